//! How the scene is looked at.

use eframe::egui;
use relume_gpu::Surface;

use crate::app::Viewer;
use crate::content::{Content, Paths};
use crate::navigation::Mode;

/// Exposure, what is shown, and the camera.
pub fn show(viewer: &mut Viewer, ui: &mut egui::Ui) {
    // Rows of a grid do not wrap.
    ui.horizontal_wrapped(|ui| paths(viewer, ui));
    let content = viewer.content.as_ref();
    let glossy = content.is_some_and(|c| c.asset.transfer.matrices.is_some());
    if glossy && viewer.paths == Paths::Unshadowed {
        ui.weak("Without shadows: as if all were diffuse.");
    }
    egui::Grid::new("view").num_columns(2).show(ui, |ui| {
        ui.label("Exposure");
        ui.horizontal(|ui| {
            ui.add(egui::Slider::new(&mut viewer.look.exposure, -10.0..=10.0).suffix(" stops"));
            if ui.button("Auto").clicked() {
                viewer.auto_exposure();
            }
        });
        ui.end_row();
        ui.label("Surface");
        ui.horizontal(|ui| {
            let surface = &mut viewer.look.surface;
            ui.selectable_value(surface, Surface::Shaded, "shaded");
            ui.selectable_value(surface, Surface::White, "white")
                .on_hover_text("as if everything were white");
            ui.selectable_value(surface, Surface::Albedo, "albedo");
        });
        ui.end_row();
        ui.label("Also");
        ui.horizontal(|ui| {
            ui.toggle_value(&mut viewer.look.background, "background");
            ui.toggle_value(&mut viewer.look.wireframe, "wireframe");
        });
        ui.end_row();
        ui.label("Camera");
        ui.horizontal(|ui| {
            ui.selectable_value(&mut viewer.navigation.mode, Mode::Orbit, "orbit");
            ui.selectable_value(&mut viewer.navigation.mode, Mode::Fly, "fly");
            if ui.button("Reset").clicked() {
                viewer.navigation.reset();
            }
        });
        ui.end_row();
        ui.label("Angle");
        let fov = &mut viewer.navigation.camera.fov_vertical_deg;
        ui.add(egui::Slider::new(fov, 5.0..=120.0).suffix("°"));
        ui.end_row();
    });
    if ui.button("Screenshot…").clicked() {
        crate::files::save_picture(viewer);
    }
}

/// Unshadowed, shadowed, interreflected: what is there, or can be had.
fn paths(viewer: &mut Viewer, ui: &mut egui::Ui) {
    let Some(bounces) = viewer.content.as_ref().map(Content::bounces) else {
        return;
    };
    let mut wanted = viewer.paths;
    ui.selectable_value(&mut wanted, Paths::Unshadowed, "unshadowed");
    match bounces {
        Some(0) => {
            ui.selectable_value(&mut wanted, Paths::Baked, "shadowed");
        }
        Some(_) => {
            let there = viewer
                .content
                .as_ref()
                .is_some_and(|c| c.shadowed.is_some());
            let possible = there || cfg!(not(target_arch = "wasm32"));
            let label = ui.add_enabled(
                possible,
                egui::Button::selectable(wanted == Paths::Shadowed, "shadowed"),
            );
            let label = label.on_disabled_hover_text(
                "the asset holds no direct light of its own; the native viewer bakes it",
            );
            if label.clicked() {
                wanted = Paths::Shadowed;
            }
            ui.selectable_value(&mut wanted, Paths::Baked, "interreflected");
        }
        None => (),
    }
    if wanted != viewer.paths {
        choose(viewer, wanted);
    }
}

/// Shows these paths; direct light that is not there is baked first.
pub fn choose(viewer: &mut Viewer, wanted: Paths) {
    #[cfg(not(target_arch = "wasm32"))]
    if wanted == Paths::Shadowed
        && viewer.baking.is_none()
        && let Some(content) = &viewer.content
        && content.shadowed.is_none()
        && content.bounces() != Some(0)
    {
        viewer.shadowed_wanted = true;
        viewer.bake_direct();
        return;
    }
    if viewer
        .content
        .as_mut()
        .is_some_and(|c| c.transfer(wanted).is_some())
    {
        viewer.show_paths(wanted);
    }
}
