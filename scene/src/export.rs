//! Writing a model as GLB 2.0: groups and elements as nodes, shared meshes, one primitive for each
//! material of a mesh.

use crate::{Element, Group, Instance, Material, Mesh, MeshId, Model, decode_normal};
use glam::{Affine3A, Vec3, Vec3A};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, Write};

/// Why a model cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The destination refuses.
    #[error("cannot write the GLB: {0}")]
    Io(#[from] io::Error),
    /// A GLB holds at most 4 GiB.
    #[error("the GLB would have {bytes} bytes, more than the format can hold")]
    TooLarge {
        /// What it would need.
        bytes: u64,
    },
    /// A position that is not a number cannot be written.
    #[error("element {element:?} has a position that is not finite")]
    NotFinite {
        /// Its name.
        element: String,
    },
}

/// Buffer views, in the order in which they lie in the file.
const POSITIONS: usize = 0;
const NORMALS: usize = 1;
const SHORT: usize = 2;
const LONG: usize = 3;

/// Writes the model. Nodes carry names and, in their extras, guid, type and storey.
///
/// An element of one instance is one node; of several, a node with a nameless child for each. Every
/// material is double-sided, since meshes are triangle soups.
pub fn write_glb(model: &Model, mut out: impl Write) -> Result<(), ExportError> {
    check(model)?;
    let mut data = Data::default();
    let meshes: Vec<Value> = model.meshes.iter().map(|m| data.mesh(m)).collect();
    // glTF knows no mesh without primitives; their nodes are written without one.
    let mut index = 0;
    let numbers: Vec<Option<usize>> = meshes
        .iter()
        .map(|m| {
            let some = m["primitives"].as_array().is_some_and(|p| !p.is_empty());
            index += usize::from(some);
            some.then(|| index - 1)
        })
        .collect();
    let meshes: Vec<&Value> =
        meshes.iter().zip(&numbers).filter(|(_, n)| n.is_some()).map(|(m, _)| m).collect();
    for part in &mut data.parts {
        part.resize(part.len().next_multiple_of(4), 0);
    }
    let mut text = Vec::new();
    document(model, &meshes, &numbers, &data, &mut text)?;
    while text.len() % 4 != 0 {
        text.push(b' ');
    }
    let binary = data.parts.iter().map(Vec::len).sum::<usize>();
    let bytes = 12 + 8 + text.len() as u64 + 8 + binary as u64;
    if bytes > u64::from(u32::MAX) {
        return Err(ExportError::TooLarge { bytes });
    }
    out.write_all(b"glTF")?;
    for word in [2, bytes as u32, text.len() as u32] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    out.write_all(&(binary as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    for part in &data.parts {
        out.write_all(part)?;
    }
    Ok(out.flush()?)
}

fn check(model: &Model) -> Result<(), ExportError> {
    let sound: Vec<bool> = model
        .meshes
        .iter()
        .map(|m| m.vertices.iter().all(|v| v.position.iter().all(|c| c.is_finite())))
        .collect();
    for element in &model.elements {
        let fine = |i: &Instance| sound[i.mesh.index()] && i.world_from_mesh.is_finite();
        if !model.instances_of(element).iter().all(fine) {
            return Err(ExportError::NotFinite { element: element.name.clone() });
        }
    }
    Ok(())
}

/// The binary part under construction.
#[derive(Default)]
struct Data {
    parts: [Vec<u8>; 4],
    accessors: Vec<Value>,
}

impl Data {
    /// A glTF mesh with a primitive for each material; empty for a mesh without triangles.
    fn mesh(&mut self, mesh: &Mesh) -> Value {
        let mut by_material: BTreeMap<u16, Vec<u32>> = BTreeMap::new();
        for corners in mesh.indices.chunks_exact(3) {
            let material = mesh.vertices[corners[0] as usize].material;
            by_material.entry(material).or_default().extend(corners);
        }
        let primitives: Vec<Value> = by_material
            .into_iter()
            .map(|(material, indices)| self.primitive(mesh, material, &indices))
            .collect();
        json!({ "primitives": primitives })
    }

    fn primitive(&mut self, mesh: &Mesh, material: u16, indices: &[u32]) -> Value {
        let mut number = vec![u32::MAX; mesh.vertices.len()];
        let mut used = Vec::new();
        let indices: Vec<u32> = indices
            .iter()
            .map(|&i| {
                let slot = &mut number[i as usize];
                if *slot == u32::MAX {
                    *slot = used.len() as u32;
                    used.push(&mesh.vertices[i as usize]);
                }
                *slot
            })
            .collect();
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (positions, normals) = (self.parts[POSITIONS].len(), self.parts[NORMALS].len());
        for v in &used {
            let p = Vec3::from(v.position);
            (low, high) = (low.min(p), high.max(p));
            for c in v.position {
                self.parts[POSITIONS].extend(c.to_le_bytes());
            }
            for c in decode_normal(v.normal).to_array() {
                self.parts[NORMALS].extend(c.to_le_bytes());
            }
        }
        // 65,535 would be a restart value for u16.
        let (view, kind) = if used.len() < 65_535 { (SHORT, 5123) } else { (LONG, 5125) };
        let offset = self.parts[view].len();
        for i in &indices {
            let bytes = i.to_le_bytes();
            self.parts[view].extend(&bytes[..if view == SHORT { 2 } else { 4 }]);
        }
        let first = self.accessors.len();
        let n = used.len();
        self.accessors
            .push(json!({ "bufferView": POSITIONS, "byteOffset": positions, "componentType": 5126,
            "count": n, "type": "VEC3", "min": low.to_array(), "max": high.to_array() }));
        self.accessors
            .push(json!({ "bufferView": NORMALS, "byteOffset": normals, "componentType": 5126,
            "count": n, "type": "VEC3" }));
        self.accessors
            .push(json!({ "bufferView": view, "byteOffset": offset, "componentType": kind,
            "count": indices.len(), "type": "SCALAR" }));
        json!({ "attributes": { "POSITION": first, "NORMAL": first + 1 }, "indices": first + 2, "material": material })
    }

    /// The views that hold anything, and for each part its number among them.
    fn views(&self) -> (Vec<Value>, [usize; 4]) {
        let mut views = Vec::new();
        let mut numbers = [0; 4];
        let mut offset = 0;
        for (i, part) in self.parts.iter().enumerate() {
            numbers[i] = views.len();
            if !part.is_empty() {
                let mut view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": part.len(),
                    "target": if i < SHORT { 34962 } else { 34963 } });
                if i < SHORT {
                    view["byteStride"] = 12.into();
                }
                views.push(view);
            }
            offset += part.len();
        }
        (views, numbers)
    }
}

