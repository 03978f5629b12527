//! Damaged files: the error or finding names file, place and value, and nothing else happens.

use super::build::{Builder, F32, U16, check_rules, glb, le_f32, le_u16, read};
use crate::Progress;
use crate::import::{ImportError, read_model};
use serde_json::{Value, json};
use std::path::Path;

/// Two elements, the first of them damaged by `bend`; what is said of it.
fn finding(bend: impl Fn(&mut Builder)) -> (String, &'static str) {
    let mut b = Builder::simple();
    bend(&mut b);
    let alone = b.error();
    assert!(alone.contains("model.glb"), "{alone}");
    // The neighbour is read all the same.
    let mesh = b.triangle();
    b.node(json!({"name": "sound", "mesh": mesh}));
    let model = b.model();
    check_rules(&model);
    assert_eq!(model.elements.len(), 1);
    assert_eq!(model.elements[0].name, "sound");
    let error = model.diagnostics.iter().next().unwrap().clone();
    assert_eq!(error.severity, topout_schedule::Severity::Error);
    assert!(error.message.contains("model.glb"), "{}", error.message);
    assert!(error.message.contains("\"wall\""), "{}", error.message);
    assert!(alone.contains("\"wall\""), "{alone}");
    (error.message, error.code)
}

fn set(b: &mut Builder, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    b.json.pointer_mut(parent).unwrap()[key] = value;
}

#[test]
fn files_that_are_not_there_or_not_glb_are_named() {
    let progress = Progress::default();
    let message = read_model(Path::new("no/such.glb"), &progress).unwrap_err().to_string();
    assert!(message.contains("such.glb"), "{message}");
    let folder = tempfile::tempdir().unwrap();
    let message = read_model(folder.path(), &progress).unwrap_err().to_string();
    assert!(message.contains("not a file"), "{message}");
    for bytes in [&b""[..], b"hello", b"PK\x03\x04\x00\x00\x00\x00", b"ISO-10303-21;"] {
        let error = read(bytes).unwrap_err();
        assert!(matches!(error, ImportError::Invalid { .. }));
        assert!(error.to_string().contains("model.glb: byte 0: not glTF"), "{error}");
    }
}

#[test]
fn every_truncation_of_a_glb_is_an_error() {
    let whole = Builder::simple().glb();
    assert!(read(&whole).is_ok());
    for end in 0..whole.len() {
        assert!(read(&whole[..end]).is_err(), "{end} of {} bytes", whole.len());
    }
    let message = read(&whole[..whole.len() - 1]).unwrap_err().to_string();
    assert!(
        message.contains("truncated") && message.contains(&whole.len().to_string()),
        "{message}"
    );
}

