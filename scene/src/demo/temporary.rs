//! Temporary works: fence, cabins, formwork, screens, scaffolding, cranes, hoist, deliveries, crews.

use super::builder::{Builder, Tag, WorkId, Zone, at, mm, placed, turned};
use super::design::{BAY, FACADE, PLATE, Side};
use super::facade::{along, extent};
use super::palette as p;
use super::programme::{Window, Work};
use super::shapes::sides;
use glam::{Vec3, vec3};

const FENCE: Tag = Tag("FNC", "IfcRailing");
const CABIN: Tag = Tag("CAB", "IfcBuildingElementProxy");
const FORMWORK: Tag = Tag("FRM", "IfcBuildingElementProxy");
const PROPS: Tag = Tag("PRP", "IfcBuildingElementProxy");
const SCREEN: Tag = Tag("SCR", "IfcBuildingElementProxy");
const SCAFFOLD: Tag = Tag("SCF", "IfcBuildingElementProxy");
const NET: Tag = Tag("NET", "IfcBuildingElementProxy");
const MAST: Tag = Tag("CRM", "IfcTransportElement");
const CRANE: Tag = Tag("CRT", "IfcTransportElement");
const HOIST: Tag = Tag("HOI", "IfcTransportElement");
const LORRY: Tag = Tag("LOR", "IfcTransportElement");
const DIGGER: Tag = Tag("EXC", "IfcTransportElement");
const STOCK: Tag = Tag("STK", "IfcBuildingElementProxy");
const CREW: Tag = Tag("MAN", "IfcActor");
const TRADE: &str = "Temporary works";
const LOGISTICS: &str = "Logistics";

/// Adds all temporary things.
pub(super) fn add(b: &mut Builder) {
    fence(b);
    cabins(b);
    for storey in 1 - b.design.basements..=b.design.storeys {
        formwork(b, storey);
    }
    for storey in b.design.podium..=b.design.storeys {
        screens(b, storey);
    }
    scaffolding(b);
    cranes(b);
    hoist(b);
    earth_movers(b);
    deliveries(b);
    stock(b);
    crews(b);
}

fn temporary(
    b: &mut Builder,
    trade: &'static str,
    name: &'static str,
    storey: i32,
    on: Window,
    off: Window,
) -> WorkId {
    b.work(Work::temporary(trade, name, storey, on, off))
}

fn fence(b: &mut Builder) {
    let work = temporary(
        b,
        "Site setup",
        "Site fence",
        0,
        b.plan.share(0.0, 0.010),
        b.plan.share(0.974, 0.990),
    );
    let plot = b.design.plot();
    let length = if b.design.simple() {
        12.0
    } else if b.design.wealth < 0.1 {
        8.0
    } else {
        3.5
    };
    let gate = (plot[0] + plot[2]) * 0.5 - 12.0;
    for (side, from, to) in [
        (Side::South, plot[0], plot[2]),
        (Side::North, plot[0], plot[2]),
        (Side::East, plot[1], plot[3]),
        (Side::West, plot[1], plot[3]),
    ] {
        let count = ((to - from) / length) as i32;
        let width = (to - from) / count as f32;
        let panel = fence_panel(b, width);
        for k in 0..count {
            let t = from + width * (k as f32 + 0.5);
            let position = match side {
                Side::South => vec3(t, 0.0, plot[3] - 0.4),
                Side::North => vec3(t, 0.0, plot[1] + 0.4),
                Side::East => vec3(plot[2] - 0.4, 0.0, t),
                Side::West => vec3(plot[0] + 0.4, 0.0, t),
            };
            // The gate faces south.
            if side == Side::South && (t - gate).abs() < 6.0 && count > 8 {
                continue;
            }
            b.add(
                FENCE,
                Zone::Temporary,
                0,
                panel,
                placed(position, side.quarter(), Vec3::ONE),
                &[work],
            );
        }
    }
}

