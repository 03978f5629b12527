//! The CPU twin of [`super::gpu`], for adapters that are programs on the CPU themselves: there the
//! kernels cost more than what they save, and this, with the depth of the occluders drawn here too, a
//! fraction of it.

use super::Item;
use glam::{BVec4A, IVec2, Mat4, UVec2, Vec2, Vec3, Vec4};
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use topout_scene::Hdlod;

/// Pixels by which edges may be moved: software adapters bring corners onto a grid of 1/256 pixel.
const SNAP_PX: f32 = 1.0 / 64.0;
/// Relative, what depths may differ by because of rounding.
const DEPTH_SLACK: f32 = 1e-5;
/// Items that a thread takes at a time.
const PORTION: usize = 64;
/// Boxes with fewer pixels more than one across are small.
const SMALL: i32 = 8;
/// Frames after which a triangle that was seen is looked at closely again.
const LOOK_AGAIN: usize = 4;
/// More threads than this only wait for each other.
const MOST_THREADS: usize = 4;

/// Where the pixels of a part of a picture are in a table.
#[derive(Clone, Copy, Debug, Default)]
struct Grid {
    /// First pixel.
    low: IVec2,
    /// From one row to the next. Some more texels follow the last pixel of a row, so that four can be taken
    /// at once from every pixel on.
    stride: usize,
}

impl Grid {
    /// The place of a pixel.
    fn index(&self, x: i32, y: i32) -> usize {
        (y - self.low.y) as usize * self.stride + (x - self.low.x) as usize
    }

