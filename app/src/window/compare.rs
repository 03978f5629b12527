//! Two plans beside each other: one camera, one date, two pictures.

use super::coloring::Coloring;
use super::loading::{Job, Outcome, Project, stamps};
use super::reload::{Base, Edit};
use super::state::AppState;
use crate::project::{self, Request};
use crate::report::describe;
use crate::tree::Baked;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use topout_render::DrawMode;
use topout_scene::cache::Cache;
use topout_scene::{Hdlod, Looks, Progress, Scene, hdlod};
use topout_schedule::DateSet;

/// What the shown plan is held against.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Against {
    /// The plan as it is now, whatever is changed from now on.
    Now,
    /// Another of its sets of dates.
    Dates(DateSet),
    /// Another schedule for the same models.
    Schedule(PathBuf),
}

/// One of the two pictures.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Half {
    /// The shown project.
    Shown,
    /// What it is held against, to the right of it.
    Other,
}

/// The plan on the other side.
pub struct Compared {
    /// Which it is, for people.
    pub name: String,
    /// Its scene and what follows from it.
    pub project: Arc<Project>,
    /// Its tree; none while the scene is drawn in full detail.
    pub tree: Option<Arc<Hdlod>>,
    /// The colours of its elements.
    pub coloring: Coloring,
}

/// What a picture shows.
#[derive(Clone, Copy)]
pub struct Shown<'a> {
    /// The scene and what follows from it.
    pub project: &'a Arc<Project>,
    /// Its tree, when there is one.
    pub tree: Option<&'a Arc<Hdlod>>,
    /// The colours of its elements.
    pub looks: Option<&'a Arc<Looks>>,
}

/// A comparison on its way.
pub type Comparing = Job<anyhow::Result<Compared>>;

impl Against {
    /// For people.
    pub fn name(&self) -> String {
        match self {
            Self::Now => "Plan before the changes".to_owned(),
            Self::Dates(set) => format!("{} dates", capital(set.word())),
            Self::Schedule(path) => path
                .file_name()
                .map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into()),
        }
    }

    fn compared(
        &self,
        base: Base,
        cache: Option<Cache>,
        progress: &Progress,
    ) -> anyhow::Result<Compared> {
        let (project, tree) = match self {
            Self::Now => (base.project, base.tree),
            Self::Dates(set) => {
                let schedule = base.project.scene.schedule.clone();
                let any =
                    schedule.activities.iter().any(|a| a.dates_of(*set) != Default::default());
                anyhow::ensure!(any, "no activity of this schedule has {} dates", set.word());
                let (request, stamps) = (base.project.request.clone(), base.project.stamps.clone());
                let edit = Edit::new(base, request, stamps, schedule.show(*set));
                edit.ok_or_else(|| anyhow::anyhow!("the tree belongs to another scene"))?.made()
            }
            Self::Schedule(path) => other_schedule(path, base, cache, progress)?,
        };
        Ok(Compared { name: self.name(), project, tree, coloring: Coloring::default() })
    }
}

fn other_schedule(
    path: &Path,
    base: Base,
    cache: Option<Cache>,
    progress: &Progress,
) -> anyhow::Result<(Arc<Project>, Option<Arc<Hdlod>>)> {
    let shown = Arc::clone(&base.project);
    let request = Request { schedules: vec![path.to_owned()], ..shown.request.clone() };
    let schedule = project::load_schedule(&request, progress)?;
    progress.begin("linking", 0)?;
    let stamps = stamps(&request.watched());
    if let Some(edit) = Edit::new(base, request.clone(), stamps.clone(), schedule.clone()) {
        return Ok(edit.made());
    }
    // Other activities: the scene has to be linked, and its tree built, anew.
    let scene = Arc::new(shown.scene.relinked(schedule));
    let mut baked = Baked::new(&scene, &hdlod::Settings::default(), &request, cache, progress)?;
    let tree = Some(Arc::clone(&baked.tree));
    baked.keep();
    Ok((Arc::new(shown.with_dates(request, scene, stamps)), tree))
}

/// With a capital letter.
fn capital(word: &str) -> String {
    let mut chars = word.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}

impl AppState {
    /// What a picture shows; `None` where there is nothing to show.
    pub fn on(&self, side: Half) -> Option<Shown<'_>> {
        match side {
            Half::Shown => Some(Shown {
                project: self.project.as_ref()?,
                tree: self.ready_tree(),
                looks: self.coloring.looks(),
            }),
            Half::Other => {
                let Compared { project, tree, coloring, .. } = self.compared.as_ref()?;
                Some(Shown { project, tree: tree.as_ref(), looks: coloring.looks() })
            }
        }
    }

    /// How a scene can be drawn now: in full detail until its tree is ready.
    pub fn mode_on(&self, side: Half) -> DrawMode {
        match self.on(side).and_then(|shown| shown.tree) {
            None if self.mode == DrawMode::Hdlod => DrawMode::Batched,
            _ => self.mode,
        }
    }

    /// The scene on one side.
    pub(super) fn scene_on(&self, side: Half) -> Option<&Arc<Scene>> {
        Some(&self.on(side)?.project.scene)
    }

    /// Holds the shown plan against another one.
    pub(super) fn compare(&mut self, against: Against) {
        let Some(base) = self.base() else { return };
        self.error = None;
        let cache = self.cache.clone();
        let work = move |progress: &Progress| against.compared(base, cache, progress);
        match Job::spawn("topout-compare", Arc::clone(&self.wake), work) {
            Ok(job) => self.comparing = Some(job),
            Err(error) => self.error = Some(format!("No thread for comparing: {error}")),
        }
    }

    /// Shows the project alone.
    pub(super) fn stop_comparing(&mut self) {
        (self.compared, self.comparing) = (None, None);
        self.hold_clock();
    }

    /// Takes over what was compared.
    pub(super) fn poll_comparing(&mut self) {
        let Some(job) = &self.comparing else { return };
        match job.poll() {
            Outcome::Pending => return,
            Outcome::Done(Ok(compared)) => {
                self.compared = Some(compared);
                self.hold_clock();
            }
            Outcome::Done(Err(error)) if project::is_cancelled(&error) => {}
            Outcome::Done(Err(error)) => self.error = Some(describe(&error)),
            Outcome::Died => self.error = Some("The comparing thread died.".to_owned()),
        }
        self.comparing = None;
    }

    /// The names of the two pictures.
    pub fn names_compared(&self) -> Option<[String; 2]> {
        let other = self.compared.as_ref()?;
        Some(["Plan as shown".to_owned(), other.name.clone()])
    }
}
