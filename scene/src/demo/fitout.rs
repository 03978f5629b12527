//! What fills a storey: partitions, doors, ceilings, floors, pipes, ducts, trays, fittings.

use super::builder::{Builder, Tag, WorkId, Zone, at, mm, placed};
use super::design::{BAY, FACADE, PLATE, Role};
use super::facade::{along, extent};
use super::palette as p;
use super::programme::Work;
use glam::{Affine3A, Vec3, vec3};

const PARTITION: Tag = Tag("WAL", "IfcWall");
const DOOR: Tag = Tag("DOR", "IfcDoor");
const CEILING: Tag = Tag("CLG", "IfcCovering");
const FLOOR: Tag = Tag("FLR", "IfcCovering");
const PIPE: Tag = Tag("PIP", "IfcPipeSegment");
const DUCT: Tag = Tag("DCT", "IfcDuctSegment");
const TRAY: Tag = Tag("CTR", "IfcCableCarrierSegment");
const SPRINKLER: Tag = Tag("SPK", "IfcFireSuppressionTerminal");
const RADIATOR: Tag = Tag("RAD", "IfcSpaceHeater");
const DESK: Tag = Tag("FUR", "IfcFurniture");
/// Ceiling fittings and their classes, by the kinds of [`Builder::fitting`].
const FITTINGS: [Tag; 4] = [
    Tag("LUM", "IfcLightFixture"),
    Tag("SMK", "IfcSensor"),
    Tag("DIF", "IfcAirTerminal"),
    Tag("SPE", "IfcAudioVisualAppliance"),
];

/// Height of the ceilings above the floor, metres.
const CLEAR: f32 = 2.72;

/// Works of one storey's fit-out.
struct Works {
    risers: WorkId,
    pipes: WorkId,
    ducts: WorkId,
    trays: WorkId,
    sprinklers: WorkId,
    walls: WorkId,
    doors: WorkId,
    ceilings: WorkId,
    floors: WorkId,
    radiators: WorkId,
    furniture: WorkId,
}

impl Works {
    fn new(b: &mut Builder, storey: i32) -> Self {
        let mut work = |trade, name, lag, duration| {
            let window = b.plan.fit(storey, lag, duration);
            b.work(Work::construct(trade, name, storey, window))
        };
        Self {
            risers: work("Mechanical", "Install risers", 2.0, 1.0),
            ducts: work("Mechanical", "Hang ducts", 4.5, 1.5),
            pipes: work("Mechanical", "Run pipes", 5.5, 1.5),
            trays: work("Electrical", "Fix cable trays", 6.5, 1.2),
            sprinklers: work("Sprinklers", "Sprinkler lines and heads", 7.0, 1.5),
            walls: work("Partitions", "Build partitions", 8.0, 2.0),
            radiators: work("Mechanical", "Set radiators", 10.0, 1.0),
            ceilings: work("Finishes", "Close ceilings", 12.0, 1.5),
            floors: work("Finishes", "Lay floors", 13.5, 1.5),
            doors: work("Finishes", "Hang doors", 14.5, 1.5),
            furniture: work("Fitting out", "Furnish", 18.0, 2.0),
        }
    }
}

/// Adds the fit-out of all storeys.
pub(super) fn add(b: &mut Builder) {
    for storey in -b.design.basements..b.design.storeys {
        let works = Works::new(b, storey);
        for (i, j) in b.design.cells(storey) {
            match b.design.role(i, j) {
                Some(Role::Riser) => risers(b, storey, i, j, &works),
                Some(_) => {}
                None => cell(b, storey, i, j, &works),
            }
        }
        if storey >= b.design.podium.min(1) {
            radiators(b, storey, &works);
        }
    }
}

