//! How large the project is: storeys, bays and where the tower stands on its grid.
//!
//! Every storey is a set of square cells of one grid. The podium spreads beyond the tower; the tower
//! steps back twice and has notched corners. All structure, facade and fittings follow from the set.

use super::random::Random;

/// Width of a cell in metres.
pub(super) const BAY: f32 = 6.0;
/// How far a floor plate reaches beyond its outermost grid line, metres.
pub(super) const OVERHANG: f32 = 0.38;
/// Distance of the facade's plane from the outermost grid line, metres.
pub(super) const FACADE: f32 = 0.52;
/// Thickness of a floor plate in metres.
pub(super) const PLATE: f32 = 0.28;

/// A rectangle of cells: `x0 <= i < x1`, `z0 <= j < z1`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Cells {
    pub x0: i32,
    pub z0: i32,
    pub x1: i32,
    pub z1: i32,
}

impl Cells {
    fn has(&self, i: i32, j: i32) -> bool {
        self.x0 <= i && i < self.x1 && self.z0 <= j && j < self.z1
    }

    fn is_corner(&self, i: i32, j: i32) -> bool {
        (i == self.x0 || i == self.x1 - 1) && (j == self.z0 || j == self.z1 - 1)
    }

    pub(super) fn iter(self) -> impl Iterator<Item = (i32, i32)> {
        (self.z0..self.z1).flat_map(move |j| (self.x0..self.x1).map(move |i| (i, j)))
    }
}

/// What a cell of the core holds.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Role {
    Stair,
    Lift,
    Riser,
    Lobby,
}

/// The four sides of a cell, as the direction that a wall there faces.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Side {
    South,
    East,
    North,
    West,
}

impl Side {
    pub(super) const ALL: [Self; 4] = [Self::South, Self::East, Self::North, Self::West];

    /// The step to the neighbouring cell.
    pub(super) fn step(self) -> (i32, i32) {
        match self {
            Self::South => (0, 1),
            Self::East => (1, 0),
            Self::North => (0, -1),
            Self::West => (-1, 0),
        }
    }

    /// Quarter turns about Y that bring +Z to this direction.
    pub(super) fn quarter(self) -> u8 {
        self as u8
    }
}

/// A straight piece of a storey's outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub side: Side,
    /// Length along the grid lines in bays.
    pub bays: i32,
    /// Middle of the run on the grid line, metres.
    pub x: f32,
    pub z: f32,
    /// How far a wall at distance 1 beyond the grid line reaches past the run at its left and right
    /// end, seen from outside: 1 at a convex corner, -1 at a concave one.
    pub left: f32,
    pub right: f32,
    /// Cells of the run, left to right seen from outside.
    pub first: (i32, i32),
}

/// Sizes of the project.
#[derive(Clone, Debug)]
pub(super) struct Design {
    /// Storeys above ground.
    pub storeys: i32,
    /// Storeys below ground.
    pub basements: i32,
    /// Storeys of the podium.
    pub podium: i32,
    /// Width of the tower in bays.
    pub bays: i32,
    /// Facade panels a bay.
    pub panels: i32,
    /// Stands for the size of site and surroundings; 1 at the default size.
    pub wealth: f32,
    podium_cells: Cells,
    tiers: [Cells; 3],
    tier_from: [i32; 3],
    core: Cells,
}

/// Elements, storeys and bays of designs that look right; between them is interpolated.
const SIZES: [(u32, f32, f32); 8] = [
    (600, 3.0, 3.0),
    (1_000, 4.0, 3.0),
    (5_000, 12.0, 4.0),
    (20_000, 28.0, 5.3),
    (79_396, 57.0, 7.4),
    (250_000, 72.0, 11.4),
    (1_000_000, 90.0, 20.4),
    (2_000_000, 100.0, 28.4),
];

