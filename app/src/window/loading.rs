//! Work on named threads: loading a project, building the tree, measuring, asking for files.

use super::calendar::Calendar;
use super::gantt::Plan;
use super::reload::Edit;
use crate::bench::export::Format;
use crate::estimate::{Estimate, left_text};
use crate::output::film::write_whole;
use crate::project::{self, Request};
use crate::report::write_file;
use anyhow::Context as _;
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{self, TryRecvError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};
use topout_scene::pick::Picker;
use topout_scene::{Aabb, Looks, Progress, Scene};
use topout_schedule::{DateSet, Network, SCurve, Schedule};

/// Called by a worker when it has something to show.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// One piece of work on a thread of its own. Dropping it asks the thread to stop and does not wait.
pub struct Job<T> {
    thread: Option<JoinHandle<()>>,
    progress: Arc<Progress>,
    result: mpsc::Receiver<T>,
    started: Instant,
    estimate: RefCell<Estimate>,
}

/// What became of a [`Job`].
pub enum Outcome<T> {
    /// Still at work.
    Pending,
    /// Finished.
    Done(T),
    /// The thread died without a result.
    Died,
}

impl<T: Send + 'static> Job<T> {
    /// Starts `work` on a thread called `name`; `wake` is called once when it ends.
    ///
    /// # Errors
    /// When the system has no thread to give.
    pub fn spawn(
        name: &str,
        wake: Wake,
        work: impl FnOnce(&Progress) -> T + Send + 'static,
    ) -> std::io::Result<Self> {
        let progress = Arc::new(Progress::default());
        let (sender, result) = mpsc::sync_channel(1);
        let theirs = Arc::clone(&progress);
        let thread = std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            // Wakes also when the work panics: the sender is gone by then, and the window says so.
            let _wake = WakeOnDrop(wake);
            let value = work(&theirs);
            // The receiver is gone when the user cancelled; then nobody wants the value.
            let _ = sender.send(value);
        })?;
        Ok(Self {
            thread: Some(thread),
            progress,
            result,
            started: Instant::now(),
            estimate: RefCell::default(),
        })
    }

    /// Asks the thread to stop at its next step; [`Job::poll`] tells when it has.
    pub fn cancel(&self) {
        self.progress.cancel();
    }

    /// Asks the thread to stop and waits for it.
    pub fn stop(mut self) {
        self.cancel();
        if let Some(thread) = self.thread.take() {
            // A panic of the thread was reported on standard error; nobody wants its result.
            let _ = thread.join();
        }
    }

    /// Looks without waiting.
    pub fn poll(&self) -> Outcome<T> {
        match self.result.try_recv() {
            Ok(value) => Outcome::Done(value),
            Err(TryRecvError::Empty) => Outcome::Pending,
            Err(TryRecvError::Disconnected) => Outcome::Died,
        }
    }

    /// The current stage and its finished share in [0, 1].
    pub fn state(&self) -> (String, f32) {
        self.progress.state()
    }

    /// The current stage with its share and the time that it will still take, each where it is known, and the
    /// time since the start of all: `HDLOD: level 3 · 40 %, 20 s left · 32 s so far`.
    pub fn told(&self) -> String {
        let ((stage, share), passed) = (self.state(), self.elapsed());
        let mut told = if stage.is_empty() { "Starting".to_owned() } else { stage.clone() };
        if share > 0.0 {
            told.push_str(&format!(" · {:.0} %", share * 100.0));
        }
        if let Some(left) = self.estimate.borrow_mut().update(&stage, share, passed) {
            told.push_str(&format!(", {}", left_text(left)));
        }
        told + &format!(" · {} s so far", passed.as_secs())
    }

    /// Time since the start.
    pub fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }
}

impl<T> Drop for Job<T> {
    fn drop(&mut self) {
        self.progress.cancel();
    }
}

struct WakeOnDrop(Wake);

impl Drop for WakeOnDrop {
    fn drop(&mut self) {
        (self.0)();
    }
}

