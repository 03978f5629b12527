//! Animated GIFs.
//!
//! A frame holds what changed since the one before, with 255 colours of its own. What did not change stays as it
//! was written, so nothing that stands still flickers, and colours are spent on what moves.

use super::palette::Palette;
use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use std::io::{self, Write};

/// Viewers take less than this for a mistake and play slowly; hundredths of a second.
const SHORTEST_DELAY_CS: i64 = 2;

/// A GIF that is being written.
pub(super) struct GifWriter<W: Write> {
    encoder: Encoder<W>,
    size: [u16; 2],
    fps: f64,
    frames: u32,
    /// The pixels of the last frame, four bytes each; empty before the first.
    last: Vec<u8>,
}

impl<W: Write> GifWriter<W> {
    /// `size` in pixels, `fps` above 0; at most 50 frames a second are kept.
    pub fn new(out: W, size: [u16; 2], fps: f64) -> io::Result<Self> {
        let mut encoder = Encoder::new(out, size[0], size[1], &[]).map_err(cause)?;
        encoder.set_repeat(Repeat::Infinite).map_err(cause)?;
        Ok(Self { encoder, size, fps, frames: 0, last: Vec::new() })
    }

    /// Appends a frame of four bytes a pixel, of which the fourth does not count.
    pub fn push(&mut self, rgba: &[u8]) -> io::Result<()> {
        let [width, height] = self.size.map(usize::from);
        let changed = |at: usize| -> Option<[u8; 3]> {
            let color =
                |of: &[u8]| -> Option<[u8; 3]> { of.get(at * 4..at * 4 + 3)?.try_into().ok() };
            color(rgba).filter(|new| color(&self.last) != Some(*new))
        };
        let [left, top, across, down] =
            extent(width, height, |x, y| changed(y * width + x).is_some());
        let pixels: Vec<_> = (top..top + down)
            .flat_map(|y| (left..left + across).map(move |x| y * width + x))
            .map(changed)
            .collect();
        let mut palette = Palette::of(pixels.iter().flatten().copied());
        let clear = palette.colors().len() as u8;
        let buffer = palette.spread(&pixels, across, clear);
        // The colour of what shows the frame before is never seen.
        let colors = palette.colors().iter().copied().chain([[0; 3]]).flatten().collect();
        let frame = Frame {
            delay: self.delay(),
            dispose: DisposalMethod::Keep,
            transparent: pixels.contains(&None).then_some(clear),
            left: left as u16,
            top: top as u16,
            width: across as u16,
            height: down as u16,
            palette: Some(colors),
            buffer: buffer.into(),
            ..Frame::default()
        };
        self.encoder.write_frame(&frame).map_err(cause)?;
        self.last.clear();
        self.last.extend_from_slice(rgba);
        self.frames += 1;
        Ok(())
    }

    /// Hundredths of a second that the next frame is shown: rounded so that errors do not add up.
    fn delay(&self) -> u16 {
        let at = |frame: u32| (f64::from(frame) * 100.0 / self.fps).round() as i64;
        (at(self.frames + 1) - at(self.frames)).clamp(SHORTEST_DELAY_CS, i64::from(u16::MAX)) as u16
    }

    /// Completes the file.
    pub fn finish(self) -> io::Result<W> {
        self.encoder.into_inner().map_err(cause)
    }
}

fn cause(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        other => io::Error::other(other),
    }
}

/// Left, top, width and height of where something changed; one pixel where nothing did.
fn extent(width: usize, height: usize, changed: impl Fn(usize, usize) -> bool) -> [usize; 4] {
    let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
    for y in 0..height {
        let Some(first) = (0..width).find(|&x| changed(x, y)) else { continue };
        let last = (first..width).rev().find(|&x| changed(x, y)).unwrap_or(first);
        low = [low[0].min(first), low[1].min(y)];
        high = [high[0].max(last), y];
    }
    match low[0] {
        usize::MAX => [0, 0, 1, 1],
        _ => [low[0], low[1], high[0] - low[0] + 1, high[1] - low[1] + 1],
    }
}
