//! Moving objects (H3): an object on a path becomes instances that appear and vanish in turn.
//!
//! HDLOD knows elements that come and go and none that move. So a path in space and time is cut into steps
//! no longer than a length that the user names; each step is an element of its own, with the meshes of the
//! object at that place, and an activity that shows it until the next step begins. Everything else, clusters and
//! reports included, takes them for what they are: elements with behaviours.

use crate::{Aabb, Element, ElementId, Instance, Model};
use glam::{Affine3A, DVec3, Mat3A, Vec3, Vec3A};
use serde::Deserialize;
use std::collections::HashSet;
use std::f32::consts::TAU;
use std::path::{Path, PathBuf};
use topout_schedule::{Activity, ActivityKind, Schedule, Severity, Time, TimeError, TimeRange};

/// The `format` of such a file.
pub const FORMAT: &str = "topout-paths";
/// Steps of all paths, repetitions counted each.
pub const MOST_STEPS: usize = 100_000;
/// Longest file, bytes.
const MOST_BYTES: u64 = 64 << 20;

/// Why paths cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PathsError {
    /// The file cannot be read.
    #[error("{}: {source}", file.display())]
    Io {
        /// Which file.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// It is no JSON, or not such a file.
    #[error("{}: {source}", file.display())]
    Json {
        /// Which file.
        file: PathBuf,
        /// What is wrong, with line and column.
        source: serde_json::Error,
    },
    /// A value cannot be meant.
    #[error("{}: {place}: {reason}", file.display())]
    Value {
        /// Which file.
        file: PathBuf,
        /// Where in the file: `paths[2].points[0].time`.
        place: String,
        /// What is wrong with what value.
        reason: String,
    },
}

#[derive(Deserialize)]
struct File {
    format: Option<String>,
    paths: Vec<PathText>,
}

#[derive(Deserialize)]
struct PathText {
    element: String,
    id: Option<String>,
    name: Option<String>,
    points: Vec<PointText>,
    step_m: Option<f64>,
    #[serde(default)]
    turn: bool,
    heading_degrees: Option<f64>,
    #[serde(default)]
    before: Outside,
    #[serde(default)]
    after: Outside,
    repeat: Option<Repeat>,
}

#[derive(Deserialize)]
struct PointText {
    time: String,
    at: [f64; 3],
}

#[derive(Deserialize)]
struct Repeat {
    every_minutes: f64,
    until: String,
}

/// What becomes of an object outside of its path's time.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Outside {
    #[default]
    Hidden,
    Stays,
}

/// A file that was read.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Paths {
    file: PathBuf,
    paths: Vec<MovingObject>,
}

#[derive(Clone, PartialEq, Debug)]
struct MovingObject {
    element: String,
    id: String,
    name: String,
    points: Vec<(Time, DVec3)>,
    step_m: Option<f64>,
    turn: bool,
    heading: Option<f64>,
    before: Outside,
    after: Outside,
    /// Seconds from one start to the next, and the last instant at which one may start.
    repeat: Option<(i64, Time)>,
}

/// One place of an object, from `start` on.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Step {
    start: Time,
    end: Time,
    at: DVec3,
    /// Metres along X and Z since the step before: where it heads.
    way: DVec3,
}

impl Paths {
    /// Reads a file.
    ///
    /// # Errors
    /// What cannot be read, is no such file, or cannot be meant, with its place.
    pub fn read(file: &Path) -> Result<Self, PathsError> {
        let io = |source| PathsError::Io { file: file.to_owned(), source };
        let length = std::fs::metadata(file).map_err(io)?.len();
        if length > MOST_BYTES {
            return Err(io(std::io::Error::other(format!(
                "{length} bytes are more than the {MOST_BYTES} that are read"
            ))));
        }
        Self::parse(file, &std::fs::read_to_string(file).map_err(io)?)
    }

