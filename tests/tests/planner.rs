//! What planners do with the window: scrub, play, list, select, hide, colour, move.
//!
//! As in `window.rs`, widgets are found by the names that screen readers hear.
#![allow(clippy::unwrap_used)]

use egui::{Key, Modifiers, MouseWheelUnit, Pos2, TouchPhase};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use topout::window::{
    COLUMNS, Choose, Command, ElementColors, Filter, Half, Panel, Run, Shown, Speed, Step, Window,
};
use topout_scene::ElementId;
use topout_schedule::Time;
use topout_tests::window::{
    apply, apply_now, axis, drag, open_sized, picture, scene, settle, state, view,
};

/// As large as most screens, so that panels do not cover each other.
fn open() -> Harness<'static, Window> {
    open_sized([1280.0, 800.0])
}

fn time(text: &str) -> Time {
    Time::parse_iso(text).unwrap()
}

/// A point of the timeline, by its share of the width.
fn on_axis(harness: &Harness<'_, Window>, share: f32) -> Pos2 {
    let place = axis(harness);
    Pos2::new(place.min.x + place.width() * share, place.min.y + 50.0)
}

fn turn_wheel(harness: &mut Harness<'_, Window>, at: Pos2, notches: f32, modifiers: Modifiers) {
    harness.hover_at(at);
    harness.event(egui::Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        delta: egui::vec2(0.0, notches),
        phase: TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers,
    });
    harness.run();
}

/// Types into a field, one event a character.
fn type_into(harness: &mut Harness<'_, Window>, label: &str, text: &str) {
    harness.get_by_label(label).focus();
    harness.run();
    harness.get_by_label(label).type_text(text);
    harness.run();
}

#[test]
fn the_timeline_zooms_about_the_cursor_pans_and_fits() {
    let mut harness = open();
    let at = on_axis(&harness, 0.3);
    let under = |harness: &Harness<'_, Window>| state(harness).scale.at(0.3).seconds();
    let (whole, instant) = (state(&harness).scale, under(&harness));
    turn_wheel(&mut harness, at, 6.0, Modifiers::NONE);
    let near = state(&harness).scale.range();
    assert!(near.seconds() < whole.range().seconds() / 3);
    assert!((under(&harness) - instant).abs() < near.seconds() / 300, "it stays under the cursor");

    // The middle button drags time along.
    let press = |harness: &mut Harness<'_, Window>, pos, pressed| {
        let (button, modifiers) = (egui::PointerButton::Middle, Modifiers::NONE);
        harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
        harness.step();
    };
    let date = state(&harness).time();
    press(&mut harness, at, true);
    harness.hover_at(at + egui::vec2(-90.0, 0.0));
    harness.step();
    press(&mut harness, at + egui::vec2(-90.0, 0.0), false);
    assert!(state(&harness).scale.range().start > near.start);
    assert_eq!(state(&harness).time(), date, "panning does not scrub");

    harness.hover_at(at);
    for _ in 0..2 {
        for pressed in [true, false] {
            let (button, modifiers) = (egui::PointerButton::Primary, Modifiers::NONE);
            harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        }
        harness.step();
    }
    harness.run();
    assert_eq!(state(&harness).scale, whole, "a double click shows everything again");
}

