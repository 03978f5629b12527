//! `topout check`: what loads, what is linked, what is wrong.

use super::sections::{SectionReport, table};
use super::slip::{FlagsReport, SlipReport};
use super::{Outcome, args, terminal};
use crate::project::{self, Request};
use crate::report::{Output, columns, count, write_file};
use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::sync::Arc;
use topout_scene::check::{Section, check};
use topout_scene::link::{RuleReport, Suggestion, Suggestions, suggest};
use topout_scene::{ElementId, Progress, Scene};
use topout_schedule::{Comparison, Diagnostic, Preset, Severity, Tally};

/// The keys that scripts read.
#[derive(Serialize, Debug)]
pub struct Report {
    name: String,
    elements: usize,
    triangles: usize,
    meshes: usize,
    instances: usize,
    groups: usize,
    /// World coordinates, metres: smallest and largest corner.
    bounds: Option<[[f64; 3]; 2]>,
    project: String,
    activities: usize,
    /// What else the schedule holds, and how much of it is unusual but fine.
    tally: Tally,
    linked_elements: usize,
    unlinked_elements: usize,
    linked_activities: usize,
    unlinked_activities: usize,
    start: Option<String>,
    finish: Option<String>,
    behaviours: Map<String, Value>,
    /// What `--compare` or `--against` asks for.
    #[serde(skip_serializing_if = "Option::is_none")]
    slip: Option<SlipReport>,
    /// What an event log says of its elements.
    #[serde(skip_serializing_if = "Option::is_none")]
    flags: Option<FlagsReport>,
    /// What each rule of linking did, in order; then what links by hand did.
    rules: Vec<RuleReport>,
    /// Rules that would link more, best first, where much is left; see the manual.
    suggestions: Vec<Value>,
    /// What the usual ways match, where much is left.
    #[serde(skip)]
    suggested: Option<String>,
    /// What there is to look at, in full in the table of `--csv`.
    sections: Vec<SectionReport>,
    diagnostics: Vec<Diagnostic>,
}

/// Reports, and says whether there are errors.
pub fn run(args: &args::Check) -> anyhow::Result<Outcome> {
    let output = Output::new(args.common.json.clone()).beside(args.csv.as_deref());
    let progress = Arc::new(Progress::default());
    let (scene, slip) = {
        let _line = terminal::ProgressLine::show(&progress);
        let scene = project::load_what_can_be(&args.common.request(), &progress)?;
        let slip = slip(args, &scene, &progress)?;
        (scene, slip)
    };
    let sections = check(&scene);
    let report = Report { slip, ..Report::of(&scene, &sections) };
    if let Some(path) = &args.csv {
        write_file(path, &table(&scene, &sections)?)?;
    }
    output.say(&report.text());
    output.write(&report)?;
    Ok(if scene.diagnostics.has_errors() { Outcome::BadData } else { Outcome::Fine })
}

/// What is asked for: one set of dates beside another, or the schedule beside another one.
fn slip(
    args: &args::Check,
    scene: &Scene,
    progress: &Progress,
) -> anyhow::Result<Option<SlipReport>> {
    let schedule = &scene.schedule;
    if let Some([from, to]) = args.compare {
        let found = Comparison::of_sets(schedule, from, to);
        let names = [from, to].map(|set| set.word().to_owned());
        let [from, to] = names;
        return Ok(Some(SlipReport::of(&found, schedule, from, to)));
    }
    let Some(against) = &args.against else { return Ok(None) };
    let request = args.common.request();
    let given = |paths: &[std::path::PathBuf]| {
        paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
    };
    let to = match request.schedules.is_empty() {
        true => "the model's own schedule".to_owned(),
        false => given(&request.schedules),
    };
    let request = Request { schedules: vec![against.clone()], ..request };
    let older = project::load_schedule(&request, progress)?;
    let found = Comparison::of_schedules(&older, schedule);
    Ok(Some(SlipReport::of(&found, schedule, given(&request.schedules), to)))
}

