//! What moves when a planner moves something: dates along the links between activities.

use crate::workclock::{LIMIT, WorkClock};
use crate::{Activity, DateSet, Lag, LinkKind, Schedule, Time, TimeRange};

/// What becomes of the successors of something that is moved earlier.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Pull {
    /// They stay.
    #[default]
    Keep,
    /// Those that touched it, with no working time between, follow as far back as all their links
    /// allow.
    Back,
}

/// A link that waits for itself, directly or round a cycle; it moves nothing.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct CyclicLink {
    /// The activity that has the link: index in [`Schedule::activities`].
    pub activity: usize,
    /// Which of its links: index in [`Activity::predecessors`].
    pub link: usize,
}

/// One link, seen from either end.
#[derive(Clone, Copy, Debug)]
struct Edge {
    other: u32,
    kind: LinkKind,
    lag: Lag,
}

/// Rows of edges behind each other.
#[derive(Clone, Debug, Default)]
struct Rows {
    /// Where the row of an activity begins; one more than there are activities.
    starts: Vec<u32>,
    edges: Vec<Edge>,
}

impl Rows {
    fn of(&self, activity: usize) -> &[Edge] {
        &self.edges[self.starts[activity] as usize..self.starts[activity + 1] as usize]
    }

    /// The same links from their other ends.
    fn turned(&self) -> Rows {
        let count = self.starts.len() - 1;
        let mut starts = vec![0u32; count + 1];
        for edge in &self.edges {
            starts[edge.other as usize + 1] += 1;
        }
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let nothing = Edge { other: 0, kind: LinkKind::FinishStart, lag: Lag::default() };
        let mut edges = vec![nothing; self.edges.len()];
        for i in 0..count {
            for &edge in self.of(i) {
                let at = &mut next[edge.other as usize];
                edges[*at as usize] = Edge { other: i as u32, ..edge };
                *at += 1;
            }
        }
        Rows { starts, edges }
    }
}

/// Start and end in seconds.
type Dates = (i64, i64);

/// The links between the activities of a schedule, made once and asked often.
///
/// It knows the links and calendars of the schedule that it was made of, not its dates: those may
/// change in between. It takes about 50 bytes a link and 20 an activity.
///
/// # What a link asks
///
/// A link sets the earliest start (FS, SS) or the earliest end (FF, SF) of its successor: the start
/// (SS, SF) or the end (FS, FF) of its predecessor, later by the lag, earlier by a negative one. Lags
/// and durations are working time of the successor's own calendar, else of the schedule's; they are
/// time of the clock if the lag is elapsed or there is no calendar that works on any weekday. A lag
/// of nothing is nothing. Work begins at an instant that is worked, and an end that would have to lie
/// in time off lies at the end of the work before it. Activities without working time between their
/// dates (milestones, work over a weekend) keep their length by the clock and may lie anywhere.
///
/// Links from or to activities that are inactive or have no dates ask nothing; nor do those in
/// cycles, see [`Network::cyclic_links`]. Summaries are no activities and have no links here.
#[derive(Clone, Debug)]
pub struct Network {
    predecessors: Rows,
    successors: Rows,
    /// The clock of each activity, or `u32::MAX`.
    clock: Vec<u32>,
    clocks: Vec<WorkClock>,
    /// Activities, each after all its predecessors.
    order: Vec<u32>,
    /// Where in the order an activity stands.
    rank: Vec<u32>,
    cyclic: Vec<CyclicLink>,
}

