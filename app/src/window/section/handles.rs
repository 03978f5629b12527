//! What a section is moved by in the 3D view: a handle for each plane, and for each side of the box.

use super::Section;
use crate::window::camera::Camera;
use glam::{UVec2, Vec2, Vec3};

/// A handle's reach, points.
pub const REACH: f32 = 9.0;

/// What can be dragged.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Handle {
    /// A side of the box.
    Side(usize),
    /// A plane, by its place in the list.
    Plane(usize),
}

/// Where the handles are, and which way each moves.
pub fn handles(section: &Section) -> Vec<(Handle, Vec3, Vec3)> {
    let mut all = Vec::new();
    if !section.on {
        return all;
    }
    if let Some(boxed) = &section.boxed {
        let side = |i| (Handle::Side(i), boxed.side(i).at, boxed.side(i).outward);
        all.extend((0..6).map(side));
    }
    let planes = section.planes.iter().enumerate();
    all.extend(planes.map(|(i, plane)| (Handle::Plane(i), plane.at, plane.outward)));
    all
}

/// The handle under a pixel; `reach` in pixels. Of several the nearest to the eye.
pub fn under(
    section: &Section,
    camera: &Camera,
    pixel: Vec2,
    size: UVec2,
    reach: f32,
) -> Option<Handle> {
    let near = |(handle, at, _): (Handle, Vec3, Vec3)| {
        let seen = camera.project(at, size)?;
        (seen.distance(pixel) <= reach).then_some((camera.depth(at), handle))
    };
    let found = handles(section).into_iter().filter_map(near);
    found.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, handle)| handle)
}

/// The section after its handle was dragged from one pixel to another; `section` is how it was when that began.
pub fn dragged(
    section: &Section,
    handle: Handle,
    camera: &Camera,
    [from, to]: [Vec2; 2],
    size: UVec2,
) -> Option<Section> {
    let (_, at, outward) = handles(section).into_iter().find(|(other, ..)| *other == handle)?;
    let along = |pixel| {
        let (eye, ray) = camera.ray(pixel, size);
        nearest_along(at, outward, eye, ray)
    };
    let by = along(to)? - along(from)?;
    let mut next = section.clone();
    match handle {
        Handle::Side(i) => next.boxed = next.boxed.map(|boxed| boxed.with_side_moved(i, by)),
        Handle::Plane(i) => {
            let plane = next.planes.get_mut(i)?;
            *plane = plane.moved(by);
        }
    }
    next.is_sound().then_some(next)
}

/// How far along a line (from a point, in a unit direction) it comes nearest to a ray; `None` where the two
/// are parallel.
fn nearest_along(at: Vec3, along: Vec3, eye: Vec3, ray: Vec3) -> Option<f32> {
    let ray = ray.try_normalize()?;
    let (between, cosine) = (eye - at, along.dot(ray));
    let sine2 = 1.0 - cosine * cosine;
    (sine2 > 1e-3).then(|| (between.dot(along) - between.dot(ray) * cosine) / sine2)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::SectionBox;
    use super::*;
    use topout_scene::{Aabb, NamedView};

    /// What is pulled follows the pointer.
    #[test]
    fn a_handle_stays_under_the_pointer() {
        let bounds = Aabb { min: Vec3::new(-5.0, 0.0, -5.0), max: Vec3::new(5.0, 20.0, 5.0) };
        let size = UVec2::new(800, 600);
        let boxed = SectionBox::around(&bounds);
        let section = Section { on: true, boxed: Some(boxed), planes: Vec::new() };
        let section = section.with_plane(Vec3::new(1.0, 10.0, 1.0), Vec3::Y);
        for parallel in [false, true] {
            let camera = Camera::fit_named(&bounds.grown(8.0), NamedView::Iso, size);
            let camera = Camera { parallel, ..camera };
            for (handle, at, outward) in handles(&section) {
                let from = camera.project(at, size).unwrap();
                let found = under(&section, &camera, from, size, REACH);
                assert_eq!(found, Some(handle), "{handle:?}");
                let to = camera.project(at + outward * 2.5, size).unwrap();
                let next = dragged(&section, handle, &camera, [from, to], size).unwrap();
                let (_, now, _) =
                    handles(&next).into_iter().find(|(other, ..)| *other == handle).unwrap();
                assert!((now - at).distance(outward * 2.5) < 0.05, "{handle:?} {now} {at}");
            }
        }
        let off = Section { on: false, ..section };
        assert!(handles(&off).is_empty());
    }
}
