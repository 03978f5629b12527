//! The graph of the last frames' times.

use super::command::{Command, Panel};
use super::frames::{FrameLog, frame_ms};
use super::state::AppState;
use super::theme::{Palette, SMALL, palette};
use egui::{Align2, Color32, FontId, Pos2, Rect, RichText, Sense, Stroke, Ui, pos2, vec2};
use topout_render::{FrameStats, Pass};

/// Points from bar to bar; as many bars as frames are remembered.
const BAR: f32 = 3.0;
const HEIGHT: f32 = 110.0;
/// Room for the scale on the left, points.
const SCALE: f32 = 36.0;

/// The window with the graph.
pub fn show(ctx: &egui::Context, state: &AppState, place: Rect, commands: &mut Vec<Command>) {
    let mut open = state.panels.graph && state.project.is_some();
    if !open {
        return;
    }
    egui::Window::new("Frame times")
        .open(&mut open)
        .resizable(false)
        .collapsible(false)
        .pivot(Align2::RIGHT_BOTTOM)
        // Above the figures.
        .default_pos(place.right_bottom() - vec2(12.0, 92.0))
        .show(ctx, |ui| content(ui, &state.frames));
    if !open {
        commands.push(Command::Toggle(Panel::Graph));
    }
}

fn content(ui: &mut Ui, log: &FrameLog) {
    let (Some(median), Some(p95)) = (log.percentile(0.5), log.percentile(0.95)) else {
        ui.label("Frames are rendered only when something changes: move the camera or the date.");
        return;
    };
    let colors = palette(ui);
    let count = log.len();
    ui.horizontal(|ui| {
        // What a colour of the graph means.
        let mut figure = |color: Color32, text: String, tip: &str| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let (place, _) = ui.allocate_exact_size(vec2(8.0, 8.0), Sense::hover());
            ui.painter().rect_filled(place, 1.0, color);
            ui.label(RichText::new(text).size(SMALL)).on_hover_text(tip);
            ui.add_space(8.0);
        };
        figure(
            colors.text,
            format!("median {median:.1} ms"),
            &format!("Half of the last {count} rendered frames took no longer."),
        );
        figure(
            colors.warning,
            format!("95 % {p95:.1} ms"),
            &format!("95 of 100 of the last {count} rendered frames took no longer."),
        );
        figure(colors.bars, "CPU".to_owned(), "Choosing what to draw and writing commands.");
        figure(
            colors.accent,
            "GPU".to_owned(),
            "Drawing, by the adapter's own clock. The two are added as if nothing overlapped; \
             adapters without a clock show the CPU alone.",
        );
    });
    let size = vec2(SCALE + BAR * FrameLog::REMEMBERED as f32, HEIGHT);
    let (response, painter) = ui.allocate_painter(size, Sense::hover());
    let name = format!("Frame times: median {median:.1} ms, 95th percentile {p95:.1} ms");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &name));
    let plot = Plot::new(response.rect, log);
    plot.paint(&painter, colors, log, median, p95);
    let hovered = response.hover_pos().and_then(|at| plot.frame_at(at));
    if let Some((index, stats)) = hovered.and_then(|i| Some((i, log.timed().nth(i)?))) {
        painter.rect_filled(plot.slot(index), 0.0, colors.text.gamma_multiply(0.15));
        let back = count - 1 - index;
        let title = match back {
            0 => "Last frame".to_owned(),
            1 => "The frame before".to_owned(),
            _ => format!("{back} frames before the last"),
        };
        response.on_hover_ui(|ui| breakdown(ui, &title, stats, log));
    }
    if let Some(last) = log.timed().last() {
        let text = format!(
            "last {:.1} ms; frames are rendered only when something changes",
            frame_ms(last)
        );
        let text = RichText::new(text).size(SMALL).color(colors.weak);
        ui.label(text).on_hover_ui(|ui| breakdown(ui, "Last frame", last, log));
    }
}

/// Where the frames stand.
struct Plot {
    rect: Rect,
    count: usize,
    /// Milliseconds at the top: a round number.
    top_ms: f64,
}

impl Plot {
    fn new(whole: Rect, log: &FrameLog) -> Self {
        let rect = whole.with_min_x(whole.min.x + SCALE).shrink2(vec2(0.0, 6.0));
        let longest = log.percentile(1.0).unwrap_or(0.0);
        Self { rect, count: log.len(), top_ms: round_up(longest) }
    }

    fn y(&self, ms: f64) -> f32 {
        egui::remap(ms as f32, 0.0..=self.top_ms as f32, self.rect.bottom()..=self.rect.top())
    }

    /// Where a frame stands; the last one on the right.
    fn slot(&self, index: usize) -> Rect {
        let right = self.rect.right() - (self.count - 1 - index) as f32 * BAR;
        Rect::from_min_max(pos2(right - BAR, self.rect.top()), pos2(right, self.rect.bottom()))
    }

