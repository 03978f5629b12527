//! Linking: which activities touch which elements, and when each element is there.

use crate::{BehaviourId, Element, ElementId, Group, GroupId, Model, Scene};
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;
use topout_schedule::{
    Activity, ActivityKind, Behaviour, Diagnostics, Schedule, Severity, presence,
};

/// Pairs of element and activity that are kept. A schedule that links the whole building to each
/// of thousands of activities would otherwise fill the memory.
const MOST_LINKS: usize = 1 << 27;

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
pub fn link(model: Model, schedule: Schedule) -> Scene {
    let mut diagnostics = Diagnostics::default();
    let mut pairs = pairs(&model, &schedule, &mut diagnostics);
    pairs.par_sort_unstable();
    pairs.dedup();
    let mut activity_starts = Vec::with_capacity(model.elements.len() + 1);
    let mut at = 0;
    for element in 0..model.elements.len() as u32 {
        activity_starts.push(at as u32);
        while pairs.get(at).is_some_and(|p| p.0 == element) {
            at += 1;
        }
    }
    activity_starts.push(at as u32);
    let activity_links: Vec<u32> = pairs.into_iter().map(|p| p.1).collect();
    let (behaviours, element_behaviour) =
        behaviours(&schedule.activities, &activity_starts, &activity_links);
    let mut scene = Scene {
        model: Arc::new(model),
        schedule,
        behaviours,
        element_behaviour,
        activity_starts,
        activity_links,
        link_diagnostics: diagnostics,
        diagnostics: Diagnostics::default(),
    };
    note_unlinked(&mut scene);
    scene.collect_diagnostics();
    scene
}

/// What a name stands for.
#[derive(Clone, Copy)]
enum Target {
    Element(u32),
    Group(GroupId),
}

/// All targets by name and guid; those of one name are chained.
struct Names<'a> {
    first: HashMap<&'a str, u32>,
    entries: Vec<(Target, Option<u32>)>,
}

impl<'a> Names<'a> {
    fn new(model: &'a Model) -> Self {
        let mut names = Self { first: HashMap::new(), entries: Vec::new() };
        names.first.reserve(model.elements.len());
        // Backwards, because a chain is read from its latest entry on.
        for (i, group) in model.groups.iter().enumerate().rev() {
            let Group { name, guid, .. } = group;
            names.insert(name, guid.as_deref(), Target::Group(GroupId(i as u32)));
        }
        for (i, element) in model.elements.iter().enumerate().rev() {
            let Element { name, guid, .. } = element;
            names.insert(name, guid.as_deref(), Target::Element(i as u32));
        }
        names
    }

    fn insert(&mut self, name: &'a str, guid: Option<&'a str>, target: Target) {
        let guid = guid.filter(|&g| g != name);
        for key in [Some(name), guid].into_iter().flatten().filter(|k| !k.is_empty()) {
            let next = self.first.insert(key, self.entries.len() as u32);
            self.entries.push((target, next));
        }
    }

    fn find(&self, key: &str) -> impl Iterator<Item = Target> + '_ {
        let mut next = self.first.get(key).copied();
        std::iter::from_fn(move || {
            let (target, after) = self.entries[next? as usize];
            next = after;
            Some(target)
        })
    }
}

/// Elements sorted by group, so that those below a group are a range.
struct Groups {
    elements: Vec<u32>,
    ranges: Vec<Range<usize>>,
}

impl Groups {
    fn new(model: &Model) -> Self {
        let count = model.groups.len();
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); count];
        let mut stack: Vec<(u32, bool)> = Vec::new();
        for (i, group) in model.groups.iter().enumerate() {
            match group.parent {
                Some(parent) => children[parent.index()].push(i as u32),
                None => stack.push((i as u32, false)),
            }
        }
        let mut own: Vec<Vec<u32>> = vec![Vec::new(); count];
        for (i, element) in model.elements.iter().enumerate() {
            if let Some(group) = element.group {
                own[group.index()].push(i as u32);
            }
        }
        let mut groups = Self { elements: Vec::new(), ranges: vec![0..0; count] };
        while let Some((group, done)) = stack.pop() {
            let g = group as usize;
            if done {
                groups.ranges[g].end = groups.elements.len();
                continue;
            }
            let start = groups.elements.len();
            groups.ranges[g] = start..start;
            groups.elements.append(&mut own[g]);
            stack.push((group, true));
            stack.extend(children[g].drain(..).map(|c| (c, false)));
        }
        groups
    }

    fn below(&self, group: GroupId) -> &[u32] {
        &self.elements[self.ranges[group.index()].clone()]
    }
}

