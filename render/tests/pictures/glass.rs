//! Of transparent surfaces the nearest is shown, once, in whatever order they are drawn.

use crate::common::*;
use glam::{Affine3A, Vec3};
use std::sync::Arc;
use topout_render::{Antialias, DrawMode, Options, Picture, Renderer};
use topout_scene::{Progress, View, hdlod};

const SIZE: (u32, u32) = (160, 120);
const ANTIALIAS: [Antialias; 3] = [Antialias::Off, Antialias::Smooth, Antialias::Msaa4];
const MODES: [DrawMode; 3] = [DrawMode::Hdlod, DrawMode::Batched, DrawMode::Objects];

fn view(z: f32) -> View {
    View { tolerance_px: 0.0, ..look(Vec3::new(0.7, 1.0, z), Vec3::ZERO, SIZE) }
}

/// An upright pane, `z` metres towards the viewer.
fn pane(material: u16, z: f32) -> Part {
    part(cube(material), at(0.0, 0.0, z) * Affine3A::from_scale(Vec3::new(1.5, 1.0, 0.02)))
}

/// The parts from both sides, in every mode and against stairs in every way.
fn pictures(r: &mut Renderer, parts: Vec<Part>) -> Vec<Picture> {
    let scene = scene(parts);
    let tree = hdlod::build(&scene, &hdlod::Settings::default(), &Progress::default()).unwrap();
    r.set_scene(&scene).unwrap();
    r.set_hdlod(&Arc::new(tree)).unwrap();
    let mut pictures = Vec::new();
    for antialias in ANTIALIAS {
        r.set_options(Options { antialias, ..r.options() });
        for mode in MODES {
            pictures.extend([8.0, -8.0].map(|z| shot(r, view(z), mode)));
        }
    }
    pictures
}

/// A box of glass through a box of amber, a red one within both.
#[test]
fn order_does_not_matter() {
    let parts = |order: [usize; 3]| {
        let parts = [
            (GLASS, at(0.6, 0.1, 0.7)),
            (AMBER, at(-0.5, 0.0, 0.0)),
            (RED, Affine3A::from_scale(Vec3::splat(0.4))),
        ];
        order.map(|i| part(cube(parts[i].0), parts[i].1)).into()
    };
    let mut r = renderer();
    let expected = pictures(&mut r, parts([0, 1, 2]));
    assert_ne!(expected[0], expected[1], "the two sides differ");
    assert!(expected == pictures(&mut r, parts([1, 0, 2])));
    assert!(expected == pictures(&mut r, parts([2, 1, 0])));
}

/// Two and three panes in one place look as one.
#[test]
fn what_coincides_is_not_darker() {
    let mut r = renderer();
    let one = pictures(&mut r, vec![pane(AMBER, 0.0)]);
    assert!(covered(&one[0]) > 1000);
    let two = pictures(&mut r, vec![pane(AMBER, 0.0), pane(AMBER, 0.0)]);
    assert!(one == two);
    let three = [0; 3].map(|_| pane(AMBER, 0.0));
    assert!(one == pictures(&mut r, three.into()));
}

/// Amber before glass of the same size is amber alone where it is, over the sky and over a solid part; all of
/// it is masked as an element, and a solid part in front hides it.
#[test]
fn the_nearest_is_shown() {
    let red = |z| part(cube(RED), at(0.0, 0.0, z) * Affine3A::from_scale(Vec3::splat(0.3)));
    let mut r = renderer();
    let alone = pictures(&mut r, vec![pane(AMBER, 1.0), red(0.0)]);
    let both = pictures(&mut r, vec![pane(GLASS, 0.5), pane(AMBER, 1.0), red(0.0)]);
    let bare = pictures(&mut r, vec![red(0.0)]);
    let hidden = pictures(&mut r, vec![red(3.0), pane(GLASS, 0.5), red(0.0)]);
    for i in (0..alone.len()).step_by(2) {
        let pixels = [&alone, &both, &bare, &hidden].map(|p| {
            // Over the solid part, and over the sky above it.
            [(80, 58), (80, 48)].map(|(x, y)| p[i].pixel(x, y))
        });
        let [alone, both, bare, hidden] = pixels;
        assert_eq!(alone, both, "{i}");
        assert!(alone.iter().zip(&bare).all(|(a, b)| a[..3] != b[..3]), "{i}: {alone:?} {bare:?}");
        assert_eq!(bare.map(|p| p[3]), [255, 0], "{i}");
        assert_eq!(both.map(|p| p[3]), [255, 255], "{i}");
        let [r, g, b, a] = hidden[0];
        assert!(r > g + 60 && r > b + 60 && a == 255, "{i}: {:?}", hidden[0]);
    }
}
