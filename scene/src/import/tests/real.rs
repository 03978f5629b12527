//! Real buildings, where TOPOUT_REAL_DATA says they are.

use super::build::check_rules;
use crate::Progress;
use crate::import::read_model;
use std::path::PathBuf;

/// The folder of real data; `None` (and a note) where the variable is unset.
pub(super) fn real_data() -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("TOPOUT_REAL_DATA") else {
        println!("skipped: TOPOUT_REAL_DATA is not set");
        return None;
    };
    let folder = PathBuf::from(folder);
    assert!(folder.is_dir(), "TOPOUT_REAL_DATA is no folder: {}", folder.display());
    Some(folder)
}

/// Elements and triangles of each file; triangles 0: not known from elsewhere.
const FILES: &[(&str, usize, usize)] = &[
    ("schependomlaan/schependomlaan.glb", 3504, 260_195),
    ("schependomlaan/schependomlaan_instanced_4brokenwindows.glb", 3661, 464_562),
    ("schependomlaan/sub/XELLA-Begane_grond.glb", 750, 0),
    ("schependomlaan/sub/JORDAHL-Gevelderagers.glb", 42, 0),
    ("schependomlaan/sub/BERNTS-Staalconstructie.glb", 965, 0),
    ("duplex/ifc_duplex.glb", 215, 26_348),
    ("duplex/ifc_duplex.native.glb", 286, 0),
    ("duplex/Duplex_models_mep_geometry.glb", 926, 335_822),
    ("bimwhale/ifc_bimwhale_LargeBuilding.glb", 114, 35_458),
    ("bimwhale/ifc_bimwhale_TallBuilding.glb", 55, 5_460),
    ("ifc4_task/ifc_construction_scheduling_task.glb", 6, 72),
];

#[test]
fn real_files_load_completely() {
    let Some(folder) = real_data() else { return };
    for (file, elements, triangles) in FILES {
        let model = read_model(&folder.join(file), &Progress::default()).unwrap();
        assert_eq!(model.elements.len(), *elements, "{file}");
        if *triangles > 0 {
            assert_eq!(model.triangle_count(), *triangles, "{file}");
        }
        assert!(!model.diagnostics.has_errors(), "{file}: {:?}", model.diagnostics);
        check_rules(&model);
    }
}

#[test]
fn storeys_kinds_and_guids_come_from_the_extras() {
    let Some(folder) = real_data() else { return };
    let path = folder.join("schependomlaan/schependomlaan.glb");
    let model = read_model(&path, &Progress::default()).unwrap();
    let storeys: std::collections::BTreeSet<&str> =
        model.elements.iter().map(|e| e.storey.as_str()).collect();
    assert_eq!(storeys.len(), 6, "{storeys:?}");
    assert!(storeys.contains("-1 fundering"));
    let wall = model.elements.iter().find(|e| e.name == "1nOs6Hg0v9fR$sLR1LjIyX").unwrap();
    assert_eq!(wall.guid.as_deref(), Some("1nOs6Hg0v9fR$sLR1LjIyX"));
    assert_eq!(wall.kind, "IfcWallStandardCase");
    assert_eq!(wall.label, "opgaand werk");
    assert_eq!(wall.storey, "-1 fundering");
    // 246 windows and the like share meshes.
    assert!(model.meshes.len() < model.elements.len());
}

