//! Contraction keeps its word: distances are proved, shares are small, nothing foreign is joined.
#![allow(clippy::unwrap_used)]

use super::super::bvh::squared_distance;
use super::super::cover;
use super::super::palette::Palette;
use super::*;
use crate::{BehaviourId, Layer};
use proptest::prelude::*;
use std::f32::consts::{PI, TAU};
use topout_schedule::{Behaviour, Time};

fn triangle(corners: [Vec3; 3], normals: [Vec3; 3]) -> Triangle {
    let (material, layer, behaviour) = (0, Layer::Opaque, BehaviourId(0));
    Triangle { corners, normals: normals.map(encode_normal), material, layer, behaviour }
}

/// A closed surface around the origin: `at` gives places for angles in [0, 1] x [0, 1].
fn lathe(around: u32, along: u32, at: impl Fn(f32, f32) -> (Vec3, Vec3)) -> Vec<Triangle> {
    let place = |i: u32, j: u32| at((i % around) as f32 / around as f32, j as f32 / along as f32);
    let mut soup = Vec::new();
    for i in 0..around {
        for j in 0..along {
            let [a, b, c, d] = [place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)];
            for [p, q, r] in [[a, b, c], [a, c, d]] {
                let made = triangle([p.0, q.0, r.0], [p.1, q.1, r.1]);
                // At the poles one of the two has no area.
                if made.area() > 1e-9 {
                    soup.push(made);
                }
            }
        }
    }
    soup
}

/// With bumps of a height, at a place.
fn sphere(around: u32, along: u32, bumps: f32, center: Vec3) -> Vec<Triangle> {
    lathe(around, along, |u, v| {
        let (polar, azimuth) = (v * PI, u * TAU);
        let out = Vec3::new(
            polar.sin() * azimuth.cos(),
            if v == 1.0 { -1.0 } else { polar.cos() },
            polar.sin() * azimuth.sin(),
        );
        let out = if v == 1.0 || v == 0.0 { Vec3::Y * out.y } else { out };
        let radius = 1.0 + bumps * (azimuth * 5.0).sin() * (polar * 4.0).sin();
        (center + out * radius, out)
    })
}

fn tube(around: u32, along: u32, radius: f32, length: f32) -> Vec<Triangle> {
    lathe(around, along, |u, v| {
        let out = Vec3::new((u * TAU).cos(), 0.0, (u * TAU).sin());
        (out * radius + Vec3::Y * (v * length), out)
    })
}

fn behaviours() -> [Behaviour; 2] {
    let late = Behaviour::new(false, vec![Time::from_seconds(5)]).unwrap();
    [Behaviour::always(), late]
}

/// The farthest of many points of either soup from the other, by brute force.
fn sampled(a: &[Triangle], b: &[Triangle]) -> f32 {
    const STEPS: i32 = 5;
    let mut worst = 0f64;
    for (from, to) in [(a, b), (b, a)] {
        let to: Vec<_> = to.iter().map(|t| t.corners.map(|c| c.as_dvec3())).collect();
        for t in from {
            let [p, q, r] = t.corners.map(|c| c.as_dvec3());
            for i in 0..=STEPS {
                for j in 0..=STEPS - i {
                    let (u, v) = (f64::from(i), f64::from(j));
                    let point = p + ((q - p) * u + (r - p) * v) / f64::from(STEPS);
                    let near = to.iter().map(|t| squared_distance(point, *t));
                    worst = worst.max(near.fold(f64::INFINITY, f64::min));
                }
            }
        }
    }
    worst.sqrt() as f32
}

fn aim(source: &[Triangle], budget_m: f32, joins: Joins) -> Aim {
    Aim { budget_m, joins, fewer_than: source.len(), tries: TRIES, retries: RETRIES }
}

fn contracted(source: &[Triangle], budget_m: f32, joins: Joins) -> Option<Contracted> {
    let known = behaviours();
    let presence = PresenceTable::new(&known, true);
    contract(source, aim(source, budget_m, joins), &presence, &Progress::default()).unwrap()
}

fn simplified(source: &[Triangle], budget_m: f32, joins: Joins) -> Simplified {
    let known = behaviours();
    let presence = PresenceTable::new(&known, true);
    simplify(source, budget_m, joins, &presence, &Progress::default()).unwrap()
}

fn joins() -> impl Strategy<Value = Joins> {
    prop_oneof![Just(Joins::Edges), Just(Joins::Pairs)]
}

