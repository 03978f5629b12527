//! How much is done: as planned, and as it happened.

use topout_schedule::{Activity, DateSet, Schedule, Time, TimeRange};

/// One activity's share in the whole.
struct Part {
    /// Seconds that it is planned to take.
    weight: f64,
    plan: TimeRange,
    actual: Option<Actual>,
}

/// What is known of how it went.
enum Actual {
    /// It began and ended.
    Done(TimeRange),
    /// It began, and this share was done at the date up to which the schedule knows.
    Begun(Time, f64),
}

/// The progress of a project over time: the shares of its activities that are done, weighted by the time that
/// each is planned to take.
pub struct Progress {
    parts: Vec<Part>,
    total: f64,
    /// The last instant of which anything actual is known.
    known_until: Option<Time>,
}

impl Progress {
    /// Of all activities that happen and have planned dates, or where no set of dates says so, dates at all.
    ///
    /// A milestone, which takes no time, has no weight unless nothing has. An activity that has begun comes, evenly, to
    /// its percentage on the day up to which the schedule knows; to half where no percentage is known.
    pub fn of(schedule: &Schedule) -> Self {
        let mut parts: Vec<Part> = schedule
            .activities
            .iter()
            .filter(|activity| activity.active)
            .filter_map(|activity| {
                let plan = range(activity, DateSet::Planned).or_else(|| activity.dates())?;
                let weight = plan.seconds() as f64;
                Some(Part { weight, plan, actual: actual(activity) })
            })
            .collect();
        if parts.iter().all(|part| part.weight == 0.0) {
            parts.iter_mut().for_each(|part| part.weight = 1.0);
        }
        let known = parts.iter().filter_map(|part| match part.actual.as_ref()? {
            Actual::Done(range) => Some(range.end),
            Actual::Begun(start, _) => Some(*start),
        });
        let last = known.max();
        // Nothing that happened lies after the date up to which it is known.
        let known_until = last.map(|last| schedule.data_date.unwrap_or(last));
        Self { total: parts.iter().map(|part| part.weight).sum(), parts, known_until }
    }

    /// Up to when it is known what happened; `None` if nothing is.
    pub fn known_until(&self) -> Option<Time> {
        self.known_until
    }

    /// The share in [0, 1] that is planned to be done at a time.
    pub fn planned(&self, time: Time) -> f64 {
        self.sum(|part| passed(part.plan, time))
    }

    /// The share in [0, 1] that was done at a time.
    pub fn actual(&self, time: Time) -> f64 {
        self.sum(|part| match part.actual {
            None => 0.0,
            Some(Actual::Done(range)) => passed(range, time),
            Some(Actual::Begun(start, share)) => {
                let until = self.known_until.unwrap_or(start);
                match start < until {
                    true => passed(TimeRange { start, end: until }, time) * share,
                    false => 0.0,
                }
            }
        })
    }

    fn sum(&self, done: impl Fn(&Part) -> f64) -> f64 {
        let sum: f64 = self.parts.iter().map(|part| part.weight * done(part)).sum();
        if self.total > 0.0 { sum / self.total } else { 0.0 }
    }
}

/// The share of a span that has passed at a time.
fn passed(range: TimeRange, time: Time) -> f64 {
    let since = time.seconds().saturating_sub(range.start.seconds()) as f64;
    match range.seconds() {
        0 => f64::from(u8::from(since >= 0.0)),
        length => (since / length as f64).clamp(0.0, 1.0),
    }
}

fn range(activity: &Activity, set: DateSet) -> Option<TimeRange> {
    let dates = activity.dates_of(set);
    let range = TimeRange { start: dates.start?, end: dates.end? };
    (range.start <= range.end).then_some(range)
}

fn actual(activity: &Activity) -> Option<Actual> {
    if let Some(range) = range(activity, DateSet::Actual) {
        return Some(Actual::Done(range));
    }
    let start = activity.dates_of(DateSet::Actual).start?;
    let share = activity.percent_complete.map_or(0.5, |percent| f64::from(percent) / 100.0);
    Some(Actual::Begun(start, share.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use topout_schedule::{DateSets, Dates};

    const DAY: i64 = 86_400;

    fn day(n: i64) -> Time {
        Time::from_seconds(n * DAY)
    }

    fn activity(planned: [i64; 2], actual: [Option<i64>; 2], percent: Option<f32>) -> Activity {
        let mut date_sets = DateSets::default();
        date_sets[DateSet::Planned] =
            Dates { start: Some(day(planned[0])), end: Some(day(planned[1])) };
        date_sets[DateSet::Actual] = Dates { start: actual[0].map(day), end: actual[1].map(day) };
        Activity { date_sets, percent_complete: percent, ..Activity::default() }
    }

    #[test]
    fn shares_are_weighted_by_planned_time() {
        let schedule = Schedule {
            activities: vec![
                activity([0, 10], [Some(0), Some(20)], None),
                activity([10, 40], [Some(20), None], Some(50.0)),
                activity([40, 40], [None, None], None),
                Activity { active: false, ..activity([0, 100], [None, None], None) },
            ],
            data_date: Some(day(30)),
            ..Schedule::default()
        };
        let progress = Progress::of(&schedule);
        assert_eq!(progress.known_until(), Some(day(30)));
        let planned = |n| progress.planned(day(n));
        assert_eq!([0, 5, 10, 25, 40, 99].map(planned), [0.0, 0.125, 0.25, 0.625, 1.0, 1.0]);
        let actual = |n| progress.actual(day(n));
        // Half of the second, which weighs three quarters, at the data date.
        assert_eq!([0, 10, 20, 25, 30].map(actual), [0.0, 0.125, 0.25, 0.4375, 0.625]);
    }

    #[test]
    fn what_has_begun_counts_half() {
        let schedule = Schedule {
            activities: vec![
                activity([0, 10], [Some(0), None], None),
                activity([0, 10], [Some(0), Some(8)], None),
            ],
            ..Schedule::default()
        };
        let progress = Progress::of(&schedule);
        assert_eq!(progress.known_until(), Some(day(8)));
        assert_eq!(progress.actual(day(8)), 0.75);
    }

    #[test]
    fn nothing_is_known_of_a_plan() {
        let schedule = Schedule {
            activities: vec![
                activity([0, 0], [None, None], None),
                activity([2, 2], [None, None], None),
            ],
            ..Schedule::default()
        };
        let progress = Progress::of(&schedule);
        assert_eq!(progress.known_until(), None);
        assert_eq!([-1, 0, 1, 2].map(|n| progress.planned(day(n))), [0.0, 0.5, 0.5, 1.0]);
        let empty = Progress::of(&Schedule::default());
        assert_eq!((empty.planned(day(1)), empty.known_until()), (0.0, None));
    }
}
