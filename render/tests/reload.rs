//! Shaders that are changed while the program runs: what is valid is taken over, what is not leaves the
//! picture as it was.
#![allow(clippy::unwrap_used)]

use glam::UVec2;
use std::path::Path;
use std::sync::Arc;
use topout_render::{Antialias, DrawMode, FrameInput, Gpu, Occlusion, Options, Picture};
use topout_render::{Renderer, ShaderError, ShaderFolder};
use topout_scene::{Progress, View, demo, hdlod, link};

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            std::fs::copy(&path, target).unwrap();
        }
    }
}

/// Replaces a text in a file; returns what the file said before.
fn edit(file: &Path, what: &str, by: &str) -> String {
    let before = std::fs::read_to_string(file).unwrap();
    assert!(before.contains(what), "{}: no {what}", file.display());
    std::fs::write(file, before.replace(what, by)).unwrap();
    before
}

fn shot(r: &mut Renderer, frame: &FrameInput) -> Picture {
    r.render(frame);
    r.read_back().unwrap()
}

#[test]
fn shaders_are_exchanged_only_for_ones_that_work() {
    let settings = demo::DemoSettings::for_elements(1000);
    let (model, schedule) = demo::generate(&settings, &Progress::default()).unwrap();
    let scene = Arc::new(link::link(model, schedule));
    let tree = hdlod::build(&scene, &hdlod::Settings::default(), &Progress::default()).unwrap();
    let mut r = Renderer::new(&Gpu::headless().unwrap());
    r.set_scene(&scene).unwrap();
    r.set_hdlod(&Arc::new(tree)).unwrap();
    let options = Options { antialias: Antialias::Off, occlusion: Occlusion::Gpu, ..r.options() };
    r.set_options(options);
    let view = View::fit(&scene.focus_bounds(), 30.0, 20.0, 2.0, UVec2::new(160, 100));
    let frame = FrameInput { view, time: scene.schedule.period.end, mode: DrawMode::Hdlod };
    let original = shot(&mut r, &frame);

    let temp = tempfile::tempdir().unwrap();
    copy(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shaders")), temp.path());
    let mut folder = ShaderFolder::new(temp.path());
    assert!(!folder.has_changed());

    // A sky without colour.
    let background = temp.path().join("common/background.wgsl");
    edit(&background, "vec3<f32>(0.545, 0.690, 0.860)", "vec3<f32>(0.0)");
    edit(&background, "vec3<f32>(0.885, 0.910, 0.935)", "vec3<f32>(0.0, 0.0, 0.01)");
    assert!(folder.has_changed() && !folder.has_changed());
    r.reload_shaders(&folder, &frame).unwrap();
    let black = shot(&mut r, &frame);
    assert!(black != original, "the new shader shows");

    for (file, what, by) in [
        // No WGSL.
        ("sky.wgsl", "fn sky_fragment", "fn fn sky_fragment"),
        // Another name than the program asks for.
        ("solid.wgsl", "fn solid_fragment", "fn other_fragment"),
        // A kernel that is valid alone, but reads what the program does not give to it.
        ("cull/recall.wgsl", "@binding(3)", "@binding(4)"),
        // More than the program writes.
        ("common/cull.wgsl", "array<vec4<u32>, 8>", "array<vec4<u32>, 80>"),
    ] {
        let path = temp.path().join(file);
        let before = edit(&path, what, by);
        assert!(folder.has_changed(), "{file}");
        let error = r.reload_shaders(&folder, &frame).unwrap_err();
        assert!(matches!(error, ShaderError::Invalid(_)), "{file}: {error}");
        assert!(error.to_string().is_ascii(), "{error}");
        assert!(shot(&mut r, &frame) == black, "{file}: the picture stays");
        std::fs::write(&path, before).unwrap();
    }
    std::fs::remove_file(temp.path().join("edges.wgsl")).unwrap();
    let error = r.reload_shaders(&folder, &frame).unwrap_err();
    assert!(error.to_string().contains("edges.wgsl"), "{error}");
    assert!(shot(&mut r, &frame) == black);

    // Pipelines that are built later are built from the same texts; the compiled ones come back.
    r.set_options(Options { antialias: Antialias::Smooth, ..options });
    r.set_options(options);
    assert!(shot(&mut r, &frame) == black);
    r.reload_shaders(&ShaderFolder::of_source(), &frame).unwrap();
    assert!(shot(&mut r, &frame) == original);
}
