//! The few colours that stand for many, and pixels spread so that no bands show.

/// Bits a channel by which colours are told apart.
const BITS: u32 = 6;
const CELLS: usize = 1 << (3 * BITS);
/// Not asked for yet.
const UNKNOWN: u16 = u16::MAX;

/// Colours with their pixels: count and sums of the channels.
#[derive(Clone, Copy, Default)]
struct Bin {
    count: u64,
    sums: [u64; 3],
}

/// How many colours a cell of [`BITS`] bits a channel is.
fn cell([r, g, b]: [u8; 3]) -> usize {
    let part = |c: u8| usize::from(c >> (8 - BITS));
    (part(r) << (2 * BITS)) | (part(g) << BITS) | part(b)
}

/// At most 255 colours.
pub(super) struct Palette {
    colors: Vec<[u8; 3]>,
    /// The nearest of `colors` by cell, as far as it was asked for.
    nearest: Vec<u16>,
}

impl Palette {
    /// The largest number of colours.
    pub const LARGEST: usize = 255;

    /// Colours for these pixels: the cells of colours are halved where they differ most from their mean, all
    /// pixels counted, until there are enough (after Wu 1991).
    pub fn of(pixels: impl Iterator<Item = [u8; 3]>) -> Palette {
        let mut bins = vec![Bin::default(); CELLS];
        for color in pixels {
            let bin = &mut bins[cell(color)];
            bin.count += 1;
            bin.sums.iter_mut().zip(color).for_each(|(sum, c)| *sum += u64::from(c));
        }
        let bins: Vec<Bin> = bins.into_iter().filter(|bin| bin.count > 0).collect();
        let mut boxes = vec![ColorBox::of(bins)];
        while boxes.len() < Self::LARGEST {
            let worst = (0..boxes.len()).max_by(|&a, &b| boxes[a].error.total_cmp(&boxes[b].error));
            let Some(worst) = worst.filter(|&i| boxes[i].error > 0.0) else { break };
            let (low, high) = boxes.swap_remove(worst).split();
            boxes.extend([low, high]);
        }
        let mut colors: Vec<[u8; 3]> =
            boxes.iter().map(|b| b.mean.map(|c| c.round() as u8)).collect();
        // One order for one set of colours.
        colors.sort_unstable();
        colors.dedup();
        Palette { colors, nearest: vec![UNKNOWN; CELLS] }
    }

    /// The colours in order, at least one.
    pub fn colors(&self) -> &[[u8; 3]] {
        &self.colors
    }

