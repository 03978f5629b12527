//! IFC4: tasks, their times, nesting and sequence, and the products that they are assigned to. Geometry
//! is passed over.
//!
//! An activity's id is the task's GlobalId, and its elements are GlobalIds. A task that others nest in
//! is a node of the outline, too; it stays as a neutral activity, since it may have products and
//! sequences of its own. Forecast dates are IFC's early dates.

use super::collected::Collected;
use super::error::ReadError;
use super::step::{Statement, Statements, Value};
use super::tasklinks::{duration_seconds, parents_first};
use super::text::Input;
use crate::sources::Place;
use crate::{Activity, ActivityKind, DateSet, Lag, LinkKind, Predecessor, Severity, WbsNode};
use std::collections::{HashMap, HashSet};

/// What is read at all.
const WANTED: [&str; 10] = [
    "IFCTASK",
    "IFCTASKTIME",
    "IFCTASKTIMERECURRING",
    "IFCRELSEQUENCE",
    "IFCRELNESTS",
    "IFCRELASSIGNSTOPROCESS",
    "IFCRELASSIGNSTOPRODUCT",
    "IFCLAGTIME",
    "IFCPROJECT",
    "FILE_SCHEMA",
];

/// Attributes of a task and of its time that are kept as fields, by their number.
const KEPT: [(usize, &str); 6] = [
    (3, "Description"),
    (4, "ObjectType"),
    (5, "Identification"),
    (6, "LongDescription"),
    (7, "Status"),
    (12, "PredefinedType"),
];
const KEPT_OF_TIME: [(usize, &str); 3] =
    [(4, "ScheduleDuration"), (12, "TotalFloat"), (13, "IsCritical")];

pub(super) fn read(input: &Input, all: &mut Collected) -> Result<(), ReadError> {
    let mut ifc = Ifc::default();
    let mut statements = Statements::new(input)?;
    let wanted = |_: u64, name: &str| WANTED.contains(&name);
    while let Some(statement) = statements.next(wanted)? {
        ifc.take(statement, all);
    }
    if statements.cut {
        let file = all.sources.files.last().cloned().unwrap_or_default();
        all.report(Severity::Warning, "no-end", &file, all.line(1), || {
            "the file ends without END-ISO-10303-21: it may have been cut off".to_owned()
        });
    }
    ifc.keep_assignments_of_tasks();
    ifc.find_products(input)?;
    ifc.finish(all);
    Ok(())
}

#[derive(Default)]
struct Ifc {
    tasks: Vec<Task>,
    /// Indices of tasks by their numbers in the file.
    by_number: HashMap<u64, usize>,
    /// Not taken apart yet: that takes a fifth of the memory.
    times: HashMap<u64, Statement>,
    lags: HashMap<u64, Lag>,
    /// Child and parent.
    nests: Vec<(u64, u64)>,
    sequences: Vec<Sequence>,
    /// Task and product.
    assignments: Vec<(u64, u64)>,
    /// GlobalIds of products.
    products: HashMap<u64, String>,
}

struct Task {
    values: Vec<Value>,
    place: Place,
}

struct Sequence {
    predecessor: u64,
    successor: u64,
    lag: Option<u64>,
    kind: LinkKind,
}

