//! The keys of both sides of a rule, distinct texts once.

use super::rules::{ActivityBy, ElementBy, List, Match, Pattern, Rule};
use crate::{ElementId, Group, GroupId, Model};
use std::borrow::Cow;
use std::collections::HashMap;
use topout_schedule::Schedule;

/// What a key of the model stands for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Target {
    Element(u32),
    Group(GroupId),
}

/// Where a key of the schedule stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub activity: u32,
    /// Which of the activity's elements it belongs to; 0 where it is no element's.
    pub element: u32,
    /// The same for the keys that mean the same thing; see [`super::rules::Match::InOrder`].
    pub identity: u32,
}

/// Distinct keys of one side and who uses them.
pub(super) struct Keys<'a, U> {
    /// Distinct keys, in the order of their first use.
    pub texts: Vec<Cow<'a, str>>,
    pub index: HashMap<Cow<'a, str>, u32>,
    /// Key, number to count by (0 where there is none), use; in the order of model or schedule.
    pub uses: Vec<(u32, u64, U)>,
}

impl<'a, U> Keys<'a, U> {
    fn new() -> Self {
        Self { texts: Vec::new(), index: HashMap::new(), uses: Vec::new() }
    }

    fn intern(&mut self, text: Cow<'a, str>) -> u32 {
        if let Some(&id) = self.index.get(&text) {
            return id;
        }
        let id = self.texts.len() as u32;
        self.texts.push(text.clone());
        self.index.insert(text, id);
        id
    }

    /// Uses by key: those of key `k` are `order[starts[k]..starts[k + 1]]`, indices into `uses`, by
    /// their number and then as they come.
    pub fn by_key(&self) -> (Vec<u32>, Vec<u32>) {
        let mut starts = vec![0u32; self.texts.len() + 1];
        for (key, ..) in &self.uses {
            starts[*key as usize + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        let mut next = starts.clone();
        let mut order = vec![0u32; self.uses.len()];
        let mut numbered = false;
        for (i, (key, number, _)) in self.uses.iter().enumerate() {
            let place = &mut next[*key as usize];
            order[*place as usize] = i as u32;
            *place += 1;
            numbered |= *number != 0;
        }
        if numbered {
            for range in starts.windows(2) {
                order[range[0] as usize..range[1] as usize]
                    .sort_by_key(|&i| self.uses[i as usize].1);
            }
        }
        (starts, order)
    }
}

/// Brings texts into the form in which they are compared; each distinct text once.
struct Reader<'a, 'r> {
    pattern: Option<&'r Pattern>,
    only: Vec<Glob>,
    fold: bool,
    /// Whether no text at all is a key too: what has no name can still be counted by a number.
    empty: bool,
    known: HashMap<&'a str, Option<(u32, u64)>>,
}

impl<'a, 'r> Reader<'a, 'r> {
    fn new(pattern: Option<&'r Pattern>, only: &[String], rule: &Rule) -> Self {
        let only = only.iter().map(|o| Glob::new(o, rule.case)).collect();
        let numbered = rule.activity.pattern.as_ref().is_some_and(Pattern::has_order);
        let empty = numbered && rule.matching == Match::InOrder;
        Self { pattern, only, fold: !rule.case, empty, known: HashMap::new() }
    }

    /// The key that a text holds and its number.
    fn read<U>(&mut self, text: &'a str, keys: &mut Keys<'a, U>) -> Option<(u32, u64)> {
        if text.is_empty() && !self.empty {
            return None;
        }
        if self.pattern.is_none() && self.only.is_empty() && !self.fold {
            return Some((keys.intern(Cow::Borrowed(text)), 0));
        }
        if let Some(&known) = self.known.get(text) {
            return known;
        }
        let key = self.key(text).map(|(key, number)| (keys.intern(key), number));
        self.known.insert(text, key);
        key
    }

    fn key(&self, text: &'a str) -> Option<(Cow<'a, str>, u64)> {
        if !self.only.is_empty() && !self.only.iter().any(|o| o.matches(text)) {
            return None;
        }
        let (key, number) = match self.pattern {
            Some(pattern) => pattern.find(text)?,
            None => (text, None),
        };
        let key = match self.fold {
            true => Cow::Owned(key.to_lowercase()),
            false => Cow::Borrowed(key),
        };
        (self.empty || !key.is_empty()).then_some((key, number.unwrap_or(0)))
    }
}

/// A text in which `*` stands for any text and `?` for any character.
pub(super) struct Glob {
    pattern: Vec<char>,
    fold: bool,
}

impl Glob {
    pub fn new(text: &str, case: bool) -> Self {
        let text = if case { text.to_owned() } else { text.to_lowercase() };
        Self { pattern: text.chars().collect(), fold: !case }
    }

    /// Whether all of a text fits. Costs at most the product of both lengths.
    pub fn matches(&self, text: &str) -> bool {
        let text = if self.fold { Cow::Owned(text.to_lowercase()) } else { Cow::Borrowed(text) };
        let text: Vec<char> = text.chars().collect();
        let (mut p, mut t) = (0, 0);
        // The last `*`, and up to where it reaches.
        let mut star: Option<(usize, usize)> = None;
        while t < text.len() {
            match self.pattern.get(p) {
                Some('*') => {
                    star = Some((p, t));
                    p += 1;
                }
                Some(&c) if c == '?' || c == text[t] => (p, t) = (p + 1, t + 1),
                _ => match &mut star {
                    Some((at, reach)) => {
                        *reach += 1;
                        (p, t) = (*at + 1, *reach);
                    }
                    None => return false,
                },
            }
        }
        self.pattern[p..].iter().all(|&c| c == '*')
    }
}

/// The keys of the model's elements and groups.
pub(super) fn of_model<'a>(model: &'a Model, rule: &Rule) -> Keys<'a, Target> {
    let side = &rule.element;
    let mut keys = Keys::new();
    let mut reader = Reader::new(side.pattern.as_ref(), &side.only, rule);
    each_text_of_model(model, &side.by, &mut |text, target| {
        if let Some((key, number)) = reader.read(text, &mut keys) {
            keys.uses.push((key, number, target));
        }
    });
    keys
}

