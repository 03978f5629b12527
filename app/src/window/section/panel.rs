//! The window in which a section is set by numbers.

use super::{Section, SectionBox, SectionPlane};
use crate::window::command::{Command, Panel, keys_of};
use crate::window::state::AppState;
use crate::window::theme::{SMALL, palette};
use egui::{Button, DragValue, RichText, Ui};
use glam::{DVec3, Vec3};
use topout_scene::storeys;

/// Draws the window while it is open, and collects what is asked for.
pub fn show(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let Some(project) = &state.project else { return };
    let mut open = state.panels.section;
    if !open {
        return;
    }
    egui::Window::new("Section")
        .open(&mut open)
        .resizable(false)
        .collapsible(false)
        .default_pos([24.0, 220.0])
        .show(ctx, |ui| {
            let origin = project.scene.model.origin;
            let mut next = state.section.clone();
            ui.horizontal(|ui| {
                let toggle = Command::ToggleSection;
                if ui.checkbox(&mut next.on, "Cut").changed() {
                    commands.push(toggle.clone());
                    next.on = state.section.on;
                }
                ui.label(RichText::new(keys_of(&toggle)).size(SMALL).color(palette(ui).weak));
            });
            ui.separator();
            ui.horizontal(|ui| {
                ui.strong("Box");
                for (name, tip, around) in [
                    ("Around all", "A box around everything", false),
                    ("Around selection", "A box around the selected elements", true),
                ] {
                    let enabled = !around || !state.selected.elements().is_empty();
                    if ui.add_enabled(enabled, Button::new(name)).on_hover_text(tip).clicked() {
                        commands.push(Command::SectionBox(around));
                    }
                }
                let remove = ui.add_enabled(next.boxed.is_some(), Button::new("Remove"));
                if remove.accessible_name("Remove the box").clicked() {
                    next.boxed = None;
                }
            });
            if let Some(boxed) = &mut next.boxed {
                box_rows(ui, boxed, origin);
                storey_row(ui, boxed, state);
            }
            ui.separator();
            ui.horizontal(|ui| {
                ui.strong("Planes");
                for (name, outward) in [("X", Vec3::X), ("Level", Vec3::Y), ("Z", Vec3::Z)] {
                    let button = ui.button(format!("+ {name}"));
                    let button = button.accessible_name(format!("Add a section plane: {name}"));
                    let tip = "A plane through the middle of the model. Right-click a face for one along it.";
                    if button.on_hover_text(tip).clicked() {
                        next = next.with_plane(project.focus.center(), outward);
                    }
                }
            });
            let mut gone = None;
            for (i, plane) in next.planes.iter_mut().enumerate() {
                ui.horizontal(|ui| {
                    if plane_row(ui, i, plane, origin) {
                        gone = Some(i);
                    }
                });
            }
            if let Some(i) = gone {
                next.planes.remove(i);
            }
            if next != state.section {
                commands.push(Command::SetSection(Box::new(next)));
            }
        });
    if !open {
        commands.push(Command::Toggle(Panel::Section));
    }
}

fn metres(ui: &mut Ui, name: &str, value: f64) -> f64 {
    let mut shown = value;
    ui.horizontal(|ui| {
        let label = ui.label(name);
        let drag = DragValue::new(&mut shown).speed(0.05).fixed_decimals(2).suffix(" m");
        ui.add(drag).labelled_by(label.id);
    });
    shown
}

