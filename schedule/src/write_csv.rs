//! Writing topout's own tables.

use crate::read::{HEADINGS, read_predecessor, write_predecessor};
use crate::write::{date, text};
use crate::{Activity, DateSet, Fields, Schedule, Time};
use std::collections::HashMap;
use std::io::{Result, Write};

/// Fields have columns of their own up to so many names; office programs stop at 256 in all.
const MAX_FIELD_COLUMNS: usize = 200;

impl Schedule {
    /// Writes a table: a row for the project, one for each calendar and summary, then one for each
    /// activity. Reading it gives the same schedule.
    ///
    /// # Errors
    /// Those of `out`, and `InvalidData` for a time outside the calendar.
    pub fn write_csv(&self, out: impl Write) -> Result<()> {
        let fields = FieldColumns::of(&self.activities);
        let mut out = csv::WriterBuilder::new().flexible(true).from_writer(out);
        out.write_record(HEADINGS.iter().copied().chain(fields.names.iter().copied()))?;
        let row = |kind: &str, cells: &[(usize, &str)]| -> Vec<String> {
            let mut row = vec![String::new(); HEADINGS.len()];
            row[0] = kind.to_owned();
            cells.iter().for_each(|&(column, cell)| row[column] = cell.to_owned());
            row
        };
        let (start, end) = (cell(Some(self.period.start))?, cell(Some(self.period.end))?);
        let cells = [(2, &*self.project), (3, &*start), (4, &*end), (21, &*self.project_data()?)];
        out.write_record(row("project", &cells))?;
        for calendar in &self.calendars {
            let data = serde_json::to_string(calendar)?;
            out.write_record(row("calendar", &[(2, &calendar.name), (21, &data)]))?;
        }
        for kind in self.kinds.to_write() {
            let data = serde_json::to_string(kind)?;
            out.write_record(row("kind", &[(2, &kind.name), (21, &data)]))?;
        }
        for node in &self.wbs {
            let parent = node.parent.map_or_else(String::new, |p| p.to_string());
            out.write_record(row("wbs", &[(1, &node.code), (2, &node.name), (9, &parent)]))?;
        }
        for activity in &self.activities {
            out.write_record(self.row(activity, &fields)?)?;
        }
        out.flush()
    }

    /// What of the project has no column.
    fn project_data(&self) -> Result<String> {
        let calendar = self.calendar.map_or("null".to_owned(), |c| c.to_string());
        let (data_date, fields) = (date(self.data_date)?, pairs(&self.fields)?);
        Ok(format!(
            "{{\"data_date\": {data_date}, \"calendar\": {calendar}, \"fields\": {fields}}}"
        ))
    }

    fn row(&self, activity: &Activity, columns: &FieldColumns) -> Result<Vec<String>> {
        let number = |n: Option<u32>| n.map_or_else(String::new, |n| n.to_string());
        let mut row = vec![
            "activity".to_owned(),
            activity.id.clone(),
            activity.name.clone(),
            cell(activity.start)?,
            cell(activity.end)?,
            self.kinds.of(activity.kind).name.clone(),
            activity.active.to_string(),
            activity.milestone.to_string(),
            activity.percent_complete.map_or_else(String::new, |p| p.to_string()),
            number(activity.wbs),
            number(activity.calendar),
            self.predecessors_as_cell(activity)?,
            elements(&activity.elements)?,
        ];
        for (_, set) in DateSet::WORDS {
            let dates = activity.date_sets[set];
            row.extend([cell(dates.start)?, cell(dates.end)?]);
        }
        match columns.cells(&activity.fields) {
            Some(cells) => {
                row.push(String::new());
                row.extend(cells);
            }
            None => row.push(pairs(&activity.fields)?),
        }
        Ok(row)
    }

    /// As planners write them, unless that could be read in another way.
    fn predecessors_as_cell(&self, activity: &Activity) -> Result<String> {
        let mut cells = Vec::with_capacity(activity.predecessors.len());
        for link in &activity.predecessors {
            let Some(other) = self.activities.get(link.activity as usize) else { continue };
            let cell = write_predecessor(&other.id, link);
            let plain = !other.id.contains(';')
                && !other.id.starts_with('[')
                && read_predecessor(&cell) == Some((&other.id, link.kind, link.lag));
            if !plain {
                return Ok(self.predecessors_as_json(&activity.predecessors)?.unwrap_or_default());
            }
            cells.push(cell);
        }
        Ok(cells.join(";"))
    }
}

fn cell(time: Option<Time>) -> Result<String> {
    match time {
        None => Ok(String::new()),
        time => Ok(date(time)?.trim_matches('"').to_owned()),
    }
}

fn elements(names: &[String]) -> Result<String> {
    let plain = |name: &String| !name.is_empty() && !name.contains(';') && !name.starts_with('[');
    match names.iter().all(plain) {
        true => Ok(names.join(";")),
        false => Ok(serde_json::to_string(names)?),
    }
}

/// Fields as JSON.
fn pairs(fields: &Fields) -> Result<String> {
    let pairs = fields.iter().map(|(n, v)| Ok(format!("[{}, {}]", text(n)?, text(v)?)));
    Ok(format!("[{}]", pairs.collect::<Result<Vec<_>>>()?.join(", ")))
}

/// The fields that have columns.
struct FieldColumns<'a> {
    names: Vec<&'a str>,
    columns: HashMap<&'a str, usize>,
}

impl<'a> FieldColumns<'a> {
    /// Names in the order in which they occur, if a heading can hold them.
    fn of(activities: &'a [Activity]) -> Self {
        let mut this = Self { names: Vec::new(), columns: HashMap::new() };
        for (name, _) in activities.iter().flat_map(|a| &a.fields) {
            let plain = !name.is_empty() && name.trim() == &**name;
            if plain && this.names.len() < MAX_FIELD_COLUMNS && !this.columns.contains_key(&**name)
            {
                this.columns.insert(name, this.names.len());
                this.names.push(name);
            }
        }
        this
    }

    /// The cells of an activity's fields; `None` where reading them would give others.
    fn cells(&self, fields: &Fields) -> Option<Vec<String>> {
        let mut cells = Vec::with_capacity(self.names.len());
        for (name, value) in fields {
            let column = *self.columns.get(&**name)?;
            if column < cells.len() || value.is_empty() {
                return None;
            }
            cells.resize(column, String::new());
            cells.push(value.to_string());
        }
        cells.resize(self.names.len(), String::new());
        Some(cells)
    }
}
