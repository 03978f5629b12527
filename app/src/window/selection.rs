//! What is selected: elements, and perhaps the activity that they were selected by.

use topout_scene::ElementId;

/// How elements change what is selected.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Choose {
    /// They are selected, nothing else.
    Only,
    /// They are selected, too.
    Add,
    /// Those that are selected no longer are, the others are.
    Toggle,
}

impl Choose {
    /// As everywhere: Ctrl toggles, Shift adds.
    pub fn by(modifiers: egui::Modifiers) -> Self {
        match (modifiers.command, modifiers.shift) {
            (true, _) => Self::Toggle,
            (false, true) => Self::Add,
            (false, false) => Self::Only,
        }
    }
}

/// Selected elements, each once.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Selected {
    /// Sorted.
    elements: Vec<ElementId>,
    /// Chosen last.
    last: Option<ElementId>,
    /// The activity, by its place in the schedule, whose elements were selected.
    activity: Option<usize>,
}

impl Selected {
    /// All of them, sorted.
    pub fn elements(&self) -> &[ElementId] {
        &self.elements
    }

    /// The element that was chosen last, if it is selected.
    pub fn last(&self) -> Option<ElementId> {
        self.last
    }

    /// The element, if there is but one.
    pub fn only(&self) -> Option<ElementId> {
        match self.elements[..] {
            [one] => Some(one),
            _ => None,
        }
    }

    /// The activity that was selected last, by its place in the schedule.
    pub fn activity(&self) -> Option<usize> {
        self.activity
    }

    /// Whether nothing is selected.
    pub fn is_empty(&self) -> bool {
        self.elements.is_empty() && self.activity.is_none()
    }

    /// Whether an element is selected.
    pub fn contains(&self, element: ElementId) -> bool {
        self.elements.binary_search(&element).is_ok()
    }

    /// Selects elements.
    pub fn choose(&mut self, how: Choose, mut elements: Vec<ElementId>) {
        self.activity = None;
        let last = elements.last().copied();
        elements.sort_unstable();
        elements.dedup();
        match how {
            Choose::Only => self.elements = elements,
            Choose::Add => {
                self.elements.extend(elements);
                self.elements.sort_unstable();
                self.elements.dedup();
            }
            Choose::Toggle => {
                let gone: Vec<ElementId> =
                    elements.iter().copied().filter(|id| self.contains(*id)).collect();
                self.elements.retain(|id| gone.binary_search(id).is_err());
                elements.retain(|id| gone.binary_search(id).is_err());
                self.elements.extend(elements);
                self.elements.sort_unstable();
            }
        }
        self.last = last.filter(|id| self.contains(*id)).or(self.only());
    }

    /// Selects the elements of an activity.
    pub fn choose_activity(&mut self, activity: usize, elements: Vec<ElementId>) {
        self.choose(Choose::Only, elements);
        self.activity = Some(activity);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        /// Against sets.
        #[test]
        fn it_is_a_set(steps in prop::collection::vec((0u8..3, prop::collection::vec(0u32..12, 0..6)), 0..12)) {
            let mut selected = Selected::default();
            let mut set = BTreeSet::new();
            for (how, ids) in steps {
                let elements: Vec<ElementId> = ids.iter().copied().map(ElementId).collect();
                let named: BTreeSet<ElementId> = elements.iter().copied().collect();
                let how = [Choose::Only, Choose::Add, Choose::Toggle][how as usize];
                set = match how {
                    Choose::Only => named,
                    Choose::Add => &set | &named,
                    Choose::Toggle => &set ^ &named,
                };
                selected.choose(how, elements);
                prop_assert!(selected.elements().iter().eq(set.iter()));
                prop_assert!(selected.last().is_none_or(|id| selected.contains(id)));
                prop_assert_eq!(selected.only().is_some(), set.len() == 1);
            }
        }
    }
}
