//! The bar at the top with its menus, the list of findings and the list of shortcuts.

use super::command::{Action, Command, Panel, actions, keys_of};
use super::overlay::short_count;
use super::shown::ElementColors;
use super::state::{AppState, TOLERANCE};
use super::theme::{SMALL, palette};
use egui::{Align, Layout, RichText, ScrollArea, Ui};
use topout_render::DrawMode;
use topout_schedule::Severity;

/// Titles of the menus and the names of the actions in them; an empty name draws a line.
const MENUS: [(&str, &[&str]); 6] = [
    (
        "File",
        &[
            "Open model…",
            "Open schedule…",
            "Reload schedule",
            "Open demo project",
            "",
            "Save project",
            "Save project as…",
            "Save schedule as…",
            "",
            "Export…",
            "",
            "Quit",
        ],
    ),
    (
        "View",
        &[
            "Fit all",
            "Fit selection",
            "View before",
            "View after",
            "Save viewpoint",
            "Viewpoints…",
            "",
            "Section",
            "Section box around selection",
            "Section box around all",
            "Remove section",
            "Section…",
            "Storeys apart",
            "Measure",
            "Remove distances",
            "",
            "Parallel projection",
            "Walk",
            "Fly",
            "Mouse: topout",
            "Mouse: Navisworks and Revit",
            "Mouse: Blender",
            "Mouse: CAD",
            "",
            "Front",
            "Back",
            "Left",
            "Right",
            "Top",
            "Iso",
            "",
            "Model tree",
            "Inspector",
            "Timeline",
            "Progress curves",
            "Gantt chart",
            "Frame figures",
            "Frame times",
            "",
            "Color by activity",
            "Color by slip",
            "Color by storey",
            "Color by type",
            "Color by look-ahead",
            "Color by level",
            "",
            "Fade between levels",
            "Sun…",
            "Dark or light",
        ],
    ),
    (
        "Select",
        &[
            "Undo",
            "Redo",
            "",
            "Clear selection",
            "",
            "Hide selection",
            "Ghost selection",
            "Show selection",
            "Isolate selection",
            "Ghost everything else",
            "Show all",
            "",
            "Unscheduled elements: shown",
            "Unscheduled elements: ghosts",
            "Unscheduled elements: hidden",
        ],
    ),
    (
        "Timeline",
        &[
            "Play or pause",
            "Play",
            "Play backward",
            "Pause",
            "Stop",
            "Play faster",
            "Play slower",
            "Skip non-working time",
            "",
            "Hour forward",
            "Hour back",
            "Day forward",
            "Day back",
            "Week forward",
            "Week back",
            "Month forward",
            "Month back",
            "Next event",
            "Previous event",
            "Start of project",
            "End of project",
            "",
            "Loop what the timeline shows",
            "No loop",
            "Fit timeline",
        ],
    ),
    (
        "Tools",
        &[
            "Command palette…",
            "",
            "Draw HDLOD",
            "Draw batched",
            "Draw objects",
            "",
            "Compare with the plan as it is now",
            "Compare with planned dates",
            "Compare with actual dates",
            "Compare with baseline dates",
            "Compare with forecast dates",
            "Compare with another schedule…",
            "Stop comparing",
            "",
            "HDLOD table…",
            "Diagnostics",
        ],
    ),
    ("Help", &["Keyboard shortcuts", "First steps", "", "About topout…"]),
];

/// The bar.
pub fn bar(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let actions = actions();
    egui::MenuBar::new().ui(ui, |ui| {
        for (title, names) in MENUS {
            ui.menu_button(title, |ui| {
                for name in names {
                    if *name == "Export…" {
                        recent(ui, state, commands);
                    }
                    match actions.iter().find(|a| a.name == *name) {
                        Some(action) => entry(ui, state, action, commands),
                        None => {
                            ui.separator();
                        }
                    }
                }
            });
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let palette = Command::Toggle(Panel::Palette);
            let search =
                ui.button(RichText::new(format!("Search  {}", keys_of(&palette))).size(SMALL));
            let search = search.accessible_name("Command palette");
            if search.on_hover_text("Find any command or activity by its name").clicked() {
                commands.push(palette);
            }
            badge(ui, state, commands);
            if state.project.is_some() {
                tolerance(ui, state, commands);
                modes(ui, state, commands);
            }
        });
    });
}

