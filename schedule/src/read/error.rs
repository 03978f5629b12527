//! Why a schedule file cannot be used.

use std::path::PathBuf;

/// Why a schedule cannot be read at all. Smaller problems become [`crate::Diagnostics`].
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("{}: cannot be read: {source}", file.display())]
    Io {
        /// Which file.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Nothing but white space.
    #[error("{}: the file is empty; a schedule was expected", file.display())]
    Empty {
        /// Which file.
        file: PathBuf,
    },
    /// Larger than any schedule.
    #[error("{}: larger than {limit_bytes} bytes, which no schedule is", file.display())]
    TooLarge {
        /// Which file.
        file: PathBuf,
        /// The limit.
        limit_bytes: u64,
    },
    /// One activity, row or element that is longer than any schedule's.
    #[error("{}: line {line}: more than {limit_bytes} bytes in one piece, which no schedule has", file.display())]
    TooLong {
        /// Which file.
        file: PathBuf,
        /// Where it is refused, from 1.
        line: usize,
        /// The limit.
        limit_bytes: u64,
    },
    /// Bytes that are no text in the encoding.
    #[error(
        "{}: line {line}: byte {byte} of the file (0x{value:02X}) is not {encoding}; {hint}",
        file.display()
    )]
    Encoding {
        /// Which file.
        file: PathBuf,
        /// Line of the first wrong byte, from 1.
        line: usize,
        /// Place of the first wrong byte, from 1.
        byte: usize,
        /// The byte.
        value: u8,
        /// The encoding in which it was read.
        encoding: String,
        /// What to try.
        hint: &'static str,
    },
    /// A declared encoding that nobody knows.
    #[error(
        "{name:?} is not an encoding; known are UTF-8, windows-1252, ISO-8859-15, UTF-16LE ..."
    )]
    UnknownEncoding {
        /// As declared.
        name: String,
    },
    /// A date format that cannot give dates.
    #[error("the date format {format:?} {reason}; an example is %d-%m-%Y or %d.%m.%Y %H:%M")]
    DateFormat {
        /// As declared.
        format: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// Not JSON, or not an object with activities.
    #[error("{}: line {line} column {column}: {reason}", file.display())]
    Json {
        /// Which file.
        file: PathBuf,
        /// From 1.
        line: usize,
        /// In bytes, from 1.
        column: usize,
        /// What is wrong there.
        reason: String,
    },
    /// Not what its format asks for: XML, XER or IFC that is broken or of another kind.
    #[error("{}: line {line}: {reason}", file.display())]
    Malformed {
        /// Which file.
        file: PathBuf,
        /// From 1.
        line: usize,
        /// What is wrong there, with the byte where one line is all there is.
        reason: String,
    },
    /// A column that was said to be there.
    #[error("{}: line 1: there is no column {name:?} (found: {found})", file.display())]
    NoSuchColumn {
        /// Which file.
        file: PathBuf,
        /// As declared.
        name: String,
        /// The columns as found, shortened.
        found: String,
    },
    /// A table whose header row is neither a schedule's nor a links file's.
    #[error(
        "{}: line 1: the header row lacks {missing} (found: {found}); a schedule needs id, name, \
         start and end, a links file guid or element, and activity_id, an event log an element, a \
         task, start and end",
        file.display()
    )]
    Header {
        /// Which file.
        file: PathBuf,
        /// Names of columns that a schedule needs.
        missing: String,
        /// The columns as found, shortened.
        found: String,
    },
    /// Dates, but none that can be read.
    #[error("no activity has dates that can be read; {first}")]
    NoReadableDates {
        /// The first of them: file, line and value.
        first: String,
    },
}
