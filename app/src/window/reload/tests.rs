//! A schedule that is edited while the window shows it.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::project::Source;
use crate::window::{Choose, Command};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::time::Duration;
use topout_scene::cache::Cache;
use topout_scene::demo::{DemoSettings, generate};
use topout_scene::{ElementId, Model, export, link};
use topout_schedule::Time;

const DAY: i64 = 86_400;

/// A small demo project as files, and what is in them.
struct Files {
    folder: tempfile::TempDir,
    model: Model,
    schedule: Schedule,
}

impl Files {
    fn new() -> Self {
        let settings =
            DemoSettings { elements: 1_000, triangles: 46_000, activities: 850, seed: 4 };
        let (model, schedule) = generate(&settings, &Progress::default()).unwrap();
        let mut files = Self { folder: tempfile::tempdir().unwrap(), model, schedule };
        let glb = std::fs::File::create(files.path("tower.glb")).unwrap();
        export::write_glb(&files.model, std::io::BufWriter::new(glb)).unwrap();
        files.write();
        // Written and read, elements stand in another order.
        let read = project::load(&files.request(), &Progress::default()).unwrap();
        files.model = Model::clone(&read.model);
        files
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn request(&self) -> Request {
        Request {
            models: vec![Source::File(self.path("tower.glb"))],
            schedules: vec![self.path("plan.json")],
            ..Request::default()
        }
    }

    fn write(&self) {
        let mut bytes = Vec::new();
        self.schedule.write_json(&mut bytes).unwrap();
        std::fs::write(self.path("plan.json"), bytes).unwrap();
    }

    /// Moves every so many-th activity, and writes that.
    fn shift(&mut self, step: usize, days: i64) {
        for activity in self.schedule.activities.iter_mut().step_by(step) {
            let later = |t: Option<Time>| t.map(|t| t.plus_seconds(days * DAY));
            (activity.start, activity.end) = (later(activity.start), later(activity.end));
        }
        self.write();
    }

    /// Opened, with its tree.
    fn open(&self, cache: Option<Cache>) -> AppState {
        let mut state = AppState::new(Arc::new(|| ()));
        state.cache = cache;
        state.apply(Command::Load(self.request()));
        settle(&mut state);
        assert_eq!(state.error, None);
        state
    }

    /// Whether the window shows what the files say, and a whole tree of it.
    fn check(&self, state: &AppState) {
        let shown = &state.project.as_ref().unwrap().scene;
        let linked = link::link(self.model.clone(), self.schedule.clone());
        let said = format!("{:?} {:?} {:?}", state.news, state.error, state.tree_origin);
        assert!(shown.behaviours == linked.behaviours, "{said}");
        assert!(shown.element_behaviour == linked.element_behaviour, "{said}");
        assert_eq!(shown.schedule.period, linked.schedule.period);
        let tree = state.ready_tree().unwrap();
        assert_eq!(tree.validate(shown), Ok(()));
        assert_eq!(tree.stale_count(), 0);
    }
}

fn settle(state: &mut AppState) {
    while state.is_busy() {
        std::thread::sleep(Duration::from_millis(2));
        state.poll();
    }
}

/// Until the edit is shown; refining may go on.
fn reload(state: &mut AppState) {
    state.apply(Command::ReloadSchedule);
    while state.loading.is_some() {
        std::thread::sleep(Duration::from_millis(2));
        state.poll();
    }
}

#[test]
fn moved_activities_show_at_once_and_are_refined_later() {
    let mut files = Files::new();
    let mut state = files.open(None);
    state.apply(Command::JumpTo(files.schedule.period.at_fraction(0.4)));
    let element = ElementId(7);
    state.apply(Command::Choose(Choose::Only, vec![element]));
    let (camera, time) = (state.camera, state.time());
    let before = Arc::clone(state.ready_tree().unwrap());

    files.shift(5, 9);
    reload(&mut state);
    let project = Arc::clone(state.project.as_ref().unwrap());
    let linked = link::link(files.model.clone(), files.schedule.clone());
    for id in (0..linked.model.elements.len() as u32).map(ElementId) {
        assert_eq!(project.scene.behaviour(id), linked.behaviour(id));
    }
    let restated = Arc::clone(state.ready_tree().unwrap());
    assert!(restated.stale_count() > 0, "no certificate is lost, so nothing is tested");
    assert_eq!(restated.vertices.len(), before.vertices.len(), "nothing was built");
    let change = state.tree_change.as_ref().unwrap();
    assert!(!change.since(&before).unwrap().is_empty());
    assert!(change.since(&restated).is_none());
    let news = state.news.clone().unwrap();
    assert!(news.starts_with("170 activities moved") && news.contains("restated in"), "{news}");
    assert!(state.refining.is_some());

    settle(&mut state);
    files.check(&state);
    assert!(state.news.as_ref().unwrap().contains("refined in"), "{:?}", state.news);
    assert_eq!(state.tree_origin, Some("refined after an edit"));
    assert_eq!((state.camera, state.time()), (camera, time));
    assert_eq!(state.selected.only(), Some(element));
}

#[test]
fn of_several_edits_in_a_row_the_last_one_counts() {
    let mut files = Files::new();
    let mut state = files.open(None);
    for (step, days) in [(3, 5), (4, -8), (2, 30), (7, 2)] {
        files.shift(step, days);
        // The refining of the edit before is still going on, or it is not.
        reload(&mut state);
    }
    settle(&mut state);
    files.check(&state);
    files.shift(1, 11);
    reload(&mut state);
    settle(&mut state);
    files.check(&state);
}

#[test]
fn what_does_not_move_leaves_the_tree_alone() {
    let mut files = Files::new();
    let mut state = files.open(None);
    let tree = Arc::clone(state.ready_tree().unwrap());
    files.schedule.activities[3].name = "renamed".to_owned();
    files.write();
    reload(&mut state);
    assert!(state.refining.is_none());
    assert!(Arc::ptr_eq(&tree, state.ready_tree().unwrap()));
    assert_eq!(state.project.as_ref().unwrap().scene.schedule.activities[3].name, "renamed");
    assert!(state.news.as_ref().unwrap().contains("no dates differ"), "{:?}", state.news);
}

/// A reload that comes while the tree is built, and one whose snapshot is old when it is ready.
#[test]
fn an_edit_meets_a_tree_that_is_being_built() {
    let mut files = Files::new();
    let mut state = AppState::new(Arc::new(|| ()));
    state.apply(Command::Load(files.request()));
    while state.project.is_none() {
        std::thread::sleep(Duration::from_millis(2));
        state.poll();
    }
    let base = state.base().unwrap();
    assert!(base.tree.is_none(), "it cannot be ready within one frame");
    files.shift(3, 5);
    let stamps = stamps(&files.request().schedules);
    let early = Edit::new(base, files.request(), stamps, files.schedule.clone()).unwrap();
    settle(&mut state);
    assert!(state.ready_tree().is_some());
    state.take_edit(early);
    assert!(state.loading.is_some(), "worked out again");
    settle(&mut state);
    files.check(&state);

    state.apply(Command::BuildHdlod);
    state.build_tree();
    files.shift(2, -4);
    reload(&mut state);
    settle(&mut state);
    files.check(&state);
}

#[test]
fn refining_can_be_cancelled_and_asked_for() {
    let mut files = Files::new();
    let mut state = files.open(None);
    files.shift(5, 9);
    reload(&mut state);
    state.apply(Command::CancelHdlod);
    settle(&mut state);
    let stale = state.ready_tree().unwrap().stale_count();
    assert!(stale > 0, "drawn in detail instead");
    state.apply(Command::BuildHdlod);
    settle(&mut state);
    files.check(&state);
}

#[test]
fn rules_are_opened_and_looked_after_like_schedules() {
    let files = Files::new();
    let mut state = files.open(None);
    let scene = Arc::clone(&state.project.as_ref().unwrap().scene);
    let loose = scene.model.elements.iter().enumerate().find(|(i, e)| {
        scene.activities_of(topout_scene::ElementId(*i as u32)).is_empty() && !e.name.is_empty()
    });
    let (index, element) = loose.expect("the demo has neighbours");
    let activity = &scene.schedule.activities[0].id;
    let rules = files.path("links.json");
    let write = |attached: &str| {
        let text =
            format!(r#"{{"format": "topout-rules", "version": 1, "attached": [{attached}]}}"#);
        std::fs::write(&rules, text).unwrap();
    };
    let name = &element.name;
    write(&format!(r#"{{"activity": "{activity}", "elements": ["{name}"]}}"#));
    state.apply(Command::OpenFiles(vec![rules.clone()]));
    settle(&mut state);
    assert_eq!(state.error, None);
    let linked = |state: &AppState| {
        let scene = &state.project.as_ref().unwrap().scene;
        scene.activities_of(topout_scene::ElementId(index as u32)).len()
    };
    let request = &state.project.as_ref().unwrap().request;
    assert_eq!(
        (&request.rules, &request.schedules),
        (&Some(rules.clone()), &files.request().schedules)
    );
    assert_eq!(linked(&state), 1);
    let news = state.news.clone().unwrap();
    assert!(news.contains("1 elements newly linked"), "{news}");

    write("");
    reload(&mut state);
    settle(&mut state);
    assert_eq!(linked(&state), 0);
    let news = state.news.clone().unwrap();
    assert!(news.contains("1 no longer linked"), "{news}");

    std::fs::write(&rules, b"{\"format\": \"topout-rules\", \"rules\": 7}").unwrap();
    reload(&mut state);
    assert!(state.error.as_ref().unwrap().contains("links.json"), "{:?}", state.error);
    assert!(state.project.is_some(), "the project stays");
}

#[test]
fn links_by_hand_are_kept_in_a_file() {
    let files = Files::new();
    let mut state = files.open(None);
    let scene = |state: &AppState| Arc::clone(&state.project.as_ref().unwrap().scene);
    let before = scene(&state);
    let loose = (0..before.model.elements.len() as u32).map(topout_scene::ElementId).find(|&e| {
        let element = &before.model.elements[e.index()];
        before.activities_of(e).is_empty() && !element.name.is_empty()
    });
    let element = loose.expect("the demo has neighbours");
    let linked = |state: &AppState| scene(state).activities_of(element).to_vec();
    state.apply(Command::Choose(Choose::Only, vec![element]));
    state.apply(Command::Attach(vec![element], 3));
    settle(&mut state);
    assert_eq!(state.error, None);
    assert_eq!((linked(&state), state.selected.only()), (vec![3], Some(element)));
    assert!(state.news.as_ref().unwrap().contains("1 element "), "{:?}", state.news);
    let kept = files.path("plan.rules.json");
    assert_eq!(state.project.as_ref().unwrap().request.rules.as_ref(), Some(&kept));
    let rules = topout_scene::link::Rules::read(&kept).unwrap();
    assert_eq!(rules.attached[0].activity, before.schedule.activities[3].id);

    // The tree follows, and what was written is what is read.
    assert!(state.ready_tree().is_some());
    let request = state.project.as_ref().unwrap().request.clone();
    let read = project::load(&request, &Progress::default()).unwrap();
    for e in (0..before.model.elements.len() as u32).map(topout_scene::ElementId) {
        assert_eq!(read.behaviour(e), scene(&state).behaviour(e));
    }
    state.apply(Command::Detach(vec![element], 3));
    settle(&mut state);
    assert!(linked(&state).is_empty());
    assert_eq!(scene(&state).behaviour(element), before.behaviour(element));

    // A file that is there is not written over before it was opened.
    let mut other = files.open(None);
    other.apply(Command::Attach(vec![element], 5));
    settle(&mut other);
    assert_eq!(linked(&other), [5], "it holds all the same");
    assert!(other.error.as_ref().unwrap().contains("plan.rules.json"), "{:?}", other.error);
}

#[test]
fn other_activities_are_loaded_anew_and_broken_files_named() {
    let mut files = Files::new();
    let mut state = files.open(None);
    std::fs::write(files.path("plan.json"), b"{\"format\": \"4d-sched").unwrap();
    reload(&mut state);
    assert!(state.error.as_ref().unwrap().contains("plan.json"), "{:?}", state.error);
    assert!(state.ready_tree().is_some(), "the project stays");

    files.schedule.activities.truncate(700);
    files.write();
    reload(&mut state);
    let news = state.news.clone().unwrap();
    assert!(news.contains(" removed"), "{news}");
    settle(&mut state);
    files.check(&state);
    assert_eq!(state.tree_origin, Some("built"));

    let mut demo = AppState::new(Arc::new(|| ()));
    demo.apply(Command::ReloadSchedule);
    assert!(demo.loading.is_none() && demo.error.is_none());
}

/// What one window refined, the next finds, and going back finds what was there before.
#[test]
fn refined_trees_are_found_again() {
    let mut files = Files::new();
    let cache = Cache::new(files.path("trees"), u64::MAX);
    let kept = |folder: &Path| {
        let names = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name());
        names.collect::<HashSet<_>>()
    };
    let mut state = files.open(Some(cache.clone()));
    drop(state);
    let first = kept(cache.folder());
    assert_eq!(first.len(), 1);

    state = files.open(Some(cache.clone()));
    assert_eq!(state.tree_origin, Some("taken from the cache"));
    files.shift(5, 9);
    reload(&mut state);
    settle(&mut state);
    assert_eq!(state.tree_origin, Some("refined after an edit"));
    drop(state);
    assert_eq!(kept(cache.folder()).len(), 2);
    state = files.open(Some(cache.clone()));
    assert_eq!(state.tree_origin, Some("taken from the cache"));
    files.check(&state);

    files.shift(5, -9);
    reload(&mut state);
    settle(&mut state);
    assert_eq!(state.tree_origin, Some("taken from the cache"));
    files.check(&state);
}

#[test]
fn a_file_that_changes_is_read_again() {
    let mut files = Files::new();
    let mut state = files.open(None);
    assert!(state.watching.is_some());
    files.shift(5, 9);
    while state.news.is_none() {
        std::thread::sleep(Duration::from_millis(5));
        state.poll();
    }
    assert!(state.news.as_ref().unwrap().contains("170 activities moved"), "{:?}", state.news);
    settle(&mut state);
    files.check(&state);

    // Gone for a moment, as when an editor replaces it; then broken; then whole.
    let plan = files.path("plan.json");
    std::fs::remove_file(&plan).unwrap();
    std::fs::write(&plan, b"{").unwrap();
    while state.error.is_none() {
        std::thread::sleep(Duration::from_millis(5));
        state.poll();
    }
    files.shift(2, 3);
    while !state.news.as_ref().is_some_and(|news| news.starts_with("425 ")) {
        std::thread::sleep(Duration::from_millis(5));
        state.poll();
    }
    settle(&mut state);
    files.check(&state);
}
