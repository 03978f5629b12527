//! The axis: ruler, events and progress over time, and everything that dragging on it means.

use super::super::calendar::{Calendar, DAY, short_date};
use super::super::clock::Step;
use super::super::command::Command;
use super::super::overlay::short_count;
use super::super::state::AppState;
use super::super::theme::{Palette, SMALL, palette};
use super::super::viewport::wheel_notches;
use super::Scale;
use super::scale::Ticks;
use egui::{
    Align2, Color32, FontId, Painter, PointerButton, Pos2, Rect, Response, Sense, Stroke, Ui,
};
use topout_schedule::{Time, TimeRange};

/// Height of one row of the ruler, points; it has two.
pub const RULER_ROW: f32 = 15.0;
/// Height of the strip of events below it, points.
const STRIP: f32 = 36.0;
/// Height of the curves of progress below that, points.
const CURVES: f32 = 36.0;
/// Distance of the points of a curve, points.
const CURVE_STEP: f32 = 4.0;
/// Width of one bar of the strip, points.
const BAR: f32 = 3.0;
/// Days have to be so wide, in points, for days off to be shaded.
const SHADED_DAY: f32 = 2.5;
/// Zoom of one notch of the wheel.
const ZOOM_PER_NOTCH: f64 = 0.8;

/// Where time is on the picture.
#[derive(Clone, Copy)]
pub struct Axis {
    /// From the left end to the right one.
    pub place: Rect,
    /// What it shows.
    pub scale: Scale,
}

impl Axis {
    /// Where an instant stands, also where that is beyond the ends; not so far that pictures suffer.
    pub fn x(&self, time: Time) -> f32 {
        let share = self.scale.share(time).clamp(-8.0, 9.0);
        self.place.min.x + (f64::from(self.place.width()) * share) as f32
    }

    /// The share of the axis to the left of a position.
    fn share(&self, x: f32) -> f64 {
        f64::from((x - self.place.min.x) / self.place.width().max(1.0))
    }

    /// The instant at a position.
    pub fn at(&self, x: f32) -> Time {
        self.scale.at(self.share(x))
    }

    /// Seconds that a distance on the picture stands for.
    pub fn seconds(&self, points: f32) -> f64 {
        (self.scale.range().seconds() as f64) * f64::from(points / self.place.width().max(1.0))
    }
}

/// Draws the axis and collects what is asked for.
pub fn show(ui: &mut Ui, calendar: &Calendar, state: &AppState, commands: &mut Vec<Command>) {
    let curves = state.project.as_ref().map(|p| &p.progress).filter(|curves| !curves.is_empty());
    let below = if state.panels.curves && curves.is_some() { CURVES } else { 0.0 };
    let size = egui::vec2(ui.available_width(), 2.0 * RULER_ROW + STRIP + below);
    let (place, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let axis = Axis { place, scale: state.scale };
    let ruler = Rect::from_min_size(place.min, egui::vec2(place.width(), 2.0 * RULER_ROW));
    let strip = Rect::from_min_size(ruler.left_bottom(), egui::vec2(place.width(), STRIP));
    let graph = Rect::from_min_max(strip.left_bottom(), place.max);
    announce(ui, &response, state, commands);

    let colors = palette(ui);
    let painter = ui.painter_at(place.expand(1.0));
    let well = Rect::from_min_max(strip.min, place.max);
    painter.rect_filled(well, 4.0, colors.well);
    days_off(&painter, well, axis, state, colors);
    if let Some(looped) = state.clock.looped() {
        let band =
            Rect::from_x_y_ranges(axis.x(looped.start)..=axis.x(looped.end), place.y_range());
        painter.rect_filled(band, 0.0, colors.accent.gamma_multiply(0.18));
        for x in [band.min.x, band.max.x] {
            painter.vline(x, place.y_range(), Stroke::new(1.0, colors.accent));
        }
    }
    marks(&painter, ruler, well, axis, &axis.scale.ticks(place.width()), colors);
    density(&painter, strip, axis, calendar, colors, state.time());
    if let Some(curves) = curves.filter(|_| below > 0.0) {
        let planned = |time| Some(curves.planned_at(time));
        curve(&painter, graph, axis, planned, Stroke::new(1.5, colors.weak));
        let actual = |time| curves.actual_at(time);
        curve(&painter, graph, axis, actual, Stroke::new(2.0, colors.accent));
    }
    if let Some(data_date) = state.project.as_ref().and_then(|p| p.scene.schedule.data_date) {
        painter.vline(axis.x(data_date), place.y_range(), Stroke::new(1.5, colors.data_date));
    }
    let x = axis.x(state.time());
    painter.vline(x, place.y_range(), Stroke::new(2.0, colors.cursor));
    painter.circle_filled(egui::pos2(x, place.min.y + 5.0), 4.0, colors.cursor);

    gestures(ui, &response, axis, state, commands);
    hover(ui, &response, &painter, axis, calendar, state, well);
}

/// What screen readers hear: a slider whose value is the date.
fn announce(ui: &Ui, response: &Response, state: &AppState, commands: &mut Vec<Command>) {
    let now = state.time();
    let share = Scale::of(state.period()).share(now) * 100.0;
    response.widget_info(|| egui::WidgetInfo::slider(true, share, "Timeline"));
    let text = state.calendar().map_or_else(String::new, |c| c.headline(now));
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_value(text);
        node.add_action(egui::accesskit::Action::Increment);
        node.add_action(egui::accesskit::Action::Decrement);
    });
    ui.input(|input| {
        use egui::accesskit::Action;
        for (action, days) in [(Action::Increment, 1), (Action::Decrement, -1)] {
            for _ in 0..input.num_accesskit_action_requests(response.id, action) {
                commands.push(Command::Step(Step::Days(days)));
            }
        }
    });
}

