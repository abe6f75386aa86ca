//! How long the passes take on the device, where it can tell.

use std::sync::{Arc, Mutex};

use crate::stage::PassTimes;

/// Bytes of the four timestamps.
const BYTES: u64 = 32;

/// Timestamps around both passes.
pub struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    /// What is mapped and read; not written to until it was read.
    readable: wgpu::Buffer,
    /// Seconds of a tick.
    tick: f32,
    /// Whether the relight pass of this frame was timed.
    relit: std::cell::Cell<bool>,
    reading: Arc<Mutex<Reading>>,
}

#[derive(Default)]
enum Reading {
    /// The buffer is free.
    #[default]
    Idle,
    /// Copied to in this frame, then mapped; whether with a relight pass.
    Copied(bool),
    /// Waits for the device.
    Waiting,
    /// Read.
    Times(PassTimes),
}

impl Timer {
    /// A timer, where the device has timestamps.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Self> {
        if !device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let buffer = |usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Usage;
        Some(Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: 4,
            }),
            resolved: buffer(Usage::QUERY_RESOLVE | Usage::COPY_SRC),
            readable: buffer(Usage::COPY_DST | Usage::MAP_READ),
            tick: queue.get_timestamp_period() * 1e-9,
            relit: std::cell::Cell::new(false),
            reading: Arc::default(),
        })
    }

    /// For the relight pass.
    pub fn relight(&self) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.relit.set(true);
        Some(self.writes(0))
    }

    /// For the view pass.
    pub fn view(&self) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        Some(self.writes(2))
    }

    fn writes(&self, first: u32) -> wgpu::RenderPassTimestampWrites<'_> {
        wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }
    }

    /// Encodes the copy of this frame's timestamps, unless earlier ones are still being read.
    pub fn resolve(&mut self, encoder: &mut wgpu::CommandEncoder) {
        let relit = self.relit.replace(false);
        let Ok(mut reading) = self.reading.lock() else {
            return;
        };
        if !matches!(*reading, Reading::Idle) {
            return;
        }
        // Queries that were not written in this frame cannot be resolved.
        let written = if relit { 0..4 } else { 2..4 };
        let offset = u64::from(written.start) * 8;
        // Resolved to the buffer's start: other offsets would have to be multiples of 256.
        encoder.resolve_query_set(&self.queries, written, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, BYTES - offset);
        *reading = Reading::Copied(relit);
    }

    /// Asks for what was copied, after the submission.
    pub fn read(&mut self) {
        let Ok(mut reading) = self.reading.lock() else {
            return;
        };
        let Reading::Copied(relit) = *reading else {
            return;
        };
        *reading = Reading::Waiting;
        drop(reading);
        let (buffer, kept, tick) = (self.readable.clone(), Arc::clone(&self.reading), self.tick);
        self.readable
            .map_async(wgpu::MapMode::Read, .., move |mapped| {
                let times = mapped.ok().and_then(|()| {
                    let bytes = buffer.get_mapped_range(..).ok()?;
                    let ticks: &[u64] = bytemuck::try_cast_slice(&bytes).ok()?;
                    let seconds = |i: usize| ticks[i + 1].saturating_sub(ticks[i]) as f32 * tick;
                    Some(PassTimes {
                        relight: relit.then(|| seconds(0)),
                        view: Some(seconds(if relit { 2 } else { 0 })),
                    })
                });
                buffer.unmap();
                if let Ok(mut reading) = kept.lock() {
                    *reading = times.map_or(Reading::Idle, Reading::Times);
                }
            });
    }

    /// What was read since the last call.
    pub fn take(&mut self) -> PassTimes {
        let Ok(mut reading) = self.reading.lock() else {
            return PassTimes::default();
        };
        match *reading {
            Reading::Times(times) => {
                *reading = Reading::Idle;
                times
            }
            _ => PassTimes::default(),
        }
    }
}
