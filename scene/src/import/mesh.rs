//! One glTF mesh becomes one [`Mesh`]: its primitives merged, every topology made triangles.

use super::accessor::{Attribute, Kind};
use super::document::{Checked, Primitive, Semantic, attribute};
use super::fault::Fault;
use super::palette::{Palette, quantize};
use super::source::Source;
use crate::{Aabb, Mesh, Vertex, encode_normal};
use glam::{DVec3, Vec3};
use topout_schedule::{Diagnostics, Severity};

/// Meshes centred further away than this (metres) are moved to their own centre, so that what an
/// f32 can hold goes into their shape and not into their place.
pub(super) const LARGE: f64 = 10_000.0;

/// A mesh and what was found while reading it.
pub(super) struct Read {
    /// Positions are relative to `offset`.
    pub mesh: Mesh,
    /// Position of the mesh's zero in the file's mesh space.
    pub offset: DVec3,
    /// What was left out or is odd.
    pub diagnostics: Diagnostics,
}

/// Names the file and the node for messages.
pub(super) struct Place<'a> {
    /// The file's name.
    pub file: &'a str,
    /// A node that uses the mesh.
    pub node: &'a str,
    /// Index of the mesh.
    pub mesh: usize,
}

/// A primitive whose accessors were opened and whose vertex numbers were checked.
struct Part<'a> {
    material: Option<usize>,
    positions: Attribute<'a>,
    normals: Option<Attribute<'a>>,
    colors: Option<Attribute<'a>>,
    corners: Vec<u32>,
    bounds: Aabb,
}

/// Reads a mesh; primitives with faults are left out and reported.
pub(super) fn read(source: &Source<'_>, palette: &Palette, place: &Place<'_>) -> Read {
    let mut diagnostics = Diagnostics::default();
    let mut parts = Vec::new();
    for (i, primitive) in source.document.meshes[place.mesh].primitives.iter().enumerate() {
        let name = format!("meshes[{}].primitives[{i}]", place.mesh);
        match open(source, primitive, &name, place, &mut diagnostics) {
            Ok(Some(part)) => parts.push(part),
            Ok(None) => {}
            Err((code, fault)) => diagnostics.add(Severity::Error, code, name.clone(), || {
                format!("{}: node {:?}: {name}: left out: {fault}", place.file, place.node)
            }),
        }
    }
    let bounds = parts.iter().fold(Aabb::EMPTY, |b, part| b.union(&part.bounds));
    let offset = offset_of(&bounds);
    let mesh = merge(&parts, palette, offset);
    Read { mesh, offset, diagnostics }
}

/// Where the mesh's zero is moved: nowhere, unless it lies far away.
fn offset_of(bounds: &Aabb) -> DVec3 {
    if bounds.is_empty() {
        return DVec3::ZERO;
    }
    let center = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) * 0.5;
    let far = |c: f64| if c.abs() > LARGE { c.round() } else { 0.0 };
    DVec3::new(far(center.x), far(center.y), far(center.z))
}

/// Corners of triangles that one file may have; far above any building, and what memory holds.
/// Meshes may share their bytes, so the file's size is no bound.
pub(super) const MOST_CORNERS: u64 = 1 << 28;

/// Checks how much geometry the meshes together will make, before any of it is made.
pub(super) fn check_total(source: &Source<'_>, meshes: &[usize]) -> Result<(), Fault> {
    let mut total = 0u64;
    for &mesh in meshes {
        let primitives = source.document.meshes[mesh].primitives.iter();
        total += primitives.map(|p| corner_count(source, p)).sum::<u64>();
        if total > MOST_CORNERS {
            return Err(Fault::new(
                format!("meshes[{mesh}]"),
                format!(
                    "brings the geometry to {total} corners of triangles, more than {MOST_CORNERS} \
                     are not read"
                ),
            ));
        }
    }
    Ok(())
}

/// Corners of a primitive's triangles; none where it is left out.
fn corner_count(source: &Source<'_>, primitive: &Primitive) -> u64 {
    let open = |index, kind| Attribute::open(source, index, kind, "").ok().map(|a| a.count as u64);
    let Checked::Valid(mode) = primitive.mode else { return 0 };
    let positions = attribute(primitive, Semantic::Positions).and_then(|p| open(p, Kind::Vec3));
    let count = match (positions, primitive.indices) {
        (None, _) => None,
        (count, None) => count,
        (_, Some(indices)) => open(indices.value(), Kind::Index),
    };
    match mode.as_gl_enum() {
        0..=3 => 0,
        4 => count.unwrap_or(0),
        _ => count.unwrap_or(0).saturating_sub(2) * 3,
    }
}

