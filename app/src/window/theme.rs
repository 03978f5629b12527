//! Colours, type and spacing: a 4 px grid, one family in three sizes, one accent.

use egui::{
    Color32, Context, CornerRadius, FontId, Margin, Shadow, Stroke, Style, TextStyle, Theme,
};
use topout_schedule::Kind;

/// Which of the two looks is shown.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Serialize, serde::Deserialize)]
pub enum Scheme {
    /// As the system says.
    #[default]
    System,
    /// Dark.
    Dark,
    /// Light.
    Light,
}

/// Text of the head line of a panel.
pub const TITLE: f32 = 15.0;
/// Everything else.
pub const BODY: f32 = 13.0;
/// Axis labels and remarks.
pub const SMALL: f32 = 11.0;

/// Colours beyond those that egui's own widgets use.
pub struct Palette {
    /// Selection, active buttons, links.
    pub accent: Color32,
    /// Where in time the picture is.
    pub cursor: Color32,
    /// Up to where in time actual dates are known.
    pub data_date: Color32,
    /// Behind the panels.
    pub panel: Color32,
    /// Behind the 3D view while nothing is loaded, and behind strips.
    pub well: Color32,
    /// Ordinary text.
    pub text: Color32,
    /// Text that stands out, and pressed buttons.
    pub strong: Color32,
    /// Secondary text.
    pub weak: Color32,
    /// Lines between panels.
    pub line: Color32,
    /// Bars of the density strip.
    pub bars: Color32,
    /// What is wrong.
    pub error: Color32,
    /// What needs a look.
    pub warning: Color32,
}

const DARK: Palette = Palette {
    accent: Color32::from_rgb(0x5B, 0x9D, 0xFF),
    cursor: Color32::from_rgb(0xFF, 0x5A, 0x52),
    data_date: Color32::from_rgb(0x38, 0xBD, 0xF8),
    panel: Color32::from_rgb(0x1F, 0x22, 0x27),
    well: Color32::from_rgb(0x16, 0x18, 0x1C),
    text: Color32::from_rgb(0xC9, 0xCE, 0xD6),
    strong: Color32::from_rgb(0xFF, 0xFF, 0xFF),
    weak: Color32::from_rgb(0x93, 0x9B, 0xA6),
    line: Color32::from_rgb(0x34, 0x39, 0x41),
    bars: Color32::from_rgb(0x4A, 0x55, 0x66),
    error: Color32::from_rgb(0xFF, 0x6B, 0x61),
    warning: Color32::from_rgb(0xE9, 0xAE, 0x3D),
};

const LIGHT: Palette = Palette {
    accent: Color32::from_rgb(0x1F, 0x66, 0xD6),
    cursor: Color32::from_rgb(0xD9, 0x2D, 0x25),
    data_date: Color32::from_rgb(0x02, 0x84, 0xC7),
    panel: Color32::from_rgb(0xF7, 0xF7, 0xF5),
    well: Color32::from_rgb(0xE9, 0xEA, 0xEA),
    text: Color32::from_rgb(0x34, 0x39, 0x40),
    strong: Color32::from_rgb(0x0B, 0x0D, 0x10),
    weak: Color32::from_rgb(0x62, 0x6A, 0x74),
    line: Color32::from_rgb(0xD3, 0xD6, 0xD9),
    bars: Color32::from_rgb(0xAE, 0xB8, 0xC4),
    error: Color32::from_rgb(0xC0, 0x27, 0x1E),
    warning: Color32::from_rgb(0x9A, 0x67, 0x00),
};

/// The colours of the look that `ui` is drawn in.
pub fn palette(ui: &egui::Ui) -> &'static Palette {
    if ui.visuals().dark_mode { &DARK } else { &LIGHT }
}

/// The colour of a kind of activities: that of elements while one lasts, blue where they keep their own.
pub fn kind_color(kind: &Kind, dark: bool) -> Color32 {
    let own = if dark { [0x6F, 0xA3, 0xDC] } else { [0x3E, 0x76, 0xB3] };
    let phases = [kind.during, kind.after, kind.before];
    let [r, g, b] = phases.into_iter().find_map(|p| p.look().color).unwrap_or(own);
    Color32::from_rgb(r, g, b)
}

