//! Collecting parts: which shapes stand where, what they are, and which work they belong to.

use super::design::Design;
use super::mesh::MeshBuilder;
use super::programme::{Plan, Work};
use super::random::Random;
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use std::collections::HashMap;
use std::ops::Range;

/// Number of tessellations of a shape, coarse to fine.
pub(super) const LODS: usize = 6;

/// Name prefix and IFC class of a kind of part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tag(pub &'static str, pub &'static str);

/// Top-level groups of the model.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub(super) enum Zone {
    Surroundings,
    Site,
    OldBuilding,
    Temporary,
    /// Podium, tower or basement, by the storey.
    Building,
}

/// Index into [`Builder::shapes`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub(super) struct ShapeId(pub u32);

/// Index into [`Builder::works`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub(super) struct WorkId(pub u32);

/// Draws a shape at a tessellation in `0..LODS`.
pub(super) type Recipe = Box<dyn Fn(usize, &mut MeshBuilder)>;

/// What identifies a shape: its name and sizes in millimetres or other whole numbers.
pub(super) type ShapeKey = (&'static str, [i32; 6]);

/// One element to be.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub tag: Tag,
    pub zone: Zone,
    pub storey: i32,
    pub instances: Range<u32>,
    /// Works in time order; unused places hold `None`.
    pub works: [Option<WorkId>; 3],
}

/// Everything collected so far.
pub(super) struct Builder {
    pub design: Design,
    pub plan: Plan,
    pub random: Random,
    pub parts: Vec<Part>,
    pub instances: Vec<(ShapeId, Affine3A)>,
    pub shapes: Vec<(ShapeKey, Recipe)>,
    pub works: Vec<Work>,
    shape_index: HashMap<ShapeKey, ShapeId>,
}

impl Builder {
    pub(super) fn new(design: Design, seed: u64) -> Self {
        Self {
            plan: Plan::new(&design),
            design,
            random: Random::new(seed),
            parts: Vec::new(),
            instances: Vec::new(),
            shapes: Vec::new(),
            works: Vec::new(),
            shape_index: HashMap::new(),
        }
    }

    /// The shape of this key, drawn by `recipe`, which must depend on the key alone.
    pub(super) fn shape(
        &mut self,
        name: &'static str,
        sizes: &[i32],
        recipe: impl Fn(usize, &mut MeshBuilder) + 'static,
    ) -> ShapeId {
        let mut key = (name, [0; 6]);
        key.1[..sizes.len()].copy_from_slice(sizes);
        if let Some(&id) = self.shape_index.get(&key) {
            return id;
        }
        let id = ShapeId(self.shapes.len() as u32);
        self.shapes.push((key, Box::new(recipe)));
        self.shape_index.insert(key, id);
        id
    }

    /// Starts a package of work; parts join it in the order in which they are added.
    pub(super) fn work(&mut self, work: Work) -> WorkId {
        self.works.push(work);
        WorkId(self.works.len() as u32 - 1)
    }

    /// Adds an element of several shapes.
    pub(super) fn add_all(
        &mut self,
        tag: Tag,
        zone: Zone,
        storey: i32,
        pieces: &[(ShapeId, Affine3A)],
        works: &[WorkId],
    ) {
        let from = self.instances.len() as u32;
        self.instances.extend_from_slice(pieces);
        let mut slots = [None; 3];
        slots.iter_mut().zip(works).for_each(|(slot, work)| *slot = Some(*work));
        self.parts.push(Part {
            tag,
            zone,
            storey,
            instances: from..self.instances.len() as u32,
            works: slots,
        });
    }

    /// Adds an element of one shape.
    pub(super) fn add(
        &mut self,
        tag: Tag,
        zone: Zone,
        storey: i32,
        shape: ShapeId,
        place: Affine3A,
        works: &[WorkId],
    ) {
        self.add_all(tag, zone, storey, &[(shape, place)], works);
    }

    /// Adds an element of the building.
    pub(super) fn build(
        &mut self,
        tag: Tag,
        storey: i32,
        shape: ShapeId,
        place: Affine3A,
        work: WorkId,
    ) {
        self.add(tag, Zone::Building, storey, shape, place, &[work]);
    }
}

/// Millimetres, for shape keys.
pub(super) fn mm(metres: f32) -> i32 {
    (metres * 1000.0).round() as i32
}

/// A place.
pub(super) fn at(x: f32, y: f32, z: f32) -> Affine3A {
    Affine3A::from_translation(Vec3::new(x, y, z))
}

/// A place with exact quarter turns about Y (each brings +Z to +X) and a scale.
pub(super) fn placed(position: Vec3, quarter: u8, scale: Vec3) -> Affine3A {
    let (s, c) = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][usize::from(quarter % 4)];
    turned_by(position, s, c, scale)
}

/// A place turned about Y by a share of a full turn.
pub(super) fn turned(position: Vec3, turns: f32, scale: Vec3) -> Affine3A {
    let (s, c) = super::random::sin_cos(turns);
    turned_by(position, s, c, scale)
}

fn turned_by(position: Vec3, s: f32, c: f32, scale: Vec3) -> Affine3A {
    // -0.0 would be written differently from 0.0.
    let column = |x: f32, y: f32, z: f32| Vec3A::new(x + 0.0, y + 0.0, z + 0.0);
    Affine3A {
        matrix3: Mat3A::from_cols(
            column(c * scale.x, 0.0, -s * scale.x),
            column(0.0, scale.y, 0.0),
            column(s * scale.z, 0.0, c * scale.z),
        ),
        translation: position.into(),
    }
}
