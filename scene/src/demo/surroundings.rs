//! The town around the plot: ground, streets, pavements, houses, trees, cars, lamps.

use super::builder::{Builder, Tag, Zone, at, mm, placed};
use super::design::Side;
use super::palette::{self as p, Paint};
use glam::{Vec3, vec3};

const GROUND: Tag = Tag("GND", "IfcGeographicElement");
const ROAD: Tag = Tag("RDM", "IfcGeographicElement");
const HOUSE: Tag = Tag("HSE", "IfcBuilding");
const WINDOWS: Tag = Tag("HWN", "IfcWindow");
const ROOF: Tag = Tag("HRF", "IfcRoof");
const TREE: Tag = Tag("TRE", "IfcGeographicElement");
const CAR: Tag = Tag("CAR", "IfcBuildingElementProxy");
const LAMP: Tag = Tag("LMP", "IfcLightFixture");

/// Width of the pavement around the plot, of the streets, and of the blocks beyond, metres.
const PAVEMENT: f32 = 4.0;
const STREET: f32 = 15.0;
const BLOCK: f32 = 76.0;
/// Road surface below the pavements' top, metres.
const KERB: f32 = 0.14;

type Rectangle = [f32; 4];

/// Adds everything that stays.
pub(super) fn add(b: &mut Builder) {
    let plot = b.design.plot();
    let own = grown(plot, PAVEMENT);
    let far = grown(own, STREET + BLOCK);
    ground(b, plot, own, far);
    let (xs, zs) = (bands(own[0], own[2], far[0], far[2]), bands(own[1], own[3], far[1], far[3]));
    for (i, x) in xs.iter().enumerate() {
        for (j, z) in zs.iter().enumerate() {
            if (i, j) != (1, 1) {
                block(b, [x.0, z.0, x.1, z.1]);
            }
        }
    }
    street_life(b, own, far);
}

fn grown(r: Rectangle, by: f32) -> Rectangle {
    [r[0] - by, r[1] - by, r[2] + by, r[3] + by]
}

/// The block before, the own plot, and the block behind, along one axis.
fn bands(a: f32, b: f32, from: f32, to: f32) -> [(f32, f32); 3] {
    [(from, a - STREET), (a, b), (b + STREET, to)]
}

/// A flat plate with its top at `top`.
fn plate(b: &mut Builder, tag: Tag, r: Rectangle, top: f32, thickness: f32, paint: Paint) {
    let shape = b.unit_box(paint);
    let centre = vec3((r[0] + r[2]) * 0.5, top - thickness, (r[1] + r[3]) * 0.5);
    let place = placed(centre, 0, vec3(r[2] - r[0], thickness, r[3] - r[1]));
    b.add(tag, Zone::Surroundings, 0, shape, place, &[]);
}

/// A plate around a hole.
fn frame(
    b: &mut Builder,
    outer: Rectangle,
    hole: Rectangle,
    top: f32,
    thickness: f32,
    paint: Paint,
    name: &'static str,
) {
    let shape = b.shape(name, &[], move |_, m| m.ring(outer, hole, top - thickness, top, paint));
    b.add(GROUND, Zone::Surroundings, 0, shape, at(0.0, 0.0, 0.0), &[]);
}

/// The pit that the basement fills, without its retaining walls.
pub(super) fn pit(b: &Builder) -> Rectangle {
    grown(b.design.podium_outline(), 1.0)
}