fn box_rows(ui: &mut Ui, boxed: &mut SectionBox, origin: DVec3) {
    let before = *boxed;
    let height = |y: f32| f64::from(y) + origin.y;
    let (foot, top) = (boxed.center.y - boxed.half.y, boxed.center.y + boxed.half.y);
    egui::Grid::new("section box").num_columns(2).show(ui, |ui| {
        let new_foot = metres(ui, "Foot", height(foot));
        let new_top = metres(ui, "Top", height(top));
        ui.end_row();
        let x = metres(ui, "Middle X", f64::from(boxed.center.x) + origin.x);
        let z = metres(ui, "Middle Z", f64::from(boxed.center.z) + origin.z);
        ui.end_row();
        let width = metres(ui, "Width", f64::from(boxed.half.x) * 2.0);
        let depth = metres(ui, "Depth", f64::from(boxed.half.z) * 2.0);
        ui.end_row();
        ui.horizontal(|ui| {
            let label = ui.label("Turn");
            ui.add(
                DragValue::from_get_set(|set| {
                    if let Some(degrees) = set {
                        boxed.turn = (degrees as f32).rem_euclid(360.0).to_radians();
                    }
                    f64::from(boxed.turn.to_degrees())
                })
                .speed(0.5)
                .fixed_decimals(1)
                .suffix("°"),
            )
            .labelled_by(label.id);
        });
        ui.end_row();
        // Only what was changed: reading a value back must not move the box by a rounding.
        if new_foot != height(foot) {
            *boxed = boxed.with_side_moved(3, (height(foot) - new_foot) as f32);
        }
        if new_top != height(top) {
            *boxed = boxed.with_side_moved(2, (new_top - height(top)) as f32);
        }
        boxed.center.x = (x - origin.x) as f32;
        boxed.center.z = (z - origin.z) as f32;
        boxed.half.x = (width * 0.5) as f32;
        boxed.half.z = (depth * 0.5) as f32;
    });
    if !boxed.is_sound() {
        *boxed = before;
    }
}

/// Opens one storey.
fn storey_row(ui: &mut Ui, boxed: &mut SectionBox, state: &AppState) {
    let Some(project) = &state.project else { return };
    egui::ComboBox::from_label("Storey").selected_text("Choose…").height(320.0).show_ui(ui, |ui| {
        // Only worked out while the list is open.
        let storeys = storeys(&project.scene.model);
        if storeys.is_empty() {
            ui.label("The model names no storeys");
        }
        for (i, storey) in storeys.iter().enumerate() {
            if ui.button(&storey.name).clicked() {
                let above = storeys.get(i + 1).map(|next| next.foot);
                let next = above.unwrap_or(project.focus.max.y).max(storey.foot + 2.0);
                *boxed = boxed.on_storey(storey.foot, next);
            }
        }
    });
}

/// Whether the plane is to go.
fn plane_row(ui: &mut Ui, i: usize, plane: &mut SectionPlane, origin: DVec3) -> bool {
    let name = [(Vec3::X, "X"), (Vec3::Y, "Level"), (Vec3::Z, "Z")]
        .iter()
        .find(|(axis, _)| axis.dot(plane.outward).abs() > 0.9999)
        .map_or("Free", |(_, name)| *name);
    let label = ui.label(format!("{} {name}", i + 1));
    // The place along an axis is what one reads in drawings.
    let axis = if name == "Free" { plane.outward } else { plane.outward.abs() };
    let place = axis.as_dvec3().dot(plane.at.as_dvec3() + origin);
    let mut shown = place;
    let drag = DragValue::new(&mut shown).speed(0.05).fixed_decimals(2).suffix(" m");
    ui.add(drag).labelled_by(label.id);
    if shown != place {
        let moved = SectionPlane { at: plane.at + axis * (shown - place) as f32, ..*plane };
        if moved.is_sound() {
            *plane = moved;
        }
    }
    let flip = ui.button("Flip").accessible_name(format!("Flip section plane {}", i + 1));
    if flip.on_hover_text("Show the other side").clicked() {
        plane.outward = -plane.outward;
    }
    ui.small_button("×").accessible_name(format!("Remove section plane {}", i + 1)).clicked()
}

impl Section {
    /// In a few words, for the corner of the view.
    pub fn summary(&self) -> String {
        let planes = match self.planes.len() {
            0 => String::new(),
            1 => "1 plane".to_owned(),
            n => format!("{n} planes"),
        };
        match (self.boxed.is_some(), planes.is_empty()) {
            (true, true) => "box".to_owned(),
            (true, false) => format!("box, {planes}"),
            (false, _) => planes,
        }
    }
}
