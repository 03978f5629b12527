//! `topout verify`: does the tree keep what it promises?

use super::{Outcome, args, load, stage, terminal};
use crate::report::{Output, columns, count, grouped, rounded};
use serde::Serialize;
use serde_json::{Map, Value};
use std::fmt::Write;
use std::sync::Arc;
use std::time::Instant;
use topout_scene::Progress;
use topout_scene::hdlod::Temporal;
use topout_scene::hdlod::audit;
use topout_scene::hdlod::verify::{self, Plan};

/// Clusters that `--certificates` measures, about.
const AUDITED: usize = 400;

/// The keys that scripts read.
#[derive(Serialize, Debug)]
struct Report {
    temporal: &'static str,
    tolerance_px: f32,
    full: bool,
    clusters: usize,
    clusters_checked: usize,
    structure_violations: usize,
    eps_violations: usize,
    gamma_violations: usize,
    /// Median of the largest distance that was measured, as a share of eps.
    median_eps_share: f64,
    pictures: usize,
    points_checked: u64,
    promise_violations: u64,
    wrong_points: u64,
    worst_px: f64,
    paper_worst_region_px: u64,
    paper_worst_region_at: String,
    /// Building the tree, or taking it from the cache.
    bake_seconds: f64,
    cache_hit: bool,
    /// Checking it.
    seconds: f64,
    /// Seconds of each phase of the check, in order.
    phases: Map<String, Value>,
    /// Some of the violations, in words.
    findings: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    certificates: Option<Certificates>,
}

/// How tight certified errors are, and what others claim.
#[derive(Serialize, Debug)]
struct Certificates {
    clusters: usize,
    upper_over_sampled: Spread,
    claims: Vec<Claim>,
}

/// Infinite figures are null.
#[derive(Serialize, Debug)]
struct Spread {
    median: f64,
    p90: f64,
    max: f64,
}

#[derive(Serialize, Debug)]
struct Claim {
    way: &'static str,
    triangles_kept: f64,
    true_over_claimed: Spread,
    within_eps: f64,
    disproved: f64,
}

impl From<audit::Spread> for Spread {
    fn from(s: audit::Spread) -> Self {
        Self { median: rounded(s.median, 3), p90: rounded(s.p90, 3), max: rounded(s.max, 3) }
    }
}

impl From<audit::Audit> for Certificates {
    fn from(audit: audit::Audit) -> Self {
        let claims = audit.claims.into_iter().map(|c| Claim {
            way: c.way,
            triangles_kept: rounded(c.triangles_kept, 4),
            true_over_claimed: c.true_over_claimed.into(),
            within_eps: rounded(c.within_eps, 4),
            disproved: rounded(c.disproved, 4),
        });
        Self {
            clusters: audit.clusters,
            upper_over_sampled: audit.upper_over_sampled.into(),
            claims: claims.collect(),
        }
    }
}

impl Certificates {
    fn text(&self) -> String {
        let cell = |v: f64| if v.is_finite() { format!("{v:.2}") } else { "gone".to_owned() };
        let spread = |s: &Spread| [cell(s.median), cell(s.p90), cell(s.max)];
        let [median, p90, max] = spread(&self.upper_over_sampled);
        let head = [
            "Error: true / claimed",
            "median",
            "p90",
            "largest",
            "too small",
            "within eps",
            "triangles",
        ];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        rows.extend(self.claims.iter().map(|c| {
            let percent = |v: f64| format!("{:.1} %", v * 100.0);
            let mut row = vec![format!("  {}", c.way)];
            row.extend(spread(&c.true_over_claimed));
            row.extend([c.disproved, c.within_eps, c.triangles_kept].map(percent));
            row
        }));
        format!(
            "Certified upper bound / largest sampled distance, {} clusters: median {median}, \
             p90 {p90}, largest {max}\n{}",
            self.clusters,
            columns(&rows)
        )
    }
}

/// Builds the tree, checks it, and says whether anything is wrong.
pub fn run(args: &args::Verify) -> anyhow::Result<Outcome> {
    let output = Output::new(args.common.json.clone());
    let scene = load(&args.common.request(), &Arc::default())?;
    let mut baked = stage::bake(&scene, &args.common, args.caching.cache(), &Arc::default())?;
    baked.keep();
    let tree = &baked.tree;

    let plan = if args.full { Plan::full } else { Plan::sample };
    let plan = plan(args.common.size, args.common.tolerance);
    let progress = Arc::new(Progress::default());
    let started = Instant::now();
    let found = {
        let _line = terminal::ProgressLine::show(&progress);
        verify::verify(&scene, tree, &plan, &progress)?
    };
    let seconds = started.elapsed().as_secs_f64();
    let certificates = if args.certificates {
        Some(audit::audit(&scene, tree, AUDITED, &progress)?)
    } else {
        None
    };
    let report = Report {
        temporal: match tree.temporal {
            Temporal::Tight => "tight",
            Temporal::Paper => "paper",
        },
        tolerance_px: args.common.tolerance,
        full: args.full,
        clusters: tree.clusters.len(),
        clusters_checked: found.clusters_checked,
        structure_violations: found.structure_violations,
        eps_violations: found.eps_violations,
        gamma_violations: found.gamma_violations,
        median_eps_share: rounded(found.median_eps_share.into(), 3),
        pictures: found.pictures,
        points_checked: found.points_checked,
        promise_violations: found.promise_violations,
        wrong_points: found.wrong_points,
        worst_px: rounded(found.worst_px.into(), 3),
        paper_worst_region_px: found.worst_region_px,
        paper_worst_region_at: found.worst_region_at.clone(),
        bake_seconds: rounded(baked.seconds, 3),
        cache_hit: baked.from_cache,
        seconds: rounded(seconds, 3),
        phases: progress
            .phases()
            .into_iter()
            .map(|(name, time)| (name, rounded(time.as_secs_f64(), 3).into()))
            .collect(),
        findings: found.findings.iter().map(|f| f.message.clone()).collect(),
        certificates: certificates.map(Into::into),
    };
    output.say(&report.text());
    output.write(&report)?;
    Ok(if found.is_clean() { Outcome::Fine } else { Outcome::BadData })
}

impl Report {
    fn text(&self) -> String {
        let mut text = format!(
            "Checked {} of {} clusters and {} points of {} pictures, mode {}, in {:.1} s\n",
            count(self.clusters_checked),
            count(self.clusters),
            grouped(self.points_checked),
            count(self.pictures),
            self.temporal,
            self.seconds,
        );
        let mut row = |key: &str, value: String| {
            let _ = writeln!(text, "  {key:<24}{value}");
        };
        row("structure violations", count(self.structure_violations));
        row("eps violations", count(self.eps_violations));
        row("gamma violations", count(self.gamma_violations));
        row("promise violations", grouped(self.promise_violations));
        row("eps that is made use of", format!("{:.0} % (median)", self.median_eps_share * 100.0));
        let of = format!("{:.2} px of {} allowed", self.worst_px, self.tolerance_px);
        row("worst visible point", of);
        if self.paper_worst_region_px > 0 {
            let (size, at) = (grouped(self.paper_worst_region_px), &self.paper_worst_region_at);
            row("largest wrong region", format!("{size} px, view {at}"));
        }
        for finding in &self.findings {
            let _ = writeln!(text, "  - {finding}");
        }
        if let Some(certificates) = &self.certificates {
            text.push_str(&certificates.text());
        }
        text
    }
}
