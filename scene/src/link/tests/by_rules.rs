//! Rules: each way of matching, precedence, links by hand, and what is said of a file.

use super::{activity, element, group, linked};
use crate::link::{Resync, Rules, RulesError, link, link_by};
use crate::properties::Builder;
use crate::{Element, ElementId, Group, Model, Scene};
use proptest::prelude::*;
use serde_json::{Value, json};
use topout_schedule::{Activity, Diagnostics, ElementField, Schedule, WbsNode};

fn rules(text: &Value) -> Rules {
    Rules::parse(&text.to_string(), "r.json").unwrap()
}

fn rule(element: Value, activity: Value, more: Value) -> Value {
    let mut rule = json!({ "element": element, "activity": activity });
    rule.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    rule
}

fn file(rules: &[Value]) -> Value {
    json!({ "format": "topout-rules", "version": 1, "rules": rules })
}

fn scene_of(rules_text: &Value, model: &Model, activities: &[Activity]) -> Scene {
    let schedule = Schedule::new(String::new(), None, activities.to_vec(), Diagnostics::default());
    link_by(rules(rules_text), model.clone(), schedule)
}

fn all_linked(scene: &Scene) -> Vec<String> {
    (0..scene.model.elements.len() as u32).map(|e| linked(scene, e).join(" ")).collect()
}

fn model(elements: Vec<Element>, groups: Vec<Group>, properties: &[&[(&str, &str)]]) -> Model {
    let mut builder = Builder::default();
    for entries in properties {
        entries.iter().for_each(|(k, v)| builder.say(k, v));
        builder.end_element();
    }
    let properties = builder.finish().0;
    Model { elements, groups, properties, ..Model::default() }
}

fn walls() -> Model {
    let wall = |name: &str, storey: &str, kind: &str| Element {
        storey: storey.into(),
        kind: kind.into(),
        ..element(name, Some(&format!("guid-{name}")), None)
    };
    model(
        vec![
            wall("W-01", "Level 1", "IfcWall"),
            wall("W-02", "Level 2", "IfcWall"),
            wall("S-01", "Level 1", "IfcSlab"),
            wall("w-01", "", "IfcWallStandardCase"),
        ],
        vec![],
        &[
            &[("Zone", "A"), ("Layer", "A-WALL")],
            &[("Zone", "A"), ("Zone", "B")],
            &[("Pset.Zone", "A"), ("Layer", "A-SLAB")],
            &[],
        ],
    )
}

fn named(id: &str, name: &str) -> Activity {
    Activity { name: name.into(), ..activity(id, 0, 1, &[]) }
}

fn fielded(id: &str, fields: &[(&str, &str)]) -> Activity {
    let fields = fields.iter().map(|&(n, v)| (n.into(), v.into())).collect();
    Activity { fields, ..activity(id, 0, 1, &[]) }
}

#[test]
fn each_side_of_an_element_is_a_key() {
    let activities = [
        fielded("A", &[("key", "A")]),
        fielded("B", &[("key", "W-01")]),
        fielded("C", &[("key", "guid-S-01")]),
        fielded("D", &[("key", "Level 1")]),
        fielded("E", &[("key", "IfcWall")]),
        fielded("F", &[("KEY", "ignored"), ("key", "A-SLAB")]),
    ];
    let by = |element: Value| {
        let text = file(&[rule(element, json!({"by": "field", "field": "key"}), json!({}))]);
        all_linked(&scene_of(&text, &walls(), &activities))
    };
    assert_eq!(by(json!({"by": "name"})), ["B", "", "", ""]);
    assert_eq!(by(json!({"by": "guid"})), ["", "", "C", ""]);
    assert_eq!(by(json!({"by": "name-or-guid"})), ["B", "", "C", ""]);
    assert_eq!(by(json!({"by": "storey"})), ["D", "", "D", ""]);
    assert_eq!(by(json!({"by": "type"})), ["E", "E", "", ""]);
    assert_eq!(by(json!({"by": "layer"})), ["", "", "F", ""]);
    assert_eq!(by(json!({"by": "property", "property": "Zone"})), ["A", "A", "", ""]);
    assert_eq!(by(json!({"by": "property", "property": "Pset.Zone"})), ["", "", "A", ""]);
}

