//! `topout render`: one picture at a date.

use super::stage::{Stage, view};
use super::{Outcome, args};
use crate::bench::{mode_name, timed};
use crate::flip::rgb;
use crate::report::{Output, grouped, rounded};
use anyhow::Context;
use serde::Serialize;
use serde_json::{Map, Value};
use std::fmt::Write;
use std::path::Path;
use std::time::{Duration, Instant};
use topout_render::{FrameInput, FrameStats, Options, Picture, Renderer};
use topout_scene::{ElementId, Scene};
use topout_schedule::Time;

/// The keys that scripts read.
#[derive(Serialize, Debug)]
struct Report {
    file: String,
    at: String,
    lod: &'static str,
    adapter: String,
    present_elements: usize,
    present_triangles: usize,
    load_seconds: f64,
    bake_seconds: Option<f64>,
    cache_hit: bool,
    first_picture_seconds: f64,
    frame_ms: f64,
    select_ms: f64,
    gpu_ms: Option<f64>,
    draws: u64,
    triangles: u64,
    clusters: u64,
    worst_px: f32,
    /// Seconds of each step to the first picture, in order.
    phases: Map<String, Value>,
}

/// Colour of the line around what `--select` names: the accent of the window's dark theme.
const OUTLINE: [u8; 3] = [0x5B, 0x9D, 0xFF];

/// Draws, saves and reports. `started` is the start of the process.
pub fn run(args: &args::Render, started: Instant) -> anyhow::Result<Outcome> {
    let output = Output::new(args.common.json.clone());
    let mode = args.common.lod.unwrap_or(args::Lod::Hdlod).into();
    let mut stage = Stage::set(&args.common, &[mode], args.caching.cache())?;
    if args.color_levels {
        stage.color_levels().context("cannot bring the coloured tree onto the GPU")?;
    }
    if let Some(sun) = args.sun {
        let options = stage.renderer.options();
        stage.renderer.set_options(Options { sun, ..options });
    }
    if let Some(name) = &args.select {
        stage.renderer.set_selection(&named(&stage.scene, name)?, OUTLINE);
    }
    let input = FrameInput { view: view(args, &stage.scene)?, time: args.at, mode };
    let renderer = &mut stage.renderer;
    let picture = stage.phases.time("first picture", || {
        renderer.render(&input);
        renderer.read_back()
    })?;
    let first_picture = started.elapsed();
    let (frame_ms, stats) = steady_frame(&mut stage.renderer, &input);
    save(&picture, &args.output)?;
    stage.keep_tree();
    let report = Report::of(&stage, &input, args, first_picture, frame_ms, &stats);
    output.say(&report.text());
    output.write(&report)?;
    Ok(Outcome::Fine)
}

/// Elements that are called so.
fn named(scene: &Scene, name: &str) -> anyhow::Result<Vec<ElementId>> {
    let found: Vec<ElementId> = (0u32..)
        .zip(&scene.model.elements)
        .filter(|(_, e)| {
            [&e.name, &e.label, &e.kind].into_iter().chain(&e.guid).any(|text| text == name)
        })
        .map(|(id, _)| ElementId(id))
        .collect();
    anyhow::ensure!(!found.is_empty(), "--select: no element is called {name:?}");
    Ok(found)
}

/// The shortest of a few frames in milliseconds, and what was drawn in it.
fn steady_frame(renderer: &mut Renderer, input: &FrameInput) -> (f64, FrameStats) {
    let began = Instant::now();
    let mut best: Option<(f64, FrameStats)> = None;
    for _ in 0..5 {
        let (ms, stats) = timed(renderer, input);
        if best.as_ref().is_none_or(|(least, _)| ms < *least) {
            best = Some((ms, stats));
        }
        if began.elapsed() > Duration::from_secs(1) {
            break;
        }
    }
    best.unwrap_or_default()
}

/// Writes an opaque PNG.
fn save(picture: &Picture, path: &Path) -> anyhow::Result<()> {
    let pixels = rgb(picture);
    image::save_buffer_with_format(
        path,
        &pixels,
        picture.width,
        picture.height,
        image::ExtendedColorType::Rgb8,
        image::ImageFormat::Png,
    )
    .with_context(|| format!("cannot write {}", path.display()))
}

/// Elements that are there at a date, and their triangles.
fn present(scene: &Scene, at: Time) -> (usize, usize) {
    scene
        .model
        .elements
        .iter()
        .enumerate()
        .filter(|(i, _)| scene.behaviour(ElementId(*i as u32)).at(at))
        .fold((0, 0), |(n, triangles), (_, e)| (n + 1, triangles + scene.model.triangles_of(e)))
}

impl Report {
    fn of(
        stage: &Stage,
        input: &FrameInput,
        args: &args::Render,
        first_picture: Duration,
        frame_ms: f64,
        stats: &FrameStats,
    ) -> Self {
        let (present_elements, present_triangles) = present(&stage.scene, input.time);
        Self {
            file: args.output.display().to_string(),
            at: input.time.to_string(),
            lod: mode_name(input.mode),
            adapter: stage.gpu.info.name.clone(),
            present_elements,
            present_triangles,
            load_seconds: rounded(stage.load_seconds, 3),
            bake_seconds: stage.bake_seconds(),
            cache_hit: stage.cache_hit(),
            first_picture_seconds: rounded(first_picture.as_secs_f64(), 3),
            frame_ms: rounded(frame_ms, 3),
            select_ms: rounded(stats.select_ms, 3),
            gpu_ms: stats.gpu_ms.map(|ms| rounded(ms, 3)),
            draws: stats.draws,
            triangles: stats.triangles,
            clusters: stats.clusters.into(),
            worst_px: stats.worst_px,
            phases: stage.phases.as_json(),
        }
    }

    fn text(&self) -> String {
        let promise = match self.lod {
            "hdlod" => format!(
                " in {} clusters, at most {:.2} px off",
                grouped(self.clusters),
                self.worst_px
            ),
            _ => String::new(),
        };
        let mut phases = String::new();
        for (name, seconds) in &self.phases {
            let _ = write!(phases, "\n    {name:<30}{:>7.2}", seconds.as_f64().unwrap_or_default());
        }
        format!(
            "{file}\n  at       {at}: {elements} elements of {whole} triangles are there\n  \
             drawn    {triangles} triangles{promise}\n  frame    {frame:.1} ms with {lod} on \
             {adapter}\n  start    {load:.1} s to load, {first:.1} s to the picture{phases}",
            file = self.file,
            at = self.at,
            elements = grouped(self.present_elements as u64),
            whole = grouped(self.present_triangles as u64),
            triangles = grouped(self.triangles),
            frame = self.frame_ms,
            lod = self.lod,
            adapter = self.adapter,
            load = self.load_seconds,
            first = self.first_picture_seconds,
        )
    }
}
