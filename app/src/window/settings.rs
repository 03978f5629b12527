//! What the window remembers from one start to the next.

use super::clock::Speed;
use super::command::Command;
use super::gantt::Columns;
use super::hint::Hint;
use super::navigation::Mouse;
use super::shown::{ElementColors, Panels};
use super::state::AppState;
use super::theme::Scheme;
use crate::project::{Request, Source, column_text, parse_column};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use topout_schedule::DateSet;

/// Where eframe keeps them among what it keeps itself: the window's place and the widths of columns and panels.
pub const KEY: &str = "topout";
/// Projects that are remembered.
const RECENT: usize = 10;

/// The files of a project that was open.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Recent {
    models: Vec<PathBuf>,
    #[serde(default)]
    schedules: Vec<PathBuf>,
    #[serde(default)]
    rules: Option<PathBuf>,
    #[serde(default)]
    paths: Vec<PathBuf>,
    #[serde(default)]
    date_format: Option<String>,
    #[serde(default)]
    encoding: Option<String>,
    #[serde(default)]
    columns: Vec<String>,
    #[serde(default)]
    kind_field: Option<String>,
    #[serde(default)]
    dates: Option<String>,
}

impl Recent {
    /// `None` where nothing of it is a file.
    fn of(request: &Request) -> Option<Self> {
        let whole = |path: &PathBuf| std::path::absolute(path).unwrap_or_else(|_| path.clone());
        let models: Option<Vec<PathBuf>> = request
            .models
            .iter()
            .map(|source| match source {
                Source::File(path) => Some(whole(path)),
                Source::Demo => None,
            })
            .collect();
        Some(Self {
            models: models.filter(|models| !models.is_empty())?,
            schedules: request.schedules.iter().map(whole).collect(),
            rules: request.rules.as_ref().map(whole),
            paths: request.paths.iter().map(whole).collect(),
            date_format: request.date_format.clone(),
            encoding: request.encoding.clone(),
            columns: request.columns.iter().map(column_text).collect(),
            kind_field: request.kind_field.clone(),
            dates: request.dates.map(|set| set.word().to_owned()),
        })
    }

    /// What to load.
    pub fn request(&self) -> Request {
        Request {
            models: self.models.iter().cloned().map(Source::from).collect(),
            schedules: self.schedules.clone(),
            rules: self.rules.clone(),
            paths: self.paths.clone(),
            date_format: self.date_format.clone(),
            encoding: self.encoding.clone(),
            columns: self.columns.iter().filter_map(|text| parse_column(text).ok()).collect(),
            kind_field: self.kind_field.clone(),
            dates: self.dates.as_deref().and_then(DateSet::from_word),
        }
    }

    /// The names of its files, without their folders.
    pub fn name(&self) -> String {
        let names = self.models.iter().chain(&self.schedules).map(|path: &PathBuf| {
            let name = Path::new(path).file_name();
            name.map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned())
        });
        names.collect::<Vec<_>>().join(" + ")
    }
}

/// Everything that is remembered. What an older or newer version wrote and this one does not know is left
/// out; what it lacks is as in a first start.
#[derive(Clone, PartialEq, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    scheme: Scheme,
    mouse: Mouse,
    panels: Option<Panels>,
    speed: Option<Speed>,
    skip_idle: bool,
    colors: Option<ElementColors>,
    tolerance_px: Option<f32>,
    recent: Vec<Recent>,
    hint_seen: bool,
    gantt_columns: Option<Columns>,
}

impl Settings {
    /// What is to be remembered of a window.
    pub fn of(state: &AppState) -> Self {
        // What is looked at for a moment is not there at the next start.
        let kept = Panels {
            palette: false,
            export: false,
            diagnostics: false,
            table: false,
            shortcuts: false,
            about: false,
            ..state.panels
        };
        Self {
            scheme: state.scheme,
            mouse: state.mouse,
            panels: Some(kept),
            speed: Some(state.clock.speed),
            skip_idle: state.clock.skip_idle,
            colors: Some(state.colors),
            tolerance_px: Some(state.tolerance_px),
            recent: state.recent.clone(),
            hint_seen: state.hint.seen,
            gantt_columns: Some(state.columns),
        }
    }

