//! What is wrong with files is said with file, place and value, and never stops the program.

mod support;

use proptest::prelude::*;
use support::*;
use topout_schedule::{Severity, presence};

#[test]
fn missing_file() {
    let said = Files::new().add_missing("nowhere.json").error();
    assert_says(&said, &["nowhere.json", "cannot be read"]);
}

#[test]
fn a_folder_is_no_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let error = topout_schedule::read_files(&[folder.path().to_owned()], &Default::default());
    assert_says(&error.expect_err("no file").to_string(), &["cannot be read"]);
}

#[test]
fn empty_files() {
    for content in ["", " \n\t\r\n", "\u{feff}"] {
        for name in ["plan.json", "plan.csv", "plan"] {
            let said = Files::new().add(name, content).error();
            assert_says(&said, &[name, "is empty"]);
        }
    }
}

#[test]
fn not_json() {
    for (content, place) in [
        ("hello", "line 1 column 1"),
        ("{\"activities\": [\n  {\"id\": \"A\",}\n]}", "line 2 column 14"),
        ("{\"activities\": [\n", "line 2 column 0"),
        ("{\"activities\": []} x", "line 1 column 20"),
        ("id,name,start,end", "line 1 column 1"),
    ] {
        let said = Files::new().add("plan.json", content).error();
        assert_says(&said, &["plan.json: ", place]);
        assert!(!said.contains(" at line "), "the place once is enough: {said}");
    }
}

#[test]
fn json_of_another_kind() {
    let said = Files::new().add("plan.json", "[1, 2]").error();
    assert_says(&said, &["plan.json: line 1", "sequence", "an object"]);
    let said = Files::new().add("plan.json", "\n{\"tasks\": []}").error();
    assert_says(&said, &["plan.json: line 2 column 1", "no list \"activities\""]);
    for (value, kind) in
        [("5", "a number"), ("\"A\"", "a text"), ("{}", "an object"), ("null", "null")]
    {
        let said = Files::new().add("p.json", format!("{{\"activities\":\n {value}}}")).error();
        assert_says(&said, &["p.json: line 2 column 2", kind, "not a list"]);
    }
}

