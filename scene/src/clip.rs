//! What of space is shown: a convex part, cut out by section planes.

use crate::{Aabb, Containment};
use glam::{DVec3, Vec3, Vec4};

/// The part of space in which all of some planes agree that something is shown; all of it where there
/// are none.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Clip {
    planes: [Vec4; Self::MOST],
    count: usize,
}

impl Clip {
    /// Most planes: two boxes, or a box and six more.
    pub const MOST: usize = 12;
    /// All of space.
    pub const NONE: Self = Self { planes: [Vec4::ZERO; Self::MOST], count: 0 };

    /// Takes away what lies beyond a plane through `point` (local space) in the direction of `normal`
    /// (any length). Says whether there was room for another plane, and `normal` has a direction.
    pub fn cut(&mut self, point: Vec3, normal: Vec3) -> bool {
        let Some(out) = normal.try_normalize().filter(|_| point.is_finite()) else { return false };
        let Some(free) = self.planes.get_mut(self.count) else { return false };
        *free = (-out).extend(out.dot(point));
        self.count += 1;
        true
    }

    /// What lies in an upright box that is turned by `turn` (radians, from +Z towards +X) about a vertical
    /// line through its middle.
    pub fn inside(bounds: &Aabb, turn: f32) -> Self {
        let mut clip = Self::NONE;
        let (center, half) = (bounds.center(), bounds.size() * 0.5);
        for axis in Self::axes(turn) {
            let reach = axis.0 * axis.1.dot(half);
            clip.cut(center + reach, axis.0);
            clip.cut(center - reach, -axis.0);
        }
        clip
    }

    /// The directions of a box's sides, and which of its half sizes belongs to each.
    pub fn axes(turn: f32) -> [(Vec3, Vec3); 3] {
        let (sin, cos) = turn.sin_cos();
        [
            (Vec3::new(cos, 0.0, -sin), Vec3::X),
            (Vec3::Y, Vec3::Y),
            (Vec3::new(sin, 0.0, cos), Vec3::Z),
        ]
    }

    /// As (normal, offset): shown is where `normal . p + offset >= 0` for all of them. Normals are units.
    pub fn planes(&self) -> &[Vec4] {
        &self.planes[..self.count]
    }

    /// Whether nothing is taken away.
    pub fn is_none(&self) -> bool {
        self.count == 0
    }

    /// Whether a point is shown.
    pub fn contains(&self, point: Vec3) -> bool {
        self.planes().iter().all(|plane| plane.dot(point.extend(1.0)) >= 0.0)
    }

    /// Where a box lies. Conservative: [`Containment::Partly`] may be said of a box that is outside.
    pub fn test(&self, bounds: &Aabb) -> Containment {
        let (center, half) = (bounds.center(), bounds.size() * 0.5);
        let mut inside = true;
        for plane in self.planes() {
            let middle = plane.dot(center.extend(1.0));
            let radius = plane.truncate().abs().dot(half);
            if middle + radius < 0.0 {
                return Containment::Outside;
            }
            inside &= middle - radius >= 0.0;
        }
        if inside { Containment::Inside } else { Containment::Partly }
    }

    /// The part of a ray that is shown: from where to where, in lengths of `direction`, from 0 on, and the
    /// plane through which it comes in (none where it starts inside). `None` if nothing of it is shown.
    pub(crate) fn part_of_ray(&self, origin: DVec3, direction: DVec3) -> Option<Part> {
        let mut part = Part { from: 0.0, to: f64::INFINITY, through: None };
        for plane in self.planes() {
            let normal = plane.truncate();
            let (height, speed) = (
                normal.as_dvec3().dot(origin) + f64::from(plane.w),
                normal.as_dvec3().dot(direction),
            );
            let at = -height / speed;
            if speed > 0.0 && at > part.from {
                part = Part { from: at, through: Some(-normal), ..part };
            } else if speed < 0.0 {
                part.to = part.to.min(at);
            } else if speed == 0.0 && height < 0.0 {
                return None;
            }
        }
        (part.from <= part.to).then_some(part)
    }
}

/// The part of a ray that is shown.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Part {
    pub from: f64,
    pub to: f64,
    /// The outward normal of the plane through which it comes in.
    pub through: Option<Vec3>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point(size: f32) -> impl Strategy<Value = Vec3> {
        (-size..size, -size..size, -size..size).prop_map(Vec3::from)
    }

    proptest! {
        /// What is said of a box holds for its points, and of a ray for the points along it.
        #[test]
        fn boxes_and_rays_agree_with_points(
            planes in proptest::collection::vec((point(5.0), point(1.0)), 0..6),
            center in point(8.0), half in 0.01f32..4.0, shares in proptest::collection::vec(point(1.0), 20),
            direction in point(1.0),
        ) {
            let mut clip = Clip::NONE;
            for (at, normal) in planes {
                clip.cut(at, normal);
            }
            let bounds = Aabb { min: center - half, max: center + half };
            let verdict = clip.test(&bounds);
            for share in shares {
                let shown = clip.contains(center + share * half);
                prop_assert!(!shown || verdict != Containment::Outside);
                prop_assert!(shown || verdict != Containment::Inside);
            }
            prop_assume!(direction.length() > 0.1);
            let part = clip.part_of_ray(center.as_dvec3(), direction.as_dvec3());
            for step in 0..60 {
                let t = f64::from(step) * 0.5;
                let shown = clip.contains(center + direction * t as f32);
                let within = part.is_some_and(|p| (p.from..=p.to).contains(&t));
                let near = part.is_some_and(|p| (p.from - t).abs() < 1e-3 || (p.to - t).abs() < 1e-3);
                let by = clip.planes().iter().any(|p| p.dot((center + direction * t as f32).extend(1.0)).abs() < 1e-4);
                prop_assert!(shown == within || near || by, "{t}: {part:?}");
            }
        }

        #[test]
        fn a_turned_box_has_its_corners(turn in -4f32..4.0, at in point(1.5)) {
            let bounds = Aabb { min: Vec3::new(2.0, -1.0, 5.0), max: Vec3::new(6.0, 1.0, 6.0) };
            let clip = Clip::inside(&bounds, turn);
            let own = glam::Quat::from_rotation_y(turn) * (at * bounds.size() * 0.5);
            prop_assume!((at.abs() - 1.0).abs().min_element() > 1e-3);
            let inside = at.abs().max_element() < 1.0;
            prop_assert_eq!(clip.contains(bounds.center() + own), inside);
        }
    }

    #[test]
    fn there_is_room_for_so_many() {
        let mut clip = Clip::NONE;
        assert!(!clip.cut(Vec3::ZERO, Vec3::ZERO) && !clip.cut(Vec3::NAN, Vec3::X));
        assert!((0..Clip::MOST).all(|_| clip.cut(Vec3::ZERO, Vec3::X)));
        assert!(!clip.cut(Vec3::ZERO, Vec3::X));
        assert_eq!(clip.planes().len(), Clip::MOST);
    }
}
