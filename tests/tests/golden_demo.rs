//! The demo project as it should look: three dates, three coverages, drawn with HDLOD.
#![allow(clippy::unwrap_used)]

use glam::{UVec2, Vec3};
use std::sync::Arc;
use topout::flip::Difference;
use topout_render::DrawMode;
use topout_scene::{BehaviourId, Clip, Element, Scene, View};
use topout_schedule::Behaviour;
use topout_tests::{Stage, demo_scene, golden};

const SIZE: UVec2 = UVec2::new(480, 270);

/// Dates as fractions of the period, with the name that the pictures bear.
const DATES: [(f64, &str); 3] = [(1.0 / 3.0, "third"), (2.0 / 3.0, "two_thirds"), (1.0, "end")];

/// Distances as multiples of the fitting one.
const DISTANCES: [(f32, &str); 3] = [(1.0, "full"), (2.0, "quarter"), (4.0, "sixteenth")];

/// Each picture shows the site in the standard view: the tower grows from date to date, and gets
/// smaller from coverage to coverage; ground and sky fill the rest.
#[test]
fn the_demo_looks_as_it_should() {
    let mut stage = Stage::with_tree(demo_scene());
    let mut faults = Vec::new();
    for (fraction, date) in DATES {
        for (distance, coverage) in DISTANCES {
            let (view, time) = (stage.standard_view(distance, SIZE), stage.date(fraction));
            let picture = stage.picture(view, time, DrawMode::Hdlod);
            faults.extend(golden::check(&format!("demo_{date}_{coverage}"), &picture).err());
        }
    }
    let cut = cut_open(&mut stage, &mut faults);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    cut.unwrap();
}

/// The tower cut open: storeys and core are filled where the planes go through. Clusters and exact elements differ
/// no more than they do of the whole.
fn cut_open(stage: &mut Stage, faults: &mut Vec<String>) -> Result<(), String> {
    let time = stage.date(1.0);
    let mut clip = Clip::NONE;
    assert!(clip.cut(Vec3::Z * 5.0, Vec3::Z) && clip.cut(Vec3::Y * 150.0, Vec3::Y));
    let whole = stage.standard_view(0.3, SIZE);
    let mut of = |clip: Clip| {
        let view = View { clip, ..whole };
        let [picture, exact] =
            [DrawMode::Hdlod, DrawMode::Batched].map(|mode| stage.picture(view, time, mode));
        if !clip.is_none() {
            faults.extend(golden::check("demo_cut", &picture).err());
        }
        Difference::between(&exact, &picture).unwrap()
    };
    let (within, of_whole) = (of(clip), of(Clip::NONE));
    println!("cut {within:?}, whole {of_whole:?}");
    match within.elements <= of_whole.elements {
        true => Ok(()),
        false => Err(format!("{within:?} {of_whole:?}")),
    }
}

/// The scene without the elements of which `left_out` holds.
fn without(scene: &Scene, left_out: impl Fn(&Element) -> bool) -> Arc<Scene> {
    let mut scene = scene.clone();
    let never = BehaviourId(scene.behaviours.len() as u32);
    scene.behaviours.push(Behaviour::never());
    for (element, behaviour) in scene.model.elements.iter().zip(&mut scene.element_behaviour) {
        if left_out(element) {
            *behaviour = never;
        }
    }
    Arc::new(scene)
}

/// The thresholds of the golden pictures see a single missing storey, and that of `bench` sees
/// that nothing at all is drawn, from every distance.
#[test]
fn what_is_missing_does_not_match() {
    let whole = demo_scene();
    let storey = "Storey 25";
    assert!(whole.model.elements.iter().filter(|e| e.storey == storey).count() > 500);
    let part = without(&whole, |e| e.storey == storey);
    let nothing = without(&whole, |_| true);
    let mut stage = Stage::new(whole);
    let end = stage.date(1.0);
    let views = DISTANCES.map(|(distance, _)| stage.standard_view(distance, SIZE));
    let expected = views.map(|view| stage.picture(view, end, DrawMode::Batched));
    stage.replace(part);
    for (view, expected) in views.into_iter().zip(&expected) {
        let picture = stage.picture(view, end, DrawMode::Batched);
        let difference = Difference::between(expected, &picture).unwrap();
        assert!(!golden::matches(&difference), "without {storey}: {difference:?}");
    }
    stage.replace(nothing);
    for (view, expected) in views.into_iter().zip(&expected) {
        let picture = stage.picture(view, end, DrawMode::Batched);
        let difference = Difference::between(expected, &picture).unwrap();
        println!("without anything: {difference:?}");
        assert!(
            difference.elements > Difference::ANOTHER_PICTURE,
            "without anything: {difference:?}"
        );
        assert_eq!(difference.coverage_change, -1.0);
    }
}
