//! A caption on a picture: the date, where the project stands, and what colours mean.

use egui::epaint::text::{FontDefinitions, Fonts, TextOptions};
use egui::{Color32, FontId};
use topout_render::Picture;
use topout_scene::{Looks, Scene, slip_color};
use topout_schedule::{Kinds, SlipClass, Time};

/// What a colour means.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LegendEntry {
    /// The words.
    pub name: String,
    /// sRGB.
    pub color: [u8; 3],
    /// How many there are, where that is known.
    pub count: Option<usize>,
}

/// What stands on a picture.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Caption {
    /// The first line, larger than the others.
    pub title: String,
    /// What stands below it.
    pub line: String,
    /// What colours mean, one line each.
    pub legend: Vec<LegendEntry>,
}

/// Whose colours a legend explains.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Colored {
    /// Elements have their own colours: there is nothing to explain.
    Own,
    /// Those of kinds of activities.
    Activity,
    /// Those of slip.
    Slip,
    /// Those of what starts within so many weeks.
    Ahead(u32),
}

impl Caption {
    /// The date with its weekday, the week of the project, and how many activities are at work at a time.
    pub fn at(scene: &Scene, time: Time, colored: Colored) -> Self {
        let schedule = &scene.schedule;
        let at_work = schedule
            .activities
            .iter()
            .filter(|a| a.active && a.dates().is_some_and(|range| range.contains(time)));
        let mut of_kind = vec![0; schedule.kinds.iter().count()];
        let mut active = 0;
        for activity in at_work {
            active += 1;
            if let Some(count) = of_kind.get_mut(activity.kind.index()) {
                *count += 1;
            }
        }
        let activities = if active == 1 { "activity" } else { "activities" };
        let work = format!("{} {activities} at work", crate::report::count(active));
        let week = week(scene, time).map(|week| format!("{week} \u{b7} ")).unwrap_or_default();
        let legend = match colored {
            Colored::Own => Vec::new(),
            Colored::Activity => kinds(scene, &of_kind),
            Colored::Slip => SlipClass::WORDS
                .map(|(word, class)| LegendEntry {
                    name: word.to_owned(),
                    color: slip_color(class),
                    count: None,
                })
                .into(),
            Colored::Ahead(weeks) => Looks::legend_of_look_ahead(weeks)
                .into_iter()
                .map(|row| LegendEntry { name: row.name, color: row.color, count: None })
                .collect(),
        };
        Self { title: date_with_weekday(time), line: format!("{week}{work}"), legend }
    }
}

/// `Tue 3 Mar 2026`.
pub fn date_with_weekday(time: Time) -> String {
    match time.civil() {
        Some(civil) => civil.format("%a %-d %b %Y").to_string(),
        None => time.to_string(),
    }
}

/// `Week 3 of 125`, as the window counts them.
fn week(scene: &Scene, time: Time) -> Option<String> {
    let period = scene.schedule.period;
    if scene.schedule.activities.is_empty() || period.seconds() == 0 {
        return None;
    }
    let last = period.week(period.end)?;
    let first_day = period.start.civil()?.date();
    Some(match period.week(time)? {
        _ if time.civil()?.date() < first_day => "Before the start".to_owned(),
        n if n > last => "After the end".to_owned(),
        n => format!("Week {n} of {last}"),
    })
}

/// The kinds that occur and have a colour, with how many activities of each are at work.
fn kinds(scene: &Scene, at_work: &[usize]) -> Vec<LegendEntry> {
    let kinds: &Kinds = &scene.schedule.kinds;
    let mut used = vec![false; at_work.len()];
    for activity in &scene.schedule.activities {
        if let Some(used) = used.get_mut(activity.kind.index()) {
            *used = true;
        }
    }
    let rows = kinds.iter().zip(used).zip(at_work).filter(|((_, used), _)| *used);
    rows.filter_map(|((kind, _), &count)| {
        let color = kind.during.look().color?;
        Some(LegendEntry { name: kind.name.clone(), color, count: Some(count) })
    })
    .collect()
}

/// A part of a picture, pixels from the upper left corner.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Area {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// Writes captions, with the fonts of the window. Making one takes some milliseconds; keep it for a film, since
/// its captions then are as wide as the widest so far.
pub struct Scribe {
    fonts: Fonts,
    /// Of the last picture, and how wide its caption was.
    size: [u32; 2],
    width: f32,
}

