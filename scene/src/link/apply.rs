//! Rules applied: from keys that match to links of elements and activities.

use super::RuleReport;
use super::keys::{self, Entry, Keys, Target, WbsKeys};
use super::matching::{self, Matches};
use super::rules::{ActivityBy, HandLink, Match, Rule, Rules};
use crate::{GroupId, Model};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use topout_schedule::{Diagnostics, Schedule, Severity};

/// Pairs of element and activity that are kept. A schedule that links the whole building to each
/// of thousands of activities would otherwise fill the memory.
const MOST_LINKS: usize = 1 << 27;

/// Elements sorted by group, so that those below a group are a range.
pub(super) struct Groups {
    elements: Vec<u32>,
    ranges: Vec<Range<usize>>,
}

impl Groups {
    pub fn new(model: &Model) -> Self {
        let count = model.groups.len();
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); count];
        let mut stack: Vec<(u32, bool)> = Vec::new();
        for (i, group) in model.groups.iter().enumerate() {
            match group.parent {
                Some(parent) => children[parent.index()].push(i as u32),
                None => stack.push((i as u32, false)),
            }
        }
        let mut own: Vec<Vec<u32>> = vec![Vec::new(); count];
        for (i, element) in model.elements.iter().enumerate() {
            if let Some(group) = element.group {
                own[group.index()].push(i as u32);
            }
        }
        let mut groups = Self { elements: Vec::new(), ranges: vec![0..0; count] };
        while let Some((group, done)) = stack.pop() {
            let g = group as usize;
            if done {
                groups.ranges[g].end = groups.elements.len();
                continue;
            }
            let start = groups.elements.len();
            groups.ranges[g] = start..start;
            groups.elements.append(&mut own[g]);
            stack.push((group, true));
            stack.extend(children[g].drain(..).map(|c| (c, false)));
        }
        groups
    }

    pub fn below(&self, group: GroupId) -> &[u32] {
        &self.elements[self.ranges[group.index()].clone()]
    }
}

/// Links of a model and a schedule; see [`crate::Scene`].
pub(crate) struct Linked {
    pub activity_starts: Vec<u32>,
    pub activity_links: Vec<u32>,
    pub reports: Vec<RuleReport>,
    pub diagnostics: Diagnostics,
}

/// Applies all rules in order, then the links made by hand.
pub(crate) fn links(rules: &Rules, model: &Model, schedule: &Schedule) -> Linked {
    let by = |wanted: ActivityBy| rules.rules.iter().any(|r| r.activity.by == wanted);
    let wbs = WbsKeys::new(schedule, by(ActivityBy::Wbs));
    let mut work = Work {
        rules,
        model,
        schedule,
        wbs: &wbs,
        groups: Groups::new(model),
        pairs: Vec::new(),
        taken: vec![false; model.elements.len()],
        said: by(ActivityBy::Elements).then(|| Entries::new(schedule)),
        diagnostics: Diagnostics::default(),
    };
    let mut reports: Vec<RuleReport> = rules.rules.iter().map(|rule| work.apply(rule)).collect();
    work.note_entries();
    reports.extend(work.by_hand());
    let Work { mut pairs, diagnostics, .. } = work;
    pairs.par_sort_unstable();
    pairs.dedup();
    let mut activity_starts = Vec::with_capacity(model.elements.len() + 1);
    let mut at = 0;
    for element in 0..model.elements.len() as u32 {
        activity_starts.push(at as u32);
        while pairs.get(at).is_some_and(|p| p.0 == element) {
            at += 1;
        }
    }
    activity_starts.push(at as u32);
    let activity_links = pairs.into_iter().map(|p| p.1).collect();
    Linked { activity_starts, activity_links, reports, diagnostics }
}

/// How often each entry of an activity's elements was found by the rules that look for them.
struct Entries {
    /// Where an activity's begin.
    starts: Vec<u32>,
    found: Vec<u32>,
}

impl Entries {
    fn new(schedule: &Schedule) -> Self {
        let mut count = 0u32;
        let mut starts = Vec::with_capacity(schedule.activities.len());
        for activity in &schedule.activities {
            starts.push(count);
            count += activity.elements.len() as u32;
        }
        Self { starts, found: vec![0; count as usize] }
    }

