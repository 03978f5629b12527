//! `topout bake`: build the HDLOD tree and say what it is like.

use super::{Outcome, args, load, stage};
use crate::report::{Output, count, peak_rss_mb, rounded};
use serde::Serialize;
use serde_json::{Map, Value};
use std::fmt::Write;
use std::sync::Arc;
use std::time::Instant;
use topout_scene::{Hdlod, Progress, Scene};

/// The keys that scripts read.
#[derive(Serialize, Debug)]
struct Report {
    elements: usize,
    triangles: usize,
    clusters: usize,
    levels: usize,
    depth: usize,
    max_degree: usize,
    root_triangles: usize,
    cluster_triangles: usize,
    geometry_bytes: usize,
    behaviour_bytes: usize,
    /// What each level of the build did.
    level_table: Vec<Level>,
    /// Linked scene to finished tree.
    seconds: f64,
    peak_rss_mb: Option<f64>,
    cache_bytes: u64,
    cache_hit: bool,
    /// Seconds of each phase, in order.
    phases: Map<String, Value>,
}

/// One level of the build.
#[derive(Serialize, Debug)]
struct Level {
    level: u32,
    eps_m: f32,
    clusters: usize,
    active: usize,
    triangles: usize,
}

/// Builds and reports.
pub fn run(args: &args::Bake) -> anyhow::Result<Outcome> {
    let output = Output::new(args.common.json.clone());
    let loading = Arc::new(Progress::default());
    let scene = load(&args.common.request(), &loading)?;
    let baking = Arc::new(Progress::default());
    let started = Instant::now();
    let tree = stage::bake(&scene, &args.common, &baking)?;
    let seconds = started.elapsed().as_secs_f64();
    let report = Report::of(&scene, &tree, seconds, [&loading, &baking]);
    output.say(&report.text());
    output.write(&report)?;
    Ok(Outcome::Fine)
}

impl Report {
    fn of(scene: &Scene, tree: &Hdlod, seconds: f64, work: [&Progress; 2]) -> Self {
        let stats = tree.stats();
        let phases = work.iter().flat_map(|p| p.phases());
        let levels = tree.levels.iter().map(|l| Level {
            level: l.level,
            eps_m: l.eps_m,
            clusters: l.clusters,
            active: l.active,
            triangles: l.triangles,
        });
        Self {
            elements: scene.model.elements.len(),
            triangles: scene.model.triangle_count(),
            clusters: stats.clusters,
            levels: tree.levels.len(),
            depth: stats.depth,
            max_degree: stats.max_degree,
            root_triangles: stats.root_triangles,
            cluster_triangles: stats.triangles,
            geometry_bytes: stats.geometry_bytes,
            behaviour_bytes: stats.behaviour_bytes,
            level_table: levels.collect(),
            seconds: rounded(seconds, 3),
            peak_rss_mb: peak_rss_mb(),
            cache_bytes: 0,
            cache_hit: false,
            phases: phases
                .map(|(name, time)| (name, rounded(time.as_secs_f64(), 3).into()))
                .collect(),
        }
    }

    fn text(&self) -> String {
        let mut text = format!(
            "HDLOD of {} elements, {} triangles, built in {:.1} s\n",
            count(self.elements),
            count(self.triangles),
            self.seconds
        );
        let mut row = |key: &str, value: String| {
            let _ = writeln!(text, "  {key:<18}{value}");
        };
        row("clusters", count(self.clusters));
        row("levels", format!("{} (deepest leaf {})", self.levels, self.depth));
        row("largest degree", count(self.max_degree));
        row(
            "triangles",
            format!(
                "{} in clusters, {} of them in the root",
                count(self.cluster_triangles),
                count(self.root_triangles)
            ),
        );
        let bytes = self.geometry_bytes + self.behaviour_bytes;
        row("memory", format!("{:.1} MB for the tree", bytes as f64 / 1e6));
        if let Some(mb) = self.peak_rss_mb {
            row("peak memory", format!("{mb:.0} MB for the process"));
        }
        text.push_str(&self.level_text());
        text.push_str("Phases (s)\n");
        for (name, seconds) in &self.phases {
            let _ = writeln!(text, "  {:<32}{:>8.2}", name, seconds.as_f64().unwrap_or_default());
        }
        text
    }

    fn level_text(&self) -> String {
        let head = ["Level", "eps (m)", "clusters", "active", "triangles drawn by them"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        rows.extend(self.level_table.iter().map(|l| {
            vec![
                format!("  {}", l.level),
                format!("{:.3}", l.eps_m),
                count(l.clusters),
                count(l.active),
                count(l.triangles),
            ]
        }));
        crate::report::columns(&rows)
    }
}
