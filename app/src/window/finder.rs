//! The command palette: every command by its name, and activities by theirs.

use super::chrome::is_enabled;
use super::command::{Command, Panel, actions};
use super::state::AppState;
use super::theme::{SMALL, palette};
use egui::{Align2, Key, Modifiers, RichText, ScrollArea, Ui};

/// Activities that are offered.
const ACTIVITIES: usize = 12;
/// Width of the palette, points.
const WIDTH: f32 = 440.0;

/// What is typed and which entry is chosen.
#[derive(Clone, Default)]
struct Typed {
    text: String,
    chosen: usize,
}

/// One entry.
struct Entry {
    name: String,
    keys: String,
    commands: Vec<Command>,
}

/// How well a name fits what was typed: lower is better; `None` where a word is missing.
fn fit(name: &str, wanted: &str) -> Option<usize> {
    let name = name.to_lowercase();
    let mut sum = 0;
    for word in wanted.split_whitespace() {
        let at = name.find(word)?;
        let begins = at == 0 || !name[..at].ends_with(char::is_alphanumeric);
        sum += if begins { at } else { at + 100 };
    }
    Some(sum)
}

fn entries(state: &AppState, wanted: &str) -> Vec<Entry> {
    let wanted = wanted.trim().to_lowercase();
    let mut found: Vec<(usize, Entry)> = actions()
        .into_iter()
        .filter(|action| action.command != Command::Toggle(Panel::Palette))
        .filter(|action| is_enabled(state, &action.command))
        .filter_map(|action| {
            let entry = Entry {
                name: action.name.to_owned(),
                keys: action.shortcut.map(|s| s.text()).unwrap_or_default(),
                commands: vec![action.command],
            };
            Some((fit(action.name, &wanted)?, entry))
        })
        .collect();
    found.sort_by_key(|(fit, _)| *fit);
    let mut entries: Vec<Entry> = found.into_iter().map(|(_, entry)| entry).collect();
    if let Some(project) = state.project.as_ref().filter(|_| wanted.len() >= 2) {
        let activities = project.scene.schedule.activities.iter().enumerate();
        let fits = activities.filter(|(i, _)| project.plan.words(*i).contains(&wanted));
        entries.extend(fits.take(ACTIVITIES).map(|(i, activity)| {
            let mut commands = vec![Command::SelectActivity(i)];
            commands.extend(activity.start.map(Command::JumpTo));
            let name = format!("Go to {}  {}", activity.id, activity.name);
            Entry { name, keys: "activity".to_owned(), commands }
        }));
    }
    entries
}

/// Draws the palette while it is open, and collects what is asked for.
pub fn show(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let key = egui::Id::unique("command palette");
    if !state.panels.palette {
        ctx.data_mut(|data| data.remove::<Typed>(key));
        return;
    }
    let known: Option<Typed> = ctx.data(|data| data.get_temp(key));
    let just_opened = known.is_none();
    let mut typed = known.unwrap_or_default();
    let close = Command::Toggle(Panel::Palette);
    // Before the field sees them.
    let pressed = |key| ctx.input_mut(|i| i.consume_key(Modifiers::NONE, key));
    let (up, down) = (pressed(Key::ArrowUp), pressed(Key::ArrowDown));
    let (enter, escape) = (pressed(Key::Enter), pressed(Key::Escape));
    let mut found = Vec::new();
    let mut chosen = None;
    let window = egui::Window::new("Command palette")
        .title_bar(false)
        .resizable(false)
        .anchor(Align2::CENTER_TOP, [0.0, 56.0])
        .fixed_size([WIDTH, 320.0])
        .show(ctx, |ui| {
            let field = egui::TextEdit::singleline(&mut typed.text)
                .hint_text("What to do, or an activity's id or name")
                .desired_width(f32::INFINITY);
            let field = ui.add(field).accessible_name("Command");
            if just_opened {
                field.request_focus();
            }
            if field.changed() {
                typed.chosen = 0;
            }
            // What was typed in this frame counts, and then the keys that came with it.
            found = entries(state, &typed.text);
            typed.chosen = (typed.chosen + usize::from(down)).saturating_sub(usize::from(up));
            typed.chosen = typed.chosen.min(found.len().saturating_sub(1));
            chosen = enter.then_some(typed.chosen);
            ui.add_space(4.0);
            ScrollArea::vertical().max_height(280.0).auto_shrink([false, true]).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                for (i, entry) in found.iter().enumerate() {
                    let row = row(ui, entry, i == typed.chosen);
                    if i == typed.chosen && (up || down) {
                        row.scroll_to_me(None);
                    }
                    if row.clicked() {
                        chosen = Some(i);
                    }
                }
                if found.is_empty() {
                    ui.label(RichText::new("Nothing is called that.").color(palette(ui).weak));
                }
            });
        });
    let outside = ctx.input(|i| i.pointer.any_pressed())
        && !just_opened
        && window.is_some_and(|w| {
            ctx.input(|i| i.pointer.interact_pos()).is_some_and(|at| !w.response.rect.contains(at))
        });
    if let Some(entry) = chosen.and_then(|i| found.into_iter().nth(i)) {
        commands.push(close);
        commands.extend(entry.commands);
    } else if escape || outside {
        commands.push(close);
    }
    ctx.data_mut(|data| data.insert_temp(key, typed));
}

fn row(ui: &mut Ui, entry: &Entry, chosen: bool) -> egui::Response {
    let keys = RichText::new(&entry.keys).size(SMALL).color(palette(ui).weak);
    let button = egui::Button::new(&entry.name)
        .shortcut_text(keys)
        .selected(chosen)
        .frame_when_inactive(chosen)
        .truncate()
        .min_size(egui::vec2(ui.available_width(), 22.0));
    ui.add(button).accessible_name(&entry.name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn names_fit_by_their_words() {
        assert_eq!(fit("Fit all", "fit"), Some(0));
        assert!(fit("Fit selection", "sel") < fit("Counsel", "sel"));
        assert_eq!(fit("Fit all", "fit sel"), None);
        assert_eq!(fit("Show all", ""), Some(0));
    }

    #[test]
    fn an_empty_window_offers_what_can_be_done_in_it() {
        let state = AppState::new(Arc::new(|| ()));
        let names: Vec<String> = entries(&state, "open").into_iter().map(|e| e.name).collect();
        assert_eq!(names, ["Open model…", "Open schedule…", "Open demo project"]);
        assert!(entries(&state, "play").is_empty(), "there is nothing to play");
    }
}
