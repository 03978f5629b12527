//! Thin lines on folds and outlines.

use super::{ScreenPipeline, buffer_entry, texture_entry};
use crate::gpu::Gpu;
use crate::shader::{Shader, shader};

pub(super) const SHADER_ONE: Shader = shader!(
    "edges, one sample",
    "common/frame.wgsl",
    "common/depth_one.wgsl",
    "common/screen.wgsl",
    "edges.wgsl",
);
pub(super) const SHADER_MANY: Shader = shader!(
    "edges, many samples",
    "common/frame.wgsl",
    "common/depth_many.wgsl",
    "common/screen.wgsl",
    "edges.wgsl",
);

/// One triangle over the picture that darkens it.
#[derive(Debug)]
pub(crate) struct Edges {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    /// For frames in which something fades.
    fading: Option<wgpu::RenderPipeline>,
}

/// The picture times the shader's factor; its alpha stays.
const BLEND: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Dst,
        dst_factor: wgpu::BlendFactor::Zero,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
};

impl Edges {
    /// `samples` of the depth. With one, the depth test leaves out all pixels without anything
    /// solid; with more, depth and shown picture cannot be attached together.
    pub fn new(gpu: &Gpu, samples: u32, fades: bool) -> Self {
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("edges"),
            entries: &[
                buffer_entry(0, fragment, wgpu::BufferBindingType::Uniform),
                texture_entry(1, wgpu::TextureSampleType::Depth, samples > 1),
                texture_entry(2, wgpu::TextureSampleType::Float { filterable: false }, false),
            ],
        });
        let build = |fragment| {
            ScreenPipeline {
                label: "edges",
                shader: if samples > 1 { SHADER_MANY } else { SHADER_ONE },
                fragment,
                blend: Some(BLEND),
                depth: (samples == 1).then_some(wgpu::CompareFunction::Less),
            }
            .build(gpu, &layout)
        };
        let pipeline = build("edges_fragment");
        let fading = fades.then(|| build("edges_fading_fragment"));
        Self { layout, pipeline, fading }
    }

    /// `picture`: what it is drawn over, or a copy; read only where something fades.
    pub fn bind(
        &self,
        gpu: &Gpu,
        frame: &wgpu::Buffer,
        depth: &wgpu::TextureView,
        picture: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("edges"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: frame.as_entire_binding() },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(depth),
                },
                wgpu::BindGroupEntry {
                    binding: 2,
                    resource: wgpu::BindingResource::TextureView(picture),
                },
            ],
        })
    }

    /// `fading`: whether something fades.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bindings: &wgpu::BindGroup, fading: bool) {
        let other = self.fading.as_ref().filter(|_| fading);
        pass.set_pipeline(other.unwrap_or(&self.pipeline));
        pass.set_bind_group(0, bindings, &[]);
        pass.draw(0..3, 0..1);
    }
}
