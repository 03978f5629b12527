//! What the readers of planners' programs take from their files.

mod support;

use support::fixtures::{CSV, IFC, JSON, MSPDI, PMXML, XER};
use support::*;
use topout_schedule::{
    ActivityKind, Column, DateSet, Dates, Lag, LinkKind, Predecessor, ReadOptions, Schedule, Shift,
    read_bytes,
};

fn dates(start: &str, end: &str) -> Dates {
    let time = |text: &str| (!text.is_empty()).then(|| time(text));
    Dates { start: time(start), end: time(end) }
}

/// Ids, kinds and lags in hours (`e` for elapsed) of what an activity waits for.
fn predecessors(schedule: &Schedule, id: &str) -> Vec<String> {
    let text = |link: &Predecessor| {
        let Lag { seconds, elapsed } = link.lag;
        let other = &schedule.activities[link.activity as usize].id;
        let unit = if elapsed { "eh" } else { "h" };
        format!("{other} {} {}{unit}", link.kind.word(), seconds as f64 / 3600.0)
    };
    by_id(schedule, id).predecessors.iter().map(text).collect()
}

fn shifts(shifts: &[Shift]) -> Vec<String> {
    shifts.iter().map(Shift::to_string).collect()
}

fn shifts_on(schedule: &Schedule, calendar: usize, day: &str) -> Vec<String> {
    let day = time(day).civil().expect("a day").date();
    shifts(schedule.calendars[calendar].shifts_on(day))
}

#[test]
fn microsoft_project() {
    let schedule = read_as("tower.xml", MSPDI);
    assert_eq!(
        findings(&schedule),
        [("calendar-rule", 1), ("no-dates", 1), ("summary-link", 1), ("unknown-predecessor", 1)]
    );
    assert_says(
        message(&schedule, "unknown-predecessor"),
        &["tower.xml: line 21, activity 2", "\"4\" follows \"99\""],
    );
    assert_says(message(&schedule, "summary-link"), &["\"4\" follows \"1\"", "summary"]);
    assert_eq!(schedule.project, "Tower & site");
    assert_eq!(schedule.data_date, Some(time("2026-03-10T17:00")));
    let ids: Vec<&str> = schedule.activities.iter().map(|a| a.id.as_str()).collect();
    assert_eq!(ids, ["3", "4", "5", "6"]);

    let walls = by_id(&schedule, "3");
    assert_eq!(walls.name, "Walls <north>");
    assert_eq!(schedule.wbs_path(walls), ["Site", "Shell"]);
    assert_eq!(schedule.wbs[0].code, "S");
    // Begun late: it ends as planned, since nothing else is known.
    assert_eq!(
        (walls.start, walls.end),
        (Some(time("2026-03-03T08:00")), Some(time("2026-03-03T17:00")))
    );
    assert_eq!(walls.date_sets[DateSet::Planned], dates("2026-03-02T08:00", "2026-03-03T17:00"));
    assert_eq!(walls.date_sets[DateSet::Actual], dates("2026-03-03T08:00", ""));
    assert_eq!(walls.date_sets[DateSet::Baseline], dates("2026-02-23T08:00", "2026-02-24T17:00"));
    assert_eq!(walls.percent_complete, Some(40.0));
    assert_eq!((field(walls, "Zone"), field(walls, "Outline Code1")), (Some("Aä"), Some("North")));
    assert_eq!((field(walls, "Notes"), field(walls, "ID")), (Some("wet & cold"), Some("3")));

    // Half of 16 hours, and a day of the clock before the start of the milestone.
    assert_eq!(predecessors(&schedule, "4"), ["3 FS 8h", "5 SS -24eh"]);
    let handover = by_id(&schedule, "5");
    assert!(handover.milestone && handover.wbs.is_none());
    assert_eq!(handover.start, handover.end);
    assert!(!by_id(&schedule, "6").active);

    assert_eq!((schedule.calendar, walls.calendar), (Some(0), Some(1)));
    for calendar in [0, 1] {
        // A Monday, a Sunday, and a holiday of which only the newer form says more.
        assert_eq!(shifts_on(&schedule, calendar, "2026-03-02"), ["08:00-12:00", "13:00-24:00"]);
        assert!(shifts_on(&schedule, calendar, "2026-03-01").is_empty());
        assert_eq!(schedule.calendars[calendar].exceptions.len(), 1);
    }
    let tally = schedule.tally();
    assert_eq!((tally.activities, tally.summaries, tally.predecessors), (4, 2, 2));
    assert_eq!((tally.without_name, tally.repeated_names, tally.without_dates), (1, 1, 1));
    assert_eq!((tally.milestones, tally.zero_duration, tally.flat_outline), (1, 1, false));
}

