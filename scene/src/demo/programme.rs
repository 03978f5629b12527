//! When things happen: working time, phases, and packages of work that become activities.

use super::DemoError;
use super::builder::{Part, WorkId};
use super::design::Design;
use super::model::storey_code;
use super::planning::{self, Origin};
use chrono::{Days, NaiveDate};
use std::sync::Arc;
use topout_schedule::{
    Activity, ActivityKind, CalendarException, Schedule, Shift, Time, TimeRange, WbsNode,
};

/// First and last instant of the project.
const START: (i32, u32, u32) = (2026, 3, 3);
/// Work starts at 08:00.
const START_SECONDS: i64 = 8 * 3600;
/// Days from the first to the last, both included.
const DAYS: i64 = 875;
/// Minutes worked on a full day, from 08:00 to 17:00.
const DAY_MINUTES: i64 = 540;
/// The last day ends at 13:00.
const LAST_DAY_MINUTES: i64 = 300;
/// Planned times are multiples of this many minutes.
const RASTER: i64 = 15;

/// A span of working minutes from the project's start.
pub(super) type Window = (f64, f64);

/// A package of work: one trade at one place, done to parts one after the other.
#[derive(Clone, Debug)]
pub(super) struct Work {
    pub trade: &'static str,
    pub name: &'static str,
    pub storey: i32,
    pub kind: ActivityKind,
    pub active: bool,
    /// While it is done; for temporary things, while they are put up.
    pub on: Window,
    /// While temporary things are taken away again.
    pub off: Window,
}

impl Work {
    pub(super) fn construct(
        trade: &'static str,
        name: &'static str,
        storey: i32,
        on: Window,
    ) -> Self {
        Self { trade, name, storey, kind: ActivityKind::Construct, active: true, on, off: on }
    }

    pub(super) fn demolish(
        trade: &'static str,
        name: &'static str,
        storey: i32,
        on: Window,
    ) -> Self {
        Self { kind: ActivityKind::Demolish, ..Self::construct(trade, name, storey, on) }
    }

    pub(super) fn neutral(
        trade: &'static str,
        name: &'static str,
        storey: i32,
        on: Window,
    ) -> Self {
        Self { kind: ActivityKind::Neutral, ..Self::construct(trade, name, storey, on) }
    }

    pub(super) fn temporary(
        trade: &'static str,
        name: &'static str,
        storey: i32,
        on: Window,
        off: Window,
    ) -> Self {
        Self { kind: ActivityKind::Temporary, off, ..Self::construct(trade, name, storey, on) }
    }
}

/// The dates that everything is planned from.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    total: f64,
    storeys: i32,
    basements: i32,
    cycle: f64,
    lag: f64,
}

/// Shares of the working time at which the tower's structure starts and ends, and by which
/// everything inside is finished.
const STRUCTURE: (f64, f64) = (0.20, 0.755);
const BASEMENT: f64 = 0.162;
const FINISHED: f64 = 0.955;
/// Lags after which the last trade on a storey is done, in units of [`Plan::fit`].
const LAGS: f64 = 21.0;

impl Plan {
    pub(super) fn new(design: &Design) -> Self {
        let total = Calendar::new().total() as f64;
        let cycle = (STRUCTURE.1 - STRUCTURE.0) * total / f64::from(design.storeys);
        let room = (FINISHED - STRUCTURE.1) * total - 0.6 * cycle;
        // With few storeys a cycle is long; then a storey's trades follow within it.
        let lag = (room / LAGS).max(0.002 * total);
        Self { total, storeys: design.storeys, basements: design.basements, cycle, lag }
    }

    /// Working minutes of the project.
    pub(super) fn total(&self) -> f64 {
        self.total
    }

    /// A window by shares of the working time.
    pub(super) fn share(&self, from: f64, to: f64) -> Window {
        (from * self.total, to * self.total)
    }

