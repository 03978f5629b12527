//! Presence: each rule by itself, then all of them against a replay that follows the rules instant
//! by instant and is as naive as possible.

use proptest::prelude::*;
use topout_schedule::ActivityKind::{Construct, Demolish, Neutral, Temporary};
use topout_schedule::{Activity, ActivityKind, Behaviour, Time, presence};

fn t(seconds: i64) -> Time {
    Time::from_seconds(seconds)
}

/// An activity whose id is its dates, so that ids differ in these tests.
fn activity(kind: ActivityKind, start: i64, end: i64) -> Activity {
    let id = format!("{start}-{end}-{kind:?}");
    Activity { id, start: Some(t(start)), end: Some(t(end)), kind, ..Activity::default() }
}

fn inactive(activity: Activity) -> Activity {
    Activity { active: false, ..activity }
}

fn behaviour(initial: bool, toggles: &[i64]) -> Behaviour {
    Behaviour::new(initial, toggles.iter().map(|&s| t(s)).collect()).expect("increasing")
}

#[test]
fn construct_is_present_from_its_start_on() {
    let b = presence(&[activity(Construct, 10, 20)]);
    assert_eq!(b, behaviour(false, &[10]));
    assert!(!b.at(t(9)) && b.at(t(10)) && b.at(t(1000)));
}

#[test]
fn demolish_is_absent_from_its_end_on_and_was_there_from_the_beginning() {
    let b = presence(&[activity(Demolish, 10, 20)]);
    assert_eq!(b, behaviour(true, &[20]));
    assert!(b.at(t(-1000)) && b.at(t(19)) && !b.at(t(20)));
}

#[test]
fn temporary_is_present_while_it_lasts() {
    let b = presence(&[activity(Temporary, 10, 20)]);
    assert_eq!(b, behaviour(false, &[10, 20]));
    assert!(b.at(t(10)) && b.at(t(19)) && !b.at(t(20)));
}

#[test]
fn without_activities_it_is_always_there() {
    assert_eq!(presence(&[]), Behaviour::always());
}

#[test]
fn neutral_activities_say_nothing() {
    assert_eq!(presence(&[activity(Neutral, 10, 20)]), Behaviour::always());
    assert_eq!(presence(&[inactive(activity(Neutral, 10, 20))]), Behaviour::always());
    let with_construct = [activity(Neutral, 0, 5), activity(Construct, 10, 20)];
    assert_eq!(presence(&with_construct), behaviour(false, &[10]));
    // Inspected once, but what builds it never happens.
    let never_built = [activity(Neutral, 0, 5), inactive(activity(Construct, 10, 20))];
    assert_eq!(presence(&never_built), Behaviour::never());
}

#[test]
fn only_inactive_activities_mean_never_built() {
    assert_eq!(presence(&[inactive(activity(Construct, 10, 20))]), Behaviour::never());
    assert_eq!(presence(&[inactive(activity(Demolish, 10, 20))]), Behaviour::never());
}

#[test]
fn inactive_beside_active_is_ignored() {
    let all = [inactive(activity(Demolish, 0, 5)), activity(Construct, 10, 20)];
    assert_eq!(presence(&all), behaviour(false, &[10]));
}

#[test]
fn activities_without_usable_dates_are_ignored() {
    let no_start = Activity { start: None, ..activity(Construct, 10, 20) };
    let no_end = Activity { end: None, ..activity(Construct, 10, 20) };
    let reversed = activity(Construct, 20, 10);
    assert_eq!(
        presence(&[no_start.clone(), no_end.clone(), reversed.clone()]),
        Behaviour::always()
    );
    let all = [no_start, no_end, reversed.clone(), activity(Construct, 30, 40)];
    assert_eq!(presence(&all), behaviour(false, &[30]));
    assert_eq!(presence(&[reversed, inactive(activity(Construct, 1, 2))]), Behaviour::never());
}

