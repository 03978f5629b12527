//! Time, activities, schedule readers and behaviour step functions.
//!
//! This room knows nothing of geometry or of a GPU. Its central types are [`Schedule`] (validated
//! activities), [`Behaviour`] (when one object is there) and [`StepFunction`] (what share of a
//! cluster is there).

mod behaviour;
mod diagnostics;
mod schedule;
mod time;

pub use behaviour::{Behaviour, Preset, StepFunction};
pub use diagnostics::{Diagnostic, Diagnostics, Severity};
pub use schedule::{Activity, ActivityKind, Schedule};
pub use time::{Time, TimeError, TimeRange};
