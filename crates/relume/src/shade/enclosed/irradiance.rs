//! Irradiance of polygons and spheres of one radiance, as far as they are above the receiver's horizon.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// Irradiance / π of a polygon of radiance 1 by the integral along its edges [arvo1994]; corners relative to the receiver, in order.
pub fn of_polygon(corners: &[DVec3], normal: DVec3) -> f64 {
    let mut sum = 0.0;
    // Where the outline goes below the horizon, and where it comes back.
    let (mut leaves, mut comes) = (None, None);
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (height_a, height_b) = (normal.dot(a), normal.dot(b));
        let between = || a + (b - a) * (height_a / (height_a - height_b));
        match (height_a >= 0.0, height_b >= 0.0) {
            (true, true) => sum += edge(a, b, normal),
            (true, false) => {
                let at = between();
                sum += edge(a, at, normal);
                leaves = Some(at);
            }
            (false, true) => {
                let at = between();
                sum += edge(at, b, normal);
                comes = Some(at);
            }
            (false, false) => {}
        }
    }
    if let Some((leaves, comes)) = leaves.zip(comes) {
        sum += edge(leaves, comes, normal);
    }
    sum.abs() / TAU
}

/// The angle of an edge, times the cosine of its plane's normal.
fn edge(a: DVec3, b: DVec3, normal: DVec3) -> f64 {
    let across = a.cross(b);
    let sine = across.length();
    if sine == 0.0 {
        return 0.0;
    }
    libm::atan2(sine, a.dot(b)) * normal.dot(across) / sine
}

/// Irradiance / π of a sphere of radiance 1 that is seen under the half angle whose sine is `sine`, its middle at the angle whose cosine is `cosine` from the
/// normal: the closed form of a disc cut by the horizon [snyder1996].
pub fn of_sphere(sine: f64, cosine: f64) -> f64 {
    if cosine >= sine {
        return sine * sine * cosine;
    }
    if cosine <= -sine {
        return 0.0;
    }
    let across = (1.0 - cosine * cosine).sqrt();
    // Cotangent of the half angle.
    let cotangent = (1.0 / (sine * sine) - 1.0).max(0.0).sqrt();
    let y = (-cotangent * cosine / across).clamp(-1.0, 1.0);
    let chord = (1.0 - y * y).sqrt();
    let disc = cosine * libm::acos(y) - cotangent * across * chord;
    (sine * sine * disc + libm::atan2(across * chord, cotangent)) / PI
}
