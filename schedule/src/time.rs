//! Civil time in whole seconds. No time zone exists anywhere in topout.

use chrono::{Datelike, Duration, NaiveDate, NaiveDateTime, NaiveTime};
use std::fmt;

/// A civil instant: whole seconds since 1970-01-01T00:00:00, without a zone.
#[derive(
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Debug,
    Default,
    serde::Serialize,
    serde::Deserialize,
)]
pub struct Time(i64);

/// Why a text is not a date.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{text:?} is not a date ({expected})")]
pub struct TimeError {
    /// The text as found.
    pub text: String,
    /// What would have been read.
    pub expected: String,
}

impl Time {
    /// Before everything.
    pub const MIN: Self = Self(i64::MIN);
    /// After everything.
    pub const MAX: Self = Self(i64::MAX);

    /// From seconds since 1970-01-01T00:00:00.
    pub const fn from_seconds(seconds: i64) -> Self {
        Self(seconds)
    }

    /// Seconds since 1970-01-01T00:00:00.
    pub const fn seconds(self) -> i64 {
        self.0
    }

    /// From a civil date and time; fractions of a second are cut off.
    pub fn from_civil(civil: NaiveDateTime) -> Self {
        Self(civil.and_utc().timestamp())
    }

    /// The civil date and time, or `None` outside what a calendar can say.
    pub fn civil(self) -> Option<NaiveDateTime> {
        chrono::DateTime::from_timestamp(self.0, 0).map(|t| t.naive_utc())
    }

    /// This instant moved by a number of seconds, held at the ends of the range.
    pub const fn plus_seconds(self, seconds: i64) -> Self {
        Self(self.0.saturating_add(seconds))
    }

    /// Reads an ISO 8601 date (00:00 is meant) or date and time; a space may stand for the `T`,
    /// seconds may be missing, fractions of a second are cut off. A zone is refused.
    pub fn parse_iso(text: &str) -> Result<Self, TimeError> {
        let (time, _) = parse_iso(text)?;
        Ok(time)
    }
}

/// Like [`Time::parse_iso`]; also says whether the text was a date without a time of day.
pub(crate) fn parse_iso(text: &str) -> Result<(Time, bool), TimeError> {
    let text = text.trim();
    iso(text).ok_or_else(|| TimeError {
        text: text.to_owned(),
        expected: "ISO 8601 such as 2026-03-03 or 2026-03-03T08:00:00, without a zone".to_owned(),
    })
}

/// Reads by hand because chrono's `%Y` also takes the year 15 from 15-03-04: a guess, not a date.
fn iso(text: &str) -> Option<(Time, bool)> {
    let unsigned = text.strip_prefix(['+', '-']);
    let (year, rest) = unsigned.unwrap_or(text).split_once('-')?;
    let year_digits = if unsigned.is_some() { 4..=6 } else { 4..=4 };
    let year = i32::try_from(digits(year, year_digits)?).ok()?;
    let year = if text.starts_with('-') { -year } else { year };
    let (month, rest) = rest.split_once('-')?;
    let (day, time_of_day) = match rest.split_once(['T', ' ']) {
        Some((day, time)) => (day, Some(time.trim_start())),
        None => (rest, None),
    };
    let date = NaiveDate::from_ymd_opt(year, digits(month, 2..=2)?, digits(day, 2..=2)?)?;
    let Some(time_of_day) = time_of_day else {
        return Some((Time::from_civil(date.and_time(NaiveTime::MIN)), true));
    };
    let mut parts = time_of_day.split(':');
    let hour = digits(parts.next()?, 2..=2)?;
    let minute = digits(parts.next()?, 2..=2)?;
    let second = match parts.next() {
        Some(second) => {
            let (whole, fraction) = second.split_once('.').unwrap_or((second, "0"));
            digits(fraction, 1..=9)?;
            digits(whole, 2..=2)?
        }
        None => 0,
    };
    if parts.next().is_some() {
        return None;
    }
    Some((Time::from_civil(date.and_hms_opt(hour, minute, second)?), false))
}

