//! Shapes of things that live on a site and around it: trees, vehicles, cranes, people.

use super::builder::{Builder, ShapeId, mm};
use super::mesh::MeshBuilder;
use super::palette::{self as p, Paint};
use super::random::{Random, sin_cos};
use super::shapes::sides;
use glam::{Vec3, vec3};

/// Name of the shapes whose leaves make up the exact number of triangles.
pub(super) const TREE: &str = "tree";

/// Sides of a wheel or a barrel by tessellation.
fn round(lod: usize) -> usize {
    [6, 8, 12, 16, 22, 30][lod]
}

/// Scatters `count` leaf triangles over the crown of a tree of this `kind`.
pub(super) fn leaves(kind: i32, count: usize, m: &mut MeshBuilder) {
    let mut random = Random::new(0x1eaf + kind as u64);
    let paint = [p::LEAF_A, p::LEAF_B, p::LEAF_C][kind as usize % 3];
    for _ in 0..count {
        let (s, c) = sin_cos(random.unit());
        let y = random.between(-0.85, 1.0);
        let r = (1.0 - y * y).max(0.04).sqrt() * random.between(0.9, 1.03);
        let out = vec3(c * r, y, s * r);
        let at = vec3(0.0, 5.0, 0.0) + out * vec3(2.1, 2.3, 2.1);
        let (s2, c2) = sin_cos(random.unit());
        // Leaves lie nearly flat on the crown and face outward, so that they catch the same light.
        let mut u = vec3(c2, 0.3, s2) * 0.3;
        let v = vec3(-s2, 0.25, c2) * 0.26;
        if u.cross(v).dot(out) < 0.0 {
            u = -u;
        }
        m.triangle([at - u * 0.5, at + u * 0.5, at + v], paint);
    }
}

impl Builder {
    /// A tree about 7.5 m high; three kinds.
    pub(super) fn tree(&mut self, kind: i32) -> ShapeId {
        let kind = kind % 3;
        self.shape(TREE, &[kind], move |lod, m| {
            let paint = [p::LEAF_A, p::LEAF_B, p::LEAF_C][kind as usize];
            let n = [5, 6, 7, 8, 10, 12][lod];
            m.cone(vec3(0.0, -0.1, 0.0), vec3(0.0, 3.6, 0.0), 0.17, 0.11, n, p::BARK);
            let balls = [
                (vec3(0.0, 5.2, 0.0), vec3(1.9, 2.2, 1.9)),
                (vec3(0.9, 4.4, 0.5), vec3(1.3, 1.3, 1.3)),
                (vec3(-0.8, 4.6, 0.6), vec3(1.3, 1.4, 1.2)),
                (vec3(0.1, 4.3, -0.9), vec3(1.4, 1.3, 1.2)),
            ];
            let (count, detail) = [(1, 0), (3, 0), (4, 1), (4, 1), (4, 2), (4, 2)][lod];
            for (i, (center, radius)) in balls[..count].iter().enumerate() {
                m.blob(*center, *radius, detail, (kind * 7) as u64 + i as u64, paint);
            }
            leaves(kind, [0, 0, 120, 320, 700, 1500][lod], m);
        })
    }

    /// A car along X.
    pub(super) fn car(&mut self, paint: Paint) -> ShapeId {
        self.shape("car", &[paint.0.into()], move |lod, m| {
            let (w, l) = (0.88, 2.15);
            m.cuboid(vec3(-l, 0.28, -w), vec3(l, 0.85, w), paint);
            cabin(m, [-1.5, 1.0], [-1.1, 0.35], (0.85, 1.42), (w - 0.03, w - 0.2), p::CAR_GLASS);
            m.cuboid(vec3(-1.08, 1.42, -w + 0.22), vec3(0.33, 1.46, w - 0.22), paint);
            wheels(m, &[-1.3, 1.35], w, 0.33, lod);
            if lod >= 2 {
                for z in [-0.62, 0.62] {
                    m.cuboid(vec3(l, 0.6, z - 0.16), vec3(l + 0.02, 0.74, z + 0.16), p::LUMINAIRE);
                    m.cuboid(vec3(-l - 0.02, 0.6, z - 0.16), vec3(-l, 0.74, z + 0.16), p::RED);
                }
                m.cuboid(vec3(l, 0.3, -w + 0.05), vec3(l + 0.06, 0.45, w - 0.05), p::BLACK);
            }
        })
    }

