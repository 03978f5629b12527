//! Leaving out what nobody sees, triangle by triangle.
//!
//! Of the triangles of a cut seldom more than a tenth are visible: most lie behind others, or between
//! the centres of pixels. So every frame is drawn twice: first, depth alone, what was seen in the frame
//! before and is in the cut again; then, out of everything in the cut, what that depth does not hide, in
//! the order in which all would be drawn. So the picture is the same.
//!
//! Nothing rests on the frame before but speed: the occluders are triangles of this frame's cut where
//! this frame's camera sees them, so what they hide is hidden also after a jump of camera or time.
//!
//! | where | how | when |
//! |---|---|---|
//! | [`gpu`] | kernels; a pyramid of the depth | the adapter is hardware |
//! | [`cpu`] | threads; depth drawn by them | the adapter is a program on the CPU |

mod cpu;
pub(crate) mod gpu;
mod raster;

use crate::gpu::{Gpu, GpuError};
use crate::input::Occlusion;
use crate::pool::Geometry;
use crate::timing::GpuTimer;
use bytemuck::{Pod, Zeroable};
use cpu::{CpuCuller, Cut};
use glam::{IVec2, Mat4};
use gpu::{COMMAND_BYTES, GpuCuller, Inputs, Kernels};
use raster::Screen;
use topout_scene::hdlod::Span;
use topout_scene::{ElementId, Hdlod, Layer, LookId, Model, View};
use wgpu::BufferUsages;

/// Bytes of one index of what is left.
const INDEX_BYTES: u64 = size_of::<u32>() as u64;

/// At most 32 triangles that follow each other, all in one word of a table of bits. The twin of `Item` in
/// `shaders/common/cull.wgsl`; a test compares the two.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Item {
    /// Index of the first triangle.
    pub triangle: u32,
    pub count: u32,
    /// Added to the indices.
    pub base_vertex: u32,
}

/// A buffer that grows.
#[derive(Debug)]
struct Table {
    label: &'static str,
    usage: BufferUsages,
    buffer: wgpu::Buffer,
}

impl Table {
    fn new(gpu: &Gpu, label: &'static str, usage: BufferUsages) -> Result<Self, GpuError> {
        let usage = usage | BufferUsages::COPY_DST;
        Ok(Self { label, usage, buffer: gpu.buffer(label, 1 << 12, usage)? })
    }

    fn hold(&mut self, gpu: &Gpu, bytes: u64) -> Result<(), GpuError> {
        if self.buffer.size() < bytes {
            let room = (bytes + bytes / 4).next_multiple_of(16);
            self.buffer = gpu.buffer(self.label, room, self.usage)?;
        }
        Ok(())
    }
}

/// Where the triangles are tested.
#[derive(Debug)]
enum Way {
    Cpu { culler: CpuCuller, packed: Table, counts: [u32; 2] },
    Gpu { culler: Box<GpuCuller>, kernels: Kernels },
}

/// What of a cut may be seen.
#[derive(Debug)]
pub(crate) struct Culler {
    way: Way,
    items: Vec<Item>,
    opaque_items: usize,
    triangles: u64,
}

/// A frame, as a [`Culler`] needs it.
pub(crate) struct Frame<'a> {
    pub uniform: &'a wgpu::Buffer,
    pub view: &'a View,
    pub clip_from_world: Mat4,
    /// The largest coordinate of scene and eye, metres.
    pub reach_m: f32,
    pub samples: u32,
    /// x, y, width and height of the part of the picture where the scene can be.
    pub covered: [u32; 4],
    pub depth: &'a wgpu::TextureView,
    pub model: &'a Model,
    pub tree: &'a Hdlod,
    pub geometry: &'a Geometry,
    /// Stamps the kernels.
    pub timer: Option<&'a GpuTimer>,
}

impl Culler {
    /// `None` where nothing is to be left out, or the adapter cannot run the kernels.
    ///
    /// # Errors
    /// If the GPU has no room.
    pub fn new(gpu: &Gpu, occlusion: Occlusion, samples: u32) -> Result<Option<Self>, GpuError> {
        let way = match occlusion {
            Occlusion::Off => return Ok(None),
            Occlusion::Gpu if !gpu::is_able(gpu) => return Ok(None),
            Occlusion::Cpu => Way::Cpu {
                culler: CpuCuller::new(),
                packed: Table::new(gpu, "indices left", BufferUsages::INDEX)?,
                counts: [0; 2],
            },
            Occlusion::Gpu => Way::Gpu {
                culler: Box::new(GpuCuller::new(gpu)?),
                kernels: Kernels::new(gpu, samples),
            },
        };
        Ok(Some(Self { way, items: Vec::new(), opaque_items: 0, triangles: 0 }))
    }

    /// Whether the geometry is where the triangles are tested.
    pub fn suits(&self, geometry: &Geometry) -> bool {
        matches!(self.way, Way::Cpu { .. }) || geometry.readable
    }

    /// Triangles that are left, where they were counted.
    pub fn left(&self) -> Option<u64> {
        match &self.way {
            Way::Cpu { counts, .. } => Some(counts.iter().map(|c| u64::from(c / 3)).sum()),
            Way::Gpu { .. } => None,
        }
    }

    /// Whether transparent triangles may be left.
    pub fn has_glass(&self) -> bool {
        match &self.way {
            Way::Cpu { counts: [_, transparent], .. } => *transparent > 0,
            Way::Gpu { .. } => self.opaque_items < self.items.len(),
        }
    }

    /// Triangles of the cut.
    pub fn triangles(&self) -> u64 {
        self.triangles
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        match &self.way {
            Way::Cpu { packed, .. } => packed.buffer.size(),
            Way::Gpu { culler, .. } => culler.bytes(),
        }
    }

