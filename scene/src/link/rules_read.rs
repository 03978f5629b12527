//! Reading rules files: what is wrong is named with file, place and value.

use super::rules::{
    ActivityBy, ActivitySide, ElementBy, ElementSide, FORMAT, HandLink, List, Match, Pattern, Rule,
    Rules,
};
use serde_json::{Map, Value};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Bytes of a rules file; a million links by hand fit in.
pub const MOST_BYTES: u64 = 1 << 26;
/// Rules of a file.
pub const MOST_RULES: usize = 1000;
/// Bytes of a pattern, a name or a separator.
pub const LONGEST_TEXT: usize = 10_000;

/// Why a rules file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RulesError {
    /// The file cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is larger than any rules file.
    #[error("{}: {bytes} bytes; a rules file has at most {MOST_BYTES}", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// It is no JSON.
    #[error("{file}: line {line}, column {column}: {message}")]
    Json {
        /// The file.
        file: String,
        /// From 1.
        line: usize,
        /// From 1.
        column: usize,
        /// What is wrong there.
        message: String,
    },
    /// It is JSON that says no rules.
    #[error("{file}: {place}: {message}, but it is {value}")]
    Invalid {
        /// The file.
        file: String,
        /// Where, such as `rules[2].element.by`.
        place: String,
        /// What stands there, shortened.
        value: String,
        /// What should stand there.
        message: String,
    },
}

impl Rules {
    /// Reads a rules file.
    ///
    /// # Errors
    /// See [`RulesError`]; each names the file, and the place and value where there is one.
    pub fn read(path: &Path) -> Result<Self, RulesError> {
        let io = |source| RulesError::Io { path: path.to_owned(), source };
        let bytes = std::fs::metadata(path).map_err(io)?.len();
        if bytes > MOST_BYTES {
            return Err(RulesError::TooLarge { path: path.to_owned(), bytes });
        }
        let text = std::fs::read_to_string(path).map_err(io)?;
        Self::parse(&text, &path.display().to_string())
    }

    /// Reads a file's text. Without a list `rules` the standard rule counts.
    ///
    /// # Errors
    /// As [`Rules::read`].
    pub fn parse(text: &str, file: &str) -> Result<Self, RulesError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let value: Value = serde_json::from_str(text).map_err(|error| {
            let message = error.to_string();
            let message = message.split(" at line ").next().unwrap_or_default().to_owned();
            let (line, column) = (error.line(), error.column());
            RulesError::Json { file: file.to_owned(), line, column, message }
        })?;
        let top = At { file, place: String::new(), value: &value };
        let map = top.object(&["format", "version", "rules", "attached", "detached"])?;
        for (name, known) in [("format", Value::from(FORMAT)), ("version", Value::from(1))] {
            let given = top.member(map, name);
            if let Some(given) = given.filter(|given| *given.value != known) {
                return Err(given.fault(format!("it must be {known}")));
            }
        }
        if top.member(map, "format").is_none() {
            return Err(top.fault(format!("it needs a \"format\": {FORMAT:?}")));
        }
        let rules = match top.member(map, "rules") {
            Some(list) => read_rules(&list)?,
            None => vec![Rule::standard()],
        };
        let links = |name| match top.member(map, name) {
            Some(list) => list.list()?.iter().map(hand_link).collect(),
            None => Ok(Vec::new()),
        };
        let (attached, detached) = (links("attached")?, links("detached")?);
        Ok(Self { file: file.to_owned(), rules, attached, detached })
    }
}

fn read_rules(list: &At<'_>) -> Result<Vec<Rule>, RulesError> {
    let entries = list.list()?;
    if entries.len() > MOST_RULES {
        return Err(list.fault(format!("a file has at most {MOST_RULES} rules")));
    }
    let mut names = HashSet::new();
    let mut rules = Vec::with_capacity(entries.len());
    for (number, entry) in entries.iter().enumerate() {
        let rule = rule(entry, number)?;
        if !names.insert(rule.name.clone()) {
            return Err(entry.fault(format!("a rule named {:?} stands before", rule.name)));
        }
        rules.push(rule);
    }
    Ok(rules)
}

