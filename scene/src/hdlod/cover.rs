//! Simplification that comes with its certificate: snap, then delete what is covered (H13, R10, R11).
//!
//! A quadric simplifier fails on building models: they are soups of thousands of small closed
//! shells, its error figure says nothing of shells that vanish, and one that did fails the whole
//! cluster. Here nothing is deleted without proof:
//!
//! 1. **Snap.** Corners of small triangles move to the centres of a grid. On a triangle the
//!    movement is linear, so the snapped triangle is within the largest corner movement `s` of its
//!    source, both ways.
//! 2. **Flatten.** A connected part (one behaviour, one material) that is thin moves to its middle: it
//!    becomes a rectangle there, where every point of the part is within `e` of the rectangle and every
//!    point of the rectangle within `e` of the part, or, where it has openings that can be told apart,
//!    the sheet of its own triangles of one side; the other side and the rims must then be covered.
//! 3. **Cover.** What stands for some sources may be deleted when each source is cut into pieces
//!    (a few midpoint subdivisions) that have all their corners within `e` of one kept triangle.
//!    The distance to a convex set is a convex function, so the piece's every point is within `e`
//!    of it. The kept triangle must be present whenever the source is; it is locked and stays, unless
//!    in the end all that it covers finds other covers.
//!
//! A part that is a smooth mesh is contracted instead of snapped ([`super::contract`]), at a proved
//! distance `c` both ways from its source. Its new triangles are sources from then on, covered within
//! `e - c`.
//!
//! Every kept point is within `s` (snapped), `e` (flattened) or `c` (contracted) of its own source, and
//! every source point within `s` or `e` of something kept that is present whenever the source is, or
//! within `c` of a point of the contracted part, of the same behaviour, and that one kept or within
//! `e - c` of something kept. So D_H <= max(s, e, c) at every date; the largest figure that occurred,
//! `c` and what came after it added, is returned.
//!
//! The certificate is one of shape. That the picture keeps its colours is a matter of which covers
//! are allowed, see [`DISTINCT_HEIGHT`] and [`Palette::alike`], and of the colours that go over to them,
//! see [`SLIM_HEIGHT`].

use super::contract::{self, Aim, Joins};
use super::mixture::{Mixed, even_out};
use super::palette::Palette;
use super::parts::{self, Flat, FlatLimits, on_grid};
use super::pieces::{Grid, Query, SUBDIVISIONS};
use super::presence::PresenceTable;
use super::restate::Pair;
use super::soup::Triangle;
use crate::{Aabb, Cancelled, Progress};
use glam::Vec3;
use std::collections::HashSet;
use std::ops::{Range, RangeInclusive};

/// How far corners may move to the grid, as a share of the budget. 0.3 and 0.7 draw within 5 % of
/// the same triangles (a demo of 20,000 elements, all of it movable). See the file's head for why
/// this does not add to the covers' radius.
const SNAP_SHARE: f32 = 0.5;

/// Triangles higher than this share of the budget can be told apart on the picture. Unless their part
/// is flat they are not moved, and only what is flat or faces the same way may cover them: a window
/// that stands a little before its wall would else move into it, or keep only the side inside.
const DISTINCT_HEIGHT: f32 = 1.5;

/// Thickness of a part that becomes a rectangle, as a share of the budget: seen from its edge the
/// rectangle is nothing, so the part must be nearly nothing there too. 1.2 draws 8 % more triangles
/// at 1/1 and builds 14 % longer; with 2.0 a crane's jib breaks up.
const FLAT_SHARE: f32 = 1.5;

/// Triangles at most this many times the budget high may be covered by any colour, which takes
/// their colour in: they are about a pixel. 1.0 draws 10 % more triangles at 1/1.
const SLIM_HEIGHT: f32 = 1.25;

/// What is higher is only covered by what lies about parallel (cosine of the angle): a facade whose
/// panels were left to the edges of the slabs behind them is open.
pub(super) const PARALLEL: f32 = 0.7;

