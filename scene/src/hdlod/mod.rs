//! HDLOD: a tree of clusters with geometry and behaviour over time (Semenov, Shutkin, Zolotov,
//! Morozov: "Extension of HLOD technique for dynamic scenes with deterministic events").
//!
//! | step | file | lines |
//! |---|---|---|
//! | thresholds per level | `ladder` | H12, R4, R5, R9 |
//! | who is merged | `hilbert`, `grouping` | H11, H14, H15 |
//! | merged geometry and its certificate | `soup`, `parts`, `cover`, `pieces`, `contract` | H5, H13, R10 |
//! | colours of what is merged | `palette`, `mixture` | H13 |
//! | how far soups are apart, proved | `certify`, `bvh` | R10, R11 |
//! | what may stand for what in time | `presence` | R11 |
//! | the loop over levels | `build` | H4, H6, H7, H11, R2, R9 |
//! | other dates for a tree | `restate`, `repair`, `renumber` | H6, H7, R11 |
//! | what the tree is like | `report`, `paint` | H13, H14 |
//! | what to draw | `select` | H8, H9, H10, R1, R5 to R8 |
//! | looks at a date | `marks` | |
//! | is all of this true? | `verify`, `audit` | H4 to H7, R2, R3, R7, R8, R10, R11 |
//!
//! What is promised, mode [`Temporal::Tight`]: at every date, every point that a cluster draws is
//! within its `eps` of some element below it that is present, and every point of those elements
//! is within `eps` of something that the cluster draws. Mode [`Temporal::Paper`]: the paper's
//! delta, a figure of merit and not a proof of a picture (R3).

pub mod audit;
#[doc(hidden)]
pub mod bench_support;
mod build;
mod bvh;
mod certify;
mod contract;
mod cover;
mod grouping;
mod hilbert;
mod indices;
mod ladder;
mod marks;
mod mixture;
mod paint;
mod palette;
mod parts;
mod pieces;
mod presence;
mod renumber;
mod repair;
mod report;
mod restate;
mod select;
mod soup;
#[cfg(test)]
pub(crate) mod tests;
mod validate;
pub mod verify;

pub use build::build;
pub use indices::Indices;
pub use marks::Marks;
pub use paint::color_by_level;
pub use palette::blends;
pub use report::LevelReport;
pub use restate::{OtherScene, Pair, Parents, Restated};
pub use select::{delta_m, draws_part, select, select_marked};
pub use soup::Run;

use crate::{Aabb, BehaviourId, ElementId, Layer, LookId, Vertex};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::Arc;
use topout_schedule::{BoundedStep, TimeRange};

/// Counts up whenever [`build`] gives another tree for the same scene and settings: trees that an
/// earlier version left in the cache are then built anew.
pub const ALGORITHM: u32 = 10;

/// Which promise a tree makes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub enum Temporal {
    /// Every triangle is drawn exactly while what it stands for is present (R11).
    #[default]
    Tight,
    /// The paper's delta (H8) and display (H9) with the reading R1.
    Paper,
}

/// How merged geometry is simplified (H13).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub enum Simplifier {
    /// Certified covers, with contraction for smooth meshes.
    #[default]
    Covers,
    /// Quadric contraction of edges alone, part by part. To compare.
    Edges,
    /// Quadric contraction of edges and of vertices near each other, within all that has one
    /// behaviour, material and layer. To compare.
    Pairs,
}

/// What a build depends on besides the scene.
#[derive(Clone, Copy, PartialEq, Debug, Default, Serialize)]
pub struct Settings {
    /// Which promise is made.
    pub temporal: Temporal,
    /// How merged geometry is simplified. A tree that was built with another one than covers is
    /// repaired with covers.
    pub simplifier: Simplifier,
}

/// A node of the tree.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Serialize, Deserialize)]
pub enum Node {
    /// An element, drawn exactly.
    Leaf(ElementId),
    /// An index into [`Hdlod::clusters`].
    Cluster(u32),
}

/// Most instants at which the presence of one cluster may change (R13). On the demo (mode paper, the
/// dates 1/3 and 2/3 and the three coverages) the cuts are the same with 32 as without a limit, with
/// 8 they draw up to 0.5 % more triangles; 64 would save a look at 0.3 % of the nodes.
pub const MAX_STEPS: usize = 32;

