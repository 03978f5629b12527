//! Clusters against their definitions: structure, share present, weight, eps and gamma.

use super::geometry;
use super::tree::{Item, Present, Tree};
use super::{Finding, Kind, Plan, Random, Report};
use crate::hdlod::{Cluster, Hdlod, Node, Temporal, select};
use crate::{Aabb, Cancelled, ElementId, Progress, Scene};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use topout_schedule::{Behaviour, Share, Time};

/// Rounding of 32-bit coordinates: this share of the largest one is no violation.
const COORDINATE_ROUNDING: f32 = 2.0 * f32::EPSILON;

/// Rounding of shares, which are f32 and are averaged level by level.
const SHARE_ROUNDING: f64 = 2e-5;

/// Points on the smallest clusters, where the plan allows as many.
const FEWEST_POINTS: usize = 1000;

/// Dates at which a cluster's ranges are counted.
const RANGE_DATES: usize = 24;

/// What was found at one cluster.
#[derive(Default)]
struct Verdict {
    findings: Vec<Finding>,
    /// Largest distance measured, as a share of eps; `None` where eps is 0.
    eps_share: Option<f32>,
}

/// Checks a sample. False where the tree does not hold together, so that nothing can be drawn.
pub(super) fn check(
    scene: &Scene,
    hdlod: &Hdlod,
    plan: &Plan,
    progress: &Progress,
    report: &mut Report,
) -> Result<bool, Cancelled> {
    progress.begin("verify: structure", 0)?;
    if let Err(message) = shape(scene, hdlod) {
        report.structure_violations += 1;
        report.tell(Finding { kind: Kind::Structure, message });
        return Ok(false);
    }
    let chosen = sample(hdlod.clusters.len(), plan);
    let work = |i: usize| effort(&hdlod.clusters[i], plan);
    let total = chosen.iter().map(|&i| work(i)).sum();
    progress.begin(&format!("verify: {} clusters", chosen.len()), total)?;
    // Small jobs, and the large clusters (they come last) not all in one of them.
    let verdicts: Result<Vec<Verdict>, Cancelled> = chosen
        .par_iter()
        .with_max_len(1)
        .map(|&i| {
            progress.check()?;
            let verdict = Check::new(scene, hdlod, plan, i).run(progress)?;
            progress.advance(work(i))?;
            Ok(verdict)
        })
        .collect();
    let verdicts = verdicts?;
    report.clusters_checked = verdicts.len();
    let mut shares: Vec<f32> = verdicts.iter().filter_map(|v| v.eps_share).collect();
    shares.sort_by(f32::total_cmp);
    report.median_eps_share = shares.get(shares.len() / 2).copied().unwrap_or(0.0);
    for verdict in verdicts {
        let has = |kind| usize::from(verdict.findings.iter().any(|f| f.kind == kind));
        report.structure_violations += has(Kind::Structure);
        report.eps_violations += has(Kind::Eps);
        report.gamma_violations += has(Kind::Gamma);
        verdict.findings.into_iter().for_each(|f| report.tell(f));
    }
    Ok(true)
}

/// What a cluster's check takes beside that of others, about: all leaves are read, and so many points
/// measured.
fn effort(cluster: &Cluster, plan: &Plan) -> u64 {
    /// Triangles of an element, as a rule.
    const TRIANGLES: u64 = 40;
    let triangles = u64::from(cluster.leaves) * TRIANGLES;
    let points = triangles.saturating_mul(plan.triangle_points as u64);
    triangles + points.min(plan.cluster_points as u64).max(FEWEST_POINTS as u64)
}

/// Places of the clusters to check, in rising order.
fn sample(clusters: usize, plan: &Plan) -> Vec<usize> {
    if plan.clusters >= clusters {
        return (0..clusters).collect();
    }
    let mut random = Random::new(plan.seed, 0);
    let mut places: Vec<usize> = (0..clusters).collect();
    for i in 0..plan.clusters {
        let other = i + random.below(clusters - i);
        places.swap(i, other);
    }
    places.truncate(plan.clusters);
    // The coarsest ones stand for the most.
    places.extend(clusters.saturating_sub(plan.clusters / 50)..clusters);
    places.sort_unstable();
    places.dedup();
    places
}

