//! Shaders are valid, and what Rust and WGSL share is laid out alike.

#![allow(clippy::unwrap_used)]

use crate::cull::{Item, gpu as kernels};
use crate::frame::FrameUniform;
use crate::passes::{INSTANCE_ATTRIBUTES, VERTEX_ATTRIBUTES};
use crate::pool::{InstanceRow, MaterialRow};
use crate::shader::{self, Shader};
use std::mem::offset_of;
use topout_scene::{Vertex, decode_normal, encode_normal};

fn parse(name: &str, text: &str) -> naga::Module {
    naga::front::wgsl::parse_str(text)
        .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(text)))
}

/// Members with their offsets, and the size.
type Layout = (Vec<(String, u32)>, u32);

/// The WGSL struct of that name.
fn layout(module: &naga::Module, name: &str) -> Layout {
    let (_, ty) = module
        .types
        .iter()
        .find(|(_, t)| t.name.as_deref() == Some(name))
        .unwrap_or_else(|| panic!("no struct {name}"));
    let naga::TypeInner::Struct { members, span } = &ty.inner else {
        panic!("{name} is no struct")
    };
    (members.iter().map(|m| (m.name.clone().unwrap(), m.offset)).collect(), *span)
}

macro_rules! rust_layout {
    ($ty:ty { $($field:ident),* $(,)? }) => {
        (
            vec![$((stringify!($field).to_owned(), offset_of!($ty, $field) as u32)),*],
            size_of::<$ty>() as u32,
        )
    };
}

#[test]
fn every_shader_is_valid() {
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    for Shader { name, text, .. } in shader::all() {
        let module = parse(name, text);
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name}: {e:?}"));
        assert!(!module.entry_points.is_empty(), "{name} has an entry point");
    }
}

/// A file that no shader of the list is made of would be neither validated nor looked after.
#[test]
fn every_file_belongs_to_a_shader() {
    fn below(folder: &std::path::Path, files: &mut Vec<std::path::PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() { below(&path, files) } else { files.push(path) }
        }
    }
    let root = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shaders"));
    let mut found = Vec::new();
    below(root, &mut found);
    let named: Vec<_> = shader::all().flat_map(|s| s.files).map(|file| root.join(file)).collect();
    let lost: Vec<_> = found.iter().filter(|path| !named.contains(path)).collect();
    assert!(found.len() > 15 && lost.is_empty(), "{lost:?}");
}

/// The structs that Rust writes and WGSL reads, or the other way round, by their names in WGSL.
fn shared_layouts() -> Vec<(&'static str, Layout)> {
    let command = |members: [&str; 5]| {
        let words = members.iter().zip(0..).map(|(name, i)| ((*name).to_owned(), i * 4));
        (words.collect(), kernels::COMMAND_BYTES as u32)
    };
    vec![
        (
            "Frame",
            rust_layout!(FrameUniform {
                clip_from_world,
                eye,
                parallel,
                forward,
                ground,
                right,
                haze_m,
                up,
                grid_m,
                sun,
                height_m,
                middle,
                half_extent,
                size,
                bend,
                edges,
                near,
                pixel_m,
                grid_from,
                accent,
                slack_px,
                day,
                planes,
                padding_x,
                padding_y,
                section,
            }),
        ),
        ("Material", rust_layout!(MaterialRow { color, roughness, metallic, padding })),
        (
            "Cull",
            rust_layout!(kernels::CullUniform {
                low,
                high,
                items,
                opaque_items,
                samples,
                index_bits,
                levels,
            }),
        ),
        ("Item", rust_layout!(Item { triangle, count, base_vertex })),
        // What `draw_indexed_indirect` reads.
        (
            "Command",
            command([
                "index_count",
                "instance_count",
                "first_index",
                "base_vertex",
                "first_instance",
            ]),
        ),
    ]
}

/// Every struct in a buffer of any shader is one of the above and laid out as that one.
#[test]
fn shared_structs_are_laid_out_alike() {
    let shared = shared_layouts();
    let mut met = std::collections::BTreeSet::new();
    for Shader { name, text, .. } in shader::all() {
        let module = parse(name, text);
        for (_, variable) in module.global_variables.iter() {
            let in_buffer = matches!(
                variable.space,
                naga::AddressSpace::Uniform | naga::AddressSpace::Storage { .. }
            );
            let mut ty = &module.types[variable.ty];
            while let naga::TypeInner::Array { base, .. } = ty.inner {
                ty = &module.types[base];
            }
            if !in_buffer || !matches!(ty.inner, naga::TypeInner::Struct { .. }) {
                continue;
            }
            let struct_name = ty.name.as_deref().unwrap();
            let (known, rust) = shared
                .iter()
                .find(|(known, _)| *known == struct_name)
                .unwrap_or_else(|| panic!("{name}: {struct_name} has no twin in Rust"));
            assert_eq!(layout(&module, struct_name), *rust, "{name}: {struct_name}");
            met.insert(*known);
        }
    }
    assert_eq!(met.len(), shared.len(), "{met:?}");
    assert_eq!(size_of::<wgpu::util::DrawIndexedIndirectArgs>() as u64, kernels::COMMAND_BYTES);
}

