//! The 3D view: the only file that sees egui and wgpu together.
//!
//! The renderer draws into its own picture, which egui shows as an image; so the picture looks the
//! same whatever the window's format is, and nothing is drawn again until something changes.

use super::camera::Camera;
use super::command::{Command, actions};
use super::compare::{Half, Shown};
use super::marks;
use super::measure;
use super::navigation::{Drag, Navigation};
use super::raster::Raster;
use super::section::Section;
use super::section::handles::{self, Handle};
use super::selection::Choose;
use super::state::AppState;
use super::theme::palette;
use super::visibility;
use egui::{Color32, PointerButton, Pos2, Rect, Sense, TextureId, Ui};
use egui_wgpu::RenderState;
use glam::{UVec2, Vec2, Vec3};
use std::sync::Arc;
use std::time::Duration;
use topout_render::{FrameInput, Gpu, GpuError, Options, Renderer};
use topout_scene::pick::Hit;
use topout_scene::{Category, ElementId, Hdlod, Looks, Scene, hdlod};

/// For how long levels that follow each other share the pixels, where they do.
const FADE: Duration = Duration::from_millis(200);
/// Nearer (below 1) per notch of a mouse wheel.
const ZOOM_PER_NOTCH: f32 = 0.82;
/// After so many seconds without, turning the wheel is another move.
const WHEEL_RESTS: f64 = 0.7;
/// Scrolled points that count as one notch, on devices that scroll by points.
const POINTS_PER_NOTCH: f32 = 50.0;

/// The renderer, its picture within egui, and the gesture that is going on.
pub struct Viewport {
    window: RenderState,
    renderer: Renderer,
    side: Half,
    texture: Option<(TextureId, UVec2)>,
    scene: Option<Arc<Scene>>,
    tree: Option<Arc<Hdlod>>,
    /// The looks that the renderer has.
    looks: Option<Arc<Looks>>,
    /// What is uploaded has the colours of levels.
    level_colors: bool,
    /// Whether the next picture will be another.
    fading: bool,
    drawn: Option<(FrameInput, Marked)>,
    gesture: Option<Gesture>,
    /// The handle of the section that is being pulled: how the section was, and from which pixel on.
    pull: Option<(Handle, Section, Vec2)>,
    /// What the context menu was opened on.
    clicked: Option<Hit>,
    /// When the wheel turned last, seconds.
    zoomed: f64,
    /// The shaders' files are looked at, and when that was done last.
    #[cfg(debug_assertions)]
    shaders: (topout_render::ShaderFolder, std::time::Instant),
}

/// The selected elements and the colour of the line around them.
type Marked = (Vec<ElementId>, [u8; 3]);

/// A drag: what was under the pointer when the button went down.
#[derive(Clone, Copy)]
struct Gesture {
    kind: Drag,
    /// The camera at the start.
    camera: Camera,
    /// Where the button went down, pixels.
    from: Vec2,
    /// The pivot or the grabbed point.
    point: Vec3,
}

impl Drop for Viewport {
    fn drop(&mut self) {
        if let Some((id, _)) = self.texture {
            self.window.renderer.write().free_texture(&id);
        }
    }
}

impl Viewport {
    /// Shares the window's device.
    pub fn new(window: &RenderState) -> Self {
        let gpu =
            Gpu::from_parts(window.device.clone(), window.queue.clone(), window.adapter.get_info());
        Self {
            window: window.clone(),
            renderer: Renderer::new(&gpu),
            side: Half::Shown,
            texture: None,
            scene: None,
            tree: None,
            looks: None,
            level_colors: false,
            fading: false,
            drawn: None,
            gesture: None,
            pull: None,
            clicked: None,
            zoomed: f64::NEG_INFINITY,
            #[cfg(debug_assertions)]
            shaders: (topout_render::ShaderFolder::of_source(), std::time::Instant::now()),
        }
    }

    /// Whether levels share pixels: the next picture will be another.
    pub fn is_fading(&self) -> bool {
        self.fading
    }

