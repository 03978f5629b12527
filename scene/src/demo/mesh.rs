//! Building meshes out of quads, boxes, tubes and turned profiles.

use super::palette::Paint;
use super::random::{Random, sin_cos};
use crate::{Aabb, Mesh, Vertex, encode_normal};
use glam::Vec3;

/// A mesh under construction. Faces are counter-clockwise seen from outside.
#[derive(Default)]
pub(super) struct MeshBuilder {
    vertices: Vec<Vertex>,
    opaque: Vec<u32>,
    transparent: Vec<u32>,
}

impl MeshBuilder {
    pub(super) fn finish(mut self) -> Mesh {
        let bounds = Aabb::of_points(self.vertices.iter().map(|v| Vec3::from(v.position)));
        let opaque = self.opaque.len() as u32;
        self.opaque.append(&mut self.transparent);
        Mesh { vertices: self.vertices, indices: self.opaque, opaque, bounds }
    }

    pub(super) fn triangle_count(&self) -> usize {
        (self.opaque.len() + self.transparent.len()) / 3
    }

    fn vertex(&mut self, position: Vec3, normal: [i8; 2], paint: Paint) -> u32 {
        self.vertices.push(Vertex { position: position.to_array(), normal, material: paint.0 });
        (self.vertices.len() - 1) as u32
    }

    fn triangle_of(&mut self, corners: [u32; 3], paint: Paint) {
        let list = if paint.transparent() { &mut self.transparent } else { &mut self.opaque };
        list.extend(corners);
    }

    pub(super) fn triangle(&mut self, corners: [Vec3; 3], paint: Paint) {
        let [a, b, c] = corners;
        let normal = encode_normal((b - a).cross(c - a));
        let ids = corners.map(|p| self.vertex(p, normal, paint));
        self.triangle_of(ids, paint);
    }

    /// A flat quad; its first corner's normal is used for all.
    pub(super) fn quad(&mut self, corners: [Vec3; 4], paint: Paint) {
        let [a, b, c, _] = corners;
        let normal = encode_normal((b - a).cross(c - a));
        let [i, j, k, l] = corners.map(|p| self.vertex(p, normal, paint));
        self.triangle_of([i, j, k], paint);
        self.triangle_of([i, k, l], paint);
    }

    /// A box by its corners: 12 triangles.
    pub(super) fn cuboid(&mut self, min: Vec3, max: Vec3, paint: Paint) {
        self.solid(
            min,
            Vec3::X * (max.x - min.x),
            Vec3::Y * (max.y - min.y),
            Vec3::Z * (max.z - min.z),
            paint,
        );
    }

    /// A box by the middle of its bottom and its size.
    pub(super) fn block(&mut self, bottom: Vec3, size: Vec3, paint: Paint) {
        let half = Vec3::new(size.x * 0.5, 0.0, size.z * 0.5);
        self.cuboid(bottom - half, bottom + half + Vec3::Y * size.y, paint);
    }

    /// A parallelepiped from a corner and three edges (right-handed): 12 triangles.
    fn solid(&mut self, o: Vec3, x: Vec3, y: Vec3, z: Vec3, paint: Paint) {
        self.quad([o, o + y, o + x + y, o + x], paint);
        self.quad([o + z, o + z + x, o + z + x + y, o + z + y], paint);
        self.quad([o, o + z, o + z + y, o + y], paint);
        self.quad([o + x, o + x + y, o + x + y + z, o + x + z], paint);
        self.quad([o, o + x, o + x + z, o + z], paint);
        self.quad([o + y, o + y + z, o + x + y + z, o + x + y], paint);
    }

    /// A bar of rectangular section between two points: 12 triangles.
    pub(super) fn bar(&mut self, from: Vec3, to: Vec3, width: f32, height: f32, paint: Paint) {
        let along = to - from;
        let up = if along.x.abs() + along.z.abs() < 1e-4 { Vec3::X } else { Vec3::Y };
        let side = along.cross(up).normalize() * width;
        let rise = side.cross(along).normalize() * height;
        self.solid(from - side * 0.5 - rise * 0.5, along, rise, side, paint);
    }

    /// A round bar; `sides` below 5 gives a square one. 4 `sides` - 4 triangles.
    pub(super) fn tube(&mut self, from: Vec3, to: Vec3, radius: f32, sides: usize, paint: Paint) {
        if sides < 5 {
            return self.bar(from, to, radius * 1.8, radius * 1.8, paint);
        }
        self.cone(from, to, radius, radius, sides, paint);
    }