/// One root above every element that is ever there, apart from loose ones, each once; indices that point somewhere (R9).
fn shape(scene: &Scene, hdlod: &Hdlod) -> Result<(), String> {
    let mut seen = vec![0u32; scene.model.elements.len()];
    let mut used = vec![0u32; hdlod.clusters.len()];
    let mut open: Vec<Node> = hdlod.root.into_iter().collect();
    while let Some(node) = open.pop() {
        match node {
            Node::Leaf(id) => {
                let count = seen.get_mut(id.index()).ok_or("a leaf is no element")?;
                *count += 1;
            }
            Node::Cluster(i) => {
                let count = used.get_mut(i as usize).ok_or("a child is no cluster")?;
                *count += 1;
                if *count > 1 {
                    return Err(format!("cluster {i} has two parents"));
                }
                let cluster = &hdlod.clusters[i as usize];
                let children = cluster.children.start as usize..cluster.children.end as usize;
                let children = hdlod.children.get(children).ok_or("children out of range")?;
                if children.iter().any(|c| matches!(c, Node::Cluster(c) if *c >= i)) {
                    return Err(format!("cluster {i} stands before one of its children"));
                }
                open.extend_from_slice(children);
            }
        }
    }
    for id in &hdlod.loose {
        *seen.get_mut(id.index()).ok_or("a loose leaf is no element")? += 1;
    }
    if let Some(i) = used.iter().position(|&count| count == 0) {
        return Err(format!("cluster {i} is not below the root"));
    }
    for (i, &count) in seen.iter().enumerate() {
        let id = ElementId(i as u32);
        let element = &scene.model.elements[i];
        let ever = *scene.behaviour(id) != Behaviour::never();
        let needed = ever && scene.model.triangles_of(element) > 0;
        if count > 1 || (needed && count == 0) {
            return Err(format!("element {i} ({}) is {count} leaves", element.name));
        }
    }
    for (i, cluster) in hdlod.clusters.iter().enumerate() {
        for (_, run, range) in cluster.runs() {
            if cluster.stale {
                continue;
            }
            if range.end > hdlod.indices.len() {
                return Err(format!("cluster {i}: bad range"));
            }
            let vertex = |v: u32| hdlod.vertices.get((cluster.base_vertex() + v) as usize);
            let finite = |v| vertex(v).is_some_and(|v| v.position.iter().all(|x| x.is_finite()));
            if range.len() % 3 != 0 || !hdlod.indices.range(range).all(finite) {
                return Err(format!("cluster {i}: bad vertices"));
            }
            if scene.behaviours.get(run.behaviour.index()).is_none() {
                return Err(format!("cluster {i}: unknown behaviour"));
            }
        }
    }
    Ok(())
}

/// The check of one cluster.
struct Check<'a> {
    scene: &'a Scene,
    hdlod: &'a Hdlod,
    plan: &'a Plan,
    index: usize,
    cluster: &'a Cluster,
    leaves: Vec<ElementId>,
    random: Random,
    verdict: Verdict,
}

impl<'a> Check<'a> {
    fn new(scene: &'a Scene, hdlod: &'a Hdlod, plan: &'a Plan, index: usize) -> Self {
        let cluster = &hdlod.clusters[index];
        let mut leaves = Vec::with_capacity(cluster.leaves as usize);
        let mut open = vec![Node::Cluster(index as u32)];
        while let Some(node) = open.pop() {
            match node {
                Node::Leaf(id) => leaves.push(id),
                Node::Cluster(i) => {
                    open.extend_from_slice(hdlod.children_of(&hdlod.clusters[i as usize]));
                }
            }
        }
        let random = Random::new(plan.seed, index as u64 + 1);
        Self { scene, hdlod, plan, index, cluster, leaves, random, verdict: Verdict::default() }
    }

    fn find(&mut self, kind: Kind, message: &str) {
        let (index, level) = (self.index, self.cluster.level);
        let message = format!("cluster {index} (level {level}): {message}");
        self.verdict.findings.push(Finding { kind, message });
    }

    fn run(mut self, progress: &Progress) -> Result<Verdict, Cancelled> {
        // What is never drawn promises nothing.
        let drawn = !(self.cluster.stale && self.hdlod.temporal == Temporal::Tight);
        if drawn {
            self.ranges();
        }
        let dates = self.dates(self.plan.cluster_dates);
        self.structure();
        self.shares(&dates);
        self.gamma();
        progress.check()?;
        if drawn {
            self.eps(&dates, progress)?;
        }
        Ok(self.verdict)
    }

