//! `topout render`: what the saved picture shows.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Folder, assert_keys, cubes, number, small_project, text, topout};
use image::RgbImage;
use serde_json::Value;
use std::path::Path;

fn open(path: &Path) -> RgbImage {
    let picture = image::open(path).unwrap();
    assert_eq!(picture.color().channel_count(), 3, "the sky is opaque");
    picture.into_rgb8()
}

/// Renders a model with options and returns the report and the picture.
fn render(folder: &Folder, project: &[String], options: &str) -> (Value, RgbImage) {
    let png = folder.path("picture.png");
    let mut args = vec!["render".to_owned()];
    args.extend_from_slice(project);
    args.extend(["-o".to_owned(), text(&png), "--json".to_owned(), "-".to_owned()]);
    args.extend(options.split(' ').map(str::to_owned));
    let report = topout(&args).good_json();
    (report, open(&png))
}

/// Pixels by which two pictures differ clearly.
fn changed(a: &RgbImage, b: &RgbImage) -> usize {
    assert_eq!(a.dimensions(), b.dimensions());
    a.pixels()
        .zip(b.pixels())
        .filter(|(a, b)| a.0.iter().zip(b.0).any(|(x, y)| x.abs_diff(y) > 24))
        .count()
}

/// Pixels that show a cube.
fn red(picture: &RgbImage) -> usize {
    picture.pixels().filter(|p| is_red(p)).count()
}

fn is_red(pixel: &image::Rgb<u8>) -> bool {
    pixel.0[0] > pixel.0[1].saturating_add(30)
}

/// Three cubes: the slab is built, then the wall, and the shed goes in between.
#[test]
fn the_picture_follows_the_schedule() {
    let folder = Folder::new();
    let project = small_project(&folder);
    let at = |date: &str| render(&folder, &project, &format!("--at {date} --size 320x180"));
    let (first, slab_and_shed) = at("2026-03-03");
    assert_eq!(slab_and_shed.dimensions(), (320, 180));
    assert_keys(&first, &["frame_ms", "draws", "triangles", "clusters", "worst_px"]);
    assert_keys(&first, &["load_seconds", "first_picture_seconds"]);
    let present =
        |report: &Value| (number(report, "present_elements"), number(report, "present_triangles"));
    assert_eq!(present(&first), (2.0, 24.0));
    let (second, slab) = at("2026-03-07");
    assert_eq!(present(&second), (1.0, 12.0));
    let (third, slab_and_wall) = at("2026-03-09T00:00");
    assert_eq!(present(&third), (2.0, 24.0), "a start is inclusive");
    assert!(changed(&slab_and_shed, &slab) > 500);
    assert!(changed(&slab, &slab_and_wall) > 500);
    assert!(changed(&slab_and_shed, &slab_and_wall) > 1000, "other elements, not as many");
    let (_, again) = at("2026-03-03");
    assert_eq!(changed(&slab_and_shed, &again), 0, "the same date is the same picture");
}

#[test]
fn the_ways_of_drawing_agree_on_exact_elements() {
    let folder = Folder::new();
    let project = small_project(&folder);
    let by = |lod: &str| {
        render(
            &folder,
            &project,
            &format!("--at 2026-03-10 --size 320x180 --tolerance 0 --lod {lod}"),
        )
    };
    let (batched, expected) = by("batched");
    assert_eq!(number(&batched, "triangles"), 24.0);
    for lod in ["hdlod", "objects"] {
        let (report, picture) = by(lod);
        assert_eq!(report["lod"], lod);
        assert_eq!(number(&report, "triangles"), 24.0);
        assert_eq!(changed(&picture, &expected), 0, "{lod}");
    }
}

#[test]
fn farther_away_means_smaller() {
    let folder = Folder::new();
    let project = small_project(&folder);
    let shown = |coverage: &str| {
        let options = format!("--size 320x180 --at 2026-03-10 --coverage {coverage}");
        red(&render(&folder, &project, &options).1) as f64
    };
    let (whole, quarter, sixteenth) = (shown("1/1"), shown("1/4"), shown("1/16"));
    assert!((0.15..0.35).contains(&(quarter / whole)), "{whole} {quarter}");
    assert!((0.03..0.10).contains(&(sixteenth / whole)), "{whole} {sixteenth}");
}