/// Writes the JSON part.
fn document(
    model: &Model,
    meshes: &[&Value],
    numbers: &[Option<usize>],
    data: &Data,
    text: &mut Vec<u8>,
) -> Result<(), ExportError> {
    let nodes = Nodes::new(model);
    write!(
        text,
        r#"{{"asset":{{"version":"2.0","generator":"topout"}},"scene":0,"scenes":[{{"name":"#
    )?;
    put(text, &model.name)?;
    if nodes.roots.is_empty() {
        write!(text, "}}]")?;
    } else {
        write!(text, r#","nodes":"#)?;
        put(text, &nodes.roots)?;
        write!(text, "}}],\"nodes\":[")?;
        nodes.write(model, numbers, text)?;
        write!(text, "]")?;
    }
    if !model.materials.is_empty() {
        write!(text, r#","materials":"#)?;
        put(text, &model.materials.iter().map(material).collect::<Vec<_>>())?;
    }
    if !meshes.is_empty() {
        let (views, order) = data.views();
        let accessors: Vec<Value> = data
            .accessors
            .iter()
            .map(|a| {
                let mut a = a.clone();
                let view = a["bufferView"].as_u64().unwrap_or(0) as usize;
                a["bufferView"] = order[view].into();
                a
            })
            .collect();
        write!(text, r#","meshes":"#)?;
        put(text, &meshes)?;
        write!(text, r#","accessors":"#)?;
        put(text, &accessors)?;
        write!(text, r#","bufferViews":"#)?;
        put(text, &views)?;
        let length: usize = data.parts.iter().map(Vec::len).sum();
        write!(text, r#","buffers":[{{"byteLength":{length}}}]"#)?;
    }
    write!(text, "}}")?;
    Ok(())
}

fn put(text: &mut Vec<u8>, value: &(impl serde::Serialize + ?Sized)) -> Result<(), ExportError> {
    serde_json::to_writer(text, value).map_err(|e| ExportError::Io(e.into()))
}

fn material(m: &Material) -> Value {
    let mut value = json!({ "doubleSided": true, "pbrMetallicRoughness": {
        "baseColorFactor": m.color, "metallicFactor": m.metallic, "roughnessFactor": m.roughness } });
    if !m.name.is_empty() {
        value["name"] = m.name.as_str().into();
    }
    if m.transparent {
        value["alphaMode"] = "BLEND".into();
    }
    value
}

/// The order of nodes: an optional root at the origin, groups, elements, further instances.
struct Nodes {
    roots: Vec<usize>,
    /// Number of the first group.
    first: usize,
    /// Children of the root (if any) and of every group.
    top: Vec<usize>,
    children: Vec<Vec<usize>>,
}

impl Nodes {
    fn new(model: &Model) -> Self {
        let first = usize::from(model.origin != glam::DVec3::ZERO);
        let mut children = vec![Vec::new(); model.groups.len()];
        let mut top = Vec::new();
        let parents =
            model.groups.iter().map(|g| g.parent).chain(model.elements.iter().map(|e| e.group));
        for (i, parent) in parents.enumerate() {
            match parent {
                Some(group) => children[group.index()].push(first + i),
                None => top.push(first + i),
            }
        }
        let roots = if first == 1 && !top.is_empty() { vec![0] } else { top.clone() };
        Self { roots, first, top, children }
    }

    fn write(
        &self,
        model: &Model,
        numbers: &[Option<usize>],
        text: &mut Vec<u8>,
    ) -> Result<(), ExportError> {
        let mut separate = Separator(false);
        if self.first == 1 {
            separate.next(text);
            put(text, &json!({ "translation": model.origin.to_array(), "children": self.top }))?;
        }
        for (group, children) in model.groups.iter().zip(&self.children) {
            separate.next(text);
            put(text, &group_node(group, children))?;
        }
        // Nameless children come last; their numbers follow from those before.
        let mut next = self.first + model.groups.len() + model.elements.len();
        for element in &model.elements {
            separate.next(text);
            let mut node = element_node(element);
            let instances = model.instances_of(element);
            match instances {
                [] => {}
                [one] => place(&mut node, one, numbers),
                many => {
                    node["children"] = (next..next + many.len()).collect::<Vec<_>>().into();
                    next += many.len();
                }
            }
            put(text, &node)?;
        }
        for element in &model.elements {
            if let many @ [_, _, ..] = model.instances_of(element) {
                for instance in many {
                    separate.next(text);
                    let mut node = json!({});
                    place(&mut node, instance, numbers);
                    put(text, &node)?;
                }
            }
        }
        Ok(())
    }
}

/// Commas between values.
struct Separator(bool);

impl Separator {
    fn next(&mut self, text: &mut Vec<u8>) {
        if self.0 {
            text.push(b',');
        }
        self.0 = true;
    }
}

fn group_node(group: &Group, children: &[usize]) -> Value {
    let mut node = json!({});
    describe(
        &mut node,
        &group.name,
        [
            ("guid", group.guid.as_deref()),
            ("type", Some(&group.kind)),
            ("ifcName", Some(&group.label)),
        ],
    );
    if !children.is_empty() {
        node["children"] = children.into();
    }
    node
}

fn element_node(element: &Element) -> Value {
    let mut node = json!({});
    let known = [
        ("guid", element.guid.as_deref()),
        ("type", Some(element.kind.as_str())),
        ("storey", Some(element.storey.as_str())),
        ("ifcName", Some(element.label.as_str())),
    ];
    describe(&mut node, &element.name, known);
    node
}

/// Name and extras; what is empty is left out.
fn describe<const N: usize>(node: &mut Value, name: &str, known: [(&str, Option<&str>); N]) {
    if !name.is_empty() {
        node["name"] = name.into();
    }
    for (key, value) in known {
        if let Some(value) = value.filter(|v| !v.is_empty()) {
            node["extras"][key] = value.into();
        }
    }
}

/// Mesh and transform of a node, in the shortest form that is exact.
fn place(node: &mut Value, instance: &Instance, numbers: &[Option<usize>]) {
    let MeshId(mesh) = instance.mesh;
    let Some(mesh) = numbers[mesh as usize] else { return };
    node["mesh"] = mesh.into();
    let Affine3A { matrix3: m, translation: t } = instance.world_from_mesh;
    let scale = Vec3A::new(m.x_axis.x, m.y_axis.y, m.z_axis.z);
    if m != glam::Mat3A::from_diagonal(scale.into()) {
        let columns = [(m.x_axis, 0.0), (m.y_axis, 0.0), (m.z_axis, 0.0), (t, 1.0)];
        let matrix: Vec<f32> = columns.iter().flat_map(|(c, w)| [c.x, c.y, c.z, *w]).collect();
        node["matrix"] = json!(matrix);
        return;
    }
    if t != Vec3A::ZERO {
        node["translation"] = json!(t.to_array());
    }
    if scale != Vec3A::ONE {
        node["scale"] = json!(scale.to_array());
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Progress, demo, import};

    fn round_trip(model: &Model) -> (Model, usize) {
        let file = tempfile::Builder::new().suffix(".glb").tempfile().unwrap();
        write_glb(model, std::io::BufWriter::new(file.as_file())).unwrap();
        let size = file.as_file().metadata().unwrap().len() as usize;
        (import::read_model(file.path(), &Progress::default()).unwrap(), size)
    }

    fn demo(elements: usize) -> Model {
        let settings = demo::DemoSettings::for_elements(elements);
        demo::generate(&settings, &Progress::default()).unwrap().0
    }

    fn assert_same(ours: &Model, theirs: &Model) {
        assert_eq!(ours.elements.len(), theirs.elements.len());
        assert_eq!(ours.triangle_count(), theirs.triangle_count());
        let find: std::collections::HashMap<_, _> =
            theirs.elements.iter().map(|e| (e.name.as_str(), e)).collect();
        let shift = (theirs.origin - ours.origin).as_vec3();
        let group = |m: &Model, e: &Element| e.group.map(|g| m.groups[g.index()].name.clone());
        for e in &ours.elements {
            let other = find[e.name.as_str()];
            assert_eq!((&e.guid, &e.kind, &e.storey), (&other.guid, &other.kind, &other.storey));
            assert_eq!(group(ours, e), group(theirs, other), "{}", e.name);
            assert_eq!(ours.triangles_of(e), theirs.triangles_of(other), "{}", e.name);
            for (a, b) in [(e.bounds.min, other.bounds.min), (e.bounds.max, other.bounds.max)] {
                assert!((a - b - shift).abs().max_element() < 2e-3, "{}: {a} {b}", e.name);
            }
        }
        let colours = |m: &Model| {
            let mut all: Vec<String> = m
                .meshes
                .iter()
                .flat_map(|mesh| &mesh.vertices)
                .map(|v| format!("{:?}", m.materials[usize::from(v.material)]))
                .collect();
            all.sort();
            all.dedup();
            all
        };
        assert_eq!(colours(ours), colours(theirs));
    }

    #[test]
    fn the_importer_reads_what_is_written() {
        let model = demo(3_000);
        assert_same(&model, &round_trip(&model).0);
    }

    #[test]
    fn the_default_demo_stays_small() {
        let model = demo(79_396);
        let (read, bytes) = round_trip(&model);
        assert!(bytes < 60_000_000, "{bytes}");
        assert_eq!(read.elements.len(), 79_396);
        assert_eq!(read.triangle_count(), 3_632_126);
    }

    #[test]
    fn several_instances_and_an_origin_survive() {
        let mut model = demo(1_000);
        let first = model.elements[0].clone();
        let from = model.instances.len() as u32;
        let one = model.instances[first.instances.start as usize];
        let shifted = Instance {
            world_from_mesh: Affine3A::from_translation(Vec3::new(3.0, 50.0, 0.0))
                * one.world_from_mesh,
            ..one
        };
        model.instances.extend([one, shifted]);
        model.elements[0].instances = from..from + 2;
        model.elements[0].bounds.max += Vec3::new(3.0, 50.0, 0.0);
        model.origin = glam::DVec3::new(512_000.0, 20.0, -4_096.0);
        let (read, _) = round_trip(&model);
        assert_same(&model, &read);
    }

    #[test]
    fn positions_that_are_no_numbers_are_refused() {
        let mut model = demo(1_000);
        model.instances[7].world_from_mesh.translation.x = f32::NAN;
        let error = write_glb(&model, Vec::new()).unwrap_err();
        assert!(
            matches!(error, ExportError::NotFinite { element } if element == model.elements[7].name)
        );
    }

    #[test]
    fn a_destination_that_fails_is_reported() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::Error::other("disk full"))
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let error = write_glb(&Model::default(), Full).unwrap_err();
        assert!(error.to_string().contains("disk full"));
    }
}
