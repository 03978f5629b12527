//! Which rule would link what the rules do not: many are tried on a sample, the best in full.

use super::keys::{self, Entry, Keys, Target, WbsKeys};
use super::matching;
use super::rules::{ActivityBy, ElementBy, Match, Pattern, Rule};
use crate::{Model, Scene};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::HashSet;
use std::fmt;
use topout_schedule::Schedule;

/// Distinct keys of the schedule that each pair of sides is tried on.
const SAMPLE: usize = 1000;
/// Rules that are tried in full.
const FINALISTS: usize = 16;
/// Properties and fields of each kind that are tried.
const MOST_TRIED: usize = 64;
/// Suggestions that are made.
const MOST_MADE: usize = 5;
/// Names with the number of the instance behind them, as Synchro writes resources: `wall_(#1315)`.
const NUMBERED: &str = r"^(?<key>.*?)_?\(#(?<order>\d+)\)$";

/// A rule and what it would match.
#[derive(Clone, PartialEq, Debug)]
pub struct Suggestion {
    /// The rule.
    pub rule: Rule,
    /// Distinct keys of the schedule; in order, things that keys stand for.
    pub keys: usize,
    /// Those of them that mean something in the model.
    pub matched: usize,
    /// Elements that would be linked.
    pub elements: usize,
    /// Activities that would be linked.
    pub activities: usize,
}

/// What was found out about a schedule and a model that do not fit.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Suggestions {
    /// What matches by the usual ways, also where it is nothing.
    pub usual: Vec<Suggestion>,
    /// What matches best, best first; nothing where nothing does.
    pub best: Vec<Suggestion>,
}

impl Suggestion {
    /// How the keys match, without figures: `guid`, `name in order`.
    pub fn way(&self) -> String {
        let Rule { element, matching, case, .. } = &self.rule;
        let case = if *case { "" } else { ", whatever the case" };
        let order = if *matching == Match::InOrder { " and order" } else { "" };
        format!("{}{case}{order}", element.by)
    }

    /// For scripts; the rule is as it stands in a rules file.
    pub fn to_value(&self) -> Value {
        json!({
            "text": self.to_string(),
            "keys": self.keys,
            "matched": self.matched,
            "elements": self.elements,
            "activities": self.activities,
            "rule": self.rule.to_value(),
        })
    }

    /// From 0 to 1: keys and activities that are served, and how exactly: a key that means the whole
    /// storey says less than one that means a wall.
    fn score(&self, activities: usize) -> f64 {
        let share = |part: usize, all: usize| part as f64 / all.max(1) as f64;
        let spread = share(self.elements, self.matched).max(1.0);
        share(self.matched, self.keys) * share(self.activities, activities).sqrt()
            / (1.0 + spread.ln())
    }
}

impl fmt::Display for Suggestion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} of {} keys ({}) match by {}: {} elements, {} activities",
            grouped(self.matched),
            grouped(self.keys),
            self.rule.activity.by,
            self.way(),
            grouped(self.elements),
            grouped(self.activities)
        )
    }
}

impl fmt::Display for Suggestions {
    /// One sentence: what the usual ways give and what the best gives.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let usual = &self.usual;
        for (i, s) in usual.iter().enumerate() {
            let of = if i == 0 { format!(" of {} keys", grouped(s.keys)) } else { String::new() };
            let verb = if i == 0 { " match" } else { "" };
            let comma = if i == 0 { "" } else { ", " };
            write!(f, "{comma}{}{of}{verb} by {}", grouped(s.matched), s.way())?;
        }
        let separator = if usual.is_empty() { "" } else { "; " };
        match self.best.first() {
            None if usual.is_empty() => f.write_str("no key of the schedule matches the model"),
            None => Ok(()),
            Some(best) => write!(f, "{separator}{best}"),
        }
    }
}

/// `1234567` as `1,234,567`.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Whether the links of a scene leave so much out that suggestions are worth their while: more than a
/// tenth of the keys, or half of the activities.
pub fn needed(scene: &Scene) -> bool {
    let activities = scene.schedule.activities.len();
    if activities == 0 || scene.model.elements.is_empty() {
        return false;
    }
    let report = super::report(scene);
    let left = scene.rule_reports.iter().any(|r| r.keys_left * 10 > r.keys);
    left || report.linked_elements == 0 || report.linked_activities * 2 < activities
}

