//! Other dates for the same model: a scene whose activities were moved.

use crate::link::{self, presence_by_activities};
use crate::{BehaviourId, ElementId, Scene};
use std::collections::HashMap;
use std::sync::Arc;
use topout_schedule::{Activity, Behaviour, Schedule, TimeRange};

/// A scene made of another one by an edit of its schedule.
///
/// Behaviours keep their ids and new ones are appended, so a tree that was built for the scene
/// before can be brought along by [`crate::Hdlod::restate`].
#[derive(Clone, Debug)]
pub struct Edited {
    /// The scene with the new dates; shares the model.
    pub scene: Scene,
    /// The elements whose behaviour is another one now, in order.
    pub changed: Vec<ElementId>,
    /// Activities that have other dates now.
    pub moved: usize,
}

/// Other ids for behaviours: what [`Scene::renumbered`] made of the old ones.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Renumbering(Vec<Option<BehaviourId>>);

impl Renumbering {
    /// The id now; `None` where no element has the behaviour any more.
    pub fn now(&self, old: BehaviourId) -> Option<BehaviourId> {
        self.0.get(old.index()).copied().flatten()
    }
}

/// Why activities cannot be moved.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum EditError {
    /// There is no such activity.
    #[error("there is no activity number {index}: the schedule has {count}")]
    NoActivity {
        /// The index that was asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// It would end before it starts.
    #[error("activity {id:?} would end {} before its start {}", dates.end, dates.start)]
    Reversed {
        /// The activity's id.
        id: String,
        /// The dates that were asked for.
        dates: TimeRange,
    },
}

impl Scene {
    /// Moves activities, given by their index in [`Schedule::activities`]; of several dates for one
    /// activity the last count. The project's period stays, also where an activity leaves it.
    /// Returns the elements whose behaviour is another one now, in order.
    ///
    /// # Errors
    /// When an activity does not exist or would end before it starts; nothing was moved then.
    pub fn move_activities(
        &mut self,
        moves: &[(usize, TimeRange)],
    ) -> Result<Vec<ElementId>, EditError> {
        let count = self.schedule.activities.len();
        for &(index, dates) in moves {
            let activity = self.schedule.activities.get(index);
            let activity = activity.ok_or(EditError::NoActivity { index, count })?;
            if dates.end < dates.start {
                return Err(EditError::Reversed { id: activity.id.clone(), dates });
            }
        }
        let mut moved = vec![false; count];
        for &(index, dates) in moves {
            let activity = &mut self.schedule.activities[index];
            (activity.start, activity.end) = (Some(dates.start), Some(dates.end));
            moved[index] = true;
        }
        Ok(self.follow_activities(&moved))
    }

    /// [`Scene::move_activities`] on a copy.
    ///
    /// # Errors
    /// The same.
    pub fn with_activity_dates(&self, moves: &[(usize, TimeRange)]) -> Result<Edited, EditError> {
        let mut scene = self.clone();
        let changed = scene.move_activities(moves)?;
        let moved = moved_between(&self.schedule.activities, &scene.schedule.activities);
        Ok(Edited { scene, changed, moved: moved.into_iter().filter(|m| *m).count() })
    }

