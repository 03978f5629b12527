//! Lines between bars: what waits for what.

use super::super::loading::Project;
use super::super::state::AppState;
use super::super::theme::palette;
use super::super::timeline::axis::Axis;
use egui::{Pos2, Rect, Shape, Stroke, Ui};
use topout_schedule::LinkKind;

/// Most lines in a frame.
const MOST: usize = 600;
/// How far lines stand off bars, points.
const OFF: f32 = 6.0;

/// The rows that were laid out in a frame.
#[derive(Default)]
pub struct Seen {
    /// Place among the listed rows, the activity where it is one, and its part of the chart.
    rows: Vec<(usize, Option<usize>, Rect)>,
    /// Of them what is in sight.
    clip: Option<Rect>,
}

impl Seen {
    /// A row was laid out.
    pub fn add(&mut self, ui: &Ui, row: usize, activity: Option<usize>, place: Rect) {
        let clip = ui.clip_rect().intersect(place);
        self.clip = Some(self.clip.map_or(clip, |all| all.union(clip)));
        self.rows.push((row, activity, place));
    }

    /// Draws the lines that begin or end at one of these rows; those of what is selected on top.
    pub fn paint(&self, ui: &Ui, state: &AppState, project: &Project) {
        let (Some(clip), Some(&(first, _, top))) = (self.clip, self.rows.first()) else { return };
        let axis = Axis {
            place: Rect::from_x_y_ranges(top.x_range(), clip.y_range()),
            scale: state.scale,
        };
        let y = |row: usize| top.center().y + (row as f32 - first as f32) * super::ROW;
        let listed = |activity: usize| {
            let row = project.plan.row_of(activity)? as u32;
            state.gantt.rows().binary_search(&row).ok()
        };
        let colors = palette(ui);
        let painter = ui.painter().with_clip_rect(clip);
        let chosen = chosen(state, project);
        let mut marked = Vec::new();
        let mut lines = 0;
        let mut line = |from: usize, kind: LinkKind, to: usize| {
            let (Some(row_from), Some(row_to)) = (listed(from), listed(to)) else { return };
            let (Some(a), Some(b)) = (project.plan.span(from), project.plan.span(to)) else {
                return;
            };
            let (at_end, to_end) = match kind {
                LinkKind::FinishStart => (true, false),
                LinkKind::StartStart => (false, false),
                LinkKind::FinishFinish => (true, true),
                LinkKind::StartFinish => (false, true),
            };
            let x = |at_end: bool, span: topout_schedule::TimeRange| {
                axis.x(if at_end { span.end } else { span.start })
            };
            let from_at = Pos2::new(x(at_end, a), y(row_from));
            let to_at = Pos2::new(x(to_end, b), y(row_to));
            let shape = path(from_at, at_end, to_at, to_end);
            if !shape
                .iter()
                .fold(Rect::NOTHING, |r, p| r.union(Rect::from_pos(*p)))
                .intersects(clip)
            {
                return;
            }
            if chosen.contains(&from) || chosen.contains(&to) {
                marked.push((shape, to_end));
            } else if lines < MOST {
                lines += 1;
                arrow(&painter, &shape, to_end, Stroke::new(1.0, colors.weak.gamma_multiply(0.55)));
            }
        };
        let in_sight = |activity: usize| self.rows.iter().any(|row| row.1 == Some(activity));
        for activity in self.rows.iter().filter_map(|row| row.1) {
            for link in project.scene.schedule.activities[activity].predecessors.iter().take(MOST) {
                line(link.activity as usize, link.kind, activity);
            }
            for (next, kind) in project.network.successors(activity).take(MOST) {
                // The others come with the rows that they lead to.
                if !in_sight(next) {
                    line(activity, kind, next);
                }
            }
        }
        for (shape, to_end) in marked.into_iter().take(MOST) {
            arrow(&painter, &shape, to_end, Stroke::new(1.5, colors.accent));
        }
    }
}

/// The activities whose lines are marked.
fn chosen(state: &AppState, project: &Project) -> Vec<usize> {
    match (state.selected.activity(), state.selected.only()) {
        (Some(activity), _) => vec![activity],
        (None, Some(element)) => {
            project.scene.activities_of(element).iter().map(|a| *a as usize).collect()
        }
        (None, None) => Vec::new(),
    }
}

/// From bar to bar, level and upright: out of one end, along, and into the other.
fn path(from: Pos2, out_of_end: bool, to: Pos2, into_end: bool) -> Vec<Pos2> {
    let out = from.x + if out_of_end { OFF } else { -OFF };
    let before = to.x + if into_end { OFF } else { -OFF };
    let straight = match (out_of_end, into_end) {
        (true, false) => before >= out,
        // Both on one side: around whichever sticks out.
        (true, true) => return corner(from, out.max(before), to),
        (false, false) => return corner(from, out.min(before), to),
        (false, true) => before <= out,
    };
    if straight {
        return corner(from, out, to);
    }
    let half = super::ROW * 0.5 * if to.y >= from.y { -1.0 } else { 1.0 };
    let level = to.y + half;
    let at = Pos2::new;
    vec![from, at(out, from.y), at(out, level), at(before, level), at(before, to.y), to]
}

fn corner(from: Pos2, x: f32, to: Pos2) -> Vec<Pos2> {
    vec![from, Pos2::new(x, from.y), Pos2::new(x, to.y), to]
}

fn arrow(painter: &egui::Painter, path: &[Pos2], into_end: bool, stroke: Stroke) {
    painter.add(Shape::line(path.to_vec(), stroke));
    if let Some(tip) = path.last() {
        let back = if into_end { 4.0 } else { -4.0 };
        let corners = vec![*tip, *tip + egui::vec2(back, -3.0), *tip + egui::vec2(back, 3.0)];
        painter.add(Shape::convex_polygon(corners, stroke.color, Stroke::NONE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines leave a bar outward, come in outward, and go level or upright in between.
    #[test]
    fn lines_go_around_bars() {
        for (out_of_end, into_end) in [(true, false), (false, false), (true, true), (false, true)] {
            for x in [-80.0, -3.0, 0.0, 3.0, 80.0] {
                for y in [-66.0, 22.0, 66.0] {
                    let (from, to) = (Pos2::new(100.0, 100.0), Pos2::new(100.0 + x, 100.0 + y));
                    let path = path(from, out_of_end, to, into_end);
                    assert_eq!((path[0], path[path.len() - 1]), (from, to));
                    for pair in path.windows(2) {
                        assert!(pair[0].x == pair[1].x || pair[0].y == pair[1].y, "{path:?}");
                    }
                    let [second, last] = [path[1], path[path.len() - 2]];
                    assert_eq!(second.x > from.x, out_of_end, "{path:?}");
                    assert_eq!(last.x > to.x, into_end, "{path:?}");
                }
            }
        }
    }
}
