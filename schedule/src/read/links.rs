//! Links files: which element belongs to which activity.
//!
//! The elements of an event log may have other names than those of the model. A links file with a
//! column `log_guid` or `log_element` says which is which: the link then takes the place of that
//! element, and what the log says of it stays.

use super::collected::Collected;
use super::error::ReadError;
use super::table::{Header, Table};
use super::tasklinks::Keys;
use crate::Severity;
use crate::sources::Place;
use std::collections::HashMap;

/// Links that wait for their activities.
#[derive(Default)]
pub(super) struct Links {
    /// Each activity id once; links refer to it by number, for there are far more links.
    activities: Keys,
    /// Names of elements in an event log, each once.
    in_log: Keys,
    links: Vec<Link>,
}

struct Link {
    element: String,
    activity: u32,
    /// What an event log calls the element.
    in_log: Option<u32>,
    place: Place,
}

/// Where a links file's columns stand.
pub(super) struct Columns {
    guid: Option<usize>,
    element: Option<usize>,
    activity: usize,
    in_log: Option<usize>,
}

impl Columns {
    /// `None` where the table is not a links file.
    pub(super) fn find(header: &Header) -> Option<Self> {
        let [guid, element] = ["guid", "element"].map(|name| header.position(&[name]));
        if header.position(&["start"]).is_some() {
            return None;
        }
        guid.or(element)?;
        let in_log = header.position(&["log_guid", "log_element"]);
        Some(Self { guid, element, activity: header.position(&["activity_id"])?, in_log })
    }
}

/// Reads one links file into `all`.
pub(super) fn read(
    table: &mut Table,
    columns: Columns,
    all: &mut Collected,
) -> Result<(), ReadError> {
    while let Some(line) = table.next(all)? {
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
        let activity = all.links.activities.of(activity);
        let in_log = Some(table.cell(columns.in_log)).filter(|name| !name.is_empty());
        let in_log = in_log.map(|name| all.links.in_log.of(name));
        all.links.links.push(Link { element: element.to_owned(), activity, in_log, place });
    }
    Ok(())
}

/// Gives every link's element to the first activity with its id; unknown ids are reported.
pub(super) fn attach(all: &mut Collected) {
    let Links { activities: mut ids, in_log: log_names, links } = std::mem::take(&mut all.links);
    if links.is_empty() {
        return;
    }
    let mut target: HashMap<u32, usize> = HashMap::new();
    for (i, activity) in all.activities.iter().enumerate().rev() {
        target.insert(ids.of(&activity.id), i);
    }
    let names = ids.texts();
    let mut logged: HashMap<(usize, u32), usize> = HashMap::new();
    for (i, activity) in all.activities.iter().enumerate() {
        for (at, element) in activity.elements.iter().enumerate().rev() {
            logged.extend(log_names.known(element).map(|name| ((i, name), at)));
        }
    }
    for Link { element, activity, in_log, place } in links {
        if let Some(&target) = target.get(&activity) {
            if let Some(at) = in_log.and_then(|name| logged.remove(&(target, name))) {
                let elements = &mut all.activities[target].elements;
                let places = &mut all.sources.activities[target].links;
                let own = elements.len().saturating_sub(places.len());
                elements[at] = element;
                if let Some(known) = at.checked_sub(own).and_then(|at| places.get_mut(at)) {
                    *known = place;
                }
                continue;
            }
            all.activities[target].elements.push(element);
            all.sources.activities[target].links.push(place);
            continue;
        }
        let id = names[activity as usize];
        all.report(Severity::Warning, "unknown-activity", id, place, || {
            format!("no activity has the id {id:?}, to which element {element:?} is linked")
        });
    }
}
