//! Which behaviour may stand in for which: the temporal half of the certificate (R11).

use crate::{BehaviourId, Element};
use topout_schedule::{Behaviour, Time};

/// w of an element in [`topout_schedule::StepFunction`]: the diameter of its box (R2) in whole
/// micrometres, at most 1,000 km, so that the sum of a million elements has room.
pub(crate) fn presence_weight(element: &Element) -> u64 {
    const LARGEST_M: f64 = 1e6;
    (f64::from(element.bounds.diameter()).min(LARGEST_M) * 1e6) as u64
}

/// The interval around all presence of a behaviour.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Hull {
    /// First instant of presence; `Time::MIN` for "from the beginning".
    pub on: Time,
    /// First instant after the last presence; `Time::MAX` for "to the end".
    pub off: Time,
    /// Whether the behaviour is present at every instant of the interval.
    pub solid: bool,
}

impl Hull {
    pub fn of(behaviour: &Behaviour) -> Self {
        let toggles = behaviour.toggles();
        let on = if behaviour.initial() {
            Time::MIN
        } else {
            toggles.first().copied().unwrap_or(Time::MAX)
        };
        let ends_present = behaviour.initial() ^ (toggles.len() & 1 == 1);
        let off =
            if ends_present { Time::MAX } else { toggles.last().copied().unwrap_or(Time::MIN) };
        let rises = usize::from(behaviour.initial())
            + (toggles.len() + usize::from(!behaviour.initial())) / 2;
        Self { on, off, solid: rises <= 1 }
    }

    /// The order of runs: 0 for what stays to the end once it came, by its coming; 1 for what was
    /// there from the beginning, the last to go first; 2 for the rest.
    pub fn order(&self) -> (u8, i64) {
        match (self.solid, self.on, self.off) {
            (true, on, Time::MAX) => (0, on.seconds()),
            // Not negated: the beginning of time has no opposite.
            (true, Time::MIN, off) => (1, !off.seconds()),
            (_, on, _) => (2, on.seconds()),
        }
    }
}

/// All behaviours of a scene, prepared for the question "is a there whenever b is?".
pub(crate) struct PresenceTable<'a> {
    behaviours: &'a [Behaviour],
    hulls: Vec<Hull>,
    time_exact: bool,
}

impl<'a> PresenceTable<'a> {
    /// `time_exact` false: time does not matter (mode `paper`), everything includes everything.
    pub fn new(behaviours: &'a [Behaviour], time_exact: bool) -> Self {
        Self { behaviours, hulls: behaviours.iter().map(Hull::of).collect(), time_exact }
    }

    /// The interval around all presence.
    pub fn hull(&self, id: BehaviourId) -> Hull {
        self.hulls[id.index()]
    }

    /// What must be spanned by whatever is present whenever this behaviour is: the interval around
    /// all presence, everything where time does not matter.
    pub fn span(&self, id: BehaviourId) -> (Time, Time) {
        let hull = self.hull(id);
        if self.time_exact { (hull.on, hull.off) } else { (Time::MIN, Time::MAX) }
    }

    /// Whether `a` is present at every instant at which `b` is.
    pub fn includes(&self, a: BehaviourId, b: BehaviourId) -> bool {
        if a == b || !self.time_exact {
            return true;
        }
        let (outer, inner) = (self.hulls[a.index()], self.hulls[b.index()]);
        if outer.solid || outer.on > inner.on || outer.off < inner.off {
            return outer.on <= inner.on && outer.off >= inner.off;
        }
        self.behaviours[a.index()].includes(&self.behaviours[b.index()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn behaviour() -> impl Strategy<Value = Behaviour> {
        (any::<bool>(), proptest::collection::btree_set(0i64..12, 0..5)).prop_map(
            |(initial, times)| {
                Behaviour::new(initial, times.into_iter().map(Time::from_seconds).collect())
                    .expect("a set iterates in increasing order")
            },
        )
    }

    proptest! {
        #[test]
        fn inclusion_equals_asking_at_every_instant(a in behaviour(), b in behaviour()) {
            let table_of = [a.clone(), b.clone()];
            let table = PresenceTable::new(&table_of, true);
            let every = (-1..14).map(Time::from_seconds).all(|t| !b.at(t) || a.at(t));
            prop_assert_eq!(table.includes(BehaviourId(0), BehaviourId(1)), every);
        }

        #[test]
        fn a_hull_holds_all_presence(a in behaviour()) {
            let hull = Hull::of(&a);
            for t in (-1..14).map(Time::from_seconds) {
                let inside = hull.on <= t && t < hull.off;
                prop_assert!(!a.at(t) || inside);
                prop_assert!(!(hull.solid && inside) || a.at(t));
            }
        }
    }
}
