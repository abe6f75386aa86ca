//! Files that are dropped on the window.

use eframe::egui;

use crate::app::Viewer;
#[cfg(not(target_arch = "wasm32"))]
use crate::source::Source;

/// Opens what was dropped; says that it may be while it hovers.
pub fn handle(viewer: &mut Viewer, context: &egui::Context) {
    for file in context.input(|input| input.raw.dropped_files.clone()) {
        #[cfg(not(target_arch = "wasm32"))]
        viewer.jobs.open(Source::Path(file.path().to_owned()));
        #[cfg(target_arch = "wasm32")]
        crate::web::read_dropped(viewer.jobs.teller(), &file);
    }
    if context.input(|input| !input.raw.hovered_files.is_empty()) {
        let layer = egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop"));
        let painter = context.layer_painter(layer);
        let rect = context.content_rect();
        painter.rect_filled(rect, 0.0, egui::Color32::from_black_alpha(160));
        let font = egui::FontId::proportional(26.0);
        let (align, white) = (egui::Align2::CENTER_CENTER, egui::Color32::WHITE);
        painter.text(rect.center(), align, "Drop to open", font, white);
    }
}
