//! Films: a folder of PNG files, an animated GIF or an MP4, a frame at a time.
//!
//! Everything is written under another name beside its place and renamed at the end, so what has the name that
//! was asked for is whole. A film that is dropped before [`Film::finish`] leaves nothing.

use super::gif::GifWriter;
use super::mp4::Mp4Writer;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use topout_render::Picture;

/// Why there is no film.
#[derive(thiserror::Error, Debug)]
pub enum FilmError {
    /// The system refused.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// What could not be written.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The name ends like a film that topout does not write.
    #[error("{}: films are written as .gif, as .mp4 or as a folder of PNG files", .0.display())]
    Format(PathBuf),
    /// A folder would mix two films.
    #[error(
        "{}: holds {found}, of a longer film; remove its frames or name another folder",
        folder.display()
    )]
    Mixed {
        /// The folder.
        folder: PathBuf,
        /// The name of one of its frames.
        found: String,
    },
    /// The format cannot hold pictures of that size.
    #[error(
        "{}: {width} x {height} pixels are more than {format} can hold ({limit}); a folder of PNG files can",
        path.display()
    )]
    Size {
        /// The film.
        path: PathBuf,
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// The format's name.
        format: &'static str,
        /// What it can hold.
        limit: &'static str,
    },
    /// A frame has another size than the first.
    #[error(
        "{}: frame {frame} has {found_width} x {found_height} pixels instead of {width} x {height}",
        path.display()
    )]
    Frame {
        /// The film.
        path: PathBuf,
        /// From 1 on.
        frame: u32,
        /// Pixels across.
        found_width: u32,
        /// Pixels down.
        found_height: u32,
        /// Pixels across that were said.
        width: u32,
        /// Pixels down that were said.
        height: u32,
    },
    /// The format knows nothing of what shines through.
    #[error("{}: {format} holds no transparent pictures; a folder of PNG files does", path.display())]
    Transparent {
        /// The film.
        path: PathBuf,
        /// The format's name.
        format: &'static str,
    },
    /// The encoder refused.
    #[error("{}: cannot encode frame {frame}: {reason}", path.display())]
    Encode {
        /// The film.
        path: PathBuf,
        /// From 1 on.
        frame: u32,
        /// What the encoder says.
        reason: String,
    },
    /// There was no frame.
    #[error("{}: a film needs at least one frame", .0.display())]
    Empty(PathBuf),
}

impl FilmError {
    /// For `map_err`.
    pub(super) fn write(path: &Path) -> impl Fn(io::Error) -> FilmError + '_ {
        |source| FilmError::Write { path: path.to_owned(), source }
    }
}

/// How a film is kept.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Format {
    /// A folder with `frame_00001.png` and so on.
    Pngs,
    /// An animated GIF that repeats, 256 colours a frame.
    Gif,
    /// H.264 in an MP4 file.
    Mp4,
}

impl Format {
    /// By the end of the name; what has none of those of pictures and films is a folder.
    ///
    /// # Errors
    /// [`FilmError::Format`].
    pub fn of(path: &Path) -> Result<Format, FilmError> {
        const OTHERS: [&str; 14] = [
            "apng", "avi", "avif", "bmp", "jpeg", "jpg", "m4v", "mkv", "mov", "mpg", "png", "tif",
            "webm", "webp",
        ];
        let end = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
        match &*end {
            "gif" => Ok(Format::Gif),
            "mp4" => Ok(Format::Mp4),
            end if OTHERS.contains(&end) => Err(FilmError::Format(path.to_owned())),
            _ => Ok(Format::Pngs),
        }
    }

    /// The word that scripts read.
    pub fn word(self) -> &'static str {
        match self {
            Format::Pngs => "png",
            Format::Gif => "gif",
            Format::Mp4 => "mp4",
        }
    }

    /// Whether pictures may be transparent.
    pub fn holds_transparency(self) -> bool {
        self == Format::Pngs
    }
}

/// What is known of a film before its first frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Settings {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// How many frames it will have.
    pub frames: u32,
    /// Frames a second, above 0.
    pub fps: f64,
    /// Whether pictures are transparent: their fourth byte is how much they cover.
    pub transparent: bool,
}

/// A film that is done.
#[derive(Clone, PartialEq, Debug)]
pub struct Made {
    /// How it is kept.
    pub format: Format,
    /// The file, or the frames in order.
    pub files: Vec<PathBuf>,
    /// How many frames it has.
    pub frames: u32,
    /// Pixels across; of an MP4 even and at least 16.
    pub width: u32,
    /// Pixels down; of an MP4 even and at least 16.
    pub height: u32,
    /// How large all files are together.
    pub bytes: u64,
}

/// A file or folder under a name of its own beside its place; removed when dropped.
struct Scratch {
    path: PathBuf,
    /// Whether something lies there that is to be removed.
    there: bool,
}

