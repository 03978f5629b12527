//! The bars of the Gantt chart, and dragging them.

use super::super::calendar::{DAY, short_date};
use super::super::command::Command;
use super::super::state::AppState;
use super::super::theme::{Palette, SMALL, palette};
use super::super::timeline::axis::{self, Axis};
use egui::{Color32, CursorIcon, Rect, Sense, Shape, Stroke, Ui};
use topout_schedule::{Activity, DateSet, Time, TimeRange};

/// So near to its end, in points, a bar is made longer or shorter instead of being moved.
const GRIP: f32 = 5.0;

/// One row's part of the chart.
pub struct Bars {
    axis: Axis,
    place: Rect,
    colors: &'static Palette,
}

/// A bar that is being dragged.
#[derive(Clone, Copy)]
struct Drag {
    activity: usize,
    /// Its end alone.
    end_only: bool,
    /// So far, in points.
    moved: f32,
}

impl Bars {
    /// Takes what is left of a cell; draws what goes through all rows.
    pub fn begin(ui: &mut Ui, state: &AppState) -> Self {
        let place = ui.max_rect();
        let axis = Axis { place, scale: state.scale };
        let colors = palette(ui);
        // Lines go through the gaps between rows.
        let painter = ui.painter().with_clip_rect(ui.clip_rect().intersect(place.expand(4.0)));
        axis::days_off(&painter, place, axis, state, colors);
        let data_date = state.project.as_ref().and_then(|p| p.scene.schedule.data_date);
        let lines = [
            (data_date, Stroke::new(1.0, colors.data_date)),
            (Some(state.time()), Stroke::new(1.0, colors.cursor)),
        ];
        for (time, stroke) in lines.into_iter().filter_map(|(t, s)| Some((t?, s))) {
            let x = axis.x(time);
            if place.x_range().contains(x) {
                painter.vline(x, place.y_range().expand(4.0), stroke);
            }
        }
        Self { axis, place, colors }
    }

    /// Ctrl and the wheel zoom about the pointer.
    pub fn wheel(&self, ui: &Ui, state: &AppState, commands: &mut Vec<Command>) {
        let over = ui.input(|i| {
            i.pointer.hover_pos().filter(|at| self.place.contains(*at) && i.modifiers.command)
        });
        if let Some(at) = over {
            axis::wheel(ui, self.axis, at.x, state.period(), commands);
        }
    }

    fn bar(&self, span: TimeRange, top: f32, bottom: f32) -> Rect {
        let (from, to) = (self.axis.x(span.start), self.axis.x(span.end));
        let y = self.place.min.y;
        Rect::from_x_y_ranges(from..=to.max(from + 2.0), y + top..=y + bottom)
    }

    /// A bracket over what is below.
    pub fn summary(&self, ui: &Ui, span: TimeRange) {
        let painter = ui.painter_at(self.place);
        let bar = self.bar(span, 7.0, 11.0);
        painter.rect_filled(bar, 0.0, self.colors.text);
        for (x, way) in [(bar.min.x, 1.0), (bar.max.x, -1.0)] {
            let corners = [(0.0, 0.0), (5.0 * way, 0.0), (0.0, 7.0)];
            let corners = corners.map(|(dx, dy)| egui::pos2(x + dx, bar.min.y + dy)).to_vec();
            painter.add(Shape::convex_polygon(corners, self.colors.text, Stroke::NONE));
        }
    }

