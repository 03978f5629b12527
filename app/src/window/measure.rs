//! Distances between points of the model.

use super::camera::Camera;
use glam::{UVec2, Vec2, Vec3};

/// Points on the picture at which a corner is taken in place of what is under the pointer.
pub const SNAP: f32 = 9.0;
/// Distances that are kept.
const KEPT: usize = 50;

/// Distances that were taken, and the one that is being taken.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Measure {
    /// Whether a click takes a point.
    pub on: bool,
    /// The first point of the next distance.
    pub start: Option<Vec3>,
    /// From where to where, metres in local space.
    pub taken: Vec<[Vec3; 2]>,
}

impl Measure {
    /// Takes a point: the first one of a distance, or its second.
    pub fn take(&mut self, point: Vec3) {
        match self.start.take() {
            None => self.start = Some(point),
            Some(start) => {
                if self.taken.len() == KEPT {
                    self.taken.remove(0);
                }
                self.taken.push([start, point]);
            }
        }
    }

    /// Lets go of the first point, or else of measuring.
    pub fn step_back(&mut self) {
        if self.start.take().is_none() {
            self.on = false;
        }
    }
}

/// A distance in words: as the crow flies, on the level and in height.
pub fn words([from, to]: [Vec3; 2]) -> String {
    let d = (to.as_dvec3() - from.as_dvec3()).abs();
    let level = d.x.hypot(d.z);
    format!("{:.3} m  (level {level:.3}, height {:.3})", d.length(), d.y)
}

/// What is meant near a triangle that is under a pixel: one of its corners, or a point of one of its edges,
/// where that is nearer than `reach` pixels (corners) or half of that (edges); else the point itself.
pub fn snapped(
    corners: [Vec3; 3],
    point: Vec3,
    camera: &Camera,
    pixel: Vec2,
    size: UVec2,
    reach: f32,
) -> Vec3 {
    let away = |p: Vec3| camera.project(p, size).map_or(f32::INFINITY, |seen| seen.distance(pixel));
    let nearest = |points: [Vec3; 3], reach: f32| {
        let points = points.into_iter().map(|p| (away(p), p));
        points.filter(|(d, _)| *d <= reach).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, p)| p)
    };
    let [a, b, c] = corners;
    let on_edges = [(a, b), (b, c), (c, a)].map(|(from, to)| {
        let along = to - from;
        let share = (point - from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
        from + along * share.clamp(0.0, 1.0)
    });
    nearest(corners, reach).or_else(|| nearest(on_edges, reach * 0.5)).unwrap_or(point)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use topout_scene::{Aabb, NamedView};

    #[test]
    fn two_clicks_make_a_distance() {
        let mut measure = Measure { on: true, ..Measure::default() };
        measure.take(Vec3::ZERO);
        assert_eq!((measure.start, measure.taken.len()), (Some(Vec3::ZERO), 0));
        measure.take(Vec3::new(3.0, 12.0, 4.0));
        assert_eq!((measure.start, measure.taken.len()), (None, 1));
        assert_eq!(words(measure.taken[0]), "13.000 m  (level 5.000, height 12.000)");
        measure.take(Vec3::X);
        measure.step_back();
        assert!(measure.start.is_none() && measure.on);
        measure.step_back();
        assert!(!measure.on && measure.taken.len() == 1);
    }

    #[test]
    fn corners_attract_more_than_edges() {
        let corners = [Vec3::ZERO, Vec3::X * 10.0, Vec3::Y * 10.0];
        let size = UVec2::new(800, 800);
        let focus = Aabb { min: Vec3::new(-1.0, -1.0, 0.0), max: Vec3::new(11.0, 11.0, 0.0) };
        let camera = Camera::fit_named(&focus, NamedView::Front, size);
        let meant = |x: f32, y: f32| {
            let point = Vec3::new(x, y, 0.0);
            let pixel = camera.project(point, size).unwrap();
            snapped(corners, point, &camera, pixel, size, 12.0)
        };
        assert_eq!(meant(0.1, 0.1), Vec3::ZERO);
        assert_eq!(meant(9.95, 0.02), Vec3::X * 10.0);
        assert!(meant(4.0, 0.05).abs_diff_eq(Vec3::X * 4.0, 1e-5));
        let on_slope = meant(5.02, 5.0);
        assert!((on_slope.x + on_slope.y - 10.0).abs() < 1e-4, "{on_slope}");
        assert_eq!(meant(3.0, 3.0), Vec3::new(3.0, 3.0, 0.0));
    }
}