#[test]
fn wrong_chunks_are_named() {
    let mut file = Builder::simple().glb();
    file[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    let message = read(&file).unwrap_err().to_string();
    assert!(message.contains("chunk 0") && message.contains("4294967295"), "{message}");
    let mut file = Builder::simple().glb();
    file[16..20].copy_from_slice(b"NOSJ");
    assert!(read(&file).unwrap_err().to_string().contains("must be JSON"));
    let message = read(&glb(b"{\"asset\": }", b"")).unwrap_err().to_string();
    assert!(message.contains("JSON line 1 column 11"), "{message}");
    let message = read(&glb(b"{}", b"")).unwrap_err().to_string();
    assert!(message.contains("asset.version"), "{message}");
}

#[test]
fn other_versions_are_refused_by_number() {
    for (json, said) in [
        (json!({"asset": {"version": "1.0"}, "meshes": {"a": {}}}), "\"1.0\""),
        (json!({"asset": {"version": "3.0"}}), "\"3.0\""),
        (json!({"asset": {"version": "2.0", "minVersion": "2.1"}}), "\"2.1\""),
    ] {
        let error = read(json.to_string().as_bytes()).unwrap_err();
        assert!(matches!(error, ImportError::Unsupported { .. }), "{error}");
        assert!(error.to_string().contains(said), "{error}");
    }
    let mut b = Builder::simple();
    b.json["asset"]["version"] = json!("2.7");
    assert_eq!(b.model().elements.len(), 1, "later minor versions stay readable");
}

#[test]
fn types_that_are_wrong_in_the_document_are_named() {
    let mut b = Builder::simple();
    b.json["nodes"][0]["mesh"] = json!(-1);
    let message = b.error();
    assert!(message.contains("JSON line 1 column") && message.contains("-1"), "{message}");
    b.json["nodes"] = json!("none");
    assert!(b.error().contains("expected a sequence"), "{}", b.error());
}

#[test]
fn no_geometry_is_an_error_with_a_reason() {
    let mut b = Builder::new();
    let error = b.read().unwrap_err();
    assert!(matches!(error, ImportError::Empty { .. }), "{error}");
    assert!(error.to_string().contains("model.glb: no geometry: no node"), "{error}");
    b.triangle();
    b.node(json!({"name": "empty"}));
    assert!(b.error().contains("no node of the scene has a mesh"), "{}", b.error());
}

#[test]
fn accessors_out_of_range_are_named() {
    let cases = [
        ("/meshes/0/primitives/0/attributes/POSITION", json!(77), "accessors[77]"),
        ("/meshes/0/primitives/0/indices", json!(78), "accessors[78]"),
        ("/meshes/0/primitives/0/material", json!(79), "materials[79]"),
        ("/meshes/0/primitives/0/mode", json!(9), "mode 9"),
        ("/accessors/0/bufferView", json!(80), "bufferViews[80]"),
        ("/accessors/0/count", json!(4), "4 elements of 12 bytes"),
        ("/accessors/0/count", json!(u32::MAX), "4294967295 elements"),
        ("/accessors/0/count", json!(1u64 << 60), "count 1152921504606846976"),
        ("/accessors/0/byteOffset", json!(1), "from byte 1"),
        ("/accessors/0/byteOffset", json!(u64::MAX), "18446744073709551615"),
        ("/accessors/0/componentType", json!(5130), "componentType 5130"),
        ("/accessors/0/componentType", json!(5125), "componentType 5125"),
        ("/accessors/0/type", json!("VEC2"), "\"VEC2\""),
        ("/accessors/0/type", json!("SCALAR"), "type SCALAR"),
        ("/accessors/1/componentType", json!(5126), "componentType 5126"),
        ("/bufferViews/0/buffer", json!(3), "buffers[3]"),
        ("/bufferViews/0/byteLength", json!(1 << 20), "1048576"),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), "18446744073709551615"),
        ("/bufferViews/0/byteStride", json!(2), "byteStride 2"),
        ("/bufferViews/0/byteStride", json!(8), "byteStride 8"),
    ];
    for (pointer, value, said) in cases {
        let (message, code) = finding(|b| set(b, pointer, value.clone()));
        assert!(message.contains(said), "{pointer} {value}: {message}");
        assert_eq!(code, "bad-primitive");
    }
    let (message, _) = finding(|b| {
        b.json["accessors"][0] = json!({"componentType": F32, "type": "VEC3", "count": 1u32 << 31,
            "sparse": {"count": 0, "indices": {"bufferView": 0, "componentType": U16},
                       "values": {"bufferView": 0}}});
    });
    assert!(message.contains("2147483648"), "{message}");
    let (message, _) = finding(|b| {
        b.json["accessors"][0] = json!({"componentType": F32, "type": "VEC3", "count": 1u32 << 31});
    });
    assert!(message.contains("without a bufferView"), "{message}");
}

#[test]
fn indices_out_of_range_are_named_with_accessor_and_value() {
    let (message, code) = finding(|b| {
        let view = b.view(&le_u16(&[0, 1, 3]));
        b.json["accessors"][1]["bufferView"] = json!(view);
    });
    assert!(message.contains("index 3 (accessors[1], element 2)"), "{message}");
    assert!(message.contains("3 vertices"), "{message}");
    assert_eq!(code, "bad-primitive");
    let (message, _) = finding(|b| {
        let view = b.view(&u32::MAX.to_le_bytes().repeat(3));
        b.json["accessors"][1] =
            json!({"bufferView": view, "componentType": 5125, "type": "SCALAR", "count": 3});
    });
    assert!(message.contains("4294967295"), "{message}");
}

#[test]
fn positions_that_are_no_numbers_are_named() {
    for (bad, said) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf")] {
        let (message, code) = finding(|b| {
            let view = b.view(&le_f32(&[0.0, 0.0, 0.0, 1.0, bad, 0.0, 0.0, 1.0, 0.0]));
            b.json["accessors"][0]["bufferView"] = json!(view);
        });
        assert!(message.contains(said) && message.contains("vertex 1"), "{message}");
        assert!(message.contains("accessors[0]"), "{message}");
        assert_eq!(code, "non-finite-position");
    }
}

#[test]
fn huge_positions_are_named() {
    let mut b = Builder::simple();
    for huge in [3e38f32, 1e30, -2e7] {
        let view = b.view(&le_f32(&[0.0, 0.0, 0.0, 1.0, huge, 0.0, 0.0, 1.0, 0.0]));
        b.json["accessors"][0]["bufferView"] = json!(view);
        let message = b.error();
        assert!(message.contains("\"wall\"") && message.contains("1e7 m"), "{message}");
    }
}

#[test]
fn a_vertex_that_is_not_used_does_no_harm() {
    let mut b = Builder::simple();
    let position = b.vec3(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f32::NAN; 3], [1e30; 3]]);
    b.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(position);
    let model = b.model();
    check_rules(&model);
    assert_eq!(model.meshes[0].vertices.len(), 3);
}

