//! Everything on the plot that is not the tower: the old building, earthworks, foundations, the new
//! square, and the street furniture that comes and goes.

use super::builder::{Builder, Tag, WorkId, Zone, at, mm, placed};
use super::design::Side;
use super::palette as p;
use super::programme::Work;
use super::surroundings::pit;
use glam::{Vec3, vec3};

const OLD_WALL: Tag = Tag("OWL", "IfcWall");
const OLD_WINDOW: Tag = Tag("OWN", "IfcWindow");
const OLD_SLAB: Tag = Tag("OSL", "IfcSlab");
const OLD_ROOF: Tag = Tag("ORF", "IfcRoof");
const SOIL: Tag = Tag("SOI", "IfcGeographicElement");
const RETAINING: Tag = Tag("RET", "IfcWall");
const PILE: Tag = Tag("PIL", "IfcPile");
const PAVING: Tag = Tag("PAV", "IfcPavement");
const PLANTING: Tag = Tag("PLA", "IfcGeographicElement");
const BENCH: Tag = Tag("BNC", "IfcFurniture");
const LAMP: Tag = Tag("LMP", "IfcLightFixture");
const STREET: Tag = Tag("SFU", "IfcFurniture");
const SHELTER: Tag = Tag("SHL", "IfcBuildingElementProxy");
const CANOPY: Tag = Tag("CNP", "IfcBuildingElementProxy");
const HELIPAD: Tag = Tag("HEL", "IfcSlab");

/// Depth of one layer of excavation, metres.
const LAYER: f32 = 3.9;
/// Bay of the old building and height of its storeys, metres.
const OLD_BAY: f32 = 4.5;
const OLD_STOREY: f32 = 3.6;

/// Adds all of it.
pub(super) fn add(b: &mut Builder) {
    old_building(b);
    earthworks(b);
    foundations(b);
    square(b);
    street_furniture(b);
    variants(b);
}

/// An L-shaped brick house, pulled down from its roof.
fn old_building(b: &mut Builder) {
    let rich = b.design.wealth.min(1.3);
    let [x0, z0, x1, z1] = b.design.podium_outline();
    let nx = ((x1 - x0 - 6.0) / OLD_BAY * (0.45 + 0.45 * rich).min(0.9)) as i32;
    let nz = ((z1 - z0 - 6.0) / OLD_BAY * (0.45 + 0.45 * rich).min(0.9)) as i32;
    let (nx, nz) = (nx.clamp(2, 14), nz.clamp(2, 12));
    let storeys = if rich < 0.1 { 2 } else { 5 };
    let deep = |n: i32| (n / 3).max(1);
    let has = |i: i32, j: i32| {
        (0..nx).contains(&i) && (0..nz).contains(&j) && (i < deep(nx) || j >= nz - deep(nz))
    };
    let origin = (
        -(nx as f32) * OLD_BAY * 0.5 + (x0 + x1) * 0.5,
        -(nz as f32) * OLD_BAY * 0.5 + (z0 + z1) * 0.5,
    );
    let cell = |i: i32, j: i32| {
        (origin.0 + (i as f32 + 0.5) * OLD_BAY, origin.1 + (j as f32 + 0.5) * OLD_BAY)
    };
    let top = storeys as f32 * OLD_STOREY;
    let roof = b.work(Work::demolish("Demolition", "Strip roof", 0, b.plan.share(0.022, 0.032)));
    let roof_shape = b.shape("old roof", &[], |lod, m| {
        let h = OLD_BAY * 0.5 + 0.25;
        let (low, high) = (
            [vec3(-h, 0.0, h), vec3(h, 0.0, h), vec3(h, 0.0, -h), vec3(-h, 0.0, -h)],
            vec3(0.0, 1.9, 0.0),
        );
        for i in 0..4 {
            m.triangle([low[i], low[(i + 1) % 4], high], p::ROOF_TILE);
        }
        for i in 0..[0, 0, 2, 4, 6, 8][lod] {
            let y = 0.2 + i as f32 * 0.18;
            let r = h * (1.0 - y / 1.9);
            m.bar(vec3(-r, y, r + 0.03), vec3(r, y, r + 0.03), 0.06, 0.06, p::ROOF_TILE);
        }
    });
    for i in 0..nx {
        for j in (0..nz).filter(|&j| has(i, j)) {
            let (x, z) = cell(i, j);
            b.add(OLD_ROOF, Zone::OldBuilding, storeys, roof_shape, at(x, top + 0.02, z), &[roof]);
        }
    }
    for storey in (0..storeys).rev() {
        let step = 0.055 / f64::from(storeys);
        let from = 0.032 + step * f64::from(storeys - 1 - storey);
        let strip = b.work(Work::demolish(
            "Demolition",
            "Take out windows",
            storey,
            b.plan.share(0.014 + 0.001 * f64::from(storey), 0.022),
        ));
        let walls = b.work(Work::demolish(
            "Demolition",
            "Pull down walls",
            storey,
            b.plan.share(from, from + step * 0.7),
        ));
        let slabs = b.work(Work::demolish(
            "Demolition",
            "Break up floor",
            storey,
            b.plan.share(from + step * 0.5, from + step),
        ));
        let slab = b.unit_box(p::CONCRETE_RAW);
        let y = storey as f32 * OLD_STOREY;
        for i in 0..nx {
            for j in (0..nz).filter(|&j| has(i, j)) {
                let (x, z) = cell(i, j);
                let place =
                    placed(vec3(x, y + 0.02, z), 0, vec3(OLD_BAY - 0.02, 0.2, OLD_BAY - 0.02));
                b.add(OLD_SLAB, Zone::OldBuilding, storey, slab, place, &[slabs]);
                for side in Side::ALL {
                    let (dx, dz) = side.step();
                    if !has(i + dx, j + dz) {
                        let out = OLD_BAY * 0.5 + 0.02;
                        let place = vec3(x + dx as f32 * out, y + 0.01, z + dz as f32 * out);
                        old_wall(b, storey, side, place, (walls, strip));
                    }
                }
            }
        }
    }
}

