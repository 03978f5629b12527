//! What can be taken back: what is hidden, what is cut away, and the dates of activities.

use super::section::Section;
use super::visibility::Visibility;
use topout_schedule::TimeRange;

/// Changes that are kept.
const KEPT: usize = 200;

/// What has to be set to take a change back, or to make it again.
#[derive(Clone, PartialEq, Debug)]
pub enum Change {
    /// What was hidden.
    Visibility(Visibility),
    /// What was cut away.
    Section(Section),
    /// The dates that activities had, by their places in the schedule.
    Dates(Vec<(usize, TimeRange)>),
}

/// Changes in their order.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct History {
    done: Vec<Change>,
    undone: Vec<Change>,
}

impl History {
    /// Remembers what was before a change; what was undone before it cannot be made again.
    pub fn push(&mut self, before: Change) {
        self.undone.clear();
        if self.done.len() == KEPT {
            self.done.remove(0);
        }
        self.done.push(before);
    }

    /// Takes the last change back (or makes it again): returns what has to be set. `now` says what is set
    /// now in its place, and gets what has to be set.
    pub fn step(&mut self, back: bool, now: impl FnOnce(&Change) -> Change) -> Option<Change> {
        let (from, to) = match back {
            true => (&mut self.done, &mut self.undone),
            false => (&mut self.undone, &mut self.done),
        };
        let change = from.pop()?;
        to.push(now(&change));
        Some(change)
    }

    /// Whether there is something to take back, and something to make again.
    pub fn reach(&self) -> (bool, bool) {
        (!self.done.is_empty(), !self.undone.is_empty())
    }

    /// Other activities: their dates can no longer be set.
    pub fn forget_dates(&mut self) {
        let stays = |change: &Change| !matches!(change, Change::Dates(_));
        self.done.retain(stays);
        self.undone.retain(stays);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use topout_schedule::Time;

    fn dates(day: i64) -> Change {
        let time = Time::from_seconds(day);
        Change::Dates(vec![(0, TimeRange { start: time, end: time })])
    }

    #[test]
    fn changes_are_taken_back_and_made_again_in_their_order() {
        let (mut history, mut now) = (History::default(), dates(0));
        for day in 1..4 {
            history.push(now);
            now = dates(day);
        }
        let go = |history: &mut History, now: &mut Change, back| {
            let next = history.step(back, |_| now.clone());
            next.map(|next| *now = next).is_some()
        };
        assert!(go(&mut history, &mut now, true) && go(&mut history, &mut now, true));
        assert_eq!((&now, history.reach()), (&dates(1), (true, true)));
        assert!(go(&mut history, &mut now, false));
        assert_eq!(now, dates(2));
        history.push(now);
        now = dates(9);
        assert!(!go(&mut history, &mut now, false), "another change was made since");
        for _ in 0..3 {
            assert!(go(&mut history, &mut now, true));
        }
        assert!(!go(&mut history, &mut now, true));
        assert_eq!(now, dates(0));
        history.forget_dates();
        assert_eq!(history.reach(), (false, false));
    }
}