#[test]
fn each_side_of_an_activity_is_a_key() {
    let mut one = fielded("W-01", &[("Code", "W-02"), ("Refs", "S-01, w-01;W-02")]);
    one.name = "S-01".into();
    one.wbs = Some(1);
    one.elements = vec!["w-01".into()];
    let node =
        |code: &str, name: &str, parent| WbsNode { code: code.into(), name: name.into(), parent };
    let by = |side: Value| {
        let text = file(&[rule(json!({"by": "name"}), side, json!({}))]);
        let schedule = Schedule {
            activities: vec![one.clone()],
            wbs: vec![node("W-02", "", None), node("2", "S-01", Some(0))],
            ..Schedule::default()
        };
        let scene = link_by(rules(&text), walls(), schedule);
        let all = all_linked(&scene);
        all.iter().map(|l| !l.is_empty()).collect::<Vec<_>>()
    };
    assert_eq!(by(json!({"by": "id"})), [true, false, false, false]);
    assert_eq!(by(json!({"by": "name"})), [false, false, true, false]);
    assert_eq!(by(json!({"by": "code", "field": "Code"})), [false, true, false, false]);
    assert_eq!(by(json!({"by": "code", "field": "CODE"})), [false, true, false, false]);
    assert_eq!(by(json!({"by": "wbs"})), [false, true, true, false]);
    assert_eq!(by(json!({"by": "elements"})), [false, false, false, true]);
    let refs = |list: Value| by(json!({"by": "field", "field": "Refs", "list": list}));
    assert_eq!(refs(json!(true)), [false, true, true, true]);
    assert_eq!(refs(json!(", ")), [false, false, true, false]);
    assert_eq!(refs(json!(false)), [false; 4]);
}

#[test]
fn each_way_of_matching() {
    let activities = [named("A", "W-0"), named("B", "pour S-01 today"), named("C", "^.-01$")];
    let by = |way: &str, case: bool| {
        let more = json!({"match": way, "case": case});
        let text = file(&[rule(json!({"by": "name"}), json!({"by": "name"}), more)]);
        all_linked(&scene_of(&text, &walls(), &activities))
    };
    assert_eq!(by("starts-with", true), ["A", "A", "", ""]);
    assert_eq!(by("starts-with", false), ["A", "A", "", "A"]);
    assert_eq!(by("contains", true), ["A", "A", "", ""]);
    assert_eq!(by("within", true), ["", "", "B", ""]);
    assert_eq!(by("regex", true), ["A C", "A", "C", "C"]);
    let text = file(&[rule(json!({"by": "name"}), json!({"by": "id"}), json!({"case": false}))]);
    let scene = scene_of(&text, &walls(), &[named("W-01", "")]);
    assert_eq!(all_linked(&scene), ["W-01", "", "", "W-01"], "both spellings");
}

#[test]
fn patterns_take_the_key_out_and_only_leaves_others_out() {
    let side = json!({"by": "name", "pattern": "^[A-Z]-(\\d+)$", "only": ["W-*"]});
    let activity = json!({"by": "name", "pattern": "wall (?<key>\\d+)( of (.*))?"});
    let text = file(&[rule(side, activity, json!({}))]);
    let activities = [named("A", "build wall 01 of 2"), named("B", "wall 02"), named("C", "01")];
    let scene = scene_of(&text, &walls(), &activities);
    assert_eq!(all_linked(&scene), ["A", "B", "", ""]);
    let report = &scene.rule_reports[0];
    assert_eq!((report.name.as_str(), report.elements, report.activities), ("rule 1", 2, 2));
    assert_eq!((report.keys, report.keys_left, report.links), (2, 0, 2));
    assert_eq!(report.examples[0], ("W-01".to_owned(), "A".to_owned()));
}

#[test]
fn the_first_rule_keeps_its_elements_unless_the_later_says_also() {
    let first = rule(json!({"by": "name"}), json!({"by": "name"}), json!({"name": "first"}));
    let second = |also: bool| {
        rule(json!({"by": "storey"}), json!({"by": "name"}), json!({"name": "2nd", "also": also}))
    };
    let activities = [named("A", "W-01"), named("B", "Level 1"), named("C", "W-01")];
    let scene = scene_of(&file(&[first.clone(), second(false)]), &walls(), &activities);
    assert_eq!(all_linked(&scene), ["A C", "", "B", ""]);
    assert_eq!((scene.rule_reports[1].elements, scene.rule_reports[1].left_to_earlier), (1, 1));
    let scene = scene_of(&file(&[first, second(true)]), &walls(), &activities);
    assert_eq!(all_linked(&scene), ["A B C", "", "B", ""]);
    assert_eq!(scene.rule_reports[1].left_to_earlier, 0);
    assert_eq!(scene.rule_reports[0].keys_left, 1);
    assert_eq!(scene.rule_reports[0].examples_left, ["Level 1"]);
}

