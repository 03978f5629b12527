//! Curtain wall, parapets, terraces, roof and crown.

use super::builder::{Builder, Tag, WorkId, Zone, at, mm, placed};
use super::design::{BAY, FACADE, Run, Side};
use super::model::ROOF;
use super::palette::{self as p, Paint};
use super::programme::Work;
use super::structure::plate_rectangle;
use glam::{Affine3A, Vec3, vec3};

const GLASS: Tag = Tag("GLS", "IfcPlate");
const SPANDREL: Tag = Tag("SPN", "IfcPlate");
const MULLION: Tag = Tag("MUL", "IfcMember");
const TRANSOM: Tag = Tag("TRS", "IfcMember");
const LOUVRE: Tag = Tag("LOU", "IfcPlate");
const PARAPET: Tag = Tag("PAR", "IfcWall");
const ROOFING: Tag = Tag("ROF", "IfcCovering");
const RAILING: Tag = Tag("RLG", "IfcRailing");
const CROWN: Tag = Tag("CRN", "IfcMember");
const PLANT: Tag = Tag("PLT", "IfcUnitaryEquipment");
const TRADE: &str = "Facade";

/// Height of the closed band below a floor and above it, metres.
const BAND: (f32, f32) = (0.62, 0.28);

/// A place along a run of the outline: `along` metres from its middle, `out` beyond the grid line.
pub(super) fn along(run: &Run, along: f32, out: f32, y: f32) -> Affine3A {
    let (dx, dz) = run.side.step();
    let (dx, dz) = (dx as f32, dz as f32);
    let position = vec3(run.x + dz * along + dx * out, y, run.z - dx * along + dz * out);
    placed(position, run.side.quarter(), Vec3::ONE)
}

/// Start and length of a wall `out` metres beyond a run's grid line, along the run.
pub(super) fn extent(run: &Run, out: f32) -> (f32, f32) {
    let half = run.bays as f32 * BAY * 0.5;
    (-half - run.left * out, 2.0 * half + (run.left + run.right) * out)
}

/// Adds the envelope of everything above ground.
pub(super) fn add(b: &mut Builder) {
    for storey in 0..b.design.storeys {
        curtain_wall(b, storey);
    }
    for storey in 1..=b.design.storeys {
        terraces(b, storey);
    }
    crown(b);
    plant(b);
}

/// The works of one storey's curtain wall.
struct Works {
    frame: WorkId,
    band: WorkId,
    glass: WorkId,
    late: WorkId,
}

fn curtain_wall(b: &mut Builder, storey: i32) {
    let fit = |lag, duration| b.plan.fit(storey, lag, duration);
    let (frame, band, glass, late) = (fit(3.6, 1.0), fit(4.4, 1.0), fit(5.0, 1.4), fit(15.0, 1.0));
    let works = Works {
        frame: b.work(Work::construct(TRADE, "Hang mullions and transoms", storey, frame)),
        band: b.work(Work::construct(TRADE, "Fix closed panels", storey, band)),
        glass: b.work(Work::construct(TRADE, "Glaze", storey, glass)),
        late: b.work(Work::construct(TRADE, "Close hoist bay", storey, late)),
    };
    let d = b.design.clone();
    for run in d.outline(|i, j| d.cell(storey, i, j)) {
        panels(b, storey, &run, &works);
    }
}

/// Whether the hoist runs in front of this panel.
pub(super) fn hoist_bay(b: &Builder, storey: i32, run: &Run, share: f32) -> bool {
    storey >= b.design.podium
        && b.design.bays > 3
        && run.side == Side::North
        && run.bays >= 2
        && run.z < 0.0
        && (0.44..0.62).contains(&share)
}

