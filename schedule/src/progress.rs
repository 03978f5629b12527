//! How much of a project is done over time, as planned and as it happened.

use crate::{DateSet, Dates, Schedule, Time};

/// Shares of a project's work over time, from 0 to 1, piecewise linear between their points.
///
/// Work is weighed by its planned duration by the clock, so milestones weigh nothing; activities that
/// are inactive or have no planned dates in order do not count.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct SCurve {
    /// The share that is planned to be done: of each activity, the share of its planned dates that
    /// has passed. Empty if nothing is planned.
    pub planned: Vec<(Time, f32)>,
    /// The share that was done, up to the data date (or else the last actual date) and not beyond;
    /// `None` if the schedule says nothing of what happened. Of each activity, its percent complete
    /// (100 if it actually ended) arises evenly from its actual start, or else its planned start, to
    /// its actual end, or else the data date. Percents count where there is an actual start, too, or a
    /// data date.
    pub actual: Option<Vec<(Time, f32)>>,
}

impl SCurve {
    /// More points than this a curve does not have. Where there would be more, this many are spread
    /// evenly over its time, and between them the curve errs by no more than it rises there.
    pub const MAX_POINTS: usize = 512;

    /// The curves of a schedule: O(n log n).
    pub fn new(schedule: &Schedule) -> SCurve {
        let known = schedule.activities.iter().filter(|a| a.active).filter_map(|activity| {
            let planned = activity.dates_of(DateSet::Planned);
            let weight = planned.seconds().filter(|&s| s > 0)?;
            Some((activity, planned, weight))
        });
        let known: Vec<_> = known.collect();
        let total: f64 = known.iter().map(|&(.., weight)| weight as f64).sum();
        let actual = |a: &crate::Activity| a.date_sets[DateSet::Actual];
        let ramps =
            known.iter().filter_map(|&(_, planned, weight)| Ramp::new(planned, weight as f64));
        let planned = points(ramps.collect(), total, None);

        let latest = || {
            let all = known.iter().map(|&(a, ..)| actual(a));
            all.flat_map(|d| [d.start, d.end]).flatten().max()
        };
        let Some(until) = schedule.data_date.or_else(latest) else {
            return SCurve { planned, actual: None };
        };
        let mut any = false;
        let mut ramps = Vec::new();
        for &(activity, planned, weight) in &known {
            let Dates { start, end } = actual(activity);
            any |= start.is_some() || end.is_some() || activity.percent_complete.is_some();
            let ended = end.is_some();
            let percent = f64::from(activity.percent_complete.unwrap_or_default());
            let share = if ended { 1.0 } else { (percent / 100.0).clamp(0.0, 1.0) };
            let end = end.unwrap_or(until);
            let start = start.or(planned.start).unwrap_or(end).min(end);
            if share > 0.0 {
                let dates = Dates { start: Some(start), end: Some(end) };
                ramps.extend(Ramp::new(dates, share * weight as f64));
            }
        }
        let actual = any.then(|| points(ramps, total, Some(until)));
        SCurve { planned, actual }
    }

    /// The share that is planned to be done at an instant; 0 where nothing is planned.
    pub fn planned_at(&self, time: Time) -> f32 {
        Self::at(&self.planned, time).unwrap_or(0.0)
    }

    /// The share that was done at an instant; `None` after the last that is known of.
    pub fn actual_at(&self, time: Time) -> Option<f32> {
        let actual = self.actual.as_deref()?;
        (time <= actual.last()?.0).then(|| Self::at(actual, time)).flatten()
    }

    /// The height of a curve at an instant, by its points; beyond its ends that of its ends. `None`
    /// for a curve without points.
    pub fn at(curve: &[(Time, f32)], time: Time) -> Option<f32> {
        let after = curve.partition_point(|point| point.0 <= time);
        let Some(&(from, low)) = after.checked_sub(1).and_then(|i| curve.get(i)) else {
            return curve.first().map(|point| point.1);
        };
        let Some(&(to, high)) = curve.get(after) else { return Some(low) };
        let seconds = |time: Time| time.seconds() as f64;
        let share = (seconds(time) - seconds(from)) / (seconds(to) - seconds(from));
        Some(low + (high - low) * share as f32)
    }
}

/// Work that arises evenly.
struct Ramp {
    start: i64,
    end: i64,
    work: f64,
}

impl Ramp {
    fn new(dates: Dates, work: f64) -> Option<Self> {
        let (start, end) = (dates.start?.seconds(), dates.end?.seconds());
        (start <= end).then_some(Self { start, end, work })
    }
}

/// The sum of ramps as shares of a total, up to an instant.
fn points(ramps: Vec<Ramp>, total: f64, until: Option<Time>) -> Vec<(Time, f32)> {
    // What begins and ends: instant, change of the rate, jump.
    let mut changes: Vec<(i64, f64, f64)> = Vec::with_capacity(2 * ramps.len());
    for Ramp { start, end, work } in ramps {
        if start == end {
            changes.push((end, 0.0, work));
        } else {
            let rate = work / end.saturating_sub(start) as f64;
            changes.extend([(start, rate, 0.0), (end, -rate, 0.0)]);
        }
    }
    changes.sort_unstable_by_key(|change| change.0);
    let mut all: Vec<(i64, f64)> = Vec::new();
    let (mut rate, mut done) = (0.0, 0.0);
    for (at, more, jump) in changes {
        if let Some(&(last, _)) = all.last() {
            done += rate * at.saturating_sub(last) as f64;
        }
        rate += more;
        // A jump is a point before it and one at it.
        if jump > 0.0 && all.last().is_none_or(|last| last.0 < at.saturating_sub(1)) {
            all.push((at.saturating_sub(1), done));
        }
        done += jump;
        match all.last_mut() {
            Some(last) if last.0 == at => last.1 = done,
            _ => all.push((at, done)),
        }
    }
    let share = |done: f64| (done / total).clamp(0.0, 1.0) as f32;
    let mut curve: Vec<(Time, f32)> =
        all.iter().map(|&(at, done)| (Time::from_seconds(at), share(done))).collect();
    if let Some(until) = until {
        let height = SCurve::at(&curve, until).unwrap_or(0.0);
        curve.truncate(curve.partition_point(|point| point.0 < until));
        curve.push((until, height));
    }
    if curve.len() <= SCurve::MAX_POINTS {
        return curve;
    }
    let (Some(&(first, _)), Some(&(last, _))) = (curve.first(), curve.last()) else { return curve };
    let span = i128::from(last.seconds()) - i128::from(first.seconds());
    let steps = SCurve::MAX_POINTS as i128 - 1;
    let at = |i: i128| (i128::from(first.seconds()) + span * i / steps) as i64;
    let mut few: Vec<(Time, f32)> = Vec::with_capacity(SCurve::MAX_POINTS);
    for time in (0..=steps).map(|i| Time::from_seconds(at(i))) {
        if few.last().is_none_or(|point| point.0 < time) {
            few.push((time, SCurve::at(&curve, time).unwrap_or(0.0)));
        }
    }
    few
}
