//! Whether a tree that was read from a file can be used with a scene.

use super::{Cluster, Hdlod, Node};
use crate::{Aabb, BehaviourId, Scene, Vertex};
use rayon::prelude::*;

/// Deepest tree that is taken: [`super::select`] descends by recursion. Trees that were built stay
/// below a hundred nodes.
const MAX_DEPTH: u32 = 1000;

impl Hdlod {
    /// Looks at every range, number and reference, so that nothing that draws or reports this tree
    /// with `scene` can go astray. O(size of the tree), on rayon's pool.
    ///
    /// # Errors
    /// What is wrong first.
    pub fn validate(&self, scene: &Scene) -> Result<(), &'static str> {
        let own = scene.model.materials.len();
        let materials = own + super::blends(own).len();
        let usable = |v: &Vertex| {
            usize::from(v.material) < materials && v.position.iter().all(|p| p.is_finite())
        };
        require(self.vertices.par_iter().with_min_len(1 << 14).all(usable), "a vertex")?;
        self.clusters.par_iter().try_for_each(|c| self.check_cluster(c, scene))?;
        self.check_dates(scene)?;
        self.check_shape(scene)
    }

    /// The tree is for the dates of the scene: what is read was built for them.
    fn check_dates(&self, scene: &Scene) -> Result<(), &'static str> {
        require(self.built == scene.element_behaviour, "the behaviours of elements")?;
        require(self.period == scene.schedule.period, "the period")?;
        require(self.loose.iter().all(|id| id.index() < self.built.len()), "a loose element")
    }

    fn check_cluster(&self, cluster: &Cluster, scene: &Scene) -> Result<(), &'static str> {
        let fine = |b: &Aabb| b.min.is_finite() && b.max.is_finite() && !b.is_empty();
        require(fine(&cluster.bounds), "a cluster's box")?;
        let errors = cluster.eps >= 0.0
            && cluster.eps == cluster.built_eps
            && cluster.eps <= cluster.covered_eps
            && cluster.covered_eps.is_finite();
        require(errors, "a cluster's error")?;
        require(cluster.gamma.is_finite() && cluster.gamma >= 0.0, "a cluster's gamma")?;
        require(cluster.weight.is_finite() && cluster.weight >= 0.0, "a cluster's weight")?;
        require(cluster.presence.is_valid(), "a cluster's behaviour")?;

        let mut end = Some(0);
        for layer in &cluster.layers {
            end = end.and_then(|first| layer.check(first, scene.behaviours.len()));
        }
        let end = end.ok_or("a cluster's runs")?;
        let known = |b: BehaviourId| b.index() < scene.behaviours.len();
        let pairs_known = cluster.pairs.iter().all(|&(a, b)| known(a) && known(b));
        require(pairs_known && !cluster.stale, "what a certificate rests on")?;
        let first = cluster.first_index as usize;
        let range = first..first + end as usize;
        require(range.end <= self.indices.len(), "a cluster's indices")?;
        let base = cluster.base_vertex as usize;
        let count = self.vertices.len().checked_sub(base).ok_or("a cluster's vertices")?;
        require(self.indices.range(range).all(|i| (i as usize) < count), "an index")
    }

    /// A tree of all clusters and elements: each has at most one parent, children come first.
    fn check_shape(&self, scene: &Scene) -> Result<(), &'static str> {
        let mut element_taken = vec![false; scene.model.elements.len()];
        let mut cluster_taken = vec![false; self.clusters.len()];
        let mut depths = Vec::with_capacity(self.clusters.len());
        for (i, cluster) in self.clusters.iter().enumerate() {
            let range = cluster.children.start as usize..cluster.children.end as usize;
            let children = self.children.get(range).ok_or("a cluster's children")?;
            require(!children.is_empty(), "a cluster without children")?;
            let mut depth = 1;
            for child in children {
                let taken = match *child {
                    Node::Leaf(id) => element_taken.get_mut(id.index()).ok_or("an element")?,
                    Node::Cluster(below) => {
                        let below = below as usize;
                        require(below < i, "a cluster before its child")?;
                        depth = depth.max(depths[below] + 1);
                        &mut cluster_taken[below]
                    }
                };
                require(!std::mem::replace(taken, true), "a node with two parents")?;
            }
            require(depth <= MAX_DEPTH, "a tree too deep")?;
            depths.push(depth);
        }
        match self.root {
            Some(Node::Cluster(root)) => {
                let free = cluster_taken.get(root as usize).is_some_and(|taken| !taken);
                require(free, "the root")
            }
            Some(Node::Leaf(id)) => {
                require(id.index() < element_taken.len() && self.clusters.is_empty(), "the root")
            }
            None => require(self.clusters.is_empty(), "clusters without a root"),
        }
    }
}

fn require(fine: bool, what: &'static str) -> Result<(), &'static str> {
    if fine { Ok(()) } else { Err(what) }
}