fn panels(b: &mut Builder, storey: i32, run: &Run, works: &Works) {
    let d = b.design.clone();
    let lobby = storey == 0;
    let per_bay = if lobby { (d.panels / 2).max(1) } else { d.panels };
    let count = run.bays * per_bay;
    let (start, length) = extent(run, FACADE);
    let width = length / count as f32;
    let (y, top) = (d.level(storey), d.level(storey + 1));
    let (dx, dz) = run.side.step();
    // Where a terrace lies in front, the wall stands on it.
    let on_terrace = storey > 0 && d.cell(storey - 1, run.first.0 + dx, run.first.1 + dz);
    let low = if on_terrace || lobby { y + 0.16 } else { y - BAND.0 };
    let sill = y + if lobby { 0.3 } else { BAND.1 };
    let head = top - BAND.0;
    let technical = d.technical(storey);
    let podium = storey < d.podium;
    let upper = storey >= d.storeys - (d.storeys / 5).max(2);
    let glass = if lobby {
        p::GLASS_CLEAR
    } else if upper {
        p::GLASS_DEEP
    } else {
        p::GLASS
    };
    let closed = if podium { p::SPANDREL_PALE } else { p::SPANDREL };
    let fin = if podium { 0.18 } else { 0.3 };
    let glass = b.glass_panel(width - 0.09, head - sill - 0.07, glass, p::ALU_DARK);
    let spandrel = b.spandrel(width - 0.05, sill - low, closed);
    let louvre = b.louvre(width - 0.09, head - sill - 0.07);
    let fins = [b.mullion(fin, if podium { p::ALU } else { p::BRONZE }), b.mullion(0.08, p::ALU)];
    let transom = b.transom();
    for k in 0..=count {
        let x = start + width * k as f32;
        // A corner's mullion belongs to the run that ends there, seen from outside.
        if k > 0 || run.left < 0.0 {
            let place =
                along(run, x, FACADE, low) * Affine3A::from_scale(vec3(1.0, head - low, 1.0));
            b.build(MULLION, storey, fins[(k % 2) as usize], place, works.frame);
        }
        if k == count {
            break;
        }
        let x = x + width * 0.5;
        for y in [head + 0.01, sill - 0.02].into_iter().take(if d.simple() { 1 } else { 2 }) {
            let place =
                along(run, x, FACADE, y) * Affine3A::from_scale(vec3(width - 0.075, 1.0, 1.0));
            b.build(TRANSOM, storey, transom, place, works.frame);
        }
        let leave_out = hoist_bay(b, storey, run, (k as f32 + 0.5) / count as f32);
        let glaze = if leave_out { works.late } else { works.glass };
        b.build(SPANDREL, storey, spandrel, along(run, x, FACADE, low), works.band);
        if technical {
            b.build(LOUVRE, storey, louvre, along(run, x, FACADE, sill + 0.03), glaze);
        } else {
            b.build(GLASS, storey, glass, along(run, x, FACADE, sill + 0.02), glaze);
        }
    }
}

/// Roofing, parapet and railing of the cells at `storey` that lie under the sky.
fn terraces(b: &mut Builder, storey: i32) {
    let d = b.design.clone();
    let open = |i, j| d.cell(storey - 1, i, j) && !d.cell(storey, i, j);
    if !d.podium_cells().iter().any(|(i, j)| open(i, j)) {
        return;
    }
    let label = if storey == d.storeys { ROOF } else { storey };
    let lag = if storey == d.storeys { 1.0 } else { 6.0 };
    let roofing = b.work(Work::construct(
        "Roofing",
        "Waterproof and finish terraces",
        label,
        b.plan.fit(storey - 1, lag, 2.0),
    ));
    let parapet =
        b.work(Work::construct(TRADE, "Parapets", label, b.plan.fit(storey - 1, lag + 1.0, 1.5)));
    let rail = b.work(Work::construct(
        "Finishes",
        "Terrace railings",
        label,
        b.plan.fit(storey - 1, lag + 3.0, 1.0),
    ));
    let y = d.level(storey);
    for (i, j) in d.podium_cells().iter().filter(|&(i, j)| open(i, j)) {
        if d.role(i, j).is_some() && storey == d.storeys {
            continue;
        }
        let [x0, z0, x1, z1] = plate_rectangle(b, storey, i, j);
        // Where a tower wall rises beside it the roofing stops short of the facade.
        let gap =
            |s: Side| if d.cell(storey, i + s.step().0, j + s.step().1) { 0.65 } else { 0.03 };
        let (x0, x1) = (x0 + gap(Side::West), x1 - gap(Side::East));
        let (z0, z1) = (z0 + gap(Side::North), z1 - gap(Side::South));
        let paint = if storey == d.storeys {
            p::GRAVEL
        } else if (i + j) % 3 == 0 {
            p::PAVING
        } else {
            p::GREEN_ROOF
        };
        let shape = b.unit_box(paint);
        let place = placed(
            vec3((x0 + x1) * 0.5, y + 0.01, (z0 + z1) * 0.5),
            0,
            vec3(x1 - x0, 0.12, z1 - z0),
        );
        b.build(ROOFING, label, shape, place, roofing);
    }
    for run in d.outline(|i, j| d.plate(storey, i, j)) {
        parapets(b, label, &run, &open, y, (parapet, rail));
    }
}

