//! Linking: which activities touch which elements, and when each element is there.

mod apply;
mod keys;
mod matching;
mod resync;
pub mod rules;
mod rules_read;
pub mod suggest;
#[cfg(test)]
mod tests;

pub(crate) use apply::Linked;
pub(crate) use keys::names_a_layer;
pub use resync::{Moved, Resync};
pub use rules::Rules;
pub use rules_read::RulesError;
pub use suggest::{Suggestion, Suggestions};

use crate::{BehaviourId, ElementId, Model, Scene};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;
use topout_schedule::{Activity, Behaviour, Diagnostics, Kinds, Schedule, Severity, presence};

/// How well model and schedule fit.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Serialize)]
pub struct LinkReport {
    /// Elements of the model.
    pub elements: usize,
    /// Elements that some activity is linked to.
    pub linked_elements: usize,
    /// Elements without any activity; they are always there.
    pub unlinked_elements: usize,
    /// Activities of the schedule.
    pub activities: usize,
    /// Activities linked to some element.
    pub linked_activities: usize,
    /// Activities without any element.
    pub unlinked_activities: usize,
}

/// Counts what is linked and what is not.
pub fn report(scene: &Scene) -> LinkReport {
    let elements = scene.model.elements.len();
    let linked_elements = scene.activity_starts.windows(2).filter(|w| w[0] < w[1]).count();
    let mut touched = vec![false; scene.schedule.activities.len()];
    for &activity in &scene.activity_links {
        touched[activity as usize] = true;
    }
    let linked_activities = touched.iter().filter(|&&t| t).count();
    LinkReport {
        elements,
        linked_elements,
        unlinked_elements: elements - linked_elements,
        activities: touched.len(),
        linked_activities,
        unlinked_activities: touched.len() - linked_activities,
    }
}

/// Links a schedule to a model. An activity's entry means every element or group of exactly that
/// name or guid; a group means all elements below it.
pub fn link(model: impl Into<Arc<Model>>, schedule: Schedule) -> Scene {
    link_by(Rules::default(), model, schedule)
}

/// Links a schedule to a model by rules; what each rule did is in [`Scene::rule_reports`].
///
/// Rules that do nothing, keys that match nothing and hand links that name what does not exist are
/// found in [`Scene::link_diagnostics`].
pub fn link_by(
    rules: impl Into<Arc<Rules>>,
    model: impl Into<Arc<Model>>,
    schedule: Schedule,
) -> Scene {
    let (rules, model) = (rules.into(), model.into());
    let Linked { activity_starts, activity_links, reports, diagnostics } =
        apply::links(&rules, &model, &schedule);
    let (behaviours, element_behaviour) = behaviours(&schedule, &activity_starts, &activity_links);
    let mut scene = Scene {
        model,
        schedule,
        behaviours,
        element_behaviour,
        activity_starts,
        activity_links,
        rules,
        rule_reports: reports,
        link_diagnostics: diagnostics,
        diagnostics: Diagnostics::default(),
    };
    note_unlinked(&mut scene);
    scene.collect_diagnostics();
    scene
}

/// The links that a scene's rules give it with another schedule.
pub(crate) fn links_again(scene: &Scene, schedule: &Schedule) -> Linked {
    apply::links(&scene.rules, &scene.model, schedule)
}

/// What one rule did.
#[derive(Clone, PartialEq, Eq, Debug, Default, serde::Serialize)]
pub struct RuleReport {
    /// The rule's name; `attached` or `detached` for links made by hand.
    pub name: String,
    /// Elements that it linked.
    pub elements: usize,
    /// Activities that it linked.
    pub activities: usize,
    /// Pairs of element and activity, also those that another rule gives too; those taken away for
    /// `detached`.
    pub links: usize,
    /// Elements that match, but were left to earlier rules.
    pub left_to_earlier: usize,
    /// Distinct keys of the schedule.
    pub keys: usize,
    /// Distinct keys of the schedule that match nothing in the model.
    pub keys_left: usize,
    /// The first keys that match nothing.
    pub examples_left: Vec<String>,
    /// The first links: name of the element and id of the activity.
    pub examples: Vec<(String, String)>,
}

impl RuleReport {
    /// Examples kept of each kind.
    pub const EXAMPLES: usize = 5;
}

/// The behaviour of an element with these activities.
pub(crate) fn presence_by_activities(
    kinds: &Kinds,
    activities: &[Activity],
    list: &[u32],
) -> Behaviour {
    presence(kinds, list.iter().map(|&a| &activities[a as usize]))
}

/// Distinct behaviours and that of each element. Elements with the same activities share theirs,
/// so presence is worked out once for each distinct list.
fn behaviours(
    schedule: &Schedule,
    starts: &[u32],
    links: &[u32],
) -> (Vec<Behaviour>, Vec<BehaviourId>) {
    let list = |e: usize| &links[starts[e] as usize..starts[e + 1] as usize];
    let mut lists: HashMap<&[u32], u32> = HashMap::new();
    let mut distinct: Vec<&[u32]> = Vec::new();
    let list_of_element: Vec<u32> = (0..starts.len() - 1)
        .map(|e| {
            *lists.entry(list(e)).or_insert_with(|| {
                distinct.push(list(e));
                distinct.len() as u32 - 1
            })
        })
        .collect();
    let worked_out: Vec<_> = distinct
        .par_iter()
        .map(|list| presence_by_activities(&schedule.kinds, &schedule.activities, list))
        .collect();
    let mut known: HashMap<Behaviour, BehaviourId> = HashMap::new();
    let mut behaviours = Vec::new();
    let ids: Vec<BehaviourId> = worked_out
        .into_iter()
        .map(|behaviour| {
            *known.entry(behaviour).or_insert_with_key(|behaviour| {
                behaviours.push(behaviour.clone());
                BehaviourId(behaviours.len() as u32 - 1)
            })
        })
        .collect();
    (behaviours, list_of_element.into_iter().map(|l| ids[l as usize]).collect())
}

/// Reports elements without activities and activities without elements.
pub(crate) fn note_unlinked(scene: &mut Scene) {
    if scene.schedule.activities.is_empty() {
        return;
    }
    let mut touched = vec![false; scene.schedule.activities.len()];
    for &activity in &scene.activity_links {
        touched[activity as usize] = true;
    }
    for (a, (activity, touched)) in scene.schedule.activities.iter().zip(touched).enumerate() {
        // What says nothing of presence needs no element.
        if !touched && !scene.schedule.kinds.of(activity.kind).is_neutral() {
            let Activity { id, name, .. } = activity;
            scene.link_diagnostics.add(Severity::Warning, "unlinked-activity", id.as_str(), || {
                let place = scene.schedule.place(a);
                format!("{place}: activity {id:?} ({name}) is linked to no element")
            });
        }
    }
    for (i, element) in scene.model.elements.iter().enumerate() {
        let id = ElementId(i as u32);
        if scene.activity_starts[id.index()] == scene.activity_starts[id.index() + 1] {
            let name = if element.name.is_empty() { &element.label } else { &element.name };
            scene.link_diagnostics.add(Severity::Info, "unlinked-element", name.as_str(), || {
                format!("element {name:?} has no activity and is always there")
            });
        }
    }
}
