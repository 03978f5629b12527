//! Elements in the colours of what they are, where they are, or by whom they are done.

use crate::link::names_a_layer;
use crate::storeys::middle_foot;
use crate::{ElementId, Looks, Scene};
use std::collections::HashMap;
use topout_schedule::Look;

/// What elements are told apart by.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Category {
    /// Their storeys, from the lowest to the highest.
    Storey,
    /// Their types, the most frequent first.
    Type,
    /// Their layers, as a property of the model's file names them, the most frequent first.
    Layer,
}

/// A line of a legend.
#[derive(Clone, PartialEq, Debug)]
pub struct LegendRow {
    /// What the colour stands for.
    pub name: String,
    /// sRGB.
    pub color: [u8; 3],
    /// Elements that have it.
    pub elements: usize,
}

/// For types: colours that people of any colour vision tell apart (Okabe and Ito, 2008, and lighter ones
/// of the same hues).
const TYPES: [[u8; 3]; 11] = [
    [0xE6, 0x9F, 0x00],
    [0x56, 0xB4, 0xE9],
    [0x00, 0x9E, 0x73],
    [0xF0, 0xE4, 0x42],
    [0x00, 0x72, 0xB2],
    [0xD5, 0x5E, 0x00],
    [0xCC, 0x79, 0xA7],
    [0xB3, 0x7B, 0x3E],
    [0x9A, 0xD0, 0xC2],
    [0x7A, 0x6F, 0xB0],
    [0xF5, 0xC4, 0xB0],
];
/// Whatever has no colour of its own.
const OTHER: [u8; 3] = [0x9A, 0x9A, 0x9A];

/// Points of a scale whose lightness rises evenly, for whatever has an order (the ends and quarters of
/// cividis; Nuñez, Anderton and Renslow, 2018).
const ORDER: [[u8; 3]; 5] = [
    [0x00, 0x22, 0x4E],
    [0x43, 0x4E, 0x6C],
    [0x7D, 0x7C, 0x78],
    [0xBC, 0xAF, 0x6F],
    [0xFE, 0xE8, 0x38],
];

impl Category {
    /// The category's name of an element; empty where it has none.
    pub fn of(self, scene: &Scene, id: ElementId) -> &str {
        let element = &scene.model.elements[id.index()];
        match self {
            Self::Storey => &element.storey,
            Self::Type => &element.kind,
            Self::Layer => {
                let layer = scene.model.properties(id).find(|(name, _)| names_a_layer(name));
                layer.map_or("", |(_, layer)| layer)
            }
        }
    }

    /// The elements of each name that occurs, in the order of the legend.
    pub fn groups(self, scene: &Scene) -> Vec<(&str, Vec<ElementId>)> {
        let mut places: HashMap<&str, usize> = HashMap::new();
        let mut groups: Vec<(&str, Vec<ElementId>)> = Vec::new();
        for id in (0..scene.model.elements.len() as u32).map(ElementId) {
            let name = self.of(scene, id);
            let place = *places.entry(name).or_insert_with(|| {
                groups.push((name, Vec::new()));
                groups.len() - 1
            });
            groups[place].1.push(id);
        }
        match self {
            Self::Storey => groups.sort_by_cached_key(|(name, elements)| {
                let foot = middle_foot(&scene.model, elements);
                // Millimetres: whole numbers have an order.
                let foot = foot.map_or(i64::MAX, |foot| (foot * 1000.0) as i64);
                (name.is_empty(), foot, *name)
            }),
            Self::Type | Self::Layer => groups.sort_by(|(a, of_a), (b, of_b)| {
                let key = |name: &str, count: usize| (name.is_empty(), std::cmp::Reverse(count));
                key(a, of_a.len()).cmp(&key(b, of_b.len())).then(a.cmp(b))
            }),
        }
        groups
    }
}