    /// Whether the adapter draws two levels at once as easily as one.
    pub fn suits_fading(&self) -> bool {
        self.window.adapter.get_info().device_type != wgpu::DeviceType::Cpu
    }

    /// Whether a figure is still missing that a later look will bring.
    pub fn expects_gpu_times(&self) -> bool {
        self.renderer.expects_gpu_times()
    }

    /// Fills `place` with the picture of one side.
    pub fn show(&mut self, ui: &mut Ui, state: &mut AppState, side: Half, place: Rect) {
        let largest = self.window.device.limits().max_texture_dimension_2d;
        let raster = Raster::new(place, ui.ctx().pixels_per_point(), largest);
        let place = raster.place;
        let response = ui
            .allocate_rect(place, Sense::click_and_drag())
            .on_hover_cursor(egui::CursorIcon::Default);
        let name = if side == Half::Shown { "3D view" } else { "3D view of the other plan" };
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, name));
        self.side = side;
        state.set_picture(raster.size);
        if state.project.is_none() {
            ui.painter().rect_filled(place, 0.0, palette(ui).well);
            return;
        }
        for command in self.gestures(ui, &response, state, &raster) {
            state.apply(command);
        }
        let errors = [self.take_over(state), self.take_looks(state)];
        errors.into_iter().flatten().for_each(|error| state.apply(error));
        #[cfg(debug_assertions)]
        self.reload_shaders(ui, state);
        let [r, g, b, _] = palette(ui).accent.to_array();
        self.draw(state, [r, g, b]);
        if let Some((texture, _)) = self.texture {
            let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            ui.painter().image(texture, place, whole, Color32::WHITE);
        }
        let marks = marks::Marks { state, side, raster };
        marks.paint(
            ui,
            self.gesture.map(|g| (g.kind, g.from, g.point)),
            self.pull.as_ref().map(|p| p.0),
        );
    }

    fn gestures(
        &mut self,
        ui: &Ui,
        response: &egui::Response,
        state: &AppState,
        raster: &Raster,
    ) -> Vec<Command> {
        let pixel = |point| raster.pixel(point);
        let mut commands = Vec::new();
        let (origin, now, modifiers) =
            ui.input(|i| (i.pointer.press_origin(), i.pointer.latest_pos(), i.modifiers));
        if response.drag_started_by(PointerButton::Primary)
            && let Some(origin) = origin
        {
            let (at, reach) = (pixel(origin), handles::REACH * raster.per_point);
            let handle = handles::under(&state.section, &state.camera, at, state.picture, reach);
            self.pull = handle.map(|handle| (handle, state.section.clone(), at));
        }
        if let Some((handle, before, from)) = &self.pull {
            if let Some(now) = now
                && let Some(next) = handles::dragged(
                    before,
                    *handle,
                    &state.camera,
                    [*from, pixel(now)],
                    state.picture,
                )
            {
                commands.push(Command::SetSection(Box::new(next)));
            }
            if response.drag_stopped() || !response.dragged() {
                self.pull = None;
                commands.push(Command::SettleSection);
            }
            return commands;
        }
        if response.drag_started()
            && let Some(origin) = origin
        {
            let buttons = [PointerButton::Primary, PointerButton::Middle, PointerButton::Secondary];
            let button = buttons.into_iter().find(|button| response.drag_started_by(*button));
            let kind = match (button, state.navigation) {
                (Some(PointerButton::Primary), Navigation::Walk | Navigation::Fly) => Drag::Look,
                (Some(button), _) => state.mouse.drag(button, modifiers),
                (None, _) => Drag::Pan,
            };
            if kind != Drag::Frame {
                commands.push(Command::LeaveView);
            }
            let from = pixel(origin);
            let fallback = match (kind, &state.project) {
                (Drag::Orbit, Some(project)) if !project.focus.is_empty() => project.focus.center(),
                _ => state.camera.point_at_reach(from, state.picture),
            };
            let point = state.pick(self.side, from).map_or(fallback, |hit| hit.point);
            self.gesture = Some(Gesture { kind, camera: state.camera, from, point });
        }
        if let (Some(gesture), true, Some(now)) = (self.gesture, response.dragged(), now) {
            let turn = std::f32::consts::PI / state.picture.y as f32;
            let turned = response.drag_delta() * raster.per_point * turn;
            let camera = match gesture.kind {
                Drag::Orbit => state.camera.orbit(gesture.point, -turned.x, turned.y),
                Drag::Look => state.camera.orbit(state.camera.eye, -turned.x, turned.y),
                Drag::Pan => {
                    gesture.camera.pan(gesture.point, gesture.from, pixel(now), state.picture)
                }
                Drag::Zoom => {
                    let factor = 1.0 + turned.y.clamp(-0.5, 0.5);
                    state.camera.zoom(gesture.point, factor, state.far_limit())
                }
                Drag::Frame => state.camera,
            };
            commands.push(Command::MoveCamera(camera));
        }
        if response.drag_stopped()
            && let Some(gesture) = self.gesture.take()
            && let (Drag::Frame, Some(now)) = (gesture.kind, now)
        {
            let found = state.within(self.side, gesture.from, pixel(now));
            let how = if modifiers.shift { Choose::Add } else { Choose::Only };
            commands.push(Command::Choose(how, found));
        }
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            let hit = state.pick(self.side, pixel(at));
            commands.extend(match (hit, Choose::by(modifiers)) {
                (Some(hit), _) if state.measure.on => {
                    let reach = measure::SNAP * raster.per_point;
                    let point = meant(state, &hit, pixel(at), reach);
                    Some(Command::MeasureAt(point))
                }
                (None, _) if state.measure.on => None,
                (Some(hit), how) => Some(Command::Choose(how, vec![hit.element])),
                (None, Choose::Only) => Some(Command::ClearSelection),
                (None, _) => None,
            });
        }
        if response.secondary_clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            self.clicked = state.pick(self.side, pixel(at));
            if let Some(hit) = self.clicked
                && !state.selected.contains(hit.element)
            {
                commands.push(Command::Choose(Choose::Only, vec![hit.element]));
            }
        }
        response.context_menu(|ui| context_menu(ui, state, self.clicked, &mut commands));
        let factor = ZOOM_PER_NOTCH.powf(wheel_notches(ui).y);
        if let (Some(hover), true) = (response.hover_pos(), factor != 1.0) {
            let at = pixel(hover);
            let point = match state.pick(self.side, at) {
                Some(hit) => hit.point,
                None => state.camera.point_at_reach(at, state.picture),
            };
            let camera = state.camera.zoom(point, factor, state.far_limit());
            // A wheel that turns on is one move.
            let now = ui.input(|i| i.time);
            if now - self.zoomed > WHEEL_RESTS {
                commands.push(Command::LeaveView);
            }
            self.zoomed = now;
            commands.push(Command::MoveCamera(camera));
        }
        commands
    }

    /// Uploads what changed; reports what does not fit on the device.
    fn take_over(&mut self, state: &AppState) -> Option<Command> {
        let Shown { project, tree, .. } = state.on(self.side)?;
        let level_colors = state.level_colors && tree.is_some();
        let same_scene = self.scene.as_ref().is_some_and(|s| Arc::ptr_eq(s, &project.scene));
        let same_tree = match (&self.tree, tree) {
            (Some(uploaded), Some(tree)) => Arc::ptr_eq(uploaded, tree),
            // Without one the uploaded one is not drawn.
            (_, tree) => tree.is_none(),
        };
        let same_colors = level_colors == self.level_colors;
        if same_scene && same_tree && same_colors {
            return None;
        }
        let dates_only = same_colors && !level_colors && {
            let model = &project.scene.model;
            self.scene.as_ref().is_some_and(|s| Arc::ptr_eq(&s.model, model))
        };
        let taken = match tree {
            Some(tree) if dates_only => self.take_dates(&project.scene, tree, state),
            None if dates_only => self.renderer.set_dates(&project.scene),
            Some(tree) if level_colors => {
                let (scene, tree) = hdlod::color_by_level(&project.scene, tree);
                let taken = self.renderer.set_scene(&Arc::new(scene));
                taken.and_then(|()| self.renderer.set_hdlod(&Arc::new(tree)))
            }
            tree => self.renderer.set_scene(&project.scene).and_then(|()| match tree {
                Some(tree) => self.renderer.set_hdlod(tree),
                None => Ok(()),
            }),
        };
        self.scene = Some(Arc::clone(&project.scene));
        self.looks = None;
        let taken = taken.and_then(|()| self.renderer.set_looks(None));
        self.tree = tree.cloned();
        self.level_colors = level_colors;
        self.drawn = None;
        taken.err().map(|error| Command::Report(error.to_string()))
    }

    /// Gives elements the looks that are wanted now.
    fn take_looks(&mut self, state: &AppState) -> Option<Command> {
        let wanted = state.on(self.side)?.looks.filter(|_| !self.level_colors).cloned();
        if wanted.as_ref().map(Arc::as_ptr) == self.looks.as_ref().map(Arc::as_ptr) {
            return None;
        }
        let taken = self.renderer.set_looks(wanted.as_ref());
        self.looks = wanted;
        self.drawn = None;
        taken.err().map(|error| Command::Report(error.to_string()))
    }

    /// Other dates for the model that is uploaded, with their tree: of a tree that an edit made of the
    /// uploaded one only what moved.
    fn take_dates(
        &mut self,
        scene: &Arc<Scene>,
        tree: &Arc<Hdlod>,
        state: &AppState,
    ) -> Result<(), GpuError> {
        let change = state.tree_change.as_ref();
        match &self.tree {
            Some(uploaded) if Arc::ptr_eq(uploaded, tree) => self.renderer.update(scene, tree, &[]),
            Some(uploaded) => match change.and_then(|change| change.since(uploaded)) {
                Some(dirty) => self.renderer.update(scene, tree, dirty),
                None => self.renderer.set_dates(scene).and_then(|()| self.renderer.set_hdlod(tree)),
            },
            None => self.renderer.set_dates(scene).and_then(|()| self.renderer.set_hdlod(tree)),
        }
    }

    /// Takes over shaders that were changed while the window is open.
    #[cfg(debug_assertions)]
    fn reload_shaders(&mut self, ui: &Ui, state: &mut AppState) {
        const LOOK_EVERY: std::time::Duration = std::time::Duration::from_millis(300);
        ui.ctx().request_repaint_after(LOOK_EVERY);
        let (folder, looked) = &mut self.shaders;
        let Some((frame, _)) = self.drawn.filter(|_| looked.elapsed() >= LOOK_EVERY) else {
            return;
        };
        *looked = std::time::Instant::now();
        if !folder.has_changed() {
            return;
        }
        match self.renderer.reload_shaders(folder, &frame) {
            Ok(()) => {
                (state.news, state.error) =
                    (Some("The shaders were loaded again.".to_owned()), None);
            }
            Err(error) => {
                tracing::warn!("{error}");
                state.error = Some(error.to_string());
            }
        }
    }

    /// Renders if the picture would differ from the last one.
    fn draw(&mut self, state: &mut AppState, color: [u8; 3]) {
        let input = FrameInput {
            view: state.view(state.picture),
            time: state.time(),
            mode: state.mode_on(self.side),
        };
        let times = self.renderer.take_gpu_times();
        if self.side == Half::Shown {
            state.frames.add_gpu_times(&times);
        }
        let fade = if state.fade { FADE } else { Duration::ZERO };
        let options = Options { sun: state.sun, fade, ..self.renderer.options() };
        let elements = state.selected.elements();
        let same = self.drawn.as_ref().is_some_and(|(drawn, marked)| {
            *drawn == input && marked.0 == elements && marked.1 == color
        });
        if same && options == self.renderer.options() && !self.fading {
            return;
        }
        self.renderer.set_options(options);
        self.renderer.set_selection(elements, color);
        let marked = (elements.to_vec(), color);
        let stats = self.renderer.render(&input);
        if self.side == Half::Shown {
            state.frames.show(stats, self.renderer.has_timestamps());
        }
        self.fading = stats.fading > 0;
        self.drawn = Some((input, marked));
        let mut egui_renderer = self.window.renderer.write();
        let (view, filter) = (self.renderer.color_view(), wgpu::FilterMode::Nearest);
        match self.texture {
            None => {
                let id = egui_renderer.register_native_texture(&self.window.device, view, filter);
                self.texture = Some((id, state.picture));
            }
            Some((id, size)) if size != state.picture => {
                let device = &self.window.device;
                egui_renderer.update_egui_texture_from_wgpu_texture(device, view, filter, id);
                self.texture = Some((id, state.picture));
            }
            Some(_) => {}
        }
    }
}

