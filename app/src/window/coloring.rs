//! Which looks elements have now, and what the legend says of them.

use super::loading::Project;
use super::shown::ElementColors;
use super::visibility::Visibility;
use std::sync::Arc;
use topout_scene::{Category, LegendRow, Looks, slip_color};
use topout_schedule::{SlipClass, Time};

/// The looks of the shown elements; worked out when what they follow from has changed.
#[derive(Default)]
pub struct Coloring {
    /// What they are for.
    of: Option<(Arc<Project>, ElementColors, Visibility)>,
    looks: Option<Arc<Looks>>,
    legend: Vec<LegendRow>,
    /// The date that the legend counts at, where that matters.
    counted: Option<Time>,
}

impl Coloring {
    /// What the renderer shows; `None` where everything looks as it is.
    pub fn looks(&self) -> Option<&Arc<Looks>> {
        self.looks.as_ref()
    }

    /// Which colour means what, and how many elements have it.
    pub fn legend(&self) -> &[LegendRow] {
        &self.legend
    }

    /// Brings looks and legend to what is wanted.
    pub fn refresh(
        &mut self,
        project: Option<&Arc<Project>>,
        colors: ElementColors,
        visibility: &Visibility,
        time: Time,
    ) {
        let Some(project) = project else {
            *self = Self::default();
            return;
        };
        let same = self.of.as_ref().is_some_and(|(known, by, shown)| {
            Arc::ptr_eq(known, project) && *by == colors && shown == visibility
        });
        if !same {
            self.of = Some((Arc::clone(project), colors, visibility.clone()));
            self.counted = None;
            self.work_out(project, colors, visibility);
        }
        let by_date = matches!(colors, ElementColors::Activity | ElementColors::LookAhead(_));
        if by_date && self.counted != Some(time) {
            self.counted = Some(time);
            self.count(time);
        }
    }

    fn work_out(&mut self, project: &Project, colors: ElementColors, visibility: &Visibility) {
        let scene = &project.scene;
        let category = |category| {
            let (looks, legend) = Looks::of_category(scene, category);
            (Some(Arc::new(looks)), legend)
        };
        let row = |name: &str, color| LegendRow { name: name.to_owned(), color, elements: 0 };
        let (base, legend) = match colors {
            ElementColors::Own => (None, Vec::new()),
            ElementColors::Activity => {
                let legend = project.legend.iter().map(|(name, color)| row(name, *color));
                (Some(Arc::clone(&project.looks)), legend.collect())
            }
            ElementColors::Slip => {
                let rows = SlipClass::WORDS.into_iter();
                let rows = rows.map(|(word, class)| row(word, slip_color(class))).collect();
                (project.slip_looks.clone(), rows)
            }
            ElementColors::Storey => category(Category::Storey),
            ElementColors::Type => category(Category::Type),
            ElementColors::LookAhead(weeks) => {
                let weeks = u32::from(weeks);
                let looks = Looks::of_look_ahead(scene, weeks);
                (Some(Arc::new(looks)), Looks::legend_of_look_ahead(weeks))
            }
        };
        self.legend = legend;
        self.looks = match (base, visibility.is_default()) {
            (base, true) => base,
            (base, false) => {
                let base = base.unwrap_or_default();
                Some(Arc::new(base.overridden(&visibility.looks(scene))))
            }
        };
        if colors == ElementColors::Slip {
            self.count(Time::MIN);
        }
    }

    /// Counts the elements of each colour at a date; those that are hidden or ghosts are not among them.
    fn count(&mut self, time: Time) {
        let Some(looks) = &self.looks else { return };
        let mut counts = vec![0; looks.palette().len()];
        looks.at(time, |_, look| counts[look.index()] += 1);
        for row in &mut self.legend {
            let same =
                |look: &topout_schedule::Look| look.color == Some(row.color) && look.opacity >= 0.5;
            let of_row = looks.palette().iter().zip(&counts).filter(|(look, _)| same(look));
            row.elements = of_row.map(|(_, count)| count).sum();
        }
    }
}
