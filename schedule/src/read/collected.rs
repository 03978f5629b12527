//! What the files said, before it is validated.

use super::ReadOptions;
use super::dates::DateReader;
use super::error::ReadError;
use super::links::{self, Links};
use super::tasklinks::TaskLinks;
use crate::sources::{Place, Source, Sources};
use crate::{
    Activity, ActivityKind, Calendar, Diagnostics, Fields, Kind, Kinds, Schedule, Severity, Time,
    TimeError, WbsNode,
};
use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;

/// Longer texts of fields are cut: nobody reads a megabyte beside a time line.
const MAX_FIELD: usize = 1 << 20;

#[derive(Default)]
pub(super) struct Collected {
    pub(super) project: String,
    start: Option<Time>,
    end: Option<Time>,
    pub(super) data_date: Option<Time>,
    pub(super) fields: Fields,
    pub(super) activities: Vec<Activity>,
    pub(super) wbs: Vec<WbsNode>,
    pub(super) calendars: Vec<Calendar>,
    pub(super) calendar: Option<u32>,
    pub(super) kinds: Kinds,
    /// Kinds that are not built in: of which activity. What they mean may stand after the activities.
    kind_words: Vec<(usize, Box<str>)>,
    pub(super) sources: Sources,
    pub(super) links: Links,
    /// Links between activities by their ids.
    pub(super) task_links: TaskLinks,
    /// Schedules among the files (not links files) in which no activity stands.
    empty_files: Vec<usize>,
    /// Activities before the file that is being read.
    before_file: usize,
    /// The file that is being read defines kinds, so it says something without activities.
    pub(super) kinds_in_file: bool,
    names: HashSet<Arc<str>>,
    pub(super) diagnostics: Diagnostics,
}

impl Collected {
    pub(super) fn begin_file(&mut self, path: &Path) {
        self.sources.files.push(path.display().to_string());
        self.before_file = self.activities.len();
        self.kinds_in_file = false;
    }

    /// Index of the first activity of the file that is being read.
    pub(super) fn before_file(&self) -> usize {
        self.before_file
    }

    /// A schedule was read; one without activities is reported.
    pub(super) fn end_schedule(&mut self) {
        if self.activities.len() == self.before_file && !self.kinds_in_file {
            self.empty_files.push(self.current_file());
        }
    }

    /// Index of the file that is being read.
    pub(super) fn current_file(&self) -> usize {
        self.sources.files.len().saturating_sub(1)
    }

    /// A line of the file that is being read.
    pub(super) fn line(&self, line: usize) -> Place {
        Place::new(self.current_file(), line, 0)
    }

    /// The place of the next activity of the file that is being read.
    pub(super) fn next_place(&self, line: usize) -> Place {
        Place::new(self.current_file(), line, self.activities.len() - self.before_file + 1)
    }

    /// A finding at a place.
    pub(super) fn report(
        &mut self,
        severity: Severity,
        code: &'static str,
        subject: &str,
        place: Place,
        message: impl FnOnce() -> String,
    ) {
        self.diagnostics.add(severity, code, subject, || {
            format!("{}: {}", self.sources.describe(place), message())
        });
    }

    /// A name of fields, once in memory however often it occurs.
    pub(super) fn name(&mut self, name: &str) -> Arc<str> {
        match self.names.get(name) {
            Some(known) => known.clone(),
            None => {
                let name: Arc<str> = name.into();
                self.names.insert(name.clone());
                name
            }
        }
    }

    /// A field's text, cut where it is longer than anybody reads.
    pub(super) fn field_text(&mut self, name: &str, text: &str, place: Place) -> Box<str> {
        if text.len() <= MAX_FIELD {
            return text.into();
        }
        let cut = text.floor_char_boundary(MAX_FIELD);
        self.report(Severity::Warning, "long-text", name, place, || {
            format!("the field {name:?} has {} bytes; it is cut to {cut}", text.len())
        });
        text[..cut].into()
    }

    /// Takes the value of a date; what is not one is reported and missing.
    pub(super) fn date(
        &mut self,
        read: Result<Time, TimeError>,
        what: &str,
        id: &str,
        place: Place,
    ) -> Option<Time> {
        read.map_err(|error| {
            let subject = if id.is_empty() { what } else { id };
            self.report(Severity::Error, "bad-date", subject, place, || {
                let of = if id.is_empty() { String::new() } else { format!(" of {id:?}") };
                format!("{what}{of}: {error}")
            });
        })
        .ok()
    }

