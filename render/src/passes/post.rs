//! From the drawn picture to the shown one: edge lines and soft stairs.

use super::{OUTPUT_FORMAT, buffer_entry, module};
use crate::gpu::Gpu;

pub(super) const SHADER_ONE: &str = concat!(
    include_str!("../../../shaders/common/frame.wgsl"),
    include_str!("../../../shaders/common/depth_one.wgsl"),
    include_str!("../../../shaders/post.wgsl"),
);
pub(super) const SHADER_MANY: &str = concat!(
    include_str!("../../../shaders/common/frame.wgsl"),
    include_str!("../../../shaders/common/depth_many.wgsl"),
    include_str!("../../../shaders/post.wgsl"),
);

/// One triangle over the whole picture.
#[derive(Debug)]
pub(crate) struct Post {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
}

impl Post {
    /// `samples` of the depth that is read; `smooth_stairs` where nothing else softens the edges.
    pub fn new(gpu: &Gpu, samples: u32, smooth_stairs: bool) -> Self {
        let layout = layout(gpu, samples > 1);
        let shader = if samples > 1 { SHADER_MANY } else { SHADER_ONE };
        let module = module(gpu, "post", shader);
        let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("post"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let options = wgpu::PipelineCompilationOptions {
            constants: &[("smooth_stairs", f64::from(u8::from(smooth_stairs)))],
            ..Default::default()
        };
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("post"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("post_vertex"),
                compilation_options: options.clone(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("post_fragment"),
                compilation_options: options,
                targets: &[Some(OUTPUT_FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("post"),
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
        depth: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("post"),
            layout: &self.layout,
            entries: &[
                entry(0, frame.as_entire_binding()),
                entry(1, wgpu::BindingResource::TextureView(picture)),
                entry(2, wgpu::BindingResource::Sampler(&self.sampler)),
                entry(3, wgpu::BindingResource::TextureView(depth)),
            ],
        })
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, bindings: &wgpu::BindGroup) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, bindings, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn layout(gpu: &Gpu, multisampled: bool) -> wgpu::BindGroupLayout {
    let fragment = wgpu::ShaderStages::FRAGMENT;
    let texture = |binding, sample_type, multisampled| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: fragment,
        ty: wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled,
        },
        count: None,
    };
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("post"),
        entries: &[
            buffer_entry(0, fragment, wgpu::BufferBindingType::Uniform),
            texture(1, wgpu::TextureSampleType::Float { filterable: true }, false),
            wgpu::BindGroupLayoutEntry {
                binding: 2,
                visibility: fragment,
                ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                count: None,
            },
            texture(3, wgpu::TextureSampleType::Depth, multisampled),
        ],
    })
}
