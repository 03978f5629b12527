//! Activities and the schedule that holds them.

use crate::{Diagnostics, Time, TimeRange};

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

/// One leaf task.
#[derive(Clone, PartialEq, Debug, Default)]
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

/// Validated activities of one project.
#[derive(Clone, Debug, Default)]
pub struct Schedule {
    /// The project's name, or empty.
    pub project: String,
    /// T of the behaviours: the project's start and end.
    pub period: TimeRange,
    /// Leaf tasks in file order.
    pub activities: Vec<Activity>,
    /// What was found while reading.
    pub diagnostics: Diagnostics,
}
