//! The window, driven as a user drives it: by its buttons, its keys and the mouse.
//!
//! Every case opens the real application on a software adapter with a small demo project, finds
//! widgets by the names that screen readers hear, and looks at what the window then shows.
#![allow(clippy::unwrap_used)]

use egui::{Key, Modifiers, MouseWheelUnit, Pos2, Role, TouchPhase};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use topout::project::Request;
use topout::window::{Command, ElementColors, Half, Panel, Speed, Step, Window};
use topout_render::{DrawMode, Sun};
use topout_scene::cache::Cache;
use topout_scene::demo::{DemoSettings, generate};
use topout_scene::{Progress, link};
use topout_schedule::Time;
use topout_tests::window::{
    apply, apply_now, axis, drag, empty, open, picture, scene, settle, state, view,
};

#[test]
fn an_empty_window_says_what_to_do() {
    let mut harness = empty();
    harness.run();
    for label in ["Open model…", "Open schedule…", "Open demo project"] {
        harness.get_by_label(label);
    }
    assert!(harness.query_by_label("Play").is_none());
}

#[test]
fn play_advances_the_date_until_pause_and_ends_at_the_end() {
    let mut harness = open();
    let before = state(&harness).time();
    harness.get_by_label("Play").click();
    harness.run_steps(3);
    let running = state(&harness).time();
    assert!(running > before, "{running} is not after {before}");
    harness.get_by_label("Pause").click();
    harness.run_steps(2);
    let paused = state(&harness).time();
    harness.run_steps(3);
    assert_eq!(state(&harness).time(), paused);

    apply(&mut harness, Command::ToEnd);
    harness.key_press(Key::Space);
    harness.step();
    assert!(state(&harness).clock.is_playing());
    assert!(state(&harness).time() < before, "playing at the end starts over");
    apply_now(&mut harness, Command::SetSpeed(Speed::Days(120)));
    let mut steps = 0;
    while state(&harness).clock.is_playing() {
        harness.step();
        steps += 1;
        assert!(steps < 200, "never ends");
    }
    assert_eq!(state(&harness).time(), state(&harness).period().end);
}

#[test]
fn dragging_the_timeline_changes_the_date_and_the_picture() {
    let mut harness = open();
    let place = axis(&harness);
    let at = |share: f32| Pos2::new(place.min.x + place.width() * share, place.min.y + 20.0);
    let share = |harness: &Harness<'_, Window>| {
        let s = state(harness);
        s.scale.share(s.time())
    };
    // The figures are times, which differ from frame to frame.
    apply(&mut harness, Command::Toggle(Panel::Figures));
    drag(&mut harness, &[at(0.9), at(0.4), at(0.25)]);
    assert!((share(&harness) - 0.25).abs() < 0.01, "{}", share(&harness));
    let early = picture(&mut harness);

    // Through the whole period and back: the same picture as a jump to that instant.
    let instant = state(&harness).time();
    drag(&mut harness, &[at(0.25), at(0.95), at(0.02), at(0.6)]);
    assert!(picture(&mut harness) != early, "another date looks the same");
    apply(&mut harness, Command::JumpTo(instant));
    assert!(picture(&mut harness) == early, "scrubbing and jumping differ");

    // Out of the window: held at the end.
    drag(&mut harness, &[at(0.5), Pos2::new(3_000.0, at(0.0).y)]);
    assert_eq!(state(&harness).time(), state(&harness).period().end);
}

#[test]
fn keys_step_through_time_and_choose_how_to_draw() {
    let mut harness = open();
    let start = state(&harness).time();
    let days = |harness: &Harness<'_, Window>| {
        (state(harness).time().seconds() - start.seconds()) as f64 / 86_400.0
    };
    for (modifiers, key, expected) in [
        (Modifiers::NONE, Key::ArrowRight, 1.0),
        (Modifiers::SHIFT, Key::ArrowRight, 8.0),
        (Modifiers::NONE, Key::ArrowLeft, 7.0),
        (Modifiers::SHIFT, Key::ArrowLeft, 0.0),
    ] {
        harness.key_press_modifiers(modifiers, key);
        harness.run();
        assert_eq!(days(&harness), expected, "{modifiers:?} {key:?}");
    }
    harness.key_press(Key::Home);
    harness.run();
    assert_eq!(state(&harness).time(), state(&harness).period().start);
    harness.key_press(Key::B);
    harness.run();
    assert_eq!(state(&harness).mode, DrawMode::Batched);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::B);
    harness.key_press(Key::H);
    harness.run();
    assert_eq!(state(&harness).mode, DrawMode::Hdlod);
}

