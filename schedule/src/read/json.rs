//! topout JSON.
//!
//! Values are taken as raw slices of the text: where a slice lies gives its line, and fields that
//! topout does not know keep exactly the text they had.

use super::collected::{Collected, Texts, truth};
use super::dates::DateReader;
use super::error::ReadError;
use super::json_project::Project;
use super::json_scan::{Chunk, Scan};
use super::read_predecessor;
use super::text::{Input, TextEncoding};
use crate::sources::Place;
use crate::{Activity, ElementField, Lag, LinkKind, Severity};
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use std::fmt;

/// The `format` of topout JSON.
pub const FORMAT: &str = "4d-schedule";

/// Members of an activity that hold the dates of its sets, in the order of [`crate::DateSet::WORDS`].
pub(crate) const SET_NAMES: [[&str; 2]; 4] = [
    ["planned_start", "planned_end"],
    ["actual_start", "actual_end"],
    ["baseline_start", "baseline_end"],
    ["forecast_start", "forecast_end"],
];

/// Reads one file into `all`.
pub(super) fn read(
    input: &Input,
    dates: &DateReader,
    all: &mut Collected,
) -> Result<(), ReadError> {
    let mut scan = Scan::new(input.text(TextEncoding::UTF_8)?);
    if scan.peek()? != Some(b'{') {
        let line_error = scan.error("invalid type: sequence, expected an object");
        if scan.peek()? == Some(b'[') {
            return Err(line_error);
        }
        let chunk = scan.value()?;
        return Err(match serde_json::from_str::<Object>(&chunk.text) {
            Err(error) => scan.refuse(&chunk, &error),
            Ok(_) => line_error,
        });
    }
    let no_list = scan.error("there is no list \"activities\"");
    scan.take(b'{')?;
    let mut project = Project::new(all);
    let mut listed = false;
    let mut first = true;
    while scan.another(first, b'}')? {
        first = false;
        let name = scan.value()?;
        let text: String =
            serde_json::from_str(&name.text).map_err(|error| scan.refuse(&name, &error))?;
        if !scan.take(b':')? {
            return Err(scan.error("expected `:`"));
        }
        let is_list = text == "activities" && !listed;
        if is_list && scan.peek()? == Some(b'[') {
            listed = true;
            read_list(&mut scan, dates, all)?;
            continue;
        }
        let value = scan.value()?;
        let raw: &RawValue =
            serde_json::from_str(&value.text).map_err(|error| scan.refuse(&value, &error))?;
        if is_list {
            let reason = format!("\"activities\" is {}, not a list", kind_of(raw));
            let (line, column) = (value.line, value.column + 1);
            return Err(ReadError::Json { file: input.path.to_owned(), line, column, reason });
        }
        project.add(text, value).map_err(|reason| scan.error(reason))?;
    }
    if scan.peek()?.is_some() {
        return Err(scan.error("trailing characters"));
    }
    if !listed {
        return Err(no_list);
    }
    project.read(dates, all);
    all.end_schedule();
    Ok(())
}

fn read_list(scan: &mut Scan, dates: &DateReader, all: &mut Collected) -> Result<(), ReadError> {
    scan.take(b'[')?;
    let mut number = 0;
    while scan.another(number == 0, b']')? {
        number += 1;
        let chunk = scan.value()?;
        let place = Place::new(all.current_file(), chunk.line, number);
        match serde_json::from_str::<Object>(&chunk.text) {
            Ok(object) => read_activity(object, &chunk, place, dates, all),
            Err(error) if error.is_data() => {
                let subject = format!("activity {number}");
                let kind = serde_json::from_str(&chunk.text).map_or("something else", kind_of);
                wrong_type(all, place, &subject, &subject, &format!("{kind}, not an object"));
            }
            Err(error) => return Err(scan.refuse(&chunk, &error)),
        }
    }
    Ok(())
}

