//! Bad input through the program: it names the file, the place and the value, ends with code 1
//! where nothing can be done, and never panics (the runner checks that).
#![allow(clippy::unwrap_used)]

mod common;

use common::{Folder, Run, glb, text, topout};
use serde_json::json;

/// The run fails with code 1, and its message tells all of `told`.
fn assert_refused(run: &Run, told: &[&str]) {
    assert_eq!(run.code, 1, "{}{}", run.stdout, run.stderr);
    let message = format!("{}{}", run.stdout, run.stderr);
    for part in told {
        assert!(message.contains(part), "{part:?} is not told:\n{message}");
    }
}

/// A model that cannot be used: `check` reports it, `bake` and `render` refuse it.
fn assert_unusable_model(model: &str, told: &[&str]) {
    let folder = Folder::new();
    let png = text(&folder.path("a.png"));
    assert_refused(&topout(["check", model]), told);
    assert_refused(&topout(["bake", model]), told);
    assert_refused(&topout(["render", model, "--at", "2026-01-01", "-o", &png]), told);
    let report = topout(["check", model, "--json", "-"]);
    assert_eq!(report.code, 1);
    let finding = report.json()["diagnostics"][0].clone();
    assert_eq!(finding["severity"], "error");
    assert_eq!(finding["count"], 1);
}

#[test]
fn a_missing_model() {
    assert_unusable_model("no/such/house.glb", &["no/such/house.glb", "No such file"]);
}

#[test]
fn a_model_that_is_no_gltf() {
    let folder = Folder::new();
    for (name, content) in [("text.glb", "ISO-10303-21;"), ("empty.glb", ""), ("list.gltf", "[1")] {
        assert_unusable_model(&folder.write(name, content), &[name]);
    }
}

#[test]
fn a_truncated_model() {
    let folder = Folder::new();
    let whole = common::cubes(&["slab"], [0.0; 3]);
    for keep in [11, 30, whole.len() - 60] {
        let model = folder.write("short.glb", &whole[..keep]);
        assert_unusable_model(&model, &["short.glb", "byte"]);
    }
}

#[test]
fn a_model_without_meshes() {
    let folder = Folder::new();
    let document = json!({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
                          "nodes": [{"name": "storey"}]});
    assert_unusable_model(
        &folder.write("bare.glb", glb(&document, &[])),
        &["bare.glb", "geometry"],
    );
}

/// Checks a model of one cube, `slab`, with a schedule.
fn check(name: &str, schedule: &[u8], options: &[&str]) -> Run {
    let folder = Folder::new();
    let model = folder.cubes("house.glb", &["slab"]);
    let schedule = folder.write(name, schedule);
    topout(["check", &model, "--schedule", &schedule].iter().chain(options))
}

#[test]
fn a_missing_schedule() {
    let folder = Folder::new();
    let model = folder.cubes("house.glb", &["slab"]);
    let run = topout(["check", &model, "--schedule", "no/such/plan.csv"]);
    assert_refused(&run, &["no/such/plan.csv", "No such file", "elements"]);
}

#[test]
fn an_empty_schedule() {
    for (name, content) in [("plan.csv", ""), ("plan.json", "  \n"), ("plan.json", "{}")] {
        assert_refused(&check(name, content.as_bytes(), &[]), &[name]);
    }
    let run = check("plan.csv", b"id,name,start,end,elements\n", &[]);
    assert!(run.stdout.contains("plan.csv"), "no activities: {}", run.stdout);
}

#[test]
fn a_bad_date() {
    let csv = "id,name,start,end,elements\nA1,Slab,2026-03-02,2026-03-06,slab\n\
               A2,Wall,2026-02-31,2026-03-13,slab\n";
    assert_refused(&check("plan.csv", csv.as_bytes(), &[]), &["plan.csv", "line 3", "2026-02-31"]);
    let json =
        "{\"activities\": [\n{\"id\": \"A1\", \"start\": \"soon\", \"end\": \"2026-03-06\"}]}";
    assert_refused(&check("plan.json", json.as_bytes(), &[]), &["plan.json", "line 2", "soon"]);
}

