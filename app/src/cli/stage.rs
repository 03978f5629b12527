//! What `render` and `bench` share: a scene with its tree on a graphics adapter.

use super::args::Colors;
use super::{args, load, terminal};
use crate::output::caption::Colored;
use crate::report::rounded;
use crate::tree::Baked;
use anyhow::Context;
use glam::{DVec3, UVec2};
use serde_json::{Map, Value};
use std::panic::resume_unwind;
use std::sync::Arc;
use std::time::{Duration, Instant};
use topout_render::{DrawMode, Gpu, GpuError, Options, Renderer};
use topout_scene::cache::Cache;
use topout_scene::{Clip, ElementId, Looks, NamedView, Progress, Projection, Scene, View, hdlod};
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

/// Weeks that `--colors ahead` shows.
const AHEAD_WEEKS: u32 = 4;

/// The colours that are asked for, where they are not the model's own.
fn looks(args: &args::Common, scene: &Scene) -> anyhow::Result<Option<Looks>> {
    match args.colors {
        Colors::Own => Ok(None),
        Colors::Activity => Ok(Some(Looks::of_activities(scene))),
        Colors::Ahead => Ok(Some(Looks::of_look_ahead(scene, AHEAD_WEEKS))),
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

/// A line around what `--select` names: the accent of the window's dark theme.
const OUTLINE: [u8; 3] = [0x5B, 0x9D, 0xFF];

impl Stage {
    /// Light, colours and lines as the options say.
    ///
    /// # Errors
    /// When the GPU has no room, or nothing has the name that is to be lined.
    pub fn dress(&mut self, looking: &args::Looking) -> anyhow::Result<()> {
        if looking.color_levels {
            self.color_levels().context("cannot bring the coloured tree onto the GPU")?;
        }
        if let Some(sun) = looking.sun {
            let options = self.renderer.options();
            self.renderer.set_options(Options { sun, ..options });
        }
        if let Some(name) = &looking.select {
            self.renderer.set_selection(&named(&self.scene, name)?, OUTLINE);
        }
        Ok(())
    }
}

/// Elements that are called so.
fn named(scene: &Scene, name: &str) -> anyhow::Result<Vec<ElementId>> {
    let found: Vec<ElementId> = (0u32..)
        .zip(&scene.model.elements)
        .filter(|(_, e)| {
            [&e.name, &e.label, &e.kind].into_iter().chain(&e.guid).any(|text| text == name)
        })
        .map(|(id, _)| ElementId(id))
        .collect();
    anyhow::ensure!(!found.is_empty(), "--select: no element is called {name:?}");
    Ok(found)
}

/// What a caption explains.
pub fn colored(colors: Colors) -> Colored {
    match colors {
        Colors::Own => Colored::Own,
        Colors::Activity => Colored::Activity,
        Colors::Slip => Colored::Slip,
        Colors::Ahead => Colored::Ahead(AHEAD_WEEKS),
    }
}

/// The camera that the options describe.
pub fn view(common: &args::Common, looking: &args::Looking, scene: &Scene) -> anyhow::Result<View> {
    let view = match (looking.eye, looking.target) {
        (Some(eye), Some(target)) => free_view(eye, target, common.size, scene)?,
        _ => fitted(common, looking, scene, 0.0),
    };
    Ok(View { tolerance_px: common.tolerance, clip: clip(looking, scene)?, ..view })
}

fn clip(looking: &args::Looking, scene: &Scene) -> anyhow::Result<Clip> {
    let mut clip = Clip::NONE;
    for half in &looking.section {
        let at = (half.point - scene.model.origin).as_vec3();
        anyhow::ensure!(clip.cut(at, half.outward), "--section: at most {} planes", Clip::MOST);
    }
    Ok(clip)
}

/// The same for a camera that turns by so many degrees: far enough away that everything stays in the frame,
/// unless it says itself where it stands.
pub fn turning_view(
    common: &args::Common,
    looking: &args::Looking,
    scene: &Scene,
    turn: f32,
) -> anyhow::Result<View> {
    let mut view = view(common, looking, scene)?;
    if looking.eye.is_none() {
        let away = view.eye - view.target;
        let degrees = (0..=(turn.abs().min(360.0) as u32)).map(|d| (d as f32).copysign(turn));
        let distances = degrees.map(|d| {
            let view = fitted(common, looking, scene, d);
            view.eye.distance(view.target)
        });
        let farthest = distances.fold(away.length(), f32::max);
        view.eye = view.target + away.normalize_or(glam::Vec3::Z) * farthest;
    }
    Ok(view)
}

/// Everything in the frame, from so many degrees beside the direction that is asked for.
fn fitted(common: &args::Common, looking: &args::Looking, scene: &Scene, beside: f32) -> View {
    let (azimuth, elevation) = looking.view.unwrap_or(NamedView::Iso).angles();
    let factor = looking.coverage.unwrap_or_default().distance_factor();
    View::fit(&scene.focus_bounds(), azimuth + beside, elevation, factor, common.size)
}

fn free_view(eye: DVec3, target: DVec3, size: UVec2, scene: &Scene) -> anyhow::Result<View> {
    let sight = target - eye;
    anyhow::ensure!(sight.length() > 1e-6, "--eye and --target are the same point");
    let upright = sight.normalize().y.abs() < 0.9999;
    Ok(View {
        eye: (eye - scene.model.origin).as_vec3(),
        target: (target - scene.model.origin).as_vec3(),
        up: if upright { glam::Vec3::Y } else { glam::Vec3::NEG_Z },
        projection: Projection::Perspective { fov_y: View::FOV_Y },
        size,
        tolerance_px: 1.0,
        clip: Clip::NONE,
    })
}
