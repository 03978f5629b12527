//! The tree against brute force on small random scenes.
#![allow(clippy::unwrap_used)]

use super::bvh::squared_distance;
use super::*;
use crate::{
    BehaviourId, Element, Instance, Material, Mesh, MeshId, Model, Progress, Scene, View,
    encode_normal,
};
use glam::{Affine3A, Quat, UVec2, Vec3};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;
use std::collections::BTreeSet;
use topout_schedule::{Behaviour, Schedule, Share, Time, TimeRange};

mod edits;

const END: i64 = 100;

fn cube(material: u16) -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for side in [-0.5f32, 0.5] {
            let base = mesh.vertices.len() as u32;
            for (u, v) in [(-0.5f32, -0.5f32), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)] {
                let mut position = [0.0; 3];
                position[axis] = side;
                position[(axis + 1) % 3] = u;
                position[(axis + 2) % 3] = v;
                let mut normal = [0.0; 3];
                normal[axis] = side * 2.0;
                mesh.vertices.push(Vertex {
                    position,
                    normal: encode_normal(Vec3::from(normal)),
                    material,
                });
            }
            mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|i| base + i));
        }
    }
    mesh.opaque = if material == 2 { 0 } else { mesh.indices.len() as u32 };
    mesh.bounds = Aabb::of_points(mesh.vertices.iter().map(|v| v.position.into()));
    mesh
}

fn material(color: [f32; 4]) -> Material {
    Material {
        name: String::new(),
        color,
        roughness: 1.0,
        metallic: 0.0,
        transparent: color[3] < 1.0,
    }
}

#[derive(Clone, Debug)]
pub(super) struct Part {
    pub center: Vec3,
    pub size: Vec3,
    pub turn: f32,
    pub mesh: u32,
    pub behaviour: usize,
}

/// Storeys of a hundred turned boxes each, `rise` metres apart; `size` is the boxes' width and depth.
/// A behaviour for each storey.
pub(super) fn storeys(rise: f32, size: [f32; 2], behaviours: &[Behaviour]) -> Scene {
    let parts: Vec<Part> = (0..behaviours.len() * 100)
        .map(|i| Part {
            center: Vec3::new((i % 10) as f32, (i / 100) as f32 * rise, (i / 10 % 10) as f32),
            size: Vec3::new(size[0], 0.2 + (i % 7) as f32 * 0.1, size[1]),
            turn: (i % 3) as f32,
            mesh: 0,
            behaviour: i / 100,
        })
        .collect();
    scene_of(&parts, behaviours)
}

pub(super) fn scene_of(parts: &[Part], behaviours: &[Behaviour]) -> Scene {
    let mut model = Model {
        meshes: (0..3).map(cube).collect(),
        materials: vec![
            material([0.5, 0.5, 0.5, 1.0]),
            material([0.9, 0.1, 0.1, 1.0]),
            material([0.3, 0.5, 0.9, 0.3]),
        ],
        ..Model::default()
    };
    for part in parts {
        let transform = Affine3A::from_scale_rotation_translation(
            part.size,
            Quat::from_rotation_y(part.turn),
            part.center,
        );
        let mesh = &model.meshes[part.mesh as usize];
        let points = mesh.vertices.iter().map(|v| transform.transform_point3(v.position.into()));
        let bounds = Aabb::of_points(points);
        let first = model.instances.len() as u32;
        model.instances.push(Instance { mesh: MeshId(part.mesh), world_from_mesh: transform });
        model.elements.push(Element { instances: first..first + 1, bounds, ..Element::default() });
    }
    let period = TimeRange { start: Time::from_seconds(0), end: Time::from_seconds(END) };
    Scene {
        element_behaviour: parts.iter().map(|p| BehaviourId(p.behaviour as u32)).collect(),
        schedule: Schedule { period, ..Schedule::default() },
        behaviours: behaviours.to_vec(),
        model: model.into(),
        ..Scene::default()
    }
}

fn behaviour() -> impl Strategy<Value = Behaviour> {
    (any::<bool>(), proptest::collection::btree_set(0..END, 0..4)).prop_map(|(initial, times)| {
        Behaviour::new(initial, times.into_iter().map(Time::from_seconds).collect()).unwrap()
    })
}

