//! Event logs: tables with a row for each element of each task, as process mining takes them.
//!
//! Rows with the same task become one activity. What its rows agree on becomes a field of the
//! activity, what differs a value an element.

use super::collected::{Collected, Texts};
use super::dates::DateReader;
use super::error::ReadError;
use super::table::{Header, Table};
use crate::sources::Place;
use crate::{Activity, ElementField, Severity};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Columns that are kept beside those that are understood; office programs stop at 256 in all.
const MAX_COLUMNS: usize = 250;

/// Values of single elements that are kept of one file: a million rows that differ in 32 columns.
/// They take half a gigabyte.
const MAX_VALUES: usize = 32 << 20;

/// Headings without case and signs, of which the first that occurs counts.
const ELEMENT: [&str; 9] = [
    "guid",
    "ifcguid",
    "globalid",
    "elementguid",
    "elementid",
    "element",
    "objectguid",
    "caseid",
    "caseconceptname",
];
const TASK: [&str; 5] = ["taskid", "activityid", "taskcode", "activitycode", "task"];
const NAME: [&str; 6] =
    ["taskname", "activityname", "activity", "conceptname", "activitydescription", "name"];
const START: [&str; 7] = [
    "taskstart",
    "activitystart",
    "start",
    "starttime",
    "starttimestamp",
    "startdate",
    "taskstartdate",
];
const END: [&str; 10] = [
    "taskfinish",
    "taskend",
    "activityfinish",
    "activityend",
    "end",
    "finish",
    "endtime",
    "enddate",
    "finishdate",
    "completetimestamp",
];

/// Where a log's columns stand.
pub(super) struct Columns {
    element: usize,
    task: Option<usize>,
    name: Option<usize>,
    start: usize,
    end: usize,
    /// All others, with their names.
    others: Vec<(usize, Arc<str>)>,
    /// Others that are too many.
    left_out: usize,
}

impl Columns {
    /// `None` where the table is not an event log: one needs an element, a task, start and end. A
    /// table with a schedule's own headings is a schedule, whatever else it has.
    pub(super) fn find(header: &Header, all: &mut Collected) -> Option<Self> {
        let own = [&["id", "activity_id"][..], &["name"], &["start"], &["end", "finish"]];
        if own.iter().all(|names| header.position(names).is_some()) {
            return None;
        }
        let plain: Vec<String> = (header.0.iter())
            .map(|name| {
                name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
            })
            .collect();
        let position =
            |names: &[&str]| names.iter().find_map(|name| plain.iter().position(|p| p == name));
        let (element, task, name) = (position(&ELEMENT)?, position(&TASK), position(&NAME));
        let (start, end) = (position(&START)?, position(&END)?);
        task.or(name)?;
        let known = [Some(element), task, name, Some(start), Some(end)];
        let others = (0..header.0.len())
            .filter(|&at| !known.contains(&Some(at)) && !header.0[at].is_empty())
            .collect::<Vec<_>>();
        let left_out = others.len().saturating_sub(MAX_COLUMNS);
        let others = others.into_iter().take(MAX_COLUMNS);
        let others = others.map(|at| (at, all.name(&header.0[at]))).collect();
        Some(Self { element, task, name, start, end, others, left_out })
    }

    /// The columns that hold dates.
    pub(super) fn dates(&self) -> [usize; 2] {
        [self.start, self.end]
    }

    /// Whether tasks have names, which links files have not.
    pub(super) fn has_names(&self) -> bool {
        self.name.is_some()
    }
}

/// What the rows of a task are recognised by: its id, else name, start and end as written.
#[derive(PartialEq, Eq, Hash, Clone)]
enum Key {
    Id(Box<str>),
    Dates([Box<str>; 3]),
}

/// The rows of one task.
struct Task {
    id: String,
    name: String,
    dates: [String; 2],
    elements: Vec<String>,
    /// A place an element.
    places: Vec<Place>,
    /// Other columns by number, those that are empty in all rows left out.
    cells: Vec<(usize, Cells)>,
}

