//! How far two soups are from each other at most, and at least: the certificate (R10, R11).
//!
//! What is bounded is the largest distance from a point of either soup to the other one, where a
//! point of a triangle t may only be matched with triangles that are present whenever t is. Who
//! keeps within that figure keeps within it at every date.
//!
//! Branch and bound (the idea is that of Sacht and Jacobson, "Cascading upper bounds for triangle
//! soup Pompeiu-Hausdorff distance", 2024). For a piece of a triangle:
//!
//! - **upper bound**: the smallest distance, over the allowed triangles u of the other soup, of the
//!   farthest of its three corners from u. The distance to a convex set is convex, so no point of the
//!   piece is farther from u. Halves of a piece start from their parent's u, so bounds only fall.
//! - **lower bound**: the exact distance of its corners from the nearest allowed triangle.
//!
//! The piece with the largest upper bound is halved at its longest edge until that bound is small
//! enough, or a corner is found too far away. Halving and not quartering: building models are full of
//! long, thin triangles, which need cuts in one direction only. Over a flat offset the bound of a
//! piece that straddles two triangles exceeds the distance only by the square of its size.

use super::bvh::{Nearest, SoupTree, Wanted};
use super::presence::PresenceTable;
use super::soup::Triangle;
use crate::Progress;
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Halvings allowed for each triangle, and for each call. A decision takes some 0 to 3 a triangle;
/// what needs more than these is close to the limit and is answered with the bounds that are known.
const HALVINGS_PER_TRIANGLE: usize = 64;
const HALVINGS: usize = 20_000;

/// Pieces between two questions whether the work was cancelled.
const LOOKS_UP_EVERY: usize = 64;

/// Pieces shorter than this share of the distance are not halved: it would gain less than that.
const FINEST: f64 = 1e-3;

/// f64 rounding of sums and products of coordinates, as a share of the largest coordinate.
const ROUNDING: f64 = 1e-13;

/// What has to be known about a distance, in metres.
#[derive(Clone, Copy)]
pub(crate) struct Limits<'a> {
    /// At or below this any upper bound will do.
    pub accept: f32,
    /// Done when the upper bound is at most this many times the lower one; at least 1.
    pub ratio: f32,
    /// Done when the lower bound is above this.
    pub give_up_above: f32,
    /// Cancelled: the bounds known by then are returned, the upper one possibly infinite.
    pub progress: Option<&'a Progress>,
}

impl Limits<'_> {
    /// Only the question "is it at most `limit_m`?": then and only then `upper <= limit_m`, apart
    /// from cases so close that the answer is the careful one.
    pub fn decide(limit_m: f32) -> Self {
        Self { accept: limit_m, ratio: 1.0, give_up_above: limit_m, progress: None }
    }

    /// The distance, to a factor of `ratio`, or to `accept` where it is smaller than that.
    pub fn value(ratio: f32, accept: f32) -> Self {
        Self { accept, ratio, give_up_above: f32::INFINITY, progress: None }
    }
}

/// Soups with more triangles are measured both ways at once: the first way would spare the second
/// some work, but few of them are left at a time.
const LARGE: usize = 4096;

/// Bounds of a distance in metres.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Distance {
    /// It is no smaller.
    pub lower: f32,
    /// It is no larger; infinite where something has no counterpart at some date.
    pub upper: f32,
}

/// Bounds of the time-exact Hausdorff distance of two soups, both ways. Rounding is counted in.
pub(crate) fn distance(
    a: &[Triangle],
    b: &[Triangle],
    presence: &PresenceTable,
    limits: Limits,
) -> Distance {
    if a.is_empty() && b.is_empty() {
        return Distance { lower: 0.0, upper: 0.0 };
    }
    let (tree_a, tree_b) = (SoupTree::new(a, presence), SoupTree::new(b, presence));
    distance_between((a, &tree_a), (b, &tree_b), presence, limits)
}

/// [`distance`] of soups whose trees are there already.
pub(crate) fn distance_between(
    a: (&[Triangle], &SoupTree),
    b: (&[Triangle], &SoupTree),
    presence: &PresenceTable,
    limits: Limits,
) -> Distance {
    let mut search = Search::new(limits);
    if a.0.len().max(b.0.len()) > LARGE {
        let mut back = Search::new(limits);
        rayon::join(|| search.one_way(a.0, b.1, presence), || back.one_way(b.0, a.1, presence));
        search.lower = search.lower.max(back.lower);
        search.upper = search.upper.max(back.upper);
    } else {
        search.one_way(a.0, b.1, presence);
        if !search.given_up() {
            search.one_way(b.0, a.1, presence);
        }
    }
    let corners = a.0.iter().chain(b.0).flat_map(|t| t.corners);
    let reach = corners.fold(0f32, |m, c| m.max(c.abs().max_element()));
    let slack = f64::from(reach) * ROUNDING;
    Distance {
        lower: ((search.lower - slack).max(0.0) as f32).next_down().max(0.0),
        upper: ((search.upper + slack) as f32).next_up(),
    }
}

