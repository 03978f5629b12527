//! Activities and the schedule that holds them.

use crate::element_fields::retain;
use crate::sources::Sources;
use crate::{
    ActivityKind, Calendar, DateSet, DateSets, Dates, Diagnostics, ElementField, Kinds,
    Predecessor, Severity, Time, TimeRange, WbsNode,
};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// What a file says beside what topout knows: names and values in the file's order. Activities of
/// one file share the names.
pub type Fields = Vec<(Arc<str>, Box<str>)>;

/// One leaf task.
#[derive(Clone, PartialEq, Debug)]
pub struct Activity {
    /// Unique within the schedule.
    pub id: String,
    /// What the planner calls it.
    pub name: String,
    /// First instant, if it has dates; what presence uses.
    pub start: Option<Time>,
    /// First instant after it, if it has dates; what presence uses.
    pub end: Option<Time>,
    /// All dates that the planner keeps of it.
    pub date_sets: DateSets,
    /// What it does to its elements.
    pub kind: ActivityKind,
    /// False: it never happens.
    pub active: bool,
    /// An event rather than work.
    pub milestone: bool,
    /// How much is done, from 0 to 100.
    pub percent_complete: Option<f32>,
    /// The summary above it: index in [`Schedule::wbs`].
    pub wbs: Option<u32>,
    /// Its own calendar: index in [`Schedule::calendars`].
    pub calendar: Option<u32>,
    /// What it waits for.
    pub predecessors: Vec<Predecessor>,
    /// Node names or guids of elements or groups.
    pub elements: Vec<String>,
    /// What the file said of single elements, in their order.
    pub element_fields: Vec<ElementField>,
    /// Everything else the file said: activity codes, user fields, unknown columns.
    pub fields: Fields,
}

impl Default for Activity {
    /// A construct activity that happens, without dates.
    fn default() -> Self {
        Self {
            id: String::new(),
            name: String::new(),
            start: None,
            end: None,
            date_sets: DateSets::default(),
            kind: ActivityKind::default(),
            active: true,
            milestone: false,
            percent_complete: None,
            wbs: None,
            calendar: None,
            predecessors: Vec::new(),
            elements: Vec::new(),
            element_fields: Vec::new(),
            fields: Vec::new(),
        }
    }
}

impl Activity {
    /// When it lasts: both dates, unless one is missing or the end precedes the start.
    pub fn dates(&self) -> Option<TimeRange> {
        let (start, end) = (self.start?, self.end?);
        (start <= end).then_some(TimeRange { start, end })
    }

    /// Takes the dates that count by [`DateSets::chosen`]; a milestone needs but one.
    pub(crate) fn choose_dates(&mut self) {
        let Dates { start, end } = self.date_sets.chosen();
        (self.start, self.end) = match self.milestone {
            true => (start.or(end), end.or(start)),
            false => (start, end),
        };
    }
}

/// Validated activities of one project.
#[derive(Clone, Debug, Default)]
pub struct Schedule {
    /// The project's name, or empty.
    pub project: String,
    /// T of the behaviours: the project's start and end.
    pub period: TimeRange,
    /// Up to when the actual dates are known.
    pub data_date: Option<Time>,
    /// Leaf tasks in file order.
    pub activities: Vec<Activity>,
    /// The outline above them, parents before children.
    pub wbs: Vec<WbsNode>,
    /// Working times that activities refer to.
    pub calendars: Vec<Calendar>,
    /// The calendar of activities that have none: index in `calendars`.
    pub calendar: Option<u32>,
    /// What the activities' kinds mean.
    pub kinds: Kinds,
    /// What else the file said of the project, kept in the file's order.
    pub fields: Fields,
    /// What was found while reading.
    pub diagnostics: Diagnostics,
    /// Where the activities stand in their files; see [`Schedule::place`].
    pub sources: Sources,
}

