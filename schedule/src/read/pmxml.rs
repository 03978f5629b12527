//! Primavera P6's XML (PMXML): what XER says, as elements.

use super::collected::Collected;
use super::error::ReadError;
use super::p6::{P6, Progress, TaskIds, task_type};
use super::xml::{Step, Xml};
use crate::calendar::seconds_of_day;
use crate::sources::Place;
use crate::{Activity, Calendar, CalendarException, DateSet, LinkKind, Shift};
use chrono::NaiveDate;

/// Parts of an activity that are kept as fields under the same name.
const KEPT: [&str; 9] = [
    "Type",
    "Status",
    "PlannedDuration",
    "RemainingDuration",
    "TotalFloat",
    "PrimaryConstraintType",
    "PrimaryConstraintDate",
    "LevelingPriority",
    "GUID",
];

pub(super) fn read(xml: &mut Xml, all: &mut Collected) -> Result<(), ReadError> {
    let mut reader = Pmxml::default();
    loop {
        match xml.next()? {
            Step::Open => reader.open(xml, all),
            Step::Close => reader.close(xml, all),
            Step::End => break,
        }
    }
    reader.p6.finish(all);
    Ok(())
}

#[derive(Default)]
struct Pmxml {
    p6: P6,
    project: Project,
    /// Texts of the record that is being read, by what they are.
    parts: Parts,
    activity: Option<(Activity, Place)>,
    bad_dates: bool,
    progress: Progress,
    calendar: CalendarDraft,
    /// The code or user field of an activity that is being read: type and value.
    code: [String; 2],
    /// Those of the activity, which may come before its own id.
    codes: Vec<[String; 2]>,
    user_fields: Vec<[String; 2]>,
}

/// The project or baseline within which activities are read.
#[derive(Default)]
struct Project {
    id: String,
    known: bool,
}

#[derive(Default)]
struct Parts {
    object: String,
    id: String,
    name: String,
    parent: String,
    calendar: String,
    wbs: String,
    original: String,
    predecessor: String,
    successor: String,
    kind: LinkKind,
    lag: f64,
    subject: String,
}

#[derive(Default)]
struct CalendarDraft {
    calendar: Calendar,
    base: String,
    weekday: Option<usize>,
    day: Option<NaiveDate>,
    shifts: Vec<Shift>,
    start: Option<u32>,
}

impl Pmxml {
    fn open(&mut self, xml: &Xml, all: &mut Collected) {
        if matches!(
            xml.name(),
            b"Activity"
                | b"WBS"
                | b"Relationship"
                | b"Calendar"
                | b"ActivityCodeType"
                | b"ActivityCode"
                | b"UDFType"
        ) && matches!(xml.parent(), b"Project" | b"BaselineProject")
        {
            self.before_records(all);
        }
        match xml.name() {
            b"Project" | b"BaselineProject" => {
                self.project = Project::default();
                self.parts = Parts::default();
            }
            b"Activity" => {
                self.parts = Parts::default();
                self.progress = Progress::default();
                self.bad_dates = false;
                self.activity = Some((Activity::default(), all.next_place(xml.line())));
            }
            b"WBS" | b"Relationship" | b"ActivityCodeType" | b"ActivityCode" | b"UDFType" => {
                self.parts = Parts::default();
            }
            b"Calendar" => {
                self.parts = Parts::default();
                self.calendar = CalendarDraft::default();
            }
            b"StandardWorkHours" | b"HolidayOrException" => {
                self.calendar.shifts.clear();
                (self.calendar.weekday, self.calendar.day) = (None, None);
            }
            b"Code" | b"UDF" => self.code = Default::default(),
            _ => {}
        }
    }

    /// The project's own parts come before its records.
    fn before_records(&mut self, all: &mut Collected) {
        if std::mem::replace(&mut self.project.known, true) {
            return;
        }
        let Parts { object, id, name, calendar, original, .. } = &self.parts;
        self.project.id.clone_from(object);
        self.p6.project(object, id, calendar, original);
        if original.is_empty() {
            all.name_project(if name.is_empty() { id } else { name });
        }
    }

