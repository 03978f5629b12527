//! Real schedules. They are looked for in the folder that TOPOUT_REAL_DATA names; without the
//! variable these tests say so and pass, with it a missing file is a failure.

use std::path::PathBuf;
use topout_schedule::{Activity, ReadOptions, Schedule, Severity, Time, read_files};

fn real_data() -> Option<PathBuf> {
    let folder = std::env::var_os("TOPOUT_REAL_DATA").map(PathBuf::from);
    if folder.is_none() {
        println!("skipped: TOPOUT_REAL_DATA is not set");
    }
    folder
}

fn read(files: &[PathBuf]) -> Schedule {
    read_files(files, &ReadOptions::default()).expect("a real schedule")
}

fn findings(schedule: &Schedule) -> Vec<(&'static str, Severity, usize)> {
    schedule.diagnostics.iter().map(|d| (d.code, d.severity, d.count)).collect()
}

/// 73 activities and 7,164 links, once in one JSON file and once in two tables, given in either
/// order: the same schedule.
#[test]
fn schependomlaan_reads_the_same_in_every_form() {
    let Some(data) = real_data() else { return };
    let folder = data.join("schependomlaan");
    let json = read(&[folder.join("schedule.json")]);
    let (table, links) = (folder.join("schedule.csv"), folder.join("links.csv"));
    let csv = read(&[table.clone(), links.clone()]);
    let links_first = read(&[links, table]);

    for schedule in [&json, &csv, &links_first] {
        assert_eq!(findings(schedule), vec![]);
        assert_eq!(schedule.activities.len(), 73);
        let links: usize = schedule.activities.iter().map(|a| a.elements.len()).sum();
        assert_eq!(links, 7_164);
        assert_eq!(schedule.period.start, Time::parse_iso("2015-02-26").expect("a date"));
        // The last activity ends with the day 2015-12-31.
        assert_eq!(schedule.period.end, Time::parse_iso("2016-01-01").expect("a date"));
        assert!(schedule.activities.iter().all(|a| a.dates().is_some()));
    }
    assert_eq!(json.project, "Schependomlaan");
    assert_eq!(csv.activities, links_first.activities);
    assert_eq!(by_id(&json), by_id(&csv));
}

/// The activities ordered by id, their elements by name.
fn by_id(schedule: &Schedule) -> Vec<Activity> {
    let mut all = schedule.activities.clone();
    all.sort_by(|a, b| a.id.cmp(&b.id));
    all.iter_mut().for_each(|a| a.elements.sort());
    all
}

/// A table written from a P6 export: dates with a space and without seconds, milestones without
/// length, columns that topout does not know.
#[test]
fn p6_table_keeps_its_columns() {
    let Some(data) = real_data() else { return };
    let schedule = read(&[data.join("schedules/MDL4D.csv")]);
    assert_eq!(findings(&schedule), vec![]);
    assert_eq!(schedule.activities.len(), 62);
    assert_eq!(schedule.period.start, Time::parse_iso("2023-07-23 08:00").expect("a date"));
    let start = &schedule.activities[0];
    assert_eq!((start.id.as_str(), start.name.as_str()), ("C0900", "House 1 Start"));
    assert_eq!(start.start, start.end);
    let field = |name: &str| start.fields.iter().find(|(n, _)| **n == *name).map(|(_, v)| &**v);
    assert_eq!(field("type"), Some("milestone"));
    assert_eq!(field("wbs"), Some("MDL4D.1"));
    assert_eq!(field("preds"), Some("104897:SS"));
}

/// 157 tasks of a Project plan, some without a name; its ids are numbers.
#[test]
fn project_table_reads() {
    let Some(data) = real_data() else { return };
    let schedule = read(&[data.join("schependomlaan/planning_mspdi.csv")]);
    assert_eq!(schedule.activities.len(), 157);
    assert!(!schedule.diagnostics.has_errors());
}

/// The planner's own log writes 26-2-2015, and a row for each element of each task: the same 73
/// activities, dates and links as in the tables that were made from it.
#[test]
fn event_log_reads() {
    let Some(data) = real_data() else { return };
    let folder = data.join("schependomlaan");
    let schedule = read(&[folder.join("eventlog/eventlog IFC schependomlaan.csv")]);
    let info = |code| (code, Severity::Info, 1);
    assert_eq!(findings(&schedule), [info("event-log"), info("guessed-dates")]);
    let tally = schedule.tally();
    assert_eq!((tally.activities, tally.elements, tally.without_dates), (73, 7166, 0));
    assert_eq!(schedule.period.start, Time::parse_iso("2015-02-26").expect("a date"));
    assert_eq!(schedule.period.end, Time::parse_iso("2016-01-01").expect("a date"));
    let table = read(&[folder.join("schedule.csv"), folder.join("links.csv")]);
    for (a, b) in by_id(&schedule).iter().zip(&by_id(&table)) {
        assert_eq!((a.name.trim(), a.start, a.end), (b.name.trim(), b.start, b.end));
    }
}

