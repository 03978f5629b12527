//! Golden pictures: kept in `tests/golden`, compared by FLIP, renewed by `UPDATE_GOLDEN=1`.

use image::{ExtendedColorType, ImageFormat};
use std::path::{Path, PathBuf};
use topout::flip::Difference;
use topout_render::Picture;

/// Largest mean FLIP over the pixels that show an element in either picture that still matches.
pub const MAX_ELEMENTS: f32 = 0.02;

/// Largest mean FLIP of a tile that still matches.
///
/// One adapter gives the same picture again, byte for byte; this leaves room for another Mesa. In
/// pictures of 480 x 270 a missing storey, of fifty, changes a tile by 0.17 from the fitting
/// distance, by 0.09 from twice and by 0.034 from four times as far, where it is a pixel high.
pub const MAX_TILE: f32 = 0.025;

/// Whether a difference is small enough to be the same picture from another adapter.
pub fn matches(difference: &Difference) -> bool {
    difference.elements <= MAX_ELEMENTS && difference.worst_tile <= MAX_TILE
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn golden_path(name: &str) -> PathBuf {
    root().join("golden").join(format!("{name}.png"))
}

/// Where a picture that does not match is put, for looking at.
fn actual_path(name: &str) -> PathBuf {
    root().join("..").join("out").join("golden").join(format!("{name}.actual.png"))
}

/// Compares a picture with the golden one of that name, or becomes it under `UPDATE_GOLDEN=1`.
///
/// # Errors
/// In words, when there is no such picture or when it looks different.
pub fn check(name: &str, picture: &Picture) -> Result<(), String> {
    let path = golden_path(name);
    if std::env::var_os("UPDATE_GOLDEN").is_some_and(|v| v == "1") {
        return save(&path, picture);
    }
    let golden = open(&path)?;
    let difference = Difference::between(&golden, picture).map_err(|e| format!("{name}: {e}"))?;
    if matches(&difference) {
        return Ok(());
    }
    let actual = actual_path(name);
    save(&actual, picture)?;
    Err(format!(
        "{name}: FLIP over the elements {:.4} (at most {MAX_ELEMENTS}), in the worst tile {:.4} \
         (at most {MAX_TILE}); compare {} with {}, and set UPDATE_GOLDEN=1 if the new one is right",
        difference.elements,
        difference.worst_tile,
        actual.display(),
        path.display()
    ))
}

/// A golden picture; its transparency is the mask of the elements.
fn open(path: &Path) -> Result<Picture, String> {
    let image = image::open(path)
        .map_err(|e| format!("{}: {e}; UPDATE_GOLDEN=1 makes it", path.display()))?
        .into_rgba8();
    Ok(Picture { width: image.width(), height: image.height(), rgba: image.into_raw() })
}

fn save(path: &Path, picture: &Picture) -> Result<(), String> {
    let write = || -> anyhow::Result<()> {
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
        let (width, height) = (picture.width, picture.height);
        let (color, format) = (ExtendedColorType::Rgba8, ImageFormat::Png);
        image::save_buffer_with_format(path, &picture.rgba, width, height, color, format)?;
        Ok(())
    };
    write().map_err(|e| format!("{}: {e}", path.display()))
}