/// What a drag with the primary button does, by what was held when it began.
#[derive(Clone, Copy, PartialEq)]
enum Grab {
    Scrub,
    /// A part to play again and again, from here.
    Loop(Time),
}

/// Scrubbing, loops, panning and zooming.
pub fn gestures(
    ui: &Ui,
    response: &Response,
    axis: Axis,
    state: &AppState,
    commands: &mut Vec<Command>,
) {
    let period = state.period();
    let pressed = ui.input(|input| {
        input.events.iter().find_map(|event| match *event {
            egui::Event::PointerButton {
                pos,
                button: PointerButton::Primary,
                pressed: true,
                modifiers,
            } => Some((pos, modifiers)),
            _ => None,
        })
    });
    if let Some((at, modifiers)) = pressed
        && response.contains_pointer()
    {
        let grab = if modifiers.shift { Grab::Loop(axis.at(at.x)) } else { Grab::Scrub };
        ui.data_mut(|data| data.insert_temp(response.id, grab));
    }
    let grab: Option<Grab> = ui.data(|data| data.get_temp(response.id));
    if let (Some(grab), Some(pointer)) = (grab, response.interact_pointer_pos()) {
        let to = axis.at(pointer.x);
        match grab {
            // The end of a drag counts too: a quick one may begin and end within one slow frame.
            Grab::Scrub => commands.push(Command::JumpTo(to)),
            Grab::Loop(_) if response.clicked() => commands.push(Command::SetLoop(None)),
            Grab::Loop(from) => {
                let range = TimeRange { start: from.min(to), end: from.max(to) };
                commands.push(Command::SetLoop(Some(range)));
            }
        }
    }
    if grab.is_some() && !ui.input(|input| input.pointer.primary_down()) {
        ui.data_mut(|data| data.remove::<Grab>(response.id));
    }
    if response.dragged_by(PointerButton::Middle) {
        let moved = f64::from(-response.drag_delta().x / axis.place.width().max(1.0));
        commands.push(Command::ShowTime(axis.scale.panned(moved, period)));
    }
    if response.double_clicked() {
        commands.push(Command::FitTimeline);
    }
    if let Some(hover) = response.hover_pos() {
        wheel(ui, axis, hover.x, period, commands);
    }
}

/// Zooms and pans while the pointer is over the axis.
pub fn wheel(ui: &Ui, axis: Axis, x: f32, period: TimeRange, commands: &mut Vec<Command>) {
    let turned = wheel_notches(ui);
    if turned.y != 0.0 {
        let factor = ZOOM_PER_NOTCH.powf(f64::from(turned.y));
        commands.push(Command::ShowTime(axis.scale.zoomed(axis.share(x), factor, period)));
    }
    if turned.x != 0.0 {
        let scale = axis.scale.panned(f64::from(-turned.x) * 0.1, period);
        commands.push(Command::ShowTime(scale));
    }
}

/// Shades the days on which nobody works, where days are wide enough to be told apart.
pub fn days_off(painter: &Painter, well: Rect, axis: Axis, state: &AppState, colors: &Palette) {
    if !axis.scale.shows_days(well.width(), SHADED_DAY) {
        return;
    }
    let Some(work) = state.project.as_ref().and_then(|p| p.scene.schedule.work_calendar()) else {
        return;
    };
    let range = axis.scale.range();
    let Some(first) = range.start.civil() else { return };
    let shade = colors.line.gamma_multiply(0.5);
    for day in first.date().iter_days() {
        let from = Time::from_civil(day.and_time(chrono::NaiveTime::MIN));
        if from >= range.end {
            break;
        }
        if work.shifts_on(day).is_empty() {
            let to = axis.x(from.plus_seconds(DAY)).min(well.max.x);
            let shaded = Rect::from_x_y_ranges(axis.x(from).max(well.min.x)..=to, well.y_range());
            painter.rect_filled(shaded, 0.0, shade);
        }
    }
}