impl Design {
    /// A design for about `elements` elements.
    pub(super) fn new(elements: u32, seed: u64) -> Self {
        let elements = elements.clamp(SIZES[0].0, SIZES[SIZES.len() - 1].0);
        let k = SIZES.windows(2).position(|w| elements <= w[1].0).unwrap_or(SIZES.len() - 2);
        let (a, b) = (SIZES[k], SIZES[k + 1]);
        let t = (elements - a.0) as f32 / (b.0 - a.0) as f32;
        let storeys = (a.1 + (b.1 - a.1) * t) as i32;
        let bays = (a.2 + (b.2 - a.2) * t) as i32;
        let mut random = Random::new(seed ^ 0xde51);
        let wide = (bays / 4 + 1).min(4);
        let (east, west) = if random.below(2) == 0 { (wide, wide - 1) } else { (wide - 1, wide) };
        let podium_cells = Cells {
            x0: -west,
            z0: if bays > 6 { -1 } else { 0 },
            x1: bays + east,
            z1: if elements < 2_000 { bays } else { bays + wide },
        };
        let full = Cells { x0: 0, z0: 0, x1: bays, z1: bays };
        let step = if bays > 10 { 2 } else { 1 };
        let tiers = match bays {
            ..=3 => [full; 3],
            4 => [full, Cells { x1: 3, ..full }, Cells { x1: 3, ..full }],
            5 => [full, Cells { x0: 1, ..full }, Cells { x0: 1, z1: 4, ..full }],
            _ => {
                let narrow = Cells { x0: step, x1: bays - step, ..full };
                [full, narrow, Cells { z0: step, z1: bays - step, ..narrow }]
            }
        };
        let podium = (storeys / 12).clamp(1, 3);
        let shift = random.below(3) as i32;
        let at = |share: i32| podium + (storeys - podium) * share / 100;
        let core_bays = match bays {
            ..=3 => 1,
            4 => 2,
            n => n / 2 - (n / 2 + n) % 2,
        };
        let (cx, cz) = ((bays - core_bays) / 2, (bays - core_bays) / 2);
        Self {
            storeys,
            basements: if bays >= 7 {
                3
            } else if bays >= 5 {
                2
            } else {
                1
            },
            podium,
            bays,
            panels: if elements < 1_400 {
                1
            } else if elements < 3_000 {
                2
            } else if elements < 12_000 {
                3
            } else {
                4
            },
            wealth: match elements {
                ..5_000 => elements as f32 / 79_396.0 * 2.0,
                5_000..79_396 => 0.13 + 0.87 * (elements - 5_000) as f32 / 74_396.0,
                _ => 1.0 + (elements - 79_396) as f32 / 500_000.0,
            },
            podium_cells,
            tiers,
            tier_from: [podium, at(44 + shift), at(74 + shift)],
            core: Cells { x0: cx, z0: cz, x1: cx + core_bays, z1: cz + core_bays },
        }
    }

    /// Whether the project is so small that it must do with the least of everything.
    pub(super) fn simple(&self) -> bool {
        self.wealth < 0.06
    }

    fn tier(&self, storey: i32) -> usize {
        (1..3).rev().find(|&t| storey >= self.tier_from[t]).unwrap_or(0)
    }

    /// The tower's rectangle at a storey, without regard to its notches.
    pub(super) fn tower(&self, storey: i32) -> Cells {
        self.tiers[self.tier(storey)]
    }

    pub(super) fn podium_cells(&self) -> Cells {
        self.podium_cells
    }

    pub(super) fn core(&self) -> Cells {
        self.core
    }

    /// Whether a storey has the cell (i, j).
    pub(super) fn cell(&self, storey: i32, i: i32, j: i32) -> bool {
        if storey < -self.basements || storey >= self.storeys {
            return false;
        }
        if storey < self.podium {
            return self.podium_cells.has(i, j);
        }
        let tier = self.tower(storey);
        let notched = tier.x1 - tier.x0 >= 4 && tier.z1 - tier.z0 >= 4;
        tier.has(i, j) && !(notched && tier.is_corner(i, j))
    }

    /// All cells of a storey, row by row.
    pub(super) fn cells(&self, storey: i32) -> Vec<(i32, i32)> {
        self.podium_cells.iter().filter(|&(i, j)| self.cell(storey, i, j)).collect()
    }

    /// Cells of the floor plate of a storey: under its own cells and over those below.
    pub(super) fn plate(&self, storey: i32, i: i32, j: i32) -> bool {
        self.cell(storey, i, j) || self.cell(storey - 1, i, j)
    }

    /// What the core holds at a cell; `None` outside the core.
    pub(super) fn role(&self, i: i32, j: i32) -> Option<Role> {
        if !self.core.has(i, j) {
            return None;
        }
        let (w, d) = (self.core.x1 - self.core.x0, self.core.z1 - self.core.z0);
        let k = (j - self.core.z0) * w + i - self.core.x0;
        Some(if k == 0 || k == w * d - 1 {
            Role::Stair
        } else if (j - self.core.z0) % 2 == 1 && w >= 3 {
            Role::Lobby
        } else if k == w - 1 || k == w * d - w {
            Role::Riser
        } else {
            Role::Lift
        })
    }

    /// Height of a storey's floor in metres; `storeys` itself is the roof.
    pub(super) fn level(&self, storey: i32) -> f32 {
        let podium = storey.clamp(0, self.podium);
        let podium_height = if podium == 0 { 0.0 } else { 6.0 + (podium - 1) as f32 * 4.6 };
        let tower = (storey - self.podium).max(0) as f32 * 3.85;
        let below = storey.min(0) as f32 * 3.7;
        0.3 + podium_height + tower + below
    }

