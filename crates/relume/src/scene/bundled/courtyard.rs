//! The demo's scene: a courtyard with an arcade, a sculpture, urns and coloured walls.

use glam::{DAffine3, DVec2, DVec3, Vec3};

use super::furniture;
use super::paint::{mosaic, plaster};
use super::part::{Part, Point, add_material};
use super::shapes::{NO_BOTTOM, SIDES, cells, cuboid, curve_through, lathe, on_circle, plane};
use crate::display::Camera;
use crate::scene::{Material, Scene};

/// Middle of the floor, its medallion and the sculpture.
pub(super) const MIDDLE: DVec3 = DVec3::new(0.7, 0.0, 1.0);
/// Side of the square that the floor's texture covers, metres.
const MOSAIC: f64 = 12.0;
/// Height of the loggia's floor.
pub(super) const LOGGIA: f64 = 0.32;
/// Left end of the arcade, and the plane of the terracotta wall.
pub(super) const LEFT: f64 = -4.4;
/// The arcade's middle plane, half its thickness, and the face of the teal wall behind it.
pub(super) const ARCADE: f64 = -2.6;
const HALF_DEPTH: f64 = 0.2;
const BACK: f64 = -4.4;
/// Right and front edges of the floor.
const RIGHT_EDGE: f64 = 6.75;
const FRONT_EDGE: f64 = 6.95;
/// Bays, their width and the radius of their arches.
const BAYS: usize = 4;
pub(super) const BAY: f64 = 2.2;
const RADIUS: f64 = 0.86;
/// Heights of the springing line and of the top of the arcade.
const SPRING: f64 = 2.35;
const TOP: f64 = 3.75;

/// The courtyard: about 60,000 vertices, of our own making.
///
/// A mosaic floor (textured), a white torus knot on a round plinth, a loggia of four arches before a teal wall, a terracotta wall (both
/// vertex-coloured), urns, balls, a lattice (alpha mask) and an awning (double-sided). Walls reach below the floor, so that no light
/// comes in underneath.
pub fn courtyard() -> Scene {
    let mut scene = Scene::default();
    floor(&mut scene);
    walls(&mut scene);
    arcade(&mut scene);
    columns(&mut scene);
    furniture::sculpture(&mut scene);
    furniture::urns(&mut scene);
    furniture::balls(&mut scene);
    furniture::screen(&mut scene);
    furniture::awning(&mut scene);
    furniture::cypresses(&mut scene);
    scene
}

/// The view the demo's pictures are taken from.
pub fn courtyard_camera() -> Camera {
    Camera {
        eye: Vec3::new(5.3, 3.3, 8.6),
        target: Vec3::new(-0.42, 1.36, -0.6),
        up: Vec3::Y,
        fov_vertical_deg: 33.0,
    }
}

pub(super) fn diffuse(scene: &mut Scene, name: &str, albedo: [f32; 3]) -> usize {
    add_material(scene, Material::diffuse(name, albedo))
}

/// Plaster of one colour, mottled through vertex colours.
fn mottled(color: [f32; 3]) -> impl Fn(DVec3) -> [f32; 3] {
    move |p| color.map(|c| c * plaster(p) as f32)
}

fn floor(scene: &mut Scene) {
    scene.textures.push(mosaic(1024, MOSAIC));
    let material = add_material(
        scene,
        Material {
            base_color_texture: Some(scene.textures.len() - 1),
            ..Material::diffuse("mosaic", [1.0; 3])
        },
    );
    // Only where it is seen: in the court as far as under the first step, and to the right of the steps. Cells of 10 cm, so that the
    // vertices along the joint are the same, and none in the plane of a wall or a step.
    let mut part = Part::default();
    for (low, high) in [
        (DVec2::new(-4.65, -1.85), DVec2::new(RIGHT_EDGE, FRONT_EDGE)),
        (DVec2::new(4.85, -4.65), DVec2::new(RIGHT_EDGE, -1.85)),
    ] {
        let size = high - low;
        part.patch(cells(size.x, 0.1), cells(size.y, 0.1), |s, t| {
            let at = low + size * DVec2::new(s, t);
            Point {
                position: DVec3::new(at.x, 0.0, at.y),
                normal: DVec3::Y,
                uv: (at - DVec2::new(MIDDLE.x, MIDDLE.z)) / MOSAIC + 0.5,
            }
        });
    }
    part.add_to(scene, "floor", material, None);
    underside(scene);
}

