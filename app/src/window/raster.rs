//! Points of the window on pixels of the picture.

use egui::{Pos2, Rect};
use glam::{UVec2, Vec2};

/// Where the picture is, and how many pixels it has: as many as the screen has there, or fewer in both
/// directions alike where the device has no textures so large.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Raster {
    /// Where the picture is, points; never less than nothing.
    pub place: Rect,
    /// Pixels across and down, at least one.
    pub size: UVec2,
    /// Pixels of the picture a point.
    pub per_point: f32,
}

impl Raster {
    /// `largest` is how many pixels a texture may have across or down.
    pub fn new(place: Rect, pixels_per_point: f32, largest: u32) -> Self {
        // Panels may have taken more than there is.
        let size = place.size().max(egui::Vec2::ZERO);
        let place = Rect::from_min_size(place.min, size);
        let wanted = size.max_elem() * pixels_per_point;
        let per_point = pixels_per_point * (largest as f32 / wanted.max(1.0)).min(1.0);
        let pixels = |points: f32| ((points * per_point).round() as u32).clamp(1, largest.max(1));
        Self { place, size: UVec2::new(pixels(size.x), pixels(size.y)), per_point }
    }

    /// The pixel at a point of the window, with its fraction.
    pub fn pixel(&self, point: Pos2) -> Vec2 {
        let from = (point - self.place.min) * self.per_point;
        Vec2::new(from.x, from.y)
    }

    /// The point of the window at a pixel.
    pub fn point(&self, pixel: Vec2) -> Pos2 {
        self.place.min + egui::vec2(pixel.x, pixel.y) / self.per_point
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raster(width: f32, height: f32, pixels_per_point: f32) -> Raster {
        let place = Rect::from_min_size(Pos2::new(10.0, 20.0), egui::vec2(width, height));
        Raster::new(place, pixels_per_point, 16_384)
    }

    #[test]
    fn a_picture_has_the_pixels_of_the_screen_and_a_texture_has_room_for_it() {
        for ((width, height, scale), size) in [
            ((640.0, 480.0, 1.0), [640, 480]),
            ((640.5, 480.0, 1.5), [961, 720]),
            ((0.3, 0.0, 2.0), [1, 1]),
            ((-200.0, 5.0, 1.0), [1, 5]),
            ((16_384.0, 100.0, 1.0), [16_384, 100]),
            ((8_192.0, 4_096.0, 4.0), [16_384, 8_192]),
            ((1.0e6, 10.0, 3.0), [16_384, 1]),
        ] {
            let raster = raster(width, height, scale);
            assert_eq!(raster.size, UVec2::from(size), "{width} x {height} at {scale}");
            assert!(raster.place.width() >= 0.0 && raster.place.height() >= 0.0);
        }
    }

    #[test]
    fn points_and_pixels_lie_on_each_other_also_in_a_reduced_picture() {
        for scale in [1.0, 1.5, 3.0, 50.0] {
            let raster = raster(800.0, 500.0, scale);
            let corner = raster.pixel(raster.place.max);
            assert!((corner - raster.size.as_vec2()).abs().max_element() <= 1.0, "{scale}");
            let point = Pos2::new(333.0, 222.0);
            assert!((raster.point(raster.pixel(point)) - point).length() < 0.01, "{scale}");
        }
    }
}
