//! Pictures of small scenes on the real adapter. Without an adapter every test fails.

#![allow(clippy::unwrap_used)]

mod common;
mod glass;
mod section;
mod selection;
mod site;

use common::*;
use glam::{Affine3A, Quat, Vec3};
use std::sync::Arc;
use topout_render::{Antialias, Backdrop, DrawMode, FrameInput, Options, Sun};
use topout_scene::{BehaviourId, ElementId, Progress, Projection, Scene, View, hdlod};
use topout_schedule::{Behaviour, Time};

const SIZE: (u32, u32) = (160, 120);
const FRONT: Vec3 = Vec3::new(0.0, 0.5, 8.0);

fn front() -> View {
    look(FRONT, Vec3::ZERO, SIZE)
}

/// A red cube before sky and ground: red with alpha 255 in the middle, alpha 0 in the corners, and
/// the picture's own alpha is nothing but these two.
#[test]
fn a_cube_is_shown_and_masked() {
    let mut r = renderer();
    r.set_scene(&scene(vec![part(cube(RED), Affine3A::IDENTITY)])).unwrap();
    let p = shot(&mut r, front(), DrawMode::Batched);
    assert_eq!((p.width, p.height), SIZE);
    assert!(shows(&p, 80, 60, 0), "{:?}", p.pixel(80, 60));
    for (x, y) in [(0, 0), (159, 0), (0, 119), (159, 119)] {
        assert_eq!(p.pixel(x, y)[3], 0);
    }
    assert!(p.rgba.chunks_exact(4).all(|p| p[3] == 0 || p[3] == 255));
    // The cube is 2 m of 2 * 8 * tan(22.5 deg) = 6.6 m: nearer 36 than 50 pixels across.
    let middle: Vec<bool> = (0..160).map(|x| p.pixel(x, 60)[3] == 255).collect();
    let across = middle.iter().filter(|&&c| c).count();
    assert!((36..=44).contains(&across), "{across}");
}

/// No scene: sky above, lighter or darker ground below, alpha 0 everywhere; it does not fail.
#[test]
fn nothing_is_shown_without_a_scene() {
    let mut r = renderer();
    let p = shot(&mut r, front(), DrawMode::Hdlod);
    assert_eq!(covered(&p), 0);
    let top = p.pixel(80, 0);
    assert!(top[2] > top[0], "the sky is blue: {top:?}");
    assert_ne!(top[..3], p.pixel(80, 119)[..3]);
}

/// A pane of glass, half before a red cube and half before the sky: the cube shines through, a
/// little changed; the glass before the sky is masked as an element.
#[test]
fn glass_lets_the_cube_shine_through() {
    let mut pane =
        part(cube(GLASS), at(1.2, 0.0, 2.0) * Affine3A::from_scale(Vec3::new(1.2, 0.8, 0.02)));
    pane.behaviour = Behaviour::new(false, vec![Time::from_seconds(10)]).unwrap();
    let mut r = renderer();
    // The pane comes first in the scene and still is drawn after the cube.
    r.set_scene(&scene(vec![pane, part(cube(RED), Affine3A::IDENTITY)])).unwrap();
    let bare = shot_at(&mut r, front(), DrawMode::Batched, 0);
    let glazed = shot_at(&mut r, front(), DrawMode::Batched, 10);
    let (before, after) = (bare.pixel(88, 60), glazed.pixel(88, 60));
    assert!(shows(&glazed, 88, 60, 0), "{after:?}");
    assert!(after[2] > before[2] + 10, "tinted by the glass: {before:?} {after:?}");
    // Left of the pane nothing has changed.
    assert_eq!(bare.pixel(68, 60), glazed.pixel(68, 60));
    // Over the sky, right of the cube.
    assert_eq!((bare.pixel(112, 60)[3], glazed.pixel(112, 60)[3]), (0, 255));
}

/// Glass behind a solid cube is hidden by it: exactly the picture of the cube alone.
#[test]
fn solid_hides_glass_behind() {
    let mut r = renderer();
    r.set_scene(&scene(vec![part(cube(RED), Affine3A::IDENTITY)])).unwrap();
    let bare = shot(&mut r, front(), DrawMode::Batched);
    let pane = Affine3A::from_translation(Vec3::new(0.0, 0.0, -0.5))
        * Affine3A::from_scale(Vec3::splat(0.4));
    r.set_scene(&scene(vec![part(cube(RED), Affine3A::IDENTITY), part(cube(GLASS), pane)]))
        .unwrap();
    assert_eq!(bare, shot(&mut r, front(), DrawMode::Batched));
}