    fn row(&self, y: i32, x: [i32; 2]) -> std::ops::Range<usize> {
        let first = self.index(x[0], y);
        first..first + (x[1] - x[0]) as usize + 1
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
struct Depth {
    grid: Grid,
    texels: Vec<f32>,
}

impl Depth {
    fn clear(&mut self, low: IVec2, high: IVec2) {
        let extent = (high - low).as_usizevec2();
        self.grid = Grid { low, stride: extent.x + 3 };
        self.texels.clear();
        self.texels.resize(self.grid.stride * extent.y, 0.0);
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

/// The way from local space to pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screen {
    pixel_from_world: Mat4,
}

impl Screen {
    pub fn new(clip_from_world: Mat4, size: UVec2) -> Self {
        let half = (size.as_vec2() * 0.5).extend(1.0);
        let pixel_from_clip = Mat4::from_translation(half.with_z(0.0))
            * Mat4::from_scale(half * Vec3::new(1.0, -1.0, 1.0));
        Self { pixel_from_world: pixel_from_clip * clip_from_world }
    }

    /// Pixels from the upper left and reversed depth; then 0, or 1 before the near or behind the far plane,
    /// where the GPU clips.
    fn corner(&self, position: [f32; 3]) -> Vec4 {
        let clip = self.pixel_from_world * Vec3::from(position).extend(1.0);
        let clipped = if (0.0..=clip.w).contains(&clip.z) { 0.0 } else { 1.0 };
        (clip * clip.w.recip()).with_w(clipped)
    }
}

/// Corners of a triangle as [`Screen::corner`] gives them.
type Corners = [Vec4; 3];

/// The largest whole number not above, where that is not negative; what is negative is cut at -1.
fn floor(x: f32) -> i32 {
    if x < 0.0 { -1 } else { x as i32 }
}

/// The smallest whole number not below, where that is not negative.
fn ceil(x: f32) -> i32 {
    let cut = x.max(0.0) as i32;
    cut + i32::from((cut as f32) < x)
}

/// The part of a picture in which pixels are looked for.
#[derive(Clone, Copy, Debug)]
struct Area {
    /// First and last pixel.
    first: Vec4,
    last: Vec4,
    /// What is added to the least and to the most of a box to have its pixels by rounding.
    to_first: f32,
    to_last: f32,
}

impl Area {
    /// Added to a number it leaves the nearest whole number, plus 2^22, in the lowest 23 bits.
    const ROUND: f32 = 1.5 * (1 << 23) as f32;
    /// A little less than half, so that what lies just at a whole number is not lost to rounding.
    const HALF: f32 = 0.499;

    /// Of the pixels from `low` to one before `high`. The sides of boxes are moved outward by `grow`.
    fn new(low: IVec2, high: IVec2, grow: f32) -> Self {
        let wide = |v: IVec2| v.as_vec2().extend(0.0).extend(0.0);
        Self {
            first: wide(low),
            last: wide(high - 1),
            // Centres lie at halves.
            to_first: Self::HALF - (0.5 + grow),
            to_last: -(0.5 - grow) - Self::HALF,
        }
    }

    /// First and last of the pixels whose centres a box covers, or a little more; `least` and `most` of its
    /// corners.
    fn pixels(&self, least: Vec4, most: Vec4) -> Option<[IVec2; 2]> {
        let whole = |v: Vec4| {
            let bits = (v + Self::ROUND).to_array().map(f32::to_bits);
            let [x, y, ..] = bits.map(|bits| (bits & 0x7f_ffff) as i32 - (1 << 22));
            IVec2::new(x, y)
        };
        let first = (least + self.to_first).max(self.first).min(self.last + 1.0);
        let last = (most + self.to_last).min(self.last).max(self.first - 1.0);
        let (first, last) = (whole(first), whole(last));
        (first.x <= last.x && first.y <= last.y).then_some([first, last])
    }
}

/// The pixels of a triangle whose centres it covers, row by row, with depths.
struct Rows {
    /// First and last pixel.
    low: IVec2,
    high: IVec2,
    /// Its first corner, to which all else is relative.
    origin: Vec2,
    /// For each edge: where its line meets a row is `at.x + at.y * y`; pixels are right of it (1), left
    /// of it (-1), or the whole row is on one side (0), inside where `at.x + at.y * y >= 0`.
    edges: [(Vec2, i8); 3],
    /// Depth at the origin and its gradient.
    depth: f32,
    slope: Vec2,
    nearest: f32,
    farthest: f32,
    /// What the depth may be wrong by.
    slack: f32,
}

impl Rows {
    /// `grow`: pixels by which the edges are moved outward; `area`: the pixels to look at. `None` where
    /// none can be covered.
    fn new(corners: Corners, grow: f32, [low, high]: [IVec2; 2]) -> Option<Self> {
        let [p, q, r] = corners.map(Vec4::truncate);
        let origin = p.truncate();
        let (across, over) = (q - p, r - p);
        let area = across.x * over.y - across.y * over.x;
        let slope =
            Vec2::new(across.z * over.y - over.z * across.y, over.z * across.x - across.z * over.x)
                / area;
        let flat = slope.is_finite();
        if !flat && grow < 0.0 {
            return None;
        }
        let slope = if flat { slope } else { Vec2::ZERO };
        let corners = [Vec2::ZERO, across.truncate(), over.truncate()];
        let edge = |i: usize| {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            let along = (b - a) * area.signum();
            // Inside where x * normal.x + y * normal.y + offset >= 0.
            let normal = Vec2::new(-along.y, along.x);
            let offset = grow * (along.x.abs() + along.y.abs()) - normal.dot(a);
            if normal.x == 0.0 {
                (Vec2::new(offset, normal.y), 0)
            } else {
                let at = Vec2::new(-offset / normal.x, -normal.y / normal.x);
                (at, if normal.x > 0.0 { 1 } else { -1 })
            }
        };
        let (nearest, farthest) = (p.z.max(q.z).max(r.z), p.z.min(q.z).min(r.z));
        Some(Self {
            low,
            high,
            origin,
            // A line has no inside, so all pixels of its box count.
            edges: if flat { [edge(0), edge(1), edge(2)] } else { [(Vec2::ZERO, 0); 3] },
            depth: if flat { p.z } else { nearest },
            slope,
            nearest,
            farthest,
            slack: (slope.x.abs() + slope.y.abs()) * grow.abs() + nearest * DEPTH_SLACK,
        })
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

    /// Depth at the middle of a pixel.
    fn depth_at(&self, x: i32, y: i32) -> f32 {
        let at = Vec2::new(x as f32, y as f32) + 0.5 - self.origin;
        self.depth + self.slope.dot(at)
    }

    fn occlude(&self, depth: &mut Depth) {
        let farthest = self.farthest * (1.0 - DEPTH_SLACK);
        for y in self.low.y..=self.high.y {
            let Some(x) = self.row(y) else { continue };
            let mut here = self.depth_at(x[0], y) - self.slack;
            let range = depth.grid.row(y, x);
            for texel in &mut depth.texels[range] {
                *texel = larger(*texel, smaller(larger(here, farthest), self.nearest));
                here += self.slope.x;
            }
        }
    }

    fn may_be_seen(&self, depth: &Depth) -> bool {
        let nearest = self.nearest * (1.0 + DEPTH_SLACK);
        (self.low.y..=self.high.y).any(|y| {
            let Some(x) = self.row(y) else { return false };
            let mut here = self.depth_at(x[0], y) + self.slack;
            depth.texels[depth.grid.row(y, x)].iter().any(|&occluder| {
                let seen = smaller(here, nearest) >= occluder;
                here += self.slope.x;
                seen
            })
        })
    }
}

/// The edges of a triangle with a small box, for four pixels at a time, which saves the divisions of
/// [`Rows`].
struct Edges {
    /// For each: how far inside the box's first four pixels are, in pixels times the edge's length, and what
    /// a step to the right and down adds.
    edges: [(Vec4, Vec2); 3],
    /// Twice the triangle's area, with a sign.
    area: f32,
    /// The middle of the box's first pixel, seen from the first corner.
    start: Vec2,
}

impl Edges {
    /// The edges are moved outward by `grow`.
    fn new([p, q, r]: Corners, grow: f32, low: IVec2) -> Self {
        let start = low.as_vec2() + 0.5;
        let [p, q, r] = [p, q, r].map(|corner| Vec2::new(corner.x, corner.y) - start);
        let area = (q - p).perp_dot(r - p);
        let edge = |a: Vec2, b: Vec2| {
            let along = (b - a) * area.signum();
            let inward = Vec2::new(-along.y, along.x);
            let first = grow * (along.x.abs() + along.y.abs()) - inward.dot(a);
            (LANES * inward.x + first, inward)
        };
        Self { edges: [edge(p, q), edge(q, r), edge(r, p)], area, start: -p }
    }

    /// Which of four pixels the triangle covers.
    fn cover(&self, four: &Four) -> BVec4A {
        let [p, q, r] =
            self.edges.map(|(at, step)| at + (step.x * four.right + step.y * four.down));
        p.min(q).min(r).cmpge(Vec4::ZERO) & four.within
    }

    fn occlude(&self, [p, q, r]: Corners, grow: f32, depth: &mut Depth, box_px: [IVec2; 2]) {
        let (across, over) = (q - p, r - p);
        let slope =
            Vec2::new(across.z * over.y - over.z * across.y, over.z * across.x - across.z * over.x)
                / self.area;
        if !slope.is_finite() {
            return;
        }
        let nearest = larger(larger(p.z, q.z), r.z);
        let farthest = smaller(smaller(p.z, q.z), r.z) * (1.0 - DEPTH_SLACK);
        let slack = (slope.x.abs() + slope.y.abs()) * grow.abs() + nearest * DEPTH_SLACK;
        let first = LANES * slope.x + (p.z + slope.dot(self.start) - slack);
        let (nearest, farthest) = (Vec4::splat(nearest), Vec4::splat(farthest));
        depth.grid.any_four(box_px, |four| {
            let here = first + (slope.x * four.right + slope.y * four.down);
            let here = here.max(farthest).min(nearest);
            let here = Vec4::select(self.cover(&four), here, Vec4::ZERO);
            four.of(&depth.texels).max(here).write_to_slice(&mut depth.texels[four.at..]);
            false
        });
    }

    /// Whether one of the pixels that the triangle covers is not nearer than `nearest`.
    fn may_be_seen(&self, nearest: f32, depth: &Depth, box_px: [IVec2; 2]) -> bool {
        depth.grid.any_four(box_px, |four| {
            let open = four.of(&depth.texels).cmple(Vec4::splat(nearest));
            (open & self.cover(&four)).any()
        })
    }
}

/// The larger of two numbers, neither of which is none.
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, neither of which is none.
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Whether a triangle may be seen.
enum Visible {
    No,
    Yes,
    /// It is not hidden all over its box, whose first and last pixels these are.
    Perhaps([IVec2; 2]),
}

/// A first look at a triangle, of whose corners the `least` and the `most` are given.
fn look(least: Vec4, most: Vec4, area: &Area, depth: &Depth) -> Visible {
    // A corner is clipped.
    if most.w > 0.0 {
        return Visible::Yes;
    }
    let Some(box_px) = area.pixels(least, most) else { return Visible::No };
    // Most that is hidden is hidden all over its box.
    let nearest = most.z * (1.0 + DEPTH_SLACK);
    let open =
        |four: Four| (four.of(&depth.texels).cmple(Vec4::splat(nearest)) & four.within).any();
    if depth.grid.any_four(box_px, open) { Visible::Perhaps(box_px) } else { Visible::No }
}

/// Whether a box is small enough for [`Edges`].
fn is_small([low, high]: [IVec2; 2]) -> bool {
    (high - low).max_element() < SMALL
}

/// Whether a triangle, the nearest of whose corners is given, covers one of the pixels of its box at which
/// nothing of the occluders is nearer.
fn look_closely(
    corners: Corners,
    most: Vec4,
    grow: f32,
    depth: &Depth,
    box_px: [IVec2; 2],
) -> bool {
    if is_small(box_px) {
        let nearest = most.z * (1.0 + DEPTH_SLACK);
        return Edges::new(corners, grow, box_px[0]).may_be_seen(nearest, depth, box_px);
    }
    Rows::new(corners, grow, box_px).is_some_and(|rows| rows.may_be_seen(depth))
}

/// Draws an occluder.
fn draw(corners: Corners, grow: f32, depth: &mut Depth, box_px: [IVec2; 2]) {
    if is_small(box_px) {
        Edges::new(corners, grow, box_px[0]).occlude(corners, grow, depth, box_px);
    } else if let Some(rows) = Rows::new(corners, grow, box_px) {
        rows.occlude(depth);
    }
}

/// The least and the most of three corners.
fn extremes([a, b, c]: Corners) -> (Vec4, Vec4) {
    (a.min(b).min(c), a.max(b).max(c))
}

/// What became of a portion of the items.
#[derive(Debug, Default)]
struct Portion {
    /// Corners of the items' triangles on the picture.
    corners: Vec<Vec4>,
    /// For each item, where its corners are.
    places: Vec<Place>,
    /// Indices of what is left, opaque and transparent.
    packed: [Vec<u32>; 2],
}

/// Where the corners of an item's triangles are within [`Portion::corners`].
#[derive(Clone, Copy, Debug)]
struct Place {
    start: usize,
    /// The index of the vertex that comes first; `None` if there are three corners for each triangle.
    first: Option<u32>,
}

impl Portion {
    /// Vertices of an item that are brought to the picture together, whether they are needed or not.
    const MOST: u32 = 256;

    /// Brings the items' vertices to the picture: all between the first and the last of an item, since
    /// neighbours share them, so most are needed. Where they are far apart, each corner alone.
    fn place(&mut self, cut: &Cut<'_>, items: &[Item]) {
        self.corners.clear();
        self.places.clear();
        for item in items {
            let indices = cut.indices(item);
            let (least, most) =
                indices.iter().fold((u32::MAX, 0), |(least, most), &i| (least.min(i), most.max(i)));
            let together = most - least < Self::MOST.min(item.count * 4);
            let place = Place { start: self.corners.len(), first: together.then_some(least) };
            self.places.push(place);
            if together {
                let base = item.base_vertex as usize;
                let vertices = &cut.tree.vertices[least as usize + base..most as usize + base + 1];
                self.corners.extend(vertices.iter().map(|v| cut.screen.corner(v.position)));
            } else {
                self.corners.extend(indices.iter().map(|&index| {
                    let vertex = &cut.tree.vertices[(index + item.base_vertex) as usize];
                    cut.screen.corner(vertex.position)
                }));
            }
        }
    }

    /// Corners of the triangles of an item, the `slot`th of the portion, with their bits, out of `which`.
    fn triangles(
        &self,
        cut: &Cut<'_>,
        slot: usize,
        item: &Item,
        which: u32,
    ) -> impl Iterator<Item = (u32, Corners)> {
        let Place { start, first } = self.places[slot];
        let corners = &self.corners[start..];
        let indices = cut.indices(item);
        bits(which).map(move |bit| {
            let at = bit as usize * 3;
            let corner = match first {
                Some(first) => [0, 1, 2].map(|k| corners[(indices[at + k] - first) as usize]),
                None => [0, 1, 2].map(|k| corners[at + k]),
            };
            (bit, corner)
        })
    }
}

/// The cut of a frame.
pub(super) struct Cut<'a> {
    pub items: &'a [Item],
    /// Those of the opaque layer come first.
    pub opaque_items: usize,
    pub tree: &'a Hdlod,
    pub screen: Screen,
    pub samples: u32,
    /// x, y, width and height of the part of the picture where the scene can be.
    pub covered: [u32; 4],
}

impl Cut<'_> {
    /// Three for each of the item's triangles, without its base.
    fn indices(&self, item: &Item) -> &[u32] {
        let from = item.triangle as usize * 3;
        &self.tree.indices[from..from + item.count as usize * 3]
    }

    /// Pixels by which edges are moved, so that roundings do not matter.
    fn grow(&self) -> f32 {
        // Several samples may lie anywhere in a pixel.
        if self.samples > 1 { 0.5 + SNAP_PX } else { SNAP_PX }
    }

    fn area(&self) -> [IVec2; 2] {
        let [x, y, width, height] = self.covered.map(|v| v as i32);
        [IVec2::new(x, y), IVec2::new(x + width, y + height)]
    }
}

/// All triangles of an item.
fn whole(item: &Item) -> u32 {
    u32::MAX >> (32 - item.count)
}

/// The part of a word of a table of bits, one a triangle, that an item stands for.
fn part(word: u32, item: &Item) -> u32 {
    (word >> (item.triangle % 32)) & whole(item)
}

fn bits(mut mask: u32) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let bit = mask.trailing_zeros();
        mask &= mask.wrapping_sub(1);
        (bit < 32).then_some(bit)
    })
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn inner<T>(mutex: &mut Mutex<T>) -> &mut T {
    mutex.get_mut().unwrap_or_else(PoisonError::into_inner)
}

