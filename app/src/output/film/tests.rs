//! Films are read back by other code than wrote them.

#![allow(clippy::unwrap_used)]

use super::*;
use openh264::decoder::Decoder;
use openh264::formats::YUVSource;
use std::io::BufReader;

/// A square that moves over a gradient.
fn frame(width: u32, height: u32, step: u32) -> Picture {
    let mut rgba = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let on = (x.wrapping_sub(step * 3) < 8) && (y.wrapping_sub(5) < 8);
            let ground = [90 + (x % 64) as u8, 140 + (y % 64) as u8, 200];
            rgba.extend(if on { [230, 60, 20] } else { ground });
            rgba.push(255);
        }
    }
    Picture { width, height, rgba }
}

fn settings(width: u32, height: u32, frames: u32) -> Settings {
    Settings { width, height, frames, fps: 24.0, transparent: false }
}

fn film(path: &Path, width: u32, height: u32, frames: u32) -> Made {
    let mut film = Film::begin(path, settings(width, height, frames)).unwrap();
    for step in 0..frames {
        film.push(&frame(width, height, step)).unwrap();
    }
    film.finish().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> =
        entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// The largest difference of a channel, and the mean of all.
fn difference(a: &[u8], b: impl Iterator<Item = u8>) -> (u8, f64) {
    let off: Vec<u8> = a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).collect();
    assert_eq!(off.len(), a.len());
    (
        off.iter().copied().max().unwrap(),
        off.iter().map(|&d| f64::from(d)).sum::<f64>() / a.len() as f64,
    )
}

fn rgb(picture: &Picture) -> impl Iterator<Item = u8> + '_ {
    picture.rgba.chunks(4).flat_map(|p| [p[0], p[1], p[2]])
}

#[test]
fn the_name_says_the_format() {
    let of = |name: &str| Format::of(Path::new(name)).ok();
    assert_eq!(of("a/b.GIF"), Some(Format::Gif));
    assert_eq!(of("b.mp4"), Some(Format::Mp4));
    assert_eq!(of("frames"), Some(Format::Pngs));
    assert_eq!(of("frames.v2"), Some(Format::Pngs));
    for other in ["a.png", "a.avi", "a.WebM"] {
        assert_eq!(of(other), None, "{other}");
    }
}

#[test]
fn a_folder_of_png_files() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("film");
    let made = film(&folder, 33, 21, 3);
    assert_eq!((made.format, made.frames, made.width, made.height), (Format::Pngs, 3, 33, 21));
    assert_eq!(names(&folder), ["frame_00001.png", "frame_00002.png", "frame_00003.png"]);
    for (step, file) in (0..).zip(&made.files) {
        let read = image::open(file).unwrap().into_rgba8();
        assert_eq!(read.into_raw(), frame(33, 21, step).rgba);
    }
    // The same again; a shorter one would leave frames of the longer one.
    film(&folder, 10, 10, 3);
    let error = Film::begin(&folder, settings(10, 10, 2)).err().unwrap();
    assert!(error.to_string().contains("frame_00003.png"), "{error}");
    assert_eq!(names(&folder).len(), 3);
}

#[test]
fn transparent_pictures_stay_transparent() {
    let dir = tempfile::tempdir().unwrap();
    let picture = Picture { width: 2, height: 1, rgba: vec![1, 2, 3, 0, 200, 100, 50, 128] };
    let settings = Settings { transparent: true, ..settings(2, 1, 1) };
    let mut film = Film::begin(&dir.path().join("film"), settings).unwrap();
    film.push(&picture).unwrap();
    let read = image::open(&film.finish().unwrap().files[0]).unwrap();
    assert_eq!(read.into_rgba8().into_raw(), picture.rgba);
    for name in ["a.gif", "a.mp4"] {
        let error = Film::begin(&dir.path().join(name), settings).err().unwrap();
        assert!(matches!(error, FilmError::Transparent { .. }), "{error}");
    }
    assert_eq!(names(dir.path()), ["film"]);
}

#[test]
fn a_gif_shows_its_frames() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("film.gif");
    let made = film(&path, 65, 43, 5);
    assert_eq!((made.frames, made.width, made.height), (5, 65, 43));
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(BufReader::new(File::open(&path).unwrap())).unwrap();
    assert_eq!((decoder.width(), decoder.height()), (65, 43));
    assert_eq!(decoder.repeat(), gif::Repeat::Infinite);
    let mut shown = vec![0; 65 * 43 * 4];
    let (mut frames, mut delay) = (0, 0);
    while let Some(part) = decoder.read_next_frame().unwrap() {
        let (left, top) = (usize::from(part.left), usize::from(part.top));
        let across = usize::from(part.width);
        assert!(frames == 0 || across < 30, "what stands still is not written again: {across}");
        for (i, pixel) in part.buffer.chunks(4).enumerate() {
            let at = ((top + i / across) * 65 + left + i % across) * 4;
            if pixel[3] == 255 {
                shown[at..at + 4].copy_from_slice(pixel);
            }
        }
        let wanted = frame(65, 43, frames);
        let (most, mean) = difference(&wanted.rgba, shown.iter().copied());
        assert!(most <= 40 && mean < 3.0, "frame {frames}: {most}, {mean}");
        frames += 1;
        delay += part.delay;
    }
    assert_eq!(frames, 5);
    assert_eq!(delay, 21, "5 frames at 24 a second are 20.8 hundredths");
}

