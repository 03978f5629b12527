//! Time, activities, schedule readers and behaviour step functions.
//!
//! This room knows nothing of geometry or of a GPU. Its central types are [`Schedule`] (validated
//! activities), [`Behaviour`] (when one object is there) and [`StepFunction`] (what share of a
//! cluster is there). [`read_files`] makes schedules from files, [`presence`] behaviours from
//! activities.

mod behaviour;
mod diagnostics;
mod presence;
mod read;
mod schedule;
mod sources;
mod time;
mod write;

pub use behaviour::{Behaviour, Preset, StepFunction};
pub use diagnostics::{Diagnostic, Diagnostics, Severity};
pub use presence::presence;
pub use read::{FORMAT, ReadError, ReadOptions, read_files};
pub use schedule::{Activity, ActivityKind, Schedule};
pub use sources::Sources;
pub use time::{Time, TimeError, TimeRange};