/// A camera is given in the file's coordinates, also where these are large (surveyed models).
#[test]
fn eye_and_target_are_world_coordinates() {
    let folder = Folder::new();
    let place = [183_000.0, 12.0, -431_000.0];
    // As high above zero, where the ground is.
    let level = [0.0, place[1], 0.0];
    let model = folder.write("far.glb", cubes(&["slab"], place));
    let look = |model: &str, z: f64, dx: f64| {
        let [x, y, _] = if z == 0.0 { level } else { place };
        let options = format!(
            "--at 2026-03-03 --size 160x90 --eye {},{},{} --target {},{y},{z}",
            x + dx,
            y + 1.0,
            z + 6.0,
            x + dx
        );
        render(&folder, &[model.to_owned()], &options).1
    };
    let near = folder.write("near.glb", cubes(&["slab"], level));
    let (far, expected) = (look(&model, place[2], 0.0), look(&near, 0.0, 0.0));
    assert!(red(&expected) > 150, "{}", red(&expected));
    let cube = |picture: &RgbImage| picture.pixels().map(is_red).collect::<Vec<_>>();
    let moved = cube(&far).iter().zip(cube(&expected)).filter(|(a, b)| **a != *b).count();
    assert!(moved < 10, "{moved} of {} pixels", red(&expected));
    let aside = look(&near, 0.0, 50.0);
    assert_eq!(red(&aside), 0, "the cube is not seen from aside");
}

#[test]
fn every_named_view_shows_something_else() {
    let folder = Folder::new();
    let project = small_project(&folder);
    let mut seen: Vec<RgbImage> = Vec::new();
    for view in ["front", "left", "top", "iso"] {
        let (_, picture) =
            render(&folder, &project, &format!("--at 2026-03-10 --size 160x90 --view {view}"));
        assert!(seen.iter().all(|other| changed(other, &picture) > 200), "{view}");
        seen.push(picture);
    }
}

#[test]
fn a_picture_that_cannot_be_written_is_named() {
    let folder = Folder::new();
    let model = folder.cubes("house.glb", &["slab"]);
    let end = topout(["render", &model, "--at", "2026-03-03", "-o", "/no/such/place/a.png"]);
    assert_eq!(end.code, 1);
    assert!(end.stderr.contains("/no/such/place/a.png"), "{}", end.stderr);
}

/// Full detail, the way that is asked for, and the difference, from left to right.
#[test]
fn compared_pictures_stand_beside_each_other() {
    let folder = Folder::new();
    let project = small_project(&folder);
    let by = |options: &str| {
        render(&folder, &project, &format!("--at 2026-03-10 --size 320x180 {options}"))
    };
    let part = |all: &RgbImage, at: u32| {
        assert_eq!(all.dimensions(), (960, 180));
        image::imageops::crop_imm(all, at * 320, 0, 320, 180).to_image()
    };
    let brightest = |picture: &RgbImage| picture.as_raw().iter().copied().max().unwrap();
    let (report, same) = by("--lod objects --compare");
    assert_eq!(number(&report, "flip"), 0.0);
    let batched = by("--lod batched").1;
    assert!(part(&same, 0) == batched && part(&same, 1) == batched);
    assert!(brightest(&part(&same, 2)) < 8, "black where nothing differs");

    let files = folder.path("demo");
    topout(["demo", "-o", &text(&files), "--elements", "1000", "--json", "-"]).good_json();
    let schedule = text(&files.join("demo.json"));
    let project = [text(&files.join("demo.glb")), "--schedule".to_owned(), schedule];
    let by = |options: &str| {
        let common = "--at 2028-01-01 --size 320x180 --tolerance 8";
        render(&folder, &project, &format!("{common} {options}"))
    };
    let (report, other) = by("--compare");
    let (alone, coarse) = by("--lod hdlod");
    assert!(alone["flip"].is_null() && number(&report, "flip") > 0.02);
    // Clusters of eight pixels are worse than what one sample a pixel costs, but not another picture.
    let (full, other_ideal) = (number(&report, "flip_full_ideal"), number(&report, "flip_ideal"));
    assert!(0.01 < full && full < other_ideal && other_ideal < 0.6, "{full} {other_ideal}");
    assert!(part(&other, 0) != coarse && part(&other, 1) == coarse);
    assert!(brightest(&part(&other, 2)) > 60);
}