#[test]
fn dragging_with_shift_makes_a_loop_that_playing_stays_in() {
    let mut harness = open();
    let points = [0.4, 0.5, 0.6].map(|share| on_axis(&harness, share));
    harness.event_modifiers(egui::Event::PointerMoved(points[0]), Modifiers::SHIFT);
    harness.step();
    let press = |harness: &mut Harness<'_, Window>, pos, pressed| {
        let (button, modifiers) = (egui::PointerButton::Primary, Modifiers::SHIFT);
        harness.event_modifiers(
            egui::Event::PointerButton { pos, button, pressed, modifiers },
            Modifiers::SHIFT,
        );
        harness.step();
    };
    let before = state(&harness).time();
    press(&mut harness, points[0], true);
    for at in &points[1..] {
        harness.event_modifiers(egui::Event::PointerMoved(*at), Modifiers::SHIFT);
        harness.step();
    }
    press(&mut harness, points[2], false);
    let looped = state(&harness).clock.looped().expect("a loop");
    let scale = state(&harness).scale;
    assert!((scale.share(looped.start) - 0.4).abs() < 0.01, "{looped:?}");
    assert!((scale.share(looped.end) - 0.6).abs() < 0.01);
    assert_eq!(state(&harness).time(), before, "Shift does not scrub");

    apply_now(&mut harness, Command::SetSpeed(Speed::Whole(10)));
    harness.get_by_label("Play").click();
    for _ in 0..300 {
        harness.step();
        assert!(state(&harness).clock.is_playing());
    }
    let now = state(&harness).time();
    assert!(looped.start <= now && now <= looped.end, "{now}");
    harness.get_by_label("Pause").click();
    harness.run();
    harness.key_press_modifiers(Modifiers::SHIFT, Key::R);
    harness.run();
    assert_eq!(state(&harness).clock.looped(), None);
}

#[test]
fn j_k_and_l_shuttle_and_keys_step_by_hours_months_and_events() {
    let mut harness = open();
    for (key, run, times) in [
        (Key::L, Run::Forward, 1),
        (Key::L, Run::Forward, 2),
        (Key::J, Run::Backward, 1),
        (Key::J, Run::Backward, 2),
        (Key::K, Run::Still, 1),
    ] {
        harness.key_press(key);
        harness.step();
        harness.step();
        assert_eq!((state(&harness).clock.run(), state(&harness).clock.shuttle()), (run, times));
    }
    apply(&mut harness, Command::JumpTo(time("2027-01-31")));
    for (modifiers, key, expected) in [
        (Modifiers::ALT, Key::ArrowRight, "2027-02-28"),
        (Modifiers::ALT, Key::ArrowLeft, "2027-01-28"),
        (Modifiers::NONE, Key::Period, "2027-01-28T01:00"),
        (Modifiers::NONE, Key::Comma, "2027-01-28"),
    ] {
        harness.key_press_modifiers(modifiers, key);
        harness.run();
        assert_eq!(state(&harness).time(), time(expected), "{modifiers:?} {key:?}");
    }
    harness.key_press_modifiers(Modifiers::COMMAND, Key::ArrowRight);
    harness.run();
    let event = state(&harness).time();
    let starts_or_ends =
        |a: &topout_schedule::Activity| a.start == Some(event) || a.end == Some(event);
    assert!(event > time("2027-01-28") && scene().schedule.activities.iter().any(starts_or_ends));
    harness.get_by_label("Stop playing").click();
    harness.run();
    assert_eq!(state(&harness).time(), state(&harness).period().start);
}

#[test]
fn the_timeline_is_a_slider_whose_value_is_the_date() {
    let harness = open();
    let slider = harness.get_by_role(egui::Role::Slider);
    let node = slider.accesskit_node();
    assert_eq!(node.value().as_deref(), Some("1 Jan 2027, Friday · week 44"));
}

#[test]
fn the_gantt_chart_is_searched_filtered_and_leads_to_elements() {
    let mut harness = open();
    apply(&mut harness, Command::Toggle(Panel::Gantt));
    let all = scene().schedule.activities.len();
    assert_eq!(state(&harness).gantt.passing(), all);
    harness.get_by_label("Active now").click();
    harness.run();
    let now = state(&harness).time();
    let active = |a: &topout_schedule::Activity| {
        a.start.is_some_and(|s| s <= now) && a.end.is_some_and(|e| now < e)
    };
    let expected = scene().schedule.activities.iter().filter(|a| active(a)).count();
    assert!(expected > 0);
    assert_eq!(state(&harness).gantt.passing(), expected);
    harness.get_by_label("Clear filters").click();
    harness.run();
    let wanted = &scene().schedule.activities[40];
    type_into(&mut harness, "Search activities", &wanted.id.to_lowercase());
    assert_eq!(state(&harness).gantt.filter.text, wanted.id.to_lowercase());
    assert!(state(&harness).clock.run() == Run::Still, "typing asks for nothing else");
    harness.get_by_label(&wanted.name).click();
    harness.run();
    let (scene, selected) = (scene(), &state(&harness).selected);
    assert_eq!(selected.activity(), Some(40));
    let linked = (0..scene.model.elements.len() as u32).map(ElementId);
    let linked: Vec<_> = linked.filter(|id| scene.activities_of(*id).contains(&40)).collect();
    assert!(!linked.is_empty());
    assert_eq!(selected.elements(), linked);
    // The inspector says when; a click there goes to it.
    harness.get_all_by_role(egui::Role::Link).next().unwrap().click();
    harness.run();
    assert_eq!(state(&harness).time(), wanted.start.unwrap());
}

