//! Picking: which present element a ray meets first.

use crate::{Aabb, Clip, ElementId, Mesh, Scene, Solids};
use glam::{Affine3A, DVec3, Vec3};
use std::ops::RangeInclusive;
use std::sync::OnceLock;
use topout_schedule::Time;

/// Meshes with more triangles than this get a tree of their own when first met.
const SMALL_MESH: usize = 128;

/// Items in a leaf.
const LEAF: usize = 4;

/// Where a ray meets an element.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Hit {
    /// Which element.
    pub element: ElementId,
    /// Metres from the ray's origin.
    pub distance: f32,
    /// The point met, local space.
    pub point: Vec3,
    /// The surface's unit normal there, on the side that the ray comes from.
    pub normal: Vec3,
    /// The corners of the triangle met; where the cut of a solid is met, that point.
    pub corners: [Vec3; 3],
}

/// A tree over the elements' boxes. Belongs to the scene it was built for.
#[derive(Debug, Default)]
pub struct Picker {
    elements: Tree,
    /// A tree over the triangles of each large mesh, built when first met.
    meshes: Vec<OnceLock<Tree>>,
    solids: Solids,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy)]
struct Met {
    /// Lengths of the ray's direction.
    at: f64,
    /// Of the triangle, counter-clockwise, of any length.
    normal: DVec3,
    corners: [Vec3; 3],
    /// The instance that it belongs to.
    instance: usize,
}

impl Picker {
    /// Builds the tree over the elements; O(n log n).
    pub fn new(scene: &Scene) -> Self {
        let boxes: Vec<Aabb> = scene.model.elements.iter().map(|e| e.bounds).collect();
        let meshes = scene.model.meshes.iter().map(|_| OnceLock::new()).collect();
        Self { elements: Tree::new(&boxes), meshes, solids: Solids::new(&scene.model) }
    }

    /// The nearest element that is present at `time` on the ray from `origin` (local space) along
    /// `direction` (any length). Both sides of a triangle count, transparent ones too.
    pub fn pick(&self, scene: &Scene, origin: Vec3, direction: Vec3, time: Time) -> Option<Hit> {
        self.pick_among(scene, origin, direction, time, &Clip::NONE, |_| true)
    }

    /// [`Picker::pick`] of the elements that are `wanted`, as far as `clip` shows them. Where a solid is cut
    /// open, the cut is met.
    pub fn pick_among(
        &self,
        scene: &Scene,
        origin: Vec3,
        direction: Vec3,
        time: Time,
        clip: &Clip,
        wanted: impl Fn(ElementId) -> bool,
    ) -> Option<Hit> {
        let ray = Ray::new(origin, direction)?;
        let part = clip.part_of_ray(ray.origin, ray.direction)?;
        let mut best: Option<(Met, ElementId)> = None;
        let identity = Affine3A::IDENTITY;
        self.elements.visit(&ray, &identity, part.to, |e, limit: &mut f64| {
            let id = ElementId(e);
            if !scene.behaviour(id).at(time) || !wanted(id) {
                return;
            }
            for instance in scene.model.elements[id.index()].instances.clone() {
                if let Some(met) = self.instance(scene, instance as usize, &ray, part.from..=*limit)
                {
                    // Of two at the same distance the first element is met, in whatever order.
                    let nearer = |(known, other): (Met, _)| {
                        met.at < known.at || (met.at == known.at && id < other)
                    };
                    if best.is_none_or(nearer) {
                        best = Some((met, id));
                    }
                    *limit = met.at;
                }
            }
        });
        best.map(|(met, element)| {
            let leaves = met.normal.dot(ray.direction) > 0.0;
            let outward = || self.solids.faces_outward(&scene.model, met.instance);
            let point = |at: f64| (ray.origin + ray.direction * at).as_vec3();
            match part.through.filter(|_| outward() == Some(leaves)) {
                // From within a solid: the ray came in through the cut.
                Some(normal) => {
                    let (distance, point) = (part.from as f32, point(part.from));
                    Hit { element, distance, point, normal, corners: [point; 3] }
                }
                None => {
                    let normal = met.normal.as_vec3().normalize_or_zero();
                    let normal = if leaves { -normal } else { normal };
                    let (distance, point) = (met.at as f32, point(met.at));
                    Hit { element, distance, point, normal, corners: met.corners }
                }
            }
        })
    }

