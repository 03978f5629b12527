//! Behaviour over time: binary for one object (H1, H2), weighted for a cluster (H7).

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

    /// Which standard behaviour this is within `period` (H2).
    pub fn preset(&self, period: TimeRange) -> Preset {
        let first = self.at(period.start);
        let inside = self.toggles.iter().filter(|&&t| period.start < t && t < period.end).count();
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

/// A right-continuous step function into [0, 1]: f_c of H7.
///
/// Rule: `values[i]` holds from `times[i - 1]` (included) to `times[i]` (excluded); `values[0]`
/// before everything. Times increase strictly; neighbouring values differ.
#[derive(Clone, PartialEq, Debug)]
pub struct StepFunction {
    times: Vec<Time>,
    values: Vec<f32>,
}

impl StepFunction {
    /// The same value at all times.
    pub fn constant(value: f32) -> Self {
        Self { times: Vec::new(), values: vec![value] }
    }

    /// The value at `time`; O(log k).
    pub fn at(&self, time: Time) -> f32 {
        self.values[self.times.partition_point(|&t| t <= time)]
    }

    /// Instants at which the value changes.
    pub fn times(&self) -> &[Time] {
        &self.times
    }

    /// One value more than there are times.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The weighted mean of behaviours (H7), with positive weights. Zero weights count as nothing.
    ///
    /// The result is exactly 0 where none is present and exactly 1 where all are.
    pub fn weighted_mean<'a>(parts: impl IntoIterator<Item = (f64, &'a Behaviour)>) -> Self {
        let mut total = 0.0f64;
        let mut count = 0i64;
        let (mut sum, mut present) = (0.0f64, 0i64);
        let mut events: Vec<(Time, f64, i64)> = Vec::new();
        for (weight, behaviour) in parts {
            total += weight;
            count += 1;
            let mut on = behaviour.initial();
            if on {
                sum += weight;
                present += 1;
            }
            for &t in behaviour.toggles() {
                on = !on;
                let sign = if on { 1 } else { -1 };
                events.push((t, weight * sign as f64, sign));
            }
        }
        events.sort_by_key(|e| e.0);
        let value = |sum: f64, present: i64| -> f32 {
            if present == 0 {
                0.0
            } else if present == count {
                1.0
            } else if total > 0.0 {
                // A share strictly between must not read as none or all.
                ((sum / total) as f32).clamp(f32::MIN_POSITIVE, 1.0 - f32::EPSILON)
            } else {
                present as f32 / count as f32
            }
        };
        let mut result = Self::constant(value(sum, present));
        let mut i = 0;
        while i < events.len() {
            let time = events[i].0;
            while i < events.len() && events[i].0 == time {
                sum += events[i].1;
                present += events[i].2;
                i += 1;
            }
            let now = value(sum, present);
            if result.values.last() != Some(&now) {
                result.times.push(time);
                result.values.push(now);
            }
        }
        result
    }

    /// D_F of H6: the mean of |f - g| over the period; 0 for an empty period.
    pub fn mean_difference(&self, other: &StepFunction, period: TimeRange) -> f64 {
        let length = period.seconds();
        if length == 0 {
            return 0.0;
        }
        let (mut i, mut j) = (0, 0);
        let mut from = period.start;
        i += self.times.partition_point(|&t| t <= from);
        j += other.times.partition_point(|&t| t <= from);
        let mut area = 0.0f64;
        while from < period.end {
            let next_a = self.times.get(i).copied().unwrap_or(Time::MAX);
            let next_b = other.times.get(j).copied().unwrap_or(Time::MAX);
            let until = next_a.min(next_b).min(period.end);
            let difference = f64::from(self.values[i]) - f64::from(other.values[j]);
            area += difference.abs() * (until.seconds() - from.seconds()) as f64;
            i += usize::from(next_a == until);
            j += usize::from(next_b == until);
            from = until;
        }
        area / length as f64
    }
}

impl From<&Behaviour> for StepFunction {
    fn from(behaviour: &Behaviour) -> Self {
        let value = |on: bool| if on { 1.0 } else { 0.0 };
        let values = (0..=behaviour.toggles.len())
            .map(|i| value(behaviour.initial ^ (i & 1 == 1)))
            .collect();
        Self { times: behaviour.toggles.to_vec(), values }
    }
}
