//! The plan around the demo's activities: an outline, links, and what was done up to a data date. The dates that
//! count stay as they are.

use super::model::storey_code;
use super::programme::{Calendar, Work};
use std::collections::HashMap;
use std::ops::Range;
use topout_schedule::{
    Activity, ActivityKind, DateSet, Dates, Lag, LinkKind, Predecessor, Time, WbsNode,
};

/// Up to when is known what was done.
const DATA_DATE: &str = "2027-05-03T17:00";
/// Working days by which work of a storey is late, or early; after the last one from the first on.
const LATE_DAYS: [i64; 12] = [0, 1, 3, 2, 0, -2, -4, -1, 1, 4, 7, 5];

/// Which part of which work an activity is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Origin {
    /// Index of the work.
    pub work: u32,
    /// Checks come after the work and change nothing.
    pub check: bool,
    /// The `index`-th of `count` parts of equal length.
    pub index: usize,
    /// See `index`.
    pub count: usize,
}

/// Up to when is known what was done.
pub(super) fn data_date() -> Time {
    Time::parse_iso(DATA_DATE).expect("the constant is a date")
}

/// Places activities in an outline, site > storey > trade, which is returned.
pub(super) fn outline(list: &mut [Activity], origins: &[Origin], works: &[Work]) -> Vec<WbsNode> {
    let node = |code: String, name: String, parent| WbsNode { code, name, parent };
    let mut nodes = vec![node("HT".to_owned(), "Harbour Tower".to_owned(), None)];
    let mut storeys: Vec<i32> = origins.iter().map(|o| works[o.work as usize].storey).collect();
    storeys.sort_unstable();
    storeys.dedup();
    let mut storey_nodes = HashMap::new();
    for storey in storeys {
        let code = storey_code(storey);
        storey_nodes.insert(storey, nodes.len() as u32);
        nodes.push(node(code.clone(), format!("Storey {code}"), Some(0)));
    }
    let mut trade_nodes: HashMap<(i32, &str), u32> = HashMap::new();
    for (activity, origin) in list.iter_mut().zip(origins) {
        let work = &works[origin.work as usize];
        let above = storey_nodes[&work.storey];
        let id = *trade_nodes.entry((work.storey, work.trade)).or_insert_with(|| {
            let code = work.trade.split_whitespace().filter_map(|w| w.get(..3)).collect::<String>();
            nodes.push(node(code, work.trade.to_owned(), Some(above)));
            nodes.len() as u32 - 1
        });
        activity.wbs = Some(id);
    }
    nodes
}

/// Links activities in ways that their dates keep to: a work's parts follow each other, checks follow what they
/// check, and a work follows the last one that is done on its storey before it, or its own trade one storey
/// below.
pub(super) fn link(list: &mut [Activity], origins: &[Origin], works: &[Work]) {
    let mut own: Vec<Range<usize>> = vec![0..0; works.len()];
    for (i, origin) in origins.iter().enumerate().filter(|(_, origin)| !origin.check) {
        let range = &mut own[origin.work as usize];
        *range = if range.start == range.end { i..i + 1 } else { range.start..i + 1 };
    }
    let before = works_before(list, &own, works);
    for i in 0..list.len() {
        let origin = origins[i];
        let work = origin.work as usize;
        let temporary = works[work].kind == ActivityKind::Temporary;
        let (from, kind) = if origin.check {
            // The part of the work that made the last of what is checked.
            let parts = own[work].len();
            let made = ((origin.index + 1) * parts).div_ceil(origin.count).clamp(1, parts) - 1;
            (own[work].start + made, LinkKind::FinishStart)
        } else if origin.index > 0 {
            (i - 1, if temporary { LinkKind::StartStart } else { LinkKind::FinishStart })
        } else if let Some(from) = before[work] {
            (from, LinkKind::FinishStart)
        } else {
            continue;
        };
        let kinds = [kind, LinkKind::StartStart];
        if let Some(kind) = kinds.into_iter().find(|kind| holds(&list[from], *kind, &list[i])) {
            let link = Predecessor { activity: from as u32, kind, lag: Lag::default() };
            list[i].predecessors.push(link);
        }
    }
}

/// Whether the dates keep to a link without a lag.
fn holds(from: &Activity, kind: LinkKind, to: &Activity) -> bool {
    match kind {
        LinkKind::FinishStart => from.end <= to.start,
        LinkKind::StartStart => from.start <= to.start,
        LinkKind::FinishFinish => from.end <= to.end,
        LinkKind::StartFinish => from.start <= to.end,
    }
}

/// For each work the activity that its first one waits for.
fn works_before(list: &[Activity], own: &[Range<usize>], works: &[Work]) -> Vec<Option<usize>> {
    let mut by_storey: HashMap<i32, Vec<usize>> = HashMap::new();
    for (w, work) in works.iter().enumerate().filter(|(w, _)| !own[*w].is_empty()) {
        by_storey.entry(work.storey).or_default().push(w);
    }
    let none = Vec::new();
    let waits_for = |w: usize| {
        let work = &works[w];
        let start = list[own[w].start].start;
        let on = |storey| by_storey.get(&storey).unwrap_or(&none).iter().copied();
        let below = on(work.storey - 1).filter(|o| works[*o].trade == work.trade);
        on(work.storey)
            .chain(below)
            .filter(|&o| o != w && works[o].kind != ActivityKind::Temporary)
            .map(|o| own[o].end - 1)
            .filter(|&last| list[last].end <= start && list[last].end.is_some())
            .max_by_key(|&last| list[last].end)
    };
    (0..works.len()).map(|w| if own[w].is_empty() { None } else { waits_for(w) }).collect()
}

