//! Which part of time an axis shows, and where its marks stand.

use chrono::{Datelike, Days, Duration, Months, NaiveDate, NaiveDateTime, NaiveTime};
use topout_schedule::{Time, TimeRange};

/// The shortest part that can be looked at, seconds.
const SHORTEST: f64 = 3600.0;

/// The part of time that an axis shows. Both ends are kept as fractions of seconds, so that zooming
/// in and out about a point leads back.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Scale {
    start: f64,
    seconds: f64,
}

impl Default for Scale {
    fn default() -> Self {
        Self::of(TimeRange::default())
    }
}

/// What the marks of one row count.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Unit {
    /// Minutes.
    Minutes(u32),
    /// Hours, dividing a day.
    Hours(u32),
    /// Days.
    Day,
    /// Weeks that begin on Mondays.
    Week,
    /// Months, dividing a year.
    Months(u32),
    /// Years.
    Years(u32),
}

/// Units from fine to coarse, the room in points that a label needs, and what stands above it.
const UNITS: [(Unit, f32, Option<Unit>); 16] = [
    (Unit::Minutes(10), 40.0, Some(Unit::Day)),
    (Unit::Hours(1), 40.0, Some(Unit::Day)),
    (Unit::Hours(3), 40.0, Some(Unit::Day)),
    (Unit::Hours(6), 40.0, Some(Unit::Day)),
    (Unit::Day, 22.0, Some(Unit::Months(1))),
    (Unit::Week, 26.0, Some(Unit::Months(1))),
    (Unit::Months(1), 32.0, Some(Unit::Years(1))),
    (Unit::Months(3), 32.0, Some(Unit::Years(1))),
    (Unit::Months(6), 32.0, Some(Unit::Years(1))),
    (Unit::Years(1), 36.0, None),
    (Unit::Years(2), 36.0, None),
    (Unit::Years(5), 36.0, None),
    (Unit::Years(10), 36.0, None),
    (Unit::Years(50), 36.0, None),
    (Unit::Years(100), 36.0, None),
    (Unit::Years(1000), 36.0, None),
];

/// A mark on an axis.
#[derive(Clone, PartialEq, Debug)]
pub struct Tick {
    /// Where.
    pub time: Time,
    /// What stands beside it.
    pub label: String,
}

/// The two rows of marks of an axis.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Ticks {
    /// Those close together.
    pub minor: Vec<Tick>,
    /// What the minor ones are parts of; begins with the one that the axis begins in.
    pub major: Vec<Tick>,
}

impl Scale {
    /// All of a period.
    pub fn of(period: TimeRange) -> Self {
        Self { start: period.start.seconds() as f64, seconds: (period.seconds() as f64).max(1.0) }
    }

    /// What it shows, in whole seconds.
    pub fn range(&self) -> TimeRange {
        let at = |seconds: f64| Time::from_seconds(seconds.round() as i64);
        TimeRange { start: at(self.start), end: at(self.start + self.seconds) }
    }

    /// Where an instant stands: 0 at the left end, 1 at the right one, other values beyond them.
    pub fn share(&self, time: Time) -> f64 {
        (time.seconds() as f64 - self.start) / self.seconds
    }

    /// The instant at a share.
    pub fn at(&self, share: f64) -> Time {
        Time::from_seconds((self.start + share * self.seconds).round() as i64)
    }

    /// Shows `factor` times as much time, with the instant at `share` where it is, within `period`.
    #[must_use]
    pub fn zoomed(&self, share: f64, factor: f64, period: TimeRange) -> Self {
        if !factor.is_finite() || factor <= 0.0 {
            return *self;
        }
        let whole = Self::of(period).seconds;
        let seconds = (self.seconds * factor).max(SHORTEST.min(whole)).min(whole);
        let start = self.start + share * (self.seconds - seconds);
        Self { start, seconds }.within(period)
    }

    /// Moved by a share of what is shown (positive: to later times), within `period`.
    #[must_use]
    pub fn panned(&self, share: f64, period: TimeRange) -> Self {
        Self { start: self.start + share * self.seconds, ..*self }.within(period)
    }

    /// The same length, moved so that it shows `time`, if it does not: a page on, as when playing.
    #[must_use]
    pub fn following(&self, time: Time, period: TimeRange) -> Self {
        let share = self.share(time);
        match (0.0..=1.0).contains(&share) {
            true => *self,
            false if share > 1.0 => self.panned(share - 0.05, period),
            false => self.panned(share - 0.95, period),
        }
    }

