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