/// Without a namespace, with a prefix, in another encoding.
#[test]
fn dialects_of_microsoft_project() {
    let plain = read_as("tower.xml", MSPDI);
    let bare = MSPDI.replace(" xmlns=\"http://schemas.microsoft.com/project\"", "");
    let prefixed = bare.replace("</", "\u{1}").replace("<?", "\u{2}").replace("<!", "\u{3}");
    let prefixed = prefixed.replace('<', "<p:").replace('\u{1}', "</p:");
    let prefixed = prefixed.replace('\u{2}', "<?").replace('\u{3}', "<!");
    let utf16: Vec<u8> =
        "\u{feff}".encode_utf16().chain(MSPDI.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    for other in [bare.as_bytes(), prefixed.as_bytes(), &utf16] {
        // The content tells what it is, whatever the file is called.
        let read = read_as("tower.dat", other);
        assert_eq!(read.activities, plain.activities);
        assert_eq!(read.calendars, plain.calendars);
    }
    let latin = MSPDI.replace("UTF-8", "ISO-8859-1").replace("&#228;", "ä");
    let latin = encoding_rs::WINDOWS_1252.encode(&latin).0;
    assert_eq!(read_as("tower.xml", latin).activities, plain.activities);
}

#[test]
fn primavera_xer() {
    let windows = encoding_rs::WINDOWS_1252.encode(XER).0;
    let schedule = read_as("tower.xer", &windows);
    assert_eq!(
        findings(&schedule),
        [("guessed-encoding", 1), ("unknown-predecessor", 1), ("unknown-successor", 1)]
    );
    assert_says(
        message(&schedule, "unknown-predecessor"),
        &["tower.xer: line 29, activity 2", "\"A20\" follows \"77\""],
    );
    assert_eq!(read_as("tower.xer", XER).activities, schedule.activities);
    assert_eq!(schedule.project, "TOWER");
    assert_eq!(schedule.data_date, Some(time("2026-03-10T17:00")));

    let walls = by_id(&schedule, "A10");
    assert_eq!((walls.name.as_str(), walls.percent_complete), ("Walls, Süd", Some(75.0)));
    assert_eq!(schedule.wbs_path(walls), ["Tower", "Shell"]);
    assert_eq!(
        (walls.start, walls.end),
        (Some(time("2026-03-03T08:00")), Some(time("2026-03-09T17:00")))
    );
    assert_eq!(walls.date_sets[DateSet::Planned], dates("2026-03-02T08:00", "2026-03-06T17:00"));
    assert_eq!(walls.date_sets[DateSet::Forecast], dates("2026-03-04T08:00", "2026-03-09T17:00"));
    assert_eq!(walls.date_sets[DateSet::Baseline], dates("2026-02-02T08:00", "2026-02-06T17:00"));
    assert_eq!(
        (field(walls, "Location"), field(walls, "Crew")),
        (Some("L03 - Level 3"), Some("12.5"))
    );
    assert_eq!(field(walls, "status_code"), Some("TK_Active"));

    let done = by_id(&schedule, "A20");
    assert!(done.milestone);
    assert_eq!((done.start, done.percent_complete), (Some(time("2026-03-06T17:00")), Some(25.5)));
    assert_eq!(predecessors(&schedule, "A20"), ["A10 FF -8h"]);
    let summary = by_id(&schedule, "A30");
    assert_eq!((summary.kind, summary.percent_complete), (ActivityKind::Neutral, Some(100.0)));
    // What it refers to is not in the file.
    assert_eq!((summary.wbs, summary.calendar), (None, None));
    // A ring of summaries is opened somewhere.
    assert_eq!(schedule.wbs.iter().filter(|n| n.name == "ring" && n.parent.is_none()).count(), 1);

    assert_eq!((schedule.calendar, walls.calendar), (Some(0), Some(0)));
    assert_eq!(shifts_on(&schedule, 0, "2026-03-02"), ["08:00-12:00", "13:00-17:00"]);
    let exceptions: Vec<String> =
        schedule.calendars[0].exceptions.iter().map(|e| e.first.to_string()).collect();
    assert_eq!(exceptions, ["2026-01-01", "2025-12-24"]);
}

/// Several projects in one file: ids are unique within each only.
#[test]
fn primavera_projects_side_by_side() {
    let both = XER.replace("TOWER-B1\t7\t10\t", "ANNEX\t7\t\t");
    let schedule = read_as("both.xer", both);
    let ids: Vec<&str> = schedule.activities.iter().map(|a| a.id.as_str()).collect();
    assert_eq!(ids, ["TOWER.A10", "TOWER.A20", "TOWER.A30", "ANNEX.A10"]);
    assert_eq!(predecessors(&schedule, "TOWER.A20"), ["TOWER.A10 FF -8h"]);
}

#[test]
fn primavera_xml() {
    let schedule = read_as("tower.xml", PMXML);
    assert_eq!(findings(&schedule), [("unknown-predecessor", 1)]);
    assert_eq!(schedule.project, "Tower");
    assert_eq!(schedule.data_date, Some(time("2026-03-10T17:00")));
    let xer = read_as("tower.xer", XER);
    let (walls, same) = (by_id(&schedule, "A10"), by_id(&xer, "A10"));
    assert_eq!((walls.start, walls.end), (same.start, same.end));
    for set in [DateSet::Planned, DateSet::Actual, DateSet::Baseline] {
        assert_eq!(walls.date_sets[set], same.date_sets[set], "{set:?}");
    }
    assert_eq!(walls.percent_complete, same.percent_complete);
    assert_eq!(schedule.wbs_path(walls), xer.wbs_path(same));
    for name in ["Location", "Crew"] {
        assert_eq!(field(walls, name), field(same, name), "{name}");
    }
    assert_eq!(predecessors(&schedule, "A20"), predecessors(&xer, "A20"));
    assert!(by_id(&schedule, "A20").milestone);
    assert_eq!((schedule.calendar, walls.calendar), (Some(0), Some(0)));
    assert_eq!(shifts_on(&schedule, 0, "2026-03-02"), ["08:00-12:00", "13:00-17:00"]);
    assert!(shifts_on(&schedule, 0, "2025-12-25").is_empty());
    // The baseline's outline is not repeated.
    assert_eq!((schedule.activities.len(), schedule.wbs.len()), (2, 2));
}

#[test]
fn ifc_tasks() {
    let schedule = read_as("tower.ifc", IFC);
    assert_eq!(
        findings(&schedule),
        [("no-dates", 1), ("unknown-predecessor", 1), ("zone-ignored", 1)]
    );
    assert_eq!(schedule.project, "Türme");
    assert_eq!(schedule.data_date, Some(time("2026-03-10T17:00")));
    let summary = by_id(&schedule, "1summary");
    assert_eq!(
        (summary.kind, &*summary.elements),
        (ActivityKind::Neutral, &["G-storey".to_owned()][..])
    );
    let walls = by_id(&schedule, "2walls");
    assert_eq!(walls.name, "Walls /* no comment */");
    assert_eq!(schedule.wbs_path(walls), ["Shell"]);
    // The crew is no product.
    assert_eq!(
        (walls.kind, &*walls.elements),
        (ActivityKind::Construct, &["G-wall".to_owned()][..])
    );
    assert_eq!(
        (walls.start, walls.end),
        (Some(time("2026-03-03T08:00")), Some(time("2026-03-03T17:00")))
    );
    assert_eq!(walls.percent_complete, Some(50.0));
    assert_eq!(
        (field(walls, "Identification"), field(walls, "IsCritical")),
        (Some("W"), Some("T"))
    );
    let gone = by_id(&schedule, "3gone");
    assert_eq!(
        (gone.name.as_str(), gone.kind, gone.milestone),
        ("It's gone", ActivityKind::Demolish, true)
    );
    assert_eq!(gone.start, Some(time("2026-03-04T08:00")));
    assert_eq!(predecessors(&schedule, "3gone"), ["2walls SS -4eh"]);
}

#[test]
fn json_with_everything() {
    let schedule = json(JSON);
    assert_eq!(findings(&schedule), [("unknown-predecessor", 1)]);
    let walls = by_id(&schedule, "A10");
    // No start of its own: the actual one counts, and the planned end, whose day is over.
    assert_eq!(
        (walls.start, walls.end),
        (Some(time("2026-03-03T08:00")), Some(time("2026-03-07")))
    );
    assert_eq!((schedule.wbs_path(walls), walls.calendar), (vec!["Site", "SH"], Some(0)));
    assert_eq!(walls.percent_complete, Some(62.5));
    let done = by_id(&schedule, "A20");
    assert!(done.milestone);
    assert_eq!(predecessors(&schedule, "A20"), ["A10 FS 0h", "A10 FF -1eh"]);
    assert_eq!(field(done, "crew"), Some("[1, {\"a\": 2}]"));
    assert_eq!(schedule.data_date, Some(time("2026-03-10")));
    assert!(shifts_on(&schedule, 0, "2026-12-25").is_empty());
}

/// Members of these names that are of another kind are fields, as they were before topout knew them.
#[test]
fn json_with_other_uses_of_the_names() {
    let dates = r#""start": "2026-01-01", "end": "2026-01-02""#;
    let text = format!(
        r#"{{"wbs": "free text", "calendar": "5 days", "activities": [{{"id": "A", {dates},
            "wbs": "A.1", "calendar": 3, "predecessors": "B;C", "milestone": "perhaps",
            "percent_complete": "half"}}]}}"#
    );
    let schedule = json(text);
    assert_eq!(findings(&schedule), []);
    let a = by_id(&schedule, "A");
    for (name, value) in [
        ("wbs", "A.1"),
        ("calendar", "3"),
        ("predecessors", "B;C"),
        ("milestone", "perhaps"),
        ("percent_complete", "half"),
    ] {
        assert_eq!(field(a, name), Some(value));
    }
    assert_eq!(schedule.fields.len(), 2);
}

