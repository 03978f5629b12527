//! `topout render`: one picture at a date.

use super::stage::{Stage, colored, view};
use super::{Outcome, args};
use crate::bench::{mode_name, timed};
use crate::flip::{Difference, rgb};
use crate::ideal::ideal;
use crate::output::{Background, Caption, Scribe, Studio};
use crate::report::{Output, grouped, rounded};
use anyhow::Context;
use image::ExtendedColorType;
use serde::Serialize;
use serde_json::{Map, Value};
use std::fmt::Write;
use std::path::Path;
use std::time::{Duration, Instant};
use topout_render::{DrawMode, FrameInput, FrameStats, Picture, Renderer};
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
    /// With --compare.
    #[serde(flatten)]
    flip: Option<Flip>,
    /// Seconds of each step to the first picture, in order.
    phases: Map<String, Value>,
}

/// Mean FLIP over the pixels that show an element.
#[derive(Serialize, Debug)]
struct Flip {
    /// Between the picture and full detail.
    flip: f64,
    /// Between the picture and full detail with many samples a pixel.
    flip_ideal: Option<f64>,
    /// Between full detail and the same with many samples a pixel.
    flip_full_ideal: Option<f64>,
}

impl Flip {
    fn of(
        difference: &Difference,
        full: &Picture,
        picture: &Picture,
        ideal: Option<&Picture>,
    ) -> anyhow::Result<Self> {
        let figure = |d: &Difference| rounded(f64::from(d.elements), 4);
        let against =
            |test| ideal.map(|ideal| Ok(figure(&Difference::between(ideal, test)?))).transpose();
        let (flip_ideal, flip_full_ideal): (_, anyhow::Result<_>) =
            (against(picture), against(full));
        Ok(Self {
            flip: figure(difference),
            flip_ideal: flip_ideal?,
            flip_full_ideal: flip_full_ideal?,
        })
    }

    fn text(&self) -> String {
        let ideal = self.flip_ideal.zip(self.flip_full_ideal).map(|(picture, full)| {
            format!("; from many samples a pixel {picture:.3}, full detail {full:.3}")
        });
        format!("\n  FLIP     {:.3} from full detail{}", self.flip, ideal.unwrap_or_default())
    }
}

/// Draws, saves and reports. `started` is the start of the process.
pub fn run(args: &args::Render, started: Instant) -> anyhow::Result<Outcome> {
    let output = Output::new(args.common.json.clone());
    let mode = args.common.lod.unwrap_or(args::Lod::Hdlod).into();
    let mut stage = Stage::set(&args.common, &[mode], args.caching.cache())?;
    stage.dress(&args.looking)?;
    let view = view(&args.common, &args.looking, &stage.scene)?;
    let input = FrameInput { view, time: args.at, mode };
    let background: Background = args.looking.background.into();
    let renderer = &mut stage.renderer;
    let mut picture = stage.phases.time("first picture", || match args.compare {
        true => {
            renderer.render(&input);
            renderer.read_back()
        }
        false => Studio::new(renderer, background).shoot(&input).map(|(picture, _)| picture),
    })?;
    if args.caption {
        let caption = Caption::at(&stage.scene, args.at, colored(args.common.colors));
        Scribe::new().draw(&caption, &mut picture);
    }
    let first_picture = started.elapsed();
    let (frame_ms, stats) = steady_frame(&mut stage.renderer, &input);
    let flip = if args.compare {
        let full = full_detail(&mut stage.renderer, &input)?;
        let (difference, colors) = Difference::with_colors(&full, &picture)?;
        let parts = [rgb(&full), rgb(&picture), colors];
        let size = [picture.width * 3, picture.height];
        save(&beside(&parts, picture.width), size, ExtendedColorType::Rgb8, &args.output)?;
        let ideal = ideal(&mut stage.renderer, &input)?;
        Some(Flip::of(&difference, &full, &picture, ideal.as_ref())?)
    } else {
        let size = [picture.width, picture.height];
        match background {
            Background::Transparent => {
                save(&picture.rgba, size, ExtendedColorType::Rgba8, &args.output)?;
            }
            _ => save(&rgb(&picture), size, ExtendedColorType::Rgb8, &args.output)?,
        }
        None
    };
    stage.keep_tree();
    let report =
        Report { flip, ..Report::of(&stage, &input, args, first_picture, frame_ms, &stats) };
    output.say(&report.text());
    output.write(&report)?;
    Ok(Outcome::Fine)
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

/// The same with every element that is there.
fn full_detail(renderer: &mut Renderer, input: &FrameInput) -> anyhow::Result<Picture> {
    renderer.render(&FrameInput { mode: DrawMode::Batched, ..*input });
    Ok(renderer.read_back()?)
}

/// Pictures of one size, of three bytes a pixel, from left to right.
fn beside(parts: &[Vec<u8>; 3], width: u32) -> Vec<u8> {
    let row = (width as usize * 3).max(1);
    let rows = parts[0].chunks(row).zip(parts[1].chunks(row)).zip(parts[2].chunks(row));
    rows.flat_map(|((a, b), c)| [a, b, c].concat()).collect()
}

/// Writes a PNG.
fn save(
    bytes: &[u8],
    [width, height]: [u32; 2],
    color: ExtendedColorType,
    path: &Path,
) -> anyhow::Result<()> {
    image::save_buffer_with_format(path, bytes, width, height, color, image::ImageFormat::Png)
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
            flip: None,
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
        let flip = self.flip.as_ref().map(Flip::text).unwrap_or_default();
        let mut phases = String::new();
        for (name, seconds) in &self.phases {
            let _ = write!(phases, "\n    {name:<30}{:>7.2}", seconds.as_f64().unwrap_or_default());
        }
        format!(
            "{file}\n  at       {at}: {elements} elements of {whole} triangles are there\n  \
             drawn    {triangles} triangles{promise}{flip}\n  frame    {frame:.1} ms with {lod} on \
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