fn ground(b: &mut Builder, plot: Rectangle, own: Rectangle, far: Rectangle) {
    let hole = grown(pit(b), 0.9);
    frame(b, far, hole, -KERB, 2.0, p::ASPHALT, "ground");
    frame(b, plot, hole, 0.0, KERB - 0.01, p::SOIL, "plot");
    frame(b, own, plot, 0.02, KERB + 0.01, p::PAVING, "pavement");
    frame(b, grown(own, 0.3), own, 0.04, KERB + 0.02, p::KERB, "kerb");
    // Dashes along the middle of the four streets around the plot.
    let centre = grown(own, STREET * 0.5);
    let dash = b.unit_box(p::MARKING);
    let count = ((centre[2] - centre[0]) / 9.0) as i32;
    for k in 0..count {
        let share = (k as f32 + 0.5) / count as f32;
        let (x, z) = (
            centre[0] + (centre[2] - centre[0]) * share,
            centre[1] + (centre[3] - centre[1]) * share,
        );
        for z in [centre[1], centre[3]] {
            b.add(
                ROAD,
                Zone::Surroundings,
                0,
                dash,
                placed(vec3(x, -KERB, z), 0, vec3(3.0, 0.015, 0.18)),
                &[],
            );
        }
        for x in [centre[0], centre[2]] {
            b.add(
                ROAD,
                Zone::Surroundings,
                0,
                dash,
                placed(vec3(x, -KERB, z), 1, vec3(3.0, 0.015, 0.18)),
                &[],
            );
        }
        if b.design.wealth < 0.1 && k >= 2 {
            break;
        }
    }
}

/// A block of houses, or a small park.
fn block(b: &mut Builder, r: Rectangle) {
    plate(b, GROUND, r, 0.0, KERB - 0.005, p::PAVING);
    let rich = b.design.wealth.min(1.0);
    let lot = 25.0 + 50.0 * (1.0 - rich);
    let inner = grown(r, -4.5);
    let (w, d) = (inner[2] - inner[0], inner[3] - inner[1]);
    let (nx, nz) = ((w / lot).round().max(1.0) as i32, (d / (lot + 4.0)).round().max(1.0) as i32);
    let (lw, ld) = (w / nx as f32, d / nz as f32);
    let park = b.random.below(5) == 0;
    if park {
        plate(b, GROUND, grown(inner, 1.5), 0.03, 0.02, p::GRASS);
        park_trees(b, inner, (30.0 * rich) as usize + 2);
        return;
    }
    plate(b, GROUND, grown(inner, -lot * 0.3), 0.03, 0.02, p::GRASS);
    for i in 0..nx {
        for j in 0..nz {
            let inside = 0 < i && i < nx - 1 && 0 < j && j < nz - 1;
            if inside || b.random.below(9) == 0 {
                continue;
            }
            let x = inner[0] + lw * (i as f32 + 0.5);
            let z = inner[1] + ld * (j as f32 + 0.5);
            let (hw, hd) =
                ((lw * 0.5 - 0.4).min(22.0), (ld * 0.5 - b.random.between(1.0, 4.0)).min(22.0));
            house(b, vec3(x, 0.0, z), hw, hd);
        }
    }
}

fn park_trees(b: &mut Builder, r: Rectangle, count: usize) {
    for k in 0..count {
        let x = b.random.between(r[0], r[2]);
        let z = b.random.between(r[1], r[3]);
        let scale = b.random.between(0.9, 1.6);
        tree(b, vec3(x, 0.03, z), k as i32, scale);
    }
}

pub(super) fn tree(b: &mut Builder, position: Vec3, kind: i32, scale: f32) {
    let shape = b.tree(kind);
    let quarter = b.random.below(4) as u8;
    b.add(TREE, Zone::Surroundings, 0, shape, placed(position, quarter, Vec3::splat(scale)), &[]);
}

const STOREY: f32 = 3.3;
const WINDOW: f32 = 2.6;