type Refusal = (&'static str, Fault);

fn open<'a>(
    source: &'a Source<'_>,
    primitive: &Primitive,
    name: &str,
    place: &Place<'_>,
    diagnostics: &mut Diagnostics,
) -> Result<Option<Part<'a>>, Refusal> {
    let bad = |fault: Fault| ("bad-primitive", fault);
    let Checked::Valid(mode) = primitive.mode else {
        let pointer = format!("/{}/mode", name.replace(['[', '.'], "/").replace(']', ""));
        let said = source.document.said(&pointer);
        return Err(bad(Fault::new(name, format!("mode {said} does not exist"))));
    };
    let mode = mode.as_gl_enum();
    let mut note = |severity, code, text: &str| {
        diagnostics.add(severity, code, name, || {
            format!("{}: node {:?}: {name}: {text}", place.file, place.node)
        });
    };
    if mode <= 3 {
        note(Severity::Info, "points-or-lines", "points and lines are not drawn");
        return Ok(None);
    }
    if primitive.targets.as_ref().is_some_and(|t| !t.is_empty()) {
        note(Severity::Info, "morph-targets", "morph targets are ignored");
    }
    let Some(position) = attribute(primitive, Semantic::Positions) else {
        note(Severity::Warning, "no-position", "has no POSITION, so nothing is drawn");
        return Ok(None);
    };
    let positions = Attribute::open(source, position, Kind::Vec3, name).map_err(bad)?;
    let indices = match primitive.indices {
        Some(index) => {
            Some(Attribute::open(source, index.value(), Kind::Index, name).map_err(bad)?)
        }
        None => None,
    };
    if let Some(material) = primitive.material
        && material.value() >= source.document.materials.len()
    {
        Fault::entry(&source.document.materials, "materials", material.value(), name)
            .map_err(bad)?;
    }
    let mut optional = |semantic, kind, what: &str| {
        let index = attribute(primitive, semantic)?;
        match Attribute::open(source, index, kind, name) {
            Ok(attribute) if attribute.count == positions.count => Some(attribute),
            Ok(attribute) => {
                note(
                    Severity::Warning,
                    "bad-attribute",
                    &format!(
                        "{what} (accessors[{}]) has {} elements for {} positions and is ignored",
                        index, attribute.count, positions.count
                    ),
                );
                None
            }
            Err(fault) => {
                note(Severity::Warning, "bad-attribute", &format!("{what} is ignored: {fault}"));
                None
            }
        }
    };
    let normals = optional(Semantic::Normals, Kind::Vec3, "NORMAL");
    let colors = optional(Semantic::Colors(0), Kind::Color, "COLOR_0");
    let count = indices.as_ref().map_or(positions.count, |i| i.count);
    if (mode == 4 && count % 3 != 0) || (mode != 4 && count < 3) {
        note(
            Severity::Warning,
            "incomplete-triangle",
            &format!("{count} vertices do not make whole triangles; the rest is not drawn"),
        );
    }
    let corners = corners(mode, count, indices.as_ref(), positions.count, name).map_err(bad)?;
    let bounds = bounds_of(&positions, &corners, name)?;
    let material = primitive.material.map(|m| m.value());
    Ok(Some(Part { material, positions, normals, colors, corners, bounds }))
}

/// Vertex numbers, three a triangle, each below `vertices`.
fn corners(
    mode: u32,
    count: usize,
    indices: Option<&Attribute<'_>>,
    vertices: usize,
    name: &str,
) -> Result<Vec<u32>, Fault> {
    let at = |i: usize| -> Result<u32, Fault> {
        let Some(indices) = indices else {
            return Ok(i as u32);
        };
        let index = indices.index(i);
        if (index as usize) < vertices {
            Ok(index)
        } else {
            Err(Fault::new(
                name,
                format!(
                    "index {index} (accessors[{}], element {i}) is out of range, there are \
                     {vertices} vertices",
                    indices.accessor
                ),
            ))
        }
    };
    if mode == 4 {
        return (0..count / 3 * 3).map(at).collect();
    }
    let triangles = count.saturating_sub(2);
    let mut corners = Vec::with_capacity(triangles * 3);
    for i in 0..triangles {
        let three = match mode {
            5 => [i, i + 1 + i % 2, i + 2 - i % 2],
            _ => [i + 1, i + 2, 0],
        };
        for corner in three {
            corners.push(at(corner)?);
        }
    }
    Ok(corners)
}

