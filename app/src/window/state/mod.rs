//! What the window shows, and the one place that changes it.

mod files;
mod select;
mod view;

use super::browser::Browser;
use super::calendar::Calendar;
use super::camera::Camera;
use super::clock::{Clock, Run};
use super::closing::Closing;
use super::coloring::Coloring;
use super::command::{Command, Panel};
use super::compare::{Compared, Comparing, Half};
use super::explode::Explosion;
use super::export::{Export, Exporting, browse};
use super::frames::FrameLog;
use super::gantt::{Columns, Gantt};
use super::hint::Hint;
use super::history::History;
use super::loading::{Answer, Ask, Job, Loaded, Outcome, Project, Stamp, Wake, place_project};
use super::measure::Measure;
use super::navigation::{Mouse, Navigation};
use super::project_file::Saved;
use super::reload::{Refining, TreeChange};
use super::section::Section;
use super::selection::Selected;
use super::settings::{Recent, remember};
use super::shown::{ElementColors, Panels, WEEKS_AHEAD};
use super::table::Table;
use super::theme::Scheme;
use super::timeline::Scale;
use super::viewpoints::{Trail, Viewpoint};
use super::visibility::Visibility;
use crate::project::{self, Request};
use crate::report::describe;
use crate::tree::Baked;
use glam::UVec2;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use topout_render::{DrawMode, Sun};
use topout_scene::cache::Cache;
use topout_scene::{Cancelled, Hdlod, MOST_WEEKS, NamedView, Scene, hdlod};
use topout_schedule::{Time, TimeRange};

/// Tolerances that can be set, physical pixels.
pub const TOLERANCE: std::ops::RangeInclusive<f32> = 0.25..=32.0;

/// The level-of-detail tree of the shown scene.
pub enum Tree {
    /// There is no scene.
    None,
    /// A worker is at it.
    Building(Job<Result<Baked, Cancelled>>),
    /// Ready to draw.
    Ready(Arc<Hdlod>),
    /// The user stopped it, or its thread could not run.
    Stopped,
}

/// A tree on its way into the cache; waited for when the window closes.
struct Keeping(Option<JoinHandle<()>>);

impl Keeping {
    fn is_going_on(&self) -> bool {
        self.0.as_ref().is_some_and(|thread| !thread.is_finished())
    }
}

impl Drop for Keeping {
    fn drop(&mut self) {
        if let Some(thread) = self.0.take() {
            // A panic of the thread was reported on standard error; the tree is built again then.
            let _ = thread.join();
        }
    }
}

/// What only the window system can do; collected by [`AppState::apply`].
#[derive(Clone, PartialEq, Debug)]
pub enum Effect {
    /// Close the window.
    Close,
    /// Put a text on the clipboard.
    Copy(String),
    /// Change the look.
    Scheme(Scheme),
}

/// Everything that the window shows. [`AppState::apply`] carries out what the user asks for;
/// besides it only time ([`AppState::advance`]) and finished work ([`AppState::poll`]) change it.
pub struct AppState {
    pub(super) wake: Wake,
    /// The shown project.
    pub project: Option<Arc<Project>>,
    /// Its tree.
    pub tree: Tree,
    /// Where trees are kept; none where there is no cache.
    pub cache: Option<Cache>,
    /// Where the tree came from; none while there is none.
    pub tree_origin: Option<&'static str>,
    /// How it came from the one before, after an edit of the schedule.
    pub tree_change: Option<TreeChange>,
    /// The tree of an edited schedule is being made whole.
    pub refining: Option<Refining>,
    keeping: Vec<Keeping>,
    /// What is being loaded, and its name.
    pub loading: Option<(String, Job<anyhow::Result<Loaded>>)>,
    /// Ends when the schedule's files have changed.
    pub(super) watching: Option<Job<Vec<Stamp>>>,
    /// What the shown plan is held against.
    pub compared: Option<Compared>,
    /// The same on its way.
    pub comparing: Option<Comparing>,
    dialog: Option<Job<Answer>>,
    /// Where the shown project is saved.
    pub project_file: Option<PathBuf>,
    /// What that file has, and what is asked before the window closes.
    pub closing: Closing,
    /// How what is being loaded was looked at.
    pub(super) saved: Option<Saved>,
    /// Projects that were open, the last one first.
    pub recent: Vec<Recent>,
    /// What is to be saved of what is shown.
    pub export: Export,
    /// What is being saved.
    pub exporting: Option<Exporting>,
    /// Schedules that were opened before any model.
    pub waiting_schedules: Vec<PathBuf>,
    /// What went wrong last: file, place and value.
    pub error: Option<String>,
    /// What happened last to the schedule, or to a file that was saved.
    pub news: Option<String>,

