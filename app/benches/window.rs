//! What a frame of the window costs on the CPU: laying out panels and making triangles of them, while a hand scrubs
//! through the demo and scrolls a Gantt chart of 100,000 rows; and, with the demo, what the 3D view adds to that: looks,
//! cut and commands. What the adapter does is not counted, nor is culling, which software adapters have in its place.
//!
//! `cargo bench --workspace --bench window`. A program of its own, because what counts is the slowest frame in
//! a hundred, not the mean.
#![allow(clippy::unwrap_used)]

use egui::{
    Event, Modifiers, MouseWheelUnit, PointerButton, Pos2, RawInput, Rect, TouchPhase, vec2,
};
use glam::UVec2;
use std::sync::Arc;
use std::time::Instant;
use topout::project::{self, Request};
use topout::window::{AppState, Command, Panel, lay_out};
use topout_render::{DrawMode, FrameInput, Gpu, Occlusion, Options, Renderer};
use topout_scene::{Looks, Model, Progress, Scene, hdlod, link};
use topout_schedule::{Activity, Lag, LinkKind, Predecessor, Schedule, Time, TimeRange, WbsNode};

const SIZE: [f32; 2] = [1280.0, 800.0];
const FRAMES: usize = 600;

/// One frame, a sixtieth of a second after the one before; its milliseconds.
fn frame(ctx: &egui::Context, state: &mut AppState, events: Vec<Event>) -> f64 {
    let input = RawInput {
        screen_rect: Some(Rect::from_min_size(Pos2::ZERO, SIZE.into())),
        time: Some(ctx.cumulative_frame_nr() as f64 / 60.0),
        events,
        ..RawInput::default()
    };
    let started = Instant::now();
    let output = lay_out(ctx, state, input);
    let triangles = ctx.tessellate(output.shapes, output.pixels_per_point);
    std::hint::black_box(triangles);
    started.elapsed().as_secs_f64() * 1e3
}

fn say(what: &str, mut ms: Vec<f64>) {
    ms.sort_by(f64::total_cmp);
    let at = |share: f64| ms[((ms.len() - 1) as f64 * share) as usize];
    println!(
        "{what:<44} median {:.2} ms, 99 % {:.2} ms, longest {:.2} ms",
        at(0.5),
        at(0.99),
        at(1.0)
    );
}

fn window(scene: topout_scene::Scene) -> (egui::Context, AppState) {
    let mut state = AppState::new(Arc::new(|| ()));
    state.show_scene(Request::demo(), Arc::new(scene));
    // Nobody waits for the tree here.
    state.apply(Command::CancelHdlod);
    (egui::Context::default(), state)
}