impl Schedule {
    /// Validates activities; what is wrong is added to `diagnostics`.
    ///
    /// Ids are unique afterwards: of several activities with one id the first stays. Activities
    /// without an id are left out, those without usable dates stay but have no [`Activity::dates`].
    /// No activity names an element twice, and element fields have a value an element. Without a
    /// period, or with one that ends before it starts, the period runs from the first start to the
    /// last end of the usable dates.
    pub fn new(
        project: String,
        period: Option<TimeRange>,
        activities: Vec<Activity>,
        diagnostics: Diagnostics,
    ) -> Schedule {
        let period = (period.map(|p| p.start), period.map(|p| p.end));
        Schedule { project, activities, diagnostics, ..Schedule::default() }.validated(period)
    }

    /// Validates again what was put together by hand, as [`Schedule::new`] does. The period stays.
    pub fn revalidated(self) -> Schedule {
        let TimeRange { start, end } = self.period;
        self.validated((Some(start), Some(end)))
    }

    /// [`Schedule::new`] for what comes from files. References to what does not exist are reported
    /// and removed.
    pub(crate) fn validated(mut self, period: (Option<Time>, Option<Time>)) -> Schedule {
        let keep = unique_ids(&self.activities, &self.sources, &mut self.diagnostics);
        for (i, activity) in self.activities.iter_mut().enumerate().filter(|&(i, _)| keep[i]) {
            let source = self.sources.activities.get_mut(i);
            let longer = activity.fit_element_fields();
            activity.remove_repeats(source.map(|s| &mut s.links));
            if let Some(name) = longer {
                let (place, id) = (self.sources.of_activity(i), &activity.id);
                self.diagnostics.add(Severity::Warning, "lost-values", id, || {
                    format!("{place}: {name:?} of {id:?} has more values than there are elements")
                });
            }
            check_dates(activity, i, &self.sources, &mut self.diagnostics);
        }
        self.check_references(&keep);
        retain(&mut self.activities, &keep);
        retain(&mut self.sources.activities, &keep);
        self.period = period_of(period, &self.activities, &mut self.diagnostics);
        self
    }

    /// Predecessors, summaries and calendars exist afterwards; predecessors are numbered as they are
    /// once only the activities to keep are left.
    fn check_references(&mut self, keep: &[bool]) {
        for (i, node) in self.wbs.iter_mut().enumerate() {
            node.parent = node.parent.filter(|&parent| (parent as usize) < i);
        }
        let (nodes, calendars) = (self.wbs.len(), self.calendars.len());
        self.calendar = self.calendar.filter(|&c| (c as usize) < calendars);
        let mut kept = 0;
        let new_index: Vec<Option<u32>> = (keep.iter())
            .map(|&k| {
                kept += u32::from(k);
                k.then(|| kept - 1)
            })
            .collect();
        for (i, activity) in self.activities.iter_mut().enumerate().filter(|&(i, _)| keep[i]) {
            let unknown = |r: Option<u32>, count: usize| r.is_some_and(|r| r as usize >= count);
            let before = activity.predecessors.len();
            activity.predecessors.retain_mut(|link| {
                let there = new_index.get(link.activity as usize).copied().flatten();
                link.activity = there.unwrap_or_default();
                there.is_some()
            });
            let lost = before - activity.predecessors.len();
            let unknown_wbs = unknown(activity.wbs, nodes);
            let unknown_calendar = unknown(activity.calendar, calendars);
            activity.wbs = activity.wbs.filter(|_| !unknown_wbs);
            activity.calendar = activity.calendar.filter(|_| !unknown_calendar);
            for (what, found) in [
                ("a predecessor", lost > 0),
                ("a summary", unknown_wbs),
                ("a calendar", unknown_calendar),
            ] {
                if found {
                    let place = self.sources.of_activity(i);
                    self.diagnostics.add(Severity::Warning, "lost-reference", &activity.id, || {
                        format!(
                            "{place}: activity {:?} names {what} that is not there",
                            activity.id
                        )
                    });
                }
            }
        }
    }

    /// Takes away elements from all activities. Returns the activities that had any, as indices.
    pub fn remove_elements(&mut self, which: impl Fn(&str) -> bool) -> Vec<usize> {
        let mut had = Vec::new();
        for (i, activity) in self.activities.iter_mut().enumerate() {
            let keep: Vec<bool> = activity.elements.iter().map(|key| !which(key)).collect();
            if !keep.iter().all(|&k| k) {
                let source = self.sources.activities.get_mut(i);
                activity.keep_elements(&keep, source.map(|s| &mut s.links));
                had.push(i);
            }
        }
        had
    }

