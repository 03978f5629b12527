//! What the model's files say of elements and groups beyond what topout knows: glTF extras as one
//! compact table.

use crate::{Element, ElementId, GroupId, Model};
use serde_json::Value;
use std::collections::HashMap;
use topout_schedule::{Diagnostics, Severity};

/// Depth to which objects inside extras are followed; what lies deeper is left out.
pub const MOST_DEPTH: usize = 8;
/// Bytes of a key; longer ones are left out.
pub const LONGEST_KEY: usize = 1024;
/// Distinct keys of one table. Exporters write some hundreds; files that use ids as keys write one
/// a node.
pub const MOST_KEYS: usize = 1 << 16;
/// Entries of one table, 8 bytes each.
pub const MOST_ENTRIES: usize = 1 << 26;
/// Bytes that the distinct values of one table take.
pub const MOST_TEXT: usize = 1 << 28;

/// Properties of elements and groups: keys and values are stored once each, whatever their number
/// of users; an element or a group has a range of entries.
///
/// Rule: `ends[i]` of a list is where the entries of its i-th owner end; they begin where those of
/// the owner before end. Owners beyond the list have none.
#[derive(Clone, Debug, Default)]
pub struct Properties {
    keys: Vec<Box<str>>,
    text: String,
    /// Where in `text` each distinct value ends.
    value_ends: Vec<u32>,
    /// Key and value.
    entries: Vec<(u32, u32)>,
    /// Of elements, then of groups.
    ends: [Vec<u32>; 2],
    /// Where in `entries` the groups' begin.
    first_of_groups: u32,
}

/// Something was left out because a table would have become too large.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Full;

impl Properties {
    /// The distinct keys, in the order of their first use.
    pub fn keys(&self) -> impl ExactSizeIterator<Item = &str> {
        self.keys.iter().map(|k| &**k)
    }

    /// The id of a key: exactly this one, else the first that differs in case alone.
    pub fn key_id(&self, key: &str) -> Option<u32> {
        let exact = self.keys.iter().position(|k| **k == *key);
        let place = exact.or_else(|| self.keys.iter().position(|k| k.eq_ignore_ascii_case(key)));
        place.map(|p| p as u32)
    }

    /// Number of distinct values.
    pub fn value_count(&self) -> usize {
        self.value_ends.len()
    }

    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Entries (ids of key and value) of an element.
    pub fn entries_of_element(&self, element: ElementId) -> &[(u32, u32)] {
        self.slice(0, 0, element.index())
    }

    /// Entries (ids of key and value) of a group.
    pub fn entries_of_group(&self, group: GroupId) -> &[(u32, u32)] {
        self.slice(1, self.first_of_groups, group.index())
    }

    /// The value with an id out of an entry; empty for any other.
    pub fn value(&self, id: u32) -> &str {
        let Some(&end) = self.value_ends.get(id as usize) else { return "" };
        let start = id.checked_sub(1).map_or(0, |before| self.value_ends[before as usize]);
        &self.text[start as usize..end as usize]
    }

    /// Leaves the elements out that are not to be kept; the others move up.
    pub(crate) fn retain_elements(&mut self, keep: &[bool]) {
        if keep.iter().all(|&k| k) {
            return;
        }
        let (mut entries, mut ends) = (Vec::new(), Vec::new());
        for element in (0..self.ends[0].len()).filter(|&e| keep.get(e).is_none_or(|&k| k)) {
            entries.extend_from_slice(self.slice(0, 0, element));
            ends.push(entries.len() as u32);
        }
        let moved = self.first_of_groups - entries.len() as u32;
        entries.extend_from_slice(&self.entries[self.first_of_groups as usize..]);
        self.first_of_groups -= moved;
        self.ends[1].iter_mut().for_each(|end| *end -= moved);
        (self.entries, self.ends[0]) = (entries, ends);
    }