fn old_wall(b: &mut Builder, storey: i32, side: Side, position: Vec3, works: (WorkId, WorkId)) {
    let paint = if storey == 0 { p::BRICK_DARK } else { p::BRICK };
    let wall = b.shape("old wall", &[paint.0.into()], move |lod, m| {
        m.wall(OLD_BAY, OLD_STOREY - 0.02, 0.4, [-0.7, 1.0, 0.7, 2.7], paint);
        if lod >= 1 {
            m.cuboid(vec3(-0.85, 0.86, 0.2), vec3(0.85, 0.98, 0.32), p::HOUSE_SAND);
            m.cuboid(vec3(-0.85, 2.72, 0.2), vec3(0.85, 2.95, 0.27), p::HOUSE_SAND);
        }
        if lod >= 2 {
            m.cuboid(
                vec3(-OLD_BAY * 0.5, OLD_STOREY - 0.3, 0.2),
                vec3(OLD_BAY * 0.5, OLD_STOREY - 0.12, 0.3),
                p::HOUSE_SAND,
            );
        }
    });
    let window = b.shape("old window", &[], |lod, m| {
        m.cuboid(vec3(-0.69, 1.01, -0.02), vec3(0.69, 2.69, 0.02), p::WINDOW);
        if lod >= 1 {
            m.cuboid(vec3(-0.03, 1.01, 0.02), vec3(0.03, 2.69, 0.06), p::WHITE);
            m.cuboid(vec3(-0.69, 2.1, 0.02), vec3(0.69, 2.16, 0.05), p::WHITE);
        }
    });
    let place = placed(position, side.quarter(), Vec3::ONE);
    b.add(OLD_WALL, Zone::OldBuilding, storey, wall, place, &[works.0]);
    b.add(OLD_WINDOW, Zone::OldBuilding, storey, window, place, &[works.1]);
}

