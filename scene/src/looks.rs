//! How elements look in the course of time: in their own colours, or as what is done to them says.

use crate::{ElementId, Scene};
use std::collections::HashMap;
use topout_schedule::{Look, Time, appearance};

/// A place in [`Looks::palette`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug, Default)]
pub struct LookId(pub u16);

impl LookId {
    /// The elements' own look.
    pub const OWN: LookId = LookId(0);

    /// As an index into the palette.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// A look of an element for a while: from `start` on, until `end`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Spell {
    pub start: Time,
    pub end: Time,
    pub element: ElementId,
    pub look: LookId,
}

/// Which elements look other than they are, and when.
#[derive(Clone, PartialEq, Debug)]
pub struct Looks {
    palette: Vec<Look>,
    /// By start. The middle of all is the root of a tree, the middles of both halves are its children.
    spells: Vec<Spell>,
    /// For each spell the last end in the part of which it is the middle.
    last_ends: Vec<Time>,
    previews: Vec<LookId>,
}

impl Default for Looks {
    /// Everything as it is.
    fn default() -> Self {
        Self::new(vec![Look::OWN], Vec::new())
    }
}

impl Looks {
    /// What activities make of their elements ([`appearance`]): mostly colours while they last.
    /// Elements with the same activities are worked out once.
    pub fn of_activities(scene: &Scene) -> Self {
        let activities = &scene.schedule.activities;
        let mut palette = vec![Look::OWN];
        let mut steps_of: HashMap<&[u32], Vec<(Time, LookId)>> = HashMap::new();
        let mut spells = Vec::new();
        for element in (0..scene.model.elements.len() as u32).map(ElementId) {
            let list = scene.activities_of(element);
            let steps = steps_of.entry(list).or_insert_with(|| {
                let all = list.iter().map(|&a| &activities[a as usize]);
                let steps = appearance(&scene.schedule.kinds, all).into_iter();
                steps.map(|(time, look)| (time, id_of(&mut palette, look))).collect()
            });
            for (i, &(start, look)) in steps.iter().enumerate() {
                let end = steps.get(i + 1).map_or(Time::MAX, |next| next.0);
                if look != LookId::OWN {
                    spells.push(Spell { start, end, element, look });
                }
            }
        }
        Self::new(palette, spells)
    }

    /// Looks that do not change; elements without one look as they are.
    pub fn fixed(looks: impl IntoIterator<Item = (ElementId, Look)>) -> Self {
        let mut palette = vec![Look::OWN];
        let spell = |(element, look)| {
            let look = id_of(&mut palette, look);
            Spell { start: Time::MIN, end: Time::MAX, element, look }
        };
        let mut spells: Vec<Spell> = looks.into_iter().map(spell).collect();
        spells.retain(|spell| spell.look != LookId::OWN);
        Self::new(palette, spells)
    }

    /// The same, but for some elements that have a look all the time, whatever it was.
    #[must_use]
    pub fn overridden(&self, looks: &[(ElementId, Look)]) -> Self {
        let mut palette = self.palette.clone();
        let last = looks.iter().map(|(element, _)| element.index()).max();
        let mut named = vec![false; last.map_or(0, |last| last + 1)];
        looks.iter().for_each(|(element, _)| named[element.index()] = true);
        let stays = |spell: &&Spell| !named.get(spell.element.index()).is_some_and(|named| *named);
        let mut spells: Vec<Spell> = self.spells.iter().filter(stays).copied().collect();
        spells.extend(looks.iter().map(|&(element, look)| {
            let look = id_of(&mut palette, look);
            Spell { start: Time::MIN, end: Time::MAX, element, look }
        }));
        spells.retain(|spell| spell.look != LookId::OWN);
        Self::with_previews(palette, spells, self.previews.clone())
    }

    fn new(palette: Vec<Look>, spells: Vec<Spell>) -> Self {
        Self::with_previews(palette, spells, Vec::new())
    }

    pub(crate) fn with_previews(
        palette: Vec<Look>,
        mut spells: Vec<Spell>,
        previews: Vec<LookId>,
    ) -> Self {
        spells.sort_unstable_by_key(|s| (s.start, s.element));
        let mut last_ends = vec![Time::MIN; spells.len()];
        fill_last_ends(&spells, &mut last_ends);
        Self { palette, spells, last_ends, previews }
    }

    /// All looks that occur; the first is the elements' own.
    pub fn palette(&self) -> &[Look] {
        &self.palette
    }

    /// Whether elements of this look are drawn although they are not there yet.
    pub fn is_preview(&self, look: LookId) -> bool {
        self.previews.contains(&look)
    }

