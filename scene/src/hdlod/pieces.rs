//! Which kept triangles cover a source triangle: pieces of it that lie each at one of them (R10).

use super::cover::Item;
use crate::Aabb;
use glam::{IVec3, Vec3};

/// Midpoint subdivisions tried before a cover counts as not found.
pub(super) const SUBDIVISIONS: u32 = 3;

/// Cells of the triangle index along the longest side.
const INDEX_CELLS: f32 = 24.0;

/// The search for the covers of one item's sources.
pub(super) struct Query<'a> {
    pub items: &'a [Item],
    pub grid: &'a Grid,
    /// The unit that the sources belong to: it does not cover itself.
    pub own: u32,
    pub radius: f32,
    /// Who may cover.
    pub may: &'a dyn Fn(&Item) -> bool,
    /// Who covers a piece, each once.
    pub found: Vec<u32>,
    /// The largest distance that occurred.
    pub worst: f32,
}

impl Query<'_> {
    /// Covers a piece by one triangle or by covering its four parts.
    pub fn piece(&mut self, corners: [Vec3; 3], depth: u32) -> bool {
        let nearest = self.near(corners[0]);
        match nearest.whole(self, corners) {
            Some((i, distance)) => {
                self.worst = self.worst.max(distance);
                if !self.found.contains(&i) {
                    self.found.push(i);
                }
                true
            }
            None if depth == 0 || !nearest.any => false,
            None => {
                let [a, b, c] = corners;
                let (ab, bc, ca) = ((a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5);
                // The outer parts first: they hold the corners, where covers fail.
                self.piece([b, bc, ab], depth - 1)
                    && self.piece([c, ca, bc], depth - 1)
                    && self.piece([a, ab, ca], depth - 1)
                    && self.piece([ab, bc, ca], depth - 1)
            }
        }
    }

    /// Whether anything covers the middle. Most triangles that must stay fail here, at once:
    /// neighbours touch their corners but do not reach inside.
    pub fn reaches_middle(&self, [a, b, c]: [Vec3; 3]) -> bool {
        let middle = (a + b + c) / 3.0;
        self.grid.any(middle, self.radius, |i| self.covers(i, middle).is_some())
    }

    fn near(&self, point: Vec3) -> Near {
        let mut near = Near { candidates: [(0, 0.0); Near::KEPT], count: 0, any: false };
        self.grid.any(point, self.radius, |i| {
            if let Some(distance) = self.covers(i, point) {
                near.offer(i, distance, self.items[i as usize].locked);
            }
            false
        });
        near
    }

    /// The distance of a point to a triangle that may cover it.
    fn covers(&self, index: u32, point: Vec3) -> Option<f32> {
        let item = &self.items[index as usize];
        let gap = (item.bounds.min - point).max(point - item.bounds.max);
        if gap.max_element() > self.radius || item.dead || item.unit == self.own {
            return None;
        }
        let plane = item.normal.dot(point - item.triangle.corners[0]);
        if plane.abs() > self.radius {
            return None;
        }
        let distance = distance_to_triangle(point, item.triangle.corners);
        (distance <= self.radius && (self.may)(item)).then_some(distance)
    }
}

/// Triangles near a piece's first corner: locked ones first, then by area.
struct Near {
    candidates: [(u32, f32); Self::KEPT],
    count: usize,
    any: bool,
}

impl Near {
    const KEPT: usize = 24;

    fn offer(&mut self, index: u32, distance: f32, locked: bool) {
        self.any = true;
        if self.candidates[..self.count].iter().any(|c| c.0 == index) {
            return;
        }
        if locked {
            // Locked ones cost nothing more: to the front.
            if self.count < Self::KEPT {
                self.count += 1;
            }
            self.candidates[..self.count].rotate_right(1);
            self.candidates[0] = (index, distance);
        } else if self.count < Self::KEPT {
            self.candidates[self.count] = (index, distance);
            self.count += 1;
        }
    }

