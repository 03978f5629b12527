//! The reader of topout JSON.

mod support;

use support::*;
use topout_schedule::ActivityKind;

#[test]
fn the_example_of_the_format() {
    let schedule = json(
        r#"{"format": "4d-schedule", "version": 1, "project": "Tower",
            "start": "2026-03-03T08:00:00", "end": "2028-07-24T13:00:00",
            "activities": [{"id": "A000001", "name": "Site fence",
              "start": "2026-03-03T08:00:00", "end": "2028-07-18T08:00:00", "kind": "temporary",
              "active": true, "elements": ["FNC_S00_0000"], "trade": "Site setup", "storey": 0}]}"#,
    );
    assert_eq!(findings(&schedule), []);
    assert_eq!(schedule.project, "Tower");
    assert_eq!(schedule.period.start, time("2026-03-03T08:00:00"));
    assert_eq!(schedule.period.end, time("2028-07-24T13:00:00"));
    let fence = &schedule.activities[0];
    assert_eq!((fence.id.as_str(), fence.name.as_str()), ("A000001", "Site fence"));
    assert_eq!(fence.start, Some(time("2026-03-03T08:00:00")));
    assert_eq!(fence.end, Some(time("2028-07-18T08:00:00")));
    assert_eq!(fence.kind, ActivityKind::Temporary);
    assert!(fence.active);
    assert_eq!(fence.elements, ["FNC_S00_0000"]);
    let fields = [("trade".into(), "Site setup".into()), ("storey".into(), "0".into())];
    assert_eq!(fence.fields, fields);
}

#[test]
fn what_may_be_missing() {
    let schedule = json(
        r#"{"activities": [
            {"id": "A", "start": "2026-03-03", "end": "2026-03-04"},
            {"id": "B", "name": null, "start": "2026-02-01 09:30", "end": "2026-03-01T10:00",
             "kind": null, "active": null, "elements": null}]}"#,
    );
    assert_eq!(findings(&schedule), []);
    let a = by_id(&schedule, "A");
    assert_eq!((a.kind, a.active, a.elements.len()), (ActivityKind::Construct, true, 0));
    // The first start and the last end; a date alone ends with its day.
    assert_eq!(schedule.period.start, time("2026-02-01T09:30:00"));
    assert_eq!(schedule.period.end, time("2026-03-05"));
    assert_eq!(by_id(&schedule, "B").end, Some(time("2026-03-01T10:00:00")));
}

#[test]
fn other_names_for_id_and_end() {
    let schedule = json(
        r#"{"finish": "2026-12-31", "activities": [
            {"activity_id": 17, "start": "2026-03-03", "finish": "2026-03-03"}]}"#,
    );
    let a = by_id(&schedule, "17");
    assert_eq!((a.start, a.end), (Some(time("2026-03-03")), Some(time("2026-03-04"))));
    assert_eq!(schedule.period.end, time("2027-01-01"));
}

/// `end` and `id` are the names; beside them the others are fields like any other.
#[test]
fn names_go_before_their_other_forms() {
    let schedule = json(
        r#"{"activities": [{"finish": "early", "end": "2026-03-04", "start": "2026-03-03",
                            "activity_id": "P6-1", "id": "A"}]}"#,
    );
    assert_eq!(findings(&schedule), []);
    let a = by_id(&schedule, "A");
    assert_eq!(a.end, Some(time("2026-03-05")));
    assert_eq!((field(a, "finish"), field(a, "activity_id")), (Some("early"), Some("P6-1")));
}

#[test]
fn kinds() {
    let words = ["construct", "Demolish", "TEMPORARY", "neutral", "inspect", "maintain", "weld"];
    let list: Vec<String> = (words.iter())
        .map(|w| {
            let dates = r#""start": "2026-01-01", "end": "2026-01-02""#;
            format!(r#"{{"id": "{w}", {dates}, "kind": "{w}"}}"#)
        })
        .collect();
    let schedule = json(format!("{{\"activities\": [\n{}]}}", list.join(",\n")));
    let kinds: Vec<_> = schedule.activities.iter().map(|a| a.kind).collect();
    use ActivityKind::{Construct, Demolish, Maintain, Neutral, Temporary};
    assert_eq!(kinds, [Construct, Demolish, Temporary, Neutral, Neutral, Maintain, Construct]);
    assert_eq!(findings(&schedule), [("unknown-kind", 1)]);
    assert_says(message(&schedule, "unknown-kind"), &["plan.json", "line 8", "weld", "construct"]);
}

#[test]
fn active_in_all_its_forms() {
    let forms =
        ["true", "1", "\"yes\"", "\"TRUE\"", "\"\"", "null", "false", "0", "\"No\"", "\"0\""];
    let list: Vec<String> = (forms.iter().enumerate())
        .map(|(i, form)| {
            format!(
                r#"{{"id": {i}, "start": "2026-01-01", "end": "2026-01-02", "active": {form}}}"#
            )
        })
        .collect();
    let schedule = json(format!("{{\"activities\": [{}]}}", list.join(",")));
    assert_eq!(findings(&schedule), []);
    let active: Vec<_> = schedule.activities.iter().map(|a| a.active).collect();
    assert_eq!(active, [true, true, true, true, true, true, false, false, false, false]);

    let schedule = json(
        r#"{"activities": [{"id": "A", "start": "2026-01-01", "end": "2026-01-02",
            "active": "perhaps"}]}"#,
    );
    assert!(schedule.activities[0].active);
    assert_says(message(&schedule, "unknown-active"), &["line 1", "\"A\"", "perhaps"]);
}

