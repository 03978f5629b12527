//! How much of a cluster is there over time, in bounded memory (R13).

use crate::{StepFunction, Time};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::RangeInclusive;

/// What is known of a share: it lies in `lo..=hi`.
#[derive(Clone, Copy, PartialEq, Debug, serde::Serialize, serde::Deserialize)]
pub struct Share {
    /// No smaller; in [0, 1].
    pub lo: f32,
    /// No larger; in [0, 1].
    pub hi: f32,
}

impl Share {
    /// A share that is known.
    pub const fn exactly(value: f32) -> Self {
        Self { lo: value, hi: value }
    }

    fn union(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Whether everything is there or nothing is.
    fn is_settled(self) -> bool {
        self.lo == self.hi && (self.lo == 0.0 || self.lo == 1.0)
    }
}

/// A [`StepFunction`] of which at most so many steps are kept: where there were more, neighbouring
/// spans were merged and only the smallest and the largest value in them is known (R13).
///
/// Rule: `shares[i]` holds from `times[i - 1]` (included) to `times[i]` (excluded); `shares[0]`
/// before everything. Times increase strictly; neighbouring shares differ; 0 <= lo <= hi <= 1.
#[derive(Clone, PartialEq, Debug, serde::Serialize, serde::Deserialize)]
#[serde(from = "Steps")]
pub struct BoundedStep {
    times: Box<[Time]>,
    shares: Box<[Share]>,
    /// From the first instant at which something may be there to the last.
    #[serde(skip)]
    hull: RangeInclusive<Time>,
}

/// What a [`BoundedStep`] is written as.
#[derive(serde::Deserialize)]
struct Steps {
    times: Box<[Time]>,
    shares: Box<[Share]>,
}

impl From<Steps> for BoundedStep {
    fn from(Steps { times, shares }: Steps) -> Self {
        let some = |share: &Share| share.hi > 0.0;
        let from = match shares.iter().position(some) {
            Some(0) => Time::MIN,
            Some(i) => times.get(i - 1).copied().unwrap_or(Time::MAX),
            None => return Self { times, shares, hull: Time::MAX..=Time::MIN },
        };
        let until = shares.iter().rposition(some).and_then(|i| times.get(i));
        let hull = from..=until.map_or(Time::MAX, |until| until.plus_seconds(-1));
        Self { times, shares, hull }
    }
}

impl BoundedStep {
    /// Keeps at most `steps` instants of change, all of them if there are no more.
    ///
    /// Spans are merged, one pair at a time, where that adds least to the area between lo and hi.
    /// Those in which everything or nothing is present are merged last: there a cluster costs
    /// nothing, or has no error in time.
    pub fn new(exact: &StepFunction, steps: usize) -> Self {
        let mut spans = Spans::of(exact);
        if exact.times().len() > steps {
            spans.merge_down_to(steps);
        }
        spans.finish()
    }

    /// The same share at all times.
    pub fn constant(share: f32) -> Self {
        Steps { times: Box::default(), shares: [Share::exactly(share)].into() }.into()
    }

    /// False only where nothing is there: before the first and after the last instant with something.
    /// O(1), and without a look at the steps.
    pub fn may_be_present(&self, time: Time) -> bool {
        self.hull.contains(&time)
    }

    /// What is known of the share at `time`; O(log k), and one comparison from
    /// [`BoundedStep::constant_from`] on.
    pub fn at(&self, time: Time) -> Share {
        match self.times.last() {
            Some(&last) if time < last => self.shares[self.times.partition_point(|&t| t <= time)],
            _ => self.shares[self.times.len()],
        }
    }

    /// From this instant on nothing changes.
    pub fn constant_from(&self) -> Time {
        self.times.last().copied().unwrap_or(Time::MIN)
    }

    /// Instants at which the share changes.
    pub fn times(&self) -> &[Time] {
        &self.times
    }

    /// One share more than there are times.
    pub fn shares(&self) -> &[Share] {
        &self.shares
    }

