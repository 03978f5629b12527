//! STEP files (ISO 10303-21), statement by statement. What nobody asks for is passed over and takes
//! no memory.

use super::error::ReadError;
use super::text::{BLOCK, Input, fill};
use encoding_rs::WINDOWS_1252;
use std::io::Read;

/// Values within each other; IFC writes five.
const MAX_DEPTH: usize = 16;

/// A statement that is kept may be so long: a million references fit.
const MAX_STATEMENT: usize = 16 << 20;

/// A name is not longer.
const MAX_NAME: usize = 256;

/// `#12=IFCTASK(...)`, or `FILE_SCHEMA(...)` with the id 0.
pub(super) struct Statement {
    pub(super) id: u64,
    pub(super) name: String,
    /// From 1; where it begins.
    pub(super) line: usize,
    arguments: Vec<u8>,
}

/// A file's statements.
pub(super) struct Statements<'a> {
    input: &'a Input<'a>,
    bytes: Box<dyn Read + 'a>,
    block: Vec<u8>,
    rest: std::ops::Range<usize>,
    line: usize,
    /// The file ends within a statement, or without saying that it ends.
    pub(super) cut: bool,
}

/// Where a byte stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum At {
    Plain,
    Text,
    /// After a slash, which begins a comment before an asterisk.
    Slash,
    Comment,
    CommentStar,
}

impl<'a> Statements<'a> {
    pub(super) fn new(input: &'a Input<'a>) -> Result<Self, ReadError> {
        let (bytes, block) = (input.open()?, vec![0; BLOCK]);
        Ok(Self { input, bytes, block, rest: 0..0, line: 1, cut: true })
    }

    /// The next statement that is wanted by its id and name.
    pub(super) fn next(
        &mut self,
        wanted: impl Fn(u64, &str) -> bool,
    ) -> Result<Option<Statement>, ReadError> {
        let (mut at, mut head, mut statement) = (At::Plain, Vec::new(), None);
        let mut in_arguments = false;
        let mut line = self.line;
        loop {
            if self.rest.is_empty() && !self.fill()? {
                self.cut |= !head.is_empty();
                return Ok(None);
            }
            match at {
                At::Plain | At::Text if in_arguments => self.take_run(at, statement.as_mut())?,
                At::Plain => self.take_head(&mut head, &mut line),
                _ => {}
            }
            if self.rest.is_empty() {
                continue;
            }
            let byte = self.block[self.rest.start];
            self.rest.start += 1;
            self.line += usize::from(byte == b'\n');
            let before = at;
            at = at.after(byte);
            if at == At::Comment && before == At::Slash {
                // The slash was taken for part of the statement.
                match &mut statement {
                    Some(Statement { arguments, .. }) => arguments.pop(),
                    None => head.pop(),
                };
            }
            let comment = [At::Comment, At::CommentStar];
            if comment.contains(&at) || comment.contains(&before) {
                continue;
            }
            if at == At::Plain && byte == b';' {
                if let Some(mut statement) = statement {
                    statement.arguments.shrink_to_fit();
                    return Ok(Some(statement));
                }
                self.cut &= !head.starts_with(b"END-ISO");
                (in_arguments, line) = (false, self.line);
                head.clear();
                continue;
            }
            if in_arguments {
                if let Some(statement) = &mut statement {
                    statement.arguments.push(byte);
                }
            } else if byte == b'(' {
                in_arguments = true;
                head.make_ascii_uppercase();
                let (id, name) = id_and_name(&head);
                if wanted(id, name) {
                    let name = name.to_owned();
                    statement = Some(Statement { id, name, line, arguments: vec![byte] });
                }
            } else if head.len() < MAX_NAME {
                head.push(byte);
            }
        }
    }

    /// Reads the next block; false at the end.
    fn fill(&mut self) -> Result<bool, ReadError> {
        let length = fill(&mut *self.bytes, &mut self.block);
        self.rest = 0..length.map_err(|source| self.input.io(source))?;
        Ok(!self.rest.is_empty())
    }

    /// Takes what stands before the brackets; `line` becomes that of its first byte.
    fn take_head(&mut self, head: &mut Vec<u8>, line: &mut usize) {
        let mut rest = &self.block[self.rest.clone()];
        let line_ends = |bytes: &[u8]| bytes.iter().filter(|&&b| b == b'\n').count();
        if head.is_empty() {
            let text = rest.trim_ascii_start();
            self.line += line_ends(&rest[..rest.len() - text.len()]);
            self.rest.start += rest.len() - text.len();
            (rest, *line) = (text, self.line);
        }
        let end = rest.iter().position(|b| matches!(b, b'(' | b';' | b'\'' | b'/'));
        let run = &rest[..end.unwrap_or(rest.len())];
        head.extend_from_slice(&run[..run.len().min(MAX_NAME.saturating_sub(head.len()))]);
        self.line += line_ends(run);
        self.rest.start += run.len();
    }