    /// The elements that look other than they are at a time, whether they are there or not, in no order;
    /// O(log n) and what there is of them.
    pub fn at(&self, time: Time, mut found: impl FnMut(ElementId, LookId)) {
        self.stab(0, self.spells.len(), time, &mut found);
    }

    /// Those of a part of the spells.
    fn stab(&self, from: usize, to: usize, time: Time, found: &mut impl FnMut(ElementId, LookId)) {
        if from == to {
            return;
        }
        let middle = from.midpoint(to);
        let forever = self.last_ends[middle] == Time::MAX;
        if self.last_ends[middle] <= time && !forever {
            return;
        }
        self.stab(from, middle, time, found);
        let spell = &self.spells[middle];
        if spell.start <= time {
            if time < spell.end || spell.end == Time::MAX {
                found(spell.element, spell.look);
            }
            self.stab(middle + 1, to, time, found);
        }
    }
}

/// Returns the last end of all of a part.
fn fill_last_ends(spells: &[Spell], last_ends: &mut [Time]) -> Time {
    if spells.is_empty() {
        return Time::MIN;
    }
    let middle = 0usize.midpoint(spells.len());
    let left = fill_last_ends(&spells[..middle], &mut last_ends[..middle]);
    let right = fill_last_ends(&spells[middle + 1..], &mut last_ends[middle + 1..]);
    last_ends[middle] = left.max(right).max(spells[middle].end);
    last_ends[middle]
}

/// The place of a look in the palette, where it is added if need be; its own look if there are too many.
pub(crate) fn id_of(palette: &mut Vec<Look>, look: Look) -> LookId {
    let known = palette.iter().position(|l| *l == look).unwrap_or_else(|| {
        palette.push(look);
        palette.len() - 1
    });
    match u16::try_from(known) {
        Ok(id) if id < u16::MAX => LookId(id),
        _ => LookId::OWN,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Element, Model, link};
    use proptest::prelude::*;
    use topout_schedule::{Activity, ActivityKind, Diagnostics, Schedule};

    fn t(seconds: i64) -> Time {
        Time::from_seconds(seconds)
    }

    fn at(looks: &Looks, time: Time) -> Vec<(u32, Look)> {
        let mut all = Vec::new();
        looks.at(time, |e, look| all.push((e.0, looks.palette()[look.index()])));
        all.sort_by_key(|e| e.0);
        all
    }

    proptest! {
        #[test]
        fn every_element_has_the_look_of_its_activities(
            activities in proptest::collection::vec(
                (0i64..40, 0i64..20, 0usize..6, proptest::collection::vec(0u8..10, 0..4)), 1..20),
        ) {
            let activities = activities.iter().enumerate().map(|(i, (start, length, kind, on))| {
                Activity {
                    id: format!("a{i}"),
                    start: Some(t(*start)),
                    end: Some(t(start + length)),
                    kind: ActivityKind::WORDS[*kind].1,
                    elements: on.iter().map(|e| format!("e{e}")).collect(),
                    ..Activity::default()
                }
            });
            let schedule =
                Schedule::new(String::new(), None, activities.collect(), Diagnostics::default());
            let element = |i| Element { name: format!("e{i}"), ..Element::default() };
            let model = Model { elements: (0..10).map(element).collect(), ..Model::default() };
            let scene = link::link(model, schedule);
            let looks = Looks::of_activities(&scene);
            for time in (-1..62).map(t).chain([Time::MIN, Time::MAX]) {
                let mut expected = Vec::new();
                for e in 0..10 {
                    let list = scene.activities_of(ElementId(e)).iter();
                    let list = list.map(|&a| &scene.schedule.activities[a as usize]);
                    let steps = appearance(&scene.schedule.kinds, list);
                    let look = steps.iter().rfind(|s| s.0 <= time).unwrap().1;
                    expected.extend((look != Look::OWN).then_some((e, look)));
                }
                prop_assert_eq!(at(&looks, time), expected);
            }
        }
    }

    #[test]
    fn fixed_looks_last() {
        let red = Look::colored([255, 0, 0]);
        let given = [(ElementId(4), red), (ElementId(2), Look::OWN), (ElementId(7), red)];
        let looks = Looks::fixed(given);
        for time in [Time::MIN, t(0), Time::MAX] {
            assert_eq!(at(&looks, time), [(4, red), (7, red)]);
        }
        assert_eq!(looks.palette(), [Look::OWN, red]);
        assert_eq!(at(&Looks::default(), t(0)), []);
        let other = [(ElementId(7), Look::HIDDEN), (ElementId(9), red), (ElementId(4), Look::OWN)];
        assert_eq!(at(&looks.overridden(&other), t(5)), [(7, Look::HIDDEN), (9, red)]);
        assert_eq!(looks.overridden(&[]), looks);
    }
}
