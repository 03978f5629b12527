//! What a node's extras say about the element: exporters use many spellings of few ideas.

use serde_json::Value;

/// Lower-case keys, best first.
const GUID: &[&str] =
    &["guid", "globalid", "global_id", "ifcguid", "ifc_guid", "ifcglobalid", "uniqueid", "id"];
const KIND: &[&str] =
    &["ifctype", "ifcclass", "ifc_type", "ifc_class", "type", "class", "category"];
const STOREY: &[&str] = &["storey", "ifcstorey", "buildingstorey", "story", "level", "floor"];
const LABEL: &[&str] = &["ifcname", "ifc_name", "label", "longname"];

/// The known parts of extras; empty where nothing is said.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(super) struct Extras {
    pub guid: Option<String>,
    pub kind: String,
    pub storey: String,
    pub label: String,
}

impl Extras {
    pub(super) fn read(extras: Option<&Value>) -> Self {
        let Some(Value::Object(map)) = extras else {
            return Self::default();
        };
        let keys: Vec<(String, &Value)> =
            map.iter().map(|(k, v)| (k.to_ascii_lowercase(), v)).collect();
        let find = |names: &[&str]| {
            names
                .iter()
                .find_map(|name| keys.iter().filter(|(k, _)| k == name).find_map(|(_, v)| text(v)))
        };
        Self {
            guid: find(GUID),
            kind: find(KIND).unwrap_or_default(),
            storey: find(STOREY).unwrap_or_default(),
            label: find(LABEL).unwrap_or_default(),
        }
    }

    /// Whether this is a storey by its type.
    pub(super) fn is_storey(&self) -> bool {
        ["ifcbuildingstorey", "buildingstorey", "storey"]
            .iter()
            .any(|kind| self.kind.eq_ignore_ascii_case(kind))
    }
}

/// A text that says something, or a number as text.
fn text(value: &Value) -> Option<String> {
    match value {
        Value::String(s) => Some(s.trim()).filter(|s| !s.is_empty()).map(str::to_owned),
        Value::Number(n) => Some(n.to_string()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn read(json: &str) -> Extras {
        Extras::read(Some(&serde_json::from_str(json).unwrap()))
    }

    #[test]
    fn spellings_are_understood_and_the_best_one_wins() {
        let extras =
            read(r#"{"id": 7, "GlobalId": "0abc", "ifcType": "IfcWall", "type": "Basic"}"#);
        assert_eq!(extras.guid.as_deref(), Some("0abc"));
        assert_eq!(extras.kind, "IfcWall");
        assert_eq!(read(r#"{"id": 7, "level": 3}"#).guid.as_deref(), Some("7"));
        assert_eq!(read(r#"{"id": 7, "level": 3}"#).storey, "3");
        assert_eq!(read(r#"{"class": "column", "ifcName": null}"#).kind, "column");
        assert!(read(r#"{"type": "IfcBuildingStorey"}"#).is_storey());
    }

    #[test]
    fn anything_else_is_silence() {
        for json in
            ["3", "null", "[]", r#"{"guid": ""}"#, r#"{"guid": {"a": 1}}"#, r#"{"guid": " "}"#]
        {
            assert_eq!(read(json), Extras::default(), "{json}");
        }
    }
}