/// Boxes of a few centimetres to several metres in a yard of 40 m, some of them equal.
pub(crate) fn scene() -> impl Strategy<Value = Scene> {
    let coordinate = || (0u32..80).prop_map(|v| v as f32 * 0.5);
    let edge = || prop_oneof![Just(0.05f32), Just(0.3), Just(1.0), 0.02f32..6.0];
    let part = (
        (coordinate(), 0f32..12.0, coordinate()),
        (edge(), edge(), edge()),
        prop_oneof![Just(0f32), 0f32..3.0],
        0u32..3,
        0usize..5,
    )
        .prop_map(|((x, y, z), (a, b, c), turn, mesh, behaviour)| Part {
            center: Vec3::new(x, y, z),
            size: Vec3::new(a, b, c),
            turn,
            mesh,
            behaviour,
        });
    (proptest::collection::vec(part, 1..90), proptest::collection::vec(behaviour(), 5))
        .prop_map(|(parts, behaviours)| scene_of(&parts, &behaviours))
}

pub(crate) fn built(scene: &Scene, temporal: Temporal) -> Hdlod {
    build(scene, &Settings { temporal, ..Settings::default() }, &Progress::default()).unwrap()
}

pub(crate) fn leaves_below(hdlod: &Hdlod, node: Node, out: &mut Vec<ElementId>) {
    match node {
        Node::Leaf(id) => out.push(id),
        Node::Cluster(i) => {
            for &child in hdlod.children_of(&hdlod.clusters[i as usize]) {
                leaves_below(hdlod, child, out);
            }
        }
    }
}

pub(crate) fn element_triangles(scene: &Scene, id: ElementId, out: &mut Vec<[Vec3; 3]>) {
    let mut triangles = Vec::new();
    for instance in scene.model.instances_of(&scene.model.elements[id.index()]) {
        let mesh = &scene.model.meshes[instance.mesh.index()];
        soup::append_instance(instance, mesh, BehaviourId(0), &mut triangles);
    }
    out.extend(triangles.iter().map(|t| t.corners));
}

fn drawn_at(hdlod: &Hdlod, cluster: &Cluster, scene: &Scene, time: Time) -> Vec<[Vec3; 3]> {
    let mut out = Vec::new();
    for (_, run, range) in cluster.runs() {
        if scene.behaviours[run.behaviour.index()].at(time) {
            out.extend(hdlod.indices.triangles(range).map(|corners| {
                corners.map(|index| {
                    let at = (cluster.base_vertex() + index) as usize;
                    Vec3::from(hdlod.vertices[at].position)
                })
            }));
        }
    }
    out
}

/// The largest distance from sampled points of `from` to the nearest triangle of `to`. In f64, or long
/// thin triangles would seem farther off than they are.
fn sampled_distance(from: &[[Vec3; 3]], to: &[[Vec3; 3]]) -> f32 {
    let exact = |corners: &[Vec3; 3]| corners.map(|c| c.as_dvec3());
    let to: Vec<_> = to.iter().map(exact).collect();
    let mut worst = 0f64;
    for [a, b, c] in from.iter().map(exact) {
        for i in 0..=6 {
            for j in 0..=6 - i {
                let (u, v) = (f64::from(i) / 6.0, f64::from(j) / 6.0);
                let point = a + (b - a) * u + (c - a) * v;
                let nearest =
                    to.iter().map(|t| squared_distance(point, *t)).fold(f64::INFINITY, f64::min);
                worst = worst.max(nearest);
            }
        }
    }
    worst.sqrt() as f32
}

/// R11 by brute force at one date, for the clusters that hold.
fn check_promise(hdlod: &Hdlod, scene: &Scene, time: Time) -> Result<(), TestCaseError> {
    for cluster in hdlod.clusters.iter().filter(|c| !c.stale) {
        let mut leaves = Vec::new();
        for &child in hdlod.children_of(cluster) {
            leaves_below(hdlod, child, &mut leaves);
        }
        let mut present = Vec::new();
        for &id in leaves.iter().filter(|id| scene.behaviour(**id).at(time)) {
            element_triangles(scene, id, &mut present);
        }
        let drawn = drawn_at(hdlod, cluster, scene, time);
        prop_assert_eq!(present.is_empty(), drawn.is_empty());
        let tolerance = cluster.eps + 1e-4;
        let (lost, invented) =
            (sampled_distance(&present, &drawn), sampled_distance(&drawn, &present));
        let told = format!("level {} of eps {}, {leaves:?}", cluster.level, cluster.eps);
        prop_assert!(lost <= tolerance, "{lost} m were lost at {time:?}, {told}");
        prop_assert!(invented <= tolerance, "{invented} m were invented at {time:?}, {told}");

        let mut asked = 0;
        for layer in &cluster.layers {
            layer.present(&scene.behaviours, time, |from, to| asked += (to - from) as usize / 3);
        }
        prop_assert_eq!(asked, drawn.len(), "the order of the runs");
    }
    Ok(())
}

