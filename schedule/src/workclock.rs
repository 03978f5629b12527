//! Counting seconds of working time, there and back.

use crate::workdays::exception_spans;
use crate::{Calendar, Shift};

const DAY: i64 = 86_400;

/// Instants and lags are clamped to this many seconds either way (a million years), so that sums of
/// them cannot overflow.
pub(crate) const LIMIT: i64 = 1 << 45;

/// The working time of one kind of day: disjoint shifts in order.
#[derive(Clone, Debug, Default)]
struct Day {
    shifts: Box<[(i64, i64)]>,
    seconds: i64,
}

impl Day {
    fn new(shifts: &[Shift]) -> Self {
        let mut sorted: Vec<(i64, i64)> =
            shifts.iter().map(|s| (i64::from(s.start()), i64::from(s.end()))).collect();
        sorted.sort_unstable();
        let mut joined: Vec<(i64, i64)> = Vec::with_capacity(sorted.len());
        for (start, end) in sorted {
            match joined.last_mut() {
                Some(last) if start <= last.1 => last.1 = last.1.max(end),
                _ => joined.push((start, end)),
            }
        }
        let seconds = joined.iter().map(|(start, end)| end - start).sum();
        Self { shifts: joined.into(), seconds }
    }

    /// Seconds worked before a second of the day.
    fn before(&self, second: i64) -> i64 {
        self.shifts.iter().map(|&(start, end)| second.clamp(start, end) - start).sum()
    }

    /// First second of the day before which this many are worked; `worked` is at least 1.
    fn reached(&self, mut worked: i64) -> i64 {
        for &(start, end) in &self.shifts {
            if worked <= end - start {
                return start + worked;
            }
            worked -= end - start;
        }
        DAY
    }
}

/// Days that one exception rules. Days are numbered from 1970-01-01.
#[derive(Clone, Debug)]
struct Span {
    first: i64,
    end: i64,
    day: Day,
    /// Work done before its first day and before the first day after it.
    before: i64,
    after: i64,
}

/// Working time as a clock that stands still at night: how many seconds were worked until an instant.
///
/// The count begins long ago and only differences of it mean something. Both directions take
/// O(log n) of the calendar's exceptions.
#[derive(Clone, Debug)]
pub(crate) struct WorkClock {
    week: [Day; 7],
    week_seconds: i64,
    spans: Vec<Span>,
}

impl WorkClock {
    /// `None` for a calendar that works on no weekday: it says nothing.
    pub(crate) fn new(calendar: &Calendar) -> Option<Self> {
        let week = calendar.week.each_ref().map(|shifts| Day::new(shifts));
        let week_seconds = week.iter().map(|day| day.seconds).sum();
        if week_seconds == 0 {
            return None;
        }
        let mut this = Self { week, week_seconds, spans: Vec::new() };
        let mut more = 0;
        for (first, end, exception) in exception_spans(calendar) {
            let day = Day::new(&calendar.exceptions[exception].shifts);
            let before = this.by_week(first) + more;
            let after = before + (end - first) * day.seconds;
            more = after - this.by_week(end);
            this.spans.push(Span { first, end, day, before, after });
        }
        Some(this)
    }

    /// Seconds worked until an instant.
    pub(crate) fn worked(&self, time: i64) -> i64 {
        let (number, second) = (time.div_euclid(DAY), time.rem_euclid(DAY));
        let at = self.spans.partition_point(|span| span.end <= number);
        if let Some(span) = self.spans.get(at).filter(|span| span.first <= number) {
            return span.before
                + (number - span.first) * span.day.seconds
                + span.day.before(second);
        }
        let day = &self.week[(number + 3).rem_euclid(7) as usize];
        self.by_week(number) + self.more(at) + day.before(second)
    }

    /// First instant until which this much is worked; where work ends.
    pub(crate) fn end_at(&self, worked: i64) -> i64 {
        let at = self.spans.partition_point(|span| span.after < worked);
        if let Some(span) = self.spans.get(at).filter(|span| span.before < worked) {
            let done = worked - span.before - 1;
            let (days, rest) = (done / span.day.seconds, done % span.day.seconds + 1);
            return (span.first + days) * DAY + span.day.reached(rest);
        }
        let done = worked - self.more(at) - 1;
        let mut rest = done.rem_euclid(self.week_seconds) + 1;
        // Day -3, 1969-12-29, was a Monday.
        let mut number = done.div_euclid(self.week_seconds) * 7 - 3;
        for day in &self.week {
            if rest <= day.seconds {
                return number * DAY + day.reached(rest);
            }
            rest -= day.seconds;
            number += 1;
        }
        number * DAY
    }

    /// Last instant until which no more is worked; where the next work begins.
    pub(crate) fn start_at(&self, worked: i64) -> i64 {
        self.end_at(worked + 1) - 1
    }

    /// Work that the weekdays alone say is done before a day.
    fn by_week(&self, number: i64) -> i64 {
        let weekday = (number + 3).rem_euclid(7) as usize;
        let rest: i64 = self.week[..weekday].iter().map(|day| day.seconds).sum();
        (number + 3).div_euclid(7) * self.week_seconds + rest
    }

    /// Work that the spans before one have more than the weekdays say.
    fn more(&self, at: usize) -> i64 {
        at.checked_sub(1).map_or(0, |last| {
            let span = &self.spans[last];
            span.after - self.by_week(span.end)
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::Time;

    #[test]
    fn there_and_back_over_three_weeks() {
        let text = r#"{"week": {"mon": ["13:00-17:00", "08:00-12:00"], "tue": ["08:00-12:00", "10:00-13:00"],
            "fri": ["00:00-24:00"]}, "exceptions": [
            {"first": "2026-12-01", "last": "2026-12-01"},
            {"first": "2026-12-05", "last": "2026-12-06", "shifts": ["09:00-10:00"]},
            {"first": "2026-12-06", "last": "2026-12-07"}]}"#;
        let calendar: Calendar = serde_json::from_str(text).unwrap();
        let clock = WorkClock::new(&calendar).unwrap();
        let first = Time::parse_iso("2026-11-22").unwrap().seconds();
        let mut worked = clock.worked(first);
        let civil = |t: i64| Time::from_seconds(t);
        for time in (first..first + 21 * DAY).step_by(1800) {
            let next = calendar.next_work(civil(time)).unwrap().seconds();
            let works = next < time + 1800;
            assert_eq!(clock.worked(time), worked, "{}", civil(time));
            assert_eq!(clock.start_at(worked), next, "{}", civil(time));
            worked += if works { 1800 } else { 0 };
            if works {
                assert_eq!(clock.end_at(worked), time + 1800, "{}", civil(time));
            }
        }
        assert!(WorkClock::new(&Calendar::default()).is_none());
    }
}
