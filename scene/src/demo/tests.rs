#![allow(clippy::unwrap_used)]
use super::*;
use std::collections::{HashMap, HashSet};
use topout_schedule::{Activity, ActivityKind, Behaviour, Preset, Time};

fn demo(elements: usize) -> (Model, Schedule) {
    generate(&DemoSettings::for_elements(elements), &Progress::default()).unwrap()
}

/// Presence as the linker computes it, for schedules whose activities of one element do not overlap
/// in other ways than the demo's: events in time order, presence last at one instant.
fn behaviour(activities: &[&Activity]) -> Behaviour {
    let active: Vec<_> =
        activities.iter().filter(|a| a.active && a.kind != ActivityKind::Neutral).collect();
    if active.is_empty() {
        let inactive = activities.iter().any(|a| !a.active);
        return if inactive { Behaviour::never() } else { Behaviour::always() };
    }
    let mut events = Vec::new();
    for a in &active {
        let (start, end) = (a.start.unwrap(), a.end.unwrap());
        match a.kind {
            ActivityKind::Construct => events.push((start, true)),
            ActivityKind::Demolish => events.push((end, false)),
            _ => events.extend([(start, true), (end, false)]),
        }
    }
    events.sort();
    let first = active.iter().min_by_key(|a| (a.start, a.end)).unwrap();
    let initial = first.kind == ActivityKind::Demolish;
    let mut on = initial;
    let mut toggles: Vec<Time> = Vec::new();
    for (time, value) in events {
        if value == on {
            continue;
        }
        on = value;
        if toggles.last() == Some(&time) {
            toggles.pop();
        } else {
            toggles.push(time);
        }
    }
    Behaviour::new(initial, toggles).unwrap()
}

fn behaviours(model: &Model, schedule: &Schedule) -> Vec<Behaviour> {
    let mut of: HashMap<&str, Vec<&Activity>> = HashMap::new();
    for a in &schedule.activities {
        for e in &a.elements {
            of.entry(e.as_str()).or_default().push(a);
        }
    }
    let none = Vec::new();
    model.elements.iter().map(|e| behaviour(of.get(e.name.as_str()).unwrap_or(&none))).collect()
}

#[test]
fn counts_are_exact() {
    for elements in [1_000, 1_001, 1_777, 5_000, 20_000] {
        let settings = DemoSettings::for_elements(elements);
        let (model, schedule) = demo(elements);
        assert_eq!(model.elements.len(), elements);
        assert_eq!(model.triangle_count(), settings.triangles, "{elements}");
        assert_eq!(schedule.activities.len(), settings.activities, "{elements}");
    }
}

#[test]
fn smallest_project_exists_for_any_seed() {
    for seed in 0..24 {
        let settings = DemoSettings { seed, ..DemoSettings::for_elements(1_000) };
        let (model, schedule) = generate(&settings, &Progress::default()).unwrap();
        assert_eq!((model.elements.len(), schedule.activities.len()), (1_000, settings.activities));
    }
}

#[test]
fn default_is_the_papers_scene() {
    let (model, schedule) = generate(&DemoSettings::default(), &Progress::default()).unwrap();
    assert_eq!(model.elements.len(), 79_396);
    assert_eq!(model.triangle_count(), 3_632_126);
    assert_eq!(schedule.activities.len(), 67_099);
    let period = schedule.period;
    assert_eq!(period.start.to_string(), "2026-03-03T08:00:00");
    assert_eq!(period.end.to_string(), "2028-07-24T13:00:00");
    let times: HashSet<Time> =
        schedule.activities.iter().flat_map(|a| [a.start.unwrap(), a.end.unwrap()]).collect();
    assert!(times.len() >= 14_000, "{}", times.len());

    let behaviours = behaviours(&model, &schedule);
    let share = |fraction: f64| {
        let time = period.at_fraction(fraction);
        let shown = model.elements.iter().zip(&behaviours).filter(|(_, b)| b.at(time));
        shown.map(|(e, _)| model.triangles_of(e)).sum::<usize>() as f64 / 3_632_126.0
    };
    let (start, third, two, end) = (share(0.0), share(1.0 / 3.0), share(2.0 / 3.0), share(0.999));
    println!("present: {start:.3} {third:.3} {two:.3} {end:.3}");
    assert!((0.18..0.36).contains(&third), "{third}");
    assert!((0.55..0.78).contains(&two), "{two}");
    assert!(start < third && third < two && two < end);

    let mut count: HashMap<Preset, usize> = HashMap::new();
    behaviours.iter().for_each(|b| *count.entry(b.preset(period)).or_default() += 1);
    println!("{count:?}");
    let bounds = model.bounds();
    println!("bounds {bounds:?} diagonal {}, meshes {}", bounds.diameter(), model.meshes.len());
    assert!((450.0..560.0).contains(&bounds.diameter()));
    assert!((300..5_000).contains(&model.meshes.len()));
}