/// Every text that may be a key: those of elements in order, then those of groups in order.
pub(super) fn each_text_of_model<'a>(
    model: &'a Model,
    by: &ElementBy,
    say: &mut dyn FnMut(&'a str, Target),
) {
    let table = &model.properties;
    let wanted: Vec<bool> = match by {
        ElementBy::Property(key) => {
            let id = table.key_id(key);
            (0..table.keys().len()).map(|k| id == Some(k as u32)).collect()
        }
        ElementBy::Layer => table.keys().map(names_a_layer).collect(),
        _ => Vec::new(),
    };
    let tabled = |entries: &'a [(u32, u32)], target, say: &mut dyn FnMut(&'a str, Target)| {
        for (key, value) in entries {
            if wanted[*key as usize] {
                say(table.value(*value), target);
            }
        }
    };
    for (i, element) in model.elements.iter().enumerate() {
        let target = Target::Element(i as u32);
        let guid = element.guid.as_deref();
        match by {
            ElementBy::NameOrGuid => two(&element.name, guid, target, say),
            ElementBy::Name => two(&element.name, Some(&element.label), target, say),
            ElementBy::Guid => say(guid.unwrap_or_default(), target),
            ElementBy::Storey => say(&element.storey, target),
            ElementBy::Type => say(&element.kind, target),
            ElementBy::Property(_) | ElementBy::Layer if wanted.is_empty() => {}
            ElementBy::Property(_) | ElementBy::Layer => {
                tabled(table.entries_of_element(ElementId(i as u32)), target, say);
            }
        }
    }
    for (i, group) in model.groups.iter().enumerate() {
        let Group { name, label, kind, guid, .. } = group;
        let id = GroupId(i as u32);
        let target = Target::Group(id);
        let guid = guid.as_deref();
        match by {
            ElementBy::NameOrGuid => two(name, guid, target, say),
            ElementBy::Name => two(name, Some(label), target, say),
            ElementBy::Guid => say(guid.unwrap_or_default(), target),
            // The elements below have the name that people use already.
            ElementBy::Storey if is_storey(kind) => two(name, guid, target, say),
            ElementBy::Property(_) | ElementBy::Layer if !wanted.is_empty() => {
                tabled(table.entries_of_group(id), target, say);
            }
            _ => {}
        }
    }
}

/// Both texts, once where they are equal.
fn two<'a>(
    first: &'a str,
    second: Option<&'a str>,
    target: Target,
    say: &mut dyn FnMut(&'a str, Target),
) {
    say(first, target);
    if let Some(second) = second.filter(|&s| s != first) {
        say(second, target);
    }
}

fn is_storey(kind: &str) -> bool {
    let words = ["ifcbuildingstorey", "buildingstorey", "storey"];
    words.iter().any(|word| kind.eq_ignore_ascii_case(word))
}

/// Whether a property's values are layers: by the last part of its key.
pub(crate) fn names_a_layer(key: &str) -> bool {
    let last = key.rsplit('.').next().unwrap_or(key).to_ascii_lowercase();
    let words = [
        "layer",
        "layers",
        "layername",
        "ifclayer",
        "presentationlayer",
        "presentationlayerassignment",
    ];
    words.contains(&last.as_str())
}