/// Cut where words of the tables of bits begin, spans still name each triangle once: what is drawn where
/// there is no room to cull is what would have been culled.
#[test]
fn spans_survive_being_cut() {
    use topout_scene::Layer;
    use topout_scene::hdlod::Span;
    let gpu = crate::Gpu::headless().unwrap();
    let mut culler = crate::cull::Culler::new(&gpu, crate::Occlusion::Cpu, 1).unwrap().unwrap();
    let span = |first: u32, count: u32, base_vertex, layer| Span {
        first_index: first * 3,
        index_count: count * 3,
        base_vertex,
        layer,
        look: topout_scene::LookId::OWN,
    };
    let spans = [
        span(30, 100, 7, Layer::Opaque),
        span(400, 1, 9, Layer::Transparent),
        span(160, 32, 8, Layer::Opaque),
    ];
    culler.set_spans(&spans);
    let triangles = |spans: &[Span]| {
        let of = |s: &Span| {
            let first = s.first_index / 3;
            let (base, glass) = (s.base_vertex, s.layer == Layer::Transparent);
            (first..first + s.index_count / 3).map(move |t| (t, base, glass))
        };
        let mut all: Vec<_> = spans.iter().flat_map(of).collect();
        all.sort_unstable();
        all
    };
    let cut = culler.spans();
    assert!(cut.len() > spans.len() && cut.iter().all(|s| s.index_count <= 96));
    assert_eq!(triangles(&cut), triangles(&spans));
    assert_eq!(culler.triangles(), 133);
}

/// The vertex shader's inputs are the pool's attributes: position, then one word with the normal in
/// the lower and the material in the upper half, then the three rows of the instance.
#[test]
fn vertex_is_packed_as_the_shader_reads_it() {
    assert_eq!((offset_of!(Vertex, position), offset_of!(Vertex, normal)), (0, 12));
    assert_eq!((offset_of!(Vertex, material), size_of::<Vertex>()), (14, 16));
    assert_eq!(size_of::<InstanceRow>(), 48);
    assert_eq!(VERTEX_ATTRIBUTES.map(|a| (a.shader_location, a.offset)), [(0, 0), (1, 12)]);
    let rows = INSTANCE_ATTRIBUTES.map(|a| (a.shader_location, a.offset));
    assert_eq!(rows, [(2, 0), (3, 16), (4, 32)]);
    let vertex = Vertex { position: [0.0; 3], normal: [-127, 64], material: 0xabcd };
    let word = bytemuck::cast::<Vertex, [u32; 4]>(vertex)[3];
    assert_eq!(word >> 16, 0xabcd);
    assert_eq!([(word & 0xff) as u8 as i8, (word >> 8 & 0xff) as u8 as i8], [-127, 64]);
}

/// The shader unfolds an octahedral normal in another way than the scene does; both agree.
#[test]
fn normals_unfold_as_in_the_scene() {
    for x in -127i8..=127 {
        for y in (-127i8..=127).step_by(5) {
            let p = glam::Vec2::new(f32::from(x), f32::from(y)) / 127.0;
            let mut n = glam::Vec3::new(p.x, p.y, 1.0 - p.x.abs() - p.y.abs());
            let fold = (-n.z).max(0.0);
            n.x -= if n.x >= 0.0 { fold } else { -fold };
            n.y -= if n.y >= 0.0 { fold } else { -fold };
            let expected = decode_normal([x, y]);
            assert!(n.normalize().distance(expected) < 1e-5, "{x} {y}: {n} {expected}");
        }
    }
    assert!(decode_normal(encode_normal(glam::Vec3::NEG_Z)).distance(glam::Vec3::NEG_Z) < 1e-5);
}

/// More than the device allows is an error with what, how much and the limit; never a panic.
#[test]
fn too_big_is_an_error() {
    let gpu = crate::Gpu::headless().unwrap();
    let limit = gpu.device.limits().max_buffer_size;
    let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
    let error = gpu.buffer("scene vertices", limit + 1, usage).unwrap_err();
    assert_eq!(error, crate::GpuError::TooBig { what: "scene vertices", bytes: limit + 1, limit });
    assert!(
        error.to_string().contains("scene vertices")
            && error.to_string().contains(&limit.to_string())
    );
}