    /// A window by the structure's cycle of a storey, 0 to 1 while it is built.
    pub(super) fn structure(&self, storey: i32, from: f64, to: f64) -> Window {
        let (start, length) = if storey < 0 {
            let length = (STRUCTURE.0 - BASEMENT) * self.total / f64::from(self.basements);
            (BASEMENT * self.total + length * f64::from(storey + self.basements), length)
        } else {
            (STRUCTURE.0 * self.total + self.cycle * f64::from(storey), self.cycle)
        };
        // What happens after the storey's own cycle does not wait longer where cycles are long.
        let after = length.min(0.015 * self.total);
        let minute = |at: f64| start + length * at.min(1.0) + after * (at - 1.0).max(0.0);
        (minute(from), minute(to))
    }

    /// A window of a trade that follows the structure by `lag` units and takes `duration` units; the
    /// floor above is there by then.
    pub(super) fn fit(&self, storey: i32, lag: f64, duration: f64) -> Window {
        let free =
            self.structure(storey.min(self.storeys - 1).max(0), 0.0, 0.0).0 + 1.62 * self.cycle;
        (free + lag * self.lag, free + (lag + duration) * self.lag)
    }
}

/// Maps working minutes to civil time: Monday to Friday 08:00 to 17:00, closed over Christmas.
pub(super) struct Calendar {
    /// 08:00 of every working day.
    days: Vec<Time>,
}

impl Calendar {
    pub(super) fn new() -> Self {
        let (start, _) = period();
        let days = (0..DAYS)
            .map(|d| start.plus_seconds(d * 86_400))
            .filter(|t| {
                let text = t.to_string();
                let christmas =
                    ("12-24"..="12-31").contains(&&text[5..10]) || &text[5..10] == "01-01";
                // 1970-01-01 was a Thursday.
                (t.seconds().div_euclid(86_400) + 3).rem_euclid(7) < 5 && !christmas
            })
            .collect();
        Self { days }
    }

    /// All working minutes up to the project's end.
    pub(super) fn total(&self) -> i64 {
        (self.days.len() as i64 - 1) * DAY_MINUTES + LAST_DAY_MINUTES
    }

    /// The same time of day so many working days earlier; the first or the last day where there are not so many.
    pub(super) fn days_before(&self, time: Time, count: i64) -> Time {
        let day = self.days.partition_point(|day| *day <= time).max(1) - 1;
        let earlier = (day as i64 - count).clamp(0, self.days.len() as i64 - 1) as usize;
        let of_day = time.seconds() - self.days[day].seconds();
        self.days[earlier].plus_seconds(of_day)
    }

    /// When work of this minute starts: the end of a day is the next morning.
    fn start(&self, minute: i64) -> Time {
        let day = (minute / DAY_MINUTES).clamp(0, self.days.len() as i64 - 1);
        self.days[day as usize].plus_seconds((minute - day * DAY_MINUTES) * 60)
    }

    /// When work up to this minute ends: the start of a day is the evening before.
    fn end(&self, minute: i64) -> Time {
        self.start(minute - 1).plus_seconds(60)
    }
}

/// Start and end of the project.
fn period() -> (Time, Time) {
    let (y, m, d) = START;
    let start = Time::parse_iso(&format!("{y:04}-{m:02}-{d:02}"))
        .expect("the constant is a date")
        .plus_seconds(START_SECONDS);
    (start, start.plus_seconds((DAYS - 1) * 86_400 + LAST_DAY_MINUTES * 60))
}

/// What is done to finished parts without changing their presence, by trade.
fn checks(trade: &str) -> [&'static str; 3] {
    match trade {
        "Structure" => ["Survey as built", "Inspect", "Make good"],
        "Facade" => ["Seal joints", "Inspect", "Clean"],
        "Finishes" => ["Paint", "Snag", "Clean"],
        "Mechanical" | "Sprinklers" => ["Pressure test", "Label", "Commission"],
        "Electrical" => ["Test circuits", "Label", "Commission"],
        "Temporary works" | "Logistics" => ["Safety check", "Inspect", "Maintain"],
        "Demolition" | "Earthworks" => ["Survey", "Monitor dust", "Photograph"],
        _ => ["Inspect", "Snag", "Sign off"],
    }
}

/// Parts of every work, in the order in which they are done.
fn members(works: usize, parts: &[Part]) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); works];
    for (i, part) in parts.iter().enumerate() {
        for WorkId(w) in part.works.iter().flatten() {
            members[*w as usize].push(i as u32);
        }
    }
    members
}