    fn close(&mut self, xml: &Xml, all: &mut Collected) {
        let text = xml.text();
        match (xml.parent(), xml.name()) {
            (b"Project" | b"BaselineProject", name) if !self.project.known => {
                self.part_of_project(name, xml, all);
            }
            (b"Activity", name) => self.part_of_activity(name, xml, all),
            (
                b"WBS" | b"Calendar" | b"ActivityCodeType" | b"ActivityCode" | b"UDFType"
                | b"Relationship",
                name,
            ) => self.part_of_record(name, text),
            (b"Code", b"TypeObjectId") | (b"UDF", b"TypeObjectId") => {
                text.clone_into(&mut self.code[0]);
            }
            (b"Code", b"ValueObjectId") => text.clone_into(&mut self.code[1]),
            (b"UDF", b"CodeValue") if !self.code[1].is_empty() => {}
            (b"UDF", _) if !text.is_empty() => text.clone_into(&mut self.code[1]),
            _ => self.part_of_calendar(xml),
        }
        self.record(xml, all);
    }

    fn part_of_project(&mut self, name: &[u8], xml: &Xml, all: &mut Collected) {
        let text = xml.text();
        match name {
            b"DataDate" => {
                let date = all.civil_date(text, "data date", &self.parts.id, all.line(xml.line()));
                if xml.parent() == b"Project" {
                    all.data_date = all.data_date.max(date);
                }
            }
            b"ActivityDefaultCalendarObjectId" => text.clone_into(&mut self.parts.calendar),
            b"OriginalProjectObjectId" => text.clone_into(&mut self.parts.original),
            _ => self.part_of_record(name, text),
        }
    }

    fn part_of_record(&mut self, name: &[u8], text: &str) {
        let parts = &mut self.parts;
        let part = match name {
            b"ObjectId" => &mut parts.object,
            b"Id" | b"Code" | b"CodeValue" => &mut parts.id,
            b"Name" | b"Title" | b"Description" => &mut parts.name,
            b"ParentObjectId" => &mut parts.parent,
            b"BaseCalendarObjectId" => &mut self.calendar.base,
            b"SubjectArea" => &mut parts.subject,
            b"PredecessorActivityObjectId" => &mut parts.predecessor,
            b"SuccessorActivityObjectId" => &mut parts.successor,
            b"Type" => {
                parts.kind = match text {
                    "Start to Start" => LinkKind::StartStart,
                    "Finish to Finish" => LinkKind::FinishFinish,
                    "Start to Finish" => LinkKind::StartFinish,
                    _ => LinkKind::FinishStart,
                };
                return;
            }
            b"Lag" => {
                parts.lag = number(text).unwrap_or_default();
                return;
            }
            _ => return,
        };
        text.clone_into(part);
    }

    fn part_of_activity(&mut self, name: &[u8], xml: &Xml, all: &mut Collected) {
        let Some((activity, place)) = &mut self.activity else { return };
        let (text, parts, progress) = (xml.text(), &mut self.parts, &mut self.progress);
        let date = match name {
            b"PlannedStartDate" => Some((DateSet::Planned, true)),
            b"PlannedFinishDate" => Some((DateSet::Planned, false)),
            b"ActualStartDate" => Some((DateSet::Actual, true)),
            b"ActualFinishDate" => Some((DateSet::Actual, false)),
            b"StartDate" => Some((DateSet::Forecast, true)),
            b"FinishDate" => Some((DateSet::Forecast, false)),
            _ => None,
        };
        if let Some((set, is_start)) = date {
            let what = String::from_utf8_lossy(name);
            let time = all.civil_date(text, &what, &activity.id, *place);
            self.bad_dates |= time.is_none() && !text.trim().is_empty();
            let dates = &mut activity.date_sets[set];
            *(if is_start { &mut dates.start } else { &mut dates.end }) = time;
            return;
        }
        match name {
            b"ObjectId" => text.clone_into(&mut parts.object),
            b"Id" => text.clone_into(&mut activity.id),
            b"Name" => text.clone_into(&mut activity.name),
            b"WBSObjectId" => text.clone_into(&mut parts.wbs),
            b"CalendarObjectId" => text.clone_into(&mut parts.calendar),
            b"Type" => (activity.kind, activity.milestone) = task_type(text),
            b"Status" => progress.complete = text == "Completed",
            b"PercentCompleteType" => {
                let measure = if text == "Physical" { "CP_Phys" } else { text };
                measure.clone_into(&mut progress.measure);
            }
            // Shares from 0 to 1; how it is measured is settled already.
            b"PercentComplete" => {
                let percent = number(text).map(|share| (share * 100.0).clamp(0.0, 100.0) as f32);
                activity.percent_complete = percent;
            }
            b"PhysicalPercentComplete" => progress.physical = number(text).map(|s| s * 100.0),
            b"PlannedDuration" => progress.target_hours = number(text),
            b"RemainingDuration" => progress.remaining_hours = number(text),
            b"Code" => self.codes.push(std::mem::take(&mut self.code)),
            b"UDF" => self.user_fields.push(std::mem::take(&mut self.code)),
            _ => {}
        }
        let kept = KEPT.into_iter().find(|kept| kept.as_bytes() == name);
        if let Some(kept) = kept.filter(|_| !text.is_empty()) {
            let value = all.field_text(kept, text, *place);
            activity.fields.push((all.name(kept), value));
        }
    }

