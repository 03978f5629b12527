//! From files to text.

use super::ReadError;
use encoding_rs::{DecoderResult, Encoding, UTF_8};
use std::borrow::Cow;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// More than ten times the largest schedule known; bounds what one file can allocate.
const MAX_BYTES: u64 = 2 << 30;

/// The bytes of a file that is not empty.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, ReadError> {
    let io = |source| ReadError::Io { file: path.to_owned(), source };
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(io)?;
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(ReadError::TooLarge { file: path.to_owned(), limit_bytes: MAX_BYTES });
    }
    Ok(bytes)
}

/// The text that bytes are in a declared encoding, by default UTF-8. A byte order mark overrules
/// both and is removed.
pub(super) fn decode<'a>(
    path: &Path,
    bytes: &'a [u8],
    declared: Option<&str>,
) -> Result<Cow<'a, str>, ReadError> {
    let declared = match declared {
        Some(name) => Some(
            Encoding::for_label(name.trim().as_bytes())
                .ok_or_else(|| ReadError::UnknownEncoding { name: name.to_owned() })?,
        ),
        None => None,
    };
    let (encoding, mark) = match Encoding::for_bom(bytes) {
        Some((encoding, length)) => (encoding, length),
        None => (declared.unwrap_or(UTF_8), 0),
    };
    let text = match encoding.decode_without_bom_handling_and_without_replacement(&bytes[mark..]) {
        Some(text) => text,
        None => {
            let wrong = mark + first_malformed(encoding, &bytes[mark..]);
            return Err(ReadError::Encoding {
                file: path.to_owned(),
                line: 1 + bytes[..wrong].iter().filter(|&&b| b == b'\n').count(),
                byte: wrong + 1,
                value: bytes.get(wrong).copied().unwrap_or_default(),
                encoding: encoding.name().to_owned(),
                hint: match declared {
                    Some(_) => "another encoding was declared than the file has",
                    None => {
                        "save it as UTF-8 or declare its encoding, often --encoding windows-1252"
                    }
                },
            });
        }
    };
    if text.trim().is_empty() {
        return Err(ReadError::Empty { file: path.to_owned() });
    }
    Ok(text)
}

/// Index of the first byte that the encoding cannot read.
fn first_malformed(encoding: &'static Encoding, bytes: &[u8]) -> usize {
    let mut decoder = encoding.new_decoder_without_bom_handling();
    let mut text = String::with_capacity(4096);
    let mut done = 0;
    loop {
        text.clear();
        let (result, read) =
            decoder.decode_to_string_without_replacement(&bytes[done..], &mut text, true);
        done += read;
        match result {
            DecoderResult::InputEmpty => return done,
            DecoderResult::OutputFull => {}
            DecoderResult::Malformed(length, after) => {
                return done.saturating_sub(usize::from(length) + usize::from(after));
            }
        }
    }
}

/// Counts lines on the way through a text, so that all places together cost one pass. A line ends
/// with a line feed, a carriage return or both.
#[derive(Clone)]
pub(super) struct Lines<'a> {
    pub(super) text: &'a str,
    offset: usize,
    line: usize,
    line_start: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, offset: 0, line: 1, line_start: 0 }
    }

    /// Line and column, from 1, of a byte not before the last one asked for.
    pub(super) fn at(&mut self, offset: usize) -> (usize, usize) {
        let bytes = self.text.as_bytes();
        let offset = offset.clamp(self.offset, bytes.len());
        for i in self.offset..offset {
            let ends = match bytes[i] {
                b'\n' => true,
                b'\r' => bytes.get(i + 1) != Some(&b'\n'),
                _ => false,
            };
            if ends {
                self.line += 1;
                self.line_start = i + 1;
            }
        }
        self.offset = offset;
        (self.line, offset - self.line_start + 1)
    }

    /// The line of the first byte from `offset` on that does not end a line.
    pub(super) fn of_text_from(&mut self, offset: usize) -> usize {
        let rest = self.text.as_bytes().get(offset..).unwrap_or_default();
        let ends = rest.iter().take_while(|b| matches!(b, b'\r' | b'\n')).count();
        self.at(offset + ends).0
    }
}
