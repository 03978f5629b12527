//! What can be written on the command line. A contract: scripts call it.

mod pictures;

pub use pictures::{Looking, Movie, Page};

use crate::project::{self, Request, Source};
use crate::report::is_stdout;
use clap::builder::{NonEmptyStringValueParser, TypedValueParser};
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use glam::{DVec3, UVec2};
use std::path::PathBuf;
use std::str::FromStr;
use topout_render::{DrawMode, Occlusion, Sun};
use topout_scene::NamedView;
use topout_scene::hdlod::{Simplifier, Temporal};
use topout_schedule::{Column, DateSet, Time};

/// See a building on any day of its construction.
///
/// With no sub-command the viewer opens; with no model either, it shows the built-in demo project.
#[derive(Parser, Debug)]
#[command(name = "topout", version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// What to do instead of opening the viewer.
    #[command(subcommand)]
    pub command: Option<Command>,

    /// .glb or .gltf files, or the word demo; several make one federated scene.
    #[arg(value_name = "MODEL")]
    pub models: Vec<Source>,

    #[allow(missing_docs)]
    #[command(flatten)]
    pub reading: Reading,
}

impl Cli {
    /// What the viewer shall open: the demo project where neither model nor schedule is named.
    pub fn viewer_request(self) -> Request {
        if self.models.is_empty() && self.reading.schedule.is_empty() {
            return Request { dates: self.reading.dates, ..Request::demo() };
        }
        self.reading.request(self.models)
    }
}

/// The sub-commands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Write the demo project as files: demo.glb and demo.json.
    Demo(Demo),
    /// Say what loads, what is linked and what is wrong.
    Check(Check),
    /// Build the HDLOD tree and say what it is like.
    Bake(Bake),
    /// Draw one picture at a date.
    Render(Render),
    /// Make a film of a time: a folder of PNG files, a GIF or an MP4.
    Movie(Movie),
    /// Write a page (HTML) with pictures and progress, month by month.
    Report(Page),
    /// Measure the paper's table here.
    Bench(Bench),
    /// List or clear the trees that were built before.
    Cache(Cache),
    /// Check the tree's certified errors and its promise in pixels against full detail.
    Verify(Verify),
}

/// How files are read.
#[derive(Args, Debug, Clone)]
pub struct Reading {
    /// Schedule (.json, .csv, .xml, .xer, .ifc) or links file; may be repeated, all are merged.
    #[arg(long, value_name = "FILE")]
    pub schedule: Vec<PathBuf>,

    /// Rules that say which keys of the schedule mean which elements [default: node names and guids].
    #[arg(long, value_name = "FILE")]
    pub rules: Option<PathBuf>,

    /// Paths of moving objects (.json); may be repeated.
    #[arg(long, value_name = "FILE")]
    pub paths: Vec<PathBuf>,

    /// How the schedules write dates, for example %d-%m-%Y [default: ISO 8601].
    #[arg(long, value_name = "F", value_parser = NonEmptyStringValueParser::new().try_map(date_format))]
    pub date_format: Option<String>,

    /// Text encoding of CSV and XER files, for example windows-1252 [default: UTF-8, else windows-1252].
    #[arg(long, value_name = "NAME")]
    pub encoding: Option<String>,

    /// What a column of CSV schedules means, for example start=Begin; may be repeated.
    #[arg(long = "column", value_name = "MEANING=HEADING", value_parser = project::parse_column)]
    pub columns: Vec<(String, Column)>,

    /// The user-defined field or activity code that says the kinds of activities.
    #[arg(long, value_name = "FIELD")]
    pub kind_field: Option<String>,

    /// Which dates count: planned, actual, baseline or forecast [default: those the schedule says,
    /// else actual, else planned, else forecast].
    #[arg(long, value_name = "SET", value_parser = date_set)]
    pub dates: Option<DateSet>,
}

/// `start=Begin`.
impl Reading {
    /// With the models that go with it.
    pub fn request(&self, models: Vec<Source>) -> Request {
        Request {
            models,
            schedules: self.schedule.clone(),
            rules: self.rules.clone(),
            paths: self.paths.clone(),
            date_format: self.date_format.clone(),
            encoding: self.encoding.clone(),
            columns: self.columns.clone(),
            kind_field: self.kind_field.clone(),
            dates: self.dates,
        }
    }
}