/// The same half-red, half-green cube twice, the right one mirrored in x: the colours swap sides,
/// and both are lit as bright (a mirrored normal must not point inwards).
#[test]
fn mirrored_instances_are_mirrored_and_lit() {
    let mut mesh = cube(RED);
    for v in &mut mesh.vertices {
        // A cube of two colours: its left half from x = -1 to 0 is red; the face's own cut does not
        // matter here, the sides do.
        if v.position[0] > 0.0 {
            v.material = GREEN;
        }
    }
    let mirror = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let turn = |angle: f32| Affine3A::from_quat(Quat::from_rotation_y(angle));
    let place = |x: f32, inner: Affine3A, angle: f32| at(x, 0.0, 0.0) * turn(angle) * inner;
    let angle = std::f32::consts::FRAC_PI_2;
    let mut r = renderer();
    let view = look(Vec3::new(0.0, 0.0, 12.0), Vec3::ZERO, SIZE);
    // Turned by 90 degrees the right (green) face of the plain cube goes back, its left face (red)
    // to the front; of the mirrored one the green face, now on the left, comes to the front.
    r.set_scene(&scene(vec![
        part(mesh.clone(), place(-2.0, Affine3A::IDENTITY, angle)),
        part(mesh.clone(), place(2.0, mirror, angle)),
    ]))
    .unwrap();
    let p = shot(&mut r, view, DrawMode::Batched);
    assert!(shows(&p, 56, 60, 0), "{:?}", p.pixel(56, 60));
    assert!(shows(&p, 104, 60, 1), "{:?}", p.pixel(104, 60));

    let blue = |x: f32, inner| part(cube(BLUE), at(x, 0.0, 0.0) * inner);
    r.set_scene(&scene(vec![blue(-2.0, Affine3A::IDENTITY), blue(2.0, mirror)])).unwrap();
    let p = shot(&mut r, view, DrawMode::Batched);
    let (plain, mirrored) = (p.pixel(56, 60), p.pixel(104, 60));
    assert!(plain.iter().zip(mirrored).all(|(a, b)| a.abs_diff(b) <= 3), "{plain:?} {mirrored:?}");
}

/// Two storeys: the red one from second 10 on, the blue one above it from 20 to 30. At each date
/// exactly the present ones are there, at toggles too, forward and backward.
#[test]
fn storeys_come_and_go() {
    let toggles = |seconds: &[i64]| {
        Behaviour::new(false, seconds.iter().map(|&s| Time::from_seconds(s)).collect()).unwrap()
    };
    let mut ground = part(cube(RED), at(0.0, -1.0, 0.0));
    ground.behaviour = toggles(&[10]);
    let mut upper = part(cube(BLUE), at(0.0, 1.0, 0.0));
    upper.behaviour = toggles(&[20, 30]);
    let mut r = renderer();
    r.set_scene(&scene(vec![ground, upper])).unwrap();
    let view = look(Vec3::new(0.0, 0.0, 9.0), Vec3::ZERO, SIZE);
    let mut check = |mode: DrawMode, seconds: i64, red: bool, blue: bool| {
        let p = shot_at(&mut r, view, mode, seconds);
        assert_eq!(shows(&p, 80, 72, 0), red, "{mode:?} {seconds}: {:?}", p.pixel(80, 72));
        assert_eq!(shows(&p, 80, 48, 2), blue, "{mode:?} {seconds}: {:?}", p.pixel(80, 48));
        if !red && !blue {
            assert_eq!(covered(&p), 0);
        }
    };
    for mode in [DrawMode::Batched, DrawMode::Objects, DrawMode::Hdlod] {
        for (seconds, red, blue) in [
            (9, false, false),
            (10, true, false),
            (20, true, true),
            (29, true, true),
            (30, true, false),
            (25, true, true),
            (0, false, false),
        ] {
            check(mode, seconds, red, blue);
        }
    }
}

/// Two hundred turned cubes and panes in four rows behind each other.
fn crowd() -> Arc<Scene> {
    let parts = (0..200u16).map(|i| {
        let (x, y, z) = (f32::from(i % 10), f32::from(i / 10 % 5), f32::from(i / 50));
        let place = at(x * 3.0 - 15.0, y * 3.0 - 6.0, z * -3.0)
            * Affine3A::from_quat(Quat::from_rotation_y(f32::from(i)))
            * Affine3A::from_scale(Vec3::new(1.0, 0.7, 1.2));
        part(cube(i % 4), place)
    });
    scene(parts.collect())
}