    /// Its bar with what is done, its baseline below, or its diamond; dragging moves it.
    pub fn activity(
        &self,
        ui: &mut Ui,
        index: usize,
        activity: &Activity,
        color: Color32,
        critical: bool,
        commands: &mut Vec<Command>,
    ) {
        let painter = ui.painter_at(self.place);
        let baseline = activity.date_sets[DateSet::Baseline];
        if let (Some(start), Some(end)) = (baseline.start, baseline.end) {
            let bar = self.bar(TimeRange { start, end }, 15.0, 18.0);
            painter.rect_filled(bar, 1.0, self.colors.weak.gamma_multiply(0.7));
        }
        let Some(span) = activity.dates() else { return };
        let bar = self.bar(span, 4.0, 14.0);
        if bar.max.x < self.place.min.x || self.place.max.x < bar.min.x {
            self.beyond(ui, bar);
            return;
        }
        let shown = bar.intersect(self.place);
        let grip = Rect::from_center_size(shown.center(), shown.size().max(egui::vec2(8.0, 12.0)));
        let response = ui
            .interact(grip, ui.scope_id().with(("bar", index)), Sense::click_and_drag())
            .accessible_name(format!("Bar of {}", activity.id));
        let drag = self.drag(ui, &response, index, activity, bar, commands);
        let span = match drag {
            Some(drag) => self.dragged(span, drag),
            None => span,
        };
        if drag.is_some() {
            painter.rect_stroke(bar, 2.0, Stroke::new(1.0, color), egui::StrokeKind::Inside);
        }
        let bar = self.bar(span, 4.0, 14.0);
        match activity.milestone || span.start == span.end {
            true => {
                let middle = egui::pos2(bar.min.x, bar.center().y);
                let corners = [(0.0, -6.0), (6.0, 0.0), (0.0, 6.0), (-6.0, 0.0)];
                let corners = corners.map(|(x, y)| middle + egui::vec2(x, y)).to_vec();
                painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
            }
            false => {
                painter.rect_filled(bar, 2.0, color.gamma_multiply(0.55));
                let done = activity.percent_complete.unwrap_or(0.0).clamp(0.0, 100.0) / 100.0;
                let width = bar.width() * done;
                let part = Rect::from_min_size(bar.min, egui::vec2(width, bar.height()));
                painter.rect_filled(part, 2.0, color);
                if critical {
                    let stroke = Stroke::new(1.5, self.colors.error);
                    painter.hline(bar.x_range(), bar.max.y, stroke);
                }
            }
        }
        if drag.is_some() {
            let text = format!("{} – {}", short_date(span.start), short_date(span.end));
            let font = egui::FontId::proportional(SMALL);
            let at = bar.right_center() + egui::vec2(8.0, 0.0);
            painter.text(at, egui::Align2::LEFT_CENTER, text, font, self.colors.strong);
        }
    }

    /// A small sign where a bar lies beyond the chart.
    fn beyond(&self, ui: &Ui, bar: Rect) {
        let (x, way) = match bar.max.x < self.place.min.x {
            true => (self.place.min.x + 8.0, -1.0),
            false => (self.place.max.x - 8.0, 1.0),
        };
        let middle = egui::pos2(x, self.place.center().y);
        let corners = [(-2.0, -3.0), (3.0, 0.0), (-2.0, 3.0)];
        let corners = corners.map(|(dx, dy)| middle + egui::vec2(dx * way, dy)).to_vec();
        let painter = ui.painter_at(self.place);
        painter.add(Shape::convex_polygon(corners, self.colors.weak, Stroke::NONE));
    }

    /// What of dragging goes on; letting go asks for the new dates, Escape for nothing.
    fn drag(
        &self,
        ui: &Ui,
        response: &egui::Response,
        index: usize,
        activity: &Activity,
        bar: Rect,
        commands: &mut Vec<Command>,
    ) -> Option<Drag> {
        let key = egui::Id::unique("dragged bar");
        let known: Option<Drag> = ui.data(|data| data.get_temp(key));
        let mut drag = known.filter(|drag| drag.activity == index);
        let near_end = |x: f32| !activity.milestone && (bar.max.x - x).abs() <= GRIP;
        if let Some(at) = response.hover_pos().filter(|_| drag.is_none()) {
            ui.ctx().set_cursor_icon(match near_end(at.x) && bar.width() > 3.0 * GRIP {
                true => CursorIcon::ResizeHorizontal,
                false => CursorIcon::Grab,
            });
        }
        if response.drag_started() {
            let from = ui.input(|i| i.pointer.press_origin()).map_or(bar.min.x, |at| at.x);
            let end_only = near_end(from) && bar.width() > 3.0 * GRIP;
            drag = Some(Drag { activity: index, end_only, moved: 0.0 });
        }
        if let Some(drag) = &mut drag {
            drag.moved += response.drag_delta().x;
            if ui.input(|i| i.key_pressed(egui::Key::Escape)) {
                ui.data_mut(|data| data.remove::<Drag>(key));
                return None;
            }
            match response.drag_stopped() {
                true => {
                    ui.data_mut(|data| data.remove::<Drag>(key));
                    if let Some(span) = activity.dates() {
                        let to = self.dragged(span, *drag);
                        if to != span {
                            commands.push(Command::MoveActivity(index, to));
                        }
                    }
                }
                false => {
                    ui.data_mut(|data| data.insert_temp(key, *drag));
                }
            }
        } else if response.clicked() {
            commands.push(Command::SelectActivity(index));
        }
        drag
    }

    /// By whole days, and no end before the start.
    fn dragged(&self, span: TimeRange, drag: Drag) -> TimeRange {
        let days = (self.axis.seconds(drag.moved) / DAY as f64).round() as i64;
        let moved = |time: Time| time.plus_seconds(days * DAY);
        match drag.end_only {
            true => TimeRange { end: moved(span.end).max(span.start), ..span },
            false => TimeRange { start: moved(span.start), end: moved(span.end) },
        }
    }
}
