//! A tree of boxes over a triangle soup that knows when its triangles are there.
//!
//! One question is asked of it: which triangle that is present whenever X is present is nearest to
//! some points, by the farthest of them? For one point that is the nearest triangle; for the corners
//! of a piece of a triangle it bounds the distance of the whole piece, because the distance to a
//! convex set is convex.
//!
//! Distances are computed in f64 from f32 corners, so that rounding stays far below the coordinates'.

use super::presence::PresenceTable;
use super::soup::Triangle;
use crate::{Aabb, BehaviourId};
use glam::{DVec3, Vec3};
use topout_schedule::Time;

/// Triangles in a leaf.
const LEAF: usize = 4;

/// More than the depth of a tree over 2^32 triangles that is halved at every node.
const STACK: usize = 64;

/// A behaviour with the interval around its presence; whoever is there whenever it is must span
/// that interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    behaviour: BehaviourId,
    on: Time,
    off: Time,
}

impl Wanted {
    /// The question "who is there whenever `behaviour` is?".
    pub fn new(behaviour: BehaviourId, presence: &PresenceTable) -> Self {
        let (on, off) = presence.span(behaviour);
        Self { behaviour, on, off }
    }
}

/// A triangle with the interval around its presence.
#[derive(Clone, Copy)]
struct Item {
    corners: [Vec3; 3],
    behaviour: BehaviourId,
    on: Time,
    off: Time,
}

#[derive(Clone, Copy)]
struct Node {
    bounds: Aabb,
    /// Earliest `on` and latest `off` of the items below.
    on: Time,
    off: Time,
    /// Leaf: first item. Inner: the right child; the left one follows the node.
    at: u32,
    /// Number of items; 0 for an inner node.
    count: u32,
}

/// The tree. Building sorts the triangles; asking allocates nothing.
pub(crate) struct SoupTree<'a> {
    nodes: Vec<Node>,
    items: Vec<Item>,
    presence: &'a PresenceTable<'a>,
}

/// The nearest triangle: its place in the tree and the squared distance of the farthest point.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Nearest {
    /// Squared metres; infinite where no triangle is allowed.
    pub squared: f64,
    /// Place in the tree; `u32::MAX` where no triangle is allowed.
    pub item: u32,
}

impl Nearest {
    /// No triangle at all.
    pub const NONE: Self = Self { squared: f64::INFINITY, item: u32::MAX };
}

impl<'a> SoupTree<'a> {
    /// Sorts a soup into a tree; O(n log n).
    pub fn new(soup: &[Triangle], presence: &'a PresenceTable<'a>) -> Self {
        let items = soup.iter().map(|t| {
            let (on, off) = presence.span(t.behaviour);
            Item { corners: t.corners, behaviour: t.behaviour, on, off }
        });
        let mut items: Vec<Item> = items.collect();
        let mut nodes = Vec::with_capacity(items.len());
        if !items.is_empty() {
            split(&mut items, 0, &mut nodes);
        }
        Self { nodes, items, presence }
    }

    /// Of the triangles that are there whenever `wanted` is, the one for which the farthest of the
    /// points is nearest. The search starts from `known` and ends early once a triangle is within
    /// `enough` (squared metres).
    pub fn nearest<const N: usize>(
        &self,
        points: &[DVec3; N],
        wanted: Wanted,
        known: Nearest,
        enough: f64,
    ) -> Nearest {
        let mut best = known;
        if self.nodes.is_empty() || best.squared <= enough {
            return best;
        }
        let mut stack = [(0f64, 0u32); STACK];
        stack[0].0 = self.bound(0, points, wanted);
        let mut open = 1;
        while open > 0 {
            open -= 1;
            let (bound, index) = stack[open];
            if bound >= best.squared {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.count == 0 {
                let near = (self.bound(index + 1, points, wanted), index + 1);
                let far = (self.bound(node.at, points, wanted), node.at);
                let (near, far) = if near.0 <= far.0 { (near, far) } else { (far, near) };
                stack[open] = far;
                stack[open + 1] = near;
                open += 2;
                continue;
            }
            for place in node.at..node.at + node.count {
                let item = &self.items[place as usize];
                if !self.allowed(item, wanted) {
                    continue;
                }
                let squared = farthest(points, &item.corners, best.squared);
                if squared < best.squared {
                    best = Nearest { squared, item: place };
                    if squared <= enough {
                        return best;
                    }
                }
            }
        }
        best
    }

    /// The same question asked of one triangle, `item` of an earlier answer.
    pub fn to_item<const N: usize>(&self, points: &[DVec3; N], item: u32) -> Nearest {
        match self.items.get(item as usize) {
            Some(found) => {
                Nearest { squared: farthest(points, &found.corners, f64::INFINITY), item }
            }
            None => Nearest::NONE,
        }
    }

    fn allowed(&self, item: &Item, wanted: Wanted) -> bool {
        item.on <= wanted.on
            && item.off >= wanted.off
            && self.presence.includes(item.behaviour, wanted.behaviour)
    }

    /// No triangle below the node that is allowed has the farthest of the points nearer than this.
    fn bound<const N: usize>(&self, node: u32, points: &[DVec3; N], wanted: Wanted) -> f64 {
        let node = &self.nodes[node as usize];
        if node.on > wanted.on || node.off < wanted.off {
            return f64::INFINITY;
        }
        let (min, max) = (node.bounds.min.as_dvec3(), node.bounds.max.as_dvec3());
        points.iter().fold(0.0, |worst, &p| {
            worst.max((min - p).max(p - max).max(DVec3::ZERO).length_squared())
        })
    }
}

/// The largest squared distance of the points from a triangle; stops at the first beyond `limit`.
fn farthest<const N: usize>(points: &[DVec3; N], corners: &[Vec3; 3], limit: f64) -> f64 {
    let corners = corners.map(|c| c.as_dvec3());
    let mut worst = 0f64;
    for &point in points {
        worst = worst.max(squared_distance(point, corners));
        if worst >= limit {
            return worst;
        }
    }
    worst
}

/// Nodes over the items in depth-first order, halved at the median of the longest side.
fn split(items: &mut [Item], first: u32, nodes: &mut Vec<Node>) {
    let bounds = Aabb::of_points(items.iter().flat_map(|i| i.corners));
    let on = items.iter().map(|i| i.on).min().unwrap_or(Time::MAX);
    let off = items.iter().map(|i| i.off).max().unwrap_or(Time::MIN);
    let index = nodes.len();
    nodes.push(Node { bounds, on, off, at: first, count: items.len() as u32 });
    if items.len() <= LEAF {
        return;
    }
    let middle = |i: &Item| i.corners[0] + i.corners[1] + i.corners[2];
    let size = Aabb::of_points(items.iter().map(middle)).size();
    let axis = if size.x >= size.y.max(size.z) {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let half = items.len() / 2;
    items.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
    let (low, high) = items.split_at_mut(half);
    split(low, first, nodes);
    nodes[index].at = nodes.len() as u32;
    nodes[index].count = 0;
    split(high, first + half as u32, nodes);
}

/// Squared distance from a point to a triangle: to some point of the triangle in any case, also
/// where rounding picks the wrong one, so never too small by more than rounding.
///
/// By the region of the plane that the point projects to (Ericson, "Real-Time Collision
/// Detection", 5.1.5); a triangle without area is its edges.
pub(crate) fn squared_distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ap.length_squared();
    }
    // Corners are f32: what is thinner than this has no area at all.
    const FLAT: f64 = 1e-24;
    if ab.cross(ac).length_squared() <= FLAT * ab.length_squared() * ac.length_squared() {
        return to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a));
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return bp.length_squared();
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return to_segment(p, a, b);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return cp.length_squared();
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return to_segment(p, a, c);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return to_segment(p, b, c);
    }
    let sum = va + vb + vc;
    if va < 0.0 || vb < 0.0 || vc < 0.0 || sum <= 0.0 {
        return to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a));
    }
    (ap - ab * (vb / sum) - ac * (vc / sum)).length_squared()
}

