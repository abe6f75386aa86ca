//! What stands in the courtyard.

use glam::{DAffine3, DQuat, DVec2, DVec3};

use super::courtyard::{ARCADE, BAY, LEFT, LOGGIA, MIDDLE, diffuse, into};
use super::paint::{lattice, noise};
use super::part::{Part, Point, add_material};
use super::shapes::{Knot, ball, cells, cuboid, curve_through, lathe, lathe_line};
use crate::scene::{AlphaMode, Material, Scene};

/// The white torus knot on its round stepped plinth.
pub fn sculpture(scene: &mut Scene) {
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

pub fn urns(scene: &mut Scene) {
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
        ("blue urn", blue, DVec3::new(-3.35, -0.02, 0.1), 1.15, 56),
        (
            "amber urn",
            amber,
            DVec3::new(3.35, LOGGIA / 2.0 - 0.02, -1.95),
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

pub fn balls(scene: &mut Scene) {
    let white = diffuse(scene, "chalk", [0.86, 0.85, 0.83]);
    let red = diffuse(scene, "vermilion", [0.66, 0.09, 0.05]);
    let gold = diffuse(scene, "saffron", [0.80, 0.46, 0.05]);
    for (name, material, at, radius, around) in [
        ("chalk ball", white, DVec3::new(-3.3, 0.0, 1.95), 0.62, 64),
        ("vermilion ball", red, DVec3::new(-2.2, 0.0, 2.55), 0.30, 44),
        ("saffron ball", gold, DVec3::new(2.75, 0.0, 2.35), 0.34, 48),
    ] {
        let mut part = Part::default();
        // Pressed in a little, as heavy things are.
        ball(&mut part, at + DVec3::Y * (radius - 0.01), radius, around);
        part.add_to(scene, name, material, None);
    }
}

/// A lattice in the lower part of the last arch.
pub fn screen(scene: &mut Scene) {
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
        position: DVec3::new(
            left + width * s,
            LOGGIA - 0.02 + width * (1.0 - t),
            ARCADE - 0.02,
        ),
        normal: DVec3::Z,
        uv: DVec2::new(s, t),
    });
    part.add_to(scene, "lattice", material, None);
}

/// Three trees in a bed behind the terracotta wall.
pub fn cypresses(scene: &mut Scene) {
    let lawn = diffuse(scene, "lawn", [0.10, 0.17, 0.05]);
    let mut bed = Part::default();
    let (low, high) = (
        DVec3::new(-7.1, -0.15, -2.6),
        DVec3::new(LEFT - 0.3, 0.12, 2.2),
    );
    cuboid(&mut bed, low, high, 0.22, 63);
    bed.add_to(scene, "bed", lawn, None);
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
pub fn awning(scene: &mut Scene) {
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
