//! Tables row by row, whatever stands in them.

use super::collected::Collected;
use super::csv_own::Own;
use super::error::ReadError;
use super::text::{Input, TextEncoding, TextReader};
use crate::Severity;
use csv::{ReaderBuilder, StringRecord};
use std::collections::VecDeque;
use std::io::Read;

/// The names of a table's columns.
pub(super) struct Header(pub(super) StringRecord);

impl Header {
    /// The column with the first of these names that occurs, in whatever case.
    pub(super) fn position(&self, names: &[&str]) -> Option<usize> {
        names.iter().find_map(|name| self.0.iter().position(|c| c.eq_ignore_ascii_case(name)))
    }

    /// The columns for a message, shortened.
    pub(super) fn found(&self) -> String {
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
    pub(super) semicolons: bool,
    /// Cells are taken as they are, without a look at white space around them.
    pub(super) exact: bool,
    reader: csv::Reader<LineCounter<'a>>,
}

impl<'a> Table<'a> {
    /// Takes the separator that gives the header row more columns.
    pub(super) fn open(input: &'a Input, encoding: TextEncoding) -> Result<Self, ReadError> {
        let with = |separator: u8| {
            let reader = ReaderBuilder::new()
                .delimiter(separator)
                .has_headers(false)
                .flexible(true)
                .buffer_capacity(64 << 10)
                .from_reader(LineCounter::new(input.text(encoding)?));
            let (header, row) = (Header(StringRecord::new()), StringRecord::new());
            let semicolons = separator == b';';
            let mut table = Self { header, row, semicolons, exact: false, reader };
            table.read_record()?;
            table.row.trim();
            table.header = Header(std::mem::take(&mut table.row));
            Ok(table)
        };
        let (commas, semicolons): (Self, Self) = (with(b',')?, with(b';')?);
        // A field of topout's own tables may be called anything.
        let own = Own::is(&commas.header);
        let more = !own && semicolons.header.0.len() > commas.header.0.len();
        Ok(if more { semicolons } else { commas })
    }

    fn read_record(&mut self) -> Result<bool, ReadError> {
        self.reader.get_mut().text.begin_record();
        self.reader.read_record(&mut self.row).map_err(|error| {
            let text = &mut self.reader.get_mut().text;
            text.error(|file, line| {
                let (file, reason) = (file.to_owned(), error.to_string());
                ReadError::Malformed { file, line, reason }
            })
        })
    }

    /// Reads the next row that says something and returns its line. Rows with more cells than the
    /// header names are reported and left out: a separator stands where none belongs.
    pub(super) fn next(&mut self, all: &mut Collected) -> Result<Option<usize>, ReadError> {
        while self.read_record()? {
            let columns = self.header.0.len();
            // The reader's own count lags behind by the line ends that it has not skipped yet.
            let from = self.row.position().map_or(0, |p| p.byte());
            let line = self.reader.get_mut().line_of_text_from(from);
            let is_empty = |cell: &str| cell.trim().is_empty();
            if self.row.iter().all(is_empty) {
                continue;
            }
            if self.row.iter().skip(columns).all(is_empty) {
                return Ok(Some(line));
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
        Ok(None)
    }

    /// The cell of a column in the row that was read last; empty where the row is shorter.
    pub(super) fn cell(&self, column: Option<usize>) -> &str {
        let cell = column.and_then(|c| self.row.get(c)).unwrap_or_default();
        if self.exact { cell } else { cell.trim() }
    }
}

/// Knows the lines of bytes that were read ahead.
struct LineCounter<'a> {
    text: TextReader<'a>,
    /// Line ends at and after the last byte that was asked for, and whether each ends a line (of a
    /// carriage return and a line feed only the first does).
    ends: VecDeque<(u64, bool)>,
    read: u64,
    after_return: bool,
    line: usize,
}

impl<'a> LineCounter<'a> {
    fn new(text: TextReader<'a>) -> Self {
        Self { text, ends: VecDeque::new(), read: 0, after_return: false, line: 1 }
    }

    /// The line of the first byte from `byte` on that does not end a line; not before the last one.
    fn line_of_text_from(&mut self, mut byte: u64) -> usize {
        while let Some(&(end, counts)) = self.ends.front()
            && end <= byte
        {
            byte = byte.max(end + 1);
            self.line += usize::from(counts);
            self.ends.pop_front();
        }
        self.line
    }
}

impl Read for LineCounter<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let length = self.text.read(buffer)?;
        for (i, &byte) in buffer[..length].iter().enumerate() {
            if byte == b'\n' || byte == b'\r' {
                let counts = byte == b'\r' || !self.after_return;
                self.ends.push_back((self.read + i as u64, counts));
            }
            self.after_return = byte == b'\r';
        }
        self.read += length as u64;
        Ok(length)
    }
}