    /// The same scene with a schedule whose activities are the same and in the same order and
    /// differ in dates, names and fields at most, with the same kinds; `None` for any other, which
    /// has to be linked ([`Scene::relinked`]). Where rules look at names and fields, they are applied
    /// again.
    pub fn with_schedule(&self, schedule: Schedule) -> Option<Edited> {
        let alike = |a: &Activity, b: &Activity| {
            a.id == b.id && a.kind == b.kind && a.active == b.active && a.elements == b.elements
        };
        let (ours, theirs) = (&self.schedule.activities, &schedule.activities);
        let same_kinds = self.schedule.kinds == schedule.kinds;
        if !same_kinds
            || ours.len() != theirs.len()
            || !ours.iter().zip(theirs).all(|(a, b)| alike(a, b))
        {
            return None;
        }
        let moved = moved_between(ours, theirs);
        let count = moved.iter().filter(|m| **m).count();
        if !self.rules.only_elements() {
            let links = link::links_again(self, &schedule);
            let (scene, changed) = self.with_links(schedule, links);
            return Some(Edited { scene, changed, moved: count });
        }
        let mut scene = Scene {
            model: Arc::clone(&self.model),
            schedule,
            behaviours: self.behaviours.clone(),
            element_behaviour: self.element_behaviour.clone(),
            activity_starts: self.activity_starts.clone(),
            activity_links: self.activity_links.clone(),
            rules: Arc::clone(&self.rules),
            rule_reports: self.rule_reports.clone(),
            link_diagnostics: self.link_diagnostics.clone(),
            diagnostics: Default::default(),
        };
        scene.collect_diagnostics();
        let changed = scene.follow_activities(&moved);
        Some(Edited { scene, changed, moved: count })
    }

    /// The same model and schedule linked by other rules.
    pub fn with_rules(&self, rules: link::Rules) -> Edited {
        let mut asked = self.clone();
        asked.rules = Arc::new(rules);
        let links = link::links_again(&asked, &self.schedule);
        let (scene, changed) = asked.with_links(self.schedule.clone(), links);
        Edited { scene, changed, moved: 0 }
    }

    /// The same model linked anew, by the same rules, to any schedule.
    pub fn relinked(&self, schedule: Schedule) -> Scene {
        link::link_by(Arc::clone(&self.rules), Arc::clone(&self.model), schedule)
    }

    /// This scene with other links; behaviours keep their ids, new ones are appended. Returns the
    /// elements whose behaviour is another one now, in order.
    fn with_links(&self, schedule: Schedule, links: link::Linked) -> (Scene, Vec<ElementId>) {
        let mut scene = Scene {
            model: Arc::clone(&self.model),
            schedule,
            behaviours: self.behaviours.clone(),
            element_behaviour: self.element_behaviour.clone(),
            activity_starts: links.activity_starts,
            activity_links: links.activity_links,
            rules: Arc::clone(&self.rules),
            rule_reports: links.reports,
            link_diagnostics: links.diagnostics,
            diagnostics: Default::default(),
        };
        link::note_unlinked(&mut scene);
        scene.collect_diagnostics();
        let changed = scene.follow(&|_| true);
        (scene, changed)
    }

    /// The same scene with its behaviours numbered as linking numbers them: in the order of the
    /// elements, without those that edits left behind. So a scene that was edited and one that was
    /// loaded with the same dates have the same [`crate::cache::Key`].
    pub fn renumbered(&self) -> (Scene, Renumbering) {
        let mut now: Vec<Option<BehaviourId>> = vec![None; self.behaviours.len()];
        let mut scene = self.clone();
        scene.behaviours.clear();
        for id in &mut scene.element_behaviour {
            let old = id.index();
            *id = *now[old].get_or_insert_with(|| {
                scene.behaviours.push(self.behaviours[old].clone());
                BehaviourId(scene.behaviours.len() as u32 - 1)
            });
        }
        (scene, Renumbering(now))
    }

    /// Works out anew the behaviours of the elements that moved activities touch.
    fn follow_activities(&mut self, moved: &[bool]) -> Vec<ElementId> {
        self.follow(&|activities| activities.iter().any(|&a| moved[a as usize]))
    }

