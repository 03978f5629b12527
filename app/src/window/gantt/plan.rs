//! A schedule as rows: summaries and activities in the order of the outline, made once a schedule.

use std::sync::Arc;
use topout_scene::{ElementId, Scene};
use topout_schedule::{Activity, ActivityKind, DateSet, Network, Schedule, Time, TimeRange};

/// What a row stands for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum What {
    /// A summary, by its place in [`Schedule::wbs`].
    Summary(u32),
    /// An activity, by its place in [`Schedule::activities`].
    Activity(u32),
}

/// A row of the outline.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Row {
    /// Summary or activity.
    pub what: What,
    /// Summaries above it.
    pub depth: u16,
    /// The row after the last one below it, or after itself.
    pub end: u32,
}

/// Figures of a summary.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Sum {
    /// From the first start to the last finish below it.
    pub span: Option<TimeRange>,
    /// Activities below it.
    pub activities: u32,
    /// Seconds that they take together, and those of them that are done, as far as that is known.
    work: (f64, f64),
}

impl Sum {
    /// What is done, from 0 to 1; activities of no length count nothing.
    pub fn done(&self) -> Option<f32> {
        let (work, done) = self.work;
        (work > 0.0 && done > 0.0).then_some((done / work) as f32)
    }

    fn add(&mut self, other: &Sum) {
        self.span = match (self.span, other.span) {
            (Some(a), Some(b)) => {
                Some(TimeRange { start: a.start.min(b.start), end: a.end.max(b.end) })
            }
            (a, b) => a.or(b),
        };
        self.activities += other.activities;
        self.work = (self.work.0 + other.work.0, self.work.1 + other.work.1);
    }
}

/// The outline of a schedule, and what is asked of its activities row by row: in tables of their own, since
/// activities themselves are too large to look through a hundred thousand of them in a frame.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    rows: Vec<Row>,
    row_of: Vec<u32>,
    sums: Vec<Sum>,
    spans: Vec<Option<TimeRange>>,
    late: Vec<bool>,
    /// Seconds that an activity can move before the project ends later.
    slack: Vec<Option<i64>>,
    /// Lower-case id and name.
    words: Arc<[Box<str>]>,
    kinds: Vec<ActivityKind>,
    /// Elements by activity: places in `elements`.
    starts: Vec<u32>,
    elements: Vec<ElementId>,
}

impl Plan {
    /// Lays the rows out; O(n).
    pub fn new(scene: &Scene) -> Self {
        let schedule = &scene.schedule;
        let (starts, elements) = elements_of(scene);
        let rows = outline(schedule);
        let mut row_of = vec![0; schedule.activities.len()];
        for (place, row) in (0u32..).zip(&rows) {
            if let What::Activity(activity) = row.what {
                row_of[activity as usize] = place;
            }
        }
        Self {
            row_of,
            sums: sums(schedule),
            spans: schedule.activities.iter().map(Activity::dates).collect(),
            late: schedule.activities.iter().map(|a| is_late(a, schedule.data_date)).collect(),
            words: schedule
                .activities
                .iter()
                .map(|a| format!("{}\n{}", a.id, a.name).to_lowercase().into())
                .collect(),
            kinds: kinds(schedule),
            slack: Network::new(schedule).critical(schedule),
            rows,
            starts,
            elements,
        }
    }

    /// Seconds of working time that an activity can move before the project ends later; `None` where
    /// that is not known.
    pub fn slack(&self, activity: usize) -> Option<i64> {
        self.slack.get(activity).copied().flatten()
    }

    /// Whether the project ends later as soon as an activity does. In a schedule without links nothing is
    /// said to be so.
    pub fn is_critical(&self, activity: usize) -> bool {
        self.slack(activity).is_some_and(|slack| slack <= 0)
    }

    /// The kinds of activities that occur.
    pub fn kinds(&self) -> &[ActivityKind] {
        &self.kinds
    }

    /// All rows.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The row of an activity.
    pub fn row_of(&self, activity: usize) -> Option<usize> {
        self.row_of.get(activity).map(|row| *row as usize)
    }

