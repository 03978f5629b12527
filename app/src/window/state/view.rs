//! Where one looks from, and what is under the pointer.

use super::super::camera::Camera;
use super::super::compare::Half;
use super::super::history::Change;
use super::super::navigation::{EYES_M, Navigation};
use super::super::section::{Section, SectionBox};
use super::super::viewpoints::Viewpoint;
use super::super::visibility::Shown;
use super::AppState;
use glam::{UVec2, Vec3};
use topout_scene::pick::Hit;
use topout_scene::{Aabb, Containment, ElementId, NamedView, View};

impl AppState {
    /// The 3D view has this size; a camera that nobody moved since a fit fits again.
    pub fn set_picture(&mut self, size: UVec2) {
        if size != self.picture {
            self.picture = size;
            if self.fitted {
                self.fit();
            }
        }
    }

    pub(super) fn move_camera(&mut self, camera: Camera) {
        if camera != self.camera {
            self.camera = camera;
            self.fitted = false;
        }
    }

    /// How far from a point the eye may go, metres.
    pub fn far_limit(&self) -> f32 {
        self.project.as_ref().map_or(1e3, |p| p.focus.diameter().max(1.0) * 40.0)
    }

    /// The point of a present element under a pixel.
    pub fn pick(&self, side: Half, pixel: glam::Vec2) -> Option<Hit> {
        let project = self.on(side)?.project;
        let (eye, direction) = self.camera.ray(pixel, self.picture);
        let (scene, time) = (&project.scene, self.time());
        let whole = |id| self.visibility.of(scene, id) == Shown::Whole;
        project.picker.pick_among(scene, eye, direction, time, &self.section.clip(), whole)
    }

    /// The present elements within a rectangle of the picture, given by two corners in the order in which
    /// it was drawn: from left to right those that lie in it wholly, from right to left all that it touches.
    pub fn within(&self, side: Half, from: glam::Vec2, to: glam::Vec2) -> Vec<ElementId> {
        let Some(scene) = self.scene_on(side) else { return Vec::new() };
        let (min, max) = (from.min(to), from.max(to));
        let wholly = from.x <= to.x;
        let clip = self.section.clip();
        let found = |id: ElementId| {
            let bounds = &scene.model.elements[id.index()].bounds;
            if bounds.is_empty()
                || clip.test(bounds) == Containment::Outside
                || !scene.behaviour(id).at(self.time())
                || self.visibility.of(scene, id) != Shown::Whole
            {
                return false;
            }
            let corners = bounds.corners().map(|c| self.camera.project(c, self.picture));
            let seen = corners.iter().flatten();
            let (low, high) = seen
                .clone()
                .fold((glam::Vec2::INFINITY, glam::Vec2::NEG_INFINITY), |(low, high), at| {
                    (low.min(*at), high.max(*at))
                });
            match wholly {
                true => {
                    seen.count() == corners.len() && low.cmpge(min).all() && high.cmple(max).all()
                }
                false => low.cmple(max).all() && high.cmpge(min).all(),
            }
        };
        (0..scene.model.elements.len() as u32).map(ElementId).filter(|id| found(*id)).collect()
    }

    pub(super) fn step_view(&mut self, back: bool) {
        if let Some(camera) = self.trail.step(back, self.camera) {
            self.move_camera(camera);
        }
    }

    pub(super) fn save_viewpoint(&mut self) {
        let Some(project) = &self.project else { return };
        let name = format!("View {}", self.viewpoints.len() + 1);
        self.news = Some(format!("{name} is saved: {}", project.calendar.headline(self.time())));
        self.viewpoints.push(Viewpoint {
            name,
            camera: self.camera,
            time: self.time(),
            visibility: self.visibility.clone(),
            colors: self.colors,
            section: self.section.clone(),
        });
    }

    pub(super) fn show_viewpoint(&mut self, i: usize) {
        let Some(viewpoint) = self.viewpoints.get(i).cloned() else { return };
        self.trail.leave(self.camera);
        self.set_view(viewpoint);
    }

    /// Looks from there, at that date, at what was shown.
    pub(in super::super) fn set_view(&mut self, viewpoint: Viewpoint) {
        self.move_camera(viewpoint.camera);
        self.clock.pause();
        self.clock.jump(viewpoint.time);
        self.follow_clock();
        self.colors = viewpoint.colors;
        self.set_visibility(viewpoint.visibility);
        self.set_section(viewpoint.section);
        self.settle_section();
    }

