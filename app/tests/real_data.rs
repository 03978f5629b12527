//! A real house with its real schedule (Schependomlaan, Nijmegen 2015), through the program.
//!
//! The data is not part of the repository: `TOPOUT_REAL_DATA` names its folder. Without the
//! variable these tests pass with a note; with it, a missing folder is a failure.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Folder, number, text, topout};
use std::path::PathBuf;

/// The arguments of the project with its schedule in JSON, and in CSV with a links file.
fn projects() -> Option<[Vec<String>; 2]> {
    let Some(root) = std::env::var_os("TOPOUT_REAL_DATA") else {
        println!("skipped: TOPOUT_REAL_DATA is not set");
        return None;
    };
    let folder = PathBuf::from(root).join("schependomlaan");
    assert!(folder.is_dir(), "TOPOUT_REAL_DATA is set, but {} is missing", folder.display());
    let with = |schedules: &[&str]| {
        let mut args = vec![text(&folder.join("schependomlaan.glb"))];
        for schedule in schedules {
            args.extend(["--schedule".to_owned(), text(&folder.join(schedule))]);
        }
        args
    };
    Some([with(&["schedule.json"]), with(&["schedule.csv", "links.csv"])])
}

#[test]
fn nearly_every_element_is_linked_from_either_format() {
    let Some(projects) = projects() else { return };
    let reports = projects.map(|project| {
        let mut args = vec!["check".to_owned()];
        args.extend(project);
        args.extend(["--json".to_owned(), "-".to_owned()]);
        topout(&args).good_json()
    });
    for report in &reports {
        assert_eq!(report["elements"], 3504);
        assert_eq!(report["triangles"], 260_195);
        assert_eq!(report["activities"], 73);
        assert!(number(report, "linked_elements") >= 3502.0, "{report}");
        assert_eq!(report["unlinked_activities"], 0, "{report}");
        assert_eq!(report["start"], "2015-02-26T00:00:00");
        assert_eq!(report["finish"], "2016-01-01T00:00:00", "the end of 2015-12-31");
    }
    for key in ["linked_elements", "behaviours"] {
        assert_eq!(reports[0][key], reports[1][key], "both formats say the same");
    }
}

/// The log has guids of its own; the rule that is suggested finds the elements by their names.
#[test]
fn an_event_log_with_other_guids_is_linked_by_the_suggested_rule() {
    let Some([project, _]) = projects() else { return };
    let house = PathBuf::from(&project[0]);
    let log = house.with_file_name("eventlog").join("eventlog IFC schependomlaan.csv");
    let log = text(&log);
    let args = ["check", &project[0], "--schedule", &log, "--json", "-"];
    let report = topout(args).good_json();
    assert_eq!(report["linked_elements"], 0);
    let suggestion = &report["suggestions"][0];
    assert_eq!(suggestion["matched"], 3504, "{suggestion}");
    let folder = Folder::new();
    let rules = serde_json::json!({"format": "topout-rules", "rules": [suggestion["rule"]]});
    let rules = folder.write("rules.json", rules.to_string());
    let report = topout(args.iter().chain(&["--rules", rules.as_str()])).good_json();
    assert_eq!(report["linked_elements"], 3504);
    assert_eq!(report["unlinked_activities"], 0, "{report}");
}

/// Foundations, storeys and the house in turn. One activity is linked to every element and ends
/// last: presence must not wait for it.
#[test]
fn the_house_grows() {
    let Some([project, _]) = projects() else { return };
    let folder = Folder::new();
    let mut present = Vec::new();
    let mut ink = Vec::new();
    // One tree is built; at the other dates full detail shows the same and is faster to get.
    for (date, lod) in [
        ("2015-03-20", "batched"),
        ("2015-06-01", "hdlod"),
        ("2015-09-01", "batched"),
        ("2015-12-30", "batched"),
    ] {
        let png = folder.path(&format!("{date}.png"));
        let mut args = vec!["render".to_owned()];
        args.extend_from_slice(&project);
        args.extend(["--at", date, "--lod", lod, "--size", "480x270"].map(str::to_owned));
        args.extend(["--json", "-", "-o"].map(str::to_owned));
        args.push(text(&png));
        let report = topout(&args).good_json();
        present.push(number(&report, "present_elements"));
        ink.push(image::open(&png).unwrap().into_rgb8());
    }
    assert!(present[0] >= 40.0, "foundations: {present:?}");
    assert!(present.windows(2).all(|w| w[1] > 1.2 * w[0]), "{present:?}");
    assert!(present[3] >= 3400.0, "{present:?}");
    let differing =
        |a: usize, b: usize| ink[a].pixels().zip(ink[b].pixels()).filter(|(p, q)| p != q).count();
    for i in 0..3 {
        assert!(differing(i, i + 1) > 1000, "the picture changes after step {i}");
    }
}

/// The tree of a real house keeps its certificates and its promise, in every cluster and picture.
#[test]
fn the_house_is_what_its_tree_says() {
    let Some([project, _]) = projects() else { return };
    let mut args = vec!["verify".to_owned()];
    args.extend_from_slice(&project);
    args.extend(["--size", "640x360", "--json", "-"].map(str::to_owned));
    let report = topout(&args).good_json();
    for key in ["structure_violations", "eps_violations", "gamma_violations", "promise_violations"]
    {
        assert_eq!(report[key], 0, "{key}: {report}");
    }
    assert!(number(&report, "clusters_checked") > 100.0, "{report}");
    assert!(number(&report, "points_checked") > 100_000.0, "{report}");
    assert!(number(&report, "worst_px") <= 1.01, "{report}");
}
