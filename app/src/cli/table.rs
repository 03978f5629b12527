//! The paper's table as text.

use super::bench::RuleCell;
use crate::bench::{Cell, Coverage, Moment, mode_name};
use crate::flip::Difference;
use crate::report::{columns, grouped};
use topout_render::DrawMode;

/// Frame times of the paper (H16) in ms: HDLOD at 1/1, 1/4, 1/16, then without it.
const PAPER: [[f64; 4]; 5] = [
    [7.02, 1.5, 0.66, 40.88],
    [8.7, 2.75, 0.71, 82.9],
    [26.47, 2.93, 0.74, 121.3],
    [28.17, 3.15, 0.76, 164.83],
    [18.63, 2.87, 0.72, 105.4],
];

/// A cell that is not slower than this many empty frames needs no further speed-up.
pub const NEAR_EMPTY: f64 = 1.5;

fn find(cells: &[Cell], moment: Moment, coverage: Coverage, mode: DrawMode) -> Option<&Cell> {
    cells.iter().find(|c| c.moment == moment && c.coverage == coverage && c.mode == mode)
}

/// The one draw call per object that a row is compared with.
fn baseline(cells: &[Cell], moment: Moment) -> Option<&Cell> {
    find(cells, moment, Coverage::Full, DrawMode::Objects)
}