fn rule(at: &At<'_>, number: usize) -> Result<Rule, RulesError> {
    let map = at.object(&["name", "element", "activity", "match", "case", "also"])?;
    let name = match at.member(map, "name") {
        Some(name) => name.text()?.to_owned(),
        None => format!("rule {}", number + 1),
    };
    let matching = match at.member(map, "match") {
        Some(word) => {
            let given = word.text()?;
            let found = Match::WORDS.iter().find(|(w, _)| *w == given);
            found.ok_or_else(|| word.fault_words(&Match::WORDS.map(|w| w.0)))?.1
        }
        None => Match::Exact,
    };
    let flag = |name, usual| at.member(map, name).map_or(Ok(usual), |value| value.flag());
    Ok(Rule {
        name,
        element: element_side(&at.needed(map, "element")?)?,
        activity: activity_side(&at.needed(map, "activity")?)?,
        matching,
        case: flag("case", true)?,
        also: flag("also", false)?,
    })
}

fn element_side(at: &At<'_>) -> Result<ElementSide, RulesError> {
    let map = at.object(&["by", "property", "pattern", "only"])?;
    let word = at.needed(map, "by")?;
    let by = match word.text()? {
        "name-or-guid" => ElementBy::NameOrGuid,
        "name" => ElementBy::Name,
        "guid" => ElementBy::Guid,
        "property" => ElementBy::Property(at.needed(map, "property")?.text()?.to_owned()),
        "storey" => ElementBy::Storey,
        "type" => ElementBy::Type,
        "layer" => ElementBy::Layer,
        _ => return Err(word.fault_words(&ElementBy::WORDS)),
    };
    let property = at.member(map, "property").filter(|_| !matches!(by, ElementBy::Property(_)));
    if let Some(property) = property {
        return Err(property.fault("it counts only beside \"by\": \"property\""));
    }
    let only = match at.member(map, "only") {
        Some(list) => {
            let texts = list.list()?;
            texts.iter().map(|t| t.text().map(str::to_owned)).collect::<Result<_, _>>()?
        }
        None => Vec::new(),
    };
    Ok(ElementSide { by, pattern: pattern(at, map)?, only })
}

fn activity_side(at: &At<'_>) -> Result<ActivitySide, RulesError> {
    let map = at.object(&["by", "field", "list", "pattern"])?;
    let word = at.needed(map, "by")?;
    let field =
        || -> Result<String, RulesError> { Ok(at.needed(map, "field")?.text()?.to_owned()) };
    let by = match word.text()? {
        "id" => ActivityBy::Id,
        "code" => ActivityBy::Code(field()?),
        "name" => ActivityBy::Name,
        "wbs" => ActivityBy::Wbs,
        "field" => ActivityBy::Field(field()?),
        "elements" => ActivityBy::Elements,
        "element-field" => ActivityBy::ElementField(field()?),
        _ => return Err(word.fault_words(&ActivityBy::WORDS)),
    };
    let named =
        matches!(by, ActivityBy::Code(_) | ActivityBy::Field(_) | ActivityBy::ElementField(_));
    if let Some(field) = at.member(map, "field").filter(|_| !named) {
        let words = "\"code\", \"field\" or \"element-field\"";
        return Err(field.fault(format!("it counts only beside \"by\": {words}")));
    }
    let list = match at.member(map, "list") {
        None => List::No,
        Some(At { value: Value::Bool(yes), .. }) => {
            if *yes {
                List::Usual
            } else {
                List::No
            }
        }
        Some(other) => List::At(match other.value {
            Value::String(text) if !text.is_empty() => other.text()?.to_owned(),
            _ => return Err(other.fault("it must be true, false or a separator")),
        }),
    };
    Ok(ActivitySide { by, pattern: pattern(at, map)?, list })
}

