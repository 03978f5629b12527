//! Generation (Fig. 5; H11 to H15, R9): level by level, bottom-up.

use super::certify::{self, Limits};
use super::contract::{self, Joins};
use super::cover::{Simplified, simplify};
use super::grouping::group;
use super::ladder::Ladder;
use super::palette::Palette;
use super::presence::{PresenceTable, presence_weight};
use super::restate::Pair;
use super::soup::{Geometry, Triangle, append_instance};
use super::{Cluster, Hdlod, LevelStats, MAX_STEPS, Node, Settings, Simplifier, Temporal};
use crate::{Aabb, Cancelled, ElementId, Progress, Scene};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;
use topout_schedule::{Behaviour, BoundedStep, StepFunction};

/// A cluster is measured against those descendants whose own error is at most this share of its
/// threshold: the chain of H5 then spends little, and the work stays that of a few levels. On a
/// demo of 20,000 elements 0.4 draws 5 % more triangles at 1/1 and as many at 1/4.
pub(super) const SOURCE_SHARE: f32 = 0.2;

/// A parent must draw at most this share of its children's triangles; otherwise they stay active
/// and are tried again at the next, coarser level (H14: complexity falls with level).
const WORTHWHILE: f32 = 0.75;

/// An active node with at least this many triangles that found no neighbour is simplified on its
/// own: a crane's lattice is larger than most groups may be and would otherwise be drawn in full.
const ALONE_TRIANGLES: usize = 192;

/// A node on its own is tried again once the threshold is this many times its error.
const ALONE_STEP: f32 = 2.5;

/// The error of a step is known to this factor, or known to be below that share of what the covers
/// prove.
const TIGHT: f32 = 1.15;
const NEGLIGIBLE: f32 = 0.3;

/// Largest error of the root as a share of its diameter.
const COARSEST_SHARE: f32 = 0.05;

/// Of so many groups one is tried first: where none gains anything, as at the millimetres of the
/// first levels, the level makes nothing.
const SAMPLED: usize = 32;

/// A node under construction. Leaves carry no geometry: it is taken from the scene.
struct Draft {
    node: Node,
    bounds: Aabb,
    eps: f32,
    /// See [`Cluster::covered_eps`].
    covered_eps: f32,
    gamma: f64,
    weight: f64,
    triangles: usize,
    leaves: u32,
    /// Exact while the node is active, nothing afterwards.
    presence: StepFunction,
    cluster: Option<Box<Inner>>,
}

struct Inner {
    children: Vec<u32>,
    geometry: Geometry,
    presence: BoundedStep,
    pairs: Box<[Pair]>,
    level: u32,
}

/// Everything that stays fixed during a build.
struct Ground<'a> {
    scene: &'a Scene,
    presence: PresenceTable<'a>,
    palette: Palette,
    temporal: Temporal,
    simplifier: Simplifier,
    ladder: Ladder,
}

impl Ground<'_> {
    fn simplify(
        &self,
        source: &[Triangle],
        budget_m: f32,
        progress: &Progress,
    ) -> Result<Simplified, Cancelled> {
        let joins = match self.simplifier {
            Simplifier::Covers => {
                return simplify(source, budget_m, &self.presence, &self.palette, progress);
            }
            Simplifier::Edges => Joins::Edges,
            Simplifier::Pairs => Joins::Pairs,
        };
        contract::simplify(source, budget_m, joins, &self.presence, progress)
    }
}

