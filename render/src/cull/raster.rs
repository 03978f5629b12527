//! Drawing and asking a depth buffer in threads of this program, never nearer and never larger than the
//! adapter draws (occluders), never farther and never smaller (what is asked for).

use glam::{BVec4A, IVec2, Mat4, UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use rayon::prelude::*;
use std::ops::Deref;
use topout_scene::Projection;

#[cfg(test)]
mod tests;

/// Pixels by which edges may be moved: software adapters bring corners onto a grid of 1/256 pixel.
const SNAP_PX: f32 = 1.0 / 256.0;
/// Relative, what depths may differ by because of rounding.
const DEPTH_SLACK: f32 = 1e-5;
/// Relative to the largest coordinate, what positions may differ by because of rounding.
const POSITION_SLACK: f32 = 1.0 / (1 << 20) as f32;
/// Boxes with fewer pixels more than one across are small.
const SMALL: i32 = 8;
/// Corners farther out than so many pixels count as clipped: their roundings show.
const FAR_OUT_PX: f32 = 16384.0;
/// Texels along the side of a tile.
const TILE: i32 = 8;

/// Where the pixels of a part of a picture are in a table.
#[derive(Clone, Copy, Debug, Default)]
struct Grid {
    /// First pixel, and one past the last.
    low: IVec2,
    high: IVec2,
    /// From one row to the next. Some more texels follow the last pixel of a row, so that four can be taken
    /// at once from every pixel on.
    stride: usize,
}

impl Grid {
    /// The place of a pixel.
    fn index(&self, x: i32, y: i32) -> usize {
        (y - self.low.y) as usize * self.stride + (x - self.low.x) as usize
    }

    fn row(&self, y: i32, [first, last]: [i32; 2]) -> std::ops::Range<usize> {
        let start = self.index(first, y);
        start..start + (last - first) as usize + 1
    }

    /// Calls `visit` with the texels of a box of pixels, by fours, until it answers true; whether it did.
    fn any_four(&self, [low, high]: [IVec2; 2], mut visit: impl FnMut(Four) -> bool) -> bool {
        let extent = high - low;
        let mut row = self.index(low.x, low.y);
        for down in 0..=extent.y {
            let mut right = 0;
            while right <= extent.x {
                let within = LANES.cmple(Vec4::splat((extent.x - right) as f32));
                let at = row + right as usize;
                if visit(Four { at, right: right as f32, down: down as f32, within }) {
                    return true;
                }
                right += 4;
            }
            row += self.stride;
        }
        false
    }
}

/// Depth of a part of a picture, reversed: 0 is infinitely far.
#[derive(Debug, Default)]
pub(super) struct Depth {
    grid: Grid,
    texels: Vec<f32>,
    /// What is farthest in squares of [`TILE`] texels, row by row; see [`Depth::finish`].
    tiles: Vec<f32>,
    tile_stride: usize,
}

impl Depth {
    /// Nothing, in the pixels from `low` to one before `high`.
    pub fn clear(&mut self, [low, high]: [IVec2; 2]) {
        let extent = (high - low).as_usizevec2();
        self.grid = Grid { low, high, stride: extent.x + 3 };
        self.texels.clear();
        self.texels.resize(self.grid.stride * extent.y, 0.0);
        let tile = TILE as usize;
        self.tile_stride = extent.x.div_ceil(tile);
        self.tiles.clear();
        self.tiles.resize(self.tile_stride * extent.y.div_ceil(tile), 0.0);
    }

    /// Takes what is nearer in others of the same part of the picture, and makes the tiles.
    pub fn finish(&mut self, others: &[&Self]) {
        let (grid, tile) = (self.grid, TILE as usize);
        let width = (grid.high.x - grid.low.x) as usize;
        let band = grid.stride * tile;
        let tiles = self.tiles.par_chunks_mut(self.tile_stride.max(1));
        let texels = self.texels.par_chunks_mut(band.max(1));
        tiles.zip(texels).enumerate().for_each(|(at, (tiles, texels))| {
            for other in others {
                for (texel, nearer) in texels.iter_mut().zip(&other.texels[at * band..]) {
                    *texel = larger(*nearer, *texel);
                }
            }
            tiles.fill(f32::INFINITY);
            for row in texels.chunks(grid.stride) {
                for (tile, texels) in tiles.iter_mut().zip(row[..width].chunks(tile)) {
                    *tile = texels.iter().fold(*tile, |least, &texel| smaller(least, texel));
                }
            }
        });
    }

    /// What is farthest in the tile of a pixel.
    fn tile(&self, x: i32, y: i32) -> f32 {
        let at = (IVec2::new(x, y) - self.grid.low) / TILE;
        self.tiles[at.y as usize * self.tile_stride + at.x as usize]
    }

    /// Whether somewhere in a box of pixels nothing is nearer than `nearest`.
    fn is_open(&self, [low, high]: [IVec2; 2], nearest: f32) -> bool {
        let within = |box_px| {
            self.grid.any_four(box_px, |four| {
                (four.of(&self.texels).cmple(Vec4::splat(nearest)) & four.within).any()
            })
        };
        if (high - low).max_element() < 2 * TILE {
            return within([low, high]);
        }
        let mut y = low.y;
        while y <= high.y {
            let last_y = self.last_of_tile(y, self.grid.low.y).min(high.y);
            let mut x = low.x;
            while x <= high.x {
                let last_x = self.last_of_tile(x, self.grid.low.x).min(high.x);
                if self.tile(x, y) <= nearest
                    && within([IVec2::new(x, y), IVec2::new(last_x, last_y)])
                {
                    return true;
                }
                x = last_x + 1;
            }
            y = last_y + 1;
        }
        false
    }

    /// The last pixel of the tile of a pixel, along one axis.
    fn last_of_tile(&self, at: i32, low: i32) -> i32 {
        at + TILE - 1 - (at - low) % TILE
    }
}

/// Four texels beside each other.
struct Four {
    /// The place of the first.
    at: usize,
    /// How many pixels right of and below the box's first.
    right: f32,
    down: f32,
    /// Which are in the box.
    within: BVec4A,
}

impl Four {
    fn of(&self, texels: &[f32]) -> Vec4 {
        Vec4::from_slice(&texels[self.at..self.at + 4])
    }
}

const LANES: Vec4 = Vec4::new(0.0, 1.0, 2.0, 3.0);

/// What corners may be off by between here and the adapter. Those that end in `_near` are for corners one
/// metre before the eye, and less for those farther away.
#[derive(Clone, Copy, Debug)]
struct Slack {
    px: f32,
    px_near: f32,
    depth: f32,
    /// Relative.
    depth_near: f32,
}

/// The way from local space to pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screen {
    pixel_from_world: Mat4,
    /// First and last pixel.
    first: Vec4,
    last: Vec4,
    slack: Slack,
}

