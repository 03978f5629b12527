//! What a planner has to know of a model and its schedule: what is not linked, what is there twice, what
//! cannot be meant.

use crate::outliers::{Outlier, outliers};
use crate::{Element, ElementId, Scene};
use std::collections::{BTreeMap, HashMap};
use topout_schedule::{Activity, Preset, Severity, Time};

/// What a row is about.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Subject {
    /// An element of the model.
    Element(ElementId),
    /// An activity: a place in the schedule's list.
    Activity(u32),
}

/// One thing to look at.
#[derive(Clone, PartialEq, Debug)]
pub struct Row {
    /// What it is about; of several the first.
    pub subject: Subject,
    /// What is remarkable in words; may be empty.
    pub detail: String,
}

/// All things of one sort to look at.
#[derive(Clone, PartialEq, Debug)]
pub struct Section {
    /// Stable short name.
    pub code: &'static str,
    /// What it is, for people.
    pub title: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// In the order of model or schedule.
    pub rows: Vec<Row>,
}

impl Section {
    /// The codes of all sections, in the order of the report.
    pub const CODES: [&'static str; 11] = [
        "unlinked-activity",
        "unlinked-element",
        "no-dates",
        "outside-period",
        "overlapping-activities",
        "duplicate-guid",
        "duplicate-name",
        "never-appears",
        "before-start",
        "far-away",
        "swollen",
    ];
}

/// The sections that have rows.
pub fn check(scene: &Scene) -> Vec<Section> {
    let section = |code, title, severity, rows| Section { code, title, severity, rows };
    let (info, warning) = (Severity::Info, Severity::Warning);
    let mut sections = Vec::new();
    if !scene.schedule.activities.is_empty() {
        sections.extend([
            section("unlinked-activity", "activities without elements", warning, loose(scene)),
            section("unlinked-element", "elements without activities", info, taskless(scene)),
            section("no-dates", "activities without usable dates", warning, undated(scene)),
            section("outside-period", "activities outside of the period", warning, outside(scene)),
            section(
                "overlapping-activities",
                "activities that work on the same elements at the same time",
                info,
                overlapping(scene),
            ),
        ]);
    }
    let (guids, names) = duplicates(&scene.model.elements);
    sections.push(section("duplicate-guid", "guids of several elements", warning, guids));
    sections.push(section("duplicate-name", "names of several elements", info, names));
    if !scene.schedule.activities.is_empty() {
        let (never, before) = presence(scene);
        sections.push(section("never-appears", "elements that never appear", warning, never));
        sections.push(section(
            "before-start",
            "elements that are there before their first activity",
            info,
            before,
        ));
    }
    let (far, swollen) = displaced(scene);
    sections.push(section("far-away", "elements far from the rest", warning, far));
    sections.push(section(
        "swollen",
        "elements much larger than their kind, out of the rest",
        warning,
        swollen,
    ));
    sections.retain(|s| !s.rows.is_empty());
    debug_assert!(sections.iter().all(|s| Section::CODES.contains(&s.code)));
    sections
}

fn elements(scene: &Scene) -> impl Iterator<Item = (ElementId, &Element)> {
    (0u32..).map(ElementId).zip(&scene.model.elements)
}

fn activities(scene: &Scene) -> impl Iterator<Item = (u32, &Activity)> {
    (0u32..).zip(&scene.schedule.activities)
}

fn row(subject: Subject, detail: String) -> Row {
    Row { subject, detail }
}

/// Activities that should have elements and have none.
fn loose(scene: &Scene) -> Vec<Row> {
    let mut touched = vec![false; scene.schedule.activities.len()];
    scene.activity_links.iter().for_each(|&a| touched[a as usize] = true);
    let kinds = &scene.schedule.kinds;
    activities(scene)
        .filter(|(i, a)| !touched[*i as usize] && !a.milestone && !kinds.of(a.kind).is_neutral())
        .map(|(i, a)| {
            let detail = match a.elements.len() {
                0 => "names no element".to_owned(),
                n => format!("none of its {n} keys is in the model, such as {:?}", a.elements[0]),
            };
            row(Subject::Activity(i), detail)
        })
        .collect()
}

fn taskless(scene: &Scene) -> Vec<Row> {
    elements(scene)
        .filter(|(id, _)| scene.activities_of(*id).is_empty())
        .map(|(id, e)| {
            row(Subject::Element(id), [&*e.kind, &*e.storey].join(" ").trim().to_owned())
        })
        .collect()
}

fn undated(scene: &Scene) -> Vec<Row> {
    activities(scene)
        .filter(|(_, a)| a.dates().is_none())
        .map(|(i, a)| {
            let detail = match (a.start, a.end) {
                (Some(start), Some(end)) => format!("ends {end} before its start {start}"),
                (Some(_), None) => "no end".to_owned(),
                (None, Some(_)) => "no start".to_owned(),
                (None, None) => "neither start nor end".to_owned(),
            };
            row(Subject::Activity(i), detail)
        })
        .collect()
}

