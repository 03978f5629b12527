//! Writing topout JSON.

use crate::read::SET_NAMES;
use crate::{Activity, DateSet, FORMAT, Fields, Predecessor, Schedule, Time};
use serde_json::value::RawValue;
use std::io::{Error, ErrorKind, Result, Write};
use std::sync::Arc;

impl Schedule {
    /// Writes topout JSON, one activity a line. Reading it gives the same schedule.
    ///
    /// # Errors
    /// Those of `out`, and `InvalidData` for a time outside the calendar.
    pub fn write_json(&self, mut out: impl Write) -> Result<()> {
        let out = &mut out;
        write!(out, "{{\"format\": {}, \"version\": 1", text(FORMAT)?)?;
        write!(out, ", \"project\": {}", text(&self.project)?)?;
        write!(out, ", \"start\": {}", date(Some(self.period.start))?)?;
        write!(out, ", \"end\": {}", date(Some(self.period.end))?)?;
        let mut rest = Members { out, fields: &self.fields };
        rest.date("data_date", self.data_date)?;
        let kinds = self.kinds.to_write().map(|k| Ok(serde_json::to_string(k)?));
        rest.write("kinds", list(kinds)?)?;
        rest.write("calendar", self.calendar.map(|c| c.to_string()))?;
        let calendars = self.calendars.iter().map(|c| Ok(serde_json::to_string(c)?));
        rest.write("calendars", list(calendars)?)?;
        let nodes = self.wbs.iter().map(|node| {
            let parent = node.parent.map_or_else(String::new, |p| format!(", \"parent\": {p}"));
            let (code, name) = (text(&node.code)?, text(&node.name)?);
            Ok(format!("{{\"code\": {code}, \"name\": {name}{parent}}}"))
        });
        rest.write("wbs", list(nodes)?)?;
        write!(out, ",\n \"activities\": [")?;
        for (i, activity) in self.activities.iter().enumerate() {
            out.write_all(if i == 0 { b"\n  " } else { b",\n  " })?;
            self.write_activity(out, activity)?;
        }
        out.write_all(b"]")?;
        write_fields(out, &self.fields)?;
        out.write_all(b"}\n")
    }

    /// Known names are written before the fields, and null where there is no value but a field of
    /// the same name or meaning (`finish`): that is then not mistaken for it when the file is read.
    fn write_activity(&self, out: &mut impl Write, activity: &Activity) -> Result<()> {
        write!(out, "{{\"id\": {}, \"name\": {}", text(&activity.id)?, text(&activity.name)?)?;
        write!(out, ", \"start\": {}, \"end\": {}", date(activity.start)?, date(activity.end)?)?;
        write!(
            out,
            ", \"kind\": {}, \"active\": {}",
            text(&self.kinds.of(activity.kind).name)?,
            activity.active
        )?;
        let mut rest = Members { out: &mut *out, fields: &activity.fields };
        for ((_, set), names) in DateSet::WORDS.into_iter().zip(SET_NAMES) {
            let dates = activity.date_sets[set];
            for (name, time) in names.into_iter().zip([dates.start, dates.end]) {
                rest.date(name, time)?;
            }
        }
        rest.write("milestone", activity.milestone.then(|| "true".to_owned()))?;
        rest.write("percent_complete", activity.percent_complete.map(|p| p.to_string()))?;
        rest.write("wbs", activity.wbs.map(|n| n.to_string()))?;
        rest.write("calendar", activity.calendar.map(|c| c.to_string()))?;
        rest.write("predecessors", self.predecessors_as_json(&activity.predecessors)?)?;
        out.write_all(b", \"elements\": [")?;
        for (i, element) in activity.elements.iter().enumerate() {
            out.write_all(if i == 0 { b"" } else { b", " })?;
            serde_json::to_writer(&mut *out, element)?;
        }
        out.write_all(b"]")?;
        write_fields(out, &activity.fields)?;
        out.write_all(b"}")
    }

    pub(crate) fn predecessors_as_json(&self, links: &[Predecessor]) -> Result<Option<String>> {
        list(links.iter().filter_map(|link| {
            let id = &self.activities.get(link.activity as usize)?.id;
            let one = |id: String| {
                let (kind, lag) = (link.kind.word(), link.lag);
                let lag = match lag.seconds == 0 && !lag.elapsed {
                    true => String::new(),
                    false => format!(", \"lag\": {}, \"elapsed\": {}", lag.seconds, lag.elapsed),
                };
                format!("{{\"id\": {id}, \"type\": \"{kind}\"{lag}}}")
            };
            Some(text(id).map(one))
        }))
    }
}

/// Members that are left out where they have no value, unless a field would be taken for them.
struct Members<'a, W> {
    out: &'a mut W,
    fields: &'a Fields,
}

impl<W: Write> Members<'_, W> {
    /// A member that is no text: fields that are texts are not taken for it.
    fn write(&mut self, name: &str, value: Option<String>) -> Result<()> {
        let taken = |(n, v): &(Arc<str>, Box<str>)| **n == *name && reads_as_written(v);
        self.value_or_null(name, value, taken)
    }

    fn date(&mut self, name: &str, time: Option<Time>) -> Result<()> {
        let value = time.map(|time| date(Some(time))).transpose()?;
        self.value_or_null(name, value, |(n, _)| **n == *name)
    }

    fn value_or_null(
        &mut self,
        name: &str,
        value: Option<String>,
        taken: impl Fn(&(Arc<str>, Box<str>)) -> bool,
    ) -> Result<()> {
        match value {
            Some(value) => write!(self.out, ", \"{name}\": {value}"),
            None if self.fields.iter().any(taken) => write!(self.out, ", \"{name}\": null"),
            None => Ok(()),
        }
    }
}

/// A list, unless it is empty.
fn list(members: impl Iterator<Item = Result<String>>) -> Result<Option<String>> {
    let members: Vec<String> = members.collect::<Result<_>>()?;
    Ok((!members.is_empty()).then(|| format!("[{}]", members.join(", "))))
}

fn write_fields(out: &mut impl Write, fields: &Fields) -> Result<()> {
    for (name, value) in fields {
        let value = if reads_as_written(value) { value.to_string() } else { text(value)? };
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

pub(crate) fn text(text: &str) -> Result<String> {
    Ok(serde_json::to_string(text)?)
}

pub(crate) fn date(time: Option<Time>) -> Result<String> {
    match time {
        None => Ok("null".to_owned()),
        Some(time) if time.civil().is_some() => Ok(format!("\"{time}\"")),
        Some(time) => {
            Err(Error::new(ErrorKind::InvalidData, format!("{time} is outside the calendar")))
        }
    }
}
