//! Which rows of the outline are listed: what is folded, searched for and filtered by.

use super::super::calendar::DAY;
use super::super::loading::Project;
use super::plan::{Plan, What};
use std::collections::BTreeSet;
use std::sync::Arc;
use topout_schedule::{ActivityKind, Schedule, Time};

/// Which activities are listed: those that pass all of it.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Filter {
    /// Part of id or name, or of the name of a summary above, in whatever case.
    pub text: String,
    /// At work at the shown date.
    pub active_now: bool,
    /// Starting within so many weeks after the shown date.
    pub starting_weeks: Option<u32>,
    /// Late by their plan.
    pub late: bool,
    /// Without room to move before the project ends later.
    pub critical: bool,
    /// Linked to no element.
    pub unlinked: bool,
    /// Of one kind.
    pub kind: Option<ActivityKind>,
    /// Below one summary.
    pub below: Option<u32>,
}

impl Filter {
    /// Whether it lets everything pass.
    pub fn is_empty(&self) -> bool {
        *self == Self { text: self.text.clone(), ..Self::default() } && self.text.trim().is_empty()
    }

    fn asks_for_date(&self) -> bool {
        self.active_now || self.starting_weeks.is_some()
    }

    fn passes(&self, plan: &Plan, schedule: &Schedule, activity: usize, time: Time) -> bool {
        let within = |from: Time, to: Time| from <= time && time < to;
        let span = plan.span(activity);
        (!self.active_now || span.is_some_and(|s| within(s.start, s.end)))
            && self.starting_weeks.is_none_or(|weeks| {
                let until = time.plus_seconds(i64::from(weeks) * 7 * DAY);
                span.is_some_and(|s| time < s.start && s.start <= until)
            })
            && (!self.late || plan.is_late(activity))
            && (!self.critical || plan.is_critical(activity))
            && (!self.unlinked || plan.elements_of(activity).is_empty())
            && self.kind.is_none_or(|kind| schedule.activities[activity].kind == kind)
    }
}

/// The Gantt chart's rows.
#[derive(Default)]
pub struct Gantt {
    /// What is listed.
    pub filter: Filter,
    folded: BTreeSet<u32>,
    /// Counts folding.
    changes: u64,
    /// Places in [`Plan::rows`].
    rows: Vec<u32>,
    /// Activities among them or folded away that pass.
    passing: usize,
    /// What `rows` are for.
    of: Option<(Arc<Project>, Filter, u64, Option<Time>)>,
    /// The activity that has to be in sight, and the how manieth wish that is.
    reveal: (u64, Option<usize>),
}

impl Gantt {
    /// For another project: nothing is folded, but the outline of a large plan below its second level.
    pub fn of(project: &Project) -> Self {
        const LARGE: usize = 2_000;
        let mut gantt = Self::default();
        if project.plan.rows().len() > LARGE {
            let deep = project.plan.rows().iter().filter(|row| row.depth >= 1);
            gantt.folded = deep.filter_map(|row| summary(row.what)).collect();
        }
        gantt
    }

    /// The listed rows: places in [`Plan::rows`].
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Activities that pass the filter, folded away or not.
    pub fn passing(&self) -> usize {
        self.passing
    }

    /// Whether what is below a summary is folded away.
    pub fn is_folded(&self, summary: u32) -> bool {
        self.folded.contains(&summary)
    }

    /// Folds or unfolds a summary.
    pub fn fold(&mut self, summary: u32, folded: bool) {
        self.changes += 1;
        match folded {
            true => self.folded.insert(summary),
            false => self.folded.remove(&summary),
        };
    }

    /// Folds or unfolds all summaries.
    pub fn fold_all(&mut self, plan: &Plan, folded: bool) {
        self.changes += 1;
        self.folded.clear();
        if folded {
            self.folded.extend(plan.rows().iter().filter_map(|row| summary(row.what)));
        }
    }

    /// Brings an activity into sight.
    pub fn reveal(&mut self, plan: &Plan, schedule: &Schedule, activity: usize) {
        self.reveal = (self.reveal.0 + 1, Some(activity));
        let mut above = schedule.activities.get(activity).and_then(|a| a.wbs);
        while let Some(summary) = above {
            if self.folded.remove(&summary) {
                self.changes += 1;
            }
            above = schedule.wbs.get(summary as usize).and_then(|node| node.parent);
        }
        debug_assert!(plan.row_of(activity).is_some());
    }

