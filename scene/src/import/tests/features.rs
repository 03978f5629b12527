//! Geometry and materials in all the forms that glTF allows.

use super::build::{Builder, F32, I16, U8, U16, U32, check_rules, le_f32, le_u16};
use crate::optimizer::pack;
use crate::{Mesh, Model, decode_normal};
use glam::Vec3;
use serde_json::{Value, json};

const QUAD: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

fn one(b: &mut Builder, primitives: Value) -> Model {
    let mesh = b.push("meshes", json!({"primitives": primitives}));
    b.node(json!({"name": "it", "mesh": mesh}));
    let model = b.model();
    check_rules(&model);
    model
}

fn triangles(mesh: &Mesh) -> Vec<[[f32; 3]; 3]> {
    let p = |i: &u32| mesh.vertices[*i as usize].position;
    mesh.indices.chunks(3).map(|t| [p(&t[0]), p(&t[1]), p(&t[2])]).collect()
}

fn normals(mesh: &Mesh) -> Vec<Vec3> {
    mesh.vertices.iter().map(|v| decode_normal(v.normal)).collect()
}

#[test]
fn every_index_type_gives_the_same_triangles() {
    let expected = [[QUAD[0], QUAD[1], QUAD[2]], [QUAD[0], QUAD[2], QUAD[3]]];
    let list = [0u32, 1, 2, 0, 2, 3];
    let le32: Vec<u8> = list.iter().flat_map(|i| i.to_le_bytes()).collect();
    let forms: [(Vec<u8>, u32); 3] =
        [(list.map(|i| i as u8).to_vec(), U8), (le_u16(&list.map(|i| i as u16)), U16), (le32, U32)];
    for (bytes, component) in forms {
        let mut b = Builder::new();
        let position = b.vec3(&QUAD);
        let indices = b.accessor(&bytes, component, "SCALAR", 6);
        let model =
            one(&mut b, json!([{"attributes": {"POSITION": position}, "indices": indices}]));
        assert_eq!(triangles(&model.meshes[0]), expected);
        assert_eq!(model.meshes[0].vertices.len(), 4, "equal corners of a flat face are shared");
    }
    let mut b = Builder::new();
    let position = b.vec3(&list.map(|i| QUAD[i as usize]));
    let model = one(&mut b, json!([{"attributes": {"POSITION": position}}]));
    assert_eq!(triangles(&model.meshes[0]), expected);
}

#[test]
fn strips_and_fans_become_triangles_that_face_the_same_way() {
    let mut b = Builder::new();
    let position = b.vec3(&QUAD);
    let strip = b.accessor(&[0, 1, 3, 2], U8, "SCALAR", 4);
    let model = one(
        &mut b,
        json!([
            {"attributes": {"POSITION": position}, "indices": strip, "mode": 5},
            {"attributes": {"POSITION": position}, "mode": 6},
        ]),
    );
    let mesh = &model.meshes[0];
    assert_eq!(mesh.triangle_count(), 4);
    assert!(normals(mesh).iter().all(|n| n.distance(Vec3::Z) < 0.01));
    let fan = &triangles(mesh)[2..];
    assert_eq!(fan, [[QUAD[1], QUAD[2], QUAD[0]], [QUAD[2], QUAD[3], QUAD[0]]]);
}

#[test]
fn points_and_lines_are_skipped_and_said() {
    let mut b = Builder::new();
    let position = b.vec3(&QUAD[..3]);
    let model = one(
        &mut b,
        json!([
            {"attributes": {"POSITION": position}, "mode": 0},
            {"attributes": {"POSITION": position}, "mode": 1},
            {"attributes": {"POSITION": position}, "mode": 4},
        ]),
    );
    assert_eq!(model.triangle_count(), 1);
    assert_eq!(model.diagnostics.get("points-or-lines").unwrap().count, 2);
}

