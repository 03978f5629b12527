//! Storeys in the order of their height.

use crate::{ElementId, Model};
use std::collections::HashMap;

/// Elements that name the same storey.
#[derive(Clone, PartialEq, Debug)]
pub struct Storey {
    /// As the model names it.
    pub name: String,
    /// Its height, metres in local space: that of the feet of half its elements.
    pub foot: f32,
    /// In the order of the model.
    pub elements: Vec<ElementId>,
}

/// The model's storeys that have geometry, from the lowest to the highest.
pub fn storeys(model: &Model) -> Vec<Storey> {
    let mut by_name: HashMap<&str, Vec<ElementId>> = HashMap::new();
    for (i, element) in (0u32..).zip(&model.elements) {
        if !element.storey.is_empty() {
            by_name.entry(&element.storey).or_default().push(ElementId(i));
        }
    }
    let storey = |(name, elements): (&str, Vec<ElementId>)| {
        let foot = middle_foot(model, &elements)?;
        Some(Storey { name: name.to_owned(), foot, elements })
    };
    let mut storeys: Vec<Storey> = by_name.into_iter().filter_map(storey).collect();
    storeys.sort_by(|a, b| a.foot.total_cmp(&b.foot).then_with(|| a.name.cmp(&b.name)));
    storeys
}

/// The height that half of the elements' feet are below, metres; `None` where none has geometry.
pub(crate) fn middle_foot(model: &Model, elements: &[ElementId]) -> Option<f32> {
    let bounds = elements.iter().map(|id| &model.elements[id.index()].bounds);
    let mut feet: Vec<f32> = bounds.filter(|b| !b.is_empty()).map(|b| b.min.y).collect();
    feet.sort_unstable_by(f32::total_cmp);
    feet.get(feet.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Aabb, Element};
    use glam::Vec3;

    #[test]
    fn storeys_go_from_the_foot_to_the_top() {
        let element = |&(storey, foot): &(&str, f32)| Element {
            storey: storey.to_owned(),
            bounds: Aabb { min: Vec3::Y * foot, max: Vec3::Y * (foot + 2.0) },
            ..Element::default()
        };
        // A column that reaches down to the foundations does not lower its storey.
        let all = [("Roof", 9.0), ("", -3.0), ("1", 3.0), ("1", -2.0), ("1", 3.2), ("0", 0.0)];
        let mut elements: Vec<Element> = all.iter().map(element).collect();
        elements.push(Element { storey: "empty".to_owned(), ..Element::default() });
        let model = Model { elements, ..Model::default() };
        let found = storeys(&model);
        let names: Vec<_> = found.iter().map(|s| (s.name.as_str(), s.foot)).collect();
        assert_eq!(names, [("0", 0.0), ("1", 3.0), ("Roof", 9.0)]);
        assert_eq!(found[1].elements, [2, 3, 4].map(ElementId));
    }
}