/// Builds the tree on the calling thread and rayon's pool. The result does not depend on the
/// number of threads.
///
/// # Errors
/// Only when `progress` is cancelled.
pub fn build(scene: &Scene, settings: &Settings, progress: &Progress) -> Result<Hdlod, Cancelled> {
    progress.begin("HDLOD: leaves", 0)?;
    let mut drafts = leaves(scene);
    let total_bounds = drafts.iter().fold(Aabb::EMPTY, |b, d| b.union(&d.bounds));
    let events: BTreeSet<_> = scene.behaviours.iter().flat_map(Behaviour::toggles).collect();
    let sizes = drafts.iter().map(|d| d.weight as f32).collect();
    let ground = Ground {
        scene,
        presence: PresenceTable::new(&scene.behaviours, settings.temporal == Temporal::Tight),
        palette: Palette::new(&scene.model.materials),
        temporal: settings.temporal,
        simplifier: settings.simplifier,
        ladder: Ladder::new(total_bounds.diameter(), sizes, events.len(), scene.schedule.period),
    };

    let mut active: Vec<u32> = (0..drafts.len() as u32).collect();
    let mut stats = Vec::new();
    let mut level = 0;
    while active.len() > 1 || worth_going_on(&ground, &drafts, &active, level) {
        level += 1;
        // Once a group may be as large as the scene every pass divides the active nodes.
        let merged = merge_level(&ground, level, &drafts, &active, progress)?;
        let mut passive = vec![false; drafts.len()];
        let mut parents = Vec::with_capacity(merged.len());
        for draft in merged {
            let inner = draft.cluster.as_ref().expect("merging makes clusters");
            for &child in &inner.children {
                passive[child as usize] = true;
                drafts[child as usize].presence = StepFunction::default();
            }
            parents.push(drafts.len() as u32);
            drafts.push(draft);
        }
        active.retain(|&i| !passive[i as usize]);
        active.extend_from_slice(&parents);
        if parents.is_empty() && active.len() == 1 {
            // The root would not become any coarser here.
            continue;
        }
        stats.push(LevelStats {
            level,
            eps_m: ground.ladder.eps_m(level),
            gamma_limit: ground.ladder.gamma(level),
            clusters: parents.len(),
            active: active.len(),
            triangles: active.iter().map(|&i| drafts[i as usize].triangles).sum(),
        });
    }
    progress.begin("HDLOD: tables", 0)?;
    let mut tree = finish(drafts, active.first().copied(), settings, stats);
    tree.built.clone_from(&scene.element_behaviour);
    tree.period = scene.schedule.period;
    Ok(tree)
}

/// Whether the root may still become coarser: "root clusters can be simplified further" (R9), as
/// long as its error is small against the scene.
fn worth_going_on(ground: &Ground, drafts: &[Draft], active: &[u32], level: u32) -> bool {
    active.iter().any(|&i| {
        let draft = &drafts[i as usize];
        draft.triangles >= ALONE_TRIANGLES
            && ground.ladder.eps_m(level + 1) <= draft.bounds.diameter() * COARSEST_SHARE
    })
}

/// One leaf an element that is ever present (H4): its own behaviour, no error.
fn leaves(scene: &Scene) -> Vec<Draft> {
    let mut result = Vec::with_capacity(scene.model.elements.len());
    for (i, element) in scene.model.elements.iter().enumerate() {
        let id = ElementId(i as u32);
        let behaviour = scene.element_behaviour[i];
        let behaviour = &scene.behaviours[behaviour.index()];
        let never = *behaviour == Behaviour::never();
        let triangles = scene.model.triangles_of(element);
        if never || triangles == 0 {
            continue;
        }
        result.push(Draft {
            node: Node::Leaf(id),
            bounds: element.bounds,
            eps: 0.0,
            covered_eps: 0.0,
            gamma: 0.0,
            // R2: the diameter of the object's box; sums over clusters.
            weight: f64::from(element.bounds.diameter()),
            triangles,
            leaves: 1,
            presence: StepFunction::of(behaviour, presence_weight(element)),
            cluster: None,
        });
    }
    result
}

