//! Who is merged with whom at one level: representatives in Hilbert order and their neighbours in
//! space and, where asked, in time (H11, H14).

use super::hilbert;
use crate::Aabb;
use glam::{IVec3, Vec3};
use std::collections::HashMap;

/// Most children of a cluster (H14): few clusters are cheap to visit, and 32 siblings of one size
/// fill a box some three times as wide as their own, little more than one step of the ladder.
pub(crate) const MAX_DEGREE: usize = 32;

/// Neighbours looked at for one representative; bounds the work where everything is in one place.
const MAX_CANDIDATES: usize = 1024;

/// Groups active nodes whose joint box is at most `diameter_m` across. `apart` gives a distance
/// in time in [0, 1] between two nodes, or `None` where they must not be grouped.
///
/// Returns places in `bounds`; every place at most once, groups of two or more. Each
/// representative looks at a bounded number of neighbours, so the cost is that of sorting:
/// O(n log n) (H15).
pub(crate) fn group(
    bounds: &[Aabb],
    diameter_m: f32,
    apart: impl Fn(usize, usize) -> Option<f32>,
) -> Vec<Vec<u32>> {
    let all = bounds.iter().fold(Aabb::EMPTY, |a, b| a.union(b));
    let mut order: Vec<(u64, u32)> = bounds
        .iter()
        .enumerate()
        .filter(|(_, b)| b.diameter() <= diameter_m)
        .map(|(i, b)| (hilbert::position(b.center(), &all), i as u32))
        .collect();
    order.sort_unstable();

    // Centres of two members are at most a diameter apart: with cells of half that, neighbours
    // within two cells. One cell each way finds the nearer half, which is what a group takes.
    let cell = (diameter_m * 0.5).max(f32::MIN_POSITIVE);
    let cell_of = |p: Vec3| ((p - all.min) / cell).floor().as_ivec3();
    let mut cells: HashMap<IVec3, Vec<u32>> = HashMap::new();
    for &(_, i) in &order {
        cells.entry(cell_of(bounds[i as usize].center())).or_default().push(i);
    }

    let mut taken = vec![false; bounds.len()];
    let mut groups = Vec::new();
    let mut near: Vec<(f32, u32)> = Vec::new();
    for &(_, representative) in &order {
        let own = representative as usize;
        if taken[own] {
            continue;
        }
        let center = bounds[own].center();
        let middle = cell_of(center);
        near.clear();
        for step in NEIGHBOURHOOD {
            let Some(list) = cells.get_mut(&(middle + IVec3::from_array(step))) else { continue };
            list.retain(|&i| !taken[i as usize]);
            for &i in list.iter() {
                let other = &bounds[i as usize];
                if i == representative || bounds[own].union(other).diameter() > diameter_m {
                    continue;
                }
                if let Some(time) = apart(own, i as usize) {
                    near.push((center.distance(other.center()) / diameter_m + time, i));
                }
                if near.len() >= MAX_CANDIDATES {
                    break;
                }
            }
            if near.len() >= MAX_CANDIDATES {
                break;
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut joint = bounds[own];
        let mut members = vec![representative];
        for &(_, i) in &near {
            let grown = joint.union(&bounds[i as usize]);
            if grown.diameter() <= diameter_m {
                joint = grown;
                members.push(i);
                if members.len() == MAX_DEGREE {
                    break;
                }
            }
        }
        if members.len() > 1 {
            for &i in &members {
                taken[i as usize] = true;
            }
            groups.push(members);
        }
    }
    groups
}

/// A cell and the 26 around it, the nearest first.
const NEIGHBOURHOOD: [[i32; 3]; 27] = {
    let mut steps = [[0; 3]; 27];
    let mut at = 0;
    let mut reach = 0;
    while reach <= 3 {
        let mut i = 0;
        while i < 27 {
            let step = [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1];
            if step[0] * step[0] + step[1] * step[1] + step[2] * step[2] == reach {
                steps[at] = step;
                at += 1;
            }
            i += 1;
        }
        reach += 1;
    }
    steps
};

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn groups_are_disjoint_bounded_and_small(
            points in proptest::collection::vec((0f32..50.0, 0f32..50.0, 0f32..5.0, 0f32..2.0), 0..200),
            diameter in 0.5f32..40.0,
        ) {
            let bounds: Vec<Aabb> = points
                .iter()
                .map(|&(x, y, z, r)| Aabb { min: Vec3::new(x, y, z), max: Vec3::new(x, y, z) + r })
                .collect();
            let groups = group(&bounds, diameter, |_, _| Some(0.0));
            let mut seen = std::collections::HashSet::new();
            for members in &groups {
                prop_assert!((2..=MAX_DEGREE).contains(&members.len()));
                let joint = members.iter().fold(Aabb::EMPTY, |a, &i| a.union(&bounds[i as usize]));
                prop_assert!(joint.diameter() <= diameter);
                for &i in members {
                    prop_assert!(seen.insert(i));
                }
            }
        }
    }

    #[test]
    fn a_row_of_neighbours_leaves_nobody_alone_and_time_keeps_apart() {
        let bounds: Vec<Aabb> = (0..64)
            .map(|i| Aabb { min: Vec3::X * i as f32, max: Vec3::X * i as f32 + 0.5 })
            .collect();
        let grouped: usize = group(&bounds, 8.0, |_, _| Some(0.0)).iter().map(Vec::len).sum();
        assert!(grouped >= 60, "{grouped}");
        let early_late = |a: usize, b: usize| ((a & 1) == (b & 1)).then_some(0.0);
        for members in group(&bounds, 8.0, early_late) {
            assert!(members.iter().all(|i| i & 1 == members[0] & 1), "{members:?}");
        }
    }

    #[test]
    fn everything_in_one_place_is_grouped_in_bounded_groups() {
        let bounds = vec![Aabb { min: Vec3::ZERO, max: Vec3::ONE }; 5000];
        let groups = group(&bounds, 2.0, |_, _| Some(0.0));
        assert_eq!(groups.iter().map(Vec::len).sum::<usize>(), 5000);
    }
}
