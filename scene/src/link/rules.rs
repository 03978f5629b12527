//! Rules: saved statements of which keys of a schedule mean which elements, and links made by hand.

use regex::{Regex, RegexBuilder};
use serde_json::{Map, Value, json};

/// What the member `format` of a rules file says.
pub const FORMAT: &str = "topout-rules";
/// Memory that a compiled pattern may take; those that people write take some tens of kilobytes.
const PATTERN_BYTES: usize = 1 << 20;

/// How a schedule is linked to a model.
///
/// Rule: an element that an earlier rule linked is left to it unless the later rule says `also`.
/// Links made by hand come last: `detached` takes away, `attached` gives, and giving wins.
#[derive(Clone, PartialEq, Debug)]
pub struct Rules {
    /// The file's name for what is said of it, or empty.
    pub file: String,
    /// In order of precedence.
    pub rules: Vec<Rule>,
    /// Links that hold whatever the rules say.
    pub attached: Vec<HandLink>,
    /// Links that do not hold whatever the rules say.
    pub detached: Vec<HandLink>,
}

/// Elements of one activity, linked or unlinked by hand.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct HandLink {
    /// The activity's id.
    pub activity: String,
    /// Names or guids of elements, or of groups for all elements below them.
    pub elements: Vec<String>,
}

/// One statement of which keys mean which elements.
#[derive(Clone, PartialEq, Debug)]
pub struct Rule {
    /// What the user calls it; not empty.
    pub name: String,
    /// Keys of elements.
    pub element: ElementSide,
    /// Keys of activities.
    pub activity: ActivitySide,
    /// When two keys match.
    pub matching: Match,
    /// Whether upper and lower case differ.
    pub case: bool,
    /// Elements that earlier rules linked are linked too.
    pub also: bool,
}

/// Where the keys of elements come from.
#[derive(Clone, PartialEq, Debug)]
pub struct ElementSide {
    /// What of the element.
    pub by: ElementBy,
    /// Which part of that is the key.
    pub pattern: Option<Pattern>,
    /// Where not empty: only values (before the pattern) that are one of these, in which `*` stands
    /// for any text and `?` for any character.
    pub only: Vec<String>,
}

/// What of an element is its key. Groups have keys as well; they mean all elements below them.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum ElementBy {
    /// Node name and guid.
    NameOrGuid,
    /// Node name, and what people call it.
    Name,
    /// Guid.
    Guid,
    /// Values of a property; see [`crate::Model::property`].
    Property(String),
    /// Storey, and name and guid of its group.
    Storey,
    /// What it is (IfcWall).
    Type,
    /// Values of properties that name a layer.
    Layer,
}

/// Where the keys of activities come from.
#[derive(Clone, PartialEq, Debug)]
pub struct ActivitySide {
    /// What of the activity.
    pub by: ActivityBy,
    /// Which part of that is the key.
    pub pattern: Option<Pattern>,
    /// Whether it is a list of keys.
    pub list: List,
}

/// What of an activity is its key.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum ActivityBy {
    /// Its id.
    Id,
    /// An activity code.
    Code(String),
    /// Its name.
    Name,
    /// Names and codes of the summaries above it, and the codes joined by dots.
    Wbs,
    /// A field.
    Field(String),
    /// The entries of its elements.
    Elements,
    /// A column that says something of each of its elements, as event logs have.
    ElementField(String),
}

/// How one text holds several keys.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub enum List {
    /// It does not.
    #[default]
    No,
    /// At commas, semicolons, bars and line ends.
    Usual,
    /// At this separator.
    At(String),
}

/// When the key of an activity matches the key of an element.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Match {
    /// They are equal.
    #[default]
    Exact,
    /// The element's starts with the activity's.
    StartsWith,
    /// The element's contains the activity's.
    Contains,
    /// The activity's contains the element's.
    Within,
    /// The activity's is a pattern that is found in the element's.
    Regex,
    /// The n-th key of a text means the n-th element of that text: in the model's order and in that
    /// of the schedule, or by the number that a pattern's group `order` finds.
    InOrder,
}

