//! Civil time in whole seconds. No time zone exists anywhere in topout.

use chrono::{NaiveDate, NaiveDateTime, NaiveTime};
use std::fmt;

/// A civil instant: whole seconds since 1970-01-01T00:00:00, without a zone.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
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
    /// seconds may be missing. A zone is refused.
    pub fn parse_iso(text: &str) -> Result<Self, TimeError> {
        let (time, _) = parse_iso(text)?;
        Ok(time)
    }
}

/// Like [`Time::parse_iso`]; also says whether the text was a date without a time of day.
pub(crate) fn parse_iso(text: &str) -> Result<(Time, bool), TimeError> {
    let text = text.trim();
    if let Ok(date) = NaiveDate::parse_from_str(text, "%Y-%m-%d") {
        return Ok((Time::from_civil(date.and_time(NaiveTime::MIN)), true));
    }
    for format in ["%Y-%m-%dT%H:%M:%S", "%Y-%m-%d %H:%M:%S", "%Y-%m-%dT%H:%M", "%Y-%m-%d %H:%M"] {
        if let Ok(civil) = NaiveDateTime::parse_from_str(text, format) {
            return Ok((Time::from_civil(civil), false));
        }
    }
    Err(TimeError {
        text: text.to_owned(),
        expected: "ISO 8601 such as 2026-03-03 or 2026-03-03T08:00:00, without a zone".to_owned(),
    })
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
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
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

    /// Whether the instant lies in the span.
    pub fn contains(&self, time: Time) -> bool {
        self.start <= time && time < self.end
    }
}
