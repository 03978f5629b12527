//! A page that tells a project month by month: pictures, what is at work, progress, what is late. It is one HTML file
//! that loads nothing.

mod curve;
mod markup;
mod month;

pub use month::Month;

use super::caption::date_with_weekday;
use super::film::encode_png;
use super::shot::{Background, Studio};
use crate::report::count;
use image::codecs::jpeg::JpegEncoder;
use markup::{data_address, escape};
use std::fmt::Write;
use topout_render::{DrawMode, FrameInput, Picture, Renderer};
use topout_scene::check::{Section, Subject, check, name_of};
use topout_scene::{ElementId, Scene, View};
use topout_schedule::{Activity, Comparison, DateSet, SCurve, Severity, SlipClass, Time};

/// What a page shows.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Plan {
    /// The camera of all pictures.
    pub view: View,
    /// Way of drawing.
    pub mode: DrawMode,
    /// What stands behind the scene.
    pub background: Background,
    /// Late is what ends later in the second set of dates than in the first.
    pub late: [DateSet; 2],
}

/// A page and what stands in it.
#[derive(Clone, PartialEq, Debug)]
pub struct Page {
    /// The file's text.
    pub html: String,
    /// Pictures, one a month.
    pub pictures: usize,
    /// Activities that are late.
    pub late: usize,
    /// Up to when it is known what happened, and the shares in [0, 1] that were planned and done then.
    pub progress: Option<(Time, f64, f64)>,
}

/// Lines of a list that is written; the figure above it counts all.
const LISTED: usize = 60;
/// Late activities in the table.
const LATE_LISTED: usize = 200;
/// Examples of a finding.
const EXAMPLES: usize = 5;
/// Of JPEG, 1 to 100: fine parts stay sharp.
const QUALITY: u8 = 88;

/// Draws the pictures and writes the page's text. `progress` counts the pictures, and can cancel.
///
/// # Errors
/// A [`topout_render::GpuError`], a picture that cannot be encoded, or [`topout_scene::Cancelled`].
pub fn make(
    renderer: &mut Renderer,
    scene: &Scene,
    plan: &Plan,
    progress: &topout_scene::Progress,
) -> anyhow::Result<Page> {
    let months = month::months(scene.schedule.period);
    progress.begin("Drawing the months", months.len() as u64)?;
    let mut studio = Studio::new(renderer, plan.background);
    let mut pictures = Vec::with_capacity(months.len());
    for month in &months {
        let input = FrameInput { view: plan.view, time: shown_at(month), mode: plan.mode };
        let (picture, _) = studio.shoot(&input)?;
        pictures.push(address(&picture, plan.background)?);
        progress.advance(1)?;
    }
    Ok(write(scene, plan.late, &months, &pictures))
}

/// The last second of a month: what is torn down or built at midnight belongs to the next.
fn shown_at(month: &Month) -> Time {
    last(month.range.end, Some(month.range.start))
}

fn address(picture: &Picture, background: Background) -> anyhow::Result<String> {
    if background == Background::Transparent {
        return Ok(data_address("image/png", &encode_png(picture, true)?));
    }
    let mut bytes = Vec::new();
    let rgb: Vec<u8> = picture.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    let size = (picture.width, picture.height);
    JpegEncoder::new_with_quality(&mut bytes, QUALITY).encode(
        &rgb,
        size.0,
        size.1,
        image::ExtendedColorType::Rgb8,
    )?;
    Ok(data_address("image/jpeg", &bytes))
}