/// Projects that were open before.
fn recent(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.add_enabled_ui(!state.recent.is_empty(), |ui| {
        ui.menu_button("Recent projects", |ui| {
            for project in &state.recent {
                if ui.button(project.name()).clicked() {
                    commands.push(Command::Load(project.request()));
                }
            }
        });
    });
}

fn entry(ui: &mut Ui, state: &AppState, action: &Action, commands: &mut Vec<Command>) {
    let keys = action.shortcut.map(|s| s.text()).unwrap_or_default();
    let button = egui::Button::new(action.name)
        .shortcut_text(RichText::new(keys).size(SMALL))
        .selected(is_on(state, &action.command));
    let enabled = is_enabled(state, &action.command);
    if ui.add_enabled(enabled, button).clicked() {
        commands.push(action.command.clone());
    }
}

/// Whether a command means something now.
pub fn is_enabled(state: &AppState, command: &Command) -> bool {
    let Some(project) = &state.project else { return !needs_project(command) };
    match command {
        Command::ReloadSchedule => !project.request.schedules.is_empty(),
        Command::ColorBy(ElementColors::Slip) => project.slip_looks.is_some(),
        Command::ToggleSkipIdle => project.scene.schedule.work_calendar().is_some(),
        Command::SetLoop(None) => state.clock.looped().is_some(),
        Command::Undo => state.history.reach().0,
        Command::Redo => state.history.reach().1,
        Command::ViewBack => state.trail.reach().0,
        Command::ViewForward => state.trail.reach().1,
        Command::DrawSelection(_) | Command::Isolate(_) | Command::FitSelection => {
            !state.selected.elements().is_empty()
        }
        Command::ClearSelection => !state.selected.is_empty() || state.measure.on,
        Command::StopComparing => state.compared.is_some() || state.comparing.is_some(),
        Command::SectionBox(true) => !state.selected.elements().is_empty(),
        Command::ClearSection => !state.section.is_empty(),
        Command::ClearMeasures => !state.measure.taken.is_empty(),
        Command::ShowAll => !state.visibility.is_default(),
        _ => true,
    }
}

/// Whether a menu entry shows a state that holds now.
fn is_on(state: &AppState, command: &Command) -> bool {
    match command {
        Command::SetMode(mode) => state.mode == *mode,
        Command::ColorBy(ElementColors::LookAhead(_)) => {
            matches!(state.colors, ElementColors::LookAhead(_))
        }
        Command::ColorBy(colors) => state.colors == *colors,
        Command::DrawUnscheduled(shown) => state.visibility.unscheduled == *shown,
        Command::ToggleSkipIdle => state.clock.skip_idle,
        Command::ToggleParallel => state.camera.parallel,
        Command::Navigate(navigation) => state.navigation == *navigation,
        Command::SetMouse(mouse) => state.mouse == *mouse,
        Command::ToggleSection => state.section.on,
        Command::ToggleMeasure => state.measure.on,
        Command::ToggleExplosion => state.explosion.wanted() > 0.0,
        Command::Toggle(Panel::Section) => state.panels.section,
        Command::Toggle(Panel::Viewpoints) => state.panels.viewpoints,
        Command::Toggle(Panel::Export) => state.panels.export,
        Command::ToggleLevelColors => state.level_colors,
        Command::ToggleFade => state.fade,
        Command::Toggle(Panel::Gantt) => state.panels.gantt,
        Command::Toggle(Panel::Tree) => state.panels.tree,
        Command::Toggle(Panel::Curves) => state.panels.curves,
        Command::Toggle(Panel::Inspector) => state.panels.inspector,
        Command::Toggle(Panel::Timeline) => state.panels.timeline,
        Command::Toggle(Panel::Figures) => state.panels.figures,
        Command::Toggle(Panel::Graph) => state.panels.graph,
        Command::Toggle(Panel::Sun) => state.panels.sun,
        Command::Toggle(Panel::Diagnostics) => state.panels.diagnostics,
        Command::Toggle(Panel::Table) => state.panels.table,
        _ => false,
    }
}