fn fence_panel(b: &mut Builder, width: f32) -> super::builder::ShapeId {
    b.shape("fence", &[mm(width)], move |lod, m| {
        let w = width * 0.5 - 0.02;
        m.cuboid(vec3(-w, 0.12, -0.02), vec3(w, 2.1, 0.02), p::WHITE);
        m.cuboid(vec3(-w, 1.55, 0.02), vec3(w, 1.95, 0.035), p::CABIN_BLUE);
        for x in [-w, w] {
            m.tube(vec3(x, 0.0, -0.06), vec3(x, 2.2, -0.06), 0.03, sides(lod), p::STEEL);
        }
        if lod >= 1 {
            m.bar(vec3(-w + 0.2, 1.7, -0.03), vec3(-w + 0.2, 0.05, -1.2), 0.05, 0.05, p::STEEL);
            m.cuboid(vec3(-w, 0.0, -1.3), vec3(-w + 0.6, 0.18, -0.9), p::CONCRETE_LIGHT);
        }
    })
}

fn cabins(b: &mut Builder) {
    let work = temporary(
        b,
        "Site setup",
        "Site cabins",
        0,
        b.plan.share(0.004, 0.018),
        b.plan.share(0.962, 0.976),
    );
    let plot = b.design.plot();
    let shape = b.shape("cabin", &[], |lod, m| {
        m.cuboid(vec3(-3.0, 0.12, -1.2), vec3(3.0, 2.75, 1.2), p::CABIN);
        m.cuboid(vec3(-3.03, 0.0, -1.23), vec3(3.03, 0.14, 1.23), p::CABIN_BLUE);
        m.cuboid(vec3(-3.03, 2.62, -1.23), vec3(3.03, 2.8, 1.23), p::CABIN_BLUE);
        m.cuboid(vec3(-1.6, 1.0, 1.2), vec3(0.0, 2.1, 1.23), p::CAR_GLASS);
        m.cuboid(vec3(1.2, 0.15, 1.2), vec3(2.1, 2.2, 1.23), p::CABIN_BLUE);
        for i in 0..[0, 2, 6, 10, 16, 24][lod] {
            let x = -2.9 + 5.8 * i as f32 / 24.0;
            m.cuboid(vec3(x, 0.3, -1.25), vec3(x + 0.1, 2.6, -1.2), p::CABIN);
        }
    });
    let columns = (9.0 * b.design.wealth.min(1.3)) as i32 + 1;
    for level in 0..2 {
        for k in 0..columns {
            let x = plot[0] + 6.5 + 6.2 * k as f32;
            b.add(
                CABIN,
                Zone::Temporary,
                0,
                shape,
                at(x, 0.02 + 2.82 * level as f32, plot[1] + 5.0),
                &[work],
            );
        }
    }
}

/// Formwork tables and props under the plates of a storey.
fn formwork(b: &mut Builder, storey: i32) {
    let d = b.design.clone();
    let tables = temporary(
        b,
        TRADE,
        "Formwork tables",
        storey,
        b.plan.structure(storey, 0.02, 0.28),
        b.plan.structure(storey, 2.1, 2.5),
    );
    let props = temporary(
        b,
        TRADE,
        "Props",
        storey,
        b.plan.structure(storey, 0.05, 0.34),
        b.plan.structure(storey, 2.5, 2.9),
    );
    let base = d.level(storey - 1);
    let height = d.level(storey) - PLATE - base - 0.01;
    let table = b.shape("formwork", &[mm(height)], move |lod, m| {
        let h = BAY * 0.5 - 0.32;
        m.cuboid(vec3(-h, height - 0.04, -h), vec3(h, height, h), p::FORM_PANEL);
        for k in 0..[0, 2, 3, 5, 7, 9][lod] {
            let x = -h + 0.3 + (2.0 * h - 0.6) * k as f32 / ([1, 1, 2, 4, 6, 8][lod]) as f32;
            m.cuboid(
                vec3(x - 0.05, height - 0.24, -h),
                vec3(x + 0.05, height - 0.04, h),
                p::FORM_BEAM,
            );
        }
    });
    let prop = b.shape("props", &[mm(height)], move |lod, m| {
        let n = sides(lod);
        for x in [-1.9, 1.9] {
            for z in [-1.9, 1.9] {
                m.tube(vec3(x, 0.13, z), vec3(x, height * 0.55, z), 0.045, n, p::RED);
                m.tube(vec3(x, height * 0.55, z), vec3(x, height - 0.25, z), 0.035, n, p::STEEL);
                if lod >= 2 {
                    m.block(vec3(x, 0.12, z), vec3(0.2, 0.02, 0.2), p::STEEL);
                }
            }
        }
    });
    for (i, j) in d.cells(storey - 1) {
        if d.role(i, j).is_none() {
            let (x, z) = d.middle(i, j);
            b.add(FORMWORK, Zone::Temporary, storey, table, at(x, base, z), &[tables]);
            if d.simple() {
                continue;
            }
            b.add(PROPS, Zone::Temporary, storey, prop, at(x, base, z), &[props]);
        }
    }
}

