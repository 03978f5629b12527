//! How much earlier or later activities are in one set of dates, or in one schedule, than in another.

use crate::workdays::WorkDays;
use crate::{Activity, DateSet, Dates, Schedule, Time};
use std::collections::HashMap;
use std::sync::Arc;

const DAY_SECONDS: f64 = 86_400.0;

/// How much earlier or later something is, in classes that have a colour each.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum SlipClass {
    /// More than a working week (5 working days) earlier.
    MuchEarlier,
    /// More than half a working day earlier.
    Earlier,
    /// Within half a working day: what one planner writes as an evening is another's next morning.
    OnTime,
    /// More than half a working day later.
    Later,
    /// More than a working week (5 working days) later.
    MuchLater,
    /// One of the two dates is not known.
    NoDate,
}

impl SlipClass {
    /// Working days up to which something is on time.
    pub const ON_TIME_WORKING_DAYS: f64 = 0.5;
    /// Working days beyond which something is much earlier or later.
    pub const MUCH_WORKING_DAYS: f64 = 5.0;

    /// All classes in order, with the words for them.
    pub const WORDS: [(&'static str, SlipClass); 6] = [
        ("much earlier", SlipClass::MuchEarlier),
        ("earlier", SlipClass::Earlier),
        ("on time", SlipClass::OnTime),
        ("later", SlipClass::Later),
        ("much later", SlipClass::MuchLater),
        ("no date", SlipClass::NoDate),
    ];

    /// The class of a slip in working days, positive for later.
    pub fn of(working_days: Option<f64>) -> Self {
        let Some(days) = working_days else { return Self::NoDate };
        let much = days.abs() > Self::MUCH_WORKING_DAYS;
        match (days.abs() > Self::ON_TIME_WORKING_DAYS, days < 0.0) {
            (false, _) => Self::OnTime,
            (true, true) if much => Self::MuchEarlier,
            (true, true) => Self::Earlier,
            (true, false) if much => Self::MuchLater,
            (true, false) => Self::Later,
        }
    }

    /// The word for it.
    pub fn word(self) -> &'static str {
        Self::WORDS[self as usize].0
    }
}

/// How much earlier or later one activity is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Slip {
    /// Which activity: index in the schedule, of two schedules in the newer one.
    pub activity: usize,
    /// The same activity in the older one of two schedules.
    pub older: usize,
    /// Seconds by which it starts later, negative for earlier; `None` where a start is not known.
    pub start: Option<i64>,
    /// Seconds by which it ends later, negative for earlier; `None` where an end is not known.
    pub end: Option<i64>,
    /// Working days by which it ends later, by its calendar; 0 where an end is not known.
    pub working_days: f64,
    /// One of the two ends is not known.
    pub missing: bool,
}

impl Slip {
    /// The class by its end.
    pub fn class(&self) -> SlipClass {
        SlipClass::of((!self.missing).then_some(self.working_days))
    }
}

/// All slips in a few figures.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Totals {
    /// Activities, or elements, that are [`SlipClass::Earlier`] or [`SlipClass::MuchEarlier`].
    pub earlier: usize,
    /// Those that are [`SlipClass::OnTime`].
    pub on_time: usize,
    /// Those that are [`SlipClass::Later`] or [`SlipClass::MuchLater`].
    pub later: usize,
    /// Those of which one of the two dates is not known.
    pub missing: usize,
}

impl Totals {
    /// Counts one more.
    pub fn add(&mut self, class: SlipClass) {
        match class {
            SlipClass::MuchEarlier | SlipClass::Earlier => self.earlier += 1,
            SlipClass::OnTime => self.on_time += 1,
            SlipClass::Later | SlipClass::MuchLater => self.later += 1,
            SlipClass::NoDate => self.missing += 1,
        }
    }
}

/// What differs between two sets of dates, or two schedules.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Comparison {
    /// One for each activity that is in both, in the order of the (newer) schedule.
    pub slips: Vec<Slip>,
    /// How many are earlier and later.
    pub totals: Totals,
    /// The median slip of the ends that are known, in days of 24 hours.
    pub median_days: Option<f64>,
    /// Their mean, in days of 24 hours.
    pub mean_days: Option<f64>,
    /// Indices in `slips` of what starts or ends at another time, those whose ends differ most first;
    /// of equal ones by id.
    pub movers: Vec<usize>,
    /// Activities of the newer schedule that the older one has not.
    pub added: Vec<usize>,
    /// Activities of the older schedule that the newer one has not.
    pub removed: Vec<usize>,
}

impl Comparison {
    /// Compares two sets of dates that one schedule has: how much later than `from` is `to`?
    ///
    /// Dates are those of [`Activity::dates_of`]; an activity that a set does not know is missing.
    pub fn of_sets(schedule: &Schedule, from: DateSet, to: DateSet) -> Comparison {
        let mut counter = Counter::of(schedule);
        let slips = schedule.activities.iter().enumerate().map(|(i, activity)| {
            counter.slip(activity, (i, activity.dates_of(from)), (i, activity.dates_of(to)))
        });
        let slips = slips.collect();
        Comparison { slips, ..Comparison::default() }.completed(schedule)
    }