impl Match {
    /// The words of rules files.
    pub const WORDS: [(&'static str, Match); 6] = [
        ("exact", Match::Exact),
        ("starts-with", Match::StartsWith),
        ("contains", Match::Contains),
        ("within", Match::Within),
        ("regex", Match::Regex),
        ("in-order", Match::InOrder),
    ];

    /// Its word.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|&&(_, m)| m == self).expect("every way has a word").0
    }
}

/// A regular expression that finds the key in a text: its group `key`, else its first unnamed group,
/// else all that it matches. A group `order` finds the number by which [`Match::InOrder`] counts.
#[derive(Clone, Debug)]
pub struct Pattern {
    regex: Regex,
    key: usize,
    order: Option<usize>,
}

impl PartialEq for Pattern {
    fn eq(&self, other: &Self) -> bool {
        self.regex.as_str() == other.regex.as_str()
    }
}

impl Pattern {
    /// Compiles a pattern.
    ///
    /// # Errors
    /// Where it is no regular expression or a compiled one of more than a megabyte.
    pub fn new(text: &str) -> Result<Self, regex::Error> {
        let regex = compile(text, true)?;
        let named = |name| regex.capture_names().position(|n| n == Some(name));
        let unnamed = || regex.capture_names().skip(1).position(|n| n.is_none()).map(|i| i + 1);
        let (key, order) = (named("key").or_else(unnamed).unwrap_or(0), named("order"));
        Ok(Self { regex, key, order })
    }

    /// As it is written.
    pub fn as_str(&self) -> &str {
        self.regex.as_str()
    }

    /// Whether it finds a number to count by.
    pub fn has_order(&self) -> bool {
        self.order.is_some()
    }

    /// The key in a text, and its number if it has one.
    pub(super) fn find<'a>(&self, text: &'a str) -> Option<(&'a str, Option<u64>)> {
        if self.key == 0 && self.order.is_none() {
            return self.regex.find(text).map(|m| (m.as_str(), None));
        }
        let found = self.regex.captures(text)?;
        let order = self.order.and_then(|o| found.get(o)).and_then(|m| m.as_str().parse().ok());
        found.get(self.key).map(|m| (m.as_str(), order))
    }
}

/// A regular expression of bounded size.
pub(super) fn compile(text: &str, case: bool) -> Result<Regex, regex::Error> {
    RegexBuilder::new(text).case_insensitive(!case).size_limit(PATTERN_BYTES).build()
}

impl Default for Rules {
    /// Entries of elements are node names or guids, and nothing else links.
    fn default() -> Self {
        Self {
            file: String::new(),
            rules: vec![Rule::standard()],
            attached: Vec::new(),
            detached: Vec::new(),
        }
    }
}

impl Rules {
    /// Whether the entries of elements alone decide: nothing else of an activity changes its links.
    pub fn only_elements(&self) -> bool {
        self.rules.iter().all(|rule| rule.activity.by == ActivityBy::Elements)
    }

    /// Links an element by its name or guid to an activity by hand.
    pub fn attach(&mut self, activity: &str, element: &str) {
        unlist(&mut self.detached, activity, element);
        list(&mut self.attached, activity, element);
    }

    /// Unlinks an element from an activity by hand.
    pub fn detach(&mut self, activity: &str, element: &str) {
        unlist(&mut self.attached, activity, element);
        list(&mut self.detached, activity, element);
    }

    /// The file's text; [`Rules::parse`] reads it back.
    pub fn to_json(&self) -> String {
        let links = |links: &[HandLink]| -> Value {
            let link = |l: &HandLink| json!({ "activity": l.activity, "elements": l.elements });
            links.iter().map(link).collect()
        };
        let rules: Vec<Value> = self.rules.iter().map(Rule::to_value).collect();
        let value = json!({
            "format": FORMAT,
            "version": 1,
            "rules": rules,
            "attached": links(&self.attached),
            "detached": links(&self.detached),
        });
        let mut text = serde_json::to_string_pretty(&value).expect("texts and lists are JSON");
        text.push('\n');
        text
    }
}

fn list(links: &mut Vec<HandLink>, activity: &str, element: &str) {
    let link = match links.iter().position(|link| link.activity == activity) {
        Some(place) => &mut links[place],
        None => {
            links.push(HandLink { activity: activity.to_owned(), elements: Vec::new() });
            links.last_mut().expect("it was pushed")
        }
    };
    if !link.elements.iter().any(|e| e == element) {
        link.elements.push(element.to_owned());
    }
}