#[test]
fn normals_are_taken_from_the_file_and_made_where_missing() {
    let mut b = Builder::new();
    let position = b.vec3(&QUAD[..3]);
    let tilted = Vec3::new(0.6, 0.0, 0.8);
    let normal = b.vec3(&[tilted.into(), tilted.into(), [0.0; 3]]);
    let short = b.vec3(&[[1.0, 0.0, 0.0]]);
    let model = one(
        &mut b,
        json!([
            {"attributes": {"POSITION": position, "NORMAL": normal}},
            {"attributes": {"POSITION": position, "NORMAL": short}},
        ]),
    );
    let found = normals(&model.meshes[0]);
    assert!(found[0].distance(tilted) < 0.02 && found[1].distance(tilted) < 0.02);
    assert!(
        found[2..].iter().all(|n| n.distance(Vec3::Z) < 0.02),
        "zero and missing ones are flat"
    );
    let warning = model.diagnostics.get("bad-attribute").unwrap();
    assert!(warning.message.contains("1 elements for 3 positions"), "{}", warning.message);
}

#[test]
fn flat_faces_at_an_edge_do_not_share_normals() {
    let mut b = Builder::new();
    let position = b.vec3(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let indices = b.accessor(&[0, 1, 2, 0, 3, 1], U8, "SCALAR", 6);
    let model = one(&mut b, json!([{"attributes": {"POSITION": position}, "indices": indices}]));
    assert_eq!(model.meshes[0].vertices.len(), 6);
    let n = normals(&model.meshes[0]);
    assert!(n[0].distance(Vec3::Z) < 0.01 && n[3].distance(Vec3::Y) < 0.01);
}

#[test]
fn primitives_merge_with_the_transparent_ones_last() {
    let mut b = Builder::new();
    let position = b.vec3(&QUAD[..3]);
    b.json["materials"] = json!([
        {"name": "glass", "alphaMode": "BLEND", "pbrMetallicRoughness":
            {"baseColorFactor": [0.2, 0.4, 0.6, 0.25], "roughnessFactor": 0.1, "metallicFactor": 0.5}},
        {"name": "frame", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.5]}},
        {"name": "not really glass", "alphaMode": "BLEND"},
        {"name": "leaf", "alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0, 0.5]}},
    ]);
    let part = |m: usize| json!({"attributes": {"POSITION": position}, "material": m});
    let model = one(&mut b, json!([part(0), part(1), part(2), part(3)]));
    let mesh = &model.meshes[0];
    assert_eq!((mesh.opaque, mesh.indices.len()), (9, 12));
    let of = |i: u32| &model.materials[usize::from(mesh.vertices[i as usize].material)];
    assert_eq!(of(mesh.indices[9]).name, "glass");
    let glass = of(mesh.indices[9]);
    assert_eq!((glass.color, glass.roughness, glass.metallic), ([0.2, 0.4, 0.6, 0.25], 0.1, 0.5));
    assert!(glass.transparent);
    assert_eq!(of(mesh.indices[0]).color, [1.0, 0.0, 0.0, 1.0], "OPAQUE ignores alpha");
    assert!(model.diagnostics.get("alpha-mask").is_some());
}

#[test]
fn vertex_colours_become_materials() {
    let quarter = [[1.0f32, 0.5, 0.0, 1.0], [1.0, 0.5, 0.0, 1.0], [0.25, 0.25, 0.25, 1.0]];
    let bytes: Vec<u8> = quarter.concat().iter().map(|c| (c * 255.0).round() as u8).collect();
    let words: Vec<u16> = quarter.concat().iter().map(|c| (c * 65535.0).round() as u16).collect();
    let rgb: Vec<f32> = quarter.iter().flat_map(|c| c[..3].to_vec()).collect();
    let forms = [
        (le_f32(&quarter.concat()), F32, "VEC4"),
        (le_f32(&rgb), F32, "VEC3"),
        (bytes, U8, "VEC4"),
        (le_u16(&words), U16, "VEC4"),
    ];
    for (bytes, component, shape) in forms {
        let mut b = Builder::new();
        let position = b.vec3(&QUAD[..3]);
        let color = b.accessor(&bytes, component, shape, 3);
        b.json["materials"] = json!([{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], "roughnessFactor": 0.3}}]);
        let model = one(
            &mut b,
            json!([
            {"attributes": {"POSITION": position, "COLOR_0": color}, "material": 0}]),
        );
        let vertices = &model.meshes[0].vertices;
        assert_eq!(vertices[0].material, vertices[1].material);
        for (vertex, expected) in vertices.iter().zip(quarter) {
            let material = &model.materials[usize::from(vertex.material)];
            let expected = [expected[0] * 0.5, expected[1], expected[2], 1.0];
            for (a, b) in material.color.iter().zip(expected) {
                assert!((a - b).abs() < 0.003, "{component} {shape}: {a} {b}");
            }
            assert_eq!(material.roughness, 0.3);
        }
    }
}

