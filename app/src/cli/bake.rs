//! `topout bake`: build the HDLOD tree and say what it is like.

use super::{Outcome, args, load, stage};
use crate::report::{Output, count, peak_rss_mb, rounded};
use crate::tree::Baked;
use serde::Serialize;
use serde_json::{Map, Value};
use std::fmt::Write;
use std::sync::Arc;
use topout_scene::cache::Cache;
use topout_scene::hdlod::LevelReport;
use topout_scene::{Progress, Scene};

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
    /// Where trees are kept; none without a cache.
    cache_folder: Option<String>,
    /// Seconds of each phase, in order.
    phases: Map<String, Value>,
}

/// One level of the tree, as [`LevelReport`] says.
#[derive(Serialize, Debug)]
struct Level {
    level: u32,
    eps_m: f32,
    clusters: usize,
    mean_degree: f64,
    max_degree: usize,
    cluster_triangles: usize,
    active: usize,
    /// Drawn by the active nodes.
    triangles: usize,
    overlap: f64,
    area_kept: f64,
    gamma_limit: f64,
    gamma_median: f64,
    gamma_max: f64,
}

impl From<LevelReport> for Level {
    fn from(l: LevelReport) -> Self {
        Self {
            level: l.level,
            eps_m: l.eps_m,
            clusters: l.clusters,
            mean_degree: rounded(l.mean_degree, 2),
            max_degree: l.max_degree,
            cluster_triangles: l.triangles,
            active: l.active,
            triangles: l.active_triangles,
            overlap: rounded(l.overlap, 4),
            area_kept: rounded(l.area_kept, 4),
            gamma_limit: rounded(l.gamma_limit, 4),
            gamma_median: rounded(l.gamma_median, 4),
            gamma_max: rounded(l.gamma_max, 4),
        }
    }
}

/// Builds and reports.
pub fn run(args: &args::Bake) -> anyhow::Result<Outcome> {
    let output = Output::new(args.common.json.clone());
    let loading = Arc::new(Progress::default());
    let scene = load(&args.common.request(), &loading)?;
    let mut phases = stage::Phases::default();
    phases.append(&loading);
    let baking = Arc::new(Progress::default());
    let cache = args.caching.cache();
    let mut baked = stage::bake(&scene, &args.common, cache.clone(), &baking)?;
    phases.append(&baking);
    if cache.is_some() && !baked.from_cache {
        phases.time("cache: writing", || baked.keep());
    }
    let report = Report::of(&scene, &baked, cache.as_ref(), &phases);
    output.say(&report.text());
    output.write(&report)?;
    Ok(Outcome::Fine)
}

impl Report {
    fn of(scene: &Scene, baked: &Baked, cache: Option<&Cache>, phases: &stage::Phases) -> Self {
        let tree = &baked.tree;
        let stats = tree.stats();
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
            level_table: tree.report(scene).into_iter().map(Level::from).collect(),
            seconds: rounded(baked.seconds, 3),
            peak_rss_mb: peak_rss_mb(),
            cache_bytes: baked.cache_bytes,
            cache_hit: baked.from_cache,
            cache_folder: cache.map(|c| c.folder().display().to_string()),
            phases: phases.as_json(),
        }
    }

    fn text(&self) -> String {
        let mut text = format!(
            "HDLOD of {} elements, {} triangles, {} in {:.1} s\n",
            count(self.elements),
            count(self.triangles),
            if self.cache_hit { "taken from the cache" } else { "built" },
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
        let megabytes = self.cache_bytes as f64 / 1e6;
        row(
            "cache",
            match (&self.cache_folder, self.cache_bytes) {
                (None, _) => "not used".to_owned(),
                (Some(folder), 0) => format!("not kept in {folder}"),
                (Some(folder), _) => format!("{megabytes:.1} MB in {folder}"),
            },
        );
        text.push_str(&self.level_text());
        text.push_str("Phases (s)\n");
        for (name, seconds) in &self.phases {
            let _ = writeln!(text, "  {:<32}{:>8.2}", name, seconds.as_f64().unwrap_or_default());
        }
        text
    }

    fn level_text(&self) -> String {
        let head = [
            "Level",
            "eps (m)",
            "clusters",
            "degree mean",
            "max",
            "triangles",
            "active nodes",
            "draw",
            "overlap",
            "area kept",
            "gamma limit",
            "median",
            "max",
        ];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        for l in &self.level_table {
            // A level without clusters has no such figures.
            let some = |text: String| if l.clusters > 0 { text } else { "-".to_owned() };
            rows.push(vec![
                format!("  {}", l.level),
                format!("{:.3}", l.eps_m),
                count(l.clusters),
                some(format!("{:.1}", l.mean_degree)),
                some(l.max_degree.to_string()),
                count(l.cluster_triangles),
                count(l.active),
                count(l.triangles),
                some(format!("{:.1} %", l.overlap * 100.0)),
                some(format!("{:.1} %", l.area_kept * 100.0)),
                format!("{:.4}", l.gamma_limit),
                some(format!("{:.4}", l.gamma_median)),
                some(format!("{:.4}", l.gamma_max)),
            ]);
        }
        crate::report::columns(&rows)
    }
}
