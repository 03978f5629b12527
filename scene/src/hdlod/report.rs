//! What a tree is like, level by level: the figures by which H14 is judged.

use super::{Cluster, Hdlod, Node};
use crate::{Aabb, ElementId, Scene, Vertex};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Boxes count as at least this thick, in metres: a plate has a place, too.
const THINNEST: f32 = 1e-3;

/// One level of a tree. Means and medians are those of the clusters that this level made; zero
/// where it made none.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct LevelReport {
    /// From 1.
    pub level: u32,
    /// eps(l) of H12 in metres.
    pub eps_m: f32,
    /// gamma(l) of H12 in [0, 1].
    pub gamma_limit: f64,
    /// Clusters made.
    pub clusters: usize,
    /// Children of a cluster.
    pub mean_degree: f64,
    /// Most children of a cluster.
    pub max_degree: usize,
    /// Triangles of these clusters.
    pub triangles: usize,
    /// Nodes active after the level.
    pub active: usize,
    /// Triangles that the active nodes draw together: complexity falls with level (H13).
    pub active_triangles: usize,
    /// How much the children of a cluster overlap, in [0, 1]: the volume that two children's boxes
    /// have in common over that of the smaller box, the mean over all pairs of siblings, the mean
    /// over the clusters with two children or more.
    pub overlap: f64,
    /// Surface of the clusters over the surface of the elements below them. Both sides of thin
    /// parts count, so what is drawn as one plate keeps half.
    pub area_kept: f64,
    /// The middle gamma of the clusters (H6).
    pub gamma_median: f64,
    /// The largest.
    pub gamma_max: f64,
}

impl Hdlod {
    /// Looks at every cluster of a tree of `scene`. A pure function of the two, O(n log n).
    pub fn report(&self, scene: &Scene) -> Vec<LevelReport> {
        let elements = element_areas(scene);
        let clusters = self.figures(scene, &elements);
        let mut by_level: Vec<u32> = (0..clusters.len() as u32).collect();
        by_level.sort_by_key(|&i| self.clusters[i as usize].level);
        let mut rest = &by_level[..];
        let mut report = Vec::with_capacity(self.levels.len());
        for stats in &self.levels {
            let end = rest.partition_point(|&i| self.clusters[i as usize].level <= stats.level);
            let (own, later) = rest.split_at(end);
            rest = later;
            report.push(LevelReport {
                level: stats.level,
                eps_m: stats.eps_m,
                gamma_limit: stats.gamma_limit,
                active: stats.active,
                active_triangles: stats.triangles,
                ..self.level_figures(own, &clusters)
            });
        }
        report
    }

    fn level_figures(&self, members: &[u32], figures: &[Figures]) -> LevelReport {
        let clusters = || members.iter().map(|&i| &self.clusters[i as usize]);
        let figures = || members.iter().map(|&i| &figures[i as usize]);
        let mut gammas: Vec<f64> = clusters().map(|c| c.gamma).collect();
        gammas.sort_by(f64::total_cmp);
        LevelReport {
            clusters: members.len(),
            mean_degree: mean(clusters().map(|c| c.children.len() as f64)),
            max_degree: clusters().map(|c| c.children.len()).max().unwrap_or(0),
            triangles: clusters().map(Cluster::triangle_count).sum(),
            overlap: mean(figures().filter_map(|f| f.overlap)),
            area_kept: ratio(figures().map(|f| f.drawn).sum(), figures().map(|f| f.below).sum()),
            gamma_median: gammas.get(gammas.len() / 2).copied().unwrap_or(0.0),
            gamma_max: gammas.last().copied().unwrap_or(0.0),
            ..LevelReport::default()
        }
    }

    /// The figures of each cluster, in the order of the table.
    fn figures(&self, scene: &Scene, elements: &[f64]) -> Vec<Figures> {
        let mut figures: Vec<Figures> = self
            .clusters
            .par_iter()
            .map(|c| Figures { drawn: self.area(c), below: 0.0, overlap: self.overlap(c, scene) })
            .collect();
        for (i, cluster) in self.clusters.iter().enumerate() {
            let below = self.children_of(cluster).iter().map(|child| match *child {
                Node::Leaf(ElementId(id)) => elements[id as usize],
                Node::Cluster(child) => figures[child as usize].below,
            });
            figures[i].below = below.sum();
        }
        figures
    }