/// The other way: a click on the building lists its activity.
#[test]
fn a_click_on_the_building_brings_its_activity_into_the_chart() {
    let mut harness = open();
    apply(&mut harness, Command::Toggle(Panel::Gantt));
    apply(&mut harness, Command::FoldAll(true));
    apply(&mut harness, Command::ToEnd);
    let element = (0..scene().model.elements.len() as u32)
        .map(ElementId)
        .rfind(|id| !scene().activities_of(*id).is_empty())
        .unwrap();
    apply(&mut harness, Command::Choose(Choose::Only, vec![element]));
    let activity = scene().activities_of(element)[0] as usize;
    let name = &scene().schedule.activities[activity].name;
    harness.run();
    assert!(harness.query_all_by_label(name).next().is_some(), "{name} is not in sight");
}

#[test]
fn a_bar_is_dragged_and_that_is_taken_back() {
    let mut harness = open();
    apply(&mut harness, Command::Toggle(Panel::Gantt));
    let activity = scene().schedule.activities.iter().position(|a| a.dates().is_some()).unwrap();
    let id = scene().schedule.activities[activity].id.clone();
    let filter = Filter { text: id.clone(), ..Filter::default() };
    apply(&mut harness, Command::SetFilter(Box::new(filter)));
    let dates = |harness: &Harness<'_, Window>| {
        let scene = &state(harness).project.as_ref().unwrap().scene;
        scene.schedule.activities[activity].dates().unwrap()
    };
    let before = dates(&harness);
    let bar = harness.get_by_label(&format!("Bar of {id}")).rect().center();
    drag(&mut harness, &[bar, bar + egui::vec2(20.0, 0.0), bar + egui::vec2(40.0, 0.0)]);
    settle(&mut harness);
    let after = dates(&harness);
    assert!(after.start > before.start && after.seconds() == before.seconds(), "{after:?}");
    assert_eq!((after.start.seconds() - before.start.seconds()) % 86_400, 0, "by whole days");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run();
    settle(&mut harness);
    assert_eq!(dates(&harness), before);
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    harness.run();
    settle(&mut harness);
    assert_eq!(dates(&harness), after);
}

#[test]
fn ctrl_toggles_shift_adds_and_a_frame_selects_what_is_in_it() {
    let mut harness = open();
    apply(&mut harness, Command::ToEnd);
    let middle = view(&harness).center();
    let click = |harness: &mut Harness<'_, Window>, pos, modifiers| {
        for pressed in [true, false] {
            let button = egui::PointerButton::Primary;
            let event = egui::Event::PointerButton { pos, button, pressed, modifiers };
            harness.event_modifiers(event, modifiers);
            harness.step();
        }
        harness.run();
    };
    harness.hover_at(middle);
    harness.step();
    click(&mut harness, middle, Modifiers::NONE);
    let first = state(&harness).selected.only().expect("the building stands in the middle");
    let other = middle + egui::vec2(0.0, 60.0);
    harness.hover_at(other);
    harness.step();
    click(&mut harness, other, Modifiers::SHIFT);
    assert_eq!(state(&harness).selected.elements().len(), 2);
    assert!(state(&harness).selected.contains(first));
    click(&mut harness, other, Modifiers::COMMAND);
    assert_eq!(state(&harness).selected.only(), Some(first));

    // A frame around everything, from left to right.
    let place = view(&harness).shrink(3.0);
    let press = |harness: &mut Harness<'_, Window>, pos, pressed| {
        let (button, modifiers) = (egui::PointerButton::Primary, Modifiers::COMMAND);
        let event = egui::Event::PointerButton { pos, button, pressed, modifiers };
        harness.event_modifiers(event, modifiers);
        harness.step();
    };
    let corners = [place.left_bottom() + egui::vec2(90.0, -90.0), place.right_top()];
    harness.event_modifiers(egui::Event::PointerMoved(corners[0]), Modifiers::COMMAND);
    harness.step();
    press(&mut harness, corners[0], true);
    for at in [place.center(), corners[1]] {
        harness.event_modifiers(egui::Event::PointerMoved(at), Modifiers::COMMAND);
        harness.step();
    }
    press(&mut harness, corners[1], false);
    harness.run();
    let framed = state(&harness).selected.elements().len();
    assert!(framed > 100, "{framed} elements in a frame around the tower");
    harness.get_by_label_contains(" elements");
}

