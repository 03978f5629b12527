//! Errors of the import, and faults that concern only a part of a file.

use crate::Cancelled;
use std::fmt;
use std::path::PathBuf;

/// Why a file gives no model. Each names the file, and the place and value where there is one.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The file itself cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is not glTF, or damaged beyond use.
    #[error("{}: {fault}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Place and value.
        fault: Fault,
    },
    /// The file needs something that is not read here.
    #[error("{}: needs {feature}, which is not supported{hint}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Name of the extension or version.
        feature: String,
        /// What the user can do about it, or empty.
        hint: &'static str,
    },
    /// Nothing in the file can be drawn.
    #[error("{}: no geometry: {reason}", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
        /// What was found instead.
        reason: String,
    },
    /// The user cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Something wrong at a place of a file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Fault {
    /// Where: `accessors[3]`, `byte 12`.
    pub place: String,
    /// What, with the value.
    pub message: String,
}

impl Fault {
    pub(super) fn new(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { place: place.into(), message: message.into() }
    }

    /// The entry `index` of a table, or a fault in words.
    pub(super) fn entry<'a, T>(
        table: &'a [T],
        name: &str,
        index: usize,
        user: impl fmt::Display,
    ) -> Result<&'a T, Self> {
        table.get(index).ok_or_else(|| {
            Self::new(
                user.to_string(),
                format!("refers to {name}[{index}], but there are only {}", table.len()),
            )
        })
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}
