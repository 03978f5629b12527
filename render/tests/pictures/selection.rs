//! The line around what is selected.

use crate::common::*;
use glam::{Affine3A, Vec3};
use topout_render::{Antialias, DrawMode, Options, Picture, Renderer};
use topout_scene::{ElementId, Projection, View};
use topout_schedule::{Behaviour, Time};

const LINE: [u8; 3] = [255, 0, 255];
const SIZE: (u32, u32) = (160, 120);

fn front() -> View {
    look(Vec3::new(0.0, 0.0, 8.0), Vec3::ZERO, SIZE)
}

/// Pixels in which two pictures differ, with their coordinates.
fn changed(a: &Picture, b: &Picture) -> Vec<(u32, u32)> {
    let pixels = a.rgba.chunks(4).zip(b.rgba.chunks(4)).enumerate();
    let differ = pixels.filter(|(_, (a, b))| a != b).map(|(i, _)| i as u32);
    differ.map(|i| (i % a.width, i / a.width)).collect()
}

/// Without and with the line, and without again.
fn outlined(r: &mut Renderer, view: View, mode: DrawMode, selected: &[ElementId]) -> [Picture; 3] {
    let mut show = |selected: &[ElementId]| {
        r.set_selection(selected, LINE);
        shot(r, view, mode)
    };
    [show(&[]), show(selected), show(&[])]
}

/// A green cube, selected: pixels of the line's colour all around it, none on it or farther than three pixels
/// away; the mask of elements stays, and deselected the picture is the former one.
#[test]
fn a_line_surrounds_what_is_selected() {
    let mut r = renderer();
    r.set_scene(&scene(vec![part(cube(GREEN), Affine3A::IDENTITY)])).unwrap();
    let mut parallel = front();
    parallel.projection = Projection::Orthographic { height: 6.0 };
    for antialias in [Antialias::Off, Antialias::Smooth, Antialias::Msaa4] {
        r.set_options(Options { antialias, ..r.options() });
        for (view, mode) in [(front(), DrawMode::Batched), (parallel, DrawMode::Objects)] {
            let [before, with, after] = outlined(&mut r, view, mode, &[ElementId(0)]);
            assert_eq!(before, after);
            assert_eq!(covered(&before), covered(&with));
            let green: Vec<_> = (0..SIZE.0).filter(|&x| shows(&before, x, 60, 1)).collect();
            let (left, right) = (green[0], green[green.len() - 1]);
            let line: Vec<_> = changed(&before, &with).into_iter().filter(|p| p.1 == 60).collect();
            assert!((4..=6).contains(&line.len()), "{antialias:?} {line:?}");
            for (x, _) in line {
                assert!(x + 3 >= left && x <= right + 3 && !(left < x && x < right), "{x} {left}");
            }
            let [r, g, b, _] = with.pixel(left - 1, 60);
            assert!(r > 240 && g < 15 && b > 240, "{antialias:?} {r} {g} {b}");
        }
    }
}

/// A cube behind a wall: the line is there, but weak. Behind glass it is strong.
#[test]
fn what_is_hidden_has_a_weaker_line() {
    let mut r = renderer();
    let cube_behind = |material| {
        let wall = at(0.0, 0.0, 2.0) * Affine3A::from_scale(Vec3::new(2.5, 2.5, 0.1));
        scene(vec![part(cube(GREEN), Affine3A::IDENTITY), part(cube(material), wall)])
    };
    // The line adds red, of which cube, wall and glass have little.
    let most_red = |[before, with, _]: &[Picture; 3]| {
        changed(before, with).into_iter().map(|(x, y)| with.pixel(x, y)[0]).max()
    };
    r.set_scene(&cube_behind(BLUE)).unwrap();
    let hidden = outlined(&mut r, front(), DrawMode::Batched, &[ElementId(0)]);
    let most = most_red(&hidden);
    assert!(most.is_some_and(|most| (80..180).contains(&most)), "{most:?}");
    r.set_scene(&cube_behind(GLASS)).unwrap();
    let seen = outlined(&mut r, front(), DrawMode::Batched, &[ElementId(0)]);
    assert_eq!(most_red(&seen), Some(255));
}

/// What is not there has no line, nor have elements of a scene that is gone or that never were.
#[test]
fn only_what_is_there_has_a_line() {
    let mut later = part(cube(GREEN), Affine3A::IDENTITY);
    later.behaviour = Behaviour::new(false, vec![Time::from_seconds(10)]).unwrap();
    let mut r = renderer();
    r.set_scene(&scene(vec![later, part(cube(RED), at(2.5, 0.0, 0.0))])).unwrap();
    let [bare, absent, _] = outlined(&mut r, front(), DrawMode::Batched, &[ElementId(0)]);
    assert_eq!(bare, absent);
    let [bare, none, _] = outlined(&mut r, front(), DrawMode::Batched, &[ElementId(7)]);
    assert_eq!(bare, none);
    r.set_selection(&[ElementId(0)], LINE);
    assert_ne!(shot_at(&mut r, front(), DrawMode::Batched, 10), bare);
    let alone = scene(vec![part(cube(RED), Affine3A::IDENTITY)]);
    r.set_scene(&alone).unwrap();
    let [bare, ..] = outlined(&mut r, front(), DrawMode::Batched, &[]);
    r.set_selection(&[ElementId(0)], LINE);
    r.set_scene(&alone).unwrap();
    assert_eq!(bare, shot(&mut r, front(), DrawMode::Batched));
}

/// Twenty thousand selected: the largest are lined, and memory does not grow with their number.
#[test]
fn many_selected_are_bounded() {
    let mesh = || part(cube(RED), Affine3A::from_scale(Vec3::splat(0.05)));
    let mut parts = vec![part(cube(GREEN), Affine3A::IDENTITY)];
    parts.extend((0..5000).map(|_| mesh()));
    let mut r = renderer();
    r.set_scene(&scene(parts)).unwrap();
    let one = outlined(&mut r, front(), DrawMode::Batched, &[ElementId(0)]);
    let bytes = r.gpu_bytes();
    let all: Vec<_> = (0..20_000).map(|i| ElementId(i % 5001)).collect();
    // The small ones are within the large one.
    assert_eq!(one, outlined(&mut r, front(), DrawMode::Batched, &all));
    assert_eq!(bytes, r.gpu_bytes());
}
