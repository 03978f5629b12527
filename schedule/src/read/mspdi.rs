//! Microsoft Project's XML (MSPDI), as written by versions 2003 to 2021 and by other programs.
//!
//! Tasks that others stand below become nodes of the outline, all others activities. An activity's
//! id is the task's UID, which stays when rows are moved.

use super::collected::{Collected, truth};
use super::error::ReadError;
use super::mspdi_calendar::Calendars;
use super::tasklinks::{Target, TaskLinks, duration_seconds, whole_seconds};
use super::xml::{Step, Xml};
use crate::sources::Place;
use crate::{Activity, DateSet, Dates, Lag, LinkKind, Severity, WbsNode};
use std::collections::HashMap;
use std::sync::Arc;

/// Parts of a task that are kept as fields under the same name.
const KEPT: [&str; 13] = [
    "ID",
    "GUID",
    "WBS",
    "Duration",
    "Critical",
    "ConstraintType",
    "ConstraintDate",
    "Deadline",
    "Priority",
    "Contact",
    "Work",
    "Cost",
    "Notes",
];

/// Parts of the project that are kept as fields under the same name.
const KEPT_OF_PROJECT: [&str; 8] =
    ["Title", "Subject", "Company", "Manager", "Author", "StartDate", "FinishDate", "CreationDate"];

pub(super) fn read(xml: &mut Xml, all: &mut Collected) -> Result<(), ReadError> {
    let mut reader = Mspdi { calendars: Calendars::new(all), ..Mspdi::default() };
    loop {
        match xml.next()? {
            Step::Open => reader.open(xml, all),
            Step::Close => reader.close(xml, all),
            Step::End => break,
        }
    }
    reader.finish(all);
    Ok(())
}

#[derive(Default)]
struct Mspdi {
    calendars: Calendars,
    project_name: String,
    /// Names of user fields by their ids, and values by field and value id.
    field_names: HashMap<Box<str>, Arc<str>>,
    values: HashMap<(Box<str>, Box<str>), Box<str>>,
    definition: Definition,
    task: Task,
    /// The task before, about which the next one tells whether it is a summary.
    waiting: Option<Task>,
    /// Summaries that may hold the next task: outline level and node.
    above: Vec<(u32, u32)>,
    links: TaskLinks,
    targets: HashMap<u32, Target>,
    /// Lags in percent of what the predecessor takes.
    percent_lags: Vec<PercentLag>,
    /// What tasks take in seconds of working time, where some lag may need it.
    durations: HashMap<u32, i64>,
}

/// A user field, or one of the values that it may have.
#[derive(Default)]
struct Definition {
    field: String,
    name: String,
    alias: String,
    value_id: String,
    value: String,
}

#[derive(Default)]
struct Task {
    activity: Activity,
    place: Option<Place>,
    bad_dates: bool,
    level: u32,
    summary: bool,
    blank: bool,
    calendar: String,
    duration_seconds: i64,
    baseline_number: String,
    baseline: Dates,
    /// Field id and value (or value id) of the user field that is being read.
    user_field: (String, String),
    link: Link,
    links: Vec<Link>,
}

#[derive(Clone, Default)]
struct Link {
    predecessor: String,
    kind: LinkKind,
    /// Tenths of a minute, or percent.
    lag: f64,
    format: u32,
}

struct PercentLag {
    link: usize,
    predecessor: u32,
    percent: f64,
}

impl Mspdi {
    fn open(&mut self, xml: &Xml, all: &mut Collected) {
        match (xml.name(), xml.parent()) {
            (b"Task", b"Tasks") => {
                // Its number is known only when it is known whether those before are summaries.
                let place = Some(all.line(xml.line()));
                self.task = Task { place, level: 1, ..Task::default() };
            }
            (b"PredecessorLink", b"Task") => self.task.link = Link::default(),
            (b"Baseline", b"Task") => {
                self.task.baseline_number.clear();
                self.task.baseline = Dates::default();
            }
            (b"ExtendedAttribute" | b"OutlineCode", b"Task") => {
                self.task.user_field = Default::default();
            }
            (b"ExtendedAttribute" | b"OutlineCode", _) => self.definition = Definition::default(),
            (b"Value", b"ValueList" | b"Values") => {
                self.definition.value_id.clear();
                self.definition.value.clear();
            }
            _ => self.calendars.open(xml),
        }
    }

