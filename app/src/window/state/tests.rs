//! What the user asks for, and what becomes of it.
#![allow(clippy::unwrap_used)]

use super::super::calendar::DAY;
use super::super::clock::{SPEEDS, Speed, Step};
use super::*;
use crate::project::Source;
use glam::Vec3;
use topout_schedule::Schedule;

fn state() -> AppState {
    AppState::new(Arc::new(|| ()))
}

fn day(day: i64) -> Time {
    Time::from_seconds(day * DAY)
}

/// A hundred days without elements.
fn with_period() -> AppState {
    let period = TimeRange { start: day(0), end: day(100) };
    let schedule = Schedule { period, ..Schedule::default() };
    let scene = Scene { schedule, activity_starts: vec![0], ..Scene::default() };
    let mut state = state();
    state.show_scene(Request::demo(), Arc::new(scene));
    state
}

#[test]
fn time_is_held_within_the_period() {
    let mut state = with_period();
    assert_eq!(state.time(), day(100), "a new project shows everything");
    for (command, expected) in [
        (Command::Step(Step::Days(1)), day(100)),
        (Command::Step(Step::Days(-7)), day(93)),
        (Command::JumpTo(Time::MIN), day(0)),
        (Command::JumpTo(Time::MAX), day(100)),
        (Command::ToStart, day(0)),
        (Command::Step(Step::Days(-1)), day(0)),
        (Command::ToEnd, day(100)),
    ] {
        state.apply(command.clone());
        assert_eq!(state.time(), expected, "{command:?}");
    }
}

#[test]
fn playing_runs_at_its_speed_and_stops_at_the_end() {
    let mut state = with_period();
    state.apply(Command::SetSpeed(Speed::Days(30)));
    state.apply(Command::TogglePlay);
    assert_eq!(state.time(), day(0), "at the end, playing starts over");
    for _ in 0..10 {
        state.advance(0.1);
    }
    let error = state.time().seconds() - day(30).seconds();
    assert!(error.abs() <= 1, "small steps add up to 30 days, {error} s off");
    state.advance(10.0);
    assert!(!state.clock.is_playing());
    assert_eq!(state.time(), day(100));
    state.advance(1.0);
    assert_eq!(state.time(), day(100));
}

#[test]
fn playing_can_leave_out_nights_and_days_off() {
    let mut state = state();
    let text = r#"{"calendars": [{"week": {"mon": ["08:00-12:00"], "wed": ["08:00-12:00"]}}],
        "calendar": 0, "activities": [{"id": "A", "start": "2026-11-23", "end": "2026-12-02"}]}"#;
    let options = topout_schedule::ReadOptions::default();
    let schedule =
        topout_schedule::read_bytes("a.json".as_ref(), text.as_bytes(), &options).unwrap();
    let scene = topout_scene::link::link(topout_scene::Model::default(), schedule);
    state.show_scene(Request::demo(), Arc::new(scene));
    let at = |text: &str| Time::parse_iso(text).unwrap();
    state.apply(Command::SetSpeed(Speed::Days(1)));
    state.apply(Command::TogglePlay);
    state.advance(0.25);
    assert_eq!(state.time(), at("2026-11-23T06:00:00"));
    state.apply(Command::ToggleSkipIdle);
    state.advance(0.0);
    assert_eq!(state.time(), at("2026-11-23T08:00:00"));
    state.advance(0.25);
    assert_eq!(state.time(), at("2026-11-25T08:00:00"), "a Wednesday");
    state.advance(0.125);
    assert_eq!(state.time(), at("2026-11-25T11:00:00"), "while somebody works time runs on");
    state.advance(0.125);
    assert_eq!(state.time(), at("2026-11-30T08:00:00"));
    // Scrubbing shows what it is asked for.
    state.apply(Command::JumpTo(at("2026-11-29T03:00:00")));
    assert_eq!(state.time(), at("2026-11-29T03:00:00"));
    state.apply(Command::JumpTo(at("2026-12-02T12:00:00")));
    state.advance(0.001);
    assert!(!state.clock.is_playing() && state.time() == state.period().end);
}

#[test]
fn nothing_plays_without_a_period() {
    let mut state = state();
    state.apply(Command::TogglePlay);
    assert!(!state.clock.is_playing());
}

