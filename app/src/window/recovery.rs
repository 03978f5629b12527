//! What was not saved is kept: how a project was looked at, for when it is opened again.
//!
//! A recovery file is a project file under a name made of the files that it belongs to. Of a project with a
//! name of its own it says what that file held; where the file was changed since, the file is right.

use super::project_file::{self, EXTENSION, Recovers, Saved};
use super::state::AppState;
use crate::output::film::write_whole;
use crate::project::{Request, Source};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Files that are kept; the oldest go first.
const KEPT: usize = 100;

/// A short text that differs where the bytes differ (FNV-1a, 64 bits).
pub fn digest(bytes: &[u8]) -> String {
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
}

/// The folder of recovery files.
#[derive(Clone, Debug)]
pub struct Recovery {
    folder: PathBuf,
    /// The file that was written last, and the digest of its text.
    written: Option<(PathBuf, String)>,
}

impl Recovery {
    /// In a folder, which need not exist.
    pub fn new(folder: PathBuf) -> Self {
        Self { folder, written: None }
    }

    /// In the user's folder for data of programs; `None` where the system has none.
    pub fn user() -> Option<Self> {
        let folders = directories::ProjectDirs::from("", "", "topout")?;
        Some(Self::new(folders.data_local_dir().join("recovery")))
    }

    fn file(&self, of: &str) -> PathBuf {
        self.folder.join(digest(of.as_bytes())).with_extension(EXTENSION)
    }

    /// Where a project file's changes are kept.
    fn of_named(&self, file: &Path) -> PathBuf {
        self.file(&format!("named {}", whole(file).display()))
    }

    /// The same of a project without a file of its own.
    fn of_request(&self, request: &Request) -> PathBuf {
        let files = request.models.iter().map(|source| match source {
            Source::Demo => Source::DEMO.to_owned(),
            Source::File(path) => whole(path).display().to_string(),
        });
        let beside = request.watched();
        let beside = beside.iter().map(|path| whole(path).display().to_string());
        self.file(&files.chain(beside).collect::<Vec<_>>().join("\n"))
    }

    /// What goes on from a project file that was just read; `None` where nothing does.
    pub(super) fn find_named(
        &self,
        file: &Path,
        request: &Request,
        saved: &Saved,
    ) -> Option<(Request, Saved)> {
        let (kept, mut later) = read(&self.of_named(file))?;
        let held = |saved: &Saved| saved.named.as_ref().map(|named| named.held.clone());
        if held(&later) != held(saved) {
            return None;
        }
        later.unsaved = later.differs(saved) || !same_files(&kept, request);
        later.named.clone_from(&saved.named);
        Some((kept, later))
    }

    /// How a project without a file of its own was left.
    pub(super) fn find(&self, request: &Request) -> Option<Saved> {
        let (_, saved) = read(&self.of_request(request))?;
        saved.named.is_none().then_some(saved)
    }

    /// Writes a file if it is not what was written last.
    fn write(&mut self, path: PathBuf, text: &str) -> Option<PathBuf> {
        let written = Some((path.clone(), digest(text.as_bytes())));
        if self.written == written && path.exists() {
            return Some(path);
        }
        let made = std::fs::create_dir_all(&self.folder).map_err(anyhow::Error::from);
        if let Err(error) = made.and_then(|()| Ok(write_whole(&path, text.as_bytes())?)) {
            tracing::warn!("what is not saved cannot be kept: {error:#}");
            return None;
        }
        self.written = written;
        self.tidy();
        Some(path)
    }

    /// Only the latest files stay.
    fn tidy(&self) {
        let Ok(files) = std::fs::read_dir(&self.folder) else { return };
        let mut files: Vec<(SystemTime, PathBuf)> = files
            .flatten()
            .filter(|file| file.path().extension().is_some_and(|end| end == EXTENSION))
            .filter_map(|file| Some((file.metadata().ok()?.modified().ok()?, file.path())))
            .collect();
        files.sort_unstable();
        for (_, file) in files.iter().rev().skip(KEPT) {
            // It goes the next time.
            let _ = std::fs::remove_file(file);
        }
    }
}

