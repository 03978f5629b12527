//! What `render` and `bench` share: a scene with its tree on a graphics adapter.

use super::args::Colors;
use super::{args, load, terminal};
use crate::report::rounded;
use crate::tree::Baked;
use anyhow::Context;
use glam::DVec3;
use serde_json::{Map, Value};
use std::panic::resume_unwind;
use std::sync::Arc;
use std::time::{Duration, Instant};
use topout_render::{DrawMode, Gpu, GpuError, Options, Renderer};
use topout_scene::cache::Cache;
use topout_scene::{Looks, NamedView, Progress, Projection, Scene, View, hdlod};
use topout_schedule::DateSet;

/// A scene that can be drawn.
pub struct Stage {
    /// The adapter.
    pub gpu: Gpu,
    /// Shows `scene`.
    pub renderer: Renderer,
    /// What is shown.
    pub scene: Arc<Scene>,
    /// From files to linked scene.
    pub load_seconds: f64,
    /// The tree; `None` where none was needed.
    pub baked: Option<Baked>,
    /// How long each step took.
    pub phases: Phases,
}

impl Stage {
    /// Loads the project, finds an adapter, and takes the tree from the cache or builds it where
    /// `modes` need one.
    ///
    /// # Errors
    /// A file that cannot be used; no adapter (before anything slow is done).
    pub fn set(
        args: &args::Common,
        modes: &[DrawMode],
        cache: Option<Cache>,
    ) -> anyhow::Result<Self> {
        let mut phases = Phases::default();
        let (loading, started) = (Arc::new(Progress::default()), Instant::now());
        // The adapter is opened and the shaders are compiled while the files are read.
        let (scene, graphics) = std::thread::scope(|scope| {
            let graphics = scope.spawn(open_graphics);
            let scene = load(&args.request(), &loading);
            (scene, graphics.join().unwrap_or_else(|panic| resume_unwind(panic)))
        });
        let scene = Arc::new(scene?);
        phases.append(&loading);
        let load_seconds = started.elapsed().as_secs_f64();
        let (gpu, mut renderer, opening) = graphics?;
        phases.0.extend(opening.0);
        if let Some(choice) = args.occlusion {
            renderer.set_options(Options { occlusion: choice.into(), ..renderer.options() });
        }
        phases
            .time("graphics: scene", || renderer.set_scene(&scene))
            .context("cannot bring the scene onto the GPU")?;
        if let Some(looks) = looks(args, &scene)? {
            let looks = Arc::new(looks);
            renderer.set_looks(Some(&looks)).context("cannot bring the colours onto the GPU")?;
        }
        let mut baked = None;
        if modes.contains(&DrawMode::Hdlod) {
            let progress = Arc::default();
            let tree = bake(&scene, args, cache, &progress)?;
            phases.append(&progress);
            phases
                .time("graphics: tree", || renderer.set_hdlod(&tree.tree))
                .context("cannot bring the HDLOD tree onto the GPU")?;
            baked = Some(tree);
        }
        Ok(Self { gpu, renderer, scene, load_seconds, baked, phases })
    }

    /// From linked scene to tree, in seconds.
    pub fn bake_seconds(&self) -> Option<f64> {
        self.baked.as_ref().map(|b| rounded(b.seconds, 3))
    }

    /// Whether the tree came out of the cache.
    pub fn cache_hit(&self) -> bool {
        self.baked.as_ref().is_some_and(|b| b.from_cache)
    }

    /// Another tree in place of the one that is shown.
    ///
    /// # Errors
    /// When the GPU has no room.
    pub fn change_tree(&mut self, args: &args::Common, cache: Option<Cache>) -> anyhow::Result<()> {
        // There may not be room for both.
        self.baked = None;
        self.renderer.clear_hdlod();
        let baked = bake(&self.scene, args, cache, &Arc::default())?;
        self.renderer.set_hdlod(&baked.tree).context("cannot bring the HDLOD tree onto the GPU")?;
        self.baked = Some(baked);
        Ok(())
    }

