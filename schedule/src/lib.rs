//! Time, activities, schedule readers and behaviour step functions.
//!
//! This room knows nothing of geometry or of a GPU. Its central types are [`Schedule`] (validated
//! activities), [`Behaviour`] (when one object is there), [`StepFunction`] (what share of a
//! cluster is there) and [`BoundedStep`] (the same in bounded memory). [`read_files`] makes schedules from files, [`presence`] behaviours from
//! activities.

mod behaviour;
mod bounded;
mod diagnostics;
mod presence;
mod read;
mod schedule;
mod sources;
mod step;
mod time;
mod write;

pub use behaviour::{Behaviour, Preset};
pub use bounded::{BoundedStep, Share};
pub use diagnostics::{Diagnostic, Diagnostics, Severity};
pub use presence::presence;
pub use read::{FORMAT, ReadError, ReadOptions, read_files};
pub use schedule::{Activity, ActivityKind, Schedule};
pub use sources::Sources;
pub use step::StepFunction;
pub use time::{Time, TimeError, TimeRange};