/// Tries guid, name, name in whatever case, name in order, storey, type and each property against each
/// of elements' entries, their columns, ids, names, summaries and fields of activities.
pub fn suggest(model: &Model, schedule: &Schedule) -> Suggestions {
    let wbs = WbsKeys::new(schedule, true);
    let sources = sources(schedule, &wbs);
    let candidates: Vec<Suggestion> =
        sides(model).par_iter().flat_map_iter(|side| screen(model, side, &sources)).collect();
    let activities = schedule.activities.len();
    let mut candidates = ranked(candidates, activities);
    candidates.truncate(FINALISTS);
    let measured = candidates.par_iter().filter_map(|c| measure(model, schedule, &wbs, &c.rule));
    let mut best = ranked(measured.filter(|s| s.matched > 0).collect(), activities);
    best.truncate(MOST_MADE);
    let usual = match schedule.activities.iter().any(|a| !a.elements.is_empty()) {
        true => [ElementBy::Guid, ElementBy::Name]
            .into_iter()
            .filter_map(|by| {
                let rule = Rule::new("usual", by, ActivityBy::Elements, Match::Exact);
                measure(model, schedule, &wbs, &rule)
            })
            .collect(),
        false => Vec::new(),
    };
    Suggestions { usual, best }
}

fn ranked(mut all: Vec<Suggestion>, activities: usize) -> Vec<Suggestion> {
    // Of equals the first tried, which is the plainest.
    all.sort_by(|a, b| b.score(activities).total_cmp(&a.score(activities)));
    all
}

/// One side of the schedule and some of its distinct texts.
struct Source<'a> {
    by: ActivityBy,
    texts: Vec<&'a str>,
    /// Most texts end with a number of the instance.
    numbered: bool,
}

fn sources<'a>(schedule: &'a Schedule, wbs: &'a WbsKeys) -> Vec<Source<'a>> {
    let mut all = vec![ActivityBy::Elements];
    all.extend(keys::element_field_names(schedule).into_iter().map(ActivityBy::ElementField));
    all.extend([ActivityBy::Id, ActivityBy::Name, ActivityBy::Wbs]);
    all.extend(keys::field_names(schedule).into_iter().map(ActivityBy::Field));
    let pattern = Pattern::new(NUMBERED).expect("a constant that tests compile");
    let source = |by: ActivityBy| {
        let mut distinct: HashSet<&str> = HashSet::new();
        let mut texts = Vec::new();
        // Every n-th, so that the sample comes from everywhere: n doubles whenever it is full.
        let (mut step, mut number) = (1usize, 0usize);
        keys::each_text_of_schedule(schedule, &by, wbs, &mut |text, _, _| {
            if text.is_empty() || !distinct.insert(text) {
                return;
            }
            if number.is_multiple_of(step) {
                if texts.len() == SAMPLE {
                    let mut even = false;
                    texts.retain(|_| {
                        even = !even;
                        even
                    });
                    step *= 2;
                }
                if number.is_multiple_of(step) {
                    texts.push(text);
                }
            }
            number += 1;
        });
        let numbered = texts.iter().filter(|t| pattern.find(t).is_some()).count();
        let numbered = numbered * 2 > texts.len();
        (!texts.is_empty()).then_some(Source { by, texts, numbered })
    };
    all.into_par_iter().filter_map(source).collect()
}

/// One side of the model, and how it is compared.
struct Side {
    by: ElementBy,
    case: bool,
}

fn sides(model: &Model) -> Vec<Side> {
    let mut sides = vec![
        Side { by: ElementBy::Guid, case: true },
        Side { by: ElementBy::Name, case: true },
        Side { by: ElementBy::Name, case: false },
        Side { by: ElementBy::Storey, case: false },
        Side { by: ElementBy::Type, case: false },
    ];
    let keys = model.properties.keys().take(MOST_TRIED);
    sides.extend(keys.map(|k| Side { by: ElementBy::Property(k.to_owned()), case: true }));
    sides
}