/// The page of a scene, with the addresses of a picture a month.
fn write(scene: &Scene, late: [DateSet; 2], months: &[Month], pictures: &[String]) -> Page {
    let schedule = &scene.schedule;
    let name = match (schedule.project.trim(), scene.model.name.trim()) {
        ("", "") => "Project",
        ("", model) => model,
        (project, _) => project,
    };
    let name = escape(name);
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; \
         style-src 'unsafe-inline'\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <title>{name}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<header>\n<h1>{name}</h1>\n"
    );
    let progress = SCurve::new(schedule);
    let known = progress.known_until().map(|t| {
        let actual = progress.actual_at(t).unwrap_or_default();
        (t, f64::from(progress.planned_at(t)), f64::from(actual))
    });
    html.push_str(&summary(scene, known));
    html.push_str("</header>\n<main>\n");
    if !progress.is_empty() {
        html.push_str("<section id=\"progress\">\n<h2>Progress</h2>\n");
        html.push_str(&curve::svg(&progress, schedule.period));
        let key = |word, color| format!("<b style=\"color:{color}\">{word}</b> \u{b7} ");
        let _ = write!(html, "<p class=\"key\">{}", key("planned", curve::PLANNED));
        if known.is_some() {
            html.push_str(&key("actual", curve::ACTUAL));
        }
        html.push_str("weighted by planned time</p>\n</section>\n");
    }
    let slips = Comparison::of_sets(schedule, late[0], late[1]);
    let later = lateness(scene, late, &slips);
    html.push_str(&late_section(scene, late, &slips, &later));
    html.push_str("<section id=\"months\">\n<h2>Month by month</h2>\n");
    for (month, picture) in months.iter().zip(pictures) {
        html.push_str(&month_section(scene, month, picture));
    }
    html.push_str("</section>\n");
    html.push_str(&findings(scene));
    html.push_str("</main>\n<footer><p>Made by topout.</p></footer>\n</body>\n</html>\n");
    Page { html, pictures: pictures.len(), late: later.len(), progress: known }
}

fn summary(scene: &Scene, known: Option<(Time, f64, f64)>) -> String {
    let schedule = &scene.schedule;
    let mut text = String::from("<p class=\"facts\">");
    if !schedule.activities.is_empty() {
        let [from, to] = [schedule.period.start, schedule.period.end].map(date_with_weekday);
        let activities = count(schedule.activities.len());
        let _ = write!(
            text,
            "{} to {} \u{b7} {activities} activities \u{b7} ",
            escape(&from),
            escape(&to)
        );
    }
    let elements = count(scene.model.elements.len());
    let _ = writeln!(text, "{elements} elements</p>");
    if let Some((time, planned, actual)) = known {
        let [planned, actual] = [planned, actual].map(|share| (share * 100.0).round());
        let _ = writeln!(
            text,
            "<p class=\"facts\">On {}: {actual} % done, {planned} % planned</p>",
            escape(&date_with_weekday(time)),
        );
    }
    text
}

/// An activity that is late: a place in the schedule's list, and the working days by which it ended later; `None`
/// where it should have ended and has not.
type Late = (usize, Option<f64>);

/// What has not ended though it should have, up to the day on which that is known, then what ended later, most first.
fn lateness(scene: &Scene, [from, to]: [DateSet; 2], slips: &Comparison) -> Vec<Late> {
    let schedule = &scene.schedule;
    let due = |activity: &Activity| {
        let ended = activity.dates_of(to).end.is_some();
        let due = activity.dates_of(from).end.filter(|_| to == DateSet::Actual && activity.active);
        !ended && due.zip(schedule.data_date).is_some_and(|(due, known)| due <= known)
    };
    let open = schedule.activities.iter().enumerate().filter(|(_, activity)| due(activity));
    let mut late: Vec<Late> = open.map(|(i, _)| (i, None)).collect();
    let later = slips
        .slips
        .iter()
        .filter(|slip| matches!(slip.class(), SlipClass::Later | SlipClass::MuchLater));
    let mut later: Vec<_> = later.map(|slip| (slip.activity, slip.working_days)).collect();
    later.sort_by(|a, b| b.1.total_cmp(&a.1));
    late.extend(later.into_iter().map(|(activity, days)| (activity, Some(days))));
    late
}

