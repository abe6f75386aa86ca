//! A device, and how long it takes.

use std::error::Error;
use std::time::Instant;

use wgpu::{Buffer, BufferUsages, CommandEncoder, Device, QuerySet, Queue};

/// A device that is waited for.
pub struct Stopwatch {
    pub device: Device,
    pub queue: Queue,
    /// What it is, for people.
    pub adapter: String,
    queries: Option<Queries>,
}

/// Clock readings of the device: two of each pass.
struct Queries {
    set: QuerySet,
    resolved: Buffer,
    read: Buffer,
    /// Nanoseconds of a tick.
    tick: f64,
}

/// The passes of a frame.
#[derive(Clone, Copy)]
pub enum Pass {
    Relight,
    View,
}

const READINGS: u32 = 4;
const BYTES: u64 = READINGS as u64 * wgpu::QUERY_SIZE as u64;

impl Stopwatch {
    pub async fn open() -> Result<Self, Box<dyn Error>> {
        let instance = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        let instance = wgpu::Instance::new(instance);
        let adapter = instance.request_adapter(&Default::default()).await?;
        let clock = adapter.features() & wgpu::Features::TIMESTAMP_QUERY;
        let descriptor = wgpu::DeviceDescriptor {
            required_features: clock,
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = adapter.request_device(&descriptor).await?;
        let info = adapter.get_info();
        let clock = !clock.is_empty();
        Ok(Self {
            queries: clock.then(|| Queries::new(&device, queue.get_timestamp_period())),
            adapter: format!(
                "{} ({}, {}), passes timed {}",
                info.name,
                info.backend,
                info.driver_info,
                if clock { "by the device" } else { "one by one" }
            ),
            device,
            queue,
        })
    }

    /// Milliseconds until what `encode` has encoded is done, encoding included.
    pub fn time(
        &self,
        encode: impl FnOnce(&mut CommandEncoder) -> Result<(), Box<dyn Error>>,
    ) -> Result<f64, Box<dyn Error>> {
        let start = Instant::now();
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encode(&mut encoder)?;
        self.queue.submit([encoder.finish()]);
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        Ok(1e3 * start.elapsed().as_secs_f64())
    }

    /// Where a pass leaves its readings, if the device has a clock.
    pub fn timestamps(&self, pass: Pass) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let first = 2 * pass as u32;
        self.queries
            .as_ref()
            .map(|queries| wgpu::RenderPassTimestampWrites {
                query_set: &queries.set,
                beginning_of_pass_write_index: Some(first),
                end_of_pass_write_index: Some(first + 1),
            })
    }

    /// Milliseconds of the last frame's passes, if the device has a clock.
    pub fn passes(&self) -> Option<(f64, f64)> {
        let queries = self.queries.as_ref()?;
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.resolve_query_set(&queries.set, 0..READINGS, &queries.resolved, 0);
        encoder.copy_buffer_to_buffer(&queries.resolved, 0, &queries.read, 0, BYTES);
        self.queue.submit([encoder.finish()]);
        queries.read.map_async(wgpu::MapMode::Read, .., |_| ());
        self.device.poll(wgpu::PollType::wait_indefinitely()).ok()?;
        let readings = queries.read.get_mapped_range(..).ok()?.to_vec();
        queries.read.unmap();
        let readings = bytemuck::pod_collect_to_vec::<u8, u64>(&readings);
        let milliseconds = |first: usize| {
            readings[first + 1].wrapping_sub(readings[first]) as f64 * queries.tick * 1e-6
        };
        Some((milliseconds(0), milliseconds(2)))
    }
}

impl Queries {
    fn new(device: &Device, tick: f32) -> Self {
        let buffer = |usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("clock"),
                size: BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        Self {
            set: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("clock"),
                ty: wgpu::QueryType::Timestamp,
                count: READINGS,
            }),
            resolved: buffer(BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
            read: buffer(BufferUsages::COPY_DST | BufferUsages::MAP_READ),
            tick: tick.into(),
        }
    }
}

/// The middle value.
pub fn median(values: &[f64]) -> f64 {
    percentile(values, 0.5)
}

/// The value that the share `part` of all is no greater than.
pub fn percentile(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1);
    sorted
        .get((part * last as f64).round() as usize)
        .copied()
        .unwrap_or(f64::NAN)
}