    /// The nearest triangle of an instance whose distance is in `within`.
    fn instance(
        &self,
        scene: &Scene,
        at: usize,
        ray: &Ray,
        within: RangeInclusive<f64>,
    ) -> Option<Met> {
        let instance = &scene.model.instances[at];
        let mesh = &scene.model.meshes[instance.mesh.index()];
        let transform = &instance.world_from_mesh;
        let (start, mut limit) = within.into_inner();
        let mut best = None;
        let mut test = |triangle: usize, limit: &mut f64| {
            let corners = corners(mesh, transform, triangle);
            if let Some(t) = ray.meets(&corners)
                && (start..=*limit).contains(&t)
            {
                *limit = t;
                let [a, b, c] = corners.map(|p| p.as_dvec3());
                let normal = (b - a).cross(c - a);
                best = Some(Met { at: t, normal, corners, instance: at });
            }
        };
        if mesh.triangle_count() <= SMALL_MESH {
            (0..mesh.triangle_count()).for_each(|t| test(t, &mut limit));
        } else {
            let tree = self.meshes[instance.mesh.index()].get_or_init(|| {
                let boxes: Vec<Aabb> = (0..mesh.triangle_count())
                    .map(|t| Aabb::of_points(corners(mesh, &Affine3A::IDENTITY, t)))
                    .collect();
                Tree::new(&boxes)
            });
            tree.visit(ray, transform, limit, |t, limit| test(t as usize, limit));
        }
        best
    }
}

/// The corners of a triangle after the transform.
fn corners(mesh: &Mesh, transform: &Affine3A, triangle: usize) -> [Vec3; 3] {
    [0, 1, 2].map(|k| {
        let vertex = &mesh.vertices[mesh.indices[triangle * 3 + k] as usize];
        transform.transform_point3(vertex.position.into())
    })
}

/// A half-line; `direction` is of unit length.
struct Ray {
    origin: DVec3,
    direction: DVec3,
}

impl Ray {
    fn new(origin: Vec3, direction: Vec3) -> Option<Self> {
        let direction = direction.as_dvec3().try_normalize()?;
        let origin = origin.as_dvec3();
        (origin.is_finite() && direction.is_finite()).then_some(Self { origin, direction })
    }

    /// Distance at which the ray enters a box (0 where it starts inside).
    fn enters(&self, bounds: &Aabb) -> Option<f64> {
        if bounds.is_empty() {
            return None;
        }
        // A transformed corner is rounded; the box must not lose its triangles by that.
        let size = bounds.min.abs().max(bounds.max.abs()).max_element();
        let bounds = bounds.grown(size * 1e-6);
        let (mut near, mut far) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            let (min, max) = (f64::from(bounds.min[axis]), f64::from(bounds.max[axis]));
            let (o, d) = (self.origin[axis], self.direction[axis]);
            if d == 0.0 {
                if o < min || o > max {
                    return None;
                }
                continue;
            }
            let (a, b) = ((min - o) / d, (max - o) / d);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        (near <= far).then_some(near)
    }

    /// Distance to a triangle, either side (Moeller and Trumbore).
    fn meets(&self, corners: &[Vec3; 3]) -> Option<f64> {
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let (ab, ac) = (b - a, c - a);
        let p = self.direction.cross(ac);
        let volume = ab.dot(p);
        if volume == 0.0 {
            return None;
        }
        let from_a = self.origin - a;
        let u = from_a.dot(p) / volume;
        let q = from_a.cross(ab);
        let v = self.direction.dot(q) / volume;
        let t = ac.dot(q) / volume;
        // Neighbouring triangles share an edge; a ray through it must not slip between them.
        const EDGE: f64 = -1e-9;
        (u >= EDGE && v >= EDGE && u + v <= 1.0 - EDGE && t >= 0.0 && t.is_finite()).then_some(t)
    }
}

/// A tree of boxes, halved at the median of the longest side; depth is log2 of the items.
#[derive(Debug, Default)]
struct Tree {
    nodes: Vec<Node>,
    items: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// Leaf: first item. Inner: the right child; the left one follows the node.
    at: u32,
    /// Number of items; 0 for an inner node.
    count: u32,
}

