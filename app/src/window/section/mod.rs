//! Section planes and the section box: what of the model is cut away.

pub(super) mod handles;
mod panel;

pub(super) use panel::show;

use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};
use topout_scene::{Aabb, Clip};

/// Planes beside those of the box.
pub const MOST_PLANES: usize = Clip::MOST - 6;
/// The box's sides stay this far apart, metres.
const THINNEST: f32 = 0.02;
/// Nothing lies farther from the scene's zero, metres.
const FARTHEST: f32 = 1e7;

/// What is cut away, and whether it is now. Everything is in the scene's local space.
#[derive(Clone, PartialEq, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Section {
    /// Whether anything is cut away.
    pub on: bool,
    /// Only what lies in it is shown.
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    pub boxed: Option<SectionBox>,
    /// What lies beyond each of them is not shown.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<SectionPlane>,
}

/// An upright box.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
pub struct SectionBox {
    /// Its middle, metres.
    pub center: Vec3,
    /// Half its width, height and depth, metres.
    pub half: Vec3,
    /// By how much it is turned about a vertical line, radians from +Z towards +X.
    pub turn: f32,
}

/// A plane.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
pub struct SectionPlane {
    /// A point of it, metres.
    pub at: Vec3,
    /// Unit vector into what is cut away.
    pub outward: Vec3,
}

impl SectionBox {
    /// Around something, with some room to spare.
    pub fn around(bounds: &Aabb) -> Self {
        let room = (bounds.diameter() * 0.02).max(THINNEST);
        Self { center: bounds.center(), half: bounds.size() * 0.5 + room, turn: 0.0 }
    }

    /// Over a storey, given by its height and that of the next one: with its own floor and without the slab above, so
    /// that one sees into it.
    pub fn on_storey(&self, foot: f32, next: f32) -> Self {
        const SLAB: f32 = 0.2;
        let half = (next - foot) * 0.5;
        let mut boxed = *self;
        boxed.center.y = foot + half - 2.0 * half * SLAB;
        boxed.half.y = half;
        boxed
    }

    /// The box before it is turned.
    fn bounds(&self) -> Aabb {
        Aabb { min: self.center - self.half, max: self.center + self.half }
    }

    /// Its corners, in the order of [`Aabb::corners`].
    pub fn corners(&self) -> [Vec3; 8] {
        let turn = Quat::from_rotation_y(self.turn);
        self.bounds().corners().map(|corner| self.center + turn * (corner - self.center))
    }

    /// The middle of a side (two for each axis) and the direction out of it.
    pub fn side(&self, i: usize) -> SectionPlane {
        let (axis, own) = Clip::axes(self.turn)[i / 2];
        let outward = if i.is_multiple_of(2) { axis } else { -axis };
        SectionPlane { at: self.center + outward * own.dot(self.half), outward }
    }

    /// With that side moved out by so many metres, or in, while the others stay.
    pub fn with_side_moved(&self, i: usize, by: f32) -> Self {
        let (_, own) = Clip::axes(self.turn)[i / 2];
        let by = by.max(2.0 * (THINNEST - own.dot(self.half)));
        let outward = self.side(i).outward;
        Self { center: self.center + outward * by * 0.5, half: self.half + own * by * 0.5, ..*self }
    }

    fn is_sound(&self) -> bool {
        let values =
            [self.center, self.half].iter().all(|v| v.is_finite() && v.length() < FARTHEST);
        values && self.half.min_element() > 0.0 && self.turn.is_finite()
    }
}

impl SectionPlane {
    /// Moved by so many metres into what is cut away.
    pub fn moved(&self, by: f32) -> Self {
        Self { at: self.at + self.outward * by, ..*self }
    }

    fn is_sound(&self) -> bool {
        self.at.is_finite()
            && self.at.length() < FARTHEST
            && (self.outward.length() - 1.0).abs() < 1e-3
    }
}

