//! What is drawn in a frame, as plain data: pure functions of scene, view and time.

use crate::pool::MeshRange;
use topout_scene::hdlod::Span;
use topout_scene::{Containment, ElementId, Layer, Model, Scene, View};
use topout_schedule::Time;
use wgpu::util::DrawIndexedIndirectArgs as Command;

/// Draw commands by layer.
#[derive(Debug, Default)]
pub(crate) struct Layers {
    pub opaque: Vec<Command>,
    pub transparent: Vec<Command>,
}

impl Layers {
    pub fn clear(&mut self) {
        self.opaque.clear();
        self.transparent.clear();
    }

    pub fn len(&self) -> usize {
        self.opaque.len() + self.transparent.len()
    }

    /// Triangles of all commands.
    pub fn triangles(&self) -> u64 {
        self.opaque.iter().chain(&self.transparent).map(|c| u64::from(c.index_count) / 3).sum()
    }
}

/// All commands of a frame; kept from frame to frame for its memory.
#[derive(Debug, Default)]
pub(crate) struct DrawList {
    /// Exact elements, out of the scene's geometry.
    pub elements: Layers,
    /// Parts of clusters, out of the clusters' geometry.
    pub clusters: Layers,
    /// Which behaviours are present; scratch.
    present: Vec<bool>,
    /// Elements drawn exactly.
    pub visible: Vec<ElementId>,
}

impl DrawList {
    pub fn clear(&mut self) {
        self.elements.clear();
        self.clusters.clear();
        self.visible.clear();
    }

    /// Finds the elements that are present at `time` and not outside the frame. Every distinct
    /// behaviour is asked once.
    pub fn gather_visible(&mut self, scene: &Scene, view: &View, time: Time, culling: bool) {
        self.present.clear();
        self.present.extend(scene.behaviours.iter().map(|b| b.at(time)));
        let frustum = view.frustum();
        let elements = scene.model.elements.iter().zip(&scene.element_behaviour);
        for (id, (element, behaviour)) in (0u32..).zip(elements) {
            let present = self.present.get(behaviour.index()).copied().unwrap_or(false);
            if !present || (culling && frustum.test(&element.bounds) == Containment::Outside) {
                continue;
            }
            self.visible.push(ElementId(id));
        }
    }

    /// Appends the commands of the visible elements, one per instance and layer.
    pub fn push_elements(&mut self, model: &Model, meshes: &[MeshRange]) {
        for &id in &self.visible {
            let range = model.elements[id.index()].instances.clone();
            for instance in range {
                let mesh = meshes[model.instances[instance as usize].mesh.index()];
                let command = |first_index, index_count| Command {
                    index_count,
                    instance_count: 1,
                    first_index,
                    base_vertex: mesh.base_vertex as i32,
                    first_instance: instance,
                };
                if mesh.opaque > 0 {
                    self.elements.opaque.push(command(mesh.first_index, mesh.opaque));
                }
                if mesh.transparent > 0 {
                    let first = mesh.first_index + mesh.opaque;
                    self.elements.transparent.push(command(first, mesh.transparent));
                }
            }
        }
    }

    /// Appends the commands of parts of clusters; `identity` is the instance that moves nothing.
    pub fn push_spans(&mut self, spans: &[Span], identity: u32) {
        for span in spans {
            let layer = match span.layer {
                Layer::Opaque => &mut self.clusters.opaque,
                Layer::Transparent => &mut self.clusters.transparent,
            };
            layer.push(Command {
                index_count: span.index_count,
                instance_count: 1,
                first_index: span.first_index,
                base_vertex: span.base_vertex as i32,
                first_instance: identity,
            });
        }
    }
}
