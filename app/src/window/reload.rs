//! Other dates for the shown project: its schedule read again, the tree brought along at once and
//! refined in the background.
//!
//! An edit is worked out on the loading thread from a snapshot of scene and tree ([`Base`]). Where the
//! window shows another tree by the time it is ready (one that was built or refined meanwhile), it is
//! worked out again from that one, without reading. Each edit ends the refining of the one before.

use super::loading::{Job, Loaded, Outcome, Project, Stamp, stamps, watch};
use super::state::{AppState, Tree};
use crate::project::{self, Request, Source};
use crate::report::{count, grouped};
use crate::tree::Baked;
use std::ops::Range;
use std::sync::{Arc, Weak};
use std::time::Instant;
use topout_scene::hdlod::{self, Restated};
use topout_scene::link::{Resync, Rules};
use topout_scene::{Cancelled, Edited, ElementId, Hdlod, Progress, Scene};
use topout_schedule::{Schedule, TimeRange};

/// What an edit starts from.
pub struct Base {
    /// What is shown.
    pub project: Arc<Project>,
    /// Its tree, where it is ready.
    pub tree: Option<Arc<Hdlod>>,
}

/// The shown project with other dates.
pub struct Edit {
    base: Base,
    project: Project,
    tree: Option<(Arc<Hdlod>, Restated)>,
    /// Activities that were moved.
    moved: usize,
    /// Links were changed, not dates.
    relinked: bool,
    /// What went wrong beside it.
    warning: Option<String>,
    /// Elements that come or go at other times.
    changed: usize,
    /// What it took besides reading, milliseconds.
    ms: f64,
}

/// What a tree was made of by an edit, and where its indices differ: enough for a GPU that holds the
/// one before.
pub struct TreeChange {
    from: Weak<Hdlod>,
    dirty: Vec<Range<usize>>,
}

impl TreeChange {
    /// Where the indices differ from those of `uploaded`; `None` where it was made of another tree.
    pub fn since(&self, uploaded: &Arc<Hdlod>) -> Option<&[Range<usize>]> {
        (self.from.as_ptr() == Arc::as_ptr(uploaded)).then_some(&self.dirty[..])
    }
}

/// The refined tree of an edited scene, and the scene that goes with it.
pub type Refining = Job<Result<(Scene, Baked), Cancelled>>;

impl Edit {
    /// Brings scene and tree to the dates of `schedule`; `None` where it differs in more than dates.
    pub fn new(
        base: Base,
        request: Request,
        stamps: Vec<Stamp>,
        schedule: Schedule,
    ) -> Option<Self> {
        let started = Instant::now();
        let edited = base.project.scene.with_schedule(schedule)?;
        Self::of(base, request, stamps, edited, false, started)
    }

    /// Brings scene and tree to other links.
    pub fn relinked(
        base: Base,
        request: Request,
        stamps: Vec<Stamp>,
        rules: Rules,
    ) -> Option<Self> {
        let started = Instant::now();
        let edited = base.project.scene.with_rules(rules);
        Self::of(base, request, stamps, edited, true, started)
    }

    fn of(
        base: Base,
        request: Request,
        stamps: Vec<Stamp>,
        edited: Edited,
        relinked: bool,
        started: Instant,
    ) -> Option<Self> {
        let scene = match &base.tree {
            // The tree names behaviours by the ids that they have.
            Some(_) => edited.scene,
            None => edited.scene.renumbered().0,
        };
        let scene = Arc::new(scene);
        let same_period = scene.schedule.period == base.project.scene.schedule.period;
        let tree = match &base.tree {
            Some(tree) if edited.changed.is_empty() && same_period => {
                Some((Arc::clone(tree), Restated::default()))
            }
            Some(tree) => {
                let mut tree = Hdlod::clone(tree);
                let done = tree.restate(&scene, &edited.changed).ok()?;
                Some((Arc::new(tree), done))
            }
            None => None,
        };
        let ms = started.elapsed().as_secs_f64() * 1e3;
        let project = base.project.with_dates(request, scene, stamps);
        let (moved, changed) = (edited.moved, edited.changed.len());
        let warning = None;
        Some(Self { base, project, tree, moved, relinked, warning, changed, ms })
    }