fn merge_level(
    ground: &Ground,
    level: u32,
    drafts: &[Draft],
    active: &[u32],
    progress: &Progress,
) -> Result<Vec<Draft>, Cancelled> {
    let bounds: Vec<Aabb> = active.iter().map(|&i| drafts[i as usize].bounds).collect();
    let gamma_limit = ground.ladder.gamma(level);
    let period = ground.scene.schedule.period;
    let mut groups =
        group(&bounds, ground.ladder.diameter_m(level), |a, b| match ground.temporal {
            Temporal::Tight => Some(0.0),
            Temporal::Paper => {
                let (a, b) = (&drafts[active[a] as usize], &drafts[active[b] as usize]);
                let apart = a.presence.mean_difference(&b.presence, period);
                (apart <= gamma_limit).then_some(apart as f32)
            }
        });
    let alone = loners(ground.ladder.eps_m(level), drafts, active, &groups);
    groups.extend(alone);
    let triangles_of = |members: &[u32]| -> usize {
        members.iter().map(|&i| drafts[active[i as usize] as usize].triangles).sum()
    };
    let total: usize = groups.iter().map(|g| triangles_of(g)).sum();
    progress.begin(&format!("HDLOD: level {level}, {} groups", groups.len()), total as u64)?;
    let merge_all = |groups: &[Vec<u32>]| -> Result<Vec<Draft>, Cancelled> {
        let merged: Result<Vec<Option<Draft>>, Cancelled> = groups
            .par_iter()
            .map(|members| {
                progress.check()?;
                let children: Vec<u32> = members.iter().map(|&i| active[i as usize]).collect();
                let parent = merge(ground, level, drafts, children, progress)?;
                progress.advance(triangles_of(members) as u64)?;
                Ok(parent)
            })
            .collect();
        Ok(merged?.into_iter().flatten().collect())
    };
    if groups.len() > SAMPLED * SAMPLED {
        let sample: Vec<Vec<u32>> = groups.iter().step_by(SAMPLED).cloned().collect();
        if merge_all(&sample)?.is_empty() {
            return Ok(Vec::new());
        }
    }
    merge_all(&groups)
}

/// Active nodes outside all groups that are rich enough to be simplified alone.
fn loners(limit: f32, drafts: &[Draft], active: &[u32], groups: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut grouped = vec![false; active.len()];
    groups.iter().flatten().for_each(|&i| grouped[i as usize] = true);
    (0..active.len() as u32)
        .filter(|&i| {
            let draft = &drafts[active[i as usize] as usize];
            !grouped[i as usize]
                && draft.triangles >= ALONE_TRIANGLES
                && draft.eps * ALONE_STEP <= limit
        })
        .map(|i| vec![i])
        .collect()
}

/// Makes the parent of `children`, if it meets the level's thresholds and is worth drawing.
fn merge(
    ground: &Ground,
    level: u32,
    drafts: &[Draft],
    children: Vec<u32>,
    progress: &Progress,
) -> Result<Option<Draft>, Cancelled> {
    let limit = ground.ladder.eps_m(level);
    let members = || children.iter().map(|&i| &drafts[i as usize]);

    // H6, H7: the mean behaviour and how far its parts are from it.
    let presence = StepFunction::sum(members().map(|d| &d.presence));
    let period = ground.scene.schedule.period;
    let gamma = members()
        .map(|d| d.gamma + presence.mean_difference(&d.presence, period))
        .fold(0.0, f64::max);
    if ground.temporal == Temporal::Paper
        && gamma > ground.ladder.gamma(level)
        && !ground.ladder.is_beyond(level)
    {
        return Ok(None);
    }

    let mut source = Vec::new();
    let mut below = Below::default();
    for &child in &children {
        gather(ground, drafts, child, limit * SOURCE_SHARE, &mut source, &mut below);
    }
    let budget = limit - below.covered_eps;
    let simplified = ground.simplify(&source, budget, progress)?;
    let before: usize = members().map(|d| d.triangles).sum();
    let after = simplified.triangles.len();
    let worthwhile = after as f32 <= before as f32 * WORTHWHILE;
    // Beyond L groups are made in any case: the tree must end in one root (R9).
    if !worthwhile && (children.len() == 1 || !ground.ladder.is_beyond(level)) {
        return Ok(None);
    }

    // H5, with the descendants that were measured in place of the children; grows to the root.
    let step = proved_m(&simplified, &source, &ground.presence, progress);
    let eps = members().map(|d| d.eps).fold(below.eps + step, f32::max);
    let covered = below.covered_eps + simplified.distance_m;
    let covered_eps = members().map(|d| d.covered_eps).fold(covered, f32::max);
    let geometry = Geometry::new(simplified.triangles, &ground.presence);
    let drawn = Aabb::of_points(geometry.vertices.iter().map(|v| v.position.into()));
    Ok(Some(Draft {
        node: Node::Cluster(u32::MAX),
        bounds: members().fold(drawn, |b, d| b.union(&d.bounds)),
        eps,
        covered_eps,
        gamma,
        weight: members().map(|d| d.weight).sum(),
        triangles: after,
        leaves: members().map(|d| d.leaves).sum(),
        cluster: Some(Box::new(Inner {
            children,
            geometry,
            presence: BoundedStep::new(&presence, MAX_STEPS),
            pairs: match ground.temporal {
                Temporal::Tight => simplified.pairs.into(),
                Temporal::Paper => Box::default(),
            },
            level,
        })),
        presence,
    }))
}