/// What was built late is said of elements only: 194 of 3,661 rows in 8 of 72 tasks. The other half
/// of the file is rows of nothing.
#[test]
fn event_log_of_what_was_built_reads() {
    let Some(data) = real_data() else { return };
    let log = "eventlog/Schependomlaan eventlog as planned data incl as built data.csv";
    let schedule = read(&[data.join("schependomlaan").join(log)]);
    let info = |code| (code, Severity::Info, 1);
    assert_eq!(findings(&schedule), [info("event-log"), info("guessed-dates")]);
    let tally = schedule.tally();
    assert_eq!((tally.activities, tally.elements, tally.without_dates), (72, 3661, 0));
    let mut late = Vec::new();
    for activity in &schedule.activities {
        let flag = |i| activity.element_field("Element on time or not", i);
        let count = |word| (0..activity.elements.len()).filter(|&i| flag(i) == Some(word)).count();
        assert_eq!(count("On time") + count("Too late"), activity.elements.len());
        late.extend(Some(count("Too late")).filter(|&n| n > 0));
    }
    assert_eq!((late.len(), late.iter().sum::<usize>()), (8, 194));
}

/// The same plan as Project wrote it: 157 tasks, 36 of them without a name, none of them a summary.
#[test]
fn project_plan_reads() {
    let Some(data) = real_data() else { return };
    let schedule = read(&[data.join("schependomlaan/planning_mspdi.xml")]);
    assert_eq!(findings(&schedule), vec![]);
    let tally = schedule.tally();
    assert_eq!((tally.activities, tally.without_name, tally.predecessors), (157, 36, 48));
    assert!(tally.flat_outline && tally.zero_duration > 0);
    assert_eq!(schedule.project, "Schependomlaan Nijmegen");
    // Like the table that was made from it, row by row.
    let table = read(&[data.join("schependomlaan/planning_mspdi.csv")]);
    for (a, row) in schedule.activities.iter().zip(&table.activities) {
        assert_eq!((a.name.trim(), a.start, a.end), (row.name.as_str(), row.start, row.end));
    }
    assert_eq!(schedule.calendars.len(), 4);
    let calendar = &schedule.calendars[schedule.calendar.expect("the project's") as usize];
    assert_eq!(calendar.name, "Prognosekalender verlof / rv / vv");
    assert_eq!(calendar.week.each_ref().map(Vec::len), [1, 1, 1, 1, 1, 0, 0]);
}

/// 62 activities and 87 links, as P6 exports them.
#[test]
fn p6_export_reads() {
    let Some(data) = real_data() else { return };
    let schedule = read(&[data.join("schedules/MDL4D.xer")]);
    assert_eq!(findings(&schedule), vec![("guessed-encoding", Severity::Info, 1)]);
    let tally = schedule.tally();
    assert_eq!((tally.activities, tally.predecessors, tally.summaries), (62, 87, 7));
    assert_eq!((schedule.project.as_str(), tally.calendars), ("MDL4D", 3));
    let table = read(&[data.join("schedules/MDL4D.csv")]);
    for (a, row) in schedule.activities.iter().zip(&table.activities) {
        assert_eq!((&a.id, &a.name, a.start, a.end), (&row.id, &row.name, row.start, row.end));
    }
    let path = schedule.wbs_path(&schedule.activities[0]);
    assert_eq!(path, ["CPLEX Model 4 Resourse allocation and dates uploaded", "Milestones"]);
    // Seven days a week, eight hours, but for holidays.
    let calendar = &schedule.calendars[schedule.calendar.expect("the project's") as usize];
    assert!(calendar.week.iter().all(|day| day.len() == 1 && !calendar.exceptions.is_empty()));
}

/// buildingSMART's example: 8 tasks, 3 of them summaries, 7 sequences, 6 products.
#[test]
fn ifc_example_reads() {
    let Some(data) = real_data() else { return };
    let schedule = read(&[data.join("ifc4_task/construction_scheduling_task.ifc")]);
    assert_eq!(findings(&schedule), vec![]);
    let tally = schedule.tally();
    assert_eq!((tally.activities, tally.predecessors, tally.elements), (8, 7, 6));
    assert_eq!(tally.summaries, 3);
    assert_eq!(schedule.project, "example project");
    let wall = schedule.activities.iter().find(|a| a.name == "Wall #1").expect("a wall");
    assert_eq!(wall.id, "0Kq8RwbZH3afCy87RX8dso");
    assert_eq!(wall.elements, ["26tmERtwL8G8UQn5BoglEh"]);
    assert_eq!(wall.start, Some(Time::parse_iso("2010-09-21T08:00:00").expect("a date")));
    assert_eq!(schedule.wbs_path(wall), ["Ground Level", "Wall (Standard)"]);
}