/// A corner of a triangle: pixels from the upper left, reversed depth and one over the distance from the eye's
/// plane (1 in parallel projection); infinite where it is clipped, or too far out to count on it.
pub(super) type Corner = Vec4;

/// First and last pixel.
pub(super) type BoxPx = [IVec2; 2];

/// The least and the most of some corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extremes {
    least: Vec4,
    most: Vec4,
}

impl Extremes {
    fn of([a, b, c]: [Corner; 3]) -> Self {
        Self { least: a.min(b).min(c), most: a.max(b).max(c) }
    }

    /// `None` without corners.
    fn of_all(corners: &[Corner]) -> Option<Self> {
        let (first, rest) = corners.split_first()?;
        Some(rest.iter().fold(Self { least: *first, most: *first }, |e, corner| Self {
            least: e.least.min(*corner),
            most: e.most.max(*corner),
        }))
    }

    fn is_clipped(&self) -> bool {
        self.most.w == f32::INFINITY
    }
}

/// Whether something may be seen.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Visible {
    No,
    Yes,
    /// It is not hidden all over its box.
    Perhaps(BoxPx),
}

impl Screen {
    /// Of pictures of `size` pixels, of which the part `area` (first, and one past the last) is looked at.
    /// `reach_m`: the largest coordinate that matters.
    pub fn new(
        clip_from_world: Mat4,
        projection: Projection,
        size: UVec2,
        area: [IVec2; 2],
        samples: u32,
        reach_m: f32,
    ) -> Self {
        let half = (size.as_vec2() * 0.5).extend(1.0);
        let pixel_from_clip = Mat4::from_translation(half.with_z(0.0))
            * Mat4::from_scale(half * Vec3::new(1.0, -1.0, 1.0));
        let off_m = reach_m * POSITION_SLACK;
        // Several samples may lie anywhere in a pixel.
        let px = if samples > 1 { 0.5 + SNAP_PX } else { SNAP_PX };
        let slack = match projection {
            Projection::Perspective { fov_y } => Slack {
                px,
                px_near: off_m * half.y / (fov_y * 0.5).tan(),
                depth: 0.0,
                depth_near: off_m,
            },
            Projection::Orthographic { height } => Slack {
                px: px + off_m * size.y as f32 / height,
                px_near: 0.0,
                depth: off_m * clip_from_world.row(2).xyz().length(),
                depth_near: 0.0,
            },
        };
        let wide = |v: IVec2| v.as_vec2().extend(0.0).extend(0.0);
        let pixel_from_world = pixel_from_clip * clip_from_world;
        Self { pixel_from_world, first: wide(area[0]), last: wide(area[1] - 1), slack }
    }