impl Network {
    /// Takes the links and calendars of a schedule: O(activities + links).
    pub fn new(schedule: &Schedule) -> Network {
        let count = schedule.activities.len();
        let links = |i: usize| &schedule.activities[i].predecessors[..];
        let (group, order) = groups(count, &links);
        let mut predecessors = Rows { starts: Vec::with_capacity(count + 1), edges: Vec::new() };
        let mut cyclic = Vec::new();
        predecessors.starts.push(0);
        for (i, group_of) in group.iter().enumerate() {
            for (number, link) in links(i).iter().enumerate() {
                match group.get(link.activity as usize) {
                    Some(other) if other == group_of => {
                        cyclic.push(CyclicLink { activity: i, link: number });
                    }
                    Some(_) => predecessors.edges.push(Edge {
                        other: link.activity,
                        kind: link.kind,
                        lag: link.lag,
                    }),
                    None => {}
                }
            }
            predecessors.starts.push(predecessors.edges.len() as u32);
        }
        let mut clocks = Vec::new();
        let numbers: Vec<u32> = (schedule.calendars.iter())
            .map(|calendar| {
                let Some(clock) = WorkClock::new(calendar) else { return u32::MAX };
                clocks.push(clock);
                clocks.len() as u32 - 1
            })
            .collect();
        let clock = |activity: &Activity| {
            let calendar = activity.calendar.or(schedule.calendar);
            calendar.and_then(|c| numbers.get(c as usize).copied()).unwrap_or(u32::MAX)
        };
        let mut rank = vec![0; count];
        for (i, &activity) in order.iter().enumerate() {
            rank[activity as usize] = i as u32;
        }
        Network {
            successors: predecessors.turned(),
            predecessors,
            clock: schedule.activities.iter().map(clock).collect(),
            clocks,
            order,
            rank,
            cyclic,
        }
    }

    /// What waits for an activity, and by which kind of link; nothing for one that is not there. Links of
    /// cycles are not among them.
    pub fn successors(&self, activity: usize) -> impl Iterator<Item = (usize, LinkKind)> {
        let edges = if activity < self.order.len() { self.successors.of(activity) } else { &[] };
        edges.iter().map(|edge| (edge.other as usize, edge.kind))
    }

    /// The links that are part of a cycle, in the order of their activities. They move nothing.
    pub fn cyclic_links(&self) -> &[CyclicLink] {
        &self.cyclic
    }

    /// [`Network::moved_with`] and [`Pull::Keep`].
    pub fn moved(
        &self,
        schedule: &Schedule,
        moves: &[(usize, TimeRange)],
    ) -> Vec<(usize, TimeRange)> {
        self.moved_with(schedule, moves, Pull::Keep)
    }

    /// The dates of all activities that move when a planner moves some, those among them, in the
    /// order of their indices. `schedule` has the dates before.
    ///
    /// What is moved by hand gets the dates that are given, whatever its links ask; the last ones if
    /// it is named twice. From there on, predecessors before successors: a link whose predecessor
    /// moved such that it now asks for more than before pushes its successor later, just until what
    /// the link asks is fulfilled. What has room does not move, and what moves keeps its duration.
    /// What has actually begun, is complete, is inactive or has no dates is never pushed. Links that
    /// now ask for less push nothing, even if they were broken before; with [`Pull::Back`] they pull
    /// what touched them. Moves of activities that are not there, or that end before they start, are
    /// left out; so are all if the schedule has not as many activities as the network. Dates are taken up to a
    /// million years from 1970.
    pub fn moved_with(
        &self,
        schedule: &Schedule,
        moves: &[(usize, TimeRange)],
        pull: Pull,
    ) -> Vec<(usize, TimeRange)> {
        let count = self.order.len();
        if schedule.activities.len() != count {
            return Vec::new();
        }
        let mut states = vec![State::default(); count];
        // The activities to look at, by rank.
        let mut open = vec![0u64; count.div_ceil(64)];
        for &(activity, dates) in moves {
            if let Some(state) = states.get_mut(activity).filter(|_| dates.start <= dates.end) {
                state.now = Some(seconds(dates));
                state.given = true;
                open[self.rank[activity] as usize / 64] |= 1 << (self.rank[activity] % 64);
            }
        }
        let mut word = 0;
        while word < open.len() {
            if open[word] == 0 {
                word += 1;
                continue;
            }
            let bit = open[word].trailing_zeros() as usize;
            open[word] &= open[word] - 1;
            let activity = self.order[word * 64 + bit] as usize;
            let old = before(&schedule.activities[activity]);
            if !states[activity].given {
                let Some(old) = old else { continue };
                states[activity].now = self.follows(schedule, activity, old, &states);
            }
            let Some(now) = states[activity].now else { continue };
            let Some(old) = old.filter(|&old| old != now) else { continue };
            for edge in self.successors.of(activity) {
                let next = edge.other as usize;
                let successor = &schedule.activities[next];
                let Some(dates) = before(successor).filter(|_| !states[next].given) else {
                    continue;
                };
                if has_begun(successor) {
                    continue;
                }
                let clock = self.clock(next);
                let (was, is) = (asked(clock, edge, old), asked(clock, edge, now));
                let state = &mut states[next];
                let look = if is > was {
                    let bound = if at_start(edge.kind) { &mut state.start } else { &mut state.end };
                    *bound = (*bound).max(is);
                    true
                } else {
                    let pulls =
                        pull == Pull::Back && is < was && touches(clock, edge.kind, was, dates);
                    state.pulled |= pulls;
                    pulls
                };
                if look {
                    open[self.rank[next] as usize / 64] |= 1 << (self.rank[next] % 64);
                }
            }
        }
        let range = |(start, end): Dates| TimeRange {
            start: Time::from_seconds(start),
            end: Time::from_seconds(end),
        };
        let moved = states.iter().enumerate().filter_map(|(i, s)| Some((i, range(s.now?))));
        moved.collect()
    }

