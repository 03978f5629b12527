//! The camera as a value, and what dragging and scrolling do to it: pure functions.
//!
//! Azimuth and elevation (never beyond straight up or down) give the direction, so the picture
//! cannot roll or flip over a pole. Positions on the picture are physical pixels from the top left.

use glam::{Mat3, UVec2, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, TAU};
use topout_scene::{Aabb, Clip, NamedView, Projection, View};

/// Metres that one zoom step moves at least, so that zooming in passes through what is in front
/// instead of creeping up to it for ever.
const MIN_ZOOM_STEP_M: f32 = 0.05;

/// How much farther away than the smallest possible distance a fit stands, so that nothing
/// touches the frame.
const FIT_MARGIN: f32 = 1.06;

/// Where one looks from and to. Up is +Y.
#[derive(Clone, Copy, PartialEq, Debug, serde::Serialize, serde::Deserialize)]
pub struct Camera {
    /// Position, metres in the scene's local space.
    pub eye: Vec3,
    /// From +Z towards +X, radians.
    pub azimuth: f32,
    /// Above the horizon, radians in [-pi/2, pi/2].
    pub elevation: f32,
    /// Metres from the eye to what is looked at, above zero.
    pub reach: f32,
    /// Vertical field of view, radians.
    pub fov_y: f32,
    /// Rays are parallel; what is `reach` metres away has the size that it has in perspective.
    pub parallel: bool,
}

/// How far behind the eye a picture of parallel rays begins, metres: there is no point in cutting off what
/// is beside one.
const BEHIND: f32 = 2000.0;

impl Camera {
    /// The standard view `named` that just shows all of `focus` in a picture of `size`.
    pub fn fit_named(focus: &Aabb, named: NamedView, size: UVec2) -> Self {
        let (azimuth, elevation) = named.angles();
        Self::fit_angles(focus, azimuth.to_radians(), elevation.to_radians(), size)
    }

    /// The same direction, placed so that it just shows all of `focus`.
    pub fn fit(&self, focus: &Aabb, size: UVec2) -> Self {
        let fitted = Self::fit_angles(focus, self.azimuth, self.elevation, size);
        Self { parallel: self.parallel, ..fitted }
    }

    fn fit_angles(focus: &Aabb, azimuth: f32, elevation: f32, size: UVec2) -> Self {
        let view = View::fit(focus, azimuth.to_degrees(), elevation.to_degrees(), FIT_MARGIN, size);
        let reach = view.eye.distance(view.target).max(1e-3);
        Self { eye: view.eye, azimuth, elevation, reach, fov_y: View::FOV_Y, parallel: false }
    }

    /// Whether it can be looked through: a file may hold anything.
    pub fn is_sound(&self) -> bool {
        let angles = [self.azimuth, self.elevation, self.reach, self.fov_y];
        self.eye.is_finite()
            && angles.iter().all(|value| value.is_finite())
            && self.elevation.abs() <= FRAC_PI_2
            && self.reach > 0.0
            && (0.01..3.0).contains(&self.fov_y)
    }

    /// Metres from the foot to the top of the picture at the distance that is looked at.
    fn height(&self) -> f32 {
        2.0 * self.reach * (self.fov_y * 0.5).tan()
    }

    /// What the renderer needs to know.
    pub fn view(&self, size: UVec2, tolerance_px: f32) -> View {
        let basis = self.basis();
        let (behind, projection) = match self.parallel {
            true => (BEHIND, Projection::Orthographic { height: self.height() }),
            false => (0.0, Projection::Perspective { fov_y: self.fov_y }),
        };
        View {
            eye: self.eye + basis.z_axis * behind,
            target: self.eye - basis.z_axis * self.reach,
            up: basis.y_axis,
            projection,
            size: size.max(UVec2::ONE),
            tolerance_px,
            clip: Clip::NONE,
        }
    }

    /// Right, up and backward as columns; orthonormal, right-handed.
    fn basis(&self) -> Mat3 {
        let (sa, ca) = self.azimuth.sin_cos();
        let (se, ce) = self.elevation.sin_cos();
        Mat3::from_cols(
            Vec3::new(ca, 0.0, -sa),
            Vec3::new(-sa * se, ce, -ca * se),
            Vec3::new(sa * ce, se, ca * ce),
        )
    }

    /// The point under a pixel that is so many metres in front of the eye.
    fn point_at_depth(&self, pixel: Vec2, size: UVec2, depth: f32) -> Vec3 {
        let size = size.max(UVec2::ONE).as_vec2();
        let x = (2.0 * pixel.x / size.x - 1.0) * size.x / size.y;
        let y = 1.0 - 2.0 * pixel.y / size.y;
        let across = match self.parallel {
            true => self.height() * 0.5,
            false => depth * (self.fov_y * 0.5).tan(),
        };
        self.eye + self.basis() * Vec3::new(x * across, y * across, -depth)
    }

