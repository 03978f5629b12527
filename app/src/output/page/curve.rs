//! The S-curve as a drawing (SVG).

use chrono::Datelike;
use std::fmt::Write;
use topout_schedule::{SCurve, Time, TimeRange};

/// The drawing, in its own units.
const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 320.0;
const LEFT: f64 = 56.0;
const RIGHT: f64 = 30.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = 34.0;
const LINE: &str = "fill=\"none\" stroke-width=\"2.5\" stroke-linejoin=\"round\"";
/// Colours that people tell apart who do not see red or green (Okabe and Ito).
pub(super) const PLANNED: &str = "#0072b2";
pub(super) const ACTUAL: &str = "#d55e00";
/// Points of a curve.
const POINTS: u32 = 200;
/// Most labels on the axis of time.
const MOST_LABELS: usize = 12;

/// Planned progress over a period, and actual progress as far as it is known.
pub(super) fn svg(progress: &SCurve, period: TimeRange) -> String {
    let x = |time: Time| {
        let since = time.seconds().saturating_sub(period.start.seconds()) as f64;
        LEFT + (since / period.seconds().max(1) as f64).clamp(0.0, 1.0) * (WIDTH - LEFT - RIGHT)
    };
    let y = |share: f64| TOP + (1.0 - share) * (HEIGHT - TOP - BOTTOM);
    let mut svg = format!(
        "<svg class=\"curve\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" \
         aria-label=\"Progress over time\" xmlns=\"http://www.w3.org/2000/svg\" font-size=\"12\" fill=\"#4a5565\">\n"
    );
    for percent in [0, 25, 50, 75, 100] {
        let at = y(f64::from(percent) / 100.0);
        let _ = writeln!(
            svg,
            "<line stroke=\"#e3e6eb\" x1=\"{LEFT}\" y1=\"{at:.1}\" x2=\"{:.1}\" y2=\"{at:.1}\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{percent} %</text>",
            WIDTH - RIGHT,
            LEFT - 6.0,
            at + 4.0,
        );
    }
    for (time, label) in labels(period) {
        let at = x(time);
        let _ = writeln!(
            svg,
            "<line stroke=\"#e3e6eb\" x1=\"{at:.1}\" y1=\"{TOP}\" x2=\"{at:.1}\" y2=\"{:.1}\"/>\
             <text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
            HEIGHT - BOTTOM,
            HEIGHT - BOTTOM + 18.0,
        );
    }
    let points = |until: Time, share: &dyn Fn(Time) -> f64| {
        let span = TimeRange { start: period.start, end: until };
        let times = (0..=POINTS).map(|i| span.at_fraction(f64::from(i) / f64::from(POINTS)));
        times.map(|t| format!("{:.1},{:.1}", x(t), y(share(t)))).collect::<Vec<_>>().join(" ")
    };
    let planned = points(period.end, &|t| f64::from(progress.planned_at(t)));
    let _ = writeln!(svg, "<polyline {LINE} stroke=\"{PLANNED}\" points=\"{planned}\"/>");
    if let Some(until) = progress.known_until().map(|t| t.clamp(period.start, period.end)) {
        let actual = points(until, &|t| progress.actual_at(t).map_or(0.0, f64::from));
        let at = x(until);
        let _ = writeln!(
            svg,
            "<line stroke=\"#7a8494\" stroke-dasharray=\"4 3\" x1=\"{at:.1}\" y1=\"{TOP}\" x2=\"{at:.1}\" y2=\"{:.1}\"/>\
             <polyline {LINE} stroke=\"{ACTUAL}\" points=\"{actual}\"/>",
            HEIGHT - BOTTOM,
        );
    }
    svg.push_str("</svg>\n");
    svg
}

/// First days of months within a period with what they are called, evenly chosen.
fn labels(period: TimeRange) -> Vec<(Time, String)> {
    let months = super::month::starts(period);
    let step = match months.len().div_ceil(MOST_LABELS) {
        ..=1 => 1,
        2..=3 => 3,
        4..=6 => 6,
        n => n.next_multiple_of(12),
    };
    let label = |time: Time| {
        let civil = time.civil()?;
        (civil.month0() as usize).is_multiple_of(step.min(12)).then_some(())?;
        let years = usize::try_from(civil.year()).unwrap_or(0);
        (step <= 12 || years.is_multiple_of(step / 12)).then_some(())?;
        Some((time, civil.format("%b %Y").to_string()))
    };
    months.into_iter().filter_map(label).collect()
}
