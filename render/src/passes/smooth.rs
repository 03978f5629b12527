//! Soft stairs for pictures with one sample a pixel.

use super::{ScreenPipeline, buffer_entry, texture_entry};
use crate::gpu::Gpu;
use crate::shader::{Shader, shader};

pub(super) const SHADER: Shader =
    shader!("smooth", "common/frame.wgsl", "common/screen.wgsl", "smooth.wgsl",);

/// One triangle over the picture, from the scene's texture into the shown one.
#[derive(Debug)]
pub(crate) struct Smooth {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
}

impl Smooth {
    pub fn new(gpu: &Gpu) -> Self {
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let float = wgpu::TextureSampleType::Float { filterable: true };
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("smooth"),
            entries: &[
                buffer_entry(0, fragment, wgpu::BufferBindingType::Uniform),
                texture_entry(1, float, false),
                wgpu::BindGroupLayoutEntry {
                    binding: 2,
                    visibility: fragment,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
            ],
        });
        let pipeline = ScreenPipeline {
            label: "smooth",
            shader: SHADER,
            fragment: "smooth_fragment",
            blend: None,
            depth: Some(wgpu::CompareFunction::Always),
        }
        .build(gpu, &layout);
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("smooth"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self { layout, pipeline, sampler }
    }

    pub fn bind(
        &self,
        gpu: &Gpu,
        frame: &wgpu::Buffer,
        picture: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("smooth"),
            layout: &self.layout,
            entries: &[
                entry(0, frame.as_entire_binding()),
                entry(1, wgpu::BindingResource::TextureView(picture)),
                entry(2, wgpu::BindingResource::Sampler(&self.sampler)),
            ],
        })
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bindings: &wgpu::BindGroup) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, bindings, &[]);
        pass.draw(0..3, 0..1);
    }
}
