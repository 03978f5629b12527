//! What files say of single elements of an activity.

use crate::Activity;
use crate::sources::Place;
use std::collections::HashSet;
use std::sync::Arc;

/// What a file says of each element of one activity: a column of an event log, such as who worked
/// on it or whether it was on time.
///
/// Rule: in a [`crate::Schedule`], `values[i]` is said of `elements[i]` of the activity, and there
/// are as many values as elements. An empty value says nothing.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ElementField {
    /// What the file calls it. Activities of one file share the names.
    pub name: Arc<str>,
    /// One value an element. Equal values of one file share their text.
    pub values: Vec<Arc<str>>,
}

impl ElementField {
    /// Bytes of names and values, each text in memory once.
    pub(crate) fn bytes<'a>(all: impl Iterator<Item = &'a ElementField>) -> usize {
        let mut seen = HashSet::new();
        let mut text = |t: &Arc<str>| if seen.insert(t.as_ptr()) { t.len() } else { 0 };
        let one = |field: &ElementField| {
            let texts = text(&field.name) + field.values.iter().map(&mut text).sum::<usize>();
            size_of::<ElementField>() + size_of_val(&field.values[..]) + texts
        };
        all.map(one).sum()
    }
}

impl Activity {
    /// What is said of one of its elements under a name: of it alone, else of the whole activity.
    pub fn element_field(&self, name: &str, element: usize) -> Option<&str> {
        let own = self.element_fields.iter().find(|field| *field.name == *name);
        let value = match own {
            Some(field) => field.values.get(element).map(|value| &**value),
            None => self.fields.iter().find(|(n, _)| **n == *name).map(|(_, value)| &**value),
        };
        value.filter(|value| !value.is_empty())
    }

    /// Makes values as many as elements: empty ones are added for elements that other files gave.
    /// Returns the name of the first field that had more values than there are elements.
    pub(crate) fn fit_element_fields(&mut self) -> Option<Arc<str>> {
        let elements = self.elements.len();
        let mut longer = None;
        for field in &mut self.element_fields {
            if field.values.len() > elements && longer.is_none() {
                longer = Some(field.name.clone());
            }
            if field.values.len() != elements {
                field.values.resize(elements, Arc::from(""));
            }
        }
        longer
    }

    /// Removes empty names of elements and all but the first of equal ones; see
    /// [`Activity::keep_elements`].
    pub(crate) fn remove_repeats(&mut self, links: Option<&mut Vec<Place>>) {
        let mut seen = HashSet::with_capacity(self.elements.len());
        let keep: Vec<bool> = (self.elements.iter())
            .map(|name| !name.is_empty() && seen.insert(name.as_str()))
            .collect();
        self.keep_elements(&keep, links);
    }

    /// Keeps some names of elements, with what is said of them and with the places of those that links
    /// gave, which are the last.
    pub(crate) fn keep_elements(&mut self, keep: &[bool], links: Option<&mut Vec<Place>>) {
        if !keep.iter().all(|&k| k) {
            retain(&mut self.elements, keep);
            for field in &mut self.element_fields {
                retain(&mut field.values, keep);
            }
            if let Some(links) = links {
                let own = keep.len().saturating_sub(links.len());
                retain(links, &keep[own..]);
            }
        }
        if self.elements.is_empty() {
            self.element_fields.clear();
        }
    }
}

/// Keeps what `keep` says, which is as long or longer.
pub(crate) fn retain<T>(items: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    items.retain(|_| *keep.next().expect("one answer an item"));
}