    fn part_of_calendar(&mut self, xml: &Xml) {
        let (text, draft) = (xml.text().trim(), &mut self.calendar);
        match (xml.parent(), xml.name()) {
            (b"StandardWorkHours", b"DayOfWeek") => {
                let days =
                    ["Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday", "Sunday"];
                draft.weekday = days.iter().position(|day| *day == text);
            }
            (b"HolidayOrException", b"Date") => {
                draft.day = text.get(..10).and_then(|day| day.parse().ok());
            }
            (b"WorkTime", b"Start") => draft.start = seconds_of_day(text),
            (b"WorkTime", b"Finish") => {
                let shift = draft.start.take().zip(finish_of_shift(text));
                draft.shifts.extend(shift.and_then(|(start, end)| Shift::new(start, end)));
            }
            (_, b"StandardWorkHours") => {
                if let Some(day) = draft.weekday.take() {
                    draft.calendar.week[day] = std::mem::take(&mut draft.shifts);
                }
            }
            (_, b"HolidayOrException") => {
                if let Some(day) = draft.day.take() {
                    let shifts = std::mem::take(&mut draft.shifts);
                    let exception = CalendarException { first: day, last: day, shifts };
                    draft.calendar.exceptions.push(exception);
                }
            }
            _ => {}
        }
    }

    /// Takes a record that is complete.
    fn record(&mut self, xml: &Xml, all: &mut Collected) {
        let Parts { object, id, name, parent, calendar, wbs, .. } = &self.parts;
        match xml.name() {
            b"Activity" => {
                let Some((mut activity, place)) = self.activity.take() else { return };
                if activity.percent_complete.is_none() || self.progress.complete {
                    activity.percent_complete = self.progress.percent();
                }
                for [kind, value] in self.codes.drain(..) {
                    self.p6.code(object, &kind, &value);
                }
                for [kind, value] in self.user_fields.drain(..) {
                    let value = all.field_text("UDF", &value, place);
                    self.p6.user_value(object, &kind, value);
                }
                let project = &self.project.id;
                let ids = TaskIds { object, project, wbs, calendar };
                self.p6.task(&ids, activity, place, self.bad_dates, all);
            }
            // Baselines repeat the outline.
            b"WBS" if xml.parent() != b"BaselineProject" => self.p6.node(object, parent, id, name),
            b"Relationship" if xml.parent() != b"BaselineProject" => {
                let Parts { predecessor, successor, kind, lag, .. } = &self.parts;
                self.p6.link(successor, predecessor, *kind, *lag);
            }
            b"Calendar" if !object.is_empty() => {
                let mut draft = std::mem::take(&mut self.calendar);
                draft.calendar.name.clone_from(name);
                self.p6.calendar(object, &draft.base, draft.calendar);
            }
            b"ActivityCodeType" => self.p6.code_type(object, name, all),
            b"ActivityCode" => self.p6.code_value(object, id, name),
            b"UDFType" if self.parts.subject == "Activity" => self.p6.user_type(object, name, all),
            // A project without records still names and dates what is read.
            b"Project" | b"BaselineProject" => self.before_records(all),
            _ => {}
        }
    }
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|n: &f64| n.is_finite())
}

/// P6 writes the last minute of a shift, 16:59 for 17:00; no shift ends at an odd minute otherwise.
fn finish_of_shift(text: &str) -> Option<u32> {
    let end = seconds_of_day(text)?;
    Some(match end % 300 {
        240..=299 => end - end % 300 + 300,
        _ if end == 0 => 86_400,
        _ => end,
    })
}