/// The crowd: one call each gives the picture of one multi-draw, and so do a second frame and
/// another device, byte for byte.
#[test]
fn batched_and_objects_are_identical_and_repeatable() {
    let mut r = renderer();
    r.set_scene(&crowd()).unwrap();
    let view = look(Vec3::new(8.0, 6.0, 22.0), Vec3::ZERO, (320, 200));
    let batched = shot(&mut r, view, DrawMode::Batched);
    assert!(covered(&batched) > 8000);
    assert_eq!(batched, shot(&mut r, view, DrawMode::Batched));
    assert_eq!(batched, shot(&mut r, view, DrawMode::Objects));
    let mut other = renderer();
    other.set_scene(&crowd()).unwrap();
    assert_eq!(batched, shot(&mut other, view, DrawMode::Batched));
}

/// The crowd on a device without optional features (no indirect instances, no timestamps): the
/// same picture in every mode, and no time of the GPU.
#[test]
fn optional_features_are_optional() {
    let view = look(Vec3::new(8.0, 6.0, 22.0), Vec3::ZERO, (320, 200));
    let mut rich = renderer();
    rich.set_scene(&crowd()).unwrap();
    let expected = shot(&mut rich, view, DrawMode::Batched);
    let mut plain = plain_renderer();
    plain.set_scene(&crowd()).unwrap();
    for mode in [DrawMode::Batched, DrawMode::Objects, DrawMode::Hdlod] {
        assert_eq!(expected, shot(&mut plain, view, mode), "{mode:?}");
    }
    plain.wait_idle();
    assert_eq!(plain.gpu_ms(), None);
}

/// The crowd with its HDLOD. Without tolerance the cut is exact: the picture of the batched way.
/// From far away it draws fewer triangles, in clusters. Without the tree it is batched again.
#[test]
fn hdlod_is_exact_without_tolerance_and_cheaper_from_afar() {
    let scene = crowd();
    let tree = hdlod::build(&scene, &hdlod::Settings::default(), &Progress::default()).unwrap();
    let mut r = renderer();
    r.set_scene(&scene).unwrap();
    let bare = r.gpu_bytes();
    r.set_hdlod(&Arc::new(tree)).unwrap();
    assert!(r.has_hdlod() && r.gpu_bytes() > bare);
    let mut view = look(Vec3::new(8.0, 6.0, 22.0), Vec3::ZERO, (320, 200));
    view.tolerance_px = 0.0;
    let batched = shot(&mut r, view, DrawMode::Batched);
    assert_eq!(batched, shot(&mut r, view, DrawMode::Hdlod));

    let mut far = look(Vec3::new(160.0, 120.0, 440.0), Vec3::ZERO, (320, 200));
    far.tolerance_px = 1.0;
    let frame = |mode| FrameInput { view: far, time: Time::default(), mode };
    let coarse = r.render(&frame(DrawMode::Hdlod));
    let shown = covered(&r.read_back().unwrap());
    let full = r.render(&frame(DrawMode::Batched));
    assert!(shown > 0 && coarse.clusters > 0 && coarse.worst_px <= 1.0, "{coarse:?}");
    assert!(coarse.triangles < full.triangles, "{coarse:?} {full:?}");

    r.clear_hdlod();
    assert_eq!(r.gpu_bytes(), bare + (320 * 200 - 1) * 12);
    assert_eq!(shot(&mut r, view, DrawMode::Hdlod), batched);
}