/// Leaves out triangles that nobody sees; see the file's head.
#[derive(Debug)]
pub(crate) struct CpuCuller {
    threads: rayon::ThreadPool,
    /// Each thread's occluders; those of all in the first.
    depths: Vec<Mutex<Depth>>,
    /// Which triangles of each item are left.
    masks: Vec<AtomicU32>,
    portions: Vec<Mutex<Portion>>,
    /// One bit a triangle of the tree: what was seen in the frame before.
    seen: Vec<u32>,
    /// Counts frames.
    turn: usize,
}

impl CpuCuller {
    pub fn new() -> Self {
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads(cores.min(MOST_THREADS))
            .thread_name(|i| format!("culling {i}"))
            .build()
            .expect("threads can be started");
        let depths = (0..threads.current_num_threads()).map(|_| Mutex::default()).collect();
        let (masks, portions, seen) = (Vec::new(), Vec::new(), Vec::new());
        Self { threads, depths, masks, portions, seen, turn: 0 }
    }

    /// Finds what may be seen of the cut.
    pub(super) fn cull(&mut self, cut: &Cut<'_>) {
        self.seen.resize((cut.tree.indices.len() / 3).div_ceil(32), 0);
        self.masks.resize_with(cut.items.len().max(self.masks.len()), AtomicU32::default);
        self.portions.resize_with(cut.items.len().div_ceil(PORTION), Mutex::default);
        self.turn += 1;
        let [low, high] = cut.area();
        self.depths.iter_mut().for_each(|depth| inner(depth).clear(low, high));
        let seen = |item: &Item| part(self.seen[item.triangle as usize / 32], item);
        let mask = |slot: usize| self.masks[slot].load(Ordering::Relaxed);

        self.share(cut, |_, _, items, portion| portion.place(cut, items));
        let recalled = self.occlude(cut, |_, item| seen(item));
        self.test(cut, |_, item| whole(item));
        let all = || cut.items[..cut.opaque_items].iter().enumerate();
        let new: u32 = all().map(|(slot, item)| (mask(slot) & !seen(item)).count_ones()).sum();
        // After a jump of the date much is left only because what hides it is new itself.
        if new as usize > recalled / 4 {
            self.occlude(cut, |slot, item| mask(slot) & !seen(item));
            self.test(cut, |slot, _| mask(slot));
        }
        self.pack(cut);

        self.seen.fill(0);
        for (mask, item) in self.masks.iter_mut().zip(cut.items) {
            self.seen[item.triangle as usize / 32] |= *mask.get_mut() << (item.triangle % 32);
        }
    }

