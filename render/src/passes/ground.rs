//! The ground with its grid where nothing solid is.

use super::{SceneBindings, ScenePipeline, Vertices};
use crate::gpu::Gpu;
use crate::shader::{Shader, shader};

pub(super) const SHADER: Shader =
    shader!("ground", "common/frame.wgsl", "common/background.wgsl", "ground.wgsl",);

/// One square around the scene, behind everything but the sky, which it leaves out.
#[derive(Debug)]
pub(crate) struct Ground {
    pipeline: wgpu::RenderPipeline,
}

impl Ground {
    pub fn new(gpu: &Gpu, bindings: &SceneBindings, samples: u32) -> Self {
        let pipeline = ScenePipeline {
            label: "ground",
            shader: SHADER,
            vertex: "ground_vertex",
            fragment: Some("ground_fragment"),
            vertices: Vertices::None,
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            write_depth: true,
            compare: wgpu::CompareFunction::GreaterEqual,
        }
        .build(gpu, &bindings.pipeline_layout, samples);
        Self { pipeline }
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..4, 0..1);
    }
}