/// Blocks of soil in the pit, taken out layer by layer.
fn earthworks(b: &mut Builder) {
    let [x0, z0, x1, z1] = pit(b);
    let rich = b.design.wealth.min(2.0);
    let size = 12.0 - 4.0 * rich.min(1.0);
    let (nx, nz) = (((x1 - x0) / size) as i32, ((z1 - z0) / size) as i32);
    let (w, d) = ((x1 - x0) / nx as f32, (z1 - z0) / nz as f32);
    let depth = -(b.design.level(-b.design.basements) - 1.1);
    let layers = (depth / LAYER).ceil() as i32;
    let thick = depth / layers as f32;
    for layer in 0..layers {
        let share = |k: i32| 0.092 + 0.052 * k as f32 as f64 / f64::from(layers);
        let work = b.work(Work::demolish(
            "Earthworks",
            "Excavate layer",
            -layer,
            b.plan.share(share(layer), share(layer + 1)),
        ));
        let paint = if layer == 0 { p::SOIL } else { p::SOIL_DARK };
        let shape = b.unit_box(paint);
        for i in 0..nx {
            for j in 0..nz {
                let bottom = vec3(
                    x0 + w * (i as f32 + 0.5),
                    -thick * (layer + 1) as f32,
                    z0 + d * (j as f32 + 0.5),
                );
                b.add(SOIL, Zone::Site, 0, shape, placed(bottom, 0, vec3(w, thick, d)), &[work]);
            }
        }
    }
}

fn foundations(b: &mut Builder) {
    let work = b.work(Work::construct(
        "Foundations",
        "Retaining wall panels",
        -1,
        b.plan.share(0.082, 0.094),
    ));
    let r = pit(b);
    let depth = -(b.design.level(-b.design.basements) - 1.1) + 3.0;
    let wall = b.unit_box(p::CONCRETE_RAW);
    for (along_x, from, to, line) in [
        (true, r[0] - 0.8, r[2] + 0.8, r[1] - 0.41),
        (true, r[0] - 0.8, r[2] + 0.8, r[3] + 0.41),
        (false, r[1], r[3], r[0] - 0.41),
        (false, r[1], r[3], r[2] + 0.41),
    ] {
        let count = ((to - from) / 5.0) as i32;
        let width = (to - from) / count as f32;
        for k in 0..count {
            let t = from + width * (k as f32 + 0.5);
            let (x, z) = if along_x { (t, line) } else { (line, t) };
            let place =
                placed(vec3(x, -depth, z), u8::from(!along_x), vec3(width, depth + 0.12, 0.78));
            b.add(RETAINING, Zone::Site, -1, wall, place, &[work]);
        }
    }
    let work = b.work(Work::construct(
        "Foundations",
        "Drill piles",
        -b.design.basements,
        b.plan.share(0.138, 0.1605),
    ));
    let cells = b.design.podium_cells();
    let top = b.design.level(-b.design.basements) - 1.15;
    let pile = b.unit_round(p::CONCRETE_RAW);
    let length = 6.0 + b.design.storeys as f32 * 0.2;
    for j in cells.z0..=cells.z1 {
        for i in cells.x0..=cells.x1 {
            let (x, z) = (b.design.line(i), b.design.line(j));
            b.add(
                PILE,
                Zone::Site,
                -b.design.basements,
                pile,
                placed(vec3(x, top - length, z), 0, vec3(0.55, length, 0.55)),
                &[work],
            );
        }
    }
}

