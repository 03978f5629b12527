//! How tight the certificates are, and what a library's own error figure is worth beside them (R10).
//!
//! For a sample of clusters: the bounds of [`super::certify`] against points sampled densely, and the
//! same soups given to meshoptimizer with the cluster's eps as the error allowed.

use super::bvh::{Nearest, SoupTree, Wanted};
use super::certify::{Limits, distance};
use super::presence::PresenceTable;
use super::soup::{Triangle, append_instance};
use super::{Cluster, Hdlod, Node, Temporal};
use crate::optimizer::{Way, simplify};
use crate::{Cancelled, ElementId, Progress, Scene};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// How close upper and lower bound are asked to be.
const RATIO: f32 = 1.1;

/// Differences that do not count: pieces are not cut more finely than this.
const CLOSE: f32 = 1.001;

/// Points sampled on each soup, about.
const POINTS: f64 = 40_000.0;

/// Median, 90th percentile and largest of some figure.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Spread {
    /// Half of the values are not larger.
    pub median: f64,
    /// Nine of ten are not larger.
    pub p90: f64,
    /// None is larger.
    pub max: f64,
}

impl Spread {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.filter(|v| !v.is_nan()).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = values.len().saturating_sub(1);
            values.get((last as f64 * share).round() as usize).copied().unwrap_or(0.0)
        };
        Self { median: at(0.5), p90: at(0.9), max: at(1.0) }
    }
}

/// What one way of simplifying claims of its result, and what is true.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Claim {
    /// Who simplified.
    pub way: &'static str,
    /// Triangles left of those given, over all clusters.
    pub triangles_kept: f64,
    /// Certified distance over the error that was reported.
    pub true_over_claimed: Spread,
    /// Share of the clusters whose certified distance is within the eps that was allowed.
    pub within_eps: f64,
    /// Share of the clusters where some point is farther away than was claimed.
    pub disproved: f64,
}

/// The figures of a sample.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Audit {
    /// Clusters in the sample.
    pub clusters: usize,
    /// Upper bound over the largest sampled distance, cluster against the union of its children.
    pub upper_over_sampled: Spread,
    /// This tree, and the library's ways.
    pub claims: Vec<Claim>,
}

/// Figures of one cluster.
struct Row {
    upper_over_sampled: f64,
    given: usize,
    ways: [Kept; 3],
}

/// What one way made of one cluster.
struct Kept {
    triangles: usize,
    claimed: f32,
    certified: f32,
    within_eps: bool,
    /// A point was found that is farther than what is claimed.
    disproved: bool,
}

const NAMES: [&str; 3] = ["this tree", "meshoptimizer simplify", "meshoptimizer simplifySloppy"];

/// Measures every so many-th cluster, about `most` of them.
///
/// # Errors
/// Only when `progress` is cancelled.
pub fn audit(
    scene: &Scene,
    hdlod: &Hdlod,
    most: usize,
    progress: &Progress,
) -> Result<Audit, Cancelled> {
    let step = hdlod.clusters.len().div_ceil(most.max(1)).max(1);
    let sample: Vec<&Cluster> = hdlod
        .clusters
        .iter()
        .step_by(step)
        .filter(|c| !c.stale && c.eps > 0.0 && c.triangle_count() > 0)
        .collect();
    progress.begin("how tight certificates are", sample.len() as u64)?;
    let time_exact = hdlod.temporal == Temporal::Tight;
    let exact = PresenceTable::new(&scene.behaviours, time_exact);
    let blind = PresenceTable::new(&scene.behaviours, false);
    let rows: Result<Vec<Row>, Cancelled> = sample
        .par_iter()
        .with_max_len(1)
        .map(|cluster| {
            let row = measure(scene, hdlod, cluster, &exact, &blind);
            progress.advance(1)?;
            Ok(row)
        })
        .collect();
    let rows = rows?;
    let given: usize = rows.iter().map(|r| r.given).sum();
    let claims = NAMES.into_iter().enumerate().map(|(i, way)| {
        let kept: usize = rows.iter().map(|r| r.ways[i].triangles).sum();
        let within = rows.iter().filter(|r| r.ways[i].within_eps).count();
        let disproved = rows.iter().filter(|r| r.ways[i].disproved).count();
        Claim {
            way,
            triangles_kept: kept as f64 / given.max(1) as f64,
            // What claims no error and has none is right; what has one is infinitely wrong.
            true_over_claimed: Spread::of(
                rows.iter()
                    .map(|r| &r.ways[i])
                    .filter(|k| k.certified > 1e-6)
                    .map(|k| f64::from(k.certified) / f64::from(k.claimed)),
            ),
            within_eps: within as f64 / rows.len().max(1) as f64,
            disproved: disproved as f64 / rows.len().max(1) as f64,
        }
    });
    Ok(Audit {
        clusters: rows.len(),
        upper_over_sampled: Spread::of(rows.iter().map(|r| r.upper_over_sampled)),
        claims: claims.collect(),
    })
}

