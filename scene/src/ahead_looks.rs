//! Look-ahead: what starts within the next weeks.

use crate::looks::{Spell, id_of};
use crate::{ElementId, LegendRow, LookId, Looks, Scene};
use std::collections::HashMap;
use topout_schedule::{Look, Time};

const WEEK_S: i64 = 7 * 86_400;
/// Work that goes on.
const UNDER_WAY: [u8; 3] = [0xD5, 0x5E, 0x00];
/// All that is there and has nothing to do with it.
const MUTED: [u8; 3] = [0xC9, 0xCB, 0xCE];
/// What is not there yet.
const PREVIEW_OPACITY: f32 = 0.55;
/// From the first week to the last one (points of viridis from its light end; van der Walt and Smith, 2015).
const WEEKS: [[u8; 3]; 4] =
    [[0xFD, 0xE7, 0x25], [0x5E, 0xC9, 0x62], [0x21, 0x91, 0x8C], [0x3B, 0x52, 0x8B]];

/// Most weeks that are told apart.
pub const MOST_WEEKS: u32 = 12;

/// The colour of the `week`-th of so many weeks, sRGB.
fn week_color(week: u32, of: u32) -> [u8; 3] {
    let at = week as f32 / (of.max(2) - 1) as f32 * (WEEKS.len() - 1) as f32;
    let (low, share) = ((at as usize).min(WEEKS.len() - 2), at.fract());
    let share = if at as usize > low { 1.0 } else { share };
    std::array::from_fn(|c| {
        let [from, to] = [WEEKS[low][c], WEEKS[low + 1][c]].map(f32::from);
        (from + (to - from) * share).round() as u8
    })
}

impl Looks {
    /// What goes on in one colour, what starts within the next `weeks` (1 to [`MOST_WEEKS`]) in one for each
    /// week, everything else muted. Elements that are to come are previews, see [`Looks::is_preview`].
    pub fn of_look_ahead(scene: &Scene, weeks: u32) -> Self {
        let weeks = weeks.clamp(1, MOST_WEEKS);
        let mut palette = vec![Look::OWN];
        let muted = id_of(&mut palette, Look::colored(MUTED));
        let under_way = id_of(&mut palette, Look::colored(UNDER_WAY));
        let colors: Vec<[u8; 3]> = (0..weeks).map(|week| week_color(week, weeks)).collect();
        let present: Vec<LookId> =
            colors.iter().map(|color| id_of(&mut palette, Look::colored(*color))).collect();
        let preview = |color: &[u8; 3]| Look { color: Some(*color), opacity: PREVIEW_OPACITY };
        let previews: Vec<LookId> =
            colors.iter().map(|color| id_of(&mut palette, preview(color))).collect();

        let mut steps_of: HashMap<&[u32], Vec<(Time, Stage)>> = HashMap::new();
        let mut spells = Vec::new();
        for element in (0..scene.model.elements.len() as u32).map(ElementId) {
            let list = scene.activities_of(element);
            let steps = steps_of.entry(list).or_insert_with(|| stages(scene, list, weeks));
            let behaviour = scene.behaviour(element);
            let mut last: Option<(Time, LookId)> = None;
            let mut push = |until: Time, last: Option<(Time, LookId)>| {
                if let Some((start, look)) = last.filter(|(start, _)| *start < until) {
                    spells.push(Spell { start, end: until, element, look });
                }
            };
            for &(start, stage) in steps.iter() {
                let look = match stage {
                    Stage::Rest => muted,
                    Stage::UnderWay => under_way,
                    Stage::Ahead(week) if behaviour.at(start) => present[week as usize],
                    Stage::Ahead(week) => previews[week as usize],
                };
                if last.is_none_or(|(_, before)| before != look) {
                    push(start, last);
                    last = Some((start, look));
                }
            }
            push(Time::MAX, last);
        }
        Self::with_previews(palette, spells, previews)
    }

    /// Which colour means which week, without counts.
    pub fn legend_of_look_ahead(weeks: u32) -> Vec<LegendRow> {
        let weeks = weeks.clamp(1, MOST_WEEKS);
        let row = |name: String, color| LegendRow { name, color, elements: 0 };
        let named = (0..weeks).map(|week| match week {
            0 => row("starts within a week".to_owned(), week_color(week, weeks)),
            week => row(format!("in week {}", week + 1), week_color(week, weeks)),
        });
        std::iter::once(row("under way".to_owned(), UNDER_WAY)).chain(named).collect()
    }
}

