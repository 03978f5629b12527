//! What several of the tests draw.
#![allow(clippy::unwrap_used, dead_code)]

use std::sync::Arc;
use topout_render::{Gpu, Renderer};
use topout_scene::{Hdlod, Progress, Scene, demo, hdlod, link};

/// The demo project with so many elements, and its tree.
pub fn small_demo(elements: usize) -> (Arc<Scene>, Arc<Hdlod>) {
    let settings = demo::DemoSettings::for_elements(elements);
    let (model, schedule) = demo::generate(&settings, &Progress::default()).unwrap();
    let scene = link::link(model, schedule);
    let tree = hdlod::build(&scene, &hdlod::Settings::default(), &Progress::default()).unwrap();
    (Arc::new(scene), Arc::new(tree))
}

/// A renderer with both.
pub fn renderer(scene: &Arc<Scene>, tree: &Arc<Hdlod>) -> Renderer {
    let mut r = Renderer::new(&Gpu::headless().unwrap());
    r.set_scene(scene).unwrap();
    r.set_hdlod(tree).unwrap();
    r
}
