//! What the timeline knows of a schedule: counts and densities over time, and dates in words.
//!
//! Everything is a pure function of the instant asked for, so scrubbing, jumping and playing agree.

use chrono::NaiveTime;
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

    /// Starts and ends in each of `bins` equal parts of a span; the last part includes its end.
    pub fn density(&self, span: TimeRange, bins: usize) -> Vec<[usize; 2]> {
        let edge = |i: usize| span.at_fraction(i as f64 / bins as f64);
        (0..bins)
            .map(|i| {
                let to = if i + 1 == bins { edge(bins).plus_seconds(1) } else { edge(i + 1) };
                [&self.starts, &self.ends].map(|events| events_in(events, edge(i), to))
            })
            .collect()
    }

    /// The next instant after `time` at which an activity starts or ends, or the last one before.
    pub fn event_beside(&self, time: Time, after: bool) -> Option<Time> {
        let lists = [&self.starts, &self.ends];
        match after {
            true => {
                let next = |l: &Vec<Time>| l.get(l.partition_point(|&t| t <= time)).copied();
                lists.into_iter().filter_map(next).min()
            }
            false => {
                let last = |l: &Vec<Time>| l[..l.partition_point(|&t| t < time)].last().copied();
                lists.into_iter().filter_map(last).max()
            }
        }
    }

    /// `14 Mar 2027, Sunday · week 54`.
    pub fn headline(&self, time: Time) -> String {
        match (time.civil(), self.period.week(time)) {
            (Some(civil), Some(week)) => {
                format!("{} · week {week}", civil.format("%-d %b %Y, %A"))
            }
            _ => time.to_string(),
        }
    }
}

fn events_in(sorted: &[Time], from: Time, to: Time) -> usize {
    let before = |limit: Time| sorted.partition_point(|&t| t < limit);
    before(to).saturating_sub(before(from))
}

/// `3 Mar 2026`, whatever the time of day.
pub fn day_date(time: Time) -> String {
    time.civil().map_or_else(|| time.to_string(), |civil| civil.format("%-d %b %Y").to_string())
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
        assert_eq!(c.period().week(time("2026-03-03T08:00")), Some(1));
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
            let density = c.density(c.period(), bins);
            let sums = [0, 1].map(|i| density.iter().map(|bin| bin[i]).sum::<usize>());
            assert_eq!((density.len(), sums), (bins, [2, 2]));
        }
        assert!(c.density(c.period(), 0).is_empty());
        let part = TimeRange { start: time("2026-01-05"), end: time("2026-02-09") };
        assert_eq!(c.density(part, 2), [[1, 0], [0, 0]]);
    }
}
