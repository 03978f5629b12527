//! The document of a glTF and the container around it, read by the `gltf` crate; nothing else here
//! knows that crate.
//!
//! What the crate cannot say is kept beside its types: transforms as f64 (national grid coordinates
//! do not fit its f32), extras, extensions without a type, and values as they were written. Indices
//! are checked where they are used, by the code that can name the place.

use super::fault::Fault;
use gltf::binary::{Error as GlbError, Glb};
use rayon::prelude::*;
use serde::Deserialize;
use serde_json::value::RawValue;
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Deref;

pub(super) use gltf::json::accessor::{ComponentType, Type};
pub(super) use gltf::json::material::{AlphaMode, Material};
pub(super) use gltf::json::mesh::{Primitive, Semantic};
pub(super) use gltf::json::scene::Node;
pub(super) use gltf::json::validation::{Checked, USize64};

const COMPRESSION: &[&str] = &["EXT_meshopt_compression", "KHR_meshopt_compression"];
const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// A file taken apart.
#[derive(Debug)]
pub(super) struct Container<'a> {
    /// The document's text.
    pub json: Cow<'a, [u8]>,
    /// The binary chunk of a GLB.
    pub bin: Option<Cow<'a, [u8]>>,
}

/// Recognises GLB and glTF by their first bytes and finds the chunks.
pub(super) fn split(bytes: &[u8]) -> Result<Container<'_>, Fault> {
    if bytes.starts_with(b"glTF") {
        return split_glb(bytes);
    }
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    match text.iter().find(|b| !b.is_ascii_whitespace()) {
        Some(b'{') => Ok(Container { json: text.into(), bin: None }),
        _ => {
            let start: Vec<_> = bytes.iter().take(4).map(|b| format!("{b:02x}")).collect();
            Err(Fault::new(
                "byte 0",
                format!(
                    "not glTF: starts with [{}] instead of \"glTF\" (GLB) or \"{{\" (JSON)",
                    start.join(" ")
                ),
            ))
        }
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(four.try_into().expect("four bytes were taken")))
}

fn split_glb(bytes: &[u8]) -> Result<Container<'_>, Fault> {
    let truncated = |at: usize, need: u64| {
        Fault::new(
            format!("byte {at}"),
            format!("truncated GLB: {need} bytes are announced, the file has {}", bytes.len()),
        )
    };
    let version = word(bytes, 4).ok_or_else(|| truncated(4, 12))?;
    if version != 2 {
        return Err(Fault::new("byte 4", format!("GLB version {version} is not read, only 2")));
    }
    let length = word(bytes, 8).ok_or_else(|| truncated(8, 12))?;
    if u64::from(length) > bytes.len() as u64 {
        return Err(truncated(8, u64::from(length)));
    }
    // The crate subtracts the header's length from what is announced without looking.
    if length <= 12 {
        return Err(Fault::new("byte 12", "truncated GLB: it has no chunk"));
    }
    let bytes = &bytes[..length as usize];
    let first = word(bytes, 12).unwrap_or(0) as usize;
    let error = match Glb::from_slice(bytes) {
        Ok(glb) => return Ok(Container { json: glb.json, bin: glb.bin }),
        Err(gltf::Error::Binary(error)) => error,
        Err(other) => return Err(Fault::new("byte 0", other.to_string())),
    };
    let second = first.saturating_add(20);
    let is_json = bytes.get(16..20) == Some(b"JSON");
    let (chunk, at) = if is_json { (1, second) } else { (0, 12) };
    Err(match error {
        // A reader skips chunks that it does not know; the crate refuses them as second chunk.
        GlbError::UnknownChunkType(_) | GlbError::ChunkType(_) if is_json => {
            let json = &bytes[20..second];
            return Ok(Container { json: json.into(), bin: None });
        }
        GlbError::UnknownChunkType(_) | GlbError::ChunkType(_) => {
            let kind = word(bytes, 16).unwrap_or(0);
            Fault::new(
                "byte 16",
                format!("the first chunk of a GLB must be JSON, this one is 0x{kind:08x}"),
            )
        }
        GlbError::ChunkLength { ty, length, length_read } => {
            let (chunk, at) =
                if matches!(ty, gltf::binary::ChunkType::Json) { (0, 12) } else { (1, second) };
            Fault::new(
                format!("byte {at}"),
                format!(
                    "truncated GLB: chunk {chunk} announces {length} bytes, {length_read} are left"
                ),
            )
        }
        _ => Fault::new(
            format!("byte {at}"),
            format!("truncated GLB: the header of chunk {chunk} needs 8 bytes"),
        ),
    })
}