    /// Draws clusters in the colours of their levels from now on.
    ///
    /// # Errors
    /// When the GPU has no room.
    pub fn color_levels(&mut self) -> anyhow::Result<()> {
        let Some(baked) = &self.baked else { return Ok(()) };
        let (scene, tree) = hdlod::color_by_level(&self.scene, &baked.tree);
        self.renderer.set_scene(&Arc::new(scene))?;
        Ok(self.renderer.set_hdlod(&Arc::new(tree))?)
    }

    /// Brings a tree that was built into the cache.
    pub fn keep_tree(&mut self) {
        if let Some(baked) = &mut self.baked {
            baked.keep();
        }
    }
}

/// The colours that are asked for, where they are not the model's own.
fn looks(args: &args::Common, scene: &Scene) -> anyhow::Result<Option<Looks>> {
    match args.colors {
        Colors::Own => Ok(None),
        Colors::Activity => Ok(Some(Looks::of_activities(scene))),
        Colors::Slip => {
            let [from, to] = args.slip.unwrap_or([DateSet::Planned, DateSet::Actual]);
            let looks = Looks::of_differences(scene, from, to);
            Ok(Some(looks.with_context(|| {
                format!(
                    "--colors slip: no activity has both {} and {} dates, and nothing says which \
                     elements are late; --slip compares other dates",
                    from.word(),
                    to.word()
                )
            })?))
        }
    }
}

/// An adapter and a renderer on it.
fn open_graphics() -> Result<(Gpu, Renderer, Phases), GpuError> {
    let mut phases = Phases::default();
    let gpu = phases.time("graphics: adapter", Gpu::headless)?;
    let renderer = phases.time("graphics: shaders", || Renderer::new(&gpu));
    Ok((gpu, renderer, phases))
}

/// The steps of some work and how long each took, in order; some ran beside each other.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Phases(Vec<(String, Duration)>);

impl Phases {
    /// Does one step.
    pub fn time<T>(&mut self, step: &str, work: impl FnOnce() -> T) -> T {
        let started = Instant::now();
        let result = work();
        self.0.push((step.to_owned(), started.elapsed()));
        result
    }

    /// Appends what a worker reported.
    pub fn append(&mut self, progress: &Progress) {
        self.0.extend(progress.phases());
    }

    /// Seconds by name.
    pub fn as_json(&self) -> Map<String, Value> {
        let seconds = |time: &Duration| rounded(time.as_secs_f64(), 3).into();
        self.0.iter().map(|(name, time)| (name.clone(), seconds(time))).collect()
    }
}

/// Takes the tree from the cache or builds it, with a progress line on the terminal.
pub fn bake(
    scene: &Scene,
    args: &args::Common,
    cache: Option<Cache>,
    progress: &Arc<Progress>,
) -> anyhow::Result<Baked> {
    let _line = terminal::ProgressLine::show(progress);
    let settings =
        hdlod::Settings { temporal: args.temporal.into(), simplifier: args.simplifier.into() };
    Ok(Baked::new(scene, &settings, &args.request(), cache, progress)?)
}

/// The camera that `render`'s options describe.
pub fn view(args: &args::Render, scene: &Scene) -> anyhow::Result<View> {
    let size = args.common.size;
    let view = match (args.eye, args.target) {
        (Some(eye), Some(target)) => free_view(eye, target, args, scene)?,
        _ => {
            let (azimuth, elevation) = args.view.unwrap_or(NamedView::Iso).angles();
            let factor = args.coverage.unwrap_or_default().distance_factor();
            View::fit(&scene.focus_bounds(), azimuth, elevation, factor, size)
        }
    };
    Ok(View { tolerance_px: args.common.tolerance, ..view })
}

fn free_view(
    eye: DVec3,
    target: DVec3,
    args: &args::Render,
    scene: &Scene,
) -> anyhow::Result<View> {
    let sight = target - eye;
    anyhow::ensure!(sight.length() > 1e-6, "--eye and --target are the same point");
    let upright = sight.normalize().y.abs() < 0.9999;
    Ok(View {
        eye: (eye - scene.model.origin).as_vec3(),
        target: (target - scene.model.origin).as_vec3(),
        up: if upright { glam::Vec3::Y } else { glam::Vec3::NEG_Z },
        projection: Projection::Perspective { fov_y: View::FOV_Y },
        size: args.common.size,
        tolerance_px: args.common.tolerance,
    })
}
