//! Dates as files write them.

use super::ReadError;
use crate::time::parse_iso;
use crate::{Time, TimeError};
use chrono::format::{Fixed, Item, StrftimeItems};
use chrono::{NaiveDate, NaiveDateTime, NaiveTime};
use std::fmt::Write;

const DAY_SECONDS: i64 = 86_400;

/// Reads dates: ISO 8601, or by an explicit format.
///
/// Rule: with a format, a text is read by it; ISO 8601 is then understood too, unless the format
/// begins with the year as ISO does and the two could be taken for each other. A format without a
/// time of day also reads dates that have one after a space or a `T`.
pub(super) struct DateReader {
    format: Option<Format>,
}

struct Format {
    text: String,
    has_time: bool,
    iso_too: bool,
}

impl DateReader {
    /// Fails on a format that does not say year, month and day, or that has a zone.
    pub(super) fn new(format: Option<&str>) -> Result<Self, ReadError> {
        Ok(Self { format: format.map(Format::new).transpose()? })
    }

    /// An instant at which something starts: a date alone means its 00:00.
    pub(super) fn start(&self, text: &str) -> Result<Time, TimeError> {
        self.parse(text).map(|(time, _)| time)
    }

    /// An instant at which something ends: a date alone means the end of that day.
    pub(super) fn end(&self, text: &str) -> Result<Time, TimeError> {
        let (time, is_date) = self.parse(text)?;
        Ok(if is_date { time.plus_seconds(DAY_SECONDS) } else { time })
    }

    fn parse(&self, text: &str) -> Result<(Time, bool), TimeError> {
        let Some(format) = &self.format else {
            return parse_iso(text).map_err(|error| TimeError {
                expected: format!("{}; other forms need --date-format", error.expected),
                ..error
            });
        };
        if let Some(found) = format.parse(text.trim()) {
            return Ok(found);
        }
        let iso = format.iso_too.then(|| parse_iso(text).ok()).flatten();
        iso.ok_or_else(|| TimeError {
            text: text.trim().to_owned(),
            expected: format!("the format {:?}, no zone", format.text),
        })
    }
}

impl Format {
    fn new(text: &str) -> Result<Self, ReadError> {
        let error = |reason| ReadError::DateFormat { format: text.to_owned(), reason };
        for item in StrftimeItems::new(text) {
            match item {
                Item::Error => return Err(error("holds a pattern that does not exist")),
                Item::Fixed(
                    Fixed::TimezoneName
                    | Fixed::TimezoneOffset
                    | Fixed::TimezoneOffsetColon
                    | Fixed::TimezoneOffsetDoubleColon
                    | Fixed::TimezoneOffsetTripleColon
                    | Fixed::TimezoneOffsetColonZ
                    | Fixed::TimezoneOffsetZ
                    | Fixed::RFC2822
                    | Fixed::RFC3339,
                ) => return Err(error("asks for a time zone, and schedules have none")),
                _ => {}
            }
        }
        // A sample that is written and read back shows what the format can say.
        let date = NaiveDate::from_ymd_opt(2015, 12, 26).expect("a day of the calendar");
        let sample = date.and_hms_opt(13, 45, 0).expect("a time of day");
        let (mut with_time, mut at_midnight) = (String::new(), String::new());
        write!(with_time, "{}", sample.format(text))
            .and_then(|()| write!(at_midnight, "{}", date.and_time(NaiveTime::MIN).format(text)))
            .map_err(|_| error("cannot be written"))?;
        let has_time = with_time != at_midnight;
        if has_time && NaiveDateTime::parse_from_str(&with_time, text) != Ok(sample) {
            return Err(error("does not say date, hour and minute completely"));
        }
        if NaiveDate::parse_from_str(&with_time, text) != Ok(date) {
            return Err(error("does not say year, month and day"));
        }
        Ok(Self { text: text.to_owned(), has_time, iso_too: !text.trim().starts_with("%Y") })
    }

    fn parse(&self, text: &str) -> Option<(Time, bool)> {
        let (civil, is_date) = if self.has_time {
            (NaiveDateTime::parse_from_str(text, &self.text).ok()?, false)
        } else if let Ok(date) = NaiveDate::parse_from_str(text, &self.text) {
            (date.and_time(NaiveTime::MIN), true)
        } else {
            let with_time = |suffix: &str| {
                NaiveDateTime::parse_from_str(text, &format!("{}{suffix}", self.text)).ok()
            };
            let forms = [" %H:%M:%S", " %H:%M", "T%H:%M:%S", "T%H:%M"];
            (forms.into_iter().find_map(with_time)?, false)
        };
        // `%Y` takes the year 15 from 26-02-15; that file needs `%y`.
        (chrono::Datelike::year(&civil) >= 1000).then(|| (Time::from_civil(civil), is_date))
    }
}