    pub fn corner(&self, position: [f32; 3]) -> Corner {
        project(self.pixel_from_world * Vec3::from(position).extend(1.0))
    }

    /// The same for what stands somewhere.
    pub fn placed(&self, world_from_mesh: Mat4) -> Self {
        Self { pixel_from_world: self.pixel_from_world * world_from_mesh, ..*self }
    }

    /// Pixels by which edges are moved, so that roundings do not matter.
    fn grow(&self, most: Vec4) -> f32 {
        self.slack.px + self.slack.px_near * most.w
    }

    /// The depth before which nothing of what has these extremes is.
    fn nearest(&self, most: Vec4) -> f32 {
        most.z * (1.0 + DEPTH_SLACK + self.slack.depth_near * most.w) + self.slack.depth
    }

    /// First and last of the pixels whose centres a box covers, or a little more, when its sides are moved
    /// outward by `grow`.
    fn pixels(&self, extremes: &Extremes, grow: f32) -> Option<BoxPx> {
        /// Added to a number it leaves the nearest whole number, plus 2^22, in the lowest 23 bits.
        const ROUND: f32 = 1.5 * (1 << 23) as f32;
        // A little less than half, so that what lies just at a whole number is not lost to rounding.
        let half = 0.499;
        let whole = |v: Vec4| {
            let bits = (v + ROUND).to_array().map(f32::to_bits);
            let [x, y, ..] = bits.map(|bits| (bits & 0x7f_ffff) as i32 - (1 << 22));
            IVec2::new(x, y)
        };
        // Centres lie at halves.
        let first = extremes.least + (half - (0.5 + grow));
        let last = extremes.most - (half + (0.5 - grow));
        let first = whole(first.max(self.first).min(self.last + 1.0));
        let last = whole(last.min(self.last).max(self.first - 1.0));
        (first.x <= last.x && first.y <= last.y).then_some([first, last])
    }

    /// A first look at a triangle.
    pub fn look(&self, corners: [Corner; 3], depth: &Depth) -> Visible {
        self.look_at_box(&Extremes::of(corners), depth)
    }

    fn look_at_box(&self, extremes: &Extremes, depth: &Depth) -> Visible {
        if extremes.is_clipped() {
            return Visible::Yes;
        }
        match self.pixels(extremes, self.grow(extremes.most)) {
            // Most that is hidden is hidden all over its box.
            Some(box_px) if depth.is_open(box_px, self.nearest(extremes.most)) => {
                Visible::Perhaps(box_px)
            }
            _ => Visible::No,
        }
    }