/// How an element stands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Stage {
    Rest,
    UnderWay,
    /// In so many whole weeks.
    Ahead(u32),
}

/// From when on which holds: at first, and at each change.
fn stages(scene: &Scene, list: &[u32], weeks: u32) -> Vec<(Time, Stage)> {
    let activities = list.iter().map(|&a| &scene.schedule.activities[a as usize]);
    let ranges: Vec<_> = activities.filter(|a| a.active).filter_map(|a| a.dates()).collect();
    let week = |start: Time, k: u32| start.plus_seconds(-i64::from(k) * WEEK_S);
    let mut times: Vec<Time> = vec![Time::MIN];
    for range in &ranges {
        times.push(range.end);
        times.extend((0..=weeks).map(|k| week(range.start, k)));
    }
    times.sort_unstable();
    times.dedup();
    let at = |time: Time| {
        if ranges.iter().any(|range| range.contains(time)) {
            return Stage::UnderWay;
        }
        let next = ranges.iter().map(|range| range.start).filter(|start| *start > time).min();
        let away = next.map(|start| start.seconds().saturating_sub(time.seconds()));
        match away.map(|away| (away - 1) / WEEK_S) {
            Some(away) if away < i64::from(weeks) => Stage::Ahead(away as u32),
            _ => Stage::Rest,
        }
    };
    times.into_iter().map(|time| (time, at(time))).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Element, Model, link};
    use proptest::prelude::*;
    use topout_schedule::{Activity, ActivityKind, Diagnostics, Schedule};

    fn scene(activities: &[(i64, i64, bool, u8)]) -> Scene {
        let day = |d: i64| Some(Time::from_seconds(d * 86_400));
        let activity =
            |(i, &(start, days, demolish, on)): (usize, &(i64, i64, bool, u8))| Activity {
                id: format!("a{i}"),
                start: day(start),
                end: day(start + days),
                kind: if demolish { ActivityKind::Demolish } else { ActivityKind::Construct },
                elements: vec![format!("e{on}")],
                ..Activity::default()
            };
        let list = activities.iter().enumerate().map(activity).collect();
        let schedule = Schedule::new(String::new(), None, list, Diagnostics::default());
        let element = |i| Element { name: format!("e{i}"), ..Element::default() };
        link::link(Model { elements: (0..4).map(element).collect(), ..Model::default() }, schedule)
    }

    proptest! {
        /// At every day each element has the look that its activities ask for on that day.
        #[test]
        fn looks_say_what_comes(
            activities in proptest::collection::vec((0i64..100, 1i64..20, any::<bool>(), 0u8..4), 1..12),
            weeks in 1u32..6,
        ) {
            let scene = scene(&activities);
            let looks = Looks::of_look_ahead(&scene, weeks);
            for day in -60..150 {
                let time = Time::from_seconds(day * 86_400);
                let mut found = vec![None; 4];
                looks.at(time, |e, look| {
                    assert!(found[e.index()].is_none(), "one look at a time");
                    found[e.index()] = Some(look);
                });
                for (e, look) in found.into_iter().enumerate() {
                    let look = look.unwrap();
                    let color = looks.palette()[look.index()].color.unwrap();
                    let own = activities.iter().filter(|a| a.3 as usize == e);
                    let on = own.clone().any(|a| (a.0..a.0 + a.1).contains(&day));
                    let next = own.map(|a| a.0).filter(|start| *start > day).min();
                    let within = next.map(|start| (start - day - 1) / 7).filter(|w| *w < i64::from(weeks));
                    let expected = match (on, within) {
                        (true, _) => UNDER_WAY,
                        (false, Some(week)) => week_color(week as u32, weeks),
                        (false, None) => MUTED,
                    };
                    prop_assert_eq!(color, expected, "day {} element {}", day, e);
                    let absent = !scene.behaviour(ElementId(e as u32)).at(time);
                    let ahead = !on && within.is_some();
                    prop_assert_eq!(looks.is_preview(look), absent && ahead);
                }
            }
        }
    }

    #[test]
    fn weeks_have_colours_of_their_own() {
        for weeks in 1..=MOST_WEEKS {
            let rows = Looks::legend_of_look_ahead(weeks);
            assert_eq!(rows.len(), weeks as usize + 1);
            for (i, a) in rows.iter().enumerate() {
                assert!(rows[i + 1..].iter().all(|b| a.color != b.color), "{weeks}");
            }
        }
        assert_eq!(week_color(3, 4), WEEKS[3]);
        assert_eq!(week_color(0, 1), WEEKS[0]);
    }
}
