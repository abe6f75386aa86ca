//! What surfaces are made of, to be tried out.

use eframe::egui::{self, color_picker};
use relume::brdf::Reflection;
use relume::scene::Material;
use relume_gpu::MaterialEdit;

use crate::app::Viewer;

/// A material after another, folded: its colour, and, where surfaces are glossy, roughness and metalness.
pub fn show(viewer: &mut Viewer, ui: &mut egui::Ui) {
    let Some(content) = &viewer.content else {
        ui.weak("Nothing yet.");
        return;
    };
    let glossy = content.asset.transfer.matrices.is_some();
    let world = std::sync::Arc::clone(&content.world);
    if !glossy {
        ui.weak("A diffuse asset: only colours show. Bake with --transfer glossy for roughness and metalness.");
    }
    let mut changed = Vec::new();
    for (index, (material, edit)) in world
        .materials
        .iter()
        .zip(&mut viewer.materials)
        .enumerate()
    {
        let name = relume::files::printable(&material.name);
        // Two may have one name.
        egui::CollapsingHeader::new(name)
            .id_salt(("material", index))
            .show(ui, |ui| {
                let before = *edit;
                controls(material, glossy, edit, ui);
                if before != *edit {
                    changed.push((index, *edit));
                }
            });
    }
    ui.weak("What they reflect onto others stays as baked.");
    for (index, edit) in changed {
        viewer.edit_material(index, &edit);
    }
}

fn controls(material: &Material, glossy: bool, edit: &mut MaterialEdit, ui: &mut egui::Ui) {
    let fixed = glossy
        && matches!(
            material.reflection,
            Reflection::Fixed(_) | Reflection::Tile { .. }
        );
    if fixed {
        ui.weak("A BRDF or a tile with colours of its own, which cannot be edited yet.");
    }
    egui::Grid::new("material").num_columns(2).show(ui, |ui| {
        if !fixed {
            ui.label("Colour");
            let [r, g, b] = edit.base_color;
            let mut color = egui::Rgba::from_rgb(r, g, b);
            let alpha = color_picker::Alpha::Opaque;
            if color_picker::color_edit_button_rgba(ui, &mut color, alpha).changed() {
                edit.base_color = [color.r(), color.g(), color.b()];
            }
            ui.end_row();
        }
        if glossy && matches!(material.reflection, Reflection::MetallicRoughness { .. }) {
            ui.label("Roughness");
            ui.add(egui::Slider::new(&mut edit.roughness, 0.0..=1.0));
            ui.end_row();
            ui.label("Metalness");
            ui.add(egui::Slider::new(&mut edit.metallic, 0.0..=1.0));
            ui.end_row();
        }
        if has_maps(material, glossy) {
            ui.label("Textures");
            ui.checkbox(&mut edit.maps, "shown");
            ui.end_row();
        }
    });
    let baked = MaterialEdit::from(material);
    let edited = *edit != baked;
    if ui
        .add_enabled(edited, egui::Button::new("As baked"))
        .clicked()
    {
        *edit = baked;
    }
}

/// Whether it has textures that show.
fn has_maps(material: &Material, glossy: bool) -> bool {
    let finish = material.metallic_roughness_texture.is_some();
    let glossy = glossy && (finish || material.normal_texture.is_some());
    glossy || material.base_color_texture.is_some()
}
