//! What several surfaces look like together: the colours of what is merged (H13).

use super::cover::{Item, PARALLEL};
use super::palette::Palette;
use glam::Vec3;
use std::collections::HashMap;

/// Least share of its own colour that a triangle keeps when others are merged into it.
const OWN_SHARE: f32 = 0.3;

/// What several surfaces look like together.
#[derive(Clone, Copy, Default)]
pub(super) struct Mixed {
    /// Gamma-encoded, times opacity and area.
    color: Vec3,
    /// Times area.
    opacity: f32,
    area: f32,
}

impl Mixed {
    fn add(&mut self, palette: &Palette, material: u16, area: f32) {
        let opacity = palette.opacity(material);
        self.color += palette.color(material) * (opacity * area);
        self.opacity += opacity * area;
        self.area += area;
    }

    pub fn with(self, other: Self) -> Self {
        Self {
            color: self.color + other.color,
            opacity: self.opacity + other.opacity,
            area: self.area + other.area,
        }
    }

    pub fn times(self, share: f32) -> Self {
        Self { color: self.color * share, opacity: self.opacity * share, area: self.area * share }
    }

    /// What a surface looks like with all this on it or beside it. What lies on it hides it, what lies
    /// beside it adds to it; either way some of it is left.
    pub fn on(mut self, palette: &Palette, material: u16, area: f32) -> Self {
        self.add(palette, material, (area - self.area).max(area * OWN_SHARE));
        self
    }

    /// The material that looks like [`Self::on`].
    pub fn over(self, palette: &Palette, material: u16, area: f32) -> u16 {
        if self.area == 0.0 {
            return material;
        }
        let seen = self.on(palette, material, area);
        let color = seen.color / seen.opacity.max(f32::MIN_POSITIVE);
        palette.blend(material, color, seen.opacity / seen.area)
    }
}

/// Gives triangles of one material that share their longest edge, the two halves of a rectangle,
/// the same mixture: the eye sees one face.
pub(super) fn even_out(items: &mut [Item]) {
    let mut halves = HashMap::new();
    for i in 0..items.len() {
        let Item { triangle, normal, .. } = &items[i];
        let [a, b, c] = triangle.corners;
        let longest = [(a, b), (b, c), (c, a)]
            .into_iter()
            .max_by(|x, y| x.0.distance(x.1).total_cmp(&y.0.distance(y.1)))
            .expect("three edges");
        let [p, q] = [longest.0, longest.1].map(|v| v.to_array().map(f32::to_bits));
        let key = (p.min(q), p.max(q), triangle.material, triangle.behaviour);
        let Some(other) = halves.insert(key, i) else { continue };
        if normal.dot(items[other].normal).abs() > PARALLEL {
            let both = items[i].mixed.with(items[other].mixed);
            let area = items[i].area + items[other].area;
            for half in [i, other] {
                items[half].mixed = both.times(items[half].area / area);
            }
        }
    }
}