    /// The frame under a point.
    fn frame_at(&self, at: Pos2) -> Option<usize> {
        let back = ((self.rect.right() - at.x) / BAR).floor();
        let inside = back >= 0.0 && at.x >= self.rect.left();
        if inside { self.count.checked_sub(1 + back as usize) } else { None }
    }

    fn paint(
        &self,
        painter: &egui::Painter,
        colors: &Palette,
        log: &FrameLog,
        median: f64,
        p95: f64,
    ) {
        painter.rect_filled(self.rect, 0.0, colors.well);
        let font = FontId::proportional(SMALL);
        for share in [0.0, 0.5, 1.0] {
            let ms = self.top_ms * share;
            let y = self.y(ms);
            painter.hline(self.rect.x_range(), y, Stroke::new(1.0, colors.line));
            let decimals = if self.top_ms < 1.0 { 2 } else { usize::from(self.top_ms < 10.0) };
            let (at, text) = (pos2(self.rect.left() - 4.0, y), format!("{ms:.decimals$}"));
            painter.text(at, Align2::RIGHT_CENTER, text, font.clone(), colors.weak);
        }
        for (index, stats) in log.timed().enumerate() {
            let slot = self.slot(index).shrink2(vec2(0.5, 0.0));
            let cpu = self.y(stats.select_ms + stats.cpu_ms);
            painter.rect_filled(slot.with_min_y(cpu), 0.0, colors.bars);
            painter.rect_filled(
                slot.with_min_y(self.y(frame_ms(stats))).with_max_y(cpu),
                0.0,
                colors.accent,
            );
        }
        for (ms, color) in [(median, colors.text), (p95, colors.warning)] {
            painter.hline(self.rect.x_range(), self.y(ms), Stroke::new(1.0, color));
        }
    }
}

/// The next of 1, 2, 4, 6, 8, 10, 20, 40 and so on.
fn round_up(ms: f64) -> f64 {
    let ms = ms.clamp(0.1, 1e6);
    let power = 10f64.powf(ms.log10().floor());
    [1.0, 2.0, 4.0, 6.0, 8.0, 10.0]
        .map(|step| step * power)
        .into_iter()
        .find(|top| *top >= ms)
        .unwrap_or(ms)
}

/// What the parts of a frame took, beside the medians of all that are remembered.
fn breakdown(ui: &mut Ui, title: &str, stats: &FrameStats, log: &FrameLog) {
    let (weak, medians) = (palette(ui).weak, log.medians());
    ui.label(RichText::new(format!("{title}: {:.2} ms", frame_ms(stats))).strong());
    ui.set_max_width(640.0);
    // The rows hold no buttons.
    ui.spacing_mut().interact_size.y = 0.0;
    egui::Grid::new("breakdown").num_columns(6).spacing([12.0, 2.0]).show(ui, |ui| {
        for head in ["ms", "CPU", "GPU", "median CPU", "median GPU", ""] {
            ui.label(RichText::new(head).size(SMALL).color(weak));
        }
        ui.end_row();
        for (pass, name, about) in Pass::ALL {
            let (here, typical) = (stats.passes[pass], medians[pass]);
            let sides = [here.cpu_ms, here.gpu_ms, typical.cpu_ms, typical.gpu_ms];
            if sides.iter().all(Option::is_none) {
                continue;
            }
            ui.label(RichText::new(name).size(SMALL));
            for side in sides {
                let text = side.map_or_else(|| "–".to_owned(), |ms| format!("{ms:.2}"));
                ui.label(RichText::new(text).size(SMALL));
            }
            ui.label(RichText::new(about).size(SMALL).color(weak));
            ui.end_row();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_ends_at_a_round_number() {
        for (longest, top) in
            [(0.0, 0.1), (0.7, 0.8), (1.0, 1.0), (3.1, 4.0), (41.0, 60.0), (160.0, 200.0)]
        {
            assert!((round_up(longest) - top).abs() < 1e-9, "{longest}: {}", round_up(longest));
        }
    }

    /// Whatever the number of frames, a point within a frame's bar means that frame.
    #[test]
    fn a_point_means_the_frame_that_stands_there() {
        let rect = Rect::from_min_size(pos2(10.0, 20.0), vec2(360.0, 100.0));
        for count in [1, 7, 120] {
            let plot = Plot { rect, count, top_ms: 10.0 };
            for index in 0..count {
                assert_eq!(plot.frame_at(plot.slot(index).center()), Some(index));
            }
            assert_eq!(plot.frame_at(pos2(rect.right() + 1.0, 50.0)), None);
            assert_eq!(plot.frame_at(pos2(rect.left() - 1.0, 50.0)), None);
        }
        let few = Plot { rect, count: 2, top_ms: 10.0 };
        assert_eq!(few.frame_at(rect.center()), None, "nothing stands there yet");
    }
}