#[test]
fn in_order_the_nth_means_the_nth() {
    let elements = ["door", "wall", "door", "door", "wall"];
    let model = model(elements.iter().map(|n| element(n, None, None)).collect(), vec![], &[]);
    let by = |side: Value, names: &[&str]| {
        let text = file(&[rule(json!({"by": "name"}), side, json!({"match": "in-order"}))]);
        let activities: Vec<Activity> =
            names.iter().enumerate().map(|(i, n)| named(&format!("{i}"), n)).collect();
        scene_of(&text, &model, &activities)
    };
    let scene = by(json!({"by": "name"}), &["wall", "door", "door", "wall", "wall", "roof"]);
    assert_eq!(all_linked(&scene), ["1", "0", "2", "", "3"]);
    assert_eq!(scene.rule_reports[0].examples_left, ["wall", "roof"], "a third wall, and a roof");
    // By number; equal texts mean one thing.
    let side = json!({"by": "name", "pattern": "^(.*)_\\(#(?<order>\\d+)\\)$"});
    let names = ["door_(#30)", "door_(#7)", "wall_(#2)", "door_(#30)", "door_(#100)"];
    assert_eq!(all_linked(&by(side, &names)), ["1", "2", "0 3", "4", ""]);
}

/// Elements of a log have ids of its own; a column says which they are.
#[test]
fn a_column_of_a_log_says_which_elements_are_meant() {
    let field = |values: &[&str]| ElementField {
        name: "Mark".into(),
        values: values.iter().map(|&v| v.into()).collect(),
    };
    let mut activities =
        [activity("A", 0, 1, &["x1", "x2"]), activity("B", 1, 2, &["x2", "x3", "x4"])];
    activities[0].element_fields = vec![field(&["W-01", "door"])];
    activities[1].element_fields = vec![field(&["door", "", "door"])];
    let by = |field: &str, way: &str, model: &Model| {
        let side = json!({"by": "element-field", "field": field});
        let text = file(&[rule(json!({"by": "name"}), side, json!({"match": way}))]);
        all_linked(&scene_of(&text, model, &activities))
    };
    assert_eq!(by("mark", "exact", &walls()), ["A", "", "", ""], "whatever the case of the name");
    // The second row of x2 is no second door.
    let names = ["door", "W-01", "door", "door"];
    let doors = model(names.iter().map(|n| element(n, None, None)).collect(), vec![], &[]);
    assert_eq!(by("Mark", "in-order", &doors), ["A B", "A", "B", ""]);
    assert_eq!(by("Mark", "exact", &doors), ["A B", "A", "A B", "A B"]);
    assert_eq!(by("None", "exact", &doors), ["", "", "", ""]);
}

#[test]
fn groups_link_what_is_below_by_name_and_property() {
    let groups = vec![
        Group {
            kind: "IfcBuildingStorey".into(),
            label: "Level 9".into(),
            ..group("g", None, None)
        },
        group("room", None, Some(0)),
    ];
    let elements = vec![element("a", None, Some(1)), element("b", None, Some(0))];
    let mut model = model(elements, groups, &[&[], &[]]);
    let mut builder = Builder::default();
    (0..2).for_each(|_| builder.end_element());
    builder.end_elements();
    builder.end_group();
    builder.say("Use", "Office");
    builder.end_group();
    model.properties = builder.finish().0;
    let by = |side: Value, name: &str| {
        let text = file(&[rule(side, json!({"by": "name"}), json!({}))]);
        all_linked(&scene_of(&text, &model, &[named("A", name)]))
    };
    assert_eq!(by(json!({"by": "name"}), "Level 9"), ["A", "A"]);
    assert_eq!(by(json!({"by": "storey"}), "g"), ["A", "A"]);
    assert_eq!(by(json!({"by": "property", "property": "Use"}), "Office"), ["A", ""]);
}

