//! Where the promise is tested from, and when.

use super::{Plan, Random};
use crate::{Projection, Scene, View};
use glam::{DVec2, DVec3, UVec2, Vec3};
use topout_schedule::Time;

/// Cameras with their names: the standard ones at three distances, parallel ones, one that has the
/// building in the corner of a wide frame, from the street, and from inside.
pub(super) fn views(scene: &Scene, plan: &Plan) -> Vec<(&'static str, View)> {
    let focus = scene.focus_bounds();
    let focus = if focus.is_empty() { scene.model.bounds() } else { focus };
    let fit = |azimuth, elevation, factor| View::fit(&focus, azimuth, elevation, factor, plan.size);
    let (center, size) = (focus.center(), focus.size());
    let height = size.length().max(1e-3);
    let parallel =
        |view: View, height: f32| View { projection: Projection::Orthographic { height }, ..view };
    let perspective = |degrees: f32| Projection::Perspective { fov_y: degrees.to_radians() };

    let near = fit(210.0, 12.0, 1.2);
    let (forward, across) = (near.forward(), near.forward().cross(near.up).normalize_or(Vec3::X));
    let distance = near.eye.distance(center);
    let wide = UVec2::new(plan.size.x, (plan.size.x / 3).max(1));
    let cornered = View {
        target: near.eye + (forward + across * 1.1 - near.up * 0.35) * distance,
        projection: perspective(65.0),
        size: wide,
        ..near
    };

    let level = focus.min.y + (1.7f32).min(size.y * 0.5);
    let street = Vec3::new(
        focus.max.x + (size.x * 0.15).min(15.0),
        level,
        focus.max.z + (size.z * 0.1).min(10.0),
    );
    let inside = |share: f32, toward: Vec3| {
        let eye = Vec3::new(center.x, focus.min.y + size.y * share, center.z);
        View { eye, target: eye + toward, projection: perspective(75.0), up: Vec3::Y, ..near }
    };
    let list = vec![
        ("1/1", fit(30.0, 20.0, 1.0)),
        ("1/4", fit(30.0, 20.0, 2.0)),
        ("1/16", fit(30.0, 20.0, 4.0)),
        ("parallel", parallel(fit(-60.0, 35.0, 1.0), height)),
        ("plan", parallel(fit(0.0, 90.0, 1.0), height * 0.3)),
        ("in the corner", cornered),
        (
            "street",
            View {
                eye: street,
                target: center,
                projection: perspective(60.0),
                up: Vec3::Y,
                ..near
            },
        ),
        ("inside, low", inside(0.21, Vec3::new(1.0, -0.05, 0.3))),
        ("inside, high", inside(0.67, Vec3::new(-0.4, 0.1, 1.0))),
    ];
    let tolerance_px = plan.tolerance_px;
    list.into_iter().map(|(name, view)| (name, View { tolerance_px, ..view })).collect()
}

/// Start, 1/3, 1/2, 2/3, end and a random date of the period.
pub(super) fn dates(scene: &Scene, plan: &Plan) -> Vec<Time> {
    let period = scene.schedule.period;
    let mut dates = vec![
        period.start,
        period.at_fraction(1.0 / 3.0),
        period.at_fraction(0.5),
        period.at_fraction(2.0 / 3.0),
        period.end.plus_seconds(-1).max(period.start),
        period.at_fraction(Random::new(plan.seed, u64::MAX).unit()),
    ];
    dates.sort_unstable();
    dates.dedup();
    dates
}

/// A view's rays and projection in f64, from the camera's definition.
pub(super) struct Camera {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    half: DVec2,
    /// Focal length in pixels, or pixels a metre.
    scale: f64,
    perspective: bool,
    /// Where rays start, as multiples of their direction.
    pub start: f64,
}

impl Camera {
    pub fn new(view: &View, scene_reach: f64) -> Self {
        let forward = view.forward().as_dvec3().normalize();
        let right = forward.cross(view.up.as_dvec3()).normalize();
        let height = f64::from(view.size.y);
        let (scale, perspective, start) = match view.projection {
            Projection::Perspective { fov_y } => {
                (height * 0.5 / (f64::from(fov_y) * 0.5).tan(), true, f64::from(view.near()))
            }
            Projection::Orthographic { height: metres } => {
                (height / f64::from(metres), false, -2.0 * scene_reach)
            }
        };
        let half = view.size.as_dvec2() * 0.5;
        let (eye, up) = (view.eye.as_dvec3(), right.cross(forward));
        Self { eye, right, up, forward, half, scale, perspective, start }
    }

    /// Origin and direction of the ray through a place on the picture, pixels from its top left.
    /// Multiples of the direction are depths.
    pub fn ray(&self, pixel: DVec2) -> (DVec3, DVec3) {
        let place = (pixel - self.half) / self.scale;
        let aside = self.right * place.x - self.up * place.y;
        if self.perspective {
            (self.eye, self.forward + aside)
        } else {
            (self.eye + aside, self.forward)
        }
    }

    /// Where a point is on the picture, pixels from its middle; `None` behind the eye.
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        let from_eye = point - self.eye;
        let depth = if self.perspective { from_eye.dot(self.forward) } else { 1.0 };
        let place = DVec2::new(from_eye.dot(self.right), -from_eye.dot(self.up));
        (depth > 0.0).then(|| place * (self.scale / depth))
    }
}
