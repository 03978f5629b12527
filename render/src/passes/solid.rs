//! Everything opaque: writes colour and depth.

use super::{SceneBindings, ScenePipeline};
use crate::gpu::Gpu;

pub(super) const SHADER: &str = concat!(
    include_str!("../../../shaders/common/frame.wgsl"),
    include_str!("../../../shaders/common/light.wgsl"),
    include_str!("../../../shaders/common/instance.wgsl"),
    include_str!("../../../shaders/solid.wgsl"),
);

/// The pass of the opaque layer.
#[derive(Debug)]
pub(crate) struct Solid {
    pub pipeline: wgpu::RenderPipeline,
}

impl Solid {
    pub fn new(gpu: &Gpu, bindings: &SceneBindings, samples: u32) -> Self {
        let pipeline = ScenePipeline {
            label: "solid",
            shader: SHADER,
            vertex: "solid_vertex",
            fragment: "solid_fragment",
            from_pool: true,
            topology: wgpu::PrimitiveTopology::TriangleList,
            blend: None,
            write_depth: true,
            compare: wgpu::CompareFunction::Greater,
        }
        .build(gpu, bindings, samples);
        Self { pipeline }
    }
}
