//! Damaged files of every format: reading ends with a schedule or with an error that names the file.

mod support;

use proptest::prelude::*;
use support::fixtures::{CSV, IFC, JSON, LOG, MSPDI, PMXML, XER};
use support::*;
use topout_schedule::{
    Comparison, DateSet, ReadError, ReadOptions, Schedule, presence, read_bytes,
};

const ALL: [(&str, &str); 7] = [
    ("plan.xml", MSPDI),
    ("plan.xer", XER),
    ("p6.xml", PMXML),
    ("plan.ifc", IFC),
    ("plan.json", JSON),
    ("plan.csv", CSV),
    ("log.csv", LOG),
];

fn try_read(name: &str, bytes: &[u8]) -> Result<Schedule, ReadError> {
    read_bytes(name.as_ref(), bytes, &ReadOptions::default())
}

/// What was read keeps its rules; what was not is an error in words.
fn survives(name: &str, bytes: &[u8]) {
    match try_read(name, bytes) {
        Ok(schedule) => {
            let count = schedule.activities.len();
            for activity in &schedule.activities {
                let links = &activity.predecessors;
                assert!(links.iter().all(|link| (link.activity as usize) < count));
                assert!(activity.wbs.is_none_or(|node| (node as usize) < schedule.wbs.len()));
                assert!(activity.calendar.is_none_or(|c| (c as usize) < schedule.calendars.len()));
                assert!(schedule.wbs_path(activity).len() <= schedule.wbs.len());
                let elements = activity.elements.len();
                assert!(activity.element_fields.iter().all(|f| f.values.len() == elements));
            }
            let _ = (presence(&schedule.kinds, &schedule.activities), schedule.tally());
            let _ = Comparison::of_flags(&schedule);
            let slips = Comparison::of_sets(&schedule, DateSet::Planned, DateSet::Actual).slips;
            assert_eq!(slips.len(), count);
            assert!(slips.iter().all(|slip| slip.working_days.is_finite()));
            schedule.write_json(std::io::sink()).expect("dates that were read can be written");
            schedule.write_csv(std::io::sink()).expect("dates that were read can be written");
        }
        Err(ReadError::NoReadableDates { first }) => assert_says(&first, &[name]),
        Err(ReadError::UnknownEncoding { .. }) => {}
        Err(error) => assert_says(&error.to_string(), &[name]),
    }
}

#[test]
fn cut_at_every_byte() {
    for (name, text) in ALL {
        for end in 0..text.len() {
            survives(name, &text.as_bytes()[..end]);
        }
    }
}

/// Every byte is changed in two ways: one bit, and to something that means a lot in this format.
#[test]
fn every_byte_flipped() {
    for (name, text) in ALL {
        let mut bytes = text.as_bytes().to_vec();
        for at in 0..bytes.len() {
            let was = bytes[at];
            bytes[at] = was ^ (1 << (at % 8));
            survives(name, &bytes);
            bytes[at] = b"<>'\"();#\t\n&{}[],\\/\0"[at % 19];
            survives(name, &bytes);
            bytes[at] = was;
        }
    }
}

#[test]
fn what_is_cut_off_is_said() {
    let cut = |text: &str, at: &str| text[..text.find(at).expect("it is there")].to_owned();
    let said =
        |name: &str, text: String| try_read(name, text.as_bytes()).expect_err("cut").to_string();
    assert_says(
        &said("plan.xml", cut(MSPDI, "<Type>3")),
        &["plan.xml: line 23: byte ", "ends within the element \"PredecessorLink\""],
    );
    assert_says(&said("p6.xml", cut(PMXML, "</Project>")), &["p6.xml: line 16", "\"Project\""]);
    assert_says(&said("plan.json", cut(JSON, "\"A20\"")), &["plan.json: line 8 column 9"]);
    for (name, text) in [("plan.xer", cut(XER, "%E")), ("plan.ifc", cut(IFC, "END-ISO"))] {
        let schedule = try_read(name, text.as_bytes()).expect("what is there");
        assert_says(message(&schedule, "no-end"), &[name, "cut off"]);
    }
}

#[test]
fn broken_xml() {
    for (content, says) in [
        ("<Project><Tasks></Project>", "Tasks"),
        ("<Project>&lol;</Project>", "&lol;"),
        ("<Project>&#xFFFFFFFF;</Project>", "&#xFFFFFFFF;"),
        ("<Schedule/>", "\"Schedule\""),
        ("<?xml version=\"1.0\"?>", "no element"),
        ("<?xml version=\"1.0\" encoding=\"klingon\"?><Project/>", "klingon"),
        ("<Project><Name>\u{0}</Name", "plan.xml"),
    ] {
        let said = try_read("plan.xml", content.as_bytes()).expect_err(content).to_string();
        assert_says(&said, &[says]);
    }
    let said = try_read("plan.xml", b"<?xml version=\"1.0\"?><Project><Name>\xE4</Name></Project>");
    assert_says(&said.expect_err("no UTF-8").to_string(), &["plan.xml: line 1: byte 37", "0xE4"]);
}