#[test]
fn an_id_that_is_there_twice() {
    let csv = "id,name,start,end,elements\nA1,Slab,2026-03-02,2026-03-06,slab\n\
               A1,Wall,2026-03-09,2026-03-13,slab\n";
    assert_refused(&check("plan.csv", csv.as_bytes(), &[]), &["A1", "line 2", "line 3"]);
}

#[test]
fn the_same_id_in_two_schedules() {
    let folder = Folder::new();
    let model = folder.cubes("house.glb", &["slab"]);
    let csv = "id,name,start,end,elements\nA1,Slab,2026-03-02,2026-03-06,slab\n";
    let [one, two] = ["one.csv", "two.csv"].map(|name| folder.write(name, csv));
    let run = topout(["check", &model, "--schedule", &one, "--schedule", &two]);
    assert_refused(&run, &["A1", "one.csv", "two.csv"]);
}

#[test]
fn an_end_before_the_start() {
    let csv = "id,name,start,end,elements\nA1,Slab,2026-04-01,2026-03-01,slab\n";
    let run = check("plan.csv", csv.as_bytes(), &[]);
    assert_refused(&run, &["plan.csv", "line 2", "2026-03-0", "2026-04-01"]);
}

/// Nothing that is there is lost; the name that is not there is told.
#[test]
fn an_unknown_element() {
    let csv = "id,name,start,end,elements\nA1,Slab,2026-03-02,2026-03-06,slab;slap\n";
    let run = check("plan.csv", csv.as_bytes(), &["--json", "-"]);
    let report = run.json();
    assert_eq!(report["linked_elements"], 1);
    assert!(report["diagnostics"].to_string().contains("slap"), "{report}");
}

#[test]
fn a_wrong_encoding() {
    let csv = b"id,name,start,end,elements\nA1,D\xe9molition,2026-03-02,2026-03-06,slab\n";
    let declared = check("plan.csv", csv, &["--encoding", "utf-8"]);
    assert_refused(&declared, &["plan.csv", "line 2", "0xE9", "encoding"]);
    let read = check("plan.csv", csv, &["--encoding", "windows-1252"]);
    assert_eq!(read.code, 0, "{}{}", read.stdout, read.stderr);
    // What nobody declared is guessed, and said.
    let guessed = check("plan.csv", csv, &["--json", "-"]).good_json();
    assert!(guessed["diagnostics"].to_string().contains("windows-1252"), "{guessed}");
    let unknown = check("plan.csv", csv, &["--encoding", "klingon"]);
    assert_refused(&unknown, &["klingon"]);
}

#[test]
fn dates_in_another_format() {
    let csv = "id,name,start,end,elements\nA1,Slab,02-03-2026,06-03-2026,slab\n";
    let told = ["plan.csv", "line 2", "02-03-2026"];
    assert_refused(&check("plan.csv", csv.as_bytes(), &[]), &told);
    assert_refused(&check("plan.csv", csv.as_bytes(), &["--date-format", "%Y/%m/%d"]), &told);
    let read = check("plan.csv", csv.as_bytes(), &["--date-format", "%d-%m-%Y", "--json", "-"]);
    assert_eq!(read.good_json()["start"], "2026-03-02T00:00:00");
}

/// Errors inside a usable file do not keep the rest from being drawn.
#[test]
fn a_picture_in_spite_of_errors() {
    let folder = Folder::new();
    let model = folder.cubes("house.glb", &["slab", "wall"]);
    let schedule = folder.write(
        "plan.csv",
        "id,name,start,end,elements\nA1,Slab,2026-03-02,2026-03-06,slab\nA2,Wall,2026-13-09,,wall\n",
    );
    let png = text(&folder.path("a.png"));
    let args = ["render", &model, "--schedule", &schedule, "--at", "2026-03-05", "-o", &png];
    assert_eq!(topout(args).code, 0);
    assert!(folder.path("a.png").exists());
}
