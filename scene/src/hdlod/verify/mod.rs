//! An independent check of a tree: its certificates, and the promise that it makes about pictures.
//!
//! Nothing here shares code with the builder: triangles are read from the model again, nearest
//! points and rays have a tree of their own, shares and integrals are computed from the
//! definitions. Only what is under test is called: [`super::select`] and what it draws.
//!
//! | what | file | lines |
//! |---|---|---|
//! | structure, f, w, eps, gamma of clusters | `clusters` | H4 to H7, R2, R7, R9 to R11 |
//! | the picture against full detail | `pictures`, `views` | R8, R11; H9 with R3 in mode paper |
//!
//! The promise of mode tight, as it is tested: each visible point of the picture drawn by HDLOD, and
//! each visible point of the picture in full detail, has a point of the other's geometry at that
//! date so near in space that on the picture the two are at most the tolerance apart. What lies
//! behind glass is visible as well.

mod clusters;
mod geometry;
mod pictures;
#[cfg(test)]
mod tests;
mod tree;
mod views;

use super::{Hdlod, Temporal};
use crate::{Cancelled, Progress, Scene};
use glam::UVec2;

/// What to check and how thoroughly.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Plan {
    /// Size of the pictures in physical pixels.
    pub size: UVec2,
    /// Largest error allowed on them, physical pixels.
    pub tolerance_px: f32,
    /// Most clusters that are checked; which ones, the seed says.
    pub clusters: usize,
    /// Most points that are measured for a cluster, each way and date.
    pub cluster_points: usize,
    /// Points for each triangle of a cluster, where `cluster_points` allows as many.
    pub triangle_points: usize,
    /// Dates at which a cluster is checked.
    pub cluster_dates: usize,
    /// Of the pictures every so many-th pixel each way is looked at.
    pub stride: u32,
    /// Decides what a sample consists of: the same seed, the same report.
    pub seed: u64,
}

impl Plan {
    /// A sample that suffices to find what is wrong in more than single places.
    pub fn sample(size: UVec2, tolerance_px: f32) -> Self {
        Self {
            size,
            tolerance_px,
            clusters: 10_000,
            cluster_points: 1500,
            triangle_points: 16,
            cluster_dates: 3,
            stride: 4,
            seed: 1,
        }
    }

    /// Every cluster and every pixel.
    pub fn full(size: UVec2, tolerance_px: f32) -> Self {
        Self {
            clusters: usize::MAX,
            cluster_points: 6000,
            cluster_dates: 4,
            stride: 1,
            ..Self::sample(size, tolerance_px)
        }
    }
}

/// What a violation is about.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// The tree's shape, a box, a weight or a share that is present.
    Structure,
    /// More is wrong than eps says.
    Eps,
    /// More is wrong in time than gamma says.
    Gamma,
    /// A visible point is farther from its counterpart than the tolerance.
    Promise,
}

/// One violation.
#[derive(Clone, PartialEq, Debug)]
pub struct Finding {
    /// What it is about.
    pub kind: Kind,
    /// Where and how much, for people.
    pub message: String,
}

/// What was found.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Report {
    /// Clusters that were measured.
    pub clusters_checked: usize,
    /// Clusters (and once the tree itself) whose definition does not hold.
    pub structure_violations: usize,
    /// Clusters that draw something farther than eps from what is present, or the other way round.
    pub eps_violations: usize,
    /// Clusters whose gamma is below what it bounds.
    pub gamma_violations: usize,
    /// Median over the checked clusters of the largest distance measured, as a share of eps.
    pub median_eps_share: f32,
    /// Pictures that were looked at.
    pub pictures: usize,
    /// Visible points that were measured, of both pictures.
    pub points_checked: u64,
    /// Visible points farther than the tolerance from their counterpart; mode paper promises
    /// nothing, so there they are counted in [`Report::wrong_points`] alone.
    pub promise_violations: u64,
    /// Visible points farther than the tolerance from their counterpart.
    pub wrong_points: u64,
    /// The largest error in pixels; at most the picture's diagonal.
    pub worst_px: f32,
    /// The largest connected part of a picture, in pixels, in which something visible has no
    /// counterpart within the tolerance.
    pub worst_region_px: u64,
    /// Where `worst_region_px` was found.
    pub worst_region_at: String,
    /// Some of the violations, the first of each kind.
    pub findings: Vec<Finding>,
}

impl Report {
    /// Most findings of one kind that are told.
    const TOLD: usize = 20;

    /// Whether everything holds.
    pub fn is_clean(&self) -> bool {
        self.structure_violations == 0
            && self.eps_violations == 0
            && self.gamma_violations == 0
            && self.promise_violations == 0
    }

    fn tell(&mut self, finding: Finding) {
        if self.findings.iter().filter(|f| f.kind == finding.kind).count() < Self::TOLD {
            self.findings.push(finding);
        }
    }
}

/// Checks a tree against its scene, on the calling thread and rayon's pool.
///
/// # Errors
/// Only when `progress` is cancelled.
pub fn verify(
    scene: &Scene,
    hdlod: &Hdlod,
    plan: &Plan,
    progress: &Progress,
) -> Result<Report, Cancelled> {
    let mut report = Report::default();
    // What draws from tables that do not hold together cannot be looked at.
    if clusters::check(scene, hdlod, plan, progress, &mut report)? {
        pictures::check(scene, hdlod, plan, progress, &mut report)?;
    }
    if hdlod.temporal == Temporal::Tight {
        report.promise_violations = report.wrong_points;
    } else {
        report.findings.retain(|f| f.kind != Kind::Promise);
    }
    Ok(report)
}

/// SplitMix64: the same sample on every machine.
#[derive(Clone, Debug)]
struct Random(u64);

impl Random {
    /// A stream of its own for each pair of numbers.
    fn new(seed: u64, stream: u64) -> Self {
        let mut random = Self(seed ^ stream.wrapping_mul(0xd134_2543_de82_ef95));
        random.next();
        random
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// In 0..n; `n` must not be 0.
    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
}
