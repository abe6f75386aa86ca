//! The demo's scene: a courtyard with an arcade, a sculpture, urns and coloured walls.

use glam::{DAffine3, DQuat, DVec2, DVec3, Vec3};

use super::paint::{lattice, mosaic, noise, plaster};
use super::part::{Part, Point, add_material};
use super::shapes::{
    Knot, NO_BOTTOM, SIDES, ball, cells, cuboid, curve_through, lathe, lathe_line, on_circle,
};
use crate::display::Camera;
use crate::scene::{AlphaMode, Material, Scene};

/// Middle of the floor, its medallion and the sculpture.
const MIDDLE: DVec3 = DVec3::new(0.7, 0.0, 1.0);
/// Side of the floor, metres.
const FLOOR: f64 = 12.0;
/// Height of the loggia's floor.
const LOGGIA: f64 = 0.32;
/// Left end of the arcade, and the plane of the terracotta wall.
const LEFT: f64 = -4.4;
/// The arcade's middle plane, half its thickness, and the face of the teal wall behind it.
const ARCADE: f64 = -2.6;
const HALF_DEPTH: f64 = 0.2;
const BACK: f64 = -4.4;
/// Bays, their width and the radius of their arches.
const BAYS: usize = 4;
const BAY: f64 = 2.2;
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
    sculpture(&mut scene);
    urns(&mut scene);
    balls(&mut scene);
    screen(&mut scene);
    awning(&mut scene);
    cypresses(&mut scene);
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

fn diffuse(scene: &mut Scene, name: &str, albedo: [f32; 3]) -> usize {
    add_material(scene, Material::diffuse(name, albedo))
}

/// Plaster of one colour, mottled through vertex colours.
fn mottled(color: [f32; 3]) -> impl Fn(DVec3) -> [f32; 3] {
    move |p| color.map(|c| c * plaster(p) as f32)
}

fn floor(scene: &mut Scene) {
    scene.textures.push(mosaic(1024, FLOOR));
    let material = add_material(
        scene,
        Material {
            base_color_texture: Some(scene.textures.len() - 1),
            ..Material::diffuse("mosaic", [1.0; 3])
        },
    );
    let mut part = Part::default();
    let n = 118;
    part.patch(n, n, |s, t| Point {
        position: MIDDLE + DVec3::new(s - 0.5, 0.0, t - 0.5) * FLOOR,
        normal: DVec3::Y,
        uv: DVec2::new(s, t),
    });
    part.add_to(scene, "floor", material, None);
}