/// Where the grid leaves no more triangles than this of a smooth mesh it is not contracted: covers come
/// off better with the triangles of the grid. 16 draws 2 % more of the demo at 1/16, 160 as many there and
/// 2 % more at 1/1.
const FEW_TRIANGLES: usize = 64;

/// A simplified soup and how far it is from its source, in metres, at any date, both ways.
pub(crate) struct Simplified {
    pub triangles: Vec<Triangle>,
    pub distance_m: f32,
    /// Behaviours of what was kept and of what it covers, where they differ; sorted.
    pub pairs: Vec<Pair>,
}

/// Simplifies a soup within `budget_m`. The result's distance never exceeds it, apart from the
/// rounding of 32-bit coordinates, which is counted in.
pub(crate) fn simplify(
    source: &[Triangle],
    budget_m: f32,
    presence: &PresenceTable,
    palette: &Palette,
    progress: &Progress,
) -> Result<Simplified, Cancelled> {
    let bounds = Aabb::of_points(source.iter().flat_map(|t| t.corners));
    let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
    let slack = if source.is_empty() { 0.0 } else { reach * f32::EPSILON * 8.0 };
    let snap_m = (budget_m - 2.0 * slack) * SNAP_SHARE;
    if source.is_empty() || snap_m <= 0.0 {
        let triangles = source.to_vec();
        return Ok(Simplified { triangles, distance_m: slack, pairs: Vec::new() });
    }

    let cover_m = budget_m - 2.0 * slack;
    let task = Task { cover_m, presence, palette, progress };
    let mut work = Work::snapped(source, snap_m, task)?;
    work.index();
    work.delete_collapsed()?;
    work.delete_covered()?;
    work.delete_spare()?;
    let distance_m = work.distance_m + 2.0 * slack;
    let mut pairs: Vec<_> = work.pairs.drain().collect();
    pairs.sort_unstable();
    Ok(Simplified { triangles: work.finish(), distance_m, pairs })
}

/// What may be kept: one or two triangles that stand for some sources.
pub(super) struct Item {
    pub triangle: Triangle,
    pub bounds: Aabb,
    pub normal: Vec3,
    pub area: f32,
    /// The source triangles it stands for: a range of [`Work::sources`].
    pub sources: Range<u32>,
    /// Items of one rectangle have the same number and live and die together.
    pub unit: u32,
    /// In the middle of a thin part: it has no side.
    pub flat: bool,
    /// How far its source, a triangle of a contracted part, is from the part's own triangles.
    pub spent_m: f32,
    /// What it took the place of.
    pub mixed: Mixed,
    pub dead: bool,
    pub locked: bool,
}

impl Item {
    fn flat(triangle: Triangle, sources: Range<u32>, unit: u32) -> Self {
        Self { flat: true, ..Self::new(triangle, sources, unit) }
    }

    fn new(triangle: Triangle, sources: Range<u32>, unit: u32) -> Self {
        let cross = triangle.cross();
        Self {
            triangle,
            bounds: Aabb::of_points(triangle.corners),
            normal: cross.normalize_or_zero(),
            area: cross.length() * 0.5,
            sources,
            unit,
            flat: false,
            spent_m: 0.0,
            mixed: Mixed::default(),
            dead: false,
            locked: false,
        }
    }
}

/// What may cover something.
#[derive(Clone, Copy)]
struct Rule {
    triangle: Triangle,
    facing: Vec3,
    /// Only what faces the same way or is flat.
    distinct: bool,
    /// What is slimmer than the error may take any colour.
    any_color: bool,
    /// What is a mere line on the picture may also go behind glass.
    line: bool,
}

impl Rule {
    fn of(item: &Item, radius: f32) -> Self {
        let slim = item.triangle.height();
        Self {
            triangle: item.triangle,
            facing: item.triangle.cross(),
            distinct: slim > DISTINCT_HEIGHT * radius && !item.flat,
            any_color: slim <= SLIM_HEIGHT * radius,
            line: slim <= 0.5 * SLIM_HEIGHT * radius,
        }
    }

