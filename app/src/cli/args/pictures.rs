//! What `render`, `movie` and `report` take beside the common options.

use super::{Caching, Cli, Common, Coverage, named_view, place, point};
use crate::output::{Background, Format};
use clap::{Args, CommandFactory, ValueEnum};
use glam::{DVec3, Vec3};
use std::path::PathBuf;
use topout_render::Sun;
use topout_scene::NamedView;
use topout_schedule::Time;

/// From where a picture is taken, and what it shows beside the scene.
#[derive(Args, Debug, Clone)]
pub struct Looking {
    /// Direction to look from, with everything in the frame [default: iso].
    #[arg(long, value_name = "NAME", value_parser = named_view, conflicts_with_all = ["eye", "target"])]
    pub view: Option<NamedView>,

    /// Where the camera stands, in the file's coordinates (metres, up is +Y).
    #[arg(long, value_name = "X,Y,Z", requires = "target", value_parser = point, allow_hyphen_values = true)]
    pub eye: Option<DVec3>,

    /// What the camera looks at, in the file's coordinates.
    #[arg(long, value_name = "X,Y,Z", requires = "eye", value_parser = point, allow_hyphen_values = true)]
    pub target: Option<DVec3>,

    /// How much of the screen the building covers: 1/1, 1/4, 1/16 [default: 1/1].
    #[arg(long, value_name = "1/N", conflicts_with_all = ["eye", "target"])]
    pub coverage: Option<Coverage>,

    /// Colour clusters by the level that made them, from violet (fine) to red (coarse); exact
    /// elements are grey.
    #[arg(long)]
    pub color_levels: bool,

    /// Light of the sun as it stands there at the instant shown, degrees north and east [default: a
    /// fixed sun].
    #[arg(long, value_name = "LAT,LON", value_parser = place, allow_hyphen_values = true)]
    pub sun: Option<Sun>,

    /// Line the elements of this name, label, guid or kind (IfcSlab), as the window does with what is selected.
    #[arg(long, value_name = "NAME")]
    pub select: Option<String>,

    /// Show only what lies on one side of a plane, such as y<12.5 or x>-3, in the file's coordinates (metres, up
    /// is +Y); may be given several times.
    #[arg(long, value_name = "AXIS<METRES", value_parser = half_space, allow_hyphen_values = true)]
    pub section: Vec<HalfSpace>,

    /// What stands behind the scene.
    #[arg(long, value_name = "WHAT", default_value = "scenery")]
    pub background: BackgroundChoice,
}

/// One side of a plane across an axis.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HalfSpace {
    /// A point of the plane, in the file's coordinates.
    pub point: DVec3,
    /// From the plane into what is not shown.
    pub outward: Vec3,
}

fn half_space(text: &str) -> Result<HalfSpace, String> {
    let parts = text.split_once(['<', '>']).and_then(|(name, metres)| {
        let axis = match name.trim() {
            "x" | "X" => Vec3::X,
            "y" | "Y" => Vec3::Y,
            "z" | "Z" => Vec3::Z,
            _ => return None,
        };
        let metres: f64 = metres.trim().parse().ok().filter(|m: &f64| m.is_finite())?;
        let outward = if text.contains('<') { axis } else { -axis };
        Some(HalfSpace { point: axis.as_dvec3() * metres, outward })
    });
    parts.ok_or_else(|| "expected an axis, < or > and metres, such as y<12.5".to_owned())
}

/// What stands behind the scene.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum BackgroundChoice {
    /// Sky and ground.
    Scenery,
    /// White.
    White,
    /// Nothing, for pictures that are laid over others.
    Transparent,
}

impl From<BackgroundChoice> for Background {
    fn from(choice: BackgroundChoice) -> Self {
        match choice {
            BackgroundChoice::Scenery => Self::Scenery,
            BackgroundChoice::White => Self::White,
            BackgroundChoice::Transparent => Self::Transparent,
        }
    }
}

/// Most frames of a film.
const MOST_FRAMES: i64 = 99_999;

/// `topout movie`
#[derive(Args, Debug)]
pub struct Movie {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub common: Common,

    #[allow(missing_docs)]
    #[command(flatten)]
    pub looking: Looking,

    /// The instant of the first frame, ISO 8601; a date alone is its 00:00 [default: the project's start].
    #[arg(long, value_name = "DATE", value_parser = Time::parse_iso)]
    pub from: Option<Time>,

    /// The instant of the last frame [default: the project's end].
    #[arg(long, value_name = "DATE", value_parser = Time::parse_iso)]
    pub to: Option<Time>,

    /// How many frames.
    #[arg(long, value_name = "N", default_value = "120", value_parser = clap::value_parser!(u32).range(1..=MOST_FRAMES))]
    pub frames: u32,

    /// Frames a second, 0.1 to 240.
    #[arg(long, value_name = "N", default_value = "24", value_parser = fps)]
    pub fps: f64,

    /// Degrees by which the camera turns around what it looks at, evenly over the film.
    #[arg(long, value_name = "DEGREES", default_value = "0", value_parser = turn, allow_negative_numbers = true)]
    pub turn: f32,

    /// Write date, week and activities at work onto each frame, and what its colours mean.
    #[arg(long)]
    pub caption: bool,

    /// What to write: a name that ends in .gif or .mp4, else a folder of PNG files, made if it is missing.
    #[arg(short, value_name = "DIR|FILE", value_parser = film)]
    pub output: PathBuf,

    #[allow(missing_docs)]
    #[command(flatten)]
    pub caching: Caching,
}

impl Movie {
    /// Refuses what cannot become a film, as far as that is known without the project.
    ///
    /// # Errors
    /// As clap reports them.
    pub fn check(&self) -> Result<(), clap::Error> {
        use clap::error::ErrorKind;
        if let (Some(from), Some(to)) = (self.from, self.to)
            && from > to
        {
            let told = format!("--from {from} is after --to {to}");
            return Err(Cli::command().error(ErrorKind::ValueValidation, told));
        }
        let holds = Format::of(&self.output).is_ok_and(Format::holds_transparency);
        if self.looking.background == BackgroundChoice::Transparent && !holds {
            let told =
                "--background transparent: only a folder of PNG files holds transparent pictures";
            return Err(Cli::command().error(ErrorKind::ArgumentConflict, told));
        }
        Ok(())
    }
}

/// `topout report`
#[derive(Args, Debug)]
pub struct Page {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub common: Common,

    #[allow(missing_docs)]
    #[command(flatten)]
    pub looking: Looking,

    /// HTML file to write; nothing beside it is needed to read it.
    #[arg(short, value_name = "FILE.html", value_parser = html)]
    pub output: PathBuf,

    #[allow(missing_docs)]
    #[command(flatten)]
    pub caching: Caching,
}

fn fps(text: &str) -> Result<f64, String> {
    let wanted = text.parse().ok().filter(|fps| (0.1..=240.0).contains(fps));
    wanted.ok_or_else(|| "expected frames a second, 0.1 to 240".to_owned())
}

fn turn(text: &str) -> Result<f32, String> {
    let wanted = text.parse().ok().filter(|turn: &f32| turn.abs() <= 36_000.0);
    wanted.ok_or_else(|| "expected degrees, at most a hundred turns".to_owned())
}

fn film(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    Format::of(&path).map_err(|error| error.to_string())?;
    Ok(path)
}

fn html(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let end = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
    match end.as_ref().and_then(|end| end.to_str()) {
        Some("html" | "htm") => Ok(path),
        _ => Err("expected a name that ends in .html".to_owned()),
    }
}
