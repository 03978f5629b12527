//! Shapes of building parts. Each has `LODS` tessellations; round parts get more sides, fittings get
//! the details that one sees close up.

use super::builder::{Builder, ShapeId, mm};
use super::mesh::MeshBuilder;
use super::palette::{self as p, Paint};
use glam::{Vec3, vec3};

/// Sides of a thin round part by tessellation; below 5 it is drawn square.
pub(super) fn sides(lod: usize) -> usize {
    [4, 4, 6, 8, 12, 18][lod]
}

impl Builder {
    /// A box of 1 x 1 x 1, x and z about 0, standing on y = 0.
    pub(super) fn unit_box(&mut self, paint: Paint) -> ShapeId {
        self.shape("box", &[paint.0.into()], move |_, m| {
            m.cuboid(vec3(-0.5, 0.0, -0.5), vec3(0.5, 1.0, 0.5), paint);
        })
    }

    /// An upright column of 1 x 1 x 1 with chamfered corners.
    pub(super) fn unit_column(&mut self, paint: Paint) -> ShapeId {
        self.shape("column", &[paint.0.into()], move |lod, m| match lod {
            0 => m.cuboid(vec3(-0.5, 0.0, -0.5), vec3(0.5, 1.0, 0.5), paint),
            _ => {
                let c = 0.5 - 0.06;
                let corners = [
                    (c, 0.5),
                    (0.5, c),
                    (0.5, -c),
                    (c, -0.5),
                    (-c, -0.5),
                    (-0.5, -c),
                    (-0.5, c),
                    (-c, 0.5),
                ];
                m.prism(&corners, 0.0, 1.0, paint);
            }
        })
    }

    /// An upright round bar of radius 1 and length 1.
    pub(super) fn unit_round(&mut self, paint: Paint) -> ShapeId {
        self.shape("round", &[paint.0.into()], move |lod, m| {
            m.cone(Vec3::ZERO, Vec3::Y, 1.0, 1.0, [6, 8, 12, 16, 24, 36][lod], paint);
        })
    }

    /// A lying pipe along X with collars at its ends.
    pub(super) fn pipe(&mut self, length: f32, radius: f32, paint: Paint) -> ShapeId {
        self.shape("pipe", &[mm(length), mm(radius), paint.0.into()], move |lod, m| {
            let half = vec3(length * 0.5, 0.0, 0.0);
            m.tube(-half, half, radius, sides(lod), paint);
            for i in 0..[0, 0, 1, 2, 3, 4][lod] {
                let x = -length * 0.5 + length * (i as f32 + 0.5) / lod.max(2) as f32;
                m.tube(
                    vec3(x - 0.03, 0.0, 0.0),
                    vec3(x + 0.03, 0.0, 0.0),
                    radius * 1.35,
                    sides(lod),
                    p::STEEL,
                );
                m.bar(vec3(x, radius, 0.0), vec3(x, radius + 0.22, 0.0), 0.012, 0.012, p::STEEL);
            }
        })
    }

    /// A bar lying along X, its top at y = 0, with chamfered lower edges.
    pub(super) fn beam(&mut self, length: f32, width: f32, depth: f32, paint: Paint) -> ShapeId {
        self.shape("beam", &[mm(length), mm(width), mm(depth), paint.0.into()], move |lod, m| {
            let (l, w) = (length * 0.5, width * 0.5);
            if lod < 2 {
                return m.cuboid(vec3(-l, -depth, -w), vec3(l, 0.0, w), paint);
            }
            let c = 0.05;
            // The outline in (z, y), counter-clockwise seen from +X.
            let outline = [
                (w, 0.0),
                (-w, 0.0),
                (-w, c - depth),
                (c - w, -depth),
                (w - c, -depth),
                (w, c - depth),
            ];
            let points = |x: f32| outline.map(|(z, y)| vec3(x, y, z));
            let (near, far) = (points(-l), points(l));
            for i in 0..6 {
                let j = (i + 1) % 6;
                m.quad([near[j], near[i], far[i], far[j]], paint);
            }
            m.fan(&near, paint);
            m.fan(&[far[0], far[5], far[4], far[3], far[2], far[1]], paint);
            if lod >= 4 {
                m.cuboid(vec3(-l, -depth + 0.1, -w - 0.06), vec3(-l + 0.4, -0.1, w + 0.06), paint);
                m.cuboid(vec3(l - 0.4, -depth + 0.1, -w - 0.06), vec3(l, -0.1, w + 0.06), paint);
            }
        })
    }

