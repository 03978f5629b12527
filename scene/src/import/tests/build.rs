//! Builds small glTF files.

use crate::import::{ImportError, parse};
use crate::{Model, Progress};
use serde_json::{Value, json};
use std::path::Path;

/// A GLB in the making: JSON that a test may bend at will, and its binary chunk.
pub(super) struct Builder {
    pub json: Value,
    pub bin: Vec<u8>,
}

pub(super) const F32: u32 = 5126;
pub(super) const U8: u32 = 5121;
pub(super) const U16: u32 = 5123;
pub(super) const U32: u32 = 5125;
pub(super) const I16: u32 = 5122;

pub(super) fn le_f32(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

pub(super) fn le_u16(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

impl Builder {
    /// A document without anything but a version.
    pub fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "accessors": [], "bufferViews": [], "meshes": [],
            "nodes": [], "materials": [], "buffers": [{"byteLength": 0}],
        });
        Self { json, bin: Vec::new() }
    }

    /// Appends to a table of the document; returns the index.
    pub fn push(&mut self, table: &str, value: Value) -> usize {
        if self.json.get(table).is_none() {
            self.json[table] = json!([]);
        }
        let list = self.json[table].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    /// Adds bytes as a buffer view of their own.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        while !self.bin.len().is_multiple_of(4) {
            self.bin.push(0);
        }
        let offset = self.bin.len();
        self.bin.extend(bytes);
        let view = json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()});
        self.push("bufferViews", view)
    }

    /// Adds bytes as an accessor of their own.
    pub fn accessor(&mut self, bytes: &[u8], component: u32, shape: &str, count: usize) -> usize {
        let view = self.view(bytes);
        let accessor = json!({
            "bufferView": view, "componentType": component, "type": shape, "count": count,
        });
        self.push("accessors", accessor)
    }

    /// Three floats a vertex.
    pub fn vec3(&mut self, values: &[[f32; 3]]) -> usize {
        self.accessor(&le_f32(&values.concat()), F32, "VEC3", values.len())
    }

    /// A mesh with one triangle: (0,0,0), (1,0,0), (0,1,0).
    pub fn triangle(&mut self) -> usize {
        let position = self.vec3(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let indices = self.accessor(&le_u16(&[0, 1, 2]), U16, "SCALAR", 3);
        let primitive = json!({"attributes": {"POSITION": position}, "indices": indices});
        self.push("meshes", json!({"primitives": [primitive]}))
    }

    /// A node.
    pub fn node(&mut self, node: Value) -> usize {
        self.push("nodes", node)
    }

    /// One named node with one triangle.
    pub fn simple() -> Self {
        let mut builder = Self::new();
        let mesh = builder.triangle();
        builder.node(json!({"name": "wall", "mesh": mesh}));
        builder
    }

    /// The file's bytes.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        if json["buffers"][0]["byteLength"] == 0 {
            json["buffers"][0]["byteLength"] = json!(bin.len());
        }
        glb(json.to_string().as_bytes(), &bin)
    }

    /// Reads the file.
    pub fn read(&self) -> Result<Model, ImportError> {
        read(&self.glb())
    }

    /// Reads the file, which must succeed.
    pub fn model(&self) -> Model {
        self.read().unwrap()
    }

    /// Reads the file, which must fail; returns the message.
    pub fn error(&self) -> String {
        self.read().unwrap_err().to_string()
    }
}

/// A container around a document and a binary chunk.
pub(super) fn glb(json: &[u8], bin: &[u8]) -> Vec<u8> {
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + bin.len();
    let mut out = b"glTF".to_vec();
    out.extend(2u32.to_le_bytes());
    out.extend((length as u32).to_le_bytes());
    out.extend((json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(json);
    out.extend((bin.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(bin);
    out
}

/// Reads a file's bytes as `model.glb`.
pub(super) fn read(bytes: &[u8]) -> Result<Model, ImportError> {
    parse(bytes, Path::new("."), Path::new("model.glb"), "model.glb", &Progress::default())
}

/// What every model promises to those who use it.
pub(super) fn check_rules(model: &Model) {
    assert!(model.materials.len() <= 1 << 16);
    for mesh in &model.meshes {
        assert!(mesh.indices.len().is_multiple_of(3) && mesh.opaque.is_multiple_of(3));
        assert!(mesh.opaque as usize <= mesh.indices.len());
        assert!(mesh.indices.iter().all(|&i| (i as usize) < mesh.vertices.len()));
        assert!(mesh.vertices.iter().all(|v| {
            v.position.iter().all(|c| c.is_finite())
                && usize::from(v.material) < model.materials.len()
        }));
        assert!(!mesh.indices.is_empty() && !mesh.bounds.is_empty());
    }
    let mut next = 0;
    for element in &model.elements {
        assert_eq!(element.instances.start, next);
        next = element.instances.end;
        assert!(next > element.instances.start);
        assert!(element.bounds.min.is_finite() && element.bounds.max.is_finite());
        assert!(element.group.is_none_or(|g| g.index() < model.groups.len()));
        for instance in model.instances_of(element) {
            let mesh = &model.meshes[instance.mesh.index()];
            assert!(instance.world_from_mesh.is_finite());
            for vertex in &mesh.vertices {
                let p = instance.world_from_mesh.transform_point3(vertex.position.into());
                // Rounding of the corners' transform.
                let slack = 1e-4 + 1e-5 * p.abs().max_element();
                assert!(element.bounds.grown(slack).distance(p) == 0.0);
            }
        }
    }
    assert_eq!(next as usize, model.instances.len());
    for (i, group) in model.groups.iter().enumerate() {
        assert!(group.parent.is_none_or(|p| p.index() < i), "parents come first");
    }
    for material in &model.materials {
        assert!(material.color.iter().all(|c| (0.0..=1.0).contains(c)));
        assert!(material.transparent || material.color[3] == 1.0);
    }
}
