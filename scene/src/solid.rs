//! Which meshes bound solids, so that a section through them can be filled.

use crate::{Mesh, Model};
use std::collections::HashMap;
use std::sync::OnceLock;

/// What the opaque triangles of a mesh bound.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Solidity {
    /// Nothing for sure: some edge has not one triangle on either side.
    Open,
    /// A solid; triangles are counter-clockwise as seen from outside.
    Outward,
    /// A solid; they are clockwise.
    Inward,
}

impl Solidity {
    /// Looks at every edge: O(triangles). Corners are one where they have the same position to the bit,
    /// triangles without area do not count.
    pub fn of(mesh: &Mesh) -> Self {
        let mut corners: HashMap<[u32; 3], u32> = HashMap::new();
        let mut welded = |index: u32| {
            // Zero has two signs.
            let key = mesh.vertices[index as usize].position.map(|c| (c + 0.0).to_bits());
            let next = corners.len() as u32;
            *corners.entry(key).or_insert(next)
        };
        let mut open: HashMap<(u32, u32), i32> = HashMap::new();
        let mut volume = 0.0;
        for triangle in mesh.triangles().take(mesh.opaque as usize / 3) {
            let [a, b, c] = triangle.map(&mut welded);
            if a == b || b == c || c == a {
                continue;
            }
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (edge, way) = if from < to { ((from, to), 1) } else { ((to, from), -1) };
                *open.entry(edge).or_insert(0) += way;
            }
            let [p, q, r] = triangle.map(|i| {
                let center = mesh.bounds.center();
                (glam::Vec3::from(mesh.vertices[i as usize].position) - center).as_dvec3()
            });
            volume += p.dot(q.cross(r));
        }
        match volume {
            _ if open.is_empty() || open.values().any(|way| *way != 0) => Self::Open,
            volume if volume > 0.0 => Self::Outward,
            volume if volume < 0.0 => Self::Inward,
            _ => Self::Open,
        }
    }
}

/// The solidity of a model's meshes, found out when first asked for.
#[derive(Debug, Default)]
pub struct Solids(Vec<OnceLock<Solidity>>);

impl Solids {
    /// Of the meshes of `model`, which must be the one that is asked about.
    pub fn new(model: &Model) -> Self {
        Self(model.meshes.iter().map(|_| OnceLock::new()).collect())
    }

    /// Whether the triangles of an instance, given by its place in the model, are counter-clockwise as seen
    /// from outside in the world; `None` where they bound nothing.
    pub fn faces_outward(&self, model: &Model, instance: usize) -> Option<bool> {
        let instance = &model.instances[instance];
        let known = self.0.get(instance.mesh.index())?;
        let mesh = &model.meshes[instance.mesh.index()];
        // A mirror turns them round.
        let upright = instance.world_from_mesh.matrix3.determinant() > 0.0;
        match known.get_or_init(|| Solidity::of(mesh)) {
            Solidity::Open => None,
            Solidity::Outward => Some(upright),
            Solidity::Inward => Some(!upright),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Aabb, Vertex};
    use glam::Vec3;

    /// A tetrahedron whose corners are not shared between faces.
    fn tetrahedron() -> Mesh {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|c| c + 100.0);
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let vertices: Vec<Vertex> = faces
            .iter()
            .flatten()
            .map(|&i: &usize| Vertex { position: corners[i].into(), normal: [0, 127], material: 0 })
            .collect();
        let bounds = Aabb::of_points(corners);
        Mesh { indices: (0..12).collect(), vertices, opaque: 12, bounds }
    }

    #[test]
    fn a_solid_is_closed_and_has_an_outside() {
        let mut mesh = tetrahedron();
        assert_eq!(Solidity::of(&mesh), Solidity::Outward);
        // A triangle without area changes nothing.
        mesh.indices.extend([0, 0, 1]);
        mesh.opaque = 15;
        assert_eq!(Solidity::of(&mesh), Solidity::Outward);
        mesh.indices.reverse();
        assert_eq!(Solidity::of(&mesh), Solidity::Inward);
        let mut torn = tetrahedron();
        torn.indices.truncate(9);
        torn.opaque = 9;
        assert_eq!(Solidity::of(&torn), Solidity::Open);
        let mut twisted = tetrahedron();
        twisted.indices.swap(0, 1);
        assert_eq!(Solidity::of(&twisted), Solidity::Open);
        let mut glass = tetrahedron();
        glass.opaque = 0;
        assert_eq!(Solidity::of(&glass), Solidity::Open);
    }
}
