//! MP4 files with one H.264 track (ISO/IEC 14496-12 and -15), encoded by OpenH264.

use openh264::OpenH264API;
use openh264::encoder::{
    Complexity, Encoder, EncoderConfig, FrameRate, IntraFramePeriod, Profile, QpRange,
    RateControlMode, VuiConfig,
};
use openh264::formats::YUVSlices;
use std::io::{self, Seek, SeekFrom, Write};

/// Why a frame was not written.
#[derive(Debug)]
pub(super) enum Mp4Error {
    Write(io::Error),
    Encode(String),
}

impl From<io::Error> for Mp4Error {
    fn from(error: io::Error) -> Self {
        Mp4Error::Write(error)
    }
}

/// Ticks that a frame lasts; the time scale is as many times the frames a second.
const TICKS: u32 = 1000;

/// Quantiser of H.264, 0 (best) to 51.
const QUALITY: u8 = 20;

/// Units of H.264 by their type.
const IDR_SLICE: u8 = 5;
const SEQUENCE_PARAMETERS: u8 = 7;
const PICTURE_PARAMETERS: u8 = 8;

/// A frame in the file.
struct Sample {
    at: u64,
    bytes: u32,
    /// Whether it needs no other frame.
    key: bool,
}

/// An MP4 that is being written. Pictures of odd sizes, or smaller than the encoder takes, get more columns and
/// rows like their last: [`film_size`].
pub(super) struct Mp4Writer<W> {
    out: W,
    encoder: Encoder,
    planes: Planes,
    /// Of the picture as given, pixels.
    size: [usize; 2],
    fps: f64,
    /// Bytes written so far.
    end: u64,
    /// Where the media data begins: its size is written there in the end.
    data: u64,
    sequence: Vec<u8>,
    picture: Vec<u8>,
    samples: Vec<Sample>,
}

impl<W> Mp4Writer<W> {
    /// The longest side that the encoder takes, pixels.
    pub const LONG: u32 = 3840;
    /// The longest that the shorter side may be, pixels.
    pub const SHORT: u32 = 2160;
}

impl<W: Write + Seek> Mp4Writer<W> {
    /// `size` in pixels, within [`Self::LONG`] and [`Self::SHORT`]; `fps` above 0.
    pub fn new(mut out: W, size: [u32; 2], fps: f64) -> io::Result<Self> {
        // Constant quality, which fine parts of buildings need, and no frame left out. (The mode of that name warns on
        // standard error when it may not leave out frames.) A key frame every second, so that players can jump.
        let config = EncoderConfig::new()
            .rate_control_mode(RateControlMode::Bufferbased)
            .qp(QpRange::new(QUALITY, QUALITY))
            .adaptive_quantization(false)
            .skip_frames(false)
            .profile(Profile::High)
            .complexity(Complexity::High)
            .max_frame_rate(FrameRate::from_hz(fps as f32))
            .intra_frame_period(IntraFramePeriod::from_num_frames(fps.round().max(1.0) as u32))
            .vui(VuiConfig::bt709());
        let encoder = Encoder::with_api_config(OpenH264API::from_source(), config)
            .map_err(io::Error::other)?;
        let kind = boxed(b"ftyp", |b| {
            b.extend(b"isom");
            b.extend(0x200u32.to_be_bytes());
            b.extend(b"isomiso2avc1mp41");
        });
        out.write_all(&kind)?;
        let data = kind.len() as u64;
        // Size 1: the size stands after the name, in 8 bytes.
        out.write_all(&1u32.to_be_bytes())?;
        out.write_all(b"mdat")?;
        out.write_all(&[0; 8])?;
        Ok(Self {
            out,
            encoder,
            planes: Planes::new(size),
            size: size.map(|n| n as usize),
            fps,
            end: data + 16,
            data,
            sequence: Vec::new(),
            picture: Vec::new(),
            samples: Vec::new(),
        })
    }

