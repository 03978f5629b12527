//! What this program is and what it draws with: what is asked first of whoever reports a mistake.

use super::command::{Command, Panel};
use super::state::AppState;
use super::theme::palette;
use egui::{RichText, Ui};
use wgpu::{AdapterInfo, DeviceType};

/// The version of wgpu in Cargo.lock, which a test compares.
const WGPU: &str = "30.0.1";
/// Whoever builds may say which commit it is; nothing is asked of git.
const COMMIT: Option<&str> = option_env!("TOPOUT_COMMIT");

/// What there is to say, as titles and values.
pub fn rows(adapter: Option<&AdapterInfo>) -> Vec<(&'static str, String)> {
    let mut rows = vec![("Version", env!("CARGO_PKG_VERSION").to_owned())];
    if let Some(commit) = COMMIT.map(str::trim).filter(|commit| !commit.is_empty()) {
        rows.push(("Commit", commit.to_owned()));
    }
    rows.push(("System", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)));
    match adapter {
        None => rows.push(("Graphics", "no adapter".to_owned())),
        Some(adapter) => {
            rows.push(("Graphics", adapter.name.clone()));
            rows.push(("Kind", kind(adapter.device_type).to_owned()));
            rows.push(("Backend", adapter.backend.to_string()));
            let parts = [&adapter.driver, &adapter.driver_info];
            let parts: Vec<&str> =
                parts.into_iter().map(|part| part.trim()).filter(|part| !part.is_empty()).collect();
            let driver = if parts.is_empty() { "not told".to_owned() } else { parts.join(", ") };
            rows.push(("Driver", driver));
        }
    }
    rows.push(("wgpu", WGPU.to_owned()));
    rows.push(("Licence", env!("CARGO_PKG_LICENSE").replace(" OR ", " or ")));
    rows
}

fn kind(kind: DeviceType) -> &'static str {
    match kind {
        DeviceType::DiscreteGpu => "hardware, a card of its own",
        DeviceType::IntegratedGpu => "hardware, part of the processor",
        DeviceType::VirtualGpu => "hardware, by way of a virtual machine",
        DeviceType::Cpu => "software: the processor draws",
        DeviceType::Other => "unknown",
    }
}

/// The same as text, a line each.
pub fn text(adapter: Option<&AdapterInfo>) -> String {
    let lines = rows(adapter).into_iter().map(|(title, value)| format!("{title}: {value}\n"));
    std::iter::once("topout\n".to_owned()).chain(lines).collect()
}

/// The window with all that.
pub fn show(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let mut open = state.panels.about;
    if !open {
        return;
    }
    let adapter = state.adapter.as_ref();
    egui::Window::new("About topout")
        .open(&mut open)
        .resizable(false)
        .collapsible(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(ctx.content_rect().center())
        .show(ctx, |ui| content(ui, adapter, commands));
    if !open {
        commands.push(Command::Toggle(Panel::About));
    }
}

fn content(ui: &mut Ui, adapter: Option<&AdapterInfo>, commands: &mut Vec<Command>) {
    ui.set_max_width(460.0);
    ui.label("A building and its schedule: the site on any day.");
    ui.add_space(4.0);
    egui::Grid::new("about").num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
        for (title, value) in rows(adapter) {
            ui.label(RichText::new(title).color(palette(ui).weak));
            ui.add(egui::Label::new(value).wrap().selectable(true));
            ui.end_row();
        }
    });
    ui.add_space(8.0);
    let copy = ui.button("Copy all").accessible_name("Copy all about topout");
    if copy.on_hover_text("Put all of this on the clipboard, as text").clicked() {
        commands.push(Command::Copy(text(adapter)));
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_version_of_wgpu_is_the_one_that_is_built_in() {
        let lock = include_str!("../../../Cargo.lock").replace("\r\n", "\n");
        let version = lock.split("name = \"wgpu\"\nversion = \"").nth(1).unwrap();
        assert_eq!(version.split('"').next().unwrap(), WGPU);
    }

    #[test]
    fn everything_is_said_also_without_an_adapter() {
        let titles = |text: &str| -> Vec<String> {
            let lines =
                text.lines().skip(1).map(|line| line.split(": ").next().unwrap().to_owned());
            lines.filter(|title| title != "Commit").collect()
        };
        assert_eq!(titles(&text(None)), ["Version", "System", "Graphics", "wgpu", "Licence"]);
        assert!(text(None).contains("Licence: MIT or Apache-2.0"));
        let kinds = [
            DeviceType::DiscreteGpu,
            DeviceType::IntegratedGpu,
            DeviceType::VirtualGpu,
            DeviceType::Cpu,
        ];
        for wanted in kinds {
            let software = kind(wanted).starts_with("software");
            assert_eq!(software, wanted == DeviceType::Cpu);
        }
    }
}