impl Scratch {
    /// The name for what will have the name `path`, of this process alone.
    fn beside(path: &Path) -> Self {
        let mut name = OsString::from(".");
        name.push(path.file_name().unwrap_or("film".as_ref()));
        name.push(format!(".{}.part", std::process::id()));
        Self { path: path.with_file_name(name), there: false }
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        if self.there {
            let _ = match self.path.is_dir() {
                true => fs::remove_dir_all(&self.path),
                false => fs::remove_file(&self.path),
            };
        }
    }
}

enum Sink {
    Pngs,
    Gif(GifWriter<BufWriter<File>>),
    Mp4(Box<Mp4Writer<BufWriter<File>>>),
}

/// A film that is being written.
pub struct Film {
    path: PathBuf,
    settings: Settings,
    frames: u32,
    // Before `scratch`: a file is closed before it is removed.
    sink: Sink,
    scratch: Scratch,
    /// The folder was made for this film.
    made_folder: bool,
    finished: bool,
}

impl Film {
    /// Begins a film; [`Format::of`] says what kind. Folders above it are not made, a folder of frames is.
    ///
    /// # Errors
    /// If the place cannot be written to, or the format does not hold such pictures.
    pub fn begin(path: &Path, settings: Settings) -> Result<Film, FilmError> {
        let format = Format::of(path)?;
        if settings.transparent && !format.holds_transparency() {
            return Err(FilmError::Transparent { path: path.to_owned(), format: format.word() });
        }
        let Settings { width, height, fps, .. } = settings;
        let too_large = |limit| FilmError::Size {
            path: path.to_owned(),
            width,
            height,
            format: format.word(),
            limit,
        };
        let mut made_folder = false;
        let mut scratch = match format {
            Format::Pngs => {
                made_folder = !path.exists();
                if made_folder {
                    fs::create_dir(path).map_err(FilmError::write(path))?;
                }
                Scratch::beside(&path.join("frames"))
            }
            _ => Scratch::beside(path),
        };
        let sink = match format {
            Format::Pngs => {
                no_longer_film(path, settings.frames)?;
                fs::create_dir(&scratch.path).map_err(|source| {
                    if made_folder {
                        let _ = fs::remove_dir(path);
                    }
                    FilmError::Write { path: path.to_owned(), source }
                })?;
                Sink::Pngs
            }
            Format::Gif => {
                let side = |n: u32| u16::try_from(n);
                let (Ok(w), Ok(h)) = (side(width), side(height)) else {
                    return Err(too_large("65535 x 65535"));
                };
                let file = BufWriter::new(create(path, &scratch.path)?);
                scratch.there = true;
                Sink::Gif(GifWriter::new(file, [w, h], fps).map_err(FilmError::write(path))?)
            }
            Format::Mp4 => {
                let (long, short) = (width.max(height), width.min(height));
                if long > Mp4Writer::<File>::LONG || short > Mp4Writer::<File>::SHORT {
                    return Err(too_large("3840 x 2160 or 2160 x 3840"));
                }
                let file = BufWriter::new(create(path, &scratch.path)?);
                scratch.there = true;
                let writer = Mp4Writer::new(file, [width, height], fps);
                Sink::Mp4(Box::new(writer.map_err(FilmError::write(path))?))
            }
        };
        scratch.there = true;
        let path = path.to_owned();
        Ok(Film { path, settings, frames: 0, sink, scratch, made_folder, finished: false })
    }

    /// How the film is kept.
    pub fn format(&self) -> Format {
        match self.sink {
            Sink::Pngs => Format::Pngs,
            Sink::Gif(_) => Format::Gif,
            Sink::Mp4(_) => Format::Mp4,
        }
    }

    /// Appends a frame.
    ///
    /// # Errors
    /// If it has another size than was said, or cannot be written.
    pub fn push(&mut self, picture: &Picture) -> Result<(), FilmError> {
        let Settings { width, height, transparent, .. } = self.settings;
        let frame = self.frames + 1;
        if (picture.width, picture.height) != (width, height) {
            return Err(FilmError::Frame {
                path: self.path.clone(),
                frame,
                found_width: picture.width,
                found_height: picture.height,
                width,
                height,
            });
        }
        match &mut self.sink {
            Sink::Pngs => {
                let name = frame_name(frame);
                let failed = FilmError::write(&self.path);
                let png = encode_png(picture, transparent).map_err(io::Error::other);
                let place = self.scratch.path.join(name);
                png.and_then(|png| fs::write(place, png)).map_err(failed)?;
            }
            Sink::Gif(gif) => gif.push(&picture.rgba).map_err(FilmError::write(&self.path))?,
            Sink::Mp4(mp4) => mp4.push(&picture.rgba).map_err(|error| match error {
                super::mp4::Mp4Error::Write(source) => {
                    FilmError::Write { path: self.path.clone(), source }
                }
                super::mp4::Mp4Error::Encode(reason) => {
                    FilmError::Encode { path: self.path.clone(), frame, reason }
                }
            })?,
        }
        self.frames = frame;
        Ok(())
    }