/// The screens that climb with the structure around its top floors.
fn screens(b: &mut Builder, storey: i32) {
    let d = b.design.clone();
    let work = temporary(
        b,
        TRADE,
        "Safety screens",
        storey,
        b.plan.structure(storey, 0.0, 0.3),
        b.plan.structure(storey, 2.85, 3.2),
    );
    let height = if storey == d.storeys { 2.4 } else { d.height(storey) - 0.06 };
    for run in d.outline(|i, j| d.plate(storey, i, j)) {
        let (start, length) = extent(&run, FACADE + 0.55);
        let count = if d.simple() { 1 } else { run.bays };
        let width = length / count as f32;
        let shape = b.shape("screen", &[mm(width), mm(height)], move |lod, m| {
            let w = width * 0.5 - 0.06;
            m.cuboid(vec3(-w, -0.5, 0.0), vec3(w, height - 0.52, 0.04), p::SCREEN);
            m.cuboid(vec3(-w, height * 0.36, 0.04), vec3(w, height * 0.44, 0.07), p::ORANGE);
            for x in [-w * 0.66, 0.0, w * 0.66].into_iter().take([0, 2, 3, 3, 3, 3][lod]) {
                m.cuboid(
                    vec3(x - 0.06, -0.4, -0.14),
                    vec3(x + 0.06, height - 0.6, 0.0),
                    p::STEEL_DARK,
                );
            }
            for k in 0..[0, 0, 1, 2, 4, 6][lod] {
                let y = 0.3 + k as f32 * 0.5;
                m.cuboid(vec3(-w, y, -0.09), vec3(w, y + 0.05, -0.04), p::STEEL);
            }
        });
        for k in 0..count {
            let x = start + width * (k as f32 + 0.5);
            b.add(
                SCREEN,
                Zone::Temporary,
                storey,
                shape,
                along(&run, x, FACADE + 0.55, d.level(storey)),
                &[work],
            );
        }
    }
}

/// Scaffolding and nets around the podium.
fn scaffolding(b: &mut Builder) {
    let d = b.design.clone();
    let lifts = (d.level(d.podium) / 2.0).ceil() as i32;
    let divide = if d.wealth < 0.1 { 1 } else { 2 };
    for lift in (0..lifts).filter(|l| !d.simple() || *l < 2) {
        let k = f64::from(lift) / f64::from(lifts);
        let on = b.plan.structure(0, 0.5 + f64::from(d.podium) * k, 0.9 + f64::from(d.podium) * k);
        let end = b.plan.fit(d.podium, 9.0 - 2.0 * k, 1.5);
        let tubes = temporary(b, TRADE, "Scaffolding", 0, on, end);
        let nets =
            temporary(b, TRADE, "Debris nets", 0, (on.1, on.1 + 400.0), (end.0 - 900.0, end.0));
        let y = 0.05 + lift as f32 * 2.0;
        for run in d.outline(|i, j| d.cell(0, i, j)) {
            let count = if d.simple() { 1 } else { run.bays * divide };
            let (start, length) = extent(&run, FACADE + 0.3);
            let width = length / count as f32;
            let bay = b.scaffold(width, lift + 1 == lifts);
            let net = b.unit_box(p::NET);
            for k in 0..count {
                let x = start + width * (k as f32 + 0.5);
                let place = along(&run, x, FACADE + 0.45, y);
                b.add(SCAFFOLD, Zone::Temporary, 0, bay, place, &[tubes]);
                if d.wealth >= 0.1 {
                    let net_place = along(&run, x, FACADE + 1.72, y + 0.02)
                        * glam::Affine3A::from_scale(vec3(width - 0.02, 1.96, 0.015));
                    b.add(NET, Zone::Temporary, 0, net, net_place, &[nets]);
                }
            }
        }
    }
}

/// Height of one mast section, metres.
const SECTION: f32 = 5.8;

