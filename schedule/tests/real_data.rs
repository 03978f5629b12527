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
    let field = |name: &str| start.fields.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_str());
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

/// The planner's own log writes 26-2-2015. Its columns are not a schedule's; the message says so.
#[test]
fn event_log_is_refused_by_its_columns() {
    let Some(data) = real_data() else { return };
    let file = data.join("schependomlaan/eventlog/eventlog IFC schependomlaan.csv");
    let error = read_files(&[file], &ReadOptions::default()).expect_err("no schedule");
    let message = error.to_string();
    assert!(message.contains("lacks id, name, start, end"), "{message}");
    assert!(message.contains("TaskStart"), "{message}");
}