    /// [`Paths::read`] for a text that is in memory.
    ///
    /// # Errors
    /// The same.
    pub fn parse(file: &Path, text: &str) -> Result<Self, PathsError> {
        let file = file.to_owned();
        let read: File = serde_json::from_str(text)
            .map_err(|source| PathsError::Json { file: file.clone(), source })?;
        let wrong = |place: String, reason: String| {
            Err(PathsError::Value { file: file.clone(), place, reason })
        };
        if read.format.as_deref().is_some_and(|format| format != FORMAT) {
            let reason = format!("{:?} is not {FORMAT:?}", read.format.unwrap_or_default());
            return wrong("format".to_owned(), reason);
        }
        let mut paths = Vec::with_capacity(read.paths.len());
        for (number, path) in read.paths.into_iter().enumerate() {
            match path.validated() {
                Ok(path) => paths.push(path),
                Err((place, reason)) => return wrong(format!("paths[{number}]{place}"), reason),
            }
        }
        Ok(Self { file, paths })
    }

    /// Adds the steps of all paths to model and schedule. Returns the activities that were added and the
    /// names of their elements.
    ///
    /// The object itself is never there any more: its first activity on the path takes its place. Links
    /// of other activities to it by name or guid are taken away, which is said.
    ///
    /// # Errors
    /// An element that is not there or not one, ids that are used, or more than [`MOST_STEPS`] steps.
    pub fn add_to(
        &self,
        model: &mut Model,
        schedule: &mut Schedule,
    ) -> Result<Vec<(String, String)>, PathsError> {
        let mut ids: HashSet<String> = schedule.activities.iter().map(|a| a.id.clone()).collect();
        let mut added = Vec::new();
        for (number, path) in self.paths.iter().enumerate() {
            let wrong = |place: &str, reason: String| PathsError::Value {
                file: self.file.clone(),
                place: format!("paths[{number}].{place}"),
                reason,
            };
            let object = path.object(model).map_err(|reason| wrong("element", reason))?;
            let steps = path.steps(model.elements[object.index()].bounds);
            let rounds = path.rounds();
            let most = MOST_STEPS.saturating_sub(added.len());
            if steps.len().saturating_mul(rounds.len()) > most {
                let count = steps.len().saturating_mul(rounds.len());
                let reason = format!(
                    "{count} steps make more than {MOST_STEPS} of all paths; take a longer step_m, \\
                     or fewer repetitions"
                );
                return Err(wrong("step_m", reason));
            }
            take_links(model, schedule, object, &self.file);
            schedule.activities.push(Activity {
                id: format!("{}@", path.id),
                name: format!("{} (moves)", path.name),
                active: false,
                elements: vec![key_of(&model.elements[object.index()])],
                ..Activity::default()
            });
            let first = schedule.activities.len();
            path.add(model, schedule, object, &steps, &rounds);
            for activity in &schedule.activities[first - 1..] {
                if !ids.insert(activity.id.clone()) {
                    let reason = format!("the activity id {:?} is used already", activity.id);
                    return Err(wrong("id", reason));
                }
                added.extend(activity.elements.iter().map(|e| (activity.id.clone(), e.clone())));
            }
        }
        let times = schedule.activities.iter().filter_map(Activity::dates);
        if let Some(all) =
            times.reduce(|a, b| TimeRange { start: a.start.min(b.start), end: a.end.max(b.end) })
            && schedule.period == TimeRange::default()
        {
            schedule.period = all;
        }
        Ok(added)
    }
}