    /// Sets a window up as it was.
    pub fn apply(self, state: &mut AppState) {
        state.apply(Command::SetScheme(self.scheme));
        state.mouse = self.mouse;
        state.panels = self.panels.unwrap_or(state.panels);
        state.clock.speed = self.speed.unwrap_or(state.clock.speed);
        state.clock.skip_idle = self.skip_idle;
        state.colors = self.colors.unwrap_or(state.colors);
        state.apply(Command::SetTolerance(self.tolerance_px.unwrap_or(state.tolerance_px)));
        state.recent = self.recent;
        state.columns = self.gantt_columns.unwrap_or_default();
        state.hint = Hint { open: !self.hint_seen, seen: self.hint_seen };
    }

    /// From what was kept; as in a first start where that cannot be read.
    pub fn read(text: &str) -> Self {
        serde_json::from_str(text).unwrap_or_else(|error| {
            tracing::warn!("the settings cannot be read, so they are as at first: {error}");
            Self::default()
        })
    }

    /// For [`Settings::read`].
    pub fn write(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// Remembers what is shown now, before what was shown earlier.
pub fn remember(recent: &mut Vec<Recent>, request: &Request) {
    if let Some(now) = Recent::of(request) {
        recent.retain(|known| *known != now);
        recent.insert(0, now);
        recent.truncate(RECENT);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::sync::Arc;

    #[test]
    fn a_window_comes_back_as_it_was() {
        let mut state = AppState::new(Arc::new(|| ()));
        for command in [
            Command::SetScheme(Scheme::Light),
            Command::SetMouse(Mouse::Blender),
            Command::SetColumns(Columns::default().with(5, true)),
            Command::SetSpeed(Speed::Whole(20)),
            Command::ToggleSkipIdle,
            Command::ColorBy(ElementColors::Storey),
            Command::SetTolerance(2.5),
            Command::Toggle(super::super::command::Panel::Gantt),
            Command::Toggle(super::super::command::Panel::Palette),
        ] {
            state.apply(command);
        }
        let file = |name: &str| Request {
            models: vec![Source::File(name.into())],
            schedules: vec!["plan.xml".into()],
            ..Request::default()
        };
        for name in ["a.glb", "b.glb", "a.glb"] {
            remember(&mut state.recent, &file(name));
        }
        remember(&mut state.recent, &Request::demo());
        let names: Vec<String> = state.recent.iter().map(Recent::name).collect();
        assert_eq!(names, ["a.glb + plan.xml", "b.glb + plan.xml"]);

        let kept = Settings::of(&state);
        let mut other = AppState::new(Arc::new(|| ()));
        Settings::read(&kept.write()).apply(&mut other);
        assert_eq!(Settings::of(&other), kept);
        assert!(other.panels.gantt && !other.panels.palette);
        let again = other.recent[0].request();
        assert!(again.schedules[0].is_absolute() && again.schedules[0].ends_with("plan.xml"));
    }

    #[test]
    fn what_cannot_be_read_is_as_at_first_and_what_is_unknown_is_left_out() {
        assert_eq!(Settings::read("{"), Settings::default());
        let newer = r#"{"mouse": "Cad", "holograms": true, "panels": {"gantt": true}}"#;
        let settings = Settings::read(newer);
        assert_eq!(settings.mouse, Mouse::Cad);
        assert!(settings.panels.unwrap().gantt && settings.panels.unwrap().timeline);
        for i in 0..30 {
            let mut recent = Vec::new();
            for j in 0..i {
                let models = vec![Source::File(format!("{j}.glb").into())];
                remember(&mut recent, &Request { models, ..Request::default() });
            }
            assert!(recent.len() <= RECENT);
        }
    }
}