/// What every sub-command that reads a project takes.
#[derive(Args, Debug, Clone)]
pub struct Common {
    /// .glb or .gltf files, or the word demo; several make one federated scene.
    #[arg(value_name = "MODEL", required = true)]
    pub models: Vec<Source>,

    #[allow(missing_docs)]
    #[command(flatten)]
    pub reading: Reading,

    /// Picture in physical pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub size: UVec2,

    /// Largest error of HDLOD on the picture, in physical pixels.
    #[arg(long, value_name = "PX", default_value = "1.0", value_parser = tolerance, allow_negative_numbers = true)]
    pub tolerance: f32,

    /// Way of drawing [default: hdlod; bench: all].
    #[arg(long, value_name = "WAY")]
    pub lod: Option<Lod>,

    /// What the tree promises: tight (exact in time) or the paper's own delta.
    #[arg(long, value_name = "RULE", default_value = "tight")]
    pub temporal: TemporalRule,

    /// How the tree's geometry is simplified; edges and pairs are there to compare.
    #[arg(long, value_name = "WAY", default_value = "covers")]
    pub simplifier: SimplifierChoice,

    /// Where triangles that nobody sees are left out [default: cpu on software adapters, else gpu].
    #[arg(long, value_name = "WHERE")]
    pub occlusion: Option<OcclusionChoice>,

    /// Which colours elements have [default: own].
    #[arg(long, value_name = "WHICH", default_value = "own", hide_default_value = true)]
    pub colors: Colors,

    /// What --colors slip compares [default: planned,actual].
    #[arg(long, value_name = "FROM,TO", value_parser = two_date_sets)]
    pub slip: Option<[DateSet; 2]>,

    /// Also write one JSON object to this file; - is standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

impl Common {
    /// What to load.
    pub fn request(&self) -> Request {
        self.reading.request(self.models.clone())
    }
}

/// Whether trees that were built before are used.
#[derive(Args, Debug, Clone, Copy)]
pub struct Caching {
    /// Build the tree even if it was built before, and do not keep it.
    #[arg(long)]
    pub no_cache: bool,
}

impl Caching {
    /// The user's cache, unless none is wanted.
    pub fn cache(self) -> Option<topout_scene::cache::Cache> {
        if self.no_cache { None } else { crate::tree::user_cache() }
    }
}

/// `topout demo`
#[derive(Args, Debug)]
pub struct Demo {
    /// Folder to write demo.glb and demo.json to; made if it is missing.
    #[arg(short, value_name = "DIR")]
    pub output: PathBuf,

    /// Number of building elements, 1000 to 1000000 [default: 79396].
    #[arg(long, value_name = "N")]
    pub elements: Option<usize>,

    /// Number of triangles [default: in proportion to the elements; 3632126 for 79396].
    #[arg(long, value_name = "N")]
    pub triangles: Option<usize>,

    /// Number of activities [default: in proportion to the elements; 67099 for 79396].
    #[arg(long, value_name = "N")]
    pub activities: Option<usize>,

    /// Another number gives another building of the same kind.
    #[arg(long, value_name = "S")]
    pub seed: Option<u64>,

    /// Also write one JSON object to this file; - is standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// `topout check`
#[derive(Args, Debug)]
pub struct Check {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub common: Common,

    /// Say how much later one set of dates is than another, for example planned,actual.
    #[arg(long, value_name = "FROM,TO", value_parser = two_date_sets, conflicts_with = "against")]
    pub compare: Option<[DateSet; 2]>,

    /// Say how much later the schedule is than this one.
    #[arg(long, value_name = "SCHEDULE")]
    pub against: Option<PathBuf>,

