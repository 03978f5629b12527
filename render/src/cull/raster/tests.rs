//! Occluders are never too large or too near, what is asked for never too small or too far.

use super::*;
use glam::DVec2;
use topout_scene::{Clip, View};

const SIZE: i32 = 24;

fn empty() -> Depth {
    let mut depth = Depth::default();
    depth.clear([IVec2::ZERO, IVec2::splat(SIZE)]);
    depth
}

fn screen() -> Screen {
    let projection = Projection::Orthographic { height: 1.0 };
    let (size, area) = (UVec2::splat(SIZE as u32), [IVec2::ZERO, IVec2::splat(SIZE)]);
    Screen::new(Mat4::IDENTITY, projection, size, area, 1, 0.0)
}

fn along_z() -> View {
    View {
        eye: Vec3::ZERO,
        target: Vec3::NEG_Z,
        up: Vec3::Y,
        projection: Projection::Perspective { fov_y: View::FOV_Y },
        size: UVec2::splat(SIZE as u32),
        tolerance_px: 1.0,
        clip: Clip::NONE,
    }
}

fn seen_by(view: &View) -> Screen {
    let area = [IVec2::ZERO, view.size.as_ivec2()];
    let clip_from_world = view.clip_from_world(10.0);
    Screen::new(clip_from_world, view.projection, view.size, area, 1, 10.0)
}

/// Triangles from tiny to larger than the picture, some of them slivers, some partly outside.
fn triangles() -> impl Iterator<Item = [Corner; 3]> {
    let mut state = 7u32;
    let mut next = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    (0..4000).map(move |i| {
        let reach = [0.5, 2.0, 9.0, 60.0][i % 4];
        let middle = Vec2::new(next(), next()) * SIZE as f32;
        let mut corner = || {
            let offset = Vec2::new(next() - 0.5, next() - 0.5) * reach;
            (middle + offset).extend(0.1 + 0.8 * next()).extend(1.0)
        };
        let [a, b, c] = [corner(), corner(), corner()];
        let sliver = (a + b) * 0.5 + (c - a) * 1e-3;
        [a, b, if i % 5 == 0 { sliver } else { c }]
    })
}

/// How far inside all three edges a pixel's middle lies, and the depth there, exactly.
fn truth([a, b, c]: [Corner; 3], x: i32, y: i32) -> (f64, f64) {
    let p = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
    let flat = |v: Vec4| DVec2::new(v.x.into(), v.y.into());
    let area = (flat(b) - flat(a)).perp_dot(flat(c) - flat(a));
    let share = |from: Vec4, to: Vec4| (flat(to) - flat(from)).perp_dot(p - flat(from)) / area;
    let distance =
        |from: Vec4, to: Vec4| share(from, to) * area.abs() / flat(from).distance(flat(to));
    let inside = distance(a, b).min(distance(b, c)).min(distance(c, a));
    let depth =
        share(b, c) * f64::from(a.z) + share(c, a) * f64::from(b.z) + share(a, b) * f64::from(c.z);
    (inside, depth)
}

/// What the GPU clips at the near or far plane is known as such, in both projections: it hides nothing.
#[test]
fn what_is_clipped_is_known() {
    let mut view = along_z();
    let corner = |view: &View, z: f32| seen_by(view).corner([0.0, 0.0, z]);
    let clipped = |view: &View, z: f32| corner(view, z).w == f32::INFINITY;
    assert!(clipped(&view, -0.5 * view.near()) && clipped(&view, 5.0));
    let middle = SIZE as f32 / 2.0;
    assert!(
        corner(&view, -5.0).abs_diff_eq(Vec4::new(middle, middle, view.near() / 5.0, 0.2), 1e-5)
    );
    assert!(!clipped(&view, -1e6));
    view.projection = Projection::Orthographic { height: 4.0 };
    assert!(clipped(&view, -11.0) && clipped(&view, 11.0));
    assert!(!clipped(&view, -9.0) && !clipped(&view, 9.0));
}

fn may_be_seen(triangle: [Corner; 3], depth: &Depth) -> bool {
    match screen().look(triangle, depth) {
        Visible::No => false,
        Visible::Yes => true,
        Visible::Perhaps(box_px) => screen().look_closely(triangle, depth, box_px),
    }
}

fn every_pixel() -> impl Iterator<Item = (i32, i32)> {
    (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y)))
}

fn occlude(triangle: [Corner; 3], depth: &mut Depth) {
    screen().occlude(triangle, depth);
    depth.finish(&[]);
}

