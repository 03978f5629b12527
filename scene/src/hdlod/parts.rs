//! Connected parts of a soup, and the rectangle that may stand for a thin one.

use super::cover::distance_to_triangle;
use super::soup::Triangle;
use crate::encode_normal;
use glam::{Mat3, Vec3};
use std::collections::HashMap;

/// Midpoint subdivisions of the rectangle's halves when it is measured against the part.
const SUBDIVISIONS: u32 = 3;

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

/// Two triangles that stand for a part.
pub(crate) struct Flat {
    pub halves: [Triangle; 2],
    /// Upper bound of the distance between the rectangle and the part, both ways.
    pub distance_m: f32,
}

/// The middle rectangle of a part of more than two triangles, if it is at most `thickness_m`
/// thick and `height_m` high and rectangle and part are within `radius` of each other, both ways.
///
/// A rectangle is convex, so the part is within `radius` where its corners are; the other way
/// the rectangle is cut into pieces that each lie at one triangle.
pub(crate) fn flatten(
    part: &[Triangle],
    radius: f32,
    thickness_m: f32,
    height_m: f32,
) -> Option<Flat> {
    if !(3..=MOST_TRIANGLES).contains(&part.len()) {
        return None;
    }
    let largest = part.iter().max_by(|a, b| a.area().total_cmp(&b.area()))?;
    let [a, b, c] = largest.corners;
    let longest =
        [b - a, c - b, a - c].into_iter().max_by(|x, y| x.length().total_cmp(&y.length()))?;
    let (normal, along) = (largest.cross().try_normalize()?, longest.try_normalize()?);
    let world_from_part = Mat3::from_cols(along, normal.cross(along), normal);
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
    let height = size[(thin + 1) % 3].min(size[(thin + 2) % 3]);
    if size[thin] > thickness_m || height > height_m {
        return None;
    }
    let middle = (min + max) * 0.5;
    let (u, v) = ((thin + 1) % 3, (thin + 2) % 3);
    let at = |x: f32, y: f32| {
        let mut local = middle;
        local[u] = x;
        local[v] = y;
        world_from_part * local
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
    let halves = rectangle.map(|corners| Triangle { corners, normals: [packed; 3], ..*largest });
    halves.iter().all(|t| t.area() > 0.0).then_some(Flat { halves, distance_m: worst })
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