fn outside(scene: &Scene) -> Vec<Row> {
    let period = scene.schedule.period;
    activities(scene)
        .filter_map(|(i, a)| {
            let dates = a.dates()?;
            let detail = match () {
                () if dates.start < period.start => format!("starts {}", dates.start),
                () if dates.end > period.end => format!("ends {}", dates.end),
                () => return None,
            };
            Some(row(Subject::Activity(i), detail))
        })
        .collect()
}

/// Pairs of activities with a say in presence that last at the same time and have elements in common.
/// Of several that overlap one, the one that lasts longest stands for all.
fn overlapping(scene: &Scene) -> Vec<Row> {
    let all = &scene.schedule.activities;
    let acts = |a: u32| {
        let activity = &all[a as usize];
        let neutral = scene.schedule.kinds.of(activity.kind).is_neutral();
        activity.dates().filter(|d| activity.active && !neutral && d.start < d.end)
    };
    let mut lists: HashMap<&[u32], (usize, ElementId)> = HashMap::new();
    for (id, _) in elements(scene) {
        let list = scene.activities_of(id);
        if list.len() > 1 {
            lists.entry(list).or_insert((0, id)).0 += 1;
        }
    }
    let mut pairs: BTreeMap<(u32, u32), (usize, ElementId)> = BTreeMap::new();
    for (list, (count, example)) in lists {
        let mut acting: Vec<(Time, Time, u32)> =
            list.iter().filter_map(|&a| acts(a).map(|d| (d.start, d.end, a))).collect();
        acting.sort_unstable();
        let mut longest: Option<(Time, u32)> = None;
        for (start, end, activity) in acting {
            if let Some((until, other)) = longest
                && start < until
            {
                let pair = pairs.entry((other, activity)).or_insert((0, example));
                *pair = (pair.0 + count, pair.1.min(example));
            }
            if longest.is_none_or(|(until, _)| until < end) {
                longest = Some((end, activity));
            }
        }
    }
    let text = |((one, other), (count, example)): ((u32, u32), (usize, ElementId))| {
        let other = &all[other as usize];
        let element = name_of(&scene.model.elements[example.index()]);
        let many = if count == 1 { "" } else { ", ..." };
        let detail = format!("{} {:?} as well, on {count}: {element}{many}", other.id, other.name);
        row(Subject::Activity(one), detail)
    };
    pairs.into_iter().map(text).collect()
}

/// Keys by which several elements are found: guids, and names.
fn duplicates(elements: &[Element]) -> (Vec<Row>, Vec<Row>) {
    let rows = |key: &dyn Fn(&Element) -> Option<&str>, what: &str| {
        let mut count: HashMap<&str, (usize, u32)> = HashMap::with_capacity(elements.len());
        for (i, element) in (0u32..).zip(elements) {
            if let Some(key) = key(element).filter(|k| !k.is_empty()) {
                count.entry(key).or_insert((0, i)).0 += 1;
            }
        }
        let mut found: Vec<_> = count.into_iter().filter(|(_, (n, _))| *n > 1).collect();
        found.sort_unstable_by_key(|(_, (_, first))| *first);
        let text = |(key, (n, first)): (&str, (usize, u32))| {
            row(Subject::Element(ElementId(first)), format!("{n} elements have the {what} {key:?}"))
        };
        found.into_iter().map(text).collect()
    };
    (rows(&|e| e.guid.as_deref(), "guid"), rows(&|e| Some(&e.name), "name"))
}

/// Elements that never appear, and those with activities that are there before.
fn presence(scene: &Scene) -> (Vec<Row>, Vec<Row>) {
    let (mut never, mut before) = (Vec::new(), Vec::new());
    let period = scene.schedule.period;
    for (id, _) in elements(scene) {
        let behaviour = scene.behaviour(id);
        let list = scene.activities_of(id);
        let example = || {
            let first = list.first().map(|&a| &scene.schedule.activities[a as usize]);
            first.map_or_else(String::new, |a| format!("{} {:?}", a.id, a.name))
        };
        if behaviour.preset(period) == Preset::Absent {
            never.push(row(Subject::Element(id), example()));
        } else if behaviour.initial() && !behaviour.toggles().is_empty() {
            before.push(row(Subject::Element(id), example()));
        }
    }
    (never, before)
}