    /// Also write everything there is to look at as a table; - is standard output.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

impl Check {
    /// Refuses two results on standard output.
    ///
    /// # Errors
    /// As clap reports them.
    pub fn check(&self) -> Result<(), clap::Error> {
        let both = [&self.common.json, &self.csv];
        if both.iter().all(|f| f.as_deref().is_some_and(is_stdout)) {
            let told = "only one of --json and --csv can go to standard output";
            return Err(Cli::command().error(clap::error::ErrorKind::ArgumentConflict, told));
        }
        Ok(())
    }
}

/// `topout bake`
#[derive(Args, Debug)]
pub struct Bake {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub common: Common,

    #[allow(missing_docs)]
    #[command(flatten)]
    pub caching: Caching,
}

/// `topout render`
#[derive(Args, Debug)]
pub struct Render {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub common: Common,

    /// The instant to show, ISO 8601; a date alone is its 00:00.
    #[arg(long, value_name = "DATE", value_parser = Time::parse_iso)]
    pub at: Time,

    /// PNG file to write.
    #[arg(short, value_name = "FILE.png", value_parser = png)]
    pub output: PathBuf,

    #[allow(missing_docs)]
    #[command(flatten)]
    pub looking: Looking,

    /// Write date, week and activities at work onto the picture, and what its colours mean.
    #[arg(long)]
    pub caption: bool,

    /// Three pictures beside each other: full detail, the way of --lod, and where the two differ to the eye
    /// (FLIP: black is nowhere, pale is most).
    #[arg(long, conflicts_with_all = ["caption", "background"])]
    pub compare: bool,

    #[allow(missing_docs)]
    #[command(flatten)]
    pub caching: Caching,
}

/// `topout bench`
#[derive(Args, Debug)]
pub struct Bench {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub common: Common,

    /// Also write every figure of every cell to this file, as CSV; - is standard output.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,

    /// Also write the tables to this file, as Markdown; - is standard output.
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,

    #[allow(missing_docs)]
    #[command(flatten)]
    pub caching: Caching,
}

impl Bench {
    /// Refuses what would mix two answers on standard output.
    ///
    /// # Errors
    /// Wrong use, as clap reports it.
    pub fn check(&self) -> Result<(), clap::Error> {
        let files = [&self.common.json, &self.csv, &self.markdown];
        let to_stdout = files.into_iter().flatten().filter(|file| is_stdout(file)).count();
        if to_stdout > 1 {
            let told = "only one of --json, --csv and --markdown can go to standard output";
            return Err(Cli::command().error(clap::error::ErrorKind::ArgumentConflict, told));
        }
        Ok(())
    }

    /// The options that choose what is measured, besides those of project and plan.
    pub fn choices(&self) -> Vec<String> {
        fn choice(name: &str, value: &impl ValueEnum) -> [String; 2] {
            let value = value.to_possible_value();
            [name.to_owned(), value.map_or_else(String::new, |v| v.get_name().to_owned())]
        }
        let Common { lod, temporal, simplifier, occlusion, .. } = &self.common;
        let mut words = Vec::new();
        words.extend(lod.iter().flat_map(|lod| choice("--lod", lod)));
        if *temporal != TemporalRule::Tight {
            words.extend(choice("--temporal", temporal));
        }
        if *simplifier != SimplifierChoice::Covers {
            words.extend(choice("--simplifier", simplifier));
        }
        words.extend(occlusion.iter().flat_map(|occlusion| choice("--occlusion", occlusion)));
        words
    }
}

/// `topout cache`
#[derive(Args, Debug)]
pub struct Cache {
    /// What to do.
    #[arg(value_name = "ACTION")]
    pub action: CacheAction,

    /// Also write one JSON object to this file; - is standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// What to do with the cache.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum CacheAction {
    /// Say where it is and what lies in it.
    List,
    /// Remove all trees.
    Clear,
}

/// `topout verify`
#[derive(Args, Debug)]
pub struct Verify {
    #[allow(missing_docs)]
    #[command(flatten)]
    pub common: Common,

    /// Check every cluster and every pixel instead of a sample.
    #[arg(long)]
    pub full: bool,

    /// Also measure how tight the certified errors are, beside those a simplifier reports.
    #[arg(long)]
    pub certificates: bool,