    /// Bytes that the table takes, without what an allocator adds.
    pub fn bytes(&self) -> usize {
        let keys: usize = self.keys.iter().map(|k| k.len() + size_of::<Box<str>>()).sum();
        let ends: usize = self.ends.iter().map(|e| size_of_val(&e[..])).sum();
        keys + self.text.len()
            + size_of_val(&self.value_ends[..])
            + size_of_val(&self.entries[..])
            + ends
    }

    fn slice(&self, list: usize, first: u32, index: usize) -> &[(u32, u32)] {
        let ends = &self.ends[list];
        let Some(&end) = ends.get(index) else { return &[] };
        let start = index.checked_sub(1).map_or(first, |before| ends[before]);
        &self.entries[start as usize..end as usize]
    }

    fn pairs<'a>(&'a self, of: &'a [(u32, u32)]) -> impl Iterator<Item = (&'a str, &'a str)> {
        of.iter().map(|&(k, v)| (&*self.keys[k as usize], self.value(v)))
    }
}

impl Model {
    /// The first value that an element's extras have for a key; objects inside objects have keys
    /// with dots (`Pset_WallCommon.FireRating`).
    pub fn property(&self, element: ElementId, key: &str) -> Option<&str> {
        let key = self.properties.key_id(key)?;
        let entries = self.properties.entries_of_element(element);
        entries.iter().find(|e| e.0 == key).map(|e| self.properties.value(e.1))
    }

    /// All properties of an element, in the file's order; a list has one entry a value.
    pub fn properties(&self, element: ElementId) -> impl Iterator<Item = (&str, &str)> {
        self.properties.pairs(self.properties.entries_of_element(element))
    }

    /// All properties of a group, in the file's order.
    pub fn group_properties(&self, group: GroupId) -> impl Iterator<Item = (&str, &str)> {
        self.properties.pairs(self.properties.entries_of_group(group))
    }

    /// The groups above an element, the nearest first.
    pub fn groups_above(&self, element: &Element) -> impl Iterator<Item = GroupId> {
        let mut next = element.group;
        // No chain is longer than there are groups: a model made by hand may have a cycle.
        (0..self.groups.len()).map_while(move |_| {
            let group = next?;
            next = self.groups.get(group.index())?.parent;
            Some(group)
        })
    }
}

/// What the extras of a node say: objects inside objects by keys with dots, one entry for each value
/// of a list. `null`, empty texts, what lies deeper than [`MOST_DEPTH`] and keys longer than
/// [`LONGEST_KEY`] say nothing.
pub fn flatten(extras: &Value, say: &mut dyn FnMut(&str, &str)) {
    if extras.is_object() {
        visit(extras, 0, &mut String::new(), say);
    }
}

fn visit(value: &Value, depth: usize, key: &mut String, say: &mut dyn FnMut(&str, &str)) {
    if depth > MOST_DEPTH || key.len() > LONGEST_KEY {
        return;
    }
    match value {
        Value::Null => {}
        Value::Bool(yes) => say(key, if *yes { "true" } else { "false" }),
        Value::Number(number) => say(key, &number.to_string()),
        Value::String(text) if text.trim().is_empty() => {}
        Value::String(text) => say(key, text.trim()),
        Value::Array(list) => list.iter().for_each(|v| visit(v, depth + 1, key, say)),
        Value::Object(map) => {
            let before = key.len();
            for (name, value) in map {
                if before > 0 {
                    key.push('.');
                }
                key.push_str(name);
                visit(value, depth + 1, key, say);
                key.truncate(before);
            }
        }
    }
}

/// Puts a table together: elements in order, then groups in order.
#[derive(Default)]
pub struct Builder {
    table: Properties,
    keys: HashMap<Box<str>, u32>,
    values: HashMap<Box<str>, u32>,
    groups: bool,
    full: bool,
}

impl Builder {
    /// A property of the next element, or of the next group after [`Builder::end_elements`].
    pub fn say(&mut self, key: &str, value: &str) {
        match self.entry(key, value) {
            Some(entry) => self.table.entries.push(entry),
            None => self.full = true,
        }
    }

    /// What was said was said of the next element.
    pub fn end_element(&mut self) {
        debug_assert!(!self.groups, "elements come before groups");
        self.table.ends[0].push(self.table.entries.len() as u32);
    }