    /// Takes the dates of a set as those that count, start and end apart, where it has them; others
    /// stay. The period grows as needed. Returns how many activities have neither date in it.
    pub fn use_dates(&mut self, set: DateSet) -> usize {
        let mut without = 0;
        for activity in &mut self.activities {
            let Dates { start, end } = activity.date_sets[set];
            without += usize::from(start.is_none() && end.is_none());
            activity.start = start.or(activity.start);
            activity.end = end.or(activity.end);
            if let Some(dates) = activity.dates() {
                self.period.start = self.period.start.min(dates.start);
                self.period.end = self.period.end.max(dates.end);
            }
        }
        without
    }

    /// The calendar of the project: its own, else the one that most activities have, else the first;
    /// one in which nobody ever works does not count.
    pub fn work_calendar(&self) -> Option<&Calendar> {
        let mut uses = vec![0usize; self.calendars.len()];
        for calendar in self.activities.iter().filter_map(|a| a.calendar) {
            if let Some(count) = uses.get_mut(calendar as usize) {
                *count += 1;
            }
        }
        let works = |&i: &usize| self.calendars.get(i).is_some_and(|c| !c.is_empty());
        let own = self.calendar.map(|c| c as usize).filter(works);
        let most =
            || (0..uses.len()).filter(works).max_by_key(|&i| (uses[i], std::cmp::Reverse(i)));
        self.calendars.get(own.or_else(most)?)
    }

    /// The names of the summaries above an activity, the outermost first; their codes where they
    /// have no names.
    pub fn wbs_path(&self, activity: &Activity) -> Vec<&str> {
        let mut path = Vec::new();
        let mut next = activity.wbs;
        while let Some(node) = next.and_then(|n| self.wbs.get(n as usize)) {
            path.push(if node.name.is_empty() { &node.code } else { &node.name }.as_str());
            // Parents come first, so this ends.
            next = node.parent.filter(|&parent| Some(parent) < next);
        }
        path.reverse();
        path
    }

    /// What there is, and how much of it is unusual but fine.
    pub fn tally(&self) -> Tally {
        let mut names = HashSet::with_capacity(self.activities.len());
        let mut tally = Tally {
            activities: self.activities.len(),
            summaries: self.wbs.len(),
            calendars: self.calendars.len(),
            flat_outline: self.wbs.is_empty(),
            ..Tally::default()
        };
        for activity in &self.activities {
            let name = activity.name.trim();
            tally.predecessors += activity.predecessors.len();
            tally.elements += activity.elements.len();
            tally.milestones += usize::from(activity.milestone);
            tally.without_name += usize::from(name.is_empty());
            tally.repeated_names += usize::from(!name.is_empty() && !names.insert(name));
            tally.without_dates += usize::from(activity.dates().is_none());
            tally.zero_duration += usize::from(activity.dates().is_some_and(|d| d.start == d.end));
        }
        tally
    }

    /// Bytes that the activities, the outline and their places take, without what an allocator adds.
    pub fn bytes(&self) -> usize {
        let text = |fields: &Fields| -> usize {
            size_of_val(&fields[..]) + fields.iter().map(|(_, v)| v.len()).sum::<usize>()
        };
        let names = |names: &[String]| -> usize {
            size_of_val(names) + names.iter().map(String::len).sum::<usize>()
        };
        let activity = |a: &Activity| {
            let links = size_of_val(&a.predecessors[..]);
            a.id.len() + a.name.len() + links + names(&a.elements) + text(&a.fields)
        };
        let node = |n: &WbsNode| n.code.len() + n.name.len();
        size_of_val(&self.activities[..])
            + self.activities.iter().map(activity).sum::<usize>()
            + size_of_val(&self.wbs[..])
            + self.wbs.iter().map(node).sum::<usize>()
            + self.sources.bytes()
            + ElementField::bytes(self.activities.iter().flat_map(|a| &a.element_fields))
    }

