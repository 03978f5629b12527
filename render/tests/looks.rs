//! Elements in the colours of what is done to them.
#![allow(clippy::unwrap_used)]

mod common;

use common::{renderer, small_demo};
use glam::UVec2;
use std::sync::Arc;
use topout_render::{Antialias, DrawMode, FrameInput, Occlusion, Options, Picture, Renderer};
use topout_scene::{ElementId, Looks, Scene, View};
use topout_schedule::Look;

fn input(scene: &Scene, mode: DrawMode, at: f64) -> FrameInput {
    let view = View::fit(&scene.focus_bounds(), 30.0, 15.0, 1.0, UVec2::new(320, 200));
    FrameInput { view, time: scene.schedule.period.at_fraction(at), mode }
}

fn shot(r: &mut Renderer, input: &FrameInput) -> Picture {
    r.render(input);
    r.read_back().unwrap()
}

fn plain(r: &mut Renderer) {
    let options = Options { antialias: Antialias::Off, edges: 0.0, ..r.options() };
    r.set_options(options);
}

/// Pixels whose three channels differ by more than `by` somewhere.
fn different(a: &Picture, b: &Picture, by: u8) -> usize {
    let pixels = a.rgba.chunks(4).zip(b.rgba.chunks(4));
    pixels.filter(|(a, b)| a.iter().zip(*b).any(|(x, y)| x.abs_diff(*y) > by)).count()
}

/// Pixels that are clearly red.
fn red(picture: &Picture) -> usize {
    let is_red = |p: &&[u8]| p[0] > 60 && p[0] / 2 > p[1].max(p[2]);
    picture.rgba.chunks(4).filter(is_red).count()
}

#[test]
fn every_way_of_drawing_shows_the_same_colours() {
    let (scene, tree) = small_demo(3000);
    let mut r = renderer(&scene, &tree);
    plain(&mut r);
    let looks = Arc::new(Looks::of_activities(&scene));
    for at in [0.3, 0.6, 0.8] {
        r.set_looks(None).unwrap();
        let own = shot(&mut r, &input(&scene, DrawMode::Batched, at));
        r.set_looks(Some(&looks)).unwrap();
        let [objects, batched, cut] =
            [DrawMode::Objects, DrawMode::Batched, DrawMode::Hdlod].map(|mode| {
                let input = input(&scene, mode, at);
                let exact = View { tolerance_px: 0.0, ..input.view };
                shot(&mut r, &FrameInput { view: exact, ..input })
            });
        assert!(different(&batched, &own, 8) > 50, "something is being built at {at}");
        assert_eq!(different(&batched, &objects, 0), 0);
        assert_eq!(different(&batched, &cut, 0), 0);
        // Going to a date and coming back leaves nothing behind.
        shot(&mut r, &input(&scene, DrawMode::Batched, 0.95));
        assert!(shot(&mut r, &input(&scene, DrawMode::Batched, at)) == batched);
        r.set_looks(None).unwrap();
        assert!(shot(&mut r, &input(&scene, DrawMode::Batched, at)) == own);
    }
}

/// A cut in one colour has clusters in that colour: as red as full detail is.
#[test]
fn clusters_take_a_colour_that_all_of_them_have() {
    let (scene, tree) = small_demo(3000);
    let mut r = renderer(&scene, &tree);
    plain(&mut r);
    let all = (0..scene.model.elements.len() as u32).map(ElementId);
    let looks = Looks::fixed(all.map(|e| (e, Look::colored([200, 0, 0]))));
    r.set_looks(Some(&Arc::new(looks))).unwrap();
    let far = |mode| FrameInput {
        view: View::fit(&scene.focus_bounds(), 30.0, 15.0, 2.0, UVec2::new(320, 200)),
        ..input(&scene, mode, 0.9)
    };
    for occlusion in [Occlusion::Off, Occlusion::Cpu] {
        r.set_options(Options { occlusion, ..r.options() });
        let full = red(&shot(&mut r, &far(DrawMode::Batched)));
        let stats = r.render(&far(DrawMode::Hdlod));
        let cut = red(&r.read_back().unwrap());
        assert!(stats.clusters > 0, "there is something merged");
        assert!(full > 1000 && cut.abs_diff(full) < full / 20, "{cut} of {full}");
    }
}

/// What shines through shows what is behind it, and hides none of it from drawing.
#[test]
fn see_through_elements_hide_nothing() {
    let (scene, tree) = small_demo(3000);
    let mut r = renderer(&scene, &tree);
    plain(&mut r);
    let all = (0..scene.model.elements.len() as u32).map(ElementId);
    let ghost = Look { color: Some([200, 0, 0]), opacity: 0.2 };
    let ghosts: Vec<_> = all.filter(|e| e.0 % 2 == 0).map(|e| (e, ghost)).collect();
    let shots = |r: &mut Renderer, ghosts: Vec<_>| {
        r.set_looks(Some(&Arc::new(Looks::fixed(ghosts)))).unwrap();
        [Occlusion::Off, Occlusion::Cpu].map(|occlusion| {
            r.set_options(Options { occlusion, ..r.options() });
            let input = input(&scene, DrawMode::Hdlod, 0.9);
            let exact = View { tolerance_px: 0.0, ..input.view };
            shot(r, &FrameInput { view: exact, ..input })
        })
    };
    let [full, culled] = shots(&mut r, ghosts.clone());
    assert_eq!(different(&full, &culled, 0), 0, "occlusion changes no picture");
    let solid = ghosts.into_iter().map(|(e, look)| (e, Look { opacity: 1.0, ..look })).collect();
    let [solid, _] = shots(&mut r, solid);
    assert!(red(&full) * 3 < red(&solid), "{} of {}", red(&full), red(&solid));
}