    /// The shown date, and how it runs.
    pub clock: Clock,
    /// The part of time that the timeline shows.
    pub scale: Scale,
    /// The rows of the Gantt chart.
    pub gantt: Gantt,
    /// Its columns.
    pub columns: Columns,
    /// The model tree.
    pub browser: Browser,

    /// Where one looks from.
    pub camera: Camera,
    /// Where one looked from before.
    pub trail: Trail,
    /// Views that are kept.
    pub viewpoints: Vec<Viewpoint>,
    /// Which mouse buttons do what.
    pub mouse: Mouse,
    /// How one moves.
    pub navigation: Navigation,
    /// Size of the 3D view, physical pixels.
    pub picture: UVec2,
    /// The camera still stands where a fit put it, so a change of the window's size fits again.
    fitted: bool,
    /// How the scene is drawn.
    pub mode: DrawMode,
    /// Largest error allowed on the picture, physical pixels.
    pub tolerance_px: f32,
    /// Whether clusters take their colour from their level.
    pub level_colors: bool,
    /// Which colours elements have.
    pub colors: ElementColors,
    /// What is hidden, or a ghost.
    pub visibility: Visibility,
    /// What is cut away.
    pub section: Section,
    /// It is being changed: one step for undo.
    pulling_section: bool,
    /// Distances.
    pub measure: Measure,
    /// Storeys that stand apart.
    pub explosion: Explosion,
    /// What can be taken back.
    pub history: History,
    /// The looks that follow from these.
    pub coloring: Coloring,
    /// Where the light comes from.
    pub sun: Sun,
    /// Whether levels fade into each other.
    pub fade: bool,
    /// What is selected.
    pub selected: Selected,

    /// Figures of the last frames.
    pub frames: FrameLog,
    /// Which panels are unfolded.
    pub panels: Panels,
    /// What can be done first.
    pub hint: Hint,
    /// What draws; none without a window.
    pub adapter: Option<wgpu::AdapterInfo>,
    /// Dark or light.
    pub scheme: Scheme,
    /// The paper's table.
    pub table: Table,
    /// What the window system is asked for.
    pub effects: Vec<Effect>,
}

impl AppState {
    /// Nothing loaded. `wake` must cause a frame; it is called from other threads.
    pub fn new(wake: Wake) -> Self {
        let picture = UVec2::new(1280, 720);
        Self {
            wake,
            project: None,
            tree: Tree::None,
            cache: None,
            tree_origin: None,
            tree_change: None,
            refining: None,
            keeping: Vec::new(),
            loading: None,
            watching: None,
            compared: None,
            comparing: None,
            dialog: None,
            project_file: None,
            closing: Closing::default(),
            saved: None,
            recent: Vec::new(),
            export: Export::default(),
            exporting: None,
            waiting_schedules: Vec::new(),
            error: None,
            news: None,
            clock: Clock::default(),
            scale: Scale::default(),
            gantt: Gantt::default(),
            columns: Columns::default(),
            browser: Browser::default(),
            camera: Camera::fit_named(&Default::default(), NamedView::Iso, picture),
            trail: Trail::default(),
            viewpoints: Vec::new(),
            mouse: Mouse::default(),
            navigation: Navigation::default(),
            picture,
            fitted: true,
            mode: DrawMode::Hdlod,
            tolerance_px: 1.0,
            level_colors: false,
            colors: ElementColors::Activity,
            visibility: Visibility::default(),
            section: Section::default(),
            pulling_section: false,
            measure: Measure::default(),
            explosion: Explosion::default(),
            history: History::default(),
            coloring: Coloring::default(),
            sun: Sun::Fixed,
            fade: false,
            selected: Selected::default(),
            frames: FrameLog::default(),
            panels: Panels::default(),
            hint: Hint::default(),
            adapter: None,
            scheme: Scheme::default(),
            table: Table::default(),
            effects: Vec::new(),
        }
    }

    /// The shown date.
    pub fn time(&self) -> Time {
        self.clock.time()
    }