    /// Where an activity goes, if it moves.
    fn follows(
        &self,
        schedule: &Schedule,
        activity: usize,
        old: Dates,
        states: &[State],
    ) -> Option<Dates> {
        let clock = self.clock(activity);
        let state = &states[activity];
        let end = normal_end(clock, old, state.end);
        if state.start > old.0 || end > old.1 {
            let (start, end) = placed(clock, old, state.start.max(old.0), end);
            return Some((start.max(old.0), end.max(old.1)));
        }
        if !state.pulled {
            return None;
        }
        let mut bounds = (i64::MIN, i64::MIN);
        for edge in self.predecessors.of(activity) {
            let other = edge.other as usize;
            let Some(was) = before(&schedule.activities[other]) else { continue };
            let asks = asked(clock, edge, states[other].now.unwrap_or(was));
            let bound = if at_start(edge.kind) { &mut bounds.0 } else { &mut bounds.1 };
            *bound = (*bound).max(asks);
        }
        let new = placed(clock, old, bounds.0, normal_end(clock, old, bounds.1));
        (new.0 < old.0).then_some(new)
    }

    /// Total slack of each activity: by how many seconds it can be later before the last end of the
    /// schedule moves, if everything after it is pushed by its links alone. Working time of its
    /// calendar where it keeps its duration by that, else time of the clock.
    ///
    /// What has none, 0 or less, is critical; negative slack says that links are broken as planned.
    /// `None` for activities that are complete, inactive or have no dates. Links to what has begun
    /// ask nothing, since they push nothing. Found backwards from the last end of what is active, with
    /// the rules of [`Network::moved`].
    pub fn critical(&self, schedule: &Schedule) -> Vec<Option<i64>> {
        let activities = &schedule.activities;
        let mut slacks = vec![None; activities.len()];
        if activities.len() != self.order.len() {
            return slacks;
        }
        let Some(last) = activities.iter().filter_map(|a| Some(before(a)?.1)).max() else {
            return slacks;
        };
        // The latest start and end of each.
        let mut latest: Vec<Dates> = vec![(i64::MAX, i64::MAX); activities.len()];
        for &activity in self.order.iter().rev() {
            let activity = activity as usize;
            let Some(dates) = before(&activities[activity]) else { continue };
            if is_complete(&activities[activity]) {
                continue;
            }
            let (mut start, mut end) = (LIMIT, last);
            for edge in self.successors.of(activity) {
                let next = edge.other as usize;
                let successor = &activities[next];
                let Some(theirs) = before(successor).filter(|_| !has_begun(successor)) else {
                    continue;
                };
                let until = allowed(self.clock(next), edge, theirs, latest[next]);
                let bound = match edge.kind {
                    LinkKind::StartStart | LinkKind::StartFinish => &mut start,
                    LinkKind::FinishStart | LinkKind::FinishFinish => &mut end,
                };
                *bound = (*bound).min(until);
            }
            let clock = self.clock(activity);
            let slack = match works(clock, dates) {
                None => (start - dates.0).min(end - dates.1),
                Some((clock, _)) => {
                    let worked = clock.worked(start);
                    // The start may not lie in the time off after the last allowed instant.
                    let early = clock.start_at(worked) > start && start != dates.0;
                    let room = worked - i64::from(early) - clock.worked(dates.0);
                    room.min(clock.worked(end) - clock.worked(dates.1))
                }
            };
            slacks[activity] = Some(slack);
            latest[activity] = match works(clock, dates) {
                None => (dates.0 + slack, dates.1 + slack),
                Some((clock, _)) => (
                    clock.start_at(clock.worked(dates.0) + slack),
                    clock.end_at(clock.worked(dates.1) + slack),
                ),
            };
        }
        slacks
    }

