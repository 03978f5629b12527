//! The cuts of solids by section planes: their surfaces are added up, then what is left of them is drawn.

use super::{DEPTH_FORMAT, SCENE_FORMAT, SceneBindings, module, texture_entry, vertex_buffers};
use crate::gpu::Gpu;
use crate::shader::{Shader, shader};

pub(super) const SHADER: Shader = shader!(
    "caps",
    "common/frame.wgsl",
    "common/light.wgsl",
    "common/instance.wgsl",
    "common/screen.wgsl",
    "caps.wgsl",
);

/// Sums of colours, and of how often a ray leaves solids.
pub(crate) const SUM_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Everything is added up.
const SUM: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::One,
    dst_factor: wgpu::BlendFactor::One,
    operation: wgpu::BlendOperation::Add,
};

/// The pipelines.
#[derive(Debug)]
pub(crate) struct Caps {
    /// Of solids whose triangles are counter-clockwise as seen from outside, and of those where they are not.
    pub sum: [wgpu::RenderPipeline; 2],
    /// Over the whole picture.
    pub fill: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
}

impl Caps {
    /// `samples` of the scene.
    pub fn new(gpu: &Gpu, bindings: &SceneBindings, samples: u32) -> Self {
        let float = wgpu::TextureSampleType::Float { filterable: false };
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("caps"),
            entries: &[texture_entry(0, float, false)],
        });
        let over = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("caps"),
            bind_group_layouts: &[Some(&bindings.layout), Some(&layout)],
            immediate_size: 0,
        });
        let module = module(gpu, SHADER);
        let pool = vertex_buffers();
        let build = |entries: [&str; 2], sums: bool| {
            let blend = sums.then_some(wgpu::BlendState { color: SUM, alpha: SUM });
            let target = [Some(wgpu::ColorTargetState {
                format: if sums { SUM_FORMAT } else { SCENE_FORMAT },
                blend,
                write_mask: wgpu::ColorWrites::ALL,
            })];
            gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("caps"),
                layout: Some(if sums { &bindings.pipeline_layout } else { &over }),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(entries[0]),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: if sums { &pool[..3] } else { &[] },
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: (!sums).then(|| wgpu::DepthStencilState {
                    format: DEPTH_FORMAT,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Greater),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState {
                    count: if sums { 1 } else { samples },
                    ..Default::default()
                },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(entries[1]),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &target,
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Self {
            sum: ["sum_outward_fragment", "sum_inward_fragment"]
                .map(|fragment| build(["sum_vertex", fragment], true)),
            fill: build(["screen_vertex", "cap_fragment"], false),
            layout,
        }
    }

    /// `sums`: what the surfaces added up to.
    pub fn bind(&self, gpu: &Gpu, sums: &wgpu::TextureView) -> wgpu::BindGroup {
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("caps"),
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(sums),
            }],
        })
    }
}