/// Corners on a coarse grid: points, lines, copies and edges of many triangles among them.
fn rubble() -> impl Strategy<Value = Vec<Triangle>> {
    let point = || {
        (0i32..4, 0i32..4, 0i32..3).prop_map(|(x, y, z)| Vec3::new(x as f32, y as f32, z as f32))
    };
    let one = ([point(), point(), point()], 0u16..2, any::<bool>(), 0u32..2).prop_map(
        |(corners, material, clear, behaviour)| Triangle {
            material,
            layer: if clear { Layer::Transparent } else { Layer::Opaque },
            behaviour: BehaviourId(behaviour),
            ..triangle(corners, [Vec3::Y; 3])
        },
    );
    proptest::collection::vec(one, 0..60)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// The proved distance is within the budget and no point of either soup is farther away.
    #[test]
    fn the_proved_distance_bounds_every_sample(
        around in 5u32..24, along in 3u32..14, bumps in 0f32..0.3, budget_m in 0.01f32..0.8,
        joins in joins(),
    ) {
        let source = sphere(around, along, bumps, Vec3::new(40.0, 3.0, -20.0));
        if let Some(found) = contracted(&source, budget_m, joins) {
            prop_assert!(found.triangles.len() < source.len());
            prop_assert!(found.distance_m <= budget_m);
            let sampled = sampled(&source, &found.triangles);
            prop_assert!(sampled <= found.distance_m, "{sampled} of {}", found.distance_m);
        }
    }

    /// Whatever the input is, what comes of each behaviour, material and layer is within the budget of
    /// it, both ways: nothing was joined with anything else.
    #[test]
    fn rubble_stays_what_it_is(source in rubble(), budget_m in 0.05f32..3.0, joins in joins()) {
        let result = simplified(&source, budget_m, joins);
        prop_assert!(result.distance_m <= budget_m && result.pairs.is_empty());
        prop_assert!(result.triangles.len() <= source.len());
        let of = |soup: &[Triangle], like: &Triangle| -> Vec<Triangle> {
            let key = |t: &Triangle| (t.behaviour, t.material, t.layer);
            soup.iter().filter(|t| key(t) == key(like)).copied().collect()
        };
        for group in alike(&source) {
            let like = &source[group[0] as usize];
            let sampled = sampled(&of(&source, like), &of(&result.triangles, like));
            prop_assert!(sampled <= result.distance_m.max(1e-6), "{sampled} of {}", result.distance_m);
        }
        prop_assert_eq!(alike(&result.triangles).len(), alike(&source).len());
        prop_assert_eq!(simplified(&source, budget_m, joins).triangles, result.triangles);
    }
}

#[test]
fn round_things_fall_to_a_small_share() {
    let ball = sphere(32, 16, 0.0, Vec3::ZERO);
    let pipe = tube(24, 40, 0.3, 12.0);
    for (source, budget_m, most) in [(&ball, 0.2, 0.06), (&ball, 0.02, 0.5), (&pipe, 0.1, 0.02)] {
        assert!(is_smooth(source));
        let found = contracted(source, budget_m, Joins::Edges).unwrap();
        let share = found.triangles.len() as f32 / source.len() as f32;
        assert!(share < most, "{share} of {} within {budget_m}", source.len());
    }
}

#[test]
fn a_round_thing_stays_round_to_the_light() {
    let source = sphere(32, 16, 0.0, Vec3::ZERO);
    let found = contracted(&source, 0.03, Joins::Edges).unwrap();
    for t in &found.triangles {
        for (corner, normal) in t.corners.iter().zip(t.normals) {
            let cosine = decode_normal(normal).dot(corner.normalize());
            assert!(cosine > 0.95, "{cosine} at {corner}");
        }
    }
    // Facets stay facets.
    let facets: Vec<Triangle> =
        source.iter().map(|t| triangle(t.corners, [t.cross().normalize(); 3])).collect();
    for t in contracted(&facets, 0.03, Joins::Edges).unwrap().triangles {
        let face = t.cross().normalize();
        assert!(t.normals.iter().all(|&n| decode_normal(n).dot(face) > 0.99));
    }
}

#[test]
fn boxes_and_plates_are_not_smooth() {
    let plate = lathe(4, 8, |u, v| {
        let out = Vec3::new((u * TAU).cos(), 0.0, (u * TAU).sin());
        (out + Vec3::Y * v, out)
    });
    assert!(plate.len() >= LEAST_TRIANGLES && !is_smooth(&plate));
    assert!(!is_smooth(&sphere(8, 6, 0.0, Vec3::ZERO)[..LEAST_TRIANGLES - 1]));
    assert!(!is_smooth(&[]));
}