    fn close(&mut self, xml: &Xml, all: &mut Collected) {
        match xml.parent() {
            b"Task" if xml.ancestor(2) == b"Tasks" => self.part_of_task(xml, all),
            b"PredecessorLink" => self.task.link.part(xml),
            b"Baseline" if xml.ancestor(2) == b"Task" => self.part_of_baseline(xml, all),
            b"ExtendedAttribute" | b"OutlineCode" if xml.ancestor(2) == b"Task" => {
                match xml.name() {
                    b"FieldID" => xml.text().clone_into(&mut self.task.user_field.0),
                    b"Value" | b"ValueID" if !xml.text().is_empty() => {
                        xml.text().clone_into(&mut self.task.user_field.1);
                    }
                    _ => {}
                }
            }
            b"ExtendedAttribute" | b"OutlineCode" => self.part_of_definition(xml),
            b"Value" => match xml.name() {
                b"ID" | b"ValueID" => xml.text().clone_into(&mut self.definition.value_id),
                b"Value" => xml.text().clone_into(&mut self.definition.value),
                _ => {}
            },
            b"ValueList" | b"Values" => {
                let Definition { field, value_id, value, .. } = &self.definition;
                let key = (field.as_str().into(), value_id.as_str().into());
                self.values.insert(key, value.as_str().into());
            }
            b"ExtendedAttributes" | b"OutlineCodes" if xml.ancestor(2) == b"Project" => {
                let Definition { field, name, alias, .. } = &self.definition;
                let name = all.name(if alias.is_empty() { name } else { alias });
                self.field_names.insert(field.as_str().into(), name);
            }
            b"Tasks" if xml.name() == b"Task" => {
                let task = std::mem::take(&mut self.task);
                self.add(task, all);
            }
            b"Project" => self.part_of_project(xml, all),
            _ => self.calendars.close(xml, all),
        }
    }

    fn part_of_project(&mut self, xml: &Xml, all: &mut Collected) {
        let place = all.line(xml.line());
        match xml.name() {
            b"Name" => xml.text().clone_into(&mut self.project_name),
            b"Title" if !xml.text().trim().is_empty() => {
                xml.text().clone_into(&mut self.project_name);
            }
            b"StatusDate" => {
                let date = all.civil_date(xml.text(), "status date", "", place);
                all.data_date = all.data_date.max(date);
            }
            b"CalendarUID" => self.calendars.default = xml.text().into(),
            _ => {}
        }
        let name = KEPT_OF_PROJECT.into_iter().find(|name| name.as_bytes() == xml.name());
        if let Some(name) = name.filter(|_| !xml.text().is_empty()) {
            let value = all.field_text(name, xml.text(), place);
            let name = all.name(name);
            all.fields.push((name, value));
        }
    }

    fn part_of_definition(&mut self, xml: &Xml) {
        let Definition { field, name, alias, .. } = &mut self.definition;
        match xml.name() {
            b"FieldID" => xml.text().clone_into(field),
            b"FieldName" => xml.text().clone_into(name),
            b"Alias" => xml.text().clone_into(alias),
            _ => {}
        }
    }

    fn part_of_baseline(&mut self, xml: &Xml, all: &mut Collected) {
        let task = &mut self.task;
        match xml.name() {
            b"Number" => xml.text().clone_into(&mut task.baseline_number),
            b"Start" => task.baseline.start = task.date(xml, "baseline start", all),
            b"Finish" => task.baseline.end = task.date(xml, "baseline finish", all),
            _ => {}
        }
    }

