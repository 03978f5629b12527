//! Pictures, films and reports of what is shown, made on a thread of their own.

use super::command::{Command, Panel};
use super::loading::{Answer, Job, Outcome, Wake};
use super::shown::ElementColors;
use super::state::{AppState, Tree};
use super::theme::{SMALL, palette};
use crate::output::caption::{Caption, Colored, Scribe};
use crate::output::shot::{Background, Studio};
use crate::output::{film, movie, page};
use anyhow::Context as _;
use egui::{RichText, Ui};
use glam::UVec2;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use topout_render::{DrawMode, FrameInput, Gpu, Options, Renderer, Sun};
use topout_scene::{Hdlod, Looks, Progress, Scene, View};
use topout_schedule::{DateSet, Time, TimeRange};

/// What is made.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Product {
    /// One picture at the shown date.
    #[default]
    Picture,
    /// A film through time.
    Film,
    /// A page with a picture a month.
    Report,
}

impl Product {
    const ALL: [(Self, &'static str, &'static str); 3] = [
        (Self::Picture, "Picture", "png"),
        (Self::Film, "Film", "mp4"),
        (Self::Report, "Report", "html"),
    ];

    fn extension(self) -> &'static str {
        Self::ALL.into_iter().find(|(product, ..)| *product == self).map_or("png", |(.., e)| e)
    }
}

/// Pixels across and down that can be asked for.
const PIXELS: std::ops::RangeInclusive<u32> = 16..=8192;

/// What the user set.
#[derive(Clone, PartialEq, Debug)]
pub struct Export {
    /// What is made.
    pub product: Product,
    /// Where it is written to.
    pub file: String,
    /// Pixels.
    pub size: [u32; 2],
    /// What stands behind the scene.
    pub background: Background,
    /// Whether date, week, activities and colours are written onto it.
    pub caption: bool,
    /// Frames of a film.
    pub frames: u32,
    /// Frames a second.
    pub fps: u32,
    /// Degrees by which the camera turns meanwhile.
    pub turn_deg: f32,
}

impl Default for Export {
    fn default() -> Self {
        let folder = std::env::current_dir().unwrap_or_default();
        Self {
            product: Product::Picture,
            file: folder.join("topout.png").display().to_string(),
            size: [1920, 1080],
            background: Background::Scenery,
            caption: true,
            frames: 240,
            fps: 24,
            turn_deg: 0.0,
        }
    }
}

impl Export {
    /// Another product, and a file name that suits it.
    fn choose(&mut self, product: Product) {
        self.product = product;
        let file = Path::new(&self.file).with_extension(product.extension());
        self.file = file.display().to_string();
    }
}

/// What is at work, and what it will say when it is done.
pub type Exporting = Job<anyhow::Result<String>>;

/// Everything that the worker needs.
struct Work {
    scene: Arc<Scene>,
    tree: Option<Arc<Hdlod>>,
    looks: Option<Arc<Looks>>,
    wanted: Export,
    view: View,
    time: Time,
    range: TimeRange,
    mode: DrawMode,
    sun: Sun,
    colored: Colored,
}

impl AppState {
    /// Makes what the user set.
    pub(super) fn start_export(&mut self) {
        let Some(project) = &self.project else { return };
        let wanted = self.export.clone();
        let size = UVec2::from(wanted.size).clamp(UVec2::splat(16), UVec2::splat(8192));
        let work = Work {
            scene: Arc::clone(&project.scene),
            tree: match &self.tree {
                Tree::Ready(tree) => Some(Arc::clone(tree)),
                _ => None,
            },
            looks: self.coloring.looks().cloned(),
            view: self.view(size),
            time: self.time(),
            range: self.clock.looped().unwrap_or(self.period()),
            mode: self.effective_mode(),
            sun: self.sun,
            colored: match self.colors {
                ElementColors::Activity => Colored::Activity,
                ElementColors::Slip => Colored::Slip,
                ElementColors::LookAhead(weeks) => Colored::Ahead(weeks.into()),
                _ => Colored::Own,
            },
            wanted,
        };
        let job = Job::spawn("topout-export", Arc::clone(&self.wake), move |p| work.done(p));
        match job {
            Ok(job) => self.exporting = Some(job),
            Err(error) => self.error = Some(format!("No thread for the export: {error}")),
        }
    }

