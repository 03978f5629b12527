//! The model tree: elements by storey, type, layer or activity.

use super::command::{Command, Panel};
use super::loading::Project;
use super::selection::Choose;
use super::state::AppState;
use super::theme::{SMALL, fold_sign, palette};
use super::visibility::Shown;
use crate::report::grouped;
use egui::{Align, Layout, Rect, RichText, ScrollArea, Sense, Stroke, Ui};
use std::collections::BTreeSet;
use std::sync::Arc;
use topout_scene::{Category, ElementId, Scene, check};

/// Height of a row, points.
const ROW: f32 = 20.0;

/// What the elements are grouped by.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Grouping {
    /// Storeys, from the top to the foot.
    #[default]
    Storey,
    /// Types, the most frequent first.
    Type,
    /// Layers, as properties name them.
    Layer,
    /// Activities in the order of the schedule; an element stands below each of its own.
    Activity,
}

impl Grouping {
    const ALL: [(Self, &'static str); 4] = [
        (Self::Storey, "Storey"),
        (Self::Type, "Type"),
        (Self::Layer, "Layer"),
        (Self::Activity, "Activity"),
    ];
}

/// What the user set.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Browse {
    /// What the elements are grouped by.
    pub by: Grouping,
    /// Part of the name of an element or group, in whatever case.
    pub text: String,
    /// Groups that are unfolded.
    open: BTreeSet<u32>,
}

impl Browse {
    /// Unfolds or folds a group, given by its place.
    pub fn unfold(&mut self, group: u32, open: bool) {
        match open {
            true => self.open.insert(group),
            false => self.open.remove(&group),
        };
    }
}

/// One group.
#[derive(Clone, PartialEq, Debug)]
struct Group {
    name: String,
    elements: Vec<ElementId>,
}

/// A listed row.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Line {
    Group(u32),
    Element(u32, ElementId),
}

/// The tree's rows; worked out when what they follow from has changed.
#[derive(Default)]
pub struct Browser {
    /// What the user set.
    pub wanted: Browse,
    groups: Vec<Group>,
    lines: Vec<Line>,
    grouped: Option<(Arc<Project>, Grouping)>,
    listed: Option<Browse>,
}

impl Browser {
    /// Works the rows out anew where something that they follow from has changed.
    pub fn refresh(&mut self, project: &Arc<Project>) {
        let by = self.wanted.by;
        let same =
            |(known, how): &(Arc<Project>, Grouping)| Arc::ptr_eq(known, project) && *how == by;
        if !self.grouped.as_ref().is_some_and(same) {
            self.groups = groups(project, by);
            let regrouped = self.grouped.as_ref().is_none_or(|(_, how)| *how != by);
            if regrouped && self.listed.is_some() {
                self.wanted.open.clear();
            }
            self.grouped = Some((Arc::clone(project), by));
            self.listed = None;
        }
        if self.listed.as_ref() != Some(&self.wanted) {
            self.lines = lines(&self.groups, &project.scene, &self.wanted);
            self.listed = Some(self.wanted.clone());
        }
    }
}

/// What people call an element.
pub fn name_of(scene: &Scene, id: ElementId) -> &str {
    match check::name_of(&scene.model.elements[id.index()]) {
        "" => "unnamed element",
        name => name,
    }
}

fn groups(project: &Project, by: Grouping) -> Vec<Group> {
    let scene = &project.scene;
    let category = |category: Category, without: &str| {
        let mut groups: Vec<Group> = category
            .groups(scene)
            .into_iter()
            .map(|(name, elements)| {
                let name = if name.is_empty() { without } else { name };
                Group { name: name.to_owned(), elements }
            })
            .collect();
        if category == Category::Storey {
            groups.reverse();
        }
        groups
    };
    match by {
        Grouping::Storey => category(Category::Storey, "no storey"),
        Grouping::Type => category(Category::Type, "no type"),
        Grouping::Layer => category(Category::Layer, "no layer"),
        Grouping::Activity => {
            let activities = scene.schedule.activities.iter().enumerate();
            let mut groups: Vec<Group> = activities
                .map(|(i, activity)| Group {
                    name: match activity.name.is_empty() {
                        true => activity.id.clone(),
                        false => format!("{}  {}", activity.id, activity.name),
                    },
                    elements: project.plan.elements_of(i).to_vec(),
                })
                .filter(|group| !group.elements.is_empty())
                .collect();
            let all = (0..scene.model.elements.len() as u32).map(ElementId);
            let loose: Vec<ElementId> =
                all.filter(|id| scene.activities_of(*id).is_empty()).collect();
            if !loose.is_empty() {
                groups.push(Group { name: "not scheduled".to_owned(), elements: loose });
            }
            groups
        }
    }
}