/// One member of the list. A value of a wrong type is reported and counts as not given.
fn read_activity(
    mut object: Object,
    chunk: &Chunk,
    place: Place,
    dates: &DateReader,
    all: &mut Collected,
) {
    let mut texts = Texts::default();
    let at = |raw: &RawValue| place.on_line(chunk.line_of(offset_in(&chunk.text, raw)));
    let mut value = |all: &mut Collected, object: &mut Object, id: &str, names: &[&str]| {
        let raw = object.take(names)?;
        scalar(raw).unwrap_or_else(|reason| {
            let subject = if id.is_empty() { names[0] } else { id };
            wrong_type(all, at(raw), subject, names[0], &reason);
            texts.reported |= matches!(names[0], "start" | "end");
            None
        })
    };
    let id = value(all, &mut object, "", &["id", "activity_id"]).unwrap_or_default();
    let name = value(all, &mut object, &id, &["name"]).unwrap_or_default();
    let choose = !object.0.iter().any(|(n, _)| ["start", "end", "finish"].contains(&n.as_str()));
    let start = value(all, &mut object, &id, &["start"]);
    let end = value(all, &mut object, &id, &["end", "finish"]);
    let kind = value(all, &mut object, &id, &["kind"]);
    let active = value(all, &mut object, &id, &["active"]);
    texts = Texts { start, end, kind, active, choose, ..texts };
    for (set, names) in texts.sets.iter_mut().zip(SET_NAMES) {
        for (date, name) in set.iter_mut().zip(names) {
            *date = object.take_text(name, |raw| raw.starts_with('"'));
        }
    }
    texts.percent_complete = object.take_text("percent_complete", is_number);
    texts.milestone = object.take_text("milestone", |raw| truth(raw).is_some());
    let mut number = |name| object.take_text(name, |n| n.parse::<u32>().is_ok())?.parse().ok();
    let (wbs, calendar) = (number("wbs"), number("calendar"));
    let elements = match object.take(&["elements"]) {
        Some(raw) => elements(raw, &at, &id, all),
        None => Vec::new(),
    };
    let element_fields = match object.take_if("element_fields", |raw| raw.starts_with('[')) {
        Some(raw) => element_fields(raw, &at, &id, all),
        None => Vec::new(),
    };
    if let Some(raw) = object.take_if("predecessors", |raw| raw.starts_with('[')) {
        predecessors(raw, &at, &id, all);
    }
    let mut fields = Vec::with_capacity(object.0.len());
    for (name, raw) in object.0 {
        let value = all.field_text(&name, &field_text(raw), at(raw));
        fields.push((all.name(&name), value));
    }
    let activity = Activity {
        id,
        name,
        wbs,
        calendar,
        elements,
        element_fields,
        fields,
        ..Activity::default()
    };
    all.push_texts(activity, texts, dates, place);
}

fn is_number(raw: &str) -> bool {
    raw.starts_with(|c: char| c == '-' || c.is_ascii_digit())
}

fn elements(
    raw: &RawValue,
    at: &impl Fn(&RawValue) -> Place,
    id: &str,
    all: &mut Collected,
) -> Vec<String> {
    let list: Result<Option<Vec<&RawValue>>, _> = serde_json::from_str(raw.get());
    let Ok(list) = list else {
        wrong_type(all, at(raw), id, "elements", &format!("{}, not a list", kind_of(raw)));
        return Vec::new();
    };
    let mut names = Vec::with_capacity(list.as_ref().map_or(0, Vec::len));
    for raw in list.into_iter().flatten() {
        match scalar(raw) {
            // What is no name is left out later, with what element fields say of it.
            Ok(name) => names.push(name.unwrap_or_default()),
            Err(reason) => {
                wrong_type(all, at(raw), id, "elements", &reason);
                names.push(String::new());
            }
        }
    }
    names
}

/// What is said of single elements: names, each with a value an element.
fn element_fields(
    raw: &RawValue,
    at: &impl Fn(&RawValue) -> Place,
    id: &str,
    all: &mut Collected,
) -> Vec<ElementField> {
    let list: Vec<&RawValue> = serde_json::from_str(raw.get()).unwrap_or_default();
    let mut fields = Vec::with_capacity(list.len());
    for raw in list {
        let parts = serde_json::from_str::<Object>(raw.get()).ok().and_then(|mut object| {
            let name = scalar(object.take(&["name"])?).ok()??;
            let values = object.take(&["values"])?;
            Some((name, serde_json::from_str::<Vec<&RawValue>>(values.get()).ok()?))
        });
        let Some((name, values)) = parts else {
            let reason = format!("{}, not a name with a list of values", kind_of(raw));
            wrong_type(all, at(raw), id, "element_fields", &reason);
            continue;
        };
        let values = values.into_iter().map(|raw| {
            let text = all.field_text(&name, &field_text(raw), at(raw));
            all.name(&text)
        });
        let values = values.collect();
        fields.push(ElementField { name: all.name(&name), values });
    }
    fields
}