    /// Whether a triangle with such a box covers a pixel of it at which nothing is nearer.
    pub fn look_closely(&self, corners: [Corner; 3], depth: &Depth, box_px: BoxPx) -> bool {
        let extremes = Extremes::of(corners);
        let grow = self.grow(extremes.most);
        if is_small(box_px) {
            let edges = Edges::new(corners, grow, box_px[0]);
            return edges.may_be_seen(self.nearest(extremes.most), depth, box_px);
        }
        let plane = Plane::new(corners, &extremes, &self.slack);
        Rows::new(corners, grow, box_px).is_some_and(|rows| rows.may_be_seen(&plane, depth))
    }

    /// Whether one of the pixels of a box in space may show something of what is in it.
    pub fn may_show(&self, corners: [Vec3; 8], depth: &Depth) -> bool {
        let corners = corners.map(|corner| self.corner(corner.into()));
        let extremes = Extremes::of_all(&corners);
        extremes.is_some_and(|extremes| self.look_at_box(&extremes, depth) != Visible::No)
    }

    /// Draws a triangle, unless a corner is clipped.
    pub fn occlude(&self, corners: [Corner; 3], depth: &mut Depth) {
        let extremes = Extremes::of(corners);
        if extremes.is_clipped() {
            return;
        }
        let grow = -self.grow(extremes.most);
        let Some(box_px) = self.pixels(&extremes, grow) else { return };
        let plane = Plane::new(corners, &extremes, &self.slack);
        if plane.is_line {
            return;
        }
        if is_small(box_px) {
            Edges::new(corners, grow, box_px[0]).occlude(&plane, depth, box_px);
        } else if let Some(rows) = Rows::new(corners, grow, box_px) {
            rows.occlude(&plane, depth);
        }
    }

    /// Draws a flat convex polygon of at most [`MOST_CORNERS`] corners, or the part of it that is not clipped:
    /// between triangles that are drawn one by one, seams stay open.
    pub fn occlude_polygon(&self, positions: &[[f32; 3]], depth: &mut Depth) {
        let clip = |p: &[f32; 3]| self.pixel_from_world * Vec3::from(*p).extend(1.0);
        let mut polygon = Polygon::new(positions.iter().map(clip));
        let mut corners = polygon.map(project);
        if corners.iter().any(|corner| corner.w == f32::INFINITY) {
            // Inside where the product with each is not negative: before the far plane, behind the near one,
            // and not too far out.
            let margin = 2048.0;
            let (low, high) = (self.first - margin, self.last + margin);
            let planes = [
                Vec4::new(0.0, 0.0, 1.0, 0.0),
                Vec4::new(0.0, 0.0, -1.0, 1.0),
                Vec4::new(1.0, 0.0, 0.0, -low.x),
                Vec4::new(-1.0, 0.0, 0.0, high.x),
                Vec4::new(0.0, 1.0, 0.0, -low.y),
                Vec4::new(0.0, -1.0, 0.0, high.y),
            ];
            for plane in planes {
                polygon = polygon.cut(plane);
            }
            // What was cut at the near plane may lie a rounding before it.
            let kept = |clip: Vec4| project(clip.with_z(clip.z.clamp(0.0, clip.w.max(0.0))));
            corners = polygon.map(kept);
        }
        let Some(extremes) = Extremes::of_all(&corners).filter(|e| !e.is_clipped()) else { return };
        let grow = -self.grow(extremes.most);
        let Some(box_px) = self.pixels(&extremes, grow) else { return };
        let Some(largest) = largest_triangle(&corners) else { return };
        let plane = Plane::new(largest, &extremes, &self.slack);
        if !plane.is_line
            && let Some(rows) = Rows::<ROOM>::around(&corners, grow, box_px)
        {
            rows.occlude(&plane, depth);
        }
    }
}

/// Twice the area of a triangle on the picture, with a sign.
fn area([a, b, c]: [Corner; 3]) -> f32 {
    (b - a).xy().perp_dot((c - a).xy())
}

