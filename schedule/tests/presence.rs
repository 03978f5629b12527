//! Presence: each rule by itself, then all of them against a replay that follows the rules instant
//! by instant and is as naive as possible.

use proptest::prelude::*;
use topout_schedule::ActivityKind::{Construct, Demolish, Maintain, Neutral, Own, Temporary};
use topout_schedule::{
    Activity, ActivityKind, Behaviour, Kind, Kinds, Look, Phase, Preset, Time, TimeRange,
    appearance, presence,
};

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
    let b = presence(&Kinds::default(), &[activity(Construct, 10, 20)]);
    assert_eq!(b, behaviour(false, &[10]));
    assert!(!b.at(t(9)) && b.at(t(10)) && b.at(t(1000)));
}

#[test]
fn demolish_is_absent_from_its_end_on_and_was_there_from_the_beginning() {
    let b = presence(&Kinds::default(), &[activity(Demolish, 10, 20)]);
    assert_eq!(b, behaviour(true, &[20]));
    assert!(b.at(t(-1000)) && b.at(t(19)) && !b.at(t(20)));
}

#[test]
fn temporary_is_present_while_it_lasts() {
    let b = presence(&Kinds::default(), &[activity(Temporary, 10, 20)]);
    assert_eq!(b, behaviour(false, &[10, 20]));
    assert!(b.at(t(10)) && b.at(t(19)) && !b.at(t(20)));
}

#[test]
fn without_activities_it_is_always_there() {
    assert_eq!(presence(&Kinds::default(), &[]), Behaviour::always());
}

#[test]
fn neutral_activities_say_nothing() {
    assert_eq!(presence(&Kinds::default(), &[activity(Neutral, 10, 20)]), Behaviour::always());
    assert_eq!(
        presence(&Kinds::default(), &[inactive(activity(Neutral, 10, 20))]),
        Behaviour::always()
    );
    let with_construct = [activity(Neutral, 0, 5), activity(Construct, 10, 20)];
    assert_eq!(presence(&Kinds::default(), &with_construct), behaviour(false, &[10]));
    // Inspected once, but what builds it never happens.
    let never_built = [activity(Neutral, 0, 5), inactive(activity(Construct, 10, 20))];
    assert_eq!(presence(&Kinds::default(), &never_built), Behaviour::never());
}

#[test]
fn only_inactive_activities_mean_never_built() {
    assert_eq!(
        presence(&Kinds::default(), &[inactive(activity(Construct, 10, 20))]),
        Behaviour::never()
    );
    assert_eq!(
        presence(&Kinds::default(), &[inactive(activity(Demolish, 10, 20))]),
        Behaviour::never()
    );
}

#[test]
fn inactive_beside_active_is_ignored() {
    let all = [inactive(activity(Demolish, 0, 5)), activity(Construct, 10, 20)];
    assert_eq!(presence(&Kinds::default(), &all), behaviour(false, &[10]));
}

#[test]
fn activities_without_usable_dates_are_ignored() {
    let no_start = Activity { start: None, ..activity(Construct, 10, 20) };
    let no_end = Activity { end: None, ..activity(Construct, 10, 20) };
    let reversed = activity(Construct, 20, 10);
    assert_eq!(
        presence(&Kinds::default(), &[no_start.clone(), no_end.clone(), reversed.clone()]),
        Behaviour::always()
    );
    let all = [no_start, no_end, reversed.clone(), activity(Construct, 30, 40)];
    assert_eq!(presence(&Kinds::default(), &all), behaviour(false, &[30]));
    assert_eq!(
        presence(&Kinds::default(), &[reversed, inactive(activity(Construct, 1, 2))]),
        Behaviour::never()
    );
}

#[test]
fn several_constructs_count_from_the_earliest_start() {
    let all = [activity(Construct, 50, 60), activity(Construct, 10, 90), activity(Construct, 5, 6)];
    assert_eq!(presence(&Kinds::default(), &all), behaviour(false, &[5]));
}

#[test]
fn later_events_override_earlier_ones() {
    let all = [activity(Construct, 0, 10), activity(Demolish, 20, 30), activity(Construct, 50, 60)];
    assert_eq!(presence(&Kinds::default(), &all), behaviour(false, &[0, 30, 50]));
    // The demolition ends while the temporary lasts: it has the last word.
    let all = [activity(Temporary, 0, 40), activity(Demolish, 20, 30)];
    assert_eq!(presence(&Kinds::default(), &all), behaviour(false, &[0, 30]));
    // A temporary's end overrides the construct before it.
    let all = [activity(Construct, 5, 10), activity(Temporary, 0, 40)];
    assert_eq!(presence(&Kinds::default(), &all), behaviour(false, &[0, 40]));
}

