//! A window whose graphics device is lost: nothing panics, and another window goes on with all of it.
#![allow(clippy::unwrap_used)]

use egui_kittest::kittest::Queryable;
use topout::window::{Choose, Command, Panel, Shown};
use topout_scene::ElementId;
use topout_schedule::Time;
use topout_tests::window::{again, apply, empty, open, picture, scene, settle, state, view};

/// The device is destroyed while the demo is shown in HDLOD with a selection. The frames that follow paint
/// nothing and ask for the window to be closed; the next window shows the same picture, element for element.
#[test]
fn another_window_goes_on_with_all_that_a_lost_device_showed() {
    let mut harness = open();
    apply(&mut harness, Command::JumpTo(Time::parse_iso("2026-11-05").unwrap()));
    apply(&mut harness, Command::Choose(Choose::Only, vec![ElementId(40), ElementId(41)]));
    apply(&mut harness, Command::DrawSelection(Shown::Hidden));
    apply(&mut harness, Command::Choose(Choose::Only, vec![ElementId(300)]));
    apply(&mut harness, Command::SaveViewpoint);
    apply(&mut harness, Command::Toggle(Panel::Figures));
    apply(&mut harness, Command::DismissNews);
    let before = picture(&mut harness);
    let (camera, time, size) = {
        let state = state(&harness);
        (state.camera, state.time(), state.picture)
    };

    assert_eq!(harness.state().lost_device(), None);
    harness.state().lose_device();
    for _ in 0..5 {
        harness.step();
    }
    assert!(harness.state().lost_device().is_some());
    let output = &harness.output().viewport_output[&egui::ViewportId::ROOT];
    assert!(output.commands.contains(&egui::ViewportCommand::Close), "{:?}", output.commands);
    assert!(harness.output().shapes.is_empty(), "egui panics where it paints without a device");

    let left = harness.state_mut().leave().unwrap();
    drop(harness);
    let mut harness = again(left);
    settle(&mut harness);
    assert!(state(&harness).news.as_ref().unwrap().contains("opened again"));
    harness.get_by_label("Close message").click();
    settle(&mut harness);
    let state = state(&harness);
    assert!(std::sync::Arc::ptr_eq(&state.project.as_ref().unwrap().scene, &scene()));
    assert_eq!((state.camera, state.time(), state.picture), (camera, time, size));
    assert_eq!(state.selected.elements(), [ElementId(300)]);
    assert_eq!(state.shown(ElementId(41)), Shown::Hidden);
    assert_eq!((state.viewpoints.len(), state.history.reach().0), (1, true));
    assert!(state.error.is_none(), "{:?}", state.error);
    let after = picture(&mut harness);
    let other = before.iter().zip(&after).filter(|(a, b)| a.abs_diff(**b) > 2).count();
    assert!(other * 1000 < before.len(), "{other} of {} bytes", before.len());
}

/// Before anything is open, and while something is loaded.
#[test]
fn a_device_can_be_lost_at_any_time() {
    let mut harness = empty();
    harness.state().lose_device();
    harness.step();
    harness.step();
    let left = harness.state_mut().leave().unwrap();
    let mut harness = again(left);
    harness.state_mut().state_mut().apply(Command::OpenDemo);
    harness.step();
    harness.state().lose_device();
    harness.step();
    let left = harness.state_mut().leave().unwrap();
    assert!(left.state.loading.is_some(), "loading goes on");
    let mut harness = again(left);
    apply(&mut harness, Command::CancelLoading);
    assert!(view(&harness).width() > 100.0);
    assert!(harness.state().lost_device().is_none());
}
