//! Files on the way from a test to the readers.
#![allow(dead_code, reason = "each test program uses its part")]

pub mod fixtures;

use std::path::PathBuf;
use tempfile::TempDir;
use topout_schedule::{Activity, ReadError, ReadOptions, Schedule, Time, read_files};

/// A folder with files, gone with this value.
pub struct Files {
    folder: TempDir,
    paths: Vec<PathBuf>,
}

impl Files {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder"), paths: Vec::new() }
    }

    /// Writes a file and adds it to those that are read.
    pub fn add(mut self, name: &str, content: impl AsRef<[u8]>) -> Self {
        let path = self.folder.path().join(name);
        std::fs::write(&path, content).expect("a temporary file");
        self.paths.push(path);
        self
    }

    /// Adds a file that does not exist.
    pub fn add_missing(mut self, name: &str) -> Self {
        self.paths.push(self.folder.path().join(name));
        self
    }

    pub fn reversed(mut self) -> Self {
        self.paths.reverse();
        self
    }

    pub fn try_read(&self, options: &ReadOptions) -> Result<Schedule, ReadError> {
        read_files(&self.paths, options)
    }

    pub fn read(&self) -> Schedule {
        self.try_read(&ReadOptions::default()).expect("a schedule")
    }

    /// The message with which reading fails.
    pub fn error(&self) -> String {
        self.try_read(&ReadOptions::default()).expect_err("an error").to_string()
    }
}

pub fn json(content: impl AsRef<[u8]>) -> Schedule {
    Files::new().add("plan.json", content).read()
}

pub fn csv(content: impl AsRef<[u8]>) -> Schedule {
    Files::new().add("plan.csv", content).read()
}

pub fn with_format(format: &str) -> ReadOptions {
    ReadOptions { date_format: Some(format.to_owned()), ..ReadOptions::default() }
}

pub fn with_encoding(encoding: &str) -> ReadOptions {
    ReadOptions { encoding: Some(encoding.to_owned()), ..ReadOptions::default() }
}

pub fn time(text: &str) -> Time {
    Time::parse_iso(text).expect("a date")
}

/// Reads bytes as a file of this name.
pub fn read_as(name: &str, content: impl AsRef<[u8]>) -> Schedule {
    topout_schedule::read_bytes(name.as_ref(), content.as_ref(), &ReadOptions::default())
        .expect("a schedule")
}

/// The activity with an id.
pub fn by_id<'a>(schedule: &'a Schedule, id: &str) -> &'a Activity {
    schedule.activities.iter().find(|a| a.id == id).expect("an activity with this id")
}

pub fn field<'a>(activity: &'a Activity, name: &str) -> Option<&'a str> {
    activity.fields.iter().find(|(n, _)| **n == *name).map(|(_, v)| &**v)
}

/// Codes of what was found, each with its count.
pub fn findings(schedule: &Schedule) -> Vec<(&'static str, usize)> {
    let mut all: Vec<_> = schedule.diagnostics.iter().map(|d| (d.code, d.count)).collect();
    all.sort();
    all
}

/// What is said of a code.
pub fn message<'a>(schedule: &'a Schedule, code: &str) -> &'a str {
    &schedule.diagnostics.get(code).expect("a finding with this code").message
}

/// Fails unless the text contains all parts.
#[track_caller]
pub fn assert_says(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part:?} is not said in: {text}");
    }
}