    /// The first candidate that has the other two corners within reach too.
    fn whole(&self, query: &Query, corners: [Vec3; 3]) -> Option<(u32, f32)> {
        self.candidates[..self.count].iter().find_map(|&(i, first)| {
            let item = &query.items[i as usize];
            let second = distance_to_triangle(corners[1], item.triangle.corners);
            if second > query.radius {
                return None;
            }
            let third = distance_to_triangle(corners[2], item.triangle.corners);
            (third <= query.radius).then_some((i, first.max(second).max(third)))
        })
    }
}

/// Triangles by the cells that their boxes touch.
#[derive(Default)]
pub(super) struct Grid {
    min: Vec3,
    cell: f32,
    counts: IVec3,
    cells: Vec<Vec<u32>>,
}

impl Grid {
    pub fn new(bounds: &Aabb, radius: f32) -> Self {
        let size = bounds.size();
        let cell = (2.0 * radius).max(size.max_element() / INDEX_CELLS).max(f32::MIN_POSITIVE);
        let counts = (size / cell).as_ivec3() + IVec3::ONE;
        let cells = vec![Vec::new(); counts.element_product() as usize];
        Self { min: bounds.min, cell, counts, cells }
    }

    fn range(&self, min: Vec3, max: Vec3) -> (IVec3, IVec3) {
        let last = self.counts - IVec3::ONE;
        let place =
            |p: Vec3| ((p - self.min) / self.cell).floor().as_ivec3().clamp(IVec3::ZERO, last);
        (place(min), place(max))
    }

    fn slot(&self, x: i32, y: i32, z: i32) -> usize {
        ((z * self.counts.y + y) * self.counts.x + x) as usize
    }

    pub fn insert(&mut self, index: u32, bounds: &Aabb) {
        let (from, to) = self.range(bounds.min, bounds.max);
        for z in from.z..=to.z {
            for y in from.y..=to.y {
                for x in from.x..=to.x {
                    let slot = self.slot(x, y, z);
                    self.cells[slot].push(index);
                }
            }
        }
    }

    /// Whether `test` holds for any triangle whose box may be within `radius`; stops at the first.
    fn any(&self, point: Vec3, radius: f32, mut test: impl FnMut(u32) -> bool) -> bool {
        let (from, to) = self.range(point - radius, point + radius);
        for z in from.z..=to.z {
            for y in from.y..=to.y {
                for x in from.x..=to.x {
                    if self.cells[self.slot(x, y, z)].iter().any(|&i| test(i)) {
                        return true;
                    }
                }
            }
        }
        false
    }
}

/// Distance from a point to some point of a triangle, the nearest but for rounding (Ericson,
/// "Real-Time Collision Detection", 5.1.5): what covers by it does cover. In f32 the point found in a
/// triangle of 6 m x 5 cm may lie millimetres from the nearest one; [`squared_distance`] is exact.
///
/// [`squared_distance`]: super::bvh::squared_distance
pub(super) fn distance_to_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ap.length();
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return bp.length();
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
        return (ap - ab * (d1 / (d1 - d3))).length();
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return cp.length();
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
        return (ap - ac * (d2 / (d2 - d6))).length();
    }
    let va = d3 * d6 - d5 * d4;
    let (e1, e2) = (d4 - d3, d5 - d6);
    if va <= 0.0 && e1 >= 0.0 && e2 >= 0.0 && e1 + e2 > 0.0 {
        return (bp - (c - b) * (e1 / (e1 + e2))).length();
    }
    let sum = va + vb + vc;
    if va < 0.0 || vb < 0.0 || vc < 0.0 || sum <= 0.0 {
        // Rounding would put the point outside: some point of an edge is an upper bound.
        return to_edge(ap, ab).min(to_edge(ap, ac)).min(to_edge(bp, c - b));
    }
    (ap - ab * (vb / sum) - ac * (vc / sum)).length()
}

/// Distance from a point to a segment that begins at the origin.
fn to_edge(point: Vec3, edge: Vec3) -> f32 {
    let squared = edge.length_squared();
    let along = if squared > 0.0 { (point.dot(edge) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (point - edge * along).length()
}