/// Paving, planting, benches and lamps around the finished house.
fn square(b: &mut Builder) {
    let plot = b.design.plot();
    let inner = pit(b);
    let inner = [inner[0] - 1.0, inner[1] - 1.0, inner[2] + 1.0, inner[3] + 1.0];
    let paving =
        b.work(Work::construct("Landscaping", "Lay paving", 0, b.plan.share(0.935, 0.972)));
    let planting =
        b.work(Work::construct("Landscaping", "Plant trees", 0, b.plan.share(0.962, 0.985)));
    let furniture = b.work(Work::construct(
        "Landscaping",
        "Set benches and lamps",
        0,
        b.plan.share(0.968, 0.99),
    ));
    let size = if b.design.wealth < 0.1 { 14.0 } else { 6.0 };
    let (lamp, bench) = (b.lamp(), bench(b));
    let strips = [
        [plot[0], inner[3], plot[2], plot[3]],
        [plot[0], plot[1], plot[2], inner[1]],
        [plot[0], inner[1], inner[0], inner[3]],
        [inner[2], inner[1], plot[2], inner[3]],
    ];
    for r in strips {
        let (nx, nz) = (
            ((r[2] - r[0]) / size).ceil().max(1.0) as i32,
            ((r[3] - r[1]) / size).ceil().max(1.0) as i32,
        );
        let (w, d) = ((r[2] - r[0]) / nx as f32, (r[3] - r[1]) / nz as f32);
        for i in 0..nx {
            for j in 0..nz {
                let (x, z) = (r[0] + w * (i as f32 + 0.5), r[1] + d * (j as f32 + 0.5));
                let pick = super::random::mix((i * 31 + j * 7) as u64);
                let green = (i + 2 * j) % 5 == 2;
                let paint = if green {
                    p::GRASS
                } else if pick.is_multiple_of(3) {
                    p::PAVING_DARK
                } else {
                    p::PAVING
                };
                let slab = b.unit_box(paint);
                let height = if green { 0.28 } else { 0.13 };
                b.add(
                    PAVING,
                    Zone::Site,
                    0,
                    slab,
                    placed(vec3(x, 0.01, z), 0, vec3(w - 0.03, height, d - 0.03)),
                    &[paving],
                );
                if green {
                    let tree = b.tree((i + j) % 3);
                    let scale = 0.75 + (pick % 64) as f32 / 256.0;
                    b.add(
                        PLANTING,
                        Zone::Site,
                        0,
                        tree,
                        placed(vec3(x, 0.28, z), (pick % 4) as u8, Vec3::splat(scale)),
                        &[planting],
                    );
                } else if (i + 2 * j) % 5 == 4 {
                    b.add(
                        BENCH,
                        Zone::Site,
                        0,
                        bench,
                        placed(vec3(x, 0.14, z), (pick % 4) as u8, Vec3::ONE),
                        &[furniture],
                    );
                } else if (i * 3 + j) % 11 == 3 {
                    b.add(
                        LAMP,
                        Zone::Site,
                        0,
                        lamp,
                        placed(vec3(x, 0.14, z), (pick % 4) as u8, Vec3::splat(0.7)),
                        &[furniture],
                    );
                }
            }
        }
    }
}

fn bench(b: &mut Builder) -> super::builder::ShapeId {
    b.shape("bench", &[], |lod, m| {
        let slats = [2, 3, 4, 5, 6, 7][lod];
        for i in 0..slats {
            let z = -0.22 + 0.46 * i as f32 / slats as f32;
            m.cuboid(vec3(-0.95, 0.42, z), vec3(0.95, 0.46, z + 0.4 / slats as f32), p::TIMBER);
        }
        for x in [-0.8, 0.72] {
            m.cuboid(vec3(x, 0.0, -0.2), vec3(x + 0.08, 0.42, 0.2), p::CONCRETE_LIGHT);
        }
    })
}

/// Things on the pavement: taken away and put back; or put back for a while and then gone.
fn street_furniture(b: &mut Builder) {
    let plot = b.design.plot();
    let rich = b.design.wealth.min(1.5);
    let away = b.work(Work::demolish(
        "Site setup",
        "Take away street furniture",
        0,
        b.plan.share(0.002, 0.008),
    ));
    let back = b.work(Work::construct(
        "Landscaping",
        "Put street furniture back",
        0,
        b.plan.share(0.978, 0.992),
    ));
    let kinds = [street_item(b, 0), street_item(b, 1), bench(b)];
    let count = (48.0 * rich) as i32 + 4;
    for k in 0..count {
        let share = (k as f32 + 0.5) / count as f32;
        let x = plot[0] + (plot[2] - plot[0]) * share;
        let z = if k % 3 == 0 { plot[1] - 2.2 } else { plot[3] + 2.2 };
        b.add(STREET, Zone::Site, 0, kinds[(k % 3) as usize], at(x, 0.02, z), &[away, back]);
    }
    let first = b.work(Work::demolish(
        "Site setup",
        "Take down bus shelters",
        0,
        b.plan.share(0.004, 0.009),
    ));
    let second = b.work(Work::temporary(
        "Logistics",
        "Bus shelters, provisional",
        0,
        b.plan.share(0.03, 0.034),
        b.plan.share(0.60, 0.61),
    ));
    let shelter = b.shape("shelter", &[], |lod, m| {
        m.cuboid(vec3(-1.8, 2.4, -0.75), vec3(1.8, 2.5, 0.75), p::ALU_DARK);
        m.cuboid(vec3(-1.75, 0.2, -0.7), vec3(1.75, 2.3, -0.66), p::GLASS_CLEAR);
        for x in [-1.7, 1.6] {
            m.tube(
                vec3(x, 0.0, -0.6),
                vec3(x, 2.4, -0.6),
                0.05,
                super::shapes::sides(lod),
                p::ALU_DARK,
            );
        }
        if lod >= 1 {
            m.cuboid(vec3(-1.2, 0.4, -0.5), vec3(1.2, 0.46, -0.1), p::TIMBER);
        }
    });
    for k in 0..(8.0 * rich) as i32 + 1 {
        let z = plot[1] + (plot[3] - plot[1]) * (0.15 + 0.09 * (k / 2) as f32);
        let (x, quarter) = if k % 2 == 0 { (plot[0] - 1.9, 1) } else { (plot[2] + 1.9, 3) };
        b.add(
            SHELTER,
            Zone::Site,
            0,
            shelter,
            placed(vec3(x, 0.02, z), quarter, Vec3::ONE),
            &[first, second],
        );
    }
}

