//! Files that the window opens and saves, on threads of their own.

use super::super::compare::Against;
use super::super::loading::{Answer, Ask, Job, Loaded, Outcome, Project, ask, save, save_schedule};
use super::super::project_file::{self, EXTENSION};
use super::AppState;
use crate::bench::export::Format;
use crate::project::{self, Request, Source};
use crate::report::describe;
use std::path::PathBuf;
use std::sync::Arc;

impl AppState {
    pub(in super::super) fn load(&mut self, request: Request) {
        self.keep_unsaved();
        self.saved = self.closing.recovery.as_ref().and_then(|recovery| recovery.find(&request));
        if let [Source::File(path)] = &request.models[..]
            && path.extension().is_some_and(|e| e.eq_ignore_ascii_case(EXTENSION))
        {
            return match project_file::read(path) {
                Ok((request, saved)) => {
                    let recovery = self.closing.recovery.as_ref();
                    let later = recovery.and_then(|r| r.find_named(path, &request, &saved));
                    let (request, saved) = later.unwrap_or((request, saved));
                    self.load(request);
                    self.saved = Some(saved);
                }
                Err(error) => self.error = Some(describe(&error)),
            };
        }
        let names: Vec<String> = request.models.iter().map(name_of).collect();
        self.start_loading(names.join(", "), move |progress| {
            Ok(Loaded::Project(Box::new(Project::load(request, progress)?)))
        });
    }

    /// Loads on a thread of its own, in place of what is being loaded.
    pub(in super::super) fn start_loading(
        &mut self,
        what: String,
        work: impl FnOnce(&topout_scene::Progress) -> anyhow::Result<Loaded> + Send + 'static,
    ) {
        self.error = None;
        match Job::spawn("topout-load", Arc::clone(&self.wake), work) {
            Ok(job) => self.loading = Some((what, job)),
            Err(error) => self.error = Some(format!("No thread for loading {what}: {error}")),
        }
    }

    pub(super) fn ask(&mut self, what: Ask) {
        if self.dialog.is_none() {
            self.take_dialog(ask(what, Arc::clone(&self.wake)));
        }
    }

    pub(super) fn save_table(&mut self, format: Format) {
        let Some(export) = self.table.export().filter(|_| self.dialog.is_none()) else { return };
        match export.text(format) {
            Ok(text) => self.take_dialog(save(format, text, Arc::clone(&self.wake))),
            Err(error) => self.error = Some(describe(&error)),
        }
    }

    pub(super) fn save_schedule(&mut self) {
        if let Some(project) = self.project.as_ref().filter(|_| self.dialog.is_none()) {
            let scene = Arc::clone(&project.scene);
            self.take_dialog(save_schedule(scene, Arc::clone(&self.wake)));
        }
    }

    pub(super) fn take_dialog(&mut self, dialog: std::io::Result<Job<Answer>>) {
        match dialog {
            Ok(job) => self.dialog = Some(job),
            Err(error) => self.error = Some(format!("No thread for the dialog: {error}")),
        }
    }

    pub(super) fn poll_dialog(&mut self) {
        let Some(job) = &self.dialog else { return };
        let answer = match job.poll() {
            Outcome::Pending => return,
            Outcome::Done(answer) => answer,
            Outcome::Died => Answer::NoDialog("The file dialog died."),
        };
        self.dialog = None;
        match answer {
            Answer::Chosen(paths) => self.open_files(paths),
            Answer::Compared(path) => self.compare(Against::Schedule(path)),
            Answer::Closed => {}
            Answer::Project(path) => self.save_project_to(path),
            Answer::Place(path) => self.export.file = path.display().to_string(),
            Answer::Saved(Ok(path)) => self.news = Some(format!("Saved to {}", path.display())),
            Answer::Saved(Err(error)) => self.error = Some(describe(&error)),
            Answer::NoDialog(instead) => self.error = Some(instead.to_owned()),
        }
    }

    /// Models replace the project; schedules alone replace the schedule of the shown models, rules their links,
    /// and paths what moves.
    pub(super) fn open_files(&mut self, files: Vec<PathBuf>) {
        let (mut models, mut schedules) = (Vec::new(), Vec::new());
        let (mut rules, mut paths) = (None, Vec::new());
        for path in files {
            let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
            match extension.as_deref() {
                Some("glb" | "gltf" | EXTENSION) => models.push(Source::File(path)),
                Some("json") if project::says(&path, "topout-rules") => rules = Some(path),
                Some("json") if project::says(&path, "topout-paths") => paths.push(path),
                Some("json" | "csv" | "xml" | "xer" | "ifc") => schedules.push(path),
                _ => {
                    self.error = Some(format!(
                        "{}: not a file that topout opens. Models are .glb or .gltf, \
                         projects .topout, schedules are .json, .csv, .xml, .xer or .ifc.",
                        path.display()
                    ));
                    return;
                }
            }
        }
        let beside = rules.is_some() || !paths.is_empty();
        if models.is_empty() && schedules.is_empty() && !beside {
            return;
        }
        let mut shown = self.project.as_ref().map(|p| p.request.clone());
        if beside {
            let request = shown.get_or_insert_default();
            if models.is_empty() && request.models.is_empty() {
                self.error = Some("Rules and paths need a model: open it first.".to_owned());
                return;
            }
            request.rules = rules.or_else(|| request.rules.take());
            request.paths.append(&mut paths);
        }
        if models.is_empty() {
            match shown {
                Some(shown) if schedules.is_empty() => self.load_schedule(shown),
                Some(shown) => self.load_schedule(Request { schedules, ..shown }),
                None => self.waiting_schedules = schedules,
            }
            return;
        }
        if schedules.is_empty() {
            schedules = std::mem::take(&mut self.waiting_schedules);
        }
        self.load(Request { models, schedules, ..shown.unwrap_or_default() });
    }
}

/// A file's name without its folder.
fn name_of(source: &Source) -> String {
    match source {
        Source::Demo => "the demo project".to_owned(),
        Source::File(path) => path
            .file_name()
            .map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned()),
    }
}