    /// The period that the timeline spans.
    pub fn period(&self) -> TimeRange {
        let Some(project) = &self.project else { return TimeRange::default() };
        let own = project.calendar.period();
        self.compared.as_ref().map_or(own, |compared| {
            let other = compared.project.calendar.period();
            TimeRange { start: own.start.min(other.start), end: own.end.max(other.end) }
        })
    }

    /// Whether some thread is at work whose result will change what is shown.
    pub fn is_busy(&self) -> bool {
        self.loading.is_some()
            || matches!(self.tree, Tree::Building(_))
            || self.refining.is_some()
            || self.dialog.is_some()
            || self.exporting.is_some()
            || self.comparing.is_some()
            || self.explosion.is_going_on()
            || self.table.is_measuring()
    }

    /// How the scene can be drawn now: in full detail until the tree is ready.
    pub fn effective_mode(&self) -> DrawMode {
        self.mode_on(Half::Shown)
    }

    /// Carries out one command.
    pub fn apply(&mut self, command: Command) {
        self.hint.heed(&command);
        match command {
            Command::OpenModel => self.ask(Ask::Models),
            Command::OpenSchedule => self.ask(Ask::Schedules),
            Command::OpenDemo => self.load(Request::demo()),
            Command::Load(request) => self.load(request),
            Command::OpenFiles(paths) => self.open_files(paths),
            Command::SaveSchedule => self.save_schedule(),
            Command::SaveProject => self.save_project(),
            Command::SaveProjectAs => {
                if self.dialog.is_none() {
                    let file = self.project_file.as_ref().and_then(|path| path.file_name());
                    let name =
                        file.map_or_else(|| "project.topout".into(), |n| n.to_string_lossy());
                    self.take_dialog(place_project(&name, Arc::clone(&self.wake)));
                }
            }
            Command::ReloadSchedule => self.reload_schedule(),
            Command::CancelLoading => self.loading = None,
            Command::DismissNews => self.news = None,
            Command::Report(error) => self.error = Some(error),
            Command::DismissError => self.error = None,
            Command::Quit => self.effects.push(Effect::Close),
            Command::ShowHint => self.hint.show(),
            Command::CloseHint => self.hint.close(),
            Command::AnswerClose(answer) => self.answer_close(answer),

            Command::TogglePlay => self.clock.toggle(),
            Command::PlayForward => self.clock.play(Run::Forward, true),
            Command::PlayBackward => self.clock.play(Run::Backward, true),
            Command::Pause => self.clock.pause(),
            Command::Stop => self.clock.stop(),
            Command::ToggleSkipIdle => self.clock.skip_idle = !self.clock.skip_idle,
            Command::Step(step) => {
                if let Some(project) = &self.project {
                    self.clock.step(step, &project.calendar);
                    self.follow_clock();
                }
            }
            Command::JumpTo(time) => self.clock.jump(time),
            Command::ToStart => {
                self.clock.jump(self.period().start);
                self.follow_clock();
            }
            Command::ToEnd => {
                self.clock.pause();
                self.clock.jump(self.period().end);
                self.follow_clock();
            }
            Command::SetSpeed(speed) => self.clock.speed = speed,
            Command::Faster => self.clock.change_speed(true),
            Command::Slower => self.clock.change_speed(false),
            Command::SetLoop(range) => self.clock.set_loop(range),
            Command::LoopShown => self.clock.set_loop(Some(self.scale.range())),
            Command::ShowTime(scale) => self.scale = scale.within(self.period()),
            Command::FitTimeline => self.scale = Scale::of(self.period()),

            Command::SetMode(mode) if mode == self.mode => {}
            Command::SetMode(mode) => {
                self.mode = mode;
                self.frames.clear();
            }
            Command::SetTolerance(px) => {
                if px.is_finite() {
                    self.tolerance_px = px.clamp(*TOLERANCE.start(), *TOLERANCE.end());
                    self.frames.clear();
                }
            }
            Command::ColorBy(wanted) => {
                // Other weeks are no other colours.
                let menu = ElementColors::LookAhead(WEEKS_AHEAD);
                let ahead = matches!(self.colors, ElementColors::LookAhead(_));
                let off = self.colors == wanted || (ahead && wanted == menu);
                self.colors = if off { ElementColors::Own } else { wanted };
            }
            Command::LookAhead(weeks) => {
                let weeks = weeks.clamp(1, MOST_WEEKS as u8);
                self.colors = ElementColors::LookAhead(weeks);
            }
            Command::ToggleLevelColors => self.level_colors = !self.level_colors,
            Command::ToggleFade => self.fade = !self.fade,
            Command::SetSun(sun) => self.sun = sun,
            Command::BuildHdlod if matches!(self.tree, Tree::Ready(_)) => self.refine(),
            Command::BuildHdlod => self.build_tree(),
            Command::CancelHdlod => {
                self.refining = None;
                if matches!(self.tree, Tree::Building(_)) {
                    self.tree = Tree::Stopped;
                }
            }

            Command::Fit => {
                self.trail.leave(self.camera);
                self.fit();
            }
            Command::FitSelection => self.fit_selection(),
            Command::LookFrom(named) => {
                self.trail.leave(self.camera);
                self.look_from(named);
            }
            Command::LookAlong(azimuth, elevation) => {
                self.trail.leave(self.camera);
                let [azimuth, elevation] = [azimuth, elevation].map(|a| f32::from(a).to_radians());
                self.camera = Camera { azimuth, elevation, ..self.camera };
                self.fit();
            }
            Command::LeaveView => self.trail.leave(self.camera),
            Command::ViewBack => self.step_view(true),
            Command::ViewForward => self.step_view(false),
            Command::ToggleParallel => self.camera.parallel = !self.camera.parallel,
            Command::SetMouse(mouse) => self.mouse = mouse,
            Command::Navigate(wanted) => {
                let off = self.navigation == wanted;
                self.navigation = if off { Navigation::Orbit } else { wanted };
                if !off {
                    self.trail.leave(self.camera);
                    self.camera.parallel = false;
                }
                self.stand();
            }
            Command::SaveViewpoint => self.save_viewpoint(),
            Command::ShowViewpoint(i) => self.show_viewpoint(i),
            Command::RenameViewpoint(i, name) => {
                if let Some(viewpoint) = self.viewpoints.get_mut(i) {
                    viewpoint.name = name;
                }
            }
            Command::DeleteViewpoint(i) => {
                if i < self.viewpoints.len() {
                    self.viewpoints.remove(i);
                }
            }
            Command::MoveCamera(camera) => self.move_camera(camera),
            Command::Choose(how, elements) => self.choose(how, elements),
            Command::ClearSelection if self.measure.on => self.measure.step_back(),
            Command::ClearSelection if self.navigation != Navigation::Orbit => {
                self.navigation = Navigation::Orbit;
            }
            Command::ClearSelection => self.selected = Selected::default(),
            Command::SelectActivity(activity) => self.select_activity(activity),
            Command::SelectSummary(summary) => self.select_summary(summary),
            Command::Draw(shown, elements) => {
                let mut next = self.visibility.clone();
                next.set(&elements, shown);
                self.set_visibility(next);
            }
            Command::DrawSelection(shown) => {
                let mut next = self.visibility.clone();
                next.set(self.selected.elements(), shown);
                self.set_visibility(next);
            }
            Command::Isolate(others) => self.isolate(others),
            Command::ShowAll => self.set_visibility(Visibility::default()),
            Command::DrawUnscheduled(unscheduled) => {
                let mut next = self.visibility.clone();
                next.unscheduled = unscheduled;
                self.set_visibility(next);
            }
            Command::Compare(against) => self.compare(against),
            Command::CompareFile => self.ask(Ask::Compared),
            Command::StopComparing => self.stop_comparing(),
            Command::Explode(gap) => self.explode(gap),
            Command::ToggleExplosion => self.toggle_explosion(),
            Command::SetSection(next) => self.set_section(*next),
            Command::SettleSection => self.settle_section(),
            Command::ToggleSection => {
                self.toggle_section();
                self.settle_section();
            }
            Command::SectionBox(around_selection) => {
                self.section_box(around_selection);
                self.settle_section();
            }
            Command::SectionAt(point, outward) => {
                self.set_section(self.section.with_plane(point, outward));
                self.settle_section();
            }
            Command::ClearSection => {
                self.set_section(Section::default());
                self.settle_section();
            }
            Command::ToggleMeasure => {
                self.measure.on = !self.measure.on;
                self.measure.start = None;
            }
            Command::MeasureAt(point) => self.measure.take(point),
            Command::ClearMeasures => {
                self.measure = Measure { on: self.measure.on, ..Measure::default() };
            }
            Command::MoveActivity(activity, dates) => self.move_activity(activity, dates),
            Command::Undo => self.step_history(true),
            Command::Redo => self.step_history(false),
            Command::Browse(wanted) => self.browser.wanted = *wanted,
            Command::SetFilter(filter) => self.gantt.filter = *filter,
            Command::SetColumns(columns) => self.columns = columns,
            Command::Fold(node, folded) => self.gantt.fold(node, folded),
            Command::FoldAll(folded) => {
                if let Some(project) = &self.project {
                    self.gantt.fold_all(&project.plan, folded);
                }
            }
            Command::Attach(elements, activity) => self.link_by_hand(&elements, activity, true),
            Command::Detach(elements, activity) => self.link_by_hand(&elements, activity, false),

            Command::Toggle(panel) => {
                let open = self.panel_mut(panel);
                *open = !*open;
            }
            Command::SetScheme(scheme) => {
                self.scheme = scheme;
                self.effects.push(Effect::Scheme(scheme));
            }
            Command::ToggleScheme => {
                let next = if self.scheme == Scheme::Light { Scheme::Dark } else { Scheme::Light };
                self.apply(Command::SetScheme(next));
            }

            Command::SetExport(wanted) => self.export = *wanted,
            Command::BrowseExport => {
                if self.dialog.is_none() {
                    self.take_dialog(browse(&self.export, Arc::clone(&self.wake)));
                }
            }
            Command::StartExport => self.start_export(),
            Command::CancelExport => {
                if let Some(job) = &self.exporting {
                    job.cancel();
                }
            }

            Command::MeasureTable => {
                if let Some(project) = &self.project {
                    let tree = match &self.tree {
                        Tree::Ready(tree) => Some(Arc::clone(tree)),
                        _ => None,
                    };
                    self.panels.table = true;
                    self.table.start(project, tree, self.picture, self.tolerance_px, &self.wake);
                }
            }
            Command::CancelTable => self.table.cancel(),
            Command::SaveTable(format) => self.save_table(format),
            Command::Copy(text) => self.effects.push(Effect::Copy(text)),
        }
    }

