//! From the file's world (f64) to local space: the origin, instances, boxes; and what is left out.

use super::document::Document;
use super::mesh::{LARGE, Read};
use super::nodes::{Hierarchy, Placement, node_name};
use crate::{Aabb, Instance, Mesh, MeshId, Model};
use glam::{Affine3A, DAffine3, DVec3, Vec3};
use rayon::prelude::*;
use topout_schedule::Severity;

/// Nothing that far (metres) from the middle of everything belongs to the same site.
const FAR: f64 = 1e7;

/// Boxes of meshes with up to this many vertices are taken from the vertices, of others (where an
/// instance is turned) from the corners of the mesh's box, which are a little larger.
const EXACT_VERTICES: usize = 4096;

/// A box in the file's world.
#[derive(Clone, Copy)]
struct WorldBox {
    min: DVec3,
    max: DVec3,
}

impl WorldBox {
    fn center(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }
}

/// Fills the model with meshes, elements, groups and instances.
pub(super) fn place(
    document: &Document,
    hierarchy: Hierarchy,
    used: &[usize],
    meshes: Vec<Read>,
    file: &str,
    model: &mut Model,
) {
    let Hierarchy { elements, groups, mut placements, mut properties } = hierarchy;
    let mut numbers = vec![usize::MAX; document.meshes.len()];
    for (number, &mesh) in used.iter().enumerate() {
        numbers[mesh] = number;
    }
    let (mut offsets, mut shapes) = (Vec::new(), Vec::new());
    for read in meshes {
        offsets.push(read.offset);
        shapes.push(read.mesh);
        model.diagnostics.append(read.diagnostics);
    }
    // From here on placements refer to shapes, and their transforms start at the shape's zero.
    for placement in &mut placements {
        placement.mesh = numbers[placement.mesh];
        let shift = DAffine3::from_translation(offsets[placement.mesh]);
        placement.world_from_mesh *= shift;
    }
    let mut first_node = vec![None; elements.len()];
    for placement in &placements {
        first_node[placement.element].get_or_insert(placement.node);
    }
    placements.retain(|p| !shapes[p.mesh].indices.is_empty());
    placements.sort_by_key(|p| p.element);
    let boxes = world_boxes(&placements, &shapes, elements.len());

    let middle = median(&boxes);
    model.origin = origin(middle);
    // An f32 may overflow where the f64 above did not.
    let mut drawable = vec![true; elements.len()];
    for placement in &placements {
        let instance = instance(placement, model.origin);
        let bounds = shapes[placement.mesh].bounds.transformed(&instance.world_from_mesh);
        let finite = instance.world_from_mesh.is_finite() && bounds.max.is_finite();
        drawable[placement.element] &= finite && bounds.min.is_finite();
    }
    let keep: Vec<bool> = boxes
        .iter()
        .enumerate()
        .map(|(e, world)| {
            let Some(node) = first_node[e] else { return false };
            let name = || node_name(document, node);
            match world {
                None => {
                    model.diagnostics.add(Severity::Info, "empty-element", name(), || {
                        format!("{file}: node {:?} has no triangles and is left out", name())
                    });
                    false
                }
                Some(world) if !drawable[e] || !reaches(world, middle) => {
                    model.diagnostics.add(Severity::Error, "far-element", name(), || {
                        format!(
                            "{file}: node {:?} lies from {} to {}, further than {FAR:e} m from the \
                             rest around {middle}; it is left out",
                            name(),
                            world.min,
                            world.max
                        )
                    });
                    false
                }
                Some(_) => true,
            }
        })
        .collect();

    properties.retain_elements(&keep);
    (model.groups, model.properties) = (groups, properties);
    placements.retain(|p| keep[p.element]);
    let shapes = drop_unused(shapes, &mut placements);
    model.instances = placements.iter().map(|p| instance(p, model.origin)).collect();
    let bounds: Vec<Aabb> =
        model.instances.par_iter().map(|i| instance_bounds(&shapes[i.mesh.index()], i)).collect();
    model.meshes = shapes;
    let mut at = 0;
    for (e, mut element) in elements.into_iter().enumerate() {
        let start = at;
        while at < placements.len() && placements[at].element == e {
            element.bounds = element.bounds.union(&bounds[at]);
            at += 1;
        }
        if at > start {
            element.instances = start as u32..at as u32;
            model.elements.push(element);
        }
    }
}

