//! Messages over the picture, until they are closed.

use eframe::egui;

use crate::app::Viewer;
use crate::messages::Weight;

/// All messages, at the bottom.
pub fn show(viewer: &mut Viewer, context: &egui::Context) {
    if viewer.messages.shown.is_empty() {
        return;
    }
    let mut closed = None;
    egui::Area::new(egui::Id::unique("messages"))
        .anchor(egui::Align2::RIGHT_BOTTOM, [-12.0, -12.0])
        .order(egui::Order::Foreground)
        .show(context, |ui| {
            for (i, message) in viewer.messages.shown.iter().enumerate() {
                egui::Frame::popup(ui.style()).show(ui, |ui| {
                    ui.set_max_width(420.0);
                    ui.horizontal_wrapped(|ui| {
                        let color = match message.weight {
                            Weight::Note => ui.visuals().text_color(),
                            Weight::Error => ui.visuals().error_fg_color,
                        };
                        ui.colored_label(color, &message.text);
                        if ui.small_button("×").on_hover_text("close").clicked() {
                            closed = Some(i);
                        }
                    });
                });
            }
        });
    if let Some(closed) = closed {
        viewer.messages.shown.remove(closed);
    }
}
