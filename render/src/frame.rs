//! What the shaders know of a frame.

use crate::sun;
use glam::{DVec3, Mat4, Vec2, Vec3, Vec4};
use topout_scene::{Aabb, Clip, Projection, View};

/// The twin of `Frame` in `shaders/common/frame.wgsl`; a test compares the two.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct FrameUniform {
    pub clip_from_world: Mat4,
    pub eye: Vec3,
    pub parallel: f32,
    pub forward: Vec3,
    pub ground: f32,
    pub right: Vec3,
    pub haze_m: f32,
    pub up: Vec3,
    pub grid_m: f32,
    pub sun: Vec3,
    pub height_m: f32,
    pub middle: Vec2,
    pub half_extent: Vec2,
    pub size: Vec2,
    pub bend: f32,
    pub edges: f32,
    pub near: f32,
    pub pixel_m: f32,
    pub grid_from: Vec2,
    pub accent: Vec3,
    pub slack_px: f32,
    pub day: f32,
    pub planes: u32,
    pub padding_x: f32,
    pub padding_y: f32,
    pub section: [Vec4; Clip::MOST],
}

/// Where the ground is: at height zero of the project if the scene reaches below and above it, as
/// with foundations, else at the foot of the scene.
pub(crate) fn ground_height(bounds: &Aabb, origin_height: f64) -> f32 {
    let zero = -origin_height as f32;
    if bounds.min.y < zero && zero < bounds.max.y {
        zero
    } else if bounds.is_empty() {
        0.0
    } else {
        bounds.min.y
    }
}

/// Fine grid lines: a power of ten metres, about a hundredth of the scene.
fn grid_spacing(extent: f32) -> f32 {
    10.0f32.powf((extent.max(1.0) / 40.0).log10().ceil().clamp(-1.0, 4.0))
}

impl FrameUniform {
    /// `bounds` is the box of the scene (any box where there is none), `origin` the place of its zero in
    /// the project, `edges` the strength of the edge lines in [0, 1].
    pub fn new(view: &View, bounds: &Aabb, origin: DVec3, edges: f32) -> Self {
        let ground = ground_height(bounds, origin.y);
        let bounds = if bounds.is_empty() {
            Aabb { min: Vec3::new(-10.0, 0.0, -10.0), max: Vec3::splat(10.0) }
        } else {
            *bounds
        };
        // In parallel projection the whole scene is shown, wherever the eye's plane is.
        let reach =
            bounds.corners().iter().fold(1.0f32, |r, c| r.max(c.distance(view.eye))) * 1.01 + 1.0;
        let forward = view.forward();
        let right = forward.cross(view.up).normalize_or(Vec3::X);
        let up = right.cross(forward);
        let size = view.size.as_vec2();
        let (half_height, parallel, bend) = match view.projection {
            Projection::Perspective { fov_y } => {
                let half = (fov_y * 0.5).tan();
                (half, 0.0, size.y * 0.5 / half)
            }
            Projection::Orthographic { height } => {
                (height * 0.5, 1.0, 2.0 * reach * size.y / height)
            }
        };
        let extent = bounds.size();
        let center = bounds.center();
        let grid_m = grid_spacing(extent.x.max(extent.z));
        let along = |metres: f64| metres.rem_euclid(f64::from(grid_m) * 10.0) as f32;
        Self {
            clip_from_world: view.clip_from_world(reach),
            eye: view.eye,
            parallel,
            forward,
            ground,
            right: right * half_height * view.aspect(),
            // Distance from the eye means nothing where rays are parallel.
            haze_m: if parallel > 0.5 { f32::MAX } else { bounds.diameter().max(1.0) * 30.0 },
            up: up * half_height,
            grid_m,
            sun: sun::fixed(),
            height_m: (bounds.max.y - ground).max(1.0),
            middle: Vec2::new(center.x, center.z),
            half_extent: Vec2::new(extent.x, extent.z) * 0.5,
            size,
            bend,
            edges,
            near: view.near(),
            pixel_m: 2.0 * half_height / size.y,
            grid_from: Vec2::new(along(origin.x), along(origin.z)),
            accent: Vec3::ZERO,
            // What is drawn and what is selected may both be off, and by half a pixel more.
            slack_px: 1.0 + 2.0 * view.tolerance_px,
            day: 1.0,
            planes: view.clip.planes().len() as u32,
            padding_x: 0.0,
            padding_y: 0.0,
            section: std::array::from_fn(|i| {
                view.clip.planes().get(i).copied().unwrap_or_default()
            }),
        }
    }

    /// Whether the ground's upper side is towards the eye.
    pub fn sees_ground_from_above(&self) -> bool {
        if self.parallel > 0.5 { self.forward.y < 0.0 } else { self.eye.y > self.ground }
    }
}

/// The part of the picture that what is in a box can cover, drawn with an error of at most
/// `tolerance_px`, as x, y, width and height in pixels. `None` if it covers nothing.
pub(crate) fn covered_rectangle(
    frame: &FrameUniform,
    bounds: &Aabb,
    tolerance_px: f32,
) -> Option<[u32; 4]> {
    /// Smoothing looks this far.
    const MARGIN_PX: f32 = 4.0;
    let margin = MARGIN_PX + tolerance_px.max(0.0);
    if bounds.is_empty() {
        return None;
    }
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    for corner in bounds.corners() {
        let clip = frame.clip_from_world * corner.extend(1.0);
        if clip.w <= frame.near {
            // Partly behind the eye: it may be anywhere.
            (low, high) = (Vec2::ZERO, frame.size);
            break;
        }
        let at = (Vec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5) * frame.size;
        (low, high) = (low.min(at), high.max(at));
    }
    let low = (low - margin).floor().clamp(Vec2::ZERO, frame.size).as_uvec2();
    let high = (high + margin).ceil().clamp(Vec2::ZERO, frame.size).as_uvec2();
    let extent = high.saturating_sub(low);
    (extent.x > 0 && extent.y > 0).then_some([low.x, low.y, extent.x, extent.y])
}
