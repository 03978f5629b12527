//! Calendars of Microsoft Project's XML.

use super::collected::{Collected, truth};
use super::xml::Xml;
use crate::calendar::seconds_of_day;
use crate::{Calendar, CalendarException, Severity, Shift};
use chrono::NaiveDate;
use std::collections::HashMap;

/// Calendars may be derived from others so many times.
const MAX_BASES: usize = 8;

/// The calendars of one file.
#[derive(Default)]
pub(super) struct Calendars {
    /// UID of the project's calendar.
    pub(super) default: Box<str>,
    /// Calendars of the files before.
    before: usize,
    numbers: HashMap<Box<str>, usize>,
    calendars: Vec<Draft>,
    draft: Draft,
    day: Day,
    from_time: Option<u32>,
    /// Names of calendars with days that follow no rule that is read.
    unread: Vec<String>,
}

#[derive(Default)]
struct Draft {
    uid: String,
    name: String,
    base: String,
    week: [Option<Vec<Shift>>; 7],
    /// As versions before 2007 write them, and others beside `exceptions`.
    old_exceptions: Vec<CalendarException>,
    exceptions: Vec<CalendarException>,
}

/// A weekday or an exception that is being read.
#[derive(Default)]
struct Day {
    /// 1 is Sunday, 0 an exception.
    kind: u32,
    working: bool,
    first: Option<NaiveDate>,
    last: Option<NaiveDate>,
    shifts: Vec<Shift>,
    /// How an exception recurs; 1 is day by day.
    recurrence: u32,
}

impl Day {
    fn exception(&mut self) -> Option<CalendarException> {
        let (first, last) = (self.first?, self.last.or(self.first)?);
        (first <= last).then(|| CalendarException { first, last, shifts: self.hours() })
    }

    /// The hours of a working day; those of any day if none are given.
    fn hours(&mut self) -> Vec<Shift> {
        let mut shifts = std::mem::take(&mut self.shifts);
        if self.working && shifts.is_empty() {
            let usual = [(8, 12), (13, 17)].map(|(a, b)| Shift::new(a * 3600, b * 3600));
            shifts.extend(usual.into_iter().flatten());
        }
        if self.working { shifts } else { Vec::new() }
    }
}

impl Calendars {
    pub(super) fn new(all: &Collected) -> Self {
        Self { before: all.calendars.len(), ..Self::default() }
    }

    /// The calendar with a UID.
    pub(super) fn number(&self, uid: &str) -> Option<u32> {
        let number = self.before + self.numbers.get(uid.trim())?;
        u32::try_from(number).ok()
    }

    pub(super) fn open(&mut self, xml: &Xml) {
        match (xml.name(), xml.parent()) {
            (b"Calendar", b"Calendars") => self.draft = Draft::default(),
            (b"WeekDay", _) | (b"Exception", b"Exceptions") => {
                self.day = Day { recurrence: 1, ..Day::default() };
            }
            _ => {}
        }
    }

    pub(super) fn close(&mut self, xml: &Xml, all: &mut Collected) {
        let text = xml.text().trim();
        let day = || text.get(..10).and_then(|t| t.parse().ok());
        match (xml.parent(), xml.name()) {
            (b"Calendar", b"UID") => text.clone_into(&mut self.draft.uid),
            (b"Calendar", b"Name") => xml.text().clone_into(&mut self.draft.name),
            (b"Calendar", b"BaseCalendarUID") => text.clone_into(&mut self.draft.base),
            (b"WeekDay", b"DayType") => self.day.kind = text.parse().unwrap_or(u32::MAX),
            (b"WeekDay" | b"Exception", b"DayWorking") => {
                self.day.working = truth(text).unwrap_or(false);
            }
            (b"Exception", b"Type") => self.day.recurrence = text.parse().unwrap_or_default(),
            (b"TimePeriod", b"FromDate") => self.day.first = day(),
            (b"TimePeriod", b"ToDate") => self.day.last = day(),
            (b"WorkingTime", b"FromTime") => self.from_time = seconds_of_day(text),
            (b"WorkingTime", b"ToTime") => {
                let end = seconds_of_day(text).map(|end| if end == 0 { 86_400 } else { end });
                let shift = self.from_time.take().zip(end).and_then(|(a, b)| Shift::new(a, b));
                self.day.shifts.extend(shift);
            }
            (b"WeekDays", b"WeekDay") if xml.ancestor(2) == b"Calendar" => self.weekday(),
            (b"WorkWeeks", b"WorkWeek") => self.unread.push(self.draft.name.clone()),
            (b"Exceptions", b"Exception") => {
                let exception = self.day.exception();
                match self.day.recurrence {
                    0 | 1 => self.draft.exceptions.extend(exception),
                    _ => self.unread.push(self.draft.name.clone()),
                }
            }
            (b"Calendars", b"Calendar") => {
                let draft = std::mem::take(&mut self.draft);
                self.numbers.insert(draft.uid.as_str().into(), self.calendars.len());
                self.calendars.push(draft);
            }
            _ => return,
        }
        for name in self.unread.drain(..) {
            all.report(Severity::Info, "calendar-rule", &name, all.line(xml.line()), || {
                format!(
                    "the calendar {name:?} has weeks or recurring days that are not read; its \
                     usual hours are kept there"
                )
            });
        }
    }

    fn weekday(&mut self) {
        match self.day.kind {
            0 => self.draft.old_exceptions.extend(self.day.exception()),
            // From Sunday = 1 to Monday = 0.
            kind @ 1..=7 => self.draft.week[(kind as usize + 5) % 7] = Some(self.day.hours()),
            _ => {}
        }
    }

    /// Hands the calendars over, each with what it has from those that it is derived from.
    pub(super) fn finish(self, all: &mut Collected) {
        for draft in &self.calendars {
            let mut calendar = Calendar { name: draft.name.clone(), ..Calendar::default() };
            let mut week: [Option<&Vec<Shift>>; 7] = [None; 7];
            let mut from = Some(draft);
            for _ in 0..=MAX_BASES {
                let Some(draft) = from else { break };
                for (hours, given) in week.iter_mut().zip(&draft.week) {
                    *hours = hours.or(given.as_ref());
                }
                let newer = !draft.exceptions.is_empty();
                let own = if newer { &draft.exceptions } else { &draft.old_exceptions };
                // Those of the calendar itself come last and count.
                calendar.exceptions.splice(0..0, own.iter().cloned());
                from = self.numbers.get(draft.base.as_str()).map(|&n| &self.calendars[n]);
            }
            calendar.week = week.map(|hours| hours.cloned().unwrap_or_default());
            all.calendars.push(calendar);
        }
        all.calendar = all.calendar.or(self.number(&self.default));
    }
}
