//! What moves when something is moved, against a solver that steps through half hours and relaxes
//! links until nothing changes, and by hand.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use std::path::PathBuf;
use topout_schedule::{
    Activity, Calendar, DateSet, Diagnostics, Lag, LinkKind, Network, Predecessor, Pull,
    ReadOptions, Schedule, Time, TimeRange, read_files,
};

const STEP: i64 = 1800;
const WEEK: &str = r#"{"week": {"mon": ["08:00-12:00", "13:00-17:00"], "tue": ["08:00-12:00", "13:00-17:00"],
    "wed": ["08:00-12:00", "13:00-17:00"], "thu": ["08:00-12:00", "13:00-17:00"],
    "fri": ["08:00-12:00", "13:00-17:00"]},
    "exceptions": [{"first": "2026-03-11", "last": "2026-03-12"}, {"first": "2026-03-15", "last": "2026-03-15", "shifts": ["10:00-11:00"]}]}"#;

fn time(text: &str) -> Time {
    Time::parse_iso(text).unwrap()
}

fn range(start: &str, end: &str) -> TimeRange {
    TimeRange { start: time(start), end: time(end) }
}

fn link(activity: u32, kind: &str, hours: f64, elapsed: bool) -> Predecessor {
    let lag = Lag { seconds: (hours * 3600.0) as i64, elapsed };
    Predecessor { activity, kind: LinkKind::from_word(kind).unwrap(), lag }
}

/// Activities by dates and links, all of one calendar if any.
fn schedule(rows: Vec<(TimeRange, Vec<Predecessor>)>, calendar: Option<&str>) -> Schedule {
    let activities = rows.into_iter().enumerate().map(|(i, (dates, predecessors))| Activity {
        id: format!("a{i}"),
        start: Some(dates.start),
        end: Some(dates.end),
        predecessors,
        ..Activity::default()
    });
    let activities: Vec<_> = activities.collect();
    let mut schedule = Schedule::new("p".into(), None, activities, Diagnostics::default());
    schedule.calendars =
        calendar.map(|text| serde_json::from_str(text).unwrap()).into_iter().collect();
    schedule.calendar = calendar.map(|_| 0);
    schedule
}

/// Working time in half hours of a span, counted one by one.
struct Hours {
    first: i64,
    worked: Vec<i64>,
}

impl Hours {
    fn new(calendar: &Calendar, first: Time, days: usize) -> Self {
        let first = first.seconds();
        let mut worked = vec![0];
        for i in 0..days as i64 * 86_400 / STEP {
            let at = Time::from_seconds(first + i * STEP);
            let works = calendar.next_work(at).is_some_and(|next| next == at);
            worked.push(worked[i as usize] + i64::from(works));
        }
        Self { first, worked }
    }

    fn worked(&self, time: i64) -> i64 {
        self.worked[((time - self.first) / STEP) as usize]
    }

    fn end_at(&self, worked: i64) -> i64 {
        self.first + self.worked.iter().position(|&w| w >= worked).unwrap() as i64 * STEP
    }
}

type Dates = (i64, i64);