    /// A lorry along X; kinds: tipper, concrete mixer, flatbed.
    pub(super) fn lorry(&mut self, kind: i32, paint: Paint) -> ShapeId {
        self.shape("lorry", &[kind, paint.0.into()], move |lod, m| {
            m.cuboid(vec3(-4.2, 0.7, -1.0), vec3(3.9, 1.0, 1.0), p::BLACK);
            m.cuboid(vec3(2.2, 0.95, -1.22), vec3(4.0, 2.0, 1.22), paint);
            cabin(m, [2.2, 4.0], [2.25, 3.7], (2.0, 3.0), (1.2, 1.1), p::CAR_GLASS);
            m.cuboid(vec3(2.3, 3.0, -1.08), vec3(3.65, 3.08, 1.08), paint);
            wheels(m, &[-3.4, -2.2, 2.9], 1.2, 0.5, lod);
            match kind {
                0 => {
                    m.cuboid(vec3(-4.2, 1.0, -1.2), vec3(1.9, 1.15, 1.2), p::YELLOW);
                    for z in [-1.25, 1.15] {
                        m.cuboid(vec3(-4.2, 1.15, z), vec3(1.9, 2.2, z + 0.1), p::YELLOW);
                    }
                    m.cuboid(vec3(1.8, 1.15, -1.15), vec3(1.9, 2.5, 1.15), p::YELLOW);
                    m.blob(vec3(-1.2, 1.5, 0.0), vec3(2.6, 0.9, 1.0), lod.min(3), 3, p::SOIL);
                }
                1 => {
                    let n = round(lod);
                    m.cone(vec3(-4.3, 2.5, 0.0), vec3(-2.2, 2.2, 0.0), 0.55, 1.2, n, p::WHITE);
                    m.cone(vec3(-2.2, 2.2, 0.0), vec3(0.3, 2.1, 0.0), 1.2, 1.15, n, p::ORANGE);
                    m.cone(vec3(0.3, 2.1, 0.0), vec3(1.7, 1.95, 0.0), 1.15, 0.5, n, p::WHITE);
                    m.bar(vec3(-4.4, 2.3, 0.0), vec3(-5.0, 1.2, 0.0), 0.5, 0.1, p::STEEL);
                }
                _ => {
                    m.cuboid(vec3(-4.3, 1.0, -1.22), vec3(2.0, 1.15, 1.22), p::TIMBER_OLD);
                    for i in 0..[2, 3, 4, 6, 8, 10][lod] {
                        let z = -0.95 + 0.2 * i as f32;
                        m.tube(vec3(-4.1, 1.25, z), vec3(1.6, 1.25, z), 0.09, sides(lod), p::STEEL);
                    }
                    m.cuboid(vec3(1.9, 1.15, -1.2), vec3(2.0, 2.3, 1.2), paint);
                }
            }
        })
    }