#[test]
fn references_that_lead_nowhere() {
    let dates = r#""start": "2026-01-01", "end": "2026-01-02""#;
    let schedule = json(format!(
        r#"{{"wbs": [{{"code": "S"}}, 7], "calendars": [{{"week": {{"mon": ["8-12"]}}}}],
            "activities": [{{"id": "A", {dates}, "wbs": 9, "calendar": 9}},
                           {{"id": "B", {dates}, "wbs": 1, "predecessors": [["A"], 1]}}]}}"#
    ));
    assert_eq!(
        findings(&schedule),
        [("lost-reference", 2), ("unknown-predecessor", 1), ("wrong-type", 3)]
    );
    assert_says(
        message(&schedule, "lost-reference"),
        &["plan.json: line 2, activity 1", "a summary"],
    );
    assert_eq!((by_id(&schedule, "A").wbs, by_id(&schedule, "B").wbs), (None, Some(1)));
}

fn mapped(columns: &[(&str, Column)]) -> ReadOptions {
    let columns = columns.iter().map(|&(name, column)| (name.to_owned(), column)).collect();
    ReadOptions { columns, ..ReadOptions::default() }
}

const MAPPING: [(&str, Column); 8] = [
    ("task", Column::Id),
    ("Title", Column::Name),
    ("Begin", Column::Start),
    ("Planned", Column::StartOf(DateSet::Planned)),
    ("Done", Column::PercentComplete),
    ("Path", Column::Wbs),
    ("After", Column::Predecessors),
    ("trade", Column::Ignored),
];

