//! Lights that stand near: which, where, and how their light is sampled.

use eframe::egui;
use glam::DVec3;

use crate::app::Viewer;
use crate::content::Content;
use crate::near::{Lamp, Made, Method, Near, Tool};

/// Everything about near lights.
pub fn show(viewer: &mut Viewer, ui: &mut egui::Ui) {
    ui.horizontal_wrapped(|ui| choose(viewer, ui));
    if viewer.near.is_empty() {
        ui.weak("None. Add one, or drop an emitters.json.");
        let content = viewer.content.as_ref();
        if content.is_some_and(Content::can_bounce) {
            viewer.light_changed |= ui
                .horizontal(|ui| bounces(&mut viewer.near.bounces, ui))
                .inner;
        }
        return;
    }
    list(&mut viewer.near, ui);
    if let Some(index) = viewer.near.selected {
        selected(viewer, index, ui);
    }
    ui.separator();
    let changed = sampling(&mut viewer.near, ui);
    viewer.light_changed |= changed;
    report(viewer, ui);
}

/// Adds, opens, takes away.
fn choose(viewer: &mut Viewer, ui: &mut egui::Ui) {
    ui.menu_button("Add…", |ui| {
        for (made, name) in Made::ALL {
            if ui.button(name).clicked() {
                viewer.near.add(new_lamp(viewer, made));
                viewer.light_changed = true;
                ui.close();
            }
        }
    });
    let file = ui.button("Open…");
    if file.on_hover_text("an emitters.json").clicked() {
        crate::files::pick(&viewer.jobs);
    }
    let there = !viewer.near.is_empty();
    let save = ui.add_enabled(there, egui::Button::new("Save…"));
    if save.on_hover_text("as an emitters.json").clicked() {
        crate::files::save_emitters(viewer);
    }
    let see = ui.add_enabled(there, egui::Button::new("See all"));
    if see
        .on_hover_text("step back until all lamps are in view")
        .clicked()
    {
        let scene = viewer.content.as_ref().map(Content::bounds);
        let balls: Vec<_> = scene.into_iter().chain(viewer.near.balls()).collect();
        viewer.navigation.see(&balls, viewer.look.aspect);
    }
    let lamps = ui.toggle_value(&mut viewer.near.shows_lamps, "lamps");
    viewer.light_changed |= lamps.on_hover_text("in the picture").changed();
    let remove = ui.add_enabled(viewer.near.selected.is_some(), egui::Button::new("Remove"));
    if remove.on_hover_text("Delete").clicked() {
        remove_selected(viewer);
    }
}

/// Takes the selected lamp away.
pub fn remove_selected(viewer: &mut Viewer) {
    viewer.near.remove();
    viewer.light_changed = true;
}

/// Between the camera and the scene, above, facing its middle.
fn new_lamp(viewer: &Viewer, made: Made) -> Lamp {
    let (centre, radius) = viewer
        .content
        .as_ref()
        .map_or((DVec3::ZERO, 1.0), Content::bounds);
    let toward_eye = (viewer.navigation.camera.eye.as_dvec3() - centre).normalize_or(DVec3::Z);
    let turn = glam::DQuat::from_rotation_y(0.5 * viewer.near.lamps().len() as f64);
    let direction = (turn * toward_eye + 0.8 * DVec3::Y).normalize();
    made.lamp(0.5 * radius, centre + direction * (1.3 * radius), centre)
}

fn list(near: &mut Near, ui: &mut egui::Ui) {
    let rows = near.lamps().len();
    let height = ui.text_style_height(&egui::TextStyle::Body);
    let mut chosen = near.selected;
    egui::ScrollArea::vertical()
        .id_salt("lamps")
        .max_height(6.0 * (height + 6.0))
        .show_rows(ui, height, rows, |ui, range| {
            for i in range {
                let name = relume::files::printable(&near.lamps()[i].emitter.name);
                ui.selectable_value(&mut chosen, Some(i), name);
            }
        });
    near.selected = chosen;
}

/// The lamp that is edited.
fn selected(viewer: &mut Viewer, index: usize, ui: &mut egui::Ui) {
    ui.horizontal(|ui| {
        for (tool, name) in Tool::ALL {
            let choice = ui.selectable_value(&mut viewer.near.tool, tool, name);
            choice.on_hover_text("by its handles in the picture");
        }
    });
    let mut lamp = viewer.near.lamps()[index].clone();
    let centre = viewer.content.as_ref().map(|content| content.bounds().0);
    if edit(&mut lamp, centre, ui) {
        let outcome = viewer.near.edit(index, lamp);
        viewer
            .messages
            .standing("lamp", outcome.err().map(|error| error.to_string()));
        viewer.light_changed = true;
    }
}

