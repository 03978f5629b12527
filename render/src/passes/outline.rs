//! The line around what is selected: a mask of it, then a pass over the picture.

use super::{ScreenPipeline, buffer_entry, module, texture_entry, vertex_buffers};
use crate::gpu::Gpu;
use crate::shader::{Shader, shader};

pub(super) const MASK_ONE: Shader = shader!(
    "mask, one sample",
    "common/frame.wgsl",
    "common/section.wgsl",
    "common/depth_one.wgsl",
    "mask.wgsl"
);
pub(super) const MASK_MANY: Shader = shader!(
    "mask, many samples",
    "common/frame.wgsl",
    "common/section.wgsl",
    "common/depth_many.wgsl",
    "mask.wgsl"
);
pub(super) const SHADER: Shader =
    shader!("outline", "common/frame.wgsl", "common/screen.wgsl", "outline.wgsl");

/// 1 where what is selected is seen, one half where it is hidden.
pub(crate) const MASK_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// Seen wins over hidden.
const LARGEST: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::One,
    dst_factor: wgpu::BlendFactor::One,
    operation: wgpu::BlendOperation::Max,
};

/// The line over the picture, whose alpha stays.
const BLEND: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::SrcAlpha,
        dst_factor: wgpu::BlendFactor::OneMinusSrcAlpha,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
};

/// The two pipelines.
#[derive(Debug)]
pub(crate) struct Outline {
    mask_layout: wgpu::BindGroupLayout,
    line_layout: wgpu::BindGroupLayout,
    pub mask: wgpu::RenderPipeline,
    pub line: wgpu::RenderPipeline,
}

impl Outline {
    /// `samples` of the depth.
    pub fn new(gpu: &Gpu, samples: u32) -> Self {
        let layout = |label, texture| {
            let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
            gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries: &[buffer_entry(0, stages, wgpu::BufferBindingType::Uniform), texture],
            })
        };
        let depth = texture_entry(1, wgpu::TextureSampleType::Depth, samples > 1);
        let float = wgpu::TextureSampleType::Float { filterable: false };
        let mask_layout = layout("mask", depth);
        let line_layout = layout("outline", texture_entry(1, float, false));
        let line = ScreenPipeline {
            label: "outline",
            shader: SHADER,
            fragment: "outline_fragment",
            blend: Some(BLEND),
            depth: None,
        }
        .build(gpu, &line_layout);
        let mask = mask_pipeline(gpu, &mask_layout, samples);
        Self { mask_layout, line_layout, mask, line }
    }

    /// What the mask is drawn with (`depth`), and what the line is drawn with (`mask`).
    pub fn bind(
        &self,
        gpu: &Gpu,
        frame: &wgpu::Buffer,
        depth: &wgpu::TextureView,
        mask: &wgpu::TextureView,
    ) -> [wgpu::BindGroup; 2] {
        [(&self.mask_layout, depth), (&self.line_layout, mask)].map(|(layout, view)| {
            let texture = wgpu::BindingResource::TextureView(view);
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("outline"),
                layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: frame.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: texture },
                ],
            })
        })
    }
}

fn mask_pipeline(gpu: &Gpu, layout: &wgpu::BindGroupLayout, samples: u32) -> wgpu::RenderPipeline {
    let module = module(gpu, if samples > 1 { MASK_MANY } else { MASK_ONE });
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("mask"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("mask"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("mask_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &vertex_buffers()[..2],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("mask_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: MASK_FORMAT,
                blend: Some(wgpu::BlendState { color: LARGEST, alpha: LARGEST }),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