    /// Some instants at which something below changes, and the last one of the period.
    fn dates(&mut self, most: usize) -> Vec<Time> {
        let behaviours: BTreeSet<_> =
            self.leaves.iter().map(|id| self.scene.element_behaviour[id.index()]).collect();
        let changes: BTreeSet<Time> = behaviours
            .iter()
            .flat_map(|b| self.scene.behaviours[b.index()].toggles())
            .copied()
            .collect();
        let changes: Vec<Time> = changes.into_iter().collect();
        let mut dates = vec![self.scene.schedule.period.end.plus_seconds(-1)];
        for _ in 1..most {
            if !changes.is_empty() {
                // At the instant of a change and just before it.
                let before = -((self.random.next() % 2) as i64);
                dates.push(changes[self.random.below(changes.len())].plus_seconds(before));
            }
        }
        dates.sort_unstable();
        dates.dedup();
        dates
    }

    /// What is drawn at a date is what the ranges of the behaviours present then hold, in number
    /// (R11). Cheap, so at more dates than the rest.
    fn ranges(&mut self) {
        if self.hdlod.temporal == Temporal::Paper {
            return;
        }
        for time in self.dates(RANGE_DATES) {
            let there = |b: crate::BehaviourId| self.scene.behaviours[b.index()].at(time);
            let runs = self.cluster.runs().filter(|(_, run, _)| there(run.behaviour));
            let expected: usize = runs.map(|(_, _, range)| range.len()).sum();
            let mut drawn = 0;
            select::spans(self.scene, self.hdlod, self.cluster, time, |span| {
                drawn += span.index_count as usize;
            });
            if drawn != expected {
                let message = format!("draws {drawn} indices at {time}, its ranges say {expected}");
                self.find(Kind::Structure, &message);
                return;
            }
        }
    }

    /// Boxes (R7), weights (R2), counts, and errors that grow toward the root (H5, H6).
    fn structure(&mut self) {
        let cluster = self.cluster;
        for &child in self.hdlod.children_of(cluster) {
            let Node::Cluster(i) = child else { continue };
            let child = &self.hdlod.clusters[i as usize];
            if child.eps > cluster.eps {
                self.find(
                    Kind::Eps,
                    &format!("eps {} below its child's {}", cluster.eps, child.eps),
                );
            }
            if child.gamma > cluster.gamma {
                self.find(Kind::Gamma, &format!("gamma {} below its child's", cluster.gamma));
            }
            if !encloses(&cluster.bounds, &child.bounds) {
                self.find(Kind::Structure, &format!("its box does not hold cluster {i}"));
            }
        }
        let elements = &self.scene.model.elements;
        let mut below = Aabb::EMPTY;
        let mut weight = 0f64;
        for id in &self.leaves {
            let bounds = &elements[id.index()].bounds;
            below = below.union(bounds);
            weight += f64::from(bounds.diameter());
        }
        let drawn = self.cluster.runs().flat_map(|(_, _, range)| self.hdlod.indices.range(range));
        let drawn = Aabb::of_points(drawn.map(|i| {
            Vec3::from(self.hdlod.vertices[(cluster.base_vertex() + i) as usize].position)
        }));
        if !encloses(&cluster.bounds, &below) || !encloses(&cluster.bounds, &drawn) {
            self.find(Kind::Structure, "its box does not hold what is below or drawn");
        }
        if (weight - cluster.weight).abs() > 1e-6 * weight.max(1.0) {
            self.find(Kind::Structure, &format!("weight {} is not {weight}", cluster.weight));
        }
        if self.leaves.len() != cluster.leaves as usize || self.leaves.is_empty() {
            self.find(Kind::Structure, &format!("{} leaves", self.leaves.len()));
        }
    }

    fn weight_of(&self, id: ElementId) -> f64 {
        f64::from(self.scene.model.elements[id.index()].bounds.diameter())
    }