    /// Compares the dates that count in two schedules: how much later than in `older` is `newer`?
    ///
    /// Activities are the same if they have one id; of the others, if they have a code (a field
    /// `code`), and then a name, that no other of them has in either schedule. The working days are
    /// those of the newer schedule.
    pub fn of_schedules(older: &Schedule, newer: &Schedule) -> Comparison {
        let same = matched(&older.activities, &newer.activities);
        let mut counter = Counter::of(newer);
        let mut result = Comparison::default();
        let mut found = vec![false; older.activities.len()];
        for (i, activity) in newer.activities.iter().enumerate() {
            let Some(was) = same[i] else {
                result.added.push(i);
                continue;
            };
            found[was] = true;
            let counts = |a: &Activity| Dates { start: a.start, end: a.end };
            let before = counts(&older.activities[was]);
            result.slips.push(counter.slip(activity, (was, before), (i, counts(activity))));
        }
        result.removed = (0..found.len()).filter(|&i| !found[i]).collect();
        result.completed(newer)
    }

    /// The slip of an activity of the (newer) schedule.
    pub fn of_activity(&self, activity: usize) -> Option<&Slip> {
        let at = self.slips.binary_search_by_key(&activity, |slip| slip.activity).ok()?;
        self.slips.get(at)
    }

    /// The largest slip of an end, if anything moved.
    pub fn largest(&self) -> Option<&Slip> {
        self.slips.get(*self.movers.first()?)
    }

    fn completed(mut self, schedule: &Schedule) -> Self {
        let mut ends: Vec<i64> = Vec::with_capacity(self.slips.len());
        for (i, slip) in self.slips.iter().enumerate() {
            self.totals.add(slip.class());
            ends.extend(slip.end);
            if slip.start.unwrap_or(0) != 0 || slip.end.unwrap_or(0) != 0 {
                self.movers.push(i);
            }
        }
        self.movers.sort_by_key(|&i| {
            let slip = &self.slips[i];
            let id = &schedule.activities[slip.activity].id;
            (std::cmp::Reverse(slip.end.map(i64::unsigned_abs)), id)
        });
        if !ends.is_empty() {
            ends.sort_unstable();
            let days = |seconds: i64| seconds as f64 / DAY_SECONDS;
            let (low, high) = (ends[(ends.len() - 1) / 2], ends[ends.len() / 2]);
            self.median_days = Some((days(low) + days(high)) / 2.0);
            self.mean_days = Some(ends.iter().map(|&s| days(s)).sum::<f64>() / ends.len() as f64);
        }
        self
    }
}

/// Counts working days by the calendars of a schedule.
struct Counter<'a> {
    schedule: &'a Schedule,
    calendars: HashMap<Option<u32>, WorkDays<'a>>,
}

impl<'a> Counter<'a> {
    fn of(schedule: &'a Schedule) -> Self {
        Self { schedule, calendars: HashMap::new() }
    }

    fn slip(
        &mut self,
        activity: &Activity,
        (older, from): (usize, Dates),
        (index, to): (usize, Dates),
    ) -> Slip {
        let seconds = |from: Option<Time>, to: Option<Time>| {
            Some(to?.seconds().saturating_sub(from?.seconds()))
        };
        let working_days = from.end.zip(to.end).map(|(from, to)| {
            let calendar = activity.calendar.or(self.schedule.calendar);
            let days = self.calendars.entry(calendar).or_insert_with(|| {
                WorkDays::new(calendar.and_then(|c| self.schedule.calendars.get(c as usize)))
            });
            days.between(from, to)
        });
        Slip {
            activity: index,
            older,
            start: seconds(from.start, to.start),
            end: seconds(from.end, to.end),
            working_days: working_days.unwrap_or_default(),
            missing: working_days.is_none(),
        }
    }
}

/// Which of the older activities each newer one is.
fn matched(older: &[Activity], newer: &[Activity]) -> Vec<Option<usize>> {
    let by_id: HashMap<&str, usize> =
        older.iter().enumerate().rev().map(|(i, a)| (a.id.as_str(), i)).collect();
    let mut same: Vec<Option<usize>> = vec![None; newer.len()];
    let mut taken = vec![false; older.len()];
    for (i, activity) in newer.iter().enumerate() {
        let was = by_id.get(activity.id.as_str()).copied().filter(|&was| !taken[was]);
        if let Some(was) = was {
            (same[i], taken[was]) = (Some(was), true);
        }
    }
    let code = |a: &Activity| {
        let field = a.fields.iter().find(|(name, _)| name.eq_ignore_ascii_case("code"));
        field.map(|(_, value)| value.trim().to_owned())
    };
    let name = |a: &Activity| Some(a.name.trim().to_owned());
    for key in [&code as &dyn Fn(&Activity) -> Option<String>, &name] {
        let unique = |all: &[Activity], left: &dyn Fn(usize) -> bool| {
            let mut places: HashMap<String, Option<usize>> = HashMap::new();
            for (i, activity) in all.iter().enumerate().filter(|&(i, _)| left(i)) {
                if let Some(key) = key(activity).filter(|key| !key.is_empty()) {
                    places.entry(key).and_modify(|place| *place = None).or_insert(Some(i));
                }
            }
            places
        };
        let before = unique(older, &|i| !taken[i]);
        for (key, i) in unique(newer, &|i| same[i].is_none()) {
            if let (Some(i), Some(Some(was))) = (i, before.get(&key)) {
                (same[i], taken[*was]) = (Some(*was), true);
            }
        }
    }
    same
}

