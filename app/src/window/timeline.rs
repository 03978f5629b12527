//! The bottom of the window: transport, date, and the axis that is dragged.

use super::calendar::{Calendar, short_date};
use super::command::{Command, keys_of};
use super::overlay::short_count;
use super::state::{AppState, SPEEDS};
use super::theme::{SMALL, TITLE, palette};
use egui::{
    Align, Align2, Color32, FontId, Layout, Rect, Response, RichText, Sense, Shape, Stroke, Ui,
};
use topout_schedule::Time;

/// Height of the density strip, points.
const STRIP: f32 = 44.0;
/// Height of the row of month names below it, points.
const AXIS: f32 = 16.0;
/// Width of one bar of the density strip, points.
const BAR: f32 = 3.0;
/// Room that a month's name needs, points.
const LABEL: f32 = 44.0;

/// Draws both rows and collects what is asked for.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(calendar) = state.calendar() else { return };
    ui.horizontal(|ui| {
        transport(ui, state, commands);
        ui.add_space(8.0);
        speed(ui, state, commands);
        ui.add_space(8.0);
        date(ui, calendar, state.time());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            counts(ui, calendar, state.time());
        });
    });
    axis(ui, calendar, state, commands);
}

fn transport(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = 4.0;
    let mut button = |icon: Icon, name: &str, command: Command| {
        let tip = format!("{name} ({})", keys_of(&command));
        if icon_button(ui, icon, name).on_hover_text(tip).clicked() {
            commands.push(command);
        }
    };
    button(Icon::ToStart, "Start of project", Command::ToStart);
    button(Icon::Back, "Day back", Command::StepDays(-1));
    if state.playing {
        button(Icon::Pause, "Pause", Command::TogglePlay);
    } else {
        button(Icon::Play, "Play", Command::TogglePlay);
    }
    button(Icon::Forward, "Day forward", Command::StepDays(1));
    button(Icon::ToEnd, "End of project", Command::ToEnd);
}

#[derive(Clone, Copy)]
enum Icon {
    ToStart,
    Back,
    Play,
    Pause,
    Forward,
    ToEnd,
}

/// A button with a drawn sign: fonts differ in which of them they have.
fn icon_button(ui: &mut Ui, icon: Icon, name: &str) -> Response {
    let button = egui::Button::new("").min_size(egui::vec2(28.0, 24.0));
    let response = ui.add(button).accessible_name(name);
    let color = ui.style().interact(&response).fg_stroke.color;
    let (middle, painter) = (response.rect.center(), ui.painter());
    // A triangle that points right (1) or left (-1), its middle moved by `x`.
    let triangle = |x: f32, sign: f32, half: f32| {
        let corners = [(-0.8, -1.0), (0.9, 0.0), (-0.8, 1.0)];
        let at = |(dx, dy): (f32, f32)| middle + egui::vec2(x + dx * half * sign, dy * half);
        painter.add(Shape::convex_polygon(corners.map(at).to_vec(), color, Stroke::NONE));
    };
    let bar = |x: f32, width: f32, half: f32| {
        let size = egui::vec2(width, 2.0 * half);
        painter.rect_filled(Rect::from_center_size(middle + egui::vec2(x, 0.0), size), 0.0, color);
    };
    match icon {
        Icon::Play => triangle(0.0, 1.0, 6.0),
        Icon::Pause => [-3.0, 3.0].into_iter().for_each(|x| bar(x, 3.0, 5.0)),
        Icon::Back => triangle(0.0, -1.0, 4.0),
        Icon::Forward => triangle(0.0, 1.0, 4.0),
        Icon::ToStart => {
            bar(-4.0, 2.0, 4.0);
            triangle(1.0, -1.0, 4.0);
        }
        Icon::ToEnd => {
            triangle(-1.0, 1.0, 4.0);
            bar(4.0, 2.0, 4.0);
        }
    }
    response
}

fn speed(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let text = |days: u32| format!("{days} d/s");
    egui::ComboBox::from_id_salt("speed")
        .selected_text(text(state.speed))
        .width(72.0)
        .show_ui(ui, |ui| {
            for days in SPEEDS {
                if ui.selectable_label(days == state.speed, text(days)).clicked() {
                    commands.push(Command::SetSpeed(days));
                }
            }
        })
        .response
        .accessible_name("Speed")
        .on_hover_text(format!(
            "Days a second while playing (slower {}, faster {})",
            keys_of(&Command::Slower),
            keys_of(&Command::Faster)
        ));
}

fn date(ui: &mut Ui, calendar: &Calendar, time: Time) {
    let tip =
        "The shown date. Weeks count from the Monday of the week in which the project starts.";
    ui.label(RichText::new(calendar.headline(time)).size(TITLE).strong()).on_hover_text(tip);
    if let Some(civil) = time.civil() {
        let clock = civil.format("%H:%M").to_string();
        ui.label(RichText::new(clock).size(SMALL).color(palette(ui).weak));
    }
}

