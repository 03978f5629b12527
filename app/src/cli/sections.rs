//! What a planner has to look at, in the report of `topout check` and as a table.

use crate::report::count;
use anyhow::Context;
use serde::Serialize;
use std::fmt::Write;
use topout_scene::Scene;
use topout_scene::check::{Row, Section, Subject, name_of};
use topout_schedule::Severity;

/// Rows of a section in JSON; the table has all.
const LISTED: usize = 200;
/// Rows of a section in the text.
const SHOWN: usize = 5;

/// One section as scripts read it.
#[derive(Serialize, Debug)]
pub struct SectionReport {
    /// Stable short name.
    pub code: &'static str,
    title: &'static str,
    severity: Severity,
    count: usize,
    rows: Vec<RowReport>,
}

/// One thing to look at.
#[derive(Serialize, Debug)]
struct RowReport {
    /// `element` or `activity`.
    of: &'static str,
    /// The activity's id; the element's guid, else its name.
    id: String,
    name: String,
    detail: String,
}

impl RowReport {
    fn of(row: &Row, scene: &Scene) -> Self {
        let (of, id, name) = match row.subject {
            Subject::Element(id) => {
                let element = &scene.model.elements[id.index()];
                let key = element.guid.as_deref().unwrap_or(&element.name);
                ("element", key.to_owned(), name_of(element).to_owned())
            }
            Subject::Activity(index) => {
                let activity = &scene.schedule.activities[index as usize];
                ("activity", activity.id.clone(), activity.name.clone())
            }
        };
        Self { of, id, name, detail: row.detail.clone() }
    }
}

impl SectionReport {
    /// The section, with as many rows as JSON lists.
    pub fn of(section: &Section, scene: &Scene) -> Self {
        let Section { code, title, severity, rows } = section;
        let listed = rows.iter().take(LISTED).map(|row| RowReport::of(row, scene)).collect();
        Self { code, title, severity: *severity, count: rows.len(), rows: listed }
    }

    /// Its number and its first rows.
    pub fn text(&self) -> String {
        let mut text = format!("{:<12}{} {}\n", "Look at", count(self.count), self.title);
        for row in self.rows.iter().take(SHOWN) {
            let name = if row.name == row.id { "" } else { &row.name };
            let line = format!("  {}  {name}  {}", row.id, row.detail);
            let _ = writeln!(text, "{}", line.trim_end());
        }
        if self.count > SHOWN {
            let _ = writeln!(text, "  ... --csv FILE lists all");
        }
        text
    }
}

/// All rows of all sections.
///
/// # Errors
/// None that is to be expected: it is written to memory.
pub fn table(scene: &Scene, sections: &[Section]) -> anyhow::Result<String> {
    let mut out = csv::Writer::from_writer(Vec::new());
    out.write_record(["section", "severity", "of", "id", "name", "detail", "place"])?;
    for section in sections {
        let severity = match section.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Info => "info",
        };
        for row in &section.rows {
            let place = match row.subject {
                Subject::Activity(index) => scene.schedule.place(index as usize),
                Subject::Element(_) => String::new(),
            };
            let RowReport { of, id, name, detail } = RowReport::of(row, scene);
            out.write_record([section.code, severity, of, &id, &name, &detail, &place])?;
        }
    }
    let bytes = out.into_inner().context("cannot write the table")?;
    String::from_utf8(bytes).context("the table is no text")
}