/// A house of half width `hw` and half depth `hd`: body, windows on four sides, roof.
fn house(b: &mut Builder, position: Vec3, hw: f32, hd: f32) {
    let colours = [p::HOUSE_CREAM, p::HOUSE_GREY, p::HOUSE_SAND, p::HOUSE_BRICK, p::HOUSE_WHITE];
    let paint = colours[b.random.below(colours.len())];
    let storeys = 4 + b.random.below(5) as i32 + if b.random.below(6) == 0 { 6 } else { 0 };
    let height = storeys as f32 * STOREY + 1.2;
    let (hw, hd) = ((hw * 4.0).round() / 4.0, (hd * 4.0).round() / 4.0);
    let body = b.shape("house", &[mm(hw), mm(hd), mm(height), paint.0.into()], move |lod, m| {
        m.cuboid(vec3(-hw, -0.1, -hd), vec3(hw, height, hd), paint);
        if lod >= 1 {
            m.cuboid(
                vec3(-hw - 0.12, -0.1, -hd - 0.12),
                vec3(hw + 0.12, 0.9, hd + 0.12),
                p::PAVING_DARK,
            );
            m.cuboid(
                vec3(-hw - 0.3, height - 0.5, -hd - 0.3),
                vec3(hw + 0.3, height - 0.1, hd + 0.3),
                p::CONCRETE_LIGHT,
            );
        }
        if lod >= 2 {
            m.cuboid(
                vec3(-hw - 0.1, STOREY + 0.4, -hd - 0.1),
                vec3(hw + 0.1, STOREY + 0.6, hd + 0.1),
                p::CONCRETE_LIGHT,
            );
        }
    });
    b.add(HOUSE, Zone::Surroundings, 0, body, at(position.x, 0.0, position.z), &[]);
    for side in Side::ALL {
        let (dx, dz) = side.step();
        let half = if dx == 0 { hw } else { hd };
        let columns = ((half * 2.0 - 1.0) / WINDOW) as i32;
        let windows = windows(b, columns, storeys);
        let out = vec3(dx as f32 * hw, 0.0, dz as f32 * hd);
        b.add(
            WINDOWS,
            Zone::Surroundings,
            0,
            windows,
            placed(position + out, side.quarter(), Vec3::ONE),
            &[],
        );
    }
    roof(b, position, hw, hd, height);
}

/// All windows of a house's side, outside at +Z.
fn windows(b: &mut Builder, columns: i32, storeys: i32) -> super::builder::ShapeId {
    b.shape("windows", &[columns, storeys], move |lod, m| {
        for s in 0..storeys {
            let y = 1.3 + s as f32 * STOREY;
            if lod == 0 {
                let w = columns as f32 * WINDOW * 0.5 - 0.6;
                m.cuboid(vec3(-w, y, -0.02), vec3(w, y + 1.6, 0.03), p::WINDOW);
                continue;
            }
            for c in 0..columns {
                let x = (c as f32 + 0.5 - columns as f32 * 0.5) * WINDOW;
                if lod == 1 {
                    m.quad(
                        [
                            vec3(x - 0.6, y, 0.03),
                            vec3(x + 0.6, y, 0.03),
                            vec3(x + 0.6, y + 1.7, 0.03),
                            vec3(x - 0.6, y + 1.7, 0.03),
                        ],
                        p::WINDOW,
                    );
                    continue;
                }
                m.cuboid(vec3(x - 0.6, y, -0.02), vec3(x + 0.6, y + 1.7, 0.03), p::WINDOW);
                if lod >= 2 {
                    m.cuboid(
                        vec3(x - 0.75, y - 0.12, -0.02),
                        vec3(x + 0.75, y - 0.01, 0.16),
                        p::CONCRETE_LIGHT,
                    );
                }
                if lod >= 4 {
                    m.cuboid(vec3(x - 0.03, y, 0.03), vec3(x + 0.03, y + 1.7, 0.05), p::WHITE);
                    m.cuboid(
                        vec3(x - 0.75, y + 1.71, -0.02),
                        vec3(x + 0.75, y + 1.85, 0.1),
                        p::CONCRETE_LIGHT,
                    );
                }
            }
        }
    })
}

fn roof(b: &mut Builder, position: Vec3, hw: f32, hd: f32, height: f32) {
    let kind = b.random.below(3) as i32;
    let shape = b.shape("house roof", &[mm(hw), mm(hd), kind], move |lod, m| {
        let (w, d) = (hw - 0.1, hd - 0.1);
        if kind == 0 {
            m.cuboid(vec3(-w, 0.0, -d), vec3(w, 0.12, d), p::GRAVEL);
            m.cuboid(vec3(-w * 0.3, 0.12, -d * 0.3), vec3(w * 0.1, 2.6, d * 0.2), p::ZINC);
            for i in 0..[0, 1, 2, 3, 4, 5][lod] {
                m.block(
                    vec3(w * 0.35 + i as f32 * 0.9, 0.12, d * 0.3),
                    vec3(0.7, 1.0, 1.3),
                    p::STEEL,
                );
            }
            return;
        }
        let (rise, inset) = if kind == 1 { (2.2, 2.2) } else { (3.6, 4.2) };
        let paint = if kind == 1 { p::ZINC } else { p::ROOF_TILE };
        let ring = |w: f32, d: f32, y: f32| {
            [vec3(-w, y, d), vec3(w, y, d), vec3(w, y, -d), vec3(-w, y, -d)]
        };
        let (low, high) =
            (ring(w + 0.2, d + 0.2, 0.0), ring((w - inset).max(0.5), (d - inset).max(0.5), rise));
        for i in 0..4 {
            let j = (i + 1) % 4;
            m.quad([low[i], low[j], high[j], high[i]], paint);
        }
        m.quad(high, p::ZINC);
        m.block(vec3(w * 0.4, rise * 0.3, 0.0), vec3(0.8, rise + 0.6, 1.4), p::BRICK_DARK);
    });
    b.add(ROOF, Zone::Surroundings, 0, shape, at(position.x, height + 0.01, position.z), &[]);
}