/// Says what was planned and what was done. What has begun has its dates as actual ones; what is finished was planned for other days,
/// by its storey.
pub(super) fn progress(
    list: &mut [Activity],
    origins: &[Origin],
    works: &[Work],
    calendar: &Calendar,
) {
    let now = data_date();
    for (activity, origin) in list.iter_mut().zip(origins) {
        let Some(dates) = activity.dates() else { continue };
        let sets = &mut activity.date_sets;
        sets[DateSet::Planned] = Dates { start: activity.start, end: activity.end };
        if dates.end <= now {
            let place = works[origin.work as usize].storey.rem_euclid(LATE_DAYS.len() as i32);
            let late = LATE_DAYS[place as usize];
            sets[DateSet::Planned] = Dates {
                start: Some(calendar.days_before(dates.start, late)),
                end: Some(calendar.days_before(dates.end, late)),
            };
            sets[DateSet::Actual] = Dates { start: activity.start, end: activity.end };
            activity.percent_complete = Some(100.0);
        } else if dates.start < now {
            sets[DateSet::Actual] = Dates { start: activity.start, end: None };
            let done = (now.seconds() - dates.start.seconds()) as f64;
            let whole = (dates.end.seconds() - dates.start.seconds()) as f64;
            activity.percent_complete =
                Some((done / whole * 100.0).round().clamp(1.0, 99.0) as f32);
        } else {
            activity.percent_complete = Some(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::{DemoSettings, generate};
    use super::*;
    use topout_schedule::{Network, ReadOptions, Schedule, TimeRange, read_bytes};

    fn schedule() -> Schedule {
        let settings =
            DemoSettings { elements: 2_000, triangles: 92_000, activities: 1_700, seed: 4 };
        generate(&settings, &crate::Progress::default()).unwrap().1
    }

    #[test]
    fn the_dates_keep_to_every_link() {
        let schedule = schedule();
        let (mut links, mut waiting) = (0, 0);
        for activity in &schedule.activities {
            waiting += usize::from(!activity.predecessors.is_empty());
            for link in &activity.predecessors {
                links += 1;
                let from = &schedule.activities[link.activity as usize];
                assert!(holds(from, link.kind, activity), "{} -> {}", from.id, activity.id);
            }
        }
        assert!(waiting * 10 > schedule.activities.len() * 9, "{waiting} wait for something");
        let finish = |a: &&Activity| a.predecessors.iter().any(|p| p.kind == LinkKind::FinishStart);
        assert!(schedule.activities.iter().filter(finish).count() * 2 > links);
        assert_eq!(Network::new(&schedule).cyclic_links(), []);
    }

    #[test]
    fn what_is_late_moves_what_follows() {
        let schedule = schedule();
        let network = Network::new(&schedule);
        // The next storey that is begun.
        let now = schedule.data_date.unwrap();
        let structure = |a: &&Activity| {
            let trade = schedule.wbs_path(a).last().copied();
            trade == Some("Structure") && a.kind == ActivityKind::Construct
        };
        let next = schedule.activities.iter().filter(structure).filter(|a| a.start > Some(now));
        let next = next.min_by_key(|a| a.start).unwrap();
        let place = schedule.activities.iter().position(|a| a.id == next.id).unwrap();
        let dates = next.dates().unwrap();
        let month = 30 * 86_400;
        let late = TimeRange {
            start: dates.start.plus_seconds(month),
            end: dates.end.plus_seconds(month),
        };
        let moves = network.moved(&schedule, &[(place, late)]);
        assert!(moves.len() >= 5, "{}", moves.len());
    }

    #[test]
    fn the_outline_has_everything_and_is_read_as_it_was_written() {
        let schedule = schedule();
        assert!(schedule.activities.iter().all(|a| schedule.wbs_path(a).len() == 3));
        let mut text = Vec::new();
        schedule.write_json(&mut text).unwrap();
        let read = read_bytes("demo.json".as_ref(), &text, &ReadOptions::default()).unwrap();
        assert_eq!((&read.wbs, read.data_date), (&schedule.wbs, schedule.data_date));
        assert_eq!(read.activities, schedule.activities);
    }

    #[test]
    fn what_was_done_is_known_up_to_the_data_date() {
        let schedule = schedule();
        let now = schedule.data_date.unwrap();
        let (mut done, mut open, mut shifted) = (0, 0, 0);
        for activity in &schedule.activities {
            let dates = activity.dates().unwrap();
            let chosen = activity.date_sets.chosen();
            assert_eq!((chosen.start, chosen.end), (Some(dates.start), Some(dates.end)));
            let actual = activity.date_sets[DateSet::Actual];
            assert!(actual.start.is_none_or(|t| t <= now) && actual.end.is_none_or(|t| t <= now));
            done += usize::from(activity.percent_complete == Some(100.0));
            open += usize::from(activity.percent_complete == Some(0.0));
            let planned = activity.date_sets[DateSet::Planned];
            shifted += usize::from(planned.start != activity.start);
            assert!(planned.start < planned.end);
        }
        let all = schedule.activities.len();
        assert!(done * 5 > all && open * 5 > all && shifted * 8 > all, "{done} {open} {shifted}");
    }
}
