//! From activities to presence: f_s of one element.

use crate::{Activity, Behaviour, Kinds, Time, TimeRange};

/// When an element with these activities is present (f_s of H1).
///
/// Rule: activities of kinds without a say in presence, inactive ones and those without usable dates
/// are ignored. With none left the element is there always, or never if inactive ones were among
/// them. Otherwise events act in time order, a later one overriding an earlier one, and at one
/// instant presence wins. What a kind shows before, during and after makes the events:
///
/// - construct (hidden, shown, shown): present at its start;
/// - demolish (shown, shown, hidden): absent at its end;
/// - temporary (hidden, shown, hidden): present at its start, absent at its end unless another
///   temporary lasts then; nothing if it has no length;
/// - away (shown, hidden, shown): absent at its start, present at its end unless another one lasts
///   then; nothing if it has no length;
/// - hidden, hidden, shown: present at its end; shown, hidden, hidden: absent at its start;
/// - hidden always: no event.
///
/// Before the events the element is what its first activity (earliest start, then earliest end, then
/// lowest id) shows before it: absent, unless that is a demolition or another that takes away.
pub fn presence<'a>(
    kinds: &Kinds,
    activities: impl IntoIterator<Item = &'a Activity>,
) -> Behaviour {
    let mut inactive = false;
    let mut acting: Vec<(&Activity, [bool; 3], TimeRange)> = Vec::new();
    for activity in activities {
        let kind = kinds.of(activity.kind);
        if kind.is_neutral() {
            continue;
        }
        inactive |= !activity.active;
        if activity.active
            && let Some(dates) = activity.dates()
        {
            acting.push((activity, kind.shown(), dates));
        }
    }
    let first = acting.iter().min_by_key(|(a, _, dates)| (dates.start, dates.end, &a.id));
    match first {
        Some(&(_, [before, ..], _)) => replay(before, events(&acting)),
        None if inactive => Behaviour::never(),
        None => Behaviour::always(),
    }
}

/// What happens when, unordered: (instant, whether the element is present from then on).
fn events(acting: &[(&Activity, [bool; 3], TimeRange)]) -> Vec<(Time, bool)> {
    let mut events = Vec::with_capacity(acting.len() + 1);
    // Of those that change presence while they last and no longer: to absent, to present.
    let mut spells: [Vec<TimeRange>; 2] = Default::default();
    for &(_, [before, during, after], dates) in acting {
        if before == after {
            if before != during && dates.start < dates.end {
                events.push((dates.start, during));
                spells[usize::from(during)].push(dates);
            }
        } else if before != during {
            events.push((dates.start, during));
        } else {
            events.push((dates.end, after));
        }
    }
    for (during, mut spells) in [false, true].into_iter().zip(spells) {
        // Those that overlap or touch form runs; only where a run ends does none of them last.
        spells.sort_unstable_by_key(|t| t.start);
        let mut run_end: Option<Time> = None;
        for next in spells {
            match run_end {
                Some(end) if next.start <= end => run_end = Some(end.max(next.end)),
                _ => {
                    events.extend(run_end.map(|end| (end, !during)));
                    run_end = Some(next.end);
                }
            }
        }
        events.extend(run_end.map(|end| (end, !during)));
    }
    events
}

/// Lets events act in order; instants at which nothing changes leave no toggle.
fn replay(initial: bool, mut events: Vec<(Time, bool)>) -> Behaviour {
    // false sorts before true: at one instant presence has the last word.
    events.sort_unstable();
    let mut toggles = Vec::new();
    let mut present = initial;
    for (i, &(time, value)) in events.iter().enumerate() {
        let last_of_instant = events.get(i + 1).is_none_or(|&(next, _)| next != time);
        if last_of_instant && value != present {
            toggles.push(time);
            present = value;
        }
    }
    Behaviour::new(initial, toggles).expect("at most one toggle an instant, in sorted order")
}
