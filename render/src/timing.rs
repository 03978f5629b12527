//! What the parts of a frame take: on the CPU by the clock, on the GPU by timestamps where the adapter
//! has them.

use crate::gpu::Gpu;
use crate::input::FrameStats;
use std::collections::VecDeque;
use std::ops::Index;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::Instant;
use wgpu::BufferUsages;

/// A part of a frame that is timed.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Pass {
    /// Choosing what to draw.
    Select,
    /// Bringing camera and commands to the GPU.
    Upload,
    /// Gathering what was seen in the frame before.
    Recall,
    /// Drawing the depth of that.
    Occluders,
    /// Leaving out triangles that nobody sees.
    Cull,
    /// Drawing everything solid, ground and sky.
    Scene,
    /// Drawing glass over a copy of that.
    Glass,
    /// Smoothing and edge lines.
    Finish,
    /// Bringing what was smoothed back into the picture.
    Copy,
    /// Drawing the line around what is selected.
    Outline,
    /// Handing the commands to the driver.
    Submit,
}

impl Pass {
    /// All in the order of a frame, with their names and what they do, for people.
    pub const ALL: [(Self, &'static str, &'static str); 11] = [
        (
            Self::Select,
            "selection",
            "Choosing what to draw: what is there and in the frame, and how coarse.",
        ),
        (Self::Upload, "upload", "Bringing the camera and the draw commands to the GPU."),
        (Self::Recall, "recall", "Gathering the triangles that were seen in the frame before."),
        (Self::Occluders, "occluders", "Drawing the depth of what was seen in the frame before."),
        (
            Self::Cull,
            "culling",
            "Leaving out triangles that nobody sees, by threads or by the adapter.",
        ),
        (Self::Scene, "scene", "Drawing everything solid, ground and sky."),
        (Self::Glass, "glass", "Drawing the nearest glass over a copy of what is behind."),
        (Self::Finish, "finish", "Smoothing stairs and drawing the edge lines."),
        (Self::Copy, "copy", "Bringing the smoothed part back into the picture."),
        (Self::Outline, "outline", "Drawing the line around what is selected."),
        (Self::Submit, "submit", "Handing the commands to the graphics driver."),
    ];
    const COUNT: usize = Self::ALL.len();
}

/// Milliseconds that a part of a frame took; `None` where it did not run there, or nobody can tell.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct PassTime {
    /// On the CPU. What one pass after the other takes there adds up to the frame's share.
    pub cpu_ms: Option<f64>,
    /// On the GPU, from the beginning of the pass to its end.
    pub gpu_ms: Option<f64>,
}

/// The times of every [`Pass`] of a frame.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct FrameTimings([PassTime; Pass::COUNT]);

impl Index<Pass> for FrameTimings {
    type Output = PassTime;

    fn index(&self, pass: Pass) -> &PassTime {
        &self.0[pass as usize]
    }
}

impl FrameTimings {
    /// Milliseconds of all passes on the CPU.
    pub fn cpu_ms(&self) -> f64 {
        self.0.iter().filter_map(|time| time.cpu_ms).sum()
    }

    /// Of each pass what `middle` makes of its times in all frames. A frame in which a pass did not run
    /// counts as 0 for it; `None` where it ran in none.
    pub fn of_frames<'a>(
        frames: impl Iterator<Item = &'a FrameStats> + Clone,
        middle: impl Fn(Vec<f64>) -> Option<f64>,
    ) -> Self {
        let side = |times: Vec<Option<f64>>| {
            let ran = times.iter().any(Option::is_some);
            ran.then(|| middle(times.into_iter().map(Option::unwrap_or_default).collect()))
                .flatten()
        };
        // Of some frames the GPU may not have told anything.
        let told = frames.clone().filter(|stats| stats.gpu_ms.is_some());
        Self(std::array::from_fn(|i| PassTime {
            cpu_ms: side(frames.clone().map(|stats| stats.passes.0[i].cpu_ms).collect()),
            gpu_ms: side(told.clone().map(|stats| stats.passes.0[i].gpu_ms).collect()),
        }))
    }

    /// Takes over what the GPU took.
    pub(crate) fn set_gpu(&mut self, gpu_ms: &[Option<f64>; Pass::COUNT]) {
        for (time, ms) in self.0.iter_mut().zip(gpu_ms) {
            time.gpu_ms = *ms;
        }
    }
}