/// Tries one side of the model against samples of all sides of the schedule.
fn screen(model: &Model, side: &Side, sources: &[Source<'_>]) -> Vec<Suggestion> {
    let rule = |activity: &ActivityBy, matching| {
        let mut rule = Rule::new("suggested", side.by.clone(), activity.clone(), matching);
        rule.case = side.case;
        rule
    };
    let numbered = Pattern::new(NUMBERED).expect("a constant that tests compile");
    let probe = rule(&ActivityBy::Id, Match::Exact);
    let theirs: Keys<'_, Target> = keys::of_model(model, &probe);
    let (starts, _) = theirs.by_key();
    let mut found = Vec::new();
    for source in sources {
        let by_name = side.by == ElementBy::Name && side.case;
        let of_elements = matches!(source.by, ActivityBy::Elements | ActivityBy::ElementField(_));
        let mut ways = vec![rule(&source.by, Match::Exact)];
        if by_name && of_elements {
            ways.push(rule(&source.by, Match::InOrder));
        }
        if by_name && source.numbered {
            let mut way = rule(&source.by, Match::InOrder);
            way.activity.pattern = Some(numbered.clone());
            ways.push(way);
        }
        for rule in ways {
            let pattern = rule.activity.pattern.as_ref();
            let (mut matched, mut elements) = (0, 0);
            for text in &source.texts {
                let Some(text) = pattern.map_or(Some(*text), |p| p.find(text).map(|f| f.0)) else {
                    continue;
                };
                let key = match side.case {
                    true => theirs.index.get(text),
                    false => theirs.index.get(text.to_lowercase().as_str()),
                };
                if let Some(&key) = key {
                    matched += 1;
                    let users = starts[key as usize + 1] - starts[key as usize];
                    elements += if rule.matching == Match::InOrder { 1 } else { users as usize };
                }
            }
            if matched > 0 {
                let keys = source.texts.len();
                found.push(Suggestion { rule, keys, matched, elements, activities: matched });
            }
        }
    }
    found
}

/// What a rule matches in full.
fn measure(model: &Model, schedule: &Schedule, wbs: &WbsKeys, rule: &Rule) -> Option<Suggestion> {
    let theirs = keys::of_model(model, rule);
    let ours: Keys<'_, Entry> = keys::of_schedule(schedule, rule, wbs)?;
    let matches = matching::matches(rule.matching, rule.case, &ours, &theirs);
    let (starts, order) = theirs.by_key();
    let mut elements = vec![false; model.elements.len()];
    let mut activities = vec![false; schedule.activities.len()];
    let (mut things, mut met_things) = (HashSet::new(), HashSet::new());
    let met =
        (rule.matching == Match::InOrder).then(|| matching::in_order(&matches, &ours, &theirs));
    let groups = super::apply::Groups::new(model);
    let mut mark = |use_: u32| match theirs.uses[use_ as usize].2 {
        Target::Element(e) => elements[e as usize] = true,
        Target::Group(g) => groups.below(g).iter().for_each(|&e| elements[e as usize] = true),
    };
    for (u, (key, _, entry)) in ours.uses.iter().enumerate() {
        let hit = match &met {
            Some(met) => {
                met[u].into_iter().for_each(&mut mark);
                things.insert(entry.identity);
                met[u].is_some()
            }
            None => {
                let first = things.insert(*key);
                let hits = matches.of(*key);
                for &k in hits.iter().filter(|_| first) {
                    let range = starts[k as usize] as usize..starts[k as usize + 1] as usize;
                    order[range].iter().copied().for_each(&mut mark);
                }
                !hits.is_empty()
            }
        };
        if hit {
            met_things.insert(if met.is_some() { entry.identity } else { *key });
            activities[entry.activity as usize] = true;
        }
    }
    let count = |flags: &[bool]| flags.iter().filter(|&&f| f).count();
    let name = format!("{} by {}", rule.element.by, rule.activity.by);
    Some(Suggestion {
        rule: Rule { name, ..rule.clone() },
        keys: things.len(),
        matched: met_things.len(),
        elements: count(&elements),
        activities: count(&activities),
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::Element;
    use crate::link::{Rules, link_by};
    use topout_schedule::{Activity, Diagnostics};

    fn schedule(activities: Vec<Activity>) -> Schedule {
        Schedule::new(String::new(), None, activities, Diagnostics::default())
    }

    fn model(count: usize) -> Model {
        let mut builder = crate::properties::Builder::default();
        for i in 0..count {
            builder.say("Mark", &format!("M{i}"));
            builder.end_element();
        }
        let element = |i: usize| Element {
            name: format!("n{i}"),
            label: ["wall", "Door"][i % 2].to_owned(),
            guid: Some(format!("g{i}")),
            storey: format!("L{}", i % 3),
            ..Element::default()
        };
        let elements = (0..count).map(element).collect();
        Model { elements, properties: builder.finish().0, ..Model::default() }
    }

    /// The best suggestion, which linking by it confirms.
    fn best(activities: Vec<Activity>) -> Suggestion {
        let (model, schedule) = (model(30), schedule(activities));
        let found = suggest(&model, &schedule);
        let best = found.best[0].clone();
        let rules = Rules { rules: vec![best.rule.clone()], ..Rules::default() };
        let scene = link_by(rules, model, schedule);
        let report = crate::link::report(&scene);
        assert_eq!(
            (report.linked_elements, report.linked_activities),
            (best.elements, best.activities)
        );
        best
    }

    #[test]
    fn the_field_and_the_property_that_belong_together_are_found() {
        let activity = |i: usize| Activity {
            id: format!("A{i}"),
            name: "Install".into(),
            fields: vec![
                ("Level".into(), format!("l{}", i % 3).into()),
                ("Tag".into(), format!("M{}", i + 2).into()),
            ],
            ..Activity::default()
        };
        let best = best((0..29).map(activity).collect());
        assert_eq!(best.rule.element.by, ElementBy::Property("Mark".into()));
        assert_eq!(best.rule.activity.by, ActivityBy::Field("Tag".into()));
        assert_eq!((best.keys, best.matched, best.elements), (29, 28, 28));
        let said =
            "28 of 29 keys (field \"Tag\") match by property \"Mark\": 28 elements, 28 activities";
        assert_eq!(best.to_string(), said);
    }

    #[test]
    fn names_with_numbers_are_matched_in_order() {
        let activity = |i: usize| Activity {
            id: format!("A{i}"),
            elements: (0..2).map(|k| format!("{}_(#{})", ["wall", "Door"][k], i * 7)).collect(),
            ..Activity::default()
        };
        let activities: Vec<Activity> = (0..16).map(activity).collect();
        let best = best(activities.clone());
        assert_eq!(best.rule.matching, Match::InOrder);
        assert_eq!((best.keys, best.matched, best.elements), (32, 30, 30));
        let said = suggest(&model(30), &schedule(activities)).to_string();
        assert!(said.starts_with("0 of 32 keys match by guid, 0 by name; 30 of 32 keys"), "{said}");
        assert!(said.contains("match by name and order"), "{said}");
    }

    #[test]
    fn guids_need_no_other_rule_and_nothing_gives_nothing() {
        let activity = |i: usize| Activity {
            id: format!("A{i}"),
            elements: vec![format!("g{i}")],
            ..Activity::default()
        };
        let best = best((0..30).map(activity).collect());
        assert_eq!((best.way().as_str(), best.matched), ("guid", 30));
        let none = suggest(&model(3), &schedule(vec![activity(77)]));
        assert!(none.best.is_empty());
        assert_eq!(none.to_string(), "0 of 1 keys match by guid, 0 by name");
        assert_eq!(suggest(&Model::default(), &Schedule::default()), Suggestions::default());
        let empty = Suggestions::default().to_string();
        assert_eq!(empty, "no key of the schedule matches the model");
    }

    #[test]
    fn what_is_linked_well_needs_no_suggestion() {
        let of = |name: &str| Activity {
            id: "A".into(),
            elements: vec![name.to_owned()],
            ..Activity::default()
        };
        let scene = |name| crate::link::link(model(3), schedule(vec![of(name)]));
        assert!(!needed(&scene("n1")) && needed(&scene("x")));
        assert!(!needed(&crate::link::link(model(3), Schedule::default())));
    }
}