/// Two shells a hand apart become one where pairs may be joined, and only there.
#[test]
fn pairs_join_separate_shells_of_one_behaviour() {
    let with = |behaviour: u32| {
        let mut both = sphere(12, 8, 0.0, Vec3::ZERO);
        let other = sphere(12, 8, 0.0, Vec3::new(0.0, 0.1, 2.02));
        let behaviour = BehaviourId(behaviour);
        both.extend(other.into_iter().map(|t| Triangle { behaviour, ..t }));
        both
    };
    let shells = |soup: &[Triangle]| parts::connected(soup).len();
    let one = with(0);
    assert_eq!(shells(&one), 2);
    assert_eq!(shells(&simplified(&one, 0.5, Joins::Edges).triangles), 2);
    assert_eq!(shells(&simplified(&one, 0.5, Joins::Pairs).triangles), 1);
    assert_eq!(shells(&simplified(&with(1), 0.5, Joins::Pairs).triangles), 2);
}

#[test]
fn a_fan_of_thousands_and_a_crowd_in_one_place_come_to_an_end() {
    let at = |i: u32| {
        let angle = i as f32 / 4000.0 * TAU;
        Vec3::new(angle.cos(), 0.0, angle.sin())
    };
    let fan: Vec<Triangle> =
        (0..4000).map(|i| triangle([Vec3::ZERO, at(i), at(i + 1)], [Vec3::Y; 3])).collect();
    assert!(contracted(&fan, 0.05, Joins::Edges).unwrap().triangles.len() < 100);
    let crowd: Vec<Triangle> = (0..2000)
        .map(|i| {
            let by = Vec3::new((i % 13) as f32, (i % 17) as f32, (i % 19) as f32) * 1e-3;
            triangle([by, by + Vec3::X * 0.01, by + Vec3::Z * 0.01], [Vec3::Y; 3])
        })
        .collect();
    let left = simplified(&crowd, 0.1, Joins::Pairs).triangles.len();
    assert!((1..1000).contains(&left), "{left}");
}

#[test]
fn input_that_cannot_be_contracted_stays() {
    assert!(contracted(&[], 1.0, Joins::Edges).is_none());
    let point = triangle([Vec3::ONE; 3], [Vec3::Y; 3]);
    assert!(contracted(&[point; 5], 1.0, Joins::Pairs).is_none());
    let lost = triangle([Vec3::NAN, Vec3::X, Vec3::Y], [Vec3::Y; 3]);
    assert!(contracted(&[lost; 5], 1.0, Joins::Edges).is_none());
    let ball = sphere(8, 6, 0.0, Vec3::ZERO);
    assert!(contracted(&ball, 0.0, Joins::Edges).is_none());
    assert!(contracted(&ball, f32::NAN, Joins::Edges).is_none());
    assert_eq!(simplified(&[point; 5], 1.0, Joins::Edges).triangles.len(), 5);
}

#[test]
fn cancelling_stops_it() {
    let known = behaviours();
    let presence = PresenceTable::new(&known, true);
    let progress = Progress::default();
    progress.cancel();
    let ball = sphere(32, 16, 0.0, Vec3::ZERO);
    assert!(contract(&ball, aim(&ball, 0.1, Joins::Edges), &presence, &progress).is_err());
}

/// The default simplifier contracts a round part, and its figure holds for what became of it.
#[test]
fn covers_contract_what_is_smooth() {
    let known = behaviours();
    let presence = PresenceTable::new(&known, true);
    let source = sphere(32, 16, 0.1, Vec3::new(7.0, 0.0, 3.0));
    for (budget_m, most) in [(0.05f32, 0.4), (0.2, 0.1), (0.6, 0.03)] {
        let palette = Palette::new(&[]);
        let never = Progress::default();
        let found = cover::simplify(&source, budget_m, &presence, &palette, &never).unwrap();
        let sampled = sampled(&source, &found.triangles);
        assert!(found.distance_m <= budget_m * 1.0001);
        assert!(sampled <= found.distance_m, "{sampled} of {}", found.distance_m);
        let share = found.triangles.len() as f32 / source.len() as f32;
        assert!(share < most, "{share} within {budget_m}");
    }
}