/// Drawn as an occluder a triangle covers only pixels whose middle it covers, none that is well
/// inside is left out, and it is never nearer than it is.
#[test]
fn an_occluder_hides_no_more_than_it_covers() {
    let mut covered = 0;
    for triangle in triangles() {
        let mut depth = empty();
        occlude(triangle, &mut depth);
        for (x, y) in every_pixel() {
            let drawn = depth.texels[depth.grid.row(y, [x, x])][0];
            let (inside, exact) = truth(triangle, x, y);
            if drawn > 0.0 {
                assert!(inside > 0.0, "{triangle:?} at {x}, {y}: {inside}");
                assert!(f64::from(drawn) <= exact, "{triangle:?} at {x}, {y}");
                covered += 1;
            } else {
                assert!(inside < 0.05, "{triangle:?} at {x}, {y}: {inside}");
            }
        }
    }
    assert!(covered > 50_000, "{covered}");
}

/// A triangle that covers the middle of a pixel is seen on an empty picture, over itself and over
/// what lies a little behind it at that pixel; it is hidden where everything is nearer.
#[test]
fn what_covers_a_pixel_that_nothing_hides_is_seen() {
    let (mut seen, mut not) = (0, 0);
    for triangle in triangles() {
        let inside: Vec<_> =
            every_pixel().filter(|&(x, y)| truth(triangle, x, y).0 > 0.0).collect();
        if inside.is_empty() {
            not += u32::from(!may_be_seen(triangle, &empty()));
            continue;
        }
        seen += 1;
        assert!(may_be_seen(triangle, &empty()), "{triangle:?}");
        let mut own = empty();
        occlude(triangle, &mut own);
        assert!(may_be_seen(triangle, &own), "{triangle:?} hides itself");
        // Everything is nearer, but at one pixel.
        let mut wall = empty();
        wall.texels.fill(0.95);
        assert!(!may_be_seen(triangle, &wall), "{triangle:?} shines through");
        let (x, y) = inside[inside.len() / 2];
        let hole = wall.grid.row(y, [x, x]);
        wall.texels[hole][0] = truth(triangle, x, y).1 as f32 * 0.99999;
        assert!(may_be_seen(triangle, &wall), "{triangle:?} not seen at {x}, {y}");
    }
    assert!(seen > 1000 && not > 1000, "{seen} {not}");
}

/// Triangles around the eye, most of them partly behind it: as occluders they cover only pixels whose line
/// of sight meets them, are never nearer than there, and most of what they cover is drawn.
#[test]
fn what_is_partly_clipped_hides_no_more_than_it_covers() {
    let mut state = 3u32;
    let mut next = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32 - 0.5
    };
    let view = along_z();
    let tan = f64::from((View::FOV_Y * 0.5).tan());
    let (mut drawn, mut met) = (0, 0);
    for i in 0..3000 {
        let reach = [1.0, 5.0, 20.0][i % 3];
        let mut corner = || [next() * reach, next() * reach, next() * reach - 0.2];
        let corners = [corner(), corner(), corner()];
        let mut depth = empty();
        seen_by(&view).occlude_polygon(&corners, &mut depth);
        let [a, b, c] = corners.map(|p| Vec3::from(p).as_dvec3());
        for (x, y) in every_pixel() {
            let at = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / f64::from(SIZE) * 2.0 - 1.0;
            let sight = glam::DVec3::new(at.x * tan, -at.y * tan, -1.0);
            let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| sight.dot(p.cross(q)));
            let inside = sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0);
            let normal = (b - a).cross(c - a);
            let away = normal.dot(a) / normal.dot(sight);
            let near = f64::from(view.near());
            let hit = inside && away >= near;
            met += u32::from(hit);
            let texel = f64::from(depth.texels[depth.grid.index(x, y)]);
            if texel > 0.0 {
                drawn += 1;
                assert!(hit, "{corners:?} at {x}, {y}");
                assert!(texel <= near / away, "{corners:?} at {x}, {y}: {texel}");
            }
        }
    }
    assert!(drawn > 100_000 && drawn * 10 > met * 8, "{drawn} of {met}");
}

/// A box is hidden behind a wall in front of all of it, and by nothing less.
#[test]
fn a_box_is_hidden_only_behind_what_covers_it() {
    let screen = seen_by(&along_z());
    let corners =
        topout_scene::Aabb { min: Vec3::new(-1.0, -1.0, -7.0), max: Vec3::new(1.0, 1.0, -5.0) };
    let wall = |half: f32, z: f32| {
        let at = |x: f32, y: f32| [x * half, y * half, z];
        let mut depth = empty();
        let wall = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        screen.occlude_polygon(&wall, &mut depth);
        depth.finish(&[]);
        depth
    };
    let shows = |depth: &Depth| screen.may_show(corners.corners(), depth);
    assert!(shows(&empty()), "nothing before it");
    assert!(!shows(&wall(2.0, -4.0)), "a wall before it");
    assert!(!shows(&wall(30.0, -4.0)), "a wall far larger than the picture");
    assert!(shows(&wall(2.0, -8.0)), "a wall behind it");
    assert!(shows(&wall(2.0, -6.0)), "a wall through it");
    assert!(shows(&wall(0.5, -4.0)), "a wall that is too small");
}