fn walls(scene: &mut Scene) {
    let white = diffuse(scene, "plaster", [1.0; 3]);
    let right = LEFT + BAYS as f64 * BAY;
    let mut terracotta = Part::default();
    // Low along the court, as high as the roof beside the loggia.
    for (top, from, to, sides) in [
        (3.0, ARCADE + HALF_DEPTH, 3.4, NO_BOTTOM - SIDES[4]),
        (TOP, BACK - 0.3, ARCADE + HALF_DEPTH, NO_BOTTOM - SIDES[5]),
    ] {
        let low = DVec3::new(LEFT - 0.35, -0.1, from);
        cuboid(&mut terracotta, low, DVec3::new(LEFT, top, to), 0.13, sides);
    }
    // The step between the two.
    let low = DVec3::new(LEFT - 0.35, 3.0, ARCADE);
    let high = DVec3::new(LEFT, TOP, ARCADE + HALF_DEPTH);
    cuboid(&mut terracotta, low, high, 0.13, SIDES[5]);
    let color = mottled([0.62, 0.20, 0.10]);
    terracotta.add_to(scene, "terracotta wall", white, Some(&color));
    let mut teal = Part::default();
    cuboid(
        &mut teal,
        DVec3::new(LEFT - 0.35, -0.1, BACK - 0.3),
        DVec3::new(right, TOP, BACK),
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
    for (top, front, end) in [
        (LOGGIA, ARCADE + 0.42, right + 0.3),
        (LOGGIA / 2.0, ARCADE + 0.80, right + 0.62),
    ] {
        let low = DVec3::new(LEFT - 0.1, -0.1, BACK - 0.1);
        let high = DVec3::new(end, top, front);
        cuboid(&mut steps, low, high, 0.11, SIDES[1] | SIDES[3] | SIDES[5]);
    }
    let color = mottled([0.60, 0.56, 0.48]);
    steps.add_to(scene, "steps", stone, Some(&color));
}

/// One bay of the wall with its arch; `spring` is the middle of the springing line.
fn arch(part: &mut Part, spring: DVec3) {
    let half = BAY / 2.0;
    let height = TOP - SPRING;
    let arc = 32;
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
        part.patch(33, 6, |s, t| {
            let way = on_circle(angle(s));
            let at = (way * RADIUS).lerp(outer(way), t);
            let position = spring + DVec3::new(at.x, at.y, side * HALF_DEPTH);
            Point::new(position, DVec3::Z * side)
        });
    }
    part.patch(arc, 4, |s, t| {
        let way = on_circle(0.5 * s);
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
            DVec3::Y * (slab_low + 0.03) + half,
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

fn into((x, y): (f64, f64)) -> DVec2 {
    DVec2::new(x, y)
}

/// The white torus knot on its round stepped plinth.
fn sculpture(scene: &mut Scene) {
    let stone = diffuse(scene, "plinth", [0.66, 0.60, 0.50]);
    let white = diffuse(scene, "white", [0.85, 0.84, 0.82]);
    let mut plinth = Part::default();
    let corners = [
        (1.05, -0.05),
        (1.05, 0.16),
        (0.80, 0.16),
        (0.80, 0.32),
        (0.52, 0.32),
        (0.46, 0.95),
        (0.56, 0.95),
        (0.56, 1.05),
        (0.0, 1.05),
    ]
    .map(into);
    for pair in corners.windows(2) {
        lathe_line(&mut plinth, 72, 0.075, pair[0], pair[1]);
    }
    let here = DAffine3::from_translation(MIDDLE);
    plinth.placed(here).add_to(scene, "plinth", stone, None);
    let mut knot = Part::default();
    Knot {
        p: 2.0,
        q: 3.0,
        ring: 0.50,
        swing: 0.24,
        tube: 0.135,
    }
    .build(&mut knot, 360, 26);
    // Upright, and leaning on nothing: its lowest point just above the plinth.
    let upright = DQuat::from_rotation_x(libm::acos(0.0)) * DQuat::from_rotation_y(0.5);
    let place = DAffine3::from_rotation_translation(upright, MIDDLE + DVec3::Y * 1.96);
    knot.placed(place).add_to(scene, "knot", white, None);
}

fn urns(scene: &mut Scene) {
    let blue = diffuse(scene, "blue glaze", [0.06, 0.16, 0.42]);
    let amber = diffuse(scene, "amber glaze", [0.72, 0.36, 0.07]);
    let outside = [
        (0.20, 0.0),
        (0.215, 0.04),
        (0.19, 0.09),
        (0.30, 0.28),
        (0.42, 0.58),
        (0.43, 0.80),
        (0.30, 1.02),
        (0.19, 1.14),
        (0.20, 1.22),
        (0.265, 1.28),
        (0.275, 1.30),
        (0.255, 1.305),
        (0.18, 1.22),
        (0.165, 1.13),
        (0.27, 1.0),
        (0.39, 0.80),
        (0.38, 0.60),
        (0.25, 0.30),
        (0.0, 0.2),
    ]
    .map(into);
    for (name, material, at, scale, around) in [
        ("blue urn", blue, DVec3::new(-3.35, 0.0, 0.1), 1.15, 56),
        (
            "amber urn",
            amber,
            DVec3::new(3.35, LOGGIA / 2.0, -1.95),
            0.72,
            48,
        ),
    ] {
        let mut part = Part::default();
        lathe(&mut part, around, 72, |t| curve_through(&outside, t));
        let place =
            DAffine3::from_scale_rotation_translation(DVec3::splat(scale), DQuat::IDENTITY, at);
        part.placed(place).add_to(scene, name, material, None);
    }
}

fn balls(scene: &mut Scene) {
    let white = diffuse(scene, "chalk", [0.86, 0.85, 0.83]);
    let red = diffuse(scene, "vermilion", [0.66, 0.09, 0.05]);
    let gold = diffuse(scene, "saffron", [0.80, 0.46, 0.05]);
    for (name, material, at, radius, around) in [
        ("chalk ball", white, DVec3::new(-3.3, 0.0, 1.95), 0.62, 64),
        ("vermilion ball", red, DVec3::new(-2.2, 0.0, 2.55), 0.30, 44),
        ("saffron ball", gold, DVec3::new(2.75, 0.0, 2.35), 0.34, 48),
    ] {
        let mut part = Part::default();
        ball(&mut part, at + DVec3::Y * radius, radius, around);
        part.add_to(scene, name, material, None);
    }
}

/// A lattice in the lower part of the last arch.
fn screen(scene: &mut Scene) {
    scene.textures.push(lattice(512, 6.0));
    let material = add_material(
        scene,
        Material {
            base_color_texture: Some(scene.textures.len() - 1),
            alpha: AlphaMode::Mask(0.5),
            double_sided: true,
            ..Material::diffuse("lattice", [1.0; 3])
        },
    );
    let left = LEFT + 3.0 * BAY + 0.2;
    let width = BAY - 0.5;
    let mut part = Part::default();
    let n = cells(width, 0.07);
    part.patch(n, n, |s, t| Point {
        position: DVec3::new(left + width * s, LOGGIA + width * (1.0 - t), ARCADE - 0.02),
        normal: DVec3::Z,
        uv: DVec2::new(s, t),
    });
    part.add_to(scene, "lattice", material, None);
}

/// Three trees behind the terracotta wall.
fn cypresses(scene: &mut Scene) {
    let green = diffuse(scene, "cypress", [1.0; 3]);
    let outline = [
        (0.0, -0.1),
        (0.10, 0.0),
        (0.42, 0.5),
        (0.50, 1.2),
        (0.40, 2.6),
        (0.18, 4.0),
        (0.0, 4.7),
    ];
    let outline = outline.map(into);
    let mut part = Part::default();
    for (x, z, scale) in [(-6.0, 1.1, 0.86), (-6.3, -0.2, 0.97), (-5.9, -1.5, 0.84)] {
        let mut tree = Part::default();
        lathe(&mut tree, 20, 40, |t| curve_through(&outline, t));
        let place = DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            DQuat::IDENTITY,
            DVec3::new(x, 0.0, z),
        );
        part.join(&tree.placed(place));
    }
    let leaves = |p: DVec3| {
        let tuft = noise(DVec3::new(p.x * 5.0, p.y * 2.0, p.z * 5.0));
        [0.05, 0.11, 0.035].map(|c| c * (0.55 + 0.9 * tuft as f32))
    };
    part.add_to(scene, "cypresses", green, Some(&leaves));
}

/// A sail from the terracotta wall to a pole.
fn awning(scene: &mut Scene) {
    let cloth = add_material(
        scene,
        Material {
            double_sided: true,
            ..Material::diffuse("cloth", [1.0; 3])
        },
    );
    let corners = [
        DVec3::new(LEFT + 0.02, 2.75, -1.6),
        DVec3::new(LEFT + 0.02, 2.95, 1.9),
        DVec3::new(-2.3, 2.35, 1.5),
        DVec3::new(-2.5, 2.75, -1.3),
    ];
    let mut part = Part::default();
    let at = |s: f64, t: f64| {
        let near = corners[0].lerp(corners[1], s);
        let far = corners[3].lerp(corners[2], s);
        let sag = 0.5 * s * (1.0 - s) + 0.35 * t * (1.0 - t);
        near.lerp(far, t) - DVec3::Y * sag
    };
    part.patch(40, 30, |s, t| {
        let step = 1e-4;
        let (ds, dt) = (
            at(s + step, t) - at(s - step, t),
            at(s, t + step) - at(s, t - step),
        );
        Point::new(at(s, t), ds.cross(dt))
    });
    let color = |p: DVec3| {
        let stripe = ((p.z + 1.6) / 0.35).floor().rem_euclid(2.0) < 0.5;
        if stripe {
            [0.80, 0.72, 0.56]
        } else {
            [0.78, 0.40, 0.08]
        }
    };
    part.add_to(scene, "awning", cloth, Some(&color));
}
