//! Project files (.topout): which files make the project, and how it was looked at.
//!
//! A JSON object; paths are relative to the file's folder where they lie in or below the folder above it.
//! Elements are named by their guids, or else their names, so that views survive a new export of the model.

use super::camera::Camera;
use super::closing::Kept;
use super::recovery::digest;
use super::section::Section;
use super::shown::ElementColors;
use super::state::AppState;
use super::viewpoints::Viewpoint;
use super::visibility::{Shown, Visibility};
use crate::output::film::write_whole;
use crate::project::{Request, Source, column_text, parse_column};
use anyhow::{Context as _, anyhow, bail};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};
use topout_scene::{Element, ElementId, Scene};
use topout_schedule::{Column, DateSet, Time, TimeRange};

/// The word at the head of a file.
const FORMAT: &str = "topout-project";
/// Newer ones are refused.
const VERSION: u32 = 1;

/// Bytes that a file may have: a million names of hidden elements in some views.
const LARGEST: u64 = 256 << 20;

/// The extension of project files.
pub const EXTENSION: &str = "topout";

#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
struct File {
    format: String,
    version: u32,
    models: Vec<PathBuf>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    schedules: Vec<PathBuf>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rules: Option<PathBuf>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    paths: Vec<PathBuf>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    date_format: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    encoding: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    kind_field: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    columns: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    dates: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    view: Option<View>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    views: Vec<View>,
    #[serde(default, rename = "loop", skip_serializing_if = "Option::is_none")]
    looped: Option<[String; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    recovers: Option<Recovers>,
}

/// Which project file a recovery file goes on from.
#[derive(Clone, PartialEq, Debug, Default, Serialize, Deserialize)]
pub(super) struct Recovers {
    /// The project file; empty where the project never was in one.
    pub file: PathBuf,
    /// [`super::recovery::digest`] of what it held.
    pub held: String,
}

#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
struct View {
    #[serde(default)]
    name: String,
    camera: Camera,
    date: String,
    #[serde(default = "own")]
    colors: ElementColors,
    #[serde(default)]
    unscheduled: Shown,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    hidden: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    ghosts: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    section: Option<Section>,
}

fn own() -> ElementColors {
    ElementColors::Own
}

/// How a project was looked at.
#[derive(Clone, PartialEq, Debug)]
pub struct Saved {
    /// The file that says so, for messages.
    from: PathBuf,
    /// The project file, and what it held; none for what was never saved by name.
    pub(super) named: Option<Recovers>,
    /// More was done to it than its project file knows.
    pub(super) unsaved: bool,
    view: Option<View>,
    views: Vec<View>,
    looped: Option<[String; 2]>,
}

impl Saved {
    /// Whether somebody made another thing of the project than `other` has. Where one looks from, at which
    /// date and in which colours does not count.
    pub(super) fn differs(&self, other: &Self) -> bool {
        let seen = |saved: &Self| {
            let view = saved.view.clone();
            view.map(|view| (view.unscheduled, view.hidden, view.ghosts))
        };
        self.views != other.views || self.looped != other.looped || seen(self) != seen(other)
    }
}

/// Reads a project file: what to load, and how it was looked at.
///
/// # Errors
/// With the file's name, and the place in it where there is one: if it cannot be read, is something else, or
/// comes from a newer topout.
pub fn read(path: &Path) -> anyhow::Result<(Request, Saved)> {
    let named = || path.display().to_string();
    let bytes = std::fs::metadata(path).with_context(named)?.len();
    if bytes > LARGEST {
        bail!("{}: {bytes} bytes are no project file's", path.display());
    }
    let text = std::fs::read_to_string(path).with_context(named)?;
    let file: File = serde_json::from_str(&text).with_context(named)?;
    if file.format != FORMAT {
        bail!("{}: its format is {:?}, not {FORMAT:?}", path.display(), file.format);
    }
    if file.version > VERSION {
        bail!(
            "{}: version {} was written by a newer topout; this one knows {VERSION}",
            path.display(),
            file.version
        );
    }
    if file.models.is_empty() {
        bail!("{}: it names no models", path.display());
    }
    let is_project =
        |model: &&PathBuf| model.extension().is_some_and(|end| end.eq_ignore_ascii_case(EXTENSION));
    if let Some(model) = file.models.iter().find(is_project) {
        bail!("{}: {} is a project, not a model", path.display(), model.display());
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let whole = |file: PathBuf| match file.as_os_str() == Source::DEMO {
        true => file,
        false => folder.join(file),
    };
    let columns = columns_of(&file.columns);
    let dates = file.dates.as_deref().map(dates_of).transpose();
    let request = Request {
        models: file.models.into_iter().map(|model| Source::from(whole(model))).collect(),
        schedules: file.schedules.into_iter().map(whole).collect(),
        rules: file.rules.map(whole),
        paths: file.paths.into_iter().map(whole).collect(),
        date_format: file.date_format,
        encoding: file.encoding,
        kind_field: file.kind_field,
        columns: columns.with_context(named)?,
        dates: dates.with_context(named)?,
    };
    let (view, views, looped) = (file.view, file.views, file.looped);
    let known = Recovers { file: path.to_owned(), held: digest(text.as_bytes()) };
    let (named, unsaved) = match file.recovers {
        // Of a project that was never saved.
        Some(recovers) if recovers.file.as_os_str().is_empty() => (None, false),
        Some(recovers) => (Some(recovers), true),
        None => (Some(known), false),
    };
    Ok((request, Saved { from: path.to_owned(), named, unsaved, view, views, looped }))
}

fn columns_of(texts: &[String]) -> anyhow::Result<Vec<(String, Column)>> {
    let parse = |text: &String| parse_column(text).map_err(|error| anyhow!("columns: {error}"));
    texts.iter().map(parse).collect()
}

fn dates_of(word: &str) -> anyhow::Result<DateSet> {
    DateSet::from_word(word).ok_or_else(|| {
        let words = DateSet::WORDS.map(|(word, _)| word).join(", ");
        anyhow!("dates: {word:?} is none of {words}")
    })
}

/// A path as a file in `folder` names it.
fn relative(path: &Path, folder: &Path) -> PathBuf {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (path, folder) = (absolute(path), absolute(folder));
    if let Ok(below) = path.strip_prefix(&folder) {
        return below.to_owned();
    }
    let beside = folder.parent().and_then(|above| path.strip_prefix(above).ok());
    match beside {
        Some(beside) => Path::new("..").join(beside),
        None => path,
    }
}

/// With slashes on every system.
fn portable(path: PathBuf) -> PathBuf {
    let all_plain =
        path.components().all(|c| matches!(c, Component::Normal(_) | Component::ParentDir));
    match all_plain {
        true => path.to_string_lossy().replace('\\', "/").into(),
        false => path,
    }
}

fn key_of(element: &Element) -> &str {
    element.guid.as_deref().unwrap_or(&element.name)
}

impl View {
    fn of(viewpoint: &Viewpoint, scene: &Scene) -> Self {
        let named = |wanted: Shown| {
            let elements = viewpoint.visibility.elements().filter(|(_, shown)| *shown == wanted);
            let keys = elements.map(|(id, _)| key_of(&scene.model.elements[id.index()]));
            keys.filter(|key| !key.is_empty()).map(str::to_owned).collect()
        };
        Self {
            name: viewpoint.name.clone(),
            camera: viewpoint.camera,
            date: viewpoint.time.to_string(),
            colors: viewpoint.colors,
            unscheduled: viewpoint.visibility.unscheduled,
            hidden: named(Shown::Hidden),
            ghosts: named(Shown::Ghost),
            section: Some(viewpoint.section.clone()).filter(|section| !section.is_empty()),
        }
    }

    /// The view of a scene; counts the elements that the scene does not have.
    fn in_scene(
        self,
        known: &HashMap<&str, Vec<ElementId>>,
        gone: &mut usize,
    ) -> Result<Viewpoint, String> {
        let time = Time::parse_iso(&self.date).map_err(|error| error.to_string())?;
        if !self.camera.is_sound() {
            return Err("its camera has values that are no numbers".to_owned());
        }
        let section = self.section.unwrap_or_default();
        if !section.is_sound() {
            return Err("its section has values that mean nothing".to_owned());
        }
        let mut visibility = Visibility::of_unscheduled(self.unscheduled);
        for (keys, shown) in [(&self.hidden, Shown::Hidden), (&self.ghosts, Shown::Ghost)] {
            for key in keys {
                match known.get(key.as_str()) {
                    Some(elements) => visibility.set(elements, shown),
                    None => *gone += 1,
                }
            }
        }
        let (name, camera, colors) = (self.name, self.camera, self.colors);
        Ok(Viewpoint { name, camera, time, visibility, colors, section })
    }
}

impl AppState {
    /// Writes what is shown to its project file; to one beside the first model where there is none yet.
    pub(super) fn save_project(&mut self) {
        let Some(project) = &self.project else { return };
        let beside = || match project.request.models.first() {
            Some(Source::File(path)) => path.with_extension(EXTENSION),
            _ => PathBuf::from("demo").with_extension(EXTENSION),
        };
        let path = self.project_file.clone().unwrap_or_else(beside);
        if self.project_file.is_none() && path.exists() {
            self.error = Some(format!(
                "{} is there already. Open it, or save under another name (File > Save project as…).",
                path.display()
            ));
            return;
        }
        self.save_project_to(path);
    }

    /// What is shown as the text of a project file at `path`; `None` where nothing is shown.
    pub(super) fn project_text(&self, path: &Path, recovers: Option<Recovers>) -> Option<String> {
        let project = self.project.as_ref()?;
        // The folder of a bare file name is the one that the program runs in.
        let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let folder = whole.parent().unwrap_or(Path::new("")).to_owned();
        // What is recovered stands nowhere near its files.
        let relative = |path: &PathBuf| match recovers {
            Some(_) => std::path::absolute(path).unwrap_or_else(|_| path.clone()),
            None => portable(relative(path, &folder)),
        };
        let request = &project.request;
        let now = Viewpoint {
            name: String::new(),
            camera: self.camera,
            time: self.time(),
            visibility: self.visibility.clone(),
            colors: self.colors,
            section: self.section.clone(),
        };
        let view = |viewpoint| View::of(viewpoint, &project.scene);
        let looped = self.clock.looped();
        let file = File {
            format: FORMAT.to_owned(),
            version: VERSION,
            models: request
                .models
                .iter()
                .map(|source| match source {
                    Source::Demo => PathBuf::from(Source::DEMO),
                    Source::File(path) => relative(path),
                })
                .collect(),
            schedules: request.schedules.iter().map(relative).collect(),
            rules: request.rules.as_ref().map(relative),
            paths: request.paths.iter().map(relative).collect(),
            date_format: request.date_format.clone(),
            encoding: request.encoding.clone(),
            kind_field: request.kind_field.clone(),
            columns: request.columns.iter().map(column_text).collect(),
            dates: request.dates.map(|set| set.word().to_owned()),
            view: Some(view(&now)),
            views: self.viewpoints.iter().map(view).collect(),
            looped: looped.map(|range| [range.start.to_string(), range.end.to_string()]),
            recovers,
        };
        // Strings, numbers and lists can always be written.
        serde_json::to_string_pretty(&file).ok()
    }

    /// Writes what is shown to a project file.
    pub(super) fn save_project_to(&mut self, path: PathBuf) {
        let Some(text) = self.project_text(&path, None) else { return };
        match write_whole(&path, text.as_bytes()) {
            Ok(()) => {
                self.forget_recovery();
                self.news = Some(format!("The project was saved to {}", path.display()));
                self.project_file = Some(path);
                self.hold_as_saved(digest(text.as_bytes()));
            }
            Err(error) => self.error = Some(crate::report::describe(&error.into())),
        }
    }

    /// Looks at the project as its file says.
    pub(super) fn take_saved(&mut self, saved: Saved) {
        let Some(project) = self.project.clone() else { return };
        let mut known: HashMap<&str, Vec<ElementId>> = HashMap::new();
        for (i, element) in (0u32..).zip(&project.scene.model.elements) {
            known.entry(key_of(element)).or_default().push(ElementId(i));
        }
        let (mut gone, mut wrong) = (0, Vec::new());
        let mut take = |view: View| {
            let name = view.name.clone();
            let taken = view.in_scene(&known, &mut gone);
            taken.map_err(|error| wrong.push(format!("view {name:?}: {error}"))).ok()
        };
        self.viewpoints = saved.views.into_iter().filter_map(&mut take).collect();
        let now = saved.view.and_then(&mut take);
        if let Some(now) = now {
            self.set_view(now);
        }
        if let Some([start, end]) = saved.looped {
            let range = Time::parse_iso(&start)
                .and_then(|start| Ok(TimeRange { start, end: Time::parse_iso(&end)? }));
            match range {
                Ok(range) => self.clock.set_loop(Some(range)),
                Err(error) => wrong.push(format!("loop: {error}")),
            }
        }
        let file = saved.from.display();
        if !wrong.is_empty() {
            self.error = Some(format!("{file}: {}. The rest is as it was.", wrong.join("; ")));
        }
        if gone > 0 {
            let what = if gone == 1 { "element is" } else { "elements are" };
            self.news =
                Some(format!("{gone} hidden {what} no longer in the model; {file} named them."));
        }
        if let Some(named) = saved.named {
            self.project_file = Some(named.file);
            self.hold_as_saved(named.held);
            if saved.unsaved {
                self.closing.kept.iter_mut().for_each(Kept::outdate);
                self.news = Some(
                    "Changes that were not saved the last time are here again. File > Save project \
                     keeps them."
                        .to_owned(),
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::command::Command;
    use super::super::selection::Choose;
    use super::*;
    use std::sync::Arc;
    use topout_scene::{Model, link};
    use topout_schedule::{Activity, Schedule};

    fn scene(names: &[&str]) -> Arc<Scene> {
        let element = |name: &&str| Element { name: (*name).to_owned(), ..Element::default() };
        let elements = names.iter().map(element).collect();
        let at = |text: &str| Time::parse_iso(text).ok();
        let activity = Activity {
            id: "A".to_owned(),
            start: at("2026-03-01"),
            end: at("2026-09-01"),
            ..Activity::default()
        };
        let schedule = Schedule::new(String::new(), None, vec![activity], Default::default());
        Arc::new(link::link(Model { elements, ..Model::default() }, schedule))
    }

    fn state(names: &[&str], folder: &Path) -> AppState {
        let mut state = AppState::new(Arc::new(|| ()));
        let request = Request {
            models: vec![Source::File(folder.join("models/a.glb"))],
            schedules: vec![folder.join("plan.xml")],
            ..Request::default()
        };
        state.show_scene(request, scene(names));
        state
    }

    #[test]
    fn a_project_is_looked_at_as_it_was_left() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("models")).unwrap();
        let mut left = state(&["a", "b", "c"], folder.path());
        let at = |text: &str| Time::parse_iso(text).unwrap();
        for command in [
            Command::Choose(Choose::Only, vec![ElementId(1)]),
            Command::DrawSelection(Shown::Hidden),
            Command::JumpTo(at("2026-05-06T07:00")),
            Command::ToggleParallel,
            Command::ColorBy(ElementColors::Type),
            Command::SetLoop(Some(TimeRange { start: at("2026-04-01"), end: at("2026-06-01") })),
            Command::SaveViewpoint,
            Command::JumpTo(at("2026-07-08")),
            Command::SaveProject,
        ] {
            left.apply(command);
        }
        assert_eq!(left.error, None);
        let file = folder.path().join("models/a.topout");
        assert_eq!(left.project_file.as_ref(), Some(&file));
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains("\"a.glb\"") && text.contains("\"../plan.xml\""), "{text}");

        // A model that was opened by its bare name: so is the project file beside it.
        let (here, name) = (std::env::current_dir().unwrap(), "a_bare_name_of_a_test.topout");
        let mut bare = state(&["a"], &here);
        bare.save_project_to(name.into());
        let text = std::fs::read_to_string(name).unwrap();
        std::fs::remove_file(name).unwrap();
        assert!(text.contains("\"models/a.glb\"") && text.contains("\"plan.xml\""), "{text}");

        let (request, saved) = read(&file).unwrap();
        assert_eq!(request.models, [Source::File(folder.path().join("models/a.glb"))]);
        assert_eq!(request.schedules, [folder.path().join("models/../plan.xml")]);
        // Other elements, and one that was hidden is gone.
        let mut came = state(&["x", "a", "c"], folder.path());
        came.take_saved(saved.clone());
        assert!(came.news.as_ref().unwrap().starts_with("2 hidden"), "{:?}", came.news);
        assert_eq!(came.visibility.count(), 0);
        let mut came = state(&["b", "a", "c"], folder.path());
        came.take_saved(saved);
        assert_eq!((came.news.clone(), came.error.clone()), (None, None));
        assert_eq!(came.shown(ElementId(0)), Shown::Hidden, "by its name");
        assert_eq!((came.camera, came.time()), (left.camera, left.time()));
        assert_eq!((came.colors, came.clock.looped()), (left.colors, left.clock.looped()));
        assert_eq!(came.viewpoints.len(), 1);
        assert_eq!(came.viewpoints[0].time, at("2026-05-06T07:00"));
        came.apply(Command::SaveProject);
        assert_eq!(came.error, None, "its own file is written again");
        left.project_file = None;
        left.apply(Command::SaveProject);
        assert!(left.error.as_ref().unwrap().contains("there already"));
    }

    #[test]
    fn what_is_no_project_file_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("x.topout");
        for (text, told) in [
            ("{", "line 1"),
            (r#"{"format": "other", "version": 1, "models": ["a.glb"]}"#, "\"other\""),
            (r#"{"format": "topout-project", "version": 9, "models": ["a.glb"]}"#, "newer"),
            (r#"{"format": "topout-project", "version": 1, "models": []}"#, "names no models"),
            (r#"{"format": "topout-project", "version": 1, "models": ["x.topout"]}"#, "a project"),
            (
                r#"{"format": "topout-project", "version": 1, "models": ["a.glb"], "dates": "soon"}"#,
                "\"soon\" is none of planned",
            ),
            (
                r#"{"format": "topout-project", "version": 1, "models": ["a.glb"], "columns": ["begin=A"]}"#,
                "\"begin\" is no meaning of a column",
            ),
        ] {
            std::fs::write(&file, text).unwrap();
            let error = crate::report::describe(&read(&file).unwrap_err());
            assert!(error.contains("x.topout") && error.contains(told), "{error}");
        }
        assert!(read(&folder.path().join("none.topout")).is_err());
        let view = r#"{"camera": {"eye": [0,0,0], "azimuth": 0, "elevation": 0, "reach": 1, "fov_y": 1,
            "parallel": false}, "date": "soon", "name": "V"}"#;
        let text = format!(
            r#"{{"format": "topout-project", "version": 1, "models": ["a.glb"], "views": [{view}]}}"#
        );
        std::fs::write(&file, text).unwrap();
        let mut state = state(&["a"], folder.path());
        state.take_saved(read(&file).unwrap().1);
        let error = state.error.unwrap();
        assert!(error.contains("x.topout") && error.contains("soon"), "{error}");
    }
}
