//! Choosing a set of dates, and how much earlier or later one is than another.

mod support;

use std::path::PathBuf;
use support::*;
use topout_schedule::{Comparison, DateSet, Schedule, Severity, SlipClass, Totals, read_files};

const DAY: i64 = 86_400;

/// Monday to Friday from 8 to 17 with an hour's break, off from 21 December to 3 January.
const SITE: &str = r#"{"name": "Site", "week": {"mon": ["08:00-12:00", "13:00-17:00"],
    "tue": ["08:00-12:00", "13:00-17:00"], "wed": ["08:00-12:00", "13:00-17:00"],
    "thu": ["08:00-12:00", "13:00-17:00"], "fri": ["08:00-12:00", "13:00-17:00"]},
    "exceptions": [{"first": "2026-12-21", "last": "2027-01-03"}]}"#;

/// Activities by id with planned and actual start and end, where empty ones are not known.
fn plan(rows: &[(&str, [&str; 4])]) -> Schedule {
    let rows = rows.iter().map(|(id, dates)| {
        let names = ["planned_start", "planned_end", "actual_start", "actual_end"];
        let dates = names.iter().zip(dates).filter(|(_, date)| !date.is_empty());
        let dates: String = dates.map(|(name, date)| format!(", \"{name}\": \"{date}\"")).collect();
        format!("{{\"id\": \"{id}\", \"name\": \"task {id}\"{dates}}}")
    });
    let rows: Vec<String> = rows.collect();
    json(format!(
        "{{\"calendars\": [{SITE}], \"calendar\": 0, \"activities\": [{}]}}",
        rows.join(",\n")
    ))
}

fn built() -> Schedule {
    plan(&[
        ("same", ["2026-12-01T08:00", "2026-12-02T17:00", "2026-12-01T08:00", "2026-12-02T17:00"]),
        // Three days earlier by the clock, of which two are a weekend.
        ("early", ["2026-12-01T08:00", "2026-12-07T17:00", "2026-12-01T08:00", "2026-12-04T17:00"]),
        // Eighteen days later by the clock, and two working days.
        ("break", ["2026-12-14T08:00", "2026-12-18T17:00", "2026-12-14T08:00", "2027-01-05T17:00"]),
        ("long", ["2026-11-02T08:00", "2026-11-06T17:00", "2026-11-09T08:00", "2026-11-24T17:00"]),
        // An evening is as good as the next morning.
        ("hour", ["2026-12-01T08:00", "2026-12-02T17:00", "2026-12-01T08:00", "2026-12-03T08:00"]),
        ("begun", ["2026-12-01T08:00", "2026-12-02T17:00", "2026-12-03T08:00", ""]),
        ("never", ["2026-12-01T08:00", "2026-12-02T17:00", "", ""]),
        ("extra", ["", "", "2026-12-01T08:00", "2026-12-02T17:00"]),
    ])
}

fn slip(comparison: &Comparison, schedule: &Schedule, id: &str) -> topout_schedule::Slip {
    let at = schedule.activities.iter().position(|a| a.id == id).expect("an activity");
    *comparison.of_activity(at).expect("a slip")
}