fn unlist(links: &mut Vec<HandLink>, activity: &str, element: &str) {
    for link in links.iter_mut().filter(|link| link.activity == activity) {
        link.elements.retain(|e| e != element);
    }
    links.retain(|link| !link.elements.is_empty());
}

impl Rule {
    /// The rule that counts where there is no file.
    pub fn standard() -> Self {
        Self::new("elements", ElementBy::NameOrGuid, ActivityBy::Elements, Match::Exact)
    }

    /// A rule without patterns, case-sensitive.
    pub fn new(name: &str, element: ElementBy, activity: ActivityBy, matching: Match) -> Self {
        Self {
            name: name.to_owned(),
            element: ElementSide { by: element, pattern: None, only: Vec::new() },
            activity: ActivitySide { by: activity, pattern: None, list: List::No },
            matching,
            case: true,
            also: false,
        }
    }

    /// As it stands in the file's list.
    pub fn to_value(&self) -> Value {
        let mut element = Map::new();
        element.insert("by".into(), self.element.by.word().into());
        if let ElementBy::Property(key) = &self.element.by {
            element.insert("property".into(), key.as_str().into());
        }
        insert_pattern(&mut element, &self.element.pattern);
        if !self.element.only.is_empty() {
            element.insert("only".into(), json!(self.element.only));
        }
        let mut activity = Map::new();
        activity.insert("by".into(), self.activity.by.word().into());
        if let ActivityBy::Code(f) | ActivityBy::Field(f) | ActivityBy::ElementField(f) =
            &self.activity.by
        {
            activity.insert("field".into(), f.as_str().into());
        }
        match &self.activity.list {
            List::No => {}
            List::Usual => drop(activity.insert("list".into(), true.into())),
            List::At(at) => drop(activity.insert("list".into(), at.as_str().into())),
        }
        insert_pattern(&mut activity, &self.activity.pattern);
        let mut rule = Map::new();
        rule.insert("name".into(), self.name.as_str().into());
        rule.insert("element".into(), element.into());
        rule.insert("activity".into(), activity.into());
        rule.insert("match".into(), self.matching.word().into());
        if !self.case {
            rule.insert("case".into(), false.into());
        }
        if self.also {
            rule.insert("also".into(), true.into());
        }
        rule.into()
    }
}

fn insert_pattern(side: &mut Map<String, Value>, pattern: &Option<Pattern>) {
    if let Some(pattern) = pattern {
        side.insert("pattern".into(), pattern.as_str().into());
    }
}

impl ElementBy {
    /// The words of rules files.
    pub const WORDS: [&'static str; 7] =
        ["name-or-guid", "name", "guid", "property", "storey", "type", "layer"];

    /// Its word.
    pub fn word(&self) -> &'static str {
        Self::WORDS[match self {
            Self::NameOrGuid => 0,
            Self::Name => 1,
            Self::Guid => 2,
            Self::Property(_) => 3,
            Self::Storey => 4,
            Self::Type => 5,
            Self::Layer => 6,
        }]
    }
}

impl std::fmt::Display for ElementBy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NameOrGuid => f.write_str("name or guid"),
            Self::Property(key) => write!(f, "property {key:?}"),
            _ => f.write_str(self.word()),
        }
    }
}

impl ActivityBy {
    /// The words of rules files.
    pub const WORDS: [&'static str; 7] =
        ["id", "code", "name", "wbs", "field", "elements", "element-field"];

    /// Its word.
    pub fn word(&self) -> &'static str {
        Self::WORDS[match self {
            Self::Id => 0,
            Self::Code(_) => 1,
            Self::Name => 2,
            Self::Wbs => 3,
            Self::Field(_) => 4,
            Self::Elements => 5,
            Self::ElementField(_) => 6,
        }]
    }
}

impl std::fmt::Display for ActivityBy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Code(name) => write!(f, "code {name:?}"),
            Self::Field(name) => write!(f, "field {name:?}"),
            Self::ElementField(name) => write!(f, "element field {name:?}"),
            _ => f.write_str(self.word()),
        }
    }
}
