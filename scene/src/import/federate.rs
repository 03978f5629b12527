//! Several models become one.

use super::mesh::LARGE;
use super::palette::reduce;
use super::placing::instance_bounds;
use crate::properties;
use crate::{Aabb, Element, GroupId, Instance, MeshId, Model};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;
use topout_schedule::{Diagnostics, Severity};

/// Puts models side by side in one space. Elements of equal names stay apart; a diagnostic says so.
pub fn federate(mut models: Vec<Model>) -> Model {
    if models.len() <= 1 {
        return models.pop().unwrap_or_default();
    }
    let names: Vec<String> = models.iter().map(|m| m.name.clone()).collect();
    let mut diagnostics = Diagnostics::default();
    for model in &mut models {
        diagnostics.append(std::mem::take(&mut model.diagnostics));
    }
    note_equal_names(&models, &mut diagnostics);
    let origin = common_origin(&models, &mut diagnostics);
    let (properties, full) = properties::joined(&models);
    if full.is_some() {
        properties::note_full(&names.join(" + "), &mut diagnostics);
    }
    let mut all = Model { name: names.join(" + "), origin, properties, ..Model::default() };
    let mut materials = Vec::new();
    // First material of each mesh's model.
    let mut material_bases: Vec<usize> = Vec::new();
    for model in models {
        append(&mut all, model, materials.len(), &mut materials, &mut material_bases);
    }
    let (materials, places) = reduce(materials, &all.name, &mut diagnostics);
    all.meshes.par_iter_mut().zip(&material_bases).for_each(|(mesh, base)| {
        for vertex in &mut mesh.vertices {
            vertex.material = places[base + usize::from(vertex.material)];
        }
    });
    all.materials = materials;
    all.diagnostics = diagnostics;
    all
}

fn append(
    all: &mut Model,
    model: Model,
    material_base: usize,
    materials: &mut Vec<crate::Material>,
    material_bases: &mut Vec<usize>,
) {
    let shift = model.origin - all.origin;
    let first_mesh = all.meshes.len() as u32;
    let first_instance = all.instances.len() as u32;
    let first_group = all.groups.len() as u32;
    let moved = |group: Option<GroupId>| group.map(|g| GroupId(g.0 + first_group));
    materials.extend(model.materials);
    material_bases.extend(std::iter::repeat_n(material_base, model.meshes.len()));
    all.instances.extend(model.instances.iter().map(|i| {
        let mut world_from_mesh = i.world_from_mesh;
        let place = world_from_mesh.translation.as_dvec3() + shift;
        world_from_mesh.translation = place.as_vec3().into();
        Instance { mesh: MeshId(i.mesh.0 + first_mesh), world_from_mesh }
    }));
    all.meshes.extend(model.meshes);
    for group in model.groups {
        all.groups.push(crate::Group { parent: moved(group.parent), ..group });
    }
    for element in model.elements {
        let range = element.instances;
        let instances = range.start + first_instance..range.end + first_instance;
        let bounds = if shift == DVec3::ZERO {
            element.bounds
        } else {
            all.instances[instances.start as usize..instances.end as usize]
                .iter()
                .fold(Aabb::EMPTY, |b, i| b.union(&instance_bounds(&all.meshes[i.mesh.index()], i)))
        };
        let group = moved(element.group);
        all.elements.push(Element { instances, bounds, group, ..element });
    }
}

/// The origin of the model with the most elements; the others are brought to it.
fn common_origin(models: &[Model], diagnostics: &mut Diagnostics) -> DVec3 {
    let largest = models.iter().max_by_key(|m| m.elements.len()).expect("there are models");
    let center = |m: &Model| {
        let bounds = m.bounds();
        if bounds.is_empty() { m.origin } else { m.origin + bounds.center().as_dvec3() }
    };
    for model in models {
        let distance = center(model).distance(center(largest));
        if distance > LARGE {
            diagnostics.add(Severity::Warning, "models-far-apart", model.name.as_str(), || {
                format!(
                    "{} lies {distance:.0} m from {}: do they share a coordinate system?",
                    model.name, largest.name
                )
            });
        }
    }
    largest.origin
}

fn note_equal_names(models: &[Model], diagnostics: &mut Diagnostics) {
    let mut owners: HashMap<&str, usize> = HashMap::new();
    for (m, model) in models.iter().enumerate() {
        for element in model.elements.iter().filter(|e| !e.name.is_empty()) {
            let owner = *owners.entry(&element.name).or_insert(m);
            if owner != m {
                diagnostics.add(Severity::Info, "equal-names", element.name.as_str(), || {
                    format!(
                        "element {:?} occurs in {} and in {}; both are kept and linked alike",
                        element.name, models[owner].name, model.name
                    )
                });
            }
        }
    }
}
