//! `topout movie`: a film of a time.

use super::stage::{Stage, colored, turning_view};
use super::{Outcome, WrongUse, args, stop_on_ctrl_c, terminal};
use crate::output::movie::{Plan, make};
use crate::output::{Background, Film, Made, Settings};
use crate::report::{Output, count, grouped, rounded};
use serde::Serialize;
use serde_json::{Map, Value};
use std::sync::Arc;
use std::time::Instant;
use topout_scene::{Progress, Scene};
use topout_schedule::TimeRange;

/// The keys that scripts read.
#[derive(Serialize, Debug)]
struct Report {
    /// As it was asked for.
    file: String,
    /// The file, or the frames in order.
    files: Vec<String>,
    format: &'static str,
    frames: u32,
    fps: f64,
    width: u32,
    height: u32,
    from: String,
    to: String,
    bytes: u64,
    adapter: String,
    load_seconds: f64,
    /// To draw and write all frames.
    seconds: f64,
    phases: Map<String, Value>,
}

/// Draws, writes and reports.
pub fn run(args: &args::Movie) -> anyhow::Result<Outcome> {
    let output = Output::new(args.common.json.clone());
    let size = args.common.size;
    // What cannot be written is said before anything slow is done.
    drop(Film::begin(
        &args.output,
        Settings {
            width: size.x,
            height: size.y,
            frames: args.frames,
            fps: args.fps,
            transparent: Background::from(args.looking.background) == Background::Transparent,
        },
    )?);
    let mode = args.common.lod.unwrap_or(args::Lod::Hdlod).into();
    let mut stage = Stage::set(&args.common, &[mode], args.caching.cache())?;
    let range = range(args, &stage.scene)?;
    stage.dress(&args.looking)?;
    let plan = Plan {
        range,
        frames: args.frames,
        fps: args.fps,
        view: turning_view(&args.common, &args.looking, &stage.scene, args.turn)?,
        turn_deg: args.turn,
        mode,
        background: args.looking.background.into(),
        caption: args.caption.then(|| colored(args.common.colors)),
    };
    let progress = Arc::new(Progress::default());
    stop_on_ctrl_c(&progress);
    let started = Instant::now();
    let made = {
        let _line = terminal::ProgressLine::show(&progress);
        make(&mut stage.renderer, &stage.scene, &plan, &args.output, &progress)?
    };
    let seconds = started.elapsed().as_secs_f64();
    stage.phases.append(&progress);
    stage.keep_tree();
    let report = Report::of(args, &stage, &plan, &made, seconds);
    output.say(&report.text());
    output.write(&report)?;
    Ok(Outcome::Fine)
}

/// What the film shows: the project's period unless something else is asked for.
fn range(args: &args::Movie, scene: &Scene) -> anyhow::Result<TimeRange> {
    let period = scene.schedule.period;
    let told = args.from.is_some() || args.to.is_some();
    if scene.schedule.activities.is_empty() && !told && args.turn == 0.0 {
        let told = "the project has no schedule, so every frame would be the same; see --schedule and --turn";
        return Err(WrongUse(told.to_owned()).into());
    }
    let range =
        TimeRange { start: args.from.unwrap_or(period.start), end: args.to.unwrap_or(period.end) };
    let TimeRange { start, end } = range;
    match (args.from, args.to) {
        _ if start <= end => Ok(range),
        (Some(from), _) => {
            Err(WrongUse(format!("--from {from} is after the project's end {end}")).into())
        }
        _ => Err(WrongUse(format!("--to {end} is before the project's start {start}")).into()),
    }
}

impl Report {
    fn of(args: &args::Movie, stage: &Stage, plan: &Plan, made: &Made, seconds: f64) -> Self {
        Self {
            file: args.output.display().to_string(),
            files: made.files.iter().map(|file| file.display().to_string()).collect(),
            format: made.format.word(),
            frames: made.frames,
            fps: args.fps,
            width: made.width,
            height: made.height,
            from: plan.range.start.to_string(),
            to: plan.range.end.to_string(),
            bytes: made.bytes,
            adapter: stage.gpu.info.name.clone(),
            load_seconds: rounded(stage.load_seconds, 3),
            seconds: rounded(seconds, 3),
            phases: stage.phases.as_json(),
        }
    }

    fn text(&self) -> String {
        format!(
            "{file}\n  shows    {from} to {to}\n  film     {frames} {frame_word} of {width} x {height} pixels, \
             {length:.1} s at {fps} a second\n  size     {kb} kB as {format} in {files} {file_word}\n  \
             made     in {seconds:.1} s, {each:.0} ms a frame, on {adapter}",
            file = self.file,
            from = self.from,
            to = self.to,
            frames = grouped(self.frames),
            frame_word = if self.frames == 1 { "frame" } else { "frames" },
            width = self.width,
            height = self.height,
            length = f64::from(self.frames) / self.fps,
            fps = self.fps,
            kb = grouped(self.bytes.div_ceil(1000)),
            format = self.format,
            files = count(self.files.len()),
            file_word = if self.files.len() == 1 { "file" } else { "files" },
            seconds = self.seconds,
            each = self.seconds * 1000.0 / f64::from(self.frames),
            adapter = self.adapter,
        )
    }
}
