//! Kinds of activities: what one does to the presence and to the look of its elements.

use crate::{Activity, Time, TimeRange};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What an activity does to the elements it is linked to.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum ActivityKind {
    /// Present from its start on.
    #[default]
    Construct,
    /// Absent from its end on.
    Demolish,
    /// Present from its start to its end.
    Temporary,
    /// Says nothing of presence, but is seen while it lasts.
    Maintain,
    /// Says nothing (inspect).
    Neutral,
    /// One that the planner defined: a place in [`Kinds::own`].
    Own(u8),
}

impl ActivityKind {
    /// The words that schedules use, the one that is written first.
    pub const WORDS: [(&'static str, ActivityKind); 6] = [
        ("construct", ActivityKind::Construct),
        ("demolish", ActivityKind::Demolish),
        ("temporary", ActivityKind::Temporary),
        ("maintain", ActivityKind::Maintain),
        ("neutral", ActivityKind::Neutral),
        ("inspect", ActivityKind::Neutral),
    ];

    /// The kind that a word in a schedule means, in whatever case; none that a planner defined.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(w, _)| w.eq_ignore_ascii_case(word)).map(|&(_, kind)| kind)
    }

    /// Its place in [`Kinds::iter`].
    pub fn index(self) -> usize {
        match self {
            ActivityKind::Construct => 0,
            ActivityKind::Demolish => 1,
            ActivityKind::Temporary => 2,
            ActivityKind::Maintain => 3,
            ActivityKind::Neutral => 4,
            ActivityKind::Own(i) => BUILT_IN.len() + usize::from(i),
        }
    }
}

/// A kind's name, whether elements are shown before, during and after, and their colour during.
type BuiltIn = (&'static str, [bool; 3], Option<[u8; 3]>);

/// The kinds that are always there, in the order of [`ActivityKind::index`].
const BUILT_IN: [BuiltIn; 5] = [
    // Colours that people tell apart who do not see red or green (Okabe and Ito).
    ("construct", [false, true, true], Some([0x00, 0x9E, 0x73])),
    ("demolish", [true, true, false], Some([0xD5, 0x5E, 0x00])),
    ("temporary", [false, true, false], Some([0xE6, 0x9F, 0x00])),
    ("maintain", [true, true, true], Some([0x00, 0x72, 0xB2])),
    ("neutral", [true, true, true], None),
];

/// How elements look that are there. The default is their own look.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Look {
    /// sRGB, in place of their own colours.
    pub color: Option<[u8; 3]>,
    /// In [0, 1], times that of their own colours; with 0 they are not drawn.
    pub opacity: f32,
}

impl Look {
    /// As the elements are.
    pub const OWN: Look = Look { color: None, opacity: 1.0 };

    /// One colour in place of the elements' own.
    pub const fn colored(color: [u8; 3]) -> Self {
        Look { color: Some(color), opacity: 1.0 }
    }

    /// Not drawn, though they are there.
    pub const HIDDEN: Look = Look { color: None, opacity: 0.0 };

    /// Whether they are not drawn.
    pub fn is_hidden(self) -> bool {
        self.opacity <= 0.0
    }

    /// Whether what is behind shines through.
    pub fn is_see_through(self) -> bool {
        self.opacity < 1.0
    }
}

impl Default for Look {
    fn default() -> Self {
        Self::OWN
    }
}

/// What an activity makes of its elements before, during or after it.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(try_from = "PhaseText", into = "PhaseText")]
pub enum Phase {
    /// They are not there.
    Hidden,
    /// They are there and look so.
    Shown(Look),
}

impl Phase {
    /// Whether elements are there.
    pub fn is_shown(self) -> bool {
        self != Phase::Hidden
    }

    /// How they look; their own look where they are hidden.
    pub fn look(self) -> Look {
        match self {
            Phase::Hidden => Look::OWN,
            Phase::Shown(look) => look,
        }
    }
}

/// A phase as JSON writes it: `"hidden"`, `"shown"`, or an object with colour, opacity or both.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum PhaseText {
    Word(String),
    Look {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        color: Option<String>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        opacity: Option<f32>,
    },
}

impl TryFrom<PhaseText> for Phase {
    type Error = String;