    /// Has all threads do `work` on portions of the items. It is told the thread, the place of the portion's
    /// first item, and its items.
    fn share(&self, cut: &Cut<'_>, work: impl Fn(usize, usize, &[Item], &mut Portion) + Sync) {
        let next = AtomicUsize::new(0);
        self.threads.broadcast(|thread| {
            loop {
                let at = next.fetch_add(1, Ordering::Relaxed);
                let Some(portion) = self.portions.get(at) else { return };
                let first = at * PORTION;
                let items = &cut.items[first..cut.items.len().min(first + PORTION)];
                work(thread.index(), first, items, &mut lock(portion));
            }
        });
    }

    /// Draws occluders, `which` of each opaque item, in front of those that are there. Returns how many.
    fn occlude(&self, cut: &Cut<'_>, which: impl Fn(usize, &Item) -> u32 + Sync) -> usize {
        let (grow, [low, high]) = (-cut.grow(), cut.area());
        let area = Area::new(low, high, grow);
        let count = AtomicUsize::new(0);
        self.share(cut, |thread, first, items, portion| {
            let mut depth = lock(&self.depths[thread]);
            for (slot, item) in
                items.iter().enumerate().take(cut.opaque_items.saturating_sub(first))
            {
                let mask = which(first + slot, item);
                count.fetch_add(mask.count_ones() as usize, Ordering::Relaxed);
                for (_, corners) in portion.triangles(cut, slot, item, mask) {
                    let (least, most) = extremes(corners);
                    if most.w == 0.0
                        && let Some(box_px) = area.pixels(least, most)
                    {
                        draw(corners, grow, &mut depth, box_px);
                    }
                }
            }
        });
        if let Some((all, others)) = self.depths.split_first() {
            let mut all = lock(all);
            for other in others {
                for (texel, depth) in all.texels.iter_mut().zip(&lock(other).texels) {
                    *texel = larger(*depth, *texel);
                }
            }
        }
        count.into_inner()
    }

