//! Merging anew what lost its certificate by edits of the schedule: same clusters, same children,
//! same thresholds, other geometry.

use super::build::Below;
use super::cover::simplify;
use super::palette::Palette;
use super::presence::PresenceTable;
use super::restate::{Images, Pair, Parents};
use super::soup::{Geometry, Triangle, append_instance, append_runs};
use super::{Cluster, Hdlod, Node, Settings, Temporal, build};
use crate::{Aabb, Cancelled, Progress, Scene};
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

impl Hdlod {
    /// A tree without stale clusters, for the background: the work of a build for these clusters
    /// alone. Every one of them keeps its children and meets the threshold of its level (H12); it
    /// is kept also where it saves few triangles. All certificates are then those of the dates now,
    /// so undoing the edit is another edit.
    ///
    /// Mode paper groups by time too, so there the tree is built anew. Elements that were
    /// never present before ([`Hdlod::loose`]) stay outside the tree until the next build.
    ///
    /// `scene` must be the one of the last [`Hdlod::restate`].
    ///
    /// # Errors
    /// Only when `progress` is cancelled.
    pub fn repair(&self, scene: &Scene, progress: &Progress) -> Result<Hdlod, Cancelled> {
        if self.temporal == Temporal::Paper {
            let settings = Settings { temporal: Temporal::Paper, ..Settings::default() };
            return build(scene, &settings, progress);
        }
        let work = Work {
            hdlod: self,
            scene,
            presence: PresenceTable::new(&scene.behaviours, true),
            palette: Palette::new(&scene.model.materials),
        };
        let mut stale: Vec<u32> =
            (0..).zip(&self.clusters).filter(|(_, c)| c.stale).map(|(i, _)| i).collect();
        stale.sort_by_key(|&i| self.clusters[i as usize].level);
        // The few coarse ones take the longest.
        let work_of = |i: u32| u64::from(self.clusters[i as usize].leaves);
        progress.begin("HDLOD: repair", stale.iter().map(|&i| work_of(i)).sum())?;
        let mut merged = HashMap::new();
        // Children are of a lower level, so clusters of one level do not wait for each other.
        for level in stale.chunk_by(|&a, &b| self.level_of(a) == self.level_of(b)) {
            let done: Result<Vec<_>, Cancelled> = level
                .par_iter()
                .map(|&i| {
                    let new = work.merge(&self.clusters[i as usize], &merged, progress)?;
                    progress.advance(work_of(i))?;
                    Ok((i, new))
                })
                .collect();
            merged.extend(done?);
        }
        Ok(self.with_merged(scene, merged))
    }

    fn level_of(&self, cluster: u32) -> u32 {
        self.clusters[cluster as usize].level
    }

    /// Lays the tables out again and makes the dates of `scene` those of all certificates.
    fn with_merged(&self, scene: &Scene, mut merged: HashMap<u32, Merged>) -> Hdlod {
        let parents = Parents::of(self);
        let images = Images::new(self, scene, &parents, &vec![true; self.clusters.len()]);
        let mut tree = Hdlod {
            temporal: self.temporal,
            children: self.children.clone(),
            root: self.root,
            levels: self.levels.clone(),
            built: scene.element_behaviour.clone(),
            period: self.period,
            loose: self.loose.clone(),
            ..Hdlod::default()
        };
        let mut vertices = Vec::with_capacity(self.vertices.len());
        for (i, old) in self.clusters.iter().enumerate() {
            let mut cluster = old.clone();
            let (first_index, base_vertex) = (tree.indices.len(), vertices.len());
            cluster.first_index = first_index as u32;
            cluster.base_vertex = base_vertex as u32;
            cluster.stale = false;
            if let Some(new) = merged.remove(&(i as u32)) {
                vertices.extend_from_slice(&new.geometry.vertices);
                tree.indices.append(new.geometry.indices.iter().copied());
                cluster.layers = new.geometry.layers;
                cluster.pairs = new.pairs.into();
                cluster.eps = new.eps;
                cluster.built_eps = new.eps;
                cluster.covered_eps = new.covered_eps;
                cluster.bounds = new.bounds;
            } else {
                let end = self.clusters.get(i + 1).map(|c| c.base_vertex as usize);
                let range = old.base_vertex as usize..end.unwrap_or(self.vertices.len());
                vertices.extend_from_slice(&self.vertices[range]);
                tree.indices.append(self.indices.range(old.indices()));
                cluster.layers.iter_mut().flat_map(|l| &mut l.runs).for_each(|run| {
                    run.built = run.behaviour;
                });
                cluster.pairs = images.pairs(i, &old.pairs).into();
                cluster.built_eps = old.eps;
            }
            tree.clusters.push(cluster);
        }
        tree.vertices = Arc::new(vertices);
        tree
    }
}