impl Looks {
    /// Each element in the colour of its category, and what the colours stand for. Types and layers beyond the
    /// eleven most frequent, and elements without a name of the category, are grey.
    pub fn of_category(scene: &Scene, category: Category) -> (Self, Vec<LegendRow>) {
        let groups = category.groups(scene);
        let named = groups.iter().filter(|(name, _)| !name.is_empty()).count();
        let (mut legend, mut looks) = (Vec::new(), Vec::new());
        let mut other = LegendRow { name: "other".to_owned(), color: OTHER, elements: 0 };
        for (i, (name, elements)) in groups.iter().enumerate() {
            let color = match category {
                _ if name.is_empty() => OTHER,
                Category::Storey => ramp(i as f32 / (named.max(2) - 1) as f32),
                Category::Type | Category::Layer => TYPES.get(i).copied().unwrap_or(OTHER),
            };
            looks.extend(elements.iter().map(|id| (*id, Look::colored(color))));
            match color == OTHER {
                true => other.elements += elements.len(),
                false => legend.push(LegendRow {
                    name: (*name).to_owned(),
                    color,
                    elements: elements.len(),
                }),
            }
        }
        if category == Category::Storey {
            // As they stand above each other.
            legend.reverse();
        }
        legend.extend((other.elements > 0).then_some(other));
        (Self::fixed(looks), legend)
    }
}

/// A colour of [`ORDER`], 0 for the first.
fn ramp(share: f32) -> [u8; 3] {
    let at = share.clamp(0.0, 1.0) * (ORDER.len() - 1) as f32;
    let (low, part) = ((at as usize).min(ORDER.len() - 2), at);
    let part = part - low as f32;
    let mix = |a: u8, b: u8| (f32::from(a) + (f32::from(b) - f32::from(a)) * part).round() as u8;
    std::array::from_fn(|i| mix(ORDER[low][i], ORDER[low + 1][i]))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Aabb, Element, Model, link};
    use glam::Vec3;
    use topout_schedule::{Schedule, Time};

    fn scene(elements: &[(&str, &str, f32)]) -> Scene {
        let element = |&(storey, kind, foot): &(&str, &str, f32)| {
            let min = Vec3::new(0.0, foot, 0.0);
            let bounds = Aabb { min, max: min + Vec3::ONE };
            Element {
                storey: storey.to_owned(),
                kind: kind.to_owned(),
                bounds,
                ..Element::default()
            }
        };
        let elements = elements.iter().map(element).collect();
        link::link(Model { elements, ..Model::default() }, Schedule::default())
    }

    #[test]
    fn storeys_go_from_the_top_to_the_foot_and_types_by_how_many_there_are() {
        let scene = scene(&[
            ("Roof", "slab", 30.0),
            ("Ground", "wall", 0.0),
            ("First", "wall", 3.0),
            ("First", "door", 3.5),
            ("", "wall", 99.0),
        ]);
        let (looks, legend) = Looks::of_category(&scene, Category::Storey);
        let names: Vec<_> = legend.iter().map(|row| (row.name.as_str(), row.elements)).collect();
        assert_eq!(names, [("Roof", 1), ("First", 2), ("Ground", 1), ("other", 1)]);
        let mut seen = Vec::new();
        looks.at(Time::MIN, |e, look| seen.push((e.0, looks.palette()[look.index()].color)));
        seen.sort_unstable();
        let color = |name: &str| Some(legend.iter().find(|row| row.name == name).unwrap().color);
        let expected = ["Roof", "Ground", "First", "First", "other"].map(color);
        assert_eq!(seen, (0..5).zip(expected).collect::<Vec<_>>());

        let (_, legend) = Looks::of_category(&scene, Category::Type);
        let names: Vec<_> = legend.iter().map(|row| (row.name.as_str(), row.elements)).collect();
        assert_eq!(names, [("wall", 3), ("door", 1), ("slab", 1)]);
    }

    #[test]
    fn rare_types_share_a_colour_and_one_storey_has_one() {
        let names: Vec<String> = (0..20).map(|i| format!("type {i:02}")).collect();
        let all: Vec<_> = names.iter().map(|name| ("Ground", name.as_str(), 0.0)).collect();
        let scene = scene(&all);
        let (_, legend) = Looks::of_category(&scene, Category::Type);
        assert_eq!((legend.len(), legend.last().unwrap().elements), (12, 9));
        let (_, legend) = Looks::of_category(&scene, Category::Storey);
        assert_eq!((legend.len(), legend[0].elements), (1, 20));
    }
}