/// Everything that the window derives from a scene, made on the loading thread.
pub struct Project {
    /// What was asked for.
    pub request: Request,
    /// S(t).
    pub scene: Arc<Scene>,
    /// What activities make elements look like.
    pub looks: Arc<Looks>,
    /// How much earlier or later activities are than planned, where that is known.
    pub slip_looks: Option<Arc<Looks>>,
    /// The kinds of its activities that have a colour.
    pub legend: Vec<(String, [u8; 3])>,
    /// Rays to elements.
    pub picker: Arc<Picker>,
    /// Counts over time.
    pub calendar: Calendar,
    /// Its activities as rows.
    pub plan: Plan,
    /// What its activities wait for.
    pub network: Network,
    /// Planned and actual progress over time.
    pub progress: SCurve,
    /// What the standard views fit.
    pub focus: Aabb,
    /// Triangles of all elements.
    pub triangles: usize,
    /// Elements that some activity touches.
    pub linked: usize,
    /// What the files of the schedule looked like before they were read.
    pub stamps: Vec<Stamp>,
}

/// What loading came to.
pub enum Loaded {
    /// A project of its own.
    Project(Box<Project>),
    /// The shown project with other dates.
    Edit(Box<Edit>),
    /// The shown models with a schedule or rules that differ in more than dates, and how, in words.
    Other(Box<Project>, String),
}

/// Last change and length of a file; `None` where it cannot be looked at.
pub type Stamp = Option<(SystemTime, u64)>;

/// What files look like now.
pub fn stamps(files: &[PathBuf]) -> Vec<Stamp> {
    let stamp = |file: &PathBuf| {
        let data = std::fs::metadata(file).ok()?;
        Some((data.modified().ok()?, data.len()))
    };
    files.iter().map(stamp).collect()
}

/// How often files are looked at, and how long they must have been left alone.
const LOOK_EVERY: Duration = Duration::from_millis(500);

/// Waits until files look other than `known` and are no longer written to; says how they look then.
///
/// # Errors
/// When the system has no thread to give.
pub fn watch(
    files: Vec<PathBuf>,
    known: Vec<Stamp>,
    wake: Wake,
) -> std::io::Result<Job<Vec<Stamp>>> {
    Job::spawn("topout-watch", wake, move |progress| {
        let mut before = known.clone();
        loop {
            std::thread::sleep(LOOK_EVERY);
            let now = stamps(&files);
            // A file that is gone for a moment is being replaced.
            let whole = now == before && now.iter().all(Option::is_some);
            if progress.check().is_err() || (whole && now != known) {
                return now;
            }
            before = now;
        }
    })
}

impl Project {
    /// Derives what the window needs; takes a moment for large scenes.
    pub fn new(request: Request, scene: Arc<Scene>) -> Self {
        Self {
            looks: Arc::new(Looks::of_activities(&scene)),
            slip_looks: slip_looks(&scene),
            picker: Arc::new(Picker::new(&scene)),
            calendar: Calendar::new(&scene.schedule),
            plan: Plan::new(&scene),
            network: Network::new(&scene.schedule),
            progress: SCurve::new(&scene.schedule),
            focus: scene.focus_bounds(),
            triangles: scene.model.triangle_count(),
            linked: linked(&scene),
            legend: legend(&scene),
            stamps: stamps(&request.watched()),
            request,
            scene,
        }
    }

    /// The same with another scene of the same model, whose activities touch the same elements.
    pub fn with_dates(&self, request: Request, scene: Arc<Scene>, stamps: Vec<Stamp>) -> Self {
        Self {
            looks: Arc::new(Looks::of_activities(&scene)),
            slip_looks: slip_looks(&scene),
            picker: Arc::clone(&self.picker),
            calendar: Calendar::new(&scene.schedule),
            plan: Plan::new(&scene),
            network: Network::new(&scene.schedule),
            progress: SCurve::new(&scene.schedule),
            focus: self.focus,
            triangles: self.triangles,
            linked: linked(&scene),
            legend: legend(&scene),
            stamps,
            request,
            scene,
        }
    }

