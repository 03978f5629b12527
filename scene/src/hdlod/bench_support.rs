//! Doors to the parts of HDLOD for `benches/`: not part of the interface.

use super::certify::{self, Limits};
use super::contract::{self, Joins};
use super::cover;
use super::grouping;
use super::palette::Palette;
use super::presence::PresenceTable;
use super::soup::{Triangle, append_instance};
use crate::{Aabb, ElementId, Progress, Scene};

/// The elements around a point as one soup, as a cluster's source.
pub struct Soup<'a> {
    triangles: Vec<Triangle>,
    presence: PresenceTable<'a>,
    palette: Palette,
}

/// A soup that was simplified.
pub struct Simplified(cover::Simplified);

impl<'a> Soup<'a> {
    /// Of the elements that lie in a box.
    pub fn within(scene: &'a Scene, bounds: &Aabb) -> Self {
        let mut triangles = Vec::new();
        let inside = |b: &Aabb| bounds.union(b) == *bounds;
        for (id, element) in (0..).map(ElementId).zip(&scene.model.elements) {
            if inside(&element.bounds) {
                let behaviour = scene.element_behaviour[id.index()];
                for instance in scene.model.instances_of(element) {
                    let mesh = &scene.model.meshes[instance.mesh.index()];
                    append_instance(instance, mesh, behaviour, &mut triangles);
                }
            }
        }
        Self {
            triangles,
            presence: PresenceTable::new(&scene.behaviours, true),
            palette: Palette::new(&scene.model.materials),
        }
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Within a budget in metres.
    pub fn simplify(&self, budget_m: f32) -> Simplified {
        let never = Progress::default();
        let simplified =
            cover::simplify(&self.triangles, budget_m, &self.presence, &self.palette, &never);
        Simplified(simplified.expect("nobody cancels"))
    }

    /// Within a budget in metres by contraction alone: of edges, or of vertex pairs too.
    pub fn contract(&self, budget_m: f32, pairs: bool) -> Simplified {
        let never = Progress::default();
        let joins = if pairs { Joins::Pairs } else { Joins::Edges };
        let simplified =
            contract::simplify(&self.triangles, budget_m, joins, &self.presence, &never);
        Simplified(simplified.expect("nobody cancels"))
    }

    /// Lower and upper bound in metres of the distance to what it became, to a factor of 1.3.
    pub fn certify(&self, simplified: &Simplified, budget_m: f32) -> (f32, f32) {
        let limits = Limits::value(1.3, budget_m * 0.05);
        let result =
            certify::distance(&self.triangles, &simplified.0.triangles, &self.presence, limits);
        (result.lower, result.upper)
    }
}

impl Simplified {
    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.0.triangles.len()
    }
}

/// Groups boxes in space; the number of groups.
pub fn group(bounds: &[Aabb], diameter_m: f32) -> usize {
    grouping::group(bounds, diameter_m, |_, _| Some(0.0)).len()
}