    fn try_from(text: PhaseText) -> Result<Self, String> {
        match text {
            PhaseText::Word(word) => match &*word.to_ascii_lowercase() {
                "hidden" => Ok(Phase::Hidden),
                "shown" => Ok(Phase::Shown(Look::OWN)),
                _ => Err(format!(
                    "{word:?} is neither \"hidden\" nor \"shown\" nor an object with color and opacity"
                )),
            },
            PhaseText::Look { color, opacity } => {
                let color = color.map(|text| {
                    read_color(&text)
                        .ok_or_else(|| format!("{text:?} is no colour such as #E69F00"))
                });
                let opacity = opacity.unwrap_or(1.0);
                if !(0.0..=1.0).contains(&opacity) {
                    return Err(format!("an opacity of {opacity} is not between 0 and 1"));
                }
                if opacity == 0.0 {
                    return Ok(Phase::Hidden);
                }
                Ok(Phase::Shown(Look { color: color.transpose()?, opacity }))
            }
        }
    }
}

impl From<Phase> for PhaseText {
    fn from(phase: Phase) -> Self {
        match phase {
            Phase::Hidden => PhaseText::Word("hidden".to_owned()),
            Phase::Shown(Look::OWN) => PhaseText::Word("shown".to_owned()),
            Phase::Shown(look) => PhaseText::Look {
                color: look.color.map(|[r, g, b]| format!("#{r:02X}{g:02X}{b:02X}")),
                opacity: look.is_see_through().then_some(look.opacity),
            },
        }
    }
}

/// `#E69F00` or `E69F00`.
fn read_color(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').unwrap_or(text);
    let all_digits = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
    let number = all_digits.then(|| u32::from_str_radix(digits, 16).ok())??;
    let [_, r, g, b] = number.to_be_bytes();
    Some([r, g, b])
}

/// A kind of activities by what its elements are before, during and after.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(from = "KindText")]
pub struct Kind {
    /// What schedules call it.
    pub name: String,
    /// Until the start.
    pub before: Phase,
    /// From the start to the end.
    pub during: Phase,
    /// From the end on.
    pub after: Phase,
}

/// A kind as JSON writes it; phases that are not given are those of the kind that is built in under
/// that name, else those of construct.
#[derive(Deserialize)]
struct KindText {
    name: String,
    before: Option<Phase>,
    during: Option<Phase>,
    after: Option<Phase>,
}

impl From<KindText> for Kind {
    fn from(text: KindText) -> Self {
        let built_in = Kinds::default();
        let like = ActivityKind::from_word(text.name.trim()).unwrap_or_default();
        let like = built_in.of(like).clone();
        Kind {
            before: text.before.unwrap_or(like.before),
            during: text.during.unwrap_or(like.during),
            after: text.after.unwrap_or(like.after),
            name: text.name,
        }
    }
}

impl Kind {
    /// Whether elements are there before, during and after.
    pub fn shown(&self) -> [bool; 3] {
        [self.before, self.during, self.after].map(Phase::is_shown)
    }

    /// Whether it has no say in when elements are there.
    pub fn is_neutral(&self) -> bool {
        self.shown() == [true; 3]
    }
}

/// The kinds of a schedule: those that are built in, and those that its planner defined.
#[derive(Clone, PartialEq, Debug)]
pub struct Kinds {
    all: Vec<Kind>,
}

impl Default for Kinds {
    /// Those that are built in alone.
    fn default() -> Self {
        let kind = |(name, shown, color): BuiltIn| {
            let phase = |shown| if shown { Phase::Shown(Look::OWN) } else { Phase::Hidden };
            let [before, during, after] = shown.map(phase);
            let during = match color {
                Some(color) => Phase::Shown(Look::colored(color)),
                None => during,
            };
            Kind { name: name.to_owned(), before, during, after }
        };
        Self { all: BUILT_IN.into_iter().map(kind).collect() }
    }
}

impl Kinds {
    /// Most kinds that a planner can define.
    pub const MOST_OWN: usize = 200;

    /// All kinds, those that are built in first.
    pub fn iter(&self) -> impl Iterator<Item = &Kind> {
        self.all.iter()
    }

    /// Those that the planner defined.
    pub fn own(&self) -> &[Kind] {
        &self.all[BUILT_IN.len()..]
    }

    /// Those that differ from what is built in: what a file has to say.
    pub fn to_write(&self) -> impl Iterator<Item = &Kind> {
        let built_in = Kinds::default();
        let known = move |i: usize, kind: &Kind| built_in.all.get(i) == Some(kind);
        self.all.iter().enumerate().filter(move |&(i, kind)| !known(i, kind)).map(|(_, kind)| kind)
    }

