//! The viewer: a window on eframe, drawn by egui, with the renderer's picture in its middle.
//!
//! Data flows one way: input -> panels(&[`AppState`]) -> [`Command`]s -> [`AppState::apply`] ->
//! the 3D view. Panels never change anything themselves.

mod about;
mod browser;
mod calendar;
mod camera;
mod chrome;
mod clock;
mod closing;
mod coloring;
mod command;
mod compare;
mod cube;
mod device;
mod explode;
mod export;
mod finder;
mod frames;
mod gantt;
mod graph;
mod hint;
mod history;
mod inspector;
mod loading;
mod marks;
mod measure;
mod modes;
mod navigation;
mod overlay;
mod project_file;
mod raster;
mod recovery;
mod reload;
mod section;
mod selection;
mod settings;
mod shown;
mod state;
mod sun;
mod table;
mod theme;
mod timeline;
mod viewpoints;
mod viewport;
mod visibility;

pub use browser::{Browse, Grouping};
pub use calendar::Calendar;
pub use camera::Camera;
pub use clock::{Clock, Run, Speed, Step};
pub use closing::{Close, Closing, Question};
pub use command::{Action, Command, Panel, Shortcut, actions};
pub use compare::{Against, Half};
pub use device::Left;
pub use export::{Export, Product};
pub use frames::FrameLog;
pub use gantt::{COLUMNS, Columns, Filter, Gantt, Plan};
pub use hint::Hint;
pub use loading::write_schedule;
pub use navigation::{Mouse, Navigation};
pub use recovery::Recovery;
pub use section::{Section, SectionBox, SectionPlane};
pub use selection::{Choose, Selected};
pub use shown::ElementColors;
pub use state::AppState;
pub use table::Table;
pub use theme::Scheme;
pub use timeline::Scale;
pub use visibility::{Shown, Visibility};

use crate::project::Request;
use crate::tree::user_cache;
use anyhow::Context as _;
use device::{Estate, Losses};
use egui::{CentralPanel, Frame, Margin, Panel as Side, Ui, ViewportCommand};
use settings::Settings;
use state::Effect;
use std::panic::{AssertUnwindSafe, resume_unwind};
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};
use topout_render::{Fault, Faults, GpuError};
use viewport::Viewport;

/// How often progress of other threads is shown.
const PROGRESS_EVERY: Duration = Duration::from_millis(100);
/// Points across and down beside which panels have room: the smallest ones of them and something to see.
const LEAST_ROOM: egui::Vec2 = egui::vec2(600.0, 260.0);
/// Longest step of time while playing, seconds: after a hitch the date does not leap.
const LONGEST_STEP: f32 = 1.0;

/// Opens the viewer and returns when it is closed. With a request it loads that at once. Where the graphics
/// device is lost, another window goes on in place of the first.
///
/// # Errors
/// [`GpuError::NoAdapter`] without a graphics adapter; otherwise what the window system said.
pub fn run(request: Option<Request>) -> anyhow::Result<()> {
    let (estate, mut losses, mut request) = (Estate::default(), Losses::default(), request);
    loop {
        let window = || open(request.take(), &estate);
        let closed = std::panic::catch_unwind(AssertUnwindSafe(window));
        let Some(Left { mut state, why }) = estate.take() else {
            return closed.unwrap_or_else(|panic| resume_unwind(panic));
        };
        let kept = state.keep_unsaved();
        let kept = kept.as_deref();
        match closed {
            Ok(Ok(())) if losses.may_open_again(Instant::now()) => {
                estate.replace(Some(Left { state, why }));
            }
            Ok(Ok(())) => anyhow::bail!(device::too_often(&why, kept)),
            Ok(Err(error)) => return Err(error.context(device::none_came(&why, kept))),
            // The loss met egui in the middle of a frame; its event loop is of no more use.
            Err(panic) => match device::start_again(kept) {
                Ok(true) => return Ok(()),
                Ok(false) | Err(_) => {
                    tracing::error!("{}", device::none_came(&why, kept));
                    resume_unwind(panic)
                }
            },
        }
    }
}

