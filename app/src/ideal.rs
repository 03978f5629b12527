//! What a picture would be if pixels were infinitely small before they are brought together: the measure for
//! how much of a difference between two pictures is the noise of one sample a pixel.

use topout_render::{Antialias, DrawMode, FrameInput, Options, Picture, Renderer};

/// Samples along each side of a pixel.
pub const SAMPLES: u32 = 4;

/// Full detail as the mean of [`SAMPLES`] x [`SAMPLES`] samples a pixel in linear light, without edge lines.
/// `None` where the adapter cannot draw a picture so large. Leaves the renderer's settings as they were.
///
/// # Errors
/// If the device fails or has no memory left.
pub fn ideal(renderer: &mut Renderer, input: &FrameInput) -> anyhow::Result<Option<Picture>> {
    let size = input.view.size;
    let mut view = input.view;
    view.size = size * SAMPLES;
    let options = renderer.options();
    renderer.set_options(Options { edges: 0.0, antialias: Antialias::Off, ..options });
    renderer.render(&FrameInput { view, mode: DrawMode::Batched, ..*input });
    let large = (renderer.size() == view.size).then(|| renderer.read_back()).transpose();
    renderer.set_options(options);
    Ok(large?.map(|large| mean(&large, [size.x, size.y])))
}

fn mean(large: &Picture, [width, height]: [u32; 2]) -> Picture {
    let linear: [f32; 256] = std::array::from_fn(|level| (level as f32 / 255.0).powf(2.2));
    let row = large.width as usize * 4;
    let samples = (SAMPLES * SAMPLES) as f32;
    let mut rgba = Vec::with_capacity(width as usize * height as usize * 4);
    for rows in large.rgba.chunks_exact(row * SAMPLES as usize) {
        for x in 0..width as usize {
            let (mut light, mut shown) = ([0.0; 3], 0);
            for line in rows.chunks_exact(row) {
                for pixel in line[x * SAMPLES as usize * 4..][..SAMPLES as usize * 4].chunks(4) {
                    let channels = light.iter_mut().zip(pixel);
                    channels.for_each(|(sum, level)| *sum += linear[usize::from(*level)]);
                    shown += u32::from(pixel[3] > 127);
                }
            }
            let level = |sum: f32| ((sum / samples).powf(1.0 / 2.2) * 255.0).round() as u8;
            rgba.extend(light.map(level));
            rgba.push(if shown * 2 >= SAMPLES * SAMPLES { 255 } else { 0 });
        }
    }
    Picture { width, height, rgba }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_brought_together_in_linear_light() {
        // Two pixels: half black and half white, and grey with a quarter shown.
        let line = |y: usize| {
            (0..8).flat_map(move |x| match x {
                0..2 => [0, 0, 0, 255],
                2..4 => [255, 255, 255, 255],
                _ => [100, 100, 100, if y == 0 { 255 } else { 0 }],
            })
        };
        let large = Picture { width: 8, height: 4, rgba: (0..4).flat_map(line).collect() };
        let small = mean(&large, [2, 1]);
        assert_eq!((small.width, small.height), (2, 1));
        assert_eq!(small.rgba, [186, 186, 186, 255, 100, 100, 100, 0]);
    }
}
