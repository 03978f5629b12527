//! Time, activities, schedule readers and behaviour step functions.
//!
//! This room knows nothing of geometry or of a GPU. Its central types are [`Schedule`] (validated
//! activities), [`Behaviour`] (when one object is there), [`StepFunction`] (what share of a
//! cluster is there) and [`BoundedStep`] (the same in bounded memory). [`read_files`] makes schedules from files, [`presence`] behaviours from
//! activities.

mod behaviour;
mod bounded;
mod calendar;
mod dates;
mod diagnostics;
mod element_fields;
mod kind;
mod network;
mod plan;
mod presence;
mod progress;
mod read;
mod schedule;
mod slip;
mod sources;
mod step;
mod time;
mod workclock;
mod workdays;
mod write;
mod write_csv;

pub use behaviour::{Behaviour, Preset};
pub use bounded::{BoundedStep, Share};
pub use calendar::{Calendar, CalendarException, Shift};
pub use dates::{DateSet, DateSets, Dates};
pub use diagnostics::{Diagnostic, Diagnostics, Severity};
pub use element_fields::ElementField;
pub use kind::{ActivityKind, Kind, Kinds, Look, Phase, appearance};
pub use network::{CyclicLink, Network, Pull};
pub use plan::{Lag, LinkKind, Predecessor, WbsNode};
pub use presence::presence;
pub use progress::SCurve;
pub use read::{Column, FORMAT, ReadError, ReadOptions, read_bytes, read_files};
pub use schedule::{Activity, Fields, Schedule, Tally};
pub use slip::{ActivityFlags, Comparison, Flags, Slip, SlipClass, Totals};
pub use sources::Sources;
pub use step::StepFunction;
pub use time::{Time, TimeError, TimeRange};