#[test]
fn demolished_first_then_rebuilt() {
    let all = [activity(Construct, 50, 60), activity(Demolish, 10, 20)];
    assert_eq!(presence(&Kinds::default(), &all), behaviour(true, &[20, 50]));
}

#[test]
fn what_comes_first_is_decided_by_start_then_end_then_id() {
    // Both start at 10; the demolition ends first, so it is first.
    let all = [activity(Temporary, 10, 30), activity(Demolish, 10, 20)];
    assert_eq!(presence(&Kinds::default(), &all), behaviour(true, &[20]));
    let all = [activity(Temporary, 10, 20), activity(Demolish, 10, 30)];
    assert_eq!(presence(&Kinds::default(), &all), behaviour(false, &[10, 20]));
    // The same dates: the lower id, in whatever order they are given.
    let a = Activity { id: "A".into(), ..activity(Demolish, 10, 20) };
    let b = Activity { id: "B".into(), ..activity(Construct, 10, 20) };
    assert_eq!(presence(&Kinds::default(), [&a, &b]), behaviour(true, &[20]));
    assert_eq!(presence(&Kinds::default(), [&b, &a]), behaviour(true, &[20]));
}

#[test]
fn presence_wins_at_one_instant() {
    let all = [activity(Construct, 20, 30), activity(Demolish, 10, 20)];
    assert_eq!(presence(&Kinds::default(), &all), behaviour(true, &[]));
    let all = [activity(Temporary, 10, 20), activity(Construct, 20, 30)];
    assert_eq!(presence(&Kinds::default(), &all), behaviour(false, &[10]));
}

#[test]
fn overlapping_temporaries_are_present_while_any_lasts() {
    let overlap = [activity(Temporary, 10, 30), activity(Temporary, 20, 40)];
    assert_eq!(presence(&Kinds::default(), &overlap), behaviour(false, &[10, 40]));
    let inside = [activity(Temporary, 10, 40), activity(Temporary, 20, 30)];
    assert_eq!(presence(&Kinds::default(), &inside), behaviour(false, &[10, 40]));
    let touching = [activity(Temporary, 10, 20), activity(Temporary, 20, 30)];
    assert_eq!(presence(&Kinds::default(), &touching), behaviour(false, &[10, 30]));
    let apart = [activity(Temporary, 10, 20), activity(Temporary, 21, 30)];
    assert_eq!(presence(&Kinds::default(), &apart), behaviour(false, &[10, 20, 21, 30]));
    // The start of the second is an event of its own, after what a demolition took away.
    let between =
        [activity(Temporary, 0, 20), activity(Demolish, 1, 5), activity(Temporary, 10, 30)];
    assert_eq!(presence(&Kinds::default(), &between), behaviour(false, &[0, 5, 10, 30]));
}

#[test]
fn zero_length_activities() {
    assert_eq!(presence(&Kinds::default(), &[activity(Temporary, 10, 10)]), Behaviour::never());
    // It makes no event, yet it is the first activity: absent before the demolition.
    let all = [activity(Temporary, 5, 5), activity(Demolish, 10, 20)];
    assert_eq!(presence(&Kinds::default(), &all), Behaviour::never());
    // It does not bridge or cut anything either.
    let all = [activity(Temporary, 0, 10), activity(Temporary, 10, 10)];
    assert_eq!(presence(&Kinds::default(), &all), behaviour(false, &[0, 10]));
    assert_eq!(
        presence(&Kinds::default(), &[activity(Construct, 10, 10)]),
        behaviour(false, &[10])
    );
    assert_eq!(presence(&Kinds::default(), &[activity(Demolish, 10, 10)]), behaviour(true, &[10]));
}

#[test]
fn extreme_instants() {
    let all = [activity(Temporary, i64::MIN, i64::MAX)];
    let b = presence(&Kinds::default(), &all);
    assert!(b.at(t(i64::MIN)) && b.at(t(0)) && !b.at(t(i64::MAX)));
}

/// The built-in kinds and one of each way to be shown: `Own(i)` before, during and after by the bits of i,
/// the lowest first.
fn all_kinds() -> Kinds {
    let mut kinds = Kinds::default();
    for i in 0..8u8 {
        let phase = |bit: u8| match i >> bit & 1 {
            0 => Phase::Hidden,
            _ => Phase::Shown(Look::OWN),
        };
        let [before, during, after] = [0, 1, 2].map(phase);
        let kind = Kind { name: format!("own {i}"), before, during, after };
        assert_eq!(kinds.define(kind), Ok(Own(i)));
    }
    kinds
}