/// The point that is meant by a click on something.
fn meant(state: &AppState, hit: &Hit, pixel: Vec2, reach: f32) -> Vec3 {
    measure::snapped(hit.corners, hit.point, &state.camera, pixel, state.picture, reach)
}

/// What can be done with the selection.
fn context_menu(ui: &mut Ui, state: &AppState, clicked: Option<Hit>, commands: &mut Vec<Command>) {
    if let Some(hit) = clicked {
        let button = ui.button("Section plane here");
        let tip = "Cut away what lies before this face";
        if button.on_hover_text(tip).clicked() {
            commands.push(Command::SectionAt(hit.point, hit.normal));
        }
    }
    let wanted = [
        Command::FitSelection,
        Command::DrawSelection(visibility::Shown::Hidden),
        Command::DrawSelection(visibility::Shown::Ghost),
        Command::Isolate(visibility::Shown::Hidden),
        Command::Isolate(visibility::Shown::Ghost),
        Command::SectionBox(true),
        Command::ShowAll,
        Command::ClearSelection,
    ];
    for action in actions().into_iter().filter(|action| wanted.contains(&action.command)) {
        let keys = action.shortcut.map(|s| s.text()).unwrap_or_default();
        let button = egui::Button::new(action.name).shortcut_text(keys);
        let enabled = super::chrome::is_enabled(state, &action.command);
        if ui.add_enabled(enabled, button).clicked() {
            commands.push(action.command);
        }
    }
    let (Some(project), Some(last)) = (&state.project, state.selected.last()) else { return };
    ui.separator();
    let (scene, element) = (&project.scene, &project.scene.model.elements[last.index()]);
    for (category, name) in [(Category::Storey, &element.storey), (Category::Type, &element.kind)] {
        if !name.is_empty() && ui.button(format!("Select all of {name}")).clicked() {
            let all = (0..scene.model.elements.len() as u32).map(ElementId);
            let alike = all.filter(|id| category.of(scene, *id) == name).collect();
            commands.push(Command::Choose(Choose::Only, alike));
        }
    }
}

/// How far wheel and pinching have turned since the last frame, in notches of a mouse wheel; y away from
/// the user asks to come nearer.
pub(super) fn wheel_notches(ui: &Ui) -> egui::Vec2 {
    ui.input(|input| {
        input.events.iter().fold(egui::Vec2::ZERO, |notches, event| match event {
            egui::Event::MouseWheel { unit, delta, .. } => {
                let scale = match unit {
                    egui::MouseWheelUnit::Line => 1.0,
                    egui::MouseWheelUnit::Point => 1.0 / POINTS_PER_NOTCH,
                    egui::MouseWheelUnit::Page => 5.0,
                };
                notches + *delta * scale
            }
            egui::Event::Zoom(zoom) if *zoom > 0.0 => {
                notches + egui::vec2(0.0, -zoom.ln() / ZOOM_PER_NOTCH.ln())
            }
            _ => notches,
        })
    })
}