    /// The listed row to scroll to, and the number of that wish: it is to be fulfilled once.
    pub fn wish(&self, plan: &Plan) -> (u64, Option<usize>) {
        let (number, activity) = self.reveal;
        let row = activity.and_then(|a| plan.row_of(a));
        (number, row.and_then(|row| self.rows.binary_search(&(row as u32)).ok()))
    }

    /// Works the rows out anew where something that they follow from has changed; O(n) then.
    pub fn refresh(&mut self, project: &Arc<Project>, time: Time) {
        let date = self.filter.asks_for_date().then_some(time);
        let same = self.of.as_ref().is_some_and(|(known, filter, changes, at)| {
            Arc::ptr_eq(known, project)
                && *filter == self.filter
                && *changes == self.changes
                && *at == date
        });
        if !same {
            self.of = Some((Arc::clone(project), self.filter.clone(), self.changes, date));
            let (plan, schedule) = (&project.plan, &project.scene.schedule);
            (self.rows, self.passing) = listed(plan, schedule, &self.filter, &self.folded, time);
        }
    }
}

fn summary(what: What) -> Option<u32> {
    match what {
        What::Summary(summary) => Some(summary),
        What::Activity(_) => None,
    }
}

/// Rows that pass and are not folded away, and how many activities pass.
fn listed(
    plan: &Plan,
    schedule: &Schedule,
    filter: &Filter,
    folded: &BTreeSet<u32>,
    time: Time,
) -> (Vec<u32>, usize) {
    let rows = plan.rows();
    let everything = filter.is_empty();
    let wanted = filter.text.trim().to_lowercase();
    // How many activities pass before each row.
    let mut before = Vec::with_capacity(rows.len() + 1);
    let (mut passing, mut named_until, mut below_until) = (0usize, 0u32, 0u32);
    for (place, row) in (0u32..).zip(rows) {
        before.push(passing);
        match row.what {
            What::Summary(summary) => {
                let node = &schedule.wbs[summary as usize];
                if !wanted.is_empty()
                    && (node.name.to_lowercase().contains(&wanted)
                        || node.code.to_lowercase().contains(&wanted))
                {
                    named_until = named_until.max(row.end);
                }
                if filter.below == Some(summary) {
                    below_until = row.end;
                }
            }
            What::Activity(activity) => {
                let activity = activity as usize;
                let named = wanted.is_empty()
                    || place < named_until
                    || plan.words(activity).contains(&wanted);
                let below = filter.below.is_none() || place < below_until;
                let passes = named && below && filter.passes(plan, schedule, activity, time);
                passing += usize::from(everything || passes);
            }
        }
    }
    before.push(passing);
    let passes = |from: usize, to: usize| before[to] > before[from];
    let mut listed = Vec::new();
    let mut place = 0;
    while let Some(row) = rows.get(place) {
        let end = row.end as usize;
        match row.what {
            // Summaries without activities are part of the outline, but nothing passes for them.
            _ if !everything && !passes(place, end) => place = end,
            What::Summary(summary) if folded.contains(&summary) => {
                listed.push(place as u32);
                place = end;
            }
            _ => {
                listed.push(place as u32);
                place += 1;
            }
        }
    }
    (listed, passing)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;
    use topout_scene::{Element, Model, Scene, link};
    use topout_schedule::{Activity, WbsNode};

    /// A random outline with a dozen activities, every second of them linked.
    fn scene() -> impl Strategy<Value = Scene> {
        let nodes = prop::collection::vec(any::<prop::sample::Index>(), 0..6);
        let activities = prop::collection::vec((0usize..8, 0i64..50, 0i64..20, 0usize..3), 0..14);
        (nodes, activities).prop_map(|(nodes, activities)| {
            let node = |(i, above): (usize, &prop::sample::Index)| WbsNode {
                code: format!("{i}"),
                name: format!("part {i}"),
                parent: (i > 0 && above.index(3) > 0).then(|| above.index(i) as u32),
            };
            let wbs: Vec<WbsNode> = nodes.iter().enumerate().map(node).collect();
            let activity =
                |(i, &(wbs_of, start, length, kind)): (usize, &(usize, i64, i64, usize))| {
                    let time = |day: i64| Some(Time::from_seconds(day * DAY));
                    Activity {
                        id: format!("A{i}"),
                        name: format!("pour {}", i % 3),
                        wbs: (wbs_of < wbs.len()).then_some(wbs_of as u32),
                        start: time(start),
                        end: time(start + length),
                        kind: ActivityKind::WORDS[kind].1,
                        elements: if i % 2 == 0 { vec!["e".to_owned()] } else { Vec::new() },
                        ..Activity::default()
                    }
                };
            let activities = activities.iter().enumerate().map(activity).collect();
            let schedule = Schedule { activities, wbs, ..Schedule::default() }.revalidated();
            let element = Element { name: "e".to_owned(), ..Element::default() };
            let model = Model { elements: vec![element], ..Model::default() };
            link::link(model, schedule)
        })
    }

    fn filter() -> impl Strategy<Value = Filter> {
        let text = prop_oneof![Just(""), Just("POUR 1"), Just("a1"), Just("part 0"), Just("zzz")];
        let weeks = prop::option::of(0u32..4);
        let below = prop::option::of(0u32..6);
        (text, any::<bool>(), weeks, any::<bool>(), prop::option::of(0usize..3), below).prop_map(
            |(text, active_now, starting_weeks, unlinked, kind, below)| Filter {
                text: text.to_owned(),
                active_now,
                starting_weeks,
                late: false,
                critical: false,
                unlinked,
                kind: kind.map(|k| ActivityKind::WORDS[k].1),
                below,
            },
        )
    }

    /// All summaries above an activity.
    fn above(schedule: &Schedule, activity: usize) -> Vec<u32> {
        let mut above = schedule.activities[activity].wbs;
        let mut all = Vec::new();
        while let Some(node) = above {
            all.push(node);
            above = schedule.wbs[node as usize].parent;
        }
        all
    }

    proptest! {
        /// Against a look at each activity by itself.
        #[test]
        fn rows_are_those_that_pass_and_what_is_above_them(
            scene in scene(), filter in filter(), day in 0i64..60,
            folded in prop::collection::btree_set(0u32..6, 0..4),
        ) {
            let (schedule, plan) = (&scene.schedule, Plan::new(&scene));
            let time = Time::from_seconds(day * DAY);
            let wanted = filter.text.to_lowercase();
            let passes = |i: usize| {
                let a = &schedule.activities[i];
                let (start, end) = (a.start.unwrap(), a.end.unwrap());
                let up = above(schedule, i);
                let said = |text: &str| text.to_lowercase().contains(&wanted);
                (said(&a.id) || said(&a.name) || up.iter().any(|n| {
                    said(&schedule.wbs[*n as usize].name) || said(&schedule.wbs[*n as usize].code)
                }))
                    && (!filter.active_now || (start <= time && time < end))
                    && filter.starting_weeks.is_none_or(|w| {
                        time < start && start.seconds() <= time.seconds() + i64::from(w) * 7 * DAY
                    })
                    && (!filter.unlinked || a.elements.is_empty())
                    && filter.kind.is_none_or(|k| a.kind == k)
                    && filter.below.is_none_or(|n| up.contains(&n))
            };
            let (rows, passing) = listed(&plan, schedule, &filter, &folded, time);
            let all = 0..schedule.activities.len();
            prop_assert_eq!(passing, all.clone().filter(|&i| passes(i)).count());
            let hidden = |up: &[u32]| up.iter().any(|n| folded.contains(n));
            let mut expected: Vec<u32> = Vec::new();
            for (place, row) in (0u32..).zip(plan.rows()) {
                let listed = match row.what {
                    What::Activity(i) => passes(i as usize) && !hidden(&above(schedule, i as usize)),
                    What::Summary(n) => {
                        let below = |i: &usize| above(schedule, *i).contains(&n);
                        let mut up = Vec::new();
                        let mut next = schedule.wbs[n as usize].parent;
                        while let Some(node) = next {
                            up.push(node);
                            next = schedule.wbs[node as usize].parent;
                        }
                        let any = filter.is_empty() || all.clone().filter(below).any(passes);
                        any && !hidden(&up)
                    }
                };
                if listed {
                    expected.push(place);
                }
            }
            prop_assert_eq!(rows, expected);
        }
    }
}
