//! Standard error: progress, errors and the log.

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
            let mut step = Step::default();
            while stopped.recv_timeout(Duration::from_millis(100)) == Err(RecvTimeoutError::Timeout)
            {
                let (stage, share) = progress.state();
                bar.set_message(step.describe(&stage, share));
                bar.set_position((share * 1000.0) as u64);
            }
            bar.finish_and_clear();
        });
        Self { worker: worker.ok().map(|worker| (stop, worker)) }
    }
}

/// The stage that is shown and when it began.
#[derive(Default)]
struct Step {
    name: String,
    since: Option<Instant>,
}

impl Step {
    /// With the time that is left, once there is something to tell it from.
    fn describe(&mut self, stage: &str, share: f32) -> String {
        const LEAST_SHARE: f32 = 0.02;
        const LEAST_SECONDS: f32 = 3.0;
        if self.name != stage {
            (self.name, self.since) = (stage.to_owned(), None);
        }
        let passed = self.since.get_or_insert_with(Instant::now).elapsed().as_secs_f32();
        if share < LEAST_SHARE || passed < LEAST_SECONDS {
            return stage.to_owned();
        }
        let left = (passed * (1.0 - share) / share) as u64;
        match left {
            0..120 => format!("{stage}, {left} s left"),
            _ => format!("{stage}, {} min left", left.div_ceil(60)),
        }
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
        let mut step = Step::default();
        assert_eq!(step.describe("build", 0.5), "build", "it only began");
        step.since = Instant::now().checked_sub(Duration::from_secs(10));
        assert_eq!(step.describe("build", 0.001), "build", "too little to tell it from");
        assert_eq!(step.describe("build", 0.5), "build, 10 s left");
        step.since = Instant::now().checked_sub(Duration::from_secs(90));
        assert_eq!(step.describe("build", 0.25), "build, 5 min left");
        assert_eq!(step.describe("write", 0.25), "write", "another step");
    }
}
