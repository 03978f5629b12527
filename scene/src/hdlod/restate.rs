//! A tree for other dates without a new build: what an edit of the schedule changes in a tree, and
//! which of its certificates survive it.
//!
//! Geometry does not change, so all that depends on dates is worked out anew for the ancestors of
//! the elements concerned: f_c and gamma_c (H6, H7), the behaviour of each run and with it the
//! order of the runs, and, in mode tight, whether the certificate (R11) still holds. Everything is
//! a function of the tree as it was built and of the dates now, never of the edits between: undoing
//! an edit gives back the tree before it.
//!
//! # When a certificate holds
//!
//! A cluster c was built under behaviours that are called *built* here. Let an element's built
//! behaviour b have become b'. Call the images of b in c all b' of elements below c with built
//! behaviour b. The promise "at every date, what c draws is within eps_c of what is present below
//! it, both ways" was proved from these facts alone:
//!
//! 1. Every point of a run of behaviour b is within some e of geometry that it was made of. That
//!    geometry is of elements below c, or of runs of clusters below c, with the same behaviour b.
//! 2. Every point of geometry of behaviour s that c was made of and that did not stay is within e of
//!    a run of behaviour k, and k includes s: a run stands wherever what it covers stands. The pairs
//!    (k, s) that this was used for, where k is not s, are [`Cluster::pairs`].
//! 3. The promise of the clusters below c whose geometry c was made of, with an eps so small that
//!    it and e are together at most eps_c.
//!
//! After the edit run b of c is drawn while b' is present, if b has one image b' in c. Then the promise
//! holds again with the same eps_c, if
//!
//! - (a) it holds for the clusters below c,
//! - (b) every run's behaviour has a single image in c, and
//! - (c) for every pair (k, s), the image of k includes every image of s in c.
//!
//! For let t be a date, p a point of a run of c that is drawn at t, so its b' is present at t. By 1
//! there is a point q within e of p in geometry of built behaviour b. If it is of an element below c:
//! the element's behaviour now is an image of b in c, by (b) b' itself, so it is present at t. If it
//! is of a run of a cluster d below c: elements below d are below c, so the image of b in d is b' too
//! ((b) for d, by (a)); the run is drawn at t and by (a) q is within eps_d of something present below
//! d. Conversely let p be a point of an element present at t, below c. By (a) there is, within eps_d,
//! a point q of geometry that c was made of, which is drawn at t (where the element itself was that
//! geometry, q is p). Say its built behaviour is s, and s' the image of s by which it is drawn at t:
//! an image of s in c. If q stayed, its run's behaviour is s, whose image by (b) is s', and q was
//! moved by at most e. If not, by 2 it is within e of a run of behaviour k with k = s, and the same
//! holds, or with a pair (k, s): by (c) the image of k includes s', so that run is drawn at t. In
//! all cases the way is at most e + eps_d <= eps_c. QED
//!
//! The eps_c that this speaks of is [`Cluster::covered_eps`], the one that the pairs prove. At the
//! dates of the build branch and bound proves a smaller one ([`Cluster::eps`]) from the triangles
//! themselves; below whom a behaviour changed falls back, for the others it stays.
//!
//! (a) asks for all clusters below c where those that c was made of would do: simple, and a tree
//! whose errors grow to the root needs the rest for nothing.
//!
//! In mode paper nothing here depends on dates but f_c, gamma_c and the order of the runs: eps is a
//! bound for the union of all runs, and delta follows from what is worked out anew.

use super::presence::presence_weight;
use super::{Hdlod, Indices, MAX_STEPS, Node, Temporal};
use crate::{BehaviourId, ElementId, Scene};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use topout_schedule::{Behaviour, BoundedStep, StepFunction};

/// What [`Hdlod::restate`] did.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Restated {
    /// Clusters that were worked out anew.
    pub clusters: usize,
    /// Ranges of [`Hdlod::indices`] whose content changed, in order: what a GPU has to be sent.
    pub dirty: Vec<Range<usize>>,
    /// Clusters that held before and do not now.
    pub invalidated: Vec<u32>,
    /// Clusters that hold again.
    pub revalidated: Vec<u32>,
}

/// The tree was built for another scene than the one that was edited.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("the tree belongs to another scene")]
pub struct OtherScene;

