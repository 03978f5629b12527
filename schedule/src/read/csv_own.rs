//! The tables that topout writes: everything a schedule holds, in rows of five sorts.
//!
//! The first column says what a row is. Cells are taken to the letter. What no cell can hold stands
//! as JSON in the column `data`; columns after that are fields.

use super::collected::{Collected, Texts};
use super::dates::DateReader;
use super::error::ReadError;
use super::json::predecessor;
use super::read_predecessor;
use super::table::{Header, Table};
use crate::{Activity, Calendar, Kind, Severity, WbsNode};
use serde_json::value::RawValue;
use std::sync::Arc;

/// The columns that come first, in this order.
pub(crate) const HEADINGS: [&str; 22] = [
    "topout",
    "id",
    "name",
    "start",
    "end",
    "kind",
    "active",
    "milestone",
    "percent_complete",
    "wbs",
    "calendar",
    "predecessors",
    "elements",
    "planned_start",
    "planned_end",
    "actual_start",
    "actual_end",
    "baseline_start",
    "baseline_end",
    "forecast_start",
    "forecast_end",
    "data",
];

/// The column of the first date of the sets.
const SETS: usize = 13;

/// Fields as `data` holds them.
type Pairs = Vec<(String, String)>;

/// What a project's row holds in `data`.
#[derive(Default, serde::Deserialize)]
#[serde(default)]
struct Project {
    data_date: Option<String>,
    calendar: Option<u32>,
    fields: Pairs,
}

/// Reads such a table.
pub(super) struct Own {
    dates: DateReader,
    fields: Vec<Arc<str>>,
    /// Summaries and calendars of the files before.
    outline: u32,
    calendars: u32,
}

impl Own {
    pub(super) fn is(header: &Header) -> bool {
        header.0.len() >= HEADINGS.len() && header.0.iter().zip(HEADINGS).all(|(a, b)| a == b)
    }

    pub(super) fn read(table: &mut Table, all: &mut Collected) -> Result<(), ReadError> {
        table.exact = true;
        let number = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        let own = Self {
            dates: DateReader::new(None)?,
            fields: table.header.0.iter().skip(HEADINGS.len()).map(|n| all.name(n)).collect(),
            outline: number(all.wbs.len()),
            calendars: number(all.calendars.len()),
        };
        while let Some(line) = table.next(all)? {
            match table.cell(Some(0)) {
                "activity" => own.activity(table, line, all),
                "project" => own.project(table, line, all),
                "calendar" => {
                    let calendar = own.json::<Calendar>(table, line, all).unwrap_or_default();
                    all.calendars.push(calendar);
                }
                "kind" => {
                    if let Some(kind) = own.json::<Kind>(table, line, all) {
                        all.define_kind(kind, all.line(line));
                    }
                }
                "wbs" => {
                    let [code, name] = [1, 2].map(|c| table.cell(Some(c)).to_owned());
                    let parent = own.number(table, 9, own.outline);
                    all.wbs.push(WbsNode { code, name, parent });
                }
                other => {
                    all.report(Severity::Warning, "unknown-row", other, all.line(line), || {
                        format!(
                            "a row is {other:?}, not activity, project, calendar, kind or wbs; left out"
                        )
                    })
                }
            }
        }
        all.end_schedule();
        Ok(())
    }

    /// What stands as JSON in `data`, if anything does.
    fn json<T: serde::de::DeserializeOwned>(
        &self,
        table: &Table,
        line: usize,
        all: &mut Collected,
    ) -> Option<T> {
        let text = table.cell(Some(HEADINGS.len() - 1));
        if text.is_empty() {
            return None;
        }
        let read = serde_json::from_str(text);
        read.map_err(|error| {
            let subject = table.cell(Some(1));
            all.report(Severity::Error, "wrong-type", subject, all.line(line), || {
                format!("data of {subject:?}: {error}")
            });
        })
        .ok()
    }

    /// A number of what this file counts; one that is too large exists nowhere, which is said later.
    fn number(&self, table: &Table, column: usize, base: u32) -> Option<u32> {
        let text = table.cell(Some(column));
        let number = || text.parse::<u32>().ok().and_then(|n| n.checked_add(base));
        (!text.is_empty()).then(|| number().unwrap_or(u32::MAX))
    }

    fn project(&self, table: &Table, line: usize, all: &mut Collected) {
        let place = all.line(line);
        all.name_project(table.cell(Some(2)));
        let mut date = |text: &str, what| {
            (!text.is_empty()).then(|| all.date(self.dates.start(text), what, "", place)).flatten()
        };
        let start = date(table.cell(Some(3)), "project start");
        let end = date(table.cell(Some(4)), "project end");
        all.extend_period(start, end);
        let data: Project = self.json(table, line, all).unwrap_or_default();
        let date = data.data_date.map(|t| all.date(self.dates.start(&t), "data date", "", place));
        all.data_date = all.data_date.max(date.flatten());
        all.calendar = all.calendar.or(data.calendar.map(|c| c.saturating_add(self.calendars)));
        for (name, value) in data.fields {
            let name = all.name(&name);
            all.fields.push((name, value.into()));
        }
    }

    fn activity(&self, table: &Table, line: usize, all: &mut Collected) {
        let place = all.line(line);
        let cell = |column: usize| table.cell(Some(column));
        let text = |column: usize| Some(cell(column)).filter(|c| !c.is_empty()).map(str::to_owned);
        let id = cell(1).to_owned();
        self.predecessors(cell(11), &id, line, all);
        let elements = match cell(12) {
            "" => Vec::new(),
            list if list.starts_with('[') => serde_json::from_str(list).unwrap_or_default(),
            list => list.split(';').map(str::to_owned).collect(),
        };
        let fields = match self.json::<Pairs>(table, line, all) {
            Some(pairs) => pairs.into_iter().map(|(n, v)| (all.name(&n), v.into())).collect(),
            None => {
                let cells = self.fields.iter().zip(HEADINGS.len()..);
                let given = cells.filter(|&(_, column)| !cell(column).is_empty());
                given.map(|(name, column)| (name.clone(), cell(column).into())).collect()
            }
        };
        let mut texts = Texts {
            start: text(3),
            end: text(4),
            kind: text(5),
            active: text(6),
            milestone: text(7),
            percent_complete: text(8),
            ..Texts::default()
        };
        for (i, date) in texts.sets.iter_mut().flatten().enumerate() {
            *date = text(SETS + i);
        }
        let activity = Activity {
            id,
            name: cell(2).to_owned(),
            wbs: self.number(table, 9, self.outline),
            calendar: self.number(table, 10, self.calendars),
            elements,
            fields,
            ..Activity::default()
        };
        all.push_texts(activity, texts, &self.dates, place);
    }

    /// What the next activity waits for: between semicolons, or as JSON.
    fn predecessors(&self, cell: &str, id: &str, line: usize, all: &mut Collected) {
        let successor = all.activities.len();
        if !cell.starts_with('[') {
            for (other, kind, lag) in cell.split(';').filter_map(read_predecessor) {
                let key = all.task_links.keys.of(other);
                all.task_links.add(successor, key, kind, lag);
            }
            return;
        }
        let list: Vec<&RawValue> = serde_json::from_str(cell).unwrap_or_default();
        for raw in list {
            match predecessor(raw) {
                Some((other, kind, lag)) => {
                    let key = all.task_links.keys.of(&other);
                    all.task_links.add(successor, key, kind, lag);
                }
                None => all.report(Severity::Error, "wrong-type", id, all.line(line), || {
                    format!("predecessors of {id:?}: {} is none", raw.get())
                }),
            }
        }
    }
}
