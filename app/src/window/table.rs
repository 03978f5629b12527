//! The paper's table (H16), measured on the shown project by a thread with a device of its own.

use super::command::{Command, Panel};
use super::loading::{Job, Outcome, Project, Wake};
use super::overlay::short_count;
use super::state::{AppState, Tree};
use super::theme::{SMALL, palette};
use crate::bench::{self, Cell, CellKey, Coverage, Moment, Plan};
use crate::report::describe;
use egui::{RichText, Ui};
use glam::UVec2;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver};
use topout_render::{DrawMode, Gpu, Renderer};
use topout_scene::{Hdlod, Progress, Scene};

/// The columns: ways of drawing at coverages.
const COLUMNS: [(DrawMode, Coverage, &str); 7] = [
    (DrawMode::Hdlod, Coverage::Full, "HDLOD 1/1"),
    (DrawMode::Hdlod, Coverage::Quarter, "1/4"),
    (DrawMode::Hdlod, Coverage::Sixteenth, "1/16"),
    (DrawMode::Batched, Coverage::Full, "batched 1/1"),
    (DrawMode::Batched, Coverage::Quarter, "1/4"),
    (DrawMode::Batched, Coverage::Sixteenth, "1/16"),
    (DrawMode::Objects, Coverage::Full, "objects 1/1"),
];

/// What the figures were measured with.
#[derive(Clone, PartialEq, Debug)]
struct Conditions {
    size: UVec2,
    tolerance_px: f32,
}

/// What a measuring thread sends while it works.
enum News {
    /// Adapter, and milliseconds of a frame with nothing to draw.
    Setting { adapter: String, empty_ms: f64 },
    /// One more cell.
    Cell(Box<Cell>),
}

/// Nothing yet, a measurement that is going on, or its result.
#[derive(Default)]
pub struct Table {
    job: Option<(Job<anyhow::Result<()>>, Receiver<News>)>,
    conditions: Option<Conditions>,
    adapter: String,
    empty_ms: Option<f64>,
    cells: Vec<Cell>,
    /// Why there is no (whole) table.
    remark: Option<String>,
    /// The thread was asked to stop.
    stopping: bool,
    /// What the thread still sends is about a project that is gone.
    stale: bool,
}

impl Drop for Table {
    /// A process must not end while a thread of its own is inside the graphics driver.
    fn drop(&mut self) {
        if let Some((job, _)) = self.job.take() {
            job.stop();
        }
    }
}

impl Table {
    /// Starts measuring in pictures of `size`, unless a measurement is still going on. Without a
    /// tree its columns stay empty.
    pub fn start(
        &mut self,
        project: &Project,
        tree: Option<Arc<Hdlod>>,
        size: UVec2,
        tolerance_px: f32,
        wake: &Wake,
    ) {
        if self.job.is_some() {
            return;
        }
        self.clear();
        self.conditions = Some(Conditions { size, tolerance_px });
        let plan = Plan { compare: false, ..Plan::new(size, tolerance_px) };
        let scene = Arc::clone(&project.scene);
        let (sender, receiver) = mpsc::sync_channel(64);
        let news_wake = Arc::clone(wake);
        let work = move |progress: &Progress| {
            measure(&scene, tree.as_ref(), &plan, progress, &mut |news| {
                // The window is gone or measures something else when nobody listens.
                let _ = sender.send(news);
                news_wake();
            })
        };
        match Job::spawn("topout-bench", Arc::clone(wake), work) {
            Ok(job) => self.job = Some((job, receiver)),
            Err(error) => self.remark = Some(format!("No thread for measuring: {error}")),
        }
    }

    /// Stops measuring at the end of the current frame; what was measured stays.
    pub fn cancel(&mut self) {
        if let Some((job, _)) = &self.job {
            job.cancel();
            self.stopping = true;
        }
    }

    /// Forgets everything: the project is another one.
    pub fn reset(&mut self) {
        self.cancel();
        self.clear();
        self.stale = self.job.is_some();
    }

