//! Which keys of two sides match: work over distinct texts, never over pairs of users.

use super::keys::{Entry, Keys, Target};
use super::rules::{Match, compile};
use aho_corasick::{AhoCorasick, AhoCorasickKind};
use rayon::prelude::*;
use std::borrow::Cow;

/// Pairs of distinct keys that a rule may match. Names that are contained in everything would fill
/// the memory otherwise.
const MOST_MATCHES: usize = 1 << 24;
/// Bytes of texts that patterns out of a schedule are tried on, all together: some ten seconds.
const MOST_TRIED: usize = 1 << 32;
/// Bytes of texts that are looked for at once; the automaton takes some thirty times as much.
const MOST_SOUGHT: usize = 1 << 24;

/// The keys of the model that each key of the schedule matches.
pub(super) struct Matches {
    starts: Vec<u32>,
    keys: Vec<u32>,
    /// What was left out or is wrong, in words that follow a rule's name.
    pub faults: Vec<String>,
}

impl Matches {
    /// Keys of the model for a key of the schedule.
    pub fn of(&self, key: u32) -> &[u32] {
        &self.keys[self.starts[key as usize] as usize..self.starts[key as usize + 1] as usize]
    }

    /// From pairs of the schedule's and the model's key.
    fn from_pairs(mut pairs: Vec<(u32, u32)>, count: usize, faults: Vec<String>) -> Self {
        pairs.sort_unstable();
        pairs.dedup();
        let mut starts = vec![0u32; count + 1];
        for (key, _) in &pairs {
            starts[*key as usize + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        Self { starts, keys: pairs.into_iter().map(|p| p.1).collect(), faults }
    }
}

/// Matches distinct keys.
pub(super) fn matches(
    matching: Match,
    case: bool,
    schedule: &Keys<'_, Entry>,
    model: &Keys<'_, Target>,
) -> Matches {
    let count = schedule.texts.len();
    let mut faults = Vec::new();
    let pairs = match matching {
        Match::Exact | Match::InOrder => (schedule.texts.iter().zip(0..))
            .filter_map(|(text, k)| Some((k, *model.index.get(text)?)))
            .collect(),
        Match::StartsWith => starting(&schedule.texts, &model.texts, &mut faults),
        // An automaton finds all keys of one side in a key of the other in one go.
        Match::Contains => finding(&schedule.texts, &model.texts, &mut faults),
        Match::Within => {
            let found = finding(&model.texts, &schedule.texts, &mut faults);
            found.into_iter().map(|(m, s)| (s, m)).collect()
        }
        Match::Regex => patterns(&schedule.texts, &model.texts, case, &mut faults),
    };
    Matches::from_pairs(pairs, count, faults)
}

/// Pairs of a beginning and a text that starts with it.
fn starting(
    beginnings: &[Cow<'_, str>],
    texts: &[Cow<'_, str>],
    faults: &mut Vec<String>,
) -> Vec<(u32, u32)> {
    let mut sorted: Vec<(&str, u32)> = texts.iter().map(|t| &**t).zip(0..).collect();
    sorted.par_sort_unstable();
    let mut pairs = Vec::new();
    for (beginning, b) in beginnings.iter().zip(0..) {
        let first = sorted.partition_point(|(text, _)| *text < &**beginning);
        for (_, t) in sorted[first..].iter().take_while(|(t, _)| t.starts_with(&**beginning)) {
            if pairs.len() == MOST_MATCHES {
                faults.push(too_many());
                return pairs;
            }
            pairs.push((b, *t));
        }
    }
    pairs
}

/// Pairs of a text that is sought and one that contains it.
fn finding(
    sought: &[Cow<'_, str>],
    texts: &[Cow<'_, str>],
    faults: &mut Vec<String>,
) -> Vec<(u32, u32)> {
    let bytes: usize = sought.iter().map(|s| s.len()).sum();
    let build = |sought: &[Cow<'_, str>]| {
        let kind = Some(AhoCorasickKind::NoncontiguousNFA);
        AhoCorasick::builder().kind(kind).build(sought.iter().map(|s| s.as_bytes()))
    };
    let automaton = (bytes <= MOST_SOUGHT).then(|| build(sought)).and_then(Result::ok);
    let Some(automaton) = automaton else {
        faults.push(format!("{bytes} bytes of distinct keys are too many to be looked for"));
        return Vec::new();
    };
    let mut pairs = Vec::new();
    // One that occurs often in a text is found as often.
    let mut last_found_in = vec![u32::MAX; sought.len()];
    for (text, t) in texts.iter().zip(0u32..) {
        for found in automaton.find_overlapping_iter(text.as_bytes()) {
            let s = found.pattern().as_u32();
            if std::mem::replace(&mut last_found_in[s as usize], t) == t {
                continue;
            }
            if pairs.len() == MOST_MATCHES {
                faults.push(too_many());
                return pairs;
            }
            pairs.push((s, t));
        }
    }
    pairs
}

/// Pairs of a pattern and a text in which it is found.
fn patterns(
    patterns: &[Cow<'_, str>],
    texts: &[Cow<'_, str>],
    case: bool,
    faults: &mut Vec<String>,
) -> Vec<(u32, u32)> {
    let bytes: usize = texts.iter().map(|t| t.len() + 1).sum();
    let most = MOST_TRIED.checked_div(bytes).unwrap_or(patterns.len());
    if patterns.len() > most {
        faults.push(format!(
            "{} distinct patterns are too many for {} distinct keys; the first {most} are tried",
            patterns.len(),
            texts.len()
        ));
    }
    let tried = &patterns[..patterns.len().min(most)];
    let mut pairs = Vec::new();
    // As many at a time as cannot find more than is kept of all of them.
    let portion = (MOST_MATCHES / texts.len().max(1)).max(1);
    for (n, tried) in tried.chunks(portion).enumerate() {
        let found: Vec<Result<Vec<u32>, String>> = (tried.par_iter())
            .map(|pattern| match compile(pattern, case) {
                Ok(regex) => {
                    let fits = texts.iter().zip(0u32..).filter(|(text, _)| regex.is_match(text));
                    Ok(fits.map(|(_, t)| t).collect())
                }
                Err(_) => Err(format!("the key {pattern:?} is no regular expression")),
            })
            .collect();
        for (found, p) in found.into_iter().zip((n * portion) as u32..) {
            match found {
                Ok(some) if pairs.len() + some.len() > MOST_MATCHES => {
                    faults.push(too_many());
                    return pairs;
                }
                Ok(some) => pairs.extend(some.into_iter().map(|t| (p, t))),
                Err(fault) => faults.push(fault),
            }
        }
    }
    pairs
}

fn too_many() -> String {
    format!("more than {MOST_MATCHES} pairs of keys match; what follows is left out")
}

/// The n-th thing of each key of the schedule meets the n-th element of that key: for each use of
/// the schedule the use of the model that it means.
pub(super) fn in_order(
    matches: &Matches,
    schedule: &Keys<'_, Entry>,
    model: &Keys<'_, Target>,
) -> Vec<Option<u32>> {
    let (model_starts, model_order) = model.by_key();
    let (starts, order) = schedule.by_key();
    let mut met = vec![None; schedule.uses.len()];
    for key in 0..schedule.texts.len() {
        let Some(&other) = matches.of(key as u32).first() else { continue };
        let elements = &model_order
            [model_starts[other as usize] as usize..model_starts[other as usize + 1] as usize];
        let is_element = |use_: &&u32| matches!(model.uses[**use_ as usize].2, Target::Element(_));
        let mut elements = elements.iter().filter(is_element);
        let mut of_identity: std::collections::HashMap<u32, Option<u32>> = Default::default();
        for &i in &order[starts[key] as usize..starts[key + 1] as usize] {
            let identity = schedule.uses[i as usize].2.identity;
            met[i as usize] =
                *of_identity.entry(identity).or_insert_with(|| elements.next().copied());
        }
    }
    met
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    fn keys<U: Copy>(texts: &[String], user: impl Fn(u32) -> U) -> Keys<'_, U> {
        let mut keys = Keys { texts: vec![], index: Default::default(), uses: vec![] };
        for text in texts.iter().filter(|t| !t.is_empty()) {
            let next = keys.texts.len() as u32;
            let id = *keys.index.entry(Cow::Borrowed(&**text)).or_insert(next);
            if id == next {
                keys.texts.push(Cow::Borrowed(&**text));
            }
            let number = keys.uses.len() as u32;
            keys.uses.push((id, 0, user(number)));
        }
        keys
    }

    proptest! {
        /// What the automaton, the sorted list and the hash map find is what a comparison of every
        /// pair finds.
        #[test]
        fn fast_matching_equals_comparing_all_pairs(
            ours in proptest::collection::vec("[ab]{0,4}", 0..12),
            theirs in proptest::collection::vec("[ab]{0,6}", 0..12),
        ) {
            let schedule =
                keys(&ours, |n| Entry { activity: n, element: 0, identity: n });
            let model = keys(&theirs, Target::Element);
            for (way, _) in [
                (Match::Exact, 0), (Match::StartsWith, 0), (Match::Contains, 0),
                (Match::Within, 0), (Match::Regex, 0),
            ] {
                let found = matches(way, true, &schedule, &model);
                prop_assert!(found.faults.is_empty());
                for (s, a) in schedule.texts.iter().enumerate() {
                    let obvious: Vec<u32> = (0..model.texts.len() as u32)
                        .filter(|&m| {
                            let e = &model.texts[m as usize];
                            match way {
                                Match::StartsWith => e.starts_with(&**a),
                                Match::Contains | Match::Regex => e.contains(&**a),
                                Match::Within => a.contains(&**e),
                                Match::Exact | Match::InOrder => e == a,
                            }
                        })
                        .collect();
                    prop_assert_eq!(found.of(s as u32), &obvious[..], "{:?}", way);
                }
            }
        }
    }

    #[test]
    fn patterns_that_are_none_are_said_and_the_others_count() {
        let ours = ["^wall-[0-9]+$".to_owned(), "(".to_owned()];
        let theirs = ["wall-12".to_owned(), "wall-x".to_owned()];
        let schedule = keys(&ours, |n| Entry { activity: n, element: 0, identity: n });
        let model = keys(&theirs, Target::Element);
        let found = matches(Match::Regex, true, &schedule, &model);
        assert_eq!(found.of(0), [0]);
        assert_eq!(found.faults, ["the key \"(\" is no regular expression"]);
    }
}
