//! Boxes, vertices and meshes.

use glam::{Affine3A, Vec2, Vec3};

/// An axis-aligned box in metres; empty while `min > max`.
#[derive(Clone, Copy, PartialEq, Debug, serde::Serialize, serde::Deserialize)]
pub struct Aabb {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Default for Aabb {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Aabb {
    /// The box of nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box of the points.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// Whether it encloses nothing.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The middle; meaningless for an empty box.
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Edge lengths; zero for an empty box.
    pub fn size(&self) -> Vec3 {
        (self.max - self.min).max(Vec3::ZERO)
    }

    /// Length of the diagonal.
    pub fn diameter(&self) -> f32 {
        self.size().length()
    }

    /// The eight corners.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            Vec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }

    /// The box of the transformed corners.
    pub fn transformed(&self, transform: &Affine3A) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::of_points(self.corners().map(|c| transform.transform_point3(c)))
    }

    /// Distance from a point to the nearest point of the box; 0 inside (R7).
    pub fn distance(&self, point: Vec3) -> f32 {
        (self.min - point).max(point - self.max).max(Vec3::ZERO).length()
    }

    /// The box grown by `margin` on all sides.
    pub fn grown(&self, margin: f32) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }
}

/// One vertex as the GPU reads it: 16 bytes.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    /// Metres, in the space of the mesh.
    pub position: [f32; 3],
    /// Octahedral unit normal, see [`encode_normal`].
    pub normal: [i8; 2],
    /// Index into [`crate::Model::materials`].
    pub material: u16,
}

/// Octahedral encoding of a unit normal in two signed bytes. A zero vector reads as +Y.
pub fn encode_normal(normal: Vec3) -> [i8; 2] {
    let sum = normal.abs().element_sum();
    if sum.is_nan() || sum <= 0.0 {
        return encode_normal(Vec3::Y);
    }
    let n = normal / sum;
    let mut p = Vec2::new(n.x, n.y);
    if n.z < 0.0 {
        let sign =
            Vec2::new(if p.x < 0.0 { -1.0 } else { 1.0 }, if p.y < 0.0 { -1.0 } else { 1.0 });
        p = (Vec2::ONE - Vec2::new(p.y.abs(), p.x.abs())) * sign;
    }
    [(p.x * 127.0).round() as i8, (p.y * 127.0).round() as i8]
}

/// The unit normal that [`encode_normal`] packed.
pub fn decode_normal(packed: [i8; 2]) -> Vec3 {
    let p = (Vec2::new(f32::from(packed[0]), f32::from(packed[1])) / 127.0)
        .clamp(Vec2::splat(-1.0), Vec2::ONE);
    let mut n = Vec3::new(p.x, p.y, 1.0 - p.x.abs() - p.y.abs());
    if n.z < 0.0 {
        let sign =
            Vec2::new(if p.x < 0.0 { -1.0 } else { 1.0 }, if p.y < 0.0 { -1.0 } else { 1.0 });
        let q = (Vec2::ONE - Vec2::new(p.y.abs(), p.x.abs())) * sign;
        n.x = q.x;
        n.y = q.y;
    }
    n.normalize_or(Vec3::Y)
}

/// Which pass draws a triangle.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Layer {
    /// Drawn first, writes depth.
    Opaque,
    /// Drawn after everything solid, over what is behind it.
    Transparent,
}

/// An indexed triangle soup, shared by any number of instances.
///
/// Rule: `indices` counts in threes, every index is below `vertices.len()`, positions are finite;
/// `indices[..opaque]` are the triangles of solid materials, the rest those of transparent ones.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Points with their normal and material.
    pub vertices: Vec<Vertex>,
    /// Three a triangle.
    pub indices: Vec<u32>,
    /// Number of indices of the opaque triangles, which come first.
    pub opaque: u32,
    /// Box of all vertices.
    pub bounds: Aabb,
}

impl Mesh {
    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }

    /// The corners of each triangle.
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = [u32; 3]> + '_ {
        self.indices.as_chunks::<3>().0.iter().copied()
    }
}
