//! How long work will go on, told from how far it is.
//!
//! Shares grow in bursts and slow down, so a plain rule of three jumps about. What is told here moves slowly, runs
//! down with the clock, and is not told at all before there is something to tell it from.

use std::time::Duration;

/// A stage must have gone on for so long, seconds.
const LEAST_SECONDS: f64 = 3.0;
/// And so much of it must be done.
const LEAST_SHARE: f64 = 0.02;
/// In so many steps, so that one burst is not taken for the pace.
const LEAST_STEPS: u32 = 4;
/// The pace is a mean over about so many seconds.
const PACE_SECONDS: f64 = 10.0;
/// What is told follows the pace within about so many seconds.
const FOLLOW_SECONDS: f64 = 4.0;
/// Longer is not told: nobody knows what happens in a day.
const LONGEST_SECONDS: f64 = 86_400.0;

/// The time that the running stage of some work will still take.
#[derive(Clone, Debug, Default)]
pub struct Estimate {
    stage: String,
    /// When the stage began, and when it was looked at last; seconds since anything.
    begun: f64,
    seen: f64,
    share: f64,
    steps: u32,
    /// Share a second, once there is one.
    pace: f64,
    /// Seconds left, smoothed.
    left: Option<f64>,
    told: Option<u64>,
}

impl Estimate {
    /// The seconds left of a stage of which `share` in [0, 1] is done at `now`, an instant that never runs
    /// backward; `None` while that cannot be told. Another name of the stage starts anew.
    pub fn update(&mut self, stage: &str, share: f32, now: Duration) -> Option<u64> {
        let (now, share) = (now.as_secs_f64(), f64::from(share).clamp(0.0, 1.0));
        if self.stage != stage || share < self.share {
            let stage = stage.to_owned();
            *self = Self { stage, begun: now, seen: now, share, ..Self::default() };
            return None;
        }
        let passed = now - self.seen;
        if passed <= 0.0 {
            return self.told;
        }
        let (whole, gained) = (now - self.begun, share - self.share);
        self.seen = now;
        self.share = share;
        self.steps += u32::from(gained > 0.0);
        // The mean since the beginning, until that is longer than what the pace is a mean over.
        let weight = (passed / whole.min(PACE_SECONDS)).min(1.0);
        self.pace += (gained / passed - self.pace) * weight;
        let ready = whole >= LEAST_SECONDS
            && share >= LEAST_SHARE
            && self.steps >= LEAST_STEPS
            && share < 1.0;
        if !ready || self.pace <= 0.0 {
            self.told = None;
            return None;
        }
        let expected = (1.0 - share) / self.pace;
        let left = match self.left {
            None => expected,
            Some(left) => {
                let left = (left - passed).max(0.0);
                left + (expected - left) * (1.0 - (-passed / FOLLOW_SECONDS).exp())
            }
        };
        self.left = Some(left);
        self.told = (left < LONGEST_SECONDS).then(|| self.rounded(left));
        self.told
    }

    /// In steps that suit the size; the last one stays unless another is clearly nearer.
    fn rounded(&self, left: f64) -> u64 {
        let step = step_s(left);
        match self.told {
            Some(told) if (told as f64 - left).abs() < 0.6 * step => told,
            _ => ((left / step).round() * step).max(1.0) as u64,
        }
    }
}

/// What seconds are rounded to where so many are left.
fn step_s(left: f64) -> f64 {
    match left {
        ..20.0 => 1.0,
        ..60.0 => 5.0,
        ..120.0 => 10.0,
        ..600.0 => 30.0,
        ..3600.0 => 60.0,
        _ => 300.0,
    }
}

/// `12 s left`, `3 min left`, `2 h 10 min left`.
pub fn left_text(seconds: u64) -> String {
    let minutes = seconds.div_ceil(60);
    match seconds {
        0..90 => format!("{seconds} s left"),
        90..5400 => format!("{minutes} min left"),
        _ => format!("{} h {} min left", minutes / 60, minutes % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is told every tenth of a second of work whose share is a function of the seconds.
    fn told(seconds: f64, share: impl Fn(f64) -> f64) -> Vec<(f64, Option<u64>)> {
        let mut estimate = Estimate::default();
        let steps = (seconds * 10.0) as u32;
        let at = |step: u32| f64::from(step) / 10.0;
        let mut tell =
            |now: f64| estimate.update("work", share(now) as f32, Duration::from_secs_f64(now));
        (0..=steps).map(|step| (at(step), tell(at(step)))).collect()
    }

    #[test]
    fn steady_work_is_told_rightly_after_a_few_seconds_and_not_before() {
        for whole in [8.0_f64, 40.0, 1000.0] {
            for (now, left) in told(whole.min(140.0), |now| now / whole) {
                let early = now < LEAST_SECONDS || now / whole < LEAST_SHARE - 0.001;
                assert!(!early || left.is_none(), "{whole}: {left:?} after {now}");
                if now > whole.min(100.0) * 0.4 + 2.0 && now < whole {
                    let left = left.expect("it is known") as f64;
                    let true_left = whole - now;
                    assert!((left - true_left).abs() <= 1.0 + true_left * 0.15, "{left} at {now}");
                }
            }
        }
    }

    /// Bursts of a twentieth, and a pace that drops to a third in the middle.
    #[test]
    fn what_is_told_never_jumps() {
        let bursts = |now: f64| ((now / 60.0) * 20.0).floor() / 20.0;
        let slower = |now: f64| if now < 30.0 { now / 60.0 } else { 0.5 + (now - 30.0) / 180.0 };
        let stalls = |now: f64| if now < 20.0 { now / 60.0 } else { 1.0 / 3.0 };
        for share in [&bursts as &dyn Fn(f64) -> f64, &slower, &stalls] {
            let told = told(110.0, share);
            assert!(told.iter().any(|(_, left)| left.is_some()));
            for pair in told.windows(2) {
                if let [(now, Some(before)), (_, Some(after))] = pair {
                    let step = before.abs_diff(*after) as f64;
                    // A step of rounding, and what a tenth of a second moves.
                    let allowed = step_s(before.max(after).to_owned() as f64);
                    assert!(step <= allowed + 0.05 * *before as f64, "{before} {after} at {now}");
                }
            }
        }
    }

    #[test]
    fn another_stage_or_one_burst_tells_nothing() {
        let mut estimate = Estimate::default();
        let mut tell =
            |stage: &str, share, now| estimate.update(stage, share, Duration::from_secs_f64(now));
        for step in 0..100 {
            tell("a", step as f32 / 200.0, f64::from(step) / 10.0);
        }
        assert_eq!(tell("a", 0.5, 10.0), Some(10));
        assert_eq!(tell("b", 0.5, 10.1), None, "another stage");
        for step in 0..100 {
            assert_eq!(tell("b", 0.6, 11.0 + f64::from(step)), None, "one burst is no pace");
        }
        assert_eq!(tell("b", 0.1, 120.0), None, "what goes back began anew");
        assert_eq!(told(60.0, |_| 0.0).last(), Some(&(60.0, None)), "no share is known");
    }

    #[test]
    fn seconds_are_told_in_words() {
        for (seconds, text) in [
            (1, "1 s left"),
            (85, "85 s left"),
            (90, "2 min left"),
            (600, "10 min left"),
            (7_500, "2 h 5 min left"),
        ] {
            assert_eq!(left_text(seconds), text);
        }
    }
}
