//! The view cube: shows which way one looks, and turns the view to the side that is clicked.

use super::command::Command;
use super::state::AppState;
use super::theme::{SMALL, palette};
use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Shape, Stroke, Ui};
use glam::Vec3;
use topout_scene::NamedView;

/// Width and height of the cube's place, points.
const SIZE: f32 = 84.0;
/// Half of an edge, points.
const HALF: f32 = 23.0;

/// A side: where it lies, two directions along it, its name, and the view onto it.
struct Side {
    normal: Vec3,
    along: [Vec3; 2],
    name: &'static str,
    command: Command,
}

fn sides() -> [Side; 6] {
    let side = |normal, u, v, name, command| Side { normal, along: [u, v], name, command };
    let named = Command::LookFrom;
    [
        side(Vec3::Z, Vec3::X, Vec3::Y, "Front", named(NamedView::Front)),
        side(Vec3::NEG_Z, Vec3::X, Vec3::Y, "Back", named(NamedView::Back)),
        side(Vec3::NEG_X, Vec3::Z, Vec3::Y, "Left", named(NamedView::Left)),
        side(Vec3::X, Vec3::Z, Vec3::Y, "Right", named(NamedView::Right)),
        side(Vec3::Y, Vec3::X, Vec3::Z, "Top", named(NamedView::Top)),
        side(Vec3::NEG_Y, Vec3::X, Vec3::Z, "Below", Command::LookAlong(0, -90)),
    ]
}

/// Draws the cube and collects what is asked for.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (place, response) = ui.allocate_exact_size(egui::vec2(SIZE, SIZE), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, "View cube"));
    let [right, up, toward] = state.camera.axes();
    let at = |p: Vec3| place.center() + egui::vec2(p.dot(right), -p.dot(up)) * HALF;
    let pointer = response.hover_pos().filter(|_| !response.dragged());
    let colors = palette(ui);
    let painter = ui.painter();
    let mut seen: Vec<Side> =
        sides().into_iter().filter(|side| side.normal.dot(toward) > 0.02).collect();
    seen.sort_by(|a, b| a.normal.dot(toward).total_cmp(&b.normal.dot(toward)));
    let mut over = None;
    for side in seen {
        let [u, v] = side.along;
        let corners = [-u - v, u - v, u + v, v - u].map(|offset| at(side.normal + offset));
        let hovered = pointer.is_some_and(|p| is_in(p, &corners));
        let facing = side.normal.dot(toward);
        let fill = match hovered {
            true => colors.accent,
            false => colors.panel.lerp_to_gamma(colors.text, 0.06 + 0.14 * facing),
        };
        let stroke = Stroke::new(1.0, colors.line);
        painter.add(Shape::convex_polygon(corners.to_vec(), fill.gamma_multiply(0.94), stroke));
        if facing > 0.55 {
            let color = if hovered { Color32::WHITE } else { colors.text };
            let font = FontId::proportional(SMALL);
            painter.text(at(side.normal), Align2::CENTER_CENTER, side.name, font, color);
        }
        if hovered {
            over = Some(side.command);
        }
    }
    if response.dragged()
        && let Some(project) = &state.project
    {
        let moved = response.drag_delta() * (std::f32::consts::PI / SIZE);
        if response.drag_started() {
            commands.push(Command::LeaveView);
        }
        let center = project.focus.center();
        commands.push(Command::MoveCamera(state.camera.orbit(center, -moved.x, moved.y)));
    } else if response.clicked() {
        commands.extend(over);
    }
    response.on_hover_text("Click a side to look at it, drag to turn");
}

/// Whether a point lies in a convex polygon, whichever way that goes round.
fn is_in(point: Pos2, corners: &[Pos2; 4]) -> bool {
    let turns = (0..4).map(|i| {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        (b.x - a.x) * (point.y - a.y) - (b.y - a.y) * (point.x - a.x)
    });
    let (low, high) = turns.fold((f32::MAX, f32::MIN), |(l, h), t| (l.min(t), h.max(t)));
    (low >= 0.0 || high <= 0.0) && Rect::from_points(corners).contains(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_in_and_beside_a_side() {
        let corners =
            [(0.0, 0.0), (4.0, 1.0), (5.0, 5.0), (1.0, 4.0)].map(|(x, y)| Pos2::new(x, y));
        let turned = [corners[3], corners[2], corners[1], corners[0]];
        for corners in [corners, turned] {
            assert!(is_in(Pos2::new(2.0, 2.0), &corners));
            assert!(!is_in(Pos2::new(4.5, 1.0), &corners));
            assert!(!is_in(Pos2::new(-1.0, -1.0), &corners));
        }
    }
}
