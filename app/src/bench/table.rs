//! What measured cells are laid out into: the paper's two tables, and where the time goes. The command
//! line, the window and files all take them from here.

use super::{Cell, Coverage, Moment, mode_name};
use crate::report::grouped;
use topout_render::DrawMode;

/// Frame times of the paper (H16) in ms: HDLOD at 1/1, 1/4, 1/16, then without it.
pub(super) const PAPER: [[f64; 4]; 5] = [
    [7.02, 1.5, 0.66, 40.88],
    [8.7, 2.75, 0.71, 82.9],
    [26.47, 2.93, 0.74, 121.3],
    [28.17, 3.15, 0.76, 164.83],
    [18.63, 2.87, 0.72, 105.4],
];

/// The cell of a row and column.
pub fn find(cells: &[Cell], moment: Moment, coverage: Coverage, mode: DrawMode) -> Option<&Cell> {
    cells.iter().find(|c| c.moment == moment && c.coverage == coverage && c.mode == mode)
}

/// The one draw call per object that a row is compared with.
pub fn baseline(cells: &[Cell], moment: Moment) -> Option<&Cell> {
    find(cells, moment, Coverage::Full, DrawMode::Objects)
}

/// Milliseconds with three figures.
pub fn ms(value: f64) -> String {
    match value {
        v if v < 10.0 => format!("{v:.2}"),
        v if v < 100.0 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}

/// How many times faster: at most two figures below ten, whole numbers above.
pub fn factor(value: f64) -> String {
    if value < 9.95 { format!("{value:.1}x") } else { format!("{value:.0}x") }
}

/// How many times faster one cell is than others.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SpeedUp {
    /// Than one draw call an object at 1/1, as the paper compares. `None` where that was not measured,
    /// or is the cell itself.
    pub over_objects: Option<f64>,
    /// The same of the paper; of HDLOD alone.
    pub paper: Option<f64>,
    /// Than everything in one multi-draw, seen from the same distance; of HDLOD alone.
    pub over_batched: Option<f64>,
}

impl SpeedUp {
    /// Of one of the cells.
    pub fn of(cell: &Cell, cells: &[Cell]) -> Self {
        let over = |slow: &Cell| slow.frame_ms / cell.frame_ms.max(1e-6);
        let hdlod = cell.mode == DrawMode::Hdlod;
        let batched = find(cells, cell.moment, cell.coverage, DrawMode::Batched);
        Self {
            over_objects: baseline(cells, cell.moment)
                .filter(|_| cell.mode != DrawMode::Objects)
                .map(over),
            paper: hdlod.then(|| papers(cell.moment, cell.coverage)),
            over_batched: batched.filter(|_| hdlod).map(over),
        }
    }
}

/// The paper's speed-up of HDLOD over one draw call an object.
pub fn papers(moment: Moment, coverage: Coverage) -> f64 {
    // In the order of `Moment::ALL` and `Coverage::ALL`.
    let row = &PAPER[moment as usize];
    row[3] / row[coverage as usize]
}

/// Rows of a table, the first being its head.
pub type Rows = Vec<Vec<String>>;

fn or_dash(text: Option<String>) -> String {
    text.unwrap_or_else(|| "-".to_owned())
}

/// Frame times, in brackets the speed-up over the row's last column, as the paper prints them.
pub fn frame_times(cells: &[Cell]) -> Rows {
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
            let text = find(cells, moment, coverage, mode).map(|cell| {
                match SpeedUp::of(cell, cells).over_objects {
                    Some(gain) => format!("{} ({})", ms(cell.frame_ms), factor(gain)),
                    None => ms(cell.frame_ms),
                }
            });
            row.push(or_dash(text));
        }
        rows.push(row);
    }
    rows
}

/// HDLOD beside batched, beside the paper's figures, and how true its pictures are. Without HDLOD the
/// head alone.
pub fn compared(cells: &[Cell]) -> Rows {
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
    for (moment, name) in Moment::ALL {
        for (coverage, at) in Coverage::ALL {
            let Some(cell) = find(cells, moment, coverage, DrawMode::Hdlod) else { continue };
            let gain = SpeedUp::of(cell, cells);
            let batched = find(cells, moment, coverage, DrawMode::Batched);
            rows.push(vec![
                name.to_owned(),
                at.to_owned(),
                or_dash(gain.over_objects.map(factor)),
                or_dash(gain.paper.map(factor)),
                or_dash(gain.over_batched.map(factor)),
                grouped(cell.triangles),
                or_dash(cell.left.map(grouped)),
                or_dash(batched.map(|b| grouped(b.triangles))),
                or_dash(cell.flip.map(|f| format!("{f:.3}"))),
                or_dash(cell.coverage_change.map(|c| format!("{:+.1} %", c * 100.0))),
            ]);
        }
    }
    rows
}

/// Where the time of HDLOD goes at 2/3, near by: its passes on the CPU and on the GPU. Without that cell
/// the head alone.
pub fn passes(cells: &[Cell]) -> Rows {
    let head = ["HDLOD, 2/3, 1/1 (ms)", "CPU", "GPU"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    let cell = find(cells, Moment::TwoThirds, Coverage::Full, DrawMode::Hdlod);
    for pass in cell.iter().flat_map(|cell| &cell.passes) {
        if pass.cpu_ms.is_some() || pass.gpu_ms.is_some() {
            let side = |value: Option<f64>| or_dash(value.map(ms));
            rows.push(vec![pass.name.to_owned(), side(pass.cpu_ms), side(pass.gpu_ms)]);
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::tests::{cell, papers_cells};
    use super::*;
    use crate::report::columns;

    #[test]
    fn speed_ups_are_printed_as_the_paper_prints_them() {
        let text = columns(&frame_times(&papers_cells()));
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
        let text = columns(&compared(&papers_cells()));
        let row = text.lines().find(|l| l.starts_with("2/3") && l.contains(" 1/16 ")).unwrap();
        assert_eq!(
            row.split_whitespace().collect::<Vec<_>>(),
            ["2/3", "1/16", "164x", "164x", "-", "1,234", "123", "-", "0.010", "-2.0", "%"]
        );
    }

    #[test]
    fn passes_are_those_of_hdlod_near_by_at_two_thirds() {
        let rows = passes(&papers_cells());
        assert_eq!(rows[1..], [["selection", "0.25", "-"], ["scene", "0.25", "-"]]);
        let batched = [cell(Moment::TwoThirds, Coverage::Full, DrawMode::Batched, 1.0)];
        assert_eq!(passes(&batched).len(), 1);
    }
}
