//! XML as planners' programs write it: elements within elements, and texts in the innermost ones.
//! Attributes and namespaces say nothing there and are passed over.

use super::error::ReadError;
use super::text::TextReader;
use quick_xml::Reader;
use quick_xml::events::Event;

/// Elements within each other; planners' programs need less than ten.
const MAX_DEPTH: usize = 64;

/// What comes next.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Step {
    /// The element [`Xml::name`] begins.
    Open,
    /// It ends; [`Xml::text`] is what it says, if no elements are in it.
    Close,
    /// The root element is over.
    End,
}

/// A document, element by element.
pub(super) struct Xml<'a> {
    reader: Reader<TextReader<'a>>,
    buffer: Vec<u8>,
    /// Names of the open elements, joined, and where each ends.
    names: Vec<u8>,
    ends: Vec<usize>,
    /// The innermost element closed; it goes with the next step.
    closing: bool,
    text: String,
}

impl<'a> Xml<'a> {
    pub(super) fn new(text: TextReader<'a>) -> Self {
        let mut reader = Reader::from_reader(text);
        reader.config_mut().expand_empty_elements = true;
        Self {
            reader,
            buffer: Vec::new(),
            names: Vec::new(),
            ends: Vec::new(),
            closing: false,
            text: String::new(),
        }
    }

    /// Goes into the root element and returns its name.
    pub(super) fn root(&mut self) -> Result<&[u8], ReadError> {
        match self.next()? {
            Step::Open => Ok(self.name()),
            _ => Err(self.malformed("there is no element in it".to_owned())),
        }
    }

    /// Line, from 1, of what comes next.
    pub(super) fn line(&self) -> usize {
        self.reader.get_ref().line()
    }

    /// The name of the innermost element, without a namespace.
    pub(super) fn name(&self) -> &[u8] {
        self.ancestor(0)
    }

    /// The name of the element around it.
    pub(super) fn parent(&self) -> &[u8] {
        self.ancestor(1)
    }

    /// The name of an element around it: 0 is itself; empty beyond the root.
    pub(super) fn ancestor(&self, up: usize) -> &[u8] {
        let Some(at) = self.ends.len().checked_sub(up + 1) else { return b"" };
        let start = at.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.names[start..self.ends[at]]
    }

    /// What the element that closes says.
    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// A refusal of the document at this place.
    pub(super) fn malformed(&mut self, reason: String) -> ReadError {
        let byte = self.reader.buffer_position();
        self.reader.get_mut().error(|file, line| ReadError::Malformed {
            file: file.to_owned(),
            line,
            reason: format!("byte {byte}: {reason}"),
        })
    }

    pub(super) fn next(&mut self) -> Result<Step, ReadError> {
        if std::mem::take(&mut self.closing) {
            self.ends.pop();
            self.names.truncate(self.ends.last().copied().unwrap_or_default());
            self.text.clear();
            if self.ends.is_empty() {
                return Ok(Step::End);
            }
        }
        loop {
            self.buffer.clear();
            self.reader.get_mut().begin_record();
            let event = match self.reader.read_event_into(&mut self.buffer) {
                Ok(event) => event,
                Err(error) => {
                    let reason = error.to_string();
                    return Err(self.malformed(reason));
                }
            };
            let refused = match event {
                Event::Start(tag) => {
                    self.names.extend_from_slice(tag.local_name().as_ref());
                    self.ends.push(self.names.len());
                    self.text.clear();
                    if self.ends.len() <= MAX_DEPTH {
                        return Ok(Step::Open);
                    }
                    format!("more than {MAX_DEPTH} elements within each other")
                }
                Event::End(_) => {
                    self.closing = true;
                    return Ok(Step::Close);
                }
                Event::Text(text) => match text.decode() {
                    Ok(text) => {
                        self.text.push_str(&text);
                        continue;
                    }
                    Err(error) => error.to_string(),
                },
                Event::CData(text) => match text.decode() {
                    Ok(text) => {
                        self.text.push_str(&text);
                        continue;
                    }
                    Err(error) => error.to_string(),
                },
                Event::GeneralRef(reference) => {
                    let name = String::from_utf8_lossy(&reference).into_owned();
                    match named_character(&name).or(reference.resolve_char_ref().ok().flatten()) {
                        Some(character) => {
                            self.text.push(character);
                            continue;
                        }
                        None => format!("the entity &{name}; is none of XML's own"),
                    }
                }
                Event::DocType(_) => "document types (DTD) are not read".to_owned(),
                Event::Eof => match self.ends.is_empty() {
                    true => return Ok(Step::End),
                    false => {
                        let name = String::from_utf8_lossy(self.name()).into_owned();
                        format!("the file ends within the element {name:?}")
                    }
                },
                Event::Empty(_) | Event::Comment(_) | Event::Decl(_) | Event::PI(_) => continue,
            };
            return Err(self.malformed(refused));
        }
    }
}

fn named_character(name: &str) -> Option<char> {
    Some(match name {
        "lt" => '<',
        "gt" => '>',
        "amp" => '&',
        "apos" => '\'',
        "quot" => '"',
        _ => return None,
    })
}

/// The encoding that an XML declaration names.
pub(super) fn declared_encoding(head: &str) -> Option<&str> {
    let declaration = head.strip_prefix("<?xml")?.split("?>").next()?;
    let value = declaration.split_once("encoding")?.1.trim_start().strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    let name = value[1..].split(quote).next()?;
    // A document that says UTF-16 and can be read up to here is not; its mark would say so.
    (!name.to_ascii_lowercase().starts_with("utf-16")).then_some(name)
}
