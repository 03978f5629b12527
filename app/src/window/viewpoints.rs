//! Views that are kept by name, and the way back through those that were seen.

use super::calendar::short_date;
use super::camera::Camera;
use super::command::{Command, Panel, keys_of};
use super::section::Section;
use super::shown::ElementColors;
use super::state::AppState;
use super::theme::{SMALL, palette};
use super::visibility::Visibility;
use egui::{RichText, ScrollArea, Ui};
use topout_schedule::Time;

/// Cameras that are remembered.
const KEPT: usize = 100;

/// What one sees, under a name.
#[derive(Clone, PartialEq, Debug)]
pub struct Viewpoint {
    /// What the user calls it.
    pub name: String,
    /// Where one looks from.
    pub camera: Camera,
    /// The date.
    pub time: Time,
    /// What is hidden.
    pub visibility: Visibility,
    /// Which colours elements have.
    pub colors: ElementColors,
    /// What is cut away.
    pub section: Section,
}

/// Cameras that were left, and those that were gone back from.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Trail {
    back: Vec<Camera>,
    forward: Vec<Camera>,
}

impl Trail {
    /// Remembers a camera that is about to be left.
    pub fn leave(&mut self, camera: Camera) {
        if self.back.last() == Some(&camera) {
            return;
        }
        self.forward.clear();
        if self.back.len() == KEPT {
            self.back.remove(0);
        }
        self.back.push(camera);
    }

    /// The camera before `now`, or after it.
    pub fn step(&mut self, back: bool, now: Camera) -> Option<Camera> {
        let (from, to) = match back {
            true => (&mut self.back, &mut self.forward),
            false => (&mut self.forward, &mut self.back),
        };
        // Where nothing was moved since, that camera is no step.
        let next = std::iter::from_fn(|| from.pop()).find(|camera| *camera != now)?;
        to.push(now);
        Some(next)
    }

    /// Whether there is a camera before and one after.
    pub fn reach(&self) -> (bool, bool) {
        (!self.back.is_empty(), !self.forward.is_empty())
    }
}

/// Draws the list while it is open, and collects what is asked for.
pub fn show(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let mut open = state.panels.viewpoints;
    if !open || state.project.is_none() {
        return;
    }
    egui::Window::new("Viewpoints")
        .open(&mut open)
        .default_size([320.0, 240.0])
        .collapsible(false)
        .default_pos([24.0, 140.0])
        .show(ctx, |ui| {
            let save = Command::SaveViewpoint;
            let button = ui.button("Save this view");
            let tip =
                format!("Camera, date, colours, what is hidden and cut away ({})", keys_of(&save));
            if button.on_hover_text(tip).clicked() {
                commands.push(save);
            }
            if state.viewpoints.is_empty() {
                ui.label(RichText::new("No view is saved yet.").color(palette(ui).weak));
            }
            ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
                for (i, viewpoint) in state.viewpoints.iter().enumerate() {
                    ui.horizontal(|ui| row(ui, i, viewpoint, commands));
                }
            });
        });
    if !open {
        commands.push(Command::Toggle(Panel::Viewpoints));
    }
}

fn row(ui: &mut Ui, i: usize, viewpoint: &Viewpoint, commands: &mut Vec<Command>) {
    let go = ui.button("Go").accessible_name(format!("Go to {}", viewpoint.name));
    if go.on_hover_text("Look from there, at that date").clicked() {
        commands.push(Command::ShowViewpoint(i));
    }
    let mut name = viewpoint.name.clone();
    let field = egui::TextEdit::singleline(&mut name).desired_width(140.0);
    if ui.add(field).accessible_name(format!("Name of view {}", i + 1)).changed() {
        commands.push(Command::RenameViewpoint(i, name));
    }
    let date = RichText::new(short_date(viewpoint.time)).size(SMALL).color(palette(ui).weak);
    ui.label(date);
    let delete = ui.small_button("×").accessible_name(format!("Delete {}", viewpoint.name));
    if delete.clicked() {
        commands.push(Command::DeleteViewpoint(i));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{UVec2, Vec3};
    use topout_scene::{Aabb, NamedView};

    #[test]
    fn one_goes_back_and_forth_between_views() {
        let focus = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let size = UVec2::new(640, 480);
        let view = |named| Camera::fit_named(&focus, named, size);
        let [a, b, c] = [NamedView::Front, NamedView::Left, NamedView::Top].map(view);
        let mut trail = Trail::default();
        trail.leave(a);
        trail.leave(b);
        assert_eq!(trail.step(true, c), Some(b));
        assert_eq!(trail.step(true, b), Some(a));
        assert_eq!(trail.step(true, a), None);
        assert_eq!(trail.step(false, a), Some(b));
        trail.leave(b);
        assert_eq!(trail.step(false, c), None, "another way was taken");
        assert_eq!(trail.step(true, b), Some(a), "a view that was not left is no step");
    }
}
