//! Months of the calendar.

use chrono::{Datelike, NaiveDate};
use topout_schedule::{Time, TimeRange};

/// Most spans of a page; of a longer project each is of several months.
pub(super) const MOST: usize = 120;
/// More months than projects have: a schedule of thousands of years is a mistake of its dates.
const LONGEST: usize = 12 * 400;

/// A month, or a few, within a period.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Month {
    /// From its first day, or the period's start, to the next month's, or the period's end.
    pub range: TimeRange,
    /// `March 2026`, `March to May 2026`.
    pub name: String,
}

/// The first instants of the months that begin within a period.
pub(super) fn starts(period: TimeRange) -> Vec<Time> {
    let Some(civil) = period.start.civil() else { return Vec::new() };
    let (mut year, mut month) = (civil.year(), civil.month());
    let mut starts = Vec::new();
    while starts.len() < LONGEST {
        let first = NaiveDate::from_ymd_opt(year, month, 1).and_then(|d| d.and_hms_opt(0, 0, 0));
        let Some(time) = first.map(Time::from_civil).filter(|t| *t < period.end) else { break };
        if time >= period.start {
            starts.push(time);
        }
        (year, month) = if month == 12 { (year + 1, 1) } else { (year, month + 1) };
    }
    starts
}

/// The months of a period, joined where there are more than [`MOST`]. At least one, also of a period that
/// is empty.
pub(super) fn months(period: TimeRange) -> Vec<Month> {
    let mut bounds = vec![period.start];
    bounds.extend(starts(period).into_iter().filter(|t| *t > period.start));
    let step = bounds.len().div_ceil(MOST);
    let last = bounds.len() - 1;
    let firsts: Vec<usize> = (0..bounds.len()).step_by(step).collect();
    let span = |&first: &usize| {
        let next = first + step;
        let end = bounds.get(next).copied().unwrap_or(period.end);
        let names = [bounds[first], bounds[(next - 1).min(last)]].map(Time::civil);
        let name = match names {
            [Some(from), Some(to)] if (from.year(), from.month()) == (to.year(), to.month()) => {
                from.format("%B %Y").to_string()
            }
            [Some(from), Some(to)] if from.year() == to.year() => {
                format!("{} to {}", from.format("%B"), to.format("%B %Y"))
            }
            [Some(from), Some(to)] => format!("{} to {}", from.format("%B %Y"), to.format("%B %Y")),
            _ => bounds[first].to_string(),
        };
        Month { range: TimeRange { start: bounds[first], end }, name }
    };
    firsts.iter().map(span).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn period(from: &str, to: &str) -> TimeRange {
        TimeRange { start: Time::parse_iso(from).unwrap(), end: Time::parse_iso(to).unwrap() }
    }

    fn list(from: &str, to: &str) -> Vec<String> {
        let line = |m: Month| format!("{} {} {}", m.range.start, m.range.end, m.name);
        months(period(from, to)).into_iter().map(line).collect()
    }

    #[test]
    fn a_period_is_cut_at_first_days() {
        assert_eq!(
            list("2026-11-20T08:00", "2027-01-05"),
            [
                "2026-11-20T08:00:00 2026-12-01T00:00:00 November 2026",
                "2026-12-01T00:00:00 2027-01-01T00:00:00 December 2026",
                "2027-01-01T00:00:00 2027-01-05T00:00:00 January 2027",
            ]
        );
        let one = ["2026-03-01T00:00:00 2026-04-01T00:00:00 March 2026"];
        assert_eq!(list("2026-03-01", "2026-04-01"), one);
        assert_eq!(list("2026-03-01", "2026-03-01").len(), 1);
    }

    #[test]
    fn long_periods_have_longer_spans() {
        let spans = months(period("2000-01-01", "2030-01-01"));
        assert_eq!(spans.len(), 120);
        assert_eq!(spans[0].name, "January to March 2000");
        assert_eq!(spans[119].range.end, Time::parse_iso("2030-01-01").unwrap());
        let endless = months(period("0001-01-01", "9000-01-01"));
        assert!(endless.len() <= MOST, "{}", endless.len());
        assert_eq!(endless.last().unwrap().range.end, Time::parse_iso("9000-01-01").unwrap());
    }
}