/// Neither entities nor depth nor length make it take more memory than a file's size justifies.
#[test]
fn bombs() {
    let entities = "<!DOCTYPE Project [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;\">]>\n\
                    <Project><Name>&b;</Name></Project>";
    let said = try_read("bomb.xml", entities.as_bytes()).expect_err("a DTD").to_string();
    assert_says(&said, &["bomb.xml: line 1", "DTD"]);
    let outside =
        "<?xml version=\"1.0\"?><!DOCTYPE Project SYSTEM \"file:///etc/passwd\"><Project/>";
    assert_says(&try_read("b.xml", outside.as_bytes()).expect_err("a DTD").to_string(), &["DTD"]);

    let deep = "<Project>".repeat(200_000);
    let said = try_read("deep.xml", deep.as_bytes()).expect_err("too deep").to_string();
    assert_says(&said, &["deep.xml: line 1", "64 elements within each other"]);
    let deep = format!("ISO-10303-21;\n#1=IFCTASK({}", "(".repeat(1_000_000));
    survives("deep.ifc", format!("{deep});").as_bytes());

    // One text of more than 64 MiB, in each format that has texts of any length.
    let long = "x".repeat(65 << 20);
    for (name, content) in [
        ("long.xml", format!("<Project><Name>{long}</Name></Project>")),
        ("long.json", format!("{{\"activities\": [{{\"id\": \"{long}\"}}]}}")),
        ("long.csv", format!("id,name,start,end\nA,\"{long}\n")),
        ("long.xer", format!("ERMHDR\t1\n%T\tTASK\n%R\t{long}\n")),
        ("long.ifc", format!("ISO-10303-21;\n#1=IFCTASK('{long}');\n")),
    ] {
        let said = try_read(name, content.as_bytes()).expect_err("too long").to_string();
        assert_says(&said, &[&format!("{name}: line "), "bytes in one piece"]);
    }
}

/// A field that is longer than anybody reads is cut, the rest is read.
#[test]
fn long_fields_are_cut() {
    let note = "ä".repeat(1 << 20);
    let text = MSPDI.replace("wet & cold", &note);
    let schedule = try_read("plan.xml", text.as_bytes()).expect("a schedule");
    assert_eq!(field(by_id(&schedule, "3"), "Notes").map(str::len), Some(1 << 20));
    assert_says(message(&schedule, "long-text"), &["plan.xml: line 18", "\"Notes\"", "2097152"]);
}

/// What cannot be read in one place is said and left out; the rest counts.
#[test]
fn bad_values_name_their_place() {
    for (name, text, from, to, code, says) in [
        (
            "p.xml",
            MSPDI,
            "2026-03-04T08:00:00",
            "4 March",
            "bad-date",
            "line 21: start of \"4\": \"4 March\"",
        ),
        ("p.xml", MSPDI, ">40<", ">400<", "bad-percent", "percent complete of \"3\" is \"400\""),
        (
            "p.xer",
            XER,
            "2026-03-02 08:00",
            "02-Mar-26",
            "bad-date",
            "line 28, activity 1: target_start_date of \"A10\": \"02-Mar-26\"",
        ),
        (
            "p.xer",
            XER,
            "(0||CalendarData",
            "(0|CalendarData",
            "bad-calendar",
            "line 8: the hours of calendar \"5 days\"",
        ),
        ("p.xer", XER, "%R\t50", "%X\t50", "unknown-row", "line 37: \"%X\""),
        (
            "p.xml",
            PMXML,
            "2026-03-06T17:00:00",
            "6.3.",
            "bad-date",
            "PlannedFinishDate of \"A10\": \"6.3.\"",
        ),
        (
            "p.ifc",
            IFC,
            "2026-03-02T08:00:00",
            "tomorrow",
            "bad-date",
            "ScheduleStart of \"2walls\": \"tomorrow\"",
        ),
        ("p.ifc", IFC, "$,#21,", "$,=21,", "bad-statement", "line 12: #20=IFCTASK"),
        (
            "p.ifc",
            IFC,
            "IFCDURATION('-PT4H')",
            "IFCRATIOMEASURE(0.5)",
            "unknown-lag",
            "line 16: the lag #40",
        ),
        ("p.ifc", IFC, "'IFC4'", "'IFC2X3'", "unknown-format", "IFC2X3"),
    ] {
        let broken = text.replacen(from, to, 1);
        assert_ne!(broken, text, "{from}");
        let schedule = try_read(name, broken.as_bytes()).expect(code);
        assert_says(message(&schedule, code), &[name, says]);
    }
}

/// Made-up files: as random as bytes can be, and from the words of a format.
fn words(of: &str) -> Vec<String> {
    let split = of.split_inclusive(['<', '>', '\t', '\n', ',', ';', '(', ')', '"', ':']);
    split.map(str::to_owned).collect()
}

macro_rules! fuzz {
    ($($test:ident: $name:literal, $text:expr, $head:literal;)*) => {
        proptest! {
            $(
                #[test]
                fn $test(
                    bytes in prop::collection::vec(any::<u8>(), 0..200),
                    words in prop::collection::vec(prop::sample::select(words($text)), 0..80),
                ) {
                    let head = $head.as_bytes();
                    survives($name, &[head, &bytes].concat());
                    survives($name, &[head, words.concat().as_bytes()].concat());
                }
            )*
        }
    };
}

fuzz! {
    fuzz_mspdi: "f.xml", MSPDI, "<Project><Tasks><Task>";
    fuzz_pmxml: "f.xml", PMXML, "<APIBusinessObjects><Project>";
    fuzz_xer: "f.xer", XER, "ERMHDR\t\n%T\tTASK\n%F\ttask_id\tproj_id\ttask_code\tact_start_date\n";
    fuzz_ifc: "f.ifc", IFC, "ISO-10303-21;\n";
    fuzz_json: "f.json", JSON, "{\"activities\": [";
    fuzz_csv: "f.csv", CSV, "id,name,start,end,elements\n";
    fuzz_log: "f.csv", LOG, "guid,task,start,finish\n";
}
