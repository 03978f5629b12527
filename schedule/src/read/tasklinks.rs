//! Links between activities: waiting for the activities that they name, and as text.

use super::collected::Collected;
use crate::sources::Place;
use crate::{Lag, LinkKind, Predecessor, Severity};
use std::collections::HashMap;

/// Texts that stand for others, numbered in the order in which they occur: ids that records of one
/// file use for each other.
#[derive(Default)]
pub(super) struct Keys {
    numbers: HashMap<Box<str>, u32>,
}

impl Keys {
    pub(super) fn of(&mut self, text: &str) -> u32 {
        match self.numbers.get(text) {
            Some(&known) => known,
            None => {
                let next = u32::try_from(self.numbers.len()).unwrap_or(u32::MAX);
                *self.numbers.entry(text.into()).or_insert(next)
            }
        }
    }

    /// The number of a text that occurred.
    pub(super) fn known(&self, text: &str) -> Option<u32> {
        self.numbers.get(text).copied()
    }

    /// All texts by their numbers.
    pub(super) fn texts(&self) -> Vec<&str> {
        let mut texts = vec![""; self.numbers.len()];
        for (text, &number) in &self.numbers {
            texts[number as usize] = text;
        }
        texts
    }
}

/// Links between activities that wait until all activities are known.
#[derive(Default)]
pub(super) struct TaskLinks {
    /// Ids of predecessors.
    pub(super) keys: Keys,
    links: Vec<TaskLink>,
}

struct TaskLink {
    successor: u32,
    predecessor: u32,
    kind: LinkKind,
    lag: Lag,
}

/// What a key of a file stands for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    /// Index of an activity.
    Activity(u32),
    /// It exists, but is a summary.
    Summary,
}

impl TaskLinks {
    /// `successor` is an index of an activity, `predecessor` of one of `keys`. Returns the link's
    /// number.
    pub(super) fn add(
        &mut self,
        successor: usize,
        predecessor: u32,
        kind: LinkKind,
        lag: Lag,
    ) -> usize {
        let successor = u32::try_from(successor).unwrap_or(u32::MAX);
        self.links.push(TaskLink { successor, predecessor, kind, lag });
        self.links.len() - 1
    }

    pub(super) fn set_lag(&mut self, link: usize, seconds: i64) {
        if let Some(link) = self.links.get_mut(link) {
            link.lag.seconds = seconds;
        }
    }

    /// Gives the links to their activities, where ids are those of the schedule.
    pub(super) fn attach(all: &mut Collected) {
        let mut waiting = std::mem::take(&mut all.task_links);
        if waiting.links.is_empty() {
            return;
        }
        let mut targets = HashMap::with_capacity(all.activities.len());
        for (i, activity) in all.activities.iter().enumerate().rev() {
            if let Some(&key) = waiting.keys.numbers.get(activity.id.as_str()) {
                targets.insert(key, Target::Activity(i as u32));
            }
        }
        waiting.attach_to(&targets, all);
    }

    /// Gives the links to their activities; what `targets` does not name is reported.
    pub(super) fn attach_to(&mut self, targets: &HashMap<u32, Target>, all: &mut Collected) {
        // As many for each as it has links, since there are far more than activities.
        let mut counts = vec![0usize; all.activities.len()];
        for link in &self.links {
            if let Some(count) = counts.get_mut(link.successor as usize) {
                *count += 1;
            }
        }
        for (activity, count) in all.activities.iter_mut().zip(counts) {
            activity.predecessors.reserve_exact(count);
        }
        let names = self.keys.texts();
        for link in std::mem::take(&mut self.links) {
            let successor = link.successor as usize;
            let place = all.sources.activities.get(successor).map(|s| s.place);
            let (Some(place), Some(activity)) = (place, all.activities.get_mut(successor)) else {
                continue;
            };
            let (kind, lag) = (link.kind, link.lag);
            match targets.get(&link.predecessor) {
                Some(&Target::Activity(index)) => {
                    activity.predecessors.push(Predecessor { activity: index, kind, lag });
                }
                other => {
                    let id = activity.id.clone();
                    let name = names.get(link.predecessor as usize).copied().unwrap_or_default();
                    report(all, other.is_some(), &id, name, place);
                }
            }
        }
    }
}

