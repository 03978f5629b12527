//! The readers of tables: schedules and links files.

mod support;

use support::*;
use topout_schedule::ActivityKind;

#[test]
fn a_schedule_with_all_columns() {
    let schedule = csv("ID,Name,Start,End,Kind,Active,Elements,Trade,Storey\n\
         A1,\"Walls, north\",2026-03-03,2026-03-04,,yes,W1;W2; W3 ;;W1,Masonry,2\n\
         A2,Crane,2026-03-01 07:00,2026-06-01T17:30:00,temporary,0,C1,,\n");
    assert_eq!(findings(&schedule), []);
    let a = by_id(&schedule, "A1");
    assert_eq!(a.name, "Walls, north");
    assert_eq!((a.start, a.end), (Some(time("2026-03-03")), Some(time("2026-03-05"))));
    assert_eq!(a.elements, ["W1", "W2", "W3"]);
    assert_eq!((a.kind, a.active), (ActivityKind::Construct, true));
    assert_eq!((field(a, "Trade"), field(a, "Storey")), (Some("Masonry"), Some("2")));
    let b = by_id(&schedule, "A2");
    assert_eq!((b.kind, b.active), (ActivityKind::Temporary, false));
    assert_eq!(b.end, Some(time("2026-06-01T17:30")));
    assert!(b.fields.is_empty());
}

#[test]
fn semicolons_and_bars() {
    let schedule = csv("activity_id;name;start;finish;elements\n\
                        A1;Walls, doors;2026-03-03;2026-03-04;W1| W2|;\n");
    assert_eq!(findings(&schedule), [("guessed-separator", 1)]);
    let a = by_id(&schedule, "A1");
    assert_eq!(a.name, "Walls, doors");
    assert_eq!(a.elements, ["W1", "W2"]);
}

/// In a file of commas the bar belongs to the name.
#[test]
fn bars_in_a_file_of_commas() {
    let schedule = csv("id,name,start,end,elements\nA,a,2026-01-01,2026-01-02,W|1;W|2\n");
    assert_eq!(schedule.activities[0].elements, ["W|1", "W|2"]);
}

#[test]
fn marks_line_ends_and_empty_lines() {
    let schedule = csv("\u{feff}id,name,start,end\r\n\r\nA,a,2026-01-01,2026-01-02\r\n,,,\r\n\
         B,\"two\r\nlines\",2026-01-01,2026-01-02\r\nC,c,2026-01-xx,2026-01-02\r\n");
    assert_eq!(schedule.activities.len(), 3);
    assert_eq!(by_id(&schedule, "B").name, "two\r\nlines");
    // Lines are those of the file, also after an empty one and after a text of two lines.
    assert_says(message(&schedule, "bad-date"), &["plan.csv: line 7:", "2026-01-xx"]);
    for end in ["\n", "\r\n", "\r"] {
        let rows = ["id,name,start,end", "A,a,2026-01-01,2026-01-02", "B,b,2026-01-01,x"];
        let schedule = csv(rows.join(end));
        assert_says(message(&schedule, "bad-date"), &["plan.csv: line 3:"]);
    }
}

#[test]
fn short_rows_lack_their_last_cells() {
    let schedule = csv("id,name,start,end,kind,trade\nA,a,2026-01-01,2026-01-02\n");
    assert_eq!(findings(&schedule), []);
    assert_eq!(schedule.activities[0].kind, ActivityKind::Construct);
}

#[test]
fn rows_with_a_cell_too_many_are_left_out() {
    let schedule = csv("id,name,start,end\nA,a,2026-01-01,2026-01-02,\n\
                        B,Walls, north,2026-01-01,2026-01-02\n");
    assert_eq!(schedule.activities.len(), 1);
    assert_says(message(&schedule, "too-many-cells"), &["plan.csv: line 3", "5 cells", "quotes"]);
}

#[test]
fn dates_in_another_order() {
    let content = "id,name,start,end\nB,b,2-3-2015,04-03-2015 16:00\nA,a,26-2-2015,27-02-2015\n";
    let files = Files::new().add("plan.csv", content);
    // A day above 12 shows the order, and what was made of it is said.
    let guessed = files.read();
    assert_eq!(findings(&guessed), [("guessed-dates", 1)]);
    let said = message(&guessed, "guessed-dates");
    assert_says(said, &["plan.csv", "day first", "2-3-2015 is 2015-03-02", "--date-format"]);
    let schedule = files.try_read(&with_format("%d-%m-%Y")).expect("a schedule");
    assert_eq!(findings(&schedule), []);
    assert_eq!(guessed.activities, schedule.activities);
    assert_eq!(by_id(&schedule, "A").start, Some(time("2015-02-26")));
    assert_eq!(by_id(&schedule, "A").end, Some(time("2015-02-28")));
    assert_eq!(by_id(&schedule, "B").end, Some(time("2015-03-04T16:00")));
}

