//! Site coordinates: a model a thousand kilometres from the file's zero looks as it does at zero.

use crate::common::*;
use glam::{Affine3A, DVec3, Vec3};
use std::sync::Arc;
use topout_render::{Antialias, DrawMode, Options, Picture};
use topout_scene::{BehaviourId, Model, Progress, Scene, View, export, import};
use topout_schedule::Behaviour;

/// The site's own zero lies on round coordinates of the ground's grid.
const FAR: DVec3 = DVec3::new(1e6, 0.0, 1e6);

/// A model as it is read from a file that has it at `origin`.
fn imported(parts: Vec<Part>, origin: DVec3, name: &str) -> Arc<Scene> {
    let model = Model { origin, ..Model::clone(&scene(parts).model) };
    let path = std::env::temp_dir().join(format!("topout-site-{name}-{}.glb", std::process::id()));
    export::write_glb(&model, std::fs::File::create(&path).unwrap()).unwrap();
    let model = import::read_model(&path, &Progress::default());
    std::fs::remove_file(&path).unwrap();
    let model = Arc::new(model.unwrap());
    assert_eq!(model.diagnostics.iter().count(), 0);
    let element_behaviour = vec![BehaviourId(0); model.elements.len()];
    let behaviours = vec![Behaviour::always()];
    Arc::new(Scene { model, element_behaviour, behaviours, ..Default::default() })
}

/// A slab, and towards +Z a plate 10 mm and one 1 mm before it; uneven coordinates.
fn parts() -> Vec<Part> {
    let place = |x: f32, front: f32, half: f32| {
        let scale = Affine3A::from_scale(Vec3::new(half, half, 0.05));
        at(13.37 + x, 2.5, -7.61 + front) * scale
    };
    vec![
        part(cube(RED), place(0.0, 0.0, 2.5)),
        part(cube(BLUE), place(-1.2, 0.010, 1.0)),
        part(cube(GREEN), place(1.2, 0.001, 1.0)),
    ]
}

fn shot_of(scene: &Arc<Scene>, site: DVec3, eye: DVec3, antialias: Antialias) -> Picture {
    let local = |p: DVec3| (p + site - scene.model.origin).as_vec3();
    let mut r = renderer();
    r.set_options(Options { antialias, ..r.options() });
    r.set_scene(scene).unwrap();
    let target = DVec3::new(13.37, 2.5, -7.61);
    let mut view: View = look(local(target + eye), local(target), (240, 160));
    view.tolerance_px = 0.0;
    shot(&mut r, view, DrawMode::Batched)
}

#[test]
fn far_from_zero_is_as_at_zero() {
    let near = imported(parts(), DVec3::ZERO, "near");
    let far = imported(parts(), FAR, "far");
    assert_eq!(near.model.origin, DVec3::ZERO);
    assert!(far.model.origin.x > 9e5 && far.model.origin.z > 9e5);
    for antialias in [Antialias::Smooth, Antialias::Msaa4] {
        // At working distance and from as far as the plates are told apart.
        for eye in [DVec3::new(1.0, 1.5, 9.0), DVec3::new(12.0, 8.0, 40.0)] {
            let a = shot_of(&near, DVec3::ZERO, eye, antialias);
            let b = shot_of(&far, FAR, eye, antialias);
            let apart = |(a, b): &(&u8, &u8)| a.abs_diff(**b) > 6;
            let differ = a.rgba.iter().zip(&b.rgba).filter(apart).count();
            // A rounding may move an outline across the middle of a pixel.
            assert!(differ <= a.rgba.len() / 2000, "{antialias:?} {eye}: {differ}");
        }
    }
}

/// The plates, looked at from straight ahead and aslant, cover the slab without holes, 1 mm and 10 mm before it.
#[test]
fn what_lies_close_does_not_flicker() {
    let far = imported(parts(), FAR, "close");
    for (eye, pixels) in [
        (DVec3::new(0.0, 0.0, 10.0), 35),
        (DVec3::new(4.0, 3.0, 12.0), 20),
        (DVec3::new(0.5, 1.0, 45.0), 7),
    ] {
        let p = shot_of(&far, FAR, eye, Antialias::Off);
        // Along the row through the middle: blue, then green, and red only around.
        let row: Vec<usize> =
            (0..240).filter_map(|x| (0..3).find(|&c| shows(&p, x, 80, c))).collect();
        let mut runs: Vec<(usize, usize)> = Vec::new();
        for channel in row {
            match runs.last_mut() {
                Some((last, count)) if *last == channel => *count += 1,
                _ => runs.push((channel, 1)),
            }
        }
        let order: Vec<usize> = runs.iter().map(|r| r.0).collect();
        assert_eq!(order, [0, 2, 0, 1, 0], "{eye}: {runs:?}");
        assert!(runs[1].1 >= pixels && runs[3].1 >= pixels, "{eye}: {runs:?}");
    }
}
