//! Nodes, elements, groups, transforms, origins.

use super::build::{Builder, check_rules, read};
use glam::{DVec3, Vec3};
use serde_json::json;

fn world(model: &crate::Model, element: usize, point: Vec3) -> DVec3 {
    let element = &model.elements[element];
    let instance = model.instances_of(element)[0];
    instance.world_from_mesh.transform_point3(point).as_dvec3() + model.origin
}

#[test]
fn elements_are_named_mesh_nodes_and_named_nodes_above_nameless_ones() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    // 0 storey > (1 wall, 2 window > nameless 3 > nameless 4, 5 nameless-with-guid), 6 alone
    b.node(json!({"name": "storey", "children": [1, 2, 5],
                  "extras": {"type": "IfcBuildingStorey", "ifcName": "Level 1"}}));
    b.node(json!({"name": "wall", "mesh": mesh, "extras": {"storey": "own"}}));
    b.node(json!({"name": "window", "children": [3], "extras": {"guid": "w-guid"}}));
    b.node(json!({"mesh": mesh, "children": [4]}));
    b.node(json!({"name": "  ", "mesh": mesh}));
    b.node(json!({"mesh": mesh, "extras": {"GlobalId": "5-guid"}}));
    b.node(json!({"mesh": mesh}));
    let model = b.model();
    check_rules(&model);
    let found: Vec<_> = model
        .elements
        .iter()
        .map(|e| (e.name.as_str(), e.guid.as_deref(), e.storey.as_str(), e.instances.len()))
        .collect();
    let expected = [
        ("wall", None, "own", 1),
        ("window", Some("w-guid"), "Level 1", 2),
        ("", Some("5-guid"), "Level 1", 1),
        ("", None, "", 1),
    ];
    assert_eq!(found, expected);
    assert_eq!(model.groups.len(), 1);
    assert_eq!(
        (model.groups[0].name.as_str(), model.groups[0].label.as_str()),
        ("storey", "Level 1")
    );
    assert!(model.elements[..3].iter().all(|e| e.group == Some(crate::GroupId(0))));
    assert_eq!(model.elements[3].group, None);
    assert_eq!(model.meshes.len(), 1, "a mesh that is used five times is stored once");
}

#[test]
fn a_mesh_node_named_after_its_element_is_a_part_of_it() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    b.node(json!({"name": "door", "children": [1, 2, 3], "extras": {"guid": "door"}}));
    b.node(json!({"name": "door.part", "mesh": mesh}));
    b.node(json!({"name": "door.geom", "mesh": mesh, "children": [4]}));
    b.node(json!({"name": "doorbell", "mesh": mesh}));
    b.node(json!({"mesh": mesh}));
    let model = b.model();
    check_rules(&model);
    let found: Vec<_> =
        model.elements.iter().map(|e| (e.name.as_str(), e.instances.len())).collect();
    assert_eq!(found, [("door", 3), ("doorbell", 1)]);
    // Without a guid above, the names are the only ones there are.
    b.json["nodes"][0]["extras"] = json!({});
    assert_eq!(b.model().elements.len(), 3);
}

#[test]
fn groups_nest_and_know_their_parents() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    b.node(json!({"name": "site", "children": [1]}));
    b.node(json!({"children": [2]}));
    b.node(json!({"name": "zone", "children": [3], "extras": {"guid": "z", "class": "zone"}}));
    b.node(json!({"name": "wall", "mesh": mesh}));
    let model = b.model();
    assert_eq!(model.groups[1].parent, Some(crate::GroupId(0)), "nameless nodes are no groups");
    assert_eq!(model.groups[1].guid.as_deref(), Some("z"));
    assert_eq!(model.groups[1].kind, "zone");
    assert_eq!(model.elements[0].group, Some(crate::GroupId(1)));
}

#[test]
fn transforms_accumulate_in_either_notation() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    // Mirrored by the parent, non-uniform and turned by 90 degrees about Z below.
    b.node(
        json!({"name": "mirror", "scale": [-1, 1, 1], "translation": [10, 0, 0], "children": [1]}),
    );
    b.node(json!({"name": "a", "mesh": mesh, "rotation": [0, 0, half, half], "scale": [2, 3, 1],
                  "translation": [0, 1, 0]}));
    b.node(json!({"name": "b", "mesh": mesh,
                  "matrix": [2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]}));
    // A quaternion that is not unit means the same turn.
    b.node(json!({"name": "c", "mesh": mesh, "rotation": [0, 0, 5.0 * half, 5.0 * half]}));
    b.node(json!({"name": "zero", "mesh": mesh, "scale": [0, 0, 0], "rotation": [0, 0, 0, 0]}));
    let model = b.model();
    check_rules(&model);
    let near = |a: DVec3, b: [f64; 3]| assert!(a.distance(b.into()) < 1e-5, "{a} {b:?}");
    near(world(&model, 0, Vec3::X), [10.0, 3.0, 0.0]);
    near(world(&model, 0, Vec3::Y), [13.0, 1.0, 0.0]);
    near(world(&model, 1, Vec3::ONE), [7.0, 9.0, 8.0]);
    near(world(&model, 2, Vec3::X), [0.0, 1.0, 0.0]);
    near(world(&model, 3, Vec3::ONE), [0.0, 0.0, 0.0]);
    assert!(model.instances[0].world_from_mesh.matrix3.determinant() < 0.0);
    assert!(!model.diagnostics.has_errors());
}

