//! The light: which, how it is turned, and how much of it.

use eframe::egui;
use glam::DVec3;

use super::sphere;
use crate::app::Viewer;
use crate::files;
use crate::lighting::{Against, Lighting};

/// Lights that need no file.
const MADE: [(&str, &str); 5] = [
    ("Afternoon", "sky:30,3"),
    ("Low sun", "sky:8,5"),
    ("Noon", "sky:70,2.5"),
    ("Soft sun", "sun:1,1,1,30,22,20,18"),
    ("Even white", "constant:1,1,1"),
];

/// Everything about the light.
pub fn show(viewer: &mut Viewer, ui: &mut egui::Ui) {
    ui.horizontal_wrapped(|ui| choose(viewer, ui));
    let order = viewer
        .content
        .as_ref()
        .map_or(1, |content| content.asset.transfer.order.get());
    let Some(lighting) = &mut viewer.lighting else {
        return;
    };
    ui.weak(relume::files::printable(&lighting.name));
    let mut changed = false;
    egui::Grid::new("light").num_columns(2).show(ui, |ui| {
        ui.label("Turn");
        ui.horizontal(|ui| changed |= turn(lighting, ui));
        ui.end_row();
        ui.label("Bands");
        let bands = ui.add(egui::Slider::new(&mut lighting.order, 1..=order));
        changed |= bands
            .on_hover_text("order: degrees below this shine")
            .changed();
        ui.end_row();
        ui.label("Window");
        ui.horizontal(|ui| {
            for (choice, name) in Against::ALL {
                let chosen = ui.selectable_value(&mut lighting.window, choice, name);
                changed |= chosen.on_hover_text("against ringing").changed();
            }
        });
        ui.end_row();
        ui.label("Coefficient");
        ui.horizontal(|ui| changed |= coefficient(&mut lighting.coefficient, order, ui));
        ui.end_row();
    });
    viewer.light_changed |= changed;
    if viewer.open.sphere {
        sphere::show(viewer, ui);
    }
}

/// Where the light comes from.
fn choose(viewer: &mut Viewer, ui: &mut egui::Ui) {
    let map = ui.button("Map…");
    if map
        .on_hover_text(".hdr, .exr, .dds, .pfm, .png, light.json")
        .clicked()
    {
        files::pick(&viewer.jobs);
    }
    ui.menu_button("Made…", |ui| {
        for (name, spec) in MADE {
            if ui.button(name).on_hover_text(spec).clicked() {
                viewer.jobs.run(move |teller| teller.make_light(spec));
                ui.close();
            }
        }
    });
    let ball = ui.toggle_value(&mut viewer.open.sphere, "Ball");
    ball.on_hover_text("the light, as a ball shows it");
}

/// Turns about the vertical; whether there was one.
fn turn(lighting: &mut Lighting, ui: &mut egui::Ui) -> bool {
    let mut turned = false;
    for (text, degrees) in [("−15°", -15.0_f64), ("+15°", 15.0)] {
        let button = ui.button(text);
        if button
            .on_hover_text("about the vertical; or drag with Shift")
            .clicked()
        {
            lighting.rotate(DVec3::Y, degrees.to_radians());
            turned = true;
        }
    }
    if ui.button("Reset").clicked() {
        lighting.unturn();
        turned = true;
    }
    turned
}

/// One coefficient of the transfer instead of the light.
fn coefficient(shown: &mut Option<usize>, order: usize, ui: &mut egui::Ui) -> bool {
    let mut single = shown.is_some();
    let check = ui.checkbox(&mut single, "");
    let check =
        check.on_hover_text("one coefficient of the transfer: warm positive, cold negative");
    let mut changed = check.changed();
    if changed {
        *shown = single.then_some(0);
    }
    if let Some(i) = shown {
        let slider = ui.add(egui::Slider::new(i, 0..=order * order - 1));
        changed |= slider.changed();
    }
    changed
}