#[test]
fn what_is_hidden_is_not_drawn_not_clicked_and_comes_back() {
    let mut harness = open();
    apply(&mut harness, Command::ToEnd);
    apply(&mut harness, Command::ColorBy(ElementColors::Activity));
    apply(&mut harness, Command::Toggle(Panel::Figures));
    let before = picture(&mut harness);
    let size = state(&harness).picture.as_vec2();
    let front = state(&harness).pick(Half::Shown, size * 0.5).unwrap().element;
    apply(&mut harness, Command::Choose(Choose::Only, vec![front]));
    harness.key_press(Key::X);
    harness.run();
    assert_eq!(state(&harness).shown(front), Shown::Hidden);
    let behind = state(&harness).pick(Half::Shown, size * 0.5).map(|hit| hit.element);
    assert_ne!(behind, Some(front));
    apply(&mut harness, Command::ClearSelection);
    let hidden = picture(&mut harness);
    assert!(hidden != before);

    harness.get_by_label("Show all").click();
    harness.run();
    harness.remove_cursor();
    harness.run();
    assert!(picture(&mut harness) == before, "all is as it was");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run();
    assert!(picture(&mut harness) == hidden, "undo hides it again");
    harness.key_press(Key::U);
    harness.run();

    // Alone: nothing of the rest is drawn, in any of the ways of drawing.
    apply(&mut harness, Command::Choose(Choose::Only, vec![front]));
    harness.key_press(Key::S);
    harness.run();
    for mode in ["HDLOD", "Batched", "Objects"] {
        harness.get_by_label(mode).click();
        harness.run();
        assert_eq!(state(&harness).frames.last().unwrap().triangles, {
            let scene = scene();
            scene.model.triangles_of(&scene.model.elements[front.index()]) as u64
        });
    }
}

#[test]
fn elements_are_coloured_by_storey_and_type_with_a_legend_that_counts() {
    let mut harness = open();
    apply(&mut harness, Command::ToEnd);
    apply(&mut harness, Command::Toggle(Panel::Figures));
    let mut pictures = Vec::new();
    for colors in [ElementColors::Own, ElementColors::Storey, ElementColors::Type] {
        if state(&harness).colors != colors {
            apply(&mut harness, Command::ColorBy(colors));
        }
        pictures.push(picture(&mut harness));
        let legend = state(&harness).coloring.legend();
        let count: usize = legend.iter().map(|row| row.elements).sum();
        match colors {
            ElementColors::Own => assert!(legend.is_empty()),
            _ => assert_eq!(count, scene().model.elements.len()),
        }
    }
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2]);
}

#[test]
fn the_model_tree_selects_hides_and_is_searched() {
    let mut harness = open();
    harness.key_press(Key::M);
    harness.run();
    harness.get_by_label("Type").click();
    harness.run();
    let kind = scene().model.elements[0].kind.clone();
    harness.get_by_label(&kind).click();
    harness.run();
    let scene = scene();
    let of_kind = scene.model.elements.iter().filter(|e| e.kind == kind).count();
    assert_eq!(state(&harness).selected.elements().len(), of_kind);
    harness.get_by_label(&format!("Hide {kind}")).click();
    harness.run();
    assert_eq!(state(&harness).visibility.count(), of_kind);
    harness.get_by_label(&format!("Show {kind}")).click();
    harness.run();
    assert_eq!(state(&harness).visibility.count(), 0);
    let name = scene.model.elements[5].name.clone();
    type_into(&mut harness, "Search elements", &name);
    harness.get_by_label(&name).click();
    harness.run();
    assert_eq!(state(&harness).selected.only(), Some(ElementId(5)));
}