#[test]
fn date_formats() {
    let read = |format: &str, start: &str| {
        let content =
            format!("id,name,start,end\nA,a,{start},{start}\nB,b,2026-01-01,2026-01-02\n");
        let schedule = Files::new().add("p.csv", content).try_read(&with_format(format))?;
        Ok::<_, topout_schedule::ReadError>((
            schedule.activities[0].start,
            schedule.activities[0].end,
        ))
    };
    let day = (Some(time("2015-02-03")), Some(time("2015-02-04")));
    let at_eight = (Some(time("2015-02-03T08:30")), Some(time("2015-02-03T08:30")));
    for (format, text, expected) in [
        ("%d-%m-%Y", "03-02-2015", day),
        ("%d.%m.%y", "03.02.15", day),
        ("%m/%d/%Y", "2/3/2015", day),
        ("%d %b %Y", "03 Feb 2015", day),
        ("%Y%m%d", "20150203", day),
        ("%d.%m.%Y %H:%M", "03.02.2015 08:30", at_eight),
        ("%m/%d/%Y %I:%M %p", "02/03/2015 08:30 AM", at_eight),
        ("%d-%m-%Y", "03-02-2015T08:30:00", at_eight),
        ("%d.%m.%Y %H:%M", "2015-02-03 08:30", at_eight),
        ("%d-%m-%Y", "03-02-15", (None, None)),
        ("%d-%m-%Y", "03-02-2015 08:30 +01:00", (None, None)),
        ("%Y-%d-%m", "2015-03-02", day),
        // ISO cannot be told from this format, so it is not tried.
        ("%Y-%d-%m", "2015-02-30", (None, None)),
    ] {
        if format == "%Y-%d-%m" {
            let content =
                format!("id,name,start,end\nA,a,{text},{text}\nB,b,2026-01-01,2026-02-01\n");
            let files = Files::new().add("p.csv", content);
            let schedule = files.try_read(&with_format(format)).expect("a schedule");
            let a = &schedule.activities[0];
            assert_eq!((a.start, a.end), expected, "{format} {text}");
            continue;
        }
        assert_eq!(read(format, text).expect("a schedule"), expected, "{format} {text}");
    }
    for bad in ["%Y-%m-%d %z", "%Q", "%H:%M", "%Y", "%d-%m-%Y %I:%M", "date", ""] {
        let said = read(bad, "2015-02-03").expect_err(bad).to_string();
        assert_says(&said, &[&format!("{bad:?}"), "%d-%m-%Y"]);
    }
}

#[test]
fn encodings() {
    let text = "id,name,start,end\nA,Außenwände – Süd,2026-01-01,2026-01-02\n";
    let windows = encoding_rs::WINDOWS_1252.encode(text).0;
    let files = Files::new().add("plan.csv", &windows);
    let guessed = files.read();
    assert_eq!(findings(&guessed), [("guessed-encoding", 1)]);
    assert_says(message(&guessed, "guessed-encoding"), &["plan.csv", "windows-1252", "--encoding"]);
    let schedule = files.try_read(&with_encoding("windows-1252")).expect("a schedule");
    assert_eq!(findings(&schedule), []);
    assert_eq!(schedule.activities[0].name, "Außenwände – Süd");
    assert_eq!(guessed.activities, schedule.activities);
    let said = files.try_read(&with_encoding("utf-8")).expect_err("not UTF-8").to_string();
    assert_says(&said, &["plan.csv: line 2", "byte 23", "0xDF", "UTF-8", "declared"]);

    let utf16: Vec<u8> =
        "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let schedule = csv(utf16);
    assert_eq!(schedule.activities[0].name, "Außenwände – Süd");

    let wrong = Files::new().add("plan.csv", &windows).try_read(&with_encoding("shift_jis"));
    assert_says(
        &wrong.expect_err("not Japanese").to_string(),
        &["line 2", "Shift_JIS", "declared"],
    );
    let unknown = Files::new().add("plan.csv", text).try_read(&with_encoding("klingon"));
    assert_says(&unknown.expect_err("no such encoding").to_string(), &["klingon"]);
}

/// JSON is UTF-8 whatever is declared for tables.
#[test]
fn the_declared_encoding_is_for_tables() {
    let table =
        encoding_rs::WINDOWS_1252.encode("id,name,start,end\nA,ä,2026-01-01,2026-01-02\n").0;
    let files = Files::new().add("a.csv", table).add(
        "b.json",
        r#"{"activities": [{"id": "B", "name": "ö", "start": "2026-01-01", "end": "2026-01-02"}]}"#,
    );
    let schedule = files.try_read(&with_encoding("latin1")).expect("a schedule");
    assert_eq!(
        (schedule.activities[0].name.as_str(), schedule.activities[1].name.as_str()),
        ("ä", "ö")
    );
}

const PLAN: &str = "id,name,start,end,elements\n\
                    A,a,2026-01-01,2026-01-02,E1\nB,b,2026-01-03,2026-01-04,\n";

