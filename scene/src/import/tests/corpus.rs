//! The glTF validator's own test files: small, strange, most of them wrong on purpose, each with
//! a report of what is wrong.

use super::build::check_rules;
use super::real::real_data;
use crate::Progress;
use crate::import::{ImportError, read_model};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Files without errors in their report that are refused all the same, and why.
const REFUSED: &[(&str, &str)] = &[
    ("base/data/asset/min_version_valid.gltf", "needs glTF 2.1"),
    ("base/data/buffer/non_relative_uri.gltf", "its buffer lies on another machine"),
    ("base/data/root/named_objects.gltf", "its buffer has no bytes"),
    ("base/data/root/unused_objects.gltf", "its buffer has no bytes"),
];

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
            found.push(path);
        }
    }
}

#[test]
fn every_file_of_the_corpus_gives_a_model_or_a_reason() {
    let Some(folder) = real_data() else { return };
    let folder = folder.join("gltf_validator/test");
    let mut found = Vec::new();
    files(&folder, &mut found);
    found.sort();
    assert_eq!(found.len(), 372);
    let (mut loaded, mut empty, mut wrong) = (0, 0, Vec::new());
    for path in &found {
        let name = path.strip_prefix(&folder).unwrap().to_str().unwrap();
        let report = std::fs::read(format!("{}.report.json", path.display())).unwrap();
        let report: Value = serde_json::from_slice(&report).unwrap();
        let sound = report["issues"]["numErrors"] == 0;
        let expected = REFUSED.iter().find(|(file, _)| *file == name);
        match read_model(path, &Progress::default()) {
            Ok(model) => {
                loaded += 1;
                check_rules(&model);
                if sound && (model.diagnostics.has_errors() || expected.is_some()) {
                    wrong.push(format!("{name}: read with {:?}", model.diagnostics));
                }
            }
            Err(_) if expected.is_some() => {}
            // Most of the files are about something else than geometry.
            Err(ImportError::Empty { reason, .. }) if sound => {
                empty += 1;
                if !reason.starts_with("no node") {
                    wrong.push(format!("{name}: {reason}"));
                }
            }
            Err(error) if sound => wrong.push(error.to_string()),
            Err(_) => {}
        }
    }
    println!("{loaded} loaded, {empty} sound but without geometry");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(loaded >= 8, "{loaded}");
}