    fn clear(&mut self) {
        self.conditions = None;
        self.adapter.clear();
        self.empty_ms = None;
        self.cells.clear();
        self.remark = None;
    }

    /// Takes over what was measured since the last call.
    pub fn poll(&mut self) {
        let Some((job, receiver)) = &self.job else { return };
        // First the outcome: what was sent before it is then in the channel.
        let outcome = job.poll();
        for news in receiver.try_iter().filter(|_| !self.stale) {
            match news {
                News::Setting { adapter, empty_ms } => {
                    self.adapter = adapter;
                    self.empty_ms = Some(empty_ms);
                }
                News::Cell(cell) => self.cells.push(*cell),
            }
        }
        let remark = match outcome {
            Outcome::Pending => return,
            Outcome::Done(Ok(())) => None,
            Outcome::Done(Err(_)) if self.stopping => {
                Some("Stopped before the table was complete.".to_owned())
            }
            Outcome::Done(Err(error)) => Some(describe(&error)),
            Outcome::Died => Some("The measuring thread died.".to_owned()),
        };
        self.remark = remark.filter(|_| !self.stale);
        self.job = None;
        (self.stopping, self.stale) = (false, false);
    }

    /// Whether a thread is measuring.
    pub fn is_measuring(&self) -> bool {
        self.job.is_some()
    }

    /// The cells measured so far.
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    fn cell(&self, moment: Moment, mode: DrawMode, coverage: Coverage) -> Option<&Cell> {
        self.cells.iter().find(|c| c.moment == moment && c.mode == mode && c.coverage == coverage)
    }

    /// Columns separated by tabs, for spreadsheets.
    fn text(&self) -> String {
        let mut text =
            "time\tlod\tcoverage\tframe_ms\tp95_ms\tselect_ms\tgpu_ms\tdraws\ttriangles\n"
                .to_owned();
        for cell in &self.cells {
            let gpu = cell.gpu_ms.map_or_else(String::new, |ms| format!("{ms:.3}"));
            text.push_str(&format!(
                "{}\t{}\t{}\t{:.3}\t{:.3}\t{:.3}\t{gpu}\t{}\t{}\n",
                cell.moment.name(),
                bench::mode_name(cell.mode),
                cell.coverage.name(),
                cell.frame_ms,
                cell.p95_ms,
                cell.select_ms,
                cell.draws,
                cell.triangles,
            ));
        }
        text
    }
}

/// All cells, on the calling thread, with a device of its own.
fn measure(
    scene: &Arc<Scene>,
    tree: Option<&Arc<Hdlod>>,
    plan: &Plan,
    progress: &Progress,
    tell: &mut dyn FnMut(News),
) -> anyhow::Result<()> {
    progress.begin("Opening the graphics adapter", 0)?;
    let gpu = Gpu::headless()?;
    let adapter = gpu.info.name.clone();
    let mut renderer = Renderer::new(&gpu);
    let empty_ms = bench::measure_empty(&mut renderer, &scene.focus_bounds(), plan, progress)?;
    tell(News::Setting { adapter, empty_ms });
    renderer.set_scene(scene)?;
    let mut modes = vec![DrawMode::Batched, DrawMode::Objects];
    if let Some(tree) = tree {
        renderer.set_hdlod(tree)?;
        modes.insert(0, DrawMode::Hdlod);
    }
    let keys = bench::cells(&modes);
    progress.begin("Measuring", keys.len() as u64)?;
    for key in keys {
        if let Some(cell) = bench::measure(&mut renderer, scene, key, plan, progress)? {
            tell(News::Cell(Box::new(cell)));
        }
        progress.advance(1)?;
    }
    Ok(())
}