/// What the GPU took for a frame, known some time after the frame was asked for.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct GpuTimes {
    /// [`crate::FrameStats::frame`] of that frame.
    pub frame: u64,
    /// Milliseconds from the beginning of its first pass to the end of the last.
    pub frame_ms: f64,
    /// Milliseconds of each [`Pass`], in the order of [`Pass::ALL`]; `None` for those that did not run.
    pub passes: [Option<f64>; Pass::COUNT],
}

/// A watch for the CPU's part of a frame.
#[derive(Debug)]
pub(crate) struct Laps {
    pub timings: FrameTimings,
    since: Instant,
}

impl Laps {
    pub fn start() -> Self {
        Self { timings: FrameTimings::default(), since: Instant::now() }
    }

    /// Counts the time since the last call for a pass.
    pub fn end(&mut self, pass: Pass) {
        let now = Instant::now();
        let ms = (now - self.since).as_secs_f64() * 1e3;
        *self.timings.0[pass as usize].cpu_ms.get_or_insert(0.0) += ms;
        self.since = now;
    }
}

/// Bytes between the stamps of two passes: what a copy of stamps must be aligned to.
const STRIDE: u64 = wgpu::QUERY_RESOLVE_BUFFER_ALIGNMENT;
const BYTES: u64 = Pass::COUNT as u64 * STRIDE;
/// Frames whose stamps can be under way at a time; those of more are not taken.
const UNDER_WAY: usize = 3;

/// Two stamps a pass: at its beginning and at its end.
#[derive(Debug)]
pub(crate) struct GpuTimer {
    device: wgpu::Device,
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    read_backs: Vec<ReadBack>,
    /// Nanoseconds a tick.
    period_ns: f64,
    /// Whether there can be stamps outside passes.
    between_passes: bool,
    /// The read-back of the frame that is being encoded; `None`: it is not timed.
    current: Option<usize>,
    /// Passes stamped in it, one bit each.
    ran: AtomicU32,
    arrived: VecDeque<GpuTimes>,
    latest: Option<GpuTimes>,
}

