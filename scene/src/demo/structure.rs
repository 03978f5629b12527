//! Load-bearing structure, storey by storey: plates, beams, columns, core, stairs.

use super::builder::{Builder, Tag, WorkId, Zone, at, mm, placed};
use super::design::{BAY, OVERHANG, PLATE, Role, Side};
use super::palette as p;
use super::programme::Work;
use glam::{Affine3A, Vec3, vec3};

const SLAB: Tag = Tag("SLB", "IfcSlab");
const BEAM: Tag = Tag("BEM", "IfcBeam");
const COLUMN: Tag = Tag("COL", "IfcColumn");
const CORE: Tag = Tag("COR", "IfcWall");
const SHEAR: Tag = Tag("SHW", "IfcWall");
const FLIGHT: Tag = Tag("STR", "IfcStairFlight");
const LANDING: Tag = Tag("LND", "IfcSlab");
const RAILING: Tag = Tag("RLG", "IfcRailing");
const LIFT_DOOR: Tag = Tag("LDR", "IfcDoor");
const LIFT_RAIL: Tag = Tag("LFT", "IfcTransportElement");
const TRADE: &str = "Structure";

/// Adds the structure of all storeys, basements first.
pub(super) fn add(b: &mut Builder) {
    for storey in -b.design.basements..=b.design.storeys {
        plates(b, storey);
        beams(b, storey);
        if storey < b.design.storeys {
            core(b, storey);
            columns(b, storey);
            stairs(b, storey);
            lifts(b, storey);
        }
    }
}

/// The plan rectangle of a plate over a cell, [x0, z0, x1, z1], with its overhang at the outline.
pub(super) fn plate_rectangle(b: &Builder, storey: i32, i: i32, j: i32) -> [f32; 4] {
    let d = &b.design;
    let edge =
        |s: Side| if d.plate(storey, i + s.step().0, j + s.step().1) { 0.0 } else { OVERHANG };
    [
        d.line(i) - edge(Side::West),
        d.line(j) - edge(Side::North),
        d.line(i + 1) + edge(Side::East),
        d.line(j + 1) + edge(Side::South),
    ]
}

fn plates(b: &mut Builder, storey: i32) {
    let work =
        b.work(Work::construct(TRADE, "Pour slab", storey, b.plan.structure(storey, 0.42, 0.62)));
    let raft = storey == -b.design.basements;
    let thickness = if raft { 1.1 } else { PLATE };
    let paint = if raft { p::CONCRETE_RAW } else { p::CONCRETE };
    let top = b.design.level(storey);
    for (i, j) in b.design.podium_cells().iter() {
        if !b.design.plate(storey, i, j) {
            continue;
        }
        let [x0, z0, x1, z1] = plate_rectangle(b, storey, i, j);
        let hole = match b.design.role(i, j) {
            Some(Role::Stair) => Some((1.45, 2.6)),
            Some(Role::Lift) => Some((2.3, 2.2)),
            Some(Role::Riser) => Some((1.6, 0.9)),
            _ => None,
        };
        let centre = vec3((x0 + x1) * 0.5, top - thickness, (z0 + z1) * 0.5);
        let size = vec3(x1 - x0, thickness, z1 - z0);
        match hole.filter(|_| !raft && (storey < b.design.storeys || hole != Some((2.3, 2.2)))) {
            Some((hx, hz)) => {
                // Core cells lie inside the outline, so their plates have no overhang.
                let shape =
                    b.shape("pierced plate", &[mm(hx), mm(hz), mm(thickness)], move |_, m| {
                        let h = BAY * 0.5;
                        m.ring([-h, -h, h, h], [-hx, -hz, hx, hz], 0.0, thickness, p::CONCRETE);
                    });
                b.build(SLAB, storey, shape, Affine3A::from_translation(centre), work);
            }
            None => {
                let shape = b.unit_box(paint);
                b.build(SLAB, storey, shape, placed(centre, 0, size), work);
            }
        }
    }
}

/// Whether any of the four cells at a grid node satisfies `has`.
fn touches(i: i32, j: i32, has: impl Fn(i32, i32) -> bool) -> bool {
    has(i, j) || has(i - 1, j) || has(i, j - 1) || has(i - 1, j - 1)
}

