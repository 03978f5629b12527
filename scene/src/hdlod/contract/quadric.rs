//! Sums of squared distances from planes (Garland and Heckbert: "Surface simplification using quadric
//! error metrics", 1997), weighted by area.

use glam::{DMat3, DVec3};
use std::ops::Add;

/// How strongly a place is held near the middle of the join where the planes leave it free, as a
/// share of their own pull: along a cylinder any place is as good.
const HELD: f64 = 1e-3;

/// q(p) = p A p + 2 b p + c.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct Quadric {
    /// A: xx, xy, xz, yy, yz, zz.
    a: [f64; 6],
    b: DVec3,
    c: f64,
    /// Sum of the planes' weights.
    weight: f64,
}

impl Quadric {
    /// Of the plane through `point` across the unit vector `normal`.
    pub fn plane(normal: DVec3, point: DVec3, weight: f64) -> Self {
        let n = normal;
        let d = -n.dot(point);
        let a = [n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z];
        Self { a: a.map(|v| v * weight), b: n * (d * weight), c: d * d * weight, weight }
    }

    /// Mean squared distance of a point from the planes.
    pub fn error(&self, p: DVec3) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        let ap = DVec3::new(
            xx * p.x + xy * p.y + xz * p.z,
            xy * p.x + yy * p.y + yz * p.z,
            xz * p.x + yz * p.y + zz * p.z,
        );
        let sum = p.dot(ap) + 2.0 * self.b.dot(p) + self.c;
        // Rounding takes it below zero in a plane.
        (sum / self.weight.max(f64::MIN_POSITIVE)).max(0.0)
    }

    /// The point of the smallest error; where the planes leave it free, near `middle`.
    pub fn best(&self, middle: DVec3) -> Option<DVec3> {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        let held = (xx + yy + zz) * HELD;
        let matrix = DMat3::from_cols(
            DVec3::new(xx + held, xy, xz),
            DVec3::new(xy, yy + held, yz),
            DVec3::new(xz, yz, zz + held),
        );
        let place = matrix.inverse() * (middle * held - self.b);
        place.is_finite().then_some(place)
    }
}

impl Add for Quadric {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            a: std::array::from_fn(|i| self.a[i] + other.a[i]),
            b: self.b + other.b,
            c: self.c + other.c,
            weight: self.weight + other.weight,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_meet_in_a_point_and_errors_are_mean_squared_distances() {
        let corner = DVec3::new(3.0, -2.0, 0.5);
        let planes = [DVec3::X, DVec3::Y, DVec3::new(0.0, 0.6, 0.8)];
        let sum = planes.map(|n| Quadric::plane(n, corner, 2.0)).into_iter().reduce(Add::add);
        let sum = sum.expect("three planes");
        assert!(sum.error(corner) < 1e-12);
        assert!((sum.error(corner + DVec3::X * 0.3) - 0.09 / 3.0).abs() < 1e-12);
        let best = sum.best(corner + 0.1).expect("they meet");
        assert!(best.distance(corner) < 0.01, "{best}");
    }

    #[test]
    fn a_plane_holds_only_across_itself() {
        let plane = Quadric::plane(DVec3::Z, DVec3::Z * 4.0, 1.0);
        let best = plane.best(DVec3::new(1.0, 2.0, 4.5)).expect("held near the middle");
        assert!(best.distance(DVec3::new(1.0, 2.0, 4.0)) < 0.01, "{best}");
        assert!(Quadric::default().best(DVec3::ONE).is_none());
    }
}
