//! The paper's table (H16), measured on the project at hand.
//!
//! A [`Cell`] of the table is measured by a [`Measurement`], one frame a step, so that a window
//! can go on living between the steps. What is drawn in each frame is decided before, by pure
//! functions of the project and the [`Plan`].

pub mod export;
pub mod table;

use crate::flip::Difference;
use crate::report::rounded;
use glam::UVec2;
use serde::{Serialize, Serializer};
use std::time::Instant;
use topout_render::{DrawMode, FrameInput, FrameStats, FrameTimings, Pass, Renderer};
use topout_scene::{Aabb, NamedView, Progress, Scene, View};
use topout_schedule::{Time, TimeRange};

/// The rows of the table.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Moment {
    /// The first instant.
    Start,
    /// After a third of the period.
    Third,
    /// After two thirds.
    TwoThirds,
    /// One second before the last instant.
    End,
    /// The mean over dates spread over the whole period.
    Animation,
}

impl Moment {
    /// All rows with their names.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::Start, "start"),
        (Self::Third, "1/3"),
        (Self::TwoThirds, "2/3"),
        (Self::End, "end"),
        (Self::Animation, "animation"),
    ];

    /// As the table and JSON say it.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(moment, _)| *moment == self).map_or("", |(_, name)| name)
    }

    /// The instant of a row; `None` for the animation.
    pub fn instant(self, period: TimeRange) -> Option<Time> {
        match self {
            Self::Start => Some(period.start),
            Self::Third => Some(period.at_fraction(1.0 / 3.0)),
            Self::TwoThirds => Some(period.at_fraction(2.0 / 3.0)),
            Self::End => Some(period.end.plus_seconds(-1)),
            Self::Animation => None,
        }
    }
}

/// How much of the screen the building covers.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Coverage {
    /// It just fits.
    Full,
    /// Seen from twice the distance.
    Quarter,
    /// Seen from four times the distance.
    Sixteenth,
}

impl Coverage {
    /// All with their names.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Full, "1/1"), (Self::Quarter, "1/4"), (Self::Sixteenth, "1/16")];

    /// As the table and JSON say it.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(coverage, _)| *coverage == self).map_or("", |(_, name)| name)
    }

    fn distance_factor(self) -> f32 {
        match self {
            Self::Full => 1.0,
            Self::Quarter => 2.0,
            Self::Sixteenth => 4.0,
        }
    }
}

/// The name of a way of drawing.
pub fn mode_name(mode: DrawMode) -> &'static str {
    match mode {
        DrawMode::Hdlod => "hdlod",
        DrawMode::Batched => "batched",
        DrawMode::Objects => "objects",
    }
}

/// Which cell of the table.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct CellKey {
    /// Its row.
    pub moment: Moment,
    /// Its column, together with `mode`.
    pub coverage: Coverage,
    /// Way of drawing.
    pub mode: DrawMode,
}

/// The cells of a table with these ways of drawing, row by row. Like the paper's last column,
/// `Objects` stands at 1/1 alone.
pub fn cells(modes: &[DrawMode]) -> Vec<CellKey> {
    let mut keys = Vec::new();
    for (moment, _) in Moment::ALL {
        for &mode in modes {
            for (coverage, _) in Coverage::ALL {
                if mode != DrawMode::Objects || coverage == Coverage::Full {
                    keys.push(CellKey { moment, coverage, mode });
                }
            }
        }
    }
    keys
}

/// How much is measured.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Plan {
    /// Picture in physical pixels.
    pub size: UVec2,
    /// Tolerance of HDLOD, physical pixels.
    pub tolerance_px: f32,
    /// Frames that are drawn before the first that counts.
    pub warm_up: usize,
    /// Frames of a cell, each from another azimuth.
    pub frames: usize,
    /// Dates of the animation.
    pub dates: usize,
    /// The same two for a baseline that is too slow.
    pub slow: (usize, usize),
    /// A baseline is slow when its whole cell would take longer than this, in seconds.
    pub patience: f64,
    /// Whether pictures are compared by FLIP, which takes about a second a cell.
    pub compare: bool,
}

impl Plan {
    /// What is measured unless something else is asked for.
    pub fn new(size: UVec2, tolerance_px: f32) -> Self {
        Self {
            size,
            tolerance_px,
            warm_up: 2,
            frames: 30,
            dates: 120,
            slow: (5, 12),
            patience: 3.0,
            compare: true,
        }
    }