    /// Reads the schedule of `request` and works the edit out, or loads everything where the schedule
    /// differs in more than dates.
    ///
    /// # Errors
    /// As [`Project::load`].
    fn load(base: Base, request: Request, progress: &Progress) -> anyhow::Result<Loaded> {
        let stamps = stamps(&request.watched());
        let before = Arc::clone(&base.project);
        // Paths add to schedule and model, rules to links; a project without a schedule of its own keeps the
        // models' own.
        let dates_alone = !request.schedules.is_empty()
            && request.paths.is_empty()
            && request.rules == before.request.rules
            && project::load_rules(&request)? == *before.scene.rules;
        if dates_alone {
            let schedule = project::load_schedule(&request, progress)?;
            progress.begin("moving activities", 0)?;
            if let Some(edit) = Self::new(base, request.clone(), stamps, schedule) {
                return Ok(Loaded::Edit(Box::new(edit)));
            }
        }
        let project = Project::load(request, progress)?;
        let news = sum_up(&Resync::between(&before.scene, &project.scene));
        Ok(Loaded::Other(Box::new(project), news))
    }

    /// The project with other dates, and its tree.
    pub fn made(self) -> (Arc<Project>, Option<Arc<Hdlod>>) {
        (Arc::new(self.project), self.tree.map(|(tree, _)| tree))
    }

    /// What happened, for people.
    fn news(&self) -> String {
        if self.relinked {
            return match self.changed {
                0 => "Linked by hand: nothing comes or goes at other times".to_owned(),
                1 => "Linked by hand: 1 element comes or goes at other times".to_owned(),
                n => format!("Linked by hand: {} elements come or go at other times", count(n)),
            };
        }
        if self.moved == 0 {
            return "The schedule was read again: no dates differ.".to_owned();
        }
        let plural =
            |n: usize, what: &str| format!("{} {what}{}", count(n), if n == 1 { "" } else { "s" });
        let activities = match self.moved {
            1 => "1 activity".to_owned(),
            n => format!("{} activities", count(n)),
        };
        let elements = plural(self.changed, "element");
        match &self.tree {
            Some((tree, done)) => format!(
                "{activities} moved, {elements} changed: {} restated in {:.0} ms, {} to refine",
                plural(done.clusters, "cluster"),
                self.ms,
                grouped(tree.stale_count() as u64),
            ),
            None => format!("{activities} moved, {elements} changed in {:.0} ms", self.ms),
        }
    }
}

/// What became of activities and links, in one sentence.
fn sum_up(found: &Resync) -> String {
    let lists = [
        (found.added.len(), "activities added"),
        (found.removed.len(), "removed"),
        (found.moved.len(), "moved"),
        (found.newly_linked_elements.len(), "elements newly linked"),
        (found.newly_loose_elements.len(), "no longer linked"),
        (found.newly_loose_activities.len(), "activities now without elements"),
    ];
    let said: Vec<String> = (lists.iter())
        .filter(|(number, _)| *number > 0)
        .map(|(number, what)| format!("{} {what}", count(*number)))
        .collect();
    match said.is_empty() {
        true => "The project was read again: nothing differs.".to_owned(),
        false => format!("The project was read again: {}.", said.join(", ")),
    }
}

/// Writes rules to their file: that of the request, else one beside its first file.
///
/// # Errors
/// In words, where they are kept by the window alone.
fn keep_rules(request: &mut Request, rules: &Rules) -> Result<(), String> {
    let alone = "The link holds until the window closes";
    let model = request.models.iter().find_map(|source| match source {
        Source::File(path) => Some(path),
        Source::Demo => None,
    });
    let beside = || Some(request.schedules.first().or(model)?.with_extension("rules.json"));
    let Some(file) = request.rules.clone().or_else(beside) else {
        return Err(format!("{alone}: the demo has no file to keep rules beside."));
    };
    if request.rules.is_none() && file.exists() {
        return Err(format!(
            "{alone}: {} is there already. Open it first, then what is linked is added to it.",
            file.display()
        ));
    }
    let written = std::fs::write(&file, rules.to_json());
    written.map_err(|error| format!("{alone}: cannot write {}: {error}", file.display()))?;
    request.rules = Some(file);
    Ok(())
}