fn counts(ui: &mut Ui, calendar: &Calendar, time: Time) {
    let soon = calendar.starting_in(time.plus_seconds(1), time.plus_seconds(14 * 86_400 + 1));
    ui.label(
        RichText::new(format!("starting in 2 weeks: {soon}")).size(SMALL).color(palette(ui).weak),
    )
    .on_hover_text("Activities that start within the next 14 days.");
    ui.add_space(8.0);
    ui.label(format!("active now: {}", calendar.active_at(time)))
        .on_hover_text("Activities that have started and not yet ended at the shown date.");
}

fn axis(ui: &mut Ui, calendar: &Calendar, state: &AppState, commands: &mut Vec<Command>) {
    let size = egui::vec2(ui.available_width(), STRIP + AXIS);
    let (place, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let strip = Rect::from_min_size(place.min, egui::vec2(place.width(), STRIP));
    let now = state.time();
    let share = calendar.share(now);
    response.widget_info(|| {
        egui::WidgetInfo::slider(true, share * 100.0, format!("Timeline, {}", short_date(now)))
    });

    let colors = palette(ui);
    let painter = ui.painter_at(place.expand(1.0));
    painter.rect_filled(strip, 4.0, colors.well);
    let past = Rect::from_min_max(strip.min, egui::pos2(at(strip, share), strip.max.y));
    painter.rect_filled(past, 4.0, colors.accent.gamma_multiply(0.10));
    density(&painter, strip, calendar, share, colors.bars, colors.accent);
    ticks(&painter, place, strip, calendar, colors.weak, colors.line);

    let x = at(strip, share);
    painter.vline(x, strip.y_range(), Stroke::new(2.0, colors.cursor));
    painter.circle_filled(egui::pos2(x, strip.min.y + 4.0), 4.0, colors.cursor);

    // The end of a drag counts too: a quick one may begin and end within one slow frame.
    let moved = response.is_pointer_button_down_on()
        || response.dragged()
        || response.drag_stopped()
        || response.clicked();
    if let (Some(pointer), true) = (response.interact_pointer_pos(), moved) {
        commands.push(Command::JumpTo(calendar.at(share_at(strip, pointer.x))));
    }
    hover(&response, &painter, strip, calendar, ui);
}

fn at(strip: Rect, share: f64) -> f32 {
    strip.min.x + strip.width() * share as f32
}

fn share_at(strip: Rect, x: f32) -> f64 {
    f64::from((x - strip.min.x) / strip.width().max(1.0))
}

fn density(
    painter: &egui::Painter,
    strip: Rect,
    calendar: &Calendar,
    share: f64,
    rest: Color32,
    past: Color32,
) {
    let bins = (strip.width() / BAR).floor().max(1.0) as usize;
    let counts = calendar.density(bins);
    let most = counts.iter().copied().max().unwrap_or(0).max(1) as f32;
    let width = strip.width() / bins as f32;
    for (i, count) in counts.into_iter().enumerate().filter(|(_, count)| *count > 0) {
        // The square root keeps quiet weeks visible beside busy ones.
        let height = ((count as f32 / most).sqrt() * (STRIP - 8.0)).max(1.0);
        let x = strip.min.x + i as f32 * width;
        let bar = Rect::from_min_max(
            egui::pos2(x, strip.max.y - height),
            egui::pos2(x + width - 1.0, strip.max.y),
        );
        let before = (i as f64 + 0.5) / (bins as f64) < share;
        painter.rect_filled(bar, 0.0, if before { past.gamma_multiply(0.7) } else { rest });
    }
}

fn ticks(
    painter: &egui::Painter,
    place: Rect,
    strip: Rect,
    calendar: &Calendar,
    text: Color32,
    line: Color32,
) {
    for tick in calendar.ticks((place.width() / LABEL) as usize) {
        let x = at(strip, calendar.share(tick.time));
        let from = if tick.major { strip.min.y } else { strip.max.y };
        painter.vline(x, from..=place.max.y, Stroke::new(1.0, line));
        // A name that would run out of the window is left out.
        if x + LABEL < place.max.x {
            let font = FontId::proportional(SMALL);
            let position = egui::pos2(x + 4.0, place.max.y);
            painter.text(position, Align2::LEFT_BOTTOM, tick.label, font, text);
        }
    }
}

/// The date under the pointer, written into the strip: a tooltip would cover the shown date.
fn hover(response: &Response, painter: &egui::Painter, strip: Rect, calendar: &Calendar, ui: &Ui) {
    let Some(pointer) = response.hover_pos().filter(|_| !response.dragged()) else { return };
    let colors = palette(ui);
    let time = calendar.at(share_at(strip, pointer.x));
    painter.vline(pointer.x, strip.y_range(), Stroke::new(1.0, colors.weak));
    let active = short_count(calendar.active_at(time) as u64);
    let text = format!("{} · {active} active", short_date(time));
    let galley = painter.layout_no_wrap(text, FontId::proportional(SMALL), colors.strong);
    // To the right of the pointer, to its left where there is no room.
    let left = if pointer.x + galley.size().x + 16.0 < strip.max.x {
        pointer.x + 8.0
    } else {
        pointer.x - galley.size().x - 8.0
    };
    let place = Rect::from_min_size(egui::pos2(left, strip.min.y + 4.0), galley.size());
    painter.rect_filled(place.expand(4.0), 4.0, colors.panel.gamma_multiply(0.9));
    painter.galley(place.min, galley, colors.strong);
}
