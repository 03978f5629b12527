//! The bottom of the window: transport, date, and the axis that is dragged.

pub mod axis;
mod scale;

pub use scale::Scale;

use super::calendar::Calendar;
use super::clock::{RUNS, Run, SPEEDS, Speed, Step};
use super::command::{Command, keys_of};
use super::state::AppState;
use super::theme::{SMALL, TITLE, palette};
use egui::{Align, Layout, Rect, Response, RichText, Shape, Stroke, Ui};
use topout_schedule::Time;

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
    axis::show(ui, calendar, state, commands);
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
    button(Icon::Back, "Day back", Command::Step(Step::Days(-1)));
    match state.clock.run() {
        Run::Backward => button(Icon::Pause, "Pause playing backward", Command::Pause),
        _ => button(Icon::PlayBack, "Play backward", Command::PlayBackward),
    }
    match state.clock.run() {
        Run::Forward => button(Icon::Pause, "Pause", Command::Pause),
        _ => button(Icon::Play, "Play", Command::PlayForward),
    }
    button(Icon::Stop, "Stop playing", Command::Stop);
    button(Icon::Forward, "Day forward", Command::Step(Step::Days(1)));
    button(Icon::ToEnd, "End of project", Command::ToEnd);
}

#[derive(Clone, Copy)]
enum Icon {
    ToStart,
    Back,
    PlayBack,
    Play,
    Pause,
    Stop,
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
        Icon::PlayBack => triangle(0.0, -1.0, 6.0),
        Icon::Stop => bar(0.0, 9.0, 4.5),
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
    let now = state.clock.speed;
    let text = match state.clock.shuttle() {
        1 => now.text(),
        times => format!("{} × {times}", now.text()),
    };
    egui::ComboBox::from_id_salt("speed")
        .selected_text(text)
        .width(96.0)
        .show_ui(ui, |ui| {
            let mut offer = |ui: &mut Ui, speed: Speed| {
                if ui.selectable_label(speed == now, speed.text()).clicked() {
                    commands.push(Command::SetSpeed(speed));
                }
            };
            SPEEDS.into_iter().for_each(|days| offer(ui, Speed::Days(days)));
            ui.separator();
            RUNS.into_iter().for_each(|seconds| offer(ui, Speed::Whole(seconds)));
        })
        .response
        .accessible_name("Speed")
        .on_hover_text(format!(
            "How fast time runs while playing: days a second, or the whole project in some seconds \
             (slower {}, faster {}; {} and {} again double it)",
            keys_of(&Command::Slower),
            keys_of(&Command::Faster),
            keys_of(&Command::PlayBackward),
            keys_of(&Command::PlayForward),
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
