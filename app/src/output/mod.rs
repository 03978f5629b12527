//! What leaves the program: pictures with captions, films, pages.

pub mod caption;
pub mod film;
mod gif;
pub mod movie;
mod mp4;
pub mod page;
mod palette;
pub mod shot;

pub use caption::{Caption, LegendEntry, Scribe};
pub use film::{Film, FilmError, Format, Made, Settings};
pub use shot::{Background, Studio};
