//! Small scenes whose transfer is known.

use glam::{DVec2, DVec3};

use super::part::{Part, add_material};
use super::shapes::{NO_BOTTOM, SIDES, ball, cuboid, lathe, on_circle, plane};
use crate::scene::{Material, Scene};

fn of_albedo(albedo: f32) -> (Scene, usize) {
    let mut scene = Scene::default();
    let material = add_material(&mut scene, Material::diffuse("grey", [albedo; 3]));
    (scene, material)
}

/// The unit sphere at the origin, `around` vertices on its equator. Convex: its transfer is the closed form of the clamped cosine,
/// whatever the number of bounces.
pub fn sphere(around: usize, albedo: f32) -> Scene {
    let (mut scene, material) = of_albedo(albedo);
    let mut part = Part::default();
    ball(&mut part, DVec3::ZERO, 1.0, around);
    part.add_to(&mut scene, "sphere", material, None);
    scene
}

/// The inside of a part of the unit sphere, open at the top; `fraction` of the sphere's area is there, `around` vertices on a circle.
///
/// Every point of a sphere sees all parts of it alike: the share of its cosine-weighted view that another part fills is that part's
/// share of the area. So under constant light 1, the transferred radiance is the same everywhere in the bowl and after `k` bounces
/// it is `(1 − f) Σ_{i ≤ k} (ρ f)^i`.
pub fn bowl(fraction: f64, albedo: f32, around: usize) -> Scene {
    let (mut scene, material) = of_albedo(albedo);
    let mut part = Part::default();
    // Polar angle of the rim, from the bottom; as many cells along as keeps them about square.
    let rim = libm::acos(1.0 - 2.0 * fraction) / (2.0 * std::f64::consts::PI);
    let along = ((rim * around as f64).round() as usize).max(1);
    lathe(&mut part, around, along, |t| {
        // From the rim down, so that it faces inward.
        let polar = on_circle(rim * (1.0 - t));
        (
            DVec2::new(polar.y, -polar.x),
            DVec2::new(-polar.x, -polar.y),
        )
    });
    part.add_to(&mut scene, "bowl", material, None);
    scene
}

/// A sphere of `radius` whose centre is `height` above the middle of a square floor (y = 0, sides of `side`, corners at
/// (±side/2, 0, ±side/2)). The floor is the first instance.
///
/// At a floor point whose direction to the centre makes the angle θ with the normal at distance d, and which sees the whole sphere above
/// its horizon, the sphere takes cos θ (radius / d)² of the cosine-weighted view.
pub fn plane_under_sphere(
    radius: f64,
    height: f64,
    side: f64,
    around: usize,
    albedo: f32,
) -> Scene {
    let (mut scene, material) = of_albedo(albedo);
    let (mut floor, mut ball_part) = (Part::default(), Part::default());
    let corner = DVec3::new(-side / 2.0, 0.0, -side / 2.0);
    plane(
        &mut floor,
        corner,
        DVec3::Z * side,
        DVec3::X * side,
        side / 16.0,
    );
    floor.add_to(&mut scene, "floor", material, None);
    ball(&mut ball_part, DVec3::Y * height, radius, around);
    ball_part.add_to(&mut scene, "ball", material, None);
    scene
}

/// A closed cube of side 2 about the origin, seen from the inside, `cells` per edge: no light gets in.
pub fn room(cells: usize, albedo: f32) -> Scene {
    let (mut scene, material) = of_albedo(albedo);
    let mut part = Part::default();
    // A box whose corners are exchanged is one turned inside out: all three directions flip, and with them u × v does not, so that its
    // sides, each still facing along +/−, face the middle.
    let all = NO_BOTTOM | SIDES[2];
    cuboid(&mut part, DVec3::ONE, -DVec3::ONE, 2.0 / cells as f64, all);
    part.add_to(&mut scene, "room", material, None);
    scene
}
