//! Closing the window: what is asked before, and what counts as not saved.
//!
//! Programs that planners know ask before they close a file with a name that was changed, and show the change
//! in the title. Where one looks from, the date and the colours do not count as changes; they are kept with all
//! else by [`super::recovery`], without a question.

use super::command::Command;
use super::recovery::Recovery;
use super::state::{AppState, Effect};
use super::viewpoints::Viewpoint;
use super::visibility::Visibility;
use crate::project::Request;
use egui::Ui;
use topout_schedule::TimeRange;

/// The shown project as its file has it.
#[derive(Clone, Debug)]
pub struct Kept {
    request: Request,
    viewpoints: Vec<Viewpoint>,
    visibility: Visibility,
    looped: Option<TimeRange>,
    /// [`super::recovery::digest`] of the file.
    pub(super) held: String,
    /// What was recovered goes beyond the file.
    outdated: bool,
}

impl Kept {
    /// The file lacks something from now on, whatever else is equal.
    pub(super) fn outdate(&mut self) {
        self.outdated = true;
    }
}

/// Where the user stands with closing.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Question {
    /// Nobody wants to close.
    #[default]
    None,
    /// The user is asked what becomes of changes.
    Asked,
    /// They answered; the window may close.
    Answered,
}

/// What the user can answer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Close {
    /// Write the project file first.
    Save,
    /// The file stays as it is.
    Discard,
    /// Go on.
    Cancel,
}

/// What closing needs to know.
#[derive(Debug, Default)]
pub struct Closing {
    /// What the project file has; none where there is no file.
    pub(super) kept: Option<Kept>,
    /// Where what is not saved is kept; nowhere if none.
    pub recovery: Option<Recovery>,
    /// What the user is asked.
    pub question: Question,
}

impl AppState {
    /// The shown project is now as its file, which holds what has this digest.
    pub(super) fn hold_as_saved(&mut self, held: String) {
        self.closing.kept = self.project.as_ref().map(|project| Kept {
            request: project.request.clone(),
            viewpoints: self.viewpoints.clone(),
            visibility: self.visibility.clone(),
            looped: self.clock.looped(),
            held,
            outdated: false,
        });
    }

    /// Whether the project has a file that lacks something which somebody made.
    pub fn is_unsaved(&self) -> bool {
        let (Some(kept), Some(project)) = (&self.closing.kept, &self.project) else {
            return false;
        };
        self.project_file.is_some()
            && (kept.outdated
                || kept.request != project.request
                || kept.looped != self.clock.looped()
                || kept.visibility != self.visibility
                || kept.viewpoints != self.viewpoints)
    }

    /// The title of the window: a dot where something is not saved, the project, the program.
    pub fn title(&self) -> String {
        let Some(project) = &self.project else { return "topout".to_owned() };
        let name = match self.project_file.as_ref().and_then(|file| file.file_name()) {
            Some(file) => file.to_string_lossy().into_owned(),
            None => project.name(),
        };
        format!("{}{name} – topout", if self.is_unsaved() { "● " } else { "" })
    }

    /// Whether the window may close now; asks the user where something would be lost.
    pub fn may_close(&mut self) -> bool {
        if self.closing.question != Question::Answered && self.is_unsaved() {
            self.closing.question = Question::Asked;
            return false;
        }
        true
    }

    pub(super) fn answer_close(&mut self, answer: Close) {
        self.closing.question = Question::None;
        match answer {
            Close::Cancel => return,
            Close::Save => {
                self.save_project();
                if self.is_unsaved() {
                    // It could not be written, and the message says why.
                    return;
                }
            }
            Close::Discard => {
                self.forget_recovery();
                // What is not to be kept is not kept for another start either.
                self.closing.recovery = None;
            }
        }
        self.closing.question = Question::Answered;
        self.effects.push(Effect::Close);
    }
}

/// Asks what becomes of changes, in the middle of the window.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    if state.closing.question != Question::Asked {
        return;
    }
    let name = state.project_file.as_ref().map(|file| file.display().to_string());
    let frame = egui::Frame::popup(ui.style()).inner_margin(16);
    let modal = egui::Modal::new(egui::Id::unique("closing")).frame(frame);
    let shown = modal.show(ui.ctx(), |ui| {
        ui.set_width(ui.ctx().content_rect().width().min(420.0) - 40.0);
        ui.heading("Save the changes?");
        ui.add_space(4.0);
        ui.label(format!(
            "Viewpoints, hidden elements, the loop or the files of the project differ from {}.",
            name.unwrap_or_default()
        ));
        ui.add_space(8.0);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            for (text, answer) in
                [("Save", Close::Save), ("Discard", Close::Discard), ("Cancel", Close::Cancel)]
            {
                let button = egui::Button::new(text).min_size(egui::vec2(80.0, 24.0));
                let button = ui.add(button).accessible_name(format!("{text} changes"));
                if answer == Close::Save && ui.memory(|m| m.focused().is_none()) {
                    button.request_focus();
                }
                if button.clicked() {
                    commands.push(Command::AnswerClose(answer));
                }
            }
        });
    });
    if shown.should_close() {
        commands.push(Command::AnswerClose(Close::Cancel));
    }
}
