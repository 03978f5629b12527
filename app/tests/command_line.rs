//! The command line as scripts use it: options, exit codes, JSON keys.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Folder, assert_keys, command, number, run, small_project, text, topout};
use std::collections::BTreeSet;

#[test]
fn help_names_every_sub_command() {
    let help = topout(["--help"]);
    assert_eq!(help.code, 0);
    for sub in ["demo", "check", "bake", "render", "movie", "report", "bench", "verify"] {
        assert!(help.stdout.contains(&format!("\n  {sub} ")), "{sub} in {}", help.stdout);
        assert_eq!(topout([sub, "--help"]).code, 0);
    }
}

#[test]
fn wrong_use_ends_with_2_and_says_what_was_expected() {
    for (line, told) in [
        ("check", "<MODEL>"),
        ("check demo --wrong", "--wrong"),
        ("frobnicate", "frobnicate"),
        ("movie demo --from 2026-01-01", "-o <DIR|FILE>"),
        ("render demo -o a.png", "--at"),
        ("render demo --at 3.4.2026 -o a.png", "3.4.2026"),
        ("render demo --at 2026-04-03 -o a.png --size big", "1280x720"),
        ("render demo --at 2026-04-03 -o a.png --coverage 4", "1/4"),
        ("render demo --at 2026-04-03 -o a.png --eye 1,2,3", "--target"),
        ("check demo --date-format dmy", "%d-%m-%Y"),
        ("bench demo --csv - --markdown -", "only one of"),
        ("demo --elements 1000", "-o <DIR>"),
        ("demo --elements 10 -o /no/such/folder", "1000"),
    ] {
        let wrong = topout(line.split(' '));
        assert_eq!(wrong.code, 2, "{line}: {}", wrong.stderr);
        assert!(wrong.stderr.contains(told), "{line}: {}", wrong.stderr);
    }
}

/// The figures that the paper gives for its skyscraper (H16).
#[test]
fn the_demo_has_the_papers_size_and_links_without_errors() {
    let report = topout(["check", "demo", "--json", "-"]).good_json();
    assert_eq!(number(&report, "elements"), 79_396.0);
    assert_eq!(number(&report, "triangles"), 3_632_126.0);
    assert_eq!(number(&report, "activities"), 67_099.0);
    assert_eq!(number(&report, "unlinked_activities"), 0.0, "{}", report["diagnostics"]);
    let behaviours = report["behaviours"].as_object().unwrap();
    for name in [
        "static",
        "absent",
        "installed",
        "removed",
        "temporary",
        "skipped",
        "re-installed",
        "re-deleted",
    ] {
        assert!(behaviours[name].as_u64() > Some(0), "{name}: {behaviours:?}");
    }
}

#[test]
fn check_counts_a_small_project() {
    let folder = Folder::new();
    let project = small_project(&folder);
    let mut args = vec!["check"];
    args.extend(project.iter().map(String::as_str));
    let shown = topout(&args);
    assert_eq!(shown.code, 0, "{}", shown.stderr);
    assert!(shown.stdout.contains("elements") && shown.stdout.contains("installed"));
    assert!(shown.stderr.is_empty(), "no progress without a terminal: {}", shown.stderr);

    args.extend(["--json", "-"]);
    let report = topout(&args).good_json();
    for (key, expected) in [
        ("elements", 3.0),
        ("triangles", 36.0),
        ("activities", 3.0),
        ("linked_elements", 3.0),
        ("unlinked_elements", 0.0),
        ("linked_activities", 3.0),
        ("unlinked_activities", 0.0),
    ] {
        assert_eq!(number(&report, key), expected, "{key}");
    }
    assert_eq!(report["start"], "2026-03-02T00:00:00");
    assert_eq!(report["finish"], "2026-03-14T00:00:00", "a finish lasts to the end of its day");
    // The slab is there from the first instant of the period on.
    assert_eq!(report["behaviours"]["static"], 1);
    assert_eq!(report["behaviours"]["installed"], 1);
    assert_eq!(report["behaviours"]["removed"], 1);
    assert_eq!(report["diagnostics"].as_array().map(Vec::len), Some(0));
}