#[test]
fn tables_by_a_mapping() {
    let schedule =
        read_bytes("plan.csv".as_ref(), CSV.replace("62,5", "62.5").as_bytes(), &mapped(&MAPPING))
            .expect("a schedule");
    assert_eq!(
        findings(&schedule),
        [("guessed-dates", 1), ("guessed-separator", 1), ("unknown-predecessor", 1)]
    );
    let walls = by_id(&schedule, "A10");
    assert_eq!((walls.start, walls.end), (Some(time("2026-03-02")), Some(time("2026-03-07"))));
    assert_eq!(walls.date_sets[DateSet::Planned].start, Some(time("2026-03-01")));
    assert_eq!((walls.percent_complete, walls.elements.len()), (Some(62.5), 2));
    assert_eq!((schedule.wbs_path(walls), schedule.wbs.len()), (vec!["Site", "Shell"], 2));
    assert_eq!(predecessors(&schedule, "A20"), ["A10 FF -1h"]);
    assert!(walls.fields.is_empty());
    assert_eq!(by_id(&schedule, "A20").predecessors[0].kind, LinkKind::FinishFinish);

    let error = read_bytes("p.csv".as_ref(), CSV.as_bytes(), &mapped(&[("Ort", Column::Wbs)]));
    assert_says(&error.expect_err("no such column").to_string(), &["\"Ort\"", "Task, Title"]);
    let error = read_bytes("p.csv".as_ref(), CSV.as_bytes(), &mapped(&MAPPING[1..]));
    assert_says(&error.expect_err("no id").to_string(), &["lacks id"]);
}