impl Ifc {
    fn take(&mut self, statement: Statement, all: &mut Collected) {
        if matches!(statement.name.as_str(), "IFCTASKTIME" | "IFCTASKTIMERECURRING") {
            self.times.insert(statement.id, statement);
            return;
        }
        let place = all.line(statement.line);
        let Some(values) = values_of(&statement, all) else { return };
        let value = |at: usize| values.get(at).unwrap_or(&Value::Null);
        match statement.name.as_str() {
            "FILE_SCHEMA" => {
                let schema = match value(0) {
                    Value::List(names) => names.first().map_or("", Value::text),
                    other => other.text(),
                };
                if !schema.to_ascii_uppercase().starts_with("IFC4") {
                    all.report(Severity::Warning, "unknown-format", schema, place, || {
                        format!("the schema is {schema:?}; read as IFC4 all the same")
                    });
                }
            }
            "IFCPROJECT" => all.name_project(value(2).text()),
            "IFCTASK" => {
                self.by_number.entry(statement.id).or_insert(self.tasks.len());
                self.tasks.push(Task { values, place });
            }
            "IFCLAGTIME" => {
                let lag = value(3);
                let elapsed = value(4).text() == "ELAPSEDTIME";
                let seconds = duration_seconds(lag.text());
                if seconds.is_none() {
                    let id = format!("#{}", statement.id);
                    all.report(Severity::Warning, "unknown-lag", &id, place, || {
                        format!("the lag {id} is no duration; taken as none")
                    });
                }
                let seconds = seconds.unwrap_or_default();
                self.lags.insert(statement.id, Lag { seconds, elapsed });
            }
            "IFCRELNESTS" => {
                if let Some(parent) = value(4).reference() {
                    let children = value(5).references();
                    self.nests.extend(children.into_iter().map(|child| (child, parent)));
                }
            }
            "IFCRELSEQUENCE" => {
                if let (Some(predecessor), Some(successor)) =
                    (value(4).reference(), value(5).reference())
                {
                    let kind = match value(7).text() {
                        "START_START" => LinkKind::StartStart,
                        "FINISH_FINISH" => LinkKind::FinishFinish,
                        "START_FINISH" => LinkKind::StartFinish,
                        _ => LinkKind::FinishStart,
                    };
                    let lag = value(6).reference();
                    self.sequences.push(Sequence { predecessor, successor, lag, kind });
                }
            }
            "IFCRELASSIGNSTOPROCESS" => {
                let products = value(4).references().into_iter();
                let task = value(6).reference();
                self.assignments.extend(products.filter_map(|product| Some((task?, product))));
            }
            "IFCRELASSIGNSTOPRODUCT" => {
                let tasks = value(4).references().into_iter();
                let product = value(6).reference();
                self.assignments.extend(tasks.filter_map(|task| Some((task, product?))));
            }
            _ => {}
        }
    }

    fn keep_assignments_of_tasks(&mut self) {
        let Self { assignments, by_number, .. } = self;
        assignments.retain(|(task, product)| {
            by_number.contains_key(task) && !by_number.contains_key(product)
        });
    }

    /// Goes through the file once more for the GlobalIds of what tasks are assigned to, since these
    /// may be of any class and stand anywhere. Resources are no products.
    fn find_products(&mut self, input: &Input) -> Result<(), ReadError> {
        let needed: HashSet<u64> = self.assignments.iter().map(|&(_, product)| product).collect();
        if needed.is_empty() {
            return Ok(());
        }
        let mut statements = Statements::new(input)?;
        let wanted = |id: u64, name: &str| needed.contains(&id) && !name.ends_with("RESOURCE");
        while let Some(statement) = statements.next(wanted)? {
            let guid = statement.values().and_then(|values| values.into_iter().next());
            if let Some(Value::Text(guid)) = guid {
                self.products.insert(statement.id, guid);
            }
        }
        Ok(())
    }

    fn finish(mut self, all: &mut Collected) {
        let base = all.activities.len();
        let nodes = self.outline(all);
        for (i, task) in std::mem::take(&mut self.tasks).into_iter().enumerate() {
            let time = task.values.get(11).and_then(Value::reference);
            let time = time.and_then(|time| self.times.get(&time));
            let time = time.and_then(|time| values_of(time, all));
            add(task, time.as_deref(), nodes[i], all);
        }
        for (task, product) in &self.assignments {
            let (Some(&task), Some(guid)) = (self.by_number.get(task), self.products.get(product))
            else {
                continue;
            };
            all.activities[base + task].elements.push(guid.clone());
        }
        for sequence in &self.sequences {
            self.link(base, sequence, all);
        }
        all.end_schedule();
    }

    fn link(&self, base: usize, sequence: &Sequence, all: &mut Collected) {
        let Sequence { predecessor, successor, lag, kind } = *sequence;
        let Some(&task) = self.by_number.get(&successor) else {
            let id = format!("#{successor}");
            all.report(Severity::Warning, "unknown-successor", &id, all.line(1), || {
                format!("a sequence leads to {id}, which is no task; it is left out")
            });
            return;
        };
        let Some(&before) = self.by_number.get(&predecessor) else {
            let place = all.sources.activities[base + task].place;
            let id = all.activities[base + task].id.clone();
            all.report(Severity::Warning, "unknown-predecessor", &id, place, || {
                format!("activity {id:?} follows #{predecessor}, which is no task; left out")
            });
            return;
        };
        let lag = lag.and_then(|lag| self.lags.get(&lag).copied()).unwrap_or_default();
        let activity = u32::try_from(base + before).unwrap_or(u32::MAX);
        let link = Predecessor { activity, kind, lag };
        all.activities[base + task].predecessors.push(link);
    }

