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
