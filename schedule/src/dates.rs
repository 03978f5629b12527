//! The sets of dates that planners keep of one activity.

use crate::{Activity, Schedule, Severity, Time};
use std::ops::{Index, IndexMut};

/// Which dates of an activity are meant.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum DateSet {
    /// As scheduled.
    Planned,
    /// As it happened.
    Actual,
    /// As once agreed.
    Baseline,
    /// As now expected (P6 and IFC: early dates).
    Forecast,
}

impl DateSet {
    /// All sets, with the words that schedules use.
    pub const WORDS: [(&'static str, DateSet); 4] = [
        ("planned", DateSet::Planned),
        ("actual", DateSet::Actual),
        ("baseline", DateSet::Baseline),
        ("forecast", DateSet::Forecast),
    ];

    /// The set that a word in a schedule means, in whatever case.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(w, _)| w.eq_ignore_ascii_case(word)).map(|&(_, set)| set)
    }

    /// The word that schedules use.
    pub fn word(self) -> &'static str {
        Self::WORDS[self as usize].0
    }
}

/// A start and an end, either of which may be unknown.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Dates {
    /// First instant.
    pub start: Option<Time>,
    /// First instant after it.
    pub end: Option<Time>,
}

impl Dates {
    /// Seconds from start to end, if both are known and in order.
    pub fn seconds(&self) -> Option<i64> {
        let seconds = self.end?.seconds().checked_sub(self.start?.seconds())?;
        (seconds >= 0).then_some(seconds)
    }
}

/// The dates of one activity by [`DateSet`]; sets that a file does not have are empty.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct DateSets([Dates; 4]);

impl Index<DateSet> for DateSets {
    type Output = Dates;

    fn index(&self, set: DateSet) -> &Dates {
        &self.0[set as usize]
    }
}

impl IndexMut<DateSet> for DateSets {
    fn index_mut(&mut self, set: DateSet) -> &mut Dates {
        &mut self.0[set as usize]
    }
}

impl DateSets {
    /// Whether no set has a date.
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(|dates| *dates == Dates::default())
    }

    /// The dates that count where a file does not say it: actual, else planned, else forecast, for
    /// start and end apart. Of what has begun the forecast's end goes before the planned one. If
    /// that end is past already, it takes as long as planned from its actual start.
    pub fn chosen(&self) -> Dates {
        let [planned, actual, _, forecast] = self.0;
        let begun = actual.start.is_some();
        let (first, second) = if begun { (forecast, planned) } else { (planned, forecast) };
        let start = actual.start.or(planned.start).or(forecast.start);
        let mut end = actual.end.or(first.end).or(second.end);
        if begun
            && actual.end.is_none()
            && end < start
            && let (Some(start), Some(seconds)) = (start, planned.seconds())
        {
            end = Some(start.plus_seconds(seconds));
        }
        Dates { start, end }
    }
}

impl Activity {
    /// Its dates in a set. Of an activity that has no sets at all, as in plain tables, the dates that
    /// count are the planned ones. A milestone needs but one of the two.
    pub fn dates_of(&self, set: DateSet) -> Dates {
        let Dates { start, end } = match set == DateSet::Planned && self.date_sets.is_empty() {
            true => Dates { start: self.start, end: self.end },
            false => self.date_sets[set],
        };
        match self.milestone {
            true => Dates { start: start.or(end), end: end.or(start) },
            false => Dates { start, end },
        }
    }
}

impl Schedule {
    /// The same schedule by one set of dates: those of [`Activity::dates_of`] count and no others.
    ///
    /// Activities that have none, or one alone, stay without; they are reported as `no-dates-in-set`,
    /// and that no activity has any as an error, `no-such-dates`. The period grows as needed, so that
    /// pictures by several sets show one and the same span.
    pub fn show(mut self, set: DateSet) -> Schedule {
        let word = set.word();
        let mut known = 0;
        for (i, activity) in self.activities.iter_mut().enumerate() {
            let dates = activity.dates_of(set);
            // What counted may be all that is known of the plan.
            if activity.date_sets.is_empty() {
                let (start, end) = (activity.start, activity.end);
                activity.date_sets[DateSet::Planned] = Dates { start, end };
            }
            (activity.start, activity.end) = (dates.start, dates.end);
            known += usize::from(dates != Dates::default());
            let id = &activity.id;
            if let Some(range) = activity.dates() {
                self.period.start = self.period.start.min(range.start);
                self.period.end = self.period.end.max(range.end);
                continue;
            }
            let says = match dates {
                Dates { start: Some(start), end: Some(end) } => {
                    format!("ends {end} before its start {start}")
                }
                Dates { start: Some(_), .. } => "has no end".to_owned(),
                Dates { end: Some(_), .. } => "has no start".to_owned(),
                _ => "has no dates".to_owned(),
            };
            let place = self.sources.of_activity(i);
            self.diagnostics.add(Severity::Warning, "no-dates-in-set", id, || {
                format!("{place}: activity {id:?} {says} as {word}; ignored")
            });
        }
        if known == 0 && !self.activities.is_empty() {
            let file = self.sources.files.first().map_or("the schedule", String::as_str);
            self.diagnostics.add(Severity::Error, "no-such-dates", word, || {
                format!("{file}: no activity has {word} dates")
            });
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dates(start: i64, end: i64) -> Dates {
        let time = |t| (t >= 0).then(|| Time::from_seconds(t));
        Dates { start: time(start), end: time(end) }
    }

    #[test]
    fn what_counts() {
        let of =
            |planned, actual, forecast| DateSets([planned, actual, dates(1, 2), forecast]).chosen();
        let none = dates(-1, -1);
        assert_eq!(of(dates(10, 20), none, none), dates(10, 20));
        assert_eq!(of(dates(10, 20), none, dates(12, 22)), dates(10, 20));
        assert_eq!(of(dates(10, 20), dates(11, 19), dates(12, 22)), dates(11, 19));
        // Begun: what is expected now goes before what was planned.
        assert_eq!(of(dates(10, 20), dates(11, -1), dates(12, 22)), dates(11, 22));
        assert_eq!(of(dates(10, 20), dates(11, -1), none), dates(11, 20));
        // Begun after the planned end: as long as planned.
        assert_eq!(of(dates(10, 20), dates(25, -1), none), dates(25, 35));
        assert_eq!(of(dates(10, -1), none, dates(12, 22)), dates(10, 22));
        assert_eq!(of(none, none, none), none);
    }
}
