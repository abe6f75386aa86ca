//! Which ways are compared, at which sizes.

use std::error::Error;

use relume::basis::{Order, Zonal};
use relume::brdf::{Brdf, Reflection, Reflector};

use crate::grid::grid;
use crate::lobes::{fitted, plane};
use crate::operator::Operator;
use crate::project;
use crate::separable::separable;
use crate::ways::{Basis, Way};

/// Ways that differ by size alone, from small to large, for each kind.
pub fn all(brdf: &Brdf, operator: &Operator) -> Result<Vec<Vec<Way>>, Box<dyn Error>> {
    let m = operator.order.get();
    let orders = |sizes: &[usize]| -> Result<Vec<Order>, _> {
        sizes.iter().map(|&n| Order::new(n)).collect()
    };
    let of =
        |sizes: &[usize], way: fn(&Operator, Order) -> Way| -> Result<Vec<Way>, Box<dyn Error>> {
            Ok(orders(sizes)?
                .into_iter()
                .map(|order| way(operator, order))
                .collect())
        };
    let small = [3, 5, 7, 10, 14, 20];
    let grids = [
        (2, 8),
        (3, 12),
        (4, 16),
        (6, 24),
        (8, 32),
        (12, 48),
        (16, 64),
    ];
    let lobe = match brdf {
        Brdf::Phong(phong) => orders(&[m, m + m / 2, 2 * m, 3 * m])?
            .into_iter()
            .map(|order| project::zonal(operator, &phong_lobe(phong.exponent, order), order))
            .collect(),
        _ => Vec::new(),
    };
    Ok(vec![
        vec![reflector(brdf, operator.order)?],
        vec![Way::table(operator)],
        of(&[m, 2 * m, 3 * m], project::sphere)?,
        of(&small, project::fitted)?,
        of(&small, project::stretched)?,
        grids
            .map(|(rings, spokes)| grid(operator, rings, spokes))
            .into(),
        [1, 2, 4, 8, 16, 32, 64]
            .map(|count| separable(operator, count))
            .into(),
        vec![plane(operator)],
        vec![fitted(operator)],
        lobe,
    ])
}

/// The library's reflector: lobes in the plane of view in f64, three BRDFs and three channels at once.
fn reflector(brdf: &Brdf, order: Order) -> Result<Way, Box<dyn Error>> {
    let reflector = Reflector::new(&Reflection::Fixed(brdf.clone()), false, order)?;
    Ok(Way {
        name: "the library's, 3 channels",
        label: "65 angles".to_owned(),
        // The angles, and one beyond each end.
        material_bytes: 8 * 67 * 3 * order.count(),
        blocks: Vec::new(),
        basis: Basis::Reflector(Box::new(reflector)),
    })
}

/// `(N+2)/(2π) max(0, cosine)^N`
fn phong_lobe(exponent: f64, order: Order) -> Zonal {
    let scale = (exponent + 2.0) / std::f64::consts::TAU;
    Zonal::project(order, |t| scale * t.max(0.0).powf(exponent))
}

/// A larger size is a smaller error, down to where the tables' steps and f32 show; the largest is close.
pub fn assert_convergence(family: &[Way], errors: &[f64]) {
    for (errors, ways) in errors.windows(2).zip(family.windows(2)) {
        assert!(
            errors[1] < errors[0] || errors[1] < 1e-3,
            "{} gets no better from {} to {}: {errors:?}",
            ways[0].name,
            ways[0].label,
            ways[1].label
        );
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use relume::basis::{Angle, Euler, EulerRotation};
    use relume::brdf::{Ggx, Phong};

    use super::*;
    use crate::operator::exact;
    use crate::pairs::Pair;
    use crate::ways::Eye;

    /// Any transferred radiance, from any vertex, toward any eye.
    fn pairs(order: Order) -> Vec<Pair> {
        let rotation = EulerRotation::new(order);
        let number = |k: usize, i: usize| f64::sin((k * 31 + i * 17) as f64 + 0.3) + 0.1;
        let pair = |k: usize| {
            let normal = DVec3::new(number(k, 1), number(k, 2), number(k, 3)).normalize();
            let local =
                DVec3::new(number(k, 4), number(k, 5), number(k, 6).abs() + 0.3).normalize();
            let eye = Eye {
                local: local.as_vec3().to_array(),
                normal,
                world: Euler::z_to(normal, Angle::ZERO).matrix() * local,
            };
            let a: Vec<f32> = (0..order.count())
                .map(|i| number(k, 7 + i) as f32)
                .collect();
            Pair::new(&a, eye, order, &rotation)
        };
        (0..40).map(pair).collect()
    }

    #[test]
    fn each_way_converges_to_the_exact_reflection() {
        let order = Order::new(4).unwrap();
        let phong = Phong {
            diffuse: DVec3::ZERO,
            specular: DVec3::ONE,
            exponent: 20.0,
        };
        let metal = Ggx {
            base_color: DVec3::ONE,
            metallic: 1.0,
            roughness: 0.4,
        };
        for brdf in [Brdf::from(phong), metal.into()] {
            let pairs = pairs(order);
            let exact = |pair: &Pair| {
                let angle = f64::from(pair.eye.local[2]).acos();
                pair.reflect(&exact(&brdf, order, angle))
            };
            let truth: Vec<f64> = pairs.iter().map(exact).collect();
            for family in all(&brdf, &Operator::new(&brdf, order)).unwrap() {
                let errors: Vec<f64> = family
                    .iter()
                    .map(|way| crate::relative(&crate::radiance(way, &pairs), &truth))
                    .collect();
                let name = family.first().map_or("", |way| way.name);
                println!("{name}: {errors:?}");
                assert_convergence(&family, &errors);
                // What each has left at its largest, twice over; the tables' steps and f32 where it is exact but for them.
                let bound = match name {
                    "SH" => 0.1,
                    "Gautron" => 0.03,
                    "grid, bilinear" => 0.01,
                    "one zonal lobe, fitted" => 0.2,
                    _ => 1e-3,
                };
                assert!(errors.last().is_none_or(|last| *last < bound), "{name}");
            }
        }
    }
}