fn cell(b: &mut Builder, storey: i32, i: i32, j: i32, works: &Works) {
    let plain = storey < 0 || b.design.technical(storey);
    let (x, z) = b.design.middle(i, j);
    let y = b.design.level(storey);
    let ceiling = y + CLEAR;
    services(b, storey, (i, j), vec3(x, ceiling, z), works);
    if plain {
        return;
    }
    let floor = b.unit_box(if storey == 0 {
        p::STONE
    } else if (i * 3 + j + storey) % 4 == 0 {
        p::PARQUET
    } else {
        p::CARPET
    });
    b.build(
        FLOOR,
        storey,
        floor,
        placed(vec3(x, y + 0.01, z), 0, vec3(BAY - 0.05, 0.1, BAY - 0.05)),
        works.floors,
    );
    if storey > 0 {
        let tile = b.shape("ceiling", &[], |lod, m| {
            let h = BAY * 0.5 - 0.04;
            m.cuboid(vec3(-h, 0.02, -h), vec3(h, 0.05, h), p::CEILING);
            for k in 0..[0, 0, 1, 2, 3, 5][lod] {
                let x = -h + 2.0 * h * (k as f32 + 1.0) / ([1, 1, 2, 3, 4, 6][lod]) as f32;
                m.cuboid(vec3(x - 0.02, 0.0, -h), vec3(x + 0.02, 0.02, h), p::ALU);
            }
        });
        b.build(CEILING, storey, tile, at(x, ceiling, z), works.ceilings);
    }
    partitions(b, storey, i, j, works);
    if storey > 0 {
        let desk = b.desk();
        let pick = super::random::mix(
            (storey as u64) << 40 ^ (i as u64 & 0xffff) << 20 ^ (j as u64 & 0xffff),
        );
        for k in 0..(pick % 4) as i32 {
            let place = placed(
                vec3(x - 1.8 + 1.8 * k as f32, y + 0.11, z + 0.4),
                (pick >> 8) as u8 % 4,
                Vec3::ONE,
            );
            b.build(DESK, storey, desk, place, works.furniture);
        }
    }
}

/// Duct, pipes, tray and sprinklers above the ceiling of a cell, at `c`.
fn services(b: &mut Builder, storey: i32, (i, j): (i32, i32), c: Vec3, works: &Works) {
    let (x, y, z) = (c.x, c.y, c.z);
    let duct = b.duct(BAY - 0.9, 0.6, 0.28);
    let across = (i + j).rem_euclid(2) as u8;
    if across == 0 || !b.design.simple() {
        let place = placed(vec3(x, y + 0.24, z), across, Vec3::ONE);
        b.build(DUCT, storey, duct, place, works.ducts);
    }
    let pipe = b.pipe(BAY - 0.5, 0.045, p::PIPE_RED);
    b.build(PIPE, storey, pipe, at(x, y + 0.42, z - 1.5), works.sprinklers);
    let head = b.sprinkler();
    b.build(SPRINKLER, storey, head, at(x - 1.5, y - 0.005, z - 1.5), works.sprinklers);
    if b.design.simple() {
        return;
    }
    b.build(PIPE, storey, pipe, at(x, y + 0.42, z + 1.5), works.sprinklers);
    if storey % 2 == 0 {
        let water = b.pipe(BAY - 0.7, 0.03, p::PIPE_BLUE);
        b.build(PIPE, storey, water, at(x, y + 0.46, z - 2.2), works.pipes);
    }
    let warm = b.pipe(BAY - 0.6, 0.025, p::COPPER);
    b.build(PIPE, storey, warm, at(x, y + 0.46, z + 2.3), works.pipes);
    let tray = b.tray(BAY - 0.4);
    b.build(TRAY, storey, tray, placed(vec3(x + 2.4, y + 0.12, z), 1, Vec3::ONE), works.trays);
    for (dx, dz) in [(1.5, -1.5), (-1.5, 1.5), (1.5, 1.5)] {
        b.build(SPRINKLER, storey, head, at(x + dx, y - 0.005, z + dz), works.sprinklers);
    }
}

fn partitions(b: &mut Builder, storey: i32, i: i32, j: i32, works: &Works) {
    let (x, z) = b.design.middle(i, j);
    let y = b.design.level(storey);
    let height = b.design.height(storey) - PLATE - 0.02;
    let pick = super::random::mix(
        (storey as u64) << 32 ^ (i as u64 & 0xffff) << 16 ^ (j as u64 & 0xffff) ^ 0x77,
    );
    let wall = |b: &mut Builder, place: Affine3A, open: bool| {
        if open {
            let shape = b.door_wall(BAY - 0.85, height, 0.12, (1.0, 2.15), p::GYPSUM);
            b.build(PARTITION, storey, shape, place, works.walls);
            let door = b.door(0.98, 2.13, p::DOOR_WOOD);
            b.build(DOOR, storey, door, place, works.doors);
        } else {
            let shape = b.unit_box(p::GYPSUM);
            let size = Affine3A::from_scale(vec3(BAY - 0.85, height, 0.12));
            b.build(PARTITION, storey, shape, place * size, works.walls);
        }
    };
    // On grid lines with a neighbour inside, clear of columns and of the core's own walls.
    let inside = |b: &Builder, i, j| b.design.cell(storey, i, j) && b.design.role(i, j).is_none();
    if !pick.is_multiple_of(3) && inside(b, i + 1, j) {
        wall(b, placed(vec3(x + BAY * 0.5, y + 0.005, z), 1, Vec3::ONE), pick.is_multiple_of(2));
    }
    if (pick >> 8).is_multiple_of(3) && inside(b, i, j + 1) {
        wall(b, at(x, y + 0.005, z + BAY * 0.5), (pick >> 9).is_multiple_of(2));
    }
}

