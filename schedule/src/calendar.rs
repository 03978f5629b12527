//! Working time.

use crate::Time;
use chrono::{Datelike, NaiveDate, Timelike};
use serde::{Deserialize, Serialize};
use std::fmt;

const DAY_SECONDS: u32 = 86_400;

/// A span of working time within a day, in seconds from its midnight.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Shift {
    start: u32,
    end: u32,
}

impl Shift {
    /// `None` unless it starts before it ends and ends with the day at the latest.
    pub fn new(start: u32, end: u32) -> Option<Self> {
        (start < end && end <= DAY_SECONDS).then_some(Self { start, end })
    }

    /// First second of the day that belongs to it.
    pub fn start(self) -> u32 {
        self.start
    }

    /// First second of the day after it, up to 86,400.
    pub fn end(self) -> u32 {
        self.end
    }

    /// From `08:00-16:30`, where seconds may follow and the last end is `24:00`.
    fn from_text(text: &str) -> Option<Self> {
        let (start, end) = text.split_once('-')?;
        Self::new(seconds_of_day(start)?, seconds_of_day(end)?)
    }
}

impl fmt::Display for Shift {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let clock = |s: u32| match s % 60 {
            0 => format!("{:02}:{:02}", s / 3600, s / 60 % 60),
            rest => format!("{:02}:{:02}:{rest:02}", s / 3600, s / 60 % 60),
        };
        write!(f, "{}-{}", clock(self.start), clock(self.end))
    }
}

/// Seconds from midnight of `8:00`, `08:00:30` or `08:00:00.000`.
pub(crate) fn seconds_of_day(text: &str) -> Option<u32> {
    let mut parts = text.trim().split(':');
    let mut part = |limit: u32| -> Option<u32> {
        let text = parts.next()?.split('.').next()?;
        let digits = (1..=2).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
        text.parse().ok().filter(|&n| digits && n <= limit)
    };
    let (hours, minutes) = (part(24)?, part(59)?);
    let seconds = hours * 3600 + minutes * 60 + part(59).unwrap_or(0);
    (seconds <= DAY_SECONDS && parts.next().is_none()).then_some(seconds)
}

/// Days on which other hours are worked than their weekday says; none for days off.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CalendarException {
    /// First day.
    pub first: NaiveDate,
    /// Last day, not before the first.
    pub last: NaiveDate,
    /// When work is done on each of these days.
    pub shifts: Vec<Shift>,
}

/// Which hours are worked.
#[derive(Clone, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
#[serde(into = "CalendarText", try_from = "CalendarText")]
pub struct Calendar {
    /// What the planner calls it.
    pub name: String,
    /// Working hours of the weekdays, Monday first.
    pub week: [Vec<Shift>; 7],
    /// What differs from the week; of several for one day the last counts.
    pub exceptions: Vec<CalendarException>,
}

impl Calendar {
    /// The hours that are worked on a day.
    pub fn shifts_on(&self, day: NaiveDate) -> &[Shift] {
        let exception = self.exceptions.iter().rev().find(|e| e.first <= day && day <= e.last);
        let weekday = day.weekday().num_days_from_monday() as usize;
        exception.map_or(&self.week[weekday], |e| &e.shifts)
    }

    /// Whether anybody works at all.
    pub fn is_empty(&self) -> bool {
        self.week.iter().all(Vec::is_empty) && self.exceptions.iter().all(|e| e.shifts.is_empty())
    }

    /// `time` where somebody works then, else the next instant at which somebody does; `None` where
    /// nobody does within ten years from then.
    pub fn next_work(&self, time: Time) -> Option<Time> {
        let civil = time.civil()?;
        let since = i64::from(civil.num_seconds_from_midnight());
        let midnight = time.seconds() - since;
        let mut day = civil.date();
        for number in 0..3653 {
            let from = if number == 0 { since } else { 0 };
            let next = self.shifts_on(day).iter().filter(|s| i64::from(s.end) > from);
            if let Some(start) = next.map(|s| i64::from(s.start).max(from)).min() {
                let midnight = midnight + number * i64::from(DAY_SECONDS);
                return Some(Time::from_seconds(midnight + start));
            }
            day = day.succ_opt()?;
        }
        None
    }

    /// `time` where somebody works until then, else the last instant before it until which somebody did;
    /// `None` where nobody did within ten years before.
    pub fn last_work(&self, time: Time) -> Option<Time> {
        let civil = time.civil()?;
        let until = i64::from(civil.num_seconds_from_midnight());
        let midnight = time.seconds() - until;
        let mut day = civil.date();
        for number in 0..3653 {
            let to = if number == 0 { until } else { i64::from(DAY_SECONDS) };
            let last = self.shifts_on(day).iter().filter(|s| i64::from(s.start) < to);
            if let Some(end) = last.map(|s| i64::from(s.end).min(to)).max() {
                let midnight = midnight - number * i64::from(DAY_SECONDS);
                return Some(Time::from_seconds(midnight + end));
            }
            day = day.pred_opt()?;
        }
        None
    }
}

/// A calendar as JSON writes it.
#[derive(Serialize, Deserialize)]
struct CalendarText {
    #[serde(default)]
    name: String,
    #[serde(default)]
    week: WeekText,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    exceptions: Vec<ExceptionText>,
}

#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
struct WeekText {
    mon: Vec<String>,
    tue: Vec<String>,
    wed: Vec<String>,
    thu: Vec<String>,
    fri: Vec<String>,
    sat: Vec<String>,
    sun: Vec<String>,
}

