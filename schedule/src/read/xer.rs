//! Primavera P6's XER: tables of cells between tabs. `%T` names a table, `%F` its columns, `%R` is a
//! row, `%E` the end.
//!
//! An activity's id is its task code. Planned dates are P6's target dates, forecast ones its early
//! dates.

use super::collected::Collected;
use super::error::ReadError;
use super::p6::{P6, Progress, TaskIds, task_type};
use super::p6_calendar;
use super::text::{Input, TextEncoding, TextReader};
use crate::{Activity, DateSet, Dates, LinkKind, Severity};
use encoding_rs::UTF_8;
use std::io::BufRead;

/// Columns of TASK that are kept as fields under the same name.
const KEPT: [&str; 9] = [
    "task_type",
    "status_code",
    "target_drtn_hr_cnt",
    "remain_drtn_hr_cnt",
    "total_float_hr_cnt",
    "free_float_hr_cnt",
    "cstr_type",
    "cstr_date",
    "guid",
];

/// Columns of PROJECT that are kept as fields of the project.
const KEPT_OF_PROJECT: [&str; 4] = ["plan_start_date", "plan_end_date", "scd_end_date", "guid"];

/// The rows that are looked at.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Table {
    Project,
    Wbs,
    Calendar,
    Task,
    TaskPred,
    CodeType,
    CodeValue,
    TaskCode,
    UserType,
    UserValue,
    Other,
}

pub(super) fn read(
    input: &Input,
    declared: Option<&str>,
    all: &mut Collected,
) -> Result<(), ReadError> {
    let encoding = match declared {
        Some(name) => TextEncoding::named(name)?,
        None => TextEncoding { encoding: input.guess_encoding()?, declared: false },
    };
    if !encoding.declared && encoding.encoding != UTF_8 {
        let file = all.sources.files.last().cloned().unwrap_or_default();
        all.report(Severity::Info, "guessed-encoding", &file, all.line(1), || {
            let name = encoding.encoding.name();
            format!("not UTF-8; read as {name}; --encoding says otherwise")
        });
    }
    let mut rows = Rows {
        text: input.text(encoding)?,
        row: String::new(),
        table: Table::Other,
        columns: Vec::new(),
        line: 0,
    };
    let mut p6 = P6::default();
    let mut ended = false;
    while rows.next_line()? {
        let (mark, rest) = rows.row.split_once('\t').unwrap_or((&rows.row, ""));
        match mark {
            "ERMHDR" | "" => {}
            "%E" => {
                ended = true;
                break;
            }
            "%T" => {
                rows.table = table(rest.trim());
                rows.columns.clear();
            }
            "%F" => rows.columns = rest.split('\t').map(|name| name.trim().to_owned()).collect(),
            "%R" => rows.take(&mut p6, all),
            other => {
                let other = other.chars().take(40).collect::<String>();
                all.report(Severity::Warning, "unknown-row", &other, all.line(rows.line), || {
                    format!("{other:?} begins no row of an XER file; the line is left out")
                });
            }
        }
    }
    if !ended {
        let file = all.sources.files.last().cloned().unwrap_or_default();
        all.report(Severity::Warning, "no-end", &file, all.line(rows.line), || {
            "the file ends without %E: it may have been cut off".to_owned()
        });
    }
    p6.finish(all);
    Ok(())
}

fn table(name: &str) -> Table {
    match name {
        "PROJECT" => Table::Project,
        "PROJWBS" => Table::Wbs,
        "CALENDAR" => Table::Calendar,
        "TASK" => Table::Task,
        "TASKPRED" => Table::TaskPred,
        "ACTVTYPE" => Table::CodeType,
        "ACTVCODE" => Table::CodeValue,
        "TASKACTV" => Table::TaskCode,
        "UDFTYPE" => Table::UserType,
        "UDFVALUE" => Table::UserValue,
        _ => Table::Other,
    }
}

struct Rows<'a> {
    text: TextReader<'a>,
    /// The line that was read last, without its end.
    row: String,
    table: Table,
    columns: Vec<String>,
    line: usize,
}

impl Rows<'_> {
    /// Reads a line of any length that is allowed; false at the end.
    fn next_line(&mut self) -> Result<bool, ReadError> {
        self.row.clear();
        self.text.begin_record();
        self.line = self.text.line();
        let read = self.text.read_line(&mut self.row).map_err(|error| {
            self.text.error(|file, _| ReadError::Io { file: file.to_owned(), source: error })
        })?;
        let length = self.row.trim_end_matches(['\r', '\n']).len();
        self.row.truncate(length);
        Ok(read > 0)
    }

    fn take(&self, p6: &mut P6, all: &mut Collected) {
        if self.table == Table::Other {
            return;
        }
        let cells: Vec<&str> = self.row.split('\t').skip(1).collect();
        let row = Row { columns: &self.columns, cells: &cells };
        match self.table {
            Table::Project => project(&row, self.line, p6, all),
            Table::Wbs => {
                let [id, parent, code, name] =
                    ["wbs_id", "parent_wbs_id", "wbs_short_name", "wbs_name"].map(|c| row.get(c));
                p6.node(id, parent, code, name);
            }
            Table::Calendar => calendar(&row, self.line, p6, all),
            Table::Task => task(&row, self.line, p6, all),
            Table::TaskPred => {
                let kind = row.get("pred_type").strip_prefix("PR_").and_then(LinkKind::from_word);
                let lag = row.number("lag_hr_cnt").unwrap_or_default();
                p6.link(row.get("task_id"), row.get("pred_task_id"), kind.unwrap_or_default(), lag);
            }
            Table::CodeType => {
                p6.code_type(row.get("actv_code_type_id"), row.get("actv_code_type"), all)
            }
            Table::CodeValue => {
                let [id, short, name] =
                    ["actv_code_id", "short_name", "actv_code_name"].map(|c| row.get(c));
                p6.code_value(id, short, name);
            }
            Table::TaskCode => {
                p6.code(row.get("task_id"), row.get("actv_code_type_id"), row.get("actv_code_id"));
            }
            Table::UserType if matches!(row.get("table_name"), "TASK" | "") => {
                p6.user_type(row.get("udf_type_id"), row.get("udf_type_label"), all);
            }
            Table::UserValue => {
                let value = ["udf_text", "udf_number", "udf_date"].map(|c| row.get(c));
                let value = value.into_iter().find(|v| !v.is_empty()).unwrap_or_default();
                let value = all.field_text("udf_text", value, all.line(self.line));
                p6.user_value(row.get("fk_id"), row.get("udf_type_id"), value);
            }
            Table::UserType | Table::Other => {}
        }
    }
}

