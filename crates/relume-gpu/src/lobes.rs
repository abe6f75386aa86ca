//! Reflection as lobes in the plane of view, in textures.

use std::sync::Arc;

use half::f16;
use relume::basis::Order;
use relume::brdf::{Reflection, Reflector, Tile};
use wgpu::{BindGroup, BindGroupLayout, BindingResource, Sampler};

use crate::GpuError;
use crate::gpu::Gpu;
use crate::tiles;

/// Steps between the normal and the horizon. Between them samplers draw straight lines.
const STEPS: usize = 256;

/// The lobes of the reflections that were asked for.
pub struct Lobes {
    pub layout: BindGroupLayout,
    sampler: Sampler,
    known: Vec<((Order, Gray), BindGroup)>,
}

/// Reflections that can be told apart without their colours.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Gray {
    Diffuse,
    /// A glTF material of this roughness, by its bits.
    Rough(u32),
    /// Of any.
    AnyRough,
}

impl Lobes {
    /// Nothing yet; `layout` has the array of lobes, a sampler and the array of a tile.
    pub fn new(gpu: &Gpu, layout: BindGroupLayout) -> Self {
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("lobes"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..wgpu::SamplerDescriptor::default()
        });
        Self {
            layout,
            sampler,
            known: Vec::new(),
        }
    }

    /// The lobes of each of some reflections for transferred radiance of `order`, and whether their roughness varies; those that are alike share theirs.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn all(
        &mut self,
        gpu: &Gpu,
        reflections: &[(&Reflection, bool)],
        order: Order,
    ) -> Result<Vec<BindGroup>, GpuError> {
        check(gpu, order)?;
        let is_fixed = |reflection: &Reflection| {
            matches!(reflection, Reflection::Fixed(_) | Reflection::Tile { .. })
        };
        let given = reflections.iter().copied();
        let fixed = given.clone().filter(|(reflection, _)| is_fixed(reflection));
        let mut fixed = Reflector::all(fixed, order)?.into_iter();
        let mut made: Vec<(Arc<Reflector>, BindGroup)> = Vec::new();
        let one = |(reflection, varies): (&Reflection, bool)| {
            let own = if is_fixed(reflection) {
                fixed.next()
            } else {
                None
            };
            let Some(reflector) = own else {
                return self.of(gpu, (reflection, varies), order);
            };
            if let Some((_, group)) = made.iter().find(|(same, _)| Arc::ptr_eq(same, &reflector)) {
                return Ok(group.clone());
            }
            let group = self.upload(gpu, &reflector, tiles::of(reflection))?;
            made.push((reflector, group.clone()));
            Ok(group)
        };
        given.map(one).collect()
    }

    /// The lobes of a reflection for transferred radiance of `order`; where `varies`, for every roughness of a glTF material, which takes 17 times
    /// as long.
    ///
    /// # Errors
    /// More layers than the device allows, a tile too large for it, or a BRDF that does not turn with the view.
    pub fn of(
        &mut self,
        gpu: &Gpu,
        (reflection, varies): (&Reflection, bool),
        order: Order,
    ) -> Result<BindGroup, GpuError> {
        let gray = match reflection {
            Reflection::Diffuse => Some(Gray::Diffuse),
            Reflection::MetallicRoughness { .. } if varies => Some(Gray::AnyRough),
            Reflection::MetallicRoughness { roughness, .. } => {
                Some(Gray::Rough(roughness.to_bits()))
            }
            Reflection::Fixed(_) | Reflection::Tile { .. } => None,
        };
        let key = gray.map(|gray| (order, gray));
        if let Some((_, made)) = self.known.iter().find(|(known, _)| Some(*known) == key) {
            return Ok(made.clone());
        }
        check(gpu, order)?;
        let reflector = Reflector::new(reflection, varies, order)?;
        let group = self.upload(gpu, &reflector, tiles::of(reflection))?;
        self.known.extend(key.map(|key| (key, group.clone())));
        Ok(group)
    }

    fn upload(
        &self,
        gpu: &Gpu,
        reflector: &Reflector,
        tile: Option<&Tile>,
    ) -> Result<BindGroup, GpuError> {
        let (order, levels) = (reflector.order(), reflector.levels());
        let texels = texels(&reflector.sampled(STEPS), order, levels * (STEPS + 1));
        let view = gpu.array("lobes", [STEPS + 1, levels, layers(order)], &texels);
        let tile = tile.map(|tile| tiles::texture(gpu, tile, order));
        let tile = tile.transpose()?;
        let resources = [
            (0, BindingResource::TextureView(&view)),
            (1, BindingResource::Sampler(&self.sampler)),
            // Where there is no tile, its place is not looked at.
            (
                2,
                BindingResource::TextureView(tile.as_ref().unwrap_or(&view)),
            ),
        ];
        Ok(gpu.group("lobes", &self.layout, resources))
    }
}

