//! topout JSON.
//!
//! Values are taken as raw slices of the text: where a slice lies gives its line, and fields that
//! topout does not know keep exactly the text they had.

use super::text::Lines;
use super::{Collected, DateReader, Place, ReadError, Texts};
use crate::Severity;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use std::fmt;
use std::path::Path;

/// The `format` of topout JSON.
pub const FORMAT: &str = "4d-schedule";

/// Reads one file into `all`.
pub(super) fn read(
    path: &Path,
    text: &str,
    dates: &DateReader,
    all: &mut Collected,
) -> Result<(), ReadError> {
    let mut lines = Lines::new(text);
    let mut top: Object = serde_json::from_str(text).map_err(|error| ReadError::Json {
        file: path.to_owned(),
        line: error.line(),
        column: error.column(),
        reason: without_place(&error),
    })?;
    let refuse = |lines: &mut Lines, offset: usize, reason: String| {
        let (line, column) = lines.at(offset);
        ReadError::Json { file: path.to_owned(), line, column, reason }
    };

    let activities = top.take(&["activities"]).ok_or_else(|| {
        let offset = text.find('{').unwrap_or_default();
        refuse(&mut lines, offset, "there is no list \"activities\"".to_owned())
    })?;
    let activities: Vec<&RawValue> = serde_json::from_str(activities.get()).map_err(|_| {
        let reason = format!("\"activities\" is {}, not a list", kind_of(activities));
        refuse(&mut Lines::new(text), offset_in(text, activities), reason)
    })?;
    read_project(&mut top, &lines, dates, all);

    if activities.is_empty() {
        all.empty_files.push(all.current_file());
    }
    for (i, raw) in activities.into_iter().enumerate() {
        let (line, _) = lines.at(offset_in(text, raw));
        let place = Place::new(all.current_file(), line, i + 1);
        read_activity(raw, &lines, place, dates, all);
    }
    Ok(())
}

/// Everything but the activities.
fn read_project(top: &mut Object, lines: &Lines, dates: &DateReader, all: &mut Collected) {
    let mut value = |all: &mut Collected, names: &[&str]| {
        let raw = top.take(names)?;
        let (line, _) = lines.clone().at(offset_in(lines.text, raw));
        let place = all.line(line);
        let text = match scalar(raw) {
            Ok(text) => text?,
            Err(reason) => {
                wrong_type(all, place, names[0], names[0], &reason);
                return None;
            }
        };
        Some((text, place))
    };
    let format = value(all, &["format"]).filter(|(format, _)| format != FORMAT);
    let version = value(all, &["version"]).filter(|(version, _)| version != "1");
    let project = value(all, &["project"]);
    let start = value(all, &["start"]);
    let end = value(all, &["end", "finish"]);

    for (what, (text, place)) in
        [("format", format), ("version", version)].into_iter().filter_map(|(w, v)| Some((w, v?)))
    {
        let message = format!(
            "{}: {what} is {text:?}; read as version 1 of {FORMAT:?} all the same",
            all.sources.describe(place)
        );
        all.diagnostics.add(Severity::Warning, "unknown-format", text, || message);
    }
    if let Some((project, _)) = project
        && all.project.is_empty()
    {
        all.project = project;
    }
    let start = start.and_then(|(t, place)| all.date(dates.start(&t), "project start", "", place));
    let end = end.and_then(|(t, place)| all.date(dates.end(&t), "project end", "", place));
    all.extend_period(start, end);
    all.fields.extend(top.0.drain(..).map(|(name, raw)| (name, field_text(raw))));
}

