//! One pass, one struct, one file, one shader.

mod caps;
mod edges;
mod glass;
mod ground;
mod outline;
mod sky;
mod smooth;
mod solid;

pub(crate) use caps::{Caps, SUM_FORMAT};
pub(crate) use edges::Edges;
pub(crate) use glass::Glass;
pub(crate) use ground::Ground;
pub(crate) use outline::{MASK_FORMAT, Outline};
pub(crate) use sky::Sky;
pub(crate) use smooth::Smooth;
pub(crate) use solid::Solid;

use crate::gpu::Gpu;
use crate::pool::{INSTANCE_BYTES, LOOK_BYTES, VERTEX_BYTES};
use crate::shader::Shader;

/// What the scene is drawn into: gamma-encoded colour; alpha is 255 of 255 where an element is, 253
/// where one that fades is, 254 where none is.
pub(crate) const SCENE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Reversed: 1 near, 0 infinitely far.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The shaders of all passes.
pub(crate) const SHADERS: [Shader; 11] = [
    solid::SHADER,
    glass::SHADER,
    caps::SHADER,
    sky::SHADER,
    ground::SHADER,
    smooth::SHADER,
    edges::SHADER_ONE,
    edges::SHADER_MANY,
    outline::MASK_ONE,
    outline::MASK_MANY,
    outline::SHADER,
];

pub(crate) fn module(gpu: &Gpu, shader: Shader) -> wgpu::ShaderModule {
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(shader.name),
        source: wgpu::ShaderSource::Wgsl(gpu.shaders.of(shader)),
    })
}

/// The bind group that solid, glass, sky and ground share: the frame and the materials.
#[derive(Debug)]
pub(crate) struct SceneBindings {
    pub layout: wgpu::BindGroupLayout,
    pub pipeline_layout: wgpu::PipelineLayout,
}

impl SceneBindings {
    pub fn new(gpu: &Gpu) -> Self {
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("scene bindings"),
            entries: &[
                buffer_entry(
                    0,
                    wgpu::ShaderStages::VERTEX_FRAGMENT,
                    wgpu::BufferBindingType::Uniform,
                ),
                buffer_entry(
                    1,
                    wgpu::ShaderStages::VERTEX,
                    wgpu::BufferBindingType::Storage { read_only: true },
                ),
            ],
        });
        let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("scene pipelines"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        Self { layout, pipeline_layout }
    }

    pub fn bind(
        &self,
        gpu: &Gpu,
        frame: &wgpu::Buffer,
        materials: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("scene bindings"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: frame.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: materials.as_entire_binding() },
            ],
        })
    }
}

pub(crate) fn buffer_entry(
    binding: u32,
    visibility: wgpu::ShaderStages,
    ty: wgpu::BufferBindingType,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}

pub(crate) fn texture_entry(
    binding: u32,
    sample_type: wgpu::TextureSampleType,
    multisampled: bool,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled,
        },
        count: None,
    }
}

pub(crate) const VERTEX_ATTRIBUTES: [wgpu::VertexAttribute; 2] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32];
const LOOK_ATTRIBUTES: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![6 => Uint32];
const SHARE_ATTRIBUTES: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![5 => Uint32];
pub(crate) const INSTANCE_ATTRIBUTES: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![2 => Float32x4, 3 => Float32x4, 4 => Float32x4];

/// The pool's vertices, its instances and their looks, and a share of the pixels ([`crate::fade::Share::code`]) that holds for
/// all.
fn vertex_buffers() -> [Option<wgpu::VertexBufferLayout<'static>>; 4] {
    [
        Some(wgpu::VertexBufferLayout {
            array_stride: VERTEX_BYTES,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &VERTEX_ATTRIBUTES,
        }),
        Some(wgpu::VertexBufferLayout {
            array_stride: INSTANCE_BYTES,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &INSTANCE_ATTRIBUTES,
        }),
        Some(wgpu::VertexBufferLayout {
            array_stride: LOOK_BYTES,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &LOOK_ATTRIBUTES,
        }),
        Some(wgpu::VertexBufferLayout {
            array_stride: 0,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &SHARE_ATTRIBUTES,
        }),
    ]
}

/// Where a pass of the scene has its vertices from.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Vertices {
    /// The shader makes them.
    None,
    /// The pool, placed by its instances.
    Placed,
    /// The same, with their share of the pixels.
    Fading,
    /// The pool, where they already are where they belong.
    Fixed,
}

/// How a pass of the scene differs from the others.
struct ScenePipeline<'a> {
    label: &'a str,
    shader: Shader,
    vertex: &'a str,
    /// `None`: depth alone.
    fragment: Option<&'a str>,
    vertices: Vertices,
    topology: wgpu::PrimitiveTopology,
    write_depth: bool,
    compare: wgpu::CompareFunction,
}

impl ScenePipeline<'_> {
    fn build(
        &self,
        gpu: &Gpu,
        layout: &wgpu::PipelineLayout,
        samples: u32,
    ) -> wgpu::RenderPipeline {
        let module = module(gpu, self.shader);
        let pool = vertex_buffers();
        let target = [Some(wgpu::ColorTargetState {
            format: SCENE_FORMAT,
            blend: None,
            write_mask: wgpu::ColorWrites::ALL,
        })];
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(self.vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: match self.vertices {
                    Vertices::None => &[],
                    Vertices::Placed => &pool[..3],
                    Vertices::Fading => &pool,
                    Vertices::Fixed => &pool[..1],
                },
            },
            primitive: wgpu::PrimitiveState { topology: self.topology, ..Default::default() },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(self.write_depth),
                depth_compare: Some(self.compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
            fragment: self.fragment.map(|entry| wgpu::FragmentState {
                module: &module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &target,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// How a pass over the shown picture differs from the others.
struct ScreenPipeline<'a> {
    label: &'a str,
    shader: Shader,
    fragment: &'a str,
    blend: Option<wgpu::BlendState>,
    /// Test against the scene's depth of a triangle between everything solid and ground and sky; `None`
    /// without attachment.
    depth: Option<wgpu::CompareFunction>,
}

impl ScreenPipeline<'_> {
    fn build(&self, gpu: &Gpu, layout: &wgpu::BindGroupLayout) -> wgpu::RenderPipeline {
        let module = module(gpu, self.shader);
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.label),
            bind_group_layouts: &[Some(layout)],
            immediate_size: 0,
        });
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("screen_vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: self.depth.map(|compare| wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(false),
                depth_compare: Some(compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(self.fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: SCENE_FORMAT,
                    blend: self.blend,
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