/// A piece of a triangle that is not decided yet.
struct Piece {
    corners: [DVec3; 3],
    /// Upper bound in metres, and the triangle it comes from.
    upper: f64,
    item: u32,
    /// Place of its triangle in the soup.
    source: u32,
    /// Whether its corners count in the lower bound already.
    seen: bool,
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Piece {}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Piece {
    fn cmp(&self, other: &Self) -> Ordering {
        self.upper.total_cmp(&other.upper).then(other.source.cmp(&self.source))
    }
}

/// Both directions of one distance: they share what is known of it.
struct Search<'a> {
    limits: Limits<'a>,
    /// The farthest point found so far.
    lower: f64,
    /// The largest bound of a piece that was put aside, from both directions.
    upper: f64,
    heap: BinaryHeap<Piece>,
}

impl<'a> Search<'a> {
    fn new(limits: Limits<'a>) -> Self {
        Self { limits, lower: 0.0, upper: 0.0, heap: BinaryHeap::new() }
    }

    fn given_up(&self) -> bool {
        self.lower > f64::from(self.limits.give_up_above) || self.upper == f64::INFINITY
    }

    /// Pieces with a bound up to this need no further look.
    fn enough(&self) -> f64 {
        f64::from(self.limits.accept).max(self.lower * f64::from(self.limits.ratio.max(1.0)))
    }

    fn one_way(&mut self, from: &[Triangle], to: &SoupTree, presence: &PresenceTable) {
        for (source, triangle) in from.iter().enumerate() {
            if source.is_multiple_of(LOOKS_UP_EVERY) && self.cancelled() {
                self.upper = f64::INFINITY;
                return;
            }
            let corners = triangle.corners.map(|c| c.as_dvec3());
            let wanted = Wanted::new(triangle.behaviour, presence);
            let piece = Piece { corners, upper: 0.0, item: 0, source: source as u32, seen: false };
            self.add(piece, wanted, to, Nearest::NONE);
            if self.given_up() {
                // Something has no counterpart at all, whatever the distance.
                self.lower = f64::INFINITY;
                self.heap.clear();
                return;
            }
        }
        let mut halvings = HALVINGS + HALVINGS_PER_TRIANGLE * from.len();
        while let Some(piece) = self.heap.pop() {
            let done = piece.upper <= self.enough()
                || halvings == 0
                || self.given_up()
                || (halvings.is_multiple_of(LOOKS_UP_EVERY) && self.cancelled());
            if done {
                // The largest of those left.
                self.upper = self.upper.max(piece.upper);
                self.heap.clear();
                return;
            }
            halvings -= 1;
            let wanted = Wanted::new(from[piece.source as usize].behaviour, presence);
            self.halve(&piece, wanted, to);
        }
    }

    fn cancelled(&self) -> bool {
        self.limits.progress.is_some_and(|p| p.check().is_err())
    }

    /// Bounds a piece and keeps it in mind if the bound is not good enough.
    fn add(&mut self, mut piece: Piece, wanted: Wanted, to: &SoupTree, known: Nearest) {
        let enough = self.enough();
        let nearest = to.nearest(&piece.corners, wanted, known, enough * enough);
        piece.upper = nearest.squared.sqrt();
        piece.item = nearest.item;
        if piece.upper <= enough || piece.upper == f64::INFINITY {
            self.upper = self.upper.max(piece.upper);
        } else {
            self.heap.push(piece);
        }
    }

