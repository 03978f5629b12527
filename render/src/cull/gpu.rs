//! Culling on the GPU: a kernel packs the occluders, a render pass draws their depth, kernels make a
//! pyramid of what is farthest in blocks of pixels, hold every triangle against it and pack what is left.

use super::{Frame, INDEX_BYTES, Item, Table};
use crate::gpu::{Gpu, GpuError};
use crate::passes::module;
use crate::shader::{Shader, shader};
use crate::timing::{GpuTimer, Pass};
use bytemuck::{Pod, Zeroable};
use glam::UVec2;
use wgpu::BufferUsages;

/// Levels of the pyramid, 0 being the depth itself.
const LEVELS: usize = 7;
const THREADS: u32 = 64;
/// Bytes of one indirect command.
pub(crate) const COMMAND_BYTES: u64 = 20;

/// The twin of `Cull` in `shaders/common/cull.wgsl`; a test compares the two.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct CullUniform {
    pub low: UVec2,
    pub high: UVec2,
    pub items: u32,
    pub opaque_items: u32,
    pub samples: u32,
    pub index_bits: u32,
    pub levels: [[u32; 4]; 8],
}

const RECALL: Shader = shader!("recall", "common/cull.wgsl", "cull/recall.wgsl");
const PACK: Shader = shader!("pack", "common/cull.wgsl", "cull/indices.wgsl", "cull/pack.wgsl");
const PYRAMID_ONE: Shader =
    shader!("pyramid, one sample", "common/cull.wgsl", "cull/depth_one.wgsl", "cull/pyramid.wgsl",);
const PYRAMID_MANY: Shader = shader!(
    "pyramid, many samples",
    "common/cull.wgsl",
    "cull/depth_many.wgsl",
    "cull/pyramid.wgsl",
);
const TEST_ONE: Shader = shader!(
    "test, one sample",
    "common/frame.wgsl",
    "common/cull.wgsl",
    "cull/indices.wgsl",
    "cull/depth_one.wgsl",
    "cull/test.wgsl",
);
const TEST_MANY: Shader = shader!(
    "test, many samples",
    "common/frame.wgsl",
    "common/cull.wgsl",
    "cull/indices.wgsl",
    "cull/depth_many.wgsl",
    "cull/test.wgsl",
);

/// The shaders of all kernels.
pub(crate) const KERNELS: [Shader; 6] =
    [RECALL, PACK, PYRAMID_ONE, PYRAMID_MANY, TEST_ONE, TEST_MANY];

/// The kernels; they depend on the number of samples.
#[derive(Debug)]
pub(crate) struct Kernels {
    recall: wgpu::ComputePipeline,
    count: wgpu::ComputePipeline,
    pack: wgpu::ComputePipeline,
    fine: wgpu::ComputePipeline,
    coarse: wgpu::ComputePipeline,
    test: wgpu::ComputePipeline,
}

impl Kernels {
    pub fn new(gpu: &Gpu, samples: u32) -> Self {
        let build = |shader, entry| {
            let module = module(gpu, shader);
            gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: None,
                module: &module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        };
        let (pyramid, test) =
            if samples > 1 { (PYRAMID_MANY, TEST_MANY) } else { (PYRAMID_ONE, TEST_ONE) };
        Self {
            recall: build(RECALL, "recall"),
            count: build(PACK, "count"),
            pack: build(PACK, "pack"),
            fine: build(pyramid, "pyramid_fine"),
            coarse: build(pyramid, "pyramid_coarse"),
            test: build(test, "test_triangles"),
        }
    }
}

/// Whether the device can run the kernels.
pub(super) fn is_able(gpu: &Gpu) -> bool {
    let limits = gpu.device.limits();
    limits.max_storage_buffers_per_shader_stage >= 6
        && limits.max_compute_invocations_per_workgroup >= 256
        && limits.max_compute_workgroup_size_x >= 256
        && limits.max_compute_workgroups_per_dimension >= 65_535
}

/// What the kernels work on.
#[derive(Debug)]
pub(crate) struct GpuCuller {
    uniform: wgpu::Buffer,
    items: Table,
    masks: Table,
    offsets: Table,
    /// Indices of the triangles that are left.
    packed: Table,
    pyramid: Table,
    commands: wgpu::Buffer,
    /// One bit a triangle of the tree: the frame before and this one, in turns.
    seen: [Table; 2],
    turn: usize,
}

