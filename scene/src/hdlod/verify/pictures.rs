//! The promise: what is visible in one picture is where the other one has it.

use super::tree::{Item, Met, Present, Tree};
use super::views::{Camera, dates, views};
use super::{Finding, Kind, Plan, Report, geometry};
use crate::hdlod::{Hdlod, Node, Selection, Temporal, select};
use crate::{Cancelled, ElementId, Progress, Scene, View};
use glam::{DVec2, DVec3, UVec2};
use rayon::prelude::*;
use std::collections::HashSet;
use topout_schedule::Time;

/// Rounding of 32-bit coordinates on the picture.
const ROUNDING_PX: f64 = 2e-3;

/// Owners from here on are clusters, below elements.
const CLUSTERS: u32 = 1 << 31;

pub(super) fn check(
    scene: &Scene,
    hdlod: &Hdlod,
    plan: &Plan,
    progress: &Progress,
    report: &mut Report,
) -> Result<(), Cancelled> {
    progress.begin("verify: full detail", 0)?;
    let mut items = Vec::with_capacity(scene.model.triangle_count());
    for i in 0..scene.model.elements.len() as u32 {
        if i.is_multiple_of(1024) {
            progress.check()?;
        }
        geometry::element(scene, ElementId(i), &mut items);
    }
    let full = Tree::new(items, progress)?;
    let (views, dates) = (views(scene, plan), dates(scene, plan));
    let rows: u64 = views.iter().map(|v| u64::from(v.1.size.y.div_ceil(plan.stride))).sum();
    progress.begin("verify: pictures", rows * dates.len() as u64)?;
    for &time in &dates {
        let there: Vec<bool> = scene.behaviours.iter().map(|b| b.at(time)).collect();
        let exact = full.present(&there);
        for (name, view) in &views {
            let picture = Picture::new(scene, hdlod, plan, view, time, &exact, progress)?;
            picture.check(&format!("{name} at {time}"), progress, report)?;
        }
    }
    Ok(())
}

/// One view at one date: both pictures of it.
struct Picture<'a> {
    scene: &'a Scene,
    hdlod: &'a Hdlod,
    view: &'a View,
    stride: u32,
    /// What is there, in full detail.
    exact: &'a Present<'a>,
    selection: Selection,
    /// What HDLOD draws.
    drawn: Tree,
    camera: Camera,
}

/// A visible point whose counterpart is too far.
struct Wrong {
    px: f64,
    point: DVec3,
    owner: u32,
    /// Whether full detail shows it, not HDLOD.
    missing: bool,
}

/// What one row of pixels showed.
#[derive(Default)]
struct Row {
    points: u64,
    wrong_points: u64,
    worst_px: f64,
    worst: Option<Wrong>,
    /// By pixel: whether anything visible there is wrong.
    flags: Vec<bool>,
}

impl<'a> Picture<'a> {
    fn new(
        scene: &'a Scene,
        hdlod: &'a Hdlod,
        plan: &Plan,
        view: &'a View,
        time: Time,
        exact: &'a Present<'a>,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let selection = select(scene, hdlod, view, time);
        let mut items: Vec<Item> = Vec::with_capacity(selection.triangles as usize);
        for &id in &selection.elements {
            geometry::element(scene, id, &mut items);
        }
        items.iter_mut().for_each(|item| item.tag = 0);
        for span in &selection.spans {
            let clusters = &hdlod.clusters;
            let owner = clusters.partition_point(|c| c.base_vertex() <= span.base_vertex) - 1;
            geometry::span(hdlod, span, CLUSTERS + owner as u32, &mut items);
        }
        let bounds = scene.model.bounds();
        let reach = bounds.corners().map(|c| c.distance(view.eye));
        let reach = reach.into_iter().fold(0f32, f32::max);
        let reach = if reach.is_finite() { f64::from(reach) } else { 1.0 };
        let (drawn, camera) = (Tree::new(items, progress)?, Camera::new(view, reach));
        Ok(Self { scene, hdlod, view, stride: plan.stride, exact, selection, drawn, camera })
    }

    fn check(&self, name: &str, progress: &Progress, report: &mut Report) -> Result<(), Cancelled> {
        let shown = self.drawn.present(&[true]);
        let count = UVec2::new(
            self.view.size.x.div_ceil(self.stride),
            self.view.size.y.div_ceil(self.stride),
        );
        let rows: Result<Vec<Row>, Cancelled> = (0..count.y)
            .into_par_iter()
            .map(|y| {
                let row = self.row(y, count.x, &shown);
                progress.advance(1)?;
                Ok(row)
            })
            .collect();
        let rows = rows?;
        report.pictures += 1;
        let mut worst: Option<&Wrong> = None;
        for row in &rows {
            report.points_checked += row.points;
            report.wrong_points += row.wrong_points;
            report.worst_px = report.worst_px.max(row.worst_px as f32);
            if let Some(wrong) = &row.worst
                && worst.is_none_or(|w| wrong.px > w.px)
            {
                worst = Some(wrong);
            }
        }
        if let Some(wrong) = worst {
            report.tell(Finding { kind: Kind::Promise, message: self.describe(wrong, name) });
        }
        let flags: Vec<bool> = rows.into_iter().flat_map(|r| r.flags).collect();
        let region = largest_region(flags, count.x as usize) * u64::from(self.stride).pow(2);
        if region > report.worst_region_px {
            report.worst_region_px = region;
            name.clone_into(&mut report.worst_region_at);
        }
        Ok(())
    }

