//! Handles that move, turn and scale a lamp in the picture.

use eframe::egui;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use transform_gizmo::config::TransformPivotPoint;
use transform_gizmo::math::{DMat4, Transform};
use transform_gizmo::{
    EnumSet, GizmoConfig, GizmoInteraction, GizmoMode, GizmoOrientation, Rect, enum_set,
};

use crate::near::Tool;
use crate::projection::Projection;

/// The handles of one lamp.
#[derive(Default)]
pub struct Gizmo {
    handles: transform_gizmo::Gizmo,
}

/// What the pointer does over the picture.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pointer {
    /// Where it is, points of the window.
    pub at: egui::Pos2,
    /// Whether it is over the picture.
    pub hovers: bool,
    /// Whether the button went down in this frame.
    pub pressed: bool,
    /// Whether it is down.
    pub down: bool,
}

impl Gizmo {
    /// Follows the pointer; the new pose where a handle is dragged.
    pub fn update(
        &mut self,
        pose: &DAffine3,
        tool: Tool,
        projection: &Projection,
        pointer: Pointer,
        pixels_per_point: f32,
    ) -> Option<DAffine3> {
        self.handles.update_config(GizmoConfig {
            pixels_per_point,
            ..config(tool, projection)
        });
        let interaction = GizmoInteraction {
            cursor_pos: (pointer.at.x, pointer.at.y),
            hovered: pointer.hovers,
            drag_started: pointer.pressed,
            dragging: pointer.down,
        };
        let (_, moved) = self.handles.update(interaction, &[transform(pose)])?;
        moved.first().map(pose_of)
    }

    /// Whether a handle is under the pointer, or dragged.
    pub fn is_held(&self) -> bool {
        self.handles.is_focused()
    }

    /// Draws the handles.
    pub fn paint(&self, painter: &egui::Painter) {
        let drawn = self.handles.draw();
        let vertices = drawn.vertices.iter().zip(&drawn.colors);
        let vertex = |(place, color): (&[f32; 2], &[f32; 4])| egui::epaint::Vertex {
            pos: (*place).into(),
            uv: egui::epaint::WHITE_UV,
            color: egui::Rgba::from_rgba_premultiplied(color[0], color[1], color[2], color[3])
                .into(),
        };
        painter.add(egui::Mesh {
            indices: drawn.indices,
            vertices: vertices.map(vertex).collect(),
            ..egui::Mesh::default()
        });
    }
}

fn modes(tool: Tool) -> EnumSet<GizmoMode> {
    match tool {
        Tool::Move => GizmoMode::all_translate(),
        Tool::Turn => GizmoMode::all_rotate(),
        Tool::Scale => enum_set!(GizmoMode::ScaleUniform),
    }
}

fn config(tool: Tool, projection: &Projection) -> GizmoConfig {
    let Projection { rect, eye, frame } = projection;
    let vector = |v: DVec3| transform_gizmo::math::DVec3::new(v.x, v.y, v.z);
    let aspect = f64::from(rect.width() / rect.height());
    let fov = 2.0 * frame.half_height.atan();
    let view = DMat4::look_to_rh(vector(*eye), vector(frame.forward), vector(frame.up));
    // Handles are drawn over everything, so near and far need only be around them.
    let projection = DMat4::perspective_rh_gl(fov, aspect, 1e-3, 1e6);
    let corner = |p: egui::Pos2| transform_gizmo::math::Pos2::new(p.x, p.y);
    GizmoConfig {
        view_matrix: view.into(),
        projection_matrix: projection.into(),
        viewport: Rect::from_min_max(corner(rect.min), corner(rect.max)),
        modes: modes(tool),
        orientation: match tool {
            Tool::Move => GizmoOrientation::Global,
            Tool::Turn | Tool::Scale => GizmoOrientation::Local,
        },
        pivot_point: TransformPivotPoint::IndividualOrigins,
        ..GizmoConfig::default()
    }
}