/// Everything that a frame's kernels read besides what [`GpuCuller`] holds.
pub(crate) struct Inputs<'a> {
    pub frame: &'a wgpu::Buffer,
    pub depth: &'a wgpu::TextureView,
    pub vertices: &'a wgpu::Buffer,
    pub indices: &'a wgpu::Buffer,
    pub timer: Option<&'a GpuTimer>,
}

impl GpuCuller {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let uniform = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let none = BufferUsages::STORAGE;
        let bits = || Table::new(gpu, "triangles seen", none);
        let commands = BufferUsages::STORAGE | BufferUsages::INDIRECT;
        Ok(Self {
            uniform: gpu.buffer("culling", size_of::<CullUniform>() as u64, uniform)?,
            items: Table::new(gpu, "culling items", none)?,
            masks: Table::new(gpu, "culling masks", none)?,
            offsets: Table::new(gpu, "culling offsets", none)?,
            packed: Table::new(gpu, "indices left", BufferUsages::STORAGE | BufferUsages::INDEX)?,
            pyramid: Table::new(gpu, "depth pyramid", none)?,
            commands: gpu.buffer("commands left", 2 * COMMAND_BYTES, commands)?,
            seen: [bits()?, bits()?],
            turn: 0,
        })
    }

    /// The buffer of indices and that of the two commands, opaque and transparent.
    pub fn drawn(&self) -> (&wgpu::Buffer, &wgpu::Buffer) {
        (&self.packed.buffer, &self.commands)
    }

    pub fn bytes(&self) -> u64 {
        let tables = [&self.items, &self.masks, &self.offsets, &self.packed, &self.pyramid];
        let tables = tables.into_iter().chain(&self.seen).map(|t| t.buffer.size()).sum::<u64>();
        tables + self.uniform.size() + self.commands.size()
    }

    /// Uploads what is in the cut of a frame. `triangles`: how many.
    pub(super) fn upload(
        &mut self,
        gpu: &Gpu,
        frame: &Frame<'_>,
        list: &[Item],
        opaque_items: usize,
        triangles: u64,
    ) -> Result<(), GpuError> {
        let size = frame.view.size;
        let mut levels = [[0; 4]; 8];
        let mut texels = 0;
        for (level, [first, width, height, _]) in levels.iter_mut().take(LEVELS).enumerate() {
            let at = (size + UVec2::splat((1 << level) - 1)) >> UVec2::splat(level as u32);
            (*first, *width, *height) = (texels, at.x, at.y);
            texels += if level > 0 { at.x * at.y } else { 0 };
        }
        let items = list.len() as u64;
        self.pyramid.hold(gpu, u64::from(texels) * 4)?;
        self.items.hold(gpu, items * size_of::<Item>() as u64)?;
        self.masks.hold(gpu, items * 4)?;
        self.offsets.hold(gpu, (items + 1) * 4)?;
        self.packed.hold(gpu, triangles * 3 * INDEX_BYTES)?;
        for seen in &mut self.seen {
            seen.hold(gpu, (frame.tree.indices.len() as u64 / 3).div_ceil(32) * 4)?;
        }
        let [x, y, width, height] = frame.covered;
        let uniform = CullUniform {
            low: UVec2::new(x, y),
            high: UVec2::new(x + width, y + height),
            items: items as u32,
            opaque_items: opaque_items as u32,
            samples: frame.samples,
            index_bits: frame.geometry.index_bits(),
            levels,
        };
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        gpu.queue.write_buffer(&self.items.buffer, 0, bytemuck::cast_slice(list));
        Ok(())
    }

    fn groups(threads: u64) -> (u32, u32) {
        let groups = threads.div_ceil(u64::from(THREADS)).max(1);
        let rows = groups.div_ceil(65_535);
        (groups.div_ceil(rows) as u32, rows as u32)
    }

    /// Packs the occluders.
    pub fn recall(
        &self,
        gpu: &Gpu,
        kernels: &Kernels,
        inputs: &Inputs<'_>,
        items: u64,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        let mut pass =
            begin(encoder, "recall", inputs.timer.and_then(|t| t.of_kernels(Pass::Recall)));
        let before = &self.seen[self.turn].buffer;
        let group = bind(
            gpu,
            &kernels.recall,
            &[(0, &self.uniform), (1, &self.items.buffer), (2, before), (3, &self.masks.buffer)],
            None,
        );
        pass.set_pipeline(&kernels.recall);
        pass.set_bind_group(0, &group, &[]);
        let (x, y) = Self::groups(items);
        pass.dispatch_workgroups(x, y, 1);
        self.pack(gpu, kernels, inputs, items, &mut pass);
    }

    fn pack(
        &self,
        gpu: &Gpu,
        kernels: &Kernels,
        inputs: &Inputs<'_>,
        items: u64,
        pass: &mut wgpu::ComputePass<'_>,
    ) {
        let group = bind(
            gpu,
            &kernels.count,
            &[
                (0, &self.uniform),
                (3, &self.masks.buffer),
                (4, &self.offsets.buffer),
                (6, &self.commands),
            ],
            None,
        );
        pass.set_pipeline(&kernels.count);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        let group = bind(
            gpu,
            &kernels.pack,
            &[
                (0, &self.uniform),
                (1, &self.items.buffer),
                (2, inputs.indices),
                (3, &self.masks.buffer),
                (4, &self.offsets.buffer),
                (5, &self.packed.buffer),
            ],
            None,
        );
        pass.set_pipeline(&kernels.pack);
        pass.set_bind_group(0, &group, &[]);
        let (x, y) = Self::groups(items);
        pass.dispatch_workgroups(x, y, 1);
    }

    /// Holds every triangle against the depth of the occluders and packs those that may be seen.
    pub fn test(
        &mut self,
        gpu: &Gpu,
        kernels: &Kernels,
        inputs: &Inputs<'_>,
        items: u64,
        covered: [u32; 4],
        encoder: &mut wgpu::CommandEncoder,
    ) {
        self.turn = 1 - self.turn;
        let seen = &self.seen[self.turn].buffer;
        encoder.clear_buffer(seen, 0, None);
        encoder.clear_buffer(&self.masks.buffer, 0, None);
        let mut pass =
            begin(encoder, "culling", inputs.timer.and_then(|t| t.of_kernels(Pass::Cull)));
        let [x, y, w, h] = covered;
        for (pipeline, shift) in [(&kernels.fine, 3u32), (&kernels.coarse, 6)] {
            let group = bind(
                gpu,
                pipeline,
                &[(0, &self.uniform), (2, &self.pyramid.buffer)],
                Some(inputs.depth),
            );
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            let blocks = |low: u32, extent: u32| {
                (((low + extent - 1) >> shift) - (low >> shift) + 1).div_ceil(8)
            };
            pass.dispatch_workgroups(blocks(x, w), blocks(y, h), 1);
        }
        let group = bind(
            gpu,
            &kernels.test,
            &[
                (0, inputs.frame),
                (2, &self.pyramid.buffer),
                (3, &self.uniform),
                (4, &self.items.buffer),
                (5, inputs.vertices),
                (6, inputs.indices),
                (7, &self.masks.buffer),
                (8, seen),
            ],
            Some(inputs.depth),
        );
        pass.set_pipeline(&kernels.test);
        pass.set_bind_group(0, &group, &[]);
        let (x, y) = Self::groups(items * 32);
        pass.dispatch_workgroups(x, y, 1);
        self.pack(gpu, kernels, inputs, items, &mut pass);
    }
}

fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &str,
    timestamp_writes: Option<wgpu::ComputePassTimestampWrites<'_>>,
) -> wgpu::ComputePass<'a> {
    encoder
        .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes })
}

fn bind(
    gpu: &Gpu,
    pipeline: &wgpu::ComputePipeline,
    buffers: &[(u32, &wgpu::Buffer)],
    depth: Option<&wgpu::TextureView>,
) -> wgpu::BindGroup {
    let mut entries: Vec<_> = buffers
        .iter()
        .map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding: *binding,
            resource: buffer.as_entire_binding(),
        })
        .collect();
    if let Some(depth) = depth {
        entries.push(wgpu::BindGroupEntry {
            binding: 1,
            resource: wgpu::BindingResource::TextureView(depth),
        });
    }
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    })
}
