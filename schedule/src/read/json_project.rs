//! What topout JSON says beside the activities.

use super::collected::Collected;
use super::dates::DateReader;
use super::json::{FORMAT, field_text, offset_in, scalar, without_place, wrong_type};
use super::json_scan::Chunk;
use crate::sources::Place;
use crate::{Activity, Calendar, Severity, WbsNode};
use serde::Deserialize;
use serde_json::value::RawValue;

/// All of it may take so many bytes; the outline of a large project takes a few millions.
const MAX_BYTES: usize = 64 << 20;

/// Everything but the activities.
pub(super) struct Project {
    members: Vec<(String, Chunk)>,
    bytes: usize,
    /// Summaries and calendars of the files before.
    outline: usize,
    calendars: usize,
}

impl Project {
    pub(super) fn new(all: &Collected) -> Self {
        let (outline, calendars) = (all.wbs.len(), all.calendars.len());
        Self { members: Vec::new(), bytes: 0, outline, calendars }
    }

    /// Takes a member; fails if they are too large together.
    pub(super) fn add(&mut self, name: String, value: Chunk) -> Result<(), String> {
        self.bytes += name.len() + value.text.len();
        self.members.push((name, value));
        match self.bytes > MAX_BYTES {
            true => Err(format!("more than {MAX_BYTES} bytes beside the activities")),
            false => Ok(()),
        }
    }

    fn take(&mut self, names: &[&str]) -> Option<Chunk> {
        let at = names.iter().find_map(|name| self.members.iter().position(|(n, _)| n == name))?;
        Some(self.members.remove(at).1)
    }

    /// The value of a member if it is what topout writes there or null; else it stays as a field.
    fn take_if(&mut self, name: &str, begins: &[u8]) -> Option<Chunk> {
        let (_, chunk) = self.members.iter().find(|(n, _)| n == name)?;
        let found = chunk.text.as_bytes().first().is_some_and(|b| *b == b'n' || begins.contains(b));
        if found { self.take(&[name]) } else { None }
    }

    /// The text of a member, and its place.
    fn text(&mut self, all: &mut Collected, names: &[&str]) -> Option<(String, Place)> {
        let chunk = self.take(names)?;
        let place = all.line(chunk.line);
        let raw: &RawValue = serde_json::from_str(&chunk.text).ok()?;
        match scalar(raw) {
            Ok(text) => Some((text?, place)),
            Err(reason) => {
                wrong_type(all, place, names[0], names[0], &reason);
                None
            }
        }
    }

    pub(super) fn read(mut self, dates: &DateReader, all: &mut Collected) {
        let format = self.text(all, &["format"]).filter(|(format, _)| format != FORMAT);
        let version = self.text(all, &["version"]).filter(|(version, _)| version != "1");
        for (what, (text, place)) in [("format", format), ("version", version)]
            .into_iter()
            .filter_map(|(w, v)| Some((w, v?)))
        {
            all.report(Severity::Warning, "unknown-format", &text, place, || {
                format!("{what} is {text:?}; read as version 1 of {FORMAT:?} all the same")
            });
        }
        if let Some((project, _)) = self.text(all, &["project"]) {
            all.name_project(&project);
        }
        let start = self.text(all, &["start"]);
        let start = start.and_then(|(t, p)| all.date(dates.start(&t), "project start", "", p));
        let end = self.text(all, &["end", "finish"]);
        let end = end.and_then(|(t, p)| all.date(dates.end(&t), "project end", "", p));
        all.extend_period(start, end);
        if let Some(chunk) = self.take_if("data_date", b"\"") {
            let text: Option<String> = serde_json::from_str(&chunk.text).ok().flatten();
            let place = all.line(chunk.line);
            let date = text.and_then(|t| all.date(dates.start(&t), "data date", "", place));
            all.data_date = all.data_date.max(date);
        }
        self.read_kinds(all);
        self.read_outline(all);
        self.read_calendars(all);
        for (name, chunk) in std::mem::take(&mut self.members) {
            if let Ok(raw) = serde_json::from_str::<&RawValue>(&chunk.text) {
                let value = all.field_text(&name, &field_text(raw), all.line(chunk.line));
                let name = all.name(&name);
                all.fields.push((name, value));
            }
        }
    }

