//! Writing and reading back, and the JSON Schema that describes what is written and read.

mod support;

use proptest::prelude::*;
use serde_json::Value;
use support::*;
use topout_schedule::{
    Activity, ActivityKind, Calendar, CalendarException, DateSet, Dates, FORMAT, Fields, Kind,
    Kinds, Lag, LinkKind, Look, Phase, Predecessor, Schedule, Shift, Time, TimeRange, WbsNode,
};

fn written(schedule: &Schedule) -> String {
    let mut bytes = Vec::new();
    schedule.write_json(&mut bytes).expect("memory does not fail");
    String::from_utf8(bytes).expect("JSON is UTF-8")
}

fn written_as_table(schedule: &Schedule) -> String {
    let mut bytes = Vec::new();
    schedule.write_csv(&mut bytes).expect("memory does not fail");
    String::from_utf8(bytes).expect("the table is UTF-8")
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
fn any_fields() -> impl Strategy<Value = Fields> {
    let known = [
        "finish",
        "activity_id",
        "id",
        "end",
        "start",
        "activities",
        "trade",
        "planned_start",
        "milestone",
        "percent_complete",
        "wbs",
        "calendar",
        "predecessors",
        "calendars",
        "kind",
        "kinds",
        "data_date",
        "data",
        "topout",
    ];
    let known = known.map(str::to_owned);
    let name = prop_oneof![any_text(), prop::sample::select(known.to_vec())];
    let field = (name, any_text()).prop_map(|(n, v)| (n.into(), v.into()));
    prop::collection::vec(field, 0..4)
}

fn any_time() -> impl Strategy<Value = Time> {
    // From the year 0 to beyond 9999.
    (-62_000_000_000i64..300_000_000_000).prop_map(Time::from_seconds)
}

fn any_dates() -> impl Strategy<Value = Dates> {
    let time = || prop::option::weighted(0.4, any_time());
    (time(), time()).prop_map(|(start, end)| Dates { start, end })
}

fn any_shifts() -> impl Strategy<Value = Vec<Shift>> {
    let shift = (0u32..86_400, 1u32..86_401).prop_filter_map("in order", |(a, b)| Shift::new(a, b));
    prop::collection::vec(shift, 0..3)
}

prop_compose! {
    fn any_calendar()(
        name in any_text(),
        week in prop::array::uniform7(any_shifts()),
        exceptions in prop::collection::vec((-9000i32..90_000, 0u64..9, any_shifts()), 0..3),
    ) -> Calendar {
        let day = |n: i32| chrono::NaiveDate::from_num_days_from_ce_opt(719_163 + n).expect("a day");
        let exception = |(first, days, shifts)| CalendarException {
            first: day(first),
            last: day(first) + chrono::Days::new(days),
            shifts,
        };
        Calendar { name, week, exceptions: exceptions.into_iter().map(exception).collect() }
    }
}

prop_compose! {
    fn any_node()(
        code in any_text(),
        name in any_text(),
        parent in prop::option::of(0u32..4),
    ) -> WbsNode {
        WbsNode { code, name, parent }
    }
}

prop_compose! {
    fn any_predecessor()(
        activity in 0u32..6,
        kind in prop::sample::select(LinkKind::WORDS.to_vec()),
        seconds in prop_oneof![Just(0i64), -90_000i64..90_000, any::<i64>()],
        elapsed in any::<bool>(),
    ) -> Predecessor {
        Predecessor { activity, kind: kind.1, lag: Lag { seconds, elapsed } }
    }
}

fn any_kind() -> impl Strategy<Value = ActivityKind> {
    let word = prop::sample::select(ActivityKind::WORDS.to_vec());
    prop_oneof![3 => word.prop_map(|(_, kind)| kind), 1 => (0u8..2).prop_map(ActivityKind::Own)]
}

fn any_phase() -> impl Strategy<Value = Phase> {
    let look = (prop::option::of(any::<[u8; 3]>()), 0.01f32..=1.0);
    let look = look.prop_map(|(color, opacity)| Phase::Shown(Look { color, opacity }));
    prop_oneof![Just(Phase::Hidden), Just(Phase::Shown(Look::OWN)), look]
}

prop_compose! {
    /// Two of the planner's own, and perhaps demolitions that look otherwise.
    fn any_kinds()(
        phases in prop::array::uniform2(prop::array::uniform3(any_phase())),
        names in ("[a-z]{1,3}[;\"|é ]b", "[0-9\\[{]{1,4}"),
        demolish in prop::option::of(prop::option::of(any::<[u8; 3]>())),
    ) -> Kinds {
        let mut kinds = Kinds::default();
        for ([before, during, after], name) in phases.into_iter().zip([names.0, names.1]) {
            kinds.define(Kind { name, before, during, after }).expect("another kind");
        }
        if let Some(color) = demolish {
            let during = Phase::Shown(Look { color, opacity: 0.5 });
            let kind = kinds.of(ActivityKind::Demolish).clone();
            kinds.define(Kind { during, ..kind }).expect("another look");
        }
        kinds
    }
}

prop_compose! {
    fn any_activity()(
        id in "[A-Z0-9]{1,3}|[A-C:;FS+\\[ ]{1,6}|\\PC{1,5}",
        name in any_text(),
        start in prop::option::weighted(0.9, any_time()),
        end in prop::option::weighted(0.9, any_time()),
        sets in prop::array::uniform4(any_dates()),
        kind in any_kind(),
        (active, milestone) in any::<(bool, bool)>(),
        percent_complete in prop::option::of(0f32..=100.0),
        (wbs, calendar) in prop::option::of((0u32..5, 0u32..3)).prop_map(Option::unzip),
        predecessors in prop::collection::vec(any_predecessor(), 0..3),
        elements in prop::collection::vec(any_text(), 0..5),
        fields in any_fields(),
    ) -> Activity {
        let mut activity = Activity {
            id, name, start, end, kind, active, milestone, percent_complete, wbs, calendar,
            predecessors, elements, fields, ..Activity::default()
        };
        for ((_, set), dates) in DateSet::WORDS.into_iter().zip(sets) {
            activity.date_sets[set] = dates;
        }
        activity
    }
}

prop_compose! {
    fn any_schedule()(
        project in any_text(),
        period in prop::option::of((any_time(), any_time())),
        data_date in prop::option::of(any_time()),
        activities in prop::collection::vec(any_activity(), 0..6),
        wbs in prop::collection::vec(any_node(), 0..5),
        calendars in prop::collection::vec(any_calendar(), 0..3),
        calendar in prop::option::of(0u32..3),
        kinds in any_kinds(),
        fields in any_fields(),
    ) -> Schedule {
        let period = period.map(|(a, b)| TimeRange { start: a.min(b), end: a.max(b) });
        let mut given = Schedule::new(project, period, Vec::new(), Default::default());
        (given.wbs, given.calendars, given.calendar) = (wbs, calendars, calendar);
        given.kinds = kinds;
        (given.data_date, given.fields, given.activities) = (data_date, fields, activities);
        given.revalidated()
    }
}

/// Writes it in both forms and reads it again.
fn assert_kept(schedule: &Schedule) -> Result<(), TestCaseError> {
    let text = written(schedule);
    prop_assert!(serde_json::from_str::<Value>(&text).is_ok(), "{}", text);
    let table = written_as_table(schedule);
    for (name, content) in [("plan.json", &text), ("plan.csv", &table)] {
        let read = read_as(name, content);
        prop_assert_eq!(&read.project, &schedule.project);
        prop_assert_eq!(read.period, schedule.period);
        prop_assert_eq!(&read.activities, &schedule.activities, "{}", content);
        prop_assert_eq!((&read.wbs, read.calendar), (&schedule.wbs, schedule.calendar));
        prop_assert_eq!(&read.calendars, &schedule.calendars);
        prop_assert_eq!(&read.kinds, &schedule.kinds);
        prop_assert_eq!((read.data_date, &read.fields), (schedule.data_date, &schedule.fields));
        // The first reading reports what it finds; what it finds does not change.
        prop_assert_eq!(written(&read), &*text);
        prop_assert_eq!(written_as_table(&read), &*table);
    }
    Ok(())
}

proptest! {
    #[test]
    fn what_is_written_is_read(schedule in any_schedule()) {
        assert_kept(&schedule)?;
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
    assert_kept(&table).expect("the same");
}

#[test]
fn times_outside_the_calendar_are_refused() {
    let period = TimeRange { start: Time::MIN, end: Time::MAX };
    let schedule = Schedule::new(String::new(), Some(period), Vec::new(), Default::default());
    let error = schedule.write_json(Vec::new()).expect_err("no such date");
    assert_eq!(error.kind(), std::io::ErrorKind::InvalidData);
    let error = schedule.write_csv(Vec::new()).expect_err("no such date");
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

const KIND: &str = r##"{"name": "Scaffold", "during": {"color": "#E69F00", "opacity": 0.5}}"##;

/// The schema names what the reader takes: given every property that it names, nothing is left over
/// as an unknown field, and everything that is written is named.
#[test]
fn the_schema_names_what_is_read_and_written() {
    let schema = schema();
    let project = &schema["properties"];
    let activity = &schema["$defs"]["activity"]["properties"];
    assert_eq!(
        names(project),
        [
            "activities",
            "calendar",
            "calendars",
            "data_date",
            "end",
            "finish",
            "format",
            "kinds",
            "project",
            "start",
            "version",
            "wbs"
        ]
    );
    assert_eq!(
        names(activity),
        [
            "active",
            "activity_id",
            "actual_end",
            "actual_start",
            "baseline_end",
            "baseline_start",
            "calendar",
            "elements",
            "end",
            "finish",
            "forecast_end",
            "forecast_start",
            "id",
            "kind",
            "milestone",
            "name",
            "percent_complete",
            "planned_end",
            "planned_start",
            "predecessors",
            "start",
            "wbs"
        ]
    );
    assert_eq!(project["format"]["const"], FORMAT);

    let day = Some(time("2026-01-01"));
    let mut one = Activity {
        id: "A".into(),
        start: day,
        end: Some(time("2026-01-02")),
        milestone: true,
        percent_complete: Some(33.5),
        wbs: Some(0),
        calendar: Some(0),
        ..Activity::default()
    };
    for (_, set) in DateSet::WORDS {
        one.date_sets[set] = Dates { start: day, end: day };
    }
    let lag = Lag { seconds: -60, elapsed: true };
    let link = Predecessor { activity: 0, kind: LinkKind::StartStart, lag };
    let two = Activity { id: "B".into(), predecessors: vec![link], ..one.clone() };
    let calendar = Calendar {
        week: std::array::from_fn(|_| vec![Shift::new(28_800, 57_600).expect("a shift")]),
        exceptions: vec![CalendarException {
            first: day.and_then(Time::civil).expect("a day").date(),
            last: day.and_then(Time::civil).expect("a day").date(),
            shifts: Vec::new(),
        }],
        ..Calendar::default()
    };
    let mut schedule = Schedule::new("P".into(), None, Vec::new(), Default::default());
    schedule.activities = vec![one, two];
    schedule.wbs = vec![WbsNode::default(), WbsNode { parent: Some(0), ..WbsNode::default() }];
    (schedule.calendars, schedule.calendar, schedule.data_date) = (vec![calendar], Some(0), day);
    schedule.kinds.define(serde_json::from_str(KIND).expect("a kind")).expect("a new one");
    let text = written(&schedule.revalidated());
    let value: Value = serde_json::from_str(&text).expect("what is written is JSON");
    let named = |given: &Value, schema: &Value| {
        assert!(names(given).iter().all(|n| !schema["properties"][n].is_null()), "{given}");
    };
    let parts = &schema["$defs"];
    named(&value, &schema);
    named(&value["activities"][1], &parts["activity"]);
    named(&value["activities"][1]["predecessors"][0], &parts["predecessor"]);
    named(&value["wbs"][1], &parts["summary"]);
    named(&value["kinds"][0], &parts["own_kind"]);
    named(&value["kinds"][0]["during"], &parts["look"]);
    named(&value["calendars"][0], &parts["calendar"]);
    named(&value["calendars"][0]["week"], &parts["calendar"]["properties"]["week"]);
    named(&value["calendars"][0]["exceptions"][0], &parts["exception"]);

    for other in names(activity) {
        let given = match other {
            "id" | "activity_id" | "end" | "finish" => continue,
            _ => format!("{{\"id\": \"A\", \"end\": \"2026-01-02\", \"{other}\": null}}"),
        };
        let lists = "\"kinds\": null, \"wbs\": null, \"calendars\": null, \"calendar\": null, \"data_date\": null";
        let schedule = json(format!("{{{lists}, \"activities\": [{given}]}}"));
        assert!(schedule.activities[0].fields.is_empty(), "{other} is named, but not read");
        assert!(schedule.fields.is_empty());
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

/// Every real file survives being saved in either form.
#[test]
fn real_files_are_kept() {
    let Some(data) = std::env::var_os("TOPOUT_REAL_DATA").map(std::path::PathBuf::from) else {
        println!("skipped: TOPOUT_REAL_DATA is not set");
        return;
    };
    for file in [
        "schedules/MDL4D.csv",
        "schedules/MDL4D.xer",
        "schependomlaan/planning_mspdi.csv",
        "schependomlaan/planning_mspdi.xml",
        "schependomlaan/schedule.csv",
        "schependomlaan/schedule.json",
        "ifc4_task/construction_scheduling_task.ifc",
    ] {
        let schedule = topout_schedule::read_files(&[data.join(file)], &Default::default());
        let schedule = schedule.unwrap_or_else(|error| panic!("{error}"));
        assert!(!schedule.activities.is_empty(), "{file}");
        assert_kept(&schedule).unwrap_or_else(|error| panic!("{file}: {error}"));
    }
}
