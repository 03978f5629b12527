//! Readers: schedule files become one [`Schedule`].
//!
//! One reader a format, each in a file of its own, all of them a record at a time. Each file adds to
//! a [`Collected`]; links wait there until every file is read, so the order of the files does not
//! matter to them.

mod collected;
mod csv;
mod csv_own;
mod dates;
mod dialect;
mod error;
mod ifc;
mod json;
mod json_project;
mod json_scan;
mod links;
mod mspdi;
mod mspdi_calendar;
mod p6;
mod p6_calendar;
mod pmxml;
mod step;
mod table;
mod tasklinks;
mod text;
mod xer;
mod xml;

pub use csv::Column;
pub(crate) use csv_own::HEADINGS;
pub use error::ReadError;
pub use json::FORMAT;
pub(crate) use json::SET_NAMES;
pub(crate) use tasklinks::{read_predecessor, write_predecessor};

use crate::Schedule;
use collected::Collected;
use dates::DateReader;
use std::path::{Path, PathBuf};
use text::{Input, TextEncoding};

/// How to read files that do not say it themselves.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Format of dates that are not ISO 8601, for example `%d-%m-%Y` or `%d.%m.%Y %H:%M`.
    pub date_format: Option<String>,
    /// Encoding of CSV and XER files that are not UTF-8, for example `windows-1252`.
    pub encoding: Option<String>,
    /// What columns of CSV schedules mean, by their names in whatever case. Other columns mean what
    /// their own names say.
    pub columns: Vec<(String, Column)>,
    /// The field that says the kinds of activities, for formats that have no place for them: a
    /// user-defined field or an activity code, in whatever case.
    pub kind_field: Option<String>,
}

/// Reads and merges schedules (topout JSON, CSV, Microsoft Project XML, Primavera P6 XER and XML,
/// IFC) and links files (CSV), in any order.
///
/// Problems in single activities, links and dates become [`Schedule::diagnostics`], each with file
/// and line; the rest of the file counts. A file that says nothing usable is an error.
pub fn read_files(paths: &[PathBuf], options: &ReadOptions) -> Result<Schedule, ReadError> {
    let dates = DateReader::new(options.date_format.as_deref())?;
    let mut all = Collected::default();
    for path in paths {
        read_input(&Input::file(path)?, options, &dates, &mut all)?;
    }
    all.finish(options)
}

/// [`read_files`] for one file that is in memory; `name` stands for its path.
pub fn read_bytes(name: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Schedule, ReadError> {
    let dates = DateReader::new(options.date_format.as_deref())?;
    let mut all = Collected::default();
    read_input(&Input::bytes(name, bytes), options, &dates, &mut all)?;
    all.finish(options)
}

fn read_input(
    input: &Input,
    options: &ReadOptions,
    dates: &DateReader,
    all: &mut Collected,
) -> Result<(), ReadError> {
    let head = input.head()?;
    all.begin_file(input.path);
    match Format::of(input.path, &head) {
        Format::Json => json::read(input, dates, all),
        Format::Csv => csv::read(input, options, dates, all),
        Format::Xer => xer::read(input, options.encoding.as_deref(), all),
        Format::Ifc => ifc::read(input, all),
        Format::Xml => {
            let encoding = match xml::declared_encoding(&head) {
                Some(name) => TextEncoding::named(name)?,
                None => TextEncoding::UTF_8,
            };
            let mut xml = xml::Xml::new(input.text(encoding)?);
            match xml.root()? {
                b"Project" => mspdi::read(&mut xml, all),
                b"APIBusinessObjects" => pmxml::read(&mut xml, all),
                root => {
                    let root = String::from_utf8_lossy(root).into_owned();
                    Err(xml.malformed(format!(
                        "the root element is {root:?}; Microsoft Project writes \"Project\", \
                         Primavera P6 \"APIBusinessObjects\""
                    )))
                }
            }
        }
    }
}

#[derive(Clone, Copy)]
enum Format {
    Json,
    Csv,
    Xml,
    Xer,
    Ifc,
}

impl Format {
    /// By what only one format begins with, else by the extension, else by the first character.
    fn of(path: &Path, head: &str) -> Self {
        let begins = |text: &str| head.get(..text.len()).is_some_and(|h| h == text);
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            _ if begins("ISO-10303-21") => Self::Ifc,
            _ if begins("ERMHDR\t") => Self::Xer,
            _ if begins("<?xml") || begins("<!DOCTYPE") || begins("<Project") => Self::Xml,
            _ if begins("<APIBusinessObjects") => Self::Xml,
            "json" => Self::Json,
            "csv" => Self::Csv,
            "xml" => Self::Xml,
            "xer" => Self::Xer,
            "ifc" => Self::Ifc,
            _ if begins("{") || begins("[") => Self::Json,
            _ if begins("<") => Self::Xml,
            _ => Self::Csv,
        }
    }
}
