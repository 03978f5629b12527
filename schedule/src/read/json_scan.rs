//! Takes JSON apart value by value, so that a file need not be held as a whole. Where a value ends is
//! found by its quotes and brackets; what is in it is left to `serde_json`.

use super::error::ReadError;
use super::text::TextReader;
use std::io::BufRead;

pub(super) struct Scan<'a> {
    text: TextReader<'a>,
}

/// A value's text and where it stands.
pub(super) struct Chunk {
    pub(super) text: String,
    /// From 1.
    pub(super) line: usize,
    /// Bytes of the line before it.
    pub(super) column: usize,
}

impl Chunk {
    /// The line of a byte in it.
    pub(super) fn line_of(&self, offset: usize) -> usize {
        let before = &self.text.as_bytes()[..offset.min(self.text.len())];
        self.line + before.iter().filter(|&&b| b == b'\n').count()
    }
}

impl<'a> Scan<'a> {
    pub(super) fn new(text: TextReader<'a>) -> Self {
        Self { text }
    }

    /// An error at the byte that comes next.
    pub(super) fn error(&mut self, reason: impl Into<String>) -> ReadError {
        let at_end = self.text.fill_buf().is_ok_and(<[u8]>::is_empty);
        let column = self.text.column() + usize::from(!at_end);
        self.text.error(|file, line| ReadError::Json {
            file: file.to_owned(),
            line,
            column,
            reason: reason.into(),
        })
    }

    /// The error of a value that `serde_json` refuses.
    pub(super) fn refuse(&mut self, chunk: &Chunk, error: &serde_json::Error) -> ReadError {
        let first = error.line() <= 1;
        let column = error.column() + if first { chunk.column } else { 0 };
        let line = chunk.line + error.line().saturating_sub(1);
        let reason = super::json::without_place(error);
        self.text.error(|file, _| ReadError::Json { file: file.to_owned(), line, column, reason })
    }

    /// The next byte that is not white space, which stays; `None` at the end.
    pub(super) fn peek(&mut self) -> Result<Option<u8>, ReadError> {
        loop {
            let Ok(ready) = self.text.fill_buf() else { return Err(self.error("unreadable")) };
            if ready.is_empty() {
                return Ok(None);
            }
            match ready.iter().position(|b| !matches!(b, b' ' | b'\t' | b'\r' | b'\n')) {
                Some(at) => {
                    let byte = ready[at];
                    self.text.consume(at);
                    return Ok(Some(byte));
                }
                None => {
                    let length = ready.len();
                    self.text.consume(length);
                }
            }
            self.text.begin_record();
        }
    }

    /// Takes a byte if it comes next.
    pub(super) fn take(&mut self, wanted: u8) -> Result<bool, ReadError> {
        let found = self.peek()? == Some(wanted);
        if found {
            self.text.consume(1);
        }
        Ok(found)
    }

    /// Between members: whether another one follows. `end` closes what they are in.
    pub(super) fn another(&mut self, first: bool, end: u8) -> Result<bool, ReadError> {
        if self.take(end)? {
            return Ok(false);
        }
        if first {
            return Ok(true);
        }
        if !self.take(b',')? {
            let what = if end == b'}' { "an object" } else { "a list" };
            return Err(match self.peek()? {
                None => self.error(format!("EOF while parsing {what}")),
                Some(_) => self.error(format!("expected `,` or `{}`", end as char)),
            });
        }
        if self.peek()? == Some(end) {
            return Err(self.error("trailing comma"));
        }
        Ok(true)
    }

    /// Takes the next value, whatever it is.
    pub(super) fn value(&mut self) -> Result<Chunk, ReadError> {
        self.text.begin_record();
        let first = self.peek()?;
        let (line, column) = (self.text.line(), self.text.column());
        let mut bytes = Vec::new();
        let mut state = State::default();
        let bracketed = matches!(first, Some(b'{' | b'[' | b'"'));
        loop {
            let Ok(ready) = self.text.fill_buf() else { return Err(self.error("unreadable")) };
            if ready.is_empty() {
                break;
            }
            let end = match bracketed {
                true => ready.iter().position(|&b| state.ends_with(b)).map(|at| at + 1),
                false => ready.iter().position(|b| b",]}: \t\r\n".contains(b)),
            };
            let taken = end.unwrap_or(ready.len());
            bytes.extend_from_slice(&ready[..taken]);
            self.text.consume(taken);
            if end.is_some() {
                break;
            }
        }
        if bytes.is_empty() {
            let reason =
                if first.is_none() { "EOF while parsing a value" } else { "expected value" };
            return Err(self.error(reason));
        }
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Chunk { text, line, column }),
            Err(_) => Err(self.error("a text that is not UTF-8")),
        }
    }
}

/// Within a value with quotes or brackets.
#[derive(Default)]
struct State {
    depth: usize,
    in_text: bool,
    escaped: bool,
}

impl State {
    /// Whether the value ends with this byte.
    fn ends_with(&mut self, byte: u8) -> bool {
        if self.in_text {
            match byte {
                _ if self.escaped => self.escaped = false,
                b'\\' => self.escaped = true,
                b'"' => self.in_text = false,
                _ => {}
            }
            return !self.in_text && self.depth == 0;
        }
        match byte {
            b'"' => self.in_text = true,
            b'{' | b'[' => self.depth += 1,
            b'}' | b']' => self.depth = self.depth.saturating_sub(1),
            _ => return false,
        }
        self.depth == 0 && !self.in_text
    }
}
