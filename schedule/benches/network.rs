//! What moving one activity costs: `cargo bench -p topout-schedule --bench network`.
//!
//! A programme of 100,000 activities with 250,000 links between them, five days of eight hours a week;
//! as a test (`--test`) one of 1,000.
#![allow(missing_docs)]

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use topout_schedule::{
    Activity, Diagnostics, Lag, LinkKind, Network, Predecessor, SCurve, Schedule, Time, TimeRange,
};

fn activities() -> usize {
    if std::env::args().any(|a| a == "--test") { 1_000 } else { 100_000 }
}

/// Activities of one to ten days that begin when the last of two or three predecessors ends.
fn schedule() -> Schedule {
    let first = Time::parse_iso("2026-03-02T08:00:00").expect("a date");
    let calendar = r#"{"week": {"mon": ["08:00-12:00", "13:00-17:00"], "tue": ["08:00-12:00", "13:00-17:00"],
        "wed": ["08:00-12:00", "13:00-17:00"], "thu": ["08:00-12:00", "13:00-17:00"],
        "fri": ["08:00-12:00", "13:00-17:00"]}, "exceptions": [{"first": "2026-12-24", "last": "2027-01-03"}]}"#;
    let lag = |days: i64| Lag { seconds: days * 8 * 3600, elapsed: false };
    let row = |i: usize| {
        let back = (0..2 + i % 2).map(|k| k * 977 + 20).filter(|&back| back <= i);
        let links = back.enumerate().map(|(k, back)| Predecessor {
            activity: (i - back) as u32,
            kind: if k == 2 { LinkKind::StartStart } else { LinkKind::FinishStart },
            lag: lag((i % 5) as i64 / 4),
        });
        let start = first.plus_seconds((i / 100) as i64 * 14 * 86_400);
        Activity {
            id: format!("a{i}"),
            start: Some(start),
            end: Some(start.plus_seconds((1 + i % 10) as i64 * 86_400)),
            predecessors: links.collect(),
            ..Activity::default()
        }
    };
    let all = (0..activities()).map(row).collect();
    let mut schedule = Schedule::new("bench".into(), None, all, Diagnostics::default());
    schedule.calendars = vec![serde_json::from_str(calendar).expect("a calendar")];
    schedule.calendar = Some(0);
    schedule
}

fn network(criterion: &mut Criterion) {
    let schedule = schedule();
    let network = Network::new(&schedule);
    let dates = schedule.activities[0].dates().expect("dates");
    let later = |time: Time| time.plus_seconds(3650 * 86_400);
    let moves = [(0, TimeRange { start: later(dates.start), end: later(dates.end) })];
    let tally = schedule.tally();
    println!(
        "{} activities, {} links; {} move",
        tally.activities,
        tally.predecessors,
        network.moved(&schedule, &moves).len()
    );
    let mut group = criterion.benchmark_group("network");
    group.sample_size(10);
    group.bench_function("new", |b| b.iter(|| black_box(Network::new(&schedule))));
    group.bench_function("moved", |b| b.iter(|| black_box(network.moved(&schedule, &moves))));
    group.bench_function("critical", |b| b.iter(|| black_box(network.critical(&schedule))));
    group.bench_function("s-curve", |b| b.iter(|| black_box(SCurve::new(&schedule))));
    group.finish();
}

criterion_group!(benches, network);
criterion_main!(benches);
