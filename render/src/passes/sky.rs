//! The sky where nothing solid is.

use super::{SceneBindings, ScenePipeline, Vertices};
use crate::gpu::Gpu;
use crate::shader::{Shader, shader};

pub(super) const SHADER: Shader =
    shader!("sky", "common/frame.wgsl", "common/background.wgsl", "sky.wgsl",);

/// One triangle over the whole picture at infinite depth.
#[derive(Debug)]
pub(crate) struct Sky {
    pipeline: wgpu::RenderPipeline,
}

impl Sky {
    pub fn new(gpu: &Gpu, bindings: &SceneBindings, samples: u32) -> Self {
        let pipeline = ScenePipeline {
            label: "sky",
            shader: SHADER,
            vertex: "sky_vertex",
            fragment: Some("sky_fragment"),
            vertices: Vertices::None,
            topology: wgpu::PrimitiveTopology::TriangleList,
            write_depth: false,
            compare: wgpu::CompareFunction::GreaterEqual,
        }
        .build(gpu, &bindings.pipeline_layout, samples);
        Self { pipeline }
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..3, 0..1);
    }
}
