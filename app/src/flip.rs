//! How different two pictures look to a person: NVIDIA's FLIP over the pixels that matter.

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageFloat, FlipImageRgb8, flip, magma_lut};
use topout_render::Picture;

/// How much one picture differs from another.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Difference {
    /// Mean FLIP of the whole picture: 0 the same, 1 as different as can be.
    pub mean: f32,
    /// Mean FLIP of the pixels that show an element in either picture; 0 where none does.
    pub elements: f32,
    /// The largest mean FLIP of any tile of [`Difference::TILE`] x [`Difference::TILE`] pixels: it
    /// sees what is wrong at one place alone.
    pub worst_tile: f32,
    /// Relative change of the number of pixels that show an element: -0.1 means a tenth fewer.
    /// 0 where the reference shows none and the other none either; 1 where only the other does.
    pub coverage_change: f32,
}

impl Difference {
    /// From here on, of [`Difference::elements`], HDLOD shows another picture than full detail.
    ///
    /// Measured by `bench demo` at 1280 x 720 and a tolerance of one pixel: 0.10 to 0.17, the more
    /// the farther away. Leaving out every element gives 0.5 and more (`tests/golden_demo.rs`).
    pub const ANOTHER_PICTURE: f32 = 0.25;

    /// Edge of the tiles in pixels. They overlap by half.
    pub const TILE: u32 = 16;

    /// Compares at 67 pixels per degree: a 0.7 m wide 4K screen seen from 0.7 m.
    ///
    /// # Errors
    /// When the pictures are not of one size.
    pub fn between(reference: &Picture, test: &Picture) -> anyhow::Result<Self> {
        Ok(Self::of(&map(reference, test)?, reference, test))
    }

    /// The same, and the difference pixel by pixel as colours, three bytes each: black where there is none,
    /// over violet and red to a pale yellow.
    ///
    /// # Errors
    /// When the pictures are not of one size.
    pub fn with_colors(reference: &Picture, test: &Picture) -> anyhow::Result<(Self, Vec<u8>)> {
        let map = map(reference, test)?;
        let colors = map.apply_color_lut(&magma_lut()).to_vec();
        Ok((Self::of(&map, reference, test), colors))
    }

    fn of(map: &FlipImageFloat, reference: &Picture, test: &Picture) -> Self {
        let map = map.to_vec();
        let mut sums = [0f64; 2];
        let mut shown = [0u64; 3];
        let masks = mask(reference).zip(mask(test));
        for (value, (in_reference, in_test)) in map.iter().zip(masks) {
            sums[0] += f64::from(*value);
            if in_reference || in_test {
                sums[1] += f64::from(*value);
                shown[0] += 1;
            }
            shown[1] += u64::from(in_reference);
            shown[2] += u64::from(in_test);
        }
        Self {
            mean: (sums[0] / map.len().max(1) as f64) as f32,
            elements: (sums[1] / shown[0].max(1) as f64) as f32,
            worst_tile: worst_tile(&map, reference.width as usize, Self::TILE as usize),
            coverage_change: relative_change(shown[1], shown[2]),
        }
    }

    /// The mean of several comparisons, and the worst tile of all; no difference for none.
    pub fn mean_of(all: &[Self]) -> Self {
        let n = all.len().max(1) as f32;
        Self {
            mean: all.iter().map(|d| d.mean).sum::<f32>() / n,
            elements: all.iter().map(|d| d.elements).sum::<f32>() / n,
            worst_tile: all.iter().map(|d| d.worst_tile).fold(0.0, f32::max),
            coverage_change: all.iter().map(|d| d.coverage_change).sum::<f32>() / n,
        }
    }
}

fn map(reference: &Picture, test: &Picture) -> anyhow::Result<FlipImageFloat> {
    let size = (reference.width, reference.height);
    anyhow::ensure!(
        size == (test.width, test.height),
        "pictures of {}x{} and {}x{} pixels cannot be compared",
        size.0,
        size.1,
        test.width,
        test.height
    );
    let image = |p: &Picture| FlipImageRgb8::with_data(size.0, size.1, &rgb(p));
    Ok(flip(image(reference), image(test), DEFAULT_PIXELS_PER_DEGREE))
}