    /// Lets time run on by `seconds` of the user's time.
    pub fn advance(&mut self, seconds: f64) {
        if !self.clock.is_playing() {
            return;
        }
        let work = self.project.as_ref().and_then(|p| p.scene.schedule.work_calendar());
        self.clock.advance(seconds, work);
        self.follow_clock();
    }

    /// Turns the timeline's page to the shown date.
    fn follow_clock(&mut self) {
        self.scale = self.scale.following(self.time(), self.period());
    }

    /// Works out what is shown of all this, where it has changed: once before each frame.
    pub fn refresh(&mut self) {
        let time = self.time();
        self.coloring.refresh(self.project.as_ref(), self.colors, &self.visibility, time);
        if let Some(Compared { project, coloring, .. }) = &mut self.compared {
            coloring.refresh(Some(project), self.colors, &self.visibility, time);
        }
        if let Some(project) = &self.project {
            self.gantt.refresh(project, time);
            if self.panels.tree {
                self.browser.refresh(project);
            }
        }
    }

    /// Takes over what other threads have finished.
    pub fn poll(&mut self) {
        self.poll_dialog();
        if let Some((_, job)) = &self.loading {
            match job.poll() {
                Outcome::Pending => {}
                Outcome::Died => {
                    self.loading = None;
                    self.error = Some("The loading thread died; nothing was loaded.".to_owned());
                }
                Outcome::Done(Ok(loaded)) => {
                    self.loading = None;
                    match loaded {
                        Loaded::Project(project) => self.show(*project),
                        Loaded::Edit(edit) => self.take_edit(*edit),
                        Loaded::Other(project, news) => {
                            self.show(*project);
                            self.news = Some(news);
                        }
                    }
                }
                Outcome::Done(Err(error)) => {
                    self.loading = None;
                    self.saved = None;
                    if !project::is_cancelled(&error) {
                        self.error = Some(describe(&error));
                    }
                }
            }
        }
        if let Tree::Building(job) = &self.tree {
            match job.poll() {
                Outcome::Pending => {}
                Outcome::Done(Ok(baked)) => {
                    self.tree = Tree::Ready(Arc::clone(&baked.tree));
                    self.tree_origin =
                        Some(if baked.from_cache { "taken from the cache" } else { "built" });
                    self.frames.clear();
                    self.keep(baked);
                }
                Outcome::Done(Err(Cancelled)) => self.tree = Tree::Stopped,
                Outcome::Died => {
                    self.tree = Tree::Stopped;
                    self.error = Some(
                        "Building the HDLOD tree failed; the scene is drawn in full detail."
                            .to_owned(),
                    );
                }
            }
        }
        self.poll_export();
        self.poll_comparing();
        self.poll_explosion();
        self.poll_refining();
        self.poll_watching();
        self.keeping.retain(Keeping::is_going_on);
        self.table.poll();
    }