/// The crowd goes up in two halves. When the first half is moved behind the second, the runs of
/// clusters change places: what is sent of them gives the picture that a whole upload gives, at
/// every date, and the scene's geometry stays where it is.
#[test]
fn other_dates_are_sent_in_parts() {
    let from = |day| Behaviour::new(false, vec![Time::from_seconds(day)]).unwrap();
    let mut scene = Scene::clone(&crowd());
    scene.behaviours = vec![from(10), from(20), from(30)];
    let half = |i: usize| BehaviourId(u32::from(i % 4 >= 2));
    scene.element_behaviour = (0..200).map(half).collect();
    let scene = Arc::new(scene);
    let settings = hdlod::Settings::default();
    let tree = hdlod::build(&scene, &settings, &Progress::default()).unwrap();

    let mut after = Scene::clone(&scene);
    let moved = |b: BehaviourId| if b.0 == 0 { BehaviourId(2) } else { b };
    after.element_behaviour.iter_mut().for_each(|b| *b = moved(*b));
    let changed: Vec<_> = (0..200).filter(|i| i % 4 < 2).map(ElementId).collect();
    let mut edited = tree.clone();
    let done = edited.restate(&after, &changed).unwrap();
    assert!(!done.dirty.is_empty());
    let (after, edited) = (Arc::new(after), Arc::new(edited));

    let mut whole = renderer();
    whole.set_scene(&after).unwrap();
    whole.set_hdlod(&edited).unwrap();
    let mut parts = renderer();
    parts.set_scene(&scene).unwrap();
    parts.set_hdlod(&Arc::new(tree)).unwrap();
    let bytes = parts.gpu_bytes();
    parts.update(&after, &edited, &done.dirty).unwrap();
    assert_eq!(parts.gpu_bytes(), bytes);
    // A few pixels a cube: clusters of several cubes are within the tolerance.
    let mut view = look(Vec3::new(32.0, 24.0, 88.0), Vec3::ZERO, (320, 200));
    view.tolerance_px = 6.0;
    let mut seen = Vec::new();
    for day in [15, 25, 35] {
        let input = FrameInput { view, time: Time::from_seconds(day), mode: DrawMode::Hdlod };
        let stats = whole.render(&input);
        assert_eq!(parts.render(&input).triangles, stats.triangles);
        assert!(stats.clusters > 0 || day == 15, "{stats:?}");
        let (a, b) = (whole.read_back().unwrap(), parts.read_back().unwrap());
        assert_eq!(a, b, "day {day}");
        seen.push(covered(&a));
    }
    assert!(seen[0] == 0 && 0 < seen[1] && seen[1] < seen[2], "{seen:?}");
}

/// From the middle of a ring of cubes, in many directions and both projections: leaving out what
/// is outside the frame changes no pixel, and does leave out something.
#[test]
fn culling_loses_nothing() {
    let ring = (0..60).map(|i| {
        let angle = i as f32 * 0.7;
        let (radius, height) = (4.0 + (i % 7) as f32, (i % 9) as f32 - 4.0);
        part(cube((i % 4) as u16), at(angle.sin() * radius, height, angle.cos() * radius))
    });
    let mut r = renderer();
    r.set_scene(&scene(ring.collect())).unwrap();
    let with = r.options();
    let mut fewer = 0;
    for i in 0..12 {
        let angle = i as f32 * 0.55;
        let target = Vec3::new(angle.sin(), (i as f32).sin() * 0.6, angle.cos());
        let mut view = look(Vec3::new(0.3, 0.2, -0.1), target, (96, 64));
        if i % 3 == 2 {
            view.projection = Projection::Orthographic { height: 6.0 };
        }
        let input = FrameInput { view, time: Time::default(), mode: DrawMode::Batched };
        r.set_options(Options { culling: false, ..with });
        let all = r.render(&input);
        let expected = r.read_back().unwrap();
        r.set_options(with);
        let culled = r.render(&input);
        assert_eq!(expected, r.read_back().unwrap(), "direction {i}");
        assert!(culled.draws <= all.draws && all.draws == 60);
        fewer += all.draws - culled.draws;
    }
    assert!(fewer > 100, "{fewer}");
}

/// Parallel rays: a cube of 2 m in a picture 4 m high covers half its height and, the picture being
/// as wide as high, half its width, however far away it stands; also behind the eye's plane.
#[test]
fn parallel_projection_shows_true_sizes() {
    let mut r = renderer();
    r.set_scene(&scene(vec![part(cube(GREEN), Affine3A::IDENTITY)])).unwrap();
    for distance in [0.0, 5.0, 500.0] {
        let mut view = look(Vec3::new(0.0, 0.0, distance), Vec3::new(0.0, 0.0, -1.0), (100, 100));
        view.projection = Projection::Orthographic { height: 4.0 };
        let p = shot(&mut r, view, DrawMode::Batched);
        let count = covered(&p);
        assert!((49 * 49..=51 * 51).contains(&count), "{distance}: {count}");
        assert!(shows(&p, 50, 50, 1));
    }
}