    /// Nothing is to be seen of what collapsed.
    fn collapsed(triangle: &Triangle) -> Self {
        let facing = triangle.cross();
        Self { triangle: *triangle, facing, distinct: false, any_color: true, line: true }
    }

    fn allows(&self, c: &Item, any_way: bool, presence: &PresenceTable, palette: &Palette) -> bool {
        (!self.distinct || c.flat || c.triangle.cross().dot(self.facing) > 0.0)
            && (any_way || c.normal.dot(self.facing).abs() > PARALLEL * self.facing.length())
            && (self.line || c.triangle.layer == self.triangle.layer)
            && (self.any_color || palette.alike(c.triangle.material, self.triangle.material))
            && presence.includes(c.triangle.behaviour, self.triangle.behaviour)
    }
}

/// Sources that are deleted together.
#[derive(Clone)]
struct Gone {
    sources: Range<u32>,
    unit: u32,
    rule: Rule,
    /// See [`Item::spent_m`]: it is taken off the radius.
    spent_m: f32,
}

impl Gone {
    fn item(item: &Item, radius: f32) -> Self {
        let rule = Rule::of(item, radius);
        Self { sources: item.sources.clone(), unit: item.unit, rule, spent_m: item.spent_m }
    }
}

/// The items that cover something, each once, and how far they are at most.
struct Cover {
    by: Vec<u32>,
    distance_m: f32,
}

/// What a simplification needs to know besides its triangles.
#[derive(Clone, Copy)]
struct Task<'a> {
    /// How far a cover may be.
    cover_m: f32,
    presence: &'a PresenceTable<'a>,
    palette: &'a Palette,
    progress: &'a Progress,
}

struct Work<'a> {
    task: Task<'a>,
    /// Source triangles, those of one part next to each other.
    sources: Vec<Triangle>,
    items: Vec<Item>,
    /// Places in `sources` of triangles that lost their area.
    collapsed: Vec<u32>,
    grid: Grid,
    distance_m: f32,
    /// What was deleted, and the items that cover it.
    gone: Vec<(Gone, Vec<u32>)>,
    /// See [`Simplified::pairs`].
    pairs: HashSet<Pair>,
}

impl<'a> Work<'a> {
    /// Flattens thin parts, moves the corners of the others by at most `snap_m` and sets aside
    /// what lost its area by that.
    fn snapped(source: &[Triangle], snap_m: f32, task: Task<'a>) -> Result<Self, Cancelled> {
        let Task { cover_m, progress, .. } = task;
        // A point of a cube is at most half the diagonal from its centre.
        let cell = 2.0 * snap_m / 3f32.sqrt();
        let mut work = Self {
            task,
            sources: Vec::with_capacity(source.len()),
            items: Vec::with_capacity(source.len() / 2),
            collapsed: Vec::new(),
            grid: Grid::default(),
            distance_m: 0.0,
            gone: Vec::new(),
            pairs: HashSet::new(),
        };
        for part in parts::connected(source) {
            progress.check()?;
            let first = work.sources.len() as u32;
            work.sources.extend(part.iter().map(|&i| source[i as usize]));
            let range = first..work.sources.len() as u32;
            let members = &work.sources[first as usize..];
            let limits = FlatLimits {
                radius: cover_m,
                thickness_m: cover_m * FLAT_SHARE,
                small_m: cover_m * DISTINCT_HEIGHT,
            };
            match parts::flatten(members, limits) {
                Some(Flat::Rectangle { halves, distance_m }) => {
                    work.distance_m = work.distance_m.max(distance_m);
                    for half in halves {
                        work.items.push(Item::flat(half, range.clone(), first));
                    }
                }
                Some(Flat::Sheet { kept, rest, moved_m }) => {
                    work.distance_m = work.distance_m.max(moved_m);
                    for (place, triangle) in kept {
                        let place = first + place;
                        let own = place..place + 1;
                        // The other side of the sheet is gone.
                        work.items.push(Item::flat(triangle, own, place));
                    }
                    work.collapsed.extend(rest.iter().map(|place| first + place));
                }
                None if work.contract(first, cell)? => {}
                None => range.for_each(|place| work.snap(place, cell)),
            }
        }
        Ok(work)
    }

