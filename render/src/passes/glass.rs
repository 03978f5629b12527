//! Everything transparent: of each pixel the nearest surface, once, over the picture of what is solid.

use super::{SceneBindings, ScenePipeline, Vertices, texture_entry};
use crate::gpu::Gpu;
use crate::shader::{Shader, shader};

pub(super) const SHADER: Shader = shader!(
    "glass",
    "common/frame.wgsl",
    "common/light.wgsl",
    "common/instance.wgsl",
    "common/fade.wgsl",
    "common/section.wgsl",
    "glass.wgsl",
);

/// The pass of the transparent layer. It writes depth as solids do and mixes its colour with what the
/// copy of the picture has behind it, not with what is drawn: so no order matters, and of surfaces in
/// one place the first is shown, alone.
#[derive(Debug)]
pub(crate) struct Glass {
    /// Of placed geometry.
    pub placed: wgpu::RenderPipeline,
    /// Of geometry that is where it belongs.
    pub fixed: wgpu::RenderPipeline,
    /// Of placed geometry, as far as section planes show it.
    pub cut: wgpu::RenderPipeline,
    /// Of placed geometry that fades.
    pub fading: Option<wgpu::RenderPipeline>,
    layout: wgpu::BindGroupLayout,
}

impl Glass {
    /// `fades`: whether anything may fade.
    pub fn new(gpu: &Gpu, bindings: &SceneBindings, samples: u32, fades: bool) -> Self {
        let float = wgpu::TextureSampleType::Float { filterable: false };
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("glass"),
            entries: &[texture_entry(0, float, false)],
        });
        let pipelines = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("glass"),
            bind_group_layouts: &[Some(&bindings.layout), Some(&layout)],
            immediate_size: 0,
        });
        let build = |vertex, fragment, vertices| {
            ScenePipeline {
                label: "glass",
                shader: SHADER,
                vertex,
                fragment: Some(fragment),
                vertices,
                topology: wgpu::PrimitiveTopology::TriangleList,
                write_depth: true,
                compare: wgpu::CompareFunction::Greater,
            }
            .build(gpu, &pipelines, samples)
        };
        Self {
            placed: build("glass_vertex", "glass_fragment", Vertices::Placed),
            fixed: build("glass_fixed_vertex", "glass_fragment", Vertices::Fixed),
            cut: build("glass_cut_vertex", "glass_cut_fragment", Vertices::Placed),
            fading: fades
                .then(|| build("glass_fading_vertex", "glass_fading_fragment", Vertices::Fading)),
            layout,
        }
    }

    /// `behind`: a copy of the picture without glass.
    pub fn bind(&self, gpu: &Gpu, behind: &wgpu::TextureView) -> wgpu::BindGroup {
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("glass"),
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(behind),
            }],
        })
    }
}
