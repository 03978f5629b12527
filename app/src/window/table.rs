//! The paper's table (H16), measured on the shown project by a thread with a device of its own.

use super::command::{Command, Panel};
use super::loading::{Job, Outcome, Project, Wake};
use super::overlay::short_count;
use super::state::{AppState, Tree};
use super::theme::{SMALL, palette};
use crate::bench::export::{self, Export, Format};
use crate::bench::table::{SpeedUp, factor, find, ms, papers};
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
    plan: Plan,
    /// What to type to measure the same.
    command: String,
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
        let plan = Plan { compare: false, ..Plan::new(size, tolerance_px) };
        let command = export::command(&project.request, &plan, &[]);
        self.conditions = Some(Conditions { plan, command });
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

    /// What was measured so far with all that its reader must know; `None` before the first cell.
    pub fn export(&self) -> Option<Export<'_>> {
        let Conditions { plan, command } = self.conditions.as_ref()?;
        (!self.cells.is_empty()).then_some(Export {
            cells: &self.cells,
            adapter: &self.adapter,
            plan,
            empty_ms: self.empty_ms,
            command,
        })
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
    frame_times(ui, table);
    if table.cells.iter().any(|cell| cell.mode == DrawMode::Hdlod) {
        ui.add_space(8.0);
        ui.label("How many times faster HDLOD is, beside the paper's figures.");
        ui.add_space(4.0);
        speed_ups(ui, table);
    }
    ui.add_space(4.0);
    if let Some(conditions) = &table.conditions {
        let Plan { size, tolerance_px, .. } = &conditions.plan;
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
            let (_, share) = job.state();
            ui.add(egui::ProgressBar::new(share).desired_width(160.0).desired_height(4.0));
            ui.label(RichText::new(job.told()).size(SMALL).color(weak));
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
            if !table.cells.is_empty() {
                files(ui, table, commands);
            }
        }
    });
}

/// Ways to take the table along.
fn files(ui: &mut Ui, table: &Table, commands: &mut Vec<Command>) {
    if ui.button("Copy").on_hover_text("All figures, for a spreadsheet").clicked() {
        match export::separated(&table.cells, b'\t') {
            Ok(text) => commands.push(Command::Copy(text)),
            Err(error) => commands.push(Command::Report(describe(&error))),
        }
    }
    for (format, tip) in [
        (Format::Csv, "Every figure of every cell, also of the parts of a frame"),
        (
            Format::Markdown,
            "These tables with adapter, size, tolerance and the command that measures them",
        ),
    ] {
        let button = ui.button(format!("Save as {}…", format.names().0));
        if button.on_hover_text(tip).clicked() {
            commands.push(Command::SaveTable(format));
        }
    }
}

fn frame_times(ui: &mut Ui, table: &Table) {
    let weak = palette(ui).weak;
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
}

/// HDLOD over one draw call an object here and in the paper, and over everything in one multi-draw.
fn speed_ups(ui: &mut Ui, table: &Table) {
    let weak = palette(ui).weak;
    egui::Grid::new("speed-ups").num_columns(10).spacing([12.0, 4.0]).show(ui, |ui| {
        ui.label("");
        for (_, coverage) in Coverage::ALL {
            for (head, tip) in [
                (format!("{coverage} here"), "Over one draw call an object at 1/1, measured here"),
                ("paper".to_owned(), "The same in the paper, on a graphics card of its own"),
                (
                    "over batched".to_owned(),
                    "Over everything in one multi-draw, from the same distance",
                ),
            ] {
                ui.label(RichText::new(head).size(SMALL).color(weak)).on_hover_text(tip);
            }
        }
        ui.end_row();
        for (moment, name) in Moment::ALL {
            ui.label(name);
            for (coverage, _) in Coverage::ALL {
                let cell = find(&table.cells, moment, coverage, DrawMode::Hdlod);
                let gain = cell.map(|cell| SpeedUp::of(cell, &table.cells));
                let here = gain.and_then(|gain| gain.over_objects);
                let batched = gain.and_then(|gain| gain.over_batched);
                let text = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), factor);
                ui.label(RichText::new(text(here)).strong());
                ui.label(RichText::new(factor(papers(moment, coverage))).color(weak));
                ui.label(text(batched));
            }
            ui.end_row();
        }
    });
}

/// One cell of the frame times.
fn cell(ui: &mut Ui, table: &Table, key: CellKey) {
    let Some(cell) = find(&table.cells, key.moment, key.coverage, key.mode) else {
        ui.label(RichText::new("–").color(palette(ui).weak));
        return;
    };
    let mut text = ms(cell.frame_ms);
    if let Some(gain) = SpeedUp::of(cell, &table.cells).over_objects {
        text.push_str(&format!(" ({})", factor(gain)));
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