#[test]
fn links_in_any_order() {
    let links = "guid,activity_id,quality\nE2,A,good\nE1,A,good\nE3,B,poor\nE2,A,good\n";
    let files = || Files::new().add("plan.csv", PLAN).add("links.csv", links);
    for schedule in [files().read(), files().reversed().read()] {
        assert_eq!(findings(&schedule), []);
        assert_eq!(by_id(&schedule, "A").elements, ["E1", "E2"]);
        assert_eq!(by_id(&schedule, "B").elements, ["E3"]);
    }
}

#[test]
fn links_by_element_name_and_with_semicolons() {
    let links = "Activity_ID;Element\nB;Wall 1, north\n";
    let schedule = Files::new().add("links.csv", links).add("plan.csv", PLAN).read();
    assert_eq!(by_id(&schedule, "B").elements, ["Wall 1, north"]);
    // With both columns the guid goes first, where there is one.
    let links = "guid,element,activity_id\nG1,Wall,A\n,Door,A\n";
    let schedule = Files::new().add("links.csv", links).add("plan.csv", PLAN).read();
    assert_eq!(by_id(&schedule, "A").elements, ["E1", "G1", "Door"]);
}

#[test]
fn links_to_json_activities() {
    let plan = r#"{"activities": [{"id": 7, "start": "2026-01-01", "end": "2026-01-02"}]}"#;
    let links = "element,activity_id\nE,7\n";
    let schedule = Files::new().add("links.csv", links).add("plan.json", plan).read();
    assert_eq!(by_id(&schedule, "7").elements, ["E"]);
}

#[test]
fn links_that_lead_nowhere() {
    let links = "guid,activity_id\nE1,A\nE2,Z9\n,A\nE3,\nE4,Z9\n";
    let schedule = Files::new().add("links.csv", links).add("plan.csv", PLAN).read();
    assert_eq!(findings(&schedule), [("incomplete-link", 2), ("unknown-activity", 2)]);
    let said = message(&schedule, "unknown-activity");
    assert_says(said, &["links.csv: line 3", "\"Z9\"", "\"E2\""]);
    assert_says(message(&schedule, "incomplete-link"), &["links.csv: line 4", "element"]);
}

/// Whoever finds that an element does not exist can say where it was named.
#[test]
fn elements_have_places() {
    let links = "guid,activity_id\nE1,A\nE2,B\nE3,A\n,A\nE3,A\nE4,A\n";
    let twice =
        format!("{PLAN}A,again,2026-01-01,2026-01-02,X\nC,c,2026-01-01,2026-01-02,E5;E5;E6\n");
    let schedule = Files::new().add("links.csv", links).add("plan.csv", twice).read();
    let places = |activity: usize| -> Vec<(&str, String)> {
        let elements = schedule.activities[activity].elements.iter().enumerate();
        let place = |i| schedule.element_place(activity, i);
        elements
            .map(|(i, e)| (e.as_str(), place(i).rsplit('/').next().unwrap_or_default().to_owned()))
            .collect()
    };
    // The link that repeats E1, and the second that names E3, are no elements.
    let expected =
        [("E1", "plan.csv: line 2"), ("E3", "links.csv: line 4"), ("E4", "links.csv: line 7")];
    assert_eq!(places(0), expected.map(|(e, p)| (e, p.to_owned())));
    assert_eq!(places(1), [("E2", "links.csv: line 3".to_owned())]);
    let expected = [("E5", "plan.csv: line 5"), ("E6", "plan.csv: line 5")];
    assert_eq!(places(2), expected.map(|(e, p)| (e, p.to_owned())));
    assert_says(&schedule.place(2), &["plan.csv: line 5"]);
}

/// A table with a start column is a schedule, whatever else it has.
#[test]
fn a_start_column_makes_a_schedule() {
    let schedule = csv("activity_id,guid,name,start,end\nA,G,a,2026-01-01,2026-01-02\n");
    assert_eq!(field(by_id(&schedule, "A"), "guid"), Some("G"));
}

/// A million links, a third of them to one activity: done in passing or not at all.
#[test]
fn a_million_links() {
    let mut plan = String::from("id,name,start,end\n");
    let mut links = String::from("guid,activity_id\n");
    for a in 0..1000 {
        plan.push_str(&format!("A{a},a,2026-01-01,2026-01-02\n"));
    }
    for i in 0..1_000_000 {
        let activity = if i % 3 == 0 { 0 } else { i % 1000 };
        links.push_str(&format!("GUID-{i},A{activity}\n"));
    }
    let schedule = Files::new().add("links.csv", links).add("plan.csv", plan).read();
    let linked: usize = schedule.activities.iter().map(|a| a.elements.len()).sum();
    assert_eq!(linked, 1_000_000);
    assert!(schedule.activities[0].elements.len() > 333_333);
}