/// Whether a command means nothing while nothing is loaded.
fn needs_project(command: &Command) -> bool {
    !matches!(
        command,
        Command::OpenModel
            | Command::OpenSchedule
            | Command::OpenDemo
            | Command::Quit
            | Command::ToggleScheme
            | Command::SetMouse(_)
            | Command::Toggle(Panel::Shortcuts | Panel::Palette | Panel::About)
    )
}

/// How a way of drawing is called, and what it is.
pub fn mode_names(mode: DrawMode) -> (&'static str, &'static str) {
    match mode {
        DrawMode::Hdlod => (
            "HDLOD",
            "Clusters that are exact within the tolerance at this date; single elements close up.",
        ),
        DrawMode::Batched => {
            ("Batched", "Every present element in full detail, frustum-culled, in one multi-draw.")
        }
        DrawMode::Objects => {
            ("Objects", "Every present element with a draw call of its own: the paper's baseline.")
        }
    }
}

fn modes(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = 2.0;
    // From right to left.
    for mode in [DrawMode::Objects, DrawMode::Batched, DrawMode::Hdlod] {
        let (name, tip) = mode_names(mode);
        let command = Command::SetMode(mode);
        let tip = format!("{tip} ({})", keys_of(&command));
        if ui.selectable_label(state.mode == mode, name).on_hover_text(tip).clicked() {
            commands.push(command);
        }
    }
}

fn tolerance(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut value = state.tolerance_px;
    let drag = egui::DragValue::new(&mut value)
        .range(TOLERANCE)
        .speed(0.05)
        .fixed_decimals(2)
        .suffix(" px");
    let response = ui.add(drag).accessible_name("Tolerance").on_hover_text(
        "Largest displacement allowed on the picture, in physical pixels. Drag, or click to type.",
    );
    if response.changed() {
        commands.push(Command::SetTolerance(value));
    }
    ui.label(RichText::new("tolerance").color(palette(ui).weak));
    ui.add_space(8.0);
}

/// Counts errors and warnings; a click shows them.
fn badge(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(project) = &state.project else { return };
    let colors = palette(ui);
    let worst = project.scene.diagnostics.iter().map(|d| d.severity).max();
    let kinds = project.scene.diagnostics.iter().count();
    let (text, color) = match worst {
        None => return,
        Some(Severity::Error) => (format!("{kinds} findings"), colors.error),
        Some(Severity::Warning) => (format!("{kinds} findings"), colors.warning),
        Some(Severity::Info) => (format!("{kinds} remarks"), colors.weak),
    };
    let text = if kinds == 1 { text.trim_end_matches('s').to_owned() } else { text };
    let command = Command::Toggle(Panel::Diagnostics);
    let label = ui.selectable_label(state.panels.diagnostics, RichText::new(text).color(color));
    let tip = format!("What was found in the data ({})", keys_of(&command));
    if label.on_hover_text(tip).clicked() {
        commands.push(command);
    }
    ui.add_space(8.0);
}