    /// Moved, and cut where it is longer, so that it lies in `period`.
    #[must_use]
    pub fn within(&self, period: TimeRange) -> Self {
        let whole = Self::of(period);
        let seconds = self.seconds.min(whole.seconds);
        let last = whole.start + whole.seconds - seconds;
        Self { start: self.start.max(whole.start).min(last), seconds }
    }

    /// Whether a day is at least so many points wide on an axis of `width` points.
    pub fn shows_days(&self, width: f32, points: f32) -> bool {
        f64::from(width) * 86_400.0 / self.seconds >= f64::from(points)
    }

    /// The marks of an axis that is `width` points wide: the finest unit whose labels have room.
    pub fn ticks(&self, width: f32) -> Ticks {
        let fits = |(unit, room, _): &&(Unit, f32, Option<Unit>)| {
            f64::from(width) * unit.seconds() / self.seconds >= f64::from(*room)
        };
        let Some((unit, _, above)) = UNITS.iter().find(fits) else { return Ticks::default() };
        let minor = self.marks(*unit, false);
        let major = above.map(|unit| self.marks(unit, true)).unwrap_or_default();
        Ticks { minor, major }
    }

    /// Marks of one unit. `above`: of the row that others are parts of, which begins before the axis does.
    fn marks(&self, unit: Unit, above: bool) -> Vec<Tick> {
        let range = self.range();
        let (Some(first), Some(last)) = (range.start.civil(), range.end.civil()) else {
            return Vec::new();
        };
        let mut marks = Vec::new();
        let mut at = unit.floor(first);
        if !above && at.is_some_and(|at| at < first) {
            at = at.and_then(|at| unit.next(at));
        }
        // Thinner than a point each: nobody asks for more.
        while let Some(civil) = at.filter(|at| *at <= last && marks.len() < 20_000) {
            marks.push(Tick { time: Time::from_civil(civil), label: unit.label(civil, above) });
            at = unit.next(civil);
        }
        marks
    }
}

impl Unit {
    /// About how long one is.
    fn seconds(self) -> f64 {
        match self {
            Self::Minutes(n) => 60.0 * f64::from(n),
            Self::Hours(n) => 3600.0 * f64::from(n),
            Self::Day => 86_400.0,
            Self::Week => 7.0 * 86_400.0,
            Self::Months(n) => 30.4 * 86_400.0 * f64::from(n),
            Self::Years(n) => 365.25 * 86_400.0 * f64::from(n),
        }
    }

    /// The start of the one that an instant lies in.
    fn floor(self, at: NaiveDateTime) -> Option<NaiveDateTime> {
        let day = at.date();
        let midnight = day.and_time(NaiveTime::MIN);
        let since = (at - midnight).num_seconds();
        let whole =
            |seconds: i64| midnight + Duration::seconds(since.div_euclid(seconds) * seconds);
        Some(match self {
            Self::Minutes(n) => whole(60 * i64::from(n)),
            Self::Hours(n) => whole(3600 * i64::from(n)),
            Self::Day => midnight,
            Self::Week => {
                let monday = Days::new(u64::from(day.weekday().num_days_from_monday()));
                day.checked_sub_days(monday)?.and_time(NaiveTime::MIN)
            }
            Self::Months(n) => {
                let month = day.month0() / n * n + 1;
                NaiveDate::from_ymd_opt(day.year(), month, 1)?.and_time(NaiveTime::MIN)
            }
            Self::Years(n) => {
                let n = i32::try_from(n).ok()?;
                let year = day.year().div_euclid(n) * n;
                NaiveDate::from_ymd_opt(year, 1, 1)?.and_time(NaiveTime::MIN)
            }
        })
    }

    /// The start of the next one.
    fn next(self, at: NaiveDateTime) -> Option<NaiveDateTime> {
        match self {
            Self::Minutes(n) => at.checked_add_signed(Duration::minutes(i64::from(n))),
            Self::Hours(n) => at.checked_add_signed(Duration::hours(i64::from(n))),
            Self::Day => at.checked_add_days(Days::new(1)),
            Self::Week => at.checked_add_days(Days::new(7)),
            Self::Months(n) => at.checked_add_months(Months::new(n)),
            Self::Years(n) => at.checked_add_months(Months::new(12 * n)),
        }
    }