/// The keys of the schedule's activities; `None` where no activity has the field that the rule names.
pub(super) fn of_schedule<'a>(
    schedule: &'a Schedule,
    rule: &Rule,
    wbs: &'a WbsKeys,
) -> Option<Keys<'a, Entry>> {
    let side = &rule.activity;
    let mut keys = Keys::new();
    let mut reader = Reader::new(side.pattern.as_ref(), &[], rule);
    let mut identities: HashMap<&'a str, u32> = HashMap::new();
    let by_element = matches!(side.by, ActivityBy::ElementField(_));
    let found = each_text_of_schedule(schedule, &side.by, wbs, &mut |text, activity, element| {
        split(text, &side.list, &mut |part| {
            let Some((key, number)) = reader.read(part, &mut keys) else { return };
            // A column of an event log says the same of an element in each of its rows; a text of
            // which a part is the key means one thing wherever it stands; another is one thing each.
            let same = if by_element {
                let elements = &schedule.activities[activity as usize].elements;
                elements.get(element as usize).map(String::as_str)
            } else {
                side.pattern.as_ref().map(|_| part)
            };
            let next = keys.uses.len() as u32;
            let identity = same.map_or(next, |same| *identities.entry(same).or_insert(next));
            keys.uses.push((key, number, Entry { activity, element, identity }));
        });
    });
    found.then_some(keys)
}

/// Every text that may hold keys, in the schedule's order, with its activity and the number of the
/// element that it belongs to. Whether the schedule has what is asked for.
pub(super) fn each_text_of_schedule<'a>(
    schedule: &'a Schedule,
    by: &ActivityBy,
    wbs: &'a WbsKeys,
    say: &mut dyn FnMut(&'a str, u32, u32),
) -> bool {
    let field = match by {
        ActivityBy::Code(name) | ActivityBy::Field(name) => {
            let Some(name) = field_name(schedule, name) else { return false };
            name
        }
        ActivityBy::ElementField(name) => {
            let Some(name) = element_field_name(schedule, name) else { return false };
            name
        }
        _ => "",
    };
    for (a, activity) in schedule.activities.iter().enumerate() {
        let number = a as u32;
        match by {
            ActivityBy::Id => say(&activity.id, number, 0),
            ActivityBy::Name => say(&activity.name, number, 0),
            ActivityBy::Wbs => {
                let node = activity.wbs.and_then(|w| wbs.0.get(w as usize));
                node.into_iter().flatten().for_each(|text| say(text, number, 0));
            }
            ActivityBy::Code(_) | ActivityBy::Field(_) => {
                let fields = activity.fields.iter().filter(|(name, _)| **name == *field);
                fields.for_each(|(_, value)| say(value, number, 0));
            }
            ActivityBy::Elements => {
                let elements = activity.elements.iter().zip(0..);
                elements.for_each(|(text, n)| say(text, number, n));
            }
            ActivityBy::ElementField(_) => {
                for n in 0..activity.elements.len() {
                    if let Some(text) = activity.element_field(field, n) {
                        say(text, number, n as u32);
                    }
                }
            }
        }
    }
    true
}

/// The name of a field as the schedule writes it: exactly this, else one that differs in case alone.
pub(super) fn field_name<'a>(schedule: &'a Schedule, name: &str) -> Option<&'a str> {
    let mut alike = None;
    for (given, _) in schedule.activities.iter().flat_map(|a| &a.fields) {
        if **given == *name {
            return Some(given);
        }
        if alike.is_none() && given.eq_ignore_ascii_case(name) {
            alike = Some(&**given);
        }
    }
    alike
}

/// The names of fields, in the order of their first use, as many as a message lists.
pub(super) fn field_names(schedule: &Schedule) -> Vec<String> {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in schedule.activities.iter().flat_map(|a| &a.fields) {
        if names.len() < MOST_FIELDS && !names.contains(&&**name) {
            names.push(name);
        }
    }
    names.into_iter().map(str::to_owned).collect()
}

/// Fields that are listed or tried. Linear look-up among so many costs less than hashing each name.
const MOST_FIELDS: usize = 64;

/// The names of columns that say something of each element of an activity (event logs), in the order
/// of their first use, as many as a message lists.
pub(super) fn element_field_names(schedule: &Schedule) -> Vec<String> {
    let mut names: Vec<&str> = Vec::new();
    for field in schedule.activities.iter().flat_map(|a| &a.element_fields) {
        if names.len() < MOST_FIELDS && !names.contains(&&*field.name) {
            names.push(&field.name);
        }
    }
    names.into_iter().map(str::to_owned).collect()
}

