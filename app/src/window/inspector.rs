//! The right side: what is known of the selected element, or of the project.

use super::browser::name_of;
use super::calendar::short_date;
use super::chrome::is_enabled;
use super::command::{Command, keys_of};
use super::loading::Project;
use super::state::AppState;
use super::theme::{SMALL, kind_color, palette};
use super::timeline::Scale;
use super::visibility::Shown;
use crate::report::grouped;
use egui::{Color32, Rect, RichText, ScrollArea, Sense, Stroke, Ui};
use std::collections::BTreeMap;
use topout_scene::{Category, ElementId, Scene};
use topout_schedule::{Activity, Behaviour, DateSet, Kind, Preset, Time};

/// Activities listed for one element; some schedules link a handful to every element.
const LISTED: usize = 200;

/// Draws the panel's content and collects what is asked for.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(project) = &state.project else { return };
    let selected = &state.selected;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        match (selected.activity(), selected.only(), selected.elements().len()) {
            (Some(activity), ..) => activity_panel(ui, state, project, activity, commands),
            (None, Some(element), _) => element_panel(ui, state, project, element, commands),
            (None, None, 0) => project_panel(ui, state, project),
            (None, None, _) => several_panel(ui, state, project, commands),
        }
    });
}

/// What can be done with what is selected.
fn buttons(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        for (name, tip, command) in [
            ("Show", "Fit the view to it", Command::FitSelection),
            ("Hide", "Draw it no longer", Command::DrawSelection(Shown::Hidden)),
            ("Ghost", "Draw it pale and see-through", Command::DrawSelection(Shown::Ghost)),
            ("Isolate", "Draw nothing else", Command::Isolate(Shown::Hidden)),
            ("Clear", "Select nothing", Command::ClearSelection),
        ] {
            let button = egui::Button::new(RichText::new(name).size(SMALL)).small();
            let button = ui.add_enabled(is_enabled(state, &command), button);
            if button.on_hover_text(format!("{tip} ({})", keys_of(&command))).clicked() {
                commands.push(command);
            }
        }
    });
}

/// Several elements: how many of what.
fn several_panel(ui: &mut Ui, state: &AppState, project: &Project, commands: &mut Vec<Command>) {
    let (scene, elements) = (&project.scene, state.selected.elements());
    ui.heading(format!("{} elements", grouped(elements.len() as u64)));
    buttons(ui, state, commands);
    ui.add_space(8.0);
    let there = elements.iter().filter(|id| scene.behaviour(**id).at(state.time())).count();
    let loose = elements.iter().filter(|id| scene.activities_of(**id).is_empty()).count();
    rows(ui, "several", |ui| {
        row(ui, "Present now", &grouped(there as u64));
        row(ui, "Not scheduled", &grouped(loose as u64));
    });
    for (title, category) in [("Types", Category::Type), ("Storeys", Category::Storey)] {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for &id in elements {
            *counts.entry(category.of(scene, id)).or_default() += 1;
        }
        let mut counts: Vec<_> = counts.into_iter().collect();
        counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        ui.add_space(8.0);
        ui.strong(title);
        rows(ui, title, |ui| {
            for (name, count) in counts.iter().take(12) {
                let name = if name.is_empty() { "none" } else { name };
                row(ui, name, &grouped(*count as u64));
            }
        });
        if counts.len() > 12 {
            ui.label(format!("… and {} more", counts.len() - 12));
        }
    }
    attach(ui, &scene.schedule.activities, elements, commands);
}

