//! From files to text, a block at a time.

use super::ReadError;
use encoding_rs::{Decoder, DecoderResult, Encoding, UTF_8, WINDOWS_1252};
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, Read};
use std::path::Path;

/// More than ten times the largest schedule known.
const MAX_BYTES: u64 = 2 << 30;

/// Bytes read at once.
pub(super) const BLOCK: usize = 64 << 10;

/// What one record (an activity, a row, an element) may take. Larger ones are no schedule's: a
/// million elements of one activity fit.
pub(super) const MAX_RECORD: u64 = 64 << 20;

/// A file, or bytes that stand for one. It can be read more than once.
pub(super) struct Input<'a> {
    pub(super) path: &'a Path,
    bytes: Option<Cow<'a, [u8]>>,
}

impl<'a> Input<'a> {
    /// What is no regular file (a pipe) can be read but once and is held in memory.
    pub(super) fn file(path: &'a Path) -> Result<Self, ReadError> {
        let io = |source| ReadError::Io { file: path.to_owned(), source };
        let file = File::open(path).map_err(io)?;
        let regular = file.metadata().map_err(io)?.is_file();
        let mut bytes = None;
        if !regular {
            let mut all = Vec::new();
            file.take(MAX_BYTES + 1).read_to_end(&mut all).map_err(io)?;
            bytes = Some(Cow::Owned(all));
        }
        Ok(Self { path, bytes })
    }

    pub(super) fn bytes(path: &'a Path, bytes: &'a [u8]) -> Self {
        Self { path, bytes: Some(Cow::Borrowed(bytes)) }
    }

    /// Its bytes from the beginning.
    pub(super) fn open(&self) -> Result<Box<dyn Read + '_>, ReadError> {
        Ok(match &self.bytes {
            Some(bytes) => Box::new(&bytes[..]),
            None => Box::new(File::open(self.path).map_err(|source| self.io(source))?),
        })
    }

    pub(super) fn io(&self, source: io::Error) -> ReadError {
        ReadError::Io { file: self.path.to_owned(), source }
    }

    /// The first text after white space, for a look at what this is; wrong bytes do not matter.
    pub(super) fn head(&self) -> Result<String, ReadError> {
        let mut input = self.open()?;
        let mut block = vec![0; BLOCK];
        let mut encoding = None;
        loop {
            let length = fill(&mut *input, &mut block).map_err(|source| self.io(source))?;
            let encoding =
                encoding.get_or_insert(Encoding::for_bom(&block[..length]).map_or(UTF_8, |b| b.0));
            let (text, _) = encoding.decode_with_bom_removal(&block[..length]);
            let text = text.trim_start();
            if !text.is_empty() {
                return Ok(text.chars().take(4096).collect());
            }
            if length < block.len() {
                return Err(ReadError::Empty { file: self.path.to_owned() });
            }
        }
    }

    /// The encoding that nobody declared: UTF-8 if all of it is, else windows-1252, as office
    /// programs write. Files with zero bytes are no text and stay UTF-8, which then fails.
    pub(super) fn guess_encoding(&self) -> Result<&'static Encoding, ReadError> {
        let mut input = self.open()?;
        let mut block = vec![0; BLOCK];
        let mut scratch = vec![0; BLOCK + 16];
        let mut decoder = UTF_8.new_decoder_without_bom_handling();
        let mut guess = UTF_8;
        for round in 0.. {
            let length = fill(&mut *input, &mut block).map_err(|source| self.io(source))?;
            let bytes = &block[..length];
            if bytes.contains(&0) || (round == 0 && Encoding::for_bom(bytes).is_some()) {
                return Ok(UTF_8);
            }
            let last = length < block.len();
            if guess == UTF_8 {
                let result =
                    decoder.decode_to_utf8_without_replacement(bytes, &mut scratch, last).0;
                if matches!(result, DecoderResult::Malformed(..)) {
                    guess = WINDOWS_1252;
                }
            }
            if last {
                break;
            }
        }
        Ok(guess)
    }

    /// Its text in an encoding. A byte order mark overrules that and is removed.
    pub(super) fn text(&self, encoding: TextEncoding) -> Result<TextReader<'_>, ReadError> {
        TextReader::new(self, encoding)
    }
}