#[test]
fn all_eight_behaviours_occur_at_any_size() {
    for elements in [1_000, 20_000] {
        let (model, schedule) = demo(elements);
        let found: HashSet<Preset> =
            behaviours(&model, &schedule).iter().map(|b| b.preset(schedule.period)).collect();
        for preset in [
            Preset::Static,
            Preset::Absent,
            Preset::Installed,
            Preset::Removed,
            Preset::Temporary,
            Preset::Skipped,
            Preset::ReInstalled,
            Preset::ReDeleted,
        ] {
            assert!(found.contains(&preset), "{elements}: {preset:?}");
        }
        assert!(!found.contains(&Preset::Other));
    }
}

#[test]
fn same_seed_same_project() {
    let settings = DemoSettings::for_elements(3_000);
    let text = |seed| {
        let settings = DemoSettings { seed, ..settings };
        let (model, schedule) = generate(&settings, &Progress::default()).unwrap();
        let places: Vec<_> = model.instances.iter().map(|i| (i.mesh, i.world_from_mesh)).collect();
        format!("{:?} {places:?} {:?}", model.elements, schedule.activities)
    };
    let first = text(4);
    assert_eq!(first, text(4));
    assert_ne!(first, text(5));
}

#[test]
fn names_are_unique_and_links_lead_somewhere() {
    let (model, schedule) = demo(20_000);
    let names: HashSet<&str> = model.elements.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names.len(), model.elements.len());
    let guids: HashSet<_> = model.elements.iter().map(|e| e.guid.clone().unwrap()).collect();
    assert_eq!(guids.len(), model.elements.len());
    assert!(guids.iter().all(|g| g.len() == 22));
    let ids: HashSet<&str> = schedule.activities.iter().map(|a| a.id.as_str()).collect();
    assert_eq!(ids.len(), schedule.activities.len());
    for a in &schedule.activities {
        assert!(!a.elements.is_empty(), "{}", a.name);
        assert!(a.elements.iter().all(|e| names.contains(e.as_str())), "{}", a.name);
        assert!(a.start < a.end, "{}", a.name);
        assert!(schedule.period.start <= a.start.unwrap() && a.end.unwrap() <= schedule.period.end);
    }
    let starts = schedule.activities.iter().filter_map(|a| a.start).min().unwrap();
    let ends = schedule.activities.iter().filter_map(|a| a.end).max().unwrap();
    assert_eq!((starts, ends), (schedule.period.start, schedule.period.end));
}

#[test]
fn work_happens_in_working_hours() {
    let (_, schedule) = demo(5_000);
    for a in &schedule.activities {
        for time in [a.start.unwrap(), a.end.unwrap()] {
            let day = time.seconds().div_euclid(86_400);
            assert!((day + 3).rem_euclid(7) < 5, "{} {time}", a.name);
            let hour = time.seconds().rem_euclid(86_400) as f64 / 3600.0;
            assert!((8.0..=17.0).contains(&hour), "{} {time}", a.name);
        }
    }
}

