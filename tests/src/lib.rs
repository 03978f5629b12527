//! Harness of the whole-program tests: the demo project on a graphics adapter, and pictures that
//! are compared as a person compares them.
//!
//! A test that needs an adapter fails without one: "no adapter" never reads as "passed".

pub mod golden;
pub mod window;

use glam::UVec2;
use std::sync::Arc;
use topout::project::{self, Request};
use topout_render::{Antialias, DrawMode, FrameInput, Gpu, Options, Picture, Renderer};
use topout_scene::{NamedView, Progress, Scene, View, hdlod};
use topout_schedule::Time;

/// The demo project, as a user gets it.
///
/// # Panics
/// When it cannot be made.
pub fn demo_scene() -> Arc<Scene> {
    let scene = project::load(&Request::demo(), &Progress::default());
    Arc::new(scene.expect("the demo project can be made"))
}

/// A scene on a graphics adapter.
pub struct Stage {
    /// Shows `scene`.
    pub renderer: Renderer,
    /// What is shown.
    pub scene: Arc<Scene>,
}

impl Stage {
    /// Without a tree: [`DrawMode::Batched`] and [`DrawMode::Objects`] only.
    ///
    /// # Panics
    /// Without a graphics adapter.
    pub fn new(scene: Arc<Scene>) -> Self {
        let gpu = Gpu::headless().expect("these tests need a graphics adapter");
        let mut renderer = Renderer::new(&gpu);
        // The same on every adapter, so that pictures can be compared.
        let options = Options { antialias: Antialias::Smooth, ..renderer.options() };
        renderer.set_options(options);
        renderer.set_scene(&scene).expect("the scene fits on the adapter");
        Self { renderer, scene }
    }

    /// Builds the tree too.
    ///
    /// # Panics
    /// Without a graphics adapter.
    pub fn with_tree(scene: Arc<Scene>) -> Self {
        let mut stage = Self::new(scene);
        let tree = hdlod::build(&stage.scene, &hdlod::Settings::default(), &Progress::default())
            .expect("nobody cancels");
        stage.renderer.set_hdlod(&Arc::new(tree)).expect("the tree fits on the adapter");
        stage
    }

    /// Another scene in place of this one.
    ///
    /// # Panics
    /// When it does not fit.
    pub fn replace(&mut self, scene: Arc<Scene>) {
        self.renderer.set_scene(&scene).expect("the scene fits on the adapter");
        self.scene = scene;
    }

    /// The standard view from `distance_factor` times the fitting distance, with a tolerance of a
    /// pixel.
    pub fn standard_view(&self, distance_factor: f32, size: UVec2) -> View {
        let (azimuth, elevation) = NamedView::Iso.angles();
        View::fit(&self.scene.focus_bounds(), azimuth, elevation, distance_factor, size)
    }

    /// The instant at a fraction of the period; 1 is one second before its end.
    pub fn date(&self, fraction: f64) -> Time {
        let period = self.scene.schedule.period;
        period.at_fraction(fraction).min(period.end.plus_seconds(-1))
    }

    /// Draws one picture.
    ///
    /// # Panics
    /// When the adapter fails.
    pub fn picture(&mut self, view: View, time: Time, mode: DrawMode) -> Picture {
        self.renderer.render(&FrameInput { view, time, mode });
        self.renderer.read_back().expect("the adapter works")
    }
}
