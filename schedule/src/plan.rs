//! What ties activities together: predecessors, and the tree of summaries above them.

/// What of the predecessor what of the successor waits for.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum LinkKind {
    /// Finish to start.
    #[default]
    FinishStart,
    /// Start to start.
    StartStart,
    /// Finish to finish.
    FinishFinish,
    /// Start to finish.
    StartFinish,
}

impl LinkKind {
    /// The two letters that planners use.
    pub const WORDS: [(&'static str, LinkKind); 4] = [
        ("FS", LinkKind::FinishStart),
        ("SS", LinkKind::StartStart),
        ("FF", LinkKind::FinishFinish),
        ("SF", LinkKind::StartFinish),
    ];

    /// The kind that two letters mean, in whatever case.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(w, _)| w.eq_ignore_ascii_case(word)).map(|&(_, kind)| kind)
    }

    /// Two letters.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|&&(_, k)| k == self).expect("every kind has a word").0
    }
}

/// How much later than its predecessor something may happen; earlier where negative.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Lag {
    /// Seconds of working time, or of the clock if `elapsed`.
    pub seconds: i64,
    /// Whether nights and days off count too.
    pub elapsed: bool,
}

/// A link from another activity.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Predecessor {
    /// Index in [`crate::Schedule::activities`].
    pub activity: u32,
    /// What waits for what.
    pub kind: LinkKind,
    /// For how long.
    pub lag: Lag,
}

/// One summary of the outline (work breakdown structure).
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct WbsNode {
    /// Short name, unique at best among its neighbours.
    pub code: String,
    /// What the planner calls it.
    pub name: String,
    /// Index of the node above in [`crate::Schedule::wbs`]; always smaller than its own.
    pub parent: Option<u32>,
}
