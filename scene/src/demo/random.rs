//! Numbers that are the same on every machine: a small generator and an exact sine.

/// SplitMix64: one multiplication chain a number, no platform dependence.
#[derive(Clone, Debug)]
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1234_5678_9abc_def1)
    }

    pub(super) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    /// In [0, 1), a multiple of 2^-24 and so exact in f32.
    pub(super) fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u32 << 24) as f32
    }

    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// In 0..n; `n` must not be 0.
    pub(super) fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
}

/// The finaliser of SplitMix64: a good hash of one word.
pub(super) fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Sine and cosine of an angle in turns. The C library's differ from machine to machine in the last
/// bit; this uses additions and multiplications only, which do not.
pub(super) fn sin_cos(turns: f32) -> (f32, f32) {
    let t = f64::from(turns) - f64::from(turns).floor();
    let quadrant = ((t * 4.0).floor() as usize).min(3);
    let x = (t - quadrant as f64 * 0.25) * std::f64::consts::TAU;
    let (s, c) = (series(x, 1), series(x, 0));
    let (s, c) = match quadrant {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    };
    (s as f32, c as f32)
}

/// Taylor series of sine (`first` = 1) or cosine (0) on [0, pi / 2].
fn series(x: f64, first: u32) -> f64 {
    let mut term = if first == 1 { x } else { 1.0 };
    let mut sum = term;
    let mut n = first;
    for _ in 0..11 {
        term *= -x * x / (f64::from(n + 1) * f64::from(n + 2));
        sum += term;
        n += 2;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_agrees_with_the_library() {
        for i in -50..150 {
            let turns = i as f32 * 0.013;
            let (s, c) = sin_cos(turns);
            let (s2, c2) = (f64::from(turns) * std::f64::consts::TAU).sin_cos();
            assert!(
                (f64::from(s) - s2).abs() < 1e-6 && (f64::from(c) - c2).abs() < 1e-6,
                "{turns}"
            );
        }
    }

    #[test]
    fn numbers_stay_in_their_range() {
        let mut random = Random::new(7);
        for _ in 0..1000 {
            assert!((2.0..3.0).contains(&random.between(2.0, 3.0)));
            assert!(random.below(5) < 5);
        }
    }
}
