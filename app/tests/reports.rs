//! The reports of `topout check`, word by word, for a project with everything that is wrong and for real files of every
//! format. `UPDATE_GOLDEN=1` writes them anew; read what changed.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Folder, text, topout};
use std::path::{Path, PathBuf};

/// Compares a report, and what it says of folders left out, with the one that is kept.
fn compare(name: &str, args: &[String], folders: &[(&Path, &str)]) {
    let run = topout(["check".to_owned()].iter().chain(args));
    assert!(run.code <= 1, "{name}: {}", run.stderr);
    let mut report = run.stdout;
    for (folder, word) in folders {
        report = report.replace(&format!("{}/", text(folder)), &format!("{word}/"));
    }
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/golden/reports").join(name);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::create_dir_all(golden.parent().unwrap()).unwrap();
        std::fs::write(&golden, &report).unwrap();
    }
    let kept = std::fs::read_to_string(&golden).unwrap();
    assert!(report == kept, "{name} says something else now:\n{report}\nand not:\n{kept}");
}

#[test]
fn a_project_with_everything_that_is_wrong() {
    let folder = Folder::new();
    let model = folder.cubes("house.glb", &["slab", "wall", "wall", "roof", "shed", "door"]);
    let schedule = folder.write(
        "plan.csv",
        "id;name;start;end;kind;elements\n\
         A1;Slab;2-3-2026;13-3-2026;;slab\n\
         A2;Walls;10-3-2026;20-3-2026;;wall|slab\n\
         A3;Roof;16-3-2026;;;roof\n\
         A4;Shed;;;demolish;shed\n\
         A5;Old shed;2-3-2026;4-3-2026;demolish;shed\n\
         A6;Windows;20-3-2026;18-3-2026;;window\n\
         A7;Garage;16-3-2026;20-3-2026;;garage|carport\n\
         A8;Paint;16-3-2026;20-3-2026;weld;door\n",
    );
    let args = [model, "--schedule".to_owned(), schedule];
    let place = folder.path("plan.csv");
    compare("everything.txt", &args, &[(place.parent().unwrap(), "FOLDER")]);
    // As a table: a row for each thing, with its place.
    let table =
        topout(["check"].into_iter().chain(args.iter().map(String::as_str)).chain(["--csv", "-"]));
    let mut rows = table.stdout.lines();
    assert_eq!(rows.next(), Some("section,severity,of,id,name,detail,place"));
    let garage = rows.find(|row| row.contains("A7")).unwrap();
    assert!(garage.starts_with("unlinked-activity,warning,activity,A7,Garage,"), "{garage}");
    assert!(garage.ends_with("plan.csv: line 8"), "{garage}");
}

/// One command a format: Microsoft Project, Primavera P6, IFC, CSV, JSON and an event log.
#[test]
fn real_files_of_every_format() {
    let Some(data) = std::env::var_os("TOPOUT_REAL_DATA").map(PathBuf::from) else {
        println!("skipped: TOPOUT_REAL_DATA is not set");
        return;
    };
    let house = "schependomlaan/schependomlaan.glb";
    let log =
        "schependomlaan/eventlog/Schependomlaan eventlog as planned data incl as built data.csv";
    for (name, model, schedules) in [
        ("project.txt", house, &["schependomlaan/planning_mspdi.xml"][..]),
        ("p6.txt", house, &["schedules/MDL4D.xer"]),
        (
            "ifc.txt",
            "ifc4_task/ifc_construction_scheduling_task.glb",
            &["ifc4_task/construction_scheduling_task.ifc"],
        ),
        ("csv.txt", house, &["schependomlaan/schedule.csv", "schependomlaan/links.csv"]),
        ("json.txt", house, &["schependomlaan/schedule.json"]),
        ("log.txt", house, &[log]),
        ("log_linked.txt", house, &[log, "schependomlaan/links.csv"]),
    ] {
        let path = |file: &str| text(&data.join(file));
        let mut args = vec![path(model)];
        for schedule in schedules {
            args.extend(["--schedule".to_owned(), path(schedule)]);
        }
        compare(name, &args, &[(&data, "DATA")]);
    }
}