    /// An excavator looking along X.
    pub(super) fn excavator(&mut self) -> ShapeId {
        self.shape("excavator", &[], |lod, m| {
            for z in [-1.2, 0.7] {
                m.cuboid(vec3(-1.9, 0.0, z), vec3(1.9, 0.8, z + 0.5), p::RUBBER);
                for i in 0..[2, 3, 4, 6, 8, 10][lod] {
                    let x = -1.6 + 3.2 * i as f32 / 9.0;
                    m.cone(
                        vec3(x, 0.4, z - 0.04),
                        vec3(x, 0.4, z + 0.54),
                        0.3,
                        0.3,
                        round(lod),
                        p::STEEL_DARK,
                    );
                }
            }
            m.cuboid(vec3(-2.1, 0.95, -1.3), vec3(1.2, 1.9, 1.3), p::YELLOW);
            m.cuboid(vec3(-2.3, 1.0, -1.2), vec3(-2.1, 1.7, 1.2), p::BLACK);
            cabin(m, [-0.3, 1.3], [-0.2, 1.0], (1.9, 3.0), (0.5, 0.45), p::CAR_GLASS);
            m.bar(vec3(1.0, 1.7, -0.8), vec3(3.6, 4.3, -0.8), 0.45, 0.5, p::YELLOW);
            m.bar(vec3(3.5, 4.4, -0.8), vec3(5.4, 2.1, -0.8), 0.35, 0.4, p::YELLOW);
            m.tube(vec3(1.6, 1.7, -0.8), vec3(2.9, 3.2, -0.8), 0.12, round(lod), p::STEEL);
            m.cuboid(vec3(4.7, 1.0, -1.4), vec3(5.7, 2.0, -0.2), p::STEEL_DARK);
        })
    }

    /// A person in a safety vest.
    pub(super) fn worker(&mut self, kind: i32) -> ShapeId {
        self.shape("worker", &[kind % 3], move |lod, m| {
            let n = [5, 5, 6, 8, 10, 14][lod];
            let vest = [p::ORANGE, p::YELLOW, p::ORANGE][kind as usize % 3];
            for z in [-0.1, 0.1] {
                m.cone(vec3(0.0, 0.0, z), vec3(0.0, 0.85, z), 0.07, 0.09, n, p::JEANS);
                m.cone(vec3(0.02, 0.8, z * 2.6), vec3(0.0, 1.42, z * 2.2), 0.05, 0.06, n, vest);
            }
            m.cone(vec3(0.0, 0.82, 0.0), vec3(0.0, 1.46, 0.0), 0.17, 0.2, n, vest);
            m.blob(vec3(0.0, 1.6, 0.0), vec3(0.11, 0.13, 0.1), lod / 3, 5, p::SKIN);
            let helmet = [p::WHITE, p::YELLOW, p::CABIN_BLUE][kind as usize % 3];
            m.lathe(vec3(0.0, 1.64, 0.0), &[(0.15, 0.0), (0.13, 0.07), (0.0, 0.14)], n, helmet);
        })
    }

    /// A street lamp, its arm along +Z.
    pub(super) fn lamp(&mut self) -> ShapeId {
        self.shape("lamp", &[], |lod, m| {
            let n = [5, 6, 8, 10, 14, 20][lod];
            m.cone(vec3(0.0, -0.1, 0.0), vec3(0.0, 0.9, 0.0), 0.12, 0.1, n, p::STEEL_DARK);
            m.cone(vec3(0.0, 0.9, 0.0), vec3(0.0, 7.4, 0.0), 0.08, 0.05, n, p::STEEL_DARK);
            m.tube(vec3(0.0, 7.35, 0.0), vec3(0.0, 7.7, 1.6), 0.04, n, p::STEEL_DARK);
            m.cuboid(vec3(-0.12, 7.62, 1.3), vec3(0.12, 7.74, 2.1), p::STEEL_DARK);
            m.cuboid(vec3(-0.09, 7.6, 1.4), vec3(0.09, 7.62, 2.05), p::LUMINAIRE);
        })
    }