/// What the schedule says of one activity.
fn activity_panel(
    ui: &mut Ui,
    state: &AppState,
    project: &Project,
    index: usize,
    commands: &mut Vec<Command>,
) {
    let schedule = &project.scene.schedule;
    let Some(activity) = schedule.activities.get(index) else { return };
    let name = if activity.name.is_empty() { &activity.id } else { &activity.name };
    ui.add(egui::Label::new(RichText::new(name).heading()).wrap().selectable(true));
    ui.add_space(4.0);
    rows(ui, "activity", |ui| {
        row(ui, "Id", &activity.id);
        row(ui, "Kind", &schedule.kinds.of(activity.kind).name);
        row(ui, "WBS", &schedule.wbs_path(activity).join(" › "));
        if !activity.active {
            row(ui, "State", "not active");
        }
        let done = activity.percent_complete.map(|percent| format!("{percent:.0} %"));
        row(ui, "Done", &done.unwrap_or_default());
        row(ui, "Elements", &grouped(project.plan.elements_of(index).len() as u64));
        let names = activity.calendar.and_then(|c| schedule.calendars.get(c as usize));
        row(ui, "Calendar", names.map_or("", |c| &c.name));
    });
    buttons(ui, state, commands);
    ui.add_space(8.0);
    ui.strong("Dates");
    rows(ui, "dates", |ui| {
        let mut dates = |ui: &mut Ui, what: &str, start: Option<Time>, end: Option<Time>| {
            if start.is_none() && end.is_none() {
                return;
            }
            ui.label(RichText::new(what).color(palette(ui).weak));
            ui.horizontal(|ui| {
                for (what, time) in [("starts", start), ("ends", end)] {
                    if let Some(time) = time {
                        date_link(ui, what, time, palette(ui).accent, commands);
                    }
                }
            });
            ui.end_row();
        };
        dates(ui, "Shown", activity.start, activity.end);
        for (word, set) in DateSet::WORDS {
            let of_set = activity.date_sets[set];
            let mut name = word.to_owned();
            name[..1].make_ascii_uppercase();
            dates(ui, &name, of_set.start, of_set.end);
        }
    });
    let waits = activity.predecessors.iter().take(LISTED);
    if waits.len() > 0 {
        ui.add_space(8.0);
        ui.strong("Waits for");
        for link in waits {
            let other = &schedule.activities[link.activity as usize];
            let text = format!("{}  {} {}", link.kind.word(), other.id, other.name);
            let link_to = ui.link(RichText::new(text).size(SMALL));
            if link_to.on_hover_text("Select this activity").clicked() {
                commands.push(Command::SelectActivity(link.activity as usize));
            }
        }
    }
    if !activity.fields.is_empty() {
        ui.add_space(8.0);
        ui.collapsing(format!("Fields ({})", activity.fields.len()), |ui| {
            for (name, value) in activity.fields.iter().take(PROPERTIES) {
                ui.label(RichText::new(&**name).size(SMALL).color(palette(ui).weak));
                let value = RichText::new(&**value).size(SMALL);
                ui.add(egui::Label::new(value).wrap().selectable(true));
            }
        });
    }
}

fn row(ui: &mut Ui, name: &str, value: &str) {
    if value.is_empty() {
        return;
    }
    ui.label(RichText::new(name).color(palette(ui).weak));
    ui.add(egui::Label::new(value).wrap().selectable(true));
    ui.end_row();
}

fn rows(ui: &mut Ui, id: &str, add: impl FnOnce(&mut Ui)) {
    egui::Grid::new(id).num_columns(2).min_col_width(72.0).spacing([8.0, 4.0]).show(ui, add);
}

fn project_panel(ui: &mut Ui, state: &AppState, project: &Project) {
    let scene = &project.scene;
    ui.heading(project.name());
    ui.add_space(4.0);
    rows(ui, "project", |ui| {
        let elements = scene.model.elements.len();
        row(ui, "Elements", &grouped(elements as u64));
        row(ui, "Triangles", &grouped(project.triangles as u64));
        row(ui, "Activities", &grouped(scene.schedule.activities.len() as u64));
        let share = 100.0 * project.linked as f64 / elements.max(1) as f64;
        row(ui, "Linked", &format!("{} ({share:.1} %)", grouped(project.linked as u64)));
        row(ui, "Start", &short_date(scene.schedule.period.start));
        row(ui, "End", &short_date(scene.schedule.period.end));
        if let Some(cache) = &state.cache {
            row(ui, "Tree", state.tree_origin.unwrap_or_default());
            row(ui, "Cache", &cache.folder().display().to_string());
        }
    });
    ui.add_space(12.0);
    let hint = format!(
        "Click an element to see its activities. Drag turns about the point under the cursor, \
         Shift-drag or the middle button moves, the wheel zooms, {} shows everything.",
        keys_of(&Command::Fit)
    );
    ui.label(RichText::new(hint).size(SMALL).color(palette(ui).weak));
}