/// Drags from the start of the timeline to its end, in so many frames; `view` draws the 3D view and says what that
/// took, milliseconds.
fn scrub_with(
    ctx: &egui::Context,
    state: &mut AppState,
    y: f32,
    frames: usize,
    mut view: impl FnMut(&AppState) -> f64,
) -> Vec<f64> {
    let from = Pos2::new(20.0, y);
    let press = |pressed| Event::PointerButton {
        pos: from,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    for events in [vec![], vec![Event::PointerMoved(from)], vec![press(true)]] {
        frame(ctx, state, events);
    }
    let before = state.time();
    let times = (0..frames)
        .map(|i| {
            let x = 20.0 + (SIZE[0] - 40.0) * i as f32 / frames as f32;
            let events = vec![Event::PointerMoved(Pos2::new(x, y))];
            frame(ctx, state, events) + view(state)
        })
        .collect();
    assert!(state.time() > before, "the drag did not scrub");
    frame(ctx, state, vec![press(false)]);
    times
}

fn scrub(ctx: &egui::Context, state: &mut AppState, y: f32) -> Vec<f64> {
    scrub_with(ctx, state, y, FRAMES, |_| 0.0)
}

/// The 3D view of a scene, in the colours of its activities.
fn view_of(scene: &Arc<Scene>) -> impl FnMut(&AppState) -> f64 {
    let tree = hdlod::build(scene, &hdlod::Settings::default(), &Progress::default()).unwrap();
    let mut renderer = Renderer::new(&Gpu::headless().unwrap());
    renderer.set_options(Options { occlusion: Occlusion::Off, ..renderer.options() });
    renderer.set_scene(scene).unwrap();
    renderer.set_hdlod(&Arc::new(tree)).unwrap();
    renderer.set_looks(Some(&Arc::new(Looks::of_activities(scene)))).unwrap();
    move |state| {
        let view = state.view(UVec2::new(1000, 620));
        let input = FrameInput { view, time: state.time(), mode: DrawMode::Hdlod };
        let stats = renderer.render(&input);
        renderer.wait_idle();
        stats.select_ms + stats.cpu_ms
    }
}

/// Turns the wheel over the Gantt chart.
fn scroll(ctx: &egui::Context, state: &mut AppState) -> Vec<f64> {
    let over = Pos2::new(300.0, SIZE[1] - 80.0);
    frame(ctx, state, vec![Event::PointerMoved(over)]);
    (0..FRAMES)
        .map(|_| {
            let events = vec![Event::MouseWheel {
                unit: MouseWheelUnit::Line,
                delta: vec2(0.0, -7.0),
                phase: TouchPhase::Move,
                source: egui::MouseWheelSource::Wheel,
                modifiers: Modifiers::NONE,
            }];
            frame(ctx, state, events)
        })
        .collect()
}

/// 100,000 activities below 1,000 summaries.
fn large() -> topout_scene::Scene {
    let summary = |i: usize| WbsNode {
        code: format!("{i}"),
        name: format!("Section {i}"),
        parent: (i >= 10).then_some((i % 10) as u32),
    };
    let activity = |i: usize| Activity {
        id: format!("A{i:06}"),
        name: format!("Work on part {i}"),
        wbs: Some((i % 1000) as u32),
        start: Some(Time::from_seconds(i as i64 * 800)),
        end: Some(Time::from_seconds(i as i64 * 800 + 400_000)),
        percent_complete: Some((i % 101) as f32),
        predecessors: (i > 0)
            .then(|| Predecessor {
                activity: i as u32 - 1,
                kind: LinkKind::StartStart,
                lag: Lag::default(),
            })
            .into_iter()
            .collect(),
        ..Activity::default()
    };
    let period = TimeRange { start: Time::from_seconds(0), end: Time::from_seconds(80_400_000) };
    let schedule = Schedule {
        period,
        wbs: (0..1000).map(summary).collect(),
        activities: (0..100_000).map(activity).collect(),
        ..Schedule::default()
    };
    link::link(Model::default(), schedule.revalidated())
}

fn main() {
    let demo = project::load(&Request::demo(), &Progress::default()).unwrap();
    let (ctx, mut state) = window(demo);
    say("demo, scrubbing", scrub(&ctx, &mut state, SIZE[1] - 40.0));
    let scene = Arc::clone(&state.project.as_ref().unwrap().scene);
    let with_view = scrub_with(&ctx, &mut state, SIZE[1] - 40.0, FRAMES / 3, view_of(&scene));
    say("demo, scrubbing, 3D view too", with_view);
    state.apply(Command::Toggle(Panel::Gantt));
    state.apply(Command::Toggle(Panel::Tree));
    say("demo, scrubbing, Gantt and model tree open", scrub(&ctx, &mut state, SIZE[1] - 310.0));

    let (ctx, mut state) = window(large());
    state.apply(Command::Toggle(Panel::Gantt));
    state.apply(Command::FoldAll(false));
    say("100,000 activities, scrolling the Gantt chart", scroll(&ctx, &mut state));
    let filter = topout::window::Filter { active_now: true, ..Default::default() };
    state.apply(Command::SetFilter(Box::new(filter)));
    say("100,000 activities, scrubbing, active now", scrub(&ctx, &mut state, SIZE[1] - 310.0));
}
