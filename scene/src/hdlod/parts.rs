//! Connected parts of a soup, and the rectangle that may stand for a thin one.

use super::pieces::distance_to_triangle;
use super::soup::Triangle;
use crate::encode_normal;
use glam::{Mat3, Vec2, Vec3};
use std::collections::HashMap;

/// Midpoint subdivisions of the rectangle's halves when it is measured against the part.
const SUBDIVISIONS: u32 = 3;

/// Share of a rectangle that a part must fill for no opening to be closed by it.
const FILLED: f32 = 0.95;

/// Directions tried for the sides of the rectangle.
const MOST_EDGES: usize = 24;

/// Parts with more triangles than this are not simple enough for a rectangle to be likely.
const MOST_TRIANGLES: usize = 160;

/// Sorts triangles into parts: connected through equal corners, one behaviour, one material.
/// Parts in order of their first triangle.
pub(crate) fn connected(soup: &[Triangle]) -> Vec<Vec<u32>> {
    let mut parent: Vec<u32> = (0..soup.len() as u32).collect();
    let mut first_at = HashMap::with_capacity(soup.len());
    for (i, triangle) in soup.iter().enumerate() {
        for corner in triangle.corners {
            // Adding zero makes -0 and 0 the same bits.
            let place = (corner + Vec3::ZERO).to_array().map(f32::to_bits);
            let key = (place, triangle.behaviour, triangle.material, triangle.layer);
            let other = *first_at.entry(key).or_insert(i as u32);
            let (a, b) = (root(&mut parent, i as u32), root(&mut parent, other));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    let mut parts: Vec<Vec<u32>> = Vec::new();
    let mut part_of = vec![u32::MAX; soup.len()];
    for i in 0..soup.len() as u32 {
        // A root is the smallest of its part, so it comes first.
        let r = root(&mut parent, i) as usize;
        if part_of[r] == u32::MAX {
            part_of[r] = parts.len() as u32;
            parts.push(Vec::new());
        }
        parts[part_of[r] as usize].push(i);
    }
    parts
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

/// A triangle with its corners on a grid; itself where it is higher than `distinct_m`, `None` where no
/// area is left.
pub(crate) fn on_grid(original: &Triangle, cell: f32, distinct_m: f32) -> Option<Triangle> {
    if original.height() > distinct_m {
        return Some(*original);
    }
    // The grid is the same for all clusters, so neighbours meet where they met.
    let corners = original.corners.map(|c| ((c / cell).floor() + 0.5) * cell);
    let triangle = Triangle { corners, ..*original };
    // Corners on a grid: either the height is of the order of a cell or it is rounding.
    (triangle.height() > cell * 1e-2).then_some(triangle)
}

/// What may stand for a thin part.
pub(crate) enum Flat {
    /// A rectangle for all of it.
    Rectangle {
        /// The rectangle in two triangles.
        halves: [Triangle; 2],
        /// Upper bound of the distance between the rectangle and the part, both ways.
        distance_m: f32,
    },
    /// Its sheet: the triangles of one side, moved to the middle.
    Sheet {
        /// Places in the part, and the triangles moved.
        kept: Vec<(u32, Triangle)>,
        /// Places in the part of the other side and of the rims, still to be covered.
        rest: Vec<u32>,
        /// Largest movement of a corner.
        moved_m: f32,
    },
}

/// How thin and how large a part may be to become flat.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatLimits {
    /// Largest distance between the part and what stands for it.
    pub radius: f32,
    /// Largest thickness.
    pub thickness_m: f32,
    /// A part less wide than this cannot be told apart: its openings may close.
    pub small_m: f32,
}

/// The flat thing that may stand for a thin part of more than two triangles.
///
/// A rectangle is convex, so the part is within `radius` where its corners are; the other way
/// the rectangle is cut into pieces that each lie at one triangle. Where a large part has
/// openings its own triangles are kept instead: solids that stand one before the other keep their
/// order when each moves to its middle, but a rectangle would close a window's opening before it.
pub(crate) fn flatten(part: &[Triangle], limits: FlatLimits) -> Option<Flat> {
    if !(3..=MOST_TRIANGLES).contains(&part.len()) {
        return None;
    }
    let largest = part.iter().max_by(|a, b| a.area().total_cmp(&b.area()))?;
    let world_from_part = frame(part, largest.cross().try_normalize()?)?;
    let part_from_world = world_from_part.transpose();
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for corner in part.iter().flat_map(|t| t.corners) {
        let local = part_from_world * corner;
        (min, max) = (min.min(local), max.max(local));
    }
    let size = max - min;
    let thin = if size.z <= size.x.min(size.y) {
        2
    } else if size.y <= size.x {
        1
    } else {
        0
    };
    let (u, v) = ((thin + 1) % 3, (thin + 2) % 3);
    if size[thin] > limits.thickness_m {
        return None;
    }
    let small = size[u].min(size[v]) <= limits.small_m;
    let axis = world_from_part.col(thin);
    let (mut front, mut back) = (0f32, 0f32);
    for triangle in part {
        let across = triangle.cross().dot(axis) * 0.5;
        front += across.max(0.0);
        back -= across.min(0.0);
    }
    let filled = front.max(back) >= FILLED * size[u] * size[v];
    if small || filled {
        let rectangle = rectangle(part, largest, &world_from_part, (min, max), thin, limits.radius);
        if rectangle.is_some() {
            return rectangle;
        }
    }
    Some(sheet(part, axis, (min[thin] + max[thin]) * 0.5, front >= back))
}

/// The side of a part that has the larger area, moved to the middle.
fn sheet(part: &[Triangle], axis: Vec3, middle: f32, front: bool) -> Flat {
    let (mut kept, mut rest, mut moved_m) = (Vec::new(), Vec::new(), 0f32);
    for (place, triangle) in (0u32..).zip(part) {
        let across = triangle.cross().dot(axis);
        // Rims stand across the sheet: projected they would be slivers.
        if (across > 0.0) != front || across.abs() < 0.5 * triangle.cross().length() {
            rest.push(place);
            continue;
        }
        let mut flat = *triangle;
        for corner in &mut flat.corners {
            let way = middle - axis.dot(*corner);
            *corner += axis * way;
            moved_m = moved_m.max(way.abs());
        }
        kept.push((place, flat));
    }
    Flat::Sheet { kept, rest, moved_m }
}

/// The rectangle through the middle of a part, if both are within `radius` of each other.
fn rectangle(
    part: &[Triangle],
    like: &Triangle,
    world_from_part: &Mat3,
    (min, max): (Vec3, Vec3),
    thin: usize,
    radius: f32,
) -> Option<Flat> {
    let middle = (min + max) * 0.5;
    let (u, v) = ((thin + 1) % 3, (thin + 2) % 3);
    let at = |x: f32, y: f32| {
        let mut local = middle;
        local[u] = x;
        local[v] = y;
        *world_from_part * local
    };
    let corners = [at(min[u], min[v]), at(max[u], min[v]), at(max[u], max[v]), at(min[u], max[v])];
    let rectangle = [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]];

    let mut worst = 0f32;
    for corner in part.iter().flat_map(|t| t.corners) {
        let distance = rectangle
            .iter()
            .map(|t| distance_to_triangle(corner, *t))
            .fold(f32::INFINITY, f32::min);
        worst = worst.max(distance);
    }
    if worst > radius
        || !rectangle.iter().all(|t| at_part(part, *t, radius, SUBDIVISIONS, &mut worst))
    {
        return None;
    }
    // Two-sided shading turns the normal to the eye; which side it names does not matter.
    let packed = encode_normal((corners[1] - corners[0]).cross(corners[2] - corners[0]));
    let halves = rectangle.map(|corners| Triangle { corners, normals: [packed; 3], ..*like });
    halves.iter().all(|t| t.area() > 0.0).then_some(Flat::Rectangle { halves, distance_m: worst })
}

/// The axes of the box around a part that is smallest across `normal`: the third is `normal`, the
/// first lies along an edge of a triangle that faces it.
///
/// An edge between two triangles of one rectangle is its diagonal, so the longest edge alone says
/// nothing.
fn frame(part: &[Triangle], normal: Vec3) -> Option<Mat3> {
    let mut best: Option<(f32, Mat3)> = None;
    let mut tried = 0;
    for triangle in part {
        if triangle.cross().dot(normal).abs() < 0.99 * triangle.cross().length() {
            continue;
        }
        let [a, b, c] = triangle.corners;
        for edge in [b - a, c - b, a - c] {
            let flat = edge - normal * normal.dot(edge);
            let Some(along) = flat.try_normalize() else { continue };
            let across = normal.cross(along);
            if best.is_some_and(|(_, m)| {
                let turned = m.x_axis.dot(along).abs();
                !(0.0141..=0.9999).contains(&turned)
            }) {
                continue;
            }
            let (mut min, mut max) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
            for corner in part.iter().flat_map(|t| t.corners) {
                let at = Vec2::new(along.dot(corner), across.dot(corner));
                (min, max) = (min.min(at), max.max(at));
            }
            let area = (max - min).element_product();
            if best.is_none_or(|(smallest, _)| area < smallest) {
                best = Some((area, Mat3::from_cols(along, across, normal)));
            }
            tried += 1;
            if tried == MOST_EDGES {
                return best.map(|(_, m)| m);
            }
        }
    }
    best.map(|(_, m)| m)
}

/// Whether a piece of the rectangle is within `radius` of the part.
fn at_part(part: &[Triangle], piece: [Vec3; 3], radius: f32, depth: u32, worst: &mut f32) -> bool {
    let mut reachable = false;
    for triangle in part {
        let first = distance_to_triangle(piece[0], triangle.corners);
        if first > radius {
            continue;
        }
        reachable = true;
        let second = distance_to_triangle(piece[1], triangle.corners);
        let third = distance_to_triangle(piece[2], triangle.corners);
        let distance = first.max(second).max(third);
        if distance <= radius {
            *worst = worst.max(distance);
            return true;
        }
    }
    if !reachable || depth == 0 {
        return false;
    }
    let [a, b, c] = piece;
    let (ab, bc, ca) = ((a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5);
    [[b, bc, ab], [c, ca, bc], [a, ab, ca], [ab, bc, ca]]
        .into_iter()
        .all(|piece| at_part(part, piece, radius, depth - 1, worst))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BehaviourId, Layer};
    use glam::Quat;
    use proptest::prelude::*;

    fn triangle(corners: [Vec3; 3]) -> Triangle {
        Triangle {
            corners,
            normals: [[0; 2]; 3],
            material: 0,
            layer: Layer::Opaque,
            behaviour: BehaviourId(0),
        }
    }

    fn quad([a, b, c, d]: [Vec3; 4]) -> [Triangle; 2] {
        [triangle([a, b, c]), triangle([a, c, d])]
    }

    /// A box with outward faces around the origin.
    fn solid(size: Vec3) -> Vec<Triangle> {
        let h = size * 0.5;
        let mut faces = Vec::new();
        for axis in 0..3 {
            let at = |side: f32, u: f32, v: f32| {
                let mut p = Vec3::ZERO;
                p[axis] = side * h[axis];
                p[(axis + 1) % 3] = u * h[(axis + 1) % 3];
                p[(axis + 2) % 3] = v * h[(axis + 2) % 3];
                p
            };
            for s in [-1.0, 1.0] {
                faces.extend(quad([
                    at(s, -s, -1.0),
                    at(s, s, -1.0),
                    at(s, s, 1.0),
                    at(s, -s, 1.0),
                ]));
            }
        }
        faces
    }

    /// A wall of 6 x 3 x 0.2 m with an opening of 2 x 1.5 m in its middle; its rims are left out.
    fn wall_with_opening() -> Vec<Triangle> {
        let ring = |z: f32, flip: bool| -> Vec<Triangle> {
            let p = |x: f32, y: f32| Vec3::new(x, y, z);
            let strips = [
                [p(-3.0, -1.5), p(3.0, -1.5), p(1.0, -0.75), p(-1.0, -0.75)],
                [p(3.0, -1.5), p(3.0, 1.5), p(1.0, 0.75), p(1.0, -0.75)],
                [p(3.0, 1.5), p(-3.0, 1.5), p(-1.0, 0.75), p(1.0, 0.75)],
                [p(-3.0, 1.5), p(-3.0, -1.5), p(-1.0, -0.75), p(-1.0, 0.75)],
            ];
            let mut faces: Vec<Triangle> = strips.into_iter().flat_map(quad).collect();
            if flip {
                faces.iter_mut().for_each(|t| t.corners.swap(0, 1));
            }
            faces
        };
        let mut wall = ring(0.1, false);
        wall.extend(ring(-0.1, true));
        wall
    }

    fn limits(radius: f32) -> FlatLimits {
        FlatLimits { radius, thickness_m: radius * 1.2, small_m: radius * 1.5 }
    }

    proptest! {
        /// The sides are found whichever way the diagonals run and the plate is turned.
        #[test]
        fn a_plate_becomes_the_rectangle_in_its_middle(
            long in 1f32..20.0, wide in 1f32..20.0, thin in 0.01f32..0.3,
            axis in (-1f32..1.0, -1f32..1.0, -1f32..1.0), angle in 0f32..6.3,
        ) {
            let turn = Quat::from_axis_angle(Vec3::from(axis).normalize_or(Vec3::Y), angle);
            let mut plate = solid(Vec3::new(long, thin, wide));
            for corner in plate.iter_mut().flat_map(|t| &mut t.corners) {
                *corner = turn * *corner;
            }
            let Some(Flat::Rectangle { halves, distance_m }) = flatten(&plate, limits(0.4)) else {
                panic!("no rectangle");
            };
            let area: f32 = halves.iter().map(Triangle::area).sum();
            prop_assert!((area / (long * wide) - 1.0).abs() < 1e-3, "{area} of {}", long * wide);
            prop_assert!((distance_m - thin * 0.5).abs() < 1e-3, "{distance_m} of {thin}");
            let normal = turn * Vec3::Y;
            for corner in halves.iter().flat_map(|t| t.corners) {
                prop_assert!(normal.dot(corner).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn an_opening_stays_open_until_it_cannot_be_told_apart() {
        let wall = wall_with_opening();
        let Some(Flat::Sheet { kept, rest, moved_m }) = flatten(&wall, limits(0.4)) else {
            panic!("no sheet");
        };
        let area: f32 = kept.iter().map(|(_, t)| t.area()).sum();
        assert!((area - (18.0 - 3.0)).abs() < 1e-3, "{area}");
        assert_eq!((kept.len(), rest.len()), (8, 8));
        assert!((moved_m - 0.1).abs() < 1e-5);
        assert!(kept.iter().flat_map(|(_, t)| t.corners).all(|c| c.z.abs() < 1e-5));
        assert!(matches!(flatten(&wall, limits(2.5)), Some(Flat::Rectangle { .. })));
    }

    #[test]
    fn thick_parts_and_parts_of_two_triangles_stay() {
        assert!(flatten(&solid(Vec3::new(5.0, 1.0, 5.0)), limits(0.4)).is_none());
        assert!(flatten(&solid(Vec3::ONE)[..2], limits(10.0)).is_none());
    }
}