    #[allow(missing_docs)]
    #[command(flatten)]
    pub caching: Caching,
}

/// Which colours elements have.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Colors {
    /// Those of the model.
    Own,
    /// Those of the kinds of activities that are at work on them.
    Activity,
    /// How much earlier or later their activities are: blue to red, see --slip.
    Slip,
    /// What starts within four weeks, a colour a week; what is not there yet shines through.
    Ahead,
}

/// Way of drawing.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Lod {
    /// Clusters where they are good enough, exact elements elsewhere.
    Hdlod,
    /// Every present element at full detail, in one indirect multi-draw.
    Batched,
    /// One draw call a present element: the paper's baseline.
    Objects,
}

impl From<Lod> for DrawMode {
    fn from(lod: Lod) -> Self {
        match lod {
            Lod::Hdlod => Self::Hdlod,
            Lod::Batched => Self::Batched,
            Lod::Objects => Self::Objects,
        }
    }
}

/// What the tree promises.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum TemporalRule {
    /// Every triangle is drawn exactly while what it stands for is present.
    Tight,
    /// The paper's delta: a figure of merit over time.
    Paper,
}

impl TemporalRule {
    /// As written on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tight => "tight",
            Self::Paper => "paper",
        }
    }

    /// The one that this is not.
    pub fn other(self) -> Self {
        match self {
            Self::Tight => Self::Paper,
            Self::Paper => Self::Tight,
        }
    }
}

impl From<TemporalRule> for Temporal {
    fn from(rule: TemporalRule) -> Self {
        match rule {
            TemporalRule::Tight => Self::Tight,
            TemporalRule::Paper => Self::Paper,
        }
    }
}

/// Where triangles that nobody sees are left out. No picture depends on it.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum OcclusionChoice {
    /// Nowhere.
    Off,
    /// By threads of this program.
    Cpu,
    /// By kernels on the adapter.
    Gpu,
}

impl From<OcclusionChoice> for Occlusion {
    fn from(choice: OcclusionChoice) -> Self {
        match choice {
            OcclusionChoice::Off => Self::Off,
            OcclusionChoice::Cpu => Self::Cpu,
            OcclusionChoice::Gpu => Self::Gpu,
        }
    }
}

/// How the tree's geometry is simplified.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum SimplifierChoice {
    /// Certified covers, with contraction for smooth meshes.
    Covers,
    /// Quadric contraction of edges alone.
    Edges,
    /// Quadric contraction of edges and of vertices near each other.
    Pairs,
}

impl From<SimplifierChoice> for Simplifier {
    fn from(choice: SimplifierChoice) -> Self {
        match choice {
            SimplifierChoice::Covers => Self::Covers,
            SimplifierChoice::Edges => Self::Edges,
            SimplifierChoice::Pairs => Self::Pairs,
        }
    }
}

/// The share 1/n of the screen that the building covers.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Coverage {
    /// n, at least 1.
    pub one_over: f32,
}

impl Coverage {
    /// How many times the fitting distance the camera stands away.
    pub fn distance_factor(self) -> f32 {
        self.one_over.sqrt()
    }
}

impl Default for Coverage {
    fn default() -> Self {
        Self { one_over: 1.0 }
    }
}

impl FromStr for Coverage {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        text.strip_prefix("1/")
            .and_then(|n| n.parse::<f32>().ok())
            .filter(|n| (1.0..=1e6).contains(n))
            .map(|one_over| Self { one_over })
            .ok_or_else(|| "expected 1/1, 1/4 or 1/16 (1/N with N of 1 or more)".to_owned())
    }
}

/// Largest side of a picture: what every graphics adapter takes.
const MAX_SIDE: u32 = 8192;

fn size(text: &str) -> Result<UVec2, String> {
    text.split_once(['x', 'X'])
        .and_then(|(w, h)| Some(UVec2::new(w.parse().ok()?, h.parse().ok()?)))
        .filter(|s| s.min_element() >= 1 && s.max_element() <= MAX_SIDE)
        .ok_or_else(|| format!("expected width x height such as 1280x720, 1 to {MAX_SIDE} each"))
}