#[test]
fn unknown_fields_keep_their_text() {
    let schedule = json(
        r#"{"client": "Meier & Sons", "phases": [1, 2.50], "activities": [
            {"id": "A", "start": "2026-01-01", "end": "2026-01-02", "cost": 12345678901234567890.10,
             "crew": {"lead": "Ann \u00e9"}, "note": "a \"word\"", "none": null}]}"#,
    );
    assert_eq!(schedule.fields[0], ("client".into(), "Meier & Sons".into()));
    assert_eq!(schedule.fields[1], ("phases".into(), "[1, 2.50]".into()));
    let a = by_id(&schedule, "A");
    assert_eq!(field(a, "cost"), Some("12345678901234567890.10"));
    assert_eq!(field(a, "crew"), Some(r#"{"lead": "Ann \u00e9"}"#));
    assert_eq!(field(a, "note"), Some("a \"word\""));
    assert_eq!(field(a, "none"), Some(""));
}

#[test]
fn elements_are_named_once_each() {
    let schedule = json(
        r#"{"activities": [{"id": "A", "start": "2026-01-01", "end": "2026-01-02",
            "elements": ["b", "a", "b", "", 7, "a"]}]}"#,
    );
    assert_eq!(schedule.activities[0].elements, ["b", "a", "7"]);
}

#[test]
fn another_format_or_version_is_reported_and_read() {
    let schedule = json(
        r#"{"format": "gantt", "version": 2,
            "activities": [{"id": "A", "start": "2026-01-01", "end": "2026-01-02"}]}"#,
    );
    assert_eq!(findings(&schedule), [("unknown-format", 2)]);
    assert_says(message(&schedule, "unknown-format"), &["plan.json: line 1", "gantt"]);
    assert_eq!(schedule.activities.len(), 1);
}

#[test]
fn byte_order_mark_and_unknown_extension() {
    let content = "\u{feff} {\"activities\": [{\"id\": \"A\", \"start\": \"2026-01-01\", \"end\": \
                   \"2026-01-02\"}]}";
    for name in ["plan.json", "plan.JSON", "plan", "plan.4d"] {
        assert_eq!(Files::new().add(name, content).read().activities.len(), 1, "{name}");
    }
}

#[test]
fn dates_by_an_explicit_format() {
    let files = Files::new().add(
        "plan.json",
        r#"{"start": "01/02/2026", "activities": [
            {"id": "A", "start": "03/02/2026", "end": "04/02/2026 17:30"},
            {"id": "B", "start": "2026-02-05", "end": "2026-02-06"}]}"#,
    );
    let schedule = files.try_read(&with_format("%d/%m/%Y")).expect("a schedule");
    assert_eq!(findings(&schedule), []);
    assert_eq!(schedule.period.start, time("2026-02-01"));
    assert_eq!(by_id(&schedule, "A").end, Some(time("2026-02-04T17:30")));
    assert_eq!(by_id(&schedule, "B").end, Some(time("2026-02-07")));
}

#[test]
fn the_project_ends_before_it_starts() {
    let schedule = json(
        r#"{"start": "2027-01-01", "end": "2026-01-01", "activities": [
            {"id": "A", "start": "2026-03-03", "end": "2026-03-04"}]}"#,
    );
    assert_eq!(findings(&schedule), [("reversed-project", 1)]);
    let said = message(&schedule, "reversed-project");
    assert_says(said, &["2026-01-02T00:00:00", "2027-01-01T00:00:00"]);
    assert_eq!(schedule.period.start, time("2026-03-03"));
    assert_eq!(schedule.period.end, time("2026-03-05"));
}

#[test]
fn several_files_become_one_project() {
    let part = |id: &str, project: &str, start: &str| {
        format!(
            r#"{{"project": "{project}", "start": "{start}", "activities": [
                {{"id": "{id}", "start": "2026-05-01", "end": "2026-05-02"}}]}}"#
        )
    };
    let files = || {
        Files::new()
            .add("a.json", part("A", "", "2026-03-01"))
            .add("b.json", part("B", "Tower", "2026-02-01"))
    };
    for schedule in [files().read(), files().reversed().read()] {
        assert_eq!(findings(&schedule), []);
        assert_eq!(schedule.project, "Tower");
        assert_eq!(schedule.period.start, time("2026-02-01"));
        assert_eq!(schedule.period.end, time("2026-05-03"));
        assert_eq!(schedule.activities.len(), 2);
    }
}

/// No files: nothing is known and nothing is wrong.
#[test]
fn no_files() {
    let schedule = Files::new().read();
    assert!(schedule.activities.is_empty() && findings(&schedule).is_empty());
}
