//! Tables: schedules and links files as CSV.

use super::text::Lines;
use super::{Collected, DateReader, ReadError, Texts, links};
use crate::Severity;
use csv::{ReaderBuilder, StringRecord, Trim};
use std::path::Path;

/// Columns that a schedule must have, each with the other name that is understood.
const NEEDED: [&[&str]; 4] = [&["id", "activity_id"], &["name"], &["start"], &["end", "finish"]];

/// Reads one file into `all`: a links file where its columns say so, else a schedule.
pub(super) fn read(
    path: &Path,
    text: &str,
    dates: &DateReader,
    all: &mut Collected,
) -> Result<(), ReadError> {
    let mut table = Table::open(text);
    if let Some(columns) = links::Columns::find(&table.header) {
        links::read(&mut table, columns, all);
        return Ok(());
    }
    let columns = Columns::find(&table.header).map_err(|missing| ReadError::Header {
        file: path.to_owned(),
        missing,
        found: table.header.found(),
    })?;
    let before = all.activities.len();
    while let Some(line) = table.next(all) {
        let place = all.line(line);
        all.add_activity(columns.texts(&table), dates, place);
    }
    if all.activities.len() == before {
        all.empty_files.push(all.current_file());
    }
    Ok(())
}

/// The names of a table's columns.
pub(super) struct Header(StringRecord);

impl Header {
    /// The column with the first of these names that occurs, in whatever case.
    pub(super) fn position(&self, names: &[&str]) -> Option<usize> {
        names.iter().find_map(|name| self.0.iter().position(|c| c.eq_ignore_ascii_case(name)))
    }

    /// The columns for a message, shortened.
    fn found(&self) -> String {
        let all: Vec<&str> = self.0.iter().collect();
        let mut text: String = all.join(", ").chars().take(120).collect();
        if text.len() < all.join(", ").len() {
            text.push_str(" ...");
        }
        text
    }
}

/// A table that is read row by row.
pub(super) struct Table<'a> {
    pub(super) header: Header,
    /// The row that was read last.
    pub(super) row: StringRecord,
    semicolons: bool,
    lines: Lines<'a>,
    reader: csv::Reader<&'a [u8]>,
}

impl<'a> Table<'a> {
    /// Takes the separator that gives the header row more columns.
    fn open(text: &'a str) -> Self {
        let with = |separator: u8| {
            let mut reader = ReaderBuilder::new()
                .delimiter(separator)
                .has_headers(false)
                .flexible(true)
                .trim(Trim::All)
                .from_reader(text.as_bytes());
            let mut header = StringRecord::new();
            // Text in memory that is UTF-8 and may have rows of any length cannot fail to be read.
            let _ = reader.read_record(&mut header);
            let semicolons = separator == b';';
            let (row, lines) = (StringRecord::new(), Lines::new(text));
            Self { header: Header(header), row, semicolons, lines, reader }
        };
        let (commas, semicolons) = (with(b','), with(b';'));
        if semicolons.header.0.len() > commas.header.0.len() { semicolons } else { commas }
    }

    /// Reads the next row that says something and returns its line. Rows with more cells than the
    /// header names are reported and left out: a separator stands where none belongs.
    pub(super) fn next(&mut self, all: &mut Collected) -> Option<usize> {
        while self.reader.read_record(&mut self.row).unwrap_or(false) {
            let columns = self.header.0.len();
            if self.row.iter().all(str::is_empty) {
                continue;
            }
            // The reader's own count lags behind by the line ends that it has not skipped yet.
            let from = self.row.position().map_or(0, |p| p.byte()) as usize;
            let line = self.lines.of_text_from(from);
            if self.row.iter().skip(columns).all(str::is_empty) {
                return Some(line);
            }
            let place = all.sources.describe(all.line(line));
            all.diagnostics.add(Severity::Error, "too-many-cells", place.clone(), || {
                format!(
                    "{place}: {} cells in a table of {columns} columns; the row is left out \
                     (a text with the separator in it needs quotes)",
                    self.row.len()
                )
            });
        }
        None
    }

    /// The cell of a column in the row that was read last; empty where the row is shorter.
    pub(super) fn cell(&self, column: Option<usize>) -> &str {
        column.and_then(|c| self.row.get(c)).unwrap_or_default()
    }
}

/// Where a schedule's columns stand.
struct Columns {
    id: Option<usize>,
    name: Option<usize>,
    start: Option<usize>,
    end: Option<usize>,
    kind: Option<usize>,
    active: Option<usize>,
    elements: Option<usize>,
    /// Columns that topout does not know, with their names.
    others: Vec<(usize, String)>,
}

impl Columns {
    /// Fails with the names of the needed columns that are missing.
    fn find(header: &Header) -> Result<Self, String> {
        let missing: Vec<&str> =
            NEEDED.iter().filter(|n| header.position(n).is_none()).map(|n| n[0]).collect();
        if !missing.is_empty() {
            return Err(missing.join(", "));
        }
        let [id, name, start, end] = NEEDED.map(|names| header.position(names));
        let [kind, active, elements] =
            ["kind", "active", "elements"].map(|n| header.position(&[n]));
        let known = [id, name, start, end, kind, active, elements];
        let others = header.0.iter().enumerate().filter(|&(i, _)| !known.contains(&Some(i)));
        let others = others.map(|(i, name)| (i, name.to_owned())).collect();
        Ok(Self { id, name, start, end, kind, active, elements, others })
    }

    fn texts(&self, table: &Table) -> Texts {
        let text = |column: Option<usize>| table.cell(column).to_owned();
        let joint = if table.semicolons { '|' } else { ';' };
        let elements = table.cell(self.elements).split(joint).map(str::trim);
        let field = |(i, name): &(usize, String)| {
            let cell = table.cell(Some(*i));
            (!cell.is_empty()).then(|| (name.clone(), cell.to_owned()))
        };
        Texts {
            id: text(self.id),
            name: text(self.name),
            start: Some(text(self.start)),
            end: Some(text(self.end)),
            kind: Some(text(self.kind)),
            active: Some(text(self.active)),
            elements: elements.filter(|e| !e.is_empty()).map(str::to_owned).collect(),
            fields: self.others.iter().filter_map(field).collect(),
            reported: false,
        }
    }
}