    /// A round bar with different radii (both positive): 4 `sides` - 4 triangles.
    pub(super) fn cone(
        &mut self,
        from: Vec3,
        to: Vec3,
        r0: f32,
        r1: f32,
        sides: usize,
        paint: Paint,
    ) {
        let along = to - from;
        let up = if along.x.abs() + along.z.abs() < 1e-4 { Vec3::X } else { Vec3::Y };
        let u = along.cross(up).normalize();
        let v = u.cross(along).normalize();
        let slope = (r0 - r1) / along.length();
        let axis = along.normalize();
        let rim: Vec<Vec3> = (0..sides)
            .map(|i| {
                let (s, c) = sin_cos(i as f32 / sides as f32);
                u * c - v * s
            })
            .collect();
        let first = self.vertices.len() as u32;
        for d in &rim {
            let normal = encode_normal(*d + axis * slope);
            self.vertex(from + *d * r0, normal, paint);
            self.vertex(to + *d * r1, normal, paint);
        }
        let n = sides as u32;
        for i in 0..n {
            let (a, b) = (first + 2 * i, first + 2 * ((i + 1) % n));
            self.triangle_of([a, b, b + 1], paint);
            self.triangle_of([a, b + 1, a + 1], paint);
        }
        let bottom: Vec<Vec3> = rim.iter().rev().map(|d| from + *d * r0).collect();
        let top: Vec<Vec3> = rim.iter().map(|d| to + *d * r1).collect();
        self.fan(&bottom, paint);
        self.fan(&top, paint);
    }

    /// A convex flat polygon.
    pub(super) fn fan(&mut self, points: &[Vec3], paint: Paint) {
        let normal = encode_normal((points[1] - points[0]).cross(points[2] - points[0]));
        let ids: Vec<u32> = points.iter().map(|p| self.vertex(*p, normal, paint)).collect();
        for pair in ids[1..].windows(2) {
            self.triangle_of([ids[0], pair[0], pair[1]], paint);
        }
    }

    /// A convex upright prism over a polygon of (x, z), counter-clockwise seen from above.
    pub(super) fn prism(&mut self, outline: &[(f32, f32)], bottom: f32, top: f32, paint: Paint) {
        let n = outline.len();
        let at = |i: usize, y: f32| Vec3::new(outline[i % n].0, y, outline[i % n].1);
        for i in 0..n {
            self.quad([at(i, bottom), at(i + 1, bottom), at(i + 1, top), at(i, top)], paint);
        }
        let upper: Vec<Vec3> = (0..n).map(|i| at(i, top)).collect();
        let lower: Vec<Vec3> = (0..n).rev().map(|i| at(i, bottom)).collect();
        self.fan(&upper, paint);
        self.fan(&lower, paint);
    }

    /// A profile of (radius, height), from bottom to top, turned about the Y axis through `center`.
    pub(super) fn lathe(
        &mut self,
        center: Vec3,
        profile: &[(f32, f32)],
        sides: usize,
        paint: Paint,
    ) {
        let point = |(r, y): (f32, f32), i: usize| {
            let (s, c) = sin_cos((i % sides) as f32 / sides as f32);
            center + Vec3::new(r * c, y, -r * s)
        };
        for pair in profile.windows(2) {
            let (low, high) = (pair[0], pair[1]);
            for i in 0..sides {
                let (a, b) = (point(low, i), point(low, i + 1));
                let (c, d) = (point(high, i + 1), point(high, i));
                if low.0 <= 0.0 {
                    self.triangle([a, c, d], paint);
                } else if high.0 <= 0.0 {
                    self.triangle([a, b, c], paint);
                } else {
                    self.quad([a, b, c, d], paint);
                }
            }
        }
    }

    /// A plate in the XZ plane with a rectangular hole, both given as [x0, z0, x1, z1]: 32 triangles.
    pub(super) fn ring(
        &mut self,
        outer: [f32; 4],
        hole: [f32; 4],
        bottom: f32,
        top: f32,
        paint: Paint,
    ) {
        let corners = |r: [f32; 4]| [(r[0], r[3]), (r[2], r[3]), (r[2], r[1]), (r[0], r[1])];
        let (o, h) = (corners(outer), corners(hole));
        let at = |p: (f32, f32), y: f32| Vec3::new(p.0, y, p.1);
        for i in 0..4 {
            let j = (i + 1) % 4;
            self.quad([at(o[i], top), at(o[j], top), at(h[j], top), at(h[i], top)], paint);
            self.quad(
                [at(o[j], bottom), at(o[i], bottom), at(h[i], bottom), at(h[j], bottom)],
                paint,
            );
            self.quad([at(o[i], bottom), at(o[j], bottom), at(o[j], top), at(o[i], top)], paint);
            self.quad([at(h[j], bottom), at(h[i], bottom), at(h[i], top), at(h[j], top)], paint);
        }
    }