    /// One lattice section of a mast, standing on y = 0.
    pub(super) fn mast(&mut self, width: f32, height: f32, paint: Paint) -> ShapeId {
        self.shape("mast", &[mm(width), mm(height), paint.0.into()], move |lod, m| {
            let (w, chord) = (width * 0.5, width * 0.09);
            let corner = |i: usize, y: f32| vec3([-w, w, w, -w][i % 4], y, [w, w, -w, -w][i % 4]);
            let panels = [1, 1, 2, 3, 4, 5][lod];
            for i in 0..4 {
                m.tube(
                    corner(i, 0.0),
                    corner(i, height),
                    chord * 0.55,
                    sides(lod.saturating_sub(1)),
                    paint,
                );
                for k in 0..panels {
                    let (y0, y1) = (
                        height * k as f32 / panels as f32,
                        height * (k + 1) as f32 / panels as f32,
                    );
                    m.bar(corner(i, y0), corner(i + 1, y1), chord * 0.6, chord * 0.6, paint);
                    if lod >= 1 {
                        m.bar(
                            corner(i, y1 - 0.05),
                            corner(i + 1, y1 - 0.05),
                            chord * 0.6,
                            chord * 0.6,
                            paint,
                        );
                    }
                }
            }
        })
    }

    /// The turning part of a tower crane: cab, head, jib along +X, counter-jib, ropes and hook.
    pub(super) fn crane_top(&mut self, reach: f32, trolley: i32) -> ShapeId {
        self.shape("crane top", &[mm(reach), trolley], move |lod, m| {
            m.cone(Vec3::ZERO, vec3(0.0, 1.0, 0.0), 1.2, 1.2, round(lod), p::STEEL_DARK);
            m.cuboid(vec3(-0.9, 1.0, -0.9), vec3(0.9, 2.8, 0.9), p::CRANE);
            m.cuboid(vec3(0.5, 1.0, 1.0), vec3(2.2, 3.0, 2.2), p::WHITE);
            m.cuboid(vec3(0.9, 1.6, 1.05), vec3(2.25, 2.7, 2.25), p::CAR_GLASS);
            let head = vec3(-0.4, 10.5, 0.0);
            for (x, z) in [(-0.8, -0.8), (0.8, -0.8), (0.8, 0.8), (-0.8, 0.8)] {
                m.bar(vec3(x, 2.8, z), head, 0.16, 0.16, p::CRANE);
            }
            jib(m, reach, lod);
            m.bar(vec3(-1.0, 3.0, -0.6), vec3(-16.0, 3.0, -0.6), 0.25, 0.3, p::CRANE);
            m.bar(vec3(-1.0, 3.0, 0.6), vec3(-16.0, 3.0, 0.6), 0.25, 0.3, p::CRANE);
            m.cuboid(vec3(-15.8, 0.9, -1.1), vec3(-12.8, 3.3, 1.1), p::CONCRETE_LIGHT);
            m.cuboid(vec3(-9.0, 3.15, -0.9), vec3(-6.5, 4.5, 0.9), p::STEEL_DARK);
            for (x, y) in [(reach * 0.55, 4.5), (reach * 0.88, 4.2), (-14.5, 3.1)] {
                m.bar(head, vec3(x, y, 0.0), 0.09, 0.09, p::BLACK);
            }
            let x = reach * trolley as f32 * 0.01;
            m.cuboid(vec3(x - 0.9, 2.2, -0.8), vec3(x + 0.9, 2.7, 0.8), p::STEEL_DARK);
            for z in [-0.25, 0.25] {
                m.bar(vec3(x, 2.2, z), vec3(x, -8.0, z), 0.04, 0.04, p::BLACK);
            }
            m.cuboid(vec3(x - 0.35, -9.0, -0.35), vec3(x + 0.35, -8.0, 0.35), p::RED);
            if trolley % 2 == 1 {
                m.cuboid(vec3(x - 1.8, -11.6, -0.7), vec3(x + 1.8, -11.0, 0.7), p::STEEL);
                m.bar(vec3(x - 1.6, -11.0, 0.0), vec3(x, -9.0, 0.0), 0.04, 0.04, p::BLACK);
                m.bar(vec3(x + 1.6, -11.0, 0.0), vec3(x, -9.0, 0.0), 0.04, 0.04, p::BLACK);
            }
        })
    }