    /// Cuts a piece at the middle of its longest edge; the cut's end and the corners that were not
    /// looked at yet may be farther away than anything before.
    fn halve(&mut self, piece: &Piece, wanted: Wanted, to: &SoupTree) {
        let [a, b, c] = piece.corners;
        let (ab, bc, ca) = (a.distance_squared(b), b.distance_squared(c), c.distance_squared(a));
        // The longest edge is p to q.
        let (p, q, r) = if ab >= bc.max(ca) {
            (a, b, c)
        } else if bc >= ca {
            (b, c, a)
        } else {
            (c, a, b)
        };
        let length = p.distance(q);
        let middle = (p + q) * 0.5;
        self.look_at(middle, piece, wanted, to);
        if !piece.seen {
            [p, q, r].into_iter().for_each(|corner| self.look_at(corner, piece, wanted, to));
        }
        if length <= FINEST * self.enough() || middle == p || middle == q {
            self.upper = self.upper.max(piece.upper);
            return;
        }
        for corners in [[p, middle, r], [middle, q, r]] {
            let known = to.to_item(&corners, piece.item);
            self.add(Piece { corners, seen: true, ..*piece }, wanted, to, known);
        }
    }

    /// Raises the lower bound if a point is farther away than every one before.
    fn look_at(&mut self, point: DVec3, piece: &Piece, wanted: Wanted, to: &SoupTree) {
        let known = to.to_item(&[point], piece.item);
        let nearest = to.nearest(&[point], wanted, known, self.lower * self.lower);
        self.lower = self.lower.max(nearest.squared.sqrt());
    }
}

#[cfg(test)]
mod tests {
    use super::super::bvh::squared_distance;
    use super::*;
    use crate::{BehaviourId, Layer};
    use glam::Vec3;
    use proptest::prelude::*;
    use topout_schedule::{Behaviour, Time};

    fn behaviours() -> [Behaviour; 4] {
        let from = |toggles: &[i64]| {
            let toggles = toggles.iter().map(|&s| Time::from_seconds(s)).collect();
            Behaviour::new(false, toggles).expect("toggles increase")
        };
        [from(&[5]), from(&[9]), Behaviour::always(), from(&[3, 12])]
    }

    fn flat(corners: [Vec3; 3], behaviour: u32) -> Triangle {
        let (normals, layer) = ([[0, 0]; 3], Layer::Opaque);
        Triangle { corners, normals, material: 0, layer, behaviour: BehaviourId(behaviour) }
    }