impl PathText {
    /// Fails with the place within the path and what is wrong there.
    fn validated(self) -> Result<MovingObject, (String, String)> {
        let at = |place: &str, reason: String| (format!(".{place}"), reason);
        if self.element.is_empty() {
            return Err(at("element", "names no element".to_owned()));
        }
        if self.points.len() < 2 {
            return Err(at("points", format!("{} points are no path", self.points.len())));
        }
        let time = |text: &str, place: String| {
            Time::parse_iso(text).map_err(|error: TimeError| (place, error.to_string()))
        };
        let mut points: Vec<(Time, DVec3)> = Vec::with_capacity(self.points.len());
        for (i, point) in self.points.iter().enumerate() {
            let now = time(&point.time, format!(".points[{i}].time"))?;
            let place = DVec3::from(point.at);
            if !place.is_finite() || place.abs().max_element() > 1e9 {
                let reason = format!("{:?} is no place in metres", point.at);
                return Err((format!(".points[{i}].at"), reason));
            }
            if let Some((before, _)) = points.last().filter(|(before, _)| *before >= now) {
                let reason = format!("{now} is not after {before}, the time of the point before");
                return Err((format!(".points[{i}].time"), reason));
            }
            points.push((now, place));
        }
        if let Some(step) = self.step_m.filter(|s| !(s.is_finite() && *s > 0.0)) {
            return Err(at("step_m", format!("{step} is no length in metres")));
        }
        if let Some(degrees) = self.heading_degrees.filter(|d| !d.is_finite()) {
            return Err(at("heading_degrees", format!("{degrees} is no direction")));
        }
        let length = points[points.len() - 1].0.seconds() - points[0].0.seconds();
        let repeat = match self.repeat {
            None => None,
            Some(Repeat { every_minutes, until }) => {
                let every = every_minutes * 60.0;
                if !(every.is_finite() && every >= length as f64) {
                    let reason = format!(
                        "{every_minutes} minutes are less than the {:.1} that the path takes",
                        length as f64 / 60.0
                    );
                    return Err(at("repeat.every_minutes", reason));
                }
                Some((every as i64, time(&until, ".repeat.until".to_owned())?))
            }
        };
        let id = self.id.unwrap_or_else(|| self.element.clone());
        Ok(MovingObject {
            name: self.name.unwrap_or_else(|| id.clone()),
            id,
            element: self.element,
            points,
            step_m: self.step_m,
            turn: self.turn,
            heading: self.heading_degrees.map(f64::to_radians),
            before: self.before,
            after: self.after,
            repeat,
        })
    }
}

impl MovingObject {
    /// The one element that is called so.
    fn object(&self, model: &Model) -> Result<ElementId, String> {
        let called = |e: &Element| {
            e.name == self.element || e.guid.as_deref() == Some(self.element.as_str())
        };
        let mut found = (0u32..).zip(&model.elements).filter(|(_, e)| called(e));
        let Some((object, element)) = found.next() else {
            return Err(format!("the model has no element {:?}", self.element));
        };
        match found.count() {
            0 if element.instances.is_empty() => {
                Err(format!("the element {:?} has no geometry", self.element))
            }
            0 => Ok(ElementId(object)),
            more => Err(format!("the model has {} elements {:?}", more + 1, self.element)),
        }
    }

    /// The way in steps; the last one is the place where the path ends.
    fn steps(&self, bounds: Aabb) -> Vec<Step> {
        let step_m = self.step_m.unwrap_or_else(|| f64::from(bounds.diameter()) / 2.0).max(1e-3);
        let mut steps: Vec<Step> = Vec::new();
        let mut way = DVec3::ZERO;
        for pair in self.points.windows(2) {
            let [(start, from), (end, to)] = [pair[0], pair[1]];
            let seconds = end.seconds().saturating_sub(start.seconds());
            if to != from {
                way = to - from;
            }
            // No step is shorter than a second: what is faster has longer steps.
            let wanted = (from.distance(to) / step_m).ceil().max(1.0);
            let count = (wanted.min(MOST_STEPS as f64 + 1.0) as i64).min(seconds).max(1);
            let time = |i: i64| {
                let past = (i128::from(seconds) * i128::from(i) / i128::from(count)) as i64;
                start.plus_seconds(past)
            };
            for i in 0..count {
                let at = from.lerp(to, i as f64 / count as f64);
                steps.push(Step { start: time(i), end: time(i + 1), at, way });
            }
            if steps.len() > MOST_STEPS {
                return steps;
            }
        }
        let (end, at) = self.points[self.points.len() - 1];
        steps.push(Step { start: end, end, at, way });
        // What stands before it moves looks where it will go.
        if let Some(first) = steps.iter().map(|s| s.way).find(|way| *way != DVec3::ZERO) {
            steps.iter_mut().filter(|s| s.way == DVec3::ZERO).for_each(|s| s.way = first);
        }
        steps
    }