/// What one column says in the rows of a task.
enum Cells {
    /// The same in the first so many rows.
    Same(Arc<str>, usize),
    /// One value a row; those of the last rows may be missing and are empty.
    Each(Vec<Arc<str>>),
}

impl Cells {
    /// Adds the value of a row, by its number. Returns how many values more are kept.
    fn set(&mut self, row: usize, value: Arc<str>) -> usize {
        match self {
            Self::Same(known, rows) if *rows == row && *known == value => {
                *rows += 1;
                0
            }
            Self::Same(..) => {
                let mut values = self.take(row);
                values.push(value);
                *self = Self::Each(values);
                row + 1
            }
            Self::Each(values) => {
                let before = values.len();
                values.resize(row, Arc::from(""));
                values.push(value);
                values.len() - before
            }
        }
    }

    /// One value for each of so many rows.
    fn take(&mut self, rows: usize) -> Vec<Arc<str>> {
        let mut values = match self {
            Self::Same(value, same) => vec![value.clone(); *same],
            Self::Each(values) => std::mem::take(values),
        };
        values.resize(rows, Arc::from(""));
        values
    }
}

/// Reads one event log into `all`, an activity a task, in the order of their first rows.
pub(super) fn read(
    file: &Path,
    table: &mut Table,
    columns: &Columns,
    dates: &DateReader,
    all: &mut Collected,
) -> Result<(), ReadError> {
    let mut log = Log::default();
    let mut rows = 0;
    while let Some(line) = table.next(all)? {
        rows += 1;
        log.row(table, columns, all.line(line), all);
        if log.values > MAX_VALUES {
            let reason = format!(
                "more than {MAX_VALUES} values of single elements, which no event log has; the \
                 columns that differ from row to row are too many"
            );
            return Err(ReadError::Malformed { file: file.to_owned(), line, reason });
        }
    }
    let (name, tasks) = (file.display().to_string(), log.tasks.len());
    all.report(Severity::Info, "event-log", &name, all.line(1), || {
        let heading = |at: Option<usize>| at.map(|at| &table.header.0[at]).unwrap_or_default();
        format!(
            "an event log: {rows} rows of {tasks} tasks; elements are in {:?}, tasks in {:?}, \
             their dates in {:?} and {:?}",
            heading(Some(columns.element)),
            heading(columns.task.or(columns.name)),
            heading(Some(columns.start)),
            heading(Some(columns.end)),
        )
    });
    if columns.left_out > 0 {
        all.report(Severity::Warning, "lost-columns", &name, all.line(1), || {
            format!("{} columns beyond {MAX_COLUMNS} are left out", columns.left_out)
        });
    }
    log.finish(columns, dates, all);
    all.end_schedule();
    Ok(())
}

#[derive(Default)]
struct Log {
    tasks: Vec<Task>,
    places: HashMap<Key, usize>,
    /// Values of single elements that are kept.
    values: usize,
}