/// A box of an MP4 file: its name and what is in it.
fn boxes(mut bytes: &[u8]) -> Vec<(String, &[u8])> {
    let mut found = Vec::new();
    while bytes.len() >= 8 {
        let size = u32::from_be_bytes(bytes[..4].try_into().unwrap()) as usize;
        let (head, size) = match size {
            1 => (16, u64::from_be_bytes(bytes[8..16].try_into().unwrap()) as usize),
            size => (8, size),
        };
        found.push((String::from_utf8_lossy(&bytes[4..8]).into_owned(), &bytes[head..size]));
        bytes = &bytes[size..];
    }
    assert!(bytes.is_empty(), "{} bytes are in no box", bytes.len());
    found
}

/// The box at the end of a path of names.
fn inner<'a>(bytes: &'a [u8], path: &str) -> &'a [u8] {
    path.split('/').fold(bytes, |bytes, name| {
        let found = boxes(bytes);
        let names: Vec<_> = found.iter().map(|(name, _)| name.clone()).collect();
        found.iter().find(|(n, _)| n == name).unwrap_or_else(|| panic!("{name}: {names:?}")).1
    })
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap())
}

/// The frames of an MP4 as RGB, found by its index and decoded.
fn decoded(file: &[u8]) -> Vec<(usize, usize, Vec<u8>)> {
    let table = inner(file, "moov/trak/mdia/minf/stbl");
    let (sizes, places) = (inner(table, "stsz"), inner(table, "co64"));
    let entry = &inner(table, "stsd")[8..];
    let avcc = inner(&inner(entry, "avc1")[78..], "avcC");
    let long = u16::from_be_bytes([avcc[6], avcc[7]]) as usize;
    let (sequence, rest) = avcc[8..].split_at(long);
    let short = u16::from_be_bytes([rest[1], rest[2]]) as usize;
    let picture = &rest[3..3 + short];
    let mut decoder = Decoder::new().unwrap();
    let mut stream: Vec<u8> = [&[0, 0, 0, 1], sequence, &[0, 0, 0, 1], picture].concat();
    let mut frames = Vec::new();
    for i in 0..word(sizes, 8) as usize {
        let at = word(places, 8 + i * 8 + 4) as usize;
        let mut sample = &file[at..at + word(sizes, 12 + i * 4) as usize];
        while !sample.is_empty() {
            let (unit, rest) = sample[4..].split_at(word(sample, 0) as usize);
            stream.extend([0, 0, 0, 1]);
            stream.extend(unit);
            sample = rest;
        }
        let shown = decoder.decode(&stream).unwrap().expect("a picture");
        let (width, height) = shown.dimensions();
        let mut rgb = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let (strides, half) = (shown.strides(), (y / 2, x / 2));
                let luma = (f32::from(shown.y()[y * strides.0 + x]) - 16.0) * 255.0 / 219.0;
                let chroma = |of: &[u8], stride| {
                    (f32::from(of[half.0 * stride + half.1]) - 128.0) * 255.0 / 224.0
                };
                let (u, v) = (chroma(shown.u(), strides.1), chroma(shown.v(), strides.2));
                let (r, b) = (luma + 1.5748 * v, luma + 1.8556 * u);
                let g = (luma - 0.2126 * r - 0.0722 * b) / 0.7152;
                rgb.extend([r, g, b].map(|c| c.round().clamp(0.0, 255.0) as u8));
            }
        }
        frames.push((width, height, rgb));
        stream.clear();
    }
    frames
}

#[test]
fn an_mp4_shows_its_frames() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("film.mp4");
    let made = film(&path, 128, 96, 30);
    assert_eq!((made.frames, made.width, made.height), (30, 128, 96));
    let file = fs::read(&path).unwrap();
    let names: Vec<_> = boxes(&file).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["ftyp", "mdat", "moov"]);
    let head = inner(&file, "moov/mvhd");
    assert_eq!((word(head, 12), word(head, 16)), (24_000, 30_000), "30 frames at 24 a second");
    let keys = inner(&file, "moov/trak/mdia/minf/stbl/stss");
    assert_eq!((word(keys, 4), word(keys, 8), word(keys, 12)), (2, 1, 25), "a key frame a second");
    let frames = decoded(&file);
    assert_eq!(frames.len(), 30);
    for (step, (width, height, rgb_of)) in (0..).zip(&frames) {
        assert_eq!((*width, *height), (128, 96));
        let wanted: Vec<u8> = rgb(&frame(128, 96, step)).collect();
        let (_, mean) = difference(&wanted, rgb_of.iter().copied());
        assert!(mean < 4.0, "frame {step}: {mean}");
    }
}

