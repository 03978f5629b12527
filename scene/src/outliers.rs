//! Elements that cannot be where they are said to be, or as large: they must not decide what is shown.

use crate::{Aabb, Element, ElementId};
use glam::Vec3;
use std::collections::HashMap;

/// So many times the spread of the middle half away from it, an element is far from the rest.
const FAR: f32 = 15.0;
/// An element so many times as large as the median of its kind is suspicious.
const SWOLLEN: f32 = 8.0;
/// Fewer of a kind say nothing of how large it is.
const LEAST_OF_KIND: usize = 8;
/// Of so many elements one at most is an outlier; more of them are a part of the project.
const ONE_OF: usize = 50;
/// What sticks out by less than this share of the rest is no harm.
const STICKS_OUT: f32 = 0.02;

/// Why an element is none of those that decide what is shown.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Outlier {
    /// Far from everything else.
    Far,
    /// Many times as large as others of its kind, and out of the box of everything else.
    Swollen,
}

/// The outliers among some elements, in their order. None where there are too many for accidents.
pub fn outliers(elements: &[Element], among: &[ElementId]) -> Vec<(ElementId, Outlier)> {
    let bounds = |id: &ElementId| elements[id.index()].bounds;
    let solid: Vec<ElementId> = among.iter().copied().filter(|id| !bounds(id).is_empty()).collect();
    let most = (solid.len() / ONE_OF).max(1);
    if solid.len() < 4 {
        return Vec::new();
    }
    let far = far(&solid, &bounds);
    if far.len() > most {
        return Vec::new();
    }
    let rest: Vec<ElementId> = solid.into_iter().filter(|id| !far.contains(id)).collect();
    let swollen = swollen(elements, &rest);
    let mut all: Vec<_> = far.into_iter().map(|id| (id, Outlier::Far)).collect();
    if all.len() + swollen.len() <= most {
        all.extend(swollen.into_iter().map(|id| (id, Outlier::Swollen)));
    }
    all.sort_unstable_by_key(|(id, _)| *id);
    all
}

/// Those outside of a fence around the middle half of all.
fn far(all: &[ElementId], bounds: &impl Fn(&ElementId) -> Aabb) -> Vec<ElementId> {
    let quartiles = [0, 1, 2].map(|axis| {
        let mut centers: Vec<f32> = all.iter().map(|id| bounds(id).center()[axis]).collect();
        centers.sort_unstable_by(f32::total_cmp);
        [centers[centers.len() / 4], centers[centers.len() * 3 / 4]]
    });
    let quartiles = [0, 1].map(|end| Vec3::from(quartiles.map(|both| both[end])));
    let mut sizes: Vec<f32> = all.iter().map(|id| bounds(id).diameter()).collect();
    sizes.sort_unstable_by(f32::total_cmp);
    // A row of columns, or a flat site, is as wide as it is long for this.
    let spread = (quartiles[1] - quartiles[0]).max_element().max(sizes[sizes.len() / 2]);
    let [low, high] = [quartiles[0] - FAR * spread, quartiles[1] + FAR * spread];
    let inside = |b: Aabb| b.min.cmpge(low).all() && b.max.cmple(high).all();
    all.iter().copied().filter(|id| !inside(bounds(id))).collect()
}

/// Those that are much larger than their kind and stick out of the rest.
fn swollen(elements: &[Element], all: &[ElementId]) -> Vec<ElementId> {
    let mut kinds: HashMap<&str, Vec<f32>> = HashMap::new();
    for id in all {
        let element = &elements[id.index()];
        kinds.entry(&element.kind).or_default().push(element.bounds.diameter());
    }
    let mut limits: HashMap<&str, f32> = HashMap::new();
    for (kind, mut sizes) in kinds {
        if !kind.is_empty() && sizes.len() >= LEAST_OF_KIND {
            sizes.sort_unstable_by(f32::total_cmp);
            limits.insert(kind, SWOLLEN * sizes[sizes.len() / 2]);
        }
    }
    let large = |id: &ElementId| {
        let element = &elements[id.index()];
        let limit = limits.get(element.kind.as_str());
        limit.is_some_and(|limit| element.bounds.diameter() > *limit)
    };
    let (suspects, rest): (Vec<ElementId>, Vec<ElementId>) = all.iter().partition(|id| large(id));
    let rest = rest.iter().fold(Aabb::EMPTY, |b, id| b.union(&elements[id.index()].bounds));
    if rest.is_empty() {
        return Vec::new();
    }
    let allowed = rest.grown(STICKS_OUT * rest.diameter());
    let sticks_out = |id: &ElementId| {
        let b = elements[id.index()].bounds;
        b.min.cmplt(allowed.min).any() || b.max.cmpgt(allowed.max).any()
    };
    suspects.into_iter().filter(sticks_out).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn element(kind: &str, center: Vec3, size: f32) -> Element {
        let half = Vec3::splat(size / 2.0);
        let bounds = Aabb { min: center - half, max: center + half };
        Element { kind: kind.into(), bounds, ..Element::default() }
    }

    fn found(elements: &[Element]) -> Vec<(u32, Outlier)> {
        let all: Vec<ElementId> = (0..elements.len() as u32).map(ElementId).collect();
        outliers(elements, &all).into_iter().map(|(id, why)| (id.0, why)).collect()
    }

    /// A row of columns.
    fn columns(count: usize) -> Vec<Element> {
        (0..count).map(|i| element("column", Vec3::new(i as f32 * 5.0, 0.0, 0.0), 1.0)).collect()
    }

    #[test]
    fn what_is_lost_is_found() {
        let mut all = columns(20);
        assert_eq!(found(&all), []);
        all.push(element("column", Vec3::new(0.0, 1e6, 0.0), 1.0));
        assert_eq!(found(&all), [(20, Outlier::Far)]);
        all[20] = element("", Vec3::ZERO, 1e7);
        assert_eq!(found(&all), [(20, Outlier::Far)]);
    }

    #[test]
    fn what_is_swollen_is_found() {
        let mut all = columns(20);
        all.push(element("column", Vec3::new(60.0, 0.0, 0.0), 40.0));
        assert_eq!(found(&all), [(20, Outlier::Swollen)]);
        // The same is fine as something of its own, or within the rest.
        all[20].kind = "slab".into();
        assert_eq!(found(&all), []);
        all[20] = element("column", Vec3::new(50.0, 0.0, 0.0), 40.0);
        all.push(element("hall", Vec3::new(50.0, 0.0, 0.0), 100.0));
        assert_eq!(found(&all), []);
    }

    #[test]
    fn two_sites_and_little_things_are_no_accidents() {
        let mut all = columns(40);
        all.extend(columns(4).into_iter().map(|e| {
            let away = Vec3::new(0.0, 0.0, 1e5);
            let bounds = Aabb { min: e.bounds.min + away, max: e.bounds.max + away };
            Element { bounds, ..e }
        }));
        assert_eq!(found(&all), []);
        assert_eq!(found(&columns(3)), []);
        assert_eq!(found(&[]), []);
    }
}