fn element_panel(
    ui: &mut Ui,
    state: &AppState,
    project: &Project,
    id: ElementId,
    commands: &mut Vec<Command>,
) {
    let scene = &project.scene;
    let element = &scene.model.elements[id.index()];
    let behaviour = scene.behaviour(id);
    let name = name_of(scene, id);
    ui.add(egui::Label::new(RichText::new(name).heading()).wrap().selectable(true));
    ui.add_space(4.0);
    rows(ui, "element", |ui| {
        let own_name = if element.label.is_empty() { "" } else { element.name.as_str() };
        row(ui, "Name", own_name);
        row(ui, "Kind", &element.kind);
        row(ui, "Storey", &element.storey);
        let group = element.group.map(|g| &scene.model.groups[g.index()]);
        let group = group.map(|g| if g.label.is_empty() { g.name.as_str() } else { &g.label });
        row(ui, "Group", group.unwrap_or_default());
        let guid = element.guid.as_deref().filter(|g| *g != element.name);
        row(ui, "Guid", guid.unwrap_or_default());
        row(ui, "Triangles", &grouped(scene.model.triangles_of(element) as u64));
        let size = element.bounds.size();
        row(ui, "Size", &format!("{:.2} × {:.2} × {:.2} m", size.x, size.z, size.y));
    });
    buttons(ui, state, commands);

    ui.add_space(8.0);
    let there = if behaviour.at(state.time()) { "present now" } else { "absent now" };
    let preset = preset_name(behaviour.preset(state.period()));
    ui.horizontal(|ui| {
        ui.strong("Presence");
        ui.label(RichText::new(format!("{preset} · {there}")).color(palette(ui).weak));
    });
    strip(ui, state, behaviour);

    ui.add_space(8.0);
    let activities = scene.activities_of(id);
    ui.horizontal(|ui| {
        ui.strong("Activities");
        ui.label(RichText::new(grouped(activities.len() as u64)).color(palette(ui).weak));
    });
    if activities.is_empty() {
        ui.label(RichText::new("No activity names this element.").color(palette(ui).weak));
    }
    for &index in activities.iter().take(LISTED) {
        let activity = &scene.schedule.activities[index as usize];
        let kind = scene.schedule.kinds.of(activity.kind);
        activity_row(ui, state.time(), activity, kind, commands);
        let detach = egui::Button::new(RichText::new("Detach").size(SMALL)).small();
        let detach = ui.add(detach).accessible_name(format!("Detach {}", activity.id));
        if detach.on_hover_text("No longer link this element to this activity").clicked() {
            commands.push(Command::Detach(vec![id], index as usize));
        }
    }
    if activities.len() > LISTED {
        ui.label(format!("… and {} more", activities.len() - LISTED));
    }
    attach(ui, &scene.schedule.activities, &[id], commands);
    properties(ui, scene, id);
}

/// Properties listed for one element.
const PROPERTIES: usize = 200;

/// What the model's file says of the element beside its name.
fn properties(ui: &mut Ui, scene: &Scene, element: ElementId) {
    let count = scene.model.properties(element).count();
    if count == 0 {
        return;
    }
    ui.add_space(8.0);
    ui.collapsing(format!("Properties ({count})"), |ui| {
        for (name, value) in scene.model.properties(element).take(PROPERTIES) {
            ui.label(RichText::new(name).size(SMALL).color(palette(ui).weak));
            ui.add(egui::Label::new(RichText::new(value).size(SMALL)).wrap().selectable(true));
        }
        if count > PROPERTIES {
            ui.label(format!("… and {} more", count - PROPERTIES));
        }
    });
}

/// Activities offered for what is typed.
const OFFERED: usize = 12;

/// What was searched for, and what was found.
#[derive(Clone, Default)]
struct Search {
    text: String,
    found: Vec<usize>,
}

/// A search for an activity to link elements to.
fn attach(
    ui: &mut Ui,
    activities: &[Activity],
    elements: &[ElementId],
    commands: &mut Vec<Command>,
) {
    if activities.is_empty() {
        return;
    }
    let key = egui::Id::unique("attach to");
    let mut search: Search = ui.data(|data| data.get_temp(key)).unwrap_or_default();
    ui.add_space(8.0);
    let field = egui::TextEdit::singleline(&mut search.text)
        .hint_text("Attach to an activity: id or name")
        .desired_width(f32::INFINITY);
    if ui.add(field).accessible_name("Attach to").changed() {
        let wanted = search.text.trim().to_lowercase();
        let fits = |a: &Activity| {
            a.id.to_lowercase().contains(&wanted) || a.name.to_lowercase().contains(&wanted)
        };
        search.found = match wanted.is_empty() {
            true => Vec::new(),
            false => {
                (0..activities.len()).filter(|&i| fits(&activities[i])).take(OFFERED).collect()
            }
        };
    }
    for &index in search.found.iter().filter(|&&i| i < activities.len()) {
        let Activity { id, name, .. } = &activities[index];
        let button = egui::Button::new(RichText::new(format!("{id}  {name}")).size(SMALL));
        let button = ui.add(button.truncate().frame(false));
        if button.accessible_name(format!("Attach to {id}")).clicked() {
            commands.push(Command::Attach(elements.to_vec(), index));
            search = Search::default();
            break;
        }
    }
    ui.data_mut(|data| data.insert_temp(key, search));
}