    /// Origin and unit vector of the ray through a pixel.
    pub fn ray(&self, pixel: Vec2, size: UVec2) -> (Vec3, Vec3) {
        match self.parallel {
            true => (self.point_at_depth(pixel, size, -BEHIND), -self.basis().z_axis),
            false => {
                let ahead = self.point_at_depth(pixel, size, 1.0) - self.eye;
                (self.eye, ahead.normalize())
            }
        }
    }

    /// The point under a pixel at the distance that is looked at: stands in where nothing is hit.
    pub fn point_at_reach(&self, pixel: Vec2, size: UVec2) -> Vec3 {
        self.point_at_depth(pixel, size, self.reach)
    }

    /// Metres of a point in front of the eye, negative behind it.
    pub fn depth(&self, point: Vec3) -> f32 {
        (self.eye - point).dot(self.basis().z_axis)
    }

    /// Where a point appears, in pixels; `None` at or behind the eye's plane.
    pub fn project(&self, point: Vec3, size: UVec2) -> Option<Vec2> {
        let p = self.basis().transpose() * (point - self.eye);
        let size = size.max(UVec2::ONE).as_vec2();
        let pixels_per_metre = match self.parallel {
            true => size.y / self.height(),
            false if p.z >= -1e-4 => return None,
            false => size.y * 0.5 / (self.fov_y * 0.5).tan() / -p.z,
        };
        Some(Vec2::new(p.x, -p.y) * pixels_per_metre + size * 0.5)
    }

    /// Turns about `pivot`, which keeps its place on the picture and its distance from the eye.
    /// Angles in radians; the elevation stops at the poles.
    #[must_use]
    pub fn orbit(&self, pivot: Vec3, azimuth: f32, elevation: f32) -> Self {
        let turned = Self {
            azimuth: (self.azimuth + azimuth).rem_euclid(TAU),
            elevation: (self.elevation + elevation).clamp(-FRAC_PI_2, FRAC_PI_2),
            ..*self
        };
        let in_camera = self.basis().transpose() * (self.eye - pivot);
        Self { eye: pivot + turned.basis() * in_camera, ..turned }
    }

    /// Moves parallel to the picture so that `grabbed`, which was under `from`, comes under `to`.
    #[must_use]
    pub fn pan(&self, grabbed: Vec3, from: Vec2, to: Vec2, size: UVec2) -> Self {
        let depth = self.depth(grabbed).max(self.reach * 1e-3);
        let shift = self.point_at_depth(to, size, depth) - self.point_at_depth(from, size, depth);
        Self { eye: self.eye - shift, ..*self }
    }

    /// Moves by metres to the right, up and forward, as seen from the eye.
    #[must_use]
    pub fn moved(&self, by: Vec3) -> Self {
        let basis = self.basis();
        let along = basis.x_axis * by.x + basis.y_axis * by.y - basis.z_axis * by.z;
        Self { eye: self.eye + along, ..*self }
    }

    /// Moves by metres to the right and forward over level ground.
    #[must_use]
    pub fn walked(&self, right: f32, forward: f32) -> Self {
        let (sa, ca) = self.azimuth.sin_cos();
        let along = Vec3::new(ca, 0.0, -sa) * right - Vec3::new(sa, 0.0, ca) * forward;
        Self { eye: self.eye + along, ..*self }
    }

    /// Unit vectors to the right, up and towards the viewer, as the picture has them.
    pub fn axes(&self) -> [Vec3; 3] {
        let basis = self.basis();
        [basis.x_axis, basis.y_axis, basis.z_axis]
    }