fn lines(groups: &[Group], scene: &Scene, wanted: &Browse) -> Vec<Line> {
    let text = wanted.text.trim().to_lowercase();
    let mut lines = Vec::new();
    for (place, group) in (0u32..).zip(groups) {
        let element = |id: &ElementId| Line::Element(place, *id);
        let open = wanted.open.contains(&place);
        if text.is_empty() || group.name.to_lowercase().contains(&text) {
            lines.push(Line::Group(place));
            if open {
                lines.extend(group.elements.iter().map(element));
            }
            continue;
        }
        let said = |id: &&ElementId| {
            let element = &scene.model.elements[id.index()];
            let guid = element.guid.as_deref().unwrap_or_default();
            [&element.label, &element.name, guid].iter().any(|t| t.to_lowercase().contains(&text))
        };
        let mut found = group.elements.iter().filter(said).peekable();
        if found.peek().is_some() {
            // What was searched for is shown, folded or not.
            lines.push(Line::Group(place));
            lines.extend(found.map(element));
        }
    }
    lines
}

/// Draws the panel and collects what is asked for.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(project) = &state.project else { return };
    let browser = &state.browser;
    let mut wanted = browser.wanted.clone();
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for (by, name) in Grouping::ALL {
            ui.selectable_value(&mut wanted.by, by, name)
                .on_hover_text(format!("Group elements by {}", name.to_lowercase()));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.button("×").accessible_name("Close the model tree").clicked() {
                commands.push(Command::Toggle(Panel::Tree));
            }
        });
    });
    let field = egui::TextEdit::singleline(&mut wanted.text)
        .hint_text("Search elements")
        .desired_width(f32::INFINITY);
    ui.add(field).accessible_name("Search elements");
    ui.add_space(4.0);
    ui.spacing_mut().item_spacing.y = 0.0;
    ScrollArea::both().auto_shrink(false).show_rows(ui, ROW, browser.lines.len(), |ui, rows| {
        for line in &browser.lines[rows] {
            match *line {
                Line::Group(place) => {
                    let group = &browser.groups[place as usize];
                    group_row(ui, state, group, place, &mut wanted, commands);
                }
                Line::Element(_, id) => element_row(ui, state, project, id, commands),
            }
        }
    });
    if wanted != browser.wanted {
        commands.push(Command::Browse(Box::new(wanted)));
    }
}

fn group_row(
    ui: &mut Ui,
    state: &AppState,
    group: &Group,
    place: u32,
    wanted: &mut Browse,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let open = wanted.open.contains(&place);
        let (fold, response) = ui.allocate_exact_size(egui::vec2(14.0, ROW), Sense::click());
        let name = format!("{} {}", if open { "Fold" } else { "Unfold" }, group.name);
        let response = response.accessible_name(name);
        fold_sign(ui, &response, fold.center(), !open);
        if response.clicked() {
            wanted.unfold(place, !open);
        }
        let shown = |id: &ElementId| state.visibility.named(*id);
        let all_hidden = group.elements.iter().all(|id| shown(id) == Shown::Hidden);
        if eye(ui, all_hidden, &group.name) {
            let to = if all_hidden { Shown::Whole } else { Shown::Hidden };
            commands.push(Command::Draw(to, group.elements.clone()));
        }
        let label = ui.selectable_label(false, &group.name);
        if label.on_hover_text("Select all of it; Ctrl toggles, Shift adds").clicked() {
            let how = Choose::by(ui.input(|i| i.modifiers));
            commands.push(Command::Choose(how, group.elements.clone()));
        }
        let count = grouped(group.elements.len() as u64);
        ui.label(RichText::new(count).size(SMALL).color(palette(ui).weak));
    });
}

