//! What is selected and hidden, which activities are moved, and taking that back.

use super::super::history::Change;
use super::super::loading::Project;
use super::super::selection::Choose;
use super::super::visibility::{Shown, Visibility};
use super::AppState;
use topout_scene::ElementId;
use topout_schedule::TimeRange;

impl AppState {
    /// Selects elements; the Gantt chart comes to the first activity of the last one.
    pub(super) fn choose(&mut self, how: Choose, elements: Vec<ElementId>) {
        self.selected.choose(how, elements);
        if let (Some(project), Some(last)) = (&self.project, self.selected.last())
            && let Some(&activity) = project.scene.activities_of(last).first()
        {
            self.gantt.reveal(&project.plan, &project.scene.schedule, activity as usize);
        }
    }

    /// Selects the elements of an activity.
    pub(super) fn select_activity(&mut self, activity: usize) {
        let Some(project) = &self.project else { return };
        self.selected.choose_activity(activity, project.plan.elements_of(activity).to_vec());
    }

    /// Selects the elements of all activities below a summary.
    pub(super) fn select_summary(&mut self, summary: u32) {
        let Some(project) = &self.project else { return };
        let elements = project.plan.below(summary).flat_map(|a| project.plan.elements_of(a));
        self.selected.choose(Choose::Only, elements.copied().collect());
    }

    /// Draws everything but the selection in another way.
    pub(super) fn isolate(&mut self, others: Shown) {
        if let Some(project) = &self.project
            && !self.selected.elements().is_empty()
        {
            let count = project.scene.model.elements.len();
            let mut next = self.visibility.clone();
            next.isolate(count, self.selected.elements(), others);
            self.set_visibility(next);
        }
    }

    pub(super) fn set_visibility(&mut self, next: Visibility) {
        if next != self.visibility {
            let before = std::mem::replace(&mut self.visibility, next);
            self.history.push(Change::Visibility(before));
        }
    }

    /// Whether the user wants to see an element at all, and how.
    pub fn shown(&self, element: ElementId) -> Shown {
        let scene = self.project.as_ref().map(|p| &p.scene);
        scene.map_or(Shown::Whole, |scene| self.visibility.of(scene, element))
    }

    /// Moves an activity, and what its links make follow; that can be taken back.
    pub(super) fn move_activity(&mut self, activity: usize, dates: TimeRange) {
        let Some(project) = &self.project else { return };
        let moves = project.network.moved(&project.scene.schedule, &[(activity, dates)]);
        let before = dates_of(project, &moves);
        if before.len() == moves.len() {
            self.history.push(Change::Dates(before));
            self.move_activities(moves);
        }
    }

    pub(super) fn step_history(&mut self, back: bool) {
        let (project, visibility) = (self.project.clone(), &self.visibility);
        let section = &self.section;
        let now = |change: &Change| match change {
            Change::Visibility(_) => Change::Visibility(visibility.clone()),
            Change::Section(_) => Change::Section(section.clone()),
            Change::Dates(moves) => {
                let dates = project.as_ref().map(|project| dates_of(project, moves));
                Change::Dates(dates.unwrap_or_default())
            }
        };
        match self.history.step(back, now) {
            None => {}
            Some(Change::Visibility(visibility)) => self.visibility = visibility,
            Some(Change::Section(section)) => self.section = section,
            Some(Change::Dates(moves)) => self.move_activities(moves),
        }
    }
}

/// The dates that the activities of `moves` have now.
fn dates_of(project: &Project, moves: &[(usize, TimeRange)]) -> Vec<(usize, TimeRange)> {
    moves.iter().filter_map(|&(i, _)| Some((i, project.plan.span(i)?))).collect()
}
