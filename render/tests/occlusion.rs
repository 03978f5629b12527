//! Leaving out what nobody sees changes no picture, whatever was drawn before.
#![allow(clippy::unwrap_used)]

mod common;

use common::{renderer, small_demo};
use glam::{UVec2, Vec3};
use std::sync::Arc;
use topout_render::{Antialias, DrawMode, FrameInput, Occlusion, Options, Picture, Renderer};
use topout_scene::hdlod::Indices;
use topout_scene::{Hdlod, Mesh, Model, Projection, Scene, View};

/// A way round the site: small steps and jumps of camera and date, both projections, from far, from the
/// street, from inside and with clusters much coarser than a pixel.
fn journey(scene: &Scene) -> Vec<FrameInput> {
    let size = UVec2::new(320, 200);
    let bounds = scene.focus_bounds();
    let period = scene.schedule.period;
    let mut frames = Vec::new();
    for step in 0..24 {
        let share = f64::from(step % 8) / 8.0;
        let angle = if step % 3 == 0 { step as f32 * 71.0 } else { 30.0 + step as f32 };
        let distance = [1.0, 0.5, 2.0, 4.0][step as usize / 2 % 4];
        let mut view = View::fit(&bounds, angle, 15.0, distance, size);
        match step % 6 {
            2 => view.projection = Projection::Orthographic { height: bounds.size().y * distance },
            4 => view.tolerance_px = 6.0,
            5 => {
                // Within the tower, and on the street.
                let up = if step % 12 == 5 { 0.4 } else { 0.02 };
                let foot = bounds.center().with_y(bounds.min.y);
                view.eye = foot + Vec3::new(1.0, bounds.size().y * up, 1.0);
                view.target = view.eye + Vec3::new(1.0, 0.1, 0.7);
            }
            _ => {}
        }
        // Every other step at the date of the one before.
        let time = period.at_fraction(if step % 2 == 0 { share } else { share - 0.125 });
        frames.push(FrameInput { view, time, mode: DrawMode::Hdlod });
    }
    frames
}

fn pictures(r: &mut Renderer, options: Options, frames: &[FrameInput]) -> Vec<Picture> {
    r.set_options(options);
    let shot = |frame| {
        r.render(frame);
        r.read_back().unwrap()
    };
    frames.iter().map(shot).collect()
}

#[test]
fn what_is_left_out_is_never_seen() {
    let (scene, tree) = small_demo(3000);
    let mut r = renderer(&scene, &tree);
    let frames = journey(&scene);
    for antialias in [Antialias::Smooth, Antialias::Msaa4] {
        let options = Options { antialias, ..r.options() };
        let off = Options { occlusion: Occlusion::Off, ..options };
        let expected = pictures(&mut r, off, &frames);
        for occlusion in [Occlusion::Cpu, Occlusion::Gpu] {
            let found = pictures(&mut r, Options { occlusion, ..options }, &frames);
            for (i, (expected, found)) in expected.iter().zip(&found).enumerate() {
                let pixels = expected.rgba.chunks(4).zip(found.rgba.chunks(4));
                let differ = pixels.filter(|(a, b)| a != b).count();
                assert_eq!(differ, 0, "frame {i}, {occlusion:?}, {antialias:?}");
            }
        }
    }
}

/// Big meshes need indices of 32 bits, and so does a tree with big clusters.
#[test]
fn wide_indices_draw_the_same() {
    let (scene, tree) = small_demo(3000);
    let mut model = Model::clone(&scene.model);
    let vertices = vec![model.meshes[0].vertices[0]; 1 << 16];
    model.meshes.push(Mesh { vertices, ..model.meshes[0].clone() });
    let wide_scene = Arc::new(Scene { model: Arc::new(model), ..Scene::clone(&scene) });
    let indices = Indices::Long(tree.indices.range(0..tree.indices.len()).collect());
    let wide_tree = Arc::new(Hdlod { indices, ..Hdlod::clone(&tree) });
    let (mut r, mut wide) = (renderer(&scene, &tree), renderer(&wide_scene, &wide_tree));
    let mut frames = journey(&scene);
    frames.truncate(6);
    frames[2].mode = DrawMode::Batched;
    frames[3].mode = DrawMode::Objects;
    for occlusion in [Occlusion::Off, Occlusion::Cpu, Occlusion::Gpu] {
        let options = Options { occlusion, ..r.options() };
        let [narrow, wide] = [&mut r, &mut wide].map(|r| pictures(r, options, &frames));
        assert!(narrow == wide, "{occlusion:?}");
    }
}

/// Much of the cut is left out, of the elements that are drawn exactly, too; in the first frame as in those
/// that follow.
#[test]
fn much_is_left_out() {
    let (scene, tree) = small_demo(3000);
    let mut r = renderer(&scene, &tree);
    let view = View::fit(&scene.focus_bounds(), 30.0, 20.0, 2.0, UVec2::new(640, 400));
    let time = scene.schedule.period.end.plus_seconds(-1);
    let input = FrameInput { view, time, mode: DrawMode::Hdlod };
    r.set_options(Options { antialias: Antialias::Off, occlusion: Occlusion::Off, ..r.options() });
    let all = r.render(&input);
    assert_eq!(all.left, None);
    r.set_options(Options { occlusion: Occlusion::Cpu, ..r.options() });
    let [first, second] = [0, 1].map(|_| r.render(&input));
    let (first_left, left) = (first.left.unwrap(), second.left.unwrap());
    println!("{} triangles, left {first_left}, then {left}", all.triangles);
    assert_eq!([first.triangles, second.triangles], [all.triangles; 2]);
    assert!(left * 3 < all.triangles * 2);
    assert!(first_left <= left + left / 10);
    // What is left of the clusters is two commands, where each part was one.
}

/// Most of the elements that are drawn exactly are left out where walls and slabs hide them.
#[test]
fn elements_behind_walls_are_left_out() {
    let (scene, tree) = small_demo(3000);
    let mut r = renderer(&scene, &tree);
    let bounds = scene.focus_bounds();
    let time = scene.schedule.period.end.plus_seconds(-1);
    let mut view = View::fit(&bounds, 30.0, 20.0, 2.0, UVec2::new(320, 200));
    let mut draws = [0, 0];
    for storey in 0..12 {
        let height = bounds.min.y + bounds.size().y * (0.1 + 0.05 * storey as f32);
        view.eye = bounds.center().with_y(height) + Vec3::new(6.0, 0.0, 1.0);
        view.target = view.eye + Vec3::new(-1.0, -0.05, 0.2);
        let input = FrameInput { view, time, mode: DrawMode::Hdlod };
        for (draws, occlusion) in draws.iter_mut().zip([Occlusion::Off, Occlusion::Cpu]) {
            r.set_options(Options { occlusion, ..r.options() });
            *draws += r.render(&input).draws;
        }
    }
    println!("{draws:?} draws");
    assert!(draws[1] * 3 < draws[0] * 2);
}