/// A triangle that points to the right where something is folded, and down where it is not.
pub fn fold_sign(ui: &egui::Ui, response: &egui::Response, at: egui::Pos2, folded: bool) {
    let corners = match folded {
        true => [(-3.0, -4.0), (4.0, 0.0), (-3.0, 4.0)],
        false => [(-4.0, -3.0), (4.0, -3.0), (0.0, 4.0)],
    };
    let corners = corners.map(|(x, y)| at + egui::vec2(x, y)).to_vec();
    let color = ui.style().interact(response).fg_stroke.color;
    ui.painter().add(egui::Shape::convex_polygon(corners, color, Stroke::NONE));
}

/// Sets both looks; call once.
pub fn install(ctx: &Context) {
    for (theme, palette) in [(Theme::Dark, &DARK), (Theme::Light, &LIGHT)] {
        ctx.style_mut_of(theme, |style| shape(style, palette));
    }
}

/// Chooses between the looks.
pub fn choose(ctx: &Context, scheme: Scheme) {
    ctx.set_theme(match scheme {
        Scheme::System => egui::ThemePreference::System,
        Scheme::Dark => egui::ThemePreference::Dark,
        Scheme::Light => egui::ThemePreference::Light,
    });
}

fn shape(style: &mut Style, palette: &Palette) {
    for (text, size) in [
        (TextStyle::Heading, TITLE),
        (TextStyle::Body, BODY),
        (TextStyle::Button, BODY),
        (TextStyle::Small, SMALL),
    ] {
        style.text_styles.insert(text, FontId::proportional(size));
    }
    style.text_styles.insert(TextStyle::Monospace, FontId::monospace(SMALL + 1.0));
    style.animation_time = 0.0; // A software adapter should not redraw the window for a fade.

    let spacing = &mut style.spacing;
    spacing.item_spacing = egui::vec2(8.0, 4.0);
    spacing.button_padding = egui::vec2(8.0, 4.0);
    spacing.interact_size = egui::vec2(24.0, 24.0);
    spacing.window_margin = Margin::same(12);
    spacing.menu_margin = Margin::same(4);
    spacing.icon_width = 16.0;
    spacing.tooltip_width = 360.0;
    style.interaction.selectable_labels = false;

    let visuals = &mut style.visuals;
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.panel;
    visuals.extreme_bg_color = palette.well;
    visuals.faint_bg_color = palette.well;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    visuals.window_shadow = Shadow {
        offset: [0, 4],
        blur: 16,
        spread: 0,
        color: Color32::from_black_alpha(if visuals.dark_mode { 96 } else { 40 }),
    };
    visuals.popup_shadow = visuals.window_shadow;
    visuals.hyperlink_color = palette.accent;
    visuals.error_fg_color = palette.error;
    visuals.warn_fg_color = palette.warning;
    visuals.weak_text_color = Some(palette.weak);
    visuals.selection.bg_fill = palette.accent.gamma_multiply(0.32);
    visuals.selection.stroke = Stroke::new(1.0, palette.strong);
    visuals.slider_trailing_fill = true;

    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, palette.line);
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, palette.text);
    for (state, share) in [
        (&mut widgets.inactive, 0.05),
        (&mut widgets.hovered, 0.12),
        (&mut widgets.active, 0.20),
        (&mut widgets.open, 0.12),
    ] {
        let fill = palette.panel.lerp_to_gamma(palette.text, share);
        (state.bg_fill, state.weak_bg_fill) = (fill, fill);
        state.bg_stroke = Stroke::NONE;
        state.fg_stroke = Stroke::new(1.2, palette.text);
        state.corner_radius = CornerRadius::same(4);
        state.expansion = 0.0;
    }
    // egui takes the colour of emphasised text from here.
    widgets.active.fg_stroke.color = palette.strong;
    widgets.noninteractive.corner_radius = CornerRadius::same(4);
}