    /// f_c against its definition, 0 and 1 exactly where it must be (H7, R13).
    fn shares(&mut self, dates: &[Time]) {
        let total: f64 = self.leaves.iter().map(|&id| self.weight_of(id)).sum();
        for &time in dates {
            let there = self.leaves.iter().filter(|id| self.scene.behaviour(**id).at(time));
            let (mut count, mut weight) = (0, 0.0);
            for &id in there {
                count += 1;
                weight += self.weight_of(id);
            }
            let Share { lo, hi } = self.cluster.presence.at(time);
            let exact = if total > 0.0 { weight / total } else { f64::from(lo) };
            let (none, all) = (count == 0, count == self.leaves.len());
            let wrong = f64::from(lo) > exact + SHARE_ROUNDING
                || f64::from(hi) < exact - SHARE_ROUNDING
                || (hi == 0.0 && !none)
                || (lo == 1.0 && !all)
                || (lo == hi && ((lo == 0.0) != none || (lo == 1.0) != all));
            if wrong {
                let message = format!("{lo} to {hi} present at {time} instead of {exact}");
                self.find(Kind::Structure, &message);
            }
        }
    }

    /// gamma against the largest mean of |f_c - f_leaf| over the period (H6), integrated exactly.
    fn gamma(&mut self) {
        let period = self.scene.schedule.period;
        let mut weights: BTreeMap<u32, f64> = BTreeMap::new();
        for &id in &self.leaves {
            let behaviour = self.scene.element_behaviour[id.index()];
            *weights.entry(behaviour.0).or_default() += self.weight_of(id);
        }
        let total: f64 = weights.values().sum();
        let length = period.seconds() as f64;
        if total <= 0.0 || length <= 0.0 {
            return;
        }
        let behaviour = |b: u32| &self.scene.behaviours[b as usize];
        // f_c as a sum of steps, and its integral from the period's start.
        let mut value: f64 =
            weights.iter().filter(|(b, _)| behaviour(**b).at(period.start)).map(|(_, w)| w).sum();
        let mut steps: Vec<(Time, f64)> = Vec::new();
        for (&b, &weight) in &weights {
            for &t in behaviour(b).toggles().iter().filter(|t| period.contains(**t)) {
                if t > period.start {
                    steps.push((t, if behaviour(b).at(t) { weight } else { -weight }));
                }
            }
        }
        steps.sort_by_key(|s| s.0);
        let seconds = |t: Time| (t.seconds() - period.start.seconds()) as f64;
        // (from, value from there on, integral up to there)
        let mut areas = vec![(0.0, value, 0.0)];
        for (time, change) in steps {
            let (from, before, area) = areas[areas.len() - 1];
            value += change;
            let at = seconds(time);
            areas.push((at, value, area + before * (at - from)));
        }
        let integral = |to: f64| {
            let (from, value, area) = areas[areas.partition_point(|a| a.0 <= to) - 1];
            (area + value * (to - from)) / total
        };
        let mut worst = 0f64;
        for &b in weights.keys() {
            let inside = behaviour(b).toggles().iter().filter(|t| period.contains(**t));
            let ends = inside.map(|&t| seconds(t)).chain([length]);
            let (mut from, mut on, mut sum) = (0.0, behaviour(b).at(period.start), 0.0);
            for to in ends {
                if to <= from {
                    continue;
                }
                let share = integral(to) - integral(from);
                sum += if on { (to - from) - share } else { share };
                (from, on) = (to, !on);
            }
            worst = worst.max(sum / length);
        }
        if self.cluster.gamma + SHARE_ROUNDING < worst {
            let message = format!("gamma {} where {worst} was measured", self.cluster.gamma);
            self.find(Kind::Gamma, &message);
        }
    }