/// Closes the ground from below, so that what reaches into it (the feet of walls, steps and urns) is inside something: no light leaks
/// up along a foot, and the bake knows those vertices for buried.
fn underside(scene: &mut Scene) {
    let earth = diffuse(scene, "earth", [0.2, 0.17, 0.14]);
    let low = DVec3::new(LEFT - 0.3, -0.15, BACK - 0.22);
    let size = DVec3::new(RIGHT_EDGE, 0.0, FRONT_EDGE) - low;
    let (x, y, z) = (DVec3::X * size.x, DVec3::Y, DVec3::Z * size.z);
    let mut part = Part::default();
    plane(&mut part, low, x, z, 1.0);
    // Sides: under the walls up into them, on the open sides up to the floor.
    plane(&mut part, low, z, y * 0.1, 1.0);
    plane(&mut part, low, y * 0.1, x, 1.0);
    plane(&mut part, low + x, y * 0.15, z, 1.0);
    plane(&mut part, low + z, x, y * 0.15, 1.0);
    part.add_to(scene, "underside", earth, None);
}

fn walls(scene: &mut Scene) {
    let white = diffuse(scene, "plaster", [1.0; 3]);
    let right = LEFT + BAYS as f64 * BAY;
    let mut terracotta = Part::default();
    // Low along the court, as high as the roof beside the loggia. No two parts share a plane: what lies in another's face sees half the
    // world by chance.
    let corner = ARCADE + HALF_DEPTH + 0.05;
    for (top, from, to, sides) in [
        (3.0, corner, 3.4, NO_BOTTOM - SIDES[4]),
        (TOP, BACK - 0.3, corner, NO_BOTTOM - SIDES[5]),
    ] {
        let low = DVec3::new(LEFT - 0.35, -0.1, from);
        cuboid(&mut terracotta, low, DVec3::new(LEFT, top, to), 0.13, sides);
    }
    // The step between the two.
    let low = DVec3::new(LEFT - 0.35, 3.0, ARCADE);
    cuboid(
        &mut terracotta,
        low,
        DVec3::new(LEFT, TOP, corner),
        0.13,
        SIDES[5],
    );
    let color = mottled([0.62, 0.20, 0.10]);
    terracotta.add_to(scene, "terracotta wall", white, Some(&color));
    let mut teal = Part::default();
    cuboid(
        &mut teal,
        DVec3::new(LEFT - 0.05, -0.1, BACK - 0.25),
        DVec3::new(right, TOP - 0.02, BACK),
        0.14,
        NO_BOTTOM,
    );
    let color = mottled([0.07, 0.34, 0.36]);
    teal.add_to(scene, "teal wall", white, Some(&color));
}

/// The wall above the columns, the loggia's roof, its floor and the steps up to it.
fn arcade(scene: &mut Scene) {
    let stone = diffuse(scene, "stone", [1.0; 3]);
    let right = LEFT + BAYS as f64 * BAY;
    let mut part = Part::default();
    for bay in 0..BAYS {
        let middle = LEFT + (bay as f64 + 0.5) * BAY;
        arch(&mut part, DVec3::new(middle, SPRING, ARCADE));
    }
    // The end of the wall over the last column.
    let low = DVec3::new(LEFT, SPRING, ARCADE - HALF_DEPTH);
    let high = DVec3::new(right, TOP, ARCADE + HALF_DEPTH);
    cuboid(&mut part, low, high, 0.15, SIDES[1] | SIDES[3]);
    // A cornice along the front, and the roof behind.
    let low = DVec3::new(LEFT - 0.05, TOP, ARCADE - HALF_DEPTH - 0.05);
    let high = DVec3::new(right + 0.08, TOP + 0.16, ARCADE + HALF_DEPTH + 0.1);
    cuboid(&mut part, low, high, 0.12, 63);
    let low = DVec3::new(LEFT - 0.1, TOP - 0.25, BACK - 0.1);
    let high = DVec3::new(right, TOP - 0.05, ARCADE - HALF_DEPTH + 0.05);
    cuboid(&mut part, low, high, 0.16, 63);
    let color = mottled([0.70, 0.64, 0.53]);
    part.add_to(scene, "arcade", stone, Some(&color));
    let mut steps = Part::default();
    // The loggia's floor, then the lower step before it and at its right end.
    let (front, end) = (ARCADE + 0.42, right + 0.3);
    let half = LOGGIA / 2.0;
    let left = LEFT - 0.05;
    for (low, high, sides) in [
        (
            DVec3::new(left, half - 0.03, BACK - 0.05),
            DVec3::new(end, LOGGIA, front),
            SIDES[1] | SIDES[3] | SIDES[5],
        ),
        (
            DVec3::new(left, -0.1, front - 0.04),
            DVec3::new(end + 0.32, half, front + 0.38),
            SIDES[1] | SIDES[3] | SIDES[5],
        ),
        (
            DVec3::new(end - 0.04, -0.1, BACK - 0.35),
            DVec3::new(end + 0.32, half, front - 0.04),
            SIDES[1] | SIDES[3] | SIDES[4],
        ),
    ] {
        cuboid(&mut steps, low, high, 0.11, sides);
    }
    let color = mottled([0.60, 0.56, 0.48]);
    steps.add_to(scene, "steps", stone, Some(&color));
}

