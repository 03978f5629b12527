//! Triangles in a tree of boxes: the nearest one to a point, and those that a ray meets.
//!
//! Written apart from what the builder measures with, so that a mistake there is not made here too.
//! The depth is the same everywhere: a subtree of depth d takes 2^(d + 1) - 1 nodes.

use crate::{Aabb, Cancelled, Progress};
use glam::{DVec3, Vec3};

/// Most triangles in a leaf.
const LEAF: usize = 4;

/// Subtrees with more triangles are built on several threads.
const PARALLEL: usize = 30_000;

/// A triangle of a soup.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub corners: [Vec3; 3],
    /// Whose it is: an element or a cluster, as the caller likes.
    pub owner: u32,
    /// What decides whether it is there: an index into the flags of [`Tree::present`].
    pub tag: u32,
    /// Seen through.
    pub glass: bool,
}

#[derive(Clone, Copy)]
struct Node {
    min: Vec3,
    max: Vec3,
    /// Leaf: first item. Inner: the right child; the left one follows the node.
    at: u32,
    /// Number of items; 0 for an inner node.
    count: u32,
}

const BLANK: Node = Node { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY, at: 0, count: 0 };

/// All triangles that may be there.
pub(super) struct Tree {
    nodes: Vec<Node>,
    items: Vec<Item>,
}

impl Tree {
    /// Sorts triangles into a tree; O(n log n). Looks up now and then whether it was cancelled.
    pub fn new(mut items: Vec<Item>, progress: &Progress) -> Result<Self, Cancelled> {
        let mut depth = 0;
        while items.len().div_ceil(1 << depth) > LEAF {
            depth += 1;
        }
        let mut nodes = vec![BLANK; if items.is_empty() { 0 } else { (2 << depth) - 1 }];
        if !items.is_empty() {
            split(&mut items, 0, depth, &mut nodes, 0, progress);
        }
        progress.check()?;
        Ok(Self { nodes, items })
    }

    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// The triangles whose tag's flag is set.
    pub fn present<'a>(&'a self, tags: &'a [bool]) -> Present<'a> {
        let mut nodes = vec![false; self.nodes.len()];
        // Children stand behind their parent.
        for (i, node) in self.nodes.iter().enumerate().rev() {
            nodes[i] = if node.count > 0 {
                let range = node.at as usize..(node.at + node.count) as usize;
                self.items[range].iter().any(|item| tags[item.tag as usize])
            } else {
                nodes[i + 1] || nodes[node.at as usize]
            };
        }
        Present { tree: self, nodes, tags }
    }
}

/// Leaves off in the middle when cancelled.
fn split(
    items: &mut [Item],
    first: u32,
    depth: u32,
    nodes: &mut [Node],
    index: u32,
    progress: &Progress,
) {
    let parallel = items.len() > PARALLEL;
    if parallel && progress.check().is_err() {
        return;
    }
    let bounds = Aabb::of_points(items.iter().flat_map(|i| i.corners));
    nodes[0] = Node { min: bounds.min, max: bounds.max, at: first, count: items.len() as u32 };
    if depth == 0 {
        return;
    }
    let center = |i: &Item| i.corners[0] + i.corners[1] + i.corners[2];
    let size = Aabb::of_points(items.iter().map(center)).size().to_array();
    let axis = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
    let half = items.len() / 2;
    items.select_nth_unstable_by(half, |a, b| center(a)[axis].total_cmp(&center(b)[axis]));
    // Of 2^depth - 1 nodes each.
    let left_nodes = (1usize << depth) - 1;
    let right = index + 1 + left_nodes as u32;
    (nodes[0].at, nodes[0].count) = (right, 0);
    let (low, high) = items.split_at_mut(half);
    let (left, rest) = nodes[1..].split_at_mut(left_nodes);
    let mut build_left = || split(low, first, depth - 1, left, index + 1, progress);
    let mut build_right = || split(high, first + half as u32, depth - 1, rest, right, progress);
    if parallel {
        rayon::join(build_left, build_right);
    } else {
        build_left();
        build_right();
    }
}

/// Those triangles of a tree that are there.
pub(super) struct Present<'a> {
    tree: &'a Tree,
    nodes: Vec<bool>,
    tags: &'a [bool],
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    /// Multiples of the ray's direction.
    pub along: f64,
    pub owner: u32,
}

