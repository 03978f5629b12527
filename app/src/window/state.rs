//! What the window shows, and the one place that changes it.

use super::calendar::{Calendar, DAY};
use super::camera::Camera;
use super::command::{Command, Panel};
use super::frames::FrameLog;
use super::loading::{Answer, Ask, Job, Loaded, Outcome, Project, Stamp, Wake, ask, save};
use super::reload::{Refining, TreeChange};
use super::shown::{ElementColors, Panels};
use super::table::Table;
use super::theme::Scheme;
use crate::bench::export::Format;
use crate::project::{self, Request, Source};
use crate::report::describe;
use crate::tree::Baked;
use glam::{UVec2, Vec3};
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use topout_render::{DrawMode, Sun};
use topout_scene::cache::Cache;
use topout_scene::{Cancelled, ElementId, Hdlod, NamedView, Scene, hdlod};
use topout_schedule::{Time, TimeRange};

/// Speeds that are offered, days a second.
pub const SPEEDS: [u32; 7] = [1, 2, 7, 14, 30, 60, 120];

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
    dialog: Option<Job<Answer>>,
    /// Schedules that were opened before any model.
    pub waiting_schedules: Vec<PathBuf>,
    /// What went wrong last: file, place and value.
    pub error: Option<String>,
    /// What happened last to the schedule, or to a file that was saved.
    pub news: Option<String>,

    /// Seconds since 1970-01-01T00:00:00, with the fraction that playing needs.
    clock: f64,
    /// Whether time runs.
    pub playing: bool,
    /// Days a second.
    pub speed: u32,

    /// Where one looks from.
    pub camera: Camera,
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
    /// Playing leaves out when nobody works.
    pub skip_idle: bool,
    /// Where the light comes from.
    pub sun: Sun,
    /// Whether levels fade into each other.
    pub fade: bool,
    /// The selected element.
    pub selected: Option<ElementId>,

    /// Figures of the last frames.
    pub frames: FrameLog,
    /// Which panels are unfolded.
    pub panels: Panels,
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
            dialog: None,
            waiting_schedules: Vec::new(),
            error: None,
            news: None,
            clock: 0.0,
            playing: false,
            speed: 30,
            camera: Camera::fit_named(&Default::default(), NamedView::Iso, picture),
            picture,
            fitted: true,
            mode: DrawMode::Hdlod,
            tolerance_px: 1.0,
            level_colors: false,
            colors: ElementColors::Activity,
            skip_idle: false,
            sun: Sun::Fixed,
            fade: false,
            selected: None,
            frames: FrameLog::default(),
            panels: Panels::default(),
            scheme: Scheme::default(),
            table: Table::default(),
            effects: Vec::new(),
        }
    }

    /// The shown date.
    pub fn time(&self) -> Time {
        Time::from_seconds(self.clock.floor() as i64)
    }

    /// The period that the timeline spans.
    pub fn period(&self) -> TimeRange {
        self.project.as_ref().map(|p| p.calendar.period()).unwrap_or_default()
    }

    /// Whether some thread is at work whose result will change what is shown.
    pub fn is_busy(&self) -> bool {
        self.loading.is_some()
            || matches!(self.tree, Tree::Building(_))
            || self.refining.is_some()
            || self.dialog.is_some()
            || self.table.is_measuring()
    }

    /// How the scene can be drawn now: in full detail until the tree is ready.
    pub fn effective_mode(&self) -> DrawMode {
        match (&self.tree, self.mode) {
            (Tree::Ready(_), mode) => mode,
            (_, DrawMode::Hdlod) => DrawMode::Batched,
            (_, mode) => mode,
        }
    }

    /// Carries out one command.
    pub fn apply(&mut self, command: Command) {
        match command {
            Command::OpenModel => self.ask(Ask::Models),
            Command::OpenSchedule => self.ask(Ask::Schedules),
            Command::OpenDemo => self.load(Request::demo()),
            Command::Load(request) => self.load(request),
            Command::OpenFiles(paths) => self.open_files(paths),
            Command::ReloadSchedule => self.reload_schedule(),
            Command::CancelLoading => self.loading = None,
            Command::DismissNews => self.news = None,
            Command::Report(error) => self.error = Some(error),
            Command::DismissError => self.error = None,
            Command::Quit => self.effects.push(Effect::Close),

            Command::TogglePlay => self.toggle_play(),
            Command::ToggleSkipIdle => self.skip_idle = !self.skip_idle,
            Command::StepDays(days) => {
                self.playing = false;
                self.set_clock(self.clock + (days * DAY) as f64);
            }
            Command::JumpTo(time) => self.set_clock(time.seconds() as f64),
            Command::ToStart => self.set_clock(self.period().start.seconds() as f64),
            Command::ToEnd => {
                self.playing = false;
                self.set_clock(self.period().end.seconds() as f64);
            }
            Command::SetSpeed(days) => self.speed = days.max(1),
            Command::Faster => {
                let next = SPEEDS.iter().find(|s| **s > self.speed);
                self.speed = next.copied().unwrap_or(self.speed);
            }
            Command::Slower => {
                let next = SPEEDS.iter().rev().find(|s| **s < self.speed);
                self.speed = next.copied().unwrap_or(self.speed);
            }

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
            Command::ToggleActivityColors => self.toggle_colors(ElementColors::Activity),
            Command::ToggleSlipColors => self.toggle_colors(ElementColors::Slip),
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

            Command::Fit => self.fit(),
            Command::FitSelection => self.fit_selection(),
            Command::LookFrom(named) => self.look_from(named),
            Command::MoveCamera(camera) => self.move_camera(camera),
            Command::Select(element) => self.selected = element,
            Command::Attach(element, activity) => self.link_by_hand(element, activity, true),
            Command::Detach(element, activity) => self.link_by_hand(element, activity, false),

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

    fn toggle_colors(&mut self, wanted: ElementColors) {
        let off = self.colors == wanted;
        self.colors = if off { ElementColors::Own } else { wanted };
    }

    /// Goes on to when somebody works, if nights and days off are left out.
    fn skip_to_work(&mut self) {
        let Some(project) = self.project.as_ref().filter(|_| self.skip_idle) else { return };
        let Some(calendar) = project.scene.schedule.work_calendar() else { return };
        match calendar.next_work(self.time()) {
            Some(next) if next > self.time() => self.set_clock(next.seconds() as f64),
            Some(_) => {}
            None => self.set_clock(self.period().end.seconds() as f64),
        }
    }

    /// Lets time run on by `seconds` of the user's time.
    pub fn advance(&mut self, seconds: f64) {
        if !self.playing {
            return;
        }
        self.set_clock(self.clock + seconds * f64::from(self.speed) * DAY as f64);
        self.skip_to_work();
        if self.time() >= self.period().end {
            self.playing = false;
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
        self.poll_refining();
        self.poll_watching();
        self.keeping.retain(Keeping::is_going_on);
        self.table.poll();
    }

    /// Shows a scene that is already in memory, as if it had been loaded by `request`.
    pub fn show_scene(&mut self, request: Request, scene: Arc<Scene>) {
        self.show(Project::new(request, scene));
    }

    /// The 3D view has this size; a camera that nobody moved since a fit fits again.
    pub fn set_picture(&mut self, size: UVec2) {
        if size != self.picture {
            self.picture = size;
            if self.fitted {
                self.fit();
            }
        }
    }

    fn move_camera(&mut self, camera: Camera) {
        if camera != self.camera {
            self.camera = camera;
            self.fitted = false;
        }
    }

    /// How far from a point the eye may go, metres.
    pub fn far_limit(&self) -> f32 {
        self.project.as_ref().map_or(1e3, |p| p.focus.diameter().max(1.0) * 40.0)
    }

    /// The point of a present element under a pixel.
    pub fn pick(&self, pixel: glam::Vec2) -> Option<(ElementId, Vec3)> {
        let project = self.project.as_ref()?;
        let direction = self.camera.ray(pixel, self.picture);
        let hit = project.picker.pick(&project.scene, self.camera.eye, direction, self.time())?;
        Some((hit.element, hit.point))
    }

    fn show(&mut self, project: Project) {
        let same_models =
            self.project.as_ref().is_some_and(|p| p.request.models == project.request.models);
        self.project = Some(Arc::new(project));
        self.selected = None;
        self.playing = false;
        self.error = None;
        self.news = None;
        self.refining = None;
        self.waiting_schedules.clear();
        self.frames.clear();
        self.table.reset();
        self.watch();
        if same_models {
            self.hold_clock();
        } else {
            self.apply(Command::ToEnd);
            self.look_from(NamedView::Iso);
        }
        self.build_tree();
    }

    /// Keeps the date within the period.
    pub(super) fn hold_clock(&mut self) {
        self.set_clock(self.clock);
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

    pub(super) fn load(&mut self, request: Request) {
        let names: Vec<String> = request.models.iter().map(name_of).collect();
        self.start_loading(names.join(", "), move |progress| {
            Ok(Loaded::Project(Box::new(Project::load(request, progress)?)))
        });
    }

    /// Loads on a thread of its own, in place of what is being loaded.
    pub(super) fn start_loading(
        &mut self,
        what: String,
        work: impl FnOnce(&topout_scene::Progress) -> anyhow::Result<Loaded> + Send + 'static,
    ) {
        self.error = None;
        match Job::spawn("topout-load", Arc::clone(&self.wake), work) {
            Ok(job) => self.loading = Some((what, job)),
            Err(error) => self.error = Some(format!("No thread for loading {what}: {error}")),
        }
    }

    fn ask(&mut self, what: Ask) {
        if self.dialog.is_none() {
            self.take_dialog(ask(what, Arc::clone(&self.wake)));
        }
    }

    fn save_table(&mut self, format: Format) {
        let Some(export) = self.table.export().filter(|_| self.dialog.is_none()) else { return };
        match export.text(format) {
            Ok(text) => self.take_dialog(save(format, text, Arc::clone(&self.wake))),
            Err(error) => self.error = Some(describe(&error)),
        }
    }

    fn take_dialog(&mut self, dialog: std::io::Result<Job<Answer>>) {
        match dialog {
            Ok(job) => self.dialog = Some(job),
            Err(error) => self.error = Some(format!("No thread for the dialog: {error}")),
        }
    }

    fn poll_dialog(&mut self) {
        let Some(job) = &self.dialog else { return };
        let answer = match job.poll() {
            Outcome::Pending => return,
            Outcome::Done(answer) => answer,
            Outcome::Died => Answer::NoDialog("The file dialog died."),
        };
        self.dialog = None;
        match answer {
            Answer::Chosen(paths) => self.open_files(paths),
            Answer::Closed => {}
            Answer::Saved(Ok(path)) => self.news = Some(format!("Saved to {}", path.display())),
            Answer::Saved(Err(error)) => self.error = Some(describe(&error)),
            Answer::NoDialog(instead) => self.error = Some(instead.to_owned()),
        }
    }

    /// Models replace the project; schedules alone replace the schedule of the shown models, rules their links,
    /// and paths what moves.
    fn open_files(&mut self, files: Vec<PathBuf>) {
        let (mut models, mut schedules) = (Vec::new(), Vec::new());
        let (mut rules, mut paths) = (None, Vec::new());
        for path in files {
            let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
            match extension.as_deref() {
                Some("glb" | "gltf") => models.push(Source::File(path)),
                Some("json") if project::says(&path, "topout-rules") => rules = Some(path),
                Some("json") if project::says(&path, "topout-paths") => paths.push(path),
                Some("json" | "csv" | "xml" | "xer" | "ifc") => schedules.push(path),
                _ => {
                    self.error = Some(format!(
                        "{}: not a file that topout opens. Models are .glb or .gltf, \
                         schedules are .json, .csv, .xml, .xer or .ifc.",
                        path.display()
                    ));
                    return;
                }
            }
        }
        let beside = rules.is_some() || !paths.is_empty();
        if models.is_empty() && schedules.is_empty() && !beside {
            return;
        }
        let mut shown = self.project.as_ref().map(|p| p.request.clone());
        if beside {
            let request = shown.get_or_insert_default();
            if models.is_empty() && request.models.is_empty() {
                self.error = Some("Rules and paths need a model: open it first.".to_owned());
                return;
            }
            request.rules = rules.or_else(|| request.rules.take());
            request.paths.append(&mut paths);
        }
        if models.is_empty() {
            match shown {
                Some(shown) if schedules.is_empty() => self.load_schedule(shown),
                Some(shown) => self.load_schedule(Request { schedules, ..shown }),
                None => self.waiting_schedules = schedules,
            }
            return;
        }
        if schedules.is_empty() {
            schedules = std::mem::take(&mut self.waiting_schedules);
        }
        self.load(Request { models, schedules, ..shown.unwrap_or_default() });
    }

    fn toggle_play(&mut self) {
        self.playing = !self.playing && self.period().seconds() > 0;
        if self.playing && self.time() >= self.period().end {
            self.apply(Command::ToStart);
        }
    }

    fn set_clock(&mut self, seconds: f64) {
        let period = self.period();
        let (start, end) = (period.start.seconds() as f64, period.end.seconds() as f64);
        self.clock = seconds.max(start).min(end.max(start));
    }

    fn fit(&mut self) {
        if let Some(project) = &self.project {
            self.camera = self.camera.fit(&project.focus, self.picture);
            self.fitted = true;
        }
    }

    fn fit_selection(&mut self) {
        if let (Some(project), Some(element)) = (&self.project, self.selected) {
            let bounds = project.scene.model.elements[element.index()].bounds;
            if !bounds.is_empty() {
                // Some of its surroundings help to see where it is.
                let around = bounds.grown(bounds.diameter().max(0.5) * 0.5);
                self.move_camera(self.camera.fit(&around, self.picture));
            }
        }
    }

    fn look_from(&mut self, named: NamedView) {
        if let Some(project) = &self.project {
            self.camera = Camera::fit_named(&project.focus, named, self.picture);
            self.fitted = true;
        }
    }

    fn panel_mut(&mut self, panel: Panel) -> &mut bool {
        match panel {
            Panel::Inspector => &mut self.panels.inspector,
            Panel::Timeline => &mut self.panels.timeline,
            Panel::Figures => &mut self.panels.figures,
            Panel::Graph => &mut self.panels.graph,
            Panel::Sun => &mut self.panels.sun,
            Panel::Diagnostics => &mut self.panels.diagnostics,
            Panel::Table => &mut self.panels.table,
            Panel::Shortcuts => &mut self.panels.shortcuts,
        }
    }

    /// The calendar of the shown project.
    pub fn calendar(&self) -> Option<&Calendar> {
        self.project.as_ref().map(|p| &p.calendar)
    }
}

/// A file's name without its folder.
fn name_of(source: &Source) -> String {
    match source {
        Source::Demo => "the demo project".to_owned(),
        Source::File(path) => path
            .file_name()
            .map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned()),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use topout_schedule::Schedule;

    fn state() -> AppState {
        AppState::new(Arc::new(|| ()))
    }

    fn day(day: i64) -> Time {
        Time::from_seconds(day * DAY)
    }

    /// A hundred days without elements.
    fn with_period() -> AppState {
        let period = TimeRange { start: day(0), end: day(100) };
        let schedule = Schedule { period, ..Schedule::default() };
        let scene = Scene { schedule, activity_starts: vec![0], ..Scene::default() };
        let mut state = state();
        state.show_scene(Request::demo(), Arc::new(scene));
        state
    }

    #[test]
    fn time_is_held_within_the_period() {
        let mut state = with_period();
        assert_eq!(state.time(), day(100), "a new project shows everything");
        for (command, expected) in [
            (Command::StepDays(1), day(100)),
            (Command::StepDays(-7), day(93)),
            (Command::JumpTo(Time::MIN), day(0)),
            (Command::JumpTo(Time::MAX), day(100)),
            (Command::ToStart, day(0)),
            (Command::StepDays(-1), day(0)),
            (Command::ToEnd, day(100)),
        ] {
            state.apply(command.clone());
            assert_eq!(state.time(), expected, "{command:?}");
        }
    }

    #[test]
    fn playing_runs_at_its_speed_and_stops_at_the_end() {
        let mut state = with_period();
        state.apply(Command::SetSpeed(30));
        state.apply(Command::TogglePlay);
        assert_eq!(state.time(), day(0), "at the end, playing starts over");
        for _ in 0..10 {
            state.advance(0.1);
        }
        let error = state.time().seconds() - day(30).seconds();
        assert!(error.abs() <= 1, "small steps add up to 30 days, {error} s off");
        state.advance(10.0);
        assert!(!state.playing);
        assert_eq!(state.time(), day(100));
        state.advance(1.0);
        assert_eq!(state.time(), day(100));
    }

    #[test]
    fn playing_can_leave_out_nights_and_days_off() {
        let mut state = state();
        let text = r#"{"calendars": [{"week": {"mon": ["08:00-12:00"], "wed": ["08:00-12:00"]}}],
            "calendar": 0, "activities": [{"id": "A", "start": "2026-11-23", "end": "2026-12-02"}]}"#;
        let options = topout_schedule::ReadOptions::default();
        let schedule =
            topout_schedule::read_bytes("a.json".as_ref(), text.as_bytes(), &options).unwrap();
        let scene = topout_scene::link::link(topout_scene::Model::default(), schedule);
        state.show_scene(Request::demo(), Arc::new(scene));
        let at = |text: &str| Time::parse_iso(text).unwrap();
        state.apply(Command::SetSpeed(1));
        state.apply(Command::TogglePlay);
        state.advance(0.25);
        assert_eq!(state.time(), at("2026-11-23T06:00:00"));
        state.apply(Command::ToggleSkipIdle);
        state.advance(0.0);
        assert_eq!(state.time(), at("2026-11-23T08:00:00"));
        state.advance(0.25);
        assert_eq!(state.time(), at("2026-11-25T08:00:00"), "a Wednesday");
        state.advance(0.125);
        assert_eq!(state.time(), at("2026-11-25T11:00:00"), "while somebody works time runs on");
        state.advance(0.125);
        assert_eq!(state.time(), at("2026-11-30T08:00:00"));
        // Scrubbing shows what it is asked for.
        state.apply(Command::JumpTo(at("2026-11-29T03:00:00")));
        assert_eq!(state.time(), at("2026-11-29T03:00:00"));
        state.apply(Command::JumpTo(at("2026-12-02T12:00:00")));
        state.advance(0.001);
        assert!(!state.playing && state.time() == state.period().end);
    }

    #[test]
    fn nothing_plays_without_a_period() {
        let mut state = state();
        state.apply(Command::TogglePlay);
        assert!(!state.playing);
    }

    #[test]
    fn speeds_and_tolerance_stay_in_range() {
        let mut state = state();
        for _ in 0..20 {
            state.apply(Command::Faster);
        }
        assert_eq!(Some(&state.speed), SPEEDS.last());
        for _ in 0..20 {
            state.apply(Command::Slower);
        }
        assert_eq!(Some(&state.speed), SPEEDS.first());
        for (asked, got) in [(2.0, 2.0), (-1.0, *TOLERANCE.start()), (1e9, *TOLERANCE.end())] {
            state.apply(Command::SetTolerance(asked));
            assert_eq!(state.tolerance_px, got);
        }
        state.apply(Command::SetTolerance(f32::NAN));
        assert_eq!(state.tolerance_px, *TOLERANCE.end());
    }

    #[test]
    fn another_schedule_for_the_same_models_keeps_camera_and_date() {
        let mut state = with_period();
        let moved = state.camera.orbit(Vec3::ZERO, 0.5, 0.1);
        state.apply(Command::MoveCamera(moved));
        state.apply(Command::JumpTo(day(40)));
        let scene = Arc::clone(&state.project.as_ref().unwrap().scene);
        let request = Request { schedules: vec!["plan.json".into()], ..Request::demo() };
        state.show_scene(request, Arc::clone(&scene));
        assert_eq!((state.camera, state.time()), (moved, day(40)));

        let other = Request { models: vec![Source::File("other.glb".into())], ..Request::demo() };
        state.show_scene(other, scene);
        assert_eq!(state.time(), day(100));
        assert_ne!(state.camera, moved);
    }

    #[test]
    fn files_of_other_kinds_are_refused_by_name() {
        let mut state = state();
        state.apply(Command::OpenFiles(vec!["a.GLB".into(), "site.dwg".into()]));
        assert!(state.error.as_ref().unwrap().contains("site.dwg"));
        assert!(state.loading.is_none(), "nothing is opened halfway");
        state.apply(Command::OpenFiles(vec!["plan.CSV".into(), "links.csv".into()]));
        assert_eq!(state.waiting_schedules.len(), 2, "schedules wait for their model");
    }
}
