//! Bundled scenes: baked on the spot in the native window, fetched from beside the page on the web.

use eframe::egui;

use crate::app::Viewer;
#[cfg(not(target_arch = "wasm32"))]
use crate::baking::{EXAMPLES, Subject};

/// A menu of the gallery.
#[cfg(not(target_arch = "wasm32"))]
pub fn menu(viewer: &mut Viewer, ui: &mut egui::Ui) {
    ui.menu_button("Gallery", |ui| {
        for (i, example) in EXAMPLES.iter().enumerate() {
            if ui
                .button(example.name)
                .on_hover_text(example.what)
                .clicked()
            {
                viewer.unbaked = None;
                viewer.bake(Subject::Bundled(i));
                ui.close();
            }
        }
    });
}

/// A menu of the gallery.
#[cfg(target_arch = "wasm32")]
pub fn menu(viewer: &mut Viewer, ui: &mut egui::Ui) {
    ui.menu_button("Gallery", |ui| {
        for (name, what) in crate::web::gallery() {
            if ui.button(&name).on_hover_text(&what).clicked() {
                crate::web::fetch(viewer.jobs.teller(), format!("gallery/{name}.glb"));
                ui.close();
            }
        }
    });
}
