//! Everything transparent: blended over the solid parts and the sky, tests depth, writes none.

use super::{SceneBindings, ScenePipeline, Vertices};
use crate::gpu::Gpu;
use crate::shader::{Shader, shader};

pub(super) const SHADER: Shader = shader!(
    "glass",
    "common/frame.wgsl",
    "common/light.wgsl",
    "common/instance.wgsl",
    "glass.wgsl",
);

/// The pass of the transparent layer.
#[derive(Debug)]
pub(crate) struct Glass {
    /// Of placed geometry.
    pub placed: wgpu::RenderPipeline,
    /// Of geometry that is where it belongs.
    pub fixed: wgpu::RenderPipeline,
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
        let build = |vertex, vertices| {
            ScenePipeline {
                label: "glass",
                shader: SHADER,
                vertex,
                fragment: Some("glass_fragment"),
                vertices,
                topology: wgpu::PrimitiveTopology::TriangleList,
                blend: Some(BLEND),
                write_depth: false,
                compare: wgpu::CompareFunction::Greater,
            }
            .build(gpu, bindings, samples)
        };
        Self {
            placed: build("glass_vertex", Vertices::Placed),
            fixed: build("glass_fixed_vertex", Vertices::Fixed),
        }
    }
}
