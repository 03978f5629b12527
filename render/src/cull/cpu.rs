//! The CPU twin of [`super::gpu`], for adapters that are programs on the CPU themselves: there the
//! kernels cost more than what they save, and this, with the depth of the occluders drawn here too, a
//! fraction of it.

use super::Item;
use glam::{IVec2, Mat4, UVec2, Vec2, Vec3};
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use topout_scene::Hdlod;

/// Pixels by which edges may be moved: software adapters bring corners onto a grid of 1/256 pixel.
const SNAP_PX: f32 = 1.0 / 64.0;
/// Relative, what depths may differ by because of rounding.
const DEPTH_SLACK: f32 = 1e-5;
/// Items that a thread takes at a time.
const PORTION: usize = 64;
/// Pixels across, below which they are looked at one by one.
const FEW: i32 = 4;
/// More threads than this only wait for each other.
const MOST_THREADS: usize = 4;

/// Part of a picture's depth, reversed: 0 is infinitely far.
#[derive(Debug, Default)]
struct Depth {
    /// First pixel, and one past the last.
    low: IVec2,
    high: IVec2,
    texels: Vec<f32>,
}

impl Depth {
    fn clear(&mut self, low: IVec2, high: IVec2) {
        (self.low, self.high) = (low, high);
        let extent = (high - low).as_usizevec2();
        self.texels.clear();
        self.texels.resize(extent.x * extent.y, 0.0);
    }

    fn row(&self, y: i32, x: [i32; 2]) -> std::ops::Range<usize> {
        let start = (y - self.low.y) as usize * (self.high.x - self.low.x) as usize;
        start + (x[0] - self.low.x) as usize..start + (x[1] - self.low.x) as usize + 1
    }
}

/// The way from local space to pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screen {
    clip_from_world: Mat4,
    half_size: Vec2,
}

impl Screen {
    pub fn new(clip_from_world: Mat4, size: UVec2) -> Self {
        Self { clip_from_world, half_size: size.as_vec2() * 0.5 }
    }

