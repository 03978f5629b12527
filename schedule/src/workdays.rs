//! Counting working days.

use crate::{Calendar, Shift, Time};
use std::collections::BTreeSet;

const DAY_SECONDS: i64 = 86_400;

/// Days from the first day of chrono's count to 1970-01-01.
const EPOCH_DAY: i64 = 719_163;

/// How many working days lie between instants, by one calendar.
///
/// Rule: each day on which the calendar works counts 1, however long it works then, and within such
/// a day what counts is the share of its working time that has passed. A calendar that works on no
/// weekday says nothing and counts as none; without a calendar all of Monday to Friday is worked.
/// `spans` are disjoint, in order, and everything outside them is as the weekdays say.
#[derive(Clone, Debug)]
pub(crate) struct WorkDays<'a> {
    calendar: Option<&'a Calendar>,
    /// Whether weekdays are worked, Monday first.
    week: [bool; 7],
    spans: Vec<Span>,
}

/// Days for which one exception counts. Days are numbered from 1970-01-01.
#[derive(Clone, Debug)]
struct Span {
    first: i64,
    /// The first day after it.
    end: i64,
    exception: usize,
    /// Working days that this span and those before it have more than their weekdays say.
    more: i64,
}

impl<'a> WorkDays<'a> {
    /// Sorts the exceptions of a calendar: O(n log n).
    pub(crate) fn new(calendar: Option<&'a Calendar>) -> Self {
        let calendar = calendar.filter(|c| c.week.iter().any(|shifts| !shifts.is_empty()));
        let week = match calendar {
            Some(calendar) => calendar.week.each_ref().map(|shifts| !shifts.is_empty()),
            None => std::array::from_fn(|weekday| weekday < 5),
        };
        let mut this = Self { calendar, week, spans: Vec::new() };
        let Some(calendar) = calendar else { return this };
        let mut more = 0;
        for (first, end, exception) in exception_spans(calendar) {
            let worked = !calendar.exceptions[exception].shifts.is_empty();
            let days = if worked { end - first } else { 0 };
            more += days - (this.weekdays_before(end) - this.weekdays_before(first));
            this.spans.push(Span { first, end, exception, more });
        }
        this
    }

    /// Working days from one instant to another, negative where the second is earlier.
    pub(crate) fn between(&self, from: Time, to: Time) -> f64 {
        let (from, to) = (self.before(from), self.before(to));
        (to.0 - from.0) as f64 + (to.1 - from.1)
    }

    /// Working days from an instant long ago: whole ones and a share.
    fn before(&self, time: Time) -> (i64, f64) {
        let day = time.seconds().div_euclid(DAY_SECONDS);
        let second = time.seconds().rem_euclid(DAY_SECONDS);
        let at = self.spans.partition_point(|span| span.end <= day);
        let mut whole = self.weekdays_before(day);
        whole += at.checked_sub(1).map_or(0, |last| self.spans[last].more);
        let mut shifts: Option<&[Shift]> =
            self.calendar.map(|c| &c.week[weekday(day) as usize][..]);
        let mut worked = self.week[weekday(day) as usize];
        if let (Some(span), Some(calendar)) = (self.spans.get(at), self.calendar)
            && span.first <= day
        {
            let exception = &calendar.exceptions[span.exception].shifts;
            worked = !exception.is_empty();
            shifts = Some(exception);
            let days = if worked { day - span.first } else { 0 };
            whole += days - (self.weekdays_before(day) - self.weekdays_before(span.first));
        }
        let share = match shifts {
            _ if !worked => 0.0,
            None => second as f64 / DAY_SECONDS as f64,
            Some(shifts) => {
                let (mut passed, mut all) = (0, 0);
                for shift in shifts {
                    let (start, end) = (i64::from(shift.start()), i64::from(shift.end()));
                    passed += second.clamp(start, end) - start;
                    all += end - start;
                }
                passed as f64 / all.max(1) as f64
            }
        };
        (whole, share)
    }

    /// Days before this one that their weekdays make working days, from a Monday long ago.
    fn weekdays_before(&self, day: i64) -> i64 {
        let weeks = (day + 3).div_euclid(7);
        let all = self.week.iter().filter(|&&w| w).count() as i64;
        let rest = self.week[..weekday(day) as usize].iter().filter(|&&w| w).count() as i64;
        weeks * all + rest
    }
}

