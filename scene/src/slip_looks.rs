//! Elements in the colours of how much earlier or later their work is.

use crate::{ElementId, Looks, Scene};
use std::collections::HashMap;
use topout_schedule::{Comparison, DateSet, Flags, Look, SlipClass};

/// The colour of a class, sRGB: blue for earlier, red for later, as people see them apart who do not see
/// red or green; grey where a date is not known.
pub const fn slip_color(class: SlipClass) -> [u8; 3] {
    match class {
        SlipClass::MuchEarlier => [0x05, 0x71, 0xB0],
        SlipClass::Earlier => [0x92, 0xC5, 0xDE],
        SlipClass::OnTime => [0xEE, 0xEE, 0xEA],
        SlipClass::Later => [0xF4, 0xA5, 0x82],
        SlipClass::MuchLater => [0xCA, 0x00, 0x20],
        SlipClass::NoDate => [0x8A, 0x8A, 0x8A],
    }
}

impl Looks {
    /// Each element in the colour of the activity of its own that slipped most; elements without activities
    /// keep their colours.
    pub fn of_slip(scene: &Scene, comparison: &Comparison) -> Self {
        let worst = |element| {
            let slips = scene.activities_of(element).iter();
            let slips = slips.filter_map(|&a| comparison.of_activity(a as usize));
            let known = |slip: &&topout_schedule::Slip| !slip.missing;
            let size = |slip: &&topout_schedule::Slip| slip.working_days.abs();
            let most = slips.clone().filter(known).max_by(|a, b| size(a).total_cmp(&size(b)));
            most.or_else(|| slips.into_iter().next()).map(topout_schedule::Slip::class)
        };
        Self::of_classes(scene, worst)
    }

    /// Each element in the colour of what an event log says of it: of several things the latest.
    pub fn of_flags(scene: &Scene, flags: &Flags) -> Self {
        let mut classes: HashMap<&str, SlipClass> = HashMap::new();
        for said in &flags.activities {
            let keys = &scene.schedule.activities[said.activity].elements;
            for (key, class) in keys.iter().zip(&said.elements) {
                let known = classes.entry(key).or_insert(*class);
                if *known == SlipClass::NoDate || *class == SlipClass::Later {
                    *known = *class;
                }
            }
        }
        Self::of_classes(scene, |id| {
            let element = &scene.model.elements[id.index()];
            let by_guid = element.guid.as_deref().and_then(|guid| classes.get(guid));
            by_guid.or_else(|| classes.get(element.name.as_str())).copied()
        })
    }

    /// By what is known: the dates of two sets where activities have both, else what an event log says;
    /// `None` where nothing is known.
    pub fn of_differences(scene: &Scene, from: DateSet, to: DateSet) -> Option<Self> {
        let comparison = Comparison::of_sets(&scene.schedule, from, to);
        if comparison.slips.iter().any(|slip| !slip.missing) {
            return Some(Self::of_slip(scene, &comparison));
        }
        Comparison::of_flags(&scene.schedule).map(|flags| Self::of_flags(scene, &flags))
    }

    fn of_classes(scene: &Scene, class: impl Fn(ElementId) -> Option<SlipClass>) -> Self {
        let elements = (0..scene.model.elements.len() as u32).map(ElementId);
        let look = |class| Look::colored(slip_color(class));
        Self::fixed(elements.filter_map(|id| class(id).map(|class| (id, look(class)))))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Element, Model, link};
    use topout_schedule::{ReadOptions, Time, read_bytes};

    fn scene(name: &str, text: &str) -> Scene {
        let schedule = read_bytes(name.as_ref(), text.as_bytes(), &ReadOptions::default()).unwrap();
        let element = |i| Element { name: format!("e{i}"), ..Element::default() };
        link::link(Model { elements: (0..5).map(element).collect(), ..Model::default() }, schedule)
    }

    fn colors(looks: &Looks) -> Vec<(u32, [u8; 3])> {
        let mut all = Vec::new();
        looks.at(Time::from_seconds(0), |e, l| {
            all.push((e.0, looks.palette()[l.index()].color.unwrap()));
        });
        all.sort_unstable();
        all
    }

    #[test]
    fn the_largest_slip_of_an_element_counts() {
        let activity = |id: &str, planned: &str, actual: &str, elements: &str| {
            format!(
                r#"{{"id": "{id}", "planned_start": "2026-03-02", "planned_end": "{planned}",
                    "actual_end": {actual}, "elements": [{elements}]}}"#
            )
        };
        let activities = [
            activity("A", "2026-03-03", "\"2026-03-05\"", r#""e0", "e1""#),
            activity("B", "2026-03-20", "\"2026-03-03\"", r#""e1""#),
            activity("C", "2026-03-03", "\"2026-03-03\"", r#""e2""#),
            activity("D", "2026-03-03", "null", r#""e3", "e2""#),
        ];
        let scene = scene("plan.json", &format!("{{\"activities\": [{}]}}", activities.join(",")));
        let looks = Looks::of_differences(&scene, DateSet::Planned, DateSet::Actual).unwrap();
        let of = |e, class| (e, slip_color(class));
        assert_eq!(
            colors(&looks),
            [
                of(0, SlipClass::Later),
                of(1, SlipClass::MuchEarlier),
                of(2, SlipClass::OnTime),
                of(3, SlipClass::NoDate)
            ]
        );
        assert!(
            Looks::of_differences(&scene, DateSet::Planned, DateSet::Forecast).is_none(),
            "nothing is known"
        );
    }
}