    /// Contracts the part whose sources start at `first` if it is a smooth mesh and less is left of it
    /// than the grid leaves. What is left are sources of their own, closer to which they must stay.
    fn contract(&mut self, first: u32, cell: f32) -> Result<bool, Cancelled> {
        let Task { cover_m, presence, progress, .. } = self.task;
        let part = &self.sources[first as usize..];
        if !contract::is_smooth(part) {
            return Ok(false);
        }
        let stays = |t: &&Triangle| on_grid(t, cell, DISTINCT_HEIGHT * cover_m).is_some();
        let on_grid = part.iter().filter(stays).count();
        if on_grid <= FEW_TRIANGLES {
            return Ok(false);
        }
        let aim = Aim {
            budget_m: cover_m,
            joins: Joins::Edges,
            fewer_than: on_grid,
            tries: 1,
            retries: 1,
        };
        let Some(found) = contract::contract(part, aim, presence, progress)? else {
            return Ok(false);
        };
        self.distance_m = self.distance_m.max(found.distance_m);
        self.sources.truncate(first as usize);
        for (place, triangle) in (first..).zip(found.triangles) {
            self.sources.push(triangle);
            let item = Item::new(triangle, place..place + 1, place);
            self.items.push(Item { spent_m: found.distance_m, ..item });
        }
        Ok(true)
    }

    fn snap(&mut self, place: u32, cell: f32) {
        let original = self.sources[place as usize];
        let own = place..place + 1;
        let Some(triangle) = on_grid(&original, cell, DISTINCT_HEIGHT * self.task.cover_m) else {
            self.collapsed.push(place);
            return;
        };
        for (snapped, corner) in triangle.corners.iter().zip(original.corners) {
            self.distance_m = self.distance_m.max(snapped.distance(corner));
        }
        self.items.push(Item::new(triangle, own, place));
    }

    fn index(&mut self) {
        let radius = self.task.cover_m;
        self.items.sort_by(|a, b| b.area.total_cmp(&a.area));
        let corners = self.sources.iter().flat_map(|t| t.corners);
        let bounds = self.items.iter().fold(Aabb::of_points(corners), |b, i| b.union(&i.bounds));
        self.grid = Grid::new(&bounds.grown(radius), radius);
        for (i, item) in self.items.iter().enumerate() {
            self.grid.insert(i as u32, &item.bounds);
        }
    }

    /// Deletes what collapsed to lines and points; where nothing covers it, the original comes
    /// back and may cover the others. Largest first, so that few come back.
    fn delete_collapsed(&mut self) -> Result<(), Cancelled> {
        let mut collapsed = std::mem::take(&mut self.collapsed);
        let area = |i: u32| self.sources[i as usize].area();
        collapsed.sort_by(|&a, &b| area(b).total_cmp(&area(a)));
        for place in collapsed {
            self.task.progress.check()?;
            let original = self.sources[place as usize];
            let rule = Rule::collapsed(&original);
            let gone = Gone { sources: place..place + 1, unit: place, rule, spent_m: 0.0 };
            if let Some(cover) = self.find(&gone) {
                self.lock(&gone, &cover);
                self.gone.push((gone, cover.by));
            } else {
                let mut item = Item::new(original, place..place + 1, place);
                item.locked = true;
                self.grid.insert(self.items.len() as u32, &item.bounds);
                self.items.push(item);
            }
        }
        Ok(())
    }

