//! The paper's table as text.

use super::bench::RuleCell;
use crate::bench::table::{self, Rows, baseline, find, ms};
use crate::bench::{Cell, Coverage, Moment, mode_name};
use crate::flip::Difference;
use crate::report::{columns, grouped};
use topout_render::DrawMode;

/// A cell that is not slower than this many empty frames needs no further speed-up.
pub const NEAR_EMPTY: f64 = 1.5;

/// Frame times, HDLOD beside the others and the paper, and where its time goes.
pub fn measured(cells: &[Cell]) -> String {
    let others = [table::compared(cells), table::passes(cells)];
    let others = others.iter().filter(|rows| rows.len() > 1);
    let parts: Vec<String> = std::iter::once(&table::frame_times(cells))
        .chain(others)
        .map(|rows| columns(rows))
        .collect();
    parts.join("\n")
}

/// Both promises over time side by side: what they cost, and how far their pictures are from full
/// detail.
pub fn rules(cells: &[RuleCell]) -> String {
    let rules = ["tight", "paper"];
    let mut rows: Rows = vec![vec!["Exact in time / paper's delta".to_owned(), String::new()]];
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
    use super::*;
    use crate::bench::tests::{cell, papers_cells};

    #[test]
    fn the_verdict_names_cells_that_are_slow_or_wrong() {
        assert_eq!(verdict(&papers_cells(), 0.1), "");
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
