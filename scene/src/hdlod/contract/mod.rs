//! Quadric contraction (H13): vertices are joined two by two where that moves the surface least, then
//! the result is measured, and where it went too far it is made again finer (R10).
//!
//! The method is that of Garland and Heckbert: each vertex has the planes of the faces that it came
//! from, weighted by area; two vertices are joined in the place that is nearest to the planes of both.
//! Its error is a mean over planes, so it says nothing certain of the distance. Here it only says in
//! which order to go and where to stop; the distance is proved by [`certify::distance`], and of a few
//! places to stop the one with the fewest triangles that keeps the budget is taken.
//!
//! Only vertices of one behaviour, material and layer are joined, and what comes of a behaviour is
//! measured against that behaviour alone. So no certificate here rests on one behaviour being there
//! whenever another is: it holds at all dates, and there are no pairs.
//!
//! The default simplifier ([`super::cover`]) uses this for smooth parts; [`simplify`] does whole
//! groups this way, to compare.

mod mesh;
mod quadric;
#[cfg(test)]
mod tests;

use super::certify::{self, Limits};
use super::cover::Simplified;
use super::parts;
use super::presence::PresenceTable;
use super::soup::Triangle;
use crate::{Cancelled, Progress, decode_normal, encode_normal};
use glam::Vec3;
use mesh::Mesh;
use std::collections::HashMap;

/// Which vertices may be joined (H13).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Joins {
    /// Ends of an edge.
    Edges,
    /// Also those nearer than the budget, so that separate shells may grow together.
    Pairs,
}

/// Where the first try stops, as a share of the budget.
const FIRST_STOP: f32 = 0.6;

/// A try that kept the budget goes on to this many times its stop.
const FURTHER: f32 = 1.8;

/// [`Aim`] where whole groups are contracted.
const TRIES: u32 = 3;
const RETRIES: u32 = 2;

/// A part of fewer triangles is not a smooth mesh. With 16 the build takes 15 % longer and draws as
/// many triangles within 1 % (a demo of 20,000 elements).
const LEAST_TRIANGLES: usize = 32;

/// Cosines of the angles between the normals at a soft edge: neither flat nor the edge of a box.
const SOFT: std::ops::Range<f32> = 0.25..0.999;

/// Least share of soft edges, by length, that makes a smooth mesh.
const SOFT_SHARE: f32 = 0.35;

/// Cosine of the angle between two faces from which on they are shaded as two.
const CREASE: f32 = 0.45;

/// A corner's normal that differs from its face's by more than this (cosine) says that it is shaded
/// as part of something round.
const SHADED_ROUND: f32 = 0.99;

/// Fewer triangles, and how far they are from what they came from.
pub(crate) struct Contracted {
    pub triangles: Vec<Triangle>,
    /// Proved, in metres, both ways.
    pub distance_m: f32,
}

/// What a contraction is for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    /// Largest distance.
    pub budget_m: f32,
    /// Which vertices may be joined.
    pub joins: Joins,
    /// As many triangles or more are no gain.
    pub fewer_than: usize,
    /// How often it may be made; above one the first that keeps the budget is not the last.
    pub tries: u32,
    /// How often it may be made anew finer until it keeps the budget.
    pub retries: u32,
}

/// Contracts triangles of one behaviour, material and layer. `None` where that gains nothing.
pub(crate) fn contract(
    source: &[Triangle],
    aim: Aim,
    presence: &PresenceTable,
    progress: &Progress,
) -> Result<Option<Contracted>, Cancelled> {
    let Aim { budget_m, joins, .. } = aim;
    let usable = budget_m > 0.0 && budget_m.is_finite();
    let finite = || source.iter().flat_map(|t| t.corners).all(Vec3::is_finite);
    if source.len() < 2 || !usable || !finite() {
        return Ok(None);
    }
    let mut whole = Mesh::new(source);
    if joins == Joins::Pairs {
        whole.add_partners(f64::from(budget_m));
    }
    let round = is_shaded_round(source);
    let mut best: Option<Contracted> = None;
    let (mut kept_at, mut failed_at) = (0f32, f32::INFINITY);
    let mut stop = budget_m * FIRST_STOP;
    for tried in 1..=aim.tries + aim.retries {
        progress.check()?;
        let mut mesh = whole.clone();
        mesh.contract(f64::from(stop), progress)?;
        let triangles = finished(&mesh, source[0], round);
        let fewest = best.as_ref().map_or(aim.fewer_than, |b| b.triangles.len());
        if triangles.len() >= fewest {
            // Nothing gained by going this far.
            kept_at = stop;
        } else {
            // The decision alone costs a small part of the figure, which the build wants of the whole.
            let limits = Limits { progress: Some(progress), ..Limits::decide(budget_m) };
            let distance_m = certify::distance(&triangles, source, presence, limits).upper;
            if distance_m <= budget_m {
                kept_at = stop;
                best = Some(Contracted { triangles, distance_m });
            } else {
                failed_at = stop;
            }
        }
        if tried >= aim.tries && best.is_some() {
            break;
        }
        stop = if failed_at.is_finite() { (kept_at + failed_at) * 0.5 } else { stop * FURTHER };
    }
    progress.check()?;
    Ok(best)
}