impl Hdlod {
    /// Brings the tree to the dates of `scene`, which must come from the scene that it was built
    /// for by edits ([`Scene::with_activity_dates`], [`Scene::with_schedule`]). `changed`: the
    /// elements whose behaviour is not the one of the scene before.
    ///
    /// Costs what the tree below the highest of their ancestors costs to sum up; all of it when the
    /// project's period changed.
    ///
    /// # Errors
    /// When model or behaviours cannot be those that the tree was built for.
    pub fn restate(
        &mut self,
        scene: &Scene,
        changed: &[ElementId],
    ) -> Result<Restated, OtherScene> {
        let elements = scene.model.elements.len();
        let known = self.built.iter().all(|b| b.index() < scene.behaviours.len());
        if self.built.len() != elements || scene.element_behaviour.len() != elements || !known {
            return Err(OtherScene);
        }
        let parents = Parents::of(self);
        let period = scene.schedule.period;
        let affected = if self.period == period {
            parents.above_any(changed.iter().copied())
        } else {
            vec![true; self.clusters.len()]
        };
        self.period = period;
        self.find_loose(scene, &parents);

        let images = Images::new(self, scene, &parents, &affected);
        let mut shares = Shares { scene, known: HashMap::new() };
        let mut done = Restated::default();
        for i in (0..self.clusters.len()).filter(|&i| affected[i]) {
            done.clusters += 1;
            shares.restate(self, i);
            let stale = self.temporal == Temporal::Tight && !images.holds(self, scene, i);
            match (self.clusters[i].stale, stale) {
                (false, true) => done.invalidated.push(i as u32),
                (true, false) => done.revalidated.push(i as u32),
                _ => {}
            }
            let touched = self.temporal == Temporal::Tight && images.touched[i];
            let cluster = &mut self.clusters[i];
            cluster.stale = stale;
            cluster.eps = if touched { cluster.covered_eps } else { cluster.built_eps };
            let behaviour_of = |built| if stale { built } else { images.only(i, built) };
            let first = cluster.first_index as usize;
            for layer in &mut cluster.layers {
                let moved = match &mut self.indices {
                    Indices::Short(table) => {
                        layer.restate(&mut table[first..], &scene.behaviours, behaviour_of)
                    }
                    Indices::Long(table) => {
                        layer.restate(&mut table[first..], &scene.behaviours, behaviour_of)
                    }
                };
                done.dirty.extend(moved.map(|r| first + r.start as usize..first + r.end as usize));
            }
        }
        Ok(done)
    }

    /// Number of clusters that do not hold.
    pub fn stale_count(&self) -> usize {
        self.clusters.iter().filter(|c| c.stale).count()
    }

    /// Elements that the build left out, because they were never present, and that are now.
    fn find_loose(&mut self, scene: &Scene, parents: &Parents) {
        let loose = scene.element_behaviour.iter().enumerate().filter(|&(i, now)| {
            let id = ElementId(i as u32);
            parents.of_element[i] == Parents::NONE
                && self.root != Some(Node::Leaf(id))
                && scene.behaviours[now.index()] != Behaviour::never()
                && scene.model.triangles_of(&scene.model.elements[i]) > 0
        });
        self.loose = loose.map(|(i, _)| ElementId(i as u32)).collect();
    }
}

/// The way up a tree.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Parents {
    of_cluster: Vec<u32>,
    of_element: Vec<u32>,
}

impl Parents {
    const NONE: u32 = u32::MAX;

    /// Those of all nodes.
    pub fn of(hdlod: &Hdlod) -> Self {
        let mut parents = Self {
            of_cluster: vec![Self::NONE; hdlod.clusters.len()],
            of_element: vec![Self::NONE; hdlod.built.len()],
        };
        for (i, cluster) in (0..).zip(&hdlod.clusters) {
            for child in hdlod.children_of(cluster) {
                match child {
                    Node::Leaf(id) => parents.of_element[id.index()] = i,
                    Node::Cluster(c) => parents.of_cluster[*c as usize] = i,
                }
            }
        }
        parents
    }

    /// The clusters above a node, lowest first.
    pub fn above(&self, node: Node) -> impl Iterator<Item = u32> + '_ {
        let real = |i: u32| (i != Self::NONE).then_some(i);
        let first = match node {
            Node::Leaf(element) => self.of_element[element.index()],
            Node::Cluster(cluster) => self.of_cluster[cluster as usize],
        };
        std::iter::successors(real(first), move |&i| real(self.of_cluster[i as usize]))
    }

    /// For each cluster whether it is above any of the elements.
    fn above_any(&self, elements: impl Iterator<Item = ElementId>) -> Vec<bool> {
        let mut above = vec![false; self.of_cluster.len()];
        for element in elements {
            for cluster in self.above(Node::Leaf(element)) {
                if std::mem::replace(&mut above[cluster as usize], true) {
                    break;
                }
            }
        }
        above
    }
}

/// The exact f of clusters, kept until their parent has used it.
struct Shares<'a> {
    scene: &'a Scene,
    known: HashMap<u32, StepFunction>,
}

impl Shares<'_> {
    /// H6 and H7 for one cluster; its affected children must have been done before.
    fn restate(&mut self, hdlod: &mut Hdlod, index: usize) {
        let children = hdlod.children_of(&hdlod.clusters[index]);
        let known: Vec<_> = children.iter().map(|child| self.take(*child)).collect();
        let parts: Vec<StepFunction> = known
            .into_par_iter()
            .zip(children)
            .map(|(known, child)| known.unwrap_or_else(|| exact_share(hdlod, self.scene, *child)))
            .collect();
        let share = StepFunction::sum(&parts);
        let gamma_below = |node: &Node| match node {
            Node::Leaf(_) => 0.0,
            Node::Cluster(c) => hdlod.clusters[*c as usize].gamma,
        };
        let gamma = children
            .par_iter()
            .zip(&parts)
            .map(|(c, part)| gamma_below(c) + share.mean_difference(part, hdlod.period))
            .reduce(|| 0.0, f64::max);
        let cluster = &mut hdlod.clusters[index];
        cluster.gamma = gamma;
        cluster.presence = BoundedStep::new(&share, MAX_STEPS);
        self.known.insert(index as u32, share);
    }

    fn take(&mut self, node: Node) -> Option<StepFunction> {
        match node {
            Node::Leaf(_) => None,
            Node::Cluster(c) => self.known.remove(&c),
        }
    }
}