    /// Takes over what was made.
    pub(super) fn poll_export(&mut self) {
        let Some(job) = &self.exporting else { return };
        match job.poll() {
            Outcome::Pending => return,
            Outcome::Done(Ok(news)) => self.news = Some(news),
            Outcome::Done(Err(error)) if crate::project::is_cancelled(&error) => {
                self.news = Some("The export was stopped; nothing was written.".to_owned());
            }
            Outcome::Done(Err(error)) => self.error = Some(crate::report::describe(&error)),
            Outcome::Died => self.error = Some("The export failed.".to_owned()),
        }
        self.exporting = None;
    }
}

impl Work {
    fn done(&self, progress: &Progress) -> anyhow::Result<String> {
        let path = Path::new(self.wanted.file.trim());
        anyhow::ensure!(!path.as_os_str().is_empty(), "the export has no file name");
        film::check_place(path)?;
        progress.begin("Preparing", 0)?;
        let gpu = Gpu::headless()?;
        let mut renderer = Renderer::new(&gpu);
        renderer.set_options(Options { sun: self.sun, ..renderer.options() });
        renderer.set_scene(&self.scene)?;
        if let Some(tree) = self.tree.as_ref().filter(|_| self.mode == DrawMode::Hdlod) {
            renderer.set_hdlod(tree)?;
        }
        renderer.set_looks(self.looks.as_ref())?;
        match self.wanted.product {
            Product::Picture => self.picture(&mut renderer, path),
            Product::Film => self.film(&mut renderer, path, progress),
            Product::Report => self.report(&mut renderer, path, progress),
        }
    }

    fn picture(&self, renderer: &mut Renderer, path: &Path) -> anyhow::Result<String> {
        let end = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        let is_png = end.as_deref() == Some("png");
        anyhow::ensure!(is_png, "{}: pictures are .png files", path.display());
        let mut studio = Studio::new(renderer, self.wanted.background);
        let input = FrameInput { view: self.view, time: self.time, mode: self.mode };
        let (mut picture, _) = studio.shoot(&input)?;
        if self.wanted.caption {
            let caption = Caption::at(&self.scene, self.time, self.colored);
            Scribe::new().draw(&caption, &mut picture);
        }
        let transparent = self.wanted.background == Background::Transparent;
        let bytes = film::encode_png(&picture, transparent)?;
        film::write_whole(path, &bytes)?;
        Ok(format!("The picture was saved to {}", path.display()))
    }

    fn film(
        &self,
        renderer: &mut Renderer,
        path: &Path,
        progress: &Progress,
    ) -> anyhow::Result<String> {
        let plan = movie::Plan {
            range: self.range,
            frames: self.wanted.frames.max(1),
            fps: f64::from(self.wanted.fps.max(1)),
            view: self.view,
            turn_deg: self.wanted.turn_deg,
            mode: self.mode,
            background: self.wanted.background,
            caption: self.wanted.caption.then_some(self.colored),
        };
        movie::make(renderer, &self.scene, &plan, path, progress)?;
        Ok(format!("The film of {} frames was saved to {}", plan.frames, path.display()))
    }

    fn report(
        &self,
        renderer: &mut Renderer,
        path: &Path,
        progress: &Progress,
    ) -> anyhow::Result<String> {
        let plan = page::Plan {
            view: self.view,
            mode: self.mode,
            background: self.wanted.background,
            late: [DateSet::Planned, DateSet::Actual],
        };
        let page = page::make(renderer, &self.scene, &plan, progress)?;
        film::write_whole(path, page.html.as_bytes())
            .with_context(|| format!("cannot write {}", path.display()))?;
        Ok(format!("The report with {} pictures was saved to {}", page.pictures, path.display()))
    }
}

