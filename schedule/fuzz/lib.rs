//! What every fuzz target asks of a reader.

#[path = "../tests/support/fixtures.rs"]
pub mod fixtures;

use std::path::Path;
use topout_schedule::{ReadOptions, Schedule, appearance, presence, read_bytes};

/// Writes what a target begins with to a folder of its own.
pub fn write_seeds(target: &str, texts: &[&str]) {
    let folder = Path::new("seeds").join(target);
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    for (number, text) in texts.iter().enumerate() {
        std::fs::write(folder.join(number.to_string()), text).expect("a file can be written");
    }
}

/// Whatever the bytes are, reading ends with an error or with a schedule that keeps its rules and can be
/// written and read again.
pub fn survives(name: &str, bytes: &[u8]) {
    let Ok(schedule) = read_bytes(Path::new(name), bytes, &ReadOptions::default()) else { return };
    let count = schedule.activities.len();
    for activity in &schedule.activities {
        assert!(activity.predecessors.iter().all(|link| (link.activity as usize) < count));
        assert!(activity.wbs.is_none_or(|node| (node as usize) < schedule.wbs.len()));
        assert!(activity.calendar.is_none_or(|c| (c as usize) < schedule.calendars.len()));
        assert!(schedule.wbs_path(activity).len() <= schedule.wbs.len());
    }
    let _ = presence(&schedule.kinds, &schedule.activities);
    let _ = appearance(&schedule.kinds, &schedule.activities);
    let _ = (schedule.tally(), schedule.bytes());
    let _ = schedule.work_calendar().and_then(|c| c.next_work(schedule.period.start));
    let (mut json, mut csv) = (Vec::new(), Vec::new());
    schedule.write_json(&mut json).expect("dates that were read can be written");
    schedule.write_csv(&mut csv).expect("dates that were read can be written");
    for (name, text) in [("again.json", json), ("again.csv", csv)] {
        match read_bytes(Path::new(name), &text, &ReadOptions::default()) {
            Ok(again) => assert_same(&schedule, &again),
            // A schedule in which no date can be used is refused.
            Err(error) => {
                assert!(schedule.activities.iter().all(|a| a.dates().is_none()), "{error}")
            }
        }
    }
}

fn assert_same(one: &Schedule, other: &Schedule) {
    assert_eq!(one.activities, other.activities);
    assert_eq!(one.wbs, other.wbs);
    assert_eq!(one.calendars, other.calendars);
    assert_eq!((one.period, one.data_date), (other.period, other.data_date));
}