fn report(all: &mut Collected, is_summary: bool, id: &str, predecessor: &str, place: Place) {
    let (code, what) = match is_summary {
        true => ("summary-link", "which is a summary"),
        false => ("unknown-predecessor", "which does not exist"),
    };
    all.report(Severity::Warning, code, id, place, || {
        format!("activity {id:?} follows {predecessor:?}, {what}; the link is left out")
    });
}

/// An order in which parents come before their children, else that of the numbers. Where parents
/// form a ring some child comes first.
pub(super) fn parents_first(parents: &[Option<usize>]) -> Vec<usize> {
    let mut order = Vec::with_capacity(parents.len());
    let mut on_the_way = vec![false; parents.len()];
    for start in 0..parents.len() {
        let begin = order.len();
        let mut next = Some(start);
        while let Some(i) = next
            && !std::mem::replace(&mut on_the_way[i], true)
        {
            order.push(i);
            next = parents[i];
        }
        order[begin..].reverse();
    }
    order
}

const HOUR: f64 = 3600.0;

/// Reads a predecessor as tables write it: an id, then perhaps a kind, then perhaps a lag; between
/// id and kind a colon may stand, and must if the id ends like a kind. `A10`, `A10:SS`, `12FS+2 days`,
/// `A10:FF-3600s`, `7FS+1ed` (elapsed). Days have 8 hours and weeks 5 days of working time.
pub(crate) fn read_predecessor(text: &str) -> Option<(&str, LinkKind, Lag)> {
    let text = text.trim();
    let split = match text.rsplit_once(':') {
        Some((id, rest)) => kind_and_lag(rest).map(|(kind, lag)| (id, kind, lag)),
        None => None,
    };
    let found = split.or_else(|| {
        // The last two letters that are a kind, with nothing but a lag after them.
        let ends = text.char_indices().rev().map(|(at, _)| at);
        let at = ends.take(24).find(|&at| kind_and_lag(&text[at..]).is_some())?;
        let (kind, lag) = kind_and_lag(&text[at..])?;
        (at > 0).then(|| (&text[..at], kind, lag))
    });
    let (id, kind, lag) = found.unwrap_or((text, LinkKind::default(), Lag::default()));
    let id = if found.is_some() { id.trim_end() } else { id };
    (!id.is_empty()).then_some((id, kind, lag))
}

fn kind_and_lag(text: &str) -> Option<(LinkKind, Lag)> {
    let kind = LinkKind::from_word(text.get(..2)?)?;
    let lag = text[2..].trim();
    if lag.is_empty() {
        return Some((kind, Lag::default()));
    }
    let digits = lag.strip_prefix(['+', '-'])?.trim_start();
    let split = digits.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(digits.len());
    let (number, unit) = digits.split_at(split);
    let unit = unit.trim().trim_end_matches('?').to_ascii_lowercase();
    let elapsed = unit.starts_with('e');
    let unit = unit.strip_prefix('e').unwrap_or(&unit);
    let day = if elapsed { 24.0 } else { 8.0 };
    let unit_seconds = match unit {
        "s" => 1.0,
        "m" | "min" | "mins" | "minutes" => 60.0,
        "h" | "hr" | "hrs" | "hour" | "hours" => HOUR,
        "d" | "day" | "days" | "" => day * HOUR,
        "w" | "wk" | "wks" | "week" | "weeks" => day * HOUR * if elapsed { 7.0 } else { 5.0 },
        _ => return None,
    };
    let sign = if lag.starts_with('-') { -1.0 } else { 1.0 };
    let seconds = sign * number.parse::<f64>().ok()? * unit_seconds;
    Some((kind, Lag { seconds: whole_seconds(seconds)?, elapsed }))
}

