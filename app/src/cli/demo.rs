//! `topout demo`: the demo project as files.

use super::{Outcome, args, terminal};
use crate::report::{Output, grouped, rounded};
use anyhow::Context;
use serde::Serialize;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;
use topout_scene::{Progress, demo, export};

/// The keys that scripts read.
#[derive(Serialize, Debug)]
struct Report {
    model: PathBuf,
    schedule: PathBuf,
    elements: u64,
    triangles: u64,
    activities: u64,
    seed: u64,
    bytes: u64,
    seconds: f64,
}

/// Generates and writes.
pub fn run(args: &args::Demo) -> anyhow::Result<Outcome> {
    let started = Instant::now();
    let settings = settings(args);
    let progress = Arc::new(Progress::default());
    let line = terminal::ProgressLine::show(&progress);
    let (model, schedule) = demo::generate(&settings, &progress)?;
    progress.begin("writing files", 0)?;
    std::fs::create_dir_all(&args.output)
        .with_context(|| format!("cannot make the folder {}", args.output.display()))?;
    let (model_path, schedule_path) = (args.output.join("demo.glb"), args.output.join("demo.json"));
    let bytes = write_file(&model_path, |out| Ok(export::write_glb(&model, out)?))?
        + write_file(&schedule_path, |out| Ok(schedule.write_json(out)?))?;
    drop(line);
    let report = Report {
        model: model_path,
        schedule: schedule_path,
        elements: model.elements.len() as u64,
        triangles: model.triangle_count() as u64,
        activities: schedule.activities.len() as u64,
        seed: settings.seed,
        bytes,
        seconds: rounded(started.elapsed().as_secs_f64(), 3),
    };
    let output = Output::new(args.json.clone());
    output.say(&report.text());
    output.write(&report)?;
    Ok(Outcome::Fine)
}

/// Without a number of triangles or activities, they keep the default's proportion to the elements.
fn settings(args: &args::Demo) -> demo::DemoSettings {
    let default = demo::DemoSettings::default();
    let scaled = demo::DemoSettings::for_elements(args.elements.unwrap_or(default.elements));
    demo::DemoSettings {
        triangles: args.triangles.unwrap_or(scaled.triangles),
        activities: args.activities.unwrap_or(scaled.activities),
        seed: args.seed.unwrap_or(scaled.seed),
        ..scaled
    }
}

/// Writes a file and says how long it is.
fn write_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> anyhow::Result<()>,
) -> anyhow::Result<u64> {
    let work = || -> anyhow::Result<u64> {
        let mut out = BufWriter::new(File::create(path)?);
        write(&mut out)?;
        out.flush()?;
        Ok(out.get_ref().metadata()?.len())
    };
    work().with_context(|| format!("cannot write {}", path.display()))
}

impl Report {
    fn text(&self) -> String {
        format!(
            "{model}\n  {elements} elements, {triangles} triangles\n{schedule}\n  {activities} \
             activities\nOpen it with: topout {model} --schedule {schedule}",
            model = self.model.display(),
            schedule = self.schedule.display(),
            elements = grouped(self.elements),
            triangles = grouped(self.triangles),
            activities = grouped(self.activities),
        )
    }
}