impl AppState {
    /// The tree of what is shown, where it is ready.
    pub fn ready_tree(&self) -> Option<&Arc<Hdlod>> {
        match &self.tree {
            Tree::Ready(tree) => Some(tree),
            _ => None,
        }
    }

    /// Reads the schedule of the shown project again.
    pub(super) fn reload_schedule(&mut self) {
        let Some(project) = &self.project else { return };
        if project.request.watched().is_empty() {
            self.news = Some("This project has no schedule file to read again.".to_owned());
            return;
        }
        let request = project.request.clone();
        self.load_schedule(request);
    }

    /// Reads the schedule of a request that has the models of the shown project.
    pub(super) fn load_schedule(&mut self, request: Request) {
        let Some(base) = self.base() else { return self.load(request) };
        let work = move |progress: &Progress| Edit::load(base, request, progress);
        self.start_loading("the schedule".to_owned(), work);
    }

    pub(super) fn base(&self) -> Option<Base> {
        let project = Arc::clone(self.project.as_ref()?);
        Some(Base { project, tree: self.ready_tree().cloned() })
    }

    /// Shows what an edit made, or works it out again where something else is shown by now.
    pub(super) fn take_edit(&mut self, mut edit: Edit) {
        let Some(shown) = self.base() else { return };
        let same_tree = match (&shown.tree, &edit.base.tree) {
            (Some(shown), Some(base)) => Arc::ptr_eq(shown, base),
            (shown, base) => shown.is_none() && base.is_none(),
        };
        if !same_tree || !Arc::ptr_eq(&shown.project, &edit.base.project) {
            let Project { request, stamps, scene, .. } = edit.project;
            let (relinked, warning) = (edit.relinked, edit.warning);
            let work = move |_: &Progress| {
                let again = if relinked {
                    let rules = Rules::clone(&scene.rules);
                    Edit::relinked(shown, request.clone(), stamps, rules)
                } else {
                    Edit::new(shown, request.clone(), stamps, scene.schedule.clone())
                };
                match again {
                    Some(edit) => Ok(Loaded::Edit(Box::new(Edit { warning, ..edit }))),
                    None => anyhow::bail!("the schedule no longer fits what is shown"),
                }
            };
            return self.start_loading("the schedule".to_owned(), work);
        }
        self.news = Some(edit.news());
        self.error = edit.warning.take();
        // What is at work is at work for other dates.
        let was_refining = self.refining.take().is_some();
        self.frames.clear();
        self.table.reset();
        let tree = edit.tree.take();
        self.project = Some(Arc::new(edit.project));
        self.hold_clock();
        self.watch();
        match (tree, &self.tree) {
            (Some((tree, done)), Tree::Ready(before)) => {
                let changed = !Arc::ptr_eq(&tree, before);
                if changed {
                    self.tree_change =
                        Some(TreeChange { from: Arc::downgrade(before), dirty: done.dirty });
                    self.tree_origin = Some("restated after an edit");
                    self.tree = Tree::Ready(tree);
                }
                if changed || was_refining {
                    self.refine();
                }
            }
            // The user does not want one, or it is built for the dates now.
            (_, Tree::Stopped) => {}
            _ => self.build_tree(),
        }
    }

    /// Moves activities to other dates: scene and tree follow at once.
    pub(super) fn move_activities(&mut self, moves: Vec<(usize, TimeRange)>) {
        let Some(base) = self.base() else { return };
        let (request, stamps) = (base.project.request.clone(), base.project.stamps.clone());
        let work = move |_: &Progress| {
            let started = Instant::now();
            let edited = base.project.scene.with_activity_dates(&moves)?;
            let edit = Edit::of(base, request, stamps, edited, false, started);
            let edit = edit.ok_or_else(|| anyhow::anyhow!("the tree belongs to another scene"))?;
            Ok(Loaded::Edit(Box::new(edit)))
        };
        self.start_loading("the dates".to_owned(), work);
    }