#[test]
fn odd_and_small_sizes_and_single_frames() {
    let dir = tempfile::tempdir().unwrap();
    for (width, height) in [(65, 43), (17, 16), (3, 2), (1, 1)] {
        let path = dir.path().join(format!("{width}.mp4"));
        let made = film(&path, width, height, 1);
        let even = |n: u32| n.next_multiple_of(2).max(16);
        assert_eq!((made.width, made.height), (even(width), even(height)));
        let frames = decoded(&fs::read(&path).unwrap());
        assert_eq!((frames[0].0 as u32, frames[0].1 as u32), (even(width), even(height)));
        let made = film(&dir.path().join(format!("{width}.gif")), width, height, 1);
        assert_eq!((made.width, made.height, made.frames), (width, height, 1));
        film(&dir.path().join(format!("{width}")), width, height, 1);
    }
}

#[test]
fn what_is_given_up_leaves_nothing() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["a.gif", "a.mp4", "frames"] {
        let path = dir.path().join(name);
        let mut film = Film::begin(&path, settings(32, 32, 4)).unwrap();
        film.push(&frame(32, 32, 0)).unwrap();
        drop(film);
        let film = Film::begin(&path, settings(32, 32, 4)).unwrap();
        assert!(matches!(film.finish(), Err(FilmError::Empty(_))));
        let mut film = Film::begin(&path, settings(32, 32, 4)).unwrap();
        let error = film.push(&frame(32, 30, 0)).unwrap_err();
        assert!(error.to_string().contains("frame 1 has 32 x 30"), "{error}");
    }
    assert_eq!(names(dir.path()), [""; 0]);
}

#[test]
fn what_was_there_stays_until_the_film_is_whole() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.gif");
    fs::write(&path, "before").unwrap();
    let mut half = Film::begin(&path, settings(8, 8, 2)).unwrap();
    half.push(&frame(8, 8, 0)).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"before");
    drop(half);
    assert_eq!(fs::read(&path).unwrap(), b"before");
    film(&path, 8, 8, 2);
    assert_eq!(fs::read(&path).unwrap()[..6], *b"GIF89a");
    assert_eq!(names(dir.path()), ["a.gif"]);
}

#[test]
fn places_that_cannot_be_written_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let missing = dir.path().join("no/such/folder");
    for name in ["a.gif", "a.mp4", "frames"] {
        let path = missing.join(name);
        let error = Film::begin(&path, settings(8, 8, 1)).err().unwrap();
        assert!(error.to_string().contains(&path.display().to_string()), "{error}");
    }
    // A file where a folder is wanted, and the other way round.
    fs::write(dir.path().join("file"), "").unwrap();
    fs::create_dir(dir.path().join("folder.gif")).unwrap();
    for name in ["file", "folder.gif"] {
        let error = Film::begin(&dir.path().join(name), settings(8, 8, 1)).err().unwrap();
        assert!(error.to_string().contains(name), "{error}");
    }
    assert_eq!(names(dir.path()), ["file", "folder.gif"]);
    let error = Film::begin(&dir.path().join("a.mp4"), settings(4000, 16, 1)).err().unwrap();
    assert!(error.to_string().contains("4000 x 16 pixels are more than mp4"), "{error}");
}

/// A disk with room for so many bytes.
struct Disk(usize);

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 = self.0.checked_sub(bytes.len()).ok_or(io::ErrorKind::StorageFull)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl io::Seek for Disk {
    fn seek(&mut self, _: io::SeekFrom) -> io::Result<u64> {
        Ok(0)
    }
}

#[test]
fn a_full_disk_is_said() {
    use crate::output::mp4::Mp4Error;
    let picture = frame(64, 64, 0);
    let full = |error: io::Error| assert_eq!(error.kind(), io::ErrorKind::StorageFull);
    let mut gif = GifWriter::new(Disk(500), [64, 64], 24.0).unwrap();
    full(gif.push(&picture.rgba).unwrap_err());
    let mut mp4 = Mp4Writer::new(Disk(100), [64, 64], 24.0).unwrap();
    let Err(Mp4Error::Write(error)) = mp4.push(&picture.rgba) else { panic!("it had no room") };
    full(error);
    let told = FilmError::write(Path::new("a/b.gif"))(io::ErrorKind::StorageFull.into());
    assert!(told.to_string().starts_with("cannot write a/b.gif: "), "{told}");
}

#[test]
fn whole_files_replace_those_before() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("page.html");
    write_whole(&path, b"one").unwrap();
    write_whole(&path, b"two").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"two");
    assert_eq!(names(dir.path()), ["page.html"]);
    let error = write_whole(&dir.path().join("no/page.html"), b"").unwrap_err();
    assert!(error.to_string().contains("page.html"), "{error}");
}