impl Tree {
    fn new(boxes: &[Aabb]) -> Self {
        let mut items: Vec<(Vec3, u32)> = boxes
            .iter()
            .enumerate()
            .filter(|(_, b)| !b.is_empty())
            .map(|(i, b)| (b.center(), i as u32))
            .collect();
        let nodes = if items.is_empty() { Vec::new() } else { split(boxes, &mut items, 0) };
        Self { nodes, items: items.into_iter().map(|i| i.1).collect() }
    }

    /// Calls `test` for the items whose box the ray enters before `limit`, nearer ones first by
    /// and large; `test` may lower the limit.
    fn visit(
        &self,
        ray: &Ray,
        transform: &Affine3A,
        mut limit: f64,
        mut test: impl FnMut(u32, &mut f64),
    ) {
        let identity = *transform == Affine3A::IDENTITY;
        let enters = |node: u32| {
            let bounds = self.nodes[node as usize].bounds;
            ray.enters(&if identity { bounds } else { bounds.transformed(transform) })
        };
        let mut stack: Vec<(f64, u32)> = Vec::with_capacity(64);
        if !self.nodes.is_empty() {
            stack.extend(enters(0).map(|t| (t, 0)));
        }
        while let Some((near, index)) = stack.pop() {
            if near > limit {
                continue;
            }
            let node = self.nodes[index as usize];
            if node.count > 0 {
                let items = node.at as usize..(node.at + node.count) as usize;
                self.items[items].iter().for_each(|&item| test(item, &mut limit));
                continue;
            }
            let (left, right) = (index + 1, node.at);
            match (enters(left), enters(right)) {
                (Some(a), Some(b)) if a <= b => stack.extend([(b, right), (a, left)]),
                (Some(a), Some(b)) => stack.extend([(a, left), (b, right)]),
                (Some(a), None) => stack.push((a, left)),
                (None, Some(b)) => stack.push((b, right)),
                (None, None) => {}
            }
        }
    }
}

