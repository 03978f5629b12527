//! A film of a project: what stands there, from one instant to another.

use super::caption::{Caption, Colored, Scribe};
use super::film::{Film, Made, Settings};
use super::shot::{Background, Studio};
use glam::Quat;
use std::path::Path;
use topout_render::{DrawMode, FrameInput, Renderer};
use topout_scene::{Progress, Scene, View};
use topout_schedule::{Time, TimeRange};

/// What a film shows.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Plan {
    /// The instants of the first and the last frame.
    pub range: TimeRange,
    /// How many frames, at least 1.
    pub frames: u32,
    /// Frames a second, above 0.
    pub fps: f64,
    /// The camera of the first frame.
    pub view: View,
    /// Degrees by which it turns around what it looks at, up to the last frame.
    pub turn_deg: f32,
    /// Way of drawing.
    pub mode: DrawMode,
    /// What stands behind the scene.
    pub background: Background,
    /// Whether frames have a caption, and whose colours it explains.
    pub caption: Option<Colored>,
}

impl Plan {
    /// What is known of the film before its first frame.
    pub fn settings(&self) -> Settings {
        Settings {
            width: self.view.size.x,
            height: self.view.size.y,
            frames: self.frames,
            fps: self.fps,
            transparent: self.background == Background::Transparent,
        }
    }

    /// The share of the film that has passed at a frame, from 0 on: 0 at the first, 1 at the last.
    fn passed(&self, frame: u32) -> f64 {
        f64::from(frame) / f64::from(self.frames.saturating_sub(1).max(1))
    }

    /// The instant that a frame shows, from 0 on.
    pub fn time(&self, frame: u32) -> Time {
        self.range.at_fraction(self.passed(frame))
    }

    /// The camera of a frame, from 0 on.
    pub fn view(&self, frame: u32) -> View {
        let turn = f64::from(self.turn_deg) * self.passed(frame);
        turned(&self.view, turn as f32)
    }
}

/// A camera turned around what it looks at, about the vertical; degrees from +Z towards +X.
pub fn turned(view: &View, degrees: f32) -> View {
    let turn = Quat::from_rotation_y(degrees.to_radians());
    let eye = view.target + turn * (view.eye - view.target);
    View { eye, up: turn * view.up, ..*view }
}

/// Draws and writes a film; every frame is complete. `progress` counts the frames, and can cancel.
///
/// # Errors
/// A [`super::FilmError`], a [`topout_render::GpuError`] or [`topout_scene::Cancelled`]; nothing is left then.
pub fn make(
    renderer: &mut Renderer,
    scene: &Scene,
    plan: &Plan,
    path: &Path,
    progress: &Progress,
) -> anyhow::Result<Made> {
    progress.begin("Drawing the film", plan.frames.into())?;
    let mut film = Film::begin(path, plan.settings())?;
    let mut studio = Studio::new(renderer, plan.background);
    let mut scribe = plan.caption.map(|colored| (Scribe::new(), colored));
    for frame in 0..plan.frames {
        let time = plan.time(frame);
        let input = FrameInput { view: plan.view(frame), time, mode: plan.mode };
        let (mut picture, _) = studio.shoot(&input)?;
        if let Some((scribe, colored)) = &mut scribe {
            scribe.draw(&Caption::at(scene, time, *colored), &mut picture);
        }
        film.push(&picture)?;
        progress.advance(1)?;
    }
    Ok(film.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{UVec2, Vec3};
    use topout_scene::Aabb;

    fn plan(frames: u32, turn_deg: f32) -> Plan {
        let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(10.0, 20.0, 30.0) };
        Plan {
            range: TimeRange { start: Time::from_seconds(1000), end: Time::from_seconds(2000) },
            frames,
            fps: 24.0,
            view: View::fit(&bounds, 30.0, 20.0, 1.0, UVec2::new(64, 36)),
            turn_deg,
            mode: DrawMode::Hdlod,
            background: Background::Scenery,
            caption: None,
        }
    }

    #[test]
    fn frames_are_spread_evenly_from_first_to_last() {
        let at = |plan: Plan| (0..plan.frames).map(|i| plan.time(i).seconds()).collect::<Vec<_>>();
        assert_eq!(at(plan(5, 0.0)), [1000, 1250, 1500, 1750, 2000]);
        assert_eq!(at(plan(2, 0.0)), [1000, 2000]);
        assert_eq!(at(plan(1, 0.0)), [1000]);
    }

    #[test]
    fn the_camera_turns_as_other_views_do() {
        let plan = plan(4, 90.0);
        assert_eq!(plan.view(0), plan.view);
        let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(10.0, 20.0, 30.0) };
        let wanted = View::fit(&bounds, 120.0, 20.0, 1.0, UVec2::new(64, 36));
        let last = plan.view(3);
        assert!(last.forward().distance(wanted.forward()) < 1e-5, "{last:?} {wanted:?}");
        assert!(last.up.distance(wanted.up) < 1e-5);
        let (near, far) =
            (plan.view.eye.distance(plan.view.target), last.eye.distance(last.target));
        assert!((near - far).abs() < 1e-3);
    }
}
