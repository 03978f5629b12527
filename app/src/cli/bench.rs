//! `topout bench`: the paper's table, measured here.

use super::stage::Stage;
use super::{Outcome, args, table, terminal};
use crate::bench::export::{self, Export, Format};
use crate::bench::{Cell, CellKey, Moment, Plan, cells, measure, measure_empty, mode_name};
use crate::report::{Output, count, rounded, rss_mb, write_file};
use serde::Serialize;
use std::sync::Arc;
use topout_render::{DrawMode, Gpu, Renderer};
use topout_scene::{Aabb, Progress, Scene};

/// The keys that scripts read.
#[derive(Serialize, Debug)]
struct Report {
    adapter: String,
    size: String,
    tolerance_px: f32,
    elements: usize,
    triangles: usize,
    activities: usize,
    load_seconds: f64,
    bake_seconds: Option<f64>,
    cache_hit: bool,
    empty_ms: f64,
    rss_mb: Option<f64>,
    gpu_mb: f64,
    cells: Vec<Cell>,
    /// Both promises over time side by side, at 1/3 and 2/3.
    temporal: Vec<RuleCell>,
}

/// A cell of HDLOD under one of the promises over time.
#[derive(Clone, Serialize, Debug)]
pub struct RuleCell {
    /// Which promise.
    pub temporal: &'static str,
    /// The figures.
    #[serde(flatten)]
    pub cell: Cell,
}

/// Measures, prints the table and reports.
pub fn run(args: &args::Bench) -> anyhow::Result<Outcome> {
    let common = &args.common;
    let files = [(Format::Csv, args.csv.as_deref()), (Format::Markdown, args.markdown.as_deref())];
    let output = files
        .iter()
        .fold(Output::new(common.json.clone()), |output, (_, file)| output.beside(*file));
    let modes: Vec<DrawMode> = match common.lod {
        Some(lod) => vec![lod.into()],
        None => vec![DrawMode::Hdlod, DrawMode::Batched, DrawMode::Objects],
    };
    let mut stage = Stage::set(common, &modes, args.caching.cache())?;
    stage.keep_tree();
    let plan = Plan::new(common.size, common.tolerance);
    let progress = Arc::new(Progress::default());
    let (empty_ms, cells) = {
        let _line = terminal::ProgressLine::show(&progress);
        let empty_ms = empty(&stage.gpu, &stage.scene.focus_bounds(), &plan, &progress)?;
        (empty_ms, measure_all(&mut stage, &cells(&modes), &plan, &progress)?)
    };
    let (bake_seconds, cache_hit) = (stage.bake_seconds(), stage.cache_hit());
    // Before the other tree, which only this comparison needs.
    let gpu_mb = rounded(stage.renderer.gpu_bytes() as f64 / 1e6, 1);
    let rss_mb = rss_mb();
    let temporal = match common.lod {
        Some(_) => Vec::new(),
        None => both_rules(&mut stage, args, &cells, &plan, &progress)?,
    };
    let model = &stage.scene.model;
    let report = Report {
        adapter: stage.gpu.info.name.clone(),
        size: format!("{}x{}", plan.size.x, plan.size.y),
        tolerance_px: plan.tolerance_px,
        elements: model.elements.len(),
        triangles: model.triangle_count(),
        activities: stage.scene.schedule.activities.len(),
        load_seconds: rounded(stage.load_seconds, 3),
        bake_seconds,
        cache_hit,
        empty_ms,
        rss_mb,
        gpu_mb,
        cells,
        temporal,
    };
    output.say(&report.text());
    output.write(&report)?;
    let choices = args.choices();
    let more: Vec<&str> = choices.iter().map(String::as_str).collect();
    let export = Export {
        cells: &report.cells,
        adapter: &report.adapter,
        plan: &plan,
        empty_ms: Some(empty_ms),
        command: &export::command(&common.request(), &plan, &more),
    };
    for (format, file) in files {
        if let Some(file) = file {
            write_file(file, &export.text(format)?)?;
        }
    }
    Ok(Outcome::Fine)
}

/// A second renderer, with a scene that has nothing in it.
fn empty(gpu: &Gpu, focus: &Aabb, plan: &Plan, progress: &Progress) -> anyhow::Result<f64> {
    progress.begin("empty frame", 0)?;
    let mut renderer = Renderer::new(gpu);
    renderer.set_scene(&Arc::new(Scene::default()))?;
    measure_empty(&mut renderer, focus, plan, progress)
}

/// The dates at which the two promises are compared: in between most is partly there.
const BETWEEN: [Moment; 2] = [Moment::Third, Moment::TwoThirds];

/// The cells of HDLOD at 1/3 and 2/3 under the rule in force, and measured under the other one.
/// Leaves the other tree on the stage.
fn both_rules(
    stage: &mut Stage,
    args: &args::Bench,
    measured: &[Cell],
    plan: &Plan,
    progress: &Arc<Progress>,
) -> anyhow::Result<Vec<RuleCell>> {
    let own = args.common.temporal;
    let is_between = |c: &&Cell| c.mode == DrawMode::Hdlod && BETWEEN.contains(&c.moment);
    let with = |rule: args::TemporalRule, cells: Vec<Cell>| {
        cells.into_iter().map(move |cell| RuleCell { temporal: rule.name(), cell })
    };
    let own_cells = measured.iter().filter(is_between).cloned().collect();

    let common = args::Common { temporal: own.other(), ..args.common.clone() };
    stage.change_tree(&common, args.caching.cache())?;
    stage.keep_tree();
    let mut keys = cells(&[DrawMode::Hdlod]);
    keys.retain(|key| BETWEEN.contains(&key.moment));
    let _line = terminal::ProgressLine::show(progress);
    let other_cells = measure_all(stage, &keys, plan, progress)?;
    Ok(with(own, own_cells).chain(with(own.other(), other_cells)).collect())
}

fn measure_all(
    stage: &mut Stage,
    keys: &[CellKey],
    plan: &Plan,
    progress: &Progress,
) -> anyhow::Result<Vec<Cell>> {
    let mut measured = Vec::new();
    for (i, key) in keys.iter().enumerate() {
        let (moment, coverage) = (key.moment.name(), key.coverage.name());
        progress
            .begin(&format!("{moment} {coverage} {}", mode_name(key.mode)), keys.len() as u64)?;
        progress.advance(i as u64)?;
        measured.extend(measure(&mut stage.renderer, &stage.scene, *key, plan, progress)?);
    }
    Ok(measured)
}

impl Report {
    fn text(&self) -> String {
        let mut text = format!(
            "{} elements, {} triangles, {} activities; {} pixels, {} px tolerance\n{}\n\n",
            count(self.elements),
            count(self.triangles),
            count(self.activities),
            self.size,
            self.tolerance_px,
            self.adapter,
        );
        text.push_str(&table::measured(&self.cells));
        text.push_str(&table::rules(&self.temporal));
        text.push_str(&format!(
            "\nA frame with nothing in it takes {:.1} ms. Memory: {} MB, on the GPU {} MB.\n",
            self.empty_ms,
            self.rss_mb.map_or("unknown".to_owned(), |mb| format!("{mb:.0}")),
            self.gpu_mb.round(),
        ));
        text.push_str(&table::verdict(&self.cells, self.empty_ms));
        text
    }
}
