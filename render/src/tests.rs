//! Shaders are valid, and what Rust and WGSL share is laid out alike.

#![allow(clippy::unwrap_used)]

use crate::frame::FrameUniform;
use crate::passes::SHADERS;
use crate::pool::{InstanceRow, MaterialRow};
use std::mem::offset_of;
use topout_scene::{Vertex, decode_normal, encode_normal};

fn parse(name: &str, text: &str) -> naga::Module {
    naga::front::wgsl::parse_str(text)
        .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(text)))
}

/// The WGSL struct of that name as (member, offset) and its size.
fn layout(module: &naga::Module, name: &str) -> (Vec<(String, u32)>, u32) {
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
    for (name, text) in SHADERS {
        let module = parse(name, text);
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name}: {e:?}"));
        assert!(!module.entry_points.is_empty(), "{name} has an entry point");
    }
}

#[test]
fn frame_is_laid_out_alike_in_every_shader() {
    let rust = rust_layout!(FrameUniform {
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
    });
    for (name, text) in SHADERS {
        assert_eq!(layout(&parse(name, text), "Frame"), rust, "{name}");
    }
}

#[test]
fn material_is_laid_out_alike() {
    let rust = rust_layout!(MaterialRow { color, roughness, metallic, padding });
    for (name, text) in &SHADERS[..2] {
        assert_eq!(layout(&parse(name, text), "Material"), rust, "{name}");
    }
}

/// The vertex shader's inputs are the pool's attributes: position, then one word with the normal in
/// the lower and the material in the upper half, then the three rows of the instance.
#[test]
fn vertex_is_packed_as_the_shader_reads_it() {
    assert_eq!((offset_of!(Vertex, position), offset_of!(Vertex, normal)), (0, 12));
    assert_eq!((offset_of!(Vertex, material), size_of::<Vertex>()), (14, 16));
    assert_eq!(size_of::<InstanceRow>(), 48);
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