/// The tree. The geometry of all clusters lies in one vertex and one index table.
#[derive(Clone, PartialEq, Debug, Default, Serialize, Deserialize)]
pub struct Hdlod {
    /// The promise that it was built for.
    pub temporal: Temporal,
    // The cache keeps the two large tables apart from the rest.
    /// Vertices of all clusters, local space (metres from the model's origin). Trees that differ in
    /// dates alone share them.
    #[serde(skip)]
    pub vertices: Arc<Vec<Vertex>>,
    /// Indices of all clusters, three a triangle, relative to [`Cluster::base_vertex`].
    #[serde(skip)]
    pub indices: Indices,
    /// Inner nodes, children before parents.
    pub clusters: Vec<Cluster>,
    /// Children of all clusters, see [`Cluster::children`].
    pub children: Vec<Node>,
    /// The coarsest picture of everything; `None` where nothing is ever present.
    pub root: Option<Node>,
    /// How the build went, level by level.
    pub levels: Vec<LevelStats>,
    /// The behaviour of each element that the certificates were made for; that of the scene, until
    /// an edit ([`Hdlod::restate`]).
    pub built: Vec<BehaviourId>,
    /// T, over which gamma is a mean (H6).
    pub period: TimeRange,
    /// Elements outside the tree, drawn exactly: never present when it was built, but after an edit.
    pub loose: Vec<ElementId>,
}

/// One inner node: c = (g_c, f_c, b_c, w_c, eps_c, gamma_c) of H4.
///
/// Rule of selection ([`select`]): it is drawn in place of everything below it when
/// [`crate::View::error_px`] of its `eps` (or delta) and `bounds` is within the tolerance and it is
/// not `stale`.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Cluster {
    /// Its children, a range of [`Hdlod::children`].
    pub children: Range<u32>,
    /// b_c: encloses its geometry and everything below it (R7).
    pub bounds: Aabb,
    /// Upper bound in metres of the Hausdorff distance between what it draws and what it stands
    /// for; never below a child's (H5, R10). In mode tight it holds at every date (R11).
    pub eps: f32,
    /// Its eps at the dates of [`Hdlod::built`].
    pub(crate) built_eps: f32,
    /// The error that its [`Cluster::pairs`] alone prove, at the dates of any edit that they survive;
    /// at least `built_eps`.
    pub(crate) covered_eps: f32,
    /// Temporal error (H6): a chain, so it may exceed 1.
    pub gamma: f64,
    /// w_c in metres: the sum of the diameters of the elements below (R2).
    pub weight: f64,
    /// f_c: the weighted share of the elements below that is present (H7), with at most
    /// [`MAX_STEPS`] steps (R13).
    pub presence: BoundedStep,
    /// The pairs of different built behaviours (kept, covered) that its certificate rests on; sorted,
    /// empty in mode paper. See [`Hdlod::restate`].
    pub pairs: Box<[Pair]>,
    /// Mode tight: an edit of the schedule took its certificate, so it is never drawn and always
    /// descended into. `eps` stays: it is the certificate again when the edit is undone.
    pub stale: bool,
    /// The level that made it, from 1.
    pub level: u32,
    /// Number of elements below.
    pub leaves: u32,
    first_index: u32,
    base_vertex: u32,
    layers: [soup::LayerRuns; 2],
}

impl Cluster {
    /// Number of triangles over all behaviours.
    pub fn triangle_count(&self) -> usize {
        (self.layers[1].end() as usize) / 3
    }

    /// Its index ranges by behaviour: (layer, run, first index, one past the last) in
    /// [`Hdlod::indices`].
    pub fn runs(&self) -> impl Iterator<Item = (Layer, Run, Range<usize>)> + '_ {
        let layers = self.layers.iter().zip([Layer::Opaque, Layer::Transparent]);
        layers.flat_map(move |(layer, kind)| {
            let starts = std::iter::once(layer.start).chain(layer.runs.iter().map(|r| r.end));
            let base = self.first_index;
            layer.runs.iter().zip(starts).map(move |(run, start)| {
                (kind, *run, (base + start) as usize..(base + run.end) as usize)
            })
        })
    }

    /// Where its indices are in [`Hdlod::indices`]: after those of the clusters before it.
    pub fn indices(&self) -> Range<usize> {
        let first = self.first_index as usize;
        first..first + self.layers[1].end() as usize
    }

    /// Added to its indices; a place in [`Hdlod::vertices`].
    pub fn base_vertex(&self) -> u32 {
        self.base_vertex
    }
}

