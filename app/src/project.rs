//! Loading: from the files that a user names to a linked [`Scene`].
//!
//! The command line and the window both load through [`load`], so they show the same thing.

use crate::report::describe;
use std::fmt;
use std::io::Read;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use topout_scene::paths::Paths;
use topout_scene::{Cancelled, Model, Progress, Scene, demo, import, link};
use topout_schedule::{Column, DateSet, Diagnostics, ReadOptions, Schedule, Severity};

/// Where a model comes from.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Source {
    /// The built-in skyscraper, with its own schedule.
    Demo,
    /// A .glb or .gltf file.
    File(PathBuf),
}

impl Source {
    /// The word that stands for [`Source::Demo`].
    pub const DEMO: &'static str = "demo";
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Demo => f.write_str(Self::DEMO),
            Self::File(path) => write!(f, "{}", path.display()),
        }
    }
}

impl From<PathBuf> for Source {
    fn from(path: PathBuf) -> Self {
        if path.as_os_str() == Self::DEMO { Self::Demo } else { Self::File(path) }
    }
}

/// A word that is neither a model file nor `demo`.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("neither a .glb or .gltf file nor the word demo, nor a sub-command")]
pub struct NotASource;

impl FromStr for Source {
    type Err = NotASource;

    /// Refuses a bare word that names no file: most likely a misspelt sub-command.
    fn from_str(text: &str) -> Result<Self, NotASource> {
        let source = Self::from(PathBuf::from(text));
        match &source {
            Self::File(path) if path.extension().is_none() && !path.exists() => Err(NotASource),
            _ => Ok(source),
        }
    }
}

/// What a user asks to open.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Request {
    /// Several make one federated scene. Must not be empty.
    pub models: Vec<Source>,
    /// Schedules and links files, merged. When there are any, they replace the demo's own.
    pub schedules: Vec<PathBuf>,
    /// The rules file that says how schedule and model are linked; by node names and guids when `None`.
    pub rules: Option<PathBuf>,
    /// Files with the paths of moving objects.
    pub paths: Vec<PathBuf>,
    /// How dates are written (`%d-%m-%Y`); ISO 8601 when `None`.
    pub date_format: Option<String>,
    /// Text encoding of CSV and XER files; by their content when `None`.
    pub encoding: Option<String>,
    /// What columns of CSV schedules mean, by their headings.
    pub columns: Vec<(String, Column)>,
    /// The field that says the kinds of activities.
    pub kind_field: Option<String>,
    /// Which dates count; those that the schedules say when `None`.
    pub dates: Option<DateSet>,
}

impl Request {
    /// The files beside the models: schedules, rules and paths. What they say can change while models are
    /// shown.
    pub fn watched(&self) -> Vec<PathBuf> {
        self.schedules.iter().chain(&self.rules).chain(&self.paths).cloned().collect()
    }

    /// The built-in skyscraper with its own schedule.
    pub fn demo() -> Self {
        Self { models: vec![Source::Demo], ..Self::default() }
    }

    fn by_dates(&self, schedule: Schedule) -> Schedule {
        match self.dates {
            Some(set) => schedule.show(set),
            None => schedule,
        }
    }
}

/// What a column of CSV schedules means, written MEANING=HEADING on the command line and in project files.
///
/// # Errors
/// What is wrong with it, in words.
pub fn parse_column(text: &str) -> Result<(String, Column), String> {
    let (word, heading) =
        text.split_once('=').ok_or_else(|| format!("{text:?}: write MEANING=HEADING"))?;
    let meaning = Column::from_word(word.trim()).ok_or_else(|| {
        format!("{word:?} is no meaning of a column; there are {}", Column::WORDS.join(", "))
    })?;
    Ok((heading.trim().to_owned(), meaning))
}

/// As [`parse_column`] reads it.
pub fn column_text((heading, meaning): &(String, Column)) -> String {
    format!("{}={heading}", meaning.word())
}

/// Reads everything and links it.
///
/// # Errors
/// A file that cannot be used, by name, or [`Cancelled`] (see [`is_cancelled`]). What is wrong
/// inside a usable file does not stop the load: it is found in [`Scene::diagnostics`].
pub fn load(request: &Request, progress: &Progress) -> anyhow::Result<Scene> {
    load_parts(request, progress, &mut Err)
}

/// Like [`load`], but files that cannot be used are left out and found in
/// [`Scene::diagnostics`] as `unusable-file`.
///
/// # Errors
/// Only [`Cancelled`].
pub fn load_what_can_be(request: &Request, progress: &Progress) -> anyhow::Result<Scene> {
    let mut unusable = Diagnostics::default();
    let mut scene = load_parts(request, progress, &mut |error| {
        let message = describe(&error);
        unusable.add(Severity::Error, "unusable-file", message.clone(), || message);
        Ok(())
    })?;
    scene.diagnostics.append(unusable);
    Ok(scene)
}

/// Whether a JSON file says near its beginning that it is of a format.
pub fn says(file: &Path, format: &str) -> bool {
    let mut head = Vec::new();
    let read = std::fs::File::open(file).and_then(|file| file.take(4096).read_to_end(&mut head));
    read.is_ok() && String::from_utf8_lossy(&head).contains(&format!("\"{format}\""))
}

/// Whether a load ended because the user asked it to.
pub fn is_cancelled(error: &anyhow::Error) -> bool {
    error.is::<Cancelled>()
}

/// Decides what becomes of the rest when one file cannot be used.
type OnUnusable<'a> = &'a mut dyn FnMut(anyhow::Error) -> anyhow::Result<()>;