    /// Moves along the line to `point`, which therefore stays where it is on the picture.
    /// `factor` below 1 comes nearer; the eye stays within `limit` metres of the point.
    #[must_use]
    pub fn zoom(&self, point: Vec3, factor: f32, limit: f32) -> Self {
        let offset = self.eye - point;
        let distance = offset.length();
        if distance < 1e-6 || !factor.is_finite() || factor <= 0.0 {
            return *self;
        }
        if self.parallel {
            // Sizes follow the reach alone, and nothing has to be passed through.
            let reach = (self.reach * factor).clamp(0.01, limit.max(0.1));
            return Self { eye: point + offset * (reach / self.reach), reach, ..*self };
        }
        let mut next = distance * factor;
        if factor < 1.0 {
            next = next.min(distance - MIN_ZOOM_STEP_M);
        } else {
            next = next.max(distance + MIN_ZOOM_STEP_M).min(limit.max(distance));
        }
        let reach = (self.reach * next.max(0.0) / distance).clamp(0.1, limit.max(0.1));
        Self { eye: point + offset / distance * next, reach, ..*self }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const SIZE: UVec2 = UVec2::new(800, 600);

    fn camera() -> Camera {
        let focus = Aabb { min: Vec3::new(-20.0, 0.0, -10.0), max: Vec3::new(20.0, 60.0, 10.0) };
        Camera::fit_named(&focus, NamedView::Iso, SIZE)
    }

    fn assert_near(a: Vec2, b: Vec2) {
        assert!(a.distance(b) < 0.05, "{a} is not {b}");
    }

    #[test]
    fn agrees_with_the_standard_views() {
        let focus = Aabb { min: Vec3::new(-3.0, 0.0, 2.0), max: Vec3::new(9.0, 30.0, 10.0) };
        for (named, _) in NamedView::ALL {
            let (azimuth, elevation) = named.angles();
            let expected = View::fit(&focus, azimuth, elevation, FIT_MARGIN, SIZE);
            let view = Camera::fit_named(&focus, named, SIZE).view(SIZE, 1.0);
            assert!(view.eye.distance(expected.eye) < 1e-3, "{named:?}");
            assert!(view.target.distance(expected.target) < 1e-3, "{named:?}");
            assert!(view.up.distance(expected.up) < 1e-5, "{named:?}");
        }
    }

    #[test]
    fn a_pixel_s_ray_meets_the_point_that_projects_to_it() {
        for (camera, pixel) in [false, true].into_iter().flat_map(|parallel| {
            let pixels = [Vec2::ZERO, Vec2::new(123.0, 456.0), Vec2::new(799.0, 10.0)];
            pixels.map(|pixel| (Camera { parallel, ..camera() }, pixel))
        }) {
            let (origin, direction) = camera.ray(pixel, SIZE);
            let point = origin + direction * 37.0;
            assert_near(camera.project(point, SIZE).unwrap(), pixel);
            let far = camera.point_at_reach(pixel, SIZE);
            assert!((camera.depth(far) - camera.reach).abs() < 1e-2);
            let clip = camera.view(SIZE, 1.0).clip_from_world(1.0) * point.extend(1.0);
            let ndc = clip.truncate() / clip.w;
            let from_matrix = Vec2::new(ndc.x + 1.0, 1.0 - ndc.y) * 0.5 * SIZE.as_vec2();
            assert_near(from_matrix, pixel);
        }
        assert_eq!(camera().project(camera().eye * 2.0, SIZE), None);
    }

    #[test]
    fn zooming_and_panning_keep_the_point_under_the_cursor() {
        let (from, to) = (Vec2::new(250.0, 140.0), Vec2::new(610.0, 420.0));
        for parallel in [false, true] {
            let camera = Camera { parallel, ..camera() };
            let (origin, direction) = camera.ray(from, SIZE);
            let point = origin + direction * 55.0;
            for factor in [0.5, 0.9, 1.1, 3.0] {
                let zoomed = camera.zoom(point, factor, 1e4);
                assert_near(zoomed.project(point, SIZE).unwrap(), from);
                let distances = zoomed.eye.distance(point) / camera.eye.distance(point);
                assert!((distances - factor).abs() < 1e-3);
            }
            assert_near(camera.pan(point, from, to, SIZE).project(point, SIZE).unwrap(), to);
        }
    }

    #[test]
    fn zooming_in_passes_through_and_zooming_out_ends() {
        let mut camera = camera();
        let point = camera.eye + camera.ray(Vec2::new(400.0, 300.0), SIZE).1 * 5.0;
        for _ in 0..300 {
            camera = camera.zoom(point, 0.8, 1e3);
            assert!(camera.eye.is_finite() && camera.reach > 0.0);
            if camera.depth(point) < 0.0 {
                break;
            }
        }
        assert!(camera.depth(point) < 0.0, "never passed the point");
        for _ in 0..300 {
            camera = camera.zoom(point, 1.5, 1e3);
        }
        assert!(camera.eye.distance(point) <= 1e3 * 1.001);
    }

    #[test]
    fn orbiting_keeps_the_pivot_in_place_and_at_its_distance() {
        let mut camera = camera();
        let pixel = Vec2::new(300.0, 200.0);
        let pivot = camera.eye + camera.ray(pixel, SIZE).1 * 48.0;
        for step in 0..200 {
            camera = camera.orbit(pivot, 0.11, if step < 120 { 0.03 } else { -0.07 });
            assert!((camera.eye.distance(pivot) - 48.0).abs() < 0.05);
            let at = camera.project(pivot, SIZE).unwrap();
            assert!(at.distance(pixel) < 0.5, "{at}");
        }
    }

    #[test]
    fn never_flips_over_a_pole() {
        let mut camera = camera();
        for elevation in [0.3, -0.3] {
            for _ in 0..50 {
                camera = camera.orbit(Vec3::ZERO, 0.0, elevation);
                assert!(camera.elevation.abs() <= FRAC_PI_2);
                assert!(camera.basis().y_axis.y >= -1e-6, "upside down");
                let view = camera.view(SIZE, 1.0);
                assert!(view.forward().cross(view.up).length() > 0.99);
                assert!(view.clip_from_world(1.0).is_finite());
            }
        }
    }
}