/// Vertical pipes and ducts in a riser cell.
fn risers(b: &mut Builder, storey: i32, i: i32, j: i32, works: &Works) {
    let (x, z) = b.design.middle(i, j);
    let y = b.design.level(storey);
    let height = b.design.height(storey) - 0.04;
    let paints = [p::PIPE_RED, p::PIPE_BLUE, p::COPPER, p::STEEL];
    for (k, paint) in paints.into_iter().enumerate() {
        let shape = b.shape("riser", &[mm(height), paint.0.into()], move |lod, m| {
            m.tube(Vec3::ZERO, vec3(0.0, height, 0.0), 0.09, [5, 6, 8, 12, 16, 24][lod], paint);
            for c in 0..[0, 1, 1, 2, 3, 4][lod] {
                let y = height * (c as f32 + 0.5) / 4.0;
                m.cone(
                    vec3(0.0, y, 0.0),
                    vec3(0.0, y + 0.1, 0.0),
                    0.13,
                    0.13,
                    [5, 6, 8, 12, 16, 24][lod],
                    p::STEEL,
                );
            }
        });
        b.build(PIPE, storey, shape, at(x - 1.3 + 0.35 * k as f32, y, z + 0.5), works.risers);
    }
    for k in 0..2 {
        let duct = b.duct(height, 0.7, 0.6);
        let stand = Affine3A::from_mat3(glam::Mat3::from_cols(Vec3::Y, Vec3::NEG_X, Vec3::Z));
        let place = at(x + 0.4 + 0.85 * k as f32, y + height * 0.5, z - 0.3) * stand;
        b.build(DUCT, storey, duct, place, works.risers);
    }
}

fn radiators(b: &mut Builder, storey: i32, works: &Works) {
    if b.design.technical(storey) {
        return;
    }
    let d = b.design.clone();
    let shape = b.radiator();
    for run in d.outline(|i, j| d.cell(storey, i, j)) {
        let (start, length) = extent(&run, FACADE);
        let count = if d.simple() { 1 } else { run.bays * 2 };
        for k in 0..count {
            let x = start + length * (k as f32 + 0.5) / count as f32;
            // They face the room, so they are turned about.
            let place =
                along(&run, x, 0.12, d.level(storey) + 0.1) * placed(Vec3::ZERO, 2, Vec3::ONE);
            b.add(RADIATOR, Zone::Building, storey, shape, place, &[works.radiators]);
        }
    }
}

/// Fittings on the lattice of one cell's ceiling, side by side.
const LATTICE: usize = 10;

/// Number of fittings for which [`fill`] has room.
pub(super) fn room(b: &Builder) -> usize {
    ceilings(b).len() * LATTICE * LATTICE
}

/// Cells with a ceiling, lowest storey first.
fn ceilings(b: &Builder) -> Vec<(i32, i32, i32)> {
    let d = &b.design;
    (-d.basements..d.storeys)
        .flat_map(|s| d.cells(s).into_iter().map(move |(i, j)| (s, i, j)))
        .filter(|&(_, i, j)| d.role(i, j).is_none())
        .collect()
}

/// Adds exactly `count` ceiling fittings, spread evenly; `count` is at most [`room`].
pub(super) fn fill(b: &mut Builder, count: usize) {
    let cells = ceilings(b);
    let shapes = [0, 1, 2, 3].map(|kind| b.fitting(kind));
    let mut work: Option<(i32, WorkId)> = None;
    for (c, &(storey, i, j)) in cells.iter().enumerate() {
        let here = count * (c + 1) / cells.len() - count * c / cells.len();
        let id = match work {
            Some((s, id)) if s == storey => id,
            _ => {
                let window = b.plan.fit(storey, 15.0, 3.0);
                b.work(Work::construct("Electrical", "Ceiling fittings", storey, window))
            }
        };
        work = Some((storey, id));
        let (x, z) = b.design.middle(i, j);
        let y = b.design.level(storey) + CLEAR - 0.006;
        for k in 0..here {
            // A stride coprime to the lattice spreads few fittings over the whole cell.
            let slot = (k * 37 + c * 13 + 5) % (LATTICE * LATTICE);
            let step = BAY / LATTICE as f32;
            let (u, v) = ((slot % LATTICE) as f32, (slot / LATTICE) as f32);
            let offset = |n: f32| (n + 0.5) * step - BAY * 0.5;
            let kind = [0, 2, 0, 1, 0, 3][k % 6];
            let small = Vec3::splat(if here > 24 { 0.45 } else { 1.0 });
            let place = placed(vec3(x + offset(u), y, z + offset(v)), 0, small);
            b.build(FITTINGS[kind], storey, shapes[kind], place, id);
        }
    }
}
