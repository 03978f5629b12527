//! What floats in the corners of the 3D view: figures, standard views, progress and messages.

use super::command::{Command, Panel, keys_of};
use super::cube;
use super::hint;
use super::loading::Job;
use super::modes;
use super::shown::ElementColors;
use super::state::{AppState, Tree};
use super::theme::{SMALL, palette};
use super::visibility::Shown;
use egui::{Align2, Frame, Margin, Rect, RichText, Ui};
use topout_render::{DrawMode, FrameStats};
use topout_scene::{Hdlod, MOST_WEEKS, NamedView};

/// `53 k`, `3.6 M`: at most three figures.
pub fn short_count(count: u64) -> String {
    let value = count as f64;
    let (value, unit) = match count {
        0..=9_999 => return count.to_string(),
        10_000..=999_999 => (value / 1e3, " k"),
        1_000_000..=999_999_999 => (value / 1e6, " M"),
        _ => (value / 1e9, " G"),
    };
    let decimals = if value < 9.95 { 1 } else { 0 };
    format!("{value:.decimals$}{unit}")
}

/// Everything that floats over the picture at `place`.
pub fn show(ui: &mut Ui, place: Rect, state: &AppState, commands: &mut Vec<Command>) {
    let inner = place.shrink(12.0);
    corner(ui, inner, Align2::LEFT_TOP, "notices", |ui| notices(ui, state, commands));
    if state.project.is_none() {
        return;
    }
    corner(ui, inner, Align2::RIGHT_TOP, "views", |ui| views(ui, state, commands));
    corner(ui, inner, Align2::LEFT_BOTTOM, "legend", |ui| legend(ui, state, commands));
    if state.hint.open {
        corner(ui, inner, Align2::CENTER_BOTTOM, "first steps", |ui| {
            card(ui).inner_margin(Margin::same(10)).show(ui, |ui| hint::card(ui, state, commands));
        });
    }
    if state.panels.figures {
        corner(ui, inner, Align2::RIGHT_BOTTOM, "figures", |ui| figures(ui, state, commands));
    }
}

fn corner(ui: &Ui, inner: Rect, align: Align2, name: &str, add: impl FnOnce(&mut Ui)) {
    egui::Area::new(egui::Id::unique(("corner", name)))
        .order(if name == "notices" { egui::Order::Foreground } else { egui::Order::Middle })
        .constrain_to(inner)
        .pivot(align)
        .fixed_pos(align.pos_in_rect(&inner))
        .movable(false)
        .show(ui.ctx(), add);
}

fn card(ui: &Ui) -> Frame {
    Frame::new()
        .fill(palette(ui).panel.gamma_multiply(0.92))
        .stroke(egui::Stroke::new(1.0, palette(ui).line.gamma_multiply(0.6)))
        .corner_radius(6)
        .inner_margin(Margin::symmetric(8, 4))
}

/// Rows of a legend that are listed.
const LEGEND_ROWS: usize = 16;

/// What the colours of elements mean, and what is hidden.
fn legend(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let rows = if state.level_colors { &[][..] } else { state.coloring.legend() };
    let not_whole = state.visibility.count();
    let unscheduled = state.visibility.unscheduled != Shown::Whole;
    if rows.is_empty() && not_whole == 0 && !unscheduled {
        return;
    }
    card(ui).show(ui, |ui| {
        ui.spacing_mut().item_spacing = egui::vec2(6.0, 2.0);
        ui.spacing_mut().interact_size.y = 14.0;
        for row in rows.iter().take(LEGEND_ROWS) {
            ui.horizontal(|ui| {
                let size = egui::vec2(10.0, 10.0);
                let (place, _) = ui.allocate_exact_size(size, egui::Sense::hover());
                let [r, g, b] = row.color;
                ui.painter().rect_filled(place, 2.0, egui::Color32::from_rgb(r, g, b));
                ui.label(RichText::new(&row.name).size(SMALL));
                let count = short_count(row.elements as u64);
                ui.label(RichText::new(count).size(SMALL).color(palette(ui).weak));
            });
        }
        if rows.len() > LEGEND_ROWS {
            let more = format!("… and {} more", rows.len() - LEGEND_ROWS);
            ui.label(RichText::new(more).size(SMALL).color(palette(ui).weak));
        }
        if let ElementColors::LookAhead(weeks) = state.colors {
            ui.horizontal(|ui| {
                let label = ui.label(RichText::new("Weeks ahead").size(SMALL));
                let mut wanted = weeks;
                let drag =
                    egui::DragValue::new(&mut wanted).range(1..=MOST_WEEKS as u8).speed(0.05);
                if ui.add(drag).labelled_by(label.id).changed() {
                    commands.push(Command::LookAhead(wanted));
                }
            });
        }
        if not_whole > 0 || unscheduled {
            ui.horizontal(|ui| {
                let text = match (not_whole, unscheduled) {
                    (0, _) => "unscheduled elements are muted".to_owned(),
                    (count, false) => format!("{} hidden or ghosts", short_count(count as u64)),
                    (count, true) => {
                        format!("{} hidden or ghosts, unscheduled too", short_count(count as u64))
                    }
                };
                ui.label(RichText::new(text).size(SMALL));
                let all = Command::ShowAll;
                let link = ui.link(RichText::new("Show all").size(SMALL));
                if link.on_hover_text(format!("({})", keys_of(&all))).clicked() {
                    commands.push(all);
                }
            });
        }
    });
}