    /// The name to show: the schedule's, the model's, or the first file's.
    pub fn name(&self) -> String {
        let names = [&self.scene.schedule.project, &self.scene.model.name];
        if let Some(name) = names.into_iter().find(|n| !n.is_empty()) {
            return name.clone();
        }
        self.request.models.first().map_or_else(String::new, ToString::to_string)
    }

    /// Reads, links and derives: the whole load.
    ///
    /// # Errors
    /// As [`project::load`].
    pub fn load(request: Request, progress: &Progress) -> anyhow::Result<Self> {
        let stamps = stamps(&request.watched());
        let scene = project::load(&request, progress)?;
        progress.begin("Preparing the window", 0)?;
        Ok(Self { stamps, ..Self::new(request, Arc::new(scene)) })
    }
}

/// Elements that some activity touches.
fn linked(scene: &Scene) -> usize {
    topout_scene::link::report(scene).linked_elements
}

/// The kinds that occur, by their colours while activities last.
fn legend(scene: &Scene) -> Vec<(String, [u8; 3])> {
    let kinds = &scene.schedule.kinds;
    let mut used = vec![false; kinds.iter().count()];
    for activity in &scene.schedule.activities {
        if let Some(used) = used.get_mut(activity.kind.index()) {
            *used = true;
        }
    }
    let kinds = kinds.iter().zip(used).filter(|(_, used)| *used);
    kinds.filter_map(|(kind, _)| Some((kind.name.clone(), kind.during.look().color?))).collect()
}

/// Actual dates beside planned ones, else what an event log says.
fn slip_looks(scene: &Scene) -> Option<Arc<Looks>> {
    Looks::of_differences(scene, DateSet::Planned, DateSet::Actual).map(Arc::new)
}

/// Which files a dialog asks for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Ask {
    /// .glb and .gltf.
    Models,
    /// .json, .csv, .xml, .xer and .ifc.
    Schedules,
    /// One of these, to hold the shown one against.
    Compared,
}

