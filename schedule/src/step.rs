//! How much of a cluster is there over time, exactly (H7).

use crate::{Behaviour, Time, TimeRange};

/// f_c of H7: the weighted share of some objects that is present, a right-continuous step function
/// into [0, 1].
///
/// Weights are whole numbers, so sums are exact: the function does not depend on the order in which
/// objects were added or on what they were summed to before. It is 0 exactly when no object is
/// present and 1 exactly when all are.
///
/// Rule: `present[i]` holds from `times[i - 1]` (included) to `times[i]` (excluded); `present[0]`
/// before everything. Times increase strictly; neighbouring values differ; none exceeds `total`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct StepFunction {
    times: Vec<Time>,
    present: Vec<u64>,
    total: u64,
}

impl Default for StepFunction {
    /// Of no object: 0 at all times.
    fn default() -> Self {
        Self { times: Vec::new(), present: vec![0], total: 0 }
    }
}

impl StepFunction {
    /// Of one object; a weight of 0 counts as 1. The weights of all objects that are ever summed
    /// together must stay below 2^63.
    pub fn of(behaviour: &Behaviour, weight: u64) -> Self {
        let total = weight.max(1);
        let value = |i: usize| if behaviour.initial() ^ (i & 1 == 1) { total } else { 0 };
        Self {
            times: behaviour.toggles().to_vec(),
            present: (0..=behaviour.toggles().len()).map(value).collect(),
            total,
        }
    }

    /// Of many objects at once: the sum of [`StepFunction::of`] each.
    pub fn of_all<'a>(objects: impl IntoIterator<Item = (&'a Behaviour, u64)>) -> Self {
        let mut sum = Sum::default();
        for (behaviour, weight) in objects {
            let weight = weight.max(1);
            sum.total += weight;
            let mut there = behaviour.initial();
            sum.first += if there { weight } else { 0 };
            for &time in behaviour.toggles() {
                sum.changes.push((time, if there { -(weight as i64) } else { weight as i64 }));
                there = !there;
            }
        }
        sum.finish()
    }

    /// Of the objects of all parts together.
    pub fn sum<'a>(parts: impl IntoIterator<Item = &'a StepFunction>) -> Self {
        let mut sum = Sum::default();
        for part in parts {
            sum.total += part.total;
            sum.first += part.present[0];
            let steps = part.present.windows(2).map(|v| v[1] as i64 - v[0] as i64);
            sum.changes.extend(part.times.iter().copied().zip(steps));
        }
        sum.finish()
    }

    /// The share present at `time`; O(log k).
    pub fn at(&self, time: Time) -> f32 {
        self.share(self.times.partition_point(|&t| t <= time))
    }

    /// Instants at which the value changes.
    pub fn times(&self) -> &[Time] {
        &self.times
    }

    /// The shares before, between and after [`StepFunction::times`], one more than these.
    pub fn shares(&self) -> impl ExactSizeIterator<Item = f32> + '_ {
        (0..self.present.len()).map(|i| self.share(i))
    }

    /// Rounding does not reach 0 or 1.
    fn share(&self, place: usize) -> f32 {
        match self.present[place] {
            0 => 0.0,
            all if all == self.total => 1.0,
            _ => (self.exact_share(place) as f32).clamp(f32::MIN_POSITIVE, 1.0 - f32::EPSILON),
        }
    }

    fn exact_share(&self, place: usize) -> f64 {
        self.present[place] as f64 / self.total.max(1) as f64
    }

    /// D_F of H6: the mean of |f - g| over the period; 0 for an empty period.
    pub fn mean_difference(&self, other: &StepFunction, period: TimeRange) -> f64 {
        let length = period.seconds();
        if length == 0 {
            return 0.0;
        }
        let mut from = period.start;
        let mut i = self.times.partition_point(|&t| t <= from);
        let mut j = other.times.partition_point(|&t| t <= from);
        let mut area = 0.0f64;
        while from < period.end {
            let next_a = self.times.get(i).copied().unwrap_or(Time::MAX);
            let next_b = other.times.get(j).copied().unwrap_or(Time::MAX);
            let until = next_a.min(next_b).min(period.end);
            let difference = self.exact_share(i) - other.exact_share(j);
            area += difference.abs() * until.seconds().saturating_sub(from.seconds()) as f64;
            i += usize::from(next_a == until);
            j += usize::from(next_b == until);
            from = until;
        }
        area / length as f64
    }
}

/// A sum that is being collected.
#[derive(Default)]
struct Sum {
    total: u64,
    /// Present before everything.
    first: u64,
    /// By how much the present weight changes when, in no order.
    changes: Vec<(Time, i64)>,
}

impl Sum {
    fn finish(mut self) -> StepFunction {
        self.changes.sort_unstable_by_key(|c| c.0);
        let mut result =
            StepFunction { times: Vec::new(), present: vec![self.first], total: self.total };
        let mut now = self.first;
        for instant in self.changes.chunk_by(|a, b| a.0 == b.0) {
            let change: i64 = instant.iter().map(|c| c.1).sum();
            if change != 0 {
                now = now.checked_add_signed(change).expect("what leaves was present");
                result.times.push(instant[0].0);
                result.present.push(now);
            }
        }
        result
    }
}
