//! Pages are read by an XML parser, which is stricter than browsers.

#![allow(clippy::unwrap_used)]

use super::*;
use quick_xml::Reader;
use quick_xml::events::Event;
use std::sync::Arc;
use topout_schedule::{DateSets, Dates, Schedule, TimeRange};

const HOSTILE: &str = "</title><script src=\"http://a.b/c.js\">alert('1' && \"2\")</script>\u{1}<img src=x onerror=y>]]>--><!--";

fn day(n: i64) -> Time {
    Time::from_seconds(1_772_323_200 + n * 86_400) // From 1 March 2026 on.
}

fn hostile_scene() -> Scene {
    let mut date_sets = DateSets::default();
    date_sets[DateSet::Planned] = Dates { start: Some(day(0)), end: Some(day(10)) };
    date_sets[DateSet::Actual] = Dates { start: Some(day(1)), end: Some(day(40)) };
    let late = Activity {
        id: HOSTILE.to_owned(),
        name: HOSTILE.to_owned(),
        start: Some(day(1)),
        end: Some(day(40)),
        date_sets,
        ..Activity::default()
    };
    let plain = Activity {
        id: "B".to_owned(),
        name: "Walls & slabs".to_owned(),
        start: Some(day(5)),
        end: Some(day(31)),
        ..Activity::default()
    };
    let mut schedule = Schedule {
        project: HOSTILE.to_owned(),
        period: TimeRange { start: day(0), end: day(45) },
        activities: vec![late, plain],
        ..Schedule::default()
    };
    schedule.diagnostics.add(Severity::Error, "bad", HOSTILE, || HOSTILE.to_owned());
    let model = topout_scene::Model { name: HOSTILE.to_owned(), ..topout_scene::Model::default() };
    let mut scene = Scene { schedule, model: Arc::new(model), ..Scene::default() };
    scene.diagnostics = scene.schedule.diagnostics.clone();
    scene
}

/// The names of all elements and the text between them; panics where the page is no well-formed XML.
fn read(html: &str) -> (Vec<String>, String) {
    let mut reader = Reader::from_str(html);
    reader.config_mut().check_end_names = true;
    let (mut names, mut text, mut depth) = (Vec::new(), String::new(), 0);
    loop {
        match reader.read_event().unwrap() {
            Event::Eof => break,
            Event::Start(e) | Event::Empty(e) if e.name().as_ref() == b"!" => panic!("{e:?}"),
            Event::Start(e) => {
                depth += 1;
                e.attributes().for_each(|a| drop(a.unwrap()));
                names.push(String::from_utf8(e.name().as_ref().to_vec()).unwrap());
            }
            Event::Empty(e) => {
                e.attributes().for_each(|a| drop(a.unwrap()));
                names.push(String::from_utf8(e.name().as_ref().to_vec()).unwrap());
            }
            Event::End(_) => depth -= 1,
            Event::Text(t) => text.push_str(std::str::from_utf8(&t).unwrap()),
            Event::GeneralRef(r) => {
                let name = String::from_utf8(r.to_vec()).unwrap();
                text.push(match &*name {
                    "amp" => '&',
                    "lt" => '<',
                    "gt" => '>',
                    "quot" => '"',
                    "#39" => '\'',
                    other => panic!("&{other};"),
                });
            }
            Event::DocType(_) => {}
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(depth, 0);
    (names, text)
}

#[test]
fn hostile_names_stay_text() {
    let scene = hostile_scene();
    let months = month::months(scene.schedule.period);
    let pictures = vec!["data:image/png;base64,AAAA".to_owned(); months.len()];
    let page = write(&scene, [DateSet::Planned, DateSet::Actual], &months, &pictures);
    let (names, text) = read(&page.html);
    for never in ["script", "iframe", "link", "a", "object"] {
        assert!(!names.iter().any(|name| name == never), "{never}");
    }
    let images = names.iter().filter(|name| *name == "img").count();
    assert_eq!((images, page.pictures), (2, 2), "March and April 2026");
    let shown = HOSTILE.replace('\u{1}', "\u{fffd}");
    assert!(text.contains(&shown), "{text}");
    assert!(text.contains("Walls & slabs"));
    assert!(!page.html.contains("<script"), "nothing runs");
}

#[test]
fn months_tell_what_starts_ends_and_is_at_work() {
    let scene = hostile_scene();
    let months = month::months(scene.schedule.period);
    let [march, april] = &months[..] else { panic!("{months:?}") };
    let counts = |month: &Month| {
        let (_, text) = read(&format!("<a>{}</a>", month_section(&scene, month, "data:,")));
        // `2 activities start`, `1 activity ends`, ...
        let before = text.split(" activit").take(3).map(|before| {
            let digits = before.bytes().rev().take_while(u8::is_ascii_digit).count();
            before[before.len() - digits..].parse::<usize>().unwrap()
        });
        before.collect::<Vec<_>>()
    };
    // B ends at the midnight after 31 March: in March.
    assert_eq!(counts(march), [2, 1, 2]);
    assert_eq!(counts(april), [0, 1, 1]);
    assert_eq!(shown_at(march), day(31).plus_seconds(-1));
}

#[test]
fn what_is_late_is_listed_and_the_curve_drawn() {
    let scene = hostile_scene();
    let page = write(&scene, [DateSet::Planned, DateSet::Actual], &[], &[]);
    assert_eq!(page.late, 1);
    let (_, text) = read(&page.html);
    // It was to end at the midnight before 11 March.
    assert!(text.contains("Late activities (1)") && text.contains("2026-03-10"), "{text}");
    // Planned are 10 days and 26: of the 10 all is done on day 40, of the 26 nothing is known.
    let (time, planned, actual) = page.progress.unwrap();
    assert_eq!((time, planned), (day(40), 1.0));
    assert!((actual - 10.0 / 36.0).abs() < 1e-6, "{actual}");
    assert_eq!(page.html.matches("<polyline ").count(), 2);
    let (_, text) = read(&write(&scene, [DateSet::Planned, DateSet::Forecast], &[], &[]).html);
    assert!(text.contains("No activity has both planned and forecast dates"), "{text}");
}

#[test]
fn what_should_have_ended_is_late() {
    let mut scene = hostile_scene();
    let both = [DateSet::Planned, DateSet::Actual];
    scene.schedule.activities[0].date_sets[DateSet::Actual].end = None;
    for (known, late) in [(None, 0), (Some(day(9)), 0), (Some(day(10)), 1)] {
        scene.schedule.data_date = known;
        let page = write(&scene, both, &[], &[]);
        assert_eq!((page.late, page.html.contains("not yet")), (late, late == 1), "{known:?}");
    }
}

#[test]
fn a_project_without_schedule_has_a_page() {
    let scene = Scene::default();
    let months = month::months(scene.schedule.period);
    let page = write(&scene, [DateSet::Planned, DateSet::Actual], &months, &["data:,".to_owned()]);
    let (names, text) = read(&page.html);
    assert!(text.contains("0 elements") && page.progress.is_none());
    assert!(!names.iter().any(|name| name == "svg"));
}