/// The name of such a column as the schedule writes it: exactly this, else one that differs in case
/// alone. Where its values are the same for all elements of every activity it is a field.
fn element_field_name<'a>(schedule: &'a Schedule, name: &str) -> Option<&'a str> {
    let mut alike = None;
    for field in schedule.activities.iter().flat_map(|a| &a.element_fields) {
        if *field.name == *name {
            return Some(&field.name);
        }
        if alike.is_none() && field.name.eq_ignore_ascii_case(name) {
            alike = Some(&*field.name);
        }
    }
    alike.or_else(|| field_name(schedule, name))
}

/// The keys of each summary: names and codes on the way up, and the codes from the top joined by dots.
pub(super) struct WbsKeys(Vec<Vec<String>>);

impl WbsKeys {
    /// For the summaries of a schedule; nothing where no rule asks for them.
    pub fn new(schedule: &Schedule, needed: bool) -> Self {
        let mut all: Vec<Vec<String>> = Vec::new();
        let mut paths: Vec<String> = Vec::new();
        let nodes = if needed { &schedule.wbs[..] } else { &[] };
        for (i, node) in nodes.iter().enumerate() {
            let above = node.parent.map(|p| p as usize).filter(|&p| p < i);
            let mut keys = above.map(|p| all[p].clone()).unwrap_or_default();
            let path = match above {
                Some(p) if !paths[p].is_empty() && !node.code.is_empty() => {
                    format!("{}.{}", paths[p], node.code)
                }
                _ => node.code.clone(),
            };
            for key in [&node.name, &node.code, &path] {
                if !key.is_empty() && !keys.contains(key) && keys.len() < MOST_WBS_KEYS {
                    keys.push(key.clone());
                }
            }
            paths.push(if path.len() < MOST_WBS_PATH { path } else { String::new() });
            all.push(keys);
        }
        Self(all)
    }
}

/// Keys of one summary; an outline has some ten levels with three each.
const MOST_WBS_KEYS: usize = 64;
/// Bytes of joined codes.
const MOST_WBS_PATH: usize = 1024;

/// The parts of a text that are keys.
fn split<'a>(text: &'a str, list: &List, say: &mut dyn FnMut(&'a str)) {
    match list {
        List::No => say(text),
        List::Usual => {
            let parts = text.split([',', ';', '|', '\n', '\r']).map(str::trim);
            parts.filter(|p| !p.is_empty()).for_each(say);
        }
        List::At(at) => {
            text.split(at.as_str()).map(str::trim).filter(|p| !p.is_empty()).for_each(say);
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use topout_schedule::WbsNode;

    #[test]
    fn globs_fit_whole_texts() {
        let fits = |glob: &str, text: &str| Glob::new(glob, true).matches(text);
        assert!(fits("IfcWall*", "IfcWallStandardCase") && fits("IfcWall*", "IfcWall"));
        assert!(!fits("IfcWall", "IfcWallStandardCase") && !fits("Wall", "IfcWall"));
        assert!(fits("*a?c*", "xxabcx") && !fits("*a?c", "xxabcx") && fits("*", ""));
        assert!(!fits("?", "") && fits("?", "é") && !fits("a", "A"));
        assert!(Glob::new("IFC*", false).matches("ifcSlab"));
        assert!(!fits(&"*a".repeat(50), &"b".repeat(10_000)), "no blow-up");
    }

    #[test]
    fn lists_are_split_and_trimmed() {
        let parts = |text, list: List| {
            let mut found = Vec::new();
            split(text, &list, &mut |p| found.push(p.to_owned()));
            found
        };
        assert_eq!(parts("a, b;;c|d\n", List::Usual), ["a", "b", "c", "d"]);
        assert_eq!(parts("a, b / c", List::At(" / ".into())), ["a, b", "c"]);
        assert_eq!(parts("a, b", List::No), ["a, b"]);
    }

    #[test]
    fn summaries_are_found_by_name_code_and_joined_codes() {
        let node = |code: &str, name: &str, parent| WbsNode {
            code: code.into(),
            name: name.into(),
            parent,
        };
        let wbs = vec![node("P", "Tower", None), node("2", "Level 2", Some(0))];
        let schedule = Schedule { wbs, ..Schedule::default() };
        let keys = WbsKeys::new(&schedule, true);
        assert_eq!(keys.0[1], ["Tower", "P", "Level 2", "2", "P.2"]);
        assert!(WbsKeys::new(&schedule, false).0.is_empty());
    }

    #[test]
    fn layers_are_known_by_the_end_of_the_key() {
        assert!(names_a_layer("Layer") && names_a_layer("ifc.PresentationLayer"));
        assert!(!names_a_layer("PlayerCount") && !names_a_layer("Layer.Thickness"));
    }
}