    /// Deletes what is covered, smallest first.
    fn delete_covered(&mut self) -> Result<(), Cancelled> {
        for i in (0..self.items.len()).rev() {
            self.task.progress.check()?;
            let item = &self.items[i];
            let twin = i.checked_sub(1).filter(|&t| self.items[t].unit == item.unit);
            if item.locked || item.dead || twin.is_some_and(|t| self.items[t].locked) {
                continue;
            }
            let gone = Gone::item(item, self.task.cover_m);
            let Some(cover) = self.find(&gone) else { continue };
            for part in [Some(i), twin].into_iter().flatten() {
                self.items[part].dead = true;
            }
            if gone.rule.any_color {
                self.mix(twin.unwrap_or(i)..=i, &cover.by);
            }
            self.lock(&gone, &cover);
            self.gone.push((gone, cover.by));
        }
        Ok(())
    }

    /// Deletes what only stayed to cover others, where it and they find other covers. At first what is
    /// small takes the covers that it finds, and these can no longer go. On the demo 6 % fewer triangles
    /// are drawn at 1/1, 14 % at 1/4 and 12 % at 1/16; a second time finds nothing.
    fn delete_spare(&mut self) -> Result<(), Cancelled> {
        // For each item what it helps to cover, or once did: places in `gone`.
        let mut leaning = vec![Vec::new(); self.items.len()];
        for (g, (_, by)) in self.gone.iter().enumerate() {
            by.iter().for_each(|&c| leaning[c as usize].push(g));
        }
        for i in (0..self.items.len()).rev() {
            self.task.progress.check()?;
            let item = &self.items[i];
            let unit =
                i..=i + usize::from(self.items.get(i + 1).is_some_and(|t| t.unit == item.unit));
            let first = i == 0 || self.items[i - 1].unit != item.unit;
            if item.dead || !first || !self.items[unit.clone()].iter().any(|part| part.locked) {
                continue;
            }
            let gone = Gone::item(item, self.task.cover_m);
            self.items[unit.clone()].iter_mut().for_each(|part| part.dead = true);
            let found = self.find(&gone).and_then(|own| {
                let mut others: Vec<usize> = leaning[unit.clone()].concat();
                others.retain(|&g| self.gone[g].1.iter().any(|&c| unit.contains(&(c as usize))));
                others.sort_unstable();
                others.dedup();
                let covers = others.into_iter().map(|g| Some((g, self.find(&self.gone[g].0)?)));
                Some((own, covers.collect::<Option<Vec<_>>>()?))
            });
            let Some((own, others)) = found else {
                self.items[unit].iter_mut().for_each(|part| part.dead = false);
                continue;
            };
            if gone.rule.any_color {
                self.mix(unit, &own.by);
            }
            own.by.iter().for_each(|&c| leaning[c as usize].push(self.gone.len()));
            self.lock(&gone, &own);
            self.gone.push((gone, own.by));
            for (g, cover) in others {
                cover.by.iter().for_each(|&c| leaning[c as usize].push(g));
                self.lock(&self.gone[g].0.clone(), &cover);
                self.gone[g].1 = cover.by;
            }
        }
        Ok(())
    }

    /// Kept triangles that cover something, if there are.
    fn find(&self, gone: &Gone) -> Option<Cover> {
        let Task { cover_m, presence, palette, .. } = self.task;
        let Gone { sources, unit, rule, spent_m } = gone;
        // What lies the same way takes the colour in, so it is asked first.
        let ways = if rule.line {
            [Some(true), None]
        } else {
            [Some(false), rule.any_color.then_some(true)]
        };
        ways.into_iter().flatten().find_map(|any_way| {
            let may = |c: &Item| rule.allows(c, any_way, presence, palette);
            let mut query = Query {
                items: &self.items,
                grid: &self.grid,
                own: *unit,
                radius: cover_m - spent_m,
                may: &may,
                found: Vec::new(),
                worst: 0.0,
            };
            let sources = &self.sources[sources.start as usize..sources.end as usize];
            let covered = sources
                .iter()
                .all(|s| query.reaches_middle(s.corners) && query.piece(s.corners, SUBDIVISIONS));
            covered.then_some(Cover { by: query.found, distance_m: query.worst + spent_m })
        })
    }