    /// Whether the rule above holds; a function that was read from a file may break it.
    pub fn is_valid(&self) -> bool {
        let sound = |s: &Share| 0.0 <= s.lo && s.lo <= s.hi && s.hi <= 1.0;
        self.shares.len() == self.times.len() + 1
            && self.times.is_sorted_by(|a, b| a < b)
            && self.shares.iter().all(sound)
            && self.shares.windows(2).all(|pair| pair[0] != pair[1])
    }

    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        size_of_val(&*self.times) + size_of_val(&*self.shares)
    }
}

/// Spans in a linked list, so that neighbours are merged in place.
struct Spans {
    spans: Vec<Span>,
    alive: usize,
}

struct Span {
    /// Its first instant; of no meaning for the first span.
    from: Time,
    /// Seconds; what is before and after everything counts as long as all the rest.
    length: f64,
    share: Share,
    before: Option<usize>,
    after: Option<usize>,
    /// Counts up with every change, so that entries of the heap can be told to be out of date.
    version: u32,
    merged: bool,
}

/// What merging a span with the next one costs: first whether it ends a settled span, then the
/// added area as the bits of a float that is not negative, which sort like the float.
type Cost = (bool, u64);

/// The next merge comes out first: cost, place of the span, versions of both.
type Queue = BinaryHeap<Reverse<(Cost, usize, u32, u32)>>;

impl Spans {
    fn of(exact: &StepFunction) -> Self {
        let times = exact.times();
        let count = times.len() + 1;
        let length = |a: Time, b: Time| b.seconds().saturating_sub(a.seconds()) as f64;
        let all = match (times.first(), times.last()) {
            (Some(&first), Some(&last)) => length(first, last).max(1.0),
            _ => 1.0,
        };
        let shares = exact.shares().enumerate();
        let spans = shares.map(|(i, share)| Span {
            from: if i == 0 { Time::MIN } else { times[i - 1] },
            length: if i == 0 || i + 1 == count { all } else { length(times[i - 1], times[i]) },
            share: Share::exactly(share),
            before: i.checked_sub(1),
            after: (i + 1 < count).then_some(i + 1),
            version: 0,
            merged: false,
        });
        Self { spans: spans.collect(), alive: count }
    }

    fn merge_down_to(&mut self, steps: usize) {
        let mut queue = Queue::with_capacity(self.alive);
        for i in 0..self.spans.len() {
            self.offer(i, &mut queue);
        }
        while self.alive > steps + 1 {
            let Some(Reverse((_, first, version, next_version))) = queue.pop() else { return };
            let Some(second) = self.spans[first].after else { continue };
            let current = !self.spans[first].merged
                && self.spans[first].version == version
                && self.spans[second].version == next_version;
            if current {
                self.merge(first, second);
                self.offer(first, &mut queue);
                if let Some(before) = self.spans[first].before {
                    self.offer(before, &mut queue);
                }
            }
        }
    }

    fn offer(&self, first: usize, queue: &mut Queue) {
        let Some(second) = self.spans[first].after else { return };
        let (a, b) = (&self.spans[first], &self.spans[second]);
        let both = a.share.union(b.share);
        let width = |s: Share| f64::from(s.hi) - f64::from(s.lo);
        let added =
            (width(both) - width(a.share)) * a.length + (width(both) - width(b.share)) * b.length;
        let cost = (a.share.is_settled() || b.share.is_settled(), added.max(0.0).to_bits());
        queue.push(Reverse((cost, first, a.version, b.version)));
    }

    fn merge(&mut self, first: usize, second: usize) {
        let (share, length, after) =
            (self.spans[second].share, self.spans[second].length, self.spans[second].after);
        self.spans[second].merged = true;
        let span = &mut self.spans[first];
        span.share = span.share.union(share);
        span.length += length;
        span.after = after;
        span.version += 1;
        if let Some(after) = after {
            self.spans[after].before = Some(first);
        }
        self.alive -= 1;
    }

    fn finish(self) -> BoundedStep {
        let mut times = Vec::with_capacity(self.alive.saturating_sub(1));
        let mut shares: Vec<Share> = Vec::with_capacity(self.alive);
        for span in self.spans.iter().filter(|s| !s.merged) {
            // Spans of equal value that merging brought side by side are one.
            if shares.last() != Some(&span.share) {
                if !shares.is_empty() {
                    times.push(span.from);
                }
                shares.push(span.share);
            }
        }
        Steps { times: times.into(), shares: shares.into() }.into()
    }
}