    /// Appends a frame of four bytes a pixel, of which the fourth does not count.
    pub fn push(&mut self, rgba: &[u8]) -> Result<(), Mp4Error> {
        self.planes.fill(rgba, self.size);
        let encoded = self
            .encoder
            .encode(&self.planes.slices())
            .map_err(|e| Mp4Error::Encode(e.to_string()))?;
        let (mut bytes, mut key) = (Vec::new(), false);
        for layer in (0..encoded.num_layers()).filter_map(|i| encoded.layer(i)) {
            for unit in (0..layer.nal_count()).filter_map(|i| layer.nal_unit(i)) {
                let unit = without_start_code(unit);
                let Some(first) = unit.first() else { continue };
                match first & 0x1F {
                    SEQUENCE_PARAMETERS => self.sequence = unit.to_vec(),
                    PICTURE_PARAMETERS => self.picture = unit.to_vec(),
                    kind => {
                        key |= kind == IDR_SLICE;
                        bytes.extend((unit.len() as u32).to_be_bytes());
                        bytes.extend(unit);
                    }
                }
            }
        }
        if bytes.is_empty() || self.sequence.len() < 4 || self.picture.is_empty() {
            return Err(Mp4Error::Encode("the encoder gave no picture".to_owned()));
        }
        self.out.write_all(&bytes)?;
        self.samples.push(Sample { at: self.end, bytes: bytes.len() as u32, key });
        self.end += bytes.len() as u64;
        Ok(())
    }

    /// Completes the file; there must be a frame.
    pub fn finish(mut self) -> io::Result<W> {
        let index = self.index();
        self.out.write_all(&index)?;
        self.out.seek(SeekFrom::Start(self.data + 8))?;
        self.out.write_all(&(self.end - self.data).to_be_bytes())?;
        self.out.seek(SeekFrom::End(0))?;
        Ok(self.out)
    }

    /// What a player reads first: the box `moov`.
    fn index(&self) -> Vec<u8> {
        let scale = (self.fps * f64::from(TICKS)).round().clamp(1.0, f64::from(u32::MAX)) as u32;
        let duration =
            (self.samples.len() as u64 * u64::from(TICKS)).min(u64::from(u32::MAX)) as u32;
        let [width, height] = self.planes.size.map(|n| n as u32);
        boxed(b"moov", |moov| {
            moov.extend(boxed(b"mvhd", |b| {
                words(b, &[0, 0, 0, scale, duration, 0x0001_0000, 0x0100_0000, 0, 0]);
                words(b, &MATRIX);
                words(b, &[0; 6]);
                words(b, &[2]); // The next track's number.
            }));
            moov.extend(boxed(b"trak", |trak| {
                trak.extend(boxed(b"tkhd", |b| {
                    // Enabled, in the film.
                    words(b, &[3, 0, 0, 1, 0, duration, 0, 0, 0, 0]);
                    words(b, &MATRIX);
                    words(b, &[width << 16, height << 16]);
                }));
                trak.extend(boxed(b"mdia", |mdia| {
                    // In no language.
                    mdia.extend(boxed(b"mdhd", |b| {
                        words(b, &[0, 0, 0, scale, duration, 0x55C4_0000])
                    }));
                    mdia.extend(boxed(b"hdlr", |b| {
                        words(b, &[0, 0]);
                        b.extend(b"vide");
                        words(b, &[0; 3]);
                        b.extend(b"topout\0");
                    }));
                    mdia.extend(boxed(b"minf", |minf| {
                        minf.extend(boxed(b"vmhd", |b| words(b, &[1, 0, 0])));
                        minf.extend(boxed(b"dinf", |dinf| {
                            dinf.extend(boxed(b"dref", |b| {
                                words(b, &[0, 1]);
                                // In this file.
                                b.extend(boxed(b"url ", |b| words(b, &[1])));
                            }));
                        }));
                        minf.extend(self.samples_box([width, height]));
                    }));
                }));
            }));
        })
    }

