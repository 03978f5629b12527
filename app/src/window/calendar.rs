//! What the timeline knows of a schedule: counts and densities over time, and dates in words.
//!
//! Everything is a pure function of the instant asked for, so scrubbing, jumping and playing agree.

use chrono::{Datelike, Duration, NaiveDate, NaiveTime};
use topout_schedule::{Schedule, Time, TimeRange};

/// Seconds of a civil day.
pub const DAY: i64 = 86_400;

/// Sorted starts and ends of all activities that have dates and happen.
#[derive(Clone, Debug, Default)]
pub struct Calendar {
    period: TimeRange,
    starts: Vec<Time>,
    ends: Vec<Time>,
}

/// A mark on the time axis.
#[derive(Clone, PartialEq, Debug)]
pub struct Tick {
    /// Where.
    pub time: Time,
    /// What stands beside it.
    pub label: String,
    /// The first of its year.
    pub major: bool,
}

impl Calendar {
    /// Reads the activities; those without dates or with an end before the start count nowhere.
    pub fn new(schedule: &Schedule) -> Self {
        let (mut starts, mut ends) = (Vec::new(), Vec::new());
        for activity in schedule.activities.iter().filter(|a| a.active) {
            if let (Some(start), Some(end)) = (activity.start, activity.end)
                && start <= end
            {
                starts.push(start);
                ends.push(end);
            }
        }
        starts.sort_unstable();
        ends.sort_unstable();
        Self { period: schedule.period, starts, ends }
    }

    /// T of the behaviours.
    pub fn period(&self) -> TimeRange {
        self.period
    }

    /// Activities with `start <= time < end`.
    pub fn active_at(&self, time: Time) -> usize {
        // Of those that started, the ones that ended are gone; a zero-length one is in both counts.
        let started = self.starts.partition_point(|&t| t <= time);
        started - self.ends.partition_point(|&t| t <= time)
    }

    /// Activities with `from <= start < to`.
    pub fn starting_in(&self, from: Time, to: Time) -> usize {
        events_in(&self.starts, from, to)
    }

    /// Starts and ends in each of `bins` equal parts of the period; the last part includes its end.
    pub fn density(&self, bins: usize) -> Vec<usize> {
        let edge = |i: usize| self.period.at_fraction(i as f64 / bins as f64);
        (0..bins)
            .map(|i| {
                let to = if i + 1 == bins { edge(bins).plus_seconds(1) } else { edge(i + 1) };
                events_in(&self.starts, edge(i), to) + events_in(&self.ends, edge(i), to)
            })
            .collect()
    }

    /// The instant at a share of the period, held at its ends.
    pub fn at(&self, share: f64) -> Time {
        self.period.at_fraction(share.clamp(0.0, 1.0))
    }

    /// The share of the period at an instant, in [0, 1].
    pub fn share(&self, time: Time) -> f64 {
        let length = self.period.seconds();
        if length == 0 {
            return 0.0;
        }
        let past = time.seconds().saturating_sub(self.period.start.seconds());
        (past as f64 / length as f64).clamp(0.0, 1.0)
    }

    /// The week of the project, Mondays first; the week of the project's start is 1.
    pub fn week(&self, time: Time) -> Option<i64> {
        let start = self.period.start.civil()?.date();
        let monday = start - Duration::days(i64::from(start.weekday().num_days_from_monday()));
        Some((time.civil()?.date() - monday).num_days().div_euclid(7) + 1)
    }

    /// `14 Mar 2027, Sunday · week 54`.
    pub fn headline(&self, time: Time) -> String {
        match (time.civil(), self.week(time)) {
            (Some(civil), Some(week)) => {
                format!("{} · week {week}", civil.format("%-d %b %Y, %A"))
            }
            _ => time.to_string(),
        }
    }

    /// Month marks, thinned so that at most `most` of them carry a label.
    pub fn ticks(&self, most: usize) -> Vec<Tick> {
        let (Some(start), Some(end)) = (self.period.start.civil(), self.period.end.civil()) else {
            return Vec::new();
        };
        let months = |d: NaiveDate| i64::from(d.year()) * 12 + i64::from(d.month0());
        let (first, last) = (months(start.date()), months(end.date()));
        let count = last - first + 1;
        // Steps that divide a year keep January among the marks.
        let step = [1, 2, 3, 6, 12, 24, 60, 120, 600]
            .into_iter()
            .find(|step| count / step <= most.max(1) as i64)
            .unwrap_or(1200);
        let from = first.div_euclid(step) * step;
        (from..=last)
            .step_by(step as usize)
            .filter_map(|m| {
                let month = u32::try_from(m.rem_euclid(12)).ok()? + 1;
                let year = i32::try_from(m.div_euclid(12)).ok()?;
                let date = NaiveDate::from_ymd_opt(year, month, 1)?;
                let time = Time::from_civil(date.and_time(NaiveTime::MIN));
                let major = month == 1;
                let label = if major || step >= 12 {
                    date.format("%Y").to_string()
                } else {
                    date.format("%b").to_string()
                };
                let inside = self.period.start <= time && time <= self.period.end;
                inside.then_some(Tick { time, label, major })
            })
            .collect()
    }
}