/// Opens one window, for what was left by the one before or else for a request.
fn open(request: Option<Request>, estate: &Estate) -> anyhow::Result<()> {
    let viewport = egui::ViewportBuilder::default()
        .with_title("topout")
        .with_app_id("topout")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([720.0, 480.0]);
    let options = eframe::NativeOptions {
        viewport,
        wgpu_options: egui_wgpu::WgpuConfiguration {
            wgpu_setup: wgpu_setup(),
            ..Default::default()
        },
        ..Default::default()
    };
    let heir = Rc::clone(estate);
    let create: eframe::AppCreator<'_> = Box::new(move |context| {
        let mut window = match heir.take() {
            Some(left) => Window::again(context, left)?,
            None => {
                let settings = context.storage.and_then(|s| s.get_string(settings::KEY));
                let settings = settings.map(|text| Settings::read(&text)).unwrap_or_default();
                let mut window = Window::new(context, None)?;
                settings.apply(&mut window.state);
                window.state.closing.recovery = Recovery::user();
                if let Some(request) = request {
                    window.state.apply(Command::Load(request));
                }
                window.state.cache = user_cache();
                window
            }
        };
        window.estate = Some(heir);
        device::lose_if_asked(&window.opened.device);
        Ok(Box::new(window))
    });
    eframe::run_native("topout", options, create).map_err(|error| match error {
        eframe::Error::Wgpu(egui_wgpu::WgpuError::RequestAdapterError(error)) => {
            GpuError::NoAdapter(error.to_string()).into()
        }
        error => anyhow::anyhow!("the window cannot be opened: {error}"),
    })
}

/// How the window opens its device: with all that the renderer makes use of; software adapters
/// are fine.
pub fn wgpu_setup() -> egui_wgpu::WgpuSetup {
    let defaults = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    egui_wgpu::WgpuSetup::CreateNew(egui_wgpu::WgpuSetupCreateNew {
        instance_descriptor: topout_render::instance_descriptor(),
        power_preference: wgpu::PowerPreference::HighPerformance,
        device_descriptor: Arc::new(topout_render::device_descriptor),
        ..defaults
    })
}

/// The application that eframe runs.
pub struct Window {
    state: AppState,
    viewport: Viewport,
    /// The picture on the other side of a comparison.
    other: Option<Viewport>,
    opened: egui_wgpu::RenderState,
    faults: Faults,
    /// What was told last of the device.
    told: Option<Fault>,
    /// Who goes on where the device is lost.
    estate: Option<Estate>,
    title: String,
}

impl Window {
    /// Sets up looks and renderer; starts loading what is requested. Trees are not kept until
    /// [`AppState::cache`] is set.
    ///
    /// # Errors
    /// When eframe runs on something other than wgpu.
    pub fn new(
        context: &eframe::CreationContext<'_>,
        request: Option<Request>,
    ) -> anyhow::Result<Self> {
        let mut window = Self::of(context, AppState::new(Arc::new(|| ())))?;
        window.state.fade = window.viewport.suits_fading();
        if let Some(request) = request {
            window.state.apply(Command::Load(request));
        }
        Ok(window)
    }

    /// Goes on with what a window left whose device was lost.
    ///
    /// # Errors
    /// As [`Window::new`].
    pub fn again(context: &eframe::CreationContext<'_>, left: Left) -> anyhow::Result<Self> {
        let mut window = Self::of(context, left.state)?;
        // Others may wake the window that is gone.
        window.state.watch();
        window.state.frames.clear();
        window.state.news = Some(device::opened_again(&left.why));
        theme::choose(&context.egui_ctx, window.state.scheme);
        Ok(window)
    }

    fn of(context: &eframe::CreationContext<'_>, mut state: AppState) -> anyhow::Result<Self> {
        let opened = context.wgpu_render_state.as_ref().context("the window has no wgpu device")?;
        theme::install(&context.egui_ctx);
        let ctx = context.egui_ctx.clone();
        let wake: loading::Wake = Arc::new(move || ctx.request_repaint());
        let woken = Arc::clone(&wake);
        let faults = Faults::watch(&opened.device, move || woken());
        state.wake = wake;
        state.adapter = Some(opened.adapter.get_info());
        Ok(Self {
            state,
            viewport: Viewport::new(opened),
            other: None,
            opened: opened.clone(),
            faults,
            told: None,
            estate: None,
            title: String::new(),
        })
    }

    /// Why the window's device is gone; `None` while it is there.
    pub fn lost_device(&self) -> Option<&str> {
        self.faults.lost()
    }

    /// Destroys the device, as a driver that fails does.
    pub fn lose_device(&self) {
        self.opened.device.destroy();
    }

