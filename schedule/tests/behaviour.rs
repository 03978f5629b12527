//! Step functions against sampling at every instant.

use proptest::prelude::*;
use topout_schedule::{Behaviour, BoundedStep, Preset, Share, StepFunction, Time, TimeRange};

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
fn naive_mean(parts: &[(u64, Behaviour)], at: Time) -> f64 {
    let total: u64 = parts.iter().map(|(w, _)| w).sum();
    parts.iter().filter(|(_, b)| b.at(at)).map(|(w, _)| *w as f64 / total as f64).sum()
}

fn share(parts: &[(u64, Behaviour)]) -> StepFunction {
    StepFunction::of_all(parts.iter().map(|(w, b)| (b, *w)))
}

fn parts(most: usize) -> impl Strategy<Value = Vec<(u64, Behaviour)>> {
    prop::collection::vec((1u64..1_000_000, any_behaviour()), 1..most)
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
fn small_weights_still_keep_a_share_from_0_and_1() {
    let huge = 1 << 60;
    let f = share(&[(1, behaviour(false, &[10])), (huge, behaviour(false, &[20]))]);
    assert_eq!(f.at(t(9)), 0.0);
    assert!(f.at(t(10)) > 0.0 && f.at(t(10)) < 1e-6);
    assert_eq!(f.at(t(20)), 1.0);
    let f = share(&[(huge, behaviour(false, &[10])), (1, behaviour(false, &[20]))]);
    assert!(f.at(t(10)) < 1.0);
}

#[test]
fn shares_of_nothing_and_of_what_weighs_nothing() {
    assert_eq!(share(&[]), StepFunction::default());
    assert_eq!(StepFunction::default().at(t(0)), 0.0);
    let f = share(&[(0, behaviour(false, &[10])), (0, behaviour(true, &[]))]);
    assert_eq!(f.shares().collect::<Vec<_>>(), [0.5, 1.0]);
}

#[test]
fn difference_over_the_longest_period_does_not_overflow() {
    let all = TimeRange { start: Time::MIN, end: Time::MAX };
    let (on, off) = (StepFunction::of(&Behaviour::always(), 3), StepFunction::default());
    assert_eq!(on.mean_difference(&off, all), 1.0);
    assert_eq!(on.mean_difference(&off, period(5, 5)), 0.0);
}

#[test]
fn spans_that_widen_least_are_merged_and_settled_ones_last() {
    // One object of ten a second: nothing, then 0.1, 0.2, ... 0.9, then everything.
    let parts: Vec<_> = (0..10).map(|i| (1, behaviour(false, &[i]))).collect();
    let f = share(&parts);
    let two = BoundedStep::new(&f, 2);
    assert_eq!(two.times(), [t(0), t(9)]);
    assert_eq!(
        two.shares(),
        [Share::exactly(0.0), Share { lo: 0.1, hi: 0.9 }, Share::exactly(1.0)]
    );
    assert_eq!(two.constant_from(), t(9));
    let none = BoundedStep::new(&f, 0);
    assert_eq!((none.times(), none.shares()), (&[][..], &[Share { lo: 0.0, hi: 1.0 }][..]));

    // A step that is short and one that is small go before one that is neither.
    let parts = [
        (50, behaviour(false, &[0])),
        (40, behaviour(false, &[10])),
        (1, behaviour(false, &[500])),
        (60, behaviour(false, &[990])),
        (50, behaviour(false, &[1000])),
    ];
    let bounded = BoundedStep::new(&share(&parts), 4);
    assert_eq!(bounded.times(), [t(0), t(10), t(990), t(1000)]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn at_follows_the_toggles(b in any_behaviour()) {
        for s in -1..=LAST {
            let flips = b.toggles().iter().filter(|x| x.seconds() <= s).count();
            prop_assert_eq!(b.at(t(s)), b.initial() ^ (flips % 2 == 1));
            prop_assert_eq!(StepFunction::of(&b, 7).at(t(s)), f32::from(u8::from(b.at(t(s)))));
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

    /// Shares of objects, and of sums of objects as a tree of clusters makes them.
    #[test]
    fn a_share_equals_sampling_however_it_was_summed(parts in parts(9), split in 0usize..9) {
        let (left, right) = parts.split_at(split.min(parts.len()));
        let flat = share(&parts);
        let each: Vec<_> = parts.iter().map(|(w, b)| StepFunction::of(b, *w)).collect();
        prop_assert_eq!(&StepFunction::sum([&share(left), &share(right)]), &flat);
        prop_assert_eq!(&StepFunction::sum(&each), &flat);
        for s in -1..=LAST {
            let value = flat.at(t(s));
            prop_assert!((f64::from(value) - naive_mean(&parts, t(s))).abs() < 1e-6);
            prop_assert_eq!(value == 0.0, parts.iter().all(|(_, b)| !b.at(t(s))));
            prop_assert_eq!(value == 1.0, parts.iter().all(|(_, b)| b.at(t(s))));
        }
        prop_assert!(flat.times().is_sorted_by(|a, b| a < b));
        prop_assert_eq!(flat.shares().len(), flat.times().len() + 1);
    }

    #[test]
    fn mean_difference_equals_sampling(
        a in parts(5),
        b in parts(5),
        start in -5..LAST,
        length in 1..LAST,
    ) {
        let (f, g) = (share(&a), share(&b));
        let p = period(start, start + length);
        let differences = (start..start + length)
            .map(|s| (naive_mean(&a, t(s)) - naive_mean(&b, t(s))).abs());
        let naive = differences.sum::<f64>() / length as f64;
        prop_assert!((f.mean_difference(&g, p) - naive).abs() < 1e-9);
        prop_assert_eq!(f.mean_difference(&g, p), g.mean_difference(&f, p));
        prop_assert_eq!(f.mean_difference(&f, p), 0.0);
    }

    /// R13: never wrong, never more than was allowed, exact where that suffices.
    #[test]
    fn a_bounded_step_function_holds_the_exact_one(parts in parts(30), steps in 0usize..20) {
        let exact = share(&parts);
        let bounded = BoundedStep::new(&exact, steps);
        prop_assert!(bounded.is_valid());
        prop_assert!(bounded.times().len() <= steps);
        for s in -1..=LAST {
            let (value, known) = (exact.at(t(s)), bounded.at(t(s)));
            prop_assert!(known.lo <= value && value <= known.hi, "{value} in {known:?}");
            if exact.times().len() <= steps {
                prop_assert_eq!(known, Share::exactly(value));
            }
            prop_assert!(known.hi <= 0.0 || bounded.may_be_present(t(s)));
            let later = bounded.times().iter().any(|&at| at > t(s));
            let ever = bounded.shares().iter().any(|share| share.hi > 0.0);
            prop_assert!(later || known.hi > 0.0 || !bounded.may_be_present(t(s)));
            prop_assert!(ever || !bounded.may_be_present(t(s)));
            if t(s) >= bounded.constant_from() {
                prop_assert_eq!(Some(&known), bounded.shares().last());
            }
        }
        if exact.times().len() <= steps {
            prop_assert_eq!(bounded.times(), exact.times());
        }
    }
}