impl Section {
    /// What is shown, for a [`topout_scene::View`].
    pub fn clip(&self) -> Clip {
        if !self.on {
            return Clip::NONE;
        }
        let boxed = self.boxed.map(|boxed| Clip::inside(&boxed.bounds(), boxed.turn));
        let mut clip = boxed.unwrap_or_default();
        for plane in self.planes.iter().take(MOST_PLANES) {
            clip.cut(plane.at, plane.outward);
        }
        clip
    }

    /// Whether there is nothing to cut with.
    pub fn is_empty(&self) -> bool {
        self.boxed.is_none() && self.planes.is_empty()
    }

    /// With another plane; the oldest one goes where there are too many.
    pub fn with_plane(&self, at: Vec3, outward: Vec3) -> Self {
        let mut next = Self { on: true, ..self.clone() };
        let outward = outward.normalize_or(Vec3::Y);
        next.planes.push(SectionPlane { at, outward });
        if next.planes.len() > MOST_PLANES {
            next.planes.remove(0);
        }
        next
    }

    /// Whether all values are numbers that mean something; those of a file need not be.
    pub fn is_sound(&self) -> bool {
        self.planes.len() <= MOST_PLANES
            && self.planes.iter().all(SectionPlane::is_sound)
            && self.boxed.is_none_or(|boxed| boxed.is_sound())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_side_moves_alone(
            turn in -7f32..7.0, half in (0.1f32..9.0, 0.1f32..9.0, 0.1f32..9.0), i in 0usize..6, by in -30f32..30.0,
        ) {
            let center = Vec3::new(3.0, -4.0, 5.0);
            let before = SectionBox { center, half: half.into(), turn };
            let after = before.with_side_moved(i, by);
            for k in (0..6).filter(|k| *k != i && *k != i ^ 1) {
                let (a, b) = (before.side(k), after.side(k));
                prop_assert!((a.at - b.at).dot(a.outward).abs() < 1e-3);
            }
            let other = before.side(i ^ 1);
            prop_assert!((after.side(i ^ 1).at - other.at).length() < 1e-3);
            let moved = (after.side(i).at - before.side(i).at).dot(before.side(i).outward);
            let thin = after.half.min_element() < THINNEST * 1.01;
            prop_assert!((moved - by).abs() < 1e-3 || (thin && moved > by), "{moved} {by}");
            prop_assert!(after.is_sound());
            let section = Section { on: true, boxed: Some(after), planes: Vec::new() };
            prop_assert!(section.clip().contains(after.center));
            for corner in after.corners() {
                let at = |share: f32| after.center + (corner - after.center) * share;
                prop_assert!(section.clip().contains(at(0.99)) && !section.clip().contains(at(1.01)));
            }
        }
    }

    #[test]
    fn a_storey_is_open_above_and_has_its_floor() {
        let half = Vec3::new(4.0, 9.0, 4.0);
        let boxed = SectionBox { center: Vec3::ONE, half, turn: 0.3 }.on_storey(6.0, 9.0);
        let clip = Section { on: true, boxed: Some(boxed), planes: Vec::new() }.clip();
        let shown = |y: f32| clip.contains(Vec3::new(1.0, y, 1.0));
        // Its slab lies below 6 m, the next one below 9 m.
        assert!(shown(5.7) && shown(8.0) && !shown(8.7) && !shown(5.0));
        assert_eq!((boxed.half.x, boxed.center.x, boxed.turn), (4.0, 1.0, 0.3));
    }

    #[test]
    fn planes_are_few_and_can_be_off() {
        let mut section = Section::default();
        assert!(section.is_empty() && section.clip().is_none());
        for i in 0..10 {
            section = section.with_plane(Vec3::X * i as f32, Vec3::X * 2.0);
        }
        assert_eq!((section.planes.len(), section.planes[0].at.x), (MOST_PLANES, 4.0));
        assert!(section.is_sound() && section.on);
        assert!(section.clip().contains(Vec3::X * 3.9) && !section.clip().contains(Vec3::X * 4.1));
        section.planes[2] = section.planes[2].moved(-2.0);
        assert!(!section.clip().contains(Vec3::X * 4.1));
        section.on = false;
        assert!(section.clip().is_none());
        section.planes[0].at.x = f32::NAN;
        assert!(!section.is_sound());
    }
}