/// A document: the crate's tables, reached by dereferencing, and what stands beside them.
#[derive(Debug)]
pub(super) struct Document {
    root: gltf::json::Root,
    /// One for each node.
    pub more: Vec<NodeMore>,
    /// One for each buffer view.
    pub packed: Vec<Option<Compression>>,
    /// Number of animations.
    pub animations: usize,
    /// As written, for messages.
    raw: Value,
}

impl Deref for Document {
    type Target = gltf::json::Root;

    fn deref(&self) -> &Self::Target {
        &self.root
    }
}

/// What a node says beyond the crate's type.
#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct NodeMore {
    pub matrix: Option<Vec<f64>>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    pub extras: Option<Value>,
    #[serde(skip)]
    pub instancing: Option<Instancing>,
}

impl NodeMore {
    /// Reads it out of a node, in which nothing is left of what the crate would read as f32.
    fn take(node: &mut Value) -> Result<Self, serde_json::Error> {
        let own = Self::deserialize(&*node)?;
        if let Some(node) = node.as_object_mut() {
            node.retain(|k, _| !matches!(&k[..], "matrix" | "translation" | "rotation" | "scale"));
        }
        Ok(own)
    }
}

#[derive(Deserialize, Debug, Default)]
#[serde(default)]
pub(super) struct Instancing {
    pub attributes: InstancingAttributes,
}

#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "UPPERCASE")]
pub(super) struct InstancingAttributes {
    pub translation: Option<usize>,
    pub rotation: Option<usize>,
    pub scale: Option<usize>,
}

/// A buffer view packed by meshoptimizer; `buffer` and the bytes are those of the packed data.
#[derive(Deserialize, Debug, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Compression {
    pub buffer: usize,
    pub byte_offset: usize,
    pub byte_length: usize,
    pub byte_stride: usize,
    pub count: usize,
    pub mode: String,
    pub filter: Option<String>,
}

/// Why a document is not read.
#[derive(Debug)]
pub(super) enum Refusal {
    /// It is of another version.
    Version(String),
    /// It is wrong.
    Fault(Fault),
}

impl Document {
    /// Parses a document and checks its version.
    pub fn parse(json: &[u8]) -> Result<Self, Refusal> {
        // Chunks of a GLB are padded; some writers pad with zeros.
        let end = json.iter().rposition(|&b| b != 0).map_or(0, |p| p + 1);
        let json = &json[..end];
        let parsed = parse_lists_in_parts(json).map_or_else(|| serde_json::from_slice(json), Ok);
        let mut raw: Value = parsed.map_err(|e| Refusal::Fault(at(&e)))?;
        check_version(&raw["asset"])?;
        Self::read(&mut raw)
            .map(|mut document| {
                document.raw = raw;
                document
            })
            .map_err(|error| Refusal::Fault(locate(json, &error)))
    }

