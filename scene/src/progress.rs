//! Progress and cancellation of work on another thread.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// The work was cancelled by the user.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// Shared between a worker, which reports and asks, and a watcher, which reads and cancels.
#[derive(Debug, Default)]
pub struct Progress {
    stage: Mutex<Stage>,
    done: AtomicU64,
    total: AtomicU64,
    cancel: AtomicBool,
}

#[derive(Debug, Default)]
struct Stage {
    name: String,
    since: Option<Instant>,
    finished: Vec<(String, Duration)>,
}

impl Stage {
    /// Books the running stage's time; stages of the same name add up.
    fn end(&mut self) {
        let Some(since) = self.since.take() else { return };
        match self.finished.iter_mut().find(|(name, _)| *name == self.name) {
            Some((_, time)) => *time += since.elapsed(),
            None => self.finished.push((self.name.clone(), since.elapsed())),
        }
    }
}

impl Progress {
    /// Starts a stage of `total` steps. Fails when cancelled.
    pub fn begin(&self, stage: &str, total: u64) -> Result<(), Cancelled> {
        if let Ok(mut s) = self.stage.lock() {
            s.end();
            stage.clone_into(&mut s.name);
            s.since = Some(Instant::now());
        }
        self.done.store(0, Ordering::Relaxed);
        self.total.store(total, Ordering::Relaxed);
        self.check()
    }

    /// Counts finished steps. Fails when cancelled.
    pub fn advance(&self, steps: u64) -> Result<(), Cancelled> {
        self.done.fetch_add(steps, Ordering::Relaxed);
        self.check()
    }

    /// Fails when cancelled.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.cancel.load(Ordering::Relaxed) { Err(Cancelled) } else { Ok(()) }
    }

    /// Asks the worker to stop at its next step.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// The current stage and the finished share of it in [0, 1] (0 when unknown).
    pub fn state(&self) -> (String, f32) {
        let stage = self.stage.lock().map(|s| s.name.clone()).unwrap_or_default();
        let total = self.total.load(Ordering::Relaxed);
        let done = self.done.load(Ordering::Relaxed);
        let share = if total == 0 { 0.0 } else { (done as f32 / total as f32).min(1.0) };
        (stage, share)
    }

    /// Ends the running stage and says how long each stage took, in the order of their beginning.
    pub fn phases(&self) -> Vec<(String, Duration)> {
        let Ok(mut stage) = self.stage.lock() else { return Vec::new() };
        stage.end();
        stage.finished.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_of_one_name_add_up_in_order() {
        let progress = Progress::default();
        for stage in ["read", "merge", "read"] {
            progress.begin(stage, 0).expect("not cancelled");
            std::thread::sleep(Duration::from_millis(2));
        }
        let phases = progress.phases();
        assert_eq!(phases.iter().map(|(n, _)| n.as_str()).collect::<Vec<_>>(), ["read", "merge"]);
        assert!(phases[0].1 >= Duration::from_millis(4));
        assert_eq!(progress.phases(), phases, "nothing runs after the end");
    }

    #[test]
    fn cancelling_stops_the_next_step() {
        let progress = Progress::default();
        assert_eq!(progress.advance(1), Ok(()));
        progress.cancel();
        assert_eq!(progress.advance(1), Err(Cancelled));
        assert_eq!(progress.begin("more", 3), Err(Cancelled));
    }
}