/// Pairs of element and activity, in no order and with repetitions.
fn pairs(model: &Model, schedule: &Schedule, diagnostics: &mut Diagnostics) -> Vec<(u32, u32)> {
    let names = Names::new(model);
    let groups = Groups::new(model);
    let mut pairs: Vec<(u32, u32)> = Vec::new();
    for (a, activity) in schedule.activities.iter().enumerate() {
        for (n, entry) in activity.elements.iter().enumerate() {
            let mut found = 0usize;
            for target in names.find(entry) {
                found += 1;
                let elements = match &target {
                    Target::Element(e) => std::slice::from_ref(e),
                    Target::Group(g) => groups.below(*g),
                };
                if pairs.len() + elements.len() > MOST_LINKS {
                    diagnostics.add(Severity::Error, "too-many-links", entry.as_str(), || {
                        format!(
                            "{}: activity {:?}: more than {MOST_LINKS} links of elements; \
                             {entry:?} and what follows is left out",
                            schedule.element_place(a, n),
                            activity.id
                        )
                    });
                    return pairs;
                }
                pairs.extend(elements.iter().map(|&e| (e, a as u32)));
            }
            match found {
                0 => diagnostics.add(Severity::Warning, "unknown-element", entry.as_str(), || {
                    format!(
                        "{}: activity {:?} is linked to {entry:?}, which the model does not have",
                        schedule.element_place(a, n),
                        activity.id
                    )
                }),
                1 => {}
                many => diagnostics.add(Severity::Info, "ambiguous-element", entry.as_str(), || {
                    format!(
                        "{}: activity {:?} is linked to {entry:?}, which occurs {many} times; all \
                         are linked",
                        schedule.element_place(a, n),
                        activity.id
                    )
                }),
            }
        }
    }
    pairs
}

/// The behaviour of an element with these activities.
pub(crate) fn presence_by_activities(activities: &[Activity], list: &[u32]) -> Behaviour {
    presence(list.iter().map(|&a| &activities[a as usize]))
}