/// Trees, lamps and cars along the streets around the plot.
fn street_life(b: &mut Builder, own: Rectangle, far: Rectangle) {
    let rich = b.design.wealth.min(1.4);
    let lamp = b.lamp();
    let outer = grown(own, STREET + 1.6);
    let cars = [p::CAR_RED, p::CAR_BLUE, p::CAR_SILVER, p::CAR_BLACK, p::WHITE].map(|c| b.car(c));
    for side in Side::ALL {
        let (dx, dz) = side.step();
        let length = if dx == 0 { outer[2] - outer[0] } else { outer[3] - outer[1] };
        let middle = vec3((outer[0] + outer[2]) * 0.5, 0.0, (outer[1] + outer[3]) * 0.5);
        let half = vec3((outer[2] - outer[0]) * 0.5, 0.0, (outer[3] - outer[1]) * 0.5);
        let out = vec3(dx as f32, 0.0, dz as f32);
        let line = |share: f32, inward: f32| {
            let along = vec3(dz as f32, 0.0, -dx as f32) * (share - 0.5) * length;
            middle + out * (half.dot(out.abs()) - inward) + along
        };
        let trees = (12.0 * rich) as i32 + 1;
        for k in 0..trees {
            let jitter = b.random.between(-0.02, 0.02);
            let scale = b.random.between(0.85, 1.25);
            let kind = b.random.below(3) as i32;
            tree(b, line((k as f32 + 0.5) / trees as f32 + jitter, 0.0), kind, scale);
        }
        let lamps = (6.0 * rich) as i32 + 1;
        for k in 0..lamps {
            let place = placed(
                line((k as f32 + 1.0) / (lamps as f32 + 1.0), 1.0),
                (side.quarter() + 2) % 4,
                Vec3::ONE,
            );
            b.add(LAMP, Zone::Surroundings, 0, lamp, place, &[]);
        }
        for (lane, quarter) in [(5.2, 1), (12.6, 3)] {
            for k in 0..(7.0 * rich) as i32 + 1 {
                let share = (k as f32 + b.random.between(0.1, 0.9)) / ((7.0 * rich) + 1.0);
                let car = cars[b.random.below(cars.len())];
                let place = line(share, lane) - vec3(0.0, KERB, 0.0);
                b.add(
                    CAR,
                    Zone::Surroundings,
                    0,
                    car,
                    placed(place, (side.quarter() + quarter + 1) % 4, Vec3::ONE),
                    &[],
                );
            }
        }
    }
    // Cars parked along the streets that leave the picture.
    for k in 0..(28.0 * rich) as i32 {
        let x = [own[0] - STREET + 1.4, own[2] + STREET - 1.4][(k % 2) as usize];
        let z = if k % 4 < 2 {
            b.random.between(far[1] + 3.0, own[1] - 24.0)
        } else {
            b.random.between(own[3] + 24.0, far[3] - 3.0)
        };
        let z = (z / 6.2).round() * 6.2 + [0.0, 0.4][(k % 2) as usize];
        let car = cars[b.random.below(cars.len())];
        if k / 4 % 2 == 0 {
            b.add(CAR, Zone::Surroundings, 0, car, placed(vec3(x, -KERB, z), 1, Vec3::ONE), &[]);
        }
    }
}