    fn of(&mut self, activity: u32, element: u32) -> &mut u32 {
        &mut self.found[(self.starts[activity as usize] + element) as usize]
    }
}

/// What is known while rules are applied.
struct Work<'a> {
    rules: &'a Rules,
    model: &'a Model,
    schedule: &'a Schedule,
    wbs: &'a WbsKeys,
    groups: Groups,
    /// Pairs of element and activity, in no order and with repetitions.
    pairs: Vec<(u32, u32)>,
    /// Elements that a rule linked.
    taken: Vec<bool>,
    said: Option<Entries>,
    diagnostics: Diagnostics,
}

impl Work<'_> {
    /// The rules file and a rule of it, for messages.
    fn place(&self, rule: &str) -> String {
        match &*self.rules.file {
            "" => format!("rule {rule:?}"),
            file => format!("{file}: rule {rule:?}"),
        }
    }

    fn apply(&mut self, rule: &Rule) -> RuleReport {
        let mut report = RuleReport { name: rule.name.clone(), ..RuleReport::default() };
        let (model, schedule, wbs) = (self.model, self.schedule, self.wbs);
        let (theirs, ours) =
            rayon::join(|| keys::of_model(model, rule), || keys::of_schedule(schedule, rule, wbs));
        let Some(ours) = ours else {
            self.note_field(rule);
            return report;
        };
        self.note_property(rule);
        let matches = matching::matches(rule.matching, rule.case, &ours, &theirs);
        for fault in &matches.faults {
            let place = self.place(&rule.name);
            self.diagnostics
                .add(Severity::Error, "rule-fault", &rule.name, || format!("{place}: {fault}"));
        }
        let met =
            (rule.matching == Match::InOrder).then(|| matching::in_order(&matches, &ours, &theirs));
        note_keys(&mut report, &ours, &matches, met.as_deref());
        let (starts, order) = theirs.by_key();
        let first = self.pairs.len();
        let mut later = HashSet::new();
        for (u, (key, _, entry)) in ours.uses.iter().enumerate() {
            let mut found = 0u32;
            let one = met.as_ref().map(|met| met[u].as_slice());
            let of_key =
                |k: &u32| &order[starts[*k as usize] as usize..starts[*k as usize + 1] as usize];
            let all: &mut dyn Iterator<Item = &u32> = match one {
                Some(one) => &mut one.iter(),
                None => &mut matches.of(*key).iter().flat_map(of_key),
            };
            for &t in all {
                found += 1;
                let target = theirs.uses[t as usize].2;
                let elements = match &target {
                    Target::Element(e) => std::slice::from_ref(e),
                    Target::Group(g) => self.groups.below(*g),
                };
                if self.pairs.len() + elements.len() > MOST_LINKS {
                    self.note_too_many(rule, *entry, &ours.texts[*key as usize]);
                    self.take(first, &mut report, &later);
                    return report;
                }
                for &e in elements {
                    if rule.also || !self.taken[e as usize] {
                        self.pairs.push((e, entry.activity));
                    } else {
                        later.insert(e);
                    }
                }
            }
            self.note_found(rule, *entry, found);
        }
        self.take(first, &mut report, &later);
        report
    }

    /// The pairs from `first` on are those of a rule: counts them and marks their elements.
    fn take(&mut self, first: usize, report: &mut RuleReport, later: &HashSet<u32>) {
        self.pairs[first..].par_sort_unstable();
        let mut activities = vec![false; self.schedule.activities.len()];
        let mut last = None;
        for &(e, a) in &self.pairs[first..] {
            if last == Some((e, a)) {
                continue;
            }
            report.elements += usize::from(last.is_none_or(|(before, _)| before != e));
            report.links += 1;
            report.activities += usize::from(!std::mem::replace(&mut activities[a as usize], true));
            if report.examples.len() < RuleReport::EXAMPLES {
                report.examples.push(example(self.model, self.schedule, e, a));
            }
            self.taken[e as usize] = true;
            last = Some((e, a));
        }
        report.left_to_earlier = later.len();
    }

    /// Remembers how often an entry of an activity's elements was found; several elements of one
    /// name are said.
    fn note_found(&mut self, rule: &Rule, entry: Entry, found: u32) {
        if rule.activity.by != ActivityBy::Elements {
            return;
        }
        let (schedule, Entry { activity, element, .. }) = (self.schedule, entry);
        if let Some(said) = &mut self.said {
            let count = said.of(activity, element);
            *count = count.saturating_add(found);
        }
        if found > 1 && rule.matching == Match::Exact {
            let (a, n) = (activity as usize, element as usize);
            let text = schedule.activities[a].elements[n].as_str();
            self.diagnostics.add(Severity::Info, "ambiguous-element", text, || {
                format!(
                    "{}: activity {:?} is linked to {text:?}, which occurs {found} times; all \
                     are linked",
                    schedule.element_place(a, n),
                    schedule.activities[a].id
                )
            });
        }
    }

    /// Says which entries of elements no rule found.
    fn note_entries(&mut self) {
        let Some(mut said) = self.said.take() else { return };
        for (a, activity) in self.schedule.activities.iter().enumerate() {
            for (n, text) in activity.elements.iter().enumerate() {
                if *said.of(a as u32, n as u32) > 0 {
                    continue;
                }
                self.diagnostics.add(Severity::Warning, "unknown-element", text.as_str(), || {
                    format!(
                        "{}: activity {:?} is linked to {text:?}, which the model does not have",
                        self.schedule.element_place(a, n),
                        activity.id
                    )
                });
            }
        }
    }

    fn note_too_many(&mut self, rule: &Rule, entry: Entry, key: &str) {
        let place = self.place(&rule.name);
        let (a, n) = (entry.activity as usize, entry.element as usize);
        self.diagnostics.add(Severity::Error, "too-many-links", key, || {
            format!(
                "{place}: {}: activity {:?}: more than {MOST_LINKS} links of elements; {key:?} and \
                 what follows is left out",
                self.schedule.element_place(a, n),
                self.schedule.activities[a].id
            )
        });
    }

    /// Says that no activity has the field of a rule, and which there are.
    fn note_field(&mut self, rule: &Rule) {
        let place = self.place(&rule.name);
        let by = &rule.activity.by;
        let schedule = self.schedule;
        self.diagnostics.add(Severity::Warning, "unknown-field", rule.name.as_str(), || {
            let known = match by {
                ActivityBy::ElementField(_) => keys::element_field_names(schedule),
                _ => keys::field_names(schedule),
            };
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            format!("{place}: no activity has the {by} (there are: {known})")
        });
    }

    /// Says that nothing in the model has the property of a rule.
    fn note_property(&mut self, rule: &Rule) {
        let by = &rule.element.by;
        let super::rules::ElementBy::Property(key) = by else { return };
        let table = &self.model.properties;
        if table.key_id(key).is_some() {
            return;
        }
        let place = self.place(&rule.name);
        self.diagnostics.add(Severity::Warning, "unknown-property", rule.name.as_str(), || {
            let known: Vec<&str> = table.keys().take(MOST_NAMED).collect();
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            format!("{place}: no element has the {by} (there are: {known})")
        });
    }

    /// Takes detached links away and adds attached ones.
    fn by_hand(&mut self) -> Vec<RuleReport> {
        let Rules { attached, detached, .. } = self.rules;
        if attached.is_empty() && detached.is_empty() {
            return Vec::new();
        }
        let standard = Rule::standard();
        let names = keys::of_model(self.model, &standard);
        let ids: HashMap<&str, u32> =
            self.schedule.activities.iter().map(|a| a.id.as_str()).zip(0..).collect();
        let mut reports = Vec::new();
        for (name, links) in [("detached", detached), ("attached", attached)] {
            if links.is_empty() {
                continue;
            }
            let mut report = RuleReport { name: name.to_owned(), ..RuleReport::default() };
            let mut pairs = self.hand_pairs(name, links, &names, &ids, &mut report);
            pairs.par_sort_unstable();
            pairs.dedup();
            if name == "detached" {
                let gone = |pair: &(u32, u32)| pairs.binary_search(pair).is_ok();
                let kept: Vec<(u32, u32)> =
                    self.pairs.par_iter().copied().filter(|pair| !gone(pair)).collect();
                let before: HashSet<(u32, u32)> = self.pairs.iter().copied().filter(gone).collect();
                pairs.retain(|pair| before.contains(pair));
                self.pairs = kept;
            } else {
                self.pairs.extend_from_slice(&pairs);
            }
            report.links = pairs.len();
            report.elements = pairs.chunk_by(|a, b| a.0 == b.0).count();
            report.activities = pairs.iter().map(|p| p.1).collect::<HashSet<_>>().len();
            let examples = pairs.iter().take(RuleReport::EXAMPLES);
            report.examples =
                examples.map(|&(e, a)| example(self.model, self.schedule, e, a)).collect();
            reports.push(report);
        }
        reports
    }

    fn hand_pairs(
        &mut self,
        name: &str,
        links: &[HandLink],
        names: &Keys<'_, Target>,
        ids: &HashMap<&str, u32>,
        report: &mut RuleReport,
    ) -> Vec<(u32, u32)> {
        let (starts, order) = names.by_key();
        let mut pairs = Vec::new();
        let file = &self.rules.file;
        let left = |report: &mut RuleReport, key: &str| {
            report.keys_left += 1;
            if report.examples_left.len() < RuleReport::EXAMPLES {
                report.examples_left.push(key.to_owned());
            }
        };
        for (i, link) in links.iter().enumerate() {
            report.keys += link.elements.len();
            let Some(&activity) = ids.get(link.activity.as_str()) else {
                link.elements.iter().for_each(|key| left(report, key));
                self.diagnostics.add(
                    Severity::Warning,
                    "unknown-hand-link",
                    &link.activity,
                    || {
                        format!(
                            "{file}: {name}[{i}].activity: {:?} is no activity of the schedule",
                            link.activity
                        )
                    },
                );
                continue;
            };
            for (n, key) in link.elements.iter().enumerate() {
                let Some(&k) = names.index.get(key.as_str()) else {
                    left(report, key);
                    self.diagnostics.add(Severity::Warning, "unknown-hand-link", key, || {
                        format!(
                            "{file}: {name}[{i}].elements[{n}]: the model has no {key:?} to be {name} \
                             (activity {:?})",
                            link.activity
                        )
                    });
                    continue;
                };
                let k = k as usize;
                for &t in &order[starts[k] as usize..starts[k + 1] as usize] {
                    let target = names.uses[t as usize].2;
                    let elements = match &target {
                        Target::Element(e) => std::slice::from_ref(e),
                        Target::Group(g) => self.groups.below(*g),
                    };
                    if self.pairs.len() + pairs.len() + elements.len() > MOST_LINKS {
                        self.diagnostics.add(Severity::Error, "too-many-links", key, || {
                            format!(
                                "{file}: {name}[{i}].elements[{n}]: more than {MOST_LINKS} links; \
                                 {key:?} and what follows is left out"
                            )
                        });
                        return pairs;
                    }
                    pairs.extend(elements.iter().map(|&e| (e, activity)));
                }
            }
        }
        pairs
    }
}