    /// Sets the masks to those of the triangles that may be seen, out of `which` of each item.
    fn test(&self, cut: &Cut<'_>, which: impl Fn(usize, &Item) -> u32 + Sync) {
        let (grow, [low, high]) = (cut.grow(), cut.area());
        let area = Area::new(low, high, grow);
        let Some(depth) = self.depths.first().map(lock) else { return };
        let depth = &*depth;
        self.share(cut, |_, first, items, portion| {
            for (slot, item) in items.iter().enumerate() {
                let which = which(first + slot, item);
                // What was seen just now most likely is seen again: a close look at it now and then will do.
                let trusted = if (first + slot + self.turn) % LOOK_AGAIN == 0 {
                    0
                } else {
                    part(self.seen[item.triangle as usize / 32], item)
                };
                let mut mask = 0;
                for (bit, corners) in portion.triangles(cut, slot, item, which) {
                    let (least, most) = extremes(corners);
                    let seen = match look(least, most, &area, depth) {
                        Visible::No => false,
                        Visible::Yes => true,
                        Visible::Perhaps(box_px) => {
                            trusted >> bit & 1 != 0
                                || look_closely(corners, most, grow, depth, box_px)
                        }
                    };
                    mask |= u32::from(seen) << bit;
                }
                self.masks[first + slot].store(mask, Ordering::Relaxed);
            }
        });
    }