fn to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let (ab, ap) = (b - a, p - a);
    let squared = ab.length_squared();
    let along = if squared > 0.0 { (ap.dot(ab) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (ap - ab * along).length_squared()
}

#[cfg(test)]
mod tests {
    use super::super::presence::PresenceTable;
    use super::*;
    use crate::Layer;
    use proptest::prelude::*;
    use topout_schedule::Behaviour;

    fn point() -> impl Strategy<Value = Vec3> {
        let coordinate = || prop_oneof![(-4i32..4).prop_map(|v| v as f32), -4f32..4.0];
        (coordinate(), coordinate(), coordinate()).prop_map(Vec3::from)
    }

    fn triangle() -> impl Strategy<Value = Triangle> {
        ([point(), point(), point()], 0u32..4).prop_map(|(corners, behaviour)| Triangle {
            corners,
            normals: [[0, 0]; 3],
            material: 0,
            layer: Layer::Opaque,
            behaviour: BehaviourId(behaviour),
        })
    }

    proptest! {
        /// Against the smallest distance to points all over the triangle, degenerate ones included.
        #[test]
        fn distance_to_a_triangle_is_that_of_its_nearest_point(t in triangle(), p in point()) {
            let [a, b, c] = t.corners.map(|c| c.as_dvec3());
            let p = p.as_dvec3();
            let found = squared_distance(p, [a, b, c]).sqrt();
            let mut sampled = f64::INFINITY;
            for i in 0..=60 {
                for j in 0..=60 - i {
                    let q = a + (b - a) * (f64::from(i) / 60.0) + (c - a) * (f64::from(j) / 60.0);
                    sampled = sampled.min(p.distance(q));
                }
            }
            let step = (b - a).length().max((c - a).length()) / 60.0;
            prop_assert!(found <= sampled + 1e-9 && found >= sampled - 2.0 * step, "{found} {sampled}");
        }

        /// The tree finds what a scan of all triangles finds.
        #[test]
        fn the_tree_finds_the_nearest_allowed_triangle(
            soup in proptest::collection::vec(triangle(), 0..60), piece in triangle(),
        ) {
            let step = |s| Behaviour::new(false, vec![Time::from_seconds(s)]).expect("one toggle");
            let behaviours = [step(5), step(9), Behaviour::always(),
                Behaviour::new(false, vec![Time::from_seconds(7), Time::from_seconds(8)]).expect("two")];
            let presence = PresenceTable::new(&behaviours, true);
            let tree = SoupTree::new(&soup, &presence);
            let points = piece.corners.map(|c| c.as_dvec3());
            let wanted = Wanted::new(piece.behaviour, &presence);
            let scan = soup
                .iter()
                .filter(|t| behaviours[t.behaviour.index()].includes(&behaviours[piece.behaviour.index()]))
                .map(|t| farthest(&points, &t.corners, f64::INFINITY))
                .fold(f64::INFINITY, f64::min);
            let found = tree.nearest(&points, wanted, Nearest::NONE, 0.0);
            prop_assert_eq!(found.squared, scan);
            prop_assert_eq!(tree.to_item(&points, found.item).squared, scan);
            let enough = tree.nearest(&points, wanted, Nearest::NONE, 4.0);
            prop_assert!(enough.squared >= scan && (enough.squared <= 4.0 || enough.squared == scan));
        }
    }
}
