//! What mouse buttons do in the 3D view, and moving through it by keys.

use super::camera::Camera;
use egui::{Key, Modifiers, PointerButton};
use glam::Vec3;

/// Which buttons do what, as people know it from other programs.
#[derive(
    Clone, Copy, PartialEq, Eq, Hash, Debug, Default, serde::Serialize, serde::Deserialize,
)]
pub enum Mouse {
    /// Left turns, Shift and left, middle or right moves, Ctrl and left selects within a frame.
    #[default]
    Topout,
    /// Navisworks and Revit: middle moves, Shift and middle turns, left selects.
    Navisworks,
    /// Blender: middle turns, Shift and middle moves, Ctrl and middle zooms, left selects.
    Blender,
    /// CAD (as Rhino does): right turns, Shift and right or middle moves, left selects.
    Cad,
}

/// What a drag does.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Drag {
    /// Turn about what was under the pointer.
    Orbit,
    /// Move along with what was under the pointer.
    Pan,
    /// Come nearer to it, or go away.
    Zoom,
    /// Select what is within a rectangle.
    Frame,
    /// Look around from where one stands.
    Look,
}

impl Mouse {
    /// All of them, and how they are called.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Topout, "Mouse: topout"),
        (Self::Navisworks, "Mouse: Navisworks and Revit"),
        (Self::Blender, "Mouse: Blender"),
        (Self::Cad, "Mouse: CAD"),
    ];

    /// What a drag with a button does while keys are held.
    pub fn drag(self, button: PointerButton, held: Modifiers) -> Drag {
        use PointerButton::{Middle, Primary, Secondary};
        match (self, button) {
            (Self::Topout, Primary) if held.command => Drag::Frame,
            (Self::Topout, Primary) if !held.shift => Drag::Orbit,
            (Self::Topout, _) => Drag::Pan,
            (_, Primary) => Drag::Frame,
            (Self::Navisworks, Middle) if held.shift => Drag::Orbit,
            (Self::Blender, Middle) if held.command => Drag::Zoom,
            (Self::Blender, Middle) if !held.shift => Drag::Orbit,
            (Self::Cad, Secondary) if !held.shift => Drag::Orbit,
            _ => Drag::Pan,
        }
    }
}

/// How one moves through the scene.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Navigation {
    /// Around it.
    #[default]
    Orbit,
    /// On foot, at the height of one's eyes above what is below.
    Walk,
    /// Wherever one looks.
    Fly,
}

/// Height of one's eyes, metres.
pub const EYES_M: f32 = 1.7;
/// Metres a second on foot and in the air; three times as fast with Shift.
const PACE: [f32; 2] = [4.0, 20.0];

/// The keys that move one while walking or flying, and where to: right, up, forward.
const KEYS: [(Key, Vec3); 6] = [
    (Key::W, Vec3::Z),
    (Key::S, Vec3::NEG_Z),
    (Key::A, Vec3::NEG_X),
    (Key::D, Vec3::X),
    (Key::E, Vec3::Y),
    (Key::Q, Vec3::NEG_Y),
];

impl Navigation {
    /// Whether a key moves one and means nothing else meanwhile.
    pub fn uses(self, key: Key) -> bool {
        self != Self::Orbit && KEYS.iter().any(|(used, _)| *used == key)
    }

    /// Where one is `seconds` later, with these keys down; `None` where one stands still.
    pub fn steered(
        self,
        camera: &Camera,
        seconds: f32,
        fast: bool,
        down: impl Fn(Key) -> bool,
    ) -> Option<Camera> {
        let held = KEYS.iter().filter(|(key, _)| down(*key));
        let way = held.fold(Vec3::ZERO, |sum, (_, way)| sum + *way);
        let pace = match self {
            Self::Orbit => return None,
            Self::Walk => PACE[0],
            Self::Fly => PACE[1],
        };
        let by = way.normalize_or_zero() * pace * seconds * if fast { 3.0 } else { 1.0 };
        if by == Vec3::ZERO {
            return None;
        }
        Some(match self {
            Self::Walk => camera.walked(by.x, by.z),
            _ => camera.moved(by),
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use glam::UVec2;
    use topout_scene::{Aabb, NamedView};

    #[test]
    fn every_way_of_using_the_mouse_turns_and_moves() {
        use PointerButton::{Middle, Primary, Secondary};
        for (mouse, name) in Mouse::ALL {
            let buttons = [Primary, Middle, Secondary];
            let held = [Modifiers::NONE, Modifiers::SHIFT, Modifiers::COMMAND];
            let all: Vec<Drag> =
                buttons.iter().flat_map(|b| held.map(|h| mouse.drag(*b, h))).collect();
            for drag in [Drag::Orbit, Drag::Pan, Drag::Frame] {
                assert!(all.contains(&drag), "{name}: {drag:?}");
            }
        }
        assert_eq!(Mouse::Navisworks.drag(Middle, Modifiers::SHIFT), Drag::Orbit);
        assert_eq!(Mouse::Blender.drag(Middle, Modifiers::NONE), Drag::Orbit);
        assert_eq!(Mouse::Cad.drag(Secondary, Modifiers::NONE), Drag::Orbit);
        assert_eq!(Mouse::Topout.drag(Primary, Modifiers::SHIFT), Drag::Pan);
    }

    #[test]
    fn on_foot_one_stays_level_and_in_the_air_one_goes_where_one_looks() {
        let focus = Aabb { min: Vec3::ZERO, max: Vec3::splat(10.0) };
        let camera = Camera::fit_named(&focus, NamedView::Iso, UVec2::new(800, 600));
        let forward = |key: Key| key == Key::W;
        let walked = Navigation::Walk.steered(&camera, 0.5, false, forward).unwrap();
        assert!((walked.eye.y - camera.eye.y).abs() < 1e-5);
        assert!((walked.eye.distance(camera.eye) - 2.0).abs() < 1e-3);
        let flown = Navigation::Fly.steered(&camera, 0.5, true, forward).unwrap();
        let ahead = -camera.axes()[2];
        assert!((flown.eye - camera.eye - ahead * 30.0).length() < 1e-2);
        assert_eq!(Navigation::Orbit.steered(&camera, 1.0, false, forward), None);
        assert_eq!(Navigation::Fly.steered(&camera, 1.0, false, |_| true), None, "nowhere");
        assert!(Navigation::Walk.uses(Key::A) && !Navigation::Orbit.uses(Key::A));
    }
}
