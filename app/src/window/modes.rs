//! What is going on in the 3D view beside looking: measuring, comparing, storeys apart, a section.

use super::command::{Command, Panel, keys_of};
use super::explode::FARTHEST;
use super::measure::words;
use super::state::AppState;
use super::theme::{SMALL, palette};
use egui::{DragValue, RichText, Ui};

/// Distances that are listed.
const LISTED: usize = 4;

/// Whether any of it is.
pub(super) fn any(state: &AppState) -> bool {
    state.measure.on
        || !state.measure.taken.is_empty()
        || state.compared.is_some()
        || state.explosion.wanted() > 0.0
        || state.section.on
}

/// A line for each, with what ends it.
pub(super) fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    if state.section.on {
        ui.horizontal(|ui| {
            ui.label(RichText::new(format!("Section: {}", state.section.summary())).size(SMALL));
            button(ui, "Edit", "Edit the section", Command::Toggle(Panel::Section), commands);
            button(ui, "Off", "Section off", Command::ToggleSection, commands);
        });
    }
    if let Some([_, other]) = state.names_compared() {
        ui.horizontal(|ui| {
            ui.label(RichText::new(format!("Compared with: {other}")).size(SMALL));
            button(ui, "Stop", "Stop comparing", Command::StopComparing, commands);
        });
    }
    if state.explosion.wanted() > 0.0 {
        ui.horizontal(|ui| {
            let label = ui.label(RichText::new("Storeys apart by").size(SMALL));
            let mut gap = state.explosion.wanted();
            let drag = DragValue::new(&mut gap).range(0.5..=FARTHEST).speed(0.1).suffix(" m");
            if ui.add(drag).labelled_by(label.id).changed() {
                commands.push(Command::Explode(gap));
            }
            button(ui, "Together", "Storeys together", Command::Explode(0.0), commands);
        });
    }
    measure(ui, state, commands);
}

fn measure(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let measure = &state.measure;
    if measure.on {
        let what = if measure.start.is_some() { "the second point" } else { "a point" };
        ui.horizontal(|ui| {
            ui.label(RichText::new(format!("Measure: click {what}")).size(SMALL));
            button(ui, "Done", "Stop measuring", Command::ToggleMeasure, commands);
        });
    }
    if measure.taken.is_empty() {
        return;
    }
    let skipped = measure.taken.len().saturating_sub(LISTED);
    if skipped > 0 {
        let more = format!("{skipped} earlier ones");
        ui.label(RichText::new(more).size(SMALL).color(palette(ui).weak));
    }
    for (i, ends) in measure.taken.iter().enumerate().skip(skipped) {
        ui.label(RichText::new(format!("{}: {}", i + 1, words(*ends))).size(SMALL));
    }
    ui.horizontal(|ui| {
        let all: Vec<String> = measure.taken.iter().map(|ends| words(*ends)).collect();
        button(ui, "Copy", "Copy distances", Command::Copy(all.join("\n")), commands);
        button(ui, "Clear", "Remove distances", Command::ClearMeasures, commands);
    });
}

fn button(ui: &mut Ui, text: &str, name: &str, command: Command, commands: &mut Vec<Command>) {
    let keys = keys_of(&command);
    let tip = if keys.is_empty() { name.to_owned() } else { format!("{name} ({keys})") };
    let button = ui.small_button(text).accessible_name(name);
    if button.on_hover_text(tip).clicked() {
        commands.push(command);
    }
}