/// Whether something was changed.
fn edit(lamp: &mut Lamp, centre: Option<DVec3>, ui: &mut egui::Ui) -> bool {
    let mut changed = false;
    egui::Grid::new("lamp").num_columns(2).show(ui, |ui| {
        ui.label("Colour");
        ui.horizontal(|ui| {
            changed |= ui.color_edit_button_rgb(&mut lamp.colour).changed();
            let strength = egui::Slider::new(&mut lamp.strength, 0.0..=1000.0).logarithmic(true);
            let strength = ui.add(strength.smallest_positive(0.01));
            changed |= strength
                .on_hover_text("radiance; 0 is black and only hides")
                .changed();
        });
        ui.end_row();
        ui.label("Place");
        ui.horizontal(|ui| {
            let place = &mut lamp.emitter.world_from_emitter.translation;
            for value in [&mut place.x, &mut place.y, &mut place.z] {
                changed |= ui
                    .add(egui::DragValue::new(value).speed(0.01).fixed_decimals(3))
                    .changed();
            }
        });
        ui.end_row();
        ui.label("Shines");
        ui.horizontal(|ui| {
            let both = ui.toggle_value(&mut lamp.emitter.two_sided, "both sides");
            changed |= both.changed();
            if let Some(centre) = centre.filter(|_| !lamp.is_sphere())
                && ui.button("at the scene").clicked()
            {
                lamp.face(centre);
                changed = true;
            }
        });
        ui.end_row();
        if !lamp.is_sphere() {
            ui.label("Focus");
            let exponent = egui::Slider::new(&mut lamp.emitter.exponent, 0..=8);
            let exponent = ui
                .add(exponent)
                .on_hover_text("power of the cosine to its normal");
            changed |= exponent.changed();
            ui.end_row();
        }
    });
    changed
}

/// How light is found; whether that was changed.
fn sampling(near: &mut Near, ui: &mut egui::Ui) -> bool {
    let mut changed = false;
    ui.horizontal_wrapped(|ui| {
        for (method, name, what) in Method::ALL {
            let choice = ui.selectable_value(&mut near.method, method, name);
            changed |= choice.on_hover_text(what).changed();
        }
    });
    let options = match near.method {
        Method::Exact | Method::Device => None,
        Method::FirstOrder => Some(&mut near.refine[0]),
        Method::Domains => Some(&mut near.refine[1]),
    };
    egui::Grid::new("sampling").num_columns(2).show(ui, |ui| {
        if let Some(options) = options {
            ui.label("ε");
            let epsilon = egui::Slider::new(&mut options.epsilon, 1e-6..=100.0).logarithmic(true);
            let epsilon = ui.add(epsilon.custom_formatter(|x, _| format!("{x:.1e}")));
            changed |= epsilon
                .on_hover_text("clusters whose error is below it are not cut")
                .changed();
            ui.end_row();
            ui.label("Budget");
            let budget = egui::Slider::new(&mut options.budget, 1..=8192).logarithmic(true);
            changed |= ui.add(budget).on_hover_text("the most samples").changed();
            ui.end_row();
            ui.label("Show");
            ui.horizontal(|ui| {
                ui.toggle_value(&mut near.shows_samples, "samples");
                ui.toggle_value(&mut near.shows_domains, "domains");
                let mut error = near.error.is_some();
                let shown = ui.toggle_value(&mut error, "error");
                if shown
                    .on_hover_text("warm: too bright, cold: too dark")
                    .changed()
                {
                    near.error = error.then_some(10.0);
                    changed = true;
                }
            });
            ui.end_row();
            if let Some(gain) = &mut near.error {
                ui.label("Error ×");
                let gain = egui::Slider::new(gain, 1.0..=1000.0).logarithmic(true);
                changed |= ui.add(gain).changed();
                ui.end_row();
            }
        }
        changed |= bounces(&mut near.bounces, ui);
        ui.end_row();
    });
    changed
}

/// How often light bounces on; whether that was changed.
fn bounces(count: &mut u32, ui: &mut egui::Ui) -> bool {
    ui.label("Bounces");
    let bounces = ui.add(egui::Slider::new(count, 0..=8));
    let what = "of all light, where the scene was baked with --bounces 0 (diffuse ones with --gather); else of near light";
    bounces.on_hover_text(what).changed()
}

fn report(viewer: &Viewer, ui: &mut egui::Ui) {
    let report = &viewer.report;
    if report.on_device {
        ui.weak("at every vertex, with the relight pass");
        return;
    }
    let from = match report.domains.len() {
        0 => "at every vertex".to_owned(),
        count => format!("{count} samples"),
    };
    let error = report
        .rmse
        .map_or(String::new(), |rmse| format!(", RMSE {rmse:.2e}"));
    ui.weak(format!("{from}, {:.2} ms{error}", report.seconds * 1e3));
    #[cfg(not(target_arch = "wasm32"))]
    if viewer.bouncing.is_busy() {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.weak("bounces on glossy surfaces");
        });
    }
}
