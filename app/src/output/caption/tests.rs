//! Captions are drawn into gradients, so that any pixel that changes is seen.

#![allow(clippy::unwrap_used)]

use super::*;
use topout_schedule::{Activity, Schedule, TimeRange};

fn gradient(width: u32, height: u32) -> Picture {
    let pixel = |x: u32, y: u32| [(x % 251) as u8, (y % 241) as u8, ((x + y) % 239) as u8, 255];
    let rgba = (0..height).flat_map(|y| (0..width).flat_map(move |x| pixel(x, y))).collect();
    Picture { width, height, rgba }
}

fn caption() -> Caption {
    let entry = |name: &str, color, count| LegendEntry { name: name.to_owned(), color, count };
    Caption {
        title: "Tue 3 Mar 2026".to_owned(),
        line: "Week 1 of 125 \u{b7} 12 activities at work".to_owned(),
        legend: vec![
            entry("construct", [0x00, 0x9E, 0x73], Some(1234)),
            entry("demolish", [0xD5, 0x5E, 0x00], None),
        ],
    }
}

fn inside(area: Area, x: u32, y: u32) -> bool {
    (area.x..area.x + area.width).contains(&x) && (area.y..area.y + area.height).contains(&y)
}

#[test]
fn only_its_area_changes() {
    for (width, height) in [(256, 144), (512, 288), (1920, 1080), (144, 256), (3840, 2160)] {
        let mut picture = gradient(width, height);
        let before = picture.clone();
        let area = Scribe::new().draw(&caption(), &mut picture);
        assert!(area.x + area.width <= width && area.y + area.height <= height, "{area:?}");
        let mut changed = 0;
        for y in 0..height {
            for x in 0..width {
                if picture.pixel(x, y) != before.pixel(x, y) {
                    assert!(inside(area, x, y), "({x}, {y}) is outside of {area:?}");
                    changed += 1;
                }
            }
        }
        // All but the round corners.
        assert!(changed * 100 > area.width * area.height * 98, "{changed} of {area:?}");
        assert!(area.height * 5 < height * 4, "{area:?}");
    }
}

#[test]
fn letters_are_crisp_and_legends_have_their_colours() {
    for height in [256, 720, 2160] {
        let mut picture = gradient(height * 16 / 9, height);
        Scribe::new().draw(&caption(), &mut picture);
        let count = |color: [u8; 4]| picture.rgba.chunks(4).filter(|p| **p == color).count();
        let white = picture.rgba.chunks(4).filter(|p| p[..3].iter().all(|&c| c >= 245)).count();
        // The title alone has fourteen letters.
        let letter = (height as usize * 36 / 1000).max(12);
        assert!(white > letter * letter / 2, "{white} white pixels at {height}");
        assert!(count([0x00, 0x9E, 0x73, 255]) >= letter * letter / 8, "{height}");
        assert!(count([0xD5, 0x5E, 0x00, 255]) >= letter * letter / 8, "{height}");
    }
}

#[test]
fn the_panel_of_a_film_does_not_jump() {
    let mut scribe = Scribe::new();
    let long = scribe.draw(&caption(), &mut gradient(640, 360));
    let short = Caption { title: "Fri".to_owned(), line: String::new(), ..caption() };
    let next = scribe.draw(&short, &mut gradient(640, 360));
    assert_eq!(next.width, long.width);
    let alone = Scribe::new().draw(&short, &mut gradient(640, 360));
    assert!(alone.width < long.width, "{alone:?} {long:?}");
}

#[test]
fn any_size_and_any_text_can_be_drawn() {
    let hostile = Caption {
        title: "a\nb\t\u{1}\u{202e}\u{10FFFF}柱".repeat(200),
        line: String::new(),
        legend: vec![
            LegendEntry { name: "x".repeat(5000), color: [9; 3], count: Some(usize::MAX) };
            40
        ],
    };
    for (width, height) in [(1, 1), (2, 90), (90, 2), (40, 30), (320, 180)] {
        for caption in [&hostile, &caption(), &Caption::default()] {
            let mut picture = gradient(width, height);
            let area = Scribe::new().draw(caption, &mut picture);
            assert!(area.x + area.width <= width && area.y + area.height <= height, "{area:?}");
            assert_eq!(picture.rgba.len(), (width * height * 4) as usize);
        }
    }
    let mut nothing = Picture::default();
    assert_eq!(Scribe::new().draw(&caption(), &mut nothing), Area::default());
}

#[test]
fn over_nothing_the_panel_is_as_clear_as_it_is() {
    let mut picture = Picture { width: 400, height: 300, rgba: vec![0; 400 * 300 * 4] };
    let area = Scribe::new().draw(&caption(), &mut picture);
    let [x, y] = [area.x + area.width / 2, area.y + 2];
    assert_eq!(picture.pixel(x, y), PANEL);
    assert_eq!(picture.pixel(399, 0), [0; 4]);
}

fn scene(activities: &[(i64, i64)]) -> Scene {
    const DAY: i64 = 86_400;
    let day = |n: i64| Time::from_seconds(1_772_496_000 + n * DAY); // Tuesday 3 March 2026.
    let activities = activities.iter().enumerate().map(|(i, &(from, to))| Activity {
        id: i.to_string(),
        start: Some(day(from)),
        end: Some(day(to)),
        ..Activity::default()
    });
    let schedule = Schedule {
        period: TimeRange { start: day(0).plus_seconds(8 * 3600), end: day(20) },
        activities: activities.collect(),
        ..Schedule::default()
    };
    Scene { schedule, ..Scene::default() }
}

#[test]
fn a_caption_tells_date_week_and_work() {
    let scene = scene(&[(0, 3), (2, 20), (2, 9)]);
    let at = |day: i64, hour: i64| {
        let time = Time::from_seconds(1_772_496_000 + day * 86_400 + hour * 3600);
        let caption = Caption::at(&scene, time, Colored::Activity);
        let count = caption.legend.iter().filter_map(|entry| entry.count).sum::<usize>();
        (caption.title, caption.line, count)
    };
    let told = |title: &str, line: &str, count| (title.to_owned(), line.to_owned(), count);
    assert_eq!(at(-1, 23), told("Mon 2 Mar 2026", "Before the start · 0 activities at work", 0));
    assert_eq!(at(0, 0), told("Tue 3 Mar 2026", "Week 1 of 4 · 1 activity at work", 1));
    assert_eq!(at(2, 12), told("Thu 5 Mar 2026", "Week 1 of 4 · 3 activities at work", 3));
    assert_eq!(at(7, 0), told("Tue 10 Mar 2026", "Week 2 of 4 · 2 activities at work", 2));
    assert_eq!(at(20, 0), told("Mon 23 Mar 2026", "Week 4 of 4 · 0 activities at work", 0));
    assert_eq!(at(30, 0), told("Thu 2 Apr 2026", "After the end · 0 activities at work", 0));
    let legend = Caption::at(&scene, scene.schedule.period.start, Colored::Slip).legend;
    assert_eq!(legend.len(), SlipClass::WORDS.len());
    assert!(Caption::at(&scene, scene.schedule.period.start, Colored::Own).legend.is_empty());
}

#[test]
fn without_a_schedule_there_are_no_weeks() {
    let caption = Caption::at(&Scene::default(), Time::from_seconds(0), Colored::Activity);
    assert_eq!((&*caption.title, &*caption.line), ("Thu 1 Jan 1970", "0 activities at work"));
    assert!(caption.legend.is_empty());
}