impl Log {
    fn row(&mut self, table: &Table, columns: &Columns, place: Place, all: &mut Collected) {
        let cell = |at: Option<usize>| table.cell(at);
        let (element, id, name) =
            (cell(Some(columns.element)), cell(columns.task), cell(columns.name));
        let dates = columns.dates().map(|at| cell(Some(at)));
        if id.is_empty() && name.is_empty() {
            all.report(Severity::Warning, "incomplete-row", element, place, || {
                format!("a row without a task (element {element:?}); it is left out")
            });
            return;
        }
        let key = match id {
            "" => Key::Dates([name.into(), dates[0].into(), dates[1].into()]),
            id => Key::Id(id.into()),
        };
        let next = self.tasks.len();
        let number = *self.places.entry(key).or_insert(next);
        if number == next {
            self.tasks.push(Task {
                id: id.to_owned(),
                name: if name.is_empty() { id } else { name }.to_owned(),
                dates: dates.map(str::to_owned),
                elements: Vec::new(),
                places: Vec::new(),
                cells: Vec::new(),
            });
        }
        let task = &mut self.tasks[number];
        if !name.is_empty() && task.name != name || task.dates != dates {
            all.report(Severity::Warning, "differing-rows", id, place, || {
                format!(
                    "task {id:?} is {name:?} from {:?} to {:?} here, but {:?} from {:?} to {:?} \
                     before; the first row counts",
                    dates[0], dates[1], task.name, task.dates[0], task.dates[1]
                )
            });
        }
        let row = task.elements.len();
        task.elements.push(element.to_owned());
        task.places.push(place);
        for (number, (at, name)) in columns.others.iter().enumerate() {
            let value = cell(Some(*at));
            if value.is_empty() {
                continue;
            }
            let value = all.field_text(name, value, place);
            let value = all.name(&value);
            match task.cells.binary_search_by_key(&number, |c| c.0) {
                Ok(known) => self.values += task.cells[known].1.set(row, value),
                Err(new) => {
                    let mut cells = Cells::Same(value.clone(), 1);
                    if row > 0 {
                        cells = Cells::Each(Vec::new());
                        self.values += cells.set(row, value);
                    }
                    task.cells.insert(new, (number, cells));
                }
            }
        }
    }

    /// Hands the tasks over as activities. Those without ids get their names as ids, with their dates
    /// where several have one name: the same in every version of a log in which they stay.
    fn finish(self, columns: &Columns, dates: &DateReader, all: &mut Collected) {
        drop(self.places);
        let mut named: HashMap<String, usize> = HashMap::new();
        for task in self.tasks.iter().filter(|t| t.id.is_empty()) {
            *named.entry(task.name.clone()).or_default() += 1;
        }
        for mut task in self.tasks {
            if task.id.is_empty() {
                let [start, end] = &task.dates;
                task.id = match named.get(&task.name) {
                    Some(1) => task.name.clone(),
                    _ => format!("{} {start} {end}", task.name),
                };
            }
            task.finish(columns, dates, all);
        }
    }
}

impl Task {
    fn finish(mut self, columns: &Columns, dates: &DateReader, all: &mut Collected) {
        let rows = self.elements.len();
        let mut activity = Activity { id: self.id, name: self.name, ..Activity::default() };
        for (number, mut cells) in self.cells {
            let name = columns.others[number].1.clone();
            match cells {
                Cells::Same(value, same) if same == rows => {
                    activity.fields.push((name, (&*value).into()));
                }
                _ => {
                    let values = cells.take(rows);
                    activity.element_fields.push(ElementField { name, values });
                }
            }
        }
        report_repeats(&activity, &self.elements, &self.places, all);
        activity.elements = std::mem::take(&mut self.elements);
        let [start, end] = self.dates.map(Some);
        let texts = Texts { start, end, ..Texts::default() };
        let place = self.places.first().copied().unwrap_or_else(|| all.line(1));
        all.push_texts(activity, texts, dates, place);
        if let Some(source) = all.sources.activities.last_mut() {
            self.places.shrink_to_fit();
            source.links = self.places;
        }
    }
}

/// Says where a task names an element again and says something else of it. The first row counts.
fn report_repeats(activity: &Activity, elements: &[String], places: &[Place], all: &mut Collected) {
    let mut first_rows: HashMap<&str, usize> = HashMap::with_capacity(elements.len());
    for (row, element) in elements.iter().enumerate().filter(|(_, e)| !e.is_empty()) {
        let first = *first_rows.entry(element).or_insert(row);
        let differs = |field: &&ElementField| field.values[row] != field.values[first];
        if let Some(field) = activity.element_fields.iter().find(differs) {
            all.report(Severity::Warning, "differing-element", element, places[row], || {
                format!(
                    "element {element:?} of {:?} has {:?} as {:?} here, but {:?} before; the first \
                     row counts",
                    activity.id, &*field.values[row], &*field.name, &*field.values[first]
                )
            });
        }
    }
}