/// What the next activity waits for: ids with kind and lag as objects or as texts.
fn predecessors(raw: &RawValue, at: &impl Fn(&RawValue) -> Place, id: &str, all: &mut Collected) {
    let list: Vec<&RawValue> = serde_json::from_str(raw.get()).unwrap_or_default();
    for raw in list {
        match predecessor(raw) {
            Some((other, kind, lag)) => {
                let key = all.task_links.keys.of(&other);
                all.task_links.add(all.activities.len(), key, kind, lag);
            }
            None => wrong_type(
                all,
                at(raw),
                id,
                "predecessors",
                &format!("{}, not an id with perhaps type, lag and elapsed", kind_of(raw)),
            ),
        }
    }
}

/// One predecessor, as an object or a text.
pub(super) fn predecessor(raw: &RawValue) -> Option<(String, LinkKind, Lag)> {
    let Ok(mut object) = serde_json::from_str::<Object>(raw.get()) else {
        let text = scalar(raw).ok()??;
        return read_predecessor(&text).map(|(id, kind, lag)| (id.to_owned(), kind, lag));
    };
    let id = scalar(object.take(&["id"])?).ok()??;
    let kind = match object.take(&["type"]) {
        Some(raw) => LinkKind::from_word(&scalar(raw).ok()??)?,
        None => LinkKind::default(),
    };
    let seconds = object.take(&["lag"]).map_or(Some(0), |raw| raw.get().parse().ok())?;
    let elapsed = object.take(&["elapsed"]).map_or(Some(false), |raw| raw.get().parse().ok())?;
    Some((id, kind, Lag { seconds, elapsed }))
}

pub(super) fn wrong_type(
    all: &mut Collected,
    place: Place,
    subject: &str,
    what: &str,
    reason: &str,
) {
    all.report(Severity::Error, "wrong-type", subject, place, || {
        format!("{what} of {subject:?} is {reason}")
    });
}

/// A JSON object as slices of the text, in the text's order, repeated names included.
pub(super) struct Object<'a>(Vec<(String, &'a RawValue)>);

impl<'a> Object<'a> {
    /// Removes and returns the value of the first of these names that occurs.
    fn take(&mut self, names: &[&str]) -> Option<&'a RawValue> {
        let at = names.iter().find_map(|name| self.0.iter().position(|(n, _)| n == name))?;
        Some(self.0.remove(at).1)
    }

    /// Removes the first value of this name if it is as wanted or null; else it stays as a field.
    /// Returns it unless it is null.
    fn take_if(&mut self, name: &str, wanted: impl Fn(&str) -> bool) -> Option<&'a RawValue> {
        let at = self.0.iter().position(|(n, _)| n == name)?;
        let text = self.0[at].1.get();
        if text != "null" && !wanted(text) {
            return None;
        }
        let raw = self.0.remove(at).1;
        (raw.get() != "null").then_some(raw)
    }

    fn take_text(&mut self, name: &str, wanted: impl Fn(&str) -> bool) -> Option<String> {
        scalar(self.take_if(name, wanted)?).ok()?
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
pub(super) fn scalar(raw: &RawValue) -> Result<Option<String>, String> {
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
pub(super) fn field_text(raw: &RawValue) -> String {
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
pub(super) fn without_place(error: &serde_json::Error) -> String {
    let message = error.to_string();
    let end = message.rfind(" at line ").unwrap_or(message.len());
    message[..end].to_owned()
}

/// Where a slice of the text begins.
pub(super) fn offset_in(text: &str, slice: &RawValue) -> usize {
    (slice.get().as_ptr() as usize).saturating_sub(text.as_ptr() as usize)
}
