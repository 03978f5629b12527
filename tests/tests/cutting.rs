//! What planners do to see into a building and to hold plans against each other: cut, measure, compare, draw
//! storeys apart.
//!
//! As in `window.rs`, widgets are found by the names that screen readers hear.
#![allow(clippy::unwrap_used)]

use egui::{Key, Modifiers, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::{Vec2, Vec3};
use std::sync::Arc;
use topout::window::{
    Against, Choose, Command, ElementColors, Half, Panel, Section, Window, write_schedule,
};
use topout_scene::ElementId;
use topout_schedule::{DateSet, Time, TimeRange};
use topout_tests::window::{apply, drag, open_sized, picture, settle, state, view};

fn open() -> Harness<'static, Window> {
    let mut harness = open_sized([1280.0, 800.0]);
    apply(&mut harness, Command::ToEnd);
    apply(&mut harness, Command::Fit);
    // They are other ones in each picture.
    apply(&mut harness, Command::Toggle(Panel::Figures));
    harness
}

fn press(harness: &mut Harness<'_, Window>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    settle(harness);
}

fn click(harness: &mut Harness<'_, Window>, at: Pos2) {
    harness.hover_at(at);
    harness.step();
    for pressed in [true, false] {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        harness.step();
    }
    settle(harness);
}

/// Of the 3D view, which is as large as in points.
fn pixel(harness: &Harness<'_, Window>, at: Pos2) -> Vec2 {
    let at = at - view(harness).min;
    Vec2::new(at.x, at.y)
}

fn position(harness: &Harness<'_, Window>, point: Vec3) -> Pos2 {
    let at = state(harness).camera.project(point, state(harness).picture).unwrap();
    view(harness).min + egui::vec2(at.x, at.y)
}

#[test]
fn a_section_opens_the_building_and_is_pulled_and_taken_back() {
    let mut harness = open();
    let whole = picture(&mut harness);
    let middle = view(&harness).center();
    let in_front = state(&harness).pick(Half::Shown, pixel(&harness, middle)).unwrap();
    press(&mut harness, Modifiers::NONE, Key::Q);
    let boxed = state(&harness).section.boxed.unwrap();
    assert!(state(&harness).section.on);
    // Pull the top down to a third of the height: the arrow's point follows.
    let (top, foot) = (boxed.side(2).at, boxed.side(3).at);
    let [from, to] = [top, foot.lerp(top, 0.33)].map(|p| position(&harness, p));
    drag(&mut harness, &[from, from.lerp(to, 0.4), to]);
    settle(&mut harness);
    let pulled = state(&harness).section.boxed.unwrap();
    let height = (pulled.half.y / boxed.half.y - 0.33).abs();
    assert!(height < 0.04, "{pulled:?} {boxed:?}");
    assert!((pulled.side(3).at - foot).length() < 1e-3);
    assert!(picture(&mut harness) != whole);
    // What is cut away is looked through.
    let at = pixel(&harness, position(&harness, in_front.point));
    if let Some(hit) = state(&harness).pick(Half::Shown, at) {
        assert!(state(&harness).section.clip().contains(hit.point - hit.normal * 1e-3));
        assert!(hit.point.y < pulled.center.y + pulled.half.y + 1e-2);
    }
    // One drag is one step; so was the box.
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(state(&harness).section.boxed, Some(boxed));
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(state(&harness).section, Section::default());
    assert!(picture(&mut harness) == whole);
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(state(&harness).section.boxed, Some(boxed));
}

#[test]
fn sections_are_set_by_numbers_and_kept_with_viewpoints() {
    let mut harness = open();
    apply(&mut harness, Command::Toggle(Panel::Section));
    harness.get_by_label("Add a section plane: Level").click();
    settle(&mut harness);
    let plane = state(&harness).section.planes[0];
    assert_eq!(plane.outward, Vec3::Y);
    let below = picture(&mut harness);
    harness.get_by_label("Flip section plane 1").click();
    settle(&mut harness);
    assert_eq!(state(&harness).section.planes[0].outward, Vec3::NEG_Y);
    assert!(picture(&mut harness) != below);
    press(&mut harness, Modifiers::NONE, Key::V);
    harness.get_by_label("Remove section plane 1").click();
    settle(&mut harness);
    assert!(state(&harness).section.is_empty());
    apply(&mut harness, Command::ShowViewpoint(0));
    assert_eq!(state(&harness).section.planes[0].outward, Vec3::NEG_Y);
    harness.get_by_label("Section off").click();
    settle(&mut harness);
    assert!(!state(&harness).section.on && !state(&harness).section.is_empty());
}