#[test]
fn links_by_hand_win_over_all_rules() {
    let mut text = file(&[rule(json!({"by": "storey"}), json!({"by": "name"}), json!({}))]);
    text["detached"] = json!([{"activity": "B", "elements": ["guid-W-01", "W-02"]}]);
    text["attached"] = json!([
        {"activity": "A", "elements": ["w-01", "gone"]}, {"activity": "Z", "elements": ["W-02"]}
    ]);
    let activities = [named("A", "Level 2"), named("B", "Level 1")];
    let scene = scene_of(&text, &walls(), &activities);
    assert_eq!(all_linked(&scene), ["", "A", "B", "A"]);
    let [_, detached, attached] = &scene.rule_reports[..] else { panic!() };
    assert_eq!((detached.links, attached.links), (1, 1), "B never had W-02");
    assert_eq!(attached.examples_left, ["gone", "W-02"]);
    let found = scene.diagnostics.get("unknown-hand-link").unwrap();
    assert_eq!((found.count, &found.examples[..]), (2, &["gone".to_owned(), "Z".to_owned()][..]));
    assert!(found.message.starts_with("r.json: attached[0].elements[1]"), "{}", found.message);
    // Without a list of rules the standard one counts; giving wins over taking.
    let text = json!({"format": "topout-rules",
        "detached": [{"activity": "A", "elements": ["W-01", "W-02"]}],
        "attached": [{"activity": "A", "elements": ["W-02"]}]});
    let scene = scene_of(&text, &walls(), &[activity("A", 0, 1, &["W-01", "W-02", "S-01"])]);
    assert_eq!(all_linked(&scene), ["", "A", "A", ""]);
}

#[test]
fn fields_and_properties_that_nothing_has_are_named() {
    let text = file(&[
        rule(json!({"by": "name"}), json!({"by": "field", "field": "Kode"}), json!({"name": "f"})),
        rule(json!({"by": "property", "property": "Zoone"}), json!({"by": "id"}), json!({})),
        rule(json!({"by": "guid"}), json!({"by": "element-field", "field": "X"}), json!({})),
        rule(json!({"by": "name"}), json!({"by": "name"}), json!({"match": "regex"})),
    ]);
    let mut one = fielded("A", &[("Code", "1"), ("Trade", "2")]);
    one.name = "(".into();
    let scene = scene_of(&text, &walls(), &[one]);
    let field = scene.diagnostics.get("unknown-field").unwrap();
    assert_eq!(field.count, 2);
    let said = "r.json: rule \"f\": no activity has the field \"Kode\" (there are: Code, Trade)";
    assert_eq!(field.message, said);
    let property = scene.diagnostics.get("unknown-property").unwrap();
    assert!(property.message.contains("\"Zoone\" (there are: Zone, Layer, Pset.Zone)"));
    let fault = scene.diagnostics.get("rule-fault").unwrap();
    assert!(fault.message.contains("\"(\" is no regular expression"), "{}", fault.message);
    // Nothing looks for entries of elements, so none is unknown.
    assert!(scene.diagnostics.get("unknown-element").is_none());
}

#[test]
fn the_standard_rule_is_what_linking_without_rules_does() {
    let activities = vec![activity("A", 0, 1, &["W-01", "guid-W-01", "gone"])];
    let schedule = Schedule::new(String::new(), None, activities.clone(), Diagnostics::default());
    let plain = link(walls(), schedule);
    let scene = scene_of(&json!({"format": "topout-rules"}), &walls(), &activities);
    assert_eq!(plain.activity_links, scene.activity_links);
    assert_eq!(plain.rule_reports, scene.rule_reports);
    assert_eq!(plain.rule_reports[0].examples_left, ["gone"]);
    assert_eq!(scene.diagnostics.get("unknown-element").unwrap().examples, ["gone"]);
}

#[test]
fn what_is_attached_by_hand_is_not_detached_as_well() {
    let mut rules = Rules::default();
    rules.attach("A", "W-01");
    rules.attach("A", "W-02");
    rules.attach("A", "W-01");
    rules.detach("A", "W-02");
    let read = |rules: &Rules| Rules::parse(&rules.to_json(), "").unwrap();
    let activities = [activity("A", 0, 1, &["W-02", "S-01"])];
    let all = |rules: &Rules| {
        let schedule = Schedule { activities: activities.to_vec(), ..Schedule::default() };
        all_linked(&link_by(read(rules), walls(), schedule))
    };
    assert_eq!((rules.attached.len(), rules.attached[0].elements.len()), (1, 1));
    assert_eq!(all(&rules), ["A", "", "A", ""]);
    rules.attach("A", "W-02");
    assert!(rules.detached.is_empty());
    assert_eq!(all(&rules), ["A", "A", "A", ""]);
}