/// The largest of the triangles between the first corner and two that follow each other.
fn largest_triangle(corners: &[Corner]) -> Option<[Corner; 3]> {
    let (first, rest) = corners.split_first()?;
    let triangles = rest.windows(2).map(|pair| [*first, pair[0], pair[1]]);
    triangles.max_by(|a, b| area(*a).abs().total_cmp(&area(*b).abs()))
}

fn project(clip: Vec4) -> Corner {
    let scale = clip.w.recip();
    let at = clip * scale;
    let kept =
        (0.0..=clip.w).contains(&clip.z) && at.x.abs() < FAR_OUT_PX && at.y.abs() < FAR_OUT_PX;
    at.with_w(if kept { scale } else { f32::INFINITY })
}

/// Corners that a polygon may be drawn with.
pub(super) const MOST_CORNERS: usize = 4;
/// One more for each plane that it is cut at.
const ROOM: usize = MOST_CORNERS + 6;

/// A convex polygon.
struct Polygon {
    corners: [Vec4; ROOM],
    count: usize,
}

impl Polygon {
    /// Of the first [`ROOM`] corners.
    fn new(corners: impl Iterator<Item = Vec4>) -> Self {
        let mut new = Self { corners: [Vec4::ZERO; ROOM], count: 0 };
        corners.for_each(|corner| new.push(corner));
        new
    }

    fn push(&mut self, corner: Vec4) {
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
            self.count += 1;
        }
    }

    fn map(&self, change: impl Fn(Vec4) -> Vec4) -> Self {
        Self::new(self.iter().copied().map(change))
    }

    /// What is on the inner side of a plane: at most one corner more.
    fn cut(&self, plane: Vec4) -> Self {
        let mut out = Self::new(std::iter::empty());
        for (i, &a) in self.iter().enumerate() {
            let b = self[(i + 1) % self.count];
            let (inner_a, inner_b) = (plane.dot(a), plane.dot(b));
            if inner_a >= 0.0 {
                out.push(a);
            }
            if (inner_a >= 0.0) != (inner_b >= 0.0) {
                out.push(a.lerp(b, inner_a / (inner_a - inner_b)));
            }
        }
        out
    }
}

impl Deref for Polygon {
    type Target = [Vec4];

    fn deref(&self) -> &[Vec4] {
        &self.corners[..self.count]
    }
}

/// The depth of a triangle over the picture, where it is linear, and what it may be off by: an absolute and a
/// relative part.
#[derive(Clone, Copy, Debug)]
struct Plane {
    /// The farthest corner.
    origin: Vec2,
    depth: f32,
    /// A pixel to the right, and down.
    slope: Vec2,
    /// The triangle is a line on the picture: its nearest depth stands for all.
    is_line: bool,
    nearest: f32,
    farthest: f32,
    off: f32,
    off_relative: f32,
}

impl Plane {
    /// Of three corners of something flat with these extremes.
    fn new([a, b, c]: [Corner; 3], extremes: &Extremes, slack: &Slack) -> Self {
        // From the farthest corner on: from a near one, where depths are large, roundings would be, too.
        let [p, q, r] = if a.z <= b.z && a.z <= c.z {
            [a, b, c]
        } else if b.z <= c.z {
            [b, c, a]
        } else {
            [c, a, b]
        };
        let (across, over) = (q - p, r - p);
        let area = across.x * over.y - across.y * over.x;
        let slope =
            Vec2::new(across.z * over.y - over.z * across.y, over.z * across.x - across.z * over.x)
                / area;
        let is_line = !slope.is_finite();
        let slope = if is_line { Vec2::ZERO } else { slope };
        let steep = slope.x.abs() + slope.y.abs();
        let (nearest, farthest, near) = (extremes.most.z, extremes.least.z, extremes.most.w);
        Self {
            origin: Vec2::new(p.x, p.y),
            depth: if is_line { nearest } else { p.z },
            slope,
            is_line,
            nearest,
            farthest: farthest * (1.0 - DEPTH_SLACK - slack.depth_near * near) - slack.depth,
            off: steep * slack.px + slack.depth,
            // A corner at distance w is off by `px_near / w` pixels, and a point between corners by no more
            // than one there: so what it makes of the depth near/w falls with the depth.
            off_relative: DEPTH_SLACK
                + near * (slack.depth_near + slack.px_near * steep / larger(nearest, 1e-30)),
        }
    }

