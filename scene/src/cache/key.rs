//! What a tree depends on, as one number.

use crate::hdlod::Settings;
use crate::{Aabb, Material, Mesh, Scene};
use bytemuck::cast_slice;
use rayon::prelude::*;
use std::fmt;

/// What a tree depends on besides the program, hashed by BLAKE3: the first half of the bytes says
/// geometry, places, colours and the build's settings, the other half all of that and behaviours and
/// the period. Names and activities do not matter.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Key(pub(super) [u8; 32]);

impl Key {
    /// Of the tree that [`crate::hdlod::build`] makes of these. Every mesh is hashed once, however
    /// many instances it has.
    pub fn of(scene: &Scene, settings: &Settings) -> Self {
        let model = &scene.model;
        let mut hash = Parts(blake3::Hasher::new());
        // Settings in their serialised form: a new field changes the key by itself.
        hash.bytes(&postcard::to_stdvec(settings).expect("plain values can be serialised"));
        let meshes: Vec<[u8; 32]> = model.meshes.par_iter().with_min_len(64).map(mesh).collect();
        hash.bytes(meshes.as_flattened());
        hash.bytes(&model.materials.iter().flat_map(material).collect::<Vec<u8>>());
        let mut places = Vec::with_capacity(model.instances.len() * 52);
        for instance in &model.instances {
            places.extend_from_slice(cast_slice(&instance.world_from_mesh.to_cols_array()));
            places.extend_from_slice(&instance.mesh.0.to_le_bytes());
        }
        hash.bytes(&places);
        let mut elements = Vec::with_capacity(model.elements.len() * 32);
        for element in &model.elements {
            let range = [element.instances.start, element.instances.end];
            elements.extend_from_slice(cast_slice(&range));
            elements.extend_from_slice(&bounds(&element.bounds));
        }
        hash.bytes(&elements);
        let model: [u8; 32] = hash.0.finalize().into();

        hash.numbers(
            &[scene.schedule.period.start, scene.schedule.period.end].map(|t| t.seconds()),
        );
        hash.bytes(cast_slice(&scene.element_behaviour.iter().map(|b| b.0).collect::<Vec<u32>>()));
        for behaviour in &scene.behaviours {
            let toggles = behaviour.toggles().iter().map(|t| t.seconds());
            let initial = std::iter::once(i64::from(behaviour.initial()));
            hash.numbers(&initial.chain(toggles).collect::<Vec<i64>>());
        }
        let mut key: [u8; 32] = hash.0.finalize().into();
        key[..MODEL_BYTES].copy_from_slice(&model[..MODEL_BYTES]);
        Self(key)
    }
}

/// The bytes of a key that say model and settings; 128 bits do not collide by chance.
pub(super) const MODEL_BYTES: usize = 16;

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// Parts with their lengths, so that no two lists of parts read the same.
struct Parts(blake3::Hasher);

impl Parts {
    fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(&(bytes.len() as u64).to_le_bytes());
        self.0.update_rayon(bytes);
    }

    fn numbers(&mut self, numbers: &[i64]) {
        self.bytes(cast_slice(numbers));
    }
}

fn mesh(mesh: &Mesh) -> [u8; 32] {
    let mut hash = blake3::Hasher::new();
    hash.update(&(mesh.vertices.len() as u64).to_le_bytes());
    hash.update(cast_slice(&mesh.vertices));
    hash.update(cast_slice(&mesh.indices));
    hash.update(&mesh.opaque.to_le_bytes());
    hash.update(&bounds(&mesh.bounds));
    hash.finalize().into()
}

/// What of a surface decides what may stand for what.
fn material(material: &Material) -> impl Iterator<Item = u8> {
    let numbers = material.color.into_iter().flat_map(f32::to_le_bytes);
    numbers.chain(std::iter::once(u8::from(material.transparent)))
}

fn bounds(bounds: &Aabb) -> [u8; 24] {
    bytemuck::cast([bounds.min.to_array(), bounds.max.to_array()])
}