    fn read_kinds(&mut self, all: &mut Collected) {
        let Some(chunk) = self.take_if("kinds", b"[") else { return };
        let raws: Option<Vec<&RawValue>> = serde_json::from_str(&chunk.text).ok().flatten();
        for raw in raws.into_iter().flatten() {
            let place = all.line(chunk.line_of(offset_in(&chunk.text, raw)));
            match serde_json::from_str(raw.get()) {
                Ok(kind) => {
                    all.kinds_in_file = true;
                    all.define_kind(kind, place);
                }
                Err(error) => wrong_type(all, place, "kinds", "a member", &without_place(&error)),
            }
        }
    }

    fn read_outline(&mut self, all: &mut Collected) {
        #[derive(Default, serde::Deserialize)]
        struct Node {
            #[serde(default)]
            code: String,
            #[serde(default)]
            name: String,
            parent: Option<u32>,
        }
        let base = self.outline as u32;
        let nodes = self.list::<Node>("wbs", all);
        for (i, node) in nodes.iter().flatten().enumerate() {
            let parent = node.parent.filter(|&p| (p as usize) < i).map(|p| p + base);
            all.wbs.push(WbsNode { code: node.code.clone(), name: node.name.clone(), parent });
        }
        renumber(all, "wbs", base, nodes.map(|n| n.len()), |activity| &mut activity.wbs);
    }

    fn read_calendars(&mut self, all: &mut Collected) {
        let base = self.calendars as u32;
        let calendars = self.list::<Calendar>("calendars", all);
        let count = calendars.as_ref().map(Vec::len);
        all.calendars.extend(calendars.into_iter().flatten());
        renumber(all, "calendar", base, count, |activity| &mut activity.calendar);
        let digits: &[u8] = if count.is_some() { b"0123456789" } else { b"" };
        if let Some(chunk) = self.take_if("calendar", digits)
            && let Ok(Some(number)) = serde_json::from_str::<Option<u32>>(&chunk.text)
            && all.calendar.is_none()
        {
            all.calendar = Some(number.saturating_add(base));
        }
    }

    /// A list of which members that are not what they should be are reported and left out, but keep
    /// their number.
    fn list<T: Default + for<'d> Deserialize<'d>>(
        &mut self,
        name: &str,
        all: &mut Collected,
    ) -> Option<Vec<T>> {
        let chunk = self.take_if(name, b"[")?;
        let raws: Vec<&RawValue> = serde_json::from_str::<Option<_>>(&chunk.text).ok()??;
        let mut read = |raw: &RawValue| {
            serde_json::from_str(raw.get()).unwrap_or_else(|error| {
                let place = all.line(chunk.line_of(offset_in(&chunk.text, raw)));
                wrong_type(all, place, name, "a member", &without_place(&error));
                T::default()
            })
        };
        Some(raws.into_iter().map(&mut read).collect())
    }
}

/// Numbers within a file become those of all. A file without a list of what they count has a field of
/// that name instead.
fn renumber(
    all: &mut Collected,
    name: &str,
    base: u32,
    count: Option<usize>,
    number: fn(&mut Activity) -> &mut Option<u32>,
) {
    let name = all.name(name);
    let from = all.before_file();
    for activity in &mut all.activities[from..] {
        let Some(local) = number(activity).take() else { continue };
        match count {
            None => activity.fields.push((name.clone(), local.to_string().into())),
            Some(count) if (local as usize) < count => *number(activity) = Some(local + base),
            Some(_) => *number(activity) = Some(u32::MAX),
        }
    }
}
