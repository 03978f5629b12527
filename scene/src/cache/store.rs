//! The folder of the cache.

use super::Key;
use super::file::{self, INFO_BYTES, Info, Unusable};
use super::key::MODEL_BYTES;
use crate::{Hdlod, Scene};
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// A folder of trees. Cheap to make; the folder itself is made when the first tree is kept.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Cache {
    folder: PathBuf,
    limit_bytes: u64,
}

/// What [`Cache::find`] came back with.
#[derive(Debug)]
pub enum Found {
    /// The tree, and the bytes of its file.
    Tree(Box<Hdlod>, u64),
    /// There is none.
    Nothing,
    /// There is a file that cannot be used.
    Unusable(Unusable),
}

/// One file of the cache.
#[derive(Clone, PartialEq, Debug)]
pub struct Entry {
    /// The file.
    pub path: PathBuf,
    /// Its length.
    pub bytes: u64,
    /// When a tree was last taken from it, or kept in it.
    pub used: SystemTime,
    /// What it is of, or why it cannot be used.
    pub info: Result<Info, Unusable>,
}

/// Files and their bytes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Total {
    /// How many.
    pub files: u64,
    /// Their lengths together.
    pub bytes: u64,
}

/// Why a tree was not kept, or the folder not read.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The system refused.
    #[error("{path}: {source}")]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// One tree is larger than all trees together may be.
    #[error("a tree of {bytes} bytes is larger than the cache may become ({limit_bytes} bytes)")]
    TooBig {
        /// Bytes of the tree's file.
        bytes: u64,
        /// Bytes that the cache may hold.
        limit_bytes: u64,
    },
}

const EXTENSION: &str = "hdlod";
const UNFINISHED: &str = "unfinished";

/// Trees of one model and one way of building that are kept, those used last: every edit of the
/// schedule makes another one, and a day of planning shall not push out all other projects.
pub const MOST_SCHEDULES: usize = 4;

/// An unfinished file this old belongs to nobody any more.
const ABANDONED: Duration = Duration::from_secs(3600);

impl Cache {
    /// A cache in a folder; all files together stay within `limit_bytes`.
    pub fn new(folder: impl Into<PathBuf>, limit_bytes: u64) -> Self {
        Self { folder: folder.into(), limit_bytes }
    }

    /// Where the files lie.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Bytes that all files together may have.
    pub fn limit_bytes(&self) -> u64 {
        self.limit_bytes
    }

    /// The file of a tree, whether it is there or not.
    pub fn path(&self, key: &Key) -> PathBuf {
        self.folder.join(format!("{key}.{EXTENSION}"))
    }

    /// Takes a tree out of the cache. Whatever is wrong with a file or the folder, it is only a
    /// tree that was not found.
    pub fn find(&self, key: &Key, scene: &Scene) -> Found {
        let Ok(file) = File::open(self.path(key)) else { return Found::Nothing };
        let Ok(bytes) = map(&file) else { return Found::Unusable(Unusable::Foreign) };
        match file::read(&bytes, key, scene) {
            Ok(tree) => {
                // For the order in which files go. A cache that cannot be written still helps.
                let _ = file.set_modified(SystemTime::now());
                Found::Tree(Box::new(tree), bytes.len() as u64)
            }
            Err(unusable) => Found::Unusable(unusable),
        }
    }

    /// Keeps a tree, and lets go of those that were not used for longest where there is no room, and
    /// where there are more than [`MOST_SCHEDULES`] for the same model and settings.
    /// Returns the bytes of its file.
    ///
    /// # Errors
    /// When it cannot be written or is too big; the cache is as it was then.
    pub fn keep(&self, key: &Key, info: &Info, tree: &Hdlod) -> Result<u64, StoreError> {
        let path = self.path(key);
        let failed = |source| StoreError::Io { path: self.folder.clone(), source };
        fs::create_dir_all(&self.folder).map_err(failed)?;
        // The name is random, so that two processes at once do not meet.
        let mut unfinished = tempfile::Builder::new()
            .prefix(&format!("{key}."))
            .suffix(&format!(".{UNFINISHED}"))
            .tempfile_in(&self.folder)
            .map_err(failed)?;
        let mut out = BufWriter::with_capacity(1 << 20, unfinished.as_file_mut());
        let written = file::write(&mut out, key, info, tree).and_then(|()| out.flush());
        drop(out);
        // On disk before it gets its name: a crash must not leave a name without the bytes.
        let file = unfinished.as_file();
        // By the same clock as in `find`: the system's own stamps may lie behind it.
        let stamped = written.and_then(|()| file.set_modified(SystemTime::now()));
        stamped.and_then(|()| file.sync_all()).map_err(failed)?;
        let bytes = unfinished.as_file().metadata().map_err(failed)?.len();
        if bytes > self.limit_bytes {
            return Err(StoreError::TooBig { bytes, limit_bytes: self.limit_bytes });
        }
        unfinished.persist(&path).map_err(|e| StoreError::Io { path, source: e.error })?;
        self.make_room(key);
        Ok(bytes)
    }