#[test]
fn sets_of_one_schedule() {
    let schedule = built();
    let found = Comparison::of_sets(&schedule, DateSet::Planned, DateSet::Actual);
    let of = |id| {
        let s = slip(&found, &schedule, id);
        (s.start, s.end, s.working_days, s.class())
    };
    use SlipClass::{Earlier, Later, MuchLater, NoDate, OnTime};
    assert_eq!(of("same"), (Some(0), Some(0), 0.0, OnTime));
    assert_eq!(of("early"), (Some(0), Some(-3 * DAY), -1.0, Earlier));
    assert_eq!(of("break"), (Some(0), Some(18 * DAY), 2.0, Later));
    assert_eq!(of("long"), (Some(7 * DAY), Some(18 * DAY), 12.0, MuchLater));
    assert_eq!(of("hour"), (Some(0), Some(15 * 3600), 0.0, OnTime));
    assert_eq!(of("begun"), (Some(2 * DAY), None, 0.0, NoDate));
    assert_eq!(of("never"), (None, None, 0.0, NoDate));
    assert_eq!(of("extra"), (None, None, 0.0, NoDate));
    assert_eq!(found.totals, Totals { earlier: 1, on_time: 2, later: 2, missing: 3 });
    // Of -3, 0, 15 hours, 18, 18 days.
    assert_eq!(found.median_days, Some(0.625));
    assert_eq!(found.mean_days, Some((33.0 + 0.625) / 5.0));
    let movers: Vec<&str> =
        found.movers.iter().map(|&i| &*schedule.activities[found.slips[i].activity].id).collect();
    assert_eq!(movers, ["break", "long", "early", "hour", "begun"]);
    assert_eq!(found.largest().and_then(|s| s.end), Some(18 * DAY));
    assert!(found.added.is_empty() && found.removed.is_empty());

    // The other way round all is the other way round.
    let back = Comparison::of_sets(&schedule, DateSet::Actual, DateSet::Planned);
    assert_eq!(slip(&back, &schedule, "long").working_days, -12.0);
    assert_eq!(slip(&back, &schedule, "long").class(), SlipClass::MuchEarlier);
    assert_eq!(back.totals, Totals { earlier: 2, on_time: 2, later: 1, missing: 3 });
    let none = Comparison::of_sets(&schedule, DateSet::Planned, DateSet::Baseline);
    assert_eq!((none.totals.missing, none.median_days, none.movers.len()), (8, None, 0));
}

#[test]
fn limits_of_the_classes() {
    let of = |days| SlipClass::of(Some(days)).word();
    let days = [-5.1, -5.0, -0.51, -0.5, 0.0, 0.5, 0.51, 5.0, 5.1];
    let words = ["much earlier", "earlier", "earlier", "on time", "on time", "on time"];
    assert_eq!(days.map(of)[..6], words);
    assert_eq!(days.map(of)[6..], ["later", "later", "much later"]);
    assert_eq!(SlipClass::of(None).word(), "no date");
    for (word, class) in SlipClass::WORDS {
        assert_eq!(class.word(), word);
    }
}

#[test]
fn two_schedules() {
    let table = |rows: &str| csv(format!("id,name,start,end,code\n{rows}"));
    let older = table(
        "A,Walls,2026-03-02,2026-03-06,\nB,Roof,2026-03-09,2026-03-13,R1\n\
         C,Paint,2026-03-16,2026-03-20,\nD,Paint,2026-03-16,2026-03-20,\nE,Fence,2026-03-16,2026-03-20,\n",
    );
    let newer = table(
        "A,Other walls,2026-03-02,2026-03-09,\nX,Roof of slate,2026-03-06,2026-03-12,R1\n\
         Y,Paint,2026-03-16,2026-03-20,\nZ, Fence,2026-03-16,2026-03-20,\nN,Garden,2026-03-16,2026-03-20,\n",
    );
    let found = Comparison::of_schedules(&older, &newer);
    let pairs: Vec<(&str, &str, Option<i64>)> = (found.slips.iter())
        .map(|s| (&*older.activities[s.older].id, &*newer.activities[s.activity].id, s.end))
        .collect();
    // By id, by code, by name; Paint is two activities in the older schedule.
    assert_eq!(pairs, [("A", "A", Some(3 * DAY)), ("B", "X", Some(-DAY)), ("E", "Z", Some(0))]);
    assert_eq!((&found.added[..], &found.removed[..]), (&[2, 4][..], &[2, 3][..]));
    // Without a calendar Monday to Friday is worked: from Friday night to Monday night.
    assert_eq!(found.slips[0].working_days, 1.0);
    assert_eq!(found.of_activity(2), None);
    assert_eq!(Comparison::of_schedules(&newer, &newer).movers, Vec::<usize>::new());
}

#[test]
fn a_set_of_dates_is_shown() {
    let schedule = built().show(DateSet::Actual);
    let dates = |id: &str| (by_id(&schedule, id).start, by_id(&schedule, id).end);
    assert_eq!(dates("begun"), (Some(time("2026-12-03T08:00")), None));
    assert_eq!(dates("never"), (None, None));
    assert_eq!(dates("break").1, Some(time("2027-01-05T17:00")));
    assert_eq!(schedule.period.end, time("2027-01-05T17:00"));
    let found = schedule.diagnostics.get("no-dates-in-set").expect("a finding");
    assert_eq!((found.severity, found.count), (Severity::Warning, 2));
    assert_eq!(found.examples, ["begun", "never"]);
    assert_says(&found.message, &["plan.json: line", "has no end as actual"]);
    assert!(schedule.diagnostics.get("no-such-dates").is_none());
    // Back again: nothing is lost.
    let planned = schedule.show(DateSet::Planned);
    assert_eq!(by_id(&planned, "never").end, Some(time("2026-12-02T17:00")));
    assert_eq!(by_id(&planned, "extra").dates(), None);
}

