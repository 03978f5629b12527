//! Primavera P6's projects, whichever of its two formats they come in: records that name each other
//! by object ids, in whatever order.

use super::collected::Collected;
use super::tasklinks::{Keys, Target, TaskLinks, parents_first, whole_seconds};
use crate::sources::Place;
use crate::{Activity, ActivityKind, Calendar, DateSet, Dates, Lag, LinkKind, Severity, WbsNode};
use std::collections::HashMap;
use std::sync::Arc;

/// What was read so far. Object ids are texts; 0 and empty ones name nothing.
#[derive(Default)]
pub(super) struct P6 {
    keys: Keys,
    projects: Vec<Project>,
    nodes: Vec<Node>,
    calendars: Vec<(u32, Option<u32>, Calendar)>,
    tasks: Vec<Task>,
    /// Dates of tasks of baselines by the id of the project that they are of and their own.
    baselines: HashMap<(u32, String), Dates>,
    links: TaskLinks,
    /// Successors by object ids, in step with `links`.
    successors: Vec<(u32, u32, LinkKind, Lag)>,
    code_types: HashMap<u32, Arc<str>>,
    code_values: HashMap<u32, Box<str>>,
    /// Task, type and value.
    codes: Vec<(u32, u32, u32)>,
    user_types: HashMap<u32, Arc<str>>,
    user_values: Vec<(u32, u32, Box<str>)>,
}

/// A project, or a baseline of one.
pub(super) struct Project {
    key: u32,
    code: String,
    calendar: Option<u32>,
    baseline_of: Option<u32>,
}

struct Node {
    key: u32,
    parent: Option<u32>,
    code: String,
    name: String,
}

/// What an activity refers to.
struct Task {
    key: u32,
    project: u32,
    index: usize,
    node: Option<u32>,
    calendar: Option<u32>,
}

/// The object ids of a task.
pub(super) struct TaskIds<'a> {
    pub(super) object: &'a str,
    pub(super) project: &'a str,
    pub(super) wbs: &'a str,
    pub(super) calendar: &'a str,
}

impl P6 {
    fn key(&mut self, id: &str) -> Option<u32> {
        let id = id.trim();
        (!id.is_empty() && id != "0").then(|| self.keys.of(id))
    }

    /// `baseline_of` names the project whose state this one once was.
    pub(super) fn project(&mut self, id: &str, code: &str, calendar: &str, baseline_of: &str) {
        let Some(key) = self.key(id) else { return };
        let (calendar, baseline_of) = (self.key(calendar), self.key(baseline_of));
        self.projects.push(Project { key, code: code.to_owned(), calendar, baseline_of });
    }

    pub(super) fn node(&mut self, id: &str, parent: &str, code: &str, name: &str) {
        let Some(key) = self.key(id) else { return };
        let parent = self.key(parent);
        self.nodes.push(Node { key, parent, code: code.to_owned(), name: name.to_owned() });
    }

    pub(super) fn calendar(&mut self, id: &str, base: &str, calendar: Calendar) {
        let Some(key) = self.key(id) else { return };
        let base = self.key(base);
        self.calendars.push((key, base, calendar));
    }

    pub(super) fn code_type(&mut self, id: &str, name: &str, all: &mut Collected) {
        let Some(key) = self.key(id) else { return };
        self.code_types.insert(key, all.name(name));
    }

    /// A value is shown as its short name and, where it has one, what it stands for.
    pub(super) fn code_value(&mut self, id: &str, short: &str, name: &str) {
        let Some(key) = self.key(id) else { return };
        let text = match (short.is_empty(), name.is_empty() || name == short) {
            (true, _) => name.to_owned(),
            (_, true) => short.to_owned(),
            (false, false) => format!("{short} - {name}"),
        };
        self.code_values.insert(key, text.into());
    }

    pub(super) fn code(&mut self, task: &str, code_type: &str, value: &str) {
        if let (Some(task), Some(code_type), Some(value)) =
            (self.key(task), self.key(code_type), self.key(value))
        {
            self.codes.push((task, code_type, value));
        }
    }

    pub(super) fn user_type(&mut self, id: &str, label: &str, all: &mut Collected) {
        let Some(key) = self.key(id) else { return };
        self.user_types.insert(key, all.name(label));
    }

