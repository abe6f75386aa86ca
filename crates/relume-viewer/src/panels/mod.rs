//! The user interface, one file per panel. Whatever is written by files is shown as plain text.

#[cfg(not(target_arch = "wasm32"))]
mod bake;
pub mod drop;
mod help;
mod light;
mod materials;
pub mod messages;
pub mod near;
pub mod overlay;
pub mod pointer;
mod scene;
mod sphere;
mod times;
mod view;
pub mod welcome;

use std::sync::Arc;

use eframe::egui::{self, FontData, FontDefinitions, FontFamily};

use crate::app::Viewer;

/// Below this width, in points, panels lie under the picture instead of beside it.
const NARROW: f32 = 640.0;

/// What is open.
#[derive(Default)]
pub struct Open {
    /// The panels.
    pub panels: bool,
    /// The page of keys.
    pub help: bool,
    /// The ball that shows the light.
    pub sphere: bool,
    /// Its picture, and for which light it was made.
    ball: Option<sphere::Ball>,
}

impl Open {
    /// At the start.
    pub fn new(panels: bool) -> Self {
        Self {
            panels,
            ..Self::default()
        }
    }
}

/// Sizes that can be read and touched on a phone, too.
pub fn style(context: &egui::Context) {
    context.set_fonts(fonts());
    context.set_theme(egui::Theme::Dark);
    context.all_styles_mut(|style| {
        style.spacing.item_spacing = egui::vec2(8.0, 6.0);
        style.spacing.interact_size.y = 24.0;
        style.spacing.slider_width = 110.0;
        for font in style.text_styles.values_mut() {
            font.size *= 1.08;
        }
    });
}

/// One font for everything: each more is a tenth of what a page weighs over the wire.
fn fonts() -> FontDefinitions {
    let name = "Ubuntu-Light".to_owned();
    let data = FontData::from_static(epaint_default_fonts::UBUNTU_LIGHT);
    let families = [FontFamily::Proportional, FontFamily::Monospace];
    FontDefinitions {
        font_data: [(name.clone(), Arc::new(data))].into(),
        families: families.map(|family| (family, vec![name.clone()])).into(),
    }
}

/// All panels; what is left of `ui` is for the picture.
pub fn show(viewer: &mut Viewer, ui: &mut egui::Ui) {
    if viewer.open.panels {
        let narrow = ui.available_width() < NARROW;
        let height = ui.available_height();
        let panel = if narrow {
            egui::Panel::bottom("panels below")
                .max_size(0.5 * height)
                .default_size(0.4 * height)
        } else {
            egui::Panel::left("panels")
                .default_size(340.0)
                .min_size(240.0)
        };
        panel.resizable(true).show(ui, |ui| {
            egui::ScrollArea::vertical()
                .auto_shrink([false; 2])
                .show(ui, |ui| contents(viewer, ui));
        });
    }
    help::show(&mut viewer.open.help, ui.ctx());
}

fn contents(viewer: &mut Viewer, ui: &mut egui::Ui) {
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        ui.heading("Relume");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let hide = ui.button("Hide").on_hover_text("F2 shows them again");
            if hide.clicked() {
                viewer.open.panels = false;
            }
            ui.toggle_value(&mut viewer.open.help, "Keys");
        });
    });
    section(ui, "Scene", true, |ui| scene::show(viewer, ui));
    #[cfg(not(target_arch = "wasm32"))]
    section(ui, "Bake", viewer.baking.is_some(), |ui| {
        bake::show(viewer, ui);
    });
    section(ui, "Light", true, |ui| light::show(viewer, ui));
    section(ui, "Near lights", !viewer.near.is_empty(), |ui| {
        near::show(viewer, ui);
    });
    section(ui, "Materials", false, |ui| materials::show(viewer, ui));
    section(ui, "View", true, |ui| view::show(viewer, ui));
    section(ui, "Times", true, |ui| times::show(viewer, ui));
}

/// A part that can be folded; `open` at first.
fn section(ui: &mut egui::Ui, title: &str, open: bool, contents: impl FnOnce(&mut egui::Ui)) {
    egui::CollapsingHeader::new(egui::RichText::new(title).strong())
        .default_open(open)
        .show(ui, contents);
}