    /// Brings together the indices of what is left.
    fn pack(&self, cut: &Cut<'_>) {
        self.share(cut, |_, first, items, portion| {
            portion.packed.iter_mut().for_each(Vec::clear);
            for (slot, item) in (first..).zip(items) {
                let layer = &mut portion.packed[usize::from(slot >= cut.opaque_items)];
                let indices = cut.indices(item);
                for bit in bits(self.masks[slot].load(Ordering::Relaxed)) {
                    let at = bit as usize * 3;
                    layer.extend([0, 1, 2].map(|k| indices[at + k] + item.base_vertex));
                }
            }
        });
    }

    /// Indices of what is left of a layer, 0 opaque, 1 transparent, in parts.
    pub fn left(&mut self, layer: usize) -> impl Iterator<Item = &[u32]> {
        self.portions.iter_mut().map(move |portion| &inner(portion).packed[layer][..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    const SIZE: i32 = 24;

    fn empty() -> Depth {
        let mut depth = Depth::default();
        depth.clear(IVec2::ZERO, IVec2::splat(SIZE));
        depth
    }

    /// Triangles from tiny to larger than the picture, some of them slivers, some partly outside.
    fn triangles() -> impl Iterator<Item = Corners> {
        let mut state = 7u32;
        let mut next = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        (0..4000).map(move |i| {
            let reach = [0.5, 2.0, 9.0, 60.0][i % 4];
            let middle = Vec2::new(next(), next()) * SIZE as f32;
            let mut corner = || {
                let offset = Vec2::new(next() - 0.5, next() - 0.5) * reach;
                (middle + offset).extend(0.1 + 0.8 * next()).extend(0.0)
            };
            let [a, b, c] = [corner(), corner(), corner()];
            let sliver = (a + b) * 0.5 + (c - a) * 1e-3;
            [a, b, if i % 5 == 0 { sliver } else { c }]
        })
    }

    /// How far inside all three edges a pixel's middle lies, and the depth there, exactly.
    fn truth([a, b, c]: Corners, x: i32, y: i32) -> (f64, f64) {
        let p = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
        let flat = |v: Vec4| DVec2::new(v.x.into(), v.y.into());
        let area = (flat(b) - flat(a)).perp_dot(flat(c) - flat(a));
        let share = |from: Vec4, to: Vec4| (flat(to) - flat(from)).perp_dot(p - flat(from)) / area;
        let distance =
            |from: Vec4, to: Vec4| share(from, to) * area.abs() / flat(from).distance(flat(to));
        let inside = distance(a, b).min(distance(b, c)).min(distance(c, a));
        let depth = share(b, c) * f64::from(a.z)
            + share(c, a) * f64::from(b.z)
            + share(a, b) * f64::from(c.z);
        (inside, depth)
    }

    /// What the GPU clips at the near or far plane is known as such, in both projections: it hides nothing.
    #[test]
    fn what_is_clipped_is_known() {
        use topout_scene::{Projection, View};
        let mut view = View {
            eye: Vec3::ZERO,
            target: Vec3::NEG_Z,
            up: Vec3::Y,
            projection: Projection::Perspective { fov_y: View::FOV_Y },
            size: UVec2::splat(SIZE as u32),
            tolerance_px: 1.0,
        };
        let corner = |view: &View, z: f32| {
            Screen::new(view.clip_from_world(10.0), view.size).corner([0.0, 0.0, z])
        };
        let clipped = |view: &View, z: f32| corner(view, z).w == 1.0;
        assert!(clipped(&view, -0.5 * view.near()) && clipped(&view, 5.0));
        let middle = SIZE as f32 / 2.0;
        assert!(
            corner(&view, -5.0)
                .abs_diff_eq(Vec4::new(middle, middle, view.near() / 5.0, 0.0), 1e-5)
        );
        assert!(!clipped(&view, -1e6));
        view.projection = Projection::Orthographic { height: 4.0 };
        assert!(clipped(&view, -11.0) && clipped(&view, 11.0));
        assert!(!clipped(&view, -9.0) && !clipped(&view, 9.0));
    }

    fn may_be_seen(triangle: Corners, depth: &Depth) -> bool {
        let (least, most) = extremes(triangle);
        match look(least, most, &Area::new(IVec2::ZERO, IVec2::splat(SIZE), SNAP_PX), depth) {
            Visible::No => false,
            Visible::Yes => true,
            Visible::Perhaps(box_px) => look_closely(triangle, most, SNAP_PX, depth, box_px),
        }
    }

    fn every_pixel() -> impl Iterator<Item = (i32, i32)> {
        (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y)))
    }

    fn occlude(triangle: Corners, depth: &mut Depth) {
        let (least, most) = extremes(triangle);
        if let Some(box_px) =
            Area::new(IVec2::ZERO, IVec2::splat(SIZE), -SNAP_PX).pixels(least, most)
        {
            draw(triangle, -SNAP_PX, depth, box_px);
        }
    }

    /// Drawn as an occluder a triangle covers only pixels whose middle it covers, none that is well
    /// inside is left out, and it is never nearer than it is.
    #[test]
    fn an_occluder_hides_no_more_than_it_covers() {
        let mut covered = 0;
        for triangle in triangles() {
            let mut depth = empty();
            occlude(triangle, &mut depth);
            for (x, y) in every_pixel() {
                let drawn = depth.texels[depth.grid.row(y, [x, x])][0];
                let (inside, exact) = truth(triangle, x, y);
                if drawn > 0.0 {
                    assert!(inside > 0.0, "{triangle:?} at {x}, {y}: {inside}");
                    assert!(f64::from(drawn) <= exact, "{triangle:?} at {x}, {y}");
                    covered += 1;
                } else {
                    assert!(inside < 0.05, "{triangle:?} at {x}, {y}: {inside}");
                }
            }
        }
        assert!(covered > 50_000, "{covered}");
    }

    /// A triangle that covers the middle of a pixel is seen on an empty picture, over itself and over
    /// what lies a little behind it at that pixel; it is hidden where everything is nearer.
    #[test]
    fn what_covers_a_pixel_that_nothing_hides_is_seen() {
        let (mut seen, mut not) = (0, 0);
        for triangle in triangles() {
            let inside: Vec<_> =
                every_pixel().filter(|&(x, y)| truth(triangle, x, y).0 > 0.0).collect();
            if inside.is_empty() {
                not += u32::from(!may_be_seen(triangle, &empty()));
                continue;
            }
            seen += 1;
            assert!(may_be_seen(triangle, &empty()), "{triangle:?}");
            let mut own = empty();
            occlude(triangle, &mut own);
            assert!(may_be_seen(triangle, &own), "{triangle:?} hides itself");
            // Everything is nearer, but at one pixel.
            let mut wall = empty();
            wall.texels.fill(0.95);
            assert!(!may_be_seen(triangle, &wall), "{triangle:?} shines through");
            let (x, y) = inside[inside.len() / 2];
            let hole = wall.grid.row(y, [x, x]);
            wall.texels[hole][0] = truth(triangle, x, y).1 as f32 * 0.99999;
            assert!(may_be_seen(triangle, &wall), "{triangle:?} not seen at {x}, {y}");
        }
        assert!(seen > 1000 && not > 1000, "{seen} {not}");
    }
}