fn beams(b: &mut Builder, storey: i32) {
    if storey == -b.design.basements {
        return;
    }
    let work =
        b.work(Work::construct(TRADE, "Cast beams", storey, b.plan.structure(storey, 0.30, 0.46)));
    let shape = b.beam(BAY - 0.6, 0.4, 0.5, p::CONCRETE);
    let y = b.design.level(storey) - 0.1;
    let cells = b.design.podium_cells();
    for j in cells.z0..=cells.z1 {
        for i in cells.x0..=cells.x1 {
            let d = &b.design;
            let in_core = |i: i32, j: i32| d.role(i, j).is_some();
            let along_x = (d.plate(storey, i, j) || d.plate(storey, i, j - 1))
                && !in_core(i, j)
                && !in_core(i, j - 1);
            let along_z = (d.plate(storey, i, j) || d.plate(storey, i - 1, j))
                && !in_core(i, j)
                && !in_core(i - 1, j);
            let (x, z) = (d.line(i), d.line(j));
            if along_x && i < cells.x1 {
                b.build(BEAM, storey, shape, at(x + BAY * 0.5, y, z), work);
            }
            if along_z && j < cells.z1 {
                b.build(BEAM, storey, shape, placed(vec3(x, y, z + BAY * 0.5), 1, Vec3::ONE), work);
            }
        }
    }
}

fn columns(b: &mut Builder, storey: i32) {
    let work = b.work(Work::construct(
        TRADE,
        "Erect columns",
        storey,
        b.plan.structure(storey, 0.66, 0.97),
    ));
    let lobby = storey == 0;
    let shape = if lobby { b.unit_round(p::CONCRETE_LIGHT) } else { b.unit_column(p::CONCRETE) };
    let share = storey.max(0) as f32 / b.design.storeys as f32;
    let width = if share < 0.35 {
        0.8
    } else if share < 0.7 {
        0.7
    } else {
        0.6
    };
    let scale = if lobby { width * 0.5 } else { width };
    let (y, top) = (b.design.level(storey) - 0.04, b.design.level(storey + 1) - PLATE + 0.04);
    let cells = b.design.podium_cells();
    for j in cells.z0..=cells.z1 {
        for i in cells.x0..=cells.x1 {
            let d = &b.design;
            if touches(i, j, |i, j| d.cell(storey, i, j))
                && !touches(i, j, |i, j| d.role(i, j).is_some())
            {
                let place = placed(vec3(d.line(i), y, d.line(j)), 0, vec3(scale, top - y, scale));
                b.build(COLUMN, storey, shape, place, work);
            }
        }
    }
    outriggers(b, storey, work);
}

/// Walls that brace the core against the outer columns: two a storey, four on technical storeys.
fn outriggers(b: &mut Builder, storey: i32, work: WorkId) {
    let d = &b.design;
    let core = d.core();
    let height = d.height(storey) - PLATE - 0.1;
    let y = d.level(storey);
    let all = [
        (d.line(core.x0) - BAY * 0.5, d.line(core.z0)),
        (d.line(core.x1) + BAY * 0.5, d.line(core.z1)),
        (d.line(core.x0) - BAY * 0.5, d.line(core.z1)),
        (d.line(core.x1) + BAY * 0.5, d.line(core.z0)),
    ];
    let count = if d.bays < 5 {
        0
    } else if d.technical(storey) {
        4
    } else {
        2
    };
    let shape = b.door_wall(BAY - 1.3, height, 0.3, (1.4, 2.3), p::CONCRETE);
    for (x, z) in &all[..count] {
        b.build(SHEAR, storey, shape, at(*x, y, *z), work);
    }
}

fn core(b: &mut Builder, storey: i32) {
    let work = b.work(Work::construct(
        TRADE,
        "Climb core walls",
        storey,
        b.plan.structure(storey, 0.62, 0.84),
    ));
    let y = b.design.level(storey);
    let height = b.design.height(storey) - PLATE;
    let roles = b.design.clone();
    let small = b.design.core().x1 - b.design.core().x0 < 3;
    for run in b.design.outline(|i, j| roles.role(i, j).is_some()) {
        let (dx, dz) = run.side.step();
        // Walls that face east and west stop at those that face south and north.
        let inset = if dx != 0 { 0.45 } else { -0.45 };
        let length = run.bays as f32 * BAY - inset;
        let width = length / run.bays as f32;
        for k in 0..run.bays {
            let (i, j) = (run.first.0 + dz * k, run.first.1 - dx * k);
            let offset = (k as f32 + 0.5) * width - length * 0.5;
            let place = placed(
                vec3(run.x + dz as f32 * offset, y, run.z - dx as f32 * offset),
                run.side.quarter(),
                Vec3::ONE,
            );
            let open = b.design.role(i, j) == Some(Role::Lobby) || small;
            if open {
                let shape = b.door_wall(width, height, 0.45, (1.8, 2.4), p::CONCRETE_DARK);
                b.build(CORE, storey, shape, place, work);
            } else {
                let shape = b.unit_box(p::CONCRETE_DARK);
                let place = place * Affine3A::from_scale(vec3(width, height, 0.45));
                b.build(CORE, storey, shape, place, work);
            }
        }
    }
    inner_walls(b, storey, work);
}