/// The view cube, and what shows everything.
fn views(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.vertical_centered(|ui| {
        ui.set_max_width(84.0);
        cube::show(ui, state, commands);
        card(ui).inner_margin(Margin::same(2)).show(ui, |ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            ui.horizontal(|ui| {
                for (command, name, tip) in [
                    (Command::LookFrom(NamedView::Iso), "Iso", "Look from the standard corner"),
                    (Command::Fit, "Fit", "Show everything"),
                ] {
                    let button = egui::Button::new(RichText::new(name).size(SMALL)).frame(true);
                    let button = button.frame_when_inactive(false);
                    let tip = format!("{tip} ({})", keys_of(&command));
                    if ui.add(button).on_hover_text(tip).clicked() {
                        commands.push(command);
                    }
                }
            });
        });
    });
}

fn figures(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(stats) = state.frames.last() else { return };
    let graph = Command::Toggle(Panel::Graph);
    card(ui).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
        let mut line = |ui: &mut Ui, text: String, tip: &str| {
            let label =
                egui::Label::new(RichText::new(text).size(SMALL)).sense(egui::Sense::click());
            let tip = format!("{tip}\nClick: graph of the frame times ({})", keys_of(&graph));
            if ui.add(label).on_hover_text(tip).clicked() {
                commands.push(graph.clone());
            }
        };
        let ms = |share| {
            state.frames.percentile(share).map_or_else(|| "–".to_owned(), |ms| format!("{ms:.1}"))
        };
        line(
            ui,
            format!("frame {} ms · 95 % {} ms", ms(0.5), ms(0.95)),
            &format!(
                "Median and 95th percentile of the last {} rendered frames.\n\
                 Last frame: {:.2} ms choosing what to draw, {:.2} ms encoding commands{}.\n\
                 Frames are rendered only when something changes.",
                state.frames.len(),
                stats.select_ms,
                stats.cpu_ms,
                match stats.gpu_ms {
                    Some(ms) => format!("; {ms:.2} ms on the GPU"),
                    None => "; this adapter does not tell its own time".to_owned(),
                }
            ),
        );
        line(
            ui,
            format!(
                "{}{} triangles · {} draws",
                stats.left.map_or(String::new(), |left| format!("{} of ", short_count(left))),
                short_count(stats.triangles),
                short_count(stats.draws)
            ),
            "What the last frame asked the GPU to draw: of the triangles that suffice for the \
             tolerance those that may be seen.",
        );
        let (text, tip) = accuracy(state, stats);
        line(ui, text, &tip);
    });
}

