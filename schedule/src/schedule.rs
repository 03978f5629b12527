//! Activities and the schedule that holds them.

use crate::sources::{Place, Sources};
use crate::{Diagnostics, Severity, Time, TimeRange};
use std::collections::{HashMap, HashSet};

/// What an activity does to the elements it is linked to.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum ActivityKind {
    /// Present from its start on.
    #[default]
    Construct,
    /// Absent from its end on.
    Demolish,
    /// Present from its start to its end.
    Temporary,
    /// Says nothing of presence (inspect, maintain).
    Neutral,
}

impl ActivityKind {
    /// The words that schedules use, the one that is written first.
    pub const WORDS: [(&'static str, ActivityKind); 6] = [
        ("construct", ActivityKind::Construct),
        ("demolish", ActivityKind::Demolish),
        ("temporary", ActivityKind::Temporary),
        ("neutral", ActivityKind::Neutral),
        ("inspect", ActivityKind::Neutral),
        ("maintain", ActivityKind::Neutral),
    ];

    /// The kind that a word in a schedule means, in whatever case.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(w, _)| w.eq_ignore_ascii_case(word)).map(|&(_, kind)| kind)
    }

    /// The word that schedules use.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|&&(_, k)| k == self).expect("every kind has a word").0
    }
}

/// One leaf task.
#[derive(Clone, PartialEq, Debug)]
pub struct Activity {
    /// Unique within the schedule.
    pub id: String,
    /// What the planner calls it.
    pub name: String,
    /// First instant, if it has dates.
    pub start: Option<Time>,
    /// First instant after it, if it has dates.
    pub end: Option<Time>,
    /// What it does to its elements.
    pub kind: ActivityKind,
    /// False: it never happens.
    pub active: bool,
    /// Node names or guids of elements or groups.
    pub elements: Vec<String>,
    /// Everything else the file said, kept in the file's order.
    pub fields: Vec<(String, String)>,
}

impl Default for Activity {
    /// A construct activity that happens, without dates.
    fn default() -> Self {
        Self {
            id: String::new(),
            name: String::new(),
            start: None,
            end: None,
            kind: ActivityKind::default(),
            active: true,
            elements: Vec::new(),
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
}

/// Validated activities of one project.
#[derive(Clone, Debug, Default)]
pub struct Schedule {
    /// The project's name, or empty.
    pub project: String,
    /// T of the behaviours: the project's start and end.
    pub period: TimeRange,
    /// Leaf tasks in file order.
    pub activities: Vec<Activity>,
    /// What else the file said of the project, kept in the file's order.
    pub fields: Vec<(String, String)>,
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
    /// No activity names an element twice. Without a period, or with one that ends before it
    /// starts, the period runs from the first start to the last end of the usable dates.
    pub fn new(
        project: String,
        period: Option<TimeRange>,
        activities: Vec<Activity>,
        diagnostics: Diagnostics,
    ) -> Schedule {
        let period = (period.map(|p| p.start), period.map(|p| p.end));
        Self::validate(project, period, activities, Sources::default(), diagnostics)
    }

    /// [`Schedule::new`] for activities that come from files.
    pub(crate) fn validate(
        project: String,
        period: (Option<Time>, Option<Time>),
        mut activities: Vec<Activity>,
        mut sources: Sources,
        mut diagnostics: Diagnostics,
    ) -> Schedule {
        let keep = unique_ids(&activities, &sources, &mut diagnostics);
        for (i, activity) in activities.iter_mut().enumerate().filter(|&(i, _)| keep[i]) {
            let source = sources.activities.get_mut(i);
            remove_repeats(&mut activity.elements, source.map(|s| &mut s.links));
            check_dates(activity, i, &sources, &mut diagnostics);
        }
        retain(&mut activities, &keep);
        retain(&mut sources.activities, &keep);

        let period = period_of(period, &activities, &mut diagnostics);
        Schedule { project, period, activities, fields: Vec::new(), diagnostics, sources }
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

/// Removes empty names and all but the first of equal ones, and with them the places of those that
/// links gave, which are the last.
fn remove_repeats(names: &mut Vec<String>, links: Option<&mut Vec<Place>>) {
    let mut seen = HashSet::with_capacity(names.len());
    let keep: Vec<bool> =
        names.iter().map(|name| !name.is_empty() && seen.insert(name.as_str())).collect();
    if keep.iter().all(|&k| k) {
        return;
    }
    retain(names, &keep);
    if let Some(links) = links {
        let own = keep.len().saturating_sub(links.len());
        retain(links, &keep[own..]);
    }
}

/// Keeps what `keep` says, which is as long or longer.
fn retain<T>(items: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    items.retain(|_| *keep.next().expect("one answer an item"));
}