fn events_in(sorted: &[Time], from: Time, to: Time) -> usize {
    let before = |limit: Time| sorted.partition_point(|&t| t < limit);
    before(to).saturating_sub(before(from))
}

/// `3 Mar 2026`, with the time of day where it is not midnight.
pub fn short_date(time: Time) -> String {
    match time.civil() {
        Some(civil) if civil.time() == NaiveTime::MIN => civil.format("%-d %b %Y").to_string(),
        Some(civil) => civil.format("%-d %b %Y %H:%M").to_string(),
        None => time.to_string(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use topout_schedule::Activity;

    fn time(text: &str) -> Time {
        Time::parse_iso(text).unwrap()
    }

    fn calendar(spans: &[(&str, &str)]) -> Calendar {
        let activities = spans
            .iter()
            .enumerate()
            .map(|(i, (start, end))| Activity {
                id: format!("A{i}"),
                start: Some(time(start)),
                end: Some(time(end)),
                active: true,
                ..Activity::default()
            })
            .collect::<Vec<_>>();
        let start = activities.iter().filter_map(|a| a.start).min().unwrap();
        let end = activities.iter().filter_map(|a| a.end).max().unwrap();
        Calendar::new(&Schedule {
            project: String::new(),
            period: TimeRange { start, end },
            activities,
            ..Schedule::default()
        })
    }

    #[test]
    fn reads_dates_as_a_planner_says_them() {
        let c = calendar(&[("2026-03-03T08:00", "2028-07-24T13:00")]);
        assert_eq!(c.headline(time("2027-03-14")), "14 Mar 2027, Sunday · week 54");
        assert_eq!(c.headline(time("2027-03-15")), "15 Mar 2027, Monday · week 55");
        assert_eq!(c.week(time("2026-03-03T08:00")), Some(1));
        assert_eq!(short_date(time("2026-03-03")), "3 Mar 2026");
        assert_eq!(short_date(time("2026-03-03T08:30")), "3 Mar 2026 08:30");
    }

    #[test]
    fn counts_what_is_active_against_a_scan() {
        let spans = [
            ("2026-01-01", "2026-01-10"),
            ("2026-01-05", "2026-01-05"),
            ("2026-01-05", "2026-01-20"),
            ("2026-01-10", "2026-02-01"),
        ];
        let c = calendar(&spans);
        for hour in 0..(33 * 24) {
            let t = time("2025-12-31").plus_seconds(hour * 3600);
            let scan = spans.iter().filter(|(s, e)| time(s) <= t && t < time(e)).count();
            assert_eq!(c.active_at(t), scan, "at {t}");
        }
        assert_eq!(c.starting_in(time("2026-01-05"), time("2026-01-10")), 2);
    }

    #[test]
    fn density_counts_every_event_once() {
        let c = calendar(&[("2026-01-01", "2026-02-10"), ("2026-01-05", "2026-03-01")]);
        for bins in [1, 7, 64, 1000] {
            let density = c.density(bins);
            assert_eq!((density.len(), density.iter().sum::<usize>()), (bins, 4));
        }
        assert!(c.density(0).is_empty());
    }

    #[test]
    fn share_and_instant_are_inverse_and_held_at_the_ends() {
        let c = calendar(&[("2026-01-01", "2027-01-01")]);
        for i in 0..=10 {
            let share = f64::from(i) / 10.0;
            assert!((c.share(c.at(share)) - share).abs() < 1e-6);
        }
        assert_eq!(c.share(time("2020-01-01")), 0.0);
        assert_eq!(c.at(7.0), time("2027-01-01"));
        assert_eq!(Calendar::default().share(time("2020-01-01")), 0.0);
    }

    #[test]
    fn ticks_are_thinned_and_keep_january() {
        let c = calendar(&[("2026-03-03", "2028-07-24")]);
        let labels = |most| c.ticks(most).into_iter().map(|t| t.label).collect::<Vec<_>>();
        assert_eq!(labels(100).len(), 28);
        assert!(labels(10).len() <= 11);
        assert!(labels(10).contains(&"2027".to_owned()));
        assert_eq!(labels(3), ["2027", "2028"]);
        assert!(Calendar::default().ticks(5).len() <= 1);
    }
}