    /// Takes bytes up to one that ends a text, begins one, or could end the statement.
    fn take_run(&mut self, at: At, statement: Option<&mut Statement>) -> Result<(), ReadError> {
        let rest = &self.block[self.rest.clone()];
        let end = match at {
            At::Text => rest.iter().position(|b| *b == b'\''),
            _ => rest.iter().position(|b| matches!(b, b'\'' | b';' | b'/')),
        };
        let run = &rest[..end.unwrap_or(rest.len())];
        if let Some(Statement { arguments, line, .. }) = statement {
            if arguments.len() + run.len() > MAX_STATEMENT {
                let (file, limit_bytes) = (self.input.path.into(), MAX_STATEMENT as u64);
                return Err(ReadError::TooLong { file, line: *line, limit_bytes });
            }
            arguments.extend_from_slice(run);
        }
        self.line += run.iter().filter(|&&b| b == b'\n').count();
        self.rest.start += run.len();
        Ok(())
    }
}

impl At {
    /// Where the byte after this one stands.
    fn after(self, byte: u8) -> Self {
        match (self, byte) {
            (At::Comment | At::CommentStar, b'*') => At::CommentStar,
            (At::CommentStar, b'/') => At::Plain,
            (At::Comment | At::CommentStar, _) => At::Comment,
            (At::Slash, b'*') => At::Comment,
            (At::Text, b'\'') => At::Plain,
            (At::Text, _) => At::Text,
            (_, b'\'') => At::Text,
            (_, b'/') => At::Slash,
            _ => At::Plain,
        }
    }
}

/// `#12=IFCTASK`; a statement without an id has 0.
fn id_and_name(head: &[u8]) -> (u64, &str) {
    let text = std::str::from_utf8(head).unwrap_or_default();
    let (id, name) = match text.split_once('=') {
        Some((id, name)) => (id.trim().strip_prefix('#').and_then(|id| id.parse().ok()), name),
        None => (None, text),
    };
    (id.unwrap_or(0), name.trim())
}

/// What a statement says.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Value {
    /// `$` or `*`: nothing.
    Null,
    /// `#12`
    Reference(u64),
    Text(String),
    /// `.FINISH_START.` without the points.
    Word(String),
    Number(f64),
    List(Vec<Value>),
    /// `IFCDURATION('P2D')`
    Typed(String, Box<Value>),
}

impl Value {
    /// What is not a text is an empty one.
    pub(super) fn text(&self) -> &str {
        match self {
            Value::Text(text) | Value::Word(text) => text,
            Value::Typed(_, value) => value.text(),
            _ => "",
        }
    }

    pub(super) fn reference(&self) -> Option<u64> {
        if let Value::Reference(id) = self { Some(*id) } else { None }
    }

    /// All references in it.
    pub(super) fn references(&self) -> Vec<u64> {
        match self {
            Value::List(values) => values.iter().filter_map(Value::reference).collect(),
            value => value.reference().into_iter().collect(),
        }
    }

    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Value::Number(number) => Some(*number),
            Value::Typed(_, value) => value.number(),
            _ => None,
        }
    }
}

impl Statement {
    /// What stands between its brackets; `None` if that cannot be read.
    pub(super) fn values(&self) -> Option<Vec<Value>> {
        let mut parser = Parser { bytes: &self.arguments, at: 0 };
        match parser.value(0)? {
            Value::List(values) if parser.peek().is_none() => Some(values),
            _ => None,
        }
    }
}