    /// At the middle of a pixel.
    fn at(&self, x: i32, y: i32) -> f32 {
        self.depth + self.slope.dot(Vec2::new(x as f32, y as f32) + 0.5 - self.origin)
    }

    /// No nearer than it is.
    fn behind(&self, here: Vec4) -> Vec4 {
        let behind = here * (1.0 - self.off_relative) - self.off;
        behind.max(Vec4::splat(self.farthest)).min(Vec4::splat(self.nearest))
    }
}

/// The pixels of a triangle whose centres it covers, row by row.
struct Rows<const EDGES: usize> {
    /// First and last pixel.
    low: IVec2,
    high: IVec2,
    /// Its first corner, to which all else is relative.
    origin: Vec2,
    /// For each edge: where its line meets a row is `at.x + at.y * y`; pixels are right of it (1), left
    /// of it (-1), or the whole row is on one side (0), inside where `at.x + at.y * y >= 0`.
    edges: [(Vec2, i8); EDGES],
}

impl Rows<3> {
    /// `grow`: pixels by which the edges are moved outward; the box says which pixels to look at. `None`
    /// where none can be covered.
    fn new(corners: [Corner; 3], grow: f32, [low, high]: BoxPx) -> Option<Self> {
        if area(corners).recip().is_finite() {
            return Self::around(&corners, grow, [low, high]);
        }
        // A line has no inside, so all pixels of its box count.
        let edges = [(Vec2::ZERO, 0); 3];
        (grow >= 0.0).then_some(Self { low, high, origin: Vec2::ZERO, edges })
    }
}

impl<const EDGES: usize> Rows<EDGES> {
    /// Within the edges of a convex polygon of at most so many corners.
    fn around(corners: &[Corner], grow: f32, [low, high]: BoxPx) -> Option<Self> {
        let turn = area(largest_triangle(corners)?).signum();
        let origin = corners[0].xy();
        let mut edges = [(Vec2::ZERO, 0); EDGES];
        for (i, edge) in edges.iter_mut().enumerate().take(corners.len()) {
            let a = corners[i].xy() - origin;
            let along = (corners[(i + 1) % corners.len()].xy() - origin - a) * turn;
            // Inside where x * normal.x + y * normal.y + offset >= 0.
            let normal = Vec2::new(-along.y, along.x);
            let offset = grow * (along.x.abs() + along.y.abs()) - normal.dot(a);
            *edge = if normal.x == 0.0 {
                (Vec2::new(offset, normal.y), 0)
            } else {
                let at = Vec2::new(-offset / normal.x, -normal.y / normal.x);
                (at, if normal.x > 0.0 { 1 } else { -1 })
            };
        }
        Some(Self { low, high, origin, edges })
    }

    /// First and last pixel of a row.
    fn row(&self, y: i32) -> Option<[i32; 2]> {
        let middle = y as f32 + 0.5 - self.origin.y;
        let (mut left, mut right) = (f32::NEG_INFINITY, f32::INFINITY);
        for (at, side) in &self.edges {
            let x = at.x + at.y * middle;
            match side {
                1 => left = larger(x, left),
                -1 => right = smaller(x, right),
                _ if x < 0.0 => return None,
                _ => {}
            }
        }
        let to_pixel = self.origin.x - 0.5;
        let first = ceil(left + to_pixel).max(self.low.x);
        let last = floor(right + to_pixel).min(self.high.x);
        (first <= last).then_some([first, last])
    }

    fn occlude(&self, plane: &Plane, depth: &mut Depth) {
        for y in self.low.y..=self.high.y {
            let Some(x) = self.row(y) else { continue };
            let mut here = LANES * plane.slope.x + plane.at(x[0], y);
            let texels = &mut depth.texels[depth.grid.row(y, x)];
            let mut fours = texels.chunks_exact_mut(4);
            for four in &mut fours {
                Vec4::from_slice(four).max(plane.behind(here)).write_to_slice(four);
                here += 4.0 * plane.slope.x;
            }
            for (texel, here) in
                fours.into_remainder().iter_mut().zip(plane.behind(here).to_array())
            {
                *texel = larger(here, *texel);
            }
        }
    }