/// Which exception counts on which days: first day, first day after, index; disjoint, in order. Of
/// several exceptions for one day the last counts. O(n log n). Days are numbered from 1970-01-01.
pub(crate) fn exception_spans(calendar: &Calendar) -> Vec<(i64, i64, usize)> {
    let number =
        |day: chrono::NaiveDate| i64::from(chrono::Datelike::num_days_from_ce(&day)) - EPOCH_DAY;
    let mut changes = Vec::with_capacity(2 * calendar.exceptions.len());
    for (i, exception) in calendar.exceptions.iter().enumerate() {
        let (first, end) = (number(exception.first), number(exception.last) + 1);
        if first < end {
            changes.extend([(first, true, i), (end, false, i)]);
        }
    }
    changes.sort_unstable();
    let mut open = BTreeSet::new();
    let mut spans = Vec::new();
    for (at, &(day, begins, exception)) in changes.iter().enumerate() {
        match begins {
            true => open.insert(exception),
            false => open.remove(&exception),
        };
        let next = changes.get(at + 1).filter(|next| next.0 > day);
        if let (Some(&(end, ..)), Some(&counts)) = (next, open.last()) {
            spans.push((day, end, counts));
        }
    }
    spans
}

/// 0 for Monday. 1970-01-01 was a Thursday.
fn weekday(day: i64) -> i64 {
    (day + 3).rem_euclid(7)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::CalendarException;
    use chrono::NaiveDate;
    use proptest::prelude::*;

    fn time(text: &str) -> Time {
        Time::parse_iso(text).unwrap()
    }

    /// Monday to Friday from 8 to 12 and 13 to 17, off from 21 December to 3 January, but for a
    /// Saturday morning.
    fn site() -> Calendar {
        let shift = |from: u32, to: u32| Shift::new(from * 3600, to * 3600).unwrap();
        let day = |text: &str| text.parse::<NaiveDate>().unwrap();
        let except = |first: &str, last: &str, shifts| CalendarException {
            first: day(first),
            last: day(last),
            shifts,
        };
        let week = |weekday: usize| match weekday {
            0..5 => vec![shift(8, 12), shift(13, 17)],
            _ => Vec::new(),
        };
        Calendar {
            name: "Site".to_owned(),
            week: std::array::from_fn(week),
            exceptions: vec![
                except("2026-12-21", "2027-01-03", Vec::new()),
                except("2026-12-26", "2026-12-26", vec![shift(8, 12)]),
            ],
        }
    }

    #[test]
    fn over_christmas() {
        let site = site();
        let days = WorkDays::new(Some(&site));
        let between = |a: &str, b: &str| days.between(time(a), time(b));
        // Friday evening to Tuesday evening after the break: Saturday the 26th, Monday and Tuesday.
        assert_eq!(between("2026-12-18T17:00", "2027-01-05T17:00"), 3.0);
        assert_eq!(between("2027-01-05T17:00", "2026-12-18T17:00"), -3.0);
        assert_eq!(between("2026-12-19", "2026-12-26"), 0.0);
        assert_eq!(between("2026-12-19", "2026-12-27"), 1.0);
        assert_eq!(between("2026-12-26T08:00", "2026-12-26T11:00"), 0.75);
        // Within days: 3 of 8 hours; the break at noon is no working time.
        assert_eq!(between("2026-12-14T12:00", "2026-12-14T13:00"), 0.0);
        assert_eq!(between("2026-12-14T11:00", "2026-12-14T15:00"), 0.375);
        // All of Monday to Friday without a calendar, or with one that works never.
        for days in [WorkDays::new(None), WorkDays::new(Some(&Calendar::default()))] {
            assert_eq!(days.between(time("2026-12-18"), time("2027-01-05")), 12.0);
            assert_eq!(days.between(time("2026-12-18T12:00"), time("2026-12-20T12:00")), 0.5);
        }
        assert!(days.between(Time::MIN, Time::MAX).is_finite());
    }

    proptest! {
        /// Against a count of day after day.
        #[test]
        fn as_counted_by_hand(
            exceptions in prop::collection::vec((0i64..60, 0u64..20, any::<bool>()), 0..6),
            week in prop::array::uniform7(any::<bool>()),
            (from, to) in (-10i64..80, -10i64..80),
        ) {
            let shifts = |worked| match worked {
                true => vec![Shift::new(28_800, 57_600).unwrap()],
                false => Vec::new(),
            };
            let day = |n: i64| NaiveDate::from_num_days_from_ce_opt((EPOCH_DAY + n) as i32).unwrap();
            let mut week = week;
            week[2] = true;
            let exceptions = exceptions.into_iter().map(|(first, length, worked)| CalendarException {
                first: day(first),
                last: day(first) + chrono::Days::new(length),
                shifts: shifts(worked),
            });
            let exceptions = exceptions.collect();
            let calendar = Calendar { name: String::new(), week: week.map(shifts), exceptions };
            let count = |a, b| (a..b).filter(|&n| !calendar.shifts_on(day(n)).is_empty()).count();
            let expected = count(from, to) as f64 - count(to, from) as f64;
            let at = |n: i64| Time::from_seconds(n * DAY_SECONDS);
            prop_assert_eq!(WorkDays::new(Some(&calendar)).between(at(from), at(to)), expected);
        }
    }
}
