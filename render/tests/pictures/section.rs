//! Section planes and what fills the cuts.

use crate::common::*;
use glam::{Affine3A, Quat, Vec3};
use topout_render::{Antialias, DrawMode, Options};
use topout_scene::{Clip, ElementId, Mesh, Projection, View};

const SIZE: (u32, u32) = (160, 120);

/// From the front, 8 m away, cut away what is nearer than `z`.
fn cut(z: f32) -> View {
    let mut clip = Clip::NONE;
    assert!(clip.cut(Vec3::Z * z, Vec3::Z));
    View { clip, ..look(Vec3::new(0.0, 0.0, 8.0), Vec3::ZERO, SIZE) }
}

fn inside_out(mut mesh: Mesh) -> Mesh {
    mesh.indices.reverse();
    mesh
}

/// A red cube before a green one, cut in its middle: however its triangles go and whatever mirrors it, one sees a
/// red cut and not the green cube behind; without its sides it is a hole.
#[test]
fn cuts_of_solids_are_filled() {
    let mirrored = Affine3A::from_scale(Vec3::new(1.0, -1.0, 1.0));
    // The two sides across x alone.
    let mut open = cube(RED);
    open.indices.truncate(12);
    open.opaque = 12;
    let mut r = renderer();
    for (mesh, place, filled) in [
        (cube(RED), Affine3A::IDENTITY, true),
        (cube(RED), mirrored, true),
        (inside_out(cube(RED)), Affine3A::IDENTITY, true),
        (inside_out(cube(RED)), mirrored, true),
        (open, Affine3A::IDENTITY, false),
    ] {
        let behind = part(cube(GREEN), at(0.0, 0.0, -1.5));
        r.set_scene(&scene(vec![part(mesh, place), behind])).unwrap();
        for antialias in [Antialias::Off, Antialias::Smooth, Antialias::Msaa4] {
            r.set_options(Options { antialias, ..r.options() });
            let parallel = Projection::Orthographic { height: 6.0 };
            for view in [cut(0.0), View { projection: parallel, ..cut(0.0) }] {
                for mode in [DrawMode::Batched, DrawMode::Objects, DrawMode::Hdlod] {
                    let p = shot(&mut r, view, mode);
                    let color = usize::from(!filled);
                    assert!(shows(&p, 80, 60, color), "{filled} {mode:?} {:?}", p.pixel(80, 60));
                    assert_eq!(p.pixel(5, 5)[3], 0);
                }
            }
        }
    }
}

/// What lies behind the plane is drawn as ever, also where its solid is cut beside: a slanting bar.
#[test]
fn what_is_not_cut_stays_as_it_is() {
    let slanting = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.6), Vec3::ZERO)
        * Affine3A::from_scale(Vec3::new(4.0, 0.5, 0.5));
    let glass = part(cube(GLASS), at(0.0, 2.0, 0.0));
    let mut r = renderer();
    r.set_options(Options { antialias: Antialias::Off, edges: 0.0, ..r.options() });
    r.set_scene(&scene(vec![part(cube(RED), slanting), glass])).unwrap();
    let whole = shot(&mut r, View { clip: Clip::NONE, ..cut(0.0) }, DrawMode::Batched);
    assert_eq!(whole, shot(&mut r, cut(50.0), DrawMode::Batched));
    let halved = shot(&mut r, cut(0.0), DrawMode::Batched);
    // The bar goes away from the eye to the right.
    let (mut same, mut gone, mut filled) = (0, 0, 0);
    for x in 0..SIZE.0 {
        match (whole.pixel(x, 60), halved.pixel(x, 60)) {
            (before, _) if before[3] == 0 => {}
            (_, after) if after[3] == 0 => gone += 1,
            (before, after) if before == after => same += 1,
            _ => filled += 1,
        }
    }
    assert!(same > 20 && gone > 20 && (2..45).contains(&filled), "{same} {gone} {filled}");
    // Of the cube of glass one half is left, which is not filled.
    assert_eq!(halved.pixel(80, 25)[3], 255);
    assert!(!shows(&halved, 80, 25, 0));
}

/// From within what is shown nothing is filled, and a section that cuts nothing leaves the picture as it is.
#[test]
fn from_within_nothing_is_filled() {
    let mut r = renderer();
    let room = Affine3A::from_scale(Vec3::splat(5.0));
    r.set_scene(&scene(vec![part(cube(RED), room), part(cube(GREEN), at(0.0, 0.0, -2.0))]))
        .unwrap();
    let inside = look(Vec3::new(0.0, 0.0, 3.0), Vec3::ZERO, SIZE);
    let mut clip = Clip::NONE;
    clip.cut(Vec3::Z * 4.0, Vec3::Z);
    let whole = shot(&mut r, inside, DrawMode::Batched);
    assert_eq!(whole, shot(&mut r, View { clip, ..inside }, DrawMode::Batched));
    assert!(shows(&whole, 80, 60, 1));
}

/// The line around what is selected ends where it is cut.
#[test]
fn the_line_goes_around_what_is_left() {
    let mut r = renderer();
    r.set_scene(&scene(vec![part(cube(GREEN), Affine3A::IDENTITY)])).unwrap();
    let mut clip = Clip::NONE;
    clip.cut(Vec3::ZERO, Vec3::X);
    let view = View { clip, ..cut(9.0) };
    let before = shot(&mut r, view, DrawMode::Batched);
    r.set_selection(&[ElementId(0)], [255, 0, 255]);
    let with = shot(&mut r, view, DrawMode::Batched);
    let changed = |x: u32| before.pixel(x, 60) != with.pixel(x, 60);
    let right = (0..SIZE.0).filter(|x| changed(*x)).max().unwrap();
    assert!((76..84).contains(&right), "{right}");
}