fn cranes(b: &mut Builder) {
    let d = b.design.clone();
    let [x0, _, x1, _] = d.podium_outline();
    let count = if d.bays < 5 { 1 } else { 2 };
    let reach = (x1 - x0) * 0.42 + 24.0;
    for (k, x, z) in [(0, x0 - 5.0, 5.0), (1, x1 + 5.0, -7.0)].into_iter().take(count) {
        crane(b, k, vec3(x, 0.0, z), (reach * 2.0).round() * 0.5);
    }
}

/// Working minute from which the mast must reach a height.
fn needed(b: &Builder, height: f32) -> f64 {
    let d = &b.design;
    let storey = (0..d.storeys).find(|&s| d.level(s + 1) > height).unwrap_or(d.storeys);
    b.plan.structure(storey, -0.5, 0.0).0
}

/// One climbing tower crane: sections join the mast, the top moves up and turns.
fn crane(b: &mut Builder, number: i32, foot: Vec3, reach: f32) {
    let d = b.design.clone();
    let rich = d.wealth;
    let roof = d.level(d.storeys);
    let ahead = 12.0 + 8.0 * number as f32;
    let (begin, end) = (b.plan.share(0.125, 0.132), b.plan.share(0.872, 0.884));
    let first = 6 + number;
    let last = (((roof + ahead + roof * 0.1) / SECTION).ceil() as i32).max(first);
    let climb = 3;
    let mast = b.mast(2.2, SECTION, p::CRANE);
    let climbs = (last - first + climb - 1) / climb;
    // Mast sections, and the moments at which the top moves up.
    let mut moves = vec![begin.0];
    let pieces = b.work(Work::temporary(
        LOGISTICS,
        "Crane base mast",
        0,
        begin,
        (end.0 + 1500.0, end.1 + 2100.0),
    ));
    let pad = b.unit_box(p::CONCRETE_LIGHT);
    let place = placed(vec3(foot.x, -0.3, foot.z), 0, vec3(5.6, 0.72, 5.6));
    b.add(MAST, Zone::Temporary, 0, pad, place, &[pieces]);
    for s in 0..first {
        b.add(
            MAST,
            Zone::Temporary,
            0,
            mast,
            at(foot.x, 0.4 + SECTION * s as f32, foot.z),
            &[pieces],
        );
    }
    for k in 0..climbs {
        let height = (first + climb * k) as f32 * SECTION - ahead;
        let at_minute = needed(b, height).max(moves[k as usize] + 2700.0).min(end.0 - 2700.0);
        moves.push(at_minute);
        let off = (end.0 + 1400.0 - 100.0 * f64::from(k), end.0 + 1500.0 - 100.0 * f64::from(k));
        let work = temporary(
            b,
            LOGISTICS,
            "Crane climbing sections",
            0,
            (at_minute - 240.0, at_minute),
            off,
        );
        for s in 0..climb.min(last - first - climb * k) {
            let y = 0.4 + SECTION * (first + climb * k + s) as f32;
            b.add(MAST, Zone::Temporary, 0, mast, at(foot.x, y, foot.z), &[work]);
        }
        tie(b, foot, 0.4 + SECTION * (first + climb * k) as f32 - SECTION * 2.0, work);
    }
    moves.push(end.0);
    let turns = ((5.0 * rich.min(1.6)) as i32 + 1).max(2);
    let mut random = super::random::Random::new(0xc4a7e + number as u64);
    for (k, pair) in moves.windows(2).enumerate() {
        let sections = (first + climb * k as i32).min(last);
        let y = 0.4 + SECTION * sections as f32;
        for turn in 0..turns {
            let share = |t: i32| pair[0] + (pair[1] - pair[0]) * f64::from(t) / f64::from(turns);
            // Whole quarters of an hour, so that one place ends exactly when the next begins.
            let (from, to) =
                ((share(turn) / 15.0).round() * 15.0, (share(turn + 1) / 15.0).round() * 15.0);
            if to - from < 30.0 {
                continue;
            }
            let work = temporary(b, LOGISTICS, "Crane at work", 0, (from, from), (to, to));
            let top = b.crane_top(reach, 35 + 8 * random.below(7) as i32);
            // Roughly towards the tower, and away from it once the crown stands.
            let towards = if number == 0 { 0.0 } else { 0.5 };
            let away = if k + 2 >= moves.len() { 0.5 } else { 0.0 };
            let angle = towards + away + random.between(-0.21, 0.21);
            b.add(
                CRANE,
                Zone::Temporary,
                0,
                top,
                turned(vec3(foot.x, y, foot.z), angle, Vec3::ONE),
                &[work],
            );
        }
    }
}