fn measure(
    scene: &Scene,
    hdlod: &Hdlod,
    cluster: &Cluster,
    exact: &PresenceTable,
    blind: &PresenceTable,
) -> Row {
    let own = triangles_of(hdlod, cluster);
    let (mut children, mut leaves) = (Vec::new(), Vec::new());
    for &child in hdlod.children_of(cluster) {
        match child {
            Node::Leaf(id) => append_element(scene, id, &mut children),
            Node::Cluster(i) => {
                children.extend(triangles_of(hdlod, &hdlod.clusters[i as usize]));
            }
        }
        append_leaves(scene, hdlod, child, &mut leaves);
    }
    let value = Limits::value(RATIO, 0.0);
    let one_step = distance(&children, &own, exact, value);
    let sampled = sampled(&children, &own, exact);
    let judge = |from: &[Triangle], kept: &[Triangle], claimed: f32, presence| {
        let found = distance(from, kept, presence, value);
        let decided = distance(from, kept, presence, Limits::decide(cluster.eps));
        Kept {
            triangles: kept.len(),
            claimed,
            certified: found.upper,
            within_eps: decided.upper <= cluster.eps * CLOSE,
            // 32-bit coordinates are rounded.
            disproved: found.lower > claimed * CLOSE + 1e-5,
        }
    };
    let library = |way| {
        let corners: Vec<[Vec3; 3]> = children.iter().map(|t| t.corners).collect();
        let (kept, claimed) = simplify(&corners, cluster.eps, way);
        let kept: Vec<Triangle> =
            kept.into_iter().map(|corners| Triangle { corners, ..children[0] }).collect();
        judge(&children, &kept, claimed, blind)
    };
    Row {
        // Where nothing changed there is no distance to compare.
        upper_over_sampled: if sampled > 1e-6 {
            f64::from(one_step.upper) / sampled
        } else {
            f64::NAN
        },
        given: children.len(),
        ways: [
            judge(&leaves, &own, cluster.eps, exact),
            library(Way::Default),
            library(Way::Sloppy),
        ],
    }
}

fn triangles_of(hdlod: &Hdlod, cluster: &Cluster) -> Vec<Triangle> {
    let mut out = Vec::with_capacity(cluster.triangle_count());
    for (layer, run, range) in cluster.runs() {
        for corners in hdlod.indices.triangles(range) {
            let v = corners.map(|i| hdlod.vertices[(cluster.base_vertex() + i) as usize]);
            out.push(Triangle {
                corners: v.map(|v| v.position.into()),
                normals: v.map(|v| v.normal),
                material: v[0].material,
                layer,
                behaviour: run.behaviour,
            });
        }
    }
    out
}

fn append_element(scene: &Scene, id: ElementId, out: &mut Vec<Triangle>) {
    let behaviour = scene.element_behaviour[id.index()];
    for instance in scene.model.instances_of(&scene.model.elements[id.index()]) {
        append_instance(instance, &scene.model.meshes[instance.mesh.index()], behaviour, out);
    }
}

fn append_leaves(scene: &Scene, hdlod: &Hdlod, node: Node, out: &mut Vec<Triangle>) {
    match node {
        Node::Leaf(id) => append_element(scene, id, out),
        Node::Cluster(i) => {
            for &child in hdlod.children_of(&hdlod.clusters[i as usize]) {
                append_leaves(scene, hdlod, child, out);
            }
        }
    }
}

/// The largest distance of points in a lattice on the triangles of either soup from the other one.
fn sampled(a: &[Triangle], b: &[Triangle], presence: &PresenceTable) -> f64 {
    let mut worst = 0f64;
    for (from, to) in [(a, b), (b, a)] {
        let tree = SoupTree::new(to, presence);
        let area: f64 = from.iter().map(|t| f64::from(t.area())).sum();
        for triangle in from {
            let wanted = Wanted::new(triangle.behaviour, presence);
            let share = f64::from(triangle.area()) / area.max(f64::MIN_POSITIVE);
            let steps = (share * POINTS * 2.0).sqrt().ceil().clamp(1.0, 100.0);
            let [p, q, r] = triangle.corners.map(|c| c.as_dvec3());
            for i in 0..=steps as u32 {
                for j in 0..=steps as u32 - i {
                    let point: DVec3 =
                        p + ((q - p) * f64::from(i) + (r - p) * f64::from(j)) / steps;
                    // Only what is farther than everything before matters.
                    let near = tree.nearest(&[point], wanted, Nearest::NONE, worst * worst);
                    worst = worst.max(near.squared.sqrt());
                }
            }
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::tests::{built, storeys};
    use super::*;
    use topout_schedule::Behaviour;

    /// A crowd of boxes: the library says little of what vanished, the certificate says all.
    #[test]
    fn certificates_are_tight_and_claims_are_not() {
        let scene = storeys(2.0, [0.7, 0.3], &vec![Behaviour::always(); 6]);
        let hdlod = built(&scene, Temporal::Tight);
        let audit = audit(&scene, &hdlod, 50, &Progress::default()).unwrap();
        assert!(audit.clusters > 5, "{audit:?}");
        let ratio = audit.upper_over_sampled;
        assert!(ratio.median >= 0.999 && ratio.median <= 1.3 && ratio.max < 1.5, "{ratio:?}");
        assert!(audit.claims[0].true_over_claimed.max <= 1.11, "{audit:?}");
        assert_eq!(
            (audit.claims[0].disproved, audit.claims[0].within_eps),
            (0.0, 1.0),
            "{audit:?}"
        );
        assert!(audit.claims[2].disproved > 0.0, "{audit:?}");
        for claim in &audit.claims {
            assert!(claim.triangles_kept > 0.0 && claim.triangles_kept <= 1.0, "{claim:?}");
        }
    }
}
