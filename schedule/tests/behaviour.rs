//! Step functions against sampling at every instant.

use proptest::prelude::*;
use topout_schedule::{Behaviour, Preset, StepFunction, Time, TimeRange};

const LAST: i64 = 30;

fn t(seconds: i64) -> Time {
    Time::from_seconds(seconds)
}

fn period(start: i64, end: i64) -> TimeRange {
    TimeRange { start: t(start), end: t(end) }
}

fn behaviour(initial: bool, toggles: &[i64]) -> Behaviour {
    Behaviour::new(initial, toggles.iter().map(|&s| t(s)).collect()).expect("increasing")
}

fn any_behaviour() -> impl Strategy<Value = Behaviour> {
    (any::<bool>(), prop::collection::btree_set(0i64..LAST, 0..6))
        .prop_map(|(initial, toggles)| behaviour(initial, &toggles.into_iter().collect::<Vec<_>>()))
}

/// What H7 says, at one instant, without any step function.
fn naive_mean(parts: &[(f64, Behaviour)], at: Time) -> f64 {
    let total: f64 = parts.iter().map(|(w, _)| w).sum();
    parts.iter().filter(|(_, b)| b.at(at)).map(|(w, _)| w / total).sum()
}

fn mean(parts: &[(f64, Behaviour)]) -> StepFunction {
    let functions: Vec<(f64, StepFunction)> = parts.iter().map(|(w, b)| (*w, b.into())).collect();
    StepFunction::weighted_mean(functions.iter().map(|(w, f)| (*w, f)))
}

#[test]
fn toggles_must_increase() {
    assert!(Behaviour::new(false, vec![t(1), t(1)]).is_none());
    assert!(Behaviour::new(false, vec![t(2), t(1)]).is_none());
    assert!(Behaviour::new(true, vec![]).is_some());
}

#[test]
fn the_eight_presets() {
    let p = period(0, 100);
    for (b, preset) in [
        (behaviour(true, &[]), Preset::Static),
        (behaviour(false, &[]), Preset::Absent),
        (behaviour(false, &[10]), Preset::Installed),
        (behaviour(true, &[10]), Preset::Removed),
        (behaviour(false, &[10, 20]), Preset::Temporary),
        (behaviour(true, &[10, 20]), Preset::Skipped),
        (behaviour(false, &[10, 20, 30]), Preset::ReInstalled),
        (behaviour(true, &[10, 20, 30]), Preset::ReDeleted),
        (behaviour(false, &[10, 20, 30, 40]), Preset::Other),
    ] {
        assert_eq!(b.preset(p), preset);
    }
}

/// T is closed: the value at its first and at its last instant belong to what is seen.
#[test]
fn presets_at_the_ends_of_the_period() {
    let p = period(0, 100);
    assert_eq!(behaviour(false, &[0]).preset(p), Preset::Static);
    assert_eq!(behaviour(false, &[10, 100]).preset(p), Preset::Temporary);
    assert_eq!(behaviour(false, &[10, 101]).preset(p), Preset::Installed);
    assert_eq!(behaviour(false, &[-20, -10, 50]).preset(p), Preset::Installed);
    assert_eq!(behaviour(true, &[5]).preset(period(5, 5)), Preset::Absent);
}

#[test]
fn tiny_weights_still_keep_a_mean_from_0_and_1() {
    let parts = [(1e-30, behaviour(false, &[10])), (1e12, behaviour(false, &[20]))];
    let f = mean(&parts);
    assert_eq!(f.at(t(9)), 0.0);
    assert!(f.at(t(10)) > 0.0 && f.at(t(10)) < 1e-6);
    assert_eq!(f.at(t(20)), 1.0);
    let parts = [(1e12, behaviour(false, &[10])), (1e-30, behaviour(false, &[20]))];
    assert!(mean(&parts).at(t(10)) < 1.0);
}

#[test]
fn means_without_parts_or_weights() {
    assert_eq!(mean(&[]), StepFunction::constant(0.0));
    let parts = [(0.0, behaviour(false, &[10])), (0.0, behaviour(true, &[]))];
    assert_eq!(mean(&parts).values(), [0.5, 1.0]);
}

