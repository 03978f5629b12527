//! The tree made visible: what is drawn takes its colour from the level that made it.

use super::Hdlod;
use crate::{Layer, Material, Model, Scene};
use glam::Vec3;
use std::sync::Arc;

/// How much of what is behind shows through transparent parts.
const GLASS: f32 = 0.35;

/// The same scene and tree in other colours: clusters from violet (the first level that made any)
/// over blue, green and yellow to red (the root's), elements grey. Transparent parts stay so.
///
/// Only materials differ, so [`super::select`] cuts both trees alike.
pub fn color_by_level(scene: &Scene, tree: &Hdlod) -> (Scene, Hdlod) {
    let levels = || tree.clusters.iter().map(|c| c.level);
    let (first, last) = (levels().min().unwrap_or(0), levels().max().unwrap_or(0));
    // Two of each: solid, then transparent; the first pair is that of elements.
    let mut materials = pair(Vec3::splat(0.3));
    for level in first..=last {
        let share = (level - first) as f32 / (last - first).max(1) as f32;
        materials.extend(pair(rainbow(share)));
    }
    let mut model = Model { materials, ..Model::clone(&scene.model) };
    for mesh in &mut model.meshes {
        let solid = mesh.opaque as usize;
        for (i, &index) in mesh.indices.iter().enumerate() {
            mesh.vertices[index as usize].material = u16::from(i >= solid);
        }
    }
    let mut painted = tree.clone();
    let vertices = Arc::make_mut(&mut painted.vertices);
    for cluster in &tree.clusters {
        let own = 2 * (1 + cluster.level - first) as u16;
        for (layer, _, range) in cluster.runs() {
            for index in tree.indices.range(range) {
                let vertex = (cluster.base_vertex() + index) as usize;
                vertices[vertex].material = own + u16::from(layer == Layer::Transparent);
            }
        }
    }
    (Scene { model: Arc::new(model), ..scene.clone() }, painted)
}

fn pair(color: Vec3) -> Vec<Material> {
    let material = |alpha: f32| Material {
        name: String::new(),
        color: color.extend(alpha).to_array(),
        roughness: 1.0,
        metallic: 0.0,
        transparent: alpha < 1.0,
    };
    vec![material(1.0), material(GLASS)]
}

/// Linear RGB from violet (0) to red (1).
fn rainbow(share: f32) -> Vec3 {
    const STOPS: [Vec3; 7] = [
        Vec3::new(0.22, 0.04, 0.50),
        Vec3::new(0.02, 0.10, 0.65),
        Vec3::new(0.00, 0.40, 0.55),
        Vec3::new(0.03, 0.36, 0.04),
        Vec3::new(0.80, 0.62, 0.02),
        Vec3::new(0.85, 0.20, 0.01),
        Vec3::new(0.50, 0.01, 0.01),
    ];
    let place = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let below = (place as usize).min(STOPS.len() - 2);
    STOPS[below].lerp(STOPS[below + 1], place - below as f32)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{built, scene};
    use super::super::{Temporal, select};
    use super::*;
    use crate::View;
    use glam::UVec2;
    use proptest::prelude::*;
    use topout_schedule::Time;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn only_colours_differ_and_every_level_has_its_own(scene in scene(), time in 0i64..100) {
            let tree = built(&scene, Temporal::Tight);
            let (painted_scene, painted) = color_by_level(&scene, &tree);
            prop_assert_eq!(painted.validate(&painted_scene), Ok(()));
            let view = View::fit(&scene.model.bounds(), 30.0, 20.0, 4.0, UVec2::new(640, 360));
            let time = Time::from_seconds(time);
            prop_assert_eq!(
                select(&scene, &tree, &view, time),
                select(&painted_scene, &painted, &view, time)
            );
            let mut colors = std::collections::BTreeMap::new();
            for cluster in &painted.clusters {
                for (layer, _, range) in cluster.runs() {
                    for index in painted.indices.range(range) {
                        let vertex = painted.vertices[(cluster.base_vertex() + index) as usize];
                        let material = &painted_scene.model.materials[usize::from(vertex.material)];
                        prop_assert_eq!(material.transparent, layer == Layer::Transparent);
                        prop_assert!(vertex.material > 1, "grey is for elements");
                        let known = colors.entry((cluster.level, layer)).or_insert(vertex.material);
                        prop_assert_eq!(*known, vertex.material);
                    }
                }
            }
            let distinct: std::collections::BTreeSet<u16> = colors.values().copied().collect();
            prop_assert_eq!(distinct.len(), colors.len());
        }
    }
}
