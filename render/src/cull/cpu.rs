//! The CPU twin of [`super::gpu`], for adapters that are programs on the CPU themselves: there the
//! kernels cost more than what they save, and this, with the depth of the occluders drawn here too, a
//! fraction of it. It also tells which of the elements that are drawn exactly may be seen.

use super::Item;
use super::raster::{Corner, Depth, Screen, Visible};
use glam::{IVec2, Mat4, Vec3};
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use topout_scene::{ElementId, Hdlod, Model};

/// Items that a thread takes at a time.
const PORTION: usize = 64;
/// Frames after which a triangle that was seen is looked at closely again.
const LOOK_AGAIN: usize = 4;
/// Meshes with more triangles hide nothing: drawing them here would cost more than it saves.
const MOST_OCCLUDER_TRIANGLES: usize = 4096;
/// An element counts as so many triangles where it is weighed how much is new.
const ELEMENT_WEIGHT: usize = 12;
/// More threads than this only wait for each other.
const MOST_THREADS: usize = 4;

/// What became of a portion of the items.
#[derive(Debug, Default)]
struct Portion {
    /// Corners of the items' triangles on the picture.
    corners: Vec<Corner>,
    /// For each of those triangles, which corners of its item.
    triangles: Vec<[u8; 3]>,
    /// For each item, where its corners and triangles begin.
    places: Vec<[usize; 2]>,
    /// Indices of what is left, opaque and transparent.
    packed: [Vec<u32>; 2],
}

impl Portion {
    /// Vertices of an item that are brought to the picture together, whether they are needed or not.
    const MOST: u32 = 256;

    /// Brings the items' vertices to the picture: all between the first and the last of an item, since
    /// neighbours share them, so most are needed. Where they are far apart, each corner alone.
    fn place(&mut self, cut: &Cut<'_>, items: &[Item]) {
        self.corners.clear();
        self.triangles.clear();
        self.places.clear();
        for item in items {
            self.places.push([self.corners.len(), self.triangles.len()]);
            let all = || cut.triangles(item).flatten();
            let (least, most) =
                all().fold((u32::MAX, 0), |(least, most), i| (least.min(i), most.max(i)));
            let vertices = &cut.tree.vertices[item.base_vertex as usize..];
            if most - least < Self::MOST.min(item.count * 4) {
                let vertices = &vertices[least as usize..most as usize + 1];
                self.corners.extend(vertices.iter().map(|v| cut.screen.corner(v.position)));
                let own = |index: u32| (index - least) as u8;
                self.triangles.extend(cut.triangles(item).map(|t| t.map(own)));
            } else {
                let corner = |index: u32| cut.screen.corner(vertices[index as usize].position);
                self.corners.extend(all().map(corner));
                let own = |number: u32| [0, 1, 2].map(|k| (number * 3 + k) as u8);
                self.triangles.extend((0..item.count).map(own));
            }
        }
    }

    /// Corners of the triangles of the `slot`th item of the portion, with their bits, out of `which`.
    fn triangles(&self, slot: usize, which: u32) -> impl Iterator<Item = (u32, [Corner; 3])> {
        let [corners, triangles] = self.places[slot];
        let (corners, triangles) = (&self.corners[corners..], &self.triangles[triangles..]);
        bits(which).map(move |bit| {
            (bit, triangles[bit as usize].map(|corner| corners[usize::from(corner)]))
        })
    }
}

/// The cut of a frame.
pub(super) struct Cut<'a> {
    pub items: &'a [Item],
    /// Those of the opaque layer come first.
    pub opaque_items: usize,
    pub tree: &'a Hdlod,
    /// Elements of the model that are drawn exactly.
    pub elements: &'a [ElementId],
    pub model: &'a Model,
    pub screen: Screen,
    /// The part of the picture where the scene can be: first pixel, and one past the last.
    pub area: [IVec2; 2],
}

impl Cut<'_> {
    /// The indices of the item's triangles, without its base.
    fn triangles(&self, item: &Item) -> impl Iterator<Item = [u32; 3]> {
        let first = item.triangle as usize;
        (first..first + item.count as usize).map(|number| self.tree.indices.triangle(number))
    }

    /// Draws an element as an occluder.
    fn occlude(&self, id: ElementId, depth: &mut Depth) {
        for instance in self.model.instances_of(&self.model.elements[id.index()]) {
            let mesh = &self.model.meshes[instance.mesh.index()];
            let opaque = &mesh.indices[..mesh.opaque as usize];
            if opaque.len() / 3 > MOST_OCCLUDER_TRIANGLES {
                continue;
            }
            let screen = self.screen.placed(Mat4::from(instance.world_from_mesh));
            let (triangles, _) = opaque.as_chunks::<3>();
            let mut rest = triangles;
            while let [triangle, after @ ..] = rest {
                let position = |vertex: u32| mesh.vertices[vertex as usize].position;
                let quad = after.first().and_then(|next| quad(triangle, next));
                match quad.map(|quad| quad.map(position)).filter(is_flat_and_convex) {
                    Some(quad) => {
                        screen.occlude_polygon(&quad, depth);
                        rest = &after[1..];
                    }
                    None => {
                        screen.occlude_polygon(&triangle.map(position), depth);
                        rest = after;
                    }
                }
            }
        }
    }
}