    /// Two triangles of a square of side `side` whose corner is at `at`, in the plane of x and z.
    fn square(at: Vec3, side: f32, behaviour: u32) -> [Triangle; 2] {
        let [a, b, c, d] = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z].map(|v| at + v * side);
        [flat([a, b, c], behaviour), flat([a, c, d], behaviour)]
    }

    fn soup(most: usize) -> impl Strategy<Value = Vec<Triangle>> {
        let coordinate = || prop_oneof![(-4i32..4).prop_map(|v| v as f32), -4f32..4.0];
        let point = move || (coordinate(), coordinate(), coordinate()).prop_map(Vec3::from);
        let corners = prop_oneof![
            3 => [point(), point(), point()],
            // Needles, lines and points.
            1 => (point(), point(), 0f32..1.0, 0f32..1e-3)
                .prop_map(|(a, b, t, off)| [a, b, a.lerp(b, t) + Vec3::Y * off]),
            1 => (point(), point()).prop_map(|(a, b)| [a, b, a]),
            1 => point().prop_map(|a| [a; 3]),
        ];
        proptest::collection::vec((corners, 0u32..4).prop_map(|(c, b)| flat(c, b)), 1..most)
    }

    /// The farthest of many points of both soups, by brute force; infinite without counterpart.
    fn sampled(a: &[Triangle], b: &[Triangle]) -> f64 {
        const STEPS: i32 = 12;
        let known = behaviours();
        let mut worst = 0f64;
        for (from, to) in [(a, b), (b, a)] {
            for t in from {
                let [p, q, r] = t.corners.map(|c| c.as_dvec3());
                let there = |u: &&Triangle| {
                    known[u.behaviour.index()].includes(&known[t.behaviour.index()])
                };
                for i in 0..=STEPS {
                    for j in 0..=STEPS - i {
                        let (u, v) = (f64::from(i), f64::from(j));
                        let point = p + ((q - p) * u + (r - p) * v) / f64::from(STEPS);
                        let near = to
                            .iter()
                            .filter(there)
                            .map(|t| squared_distance(point, t.corners.map(|c| c.as_dvec3())));
                        worst = worst.max(near.fold(f64::INFINITY, f64::min).sqrt());
                    }
                }
            }
        }
        worst
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]
        /// The bounds hold and are as close as was asked; no sample is above the upper one.
        #[test]
        fn bounds_enclose_every_sample_and_are_close(a in soup(12), b in soup(12)) {
            let known = behaviours();
            let presence = PresenceTable::new(&known, true);
            let found = distance(&a, &b, &presence, Limits::value(1.1, 1e-3));
            let sampled = sampled(&a, &b);
            prop_assert!(f64::from(found.upper) >= sampled, "{found:?} below {sampled}");
            if sampled.is_finite() {
                prop_assert!(found.upper <= (found.lower * 1.1).max(1e-3) * 1.0001, "{found:?}");
                prop_assert!(f64::from(found.lower) <= sampled + 8.0 / 12.0, "{found:?} {sampled}");
            } else {
                prop_assert_eq!(found.upper, f32::INFINITY);
            }
        }

        /// A decision agrees with the value, unless the two are too close to tell.
        #[test]
        fn a_decision_is_right(a in soup(10), b in soup(10), share in 0.3f32..2.0) {
            let known = behaviours();
            let presence = PresenceTable::new(&known, false);
            let value = distance(&a, &b, &presence, Limits::value(1.01, 1e-4));
            let limit = value.upper * share;
            let verdict = distance(&a, &b, &presence, Limits::decide(limit)).upper <= limit;
            if limit >= value.upper * 1.01 {
                prop_assert!(verdict, "{value:?} is within {limit}");
            } else if limit < value.lower {
                prop_assert!(!verdict, "{value:?} is not within {limit}");
            }
        }

        #[test]
        fn a_soup_is_at_no_distance_from_itself(a in soup(30)) {
            let known = behaviours();
            let presence = PresenceTable::new(&known, true);
            let found = distance(&a, &a, &presence, Limits::value(1.1, 0.0));
            prop_assert!(found.lower == 0.0 && found.upper <= 1e-6, "{found:?}");
        }
    }

    #[test]
    fn the_distance_of_an_offset_plate_is_found_though_it_is_cut_differently() {
        let known = behaviours();
        let presence = PresenceTable::new(&known, true);
        let whole = square(Vec3::ZERO, 8.0, 2);
        let tiles: Vec<Triangle> = (0..64)
            .flat_map(|i| square(Vec3::new((i % 8) as f32, 0.25, (i / 8) as f32), 1.0, 2))
            .collect();
        let found = distance(&whole, &tiles, &presence, Limits::value(1.02, 0.0));
        assert!(found.lower <= 0.25 && found.upper >= 0.25, "{found:?}");
        assert!(found.lower > 0.249 && found.upper <= 0.2551, "{found:?}");
        // Without the tile at the far corner that corner is a tile's side away from the next one.
        let holed = distance(&whole, &tiles[..126], &presence, Limits::value(1.02, 0.0));
        let expected = 0.25f32.hypot(1.0);
        assert!(holed.lower <= expected && holed.upper >= expected, "{holed:?} {expected}");
    }

    #[test]
    fn who_is_not_there_stands_for_nobody() {
        let known = behaviours();
        let presence = PresenceTable::new(&known, true);
        let [early, late] = [square(Vec3::ZERO, 1.0, 0), square(Vec3::ZERO, 1.0, 1)];
        let both: Vec<Triangle> = early.iter().chain(&late).copied().collect();
        let limits = Limits::value(1.1, 1e-4);
        // The early one is there whenever the late one is, and not the other way round.
        assert!(distance(&both, &early, &presence, limits).upper < 1e-4);
        assert_eq!(distance(&both, &late, &presence, limits).upper, f32::INFINITY);
        let blind = PresenceTable::new(&known, false);
        assert!(distance(&both, &late, &blind, limits).upper < 1e-4);
    }

    #[test]
    fn nothing_is_infinitely_far_from_something() {
        let known = behaviours();
        let presence = PresenceTable::new(&known, true);
        let limits = Limits::decide(1.0);
        let one = square(Vec3::ZERO, 1.0, 0);
        assert_eq!(distance(&[], &[], &presence, limits).upper, 0.0);
        assert_eq!(distance(&one, &[], &presence, limits).upper, f32::INFINITY);
        assert_eq!(distance(&[], &one, &presence, limits).upper, f32::INFINITY);
    }

    #[test]
    fn cancelling_leaves_bounds_that_hold() {
        let known = behaviours();
        let presence = PresenceTable::new(&known, true);
        let progress = Progress::default();
        progress.cancel();
        let limits = Limits { progress: Some(&progress), ..Limits::decide(1.0) };
        let one = square(Vec3::ZERO, 1.0, 0);
        assert_eq!(distance(&one, &one, &presence, limits).upper, f32::INFINITY);
    }
}
