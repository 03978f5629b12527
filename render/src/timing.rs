//! How long the GPU took, by timestamps where the adapter has them.

use crate::gpu::Gpu;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wgpu::BufferUsages;

const STAMPS: u32 = 2;
const BYTES: u64 = STAMPS as u64 * 8;

/// Two stamps a frame: before the first pass and after the last.
#[derive(Debug)]
pub(crate) struct GpuTimer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    mapped: wgpu::Buffer,
    /// Nanoseconds a tick.
    period_ns: f64,
    state: State,
    ready: Arc<AtomicBool>,
    last_ms: Option<f64>,
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum State {
    /// The read-back buffer is free.
    Idle,
    /// This frame's stamps are being copied into it.
    Copying,
    /// It is being mapped.
    Mapping,
}

impl GpuTimer {
    /// `None` where the adapter has no timestamps.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        if !gpu.has(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let usage = BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC;
        let resolved = gpu.buffer("timestamps", BYTES, usage).ok()?;
        let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
        let mapped = gpu.buffer("timestamps read back", BYTES, usage).ok()?;
        Some(Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("frame timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: STAMPS,
            }),
            resolved,
            mapped,
            period_ns: f64::from(gpu.queue.get_timestamp_period()),
            state: State::Idle,
            ready: Arc::default(),
            last_ms: None,
        })
    }

    /// The stamps of a pass: at its beginning if it is the frame's first, at its end if the last.
    pub fn stamps(&self, first: bool, last: bool) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        (first || last).then(|| wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: first.then_some(0),
            end_of_pass_write_index: last.then_some(1),
        })
    }

    /// The stamp at the beginning of a frame whose first pass is one of kernels.
    pub fn first_of_kernels(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: None,
        }
    }

    /// Copies the stamps at the end of a frame. Skips the frame while an older one is under way.
    pub fn resolve(&mut self, encoder: &mut wgpu::CommandEncoder) {
        if self.state == State::Idle {
            encoder.resolve_query_set(&self.queries, 0..STAMPS, &self.resolved, 0);
            encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.mapped, 0, BYTES);
            self.state = State::Copying;
        }
    }

    /// Asks for the copied stamps, once the frame is submitted.
    pub fn submitted(&mut self) {
        if self.state == State::Copying {
            self.state = State::Mapping;
            let ready = Arc::clone(&self.ready);
            self.mapped.map_async(wgpu::MapMode::Read, .., move |result| {
                if result.is_ok() {
                    ready.store(true, Ordering::Release);
                }
            });
        }
    }

    /// Milliseconds of the latest frame whose stamps have arrived.
    pub fn latest_ms(&mut self) -> Option<f64> {
        if self.state == State::Mapping && self.ready.swap(false, Ordering::Acquire) {
            if let Ok(bytes) = self.mapped.get_mapped_range(..) {
                let stamp = |i: usize| bytemuck::pod_read_unaligned::<u64>(&bytes[i * 8..][..8]);
                let ticks = stamp(1).saturating_sub(stamp(0));
                self.last_ms = Some(ticks as f64 * self.period_ns * 1e-6);
            }
            self.mapped.unmap();
            self.state = State::Idle;
        }
        self.last_ms
    }
}
