//! The camera, its picture, and what an error in metres means in pixels.

use crate::{Aabb, Clip};
use glam::camera::rh::{proj::directx, view};
use glam::{Mat3, Mat4, UVec2, Vec2, Vec3, Vec4};

/// How space is brought onto the picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Projection {
    /// Vertical field of view in radians.
    Perspective {
        /// Vertical field of view in radians.
        fov_y: f32,
    },
    /// Parallel rays.
    Orthographic {
        /// Height of the picture in metres.
        height: f32,
    },
}

/// Camera, section, picture size and tolerance: everything that a selection depends on besides the date.
///
/// Up is +Y. The picture is `size` physical pixels; depth is reversed (1 near, 0 far).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct View {
    /// Where the camera stands, metres in local space.
    pub eye: Vec3,
    /// What it looks at.
    pub target: Vec3,
    /// Roughly upward; must not be parallel to the line of sight.
    pub up: Vec3,
    /// Kind of projection.
    pub projection: Projection,
    /// Picture in physical pixels, at least 1 x 1.
    pub size: UVec2,
    /// Largest error allowed on the picture, physical pixels.
    pub tolerance_px: f32,
    /// The part of space that is shown.
    pub clip: Clip,
}

/// The standard directions of `--view` and of the axis buttons.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum NamedView {
    /// From +Z.
    Front,
    /// From -Z.
    Back,
    /// From -X.
    Left,
    /// From +X.
    Right,
    /// From +Y.
    Top,
    /// Azimuth 30 degrees from +Z towards +X, elevation 20 degrees.
    Iso,
}

impl NamedView {
    /// Every standard view with its name.
    pub const ALL: [(Self, &'static str); 6] = [
        (Self::Front, "front"),
        (Self::Back, "back"),
        (Self::Left, "left"),
        (Self::Right, "right"),
        (Self::Top, "top"),
        (Self::Iso, "iso"),
    ];

    /// Azimuth and elevation in degrees.
    pub fn angles(self) -> (f32, f32) {
        match self {
            Self::Front => (0.0, 0.0),
            Self::Back => (180.0, 0.0),
            Self::Left => (-90.0, 0.0),
            Self::Right => (90.0, 0.0),
            Self::Top => (0.0, 90.0),
            Self::Iso => (30.0, 20.0),
        }
    }
}

impl View {
    /// Vertical field of view of the standard views: 45 degrees.
    pub const FOV_Y: f32 = std::f32::consts::FRAC_PI_4;

    /// Looks at the centre of `focus` from an azimuth (from +Z towards +X) and elevation in
    /// degrees, at `distance_factor` times the smallest distance at which every corner of the box
    /// is inside the frame (1, 2 and 4 are the paper's 1/1, 1/4 and 1/16).
    pub fn fit(
        focus: &Aabb,
        azimuth: f32,
        elevation: f32,
        distance_factor: f32,
        size: UVec2,
    ) -> Self {
        let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
        let backward = Vec3::new(
            azimuth.sin() * elevation.cos(),
            elevation.sin(),
            azimuth.cos() * elevation.cos(),
        );
        // The derivative of `backward` by elevation: never parallel to it, also looking straight down.
        let up = Vec3::new(
            -azimuth.sin() * elevation.sin(),
            elevation.cos(),
            -azimuth.cos() * elevation.sin(),
        );
        let (focus, center) = if focus.is_empty() {
            (Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE }, Vec3::ZERO)
        } else {
            (*focus, focus.center())
        };
        let right = up.cross(backward);
        let tan_y = (Self::FOV_Y * 0.5).tan();
        let tan_x = tan_y * size.x.max(1) as f32 / size.y.max(1) as f32;
        let distance = focus.corners().iter().fold(1e-3f32, |distance, corner| {
            let v = *corner - center;
            let toward = v.dot(backward);
            distance.max(toward + v.dot(right).abs() / tan_x).max(toward + v.dot(up).abs() / tan_y)
        });
        Self {
            eye: center + backward * distance * distance_factor,
            target: center,
            up,
            projection: Projection::Perspective { fov_y: Self::FOV_Y },
            size: size.max(UVec2::ONE),
            tolerance_px: 1.0,
            clip: Clip::NONE,
        }
    }

    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.size.x as f32 / self.size.y as f32
    }

    /// Unit vector of the line of sight.
    pub fn forward(&self) -> Vec3 {
        (self.target - self.eye).normalize_or(Vec3::NEG_Z)
    }

    /// Distance of the near plane in metres. Depth is reversed and infinite, so it costs no precision.
    pub fn near(&self) -> f32 {
        0.05
    }

    /// World (local space) to camera space.
    pub fn view_from_world(&self) -> Mat4 {
        view::look_to_mat4(self.eye, self.forward(), self.up)
    }

    /// Local space to clip space with reversed depth. `reach` (metres, only for parallel
    /// projection) is half the depth that is shown around the eye's plane.
    pub fn clip_from_world(&self, reach: f32) -> Mat4 {
        let clip_from_view = match self.projection {
            Projection::Perspective { fov_y } => {
                directx::perspective_infinite_reverse(fov_y, self.aspect(), self.near())
            }
            Projection::Orthographic { height } => {
                let (h, w) = (height * 0.5, height * 0.5 * self.aspect());
                directx::orthographic(-w, w, -h, h, reach, -reach)
            }
        };
        clip_from_view * self.view_from_world()
    }

    /// The planes of the frame as (normal, offset), inside where `normal . p + offset >= 0`:
    /// left, right, bottom, top and, in perspective, near.
    pub fn frustum(&self) -> Frustum {
        let m = self.clip_from_world(1.0).transpose();
        let (x, y, w) = (m.x_axis, m.y_axis, m.w_axis);
        let near = match self.projection {
            // No plane can be nearer than the eye's own.
            Projection::Perspective { .. } => {
                let f = self.forward();
                f.extend(-f.dot(self.eye))
            }
            Projection::Orthographic { .. } => Vec4::W,
        };
        Frustum { planes: [w + x, w - x, w + y, w - y, near] }
    }

    /// Focal length in pixels, or pixels per metre in parallel projection.
    fn scale_px(&self) -> f32 {
        match self.projection {
            Projection::Perspective { fov_y } => self.size.y as f32 * 0.5 / (fov_y * 0.5).tan(),
            Projection::Orthographic { height } => self.size.y as f32 / height,
        }
    }

    /// Shorthand for [`Lens::error_px`] where only a few boxes are asked for.
    pub fn error_px(&self, delta: f32, bounds: &Aabb) -> f32 {
        self.lens().error_px(delta, bounds)
    }

    /// Prepares the question how large an error appears.
    pub fn lens(&self) -> Lens {
        let rotation = Mat3::from_mat4(self.view_from_world()).transpose();
        let tan_y = match self.projection {
            Projection::Perspective { fov_y } => (fov_y * 0.5).tan(),
            Projection::Orthographic { .. } => 0.0,
        };
        Lens {
            eye: self.eye,
            right: rotation.x_axis,
            up: rotation.y_axis,
            forward: -rotation.z_axis,
            frame: Vec2::new(tan_y * self.aspect(), tan_y),
            scale_px: self.scale_px(),
            parallel: matches!(self.projection, Projection::Orthographic { .. }),
        }
    }
}