#[test]
fn speeds_and_tolerance_stay_in_range() {
    let mut state = state();
    for _ in 0..20 {
        state.apply(Command::Faster);
    }
    assert_eq!(state.clock.speed, Speed::Days(SPEEDS[SPEEDS.len() - 1]));
    for _ in 0..20 {
        state.apply(Command::Slower);
    }
    assert_eq!(state.clock.speed, Speed::Days(SPEEDS[0]));
    for (asked, got) in [(2.0, 2.0), (-1.0, *TOLERANCE.start()), (1e9, *TOLERANCE.end())] {
        state.apply(Command::SetTolerance(asked));
        assert_eq!(state.tolerance_px, got);
    }
    state.apply(Command::SetTolerance(f32::NAN));
    assert_eq!(state.tolerance_px, *TOLERANCE.end());
}

#[test]
fn another_schedule_for_the_same_models_keeps_camera_and_date() {
    let mut state = with_period();
    let moved = state.camera.orbit(Vec3::ZERO, 0.5, 0.1);
    state.apply(Command::MoveCamera(moved));
    state.apply(Command::JumpTo(day(40)));
    let scene = Arc::clone(&state.project.as_ref().unwrap().scene);
    let request = Request { schedules: vec!["plan.json".into()], ..Request::demo() };
    state.show_scene(request, Arc::clone(&scene));
    assert_eq!((state.camera, state.time()), (moved, day(40)));

    let other = Request { models: vec![Source::File("other.glb".into())], ..Request::demo() };
    state.show_scene(other, scene);
    assert_eq!(state.time(), day(100));
    assert_ne!(state.camera, moved);
}

#[test]
fn files_of_other_kinds_are_refused_by_name() {
    let mut state = state();
    state.apply(Command::OpenFiles(vec!["a.GLB".into(), "site.dwg".into()]));
    assert!(state.error.as_ref().unwrap().contains("site.dwg"));
    assert!(state.loading.is_none(), "nothing is opened halfway");
    state.apply(Command::OpenFiles(vec!["plan.CSV".into(), "links.csv".into()]));
    assert_eq!(state.waiting_schedules.len(), 2, "schedules wait for their model");
}

/// Waits for what was begun.
fn settle(state: &mut AppState) {
    while state.is_busy() {
        std::thread::sleep(std::time::Duration::from_millis(2));
        state.poll();
    }
}

#[test]
fn successors_follow_what_is_moved_and_undo_brings_all_of_them_back() {
    let mut state = state();
    let text = r#"{"activities": [
        {"id": "A", "start": "2026-03-02", "end": "2026-03-06"},
        {"id": "B", "start": "2026-03-06", "end": "2026-03-10",
         "predecessors": [{"id": "A", "type": "FS"}]},
        {"id": "C", "start": "2026-03-20", "end": "2026-03-21",
         "predecessors": [{"id": "B", "type": "FS"}]},
        {"id": "D", "start": "2026-03-30", "end": "2026-03-31"}]}"#;
    let options = topout_schedule::ReadOptions::default();
    let schedule =
        topout_schedule::read_bytes("a.json".as_ref(), text.as_bytes(), &options).unwrap();
    let scene = topout_scene::link::link(topout_scene::Model::default(), schedule);
    state.show_scene(Request::demo(), Arc::new(scene));
    settle(&mut state);
    let dates = |state: &AppState| -> Vec<String> {
        let activities = &state.project.as_ref().unwrap().scene.schedule.activities;
        activities.iter().map(|a| a.start.unwrap().to_string()[5..10].to_owned()).collect()
    };
    let at = |text: &str| Time::parse_iso(text).unwrap();
    let before = dates(&state);
    let to = TimeRange { start: at("2026-03-09"), end: at("2026-03-13") };
    state.apply(Command::MoveActivity(0, to));
    settle(&mut state);
    assert_eq!(dates(&state), ["03-09", "03-13", "03-20", "03-30"], "C has room, D no link");
    state.apply(Command::MoveActivity(
        1,
        TimeRange { start: at("2026-03-18"), end: at("2026-03-22") },
    ));
    settle(&mut state);
    assert_eq!(dates(&state), ["03-09", "03-18", "03-22", "03-30"]);
    for expected in
        [vec!["03-09", "03-13", "03-20", "03-30"], vec!["03-02", "03-06", "03-20", "03-30"]]
    {
        state.apply(Command::Undo);
        settle(&mut state);
        assert_eq!(dates(&state), expected);
    }
    assert_eq!(dates(&state), before);
    state.apply(Command::Undo);
    settle(&mut state);
    assert_eq!(dates(&state), before, "nothing is left to take back");
    state.apply(Command::Redo);
    settle(&mut state);
    assert_eq!(dates(&state)[1], "03-13");
}
