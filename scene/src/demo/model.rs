//! From parts to a model: tessellations that give the exact number of triangles, names, groups.

use super::DemoError;
use super::builder::{Builder, LODS, Part, ShapeId, Zone};
use super::machines::{TREE, leaves};
use super::mesh::MeshBuilder;
use super::palette;
use super::random::mix;
use crate::{Aabb, Element, Group, GroupId, Instance, Mesh, MeshId, Model, Progress};
use glam::Vec3A;
use std::collections::BTreeMap;
use topout_schedule::Diagnostics;

/// Stands for the roof among storeys.
pub(super) const ROOF: i32 = 999;
/// Leaves that one tree may grow beyond its finest tessellation.
const MOST_LEAVES: usize = 20_000;

/// Short name of a storey, as in element names.
pub(super) fn storey_code(storey: i32) -> String {
    match storey {
        ROOF => "RF".to_owned(),
        ..0 => format!("B{}", -storey),
        _ => format!("S{storey:02}"),
    }
}

fn storey_name(zone: Zone, storey: i32) -> String {
    match (zone, storey) {
        (Zone::Building, ROOF) => "Roof".to_owned(),
        (_, ..0) => format!("Basement {}", -storey),
        (Zone::Building | Zone::Temporary | Zone::OldBuilding, _) => format!("Storey {storey:02}"),
        _ => "Site".to_owned(),
    }
}

/// Unique names: kind, storey, running number.
pub(super) fn names(parts: &[Part]) -> Vec<String> {
    let mut counters: BTreeMap<(&str, i32), u32> = BTreeMap::new();
    parts
        .iter()
        .map(|part| {
            let n = counters.entry((part.tag.0, part.storey)).or_default();
            *n += 1;
            format!("{}_{}_{:04}", part.tag.0, storey_code(part.storey), *n - 1)
        })
        .collect()
}

/// A 22-character global id in IFC's alphabet, out of a name and the seed.
fn guid(name: &str, seed: u64) -> String {
    const ALPHABET: &[u8; 64] = b"0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_$";
    let hash = |salt: u64| name.bytes().fold(mix(seed ^ salt), |h, c| mix(h ^ u64::from(c)));
    let mut bits = u128::from(hash(0x67d1)) << 64 | u128::from(hash(0x9b25));
    let mut text = [0; 22];
    for c in text.iter_mut().rev() {
        *c = ALPHABET[(bits & 63) as usize];
        bits >>= 6;
    }
    String::from_utf8_lossy(&text).into_owned()
}

/// How many instances of each shape are drawn at which tessellation, and how many leaves are added.
struct Detail {
    /// For each shape: tessellation, and how many of its first instances are one step finer.
    steps: Vec<(usize, usize)>,
    /// Leaves added to every tree and to the first one alone.
    leaves: (usize, usize),
}

/// Triangles of every shape at every tessellation, and its number of instances.
struct Census {
    triangles: Vec<[usize; LODS]>,
    uses: Vec<usize>,
    trees: usize,
}

impl Census {
    fn new(b: &Builder) -> Self {
        let triangles = b
            .shapes
            .iter()
            .map(|(_, recipe)| {
                std::array::from_fn(|lod| {
                    let mut m = MeshBuilder::default();
                    recipe(lod, &mut m);
                    m.triangle_count()
                })
            })
            .collect();
        let mut uses = vec![0; b.shapes.len()];
        b.instances.iter().for_each(|(shape, _)| uses[shape.0 as usize] += 1);
        let trees =
            b.shapes.iter().zip(&uses).filter(|((key, _), _)| key.0 == TREE).map(|(_, n)| n).sum();
        Self { triangles, uses, trees }
    }

    fn total(&self, lod: usize) -> usize {
        self.triangles.iter().zip(&self.uses).map(|(t, n)| t[lod] * n).sum()
    }

    /// A choice of tessellations with exactly `wanted` triangles.
    fn choose(&self, wanted: usize) -> Result<Detail, DemoError> {
        let least = self.total(0);
        let most = self.total(LODS - 1) + self.trees * MOST_LEAVES;
        if wanted < least || wanted > most {
            return Err(DemoError::Triangles { wanted, least, most });
        }
        let lod = (0..LODS).rev().find(|&l| self.total(l) <= wanted).unwrap_or(0);
        let mut left = wanted - self.total(lod);
        let mut steps = vec![(lod, 0); self.uses.len()];
        if lod + 1 < LODS {
            let gain = |s: usize| self.triangles[s][lod + 1] - self.triangles[s][lod];
            let mut order: Vec<usize> = (0..self.uses.len()).filter(|&s| gain(s) > 0).collect();
            order.sort_by_key(|&s| (std::cmp::Reverse(gain(s)), s));
            for s in order {
                let n = (left / gain(s)).min(self.uses[s]);
                steps[s].1 = n;
                left -= n * gain(s);
            }
        }
        let each = left / self.trees;
        Ok(Detail { steps, leaves: (each, left - each * self.trees) })
    }
}