impl Report {
    /// Counts a scene.
    pub fn of(scene: &Scene, sections: &[Section]) -> Self {
        let model = &scene.model;
        let elements = (0..model.elements.len()).map(|i| ElementId(i as u32));
        let linked_elements = elements.filter(|&e| !scene.activities_of(e).is_empty()).count();
        let linked_activities = scene.activity_links.iter().collect::<BTreeSet<_>>().len();
        let activities = scene.schedule.activities.len();
        let bounds = model.bounds();
        let suggested = suggest::needed(scene).then(|| suggest::suggest(model, &scene.schedule));
        let more =
            |s: &&Suggestion| s.elements > linked_elements || s.activities > linked_activities;
        let suggestions: Vec<&Suggestion> =
            suggested.iter().flat_map(|s| &s.best).filter(more).collect();
        let period = (activities > 0).then_some(scene.schedule.period);
        Self {
            name: model.name.clone(),
            elements: model.elements.len(),
            triangles: model.triangle_count(),
            meshes: model.meshes.len(),
            instances: model.instances.len(),
            groups: model.groups.len(),
            bounds: (!bounds.is_empty()).then(|| {
                [bounds.min, bounds.max].map(|p| (p.as_dvec3() + model.origin).to_array())
            }),
            project: scene.schedule.project.clone(),
            activities,
            tally: scene.schedule.tally(),
            linked_elements,
            unlinked_elements: model.elements.len() - linked_elements,
            linked_activities,
            unlinked_activities: activities - linked_activities,
            start: period.map(|p| p.start.to_string()),
            finish: period.map(|p| p.end.to_string()),
            behaviours: behaviours(scene),
            slip: None,
            flags: Comparison::of_flags(&scene.schedule)
                .map(|flags| FlagsReport::of(&flags, &scene.schedule)),
            rules: scene.rule_reports.clone(),
            suggestions: suggestions.iter().map(|s| s.to_value()).collect(),
            suggested: suggested.map(|s| match s.usual.is_empty() && !s.best.is_empty() {
                true => String::new(),
                false => Suggestions { best: Vec::new(), ..s }.to_string(),
            }),
            sections: sections.iter().map(|s| SectionReport::of(s, scene)).collect(),
            diagnostics: scene.diagnostics.iter().cloned().collect(),
        }
    }

    fn text(&self) -> String {
        let mut text = String::new();
        let mut section = |title: &str, name: &str, rows: &[(&str, String)]| {
            let _ = writeln!(text, "{title:<12}{name}");
            for (key, value) in rows {
                let _ = writeln!(text, "  {key:<16}{value}");
            }
        };
        let mut rows = vec![
            ("elements", count(self.elements)),
            ("triangles", count(self.triangles)),
            ("meshes", format!("{}, used {} times", count(self.meshes), count(self.instances))),
            ("groups", count(self.groups)),
        ];
        if let Some([min, max]) = self.bounds {
            let corner = |p: [f64; 3]| format!("({:.1}, {:.1}, {:.1})", p[0], p[1], p[2]);
            rows.push(("box", format!("{} to {} m", corner(min), corner(max))));
        }
        section("Model", &self.name, &rows);
        if let (Some(start), Some(finish)) = (&self.start, &self.finish) {
            let mut rows = vec![
                ("activities", count(self.activities)),
                ("start", start.clone()),
                ("finish", finish.clone()),
            ];
            let tally = &self.tally;
            for (what, number) in [
                ("predecessors", tally.predecessors),
                ("summaries", tally.summaries),
                ("calendars", tally.calendars),
                ("milestones", tally.milestones),
                ("without a name", tally.without_name),
                ("repeated names", tally.repeated_names),
                ("zero duration", tally.zero_duration),
            ] {
                if number > 0 {
                    rows.push((what, count(number)));
                }
            }
            section("Schedule", &self.project, &rows);
            let of =
                |linked: usize, not: usize| format!("{} linked, {} not", count(linked), count(not));
            let rows = [
                ("elements", of(self.linked_elements, self.unlinked_elements)),
                ("activities", of(self.linked_activities, self.unlinked_activities)),
            ];
            section("Links", "", &rows);
            text.push_str(&self.rules_text());
        } else {
            section("Schedule", "none: everything is there at all times", &[]);
        }
        text.push_str("Behaviours\n");
        let mut rows = Vec::new();
        for (name, number) in &self.behaviours {
            if let Some(number) = number.as_u64().filter(|n| *n > 0) {
                rows.push(vec![format!("  {name:<16}"), crate::report::grouped(number)]);
            }
        }
        text.push_str(&columns(&rows));
        text.extend(self.slip.iter().map(SlipReport::text));
        text.extend(self.flags.iter().map(FlagsReport::text));
        text.extend(self.sections.iter().map(SectionReport::text));
        text.push_str(&self.findings());
        text
    }

