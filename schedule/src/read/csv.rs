//! Tables: schedules, links files and event logs as CSV.

use super::collected::{Collected, Texts};
use super::csv_own::Own;
use super::dates::DateReader;
use super::dialect::DateOrder;
use super::error::ReadError;
use super::table::{Header, Table};
use super::text::{Input, TextEncoding};
use super::{ReadOptions, links, log, read_predecessor};
use crate::{Activity, DateSet, Severity, WbsNode};
use encoding_rs::UTF_8;
use std::collections::HashMap;
use std::sync::Arc;

/// What a column of a schedule means.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Column {
    /// The activity's id.
    Id,
    /// Its name.
    Name,
    /// The start that counts.
    Start,
    /// The end that counts.
    End,
    /// The start of a set. Without a column for the start that counts, this counts.
    StartOf(DateSet),
    /// The end of a set.
    EndOf(DateSet),
    /// What it does to its elements.
    Kind,
    /// Whether it happens.
    Active,
    /// Whether it is an event.
    Milestone,
    /// How much is done, from 0 to 100; a percent sign may follow.
    PercentComplete,
    /// The summaries above it, between `/`, `\` or `>`, else between points.
    Wbs,
    /// What it waits for, between commas or semicolons: `A10`, `A10:SS`, `12FS+2d`.
    Predecessors,
    /// Node names or guids.
    Elements,
    /// A field, even if its name means something.
    Field,
    /// Nothing.
    Ignored,
}

impl Column {
    /// The words of [`Column::from_word`], one for each meaning.
    pub const WORDS: [&'static str; 20] = [
        "id",
        "name",
        "start",
        "end",
        "planned_start",
        "planned_end",
        "actual_start",
        "actual_end",
        "baseline_start",
        "baseline_end",
        "forecast_start",
        "forecast_end",
        "kind",
        "active",
        "milestone",
        "percent_complete",
        "wbs",
        "predecessors",
        "elements",
        "field",
    ];

    /// The meaning that a word names: `id`, `start`, `planned_start`, `baseline_end`, `wbs` ...
    pub fn from_word(word: &str) -> Option<Self> {
        let word = word.to_ascii_lowercase();
        if let Some((set, date)) = word.split_once('_')
            && let Some(set) = DateSet::from_word(set)
        {
            return match date {
                "start" => Some(Self::StartOf(set)),
                "end" | "finish" => Some(Self::EndOf(set)),
                _ => None,
            };
        }
        Some(match word.as_str() {
            "id" | "activity_id" => Self::Id,
            "name" => Self::Name,
            "start" => Self::Start,
            "end" | "finish" => Self::End,
            "kind" => Self::Kind,
            "active" => Self::Active,
            "milestone" => Self::Milestone,
            "percent_complete" => Self::PercentComplete,
            "wbs" => Self::Wbs,
            "predecessors" => Self::Predecessors,
            "elements" => Self::Elements,
            "field" => Self::Field,
            "ignored" => Self::Ignored,
            _ => return None,
        })
    }

    /// The word of [`Column::from_word`].
    pub fn word(self) -> String {
        let word = match self {
            Self::Id => "id",
            Self::Name => "name",
            Self::Start => "start",
            Self::End => "end",
            Self::StartOf(set) => return format!("{}_start", set.word()),
            Self::EndOf(set) => return format!("{}_end", set.word()),
            Self::Kind => "kind",
            Self::Active => "active",
            Self::Milestone => "milestone",
            Self::PercentComplete => "percent_complete",
            Self::Wbs => "wbs",
            Self::Predecessors => "predecessors",
            Self::Elements => "elements",
            Self::Field => "field",
            Self::Ignored => "ignored",
        };
        word.to_owned()
    }

    /// Whether a heading of this name means it in every table; other names are those of fields there.
    fn is_common(self) -> bool {
        use Column::{Active, Elements, End, Id, Kind, Name, Start};
        matches!(self, Id | Name | Start | End | Kind | Active | Elements)
    }
}

/// Rows in which the first dates of a table are looked for.
const SAMPLE_ROWS: usize = 1000;