    /// Pixels from the upper left and reversed depth; not a number before the near or behind the far plane,
    /// where the GPU clips.
    fn corner(&self, position: [f32; 3]) -> Vec3 {
        let clip = self.clip_from_world * Vec3::from(position).extend(1.0);
        let scale = if (0.0..=clip.w).contains(&clip.z) { 1.0 / clip.w } else { f32::NAN };
        let ndc = clip.truncate() * scale;
        let at = Vec2::new(1.0 + ndc.x, 1.0 - ndc.y) * self.half_size;
        at.extend(ndc.z)
    }
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

/// First and last of the pixels within `low` and `high` (one past the last) whose centres the box of a
/// triangle covers, its sides moved outward by `grow`.
fn pixels([p, q, r]: &[Vec3; 3], grow: f32, low: IVec2, high: IVec2) -> Option<[IVec2; 2]> {
    // Centres lie at halves.
    let (least, most) = (0.5 + grow, 0.5 - grow);
    let first_x = ceil(p.x.min(q.x).min(r.x) - least).max(low.x);
    let last_x = floor(p.x.max(q.x).max(r.x) - most).min(high.x - 1);
    if first_x > last_x {
        return None;
    }
    let first_y = ceil(p.y.min(q.y).min(r.y) - least).max(low.y);
    let last_y = floor(p.y.max(q.y).max(r.y) - most).min(high.y - 1);
    (first_y <= last_y).then(|| [IVec2::new(first_x, first_y), IVec2::new(last_x, last_y)])
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
    fn new([p, q, r]: [Vec3; 3], grow: f32, [low, high]: [IVec2; 2]) -> Option<Self> {
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
                1 => left = left.max(x),
                -1 => right = right.min(x),
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
        for y in self.low.y..=self.high.y {
            let Some(x) = self.row(y) else { continue };
            let mut here = self.depth_at(x[0], y) - self.slack;
            let range = depth.row(y, x);
            for texel in &mut depth.texels[range] {
                *texel = texel.max(here.max(self.farthest * (1.0 - DEPTH_SLACK)).min(self.nearest));
                here += self.slope.x;
            }
        }
    }

    fn may_be_seen(&self, depth: &Depth) -> bool {
        let nearest = self.nearest * (1.0 + DEPTH_SLACK);
        (self.low.y..=self.high.y).any(|y| {
            let Some(x) = self.row(y) else { return false };
            let mut here = self.depth_at(x[0], y) + self.slack;
            depth.texels[depth.row(y, x)].iter().any(|&occluder| {
                let seen = here.min(nearest) >= occluder;
                here += self.slope.x;
                seen
            })
        })
    }
}

/// The same, for a few pixels one by one, which saves the divisions of [`Rows`].
fn covers_one_of_few(
    [p, q, r]: [Vec3; 3],
    grow: f32,
    depth: &Depth,
    [low, high]: [IVec2; 2],
) -> bool {
    let (across, over) = (q - p, r - p);
    let area = across.x * over.y - across.y * over.x;
    let edge = |a: Vec3, b: Vec3| {
        let along = (b - a).truncate() * area.signum();
        (a.truncate(), along, -grow * (along.x.abs() + along.y.abs()))
    };
    let edges = [edge(p, q), edge(q, r), edge(r, p)];
    let nearest = p.z.max(q.z).max(r.z) * (1.0 + DEPTH_SLACK);
    (low.y..=high.y).any(|y| {
        depth.texels[depth.row(y, [low.x, high.x])].iter().zip(low.x..).any(|(&occluder, x)| {
            let at = Vec2::new(x as f32, y as f32) + 0.5;
            occluder <= nearest
                && edges.iter().all(|(from, along, least)| along.perp_dot(at - from) >= *least)
        })
    })
}

/// Whether a triangle covers a pixel at which nothing of the occluders is nearer.
fn may_be_seen(corners: [Vec3; 3], grow: f32, depth: &Depth) -> bool {
    let Some([low, high]) = pixels(&corners, grow, depth.low, depth.high) else {
        return false;
    };
    // Most that is hidden is hidden all over its box.
    let [p, q, r] = &corners;
    let nearest = p.z.max(q.z).max(r.z) * (1.0 + DEPTH_SLACK);
    let behind = |y| depth.texels[depth.row(y, [low.x, high.x])].iter().all(|&d| d > nearest);
    if (low.y..=high.y).all(behind) {
        return false;
    }
    let extent = high - low;
    if extent.x < FEW && extent.y < FEW {
        return covers_one_of_few(corners, grow, depth, [low, high]);
    }
    Rows::new(corners, grow, [low, high]).is_some_and(|rows| rows.may_be_seen(depth))
}

/// Corners of an item's triangles on the picture.
struct Corners {
    /// Those of the vertices from `first` on; not a number where they are clipped.
    at: Vec<Vec3>,
    first: u32,
}

impl Corners {
    /// Vertices of an item that are brought to the picture together, whether they are needed or not.
    const MOST: u32 = 256;

    fn new() -> Self {
        Self { at: Vec::with_capacity(Self::MOST as usize), first: 0 }
    }

    /// Brings all vertices between the first and the last of an item to the picture: neighbours share
    /// them, so most are needed. Where they are far apart, each is brought when it is asked for.
    fn set(&mut self, cut: &Cut<'_>, item: &Item, mask: u32) {
        self.at.clear();
        let from = item.triangle as usize * 3;
        let indices = &cut.tree.indices[from..from + item.count as usize * 3];
        let range = indices.iter().fold((u32::MAX, 0), |r, &i| (r.0.min(i), r.1.max(i)));
        if range.1 - range.0 < Self::MOST.min(mask.count_ones() * 4) {
            self.first = range.0 + item.base_vertex;
            let range = self.first as usize..(range.1 + item.base_vertex) as usize + 1;
            let vertices = &cut.tree.vertices[range];
            self.at.extend(vertices.iter().map(|vertex| cut.screen.corner(vertex.position)));
        }
    }