    /// All files, the last used first. No folder is an empty one.
    ///
    /// # Errors
    /// When the folder cannot be read.
    pub fn list(&self) -> Result<Vec<Entry>, StoreError> {
        let mut entries: Vec<Entry> = self
            .files(EXTENSION)?
            .into_iter()
            .map(|(path, bytes, used)| Entry { info: describe(&path), path, bytes, used })
            .collect();
        entries.sort_by(|a, b| b.used.cmp(&a.used).then_with(|| a.path.cmp(&b.path)));
        Ok(entries)
    }

    /// Removes all files of the cache, and nothing else in the folder.
    ///
    /// # Errors
    /// When the folder cannot be read, or a file not be removed.
    pub fn clear(&self) -> Result<Total, StoreError> {
        let mut gone = Total::default();
        for (path, bytes, _) in self.files(EXTENSION)?.into_iter().chain(self.files(UNFINISHED)?) {
            match fs::remove_file(&path) {
                Ok(()) => gone = Total { files: gone.files + 1, bytes: gone.bytes + bytes },
                Err(e) if e.kind() == io::ErrorKind::NotFound => {}
                Err(source) => return Err(StoreError::Io { path, source }),
            }
        }
        Ok(gone)
    }

    /// Removes what was not used for longest, first of the same model, then until the rest fits;
    /// never the tree of `newest`.
    /// Files that cannot be removed, or are removed by another process, are left to it.
    fn make_room(&self, newest: &Key) {
        let now = SystemTime::now();
        for (path, _, written) in self.files(UNFINISHED).unwrap_or_default() {
            if now.duration_since(written).is_ok_and(|age| age > ABANDONED) {
                let _ = fs::remove_file(path);
            }
        }
        let mut files = self.files(EXTENSION).unwrap_or_default();
        files.sort_by_key(|(_, _, used)| *used);
        let mut total: u64 = files.iter().map(|(_, bytes, _)| bytes).sum();
        let newest_path = self.path(newest);
        files.retain(|(path, ..)| *path != newest_path);
        let model = &newest.to_string()[..MODEL_BYTES * 2];
        let same_model =
            |path: &Path| path.file_name().is_some_and(|n| n.to_string_lossy().starts_with(model));
        let siblings = files.iter().filter(|(path, ..)| same_model(path)).count();
        let mut too_many = siblings.saturating_sub(MOST_SCHEDULES - 1);
        // Which frees room for other projects, so it comes first.
        files.retain(|(path, bytes, _)| {
            let goes = too_many > 0 && same_model(path) && fs::remove_file(path).is_ok();
            if goes {
                too_many -= 1;
                total -= bytes;
            }
            !goes
        });
        for (path, bytes, _) in files {
            if total <= self.limit_bytes {
                break;
            }
            if fs::remove_file(path).is_ok() {
                total -= bytes;
            }
        }
    }

    /// The files with one extension whose names begin with a key: path, bytes, last change.
    fn files(&self, extension: &str) -> Result<Vec<(PathBuf, u64, SystemTime)>, StoreError> {
        let failed = |source| StoreError::Io { path: self.folder.clone(), source };
        let listing = match fs::read_dir(&self.folder) {
            Ok(listing) => listing,
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            Err(e) => return Err(failed(e)),
        };
        let mut files = Vec::new();
        for entry in listing {
            let entry = entry.map_err(failed)?;
            let name = entry.file_name();
            let Some(name) = name.to_str() else { continue };
            let (stem, rest) = name.split_once('.').unwrap_or((name, ""));
            let key = stem.len() == 64 && stem.bytes().all(|b| b.is_ascii_hexdigit());
            if !key || rest.rsplit('.').next() != Some(extension) {
                continue;
            }
            // A file may be gone by now.
            let Ok(data) = entry.metadata() else { continue };
            if data.is_file() {
                let used = data.modified().unwrap_or(SystemTime::UNIX_EPOCH);
                files.push((entry.path(), data.len(), used));
            }
        }
        Ok(files)
    }
}

/// What the start of a file says.
fn describe(path: &Path) -> Result<Info, Unusable> {
    let mut start = Vec::new();
    File::open(path)
        .and_then(|file| file.take(INFO_BYTES as u64).read_to_end(&mut start))
        .map_err(|_| Unusable::Foreign)?;
    file::read_info(&start)
}

/// The bytes of a file, not read before they are looked at.
fn map(file: &File) -> io::Result<memmap2::Mmap> {
    // SAFETY: the bytes must not change while they are mapped. Files of the cache never do: they
    // are written under another name and replaced or removed as a whole, which leaves the mapped
    // one as it was. Nothing of the map outlives `Cache::find`: what is used later was copied.
    #[allow(unsafe_code)]
    unsafe {
        memmap2::Mmap::map(file)
    }
}
