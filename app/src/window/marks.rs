//! What is painted over the 3D view: frames, pivots, handles and distances.

use super::camera::Camera;
use super::compare::Half;
use super::measure::{self, words};
use super::navigation::Drag;
use super::raster::Raster;
use super::section::handles::{self, Handle};
use super::state::AppState;
use super::theme::{SMALL, palette};
use super::visibility::Shown;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, Ui};
use glam::{UVec2, Vec2, Vec3};
use topout_scene::Aabb;

/// Where to paint.
pub(super) struct Marks<'a> {
    pub state: &'a AppState,
    pub side: Half,
    pub raster: Raster,
}

impl Marks<'_> {
    /// Paints all of them. `gesture`: what goes on, where it began (pixels) and its pivot; `pulled`: the handle that
    /// is being pulled.
    pub fn paint(&self, ui: &Ui, gesture: Option<(Drag, Vec2, Vec3)>, pulled: Option<Handle>) {
        let painter = ui.painter().with_clip_rect(self.raster.place);
        self.absent(ui, &painter);
        self.section(ui, &painter, pulled);
        self.distances(ui, &painter);
        self.name(ui, &painter);
        match gesture {
            Some((Drag::Frame, from, _)) => {
                if let Some(to) = ui.input(|i| i.pointer.latest_pos()) {
                    let color = palette(ui).accent;
                    let frame = Rect::from_two_pos(self.position(from), to);
                    painter.rect_filled(frame, 0.0, color.gamma_multiply(0.12));
                    let stroke = Stroke::new(1.0, color);
                    painter.rect_stroke(frame, 0.0, stroke, egui::StrokeKind::Inside);
                }
            }
            Some((Drag::Orbit, _, pivot)) => {
                if let Some(at) = self.seen(pivot) {
                    painter.circle_filled(at, 3.0, palette(ui).accent);
                    painter.circle_stroke(at, 5.0, Stroke::new(1.0, Color32::WHITE));
                }
            }
            _ => {}
        }
    }

    /// Which of two plans this is.
    fn name(&self, ui: &Ui, painter: &Painter) {
        let Some([shown, other]) = self.state.names_compared() else { return };
        let text = if self.side == Half::Shown { shown } else { other };
        let font = FontId::proportional(SMALL + 2.0);
        let galley = painter.layout_no_wrap(text, font, palette(ui).text);
        // Above the figures, where these reach into the middle.
        let up = if self.raster.place.width() < 480.0 { 84.0 } else { 16.0 };
        let at = self.raster.place.center_bottom() - egui::vec2(0.0, up);
        let place = Align2::CENTER_BOTTOM.anchor_size(at, galley.size());
        painter.rect_filled(
            place.expand2(egui::vec2(8.0, 3.0)),
            4.0,
            palette(ui).panel.gamma_multiply(0.92),
        );
        painter.galley(place.min, galley, palette(ui).text);
    }

    fn position(&self, pixel: Vec2) -> Pos2 {
        self.raster.point(pixel)
    }

    fn seen(&self, point: Vec3) -> Option<Pos2> {
        let in_front = self.state.camera.depth(point) > 0.0 || self.state.camera.parallel;
        let pixel = self.state.camera.project(point, self.state.picture).filter(|_| in_front)?;
        Some(self.position(pixel))
    }

    fn line(&self, painter: &Painter, a: Vec3, b: Vec3, stroke: Stroke) {
        if let Some([a, b]) = segment(&self.state.camera, a, b, self.state.picture) {
            painter.line_segment([self.position(a), self.position(b)], stroke);
        }
    }

    /// The box of a selected element that is not there.
    fn absent(&self, ui: &Ui, painter: &Painter) {
        let state = self.state;
        if let (Some(scene), Some(element)) = (state.scene_on(self.side), state.selected.only())
            && !(scene.behaviour(element).at(state.time()) && state.shown(element) != Shown::Hidden)
        {
            let bounds: &Aabb = &scene.model.elements[element.index()].bounds;
            let stroke = Stroke::new(1.5, palette(ui).accent.gamma_multiply(0.45));
            let corners = bounds.grown(bounds.diameter() * 0.01).corners();
            for [a, b] in edges(corners) {
                self.line(painter, a, b, stroke);
            }
        }
    }

    fn section(&self, ui: &Ui, painter: &Painter, pulled: Option<Handle>) {
        let (section, colors) = (&self.state.section, palette(ui));
        if !section.on {
            return;
        }
        if let Some(boxed) = &section.boxed {
            let stroke = Stroke::new(1.0, colors.accent.gamma_multiply(0.6));
            for [a, b] in edges(boxed.corners()) {
                self.line(painter, a, b, stroke);
            }
        }
        let pointer = ui.input(|i| i.pointer.hover_pos());
        for (handle, at, outward) in handles::handles(section) {
            let Some(from) = self.seen(at) else { continue };
            let near = pointer.is_some_and(|p| p.distance(from) <= handles::REACH);
            let strong = pulled == Some(handle) || (pulled.is_none() && near);
            let color = if strong { colors.accent } else { colors.accent.gamma_multiply(0.7) };
            // An arrow the way it is pulled, of one length on the picture where that is seen.
            if let Some(to) = self.seen(at + outward * self.state.camera.depth(at).abs() * 0.02)
                && from.distance(to) > 1.0
            {
                let way = (to - from).normalized() * 18.0;
                painter.arrow(from, way, Stroke::new(2.0, color));
            }
            painter.circle_filled(from, if strong { 6.0 } else { 4.5 }, color);
            painter.circle_stroke(
                from,
                if strong { 6.0 } else { 4.5 },
                Stroke::new(1.0, Color32::WHITE),
            );
        }
    }

    fn distances(&self, ui: &Ui, painter: &Painter) {
        let measure = &self.state.measure;
        let color = palette(ui).accent;
        let pointed = || self.pointed(ui);
        let next = measure.start.filter(|_| measure.on).and_then(|start| Some([start, pointed()?]));
        for (i, ends) in measure.taken.iter().copied().chain(next).enumerate() {
            let [from, to] = ends;
            self.line(painter, from, to, Stroke::new(3.0, Color32::WHITE.gamma_multiply(0.7)));
            self.line(painter, from, to, Stroke::new(1.5, color));
            for end in ends.iter().filter_map(|end| self.seen(*end)) {
                painter.circle_filled(end, 3.0, color);
                painter.circle_stroke(end, 3.5, Stroke::new(1.0, Color32::WHITE));
            }
            if let Some(at) = self.seen((from + to) * 0.5) {
                let text = match i < measure.taken.len() {
                    true => format!("{}: {}", i + 1, words(ends)),
                    false => words(ends),
                };
                let font = FontId::proportional(SMALL);
                let galley = painter.layout_no_wrap(text, font, palette(ui).text);
                let size = galley.size();
                let place = Align2::CENTER_BOTTOM.anchor_size(at - egui::vec2(0.0, 6.0), size);
                painter.rect_filled(place.expand(3.0), 3.0, palette(ui).panel.gamma_multiply(0.9));
                painter.galley(place.min, galley, palette(ui).text);
            }
        }
        let start = measure.start.and_then(|start| self.seen(start));
        for at in start.into_iter().chain(self.snapping(ui)) {
            painter.circle_stroke(at, 5.0, Stroke::new(2.0, color));
        }
    }

    /// The point that a click would take now.
    fn pointed(&self, ui: &Ui) -> Option<Vec3> {
        let pointer =
            ui.input(|i| i.pointer.hover_pos()).filter(|p| self.raster.place.contains(*p))?;
        let pixel = self.raster.pixel(pointer);
        let hit = self.state.pick(self.side, pixel)?;
        let reach = measure::SNAP * self.raster.per_point;
        let (camera, size) = (&self.state.camera, self.state.picture);
        Some(measure::snapped(hit.corners, hit.point, camera, pixel, size, reach))
    }

    fn snapping(&self, ui: &Ui) -> Option<Pos2> {
        self.state.measure.on.then(|| self.pointed(ui)).flatten().and_then(|point| self.seen(point))
    }
}

/// The twelve edges of a box, given by its corners.
fn edges(corners: [Vec3; 8]) -> impl Iterator<Item = [Vec3; 2]> {
    (0..8usize).flat_map(move |a| {
        [1usize, 2, 4]
            .into_iter()
            .filter(move |bit| a & bit == 0)
            .map(move |bit| [corners[a], corners[a | bit]])
    })
}

/// A line on the picture, cut off at the eye's plane; `None` where nothing of it is in front.
fn segment(camera: &Camera, a: Vec3, b: Vec3, size: UVec2) -> Option<[Vec2; 2]> {
    const NEAR: f32 = 0.01;
    let (depth_a, depth_b) = (camera.depth(a), camera.depth(b));
    let cut = |from: Vec3, to: Vec3, d_from: f32, d_to: f32| {
        if d_from >= NEAR { from } else { from.lerp(to, (NEAR - d_from) / (d_to - d_from)) }
    };
    if depth_a.max(depth_b) < NEAR {
        return None;
    }
    let (from, to) = (cut(a, b, depth_a, depth_b), cut(b, a, depth_b, depth_a));
    Some([camera.project(from, size)?, camera.project(to, size)?])
}
