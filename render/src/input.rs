//! What a renderer is told, and what it answers.

use crate::gpu::Gpu;
use crate::sun::Sun;
use crate::timing::{FrameTimings, GpuTimes};
use std::time::Duration;
use topout_scene::View;
use topout_schedule::Time;

/// How the picture is made of the scene.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum DrawMode {
    /// The cut of the HDLOD; [`DrawMode::Batched`] as long as there is none.
    #[default]
    Hdlod,
    /// Every present element inside the frame at full detail, one indirect multi-draw a layer:
    /// what a good engineer would do without HDLOD (R12).
    Batched,
    /// Every present element inside the frame with draw calls and state of its own: the paper's
    /// baseline (R12).
    Objects,
}

/// How edges are kept from looking like stairs.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Antialias {
    /// Not at all.
    Off,
    /// By a blend along edges in the last pass; cheap also in software.
    Smooth,
    /// By four samples a pixel; a factor 2 to 3 in software.
    Msaa4,
}

/// Where it is found out which triangles nobody sees.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Occlusion {
    /// Nowhere: all are drawn.
    Off,
    /// By threads of this program: for software adapters.
    Cpu,
    /// By kernels on the adapter.
    Gpu,
}

/// What stands behind the scene.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Backdrop {
    /// Sky and ground.
    #[default]
    Scenery,
    /// One sRGB colour. Light and mirrors stay those of the scenery, so over two such colours a picture differs
    /// by what shines through alone.
    Plain([u8; 3]),
}

/// Settings that seldom change.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Options {
    /// Chosen by the kind of adapter unless overridden.
    pub antialias: Antialias,
    /// Strength of the thin edge lines in [0, 1]; 0 for none.
    pub edges: f32,
    /// Where the light comes from.
    pub sun: Sun,
    /// Whether elements outside the frame are left out by the CPU. Off only to test that it makes
    /// no difference.
    pub culling: bool,
    /// Whether triangles of clusters that nobody sees are left out, and where that is found out. No
    /// picture depends on it.
    pub occlusion: Occlusion,
    /// For how long levels that follow each other share the pixels; zero: they follow at once.
    pub fade: Duration,
    /// What stands behind the scene.
    pub backdrop: Backdrop,
}

impl Options {
    /// Whether levels share pixels.
    pub(crate) fn fades(&self) -> bool {
        !self.fade.is_zero()
    }

    /// What suits the adapter.
    pub fn for_gpu(gpu: &Gpu) -> Self {
        let antialias = if gpu.is_software() { Antialias::Smooth } else { Antialias::Msaa4 };
        let occlusion = if gpu.is_software() { Occlusion::Cpu } else { Occlusion::Gpu };
        Self {
            antialias,
            edges: 0.35,
            sun: Sun::Fixed,
            culling: true,
            occlusion,
            fade: Duration::ZERO,
            backdrop: Backdrop::Scenery,
        }
    }
}

/// What to show.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FrameInput {
    /// Camera, size of the picture and tolerance.
    pub view: View,
    /// The instant that is shown.
    pub time: Time,
    /// How.
    pub mode: DrawMode,
}

/// What a frame cost and drew.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct FrameStats {
    /// Its number among the frames of its renderer, from 1 on.
    pub frame: u64,
    /// Milliseconds of choosing what to draw: the cut, or presence and frustum.
    pub select_ms: f64,
    /// Milliseconds of writing and encoding commands, on the CPU.
    pub cpu_ms: f64,
    /// Milliseconds on the GPU; `None` until [`FrameStats::add_gpu_times`], since the GPU is still at
    /// work when a frame is returned, and always without timestamps.
    pub gpu_ms: Option<f64>,
    /// What its parts took.
    pub passes: FrameTimings,
    /// Draw commands, those of one multi-draw counted each.
    pub draws: u64,
    /// Triangles of everything that is in the frame's cut.
    pub triangles: u64,
    /// Triangles of clusters that were left to draw after [`Options::occlusion`]; `None` where none are
    /// left out, or only the adapter knows.
    pub left: Option<u64>,
    /// Clusters drawn.
    pub clusters: u32,
    /// Elements drawn exactly.
    pub elements: u32,
    /// Subtrees in which two levels share the pixels, see [`Options::fade`]: while there are any the next
    /// picture will be another.
    pub fading: u32,
    /// Nodes looked at in the selection; elements looked at in the other modes.
    pub visited: u32,
    /// Largest certified error of a drawn cluster, physical pixels.
    pub worst_px: f32,
}

impl FrameStats {
    /// Takes over what the GPU took, if that is of this frame; says whether it is.
    pub fn add_gpu_times(&mut self, times: &GpuTimes) -> bool {
        let same = times.frame == self.frame;
        if same {
            self.gpu_ms = Some(times.frame_ms);
            self.passes.set_gpu(&times.passes);
        }
        same
    }
}