fn element_row(
    ui: &mut Ui,
    state: &AppState,
    project: &Project,
    id: ElementId,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.add_space(28.0);
        let name = name_of(&project.scene, id);
        let hidden = state.visibility.named(id) == Shown::Hidden;
        if eye(ui, hidden, name) {
            let to = if hidden { Shown::Whole } else { Shown::Hidden };
            commands.push(Command::Draw(to, vec![id]));
        }
        let there = project.scene.behaviour(id).at(state.time());
        let text = RichText::new(name);
        let text = if there && !hidden { text } else { text.color(palette(ui).weak) };
        let label = ui.selectable_label(state.selected.contains(id), text);
        if label.double_clicked() {
            commands.push(Command::Choose(Choose::Only, vec![id]));
            commands.push(Command::FitSelection);
        } else if label.clicked() {
            let how = Choose::by(ui.input(|i| i.modifiers));
            commands.push(Command::Choose(how, vec![id]));
        }
    });
}

/// An eye, open or closed; whether it was clicked.
fn eye(ui: &mut Ui, hidden: bool, name: &str) -> bool {
    let (place, response) = ui.allocate_exact_size(egui::vec2(16.0, ROW), Sense::click());
    let word = if hidden { "Show" } else { "Hide" };
    let response = response.accessible_name(format!("{word} {name}"));
    let colors = palette(ui);
    let color = match (response.hovered(), hidden) {
        (true, _) => colors.strong,
        (false, true) => colors.line,
        (false, false) => colors.weak,
    };
    let eye = Rect::from_center_size(place.center(), egui::vec2(12.0, 7.0));
    let painter = ui.painter();
    let lid = |height: f32| {
        let bow = [
            eye.left_center(),
            eye.center() + egui::vec2(-3.0, height),
            eye.center() + egui::vec2(3.0, height),
            eye.right_center(),
        ];
        egui::epaint::CubicBezierShape::from_points_stroke(
            bow,
            false,
            egui::Color32::TRANSPARENT,
            Stroke::new(1.2, color),
        )
    };
    painter.add(lid(5.0));
    if !hidden {
        painter.add(lid(-5.0));
        painter.circle_filled(eye.center(), 1.8, color);
    }
    response.clicked()
}

#[cfg(test)]
mod tests {
    use super::*;
    use topout_scene::{Element, Model, link};
    use topout_schedule::{Activity, Schedule};

    fn project() -> Arc<Project> {
        let element = |(name, storey): (&str, &str)| Element {
            name: name.to_owned(),
            storey: storey.to_owned(),
            ..Element::default()
        };
        let elements = [("Door 1", "Ground"), ("Wall", "Ground"), ("door 2", "First")];
        let activity = Activity {
            id: "A".to_owned(),
            elements: vec!["Wall".to_owned()],
            ..Activity::default()
        };
        let schedule = Schedule::new(String::new(), None, vec![activity], Default::default());
        let model = Model { elements: elements.map(element).to_vec(), ..Model::default() };
        let scene = Arc::new(link::link(model, schedule));
        Arc::new(Project::new(crate::project::Request::demo(), scene))
    }

    fn listed(browser: &mut Browser, project: &Arc<Project>) -> Vec<String> {
        browser.refresh(project);
        let name = |line: &Line| match *line {
            Line::Group(place) => browser.groups[place as usize].name.clone(),
            Line::Element(_, id) => format!("- {}", name_of(&project.scene, id)),
        };
        browser.lines.iter().map(name).collect()
    }

    #[test]
    fn groups_unfold_and_are_searched() {
        let project = project();
        let mut browser = Browser::default();
        let mut groups = listed(&mut browser, &project);
        groups.sort();
        assert_eq!(groups, ["First", "Ground"]);
        let ground = browser.groups.iter().position(|g| g.name == "Ground");
        browser.wanted.unfold(ground.map_or(99, |g| g as u32), true);
        assert_eq!(listed(&mut browser, &project).len(), 4);
        browser.wanted.text = "DOOR".to_owned();
        let found = listed(&mut browser, &project);
        assert!(found.contains(&"- Door 1".to_owned()) && found.contains(&"- door 2".to_owned()));
        assert_eq!(found.len(), 4, "both storeys, without the wall: {found:?}");
        browser.wanted = Browse { by: Grouping::Activity, ..Browse::default() };
        assert_eq!(listed(&mut browser, &project), ["A", "not scheduled"]);
    }
}