#[test]
fn two_clicks_measure() {
    let mut harness = open();
    press(&mut harness, Modifiers::NONE, Key::Y);
    let selected = state(&harness).selected.elements().to_vec();
    let middle = view(&harness).center();
    let [a, b] = [middle, middle + egui::vec2(0.0, 40.0)];
    click(&mut harness, a);
    assert!(state(&harness).measure.start.is_some());
    click(&mut harness, b);
    let [from, to] = state(&harness).measure.taken[0];
    for (point, at) in [(from, a), (to, b)] {
        // At most the reach of a corner away.
        assert!(position(&harness, point).distance(at) < 10.0);
    }
    let text = format!("1: {:.3} m", from.distance(to));
    assert!(harness.query_by_label_contains(&text).is_some(), "{text}");
    assert_eq!(state(&harness).selected.elements(), selected, "measuring selects nothing");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!state(&harness).measure.on);
    harness.get_by_label("Remove distances").click();
    settle(&mut harness);
    assert!(state(&harness).measure.taken.is_empty());
}

/// The pixels of the right half of the 3D view.
fn halves(harness: &mut Harness<'_, Window>) -> [Vec<u8>; 2] {
    let places = ["3D view", "3D view of the other plan"].map(|l| harness.get_by_label(l).rect());
    let image = harness.render().unwrap();
    // Without what floats over the corners: names and cards are not the same.
    places.map(|place| {
        let (x, y) = (place.min.x as u32 + 40, place.center().y as u32 - 60);
        let width = place.width() as u32 - 160;
        image::imageops::crop_imm(&image, x, y, width, 160).to_image().into_raw()
    })
}

#[test]
fn what_if_is_held_against_the_plan_as_it_was() {
    let mut harness = open();
    apply(&mut harness, Command::Compare(Against::Now));
    let [left, right] = ["3D view", "3D view of the other plan"];
    let [left, right] = [left, right].map(|label| harness.get_by_label(label).rect());
    assert_eq!(left.size(), right.size());
    assert!(right.left() > left.right() && right.left() - left.right() < 4.0);
    let [shown, other] = halves(&mut harness);
    assert!(shown == other, "one camera, one date, one plan");

    // All that stands on the last day comes two years later.
    let project = state(&harness).project.clone().unwrap();
    let range = project.calendar.period();
    let day = 86_400;
    let late = |t: TimeRange| TimeRange {
        start: t.start.plus_seconds(730 * day),
        end: t.end.plus_seconds(730 * day),
    };
    let middle = egui::pos2(left.center().x, left.center().y);
    let hit = state(&harness).pick(Half::Shown, pixel(&harness, middle)).unwrap();
    let activity = project.scene.activities_of(hit.element).first().copied();
    let Some(activity) = activity else { panic!("a building element has an activity") };
    let dates = project.scene.schedule.activities[activity as usize].dates().unwrap();
    apply(&mut harness, Command::MoveActivity(activity as usize, late(dates)));
    assert!(state(&harness).period().end >= range.end);
    let time = project.calendar.period().end;
    apply(&mut harness, Command::JumpTo(time));
    let at = pixel(&harness, middle);
    let [now, was] =
        [Half::Shown, Half::Other].map(|half| state(&harness).pick(half, at).map(|h| h.element));
    assert_eq!(was, Some(hit.element));
    assert_ne!(now, was);
    let [shown, other] = halves(&mut harness);
    assert!(shown != other);
    // A click on the right selects what stands there.
    click(&mut harness, egui::pos2(right.center().x, right.center().y));
    assert_eq!(state(&harness).selected.elements(), [hit.element]);
    press(&mut harness, Modifiers::NONE, Key::E);
    assert!(state(&harness).compared.is_none());
    assert!(harness.query_by_label("3D view of the other plan").is_none());
}

#[test]
fn dates_that_nobody_has_are_no_comparison() {
    let mut harness = open();
    apply(&mut harness, Command::Compare(Against::Dates(DateSet::Baseline)));
    assert!(state(&harness).compared.is_none());
    let error = state(&harness).error.clone().unwrap();
    assert!(error.contains("baseline"), "{error}");
    apply(&mut harness, Command::Compare(Against::Schedule("nowhere/plan.csv".into())));
    let error = state(&harness).error.clone().unwrap();
    assert!(error.contains("plan.csv"), "{error}");
    apply(&mut harness, Command::DismissError);
    apply(&mut harness, Command::Compare(Against::Dates(DateSet::Planned)));
    assert!(state(&harness).compared.is_some() && state(&harness).error.is_none());
}

