//! What is drawn for a cell, and what is made of the times. Whole tables: `app/tests`.
#![allow(clippy::unwrap_used)]

use super::*;
use glam::Vec3;
use std::collections::{BTreeSet, HashSet};

const MODES: [DrawMode; 3] = [DrawMode::Hdlod, DrawMode::Batched, DrawMode::Objects];

/// A cell that takes `frame_ms`, everything else being the same.
pub fn cell(moment: Moment, coverage: Coverage, mode: DrawMode, frame_ms: f64) -> Cell {
    let hdlod = mode == DrawMode::Hdlod;
    let passes = Pass::ALL.map(|(pass, name, _)| PassFigures {
        name,
        cpu_ms: [Pass::Select, Pass::Scene].contains(&pass).then_some(0.25),
        gpu_ms: None,
    });
    Cell {
        moment,
        coverage,
        mode,
        frame_ms,
        p95_ms: frame_ms,
        select_ms: 0.0,
        gpu_ms: None,
        draws: 1,
        triangles: 1234,
        left: hdlod.then_some(123),
        clusters: 0,
        frames: 30,
        worst_px: 0.0,
        flip: hdlod.then_some(0.01),
        coverage_change: hdlod.then_some(-0.02),
        passes: passes.to_vec(),
    }
}

/// The paper's own table, as if it had been measured here.
pub fn papers_cells() -> Vec<Cell> {
    let mut cells = Vec::new();
    for (row, (moment, _)) in table::PAPER.into_iter().zip(Moment::ALL) {
        for (ms, (coverage, _)) in row.into_iter().zip(Coverage::ALL) {
            cells.push(cell(moment, coverage, DrawMode::Hdlod, ms));
        }
        cells.push(cell(moment, Coverage::Full, DrawMode::Objects, row[3]));
    }
    cells
}

fn plan() -> Plan {
    Plan::new(UVec2::new(1280, 720), 1.0)
}

fn period() -> TimeRange {
    TimeRange { start: Time::from_seconds(0), end: Time::from_seconds(90_000) }
}

fn focus() -> Aabb {
    Aabb { min: Vec3::new(-20.0, 0.0, -30.0), max: Vec3::new(20.0, 100.0, 30.0) }
}

fn key(moment: Moment, coverage: Coverage) -> CellKey {
    CellKey { moment, coverage, mode: DrawMode::Hdlod }
}

fn inputs(moment: Moment, n: usize) -> Vec<FrameInput> {
    frames(key(moment, Coverage::Full), n, &focus(), period(), &plan())
}

#[test]
fn the_table_has_the_papers_rows_and_columns() {
    let keys = cells(&MODES);
    assert_eq!(keys.len(), 5 * (3 + 3 + 1));
    assert_eq!(keys.iter().collect::<HashSet<_>>().len(), keys.len());
    let objects = |k: &&CellKey| k.mode == DrawMode::Objects;
    assert!(keys.iter().filter(objects).all(|k| k.coverage == Coverage::Full));
    assert!(Moment::ALL.iter().all(|(m, name)| m.name() == *name));
}

#[test]
fn rows_stand_for_the_dates_of_the_contract() {
    let at = |moment: Moment| moment.instant(period()).map(Time::seconds);
    assert_eq!(at(Moment::Start), Some(0));
    assert_eq!(at(Moment::Third), Some(30_000));
    assert_eq!(at(Moment::TwoThirds), Some(60_000));
    assert_eq!(at(Moment::End), Some(89_999), "one second before the last instant");
    assert_eq!(at(Moment::Animation), None);
}

#[test]
fn azimuths_differ_a_little_and_surround_the_standard_one() {
    let all = inputs(Moment::Third, 30);
    let standard = standard_view(&focus(), Coverage::Full, &plan());
    let azimuth = |view: &View| {
        let from = view.eye - view.target;
        from.x.atan2(from.z).to_degrees()
    };
    assert!((azimuth(&standard) - 30.0).abs() < 1e-3);
    // Also the first five, which may be all that a slow baseline gets.
    for n in [5, 30] {
        let offsets: Vec<f32> = all[..n].iter().map(|f| azimuth(&f.view) - 30.0).collect();
        assert!(offsets.iter().all(|o| o.abs() <= AZIMUTH_SWING + 1e-3), "{offsets:?}");
        assert!(offsets.iter().any(|o| *o > 1.0) && offsets.iter().any(|o| *o < -1.0));
        let distinct: BTreeSet<i64> = offsets.iter().map(|o| (o * 1000.0) as i64).collect();
        assert_eq!(distinct.len(), n);
    }
    assert!(all.iter().all(|f| f.time == Time::from_seconds(30_000)));
}