    pub(super) fn user_value(&mut self, task: &str, user_type: &str, value: Box<str>) {
        if let (Some(task), Some(user_type)) = (self.key(task), self.key(user_type))
            && !value.is_empty()
        {
            self.user_values.push((task, user_type, value));
        }
    }

    /// Adds a task with its own dates; those of a baseline go to the task that it is one of.
    pub(super) fn task(
        &mut self,
        ids: &TaskIds,
        mut activity: Activity,
        place: Place,
        bad_dates: bool,
        all: &mut Collected,
    ) {
        let project = self.key(ids.project).unwrap_or(u32::MAX);
        let baseline_of =
            self.projects.iter().find(|p| p.key == project).and_then(|p| p.baseline_of);
        if let Some(baseline_of) = baseline_of {
            activity.choose_dates();
            let dates = Dates { start: activity.start, end: activity.end };
            self.baselines.insert((baseline_of, activity.id), dates);
            return;
        }
        let Some(key) = self.key(ids.object) else { return };
        let (node, calendar) = (self.key(ids.wbs), self.key(ids.calendar));
        let index = all.activities.len();
        self.tasks.push(Task { key, project, index, node, calendar });
        activity.choose_dates();
        all.push(activity, place, bad_dates);
    }

    /// `lag_hours` are those of working time.
    pub(super) fn link(&mut self, task: &str, predecessor: &str, kind: LinkKind, lag_hours: f64) {
        if let (Some(task), Some(predecessor)) = (self.key(task), self.key(predecessor)) {
            let seconds = whole_seconds(lag_hours * 3600.0).unwrap_or_default();
            let lag = Lag { seconds, elapsed: false };
            self.successors.push((task, predecessor, kind, lag));
        }
    }

    /// Ties everything together.
    pub(super) fn finish(mut self, all: &mut Collected) {
        let node_numbers = self.outline(all);
        let calendar_numbers = self.hand_over_calendars(all);
        let mut targets = HashMap::with_capacity(self.tasks.len());
        for task in &self.tasks {
            targets.entry(task.key).or_insert(Target::Activity(task.index as u32));
            let activity = &mut all.activities[task.index];
            activity.wbs = task.node.and_then(|node| node_numbers.get(&node).copied());
            activity.calendar = task.calendar.and_then(|c| calendar_numbers.get(&c).copied());
            if !self.baselines.is_empty() {
                let id = (task.project, activity.id.clone());
                activity.date_sets[DateSet::Baseline] =
                    self.baselines.get(&id).copied().unwrap_or_default();
            }
        }
        let default = self.projects.iter().find_map(|p| p.calendar);
        let default = default.and_then(|c| calendar_numbers.get(&c).copied());
        all.calendar = all.calendar.or(default);
        self.distinguish_projects(all);
        self.attach_fields(&targets, all);
        // Successors of other projects have no task here.
        let names = self.keys.texts();
        for (task, predecessor, kind, lag) in std::mem::take(&mut self.successors) {
            match targets.get(&task) {
                Some(&Target::Activity(index)) => {
                    self.links.add(index as usize, predecessor, kind, lag);
                }
                _ => {
                    let (task, place) = (names[task as usize], all.line(1));
                    all.report(Severity::Warning, "unknown-successor", task, place, || {
                        format!("a link leads to {task:?}, which does not exist; it is left out")
                    });
                }
            }
        }
        drop(names);
        self.links.keys = self.keys;
        self.links.attach_to(&targets, all);
        all.end_schedule();
    }

    /// The outline, parents first. A node below itself is taken as one without a parent.
    fn outline(&mut self, all: &mut Collected) -> HashMap<u32, u32> {
        let by_key: HashMap<u32, usize> =
            self.nodes.iter().enumerate().rev().map(|(i, node)| (node.key, i)).collect();
        let parent = |node: &Node| by_key.get(&node.parent?).copied();
        let parents: Vec<Option<usize>> = self.nodes.iter().map(parent).collect();
        let mut numbers: HashMap<u32, u32> = HashMap::with_capacity(self.nodes.len());
        for i in parents_first(&parents) {
            let node = &mut self.nodes[i];
            let parent = node.parent.and_then(|parent| numbers.get(&parent).copied());
            let number = u32::try_from(all.wbs.len()).unwrap_or(u32::MAX);
            numbers.entry(node.key).or_insert(number);
            let (code, name) = (std::mem::take(&mut node.code), std::mem::take(&mut node.name));
            all.wbs.push(WbsNode { code, name, parent });
        }
        numbers
    }