/// Whole groups by contraction alone: in mode edges each connected part on its own, in mode pairs all
/// that is of one behaviour, material and layer. What cannot be contracted stays as it is.
pub(crate) fn simplify(
    source: &[Triangle],
    budget_m: f32,
    joins: Joins,
    presence: &PresenceTable,
    progress: &Progress,
) -> Result<Simplified, Cancelled> {
    let groups = match joins {
        Joins::Edges => parts::connected(source),
        Joins::Pairs => alike(source),
    };
    let mut result = Simplified { triangles: Vec::new(), distance_m: 0.0, pairs: Vec::new() };
    for group in groups {
        let own: Vec<Triangle> = group.iter().map(|&i| source[i as usize]).collect();
        let fewer_than = own.len();
        let aim = Aim { budget_m, joins, fewer_than, tries: TRIES, retries: RETRIES };
        match contract(&own, aim, presence, progress)? {
            Some(contracted) => {
                result.distance_m = result.distance_m.max(contracted.distance_m);
                result.triangles.extend(contracted.triangles);
            }
            None => result.triangles.extend(own),
        }
    }
    Ok(result)
}

/// Triangles by behaviour, material and layer, in order of their first.
fn alike(soup: &[Triangle]) -> Vec<Vec<u32>> {
    let mut groups: Vec<Vec<u32>> = Vec::new();
    let mut known = HashMap::new();
    for (i, triangle) in (0..).zip(soup) {
        let key = (triangle.behaviour, triangle.material, triangle.layer);
        let group = *known.entry(key).or_insert(groups.len());
        if group == groups.len() {
            groups.push(Vec::new());
        }
        groups[group].push(i);
    }
    groups
}

/// Whether a connected part is a mesh of something round: many triangles that meet at small angles.
/// Boxes and plates, of which buildings are full, have flat and right-angled edges alone.
pub(crate) fn is_smooth(part: &[Triangle]) -> bool {
    if part.len() < LEAST_TRIANGLES {
        return false;
    }
    let mut first: HashMap<[[u32; 3]; 2], Vec3> = HashMap::with_capacity(part.len() * 2);
    let (mut soft, mut total) = (0f32, 0f32);
    for triangle in part {
        let normal = triangle.cross().normalize_or_zero();
        for k in 0..3 {
            let (a, b) = (triangle.corners[k], triangle.corners[(k + 1) % 3]);
            let [p, q] = [a, b].map(|c| (c + Vec3::ZERO).to_array().map(f32::to_bits));
            let Some(other) = first.insert([p.min(q), p.max(q)], normal) else { continue };
            let length = a.distance(b);
            total += length;
            if SOFT.contains(&other.dot(normal)) {
                soft += length;
            }
        }
    }
    soft > SOFT_SHARE * total
}

/// Whether normals of the corners say that the surface is round, and not facetted.
fn is_shaded_round(source: &[Triangle]) -> bool {
    let round = |t: &Triangle| {
        let face = t.cross().normalize_or_zero();
        t.normals.iter().any(|&n| decode_normal(n).dot(face).abs() < SHADED_ROUND)
    };
    source.iter().filter(|t| round(t)).count() * 4 > source.len()
}

/// The triangles of a mesh; shaded round: each corner's normal is the mean of the faces that meet there
/// at less than a crease, by area.
fn finished(mesh: &Mesh, like: Triangle, round: bool) -> Vec<Triangle> {
    let faces = mesh.triangles();
    let mut at: HashMap<u32, Vec<Vec3>> = HashMap::new();
    if round {
        for (nodes, [a, b, c]) in &faces {
            let cross = (b - a).cross(c - a);
            nodes.iter().for_each(|&n| at.entry(n).or_default().push(cross));
        }
    }
    let triangles = faces.into_iter().map(|(nodes, corners)| {
        let [a, b, c] = corners;
        let own = (b - a).cross(c - a);
        let normal_at = |node: u32| {
            let meets = |other: &&Vec3| other.dot(own) >= CREASE * other.length() * own.length();
            let around = at.get(&node).into_iter().flatten();
            let sum: Vec3 = around.filter(meets).sum();
            encode_normal(sum.try_normalize().unwrap_or(own))
        };
        Triangle { corners, normals: nodes.map(normal_at), ..like }
    });
    triangles.collect()
}
