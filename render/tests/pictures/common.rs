//! Small scenes made in code, and a renderer on the real adapter.

use glam::{Affine3A, UVec2, Vec3};
use std::sync::Arc;
use topout_render::{DrawMode, FrameInput, Gpu, Picture, Renderer};
use topout_scene::{
    Aabb, BehaviourId, Clip, Element, Instance, Material, Mesh, MeshId, Model, Projection, Scene,
    Vertex, View, encode_normal,
};
use topout_schedule::{Behaviour, Time};

pub const RED: u16 = 0;
pub const GREEN: u16 = 1;
pub const BLUE: u16 = 2;
pub const GLASS: u16 = 3;
pub const AMBER: u16 = 4;

fn material(name: &str, color: [f32; 4]) -> Material {
    Material {
        name: name.to_owned(),
        color,
        roughness: 0.8,
        metallic: 0.0,
        transparent: color[3] < 1.0,
    }
}

/// Red, green, blue and two sorts of glass, as the constants say.
pub fn materials() -> Vec<Material> {
    vec![
        material("red", [0.8, 0.05, 0.05, 1.0]),
        material("green", [0.05, 0.7, 0.05, 1.0]),
        material("blue", [0.05, 0.05, 0.8, 1.0]),
        material("glass", [0.6, 0.8, 0.9, 0.3]),
        material("amber", [0.9, 0.5, 0.1, 0.6]),
    ]
}

/// A cube from -1 to 1 on every axis, 24 vertices with flat normals.
pub fn cube(material: u16) -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for sign in [-1.0f32, 1.0] {
            let mut n = Vec3::ZERO;
            n[axis] = sign;
            let (u, v) = (Vec3::from_array([n.y, n.z, n.x]), n.cross(Vec3::new(n.y, n.z, n.x)));
            let base = mesh.vertices.len() as u32;
            for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                mesh.vertices.push(Vertex {
                    position: (n + u * a + v * b).to_array(),
                    normal: encode_normal(n),
                    material,
                });
            }
            mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|i| base + i));
        }
    }
    mesh.opaque = if material >= GLASS { 0 } else { mesh.indices.len() as u32 };
    mesh.bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
    mesh
}

/// One part of a test scene: a mesh at a place, present as told.
pub struct Part {
    pub mesh: Mesh,
    pub place: Affine3A,
    pub behaviour: Behaviour,
}

/// A part that is always there.
pub fn part(mesh: Mesh, place: Affine3A) -> Part {
    Part { mesh, place, behaviour: Behaviour::always() }
}

/// Moves.
pub fn at(x: f32, y: f32, z: f32) -> Affine3A {
    Affine3A::from_translation(Vec3::new(x, y, z))
}

/// One element per part.
pub fn scene(parts: Vec<Part>) -> Arc<Scene> {
    let mut model = Model { materials: materials(), ..Default::default() };
    let mut scene = Scene::default();
    for (i, part) in (0u32..).zip(parts) {
        let bounds = part.mesh.bounds.transformed(&part.place);
        model.meshes.push(part.mesh);
        model.instances.push(Instance { mesh: MeshId(i), world_from_mesh: part.place });
        model.elements.push(Element { instances: i..i + 1, bounds, ..Default::default() });
        scene.element_behaviour.push(BehaviourId(i));
        scene.behaviours.push(part.behaviour);
    }
    scene.model = Arc::new(model);
    Arc::new(scene)
}

/// From `eye` towards `target`.
pub fn look(eye: Vec3, target: Vec3, size: (u32, u32)) -> View {
    View {
        eye,
        target,
        up: Vec3::Y,
        projection: Projection::Perspective { fov_y: View::FOV_Y },
        size: UVec2::new(size.0, size.1),
        tolerance_px: 1.0,
        clip: Clip::NONE,
    }
}

/// A renderer on the adapter of this machine; a test without one fails.
pub fn renderer() -> Renderer {
    Renderer::new(&Gpu::headless().unwrap())
}

/// One frame at time 0, read back.
pub fn shot(renderer: &mut Renderer, view: View, mode: DrawMode) -> Picture {
    shot_at(renderer, view, mode, 0)
}

/// One frame, read back.
pub fn shot_at(renderer: &mut Renderer, view: View, mode: DrawMode, seconds: i64) -> Picture {
    renderer.render(&FrameInput { view, time: Time::from_seconds(seconds), mode });
    renderer.read_back().unwrap()
}

/// Number of pixels that show an element.
pub fn covered(picture: &Picture) -> usize {
    picture.rgba.chunks_exact(4).filter(|p| p[3] == 255).count()
}

/// Whether the pixel shows an element and this channel is clearly the strongest.
pub fn shows(picture: &Picture, x: u32, y: u32, channel: usize) -> bool {
    let p = picture.pixel(x, y);
    p[3] == 255 && (0..3).all(|c| c == channel || p[channel] > p[c].saturating_add(30))
}

/// A renderer on a device without any optional feature, as the poorest adapter would give.
pub fn plain_renderer() -> Renderer {
    let instance = wgpu::Instance::new(topout_render::instance_descriptor());
    let options = wgpu::RequestAdapterOptions::default();
    let adapter = pollster::block_on(instance.request_adapter(&options)).unwrap();
    let descriptor = wgpu::DeviceDescriptor {
        required_features: wgpu::Features::empty(),
        ..topout_render::device_descriptor(&adapter)
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
    Renderer::new(&Gpu::from_parts(device, queue, adapter.get_info()))
}