#[test]
fn switching_the_mode_changes_the_figures() {
    let mut harness = open();
    // From afar, where clusters pay.
    let camera = state(&harness).camera;
    let far = camera.zoom(state(&harness).project.as_ref().unwrap().focus.center(), 6.0, 1e5);
    apply(&mut harness, Command::MoveCamera(far));
    let figures = |harness: &mut Harness<'_, Window>, button: &str| {
        harness.get_by_label(button).click();
        harness.run();
        *state(harness).frames.last().unwrap()
    };
    let objects = figures(&mut harness, "Objects");
    let batched = figures(&mut harness, "Batched");
    let hdlod = figures(&mut harness, "HDLOD");
    assert_eq!((objects.clusters, batched.clusters), (0, 0));
    assert_eq!(objects.triangles, batched.triangles);
    assert!(batched.triangles > 0);
    assert!(hdlod.clusters > 0);
    assert!(hdlod.triangles < batched.triangles, "{hdlod:?} {batched:?}");
    assert!(hdlod.worst_px <= state(&harness).tolerance_px);
    harness.get_by_label_contains("px certified");
}

#[test]
fn the_building_is_there_before_its_tree_and_does_not_move_when_it_comes() {
    let mut harness = empty();
    harness.state_mut().state_mut().show_scene(Request::demo(), scene());
    apply_now(&mut harness, Command::CancelHdlod);
    harness.run();
    let (camera, time) = (state(&harness).camera, state(&harness).time());
    let stats = *state(&harness).frames.last().unwrap();
    assert_eq!(state(&harness).effective_mode(), DrawMode::Batched);
    assert!(stats.elements > 0 && stats.triangles > 0 && stats.clusters == 0, "{stats:?}");

    harness.get_by_label("Build").click();
    harness.step();
    settle(&mut harness);
    assert_eq!(state(&harness).effective_mode(), DrawMode::Hdlod);
    assert_eq!((state(&harness).camera, state(&harness).time()), (camera, time));
    assert!(!state(&harness).frames.is_empty());
}

/// What one window built, the next finds, and says so.
#[test]
fn a_tree_that_was_kept_is_taken_from_the_cache() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Cache::new(folder.path().join("trees"), u64::MAX);
    for (kept, origin) in [(0, "built"), (1, "taken from the cache")] {
        assert_eq!(cache.list().unwrap().len(), kept);
        let mut harness = empty();
        let state = harness.state_mut().state_mut();
        state.cache = Some(cache.clone());
        state.show_scene(Request::demo(), scene());
        settle(&mut harness);
        harness.get_by_label(origin);
        harness.get_by_label(cache.folder().to_str().unwrap());
        // A window that closes waits until its tree is kept.
        drop(harness);
    }
    assert_eq!(cache.list().unwrap().len(), 1);
}