/// Whether the device has layers enough.
fn check(gpu: &Gpu, order: Order) -> Result<(), GpuError> {
    let limit = gpu.device.limits().max_texture_array_layers as usize;
    if layers(order) <= limit {
        return Ok(());
    }
    Err(GpuError::Layers {
        order: order.get(),
        layers: layers(order),
        limit,
    })
}

/// Layers of a texture: for each degree and each four of the directions in the plane of view, one for each gray reflection.
fn layers(order: Order) -> usize {
    3 * order.get() * order.get().div_ceil(4)
}

/// The layers one after another, of samples `[degree][direction][place]`.
fn texels(sampled: &[[f32; 3]], order: Order, places: usize) -> Vec<[u16; 4]> {
    let n = order.get();
    let mut texels = vec![[0; 4]; layers(order) * places];
    for (lobe, samples) in sampled.chunks_exact(places).enumerate() {
        let (degree, direction) = (lobe / n, lobe % n);
        let first = 3 * (degree * n.div_ceil(4) + direction / 4) * places;
        for (place, sample) in samples.iter().enumerate() {
            for (term, value) in sample.iter().enumerate() {
                let texel = &mut texels[first + term * places + place];
                texel[direction % 4] = f16::from_f32(*value).to_bits();
            }
        }
    }
    texels
}

/// `Expansion` of glossy.wgsl: sides in a row of transferred radiance, the directions in the plane of view, and the steps of the recurrence.
pub fn expansion(order: Order, across: usize) -> Vec<[f32; 4]> {
    let n = order.get();
    let mut all = vec![[f32::from_bits(across as u32), 0.0, 0.0, 0.0]];
    for pick in [|(_, cos)| cos, |(sin, _)| sin] as [fn((f64, f64)) -> f64; 2] {
        let angle = |k: usize| std::f64::consts::PI * k as f64 / n as f64;
        // Those past the last have no lobes.
        let value = |k: usize| pick(libm::sincos(angle(k.min(n - 1)))) as f32;
        all.extend((0..n.div_ceil(4)).map(|quad| [0, 1, 2, 3].map(|lane| value(4 * quad + lane))));
    }
    let mut sectoral = (0.25 / std::f64::consts::PI).sqrt();
    for m in 0..n {
        if m > 0 {
            let doubled = if m == 1 { 2.0 } else { 1.0 };
            sectoral *= (doubled * (2 * m + 1) as f64 / (2 * m) as f64).sqrt();
        }
        all.push([sectoral as f32, 0.0, 0.0, 0.0]);
        for l in m + 1..n {
            let (a, ab) = step(l as f64, m as f64);
            all.push([a as f32, ab as f32, 0.0, 0.0]);
        }
    }
    all
}

/// `(a_lm, a_lm · b_lm)` of `P̄_lm = a_lm (z P̄_l-1,m − b_lm P̄_l-2,m)` [holmes2002].
fn step(l: f64, m: f64) -> (f64, f64) {
    let a = ((4.0 * l * l - 1.0) / (l * l - m * m)).sqrt();
    let k = l - 1.0;
    // The first step has no term before it.
    let b = ((k * k - m * m) / (4.0 * k * k - 1.0)).max(0.0).sqrt();
    (a, a * b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use relume::basis::{index, sh};

    #[test]
    fn the_recurrence_makes_spherical_harmonics() {
        for n in [1, 2, 5, 10] {
            let order = Order::new(n).unwrap();
            let expansion = expansion(order, 7);
            assert_eq!(expansion[0][0].to_bits(), 7);
            let mut steps = expansion[1 + 2 * n.div_ceil(4)..].iter();
            let d = glam::DVec3::new(0.48, -0.6, 0.64);
            let expected = sh::eval(order, d);
            // As the shader goes.
            let (mut re, mut im) = (1.0, 0.0);
            for m in 0..n {
                let (mut p, mut before) = (0.0, 0.0);
                for l in m..n {
                    let [a, ab, ..] = steps.next().unwrap().map(f64::from);
                    let next = if l == m { a } else { a * d.z * p - ab * before };
                    (before, p) = (if l == m { 0.0 } else { p }, next);
                    let off = |m: isize, y: f64| (expected[index(l, m)] - y).abs();
                    assert!(off(m as isize, p * re) < 1e-6);
                    assert!(m == 0 || off(-(m as isize), p * im) < 1e-6);
                }
                (re, im) = (re * d.x - im * d.y, im * d.x + re * d.y);
            }
            assert!(steps.next().is_none());
        }
    }
}