#[derive(Serialize, Deserialize)]
struct ExceptionText {
    first: String,
    last: String,
    #[serde(default)]
    shifts: Vec<String>,
}

fn texts(shifts: Vec<Shift>) -> Vec<String> {
    shifts.iter().map(Shift::to_string).collect()
}

fn shifts(texts: Vec<String>) -> Result<Vec<Shift>, String> {
    let wrong = |text: &str| format!("{text:?} is no working time such as 08:00-16:30");
    texts.iter().map(|text| Shift::from_text(text).ok_or_else(|| wrong(text))).collect()
}

impl From<Calendar> for CalendarText {
    fn from(calendar: Calendar) -> Self {
        let [mon, tue, wed, thu, fri, sat, sun] = calendar.week.map(texts);
        let exception = |e: CalendarException| ExceptionText {
            first: e.first.to_string(),
            last: e.last.to_string(),
            shifts: texts(e.shifts),
        };
        CalendarText {
            name: calendar.name,
            week: WeekText { mon, tue, wed, thu, fri, sat, sun },
            exceptions: calendar.exceptions.into_iter().map(exception).collect(),
        }
    }
}

impl TryFrom<CalendarText> for Calendar {
    type Error = String;

    fn try_from(text: CalendarText) -> Result<Self, String> {
        let WeekText { mon, tue, wed, thu, fri, sat, sun } = text.week;
        let mut week: [Vec<Shift>; 7] = Default::default();
        for (day, texts) in week.iter_mut().zip([mon, tue, wed, thu, fri, sat, sun]) {
            *day = shifts(texts)?;
        }
        let day = |text: &str| {
            text.parse::<NaiveDate>().map_err(|_| format!("{text:?} is no day such as 2026-12-24"))
        };
        let exception = |e: ExceptionText| -> Result<CalendarException, String> {
            let (first, last) = (day(&e.first)?, day(&e.last)?);
            if last < first {
                return Err(format!("an exception ends {last} before its first day {first}"));
            }
            Ok(CalendarException { first, last, shifts: shifts(e.shifts)? })
        };
        let exceptions = text.exceptions.into_iter().map(exception).collect::<Result<_, _>>()?;
        Ok(Calendar { name: text.name, week, exceptions })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn clocks() {
        assert_eq!(seconds_of_day("08:00:00.000"), Some(28_800));
        assert_eq!(seconds_of_day("8:30"), Some(30_600));
        assert_eq!(seconds_of_day("24:00"), Some(86_400));
        for bad in ["", "8", "25:00", "24:01", "08:60", "-1:00", "1:2:3:4", "008:00"] {
            assert_eq!(seconds_of_day(bad), None, "{bad}");
        }
    }

    #[test]
    fn hours_of_a_day() {
        let text = r#"{"week": {"mon": ["08:00-12:00", "13:00-24:00"]}, "exceptions": [
            {"first": "2026-11-23", "last": "2026-11-23", "shifts": ["09:00:01-10:00"]}]}"#;
        let calendar: Calendar = serde_json::from_str(text).unwrap();
        let day = |text: &str| text.parse().unwrap();
        assert_eq!(calendar.shifts_on(day("2026-11-16")).len(), 2);
        assert_eq!(calendar.shifts_on(day("2026-11-23")), [Shift { start: 32_401, end: 36_000 }]);
        assert_eq!(calendar.shifts_on(day("2026-11-24")), []);
        let again: Calendar =
            serde_json::from_str(&serde_json::to_string(&calendar).unwrap()).unwrap();
        assert_eq!(again, calendar);
    }

    #[test]
    fn the_next_working_time() {
        let text = r#"{"week": {"mon": ["13:00-17:00", "08:00-12:00"], "tue": ["08:00-12:00"]},
            "exceptions": [{"first": "2026-12-01", "last": "2026-12-01"}]}"#;
        let calendar: Calendar = serde_json::from_str(text).unwrap();
        let next =
            |text: &str| calendar.next_work(Time::parse_iso(text).unwrap()).unwrap().to_string();
        // A Monday.
        assert_eq!(next("2026-11-23T08:00:00"), "2026-11-23T08:00:00");
        assert_eq!(next("2026-11-23T00:00:00"), "2026-11-23T08:00:00");
        assert_eq!(next("2026-11-23T11:59:59"), "2026-11-23T11:59:59");
        assert_eq!(next("2026-11-23T12:00:00"), "2026-11-23T13:00:00");
        assert_eq!(next("2026-11-23T17:00:00"), "2026-11-24T08:00:00");
        // Over days off, and over a Tuesday that is off.
        assert_eq!(next("2026-11-24T12:00:00"), "2026-11-30T08:00:00");
        assert_eq!(next("2026-11-30T18:00:00"), "2026-12-07T08:00:00");
        assert_eq!(Calendar::default().next_work(Time::from_seconds(0)), None);
        assert!(Calendar::default().is_empty() && !calendar.is_empty());
    }

    #[test]
    fn what_is_no_calendar() {
        for (text, says) in [
            (r#"{"week": {"mon": ["8-12"]}}"#, "8-12"),
            (r#"{"week": {"mon": ["12:00-08:00"]}}"#, "12:00-08:00"),
            (r#"{"exceptions": [{"first": "2026-01-02", "last": "2026-01-01"}]}"#, "before"),
            (r#"{"exceptions": [{"first": "soon", "last": "2026-01-01"}]}"#, "soon"),
        ] {
            let said = serde_json::from_str::<Calendar>(text).unwrap_err().to_string();
            assert!(said.contains(says), "{said}");
        }
    }
}