#[test]
fn all_eight_behaviours_come_of_activities() {
    let period = TimeRange { start: t(0), end: t(100) };
    let preset = |all: &[Activity]| presence(&Kinds::default(), all).preset(period);
    let built = activity(Construct, 10, 20);
    assert_eq!(preset(&[]), Preset::Static);
    assert_eq!(preset(&[inactive(built.clone())]), Preset::Absent);
    assert_eq!(preset(std::slice::from_ref(&built)), Preset::Installed);
    let removed = activity(Demolish, 30, 40);
    assert_eq!(preset(std::slice::from_ref(&removed)), Preset::Removed);
    assert_eq!(preset(&[activity(Temporary, 10, 20)]), Preset::Temporary);
    let again = activity(Construct, 50, 60);
    assert_eq!(preset(&[removed.clone(), again.clone()]), Preset::Skipped);
    assert_eq!(preset(&[built, removed.clone(), again.clone()]), Preset::ReInstalled);
    assert_eq!(preset(&[removed, again, activity(Demolish, 70, 80)]), Preset::ReDeleted);
    // A kind of the planner's own: away for repair.
    let away = presence(&all_kinds(), &[activity(Own(0b101), 10, 20)]);
    assert_eq!(away.preset(period), Preset::Skipped);
}

#[test]
fn kinds_of_the_planner() {
    let kinds = all_kinds();
    let of = |bits: u8| presence(&kinds, &[activity(Own(bits), 10, 20)]);
    assert_eq!(of(0b000), Behaviour::never());
    assert_eq!(of(0b001), behaviour(true, &[10]));
    assert_eq!(of(0b010), behaviour(false, &[10, 20]));
    assert_eq!(of(0b011), behaviour(true, &[20]));
    assert_eq!(of(0b100), behaviour(false, &[20]));
    assert_eq!(of(0b101), behaviour(true, &[10, 20]));
    assert_eq!(of(0b110), behaviour(false, &[10]));
    assert_eq!(of(0b111), Behaviour::always());
    assert_eq!(presence(&kinds, &[activity(Maintain, 10, 20)]), Behaviour::always());
}

