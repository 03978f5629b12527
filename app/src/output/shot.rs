//! Pictures to keep: complete, over the scenery, over white or over nothing.

use topout_render::{
    Antialias, Backdrop, FrameInput, FrameStats, GpuError, Options, Picture, Renderer,
};

/// What a picture shows behind the scene.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Background {
    /// Sky and ground.
    #[default]
    Scenery,
    /// White.
    White,
    /// Nothing: the fourth byte of a pixel says how much of it is covered.
    Transparent,
}

/// A renderer that takes pictures of one kind. Its options are as they were once this is dropped.
pub struct Studio<'a> {
    renderer: &'a mut Renderer,
    before: Options,
    background: Background,
}

impl<'a> Studio<'a> {
    /// Prepares the renderer.
    pub fn new(renderer: &'a mut Renderer, background: Background) -> Self {
        let before = renderer.options();
        let options = match background {
            Background::Scenery => before,
            Background::White => Options { backdrop: Backdrop::Plain([255; 3]), ..before },
            // With several samples a pixel is a mean of what is there and what is behind it, so that what
            // is behind it can be taken out again. Smoothing looks at it, too.
            Background::Transparent => Options { antialias: Antialias::Msaa4, ..before },
        };
        renderer.set_options(options);
        Self { renderer, before, background }
    }

    /// The picture, complete, and what drawing it took. Its fourth byte is 255 unless it is transparent.
    ///
    /// # Errors
    /// If the device fails or has no memory left.
    pub fn shoot(&mut self, input: &FrameInput) -> Result<(Picture, FrameStats), GpuError> {
        if self.background == Background::Transparent {
            let (black, stats) = self.over([0; 3], input)?;
            let (white, _) = self.over([255; 3], input)?;
            return Ok((without_background(black, &white), stats));
        }
        let stats = self.renderer.render(input);
        let mut picture = self.renderer.read_back()?;
        picture.rgba.chunks_exact_mut(4).for_each(|pixel| pixel[3] = 255);
        Ok((picture, stats))
    }

    fn over(
        &mut self,
        color: [u8; 3],
        input: &FrameInput,
    ) -> Result<(Picture, FrameStats), GpuError> {
        let options = self.renderer.options();
        self.renderer.set_options(Options { backdrop: Backdrop::Plain(color), ..options });
        let stats = self.renderer.render(input);
        Ok((self.renderer.read_back()?, stats))
    }
}

impl Drop for Studio<'_> {
    fn drop(&mut self) {
        self.renderer.set_options(self.before);
    }
}

/// What is in front, from what it looks like over black and over white: what a pixel covers is what it does not
/// let through of their difference.
fn without_background(black: Picture, white: &Picture) -> Picture {
    let mut front = black;
    for (pixel, white) in front.rgba.chunks_exact_mut(4).zip(white.rgba.chunks_exact(4)) {
        let through: i32 = (0..3).map(|c| i32::from(white[c]) - i32::from(pixel[c])).sum();
        let cover = (255 - (through + 1) / 3).clamp(0, 255);
        for c in &mut pixel[..3] {
            // Half of the divisor rounds.
            *c = if cover == 0 {
                0
            } else {
                ((i32::from(*c) * 255 + cover / 2) / cover).min(255) as u8
            };
        }
        pixel[3] = cover as u8;
    }
    front
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_in_front_is_found_again() {
        // Nothing, something opaque, half of orange, a tenth of white.
        let front = [[0, 0, 0, 0], [10, 200, 30, 255], [240, 120, 0, 128], [255, 255, 255, 26]];
        let over = |behind: f32| Picture {
            width: 4,
            height: 1,
            rgba: front
                .iter()
                .flat_map(|p: &[u8; 4]| {
                    let cover = f32::from(p[3]) / 255.0;
                    let mixed =
                        |c: u8| (f32::from(c) * cover + behind * (1.0 - cover)).round() as u8;
                    [mixed(p[0]), mixed(p[1]), mixed(p[2]), 255]
                })
                .collect(),
        };
        let found = without_background(over(0.0), &over(255.0));
        for (i, wanted) in front.iter().enumerate() {
            let got = found.pixel(i as u32, 0);
            assert!(got[3].abs_diff(wanted[3]) <= 1, "{got:?} instead of {wanted:?}");
            for c in 0..3 {
                assert!(got[c].abs_diff(wanted[c]) <= 6, "{got:?} instead of {wanted:?}");
            }
        }
        assert_eq!(found.pixel(1, 0), front[1]);
        assert_eq!(found.pixel(0, 0), [0; 4]);
    }
}