fn late_section(
    scene: &Scene,
    [from, to]: [DateSet; 2],
    all: &Comparison,
    late: &[Late],
) -> String {
    let schedule = &scene.schedule;
    if schedule.activities.is_empty() {
        return String::new();
    }
    let (from_word, to_word) = (from.word(), to.word());
    let mut text =
        format!("<section id=\"late\">\n<h2>Late activities ({})</h2>\n", count(late.len()));
    if all.totals.missing == all.slips.len() && late.is_empty() {
        let _ = write!(
            text,
            "<p>No activity has both {from_word} and {to_word} dates.</p>\n</section>\n"
        );
        return text;
    }
    let totals = all.totals;
    let _ = writeln!(
        text,
        "<p>Ends, {to_word} beside {from_word}: {} later, {} on time, {} earlier, {} without both dates.</p>",
        count(totals.later),
        count(totals.on_time),
        count(totals.earlier),
        count(totals.missing),
    );
    if !late.is_empty() {
        let _ = writeln!(
            text,
            "<table>\n<thead><tr><th>Activity</th><th>Name</th><th>End {from_word}</th><th>End {to_word}</th>\
             <th class=\"n\">Working days</th></tr></thead>\n<tbody>"
        );
        for &(activity, days) in late.iter().take(LATE_LISTED) {
            let activity = &schedule.activities[activity];
            let end = |set| {
                let dates = activity.dates_of(set);
                dates.end.map_or_else(|| "not yet".to_owned(), |end| short(last(end, dates.start)))
            };
            let _ = writeln!(
                text,
                "<tr><td>{}</td><td>{}</td><td class=\"date\">{}</td><td class=\"date\">{}</td>\
                 <td class=\"n\">{}</td></tr>",
                escape(&activity.id),
                escape(&activity.name),
                end(from),
                end(to),
                days.map_or_else(String::new, |days| format!("+{days:.1}")),
            );
        }
        text.push_str("</tbody>\n</table>\n");
        text.push_str(&more(late.len(), LATE_LISTED));
    }
    text.push_str("</section>\n");
    text
}

/// The last second of something that ends: what ends at midnight ends on the day before.
fn last(end: Time, start: Option<Time>) -> Time {
    let last = end.plus_seconds(-1);
    start.map_or(last, |start| last.max(start))
}

fn month_section(scene: &Scene, month: &Month, picture: &str) -> String {
    let schedule = &scene.schedule;
    let Month { range, name } = month;
    let at = shown_at(month);
    let standing = (0..scene.model.elements.len() as u32)
        .filter(|&id| scene.behaviour(ElementId(id)).at(at))
        .count();
    let name = escape(name);
    let day = escape(&date_with_weekday(at));
    let mut text = format!(
        "<article>\n<h3>{name}</h3>\n<figure><img src=\"{picture}\" alt=\"{name}\"/>\
         <figcaption>{day} \u{b7} {} {} there</figcaption></figure>\n",
        count(standing),
        if standing == 1 { "element stands" } else { "elements stand" },
    );
    let words = [["starts", "start"], ["ends", "end"], ["is at work", "are at work"]];
    let mut lists: [Vec<(Time, &Activity)>; 3] = Default::default();
    for activity in schedule.activities.iter().filter(|a| a.active) {
        let Some(dates) = activity.dates() else { continue };
        let last = last(dates.end, Some(dates.start));
        if range.contains(dates.start) {
            lists[0].push((dates.start, activity));
        }
        if range.contains(last) {
            lists[1].push((last, activity));
        }
        if dates.start < range.end && last >= range.start {
            lists[2].push((dates.start, activity));
        }
    }
    text.push_str("<div class=\"lists\">\n");
    for ([one, several], mut list) in words.into_iter().zip(lists) {
        let what = match list.len() {
            1 => format!("activity {one}"),
            _ => format!("activities {several}"),
        };
        list.sort_by(|a, b| (a.0, &a.1.id).cmp(&(b.0, &b.1.id)));
        let _ = writeln!(text, "<details><summary><b>{}</b> {what}</summary>", count(list.len()));
        if !list.is_empty() {
            text.push_str("<ul>\n");
            for (time, activity) in list.iter().take(LISTED) {
                let _ = writeln!(
                    text,
                    "<li><span class=\"day\">{}</span> {} <span class=\"id\">{}</span></li>",
                    short(*time),
                    escape(&activity.name),
                    escape(&activity.id),
                );
            }
            text.push_str("</ul>\n");
            text.push_str(&more(list.len(), LISTED));
        }
        text.push_str("</details>\n");
    }
    text.push_str("</div>\n</article>\n");
    text
}

