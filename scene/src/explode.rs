//! Storeys drawn apart.

use crate::{ElementId, Model, Scene, storeys};
use glam::Vec3A;
use std::sync::Arc;

impl Model {
    /// How many metres each element goes up (or down) where storeys stand `gap` metres farther apart. The storey at
    /// the project's zero, or the lowest one above it, stays. Elements without a storey go with the one that
    /// they stand on. Empty where the model names fewer than two storeys.
    pub fn storey_offsets(&self, gap: f32) -> Vec<f32> {
        let storeys = storeys(self);
        if storeys.len() < 2 {
            return Vec::new();
        }
        let zero = -self.origin.y as f32 - 0.5;
        let ground = storeys.iter().position(|s| s.foot >= zero).unwrap_or(storeys.len() - 1);
        let offset = |rank: usize| (rank as f32 - ground as f32) * gap;
        // A foot a little below its storey is still its own.
        let stands_on = |foot: f32| storeys.partition_point(|s| s.foot <= foot + 0.3).max(1) - 1;
        let mut offsets: Vec<f32> = self
            .elements
            .iter()
            .map(|element| match element.bounds.is_empty() {
                true => 0.0,
                false => offset(stands_on(element.bounds.min.y)),
            })
            .collect();
        for (rank, storey) in storeys.iter().enumerate() {
            for ElementId(i) in &storey.elements {
                offsets[*i as usize] = offset(rank);
            }
        }
        offsets
    }

    /// The same model with each element moved up by so many metres; elements beyond the list stay.
    pub fn lifted(&self, offsets: &[f32]) -> Model {
        let mut model = self.clone();
        for (element, &offset) in model.elements.iter_mut().zip(offsets) {
            for instance in &mut model.instances
                [element.instances.start as usize..element.instances.end as usize]
            {
                instance.world_from_mesh.translation += Vec3A::Y * offset;
            }
            if !element.bounds.is_empty() {
                element.bounds.min.y += offset;
                element.bounds.max.y += offset;
            }
        }
        model
    }
}

impl Scene {
    /// The same scene with a model that differs in places alone.
    ///
    /// # Panics
    /// If that has another number of elements.
    pub fn with_model(&self, model: Arc<Model>) -> Scene {
        assert_eq!(model.elements.len(), self.model.elements.len(), "the same elements");
        Scene { model, ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Aabb, Element, Instance, MeshId};
    use glam::{Affine3A, Vec3};

    #[test]
    fn storeys_move_apart_and_the_ground_stays() {
        let element = |(i, &(storey, foot)): (usize, &(&str, f32))| Element {
            storey: storey.to_owned(),
            bounds: Aabb { min: Vec3::Y * foot, max: Vec3::Y * (foot + 2.0) },
            instances: i as u32..i as u32 + 1,
            ..Element::default()
        };
        let all = [
            ("cellar", -3.0),
            ("0", 0.0),
            ("1", 3.0),
            ("", 3.1),
            ("1", -1.0),
            ("", -9.0),
            ("", 0.1),
        ];
        let mut model = Model {
            elements: all.iter().enumerate().map(element).collect(),
            instances: vec![
                Instance { mesh: MeshId(0), world_from_mesh: Affine3A::IDENTITY };
                all.len()
            ],
            ..Model::default()
        };
        // Half of storey 1 reaches down; its other half tells where it is.
        model.elements.push(Element { instances: 7..7, ..model.elements[2].clone() });
        let offsets = model.storey_offsets(5.0);
        assert_eq!(offsets, [-5.0, 0.0, 5.0, 5.0, 5.0, -5.0, 0.0, 5.0]);
        let lifted = model.lifted(&offsets);
        for (i, offset) in offsets.iter().enumerate().take(7) {
            assert_eq!(lifted.instances[i].world_from_mesh.translation.y, *offset);
            let (before, after) = (model.elements[i].bounds, lifted.elements[i].bounds);
            assert_eq!((after.min.y, after.max.y), (before.min.y + offset, before.max.y + offset));
        }
        model.elements.truncate(2);
        model.elements.remove(0);
        assert!(model.storey_offsets(5.0).is_empty());
    }
}