/// What a cluster became.
struct Merged {
    geometry: Geometry,
    eps: f32,
    covered_eps: f32,
    bounds: Aabb,
    pairs: Vec<Pair>,
}

struct Work<'a> {
    hdlod: &'a Hdlod,
    scene: &'a Scene,
    presence: PresenceTable<'a>,
    palette: Palette,
}

impl Work<'_> {
    /// As the build merges, but with the children that the cluster has.
    fn merge(
        &self,
        cluster: &Cluster,
        merged: &HashMap<u32, Merged>,
        progress: &Progress,
    ) -> Result<Merged, Cancelled> {
        let levels = &self.hdlod.levels;
        let level = levels.iter().find(|l| l.level == cluster.level);
        let limit = level.map_or(cluster.eps, |l| l.eps_m);
        let mut source = Vec::new();
        let mut below = Below::default();
        let mut worst = Below::default();
        let mut bounds = Aabb::EMPTY;
        for &child in self.hdlod.children_of(cluster) {
            let (error, child_bounds) = self.error_and_box(child, merged);
            worst.include(error.eps, error.covered_eps);
            bounds = bounds.union(&child_bounds);
            self.gather(child, limit * build::SOURCE_SHARE, merged, &mut source, &mut below);
        }
        let budget = limit - below.covered_eps;
        let simplified = simplify(&source, budget, &self.presence, &self.palette, progress)?;
        let step = build::proved_m(&simplified, &source, &self.presence, progress);
        worst.include(below.eps + step, below.covered_eps + simplified.distance_m);
        let geometry = Geometry::new(simplified.triangles, &self.presence);
        let drawn = Aabb::of_points(geometry.vertices.iter().map(|v| v.position.into()));
        Ok(Merged {
            geometry,
            eps: worst.eps,
            covered_eps: worst.covered_eps,
            bounds: bounds.union(&drawn),
            pairs: simplified.pairs,
        })
    }

    fn error_and_box(&self, node: Node, merged: &HashMap<u32, Merged>) -> (Below, Aabb) {
        match node {
            Node::Leaf(id) => (Below::default(), self.scene.model.elements[id.index()].bounds),
            Node::Cluster(c) => match merged.get(&c) {
                Some(new) => (Below { eps: new.eps, covered_eps: new.covered_eps }, new.bounds),
                None => {
                    let old = &self.hdlod.clusters[c as usize];
                    (Below { eps: old.eps, covered_eps: old.covered_eps }, old.bounds)
                }
            },
        }
    }

    /// Collects the geometry of the coarsest nodes whose error is at most `eps`; also what is never
    /// present now, because the next edit may bring it back.
    fn gather(
        &self,
        node: Node,
        eps: f32,
        merged: &HashMap<u32, Merged>,
        out: &mut Vec<Triangle>,
        below: &mut Below,
    ) {
        match node {
            Node::Leaf(id) => {
                let model = &self.scene.model;
                let behaviour = self.scene.element_behaviour[id.index()];
                for instance in model.instances_of(&model.elements[id.index()]) {
                    append_instance(instance, &model.meshes[instance.mesh.index()], behaviour, out);
                }
            }
            Node::Cluster(c) => {
                let (own, _) = self.error_and_box(node, merged);
                let old = &self.hdlod.clusters[c as usize];
                if own.covered_eps > eps {
                    for &child in self.hdlod.children_of(old) {
                        self.gather(child, eps, merged, out, below);
                    }
                    return;
                }
                below.include(own.eps, own.covered_eps);
                match merged.get(&c) {
                    Some(new) => new.geometry.append_triangles(out),
                    None => {
                        let vertices = &self.hdlod.vertices[old.base_vertex as usize..];
                        let first = old.first_index as usize;
                        let triangles = |range: Range<usize>| {
                            self.hdlod.indices.triangles(first + range.start..first + range.end)
                        };
                        append_runs(&old.layers, vertices, triangles, out);
                    }
                }
            }
        }
    }
}