fn sample() -> Value {
    json!({
        "format": "topout-rules",
        "version": 1,
        "rules": [
            {
                "name": "doors by tag",
                "element": {"by": "property", "property": "tag", "pattern": "^D(\\d+)", "only": ["D*"]},
                "activity": {"by": "field", "field": "Refs", "list": "/", "pattern": "\\d+"},
                "match": "starts-with", "case": false, "also": true
            },
            {
                "name": "log",
                "element": {"by": "name"},
                "activity": {"by": "element-field", "field": "Resource", "list": true,
                    "pattern": "^(.*)_\\(#(?<order>\\d+)\\)$"},
                "match": "in-order"
            },
            {"name": "z", "element": {"by": "layer"}, "activity": {"by": "wbs"}, "match": "exact"}
        ],
        "attached": [{"activity": "A", "elements": ["x", "y"]}],
        "detached": [{"activity": "B", "elements": ["z"]}]
    })
}

#[test]
fn rules_are_written_as_they_are_read() {
    let read = rules(&sample());
    let again = Rules::parse(&read.to_json(), "r.json").unwrap();
    assert_eq!(read, again);
    let value: Value = serde_json::from_str(&read.to_json()).unwrap();
    assert_eq!(value, sample());
    let standard = Rules { file: "s".into(), ..Rules::default() };
    assert_eq!(Rules::parse(&standard.to_json(), "s").unwrap(), standard);
}

#[test]
fn the_manuals_rules_are_read() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../README.md");
    let manual = std::fs::read_to_string(path).unwrap();
    let start = manual.find("    {\"format\": \"topout-rules\"").unwrap();
    let text = manual[start..].split("\n\n").next().unwrap();
    let read = Rules::parse(text, "README.md").unwrap();
    assert_eq!((read.rules.len(), read.attached.len(), read.detached.len()), (3, 1, 1));
    assert!(read.rules[2].activity.pattern.as_ref().unwrap().has_order());
}

#[test]
fn what_is_wrong_with_a_file_is_named_with_place_and_value() {
    let fault = |change: &dyn Fn(&mut Value)| {
        let mut text = sample();
        change(&mut text);
        match Rules::parse(&text.to_string(), "dir/r.json").unwrap_err() {
            error @ RulesError::Invalid { .. } => error.to_string(),
            other => panic!("{other}"),
        }
    };
    let said = fault(&|v| v["rules"][1]["activity"]["feild"] = 3.into());
    assert!(said.starts_with("dir/r.json: rules[1].activity.feild: unknown field"), "{said}");
    assert!(said.ends_with("but it is 3"), "{said}");
    let said = fault(&|v| v["rules"][0]["element"]["pattern"] = "a(b".into());
    assert!(said.contains("rules[0].element.pattern: not a regular expression (unclosed group)"));
    assert!(said.contains("\"a(b\""), "{said}");
    let said = fault(&|v| v["rules"][0]["element"]["pattern"] = "(\\w{999}){999}".into());
    assert!(said.contains("too large"), "{said}");
    let said = fault(&|v| v["rules"][2]["match"] = "near".into());
    assert!(said.contains("rules[2].match: it must be one of exact, "), "{said}");
    let said = fault(&|v| v["rules"][2]["element"] = json!({"by": "property"}));
    assert!(said.contains("rules[2].element: it needs a \"property\""), "{said}");
    let said = fault(&|v| v["rules"][2]["name"] = "log".into());
    assert!(said.contains("rules[2]: a rule named \"log\" stands before"), "{said}");
    let said = fault(&|v| v["attached"][0]["elements"][1] = Value::Null);
    assert!(said.contains("attached[0].elements[1]: it must be a text, but it is null"), "{said}");
    for (name, bad) in [("format", json!("4d-schedule")), ("version", json!(2))] {
        let said = fault(&|v| v[name] = bad.clone());
        assert!(said.contains(&format!("{name}: it must be")), "{said}");
    }
    assert!(fault(&|v| *v = json!([])).contains("the file: it must be an object"));
    let error = Rules::parse("{\n \"format\": ", "r.json").unwrap_err();
    assert!(error.to_string().starts_with("r.json: line 2, column"), "{error}");
    let error = Rules::read(std::path::Path::new("no/such.json")).unwrap_err();
    assert!(error.to_string().contains("no/such.json"), "{error}");
}

proptest! {
    /// Any damage to a file gives rules or an error, and rules that are read survive being written.
    #[test]
    fn damaged_files_are_read_or_refused(
        damage in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let mut bytes = sample().to_string().into_bytes();
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte % 128;
        }
        let text = String::from_utf8(bytes).unwrap();
        match Rules::parse(&text, "r") {
            Ok(read) => prop_assert_eq!(&Rules::parse(&read.to_json(), "r").unwrap(), &read),
            Err(error) => prop_assert!(error.to_string().starts_with("r: ")),
        }
    }
}