    /// The corners of one of the item's triangles; `None` where it is clipped at the near or far plane.
    fn of(&self, cut: &Cut<'_>, item: &Item, bit: u32) -> Option<[Vec3; 3]> {
        let corners = cut.vertices(item, bit).map(|vertex| {
            let known = self.at.get(vertex.wrapping_sub(self.first) as usize);
            known
                .copied()
                .unwrap_or_else(|| cut.screen.corner(cut.tree.vertices[vertex as usize].position))
        });
        let [a, b, c] = corners;
        (!(a.z + b.z + c.z).is_nan()).then_some(corners)
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
    /// Indices into the tree's vertices.
    fn vertices(&self, item: &Item, bit: u32) -> [u32; 3] {
        let at = (item.triangle + bit) as usize * 3;
        [0, 1, 2].map(|k| self.tree.indices[at + k] + item.base_vertex)
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

    /// Calls `work` with portions of the items, of each its first place and its items.
    fn share(&self, next: &AtomicUsize, mut work: impl FnMut(usize, &[Item])) {
        loop {
            let first = next.fetch_add(PORTION, Ordering::Relaxed);
            let Some(rest) = self.items.get(first..).filter(|rest| !rest.is_empty()) else {
                return;
            };
            work(first, &rest[..rest.len().min(PORTION)]);
        }
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
    /// Indices of what is left of each portion, opaque and transparent.
    packed: Vec<Mutex<[Vec<u32>; 2]>>,
    /// One bit a triangle of the tree: what was seen in the frame before.
    seen: Vec<u32>,
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
        Self { threads, depths, masks: Vec::new(), packed: Vec::new(), seen: Vec::new() }
    }

    /// Finds what may be seen of the cut.
    pub(super) fn cull(&mut self, cut: &Cut<'_>) {
        self.seen.resize((cut.tree.indices.len() / 3).div_ceil(32), 0);
        self.masks.resize_with(cut.items.len().max(self.masks.len()), AtomicU32::default);
        let [low, high] = cut.area();
        self.depths.iter_mut().for_each(|depth| inner(depth).clear(low, high));
        let seen = |item: &Item| part(self.seen[item.triangle as usize / 32], item);
        let mask = |slot: usize| self.masks[slot].load(Ordering::Relaxed);

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

    /// Draws occluders, `which` of each opaque item, in front of those that are there. Returns how many.
    fn occlude(&self, cut: &Cut<'_>, which: impl Fn(usize, &Item) -> u32 + Sync) -> usize {
        let (grow, [low, high]) = (cut.grow(), cut.area());
        let (next, count) = (AtomicUsize::new(0), AtomicUsize::new(0));
        self.threads.broadcast(|thread| {
            let mut depth = lock(&self.depths[thread.index()]);
            let mut corners = Corners::new();
            cut.share(&next, |first, items| {
                for (slot, item) in (first..cut.opaque_items).zip(items) {
                    let mask = which(slot, item);
                    if mask == 0 {
                        continue;
                    }
                    count.fetch_add(mask.count_ones() as usize, Ordering::Relaxed);
                    corners.set(cut, item, mask);
                    for bit in bits(mask) {
                        if let Some(corners) = corners.of(cut, item, bit)
                            && let Some(area) = pixels(&corners, -grow, low, high)
                            && let Some(rows) = Rows::new(corners, -grow, area)
                        {
                            rows.occlude(&mut depth);
                        }
                    }
                }
            });
        });
        if let Some((all, others)) = self.depths.split_first() {
            let mut all = lock(all);
            for other in others {
                for (texel, depth) in all.texels.iter_mut().zip(&lock(other).texels) {
                    *texel = texel.max(*depth);
                }
            }
        }
        count.into_inner()
    }

    /// Sets the masks to those of the triangles that may be seen, out of `which` of each item.
    fn test(&self, cut: &Cut<'_>, which: impl Fn(usize, &Item) -> u32 + Sync) {
        let grow = cut.grow();
        let Some(depth) = self.depths.first().map(lock) else { return };
        let (depth, next) = (&*depth, AtomicUsize::new(0));
        self.threads.broadcast(|_| {
            let mut corners = Corners::new();
            cut.share(&next, |first, items| {
                for (slot, item) in (first..).zip(items) {
                    let which = which(slot, item);
                    corners.set(cut, item, which);
                    let seen = bits(which).filter(|&bit| {
                        let corners = corners.of(cut, item, bit);
                        corners.is_none_or(|corners| may_be_seen(corners, grow, depth))
                    });
                    let mask = seen.fold(0, |mask, bit| mask | 1 << bit);
                    self.masks[slot].store(mask, Ordering::Relaxed);
                }
            });
        });
    }

    /// Brings together the indices of what is left.
    fn pack(&mut self, cut: &Cut<'_>) {
        let portions = cut.items.len().div_ceil(PORTION);
        self.packed.resize_with(portions.max(self.packed.len()), Mutex::default);
        self.packed.iter_mut().flat_map(inner).for_each(Vec::clear);
        let (packed, masks, next) = (&self.packed, &self.masks, AtomicUsize::new(0));
        self.threads.broadcast(|_| {
            cut.share(&next, |first, items| {
                let mut packed = lock(&packed[first / PORTION]);
                for (slot, item) in (first..).zip(items) {
                    let layer = &mut packed[usize::from(slot >= cut.opaque_items)];
                    let mask = masks[slot].load(Ordering::Relaxed);
                    layer.extend(bits(mask).flat_map(|bit| cut.vertices(item, bit)));
                }
            });
        });
    }

    /// Indices of what is left of a layer, 0 opaque, 1 transparent, in parts.
    pub fn left(&mut self, layer: usize) -> impl Iterator<Item = &[u32]> {
        self.packed.iter_mut().map(move |packed| &inner(packed)[layer][..])
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
    fn triangles() -> impl Iterator<Item = [Vec3; 3]> {
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
                (middle + offset).extend(0.1 + 0.8 * next())
            };
            let [a, b, c] = [corner(), corner(), corner()];
            let sliver = (a + b) * 0.5 + (c - a) * 1e-3;
            [a, b, if i % 5 == 0 { sliver } else { c }]
        })
    }

    /// How far inside all three edges a pixel's middle lies, and the depth there, exactly.
    fn truth([a, b, c]: [Vec3; 3], x: i32, y: i32) -> (f64, f64) {
        let p = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
        let flat = |v: Vec3| v.truncate().as_dvec2();
        let area = (flat(b) - flat(a)).perp_dot(flat(c) - flat(a));
        let share = |from: Vec3, to: Vec3| (flat(to) - flat(from)).perp_dot(p - flat(from)) / area;
        let distance =
            |from: Vec3, to: Vec3| share(from, to) * area.abs() / flat(from).distance(flat(to));
        let inside = distance(a, b).min(distance(b, c)).min(distance(c, a));
        let depth = share(b, c) * f64::from(a.z)
            + share(c, a) * f64::from(b.z)
            + share(a, b) * f64::from(c.z);
        (inside, depth)
    }

    /// What the GPU clips at the near or far plane is known as such, in both projections: it hides nothing.
    #[test]
    fn what_is_clipped_is_no_number() {
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
        assert!(corner(&view, -0.5 * view.near()).is_nan() && corner(&view, 5.0).is_nan());
        assert_eq!(corner(&view, -5.0).truncate(), Vec2::splat(SIZE as f32 / 2.0));
        assert!(!corner(&view, -1e6).is_nan());
        view.projection = Projection::Orthographic { height: 4.0 };
        assert!(corner(&view, -11.0).is_nan() && corner(&view, 11.0).is_nan());
        assert!(!corner(&view, -9.0).is_nan() && !corner(&view, 9.0).is_nan());
    }

    fn every_pixel() -> impl Iterator<Item = (i32, i32)> {
        (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y)))
    }