fn load_parts(
    request: &Request,
    progress: &Progress,
    on_unusable: OnUnusable<'_>,
) -> anyhow::Result<Scene> {
    let mut rules = match load_rules(request) {
        Ok(rules) => rules,
        Err(error) => {
            on_unusable(error)?;
            link::Rules::default()
        }
    };
    // Models and schedules take about as long, and nothing of one is needed for the other.
    let (models, schedule) = std::thread::scope(|scope| {
        let schedule = scope.spawn(|| read_schedules(request));
        let models = read_models(request, progress, on_unusable)?;
        progress.begin("reading the schedule", 0)?;
        let schedule = schedule.join().unwrap_or_else(|panic| resume_unwind(panic));
        anyhow::Ok((models, schedule))
    })?;
    progress.check()?;
    let (models, own_schedule) = models;
    let schedule = if request.schedules.is_empty() {
        request.by_dates(own_schedule.unwrap_or_default())
    } else {
        match schedule {
            Ok(schedule) => schedule,
            Err(error) => {
                on_unusable(error)?;
                Schedule::default()
            }
        }
    };
    let mut model = import::federate(models);
    let mut schedule = schedule;
    for file in &request.paths {
        let added = Paths::read(file).and_then(|paths| paths.add_to(&mut model, &mut schedule));
        match added {
            // Rules need not look at what activities name.
            Ok(links) if request.rules.is_some() => {
                links.iter().for_each(|(activity, element)| rules.attach(activity, element));
            }
            Ok(_) => {}
            Err(error) => on_unusable(error.into())?,
        }
    }
    progress.begin("linking", 0)?;
    let scene = link::link_by(rules, model, schedule);
    progress.check()?;
    Ok(scene)
}

/// The models in the request's order, and the demo's schedule if it is among them.
fn read_models(
    request: &Request,
    progress: &Progress,
    on_unusable: OnUnusable<'_>,
) -> anyhow::Result<(Vec<Model>, Option<Schedule>)> {
    let mut models = Vec::new();
    let mut own_schedule = None;
    for source in &request.models {
        match source {
            Source::Demo => {
                let made = demo::generate(&demo::DemoSettings::default(), progress);
                progress.check()?;
                let (model, schedule) = made?;
                models.push(model);
                own_schedule = Some(schedule);
            }
            Source::File(path) => {
                let read = import::read_model(path, progress);
                progress.check()?;
                match read {
                    Ok(model) => models.push(model),
                    Err(error) => on_unusable(error.into())?,
                }
            }
        }
    }
    Ok((models, own_schedule))
}

/// Reads the schedules of a request and nothing else.
///
/// # Errors
/// A file that cannot be used, by name, or [`Cancelled`].
pub fn load_schedule(request: &Request, progress: &Progress) -> anyhow::Result<Schedule> {
    progress.begin("reading the schedule", 0)?;
    let schedule = read_schedules(request)?;
    progress.check()?;
    Ok(schedule)
}

/// Reads the rules of a request, those for names and guids where it names no file.
///
/// # Errors
/// A file that cannot be used, by name.
pub fn load_rules(request: &Request) -> anyhow::Result<link::Rules> {
    match &request.rules {
        Some(path) => Ok(link::Rules::read(path)?),
        None => Ok(link::Rules::default()),
    }
}

fn read_schedules(request: &Request) -> anyhow::Result<Schedule> {
    let options = ReadOptions {
        date_format: request.date_format.clone(),
        encoding: request.encoding.clone(),
        columns: request.columns.clone(),
        kind_field: request.kind_field.clone(),
    };
    Ok(request.by_dates(topout_schedule::read_files(&request.schedules, &options)?))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_word_demo_is_no_file() {
        assert_eq!(Source::from(PathBuf::from("demo")), Source::Demo);
        assert_eq!("./demo.glb".parse(), Ok(Source::File("./demo.glb".into())));
        assert_eq!(Source::Demo.to_string().parse(), Ok(Source::Demo));
    }

    #[test]
    fn a_bare_word_that_names_no_file_is_refused() {
        assert_eq!("chekc".parse::<Source>(), Err(NotASource));
        assert!("missing.glb".parse::<Source>().is_ok(), "a missing file is said when reading");
    }

    #[test]
    fn an_unusable_file_stops_the_load_or_is_reported() {
        let request = Request {
            models: vec![Source::File("no/such/house.glb".into())],
            schedules: vec!["no/such/plan.json".into()],
            ..Request::default()
        };
        let without = Request { rules: Some("no/such/rules.json".into()), ..request.clone() };
        let error = load(&without, &Progress::default()).unwrap_err();
        assert!(format!("{error:#}").contains("no/such/rules.json"), "{error:#}");
        let error = load(&request, &Progress::default()).unwrap_err();
        assert!(format!("{error:#}").contains("no/such/house.glb"), "{error:#}");
        let scene = load_what_can_be(&request, &Progress::default()).unwrap();
        let finding = scene.diagnostics.get("unusable-file").unwrap();
        assert_eq!(finding.count, 2);
        assert!(finding.examples[1].contains("no/such/plan.json"), "{:?}", finding.examples);
        assert!(scene.diagnostics.has_errors());
    }

    #[test]
    fn meanings_of_columns_are_read_as_they_are_written() {
        let words = Column::WORDS.into_iter().chain(["ignored"]);
        for word in words {
            let text = format!("{word}=Begin = planned");
            let column = parse_column(&text).unwrap();
            assert_eq!(column.0, "Begin = planned");
            assert_eq!(column_text(&column), text);
        }
        for (text, told) in [("Begin", "MEANING=HEADING"), ("soon=Begin", "soon")] {
            assert!(parse_column(text).unwrap_err().contains(told));
        }
    }

    #[test]
    fn a_cancelled_load_says_so() {
        let progress = Progress::default();
        progress.cancel();
        let error = load(&Request::demo(), &progress).unwrap_err();
        assert!(is_cancelled(&error), "{error:#}");
    }
}
