//! Problems in the data, collected while work goes on.

use std::collections::BTreeMap;

/// How bad a finding is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing.
    Info,
    /// Something was ignored or guessed.
    Warning,
    /// The data is wrong; what it says there was left out.
    Error,
}

/// One kind of finding, with how often it occurred and where.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// Stable short name, for example `unknown-element`.
    pub code: &'static str,
    /// The first occurrence in words: file, place and value.
    pub message: String,
    /// Number of occurrences.
    pub count: usize,
    /// Ids or places of the first occurrences, at most [`Diagnostics::EXAMPLES`].
    pub examples: Vec<String>,
}

/// Findings, one entry a code.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    entries: BTreeMap<&'static str, Diagnostic>,
}

impl Diagnostics {
    /// Examples kept per code.
    pub const EXAMPLES: usize = 20;

    /// Adds one occurrence. `subject` is the id or place it concerns.
    pub fn add(
        &mut self,
        severity: Severity,
        code: &'static str,
        subject: impl Into<String>,
        message: impl FnOnce() -> String,
    ) {
        let entry = self.entries.entry(code).or_insert_with(|| Diagnostic {
            severity,
            code,
            message: message(),
            count: 0,
            examples: Vec::new(),
        });
        entry.severity = entry.severity.max(severity);
        entry.count += 1;
        if entry.examples.len() < Self::EXAMPLES {
            entry.examples.push(subject.into());
        }
    }

    /// Takes over all findings of another collection.
    pub fn append(&mut self, other: Diagnostics) {
        for (code, theirs) in other.entries {
            match self.entries.entry(code) {
                std::collections::btree_map::Entry::Vacant(v) => {
                    v.insert(theirs);
                }
                std::collections::btree_map::Entry::Occupied(mut o) => {
                    let mine = o.get_mut();
                    mine.severity = mine.severity.max(theirs.severity);
                    mine.count += theirs.count;
                    let room = Self::EXAMPLES.saturating_sub(mine.examples.len());
                    mine.examples.extend(theirs.examples.into_iter().take(room));
                }
            }
        }
    }

    /// All findings, worst first.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        let mut all: Vec<_> = self.entries.values().collect();
        all.sort_by_key(|d| std::cmp::Reverse(d.severity));
        all.into_iter()
    }

    /// Whether any finding is an error.
    pub fn has_errors(&self) -> bool {
        self.entries.values().any(|d| d.severity == Severity::Error)
    }

    /// The finding with this code.
    pub fn get(&self, code: &str) -> Option<&Diagnostic> {
        self.entries.get(code)
    }
}