/// The findings in the data, worst first.
pub fn diagnostics(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let (mut open, Some(project)) = (state.panels.diagnostics, &state.project) else { return };
    if !open {
        return;
    }
    egui::Window::new("Diagnostics")
        .open(&mut open)
        .default_size([520.0, 320.0])
        .collapsible(false)
        .default_pos([24.0, 140.0])
        .show(ctx, |ui| {
            ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
                if project.scene.diagnostics.iter().next().is_none() {
                    ui.label("Nothing to report.");
                }
                for finding in project.scene.diagnostics.iter() {
                    let colors = palette(ui);
                    let (word, color) = match finding.severity {
                        Severity::Error => ("error", colors.error),
                        Severity::Warning => ("warning", colors.warning),
                        Severity::Info => ("remark", colors.weak),
                    };
                    ui.horizontal(|ui| {
                        ui.label(RichText::new(word).color(color).strong());
                        ui.label(RichText::new(finding.code).color(colors.weak));
                        let count = short_count(finding.count as u64);
                        ui.label(RichText::new(format!("× {count}")).color(colors.weak));
                    });
                    ui.add(egui::Label::new(finding.message.as_str()).wrap().selectable(true));
                    if finding.count > 1 && !finding.examples.is_empty() {
                        ui.collapsing(format!("Where: {}", finding.code), |ui| {
                            let examples = finding.examples.join("\n");
                            ui.add(egui::Label::new(examples).wrap().selectable(true));
                        });
                    }
                    ui.separator();
                }
            });
        });
    if !open {
        commands.push(Command::Toggle(Panel::Diagnostics));
    }
}

/// The keys, in two columns.
pub fn shortcuts(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let mut open = state.panels.shortcuts;
    if !open {
        return;
    }
    egui::Window::new("Keyboard shortcuts")
        .open(&mut open)
        .resizable(false)
        .collapsible(false)
        .default_pos([24.0, 140.0])
        .show(ctx, |ui| {
            let actions = actions();
            let half = actions.len().div_ceil(2);
            egui::Grid::new("keys").num_columns(4).spacing([16.0, 4.0]).show(ui, |ui| {
                for i in 0..half {
                    for action in [actions.get(i), actions.get(half + i)].into_iter().flatten() {
                        ui.label(action.name);
                        let keys = action.shortcut.map(|s| s.text()).unwrap_or_default();
                        ui.label(RichText::new(keys).color(palette(ui).weak));
                    }
                    ui.end_row();
                }
            });
        });
    if !open {
        commands.push(Command::Toggle(Panel::Shortcuts));
    }
}

/// What to do when nothing is loaded.
pub fn welcome(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.vertical_centered(|ui| {
        ui.label(RichText::new("topout").size(28.0).strong());
        ui.label(
            RichText::new("A building and its schedule: the site on any day.")
                .color(palette(ui).weak),
        );
        ui.add_space(16.0);
        let mut button = |text: &str, command: Command, tip: &str| {
            let tip = format!("{tip} ({})", keys_of(&command));
            let button = egui::Button::new(text).min_size(egui::vec2(200.0, 32.0));
            if ui.add(button).on_hover_text(tip).clicked() {
                commands.push(command);
            }
            ui.add_space(4.0);
        };
        button("Open model…", Command::OpenModel, "A .glb or .gltf file");
        button(
            "Open schedule…",
            Command::OpenSchedule,
            "A .json, .csv, .xml, .xer or .ifc file; choose a links file together with it",
        );
        button("Open demo project", Command::OpenDemo, "A skyscraper with its schedule");
        ui.add_space(8.0);
        let hint = if state.waiting_schedules.is_empty() {
            "or drop models and schedules on this window".to_owned()
        } else {
            let names: Vec<_> = state
                .waiting_schedules
                .iter()
                .filter_map(|p| p.file_name())
                .map(|n| n.to_string_lossy())
                .collect();
            format!("Schedule {} waits: now open its model.", names.join(", "))
        };
        ui.label(RichText::new(hint).size(SMALL).color(palette(ui).weak));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_action_stands_in_exactly_one_menu() {
        for action in actions() {
            let places = MENUS.iter().flat_map(|(_, names)| names.iter());
            assert_eq!(places.filter(|n| **n == action.name).count(), 1, "{}", action.name);
        }
        for name in MENUS.iter().flat_map(|(_, names)| names.iter()).filter(|n| !n.is_empty()) {
            assert!(actions().iter().any(|a| a.name == *name), "{name} names no action");
        }
    }
}