/// Where the stamps of one frame come back to the CPU.
#[derive(Debug)]
struct ReadBack {
    mapped: wgpu::Buffer,
    state: State,
    ready: Arc<AtomicBool>,
    frame: u64,
    ran: u32,
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum State {
    /// The buffer is free.
    Idle,
    /// This frame's stamps are being copied into it.
    Copying,
    /// It is being mapped.
    Mapping,
}

impl GpuTimer {
    /// `None` where the adapter has no timestamps.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        if !gpu.has(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let read_back = || {
            let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
            let mapped = gpu.buffer("timestamps read back", BYTES, usage).ok()?;
            Some(ReadBack { mapped, state: State::Idle, ready: Arc::default(), frame: 0, ran: 0 })
        };
        let usage = BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC;
        Some(Self {
            device: gpu.device.clone(),
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("frame timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * Pass::COUNT as u32,
            }),
            resolved: gpu.buffer("timestamps", BYTES, usage).ok()?,
            read_backs: (0..UNDER_WAY).map(|_| read_back()).collect::<Option<_>>()?,
            period_ns: f64::from(gpu.queue.get_timestamp_period()),
            between_passes: gpu.has(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS),
            current: None,
            ran: AtomicU32::new(0),
            arrived: VecDeque::new(),
            latest: None,
        })
    }

    /// What is stamped from now on belongs to the frame of this number.
    pub fn begin_frame(&mut self, frame: u64) {
        self.collect();
        self.current = self.read_backs.iter().position(|r| r.state == State::Idle);
        *self.ran.get_mut() = 0;
        if let Some(read_back) = self.current.map(|i| &mut self.read_backs[i]) {
            read_back.frame = frame;
        }
    }

    /// Where the stamps of a pass go; `None` where the frame is not timed.
    fn stamps(&self, pass: Pass) -> Option<[u32; 2]> {
        self.current?;
        self.ran.fetch_or(1 << pass as u32, Ordering::Relaxed);
        let first = 2 * pass as u32;
        Some([first, first + 1])
    }

    /// The stamps of a render pass.
    pub fn of_render(&self, pass: Pass) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.stamps(pass).map(|[begin, end]| wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(end),
        })
    }

    /// The stamps of a pass of kernels.
    pub fn of_kernels(&self, pass: Pass) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        self.stamps(pass).map(|[begin, end]| wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(end),
        })
    }

    /// Stamps `work`, commands outside passes, where the adapter can.
    pub fn around(
        timer: Option<&Self>,
        pass: Pass,
        encoder: &mut wgpu::CommandEncoder,
        work: impl FnOnce(&mut wgpu::CommandEncoder),
    ) {
        let stamped = timer.filter(|t| t.between_passes).and_then(|t| Some((t, t.stamps(pass)?)));
        if let Some((timer, [begin, _])) = stamped {
            encoder.write_timestamp(&timer.queries, begin);
        }
        work(encoder);
        if let Some((timer, [_, end])) = stamped {
            encoder.write_timestamp(&timer.queries, end);
        }
    }

    /// Copies the stamps at the end of a frame.
    pub fn resolve(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let Some(read_back) = self.current.map(|i| &mut self.read_backs[i]) else { return };
        read_back.ran = *self.ran.get_mut();
        for pass in passes(read_back.ran) {
            let first = 2 * pass as u32;
            let at = pass as u64 * STRIDE;
            encoder.resolve_query_set(&self.queries, first..first + 2, &self.resolved, at);
        }
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &read_back.mapped, 0, BYTES);
        read_back.state = State::Copying;
    }

    /// Asks for the copied stamps, once the frame is submitted.
    pub fn submitted(&mut self) {
        for read_back in self.read_backs.iter_mut().filter(|r| r.state == State::Copying) {
            read_back.state = State::Mapping;
            let ready = Arc::clone(&read_back.ready);
            read_back.mapped.map_async(wgpu::MapMode::Read, .., move |result| {
                if result.is_ok() {
                    ready.store(true, Ordering::Release);
                }
            });
        }
    }

    /// Whether times of some frame are still to come.
    pub fn is_under_way(&self) -> bool {
        self.read_backs.iter().any(|r| r.state == State::Mapping)
    }

    /// The latest frame whose times have arrived.
    pub fn latest(&mut self) -> Option<GpuTimes> {
        self.collect();
        self.latest
    }

    /// The times that have arrived since the last call.
    pub fn take(&mut self) -> Vec<GpuTimes> {
        self.collect();
        self.arrived.drain(..).collect()
    }

    /// Takes over stamps that have come back.
    fn collect(&mut self) {
        if !self.is_under_way() {
            return;
        }
        // An error here is that of a lost device, which the next submission reports.
        let _ = self.device.poll(wgpu::PollType::Poll);
        for read_back in self.read_backs.iter_mut().filter(|r| r.state == State::Mapping) {
            if !read_back.ready.swap(false, Ordering::Acquire) {
                continue;
            }
            if let Some(times) = read_back.times(self.period_ns) {
                if self.arrived.len() == UNDER_WAY {
                    self.arrived.pop_front();
                }
                self.arrived.push_back(times);
                self.latest = self.latest.filter(|l| l.frame > times.frame).or(Some(times));
            }
            read_back.mapped.unmap();
            read_back.state = State::Idle;
        }
    }
}

impl ReadBack {
    /// What the stamps in the mapped buffer say.
    fn times(&self, period_ns: f64) -> Option<GpuTimes> {
        let bytes = self.mapped.get_mapped_range(..).ok()?;
        let stamp = |at: usize| bytemuck::pod_read_unaligned::<u64>(&bytes[at..at + 8]);
        let ms = |from: u64, to: u64| to.saturating_sub(from) as f64 * period_ns * 1e-6;
        let mut times = GpuTimes { frame: self.frame, frame_ms: 0.0, passes: Default::default() };
        let (mut first, mut last) = (u64::MAX, 0);
        for pass in passes(self.ran) {
            let at = pass * STRIDE as usize;
            let (begin, end) = (stamp(at), stamp(at + 8));
            times.passes[pass] = Some(ms(begin, end));
            (first, last) = (first.min(begin), last.max(end));
        }
        times.frame_ms = ms(first, last);
        Some(times)
    }
}

/// The numbers of the bits that are set.
fn passes(ran: u32) -> impl Iterator<Item = usize> {
    (0..Pass::COUNT).filter(move |pass| ran >> pass & 1 == 1)
}