    /// Shows a scene that is already in memory, as if it had been loaded by `request`.
    pub fn show_scene(&mut self, request: Request, scene: Arc<Scene>) {
        self.show(Project::new(request, scene));
    }

    fn show(&mut self, project: Project) {
        // What was shown is left without a question.
        self.keep_unsaved();
        let same_models =
            self.project.as_ref().is_some_and(|p| p.request.models == project.request.models);
        let project = Arc::new(project);
        remember(&mut self.recent, &project.request);
        self.project = Some(Arc::clone(&project));
        self.selected = Selected::default();
        self.clock.pause();
        self.history.forget_dates();
        (self.compared, self.comparing) = (None, None);
        self.forget_explosion();
        if !same_models {
            self.visibility = Visibility::default();
            self.section = Section::default();
            self.measure = Measure::default();
            self.history = History::default();
            self.trail = Trail::default();
            self.project_file = None;
            self.closing.kept = None;
            self.viewpoints.clear();
        }
        self.gantt = Gantt::of(&project);
        self.error = None;
        self.news = None;
        self.refining = None;
        self.waiting_schedules.clear();
        self.frames.clear();
        self.table.reset();
        self.watch();
        self.hold_clock();
        if !same_models {
            self.clock.set_loop(None);
            self.apply(Command::FitTimeline);
            self.apply(Command::ToEnd);
            self.look_from(NamedView::Iso);
        }
        self.build_tree();
        if let Some(saved) = self.saved.take() {
            self.take_saved(saved);
        }
    }