    /// What covers something stays.
    fn lock(&mut self, gone: &Gone, cover: &Cover) {
        self.distance_m = self.distance_m.max(cover.distance_m);
        let sources = &self.sources[gone.sources.start as usize..gone.sources.end as usize];
        for &i in &cover.by {
            let item = &mut self.items[i as usize];
            item.locked = true;
            let keeper = item.triangle.behaviour;
            let covered = sources.iter().map(|s| s.behaviour);
            self.pairs.extend(covered.filter(|&c| c != keeper).map(|c| (keeper, c)));
        }
    }

    /// Gives the colour of what is deleted, one item or the halves of a rectangle, to what covers it
    /// from the same direction.
    fn mix(&mut self, deleted: RangeInclusive<usize>, by: &[u32]) {
        let palette = self.task.palette;
        let normal = self.items[*deleted.start()].normal;
        let mut taken = Mixed::default();
        for item in &self.items[deleted] {
            taken = taken.with(item.mixed.on(palette, item.triangle.material, item.area));
        }
        let mut covers = by.to_vec();
        covers.retain(|&i| self.items[i as usize].normal.dot(normal).abs() > PARALLEL);
        let share = 1.0 / covers.len().max(1) as f32;
        for &i in &covers {
            let mixed = &mut self.items[i as usize].mixed;
            *mixed = mixed.with(taken.times(share));
        }
    }

    /// What was kept. A rectangle's half stays when the other is needed.
    fn finish(mut self) -> Vec<Triangle> {
        let palette = self.task.palette;
        self.items.retain(|i| !i.dead);
        even_out(&mut self.items);
        let kept = self.items.into_iter();
        kept.map(|item| {
            let mut triangle = item.triangle;
            triangle.material = item.mixed.over(palette, triangle.material, item.area);
            triangle
        })
        .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BehaviourId, Layer, Material};
    use topout_schedule::Behaviour;

    fn plate(min: [f32; 2], max: [f32; 2], z: f32, material: u16) -> [Triangle; 2] {
        let p = |x: f32, y: f32| Vec3::new(x, y, z);
        let (a, b) = (p(min[0], min[1]), p(max[0], min[1]));
        let (c, d) = (p(max[0], max[1]), p(min[0], max[1]));
        [[a, b, c], [a, c, d]].map(|corners| Triangle {
            corners,
            normals: [[0; 2]; 3],
            material,
            layer: Layer::Opaque,
            behaviour: BehaviourId(0),
        })
    }

    fn materials() -> Vec<Material> {
        let of = |color: [f32; 4]| Material {
            name: String::new(),
            color,
            roughness: 1.0,
            metallic: 0.0,
            transparent: false,
        };
        vec![of([1.0; 4]), of([0.0, 0.0, 0.0, 1.0])]
    }

    fn simplified(source: &[Triangle], budget_m: f32) -> Simplified {
        let behaviours = [Behaviour::always()];
        let presence = PresenceTable::new(&behaviours, true);
        let palette = Palette::new(&materials());
        simplify(source, budget_m, &presence, &palette, &Progress::default())
            .expect("not cancelled")
    }

