//! Runs the built program and writes small projects for it.
#![allow(clippy::unwrap_used, dead_code, missing_docs)]

use serde_json::{Value, json};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What a run of the program left.
#[derive(Debug)]
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

/// Runs `topout` with these arguments. A panic or a death by signal fails the test at once.
pub fn topout<S: AsRef<OsStr>>(args: impl IntoIterator<Item = S>) -> Run {
    run(&mut command(args))
}

/// `topout` with these arguments, to add to.
pub fn command<S: AsRef<OsStr>>(args: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_topout"));
    command.args(args).env_remove("RUST_LOG").env("RUST_BACKTRACE", "0");
    // Neither the user's cache nor another test's.
    command.env("TOPOUT_CACHE_DIR", "").env_remove("TOPOUT_CACHE_LIMIT_MB");
    command
}

/// Runs to the end.
pub fn run(command: &mut Command) -> Run {
    let output = command.output().unwrap();
    let run = Run {
        code: output.status.code().unwrap_or_else(|| panic!("{command:?}: {:?}", output.status)),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    };
    assert!(!run.stderr.contains("panicked"), "{command:?}\n{}", run.stderr);
    run
}

impl Run {
    /// The JSON object on standard output, which must hold nothing else.
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout)
            .unwrap_or_else(|e| panic!("{e}\n{}\n{}", self.stdout, self.stderr))
    }

    /// The same after a run that must have ended well.
    pub fn good_json(&self) -> Value {
        assert_eq!(self.code, 0, "{}", self.stderr);
        self.json()
    }
}

/// A value's number under a key.
pub fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

/// Asserts that every key is there.
pub fn assert_keys(value: &Value, keys: &[&str]) {
    for key in keys {
        assert!(value.get(key).is_some(), "no {key} in {value}");
    }
}

/// A folder for the files of one test.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file and says where it is.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.path(name);
        std::fs::write(&path, content).unwrap();
        text(&path)
    }

    /// A GLB of unit cubes at places along X, one element each.
    pub fn cubes(&self, name: &str, elements: &[&str]) -> String {
        self.write(name, cubes(elements, [0.0; 3]))
    }
}

/// A path as text.
pub fn text(path: &Path) -> String {
    path.to_str().unwrap().to_owned()
}

/// A GLB of red unit cubes 2 m apart along X, the first in the middle of `at`.
pub fn cubes(elements: &[&str], at: [f64; 3]) -> Vec<u8> {
    let mut bin = Vec::new();
    for corner in 0..8u8 {
        for axis in 0..3 {
            let value = if corner >> axis & 1 == 1 { 0.5f32 } else { -0.5 };
            bin.extend(value.to_le_bytes());
        }
    }
    let faces: [u16; 36] = [
        0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6,
        1, 3, 5, 3, 7, 5,
    ];
    bin.extend(faces.iter().flat_map(|i| i.to_le_bytes()));
    let nodes: Vec<Value> = elements
        .iter()
        .enumerate()
        .map(|(i, name)| {
            json!({"name": name, "mesh": 0, "translation": [at[0] + 2.0 * i as f64, at[1], at[2]]})
        })
        .collect();
    let document = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": (0..nodes.len()).collect::<Vec<_>>()}],
        "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.02, 0.02, 1.0]}}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3",
             "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5]},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 96},
            {"buffer": 0, "byteOffset": 96, "byteLength": 72},
        ],
        "buffers": [{"byteLength": bin.len()}],
    });
    glb(&document, &bin)
}

/// The binary container around a document and its buffer.
pub fn glb(document: &Value, bin: &[u8]) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bin = bin.to_vec();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let total = 12 + 8 + json.len() + if bin.is_empty() { 0 } else { 8 + bin.len() };
    let mut file = b"glTF".to_vec();
    file.extend(2u32.to_le_bytes());
    file.extend((total as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", bin)] {
        if !chunk.is_empty() {
            file.extend((chunk.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(chunk);
        }
    }
    file
}

/// A project of three cubes: `slab` is built first, `wall` next, `shed` stands until it is
/// demolished.
pub fn small_project(folder: &Folder) -> [String; 3] {
    let model = folder.cubes("house.glb", &["slab", "wall", "shed"]);
    let schedule = folder.write(
        "plan.csv",
        "id,name,start,end,kind,elements\n\
         A1,Slab,2026-03-02,2026-03-06,construct,slab\n\
         A2,Wall,2026-03-09,2026-03-13,construct,wall\n\
         A3,Shed,2026-03-04,2026-03-05,demolish,shed\n",
    );
    [model, "--schedule".to_owned(), schedule]
}
