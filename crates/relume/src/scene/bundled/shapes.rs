//! Forms that scenes are put together from.

use glam::{DVec2, DVec3};

use super::part::{Part, Point};

/// A whole turn.
const TURN: f64 = 2.0 * std::f64::consts::PI;

/// (cos, sin) of a share of a turn.
pub fn on_circle(turns: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(TURN * turns);
    DVec2::new(cos, sin)
}

/// How many cells of about `edge` a length takes.
pub fn cells(length: f64, edge: f64) -> usize {
    ((length / edge).round() as usize).max(1)
}

/// A flat parallelogram from `corner` along `u` and `v`, facing `u × v`. Texture coordinates are those of the corner plus metres along
/// the sides.
pub fn plane(part: &mut Part, corner: DVec3, u: DVec3, v: DVec3, edge: f64) {
    let normal = u.cross(v);
    let (across, along) = (cells(u.length(), edge), cells(v.length(), edge));
    part.patch(across, along, |s, t| Point {
        position: corner + u * s + v * t,
        normal,
        uv: DVec2::new(u.length() * s, v.length() * t),
    });
}

/// Which sides of a box to build: bits of −x, +x, −y, +y, −z, +z.
pub const SIDES: [u8; 6] = [1, 2, 4, 8, 16, 32];
/// All but the bottom.
pub const NO_BOTTOM: u8 = 63 - 4;

/// The sides of an axis-aligned box that `sides` names, facing outward.
pub fn cuboid(part: &mut Part, low: DVec3, high: DVec3, edge: f64, sides: u8) {
    let size = high - low;
    let (x, y, z) = (DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z);
    let faces = [
        (low, z, y),
        (low + x, y, z),
        (low, x, z),
        (low + y, z, x),
        (low, y, x),
        (low + z, x, y),
    ];
    for ((corner, u, v), bit) in faces.into_iter().zip(SIDES) {
        if sides & bit != 0 {
            plane(part, corner, u, v, edge);
        }
    }
}

/// A curve through `points` (Catmull–Rom), position and derivative at `t` in 0…1.
pub fn curve_through(points: &[DVec2], t: f64) -> (DVec2, DVec2) {
    let spans = points.len() - 1;
    let x = (t * spans as f64).clamp(0.0, spans as f64);
    let i = (x.floor() as usize).min(spans - 1);
    let f = x - i as f64;
    let (b, c) = (points[i], points[i + 1]);
    // Past the ends the curve goes on straight.
    let a = if i > 0 { points[i - 1] } else { 2.0 * b - c };
    let d = points.get(i + 2).copied().unwrap_or(2.0 * c - b);
    let (k1, k2, k3) = (
        c - a,
        2.0 * a - 5.0 * b + 4.0 * c - d,
        3.0 * (b - c) + d - a,
    );
    let position = b + 0.5 * f * (k1 + f * (k2 + f * k3));
    let derivative = 0.5 * (k1 + f * (2.0 * k2 + f * 3.0 * k3));
    (position, derivative)
}

/// A surface of revolution about the y axis: `profile` gives (radius, height) and its derivative. It faces to the right of the
/// profile's way: outward where the profile runs up, inward where it runs down.
pub fn lathe(
    part: &mut Part,
    around: usize,
    along: usize,
    profile: impl Fn(f64) -> (DVec2, DVec2),
) {
    part.ring(around, along, |s, t| {
        let (at, way) = profile(t);
        let spoke = on_circle(s);
        let turned = |radial: f64, y: f64| DVec3::new(spoke.x * radial, y, spoke.y * radial);
        Point::new(turned(at.x.max(0.0), at.y), turned(way.y, -way.x))
    });
}

/// A surface of revolution whose profile is the straight line from `from` to `to` (radius, height).
pub fn lathe_line(part: &mut Part, around: usize, edge: f64, from: DVec2, to: DVec2) {
    let along = cells(from.distance(to), edge);
    lathe(part, around, along, |t| (from.lerp(to, t), to - from));
}

/// A sphere about the y axis.
pub fn ball(part: &mut Part, centre: DVec3, radius: f64, around: usize) {
    part.ring(around, around / 2, |s, t| {
        let (spoke, polar) = (on_circle(s), on_circle(0.5 * t - 0.25));
        let normal = DVec3::new(spoke.x * polar.x, polar.y, spoke.y * polar.x);
        Point::new(centre + radius * normal, normal)
    });
}

/// A tube along the torus knot that winds `p` times about the y axis and `q` times about the ring of radius `ring`.
pub struct Knot {
    pub p: f64,
    pub q: f64,
    pub ring: f64,
    /// Distance of the knot from the ring.
    pub swing: f64,
    pub tube: f64,
}

impl Knot {
    /// The tube with `along` cells along the knot and `around` about it.
    pub fn build(&self, part: &mut Part, along: usize, around: usize) {
        // Wrapped both ways: a ring of rings, whose last row repeats the first.
        part.ring(around, along, |s, t| {
            let t = if t < 1.0 { t } else { 0.0 };
            let (about_axis, about_ring) = (on_circle(self.p * t), on_circle(self.q * t));
            let spoke = DVec3::new(about_axis.x, 0.0, about_axis.y);
            let ahead = DVec3::new(-about_axis.y, 0.0, about_axis.x);
            let out = spoke * about_ring.x + DVec3::Y * about_ring.y;
            let centre = spoke * self.ring + out * self.swing;
            let turn = DVec3::Y * about_ring.x - spoke * about_ring.y;
            let reach = self.ring + self.swing * about_ring.x;
            let tangent = ahead * (self.p * reach) + turn * (self.q * self.swing);
            let side = tangent.cross(out).normalize();
            let rim = on_circle(s);
            let normal = out * rim.x + side * rim.y;
            Point::new(centre + normal * self.tube, normal)
        });
    }
}