/// The panel behind the text: dark enough for white text over everything, and clear enough to see a building.
const PANEL: [u8; 4] = [22, 26, 32, 200];
const TITLE: [u8; 4] = [255, 255, 255, 255];
const TEXT: [u8; 4] = [214, 220, 228, 255];
/// Height of the title's letters in the picture's height.
const TITLE_SHARE: f32 = 0.036;
/// Below this the title cannot be read, pixels.
const SMALLEST_TITLE_PX: f32 = 12.0;
/// More than this of the picture a caption shall not hide.
const LARGEST_SHARE: [f32; 2] = [0.92, 0.6];

impl Default for Scribe {
    fn default() -> Self {
        Self::new()
    }
}

/// A line of text, laid out.
struct Line {
    pixels: Vec<(i32, i32, u8)>,
    width: f32,
    height: f32,
}

impl Scribe {
    /// Reads the fonts.
    pub fn new() -> Self {
        let options = TextOptions {
            max_texture_side: 8192,
            // Coverage as it is: this is no screen, and mixed in gamma space.
            ..TextOptions::default()
        };
        Self { fonts: Fonts::new(options, FontDefinitions::default()), size: [0; 2], width: 0.0 }
    }

    /// Draws a caption into the lower left corner; says what it covers. A caption that has no room becomes
    /// smaller; on a picture too small for letters the rest is cut off.
    pub fn draw(&mut self, caption: &Caption, picture: &mut Picture) -> Area {
        let size = [picture.width as f32, picture.height as f32];
        if picture.width == 0 || picture.height == 0 {
            return Area::default();
        }
        let mut title = (size[1] * TITLE_SHARE).max(SMALLEST_TITLE_PX);
        let mut layout = self.lay_out(caption, title);
        for _ in 0..3 {
            let share = (size[0] * LARGEST_SHARE[0] / layout.width)
                .min(size[1] * LARGEST_SHARE[1] / layout.height);
            if share >= 1.0 || title <= 6.0 {
                break;
            }
            title = (title * share * 0.99).max(6.0);
            layout = self.lay_out(caption, title);
        }
        if self.size != [picture.width, picture.height] {
            (self.size, self.width) = ([picture.width, picture.height], 0.0);
        }
        self.width = self.width.max(layout.width).min(size[0] * LARGEST_SHARE[0]).max(layout.width);
        layout.width = self.width;
        layout.paint(picture)
    }

    fn lay_out(&mut self, caption: &Caption, title_px: f32) -> Layout {
        let text_px = title_px * 0.68;
        let pad = (title_px * 0.55).round();
        let mut parts = Vec::new();
        let mut y = pad;
        let mut width: f32 = 0.0;
        for (text, px, color) in [(&caption.title, title_px, TITLE), (&caption.line, text_px, TEXT)]
        {
            if text.is_empty() {
                continue;
            }
            let line = self.line(text, px);
            width = width.max(line.width);
            let height = line.height;
            parts.push(Part { x: pad, y, color, what: What::Text(line) });
            y += height;
        }
        if !caption.legend.is_empty() {
            y += (text_px * 0.35).round();
        }
        let swatch = (text_px * 0.72).round().max(2.0);
        for entry in &caption.legend {
            let name = self.line(&entry.name, text_px);
            let height = name.height;
            let [r, g, b] = entry.color;
            let beside = ((height - swatch) * 0.5).round();
            parts.push(Part {
                x: pad,
                y: y + beside,
                color: [r, g, b, 255],
                what: What::Swatch(swatch),
            });
            let x = pad + swatch + (text_px * 0.5).round();
            width = width.max(x - pad + name.width);
            if let Some(count) = entry.count {
                let count = self.line(&crate::report::count(count), text_px);
                let gap = text_px * 1.2;
                width = width.max(x - pad + name.width + gap + count.width);
                parts.push(Part { x: f32::INFINITY, y, color: TITLE, what: What::Text(count) });
            }
            parts.push(Part { x, y, color: TEXT, what: What::Text(name) });
            y += height;
        }
        let margin = (title_px * 0.6).round();
        Layout { parts, width: (width + 2.0 * pad).ceil(), height: (y + pad).ceil(), pad, margin }
    }