    /// Where an activity stands, in words: file and line, or its number if it comes from no file.
    pub fn place(&self, activity: usize) -> String {
        self.sources.of_activity(activity)
    }

    /// Where it stands that an activity has one of its elements: file and line, which may be those
    /// of a links file.
    pub fn element_place(&self, activity: usize, element: usize) -> String {
        let elements = self.activities.get(activity).map_or(0, |a| a.elements.len());
        self.sources.of_element(activity, elements, element)
    }
}

/// What a schedule holds; see [`Schedule::tally`].
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Serialize)]
pub struct Tally {
    /// Activities.
    pub activities: usize,
    /// Links between activities.
    pub predecessors: usize,
    /// Links to elements.
    pub elements: usize,
    /// Nodes of the outline.
    pub summaries: usize,
    /// Calendars.
    pub calendars: usize,
    /// Activities that are events.
    pub milestones: usize,
    /// Activities whose name is empty.
    pub without_name: usize,
    /// Activities that are called like one before them.
    pub repeated_names: usize,
    /// Activities without usable dates.
    pub without_dates: usize,
    /// Activities that end when they start.
    pub zero_duration: usize,
    /// There are no summaries.
    pub flat_outline: bool,
}

/// The project's period: as given, else from the first start to the last end.
fn period_of(
    (start, end): (Option<Time>, Option<Time>),
    activities: &[Activity],
    diagnostics: &mut Diagnostics,
) -> TimeRange {
    let dates = || activities.iter().filter_map(Activity::dates);
    let first = dates().map(|d| d.start).min();
    let last = dates().map(|d| d.end).max();
    let period = TimeRange {
        start: start.or(first).or(end).unwrap_or_default(),
        end: end.or(last).or(start).unwrap_or_default(),
    };
    if period.start <= period.end {
        return period;
    }
    diagnostics.add(Severity::Error, "reversed-project", "project", || {
        format!("the project ends {} before its start {}", period.end, period.start)
    });
    let start = first.unwrap_or(period.start);
    TimeRange { start, end: last.unwrap_or(start) }
}

/// Which activities have an id that none before them has.
fn unique_ids(
    activities: &[Activity],
    sources: &Sources,
    diagnostics: &mut Diagnostics,
) -> Vec<bool> {
    let mut first_with_id: HashMap<&str, usize> = HashMap::with_capacity(activities.len());
    let mut keep = vec![true; activities.len()];
    for (i, activity) in activities.iter().enumerate() {
        let id = activity.id.as_str();
        if id.is_empty() {
            keep[i] = false;
            let place = sources.of_activity(i);
            diagnostics.add(Severity::Error, "missing-id", place.clone(), || {
                format!("{place}: an activity without an id ({:?}) is left out", activity.name)
            });
        } else if let Some(&first) = first_with_id.get(id) {
            keep[i] = false;
            diagnostics.add(Severity::Error, "duplicate-id", id, || {
                let (here, there) = (sources.of_activity(i), sources.of_activity(first));
                format!("{here}: the id {id:?} was used before, at {there}; the first one counts")
            });
        } else {
            first_with_id.insert(id, i);
        }
    }
    keep
}

/// Reports dates that presence will ignore.
fn check_dates(
    activity: &Activity,
    index: usize,
    sources: &Sources,
    diagnostics: &mut Diagnostics,
) {
    let id = &activity.id;
    match (activity.start, activity.end) {
        (Some(start), Some(end)) if end < start => {
            diagnostics.add(Severity::Error, "end-before-start", id, || {
                let place = sources.of_activity(index);
                format!("{place}: activity {id:?} ends {end} before its start {start}; ignored")
            });
        }
        (Some(_), Some(_)) => {}
        (start, _) => {
            if sources.activities.get(index).is_some_and(|s| s.dates_reported) {
                return;
            }
            let missing = if start.is_some() { "end" } else { "start" };
            diagnostics.add(Severity::Warning, "no-dates", id, || {
                let place = sources.of_activity(index);
                format!("{place}: activity {id:?} has no {missing}; ignored")
            });
        }
    }
}