fn transform(pose: &DAffine3) -> Transform {
    let (scale, rotation, at) = pose.to_scale_rotation_translation();
    let vector = |v: DVec3| transform_gizmo::math::DVec3::new(v.x, v.y, v.z);
    let rotation =
        transform_gizmo::math::DQuat::from_xyzw(rotation.x, rotation.y, rotation.z, rotation.w);
    Transform::from_scale_rotation_translation(vector(scale), rotation, vector(at))
}

/// A similarity: what is scaled is scaled alike along all axes.
fn pose_of(moved: &Transform) -> DAffine3 {
    let rotation = moved.rotation;
    let rotation = DQuat::from_xyzw(rotation.v.x, rotation.v.y, rotation.v.z, rotation.s);
    let scale = (moved.scale.x * moved.scale.y * moved.scale.z).abs().cbrt();
    let at = moved.translation;
    DAffine3 {
        matrix3: DMat3::from_quat(rotation.normalize()) * scale.max(1e-6),
        translation: DVec3::new(at.x, at.y, at.z),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;
    use glam::Vec3;
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
    fn drag(tool: Tool, pose: DAffine3, from: egui::Pos2, to: egui::Pos2) -> (bool, DAffine3) {
        let (mut gizmo, mut pose) = (Gizmo::default(), pose);
        let projection = projection();
        let step = |at, pressed, down| Pointer {
            at,
            hovers: true,
            pressed,
            down,
        };
        let middle = from + (to - from) * 0.5;
        let steps = [
            step(from, false, false),
            step(from, true, true),
            step(middle, false, true),
            step(to, false, true),
        ];
        let mut held = false;
        for pointer in steps {
            let moved = gizmo.update(&pose, tool, &projection, pointer, 1.0);
            pose = moved.unwrap_or(pose);
            held |= gizmo.is_held();
        }
        (held, pose)
    }

    #[test]
    fn a_lamp_is_dragged_along_an_axis_and_across_the_picture() {
        let pose = DAffine3::from_scale_rotation_translation(
            DVec3::splat(0.5),
            DQuat::from_rotation_y(0.3),
            DVec3::new(0.2, 0.1, 0.0),
        );
        let projection = projection();
        let from = projection.screen(pose.translation).unwrap();
        // On the handle along x, some way from its middle.
        let on_handle = from + egui::vec2(45.0, 0.0);
        let (held, moved) = drag(
            Tool::Move,
            pose,
            on_handle,
            on_handle + egui::vec2(90.0, 40.0),
        );
        assert!(held);
        let step = moved.translation - pose.translation;
        assert!(step.x > 0.3 && step.y.abs() + step.z.abs() < 1e-9, "{step}");
        assert!((moved.matrix3 - pose.matrix3).x_axis.length() < 1e-9);
        // Nothing is there.
        let (held, still) = drag(Tool::Move, pose, pos2(10.0, 10.0), pos2(99.0, 99.0));
        assert!(!held && still == pose);
    }

    #[test]
    fn scaled_and_turned_poses_are_similarities() {
        let pose = DAffine3::from_translation(DVec3::new(0.1, 0.0, 0.0));
        let from = projection().screen(pose.translation).unwrap();
        let mut changed = 0;
        for tool in [Tool::Scale, Tool::Turn] {
            for radius in 1..110 {
                let start = from + egui::vec2(radius as f32, 3.0);
                let (_, moved) = drag(tool, pose, start, start + egui::vec2(12.0, 25.0));
                changed += usize::from(moved != pose);
                let m = moved.matrix3;
                let scale = m.determinant().cbrt();
                assert!(
                    (m * m.transpose() - DMat3::IDENTITY * scale * scale)
                        .x_axis
                        .length()
                        < 1e-9
                );
                assert!((moved.translation - pose.translation).length() < 1e-9);
            }
        }
        assert!(changed > 8, "{changed}");
    }
}
