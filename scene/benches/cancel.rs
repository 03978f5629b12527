//! How long work goes on after it was cancelled: `cargo bench --workspace --bench cancel`.
//!
//! Each kind of work is done once to the end, then again and again, cancelled at instants that lie
//! evenly in that time, each moved by chance within its share of it. What counts is the time from the
//! cancel to the return. TOPOUT_CANCELS says how many instants (40). As a test (`--test`) everything
//! runs on a small demo project with a few of them.
#![allow(missing_docs)]

use std::hash::{BuildHasher, RandomState};
use std::time::{Duration, Instant};
use topout_scene::hdlod::verify::{Plan, verify};
use topout_scene::{Cancelled, Hdlod, Progress, Scene, demo, hdlod, link};
use topout_schedule::TimeRange;

/// When a cancel came: how late the work ended, and in which stage it came.
struct Delay {
    time: Duration,
    stage: String,
}

fn measure(name: &str, instants: u32, work: &(dyn Fn(&Progress) -> Result<(), Cancelled> + Sync)) {
    let started = Instant::now();
    work(&Progress::default()).expect("nobody cancels");
    let whole = started.elapsed();
    let chance = RandomState::new();
    let mut delays: Vec<Delay> = (0..instants)
        .filter_map(|i| {
            let within = chance.hash_one(i) as f64 / u64::MAX as f64;
            cancelled_after(whole.mul_f64((f64::from(i) + within) / f64::from(instants)), work)
        })
        .collect();
    delays.sort_by_key(|d| d.time);
    let (Some(last), count) = (delays.last(), delays.len()) else { return };
    println!(
        "{name}: {:.1} s when not cancelled; {count} cancels: median {:.0} ms, largest {:.0} ms",
        whole.as_secs_f64(),
        delays[count / 2].time.as_secs_f64() * 1e3,
        last.time.as_secs_f64() * 1e3,
    );
    for delay in delays.iter().rev().take(5) {
        println!("  {:>6.0} ms in {:?}", delay.time.as_secs_f64() * 1e3, delay.stage);
    }
}

/// `None` where the work ended before.
fn cancelled_after(
    wait: Duration,
    work: &(dyn Fn(&Progress) -> Result<(), Cancelled> + Sync),
) -> Option<Delay> {
    let progress = Progress::default();
    std::thread::scope(|scope| {
        let worker = scope.spawn(|| work(&progress));
        std::thread::sleep(wait);
        let (stage, share) = progress.state();
        if worker.is_finished() {
            return None;
        }
        let cancelled = Instant::now();
        progress.cancel();
        worker.join().expect("it does not panic").err()?;
        let stage = format!("{stage} at {:.0} %", share * 100.0);
        Some(Delay { time: cancelled.elapsed(), stage })
    })
}

/// Every tenth activity a week later.
fn edited(scene: &Scene, tree: &Hdlod) -> (Scene, Hdlod) {
    const WEEK: i64 = 7 * 86_400;
    let moves: Vec<_> = (0..scene.schedule.activities.len())
        .step_by(10)
        .filter_map(|i| {
            let TimeRange { start, end } = scene.schedule.activities[i].dates()?;
            let range = TimeRange { start: start.plus_seconds(WEEK), end: end.plus_seconds(WEEK) };
            Some((i, range))
        })
        .collect();
    let edited = scene.with_activity_dates(&moves).expect("they exist");
    let mut tree = tree.clone();
    tree.restate(&edited.scene, &edited.changed).expect("it is the same scene");
    println!("{} activities moved: {} clusters to repair", moves.len(), tree.stale_count());
    (edited.scene, tree)
}

fn main() {
    let is_test = std::env::args().any(|a| a == "--test");
    let (settings, instants) = match is_test {
        true => (demo::DemoSettings::for_elements(2000), 2),
        false => (demo::DemoSettings::default(), instants()),
    };
    let generate = |progress: &Progress| match demo::generate(&settings, progress) {
        Err(demo::DemoError::Cancelled(cancelled)) => Err(cancelled),
        made => Ok(made.expect("the settings are usual")),
    };
    measure("generate the demo", instants, &|progress| {
        let (model, schedule) = generate(progress)?;
        progress.begin("linking", 0)?;
        link::link(model, schedule);
        Ok(())
    });
    let (model, schedule) = generate(&Progress::default()).expect("nobody cancels");
    let scene = link::link(model, schedule);
    let built = hdlod::Settings::default();
    measure("bake", instants, &|progress| hdlod::build(&scene, &built, progress).map(drop));
    let tree = hdlod::build(&scene, &built, &Progress::default()).expect("nobody cancels");
    let (moved, restated) = edited(&scene, &tree);
    measure("repair", instants, &|progress| restated.repair(&moved, progress).map(drop));
    let plan = Plan::sample(glam::UVec2::new(1280, 720), 1.0);
    measure("verify", instants, &|progress| verify(&scene, &tree, &plan, progress).map(drop));
}

fn instants() -> u32 {
    std::env::var("TOPOUT_CANCELS").ok().and_then(|n| n.parse().ok()).unwrap_or(40)
}