    /// A wall along X with a doorway in its middle.
    pub(super) fn door_wall(
        &mut self,
        width: f32,
        height: f32,
        thickness: f32,
        door: (f32, f32),
        paint: Paint,
    ) -> ShapeId {
        let key = [mm(width), mm(height), mm(thickness), mm(door.0), mm(door.1), paint.0.into()];
        self.shape("door wall", &key, move |_, m| {
            m.wall(width, height, thickness, [-door.0 * 0.5, 0.0, door.0 * 0.5, door.1], paint);
        })
    }

    /// A door in its frame, centred in x, standing on y = 0.
    pub(super) fn door(&mut self, width: f32, height: f32, leaf: Paint) -> ShapeId {
        self.shape("door", &[mm(width), mm(height), leaf.0.into()], move |lod, m| {
            let w = width * 0.5;
            m.cuboid(vec3(-w + 0.06, 0.01, -0.03), vec3(w - 0.06, height - 0.06, 0.03), leaf);
            if lod >= 1 {
                m.cuboid(vec3(-w, 0.0, -0.09), vec3(-w + 0.06, height, 0.09), p::ALU_DARK);
                m.cuboid(vec3(w - 0.06, 0.0, -0.09), vec3(w, height, 0.09), p::ALU_DARK);
                m.cuboid(
                    vec3(-w + 0.06, height - 0.06, -0.09),
                    vec3(w - 0.06, height, 0.09),
                    p::ALU_DARK,
                );
            }
            if lod >= 2 {
                for z in [-0.07, 0.07] {
                    m.tube(
                        vec3(w - 0.22, 1.05, z),
                        vec3(w - 0.12, 1.05, z),
                        0.012,
                        sides(lod),
                        p::STEEL,
                    );
                }
            }
        })
    }

    /// A flight of stairs rising along +Z from the origin, `width` along X.
    pub(super) fn flight(&mut self, width: f32, rise: f32, run: f32, steps: i32) -> ShapeId {
        self.shape("flight", &[mm(width), mm(rise), mm(run), steps], move |lod, m| {
            let (r, t, w) = (rise / steps as f32, run / steps as f32, width * 0.5);
            for i in 0..steps {
                let (y, z) = (r * i as f32, t * i as f32);
                m.cuboid(vec3(-w, y - 0.12, z), vec3(w, y + r, z + t), p::CONCRETE_LIGHT);
                if lod >= 3 {
                    m.cuboid(
                        vec3(-w + 0.05, y + r, z + 0.01),
                        vec3(w - 0.05, y + r + 0.012, z + 0.06),
                        p::RUBBER,
                    );
                }
            }
        })
    }

    /// A railing rising along +Z beside a flight (`rise` 0: level), with posts and rails.
    pub(super) fn railing(&mut self, rise: f32, run: f32, posts: i32, paint: Paint) -> ShapeId {
        self.shape("railing", &[mm(rise), mm(run), posts, paint.0.into()], move |lod, m| {
            let point = |share: f32, y: f32| vec3(0.0, rise * share + y, run * share);
            for i in 0..posts {
                let share = (i as f32 + 0.5) / posts as f32;
                m.tube(point(share, 0.0), point(share, 1.0), 0.02, sides(lod), paint);
            }
            m.tube(point(0.0, 1.02), point(1.0, 1.02), 0.03, sides(lod), paint);
            for k in 1..[1, 2, 3, 4, 5, 6][lod] {
                let y = k as f32 / lod as f32 * 0.85 + 0.05;
                m.tube(point(0.0, y), point(1.0, y), 0.01, sides(lod.min(3)), paint);
            }
        })
    }

    /// A glass panel `width` x `height` in the XY plane, centred in x, standing on y = 0.
    pub(super) fn glass_panel(
        &mut self,
        width: f32,
        height: f32,
        glass: Paint,
        frame: Paint,
    ) -> ShapeId {
        let key = [mm(width), mm(height), glass.0.into(), frame.0.into()];
        self.shape("glass", &key, move |lod, m| {
            let (w, f) = (width * 0.5, 0.045);
            m.cuboid(vec3(-w + 0.01, 0.01, -0.015), vec3(w - 0.01, height - 0.01, 0.015), glass);
            if lod >= 2 {
                for x in [-w, w - f] {
                    m.cuboid(vec3(x, 0.0, -0.04), vec3(x + f, height, 0.03), frame);
                }
                for y in [0.0, height - f] {
                    m.cuboid(vec3(-w + f, y, -0.04), vec3(w - f, y + f, 0.03), frame);
                }
            }
            if lod >= 4 {
                for (x, y) in
                    [(-w + 0.15, 0.0), (w - 0.15, 0.0), (-w + 0.15, height), (w - 0.15, height)]
                {
                    m.block(vec3(x, y - 0.04, -0.09), vec3(0.12, 0.08, 0.08), p::STEEL);
                }
            }
        })
    }