    fn count(&self, moment: Moment, slow: bool) -> usize {
        match (moment, slow) {
            (Moment::Animation, false) => self.dates,
            (Moment::Animation, true) => self.slow.1,
            (_, false) => self.frames,
            (_, true) => self.slow.0,
        }
    }
}

/// The figures of one cell.
#[derive(Clone, PartialEq, Serialize, Debug)]
pub struct Cell {
    /// Row.
    #[serde(rename = "time", serialize_with = "moment_as_text")]
    pub moment: Moment,
    /// Column.
    #[serde(serialize_with = "coverage_as_text")]
    pub coverage: Coverage,
    /// Column.
    #[serde(rename = "lod", serialize_with = "mode_as_text")]
    pub mode: DrawMode,
    /// From the call to the end of the GPU's work: the median; for the animation, the mean.
    pub frame_ms: f64,
    /// 95th percentile of the same.
    pub p95_ms: f64,
    /// Of that, choosing what to draw.
    pub select_ms: f64,
    /// Of that, the GPU's own time, where it can tell.
    pub gpu_ms: Option<f64>,
    /// Draw commands.
    pub draws: u64,
    /// Triangles of everything in the frame's cut.
    pub triangles: u64,
    /// Triangles of clusters that [`topout_render::Options::occlusion`] left to draw; the others of the cut
    /// nobody sees. `None` where none are left out, or only the adapter knows.
    pub left: Option<u64>,
    /// Clusters drawn.
    pub clusters: u64,
    /// Frames measured.
    pub frames: usize,
    /// Largest certified error of a drawn cluster in any frame, physical pixels.
    pub worst_px: f32,
    /// [`Difference::elements`] between HDLOD and full detail.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flip: Option<f64>,
    /// [`Difference::coverage_change`] between full detail and HDLOD.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage_change: Option<f64>,
    /// What the parts of a frame took, all of [`Pass::ALL`].
    pub passes: Vec<PassFigures>,
}

/// What one part of the frames of a cell took, in milliseconds: as [`Cell::frame_ms`] a median or a mean.
#[derive(Clone, PartialEq, Serialize, Debug)]
pub struct PassFigures {
    /// As in [`Pass::ALL`].
    pub name: &'static str,
    /// On the CPU; `None` where it does not run there.
    pub cpu_ms: Option<f64>,
    /// On the GPU; `None` where it does not run there, or the adapter does not tell.
    pub gpu_ms: Option<f64>,
}

fn moment_as_text<S: Serializer>(moment: &Moment, s: S) -> Result<S::Ok, S::Error> {
    s.serialize_str(moment.name())
}

fn coverage_as_text<S: Serializer>(coverage: &Coverage, s: S) -> Result<S::Ok, S::Error> {
    s.serialize_str(coverage.name())
}

fn mode_as_text<S: Serializer>(mode: &DrawMode, s: S) -> Result<S::Ok, S::Error> {
    s.serialize_str(mode_name(*mode))
}

/// The fractional part of i times the golden ratio: any number of first members are spread evenly.
fn spread(i: usize) -> f32 {
    (i as f64 * 0.618_033_988_749_894_9).fract() as f32
}

/// Azimuths differ by at most this many degrees from the standard one, to either side.
const AZIMUTH_SWING: f32 = 3.0;

/// The standard view of a cell (formats.md: "Views").
pub fn standard_view(focus: &Aabb, coverage: Coverage, plan: &Plan) -> View {
    let (azimuth, elevation) = NamedView::Iso.angles();
    view(focus, azimuth, elevation, coverage, plan)
}

fn view(focus: &Aabb, azimuth: f32, elevation: f32, coverage: Coverage, plan: &Plan) -> View {
    let fit = View::fit(focus, azimuth, elevation, coverage.distance_factor(), plan.size);
    View { tolerance_px: plan.tolerance_px, ..fit }
}

/// The `n` frames of a cell.
///
/// At a date, each is seen from another azimuth. In the animation, the dates are spread evenly
/// over the period and come in an order in which each is a jump from the one before.
fn frames(key: CellKey, n: usize, focus: &Aabb, period: TimeRange, plan: &Plan) -> Vec<FrameInput> {
    let standard = standard_view(focus, key.coverage, plan);
    let Some(time) = key.moment.instant(period) else {
        let dates = jumps(n).into_iter().map(|i| date(i, n, period));
        return dates.map(|time| FrameInput { view: standard, time, mode: key.mode }).collect();
    };
    let (azimuth, elevation) = NamedView::Iso.angles();
    (0..n)
        .map(|i| {
            let azimuth = azimuth + AZIMUTH_SWING * (2.0 * spread(i + 1) - 1.0);
            let view = view(focus, azimuth, elevation, key.coverage, plan);
            FrameInput { view, time, mode: key.mode }
        })
        .collect()
}

