//! What is open, and what else could be.

use eframe::egui;
use relume::asset::TransferKind;

use crate::app::Viewer;
use crate::content::Content;
use crate::files;

/// Open dialog, gallery, and what the scene holds.
pub fn show(viewer: &mut Viewer, ui: &mut egui::Ui) {
    ui.horizontal_wrapped(|ui| {
        if ui
            .button("Open…")
            .on_hover_text("a baked .glb, a model, or a light")
            .clicked()
        {
            files::pick(&viewer.jobs);
        }
        crate::gallery::menu(viewer, ui);
        #[cfg(not(target_arch = "wasm32"))]
        if viewer.content.is_some()
            && ui
                .button("Save…")
                .on_hover_text("the baked asset")
                .clicked()
        {
            save(viewer);
        }
    });
    match &viewer.content {
        Some(content) => facts(content, ui),
        None => {
            ui.weak("Nothing yet. Files can also be dropped anywhere.");
        }
    }
}

fn facts(content: &Content, ui: &mut egui::Ui) {
    let transfer = &content.asset.transfer;
    ui.label(relume::files::printable(&content.name));
    let paths = match transfer.kind {
        TransferKind::Unshadowed => "unshadowed".to_owned(),
        TransferKind::Shadowed { bounces: 0 } => "shadowed".to_owned(),
        TransferKind::Shadowed { bounces: 1 } => "1 bounce".to_owned(),
        TransferKind::Shadowed { bounces } => format!("{bounces} bounces"),
    };
    let matrices = transfer.matrices.as_ref();
    let numbers = transfer.coefficients.len() + matrices.map_or(0, |m| m.coefficients.len());
    let bytes = numbers * transfer.precision.bytes();
    ui.weak(format!(
        "{} vertices, {} triangles\norder {}, {} × {}, {paths}, {:.1} MB of transfer",
        transfer.vertex_count(),
        content.world.triangles.len(),
        transfer.order.get(),
        transfer.channels,
        transfer.precision.token(),
        bytes as f64 / 1e6,
    ));
    if let Some(matrices) = matrices {
        ui.weak(format!("glossy, transfer order {}", matrices.order.get()));
    }
}

#[cfg(not(target_arch = "wasm32"))]
fn save(viewer: &mut Viewer) {
    let Some(content) = &viewer.content else {
        return;
    };
    let asset = content.asset.clone();
    let stem = content.name.trim_end_matches(".glb");
    files::save(&viewer.jobs, format!("{stem}.glb"), move |path| {
        relume::asset::write(&asset, path).map_err(|error| error.to_string())
    });
}