#[test]
fn a_hundred_thousand_nested_nodes_do_not_overflow_the_stack() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    let depth = 100_000;
    for i in 0..depth {
        b.node(json!({"children": [i + 1], "translation": [1e-3, 0, 0]}));
    }
    b.node(json!({"name": "deep", "mesh": mesh}));
    let model = b.model();
    assert!((world(&model, 0, Vec3::ZERO).x - 100.0).abs() < 1e-4);
}

#[test]
fn only_the_default_scene_is_read() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    b.node(json!({"name": "a", "mesh": mesh}));
    b.node(json!({"name": "b", "mesh": mesh}));
    assert_eq!(b.model().elements.len(), 2, "no scene: all root nodes");
    b.json["scenes"] = json!([{"nodes": [0]}, {"nodes": [1]}]);
    assert_eq!(b.model().elements[0].name, "a", "no default: the first scene");
    b.json["scene"] = json!(1);
    let model = b.model();
    assert_eq!((model.elements.len(), model.elements[0].name.as_str()), (1, "b"));
    b.json["scene"] = json!(2);
    assert!(b.error().contains("scenes[2], but there are only 2"), "{}", b.error());
    b.json["scene"] = json!(0);
    b.json["scenes"] = json!([{"nodes": [0, 0]}]);
    assert!(b.error().contains("nodes[0] twice"), "{}", b.error());
    b.json["scenes"] = json!([{"nodes": [7]}]);
    assert!(b.error().contains("nodes[7]"), "{}", b.error());
}

#[test]
fn cyclic_nodes_are_refused_by_name() {
    let mut b = Builder::simple();
    b.node(json!({"name": "ouroboros", "children": [2]}));
    b.node(json!({"name": "tail", "children": [1]}));
    let message = b.error();
    assert!(message.contains("model.glb") && message.contains("ouroboros"), "{message}");
    assert!(message.contains("cyclic"), "{message}");
    b.json["nodes"] = json!([{"name": "self", "children": [0]}]);
    assert!(b.error().contains("cyclic"), "{}", b.error());
    // A scene may point into the cycle.
    b.json["scenes"] = json!([{"nodes": [0]}]);
    assert!(b.error().contains("self"), "{}", b.error());
}

#[test]
fn two_parents_and_missing_children_are_refused_by_name() {
    let mut b = Builder::simple();
    b.node(json!({"name": "x", "children": [0]}));
    b.node(json!({"name": "y", "children": [0]}));
    let message = b.error();
    assert!(message.contains("wall") && message.contains("nodes[1] and nodes[2]"), "{message}");
    b.json["nodes"] = json!([{"children": [5]}]);
    assert!(b.error().contains("nodes[5]"), "{}", b.error());
    b.json["nodes"] = json!([{"mesh": 5}]);
    assert!(b.error().contains("meshes[5]"), "{}", b.error());
    b.json["nodes"] = json!([{"mesh": 0, "matrix": [1, 2, 3]}]);
    assert!(b.error().contains("3 numbers instead of 16"), "{}", b.error());
}

#[test]
fn national_coordinates_keep_millimetres() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    for i in 0..10 {
        let x = 155_000.0 + f64::from(i) * 0.001;
        b.node(
            json!({"name": format!("n{i}"), "mesh": mesh, "translation": [x, 12.5, -463_000.25]}),
        );
    }
    let model = b.model();
    check_rules(&model);
    assert_eq!(model.origin.y, 0.0, "heights stay as they are");
    assert!(model.bounds().size().x < 1.1);
    for i in 0..10 {
        let expected = DVec3::new(155_000.0 + f64::from(i as u32) * 0.001, 12.5, -463_000.25);
        assert!(world(&model, i, Vec3::ZERO).distance(expected) < 1e-6);
    }
}