#[test]
fn farther_cells_stand_at_two_and_four_times_the_distance() {
    let distance = |coverage| {
        let view = standard_view(&focus(), coverage, &plan());
        view.eye.distance(view.target)
    };
    let near = distance(Coverage::Full);
    assert!((distance(Coverage::Quarter) / near - 2.0).abs() < 1e-4);
    assert!((distance(Coverage::Sixteenth) / near - 4.0).abs() < 1e-4);
}

#[test]
fn the_animation_jumps_between_evenly_spread_dates() {
    for n in [12, 120] {
        let dates: Vec<i64> =
            inputs(Moment::Animation, n).iter().map(|f| f.time.seconds()).collect();
        let step = 90_000 / n as i64;
        let mut sorted = dates.clone();
        sorted.sort_unstable();
        assert!(sorted.windows(2).all(|w| (w[1] - w[0] - step).abs() <= 1), "{sorted:?}");
        assert!(sorted[0] > 0 && sorted[n - 1] < 90_000);
        let jump = |w: &[i64]| (w[1] - w[0]).abs() > 2 * step;
        assert!(dates.windows(2).all(jump), "each is a jump: {dates:?}");
    }
}

#[test]
fn percentiles_are_members_by_nearest_rank() {
    let values: Vec<f64> = (1..=30).rev().map(f64::from).collect();
    assert_eq!(percentile(values.clone(), 0.5), Some(15.0));
    assert_eq!(percentile(values, 0.95), Some(29.0));
    assert_eq!(percentile(vec![7.0], 0.95), Some(7.0));
    assert_eq!(percentile(Vec::new(), 0.5), None);
}

#[test]
fn the_animation_is_a_mean_and_a_date_a_median() {
    let values = vec![1.0, 2.0, 30.0];
    assert_eq!(typical(Moment::Animation, values.clone()), Some(11.0));
    assert_eq!(typical(Moment::End, values), Some(2.0));
    assert_eq!(typical(Moment::Animation, Vec::new()), None);
}

fn measurement(mode: DrawMode, moment: Moment) -> Measurement {
    let key = CellKey { moment, coverage: Coverage::Full, mode };
    Measurement::new(key, &Scene::default(), &plan())
}

#[test]
fn only_a_baseline_that_is_too_slow_gets_fewer_frames() {
    for (mode, moment, frame_ms, expected) in [
        (DrawMode::Objects, Moment::End, 700.0, 5),
        (DrawMode::Objects, Moment::Animation, 700.0, 12),
        (DrawMode::Objects, Moment::End, 90.0, 30),
        (DrawMode::Batched, Moment::Animation, 20.0, 120),
        (DrawMode::Batched, Moment::Animation, 30.0, 12),
        (DrawMode::Hdlod, Moment::End, 700.0, 30),
        (DrawMode::Hdlod, Moment::Animation, 700.0, 120),
    ] {
        let mut m = measurement(mode, moment);
        m.save_time(frame_ms);
        assert_eq!(m.inputs.len(), expected, "{mode:?} {moment:?} {frame_ms}");
    }
}

#[test]
fn pictures_are_compared_for_hdlod_alone() {
    assert_eq!(measurement(DrawMode::Hdlod, Moment::End).comparisons().len(), 1);
    assert_eq!(measurement(DrawMode::Hdlod, Moment::Animation).comparisons().len(), 3);
    assert_eq!(measurement(DrawMode::Batched, Moment::End).comparisons().len(), 0);
}

#[test]
fn a_cell_says_in_json_what_the_contract_lists() {
    let mut m = measurement(DrawMode::Hdlod, Moment::Third);
    assert_eq!(m.finish(), None, "nothing measured yet");
    m.samples = [3.0, 1.0, 2.0]
        .map(|ms| {
            (
                ms,
                FrameStats {
                    draws: 4,
                    triangles: 50,
                    left: Some(20),
                    worst_px: 0.5,
                    ..Default::default()
                },
            )
        })
        .to_vec();
    m.compared =
        vec![Difference { mean: 0.1, elements: 0.25, worst_tile: 0.5, coverage_change: -0.125 }];
    let json = serde_json::to_value(m.finish().unwrap()).unwrap();
    for (name, expected) in [
        ("time", serde_json::json!("1/3")),
        ("coverage", "1/1".into()),
        ("lod", "hdlod".into()),
        ("frame_ms", 2.0.into()),
        ("p95_ms", 3.0.into()),
        ("gpu_ms", serde_json::Value::Null),
        ("draws", 4.into()),
        ("triangles", 50.into()),
        ("left", 20.into()),
        ("flip", 0.25.into()),
        ("coverage_change", (-0.125).into()),
    ] {
        assert_eq!(json[name], expected, "{name}");
    }
    let names: Vec<&str> =
        json["passes"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(names, Pass::ALL.map(|(_, name, _)| name));
    for pass in json["passes"].as_array().unwrap() {
        assert!(pass["cpu_ms"].is_null() && pass["gpu_ms"].is_null(), "nothing was timed: {pass}");
    }
}