/// What a view makes of errors in space (R7, R8).
#[derive(Clone, Copy, Debug)]
pub struct Lens {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    /// Tangents of the angles between the line of sight and the frame's right and upper edge.
    frame: Vec2,
    /// Perspective: the focal length in pixels; parallel: pixels a metre.
    scale_px: f32,
    parallel: bool,
}

impl Lens {
    /// An upper bound in pixels of what an error of `delta` metres within `bounds` can displace
    /// on the picture (R7, R8); infinite when the box is too near for any promise.
    ///
    /// Proof for perspective, with f the focal length in pixels. Let p be a point of the box
    /// inside the frame, at depth z_p and with tangents t = (x_p / z_p, y_p / z_p), and q a point
    /// with |p - q| <= delta, so that z_q >= z_p - delta. On the picture they are apart by
    /// f |(x_p - x_q) - t (z_p - z_q)| / z_q, x being the two lateral coordinates; the numerator
    /// is the image of p - q under a map of norm sqrt(1 + |t|^2) = s. So the picture moves by at
    /// most f delta s / (z_p - delta). The box bounds both: each component of t by its largest
    /// lateral coordinate over its smallest depth and by the frame, z_p by its smallest depth and,
    /// since p is at least the box's distance d away and |p| = s z_p, by d / s.
    pub fn error_px(&self, delta: f32, bounds: &Aabb) -> f32 {
        if delta <= 0.0 {
            return 0.0;
        }
        if self.parallel {
            return self.scale_px * delta;
        }
        let (center, half) = (bounds.center() - self.eye, bounds.size() * 0.5);
        let nearest = self.forward.dot(center) - self.forward.abs().dot(half);
        let mut tangent = self.frame;
        if nearest > 0.0 {
            let lateral = Vec2::new(
                self.right.dot(center).abs() + self.right.abs().dot(half),
                self.up.dot(center).abs() + self.up.abs().dot(half),
            );
            tangent = tangent.min(lateral / nearest);
        }
        let stretch = (1.0 + tangent.length_squared()).sqrt();
        let depth = nearest.max(bounds.distance(self.eye) / stretch) - delta;
        if depth <= 0.0 { f32::INFINITY } else { self.scale_px * delta * stretch / depth }
    }
}

/// The planes of a picture's frame.
#[derive(Clone, Copy, Debug)]
pub struct Frustum {
    planes: [Vec4; 5],
}

/// Where a box lies relative to the frame.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Containment {
    /// No point of the box is inside.
    Outside,
    /// Some may be.
    Partly,
    /// All are.
    Inside,
}