    /// A date of a planner's program: ISO 8601; a zone is cut off, since programs mean the clock at
    /// the site by it. Empty texts are no date and fine.
    pub(super) fn civil_date(
        &mut self,
        text: &str,
        what: &str,
        id: &str,
        place: Place,
    ) -> Option<Time> {
        let text = text.trim();
        if text.is_empty() {
            return None;
        }
        let zone = text.get(11..).and_then(|time| time.find(['Z', '+', '-'])).map(|at| at + 11);
        if zone.is_some() {
            self.report(Severity::Info, "zone-ignored", id, place, || {
                format!("{what} of {id:?} is {text:?}; its zone is ignored")
            });
        }
        self.date(Time::parse_iso(&text[..zone.unwrap_or(text.len())]), what, id, place)
    }

    /// The project's dates: from the earliest start of all files to the latest end.
    pub(super) fn extend_period(&mut self, start: Option<Time>, end: Option<Time>) {
        self.start = self.start.into_iter().chain(start).min();
        self.end = self.end.into_iter().chain(end).max();
    }

    /// The first project that has a name gives it.
    pub(super) fn name_project(&mut self, name: &str) {
        if self.project.is_empty() {
            self.project = name.to_owned();
        }
    }

    /// Takes an activity over. `dates_reported`: something was already said of its dates.
    pub(super) fn push(&mut self, activity: Activity, place: Place, dates_reported: bool) {
        self.activities.push(activity);
        self.sources.activities.push(Source { place, dates_reported, links: Vec::new() });
    }

    /// Defines a kind.
    pub(super) fn define_kind(&mut self, kind: Kind, place: Place) {
        let name = kind.name.clone();
        if let Err(reason) = self.kinds.define(kind) {
            self.report(Severity::Error, "bad-kind", &name, place, || reason);
        }
    }

    /// Gives activities their kinds, now that all are known: by their words, else by a field.
    fn find_kinds(&mut self, field: Option<&str>) {
        let mut by_field = Vec::new();
        if let Some(field) = field {
            for (i, activity) in self.activities.iter().enumerate() {
                let value =
                    activity.fields.iter().find(|(n, _)| n.trim().eq_ignore_ascii_case(field));
                if let Some((_, word)) = value.filter(|(_, word)| !word.trim().is_empty()) {
                    by_field.push((i, word.trim().into()));
                }
            }
            if by_field.is_empty() {
                self.diagnostics.add(Severity::Warning, "no-kinds", field, || {
                    format!("no activity has a field {field:?} that could say its kind")
                });
            }
        }
        for (i, word) in std::mem::take(&mut self.kind_words).into_iter().chain(by_field) {
            let id = self.activities[i].id.clone();
            match self.kinds.find(&word) {
                Some(kind) => self.activities[i].kind = kind,
                None => {
                    let place = self.sources.activities[i].place;
                    self.report(Severity::Warning, "unknown-kind", &id, place, || {
                        format!("kind {word:?} of {id:?} is unknown; taken as construct")
                    });
                }
            }
        }
    }

    /// Links, validates, and refuses what nothing can be made of.
    pub(super) fn finish(mut self, options: &ReadOptions) -> Result<Schedule, ReadError> {
        self.find_kinds(options.kind_field.as_deref().map(str::trim));
        links::attach(&mut self);
        TaskLinks::attach(&mut self);
        for &file in &self.empty_files {
            let name = &self.sources.files[file];
            self.diagnostics.add(Severity::Error, "empty-schedule", name, || {
                format!("{name}: there is no activity in it")
            });
        }
        if let Some(name) = self.sources.files.first()
            && self.activities.is_empty()
            && self.empty_files.is_empty()
        {
            self.diagnostics.add(Severity::Error, "empty-schedule", name, || {
                format!("{name}: there are links, but no schedule with the activities")
            });
        }
        if let Some(bad) = self.diagnostics.get("bad-date")
            && self.activities.iter().all(|a| a.dates().is_none())
            && self.sources.activities.iter().any(|s| s.dates_reported)
        {
            return Err(ReadError::NoReadableDates { first: bad.message.clone() });
        }
        // What grew while reading is kept for long.
        self.activities.shrink_to_fit();
        self.sources.activities.shrink_to_fit();
        let schedule = Schedule {
            project: self.project,
            data_date: self.data_date,
            activities: self.activities,
            wbs: self.wbs,
            calendars: self.calendars,
            calendar: self.calendar,
            kinds: self.kinds,
            fields: self.fields,
            diagnostics: self.diagnostics,
            sources: self.sources,
            ..Schedule::default()
        };
        Ok(schedule.validated((self.start, self.end)))
    }
}

