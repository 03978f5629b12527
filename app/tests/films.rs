//! `topout movie`, `topout report` and pictures with captions, as scripts use them.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Folder, Run, assert_keys, command, number, small_project, text, topout};
use image::RgbaImage;
use std::path::Path;

fn run(folder: &Folder, sub: &str, output: &str, options: &str) -> Run {
    let project = small_project(folder);
    let mut args = vec![sub.to_owned()];
    args.extend(project);
    if !options.contains("--size") {
        args.extend(["--size".to_owned(), "96x54".to_owned()]);
    }
    args.extend(["-o".to_owned(), text(&folder.path(output))]);
    args.extend(options.split_whitespace().map(str::to_owned));
    topout(args)
}

fn open(path: impl AsRef<Path>) -> RgbaImage {
    image::open(path).unwrap().into_rgba8()
}

/// What lies beside the project's two files.
fn left(folder: &Folder) -> Vec<String> {
    let entries = std::fs::read_dir(folder.path("")).unwrap();
    let names = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned());
    let mut names: Vec<_> = names.filter(|n| n != "house.glb" && n != "plan.csv").collect();
    names.sort();
    names
}

/// Pixels that show a red cube.
fn red(picture: &RgbaImage) -> usize {
    picture.pixels().filter(|p| p.0[3] > 127 && p.0[0] > p.0[1].saturating_add(30)).count()
}

/// The slab and the shed, the slab alone, and slab and wall.
#[test]
fn a_film_follows_the_schedule() {
    let folder = Folder::new();
    let report = run(&folder, "movie", "film", "--frames 13 --json -").good_json();
    assert_keys(
        &report,
        &["file", "fps", "from", "to", "bytes", "adapter", "seconds", "load_seconds"],
    );
    for (key, expected) in [("frames", 13.0), ("width", 96.0), ("height", 54.0), ("fps", 24.0)] {
        assert_eq!(number(&report, key), expected, "{key}");
    }
    assert_eq!(report["format"], "png");
    assert_eq!(
        (&report["from"], &report["to"]),
        (&"2026-03-02T00:00:00".into(), &"2026-03-14T00:00:00".into())
    );
    let files = report["files"].as_array().unwrap();
    assert_eq!(files.len(), 13);
    let frames: Vec<_> = files.iter().map(|f| open(f.as_str().unwrap())).collect();
    // A day a frame: as `render` shows that day.
    let project = small_project(&folder);
    let mut still = vec!["render"];
    still.extend(project.iter().map(String::as_str));
    let png = text(&folder.path("still.png"));
    still.extend(["--at", "2026-03-07", "--size", "96x54", "-o", &png]);
    assert_eq!(topout(still).code, 0);
    assert_eq!(frames[5], open(&png));
    let [both, slab, all] =
        [frames[0].clone(), frames[5].clone(), frames[12].clone()].map(|f| red(&f));
    assert!(slab > 0 && both > slab && all > slab, "{both}, {slab}, {all}");
}

#[test]
fn films_are_gif_and_mp4_by_name() {
    let folder = Folder::new();
    for (name, start) in [("a.gif", &b"GIF89a"[..]), ("a.mp4", b"\0\0\0\x20ftypisom")] {
        let options = "--frames 5 --fps 10 --turn -90 --caption --colors activity --json -";
        let report = run(&folder, "movie", name, options).good_json();
        assert_eq!(number(&report, "frames"), 5.0);
        assert_eq!(report["format"].as_str().unwrap(), &name[2..]);
        let file = std::fs::read(folder.path(name)).unwrap();
        assert_eq!(&file[..start.len()], start);
        assert_eq!(number(&report, "bytes"), file.len() as f64);
    }
    assert_eq!(left(&folder), ["a.gif", "a.mp4"]);
    let shown = run(&folder, "movie", "a.gif", "--frames 1 --from 2026-03-03 --to 2026-03-03");
    assert_eq!(shown.code, 0, "{}", shown.stderr);
    assert!(shown.stdout.contains("1 frame of"), "{}", shown.stdout);
    // Software drivers may say something of their own.
    let own = shown.stderr.lines().find(|line| !line.contains("XDG_RUNTIME_DIR"));
    assert_eq!(own, None, "progress is for terminals");
}

#[test]
fn wrong_films_are_refused_and_leave_nothing() {
    let folder = Folder::new();
    for (output, options, told) in [
        ("a.gif", "--from 2026-03-05 --to 2026-03-04", "after"),
        ("a.gif", "--from 2027-03-05", "2027-03-05T00:00:00 is after the project's end"),
        ("a.gif", "--to 2025-03-05", "before the project's start"),
        ("a.gif", "--frames 0", "1..=99999"),
        ("a.gif", "--fps 0", "0.1 to 240"),
        ("a.gif", "--turn NaN", "degrees"),
        ("a.gif", "--background transparent", "PNG"),
        ("a.mp4", "--background transparent", "PNG"),
        ("a.avi", "", ".mp4"),
        ("a.png", "", "folder"),
    ] {
        let wrong = run(&folder, "movie", output, options);
        assert_eq!(wrong.code, 2, "{output} {options}: {}", wrong.stderr);
        assert!(wrong.stderr.contains(told), "{output} {options}: {}", wrong.stderr);
    }
    folder.write("file", "");
    for output in
        ["no/such/a.gif", "no/such/frames", "file", "file/a.mp4", "/proc/a.gif", "/proc/frames"]
    {
        let wrong = run(&folder, "movie", output, "--frames 2");
        assert_eq!(wrong.code, 1, "{output}: {}", wrong.stderr);
        assert!(wrong.stderr.contains(output.trim_start_matches('/')), "{}", wrong.stderr);
    }
    let wrong = run(&folder, "report", "no/page.html", "");
    assert_eq!((wrong.code, wrong.stderr.contains("no/page.html")), (1, true), "{}", wrong.stderr);
    assert_eq!(run(&folder, "report", "page.pdf", "").code, 2);
    let model = folder.cubes("house.glb", &["a"]);
    let still = topout(["movie", &model, "-o", &text(&folder.path("a.gif"))]);
    assert_eq!((still.code, still.stderr.contains("no schedule")), (2, true), "{}", still.stderr);
    assert_eq!(left(&folder), ["file"]);
}