    /// Seconds by which each round is later than the first.
    fn rounds(&self) -> Vec<i64> {
        let Some((every, until)) = self.repeat else { return vec![0] };
        let first = self.points[0].0.seconds();
        let count = until.seconds().saturating_sub(first).max(0) / every.max(1) + 1;
        (0..count.min(MOST_STEPS as i64 + 1)).map(|round| round * every).collect()
    }

    /// Adds the steps.
    fn add(
        &self,
        model: &mut Model,
        schedule: &mut Schedule,
        object: ElementId,
        steps: &[Step],
        rounds: &[i64],
    ) {
        let original = model.elements[object.index()].clone();
        let heading = |way: DVec3| way.x.atan2(way.z) as f32;
        let own = self.heading.map_or_else(|| heading(steps[0].way), |h| h as f32);
        let last = steps.len() - 1;
        for (i, step) in steps.iter().enumerate() {
            let ends = i == last;
            if ends && self.after == Outside::Hidden {
                continue;
            }
            let turned = if self.turn { (heading(step.way) - own).rem_euclid(TAU) } else { 0.0 };
            let at = (step.at - model.origin).as_vec3();
            let name = format!("{}@{:04}", original.name, i + 1);
            let element = place(model, &original, at, turned, name.clone());
            model.elements.push(element);
            for (round, later) in rounds.iter().enumerate() {
                let (first, final_round) = (round == 0, round + 1 == rounds.len());
                if ends && !final_round {
                    continue;
                }
                let kind = match () {
                    () if ends => ActivityKind::Construct,
                    () if i == 0 && first && self.before == Outside::Stays => {
                        ActivityKind::Demolish
                    }
                    () => ActivityKind::Temporary,
                };
                let part = if rounds.len() > 1 { format!("/{}", round + 1) } else { String::new() };
                schedule.activities.push(Activity {
                    id: format!("{}@{:04}{part}", self.id, i + 1),
                    name: self.name.clone(),
                    start: Some(step.start.plus_seconds(*later)),
                    end: Some(step.end.plus_seconds(*later)),
                    kind,
                    elements: vec![name.clone()],
                    ..Activity::default()
                });
            }
        }
    }
}

/// The object with the middle of its base at a place, turned about it.
fn place(model: &mut Model, original: &Element, at: Vec3, turned: f32, name: String) -> Element {
    let center = original.bounds.center();
    let base = Vec3::new(center.x, original.bounds.min.y, center.z);
    let moved = Affine3A::from_translation(at)
        * Affine3A::from_mat3(Mat3A::from_rotation_y(turned).into())
        * Affine3A::from_translation(-base);
    let first = model.instances.len() as u32;
    let mut bounds = Aabb::EMPTY;
    for instance in original.instances.clone() {
        let Instance { mesh, world_from_mesh } = model.instances[instance as usize];
        let world_from_mesh = moved * world_from_mesh;
        let vertices = model.meshes[mesh.index()].vertices.iter();
        let corner = |v: Vec3A| Vec3::from(world_from_mesh.transform_point3a(v));
        let own = Aabb::of_points(vertices.map(|v| corner(Vec3A::from(v.position))));
        bounds = bounds.union(&own);
        model.instances.push(Instance { mesh, world_from_mesh });
    }
    let instances = first..model.instances.len() as u32;
    Element { name, guid: None, instances, bounds, ..original.clone() }
}

fn key_of(element: &Element) -> String {
    let guid = element.guid.as_deref().unwrap_or_default();
    if element.name.is_empty() { guid } else { &element.name }.to_owned()
}