/// Distinct behaviours and that of each element. Elements with the same activities share theirs,
/// so presence is worked out once for each distinct list.
fn behaviours(
    activities: &[Activity],
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
    let worked_out: Vec<_> =
        distinct.par_iter().map(|list| presence_by_activities(activities, list)).collect();
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
fn note_unlinked(scene: &mut Scene) {
    if scene.schedule.activities.is_empty() {
        return;
    }
    let mut touched = vec![false; scene.schedule.activities.len()];
    for &activity in &scene.activity_links {
        touched[activity as usize] = true;
    }
    for (a, (activity, touched)) in scene.schedule.activities.iter().zip(touched).enumerate() {
        // What says nothing of presence needs no element.
        if !touched && activity.kind != ActivityKind::Neutral {
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use topout_schedule::Time;

    fn element(name: &str, guid: Option<&str>, group: Option<u32>) -> Element {
        Element {
            name: name.into(),
            guid: guid.map(Into::into),
            group: group.map(GroupId),
            ..Element::default()
        }
    }

    fn group(name: &str, guid: Option<&str>, parent: Option<u32>) -> Group {
        Group {
            name: name.into(),
            guid: guid.map(Into::into),
            parent: parent.map(GroupId),
            ..Group::default()
        }
    }

    fn activity(id: &str, start: i64, end: i64, elements: &[&str]) -> Activity {
        Activity {
            id: id.into(),
            start: Some(Time::from_seconds(start)),
            end: Some(Time::from_seconds(end)),
            elements: elements.iter().map(|&e| e.into()).collect(),
            ..Activity::default()
        }
    }

    fn scene(elements: Vec<Element>, groups: Vec<Group>, activities: Vec<Activity>) -> Scene {
        let model = Model { elements, groups, ..Model::default() };
        link(model, Schedule::new(String::new(), None, activities, Diagnostics::default()))
    }

    fn linked(scene: &Scene, element: u32) -> Vec<&str> {
        let ids = scene.activities_of(ElementId(element));
        ids.iter().map(|&a| scene.schedule.activities[a as usize].id.as_str()).collect()
    }

    #[test]
    fn names_and_guids_of_elements_link_exactly() {
        let scene = scene(
            vec![element("wall", Some("g1"), None), element("Wall", None, None)],
            vec![],
            vec![activity("A", 0, 1, &["wall"]), activity("B", 2, 3, &["g1", "wall", "g1"])],
        );
        assert_eq!(linked(&scene, 0), ["A", "B"]);
        assert!(linked(&scene, 1).is_empty());
        assert_eq!(scene.activity_links.len(), 2, "equal links collapse");
        assert!(scene.behaviour(ElementId(1)).at(Time::MIN), "unlinked elements are always there");
        assert_eq!(scene.behaviour(ElementId(0)).toggles(), [Time::from_seconds(0)]);
        assert_eq!(scene.diagnostics.get("unlinked-element").unwrap().examples, ["Wall"]);
    }

    #[test]
    fn a_group_links_everything_below_it_at_any_depth() {
        let groups = vec![
            group("site", None, None),
            group("storey", Some("sg"), Some(0)),
            group("room", None, Some(1)),
            group("other", None, Some(0)),
        ];
        let elements = vec![
            element("a", None, Some(1)),
            element("b", None, Some(2)),
            element("c", None, Some(3)),
            element("d", None, None),
            element("e", None, Some(0)),
        ];
        let scene = scene(
            elements,
            groups,
            vec![
                activity("S", 0, 1, &["site"]),
                activity("T", 0, 1, &["sg"]),
                activity("R", 0, 1, &["room", "d"]),
            ],
        );
        let all: Vec<_> = (0..5).map(|e| linked(&scene, e).join("")).collect();
        assert_eq!(all, ["ST", "STR", "S", "R", "S"]);
        assert!(scene.diagnostics.get("ambiguous-element").is_none());
    }

    #[test]
    fn names_that_occur_several_times_link_all_and_say_so() {
        let scene = scene(
            vec![element("x", None, None), element("x", None, None), element("y", Some("x"), None)],
            vec![],
            vec![activity("A", 0, 1, &["x"])],
        );
        assert_eq!(report(&scene).linked_elements, 3);
        let found = scene.diagnostics.get("ambiguous-element").unwrap();
        assert_eq!((found.severity, found.count), (Severity::Info, 1));
        assert!(found.message.contains("3 times"), "{}", found.message);
    }

    #[test]
    fn what_does_not_fit_is_counted_and_named() {
        let mut neutral = activity("N", 0, 1, &[]);
        neutral.kind = ActivityKind::Neutral;
        let scene = scene(
            vec![element("a", None, None), element("", None, None)],
            vec![group("empty", None, None)],
            vec![
                activity("A", 0, 1, &["a", "gone", "gone2"]),
                activity("B", 0, 1, &["gone"]),
                activity("E", 0, 1, &["empty"]),
                neutral,
            ],
        );
        let expected = LinkReport {
            elements: 2,
            linked_elements: 1,
            unlinked_elements: 1,
            activities: 4,
            linked_activities: 1,
            unlinked_activities: 3,
        };
        assert_eq!(report(&scene), expected);
        let unknown = scene.diagnostics.get("unknown-element").unwrap();
        assert_eq!((unknown.severity, unknown.count), (Severity::Warning, 3));
        assert_eq!(unknown.examples, ["gone", "gone2", "gone"]);
        assert!(unknown.message.contains("\"A\"") && unknown.message.contains("\"gone\""));
        assert_eq!(scene.diagnostics.get("unlinked-activity").unwrap().examples, ["B", "E"]);
    }

    #[test]
    fn equal_behaviours_are_stored_once() {
        let elements = (0..100).map(|i| element(&format!("e{i}"), None, None)).collect();
        let activities = (0..100i64)
            .map(|i| activity(&format!("a{i}"), i % 3, 10, &[&format!("e{i}")]))
            .collect();
        let scene = scene(elements, vec![], activities);
        assert_eq!(scene.behaviours.len(), 3);
        for i in 0..100u32 {
            let start = Time::from_seconds(i64::from(i) % 3);
            let expected = Behaviour::new(false, vec![start]).unwrap();
            assert_eq!(*scene.behaviour(ElementId(i)), expected);
        }
    }

    #[test]
    fn a_million_elements_and_links_are_linked_completely() {
        let count = 1_000_000;
        let elements = (0..count)
            .map(|i| element(&format!("e{i}"), Some(&format!("g{i}")), Some(i % 50)))
            .collect();
        let groups = (0..50).map(|i| group(&format!("storey{i}"), None, None)).collect();
        let activities = (0..1000)
            .map(|a| {
                let names: Vec<String> = (0..1000).map(|i| format!("g{}", a * 1000 + i)).collect();
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                activity(&format!("a{a}"), a, a + 1, &names)
            })
            .collect();
        let scene = scene(elements, groups, activities);
        assert_eq!(report(&scene).linked_elements, count as usize);
        assert_eq!(scene.activities_of(ElementId(777_777)), [777]);
        assert_eq!(scene.behaviours.len(), 1000);
    }

    #[test]
    fn a_model_without_a_schedule_stands_still() {
        let scene = scene(vec![element("a", None, None)], vec![], vec![]);
        assert!(scene.behaviour(ElementId(0)).at(Time::MIN));
        assert!(scene.diagnostics.get("unlinked-element").is_none());
        let empty = link(Model::default(), Schedule::default());
        assert_eq!(report(&empty), LinkReport::default());
    }

    #[test]
    fn findings_of_model_and_schedule_are_taken_over() {
        let mut model = Model::default();
        model.diagnostics.add(Severity::Info, "from-model", "m", || "m".into());
        let mut schedule = Schedule::default();
        schedule.diagnostics.add(Severity::Error, "from-schedule", "s", || "s".into());
        let scene = link(model, schedule);
        assert!(scene.diagnostics.get("from-model").is_some());
        assert!(scene.diagnostics.get("from-schedule").is_some());
        assert!(scene.diagnostics.has_errors());
    }
}