    /// Takes what is shown out of a window whose device was lost.
    pub fn leave(&mut self) -> Option<Left> {
        let why = self.faults.lost()?.to_owned();
        if self.told.is_some() {
            // What was refused was the beginning of the loss.
            self.state.error = None;
        }
        let nothing = AppState::new(Arc::new(|| ()));
        Some(Left { state: std::mem::replace(&mut self.state, nothing), why })
    }

    /// Whether the device is gone, which ends this window; says what else is wrong with it.
    fn listen(&mut self, ctx: &egui::Context) -> bool {
        // Callbacks of a device that does nothing come only here.
        let _ = self.opened.device.poll(wgpu::PollType::Poll);
        if self.faults.lost().is_some() {
            // egui cannot paint without a device, and panics where it tries.
            ctx.graphics_mut(|painted| *painted = Default::default());
            ctx.send_viewport_cmd(ViewportCommand::Close);
            return true;
        }
        if let Some(fault) = self.faults.take()
            && self.told.as_ref() != Some(&fault)
        {
            self.state.error = Some(device::explain(&fault));
            self.told = Some(fault);
        }
        false
    }

    /// The title, and whether the window may close that the user wants to close.
    fn mind_closing(&mut self, ctx: &egui::Context) {
        let title = self.state.title();
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
        if ctx.input(|i| i.viewport().close_requested()) && !self.state.may_close() {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
        }
    }

    /// What is shown.
    pub fn state(&self) -> &AppState {
        &self.state
    }

    /// Whether what is shown will change without the user: a thread is at work, levels fade into each other,
    /// or the GPU has not told what a frame took.
    pub fn is_busy(&self) -> bool {
        self.state.is_busy() || self.is_fading() || self.viewport.expects_gpu_times()
    }

    /// For driving the window from a program.
    pub fn state_mut(&mut self) -> &mut AppState {
        &mut self.state
    }

    fn is_fading(&self) -> bool {
        self.viewport.is_fading() || self.other.as_ref().is_some_and(Viewport::is_fading)
    }

    /// The 3D view, or two beside each other; returns the place of all.
    fn pictures(&mut self, ui: &mut Ui) -> egui::Rect {
        let place = ui.available_rect_before_wrap();
        if self.state.compared.is_none() {
            self.other = None;
            self.viewport.show(ui, &mut self.state, Half::Shown, place);
            return place;
        }
        // Both of one size, in whole pixels.
        let scale = ui.ctx().pixels_per_point();
        let width = ((place.width() - 2.0) * 0.5 * scale).floor().max(1.0) / scale;
        let [mut left, mut right] = [place; 2];
        left.set_right(place.left() + width);
        right.set_left(place.right() - width);
        let other = self.other.get_or_insert_with(|| Viewport::new(&self.opened));
        self.viewport.show(ui, &mut self.state, Half::Shown, left);
        other.show(ui, &mut self.state, Half::Other, right);
        place
    }

    /// Moves on foot or in the air, while its keys are down and nothing is typed.
    fn steer(&mut self, ctx: &egui::Context, seconds: f32) -> bool {
        if self.state.navigation == Navigation::Orbit || ctx.egui_wants_keyboard_input() {
            return false;
        }
        ctx.input(|i| self.state.steer(seconds, i.modifiers.shift, |key| i.key_down(key)))
    }

    fn take_effects(&mut self, ctx: &egui::Context) {
        for effect in std::mem::take(&mut self.state.effects) {
            match effect {
                Effect::Close => ctx.send_viewport_cmd(ViewportCommand::Close),
                Effect::Copy(text) => ctx.copy_text(text),
                Effect::Scheme(scheme) => theme::choose(ctx, scheme),
            }
        }
    }
}

impl eframe::App for Window {
    fn logic(&mut self, _: &egui::Context, _: &mut eframe::Frame) {
        self.state.poll();
    }

    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        if self.listen(&ctx) {
            return;
        }
        self.mind_closing(&ctx);
        let seconds = ctx.input(|i| i.stable_dt.min(LONGEST_STEP));
        self.state.advance(f64::from(seconds));
        self.state.refresh();
        // A question is answered before anything else, also by Escape.
        let mut commands = match self.state.closing.question {
            Question::Asked => Vec::new(),
            _ => command::from_keys(&ctx, self.state.navigation),
        };
        let moving = self.steer(&ctx, seconds);
        let dropped = dropped_files(&ctx);
        if !dropped.is_empty() {
            commands.push(Command::OpenFiles(dropped));
        }
        panels(ui, &self.state, &mut commands);
        let changed = !commands.is_empty();
        for command in commands {
            self.state.apply(command);
        }
        self.state.refresh();