    /// Keeps the date within the period.
    pub(super) fn hold_clock(&mut self) {
        self.clock.set_period(self.period());
        self.scale = self.scale.within(self.period());
    }

    pub(super) fn build_tree(&mut self) {
        let Some(project) = &self.project else { return };
        let (scene, request) = (Arc::clone(&project.scene), project.request.clone());
        let cache = self.cache.clone();
        self.tree_origin = None;
        self.refining = None;
        let work = move |progress: &topout_scene::Progress| {
            Baked::new(&scene, &hdlod::Settings::default(), &request, cache, progress)
        };
        self.tree = match Job::spawn("topout-hdlod", Arc::clone(&self.wake), work) {
            Ok(job) => Tree::Building(job),
            Err(error) => {
                self.error = Some(format!("No thread for building the HDLOD tree: {error}"));
                Tree::Stopped
            }
        };
    }

    /// Writes a new tree into the cache on a thread of its own: nobody waits for it, and where it
    /// does not come to its end the tree is built again the next time.
    pub(super) fn keep(&mut self, mut baked: Baked) {
        if !baked.from_cache {
            let work = move || baked.keep();
            let thread = std::thread::Builder::new().name("topout-cache".to_owned()).spawn(work);
            self.keeping.extend(thread.ok().map(|thread| Keeping(Some(thread))));
        }
    }

    fn panel_mut(&mut self, panel: Panel) -> &mut bool {
        match panel {
            Panel::Gantt => &mut self.panels.gantt,
            Panel::Tree => &mut self.panels.tree,
            Panel::Curves => &mut self.panels.curves,
            Panel::Palette => &mut self.panels.palette,
            Panel::Export => &mut self.panels.export,
            Panel::Viewpoints => &mut self.panels.viewpoints,
            Panel::Section => &mut self.panels.section,
            Panel::Inspector => &mut self.panels.inspector,
            Panel::Timeline => &mut self.panels.timeline,
            Panel::Figures => &mut self.panels.figures,
            Panel::Graph => &mut self.panels.graph,
            Panel::Sun => &mut self.panels.sun,
            Panel::Diagnostics => &mut self.panels.diagnostics,
            Panel::Table => &mut self.panels.table,
            Panel::Shortcuts => &mut self.panels.shortcuts,
            Panel::About => &mut self.panels.about,
        }
    }

    /// The calendar of the shown project.
    pub fn calendar(&self) -> Option<&Calendar> {
        self.project.as_ref().map(|p| &p.calendar)
    }
}

#[cfg(test)]
mod tests;