/// Struts between a mast and the building at a height.
fn tie(b: &mut Builder, foot: Vec3, y: f32, work: WorkId) {
    let d = &b.design;
    let storey = (0..d.storeys).rev().find(|&s| d.level(s) <= y);
    let Some(storey) = storey.filter(|&s| s > 1) else { return };
    let face = if storey < d.podium {
        let [x0, _, x1, _] = d.podium_outline();
        if foot.x < 0.0 { x0 } else { x1 }
    } else {
        let tower = d.tower(storey);
        if foot.x < 0.0 { d.line(tower.x0) } else { d.line(tower.x1) }
    };
    let length = (face - foot.x).abs() - 0.7;
    let shape = b.shape("crane tie", &[mm(length)], move |_, m| {
        for z in [-1.0, 1.0] {
            m.bar(vec3(1.0, 0.0, z), vec3(length, 0.0, z * 2.6), 0.25, 0.25, p::CRANE);
        }
        m.cuboid(vec3(-1.4, -0.2, -1.4), vec3(1.4, 0.2, -1.15), p::CRANE);
        m.cuboid(vec3(-1.4, -0.2, 1.15), vec3(1.4, 0.2, 1.4), p::CRANE);
    });
    let quarter = if foot.x < 0.0 { 0 } else { 2 };
    let y = b.design.level(storey) - 0.15;
    b.add(
        MAST,
        Zone::Temporary,
        0,
        shape,
        placed(vec3(foot.x, y, foot.z), quarter, Vec3::ONE),
        &[work],
    );
}

/// A hoist on the north side: its mast grows with the storeys, its car is seen at many of them.
fn hoist(b: &mut Builder) {
    let d = b.design.clone();
    if d.bays <= 3 {
        return;
    }
    let z = d.line(d.tower(d.podium).z0) - FACADE - 1.9;
    let x = -1.0;
    let top = (d.podium..d.storeys).take_while(|&s| d.tower(s).z0 == d.tower(d.podium).z0).count()
        as i32
        + d.podium;
    let out = b.plan.share(0.925, 0.94);
    for storey in d.podium..top {
        let k = f64::from(storey - d.podium) / f64::from(top - d.podium);
        let length = (out.1 - out.0) * 0.9;
        let off = (out.1 - length * (k + 0.05), out.1 - length * k);
        let work =
            temporary(b, LOGISTICS, "Hoist mast", storey, b.plan.structure(storey, 3.3, 3.5), off);
        let mast = b.mast(0.8, d.height(storey), p::RED);
        b.add(HOIST, Zone::Temporary, storey, mast, at(x, d.level(storey) + 0.15, z), &[work]);
        let gate = b.unit_box(p::ORANGE);
        b.add(
            HOIST,
            Zone::Temporary,
            storey,
            gate,
            placed(vec3(x - 1.6, d.level(storey) + 0.16, z + 1.0), 0, vec3(1.4, 1.1, 0.06)),
            &[work],
        );
    }
    let car = b.shape("hoist car", &[], |lod, m| {
        m.cuboid(vec3(-2.3, 0.2, -0.7), vec3(-0.7, 2.7, 0.7), p::ORANGE);
        m.cuboid(vec3(-2.35, 0.1, -0.75), vec3(-0.65, 0.2, 0.75), p::STEEL_DARK);
        for k in 0..[0, 2, 4, 6, 8, 10][lod] {
            let z = -0.65 + 0.13 * k as f32;
            m.cuboid(vec3(-2.33, 0.4, z), vec3(-2.3, 2.5, z + 0.05), p::STEEL);
        }
    });
    let stops = (40.0 * d.wealth.min(1.5)) as i32 + 1;
    let (from, to) = (b.plan.structure(d.podium, 4.0, 4.0).0, out.0);
    let mut random = super::random::Random::new(0x4015);
    for stop in 0..stops {
        let time =
            |k: i32| ((from + (to - from) * f64::from(k) / f64::from(stops)) / 15.0).round() * 15.0;
        let built = (d.podium..top)
            .take_while(|&s| b.plan.structure(s, 3.5, 3.5).0 < time(stop))
            .count()
            .max(1);
        let storey = d.podium + random.below(built) as i32;
        let work = temporary(
            b,
            LOGISTICS,
            "Hoist car",
            storey,
            (time(stop), time(stop)),
            (time(stop + 1), time(stop + 1)),
        );
        b.add(HOIST, Zone::Temporary, storey, car, at(x, d.level(storey) + 0.15, z), &[work]);
    }
}

