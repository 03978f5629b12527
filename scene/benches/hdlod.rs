//! What the parts of HDLOD cost: `cargo bench --workspace --bench hdlod`.
//!
//! As a test (`--test`) everything runs once, on a small demo project.
#![allow(missing_docs)]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{UVec2, Vec3};
use std::hint::black_box;
use std::sync::OnceLock;
use topout_scene::hdlod::{self, bench_support};
use topout_scene::{Aabb, Edited, ElementId, Hdlod, NamedView, Progress, Scene, View, demo, link};
use topout_schedule::TimeRange;

/// Whether this is a smoke test.
fn is_test() -> bool {
    std::env::args().any(|a| a == "--test")
}

fn scene() -> &'static Scene {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    SCENE.get_or_init(|| {
        let settings = match is_test() {
            true => demo::DemoSettings::for_elements(2000),
            false => demo::DemoSettings::default(),
        };
        let (model, schedule) =
            demo::generate(&settings, &Progress::default()).expect("nobody cancels");
        link::link(model, schedule)
    })
}

fn tree() -> &'static Hdlod {
    static TREE: OnceLock<Hdlod> = OnceLock::new();
    TREE.get_or_init(|| {
        hdlod::build(scene(), &hdlod::Settings::default(), &Progress::default())
            .expect("nobody cancels")
    })
}

/// A part of the tower, ten metres across, within three budgets.
fn simplify_and_certify(c: &mut Criterion) {
    let center = scene().focus_bounds().center();
    let part = Aabb { min: center - 5.0, max: center + 5.0 };
    let soup = bench_support::Soup::within(scene(), &part);
    println!("{} triangles in 10 m around the tower's middle", soup.triangles());
    for budget_m in [0.1f32, 0.4, 1.6] {
        let simplified = soup.simplify(budget_m);
        println!("  within {budget_m} m: {} triangles", simplified.triangles());
        let mut group = c.benchmark_group("simplify");
        group.throughput(Throughput::Elements(soup.triangles() as u64));
        group.bench_function(BenchmarkId::from_parameter(budget_m), |b| {
            b.iter(|| soup.simplify(black_box(budget_m)).triangles());
        });
        for (name, pairs) in [("edges", false), ("pairs", true)] {
            let left = soup.contract(budget_m, pairs).triangles();
            println!("  within {budget_m} m by contraction, {name}: {left} triangles");
            group.bench_function(BenchmarkId::new(name, budget_m), |b| {
                b.iter(|| soup.contract(black_box(budget_m), pairs).triangles());
            });
        }
        group.finish();
        let mut group = c.benchmark_group("certify");
        group.throughput(Throughput::Elements(soup.triangles() as u64));
        group.bench_function(BenchmarkId::from_parameter(budget_m), |b| {
            b.iter(|| soup.certify(black_box(&simplified), budget_m));
        });
        group.finish();
    }
}

/// H15: the time for each of n nodes should grow no faster than log n.
fn neighbours(c: &mut Criterion) {
    let mut group = c.benchmark_group("neighbours");
    let counts: &[u32] = if is_test() { &[1000] } else { &[10_000, 40_000, 160_000, 640_000] };
    for &n in counts {
        // One box a cubic metre, moved about within it.
        let edge = f64::from(n).cbrt().ceil() as u32;
        let bounds: Vec<Aabb> = (0..n)
            .map(|i| {
                let place = Vec3::new(
                    (i % edge) as f32,
                    (i / edge % edge) as f32,
                    (i / edge / edge) as f32,
                );
                let moved = Vec3::new(0.37, 0.71, 0.13) * (i % 101) as f32;
                let min = place + moved.fract() * 0.5;
                Aabb { min, max: min + 0.4 }
            })
            .collect();
        group.throughput(Throughput::Elements(u64::from(n)));
        group.bench_with_input(BenchmarkId::from_parameter(n), &bounds, |b, bounds| {
            b.iter(|| bench_support::group(black_box(bounds), 4.0));
        });
    }
    group.finish();
}

/// H10: all that happens in a frame before drawing.
fn select(c: &mut Criterion) {
    let (scene, tree) = (scene(), tree());
    let focus = scene.focus_bounds();
    let (azimuth, elevation) = NamedView::Iso.angles();
    let mut group = c.benchmark_group("select");
    for (name, factor) in [("1/1", 1.0), ("1/4", 2.0), ("1/16", 4.0)] {
        let view = View::fit(&focus, azimuth, elevation, factor, UVec2::new(1280, 720));
        for (date, fraction) in [("1/3", 1.0 / 3.0), ("2/3", 2.0 / 3.0), ("end", 1.0)] {
            let time = scene.schedule.period.at_fraction(fraction);
            group.bench_function(BenchmarkId::new(name, date), |b| {
                b.iter(|| hdlod::select(scene, tree, black_box(&view), time).triangles);
            });
        }
    }
    group.finish();
}

/// An activity in the middle of the period is moved by a week and back again: the two parts add up.
fn edit(c: &mut Criterion) {
    let scene = scene();
    let middle = scene.schedule.period.at_fraction(0.5);
    let touched = |e: usize| scene.activities_of(ElementId(e as u32)).first().copied();
    let (activity, dates) = (0..scene.model.elements.len())
        .filter_map(touched)
        .map(|a| a as usize)
        .filter_map(|a| Some((a, scene.schedule.activities[a].dates()?)))
        .min_by_key(|(_, dates)| dates.start.seconds().abs_diff(middle.seconds()))
        .expect("the demo has activities");
    const WEEK: i64 = 7 * 86_400;
    let later =
        TimeRange { start: dates.start.plus_seconds(WEEK), end: dates.end.plus_seconds(WEEK) };

    let mut tree = tree().clone();
    let Edited { scene: moved, changed, .. } =
        scene.with_activity_dates(&[(activity, later)]).expect("it exists");
    let done = tree.restate(&moved, &changed).expect("it is the same scene");
    println!(
        "moving an activity: {} elements, {} clusters restated, {} lose their certificate, {} \
         indices move",
        changed.len(),
        done.clusters,
        done.invalidated.len(),
        done.dirty.iter().map(|r| r.len()).sum::<usize>(),
    );
    for (name, factor) in [("1/1", 1.0), ("1/4", 2.0), ("1/16", 4.0)] {
        let (azimuth, elevation) = NamedView::Iso.angles();
        let size = UVec2::new(1280, 720);
        let view = View::fit(&scene.focus_bounds(), azimuth, elevation, factor, size);
        let end = scene.schedule.period.end;
        let before = hdlod::select(scene, self::tree(), &view, end).triangles;
        let after = hdlod::select(&moved, &tree, &view, end).triangles;
        println!("  cut at {name}, end: {before} triangles before, {after} after");
    }
    if !is_test() {
        let started = std::time::Instant::now();
        let repaired = tree.repair(&moved, &Progress::default()).expect("nobody cancels");
        println!("repaired in {:?}: {} stale", started.elapsed(), repaired.stale_count());
    }
    tree.restate(scene, &changed).expect("it is the same scene");

    let mut edited = scene.clone();
    let mut there = false;
    let mut group = c.benchmark_group("edit");
    group.bench_function("scene", |b| {
        b.iter(|| {
            there = !there;
            edited.move_activities(black_box(&[(activity, if there { later } else { dates })]))
        });
    });
    group.bench_function("tree", |b| {
        b.iter(|| {
            there = !there;
            tree.restate(if there { &moved } else { scene }, &changed)
        });
    });
    group.finish();
}

criterion_group!(benches, neighbours, simplify_and_certify, select, edit);
criterion_main!(benches);