/// What a file says of single elements being on time, where it has no dates of what was built.
#[derive(Clone, PartialEq, Debug)]
pub struct Flags {
    /// The column that says it.
    pub name: Arc<str>,
    /// How many elements are on time, all activities taken together; an element of several
    /// activities counts in each.
    pub totals: Totals,
    /// One for each activity that has elements.
    pub activities: Vec<ActivityFlags>,
}

/// What is said of the elements of one activity.
#[derive(Clone, PartialEq, Debug)]
pub struct ActivityFlags {
    /// Index in the schedule.
    pub activity: usize,
    /// How many of its elements are on time.
    pub totals: Totals,
    /// One class an element: earlier, on time, later or no date.
    pub elements: Vec<SlipClass>,
}

/// Words for being on time, in whatever case.
const FLAGS: [(&str, SlipClass); 14] = [
    ("on time", SlipClass::OnTime),
    ("in time", SlipClass::OnTime),
    ("on schedule", SlipClass::OnTime),
    ("op tijd", SlipClass::OnTime),
    ("too late", SlipClass::Later),
    ("late", SlipClass::Later),
    ("later", SlipClass::Later),
    ("delayed", SlipClass::Later),
    ("behind schedule", SlipClass::Later),
    ("te laat", SlipClass::Later),
    ("too early", SlipClass::Earlier),
    ("early", SlipClass::Earlier),
    ("earlier", SlipClass::Earlier),
    ("ahead of schedule", SlipClass::Earlier),
];

/// The class that a flag names; `None` for other words, no date for no word.
fn flag(text: &str) -> Option<SlipClass> {
    let text = text.trim();
    if text.is_empty() {
        return Some(SlipClass::NoDate);
    }
    FLAGS.iter().find(|(word, _)| word.eq_ignore_ascii_case(text)).map(|&(_, class)| class)
}

impl Comparison {
    /// Takes what an event log says of its elements ("On time", "Too late") for a comparison: the
    /// first column all of whose values say such things. `None` where no column does.
    pub fn of_flags(schedule: &Schedule) -> Option<Flags> {
        let name = flag_column(&schedule.activities)?;
        let mut flags = Flags { name, totals: Totals::default(), activities: Vec::new() };
        let with_elements = schedule.activities.iter().enumerate();
        for (i, activity) in with_elements.filter(|(_, a)| !a.elements.is_empty()) {
            let mut totals = Totals::default();
            let mut elements = Vec::with_capacity(activity.elements.len());
            for element in 0..activity.elements.len() {
                let text = activity.element_field(&flags.name, element).unwrap_or_default();
                let class = flag(text).unwrap_or(SlipClass::NoDate);
                totals.add(class);
                flags.totals.add(class);
                elements.push(class);
            }
            flags.activities.push(ActivityFlags { activity: i, totals, elements });
        }
        Some(flags)
    }
}

/// The first name under which nothing but flags stands, and at least one.
fn flag_column(activities: &[Activity]) -> Option<Arc<str>> {
    let mut columns = Vec::new();
    let mut places = HashMap::new();
    for activity in activities.iter().filter(|a| !a.elements.is_empty()) {
        let fields = activity.fields.iter().map(|(name, value)| (name, flag(value)));
        for (name, class) in fields {
            see(name, class, &mut columns, &mut places);
        }
        for field in &activity.element_fields {
            for value in &field.values {
                see(&field.name, flag(value), &mut columns, &mut places);
            }
        }
    }
    columns.into_iter().find(|c| c.some && !c.others).map(|c| c.name.clone())
}

/// What values a column has.
struct Seen<'a> {
    name: &'a Arc<str>,
    /// A flag.
    some: bool,
    /// Something else.
    others: bool,
}

fn see<'a>(
    name: &'a Arc<str>,
    class: Option<SlipClass>,
    columns: &mut Vec<Seen<'a>>,
    places: &mut HashMap<&'a str, usize>,
) {
    let place = *places.entry(name).or_insert(columns.len());
    if place == columns.len() {
        columns.push(Seen { name, some: false, others: false });
    }
    let seen = &mut columns[place];
    seen.some |= class.is_some_and(|class| class != SlipClass::NoDate);
    seen.others |= class.is_none();
}
