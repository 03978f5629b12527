//! HDLOD: a tree of clusters with geometry and behaviour over time.

use crate::{Aabb, Cancelled, ElementId, Layer, Progress, Scene, Vertex, View};
use topout_schedule::Time;

/// Which promise a tree makes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Temporal {
    /// Every triangle is drawn exactly while what it stands for is present (R11).
    #[default]
    Tight,
    /// The paper's delta (H8) and display (H9) with the reading R1.
    Paper,
}

/// What a build depends on besides the scene.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Settings {
    /// Which promise is made.
    pub temporal: Temporal,
}

/// The tree. Geometry of all clusters lies in one vertex and one index table.
#[derive(Clone, Debug, Default)]
pub struct Hdlod {
    /// Vertices of all clusters, local space (metres from the model's origin).
    pub vertices: Vec<Vertex>,
    /// Indices of all clusters, three a triangle, relative to the cluster's [`Span::base_vertex`].
    pub indices: Vec<u32>,
    /// The clusters; the root is the last.
    pub clusters: Vec<Cluster>,
}

/// One inner node.
#[derive(Clone, Debug)]
pub struct Cluster {
    /// Encloses its geometry and everything below it (R7).
    pub bounds: Aabb,
    /// Upper bound in metres of the distance between what it draws and what it stands for (H5).
    pub eps: f32,
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
    /// Which pass draws it.
    pub layer: Layer,
}

/// What to draw: a value, the result of [`select`].
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Selection {
    /// Elements to draw exactly.
    pub elements: Vec<ElementId>,
    /// Parts of clusters to draw.
    pub spans: Vec<Span>,
    /// Clusters drawn.
    pub clusters: u32,
    /// Nodes looked at.
    pub visited: u32,
    /// Triangles of spans and elements.
    pub triangles: u64,
    /// Largest certified error of a drawn cluster, physical pixels.
    pub worst_px: f32,
}

/// Builds the tree, bottom-up and in parallel, on the calling thread and rayon's pool.
pub fn build(scene: &Scene, settings: &Settings, progress: &Progress) -> Result<Hdlod, Cancelled> {
    let _ = (scene, settings);
    progress.check()?;
    Ok(Hdlod::default())
}

/// The cut of the tree for a view at a date: a pure function.
pub fn select(scene: &Scene, hdlod: &Hdlod, view: &View, time: Time) -> Selection {
    let _ = (scene, hdlod, view, time);
    Selection::default()
}