/// The schema knows what the reader knows: the sample has every property that it names, and where the
/// reader refuses a property the schema does as well.
#[test]
fn the_schema_names_what_is_read_and_written() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/rules.schema.json");
    let schema: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let parts = &schema["$defs"];
    let names = |v: &Value| -> Vec<String> {
        let mut names: Vec<String> = v.as_object().unwrap().keys().cloned().collect();
        names.sort();
        names
    };
    let text = sample();
    let (one, two) = (&text["rules"][0], &text["rules"][1]);
    for (given, of) in [
        (&text, &schema),
        (one, &parts["rule"]),
        (&one["element"], &parts["element"]),
        (&one["activity"], &parts["activity"]),
        (&text["attached"][0], &parts["hand_link"]),
    ] {
        assert_eq!(names(given), names(&of["properties"]));
        assert_eq!(of["additionalProperties"], false);
        for needed in of["required"].as_array().unwrap() {
            assert!(given[needed.as_str().unwrap()] != Value::Null);
        }
    }
    assert!(names(two).iter().all(|n| names(&parts["rule"]["properties"]).contains(n)));
    let words = |of: &Value| -> Vec<String> {
        of["enum"].as_array().unwrap().iter().map(|w| w.as_str().unwrap().to_owned()).collect()
    };
    use crate::link::rules::{ActivityBy, ElementBy, FORMAT, Match};
    assert_eq!(words(&parts["rule"]["properties"]["match"]), Match::WORDS.map(|w| w.0));
    assert_eq!(words(&parts["element"]["properties"]["by"]), ElementBy::WORDS);
    assert_eq!(words(&parts["activity"]["properties"]["by"]), ActivityBy::WORDS);
    assert_eq!(schema["properties"]["format"]["const"], FORMAT);
}

#[test]
fn a_schedule_that_is_read_again_is_linked_by_the_rules_again() {
    let text = file(&[rule(json!({"by": "storey"}), json!({"by": "name"}), json!({}))]);
    let before = scene_of(&text, &walls(), &[named("A", "Level 1"), named("B", "Level 2")]);
    let mut activities = before.schedule.activities.clone();
    activities[0].name = "Level 2".into();
    activities[0].start = activities[0].start.map(|t| t.plus_seconds(-5));
    let schedule = |activities| Schedule { activities, ..before.schedule.clone() };
    let edited = before.with_schedule(schedule(activities.clone())).unwrap();
    let anew = before.relinked(schedule(activities.clone()));
    assert_eq!(edited.scene.activity_links, anew.activity_links);
    assert_eq!(all_linked(&edited.scene), ["", "A B", "", ""]);
    assert_eq!(edited.scene.rule_reports, anew.rule_reports);
    for e in (0..4).map(ElementId) {
        assert_eq!(edited.scene.behaviour(e), anew.behaviour(e));
        assert_eq!(edited.changed.contains(&e), before.behaviour(e) != anew.behaviour(e));
    }
    assert_eq!(edited.moved, 1);
    assert_eq!(&edited.scene.behaviours[..before.behaviours.len()], &before.behaviours[..]);
    let resync = Resync::between(&before, &edited.scene);
    assert_eq!(resync.moved.len(), 1);
    assert_eq!(resync.newly_loose_elements, ["guid-W-01", "guid-S-01"]);
    assert!(resync.newly_linked_elements.is_empty() && resync.added.is_empty());
    assert!(Resync::between(&before, &before).is_empty());
    assert_eq!(Resync::between(&before, &before).to_string(), "nothing changed\n");

    activities[1].name = String::new();
    activities[1].id = "C".into();
    let mut other = walls();
    other.elements.remove(0);
    let mut after = before.relinked(schedule(activities));
    let resync = Resync::between(&before, &after);
    assert_eq!((&resync.added[..], &resync.removed[..]), (&["C".into()][..], &["B".into()][..]));
    after = link_by(rules(&text), other, after.schedule);
    let resync = Resync::between(&before, &after);
    assert_eq!(resync.removed_elements, ["guid-W-01"]);
    assert!(resync.added_elements.is_empty());
    assert_eq!(resync.newly_loose_elements, ["guid-S-01"]);
    let text = resync.to_string();
    assert!(text.contains("1 activities added: C"), "{text}");
    let json = serde_json::to_value(&resync).unwrap();
    assert_eq!(json["moved"][0]["before"][1], "1970-01-01T00:00:01", "{json}");
}