/// Reads until the block is full or the input ends.
pub(super) fn fill(input: &mut dyn Read, block: &mut [u8]) -> io::Result<usize> {
    let mut length = 0;
    while length < block.len() {
        match input.read(&mut block[length..]) {
            Ok(0) => break,
            Ok(more) => length += more,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(length)
}

/// How the bytes are to be read.
#[derive(Clone, Copy)]
pub(super) struct TextEncoding {
    pub(super) encoding: &'static Encoding,
    /// Someone said so.
    pub(super) declared: bool,
}

impl TextEncoding {
    pub(super) const UTF_8: Self = Self { encoding: UTF_8, declared: false };

    /// By its name, as someone declared it.
    pub(super) fn named(name: &str) -> Result<Self, ReadError> {
        let encoding = Encoding::for_label(name.trim().as_bytes())
            .ok_or_else(|| ReadError::UnknownEncoding { name: name.to_owned() })?;
        Ok(Self { encoding, declared: true })
    }
}

/// A file's text in UTF-8: what is read from it is valid, lines are counted on the way, and no
/// record is longer than allowed.
///
/// What is wrong with the file reaches parsers as an I/O error; [`TextReader::error`] says it.
pub(super) struct TextReader<'a> {
    file: &'a Path,
    input: Box<dyn Read + 'a>,
    encoding: TextEncoding,
    decoder: Decoder,
    block: Vec<u8>,
    /// What of the block is not decoded yet.
    rest: std::ops::Range<usize>,
    /// Bytes of the file before the block.
    before_block: u64,
    /// The block is the file's last.
    last: bool,
    /// Nothing is left to decode.
    done: bool,
    text: Vec<u8>,
    /// What of the text is not taken yet.
    ready: std::ops::Range<usize>,
    line: usize,
    column: usize,
    allowed: u64,
    failure: Option<ReadError>,
}

impl<'a> TextReader<'a> {
    fn new(input: &'a Input<'a>, mut encoding: TextEncoding) -> Result<Self, ReadError> {
        let mut bytes = input.open()?;
        let mut block = vec![0; BLOCK];
        let length = fill(&mut *bytes, &mut block).map_err(|source| input.io(source))?;
        let mut mark = 0;
        if let Some((by_mark, length)) = Encoding::for_bom(&block[..length]) {
            (encoding.encoding, mark) = (by_mark, length);
        }
        Ok(Self {
            file: input.path,
            decoder: encoding.encoding.new_decoder_without_bom_handling(),
            encoding,
            input: bytes,
            last: length < block.len(),
            block,
            rest: mark..length,
            before_block: 0,
            done: false,
            text: vec![0; BLOCK],
            ready: 0..0,
            line: 1,
            column: 0,
            allowed: MAX_RECORD,
            failure: None,
        })
    }

    /// Line, from 1, of the text that comes next.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// Bytes of the line that were taken already.
    pub(super) fn column(&self) -> usize {
        self.column
    }

    /// A new record begins.
    pub(super) fn begin_record(&mut self) {
        self.allowed = MAX_RECORD;
    }

    /// Why reading failed: what is wrong with the file, else what the parser says.
    pub(super) fn error(&mut self, otherwise: impl FnOnce(&Path, usize) -> ReadError) -> ReadError {
        self.failure.take().unwrap_or_else(|| otherwise(self.file, self.line))
    }

    fn fail(&mut self, error: ReadError) -> io::Error {
        self.failure = Some(error);
        io::Error::other("the file's text cannot be read")
    }

    /// Fills the empty text; leaves it empty at the end of the file.
    fn decode(&mut self) -> io::Result<()> {
        while self.ready.is_empty() && !self.done {
            if self.rest.is_empty() && !self.last {
                self.before_block += self.rest.end as u64;
                if self.before_block > MAX_BYTES {
                    let (file, limit_bytes) = (self.file.to_owned(), MAX_BYTES);
                    return Err(self.fail(ReadError::TooLarge { file, limit_bytes }));
                }
                let length = fill(&mut *self.input, &mut self.block)?;
                (self.rest, self.last) = (0..length, length < self.block.len());
            }
            let (result, read, written) = self.decoder.decode_to_utf8_without_replacement(
                &self.block[self.rest.clone()],
                &mut self.text,
                self.last,
            );
            self.rest.start += read;
            self.ready = 0..written;
            match result {
                DecoderResult::InputEmpty => self.done = self.last,
                DecoderResult::OutputFull => {}
                DecoderResult::Malformed(length, after) => {
                    let back = usize::from(length) + usize::from(after);
                    self.done = true;
                    self.failure = Some(self.wrong_byte(self.rest.start.saturating_sub(back)));
                }
            }
        }
        match self.failure.is_some() && self.ready.is_empty() {
            true => Err(io::Error::other("the file's text cannot be read")),
            false => Ok(()),
        }
    }

    fn wrong_byte(&self, at: usize) -> ReadError {
        let unread = &self.text[self.ready.clone()];
        ReadError::Encoding {
            file: self.file.to_owned(),
            line: self.line + line_ends(unread),
            byte: self.before_block as usize + at + 1,
            value: self.block.get(at).copied().unwrap_or_default(),
            encoding: self.encoding.encoding.name().to_owned(),
            hint: match self.encoding.declared {
                true => "another encoding was declared than the file has",
                false => "save it as UTF-8 or declare its encoding, often --encoding windows-1252",
            },
        }
    }
}

fn line_ends(text: &[u8]) -> usize {
    text.iter().filter(|&&b| b == b'\n').count()
}

impl BufRead for TextReader<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.ready.is_empty() {
            self.decode()?;
        }
        if self.allowed == 0 && !self.ready.is_empty() {
            let (file, line, limit_bytes) = (self.file.to_owned(), self.line, MAX_RECORD);
            return Err(self.fail(ReadError::TooLong { file, line, limit_bytes }));
        }
        let length = self.ready.len().min(usize::try_from(self.allowed).unwrap_or(usize::MAX));
        Ok(&self.text[self.ready.start..self.ready.start + length])
    }

    fn consume(&mut self, amount: usize) {
        let amount = amount.min(self.ready.len());
        let taken = &self.text[self.ready.start..self.ready.start + amount];
        match taken.iter().rposition(|&b| b == b'\n') {
            Some(last) => {
                self.line += line_ends(taken);
                self.column = amount - last - 1;
            }
            None => self.column += amount,
        }
        self.ready.start += amount;
        self.allowed = self.allowed.saturating_sub(amount as u64);
    }
}

impl Read for TextReader<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let ready = self.fill_buf()?;
        let length = ready.len().min(buffer.len());
        buffer[..length].copy_from_slice(&ready[..length]);
        self.consume(length);
        Ok(length)
    }
}