/// What a dialog came back with.
pub enum Answer {
    /// Files.
    Chosen(Vec<PathBuf>),
    /// The place of a file that is to be written.
    Place(PathBuf),
    /// The place of the project file.
    Project(PathBuf),
    /// The schedule to hold the shown one against.
    Compared(PathBuf),
    /// The user closed it.
    Closed,
    /// A file that was written, or why it could not be.
    Saved(anyhow::Result<PathBuf>),
    /// The system has no file dialog; what to do instead.
    NoDialog(&'static str),
}

/// Said when the system has no file dialog.
const NO_OPEN_DIALOG: &str = "This system offers no file dialog: neither a desktop portal \
    (xdg-desktop-portal) nor zenity answers. Install one of them, drop the files on this window, \
    or name them on the command line: topout MODEL --schedule FILE";

/// The same where a table was to be saved.
const NO_SAVE_DIALOG: &str = "This system offers no file dialog: neither a desktop portal \
    (xdg-desktop-portal) nor zenity answers. Install one of them, copy the table, or measure on the \
    command line: topout bench MODEL --schedule FILE --csv FILE --markdown FILE";

/// The same where a schedule was to be saved.
const NO_SCHEDULE_DIALOG: &str = "This system offers no file dialog: neither a desktop portal \
    (xdg-desktop-portal) nor zenity answers. Install one of them to save the schedule.";

/// The same where the project was to be saved.
const NO_PROJECT_DIALOG: &str = "This system offers no file dialog: neither a desktop portal \
    (xdg-desktop-portal) nor zenity answers. Install one of them; File > Save project writes beside \
    the model without asking.";

/// Asks for files without stopping the window.
///
/// # Errors
/// When the system has no thread to give.
pub fn ask(what: Ask, wake: Wake) -> std::io::Result<Job<Answer>> {
    let dialog = match what {
        Ask::Models => rfd::AsyncFileDialog::new()
            .set_title("Open model")
            .add_filter("Models and projects", &["glb", "gltf", "topout"]),
        Ask::Schedules | Ask::Compared => rfd::AsyncFileDialog::new()
            .set_title("Open schedule")
            .add_filter("Schedules and links", &["json", "csv", "xml", "xer", "ifc"]),
    };
    let asked = Instant::now();
    // Some systems insist that dialogs start on the main thread; waiting happens on another.
    let chosen = dialog.pick_files();
    Job::spawn("topout-dialog", wake, move |_| match pollster::block_on(chosen) {
        Some(files) => match (what, files.first()) {
            (Ask::Compared, Some(file)) => Answer::Compared(file.path().to_owned()),
            _ => Answer::Chosen(files.iter().map(|f| f.path().to_owned()).collect()),
        },
        None => no_file(asked, NO_OPEN_DIALOG),
    })
}

/// Asks where the project file is to be.
///
/// # Errors
/// When the system has no thread to give.
pub fn place_project(name: &str, wake: Wake) -> std::io::Result<Job<Answer>> {
    let asked = Instant::now();
    let chosen = rfd::AsyncFileDialog::new()
        .set_title("Save project")
        .add_filter("Projects", &["topout"])
        .set_file_name(name)
        .save_file();
    Job::spawn("topout-dialog", wake, move |_| match pollster::block_on(chosen) {
        Some(file) => Answer::Project(file.path().with_extension("topout")),
        None => no_file(asked, NO_PROJECT_DIALOG),
    })
}

/// Asks for a file and writes the schedule of a scene to it, by its ending as CSV or JSON.
///
/// # Errors
/// When the system has no thread to give.
pub fn save_schedule(scene: Arc<Scene>, wake: Wake) -> std::io::Result<Job<Answer>> {
    let asked = Instant::now();
    let chosen = rfd::AsyncFileDialog::new()
        .set_title("Save schedule")
        .add_filter("topout JSON", &["json"])
        .add_filter("CSV", &["csv"])
        .set_file_name("schedule.json")
        .save_file();
    Job::spawn("topout-dialog", wake, move |_| match pollster::block_on(chosen) {
        Some(file) => Answer::Saved(write_schedule(&scene.schedule, file.path())),
        None => no_file(asked, NO_SCHEDULE_DIALOG),
    })
}

/// Writes a schedule, by the file's ending as CSV or JSON (which is added where there is none).
///
/// # Errors
/// With the file's name.
pub fn write_schedule(schedule: &Schedule, path: &Path) -> anyhow::Result<PathBuf> {
    let path = match path.extension() {
        Some(_) => path.to_owned(),
        None => path.with_extension("json"),
    };
    let csv = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    let mut bytes = Vec::new();
    let made = if csv { schedule.write_csv(&mut bytes) } else { schedule.write_json(&mut bytes) };
    made.with_context(|| format!("cannot write {}", path.display()))?;
    write_whole(&path, &bytes)?;
    Ok(path)
}

/// Asks for a file and writes a table's text to it, without stopping the window.
///
/// # Errors
/// When the system has no thread to give.
pub fn save(format: Format, text: String, wake: Wake) -> std::io::Result<Job<Answer>> {
    let (name, extension) = format.names();
    let asked = Instant::now();
    let chosen = rfd::AsyncFileDialog::new()
        .set_title(format!("Save as {name}"))
        .add_filter(name, &[extension])
        .set_file_name(format!("hdlod.{extension}"))
        .save_file();
    Job::spawn("topout-dialog", wake, move |_| match pollster::block_on(chosen) {
        Some(file) => {
            let path = file.path().to_owned();
            Answer::Saved(write_file(&path, &text).map(|()| path))
        }
        None => no_file(asked, NO_SAVE_DIALOG),
    })
}

/// What a dialog without a file means. Nobody closes one within a moment: then there was none.
fn no_file(asked: Instant, instead: &'static str) -> Answer {
    if asked.elapsed() < Duration::from_millis(400) && !has_zenity() {
        Answer::NoDialog(instead)
    } else {
        Answer::Closed
    }
}

fn has_zenity() -> bool {
    std::env::var_os("PATH")
        .is_some_and(|path| std::env::split_paths(&path).any(|dir| dir.join("zenity").is_file()))
}
