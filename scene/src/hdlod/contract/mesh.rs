//! A mesh whose vertices are joined two by two, the cheapest first.

use super::super::soup::Triangle;
use super::quadric::Quadric;
use crate::{Cancelled, Progress};
use glam::{DVec3, IVec3, Vec3};
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap, HashSet};

/// Weight of the planes that stand on borders, against those of the faces: outlines are seen first.
const BORDER: f64 = 4.0;

/// Least cosine between a face's normals before and after a join.
const LEAST_TURN: f64 = 0.2;

/// Height of a face as a share of its longest edge below which a join is refused.
const SLIVER: f64 = 1e-4;

/// Vertices with more neighbours than this are not joined: a join looks at all of them.
const MOST_NEIGHBOURS: usize = 64;

/// Mode pairs: partners of a vertex besides its neighbours, and how many are looked at for them.
const MOST_PARTNERS: usize = 6;
const MOST_LOOKED_AT: usize = 64;

/// Joins between two questions whether to go on.
const CHECK_EVERY: usize = 256;

#[derive(Clone)]
struct Node {
    place: DVec3,
    quadric: Quadric,
    /// Faces at it; those that died are taken out with the next join.
    faces: Vec<u32>,
    /// Mode pairs: vertices it may be joined with though no edge leads there.
    partners: Vec<u32>,
    /// Counts joins: candidates of before are void.
    stamp: u32,
    dead: bool,
}

#[derive(Clone)]
pub(super) struct Mesh {
    /// Places are relative to it: quadrics of points far away lose their digits.
    origin: DVec3,
    nodes: Vec<Node>,
    faces: Vec<Option<[u32; 3]>>,
    live: usize,
}

/// A join that may be made. The cheapest is the greatest; equal ones by their vertices.
struct Candidate {
    error: f64,
    ends: [u32; 2],
    stamps: [u32; 2],
    place: DVec3,
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        other.error.total_cmp(&self.error).then(other.ends.cmp(&self.ends))
    }
}

impl Mesh {
    /// Welds equal corners. Faces without area and copies of others are left out: they are in the
    /// others' closure or are measured as what is missing.
    pub fn new(source: &[Triangle]) -> Self {
        let origin = source.first().map_or(Vec3::ZERO, |t| t.corners[0]).as_dvec3();
        let mut mesh = Self { origin, nodes: Vec::new(), faces: Vec::new(), live: 0 };
        let mut node_at = HashMap::with_capacity(source.len());
        let mut known = HashSet::with_capacity(source.len());
        for triangle in source {
            let face = triangle.corners.map(|corner| {
                // Adding zero makes -0 and 0 the same bits.
                let key = (corner + Vec3::ZERO).to_array().map(f32::to_bits);
                *node_at.entry(key).or_insert_with(|| mesh.add_node(corner.as_dvec3() - origin))
            });
            if mesh.cross(face).length() > 0.0 && known.insert(sorted(face)) {
                for node in face {
                    mesh.nodes[node as usize].faces.push(mesh.faces.len() as u32);
                }
                mesh.faces.push(Some(face));
            }
        }
        mesh.live = mesh.faces.len();
        mesh.add_quadrics();
        mesh
    }

    fn add_node(&mut self, place: DVec3) -> u32 {
        self.nodes.push(Node {
            place,
            quadric: Quadric::default(),
            faces: Vec::new(),
            partners: Vec::new(),
            stamp: 0,
            dead: false,
        });
        self.nodes.len() as u32 - 1
    }