/// The period as a bar, filled while the element is present.
fn strip(ui: &mut Ui, state: &AppState, behaviour: &Behaviour) {
    let size = egui::vec2(ui.available_width(), 16.0);
    let (place, response) = ui.allocate_exact_size(size, Sense::hover());
    let Some(calendar) = state.calendar() else { return };
    let colors = palette(ui);
    let painter = ui.painter_at(place.expand(1.0));
    painter.rect_filled(place, 3.0, colors.well);
    let scale = Scale::of(calendar.period());
    let x = |time: Time| place.min.x + place.width() * scale.share(time).clamp(0.0, 1.0) as f32;
    for (from, to) in presence(behaviour, calendar.period().start, calendar.period().end) {
        let bar = Rect::from_x_y_ranges(x(from)..=x(to).max(x(from) + 1.0), place.y_range());
        painter.rect_filled(bar.shrink2(egui::vec2(0.0, 3.0)), 2.0, colors.accent);
    }
    painter.vline(x(state.time()), place.y_range(), Stroke::new(2.0, colors.cursor));
    response.on_hover_text("Filled while the element is there, over the whole project.");
}

/// The spans within `[start, end]` during which an object is present.
fn presence(behaviour: &Behaviour, start: Time, end: Time) -> Vec<(Time, Time)> {
    let mut spans = Vec::new();
    let mut since = behaviour.at(start).then_some(start);
    for &toggle in behaviour.toggles().iter().filter(|t| start < **t && **t <= end) {
        match since.take() {
            Some(from) => spans.push((from, toggle)),
            None => since = Some(toggle),
        }
    }
    spans.extend(since.map(|from| (from, end)));
    spans
}

fn activity_row(
    ui: &mut Ui,
    now: Time,
    activity: &Activity,
    kind: &Kind,
    commands: &mut Vec<Command>,
) {
    let dark = ui.visuals().dark_mode;
    let color = if activity.active { kind_color(kind, dark) } else { palette(ui).weak };
    let name = if activity.name.is_empty() { &activity.id } else { &activity.name };
    let running = activity.start.is_some_and(|s| s <= now) && activity.end.is_some_and(|e| now < e);
    ui.horizontal(|ui| {
        let (dot, response) = ui.allocate_exact_size(egui::vec2(8.0, 16.0), Sense::hover());
        let dot = Rect::from_center_size(dot.center(), egui::vec2(8.0, 8.0));
        ui.painter().rect_filled(dot, 2.0, color);
        response.on_hover_text(&*kind.name);
        let text = RichText::new(name);
        let text = if running { text.strong() } else { text };
        ui.add(egui::Label::new(text).truncate())
            .on_hover_text(format!("{} {}\n{}", activity.id, name, kind.name));
    });
    ui.horizontal(|ui| {
        ui.add_space(16.0);
        if !activity.active {
            ui.label(RichText::new("not active").size(SMALL).color(palette(ui).weak));
        }
        for (what, time) in [("starts", activity.start), ("ends", activity.end)] {
            match time {
                Some(time) => date_link(ui, what, time, palette(ui).accent, commands),
                None => {
                    ui.label(RichText::new("no date").size(SMALL));
                }
            }
        }
    });
}

fn date_link(ui: &mut Ui, what: &str, time: Time, color: Color32, commands: &mut Vec<Command>) {
    let text = RichText::new(short_date(time)).size(SMALL).color(color);
    let link = ui.link(text).on_hover_text(format!("Go to the instant at which it {what}"));
    if link.clicked() {
        commands.push(Command::JumpTo(time));
    }
}

fn preset_name(preset: Preset) -> &'static str {
    match preset {
        Preset::Static => "always there",
        Preset::Absent => "never there",
        Preset::Installed => "installed",
        Preset::Removed => "removed",
        Preset::Temporary => "temporary",
        Preset::Skipped => "away for a time",
        Preset::ReInstalled => "installed, removed, installed again",
        Preset::ReDeleted => "removed, back, removed again",
        Preset::Other => "comes and goes",
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn presence_spans_agree_with_the_behaviour() {
        let t = Time::from_seconds;
        let behaviour = Behaviour::new(false, vec![t(5), t(10), t(20)]).unwrap();
        assert_eq!(presence(&behaviour, t(0), t(30)), [(t(5), t(10)), (t(20), t(30))]);
        assert_eq!(presence(&behaviour, t(7), t(15)), [(t(7), t(10))]);
        assert_eq!(presence(&Behaviour::never(), t(0), t(9)), []);
        assert_eq!(presence(&Behaviour::always(), t(0), t(9)), [(t(0), t(9))]);
    }
}
