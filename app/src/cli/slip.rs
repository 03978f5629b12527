//! What `topout check` says of dates that moved.

use crate::report::{columns, count, rounded};
use serde::Serialize;
use std::fmt::Write;
use topout_schedule::{Comparison, Flags, Schedule, Totals};

/// Movers in the JSON; the figures beside them count all.
const LISTED: usize = 100;
/// Movers on the terminal.
const SHOWN: usize = 10;

/// The keys that scripts read: how much later what is compared is.
#[derive(Serialize, Debug)]
pub struct SlipReport {
    from: String,
    to: String,
    earlier: usize,
    on_time: usize,
    later: usize,
    missing: usize,
    /// Of the ends that are known, days of 24 hours.
    median_days: Option<f64>,
    mean_days: Option<f64>,
    /// How many activities start or end at another time; `movers` lists the first of them.
    moved: usize,
    /// How many only one of two schedules has.
    added: usize,
    removed: usize,
    movers: Vec<Mover>,
}

/// An activity that starts or ends at another time; days of 24 hours, later is positive.
#[derive(Serialize, Debug)]
struct Mover {
    id: String,
    name: String,
    start_days: Option<f64>,
    end_days: Option<f64>,
    working_days: Option<f64>,
}

impl SlipReport {
    /// `from` and `to`: names of what was compared; `schedule` is the newer one.
    pub fn of(found: &Comparison, schedule: &Schedule, from: String, to: String) -> Self {
        let days = |seconds: Option<i64>| seconds.map(|s| rounded(s as f64 / 86_400.0, 3));
        let mover = |&at: &usize| {
            let slip = found.slips[at];
            let activity = &schedule.activities[slip.activity];
            Mover {
                id: activity.id.clone(),
                name: activity.name.clone(),
                start_days: days(slip.start),
                end_days: days(slip.end),
                working_days: (!slip.missing).then(|| rounded(slip.working_days, 3)),
            }
        };
        let Totals { earlier, on_time, later, missing } = found.totals;
        Self {
            from,
            to,
            earlier,
            on_time,
            later,
            missing,
            median_days: found.median_days.map(|d| rounded(d, 3)),
            mean_days: found.mean_days.map(|d| rounded(d, 3)),
            moved: found.movers.len(),
            added: found.added.len(),
            removed: found.removed.len(),
            movers: found.movers.iter().take(LISTED).map(mover).collect(),
        }
    }

    /// For people: totals and the largest movers.
    pub fn text(&self) -> String {
        let mut text = format!("Slip        {} to {}\n", self.from, self.to);
        let mut row = |key: &str, value: String| {
            let _ = writeln!(text, "  {key:<16}{value}");
        };
        row(
            "activities",
            format!(
                "{} earlier, {} on time, {} later, {} without a date",
                count(self.earlier),
                count(self.on_time),
                count(self.later),
                count(self.missing)
            ),
        );
        if self.added + self.removed > 0 {
            row("only in one", format!("{} new, {} gone", count(self.added), count(self.removed)));
        }
        if let (Some(median), Some(mean)) = (self.median_days, self.mean_days) {
            row(
                "end",
                format!("{} days in the median, {} on average", signed(median), signed(mean)),
            );
        }
        if self.movers.is_empty() {
            return text;
        }
        let cell = |days: Option<f64>| days.map_or_else(|| "-".to_owned(), signed);
        let mut rows =
            vec![["  moved most", "start", "end", "working days"].map(str::to_owned).to_vec()];
        for mover in self.movers.iter().take(SHOWN) {
            let name: String = mover.name.trim().chars().take(40).collect();
            let days = [mover.start_days, mover.end_days, mover.working_days].map(cell);
            rows.push([vec![format!("  {} {name}", mover.id)], days.to_vec()].concat());
        }
        text.push_str(&columns(&rows));
        if self.moved > SHOWN {
            let _ = writeln!(text, "  and {} more", count(self.moved - SHOWN));
        }
        text
    }
}

fn signed(days: f64) -> String {
    match rounded(days, 1) {
        0.0 => "0".to_owned(),
        days => format!("{days:+}"),
    }
}

/// The keys that scripts read: what an event log says of its elements being on time.
#[derive(Serialize, Debug)]
pub struct FlagsReport {
    name: String,
    earlier: usize,
    on_time: usize,
    later: usize,
    missing: usize,
    /// Those of which an element is earlier or later.
    activities: Vec<FlaggedActivity>,
}

#[derive(Serialize, Debug)]
struct FlaggedActivity {
    id: String,
    name: String,
    earlier: usize,
    on_time: usize,
    later: usize,
    missing: usize,
}

impl FlagsReport {
    /// Of the flags of a schedule.
    pub fn of(flags: &Flags, schedule: &Schedule) -> Self {
        let Totals { earlier, on_time, later, missing } = flags.totals;
        let activities = flags.activities.iter().filter(|a| a.totals.earlier + a.totals.later > 0);
        let activities = activities.map(|flagged| {
            let Totals { earlier, on_time, later, missing } = flagged.totals;
            let activity = &schedule.activities[flagged.activity];
            let (id, name) = (activity.id.clone(), activity.name.clone());
            FlaggedActivity { id, name, earlier, on_time, later, missing }
        });
        let activities = activities.collect();
        Self { name: flags.name.to_string(), earlier, on_time, later, missing, activities }
    }

    /// For people.
    pub fn text(&self) -> String {
        format!(
            "Elements    {}\n  {:<16}{}, in {} activities\n  {:<16}{}\n  {:<16}{}\n  {:<16}{}\n",
            self.name,
            "later",
            count(self.later),
            count(self.activities.iter().filter(|a| a.later > 0).count()),
            "on time",
            count(self.on_time),
            "earlier",
            count(self.earlier),
            "not said",
            count(self.missing),
        )
    }
}
