//! Levels that follow each other share the pixels for a while: each shows one of the two.
#![allow(clippy::unwrap_used)]

mod common;

use common::{renderer, small_demo};
use glam::UVec2;
use std::time::{Duration, Instant};
use topout_render::{Antialias, DrawMode, FrameInput, FrameStats, Options, Picture, Renderer};
use topout_scene::{Scene, View};

const HOUR: Duration = Duration::from_secs(3600);

fn input(scene: &Scene, tolerance_px: f32, at: f64) -> FrameInput {
    let view = View::fit(&scene.focus_bounds(), 30.0, 15.0, 2.0, UVec2::new(320, 200));
    let time = scene.schedule.period.at_fraction(at);
    FrameInput { view: View { tolerance_px, ..view }, time, mode: DrawMode::Hdlod }
}

fn shot(r: &mut Renderer, fade: Duration, input: &FrameInput) -> (FrameStats, Picture) {
    r.set_options(Options { fade, ..r.options() });
    let stats = r.render(input);
    (stats, r.read_back().unwrap())
}

/// The step of four at which each pixel of a picture is of `old` or of `new`, as the pattern says.
fn step(picture: &Picture, old: &Picture, new: &Picture) -> Option<u32> {
    const ORDER: [[u32; 2]; 2] = [[0, 2], [3, 1]];
    let width = picture.width as usize;
    let (all, old, new) = [picture, old, new].map(|p| p.rgba.chunks(4)).into();
    let pixels: Vec<_> = all.zip(old).zip(new).enumerate().collect();
    (0..4).find(|&step| {
        pixels.iter().all(|(at, ((pixel, old), new))| {
            let order = ORDER[at / width % 2][at % width % 2];
            *pixel == if order < step { *new } else { *old }
        })
    })
}

#[test]
fn every_pixel_shows_the_old_level_or_the_new_one() {
    let (scene, tree) = small_demo(3000);
    let mut r = renderer(&scene, &tree);
    let plain = Options { antialias: Antialias::Off, edges: 0.0, ..r.options() };
    r.set_options(plain);
    let (fine, coarse) = (input(&scene, 4.0, 0.8), input(&scene, 7.0, 0.8));
    // A fade of a nanosecond is over when the next frame begins; nothing fades in the first.
    let at_once = Duration::from_nanos(1);
    let [old, new] = [&fine, &coarse].map(|input| {
        r.set_options(plain);
        let (stats, picture) = shot(&mut r, at_once, input);
        assert_eq!(stats.fading, 0);
        picture
    });
    assert!(old != new);

    r.set_options(plain);
    assert!(shot(&mut r, HOUR, &fine).1 == old);
    let before = Instant::now();
    let (stats, picture) = shot(&mut r, HOUR, &coarse);
    assert!(stats.fading > 0);
    assert_eq!(step(&picture, &old, &new), Some(0), "it begins with the old level");
    let mut steps = Vec::new();
    for part in [1.3, 1.7, 2.5, 5.0, 10.0, 1e9] {
        // So long that this part of it is over about now.
        let (stats, picture) = shot(&mut r, before.elapsed().mul_f64(part), &coarse);
        if stats.fading > 0 {
            steps.push(step(&picture, &old, &new).expect("each pixel is of one of the two"));
        } else {
            assert!(picture == new, "it ends with the new level");
            assert!(shot(&mut r, HOUR, &fine).0.fading > 0, "and may begin again");
        }
    }
    println!("{steps:?}");
    assert!(steps.iter().all(|step| *step < 4) && steps.contains(&0));
    let (stats, picture) = shot(&mut r, at_once, &coarse);
    assert!(stats.fading == 0 && picture == new);
}

/// What comes or goes with the date does so at once, and without fading nothing is different.
#[test]
fn dates_do_not_fade() {
    let (scene, tree) = small_demo(3000);
    let mut r = renderer(&scene, &tree);
    let dates = [0.3, 0.6, 0.4, 0.9, 0.0];
    let tolerance = 4.0;
    let fading = dates.map(|at| shot(&mut r, HOUR, &input(&scene, tolerance, at)));
    let plain = dates.map(|at| shot(&mut r, Duration::ZERO, &input(&scene, tolerance * 0.8, at)));
    for (at, (a, b)) in dates.iter().zip(fading.iter().zip(&plain)) {
        assert_eq!(a.0.fading, 0, "at {at}");
        assert_eq!((a.0.clusters, a.0.triangles), (b.0.clusters, b.0.triangles));
        assert!(a.1 == b.1, "at {at}");
    }
}
