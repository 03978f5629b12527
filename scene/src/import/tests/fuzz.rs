//! Random damage never panics: what is read keeps its rules, what is not is an error in words.

use super::build::{Builder, check_rules, read};
use proptest::prelude::*;
use serde_json::{Value, json};

/// A file that uses most of what is read.
fn rich() -> Builder {
    let mut b = Builder::simple();
    let colors =
        b.accessor(&[200, 100, 0, 90, 1, 2, 3, 4, 5, 6, 7, 8], super::build::U8, "VEC4", 3);
    let normals = b.vec3(&[[0.0, 0.0, 1.0]; 3]);
    b.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colors);
    b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normals);
    b.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    b.json["materials"] = json!([{"alphaMode": "BLEND", "name": "m"}]);
    let places = b.vec3(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    let indices = b.view(&[1]);
    b.json["accessors"][0]["sparse"] = json!({"count": 1,
        "indices": {"bufferView": indices, "componentType": 5121}, "values": {"bufferView": 0}});
    b.node(json!({"name": "group", "children": [2, 3], "extras": {"guid": "g", "type": "storey"}}));
    b.node(json!({"name": "it", "mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, 0, 1],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}}}));
    b.node(json!({"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1]}));
    let strip = crate::optimizer::pack::vertices(&[[0.0f32, 1.0, 2.0]; 8]);
    let view = b.view(&strip);
    let mut packed = b.json["bufferViews"][view].take();
    packed["byteStride"] = json!(12);
    packed["count"] = json!(8);
    packed["mode"] = json!("ATTRIBUTES");
    b.json["bufferViews"][view] = json!({"buffer": 0, "byteLength": 96,
        "extensions": {"EXT_meshopt_compression": packed}});
    let packed = b.push(
        "accessors",
        json!({"bufferView": view, "componentType": 5126, "type": "VEC3", "count": 8}),
    );
    b.json["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap()
        .push(json!({"attributes": {"POSITION": packed}, "mode": 5}));
    b.json["scenes"] = json!([{"nodes": [0, 1]}]);
    b.json["scene"] = json!(0);
    b
}

fn survives(bytes: &[u8]) {
    match read(bytes) {
        Ok(model) => check_rules(&model),
        Err(error) => assert!(error.to_string().contains("model.glb"), "{error}"),
    }
}

/// All numbers of a document, to be replaced one by one.
fn numbers<'a>(value: &'a mut Value, found: &mut Vec<&'a mut Value>) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(|v| numbers(v, found)),
        Value::Object(map) => map.values_mut().for_each(|v| numbers(v, found)),
        Value::Number(_) => found.push(value),
        _ => {}
    }
}

#[test]
fn the_sound_file_is_read_completely() {
    let model = rich().model();
    check_rules(&model);
    assert_eq!((model.elements.len(), model.instances.len()), (3, 4));
    assert!(!model.diagnostics.has_errors(), "{:?}", model.diagnostics);
}

#[test]
fn every_number_of_the_document_may_be_anything() {
    let sound = rich();
    let mut json = sound.json.clone();
    let mut all = Vec::new();
    numbers(&mut json, &mut all);
    for i in 0..all.len() {
        for wrong in [
            json!(0),
            json!(1),
            json!(2),
            json!(7),
            json!(255),
            json!(65_536),
            json!(u32::MAX),
            json!(u64::MAX),
            json!(i64::MIN),
            json!(1e300),
            json!(0.5),
            json!(5126),
            json!(5120),
            Value::Null,
            json!("x"),
            json!([]),
            json!({}),
        ] {
            let mut bent = Builder { json: sound.json.clone(), bin: sound.bin.clone() };
            let mut places = Vec::new();
            numbers(&mut bent.json, &mut places);
            *places[i] = wrong;
            survives(&bent.glb());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn random_bytes_in_the_file_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        cut in prop::option::weighted(0.2, any::<prop::sample::Index>()),
    ) {
        let mut bytes = rich().glb();
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        survives(&bytes);
    }

    #[test]
    fn random_bits_in_the_binary_chunk_never_panic(
        flips in prop::collection::vec((any::<prop::sample::Index>(), 0u8..8), 1..20),
    ) {
        let mut b = rich();
        for (at, bit) in flips {
            let at = at.index(b.bin.len());
            b.bin[at] ^= 1 << bit;
        }
        survives(&b.glb());
    }

    #[test]
    fn random_bytes_alone_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..200), magic: bool) {
        let mut bytes = bytes;
        if magic {
            bytes.splice(0..0, *b"glTF\x02\0\0\0");
        }
        survives(&bytes);
    }
}
