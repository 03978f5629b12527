//! What became of links when model or schedule were read again.

use crate::{ElementId, Scene};
use std::collections::{HashMap, HashSet};
use std::fmt;
use std::sync::Arc;
use topout_schedule::{Activity, Schedule, Time};

/// How two linked scenes of one project differ: activities by their ids, elements by guid, else by
/// name.
#[derive(Clone, PartialEq, Eq, Debug, Default, serde::Serialize)]
pub struct Resync {
    /// Activities that only the later scene has.
    pub added: Vec<String>,
    /// Activities that only the earlier scene has.
    pub removed: Vec<String>,
    /// Activities with other dates.
    pub moved: Vec<Moved>,
    /// Activities of both scenes that only now touch elements.
    pub newly_linked_activities: Vec<String>,
    /// Activities of both scenes that touch no element any more.
    pub newly_loose_activities: Vec<String>,
    /// Elements that only the later model has.
    pub added_elements: Vec<String>,
    /// Elements that only the earlier model has.
    pub removed_elements: Vec<String>,
    /// Elements of both scenes that only now have activities.
    pub newly_linked_elements: Vec<String>,
    /// Elements of both scenes that have no activity any more.
    pub newly_loose_elements: Vec<String>,
}

/// An activity with other dates.
#[derive(Clone, PartialEq, Eq, Debug, serde::Serialize)]
pub struct Moved {
    /// Its id.
    pub id: String,
    /// Start and end before.
    #[serde(serialize_with = "as_texts")]
    pub before: [Option<Time>; 2],
    /// Start and end now.
    #[serde(serialize_with = "as_texts")]
    pub after: [Option<Time>; 2],
}

fn as_texts<S: serde::Serializer>(dates: &[Option<Time>; 2], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(dates.map(|d| d.map(|d| d.to_string())))
}

impl Resync {
    /// Compares; all lists are in the order of the scene that has the entry, the later one where both
    /// have it.
    pub fn between(before: &Scene, after: &Scene) -> Self {
        let mut found = Self::default();
        found.compare_activities(before, after);
        found.compare_elements(before, after);
        found
    }

    /// Whether nothing differs.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    fn compare_activities(&mut self, before: &Scene, after: &Scene) {
        let id = |a: &Activity| a.id.clone();
        let index = |schedule: &Schedule| -> HashMap<String, usize> {
            schedule.activities.iter().map(id).zip(0..).collect()
        };
        let (old, new) = (index(&before.schedule), index(&after.schedule));
        let removed = before.schedule.activities.iter().filter(|a| !new.contains_key(&a.id));
        self.removed = removed.map(id).collect();
        let (touched_before, touched_now) = (touched(before), touched(after));
        let dates = |a: &Activity| [a.start, a.end];
        for (n, now) in after.schedule.activities.iter().enumerate() {
            let Some(&o) = old.get(&now.id) else {
                self.added.push(now.id.clone());
                continue;
            };
            let was = &before.schedule.activities[o];
            if dates(was) != dates(now) {
                self.moved.push(Moved { id: id(now), before: dates(was), after: dates(now) });
            }
            match (touched_before[o], touched_now[n]) {
                (false, true) => self.newly_linked_activities.push(id(now)),
                (true, false) => self.newly_loose_activities.push(id(now)),
                _ => {}
            }
        }
    }

    fn compare_elements(&mut self, before: &Scene, after: &Scene) {
        let linked = |scene: &Scene, e: usize| !scene.activities_of(ElementId(e as u32)).is_empty();
        let mut compare = |o: usize, n: usize| match (linked(before, o), linked(after, n)) {
            (false, true) => self.newly_linked_elements.push(key(after, n).to_owned()),
            (true, false) => self.newly_loose_elements.push(key(after, n).to_owned()),
            _ => {}
        };
        if Arc::ptr_eq(&before.model, &after.model) {
            (0..after.model.elements.len()).for_each(|e| compare(e, e));
            return;
        }
        // Elements of one key meet in the models' order.
        let mut old: HashMap<(&str, u32), usize> = HashMap::new();
        let mut counts: HashMap<&str, u32> = HashMap::new();
        for o in 0..before.model.elements.len() {
            let count = counts.entry(key(before, o)).or_insert(0);
            *count += 1;
            old.insert((key(before, o), *count), o);
        }
        counts.clear();
        let mut seen = HashSet::new();
        for n in 0..after.model.elements.len() {
            let count = counts.entry(key(after, n)).or_insert(0);
            *count += 1;
            match old.get(&(key(after, n), *count)) {
                Some(&o) => {
                    seen.insert(o);
                    compare(o, n);
                }
                None => self.added_elements.push(key(after, n).to_owned()),
            }
        }
        let gone = (0..before.model.elements.len()).filter(|o| !seen.contains(o));
        self.removed_elements = gone.map(|o| key(before, o).to_owned()).collect();
    }
}

/// For each activity whether it touches an element.
fn touched(scene: &Scene) -> Vec<bool> {
    let mut touched = vec![false; scene.schedule.activities.len()];
    for &activity in &scene.activity_links {
        touched[activity as usize] = true;
    }
    touched
}

/// What an element is known by.
fn key(scene: &Scene, element: usize) -> &str {
    let element = &scene.model.elements[element];
    match &element.guid {
        Some(guid) if !guid.is_empty() => guid,
        _ if element.name.is_empty() => &element.label,
        _ => &element.name,
    }
}

impl fmt::Display for Resync {
    /// One line for each list that is not empty, with its first entries.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return writeln!(f, "nothing changed");
        }
        let moved: Vec<String> = self.moved.iter().map(|m| m.id.clone()).collect();
        for (what, list) in [
            ("activities added", &self.added),
            ("activities removed", &self.removed),
            ("activities moved", &moved),
            ("activities newly linked", &self.newly_linked_activities),
            ("activities newly loose", &self.newly_loose_activities),
            ("elements added", &self.added_elements),
            ("elements removed", &self.removed_elements),
            ("elements newly linked", &self.newly_linked_elements),
            ("elements newly loose", &self.newly_loose_elements),
        ] {
            if !list.is_empty() {
                let more = if list.len() > SHOWN { ", ..." } else { "" };
                let first = list[..list.len().min(SHOWN)].join(", ");
                writeln!(f, "{:>7} {what}: {first}{more}", list.len())?;
            }
        }
        Ok(())
    }
}

/// Entries of a list that are said.
const SHOWN: usize = 5;