    /// There are no more elements; groups follow.
    pub fn end_elements(&mut self) {
        self.groups = true;
        self.table.first_of_groups = self.table.entries.len() as u32;
    }

    /// What was said was said of the next group.
    pub fn end_group(&mut self) {
        debug_assert!(self.groups, "groups come after elements");
        self.table.ends[1].push(self.table.entries.len() as u32);
    }

    /// The table, and whether something did not fit.
    pub fn finish(mut self) -> (Properties, Option<Full>) {
        if !self.groups {
            self.table.first_of_groups = self.table.entries.len() as u32;
        }
        self.table.entries.shrink_to_fit();
        self.table.text.shrink_to_fit();
        (self.table, self.full.then_some(Full))
    }

    fn entry(&mut self, key: &str, value: &str) -> Option<(u32, u32)> {
        let table = &mut self.table;
        if table.entries.len() >= MOST_ENTRIES {
            return None;
        }
        let key = match self.keys.get(key) {
            Some(&id) => id,
            None if table.keys.len() >= MOST_KEYS => return None,
            None => {
                let id = table.keys.len() as u32;
                table.keys.push(key.into());
                self.keys.insert(key.into(), id);
                id
            }
        };
        let value = match self.values.get(value) {
            Some(&id) => id,
            None if table.text.len() + value.len() > MOST_TEXT => return None,
            None => {
                let id = table.value_ends.len() as u32;
                table.text.push_str(value);
                table.value_ends.push(table.text.len() as u32);
                self.values.insert(value.into(), id);
                id
            }
        };
        Some((key, value))
    }
}

/// Says that a table is not complete.
pub(crate) fn note_full(file: &str, diagnostics: &mut Diagnostics) {
    diagnostics.add(Severity::Warning, "too-many-properties", file, || {
        format!(
            "{file}: the extras have more than {MOST_KEYS} keys, {MOST_ENTRIES} entries or \
             {MOST_TEXT} bytes of distinct values; what follows is left out"
        )
    });
}