/// A number of ASCII digits and nothing else, as many as said.
fn digits(text: &str, count: std::ops::RangeInclusive<usize>) -> Option<u32> {
    (count.contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit()))
        .then(|| text.parse().ok())?
}

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.civil() {
            Some(civil) => write!(f, "{}", civil.format("%Y-%m-%dT%H:%M:%S")),
            None => write!(f, "{} s", self.0),
        }
    }
}

/// A span of time, half-open: `start` belongs to it, `end` does not.
#[derive(
    Clone, Copy, PartialEq, Eq, Hash, Debug, Default, serde::Serialize, serde::Deserialize,
)]
pub struct TimeRange {
    /// First instant.
    pub start: Time,
    /// First instant after it.
    pub end: Time,
}

impl TimeRange {
    /// Length in seconds, never negative.
    pub fn seconds(&self) -> i64 {
        self.end.seconds().saturating_sub(self.start.seconds()).max(0)
    }

    /// The instant at a fraction of the span (0 = start, 1 = end).
    pub fn at_fraction(&self, fraction: f64) -> Time {
        self.start.plus_seconds((self.seconds() as f64 * fraction).round() as i64)
    }

    /// The week of a project that lasts so long: weeks begin on Mondays, the one that it starts in is the
    /// first. `None` beyond the calendar.
    pub fn week(&self, time: Time) -> Option<i64> {
        let start = self.start.civil()?.date();
        let monday = start - Duration::days(i64::from(start.weekday().num_days_from_monday()));
        Some((time.civil()?.date() - monday).num_days().div_euclid(7) + 1)
    }

    /// Whether the instant lies in the span.
    pub fn contains(&self, time: Time) -> bool {
        self.start <= time && time < self.end
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn iso_forms() {
        let noon = Time::parse_iso("2026-03-03T12:00:00").unwrap();
        assert_eq!(noon.seconds(), 1_772_539_200);
        for same in ["2026-03-03 12:00:00", "2026-03-03T12:00", " 2026-03-03 12:00:00.75 "] {
            assert_eq!(Time::parse_iso(same), Ok(noon), "{same}");
        }
        assert_eq!(parse_iso("2026-03-03"), Ok((noon.plus_seconds(-43_200), true)));
        assert_eq!(Time::parse_iso("2024-02-29").unwrap().to_string(), "2024-02-29T00:00:00");
    }

    #[test]
    fn what_is_not_iso_is_refused() {
        for bad in [
            "",
            "2026",
            "2026-3-3",
            "26-03-03",
            "03-03-2026",
            "2026-02-29",
            "2026-13-01",
            "2026-03-03T",
            "2026-03-03T8:00",
            "2026-03-03T24:00",
            "2026-03-03T08:00:00Z",
            "2026-03-03T08:00:00+01:00",
            "2026-03-03T08:00+01:00",
            "2026-03-03T08:00:00 Europe/Berlin",
            "2026-03-03T08:00:00:00",
            "2026/03/03",
            "20260303",
            "\u{0662}\u{0660}26-03-03",
        ] {
            let error = Time::parse_iso(bad).expect_err(bad);
            assert_eq!(error.text, bad);
            assert!(error.to_string().contains("without a zone"));
        }
    }

    #[test]
    fn fraction_of_a_period() {
        let period = TimeRange { start: Time::from_seconds(100), end: Time::from_seconds(400) };
        assert_eq!(period.at_fraction(1.0 / 3.0), Time::from_seconds(200));
        assert!(period.contains(period.start) && !period.contains(period.end));
        let reversed = TimeRange { start: period.end, end: period.start };
        assert_eq!(reversed.seconds(), 0);
    }

    proptest! {
        #[test]
        fn display_is_read_back(seconds in -100_000_000_000i64..400_000_000_000) {
            let time = Time::from_seconds(seconds);
            prop_assert_eq!(Time::parse_iso(&time.to_string()), Ok(time));
        }

        #[test]
        fn no_text_makes_it_panic(text in "\\PC{0,24}|[0-9+T: .-]{0,24}") {
            let _ = Time::parse_iso(&text);
        }
    }
}
