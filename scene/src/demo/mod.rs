//! The demo project: a skyscraper with its site, its town and its schedule, made of a few numbers.
//!
//! The same settings give the same project on every machine: whole numbers decide how many parts
//! there are, and positions use only operations that IEEE 754 fixes. The core of the project is a
//! design on a grid ([`design`]); what is missing to the wanted number of elements becomes ceiling
//! fittings, to that of triangles finer tessellation and leaves, to that of activities checks of
//! finished work.

mod builder;
mod design;
mod facade;
mod fitout;
mod machines;
mod mesh;
mod model;
mod palette;
mod planning;
mod programme;
mod random;
mod shapes;
mod site;
mod structure;
mod surroundings;
mod temporary;

#[cfg(test)]
mod tests;

use crate::{Cancelled, Model, Progress};
use builder::Builder;
use design::Design;
use topout_schedule::Schedule;

/// How large the demo project is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DemoSettings {
    /// Elements, 1,000 to 1,000,000.
    pub elements: usize,
    /// Triangles of all elements, instances counted each.
    pub triangles: usize,
    /// Activities (leaf tasks).
    pub activities: usize,
    /// Varies the site.
    pub seed: u64,
}

impl Default for DemoSettings {
    fn default() -> Self {
        Self { elements: 79_396, triangles: 3_632_126, activities: 67_099, seed: 4 }
    }
}

impl DemoSettings {
    /// Settings for a number of elements, with triangles and activities in proportion.
    pub fn for_elements(elements: usize) -> Self {
        let default = Self::default();
        let scaled = |n: usize| {
            (n as u128 * elements as u128 / default.elements as u128).min(usize::MAX as u128)
                as usize
        };
        Self {
            elements,
            triangles: scaled(default.triangles),
            activities: scaled(default.activities),
            seed: default.seed,
        }
    }
}

/// Why there is no such demo project.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum DemoError {
    /// The number of elements is out of range.
    #[error("the demo project can have {least} to {most} elements, not {wanted}", least = DemoError::ELEMENTS.0, most = DemoError::ELEMENTS.1)]
    Elements {
        /// What was asked for.
        wanted: usize,
    },
    /// The elements cannot be drawn with so few or so many triangles.
    #[error(
        "with this number of elements the demo project can have {least} to {most} triangles, not {wanted}"
    )]
    Triangles {
        /// What was asked for.
        wanted: usize,
        /// Fewest possible.
        least: usize,
        /// Most possible.
        most: usize,
    },
    /// The elements cannot be built in so few or so many activities.
    #[error(
        "with this number of elements the demo project can have {least} to {most} activities, not {wanted}"
    )]
    Activities {
        /// What was asked for.
        wanted: usize,
        /// Fewest possible.
        least: usize,
        /// Most possible.
        most: usize,
    },
    /// The user cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl DemoError {
    /// Fewest and most elements.
    const ELEMENTS: (usize, usize) = (1_000, 1_000_000);
}

/// Makes the demo project with exactly the numbers of `settings`.
pub fn generate(
    settings: &DemoSettings,
    progress: &Progress,
) -> Result<(Model, Schedule), DemoError> {
    let wanted = settings.elements;
    if wanted < DemoError::ELEMENTS.0 || wanted > DemoError::ELEMENTS.1 {
        return Err(DemoError::Elements { wanted });
    }
    progress.begin("Designing the demo project", 0)?;
    let mut b = largest(wanted, settings.seed, progress)?;
    let missing = wanted - b.parts.len();
    fitout::fill(&mut b, missing);
    progress.begin("Building the demo project", wanted as u64)?;
    let names = model::names(&b.parts);
    let model = model::model(&b, &names, settings.triangles, settings.seed, progress)?;
    let (activities, outline) =
        programme::activities(&b.works, &b.parts, &names, settings.activities)?;
    progress.check()?;
    Ok((model, programme::schedule(activities, outline)))
}

/// Everything but the fittings, as large as fits into `wanted` elements.
fn largest(wanted: usize, seed: u64, progress: &Progress) -> Result<Builder, DemoError> {
    let mut size = wanted as u64 * 13 / 10;
    loop {
        progress.check()?;
        let b = core(Design::new(size as u32, seed), seed);
        // Some fittings belong to every house, and there must be room for those that are missing.
        let most = wanted - wanted / 50;
        if b.parts.len() <= most && wanted - b.parts.len() <= fitout::room(&b) || size < 600 {
            if b.parts.len() > wanted {
                return Err(DemoError::Elements { wanted });
            }
            return Ok(b);
        }
        // Overshoot shows how far to go down; at least a hundredth, so that the loop ends.
        let guess = size * most as u64 / b.parts.len() as u64;
        size = guess.clamp(size * 3 / 4, size * 99 / 100);
    }
}

fn core(design: Design, seed: u64) -> Builder {
    let mut b = Builder::new(design, seed);
    surroundings::add(&mut b);
    site::add(&mut b);
    structure::add(&mut b);
    facade::add(&mut b);
    fitout::add(&mut b);
    temporary::add(&mut b);
    b
}
