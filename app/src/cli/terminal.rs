//! Standard error: progress, errors and the log.

use crate::estimate::{Estimate, left_text};
use crate::report::describe;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use topout_scene::Progress;

/// Log lines go to standard error; `RUST_LOG` says which, warnings by default.
pub fn log_to_stderr() {
    let filter = tracing_subscriber::EnvFilter::try_from_default_env()
        .unwrap_or_else(|_| "warn,wgpu_core=error,wgpu_hal=error,naga=error".into());
    let _ = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .without_time()
        .try_init();
}

/// Prints an error with what caused it.
pub fn say_error(error: &anyhow::Error) {
    let _ = writeln!(std::io::stderr(), "error: {}", describe(error));
}

/// A line that shows the stage of some work, as long as this value lives; nothing where standard
/// error is no terminal.
pub struct ProgressLine {
    worker: Option<(Sender<()>, JoinHandle<()>)>,
}

impl ProgressLine {
    /// Shows `progress` until the value is dropped.
    pub fn show(progress: &Arc<Progress>) -> Self {
        if !std::io::stderr().is_terminal() {
            return Self { worker: None };
        }
        let (stop, stopped) = channel();
        let progress = Arc::clone(progress);
        let worker = std::thread::Builder::new().name("progress".to_owned()).spawn(move || {
            let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("{msg:<44} {bar:30} {elapsed}") {
                bar.set_style(style);
            }
            let (mut estimate, started) = (Estimate::default(), Instant::now());
            while stopped.recv_timeout(Duration::from_millis(100)) == Err(RecvTimeoutError::Timeout)
            {
                let (stage, share) = progress.state();
                bar.set_message(described(&mut estimate, &stage, share, started.elapsed()));
                bar.set_position((share * 1000.0) as u64);
            }
            bar.finish_and_clear();
        });
        Self { worker: worker.ok().map(|worker| (stop, worker)) }
    }
}

/// A stage, with the time that is left of it once that can be told.
fn described(estimate: &mut Estimate, stage: &str, share: f32, now: Duration) -> String {
    match estimate.update(stage, share, now) {
        Some(left) => format!("{stage}, {}", left_text(left)),
        None => stage.to_owned(),
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        if let Some((stop, worker)) = self.worker.take() {
            drop(stop);
            let _ = worker.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_told_once_it_is_known() {
        let mut estimate = Estimate::default();
        let mut told = |stage: &str, share: f32, seconds: f64| {
            described(&mut estimate, stage, share, Duration::from_secs_f64(seconds))
        };
        assert_eq!(told("build", 0.0, 0.0), "build", "it only began");
        for tenth in 1..=100 {
            told("build", tenth as f32 / 200.0, f64::from(tenth) / 10.0);
        }
        assert_eq!(told("build", 0.505, 10.1), "build, 10 s left");
        assert_eq!(told("write", 0.25, 10.2), "write", "another step");
    }
}
