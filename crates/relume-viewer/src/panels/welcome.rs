//! What is shown while there is no scene.

use eframe::egui;

use crate::app::Viewer;

/// In the middle of the empty picture.
pub fn show(viewer: &mut Viewer, ui: &mut egui::Ui, rect: egui::Rect) {
    let inner = rect.shrink2(egui::vec2(16.0, rect.height() * 0.35));
    ui.scope_builder(egui::UiBuilder::new().max_rect(inner), |ui| {
        ui.vertical_centered(|ui| {
            ui.heading("Drop a baked .glb here");
            ui.label("or a model, or an environment map (.hdr, .exr)");
            ui.add_space(8.0);
            if ui.button("Open…").clicked() {
                crate::files::pick(&viewer.jobs);
            }
            crate::gallery::menu(viewer, ui);
            #[cfg(not(target_arch = "wasm32"))]
            if let Some(baking) = &viewer.baking {
                let text = format!("baking {}", relume::files::printable(&baking.name));
                let bar = egui::ProgressBar::new(baking.done().unwrap_or(0.0)).text(text);
                ui.add(bar.desired_width(320.0));
            }
        });
    });
}