    /// One line, whatever breaks it.
    fn line(&mut self, text: &str, px: f32) -> Line {
        let text: String =
            text.chars().map(|c| if c.is_control() { ' ' } else { c }).take(200).collect();
        let font = FontId::proportional(px);
        let galley =
            self.fonts.with_pixels_per_point(1.0).layout_no_wrap(text, font, Color32::WHITE);
        let atlas = self.fonts.image();
        let mut pixels = Vec::new();
        for row in &galley.rows {
            for glyph in row.glyphs.iter().filter(|g| !g.uv_rect.is_nothing()) {
                let rect = glyph.uv_rect;
                let corner = row.pos + glyph.pos.to_vec2() + rect.offset;
                let (left, top) = (corner.x.round() as i32, corner.y.round() as i32);
                for v in rect.min[1]..rect.max[1] {
                    for u in rect.min[0]..rect.max[0] {
                        let cover = atlas[(usize::from(u), usize::from(v))].a();
                        if cover > 0 {
                            let at = (
                                left + i32::from(u - rect.min[0]),
                                top + i32::from(v - rect.min[1]),
                            );
                            pixels.push((at.0, at.1, cover));
                        }
                    }
                }
            }
        }
        let size = galley.size();
        Line { pixels, width: size.x, height: size.y.ceil() }
    }
}

enum What {
    Text(Line),
    /// A square, pixels.
    Swatch(f32),
}

/// Something at a place in the panel; infinitely far right: at its right side.
struct Part {
    x: f32,
    y: f32,
    color: [u8; 4],
    what: What,
}

struct Layout {
    parts: Vec<Part>,
    width: f32,
    height: f32,
    pad: f32,
    margin: f32,
}

impl Layout {
    fn paint(&self, picture: &mut Picture) -> Area {
        let margin =
            self.margin.min(picture.width.min(picture.height) as f32 * 0.05).round() as i32;
        let (width, height) = (self.width as i32, self.height as i32);
        let left = margin;
        let top = (picture.height as i32 - margin - height).max(0);
        let radius = self.pad * 0.5;
        for y in 0..height {
            for x in 0..width {
                let cover = round_corner([x, y], [width, height], radius);
                blend(picture, left + x, top + y, PANEL, cover);
            }
        }
        let inside = |x: i32, y: i32| (0..width).contains(&x) && (0..height).contains(&y);
        for part in &self.parts {
            match &part.what {
                What::Swatch(side) => {
                    let (x0, y0, side) = (part.x as i32, part.y as i32, *side as i32);
                    for y in 0..side {
                        for x in 0..side {
                            let cover = round_corner([x, y], [side; 2], side as f32 * 0.2);
                            if inside(x0 + x, y0 + y) {
                                blend(picture, left + x0 + x, top + y0 + y, part.color, cover);
                            }
                        }
                    }
                }
                What::Text(line) => {
                    let right = self.width - self.pad - line.width;
                    let (x0, y0) = (part.x.min(right.max(self.pad)).round(), part.y.round());
                    for &(x, y, cover) in &line.pixels {
                        let (x, y) = (x + x0 as i32, y + y0 as i32);
                        if inside(x, y) {
                            blend(picture, left + x, top + y, part.color, f32::from(cover) / 255.0);
                        }
                    }
                }
            }
        }
        Area {
            x: left as u32,
            y: top as u32,
            width: (width as u32).min(picture.width.saturating_sub(left as u32)),
            height: (height as u32).min(picture.height.saturating_sub(top as u32)),
        }
    }
}

/// How much of a pixel a box with round corners covers.
fn round_corner([x, y]: [i32; 2], [width, height]: [i32; 2], radius: f32) -> f32 {
    let into = |at: i32, size: i32| {
        let at = at as f32 + 0.5;
        (radius - at).max(at - (size as f32 - radius)).max(0.0)
    };
    (radius + 0.5 - into(x, width).hypot(into(y, height))).clamp(0.0, 1.0)
}

/// Mixes a colour over a pixel, also one that is not opaque; outside the picture nothing happens.
fn blend(picture: &mut Picture, x: i32, y: i32, color: [u8; 4], cover: f32) {
    let inside = |at: i32, size: u32| u32::try_from(at).ok().filter(|&at| at < size);
    let (Some(x), Some(y)) = (inside(x, picture.width), inside(y, picture.height)) else { return };
    let at = (y as usize * picture.width as usize + x as usize) * 4;
    let Some(pixel) = picture.rgba.get_mut(at..at + 4) else { return };
    let over = f32::from(color[3]) / 255.0 * cover;
    let under = f32::from(pixel[3]) / 255.0 * (1.0 - over);
    let both = over + under;
    if both <= 0.0 {
        return;
    }
    for (c, &new) in pixel[..3].iter_mut().zip(&color) {
        *c = ((f32::from(new) * over + f32::from(*c) * under) / both).round() as u8;
    }
    pixel[3] = (both * 255.0).round() as u8;
}

#[cfg(test)]
mod tests;