fn accuracy(state: &AppState, stats: &FrameStats) -> (String, String) {
    match (state.effective_mode(), state.mode) {
        (DrawMode::Hdlod, _) => (
            format!("{} clusters · ≤ {:.2} px certified", stats.clusters, stats.worst_px),
            format!(
                "Largest displacement that a drawn cluster can cause on this picture, in physical \
                 pixels: an upper bound computed from the geometry, not an estimate.\n\
                 {} clusters and {} single elements drawn, {} nodes of the tree looked at.",
                stats.clusters, stats.elements, stats.visited
            ),
        ),
        (_, DrawMode::Hdlod) => (
            "full detail until HDLOD is ready".to_owned(),
            "The tree is still being built; every present element is drawn.".to_owned(),
        ),
        _ => (
            format!("full detail · {} elements", stats.elements),
            "Every present element inside the frame is drawn with all its triangles.".to_owned(),
        ),
    }
}

fn notices(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    if let Some(error) = &state.error {
        card(ui).inner_margin(Margin::same(8)).show(ui, |ui| {
            ui.set_max_width(400.0);
            ui.label(RichText::new("That did not work").color(palette(ui).error).strong());
            ui.label(error.as_str());
            ui.horizontal(|ui| {
                if ui.button("Dismiss").clicked() {
                    commands.push(Command::DismissError);
                }
                if ui.button("Copy text").clicked() {
                    commands.push(Command::Copy(error.clone()));
                }
            });
        });
    }
    if let Some((what, job)) = &state.loading {
        working(ui, &format!("Loading {what}"), job, Command::CancelLoading, commands);
    }
    match &state.tree {
        Tree::Building(job) => {
            working(ui, "Building HDLOD", job, Command::CancelHdlod, commands);
        }
        Tree::Stopped => {
            card(ui).show(ui, |ui| {
                ui.horizontal(|ui| {
                    ui.label("HDLOD is not built; drawn in full detail.");
                    if ui.button("Build").clicked() {
                        commands.push(Command::BuildHdlod);
                    }
                });
            });
        }
        Tree::Ready(tree) => refining(ui, state, tree, commands),
        Tree::None => {}
    }
    if let Some(job) = &state.comparing {
        working(ui, "Comparing", job, Command::StopComparing, commands);
    }
    if state.project.is_some() && modes::any(state) {
        card(ui).show(ui, |ui| modes::show(ui, state, commands));
    }
    if let Some(job) = &state.exporting {
        working(ui, "Saving", job, Command::CancelExport, commands);
    }
    if let Some(news) = &state.news {
        card(ui).show(ui, |ui| {
            ui.set_max_width(420.0);
            ui.horizontal(|ui| {
                let close = ui.small_button("×").accessible_name("Close message");
                if close.on_hover_text("Close this message").clicked() {
                    commands.push(Command::DismissNews);
                }
                ui.add(egui::Label::new(RichText::new(news).size(SMALL)).wrap());
            });
        });
    }
}

/// An edit of the schedule left clusters that are not drawn until they are merged anew.
fn refining(ui: &mut Ui, state: &AppState, tree: &Hdlod, commands: &mut Vec<Command>) {
    if let Some(job) = &state.refining {
        return working(ui, "Refining HDLOD", job, Command::CancelHdlod, commands);
    }
    let stale = tree.stale_count();
    if stale > 0 {
        card(ui).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label(format!("{stale} clusters are drawn in more detail than they need."));
                if ui.button("Refine").clicked() {
                    commands.push(Command::BuildHdlod);
                }
            });
        });
    }
}

fn working<T: Send + 'static>(
    ui: &mut Ui,
    title: &str,
    job: &Job<T>,
    cancel: Command,
    commands: &mut Vec<Command>,
) {
    let (_, share) = job.state();
    card(ui).inner_margin(Margin::same(8)).show(ui, |ui| {
        ui.set_width(280.0);
        ui.horizontal(|ui| {
            ui.label(RichText::new(title).strong());
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.small_button("Cancel").on_hover_text(format!("Stop: {title}")).clicked() {
                    commands.push(cancel);
                }
            });
        });
        ui.add(egui::ProgressBar::new(share).desired_height(4.0));
        ui.label(RichText::new(job.told()).size(SMALL).color(palette(ui).weak))
            .on_hover_text("What is being done, and how long this step of it will still take");
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_short() {
        for (count, text) in [
            (0, "0"),
            (9_999, "9999"),
            (53_120, "53 k"),
            (999_400, "999 k"),
            (3_632_126, "3.6 M"),
            (36_321_260, "36 M"),
        ] {
            assert_eq!(short_count(count), text);
        }
    }
}