fn whole(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// `None` where there is nothing, or nothing that can be read: then nothing is restored.
fn read(path: &Path) -> Option<(Request, Saved)> {
    path.exists()
        .then(|| project_file::read(path))?
        .map_err(|error| tracing::warn!("{error:#}"))
        .ok()
}

/// Whether two requests name the same files, however they are written, and read them alike.
fn same_files(a: &Request, b: &Request) -> bool {
    let clean = |path: &Path| path.canonicalize().unwrap_or_else(|_| whole(path));
    let clean = |request: &Request| Request {
        models: (request.models.iter())
            .map(|source| match source {
                Source::Demo => Source::Demo,
                Source::File(path) => Source::File(clean(path)),
            })
            .collect(),
        schedules: request.schedules.iter().map(|path| clean(path)).collect(),
        rules: request.rules.as_ref().map(|path| clean(path)),
        paths: request.paths.iter().map(|path| clean(path)).collect(),
        ..request.clone()
    };
    clean(a) == clean(b)
}

impl AppState {
    /// Keeps what is not saved; the file that it is in now. Nothing where no folder is set, nothing is shown, or
    /// it cannot be written.
    pub fn keep_unsaved(&mut self) -> Option<PathBuf> {
        let recovery = self.closing.recovery.as_ref()?;
        let request = &self.project.as_ref()?.request;
        let (path, recovers) = match (&self.project_file, &self.closing.kept) {
            (Some(file), Some(kept)) => (
                recovery.of_named(file),
                Some(Recovers { file: whole(file), held: kept.held.clone() }),
            ),
            _ => (recovery.of_request(request), Some(Recovers::default())),
        };
        let text = self.project_text(&path, recovers)?;
        self.closing.recovery.as_mut()?.write(path, &text)
    }

    /// What is not saved is not to be kept.
    pub(super) fn forget_recovery(&mut self) {
        let Some(recovery) = &mut self.closing.recovery else { return };
        if let Some(file) = &self.project_file {
            // Where there is none, there is nothing to forget.
            let _ = std::fs::remove_file(recovery.of_named(file));
            recovery.written = None;
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::window::{Choose, Close, Command, ElementColors, Question, Shown};
    use std::sync::Arc;
    use topout_scene::{Element, ElementId, Model, Scene, link};
    use topout_schedule::{Activity, Column, DateSet, Schedule, Time};

    fn time(text: &str) -> Time {
        Time::parse_iso(text).unwrap()
    }

    fn scene() -> Arc<Scene> {
        let element = |name: &str| Element { name: name.to_owned(), ..Element::default() };
        let elements = ["a", "b", "c"].map(element).to_vec();
        let (start, end) = (Some(time("2026-03-01")), Some(time("2026-09-01")));
        let activity = Activity { id: "A".to_owned(), start, end, ..Activity::default() };
        let schedule = Schedule::new(String::new(), None, vec![activity], Default::default());
        Arc::new(link::link(Model { elements, ..Model::default() }, schedule))
    }

    fn request(folder: &Path) -> Request {
        Request {
            models: vec![Source::File(folder.join("a.glb"))],
            schedules: vec![folder.join("plan.csv")],
            columns: vec![("Begin".to_owned(), Column::Start)],
            dates: Some(DateSet::Baseline),
            ..Request::default()
        }
    }

    /// A window that shows a request as it was left, as loading does.
    fn opened(folder: &Path, request: &Request) -> AppState {
        let mut state = AppState::new(Arc::new(|| ()));
        state.closing.recovery = Some(Recovery::new(folder.join("recovery")));
        state.saved = state.closing.recovery.as_ref().unwrap().find(request);
        state.show_scene(request.clone(), scene());
        state
    }

    /// The same of a project file.
    fn opened_file(folder: &Path, file: &Path) -> AppState {
        let mut state = AppState::new(Arc::new(|| ()));
        let recovery = Recovery::new(folder.join("recovery"));
        let (request, saved) = project_file::read(file).unwrap();
        let later = recovery.find_named(file, &request, &saved);
        let (request, saved) = later.unwrap_or((request, saved));
        state.saved = Some(saved);
        state.closing.recovery = Some(recovery);
        state.show_scene(request, scene());
        state
    }

    fn hide(state: &mut AppState, element: u32) {
        state.apply(Command::Choose(Choose::Only, vec![ElementId(element)]));
        state.apply(Command::DrawSelection(Shown::Hidden));
    }

    #[test]
    fn what_was_never_saved_comes_back_silently() {
        let folder = tempfile::tempdir().unwrap();
        let request = request(folder.path());
        let mut left = opened(folder.path(), &request);
        hide(&mut left, 1);
        left.apply(Command::JumpTo(time("2026-05-06T07:00")));
        left.apply(Command::ColorBy(ElementColors::Type));
        left.apply(Command::ToggleParallel);
        left.apply(Command::SaveViewpoint);
        assert!(!left.is_unsaved() && left.may_close(), "nobody is asked");
        let file = left.keep_unsaved().unwrap();
        let stamp = || std::fs::metadata(&file).unwrap().modified().unwrap();
        let written = stamp();
        assert_eq!(left.keep_unsaved().unwrap(), file);
        assert_eq!(stamp(), written, "the same is not written again");

        let came = opened(folder.path(), &request);
        assert_eq!((came.camera, came.time()), (left.camera, left.time()));
        assert_eq!((came.colors, came.viewpoints.len()), (left.colors, 1));
        assert_eq!(came.shown(ElementId(1)), Shown::Hidden);
        assert_eq!((came.project_file.clone(), came.news.clone()), (None, None));
        assert!(!came.is_unsaved());

        // Another schedule makes another project.
        let other = Request { schedules: Vec::new(), ..request };
        assert_eq!(opened(folder.path(), &other).viewpoints.len(), 0);
    }

    #[test]
    fn changes_to_a_file_are_asked_about_and_come_back_after_a_crash() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.topout");
        let mut first = opened(folder.path(), &request(folder.path()));
        first.apply(Command::SaveProject);
        assert_eq!((first.error.clone(), first.title()), (None, "a.topout – topout".to_owned()));

        // Where one looks from is kept without a question.
        first.apply(Command::JumpTo(time("2026-04-05")));
        first.apply(Command::ColorBy(ElementColors::Storey));
        assert!(!first.is_unsaved());
        first.keep_unsaved().unwrap();
        let mut again = opened_file(folder.path(), &file);
        assert_eq!((again.time(), again.colors), (time("2026-04-05"), ElementColors::Storey));
        assert_eq!((again.is_unsaved(), again.news.clone()), (false, None));
        let request = &again.project.as_ref().unwrap().request;
        assert_eq!(request.columns, [("Begin".to_owned(), Column::Start)]);
        assert_eq!(request.dates, Some(DateSet::Baseline));

        // What was made is a change until it is saved or taken back.
        hide(&mut again, 2);
        assert!(again.is_unsaved() && again.title().starts_with('●'));
        again.apply(Command::Undo);
        assert!(!again.is_unsaved());
        again.apply(Command::Redo);
        assert!(!again.may_close());
        assert_eq!(again.closing.question, Question::Asked);
        again.apply(Command::AnswerClose(Close::Cancel));
        assert_eq!((again.closing.question, again.effects.len()), (Question::None, 0));
        again.keep_unsaved().unwrap();
        drop(again);
        let mut after = opened_file(folder.path(), &file);
        assert!(after.is_unsaved() && after.news.as_ref().unwrap().contains("not saved"));
        assert_eq!(after.shown(ElementId(2)), Shown::Hidden);
        assert!(!after.may_close());
        after.apply(Command::AnswerClose(Close::Save));
        assert!(after.may_close() && !after.is_unsaved());
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains("\"c\"") && text.contains("start=Begin"), "{text}");
        assert!(!text.contains("recovers"));

        // What is discarded stays away, and a file that somebody else changed is right.
        let mut away = opened_file(folder.path(), &file);
        hide(&mut away, 0);
        away.keep_unsaved().unwrap();
        let theirs = text.replace("\"c\"", "\"b\"");
        std::fs::write(&file, &theirs).unwrap();
        let newer = opened_file(folder.path(), &file);
        let shown = [0, 1, 2].map(|i| newer.shown(ElementId(i)));
        assert_eq!(shown, [Shown::Whole, Shown::Hidden, Shown::Whole]);
        std::fs::write(&file, &text).unwrap();
        assert!(!away.may_close());
        away.apply(Command::AnswerClose(Close::Discard));
        assert!(away.may_close() && away.keep_unsaved().is_none());
        let came = opened_file(folder.path(), &file);
        assert_eq!((came.shown(ElementId(0)), came.is_unsaved()), (Shown::Whole, false));
        assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
    }

    #[test]
    fn what_cannot_be_read_or_written_stops_nothing_and_old_files_go() {
        let folder = tempfile::tempdir().unwrap();
        let request = request(folder.path());
        let mut left = opened(folder.path(), &request);
        let file = left.keep_unsaved().unwrap();
        std::fs::write(&file, "{").unwrap();
        let came = opened(folder.path(), &request);
        assert_eq!((came.error.clone(), came.viewpoints.len()), (None, 0));

        std::fs::write(folder.path().join("no-folder"), "").unwrap();
        left.closing.recovery = Some(Recovery::new(folder.path().join("no-folder")));
        assert_eq!(left.keep_unsaved(), None);

        let many = folder.path().join("many");
        std::fs::create_dir(&many).unwrap();
        for i in 0..KEPT + 20 {
            std::fs::write(many.join(format!("{i}.topout")), "").unwrap();
        }
        left.closing.recovery = Some(Recovery::new(many.clone()));
        let kept = left.keep_unsaved().unwrap();
        assert_eq!(std::fs::read_dir(many).unwrap().count(), KEPT);
        assert!(kept.exists(), "the latest stays");
    }

    #[test]
    fn a_recovery_file_can_be_opened_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let mut left = opened(folder.path(), &request(folder.path()));
        let file = left.keep_unsaved().unwrap();
        let (again, saved) = project_file::read(&file).unwrap();
        assert_eq!(
            (again.models, saved.named),
            (left.project.as_ref().unwrap().request.models.clone(), None)
        );
        left.apply(Command::SaveProject);
        hide(&mut left, 0);
        let file = left.keep_unsaved().unwrap();
        let (_, saved) = project_file::read(&file).unwrap();
        assert_eq!(saved.named.unwrap().file, folder.path().join("a.topout"));
        assert!(saved.unsaved);
    }
}