/// The i-th of n dates: the middle of the i-th part of the period.
fn date(i: usize, n: usize, period: TimeRange) -> Time {
    period.at_fraction((i as f64 + 0.5) / n as f64)
}

/// An order of 0..n in which neighbours are far apart.
fn jumps(n: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| spread(a).total_cmp(&spread(b)));
    order
}

/// The dates at which a cell's pictures are compared.
fn compared_dates(moment: Moment, period: TimeRange) -> Vec<Time> {
    match moment.instant(period) {
        Some(time) => vec![time],
        None => (0..3).map(|i| date(i, 3, period)).collect(),
    }
}

/// One cell being measured.
#[derive(Debug)]
pub struct Measurement {
    key: CellKey,
    plan: Plan,
    focus: Aabb,
    period: TimeRange,
    inputs: Vec<FrameInput>,
    warm: usize,
    samples: Vec<(f64, FrameStats)>,
    compared: Vec<Difference>,
}

impl Measurement {
    /// Of a scene that the renderer shows already.
    pub fn new(key: CellKey, scene: &Scene, plan: &Plan) -> Self {
        let (focus, period) = (scene.focus_bounds(), scene.schedule.period);
        let n = plan.count(key.moment, false);
        Self {
            key,
            plan: *plan,
            focus,
            period,
            inputs: frames(key, n, &focus, period, plan),
            warm: 0,
            samples: Vec::new(),
            compared: Vec::new(),
        }
    }

    /// Share of the work that is done, in [0, 1].
    pub fn share(&self) -> f32 {
        let total = self.plan.warm_up + self.inputs.len() + self.comparisons().len();
        (self.warm + self.samples.len() + self.compared.len()) as f32 / total.max(1) as f32
    }

    /// Draws one frame, or compares one pair of pictures; false when nothing was left to do.
    ///
    /// # Errors
    /// When the GPU fails.
    pub fn step(&mut self, renderer: &mut Renderer) -> anyhow::Result<bool> {
        if self.warm < self.plan.warm_up {
            // Frames of the animation warm up at the ends of the period, where most is uploaded.
            let input = &self.inputs[self.inputs.len() - 1 - self.warm % self.inputs.len()];
            let (ms, _) = timed(renderer, input);
            self.warm += 1;
            self.save_time(ms);
        } else if self.samples.len() < self.inputs.len() {
            self.samples.push(timed(renderer, &self.inputs[self.samples.len()]));
        } else if self.compared.len() < self.comparisons().len() {
            let time = self.comparisons()[self.compared.len()];
            self.compared.push(self.compare(renderer, time)?);
        } else {
            return Ok(false);
        }
        Ok(true)
    }

    /// Fewer frames for a baseline whose last warm-up frame took so long.
    fn save_time(&mut self, frame_ms: f64) {
        let expected = frame_ms / 1e3 * self.inputs.len() as f64;
        if self.key.mode != DrawMode::Hdlod && expected > self.plan.patience {
            let n = self.plan.count(self.key.moment, true);
            self.inputs = frames(self.key, n, &self.focus, self.period, &self.plan);
            self.warm = self.plan.warm_up;
        }
    }

    fn comparisons(&self) -> Vec<Time> {
        if self.plan.compare && self.key.mode == DrawMode::Hdlod {
            compared_dates(self.key.moment, self.period)
        } else {
            Vec::new()
        }
    }

    fn compare(&self, renderer: &mut Renderer, time: Time) -> anyhow::Result<Difference> {
        let view = standard_view(&self.focus, self.key.coverage, &self.plan);
        let mut picture = |mode| {
            renderer.render(&FrameInput { view, time, mode });
            renderer.read_back()
        };
        let (full, hdlod) = (picture(DrawMode::Batched)?, picture(DrawMode::Hdlod)?);
        Difference::between(&full, &hdlod)
    }