/// The picture changes size between frames: from large to small, odd and one pixel.
#[test]
fn resizing_works() {
    let mut r = renderer();
    r.set_scene(&scene(vec![part(cube(RED), Affine3A::IDENTITY)])).unwrap();
    let mut last = None;
    for (w, h) in [(160, 120), (33, 17), (1, 1), (320, 3), (160, 120)] {
        let p = shot(&mut r, look(FRONT, Vec3::ZERO, (w, h)), DrawMode::Batched);
        assert_eq!((p.width, p.height, p.rgba.len()), (w, h, (w * h * 4) as usize));
        assert!(covered(&p) > 0);
        if (w, h) == (160, 120) {
            assert!(last.replace(p.clone()).is_none_or(|before| before == p));
        }
    }
}

/// A second scene takes the place of the first: only its cube is there, and the memory of the first
/// one is given back.
#[test]
fn a_second_scene_replaces_the_first() {
    let mut r = renderer();
    let crowd = (0..50).map(|i| part(cube(RED), at((i as f32) * 0.1 - 2.5, 0.0, 0.0))).collect();
    r.set_scene(&scene(crowd)).unwrap();
    assert!(covered(&shot(&mut r, front(), DrawMode::Batched)) > 0);
    let crowded = r.gpu_bytes();
    r.set_scene(&scene(vec![part(cube(BLUE), Affine3A::IDENTITY)])).unwrap();
    let p = shot(&mut r, front(), DrawMode::Batched);
    assert!(shows(&p, 80, 60, 2));
    assert_eq!(p.pixel(40, 60)[3], 0);
    assert!(r.gpu_bytes() < crowded);
}

/// Every way against stairs shows the same shapes: same mask but for outlines, and the slanted edge
/// of a turned cube gets tones between cube and background.
#[test]
fn antialiasing_softens_edges() {
    let place = Affine3A::from_quat(Quat::from_rotation_z(0.2));
    let mut r = renderer();
    r.set_scene(&scene(vec![part(cube(RED), place)])).unwrap();
    let mut tones = Vec::new();
    for antialias in [Antialias::Off, Antialias::Smooth, Antialias::Msaa4, Antialias::Off] {
        r.set_options(Options { antialias, edges: 0.0, ..r.options() });
        let p = shot(&mut r, front(), DrawMode::Batched);
        assert!(shows(&p, 80, 60, 0));
        let reds: std::collections::BTreeSet<u8> = (40..80)
            .map(|x| p.pixel(x, 70)[0])
            .chain((40..80).map(|x| p.pixel(x, 50)[0]))
            .collect();
        tones.push((reds.len(), covered(&p)));
    }
    let off = tones[0];
    assert_eq!(off, tones[3]);
    assert!(tones[1].0 > off.0 && tones[2].0 > off.0, "{tones:?}");
    assert_eq!(off.1, tones[1].1, "smoothing does not change the mask");
    assert!(tones[2].1.abs_diff(off.1) < 200, "{tones:?}");
}

/// Edge lines darken the fold between two faces and leave the faces as they are.
#[test]
fn edge_lines_mark_folds() {
    let mut r = renderer();
    r.set_scene(&scene(vec![part(cube(GREEN), Affine3A::from_quat(Quat::from_rotation_y(0.785)))]))
        .unwrap();
    let view = look(Vec3::new(0.0, 0.0, 8.0), Vec3::ZERO, (160, 120));
    let mut pictures = [0.0, 0.5].map(|edges| {
        r.set_options(Options { antialias: Antialias::Off, edges, ..r.options() });
        shot(&mut r, view, DrawMode::Batched)
    });
    let [plain, lined] = &mut pictures;
    // The fold is the vertical middle line; the faces lie 10 pixels to either side.
    let darkest = (78..=82).map(|x| lined.pixel(x, 60)[1]).min().unwrap();
    let brightest = (78..=82).map(|x| plain.pixel(x, 60)[1]).min().unwrap();
    assert!(darkest + 20 < brightest, "{darkest} {brightest}");
    for x in [68, 92] {
        assert_eq!(plain.pixel(x, 60), lined.pixel(x, 60));
    }
}