struct Parser<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Parser<'a> {
    fn peek(&mut self) -> Option<u8> {
        let rest = &self.bytes[self.at..];
        self.at += rest.iter().take_while(|b| b.is_ascii_whitespace()).count();
        self.bytes.get(self.at).copied()
    }

    /// Bytes up to the first that is not as wanted.
    fn word(&mut self, wanted: impl Fn(u8) -> bool) -> &'a str {
        let from = self.at;
        self.at += self.bytes[from..].iter().take_while(|&&b| wanted(b)).count();
        std::str::from_utf8(&self.bytes[from..self.at]).unwrap_or_default()
    }

    fn value(&mut self, depth: usize) -> Option<Value> {
        if depth > MAX_DEPTH {
            return None;
        }
        let first = self.peek()?;
        Some(match first {
            b'$' | b'*' => {
                self.at += 1;
                Value::Null
            }
            b'#' => {
                self.at += 1;
                Value::Reference(self.word(|b| b.is_ascii_digit()).parse().ok()?)
            }
            b'\'' => Value::Text(self.quoted()?),
            b'.' => {
                self.at += 1;
                let word = self.word(|b| b.is_ascii_alphanumeric() || b == b'_');
                (self.peek()? == b'.').then(|| self.at += 1)?;
                Value::Word(word.to_owned())
            }
            b'"' => {
                self.at += 1;
                let word = self.word(|b| b != b'"');
                (self.peek()? == b'"').then(|| self.at += 1)?;
                Value::Word(word.to_owned())
            }
            b'(' => {
                self.at += 1;
                // A task's time has 20 attributes, the most of what is read.
                let mut values = Vec::with_capacity(if depth == 0 { 20 } else { 0 });
                if self.peek()? == b')' {
                    self.at += 1;
                    return Some(Value::List(values));
                }
                loop {
                    values.push(self.value(depth + 1)?);
                    let next = self.peek()?;
                    self.at += 1;
                    match next {
                        b',' => {}
                        b')' => return Some(Value::List(values)),
                        _ => return None,
                    }
                }
            }
            b'+' | b'-' | b'0'..=b'9' => {
                let word = self.word(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b));
                Value::Number(word.parse().ok()?)
            }
            b if b.is_ascii_alphabetic() => {
                let name = self.word(|b| b.is_ascii_alphanumeric() || b == b'_');
                (self.peek()? == b'(').then_some(())?;
                let Value::List(values) = self.value(depth + 1)? else { return None };
                let value = values.into_iter().next().unwrap_or(Value::Null);
                Value::Typed(name.to_ascii_uppercase(), Box::new(value))
            }
            _ => return None,
        })
    }

    /// A text between quotes, of which two stand for one.
    fn quoted(&mut self) -> Option<String> {
        self.at += 1;
        let mut bytes = Vec::new();
        loop {
            let rest = &self.bytes[self.at..];
            let part = &rest[..rest.iter().position(|&b| b == b'\'')?];
            self.at += part.len() + 1;
            let goes_on = self.bytes.get(self.at) == Some(&b'\'');
            if !goes_on && bytes.is_empty() {
                return Some(decode(part));
            }
            bytes.extend_from_slice(part);
            if !goes_on {
                return Some(decode(&bytes));
            }
            bytes.push(b'\'');
            self.at += 1;
        }
    }
}

/// A text with its escapes: `\X2\00C4\X0\`, `\X\C4`, `\S\D` and `\\`. Bytes beyond ASCII, which
/// should not occur, are UTF-8 or else windows-1252.
fn decode(bytes: &[u8]) -> String {
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => WINDOWS_1252.decode_without_bom_handling(bytes).0.into_owned(),
    };
    if !text.contains('\\') {
        return text;
    }
    let mut decoded = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while let Some(at) = rest.find('\\') {
        decoded.push_str(&rest[..at]);
        rest = &rest[at..];
        let (written, length) = escape(rest).unwrap_or_else(|| ("\\".to_owned(), 1));
        decoded.push_str(&written);
        rest = &rest[length..];
    }
    decoded.push_str(rest);
    decoded
}

/// What the escape at the beginning stands for, and how long it is.
fn escape(text: &str) -> Option<(String, usize)> {
    if text.starts_with("\\\\") {
        return Some(("\\".to_owned(), 2));
    }
    if let Some(hex) = text.strip_prefix("\\X\\") {
        let code = u8::from_str_radix(hex.get(..2)?, 16).ok()?;
        return Some((char::from(code).to_string(), 5));
    }
    if let Some(rest) = text.strip_prefix("\\S\\") {
        let low = rest.chars().next().filter(char::is_ascii)?;
        return Some((char::from(low as u8 | 0x80).to_string(), 4));
    }
    let (digits, hex) = match text.get(..4)? {
        "\\X2\\" => (4, &text[4..]),
        "\\X4\\" => (8, &text[4..]),
        // `\PA\` only names an alphabet.
        _ if text.starts_with("\\P") && text.as_bytes()[3] == b'\\' => {
            return Some((String::new(), 4));
        }
        _ => return None,
    };
    let hex = &hex[..hex.find("\\X0\\")?];
    let mut units = Vec::with_capacity(hex.len() / 4);
    for chunk in hex.as_bytes().chunks(digits) {
        units.push(u32::from_str_radix(std::str::from_utf8(chunk).ok()?, 16).ok()?);
    }
    let written = match digits {
        4 => String::from_utf16_lossy(&units.iter().map(|&u| u as u16).collect::<Vec<_>>()),
        _ => units.iter().filter_map(|&u| char::from_u32(u)).collect(),
    };
    Some((written, 4 + hex.len() + 4))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts() {
        for (written, text) in [
            ("W\\X\\E4nde", "Wände"),
            ("W\\X2\\00E4\\X0\\nde", "Wände"),
            ("\\X2\\D83DDE00\\X0\\", "😀"),
            ("\\X4\\0001F600\\X0\\", "😀"),
            ("W\\S\\dnde", "Wände"),
            ("\\PA\\a\\\\b", "a\\b"),
            ("C:\\X2\\zz", "C:\\X2\\zz"),
            ("\\", "\\"),
            ("\\Pä\\", "\\Pä\\"),
        ] {
            assert_eq!(decode(written.as_bytes()), text, "{written}");
        }
        assert_eq!(decode(b"W\xE4nde"), "Wände");
    }
}
