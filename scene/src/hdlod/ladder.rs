//! The thresholds of the levels: how coarse a cluster of level l may be, in space and in time.

use topout_schedule::TimeRange;

/// Number of levels that the formula of H12 spans: eps grows by a factor of about 2 from level to
/// level. Fewer would leave gaps between the errors on offer, more would only build slower.
const LEVELS: u32 = 12;

/// Pixels along the picture's height and vertical field of view that the ladder is laid out for
/// (R of H12 is their quotient, pixels per radian). Other pictures only use other parts of it.
const REFERENCE_PX: f32 = 720.0;
const REFERENCE_FOV: f32 = crate::View::FOV_Y;

/// Pixels at the view that just fits the scene which eps(L) spans. Taken literally (1, as H12
/// prints it) nothing exists for the far views; measured good: about 5 (R9).
const TOP_PX: f32 = 5.0;

/// A cluster's box may be this many times its eps across. Keeps the picture of one cluster small
/// on the screen whenever it is drawn: at most this many pixels at a tolerance of one. On a demo
/// of 20,000 elements 32 draws 23 % more triangles at 1/1, from parts that fit in no cluster.
const DIAMETER_PER_EPS: f32 = 64.0;

/// The floor of w: one element of no size must not break the ladder (R9).
const MIN_RELATIVE_SIZE: f32 = 1e-5;

/// Thresholds by level (H12), for a scene of a given size.
#[derive(Clone, Debug)]
pub(crate) struct Ladder {
    top_eps_m: f32,
    relative_size: f32,
    tau: f64,
}

impl Ladder {
    /// `diagonal_m`: of the box of everything over the whole period; `sizes_m`: diameters of the
    /// elements; `events`: number of distinct event times within `period`.
    pub fn new(diagonal_m: f32, mut sizes_m: Vec<f32>, events: usize, period: TimeRange) -> Self {
        let diagonal = if diagonal_m > 0.0 { diagonal_m } else { 1.0 };
        // R9: a low percentile, not the minimum.
        let rank = sizes_m.len() / 20;
        let small = if sizes_m.is_empty() {
            diagonal
        } else {
            *sizes_m.select_nth_unstable_by(rank, f32::total_cmp).1
        };
        let pixels_per_radian = REFERENCE_PX / REFERENCE_FOV;
        // R4: tau = T / typical step between events = the number of events.
        let tau = if period.seconds() > 0 { events.max(2) as f64 } else { 2.0 };
        Self {
            top_eps_m: TOP_PX * diagonal / pixels_per_radian,
            relative_size: (small / diagonal).clamp(MIN_RELATIVE_SIZE, 0.5),
            tau,
        }
    }

    fn share(&self, level: u32) -> f32 {
        self.relative_size.powf(1.0 - level.min(LEVELS) as f32 / LEVELS as f32)
    }

    /// eps(l) in metres: w^(1 - l/L) up to L (H12, R5), doubling beyond (R9). Strictly increasing.
    pub fn eps_m(&self, level: u32) -> f32 {
        let beyond = level.saturating_sub(LEVELS).min(60);
        self.top_eps_m * self.share(level) * 2f32.powi(beyond as i32)
    }

    /// gamma(l) of H12 with tau as R4 reads it, from about 1/tau to 1; 1 beyond L (R9).
    pub fn gamma(&self, level: u32) -> f64 {
        let floor = 1.0 / self.tau;
        floor + (1.0 - floor) * f64::from(self.share(level))
    }

    /// Largest diameter in metres of a cluster's box at a level.
    pub fn diameter_m(&self, level: u32) -> f32 {
        self.eps_m(level) * DIAMETER_PER_EPS
    }

    /// Whether the level lies beyond those of H12, where only R9 says to go on.
    pub fn is_beyond(&self, level: u32) -> bool {
        level > LEVELS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use topout_schedule::Time;

    #[test]
    fn thresholds_rise_strictly_and_go_on_past_the_last_level() {
        let period = TimeRange { start: Time::from_seconds(0), end: Time::from_seconds(1000) };
        let ladder = Ladder::new(520.0, vec![0.0, 0.4, 0.5, 3.0], 100, period);
        for level in 0..30 {
            assert!(ladder.eps_m(level) < ladder.eps_m(level + 1), "eps at {level}");
            if level < LEVELS {
                assert!(ladder.gamma(level) < ladder.gamma(level + 1), "gamma at {level}");
            }
        }
        assert!((ladder.gamma(LEVELS) - 1.0).abs() < 1e-6);
        assert!(ladder.gamma(0) >= 0.01);
        assert!(!ladder.is_beyond(LEVELS) && ladder.is_beyond(LEVELS + 1));
    }

    #[test]
    fn scenes_without_extent_or_period_still_have_a_ladder() {
        let ladder = Ladder::new(0.0, vec![0.0; 5], 0, TimeRange::default());
        assert!(ladder.eps_m(0) > 0.0 && ladder.eps_m(80).is_finite());
        assert!(ladder.gamma(0) > 0.0);
    }
}
