//! What linking costs: `cargo bench --workspace --bench link`.
//!
//! 100,000 activities and 250,000 keys to as many elements, by several rules; as a test (`--test`) a
//! hundredth of that. RAYON_NUM_THREADS=1 measures one core.
#![allow(missing_docs)]

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use std::sync::Arc;
use topout_scene::link::rules::{ActivityBy, ElementBy, Match, Pattern, Rule};
use topout_scene::link::{Rules, link_by, suggest};
use topout_scene::{Element, Model, properties};
use topout_schedule::{Activity, Diagnostics, Schedule, Time};

fn activities() -> usize {
    if std::env::args().any(|a| a == "--test") { 1_000 } else { 100_000 }
}

/// Elements with a guid, a name that some share, a property, and a number in their label.
fn model(count: usize) -> Model {
    let mut table = properties::Builder::default();
    for i in 0..count {
        table.say("Mark", &format!("M-{i:06}"));
        table.say("Zone", &format!("Z{}", i % 40));
        table.end_element();
    }
    let element = |i: usize| Element {
        name: format!("element-{i:06}"),
        label: format!("Basic Wall:{}", i % 500),
        guid: Some(format!("{:022x}", i as u64 * 0x9E37_79B9)),
        storey: format!("Level {}", i % 60),
        ..Element::default()
    };
    let elements = (0..count).map(element).collect();
    Model { elements, properties: table.finish().0, ..Model::default() }
}

/// Activities with two or three elements each; a field lists their marks.
fn schedule(count: usize) -> Schedule {
    let activity = |i: usize| {
        let own = (i * 5 / 2)..((i + 1) * 5 / 2);
        let marks: Vec<String> = own.clone().map(|e| format!("M-{e:06}")).collect();
        Activity {
            id: format!("A{i}"),
            name: format!("Install element-{:06} and others", i * 5 / 2),
            start: Some(Time::from_seconds(i as i64 / 100 * 86_400)),
            end: Some(Time::from_seconds((i as i64 / 100 + 5) * 86_400)),
            elements: own.map(|e| format!("{:022x}", e as u64 * 0x9E37_79B9)).collect(),
            fields: vec![
                ("Marks".into(), marks.join(", ").into()),
                ("Level".into(), format!("level {}", i % 60).into()),
                ("Kind".into(), format!("Basic Wall:{}_(#{i})", i % 500).into()),
            ],
            ..Activity::default()
        }
    };
    let activities = (0..count).map(activity).collect();
    Schedule::new(String::new(), None, activities, Diagnostics::default())
}

fn rules() -> Vec<Rule> {
    let field = |name: &str| ActivityBy::Field(name.to_owned());
    let mut list = Rule::new(
        "list of a field by property",
        ElementBy::Property("Mark".into()),
        field("Marks"),
        Match::Exact,
    );
    list.activity.list = topout_scene::link::rules::List::Usual;
    let mut pattern = Rule::new("pattern", ElementBy::Name, ActivityBy::Name, Match::Exact);
    pattern.activity.pattern = Some(Pattern::new(r"element-\d+").expect("a pattern"));
    let mut order = Rule::new("in order", ElementBy::Name, field("Kind"), Match::InOrder);
    let numbered = Pattern::new(r"^(?<key>.*?)_\(#(?<order>\d+)\)$").expect("a pattern");
    order.activity.pattern = Some(numbered);
    let within = Rule::new("within", ElementBy::Name, ActivityBy::Name, Match::Within);
    vec![Rule::standard(), list, pattern, order, within]
}

fn bench(c: &mut Criterion) {
    let count = activities();
    let model = Arc::new(model(count * 5 / 2));
    let schedule = schedule(count);
    let mut group = c.benchmark_group("link");
    group.sample_size(10);
    for rule in rules() {
        let name = rule.name.clone();
        let rules = Arc::new(Rules { rules: vec![rule], ..Rules::default() });
        group.bench_function(name, |b| {
            b.iter_batched(
                || schedule.clone(),
                |schedule| link_by(Arc::clone(&rules), Arc::clone(&model), schedule),
                BatchSize::PerIteration,
            );
        });
    }
    group.bench_function("suggest", |b| b.iter(|| suggest::suggest(&model, &schedule)));
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