/// Walls between the cells of the core, with doors towards lobbies.
fn inner_walls(b: &mut Builder, storey: i32, work: WorkId) {
    let core = b.design.core();
    let height = b.design.height(storey) - PLATE;
    let y = b.design.level(storey);
    let doors = b.work(Work::construct(
        "Lifts",
        "Hang lift and shaft doors",
        storey,
        b.plan.fit(storey, 8.0, 1.5),
    ));
    for (i, j) in core.iter() {
        let role = b.design.role(i, j);
        let (x, z) = b.design.middle(i, j);
        if b.design.role(i, j + 1).is_some() {
            let width = BAY - 0.45;
            let place = at(x, y, z + BAY * 0.5);
            let lift = role == Some(Role::Lift) || b.design.role(i, j + 1) == Some(Role::Lift);
            let shape = b.door_wall(
                width,
                height,
                0.3,
                if lift { (2.6, 2.3) } else { (1.1, 2.2) },
                p::CONCRETE_DARK,
            );
            b.build(CORE, storey, shape, place, work);
            let door =
                if lift { b.door(2.58, 2.29, p::STEEL) } else { b.door(1.08, 2.19, p::DOOR_STEEL) };
            b.build(LIFT_DOOR, storey, door, place, doors);
        }
        let next = b.design.role(i + 1, j);
        if next.is_some() && !(role == Some(Role::Lobby) && next == role) {
            let shape = b.unit_box(p::CONCRETE_DARK);
            let place = placed(vec3(x + BAY * 0.5, y, z), 0, vec3(0.3, height, BAY - 0.5));
            b.build(CORE, storey, shape, place, work);
        }
    }
}

fn stairs(b: &mut Builder, storey: i32) {
    let work =
        b.work(Work::construct(TRADE, "Set stair flights", storey, b.plan.fit(storey, 0.1, 0.6)));
    // Guards go in early for safety, come out for the stone treads, and go in again.
    let guard = b.work(Work::temporary(
        TRADE,
        "Stair guards, provisional",
        storey,
        b.plan.fit(storey, 0.8, 0.4),
        b.plan.fit(storey, 9.0, 0.4),
    ));
    let rails = b.work(Work::construct(
        "Finishes",
        "Stair railings",
        storey,
        b.plan.fit(storey, 11.5, 0.8),
    ));
    let (y, h) = (b.design.level(storey), b.design.height(storey));
    let steps = (h * 0.5 / 0.176).round() as i32;
    let run = (steps as f32 * 0.28).min(3.5);
    let flight = b.flight(1.3, h * 0.5, run, steps);
    let landing = b.unit_box(p::CONCRETE_LIGHT);
    let railing = b.railing(h * 0.5, run, 6, p::STEEL_DARK);
    let reinstalled = storey.rem_euclid(3) == 0;
    for (i, j) in b.design.core().iter() {
        if b.design.role(i, j) != Some(Role::Stair) {
            continue;
        }
        let (x, z) = b.design.middle(i, j);
        let z0 = z - 2.6;
        let up = at(x - 0.7, y, z0);
        let down = placed(vec3(x + 0.7, y + h * 0.5, z0 + run), 2, Vec3::ONE);
        b.build(FLIGHT, storey, flight, up, work);
        b.build(FLIGHT, storey, flight, down, work);
        let end = z + 2.6;
        let depth = end - (z0 + run) - 0.02;
        let place = placed(vec3(x, y + h * 0.5 - 0.2, end - depth * 0.5), 0, vec3(2.8, 0.2, depth));
        b.build(LANDING, storey, landing, place, work);
        let rail = |p: Affine3A, side: f32| p * Affine3A::from_translation(vec3(side, 0.1, 0.0));
        for place in [rail(up, 0.58), rail(down, 0.58)] {
            let works: &[WorkId] = if reinstalled { &[guard, rails] } else { &[rails] };
            b.add(RAILING, Zone::Building, storey, railing, place, works);
        }
    }
}

fn lifts(b: &mut Builder, storey: i32) {
    let work =
        b.work(Work::construct("Lifts", "Lift guide rails", storey, b.plan.fit(storey, 5.0, 1.0)));
    let h = b.design.height(storey);
    let shape = b.shape("lift rails", &[mm(h)], move |lod, m| {
        for x in [-2.1, -0.2, 0.2, 2.1f32] {
            m.cuboid(vec3(x - 0.04, 0.0, -0.02), vec3(x + 0.04, h, 0.02), p::STEEL);
            for k in 0..[0, 0, 1, 2, 3, 4][lod] {
                let y = h * (k as f32 + 0.5) / 4.0;
                m.cuboid(vec3(x - 0.1, y, -0.1), vec3(x + 0.1, y + 0.08, -0.03), p::STEEL_DARK);
            }
        }
    });
    for (i, j) in b.design.core().iter() {
        if b.design.role(i, j) == Some(Role::Lift) {
            let (x, z) = b.design.middle(i, j);
            b.build(LIFT_RAIL, storey, shape, at(x, b.design.level(storey), z), work);
        }
    }
}