/// Reads one file into `all`: a links file where its columns say so, else a schedule.
pub(super) fn read(
    input: &Input,
    options: &ReadOptions,
    dates: &DateReader,
    all: &mut Collected,
) -> Result<(), ReadError> {
    let encoding = match &options.encoding {
        Some(name) => TextEncoding::named(name)?,
        None => TextEncoding { encoding: input.guess_encoding()?, declared: false },
    };
    let mut table = Table::open(input, encoding)?;
    if !encoding.declared && encoding.encoding != UTF_8 {
        report_guess(all, "guessed-encoding", || {
            format!("not UTF-8; read as {}; --encoding says otherwise", encoding.encoding.name())
        });
    }
    if table.semicolons {
        report_guess(all, "guessed-separator", || "separated by semicolons".to_owned());
    }
    if Own::is(&table.header) {
        return Own::read(&mut table, all);
    }
    let links = links::Columns::find(&table.header);
    let log = match options.columns.is_empty() {
        true => log::Columns::find(&table.header, all),
        false => None,
    };
    let guess_dates = |columns: &[usize], all: &mut Collected| match options.date_format {
        Some(_) => Ok(None),
        None => guess_dates(input, encoding, columns, all),
    };
    if let Some(columns) = log.filter(|log| links.is_none() || log.has_names()) {
        let guess = guess_dates(&columns.dates(), all)?;
        return log::read(input.path, &mut table, &columns, guess.as_ref().unwrap_or(dates), all);
    }
    if let Some(columns) = links {
        return links::read(&mut table, columns, all);
    }
    let columns = Columns::find(input, &table.header, options, all)?;
    let guess = guess_dates(&columns.dates(), all)?;
    let dates = guess.as_ref().unwrap_or(dates);
    let mut outline = Outline::default();
    while let Some(line) = table.next(all)? {
        columns.read_row(&table, line, dates, &mut outline, all);
    }
    all.end_schedule();
    Ok(())
}

fn report_guess(all: &mut Collected, code: &'static str, message: impl FnOnce() -> String) {
    let file = all.sources.files.last().cloned().unwrap_or_default();
    all.report(Severity::Info, code, &file, all.line(1), message);
}

/// A reader for the order of days and months that the dates of a table prove, if they are not all
/// ISO 8601.
fn guess_dates(
    input: &Input,
    encoding: TextEncoding,
    columns: &[usize],
    all: &mut Collected,
) -> Result<Option<DateReader>, ReadError> {
    let mut table = Table::open(input, encoding)?;
    let mut order = DateOrder::default();
    let mut rows = 0;
    // What is wrong with rows is said when they are read for good.
    let mut unsaid = Collected::default();
    while (rows < SAMPLE_ROWS || order.matters()) && table.next(&mut unsaid)?.is_some() {
        rows += 1;
        for &at in columns {
            order.see(table.cell(Some(at)));
        }
    }
    let Some((format, words, example)) = order.proven() else { return Ok(None) };
    let dates = DateReader::new(Some(&format))?;
    report_guess(all, "guessed-dates", || {
        let read = dates.start(&example).map_or_else(|e| e.to_string(), |t| t.to_string());
        format!("dates are read {words} ({example} is {read}); --date-format says otherwise")
    });
    Ok(Some(dates))
}

/// What a schedule's columns mean.
struct Columns {
    columns: Vec<(usize, Column)>,
    /// Names of the columns that are fields.
    names: HashMap<usize, Arc<str>>,
    /// No column has the start or the end that counts.
    choose: bool,
}

