//! Behaviour over time of one object (H1, H2).

use crate::{Time, TimeRange};

/// When one object is present: f_s of H1, a step function {0, 1} over all time.
///
/// Rule: the value is `initial` before `toggles[0]` and flips at every toggle, the instant of the
/// toggle included in what follows it. Toggles increase strictly.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub struct Behaviour {
    initial: bool,
    toggles: Box<[Time]>,
}

/// The eight standard behaviours of H2, and what goes beyond them.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Preset {
    /// 1
    Static,
    /// 0
    Absent,
    /// 0, 1
    Installed,
    /// 1, 0
    Removed,
    /// 0, 1, 0
    Temporary,
    /// 1, 0, 1
    Skipped,
    /// 0, 1, 0, 1
    ReInstalled,
    /// 1, 0, 1, 0
    ReDeleted,
    /// More steps than the standard ones.
    Other,
}

impl Behaviour {
    /// Always there.
    pub fn always() -> Self {
        Self { initial: true, toggles: Box::default() }
    }

    /// Never there.
    pub fn never() -> Self {
        Self { initial: false, toggles: Box::default() }
    }

    /// From an initial value and strictly increasing toggles; `None` if they do not increase.
    pub fn new(initial: bool, toggles: Vec<Time>) -> Option<Self> {
        toggles.is_sorted_by(|a, b| a < b).then(|| Self { initial, toggles: toggles.into() })
    }

    /// The value before the first toggle.
    pub fn initial(&self) -> bool {
        self.initial
    }

    /// The instants at which the value flips, strictly increasing.
    pub fn toggles(&self) -> &[Time] {
        &self.toggles
    }

    /// Whether the object is present at `time`; O(log k).
    pub fn at(&self, time: Time) -> bool {
        self.initial ^ (self.toggles.partition_point(|&t| t <= time) & 1 == 1)
    }

    /// Whether this is present at every instant at which `other` is (R11).
    pub fn includes(&self, other: &Behaviour) -> bool {
        if other.initial && !self.initial {
            return false;
        }
        // Between two neighbouring toggles of either nothing changes, so the toggles' instants suffice.
        other.toggles.iter().chain(self.toggles.iter()).all(|&t| !other.at(t) || self.at(t))
    }

    /// Which standard behaviour this is on [0, T], both ends included (H2): what is removed when
    /// the period ends was removed, what is there when it starts was not installed.
    pub fn preset(&self, period: TimeRange) -> Preset {
        let first = self.at(period.start);
        let until = |end| self.toggles.partition_point(|&t| t <= end);
        let inside = until(period.end).saturating_sub(until(period.start));
        match (first, inside) {
            (true, 0) => Preset::Static,
            (false, 0) => Preset::Absent,
            (false, 1) => Preset::Installed,
            (true, 1) => Preset::Removed,
            (false, 2) => Preset::Temporary,
            (true, 2) => Preset::Skipped,
            (false, 3) => Preset::ReInstalled,
            (true, 3) => Preset::ReDeleted,
            _ => Preset::Other,
        }
    }
}