    /// Takes the spans of a frame, all of them with their own look.
    pub fn set_spans(&mut self, spans: &[Span]) {
        if let Way::Cpu { counts, .. } = &mut self.way {
            *counts = [0; 2];
        }
        self.triangles = spans.iter().map(|s| u64::from(s.index_count) / 3).sum();
        self.items.clear();
        cut_at_words(spans, Layer::Opaque, &mut self.items);
        self.opaque_items = self.items.len();
        cut_at_words(spans, Layer::Transparent, &mut self.items);
    }

    /// The spans again, in parts.
    pub fn spans(&self) -> Vec<Span> {
        let span = |(slot, item): (usize, &Item)| Span {
            first_index: item.triangle * 3,
            index_count: item.count * 3,
            base_vertex: item.base_vertex,
            layer: if slot < self.opaque_items { Layer::Opaque } else { Layer::Transparent },
            look: LookId::OWN,
        };
        self.items.iter().enumerate().map(span).collect()
    }

    /// Finds out what may be seen, or brings to the GPU what [`Self::record`] needs for that. Takes away
    /// those of the elements that nobody sees, where it knows.
    ///
    /// # Errors
    /// If the GPU has no room.
    pub fn prepare(
        &mut self,
        gpu: &Gpu,
        frame: &Frame<'_>,
        elements: &mut Vec<ElementId>,
    ) -> Result<(), GpuError> {
        match &mut self.way {
            Way::Cpu { culler, packed, counts } => {
                let [x, y, width, height] = frame.covered.map(|v| v as i32);
                let area = [IVec2::new(x, y), IVec2::new(x + width, y + height)];
                culler.cull(&Cut {
                    items: &self.items,
                    opaque_items: self.opaque_items,
                    tree: frame.tree,
                    elements,
                    model: frame.model,
                    screen: Screen::new(
                        frame.clip_from_world,
                        frame.view.projection,
                        frame.view.size,
                        area,
                        frame.samples,
                        frame.reach_m,
                    ),
                    area,
                });
                let mut slots = 0..;
                elements.retain(|_| slots.next().is_some_and(|slot| culler.is_left(slot)));
                *counts = [0, 1].map(|layer| culler.left(layer).map(|l| l.len() as u32).sum());
                let [opaque, transparent] = *counts;
                packed.hold(gpu, u64::from(opaque + transparent) * INDEX_BYTES)?;
                let mut at = 0;
                for layer in [0, 1] {
                    for left in culler.left(layer).filter(|left| !left.is_empty()) {
                        let bytes = bytemuck::cast_slice(left);
                        gpu.queue.write_buffer(&packed.buffer, at, bytes);
                        at += bytes.len() as u64;
                    }
                }
            }
            Way::Gpu { .. } if self.items.is_empty() => {}
            Way::Gpu { culler, .. } => {
                culler.upload(gpu, frame, &self.items, self.opaque_items, self.triangles)?;
            }
        }
        Ok(())
    }

    /// Where the GPU finds out, its commands for that. `draw_occluders` draws depth alone, of elements and
    /// by what it is given.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        frame: &Frame<'_>,
        encoder: &mut wgpu::CommandEncoder,
        draw_occluders: impl FnOnce(&mut wgpu::CommandEncoder, &dyn Fn(&mut wgpu::RenderPass<'_>)),
    ) {
        let Way::Gpu { culler, kernels } = &mut self.way else { return };
        let items = self.items.len() as u64;
        let inputs = Inputs {
            frame: frame.uniform,
            depth: frame.depth,
            vertices: &frame.geometry.vertices,
            indices: &frame.geometry.indices,
            timer: frame.timer,
        };
        culler.recall(gpu, kernels, &inputs, items, encoder);
        let (drawn, geometry) = (culler.drawn(), frame.geometry);
        draw_occluders(encoder, &|pass| draw_commands(pass, geometry, drawn, 0));
        culler.test(gpu, kernels, &inputs, items, frame.covered, encoder);
    }

    /// Draws what is left of a layer with the pipeline that is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, geometry: &Geometry, layer: Layer) {
        let slot = match layer {
            Layer::Opaque => 0,
            Layer::Transparent => 1,
        };
        match &self.way {
            Way::Cpu { packed, counts, .. } => {
                let first = if slot == 0 { 0 } else { counts[0] };
                pass.set_vertex_buffer(0, geometry.vertices.slice(..));
                pass.set_index_buffer(packed.buffer.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(first..first + counts[slot], 0, 0..1);
            }
            Way::Gpu { culler, .. } => draw_commands(pass, geometry, culler.drawn(), slot as u64),
        }
    }
}

/// Draws what the kernels left.
fn draw_commands(
    pass: &mut wgpu::RenderPass<'_>,
    geometry: &Geometry,
    (indices, commands): (&wgpu::Buffer, &wgpu::Buffer),
    slot: u64,
) {
    pass.set_vertex_buffer(0, geometry.vertices.slice(..));
    pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
    pass.draw_indexed_indirect(commands, slot * COMMAND_BYTES);
}

/// Appends the spans of a layer, cut where words of the tables of bits begin.
fn cut_at_words(spans: &[Span], layer: Layer, items: &mut Vec<Item>) {
    for span in spans.iter().filter(|s| s.layer == layer) {
        let mut triangle = span.first_index / 3;
        let end = triangle + span.index_count / 3;
        while triangle < end {
            let count = (32 - triangle % 32).min(end - triangle);
            items.push(Item { triangle, count, base_vertex: span.base_vertex });
            triangle += count;
        }
    }
}