/// `encode` of the shaders, run on the GPU over 0 to 1, is the sRGB curve within one step of 255.
#[test]
fn encode_is_the_srgb_curve() {
    const COUNT: u32 = 1024;
    let text = format!(
        "{}\n{}\n@group(0) @binding(1) var<storage, read_write> out: array<f32>;\n\
         @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {{\n\
         out[id.x] = encode(vec3<f32>(f32(id.x) / {}.0)).y + 0.0 * frame.ground;\n}}",
        include_str!("../../shaders/common/frame.wgsl"),
        include_str!("../../shaders/common/light.wgsl"),
        COUNT - 1
    );
    let gpu = crate::Gpu::headless().unwrap();
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("encode test"),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("encode test"),
        layout: None,
        module: &module,
        entry_point: Some("main"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    use wgpu::BufferUsages as U;
    let frame = gpu.buffer("frame", size_of::<FrameUniform>() as u64, U::UNIFORM).unwrap();
    let out = gpu.buffer("out", u64::from(COUNT) * 4, U::STORAGE | U::COPY_SRC).unwrap();
    let back = gpu.buffer("back", u64::from(COUNT) * 4, U::MAP_READ | U::COPY_DST).unwrap();
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("encode test"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: frame.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: out.as_entire_binding() },
        ],
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(COUNT / 64, 1, 1);
    drop(pass);
    encoder.copy_buffer_to_buffer(&out, 0, &back, 0, u64::from(COUNT) * 4);
    gpu.queue.submit([encoder.finish()]);
    back.map_async(wgpu::MapMode::Read, .., Result::unwrap);
    gpu.wait();
    let bytes = back.get_mapped_range(..).unwrap();
    for (i, encoded) in bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned::<f32>).enumerate() {
        let c = i as f32 / (COUNT - 1) as f32;
        let srgb = if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        assert!((encoded - srgb).abs() < 1.0 / 255.0, "{c}: {encoded} instead of {srgb}");
    }
}

/// The ground lies at the project's zero where the scene reaches through it, else at its foot.
#[test]
fn ground_is_zero_or_the_foot() {
    use crate::frame::ground_height;
    use glam::Vec3;
    use topout_scene::Aabb;
    let bounds = |from: f32, to: f32| Aabb { min: Vec3::splat(from), max: Vec3::splat(to) };
    assert_eq!(ground_height(&bounds(-3.0, 20.0), 0.0), 0.0);
    assert_eq!(ground_height(&bounds(-3.0, 20.0), -5.0), 5.0);
    assert_eq!(ground_height(&bounds(2.0, 20.0), 0.0), 2.0);
    assert_eq!(ground_height(&bounds(-9.0, -1.0), 0.0), -9.0);
    assert_eq!(ground_height(&Aabb::EMPTY, 7.0), 0.0);
}

/// Every point of a box that is inside the frame lies in the rectangle that is finished, from far
/// away, close up, from within, and with parallel rays; from far away the rectangle is small.
#[test]
fn finished_rectangle_covers_the_box() {
    use crate::frame::covered_rectangle;
    use glam::{UVec2, Vec3};
    use topout_scene::{Aabb, Projection, View};
    let bounds = Aabb { min: Vec3::new(-3.0, -1.0, -2.0), max: Vec3::new(3.0, 9.0, 4.0) };
    let size = UVec2::new(320, 200);
    let mut views: Vec<View> = [(0.2, 10.0), (1.0, 20.0), (1.0, -70.0), (6.0, 45.0)]
        .map(|(factor, elevation)| View::fit(&bounds, 33.0, elevation, factor, size))
        .to_vec();
    let mut parallel = views[1];
    parallel.projection = Projection::Orthographic { height: 40.0 };
    views.push(parallel);
    let mut inside = 0;
    for view in &views {
        let frame = FrameUniform::new(view, &bounds, glam::DVec3::ZERO, 0.0);
        let [x, y, w, h] = covered_rectangle(&frame, &bounds, 0.0).unwrap();
        for i in 0..1000 {
            let share = Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32) / 9.0;
            let clip = frame.clip_from_world * (bounds.min + bounds.size() * share).extend(1.0);
            let p = glam::Vec2::new(clip.x, -clip.y) / clip.w;
            if clip.w <= 0.0 || p.abs().max_element() >= 1.0 {
                continue;
            }
            let at = (p * 0.5 + 0.5) * size.as_vec2();
            inside += 1;
            assert!(at.x >= x as f32 && at.x <= (x + w) as f32, "{at} {x} {w} {view:?}");
            assert!(at.y >= y as f32 && at.y <= (y + h) as f32, "{at} {y} {h} {view:?}");
        }
    }
    assert!(inside > 3000, "{inside}");
    let far = FrameUniform::new(&views[3], &bounds, glam::DVec3::ZERO, 0.0);
    let [_, _, w, h] = covered_rectangle(&far, &bounds, 0.0).unwrap();
    assert!(w < 90 && h < 70, "{w} {h}");
    assert_eq!(covered_rectangle(&far, &Aabb::EMPTY, 0.0), None);
}
