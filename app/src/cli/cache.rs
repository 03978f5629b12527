//! `topout cache`: what lies in the cache, and emptying it.

use super::{Outcome, args};
use crate::report::{Output, columns, grouped};
use crate::tree::{as_time, user_cache};
use anyhow::Context;
use serde::Serialize;
use topout_scene::cache::{Cache, Entry, Total};

/// The keys of `cache list`.
#[derive(Serialize, Debug)]
struct List {
    folder: String,
    limit_bytes: u64,
    bytes: u64,
    files: Vec<File>,
}

/// One tree of the cache.
#[derive(Serialize, Debug)]
struct File {
    file: String,
    bytes: u64,
    /// UTC.
    used: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    project: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    elements: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    triangles: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    clusters: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    temporal: Option<String>,
    /// UTC.
    #[serde(skip_serializing_if = "Option::is_none")]
    made: Option<String>,
    /// Why the file cannot be used.
    #[serde(skip_serializing_if = "Option::is_none")]
    problem: Option<String>,
}

/// The keys of `cache clear`.
#[derive(Serialize, Debug)]
struct Cleared {
    folder: String,
    removed_files: u64,
    removed_bytes: u64,
}

/// Lists or clears.
pub fn run(args: &args::Cache) -> anyhow::Result<Outcome> {
    let cache = user_cache().context(
        "there is no cache: TOPOUT_CACHE_DIR is empty, or the system names no folder for caches",
    )?;
    let output = Output::new(args.json.clone());
    match args.action {
        args::CacheAction::List => {
            let list = List::of(&cache, cache.list()?);
            output.say(&list.text());
            output.write(&list)?;
        }
        args::CacheAction::Clear => {
            let cleared = Cleared::of(&cache, cache.clear()?);
            output.say(&cleared.text());
            output.write(&cleared)?;
        }
    }
    Ok(Outcome::Fine)
}

/// 12.3 MB
fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}

impl List {
    fn of(cache: &Cache, entries: Vec<Entry>) -> Self {
        Self {
            folder: cache.folder().display().to_string(),
            limit_bytes: cache.limit_bytes(),
            bytes: entries.iter().map(|e| e.bytes).sum(),
            files: entries.into_iter().map(File::of).collect(),
        }
    }

    fn text(&self) -> String {
        let mut text = format!(
            "{}\n  {} in {} trees, at most {}\n",
            self.folder,
            megabytes(self.bytes),
            self.files.len(),
            megabytes(self.limit_bytes)
        );
        if self.files.is_empty() {
            return text;
        }
        let head = ["Project", "elements", "clusters", "mode", "size", "last used (UTC)"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        rows.extend(self.files.iter().map(File::row));
        text.push_str(&columns(&rows));
        text
    }
}

impl File {
    fn of(entry: Entry) -> Self {
        let name = entry.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let (info, problem) = match entry.info {
            Ok(info) => (Some(info), None),
            Err(problem) => (None, Some(problem.to_string())),
        };
        Self {
            file: name,
            bytes: entry.bytes,
            used: as_time(entry.used).to_string(),
            elements: info.as_ref().map(|i| i.elements),
            triangles: info.as_ref().map(|i| i.triangles),
            clusters: info.as_ref().map(|i| i.clusters),
            made: info.as_ref().map(|i| i.made.to_string()),
            temporal: info.as_ref().map(|i| i.temporal.clone()),
            project: info.map(|i| i.project),
            problem,
        }
    }

    fn row(&self) -> Vec<String> {
        let number = |n: Option<u64>| n.map_or_else(String::new, grouped);
        let name = self.project.clone().or_else(|| self.problem.clone());
        vec![
            format!("  {}", name.unwrap_or_default()),
            number(self.elements),
            number(self.clusters),
            self.temporal.clone().unwrap_or_default(),
            megabytes(self.bytes),
            self.used.clone(),
        ]
    }
}

impl Cleared {
    fn of(cache: &Cache, gone: Total) -> Self {
        Self {
            folder: cache.folder().display().to_string(),
            removed_files: gone.files,
            removed_bytes: gone.bytes,
        }
    }

    fn text(&self) -> String {
        let (files, bytes) = (self.removed_files, megabytes(self.removed_bytes));
        format!("{}\n  {files} files removed, {bytes}", self.folder)
    }
}