/// The error of the geometry that a cluster is measured against.
#[derive(Clone, Copy, Default)]
pub(super) struct Below {
    pub eps: f32,
    pub covered_eps: f32,
}

impl Below {
    pub fn include(&mut self, eps: f32, covered_eps: f32) {
        self.eps = self.eps.max(eps);
        self.covered_eps = self.covered_eps.max(covered_eps);
    }
}

/// The distance of what was simplified from its source, by branch and bound (R10): the covers prove
/// theirs piece by piece, and another triangle may be nearer. Never more than theirs.
pub(super) fn proved_m(
    simplified: &Simplified,
    source: &[Triangle],
    presence: &PresenceTable,
    progress: &Progress,
) -> f32 {
    let covered = simplified.distance_m;
    let limits = Limits {
        accept: covered * NEGLIGIBLE,
        ratio: TIGHT,
        give_up_above: covered,
        progress: Some(progress),
    };
    certify::distance(&simplified.triangles, source, presence, limits).upper.min(covered)
}

/// Collects the geometry of the coarsest descendants whose error is at most `eps`.
fn gather(
    ground: &Ground,
    drafts: &[Draft],
    node: u32,
    eps: f32,
    out: &mut Vec<Triangle>,
    below: &mut Below,
) {
    let draft = &drafts[node as usize];
    match (&draft.cluster, draft.node) {
        (Some(inner), _) if draft.covered_eps <= eps => {
            inner.geometry.append_triangles(out);
            below.include(draft.eps, draft.covered_eps);
        }
        (Some(inner), _) => {
            for &child in &inner.children {
                gather(ground, drafts, child, eps, out, below);
            }
        }
        (None, Node::Leaf(id)) => {
            let model = &ground.scene.model;
            let behaviour = ground.scene.element_behaviour[id.index()];
            for instance in model.instances_of(&model.elements[id.index()]) {
                append_instance(instance, &model.meshes[instance.mesh.index()], behaviour, out);
            }
        }
        (None, Node::Cluster(_)) => unreachable!("a draft without a cluster is a leaf"),
    }
}

/// Lays the drafts out in tables.
fn finish(
    drafts: Vec<Draft>,
    root: Option<u32>,
    settings: &Settings,
    levels: Vec<LevelStats>,
) -> Hdlod {
    let mut nodes = Vec::with_capacity(drafts.len());
    let mut result = Hdlod { temporal: settings.temporal, levels, ..Hdlod::default() };
    for draft in drafts {
        let Some(inner) = draft.cluster else {
            nodes.push(draft.node);
            continue;
        };
        nodes.push(Node::Cluster(result.clusters.len() as u32));
        let first_child = result.children.len() as u32;
        result.children.extend(inner.children.iter().map(|&c| nodes[c as usize]));
        result.clusters.push(Cluster {
            children: first_child..result.children.len() as u32,
            bounds: draft.bounds,
            eps: draft.eps,
            built_eps: draft.eps,
            covered_eps: draft.covered_eps,
            gamma: draft.gamma,
            weight: draft.weight,
            presence: inner.presence,
            pairs: inner.pairs,
            stale: false,
            level: inner.level,
            leaves: draft.leaves,
            first_index: result.indices.len() as u32,
            base_vertex: result.vertices.len() as u32,
            layers: inner.geometry.layers,
        });
        Arc::make_mut(&mut result.vertices).extend_from_slice(&inner.geometry.vertices);
        result.indices.append(inner.geometry.indices);
    }
    result.root = root.map(|r| nodes[r as usize]);
    result
}
