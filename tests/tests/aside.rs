//! What stands beside the work: the card of the first start, what the program is, and closing.
#![allow(clippy::unwrap_used)]

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::Path;
use topout::project::{Request, Source};
use topout::window::{Choose, Close, Command, Hint, Panel, Question, Shown, Window};
use topout_scene::ElementId;
use topout_tests::window::{apply, empty, open_sized, scene, settle, state, view};

fn open() -> Harness<'static, Window> {
    open_sized([1280.0, 800.0])
}

fn commands(harness: &Harness<'_, Window>) -> Vec<egui::ViewportCommand> {
    harness.output().viewport_output[&egui::ViewportId::ROOT].commands.clone()
}

#[test]
fn the_first_start_says_what_to_do_until_it_is_done() {
    let mut harness = open();
    assert!(harness.query_by_label("Close first steps").is_none(), "not at every start");
    for way in 0..4 {
        apply(&mut harness, Command::ShowHint);
        for text in ["First steps", "Space", "Ctrl+P", "F1", "Wheel"] {
            assert!(harness.query_all_by_label(text).count() > 0, "{text}");
        }
        let card = harness.get_by_label("Close first steps").rect();
        assert!(view(&harness).contains_rect(card), "over the 3D view");
        match way {
            0 => harness.get_by_label("Close first steps").click(),
            1 => harness.key_press(egui::Key::Escape),
            2 => harness.key_press(egui::Key::F1),
            _ => {
                let at = view(&harness).center();
                harness.hover_at(at);
                harness.step();
                harness.drag_at(at);
                harness.step();
                harness.hover_at(at + egui::vec2(40.0, 10.0));
                harness.step();
                harness.drop_at(at + egui::vec2(40.0, 10.0));
            }
        }
        settle(&mut harness);
        assert_eq!(state(&harness).hint, Hint { open: false, seen: true }, "way {way}");
        assert!(harness.query_by_label("Close first steps").is_none(), "way {way}");
        assert_eq!(state(&harness).panels.shortcuts, way == 2, "F1 does what it always does");
        if way == 2 {
            apply(&mut harness, Command::Toggle(Panel::Shortcuts));
        }
    }
}

#[test]
fn about_says_what_draws_and_copies_it() {
    let mut harness = empty();
    harness.get_by_label("Help").click();
    harness.run();
    harness.get_by_label_contains("About topout").click();
    harness.run();
    assert!(state(&harness).panels.about, "also without a project");
    let version = env!("CARGO_PKG_VERSION");
    assert!(harness.query_by_label(version).is_some());
    let adapter = state(&harness).adapter.clone().unwrap();
    for text in [adapter.name.clone(), adapter.backend.to_string()] {
        assert!(harness.query_by_label(&text).is_some(), "{text}");
    }
    let software = adapter.device_type == egui_wgpu::wgpu::DeviceType::Cpu;
    assert_eq!(harness.query_by_label_contains("software: ").is_some(), software);
    harness.get_by_label("Copy all about topout").click();
    harness.step();
    let copied = |harness: &Harness<'_, Window>| {
        harness.output().platform_output.commands.iter().find_map(|command| match command {
            egui::OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        })
    };
    let mut text = copied(&harness);
    for _ in 0..3 {
        if text.is_none() {
            harness.step();
            text = copied(&harness);
        }
    }
    let text = text.expect("something is copied");
    assert!(
        text.contains(&format!("Version: {version}")) && text.contains(&adapter.name),
        "{text}"
    );
    apply(&mut harness, Command::Toggle(Panel::About));
    assert!(harness.query_by_label(version).is_none());
}

/// The demo under the name of a file, saved.
fn saved(folder: &Path) -> Harness<'static, Window> {
    let mut harness = open();
    let models = vec![Source::File(folder.join("tower.glb"))];
    let request = Request { models, ..Request::default() };
    harness.state_mut().state_mut().show_scene(request, scene());
    settle(&mut harness);
    apply(&mut harness, Command::SaveProject);
    assert_eq!(state(&harness).error, None);
    harness
}

fn want_to_close(harness: &mut Harness<'_, Window>) -> Vec<egui::ViewportCommand> {
    let root = harness.input_mut().viewports.entry(egui::ViewportId::ROOT).or_default();
    root.events.push(egui::ViewportEvent::Close);
    harness.step();
    commands(harness)
}

/// Closing is refused while a file lacks something, and the user is asked; the keyboard can answer.
#[test]
fn closing_asks_about_changes_to_a_file() {
    use egui::ViewportCommand as V;
    let folder = tempfile::tempdir().unwrap();
    let mut harness = saved(folder.path());
    assert_eq!(state(&harness).title(), "tower.topout – topout");
    assert!(!want_to_close(&mut harness).contains(&V::CancelClose), "nothing is lost");
    assert!(harness.query_by_label("Save changes").is_none());

    apply(&mut harness, Command::Choose(Choose::Only, vec![ElementId(7)]));
    apply(&mut harness, Command::DrawSelection(Shown::Hidden));
    assert_eq!(state(&harness).title(), "● tower.topout – topout");
    assert!(want_to_close(&mut harness).contains(&V::CancelClose));
    harness.step();
    harness.get_by_label("Cancel changes").click();
    settle(&mut harness);
    assert_eq!(state(&harness).closing.question, Question::None);
    assert!(state(&harness).is_unsaved());

    assert!(want_to_close(&mut harness).contains(&V::CancelClose));
    harness.step();
    harness.key_press(egui::Key::Escape);
    settle(&mut harness);
    assert_eq!(state(&harness).closing.question, Question::None, "Escape goes on");

    want_to_close(&mut harness);
    harness.step();
    harness.get_by_label("Save changes").click();
    harness.step();
    let mut sent = commands(&harness);
    for _ in 0..3 {
        harness.step();
        sent.extend(commands(&harness));
    }
    assert!(sent.contains(&V::Close), "{sent:?}");
    assert!(!want_to_close(&mut harness).contains(&V::CancelClose), "it was answered");
    let text = std::fs::read_to_string(folder.path().join("tower.topout")).unwrap();
    let name = scene().model.elements[7].guid.clone();
    let name = name.unwrap_or_else(|| scene().model.elements[7].name.clone());
    assert!(text.contains(&name), "{name} is hidden in the file");
}

#[test]
fn changes_can_be_given_up() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = saved(folder.path());
    let before = std::fs::read_to_string(folder.path().join("tower.topout")).unwrap();
    apply(&mut harness, Command::SaveViewpoint);
    assert!(want_to_close(&mut harness).contains(&egui::ViewportCommand::CancelClose));
    apply(&mut harness, Command::AnswerClose(Close::Discard));
    assert!(!want_to_close(&mut harness).contains(&egui::ViewportCommand::CancelClose));
    assert_eq!(std::fs::read_to_string(folder.path().join("tower.topout")).unwrap(), before);
}
