//! What can be done first, over the picture of the first start.

use super::command::{Command, Panel, keys_of};
use super::navigation::{Drag, Mouse};
use super::state::AppState;
use super::theme::{SMALL, palette};
use egui::{Modifiers, PointerButton, RichText, Ui};

/// Width of the card, points.
const WIDTH: f32 = 300.0;

/// Whether the card is shown, and whether it was before.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Hint {
    /// It is shown now.
    pub open: bool,
    /// It was closed once, so it does not come by itself any more.
    pub seen: bool,
}

impl Hint {
    /// Shown again.
    pub fn show(&mut self) {
        self.open = true;
    }

    /// Closed for good.
    pub fn close(&mut self) {
        *self = Self { open: false, seen: true };
    }

    /// Whoever does what the card says does not need it.
    pub fn heed(&mut self, command: &Command) {
        let done = matches!(
            command,
            Command::MoveCamera(_)
                | Command::TogglePlay
                | Command::PlayForward
                | Command::PlayBackward
                | Command::Choose(..)
                | Command::Toggle(Panel::Palette | Panel::Shortcuts)
                // Escape.
                | Command::ClearSelection
        );
        if self.open && done {
            self.close();
        }
    }
}

/// How one turns about the scene, with the mouse as it is set.
fn turning(mouse: Mouse) -> String {
    let buttons = [
        (PointerButton::Primary, "Drag"),
        (PointerButton::Middle, "Drag with the middle button"),
        (PointerButton::Secondary, "Drag with the right button"),
    ];
    let held = [(Modifiers::NONE, ""), (Modifiers::SHIFT, "Shift: ")];
    let ways = held.into_iter().flat_map(|held| buttons.map(|button| (held, button)));
    let mut ways =
        ways.filter(|((held, _), (button, _))| mouse.drag(*button, *held) == Drag::Orbit);
    ways.next().map_or_else(String::new, |((_, held), (_, name))| format!("{held}{name}"))
}

/// What the card says: what to do, and what happens.
pub fn lines(mouse: Mouse) -> [(String, &'static str); 6] {
    [
        (turning(mouse), "turns about what is under the pointer"),
        ("Wheel".to_owned(), "comes nearer"),
        (keys_of(&Command::TogglePlay), "plays the construction"),
        ("Click".to_owned(), "tells what is known of an element"),
        (keys_of(&Command::Toggle(Panel::Palette)), "finds any command by its name"),
        (keys_of(&Command::Toggle(Panel::Shortcuts)), "lists all keys"),
    ]
}

/// The card.
pub fn card(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let text = |text: &str| RichText::new(text).size(SMALL);
    ui.set_max_width(WIDTH);
    ui.spacing_mut().interact_size.y = 14.0;
    ui.horizontal(|ui| {
        ui.label(RichText::new("First steps").strong());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let close = ui.button(text("Got it")).accessible_name("Close first steps");
            if close
                .on_hover_text("Help > First steps shows this again (Escape closes it)")
                .clicked()
            {
                commands.push(Command::CloseHint);
            }
        });
    });
    egui::Grid::new("first steps").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        for (what, does) in lines(state.mouse) {
            ui.label(text(&what).strong());
            ui.label(text(does).color(palette(ui).weak));
            ui.end_row();
        }
    });
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::window::Choose;

    #[test]
    fn what_it_says_closes_it_and_nothing_else() {
        let mut hint = Hint::default();
        hint.show();
        for command in [Command::ToEnd, Command::Toggle(Panel::Tree), Command::Undo] {
            hint.heed(&command);
            assert!(hint.open, "{command:?}");
        }
        let used = [
            Command::TogglePlay,
            Command::Choose(Choose::Only, Vec::new()),
            Command::Toggle(Panel::Palette),
            Command::Toggle(Panel::Shortcuts),
            Command::ClearSelection,
        ];
        for command in used {
            let mut hint = Hint { open: true, seen: false };
            hint.heed(&command);
            assert_eq!(hint, Hint { open: false, seen: true }, "{command:?}");
        }
        let mut never = Hint::default();
        never.heed(&Command::TogglePlay);
        assert!(!never.seen, "what was not shown was not seen");
    }

    #[test]
    fn it_knows_the_mouse_and_the_keys() {
        let first = |mouse| lines(mouse)[0].0.clone();
        assert_eq!(first(Mouse::Topout), "Drag");
        assert_eq!(first(Mouse::Navisworks), "Shift: Drag with the middle button");
        assert_eq!(first(Mouse::Blender), "Drag with the middle button");
        assert_eq!(first(Mouse::Cad), "Drag with the right button");
        let said: Vec<String> = lines(Mouse::Topout).into_iter().map(|(what, _)| what).collect();
        assert_eq!(said[2..], ["Space", "Click", "Ctrl+P", "F1"]);
    }
}
