//! Where the light comes from: a fixed sun, or that of the site at the instant shown.

use super::command::{Command, Panel};
use super::state::AppState;
use super::theme::{SMALL, palette};
use egui::{Align2, DragValue, Rect, RichText, Ui, vec2};
use topout_render::Sun;

/// Where a site is unless its place is given, degrees: Greenwich.
const PLACE: (f32, f32) = (51.5, 0.0);

/// The window with the choice.
pub fn show(ctx: &egui::Context, state: &AppState, place: Rect, commands: &mut Vec<Command>) {
    let mut open = state.panels.sun && state.project.is_some();
    if !open {
        return;
    }
    egui::Window::new("Sun")
        .open(&mut open)
        .resizable(false)
        .collapsible(false)
        .pivot(Align2::RIGHT_TOP)
        // Below the standard views.
        .default_pos(place.right_top() + vec2(-12.0, 52.0))
        .show(ctx, |ui| content(ui, state, commands));
    if !open {
        commands.push(Command::Toggle(Panel::Sun));
    }
}

fn content(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut sun = state.sun;
    let fixed = ui.radio_value(&mut sun, Sun::Fixed, "Fixed");
    fixed.on_hover_text("The same light at every date: each side of a building has its own tone.");
    let is_placed = matches!(sun, Sun::Place { .. });
    let placed = ui.radio(is_placed, "By date and hour");
    if placed.on_hover_text("As the sun stands at the site at the instant that is shown.").clicked()
    {
        sun = Sun::Place { latitude_deg: PLACE.0, longitude_deg: PLACE.1 };
    }
    if let Sun::Place { latitude_deg, longitude_deg } = &mut sun {
        degrees(ui, "Latitude", "north", latitude_deg, 90.0);
        degrees(ui, "Longitude", "east", longitude_deg, 180.0);
        let note = "The model's -Z is taken as north and the clock as that of the\nnearest full 15 degrees, without summer time.";
        ui.label(RichText::new(note).size(SMALL).color(palette(ui).weak));
    }
    if sun != state.sun {
        commands.push(Command::SetSun(sun));
    }
}

fn degrees(ui: &mut Ui, name: &str, toward: &str, value: &mut f32, most: f32) {
    ui.horizontal(|ui| {
        let label = ui.label(name);
        let drag = DragValue::new(value).range(-most..=most).speed(0.1).max_decimals(2);
        let suffix = format!("° {toward}");
        ui.add(drag.suffix(suffix)).labelled_by(label.id);
    });
}