fn pattern(side: &At<'_>, map: &Map<String, Value>) -> Result<Option<Pattern>, RulesError> {
    let Some(at) = side.member(map, "pattern") else { return Ok(None) };
    match Pattern::new(at.text()?) {
        Ok(pattern) => Ok(Some(pattern)),
        Err(error) => {
            let said = match error {
                regex::Error::CompiledTooBig(_) => "the pattern is too large".to_owned(),
                // The last line says what is wrong; those before repeat the pattern.
                other => {
                    let text = other.to_string();
                    let last = text.lines().last().unwrap_or_default().to_owned();
                    format!("not a regular expression ({})", last.trim_start_matches("error: "))
                }
            };
            Err(at.fault(said))
        }
    }
}

fn hand_link(at: &At<'_>) -> Result<HandLink, RulesError> {
    let map = at.object(&["activity", "elements"])?;
    let activity = at.needed(map, "activity")?.text()?.to_owned();
    let elements = at.needed(map, "elements")?;
    let elements = elements.list()?;
    let elements =
        elements.iter().map(|e| e.text().map(str::to_owned)).collect::<Result<_, _>>()?;
    Ok(HandLink { activity, elements })
}

/// A value and where it stands.
struct At<'a> {
    file: &'a str,
    place: String,
    value: &'a Value,
}

impl<'a> At<'a> {
    /// The members of an object that has these at most.
    fn object(&self, known: &[&str]) -> Result<&'a Map<String, Value>, RulesError> {
        let Value::Object(map) = self.value else {
            return Err(self.fault("it must be an object"));
        };
        match map.keys().find(|key| !known.contains(&key.as_str())) {
            None => Ok(map),
            Some(key) => {
                let other = At { place: self.below(key), value: &map[key], file: self.file };
                Err(other.fault(format!("unknown field (known: {})", known.join(", "))))
            }
        }
    }

    fn below(&self, name: &str) -> String {
        let name = shortened(name);
        if self.place.is_empty() { name } else { format!("{}.{name}", self.place) }
    }

    fn member(&self, map: &'a Map<String, Value>, name: &str) -> Option<At<'a>> {
        let value = map.get(name)?;
        Some(At { file: self.file, place: self.below(name), value })
    }

    fn needed(&self, map: &'a Map<String, Value>, name: &str) -> Result<At<'a>, RulesError> {
        self.member(map, name).ok_or_else(|| self.fault(format!("it needs a {name:?}")))
    }

    fn list(&self) -> Result<Vec<At<'a>>, RulesError> {
        let Value::Array(list) = self.value else {
            return Err(self.fault("it must be a list"));
        };
        let entry =
            |(i, value)| At { file: self.file, place: format!("{}[{i}]", self.place), value };
        Ok(list.iter().enumerate().map(entry).collect())
    }

    fn text(&self) -> Result<&'a str, RulesError> {
        match self.value {
            Value::String(text) if text.is_empty() => Err(self.fault("it must not be empty")),
            Value::String(text) if text.len() > LONGEST_TEXT => {
                Err(self.fault(format!("it must have at most {LONGEST_TEXT} bytes")))
            }
            Value::String(text) => Ok(text),
            _ => Err(self.fault("it must be a text")),
        }
    }

    fn flag(&self) -> Result<bool, RulesError> {
        self.value.as_bool().ok_or_else(|| self.fault("it must be true or false"))
    }

    fn fault_words(&self, words: &[&str]) -> RulesError {
        self.fault(format!("it must be one of {}", words.join(", ")))
    }

    fn fault(&self, message: impl Into<String>) -> RulesError {
        RulesError::Invalid {
            file: self.file.to_owned(),
            place: if self.place.is_empty() { "the file".into() } else { self.place.clone() },
            value: described(self.value),
            message: message.into(),
        }
    }
}

/// A value for a message: long ones are shortened, lists and objects said by their size.
fn described(value: &Value) -> String {
    match value {
        Value::Array(list) => format!("a list of {}", list.len()),
        Value::Object(map) => {
            let names: Vec<String> = map.keys().take(8).map(|k| shortened(k)).collect();
            format!("an object with {{{}}}", names.join(", "))
        }
        Value::String(text) => format!("{:?}", shortened(text)),
        other => other.to_string(),
    }
}

fn shortened(text: &str) -> String {
    match text.char_indices().nth(80) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}