    fn row(&self, y: u32, width: u32, shown: &Present) -> Row {
        let mut row = Row::default();
        let mut seen: Vec<Met> = Vec::new();
        for x in 0..width {
            // The middle of the pixels that this one stands for.
            let pixel = (UVec2::new(x, y) * self.stride).as_dvec2() + f64::from(self.stride) * 0.5;
            let (origin, direction) = self.camera.ray(pixel);
            let before = row.wrong_points;
            for (from, to, missing) in [(self.exact, shown, true), (shown, self.exact, false)] {
                from.seen(origin, direction, self.camera.start, &mut seen);
                for met in &seen {
                    let point = origin + direction * met.along;
                    self.measure(point, met.owner, to, missing, &mut row);
                }
            }
            row.flags.push(row.wrong_points > before);
        }
        row
    }

    /// How far on the picture a visible point is from what the other picture has nearest to it.
    fn measure(&self, point: DVec3, owner: u32, to: &Present, missing: bool, row: &mut Row) {
        // What is nowhere cannot be farther off than the picture is large.
        let farthest = self.view.size.as_dvec2().length();
        let counterpart = to.nearest(point).and_then(|q| self.camera.project(q));
        let place = self.camera.project(point).unwrap_or(DVec2::ZERO);
        let px = counterpart.map_or(farthest, |q| place.distance(q).min(farthest));
        row.points += 1;
        row.worst_px = row.worst_px.max(px);
        if px > f64::from(self.view.tolerance_px) + ROUNDING_PX {
            row.wrong_points += 1;
            if row.worst.as_ref().is_none_or(|w| px > w.px) {
                row.worst = Some(Wrong { px, point, owner, missing });
            }
        }
    }

    /// For people: what is wrong, and whose fault it is.
    fn describe(&self, wrong: &Wrong, name: &str) -> String {
        let at = format!("{:.2} px, view {name}, point {:.3}", wrong.px, wrong.point);
        if !wrong.missing {
            return format!("{at}: drawn by {}, but not there", self.owner(wrong.owner));
        }
        let drawn: HashSet<u32> = self
            .selection
            .spans
            .iter()
            .map(|s| self.hdlod.clusters.partition_point(|c| c.base_vertex() <= s.base_vertex) - 1)
            .map(|c| c as u32)
            .collect();
        let by = drawn.iter().find(|&&c| self.is_below(Node::Cluster(c), wrong.owner));
        let by = by.map_or("no cluster".to_owned(), |c| self.owner(CLUSTERS + c));
        format!("{at}: {} is there, but not drawn ({by} stands for it)", self.owner(wrong.owner))
    }

    fn owner(&self, owner: u32) -> String {
        if owner < CLUSTERS {
            return format!("element {owner} ({})", self.scene.model.elements[owner as usize].name);
        }
        let i = owner - CLUSTERS;
        let cluster = &self.hdlod.clusters[i as usize];
        let delta = match self.hdlod.temporal {
            Temporal::Tight => self.view.error_px(cluster.eps, &cluster.bounds),
            Temporal::Paper => f32::NAN,
        };
        format!("cluster {i} (level {}, eps {} m, {delta:.2} px)", cluster.level, cluster.eps)
    }

    fn is_below(&self, node: Node, element: u32) -> bool {
        match node {
            Node::Leaf(id) => id.0 == element,
            Node::Cluster(i) => {
                let children = self.hdlod.children_of(&self.hdlod.clusters[i as usize]);
                children.iter().any(|&child| self.is_below(child, element))
            }
        }
    }
}

/// Number of flags in the largest part that hangs together by sides.
fn largest_region(mut flags: Vec<bool>, width: usize) -> u64 {
    let mut largest = 0;
    let mut open = Vec::new();
    for start in 0..flags.len() {
        if !std::mem::take(&mut flags[start]) {
            continue;
        }
        open.push(start);
        let mut size = 0;
        while let Some(i) = open.pop() {
            size += 1;
            let x = i % width;
            let sides = [
                (x > 0).then(|| i - 1),
                (x + 1 < width).then_some(i + 1),
                i.checked_sub(width),
                (i + width < flags.len()).then_some(i + width),
            ];
            for side in sides.into_iter().flatten() {
                if std::mem::take(&mut flags[side]) {
                    open.push(side);
                }
            }
        }
        largest = largest.max(size);
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::largest_region;

    #[test]
    fn regions_hang_together_by_sides_and_not_across_the_edge() {
        let picture = ["##..#", ".#..#", "..##."];
        let flags = picture.concat().chars().map(|c| c == '#').collect();
        assert_eq!(largest_region(flags, 5), 3);
        assert_eq!(largest_region(vec![false; 6], 3), 0);
        assert_eq!(largest_region(vec![true; 6], 3), 6);
        assert_eq!(largest_region(Vec::new(), 1), 0);
    }
}
