//! Which rule would link what the rules do not.

use super::rules::Rule;
use crate::Model;
use topout_schedule::Schedule;

/// A rule that would match keys of the schedule.
#[derive(Clone, PartialEq, Debug)]
pub struct Suggestion {
    /// The rule that does it.
    pub rule: Rule,
}

/// Rules that would match most keys, best first.
pub fn suggest(model: &Model, schedule: &Schedule) -> Vec<Suggestion> {
    let _ = (model, schedule);
    Vec::new()
}
