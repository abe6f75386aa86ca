//! Baking: what is chosen before it, and how far it is.

use eframe::egui;

use crate::app::Viewer;
use crate::baking::Subject;

/// Order, rays and bounces of the next bake; progress and cancel of the one under way.
pub fn show(viewer: &mut Viewer, ui: &mut egui::Ui) {
    let choices = &mut viewer.choices;
    egui::Grid::new("bake choices")
        .num_columns(2)
        .show(ui, |ui| {
            ui.label("Order");
            ui.add(egui::Slider::new(&mut choices.order, 1..=12));
            ui.end_row();
            ui.label("Rays");
            let rays = egui::Slider::new(&mut choices.samples, 16..=16384).logarithmic(true);
            ui.add(rays).on_hover_text("per vertex");
            ui.end_row();
            ui.label("Bounces");
            ui.add(egui::Slider::new(&mut choices.bounces, 0..=6));
            ui.end_row();
            ui.label("Glossy");
            let glossy = ui.checkbox(&mut choices.glossy, "matrices");
            glossy.on_hover_text(
                "surfaces shine as their materials say; many times the memory and the time",
            );
            ui.end_row();
        });
    let again = viewer.unbaked.clone();
    if let Some(baking) = &viewer.baking {
        let bar = match baking.done() {
            Some(done) => egui::ProgressBar::new(done).show_percentage(),
            None => egui::ProgressBar::new(0.0).text("reading"),
        };
        ui.label(relume::files::printable(&baking.name));
        ui.add(bar);
        if ui.button("Cancel").clicked() {
            baking.cancel();
        }
        // Progress comes from another thread.
        ui.ctx()
            .request_repaint_after(std::time::Duration::from_millis(100));
    } else if let Some(path) = again {
        if ui.button("Bake again").clicked() {
            viewer.bake(Subject::Model(path));
        }
    } else {
        ui.weak("Models that are not baked yet are baked when they are opened.");
    }
}