    /// The activities below a summary.
    pub fn below(&self, summary: u32) -> impl Iterator<Item = usize> + '_ {
        let place = self.rows.iter().position(|row| row.what == What::Summary(summary));
        let rows = place.map_or(0..0, |place| place..self.rows[place].end as usize);
        self.rows[rows].iter().filter_map(|row| match row.what {
            What::Activity(activity) => Some(activity as usize),
            What::Summary(_) => None,
        })
    }

    /// Figures of a summary.
    pub fn sum(&self, summary: u32) -> Sum {
        self.sums.get(summary as usize).copied().unwrap_or_default()
    }

    /// When an activity lasts.
    pub fn span(&self, activity: usize) -> Option<TimeRange> {
        self.spans.get(activity).copied().flatten()
    }

    /// Whether an activity ends later than it was to, or should have ended by the data date.
    pub fn is_late(&self, activity: usize) -> bool {
        self.late.get(activity).copied().unwrap_or(false)
    }

    /// Lower-case id and name of an activity.
    pub fn words(&self, activity: usize) -> &str {
        self.words.get(activity).map_or("", |words| words)
    }

    /// The elements that an activity is linked to.
    pub fn elements_of(&self, activity: usize) -> &[ElementId] {
        let range = self.starts.get(activity).zip(self.starts.get(activity + 1));
        range.map_or(&[], |(from, to)| &self.elements[*from as usize..*to as usize])
    }
}