    fn nearest(&mut self, color: [u8; 3]) -> u8 {
        let at = cell(color);
        if self.nearest[at] == UNKNOWN {
            let distance = |c: &[u8; 3]| -> u32 {
                c.iter().zip(color).map(|(&a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
            };
            let colors = (0u16..).zip(&self.colors);
            let best = colors.min_by_key(|(_, c)| distance(c)).map_or(0, |(i, _)| i);
            self.nearest[at] = best;
        }
        self.nearest[at] as u8
    }

    /// Indices of colours for rows of pixels, `None` for those that do not matter and get index `other`. What
    /// a pixel is off by goes to its neighbours (Floyd and Steinberg 1976), every second row the other way.
    pub fn spread(&mut self, pixels: &[Option<[u8; 3]>], width: usize, other: u8) -> Vec<u8> {
        let mut indices = vec![other; pixels.len()];
        // In sixteenths; one more on both sides.
        let mut here = vec![[0i32; 3]; width + 2];
        let mut below = here.clone();
        for (y, row) in pixels.chunks(width.max(1)).enumerate() {
            below.fill([0; 3]);
            let back = y % 2 == 1;
            for step in 0..row.len() {
                let x = if back { row.len() - 1 - step } else { step };
                let Some(color) = row[x] else { continue };
                let wanted: [i32; 3] = std::array::from_fn(|c| {
                    (i32::from(color[c]) * 16 + here[x + 1][c]).clamp(0, 4080)
                });
                let index = self.nearest(wanted.map(|c| ((c + 8) / 16).min(255) as u8));
                indices[y * width + x] = index;
                let shown = self.colors[usize::from(index)];
                let (ahead, behind) = if back { (x, x + 2) } else { (x + 2, x) };
                for c in 0..3 {
                    let off = wanted[c] - i32::from(shown[c]) * 16;
                    here[ahead][c] += off * 7 / 16;
                    below[behind][c] += off * 3 / 16;
                    below[x + 1][c] += off * 5 / 16;
                    below[ahead][c] += off / 16;
                }
            }
            std::mem::swap(&mut here, &mut below);
        }
        indices
    }
}

/// Some bins and what they are together.
struct ColorBox {
    bins: Vec<Bin>,
    mean: [f64; 3],
    /// The axis along which they differ most.
    axis: usize,
    /// Sum over the pixels of the squared distance from the mean along that axis; 0 for one bin.
    error: f64,
}

impl Bin {
    fn mean(&self, axis: usize) -> f64 {
        self.sums[axis] as f64 / self.count as f64
    }
}

impl ColorBox {
    fn of(bins: Vec<Bin>) -> Self {
        let count = bins.iter().map(|b| b.count).sum::<u64>().max(1) as f64;
        let mean: [f64; 3] =
            std::array::from_fn(|c| bins.iter().map(|b| b.sums[c] as f64).sum::<f64>() / count);
        let errors: [f64; 3] = std::array::from_fn(|c| {
            bins.iter().map(|b| b.count as f64 * (b.mean(c) - mean[c]).powi(2)).sum()
        });
        let axis = (0..3).max_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap_or(0);
        let error = if bins.len() > 1 { errors[axis] } else { 0.0 };
        Self { bins, mean, axis, error }
    }

    /// In two at the mean; neither is empty where the error is more than 0.
    fn split(self) -> (Self, Self) {
        let (axis, middle) = (self.axis, self.mean[self.axis]);
        let (low, high) = self.bins.into_iter().partition(|bin| bin.mean(axis) < middle);
        (Self::of(low), Self::of(high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colours_stay_what_they_are() {
        let colors = [[0, 0, 0], [255, 0, 0], [10, 200, 30], [250, 250, 250]];
        let pixels: Vec<_> = (0..64).map(|i| colors[i % 4]).collect();
        let mut palette = Palette::of(pixels.iter().copied());
        assert_eq!(palette.colors().len(), 4);
        let wanted: Vec<_> = pixels.iter().map(|&p| Some(p)).collect();
        let indices = palette.spread(&wanted, 8, 255);
        for (index, pixel) in indices.iter().zip(&pixels) {
            assert_eq!(palette.colors()[usize::from(*index)], *pixel);
        }
    }

    #[test]
    fn a_gradient_keeps_its_mean_everywhere() {
        // 64 x 64 from one colour to another with far more than 255 shades beside it.
        let pixel = |x: usize, y: usize| [(90 + x) as u8, (150 + x / 2) as u8, (y * 4) as u8];
        let pixels: Vec<_> = (0..64 * 64).map(|i| Some(pixel(i % 64, i / 64))).collect();
        let mut palette = Palette::of(pixels.iter().flatten().copied());
        assert!(palette.colors().len() <= Palette::LARGEST);
        let indices = palette.spread(&pixels, 64, 255);
        for by in (0..64).step_by(8) {
            for bx in (0..64).step_by(8) {
                for c in 0..3 {
                    let sum = |of: &dyn Fn(usize) -> u8| -> i32 {
                        let places = (0..64).map(|i| (by + i / 8) * 64 + bx + i % 8);
                        places.map(|at| i32::from(of(at))).sum()
                    };
                    let shown = sum(&|at| palette.colors()[usize::from(indices[at])][c]);
                    let wanted = sum(&|at| pixels[at].map_or(0, |p| p[c]));
                    let off = (shown - wanted).abs();
                    assert!(off <= 64 * 3, "block {bx},{by}, channel {c}: {off}");
                }
            }
        }
    }

    #[test]
    fn what_does_not_matter_has_the_other_index() {
        let mut palette = Palette::of([[1, 2, 3]].into_iter());
        assert_eq!(palette.spread(&[None, Some([1, 2, 3]), None], 3, 9), [9, 0, 9]);
        assert_eq!(Palette::of(std::iter::empty()).colors().len(), 1);
    }
}