/// Other dates reach the GPU in parts, and the picture is the one that sending everything gives.
#[test]
fn moved_activities_are_drawn_as_if_everything_were_sent_again() {
    let folder = tempfile::tempdir().unwrap();
    let plan = folder.path().join("plan.json");
    let write = |schedule: &topout_schedule::Schedule| {
        let mut bytes = Vec::new();
        schedule.write_json(&mut bytes).unwrap();
        std::fs::write(&plan, bytes).unwrap();
    };
    let mut schedule = scene().schedule.clone();
    write(&schedule);
    let models = vec![topout::project::Source::File("tower.glb".into())];
    let request = Request { models, schedules: vec![plan.clone()], ..Request::default() };
    let mut harness = empty();
    harness.state_mut().state_mut().show_scene(request, scene());
    settle(&mut harness);
    let date = Time::parse_iso("2027-01-01").unwrap();
    apply(&mut harness, Command::JumpTo(date));
    apply(&mut harness, Command::Toggle(Panel::Figures));
    let before = picture(&mut harness);

    for activity in schedule.activities.iter_mut().step_by(3) {
        let later = |t: Option<Time>| t.map(|t| t.plus_seconds(60 * 86_400));
        (activity.start, activity.end) = (later(activity.start), later(activity.end));
    }
    write(&schedule);
    apply_now(&mut harness, Command::ReloadSchedule);
    while state(&harness).loading.is_some() {
        harness.step();
    }
    apply(&mut harness, Command::CancelHdlod);
    harness.get_by_label("Refine");
    apply(&mut harness, Command::DismissNews);
    let moved = picture(&mut harness);
    let stats = *state(&harness).frames.last().unwrap();
    assert!(stats.clusters > 0 && moved != before);
    // Which sends everything.
    apply(&mut harness, Command::ToggleLevelColors);
    apply(&mut harness, Command::ToggleLevelColors);
    assert!(moved == picture(&mut harness), "what was sent in parts differs");

    apply(&mut harness, Command::BuildHdlod);
    apply(&mut harness, Command::SetMode(DrawMode::Batched));
    let refined = picture(&mut harness);
    let (model, _) = generate(
        &DemoSettings { elements: 1_000, triangles: 46_000, activities: 850, seed: 4 },
        &Progress::default(),
    )
    .unwrap();
    let camera = state(&harness).camera;
    let mut fresh = empty();
    let linked = Arc::new(link::link(model, schedule));
    fresh.state_mut().state_mut().show_scene(Request::demo(), linked);
    settle(&mut fresh);
    for command in [
        Command::JumpTo(date),
        Command::Toggle(Panel::Figures),
        Command::SetMode(DrawMode::Batched),
        Command::MoveCamera(camera),
    ] {
        apply(&mut fresh, command);
    }
    assert!(refined == picture(&mut fresh), "not what these dates show");
}

/// The levels' colours are another picture of the same cut; without them all is as before.
#[test]
fn coloring_by_level_changes_the_picture_alone_and_can_be_taken_back() {
    let mut harness = open();
    // Figures in milliseconds differ from frame to frame.
    apply(&mut harness, Command::Toggle(Panel::Figures));
    let by_activity = picture(&mut harness);
    // Where something is at work, single elements have other colours: another cut.
    apply(&mut harness, Command::ColorBy(ElementColors::Activity));
    let plain = picture(&mut harness);
    assert!(by_activity != plain);
    let stats = *state(&harness).frames.last().unwrap();
    apply(&mut harness, Command::ToggleLevelColors);
    let colored = picture(&mut harness);
    let colored_stats = *state(&harness).frames.last().unwrap();
    assert!(stats.clusters > 0);
    assert_eq!(
        (stats.clusters, stats.triangles),
        (colored_stats.clusters, colored_stats.triangles)
    );
    assert!(plain != colored, "the colours show");
    apply(&mut harness, Command::ToggleLevelColors);
    assert!(plain == picture(&mut harness), "nothing of them is left");
    apply(&mut harness, Command::ColorBy(ElementColors::Activity));
    assert!(by_activity == picture(&mut harness));
}

/// While levels fade frame follows frame; in the end the picture is that of the cut for 0.8 of the tolerance.
#[test]
fn levels_fade_until_the_new_ones_are_there() {
    let mut harness = open();
    apply(&mut harness, Command::Toggle(Panel::Figures));
    apply(&mut harness, Command::SetTolerance(4.0));
    let near = state(&harness).camera;
    let middle = scene().focus_bounds().center();
    let mut far = near;
    far.eye = middle + (near.eye - middle) * 1.7;
    let moved = |harness: &mut Harness<'_, Window>, camera| {
        apply_now(harness, Command::MoveCamera(camera));
        harness.step();
        let fading = state(harness).frames.last().unwrap().fading;
        settle(harness);
        fading
    };
    assert_eq!(moved(&mut harness, far), 0, "off on software adapters");
    apply(&mut harness, Command::ToggleFade);
    moved(&mut harness, near);
    assert!(moved(&mut harness, far) > 0);
    assert_eq!(state(&harness).frames.last().unwrap().fading, 0);
    let faded = picture(&mut harness);
    apply(&mut harness, Command::ToggleFade);
    apply(&mut harness, Command::SetTolerance(3.2));
    assert!(faded == picture(&mut harness));
}

