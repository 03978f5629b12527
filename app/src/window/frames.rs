//! The last frames and what they took.

use crate::bench::percentile;
use std::collections::VecDeque;
use topout_render::{FrameStats, FrameTimings, GpuTimes};

/// Figures of the last frames that were really rendered.
#[derive(Clone, Debug, Default)]
pub struct FrameLog {
    frames: VecDeque<Entry>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    stats: FrameStats,
    /// All is known that the adapter will tell.
    complete: bool,
}

impl FrameLog {
    /// Frames that are remembered.
    pub const REMEMBERED: usize = 120;

    /// Remembers a frame. Where the adapter tells its time (`gpu_tells`), the frame counts only once that
    /// has come, see [`FrameLog::add_gpu_times`].
    pub fn show(&mut self, stats: FrameStats, gpu_tells: bool) {
        if self.frames.len() == Self::REMEMBERED {
            self.frames.pop_front();
        }
        self.frames.push_back(Entry { stats, complete: !gpu_tells });
    }

    /// Takes over what the GPU took for frames that are remembered.
    pub fn add_gpu_times(&mut self, times: &[GpuTimes]) {
        for times in times {
            for entry in self.frames.iter_mut().filter(|entry| !entry.complete) {
                entry.complete = entry.stats.add_gpu_times(times);
            }
        }
    }

    /// Forgets: what follows is drawn in another way.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The figures of the last frame.
    pub fn last(&self) -> Option<&FrameStats> {
        self.frames.back().map(|entry| &entry.stats)
    }

    /// Frames whose time is known, the oldest first.
    pub fn timed(&self) -> impl Iterator<Item = &FrameStats> + Clone {
        self.frames.iter().filter(|entry| entry.complete).map(|entry| &entry.stats)
    }

    /// Frames whose time is known.
    pub fn len(&self) -> usize {
        self.timed().count()
    }

    /// Whether no time is known.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The time that a share of the frames stays within: 0.5 is the median. `None` without frames.
    pub fn percentile(&self, share: f64) -> Option<f64> {
        percentile(self.timed().map(frame_ms).collect(), share)
    }

    /// The median of each part of a frame.
    pub fn medians(&self) -> FrameTimings {
        FrameTimings::of_frames(self.timed(), |times| percentile(times, 0.5))
    }
}

/// Milliseconds of a frame: choosing and encoding on the CPU plus drawing on the GPU, as if nothing
/// overlapped.
pub fn frame_ms(stats: &FrameStats) -> f64 {
    stats.select_ms + stats.cpu_ms + stats.gpu_ms.unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_of_the_last_frames() {
        let mut log = FrameLog::default();
        assert_eq!(log.percentile(0.5), None);
        for frame in 1..=300 {
            let stats = FrameStats { frame, cpu_ms: frame as f64, ..FrameStats::default() };
            log.show(stats, false);
        }
        // 181 to 300 are remembered.
        assert_eq!(log.len(), FrameLog::REMEMBERED);
        assert_eq!(log.percentile(0.5), Some(240.0));
        assert_eq!(log.percentile(0.95), Some(294.0));
        assert_eq!(log.percentile(1.0), Some(300.0));
        log.clear();
        assert!(log.is_empty() && log.last().is_none());
    }

    /// The times of a frame come while later ones are drawn, and go to that frame.
    #[test]
    fn a_frame_counts_once_the_gpu_has_told_its_time() {
        let mut log = FrameLog::default();
        for frame in 1..=3 {
            log.show(FrameStats { frame, cpu_ms: 1.0, ..FrameStats::default() }, true);
        }
        assert!(log.is_empty() && log.last().is_some_and(|last| last.frame == 3));
        let times = |frame, frame_ms| GpuTimes { frame, frame_ms, ..GpuTimes::default() };
        log.add_gpu_times(&[times(2, 5.0), times(99, 7.0)]);
        assert_eq!(log.timed().map(|s| s.frame).collect::<Vec<_>>(), [2]);
        assert_eq!(log.percentile(1.0), Some(6.0));
        log.add_gpu_times(&[times(1, 9.0)]);
        assert_eq!(log.percentile(1.0), Some(10.0));
    }
}
