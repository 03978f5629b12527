//! A real event log whose guids are not the model's: names in order find the elements.

use crate::import::read_model;
use crate::link::rules::{ActivityBy, ElementBy, Match, Pattern, Rule};
use crate::link::{Rules, link, link_by, report, suggest};
use crate::{ElementId, Progress};
use std::collections::HashSet;
use std::path::PathBuf;
use topout_schedule::{Activity, Diagnostics, Schedule};

fn house() -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("TOPOUT_REAL_DATA") else {
        println!("skipped: TOPOUT_REAL_DATA is not set");
        return None;
    };
    Some(PathBuf::from(folder).join("schependomlaan"))
}

#[test]
fn names_in_order_link_a_log_whose_guids_are_others() {
    let Some(house) = house() else { return };
    let model = read_model(&house.join("schependomlaan.glb"), &Progress::default()).unwrap();
    let log = house.join("eventlog/eventlog IFC schependomlaan.csv");
    let schedule = topout_schedule::read_files(&[log], &Default::default()).unwrap();
    let by_guid = link(model.clone(), schedule.clone());
    assert_eq!(report(&by_guid).linked_elements, 0);
    assert_eq!(by_guid.rule_reports[0].keys_left, 3505);
    assert!(suggest::needed(&by_guid));

    let found = suggest::suggest(&model, &schedule);
    let said = found.to_string();
    let expected = "0 of 3,505 keys match by guid, 0 by name; 3,504 of 3,505 keys (element field \
                    \"Resource\") match by name and order: 3,504 elements, 73 activities";
    assert_eq!(said, expected);

    let rules = Rules { rules: vec![found.best[0].rule.clone()], ..Rules::default() };
    let rules = Rules::parse(&rules.to_json(), "").unwrap();
    let scene = link_by(rules, model.clone(), schedule);
    assert_eq!(report(&scene).linked_elements, 3504);
    // What a comparison of counts, materials and ranks gave, which does not look at the numbers.
    let links = std::fs::read_to_string(house.join("links.csv")).unwrap();
    let links: HashSet<(&str, &str)> = links
        .lines()
        .skip(1)
        .map(|line| {
            let mut cells = line.split(',');
            (cells.next().unwrap(), cells.next().unwrap())
        })
        .collect();
    let mut same = 0;
    for (e, element) in model.elements.iter().enumerate() {
        for &a in scene.activities_of(ElementId(e as u32)) {
            let id = scene.schedule.activities[a as usize].id.as_str();
            same += usize::from(links.contains(&(element.guid.as_deref().unwrap(), id)));
        }
    }
    assert!(links.len() == 7164 && same >= 7073, "{same} of {}", links.len());
}

#[test]
fn types_in_whatever_case_and_patterns_link_a_real_model() {
    let Some(house) = house() else { return };
    let path = house.parent().unwrap().join("bimwhale/ifc_bimwhale_TallBuilding.glb");
    let model = read_model(&path, &Progress::default()).unwrap();
    let mut rule = Rule::new("r", ElementBy::Type, ActivityBy::Name, Match::Exact);
    rule.element.pattern = Some(Pattern::new("^Ifc(Wall|Slab)").unwrap());
    rule.case = false;
    let named =
        |id: &str, name: &str| Activity { id: id.into(), name: name.into(), ..Activity::default() };
    let activities = vec![named("A", "WALL"), named("B", "Roof")];
    let schedule = Schedule::new(String::new(), None, activities, Diagnostics::default());
    let rules = Rules { rules: vec![rule], ..Rules::default() };
    let scene = link_by(rules, model, schedule);
    let walls = scene.model.elements.iter().filter(|e| e.kind.starts_with("IfcWall")).count();
    assert!(walls > 5);
    let report = &scene.rule_reports[0];
    assert_eq!((report.elements, report.keys_left), (walls, 1));
    assert_eq!(report.examples_left, ["roof"]);
}
