//! Triangles to measure with: those of elements as the model says, and those that are drawn.

use super::tree::Item;
use crate::hdlod::{Hdlod, Span};
use crate::{ElementId, Layer, Scene};
use glam::Vec3;

/// Appends the triangles of an element in local space. The tag is its behaviour, the owner itself.
pub(super) fn element(scene: &Scene, id: ElementId, out: &mut Vec<Item>) {
    let model = &scene.model;
    let tag = scene.element_behaviour[id.index()].0;
    for instance in model.instances_of(&model.elements[id.index()]) {
        let mesh = &model.meshes[instance.mesh.index()];
        for (i, corners) in mesh.triangles().enumerate() {
            let corners = corners.map(|v| {
                let position = Vec3::from(mesh.vertices[v as usize].position);
                instance.world_from_mesh.transform_point3(position)
            });
            out.push(Item { corners, owner: id.0, tag, glass: i * 3 >= mesh.opaque as usize });
        }
    }
}

/// Appends the triangles of what is drawn of clusters, tag 0.
pub(super) fn span(hdlod: &Hdlod, span: &Span, owner: u32, out: &mut Vec<Item>) {
    let from = span.first_index as usize;
    for corners in hdlod.indices.triangles(from..from + span.index_count as usize) {
        let corners =
            corners.map(|i| Vec3::from(hdlod.vertices[(span.base_vertex + i) as usize].position));
        out.push(Item { corners, owner, tag: 0, glass: span.layer == Layer::Transparent });
    }
}