    /// A closed facade panel with ribs, centred in x, standing on y = 0.
    pub(super) fn spandrel(&mut self, width: f32, height: f32, paint: Paint) -> ShapeId {
        self.shape("spandrel", &[mm(width), mm(height), paint.0.into()], move |lod, m| {
            let w = width * 0.5 - 0.01;
            m.cuboid(vec3(-w, 0.0, -0.06), vec3(w, height, 0.04), paint);
            for i in 0..[0, 0, 1, 2, 3, 4][lod] {
                let y = height * (i as f32 + 0.5) / [1.0, 1.0, 1.0, 2.0, 3.0, 4.0][lod];
                m.cuboid(vec3(-w, y - 0.025, 0.04), vec3(w, y + 0.025, 0.07), paint);
            }
        })
    }

    /// A panel of slanting blades, centred in x, standing on y = 0.
    pub(super) fn louvre(&mut self, width: f32, height: f32) -> ShapeId {
        self.shape("louvre", &[mm(width), mm(height)], move |lod, m| {
            let w = width * 0.5 - 0.01;
            m.cuboid(vec3(-w, 0.0, -0.09), vec3(w, height, -0.05), p::ALU_DARK);
            let blades = [3, 5, 8, 11, 14, 18][lod];
            for i in 0..blades {
                let y = height * (i as f32 + 0.3) / blades as f32;
                m.bar(vec3(-w, y, 0.0), vec3(w, y, 0.0), 0.10, 0.03, p::LOUVRE);
            }
        })
    }

    /// A mullion with an outer fin of depth `fin`, 1 m high (scale it), at x = 0, outside at +Z.
    pub(super) fn mullion(&mut self, fin: f32, paint: Paint) -> ShapeId {
        self.shape("mullion", &[mm(fin), paint.0.into()], move |lod, m| {
            if lod == 0 {
                return m.cuboid(vec3(-0.035, 0.0, -0.12), vec3(0.035, 1.0, 0.05 + fin), paint);
            }
            m.cuboid(vec3(-0.035, 0.0, -0.14), vec3(0.035, 1.0, 0.06), p::ALU_DARK);
            m.cuboid(vec3(-0.022, 0.0, 0.06), vec3(0.022, 1.0, 0.06 + fin), paint);
            if lod >= 3 {
                m.cuboid(vec3(-0.05, 0.0, 0.06 + fin), vec3(0.05, 1.0, 0.085 + fin), paint);
            }
        })
    }

    /// A transom along X, 1 m long (scale it), at y = 0.
    pub(super) fn transom(&mut self) -> ShapeId {
        self.shape("transom", &[], move |lod, m| {
            m.cuboid(vec3(-0.5, -0.03, -0.13), vec3(0.5, 0.03, 0.05), p::ALU_DARK);
            if lod >= 1 {
                m.cuboid(vec3(-0.5, -0.045, 0.05), vec3(0.5, 0.045, 0.09), p::ALU);
            }
        })
    }

    /// A radiator with fins below a window, centred in x.
    pub(super) fn radiator(&mut self) -> ShapeId {
        self.shape("radiator", &[], move |lod, m| {
            m.cuboid(vec3(-0.6, 0.12, -0.03), vec3(0.6, 0.58, 0.0), p::WHITE);
            let fins = [0, 3, 6, 10, 16, 24][lod];
            for i in 0..fins {
                let x = -0.58 + 1.16 * (i as f32 + 0.5) / fins as f32;
                m.cuboid(vec3(x - 0.012, 0.13, 0.0), vec3(x + 0.012, 0.57, 0.05), p::WHITE);
            }
            if lod >= 2 {
                m.tube(
                    vec3(0.55, 0.0, -0.015),
                    vec3(0.55, 0.12, -0.015),
                    0.012,
                    sides(lod),
                    p::COPPER,
                );
                m.tube(
                    vec3(0.5, 0.0, -0.015),
                    vec3(0.5, 0.12, -0.015),
                    0.012,
                    sides(lod),
                    p::COPPER,
                );
            }
        })
    }

    /// A sprinkler head hanging from y = 0.
    pub(super) fn sprinkler(&mut self) -> ShapeId {
        self.shape("sprinkler", &[], move |lod, m| {
            let n = [5, 6, 8, 10, 14, 20][lod];
            m.lathe(
                Vec3::ZERO,
                &[(0.0, -0.09), (0.045, -0.085), (0.014, -0.06), (0.018, 0.0)],
                n,
                p::STEEL,
            );
        })
    }