/// The parapet in front of the open cells of a run.
fn parapets(
    b: &mut Builder,
    storey: i32,
    run: &Run,
    open: &impl Fn(i32, i32) -> bool,
    y: f32,
    works: (WorkId, WorkId),
) {
    let (dx, dz) = run.side.step();
    let (start, length) = extent(run, FACADE);
    let rail = b.railing(0.0, BAY, 5, p::STEEL);
    for k in 0..run.bays {
        if !open(run.first.0 + dz * k, run.first.1 - dx * k) {
            continue;
        }
        let from = if k == 0 { start } else { (k as f32 - run.bays as f32 * 0.5) * BAY };
        let to = if k + 1 == run.bays {
            start + length
        } else {
            (k as f32 + 1.0 - run.bays as f32 * 0.5) * BAY
        };
        let width = to - from;
        let shape = b.shape("parapet", &[mm(width)], move |lod, m| {
            let w = width * 0.5 - 0.01;
            m.cuboid(vec3(-w, 0.0, -0.1), vec3(w, 1.5, 0.1), p::SPANDREL);
            if lod >= 1 {
                m.cuboid(vec3(-w, 1.5, -0.16), vec3(w, 1.56, 0.16), p::ALU);
            }
        });
        b.build(PARAPET, storey, shape, along(run, (from + to) * 0.5, FACADE, y - 0.62), works.0);
        if b.design.simple() {
            continue;
        }
        let (dx, dz) = (dx as f32, dz as f32);
        let middle = (k as f32 + 0.5 - run.bays as f32 * 0.5) * BAY;
        let corner = along(run, middle, -0.1, y + 0.13).translation;
        // The railing rises along its own +Z; turned a quarter more it runs along the wall.
        let place = placed(
            Vec3::from(corner) - vec3(dz, 0.0, -dx) * BAY * 0.5,
            run.side.quarter() + 1,
            Vec3::ONE,
        );
        b.build(RAILING, storey, rail, place, works.1);
    }
}

/// A screen of fins and glass around the roof, higher towards the middle, and a spire.
fn crown(b: &mut Builder) {
    let d = b.design.clone();
    let top = d.level(d.storeys);
    let total = (top * 0.085).clamp(4.0, 19.0);
    let frame = b.work(Work::construct(TRADE, "Crown steelwork", ROOF, b.plan.share(0.775, 0.82)));
    let glazing = b.work(Work::construct(TRADE, "Crown glazing", ROOF, b.plan.share(0.815, 0.855)));
    for run in d.outline(|i, j| d.cell(d.storeys - 1, i, j)) {
        let count = run.bays * d.panels.min(3);
        let (start, length) = extent(&run, FACADE + 0.05);
        let width = length / count as f32;
        let front = matches!(run.side, Side::South | Side::North);
        for k in 0..=count {
            let x = start + width * k as f32;
            // Steps up towards the east on the long sides, full height on the east side.
            let place = along(&run, x, FACADE + 0.05, 0.0);
            let reach = d.line(d.tower(d.storeys - 1).x1);
            let share = ((place.translation.x / reach + 1.0) * 0.5).clamp(0.0, 1.0);
            let height = ((total * (0.45 + 0.55 * share)) * 4.0).round() / 4.0;
            let base = top + 0.95;
            if k > 0 || run.left < 0.0 {
                let fin = crown_fin(b, height);
                b.build(CROWN, ROOF, fin, along(&run, x, FACADE + 0.05, base), frame);
            }
            if k < count {
                let panel = b.glass_panel(width - 0.2, height * 0.5 - 0.2, p::GLASS_DEEP, p::ALU);
                for half in 0..2 {
                    let y = base + 0.1 + half as f32 * height * 0.5;
                    if front && half == 1 && k % 2 == 1 {
                        continue;
                    }
                    b.build(
                        GLASS,
                        ROOF,
                        panel,
                        along(&run, x + width * 0.5, FACADE + 0.05, y),
                        glazing,
                    );
                }
            }
        }
    }
    spire(b, top, total);
}

