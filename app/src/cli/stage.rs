//! What `render` and `bench` share: a scene with its tree on a graphics adapter.

use super::{args, load, terminal};
use anyhow::Context;
use glam::DVec3;
use std::sync::Arc;
use std::time::Instant;
use topout_render::{DrawMode, Gpu, Renderer};
use topout_scene::{Hdlod, NamedView, Progress, Projection, Scene, View, hdlod};

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
    /// From linked scene to finished tree; `None` where no tree was needed.
    pub bake_seconds: Option<f64>,
}

impl Stage {
    /// Loads the project, finds an adapter, and builds the tree where `modes` need one.
    ///
    /// # Errors
    /// A file that cannot be used; no adapter (before anything slow is done).
    pub fn set(args: &args::Common, modes: &[DrawMode]) -> anyhow::Result<Self> {
        let started = Instant::now();
        let scene = Arc::new(load(&args.request(), &Arc::default())?);
        let load_seconds = started.elapsed().as_secs_f64();
        let gpu = Gpu::headless()?;
        let mut renderer = Renderer::new(&gpu);
        renderer.set_scene(&scene).context("cannot bring the scene onto the GPU")?;
        let mut bake_seconds = None;
        if modes.contains(&DrawMode::Hdlod) {
            let started = Instant::now();
            let tree = Arc::new(bake(&scene, args, &Arc::default())?);
            bake_seconds = Some(started.elapsed().as_secs_f64());
            renderer.set_hdlod(&tree).context("cannot bring the HDLOD tree onto the GPU")?;
        }
        Ok(Self { gpu, renderer, scene, load_seconds, bake_seconds })
    }
}

/// Builds the tree with a progress line on the terminal.
pub fn bake(scene: &Scene, args: &args::Common, progress: &Arc<Progress>) -> anyhow::Result<Hdlod> {
    let _line = terminal::ProgressLine::show(progress);
    let settings = hdlod::Settings { temporal: args.temporal.into() };
    Ok(hdlod::build(scene, &settings, progress)?)
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