    /// A bay of scaffolding, `length` along X and 2 m high, outside at +Z.
    pub(super) fn scaffold(&mut self, length: f32, top: bool) -> ShapeId {
        self.shape("scaffold", &[mm(length), top.into()], move |lod, m| {
            let (l, n) = (length * 0.5, sides(lod));
            m.cuboid(vec3(-l + 0.03, 1.92, 0.05), vec3(l - 0.03, 1.97, 1.0), p::TIMBER);
            for z in [0.0, 1.05] {
                m.tube(vec3(-l, 0.0, z), vec3(-l, 2.0, z), 0.027, n, p::SCAFFOLD);
                m.tube(vec3(-l, 1.9, z), vec3(l, 1.9, z), 0.025, n.min(6), p::SCAFFOLD);
            }
            m.tube(vec3(-l, 1.86, 0.0), vec3(-l, 1.86, 1.05), 0.025, n.min(6), p::SCAFFOLD);
            if lod >= 1 {
                m.tube(vec3(-l, 0.0, 1.08), vec3(l, 1.9, 1.08), 0.022, n.min(6), p::SCAFFOLD);
            }
            let rails: &[f32] = if top { &[2.45, 2.95] } else { &[0.45, 0.95] };
            for y in rails {
                m.tube(vec3(-l, *y, 1.05), vec3(l, *y, 1.05), 0.022, n.min(6), p::SCAFFOLD);
            }
        })
    }
}

/// A glass house tapering upward: [x0, x1] below and above, heights, half widths.
fn cabin(
    m: &mut MeshBuilder,
    low: [f32; 2],
    high: [f32; 2],
    y: (f32, f32),
    w: (f32, f32),
    paint: Paint,
) {
    let ring = |x: [f32; 2], y: f32, w: f32| {
        [vec3(x[0], y, w), vec3(x[1], y, w), vec3(x[1], y, -w), vec3(x[0], y, -w)]
    };
    let (a, b) = (ring(low, y.0, w.0), ring(high, y.1, w.1));
    for i in 0..4 {
        let j = (i + 1) % 4;
        m.quad([a[i], a[j], b[j], b[i]], paint);
    }
    m.quad(b, paint);
}

fn wheels(m: &mut MeshBuilder, axles: &[f32], half: f32, radius: f32, lod: usize) {
    for x in axles {
        for z in [-half - 0.02, half - 0.2] {
            m.cone(
                vec3(*x, radius, z),
                vec3(*x, radius, z + 0.22),
                radius,
                radius,
                round(lod),
                p::RUBBER,
            );
            if lod >= 3 {
                m.cone(
                    vec3(*x, radius, z - 0.01),
                    vec3(*x, radius, z + 0.23),
                    radius * 0.5,
                    radius * 0.5,
                    round(lod),
                    p::STEEL,
                );
            }
        }
    }
}

/// The triangular lattice of a crane's jib along +X.
fn jib(m: &mut MeshBuilder, reach: f32, lod: usize) {
    let rail = |x: f32, k: usize| [vec3(x, 2.8, -0.75), vec3(x, 2.8, 0.75), vec3(x, 4.2, 0.0)][k];
    for k in 0..3 {
        m.bar(rail(1.0, k), rail(reach, k), 0.16, 0.16, p::CRANE);
    }
    let panels = [8, 12, 18, 24, 30, 36][lod];
    let x = |i: usize| 1.0 + (reach - 1.0) * i as f32 / panels as f32;
    for i in 0..panels {
        let middle = (x(i) + x(i + 1)) * 0.5;
        for k in 0..2 {
            m.bar(rail(x(i), k), rail(middle, 2), 0.08, 0.08, p::CRANE);
            m.bar(rail(middle, 2), rail(x(i + 1), k), 0.08, 0.08, p::CRANE);
        }
        m.bar(rail(x(i), 0), rail(x(i + 1), 1), 0.07, 0.07, p::CRANE);
    }
}