    /// Attaches elements to an activity by hand, or detaches them, and keeps that in the rules file.
    pub(super) fn link_by_hand(&mut self, elements: &[ElementId], activity: usize, attach: bool) {
        let Some(base) = self.base() else { return };
        let scene = &base.project.scene;
        let Some(activity) = scene.schedule.activities.get(activity) else { return };
        let mut rules = Rules::clone(&scene.rules);
        for element in elements.iter().map(|id| &scene.model.elements[id.index()]) {
            let key = element.guid.as_deref().unwrap_or(&element.name);
            if key.is_empty() {
                let what = if elements.len() == 1 { "This element" } else { "One of the elements" };
                self.error = Some(format!("{what} has neither a name nor a guid to link it by."));
                return;
            }
            match attach {
                true => rules.attach(&activity.id, key),
                false => rules.detach(&activity.id, key),
            }
        }
        let mut request = base.project.request.clone();
        let kept = keep_rules(&mut request, &rules);
        let stamps = stamps(&request.watched());
        let work = move |_: &Progress| {
            let edit = Edit::relinked(base, request, stamps, rules);
            let edit = edit.ok_or_else(|| anyhow::anyhow!("the tree belongs to another scene"))?;
            Ok(Loaded::Edit(Box::new(Edit { warning: kept.err(), ..edit })))
        };
        self.start_loading("the links".to_owned(), work);
    }

    /// Makes the tree of an edited scene whole, on a thread of its own.
    pub(super) fn refine(&mut self) {
        let Some(Base { project, tree: Some(tree) }) = self.base() else { return };
        let cache = self.cache.clone();
        let work = move |progress: &Progress| {
            let (scene, request) = (&project.scene, &project.request);
            Baked::refined(scene, &tree, &hdlod::Settings::default(), request, cache, progress)
        };
        match Job::spawn("topout-refine", Arc::clone(&self.wake), work) {
            Ok(job) => self.refining = Some(job),
            Err(error) => self.error = Some(format!("No thread for refining the tree: {error}")),
        }
    }

    /// Takes over a tree that was refined: a newer edit would have ended that work.
    pub(super) fn poll_refining(&mut self) {
        let Some(job) = &self.refining else { return };
        let outcome = match job.poll() {
            Outcome::Pending => return,
            Outcome::Done(done) => done.ok(),
            Outcome::Died => {
                self.error = Some(
                    "Refining the HDLOD tree failed; what it concerns is drawn in detail."
                        .to_owned(),
                );
                None
            }
        };
        let seconds = job.elapsed().as_secs_f64();
        self.refining = None;
        let (Some((scene, baked)), Some(project)) = (outcome, &self.project) else { return };
        let request = project.request.clone();
        let project = project.with_dates(request, Arc::new(scene), project.stamps.clone());
        self.project = Some(Arc::new(project));
        self.tree = Tree::Ready(Arc::clone(&baked.tree));
        self.tree_origin =
            Some(if baked.from_cache { "taken from the cache" } else { "refined after an edit" });
        if let Some(news) = &mut self.news {
            *news += &format!("; refined in {seconds:.1} s");
        }
        self.frames.clear();
        self.keep(baked);
    }

    /// Looks after the schedule's files from now on.
    pub(super) fn watch(&mut self) {
        self.watching = None;
        if let Some(project) = &self.project {
            let (files, known) = (project.request.watched(), project.stamps.clone());
            self.watch_from(files, known);
        }
    }

    fn watch_from(&mut self, files: Vec<std::path::PathBuf>, known: Vec<Stamp>) {
        if !files.is_empty() {
            // Without a thread for it the user reloads.
            self.watching = watch(files, known, Arc::clone(&self.wake)).ok();
        }
    }

    /// Reads the schedule again when its files have changed.
    pub(super) fn poll_watching(&mut self) {
        // What is being loaded now may be just that.
        if self.loading.is_some() {
            return;
        }
        let Some(job) = &self.watching else { return };
        match job.poll() {
            Outcome::Pending => {}
            Outcome::Died => self.watching = None,
            Outcome::Done(now) => {
                self.reload_schedule();
                // If that fails, the next change is the next attempt.
                let files = self.project.as_ref().map(|p| p.request.watched());
                self.watch_from(files.unwrap_or_default(), now);
            }
        }
    }
}

#[cfg(test)]
mod tests;
