//! The tree of a scene: out of the cache, or built and then kept there.

use crate::memory;
use crate::project::Request;
use std::ffi::OsStr;
use std::sync::Arc;
use std::time::{Instant, SystemTime};
use topout_scene::cache::{Cache, Found, Info, Key};
use topout_scene::hdlod::{self, OtherScene, Settings, Temporal};
use topout_scene::{Cancelled, Hdlod, Progress, Scene};
use topout_schedule::Time;

/// Names the folder of the cache; empty: no cache.
const FOLDER_VARIABLE: &str = "TOPOUT_CACHE_DIR";
/// Megabytes (10^6 bytes) that all files of the cache may have together.
const LIMIT_VARIABLE: &str = "TOPOUT_CACHE_LIMIT_MB";
/// The same where nobody says otherwise: some twenty towers.
const LIMIT_MB: u64 = 2000;

/// The user's cache: where the environment says, else in the system's folder for caches. `None`
/// where there is no such folder, or the environment wants none.
pub fn user_cache() -> Option<Cache> {
    let folder = std::env::var_os(FOLDER_VARIABLE);
    let limit = std::env::var_os(LIMIT_VARIABLE);
    cache_of(folder.as_deref(), limit.as_deref())
}

fn cache_of(folder: Option<&OsStr>, limit: Option<&OsStr>) -> Option<Cache> {
    let limit_mb = limit.map_or(LIMIT_MB, |text| {
        text.to_str().and_then(|t| t.trim().parse().ok()).unwrap_or_else(|| {
            tracing::warn!("{LIMIT_VARIABLE}: {text:?} is no number of megabytes");
            LIMIT_MB
        })
    });
    let folder = match folder {
        Some(folder) if folder.is_empty() => return None,
        Some(folder) => folder.into(),
        None => directories::ProjectDirs::from("", "", "topout")?.cache_dir().to_owned(),
    };
    Some(Cache::new(folder, limit_mb.saturating_mul(1_000_000)))
}

/// A tree that is ready to draw.
#[derive(Debug)]
pub struct Baked {
    /// The tree.
    pub tree: Arc<Hdlod>,
    /// From linked scene to tree, seconds.
    pub seconds: f64,
    /// Whether it came out of the cache.
    pub from_cache: bool,
    /// Bytes of its file in the cache; 0 where there is none (yet).
    pub cache_bytes: u64,
    unkept: Option<(Cache, Key, Info)>,
}

impl Baked {
    /// Takes the tree of a scene from `cache`, or builds it. [`Baked::keep`] brings a tree that was
    /// built into the cache.
    ///
    /// # Errors
    /// Only when `progress` is cancelled.
    pub fn new(
        scene: &Scene,
        settings: &Settings,
        request: &Request,
        cache: Option<Cache>,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let build = |progress: &Progress| hdlod::build(scene, settings, progress);
        Self::found_or_made(scene, settings, request, cache, progress, build)
    }

    /// The tree of a scene that an edit of the schedule left, from `cache` or by repair of `tree`,
    /// which was brought along ([`Hdlod::restate`]); with the scene as if it had been loaded with these
    /// dates, so that the next run finds the tree that is kept.
    ///
    /// # Errors
    /// Only when `progress` is cancelled.
    pub fn refined(
        scene: &Scene,
        tree: &Hdlod,
        settings: &Settings,
        request: &Request,
        cache: Option<Cache>,
        progress: &Progress,
    ) -> Result<(Scene, Self), Cancelled> {
        let (fresh, ids) = scene.renumbered();
        let repair = |progress: &Progress| match tree.repair(scene, progress)?.renumbered(&ids) {
            Ok(tree) => Ok(tree),
            // The tree is that of another scene.
            Err(OtherScene) => hdlod::build(&fresh, settings, progress),
        };
        let mut result = Self::found_or_made(&fresh, settings, request, cache, progress, repair)?;
        if !result.tree.loose.is_empty() {
            // Whole only when it is built: the next run shall do that.
            result.unkept = None;
        }
        Ok((fresh, result))
    }

    fn found_or_made(
        scene: &Scene,
        settings: &Settings,
        request: &Request,
        cache: Option<Cache>,
        progress: &Progress,
        make: impl FnOnce(&Progress) -> Result<Hdlod, Cancelled>,
    ) -> Result<Self, Cancelled> {
        let started = Instant::now();
        let mut result = Self {
            tree: Arc::default(),
            seconds: 0.0,
            from_cache: false,
            cache_bytes: 0,
            unkept: None,
        };
        if let Some(cache) = cache {
            progress.begin("cache: key", 0)?;
            let key = Key::of(scene, settings);
            progress.begin("cache: reading", 0)?;
            match cache.find(&key, scene) {
                Found::Tree(tree, bytes) => {
                    result.tree = Arc::new(*tree);
                    result.from_cache = true;
                    result.cache_bytes = bytes;
                }
                Found::Unusable(why) => {
                    tracing::info!("{}: {why}; built anew", cache.path(&key).display());
                }
                Found::Nothing => {}
            }
            if !result.from_cache {
                result.unkept = Some((cache, key, info(scene, settings, request)));
            }
        }
        if !result.from_cache {
            result.tree = Arc::new(make(progress)?);
            if let Some((_, _, info)) = &mut result.unkept {
                info.clusters = result.tree.clusters.len() as u64;
                info.made = now();
            }
        }
        result.seconds = started.elapsed().as_secs_f64();
        memory::give_back();
        Ok(result)
    }

    /// Brings a tree that was built into the cache. Where that fails there is a warning: the tree
    /// itself is not lost.
    pub fn keep(&mut self) {
        let Some((cache, key, info)) = self.unkept.take() else { return };
        match cache.keep(&key, &info, &self.tree) {
            Ok(bytes) => self.cache_bytes = bytes,
            Err(error) => tracing::warn!("the tree is not kept in the cache: {error}"),
        }
    }
}

fn info(scene: &Scene, settings: &Settings, request: &Request) -> Info {
    /// Enough to know a project by.
    const MAX_CHARS: usize = 200;
    let names: Vec<String> = request.models.iter().map(ToString::to_string).collect();
    Info {
        project: names.join(", ").chars().take(MAX_CHARS).collect(),
        elements: scene.model.elements.len() as u64,
        triangles: scene.model.triangle_count() as u64,
        temporal: match settings.temporal {
            Temporal::Tight => "tight".to_owned(),
            Temporal::Paper => "paper".to_owned(),
        },
        ..Info::default()
    }
}

/// The present, UTC.
fn now() -> Time {
    as_time(SystemTime::now())
}

/// An instant of the system's clock, UTC.
pub fn as_time(instant: SystemTime) -> Time {
    let since = instant.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    Time::from_seconds(since.as_secs() as i64)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_environment_names_folder_and_limit() {
        let of =
            |folder: &str, limit: &str| cache_of(Some(OsStr::new(folder)), Some(OsStr::new(limit)));
        assert_eq!(of("/trees", "5"), Some(Cache::new("/trees", 5_000_000)));
        assert_eq!(of("/trees", "much"), Some(Cache::new("/trees", 2_000_000_000)));
        assert_eq!(of("", "5"), None, "no cache is wanted");
        let usual = cache_of(None, None).unwrap();
        assert!(usual.folder().ends_with("topout"), "{usual:?}");
        assert_eq!(usual.limit_bytes(), 2_000_000_000);
    }
}