/// The `index`-th of `count` nearly equal pieces of `0..len`.
fn piece(len: usize, count: usize, index: usize) -> std::ops::Range<usize> {
    len * index / count..len * (index + 1) / count
}

/// Splits works into exactly `wanted` activities: each work into one to as many as it has parts, the
/// rest being checks of finished parts. `names[i]` is the name of part `i`.
pub(super) fn activities(
    works: &[Work],
    parts: &[Part],
    names: &[String],
    wanted: usize,
) -> Result<(Vec<Activity>, Vec<WbsNode>), DemoError> {
    let members = members(works.len(), parts);
    let packages = members.iter().filter(|m| !m.is_empty()).count();
    let links: usize = members.iter().map(Vec::len).sum();
    if wanted < packages || wanted > links * 4 {
        return Err(DemoError::Activities { wanted, least: packages, most: links * 4 });
    }
    let own = (wanted * 4 / 5).clamp(packages, links);
    let (extra, spare) = (own - packages, (links - packages).max(1));
    let others = wanted - own;
    let mut writer = Writer {
        calendar: Calendar::new(),
        names,
        fields: ["trade", "storey", "package"].map(Arc::from),
        list: Vec::with_capacity(wanted),
        origins: Vec::with_capacity(wanted),
    };
    let (mut seen_spare, mut seen) = (0, 0);
    for (w, (work, members)) in works.iter().zip(&members).enumerate() {
        if members.is_empty() {
            continue;
        }
        let n = members.len();
        let share = |k: usize| (k as u128 * extra as u128 / spare as u128) as usize;
        let own = 1 + share(seen_spare + n - 1) - share(seen_spare);
        let other = |k: usize| (k as u128 * others as u128 / links as u128) as usize;
        let checks = other(seen + n) - other(seen);
        seen_spare += n - 1;
        seen += n;
        writer.package(w, work, members, own);
        writer.checks(w, work, members, checks);
    }
    let Writer { calendar, mut list, origins, .. } = writer;
    let outline = planning::outline(&mut list, &origins, works);
    planning::link(&mut list, &origins, works);
    planning::progress(&mut list, &origins, works, &calendar);
    Ok((list, outline))
}

struct Writer<'a> {
    calendar: Calendar,
    names: &'a [String],
    /// The names of the fields that every activity has.
    fields: [Arc<str>; 3],
    list: Vec<Activity>,
    /// Of each in `list`.
    origins: Vec<Origin>,
}

impl Writer<'_> {
    /// The work itself, in `count` activities.
    fn package(&mut self, number: usize, work: &Work, members: &[u32], count: usize) {
        for k in 0..count {
            let share = |window: Window, j: usize| {
                window.0 + (window.1 - window.0) * j as f64 / count as f64
            };
            let until = if work.kind == ActivityKind::Temporary { work.off } else { work.on };
            let span = (share(work.on, k), share(until, k + 1));
            let members = &members[piece(members.len(), count, k)];
            self.push(number, work, work.name, span, members, (k, count), work.kind);
            self.origins.push(Origin { work: number as u32, check: false, index: k, count });
        }
    }

    /// `count` checks of what the work made, each pass over all members under its own name.
    fn checks(&mut self, number: usize, work: &Work, members: &[u32], count: usize) {
        let (mut left, mut pass) = (count, 0);
        while left > 0 {
            let now = left.min(members.len());
            for k in 0..now {
                let length = (work.on.1 - work.on.0) / now as f64;
                let from = work.on.0 + length * (k + 1) as f64 + 540.0 * (pass + 1) as f64;
                let name = checks(work.trade)[pass % 3];
                let members = &members[piece(members.len(), now, k)];
                let span = (from, from + length.max(60.0));
                self.push(number, work, name, span, members, (k, now), ActivityKind::Neutral);
                let work = number as u32;
                self.origins.push(Origin { work, check: true, index: k, count: now });
            }
            left -= now;
            pass += 1;
        }
    }

    #[allow(clippy::too_many_arguments)]
    fn push(
        &mut self,
        number: usize,
        work: &Work,
        name: &str,
        span: Window,
        members: &[u32],
        (index, count): (usize, usize),
        kind: ActivityKind,
    ) {
        let total = self.calendar.total();
        let raster = |m: f64| (m.max(0.0) as i64) / RASTER * RASTER;
        let start = raster(span.0).min(total - RASTER);
        let end = raster(span.1).clamp(start + RASTER, total);
        let id = self.list.len() + 1;
        let storey = storey_code(work.storey);
        let part = if count > 1 { format!(" {}/{count}", index + 1) } else { String::new() };
        let what =
            if name == work.name { name.to_owned() } else { format!("{name}: {}", work.name) };
        self.list.push(Activity {
            id: format!("A{id:06}"),
            name: format!("{what}, {storey}{part}"),
            start: Some(self.calendar.start(start)),
            end: Some(self.calendar.end(end)),
            kind,
            active: work.active,
            elements: members.iter().map(|&m| self.names[m as usize].clone()).collect(),
            fields: [work.trade.to_owned(), storey, format!("{:04}.{:05}", number + 1, index + 1)]
                .into_iter()
                .zip(&self.fields)
                .map(|(value, name)| (name.clone(), value.into()))
                .collect(),
            ..Activity::default()
        });
    }
}