/// Boxes of the elements; `None` for those without triangles.
fn world_boxes(
    placements: &[Placement],
    shapes: &[Mesh],
    elements: usize,
) -> Vec<Option<WorldBox>> {
    let mut boxes: Vec<Option<WorldBox>> = vec![None; elements];
    for placement in placements {
        let target = &mut boxes[placement.element];
        for corner in shapes[placement.mesh].bounds.corners() {
            let p = placement.world_from_mesh.transform_point3(corner.as_dvec3());
            // Not a number must not vanish in the minimum.
            let p = if p.is_nan() { DVec3::INFINITY } else { p };
            let b = target.get_or_insert(WorldBox { min: p, max: p });
            *b = WorldBox { min: b.min.min(p), max: b.max.max(p) };
        }
    }
    boxes
}

fn reaches(world: &WorldBox, middle: DVec3) -> bool {
    let distance = (world.min - middle).abs().max((world.max - middle).abs());
    distance.cmple(DVec3::splat(FAR)).all()
}

/// The median of the elements' centres, each axis by itself: strays do not move it.
fn median(boxes: &[Option<WorldBox>]) -> DVec3 {
    let centers: Vec<DVec3> =
        boxes.iter().flatten().map(WorldBox::center).filter(|c| c.is_finite()).collect();
    let axis = |i: usize| {
        let mut values: Vec<f64> = centers.iter().map(|c| c[i]).collect();
        if values.is_empty() {
            return 0.0;
        }
        let half = values.len() / 2;
        *values.select_nth_unstable_by(half, f64::total_cmp).1
    };
    DVec3::new(axis(0), axis(1), axis(2))
}

/// Zero, but for the axes on which everything is so far away that an f32 would show it.
fn origin(middle: DVec3) -> DVec3 {
    let axis = |c: f64| if c.abs() > LARGE { c.round() } else { 0.0 };
    DVec3::new(axis(middle.x), axis(middle.y), axis(middle.z))
}

/// The placement in local space.
fn instance(placement: &Placement, origin: DVec3) -> Instance {
    let DAffine3 { matrix3: m, translation } = placement.world_from_mesh;
    let world_from_mesh = Affine3A::from_cols(
        m.x_axis.as_vec3().into(),
        m.y_axis.as_vec3().into(),
        m.z_axis.as_vec3().into(),
        (translation - origin).as_vec3().into(),
    );
    Instance { mesh: MeshId(placement.mesh as u32), world_from_mesh }
}

/// Meshes that only left-out elements used go too.
fn drop_unused(shapes: Vec<Mesh>, placements: &mut [Placement]) -> Vec<Mesh> {
    let mut numbers: Vec<Option<usize>> = vec![None; shapes.len()];
    for placement in placements.iter() {
        numbers[placement.mesh] = Some(0);
    }
    for (next, number) in numbers.iter_mut().flatten().enumerate() {
        *number = next;
    }
    for placement in placements {
        placement.mesh = numbers[placement.mesh].expect("just marked");
    }
    shapes.into_iter().zip(numbers).filter_map(|(s, n)| n.map(|_| s)).collect()
}

/// Box of an instance in local space.
pub(super) fn instance_bounds(mesh: &Mesh, instance: &Instance) -> Aabb {
    let m = instance.world_from_mesh.matrix3;
    let straight = [m.x_axis, m.y_axis, m.z_axis]
        .iter()
        .all(|axis| axis.to_array().iter().filter(|&&c| c != 0.0).count() <= 1);
    if straight || mesh.vertices.len() > EXACT_VERTICES {
        return mesh.bounds.transformed(&instance.world_from_mesh);
    }
    Aabb::of_points(
        mesh.vertices
            .iter()
            .map(|v| instance.world_from_mesh.transform_point3(Vec3::from(v.position))),
    )
}