fn displaced(scene: &Scene) -> (Vec<Row>, Vec<Row>) {
    let (mut far, mut swollen) = (Vec::new(), Vec::new());
    let all: Vec<ElementId> = elements(scene).map(|(id, _)| id).collect();
    for (id, why) in outliers(&scene.model.elements, &all) {
        let bounds = scene.model.elements[id.index()].bounds;
        let (size, center) = (bounds.size(), bounds.center().as_dvec3() + scene.model.origin);
        let detail = format!(
            "{:.1} x {:.1} x {:.1} m at ({:.1}, {:.1}, {:.1})",
            size.x, size.y, size.z, center.x, center.y, center.z
        );
        let rows = match why {
            Outlier::Far => &mut far,
            Outlier::Swollen => &mut swollen,
        };
        rows.push(row(Subject::Element(id), detail));
    }
    (far, swollen)
}

/// What people call an element: its label, else its name, else its guid.
pub fn name_of(element: &Element) -> &str {
    let guid = element.guid.as_deref().unwrap_or_default();
    [element.label.as_str(), &element.name, guid].into_iter().find(|n| !n.is_empty()).unwrap_or("")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Aabb, Model, link};
    use glam::Vec3;
    use topout_schedule::{ActivityKind, Schedule, TimeRange};

    fn element(name: &str, guid: &str, x: f32) -> Element {
        let bounds = Aabb { min: Vec3::new(x, 0.0, 0.0), max: Vec3::new(x + 1.0, 1.0, 1.0) };
        Element { name: name.into(), guid: Some(guid.into()), bounds, ..Element::default() }
    }

    fn activity(id: &str, days: (i64, i64), elements: &[&str]) -> Activity {
        let day = |n: i64| Some(Time::from_seconds(n * 86_400));
        Activity {
            id: id.into(),
            name: id.to_lowercase(),
            start: day(days.0),
            end: day(days.1),
            elements: elements.iter().map(|&e| e.into()).collect(),
            ..Activity::default()
        }
    }

    #[test]
    fn every_section_says_what_is_wrong() {
        let mut elements: Vec<Element> =
            (0..6).map(|i| element(&format!("e{i}"), &format!("g{i}"), i as f32 * 2.0)).collect();
        elements[1].name = "e0".into();
        elements[3].guid = Some("g2".into());
        elements[5] = element("lost", "g5", 1e6);
        let activities = vec![
            activity("A", (0, 10), &["e0", "e4"]),
            activity("B", (5, 8), &["e4"]),
            activity("C", (9, 12), &["e4"]),
            activity("D", (3, 4), &["nowhere"]),
            activity("E", (3, 4), &[]),
            Activity { kind: ActivityKind::Neutral, ..activity("F", (3, 4), &[]) },
            Activity { end: None, ..activity("G", (3, 4), &["e2"]) },
            Activity { active: false, ..activity("H", (3, 4), &["e3"]) },
            Activity { kind: ActivityKind::Demolish, ..activity("I", (3, 4), &["lost"]) },
            activity("J", (30, 40), &["e0"]),
        ];
        let day = |n: i64| Time::from_seconds(n * 86_400);
        let period = TimeRange { start: day(0), end: day(20) };
        let schedule = Schedule::new(String::new(), Some(period), activities, Default::default());
        let scene = link::link(Model { elements, ..Model::default() }, schedule);
        let found: Vec<(&str, Vec<(String, String)>)> = check(&scene)
            .into_iter()
            .map(|s| {
                let name = |r: &Row| match r.subject {
                    Subject::Element(id) => scene.model.elements[id.index()].name.clone(),
                    Subject::Activity(i) => scene.schedule.activities[i as usize].id.clone(),
                };
                (s.code, s.rows.iter().map(|r| (name(r), r.detail.clone())).collect())
            })
            .collect();
        let is = |code, rows: &[(&str, &str)]| {
            let rows = rows.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
            (code, rows)
        };
        assert_eq!(
            found,
            [
                is(
                    "unlinked-activity",
                    &[
                        ("D", "none of its 1 keys is in the model, such as \"nowhere\""),
                        ("E", "names no element"),
                    ]
                ),
                is("no-dates", &[("G", "no end")]),
                is("outside-period", &[("J", "ends 1970-02-10T00:00:00")]),
                is(
                    "overlapping-activities",
                    &[("A", "B \"b\" as well, on 1: e4"), ("A", "C \"c\" as well, on 1: e4")]
                ),
                is("duplicate-guid", &[("e2", "2 elements have the guid \"g2\"")]),
                is("duplicate-name", &[("e0", "2 elements have the name \"e0\"")]),
                is("never-appears", &[("e3", "H \"h\"")]),
                is("before-start", &[("lost", "I \"i\"")]),
                is("far-away", &[("lost", "1.0 x 1.0 x 1.0 m at (1000000.5, 0.5, 0.5)")]),
            ]
        );
        assert_eq!(scene.focus_bounds().max.x, 9.0, "what is lost does not decide what is shown");
    }
}