/// What one level of the build did.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
pub struct LevelStats {
    /// From 1.
    pub level: u32,
    /// eps(l) in metres.
    pub eps_m: f32,
    /// gamma(l); binding in mode paper alone.
    pub gamma_limit: f64,
    /// Clusters made.
    pub clusters: usize,
    /// Nodes active after it.
    pub active: usize,
    /// Triangles that the active nodes draw together.
    pub triangles: usize,
}

/// The tree in figures.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Stats {
    /// Inner nodes.
    pub clusters: usize,
    /// Longest way from the root to a leaf, in nodes.
    pub depth: usize,
    /// Most children of a cluster.
    pub max_degree: usize,
    /// Triangles of all clusters.
    pub triangles: usize,
    /// Triangles of the root over all behaviours.
    pub root_triangles: usize,
    /// Bytes of vertices and indices.
    pub geometry_bytes: usize,
    /// Bytes of the clusters' behaviours and runs.
    pub behaviour_bytes: usize,
}

impl Hdlod {
    /// The children of a cluster.
    pub fn children_of(&self, cluster: &Cluster) -> &[Node] {
        &self.children[cluster.children.start as usize..cluster.children.end as usize]
    }

    /// Counts the tree.
    pub fn stats(&self) -> Stats {
        let mut depths: Vec<usize> = Vec::with_capacity(self.clusters.len());
        let mut stats = Stats { clusters: self.clusters.len(), depth: 1, ..Stats::default() };
        for cluster in &self.clusters {
            let below = self.children_of(cluster).iter().map(|node| match node {
                Node::Leaf(_) => 1,
                Node::Cluster(i) => depths[*i as usize],
            });
            let depth = 1 + below.max().unwrap_or(0);
            depths.push(depth);
            stats.depth = stats.depth.max(depth);
            stats.max_degree = stats.max_degree.max(cluster.children.len());
            let runs: usize = cluster.layers.iter().map(|l| l.runs.len()).sum();
            stats.behaviour_bytes += runs * size_of::<Run>() + cluster.presence.heap_bytes();
        }
        stats.triangles = self.indices.len() / 3;
        if let Some(Node::Cluster(root)) = self.root {
            stats.root_triangles = self.clusters[root as usize].triangle_count();
        }
        stats.geometry_bytes =
            std::mem::size_of_val(&self.vertices[..]) + self.indices.len() * self.indices.width();
        stats
    }
}

/// An index range to draw.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Span {
    /// First index in [`Hdlod::indices`].
    pub first_index: u32,
    /// Number of indices.
    pub index_count: u32,
    /// Added to every index; a place in [`Hdlod::vertices`].
    pub base_vertex: u32,
    /// Which pass draws it, unless its look is see-through.
    pub layer: Layer,
    /// How it looks.
    pub look: LookId,
}

/// A cluster of a cut.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Drawn {
    /// Its place in [`Hdlod::clusters`].
    pub cluster: u32,
    /// What it draws, a range of [`Selection::spans`]: nothing, where all that it could is absent.
    pub spans: Range<usize>,
}

/// What to draw: a value, the result of [`select`].
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Selection {
    /// Elements to draw exactly.
    pub elements: Vec<ElementId>,
    /// Elements to draw exactly as far as [`View::clip`] shows them, which may not be all of them.
    pub cut: Vec<ElementId>,
    /// Parts of clusters to draw.
    pub spans: Vec<Span>,
    /// The clusters of the cut.
    pub drawn: Vec<Drawn>,
    /// Clusters that draw anything.
    pub clusters: u32,
    /// Nodes looked at.
    pub visited: u32,
    /// Triangles of spans and elements.
    pub triangles: u64,
    /// Largest certified error of a drawn cluster, physical pixels.
    pub worst_px: f32,
}