    /// What each rule did, and which rules would do more.
    fn rules_text(&self) -> String {
        let mut text = "Rules\n".to_owned();
        for rule in &self.rules {
            let _ = writeln!(
                text,
                "  {:<16}{} elements, {} activities, {} links; {} of {} keys left over",
                rule.name,
                count(rule.elements),
                count(rule.activities),
                count(rule.links),
                count(rule.keys_left),
                count(rule.keys)
            );
            if rule.left_to_earlier > 0 {
                let elements = count(rule.left_to_earlier);
                let _ = writeln!(text, "  {:<16}{elements} elements left to earlier rules", "");
            }
            if !rule.examples_left.is_empty() {
                let more = if rule.keys_left > rule.examples_left.len() { ", ..." } else { "" };
                let left = rule.examples_left.join(", ");
                let _ = writeln!(text, "  {:<16}left over: {left}{more}", "");
            }
        }
        let Some(suggested) = &self.suggested else { return text };
        let _ = writeln!(text, "Suggestions {suggested}");
        for suggestion in &self.suggestions {
            let said = suggestion["text"].as_str().unwrap_or_default();
            let _ = writeln!(text, "  {said}\n    {}", suggestion["rule"]);
        }
        text.push_str(match self.suggestions.is_empty() {
            true => "  no rule that was tried links more\n",
            false => "  Put what fits under \"rules\" of a file for --rules.\n",
        });
        text
    }

    /// What is not told by a section already.
    fn findings(&self) -> String {
        let told = |d: &&Diagnostic| self.sections.iter().any(|s| s.code == d.code);
        let findings: Vec<_> = self.diagnostics.iter().filter(|d| !told(d)).collect();
        if findings.is_empty() {
            return "Findings    none".to_owned();
        }
        let mut text = "Findings\n".to_owned();
        for finding in findings {
            let severity = match finding.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
                Severity::Info => "info",
            };
            let _ = writeln!(text, "  {severity:<8}{} x{}", finding.code, count(finding.count));
            for line in finding.message.lines() {
                let _ = writeln!(text, "          {line}");
            }
            if finding.count > 1 {
                let shown = finding.examples.len().min(5);
                let more = if finding.count > shown { ", ..." } else { "" };
                let _ = writeln!(text, "          {}{more}", finding.examples[..shown].join(", "));
            }
        }
        text
    }
}

fn behaviours(scene: &Scene) -> Map<String, Value> {
    let period = scene.schedule.period;
    let mut counts = [0u64; PRESETS.len()];
    for behaviour in &scene.element_behaviour {
        let preset = scene.behaviours[behaviour.index()].preset(period);
        if let Some(place) = PRESETS.iter().position(|(p, _)| *p == preset) {
            counts[place] += 1;
        }
    }
    PRESETS.iter().zip(counts).map(|((_, name), n)| ((*name).to_owned(), n.into())).collect()
}

/// The behaviours by name, in the order of the report (H2).
const PRESETS: [(Preset, &str); 9] = [
    (Preset::Static, "static"),
    (Preset::Absent, "absent"),
    (Preset::Installed, "installed"),
    (Preset::Removed, "removed"),
    (Preset::Temporary, "temporary"),
    (Preset::Skipped, "skipped"),
    (Preset::ReInstalled, "re-installed"),
    (Preset::ReDeleted, "re-deleted"),
    (Preset::Other, "other"),
];
