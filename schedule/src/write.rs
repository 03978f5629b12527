//! Writing topout JSON.

use crate::{Activity, FORMAT, Schedule, Time};
use serde_json::value::RawValue;
use std::io::{Error, ErrorKind, Result, Write};

impl Schedule {
    /// Writes topout JSON, one activity a line. Reading it gives the same project, period,
    /// activities and fields.
    ///
    /// # Errors
    /// Those of `out`, and `InvalidData` for a time outside the calendar.
    pub fn write_json(&self, mut out: impl Write) -> Result<()> {
        let out = &mut out;
        write!(out, "{{\"format\": {}, \"version\": 1", text(FORMAT)?)?;
        write!(out, ", \"project\": {}", text(&self.project)?)?;
        write!(out, ", \"start\": {}", date(Some(self.period.start))?)?;
        write!(out, ", \"end\": {}", date(Some(self.period.end))?)?;
        write!(out, ",\n \"activities\": [")?;
        for (i, activity) in self.activities.iter().enumerate() {
            out.write_all(if i == 0 { b"\n  " } else { b",\n  " })?;
            write_activity(out, activity)?;
        }
        out.write_all(b"]")?;
        write_fields(out, &self.fields)?;
        out.write_all(b"}\n")
    }
}

/// Every known name is written, null where there is no value, and before the fields: a field of the
/// same name or meaning (`finish`) is then not mistaken for it when the file is read.
fn write_activity(out: &mut impl Write, activity: &Activity) -> Result<()> {
    write!(out, "{{\"id\": {}, \"name\": {}", text(&activity.id)?, text(&activity.name)?)?;
    write!(out, ", \"start\": {}, \"end\": {}", date(activity.start)?, date(activity.end)?)?;
    write!(out, ", \"kind\": {}, \"active\": {}", text(activity.kind.word())?, activity.active)?;
    out.write_all(b", \"elements\": [")?;
    for (i, element) in activity.elements.iter().enumerate() {
        out.write_all(if i == 0 { b"" } else { b", " })?;
        serde_json::to_writer(&mut *out, element)?;
    }
    out.write_all(b"]")?;
    write_fields(out, &activity.fields)?;
    out.write_all(b"}")
}

fn write_fields(out: &mut impl Write, fields: &[(String, String)]) -> Result<()> {
    for (name, value) in fields {
        let value = if reads_as_written(value) { value.clone() } else { text(value)? };
        write!(out, ", {}: {value}", text(name)?)?;
    }
    Ok(())
}

/// Whether a field's text is JSON other than a text or null, and so came or could have come from
/// JSON as it is: numbers stay numbers.
fn reads_as_written(value: &str) -> bool {
    let begins = value.starts_with(|c: char| matches!(c, '-' | '0'..='9' | 't' | 'f' | '{' | '['));
    begins && serde_json::from_str::<&RawValue>(value).is_ok_and(|raw| raw.get() == value)
}

fn text(text: &str) -> Result<String> {
    Ok(serde_json::to_string(text)?)
}

fn date(time: Option<Time>) -> Result<String> {
    match time {
        None => Ok("null".to_owned()),
        Some(time) if time.civil().is_some() => Ok(format!("\"{time}\"")),
        Some(time) => {
            Err(Error::new(ErrorKind::InvalidData, format!("{time} is outside the calendar")))
        }
    }
}