#[test]
fn the_palette_finds_commands_and_activities_by_name() {
    let mut harness = open();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run();
    harness.get_by_label("Command").type_text("month fo");
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(state(&harness).time(), time("2027-02-01"));
    assert!(!state(&harness).panels.palette, "it closes");
    // Text and Enter in one slow frame.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run();
    let input = harness.input_mut();
    input.events.push(egui::Event::Text("color by type".to_owned()));
    let (key, modifiers) = (Key::Enter, Modifiers::NONE);
    let enter =
        |pressed| egui::Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
    input.events.extend([enter(true), enter(false)]);
    harness.run();
    assert_eq!(state(&harness).colors, ElementColors::Type);
    let activity = &scene().schedule.activities[7];
    harness.get_by_label("Command palette").click();
    harness.run();
    harness.get_by_label("Command").type_text(&activity.id);
    harness.run();
    harness.get_by_label_contains(&format!("Go to {}", activity.id)).click();
    harness.run();
    assert_eq!(state(&harness).time(), activity.start.unwrap());
    // Keys that are typed do nothing else.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run();
    let colors = state(&harness).colors;
    harness.get_by_label("Command").type_text("a");
    harness.key_press(Key::A);
    harness.run();
    assert_eq!(state(&harness).colors, colors);
    harness.key_press(Key::Escape);
    harness.run();
    assert!(!state(&harness).panels.palette);
}

#[test]
fn a_step_moves_and_an_idle_window_asks_for_no_frame() {
    let mut harness = open();
    apply(&mut harness, Command::Step(Step::Days(1)));
    settle(&mut harness);
    harness.run();
    let viewport = &harness.output().viewport_output[&egui::ViewportId::ROOT];
    assert!(
        viewport.repaint_delay > std::time::Duration::from_secs(60),
        "{:?}",
        viewport.repaint_delay
    );
}

#[test]
fn views_are_gone_back_to_saved_and_shown_again() {
    let mut harness = open();
    let first = state(&harness).camera;
    harness.key_press(Key::Num5);
    harness.run();
    let top = state(&harness).camera;
    assert_ne!(top, first);
    harness.key_press(Key::Backspace);
    harness.run();
    assert_eq!(state(&harness).camera, first);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::Backspace);
    harness.run();
    assert_eq!(state(&harness).camera, top);

    apply(&mut harness, Command::Choose(Choose::Only, vec![ElementId(3)]));
    harness.key_press(Key::X);
    harness.key_press(Key::V);
    harness.run();
    let date = state(&harness).time();
    apply(&mut harness, Command::ToStart);
    apply(&mut harness, Command::ShowAll);
    harness.key_press(Key::Num1);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::V);
    harness.run();
    harness.get_by_label("Go to View 1").click();
    harness.run();
    assert_eq!((state(&harness).camera, state(&harness).time()), (top, date));
    assert_eq!(state(&harness).shown(ElementId(3)), Shown::Hidden);
    harness.get_by_label("Name of view 1").focus();
    harness.run();
    harness.get_by_label("Name of view 1").type_text("!");
    harness.run();
    assert!(state(&harness).viewpoints[0].name.contains('!'));
    harness.get_by_label_contains("Delete ").click();
    harness.run();
    assert!(state(&harness).viewpoints.is_empty());
}

/// Parallel rays pick what is under the pointer, and the cube turns the view.
#[test]
fn parallel_projection_draws_and_picks_the_same_pixel() {
    let mut harness = open();
    apply(&mut harness, Command::ToEnd);
    apply(&mut harness, Command::Toggle(Panel::Figures));
    let perspective = picture(&mut harness);
    harness.key_press(Key::Num7);
    harness.run();
    assert!(state(&harness).camera.parallel);
    assert!(picture(&mut harness) != perspective);
    let size = state(&harness).picture;
    let at = size.as_vec2() * 0.5;
    let point = state(&harness).pick(Half::Shown, at).expect("the tower is in the middle").point;
    assert!(state(&harness).camera.project(point, size).unwrap().distance(at) < 0.5);
    let before = state(&harness).camera;
    let cube = harness.get_by_label("View cube").rect();
    drag(&mut harness, &[cube.center() + egui::vec2(-6.0, 12.0)]);
    let after = state(&harness).camera;
    assert!(after.parallel && after.azimuth != before.azimuth, "{after:?}");
}