/// A row whose cells are found by their columns' names.
struct Row<'a> {
    columns: &'a [String],
    cells: &'a [&'a str],
}

impl<'a> Row<'a> {
    /// A cell; empty where there is none.
    fn get(&self, column: &str) -> &'a str {
        let at = self.columns.iter().position(|c| c == column);
        at.and_then(|at| self.cells.get(at)).copied().unwrap_or_default()
    }

    /// A number, with a comma or a point.
    fn number(&self, column: &str) -> Option<f64> {
        let text = self.get(column);
        let number = text.parse().or_else(|_| text.replace(',', ".").parse());
        number.ok().filter(|n: &f64| n.is_finite())
    }
}

fn project(row: &Row, line: usize, p6: &mut P6, all: &mut Collected) {
    let code = row.get("proj_short_name");
    p6.project(row.get("proj_id"), code, row.get("clndr_id"), row.get("orig_proj_id"));
    if !row.get("orig_proj_id").is_empty() {
        return;
    }
    let place = all.line(line);
    let date = all.civil_date(row.get("last_recalc_date"), "data date", code, place);
    all.data_date = all.data_date.max(date);
    all.name_project(code);
    for name in KEPT_OF_PROJECT.into_iter().filter(|name| !row.get(name).is_empty()) {
        let value = all.field_text(name, row.get(name), place);
        let name = all.name(name);
        all.fields.push((name, value));
    }
}

fn calendar(row: &Row, line: usize, p6: &mut P6, all: &mut Collected) {
    let (name, data) = (row.get("clndr_name"), row.get("clndr_data"));
    let calendar = p6_calendar::read(data);
    if calendar.is_none() && !data.is_empty() {
        all.report(Severity::Warning, "bad-calendar", name, all.line(line), || {
            format!("the hours of calendar {name:?} cannot be read; it has none")
        });
    }
    let mut calendar = calendar.unwrap_or_default();
    calendar.name = name.to_owned();
    p6.calendar(row.get("clndr_id"), row.get("base_clndr_id"), calendar);
}

fn task(row: &Row, line: usize, p6: &mut P6, all: &mut Collected) {
    let id = row.get("task_code");
    let place = all.next_place(line);
    let mut bad_dates = false;
    let mut date = |all: &mut Collected, column: &str| {
        let text = row.get(column);
        let date = all.civil_date(text, column, id, place);
        bad_dates |= date.is_none() && !text.is_empty();
        date
    };
    let mut dates = |all: &mut Collected, [start, end]: [&str; 2]| Dates {
        start: date(all, start),
        end: date(all, end),
    };
    let mut activity = Activity {
        id: id.to_owned(),
        name: row.get("task_name").to_owned(),
        ..Activity::default()
    };
    let sets = &mut activity.date_sets;
    sets[DateSet::Planned] = dates(all, ["target_start_date", "target_end_date"]);
    sets[DateSet::Actual] = dates(all, ["act_start_date", "act_end_date"]);
    sets[DateSet::Forecast] = dates(all, ["early_start_date", "early_end_date"]);
    (activity.kind, activity.milestone) = task_type(row.get("task_type"));
    let progress = Progress {
        complete: row.get("status_code") == "TK_Complete",
        measure: row.get("complete_pct_type").to_owned(),
        physical: row.number("phys_complete_pct"),
        target_hours: row.number("target_drtn_hr_cnt"),
        remaining_hours: row.number("remain_drtn_hr_cnt"),
        actual_units: row.number("act_work_qty").unwrap_or_default(),
        remaining_units: row.number("remain_work_qty").unwrap_or_default(),
    };
    activity.percent_complete = progress.percent();
    activity.fields.reserve(KEPT.len());
    for name in KEPT.into_iter().filter(|name| !row.get(name).is_empty()) {
        let value = all.field_text(name, row.get(name), place);
        activity.fields.push((all.name(name), value));
    }
    let [object, project, wbs, calendar] =
        ["task_id", "proj_id", "wbs_id", "clndr_id"].map(|c| row.get(c));
    p6.task(&TaskIds { object, project, wbs, calendar }, activity, place, bad_dates, all);
}