/// Extras are kept whole; what exporters write beyond what topout knows is little.
#[test]
fn extras_become_properties() {
    let Some(folder) = real_data() else { return };
    let read = |file: &str| read_model(&folder.join(file), &Progress::default()).unwrap();
    let keys = |model: &crate::Model| -> Vec<String> {
        model.properties.keys().map(str::to_owned).collect()
    };
    for (file, tags) in [
        ("bimwhale/ifc_bimwhale_LargeBuilding.glb", 114),
        ("bimwhale/ifc_bimwhale_TallBuilding.glb", 55),
        ("duplex/ifc_duplex.glb", 215),
    ] {
        let model = read(file);
        assert_eq!(keys(&model), ["guid", "ifcType", "ifcName", "tag"], "{file}");
        let mut tagged = 0;
        for (i, element) in (0..).map(crate::ElementId).zip(&model.elements) {
            assert_eq!(model.property(i, "GUID"), element.guid.as_deref(), "{file}");
            assert_eq!(model.property(i, "ifcType"), Some(&*element.kind), "{file}");
            tagged += usize::from(model.property(i, "tag").is_some());
        }
        assert!(tagged <= tags && tagged * 10 > tags * 9, "{file}: {tagged} of {tags}");
    }
    let house = read("schependomlaan/schependomlaan.glb");
    assert_eq!(keys(&house), ["guid", "ifcType", "ifcName"]);
    let wall = house.elements.iter().position(|e| e.name == "1nOs6Hg0v9fR$sLR1LjIyX").unwrap();
    let above: Vec<&str> = house
        .groups_above(&house.elements[wall])
        .map(|g| house.groups[g.index()].kind.as_str())
        .collect();
    assert_eq!(above.first(), Some(&"IfcBuildingStorey"), "{above:?}");
    let storey = house.groups_above(&house.elements[wall]).next().unwrap();
    let said: Vec<(&str, &str)> = house.group_properties(storey).collect();
    assert!(said.contains(&("ifcName", "-1 fundering")), "{said:?}");
    assert!(house.properties.bytes() < 300_000, "{}", house.properties.bytes());
    assert!(read("duplex/ifc_duplex.native.glb").properties.is_empty());
    // A list has an entry for each value.
    let tasks = read("ifc4_task/ifc_construction_scheduling_task.glb");
    let of = |i| tasks.properties(crate::ElementId(i)).filter(|p| p.0 == "tasks").count();
    assert_eq!((0..6).map(of).sum::<usize>(), 5, "the sixth task is that of a group");
}

fn linked(folder: &std::path::Path, schedules: &[&str]) -> crate::Scene {
    let house = folder.join("schependomlaan");
    let model = read_model(&house.join("schependomlaan.glb"), &Progress::default()).unwrap();
    let paths: Vec<PathBuf> = schedules.iter().map(|s| house.join(s)).collect();
    let schedule = topout_schedule::read_files(&paths, &Default::default()).unwrap();
    crate::link::link(model, schedule)
}

#[test]
fn the_real_schedule_links_to_the_real_house() {
    let Some(folder) = real_data() else { return };
    let scenes =
        [linked(&folder, &["schedule.json"]), linked(&folder, &["schedule.csv", "links.csv"])];
    for scene in &scenes {
        let report = crate::link::report(scene);
        assert_eq!((report.elements, report.activities), (3504, 73));
        assert!(report.linked_elements >= 3502, "{report:?}");
        assert_eq!(report.linked_elements + report.unlinked_elements, 3504);
        assert!(!scene.diagnostics.has_errors(), "{:?}", scene.diagnostics);
    }
    assert_eq!(scenes[0].activity_links, scenes[1].activity_links);
}

/// One activity, the finishing, is linked to every element and starts late; each element stands
/// there from the start of its own first activity all the same.
#[test]
fn the_house_grows_through_the_year() {
    let Some(folder) = real_data() else { return };
    let scene = linked(&folder, &["schedule.json"]);
    let at = |date| scene.present_counts(topout_schedule::Time::parse_iso(date).unwrap());
    let counts: Vec<usize> =
        ["2015-01-01", "2015-03-20", "2015-06-01", "2015-09-01", "2015-12-30", "2016-06-01"]
            .map(|date| at(date).0)
            .to_vec();
    assert!(counts.is_sorted(), "{counts:?}");
    assert!(counts[0] <= 2 && counts[1] > 0 && counts[1] < counts[2], "{counts:?}");
    assert!(counts[2] < counts[3] && counts[3] < counts[4], "{counts:?}");
    assert_eq!(at("2016-06-01"), (3504, 260_195));
    let foundations = scene.model.elements.iter().filter(|e| e.storey == "-1 fundering").count();
    assert!(counts[1] <= foundations + 2, "{counts:?}, {foundations}");
}