/// A value of a wrong type is said with its place and counts as not given; the rest is read.
#[test]
fn wrong_types_in_activities() {
    let dates = r#""start": "2026-01-01", "end": "2026-01-02""#;
    for (activity, says, kept) in [
        ("7", "a number, not an object", 0),
        ("\"A\"", "a text, not an object", 0),
        (&format!(r#"{{"id": ["A"], {dates}}}"#), "id of \"id\" is a list", 0),
        (&format!(r#"{{"id": "A", "name": {{}}, {dates}}}"#), "name of \"A\" is an object", 1),
        (r#"{"id": "A", "start": ["x"], "end": "2026-01-02"}"#, "start of \"A\" is a list", 1),
        (&format!(r#"{{"id": "A", "kind": [], {dates}}}"#), "kind of \"A\" is a list", 1),
        (&format!(r#"{{"id": "A", "elements": "W1", {dates}}}"#), "a text, not a list", 1),
        (
            &format!(r#"{{"id": "A", "elements": [["W1"]], {dates}}}"#),
            "elements of \"A\" is a list",
            1,
        ),
        (&format!(r#"{{"id": "A", "name": "\ud800", {dates}}}"#), "name of \"A\" is not a text", 1),
    ] {
        let good = format!(r#"{{"id": "Z", {dates}}}"#);
        let schedule = json(format!("{{\"activities\": [{good},\n{activity}]}}"));
        assert_says(message(&schedule, "wrong-type"), &["plan.json: line 2, activity 2", says]);
        assert_eq!(schedule.activities.len(), 1 + kept, "{activity}");
        assert!(schedule.diagnostics.has_errors());
        // Dates of a wrong type are not reported as missing on top.
        assert!(schedule.diagnostics.get("no-dates").is_none());
    }
    let schedule = json("{\"start\": {}, \"project\": [1], \"activities\": []}");
    assert_eq!(findings(&schedule), [("empty-schedule", 1), ("wrong-type", 2)]);
}

#[test]
fn huge_and_deep_json() {
    let deep = "[".repeat(2_000_000);
    let said = Files::new().add("plan.json", &deep).error();
    assert_says(&said, &["plan.json: line 1"]);
    let said = Files::new().add("plan.json", format!("{{\"activities\": {deep}")).error();
    assert_says(&said, &["plan.json: line 1"]);

    // Balanced, so that only its depth could be wrong: an unknown field keeps its text.
    let nested = format!("{}{}", "[".repeat(500_000), "]".repeat(500_000));
    let dates = r#""start": "2026-01-01", "end": "2026-01-02""#;
    let schedule = json(format!(
        r#"{{"activities": [{{"id": "A", {dates}, "x": {nested}}}, {nested},
            {{"id": "B", {dates}, "elements": [{nested}]}}]}}"#
    ));
    assert_eq!(schedule.activities.len(), 2);
    assert_eq!(field(by_id(&schedule, "A"), "x").map(str::len), Some(1_000_000));
    assert_eq!(findings(&schedule), [("wrong-type", 2)]);
    assert!(message(&schedule, "wrong-type").len() < 1000);
}

#[test]
fn empty_schedules() {
    let schedule = json("{\"activities\": []}");
    assert_eq!(findings(&schedule), [("empty-schedule", 1)]);
    assert_says(message(&schedule, "empty-schedule"), &["plan.json", "no activity"]);
    assert!(schedule.diagnostics.has_errors());
    let schedule = csv("id,name,start,end\n");
    assert_says(message(&schedule, "empty-schedule"), &["plan.csv"]);
    // Links alone make no schedule, and say what they lack.
    let schedule = csv("guid,activity_id\nE,A\n");
    assert_eq!(findings(&schedule), [("empty-schedule", 1), ("unknown-activity", 1)]);
    assert_says(message(&schedule, "empty-schedule"), &["plan.csv", "no schedule"]);
}

#[test]
fn end_before_start() {
    let rows = "id,name,start,end\nA,a,2026-04-01,2026-03-01\nB,b,2026-05-01,2026-05-01\n";
    let schedule = csv(rows);
    assert_eq!(findings(&schedule), [("end-before-start", 1)]);
    let said = message(&schedule, "end-before-start");
    assert_says(said, &["plan.csv: line 2", "\"A\"", "2026-03-02T00:00:00", "2026-04-01T00:00:00"]);
    assert_eq!(
        schedule.diagnostics.get("end-before-start").map(|d| d.severity),
        Some(Severity::Error)
    );
    // It stays in the list with its dates, but neither presence nor the period see it.
    let a = by_id(&schedule, "A");
    assert_eq!((a.start, a.dates()), (Some(time("2026-04-01")), None));
    assert_eq!(presence(&schedule.kinds, [a]), topout_schedule::Behaviour::always());
    assert_eq!(schedule.period.start, time("2026-05-01"));
    assert_eq!(schedule.period.end, time("2026-05-02"));
}

#[test]
fn activities_without_dates() {
    let schedule = json(
        "{\"activities\": [\n{\"id\": \"A\", \"start\": \"2026-01-01\"},\n{\"id\": \"B\"},\n\
         {\"id\": \"C\", \"start\": \"\", \"end\": \" \"}]}",
    );
    assert_eq!(findings(&schedule), [("no-dates", 3)]);
    assert_says(
        message(&schedule, "no-dates"),
        &["plan.json: line 2, activity 1", "\"A\" has no end"],
    );
    assert_eq!(schedule.activities.len(), 3);
    assert_eq!(schedule.diagnostics.get("no-dates").map(|d| d.examples.len()), Some(3));
}

#[test]
fn the_same_id_twice() {
    let a = "id,name,start,end\nA,first,2026-01-01,2026-01-02\nB,b,2026-01-01,2026-01-02\n";
    let b = r#"{"activities": [
        {"id": "A", "name": "second", "start": "2027-01-01", "end": "2027-01-02"}]}"#;
    let schedule = Files::new().add("a.csv", a).add("b.json", b).read();
    assert_eq!(findings(&schedule), [("duplicate-id", 1)]);
    let said = message(&schedule, "duplicate-id");
    assert_says(said, &["b.json: line 2, activity 1", "a.csv: line 2", "\"A\""]);
    assert_eq!(schedule.diagnostics.get("duplicate-id").map(|d| d.severity), Some(Severity::Error));
    assert_eq!(schedule.activities.len(), 2);
    assert_eq!(by_id(&schedule, "A").name, "first");
    // What is left out does not stretch the period, and links go to the one that counts.
    assert_eq!(schedule.period.end, time("2026-01-03"));
    let links = "element,activity_id\nE,A\n";
    let schedule = Files::new().add("l.csv", links).add("a.csv", a).add("b.json", b).read();
    assert_eq!(by_id(&schedule, "A").elements, ["E"]);
}

#[test]
fn no_id() {
    let schedule =
        csv("id,name,start,end\n,nameless,2026-01-01,2026-01-02\nA,a,2026-01-01,2026-01-02\n");
    assert_eq!(schedule.activities.len(), 1);
    assert_says(message(&schedule, "missing-id"), &["plan.csv: line 2", "nameless"]);
}

#[test]
fn bad_dates_name_their_line() {
    let good = "A,a,2026-01-01,2026-01-02\n";
    for bad in [
        "2026-02-30",
        "03-04-2026",
        "15-03-04",
        "2026-01-01T08:00:00Z",
        "2026-01-01T08:00+01:00",
        "soon",
        "20260101",
        "46023",
    ] {
        let schedule = csv(format!("id,name,start,end\n{good}B,b,{bad},2026-01-02\n"));
        assert_eq!(findings(&schedule), [("bad-date", 1)], "{bad}");
        let said = message(&schedule, "bad-date");
        assert_says(
            said,
            &["plan.csv: line 3", "start of \"B\"", &format!("{bad:?}"), "without a zone"],
        );
        assert!(schedule.diagnostics.has_errors());
        assert_eq!((schedule.activities.len(), by_id(&schedule, "B").start), (2, None));

        let activity =
            format!("\n{{\"id\": \"B\", \"start\": \"2026-01-01\", \"end\": \"{bad}\"}}");
        let first = "{\"id\": \"A\", \"start\": \"2026-01-01\", \"end\": \"2026-01-02\"}";
        let schedule = json(format!("{{\"activities\": [{first},\n{activity}]}}"));
        let said = message(&schedule, "bad-date");
        assert_says(said, &["plan.json: line 3, activity 2", "end of \"B\"", &format!("{bad:?}")]);
    }
}

/// Nothing could be shown of it, and one option would help: an error, not a list of findings.
#[test]
fn no_date_can_be_read() {
    let said = Files::new()
        .add("plan.csv", "id,name,start,end\nA,a,02-03-2015,03-03-2015\nB,b,2-3-2015,4-3-2015\n")
        .error();
    assert_says(
        &said,
        &["no activity has dates", "plan.csv: line 2", "02-03-2015", "--date-format"],
    );
}

#[test]
fn tables_of_another_kind() {
    for (content, missing) in [
        ("hello", "lacks id, name, start, end (found: hello)"),
        ("id,name,finish\nA,a,2026-01-01\n", "lacks start (found: id, name, finish)"),
        ("x<?xml version=\"1.0\"?>\n<Project/>", "lacks id, name, start, end"),
        ("guid,name\nE,A\n", "lacks id, start, end"),
        ("id\tname\tstart\tend\nA\ta\t2026-01-01\t2026-01-02\n", "lacks id"),
    ] {
        let said = Files::new().add("plan.csv", content).error();
        assert_says(&said, &["plan.csv: line 1", missing]);
    }
    let wide = vec!["column"; 5000].join(",");
    assert!(Files::new().add("plan.csv", wide).error().len() < 1000);
}

#[test]
fn binary_files() {
    let bytes: Vec<u8> = b"glTF\x02\x00\x00\x00".iter().copied().chain(128..=255).collect();
    let said = Files::new().add("model.glb", bytes).error();
    assert_says(&said, &["model.glb: line 1: byte 9", "0x80"]);
}

#[test]
fn every_problem_at_once_leaves_the_good_rows() {
    let schedule = csv("id,name,start,end,kind,active\n\
         A,a,2026-01-01,2026-01-02,,\n\
         A,a,2026-01-01,2026-01-02,,\n\
         B,b,2026-01-05,2026-01-02,,\n\
         C,c,,,,\n\
         D,d,x,2026-01-02,,\n\
         E,e,2026-01-01,2026-01-02,paint,\n\
         F,f,2026-01-01,2026-01-02,,often\n\
         ,g,2026-01-01,2026-01-02,,\n");
    let expected = [
        ("bad-date", 1),
        ("duplicate-id", 1),
        ("end-before-start", 1),
        ("missing-id", 1),
        ("no-dates", 1),
        ("unknown-active", 1),
        ("unknown-kind", 1),
    ];
    assert_eq!(findings(&schedule), expected);
    assert_eq!(schedule.activities.iter().filter(|a| a.dates().is_some()).count(), 3);
}

proptest! {
    /// Whatever stands in a file, reading it ends with a schedule or an error.
    #[test]
    fn no_file_makes_it_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..200),
        json_like in "[\\[\\]{}\",:a-z0-9 ]{0,60}",
        csv_like in "(id,name,start,end[,;a-z]{0,9}|guid[,;]activity_id)\n([A-C0-9\",;|\r\n:T -]{0,20}\n){0,4}",
    ) {
        for content in [&bytes[..], json_like.as_bytes(), csv_like.as_bytes()] {
            for name in ["plan.json", "plan.csv", "plan"] {
                if let Ok(schedule) = Files::new().add(name, content).try_read(&Default::default()) {
                    let _ = presence(&schedule.kinds, &schedule.activities);
                }
            }
        }
    }
}