#[test]
fn storeys_stand_apart_and_together_again() {
    let mut harness = open();
    let (project, whole) = (state(&harness).project.clone().unwrap(), picture(&mut harness));
    press(&mut harness, Modifiers::SHIFT, Key::E);
    let apart = state(&harness).project.clone().unwrap();
    let lifted = (project.scene.model.elements.iter().zip(&apart.scene.model.elements))
        .map(|(before, after)| after.bounds.min.y - before.bounds.min.y)
        .fold(0.0, f32::max);
    assert!(lifted >= 8.0, "{lifted}");
    assert!(state(&harness).ready_tree().is_some(), "it has a tree of its own");
    assert!(picture(&mut harness) != whole);
    // What one sees is what one picks: the element is where it is drawn.
    let at = pixel(&harness, view(&harness).center());
    if let Some(hit) = state(&harness).pick(Half::Shown, at) {
        let bounds = &apart.scene.model.elements[hit.element.index()].bounds;
        assert!(bounds.grown(0.01).distance(hit.point) == 0.0);
    }
    harness.get_by_label("Storeys together").click();
    settle(&mut harness);
    assert!(Arc::ptr_eq(&project, state(&harness).project.as_ref().unwrap()));
    assert!(picture(&mut harness) == whole);

    // Dates that were changed meanwhile stay changed.
    apply(&mut harness, Command::Explode(3.0));
    let dates = project.scene.schedule.activities[5].dates().unwrap();
    let later =
        TimeRange { start: dates.start.plus_seconds(86_400), end: dates.end.plus_seconds(86_400) };
    apply(&mut harness, Command::MoveActivity(5, later));
    apply(&mut harness, Command::Explode(0.0));
    let scene = &state(&harness).project.as_ref().unwrap().scene;
    assert!(Arc::ptr_eq(&scene.model, &project.scene.model));
    assert_eq!(scene.schedule.activities[5].dates(), Some(later));
}

#[test]
fn a_look_ahead_shows_what_comes() {
    let mut harness = open();
    let time = Time::parse_iso("2027-01-04T07:00").unwrap();
    apply(&mut harness, Command::JumpTo(time));
    let project = state(&harness).project.clone().unwrap();
    // Something that comes in the next days.
    let soon = |id: &ElementId| {
        let scene = &project.scene;
        let starts = scene.activities_of(*id).iter();
        let starts = starts.filter_map(|a| scene.schedule.activities[*a as usize].start);
        let behaviour = scene.behaviour(*id);
        let next = starts.filter(|start| *start > time).min();
        !behaviour.at(time)
            && next.is_some_and(|n| n < time.plus_seconds(5 * 86_400) && behaviour.at(n))
    };
    let all = (0..project.scene.model.elements.len() as u32).map(ElementId);
    let coming = all.filter(soon).max_by(|a, b| {
        let size = |id: &ElementId| project.scene.model.elements[id.index()].bounds.diameter();
        size(a).total_cmp(&size(b))
    });
    let coming = coming.expect("something comes");
    apply(&mut harness, Command::Choose(Choose::Only, vec![coming]));
    apply(&mut harness, Command::FitSelection);
    apply(&mut harness, Command::ClearSelection);
    let before = picture(&mut harness);
    press(&mut harness, Modifiers::ALT, Key::A);
    assert_eq!(state(&harness).colors, ElementColors::LookAhead(4));
    assert!(picture(&mut harness) != before);
    let rows = state(&harness).coloring.legend();
    let row = |name: &str| rows.iter().find(|row| row.name == name).unwrap();
    assert!(row("starts within a week").elements > 0);
    assert_eq!(rows.len(), 5);
    // It is there to be seen, with the first week's colour, and not to be clicked.
    let bounds = project.scene.model.elements[coming.index()].bounds;
    let at = position(&harness, bounds.center());
    let hit = state(&harness).pick(Half::Shown, pixel(&harness, at));
    assert_ne!(hit.map(|hit| hit.element), Some(coming));
    apply(&mut harness, Command::LookAhead(2));
    assert_eq!(state(&harness).coloring.legend().len(), 3);
    press(&mut harness, Modifiers::ALT, Key::A);
    assert_eq!(state(&harness).colors, ElementColors::Own);
}

#[test]
fn what_if_is_saved_and_read_again() {
    let mut harness = open();
    let schedule = |harness: &Harness<'_, Window>| {
        state(harness).project.clone().unwrap().scene.schedule.clone()
    };
    let dates = schedule(&harness).activities[3].dates().unwrap();
    let later =
        TimeRange { start: dates.start.plus_seconds(86_400), end: dates.end.plus_seconds(86_400) };
    apply(&mut harness, Command::MoveActivity(3, later));
    let schedule = schedule(&harness);
    let folder = tempfile::tempdir().unwrap();
    for name in ["plan.json", "plan.csv", "plan"] {
        let path = write_schedule(&schedule, &folder.path().join(name)).unwrap();
        let read =
            topout_schedule::read_files(std::slice::from_ref(&path), &Default::default()).unwrap();
        assert_eq!(read.activities.len(), schedule.activities.len());
        for (a, b) in read.activities.iter().zip(&schedule.activities) {
            assert_eq!(
                (a.dates(), &a.predecessors),
                (b.dates(), &b.predecessors),
                "{name}: {}",
                a.id
            );
        }
        assert_eq!(read.activities[3].dates(), Some(later));
    }
    let error = write_schedule(&schedule, &folder.path().join("none/plan.json")).unwrap_err();
    assert!(format!("{error:#}").contains("plan.json"), "{error:#}");
}