fn ms(value: f64) -> String {
    match value {
        v if v < 10.0 => format!("{v:.2}"),
        v if v < 100.0 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}

fn factor(value: f64) -> String {
    if value < 9.95 { format!("{value:.1}x") } else { format!("{value:.0}x") }
}

/// Frame times, in brackets the speed-up over the row's last column, as the paper prints them.
pub fn measured(cells: &[Cell]) -> String {
    let modes = [DrawMode::Hdlod, DrawMode::Batched, DrawMode::Objects];
    let heads: Vec<(DrawMode, Coverage, &str)> = modes
        .iter()
        .flat_map(|&mode| Coverage::ALL.map(|(coverage, name)| (mode, coverage, name)))
        .filter(|&(mode, coverage, _)| {
            cells.iter().any(|c| c.mode == mode && c.coverage == coverage)
        })
        .collect();
    let mut rows = vec![vec!["Frame time (ms)".to_owned()]];
    rows[0].extend(heads.iter().map(|(mode, _, name)| format!("{} {name}", mode_name(*mode))));
    for (moment, name) in Moment::ALL {
        let mut row = vec![name.to_owned()];
        for &(mode, coverage, _) in &heads {
            row.push(find(cells, moment, coverage, mode).map_or("-".to_owned(), |cell| {
                match baseline(cells, moment).filter(|_| mode != DrawMode::Objects) {
                    Some(slow) => {
                        format!("{} ({})", ms(cell.frame_ms), factor(slow.frame_ms / cell.frame_ms))
                    }
                    None => ms(cell.frame_ms),
                }
            }));
        }
        rows.push(row);
    }
    columns(&rows)
}

/// HDLOD beside batched, beside the paper's figures, and how true its pictures are.
pub fn compared(cells: &[Cell]) -> String {
    if !cells.iter().any(|c| c.mode == DrawMode::Hdlod) {
        return String::new();
    }
    let head = [
        "HDLOD",
        "",
        "over objects",
        "the paper's",
        "over batched",
        "triangles",
        "left",
        "of",
        "FLIP",
        "coverage",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
    for (row, (moment, name)) in Moment::ALL.into_iter().enumerate() {
        for (column, (coverage, at)) in Coverage::ALL.into_iter().enumerate() {
            let Some(cell) = find(cells, moment, coverage, DrawMode::Hdlod) else { continue };
            let gain = |slow: Option<&Cell>| {
                or_dash(slow.map(|slow| factor(slow.frame_ms / cell.frame_ms)))
            };
            let batched = find(cells, moment, coverage, DrawMode::Batched);
            rows.push(vec![
                name.to_owned(),
                at.to_owned(),
                gain(baseline(cells, moment)),
                factor(PAPER[row][3] / PAPER[row][column]),
                gain(batched),
                grouped(cell.triangles),
                or_dash(cell.left.map(grouped)),
                or_dash(batched.map(|b| grouped(b.triangles))),
                or_dash(cell.flip.map(|f| format!("{f:.3}"))),
                or_dash(cell.coverage_change.map(|c| format!("{:+.1} %", c * 100.0))),
            ]);
        }
    }
    format!("\n{}", columns(&rows))
}

/// Both promises over time side by side: what they cost, and how far their pictures are from full
/// detail.
pub fn rules(cells: &[RuleCell]) -> String {
    let rules = ["tight", "paper"];
    let mut rows = vec![vec!["Exact in time / paper's delta".to_owned(), String::new()]];
    for rule in rules {
        let names = ["ms", "triangles", "clusters", "FLIP", "coverage"];
        rows[0].extend(names.map(|name| format!("{rule} {name}")));
    }
    for (moment, at) in Moment::ALL {
        for (coverage, from) in Coverage::ALL {
            let of = |rule: &str| {
                let same = |c: &&RuleCell| {
                    (c.temporal, c.cell.moment, c.cell.coverage) == (rule, moment, coverage)
                };
                cells.iter().find(same).map(|c| &c.cell)
            };
            let (Some(tight), Some(paper)) = (of(rules[0]), of(rules[1])) else { continue };
            let mut row = vec![at.to_owned(), from.to_owned()];
            for cell in [tight, paper] {
                row.extend([
                    ms(cell.frame_ms),
                    grouped(cell.triangles),
                    grouped(cell.clusters),
                    cell.flip.map_or("-".to_owned(), |f| format!("{f:.3}")),
                    cell.coverage_change.map_or("-".to_owned(), |c| format!("{:+.1} %", c * 100.0)),
                ]);
            }
            rows.push(row);
        }
    }
    if rows.len() > 1 { format!("\n{}", columns(&rows)) } else { String::new() }
}

/// Whether HDLOD is worth it in every cell, and true; names the cells where it is not.
pub fn verdict(cells: &[Cell], empty_ms: f64) -> String {
    let mut text = String::new();
    for cell in cells.iter().filter(|c| c.mode == DrawMode::Hdlod) {
        let place = format!("{} {}", cell.moment.name(), cell.coverage.name());
        let rivals = [
            find(cells, cell.moment, cell.coverage, DrawMode::Batched),
            baseline(cells, cell.moment),
        ];
        for rival in rivals.into_iter().flatten() {
            if cell.frame_ms >= rival.frame_ms && cell.frame_ms > NEAR_EMPTY * empty_ms {
                text.push_str(&format!(
                    "{place}: HDLOD ({} ms) is not faster than {} ({} ms)\n",
                    ms(cell.frame_ms),
                    mode_name(rival.mode),
                    ms(rival.frame_ms)
                ));
            }
        }
        if let Some(flip) = cell.flip.filter(|f| *f > f64::from(Difference::ANOTHER_PICTURE)) {
            text.push_str(&format!(
                "{place}: the picture is not that of full detail (FLIP {flip:.3})\n"
            ));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A cell that takes `frame_ms`, everything else being the same.
    fn cell(moment: Moment, coverage: Coverage, mode: DrawMode, frame_ms: f64) -> Cell {
        let hdlod = mode == DrawMode::Hdlod;
        Cell {
            moment,
            coverage,
            mode,
            frame_ms,
            p95_ms: frame_ms,
            select_ms: 0.0,
            gpu_ms: None,
            draws: 1,
            triangles: 1234,
            left: hdlod.then_some(123),
            clusters: 0,
            frames: 30,
            worst_px: 0.0,
            flip: hdlod.then_some(0.01),
            coverage_change: hdlod.then_some(-0.02),
        }
    }

    /// The paper's own table, as if it had been measured here.
    fn papers() -> Vec<Cell> {
        let mut cells = Vec::new();
        for (row, (moment, _)) in Moment::ALL.into_iter().enumerate() {
            for (column, (coverage, _)) in Coverage::ALL.into_iter().enumerate() {
                cells.push(cell(moment, coverage, DrawMode::Hdlod, PAPER[row][column]));
            }
            cells.push(cell(moment, Coverage::Full, DrawMode::Objects, PAPER[row][3]));
        }
        cells
    }

    #[test]
    fn speed_ups_are_printed_as_the_paper_prints_them() {
        let text = measured(&papers());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 6);
        assert_eq!(
            lines[1].split_whitespace().collect::<Vec<_>>(),
            ["start", "7.02", "(5.8x)", "1.50", "(27x)", "0.66", "(62x)", "40.9"]
        );
        assert!(lines[4].ends_with("0.76 (217x)          165"), "{text}");
    }

    #[test]
    fn speed_ups_stand_beside_the_papers() {
        let text = compared(&papers());
        let row = text.lines().find(|l| l.starts_with("2/3") && l.contains(" 1/16 ")).unwrap();
        assert_eq!(
            row.split_whitespace().collect::<Vec<_>>(),
            ["2/3", "1/16", "164x", "164x", "-", "1,234", "123", "-", "0.010", "-2.0", "%"]
        );
    }

    #[test]
    fn the_verdict_names_cells_that_are_slow_or_wrong() {
        assert_eq!(verdict(&papers(), 0.1), "");
        let (hdlod, batched) = (DrawMode::Hdlod, DrawMode::Batched);
        let (moment, coverage) = (Moment::End, Coverage::Quarter);
        let mut cells =
            vec![cell(moment, coverage, hdlod, 9.0), cell(moment, coverage, batched, 8.0)];
        let text = verdict(&cells, 2.0);
        assert!(text.starts_with("end 1/4: HDLOD (9.00 ms) is not faster than batched"), "{text}");
        assert_eq!(verdict(&cells, 6.0), "", "9 ms are as good as an empty frame of 6 ms");
        cells[0].flip = Some(0.5);
        assert!(verdict(&cells, 6.0).contains("FLIP 0.500"));
    }
}