#[test]
fn meshes_are_sound() {
    for elements in [1_000, 5_000, 20_000] {
        let (model, _) = demo(elements);
        for (m, mesh) in model.meshes.iter().enumerate() {
            assert_eq!(mesh.indices.len() % 3, 0);
            assert!(mesh.opaque as usize <= mesh.indices.len());
            for (t, corners) in mesh.indices.chunks(3).enumerate() {
                let [a, b, c] = [0, 1, 2].map(|k| mesh.vertices[corners[k] as usize]);
                let [pa, pb, pc] = [a, b, c].map(|v| glam::Vec3::from(v.position));
                assert!(pa.is_finite() && pb.is_finite() && pc.is_finite());
                let cross = (pb - pa).cross(pc - pa);
                assert!(cross.length() > 1e-7, "mesh {m} triangle {t}: {pa} {pb} {pc}");
                // The winding agrees with the normal that shades it.
                let normal = crate::decode_normal(a.normal);
                assert!(normal.dot(cross) > 0.0, "mesh {m} triangle {t}: {normal} {cross}");
                let transparent = model.materials[usize::from(a.material)].transparent;
                assert_eq!(transparent, t * 3 >= mesh.opaque as usize);
            }
        }
        for e in &model.elements {
            let all = model.instances_of(e).iter().fold(crate::Aabb::EMPTY, |all, i| {
                let mesh = &model.meshes[i.mesh.index()];
                let points = mesh.vertices.iter();
                all.union(&crate::Aabb::of_points(
                    points.map(|v| i.world_from_mesh.transform_point3(v.position.into())),
                ))
            });
            assert!((all.min - e.bounds.min).abs().max_element() < 1e-3, "{}", e.name);
            assert!((all.max - e.bounds.max).abs().max_element() < 1e-3, "{}", e.name);
            assert!(!e.bounds.is_empty() && e.bounds.size().max_element() > 0.0);
        }
    }
}

#[test]
fn storeys_rise_one_after_the_other() {
    for elements in [1_000, 20_000] {
        let (model, schedule) = demo(elements);
        let behaviours = behaviours(&model, &schedule);
        let mut first: HashMap<(String, &str), (Time, Time)> = HashMap::new();
        for (e, b) in model.elements.iter().zip(&behaviours) {
            let mut parts = e.name.split('_');
            let (kind, storey) = (parts.next().unwrap(), parts.next().unwrap());
            if ["SLB", "COL", "COR"].contains(&kind) && storey.starts_with('S') {
                let time = b.toggles()[0];
                let entry = first.entry((storey.to_owned(), kind)).or_insert((time, time));
                *entry = (entry.0.min(time), entry.1.max(time));
            }
        }
        for storey in 1.. {
            let at = |s: i32, kind| first.get(&(format!("S{s:02}"), kind));
            let Some(slab) = at(storey, "SLB") else {
                assert!(storey > 2);
                break;
            };
            // Every column below stands before the plate is cast, and the plate before its columns.
            assert!(at(storey - 1, "COL").unwrap().1 <= slab.0, "{elements}: {storey}");
            if let Some(columns) = at(storey, "COL") {
                assert!(slab.1 <= columns.0, "{elements}: {storey}");
            }
        }
    }
}

#[test]
fn impossible_numbers_are_refused() {
    let progress = Progress::default();
    let base = DemoSettings::for_elements(1_000);
    for elements in [0, 999, 1_000_001, usize::MAX] {
        let error = generate(&DemoSettings { elements, ..base }, &progress).unwrap_err();
        assert_eq!(error, DemoError::Elements { wanted: elements });
    }
    for triangles in [0, 11_000, usize::MAX] {
        let error = generate(&DemoSettings { triangles, ..base }, &progress).unwrap_err();
        let DemoError::Triangles { least, most, .. } = error else { panic!("{error}") };
        for triangles in [least, most] {
            let (model, _) = generate(&DemoSettings { triangles, ..base }, &progress).unwrap();
            assert_eq!(model.triangle_count(), triangles);
        }
    }
    for activities in [0, usize::MAX] {
        let error = generate(&DemoSettings { activities, ..base }, &progress).unwrap_err();
        let DemoError::Activities { least, most, .. } = error else { panic!("{error}") };
        for activities in [least, most] {
            let settings = DemoSettings { activities, ..base };
            let (_, schedule) = generate(&settings, &progress).unwrap();
            assert_eq!(schedule.activities.len(), activities);
        }
    }
}

#[test]
fn cancelling_stops() {
    let progress = Progress::default();
    progress.cancel();
    let error = generate(&DemoSettings::for_elements(1_000), &progress).unwrap_err();
    assert_eq!(error, DemoError::Cancelled(Cancelled));
}