#[test]
fn one_bad_primitive_does_not_take_its_element_along() {
    let mut b = Builder::simple();
    let sound = b.json["meshes"][0]["primitives"][0].clone();
    let mut bad = sound.clone();
    bad["indices"] = json!(55);
    b.json["meshes"][0]["primitives"] = json!([bad, sound]);
    let model = b.model();
    assert_eq!(model.triangle_count(), 1);
    assert!(model.diagnostics.has_errors());
}

#[test]
fn attributes_that_do_not_fit_are_ignored_and_said() {
    let mut b = Builder::simple();
    b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(99);
    b.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(1);
    let model = b.model();
    check_rules(&model);
    assert_eq!(model.diagnostics.get("bad-attribute").unwrap().count, 2);
}

#[test]
fn incomplete_triangles_are_said() {
    let mut b = Builder::simple();
    b.json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    let position = b.vec3(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0]]);
    b.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(position);
    let model = b.model();
    assert_eq!(model.triangle_count(), 1);
    assert!(model.diagnostics.get("incomplete-triangle").unwrap().message.contains('4'));
    b.json["accessors"][position]["count"] = json!(2);
    for mode in [4, 5, 6] {
        b.json["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        assert!(b.error().contains("no node"), "{}", b.error());
    }
}

#[test]
fn buffers_that_are_missing_or_short_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.gltf");
    let b = Builder::simple();
    let write = |uri: Option<&str>, length: usize| {
        let mut json = b.json.clone();
        json["buffers"][0] = json!({"byteLength": length});
        if let Some(uri) = uri {
            json["buffers"][0]["uri"] = json!(uri);
        }
        std::fs::write(&path, json.to_string()).unwrap();
        read_model(&path, &Progress::default()).map_err(|e| e.to_string())
    };
    let length = b.bin.len();
    let message = write(Some("parts%20of/it.bin"), length).unwrap_err();
    assert!(message.contains("buffers[0]") && message.contains("it.bin"), "{message}");
    assert!(message.contains("model.gltf"), "{message}");
    std::fs::create_dir(folder.path().join("parts of")).unwrap();
    std::fs::write(folder.path().join("parts of/it.bin"), &b.bin).unwrap();
    assert_eq!(write(Some("parts%20of/it.bin"), length).unwrap().elements.len(), 1);
    let message = write(Some("parts%20of/it.bin"), length + 1).unwrap_err();
    assert!(message.contains(&format!("holds {length} bytes")), "{message}");
    let message = write(Some("../it.bin"), length).unwrap_err();
    assert!(message.contains("leaves the folder"), "{message}");
    let message = write(None, length).unwrap_err();
    assert!(message.contains("neither a uri nor a BIN chunk"), "{message}");
    let message = write(Some("data:application/octet-stream;base64,$$"), length).unwrap_err();
    assert!(message.contains("buffers[0]") && message.contains("base64"), "{message}");
    let text: String = b.bin.iter().map(|byte| format!("%{byte:02x}")).collect();
    // Bytes above 127 are no text, so this form is rare; here there are none.
    let ascii = b.bin.iter().all(|&byte| byte < 128);
    assert_eq!(write(Some(&format!("data:,{text}")), length).is_ok(), ascii);
}

/// A small file whose meshes all use the same large accessor would fill any memory.
#[test]
fn geometry_without_end_from_shared_bytes_is_refused_at_once() {
    let mut b = Builder::simple();
    let count = 1 << 20;
    let indices = b.accessor(&vec![0; count], 5121, "SCALAR", count);
    let primitive = json!({"attributes": {"POSITION": 0}, "indices": indices});
    let strip = json!({"attributes": {"POSITION": 0}, "indices": indices, "mode": 5});
    for i in 0..100 {
        let mesh = b.push("meshes", json!({"primitives": [strip]}));
        b.node(json!({"name": format!("copy {i}"), "mesh": mesh}));
    }
    let message = b.error();
    assert!(message.contains("model.glb: meshes[86]: "), "{message}");
    assert!(message.contains("268435456"), "{message}");
    // What no node places does not count.
    b.json["nodes"].as_array_mut().unwrap().truncate(3);
    b.json["meshes"][50]["primitives"] = json!(vec![primitive; 1000]);
    assert!(b.read().is_ok());
}

#[test]
fn reading_can_be_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.glb");
    std::fs::write(&path, Builder::simple().glb()).unwrap();
    let progress = Progress::default();
    assert!(read_model(&path, &progress).is_ok());
    progress.cancel();
    assert!(matches!(read_model(&path, &progress), Err(ImportError::Cancelled(_))));
}