#[test]
fn several_constructs_count_from_the_earliest_start() {
    let all = [activity(Construct, 50, 60), activity(Construct, 10, 90), activity(Construct, 5, 6)];
    assert_eq!(presence(&all), behaviour(false, &[5]));
}

#[test]
fn later_events_override_earlier_ones() {
    let all = [activity(Construct, 0, 10), activity(Demolish, 20, 30), activity(Construct, 50, 60)];
    assert_eq!(presence(&all), behaviour(false, &[0, 30, 50]));
    // The demolition ends while the temporary lasts: it has the last word.
    let all = [activity(Temporary, 0, 40), activity(Demolish, 20, 30)];
    assert_eq!(presence(&all), behaviour(false, &[0, 30]));
    // A temporary's end overrides the construct before it.
    let all = [activity(Construct, 5, 10), activity(Temporary, 0, 40)];
    assert_eq!(presence(&all), behaviour(false, &[0, 40]));
}

#[test]
fn demolished_first_then_rebuilt() {
    let all = [activity(Construct, 50, 60), activity(Demolish, 10, 20)];
    assert_eq!(presence(&all), behaviour(true, &[20, 50]));
}

#[test]
fn what_comes_first_is_decided_by_start_then_end_then_id() {
    // Both start at 10; the demolition ends first, so it is first.
    let all = [activity(Temporary, 10, 30), activity(Demolish, 10, 20)];
    assert_eq!(presence(&all), behaviour(true, &[20]));
    let all = [activity(Temporary, 10, 20), activity(Demolish, 10, 30)];
    assert_eq!(presence(&all), behaviour(false, &[10, 20]));
    // The same dates: the lower id, in whatever order they are given.
    let a = Activity { id: "A".into(), ..activity(Demolish, 10, 20) };
    let b = Activity { id: "B".into(), ..activity(Construct, 10, 20) };
    assert_eq!(presence([&a, &b]), behaviour(true, &[20]));
    assert_eq!(presence([&b, &a]), behaviour(true, &[20]));
}

#[test]
fn presence_wins_at_one_instant() {
    let all = [activity(Construct, 20, 30), activity(Demolish, 10, 20)];
    assert_eq!(presence(&all), behaviour(true, &[]));
    let all = [activity(Temporary, 10, 20), activity(Construct, 20, 30)];
    assert_eq!(presence(&all), behaviour(false, &[10]));
}

#[test]
fn overlapping_temporaries_are_present_while_any_lasts() {
    let overlap = [activity(Temporary, 10, 30), activity(Temporary, 20, 40)];
    assert_eq!(presence(&overlap), behaviour(false, &[10, 40]));
    let inside = [activity(Temporary, 10, 40), activity(Temporary, 20, 30)];
    assert_eq!(presence(&inside), behaviour(false, &[10, 40]));
    let touching = [activity(Temporary, 10, 20), activity(Temporary, 20, 30)];
    assert_eq!(presence(&touching), behaviour(false, &[10, 30]));
    let apart = [activity(Temporary, 10, 20), activity(Temporary, 21, 30)];
    assert_eq!(presence(&apart), behaviour(false, &[10, 20, 21, 30]));
    // The start of the second is an event of its own, after what a demolition took away.
    let between =
        [activity(Temporary, 0, 20), activity(Demolish, 1, 5), activity(Temporary, 10, 30)];
    assert_eq!(presence(&between), behaviour(false, &[0, 5, 10, 30]));
}

#[test]
fn zero_length_activities() {
    assert_eq!(presence(&[activity(Temporary, 10, 10)]), Behaviour::never());
    // It makes no event, yet it is the first activity: absent before the demolition.
    let all = [activity(Temporary, 5, 5), activity(Demolish, 10, 20)];
    assert_eq!(presence(&all), Behaviour::never());
    // It does not bridge or cut anything either.
    let all = [activity(Temporary, 0, 10), activity(Temporary, 10, 10)];
    assert_eq!(presence(&all), behaviour(false, &[0, 10]));
    assert_eq!(presence(&[activity(Construct, 10, 10)]), behaviour(false, &[10]));
    assert_eq!(presence(&[activity(Demolish, 10, 10)]), behaviour(true, &[10]));
}