#[test]
fn what_cannot_be_opened_is_named_and_the_project_stays() {
    let mut harness = open();
    let folder = tempfile::tempdir().unwrap();
    let broken = folder.path().join("broken.glb");
    std::fs::write(&broken, b"glTF but not for long").unwrap();
    for path in [PathBuf::from("nowhere/tower.glb"), broken, PathBuf::from("notes.txt")] {
        apply(&mut harness, Command::OpenFiles(vec![path.clone()]));
        let error = state(&harness).error.clone().unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        assert!(error.contains(name), "{error} does not name {name}");
        harness.get_by_label(&error);
        assert!(state(&harness).project.is_some());
        harness.get_by_label("Play");
        harness.get_by_label("Dismiss").click();
        harness.run();
        assert_eq!(state(&harness).error, None);
    }
}

#[test]
fn a_schedule_may_come_before_its_model() {
    let mut harness = empty();
    apply(&mut harness, Command::OpenFiles(vec![PathBuf::from("plan.json")]));
    harness.get_by_label_contains("plan.json waits");
    assert!(state(&harness).project.is_none() && state(&harness).error.is_none());
}

#[test]
fn a_click_selects_and_its_dates_lead_through_time() {
    let mut harness = open();
    apply(&mut harness, Command::ToEnd);
    let middle = view(&harness).center();
    drag(&mut harness, &[middle]);
    let element = state(&harness).selected.only().expect("the building stands in the middle");
    let scene = scene();
    harness.get_by_label(&scene.model.elements[element.index()].name);

    let first = scene.activities_of(element)[0] as usize;
    let start = scene.schedule.activities[first].start.unwrap();
    harness.get_all_by_role(Role::Link).next().unwrap().click();
    harness.run();
    assert_eq!(state(&harness).time(), start);

    harness.key_press(Key::Escape);
    harness.run();
    assert!(state(&harness).selected.is_empty());
}

#[test]
fn the_mouse_turns_moves_and_zooms_about_what_is_under_it() {
    let mut harness = open();
    apply(&mut harness, Command::ToEnd);
    let middle = view(&harness).center();
    let size = state(&harness).picture;
    let pixel = |p: Pos2, harness: &Harness<'_, Window>| {
        let p = p - view(harness).min;
        glam::Vec2::new(p.x, p.y)
    };
    let at = pixel(middle, &harness);
    let point = state(&harness).pick(Half::Shown, at).unwrap().point;

    let before = state(&harness).camera;
    drag(&mut harness, &[middle, middle + egui::vec2(60.0, 25.0)]);
    let turned = state(&harness).camera;
    assert_ne!(turned.azimuth, before.azimuth);
    assert!(turned.elevation > before.elevation, "dragging down looks from higher up");
    assert!((turned.eye.distance(point) / before.eye.distance(point) - 1.0).abs() < 1e-3);
    assert!(turned.project(point, size).unwrap().distance(at) < 1.0);

    apply(&mut harness, Command::MoveCamera(before));
    harness.hover_at(middle);
    harness.event(egui::Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        delta: egui::vec2(0.0, 2.0),
        phase: TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run();
    let near = state(&harness).camera;
    assert!(near.eye.distance(point) < before.eye.distance(point) * 0.8);
    assert!(near.project(point, size).unwrap().distance(at) < 1.0);

    // A resize does not undo what the user did; after a fit it fits again.
    harness.set_size(egui::vec2(800.0, 600.0));
    harness.run();
    assert_eq!(state(&harness).camera, near);
    harness.key_press(Key::F);
    harness.run();
    assert_ne!(state(&harness).camera, near);
}