fn earth_movers(b: &mut Builder) {
    let [x0, z0, x1, z1] = super::surroundings::pit(b);
    let digger = b.excavator();
    let count = (5.0 * b.design.wealth.min(1.6)) as i32 + 1;
    let mut random = super::random::Random::new(0xd166);
    for k in 0..count {
        // Beside the house while it comes down, then on the ramp's edge of the pit.
        let (x, z) = (
            x0 + (x1 - x0) * (k as f32 + 0.5) / count as f32,
            if k % 2 == 0 { z1 + 4.5 } else { z0 - 5.5 },
        );
        let on = b.plan.share(0.02 + 0.001 * f64::from(k), 0.021 + 0.001 * f64::from(k));
        let off = b.plan.share(0.15, 0.155);
        let work = temporary(b, "Earthworks", "Excavator", 0, on, off);
        let turn = if k % 2 == 0 { 0.25 } else { 0.75 } + random.between(-0.1, 0.1);
        b.add(
            DIGGER,
            Zone::Temporary,
            0,
            digger,
            turned(vec3(x, 0.02, z), turn, Vec3::ONE),
            &[work],
        );
    }
}

fn deliveries(b: &mut Builder) {
    let plot = b.design.plot();
    let work = temporary(
        b,
        LOGISTICS,
        "Delivery",
        0,
        b.plan.share(0.02, 0.955),
        b.plan.share(0.024, 0.959),
    );
    let kinds = [
        b.lorry(0, p::CAR_BLUE),
        b.lorry(1, p::WHITE),
        b.lorry(2, p::RED),
        b.lorry(1, p::CABIN_BLUE),
        b.lorry(2, p::YELLOW),
    ];
    let count = (180.0 * b.design.wealth.min(2.5)) as i32 + 4;
    let mut random = super::random::Random::new(0x10b1);
    let width = plot[2] - plot[0];
    for k in 0..count {
        let early = k * 8 < count;
        let kind = if early { 0 } else { 1 + random.below(4) };
        // Bays along the haul road, used in turn so that no two lorries share one.
        let bay = (k % 4) as f32;
        let x = plot[0] + width * (0.22 + 0.19 * bay) + random.between(-1.0, 1.0);
        let place = vec3(x, 0.03, plot[3] - 9.0 - 3.6 * (k / 4 % 2) as f32);
        b.add(
            LORRY,
            Zone::Temporary,
            0,
            kinds[kind],
            placed(place, if k % 3 == 0 { 2 } else { 0 }, Vec3::ONE),
            &[work],
        );
    }
}

fn stock(b: &mut Builder) {
    let plot = b.design.plot();
    let kinds = [0, 1, 2, 3].map(|k| pile(b, k));
    let rich = b.design.wealth.min(2.0);
    let rows = (10.0 * rich) as i32 + 1;
    for round in 0..if rich < 0.1 { 1 } else { 5 } {
        let from = 0.16 + 0.15 * f64::from(round);
        let work = temporary(
            b,
            LOGISTICS,
            "Stock pile",
            0,
            b.plan.share(from, from + 0.09),
            b.plan.share(from + 0.05, from + 0.148),
        );
        for k in 0..rows {
            let (x, quarter) = if k % 2 == 0 { (plot[0] + 6.0, 1) } else { (plot[2] - 6.0, 3) };
            let z = plot[1]
                + 14.0
                + (plot[3] - plot[1] - 40.0) * (k / 2) as f32 / (rows / 2 + 1) as f32;
            // Crane masts stand in the middle of both sides.
            let x = if (-13.0..11.0).contains(&z) { x + 2.5f32.copysign(x) } else { x };
            let kind = (k + round) as usize % 4;
            b.add(
                STOCK,
                Zone::Temporary,
                0,
                kinds[kind],
                placed(vec3(x, 0.02, z), quarter, Vec3::ONE),
                &[work],
            );
        }
    }
}