/// Names of fields or properties that a message lists.
const MOST_NAMED: usize = 40;

/// What an element is called, and the id of an activity.
fn example(model: &Model, schedule: &Schedule, element: u32, activity: u32) -> (String, String) {
    let element = &model.elements[element as usize];
    let texts = [&element.label, &element.name, element.guid.as_ref().unwrap_or(&element.name)];
    let name = texts.into_iter().find(|n| !n.is_empty()).cloned().unwrap_or_default();
    (name, schedule.activities[activity as usize].id.clone())
}

/// Counts the keys of the schedule that mean nothing: in the model, or (in order) no element more.
fn note_keys(
    report: &mut RuleReport,
    ours: &Keys<'_, Entry>,
    matches: &Matches,
    met: Option<&[Option<u32>]>,
) {
    // In order the same text may stand for an element here and for none there: then it is left.
    let mut left_somewhere = vec![false; ours.texts.len()];
    for ((key, ..), met) in ours.uses.iter().zip(met.into_iter().flatten()) {
        left_somewhere[*key as usize] |= met.is_none();
    }
    report.keys = ours.texts.len();
    for (k, text) in ours.texts.iter().enumerate() {
        let left = match met {
            Some(_) => left_somewhere[k],
            None => matches.of(k as u32).is_empty(),
        };
        if left {
            report.keys_left += 1;
            if report.examples_left.len() < RuleReport::EXAMPLES {
                report.examples_left.push(text.to_string());
            }
        }
    }
}
