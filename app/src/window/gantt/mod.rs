//! Activities as rows and bars.

mod bars;
mod columns;
mod links;
mod plan;
mod rows;

pub use columns::{COLUMNS, Columns};
pub use plan::{Plan, Row, What};
pub use rows::{Filter, Gantt};

use super::calendar::{day_date, short_date};
use super::command::Command;
use super::loading::Project;
use super::state::AppState;
use super::theme::{SMALL, fold_sign, kind_color, palette};
use super::timeline::axis::{self, Axis, RULER_ROW};
use crate::report::grouped;
use bars::Bars;
use columns::{days, slack_days};
use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Align, Color32, Layout, PopupCloseBehavior, Rect, RichText, Sense, Stroke, Ui};
use egui_extras::{Column as Width, TableBuilder, TableRow};
use links::Seen;
use topout_schedule::{Activity, Schedule};

/// Height of a row, points.
const ROW: f32 = 22.0;
/// Indentation of one level of the outline, points.
const INDENT: f32 = 12.0;
/// Weeks that can be looked ahead.
const WEEKS: [u32; 5] = [1, 2, 4, 8, 12];

/// Draws the panel and collects what is asked for.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(project) = &state.project else { return };
    ui.horizontal(|ui| tools(ui, state, project, commands));
    ui.add_space(4.0);
    table(ui, state, project, commands);
}

fn tools(ui: &mut Ui, state: &AppState, project: &Project, commands: &mut Vec<Command>) {
    let schedule = &project.scene.schedule;
    let mut filter = state.gantt.filter.clone();
    let field = egui::TextEdit::singleline(&mut filter.text)
        .hint_text("Search id, name, WBS")
        .desired_width(180.0);
    ui.add(field).accessible_name("Search activities");
    let toggle = |ui: &mut Ui, on: &mut bool, name: &str, tip: &str| {
        if ui.selectable_label(*on, name).on_hover_text(tip).clicked() {
            *on = !*on;
        }
    };
    toggle(ui, &mut filter.active_now, "Active now", "At work at the shown date");
    let weeks = |w: u32| format!("Starting in {w} week{}", if w == 1 { "" } else { "s" });
    egui::ComboBox::from_id_salt("starting")
        .selected_text(filter.starting_weeks.map_or_else(|| "Starting".to_owned(), weeks))
        .show_ui(ui, |ui| {
            ui.selectable_value(&mut filter.starting_weeks, None, "Starting whenever");
            for w in WEEKS {
                ui.selectable_value(&mut filter.starting_weeks, Some(w), weeks(w));
            }
        })
        .response
        .accessible_name("Look ahead")
        .on_hover_text("Activities that start within some weeks after the shown date");
    let tip = "Ends after its baseline or plan, or was to be done by the data date and is not";
    toggle(ui, &mut filter.late, "Late", tip);
    let tip = "Cannot move without the project ending later; such bars have a red line";
    toggle(ui, &mut filter.critical, "Critical", tip);
    toggle(ui, &mut filter.unlinked, "Unlinked", "Linked to no element of the model");
    egui::ComboBox::from_id_salt("kind")
        .selected_text(filter.kind.map_or("All kinds", |kind| &schedule.kinds.of(kind).name))
        .show_ui(ui, |ui| {
            ui.selectable_value(&mut filter.kind, None, "All kinds");
            for &kind in project.plan.kinds() {
                let name = &schedule.kinds.of(kind).name;
                ui.selectable_value(&mut filter.kind, Some(kind), name);
            }
        })
        .response
        .accessible_name("Kind of activities");
    if let Some(node) = filter.below.and_then(|below| schedule.wbs.get(below as usize)) {
        let text = format!("below {} ×", node.name);
        if ui.button(text).on_hover_text("List all summaries again").clicked() {
            filter.below = None;
        }
    }
    if !filter.is_empty() {
        let clear = ui.button("Clear").accessible_name("Clear filters");
        if clear.on_hover_text("List all activities").clicked() {
            filter = Filter::default();
        }
    }
    if filter != state.gantt.filter {
        commands.push(Command::SetFilter(Box::new(filter)));
    }
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let close = ui.button("×").accessible_name("Close the Gantt chart");
        if close.clicked() {
            commands.push(Command::Toggle(super::command::Panel::Gantt));
        }
        columns_menu(ui, state, commands);
        if !schedule.wbs.is_empty() {
            if ui.button("Unfold all").clicked() {
                commands.push(Command::FoldAll(false));
            }
            if ui.button("Fold all").clicked() {
                commands.push(Command::FoldAll(true));
            }
        }
        let all = schedule.activities.len();
        let text = match state.gantt.passing() {
            passing if passing == all => format!("{} activities", grouped(all as u64)),
            passing => format!("{} of {}", grouped(passing as u64), grouped(all as u64)),
        };
        ui.label(RichText::new(text).size(SMALL).color(palette(ui).weak));
    });
}