    /// Each face's plane to its corners; on edges that are not between two faces a plane across.
    fn add_quadrics(&mut self) {
        let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(self.faces.len() * 3);
        for (i, face) in (0u32..).zip(&self.faces) {
            let Some(face) = *face else { continue };
            let cross = self.cross(face);
            let normal = cross.normalize_or_zero();
            let area = cross.length() * 0.5;
            for k in 0..3 {
                let node = &mut self.nodes[face[k] as usize];
                node.quadric = node.quadric + Quadric::plane(normal, node.place, area / 3.0);
                let (a, b) = (face[k], face[(k + 1) % 3]);
                edges.push(([a.min(b), a.max(b)], i));
            }
        }
        edges.sort_unstable();
        for same in edges.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() != 2) {
            let ([a, b], face) = same[0];
            let Some(face) = self.faces[face as usize] else { continue };
            let (p, q) = (self.nodes[a as usize].place, self.nodes[b as usize].place);
            let across = (q - p).cross(self.cross(face)).normalize_or_zero();
            let plane = Quadric::plane(across, p, p.distance_squared(q) * BORDER);
            for end in [a, b] {
                let node = &mut self.nodes[end as usize];
                node.quadric = node.quadric + plane;
            }
        }
    }

    /// Lets vertices nearer than `near_m` be joined though no edge is between them.
    pub fn add_partners(&mut self, near_m: f64) {
        if near_m <= 0.0 {
            return;
        }
        let cell_of = |p: DVec3| (p / near_m).floor().as_ivec3();
        let mut cells: HashMap<IVec3, Vec<u32>> = HashMap::new();
        for (i, node) in (0..).zip(&self.nodes).filter(|(_, n)| !n.faces.is_empty()) {
            cells.entry(cell_of(node.place)).or_default().push(i);
        }
        let mut pairs = Vec::new();
        for (i, node) in (0u32..).zip(&self.nodes).filter(|(_, n)| !n.faces.is_empty()) {
            let cell = cell_of(node.place);
            let around = (0..27).map(|k| cell + IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
            let others = around.filter_map(|c| cells.get(&c)).flatten().copied();
            let distance = |j: u32| self.nodes[j as usize].place.distance(node.place);
            let others = others.filter(|&j| j > i).take(MOST_LOOKED_AT);
            let mut near: Vec<(f64, u32)> =
                others.map(|j| (distance(j), j)).filter(|(d, _)| *d <= near_m).collect();
            near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            pairs.extend(near.into_iter().take(MOST_PARTNERS).map(|(_, j)| [i, j]));
        }
        for [a, b] in pairs {
            self.nodes[a as usize].partners.push(b);
            self.nodes[b as usize].partners.push(a);
        }
    }

    /// Joins vertices as long as the mean squared distance from the planes of what was joined stays
    /// below the square of `limit_m`. At least one face stays.
    pub fn contract(&mut self, limit_m: f64, progress: &Progress) -> Result<(), Cancelled> {
        let most = limit_m * limit_m;
        let mut heap = BinaryHeap::new();
        for node in 0..self.nodes.len() as u32 {
            for other in self.neighbours(node).into_iter().filter(|&other| other > node) {
                heap.extend(self.candidate(node, other, most));
            }
        }
        let mut steps = 0usize;
        while let Some(Candidate { ends: [kept, gone], stamps, place, .. }) = heap.pop() {
            steps += 1;
            if steps.is_multiple_of(CHECK_EVERY) {
                progress.check()?;
            }
            let now = [kept, gone].map(|end| self.nodes[end as usize].stamp);
            let there = [kept, gone].iter().all(|&end| !self.nodes[end as usize].dead);
            if !there || now != stamps || !self.may_join(kept, gone, place, most) {
                continue;
            }
            self.join(kept, gone, place);
            for other in self.neighbours(kept) {
                heap.extend(self.candidate(kept.min(other), kept.max(other), most));
            }
        }
        Ok(())
    }

    /// The vertices at edges and partners, in order.
    fn neighbours(&self, node: u32) -> Vec<u32> {
        let own = &self.nodes[node as usize];
        let at_faces = own.faces.iter().filter_map(|&f| self.faces[f as usize]).flatten();
        let mut all: Vec<u32> = at_faces.chain(own.partners.iter().copied()).collect();
        all.sort_unstable();
        all.dedup();
        all.retain(|&other| other != node && !self.nodes[other as usize].dead);
        all
    }

    /// The join of two vertices in the best place, if its error is small enough.
    fn candidate(&self, a: u32, b: u32, most: f64) -> Option<Candidate> {
        let (from, to) = (&self.nodes[a as usize], &self.nodes[b as usize]);
        let quadric = from.quadric + to.quadric;
        let middle = (from.place + to.place) * 0.5;
        let reach = from.place.distance(to.place) + most.sqrt();
        let best = quadric.best(middle).filter(|p| p.distance(middle) <= reach);
        let places = [Some(from.place), Some(to.place), Some(middle), best];
        let (error, place) = places
            .into_iter()
            .flatten()
            .map(|place| (quadric.error(place), place))
            .min_by(|x, y| x.0.total_cmp(&y.0))?;
        let stamps = [from.stamp, to.stamp];
        (error <= most).then_some(Candidate { error, ends: [a, b], stamps, place })
    }

    /// Whether no face turns over or loses its height, and one is left.
    fn may_join(&self, a: u32, b: u32, place: DVec3, small: f64) -> bool {
        if self.neighbours(a).len().max(self.neighbours(b).len()) > MOST_NEIGHBOURS {
            return false;
        }
        let mut dying = 0;
        for (end, other) in [(a, b), (b, a)] {
            let faces = &self.nodes[end as usize].faces;
            for face in faces.iter().filter_map(|&f| self.faces[f as usize]) {
                if face.contains(&other) {
                    dying += 1;
                    continue;
                }
                let corners =
                    face.map(|n| if n == end { place } else { self.nodes[n as usize].place });
                let (before, after) = (self.cross(face), cross(corners));
                let [p, q, r] = corners;
                let longest =
                    p.distance_squared(q).max(q.distance_squared(r)).max(r.distance_squared(p));
                if after.length() <= SLIVER * longest {
                    return false;
                }
                // What is smaller than the error is not seen to turn.
                let turned = before.dot(after) < LEAST_TURN * before.length() * after.length();
                if turned && after.length() > small {
                    return false;
                }
            }
        }
        // Those between both were counted at both.
        dying / 2 < self.live
    }

    fn join(&mut self, kept: u32, gone: u32, place: DVec3) {
        let old = &mut self.nodes[gone as usize];
        old.dead = true;
        let quadric = old.quadric;
        let moved = std::mem::take(&mut old.faces);
        let partners = std::mem::take(&mut old.partners);
        let mut faces = std::mem::take(&mut self.nodes[kept as usize].faces);
        for face in moved {
            let Some(corners) = &mut self.faces[face as usize] else { continue };
            if corners.contains(&kept) {
                self.faces[face as usize] = None;
                self.live -= 1;
                continue;
            }
            for corner in corners.iter_mut().filter(|c| **c == gone) {
                *corner = kept;
            }
            faces.push(face);
        }
        faces.retain(|&f| self.faces[f as usize].is_some());
        for &partner in &partners {
            let list = &mut self.nodes[partner as usize].partners;
            list.retain(|&p| p != gone && p != kept);
            if partner != kept {
                list.push(kept);
            }
        }
        let node = &mut self.nodes[kept as usize];
        node.partners.extend(partners);
        node.partners.retain(|&p| p != kept && p != gone);
        node.partners.sort_unstable();
        node.partners.dedup();
        node.quadric = node.quadric + quadric;
        node.place = place;
        node.faces = faces;
        node.stamp += 1;
        node.dead = node.faces.is_empty();
    }

    fn cross(&self, face: [u32; 3]) -> DVec3 {
        cross(face.map(|n| self.nodes[n as usize].place))
    }

    /// Corners of the faces, each face once, with the numbers of their vertices.
    pub fn triangles(&self) -> Vec<([u32; 3], [Vec3; 3])> {
        let mut known = HashSet::with_capacity(self.live);
        let faces = self.faces.iter().flatten().filter(|&&face| known.insert(sorted(face)));
        let place = |n: u32| (self.nodes[n as usize].place + self.origin).as_vec3();
        faces
            .map(|&face| (face, face.map(place)))
            .filter(|(_, [a, b, c])| (b - a).cross(c - a) != Vec3::ZERO)
            .collect()
    }
}

fn cross([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

fn sorted(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}