fn crown_fin(b: &mut Builder, height: f32) -> super::builder::ShapeId {
    b.shape("crown fin", &[mm(height)], move |lod, m| {
        m.cuboid(vec3(-0.07, 0.0, -0.15), vec3(0.07, height, 0.45), p::BRONZE);
        if lod >= 1 {
            m.bar(vec3(0.0, height * 0.75, -0.15), vec3(0.0, 0.0, -1.9), 0.1, 0.1, p::STEEL_DARK);
        }
        if lod >= 2 {
            m.bar(
                vec3(0.0, height * 0.4, -0.15),
                vec3(0.0, height * 0.4, -0.9),
                0.08,
                0.08,
                p::STEEL_DARK,
            );
        }
    })
}

fn spire(b: &mut Builder, top: f32, total: f32) {
    let work = b.work(Work::construct(TRADE, "Spire", ROOF, b.plan.share(0.83, 0.845)));
    let height = total * 0.55;
    let radius = (total * 0.03).max(0.16);
    let base = top + 4.0;
    for k in 0..5 {
        let (r0, r1) = (radius * (1.0 - k as f32 * 0.17), radius * (0.86 - k as f32 * 0.17));
        let shape = b.shape("spire", &[mm(height), mm(radius), k], move |lod, m| {
            let n = [5, 6, 8, 12, 18, 24][lod];
            m.cone(Vec3::ZERO, vec3(0.0, height - 0.03, 0.0), r0, r1, n, p::ALU);
            m.cone(
                vec3(0.0, height * 0.93, 0.0),
                vec3(0.0, height * 0.97, 0.0),
                r0 * 1.3,
                r0 * 1.3,
                n,
                p::STEEL_DARK,
            );
        });
        b.build(CROWN, ROOF, shape, at(0.0, base + height * k as f32, 0.0), work);
    }
}

/// Plant room over the core, cooling units and tanks on the roof.
fn plant(b: &mut Builder) {
    let d = b.design.clone();
    let top = d.level(d.storeys);
    let walls =
        b.work(Work::construct("Structure", "Plant room", ROOF, b.plan.share(0.762, 0.775)));
    let units =
        b.work(Work::construct("Mechanical", "Set roof plant", ROOF, b.plan.share(0.80, 0.84)));
    let core = d.core();
    let (x0, x1) = (d.line(core.x0), d.line(core.x1));
    let (z0, z1) = (d.line(core.z0), d.line(core.z1));
    let wall = |b: &mut Builder, position: Vec3, size: Vec3, paint: Paint| {
        let shape = b.unit_box(paint);
        b.add(
            Tag("PRM", "IfcWall"),
            Zone::Building,
            ROOF,
            shape,
            placed(position, 0, size),
            &[walls],
        );
    };
    let (cx, cz) = ((x0 + x1) * 0.5, (z0 + z1) * 0.5);
    for z in [z0, z1] {
        wall(b, vec3(cx, top, z), vec3(x1 - x0 + 0.3, 3.6, 0.3), p::SPANDREL);
    }
    for x in [x0, x1] {
        wall(b, vec3(x, top, cz), vec3(0.3, 3.6, z1 - z0 - 0.3), p::SPANDREL);
    }
    wall(b, vec3(cx, top + 3.6, cz), vec3(x1 - x0 + 0.9, 0.35, z1 - z0 + 0.9), p::ZINC);
    let chiller = b.shape("chiller", &[], |lod, m| {
        m.cuboid(vec3(-1.6, 0.2, -0.9), vec3(1.6, 1.7, 0.9), p::CABIN);
        m.cuboid(vec3(-1.5, 0.0, -0.8), vec3(1.5, 0.2, 0.8), p::STEEL_DARK);
        for x in [-0.8, 0.8] {
            let n = [5, 8, 12, 16, 24, 32][lod];
            m.cone(vec3(x, 1.7, 0.0), vec3(x, 1.95, 0.0), 0.6, 0.65, n, p::STEEL);
            m.cone(vec3(x, 1.95, 0.0), vec3(x, 1.97, 0.0), 0.5, 0.5, n, p::BLACK);
        }
        for i in 0..[0, 2, 5, 9, 14, 20][lod] {
            let x = -1.5 + 0.15 * i as f32;
            m.cuboid(vec3(x, 0.4, 0.9), vec3(x + 0.08, 1.5, 0.94), p::LOUVRE);
        }
    });
    for (i, j) in d.cells(d.storeys - 1) {
        if d.role(i, j).is_none() && d.bays > 3 && (i + 2 * j) % 3 == 0 {
            let (x, z) = d.middle(i, j);
            b.build(PLANT, ROOF, chiller, at(x, top + 0.14, z), units);
        }
    }
}