#[test]
fn far_vertices_of_a_mesh_keep_their_shape() {
    let mut b = Builder::new();
    let at = [155_000.0f32, 0.0, -463_000.0];
    let position = b.vec3(&[at, [at[0] + 0.25, at[1], at[2]], [at[0], at[1] + 0.125, at[2]]]);
    let mesh = b.push("meshes", json!({"primitives": [{"attributes": {"POSITION": position}}]}));
    b.node(json!({"name": "far", "mesh": mesh}));
    let model = b.model();
    check_rules(&model);
    let size = model.elements[0].bounds.size();
    assert_eq!(size, Vec3::new(0.25, 0.125, 0.0));
    assert!(model.elements[0].bounds.max.abs().max_element() < 1.0);
    let center = model.origin + model.elements[0].bounds.min.as_dvec3();
    assert_eq!(center, DVec3::new(155_000.0, 0.0, -463_000.0));
}

#[test]
fn what_lies_absurdly_far_away_is_left_out_and_named() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    for i in 0..5 {
        b.node(json!({"name": format!("n{i}"), "mesh": mesh, "translation": [i, 0, 0]}));
    }
    b.node(json!({"name": "stray", "mesh": mesh, "translation": [0, 2e7, 0]}));
    b.node(json!({"name": "beyond", "mesh": mesh, "scale": [1e300, 1, 1], "children": [7]}));
    b.node(json!({"name": "overflow", "mesh": mesh, "scale": [1e300, 1, 1]}));
    let model = b.model();
    check_rules(&model);
    assert_eq!(model.elements.len(), 5);
    let found = model.diagnostics.get("far-element").unwrap();
    assert_eq!(found.examples, ["stray", "beyond", "overflow"]);
    assert!(found.message.contains("stray") && found.message.contains("20000000"));
    assert_eq!(model.origin, DVec3::ZERO);
}

#[test]
fn instancing_places_one_element_many_times() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    let at = b.vec3(&[[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [20.0, 0.0, 0.0]]);
    b.node(json!({"name": "fence", "mesh": mesh, "translation": [1, 0, 0],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": at}}}}));
    b.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let model = b.model();
    check_rules(&model);
    assert_eq!((model.elements.len(), model.instances.len(), model.meshes.len()), (1, 3, 1));
    assert_eq!(model.triangle_count(), 3);
    assert_eq!(model.elements[0].bounds.max.x, 22.0);
}

#[test]
fn meshes_that_nobody_places_are_not_kept() {
    let mut b = Builder::simple();
    b.triangle();
    assert_eq!(b.model().meshes.len(), 1);
}

#[test]
fn a_federation_keeps_models_apart_and_in_place() {
    let mut near = Builder::simple();
    near.json["nodes"][0]["translation"] = json!([3, 0, 0]);
    let mut far = Builder::simple();
    far.json["nodes"][0]["translation"] = json!([155_000.125, 0, 0]);
    far.json["materials"] =
        json!([{"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}]);
    far.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    far.node(json!({"name": "group", "children": [2]}));
    far.node(json!({"name": "roof", "mesh": 0, "translation": [155_001, 0, 0]}));
    let (a, c) = (near.model(), far.model());
    assert_ne!(a.origin, c.origin);
    let all = crate::import::federate(vec![a.clone(), c]);
    check_rules(&all);
    let names: Vec<_> = all.elements.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names, ["wall", "wall", "roof"]);
    assert!((world(&all, 0, Vec3::ZERO).x - 3.0).abs() < 0.01);
    assert_eq!(world(&all, 1, Vec3::ZERO).x, 155_000.125);
    assert_eq!(all.groups[all.elements[2].group.unwrap().index()].name, "group");
    let color = |e: usize| {
        let instance = all.instances_of(&all.elements[e])[0];
        let vertex = all.meshes[instance.mesh.index()].vertices[0];
        all.materials[usize::from(vertex.material)].color
    };
    assert_eq!((color(0), color(1)), ([1.0; 4], [1.0, 0.0, 0.0, 1.0]));
    assert_eq!(all.diagnostics.get("equal-names").unwrap().examples, ["wall"]);
    assert!(all.diagnostics.get("models-far-apart").is_some());
    assert_eq!(crate::import::federate(vec![a.clone()]).elements.len(), 1);
    assert_eq!(crate::import::federate(vec![]).elements.len(), 0);
}

#[test]
fn a_federation_respects_the_number_of_materials() {
    let mut model = read(&Builder::simple().glb()).unwrap();
    let white = model.materials[0].clone();
    model.materials = (0..40_000u32)
        .map(|i| crate::Material {
            color: [(i % 200) as f32 / 200.0, 0.5, 0.5, 1.0],
            ..white.clone()
        })
        .collect();
    model.meshes[0].vertices[0].material = 39_999;
    let all = crate::import::federate(vec![model.clone(), model]);
    check_rules(&all);
    for mesh in &all.meshes {
        let place = usize::from(mesh.vertices[0].material);
        assert_eq!(all.materials[place].color[0], 199.0 / 200.0);
    }
}