/// The ruler: coarse marks above, fine ones below, fine lines through everything.
pub fn marks(
    painter: &Painter,
    ruler: Rect,
    well: Rect,
    axis: Axis,
    ticks: &Ticks,
    colors: &Palette,
) {
    let font = FontId::proportional(SMALL);
    let middle = ruler.min.y + RULER_ROW;
    for (i, tick) in ticks.major.iter().enumerate() {
        let x = axis.x(tick.time);
        let next = ticks.major.get(i + 1).map_or(ruler.max.x, |next| axis.x(next.time));
        if x >= ruler.min.x {
            painter.vline(x, ruler.min.y..=well.max.y, Stroke::new(1.0, colors.line));
        }
        // The one that the axis begins in stands at its left end, as long as it has room.
        let galley = painter.layout_no_wrap(tick.label.clone(), font.clone(), colors.text);
        let left = x.max(ruler.min.x) + 4.0;
        if left + galley.size().x < next {
            painter.galley(egui::pos2(left, ruler.min.y + 1.0), galley, colors.text);
        }
    }
    for tick in &ticks.minor {
        let x = axis.x(tick.time);
        if x < ruler.min.x {
            continue;
        }
        painter.vline(x, middle + 2.0..=ruler.max.y, Stroke::new(1.0, colors.line));
        let galley = painter.layout_no_wrap(tick.label.clone(), font.clone(), colors.weak);
        // A label that would run out of the axis is left out.
        if x + 4.0 + galley.size().x < ruler.max.x {
            painter.galley(egui::pos2(x + 4.0, middle + 1.0), galley, colors.weak);
        }
    }
}

/// Starts (upper part of a bar) and finishes (lower part).
fn density(
    painter: &Painter,
    strip: Rect,
    axis: Axis,
    calendar: &Calendar,
    colors: &Palette,
    now: Time,
) {
    let bins = (strip.width() / BAR).floor().max(1.0) as usize;
    let counts = calendar.density(axis.scale.range(), bins);
    let most = counts.iter().map(|[a, b]| a + b).max().unwrap_or(0).max(1) as f32;
    let width = strip.width() / bins as f32;
    let cursor = axis.x(now);
    for (i, [starts, ends]) in counts.into_iter().enumerate() {
        let count = starts + ends;
        if count == 0 {
            continue;
        }
        // The square root keeps quiet weeks visible beside busy ones.
        let height = ((count as f32 / most).sqrt() * (strip.height() - 6.0)).max(1.0);
        let x = strip.min.x + i as f32 * width;
        let split = strip.max.y - height * ends as f32 / count as f32;
        let bar = |from: f32, to: f32, color: Color32| {
            let place = Rect::from_min_max(Pos2::new(x, from), Pos2::new(x + width - 1.0, to));
            painter.rect_filled(place, 0.0, color);
        };
        let past = x + 0.5 * width < cursor;
        let [up, down] = match past {
            true => [colors.accent.gamma_multiply(0.85), colors.accent.gamma_multiply(0.45)],
            false => [colors.bars, colors.bars.gamma_multiply(0.6)],
        };
        bar(strip.max.y - height, split, up);
        bar(split, strip.max.y, down);
    }
}

/// Progress from 0 at the foot to 1 at the top, as far as it is known.
fn curve(
    painter: &Painter,
    graph: Rect,
    axis: Axis,
    share: impl Fn(Time) -> Option<f32>,
    stroke: Stroke,
) {
    let inner = graph.shrink2(egui::vec2(0.0, 3.0));
    let steps = (inner.width() / CURVE_STEP).ceil().max(1.0) as usize;
    let at = |step: usize| {
        let x = inner.min.x + inner.width() * step as f32 / steps as f32;
        Some(Pos2::new(x, inner.max.y - share(axis.at(x))? * inner.height()))
    };
    painter.line((0..=steps).map_while(at).collect(), stroke);
}

/// What is under the pointer, written into the strip: a tooltip would cover the shown date.
fn hover(
    ui: &Ui,
    response: &Response,
    painter: &Painter,
    axis: Axis,
    calendar: &Calendar,
    state: &AppState,
    well: Rect,
) {
    let Some(pointer) = response.hover_pos().filter(|_| !response.dragged()) else { return };
    let colors = palette(ui);
    let time = axis.at(pointer.x.clamp(axis.place.min.x, axis.place.max.x));
    painter.vline(pointer.x, axis.place.y_range(), Stroke::new(1.0, colors.weak));
    let active = short_count(calendar.active_at(time) as u64);
    let mut text = format!("{} · {active} active", short_date(time));
    if let Some(curves) = state.project.as_ref().map(|p| &p.progress).filter(|c| !c.is_empty()) {
        text += &format!(" · planned {:.0} %", curves.planned_at(time) * 100.0);
        if let Some(actual) = curves.actual_at(time) {
            text += &format!(", actual {:.0} %", actual * 100.0);
        }
    }
    let galley = painter.layout_no_wrap(text, FontId::proportional(SMALL), colors.strong);
    // To the right of the pointer, to its left where there is no room.
    let left = if pointer.x + galley.size().x + 16.0 < well.max.x {
        pointer.x + 8.0
    } else {
        pointer.x - galley.size().x - 8.0
    };
    let place = Rect::from_min_size(egui::pos2(left, well.min.y + 4.0), galley.size());
    painter.rect_filled(place.expand(4.0), 4.0, colors.panel.gamma_multiply(0.9));
    painter.text(
        place.min,
        Align2::LEFT_TOP,
        galley.text(),
        FontId::proportional(SMALL),
        colors.strong,
    );
}
