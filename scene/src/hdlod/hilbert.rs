//! Positions along the three-dimensional Hilbert curve: the order in which representatives are
//! taken (H11). Skilling's transposed form ("Programming the Hilbert curve", 2004).

use crate::Aabb;
use glam::Vec3;

const BITS: u32 = 16;

/// The place of a point on the curve through `bounds`; near points mostly have near places.
pub(crate) fn position(point: Vec3, bounds: &Aabb) -> u64 {
    let cells = ((1u32 << BITS) - 1) as f32;
    let unit = (point - bounds.min) / bounds.size().max(Vec3::splat(f32::MIN_POSITIVE));
    let scaled = (unit.clamp(Vec3::ZERO, Vec3::ONE) * cells).to_array();
    interleave(curve_axes(scaled.map(|v| v as u32)))
}

fn curve_axes(mut x: [u32; 3]) -> [u32; 3] {
    let top = 1u32 << (BITS - 1);
    let mut q = top;
    while q > 1 {
        let p = q - 1;
        for i in 0..3 {
            if x[i] & q != 0 {
                x[0] ^= p;
            } else {
                let t = (x[0] ^ x[i]) & p;
                x[0] ^= t;
                x[i] ^= t;
            }
        }
        q >>= 1;
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let mut t = 0;
    q = top;
    while q > 1 {
        if x[2] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    x.map(|v| v ^ t)
}

fn interleave(x: [u32; 3]) -> u64 {
    (0..BITS).rev().fold(0u64, |code, bit| {
        x.iter().fold(code, |code, v| (code << 1) | u64::from((v >> bit) & 1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn the_curve_visits_every_cell_once_and_steps_to_a_neighbour_each_time() {
        // An 8 x 8 x 8 corner block of the full grid: the curve fills it before it leaves it.
        let mut by_place = BTreeMap::new();
        for x in 0..8u32 {
            for y in 0..8 {
                for z in 0..8 {
                    by_place.insert(interleave(curve_axes([x, y, z])), [x, y, z]);
                }
            }
        }
        assert_eq!(by_place.len(), 512);
        let cells: Vec<_> = by_place.into_values().collect();
        for pair in cells.windows(2) {
            let distance: u32 = (0..3).map(|i| pair[0][i].abs_diff(pair[1][i])).sum();
            assert_eq!(distance, 1, "{pair:?}");
        }
    }

    #[test]
    fn flat_and_empty_boxes_are_harmless() {
        let flat = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 0.0, 1.0) };
        assert_ne!(position(Vec3::ZERO, &flat), position(Vec3::new(1.0, 0.0, 1.0), &flat));
        position(Vec3::ONE, &Aabb::EMPTY);
    }
}