/// `None` beyond a thousand years: no lag, and no overflow later.
pub(super) fn whole_seconds(seconds: f64) -> Option<i64> {
    (seconds.abs() < 3.2e10).then(|| seconds.round() as i64)
}

/// Seconds of an ISO 8601 duration such as `P1DT16H` or `PT8H0M0S`; a day has 24 hours.
pub(super) fn duration_seconds(text: &str) -> Option<i64> {
    let text = text.trim();
    let (text, sign) = text.strip_prefix('-').map_or((text, 1.0), |text| (text, -1.0));
    let (mut seconds, mut in_time, mut from) = (0f64, false, 0);
    let text = text.strip_prefix('P')?;
    for (at, letter) in text.char_indices().filter(|(_, c)| c.is_ascii_alphabetic()) {
        let number = &text[from..at];
        from = at + 1;
        let unit = match (letter, in_time) {
            ('T', false) if number.is_empty() => {
                in_time = true;
                continue;
            }
            ('Y', false) => 365.0 * 24.0 * HOUR,
            ('M', false) => 30.0 * 24.0 * HOUR,
            ('W', false) => 7.0 * 24.0 * HOUR,
            ('D', false) => 24.0 * HOUR,
            ('H', true) => HOUR,
            ('M', true) => 60.0,
            ('S', true) => 1.0,
            _ => return None,
        };
        seconds += number.parse::<f64>().ok()? * unit;
    }
    if from != text.len() { None } else { whole_seconds(sign * seconds) }
}

/// Writes a predecessor so that [`read_predecessor`] gives the same.
pub(crate) fn write_predecessor(id: &str, link: &Predecessor) -> String {
    let Lag { seconds, elapsed } = link.lag;
    let unit = if elapsed { "es" } else { "s" };
    match seconds == 0 && !elapsed {
        true => format!("{id}:{}", link.kind.word()),
        false => format!("{id}:{}{seconds:+}{unit}", link.kind.word()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations() {
        assert_eq!(duration_seconds("P0Y0M1DT16H0M0S"), Some(40 * 3600));
        assert_eq!(duration_seconds("PT8H30M"), Some(8 * 3600 + 1800));
        assert_eq!(duration_seconds("-P1W"), Some(-7 * 86_400));
        for bad in ["", "8H", "PT8", "P8H", "PTxH", "PT1e300H", "P1DT1D"] {
            assert_eq!(duration_seconds(bad), None, "{bad}");
        }
    }

    #[test]
    fn rings_of_parents_end() {
        assert_eq!(parents_first(&[Some(1), Some(2), None, Some(0)]), [2, 1, 0, 3]);
        assert_eq!(parents_first(&[Some(1), Some(0), Some(2)]), [1, 0, 2]);
    }

    #[test]
    fn predecessors_as_text() {
        use LinkKind::{FinishFinish, FinishStart, StartFinish, StartStart};
        let day = 28_800;
        for (text, id, kind, seconds, elapsed) in [
            ("A10", "A10", FinishStart, 0, false),
            ("104897:SS", "104897", StartStart, 0, false),
            ("12FS+2 days", "12", FinishStart, 2 * day, false),
            ("12ss", "12", StartStart, 0, false),
            ("7FF-1.5d", "7", FinishFinish, -3 * day / 2, false),
            ("7SF+1ed", "7", StartFinish, 86_400, true),
            ("7 FS +4h", "7", FinishStart, 14_400, false),
            ("A:FS:FS-30s", "A:FS", FinishStart, -30, false),
            ("A:FS+0es", "A", FinishStart, 0, true),
            // No lag follows, so these letters belong to the id.
            ("OFFSET", "OFFSET", FinishStart, 0, false),
            ("FS", "FS", FinishStart, 0, false),
        ] {
            let lag = Lag { seconds, elapsed };
            assert_eq!(read_predecessor(text), Some((id, kind, lag)), "{text}");
        }
        assert_eq!(read_predecessor(" "), None);
    }
}