#[test]
fn difference_over_the_longest_period_does_not_overflow() {
    let all = TimeRange { start: Time::MIN, end: Time::MAX };
    let (on, off) = (StepFunction::constant(1.0), StepFunction::constant(0.0));
    assert_eq!(on.mean_difference(&off, all), 1.0);
    assert_eq!(on.mean_difference(&off, period(5, 5)), 0.0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn at_follows_the_toggles(b in any_behaviour()) {
        for s in -1..=LAST {
            let flips = b.toggles().iter().filter(|x| x.seconds() <= s).count();
            prop_assert_eq!(b.at(t(s)), b.initial() ^ (flips % 2 == 1));
            prop_assert_eq!(StepFunction::from(&b).at(t(s)), f32::from(u8::from(b.at(t(s)))));
        }
    }

    #[test]
    fn includes_is_presence_at_every_instant(a in any_behaviour(), b in any_behaviour()) {
        let naive = (-1..=LAST).all(|s| !b.at(t(s)) || a.at(t(s)));
        prop_assert_eq!(a.includes(&b), naive);
        prop_assert!(a.includes(&a) && Behaviour::always().includes(&b));
        prop_assert!(b.includes(&Behaviour::never()));
    }

    #[test]
    fn preset_names_the_values_seen(b in any_behaviour(), start in 0..LAST, length in 0..LAST) {
        let p = period(start, start + length);
        let mut seen = vec![b.at(p.start)];
        for s in start..=start + length {
            if seen.last() != Some(&b.at(t(s))) {
                seen.push(b.at(t(s)));
            }
        }
        let expected = match (seen[0], seen.len()) {
            (true, 1) => Preset::Static,
            (false, 1) => Preset::Absent,
            (false, 2) => Preset::Installed,
            (true, 2) => Preset::Removed,
            (false, 3) => Preset::Temporary,
            (true, 3) => Preset::Skipped,
            (false, 4) => Preset::ReInstalled,
            (true, 4) => Preset::ReDeleted,
            _ => Preset::Other,
        };
        prop_assert_eq!(b.preset(p), expected);
    }

    /// Means of behaviours, and means of such means as a tree of clusters makes them.
    #[test]
    fn weighted_mean_equals_sampling(
        parts in prop::collection::vec((0.01f64..100.0, any_behaviour()), 1..9),
        split in 0usize..9,
    ) {
        let (left, right) = parts.split_at(split.min(parts.len()));
        let weight = |half: &[(f64, Behaviour)]| half.iter().map(|(w, _)| w).sum::<f64>();
        let halves = [(weight(left), mean(left)), (weight(right), mean(right))];
        let used = halves.iter().filter(|(w, _)| *w > 0.0).map(|(w, f)| (*w, f));
        let nested = StepFunction::weighted_mean(used);
        let flat = mean(&parts);
        for f in [&flat, &nested] {
            for s in -1..=LAST {
                let value = f.at(t(s));
                prop_assert!((f64::from(value) - naive_mean(&parts, t(s))).abs() < 1e-5);
                prop_assert_eq!(value == 0.0, parts.iter().all(|(_, b)| !b.at(t(s))));
                prop_assert_eq!(value == 1.0, parts.iter().all(|(_, b)| b.at(t(s))));
            }
            prop_assert!(f.times().is_sorted_by(|a, b| a < b));
            prop_assert!(f.values().windows(2).all(|v| v[0] != v[1]));
            prop_assert_eq!(f.values().len(), f.times().len() + 1);
        }
    }

    #[test]
    fn mean_difference_equals_sampling(
        a in prop::collection::vec((0.01f64..100.0, any_behaviour()), 1..5),
        b in prop::collection::vec((0.01f64..100.0, any_behaviour()), 1..5),
        start in -5..LAST,
        length in 1..LAST,
    ) {
        let (f, g) = (mean(&a), mean(&b));
        let p = period(start, start + length);
        let differences = (start..start + length)
            .map(|s| (f64::from(f.at(t(s))) - f64::from(g.at(t(s)))).abs());
        let naive = differences.sum::<f64>() / length as f64;
        prop_assert!((f.mean_difference(&g, p) - naive).abs() < 1e-9);
        prop_assert_eq!(f.mean_difference(&g, p), g.mean_difference(&f, p));
        prop_assert_eq!(f.mean_difference(&f, p), 0.0);
    }
}
