//! What does not fit is said before the driver says it.

use relume::basis::Order;
use relume::light::{IncidentLight, ObjectLight, VertexLight};
use relume_gpu::GpuError;

use crate::device::Gpu;
use crate::scenes::{ball, distant, light, transfer};

fn small(test: &str, change: impl Fn(wgpu::Limits) -> wgpu::Limits) -> Option<Gpu> {
    Gpu::with_limits(wgpu::Backends::VULKAN, test, change)
}

#[test]
fn scenes_past_the_limits_are_refused() {
    let texture = |limits: wgpu::Limits| wgpu::Limits {
        max_texture_dimension_2d: 16,
        max_texture_dimension_1d: 16,
        ..limits
    };
    let Some(gpu) = small("limits::scenes_past_the_limits_are_refused", texture) else {
        return;
    };
    let world = ball();
    let mut renderer = gpu.renderer();
    let many = renderer.upload(&world, &transfer(&world, 2, 1, false));
    assert!(
        matches!(many, Err(GpuError::TooManySides { .. })),
        "{many:?}"
    );
    let high = renderer.upload(&world, &transfer(&world, 6, 1, false));
    assert!(
        matches!(high, Err(GpuError::TooManySides { .. })),
        "{high:?}"
    );
}

#[test]
fn what_belongs_to_another_scene_is_refused() {
    let test = "limits::what_belongs_to_another_scene_is_refused";
    let Some(gpu) = small(test, |limits| limits) else {
        return;
    };
    let world = ball();
    let mut renderer = gpu.renderer();
    let good = transfer(&world, 3, 1, true);
    let mut other = good.clone();
    other.valid.pop();
    let mismatch = |result| {
        assert!(
            matches!(result, Err(GpuError::Mismatch { .. })),
            "{result:?}"
        );
    };
    mismatch(renderer.upload(&world, &other));
    renderer.upload(&world, &good).unwrap();
    mismatch(renderer.set_transfer(&other));
    let order = Order::new(3).unwrap();
    let few = VertexLight::new(order, vec![[0.0; 3]; 9]);
    mismatch(renderer.set_light(&IncidentLight::PerVertex(few)));
    let outside = ObjectLight {
        vertices: 0..world.positions.len() + 1,
        light: light(3, 0),
    };
    mismatch(renderer.set_light(&IncidentLight::PerObject(vec![outside])));
    // Nothing of that has harmed what was there.
    renderer.set_light(&distant(3)).unwrap();
}