/// Draws meshes on demand and remembers them.
struct Library<'a> {
    b: &'a Builder,
    detail: Detail,
    known: BTreeMap<(u32, usize, usize), MeshId>,
    seen: Vec<usize>,
    meshes: Vec<Mesh>,
    first_tree: bool,
}

impl Library<'_> {
    fn mesh(&mut self, shape: ShapeId) -> MeshId {
        let s = shape.0 as usize;
        let (lod, finer) = self.detail.steps[s];
        self.seen[s] += 1;
        let lod = if self.seen[s] <= finer { lod + 1 } else { lod };
        let (key, recipe) = &self.b.shapes[s];
        let mut extra = 0;
        if key.0 == TREE {
            extra = self.detail.leaves.0 + if self.first_tree { self.detail.leaves.1 } else { 0 };
            self.first_tree = false;
        }
        *self.known.entry((shape.0, lod, extra)).or_insert_with(|| {
            let mut m = MeshBuilder::default();
            recipe(lod, &mut m);
            leaves(key.1[0] + 10, extra, &mut m);
            self.meshes.push(m.finish());
            MeshId(self.meshes.len() as u32 - 1)
        })
    }
}

/// The groups above elements, made when first asked for.
#[derive(Default)]
struct Groups {
    list: Vec<Group>,
    known: BTreeMap<String, GroupId>,
}

impl Groups {
    fn get(&mut self, name: &str, parent: Option<GroupId>, seed: u64) -> GroupId {
        if let Some(&id) = self.known.get(name) {
            return id;
        }
        let id = GroupId(self.list.len() as u32);
        self.list.push(Group {
            name: name.to_owned(),
            guid: Some(guid(name, seed ^ 0x6706)),
            parent,
            ..Group::default()
        });
        self.known.insert(name.to_owned(), id);
        id
    }

    fn of(&mut self, b: &Builder, part: &Part, seed: u64) -> GroupId {
        let top = match (part.zone, part.storey) {
            (Zone::Surroundings, _) => "Surroundings",
            (Zone::Site, _) => "Site",
            (Zone::OldBuilding, _) => "Old building",
            (Zone::Temporary, _) => "Temporary works",
            (Zone::Building, ..0) => "Basement",
            (Zone::Building, s) if s < b.design.podium => "Podium",
            _ => "Tower",
        };
        let parent = self.get(top, None, seed);
        if part.zone != Zone::Building {
            return parent;
        }
        self.get(&storey_name(part.zone, part.storey), Some(parent), seed)
    }
}

/// Turns all parts into a model with exactly `triangles` triangles.
pub(super) fn model(
    b: &Builder,
    names: &[String],
    triangles: usize,
    seed: u64,
    progress: &Progress,
) -> Result<Model, DemoError> {
    let census = Census::new(b);
    let detail = census.choose(triangles)?;
    let mut library = Library {
        b,
        detail,
        known: BTreeMap::new(),
        seen: vec![0; b.shapes.len()],
        meshes: Vec::new(),
        first_tree: true,
    };
    let instances: Vec<Instance> = b
        .instances
        .iter()
        .map(|&(shape, place)| Instance { mesh: library.mesh(shape), world_from_mesh: place })
        .collect();
    let mut groups = Groups::default();
    let mut elements = Vec::with_capacity(b.parts.len());
    for (k, (part, name)) in b.parts.iter().zip(names).enumerate() {
        if k % 4096 == 0 {
            progress.advance(4096.min(b.parts.len() - k) as u64)?;
        }
        let range = part.instances.start as usize..part.instances.end as usize;
        elements.push(Element {
            name: name.clone(),
            guid: Some(guid(name, seed)),
            kind: part.tag.1.to_owned(),
            storey: storey_name(part.zone, part.storey),
            group: Some(groups.of(b, part, seed)),
            instances: part.instances.clone(),
            bounds: bounds(&instances[range], &library.meshes),
            ..Element::default()
        });
    }
    Ok(Model {
        name: "Harbour Tower".to_owned(),
        origin: glam::DVec3::ZERO,
        meshes: library.meshes,
        materials: palette::materials(),
        instances,
        elements,
        groups: groups.list,
        properties: Default::default(),
        diagnostics: Diagnostics::default(),
    })
}

/// The tight box of instances. Quarter turns map a mesh's box exactly; other turns need its points.
fn bounds(instances: &[Instance], meshes: &[Mesh]) -> Aabb {
    instances.iter().fold(Aabb::EMPTY, |all, instance| {
        let mesh = &meshes[instance.mesh.index()];
        let place = &instance.world_from_mesh;
        let axes = [place.matrix3.x_axis, place.matrix3.y_axis, place.matrix3.z_axis];
        let straight = axes.iter().all(|a| a.cmpeq(Vec3A::ZERO).bitmask().count_ones() == 2);
        all.union(&if straight {
            mesh.bounds.transformed(place)
        } else {
            Aabb::of_points(mesh.vertices.iter().map(|v| place.transform_point3(v.position.into())))
        })
    })
}
