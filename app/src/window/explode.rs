//! Storeys drawn apart: another model for the same schedule, made on a thread of its own.
//!
//! It has a tree of its own, which is built, or found in the cache, like any other; until then it is drawn in full
//! detail. Back together, the project and its tree are those of before, unless dates were changed meanwhile.

use super::loading::{Job, Outcome, Project};
use super::state::{AppState, Tree};
use std::sync::Arc;
use topout_scene::pick::Picker;
use topout_scene::{Hdlod, Model};

/// Farthest apart, metres.
pub const FARTHEST: f32 = 50.0;
/// Apart where nobody says how far, metres: about a storey's height.
const USUAL: f32 = 4.0;

/// Storeys that stand apart, or are asked to.
#[derive(Default)]
pub struct Explosion {
    /// Metres that are wanted.
    wanted: f32,
    /// Metres that are shown.
    shown: f32,
    job: Option<Job<Made>>,
    /// What it was before.
    before: Option<Before>,
}

/// A project with other places, made of one that was shown.
struct Made {
    of: Arc<Project>,
    project: Arc<Project>,
    gap: f32,
}

struct Before {
    model: Arc<Model>,
    /// What is shown again if nothing but places was changed.
    whole: Option<Whole>,
}

struct Whole {
    project: Arc<Project>,
    tree: Option<Arc<Hdlod>>,
    /// Where that came from.
    origin: Option<&'static str>,
    /// What it became.
    now: Arc<Project>,
}

impl Explosion {
    /// Metres by which storeys stand apart, or will.
    pub fn wanted(&self) -> f32 {
        self.wanted
    }

    /// Whether that is being made.
    pub fn is_going_on(&self) -> bool {
        self.job.is_some()
    }
}

impl Project {
    /// The same with other places.
    fn moved(&self, model: Arc<Model>) -> Self {
        let scene = Arc::new(self.scene.with_model(model));
        let request = self.request.clone();
        Self {
            looks: Arc::clone(&self.looks),
            slip_looks: self.slip_looks.clone(),
            picker: Arc::new(Picker::new(&scene)),
            focus: scene.focus_bounds(),
            ..self.with_dates(request, scene, self.stamps.clone())
        }
    }
}

impl AppState {
    /// Together, or apart by the usual distance.
    pub(super) fn toggle_explosion(&mut self) {
        self.explode(if self.explosion.wanted > 0.0 { 0.0 } else { USUAL });
    }

    /// Draws storeys so many metres farther apart.
    pub(super) fn explode(&mut self, gap: f32) {
        let Some(project) = &self.project else { return };
        if !gap.is_finite() {
            return;
        }
        if gap > 0.0 && project.scene.model.storey_offsets(1.0).is_empty() {
            self.error =
                Some("The model names fewer than two storeys: nothing to draw apart.".to_owned());
            return;
        }
        self.explosion.wanted = gap.clamp(0.0, FARTHEST);
        if self.explosion.job.is_none() && self.explosion.wanted != self.explosion.shown {
            self.start_explosion();
        }
    }

    fn start_explosion(&mut self) {
        let Some(project) = self.project.clone() else { return };
        let before = self.explosion.before.as_ref();
        let model = before.map_or(&project.scene.model, |before| &before.model);
        let (model, gap) = (Arc::clone(model), self.explosion.wanted);
        let work = move |_: &topout_scene::Progress| {
            let model = match gap > 0.0 {
                true => Arc::new(model.lifted(&model.storey_offsets(gap))),
                false => model,
            };
            Made { project: Arc::new(project.moved(model)), of: project, gap }
        };
        match Job::spawn("topout-explode", Arc::clone(&self.wake), work) {
            Ok(job) => self.explosion.job = Some(job),
            Err(error) => {
                self.error = Some(format!("No thread for drawing storeys apart: {error}"))
            }
        }
    }

    /// Takes over what was made.
    pub(super) fn poll_explosion(&mut self) {
        let Some(job) = &self.explosion.job else { return };
        let made = match job.poll() {
            Outcome::Pending => return,
            Outcome::Done(made) => made,
            Outcome::Died => {
                self.explosion.job = None;
                self.explosion.wanted = self.explosion.shown;
                self.error = Some("Drawing the storeys apart failed.".to_owned());
                return;
            }
        };
        self.explosion.job = None;
        let shown = self.project.as_ref().is_some_and(|project| Arc::ptr_eq(project, &made.of));
        if !shown || made.gap != self.explosion.wanted {
            // Other dates by now, or another distance.
            return self.start_explosion();
        }
        self.take_places(made);
    }

    fn take_places(&mut self, Made { of, project, gap }: Made) {
        let (tree, origin) = (self.ready_tree().cloned(), self.tree_origin);
        let mut before = self.explosion.before.take().unwrap_or_else(|| {
            let (project, now) = (Arc::clone(&of), Arc::clone(&of));
            let whole = Some(Whole { project, tree, origin, now });
            Before { model: Arc::clone(&of.scene.model), whole }
        });
        // Apart by another distance it is still what it was.
        let whole = before.whole.take().filter(|whole| Arc::ptr_eq(&whole.now, &of));
        self.explosion.shown = gap;
        self.refining = None;
        self.stop_comparing();
        self.frames.clear();
        self.table.reset();
        if gap > 0.0 {
            before.whole = whole.map(|whole| Whole { now: Arc::clone(&project), ..whole });
            self.explosion.before = Some(before);
            self.project = Some(project);
            return self.build_tree();
        }
        match whole {
            Some(Whole { project, tree: Some(tree), origin, .. }) => {
                self.project = Some(project);
                self.tree = Tree::Ready(tree);
                self.tree_origin = origin;
            }
            whole => {
                self.project = Some(whole.map_or(project, |whole| whole.project));
                self.build_tree();
            }
        }
    }

    /// Another project: nothing of the one before is apart.
    pub(super) fn forget_explosion(&mut self) {
        self.explosion = Explosion::default();
    }
}
