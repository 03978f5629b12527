//! `topout report`: a page with pictures and progress.

use super::stage::{Stage, view};
use super::{Outcome, args, stop_on_ctrl_c, terminal};
use crate::output::film::{check_place, write_whole};
use crate::output::page::{Page, Plan, make};
use crate::report::{Output, count, grouped, rounded};
use serde::Serialize;
use serde_json::{Map, Value};
use std::sync::Arc;
use std::time::Instant;
use topout_scene::Progress;
use topout_schedule::DateSet;

/// The keys that scripts read.
#[derive(Serialize, Debug)]
struct Report {
    file: String,
    bytes: u64,
    /// One a month.
    pictures: usize,
    /// Activities that end later than planned, or as `--slip` says.
    late: usize,
    /// Up to when it is known what happened; null where nothing is.
    known_until: Option<String>,
    /// What was planned to be done then, in percent.
    planned_percent: Option<f64>,
    /// What was done then, in percent.
    actual_percent: Option<f64>,
    adapter: String,
    load_seconds: f64,
    /// To draw and write the page.
    seconds: f64,
    phases: Map<String, Value>,
}

/// Draws, writes and reports.
pub fn run(args: &args::Page) -> anyhow::Result<Outcome> {
    let output = Output::new(args.common.json.clone());
    // What cannot be written is said before anything slow is done.
    check_place(&args.output)?;
    let mode = args.common.lod.unwrap_or(args::Lod::Hdlod).into();
    let mut stage = Stage::set(&args.common, &[mode], args.caching.cache())?;
    stage.dress(&args.looking)?;
    let plan = Plan {
        view: view(&args.common, &args.looking, &stage.scene)?,
        mode,
        background: args.looking.background.into(),
        late: args.common.slip.unwrap_or([DateSet::Planned, DateSet::Actual]),
    };
    let progress = Arc::new(Progress::default());
    stop_on_ctrl_c(&progress);
    let started = Instant::now();
    let page = {
        let _line = terminal::ProgressLine::show(&progress);
        make(&mut stage.renderer, &stage.scene, &plan, &progress)?
    };
    write_whole(&args.output, page.html.as_bytes())?;
    let seconds = started.elapsed().as_secs_f64();
    stage.phases.append(&progress);
    stage.keep_tree();
    let report = Report::of(args, &stage, &page, seconds);
    output.say(&report.text());
    output.write(&report)?;
    Ok(Outcome::Fine)
}

impl Report {
    fn of(args: &args::Page, stage: &Stage, page: &Page, seconds: f64) -> Self {
        let percent = |share: f64| rounded(share * 100.0, 2);
        Self {
            file: args.output.display().to_string(),
            bytes: page.html.len() as u64,
            pictures: page.pictures,
            late: page.late,
            known_until: page.progress.map(|(time, ..)| time.to_string()),
            planned_percent: page.progress.map(|(_, planned, _)| percent(planned)),
            actual_percent: page.progress.map(|(.., actual)| percent(actual)),
            adapter: stage.gpu.info.name.clone(),
            load_seconds: rounded(stage.load_seconds, 3),
            seconds: rounded(seconds, 3),
            phases: stage.phases.as_json(),
        }
    }

    fn text(&self) -> String {
        let done = match (&self.known_until, self.actual_percent, self.planned_percent) {
            (Some(time), Some(actual), Some(planned)) => {
                format!("\n  done     {actual:.0} % at {time}, {planned:.0} % planned")
            }
            _ => String::new(),
        };
        format!(
            "{file}\n  shows    {pictures} pictures, {late} late activities{done}\n  size     {kb} kB\n  \
             made     in {seconds:.1} s on {adapter}",
            file = self.file,
            pictures = count(self.pictures),
            late = count(self.late),
            kb = grouped(self.bytes.div_ceil(1000)),
            seconds = self.seconds,
            adapter = self.adapter,
        )
    }
}
