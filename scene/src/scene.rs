//! The model (what stands where) and the scene (what stands when).

use crate::link::{RuleReport, Rules};
use crate::{Aabb, Mesh, Properties, outliers};
use glam::{Affine3A, DVec3};
use std::ops::Range;
use std::sync::Arc;
use topout_schedule::{Behaviour, Diagnostics, Schedule, Time};

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
        #[derive(serde::Serialize, serde::Deserialize)]
        pub struct $name(pub u32);

        impl $name {
            /// As an index into the table it belongs to.
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(/** Index into [`Model::elements`]. */ ElementId);
id!(/** Index into [`Model::groups`]. */ GroupId);
id!(/** Index into [`Model::meshes`]. */ MeshId);
id!(/** Index into [`Scene::behaviours`]. */ BehaviourId);

/// How a surface looks.
#[derive(Clone, PartialEq, Debug)]
pub struct Material {
    /// The name in the file, or empty.
    pub name: String,
    /// Linear RGBA in [0, 1]; for a textured material already times the texture's mean.
    pub color: [f32; 4],
    /// 0 mirror-like, 1 matt.
    pub roughness: f32,
    /// 0 dielectric, 1 metal.
    pub metallic: f32,
    /// Drawn after the solid parts, blended by `color[3]`.
    pub transparent: bool,
}

/// A mesh at a place.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Which mesh.
    pub mesh: MeshId,
    /// Mesh space to the scene's local space (metres from [`Model::origin`]). May mirror.
    pub world_from_mesh: Affine3A,
}

/// One building element: the unit that is linked, appears and vanishes.
#[derive(Clone, Debug, Default)]
pub struct Element {
    /// Node name; may be empty.
    pub name: String,
    /// What people call it (the extras' ifcName), where that is not the name; may be empty.
    pub label: String,
    /// Global id from the node's extras, if any.
    pub guid: Option<String>,
    /// What it is (IfcWall, column, ...); may be empty.
    pub kind: String,
    /// Storey it belongs to; may be empty.
    pub storey: String,
    /// Nearest named group above it.
    pub group: Option<GroupId>,
    /// Its meshes, a range of [`Model::instances`].
    pub instances: Range<u32>,
    /// Box of its geometry in local space.
    pub bounds: Aabb,
}

/// A named node without a mesh: a storey, a zone, an assembly.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// Node name.
    pub name: String,
    /// What people call it (the extras' ifcName), where that is not the name; may be empty.
    pub label: String,
    /// What it is (IfcBuildingStorey, zone, ...); may be empty.
    pub kind: String,
    /// Global id from the node's extras, if any.
    pub guid: Option<String>,
    /// The group above.
    pub parent: Option<GroupId>,
}

/// One or several imported models: geometry and names, no time. Up is +Y, units are metres.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Display name.
    pub name: String,
    /// World position of the local space's zero; everything else is relative to it.
    pub origin: DVec3,
    /// Shared meshes.
    pub meshes: Vec<Mesh>,
    /// Surfaces, at most 65,536.
    pub materials: Vec<Material>,
    /// Meshes at places; the instances of an element are contiguous.
    pub instances: Vec<Instance>,
    /// Building elements.
    pub elements: Vec<Element>,
    /// Named nodes above elements.
    pub groups: Vec<Group>,
    /// What the files say of elements and groups beyond that.
    pub properties: Properties,
    /// What was found while importing.
    pub diagnostics: Diagnostics,
}

impl Model {
    /// The instances of an element.
    pub fn instances_of(&self, element: &Element) -> &[Instance] {
        &self.instances[element.instances.start as usize..element.instances.end as usize]
    }

    /// Number of triangles of an element, its instances counted each.
    pub fn triangles_of(&self, element: &Element) -> usize {
        self.instances_of(element)
            .iter()
            .map(|i| self.meshes[i.mesh.index()].triangle_count())
            .sum()
    }

    /// Number of triangles of all elements, instances counted each.
    pub fn triangle_count(&self) -> usize {
        self.elements.iter().map(|e| self.triangles_of(e)).sum()
    }

    /// Box of all elements.
    pub fn bounds(&self) -> Aabb {
        self.elements.iter().fold(Aabb::EMPTY, |b, e| b.union(&e.bounds))
    }
}

/// A model linked to a schedule: S(t) of H1. Immutable after load.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Geometry and names; shared by the scenes that differ in their schedule alone.
    pub model: Arc<Model>,
    /// Merged and validated activities.
    pub schedule: Schedule,
    /// Distinct behaviours; elements share them.
    pub behaviours: Vec<Behaviour>,
    /// Behaviour of each element.
    pub element_behaviour: Vec<BehaviourId>,
    /// Activities of each element: `activity_links[activity_starts[e]..activity_starts[e + 1]]`,
    /// indices into `schedule.activities`.
    pub activity_starts: Vec<u32>,
    /// See `activity_starts`.
    pub activity_links: Vec<u32>,
    /// What it was linked by.
    pub rules: Arc<Rules>,
    /// What each rule did, in order; then what links by hand did.
    pub rule_reports: Vec<RuleReport>,
    /// What linking found.
    pub link_diagnostics: Diagnostics,
    /// Everything found while importing, reading and linking.
    pub diagnostics: Diagnostics,
}

impl Scene {
    /// Puts together what importing, reading and linking found, in that order.
    pub(crate) fn collect_diagnostics(&mut self) {
        let mut all = self.model.diagnostics.clone();
        all.append(self.schedule.diagnostics.clone());
        all.append(self.link_diagnostics.clone());
        self.diagnostics = all;
    }

    /// The behaviour of an element.
    pub fn behaviour(&self, element: ElementId) -> &Behaviour {
        &self.behaviours[self.element_behaviour[element.index()].index()]
    }

    /// The activities linked to an element, as indices into `schedule.activities`.
    pub fn activities_of(&self, element: ElementId) -> &[u32] {
        match (
            self.activity_starts.get(element.index()),
            self.activity_starts.get(element.index() + 1),
        ) {
            (Some(&from), Some(&to)) => &self.activity_links[from as usize..to as usize],
            _ => &[],
        }
    }

    /// Elements and triangles that are present at a date, before any culling.
    pub fn present_counts(&self, time: Time) -> (usize, usize) {
        let present: Vec<bool> = self.behaviours.iter().map(|b| b.at(time)).collect();
        let there = self.model.elements.iter().zip(&self.element_behaviour);
        there.filter(|(_, b)| present[b.index()]).fold((0, 0), |(elements, triangles), (e, _)| {
            (elements + 1, triangles + self.model.triangles_of(e))
        })
    }

    /// The box that the standard views fit: that of all elements which some activity touches, of
    /// everything where none is touched; without [`crate::outliers`].
    pub fn focus_bounds(&self) -> Aabb {
        let elements = &self.model.elements;
        let solid = |id: &ElementId| !elements[id.index()].bounds.is_empty();
        let all = || (0..elements.len() as u32).map(ElementId).filter(solid);
        let mut shown: Vec<ElementId> =
            all().filter(|id| !self.activities_of(*id).is_empty()).collect();
        if shown.is_empty() {
            shown = all().collect();
        }
        let mut outliers = outliers(elements, &shown).into_iter().map(|(id, _)| id).peekable();
        shown
            .into_iter()
            .filter(|id| outliers.next_if_eq(id).is_none())
            .fold(Aabb::EMPTY, |b, id| b.union(&elements[id.index()].bounds))
    }
}