/// What is counted is what was drawn: of two cubes, one absent, and a pane of glass.
#[test]
fn statistics_count_what_is_drawn() {
    let mut absent = part(cube(RED), at(2.0, 0.0, 0.0));
    absent.behaviour = Behaviour::never();
    let mut r = renderer();
    r.set_scene(&scene(vec![
        part(cube(RED), at(-2.0, 0.0, 0.0)),
        absent,
        part(cube(GLASS), Affine3A::IDENTITY),
    ]))
    .unwrap();
    for mode in [DrawMode::Batched, DrawMode::Objects] {
        let stats = r.render(&FrameInput { view: front(), time: Time::default(), mode });
        assert_eq!((stats.draws, stats.triangles, stats.elements), (2, 24, 2), "{mode:?}");
        assert_eq!((stats.clusters, stats.worst_px), (0, 0.0));
    }
    r.wait_idle();
    assert!(r.gpu_ms().is_none_or(|ms| ms > 0.0 && ms < 60_000.0));
}

/// A cube by the clock of a place: at noon the south side is the brightest, in the morning the east side is
/// brighter than in the evening, at night everything is darker but told apart.
#[test]
fn the_sun_follows_the_clock() {
    let mut r = renderer();
    r.set_scene(&scene(vec![part(cube(GREEN), Affine3A::from_quat(Quat::from_rotation_y(0.785)))]))
        .unwrap();
    let fixed = shot(&mut r, front(), DrawMode::Batched);
    r.set_options(Options {
        sun: Sun::Place { latitude_deg: 48.0, longitude_deg: 15.0 },
        edges: 0.0,
        ..r.options()
    });
    let mut at_hour = |hour: i64| {
        // 20 March 2026.
        let p = shot_at(&mut r, front(), DrawMode::Batched, 1_773_964_800 + hour * 3600);
        // South-west, south-east, sky.
        [(72, 62), (88, 62), (80, 2)].map(|(x, y)| p.pixel(x, y)[1])
    };
    let [morning, noon, evening, night] = [8, 12, 16, 0].map(&mut at_hour);
    assert!(
        morning[1] > morning[0] + 20 && evening[0] > evening[1] + 20,
        "{morning:?} {evening:?}"
    );
    assert!(noon[0].abs_diff(noon[1]) < 12, "{noon:?}");
    assert!(night[2] < noon[2] / 2 + 20 && night[1] > 30, "{night:?} {noon:?}");
    r.set_options(Options { sun: Sun::Fixed, edges: 0.35, ..r.options() });
    assert_eq!(fixed, shot(&mut r, front(), DrawMode::Batched));
}

/// A cube and a pane of glass before one colour: the colour is where nothing is and shines through the glass, the cube
/// looks as ever, and what is marked as an element does not change. Black and white differ by what shines through
/// alone.
#[test]
fn one_colour_stands_behind_the_scene() {
    let mut r = renderer();
    let pane =
        part(cube(GLASS), at(1.6, 0.0, 0.0) * Affine3A::from_scale(Vec3::new(0.5, 1.0, 0.02)));
    r.set_scene(&scene(vec![part(cube(RED), Affine3A::IDENTITY), pane])).unwrap();
    for antialias in [Antialias::Off, Antialias::Smooth, Antialias::Msaa4] {
        let options = Options { antialias, backdrop: Backdrop::Scenery, ..r.options() };
        r.set_options(options);
        let scenery = shot(&mut r, front(), DrawMode::Batched);
        let mut over = |color: [u8; 3]| {
            r.set_options(Options { backdrop: Backdrop::Plain(color), ..options });
            shot(&mut r, front(), DrawMode::Batched)
        };
        let [black, white, odd] = [[0; 3], [255; 3], [10, 200, 77]].map(&mut over);
        assert_eq!(odd.pixel(2, 2), [10, 200, 77, 0], "{antialias:?}");
        assert_eq!(odd.pixel(80, 118), [10, 200, 77, 0], "there is no ground");
        assert_eq!(scenery.pixel(80, 60), odd.pixel(80, 60), "the cube is as ever");
        let marks = |p: &topout_render::Picture| covered(p);
        assert_eq!([marks(&black), marks(&white), marks(&odd)], [marks(&scenery); 3]);
        let glass = (112, 60);
        let [dark, light] = [black.pixel(glass.0, glass.1), white.pixel(glass.0, glass.1)];
        assert!(dark[0] + 60 < light[0] && light[0] < 255, "{dark:?} {light:?}");
        // The same through all three channels.
        let through = |c: usize| i32::from(light[c]) - i32::from(dark[c]);
        assert!((through(0) - through(2)).abs() <= 2, "{dark:?} {light:?}");
    }
}