fn naive(schedule: &Schedule, moves: &[(usize, TimeRange)]) -> Vec<(usize, TimeRange)> {
    let seconds = |r: TimeRange| (r.start.seconds(), r.end.seconds());
    let first = schedule.period.start.plus_seconds(-400 * 86_400).seconds() / 86_400 * 86_400;
    let days = (schedule.period.seconds() / 86_400 + 1600) as usize;
    let hours: Vec<Hours> = (schedule.calendars.iter())
        .map(|c| Hours::new(c, Time::from_seconds(first), days))
        .collect();
    let old: Vec<Option<Dates>> =
        schedule.activities.iter().map(|a| a.dates().filter(|_| a.active).map(seconds)).collect();
    let mut now = old.clone();
    for &(i, dates) in moves {
        now[i] = Some(seconds(dates));
    }
    let asks = |hours: Option<&Hours>, link: &Predecessor, (start, end): Dates| {
        let from = match link.kind {
            LinkKind::StartStart | LinkKind::StartFinish => start,
            LinkKind::FinishStart | LinkKind::FinishFinish => end,
        };
        match hours.filter(|_| link.lag.seconds != 0 && !link.lag.elapsed) {
            Some(hours) => hours.end_at(hours.worked(from) + link.lag.seconds / STEP),
            None => from + link.lag.seconds,
        }
    };
    loop {
        let mut changed = false;
        for (i, activity) in schedule.activities.iter().enumerate() {
            let begun = activity.date_sets[DateSet::Actual].start.is_some()
                || activity.percent_complete.is_some_and(|p| p >= 100.0);
            if begun || moves.iter().any(|m| m.0 == i) {
                continue;
            }
            let calendar = activity.calendar.or(schedule.calendar);
            let hours = calendar.map(|c| &hours[c as usize]);
            for link in &activity.predecessors {
                let before = link.activity as usize;
                let (Some(was), Some(is)) = (old[before], now[before]) else { continue };
                let (Some(planned), Some(mut dates)) = (old[i], now[i]) else { continue };
                let asked = asks(hours, link, is);
                if asked <= asks(hours, link, was) {
                    continue;
                }
                let hours = hours.filter(|h| h.worked(planned.1) > h.worked(planned.0));
                let at_start = matches!(link.kind, LinkKind::FinishStart | LinkKind::StartStart);
                let fits = |dates: Dates| match (at_start, hours) {
                    (true, _) => dates.0 >= asked,
                    (false, None) => dates.1 >= asked,
                    (false, Some(h)) => h.worked(dates.1) >= h.worked(asked),
                };
                if fits(dates) {
                    continue;
                }
                // Half an hour later and later, until it fits.
                let mut start = dates.0;
                while !fits(dates) {
                    start += STEP;
                    match hours {
                        None => dates = (start, start + planned.1 - planned.0),
                        Some(h) if h.worked(start + STEP) > h.worked(start) => {
                            let length = h.worked(planned.1) - h.worked(planned.0);
                            dates = (start, h.end_at(h.worked(start) + length));
                        }
                        Some(_) => {}
                    }
                }
                dates.1 = dates.1.max(planned.1);
                now[i] = Some(dates);
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    let range =
        |(s, e): Dates| TimeRange { start: Time::from_seconds(s), end: Time::from_seconds(e) };
    (0..now.len())
        .filter(|&i| now[i] != old[i] || moves.iter().any(|m| m.0 == i))
        .filter_map(|i| Some((i, range(now[i]?))))
        .collect()
}

fn with(schedule: &Schedule, moves: &[(usize, TimeRange)]) -> Schedule {
    let mut moved = schedule.clone();
    for &(i, dates) in moves {
        (moved.activities[i].start, moved.activities[i].end) = (Some(dates.start), Some(dates.end));
    }
    moved
}

prop_compose! {
    /// Start, length, calendar, links (how far back, kind, lag, elapsed), what is unusual; half hours.
    fn row()(
        start in 0i64..600, length in 0i64..60, calendar in 0u32..4,
        links in prop::collection::vec((1usize..5, 0usize..4, -20i64..40, any::<bool>()), 0..3),
        special in 0u8..16,
    ) -> (i64, i64, u32, Vec<(usize, usize, i64, bool)>, u8) {
        (start, length, calendar, links, special)
    }
}

prop_compose! {
    fn schedules()(rows in prop::collection::vec(row(), 2..12)) -> Schedule {
        let first = time("2026-03-02").seconds();
        let mut activities = Vec::new();
        let mut calendars = Vec::new();
        for (i, (start, length, calendar, links, special)) in rows.into_iter().enumerate() {
            let at = |n: i64| Some(Time::from_seconds(first + n * STEP));
            let predecessors = links.into_iter().filter(|l| l.0 <= i).map(|(back, kind, lag, elapsed)| {
                let lag = Lag { seconds: lag * STEP, elapsed };
                Predecessor { activity: (i - back) as u32, kind: LinkKind::WORDS[kind].1, lag }
            });
            let mut activity = Activity {
                id: format!("a{i}"), start: at(start), end: at(start + length),
                predecessors: predecessors.collect(),
                ..Activity::default()
            };
            match special {
                0 => activity.active = false,
                1 => activity.percent_complete = Some(100.0),
                2 => activity.date_sets[DateSet::Actual].start = at(start),
                3 => activity.end = None,
                _ => {}
            }
            activities.push(activity);
            calendars.push((calendar < 2).then_some(calendar));
        }
        let mut schedule = Schedule::new("p".into(), None, activities, Diagnostics::default());
        schedule.calendars = [WEEK, r#"{"week": {"mon": ["00:00-24:00"], "wed": ["06:00-14:00"], "sat": ["09:30-11:00"]}}"#]
            .map(|text| serde_json::from_str(text).unwrap()).to_vec();
        for (activity, calendar) in schedule.activities.iter_mut().zip(calendars) {
            activity.calendar = calendar;
        }
        schedule
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn moves_as_the_naive_solver(schedule in schedules(), which in 0usize..12, by in -200i64..400) {
        let which = which % schedule.activities.len();
        let activity = &schedule.activities[which];
        let Some(dates) = activity.dates().filter(|_| activity.active) else { return Ok(()) };
        let later = |t: Time| t.plus_seconds(by * STEP);
        let moves = [(which, TimeRange { start: later(dates.start), end: later(dates.end) })];
        let network = Network::new(&schedule);
        prop_assert!(network.cyclic_links().is_empty());
        let moved = network.moved(&schedule, &moves);
        prop_assert_eq!(&moved, &naive(&schedule, &moves));
        if by < 0 {
            prop_assert_eq!(&moved[..], &moves[..]);
        }
        // Back again by the list of the dates before. What moved earlier may have made a link hold that
        // was broken, and pushes it on its way back.
        if by >= 0 {
            let after = with(&schedule, &moved);
            let back: Vec<_> =
                moved.iter().map(|&(i, _)| (i, schedule.activities[i].dates().unwrap())).collect();
            prop_assert_eq!(network.moved(&after, &back), back);
        }
        // What is pulled back is earlier, and everything that moves later does so without pulling too.
        let pulled = network.moved_with(&schedule, &moves, Pull::Back);
        if by < 0 {
            for &(i, dates) in &pulled {
                prop_assert!(dates.start < schedule.activities[i].dates().unwrap().start);
            }
        } else {
            prop_assert_eq!(&pulled, &moved);
        }
    }
}

/// A calendar's Monday to Wednesday; the successor begins where the first ends. Each kind of link, by
/// hand, when the first is two days later: its dates go from Mon-Tue to Wed-Thu.
#[test]
fn every_kind_of_link_by_hand() {
    let first = range("2026-03-02T08:00:00", "2026-03-03T17:00:00");
    let later = range("2026-03-04T08:00:00", "2026-03-05T17:00:00");
    let second = range("2026-03-04T08:00:00", "2026-03-04T17:00:00");
    for (kind, lag, elapsed, expected) in [
        ("FS", 0.0, false, Some(("2026-03-06T08:00:00", "2026-03-06T17:00:00"))),
        // Four working hours from Thursday evening, and then over the weekend.
        ("FS", 4.0, false, Some(("2026-03-06T13:00:00", "2026-03-09T12:00:00"))),
        // 24 hours of the clock to Friday 17:00: Monday.
        ("FS", 24.0, true, Some(("2026-03-09T08:00:00", "2026-03-09T17:00:00"))),
        ("FS", -8.0, false, Some(("2026-03-05T08:00:00", "2026-03-05T17:00:00"))),
        ("FS", -16.0, false, None),
        ("SS", 0.0, false, None),
        ("SS", 2.0, false, Some(("2026-03-04T10:00:00", "2026-03-05T10:00:00"))),
        ("FF", 0.0, false, Some(("2026-03-05T08:00:00", "2026-03-05T17:00:00"))),
        ("FF", -4.0, false, Some(("2026-03-04T13:00:00", "2026-03-05T12:00:00"))),
        ("SF", 8.0, false, None),
        ("SF", 12.0, false, Some(("2026-03-04T13:00:00", "2026-03-05T12:00:00"))),
    ] {
        let rows = vec![(first, vec![]), (second, vec![link(0, kind, lag, elapsed)])];
        let schedule = schedule(rows, Some(WEEK));
        let moved = Network::new(&schedule).moved(&schedule, &[(0, later)]);
        let mut list = vec![(0, later)];
        list.extend(expected.map(|(start, end)| (1, range(start, end))));
        assert_eq!(moved, list, "{kind} {lag} {elapsed}");
    }
}

/// By the clock: moved a day earlier, what touches follows, what another link holds does not, and
/// what had room stays.
#[test]
fn pulled_back() {
    let day = |n: u32| range(&format!("2026-03-{n:02}"), &format!("2026-03-{:02}", n + 1));
    let rows = vec![
        (day(2), vec![]),
        (day(3), vec![link(0, "FS", 0.0, false)]),
        (day(3), vec![link(0, "FS", 0.0, false), link(3, "FS", 0.0, false)]),
        (day(2), vec![]),
        (day(5), vec![link(1, "FS", 0.0, false)]),
    ];
    let schedule = schedule(rows, None);
    let network = Network::new(&schedule);
    let moves = [(0, day(1))];
    assert_eq!(network.moved(&schedule, &moves), moves);
    let back = network.moved_with(&schedule, &moves, Pull::Back);
    assert_eq!(back, [(0, day(1)), (1, day(2))]);
}

#[test]
fn cycles_end_and_are_told() {
    let day = |n: u32| range(&format!("2026-03-{n:02}"), &format!("2026-03-{:02}", n + 1));
    let rows = vec![
        (day(2), vec![link(2, "FS", 0.0, false)]),
        (day(3), vec![link(0, "FS", 0.0, false)]),
        (day(4), vec![link(1, "FS", 0.0, false), link(2, "SS", 0.0, false)]),
        (day(5), vec![link(2, "FS", 0.0, false)]),
    ];
    let schedule = schedule(rows, None);
    let network = Network::new(&schedule);
    let cyclic: Vec<_> = network.cyclic_links().iter().map(|c| (c.activity, c.link)).collect();
    assert_eq!(cyclic, [(0, 0), (1, 0), (2, 0), (2, 1)]);
    let moved = network.moved(&schedule, &[(2, day(6))]);
    assert_eq!(moved, [(2, day(6)), (3, day(7))]);
}

/// A chain of a million activities, whose links need no recursion.
#[test]
fn a_long_chain_and_bad_moves() {
    let at = |n: i64| TimeRange { start: Time::from_seconds(n), end: Time::from_seconds(n + 1) };
    let row = |i: i64| {
        (at(i), (i > 0).then(|| link(i as u32 - 1, "FS", 0.0, false)).into_iter().collect())
    };
    let schedule = schedule((0..1_000_000).map(row).collect(), None);
    let network = Network::new(&schedule);
    let moved = network.moved(&schedule, &[(0, at(5))]);
    assert_eq!((moved.len(), moved.last()), (1_000_000, Some(&(999_999, at(1_000_004)))));
    let reversed = TimeRange { start: Time::from_seconds(1), end: Time::from_seconds(0) };
    assert_eq!(network.moved(&schedule, &[(1_000_000, at(0)), (3, reversed)]), []);
    let far = TimeRange { start: Time::from_seconds(i64::MAX), end: Time::from_seconds(i64::MAX) };
    assert_eq!(network.moved(&schedule, &[(999_990, far)]).len(), 10);
    assert_eq!(network.moved(&Schedule::default(), &[(0, at(5))]), []);
}

proptest! {
    /// Where all links hold, what is later by its slack does not move the end, and by more it does.
    #[test]
    fn slack(rows in prop::collection::vec((0i64..9, 0i64..20, 0usize..5, 0usize..4, -5i64..9), 2..15)) {
        let mut dates: Vec<Dates> = Vec::new();
        let mut all = Vec::new();
        for (i, (extra, length, back, kind, lag)) in rows.into_iter().enumerate() {
            let mut links = Vec::new();
            let mut start = extra;
            if (1..=i).contains(&back) {
                let kind = LinkKind::WORDS[kind].1;
                let from = dates[i - back];
                start += lag + match kind {
                    LinkKind::FinishStart => from.1,
                    LinkKind::StartStart => from.0,
                    LinkKind::FinishFinish => from.1 - length,
                    LinkKind::StartFinish => from.0 - length,
                };
                let lag = Lag { seconds: lag, elapsed: false };
                links.push(Predecessor { activity: (i - back) as u32, kind, lag });
            }
            dates.push((start, start + length));
            let at = Time::from_seconds;
            all.push((TimeRange { start: at(start), end: at(start + length) }, links));
        }
        let schedule = schedule(all, None);
        let network = Network::new(&schedule);
        let end = dates.iter().map(|d| d.1).max().unwrap();
        for (i, slack) in network.critical(&schedule).into_iter().enumerate() {
            let slack = slack.unwrap();
            prop_assert!(slack >= 0);
            for (by, moves_end) in [(slack, false), (slack + 1, true)] {
                let at = |t: i64| Time::from_seconds(t + by);
                let moves = [(i, TimeRange { start: at(dates[i].0), end: at(dates[i].1) })];
                let moved = network.moved(&schedule, &moves);
                let last = moved.iter().map(|m| m.1.end.seconds()).max().unwrap();
                prop_assert_eq!(last > end, moves_end);
            }
        }
    }
}

/// The slack over a weekend is working time: A ends on Thursday evening, B begins on Monday.
#[test]
fn slack_in_working_time() {
    let rows = vec![
        (range("2026-03-05T08:00:00", "2026-03-05T17:00:00"), vec![]),
        (range("2026-03-09T08:00:00", "2026-03-09T17:00:00"), vec![link(0, "FS", 0.0, false)]),
        (range("2026-03-06T08:00:00", "2026-03-06T12:00:00"), vec![]),
    ];
    let schedule = schedule(rows, Some(WEEK));
    let slacks = Network::new(&schedule).critical(&schedule);
    assert_eq!(slacks, [Some(8 * 3600), Some(0), Some(12 * 3600)]);
}

/// A task, five working days (a week) later.
#[test]
fn real_schedules_follow() {
    let Some(data) = std::env::var_os("TOPOUT_REAL_DATA").map(PathBuf::from) else {
        println!("skipped: TOPOUT_REAL_DATA is not set");
        return;
    };
    for (file, tasks, first, expected) in REAL {
        let schedule = read_files(&[data.join(file)], &ReadOptions::default()).unwrap();
        assert_eq!(schedule.activities.len(), tasks, "{file}");
        let network = Network::new(&schedule);
        assert_eq!(network.cyclic_links(), [], "{file}");
        let dates = schedule.activities[first].dates().unwrap();
        let later = |t: Time| t.plus_seconds(7 * 86_400);
        let moves = [(first, TimeRange { start: later(dates.start), end: later(dates.end) })];
        let moved = network.moved(&schedule, &moves);
        assert_eq!(moved, naive(&schedule, &moves), "{file}");
        assert_eq!(moved.len(), expected, "{file}");
        assert_eq!(network.critical(&schedule).len(), tasks);
    }
}

/// File, activities, the one that moves, how many move: scaffolding with four after it; the start.
const REAL: [(&str, usize, usize, usize); 2] =
    [("schependomlaan/planning_mspdi.xml", 157, 108, 5), ("schedules/MDL4D.xer", 62, 50, 23)];