    fn label(self, at: NaiveDateTime, above: bool) -> String {
        let format = match self {
            Self::Minutes(_) | Self::Hours(_) => "%H:%M",
            Self::Day if above => "%a %-d %b %Y",
            Self::Day | Self::Week => "%-d",
            Self::Months(_) if above => "%B %Y",
            Self::Months(_) => "%b",
            Self::Years(_) => "%Y",
        };
        at.format(format).to_string()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    fn time(text: &str) -> Time {
        Time::parse_iso(text).unwrap()
    }

    fn range(start: &str, end: &str) -> TimeRange {
        TimeRange { start: time(start), end: time(end) }
    }

    fn labels(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().map(|t| t.label.as_str()).collect()
    }

    #[test]
    fn marks_are_the_finest_that_have_room() {
        let months = Scale::of(range("2026-03-03", "2026-08-24")).ticks(250.0);
        assert_eq!(labels(&months.minor), ["Apr", "May", "Jun", "Jul", "Aug"]);
        assert_eq!(labels(&months.major), ["2026"]);
        let years = Scale::of(range("2026-03-03", "2036-08-24")).ticks(250.0);
        assert_eq!(labels(&years.minor), ["2028", "2030", "2032", "2034", "2036"]);
        assert!(years.major.is_empty());
        let days = Scale::of(range("2026-12-30", "2027-01-03")).ticks(100.0);
        assert_eq!(labels(&days.minor), ["30", "31", "1", "2", "3"]);
        assert_eq!(labels(&days.major), ["December 2026", "January 2027"]);
        let weeks = Scale::of(range("2026-12-30", "2027-01-30")).ticks(150.0);
        assert_eq!(labels(&weeks.minor), ["4", "11", "18", "25"], "Mondays");
        let hours = Scale::of(range("2026-12-30T05:00", "2026-12-30T13:00")).ticks(200.0);
        assert_eq!(labels(&hours.minor), ["06:00", "09:00", "12:00"]);
        assert_eq!(labels(&hours.major), ["Wed 30 Dec 2026"]);
    }

    #[test]
    fn an_axis_without_length_has_no_trouble() {
        for scale in [Scale::default(), Scale::of(range("2026-01-01", "2026-01-01"))] {
            assert!(scale.ticks(0.0).minor.len() < 1000);
            assert!(scale.ticks(1000.0).minor.len() < 1000);
            assert!(scale.share(time("2026-01-01")).is_finite());
        }
    }

    #[test]
    fn playing_turns_the_page() {
        let period = range("2026-01-01", "2027-01-01");
        let part = Scale::of(range("2026-01-01", "2026-02-01"));
        assert_eq!(part.following(time("2026-01-20"), period), part);
        let next = part.following(time("2026-02-03"), period);
        assert!(next.share(time("2026-02-03")) < 0.1 && next.share(time("2026-02-03")) > 0.0);
        let last = part.following(time("2026-12-31"), period).range();
        assert_eq!((last.end, last.seconds()), (period.end, part.range().seconds()));
    }

    proptest! {
        /// The instant under the cursor stays under it as long as the period's ends allow it; whatever is
        /// done the axis stays within the period.
        #[test]
        fn zooming_keeps_the_instant_under_the_cursor(
            days in 2i64..3000, share in 0.0f64..1.0, factors in prop::collection::vec(0.3f64..3.0, 1..12),
        ) {
            let start = time("2026-03-03T07:00");
            let period = TimeRange { start, end: start.plus_seconds(days * 86_400) };
            let mut scale = Scale::of(period);
            for factor in factors {
                let before = scale.start + share * scale.seconds;
                let next = scale.zoomed(share, factor, period);
                let held = next == Scale { start: before - share * next.seconds, ..next };
                let at_end = next.start == start.seconds() as f64
                    || next.start + next.seconds >= period.end.seconds() as f64 - 1e-3;
                prop_assert!(held || at_end || (next.start + share * next.seconds - before).abs() < 1e-2);
                prop_assert!(next.range().start >= period.start && next.range().end <= period.end);
                prop_assert!(next.seconds >= SHORTEST.min(period.seconds() as f64));
                scale = next.panned(factor - 1.0, period);
                prop_assert!(scale.range().start >= period.start && scale.range().end <= period.end);
            }
        }

        /// Marks lie on the axis in order, have room, and their labels come at the right instants.
        #[test]
        fn marks_have_room(start in -3_000_000_000i64..6_000_000_000, seconds in 1i64..400_000_000_000, width in 1f32..4000.0) {
            let start = Time::from_seconds(start);
            let scale = Scale::of(TimeRange { start, end: start.plus_seconds(seconds) });
            let ticks = scale.ticks(width);
            prop_assert!(ticks.minor.len() <= width as usize / 16 + 3, "{}", ticks.minor.len());
            prop_assert!(ticks.minor.windows(2).all(|t| t[0].time < t[1].time));
            prop_assert!(ticks.major.len() <= ticks.minor.len() + 1);
        }
    }
}
