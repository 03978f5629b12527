//! Measured cells as files: CSV with every figure, Markdown with the tables.

use super::{Cell, Plan, mode_name, table};
use crate::project::Request;
use anyhow::Context;
use std::fmt::Write;
use topout_render::Pass;

/// What a table is written as.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Format {
    /// One row a cell, RFC 4180.
    Csv,
    /// Tables to read.
    Markdown,
}

impl Format {
    /// Its name, and how its files end.
    pub fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Csv => ("CSV", "csv"),
            Self::Markdown => ("Markdown", "md"),
        }
    }
}

/// A table with what its reader must know.
#[derive(Clone, Copy, Debug)]
pub struct Export<'a> {
    /// The cells measured.
    pub cells: &'a [Cell],
    /// Name of the graphics adapter.
    pub adapter: &'a str,
    /// Size and tolerance.
    pub plan: &'a Plan,
    /// Milliseconds of a frame with nothing in it.
    pub empty_ms: Option<f64>,
    /// What to type to measure the same, see [`command`].
    pub command: &'a str,
}

/// The names of the figures of a cell, without those of its passes.
const FIGURES: [&str; 18] = [
    "time",
    "lod",
    "coverage",
    "frame_ms",
    "p95_ms",
    "select_ms",
    "gpu_ms",
    "draws",
    "triangles",
    "left",
    "clusters",
    "frames",
    "worst_px",
    "flip",
    "coverage_change",
    "over_objects",
    "paper_over_objects",
    "over_batched",
];

impl Export<'_> {
    /// The whole text of a file.
    ///
    /// # Errors
    /// Out of memory at most.
    pub fn text(&self, format: Format) -> anyhow::Result<String> {
        match format {
            Format::Csv => separated(self.cells, b','),
            Format::Markdown => Ok(self.markdown()),
        }
    }

    fn markdown(&self) -> String {
        let Plan { size, tolerance_px, .. } = self.plan;
        let mut text = format!(
            "# HDLOD, measured\n\n{}, {}x{} pixels, {tolerance_px} px tolerance",
            self.adapter, size.x, size.y
        );
        if let Some(ms) = self.empty_ms {
            let _ = write!(text, "; a frame with nothing in it takes {} ms", table::ms(ms));
        }
        let _ = write!(text, ". Measured with\n\n    {}\n", self.command);
        for (title, rows) in [
            (
                "Frame time in milliseconds: the median, of the animation the mean. In brackets how many \
                 times faster than one draw call an object at 1/1.",
                table::frame_times(self.cells),
            ),
            (
                "How many times faster HDLOD is, beside the paper's figures; its triangles, what is left \
                 of them after culling, and those of full detail.",
                table::compared(self.cells),
            ),
            ("Where the time of a frame goes.", table::passes(self.cells)),
        ] {
            if rows.len() > 1 {
                let _ = write!(text, "\n{title}\n\n{}", pipes(&rows));
            }
        }
        text
    }
}

/// One row a cell with all its figures, below their names: RFC 4180 with commas, or with tabs for the
/// clipboard.
///
/// # Errors
/// Out of memory at most.
pub fn separated(cells: &[Cell], delimiter: u8) -> anyhow::Result<String> {
    let mut writer = csv::WriterBuilder::new()
        .delimiter(delimiter)
        .terminator(csv::Terminator::CRLF)
        .from_writer(Vec::new());
    let passes = Pass::ALL
        .iter()
        .flat_map(|(_, name, _)| ["cpu", "gpu"].map(|on| format!("{name}_{on}_ms")));
    let head: Vec<String> = FIGURES.map(str::to_owned).into_iter().chain(passes).collect();
    writer.write_record(&head)?;
    for cell in cells {
        writer.write_record(record(cell, cells))?;
    }
    let bytes = writer.into_inner().map_err(csv::IntoInnerError::into_error)?;
    String::from_utf8(bytes).context("the names of figures are text")
}

/// The figures of a cell in the order of the head; what is not known stays empty.
fn record(cell: &Cell, cells: &[Cell]) -> Vec<String> {
    fn known(value: Option<impl ToString>) -> String {
        value.map_or_else(String::new, |value| value.to_string())
    }
    let gain = table::SpeedUp::of(cell, cells);
    let factor = |value: Option<f64>| known(value.map(|v| crate::report::rounded(v, 3)));
    let mut fields = vec![
        cell.moment.name().to_owned(),
        mode_name(cell.mode).to_owned(),
        cell.coverage.name().to_owned(),
        cell.frame_ms.to_string(),
        cell.p95_ms.to_string(),
        cell.select_ms.to_string(),
        known(cell.gpu_ms),
        cell.draws.to_string(),
        cell.triangles.to_string(),
        known(cell.left),
        cell.clusters.to_string(),
        cell.frames.to_string(),
        cell.worst_px.to_string(),
        known(cell.flip),
        known(cell.coverage_change),
        factor(gain.over_objects),
        factor(gain.paper),
        factor(gain.over_batched),
    ];
    fields.extend(cell.passes.iter().flat_map(|pass| [known(pass.cpu_ms), known(pass.gpu_ms)]));
    fields
}