    fn part_of_task(&mut self, xml: &Xml, all: &mut Collected) {
        let (name, text, task) = (xml.name(), xml.text(), &mut self.task);
        match name {
            b"UID" => text.clone_into(&mut task.activity.id),
            b"Name" => text.clone_into(&mut task.activity.name),
            b"OutlineLevel" => task.level = text.trim().parse().unwrap_or(1),
            b"Summary" => task.summary = is_true(text),
            b"IsNull" => task.blank = is_true(text),
            b"Milestone" => task.activity.milestone = is_true(text),
            b"Active" => task.activity.active = truth(text.trim()).unwrap_or(true),
            b"CalendarUID" => text.clone_into(&mut task.calendar),
            b"Start" => {
                task.activity.date_sets[DateSet::Planned].start = task.date(xml, "start", all);
            }
            b"Finish" => {
                task.activity.date_sets[DateSet::Planned].end = task.date(xml, "finish", all);
            }
            b"ActualStart" => {
                task.activity.date_sets[DateSet::Actual].start =
                    task.date(xml, "actual start", all);
            }
            b"ActualFinish" => {
                task.activity.date_sets[DateSet::Actual].end = task.date(xml, "actual finish", all);
            }
            b"PercentComplete" if !text.trim().is_empty() => {
                let place = task.place.unwrap_or_else(|| all.line(xml.line()));
                task.activity.percent_complete = all.percent(text, &task.activity.id, place);
            }
            b"PredecessorLink" => task.links.push(task.link.clone()),
            // The first baseline is that of the project; the others are older states.
            b"Baseline" if matches!(task.baseline_number.trim(), "" | "0") => {
                task.activity.date_sets[DateSet::Baseline] = task.baseline;
            }
            b"ExtendedAttribute" | b"OutlineCode" => {
                let (field, value) = std::mem::take(&mut task.user_field);
                let (field, value) = (field.into_boxed_str(), value.into_boxed_str());
                let name = match self.field_names.get(&field) {
                    Some(name) => name.clone(),
                    None => all.name(&field),
                };
                let key = (field, value);
                let value = self.values.get(&key).cloned().unwrap_or(key.1);
                if !value.is_empty() {
                    task.activity.fields.push((name, value));
                }
                return;
            }
            b"Duration" => task.duration_seconds = duration_seconds(text).unwrap_or_default(),
            _ => {}
        }
        let kept = KEPT.into_iter().find(|kept| kept.as_bytes() == name);
        if let Some(kept) = kept.filter(|_| !text.is_empty()) {
            let place = task.place.unwrap_or_else(|| all.line(xml.line()));
            let value = all.field_text(kept, text, place);
            task.activity.fields.push((all.name(kept), value));
        }
    }

    /// Takes a task; the one before it is complete now.
    fn add(&mut self, task: Task, all: &mut Collected) {
        // Blank rows, and the row that stands for the project itself.
        if task.blank {
            return;
        }
        if task.level == 0 {
            if self.project_name.is_empty() {
                self.project_name = task.activity.name;
            }
            return;
        }
        let level = task.level;
        if let Some(mut before) = self.waiting.replace(task) {
            before.summary |= level > before.level;
            self.take(before, all);
        }
    }