/// f of a node, from the elements below it.
fn exact_share(hdlod: &Hdlod, scene: &Scene, node: Node) -> StepFunction {
    let mut objects = Vec::new();
    let mut open = vec![node];
    while let Some(node) = open.pop() {
        match node {
            Node::Leaf(id) => {
                let weight = presence_weight(&scene.model.elements[id.index()]);
                objects.push((scene.behaviour(id), weight));
            }
            Node::Cluster(c) => open.extend(hdlod.children_of(&hdlod.clusters[c as usize])),
        }
    }
    StepFunction::of_all(objects)
}

/// What became of built behaviours, for each affected cluster by the elements below it.
pub(super) struct Images {
    /// Built behaviours that some element left.
    left: HashSet<BehaviourId>,
    /// Keyed by cluster and built behaviour, for those in `left`: the behaviours now, each once.
    now: HashMap<(u32, BehaviourId), Vec<BehaviourId>>,
    /// For each cluster whether the behaviour of an element below it is not the built one.
    touched: Vec<bool>,
}

impl Images {
    pub fn new(hdlod: &Hdlod, scene: &Scene, parents: &Parents, affected: &[bool]) -> Self {
        let pairs = || hdlod.built.iter().copied().zip(scene.element_behaviour.iter().copied());
        let left: HashSet<_> = pairs().filter(|(b, now)| b != now).map(|(b, _)| b).collect();
        let mut images: HashMap<_, Vec<BehaviourId>> = HashMap::new();
        for (element, (built, now)) in (0..).map(ElementId).zip(pairs()) {
            if !left.contains(&built) {
                continue;
            }
            for cluster in parents.above(Node::Leaf(element)).filter(|&c| affected[c as usize]) {
                let list = images.entry((cluster, built)).or_default();
                if !list.contains(&now) {
                    list.push(now);
                }
            }
        }
        let moved = (0..).map(ElementId).zip(pairs()).filter(|(_, (built, now))| built != now);
        let touched = parents.above_any(moved.map(|(element, _)| element));
        Self { left, now: images, touched }
    }

    fn of(&self, cluster: usize, built: BehaviourId) -> Option<&[BehaviourId]> {
        if !self.left.contains(&built) {
            return None;
        }
        self.now.get(&(cluster as u32, built)).map(Vec::as_slice)
    }

    /// The image of a behaviour that has one only.
    fn only(&self, cluster: usize, built: BehaviourId) -> BehaviourId {
        self.of(cluster, built).map_or(built, |images| images[0])
    }

    /// The pairs of a cluster that holds, in terms of the behaviours now.
    pub fn pairs(&self, cluster: usize, pairs: &[Pair]) -> Vec<Pair> {
        let mut now: Vec<Pair> = Vec::with_capacity(pairs.len());
        for &(keeper, covered) in pairs {
            let keeper = self.only(cluster, keeper);
            let unmoved = [covered];
            let covered = self.of(cluster, covered).unwrap_or(&unmoved).iter();
            now.extend(covered.filter(|&&c| c != keeper).map(|&c| (keeper, c)));
        }
        now.sort_unstable();
        now.dedup();
        now
    }

    /// (a), (b) and (c) of this file's head. The clusters below must have been done before.
    fn holds(&self, hdlod: &Hdlod, scene: &Scene, index: usize) -> bool {
        let cluster = &hdlod.clusters[index];
        let below = hdlod.children_of(cluster).iter().all(|child| match child {
            Node::Leaf(_) => true,
            Node::Cluster(c) => !hdlod.clusters[*c as usize].stale,
        });
        let single = |built| self.of(index, built).is_none_or(|images| images.len() == 1);
        below
            && cluster.layers.iter().flat_map(|l| &l.runs).all(|run| single(run.built))
            && cluster.pairs.iter().all(|&pair| self.pair_holds(scene, index, pair))
    }

    fn pair_holds(&self, scene: &Scene, cluster: usize, (keeper, covered): Pair) -> bool {
        let (keeper_now, covered_now) = (self.of(cluster, keeper), self.of(cluster, covered));
        if keeper_now.is_none() && covered_now.is_none() {
            return true;
        }
        let keeper = &scene.behaviours[self.only(cluster, keeper).index()];
        let covers = |b: &BehaviourId| keeper.includes(&scene.behaviours[b.index()]);
        keeper_now.is_none_or(|images| images.len() == 1)
            && covered_now.unwrap_or(&[covered]).iter().all(covers)
    }
}

/// A behaviour that was kept and one that it covers: the first includes the second (R11).
pub type Pair = (BehaviourId, BehaviourId);