#[test]
fn panels_fold_to_nothing() {
    let mut harness = open();
    let before = view(&harness).area();
    for panel in [Panel::Inspector, Panel::Timeline, Panel::Figures] {
        apply(&mut harness, Command::Toggle(panel));
    }
    assert!(harness.query_by_role(Role::Slider).is_none());
    assert!(view(&harness).area() > before * 1.4);
    assert!(view(&harness).width() >= 899.0);
}

#[test]
fn the_table_fills_cell_by_cell_and_can_be_stopped() {
    let mut harness = open();
    apply_now(&mut harness, Command::MeasureTable);
    while state(&harness).table.cells().is_empty() {
        assert!(state(&harness).table.is_measuring(), "ended without a cell");
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    harness.get_by_label("Stop").click();
    harness.step();
    settle(&mut harness);
    harness.get_by_label_contains("Stopped before");
    assert!(state(&harness).table.cells()[0].triangles > 0);
    harness.get_by_label("Measure again");
    harness.get_by_label("Copy").click();
    harness.step();
    let copied = harness.output().platform_output.commands.iter().any(|command| {
        matches!(command, egui::OutputCommand::CopyText(text) if text.starts_with("time\tlod\t"))
    });
    assert!(copied, "nothing on the clipboard");
    for label in ["Save as CSV…", "Save as Markdown…"] {
        harness.get_by_label(label);
    }
    // The paper's 217 times, beside what is measured here.
    harness.get_by_label("217x");
}

/// The card opens the graph and the graph closes itself; its frames are those that were rendered.
#[test]
fn the_graph_shows_the_frames_that_were_rendered() {
    let mut harness = open();
    let remembered = state(&harness).frames.len();
    for _ in 0..5 {
        apply(&mut harness, Command::Step(Step::Days(7)));
    }
    assert_eq!(state(&harness).frames.len(), remembered + 5);
    assert!(harness.query_by_label_contains("Frame times: median").is_none());
    harness.get_by_label_contains("px certified").click();
    harness.run();
    let median = state(&harness).frames.percentile(0.5).unwrap();
    let graph =
        harness.get_by_label_contains(&format!("Frame times: median {median:.1} ms")).rect();

    // The last frame stands at the right end; its parts are told there.
    harness.hover_at(Pos2::new(graph.right() - 1.0, graph.center().y));
    harness.run_steps(10);
    harness.get_by_label_contains("Last frame: ");
    harness.get_by_label("selection");
    harness.key_press(Key::G);
    harness.run();
    assert!(harness.query_by_label_contains("Frame times: median").is_none());
}

/// The light follows the clock once a place is given, and stands still again.
#[test]
fn the_sun_is_chosen_in_its_panel() {
    let mut harness = open();
    apply(&mut harness, Command::Toggle(Panel::Sun));
    assert!(harness.query_by_label_contains("Latitude").is_none());
    harness.get_by_label("By date and hour").click();
    harness.run();
    assert!(matches!(state(&harness).sun, Sun::Place { latitude_deg: 51.5, .. }));
    harness.get_by_label_contains("Latitude");
    harness.get_by_label("Fixed").click();
    harness.run();
    assert_eq!(state(&harness).sun, Sun::Fixed);
}

/// What is drawn: menu bar, demo tower on the first day of 2027 seen from the standard corner,
/// project data on the right, timeline at the bottom. Without the frame figures, which are times.
/// Half size, so that a hinted glyph does not decide.
#[test]
fn the_window_looks_as_it_did() {
    let mut harness = open();
    apply(&mut harness, Command::Toggle(Panel::Figures));
    harness.remove_cursor();
    settle(&mut harness);
    let image = harness.render().unwrap();
    let filter = image::imageops::FilterType::Triangle;
    let small = image::imageops::resize(&image, 512, 341, filter);
    let options = egui_kittest::SnapshotOptions::new()
        .output_path("golden/window")
        .threshold(2.0)
        .max_failed_pixels(80);
    egui_kittest::image_snapshot_options(&small, "demo_2027", &options);
}