    /// Where the frames lie and how they are encoded: the box `stbl`.
    fn samples_box(&self, [width, height]: [u32; 2]) -> Vec<u8> {
        let count = self.samples.len() as u32;
        boxed(b"stbl", |stbl| {
            stbl.extend(boxed(b"stsd", |b| {
                words(b, &[0, 1]);
                b.extend(boxed(b"avc1", |b| {
                    words(b, &[0, 1, 0, 0, 0, 0, (width << 16) | height]);
                    // 72 dots an inch, one frame a sample, no name.
                    words(b, &[0x0048_0000, 0x0048_0000, 0, 0x0001_0000]);
                    b.extend([0; 30]);
                    b.extend([0, 24, 0xFF, 0xFF]);
                    b.extend(boxed(b"avcC", |b| {
                        b.extend([1, self.sequence[1], self.sequence[2], self.sequence[3]]);
                        // Lengths of 4 bytes, one unit of each kind.
                        for (head, unit) in
                            [(&[0xFF, 0xE1][..], &self.sequence), (&[1], &self.picture)]
                        {
                            b.extend(head);
                            b.extend((unit.len() as u16).to_be_bytes());
                            b.extend(unit);
                        }
                        // High profile: 4:2:0, 8 bits.
                        if self.sequence[1] == 100 {
                            b.extend([0xFD, 0xF8, 0xF8, 0]);
                        }
                    }));
                    b.extend(boxed(b"colr", |b| {
                        b.extend(b"nclx");
                        // BT.709, not the full range.
                        b.extend([0, 1, 0, 1, 0, 1, 0]);
                    }));
                }));
            }));
            stbl.extend(boxed(b"stts", |b| words(b, &[0, 1, count, TICKS])));
            stbl.extend(boxed(b"stss", |b| {
                let keys: Vec<u32> =
                    (1u32..).zip(&self.samples).filter(|(_, s)| s.key).map(|(i, _)| i).collect();
                words(b, &[0, keys.len() as u32]);
                words(b, &keys);
            }));
            // One frame a chunk.
            stbl.extend(boxed(b"stsc", |b| words(b, &[0, 1, 1, 1, 1])));
            stbl.extend(boxed(b"stsz", |b| {
                words(b, &[0, 0, count]);
                self.samples.iter().for_each(|s| b.extend(s.bytes.to_be_bytes()));
            }));
            stbl.extend(boxed(b"co64", |b| {
                words(b, &[0, count]);
                self.samples.iter().for_each(|s| b.extend(s.at.to_be_bytes()));
            }));
        })
    }
}

/// Neither turned nor scaled.
const MATRIX: [u32; 9] = [0x0001_0000, 0, 0, 0, 0x0001_0000, 0, 0, 0, 0x4000_0000];

/// A box: its size, its name and what is in it.
fn boxed(name: &[u8; 4], fill: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = vec![0; 4];
    bytes.extend(name);
    fill(&mut bytes);
    let size = bytes.len() as u32;
    bytes[..4].copy_from_slice(&size.to_be_bytes());
    bytes
}

fn words(bytes: &mut Vec<u8>, words: &[u32]) {
    words.iter().for_each(|word| bytes.extend(word.to_be_bytes()));
}

/// The encoder puts 00 00 01 or 00 00 00 01 before each unit.
fn without_start_code(unit: &[u8]) -> &[u8] {
    let zeros = unit.iter().take_while(|&&b| b == 0).count();
    unit.get(zeros + 1..).unwrap_or_default()
}

/// The size of a film of pictures of a size: even, and at least 16, pixels.
pub(super) fn film_size(size: [u32; 2]) -> [u32; 2] {
    size.map(|n| n.next_multiple_of(2).max(16))
}

/// A picture as brightness and two colours, these of half the size (BT.709, 16 to 235).
struct Planes {
    /// [`film_size`].
    size: [usize; 2],
    y: Vec<u8>,
    u: Vec<u8>,
    v: Vec<u8>,
}

impl Planes {
    fn new(size: [u32; 2]) -> Self {
        let size = film_size(size).map(|n| n as usize);
        let pixels = size[0] * size[1];
        let colors = vec![128; pixels / 4];
        Self { size, y: vec![16; pixels], u: colors.clone(), v: colors }
    }

    fn fill(&mut self, rgba: &[u8], [width, height]: [usize; 2]) {
        let [across, down] = self.size;
        let pixel = |x: usize, y: usize| -> [f32; 3] {
            let at = (y.min(height - 1) * width + x.min(width - 1)) * 4;
            [rgba[at], rgba[at + 1], rgba[at + 2]].map(f32::from)
        };
        let bright = |[r, g, b]: [f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
        for by in 0..down / 2 {
            for bx in 0..across / 2 {
                let mut sum = [0.0; 3];
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let (x, y) = (bx * 2 + dx, by * 2 + dy);
                    let color = pixel(x, y);
                    self.y[y * across + x] = (16.5 + bright(color) * (219.0 / 255.0)) as u8;
                    (0..3).for_each(|c| sum[c] += color[c] * 0.25);
                }
                let y = bright(sum);
                let level = |off: f32, reach: f32| (128.5 + off / reach * (224.0 / 255.0)) as u8;
                let at = by * (across / 2) + bx;
                self.u[at] = level(sum[2] - y, 1.8556);
                self.v[at] = level(sum[0] - y, 1.5748);
            }
        }
    }

    fn slices(&self) -> YUVSlices<'_> {
        let [across, down] = self.size;
        let half = across / 2;
        YUVSlices::new((&self.y, &self.u, &self.v), (across, down), (across, half, half))
    }
}