fn tolerance(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|t: &f32| t.is_finite() && *t >= 0.0)
        .ok_or_else(|| "expected pixels, 0 or more".to_owned())
}

fn point(text: &str) -> Result<DVec3, String> {
    let parts: Vec<f64> = text
        .split(',')
        .map(|p| p.trim().parse().ok().filter(|v: &f64| v.is_finite()))
        .collect::<Option<_>>()
        .unwrap_or_default();
    <[f64; 3]>::try_from(parts)
        .map(DVec3::from)
        .map_err(|_| "expected three numbers X,Y,Z in metres".to_owned())
}

fn place(text: &str) -> Result<Sun, String> {
    text.split_once(',')
        .and_then(|(lat, lon)| Some((lat.trim().parse().ok()?, lon.trim().parse().ok()?)))
        .filter(|(lat, lon): &(f32, f32)| lat.abs() <= 90.0 && lon.abs() <= 180.0)
        .map(|(latitude_deg, longitude_deg)| Sun::Place { latitude_deg, longitude_deg })
        .ok_or_else(|| "expected degrees north and east such as 52.5,13.4".to_owned())
}

fn named_view(text: &str) -> Result<NamedView, String> {
    NamedView::ALL.iter().find(|(_, name)| *name == text).map(|(view, _)| *view).ok_or_else(|| {
        format!("expected one of {}", NamedView::ALL.map(|(_, name)| name).join(", "))
    })
}

fn png(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("png") => Ok(path),
        _ => Err("expected a name that ends in .png".to_owned()),
    }
}

fn date_set(text: &str) -> Result<DateSet, String> {
    DateSet::from_word(text.trim()).ok_or_else(|| {
        format!("expected one of {}", DateSet::WORDS.map(|(word, _)| word).join(", "))
    })
}

fn two_date_sets(text: &str) -> Result<[DateSet; 2], String> {
    let (from, to) = text.split_once(',').ok_or("expected two sets such as planned,actual")?;
    Ok([date_set(from)?, date_set(to)?])
}