#[test]
fn what_is_no_kind() {
    let mut kinds = Kinds::default();
    let kind = |text: &str| serde_json::from_str::<Kind>(text).expect("a kind");
    assert!(kinds.define(kind(r#"{"name": " "}"#)).is_err());
    let error = kinds.define(kind(r#"{"name": "Construct", "after": "hidden"}"#));
    assert!(error.expect_err("built in").contains("Construct"));
    let red = kind(r##"{"name": "Demolish", "during": {"color": "#FF0000", "opacity": 0.5}}"##);
    assert_eq!(kinds.define(red), Ok(Demolish));
    let look = Look { color: Some([255, 0, 0]), opacity: 0.5 };
    assert_eq!(kinds.of(Demolish).during, Phase::Shown(look));
    assert_eq!((kinds.of(Demolish).name.as_str(), kinds.to_write().count()), ("demolish", 1));
    for text in [
        r#"{"name": "x", "during": "gone"}"#,
        r##"{"name": "x", "during": {"color": "#12"}}"##,
        r#"{"name": "x", "during": {"opacity": 2}}"#,
    ] {
        assert!(serde_json::from_str::<Kind>(text).is_err(), "{text}");
    }
    for i in 0..Kinds::MOST_OWN {
        assert!(kinds.define(kind(&format!(r#"{{"name": "k{i}"}}"#))).is_ok());
    }
    assert!(kinds.define(kind(r#"{"name": "one more"}"#)).is_err());
    assert_eq!(kinds.find("K7"), Some(Own(7)));
}

#[test]
fn the_activity_that_lasts_gives_the_look() {
    let mut kinds = Kinds::default();
    let done =
        r##"{"name": "Concrete", "during": {"color": "#0000FF"}, "after": {"color": "#808080"}}"##;
    let concrete = kinds.define(serde_json::from_str(done).expect("a kind")).expect("defined");
    let look = |all: &[Activity], at| {
        let steps = appearance(&kinds, all);
        steps.iter().rfind(|step| step.0 <= t(at)).expect("one from the beginning on").1.color
    };
    let all = [activity(concrete, 10, 20), activity(Maintain, 30, 40), activity(Neutral, 0, 99)];
    let [blue, grey, maintain] = [[0, 0, 255], [128; 3], [0, 0x72, 0xB2]].map(Some);
    assert_eq!(
        [9, 10, 19, 20, 30, 39].map(|at| look(&all, at)),
        [None, blue, blue, grey, maintain, maintain]
    );
    // After both what ended last counts, which leaves things as they are.
    assert_eq!(look(&all, 40), None);
    let both = [activity(concrete, 10, 20), activity(Construct, 15, 30)];
    assert_eq!(
        [12, 17, 25, 30].map(|at| look(&both, at)),
        [blue, Some([0, 0x9E, 0x73]), Some([0, 0x9E, 0x73]), None]
    );
    assert_eq!(look(&[inactive(activity(concrete, 10, 20))], 15), None);
    assert_eq!(look(&[activity(concrete, 20, 10)], 15), None);
}

/// The rules, one instant after the other.
fn naive(kinds: &Kinds, activities: &[Activity], at: i64) -> bool {
    let shown = |a: &Activity| kinds.of(a.kind).shown();
    let not_neutral: Vec<_> = activities.iter().filter(|a| shown(a) != [true; 3]).collect();
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
    let mut present = shown(first)[0];
    for now in (-1..=at).map(|s| Some(t(s))) {
        // What would be at this instant by each of them, absences before presences.
        let mut now_present = Vec::new();
        for a in &acting {
            let [before, during, after] = shown(a);
            let spell = before == after && during != before;
            let lasts = |o: &&&&Activity| shown(o) == shown(a) && o.start <= now && now < o.end;
            if before != during && a.start == now && !(spell && a.start == a.end) {
                now_present.push(during);
            }
            if during != after && a.end == now && !spell {
                now_present.push(after);
            }
            if spell && a.end == now && a.start < a.end && acting.iter().filter(lasts).count() == 0
            {
                now_present.push(after);
            }
        }
        for value in [false, true] {
            if now_present.contains(&value) {
                present = value;
            }
        }
    }
    present
}

/// Dates are few, so that equal instants are common.
fn any_activity() -> impl Strategy<Value = Activity> {
    let kind = prop_oneof![
        3 => prop_oneof![Just(Construct), Just(Demolish), Just(Temporary), Just(Neutral)],
        1 => (0u8..8).prop_map(Own),
    ];
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
        let kinds = all_kinds();
        let fast = presence(&all_kinds(), &activities);
        for at in -1..22 {
            prop_assert_eq!(fast.at(t(at)), naive(&kinds, &activities, at), "at {}", at);
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
        let before = presence(&all_kinds(), &activities);
        let mut shuffled = activities.clone();
        shuffled.sort_by_key(|a| {
            let text = format!("{seed}{}", a.id);
            text.bytes().fold(seed, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
        });
        prop_assert_eq!(presence(&all_kinds(), &shuffled), before);
    }
}

/// The rule of appearance, one activity after the other.
fn naive_look(kinds: &Kinds, activities: &[Activity], at: Time) -> Look {
    let own = Phase::Shown(Look::OWN);
    let mut best: Option<((u8, i64, &str), Look)> = None;
    for a in activities.iter().filter(|a| a.active) {
        let kind = kinds.of(a.kind);
        let Some(dates) = a.dates() else { continue };
        if [kind.before, kind.during, kind.after] == [own; 3] {
            continue;
        }
        let (rank, since, phase) = match () {
            () if at < dates.start => (0, -dates.start.seconds(), kind.before),
            () if at < dates.end => (2, dates.start.seconds(), kind.during),
            () => (1, dates.end.seconds(), kind.after),
        };
        let key = (rank, since, a.id.as_str());
        if best.as_ref().is_none_or(|(known, _)| *known < key) {
            best = Some((key, phase.look()));
        }
    }
    best.map_or(Look::OWN, |(_, look)| look)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn looks_equal_the_naive_rule(activities in prop::collection::vec(any_activity(), 0..7)) {
        let mut kinds = Kinds::default();
        for i in 0..8u8 {
            let color = |k| Phase::Shown(Look::colored([i, k, 0]));
            let [before, during, after] = [0, 1, 2].map(color);
            kinds.define(Kind { name: format!("own {i}"), before, during, after }).expect("new");
        }
        let mut activities = activities;
        for (i, a) in activities.iter_mut().enumerate() {
            a.id = format!("{}{i}", a.id);
        }
        let steps = appearance(&kinds, &activities);
        prop_assert!(steps.is_sorted_by(|a, b| a.0 < b.0 && a.1 != b.1));
        prop_assert_eq!(steps[0].0, Time::MIN);
        for at in (-1..22).map(t) {
            let found = steps.iter().rfind(|step| step.0 <= at).map(|step| step.1);
            prop_assert_eq!(found, Some(naive_look(&kinds, &activities, at)), "at {}", at);
        }
    }
}
