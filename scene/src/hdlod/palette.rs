//! Colours: which may stand for which, and the mean where several are merged into one (H13).

use crate::Material;
use glam::Vec3;

/// Largest distance (in gamma-encoded RGB, each in [0, 1]) at which two surfaces look alike.
const ALIKE: f32 = 0.12;

/// Steps of a solid blend's colour along each gamma-encoded component.
const STEPS: u16 = 24;

/// The same for transparent blends, each in every opacity.
const CLEAR_STEPS: u16 = 12;

/// Steps of a transparent blend's opacity.
const OPACITIES: u16 = 8;

const SOLID: u16 = STEPS * STEPS * STEPS;
const BLENDS: u16 = SOLID + CLEAR_STEPS * CLEAR_STEPS * CLEAR_STEPS * OPACITIES;

/// Materials of clusters whose parts had several: they follow the model's own, so a cluster's
/// vertex names one by a number from `model.materials.len()` on. The same for all models, except
/// that a model which leaves no room for them has none.
pub fn blends(model_materials: usize) -> Vec<Material> {
    if !has_room(model_materials) {
        return Vec::new();
    }
    (0..BLENDS)
        .map(|i| {
            let (steps, place, opacity) = if i < SOLID {
                (STEPS, i, 1.0)
            } else {
                let place = (i - SOLID) / OPACITIES;
                (CLEAR_STEPS, place, f32::from((i - SOLID) % OPACITIES + 1) / f32::from(OPACITIES))
            };
            let component = |i: u16| decode(f32::from(i) / f32::from(steps - 1));
            Material {
                name: String::new(),
                color: [
                    component(place / (steps * steps)),
                    component(place / steps % steps),
                    component(place % steps),
                    opacity,
                ],
                roughness: if i < SOLID { 0.8 } else { 0.1 },
                metallic: 0.0,
                transparent: i >= SOLID,
            }
        })
        .collect()
}

fn has_room(model_materials: usize) -> bool {
    model_materials + usize::from(BLENDS) <= usize::from(u16::MAX) + 1
}

fn encode(linear: f32) -> f32 {
    linear.clamp(0.0, 1.0).powf(1.0 / 2.2)
}

fn decode(encoded: f32) -> f32 {
    encoded.powf(2.2)
}

/// Colours of all materials in a roughly perceptual space.
pub(crate) struct Palette {
    colors: Vec<Vec3>,
    opacities: Vec<f32>,
    blends_from: Option<u16>,
}

impl Palette {
    /// Of a model's materials, with the blends behind them.
    pub fn new(materials: &[Material]) -> Self {
        let blends = blends(materials.len());
        let all = || materials.iter().chain(&blends);
        let opacity = |m: &Material| if m.transparent { m.color[3].clamp(0.0, 1.0) } else { 1.0 };
        Self {
            colors: all().map(|m| Vec3::from_slice(&m.color[..3]).map(encode)).collect(),
            opacities: all().map(opacity).collect(),
            blends_from: (!blends.is_empty()).then_some(materials.len() as u16),
        }
    }

    /// Gamma-encoded RGB.
    pub fn color(&self, material: u16) -> Vec3 {
        self.colors.get(usize::from(material)).copied().unwrap_or(Vec3::ONE)
    }

    /// 1 for solid.
    pub fn opacity(&self, material: u16) -> f32 {
        self.opacities.get(usize::from(material)).copied().unwrap_or(1.0)
    }

    /// Whether a triangle of one material may be covered by one of the other at any size.
    pub fn alike(&self, a: u16, b: u16) -> bool {
        a == b || self.color(a).distance(self.color(b)) <= ALIKE
    }

    /// The material nearest to a gamma-encoded colour and an opacity, solid where `own` is: that
    /// itself where it is as near as a blend.
    pub fn blend(&self, own: u16, color: Vec3, opacity: f32) -> u16 {
        let Some(first) = self.blends_from else { return own };
        let solid = self.opacity(own) >= 1.0;
        let steps = if solid { STEPS } else { CLEAR_STEPS };
        let top = f32::from(steps - 1);
        let near = self.color(own).distance(color) <= 0.5 / top;
        let step = f32::from(OPACITIES);
        if near && (solid || (self.opacity(own) - opacity).abs() <= 0.5 / step) {
            return own;
        }
        let [r, g, b] = (color.clamp(Vec3::ZERO, Vec3::ONE) * top).round().to_array();
        let place = (r as u16 * steps + g as u16) * steps + b as u16;
        if solid {
            return first + place;
        }
        let level = (opacity * step).round().clamp(1.0, step) as u16 - 1;
        first + SOLID + place * OPACITIES + level
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn material(color: [f32; 4]) -> Material {
        Material { name: String::new(), color, roughness: 1.0, metallic: 0.0, transparent: false }
    }

    proptest! {
        #[test]
        fn a_blend_is_a_material_of_that_colour_and_opacity(
            r in 0f32..=1.0, g in 0f32..=1.0, b in 0f32..=1.0, a in 0.1f32..=1.0, n in 1usize..500,
            clear in any::<bool>(),
        ) {
            let mut own = material([0.0, 0.0, 0.0, if clear { 0.5 } else { 1.0 }]);
            own.transparent = clear;
            let palette = Palette::new(&vec![own; n]);
            let wanted = Vec3::new(r, g, b);
            let id = palette.blend(0, wanted, a);
            prop_assert!(usize::from(id) < n + blends(n).len());
            prop_assert!(palette.color(id).distance(wanted) < 0.08, "{wanted} {}", palette.color(id));
            let opacity = palette.opacity(id);
            let wanted = if clear { a } else { 1.0 };
            prop_assert!((opacity - wanted).abs() < 0.07, "{opacity} for {wanted}");
        }
    }

    #[test]
    fn a_model_with_too_many_materials_keeps_its_own() {
        let many = vec![material([1.0; 4]); 60_000];
        assert!(blends(many.len()).is_empty());
        assert_eq!(Palette::new(&many).blend(7, Vec3::ZERO, 1.0), 7);
    }
}