#[test]
fn the_dates_of_plain_tables_are_planned() {
    let table = || csv("id,name,start,end\nA,a,2026-01-01,2026-01-02\n");
    let planned = table().show(DateSet::Planned);
    assert_eq!(planned.activities[0].dates(), table().activities[0].dates());
    assert_eq!(findings(&planned), []);
    let actual = table().show(DateSet::Actual);
    assert_eq!(findings(&actual), [("no-dates-in-set", 1), ("no-such-dates", 1)]);
    assert!(actual.diagnostics.has_errors());
    let again = actual.show(DateSet::Planned);
    assert_eq!(again.activities[0].dates(), table().activities[0].dates());
}

#[test]
fn flags_of_elements() {
    let schedule = csv("guid,task,start,finish,crew,flag\n\
         W1,T,2015-02-01,2015-02-02,A,On time\nW2,T,2015-02-01,2015-02-02,B,TOO LATE\n\
         W3,T,2015-02-01,2015-02-02,B,\nW1,U,2015-02-01,2015-02-02,B,early\n");
    let flags = Comparison::of_flags(&schedule).expect("flags");
    assert_eq!(&*flags.name, "flag");
    assert_eq!(flags.totals, Totals { earlier: 1, on_time: 1, later: 1, missing: 1 });
    let [t, u] = &flags.activities[..] else { panic!("two activities") };
    assert_eq!(t.elements, [SlipClass::OnTime, SlipClass::Later, SlipClass::NoDate]);
    assert_eq!((t.activity, t.totals.later, u.activity, u.totals.earlier), (0, 1, 1, 1));
    // A word that is none makes the column another.
    let text = "guid,task,start,finish,flag\nW1,T,2015-02-01,2015-02-02,On time\nW2,T,2015-02-01,2015-02-02,red\n";
    assert_eq!(Comparison::of_flags(&csv(text)), None);
}

/// 194 of 3,661 elements of tasks are late, in 8 of 72 tasks; there are no dates of what was built.
#[test]
fn flags_of_schependomlaan() {
    let Some(data) = std::env::var_os("TOPOUT_REAL_DATA").map(PathBuf::from) else {
        println!("skipped: TOPOUT_REAL_DATA is not set");
        return;
    };
    let folder = data.join("schependomlaan/eventlog");
    let read = |name| read_files(&[folder.join(name)], &Default::default()).expect("a log");
    let built = read("Schependomlaan eventlog as planned data incl as built data.csv");
    let flags = Comparison::of_flags(&built).expect("flags");
    assert_eq!(&*flags.name, "Element on time or not");
    assert_eq!(flags.totals, Totals { earlier: 0, on_time: 3467, later: 194, missing: 0 });
    assert_eq!(flags.activities.iter().filter(|a| a.totals.later > 0).count(), 8);
    // The model has other GUIDs; the links say which is which, and the flags stay.
    let log = folder.join("Schependomlaan eventlog as planned data incl as built data.csv");
    let files = [log, data.join("schependomlaan/links.csv")];
    let linked = read_files(&files, &Default::default()).expect("a log with links");
    let found = Comparison::of_flags(&linked).expect("flags");
    assert_eq!((found.totals.later, found.totals.on_time), (194, 3467));
    // The dates of both logs are the plan's.
    let plan = read("eventlog IFC schependomlaan.csv");
    assert_eq!(Comparison::of_flags(&plan), None);
    let found = Comparison::of_schedules(&plan, &built);
    assert_eq!(found.totals, Totals { on_time: 72, ..Totals::default() });
    assert_eq!((found.movers.len(), found.added.len(), found.removed.len()), (0, 0, 1));
    assert_eq!(plan.activities[found.removed[0]].name, "Afbouw");
}
