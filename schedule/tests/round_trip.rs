//! Writing and reading back, and the JSON Schema that describes what is written and read.

mod support;

use proptest::prelude::*;
use serde_json::Value;
use support::*;
use topout_schedule::{Activity, ActivityKind, FORMAT, Schedule, Time, TimeRange};

fn written(schedule: &Schedule) -> String {
    let mut bytes = Vec::new();
    schedule.write_json(&mut bytes).expect("memory does not fail");
    String::from_utf8(bytes).expect("JSON is UTF-8")
}

fn assert_same(a: &Schedule, b: &Schedule) {
    assert_eq!((&a.project, a.period), (&b.project, b.period));
    assert_eq!(a.activities, b.activities);
    assert_eq!(a.fields, b.fields);
}

fn any_text() -> impl Strategy<Value = String> {
    prop_oneof![
        "\\PC{0,12}",
        "[\"\\\\\n\t;|,{}\\[\\] a]{0,8}",
        "-?[0-9]{1,3}(\\.[0-9]{1,3})?(e[0-9])?",
        Just("true".to_owned()),
        Just("null".to_owned()),
        Just("[1, {\"a\": \"b\"}]".to_owned()),
        Just("{\"open\": ".to_owned()),
    ]
}

/// Fields may be called like the other names of what an activity has.
fn any_fields() -> impl Strategy<Value = Vec<(String, String)>> {
    let known = ["finish", "activity_id", "id", "end", "start", "activities", "trade"];
    let known = known.map(str::to_owned);
    let name = prop_oneof![any_text(), prop::sample::select(known.to_vec())];
    prop::collection::vec((name, any_text()), 0..4)
}

fn any_time() -> impl Strategy<Value = Time> {
    // From the year 0 to beyond 9999.
    (-62_000_000_000i64..300_000_000_000).prop_map(Time::from_seconds)
}

prop_compose! {
    fn any_activity()(
        id in "[A-Z0-9]{1,3}|\\PC{1,5}",
        name in any_text(),
        start in prop::option::weighted(0.9, any_time()),
        end in prop::option::weighted(0.9, any_time()),
        kind in prop::sample::select(ActivityKind::WORDS.to_vec()),
        active in any::<bool>(),
        elements in prop::collection::vec(any_text(), 0..5),
        fields in any_fields(),
    ) -> Activity {
        Activity { id, name, start, end, kind: kind.1, active, elements, fields }
    }
}

proptest! {
    #[test]
    fn what_is_written_is_read(
        project in any_text(),
        period in prop::option::of((any_time(), any_time())),
        activities in prop::collection::vec(any_activity(), 0..6),
        fields in any_fields(),
    ) {
        let period = period.map(|(a, b)| TimeRange { start: a.min(b), end: a.max(b) });
        let mut schedule = Schedule::new(project, period, activities, Default::default());
        schedule.fields = fields;
        let text = written(&schedule);
        prop_assert!(serde_json::from_str::<Value>(&text).is_ok());
        let read = json(&text);
        assert_same(&read, &schedule);
        // The first reading reports what it finds; what it finds does not change.
        prop_assert_eq!(written(&read), text);
    }
}

#[test]
fn from_a_table_to_json_and_back() {
    let table = csv("id,name,start,finish,kind,elements,cost,code\n\
                     A,Walls,2026-03-03,2026-03-04,temporary,W1;W2,12.50,007\n");
    let text = written(&table);
    // Numbers are written as numbers, texts that only look like them are not.
    assert_says(
        &text,
        &["\"cost\": 12.50", "\"code\": \"007\"", "\"end\": \"2026-03-05T00:00:00\""],
    );
    assert_same(&json(&text), &table);
}

#[test]
fn times_outside_the_calendar_are_refused() {
    let period = TimeRange { start: Time::MIN, end: Time::MAX };
    let schedule = Schedule::new(String::new(), Some(period), Vec::new(), Default::default());
    let error = schedule.write_json(Vec::new()).expect_err("no such date");
    assert_eq!(error.kind(), std::io::ErrorKind::InvalidData);
}

fn schema() -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/schedule.schema.json");
    let text = std::fs::read_to_string(path).expect("the schema is part of the repository");
    serde_json::from_str(&text).expect("the schema is JSON")
}

fn names(object: &Value) -> Vec<&str> {
    let mut names: Vec<&str> =
        object.as_object().expect("an object").keys().map(String::as_str).collect();
    names.sort();
    names
}

/// The schema names what the reader takes: given every property that it names, nothing is left over
/// as an unknown field, and everything that is written is named.
#[test]
fn the_schema_names_what_is_read_and_written() {
    let schema = schema();
    let project = &schema["properties"];
    let activity = &schema["$defs"]["activity"]["properties"];
    assert_eq!(
        names(project),
        ["activities", "end", "finish", "format", "project", "start", "version"]
    );
    assert_eq!(
        names(activity),
        ["active", "activity_id", "elements", "end", "finish", "id", "kind", "name", "start"]
    );
    assert_eq!(project["format"]["const"], FORMAT);

    let one = Activity {
        id: "A".into(),
        start: Some(time("2026-01-01")),
        end: Some(time("2026-01-02")),
        ..Activity::default()
    };
    let text = written(&Schedule::new("P".into(), None, vec![one], Default::default()));
    let value: Value = serde_json::from_str(&text).expect("what is written is JSON");
    assert!(names(&value).iter().all(|n| !project[n].is_null()), "{text}");
    assert!(names(&value["activities"][0]).iter().all(|n| !activity[n].is_null()), "{text}");

    for other in names(activity) {
        let given = match other {
            "id" | "activity_id" | "end" | "finish" => continue,
            _ => format!("{{\"id\": \"A\", \"end\": \"2026-01-02\", \"{other}\": null}}"),
        };
        let schedule = json(format!("{{\"activities\": [{given}]}}"));
        assert!(schedule.activities[0].fields.is_empty(), "{other} is named, but not read");
    }
}

#[test]
fn the_schema_lists_the_words_that_are_read() {
    let schema = schema();
    let words = |name: &str| -> Vec<String> {
        let list = schema["$defs"][name]["enum"].as_array().expect("a list of words").clone();
        list.iter().map(|w| w.as_str().map_or_else(|| w.to_string(), str::to_owned)).collect()
    };
    let kinds: Vec<&str> = ActivityKind::WORDS.iter().map(|(w, _)| *w).collect();
    assert_eq!(words("kind"), kinds);
    for kind in words("kind") {
        let dates = "\"start\": \"2026-01-01\", \"end\": \"2026-01-02\"";
        let text =
            format!("{{\"activities\": [{{\"id\": \"A\", {dates}, \"kind\": \"{kind}\"}}]}}");
        assert_eq!(findings(&json(text)), []);
    }
    for active in schema["$defs"]["active"]["enum"].as_array().expect("a list") {
        let dates = "\"start\": \"2026-01-01\", \"end\": \"2026-01-02\"";
        let text =
            format!("{{\"activities\": [{{\"id\": \"A\", {dates}, \"active\": {active}}}]}}");
        assert_eq!(findings(&json(text)), [], "{active}");
    }
}
