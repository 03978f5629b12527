//! Links files: which element belongs to which activity.

use super::Collected;
use super::csv::{Header, Table};
use crate::Severity;
use crate::sources::Place;
use std::collections::HashMap;

/// Links that wait for their activities.
#[derive(Default)]
pub(super) struct Links {
    /// Each activity id once; links refer to it by index, for there are far more links.
    activities: HashMap<String, u32>,
    links: Vec<Link>,
}

struct Link {
    element: String,
    activity: u32,
    place: Place,
}

/// Where a links file's columns stand.
pub(super) struct Columns {
    guid: Option<usize>,
    element: Option<usize>,
    activity: usize,
}

impl Columns {
    /// `None` where the table is not a links file.
    pub(super) fn find(header: &Header) -> Option<Self> {
        let [guid, element] = ["guid", "element"].map(|name| header.position(&[name]));
        if header.position(&["start"]).is_some() {
            return None;
        }
        guid.or(element)?;
        Some(Self { guid, element, activity: header.position(&["activity_id"])? })
    }
}

/// Reads one links file into `all`.
pub(super) fn read(table: &mut Table, columns: Columns, all: &mut Collected) {
    while let Some(line) = table.next(all) {
        let guid = table.cell(columns.guid);
        let element = if guid.is_empty() { table.cell(columns.element) } else { guid };
        let activity = table.cell(Some(columns.activity));
        if element.is_empty() || activity.is_empty() {
            let place = all.sources.describe(all.line(line));
            let missing = if element.is_empty() { "element" } else { "activity" };
            all.diagnostics.add(Severity::Warning, "incomplete-link", place.clone(), || {
                format!("{place}: a link without {missing} (from {element:?} to {activity:?})")
            });
            continue;
        }
        let place = all.line(line);
        let links = &mut all.links;
        let next = links.activities.len() as u32;
        let activity = match links.activities.get(activity) {
            Some(&known) => known,
            None => *links.activities.entry(activity.to_owned()).or_insert(next),
        };
        links.links.push(Link { element: element.to_owned(), activity, place });
    }
}

/// Gives every link's element to the first activity with its id; unknown ids are reported.
pub(super) fn attach(all: &mut Collected) {
    let Links { activities: ids, links } = std::mem::take(&mut all.links);
    let mut target: Vec<Option<usize>> = vec![None; ids.len()];
    for (i, activity) in all.activities.iter().enumerate().rev() {
        if let Some(&id) = ids.get(&activity.id) {
            target[id as usize] = Some(i);
        }
    }
    let mut names: Vec<&str> = vec![""; ids.len()];
    for (name, &id) in &ids {
        names[id as usize] = name;
    }
    for Link { element, activity, place } in links {
        if let Some(target) = target[activity as usize] {
            all.activities[target].elements.push(element);
            all.sources.activities[target].links.push(place);
            continue;
        }
        let (id, sources) = (names[activity as usize], &all.sources);
        all.diagnostics.add(Severity::Warning, "unknown-activity", id, || {
            let place = sources.describe(place);
            format!(
                "{place}: no activity has the id {id:?}, to which element {element:?} is linked"
            )
        });
    }
}