    fn occlude(triangle: [Vec3; 3], depth: &mut Depth) {
        if let Some(area) = pixels(&triangle, -SNAP_PX, depth.low, depth.high)
            && let Some(rows) = Rows::new(triangle, -SNAP_PX, area)
        {
            rows.occlude(depth);
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
                let drawn = depth.texels[depth.row(y, [x, x])][0];
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
                not += u32::from(!may_be_seen(triangle, SNAP_PX, &empty()));
                continue;
            }
            seen += 1;
            assert!(may_be_seen(triangle, SNAP_PX, &empty()), "{triangle:?}");
            let mut own = empty();
            occlude(triangle, &mut own);
            assert!(may_be_seen(triangle, SNAP_PX, &own), "{triangle:?} hides itself");
            // Everything is nearer, but at one pixel.
            let mut wall = empty();
            wall.texels.fill(0.95);
            assert!(!may_be_seen(triangle, SNAP_PX, &wall), "{triangle:?} shines through");
            let (x, y) = inside[inside.len() / 2];
            let hole = wall.row(y, [x, x]);
            wall.texels[hole][0] = truth(triangle, x, y).1 as f32 * 0.99999;
            assert!(may_be_seen(triangle, SNAP_PX, &wall), "{triangle:?} not seen at {x}, {y}");
        }
        assert!(seen > 1000 && not > 1000, "{seen} {not}");
    }
}
