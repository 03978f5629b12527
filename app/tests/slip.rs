//! Dates that moved, as `topout check` tells them, and sets of dates on the command line.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Folder, number, text, topout};
use std::path::PathBuf;

/// Two cubes: the slab's end slips from a Friday over a weekend to a Monday, and the wall has no
/// actual dates yet.
fn project(folder: &Folder) -> [String; 3] {
    let model = folder.cubes("house.glb", &["slab", "wall"]);
    let schedule = folder.write(
        "plan.json",
        r#"{"activities": [
            {"id": "A1", "name": "Slab", "elements": ["slab"],
             "planned_start": "2026-03-02", "planned_end": "2026-03-06",
             "actual_start": "2026-03-02", "actual_end": "2026-03-09"},
            {"id": "A2", "name": "Wall", "elements": ["wall"],
             "planned_start": "2026-03-10", "planned_end": "2026-03-13"}]}"#,
    );
    [model, "--schedule".to_owned(), schedule]
}

fn check(project: &[String], more: &[&str]) -> common::Run {
    let words = ["check"].into_iter().chain(project.iter().map(String::as_str));
    topout(words.chain(more.iter().copied()))
}

#[test]
fn sets_are_compared() {
    let folder = Folder::new();
    let project = project(&folder);
    let report = check(&project, &["--compare", "planned,actual", "--json", "-"]).good_json();
    let slip = &report["slip"];
    assert_eq!((&slip["from"], &slip["to"]), (&"planned".into(), &"actual".into()));
    for (key, expected) in
        [("earlier", 0.0), ("on_time", 0.0), ("later", 1.0), ("missing", 1.0), ("median_days", 3.0)]
    {
        assert_eq!(number(slip, key), expected, "{key}");
    }
    let expected = serde_json::json!([{"id": "A1", "name": "Slab", "start_days": 0.0,
        "end_days": 3.0, "working_days": 1.0}]);
    assert_eq!(slip["movers"], expected);

    let shown = check(&project, &["--compare", "actual,planned"]);
    assert_eq!(shown.code, 0, "{}", shown.stderr);
    for said in ["actual to planned", "1 earlier, 0 on time, 0 later, 1 without", "A1 Slab", "-3"] {
        assert!(shown.stdout.contains(said), "{said:?} in {}", shown.stdout);
    }
    let plain = check(&project, &["--json", "-"]).good_json();
    assert!(plain.get("slip").is_none() && plain.get("flags").is_none());
}

#[test]
fn schedules_are_compared() {
    let folder = Folder::new();
    let project = project(&folder);
    let older = folder.write(
        "older.csv",
        "id,name,start,end\nA1,Slab,2026-03-02,2026-03-06\nX,Fence,2026-03-02,2026-03-06\n",
    );
    let slip = &check(&project, &["--against", &older, "--json", "-"]).good_json()["slip"];
    assert_eq!((&slip["from"], &slip["to"]), (&older.into(), &project[2].clone().into()));
    assert_eq!((number(slip, "added"), number(slip, "removed")), (1.0, 1.0));
    assert_eq!(slip["movers"][0]["end_days"], 3.0);
    let missing = check(&project, &["--against", "no/such/plan.csv"]);
    assert_eq!(missing.code, 1);
    assert!(missing.stderr.contains("no/such/plan.csv"), "{}", missing.stderr);
}

#[test]
fn one_set_of_dates_is_loaded() {
    let folder = Folder::new();
    let project = project(&folder);
    let report = |dates: &str| check(&project, &["--dates", dates, "--json", "-"]);
    let planned = report("planned").good_json();
    assert_eq!(planned["diagnostics"].as_array().map(Vec::len), Some(0));
    assert_eq!(planned["behaviours"]["installed"], 1, "{planned}");
    let actual = report("actual").good_json();
    assert_eq!(actual["diagnostics"][0]["code"], "no-dates-in-set");
    assert_eq!(actual["diagnostics"][0]["examples"][0], "A2");
    // Nothing is known of when it was agreed to be built: an error.
    let baseline = report("baseline");
    assert_eq!(baseline.code, 1);
    let codes = baseline.json()["diagnostics"].to_string();
    assert!(codes.contains("no-such-dates"), "{codes}");
}

/// The log of what was built, in Nijmegen in 2015: flags of elements, and no dates.
#[test]
fn the_event_log_of_a_real_house() {
    let Some(root) = std::env::var_os("TOPOUT_REAL_DATA") else {
        println!("skipped: TOPOUT_REAL_DATA is not set");
        return;
    };
    let folder = PathBuf::from(root).join("schependomlaan");
    let log = "eventlog/Schependomlaan eventlog as planned data incl as built data.csv";
    let files = ["schependomlaan.glb", log, "links.csv"];
    let [model, log, links] = files.map(|name| text(&folder.join(name)));
    let line = ["check", &model, "--schedule", &log, "--schedule", &links, "--json", "-"];
    let report = topout(line).good_json();
    assert_eq!(
        (number(&report, "activities"), number(&report, "unlinked_activities")),
        (72.0, 0.0)
    );
    let flags = &report["flags"];
    assert_eq!((number(flags, "later"), number(flags, "on_time")), (194.0, 3467.0));
    assert_eq!(flags["activities"].as_array().map(Vec::len), Some(8));
}
