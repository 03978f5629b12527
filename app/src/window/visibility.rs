//! What is hidden or shown as a ghost, whatever the date.

use topout_scene::{ElementId, Scene};
use topout_schedule::Look;

/// How elements are drawn that the user does not want to look at.
#[derive(
    Clone, Copy, PartialEq, Eq, Hash, Debug, Default, serde::Serialize, serde::Deserialize,
)]
pub enum Shown {
    /// As ever.
    #[default]
    Whole,
    /// Pale, and what is behind shines through.
    Ghost,
    /// Not at all.
    Hidden,
}

impl Shown {
    /// The look that replaces what an element would have; `None` where it keeps that.
    pub fn look(self) -> Option<Look> {
        match self {
            Self::Whole => None,
            Self::Ghost => Some(Look { color: Some([0xB4, 0xBA, 0xC2]), opacity: 0.14 }),
            Self::Hidden => Some(Look::HIDDEN),
        }
    }
}

/// Elements that are not drawn as ever.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Visibility {
    /// By element; those beyond its end are whole.
    elements: Vec<Shown>,
    /// How elements are drawn that no activity touches, unless they are named.
    pub unscheduled: Shown,
}

impl Visibility {
    /// Whether everything is drawn as ever.
    pub fn is_default(&self) -> bool {
        self.unscheduled == Shown::Whole && self.count() == 0
    }

    /// How the user wants an element to be drawn.
    pub fn of(&self, scene: &Scene, element: ElementId) -> Shown {
        match self.elements.get(element.index()) {
            None | Some(Shown::Whole) if scene.activities_of(element).is_empty() => {
                self.unscheduled
            }
            shown => shown.copied().unwrap_or_default(),
        }
    }

    /// How the user wants an element to be drawn by name.
    pub fn named(&self, element: ElementId) -> Shown {
        self.elements.get(element.index()).copied().unwrap_or_default()
    }

    /// Nothing is hidden but what has no activities, if that is.
    pub fn of_unscheduled(unscheduled: Shown) -> Self {
        Self { unscheduled, ..Self::default() }
    }

    /// Draws elements in another way.
    pub fn set(&mut self, elements: &[ElementId], shown: Shown) {
        let count = elements.iter().map(|id| id.index() + 1).max().unwrap_or(0);
        if self.elements.len() < count {
            self.elements.resize(count, Shown::Whole);
        }
        elements.iter().for_each(|id| self.elements[id.index()] = shown);
    }

    /// Draws all but some of `count` elements in another way, and those as ever.
    pub fn isolate(&mut self, count: usize, keep: &[ElementId], others: Shown) {
        self.elements = vec![others; count];
        self.set(keep, Shown::Whole);
    }

    /// Elements that are hidden or ghosts by name, not for want of activities.
    pub fn count(&self) -> usize {
        self.elements.iter().filter(|shown| **shown != Shown::Whole).count()
    }

    /// The elements that are hidden or ghosts by name.
    pub fn elements(&self) -> impl Iterator<Item = (ElementId, Shown)> + '_ {
        let all = (0u32..).zip(&self.elements).map(|(i, shown)| (ElementId(i), *shown));
        all.filter(|(_, shown)| *shown != Shown::Whole)
    }

    /// The looks that replace the elements' own, by element.
    pub fn looks(&self, scene: &Scene) -> Vec<(ElementId, Look)> {
        if self.is_default() {
            return Vec::new();
        }
        let all = (0..scene.model.elements.len() as u32).map(ElementId);
        all.filter_map(|id| Some((id, self.of(scene, id).look()?))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use topout_scene::{Element, Model, link};
    use topout_schedule::{Activity, Schedule};

    #[test]
    fn what_is_hidden_comes_back() {
        let element = |name: &str| Element { name: name.to_owned(), ..Element::default() };
        let elements = ["a", "b", "c"].map(element).to_vec();
        let activity = Activity {
            id: "1".to_owned(),
            elements: vec!["a".to_owned(), "b".to_owned()],
            ..Activity::default()
        };
        let schedule = Schedule::new(String::new(), None, vec![activity], Default::default());
        let scene = link::link(Model { elements, ..Model::default() }, schedule);
        let mut visibility = Visibility::default();
        let all = |v: &Visibility| [0, 1, 2].map(|i| v.of(&scene, ElementId(i)));
        use Shown::{Ghost, Hidden, Whole};
        assert_eq!(all(&visibility), [Whole; 3]);
        visibility.unscheduled = Ghost;
        assert_eq!(all(&visibility), [Whole, Whole, Ghost]);
        visibility.set(&[ElementId(0), ElementId(2)], Hidden);
        assert_eq!(all(&visibility), [Hidden, Whole, Hidden]);
        assert!(visibility.looks(&scene).iter().all(|(_, look)| look.is_hidden()));
        visibility.isolate(3, &[ElementId(1)], Ghost);
        assert_eq!(all(&visibility), [Ghost, Whole, Ghost]);
        assert_eq!((visibility.count(), visibility.looks(&scene).len()), (2, 2));
        visibility = Visibility::default();
        assert!(visibility.is_default() && visibility.looks(&scene).is_empty());
    }
}
