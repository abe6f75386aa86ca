//! Transferred radiance of the device against that of the CPU.

use relume::asset::{BackTransfer, Matrices, Provenance, TransferKind};
use relume::light::{IncidentLight, ObjectLight, ShLight};
use relume::shade::TransferredRadiance;

use super::*;
use crate::light::GpuLight;
use crate::transfer::GpuTransfer;

/// Both software adapters; a line for each that is missing.
fn on_each_back_end(test: &str, run: impl Fn(&Gpu)) {
    for backends in [wgpu::Backends::VULKAN, wgpu::Backends::GL] {
        let mut instance = wgpu::InstanceDescriptor::new_without_display_handle();
        instance.backends = backends;
        let instance = wgpu::Instance::new(instance);
        let adapter = instance.request_adapter(&wgpu::RequestAdapterOptions::default());
        let Ok(adapter) = pollster::block_on(adapter) else {
            println!("skipped: matrices::tests::{test}: needs a {backends:?} adapter");
            continue;
        };
        let limits = wgpu::Limits::downlevel_webgl2_defaults().using_alignment(adapter.limits());
        let device = adapter.request_device(&wgpu::DeviceDescriptor {
            required_limits: limits,
            ..wgpu::DeviceDescriptor::default()
        });
        let (device, queue) = pollster::block_on(device).unwrap();
        run(&Gpu { device, queue });
    }
}

/// A number in −1…1 that looks random.
fn noise(seed: usize) -> f32 {
    let bits = (seed as u32).wrapping_mul(0x9E37_79B9) ^ 0x85EB_CA6B;
    let bits = (bits ^ (bits >> 15)).wrapping_mul(0x2C1B_3C6D);
    ((bits ^ (bits >> 12)) >> 8) as f32 / 8_388_608.0 - 1.0
}

/// Numbers for `count` vertices, every third of which has a back.
fn transfer(count: usize, channels: usize, light: usize, order: usize) -> Transfer {
    let (light, order) = (Order::new(light).unwrap(), Order::new(order).unwrap());
    let numbers = |count: usize, seed| (0..count).map(|i| noise(i + seed)).collect::<Vec<_>>();
    let vertices: Vec<u32> = (0..count as u32).step_by(3).collect();
    let stride = channels * light.count();
    let matrices = stride * order.count();
    Transfer {
        order: light,
        channels,
        kind: TransferKind::Shadowed { bounces: 0 },
        samples: 1,
        seed: 0,
        made: Provenance::default(),
        precision: Precision::F32,
        coefficients: numbers(count * stride, 1).into(),
        valid: vec![true; count],
        gather: None,
        matrices: Some(Matrices {
            order,
            coefficients: numbers(count * matrices, 2).into(),
            back: numbers(vertices.len() * matrices, 3).into(),
        }),
        back: Some(BackTransfer {
            coefficients: numbers(vertices.len() * stride, 4).into(),
            vertices,
        }),
    }
}

fn light(order: usize, seed: usize) -> ShLight {
    let order = Order::new(order).unwrap();
    let coefficient = |i: usize| [0, 1, 2].map(|c| noise(3 * i + c + 977 * seed));
    ShLight::new(order, (0..order.count()).map(coefficient).collect())
}

/// What the device makes of a light: `[side][3][order²]`, fronts and then backs.
fn relit(gpu: &Gpu, transfer: &Transfer, light: &IncidentLight) -> Vec<f32> {
    let mut relight = Relight::new(gpu);
    let uploaded = GpuTransfer::new(gpu, &relight, transfer).unwrap();
    let light = GpuLight::new(gpu, &mut relight, &uploaded, light).unwrap();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let lights = Lights {
        light: &light,
        near: None,
    };
    uploaded.relight(&mut encoder, &relight, lights, None);
    let matrices = uploaded.matrices.unwrap();
    let (width, height) = matrices.blocks.extent();
    let stride = (16 * width).next_multiple_of(256);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(stride * height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(stride),
        rows_per_image: None,
    };
    let (source, size) = (matrices.radiance.as_image_copy(), matrices.radiance.size());
    let to = wgpu::TexelCopyBufferInfo {
        buffer: &buffer,
        layout,
    };
    encoder.copy_texture_to_buffer(source, to, size);
    gpu.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |mapped| mapped.unwrap());
    gpu.device
        .poll(wgpu::PollType::wait_indefinitely())
        .unwrap();
    let mapped = buffer.get_mapped_range(..).unwrap();
    let (count, rows) = (matrices.order.count(), sequence(matrices.order));
    let mut all = vec![0.0; matrices.blocks.sides * 3 * count];
    for (side, radiance) in all.chunks_exact_mut(3 * count).enumerate() {
        let (row, number) = (side / matrices.blocks.across, side % matrices.blocks.across);
        let first = row * stride as usize + 16 * number * matrices.blocks.size.radiance();
        for (i, place) in rows.iter().enumerate() {
            for channel in 0..3 {
                let Some(place) = place else { continue };
                let at = first + 16 * (i / 4 * 3 + channel) + i % 4 * 4;
                let bytes = mapped[at..at + 4].try_into().unwrap();
                radiance[channel * count + place] = f32::from_ne_bytes(bytes);
            }
        }
    }
    all
}

fn check(gpu: &Gpu, transfer: &Transfer, light: &IncidentLight) {
    let ours = relit(gpu, transfer, light);
    let theirs = TransferredRadiance::new(transfer, light).unwrap();
    let theirs = [theirs.front, theirs.back].concat();
    assert_eq!(ours.len(), theirs.len());
    // Sums of n² products of numbers up to 1, in another order: half a rounding of 1.2·10⁻⁷ for each, of sums about as large as n.
    let n = transfer.order.get() as f32;
    let most = 6e-8 * n * n * n;
    for (i, (a, b)) in ours.iter().zip(&theirs).enumerate() {
        assert!((a - b).abs() <= most, "number {i}: {a} for {b}");
    }
    assert!(theirs.iter().any(|a| a.abs() > 0.1));
}

#[test]
fn transferred_radiance_is_that_of_the_cpu() {
    on_each_back_end("transferred_radiance_is_that_of_the_cpu", |gpu| {
        for (channels, n, m) in [(1, 5, 3), (3, 4, 6), (3, 1, 1), (1, 2, 10)] {
            let transfer = transfer(40, channels, n, m);
            check(gpu, &transfer, &IncidentLight::Distant(light(n, 1)));
            check(gpu, &transfer, &IncidentLight::Distant(light(n + 1, 2)));
            let object = |vertices, seed| ObjectLight {
                vertices,
                light: light(n, seed),
            };
            let objects = vec![object(0..9, 3), object(9..30, 4)];
            check(gpu, &transfer, &IncidentLight::PerObject(objects));
            let lights: Vec<[f32; 3]> = (0..40)
                .flat_map(|v| light(n, 5 + v).coefficients().to_vec())
                .collect();
            let lights = VertexLight::new(transfer.order, lights);
            check(gpu, &transfer, &IncidentLight::PerVertex(lights));
        }
    });
}

/// A page holds some 3,700 sides of so large matrices.
#[test]
fn pages_and_halves_are_those_of_the_cpu() {
    on_each_back_end("pages_and_halves_are_those_of_the_cpu", |gpu| {
        let transfer = transfer(4000, 1, 5, 9)
            .to_precision(Precision::F16)
            .unwrap();
        check(gpu, &transfer, &IncidentLight::Distant(light(5, 1)));
        let blocks = GpuTransfer::new(gpu, &Relight::new(gpu), &transfer).unwrap();
        assert!(blocks.matrices.unwrap().parts.len() > 1);
    });
}
