//! What links and what is said of it.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::{Element, Group, GroupId};
use topout_schedule::{ActivityKind, Time};

mod by_rules;
mod real;

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
    let activities =
        (0..100i64).map(|i| activity(&format!("a{i}"), i % 3, 10, &[&format!("e{i}")])).collect();
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
