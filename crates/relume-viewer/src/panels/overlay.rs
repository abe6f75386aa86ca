//! What is drawn over the picture: handles of the selected lamp, and where near light is sampled.

use eframe::egui::{self, Color32, Stroke};

use crate::app::Viewer;
use crate::gizmo::Pointer;
use crate::near::Domain;
use crate::projection::Projection;

/// The most samples that are drawn.
const MOST: usize = 4096;

/// Lets the pointer have the handles and the lamps; whether it holds one, and the camera should stay.
pub fn handle(viewer: &mut Viewer, ui: &egui::Ui, response: &egui::Response) -> bool {
    let Some(projection) = Projection::new(&viewer.navigation.camera, response.rect) else {
        return false;
    };
    let held = drag(viewer, ui, response, &projection);
    if response.clicked()
        && !held
        && let Some(place) = response.interact_pointer_pos()
        && !viewer.near.is_empty()
    {
        let hit = viewer.near.at(projection.eye, projection.direction(place));
        viewer.near.selected = hit;
    }
    held
}

fn drag(
    viewer: &mut Viewer,
    ui: &egui::Ui,
    response: &egui::Response,
    projection: &Projection,
) -> bool {
    let Some(index) = viewer.near.selected else {
        return false;
    };
    let pointer = ui.input(|input| Pointer {
        at: input.pointer.latest_pos().unwrap_or_default(),
        hovers: response.hovered(),
        pressed: input.pointer.primary_pressed() && response.hovered(),
        down: input.pointer.primary_down(),
    });
    let mut lamp = viewer.near.lamps()[index].clone();
    let pose = lamp.emitter.world_from_emitter;
    let moved = viewer
        .gizmo
        .update(&pose, viewer.near.tool, projection, pointer);
    if let Some(moved) = moved.filter(|moved| *moved != pose) {
        lamp.emitter.world_from_emitter = moved;
        let outcome = viewer.near.edit(index, lamp);
        viewer
            .messages
            .standing("lamp", outcome.err().map(|error| error.to_string()));
        viewer.light_changed = true;
    }
    viewer.gizmo.is_held()
}

/// Draws over the picture.
pub fn paint(viewer: &Viewer, ui: &egui::Ui, rect: egui::Rect) {
    let Some(projection) = Projection::new(&viewer.navigation.camera, rect) else {
        return;
    };
    let painter = ui.painter_at(rect);
    let near = &viewer.near;
    if !near.method.is_exact() && !near.is_empty() {
        let domains = &viewer.report.domains;
        let domains = &domains[..domains.len().min(MOST)];
        if near.shows_domains {
            domains
                .iter()
                .for_each(|domain| outline(&painter, &projection, domain));
        }
        if near.shows_samples {
            domains
                .iter()
                .for_each(|domain| dot(&painter, &projection, domain));
        }
    }
    if let Some(selected) = near.selected {
        let pose = &near.lamps()[selected].emitter.world_from_emitter;
        viewer.gizmo.paint(&painter, pose, near.tool, &projection);
    }
}

fn dot(painter: &egui::Painter, projection: &Projection, domain: &Domain) {
    if let Some(place) = projection.screen(domain.at) {
        let colour =
            Color32::from_rgb(255, 120, 40).gamma_multiply(0.3 + 0.7 * domain.weight as f32);
        painter.circle(place, 2.5, colour, Stroke::new(1.0, Color32::BLACK));
    }
}

fn outline(painter: &egui::Painter, projection: &Projection, domain: &Domain) {
    let corners = projection.outline(domain.at, domain.radius);
    let colour = Color32::from_rgb(90, 170, 255).gamma_multiply(0.15 + 0.35 * domain.weight as f32);
    painter.add(egui::Shape::closed_line(corners, Stroke::new(1.0, colour)));
}