    /// Completes the film and gives it its name.
    ///
    /// # Errors
    /// If it has no frame or cannot be written; nothing is left then.
    pub fn finish(mut self) -> Result<Made, FilmError> {
        if self.frames == 0 {
            return Err(FilmError::Empty(self.path.clone()));
        }
        let format = self.format();
        let Settings { width, height, .. } = self.settings;
        let size = match format {
            Format::Mp4 => super::mp4::film_size([width, height]),
            _ => [width, height],
        };
        let failed = FilmError::write(&self.path);
        let file = match std::mem::replace(&mut self.sink, Sink::Pngs) {
            Sink::Pngs => None,
            Sink::Gif(gif) => Some(gif.finish().map_err(&failed)?),
            Sink::Mp4(mp4) => Some(mp4.finish().map_err(&failed)?),
        };
        let files = match file {
            Some(mut file) => {
                file.flush().and_then(|()| file.get_ref().sync_all()).map_err(&failed)?;
                drop(file);
                fs::rename(&self.scratch.path, &self.path).map_err(&failed)?;
                self.scratch.there = false;
                vec![self.path.clone()]
            }
            None => {
                let mut files = Vec::with_capacity(self.frames as usize);
                for name in (1..=self.frames).map(frame_name) {
                    let place = self.path.join(&name);
                    fs::rename(self.scratch.path.join(&name), &place)
                        .map_err(FilmError::write(&place))?;
                    files.push(place);
                }
                files
            }
        };
        self.finished = true;
        let bytes = files.iter().filter_map(|f| fs::metadata(f).ok()).map(|m| m.len()).sum();
        Ok(Made { format, files, frames: self.frames, width: size[0], height: size[1], bytes })
    }
}

impl Drop for Film {
    fn drop(&mut self) {
        // What lies in a folder that was made for the film goes with it, if nothing else does.
        if self.made_folder && !self.finished {
            if self.scratch.there {
                let _ = fs::remove_dir_all(&self.scratch.path);
                self.scratch.there = false;
            }
            let _ = fs::remove_dir(&self.path);
        }
    }
}

fn frame_name(frame: u32) -> String {
    format!("frame_{frame:05}.png")
}

/// A file that will have the name `path`, which must not be that of a folder.
fn create(path: &Path, scratch: &Path) -> Result<File, FilmError> {
    if path.is_dir() {
        let source = io::Error::from(io::ErrorKind::IsADirectory);
        return Err(FilmError::Write { path: path.to_owned(), source });
    }
    File::create(scratch).map_err(FilmError::write(path))
}

/// Refuses a folder that holds later frames than this film will have.
fn no_longer_film(folder: &Path, frames: u32) -> Result<(), FilmError> {
    for entry in fs::read_dir(folder).map_err(FilmError::write(folder))? {
        let name = entry.map_err(FilmError::write(folder))?.file_name();
        let number = name
            .to_str()
            .and_then(|n| n.strip_prefix("frame_")?.strip_suffix(".png")?.parse::<u32>().ok());
        if number.is_some_and(|n| n > frames) {
            let found = name.to_string_lossy().into_owned();
            return Err(FilmError::Mixed { folder: folder.to_owned(), found });
        }
    }
    Ok(())
}

/// A picture as PNG; with `transparent` its fourth byte is how much it covers, else it is opaque.
///
/// # Errors
/// If the picture's bytes are not those of its size.
pub fn encode_png(picture: &Picture, transparent: bool) -> Result<Vec<u8>, image::ImageError> {
    let mut bytes = Vec::new();
    let encoder =
        PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Adaptive);
    let (w, h) = (picture.width, picture.height);
    match transparent {
        true => encoder.write_image(&picture.rgba, w, h, ExtendedColorType::Rgba8)?,
        false => {
            let rgb: Vec<u8> =
                picture.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
            encoder.write_image(&rgb, w, h, ExtendedColorType::Rgb8)?;
        }
    }
    Ok(bytes)
}

/// Says early whether a file could be written there; leaves nothing.
///
/// # Errors
/// If it could not.
pub fn check_place(path: &Path) -> Result<(), FilmError> {
    let mut scratch = Scratch::beside(path);
    drop(create(path, &scratch.path)?);
    scratch.there = true;
    Ok(())
}

/// Writes a whole file under another name beside its place, then gives it its name.
///
/// # Errors
/// If it cannot be written; nothing is left then.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), FilmError> {
    let mut scratch = Scratch::beside(path);
    let failed = FilmError::write(path);
    let mut file = create(path, &scratch.path)?;
    scratch.there = true;
    file.write_all(bytes).and_then(|()| file.sync_all()).map_err(&failed)?;
    drop(file);
    fs::rename(&scratch.path, path).map_err(&failed)?;
    scratch.there = false;
    Ok(())
}

#[cfg(test)]
mod tests;