/// Which columns are shown.
fn columns_menu(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (button, _) = MenuButton::new("Columns").config(config).ui(ui, |ui| {
        for (i, column) in COLUMNS.iter().enumerate() {
            let mut shown = state.columns.has(i);
            if ui.checkbox(&mut shown, column.name).on_hover_text(column.tip).changed() {
                commands.push(Command::SetColumns(state.columns.with(i, shown)));
            }
        }
    });
    button.on_hover_text("Which columns stand beside the bars");
}

fn table(ui: &mut Ui, state: &AppState, project: &Project, commands: &mut Vec<Command>) {
    let (number, row) = state.gantt.wish(&project.plan);
    let key = egui::Id::unique("gantt wish");
    let fulfilled: u64 = ui.data(|data| data.get_temp(key)).unwrap_or(0);
    let scroll_to = row.filter(|_| number > fulfilled);
    ui.data_mut(|data| data.insert_temp(key, number));

    let scrolled = egui::Id::unique("gantt scroll");
    let before: Option<(Columns, f32)> = ui.data(|data| data.get_temp(scrolled));

    ui.spacing_mut().item_spacing.y = 0.0;
    let mut builder = TableBuilder::new(ui)
        .id_salt(("gantt", state.columns.key()))
        .striped(false)
        .resizable(true)
        .sense(Sense::click())
        .auto_shrink(false)
        .animate_scrolling(false)
        .cell_layout(Layout::left_to_right(Align::Center))
        .column(Width::initial(240.0).at_least(80.0).clip(true));
    for column in state.columns.shown() {
        let width = COLUMNS[column].width;
        builder = builder.column(Width::initial(width).at_least(24.0).clip(true));
    }
    builder = builder.column(Width::remainder().at_least(80.0).clip(true));
    if let Some(row) = scroll_to {
        builder = builder.scroll_to_row(row, Some(Align::Center));
    }
    // Other columns are another table, which begins where the one before was.
    if let Some((columns, offset)) = before
        && columns != state.columns
    {
        builder = builder.vertical_scroll_offset(offset);
    }
    let mut seen = Seen::default();
    let output = builder
        .header(2.0 * RULER_ROW + 2.0, |mut header| {
            let named = state.columns.shown().map(|c| (COLUMNS[c].name, COLUMNS[c].tip));
            for (name, tip) in [("Name", "")].into_iter().chain(named) {
                header.col(|ui| {
                    let label = ui.label(RichText::new(name).size(SMALL).color(palette(ui).weak));
                    if !tip.is_empty() {
                        label.on_hover_text(tip);
                    }
                });
            }
            header.col(|ui| ruler(ui, state, commands));
        })
        .body(|body| {
            let rows = state.gantt.rows();
            body.rows(ROW, rows.len(), |mut row| {
                let index = row.index();
                let place = rows[index] as usize;
                match project.plan.rows()[place] {
                    Row { what: What::Summary(summary), depth, .. } => {
                        summary_row(&mut row, state, project, summary, depth, commands);
                    }
                    Row { what: What::Activity(activity), depth, .. } => {
                        let place = (index, activity as usize, depth);
                        activity_row(&mut row, state, project, place, &mut seen, commands);
                    }
                }
            });
        });
    let offset = output.state.clamped_offset().y;
    ui.data_mut(|data| data.insert_temp(scrolled, (state.columns, offset)));
    seen.paint(ui, state, project);
}

/// The ruler above the bars, which is dragged as the timeline is.
fn ruler(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (place, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, "Gantt ruler"));
    let axis = Axis { place, scale: state.scale };
    let painter = ui.painter_at(place);
    let colors = palette(ui);
    let ticks = axis.scale.ticks(place.width());
    let foot = Rect::from_min_max(place.left_bottom(), place.max);
    axis::marks(&painter, place, foot, axis, &ticks, colors);
    let x = axis.x(state.time());
    painter.vline(x, place.y_range(), Stroke::new(2.0, colors.cursor));
    axis::gestures(ui, &response, axis, state, commands);
}

/// Fold sign and name, indented.
fn name_cell(ui: &mut Ui, depth: u16, text: RichText, fold: Option<bool>) -> Option<bool> {
    ui.add_space(f32::from(depth.min(12)) * INDENT);
    let mut toggled = None;
    let (place, response) = ui.allocate_exact_size(
        egui::vec2(14.0, ROW),
        match fold {
            Some(_) => Sense::click(),
            None => Sense::hover(),
        },
    );
    if let Some(folded) = fold {
        let name = format!("{} {}", if folded { "Unfold" } else { "Fold" }, text.text());
        let response = response.accessible_name(name);
        fold_sign(ui, &response, place.center(), folded);
        toggled = response.clicked().then_some(!folded);
    }
    ui.add(egui::Label::new(text).truncate().selectable(false));
    toggled
}

