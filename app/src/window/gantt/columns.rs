//! The columns beside the bars, and which of them are shown.

use super::super::calendar::{DAY, day_date};
use super::super::loading::Project;
use serde::{Deserialize, Serialize};
use topout_schedule::{Activity, Calendar, Schedule};

/// A column: name, first width (points), and what of an activity stands in it.
pub struct Column {
    /// Its heading.
    pub name: &'static str,
    /// What the heading means.
    pub tip: &'static str,
    /// Points, until the user drags it.
    pub width: f32,
    /// Of an activity, given by its place in the schedule.
    pub text: fn(&Project, usize) -> String,
}

fn of(project: &Project, activity: usize) -> &Activity {
    &project.scene.schedule.activities[activity]
}

/// Every column.
pub const COLUMNS: [Column; 9] = [
    Column {
        name: "Id",
        tip: "As the schedule has it",
        width: 84.0,
        text: |p, a| of(p, a).id.clone(),
    },
    Column {
        name: "Start",
        tip: "By the dates that are shown",
        width: 84.0,
        text: |p, a| of(p, a).start.map(day_date).unwrap_or_default(),
    },
    Column {
        name: "Finish",
        tip: "By the dates that are shown",
        width: 84.0,
        text: |p, a| of(p, a).end.map(day_date).unwrap_or_default(),
    },
    Column {
        name: "Days",
        tip: "From start to finish, days off counted too",
        width: 44.0,
        text: |p, a| of(p, a).dates().map(|d| days(d.seconds())).unwrap_or_default(),
    },
    Column {
        name: "Done",
        tip: "How much is complete",
        width: 44.0,
        text: |p, a| of(p, a).percent_complete.map(|p| format!("{p:.0} %")).unwrap_or_default(),
    },
    Column {
        name: "Slack",
        tip: "Days of work by which it can be later before the project ends later",
        width: 48.0,
        text: |p, a| slack_days(p, a).map(|days| format!("{days:.1}")).unwrap_or_default(),
    },
    Column {
        name: "Kind",
        tip: "What it does to its elements",
        width: 76.0,
        text: |p, a| p.scene.schedule.kinds.of(of(p, a).kind).name.clone(),
    },
    Column {
        name: "Elements",
        tip: "Elements of the model that are linked to it",
        width: 58.0,
        text: |p, a| p.plan.elements_of(a).len().to_string(),
    },
    Column {
        name: "Waits for",
        tip: "Its predecessors, with the kind of link",
        width: 120.0,
        text: |p, a| predecessors(&p.scene.schedule, of(p, a)),
    },
];

/// Which columns are shown.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
pub struct Columns(u16);

impl Default for Columns {
    /// The first five.
    fn default() -> Self {
        Self(0b1_1111)
    }
}

impl Columns {
    /// Whether a column is shown, given by its place in [`COLUMNS`].
    pub fn has(self, column: usize) -> bool {
        self.0 >> column & 1 == 1
    }

    /// With that column shown, or not.
    #[must_use]
    pub fn with(self, column: usize, shown: bool) -> Self {
        let bit = 1 << column;
        Self(if shown { self.0 | bit } else { self.0 & !bit })
    }

    /// The places of those that are shown.
    pub fn shown(self) -> impl Iterator<Item = usize> {
        (0..COLUMNS.len()).filter(move |column| self.has(*column))
    }

    /// Tells choices apart, so that each has widths of its own.
    pub fn key(self) -> u16 {
        self.0
    }
}

/// Civil days, with a half where there is one.
pub fn days(seconds: i64) -> String {
    let days = seconds as f64 / DAY as f64;
    if days >= 10.0 || days.fract() < 0.05 { format!("{days:.0}") } else { format!("{days:.1}") }
}

/// Slack in working days of the activity's calendar, in days of the clock where it has none.
pub fn slack_days(project: &Project, activity: usize) -> Option<f64> {
    let seconds = project.plan.slack(activity)?;
    let schedule = &project.scene.schedule;
    let calendar = of(project, activity).calendar.or(schedule.calendar);
    let day = calendar.and_then(|c| schedule.calendars.get(c as usize)).map_or(DAY, working_day);
    Some(seconds as f64 / day as f64)
}

/// Seconds worked on the longest day of the week.
fn working_day(calendar: &Calendar) -> i64 {
    let of_day = |shifts: &Vec<topout_schedule::Shift>| {
        shifts.iter().map(|shift| i64::from(shift.end() - shift.start())).sum::<i64>()
    };
    calendar.week.iter().map(of_day).max().filter(|day| *day > 0).unwrap_or(DAY)
}

/// `A10 FS, A12 SS`; the first few.
fn predecessors(schedule: &Schedule, activity: &Activity) -> String {
    const NAMED: usize = 4;
    let links = activity.predecessors.iter().take(NAMED);
    let one = |link: &topout_schedule::Predecessor| {
        let id = schedule.activities.get(link.activity as usize).map_or("?", |a| &a.id);
        format!("{id} {}", link.kind.word())
    };
    let mut text = links.map(one).collect::<Vec<_>>().join(", ");
    if activity.predecessors.len() > NAMED {
        text += ", …";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use topout_schedule::Shift;

    #[test]
    fn columns_are_shown_one_by_one() {
        let columns = Columns::default();
        assert_eq!(columns.shown().collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
        let other = columns.with(0, false).with(8, true).with(8, true);
        assert_eq!(other.shown().collect::<Vec<_>>(), [1, 2, 3, 4, 8]);
        assert_ne!(columns.key(), other.key());
        assert_eq!(other.with(0, true).with(8, false), columns);
    }

    #[test]
    fn a_day_of_work_is_the_longest_of_the_week() {
        let shift = |from: u32, to: u32| Shift::new(from * 3600, to * 3600);
        let mut calendar = Calendar::default();
        assert_eq!(working_day(&calendar), DAY, "nobody ever works by it");
        calendar.week[0] = [shift(8, 12), shift(13, 17)].into_iter().flatten().collect();
        calendar.week[5] = shift(8, 12).into_iter().collect();
        assert_eq!(working_day(&calendar), 8 * 3600);
    }
}