#[test]
fn transparent_vertex_colours_move_their_triangle_to_the_transparent_ones() {
    let mut b = Builder::new();
    let position = b.vec3(&[QUAD[0], QUAD[1], QUAD[2], QUAD[0], QUAD[2], QUAD[3]]);
    let alpha = [255u8, 255, 255, 128, 128, 128];
    let bytes: Vec<u8> = alpha.iter().flat_map(|&a| [255, 255, 255, a]).collect();
    let color = b.accessor(&bytes, U8, "VEC4", 6);
    b.json["materials"] = json!([{"alphaMode": "BLEND"}]);
    let model = one(
        &mut b,
        json!([
        {"attributes": {"POSITION": position, "COLOR_0": color}, "material": 0}]),
    );
    assert_eq!(model.meshes[0].opaque, 3);
    b.json["materials"] = json!([{}]);
    assert_eq!(b.model().meshes[0].opaque, 6);
}

#[test]
fn more_colours_than_materials_are_brought_together_and_said() {
    let mut b = Builder::new();
    let count = 90_000usize;
    let positions: Vec<[f32; 3]> =
        (0..count).map(|i| [(i % 300) as f32, (i / 300) as f32, 0.0]).collect();
    let colors: Vec<f32> = (0..count)
        .flat_map(|i| [(i % 300) as f32 / 299.0, (i / 300) as f32 / 299.0, 0.5])
        .collect();
    let position = b.vec3(&positions);
    let color = b.accessor(&le_f32(&colors), F32, "VEC3", count);
    let model = one(&mut b, json!([{"attributes": {"POSITION": position, "COLOR_0": color}}]));
    assert!(model.diagnostics.get("many-colors").is_some());
    for vertex in model.meshes[0].vertices.iter().step_by(97) {
        let i = vertex.position[1] as usize * 300 + vertex.position[0] as usize;
        let color = model.materials[usize::from(vertex.material)].color;
        for k in 0..3 {
            assert!((color[k] - colors[i * 3 + k]).abs() < 0.01);
        }
    }
}

fn png(pixels: &[[u8; 4]]) -> Vec<u8> {
    let image = image::RgbaImage::from_raw(pixels.len() as u32, 1, pixels.concat()).unwrap();
    let mut out = std::io::Cursor::new(Vec::new());
    image.write_to(&mut out, image::ImageFormat::Png).unwrap();
    out.into_inner()
}

