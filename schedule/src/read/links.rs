//! Links files: which element belongs to which activity.

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
        all.links.links.push(Link { element: element.to_owned(), activity, place });
    }
    Ok(())
}

/// Gives every link's element to the first activity with its id; unknown ids are reported.
pub(super) fn attach(all: &mut Collected) {
    let Links { activities: mut ids, links } = std::mem::take(&mut all.links);
    if links.is_empty() {
        return;
    }
    let mut target: HashMap<u32, usize> = HashMap::new();
    for (i, activity) in all.activities.iter().enumerate().rev() {
        target.insert(ids.of(&activity.id), i);
    }
    let names = ids.texts();
    for Link { element, activity, place } in links {
        if let Some(&target) = target.get(&activity) {
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