    fn take(&mut self, mut task: Task, all: &mut Collected) {
        let Task { level, summary, .. } = task;
        let place = task.place.unwrap_or_else(|| all.line(1));
        let key = self.links.keys.of(&task.activity.id);
        self.above.retain(|&(above, _)| above < level);
        let parent = self.above.last().map(|&(_, node)| node);
        if summary {
            self.targets.insert(key, Target::Summary);
            if let Some(link) = task.links.first() {
                let (id, predecessor) = (&task.activity.id, &link.predecessor);
                all.report(Severity::Warning, "summary-link", id, place, || {
                    format!("the summary {id:?} follows {predecessor:?}; its links are left out")
                });
            }
            let code = task.activity.fields.iter().find(|(name, _)| &**name == "WBS");
            let code = code.map(|(_, code)| code.to_string()).unwrap_or_default();
            let node = u32::try_from(all.wbs.len()).unwrap_or(u32::MAX);
            all.wbs.push(WbsNode { code, name: task.activity.name, parent });
            self.above.push((level, node));
            return;
        }
        let index = all.activities.len();
        self.targets.entry(key).or_insert(Target::Activity(index as u32));
        if task.duration_seconds > 0 {
            self.durations.insert(key, task.duration_seconds);
        }
        for link in &task.links {
            let predecessor = self.links.keys.of(&link.predecessor);
            let number = self.links.add(index, predecessor, link.kind, link.lag());
            if link.is_percent() {
                let percent = link.lag;
                self.percent_lags.push(PercentLag { link: number, predecessor, percent });
            }
        }
        task.activity.wbs = parent;
        task.activity.calendar = self.calendars.number(&task.calendar);
        task.activity.choose_dates();
        task.activity.fields.shrink_to_fit();
        let place = all.next_place(place.line as usize);
        all.push(task.activity, place, task.bad_dates);
    }

    fn finish(mut self, all: &mut Collected) {
        if let Some(last) = self.waiting.take() {
            self.take(last, all);
        }
        all.name_project(&self.project_name);
        self.resolve_percent_lags();
        let Self { mut links, targets, calendars, .. } = self;
        links.attach_to(&targets, all);
        calendars.finish(all);
        all.end_schedule();
    }

    /// Percents are those of what the predecessor takes.
    fn resolve_percent_lags(&mut self) {
        for PercentLag { link, predecessor, percent } in std::mem::take(&mut self.percent_lags) {
            let duration = self.durations.get(&predecessor).copied().unwrap_or_default();
            let seconds = whole_seconds(duration as f64 * percent / 100.0);
            self.links.set_lag(link, seconds.unwrap_or_default());
        }
    }
}

impl Task {
    /// A date of the task that is being read.
    fn date(&mut self, xml: &Xml, what: &str, all: &mut Collected) -> Option<crate::Time> {
        let place = self.place.unwrap_or_else(|| all.line(xml.line()));
        // Project writes NA for no date.
        let text = Some(xml.text().trim()).filter(|t| !t.is_empty() && *t != "NA")?;
        let date = all.civil_date(text, what, &self.activity.id, place);
        self.bad_dates |= date.is_none();
        date
    }
}

impl Link {
    fn part(&mut self, xml: &Xml) {
        let text = xml.text().trim();
        match xml.name() {
            b"PredecessorUID" => text.clone_into(&mut self.predecessor),
            b"Type" => {
                self.kind = match text {
                    "0" => LinkKind::FinishFinish,
                    "2" => LinkKind::StartFinish,
                    "3" => LinkKind::StartStart,
                    _ => LinkKind::FinishStart,
                }
            }
            b"LinkLag" => self.lag = text.parse().unwrap_or_default(),
            b"LagFormat" => self.format = text.parse().unwrap_or_default(),
            _ => {}
        }
    }

    /// Formats from 35 on are those from 3 on, of what is estimated.
    fn format(&self) -> u32 {
        if self.format >= 35 { self.format - 32 } else { self.format }
    }

    fn is_percent(&self) -> bool {
        matches!(self.format(), 19 | 20)
    }

    fn lag(&self) -> Lag {
        let elapsed = matches!(self.format(), 4 | 6 | 8 | 10 | 12 | 20);
        let seconds = whole_seconds(self.lag * 6.0).unwrap_or_default();
        Lag { seconds: if self.is_percent() { 0 } else { seconds }, elapsed }
    }
}

fn is_true(text: &str) -> bool {
    !text.trim().is_empty() && truth(text.trim()) == Some(true)
}