    /// What a kind means; construct for one that was never defined.
    pub fn of(&self, kind: ActivityKind) -> &Kind {
        self.all.get(kind.index()).unwrap_or(&self.all[0])
    }

    /// The kind that a word means, in whatever case.
    pub fn find(&self, word: &str) -> Option<ActivityKind> {
        let own = || {
            let at = self.own().iter().position(|k| k.name.eq_ignore_ascii_case(word))?;
            u8::try_from(at).ok().map(ActivityKind::Own)
        };
        ActivityKind::from_word(word).or_else(own)
    }

    /// Defines a kind, or redefines the one that is called so.
    ///
    /// # Errors
    /// In words, if it has no name, if there are too many, or if it is built in and elements would come
    /// or go at other times.
    pub fn define(&mut self, kind: Kind) -> Result<ActivityKind, String> {
        let name = kind.name.trim();
        if name.is_empty() {
            return Err("a kind has no name".to_owned());
        }
        if let Some(known) = self.find(name) {
            let built_in = !matches!(known, ActivityKind::Own(_));
            if built_in && kind.shown() != self.of(known).shown() {
                return Err(format!(
                    "the kind {name:?} is built in: its elements can look otherwise, but come and go as ever"
                ));
            }
            let name = std::mem::take(&mut self.all[known.index()].name);
            self.all[known.index()] = Kind { name, ..kind };
            return Ok(known);
        }
        let number = self.own().len();
        if number >= Self::MOST_OWN {
            return Err(format!("more than {} kinds; {name:?} is left out", Self::MOST_OWN));
        }
        self.all.push(Kind { name: name.to_owned(), ..kind });
        Ok(ActivityKind::Own(number as u8))
    }
}

/// How an element with these activities looks in the course of time, while it is there: the looks, each
/// with the instant from which on it holds, the first from [`Time::MIN`] on; neighbours differ.
///
/// Rule: of the activities that last, the one that started last counts, of several the one with the
/// greatest id; where none lasts, the one that ended last; where none has begun, the one that starts
/// first. Activities that leave elements their own look count like others, but for those of kinds
/// that neither change presence nor look. Inactive ones and those without usable dates never count.
pub fn appearance<'a>(
    kinds: &Kinds,
    activities: impl IntoIterator<Item = &'a Activity>,
) -> Vec<(Time, Look)> {
    let own = Phase::Shown(Look::OWN);
    let mut acting: Vec<(TimeRange, &str, &Kind)> = Vec::new();
    for activity in activities.into_iter().filter(|a| a.active) {
        let kind = kinds.of(activity.kind);
        let says_something = [kind.before, kind.during, kind.after].iter().any(|p| *p != own);
        if let Some(dates) = activity.dates().filter(|_| says_something) {
            acting.push((dates, &activity.id, kind));
        }
    }
    acting.sort_unstable_by_key(|&(dates, id, _)| (dates.start, std::cmp::Reverse(id)));
    let mut ends: Vec<usize> = (0..acting.len()).collect();
    ends.sort_unstable_by_key(|&i| (acting[i].0.end, acting[i].1));
    let mut instants: Vec<Time> = acting.iter().flat_map(|(d, ..)| [d.start, d.end]).collect();
    instants.sort_unstable();
    instants.dedup();

    let mut steps = vec![(Time::MIN, acting.first().map_or(Look::OWN, |a| a.2.before.look()))];
    let (mut begun, mut ended) = (0, 0);
    // Those that last, by start and id.
    let mut lasting: BTreeMap<(Time, &str), &Kind> = BTreeMap::new();
    for now in instants {
        while let Some((dates, id, kind)) = acting.get(begun).filter(|a| a.0.start <= now) {
            lasting.insert((dates.start, id), kind);
            begun += 1;
        }
        while let Some((dates, id, _)) = ends.get(ended).map(|&i| acting[i])
            && dates.end <= now
        {
            lasting.remove(&(dates.start, id));
            ended += 1;
        }
        let look = match lasting.last_key_value() {
            Some((_, kind)) => kind.during.look(),
            None => acting[ends[ended - 1]].2.after.look(),
        };
        if steps.last().is_some_and(|&(_, last)| last != look) {
            if steps.last().is_some_and(|&(time, _)| time == now) {
                steps.pop();
            }
            steps.push((now, look));
        }
    }
    steps
}