    /// Square metres of a cluster's triangles.
    fn area(&self, cluster: &Cluster) -> f64 {
        let triangles = self.indices.triangles(cluster.indices());
        let base = cluster.base_vertex as usize;
        area(triangles, |i| position(&self.vertices[base + i]))
    }

    /// Of a cluster's children; `None` of fewer than two.
    fn overlap(&self, cluster: &Cluster, scene: &Scene) -> Option<f64> {
        let boxes: Vec<Aabb> = self
            .children_of(cluster)
            .iter()
            .map(|child| match *child {
                Node::Leaf(id) => scene.model.elements[id.index()].bounds,
                Node::Cluster(i) => self.clusters[i as usize].bounds,
            })
            .map(|b| b.grown(THINNEST * 0.5))
            .collect();
        let pairs = boxes.iter().enumerate().flat_map(|(i, a)| {
            boxes[i + 1..].iter().map(move |b| shared(a, b) / volume(a).min(volume(b)))
        });
        (boxes.len() > 1).then(|| mean(pairs))
    }
}

/// What a level's figures are made of.
struct Figures {
    /// Square metres that the cluster draws.
    drawn: f64,
    /// Square metres of the elements below it.
    below: f64,
    overlap: Option<f64>,
}

/// Square metres of each element.
fn element_areas(scene: &Scene) -> Vec<f64> {
    let model = &scene.model;
    let instance = |i: &crate::Instance| {
        let mesh = &model.meshes[i.mesh.index()];
        area(mesh.triangles(), |v| i.world_from_mesh.transform_point3(position(&mesh.vertices[v])))
    };
    let elements = model.elements.par_iter().with_min_len(256);
    elements.map(|e| model.instances_of(e).iter().map(instance).sum()).collect()
}

fn position(vertex: &Vertex) -> Vec3 {
    vertex.position.into()
}

/// Square metres of triangles.
fn area(triangles: impl Iterator<Item = [u32; 3]>, corner: impl Fn(usize) -> Vec3) -> f64 {
    let triangle = |corners: [u32; 3]| {
        let [a, b, c] = corners.map(|index| corner(index as usize));
        f64::from((b - a).cross(c - a).length()) * 0.5
    };
    triangles.map(triangle).sum()
}

/// Cubic metres.
fn volume(bounds: &Aabb) -> f64 {
    let size: DVec3 = bounds.size().as_dvec3();
    size.x * size.y * size.z
}

/// Cubic metres that two boxes have in common.
fn shared(a: &Aabb, b: &Aabb) -> f64 {
    volume(&Aabb { min: a.min.max(b.min), max: a.max.min(b.max) })
}

/// 0 of nothing.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0, 0.0), |(count, sum), v| (count + 1, sum + v));
    ratio(sum, f64::from(count))
}

