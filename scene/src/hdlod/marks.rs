//! Which nodes of the tree have a look of their own at a date.
//!
//! The merged geometry of a cluster has the colours of its elements and no other. A look that all of
//! what is present below it has can be given to all of it; where looks differ it cannot stand for them,
//! and the cut goes down to where they do not. So colours are exact, at whatever distance.

use super::{Hdlod, Node, Parents};
use crate::{ElementId, LookId, Scene};
use topout_schedule::Time;

/// Looks of elements at a date, and of the clusters above them.
#[derive(Clone, Debug, Default)]
pub struct Marks {
    elements: Vec<LookId>,
    clusters: Vec<LookId>,
    /// Which are not [`LookId::OWN`].
    marked_elements: Vec<ElementId>,
    marked_clusters: Vec<u32>,
}

/// Below the cluster are several looks.
const MIXED: LookId = LookId(u16::MAX);

impl Marks {
    /// Takes the looks of a date, each element at most once; all others look as they are.
    pub fn set(
        &mut self,
        scene: &Scene,
        tree: &Hdlod,
        parents: &Parents,
        looks: &[(ElementId, LookId)],
        time: Time,
    ) {
        self.elements.resize(scene.model.elements.len(), LookId::OWN);
        self.clusters.resize(tree.clusters.len(), LookId::OWN);
        self.clear();
        for &(element, look) in looks.iter().filter(|(e, _)| scene.behaviour(*e).at(time)) {
            self.elements[element.index()] = look;
            self.marked_elements.push(element);
            for cluster in parents.above(Node::Leaf(element)) {
                if self.clusters[cluster as usize] == MIXED {
                    break;
                }
                self.clusters[cluster as usize] = MIXED;
                self.marked_clusters.push(cluster);
            }
        }
        // Children come before their parents.
        self.marked_clusters.sort_unstable();
        for &cluster in &self.marked_clusters {
            let children = tree.children_of(&tree.clusters[cluster as usize]);
            let mut looks =
                children.iter().filter_map(|&child| self.present(scene, tree, child, time));
            let first = looks.next().unwrap_or(LookId::OWN);
            let look = if looks.all(|look| look == first) { first } else { MIXED };
            self.clusters[cluster as usize] = look;
        }
    }

    /// The look of a node, unless nothing of it is present for sure.
    fn present(&self, scene: &Scene, tree: &Hdlod, node: Node, time: Time) -> Option<LookId> {
        match node {
            Node::Leaf(id) => scene.behaviour(id).at(time).then(|| self.elements[id.index()]),
            Node::Cluster(i) => {
                let present = tree.clusters[i as usize].presence.may_be_present(time);
                present.then(|| self.clusters[i as usize])
            }
        }
    }

    /// Everything looks as it is.
    pub fn clear(&mut self) {
        for element in self.marked_elements.drain(..) {
            self.elements[element.index()] = LookId::OWN;
        }
        for cluster in self.marked_clusters.drain(..) {
            self.clusters[cluster as usize] = LookId::OWN;
        }
    }

    /// The one look of all that is present below a cluster; `None` where there are several.
    pub fn of_cluster(&self, cluster: u32) -> Option<LookId> {
        let look = self.clusters.get(cluster as usize).copied().unwrap_or_default();
        (look != MIXED).then_some(look)
    }
}