    fn passes(&self) -> Vec<PassFigures> {
        let frames = self.samples.iter().map(|(_, stats)| stats);
        let times = FrameTimings::of_frames(frames, |ms| typical(self.key.moment, ms));
        let rounded = |ms: Option<f64>| ms.map(|ms| rounded(ms, 3));
        let figures = |(pass, name, _)| PassFigures {
            name,
            cpu_ms: rounded(times[pass].cpu_ms),
            gpu_ms: rounded(times[pass].gpu_ms),
        };
        Pass::ALL.map(figures).to_vec()
    }

    /// The figures; `None` before the first frame was measured.
    pub fn finish(&self) -> Option<Cell> {
        let times: Vec<f64> = self.samples.iter().map(|(ms, _)| *ms).collect();
        let middle = |of: fn(&FrameStats) -> f64| {
            typical(self.key.moment, self.samples.iter().map(|(_, s)| of(s)).collect())
        };
        let gpu: Vec<f64> = self.samples.iter().filter_map(|(_, s)| s.gpu_ms).collect();
        let left =
            self.samples.iter().filter_map(|(_, s)| s.left).map(|left| left as f64).collect();
        let difference = (!self.compared.is_empty()).then(|| Difference::mean_of(&self.compared));
        Some(Cell {
            moment: self.key.moment,
            coverage: self.key.coverage,
            mode: self.key.mode,
            p95_ms: rounded(percentile(times.clone(), 0.95)?, 3),
            frame_ms: rounded(typical(self.key.moment, times)?, 3),
            select_ms: rounded(middle(|s| s.select_ms)?, 3),
            gpu_ms: typical(self.key.moment, gpu).map(|ms| rounded(ms, 3)),
            draws: middle(|s| s.draws as f64)? as u64,
            triangles: middle(|s| s.triangles as f64)? as u64,
            left: typical(self.key.moment, left).map(|left| left as u64),
            clusters: middle(|s| s.clusters as f64)? as u64,
            frames: self.samples.len(),
            worst_px: self.samples.iter().fold(0.0, |worst, (_, s)| s.worst_px.max(worst)),
            flip: difference.map(|d| rounded(d.elements.into(), 4)),
            coverage_change: difference.map(|d| rounded(d.coverage_change.into(), 4)),
            passes: self.passes(),
        })
    }
}

/// Measures one cell to its end.
///
/// # Errors
/// When the user cancels or the GPU fails.
pub fn measure(
    renderer: &mut Renderer,
    scene: &Scene,
    key: CellKey,
    plan: &Plan,
    progress: &Progress,
) -> anyhow::Result<Option<Cell>> {
    let mut measurement = Measurement::new(key, scene, plan);
    while measurement.step(renderer)? {
        progress.check()?;
    }
    Ok(measurement.finish())
}

/// The median time of the frame's own passes, in milliseconds. `renderer` must show a scene
/// without elements.
///
/// # Errors
/// When the user cancels or the GPU fails.
pub fn measure_empty(
    renderer: &mut Renderer,
    focus: &Aabb,
    plan: &Plan,
    progress: &Progress,
) -> anyhow::Result<f64> {
    let view = standard_view(focus, Coverage::Full, plan);
    let input = FrameInput { view, time: Time::default(), mode: DrawMode::Batched };
    let mut times = Vec::new();
    for i in 0..plan.warm_up + plan.frames {
        progress.check()?;
        let (ms, _) = timed(renderer, &input);
        if i >= plan.warm_up {
            times.push(ms);
        }
    }
    Ok(rounded(percentile(times, 0.5).unwrap_or_default(), 3))
}

/// One frame, from the call to the end of the GPU's work, in milliseconds.
pub fn timed(renderer: &mut Renderer, input: &FrameInput) -> (f64, FrameStats) {
    let start = Instant::now();
    let mut stats = renderer.render(input);
    renderer.wait_idle();
    let ms = start.elapsed().as_secs_f64() * 1e3;
    for times in renderer.take_gpu_times() {
        stats.add_gpu_times(&times);
    }
    (ms, stats)
}

/// The median of a cell at a date, the mean of the animation; `None` of nothing.
fn typical(moment: Moment, values: Vec<f64>) -> Option<f64> {
    match moment {
        Moment::Animation if values.is_empty() => None,
        Moment::Animation => Some(values.iter().sum::<f64>() / values.len() as f64),
        _ => percentile(values, 0.5),
    }
}

/// The smallest value that is not below the given share of all values; `None` of nothing.
pub(crate) fn percentile(mut values: Vec<f64>, share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let rank = (values.len() as f64 * share).ceil() as usize;
    values.get(rank.max(1) - 1).copied()
}

#[cfg(test)]
pub(crate) mod tests;