/// Asks for the place of a file without stopping the window.
///
/// # Errors
/// When the system has no thread to give.
pub(super) fn browse(export: &Export, wake: Wake) -> std::io::Result<Job<Answer>> {
    let file = PathBuf::from(&export.file);
    let mut dialog = rfd::AsyncFileDialog::new()
        .set_title("Save as")
        .add_filter("As chosen", &[export.product.extension()]);
    if let Some(name) = file.file_name() {
        dialog = dialog.set_file_name(name.to_string_lossy());
    }
    if let Some(folder) = file.parent() {
        dialog = dialog.set_directory(folder);
    }
    let chosen = dialog.save_file();
    Job::spawn("topout-dialog", wake, move |_| match pollster::block_on(chosen) {
        Some(file) => Answer::Place(file.path().to_owned()),
        None => Answer::Closed,
    })
}

/// Draws the panel while it is open, and collects what is asked for.
pub fn show(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let mut open = state.panels.export;
    if !open || state.project.is_none() {
        return;
    }
    egui::Window::new("Export")
        .open(&mut open)
        .resizable(false)
        .collapsible(false)
        .default_pos([320.0, 120.0])
        .show(ctx, |ui| {
            let mut wanted = state.export.clone();
            settings(ui, state, &mut wanted, commands);
            if wanted != state.export {
                commands.push(Command::SetExport(Box::new(wanted)));
            }
        });
    if !open {
        commands.push(Command::Toggle(Panel::Export));
    }
}

fn settings(ui: &mut Ui, state: &AppState, wanted: &mut Export, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        for (product, name, _) in Product::ALL {
            if ui.selectable_label(wanted.product == product, name).clicked() {
                wanted.choose(product);
            }
        }
    });
    egui::Grid::new("export").num_columns(2).spacing([12.0, 6.0]).show(ui, |ui| {
        ui.label("File");
        ui.horizontal(|ui| {
            let field = egui::TextEdit::singleline(&mut wanted.file).desired_width(300.0);
            ui.add(field).accessible_name("File");
            if ui.button("Browse…").clicked() {
                commands.push(Command::BrowseExport);
            }
        });
        ui.end_row();
        ui.label("Size");
        ui.horizontal(|ui| {
            let [width, height] = &mut wanted.size;
            ui.add(egui::DragValue::new(width).range(PIXELS)).accessible_name("Width");
            ui.label("×");
            ui.add(egui::DragValue::new(height).range(PIXELS)).accessible_name("Height");
            for (name, size) in
                [("720p", [1280, 720]), ("1080p", [1920, 1080]), ("4K", [3840, 2160])]
            {
                if ui.small_button(name).clicked() {
                    wanted.size = size;
                }
            }
        });
        ui.end_row();
        ui.label("Background");
        ui.horizontal(|ui| {
            for (background, name) in [
                (Background::Scenery, "Sky and ground"),
                (Background::White, "White"),
                (Background::Transparent, "Transparent"),
            ] {
                ui.selectable_value(&mut wanted.background, background, name);
            }
        });
        ui.end_row();
        if wanted.product != Product::Report {
            ui.label("Caption");
            ui.checkbox(&mut wanted.caption, "Date, week, activities, colours");
            ui.end_row();
        }
        if wanted.product == Product::Film {
            ui.label("Film");
            ui.horizontal(|ui| {
                let frames = egui::DragValue::new(&mut wanted.frames).range(1..=99_999);
                ui.add(frames.suffix(" frames")).accessible_name("Frames");
                let fps = egui::DragValue::new(&mut wanted.fps).range(1..=240);
                ui.add(fps.suffix(" a second")).accessible_name("Frames a second");
                let turn = egui::DragValue::new(&mut wanted.turn_deg).range(-3600.0..=3600.0);
                ui.add(turn.suffix("° turn")).accessible_name("Turn");
            });
            ui.end_row();
        }
    });
    let hint = match wanted.product {
        Product::Picture => "What is shown now, at its date, in this size.",
        Product::Film if state.clock.looped().is_some() => {
            "The part that is played again and again. .mp4, .gif, or a folder of pictures."
        }
        Product::Film => "The whole project. .mp4, .gif, or a folder of pictures by the name.",
        Product::Report => "One self-contained page: a picture a month, progress, what is late.",
    };
    ui.label(RichText::new(hint).size(SMALL).color(palette(ui).weak));
    let ready = state.exporting.is_none();
    if ui.add_enabled(ready, egui::Button::new("Save")).clicked() {
        commands.push(Command::StartExport);
    }
}
