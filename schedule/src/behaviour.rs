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

    /// The weighted mean of step functions (H7). Weights are not negative; where all are zero the
    /// parts count equally.
    ///
    /// The result is exactly 0 where every part is 0 and exactly 1 where every part is 1, and
    /// strictly between otherwise, whatever the rounding and however small a part's weight.
    pub fn weighted_mean<'a>(parts: impl IntoIterator<Item = (f64, &'a StepFunction)>) -> Self {
        let parts: Vec<_> = parts.into_iter().collect();
        let given: f64 = parts.iter().map(|p| p.0).sum();
        let weight_of = |weight: f64| if given > 0.0 { weight } else { 1.0 };
        let total = if given > 0.0 { given } else { parts.len() as f64 };

        let mut now = Mean { total, parts: parts.len() as i64, ..Mean::default() };
        let mut events: Vec<(Time, f64, f32, f32)> = Vec::new();
        for &(weight, part) in &parts {
            let weight = weight_of(weight);
            now.change(weight, part.values[0], 1);
            for (i, &time) in part.times.iter().enumerate() {
                events.push((time, weight, part.values[i], part.values[i + 1]));
            }
        }
        events.sort_by_key(|e| e.0);
        let mut result = Self::constant(now.value());
        for instant in events.chunk_by(|a, b| a.0 == b.0) {
            for &(_, weight, before, after) in instant {
                now.change(weight, before, -1);
                now.change(weight, after, 1);
            }
            let value = now.value();
            if result.values.last() != Some(&value) {
                result.times.push(instant[0].0);
                result.values.push(value);
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
            area += difference.abs() * until.seconds().saturating_sub(from.seconds()) as f64;
            i += usize::from(next_a == until);
            j += usize::from(next_b == until);
            from = until;
        }
        area / length as f64
    }
}

/// A running weighted mean that counts what is exactly 0 and exactly 1.
#[derive(Default)]
struct Mean {
    total: f64,
    parts: i64,
    sum: f64,
    zeros: i64,
    ones: i64,
}

impl Mean {
    fn change(&mut self, weight: f64, value: f32, count: i64) {
        self.sum += weight * count as f64 * f64::from(value);
        self.zeros += if value == 0.0 { count } else { 0 };
        self.ones += if value == 1.0 { count } else { 0 };
    }

    fn value(&self) -> f32 {
        if self.zeros == self.parts {
            0.0
        } else if self.ones == self.parts {
            1.0
        } else {
            ((self.sum / self.total) as f32).clamp(f32::MIN_POSITIVE, 1.0 - f32::EPSILON)
        }
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