#[test]
fn the_mean_of_a_texture_tints_the_material() {
    let mut b = Builder::new();
    let position = b.vec3(&QUAD[..3]);
    let view = b.view(&png(&[[255, 0, 0, 255], [0, 0, 0, 255]]));
    b.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
    b.push("textures", json!({"source": 0}));
    b.json["materials"] = json!([
        {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], "baseColorTexture":
            {"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}}}}},
        {"extensions": {"KHR_materials_unlit": {}}, "pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0}},
    ]);
    b.json["extensionsRequired"] = json!(["KHR_texture_transform", "KHR_materials_unlit"]);
    let part = |m: usize| json!({"attributes": {"POSITION": position}, "material": m});
    let model = one(&mut b, json!([part(0), part(1)]));
    let color = model.materials[0].color;
    assert!((color[0] - 0.25).abs() < 1e-4 && color[1] == 0.0, "{color:?}");
    assert_eq!((model.materials[1].metallic, model.materials[1].roughness), (0.0, 1.0));
    assert!(model.diagnostics.get("texture").is_none());
    // The same picture, damaged; then missing; then of a kind that is not read.
    let start = b.json["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize;
    b.bin[start + 40..].iter_mut().take(12).for_each(|byte| *byte ^= 0x5A);
    for image in [json!({"bufferView": view}), json!({"uri": "gone.png"}), json!({})] {
        b.json["images"][0] = image;
        let model = b.model();
        assert_eq!(model.materials[0].color, [0.5, 1.0, 1.0, 1.0]);
        let warning = model.diagnostics.get("texture").unwrap();
        assert!(warning.message.contains("images[0]"), "{}", warning.message);
    }
    b.json["textures"][0] = json!({"extensions": {"KHR_texture_basisu": {"source": 0}}});
    assert!(b.model().diagnostics.get("texture").is_some());
}

#[test]
fn quantised_meshes_are_read() {
    let mut b = Builder::new();
    let words = [0i16, 0, 0, 0, 1000, 0, 0, 0, 0, 1000, 0, 0];
    let bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
    let position = b.accessor(&bytes, I16, "VEC3", 3);
    b.json["bufferViews"][0]["byteStride"] = json!(8);
    let normal = b.accessor(&[0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0], 5120, "VEC3", 3);
    b.json["bufferViews"][1]["byteStride"] = json!(4);
    b.json["accessors"][normal]["normalized"] = json!(true);
    b.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let mesh = b.push(
        "meshes",
        json!({"primitives": [{"attributes": {"POSITION": position, "NORMAL": normal}}]}),
    );
    b.node(json!({"name": "it", "mesh": mesh, "scale": [0.001, 0.001, 0.001]}));
    let model = b.model();
    check_rules(&model);
    assert!((model.elements[0].bounds.max - Vec3::new(1.0, 1.0, 0.0)).length() < 1e-5);
    assert!(normals(&model.meshes[0]).iter().all(|n| n.distance(Vec3::Y) < 0.01));
    b.json["accessors"][position]["normalized"] = json!(true);
    let size = b.model().elements[0].bounds.max.x;
    assert!((size - 0.001 * 1000.0 / 32767.0).abs() < 1e-7);
}

#[test]
fn meshopt_compression_is_unpacked() {
    let mut b = Builder::new();
    let positions: Vec<[f32; 3]> =
        (0..200).map(|i| [(i % 20) as f32, (i / 20) as f32, 0.0]).collect();
    let mut list = Vec::new();
    for y in 0..9u32 {
        for x in 0..19u32 {
            let i = y * 20 + x;
            list.extend([i, i + 1, i + 21, i, i + 21, i + 20]);
        }
    }
    let tilted = vec![[0.6f32, 0.0, 0.8, 0.0]; 200];
    let parts = [
        (pack::vertices(&positions), 12, 200, "ATTRIBUTES", "NONE"),
        (pack::vertices(&pack::exponential(&positions)), 12, 200, "ATTRIBUTES", "EXPONENTIAL"),
        (pack::vertices(&pack::octahedral(&tilted)), 4, 200, "ATTRIBUTES", "OCTAHEDRAL"),
        (pack::triangles(&list, 200), 2, list.len(), "TRIANGLES", "NONE"),
        (pack::indices(&list, 200), 4, list.len(), "INDICES", "NONE"),
    ];
    for (packed, stride, count, mode, filter) in parts {
        let view = b.view(&packed);
        let mut packed_view = b.json["bufferViews"][view].take();
        for (key, value) in [
            ("byteStride", json!(stride)),
            ("count", json!(count)),
            ("mode", json!(mode)),
            ("filter", json!(filter)),
        ] {
            packed_view[key] = value;
        }
        b.json["bufferViews"][view] = json!({"buffer": 1, "byteOffset": 0, "byteLength": stride * count,
            "extensions": {"EXT_meshopt_compression": packed_view}});
    }
    b.push(
        "buffers",
        json!({"byteLength": 100_000,
        "extensions": {"EXT_meshopt_compression": {"fallback": true}}}),
    );
    b.json["extensionsRequired"] = json!(["EXT_meshopt_compression", "KHR_mesh_quantization"]);
    for (view, component, shape, count) in [
        (0, F32, "VEC3", 200),
        (1, F32, "VEC3", 200),
        (2, 5120, "VEC3", 200),
        (3, U16, "SCALAR", list.len()),
        (4, U32, "SCALAR", list.len()),
    ] {
        b.push(
            "accessors",
            json!({"bufferView": view, "componentType": component, "type": shape,
            "count": count, "normalized": view == 2}),
        );
    }
    let model = one(
        &mut b,
        json!([
            {"attributes": {"POSITION": 0, "NORMAL": 2}, "indices": 3},
            {"attributes": {"POSITION": 1, "NORMAL": 2}, "indices": 4},
        ]),
    );
    let mesh = &model.meshes[0];
    assert_eq!(mesh.triangle_count(), list.len() / 3 * 2);
    assert_eq!(mesh.vertices.len(), 200, "both forms are the same grid");
    assert!(normals(mesh).iter().all(|n| n.distance(Vec3::new(0.6, 0.0, 0.8)) < 0.03));
    let area: f32 = triangles(mesh)
        .iter()
        .map(|[a, b, c]| {
            (Vec3::from(*b) - Vec3::from(*a)).cross(Vec3::from(*c) - Vec3::from(*a)).length() / 2.0
        })
        .sum();
    assert!((area - 2.0 * 19.0 * 9.0).abs() < 0.01);
    // Damage to the packed data is named.
    b.bin[0] ^= 0xFF;
    let model = b.model();
    let error = model.diagnostics.get("bad-primitive").unwrap();
    assert!(error.message.contains("bufferViews[0]"), "{}", error.message);
}

#[test]
fn sparse_accessors_substitute_values() {
    let mut b = Builder::new();
    let position = b.vec3(&QUAD[..3]);
    let indices = b.view(&[1, 2]);
    let values = b.view(&le_f32(&[5.0, 0.0, 0.0, 0.0, 7.0, 0.0]));
    let sparse = json!({"count": 2, "indices": {"bufferView": indices, "componentType": U8},
                        "values": {"bufferView": values}});
    b.json["accessors"][position]["sparse"] = sparse.clone();
    let bare = b.push(
        "accessors",
        json!({"componentType": F32, "type": "VEC3", "count": 3, "sparse": sparse}),
    );
    let model = one(
        &mut b,
        json!([
        {"attributes": {"POSITION": position}}, {"attributes": {"POSITION": bare}}]),
    );
    let expected = [[0.0; 3], [5.0, 0.0, 0.0], [0.0, 7.0, 0.0]];
    assert_eq!(triangles(&model.meshes[0]), [expected, expected]);
    b.bin[b.json["bufferViews"][indices]["byteOffset"].as_u64().unwrap() as usize + 1] = 9;
    assert!(b.error().contains("sparse: index 9 is out of range"), "{}", b.error());
}

#[test]
fn interleaved_attributes_and_shared_accessors_are_read() {
    let mut b = Builder::new();
    let mut bytes = Vec::new();
    for p in QUAD {
        bytes.extend(le_f32(&p));
        bytes.extend(le_f32(&[0.0, 0.0, 1.0]));
    }
    let view = b.view(&bytes);
    b.json["bufferViews"][view]["byteStride"] = json!(24);
    for offset in [0, 12] {
        b.push("accessors", json!({"bufferView": view, "byteOffset": offset, "componentType": F32, "type": "VEC3", "count": 4}));
    }
    let first = b.accessor(&[0, 1, 2], U8, "SCALAR", 3);
    let second = b.accessor(&[0, 2, 3], U8, "SCALAR", 3);
    let part = |i: usize| json!({"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": i});
    let model = one(&mut b, json!([part(first), part(second)]));
    assert_eq!(
        triangles(&model.meshes[0]),
        [[QUAD[0], QUAD[1], QUAD[2]], [QUAD[0], QUAD[2], QUAD[3]]]
    );
    assert_eq!(model.meshes[0].vertices.len(), 4);
}

#[test]
fn what_is_not_shown_is_said() {
    let mut b = Builder::simple();
    b.json["animations"] = json!([{"channels": [], "samplers": []}]);
    b.json["nodes"][0]["skin"] = json!(0);
    b.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 0}]);
    let model = b.model();
    for code in ["animations", "skins", "morph-targets"] {
        assert!(model.diagnostics.get(code).is_some(), "{code}");
    }
    assert!(!model.diagnostics.has_errors());
}

#[test]
fn extensions_that_are_not_read_are_refused_by_name() {
    let mut b = Builder::simple();
    for name in ["KHR_draco_mesh_compression", "VENDOR_new_thing"] {
        b.json["extensionsRequired"] = json!([name]);
        let message = b.error();
        assert!(message.contains(name) && message.contains("model.glb"), "{message}");
    }
    b.json["extensionsRequired"] = json!([]);
    b.json["extensionsUsed"] = json!(["VENDOR_new_thing"]);
    assert_eq!(b.model().elements.len(), 1, "an optional extension does no harm");
}
