//! How much of a project is done over time: the planner's S-curve.

use crate::{Activity, DateSet, Schedule, Time, TimeRange};

/// A share that grows from 0, with knots where its slope changes.
#[derive(Clone, PartialEq, Debug, Default)]
struct Growth {
    /// Sorted instants, the share at each, and what is added each second from then on.
    knots: Vec<(Time, f64, f64)>,
}

impl Growth {
    /// The sum of amounts that grow evenly over spans; at once where a span has no length.
    fn of(parts: impl IntoIterator<Item = (TimeRange, f64)>) -> Self {
        let mut events: Vec<(Time, f64, f64)> = Vec::new();
        for (span, amount) in parts {
            let seconds = span.seconds() as f64;
            if seconds > 0.0 {
                events.push((span.start, 0.0, amount / seconds));
                events.push((span.end, 0.0, -amount / seconds));
            } else {
                events.push((span.start, amount, 0.0));
            }
        }
        events.sort_unstable_by_key(|event| event.0);
        let mut knots: Vec<(Time, f64, f64)> = Vec::with_capacity(events.len());
        let (mut value, mut slope, mut last) = (0.0, 0.0, Time::MIN);
        for (time, jump, bend) in events {
            if let Some(knot) = knots.last().filter(|knot| knot.0 < time) {
                value += slope * (time.seconds() - knot.0.seconds()) as f64;
            }
            value += jump;
            slope += bend;
            match knots.last_mut().filter(|_| last == time) {
                Some(knot) => *knot = (time, value, slope),
                None => knots.push((time, value, slope)),
            }
            last = time;
        }
        Self { knots }
    }

    fn at(&self, time: Time) -> f64 {
        match self.knots.partition_point(|knot| knot.0 <= time) {
            0 => 0.0,
            next => {
                let (from, value, slope) = self.knots[next - 1];
                value + slope * (time.seconds() - from.seconds()) as f64
            }
        }
    }
}

/// Planned and actual progress of a project over time.
///
/// An activity weighs as many seconds as it is planned to last and is done evenly from its start to its
/// end; those that do not happen and those without dates weigh nothing, milestones neither. What is
/// planned is the planned dates, else the baseline, else those that count. What was actually done grows
/// from the actual start to the actual end, or, of what is at work, to its percentage at the data date;
/// to half where no percentage is known.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct SCurve {
    planned: Growth,
    actual: Option<(Growth, Time)>,
    /// Seconds of all activities.
    weight: f64,
}

impl SCurve {
    /// O(n log n).
    pub fn new(schedule: &Schedule) -> Self {
        let activities = || schedule.activities.iter().filter(|a| a.active);
        let planned: Vec<(TimeRange, f64)> = activities()
            .filter_map(|a| planned(a).map(|span| (span, span.seconds() as f64)))
            .filter(|(_, weight)| *weight > 0.0)
            .collect();
        let weight = planned.iter().map(|(_, weight)| weight).sum();
        let actual = actual(schedule, activities());
        Self { planned: Growth::of(planned), actual, weight }
    }

    /// The share that was to be done by an instant, in [0, 1].
    pub fn planned_at(&self, time: Time) -> f32 {
        self.share(self.planned.at(time))
    }

    /// The share that was done by an instant, in [0, 1]; `None` after the data date, and where the
    /// schedule says nothing of it.
    pub fn actual_at(&self, time: Time) -> Option<f32> {
        let (actual, until) = self.actual.as_ref()?;
        (time <= *until).then(|| self.share(actual.at(time)))
    }

    /// Up to when it is known what was done.
    pub fn known_until(&self) -> Option<Time> {
        self.actual.as_ref().map(|(_, until)| *until)
    }

    /// Whether nothing weighs anything.
    pub fn is_empty(&self) -> bool {
        self.weight <= 0.0
    }

    fn share(&self, value: f64) -> f32 {
        if self.weight > 0.0 { (value / self.weight).clamp(0.0, 1.0) as f32 } else { 0.0 }
    }
}

fn planned(activity: &Activity) -> Option<TimeRange> {
    let sets = [DateSet::Planned, DateSet::Baseline].map(|set| activity.date_sets[set]);
    let whole = sets.into_iter().find_map(|dates| {
        let (start, end) = (dates.start?, dates.end?);
        (start <= end).then_some(TimeRange { start, end })
    });
    whole.or_else(|| activity.dates())
}