    /// Works out anew the behaviours of the elements whose activities are such.
    fn follow(&mut self, such: &dyn Fn(&[u32]) -> bool) -> Vec<ElementId> {
        let mut table = Table::new(&self.behaviours);
        let mut by_activities: HashMap<&[u32], BehaviourId> = HashMap::new();
        let mut changes = Vec::new();
        for id in (0..self.element_behaviour.len() as u32).map(ElementId) {
            let activities = self.activities_of(id);
            if !such(activities) {
                continue;
            }
            let behaviour = *by_activities.entry(activities).or_insert_with(|| {
                let Schedule { kinds, activities: all, .. } = &self.schedule;
                table.id_of(presence_by_activities(kinds, all, activities))
            });
            if self.element_behaviour[id.index()] != behaviour {
                changes.push((id, behaviour));
            }
        }
        let new = table.new;
        self.behaviours.extend(new);
        for &(id, behaviour) in &changes {
            self.element_behaviour[id.index()] = behaviour;
        }
        changes.into_iter().map(|c| c.0).collect()
    }
}

/// For each activity whether its dates differ.
fn moved_between(before: &[Activity], after: &[Activity]) -> Vec<bool> {
    let dates = |a: &Activity| (a.start, a.end);
    before.iter().zip(after).map(|(a, b)| dates(a) != dates(b)).collect()
}

/// Behaviours by value; the new ones get ids after the old ones.
struct Table<'a> {
    old: HashMap<&'a Behaviour, BehaviourId>,
    new_ids: HashMap<Behaviour, BehaviourId>,
    new: Vec<Behaviour>,
}

impl<'a> Table<'a> {
    fn new(old: &'a [Behaviour]) -> Self {
        let old = old.iter().zip(0..).map(|(b, i)| (b, BehaviourId(i))).collect();
        Self { old, new_ids: HashMap::new(), new: Vec::new() }
    }