/// H5 to H7, R2, R7 for every cluster, leaf by leaf and second by second.
fn check_definitions(hdlod: &Hdlod, scene: &Scene) -> Result<(), TestCaseError> {
    for cluster in &hdlod.clusters {
        let children = hdlod.children_of(cluster);
        prop_assert!((1..=grouping::MAX_DEGREE).contains(&children.len()));
        let mut leaves = Vec::new();
        for &child in children {
            leaves_below(hdlod, child, &mut leaves);
            if let Node::Cluster(i) = child {
                let child = &hdlod.clusters[i as usize];
                prop_assert!(child.eps <= cluster.eps && child.gamma <= cluster.gamma);
                prop_assert_eq!(cluster.bounds.union(&child.bounds), cluster.bounds);
            }
        }
        prop_assert_eq!(leaves.len(), cluster.leaves as usize);
        let diameter =
            |id: &ElementId| f64::from(scene.model.elements[id.index()].bounds.diameter());
        let weight: f64 = leaves.iter().map(diameter).sum();
        prop_assert!((weight - cluster.weight).abs() <= 1e-6 * weight.max(1.0));
        for second in 0..END {
            let time = Time::from_seconds(second);
            let there = leaves.iter().filter(|id| scene.behaviour(**id).at(time));
            let count = there.clone().count();
            let share = there.map(diameter).sum::<f64>() / weight;
            let Share { lo: f, hi } = cluster.presence.at(time);
            prop_assert_eq!(f, hi, "so few behaviours are known exactly");
            prop_assert!((f64::from(f) - share).abs() < 1e-5);
            prop_assert_eq!(f == 0.0, count == 0);
            prop_assert_eq!(f == 1.0, count == leaves.len());
        }
        for id in &leaves {
            // gamma_c >= D_F(f_c, f_leaf), the integral taken second by second.
            let steps: f64 = (0..END)
                .map(|s| {
                    let t = Time::from_seconds(s);
                    let leaf = if scene.behaviour(*id).at(t) { 1.0 } else { 0.0 };
                    (f64::from(cluster.presence.at(t).lo) - leaf).abs()
                })
                .sum();
            prop_assert!(cluster.gamma + 1e-5 >= steps / END as f64);
            let bounds = scene.model.elements[id.index()].bounds;
            prop_assert_eq!(cluster.bounds.union(&bounds), cluster.bounds);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// R11 by brute force: at every date what a cluster draws and what is present below it are
    /// within its eps of each other, both ways.
    #[test]
    fn what_a_cluster_draws_is_within_eps_of_what_is_present(scene in scene(), time in 0..END) {
        check_promise(&built(&scene, Temporal::Tight), &scene, Time::from_seconds(time))?;
    }

    /// H5 to H7, R2, R7, R9 against the definitions, computed leaf by leaf.
    #[test]
    fn the_tree_obeys_its_definitions(scene in scene(), paper in any::<bool>()) {
        let hdlod = built(&scene, if paper { Temporal::Paper } else { Temporal::Tight });
        let present_ever: BTreeSet<ElementId> = (0..scene.model.elements.len() as u32)
            .map(ElementId)
            .filter(|id| *scene.behaviour(*id) != Behaviour::never())
            .collect();
        let mut all = Vec::new();
        if let Some(root) = hdlod.root {
            leaves_below(&hdlod, root, &mut all);
        }
        prop_assert_eq!(all.len(), present_ever.len(), "one root, every leaf once");
        prop_assert_eq!(all.into_iter().collect::<BTreeSet<_>>(), present_ever);
        check_definitions(&hdlod, &scene)?;
    }

    /// At tolerance 0 the selection is the set of present elements in the frame, each once.
    #[test]
    fn tolerance_zero_draws_every_present_leaf_and_no_absent_one(scene in scene(), time in 0..END, paper in any::<bool>()) {
        let hdlod = built(&scene, if paper { Temporal::Paper } else { Temporal::Tight });
        let mut view = View::fit(&scene.model.bounds(), 30.0, 20.0, 1.5, UVec2::new(640, 360));
        view.tolerance_px = 0.0;
        let time = Time::from_seconds(time);
        let selection = select(&scene, &hdlod, &view, time);
        prop_assert_eq!(selection.clusters, 0);
        let drawn: BTreeSet<ElementId> = selection.elements.iter().copied().collect();
        prop_assert_eq!(drawn.len(), selection.elements.len());
        let present: BTreeSet<ElementId> = (0..scene.model.elements.len() as u32)
            .map(ElementId)
            .filter(|id| scene.behaviour(*id).at(time))
            .collect();
        prop_assert_eq!(drawn, present);
    }

    /// Scrubbing equals jumping: nothing of an earlier date is left in a selection (H10).
    #[test]
    fn scrub_equals_jump(scene in scene(), times in proptest::collection::vec(0..END, 1..8)) {
        let hdlod = built(&scene, Temporal::Tight);
        let view = View::fit(&scene.model.bounds(), 30.0, 20.0, 4.0, UVec2::new(640, 360));
        let at = |s: &i64| select(&scene, &hdlod, &view, Time::from_seconds(*s));
        let scrubbed: Vec<_> = times.iter().map(at).collect();
        for (second, before) in times.iter().zip(&scrubbed).rev() {
            prop_assert_eq!(&at(second), before);
        }
    }

    /// H8 with R2: delta from the definition, all branches.
    #[test]
    fn delta_follows_its_four_branches(scene in scene(), time in 0..END) {
        let hdlod = built(&scene, Temporal::Paper);
        for cluster in &hdlod.clusters {
            let share = cluster.presence.at(Time::from_seconds(time));
            let f = share.lo;
            let expected = if f == 0.0 {
                0.0
            } else if f == 1.0 {
                f64::from(cluster.eps)
            } else if f >= 0.5 {
                f64::from(cluster.eps) + f64::from(1.0 - f) * cluster.weight
            } else {
                f64::from(cluster.eps) + f64::from(f) * cluster.weight
            };
            let delta = f64::from(delta_m(cluster, share));
            prop_assert!((delta - expected).abs() <= 1e-4 * expected.max(1.0));
        }
    }
}

#[test]
fn a_far_view_of_many_equal_boxes_draws_a_small_part_of_them_and_only_what_is_there() {
    let parts: Vec<Part> = (0..4000)
        .map(|i| Part {
            center: Vec3::new((i % 20) as f32, (i / 400) as f32 * 3.0, (i / 20 % 20) as f32),
            size: Vec3::new(0.9, 0.2, 0.9),
            turn: 0.0,
            mesh: 0,
            behaviour: i / 400,
        })
        .collect();
    // Ten storeys, one after the other.
    let behaviours: Vec<Behaviour> = (0..10)
        .map(|s| Behaviour::new(false, vec![Time::from_seconds(5 + s * 10)]).unwrap())
        .collect();
    let scene = scene_of(&parts, &behaviours);
    let hdlod = built(&scene, Temporal::Tight);
    let view = View::fit(&scene.model.bounds(), 30.0, 20.0, 8.0, UVec2::new(640, 360));
    for (second, storeys) in [(0, 0), (5, 1), (52, 5), (99, 10)] {
        let selection = select(&scene, &hdlod, &view, Time::from_seconds(second));
        let full = storeys * 400 * 12;
        assert!(selection.triangles * 5 <= full as u64, "{second}: {}", selection.triangles);
        assert_eq!(selection.triangles == 0, storeys == 0);
        assert!(selection.worst_px <= view.tolerance_px);
        // The highest thing drawn is the highest storey present.
        let top = selection
            .spans
            .iter()
            .flat_map(|s| {
                let range = s.first_index as usize..(s.first_index + s.index_count) as usize;
                hdlod.indices.range(range).map(|i| (s.base_vertex + i) as usize)
            })
            .map(|i| hdlod.vertices[i].position[1])
            .fold(f32::NEG_INFINITY, f32::max);
        if storeys > 0 {
            let expected = (storeys - 1) as f32 * 3.0;
            assert!((top - expected).abs() < 1.0, "{second}: {top} for {expected}");
        }
    }
}

#[test]
fn a_cancelled_build_stops_and_an_empty_scene_has_no_root() {
    let progress = Progress::default();
    progress.cancel();
    let scene = Scene::default();
    assert!(build(&scene, &Settings::default(), &progress).is_err());
    let hdlod = built(&scene, Temporal::Tight);
    assert!(hdlod.root.is_none());
    let view = View::fit(&Aabb::EMPTY, 30.0, 20.0, 1.0, UVec2::new(64, 64));
    assert_eq!(select(&scene, &hdlod, &view, Time::default()), Selection::default());
}

#[test]
fn the_same_tree_for_any_number_of_threads() {
    let parts: Vec<Part> = (0..600)
        .map(|i| Part {
            center: Vec3::new((i * 7 % 40) as f32, (i * 13 % 11) as f32, (i * 29 % 37) as f32),
            size: Vec3::new(0.3 + (i % 5) as f32, 0.2, 1.0),
            turn: i as f32,
            mesh: i % 3,
            behaviour: i as usize % 2,
        })
        .collect();
    let behaviours =
        [Behaviour::always(), Behaviour::new(false, vec![Time::from_seconds(30)]).unwrap()];
    let scene = scene_of(&parts, &behaviours);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| built(&scene, Temporal::Tight))
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one.indices, three.indices);
    assert_eq!(one.vertices, three.vertices);
    assert_eq!(one.children, three.children);
}