#[test]
fn one_walks_over_the_ground_and_leaves_with_escape() {
    let mut harness = open();
    apply(&mut harness, Command::ToEnd);
    harness.key_press(Key::W);
    harness.run_steps(2);
    let start = state(&harness).camera.eye;
    let colors = state(&harness).colors;
    harness.key_down(Key::A);
    harness.run_steps(6);
    harness.key_up(Key::A);
    harness.run_steps(2);
    let end = state(&harness).camera.eye;
    assert!(start.distance(end) > 1.0, "{start} {end}");
    assert_eq!(state(&harness).colors, colors, "the key means nothing else");
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(state(&harness).navigation, topout::window::Navigation::Orbit);
    harness.key_press(Key::A);
    harness.run();
    assert_ne!(state(&harness).colors, colors);
}

/// A picture, a film and a report of what is shown are saved from the window; what cannot be written is
/// named, and nothing is lost.
#[test]
fn pictures_films_and_reports_are_saved() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = open();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::E);
    harness.run();
    let mut wanted = state(&harness).export.clone();
    wanted.size = [128, 72];
    wanted.frames = 3;
    for (product, name, begins) in [
        ("Picture", "now.png", &b"\x89PNG"[..]),
        ("Film", "film.gif", b"GIF89a"),
        ("Report", "page.html", b"<!DOCTYPE html>"),
    ] {
        harness.get_by_label(product).click();
        harness.run();
        let file = folder.path().join(name);
        wanted.product = state(&harness).export.product;
        wanted.file = file.display().to_string();
        apply(&mut harness, Command::SetExport(Box::new(wanted.clone())));
        harness.get_by_label("Save").click();
        harness.step();
        settle(&mut harness);
        assert_eq!(state(&harness).error, None);
        assert!(state(&harness).news.as_ref().unwrap().contains(name));
        assert!(std::fs::read(&file).unwrap().starts_with(begins), "{name}");
    }
    wanted.file = folder.path().join("nowhere/at all.png").display().to_string();
    wanted.product = topout::window::Product::Picture;
    apply(&mut harness, Command::SetExport(Box::new(wanted)));
    harness.get_by_label("Save").click();
    harness.step();
    settle(&mut harness);
    assert!(state(&harness).error.as_ref().unwrap().contains("at all.png"));
    assert!(state(&harness).project.is_some());
}

#[test]
fn the_gantt_chart_has_the_columns_that_one_chooses() {
    let mut harness = open();
    apply(&mut harness, Command::Toggle(Panel::Gantt));
    apply(&mut harness, Command::FoldAll(false));
    assert!(harness.query_by_label("Waits for").is_none());
    harness.get_by_label("Columns").click();
    harness.run();
    harness.get_by_label("Waits for").click();
    harness.run();
    // The list stays open for more.
    harness.get_by_label("Slack").click();
    settle(&mut harness);
    let columns = state(&harness).columns;
    let names: Vec<&str> = columns.shown().map(|c| COLUMNS[c].name).collect();
    assert_eq!(names, ["Id", "Start", "Finish", "Days", "Done", "Slack", "Waits for"]);
    // The first row of an activity names what it waits for.
    let project = state(&harness).project.clone().unwrap();
    let waits = |i: &usize| !project.scene.schedule.activities[*i].predecessors.is_empty();
    let activity = (0..project.scene.schedule.activities.len()).find(waits).unwrap();
    let column = &COLUMNS[8];
    let text = (column.text)(&project, activity);
    let from = project.scene.schedule.activities[activity].predecessors[0].activity;
    assert!(text.starts_with(&project.scene.schedule.activities[from as usize].id), "{text}");
}