impl Frustum {
    /// Where `bounds` lies. Conservative: `Partly` may be said of a box that is outside.
    pub fn test(&self, bounds: &Aabb) -> Containment {
        let (center, half) = (bounds.center(), bounds.size() * 0.5);
        let mut inside = true;
        for plane in &self.planes {
            let normal = plane.truncate();
            let middle = normal.dot(center) + plane.w;
            let radius = normal.abs().dot(half);
            if middle + radius < 0.0 {
                return Containment::Outside;
            }
            inside &= middle - radius >= 0.0;
        }
        if inside { Containment::Inside } else { Containment::Partly }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn to_pixels(view: &View, point: Vec3) -> Option<glam::Vec2> {
        let clip = view.clip_from_world(1e4) * point.extend(1.0);
        (clip.w > 0.0).then(|| {
            let ndc = clip.truncate() / clip.w;
            glam::Vec2::new(ndc.x, ndc.y) * 0.5 * view.size.as_vec2()
        })
    }

    fn unit() -> impl Strategy<Value = Vec3> {
        (-1f32..1.0, -1f32..1.0, -1f32..1.0)
            .prop_map(|(x, y, z)| Vec3::new(x, y, z).normalize_or(Vec3::X))
    }

    proptest! {
        /// R8: no displacement by delta of a point inside the frame shows as more than the bound.
        #[test]
        fn the_pixel_error_is_an_upper_bound(
            eye in unit(), distance in 0.5f32..200.0, delta in 1e-3f32..3.0, way in unit(),
            x in -1f32..1.0, y in -1f32..1.0, wide in 100u32..3000, parallel in any::<bool>(),
        ) {
            let mut view = View::fit(&Aabb::EMPTY, 0.0, 0.0, 1.0, UVec2::new(wide, 720));
            view.eye = eye * 10.0;
            view.target = Vec3::ZERO;
            view.up = eye.any_orthonormal_vector();
            if parallel {
                view.projection = Projection::Orthographic { height: 30.0 };
            }
            // A point at any place of the frame, corners included.
            let inverse = view.clip_from_world(1e4).inverse();
            let on_ray = inverse.project_point3(Vec3::new(x, y, 0.5));
            let direction = if parallel { view.forward() } else { (on_ray - view.eye).normalize() };
            let start = if parallel { on_ray - direction * on_ray.dot(direction) } else { view.eye };
            let p = start + direction * distance;
            let bounds = Aabb { min: p, max: p };
            let bound = view.error_px(delta, &bounds);
            let (a, b) = (to_pixels(&view, p), to_pixels(&view, p + way * delta));
            if let (Some(a), Some(b)) = (a, b) {
                prop_assert!(a.distance(b) <= bound * 1.001 + 0.02, "{} > {bound}", a.distance(b));
            } else {
                prop_assert!(bound.is_infinite());
            }
        }

        /// A box with any point in the picture is never called outside.
        #[test]
        fn the_frame_never_loses_a_visible_box(
            azimuth in 0f32..360.0, elevation in -89f32..90.0,
            center in (-50f32..50.0, -50f32..50.0, -50f32..50.0), half in 0.1f32..20.0,
        ) {
            let focus = Aabb { min: Vec3::splat(-5.0), max: Vec3::splat(5.0) };
            let view = View::fit(&focus, azimuth, elevation, 1.0, UVec2::new(640, 360));
            let center = Vec3::from(center);
            let bounds = Aabb { min: center - half, max: center + half };
            let seen = bounds.corners().into_iter().chain([center]).any(|p| {
                to_pixels(&view, p).is_some_and(|q| (q.abs() * 2.0).cmple(view.size.as_vec2()).all())
            });
            let verdict = view.frustum().test(&bounds);
            prop_assert!(!seen || verdict != Containment::Outside);
            if verdict == Containment::Inside {
                for p in bounds.corners() {
                    let q = to_pixels(&view, p).expect("inside is in front of the eye");
                    prop_assert!((q.abs() * 2.0).cmple(view.size.as_vec2() * 1.001).all());
                }
            }
        }

        /// The fitted view shows every corner and could not be nearer.
        #[test]
        fn fit_is_the_smallest_distance(
            azimuth in 0f32..360.0, elevation in -90f32..90.0,
            size in (0.5f32..80.0, 0.5f32..80.0, 0.5f32..80.0), wide in 200u32..2000,
        ) {
            let focus = Aabb { min: Vec3::ZERO, max: Vec3::from(size) };
            let view = View::fit(&focus, azimuth, elevation, 1.0, UVec2::new(wide, 600));
            let reach = focus.corners().into_iter().map(|p| {
                let q = to_pixels(&view, p).expect("in front of the eye").abs() * 2.0;
                (q / view.size.as_vec2()).max_element()
            });
            let reach = reach.fold(0f32, f32::max);
            prop_assert!((reach - 1.0).abs() < 1e-2, "{reach}");
        }
    }

    #[test]
    fn an_eye_inside_the_box_gets_no_promise() {
        let view = View::fit(&Aabb::EMPTY, 0.0, 0.0, 1.0, UVec2::new(64, 64));
        let around = Aabb { min: view.eye - 1.0, max: view.eye + 1.0 };
        assert!(view.error_px(0.01, &around).is_infinite());
        assert_eq!(view.error_px(0.0, &around), 0.0);
    }
}