#[test]
fn rules_link_what_names_do_not_and_are_suggested() {
    let folder = Folder::new();
    let model = folder.cubes("house.glb", &["wall", "wall", "slab", "roof"]);
    let schedule = folder.write(
        "plan.csv",
        "id,name,start,end,Part\nA,Walls,2026-03-02,2026-03-03,wall\nB,Slab,2026-03-03,2026-03-04,slab\n",
    );
    let project = ["check", &model, "--schedule", &schedule, "--json", "-"];
    let report = topout(project).good_json();
    assert_eq!(report["linked_elements"], 0);
    assert_eq!(report["rules"][0]["name"], "elements");
    let suggestion = &report["suggestions"][0];
    let said = "2 of 2 keys (field \"Part\") match by name: 3 elements, 2 activities";
    assert_eq!(suggestion["text"], said, "{}", report["suggestions"]);
    let shown = topout(&project[..4]);
    assert!(shown.stdout.contains(said), "{}", shown.stdout);

    let rules = serde_json::json!({"format": "topout-rules", "rules": [suggestion["rule"]],
        "attached": [{"activity": "B", "elements": ["roof"]}]});
    let rules = folder.write("rules.json", rules.to_string());
    let with = ["--rules", &rules];
    let report = topout(project.iter().chain(&with)).good_json();
    assert_eq!((&report["linked_elements"], &report["linked_activities"]), (&4.into(), &2.into()));
    assert_eq!(report["rules"][0]["elements"], 3);
    assert_eq!(
        (&report["rules"][1]["name"], &report["rules"][1]["links"]),
        (&"attached".into(), &1.into())
    );
    assert_eq!(report["suggestions"].as_array().map(Vec::len), Some(0));
    let shown = topout(project[..4].iter().chain(&with));
    assert!(
        shown.stdout.contains("3 elements, 2 activities, 3 links; 0 of 2 keys"),
        "{}",
        shown.stdout
    );

    let bad = folder.write("bad.json", r#"{"format": "topout-rules", "rules": [{"element": 3}]}"#);
    let wrong = topout(project.iter().chain(&["--rules", bad.as_str()]));
    assert_eq!(wrong.code, 1);
    let findings = wrong.json()["diagnostics"].to_string();
    assert!(
        findings.contains("bad.json: rules[0].element: it must be an object, but it is 3"),
        "{findings}"
    );
}

#[test]
fn json_goes_to_a_file_and_text_to_the_terminal() {
    let folder = Folder::new();
    let model = folder.cubes("house.glb", &["slab"]);
    let json = text(&folder.path("report.json"));
    let shown = topout(["check", &model, "--json", &json]);
    assert_eq!(shown.code, 0, "{}", shown.stderr);
    assert!(shown.stdout.contains("elements"));
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    assert_eq!(report["elements"], 1);
    assert_eq!(report["start"], serde_json::Value::Null, "no schedule, no dates");
    assert_eq!(report["behaviours"]["static"], 1);

    let unwritable = topout(["check", &model, "--json", "/no/such/folder/report.json"]);
    assert_eq!(unwritable.code, 1);
    assert!(unwritable.stderr.contains("/no/such/folder/report.json"), "{}", unwritable.stderr);
}

#[test]
fn several_models_make_one_scene() {
    let folder = Folder::new();
    let [a, b] = [folder.cubes("a.glb", &["a1", "a2"]), folder.cubes("b.glb", &["b1"])];
    let report = topout(["check", &a, &b, "--json", "-"]).good_json();
    assert_eq!(report["elements"], 3);
    assert_eq!(report["triangles"], 36);
}

/// What `demo` writes is what `check`, `bake`, `render`, `bench` and `verify` read.
#[test]
fn a_written_demo_goes_through_every_sub_command() {
    let folder = Folder::new();
    let out = text(&folder.path("new/demo"));
    let sizes = ["--elements", "1500", "--triangles", "60000", "--activities", "1200"];
    let mut args = vec!["demo", "-o", &out, "--json", "-"];
    args.extend(sizes);
    let written = topout(&args).good_json();
    for (key, expected) in [("elements", 1500), ("triangles", 60_000), ("activities", 1200)] {
        assert_eq!(written[key], expected, "{key}");
    }
    let (model, schedule) = (format!("{out}/demo.glb"), format!("{out}/demo.json"));
    let project = [model.as_str(), "--schedule", schedule.as_str(), "--json", "-"];

    let checked = topout(["check"].iter().chain(&project)).good_json();
    for key in ["elements", "triangles", "activities"] {
        assert_eq!(checked[key], written[key], "{key}");
    }
    assert_eq!(checked["unlinked_activities"], 0, "{}", checked["diagnostics"]);

    let baked = topout(["bake", "--no-cache"].iter().chain(&project)).good_json();
    assert_keys(&baked, &["clusters", "levels", "max_degree", "root_triangles", "seconds"]);
    assert_keys(&baked, &["peak_rss_mb", "cache_bytes", "cache_hit", "phases"]);
    assert_eq!(baked["elements"], written["elements"]);
    assert!(number(&baked, "clusters") > 10.0 && number(&baked, "levels") > 3.0, "{baked}");
    assert!(number(&baked, "root_triangles") < 0.2 * number(&baked, "triangles"), "{baked}");
    assert!(baked["phases"].as_object().unwrap().len() > 3, "{baked}");
    levels_are_complete(&baked);

    let (csv, tables) = (text(&folder.path("cells.csv")), text(&folder.path("tables.md")));
    let bench = ["bench", "--size", "320x180", "--csv", &csv, "--markdown", &tables];
    let measured = topout(bench.iter().chain(&project)).good_json();
    bench_is_complete(&measured);
    let cells = std::fs::read_to_string(&csv).unwrap();
    assert_eq!(cells.lines().count(), measured["cells"].as_array().unwrap().len() + 1);
    let again =
        format!("    topout bench {model} --schedule {schedule} --size 320x180 --tolerance 1\n");
    assert!(std::fs::read_to_string(&tables).unwrap().contains(&again));
    both_rules_are_compared(&measured);

    let verify = ["verify", "--size", "480x270"];
    let verified = topout(verify.iter().chain(&project)).good_json();
    assert_keys(&verified, &["paper_worst_region_px", "worst_px", "findings"]);
    for key in ["structure_violations", "eps_violations", "gamma_violations", "promise_violations"]
    {
        assert_eq!(verified[key], 0, "{key}: {verified}");
    }
    assert_eq!(verified["clusters_checked"], baked["clusters"]);
    assert!(number(&verified, "points_checked") > 20_000.0, "{verified}");
    assert!((0.05..=1.0).contains(&number(&verified, "worst_px")), "{verified}");
}

/// What the tree is like, level by level.
fn levels_are_complete(baked: &serde_json::Value) {
    let levels = baked["level_table"].as_array().unwrap();
    let figures = ["eps_m", "clusters", "mean_degree", "max_degree", "cluster_triangles"];
    let judged = ["triangles", "overlap", "area_kept", "gamma_limit", "gamma_median", "gamma_max"];
    for level in levels {
        assert_keys(level, &figures);
        assert_keys(level, &judged);
    }
    let total = |key: &str| levels.iter().map(|l| number(l, key)).sum::<f64>();
    assert_eq!(total("clusters"), number(baked, "clusters"));
    assert_eq!(total("cluster_triangles"), number(baked, "cluster_triangles"));
    let last = levels.last().unwrap();
    assert_eq!(number(last, "triangles"), number(baked, "root_triangles"));
    assert!(number(last, "area_kept") > 0.05 && number(last, "area_kept") < 1.5, "{last}");
}

/// Tight and paper at two dates and three coverages; the rule in force as in the main table.
fn both_rules_are_compared(report: &serde_json::Value) {
    let rows = report["temporal"].as_array().unwrap();
    let places: Vec<_> = rows
        .iter()
        .map(|c| ["temporal", "time", "coverage"].map(|key| c[key].as_str().unwrap()))
        .collect();
    let mut expected = Vec::new();
    for rule in ["tight", "paper"] {
        for time in ["1/3", "2/3"] {
            expected.extend(["1/1", "1/4", "1/16"].map(|coverage| [rule, time, coverage]));
        }
    }
    assert_eq!(places, expected);
    for row in rows {
        assert_keys(row, &["frame_ms", "triangles", "clusters", "flip", "coverage_change"]);
    }
    let cells = report["cells"].as_array().unwrap();
    let same = |c: &&serde_json::Value| {
        (&c["time"], &c["coverage"], &c["lod"]) == (&"1/3".into(), &"1/4".into(), &"hdlod".into())
    };
    assert_eq!(rows[1]["frame_ms"], cells.iter().find(same).unwrap()["frame_ms"]);
}

/// Five rows; hdlod and batched at three coverages, objects at 1/1 (formats.md).
fn bench_is_complete(report: &serde_json::Value) {
    assert_keys(report, &["adapter", "tolerance_px", "empty_ms", "rss_mb", "gpu_mb"]);
    assert_eq!(report["size"], "320x180");
    let cells = report["cells"].as_array().unwrap();
    let places: BTreeSet<_> = cells
        .iter()
        .map(|c| ["time", "coverage", "lod"].map(|key| c[key].as_str().unwrap().to_owned()))
        .collect();
    let mut expected = BTreeSet::new();
    for time in ["start", "1/3", "2/3", "end", "animation"] {
        for coverage in ["1/1", "1/4", "1/16"] {
            for lod in ["hdlod", "batched", "objects"] {
                if lod != "objects" || coverage == "1/1" {
                    expected.insert([time, coverage, lod].map(str::to_owned));
                }
            }
        }
    }
    assert_eq!(places, expected);
    assert_eq!(cells.len(), expected.len());
    for cell in cells {
        assert_keys(cell, &["p95_ms", "select_ms", "gpu_ms", "draws", "triangles"]);
        // The parts of a frame and nothing else.
        let passes = cell["passes"].as_array().unwrap();
        let sum = |side: &str| passes.iter().filter_map(|p| p[side].as_f64()).sum::<f64>();
        assert!(
            passes.iter().any(|p| p["name"] == "selection" && p["cpu_ms"].is_number()),
            "{cell}"
        );
        assert!(sum("cpu_ms") > 0.0 && sum("gpu_ms") > 0.0, "{cell}");
        assert!(number(cell, "frame_ms") > 0.0, "{cell}");
        let least = match (cell["lod"] == "hdlod", cell["time"] == "animation") {
            (true, true) => 120.0,
            (true, false) => 30.0,
            (false, true) => 12.0,
            (false, false) => 5.0,
        };
        assert!(number(cell, "frames") >= least, "{cell}");
        assert_eq!(cell.get("flip").is_some(), cell["lod"] == "hdlod", "{cell}");
        if cell["lod"] == "hdlod" {
            assert!((0.0..0.25).contains(&number(cell, "flip")), "{cell}");
            assert!(number(cell, "coverage_change").abs() < 0.5, "{cell}");
        }
    }
}

#[test]
fn without_an_adapter_the_code_is_3() {
    let folder = Folder::new();
    let model = folder.cubes("house.glb", &["slab"]);
    let png = text(&folder.path("a.png"));
    let mut blind = command(["render", &model, "--at", "2026-03-03", "-o", &png]);
    // No Vulkan driver and no display to get OpenGL from.
    blind.env("VK_DRIVER_FILES", "/dev/null").env("VK_ICD_FILENAMES", "/dev/null");
    blind.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env("WGPU_BACKEND", "vulkan");
    let end = run(&mut blind);
    assert_eq!(end.code, 3, "{}", end.stderr);
    assert!(end.stderr.contains("graphics adapter"), "{}", end.stderr);
    assert!(!folder.path("a.png").exists());
}

/// A reader that goes away early, like `head`, is no reason to die.
#[test]
fn a_closed_pipe_is_no_error() {
    let folder = Folder::new();
    let model = folder.cubes("house.glb", &["slab"]);
    let mut child = command(["check", &model])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let end = child.wait_with_output().unwrap();
    assert_eq!(end.status.code(), Some(0));
    assert_eq!(String::from_utf8(end.stderr).unwrap(), "");
}