/// The links of the scene by activity.
fn elements_of(scene: &Scene) -> (Vec<u32>, Vec<ElementId>) {
    let all = || (0..scene.model.elements.len() as u32).map(ElementId);
    let mut starts = vec![0u32; scene.schedule.activities.len() + 1];
    for element in all() {
        for &activity in scene.activities_of(element) {
            starts[activity as usize + 1] += 1;
        }
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut elements = vec![ElementId(0); starts.last().copied().unwrap_or(0) as usize];
    for element in all() {
        for &activity in scene.activities_of(element) {
            let place = &mut next[activity as usize];
            elements[*place as usize] = element;
            *place += 1;
        }
    }
    (starts, elements)
}

fn kinds(schedule: &Schedule) -> Vec<ActivityKind> {
    let mut kinds: Vec<ActivityKind> = Vec::new();
    for activity in &schedule.activities {
        if !kinds.contains(&activity.kind) {
            kinds.push(activity.kind);
        }
    }
    kinds.sort_unstable_by_key(|kind| kind.index());
    kinds
}

/// Activities stand before the summaries beside them, in the order of the file.
fn outline(schedule: &Schedule) -> Vec<Row> {
    let nodes = schedule.wbs.len();
    // The last place is for what has nothing above it.
    let mut summaries = vec![Vec::new(); nodes + 1];
    let mut activities = vec![Vec::new(); nodes + 1];
    let place = |above: Option<u32>| above.map_or(nodes, |a| (a as usize).min(nodes));
    for (i, node) in (0u32..).zip(&schedule.wbs) {
        summaries[place(node.parent)].push(i);
    }
    for (i, activity) in (0u32..).zip(&schedule.activities) {
        activities[place(activity.wbs)].push(i);
    }
    let mut rows: Vec<Row> = Vec::with_capacity(nodes + schedule.activities.len());
    // Summaries to go through, the next one last; a row whose end is known once all above it on the
    // stack are done.
    enum Todo {
        Below(usize, u16),
        Enter(u32, u16),
        Close(usize),
    }
    let mut stack = vec![Todo::Below(nodes, 0)];
    while let Some(todo) = stack.pop() {
        match todo {
            Todo::Below(above, depth) => {
                for &activity in &activities[above] {
                    let end = rows.len() as u32 + 1;
                    rows.push(Row { what: What::Activity(activity), depth, end });
                }
                let below = summaries[above].iter().rev();
                stack.extend(below.map(|&summary| Todo::Enter(summary, depth)));
            }
            Todo::Enter(summary, depth) => {
                stack.push(Todo::Close(rows.len()));
                rows.push(Row { what: What::Summary(summary), depth, end: 0 });
                stack.push(Todo::Below(summary as usize, depth.saturating_add(1)));
            }
            Todo::Close(row) => rows[row].end = rows.len() as u32,
        }
    }
    rows
}

fn sums(schedule: &Schedule) -> Vec<Sum> {
    let mut sums = vec![Sum::default(); schedule.wbs.len()];
    for activity in &schedule.activities {
        let Some(sum) = activity.wbs.and_then(|wbs| sums.get_mut(wbs as usize)) else { continue };
        let span = activity.dates();
        let work = span.map_or(0.0, |span| span.seconds() as f64);
        let done = f64::from(activity.percent_complete.unwrap_or(0.0)) / 100.0;
        sum.add(&Sum { span, activities: 1, work: (work, work * done) });
    }
    // Parents stand before their children.
    for i in (0..sums.len()).rev() {
        if let Some(parent) = schedule.wbs[i].parent {
            let own = sums[i];
            sums[parent as usize].add(&own);
        }
    }
    sums
}

/// Ends after its baseline, or else after its plan; or was to have ended by the data date and is not done.
fn is_late(activity: &Activity, data_date: Option<Time>) -> bool {
    if !activity.active {
        return false;
    }
    let sets = &activity.date_sets;
    let wanted = sets[DateSet::Baseline].end.or(sets[DateSet::Planned].end);
    let (Some(wanted), Some(end)) = (wanted, activity.end) else { return false };
    let done = sets[DateSet::Actual].end.is_some()
        || activity.percent_complete.is_some_and(|percent| percent >= 100.0);
    end > wanted || (!done && data_date.is_some_and(|now| wanted < now))
}

#[cfg(test)]
mod tests {
    use super::*;
    use topout_scene::{Element, Model, link};
    use topout_schedule::WbsNode;

    fn schedule() -> Schedule {
        let node =
            |name: &str, parent| WbsNode { name: name.to_owned(), parent, ..WbsNode::default() };
        let activity = |(id, wbs, from, to): (&str, Option<u32>, i64, i64)| Activity {
            id: id.to_owned(),
            name: format!("Work {id}"),
            wbs,
            start: Some(Time::from_seconds(from)),
            end: Some(Time::from_seconds(to)),
            percent_complete: Some(50.0),
            elements: vec![format!("e{id}"), "shared".to_owned()],
            ..Activity::default()
        };
        let activities = [
            ("a", Some(1), 10, 20),
            ("b", None, 5, 6),
            ("c", Some(2), 30, 40),
            ("d", Some(1), 12, 30),
        ];
        let above = |name| node(name, Some(0));
        let wbs = vec![node("all", None), above("first"), above("second"), node("empty", None)];
        let activities = activities.map(activity).to_vec();
        Schedule { activities, wbs, ..Schedule::default() }.revalidated()
    }

    #[test]
    fn rows_follow_the_outline_and_know_where_they_end() {
        let elements = ["ea", "eb", "shared"]
            .map(|name| Element { name: name.to_owned(), ..Element::default() });
        let model = Model { elements: elements.to_vec(), ..Model::default() };
        let plan = Plan::new(&link::link(model, schedule()));
        let rows: Vec<_> = plan.rows().iter().map(|r| (r.what, r.depth, r.end)).collect();
        use What::{Activity as A, Summary as S};
        assert_eq!(
            rows,
            [
                (A(1), 0, 1),
                (S(0), 0, 7),
                (S(1), 1, 5),
                (A(0), 2, 4),
                (A(3), 2, 5),
                (S(2), 1, 7),
                (A(2), 2, 7),
                (S(3), 0, 8),
            ]
        );
        assert_eq!((plan.row_of(3), plan.row_of(9)), (Some(4), None));
        let all = plan.sum(0);
        let span = all.span.map(|s| (s.start.seconds(), s.end.seconds()));
        assert_eq!((all.activities, span), (3, Some((10, 40))));
        assert_eq!(all.done(), Some(0.5));
        assert_eq!((plan.sum(3).span, plan.sum(3).done()), (None, None));
        assert_eq!(plan.elements_of(0), [ElementId(0), ElementId(2)]);
        assert_eq!(plan.elements_of(1), [ElementId(1), ElementId(2)]);
        assert!(plan.elements_of(7).is_empty());
        assert_eq!(plan.words(3), "d\nwork d");
    }

    #[test]
    fn late_is_what_ends_after_its_plan_or_is_not_done_in_time() {
        let t = |day: i64| Some(Time::from_seconds(day * 86_400));
        let mut activity = Activity { end: t(10), ..Activity::default() };
        assert!(!is_late(&activity, t(99)), "nothing was wanted");
        activity.date_sets[DateSet::Planned].end = t(10);
        assert!(!is_late(&activity, t(9)));
        assert!(is_late(&activity, t(11)));
        activity.percent_complete = Some(100.0);
        assert!(!is_late(&activity, t(11)));
        activity.date_sets[DateSet::Baseline].end = t(8);
        assert!(is_late(&activity, None));
    }
}