/// Two triangles with a common edge as one polygon.
fn quad(a: &[u32; 3], b: &[u32; 3]) -> Option<[u32; 4]> {
    (0..9).find_map(|i| {
        let (k, j) = (i / 3, i % 3);
        let (first, second, third) = (a[k], a[(k + 1) % 3], a[(k + 2) % 3]);
        let shared = b[j] == second && b[(j + 1) % 3] == first;
        shared.then(|| [first, b[(j + 2) % 3], second, third])
    })
}

fn is_flat_and_convex(corners: &[[f32; 3]; 4]) -> bool {
    let [a, b, c, d] = corners.map(Vec3::from);
    let normal = (c - a).cross(d - b);
    let off = normal.dot(b - a).abs();
    let turns = [(a, b, c), (b, c, d), (c, d, a), (d, a, b)];
    // Roundings of positions are of that order.
    off <= 1e-6 * normal.length() * (c - a).length()
        && turns.iter().all(|(p, q, r)| (q - p).cross(r - q).dot(normal) > 0.0)
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

/// Leaves out what nobody sees; see the file's head.
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
    /// Which of the elements are left, 32 a word.
    element_masks: Vec<AtomicU32>,
    /// One bit an element of the model: what was seen in the frame before.
    seen_elements: Vec<u32>,
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
        Self {
            threads,
            depths,
            masks: Vec::new(),
            portions: Vec::new(),
            seen: Vec::new(),
            element_masks: Vec::new(),
            seen_elements: Vec::new(),
            turn: 0,
        }
    }

    /// Finds what may be seen of the cut.
    pub(super) fn cull(&mut self, cut: &Cut<'_>) {
        self.seen.resize((cut.tree.indices.len() / 3).div_ceil(32), 0);
        self.masks.resize_with(cut.items.len().max(self.masks.len()), AtomicU32::default);
        self.portions.resize_with(cut.items.len().div_ceil(PORTION), Mutex::default);
        self.seen_elements.resize(cut.model.elements.len().div_ceil(32), 0);
        self.element_masks.resize_with(cut.elements.len().div_ceil(32), AtomicU32::default);
        self.turn += 1;
        self.depths.iter_mut().for_each(|depth| inner(depth).clear(cut.area));
        let seen = |item: &Item| part(self.seen[item.triangle as usize / 32], item);
        let mask = |slot: usize| self.masks[slot].load(Ordering::Relaxed);

        self.share(cut, |_, _, items, portion| portion.place(cut, items));
        let recalled = self.occlude(cut, |_, item| seen(item), |slot| self.was_seen(cut, slot));
        self.test(cut, |_, item| whole(item), |_| true);
        let all = || cut.items[..cut.opaque_items].iter().enumerate();
        let new: u32 = all().map(|(slot, item)| (mask(slot) & !seen(item)).count_ones()).sum();
        let newly = |slot: usize| self.is_left(slot) && !self.was_seen(cut, slot);
        let new_elements = (0..cut.elements.len()).filter(|&slot| newly(slot)).count();
        // After a jump much is left only because what hides it is new itself.
        if new as usize + new_elements * ELEMENT_WEIGHT > recalled / 4 {
            self.occlude(cut, |slot, item| mask(slot) & !seen(item), newly);
            self.test(cut, |slot, _| mask(slot), |slot| self.is_left(slot));
        }
        self.pack(cut);

        self.seen.fill(0);
        for (mask, item) in self.masks.iter_mut().zip(cut.items) {
            self.seen[item.triangle as usize / 32] |= *mask.get_mut() << (item.triangle % 32);
        }
        self.seen_elements.fill(0);
        for (slot, id) in cut.elements.iter().enumerate() {
            let bit = u32::from(self.is_left(slot));
            self.seen_elements[id.index() / 32] |= bit << (id.index() % 32);
        }
    }

    /// Whether an element was seen in the frame before.
    fn was_seen(&self, cut: &Cut<'_>, slot: usize) -> bool {
        let at = cut.elements[slot].index();
        self.seen_elements[at / 32] >> (at % 32) & 1 != 0
    }

    /// Whether the element in a place of [`Cut::elements`] may be seen.
    pub fn is_left(&self, slot: usize) -> bool {
        self.element_masks[slot / 32].load(Ordering::Relaxed) >> (slot % 32) & 1 != 0
    }

    /// Has all threads do `work` on portions of the items. It is told the thread, the place of the portion's
    /// first item, and its items.
    fn share(&self, cut: &Cut<'_>, work: impl Fn(usize, usize, &[Item], &mut Portion) + Sync) {
        self.each(self.portions.len(), |thread, at| {
            let first = at * PORTION;
            let items = &cut.items[first..cut.items.len().min(first + PORTION)];
            work(thread, first, items, &mut lock(&self.portions[at]));
        });
    }

    /// Has all threads do `work` on numbers below `count`. It is told the thread first.
    fn each(&self, count: usize, work: impl Fn(usize, usize) + Sync) {
        let next = AtomicUsize::new(0);
        self.threads.broadcast(|thread| {
            loop {
                let at = next.fetch_add(1, Ordering::Relaxed);
                if at >= count {
                    return;
                }
                work(thread.index(), at);
            }
        });
    }

    /// Draws occluders, `which` of each opaque item and the elements `whose` place is told, in front of those
    /// that are there. Returns how many triangles, with elements counted as so many.
    fn occlude(
        &self,
        cut: &Cut<'_>,
        which: impl Fn(usize, &Item) -> u32 + Sync,
        whose: impl Fn(usize) -> bool + Sync,
    ) -> usize {
        let count = AtomicUsize::new(0);
        self.share(cut, |thread, first, items, portion| {
            let mut depth = lock(&self.depths[thread]);
            let opaque = cut.opaque_items.saturating_sub(first);
            for (slot, item) in items.iter().enumerate().take(opaque) {
                let mask = which(first + slot, item);
                count.fetch_add(mask.count_ones() as usize, Ordering::Relaxed);
                for (_, corners) in portion.triangles(slot, mask) {
                    cut.screen.occlude(corners, &mut depth);
                }
            }
        });
        self.each(self.element_masks.len(), |thread, word| {
            let mut depth = lock(&self.depths[thread]);
            for slot in (word * 32..cut.elements.len().min(word * 32 + 32)).filter(|&s| whose(s)) {
                cut.occlude(cut.elements[slot], &mut depth);
                count.fetch_add(ELEMENT_WEIGHT, Ordering::Relaxed);
            }
        });
        if let Some((all, others)) = self.depths.split_first() {
            let others: Vec<_> = others.iter().map(lock).collect();
            let others: Vec<&Depth> = others.iter().map(|depth| &**depth).collect();
            self.threads.install(|| lock(all).finish(&others));
        }
        count.into_inner()
    }

    /// Sets the masks to what may be seen, out of `which` triangles of each item and the elements `whose` place
    /// is told.
    fn test(
        &self,
        cut: &Cut<'_>,
        which: impl Fn(usize, &Item) -> u32 + Sync,
        whose: impl Fn(usize) -> bool + Sync,
    ) {
        let Some(depth) = self.depths.first().map(lock) else { return };
        let depth = &*depth;
        self.share(cut, |_, first, items, portion| {
            for (slot, item) in items.iter().enumerate() {
                let which = which(first + slot, item);
                // What was seen just now most likely is seen again: a close look at it now and then will do.
                let trusted = if (first + slot + self.turn).is_multiple_of(LOOK_AGAIN) {
                    0
                } else {
                    part(self.seen[item.triangle as usize / 32], item)
                };
                let mut mask = 0;
                for (bit, corners) in portion.triangles(slot, which) {
                    let seen = match cut.screen.look(corners, depth) {
                        Visible::No => false,
                        Visible::Yes => true,
                        Visible::Perhaps(box_px) => {
                            trusted >> bit & 1 != 0
                                || cut.screen.look_closely(corners, depth, box_px)
                        }
                    };
                    mask |= u32::from(seen) << bit;
                }
                self.masks[first + slot].store(mask, Ordering::Relaxed);
            }
        });
        self.each(self.element_masks.len(), |_, word| {
            let places = word * 32..cut.elements.len().min(word * 32 + 32);
            let mask = places.filter(|&slot| whose(slot)).fold(0, |mask, slot| {
                let bounds = &cut.model.elements[cut.elements[slot].index()].bounds;
                let seen = cut.screen.may_show(bounds.corners(), depth);
                mask | u32::from(seen) << (slot % 32)
            });
            self.element_masks[word].store(mask, Ordering::Relaxed);
        });
    }

    /// Brings together the indices of what is left.
    fn pack(&self, cut: &Cut<'_>) {
        self.share(cut, |_, first, items, portion| {
            portion.packed.iter_mut().for_each(Vec::clear);
            for (slot, item) in (first..).zip(items) {
                let layer = &mut portion.packed[usize::from(slot >= cut.opaque_items)];
                for bit in bits(self.masks[slot].load(Ordering::Relaxed)) {
                    let corners = cut.tree.indices.triangle((item.triangle + bit) as usize);
                    layer.extend(corners.map(|index| index + item.base_vertex));
                }
            }
        });
    }

    /// Indices of what is left of a layer, 0 opaque, 1 transparent, in parts.
    pub fn left(&mut self, layer: usize) -> impl Iterator<Item = &[u32]> {
        self.portions.iter_mut().map(move |portion| &inner(portion).packed[layer][..])
    }
}