/// The window with the table.
pub fn show(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let mut open = state.panels.table && state.project.is_some();
    if !open {
        return;
    }
    egui::Window::new("HDLOD table")
        .open(&mut open)
        .resizable(false)
        .collapsible(false)
        .default_pos([24.0, 140.0])
        .show(ctx, |ui| content(ui, state, commands));
    if !open {
        commands.push(Command::Toggle(Panel::Table));
    }
}

fn content(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let table = &state.table;
    let weak = palette(ui).weak;
    ui.label("Frame time in ms, and how many times faster than one draw call per object.");
    ui.add_space(4.0);
    egui::Grid::new("table").num_columns(8).spacing([12.0, 4.0]).show(ui, |ui| {
        ui.label("");
        for (_, _, name) in COLUMNS {
            ui.label(RichText::new(name).size(SMALL).color(weak));
        }
        ui.end_row();
        for (moment, name) in Moment::ALL {
            ui.label(name);
            for (mode, coverage, _) in COLUMNS {
                cell(ui, table, CellKey { moment, coverage, mode });
            }
            ui.end_row();
        }
    });
    ui.add_space(4.0);
    if let Some(conditions) = &table.conditions {
        let Conditions { size, tolerance_px } = conditions;
        let mut text = format!("{} × {} px · tolerance {tolerance_px:.2} px", size.x, size.y);
        if let Some(ms) = table.empty_ms {
            text.push_str(&format!(" · empty frame {ms:.2} ms · {}", table.adapter));
        }
        ui.label(RichText::new(text).size(SMALL).color(weak));
    }
    if let Some(remark) = &table.remark {
        ui.label(RichText::new(remark).color(palette(ui).warning));
    }
    ui.horizontal(|ui| match &table.job {
        Some((job, _)) => {
            let (stage, share) = job.state();
            ui.add(egui::ProgressBar::new(share).desired_width(160.0).desired_height(4.0));
            let text = format!("{stage} {:.0} % · {} s", share * 100.0, job.elapsed().as_secs());
            ui.label(RichText::new(text).size(SMALL).color(weak));
            if table.stopping {
                ui.label("stopping …");
            } else if ui.button("Stop").clicked() {
                commands.push(Command::CancelTable);
            }
        }
        None => {
            let ready = matches!(state.tree, Tree::Ready(_));
            let again = if table.cells.is_empty() { "Measure" } else { "Measure again" };
            let tip = if ready {
                "Some minutes on a software adapter; the window stays usable. A frame ends when \
                 the GPU has finished it."
            } else {
                "HDLOD is not ready: its columns will stay empty."
            };
            if ui.button(again).on_hover_text(tip).clicked() {
                commands.push(Command::MeasureTable);
            }
            if !table.cells.is_empty()
                && ui.button("Copy").on_hover_text("All figures, for a spreadsheet").clicked()
            {
                commands.push(Command::Copy(table.text()));
            }
        }
    });
}

fn cell(ui: &mut Ui, table: &Table, key: CellKey) {
    let Some(cell) = table.cell(key.moment, key.mode, key.coverage) else {
        ui.label(RichText::new("–").color(palette(ui).weak));
        return;
    };
    let ms = |ms: f64| if ms < 10.0 { format!("{ms:.2}") } else { format!("{ms:.1}") };
    let baseline = table.cell(key.moment, DrawMode::Objects, Coverage::Full);
    let mut text = ms(cell.frame_ms);
    if let (Some(slow), true) = (baseline, key.mode != DrawMode::Objects) {
        text.push_str(&format!(" ({:.1}×)", slow.frame_ms / cell.frame_ms.max(1e-6)));
    }
    let text = RichText::new(text);
    let text = if key.mode == DrawMode::Hdlod { text.strong() } else { text };
    ui.label(text).on_hover_text(format!(
        "{} frames, 95th percentile {} ms, of it {} ms choosing what to draw\n\
         {} triangles, {} draws",
        cell.frames,
        ms(cell.p95_ms),
        ms(cell.select_ms),
        short_count(cell.triangles),
        short_count(cell.draws)
    ));
}
