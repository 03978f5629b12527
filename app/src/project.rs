//! Loading: from the files that a user names to a linked [`Scene`].
//!
//! The command line and the window both load through [`load`], so they show the same thing.

use anyhow::Context;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;
use topout_scene::{Cancelled, Model, Progress, Scene};
use topout_schedule::Schedule;

/// Where a model comes from.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Source {
    /// The built-in skyscraper, with its own schedule.
    Demo,
    /// A .glb or .gltf file.
    File(PathBuf),
}

impl Source {
    /// The word that stands for [`Source::Demo`].
    pub const DEMO: &'static str = "demo";
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Demo => f.write_str(Self::DEMO),
            Self::File(path) => write!(f, "{}", path.display()),
        }
    }
}

impl From<PathBuf> for Source {
    fn from(path: PathBuf) -> Self {
        if path.as_os_str() == Self::DEMO { Self::Demo } else { Self::File(path) }
    }
}

/// A word that is neither a model file nor `demo`.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("neither a .glb or .gltf file nor the word demo, nor a sub-command")]
pub struct NotASource;

impl FromStr for Source {
    type Err = NotASource;

    /// Refuses a bare word that names no file: most likely a misspelt sub-command.
    fn from_str(text: &str) -> Result<Self, NotASource> {
        let source = Self::from(PathBuf::from(text));
        match &source {
            Self::File(path) if path.extension().is_none() && !path.exists() => Err(NotASource),
            _ => Ok(source),
        }
    }
}

/// What a user asks to open.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Request {
    /// Several make one federated scene. Must not be empty.
    pub models: Vec<Source>,
    /// Schedules and links files, merged. When there are any, they replace the demo's own.
    pub schedules: Vec<PathBuf>,
    /// How dates are written (`%d-%m-%Y`); ISO 8601 when `None`.
    pub date_format: Option<String>,
    /// Text encoding of CSV files; UTF-8 when `None`.
    pub encoding: Option<String>,
}

impl Request {
    /// The built-in skyscraper with its own schedule.
    pub fn demo() -> Self {
        Self { models: vec![Source::Demo], ..Self::default() }
    }
}

/// Reads everything and links it.
///
/// # Errors
/// A file that cannot be used, by name, or [`Cancelled`] (see [`is_cancelled`]). What is wrong
/// inside a usable file does not stop the load: it is found in [`Scene::diagnostics`].
pub fn load(request: &Request, progress: &Progress) -> anyhow::Result<Scene> {
    load_parts(request, progress).map_err(|error| match progress.check() {
        Ok(()) => error,
        Err(cancelled) => cancelled.into(),
    })
}

/// Whether a load ended because the user asked it to.
pub fn is_cancelled(error: &anyhow::Error) -> bool {
    error.is::<Cancelled>()
}

fn load_parts(request: &Request, progress: &Progress) -> anyhow::Result<Scene> {
    let _ = (request, progress, Model::default(), Schedule::default());
    progress.check()?;
    Err(anyhow::anyhow!("the readers are not there yet")).context("cannot load")
}