impl Columns {
    /// Fails on declared columns that are not there, and on needed ones that are missing.
    fn find(
        input: &Input,
        header: &Header,
        options: &ReadOptions,
        all: &mut Collected,
    ) -> Result<Self, ReadError> {
        let mut columns: Vec<Option<Column>> = vec![None; header.0.len()];
        for (name, column) in &options.columns {
            let at = header.position(&[name.as_str()]).ok_or_else(|| ReadError::NoSuchColumn {
                file: input.path.to_owned(),
                name: name.clone(),
                found: header.found(),
            })?;
            columns[at] = Some(*column);
        }
        // `end` goes before `finish`, and the first of equal ones counts.
        for word in
            ["id", "activity_id", "name", "start", "end", "finish", "kind", "active", "elements"]
        {
            let meaning = Column::from_word(word).filter(|c| c.is_common());
            if let Some(at) = header.position(&[word])
                && columns[at].is_none()
                && !columns.contains(&meaning)
            {
                columns[at] = meaning;
            }
        }
        let columns: Vec<(usize, Column)> =
            columns.into_iter().map(|c| c.unwrap_or(Column::Field)).enumerate().collect();
        let has = |wanted: fn(&Column) -> bool| columns.iter().any(|(_, c)| wanted(c));
        let needed = [
            ("id", has(|c| *c == Column::Id)),
            ("name", has(|c| *c == Column::Name)),
            ("start", has(|c| matches!(c, Column::Start | Column::StartOf(_)))),
            ("end", has(|c| matches!(c, Column::End | Column::EndOf(_)))),
        ];
        let missing: Vec<&str> = needed.iter().filter(|n| !n.1).map(|n| n.0).collect();
        if !missing.is_empty() {
            return Err(ReadError::Header {
                file: input.path.to_owned(),
                missing: missing.join(", "),
                found: header.found(),
            });
        }
        let choose = !has(|c| matches!(c, Column::Start | Column::End));
        let fields = columns.iter().filter(|(_, c)| *c == Column::Field);
        let names = fields.map(|&(at, _)| (at, all.name(&header.0[at]))).collect();
        Ok(Self { columns, names, choose })
    }

    /// The columns that hold dates.
    fn dates(&self) -> Vec<usize> {
        use Column::{End, EndOf, Start, StartOf};
        let dates = |c: &Column| matches!(c, Start | End | StartOf(_) | EndOf(_));
        self.columns.iter().filter(|(_, c)| dates(c)).map(|&(at, _)| at).collect()
    }

    fn read_row(
        &self,
        table: &Table,
        line: usize,
        dates: &DateReader,
        outline: &mut Outline,
        all: &mut Collected,
    ) {
        let place = all.line(line);
        let mut activity = Activity::default();
        let mut texts = Texts { choose: self.choose, ..Texts::default() };
        for &(at, column) in &self.columns {
            let cell = table.cell(Some(at));
            if cell.is_empty() {
                continue;
            }
            let text = || Some(cell.to_owned());
            match column {
                Column::Id => activity.id = cell.to_owned(),
                Column::Name => activity.name = cell.to_owned(),
                Column::Start => texts.start = text(),
                Column::End => texts.end = text(),
                Column::StartOf(set) => texts.sets[set as usize][0] = text(),
                Column::EndOf(set) => texts.sets[set as usize][1] = text(),
                Column::Kind => texts.kind = text(),
                Column::Active => texts.active = text(),
                Column::Milestone => texts.milestone = text(),
                Column::PercentComplete => texts.percent_complete = text(),
                Column::Wbs => activity.wbs = outline.node(cell, all),
                Column::Predecessors => {
                    for (id, kind, lag) in cell.split([',', ';']).filter_map(read_predecessor) {
                        let key = all.task_links.keys.of(id);
                        all.task_links.add(all.activities.len(), key, kind, lag);
                    }
                }
                Column::Elements => {
                    let joint = if table.semicolons { '|' } else { ';' };
                    let names = cell.split(joint).map(str::trim).filter(|e| !e.is_empty());
                    activity.elements = names.map(str::to_owned).collect();
                }
                Column::Field => {
                    if let Some(name) = self.names.get(&at) {
                        let value = all.field_text(name, cell, place);
                        activity.fields.push((name.clone(), value));
                    }
                }
                Column::Ignored => {}
            }
        }
        activity.fields.shrink_to_fit();
        all.push_texts(activity, texts, dates, place);
    }
}

/// Summaries that a column names by their paths.
#[derive(Default)]
struct Outline {
    nodes: HashMap<(Option<u32>, Box<str>), u32>,
}

impl Outline {
    fn node(&mut self, path: &str, all: &mut Collected) -> Option<u32> {
        let points = !path.contains(['/', '\\', '>']);
        let steps = path.split(|c| if points { c == '.' } else { "/\\>".contains(c) });
        let mut node = None;
        for code in steps.map(str::trim).filter(|code| !code.is_empty()) {
            let next = u32::try_from(all.wbs.len()).unwrap_or(u32::MAX);
            let known = *self.nodes.entry((node, code.into())).or_insert(next);
            if known == next {
                let code = code.to_owned();
                all.wbs.push(WbsNode { code, name: String::new(), parent: node });
            }
            node = Some(known);
        }
        node
    }
}
