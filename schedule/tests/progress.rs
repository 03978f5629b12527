//! S-curves, by hand and against sums over activities.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use topout_schedule::{Activity, DateSet, Dates, Diagnostics, SCurve, Schedule, Time};

fn at(seconds: i64) -> Time {
    Time::from_seconds(seconds)
}

fn activity(i: usize, start: i64, end: i64) -> Activity {
    let mut activity = Activity { id: format!("a{i}"), ..Activity::default() };
    activity.date_sets[DateSet::Planned] = Dates { start: Some(at(start)), end: Some(at(end)) };
    activity
}

fn schedule(activities: Vec<Activity>) -> Schedule {
    Schedule::new("p".into(), None, activities, Diagnostics::default())
}

/// 100 s from 0, then 300 s of which a third overlaps; the first took 200 s, of the second a quarter
/// is done at 300, where the data end.
#[test]
fn by_hand() {
    let (mut first, mut second) = (activity(0, 0, 100), activity(1, 0, 300));
    let mut milestone = activity(2, 300, 300);
    milestone.milestone = true;
    first.date_sets[DateSet::Actual] = Dates { start: Some(at(0)), end: Some(at(200)) };
    second.date_sets[DateSet::Actual].start = Some(at(100));
    second.percent_complete = Some(25.0);
    let mut schedule = schedule(vec![first, second, milestone]);
    let none = SCurve::new(&Schedule::default());
    assert_eq!((none.planned_at(at(0)), none.actual_at(at(0))), (0.0, None));
    schedule.data_date = Some(at(300));
    let curve = SCurve::new(&schedule);
    assert_eq!(curve.planned, [(at(0), 0.0), (at(100), 0.5), (at(300), 1.0)]);
    assert_eq!(curve.planned_at(at(-5)), 0.0);
    assert_eq!(curve.planned_at(at(200)), 0.75);
    assert_eq!(curve.planned_at(at(900)), 1.0);
    // 100 s of the first by 200, and 75 s of the second from 100 to 300.
    for (time, done) in [(0, 0.0), (100, 50.0), (200, 137.5), (300, 175.0)] {
        assert_eq!(curve.actual_at(at(time)), Some(done / 400.0), "{time}");
    }
    assert_eq!(curve.actual_at(at(301)), None);
    // Cut off at the data date.
    schedule.data_date = Some(at(150));
    let curve = SCurve::new(&schedule);
    assert_eq!(curve.actual.as_ref().unwrap().last().unwrap().0, at(150));
}

#[test]
fn nothing_happened() {
    let mut schedule = schedule(vec![activity(0, 0, 100)]);
    schedule.data_date = Some(at(50));
    assert_eq!(SCurve::new(&schedule).actual, None);
    schedule.activities[0].percent_complete = Some(0.0);
    assert_eq!(SCurve::new(&schedule).actual_at(at(50)), Some(0.0));
}

proptest! {
    #[test]
    fn sums(rows in prop::collection::vec((0i64..5_000, 0i64..900), 1..900), time in -10i64..6_000) {
        let schedule =
            schedule(rows.iter().enumerate().map(|(i, &(s, d))| activity(i, s, s + d)).collect());
        let curve = SCurve::new(&schedule);
        let total: i64 = rows.iter().map(|r| r.1).sum();
        let done: i64 = rows.iter().map(|r| (time - r.0).clamp(0, r.1)).sum();
        let expected = if total == 0 { 0.0 } else { done as f64 / total as f64 };
        prop_assert!(curve.planned.len() <= SCurve::MAX_POINTS);
        prop_assert!(curve.planned.windows(2).all(|w| w[0].0 < w[1].0 && w[0].1 <= w[1].1));
        let error = (f64::from(curve.planned_at(at(time))) - expected).abs();
        let exact = curve.planned.len() < SCurve::MAX_POINTS;
        prop_assert!(error < if exact { 1e-5 } else { 0.005 }, "{error}");
    }
}
