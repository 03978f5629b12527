//! Readers: schedule files become one [`Schedule`].
//!
//! Each file adds to a [`Collected`]; links wait there until every file is read, so the order of
//! the files does not matter to them.

mod csv;
mod dates;
mod error;
mod json;
mod links;
mod text;

pub use error::ReadError;
pub use json::FORMAT;

use crate::sources::{Place, Source, Sources};
use crate::{Activity, Diagnostics, Schedule, Severity, Time, TimeError};
use dates::DateReader;
use std::path::{Path, PathBuf};

/// How to read files that do not say it themselves.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Format of dates that are not ISO 8601, for example `%d-%m-%Y` or `%d.%m.%Y %H:%M`.
    pub date_format: Option<String>,
    /// Encoding of CSV files that are not UTF-8, for example `windows-1252`.
    pub encoding: Option<String>,
}

/// Reads and merges schedules (topout JSON, CSV) and links files (CSV), in any order.
///
/// Problems in single activities, links and dates become [`Schedule::diagnostics`], each with file
/// and line; the rest of the file counts. A file that says nothing usable is an error.
pub fn read_files(paths: &[PathBuf], options: &ReadOptions) -> Result<Schedule, ReadError> {
    let dates = DateReader::new(options.date_format.as_deref())?;
    let mut all = Collected::default();
    for path in paths {
        let bytes = text::read_bytes(path)?;
        let is_json = looks_like_json(path, &bytes);
        let encoding = options.encoding.as_deref().filter(|_| !is_json);
        let text = text::decode(path, &bytes, encoding)?;
        all.sources.files.push(path.display().to_string());
        if is_json {
            json::read(path, &text, &dates, &mut all)?;
        } else {
            csv::read(path, &text, &dates, &mut all)?;
        }
    }
    all.finish()
}

/// By its extension, else by its first character.
fn looks_like_json(path: &Path, bytes: &[u8]) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "json" => true,
        "csv" => false,
        _ => {
            let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
            matches!(bytes.trim_ascii_start().first(), Some(b'{' | b'['))
        }
    }
}

/// What the files said, before it is validated.
#[derive(Default)]
struct Collected {
    project: String,
    start: Option<Time>,
    end: Option<Time>,
    fields: Vec<(String, String)>,
    activities: Vec<Activity>,
    sources: Sources,
    links: links::Links,
    /// Schedules among the files (not links files) in which no activity stands.
    empty_files: Vec<usize>,
    diagnostics: Diagnostics,
}

impl Collected {
    /// Index of the file that is being read.
    fn current_file(&self) -> usize {
        self.sources.files.len().saturating_sub(1)
    }

    /// A line of the file that is being read.
    fn line(&self, line: usize) -> Place {
        Place::new(self.current_file(), line, 0)
    }

    /// Takes the value of a date; what is not one is reported and missing.
    fn date(
        &mut self,
        read: Result<Time, TimeError>,
        what: &str,
        id: &str,
        place: Place,
    ) -> Option<Time> {
        read.map_err(|error| {
            let subject = if id.is_empty() { what } else { id };
            self.diagnostics.add(Severity::Error, "bad-date", subject, || {
                let of = if id.is_empty() { String::new() } else { format!(" of {id:?}") };
                format!("{}: {what}{of}: {error}", self.sources.describe(place))
            });
        })
        .ok()
    }

    /// The project's dates: from the earliest start of all files to the latest end.
    fn extend_period(&mut self, start: Option<Time>, end: Option<Time>) {
        self.start = self.start.into_iter().chain(start).min();
        self.end = self.end.into_iter().chain(end).max();
    }

    /// Links, validates, and refuses what nothing can be made of.
    fn finish(mut self) -> Result<Schedule, ReadError> {
        links::attach(&mut self);
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
        let mut schedule = Schedule::validate(
            self.project,
            (self.start, self.end),
            self.activities,
            self.sources,
            self.diagnostics,
        );
        schedule.fields = self.fields;
        Ok(schedule)
    }
}

/// The words of `active`; `None` if it is none of them.
fn active_from_word(word: &str) -> Option<bool> {
    match word.to_ascii_lowercase().as_str() {
        "" | "true" | "1" | "yes" => Some(true),
        "false" | "0" | "no" => Some(false),
        _ => None,
    }
}

impl Collected {
    /// Adds an activity whose cells or values are texts; empty means not given.
    fn add_activity(&mut self, texts: Texts, dates: &DateReader, place: Place) {
        let Texts { id, name, start, end, kind, active, elements, fields, mut reported } = texts;
        let given = |text: Option<String>| text.filter(|t| !t.trim().is_empty());
        let mut date = |all: &mut Self, read: fn(&DateReader, &str) -> _, text, what| {
            let text: String = given(text)?;
            let found = all.date(read(dates, &text), what, &id, place);
            reported |= found.is_none();
            found
        };
        let start = date(self, DateReader::start, start, "start");
        let end = date(self, DateReader::end, end, "end");
        let kind = given(kind).map_or_else(Default::default, |word| {
            crate::ActivityKind::from_word(word.trim()).unwrap_or_else(|| {
                self.diagnostics.add(Severity::Warning, "unknown-kind", &id, || {
                    let place = self.sources.describe(place);
                    format!("{place}: kind {word:?} of {id:?} is unknown; taken as construct")
                });
                Default::default()
            })
        });
        let active = given(active).is_none_or(|word| {
            active_from_word(word.trim()).unwrap_or_else(|| {
                self.diagnostics.add(Severity::Warning, "unknown-active", &id, || {
                    let place = self.sources.describe(place);
                    format!("{place}: active {word:?} of {id:?} is neither true nor false; taken as true")
                });
                true
            })
        });
        self.activities.push(Activity { id, name, start, end, kind, active, elements, fields });
        let source = Source { place, dates_reported: reported, links: Vec::new() };
        self.sources.activities.push(source);
    }
}

/// An activity as a file writes it.
#[derive(Default)]
struct Texts {
    id: String,
    name: String,
    start: Option<String>,
    end: Option<String>,
    kind: Option<String>,
    active: Option<String>,
    elements: Vec<String>,
    fields: Vec<(String, String)>,
    /// Something was already said of its dates.
    reported: bool,
}