fn summary_row(
    row: &mut TableRow<'_, '_>,
    state: &AppState,
    project: &Project,
    summary: u32,
    depth: u16,
    commands: &mut Vec<Command>,
) {
    let node = &project.scene.schedule.wbs[summary as usize];
    let sum = project.plan.sum(summary);
    let folded = state.gantt.is_folded(summary);
    let name = if node.name.is_empty() { &node.code } else { &node.name };
    row.set_selected(state.gantt.filter.below == Some(summary));
    row.col(|ui| {
        let text = RichText::new(name).strong();
        if let Some(folded) = name_cell(ui, depth, text, Some(folded)) {
            commands.push(Command::Fold(summary, folded));
        }
    });
    let dates = sum.span.map(|s| [day_date(s.start), day_date(s.end), days(s.seconds())]);
    let [start, finish, days] = dates.unwrap_or_default();
    let done = sum.done().map(|done| format!("{:.0} %", done * 100.0)).unwrap_or_default();
    let texts = [node.code.clone(), start, finish, days, done];
    for column in state.columns.shown() {
        let text = texts.get(column).cloned().unwrap_or_default();
        row.col(|ui| {
            ui.label(RichText::new(text).size(SMALL).color(palette(ui).weak));
        });
    }
    row.col(|ui| {
        let bars = Bars::begin(ui, state);
        if let Some(span) = sum.span {
            bars.summary(ui, span);
        }
        bars.wheel(ui, state, commands);
    });
    let response = row.response();
    if response.double_clicked() {
        let below = Some(summary);
        let filter = Filter { below, ..state.gantt.filter.clone() };
        commands.push(Command::SetFilter(Box::new(filter)));
    } else if response.clicked() {
        commands.push(Command::SelectSummary(summary));
    }
    response.on_hover_text(format!(
        "{} activities. Click: select their elements. Double click: list nothing else.",
        grouped(u64::from(sum.activities))
    ));
}

fn activity_row(
    row: &mut TableRow<'_, '_>,
    state: &AppState,
    project: &Project,
    (index, activity, depth): (usize, usize, u16),
    seen: &mut Seen,
    commands: &mut Vec<Command>,
) {
    let schedule = &project.scene.schedule;
    let it = &schedule.activities[activity];
    let of_selected = || {
        let one = state.selected.only();
        one.is_some_and(|id| project.scene.activities_of(id).contains(&(activity as u32)))
    };
    let selected = match state.selected.activity() {
        Some(chosen) => chosen == activity,
        None => of_selected(),
    };
    row.set_selected(selected);
    let late = project.plan.is_late(activity);
    row.col(|ui| {
        let text = RichText::new(if it.name.is_empty() { &it.id } else { &it.name });
        let text = if it.active { text } else { text.weak().strikethrough() };
        name_cell(ui, depth, text, None);
    });
    for column in state.columns.shown() {
        row.col(|ui| {
            let color = match column {
                2 if late => palette(ui).warning,
                _ => palette(ui).weak,
            };
            let text = (COLUMNS[column].text)(project, activity);
            let text = RichText::new(text).size(SMALL).color(color);
            ui.add(egui::Label::new(text).truncate().selectable(false));
        });
    }
    row.col(|ui| {
        let bars = Bars::begin(ui, state);
        seen.add(ui, index, Some(activity), ui.max_rect());
        let color = bar_color(ui, schedule, it);
        bars.activity(ui, activity, it, color, project.plan.is_critical(activity), commands);
        bars.wheel(ui, state, commands);
    });
    let response = row.response();
    if response.double_clicked() {
        commands.push(Command::SelectActivity(activity));
        commands.extend(it.start.map(Command::JumpTo));
        commands.push(Command::FitSelection);
    } else if response.clicked() {
        commands.push(Command::SelectActivity(activity));
    }
    if response.hovered() {
        let dates = it.dates().map(|d| format!("{} – {}", short_date(d.start), short_date(d.end)));
        let elements = project.plan.elements_of(activity).len();
        let slack = slack_days(project, activity).map(|days| match days {
            ..=0.0 => "\ncritical".to_owned(),
            days => format!("\n{days:.1} days of slack"),
        });
        response.on_hover_text(format!(
            "{}  {}\n{}\n{} elements{}",
            it.id,
            it.name,
            dates.as_deref().unwrap_or("no dates"),
            grouped(elements as u64),
            slack.unwrap_or_default()
        ));
    }
}

fn bar_color(ui: &Ui, schedule: &Schedule, activity: &Activity) -> Color32 {
    match activity.active {
        true => kind_color(schedule.kinds.of(activity.kind), ui.visuals().dark_mode),
        false => palette(ui).weak,
    }
}