/// An activity as a file writes it, where it writes texts.
#[derive(Default)]
pub(super) struct Texts {
    pub(super) start: Option<String>,
    pub(super) end: Option<String>,
    /// Starts and ends of the date sets.
    pub(super) sets: [[Option<String>; 2]; 4],
    pub(super) kind: Option<String>,
    pub(super) active: Option<String>,
    pub(super) milestone: Option<String>,
    pub(super) percent_complete: Option<String>,
    /// `start` and `end` are not there at all, so those that count follow from the sets.
    pub(super) choose: bool,
    /// Something was already said of its dates.
    pub(super) reported: bool,
}

impl Collected {
    /// Completes an activity by what is written as texts, of which empty ones are not given, and
    /// takes it over.
    pub(super) fn push_texts(
        &mut self,
        mut activity: Activity,
        texts: Texts,
        dates: &DateReader,
        place: Place,
    ) {
        let given = |text: Option<String>| text.filter(|t| !t.trim().is_empty());
        let id = std::mem::take(&mut activity.id);
        let mut reported = texts.reported;
        let mut date = |all: &mut Self, read: fn(&DateReader, &str) -> _, text, what: &str| {
            let text: String = given(text)?;
            let found = all.date(read(dates, &text), what, &id, place);
            reported |= found.is_none();
            found
        };
        activity.start = date(self, DateReader::start, texts.start, "start");
        activity.end = date(self, DateReader::end, texts.end, "end");
        for ((name, set), [start, end]) in crate::DateSet::WORDS.into_iter().zip(texts.sets) {
            if start.is_some() {
                let what = format!("{name} start");
                activity.date_sets[set].start = date(self, DateReader::start, start, &what);
            }
            if end.is_some() {
                let what = format!("{name} end");
                activity.date_sets[set].end = date(self, DateReader::end, end, &what);
            }
        }
        if let Some(word) = given(texts.kind) {
            match ActivityKind::from_word(word.trim()) {
                Some(kind) => activity.kind = kind,
                None => self.kind_words.push((self.activities.len(), word.trim().into())),
            }
        }
        if let Some(word) = given(texts.active) {
            activity.active = truth(word.trim()).unwrap_or_else(|| {
                self.report(Severity::Warning, "unknown-active", &id, place, || {
                    format!("active {word:?} of {id:?} is neither true nor false; taken as true")
                });
                true
            });
        }
        if let Some(word) = given(texts.milestone) {
            activity.milestone = truth(word.trim()).unwrap_or_else(|| {
                self.report(Severity::Warning, "unknown-milestone", &id, place, || {
                    format!(
                        "milestone {word:?} of {id:?} is neither true nor false; taken as false"
                    )
                });
                false
            });
        }
        if let Some(text) = given(texts.percent_complete) {
            activity.percent_complete = self.percent(&text, &id, place);
        }
        activity.id = id;
        if texts.choose {
            activity.choose_dates();
        }
        self.push(activity, place, reported);
    }

    /// Reads how much is done, from 0 to 100.
    pub(super) fn percent(&mut self, text: &str, id: &str, place: Place) -> Option<f32> {
        let number = text.trim().trim_end_matches('%').trim_end();
        let percent = number.parse().ok().filter(|p| (0.0..=100.0).contains(p));
        if percent.is_none() {
            self.report(Severity::Warning, "bad-percent", id, place, || {
                format!("percent complete of {id:?} is {text:?}, not a number from 0 to 100")
            });
        }
        percent
    }
}

/// The words for true and false; `None` if it is none of them.
pub(super) fn truth(word: &str) -> Option<bool> {
    match word.to_ascii_lowercase().as_str() {
        "" | "true" | "1" | "yes" | "y" => Some(true),
        "false" | "0" | "no" | "n" => Some(false),
        _ => None,
    }
}