/// What was done, and until when that is known.
fn actual<'a>(
    schedule: &Schedule,
    activities: impl Iterator<Item = &'a Activity> + Clone,
) -> Option<(Growth, Time)> {
    let dates = |a: &Activity| a.date_sets[DateSet::Actual];
    let said = |a: &Activity| {
        dates(a).start.is_some() || a.percent_complete.is_some_and(|percent| percent > 0.0)
    };
    let last = activities.clone().flat_map(|a| [dates(a).start, dates(a).end]).flatten().max();
    let until = schedule.data_date.or(last)?;
    if !activities.clone().any(said) {
        return None;
    }
    let done = activities.filter(|a| said(a)).filter_map(|a| {
        let plan = planned(a)?;
        let weight = plan.seconds() as f64;
        let start = dates(a).start.unwrap_or(plan.start).min(until);
        let (end, share) = match dates(a).end {
            Some(end) => (end, 1.0),
            None => {
                (until, f64::from(a.percent_complete.unwrap_or(50.0).clamp(0.0, 100.0)) / 100.0)
            }
        };
        (weight > 0.0).then_some((TimeRange { start, end: end.max(start) }, weight * share))
    });
    Some((Growth::of(done), until))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn t(seconds: i64) -> Time {
        Time::from_seconds(seconds)
    }

    fn activity(from: i64, to: i64) -> Activity {
        Activity {
            id: format!("{from}-{to}"),
            start: Some(t(from)),
            end: Some(t(to)),
            ..Activity::default()
        }
    }

    fn schedule(activities: Vec<Activity>, data_date: Option<i64>) -> Schedule {
        Schedule { activities, data_date: data_date.map(t), ..Schedule::default() }
    }

    #[test]
    fn what_is_planned_grows_evenly_and_what_is_done_up_to_the_data_date() {
        let mut done = activity(0, 100);
        done.date_sets[DateSet::Actual] = crate::Dates { start: Some(t(20)), end: Some(t(60)) };
        let mut at_work = activity(50, 150);
        at_work.date_sets[DateSet::Actual].start = Some(t(60));
        at_work.percent_complete = Some(20.0);
        let curve = SCurve::new(&schedule(vec![done, at_work, activity(100, 300)], Some(80)));
        assert_eq!(
            [-5, 0, 50, 100, 150, 200, 300, 999].map(|s| curve.planned_at(t(s))),
            [0.0, 0.0, 0.125, 0.375, 0.625, 0.75, 1.0, 1.0]
        );
        let actual = [0, 20, 40, 60, 70, 80].map(|s| curve.actual_at(t(s)));
        assert_eq!(actual, [0.0, 0.0, 0.125, 0.25, 0.275, 0.3].map(Some));
        assert_eq!((curve.actual_at(t(81)), curve.known_until()), (None, Some(t(80))));
    }

    #[test]
    fn nothing_known_is_no_curve() {
        let curve = SCurve::new(&schedule(vec![activity(0, 10)], Some(5)));
        assert_eq!(curve.actual_at(t(3)), None);
        let empty = SCurve::new(&schedule(vec![Activity::default(), activity(4, 4)], None));
        assert!(empty.is_empty() && empty.planned_at(t(9)) == 0.0);
    }

    proptest! {
        /// Against a sum over all activities.
        #[test]
        fn it_is_the_sum_of_its_activities(
            spans in prop::collection::vec((0i64..100, 0i64..60), 1..20), at in -10i64..200,
        ) {
            let activities = spans.iter().map(|(from, long)| activity(*from, from + long)).collect();
            let curve = SCurve::new(&schedule(activities, None));
            let weight: i64 = spans.iter().map(|(_, long)| long).sum();
            let done: i64 = spans.iter().map(|(from, long)| (at - from).clamp(0, *long)).sum();
            let expected = if weight > 0 { done as f64 / weight as f64 } else { 0.0 };
            prop_assert!((f64::from(curve.planned_at(t(at))) - expected).abs() < 1e-6);
        }
    }
}