/// One member of the list. A value of a wrong type is reported and counts as not given.
fn read_activity(
    raw: &RawValue,
    lines: &Lines,
    place: Place,
    dates: &DateReader,
    all: &mut Collected,
) {
    let Ok(mut object) = serde_json::from_str::<Object>(raw.get()) else {
        let subject = format!("activity {}", place.number);
        wrong_type(all, place, &subject, &subject, &format!("{}, not an object", kind_of(raw)));
        return;
    };
    let mut texts = Texts::default();
    let mut value = |all: &mut Collected, id: &str, names: &[&str]| -> Option<String> {
        let raw = object.take(names)?;
        scalar(raw).unwrap_or_else(|reason| {
            let (line, _) = lines.clone().at(offset_in(lines.text, raw));
            let subject = if id.is_empty() { names[0] } else { id };
            wrong_type(all, place.on_line(line), subject, names[0], &reason);
            texts.reported |= matches!(names[0], "start" | "end");
            None
        })
    };
    let id = value(all, "", &["id", "activity_id"]).unwrap_or_default();
    let name = value(all, &id, &["name"]).unwrap_or_default();
    let start = value(all, &id, &["start"]);
    let end = value(all, &id, &["end", "finish"]);
    let kind = value(all, &id, &["kind"]);
    let active = value(all, &id, &["active"]);
    let elements = match object.take(&["elements"]) {
        Some(raw) => elements(raw, lines, place, &id, all),
        None => Vec::new(),
    };
    let fields = object.0.into_iter().map(|(name, raw)| (name, field_text(raw))).collect();
    let texts = Texts { id, name, start, end, kind, active, elements, fields, ..texts };
    all.add_activity(texts, dates, place);
}

fn elements(
    raw: &RawValue,
    lines: &Lines,
    place: Place,
    id: &str,
    all: &mut Collected,
) -> Vec<String> {
    let list: Result<Option<Vec<&RawValue>>, _> = serde_json::from_str(raw.get());
    let mut report = |raw: &RawValue, reason: &str| {
        let (line, _) = lines.clone().at(offset_in(lines.text, raw));
        wrong_type(all, place.on_line(line), id, "elements", reason);
    };
    let Ok(list) = list else {
        report(raw, &format!("{}, not a list", kind_of(raw)));
        return Vec::new();
    };
    let mut names = Vec::new();
    for raw in list.into_iter().flatten() {
        match scalar(raw) {
            Ok(name) => names.extend(name),
            Err(reason) => report(raw, &reason),
        }
    }
    names
}

fn wrong_type(all: &mut Collected, place: Place, subject: &str, what: &str, reason: &str) {
    let message = format!("{}: {what} of {subject:?} is {reason}", all.sources.describe(place));
    all.diagnostics.add(Severity::Error, "wrong-type", subject, || message);
}

/// A JSON object as slices of the text, in the text's order, repeated names included.
struct Object<'a>(Vec<(String, &'a RawValue)>);

impl<'a> Object<'a> {
    /// Removes and returns the value of the first of these names that occurs.
    fn take(&mut self, names: &[&str]) -> Option<&'a RawValue> {
        let at = names.iter().find_map(|name| self.0.iter().position(|(n, _)| n == name))?;
        Some(self.0.remove(at).1)
    }
}

impl<'de> Deserialize<'de> for Object<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Members;
        impl<'de> Visitor<'de> for Members {
            type Value = Object<'de>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut members = Vec::new();
                while let Some(member) = map.next_entry::<String, &RawValue>()? {
                    members.push(member);
                }
                Ok(Object(members))
            }
        }
        deserializer.deserialize_map(Members)
    }
}

/// The text of a string, number or truth value; `None` for null. Fails with what it is instead.
fn scalar(raw: &RawValue) -> Result<Option<String>, String> {
    match raw.get().as_bytes().first() {
        Some(b'"') => serde_json::from_str(raw.get())
            .map(Some)
            .map_err(|error| format!("not a text: {}", without_place(&error))),
        Some(b'n') => Ok(None),
        Some(b'{' | b'[') => Err(format!("{}, not a text", kind_of(raw))),
        _ => Ok(Some(raw.get().to_owned())),
    }
}

/// What a field says: a text as it is, null as nothing, anything else as it was written.
fn field_text(raw: &RawValue) -> String {
    match scalar(raw) {
        Ok(text) => text.unwrap_or_default(),
        Err(_) => raw.get().to_owned(),
    }
}

fn kind_of(raw: &RawValue) -> &'static str {
    match raw.get().as_bytes().first() {
        Some(b'"') => "a text",
        Some(b'{') => "an object",
        Some(b'[') => "a list",
        Some(b't' | b'f') => "true or false",
        Some(b'n') => "null",
        _ => "a number",
    }
}

/// serde_json ends its messages with the place, which stands elsewhere in ours.
fn without_place(error: &serde_json::Error) -> String {
    let message = error.to_string();
    let end = message.rfind(" at line ").unwrap_or(message.len());
    message[..end].to_owned()
}

/// Where a slice of the text begins.
fn offset_in(text: &str, slice: &RawValue) -> usize {
    (slice.get().as_ptr() as usize).saturating_sub(text.as_ptr() as usize)
}