fn street_item(b: &mut Builder, kind: i32) -> super::builder::ShapeId {
    b.shape("street item", &[kind], move |lod, m| {
        let n = [5, 6, 8, 12, 16, 24][lod];
        if kind == 0 {
            m.lathe(
                Vec3::ZERO,
                &[(0.11, 0.0), (0.09, 0.1), (0.085, 0.85), (0.1, 0.9), (0.0, 1.0)],
                n,
                p::STEEL_DARK,
            );
        } else {
            m.lathe(
                Vec3::ZERO,
                &[(0.35, 0.0), (0.42, 0.6), (0.36, 0.62), (0.0, 0.55)],
                n,
                p::CONCRETE_LIGHT,
            );
            m.blob(vec3(0.0, 0.85, 0.0), vec3(0.45, 0.4, 0.45), lod / 2, 9, p::LEAF_B);
        }
    })
}

/// An entrance canopy that is built, and a helipad that stayed a variant.
fn variants(b: &mut Builder) {
    let [x0, _, x1, z1] = b.design.podium_outline();
    let work = b.work(Work::construct("Facade", "Entrance canopy", 0, b.plan.share(0.80, 0.83)));
    let width = ((x1 - x0) * 0.3).min(24.0);
    let shape = b.shape("canopy", &[mm(width)], move |lod, m| {
        m.cuboid(vec3(-width * 0.5, 4.3, 0.0), vec3(width * 0.5, 4.55, 6.0), p::BRONZE);
        let posts = [2, 3, 4, 5, 6, 8][lod];
        for i in 0..posts {
            let x = -width * 0.45 + width * 0.9 * i as f32 / (posts - 1) as f32;
            m.cone(
                vec3(x, 0.0, 5.3),
                vec3(x, 4.3, 5.3),
                0.11,
                0.09,
                [6, 8, 10, 12, 16, 24][lod],
                p::BRONZE,
            );
        }
    });
    b.add(CANOPY, Zone::Building, 0, shape, at((x0 + x1) * 0.5, 0.15, z1 + 0.75), &[work]);
    let mut variant =
        Work::construct("Structure", "Helipad (variant, not ordered)", 0, b.plan.share(0.82, 0.84));
    variant.active = false;
    let variant = b.work(variant);
    let y = b.design.level(b.design.storeys) + 5.2;
    let tile = b.unit_box(p::STEEL);
    for k in 0..if b.design.simple() { 3 } else { 9 } {
        let place = vec3((k % 3 - 1) as f32 * 4.0, y, (k / 3 - 1) as f32 * 4.0);
        b.add(
            HELIPAD,
            Zone::Building,
            super::model::ROOF,
            tile,
            placed(place, 0, vec3(3.96, 0.3, 3.96)),
            &[variant],
        );
    }
    // The last thing that happens: the keys change hands in the lobby.
    let total = b.plan.total();
    let handover = b.work(Work::neutral("Management", "Handover", 0, (total - 300.0, total)));
    let desk = b.shape("reception", &[], |_, m| {
        m.cuboid(vec3(-2.0, 0.0, -0.4), vec3(2.0, 1.1, 0.4), p::DOOR_WOOD);
        m.cuboid(vec3(-2.1, 1.1, -0.5), vec3(2.1, 1.15, 0.5), p::STONE);
    });
    let set =
        b.work(Work::construct("Fitting out", "Reception desk", 0, b.plan.share(0.95, 0.955)));
    b.add(
        Tag("REC", "IfcFurniture"),
        Zone::Building,
        0,
        desk,
        at((x0 + x1) * 0.5, 0.42, z1 - 3.0),
        &[set, handover],
    );
}