    fn clock(&self, activity: usize) -> Option<&WorkClock> {
        self.clocks.get(self.clock[activity] as usize)
    }
}

/// What is known of an activity while things move.
#[derive(Clone, Copy)]
struct State {
    /// Its dates, if it moves.
    now: Option<Dates>,
    /// By hand.
    given: bool,
    /// Something that it touched is earlier.
    pulled: bool,
    /// The earliest start and end that links ask which ask for more than before.
    start: i64,
    end: i64,
}

impl Default for State {
    fn default() -> Self {
        Self { now: None, given: false, pulled: false, start: i64::MIN, end: i64::MIN }
    }
}

fn seconds(dates: TimeRange) -> Dates {
    let clamped = |time: Time| time.seconds().clamp(-LIMIT, LIMIT);
    (clamped(dates.start), clamped(dates.end))
}

/// The dates of an activity, unless it is inactive.
fn before(activity: &Activity) -> Option<Dates> {
    activity.dates().filter(|_| activity.active).map(seconds)
}

fn is_complete(activity: &Activity) -> bool {
    activity.percent_complete.is_some_and(|p| p >= 100.0)
        || activity.date_sets[DateSet::Actual].end.is_some()
}

fn has_begun(activity: &Activity) -> bool {
    is_complete(activity) || activity.date_sets[DateSet::Actual].start.is_some()
}

fn at_start(kind: LinkKind) -> bool {
    matches!(kind, LinkKind::FinishStart | LinkKind::StartStart)
}

/// The clock by which an activity keeps its duration, and the duration.
fn works(clock: Option<&WorkClock>, dates: Dates) -> Option<(&WorkClock, i64)> {
    let clock = clock?;
    let duration = clock.worked(dates.1) - clock.worked(dates.0);
    (duration > 0).then_some((clock, duration))
}

/// The earliest start or end that a link asks of its successor, whose clock it is.
fn asked(clock: Option<&WorkClock>, edge: &Edge, predecessor: Dates) -> i64 {
    let from = match edge.kind {
        LinkKind::StartStart | LinkKind::StartFinish => predecessor.0,
        LinkKind::FinishStart | LinkKind::FinishFinish => predecessor.1,
    };
    let lag = edge.lag.seconds.clamp(-LIMIT, LIMIT);
    let asked = match clock.filter(|_| !edge.lag.elapsed && lag != 0) {
        Some(clock) => clock.end_at(clock.worked(from) + lag),
        None => from + lag,
    };
    asked.clamp(-LIMIT, LIMIT)
}