fn date_format(text: String) -> Result<String, String> {
    let wrong = chrono::format::StrftimeItems::new(&text)
        .any(|item| matches!(item, chrono::format::Item::Error));
    let none = !text.contains('%');
    if wrong || none { Err("expected fields such as %d-%m-%Y %H:%M".to_owned()) } else { Ok(text) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use clap::error::ErrorKind;

    fn parse(line: &str) -> Result<Cli, ErrorKind> {
        Cli::try_parse_from(line.split_whitespace()).map_err(|e| e.kind())
    }

    fn render(line: &str) -> Render {
        match parse(&format!("topout render {line}")).unwrap().command {
            Some(Command::Render(args)) => args,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn definition_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn no_arguments_mean_the_viewer_with_the_demo() {
        assert_eq!(parse("topout").unwrap().viewer_request(), Request::demo());
    }

    #[test]
    fn models_and_schedules_open_in_the_viewer() {
        let cli = parse("topout a.glb demo --schedule s.csv --schedule l.csv").unwrap();
        assert!(cli.command.is_none());
        let request = cli.viewer_request();
        assert_eq!(request.models, [Source::File("a.glb".into()), Source::Demo]);
        assert_eq!(request.schedules, [PathBuf::from("s.csv"), PathBuf::from("l.csv")]);
    }

    #[test]
    fn the_defaults_are_those_of_the_contract() {
        let args = render("demo --at 2026-05-04 -o a.png");
        assert_eq!(args.common.size, UVec2::new(1280, 720));
        assert_eq!(args.common.tolerance, 1.0);
        assert_eq!(args.common.temporal, TemporalRule::Tight);
        assert_eq!(args.common.simplifier, SimplifierChoice::Covers);
        assert_eq!(args.common.lod, None);
        assert_eq!(args.at, Time::parse_iso("2026-05-04T00:00:00").unwrap());
    }

    #[test]
    fn cameras_are_read_and_exclude_each_other() {
        let args = render("demo --at 2026-05-04 -o a.png --eye -1,2.5,3 --target 0,0,-7e2");
        assert_eq!(args.looking.eye, Some(DVec3::new(-1.0, 2.5, 3.0)));
        assert_eq!(args.looking.target, Some(DVec3::new(0.0, 0.0, -700.0)));
        let args = render("demo --at 2026-05-04 -o a.png --view top --coverage 1/16");
        assert_eq!(args.looking.view, Some(NamedView::Top));
        assert_eq!(args.looking.coverage.unwrap().distance_factor(), 4.0);
        for (wrong, kind) in [
            ("--eye 1,2,3", ErrorKind::MissingRequiredArgument),
            ("--eye 1,2,3 --target 0,0,0 --view top", ErrorKind::ArgumentConflict),
            ("--eye 1,2,3 --target 0,0,0 --coverage 1/4", ErrorKind::ArgumentConflict),
        ] {
            let line = format!("topout render demo --at 2026-05-04 -o a.png {wrong}");
            assert_eq!(parse(&line).err(), Some(kind), "{wrong}");
        }
    }

    #[test]
    fn wrong_values_are_refused() {
        for wrong in [
            "--size 0x7",
            "--size 1280",
            "--size 99999x4",
            "--tolerance -1",
            "--tolerance NaN",
            "--lod none",
            "--temporal loose",
            "--view up",
            "--coverage 4",
            "--coverage 1/0",
            "--eye 1,2 --target 1,2,3",
            "--eye 1,2,inf --target 1,2,3",
            "--date-format %Q",
            "--date-format d-m-y",
            "--dates soon",
        ] {
            let line = format!("topout render demo --at 2026-05-04 -o a.png {wrong}");
            let kind = parse(&line).err().unwrap();
            assert!(
                matches!(kind, ErrorKind::ValueValidation | ErrorKind::InvalidValue),
                "{wrong}: {kind:?}"
            );
        }
        assert!(parse("topout render demo --at 4.5.2026 -o a.png").is_err());
        assert!(parse("topout render demo --at 2026-05-04 -o a.jpg").is_err());
        assert!(parse("topout render demo -o a.png").is_err());
        assert!(parse("topout check").is_err());
    }

    #[test]
    fn sets_of_dates_are_named() {
        let dates = |line: &str| parse(line).unwrap().viewer_request().dates;
        assert_eq!(dates("topout"), None);
        assert_eq!(dates("topout --dates baseline"), Some(DateSet::Baseline));
        assert_eq!(dates("topout a.glb --dates Actual"), Some(DateSet::Actual));
        let check = |line: &str| match parse(&format!("topout check demo {line}")).unwrap().command
        {
            Some(Command::Check(args)) => args,
            other => panic!("{other:?}"),
        };
        let args = check("--compare planned,forecast");
        assert_eq!(args.compare, Some([DateSet::Planned, DateSet::Forecast]));
        assert_eq!(check("--against old.xer").against, Some("old.xer".into()));
        for (wrong, kind) in [
            ("--compare planned", ErrorKind::ValueValidation),
            ("--compare planned,soon", ErrorKind::ValueValidation),
            ("--compare planned,actual --against a.csv", ErrorKind::ArgumentConflict),
        ] {
            assert_eq!(parse(&format!("topout check demo {wrong}")).err(), Some(kind), "{wrong}");
        }
    }

    #[test]
    fn answers_are_not_mixed_on_standard_output() {
        let bench = |line: &str| match parse(&format!("topout bench demo {line}")).unwrap().command
        {
            Some(Command::Bench(args)) => args,
            other => panic!("{other:?}"),
        };
        assert!(bench("--csv - --json a.json --markdown t.md").check().is_ok());
        let error = bench("--csv - --markdown -").check().unwrap_err();
        assert_eq!(error.kind(), ErrorKind::ArgumentConflict);
        let args = bench("--lod hdlod --temporal paper --simplifier covers --occlusion off");
        assert_eq!(args.choices().join(" "), "--lod hdlod --temporal paper --occlusion off");
    }

    #[test]
    fn a_misspelt_sub_command_is_not_taken_for_a_model() {
        assert_eq!(parse("topout chekc").err(), Some(ErrorKind::ValueValidation));
        assert!(parse("topout chekc.glb").is_ok());
    }
}
