//! Everything transparent: blended over the solid parts and the sky, tests depth, writes none.

use super::{SceneBindings, ScenePipeline};
use crate::gpu::Gpu;

pub(super) const SHADER: &str = concat!(
    include_str!("../../../shaders/common/frame.wgsl"),
    include_str!("../../../shaders/common/light.wgsl"),
    include_str!("../../../shaders/common/instance.wgsl"),
    include_str!("../../../shaders/glass.wgsl"),
);

/// The pass of the transparent layer.
#[derive(Debug)]
pub(crate) struct Glass {
    pub pipeline: wgpu::RenderPipeline,
}

/// Colour by the shader's opacity, which also adds to the picture's alpha: that of the sky, one step
/// below 1, becomes 1 wherever glass is, since an element is shown there.
const BLEND: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::SrcAlpha,
        dst_factor: wgpu::BlendFactor::OneMinusSrcAlpha,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
};

impl Glass {
    pub fn new(gpu: &Gpu, bindings: &SceneBindings, samples: u32) -> Self {
        let pipeline = ScenePipeline {
            label: "glass",
            shader: SHADER,
            vertex: "glass_vertex",
            fragment: "glass_fragment",
            from_pool: true,
            topology: wgpu::PrimitiveTopology::TriangleList,
            blend: Some(BLEND),
            write_depth: false,
            compare: wgpu::CompareFunction::Greater,
        }
        .build(gpu, bindings, samples);
        Self { pipeline }
    }
}
