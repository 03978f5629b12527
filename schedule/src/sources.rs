//! Where activities and their elements stand in files, for what is said of them.

/// Places of a schedule's activities, in step with [`crate::Schedule::activities`]. Empty for a
/// schedule that was not read from files.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    pub(crate) files: Vec<String>,
    pub(crate) activities: Vec<Source>,
}

/// Where one activity comes from.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    pub(crate) place: Place,
    /// Something was already said of its dates.
    pub(crate) dates_reported: bool,
    /// Places of its last elements: those that links files gave it.
    pub(crate) links: Vec<Place>,
}

/// A line of a file and, in JSON, which of the activities stands there.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Place {
    pub(crate) file: u32,
    pub(crate) line: u32,
    /// From 1; 0 for none.
    pub(crate) number: u32,
}

impl Place {
    /// Counts beyond 32 bits stay at the largest; no file that is read has as many lines.
    pub(crate) fn new(file: usize, line: usize, number: usize) -> Self {
        let short = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Self { file: short(file), line: short(line), number: short(number) }
    }

    /// The same activity, another line.
    pub(crate) fn on_line(self, line: usize) -> Self {
        Self { line: u32::try_from(line).unwrap_or(u32::MAX), ..self }
    }
}

impl Sources {
    /// Bytes of all places.
    pub(crate) fn bytes(&self) -> usize {
        let links = |source: &Source| size_of_val(&source.links[..]);
        size_of_val(&self.activities[..]) + self.activities.iter().map(links).sum::<usize>()
    }

    /// A place in words.
    pub(crate) fn describe(&self, place: Place) -> String {
        let file = self.files.get(place.file as usize).map_or("", String::as_str);
        match place.number {
            0 => format!("{file}: line {}", place.line),
            number => format!("{file}: line {}, activity {number}", place.line),
        }
    }

    /// File and line of an activity; its number where it comes from no file.
    pub(crate) fn of_activity(&self, activity: usize) -> String {
        match self.activities.get(activity) {
            Some(source) => self.describe(source.place),
            None => format!("activity {}", activity + 1),
        }
    }

    /// File and line at which an activity, that has so many elements, got one of them.
    pub(crate) fn of_element(&self, activity: usize, elements: usize, element: usize) -> String {
        let link = self.activities.get(activity).and_then(|source| {
            let own = elements.checked_sub(source.links.len())?;
            source.links.get(element.checked_sub(own)?)
        });
        match link {
            Some(&place) => self.describe(place),
            None => self.of_activity(activity),
        }
    }
}