    fn id_of(&mut self, behaviour: Behaviour) -> BehaviourId {
        if let Some(&id) = self.old.get(&behaviour) {
            return id;
        }
        let next = BehaviourId((self.old.len() + self.new.len()) as u32);
        *self.new_ids.entry(behaviour).or_insert_with_key(|behaviour| {
            self.new.push(behaviour.clone());
            next
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Element, Model, link};
    use proptest::prelude::*;
    use topout_schedule::{ActivityKind, Diagnostics, Time};

    fn range(start: i64, end: i64) -> TimeRange {
        TimeRange { start: Time::from_seconds(start), end: Time::from_seconds(end) }
    }

    /// Elements `e0` to `e9`, each activity on some of them.
    fn schedule(activities: &[(i64, i64, u8, Vec<u8>)]) -> Schedule {
        let kinds = [ActivityKind::Construct, ActivityKind::Demolish, ActivityKind::Temporary];
        let activities = activities.iter().enumerate().map(|(i, (start, length, kind, on))| {
            let dates = range(*start, start + length);
            Activity {
                id: format!("a{i}"),
                start: Some(dates.start),
                end: Some(dates.end),
                kind: kinds[usize::from(*kind)],
                elements: on.iter().map(|e| format!("e{e}")).collect(),
                ..Activity::default()
            }
        });
        let period = Some(range(0, 100));
        Schedule::new(String::new(), period, activities.collect(), Diagnostics::default())
    }

    fn model() -> Model {
        let element = |i| Element { name: format!("e{i}"), ..Element::default() };
        Model { elements: (0..10).map(element).collect(), ..Model::default() }
    }

    proptest! {
        /// An edit gives what linking the edited schedule gives, and can be undone.
        #[test]
        fn moving_equals_linking_again(
            activities in proptest::collection::vec(
                (0i64..60, 0i64..20, 0u8..3, proptest::collection::vec(0u8..10, 0..4)), 1..12),
            moves in proptest::collection::vec((0usize..12, 0i64..60, 0i64..20), 0..5),
        ) {
            let scene = link::link(model(), schedule(&activities));
            let mut edited_rows = activities.clone();
            let mut dates = Vec::new();
            for &(activity, start, length) in moves.iter().filter(|m| m.0 < activities.len()) {
                (edited_rows[activity].0, edited_rows[activity].1) = (start, length);
                dates.push((activity, range(start, start + length)));
            }
            let linked = link::link(model(), schedule(&edited_rows));
            let edited = scene.with_activity_dates(&dates).unwrap();
            for e in (0..10).map(ElementId) {
                prop_assert_eq!(edited.scene.behaviour(e), linked.behaviour(e));
                let changed = scene.behaviour(e) != linked.behaviour(e);
                prop_assert_eq!(edited.changed.contains(&e), changed);
            }
            let differ = activities.iter().zip(&edited_rows).filter(|(a, b)| (a.0, a.1) != (b.0, b.1));
            prop_assert_eq!(edited.moved, differ.count());
            let (renumbered, ids) = edited.scene.renumbered();
            prop_assert_eq!(&renumbered.behaviours, &linked.behaviours);
            prop_assert_eq!(&renumbered.element_behaviour, &linked.element_behaviour);
            for e in (0..10).map(ElementId) {
                let old = edited.scene.element_behaviour[e.index()];
                prop_assert_eq!(ids.now(old), Some(linked.element_behaviour[e.index()]));
            }
            let old = scene.behaviours.len();
            prop_assert_eq!(&edited.scene.behaviours[..old], &scene.behaviours[..]);
            let distinct: std::collections::HashSet<_> = edited.scene.behaviours.iter().collect();
            prop_assert_eq!(distinct.len(), edited.scene.behaviours.len());

            let undone = edited.scene.with_schedule(schedule(&activities)).unwrap();
            prop_assert_eq!(&undone.scene.element_behaviour, &scene.element_behaviour);
            prop_assert_eq!(&undone.changed, &edited.changed);
        }
    }

    #[test]
    fn links_by_hand_are_an_edit() {
        let scene = link::link(model(), schedule(&[(10, 5, 0, vec![1]), (20, 5, 1, vec![2])]));
        let mut rules = link::Rules::clone(&scene.rules);
        rules.attach("a0", "e7");
        rules.detach("a1", "e2");
        let edited = scene.with_rules(rules.clone());
        assert_eq!(edited.changed, [ElementId(2), ElementId(7)]);
        assert_eq!(edited.scene.activities_of(ElementId(7)), [0]);
        assert!(edited.scene.activities_of(ElementId(2)).is_empty());
        let linked =
            link::link_by(rules, model(), schedule(&[(10, 5, 0, vec![1]), (20, 5, 1, vec![2])]));
        for e in (0..10).map(ElementId) {
            assert_eq!(edited.scene.behaviour(e), linked.behaviour(e));
        }
        let old = scene.behaviours.len();
        assert_eq!(edited.scene.behaviours[..old], scene.behaviours);
        let undone = edited.scene.with_rules(link::Rules::clone(&scene.rules));
        assert_eq!(undone.scene.element_behaviour, scene.element_behaviour);
        assert_eq!(undone.changed, edited.changed);
    }

    #[test]
    fn what_cannot_be_moved_is_named() {
        let scene = link::link(model(), schedule(&[(0, 5, 0, vec![1])]));
        let error = scene.with_activity_dates(&[(7, range(0, 1))]).unwrap_err();
        assert_eq!(error, EditError::NoActivity { index: 7, count: 1 });
        let error = scene.with_activity_dates(&[(0, range(9, 3))]).unwrap_err();
        assert!(error.to_string().contains("\"a0\""), "{error}");
    }

    #[test]
    fn another_kind_or_other_elements_have_to_be_linked() {
        let scene = link::link(model(), schedule(&[(0, 5, 0, vec![1])]));
        assert!(scene.with_schedule(schedule(&[(3, 9, 0, vec![1])])).is_some());
        for other in [(0, 5, 1, vec![1]), (0, 5, 0, vec![2]), (0, 5, 0, vec![])] {
            assert!(scene.with_schedule(schedule(&[other])).is_none());
        }
        assert!(scene.with_schedule(schedule(&[])).is_none());
    }
}