    /// Height from floor to floor in metres.
    pub(super) fn height(&self, storey: i32) -> f32 {
        self.level(storey + 1) - self.level(storey)
    }

    /// Storeys that hold plant behind louvres.
    pub(super) fn technical(&self, storey: i32) -> bool {
        self.storeys >= 12
            && storey >= self.podium
            && (storey + 1 == self.tier_from[1] || storey + 1 == self.tier_from[2])
    }

    /// Position of a grid line in metres; the tower's middle is 0.
    pub(super) fn line(&self, index: i32) -> f32 {
        (index as f32 - self.bays as f32 * 0.5) * BAY
    }

    /// Middle of a cell, (x, z) in metres.
    pub(super) fn middle(&self, i: i32, j: i32) -> (f32, f32) {
        (self.line(i) + BAY * 0.5, self.line(j) + BAY * 0.5)
    }

    /// The podium's outline on the grid as [x0, z0, x1, z1] in metres.
    pub(super) fn podium_outline(&self) -> [f32; 4] {
        let c = self.podium_cells;
        [self.line(c.x0), self.line(c.z0), self.line(c.x1), self.line(c.z1)]
    }

    /// The building plot inside the fence, [x0, z0, x1, z1] in metres.
    pub(super) fn plot(&self) -> [f32; 4] {
        let [x0, z0, x1, z1] = self.podium_outline();
        [x0 - 17.0, z0 - 14.0, x1 + 17.0, z1 + 24.0]
    }

    /// Straight pieces of the outline of the cells for which `has` holds.
    pub(super) fn outline(&self, has: impl Fn(i32, i32) -> bool) -> Vec<Run> {
        let c = self.podium_cells;
        let mut runs = Vec::new();
        for side in Side::ALL {
            let (dx, dz) = side.step();
            // Seen from outside, left to right.
            let (ax, az) = (dz, -dx);
            let edge = |i: i32, j: i32| has(i, j) && !has(i + dx, j + dz);
            for (i, j) in c.iter() {
                if !edge(i, j) || edge(i - ax, j - az) {
                    continue;
                }
                let bays = (1..).find(|n| !edge(i + ax * n, j + az * n)).unwrap_or(1);
                let last = (i + ax * (bays - 1), j + az * (bays - 1));
                let end = |p: (i32, i32), s: i32| {
                    let next = (p.0 + ax * s, p.1 + az * s);
                    if has(next.0 + dx, next.1 + dz) { -1.0 } else { 1.0 }
                };
                let (m0, m1) = (self.middle(i, j), self.middle(last.0, last.1));
                runs.push(Run {
                    side,
                    bays,
                    x: (m0.0 + m1.0) * 0.5 + dx as f32 * BAY * 0.5,
                    z: (m0.1 + m1.1) * 0.5 + dz as f32 * BAY * 0.5,
                    left: end((i, j), -1),
                    right: end(last, 1),
                    first: (i, j),
                });
            }
        }
        runs
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn outline_closes_and_corners_balance() {
        for (elements, storey) in
            [(1_000, 1), (20_000, 9), (79_396, 9), (79_396, 50), (1_000_000, 80)]
        {
            let design = Design::new(elements, 4);
            let runs = design.outline(|i, j| design.cell(storey, i, j));
            let length =
                |side| -> i32 { runs.iter().filter(|r| r.side == side).map(|r| r.bays).sum() };
            assert_eq!(length(Side::South), length(Side::North));
            assert_eq!(length(Side::East), length(Side::West));
            // A closed outline without holes turns once: four more convex corners than concave ones.
            let turns: f32 = runs.iter().map(|r| r.left).sum();
            assert_eq!(turns, 4.0, "{elements} {storey}");
        }
    }

    #[test]
    fn core_stays_inside_every_storey() {
        for elements in [1_000, 3_000, 5_000, 20_000, 79_396, 300_000, 1_000_000] {
            let design = Design::new(elements, 1);
            for storey in -design.basements..design.storeys {
                for (i, j) in design.core().iter() {
                    assert!(design.cell(storey, i, j), "{elements}: {storey} {i} {j}");
                }
            }
        }
    }

    #[test]
    fn storeys_stand_on_storeys() {
        let design = Design::new(79_396, 4);
        for storey in 1..design.storeys {
            assert!(design.cells(storey).iter().all(|&(i, j)| design.cell(storey - 1, i, j)));
            assert!(design.height(storey) > 3.0);
        }
    }
}