    /// Black windows on a white wall that are less than a pixel each: the wall turns grey by as
    /// much as they cover, and what covers them is still one wall.
    #[test]
    fn what_is_merged_leaves_its_colour() {
        let mut source = plate([0.0, 0.0], [20.0, 10.0], 0.0, 0).to_vec();
        for x in 0..10 {
            for y in 0..5 {
                let corner = [x as f32 * 2.0 + 0.5, y as f32 * 2.0 + 0.5];
                source.extend(plate(corner, [corner[0] + 1.0, corner[1] + 1.0], 0.05, 1));
            }
        }
        let result = simplified(&source, 1.0);
        assert_eq!(result.triangles.len(), 2);
        let palette = Palette::new(&materials());
        for triangle in &result.triangles {
            let grey = palette.color(triangle.material);
            // A quarter of the wall is black.
            assert!((grey.x - 0.75).abs() < 0.1, "{grey}");
        }
        let apart = simplified(&source, 0.2);
        assert_eq!(apart.triangles.len(), source.len(), "what can be told apart stays");
    }

    /// Two walls side by side, a board over both and a smaller one behind it. The small one lies whole
    /// at the board, which then cannot go before it is seen that both also lie at the walls.
    #[test]
    fn what_only_stays_to_cover_goes_where_others_cover() {
        let mut source = plate([0.0, 0.0], [10.0, 10.0], 0.0, 0).to_vec();
        source.extend(plate([10.0, 0.0], [20.0, 10.0], 0.01, 0));
        source.extend(plate([6.0, 3.0], [14.0, 6.0], 0.3, 0));
        source.extend(plate([7.0, 3.5], [13.0, 5.5], 0.1, 0));
        let result = simplified(&source, 1.0);
        assert_eq!(result.triangles.len(), 4, "the walls");
        assert!(result.triangles.iter().all(|t| t.area() > 40.0));
        assert!(result.distance_m <= 1.0);
    }

    /// Of more than two triangles, so that it is known to be flat.
    fn strip(min: [f32; 2], max: [f32; 2], z: f32, material: u16) -> Vec<Triangle> {
        let middle = 0.5 * (min[1] + max[1]);
        let lower = plate(min, [max[0], middle], z, material);
        lower.into_iter().chain(plate([min[0], middle], max, z, material)).collect()
    }

    /// A board before three walls, a dark bar at its upper left end and one at its lower right. Each bar
    /// lies whole at one half of the board only, so the board takes them in before it goes to the walls:
    /// what both halves took goes over with it.
    #[test]
    fn what_goes_hands_on_all_that_it_took_in() {
        let mut source = Vec::new();
        for (from, to, z) in [(0.0, 7.0, 0.0), (7.0, 13.0, 0.01), (13.0, 20.0, 0.0)] {
            source.extend(plate([from, 0.4], [to, 2.6], z, 0));
        }
        source.extend(strip([6.0, 1.0], [14.0, 2.0], 0.3, 0));
        source.extend(strip([5.4, 2.0], [8.6, 2.6], 0.1, 1));
        source.extend(strip([11.4, 0.4], [14.6, 1.0], 0.1, 1));
        let result = simplified(&source, 1.0);
        assert_eq!(result.triangles.len(), 6, "the walls");
        let palette = Palette::new(&materials());
        let dark = |t: &Triangle| (1.0 - palette.color(t.material).x) * t.area();
        let dark: f32 = result.triangles.iter().map(dark).sum();
        let bars = 2.0 * 3.2 * 0.6;
        assert!((dark - bars).abs() < 0.25 * bars, "{bars} m2 were black, {dark} are left");
    }

    /// A facade panel is not left to the edge of a slab behind it.
    #[test]
    fn what_stands_is_not_covered_by_what_lies() {
        let mut source = strip([0.0, 0.0], [4.0, 1.6], 0.0, 0);
        for y in [0.0, 0.8, 1.6] {
            let slab = plate([0.0, 0.1], [4.0, 8.0], 0.0, 0)
                .map(|t| Triangle { corners: t.corners.map(|c| Vec3::new(c.x, y, c.y)), ..t });
            source.extend(slab);
        }
        let result = simplified(&source, 1.0);
        let upright =
            result.triangles.iter().filter(|t| t.cross().z.abs() > t.cross().y.abs()).count();
        assert_eq!(upright, 2);
    }
}