/// One bay of the wall with its arch; `spring` is the middle of the springing line.
fn arch(part: &mut Part, spring: DVec3) {
    let half = BAY / 2.0;
    // Up into the cornice, so that the row of vertices under it is one of the wall and not of the corner.
    let height = TOP + 0.04 - SPRING;
    // Cells along the arch: a multiple of the three pieces, the same on the faces and on the soffit, so that their edges meet.
    let arc = 33;
    // From the arch outward to the edge of the bay, along the ray from the middle of the springing line.
    let outer = |way: DVec2| way * (half / way.x.abs().max(1e-9)).min(height / way.y.max(1e-9));
    // Angles of the bay's upper corners, so that the grid has points there.
    let corner = libm::atan2(height, half) / (2.0 * std::f64::consts::PI);
    let angle = |s: f64| {
        let pieces = [0.0, corner, 0.5 - corner, 0.5];
        let x = (s * 3.0).min(2.999_999_999);
        let i = x as usize;
        pieces[i] + (pieces[i + 1] - pieces[i]) * (s * 3.0 - i as f64)
    };
    for side in [-1.0, 1.0] {
        part.patch(arc, 8, |s, t| {
            let way = on_circle(angle(s));
            let at = (way * RADIUS).lerp(outer(way), t);
            let position = spring + DVec3::new(at.x, at.y, side * HALF_DEPTH);
            Point::new(position, DVec3::Z * side)
        });
    }
    part.patch(arc, 4, |s, t| {
        let way = on_circle(angle(s));
        let depth = (2.0 * t - 1.0) * HALF_DEPTH;
        let position = spring + DVec3::new(way.x * RADIUS, way.y * RADIUS, depth);
        Point::new(position, DVec3::new(-way.x, -way.y, 0.0))
    });
}

/// Columns under the arcade: base, shaft with a slight swell, capital and a square slab on top.
fn columns(scene: &mut Scene) {
    let stone = diffuse(scene, "column", [0.74, 0.69, 0.60]);
    let shaft: Vec<DVec2> = [(0.165, 0.14), (0.17, 0.9), (0.155, 1.5), (0.14, 1.86)]
        .map(into)
        .to_vec();
    let base: Vec<DVec2> = [
        (0.255, 0.0),
        (0.26, 0.04),
        (0.235, 0.075),
        (0.205, 0.085),
        (0.215, 0.115),
        (0.165, 0.14),
    ]
    .map(into)
    .to_vec();
    let capital: Vec<DVec2> = [
        (0.14, 1.86),
        (0.165, 1.88),
        (0.15, 1.90),
        (0.17, 1.96),
        (0.235, 2.03),
    ]
    .map(into)
    .to_vec();
    let slab_low = SPRING - LOGGIA - 0.02;
    let mut part = Part::default();
    for i in 0..=BAYS {
        let mut column = Part::default();
        for (points, along) in [(&base, 12), (&shaft, 22), (&capital, 10)] {
            lathe(&mut column, 24, along, |t| curve_through(points, t));
        }
        let half = DVec3::new(0.26, 0.0, 0.26);
        cuboid(
            &mut column,
            DVec3::Y * 2.03 - half,
            DVec3::Y * (slab_low + 0.04) + half,
            0.09,
            63,
        );
        let x = LEFT + i as f64 * BAY;
        // The outermost ones stand half in the wall, so they are drawn in.
        let x = x.clamp(LEFT + 0.24, LEFT + BAYS as f64 * BAY - 0.24);
        let place = DAffine3::from_translation(DVec3::new(x, LOGGIA - 0.01, ARCADE));
        part.join(&column.placed(place));
    }
    part.add_to(scene, "columns", stone, None);
}

/// Radius and height of a profile's point.
pub(super) fn into((x, y): (f64, f64)) -> DVec2 {
    DVec2::new(x, y)
}