/// Nodes over the items, in depth-first order; `first` is the place of the items' first one.
fn split(boxes: &[Aabb], items: &mut [(Vec3, u32)], first: u32) -> Vec<Node> {
    let bounds = items.iter().fold(Aabb::EMPTY, |b, i| b.union(&boxes[i.1 as usize]));
    let count = items.len();
    if count <= LEAF {
        return vec![Node { bounds, at: first, count: count as u32 }];
    }
    let size = Aabb::of_points(items.iter().map(|i| i.0)).size();
    let axis = size
        .to_array()
        .iter()
        .enumerate()
        .fold((0, 0.0), |best, (i, &s)| if s > best.1 { (i, s) } else { best });
    let half = count / 2;
    items.select_nth_unstable_by(half, |a, b| {
        a.0[axis.0].total_cmp(&b.0[axis.0]).then(a.1.cmp(&b.1))
    });
    let (low, high) = items.split_at_mut(half);
    let parallel = count > 10_000;
    let (left, right) = if parallel {
        rayon::join(|| split(boxes, low, first), || split(boxes, high, first + half as u32))
    } else {
        (split(boxes, low, first), split(boxes, high, first + half as u32))
    };
    let right_at = 1 + left.len() as u32;
    let mut nodes = Vec::with_capacity(1 + left.len() + right.len());
    nodes.push(Node { bounds, at: right_at, count: 0 });
    // A child's right child is counted from the child; here from this node.
    let shifted = |n: &Node, by: u32| if n.count > 0 { *n } else { Node { at: n.at + by, ..*n } };
    nodes.extend(left.iter().map(|n| shifted(n, 1)));
    nodes.extend(right.iter().map(|n| shifted(n, right_at)));
    nodes
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Element, Instance, MeshId, Model, Solidity, Vertex, link};
    use glam::Quat;
    use proptest::prelude::*;
    use topout_schedule::{Activity, Diagnostics, Schedule};

    /// A fan of triangles over pseudo-random points in a unit box.
    fn mesh(triangles: usize, seed: u32) -> Mesh {
        let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(1);
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let vertices: Vec<Vertex> = (0..triangles * 3)
            .map(|_| Vertex { position: [next(), next(), next()], normal: [0, 0], material: 0 })
            .collect();
        let bounds = Aabb::of_points(vertices.iter().map(|v| v.position.into()));
        let indices: Vec<u32> = (0..vertices.len() as u32).collect();
        Mesh { opaque: indices.len() as u32, vertices, indices, bounds }
    }

    /// Elements of one instance each; those with an odd number appear at second 10.
    fn scene(meshes: Vec<Mesh>, transforms: &[Affine3A]) -> Scene {
        let mut model = Model { meshes, ..Model::default() };
        for (i, &world_from_mesh) in transforms.iter().enumerate() {
            let instance =
                Instance { mesh: MeshId((i % model.meshes.len()) as u32), world_from_mesh };
            model.instances.push(instance);
            let mesh = &model.meshes[instance.mesh.index()];
            let points =
                mesh.vertices.iter().map(|v| world_from_mesh.transform_point3(v.position.into()));
            model.elements.push(Element {
                name: format!("e{i}"),
                instances: i as u32..i as u32 + 1,
                bounds: Aabb::of_points(points),
                ..Element::default()
            });
        }
        let odd = (0..transforms.len()).filter(|i| i % 2 == 1).map(|i| format!("e{i}")).collect();
        let activity = Activity {
            id: "a".into(),
            start: Some(Time::from_seconds(10)),
            end: Some(Time::from_seconds(20)),
            elements: odd,
            ..Activity::default()
        };
        let schedule = Schedule::new(String::new(), None, vec![activity], Diagnostics::default());
        link::link(model, schedule)
    }

    /// Every triangle of every present element, one after the other.
    fn linear(scene: &Scene, origin: Vec3, direction: Vec3, time: Time) -> Option<(f64, u32)> {
        let ray = Ray::new(origin, direction)?;
        let mut best: Option<(f64, u32)> = None;
        for (e, element) in scene.model.elements.iter().enumerate() {
            if !scene.behaviour(ElementId(e as u32)).at(time) {
                continue;
            }
            for instance in scene.model.instances_of(element) {
                let mesh = &scene.model.meshes[instance.mesh.index()];
                for t in 0..mesh.triangle_count() {
                    let distance = ray.meets(&corners(mesh, &instance.world_from_mesh, t));
                    if let Some(t) = distance
                        && best.is_none_or(|b| t < b.0)
                    {
                        best = Some((t, e as u32));
                    }
                }
            }
        }
        best
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn picking_finds_what_a_linear_scan_finds(
            seeds in prop::collection::vec(any::<u32>(), 1..4),
            places in prop::collection::vec(
                ((-5.0f32..5.0, -5.0f32..5.0, -5.0f32..5.0), (-2.0f32..2.0, 0.0f32..2.0, -1.0f32..1.0),
                 0.0f32..6.0), 0..40),
            rays in prop::collection::vec(
                ((-8.0f32..8.0, -8.0f32..8.0, -8.0f32..8.0), (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0)), 20),
            seconds in 0i64..20,
        ) {
            // Of the meshes one is small and one needs a tree of its own.
            let meshes: Vec<Mesh> =
                seeds.iter().enumerate().map(|(i, &s)| mesh([2, 300, 20][i % 3], s)).collect();
            let transforms: Vec<Affine3A> = places
                .iter()
                .map(|&(p, s, angle)| Affine3A::from_scale_rotation_translation(
                    s.into(), Quat::from_rotation_y(angle), p.into()))
                .collect();
            let scene = scene(meshes, &transforms);
            let picker = Picker::new(&scene);
            let time = Time::from_seconds(seconds);
            for (origin, direction) in rays {
                let (origin, direction) = (Vec3::from(origin), Vec3::from(direction));
                let hit = picker.pick(&scene, origin, direction, time);
                let expected = linear(&scene, origin, direction, time);
                prop_assert_eq!(hit.map(|h| (h.distance, h.element.0)), expected.map(|e| (e.0 as f32, e.1)));
                if let Some(hit) = hit {
                    let along = origin + direction.normalize() * hit.distance;
                    prop_assert!(along.distance(hit.point) < 1e-3);
                }
            }
        }
    }

    #[test]
    fn what_is_absent_is_looked_through_and_nothing_is_behind_the_eye() {
        let quad = || {
            let mut m = mesh(1, 1);
            for (v, p) in
                m.vertices.iter_mut().zip([[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [0.0, 9.0, 0.0]])
            {
                v.position = p;
            }
            m.bounds = Aabb::of_points(m.vertices.iter().map(|v| v.position.into()));
            m
        };
        let at = |z| Affine3A::from_translation(Vec3::new(0.0, 0.0, z));
        let scene = scene(vec![quad()], &[at(0.0), at(5.0), at(20.0)]);
        let picker = Picker::new(&scene);
        let eye = Vec3::new(0.0, 0.0, 10.0);
        let pick = |direction, seconds| {
            let hit = picker.pick(&scene, eye, direction, Time::from_seconds(seconds));
            hit.map(|h| (h.element.0, h.distance))
        };
        assert_eq!(pick(Vec3::NEG_Z, 9), Some((0, 10.0)));
        assert_eq!(pick(Vec3::NEG_Z, 10), Some((1, 5.0)));
        assert_eq!(pick(Vec3::Z * 7.0, 10), Some((2, 10.0)));
        assert_eq!(pick(Vec3::X, 10), None);
        assert_eq!(pick(Vec3::ZERO, 10), None);
        assert_eq!(pick(Vec3::NAN, 10), None);
    }

    /// A box of 2 m at 10 m, hollow as solids are, is cut in the middle: the cut is met, with its normal; beyond a
    /// section nothing is.
    #[test]
    fn what_is_cut_open_is_met_at_the_cut() {
        let corners = Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE }.corners();
        // By corner: bit 0 is x, bit 1 is y, bit 2 is z.
        let quads =
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [0, 2, 3, 1], [4, 5, 7, 6], [2, 6, 7, 3]];
        let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
        let vertices =
            corners.map(|c: Vec3| Vertex { position: c.into(), normal: [0, 127], material: 0 });
        let indices: Vec<u32> = triangles.flatten().collect();
        let bounds = Aabb::of_points(corners);
        let solid = Mesh { opaque: 36, vertices: vertices.into(), indices, bounds };
        assert_eq!(Solidity::of(&solid), Solidity::Outward);
        let mut torn = solid.clone();
        torn.indices.truncate(30);
        torn.opaque = 30;
        for (mesh, scale, met) in [(&solid, 1.0, 10.0), (&solid, -1.0, 10.0), (&torn, 1.0, 11.0)] {
            let scale = Vec3::new(1.0, 1.0, scale);
            let place = Affine3A::from_scale_rotation_translation(
                scale,
                Quat::from_rotation_y(std::f32::consts::FRAC_PI_2),
                Vec3::X * 10.0,
            );
            let scene = scene(vec![mesh.clone()], &[place]);
            let picker = Picker::new(&scene);
            let pick = |clip: &Clip| {
                let (at, time) = (Vec3::new(0.0, 0.1, 0.2), Time::from_seconds(0));
                picker.pick_among(&scene, at, Vec3::X, time, clip, |_| true)
            };
            let mut clip = Clip::NONE;
            assert_eq!(pick(&clip).map(|h| h.distance), Some(9.0));
            clip.cut(Vec3::X * 10.0, Vec3::NEG_X);
            let hit = pick(&clip).unwrap();
            assert!((hit.distance - met).abs() < 1e-4, "{hit:?}");
            assert_eq!(hit.normal.round(), Vec3::NEG_X);
            clip.cut(Vec3::X * 9.5, Vec3::X);
            assert_eq!(pick(&clip), None);
        }
    }

    #[test]
    fn an_empty_scene_has_nothing_to_pick() {
        let scene = Scene::default();
        let picker = Picker::new(&scene);
        assert_eq!(picker.pick(&scene, Vec3::ZERO, Vec3::X, Time::MIN), None);
    }

    #[test]
    fn many_elements_at_one_place_do_not_make_the_tree_deep() {
        let boxes = vec![Aabb { min: Vec3::ZERO, max: Vec3::ONE }; 100_000];
        let tree = Tree::new(&boxes);
        let mut items = tree.items.clone();
        items.sort_unstable();
        assert!(items.into_iter().eq(0..100_000));
        let mut met = 0;
        let ray = Ray::new(Vec3::splat(0.5), Vec3::X).unwrap();
        tree.visit(&ray, &Affine3A::IDENTITY, f64::INFINITY, |_, _| met += 1);
        assert_eq!(met, 100_000);
    }
}
