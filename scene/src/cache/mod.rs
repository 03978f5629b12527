//! Trees kept on disk, so that a project which was opened before need not be built again.
//!
//! | step | file |
//! |---|---|
//! | what a tree depends on | `key` |
//! | the bytes of one tree | `file` |
//! | the folder: finding, keeping, listing, clearing | `store` |
//!
//! A tree that is taken from the cache equals the one that would be built, or is one that was repaired
//! after an edit of the schedule: other geometry, the same promise and thresholds. Of one model and one
//! way of building the trees of the [`MOST_SCHEDULES`] schedules used last are kept. A file is used only
//! when its versions, its key and its checksum are right and the tree in it fits the scene
//! ([`Hdlod::validate`]); any other is a miss, and the next tree that is kept replaces it. Files
//! are written under another name and renamed when they are whole: whoever reads, reads all or
//! nothing, whatever other processes do.
//!
//! Architecture invariant: nothing here looks for settings. Where the folder is and how large it
//! may become is the caller's to say.

mod file;
mod key;
mod store;
#[cfg(test)]
mod tests;

pub use file::{FORMAT, Info, Unusable};
pub use key::Key;
pub use store::{Cache, Entry, Found, MOST_SCHEDULES, StoreError, Total};