/// The box of the used vertices; one that is not finite is a fault.
fn bounds_of(positions: &Attribute<'_>, corners: &[u32], name: &str) -> Result<Aabb, Refusal> {
    let mut bounds = Aabb::EMPTY;
    for &corner in corners {
        let p = Vec3::from(positions.floats::<3>(corner as usize));
        if !p.is_finite() {
            let message = format!(
                "position {} of vertex {corner} (accessors[{}]) is not finite",
                p, positions.accessor
            );
            return Err(("non-finite-position", Fault::new(name, message)));
        }
        bounds = Aabb { min: bounds.min.min(p), max: bounds.max.max(p) };
    }
    Ok(bounds)
}

fn merge(parts: &[Part<'_>], palette: &Palette, offset: DVec3) -> Mesh {
    let corners: usize = parts.iter().map(|p| p.corners.len()).sum();
    let mut vertices = VertexSet::with_capacity(corners);
    let mut opaque = Vec::with_capacity(corners);
    let mut transparent = Vec::new();
    for part in parts {
        let plain = palette.find(part.material, None);
        for triangle in part.corners.chunks_exact(3) {
            let raw = [0, 1, 2].map(|k| part.positions.floats::<3>(triangle[k] as usize));
            let points = if offset == DVec3::ZERO {
                raw
            } else {
                raw.map(|p| (Vec3::from(p).as_dvec3() - offset).as_vec3().to_array())
            };
            let mut flat = None;
            let mut blended = false;
            let mut numbers = [0u32; 3];
            for k in 0..3 {
                let corner = triangle[k] as usize;
                let given = part.normals.as_ref().map(|n| Vec3::from(n.floats::<3>(corner)));
                let normal = match given.filter(|n| n.is_finite() && *n != Vec3::ZERO) {
                    Some(normal) => encode_normal(normal),
                    None => *flat.get_or_insert_with(|| encode_normal(flat_normal(&points))),
                };
                let material = match &part.colors {
                    Some(colors) => {
                        palette.find(part.material, Some(quantize(colors.floats(corner))))
                    }
                    None => plain,
                };
                blended |= palette.materials[usize::from(material)].transparent;
                numbers[k] = vertices.insert(Vertex { position: points[k], normal, material });
            }
            let list = if blended { &mut transparent } else { &mut opaque };
            list.extend(numbers);
        }
    }
    let solid = opaque.len() as u32;
    opaque.append(&mut transparent);
    let bounds = Aabb::of_points(vertices.list.iter().map(|v| Vec3::from(v.position)));
    Mesh { vertices: vertices.list, indices: opaque, opaque: solid, bounds }
}

/// Unit normal of a triangle by its winding; zero for one without area.
fn flat_normal(points: &[[f32; 3]; 3]) -> Vec3 {
    let [a, b, c] = points.map(|p| Vec3::from(p).as_dvec3());
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

/// Vertices without duplicates, in order of first use.
struct VertexSet {
    list: Vec<Vertex>,
    /// Open addressing; place in `list` plus one, 0 where free.
    table: Vec<u32>,
}

impl VertexSet {
    fn with_capacity(corners: usize) -> Self {
        let table = vec![0; (corners * 2).next_power_of_two().max(8)];
        Self { list: Vec::new(), table }
    }

    fn insert(&mut self, vertex: Vertex) -> u32 {
        let [a, b]: [u64; 2] = bytemuck::cast(vertex);
        let mixed = (a ^ b.rotate_left(29)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let hash = mixed ^ b.wrapping_mul(0xC2B2_AE3D_27D4_EB4F);
        let mut slot = ((hash ^ hash >> 32) as usize) & (self.table.len() - 1);
        loop {
            match self.table[slot] {
                0 => {
                    self.list.push(vertex);
                    self.table[slot] = self.list.len() as u32;
                    return self.list.len() as u32 - 1;
                }
                known => {
                    let same = bytemuck::bytes_of(&self.list[known as usize - 1])
                        == bytemuck::bytes_of(&vertex);
                    if same {
                        return known - 1;
                    }
                }
            }
            slot = (slot + 1) & (self.table.len() - 1);
        }
    }
}