impl Present<'_> {
    /// The nearest point of all triangles; `None` where there is none.
    pub fn nearest(&self, point: DVec3) -> Option<DVec3> {
        self.search(point, -1.0).1
    }

    /// The distance of a point, if it is above `limit`; infinite where there are no triangles. Whoever
    /// looks for the farthest of many points need not know how near the others are.
    pub fn farther(&self, point: DVec3, limit: f64) -> Option<f64> {
        let distance = self.search(point, limit * limit).0.sqrt();
        (distance > limit).then_some(distance)
    }

    /// Squared distance and place of the nearest point, or of any whose squared distance is at most
    /// `enough`.
    fn search(&self, point: DVec3, enough: f64) -> (f64, Option<DVec3>) {
        let nodes = &self.tree.nodes;
        let mut best = (f64::INFINITY, None);
        let mut stack = [(0f64, 0u32); 80];
        let mut open = 0;
        if self.nodes.first() == Some(&true) {
            open = 1;
        }
        while open > 0 {
            open -= 1;
            let (bound, index) = stack[open];
            if bound >= best.0 {
                continue;
            }
            let node = &nodes[index as usize];
            if node.count == 0 {
                let mut children = [index + 1, node.at].map(|child| {
                    let n = &nodes[child as usize];
                    (gap_squared(point, n.min, n.max), child)
                });
                if children[0].0 < children[1].0 {
                    children.swap(0, 1);
                }
                for child in children {
                    if self.nodes[child.1 as usize] && child.0 < best.0 {
                        stack[open] = child;
                        open += 1;
                    }
                }
                continue;
            }
            for item in &self.tree.items[node.at as usize..(node.at + node.count) as usize] {
                if self.tags[item.tag as usize] {
                    let found = nearest_on(point, item.corners.map(|c| c.as_dvec3()));
                    let squared = point.distance_squared(found);
                    if squared < best.0 {
                        best = (squared, Some(found));
                    }
                }
            }
            if best.0 <= enough {
                break;
            }
        }
        best
    }

    /// What is seen along `origin + k * direction` for k from `start`: everything that is seen
    /// through, and the first thing that is not.
    pub fn seen(&self, origin: DVec3, direction: DVec3, start: f64, out: &mut Vec<Met>) {
        out.clear();
        let mut solid: Option<Met> = None;
        let mut stack = [(0f64, 0u32); 80];
        let mut open = 0;
        if self.nodes.first() == Some(&true) {
            stack[0].0 = start;
            open = 1;
        }
        let inverse = direction.recip();
        while open > 0 {
            open -= 1;
            let (enter, index) = stack[open];
            if solid.is_some_and(|s| enter > s.along) {
                continue;
            }
            let node = &self.tree.nodes[index as usize];
            if node.count == 0 {
                let mut children = [index + 1, node.at].map(|child| {
                    let n = &self.tree.nodes[child as usize];
                    (enters(origin, inverse, start, n.min, n.max), child)
                });
                if children[0].0 < children[1].0 {
                    children.swap(0, 1);
                }
                for child in children {
                    if child.0.is_finite() && self.nodes[child.1 as usize] {
                        stack[open] = child;
                        open += 1;
                    }
                }
                continue;
            }
            for item in &self.tree.items[node.at as usize..(node.at + node.count) as usize] {
                if !self.tags[item.tag as usize] {
                    continue;
                }
                let corners = item.corners.map(|c| c.as_dvec3());
                let Some(along) = meets(origin, direction, corners) else { continue };
                if along < start || solid.is_some_and(|s| along >= s.along) {
                    continue;
                }
                let met = Met { along, owner: item.owner };
                if item.glass {
                    out.push(met);
                } else {
                    solid = Some(met);
                }
            }
        }
        if let Some(solid) = solid {
            out.retain(|met| met.along < solid.along);
            out.push(solid);
        }
    }
}

/// Squared distance from a point to a box.
fn gap_squared(point: DVec3, min: Vec3, max: Vec3) -> f64 {
    (min.as_dvec3() - point).max(point - max.as_dvec3()).max(DVec3::ZERO).length_squared()
}

/// Where a ray enters a box; infinite where it passes by.
fn enters(origin: DVec3, inverse: DVec3, start: f64, min: Vec3, max: Vec3) -> f64 {
    let (mut near, mut far) = (start, f64::INFINITY);
    for axis in 0..3 {
        let (low, high) =
            (f64::from(min[axis]) - origin[axis], f64::from(max[axis]) - origin[axis]);
        if inverse[axis].is_infinite() {
            // The ray runs along this slab, inside or outside of it.
            if low > 0.0 || high < 0.0 {
                return f64::INFINITY;
            }
            continue;
        }
        let (low, high) = (low * inverse[axis], high * inverse[axis]);
        near = near.max(low.min(high));
        far = far.min(low.max(high));
    }
    // A flat box has no thickness for rounding to lie in.
    if near <= far + far.abs() * 1e-12 { near } else { f64::INFINITY }
}

/// Where a ray meets a triangle, from either side.
fn meets(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let normal = (b - a).cross(c - a);
    let slope = normal.dot(direction);
    if slope == 0.0 {
        return None;
    }
    let along = normal.dot(a - origin) / slope;
    let point = origin + direction * along;
    let side = |p: DVec3, q: DVec3| normal.dot((q - p).cross(point - p));
    // An edge that two triangles share must not let a ray through.
    let edge = -1e-9 * normal.length_squared();
    let inside = side(a, b) >= edge && side(b, c) >= edge && side(c, a) >= edge;
    (inside && along.is_finite()).then_some(along)
}

/// The point of a triangle that is nearest to `p`.
pub(super) fn nearest_on(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let squared = normal.length_squared();
    // Without area (corners are f32) there are only the edges.
    if squared > 1e-24 * (b - a).length_squared() * (c - a).length_squared() {
        let side = |from: DVec3, to: DVec3| normal.dot((to - from).cross(p - from));
        if side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0 {
            return p - normal * (normal.dot(p - a) / squared);
        }
    }
    let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| {
        let along = to - from;
        let length = along.length_squared();
        let share = if length > 0.0 { (along.dot(p - from) / length).clamp(0.0, 1.0) } else { 0.0 };
        from + along * share
    });
    edges.into_iter().fold(edges[0], |best, q| {
        if p.distance_squared(q) < p.distance_squared(best) { q } else { best }
    })
}