/// A Markdown table: the first column to the left, the others to the right.
fn pipes(rows: &table::Rows) -> String {
    let line = |row: &[String]| {
        let cells: Vec<String> = row.iter().map(|cell| cell.replace('|', "\\|")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let mut text = String::new();
    for (i, row) in rows.iter().enumerate() {
        text.push_str(&line(row));
        if i == 0 {
            let columns = row.len().saturating_sub(1);
            let _ = writeln!(text, "|---|{}", "---:|".repeat(columns));
        }
    }
    text
}

/// What to type to measure a project with a plan; `more`: options besides those of project and plan.
pub fn command(request: &Request, plan: &Plan, more: &[&str]) -> String {
    let mut words = vec!["topout".to_owned(), "bench".to_owned()];
    words.extend(request.models.iter().map(ToString::to_string));
    let mut option = |name: &str, value: String| words.extend([name.to_owned(), value]);
    for schedule in &request.schedules {
        option("--schedule", schedule.display().to_string());
    }
    for file in &request.paths {
        option("--paths", file.display().to_string());
    }
    if let Some(rules) = &request.rules {
        option("--rules", rules.display().to_string());
    }
    for (name, value) in
        [("--date-format", &request.date_format), ("--encoding", &request.encoding)]
    {
        if let Some(value) = value {
            option(name, value.clone());
        }
    }
    if let Some(set) = request.dates {
        option("--dates", set.word().to_owned());
    }
    option("--size", format!("{}x{}", plan.size.x, plan.size.y));
    option("--tolerance", plan.tolerance_px.to_string());
    words.extend(more.iter().map(|word| (*word).to_owned()));
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./:=,+%@\\".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::tests::papers_cells;
    use super::*;
    use crate::project::Source;
    use glam::UVec2;

    fn plan() -> Plan {
        Plan::new(UVec2::new(640, 360), 0.5)
    }

    /// Every row has a field for every name, and what is read back is what was measured.
    #[test]
    fn csv_holds_every_figure_of_every_cell() {
        let cells = papers_cells();
        let text = separated(&cells, b',').unwrap();
        assert!(text.lines().count() == cells.len() + 1 && text.ends_with("\r\n"), "{text}");
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let head = reader.headers().unwrap().clone();
        let at = |name: &str| head.iter().position(|n| n == name).unwrap();
        assert_eq!(head.len(), FIGURES.len() + 2 * Pass::ALL.len());
        let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().unwrap();
        assert_eq!(rows.len(), cells.len());
        for (row, cell) in rows.iter().zip(&cells) {
            assert_eq!(row[at("time")], *cell.moment.name());
            assert_eq!(row[at("frame_ms")].parse::<f64>().unwrap(), cell.frame_ms);
            assert_eq!(row[at("triangles")], *"1234");
            assert_eq!(&row[at("gpu_ms")], "", "not known");
            assert_eq!(&row[at("scene_cpu_ms")], "0.25");
            assert_eq!(&row[at("scene_gpu_ms")], "");
        }
        let far = rows.iter().find(|r| &r[at("time")] == "end" && &r[at("coverage")] == "1/16");
        assert_eq!(&far.unwrap()[at("over_objects")], "216.882");
        assert_eq!(&far.unwrap()[at("paper_over_objects")], "216.882");
    }

    #[test]
    fn markdown_says_what_was_measured_with_what() {
        let cells = papers_cells();
        let plan = plan();
        let request =
            Request { models: vec![Source::File("my house.glb".into())], ..Request::default() };
        let command = command(&request, &plan, &["--lod", "hdlod"]);
        let export = Export {
            cells: &cells,
            adapter: "an adapter",
            plan: &plan,
            empty_ms: None,
            command: &command,
        };
        let text = export.text(Format::Markdown).unwrap();
        assert!(text.contains("an adapter, 640x360 pixels, 0.5 px tolerance"), "{text}");
        let line = "    topout bench 'my house.glb' --size 640x360 --tolerance 0.5 --lod hdlod\n";
        assert!(text.contains(line), "{text}");
        assert!(text.contains("| 2/3 | 26.5 (4.6x) |"), "{text}");
        assert!(text.contains("| 2/3 | 1/16 | 164x | 164x | - |"), "{text}");
        assert!(text.contains("| scene | 0.25 | - |"), "{text}");
        // Every row of a table has as many cells as its head.
        for table in text.split("\n\n").filter(|part| part.starts_with('|')) {
            let widths: Vec<usize> = table.lines().map(|line| line.matches('|').count()).collect();
            assert!(widths.iter().all(|w| *w == widths[0]), "{table}");
        }
    }
}