/// A stock pile: reinforcement, timber, bricks on pallets, pipes.
fn pile(b: &mut Builder, kind: i32) -> super::builder::ShapeId {
    b.shape("stock", &[kind], move |lod, m| {
        let n = sides(lod);
        for x in [-1.8, 0.0, 1.8] {
            m.cuboid(vec3(x - 0.06, 0.0, -0.8), vec3(x + 0.06, 0.12, 0.8), p::TIMBER_OLD);
        }
        match kind {
            0 => {
                for k in 0..[4, 8, 14, 22, 30, 40][lod] {
                    let (row, i) = (k / 10, k % 10);
                    let (y, z) = (0.16 + 0.09 * row as f32, -0.7 + 0.15 * i as f32);
                    m.tube(vec3(-3.2, y, z), vec3(3.2, y, z), 0.035, n, p::BRONZE);
                }
            }
            1 => {
                for k in 0..4 {
                    m.cuboid(
                        vec3(-2.2, 0.13 + 0.3 * k as f32, -0.7),
                        vec3(2.2, 0.4 + 0.3 * k as f32, 0.7),
                        p::TIMBER,
                    );
                }
            }
            2 => {
                for k in 0..3 {
                    let x = -1.7 + 1.7 * k as f32;
                    m.cuboid(vec3(x - 0.6, 0.13, -0.6), vec3(x + 0.6, 1.2, 0.6), p::GYPSUM);
                    m.cuboid(vec3(x - 0.62, 0.5, -0.62), vec3(x + 0.62, 0.56, 0.62), p::BLACK);
                }
            }
            _ => {
                let rows: &[i32] = &[5, 4, 3];
                for (row, &count) in rows.iter().enumerate() {
                    for i in 0..count {
                        let z = (i as f32 - (count - 1) as f32 * 0.5) * 0.34;
                        let y = 0.29 + 0.3 * row as f32;
                        m.cone(
                            vec3(-2.6, y, z),
                            vec3(2.6, y, z),
                            0.16,
                            0.16,
                            n.max(6),
                            p::PIPE_BLUE,
                        );
                    }
                }
            }
        }
    })
}

/// People on the deck that is being cast, and some on the ground.
fn crews(b: &mut Builder) {
    let d = b.design.clone();
    let shapes = [0, 1, 2].map(|k| b.worker(k));
    let per = (7.0 * d.wealth.min(1.5)) as usize + 1;
    let mut random = super::random::Random::new(0xc4e3);
    for storey in 1 - d.basements..d.storeys {
        let work = temporary(
            b,
            LOGISTICS,
            "Crew on the deck",
            storey,
            b.plan.structure(storey, 0.62, 0.66),
            b.plan.structure(storey, 1.3, 1.5),
        );
        let cells: Vec<_> =
            d.cells(storey).into_iter().filter(|&(i, j)| d.role(i, j).is_none()).collect();
        for k in 0..per {
            let (i, j) = cells[random.below(cells.len())];
            let (x, z) = d.middle(i, j);
            let place = vec3(
                x + random.between(-2.0, 2.0),
                d.level(storey) + 0.01,
                z + random.between(-2.0, 2.0),
            );
            b.add(
                CREW,
                Zone::Temporary,
                storey,
                shapes[k % 3],
                turned(place, random.unit(), Vec3::ONE),
                &[work],
            );
        }
    }
    let plot = d.plot();
    let work =
        temporary(b, LOGISTICS, "Ground crew", 0, b.plan.share(0.02, 0.5), b.plan.share(0.3, 0.95));
    for k in 0..(40.0 * d.wealth.min(1.5)) as usize + 2 {
        let x = random.between(plot[0] + 8.0, plot[2] - 8.0);
        let place = vec3(x, 0.02, plot[3] - random.between(14.5, 19.5));
        b.add(
            CREW,
            Zone::Temporary,
            0,
            shapes[k % 3],
            turned(place, random.unit(), Vec3::ONE),
            &[work],
        );
    }
}