        let mut commands = Vec::new();
        CentralPanel::no_frame().show(ui, |ui| {
            let place = self.pictures(ui);
            if self.state.project.is_none() {
                let middle = egui::Rect::from_center_size(
                    place.center(),
                    egui::vec2(place.width().min(420.0), place.height().min(260.0)),
                );
                ui.scope_builder(egui::UiBuilder::new().max_rect(middle), |ui| {
                    chrome::welcome(ui, &self.state, &mut commands);
                });
            }
            overlay::show(ui, place, &self.state, &mut commands);
            graph::show(&ctx, &self.state, place, &mut commands);
            sun::show(&ctx, &self.state, place, &mut commands);
        });
        let changed = changed || !commands.is_empty();
        for command in commands {
            self.state.apply(command);
        }
        self.take_effects(&ctx);
        if self.listen(&ctx) {
            return;
        }
        if changed || moving || self.state.clock.is_playing() || self.is_fading() {
            // The panels were drawn before the change.
            ctx.request_repaint();
        } else if self.is_busy() {
            ctx.request_repaint_after(PROGRESS_EVERY);
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        storage.set_string(settings::KEY, Settings::of(&self.state).write());
        self.state.keep_unsaved();
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}

impl Drop for Window {
    fn drop(&mut self) {
        if let Some(estate) = self.estate.take()
            && let Some(left) = self.leave()
        {
            estate.replace(Some(left));
        }
    }
}

/// Everything around the 3D view.
fn panels(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let fill = theme::palette(ui).panel;
    let frame = |x, y| Frame::new().fill(fill).inner_margin(Margin::symmetric(x, y));
    Side::top("bar").frame(frame(8, 4)).show(ui, |ui| chrome::bar(ui, state, commands));
    // Where there is no room, panels stay away: squeezed they would stay small for good.
    let room = ui.available_size();
    let (wide, high) = (room.x >= LEAST_ROOM.x, room.y >= LEAST_ROOM.y);
    if state.project.is_some() {
        if state.panels.gantt && high {
            Side::bottom("gantt")
                .frame(frame(12, 8))
                .resizable(true)
                .default_size(240.0)
                .size_range(120.0..=800.0)
                .show(ui, |ui| gantt::show(ui, state, commands));
        }
        if state.panels.timeline && high {
            Side::bottom("timeline")
                .frame(frame(12, 8))
                .resizable(false)
                .show(ui, |ui| timeline::show(ui, state, commands));
        }
        if state.panels.tree && wide {
            Side::left("tree")
                .frame(frame(12, 8))
                .default_size(260.0)
                .size_range(180.0..=520.0)
                .show(ui, |ui| browser::show(ui, state, commands));
        }
        if state.panels.inspector && wide {
            Side::right("inspector")
                .frame(frame(12, 8))
                .default_size(280.0)
                .size_range(220.0..=480.0)
                .show(ui, |ui| inspector::show(ui, state, commands));
        }
    }
    chrome::diagnostics(ui.ctx(), state, commands);
    chrome::shortcuts(ui.ctx(), state, commands);
    about::show(ui.ctx(), state, commands);
    table::show(ui.ctx(), state, commands);
    viewpoints::show(ui.ctx(), state, commands);
    section::show(ui.ctx(), state, commands);
    export::show(ui.ctx(), state, commands);
    finder::show(ui.ctx(), state, commands);
    closing::show(ui, state, commands);
}

/// A frame without the 3D view: what is asked for is carried out, and everything around the view is laid out.
/// For measuring what the window itself costs.
pub fn lay_out(
    ctx: &egui::Context,
    state: &mut AppState,
    input: egui::RawInput,
) -> egui::FullOutput {
    ctx.run_ui(input, |ui| {
        state.refresh();
        let mut commands = Vec::new();
        panels(ui, state, &mut commands);
        commands.into_iter().for_each(|command| state.apply(command));
        state.refresh();
        let mut commands = Vec::new();
        CentralPanel::no_frame().show(ui, |ui| {
            let place = ui.available_rect_before_wrap();
            overlay::show(ui, place, state, &mut commands);
        });
        commands.into_iter().for_each(|command| state.apply(command));
    })
}

/// The files that were let go over the window since the last frame.
fn dropped_files(ctx: &egui::Context) -> Vec<std::path::PathBuf> {
    ctx.input(|i| i.raw.dropped_files.iter().map(|f| f.path().to_owned()).collect())
}