/// The schedule around finished activities.
pub(super) fn schedule(activities: Vec<Activity>, outline: Vec<WbsNode>) -> Schedule {
    let (start, end) = period();
    let schedule = Schedule {
        project: "Harbour Tower".to_owned(),
        period: TimeRange { start, end },
        data_date: Some(planning::data_date()),
        activities,
        wbs: outline,
        calendars: vec![site_calendar()],
        calendar: Some(0),
        ..Schedule::default()
    };
    schedule.revalidated()
}

/// When the site is open, as [`Calendar`] counts it.
fn site_calendar() -> topout_schedule::Calendar {
    let shift = Shift::new(START_SECONDS as u32, START_SECONDS as u32 + DAY_MINUTES as u32 * 60);
    let day = || shift.into_iter().collect();
    let closed = |year: i32, month, day| {
        let first = NaiveDate::from_ymd_opt(year, month, day);
        first.map(|first| CalendarException {
            first,
            last: if month == 12 { first + Days::new(7) } else { first },
            shifts: Vec::new(),
        })
    };
    let years = START.0..=START.0 + 3;
    topout_schedule::Calendar {
        name: "Site".to_owned(),
        week: [day(), day(), day(), day(), day(), Vec::new(), Vec::new()],
        exceptions: years.flat_map(|y| [closed(y, 1, 1), closed(y, 12, 24)]).flatten().collect(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn calendar_knows_evenings_weekends_and_the_end() {
        let calendar = Calendar::new();
        assert_eq!(calendar.start(0).to_string(), "2026-03-03T08:00:00");
        assert_eq!(calendar.end(540).to_string(), "2026-03-03T17:00:00");
        assert_eq!(calendar.start(540).to_string(), "2026-03-04T08:00:00");
        // Tuesday, Wednesday, Thursday, Friday, then Monday.
        assert_eq!(calendar.start(4 * 540).to_string(), "2026-03-09T08:00:00");
        assert_eq!(calendar.end(calendar.total()).to_string(), "2028-07-24T13:00:00");
        assert_eq!(period().1, calendar.end(calendar.total()));
    }

    #[test]
    fn the_schedule_says_when_the_site_is_open() {
        let (site, calendar) = (site_calendar(), Calendar::new());
        let days = &calendar.days[..calendar.days.len() - 1];
        for (day, next) in days.iter().zip(&calendar.days[1..]) {
            assert_eq!(site.next_work(day.plus_seconds(-60)), Some(*day));
            assert_eq!(site.next_work(day.plus_seconds(DAY_MINUTES * 60)), Some(*next));
        }
    }

    #[test]
    fn pieces_cover_everything_once() {
        for (len, count) in [(10, 3), (7, 7), (100, 1), (13, 5)] {
            let all: Vec<usize> = (0..count).flat_map(|k| piece(len, count, k)).collect();
            assert_eq!(all, (0..len).collect::<Vec<_>>());
            assert!((0..count).all(|k| !piece(len, count, k).is_empty()));
        }
    }
}