/// The properties of several models, whose elements and groups stand one after the other.
pub fn joined<'a>(
    tables: impl IntoIterator<Item = &'a Model> + Clone,
) -> (Properties, Option<Full>) {
    let mut builder = Builder::default();
    for model in tables.clone() {
        for i in 0..model.elements.len() as u32 {
            model.properties(ElementId(i)).for_each(|(k, v)| builder.say(k, v));
            builder.end_element();
        }
    }
    builder.end_elements();
    for model in tables {
        for i in 0..model.groups.len() as u32 {
            model.group_properties(GroupId(i)).for_each(|(k, v)| builder.say(k, v));
            builder.end_group();
        }
    }
    builder.finish()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::Group;

    fn flat(json: &str) -> Vec<(String, String)> {
        let mut found = Vec::new();
        let value = serde_json::from_str(json).unwrap();
        flatten(&value, &mut |k, v| found.push((k.to_owned(), v.to_owned())));
        found
    }

    #[test]
    fn objects_get_dots_lists_several_entries_and_silence_none() {
        let found = flat(
            r#"{"guid": "g", "n": 3, "Pset": {"Fire": " F90 ", "deep": {"er": true}},
                "tasks": ["a", "b", null], "nothing": null, "blank": " ", "list": [{"x": 1}, {"x": 2}]}"#,
        );
        let found: Vec<_> = found.iter().map(|(k, v)| format!("{k}={v}")).collect();
        let expected = [
            "guid=g",
            "n=3",
            "Pset.Fire=F90",
            "Pset.deep.er=true",
            "tasks=a",
            "tasks=b",
            "list.x=1",
            "list.x=2",
        ];
        assert_eq!(found, expected);
        for other in ["3", "\"text\"", "[1, 2]", "null"] {
            assert!(flat(other).is_empty(), "{other}");
        }
        let nested = |n: usize| format!("{}1{}", r#"{"a":"#.repeat(n), "}".repeat(n));
        assert_eq!(flat(&nested(MOST_DEPTH)).len(), 1);
        assert!(flat(&nested(MOST_DEPTH + 1)).is_empty());
    }

    fn model(elements: &[&[(&str, &str)]], groups: &[&[(&str, &str)]]) -> Model {
        let mut builder = Builder::default();
        for element in elements {
            element.iter().for_each(|(k, v)| builder.say(k, v));
            builder.end_element();
        }
        builder.end_elements();
        for group in groups {
            group.iter().for_each(|(k, v)| builder.say(k, v));
            builder.end_group();
        }
        let (properties, full) = builder.finish();
        assert_eq!(full, None);
        Model {
            properties,
            elements: vec![Element::default(); elements.len()],
            groups: vec![Group::default(); groups.len()],
            ..Model::default()
        }
    }

    #[test]
    fn each_owner_finds_its_own_entries_and_texts_are_kept_once() {
        let model = model(
            &[&[("zone", "A"), ("tag", "7")], &[], &[("zone", "A"), ("zone", "B")]],
            &[&[("level", "1")], &[("zone", "A")]],
        );
        assert_eq!(model.property(ElementId(0), "tag"), Some("7"));
        assert_eq!(model.property(ElementId(0), "TAG"), Some("7"), "case does not matter");
        assert_eq!(model.property(ElementId(1), "tag"), None);
        assert_eq!(model.property(ElementId(2), "level"), None, "that is a group's");
        assert_eq!(model.property(ElementId(9), "tag"), None);
        let zones: Vec<_> = model.properties(ElementId(2)).collect();
        assert_eq!(zones, [("zone", "A"), ("zone", "B")]);
        assert_eq!(model.group_properties(GroupId(1)).collect::<Vec<_>>(), [("zone", "A")]);
        assert_eq!(model.properties.value_count(), 4);
        assert_eq!(model.properties.keys().len(), 3);
        let mut some = model.properties.clone();
        some.retain_elements(&[true, false, true]);
        assert_eq!(
            some.entries_of_element(ElementId(1)),
            model.properties.entries_of_element(ElementId(2))
        );
        assert!(some.entries_of_element(ElementId(2)).is_empty());
        assert_eq!(
            some.entries_of_group(GroupId(0)),
            model.properties.entries_of_group(GroupId(0))
        );
        some.retain_elements(&[false, false]);
        assert!(some.entries_of_element(ElementId(0)).is_empty());
        assert_eq!(
            some.entries_of_group(GroupId(1)),
            model.properties.entries_of_group(GroupId(1))
        );
        let (both, full) = joined([&model, &model]);
        assert_eq!(full, None);
        assert_eq!(both.value_count(), 4);
        assert_eq!(
            both.entries_of_element(ElementId(5)),
            model.properties.entries_of_element(ElementId(2))
        );
        assert_eq!(
            both.entries_of_group(GroupId(2)),
            model.properties.entries_of_group(GroupId(0))
        );
        assert!(model.properties.bytes() < 400);
    }

    #[test]
    fn groups_above_end_at_the_top_and_in_a_cycle() {
        let mut model = model(&[&[]], &[&[], &[], &[]]);
        model.elements[0].group = Some(GroupId(2));
        model.groups[2].parent = Some(GroupId(0));
        let above: Vec<_> = model.groups_above(&model.elements[0]).collect();
        assert_eq!(above, [GroupId(2), GroupId(0)]);
        model.groups[0].parent = Some(GroupId(2));
        assert_eq!(model.groups_above(&model.elements[0]).count(), 3);
    }

    #[test]
    fn more_keys_than_a_table_holds_are_left_out_and_said() {
        let mut builder = Builder::default();
        for i in 0..=MOST_KEYS {
            builder.say(&i.to_string(), "v");
            builder.end_element();
        }
        let (table, full) = builder.finish();
        assert_eq!((table.keys().len(), full), (MOST_KEYS, Some(Full)));
        assert!(table.entries_of_element(ElementId(MOST_KEYS as u32)).is_empty());
    }
}