    /// eps against points all over what is drawn and what is present, both ways (R10, R11).
    fn eps(&mut self, dates: &[Time], progress: &Progress) -> Result<(), Cancelled> {
        let mut items = Vec::new();
        for &id in &self.leaves {
            geometry::element(self.scene, id, &mut items);
        }
        let exact = Tree::new(items, progress)?;
        let reach = exact.items().iter().flat_map(|i| i.corners);
        let reach = reach.fold(0f32, |m, c| m.max(c.abs().max_element()));
        let allowed = f64::from(self.cluster.eps + reach * COORDINATE_ROUNDING);
        let mut worst = (0f64, String::new());
        match self.hdlod.temporal {
            // The union of everything, whatever the date: all that the paper's eps speaks of.
            Temporal::Paper => {
                let all = vec![true; self.scene.behaviours.len()];
                let mut drawn = Vec::new();
                for (layer, _, range) in self.cluster.runs() {
                    let span = crate::hdlod::Span {
                        first_index: range.start as u32,
                        index_count: range.len() as u32,
                        base_vertex: self.cluster.base_vertex(),
                        layer,
                        look: crate::LookId::OWN,
                    };
                    geometry::span(self.hdlod, &span, 0, &mut drawn);
                }
                self.compare(&exact, &all, drawn, "the whole period", &mut worst, progress)?;
            }
            Temporal::Tight => {
                for &time in dates {
                    progress.check()?;
                    let there: Vec<bool> =
                        self.scene.behaviours.iter().map(|b| b.at(time)).collect();
                    let mut drawn = Vec::new();
                    if self.cluster.presence.may_be_present(time) {
                        let (scene, hdlod) = (self.scene, self.hdlod);
                        select::spans(scene, hdlod, self.cluster, time, |span| {
                            geometry::span(hdlod, &span, 0, &mut drawn);
                        });
                    }
                    self.compare(&exact, &there, drawn, &time.to_string(), &mut worst, progress)?;
                }
            }
        }
        let (distance, what) = worst;
        if self.cluster.eps > 0.0 {
            self.verdict.eps_share = Some((distance / f64::from(self.cluster.eps)) as f32);
        }
        if distance > allowed {
            let message = format!("eps {} m, but {distance:.5} m {what}", self.cluster.eps);
            self.find(Kind::Eps, &message);
        }
        Ok(())
    }

    /// Measures what is drawn against what is there, both ways.
    fn compare(
        &mut self,
        exact: &Tree,
        there: &[bool],
        drawn: Vec<Item>,
        when: &str,
        worst: &mut (f64, String),
        progress: &Progress,
    ) -> Result<(), Cancelled> {
        let drawn = Tree::new(drawn, progress)?;
        let present = exact.present(there);
        let shown = drawn.present(&[true]);
        let leaves: Vec<&Item> = exact.items().iter().filter(|i| there[i.tag as usize]).collect();
        let made: Vec<&Item> = drawn.items().iter().collect();
        self.one_way(
            &leaves,
            &shown,
            &format!("from something present to what is drawn, {when}"),
            worst,
        );
        self.one_way(
            &made,
            &present,
            &format!("from something drawn to what is present, {when}"),
            worst,
        );
        Ok(())
    }

    fn one_way(&mut self, from: &[&Item], to: &Present, what: &str, worst: &mut (f64, String)) {
        let most = from.len().saturating_mul(self.plan.triangle_points);
        let most = most.max(FEWEST_POINTS).min(self.plan.cluster_points);
        for (point, owner) in points_on(from, most, &mut self.random) {
            if let Some(distance) = to.farther(point, worst.0) {
                *worst = (distance, format!("{what}, at {point:.3} (element {owner})"));
            }
        }
    }
}

/// Corners, and points spread evenly over the area, about `most` together.
fn points_on(items: &[&Item], most: usize, random: &mut Random) -> Vec<(DVec3, u32)> {
    let mut points = Vec::with_capacity(most + 3);
    if items.is_empty() {
        return points;
    }
    let corners = |item: &Item| item.corners.map(|c| c.as_dvec3());
    if items.len() * 6 <= most {
        points.extend(items.iter().flat_map(|i| corners(i).map(|c| (c, i.owner))));
    } else {
        for _ in 0..most / 6 {
            let item = items[random.below(items.len())];
            points.extend(corners(item).map(|c| (c, item.owner)));
        }
    }
    let mut sum = 0.0;
    let sums: Vec<f64> = items
        .iter()
        .map(|i| {
            let [a, b, c] = corners(i);
            sum += (b - a).cross(c - a).length();
            sum
        })
        .collect();
    let rest = most.saturating_sub(points.len());
    for i in 0..rest {
        // One in each of as many equal shares of the area.
        let place = (i as f64 + random.unit()) / rest as f64 * sum;
        let item = items[sums.partition_point(|&s| s <= place).min(items.len() - 1)];
        let [a, b, c] = corners(item);
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        points.push((a + (b - a) * u + (c - a) * v, item.owner));
    }
    points
}

fn encloses(outer: &Aabb, inner: &Aabb) -> bool {
    inner.is_empty() || outer.union(inner) == *outer
}
