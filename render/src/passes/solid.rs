//! Everything opaque: writes colour and depth.

use super::{SceneBindings, ScenePipeline, Vertices};
use crate::gpu::Gpu;
use crate::shader::{Shader, shader};

pub(super) const SHADER: Shader = shader!(
    "solid",
    "common/frame.wgsl",
    "common/light.wgsl",
    "common/instance.wgsl",
    "common/fade.wgsl",
    "common/section.wgsl",
    "solid.wgsl",
);

/// The pass of the opaque layer.
#[derive(Debug)]
pub(crate) struct Solid {
    /// Of placed geometry.
    pub placed: wgpu::RenderPipeline,
    /// Of geometry that is where it belongs.
    pub fixed: wgpu::RenderPipeline,
    /// The two with depth alone.
    pub occluder_placed: wgpu::RenderPipeline,
    pub occluder_fixed: wgpu::RenderPipeline,
    /// Of placed geometry, as far as section planes show it.
    pub cut: wgpu::RenderPipeline,
    /// Of placed geometry that fades.
    pub fading: Option<wgpu::RenderPipeline>,
}

impl Solid {
    /// `fades`: whether anything may fade.
    pub fn new(gpu: &Gpu, bindings: &SceneBindings, samples: u32, fades: bool) -> Self {
        let build = |vertex, fragment, vertices| {
            ScenePipeline {
                label: "solid",
                shader: SHADER,
                vertex,
                fragment,
                vertices,
                topology: wgpu::PrimitiveTopology::TriangleList,
                write_depth: true,
                compare: wgpu::CompareFunction::Greater,
            }
            .build(gpu, &bindings.pipeline_layout, samples)
        };
        let fragment = Some("solid_fragment");
        Self {
            placed: build("solid_vertex", fragment, Vertices::Placed),
            fixed: build("solid_fixed_vertex", fragment, Vertices::Fixed),
            cut: build("solid_cut_vertex", Some("solid_cut_fragment"), Vertices::Placed),
            occluder_placed: build("occluder_vertex", None, Vertices::Placed),
            occluder_fixed: build("occluder_fixed_vertex", None, Vertices::Fixed),
            fading: fades.then(|| {
                build("solid_fading_vertex", Some("solid_fading_fragment"), Vertices::Fading)
            }),
        }
    }
}