    /// A duct along X with flanges, `w` x `h` in section, its middle at 0.
    pub(super) fn duct(&mut self, length: f32, w: f32, h: f32) -> ShapeId {
        self.shape("duct", &[mm(length), mm(w), mm(h)], move |lod, m| {
            let l = length * 0.5;
            m.cuboid(vec3(-l, -h * 0.5, -w * 0.5), vec3(l, h * 0.5, w * 0.5), p::DUCT);
            let flanges = [0, 1, 2, 4, 6, 9][lod];
            for i in 0..flanges {
                let x = -l + length * (i as f32 + 0.5) / flanges as f32;
                m.cuboid(
                    vec3(x - 0.02, -h * 0.5 - 0.03, -w * 0.5 - 0.03),
                    vec3(x + 0.02, h * 0.5 + 0.03, w * 0.5 + 0.03),
                    p::STEEL,
                );
            }
        })
    }

    /// A cable tray along X with rungs and cables.
    pub(super) fn tray(&mut self, length: f32) -> ShapeId {
        self.shape("tray", &[mm(length)], move |lod, m| {
            let l = length * 0.5;
            m.cuboid(vec3(-l, 0.0, -0.15), vec3(l, 0.01, 0.15), p::TRAY);
            m.cuboid(vec3(-l, 0.0, -0.165), vec3(l, 0.06, -0.15), p::TRAY);
            m.cuboid(vec3(-l, 0.0, 0.15), vec3(l, 0.06, 0.165), p::TRAY);
            for i in 0..[0, 1, 2, 3, 5, 7][lod] {
                let z = -0.12 + 0.04 * i as f32;
                m.tube(vec3(-l, 0.025, z), vec3(l, 0.025, z), 0.015, sides(lod), p::BLACK);
            }
        })
    }

    /// A small ceiling fitting below y = 0: luminaire, smoke detector, diffuser or loudspeaker.
    pub(super) fn fitting(&mut self, kind: usize) -> ShapeId {
        self.shape("fitting", &[kind as i32], move |lod, m| fitting(kind, lod, m))
    }

    /// A desk with a screen and a chair.
    pub(super) fn desk(&mut self) -> ShapeId {
        self.shape("desk", &[], move |lod, m| {
            m.cuboid(vec3(-0.8, 0.71, -0.4), vec3(0.8, 0.74, 0.4), p::PARQUET);
            if lod >= 1 {
                for x in [-0.75, 0.72] {
                    m.cuboid(vec3(x, 0.0, -0.36), vec3(x + 0.03, 0.71, 0.36), p::WHITE);
                }
                m.cuboid(vec3(-0.3, 0.85, -0.25), vec3(0.3, 1.2, -0.23), p::BLACK);
            }
            if lod >= 2 {
                m.cuboid(vec3(-0.03, 0.74, -0.27), vec3(0.03, 0.9, -0.25), p::STEEL);
                m.cuboid(vec3(-0.24, 0.44, 0.5), vec3(0.24, 0.5, 0.95), p::CABIN_BLUE);
                m.cuboid(vec3(-0.22, 0.5, 0.92), vec3(0.22, 0.95, 0.97), p::CABIN_BLUE);
                m.tube(vec3(0.0, 0.05, 0.72), vec3(0.0, 0.44, 0.72), 0.03, sides(lod), p::STEEL);
            }
        })
    }
}

fn fitting(kind: usize, lod: usize, m: &mut MeshBuilder) {
    let n = [5, 6, 8, 10, 14, 20][lod];
    match kind {
        0 => {
            m.cuboid(vec3(-0.6, -0.05, -0.15), vec3(0.6, 0.0, 0.15), p::WHITE);
            m.cuboid(vec3(-0.56, -0.065, -0.11), vec3(0.56, -0.05, 0.11), p::LUMINAIRE);
            for i in 0..[0, 0, 2, 4, 7, 11][lod] {
                let x = -0.5 + i as f32 * 0.09;
                m.cuboid(vec3(x, -0.085, -0.11), vec3(x + 0.01, -0.065, 0.11), p::ALU);
            }
        }
        1 => m.lathe(
            Vec3::ZERO,
            &[(0.0, -0.07), (0.035, -0.065), (0.06, -0.03), (0.055, 0.0)],
            n,
            p::WHITE,
        ),
        2 => {
            m.cuboid(vec3(-0.3, -0.02, -0.3), vec3(0.3, 0.0, 0.3), p::WHITE);
            for i in 0..[1, 1, 2, 3, 4, 5][lod] {
                let r = 0.26 - 0.05 * i as f32;
                let hole = r - 0.02;
                m.ring([-r, -r, r, r], [-hole, -hole, hole, hole], -0.045, -0.02, p::ALU);
            }
        }
        _ => m.lathe(
            Vec3::ZERO,
            &[(0.0, -0.03), (0.08, -0.035), (0.11, -0.01), (0.11, 0.0)],
            n,
            p::ALU,
        ),
    }
}
