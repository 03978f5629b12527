//! From activities to presence: f_s of one element.

use crate::{Activity, ActivityKind, Behaviour, Time, TimeRange};

/// When an element with these activities is present (f_s of H1).
///
/// Rule: neutral activities, inactive ones and those without usable dates are ignored. With none
/// left the element is there always, or never if inactive ones were among them. Otherwise events
/// act in time order, a later one overriding an earlier one, and at one instant presence wins:
///
/// - construct: present at its start;
/// - demolish: absent at its end;
/// - temporary: present at its start, absent at its end unless another temporary lasts then;
///   nothing if it has no length.
///
/// Before the events the element is absent, unless its first activity (earliest start, then
/// earliest end, then lowest id) is a demolition: then it has been there from the beginning.
pub fn presence<'a>(activities: impl IntoIterator<Item = &'a Activity>) -> Behaviour {
    let mut inactive = false;
    let mut acting: Vec<(&Activity, TimeRange)> = Vec::new();
    for activity in activities {
        if activity.kind == ActivityKind::Neutral {
            continue;
        }
        inactive |= !activity.active;
        if activity.active
            && let Some(dates) = activity.dates()
        {
            acting.push((activity, dates));
        }
    }
    let first = acting.iter().min_by_key(|(a, dates)| (dates.start, dates.end, &a.id));
    match first {
        Some((first, _)) => replay(first.kind == ActivityKind::Demolish, events(&acting)),
        None if inactive => Behaviour::never(),
        None => Behaviour::always(),
    }
}

/// What happens when, unordered: (instant, whether the element is present from then on).
fn events(acting: &[(&Activity, TimeRange)]) -> Vec<(Time, bool)> {
    let mut events = Vec::with_capacity(acting.len() + 1);
    let mut temporaries = Vec::new();
    for &(activity, dates) in acting {
        match activity.kind {
            ActivityKind::Construct => events.push((dates.start, true)),
            ActivityKind::Demolish => events.push((dates.end, false)),
            ActivityKind::Temporary if dates.start < dates.end => {
                events.push((dates.start, true));
                temporaries.push(dates);
            }
            ActivityKind::Temporary | ActivityKind::Neutral => {}
        }
    }
    // Temporaries that overlap or touch form runs; only where a run ends does none of them last.
    temporaries.sort_unstable_by_key(|t| t.start);
    let mut run_end: Option<Time> = None;
    for next in temporaries {
        match run_end {
            Some(end) if next.start <= end => run_end = Some(end.max(next.end)),
            _ => {
                events.extend(run_end.map(|end| (end, false)));
                run_end = Some(next.end);
            }
        }
    }
    events.extend(run_end.map(|end| (end, false)));
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