/// Tiles that would stick out at the right or below are left out: their pixels lie in the tile
/// before, but for those of a rest smaller than half a tile.
fn worst_tile(map: &[f32], width: usize, tile: usize) -> f32 {
    let height = map.len() / width.max(1);
    let (tile_w, tile_h) = (tile.min(width), tile.min(height));
    let mut worst = 0.0f32;
    for top in (0..=height - tile_h).step_by(tile / 2) {
        for left in (0..=width - tile_w).step_by(tile / 2) {
            let rows = (top..top + tile_h).map(|y| &map[y * width + left..][..tile_w]);
            let sum: f32 = rows.map(|row| row.iter().sum::<f32>()).sum();
            worst = worst.max(sum / (tile_w * tile_h).max(1) as f32);
        }
    }
    worst
}

fn relative_change(from: u64, to: u64) -> f32 {
    match (from, to) {
        (0, 0) => 0.0,
        (0, _) => 1.0,
        _ => ((to as f64 - from as f64) / from as f64) as f32,
    }
}

/// Whether each pixel shows an element.
fn mask(picture: &Picture) -> impl Iterator<Item = bool> {
    picture.rgba.chunks_exact(4).map(|p| p[3] > 127)
}

/// The colours without the mask.
pub fn rgb(picture: &Picture) -> Vec<u8> {
    picture.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A blue sky with a grey block of `width` columns in front of it.
    fn block(width: u32) -> Picture {
        let size = 64;
        let rgba = (0..size * size)
            .flat_map(|i| if i % size < width { [120, 115, 110, 255] } else { [150, 190, 230, 0] })
            .collect();
        Picture { width: size, height: size, rgba }
    }

    #[test]
    fn the_same_picture_does_not_differ() {
        assert_eq!(Difference::between(&block(30), &block(30)).unwrap(), Difference::default());
    }

    #[test]
    fn leaving_out_every_element_is_visible() {
        let d = Difference::between(&block(30), &block(0)).unwrap();
        assert!(d.elements > Difference::ANOTHER_PICTURE, "{d:?}");
        assert_eq!(d.coverage_change, -1.0);
    }

    #[test]
    fn the_sky_does_not_dilute_the_figure() {
        let (small, large) = (
            Difference::between(&block(4), &block(0)).unwrap(),
            Difference::between(&block(40), &block(0)).unwrap(),
        );
        assert!(small.elements > Difference::ANOTHER_PICTURE, "{small:?}");
        assert!(small.mean < 0.25 * large.mean, "{small:?} {large:?}");
    }

    #[test]
    fn what_is_wrong_at_one_place_alone_shows_in_its_tile() {
        let (whole, mut spoilt) = (block(60), block(60));
        for y in 20..26 {
            for x in 20..26 {
                spoilt.rgba[(y * 64 + x) * 4..][..3].copy_from_slice(&[255, 0, 0]);
            }
        }
        let d = Difference::between(&whole, &spoilt).unwrap();
        assert!(d.elements < 0.02, "{d:?}");
        assert!(d.worst_tile > 5.0 * d.elements, "{d:?}");
    }

    #[test]
    fn coverage_counts_both_ways() {
        assert_eq!(Difference::between(&block(20), &block(30)).unwrap().coverage_change, 0.5);
        assert_eq!(Difference::between(&block(0), &block(3)).unwrap().coverage_change, 1.0);
        assert_eq!(Difference::between(&block(0), &block(0)).unwrap().coverage_change, 0.0);
    }

    #[test]
    fn other_sizes_are_refused() {
        let other = Picture { width: 1, height: 1, rgba: vec![0; 4] };
        let error = Difference::between(&block(1), &other).unwrap_err();
        assert_eq!(error.to_string(), "pictures of 64x64 and 1x1 pixels cannot be compared");
    }
}