    fn may_be_seen(&self, plane: &Plane, depth: &Depth) -> bool {
        let nearest = plane.nearest * (1.0 + plane.off_relative) + plane.off;
        (self.low.y..=self.high.y).any(|y| {
            let Some([mut x, last]) = self.row(y) else { return false };
            while x <= last {
                let to = depth.last_of_tile(x, depth.grid.low.x).min(last);
                if depth.tile(x, y) <= nearest {
                    let mut here = plane.at(x, y);
                    let open = depth.texels[depth.grid.row(y, [x, to])].iter().any(|&texel| {
                        let before = here * (1.0 + plane.off_relative) + plane.off;
                        here += plane.slope.x;
                        texel <= smaller(before, nearest)
                    });
                    if open {
                        return true;
                    }
                }
                x = to + 1;
            }
            false
        })
    }
}

/// The edges of a triangle with a small box, for four pixels at a time, which saves the divisions of
/// [`Rows`].
struct Edges {
    /// For each: how far inside the box's first four pixels are, in pixels times the edge's length, and what
    /// a step to the right and down adds.
    edges: [(Vec4, Vec2); 3],
}

impl Edges {
    /// The edges are moved outward by `grow`.
    fn new(corners: [Corner; 3], grow: f32, low: IVec2) -> Self {
        let start = low.as_vec2() + 0.5;
        let [p, q, r] = corners.map(|corner| corner.xy() - start);
        let turn = (q - p).perp_dot(r - p).signum();
        let edge = |a: Vec2, b: Vec2| {
            let along = (b - a) * turn;
            let inward = Vec2::new(-along.y, along.x);
            let first = grow * (along.x.abs() + along.y.abs()) - inward.dot(a);
            (LANES * inward.x + first, inward)
        };
        Self { edges: [edge(p, q), edge(q, r), edge(r, p)] }
    }

    /// Which of four pixels the triangle covers.
    fn cover(&self, four: &Four) -> BVec4A {
        let [p, q, r] =
            self.edges.map(|(at, step)| at + (step.x * four.right + step.y * four.down));
        p.min(q).min(r).cmpge(Vec4::ZERO) & four.within
    }

    fn occlude(&self, plane: &Plane, depth: &mut Depth, box_px: BoxPx) {
        let [low, _] = box_px;
        let first = LANES * plane.slope.x + plane.at(low.x, low.y);
        depth.grid.any_four(box_px, |four| {
            let here = first + (plane.slope.x * four.right + plane.slope.y * four.down);
            let here = Vec4::select(self.cover(&four), plane.behind(here), Vec4::ZERO);
            four.of(&depth.texels).max(here).write_to_slice(&mut depth.texels[four.at..]);
            false
        });
    }

    /// Whether nothing is nearer than `nearest` at one of the pixels that the triangle covers.
    fn may_be_seen(&self, nearest: f32, depth: &Depth, box_px: BoxPx) -> bool {
        depth.grid.any_four(box_px, |four| {
            let open = four.of(&depth.texels).cmple(Vec4::splat(nearest));
            (open & self.cover(&four)).any()
        })
    }
}

/// Whether a box is small enough for [`Edges`].
fn is_small([low, high]: BoxPx) -> bool {
    (high - low).max_element() < SMALL
}

/// The larger of two numbers, neither of which is none.
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, neither of which is none.
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The largest whole number not above, where that is not negative; what is negative is cut at -1.
fn floor(x: f32) -> i32 {
    if x < 0.0 { -1 } else { x as i32 }
}

/// The smallest whole number not below, where that is not negative.
fn ceil(x: f32) -> i32 {
    let cut = x.max(0.0) as i32;
    cut + i32::from((cut as f32) < x)
}