/// What loading found, and what there is to look at.
fn findings(scene: &Scene) -> String {
    let mut text = String::from("<section id=\"findings\">\n<h2>Findings</h2>\n");
    let mut rows = Vec::new();
    for found in scene.diagnostics.iter() {
        let examples = found.examples.iter().take(EXAMPLES).cloned().collect::<Vec<_>>().join(", ");
        rows.push((found.severity, found.count, found.message.clone(), examples));
    }
    for Section { title, severity, rows: listed, .. } in check(scene) {
        let subject = |subject: Subject| match subject {
            Subject::Element(id) => name_of(&scene.model.elements[id.index()]).to_owned(),
            Subject::Activity(index) => scene.schedule.activities[index as usize].id.clone(),
        };
        let examples: Vec<_> =
            listed.iter().take(EXAMPLES).map(|row| subject(row.subject)).collect();
        rows.push((severity, listed.len(), title.to_owned(), examples.join(", ")));
    }
    rows.sort_by_key(|row| std::cmp::Reverse(row.0));
    if rows.is_empty() {
        text.push_str("<p>None.</p>\n</section>\n");
        return text;
    }
    text.push_str("<table>\n<thead><tr><th></th><th class=\"n\">Number</th><th>What</th><th>Such as</th></tr></thead>\n<tbody>\n");
    for (severity, number, what, examples) in rows {
        let word = match severity {
            Severity::Info => "note",
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        let _ = writeln!(
            text,
            "<tr class=\"{word}\"><td>{word}</td><td class=\"n\">{}</td><td>{}</td><td>{}</td></tr>",
            count(number),
            escape(&what),
            escape(&examples),
        );
    }
    text.push_str("</tbody>\n</table>\n</section>\n");
    text
}

/// The day of a time.
fn short(time: Time) -> String {
    time.civil().map_or_else(|| time.to_string(), |civil| civil.format("%Y-%m-%d").to_string())
}

/// How many a list leaves out.
fn more(all: usize, listed: usize) -> String {
    match all.saturating_sub(listed) {
        0 => String::new(),
        left => format!("<p class=\"more\">and {} more</p>\n", count(left)),
    }
}

const STYLE: &str = "\
:root{color-scheme:light}
body{margin:0;font:15px/1.45 system-ui,sans-serif;color:#1d2530;background:#f4f5f7}
header,main,footer{max-width:1000px;margin:0 auto;padding:0 20px}
header{padding-top:28px}h1{margin:0 0 6px;font-size:28px}h2{margin:34px 0 10px;font-size:20px}
h3{margin:0 0 8px;font-size:17px}.facts{margin:0;color:#4a5565}
article,#progress,#late,#findings{background:#fff;border:1px solid #dde1e7;border-radius:8px;padding:16px 18px;margin:0 0 18px}
#progress h2,#late h2,#findings h2{margin-top:0}header{margin-bottom:22px}
figure{margin:0}img{display:block;max-width:100%;height:auto;border-radius:5px}figcaption{color:#4a5565;margin:6px 0 10px}
.lists{display:grid;grid-template-columns:repeat(auto-fit,minmax(270px,1fr));gap:6px 18px;align-items:start}
summary{cursor:pointer}ul{margin:6px 0;padding:0;list-style:none;font-size:13px}li{padding:1px 0;overflow-wrap:anywhere}
.day{color:#4a5565;font-variant-numeric:tabular-nums}.id,.more{color:#7a8494;font-size:12px}
table{border-collapse:collapse;width:100%;font-size:13px}th,td{text-align:left;vertical-align:top;padding:4px 10px 4px 0;border-bottom:1px solid #e7eaee;overflow-wrap:break-word}td:first-child,.day,.date{white-space:nowrap}
.n{text-align:right;font-variant-numeric:tabular-nums}.error td:first-child{color:#b3261e;font-weight:600}.warning td:first-child{color:#9a5b00}
.curve{width:100%;height:auto}.key{margin:4px 0 0;color:#4a5565}.key b{font-weight:600}
footer{color:#7a8494;padding-bottom:30px}@media print{body{background:#fff}article{break-inside:avoid}}
";

#[cfg(test)]
mod tests;