    fn read(raw: &mut Value) -> Result<Self, serde_json::Error> {
        let mut more = Vec::new();
        if let Some(Value::Array(nodes)) = raw.get_mut("nodes") {
            let read: Vec<_> = nodes.par_iter_mut().map(NodeMore::take).collect();
            more = read.into_iter().collect::<Result<_, _>>()?;
        }
        let animations = raw["animations"].as_array().map_or(0, Vec::len);
        tidy(raw, "");
        complete(raw);
        let root = gltf::json::Root::deserialize(&*raw)?;
        for (node, own) in root.nodes.iter().zip(&mut more) {
            let said = node.extensions.as_ref().and_then(|e| e.others.get(INSTANCING));
            own.instancing = said.map(Instancing::deserialize).transpose()?;
        }
        let packed = root
            .buffer_views
            .iter()
            .map(|view| {
                let said = view.extensions.as_ref().and_then(|e| compression(&e.others));
                said.map(Compression::deserialize).transpose()
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { root, more, packed, animations, raw: Value::Null })
    }

    /// What stands at a place of the document, for messages.
    pub fn said(&self, pointer: &str) -> String {
        self.raw.pointer(pointer).map_or_else(|| "null".to_owned(), Value::to_string)
    }

    /// Whether something stands at a place of the document.
    pub fn says(&self, pointer: &str) -> bool {
        self.raw.pointer(pointer).is_some()
    }

    /// Whether a buffer is a place that only unpacked views would fill.
    pub fn is_fallback(&self, buffer: usize) -> bool {
        let extensions = self.buffers[buffer].extensions.as_ref();
        extensions.is_some_and(|e| compression(&e.others).is_some())
    }
}

/// Parses the lists of a document, which are nearly all of it, by all threads. `None` if something is wrong:
/// where, only parsing in one go can say.
fn parse_lists_in_parts(json: &[u8]) -> Option<Value> {
    let members: BTreeMap<String, &RawValue> = serde_json::from_slice(json).ok()?;
    let value = |raw: &RawValue| serde_json::from_str::<Value>(raw.get()).ok();
    let parsed = members.into_iter().map(|(name, raw)| {
        if !raw.get().starts_with('[') {
            return Some((name, value(raw)?));
        }
        let list: Vec<&RawValue> = serde_json::from_str(raw.get()).ok()?;
        let list: Option<Vec<Value>> =
            list.par_iter().with_min_len(256).map(|&raw| value(raw)).collect();
        Some((name, Value::Array(list?)))
    });
    parsed.collect::<Option<Map<_, _>>>().map(Value::Object)
}

fn compression(extensions: &Map<String, Value>) -> Option<&Value> {
    COMPRESSION.iter().find_map(|name| extensions.get(*name))
}

/// The accessor of an attribute.
pub(super) fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<usize> {
    primitive.attributes.get(&Checked::Valid(semantic)).map(|index| index.value())
}

/// A size or offset; what no memory can hold is too large for any buffer.
pub(super) fn size(size: USize64) -> usize {
    usize::try_from(size.0).unwrap_or(usize::MAX)
}

fn check_version(asset: &Value) -> Result<(), Refusal> {
    let text = |key: &str| asset.get(key).and_then(Value::as_str);
    let minimum = text("minVersion");
    let wanted = minimum.or(text("version")).unwrap_or("");
    if !wanted.is_empty() && wanted != "2.0" {
        let older = wanted.starts_with("1.") || wanted.starts_with("0.");
        // A later 2.x must stay readable, unless the file says otherwise by minVersion.
        if older || minimum.is_some() || !wanted.starts_with("2.") {
            return Err(Refusal::Version(wanted.to_owned()));
        }
    }
    match asset.get("version") {
        None | Some(Value::Null) => {
            Err(Refusal::Fault(Fault::new("asset.version", "is missing, so this is not glTF")))
        }
        Some(Value::String(version)) if version.is_empty() => {
            Err(Refusal::Fault(Fault::new("asset.version", "is empty, so this is not glTF")))
        }
        Some(_) => Ok(()),
    }
}

/// Brings values into the form that the crate expects: it refuses whole numbers written as `3.0`,
/// takes 2^32 for 0, and fails on `null` and on extras that are no objects.
fn tidy(value: &mut Value, key: &str) {
    match value {
        Value::Object(map) => {
            map.retain(|key, value| key != "extras" && !value.is_null());
            for (key, value) in map {
                tidy(value, key);
            }
        }
        Value::Array(list) => {
            list.par_iter_mut().with_min_len(256).for_each(|value| tidy(value, key));
        }
        Value::Number(number) => {
            // Beyond 2^53 a double no longer counts in ones.
            if let Some(float) = number.as_f64().filter(|_| number.is_f64())
                && float.fract() == 0.0
                && (0.0..9_007_199_254_740_992.0).contains(&float)
            {
                *number = (float as u64).into();
            }
            let wide = key == "count" || key.starts_with("byte");
            if !wide && number.as_u64().is_some_and(|n| n > u64::from(u32::MAX)) {
                *number = u32::MAX.into();
            }
        }
        _ => {}
    }
}

/// Fills in lists that the crate insists on, and drops tables that are not used here, so that
/// nothing in them stands in the way of the geometry.
fn complete(raw: &mut Value) {
    for (table, list) in [("scenes", "nodes"), ("meshes", "primitives")] {
        let entries = raw.get_mut(table).and_then(Value::as_array_mut);
        for entry in entries.into_iter().flatten().filter_map(Value::as_object_mut) {
            entry.entry(list).or_insert_with(|| json!([]));
        }
    }
    if let Some(map) = raw.as_object_mut() {
        map.retain(|k, _| !matches!(&k[..], "animations" | "cameras" | "samplers" | "skins"));
    }
}

fn at(error: &serde_json::Error) -> Fault {
    let place = format!("JSON line {} column {}", error.line(), error.column());
    Fault { place, message: message(error) }
}

fn message(error: &serde_json::Error) -> String {
    let text = error.to_string();
    text.split(" at line ").next().unwrap_or(&text).to_owned()
}

/// Finds the place of an error of the tree in the text.
fn locate(json: &[u8], error: &serde_json::Error) -> Fault {
    #[derive(Deserialize)]
    struct Nodes {
        #[serde(rename = "nodes")]
        _nodes: Vec<NodeMore>,
    }
    let text = message(error);
    let found = [
        serde_json::from_slice::<gltf::json::Root>(json).err(),
        serde_json::from_slice::<Nodes>(json).err(),
    ];
    let same = found.into_iter().flatten().find(|e| message(e) == text);
    same.as_ref().map_or_else(|| Fault::new("JSON", text), at)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn tidied(mut value: Value) -> Value {
        tidy(&mut value, "");
        value
    }

    #[test]
    fn whole_numbers_may_be_written_as_floats_but_not_broken_or_negative() {
        let document = |mesh: &str| {
            let text =
                format!(r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"mesh": {mesh}}}]}}"#);
            Document::parse(text.as_bytes()).map(|d| d.nodes[0].mesh.map(|m| m.value()))
        };
        assert_eq!(document("3.0").unwrap(), Some(3));
        assert_eq!(document("3").unwrap(), Some(3));
        assert_eq!(document("null").unwrap(), None);
        // The crate alone takes this for 0.
        assert_eq!(document("4294967296").unwrap(), Some(u32::MAX as usize));
        for bad in ["3.5", "-1", "-1.0", "1e300", "\"3\""] {
            let Refusal::Fault(fault) = document(bad).unwrap_err() else { panic!("{bad}") };
            assert!(fault.place.starts_with("JSON line 1 column"), "{bad}: {fault}");
        }
    }

    #[test]
    fn sizes_stay_exact_and_extras_are_anything() {
        let value = tidied(json!({"count": u64::MAX, "byteOffset": 1u64 << 40, "a": [null, 2.0],
            "extras": 3, "none": null}));
        assert_eq!(value, json!({"count": u64::MAX, "byteOffset": 1u64 << 40, "a": [null, 2]}));
    }

    #[test]
    fn tables_that_are_not_used_may_be_wrong() {
        let text = br#"{"asset": {"version": "2.0", "extras": 7}, "cameras": [{"type": 3}],
            "skins": [{}], "scenes": [{}], "animations": [{}, {}]}"#;
        let document = Document::parse(text).unwrap();
        assert_eq!((document.animations, document.scenes.len()), (2, 1));
    }

    #[test]
    fn every_truncation_of_a_container_is_named() {
        let json = b"{}  ";
        let mut glb = b"glTF".to_vec();
        for n in [2u32, 24, 4, u32::from_le_bytes(*b"JSON")] {
            glb.extend(n.to_le_bytes());
        }
        glb.extend(json);
        assert_eq!(&split(&glb).unwrap().json[..], json);
        for end in 4..glb.len() {
            let fault = split(&glb[..end]).unwrap_err();
            assert!(fault.message.contains("truncated"), "{end}: {fault}");
            // The header may lie about the rest as well.
            let mut short = glb[..end].to_vec();
            if let Some(length) = short.get_mut(8..12) {
                length.copy_from_slice(&(end as u32).to_le_bytes());
                let fault = split(&short).unwrap_err();
                assert!(fault.message.contains("truncated"), "{end}: {fault}");
            }
        }
        assert!(split(b"PK\x03\x04....").unwrap_err().message.contains("50 4b 03 04"));
        glb[4] = 1;
        assert!(split(&glb).unwrap_err().message.contains("version 1"));
    }

    #[test]
    fn chunks_that_are_not_known_are_skipped() {
        let mut glb = b"glTF".to_vec();
        for n in [2u32, 36, 4, u32::from_le_bytes(*b"JSON"), u32::from_le_bytes(*b"{}  ")] {
            glb.extend(n.to_le_bytes());
        }
        glb.extend([4, 0, 0, 0]);
        glb.extend(b"NEW ....");
        let container = split(&glb).unwrap();
        assert_eq!(&container.json[..], b"{}  ");
        assert!(container.bin.is_none());
    }
}
