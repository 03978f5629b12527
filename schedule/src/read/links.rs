//! Links files: which element belongs to which activity.

use super::csv::{Header, Table};
use super::{Collected, Place};
use crate::Severity;
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
    file: u32,
    line: u32,
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
    let file = all.current_file();
    while let Some(line) = table.next(all) {
        let guid = table.cell(columns.guid);
        let element = if guid.is_empty() { table.cell(columns.element) } else { guid };
        let activity = table.cell(Some(columns.activity));
        if element.is_empty() || activity.is_empty() {
            let place = all.describe(Place { file, line, number: None });
            let missing = if element.is_empty() { "element" } else { "activity" };
            all.diagnostics.add(Severity::Warning, "incomplete-link", place.clone(), || {
                format!("{place}: a link without {missing} (from {element:?} to {activity:?})")
            });
            continue;
        }
        let links = &mut all.links;
        let next = links.activities.len() as u32;
        let activity = match links.activities.get(activity) {
            Some(&known) => known,
            None => *links.activities.entry(activity.to_owned()).or_insert(next),
        };
        let (file, line) = (file as u32, u32::try_from(line).unwrap_or(u32::MAX));
        links.links.push(Link { element: element.to_owned(), activity, file, line });
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
    for Link { element, activity, file, line } in links {
        if let Some(target) = target[activity as usize] {
            all.activities[target].elements.push(element);
            continue;
        }
        let place = Place { file: file as usize, line: line as usize, number: None };
        let (id, files) = (names[activity as usize], &all.files);
        all.diagnostics.add(Severity::Warning, "unknown-activity", id, || {
            let place = super::describe(files, place);
            format!(
                "{place}: no activity has the id {id:?}, to which element {element:?} is linked"
            )
        });
    }
}