/// 0 over nothing.
fn ratio(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::tests::{built, element_triangles, leaves_below, scene};
    use super::super::{Settings, Temporal, build};
    use super::*;
    use crate::Progress;
    use proptest::prelude::*;

    /// Surface by Heron's formula.
    fn heron(triangles: &[[Vec3; 3]]) -> f64 {
        let of = |[a, b, c]: &[Vec3; 3]| {
            let d = |p: &Vec3, q: &Vec3| p.as_dvec3().distance(q.as_dvec3());
            let (x, y, z) = (d(a, b), d(b, c), d(c, a));
            let s = (x + y + z) * 0.5;
            (s * (s - x) * (s - y) * (s - z)).max(0.0).sqrt()
        };
        triangles.iter().map(of).sum()
    }

    fn drawn(tree: &Hdlod, cluster: &Cluster) -> Vec<[Vec3; 3]> {
        let vertex = |i: u32| tree.vertices[(cluster.base_vertex() + i) as usize].position.into();
        let ranges = cluster.runs().flat_map(|(_, _, range)| range.collect::<Vec<usize>>());
        let corners: Vec<Vec3> = ranges.map(|i| vertex(tree.indices.at(i))).collect();
        corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect()
    }

    /// Length that two intervals have in common.
    fn common(a: (f32, f32), b: (f32, f32)) -> f64 {
        (f64::from(a.1.min(b.1)) - f64::from(a.0.max(b.0))).max(0.0)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn the_figures_are_those_of_looking_at_everything(scene in scene(), paper in any::<bool>()) {
            let tree = built(&scene, if paper { Temporal::Paper } else { Temporal::Tight });
            let report = tree.report(&scene);
            prop_assert_eq!(report.len(), tree.levels.len());
            for (level, stats) in report.iter().zip(&tree.levels) {
                let own: Vec<&Cluster> =
                    tree.clusters.iter().filter(|c| c.level == stats.level).collect();
                prop_assert_eq!(level.clusters, own.len());
                prop_assert_eq!(level.clusters, stats.clusters);
                prop_assert_eq!(level.active_triangles, stats.triangles);
                let degrees: Vec<usize> = own.iter().map(|c| c.children.len()).collect();
                prop_assert_eq!(level.max_degree, degrees.iter().copied().max().unwrap_or(0));
                let total: usize = degrees.iter().sum();
                let mean = total as f64 / own.len().max(1) as f64;
                prop_assert!((level.mean_degree - mean).abs() < 1e-9);

                let (mut kept, mut whole, mut triangles) = (0.0, 0.0, 0);
                let (mut overlaps, mut gammas) = (Vec::new(), Vec::new());
                for cluster in own {
                    let soup = drawn(&tree, cluster);
                    triangles += soup.len();
                    kept += heron(&soup);
                    let (mut leaves, mut below) = (Vec::new(), Vec::new());
                    for &child in tree.children_of(cluster) {
                        leaves_below(&tree, child, &mut leaves);
                    }
                    leaves.iter().for_each(|&id| element_triangles(&scene, id, &mut below));
                    whole += heron(&below);
                    gammas.push(cluster.gamma);
                    overlaps.extend(pairwise(&tree, &scene, cluster));
                }
                prop_assert_eq!(level.triangles, triangles);
                let share = if whole > 0.0 { kept / whole } else { 0.0 };
                prop_assert!((level.area_kept - share).abs() < 2e-3 * share.max(1.0), "{} {}", level.area_kept, share);
                let overlap = overlaps.iter().sum::<f64>() / overlaps.len().max(1) as f64;
                prop_assert!((level.overlap - overlap).abs() < 1e-3, "{} {}", level.overlap, overlap);
                prop_assert!((0.0..=1.0 + 1e-9).contains(&level.overlap));
                let below = gammas.iter().filter(|g| **g < level.gamma_median).count();
                let above = gammas.iter().filter(|g| **g > level.gamma_median).count();
                prop_assert!(below <= gammas.len() / 2 && above <= gammas.len() / 2);
                prop_assert_eq!(level.gamma_max, gammas.iter().copied().fold(0.0, f64::max));
                if paper && level.gamma_limit < 1.0 - 1e-6 {
                    prop_assert!(level.gamma_max <= level.gamma_limit);
                }
            }
        }
    }

    /// The mean over pairs, side by side instead of corner by corner.
    fn pairwise(tree: &Hdlod, scene: &Scene, cluster: &Cluster) -> Option<f64> {
        let children = tree.children_of(cluster);
        let sides = |node: Node| {
            let b = match node {
                Node::Leaf(id) => scene.model.elements[id.index()].bounds,
                Node::Cluster(i) => tree.clusters[i as usize].bounds,
            };
            [0, 1, 2].map(|k| (b.min[k] - 0.5 * THINNEST, b.max[k] + 0.5 * THINNEST))
        };
        let mut shares = Vec::new();
        for (i, &a) in children.iter().enumerate() {
            for &b in &children[..i] {
                let (a, b) = (sides(a), sides(b));
                let product = |f: &dyn Fn(usize) -> f64| f(0) * f(1) * f(2);
                let both = product(&|k| common(a[k], b[k]));
                let least = product(&|k| common(a[k], a[k])).min(product(&|k| common(b[k], b[k])));
                shares.push(both / least);
            }
        }
        (!shares.is_empty()).then(|| shares.iter().sum::<f64>() / shares.len() as f64)
    }

    #[test]
    fn a_scene_without_clusters_has_an_empty_report() {
        let scene = Scene::default();
        let tree = build(&scene, &Settings::default(), &Progress::default()).unwrap();
        assert_eq!(tree.report(&scene), []);
    }
}