    /// What the renderer is asked for.
    pub fn view(&self, size: UVec2) -> View {
        View { clip: self.section.clip(), ..self.camera.view(size, self.tolerance_px) }
    }

    /// Cuts away something else; what follows until it is settled is taken back with it.
    pub(super) fn set_section(&mut self, next: Section) {
        if next == self.section || !next.is_sound() {
            return;
        }
        let before = std::mem::replace(&mut self.section, next);
        if !std::mem::replace(&mut self.pulling_section, true) {
            self.history.push(Change::Section(before));
        }
    }

    /// What was cut away until now is one change.
    pub(super) fn settle_section(&mut self) {
        self.pulling_section = false;
    }

    /// Cuts with what there is, or no longer; where there is nothing yet, with a box.
    pub(super) fn toggle_section(&mut self) {
        if self.section.is_empty() {
            return self.section_box(!self.selected.elements().is_empty());
        }
        self.set_section(Section { on: !self.section.on, ..self.section.clone() });
    }

    /// Shows what is around the selected elements, or puts a box around everything.
    pub(super) fn section_box(&mut self, around_selection: bool) {
        let Some(project) = &self.project else { return };
        let bounds = match around_selection {
            true => self.selected_bounds(),
            false => project.focus,
        };
        if !bounds.is_empty() {
            let boxed = Some(SectionBox::around(&bounds));
            self.set_section(Section { on: true, boxed, ..self.section.clone() });
        }
    }

    /// The box of the selected elements; empty where none is.
    fn selected_bounds(&self) -> Aabb {
        let Some(project) = &self.project else { return Aabb::EMPTY };
        let boxes = self.selected.elements().iter();
        let boxes = boxes.map(|id| project.scene.model.elements[id.index()].bounds);
        boxes.fold(Aabb::EMPTY, |all, bounds| all.union(&bounds))
    }

    /// Walks or flies on for `seconds`, with these keys down; whether one moved.
    pub fn steer(&mut self, seconds: f32, fast: bool, down: impl Fn(egui::Key) -> bool) -> bool {
        let steered = self.navigation.steered(&self.camera, seconds, fast, down);
        if let Some(camera) = steered {
            self.move_camera(camera);
            self.stand();
        }
        steered.is_some()
    }

    /// On foot one stands on what is there below, as far as it is no more than a step up or one looks down
    /// on it.
    pub(super) fn stand(&mut self) {
        let (Navigation::Walk, Some(project)) = (self.navigation, &self.project) else { return };
        let scene = &project.scene;
        let whole = |id| self.visibility.of(scene, id) == Shown::Whole;
        let (eye, time) = (self.camera.eye, self.time());
        let hit =
            project.picker.pick_among(scene, eye, Vec3::NEG_Y, time, &self.section.clip(), whole);
        if let Some(hit) = hit {
            let standing = Camera { eye: hit.point + Vec3::Y * EYES_M, ..self.camera };
            self.move_camera(standing);
        }
    }

    /// What standard views fit: the building, or what a section box leaves of it.
    fn focus(&self) -> Aabb {
        let Some(project) = &self.project else { return Aabb::EMPTY };
        let whole = project.focus;
        let Some(boxed) = self.section.boxed.filter(|_| self.section.on) else { return whole };
        let boxed = Aabb::of_points(boxed.corners());
        let (min, max) = (boxed.min.max(whole.min), boxed.max.min(whole.max));
        let left = Aabb { min, max };
        if left.is_empty() { whole } else { left }
    }

    pub(super) fn fit(&mut self) {
        if self.project.is_some() {
            self.camera = self.camera.fit(&self.focus(), self.picture);
            self.fitted = true;
        }
    }

    pub(super) fn fit_selection(&mut self) {
        let bounds = self.selected_bounds();
        if !bounds.is_empty() {
            // Some of its surroundings help to see where it is.
            let around = bounds.grown(bounds.diameter().max(0.5) * 0.5);
            self.trail.leave(self.camera);
            self.move_camera(self.camera.fit(&around, self.picture));
        }
    }

    pub(super) fn look_from(&mut self, named: NamedView) {
        if self.project.is_some() {
            let parallel = self.camera.parallel;
            let fitted = Camera::fit_named(&self.focus(), named, self.picture);
            self.camera = Camera { parallel, ..fitted };
            self.fitted = true;
        }
    }
}
