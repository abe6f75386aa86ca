//! Handles pressed and dragged.

use super::*;
use eframe::egui::pos2;
use glam::{DQuat, Vec3};
use relume::display::Camera;

fn projection() -> Projection {
    let camera = Camera {
        eye: Vec3::new(0.0, 0.0, 5.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        fov_vertical_deg: 40.0,
    };
    let rect = egui::Rect::from_min_max(pos2(0.0, 0.0), pos2(800.0, 600.0));
    Projection::new(&camera, rect).unwrap()
}

/// Presses at `from`, drags to `to`.
fn drag(tool: Tool, pose: DAffine3, from: Pos2, to: Pos2) -> (bool, DAffine3) {
    let (mut gizmo, mut pose) = (Gizmo::default(), pose);
    let projection = projection();
    let step = |at, pressed, down| Pointer {
        at,
        hovers: true,
        pressed,
        down,
    };
    let steps = [
        step(from, false, false),
        step(from, true, true),
        step(from + (to - from) * 0.5, false, true),
        step(to, false, true),
    ];
    let mut held = false;
    for pointer in steps {
        let moved = gizmo.update(&pose, tool, &projection, pointer);
        pose = moved.unwrap_or(pose);
        held |= gizmo.is_held();
    }
    assert_eq!(
        gizmo.update(&pose, tool, &projection, step(to, false, false)),
        None
    );
    (held, pose)
}

fn pose() -> DAffine3 {
    DAffine3::from_scale_rotation_translation(
        DVec3::splat(0.5),
        DQuat::from_rotation_y(0.3),
        DVec3::new(0.2, 0.1, 0.0),
    )
}

/// Scaled alike along all axes.
fn is_similar(pose: &DAffine3) -> bool {
    let scale = pose.matrix3.determinant().cbrt();
    let product = pose.matrix3 * pose.matrix3.transpose();
    product.abs_diff_eq(DMat3::IDENTITY * (scale * scale), 1e-9 * scale * scale)
}

#[test]
fn a_lamp_is_dragged_along_an_axis_and_across_the_picture() {
    let middle = projection().screen(pose().translation).unwrap();
    let on_handle = middle + egui::vec2(45.0, 0.0);
    let (held, moved) = drag(
        Tool::Move,
        pose(),
        on_handle,
        on_handle + egui::vec2(90.0, 40.0),
    );
    let step = moved.translation - pose().translation;
    assert!(
        held && step.x > 0.3 && step.y.abs() + step.z.abs() < 1e-9,
        "{step}"
    );
    assert_eq!(moved.matrix3, pose().matrix3);
    // What is held in the middle stays under the pointer.
    let to = middle + egui::vec2(-60.0, 33.0);
    let (held, moved) = drag(Tool::Move, pose(), middle, to);
    assert!(held && moved.translation.z.abs() < 1e-9);
    let seen = projection().screen(moved.translation).unwrap();
    assert!((seen - to).length() < 1e-2, "{seen}");
    // Nothing is there.
    let (held, still) = drag(Tool::Move, pose(), pos2(10.0, 10.0), pos2(99.0, 99.0));
    assert!(!held && still == pose());
}

#[test]
fn a_lamp_is_scaled_by_its_corner() {
    let middle = projection().screen(pose().translation).unwrap();
    let corner = egui::vec2(0.6, -0.6) * LENGTH;
    let (held, moved) = drag(Tool::Scale, pose(), middle + corner, middle + corner * 2.0);
    let scale = moved.matrix3.determinant().cbrt();
    assert!(
        held && (scale - 1.0).abs() < 1e-5 && is_similar(&moved),
        "{scale}"
    );
    assert_eq!(moved.translation, pose().translation);
}

#[test]
fn a_lamp_is_turned_about_its_own_axes() {
    let flat = DAffine3::from_translation(DVec3::new(0.1, 0.0, 0.0));
    let middle = projection().screen(flat.translation).unwrap();
    // Seen from the front, z's ring is a circle: counter-clockwise along it, from where no other ring crosses it.
    let diagonal = std::f32::consts::FRAC_1_SQRT_2;
    let from = middle + egui::vec2(diagonal, -diagonal) * LENGTH;
    let step = egui::vec2(-diagonal, -diagonal) * 30.0;
    let (held, moved) = drag(Tool::Turn, flat, from, from + step);
    assert!(held && is_similar(&moved));
    assert!((moved.matrix3.z_axis - DVec3::Z).length() < 1e-9);
    let angle = moved.matrix3.x_axis.y.atan2(moved.matrix3.x_axis.x);
    assert!((angle - 30.0 / f64::from(LENGTH)).abs() < 0.02, "{angle}");
    // Every place of every ring of a slanted lamp turns it, and nothing else.
    let slanted = DAffine3::from_rotation_translation(
        DQuat::from_euler(glam::EulerRot::XYZ, 0.5, 0.8, 0.2),
        flat.translation,
    );
    let projection = projection();
    let handles = Handles::new(&slanted, &projection).unwrap();
    for axis in 0..3 {
        let line = handles.line(Handle::Ring(axis));
        assert!(line.len() > RING / 3, "{}", line.len());
        for ends in line.windows(2) {
            let (held, moved) = drag(
                Tool::Turn,
                slanted,
                ends[0],
                ends[0] + (ends[1] - ends[0]) * 2.0,
            );
            assert!(held && is_similar(&moved) && moved != slanted);
            assert_eq!(moved.translation, slanted.translation);
        }
    }
}
