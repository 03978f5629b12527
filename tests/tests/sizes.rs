//! Windows of every size and density of pixels.
//!
//! Whatever the window, the picture has the pixels of the place that the panels leave it, and what is clicked is
//! what is seen there.
#![allow(clippy::unwrap_used)]

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use glam::{UVec2, Vec2};
use topout::window::{Choose, Command, Half, Panel, Window};
use topout_tests::window::{apply, empty, open_sized, picture, settle, state, view};

/// As a screen of so many pixels a point.
fn set_density(harness: &mut Harness<'_, Window>, pixels_per_point: f32) {
    let root = harness.input_mut().viewports.entry(egui::ViewportId::ROOT).or_default();
    root.native_pixels_per_point = Some(pixels_per_point);
}

/// The picture has the pixels that the 3D view covers on the screen.
fn assert_fits(harness: &Harness<'_, Window>, what: &str) {
    let (place, scale) = (view(harness), harness.ctx.pixels_per_point());
    assert!(place.width() >= 0.0 && place.height() >= 0.0, "{what}: {place:?}");
    let expected = (place.size() * scale).round();
    let expected = UVec2::new(expected.x.max(1.0) as u32, expected.y.max(1.0) as u32);
    let size = state(harness).picture;
    // The rectangle is told in whole thousandths of a point.
    let off = size.as_ivec2() - expected.as_ivec2();
    assert!(off.abs().max_element() <= 1, "{what}: {size} pixels at {place:?}, {scale} a point");
}

/// Clicks where an element is seen near the middle of the picture, and finds that one selected.
fn assert_picks(harness: &mut Harness<'_, Window>, what: &str) {
    let (place, size) = (view(harness), state(harness).picture);
    let free = |at: Vec2| state(harness).pick(Half::Shown, at).map(|hit| (hit.element, at));
    let shares = [0.5, 0.45, 0.55, 0.4, 0.6, 0.35, 0.65, 0.7];
    let seen = shares
        .into_iter()
        .flat_map(|y| [0.5, 0.47, 0.53].map(|x| Vec2::new(x, y) * size.as_vec2()))
        .find_map(free);
    let (element, at) = seen.expect("something is seen in the middle");
    let share = at / size.as_vec2();
    let point = place.min + egui::vec2(share.x, share.y) * place.size();
    apply(harness, Command::ClearSelection);
    harness.hover_at(point);
    harness.step();
    harness.drag_at(point);
    harness.step();
    harness.drop_at(point);
    settle(harness);
    assert_eq!(state(harness).selected.elements(), [element], "{what}, at {point:?}");
}

#[test]
fn a_window_of_a_pixel_has_a_picture_of_one_and_grows_again() {
    for size in [[1.0, 1.0], [2.0, 1.0], [40.0, 900.0], [900.0, 40.0]] {
        let mut harness = open_sized([1280.0, 800.0]);
        for panel in [Panel::Gantt, Panel::Tree, Panel::Viewpoints, Panel::Diagnostics] {
            apply(&mut harness, Command::Toggle(panel));
        }
        let (camera, before) = (state(&harness).camera, view(&harness));
        harness.set_size(size.into());
        settle(&mut harness);
        assert_fits(&harness, &format!("{size:?}"));
        apply(&mut harness, Command::Choose(Choose::Only, vec![topout_scene::ElementId(5)]));
        apply(&mut harness, Command::FitSelection);
        apply(&mut harness, Command::SaveViewpoint);
        assert!(state(&harness).camera.is_sound(), "{size:?}");
        harness.set_size([1280.0, 800.0].into());
        apply(&mut harness, Command::MoveCamera(camera));
        assert_fits(&harness, "large again");
        assert_eq!(view(&harness), before, "panels are as wide as they were");
        let shown = picture(&mut harness);
        let first = &shown[..4];
        assert!(shown.chunks(4).any(|pixel| pixel != first), "something is drawn");
    }
}

#[test]
fn an_empty_window_of_a_pixel_does_not_panic() {
    let mut harness = empty();
    for size in [[1.0, 1.0], [2.0, 1.0], [3840.0, 2160.0]] {
        harness.set_size(size.into());
        harness.run();
        assert_fits(&harness, &format!("{size:?}"));
    }
}

#[test]
fn a_large_screen_is_drawn_pixel_by_pixel() {
    let mut harness = open_sized([3840.0, 2160.0]);
    assert_fits(&harness, "3840 x 2160");
    assert!(state(&harness).picture.x > 3000, "the panels take little of it");
    assert_picks(&mut harness, "3840 x 2160");
}

#[test]
fn clicks_find_what_is_under_them_at_any_density_and_zoom() {
    for scale in [1.0, 1.5, 2.0, 3.0] {
        let mut harness = open_sized([1280.0, 800.0]);
        set_density(&mut harness, scale);
        settle(&mut harness);
        let what = format!("{scale} pixels a point");
        assert_fits(&harness, &what);
        assert_eq!(harness.ctx.pixels_per_point(), scale);
        assert_picks(&mut harness, &what);
    }
    for zoom in [0.5, 0.8, 1.25] {
        let mut harness = open_sized([1280.0, 800.0]);
        harness.ctx.set_zoom_factor(zoom);
        settle(&mut harness);
        let what = format!("zoom {zoom}");
        assert_fits(&harness, &what);
        assert_picks(&mut harness, &what);
    }
}

/// Wider than any texture: the picture is reduced in both directions alike, and clicks still meet.
#[test]
fn what_is_larger_than_a_texture_is_reduced() {
    let mut harness = open_sized([1280.0, 800.0]);
    for panel in [Panel::Inspector, Panel::Timeline] {
        apply(&mut harness, Command::Toggle(panel));
    }
    set_density(&mut harness, 3.0);
    harness.set_size([14_000.0, 300.0].into());
    settle(&mut harness);
    let (place, size) = (view(&harness), state(&harness).picture);
    assert!((place.width() * 3.0) as u32 > size.x, "{place:?} {size}");
    assert!(size.x >= 8_192, "{size}");
    let [wanted, made] = [place.width() / place.height(), size.x as f32 / size.y as f32];
    assert!((wanted / made - 1.0).abs() < 0.01, "{wanted} and {made}");
    assert_picks(&mut harness, "14,000 points");
    assert!(state(&harness).error.is_none(), "{:?}", state(&harness).error);
    let label = harness.get_by_label("3D view");
    assert!(label.accesskit_node().raw_bounds().is_some());
}