/// The last start or end of a predecessor with which a link asks for no more than a start and an end
/// of its successor: the other way round than [`asked`].
fn allowed(clock: Option<&WorkClock>, edge: &Edge, dates: Dates, latest: Dates) -> i64 {
    let until = match (at_start(edge.kind), works(clock, dates)) {
        (true, _) => latest.0,
        (false, None) => latest.1,
        (false, Some((clock, _))) => clock.start_at(clock.worked(latest.1)),
    };
    let until = until.clamp(-LIMIT, LIMIT);
    let lag = edge.lag.seconds.clamp(-LIMIT, LIMIT);
    let allowed = match clock.filter(|_| !edge.lag.elapsed && lag != 0) {
        Some(clock) => clock.start_at(clock.worked(until) - lag),
        None => until - lag,
    };
    allowed.clamp(-LIMIT, LIMIT)
}

/// An end that would have to lie in time off lies at the end of the work before it.
fn normal_end(clock: Option<&WorkClock>, dates: Dates, end: i64) -> i64 {
    match works(clock, dates) {
        Some((clock, _)) if end > i64::MIN => clock.end_at(clock.worked(end)),
        _ => end,
    }
}

/// Whether no working time lies between what a link asks and where its successor is.
fn touches(clock: Option<&WorkClock>, kind: LinkKind, asked: i64, dates: Dates) -> bool {
    let date = if at_start(kind) { dates.0 } else { dates.1 };
    match works(clock, dates) {
        Some((clock, _)) => {
            (asked <= date || !at_start(kind)) && clock.worked(asked) == clock.worked(date)
        }
        None => asked == date,
    }
}

/// The earliest dates with the same duration whose start and end are not before the bounds, of
/// which one is more than `i64::MIN`.
fn placed(clock: Option<&WorkClock>, dates: Dates, start: i64, end: i64) -> Dates {
    match works(clock, dates) {
        Some((clock, duration)) => {
            let by = |bound: i64| (bound > i64::MIN).then(|| clock.worked(bound));
            let by_end = by(end).map(|worked| worked - duration);
            let Some(worked) = by(start).max(by_end) else { return dates };
            (clock.start_at(worked), clock.end_at(worked + duration))
        }
        None => {
            let duration = dates.1 - dates.0;
            let start = start.max(end.saturating_sub(duration)).min(LIMIT);
            (start, start + duration)
        }
    }
}

/// For each activity the number of its group, of which those in a cycle share one, and all activities
/// in an order in which groups come after the groups that they wait for. Tarjan, without recursion.
fn groups<'a>(
    count: usize,
    links: &dyn Fn(usize) -> &'a [crate::Predecessor],
) -> (Vec<u32>, Vec<u32>) {
    const NONE: u32 = u32::MAX;
    let mut group = vec![NONE; count];
    let mut order = Vec::with_capacity(count);
    let mut index = vec![NONE; count];
    let mut low = vec![NONE; count];
    let mut stack: Vec<u32> = Vec::new();
    let mut path: Vec<(u32, u32)> = Vec::new();
    let mut next = 0;
    for root in 0..count {
        if index[root] != NONE {
            continue;
        }
        path.push((root as u32, 0));
        while let Some((activity, link)) = path.last_mut() {
            let i = *activity as usize;
            if *link == 0 && index[i] == NONE {
                (index[i], low[i]) = (next, next);
                next += 1;
                stack.push(i as u32);
            }
            if let Some(to) = links(i).get(*link as usize).map(|l| l.activity as usize) {
                *link += 1;
                if to >= count {
                    continue;
                }
                if index[to] == NONE {
                    path.push((to as u32, 0));
                } else if group[to] == NONE {
                    low[i] = low[i].min(index[to]);
                }
                continue;
            }
            path.pop();
            if low[i] == index[i] {
                while let Some(member) = stack.pop() {
                    group[member as usize] = i as u32;
                    order.push(member);
                    if member as usize == i {
                        break;
                    }
                }
            }
            if let Some(&(parent, _)) = path.last() {
                low[parent as usize] = low[parent as usize].min(low[i]);
            }
        }
    }
    (group, order)
}