    /// A calendar has the exceptions of the one it is derived from, too; its own count.
    fn hand_over_calendars(&mut self, all: &mut Collected) -> HashMap<u32, u32> {
        let calendars = std::mem::take(&mut self.calendars);
        let mut numbers = HashMap::with_capacity(calendars.len());
        for (key, base, calendar) in &calendars {
            let mut calendar = calendar.clone();
            if let Some((.., base)) = base.and_then(|b| calendars.iter().find(|c| c.0 == b)) {
                calendar.exceptions.splice(0..0, base.exceptions.iter().cloned());
            }
            numbers.insert(*key, u32::try_from(all.calendars.len()).unwrap_or(u32::MAX));
            all.calendars.push(calendar);
        }
        numbers
    }

    /// Ids are unique within a project only: with several projects in a file theirs goes first.
    fn distinguish_projects(&self, all: &mut Collected) {
        let first = self.tasks.first().map(|t| t.project);
        if self.tasks.iter().all(|t| Some(t.project) == first) {
            return;
        }
        let codes: HashMap<u32, &str> =
            self.projects.iter().map(|p| (p.key, p.code.as_str())).collect();
        for task in &self.tasks {
            let activity = &mut all.activities[task.index];
            let code = codes.get(&task.project).copied().unwrap_or_default();
            activity.id = format!("{code}.{}", activity.id);
        }
    }

    /// Codes and user fields, in the order in which they were written.
    fn attach_fields(&mut self, targets: &HashMap<u32, Target>, all: &mut Collected) {
        let user_values = std::mem::take(&mut self.user_values);
        let Self { codes, code_types, code_values, .. } = &*self;
        let codes = codes.iter().filter_map(|(task, kind, value)| {
            Some((*task, code_types.get(kind)?.clone(), code_values.get(value)?.clone()))
        });
        let user_types = &self.user_types;
        let user_values = user_values
            .into_iter()
            .filter_map(|(task, kind, value)| Some((task, user_types.get(&kind)?.clone(), value)));
        for (task, name, value) in codes.chain(user_values) {
            if let Some(&Target::Activity(index)) = targets.get(&task) {
                all.activities[index as usize].fields.push((name, value));
            }
        }
        for task in &self.tasks {
            all.activities[task.index].fields.shrink_to_fit();
        }
    }
}

/// What P6 calls types of activities, in both formats, as kind and whether it is a milestone.
pub(super) fn task_type(word: &str) -> (ActivityKind, bool) {
    match word {
        "TT_Mile" | "TT_FinMile" | "Start Milestone" | "Finish Milestone" => {
            (ActivityKind::Construct, true)
        }
        // It only spans what others do.
        "TT_WBS" | "WBS Summary" => (ActivityKind::Neutral, false),
        _ => (ActivityKind::Construct, false),
    }
}

/// What is known of how much is done.
#[derive(Default)]
pub(super) struct Progress {
    pub(super) complete: bool,
    /// How the planner measures it: `CP_Phys`, `CP_Units`, else by duration.
    pub(super) measure: String,
    /// From 0 to 100.
    pub(super) physical: Option<f64>,
    pub(super) target_hours: Option<f64>,
    pub(super) remaining_hours: Option<f64>,
    pub(super) actual_units: f64,
    pub(super) remaining_units: f64,
}

impl Progress {
    /// How much is done, from 0 to 100.
    pub(super) fn percent(&self) -> Option<f32> {
        let share = |part: f64, whole: f64| (whole > 0.0).then(|| 100.0 * part / whole);
        let percent = match self.measure.as_str() {
            _ if self.complete => Some(100.0),
            "CP_Phys" => self.physical,
            "CP_Units" => {
                share(self.actual_units, self.actual_units + self.remaining_units).or(Some(0.0))
            }
            _ => match (self.target_hours, self.remaining_hours) {
                (Some(target), Some(left)) => share(target - left, target).or(Some(0.0)),
                _ => self.physical,
            },
        };
        percent.filter(|p| p.is_finite()).map(|p| p.clamp(0.0, 100.0) as f32)
    }
}