/// Other activities do not bring the object back.
fn take_links(model: &Model, schedule: &mut Schedule, object: ElementId, file: &Path) {
    let element = &model.elements[object.index()];
    let is_it = |key: &str| key == element.name || element.guid.as_deref() == Some(key);
    for index in schedule.remove_elements(is_it) {
        let (id, name) = (&schedule.activities[index].id, key_of(element));
        schedule.diagnostics.add(Severity::Info, "moving-element", id, || {
            format!(
                "{}: {name:?} moves on a path; activity {id:?} is not linked to it any more",
                file.display()
            )
        });
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Mesh, Progress, Scene, View, hdlod, link};
    use glam::UVec2;
    use proptest::prelude::*;

    /// A box on the ground at (10, 0, 10), 2 m long, that looks along +Z.
    fn model() -> Model {
        let (mut model, _) = crate::demo::generate(
            &crate::demo::DemoSettings::for_elements(1000),
            &Progress::default(),
        )
        .unwrap();
        let mesh: Mesh = model.meshes[model.instances[0].mesh.index()].clone();
        let mut bounds = Aabb::of_points(mesh.vertices.iter().map(|v| Vec3::from(v.position)));
        let to = Vec3::new(10.0, 0.0, 10.0) - bounds.center();
        bounds = bounds.transformed(&Affine3A::from_translation(to));
        model.meshes = vec![mesh];
        model.instances = vec![Instance {
            mesh: crate::MeshId(0),
            world_from_mesh: Affine3A::from_translation(to),
        }];
        model.elements =
            vec![Element { name: "lorry".into(), instances: 0..1, bounds, ..Element::default() }];
        model.groups.clear();
        model
    }

    fn paths(text: &str) -> Result<Paths, PathsError> {
        Paths::parse(Path::new("ways.json"), text)
    }

    fn scene(text: &str) -> (Scene, Vec<(String, String)>) {
        let (mut model, mut schedule) = (model(), Schedule::default());
        let added = paths(text).unwrap().add_to(&mut model, &mut schedule).unwrap();
        (link::link(model, schedule), added)
    }

    fn base(bounds: &Aabb) -> Vec3 {
        let center = bounds.center();
        Vec3::new(center.x, bounds.min.y, center.z)
    }

    /// Which elements are there at a time, and where.
    fn there(scene: &Scene, time: Time) -> Vec<Vec3> {
        let all = (0..scene.model.elements.len() as u32).map(ElementId);
        let there = all.filter(|&e| scene.behaviour(e).at(time));
        there.map(|e| base(&scene.model.elements[e.index()].bounds)).collect()
    }

    fn at(text: &str) -> Time {
        Time::parse_iso(text).unwrap()
    }

    #[test]
    fn an_object_drives_stands_and_drives_on() {
        let (scene, added) = scene(
            r#"{"format": "topout-paths", "version": 1, "paths": [{"element": "lorry", "id": "L1",
                "step_m": 5, "after": "stays", "points": [
                {"time": "2026-03-02T08:00", "at": [0, 0, 0]},
                {"time": "2026-03-02T08:01", "at": [20, 0, 0]},
                {"time": "2026-03-02T09:00", "at": [20, 0, 0]},
                {"time": "2026-03-02T09:02", "at": [20, 0, 8]}]}]}"#,
        );
        let place = |text| there(&scene, at(text));
        let v = Vec3::new;
        assert_eq!(place("2026-03-02T07:59:59"), []);
        let close = |found: Vec<Vec3>, to: Vec3| {
            assert!(found.len() == 1 && found[0].distance(to) < 1e-4, "{found:?} {to}");
        };
        close(place("2026-03-02T08:00:00"), v(0.0, 0.0, 0.0));
        close(place("2026-03-02T08:00:15"), v(5.0, 0.0, 0.0));
        close(place("2026-03-02T08:00:59"), v(15.0, 0.0, 0.0));
        close(place("2026-03-02T08:01:00"), v(20.0, 0.0, 0.0));
        close(place("2026-03-02T09:01:30"), v(20.0, 0.0, 4.0));
        close(place("2027-01-01"), v(20.0, 0.0, 8.0));
        assert_eq!(added.len(), 1 + 4 + 1 + 2 + 1);
        assert_eq!(added[1], ("L1@0001".to_owned(), "lorry@0001".to_owned()));
    }

    #[test]
    fn rounds_use_the_same_places_again() {
        let (scene, _) = scene(
            r#"{"paths": [{"element": "lorry", "before": "stays", "step_m": 10, "points": [
                {"time": "2026-03-02T08:00", "at": [0, 0, 0]},
                {"time": "2026-03-02T08:10", "at": [20, 0, 0]}],
                "repeat": {"every_minutes": 30, "until": "2026-03-02T09:00"}}]}"#,
        );
        assert_eq!(scene.model.elements.len(), 1 + 2);
        for (text, places) in [
            ("2020-01-01", 1),
            ("2026-03-02T08:00", 1),
            ("2026-03-02T08:10", 0),
            ("2026-03-02T08:30", 1),
            ("2026-03-02T08:39:59", 1),
            ("2026-03-02T08:59", 0),
            ("2026-03-02T09:05", 1),
            ("2026-03-02T09:10", 0),
        ] {
            assert_eq!(there(&scene, at(text)).len(), places, "{text}");
        }
    }

    #[test]
    fn other_activities_do_not_bring_it_back() {
        let mut model = model();
        let text = r#"{"activities": [{"id": "A", "name": "Delivery", "start": "2026-03-01",
            "end": "2026-03-05", "elements": ["lorry"]}]}"#;
        let mut schedule = topout_schedule::read_bytes(
            Path::new("plan.json"),
            text.as_bytes(),
            &Default::default(),
        )
        .unwrap();
        let way = r#"{"paths": [{"element": "lorry", "points": [
            {"time": "2026-03-02T08:00", "at": [0, 0, 0]},
            {"time": "2026-03-02T08:10", "at": [1, 0, 0]}]}]}"#;
        paths(way).unwrap().add_to(&mut model, &mut schedule).unwrap();
        let scene = link::link(model, schedule);
        assert_eq!(there(&scene, at("2026-03-03")), []);
        assert_eq!(scene.diagnostics.get("moving-element").unwrap().examples, ["A"]);
    }

    /// The example is read, and the schema names everything in it and all that is read.
    #[test]
    fn the_schema_names_what_is_read() {
        let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/");
        let read = |name: &str| std::fs::read_to_string(format!("{assets}{name}")).unwrap();
        let schema: serde_json::Value = serde_json::from_str(&read("paths.schema.json")).unwrap();
        let example: serde_json::Value =
            serde_json::from_str(&read("examples/demo-paths.json")).unwrap();
        let keys = |value: &serde_json::Value| -> Vec<String> {
            value.as_object().unwrap().keys().cloned().collect()
        };
        let path = &schema["$defs"]["path"]["properties"];
        for (given, named) in [
            (&example, &schema["properties"]),
            (&example["paths"][0], path),
            (&example["paths"][0]["points"][0], &schema["$defs"]["point"]["properties"]),
            (&example["paths"][0]["repeat"], &path["repeat"]["properties"]),
        ] {
            assert!(keys(given).iter().all(|key| !named[key].is_null()), "{given}");
        }
        assert_eq!(paths(&example.to_string()).unwrap().paths.len(), 1);
        // A value of a type that no property has is refused wherever it stands.
        for key in keys(path) {
            let mut broken = example.clone();
            broken["paths"][0][&key] = serde_json::json!([[[true]]]);
            assert!(paths(&broken.to_string()).is_err(), "{key} is named, but not read");
        }
    }

    #[test]
    fn what_cannot_be_meant_is_said_with_its_place() {
        let point = |time: &str, at: &str| format!(r#"{{"time": "{time}", "at": {at}}}"#);
        let one = point("2026-03-02T08:00", "[0, 0, 0]");
        let two = point("2026-03-02T09:00", "[9, 0, 0]");
        let path = |element: &str, points: &[&String], more: &str| {
            let points: Vec<&str> = points.iter().map(|p| p.as_str()).collect();
            let points = points.join(", ");
            format!(r#"{{"paths": [{{"element": "{element}", "points": [{points}]{more}}}]}}"#)
        };
        let before = point("2026-03-02T08:00", "[1, 0, 0]");
        let far = point("2026-03-02T09:00", "[1e12, 0, 0]");
        let late = point("2026-03-12T09:00", "[900, 0, 0]");
        let never = point("soon", "[1, 0, 0]");
        for (text, says) in [
            (path("lorry", &[&one], ""), "paths[0].points: 1 points"),
            (path("lorry", &[&one, &before], ""), "paths[0].points[1].time: 2026-03-02T08:00:00"),
            (path("lorry", &[&one, &far], ""), "paths[0].points[1].at"),
            (path("lorry", &[&one, &never], ""), "paths[0].points[1].time: \"soon\""),
            (path("lorry", &[&one, &two], r#", "step_m": 0"#), "paths[0].step_m: 0"),
            (
                path("crane", &[&one, &two], ""),
                "paths[0].element: the model has no element \"crane\"",
            ),
            (path("lorry", &[&one, &late], r#", "step_m": 0.00001"#), "more than 100000"),
            (
                path(
                    "lorry",
                    &[&one, &two],
                    r#", "repeat": {"every_minutes": 5, "until": "2027-01-01"}"#,
                ),
                "paths[0].repeat.every_minutes: 5",
            ),
            (
                path(
                    "lorry",
                    &[&one, &two],
                    r#", "repeat": {"every_minutes": 60, "until": "9999-01-01"}"#,
                ),
                "more than 100000",
            ),
            (r#"{"format": "4d-schedule", "paths": []}"#.to_owned(), "4d-schedule"),
            (r#"{"paths": [{}]}"#.to_owned(), "element"),
            ("[".to_owned(), "line 1"),
        ] {
            let added =
                paths(&text).and_then(|paths| paths.add_to(&mut model(), &mut Schedule::default()));
            let said = added.expect_err(&text).to_string();
            assert!(said.starts_with("ways.json: ") && said.contains(says), "{said}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// While it is on its way it is there once, and no farther than a step from where it should be.
        #[test]
        fn it_is_always_somewhere_on_its_way(
            points in proptest::collection::vec((60i64..4000, -50f64..50.0, -50f64..50.0), 2..6),
            step_m in 1f64..20.0,
            probes in proptest::collection::vec(0f64..1.0, 20),
            turn in any::<bool>(),
        ) {
            let mut now = 1_700_000_000;
            let mut way: Vec<(Time, DVec3)> = Vec::new();
            for (later, x, z) in &points {
                now += later;
                way.push((Time::from_seconds(now), DVec3::new(*x, 1.5, *z)));
            }
            let texts: Vec<String> = way.iter().map(|(time, at)| {
                format!(r#"{{"time": "{time}", "at": [{}, {}, {}]}}"#, at.x, at.y, at.z)
            }).collect();
            let (scene, _) = scene(&format!(
                r#"{{"paths": [{{"element": "lorry", "turn": {turn}, "step_m": {step_m}, "points": [{}]}}]}}"#,
                texts.join(", ")
            ));
            let (start, end) = (way[0].0.seconds(), way[way.len() - 1].0.seconds());
            for probe in probes {
                let time = Time::from_seconds(start + ((end - start - 1) as f64 * probe) as i64);
                let next = way.partition_point(|(t, _)| *t <= time).min(way.len() - 1);
                let ((t0, from), (t1, to)) = (way[next - 1], way[next]);
                let share = (time.seconds() - t0.seconds()) as f64 / (t1.seconds() - t0.seconds()) as f64;
                let true_place = from.lerp(to, share).as_vec3();
                let found = there(&scene, time);
                prop_assert_eq!(found.len(), 1, "at {}", time);
                // Turned, the middle of the box may be off by what the corners do.
                let slack = if turn { 1.0 } else { 1e-3 };
                let off = f64::from(found[0].distance(true_place));
                // Half a second of rounding at up to 2.4 m a second.
                prop_assert!(off <= step_m + slack + 2.4, "{} m off at {}", off, time);
            }
            prop_assert!(there(&scene, way[way.len() - 1].0).is_empty());
            let tree =
                hdlod::build(&scene, &hdlod::Settings::default(), &Progress::default()).unwrap();
            let view = View::fit(&scene.model.bounds(), 30.0, 20.0, 2.0, UVec2::new(320, 200));
            let middle = Time::from_seconds(start.midpoint(end));
            prop_assert!(hdlod::select(&scene, &tree, &view, middle).triangles > 0);
        }
    }
}