/// Ctrl+C while frames are drawn.
#[test]
#[cfg(unix)]
fn what_is_interrupted_leaves_nothing() {
    let folder = Folder::new();
    let project = small_project(&folder);
    for output in ["a.mp4", "frames"] {
        let mut args = vec!["movie".to_owned(), "-o".to_owned(), text(&folder.path(output))];
        args.extend(project.iter().cloned());
        args.extend(["--frames", "99999", "--size", "320x180"].map(str::to_owned));
        let mut film = command(args).spawn().unwrap();
        // Some frames in. The place is tried before anything is loaded, so there for a moment means nothing.
        let pause = || std::thread::sleep(std::time::Duration::from_millis(300));
        let at_work = (0..200).any(|_| {
            pause();
            let once = !left(&folder).is_empty();
            pause();
            once && !left(&folder).is_empty()
        });
        assert!(at_work);
        let sent =
            std::process::Command::new("kill").args(["-INT", &film.id().to_string()]).status();
        assert!(sent.unwrap().success());
        assert_eq!(film.wait().unwrap().code(), Some(130));
        assert_eq!(left(&folder), [""; 0]);
    }
}

#[test]
fn pictures_have_captions_and_backgrounds() {
    let folder = Folder::new();
    let shot = |options: &str| {
        let run =
            run(&folder, "render", "a.png", &format!("--at 2026-03-03 --size 320x180 {options}"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        open(folder.path("a.png"))
    };
    let (plain, white, clear) =
        (shot(""), shot("--background white"), shot("--background transparent"));
    let corner = |picture: &RgbaImage| picture.get_pixel(319, 0).0;
    assert_eq!((corner(&white), corner(&clear)), ([255; 4], [0; 4]));
    assert!(corner(&plain)[2] < 255 && corner(&plain)[3] == 255);
    // The same cubes, and laid over white the transparent picture is like the white one.
    let cubes = red(&plain);
    let others = [&white, &clear].map(red);
    assert!(
        cubes > 500 && others.iter().all(|n| n.abs_diff(cubes) * 20 < cubes),
        "{cubes} {others:?}"
    );
    let over = |p: &image::Rgba<u8>, c: usize| {
        (u32::from(p.0[c]) * u32::from(p.0[3]) + 255 * (255 - u32::from(p.0[3]))) / 255
    };
    let far = white.pixels().zip(clear.pixels()).filter(|(white, clear)| {
        (0..3).any(|c| u32::from(white.0[c]).abs_diff(over(clear, c)) > 70)
    });
    let far = far.count();
    assert!(far * 20 < cubes, "only edges are smoothed otherwise: {far} of {cubes}");
    let partly = clear.pixels().filter(|p| (20..235).contains(&p.0[3])).count();
    assert!(partly > 20, "edges are soft: {partly}");

    let told = shot("--caption");
    let changed = plain.enumerate_pixels().filter(|(x, y, p)| *p != told.get_pixel(*x, *y));
    let (mut right, mut top, mut count) = (0, u32::MAX, 0);
    changed.for_each(|(x, y, _)| (right, top, count) = (right.max(x), top.min(y), count + 1));
    assert!(count > 2000 && right < 300 && top > 90, "{count} {right} {top}");
}

#[test]
fn a_report_is_one_file() {
    let folder = Folder::new();
    let report = run(&folder, "report", "page.html", "--json -").good_json();
    assert_keys(
        &report,
        &["file", "bytes", "late", "known_until", "planned_percent", "adapter", "seconds"],
    );
    assert_eq!(number(&report, "pictures"), 1.0);
    let page = std::fs::read_to_string(folder.path("page.html")).unwrap();
    assert_eq!(number(&report, "bytes"), page.len() as f64);
    for text in ["March 2026", "Slab", "Wall", "Shed", "data:image/jpeg;base64,/9j/", "<svg"] {
        assert!(page.contains(text), "{text}");
    }
    for address in ["http://", "https://"] {
        let others = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!others.contains(address), "nothing is loaded");
    }
    assert_eq!(left(&folder), ["page.html"]);
    let clear = run(&folder, "report", "page.html", "--background transparent");
    assert_eq!(clear.code, 0, "{}", clear.stderr);
    let page = std::fs::read_to_string(folder.path("page.html")).unwrap();
    assert!(page.contains("data:image/png;base64,iVBOR"));
}