    /// An upright wall, centred in x, standing on y = 0, with an opening [x0, y0, x1, y1]; a `y0` of
    /// 0 makes a doorway. 28 to 32 triangles.
    pub(super) fn wall(
        &mut self,
        width: f32,
        height: f32,
        thickness: f32,
        hole: [f32; 4],
        paint: Paint,
    ) {
        let (w, t) = (width * 0.5, thickness * 0.5);
        let [x0, y0, x1, y1] = hole;
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let mut sheet = |a: [f32; 2], b: [f32; 2]| {
            self.quad(
                [at(a[0], a[1], t), at(b[0], a[1], t), at(b[0], b[1], t), at(a[0], b[1], t)],
                paint,
            );
            self.quad(
                [at(b[0], a[1], -t), at(a[0], a[1], -t), at(a[0], b[1], -t), at(b[0], b[1], -t)],
                paint,
            );
        };
        sheet([-w, 0.0], [x0, height]);
        sheet([x1, 0.0], [w, height]);
        sheet([x0, y1], [x1, height]);
        if y0 > 0.0 {
            sheet([x0, 0.0], [x1, y0]);
            self.quad([at(x0, y0, t), at(x1, y0, t), at(x1, y0, -t), at(x0, y0, -t)], paint);
            self.quad([at(-w, 0.0, -t), at(w, 0.0, -t), at(w, 0.0, t), at(-w, 0.0, t)], paint);
        } else {
            self.quad([at(-w, 0.0, -t), at(x0, 0.0, -t), at(x0, 0.0, t), at(-w, 0.0, t)], paint);
            self.quad([at(x1, 0.0, -t), at(w, 0.0, -t), at(w, 0.0, t), at(x1, 0.0, t)], paint);
        }
        self.quad([at(x0, y1, -t), at(x1, y1, -t), at(x1, y1, t), at(x0, y1, t)], paint);
        self.quad([at(x0, y0, t), at(x0, y0, -t), at(x0, y1, -t), at(x0, y1, t)], paint);
        self.quad([at(x1, y0, -t), at(x1, y0, t), at(x1, y1, t), at(x1, y1, -t)], paint);
        self.quad(
            [at(-w, height, t), at(w, height, t), at(w, height, -t), at(-w, height, -t)],
            paint,
        );
        self.quad([at(-w, 0.0, -t), at(-w, 0.0, t), at(-w, height, t), at(-w, height, -t)], paint);
        self.quad([at(w, 0.0, t), at(w, 0.0, -t), at(w, height, -t), at(w, height, t)], paint);
    }

    /// A lumpy ball: 20 triangles times 4 to the power `detail`.
    pub(super) fn blob(
        &mut self,
        center: Vec3,
        radius: Vec3,
        detail: usize,
        seed: u64,
        paint: Paint,
    ) {
        let (points, faces) = icosphere(detail);
        let mut random = Random::new(seed);
        let points: Vec<Vec3> =
            points.iter().map(|p| center + *p * radius * random.between(0.88, 1.12)).collect();
        let mut normals = vec![Vec3::ZERO; points.len()];
        for f in &faces {
            let [a, b, c] = f.map(|i| points[i as usize]);
            let normal = (b - a).cross(c - a);
            f.iter().for_each(|&i| normals[i as usize] += normal);
        }
        let first = self.vertices.len() as u32;
        for (p, n) in points.iter().zip(&normals) {
            self.vertex(*p, encode_normal(*n), paint);
        }
        for f in faces {
            self.triangle_of(f.map(|i| first + i), paint);
        }
    }
}

/// A ball of triangles on shared points, refined `detail` times.
fn icosphere(detail: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let g = 1.618_034;
    let mut points: Vec<Vec3> = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ]
    .map(|p| Vec3::from(p).normalize())
    .to_vec();
    let mut faces: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..detail {
        let mut middle = std::collections::HashMap::new();
        let mut half = |a: u32, b: u32, points: &mut Vec<Vec3>| {
            *middle.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                (points.len() - 1) as u32
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let ab = half(a, b, &mut points);
                let bc = half(b, c, &mut points);
                let ca = half(c, a, &mut points);
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    (points, faces)
}