#[test]
fn other_dates_can_count() {
    let mut schedule = read_as("tower.xer", XER);
    // A20 and A30 have no baseline and keep their dates.
    assert_eq!(schedule.use_dates(DateSet::Baseline), 2);
    let walls = by_id(&schedule, "A10");
    assert_eq!(
        (walls.start, walls.end),
        (Some(time("2026-02-02T08:00")), Some(time("2026-02-06T17:00")))
    );
    assert_eq!(schedule.period.start, time("2026-02-02T08:00"));
    assert_eq!(by_id(&schedule, "A20").start, Some(time("2026-03-06T17:00")));
}

/// Files of several formats together: what they number is told apart.
#[test]
fn formats_together() {
    let files = || Files::new().add("t.xml", MSPDI).add("t.json", JSON).add("t.ifc", IFC);
    let schedule = files().add("t.xer", XER).read();
    assert_eq!(schedule.activities.len(), 4 + 2 + 3 + 3 - 2, "A10 and A20 are there twice");
    for (id, path) in [("3", "Site/Shell"), ("A10", "Site/SH"), ("2walls", "Shell")] {
        assert_eq!(schedule.wbs_path(by_id(&schedule, id)).join("/"), path);
    }
    assert_eq!(predecessors(&schedule, "3gone"), ["2walls SS -4eh"]);
    assert_eq!(by_id(&schedule, "A10").calendar, Some(2));
}

/// What is kept of an activity with a name, all dates, nine fields and two or three links.
#[test]
fn a_kilobyte_an_activity() {
    let columns = [
        "task_id",
        "proj_id",
        "task_code",
        "task_name",
        "task_type",
        "status_code",
        "guid",
        "target_drtn_hr_cnt",
        "remain_drtn_hr_cnt",
        "total_float_hr_cnt",
        "free_float_hr_cnt",
        "cstr_type",
        "cstr_date",
        "act_start_date",
        "act_end_date",
        "target_start_date",
        "target_end_date",
        "early_start_date",
        "early_end_date",
    ];
    let day = "2026-03-02 08:00";
    let dates = [day; 7].join("\t");
    let mut tasks = format!("ERMHDR\t22\n%T\tTASK\n%F\t{}\n", columns.join("\t"));
    let mut links = "%T\tTASKPRED\n%F\ttask_id\tpred_task_id\tpred_type\tlag_hr_cnt\n".to_owned();
    for n in 1..=2000 {
        tasks += &format!(
            "%R\t{n}\t1\tA{n:06}\tReinforced concrete walls, level 12, axis C to D\tTT_Task\t\
             TK_NotStart\tygi/8weKMUKMiLdcOaqdlA\t40\t40\t16\t0\tCS_MSO\t{dates}\n"
        );
        for before in 1..=2 + n % 2 {
            links += &format!("%R\t{n}\t{}\tPR_SS\t8\n", (n - before).max(1));
        }
    }
    let schedule = read_as("plan.xer", tasks + &links + "%E\n");
    let tally = schedule.tally();
    assert_eq!((tally.activities, tally.predecessors, tally.without_dates), (2000, 5000, 0));
    assert_eq!(schedule.activities[0].fields.len(), 9);
    assert!(schedule.bytes() / 2000 <= 1024, "{} bytes an activity", schedule.bytes() / 2000);
}