    /// Makes nodes of tasks that others nest in. For each task: the node that it is in (its own for
    /// a summary) and whether it is a summary.
    fn outline(&mut self, all: &mut Collected) -> Vec<(Option<u32>, bool)> {
        let mut parents = vec![None; self.tasks.len()];
        let mut is_summary = vec![false; self.tasks.len()];
        for (child, parent) in &self.nests {
            let (child, parent) = (self.by_number.get(child), self.by_number.get(parent));
            if let (Some(&child), Some(&parent)) = (child, parent)
                && child != parent
            {
                parents[child] = Some(parent);
                is_summary[parent] = true;
            }
        }
        let mut nodes: Vec<Option<u32>> = vec![None; self.tasks.len()];
        for i in parents_first(&parents) {
            let parent = parents[i].and_then(|parent| nodes[parent]);
            if !is_summary[i] {
                continue;
            }
            let text = |at: usize| self.tasks[i].values.get(at).map_or("", Value::text).to_owned();
            nodes[i] = u32::try_from(all.wbs.len()).ok();
            all.wbs.push(WbsNode { code: text(5), name: text(2), parent });
        }
        let node = |i: usize| nodes[i].or_else(|| nodes[parents[i]?]);
        (0..self.tasks.len()).map(|i| (node(i), is_summary[i])).collect()
    }
}

/// What a statement says; one that cannot be read is reported.
fn values_of(statement: &Statement, all: &mut Collected) -> Option<Vec<Value>> {
    let values = statement.values();
    if values.is_none() {
        let Statement { id, name, line, .. } = statement;
        all.report(Severity::Error, "bad-statement", name, all.line(*line), || {
            format!("#{id}={name} cannot be read; it is left out")
        });
    }
    values
}

fn add(
    task: Task,
    time: Option<&[Value]>,
    (wbs, is_summary): (Option<u32>, bool),
    all: &mut Collected,
) {
    let text = |values: &[Value], at: usize| values.get(at).map_or("", Value::text).to_owned();
    let place = all.next_place(task.place.line as usize);
    let (id, name) = (text(&task.values, 0), text(&task.values, 2));
    let mut activity = Activity { id, name, wbs, ..Activity::default() };
    activity.kind = match text(&task.values, 12).as_str() {
        _ if is_summary => ActivityKind::Neutral,
        "DEMOLITION" | "DISMANTLE" | "REMOVAL" | "DISPOSAL" => ActivityKind::Demolish,
        "ATTENDANCE" | "MAINTENANCE" | "OPERATION" => ActivityKind::Neutral,
        _ => ActivityKind::Construct,
    };
    activity.milestone = text(&task.values, 9) == "T";
    let mut bad_dates = false;
    let mut fields = Vec::new();
    keep(&mut fields, &task.values, &KEPT, place, all);
    if let Some(time) = time {
        let mut date = |at: usize, what: &str, all: &mut Collected| {
            let text = text(time, at);
            let date = all.civil_date(&text, what, &activity.id, place);
            bad_dates |= date.is_none() && !text.trim().is_empty();
            date
        };
        let sets = &mut activity.date_sets;
        sets[DateSet::Planned].start = date(5, "ScheduleStart", all);
        sets[DateSet::Planned].end = date(6, "ScheduleFinish", all);
        sets[DateSet::Forecast].start = date(7, "EarlyStart", all);
        sets[DateSet::Forecast].end = date(8, "EarlyFinish", all);
        sets[DateSet::Actual].start = date(16, "ActualStart", all);
        sets[DateSet::Actual].end = date(17, "ActualFinish", all);
        let status = date(14, "StatusTime", all);
        all.data_date = all.data_date.max(status);
        let done = time.get(19).and_then(Value::number);
        activity.percent_complete = done.map(|share| (share * 100.0).clamp(0.0, 100.0) as f32);
        keep(&mut fields, time, &KEPT_OF_TIME, place, all);
    }
    activity.fields = fields;
    activity.choose_dates();
    all.push(activity, place, bad_dates);
}

fn keep(
    fields: &mut crate::Fields,
    values: &[Value],
    kept: &[(usize, &str)],
    place: Place,
    all: &mut Collected,
) {
    for &(at, name) in kept {
        let text = values.get(at).map_or("", Value::text);
        if !text.is_empty() {
            let value = all.field_text(name, text, place);
            fields.push((all.name(name), value));
        }
    }
}