#[test]
fn extreme_instants() {
    let all = [activity(Temporary, i64::MIN, i64::MAX)];
    let b = presence(&all);
    assert!(b.at(t(i64::MIN)) && b.at(t(0)) && !b.at(t(i64::MAX)));
}

/// The rules, one instant after the other.
fn naive(activities: &[Activity], at: i64) -> bool {
    let not_neutral: Vec<_> = activities.iter().filter(|a| a.kind != Neutral).collect();
    let usable = |a: &&&Activity| match (a.start, a.end) {
        (Some(start), Some(end)) => a.active && start <= end,
        _ => false,
    };
    let acting: Vec<_> = not_neutral.iter().filter(usable).collect();
    if acting.is_empty() {
        return not_neutral.iter().all(|a| a.active);
    }
    let mut first = acting[0];
    for a in &acting {
        if (a.start, a.end, &a.id) < (first.start, first.end, &first.id) {
            first = a;
        }
    }
    let mut present = first.kind == Demolish;
    for now in (-1..=at).map(|s| Some(t(s))) {
        for a in &acting {
            let lasts = |o: &&&&Activity| o.kind == Temporary && o.start <= now && now < o.end;
            match a.kind {
                Demolish if a.end == now => present = false,
                Temporary if a.end == now && a.start < a.end => {
                    present &= acting.iter().filter(lasts).count() > 0;
                }
                _ => {}
            }
        }
        for a in &acting {
            match a.kind {
                Construct if a.start == now => present = true,
                Temporary if a.start == now && a.start < a.end => present = true,
                _ => {}
            }
        }
    }
    present
}

/// Dates are few, so that equal instants are common.
fn any_activity() -> impl Strategy<Value = Activity> {
    let kind = prop_oneof![Just(Construct), Just(Demolish), Just(Temporary), Just(Neutral)];
    let date = || prop_oneof![9 => (0i64..20).prop_map(Some), 1 => Just(None)];
    (kind, date(), date(), prop::bool::weighted(0.85), "[a-d]{1,2}").prop_map(
        |(kind, start, end, active, id)| Activity {
            id,
            start: start.map(t),
            end: end.map(t),
            kind,
            active,
            ..Activity::default()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn equals_the_naive_replay(activities in prop::collection::vec(any_activity(), 0..7)) {
        let mut activities = activities;
        // Ids are unique in a schedule.
        for (i, a) in activities.iter_mut().enumerate() {
            a.id = format!("{}{i}", a.id);
        }
        let fast = presence(&activities);
        for at in -1..22 {
            prop_assert_eq!(fast.at(t(at)), naive(&activities, at), "at {}", at);
        }
        // Normalised: every toggle is a change, all of them where something happens.
        for &toggle in fast.toggles() {
            let s = toggle.seconds();
            prop_assert_ne!(fast.at(t(s - 1)), fast.at(toggle));
        }
        prop_assert!(fast.toggles().is_sorted_by(|a, b| a < b));
    }

    #[test]
    fn order_does_not_matter(
        activities in prop::collection::vec(any_activity(), 0..7),
        seed in any::<u64>(),
    ) {
        let mut activities = activities;
        for (i, a) in activities.iter_mut().enumerate() {
            a.id = format!("{}{i}", a.id);
        }
        let before = presence(&activities);
        let mut shuffled = activities.clone();
        shuffled.sort_by_key(|a| {
            let text = format!("{seed}{}", a.id);
            text.bytes().fold(seed, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
        });
        prop_assert_eq!(presence(&shuffled), before);
    }
}
