//! How long frames take.

use eframe::egui;

use crate::app::Viewer;
use crate::frames::Frame;

/// The graph's full height, seconds: two frames at 60 Hz.
const FULL: f32 = 2.0 / 60.0;

const CPU: egui::Color32 = egui::Color32::from_rgb(120, 170, 255);
const RELIGHT: egui::Color32 = egui::Color32::from_rgb(255, 190, 90);
const VIEW: egui::Color32 = egui::Color32::from_rgb(120, 220, 140);

/// The graph, and the sums below it.
pub fn show(viewer: &mut Viewer, ui: &mut egui::Ui) {
    let adapter = viewer.stage.adapter();
    ui.weak(format!(
        "{} ({})",
        relume::files::printable(&adapter.name),
        adapter.backend
    ));
    graph(viewer, ui);
    let frames = &viewer.frames;
    let mut line = |name: &str, color, times: Option<(f32, f32)>| {
        if let Some((mean, high)) = times {
            let text = format!(
                "{name}: {:.2} ms, 99 % below {:.2} ms",
                mean * 1e3,
                high * 1e3
            );
            ui.colored_label(color, text);
        }
    };
    line("CPU", CPU, frames.summary(|f| Some(f.cpu)));
    line("relight", RELIGHT, frames.summary(|f| f.gpu.relight));
    line("view", VIEW, frames.summary(|f| f.gpu.view));
    if !viewer.stage.is_timed() {
        ui.weak("this device does not tell the time of its passes");
    }
}

fn graph(viewer: &Viewer, ui: &mut egui::Ui) {
    let size = egui::vec2(ui.available_width().min(360.0), 56.0);
    let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, egui::Color32::from_gray(20));
    let count = viewer.frames.iter().len().max(2);
    let curve = |color, of: &dyn Fn(&Frame) -> Option<f32>| {
        let points = viewer.frames.iter().enumerate().filter_map(|(i, frame)| {
            let x = rect.left() + rect.width() * i as f32 / (count - 1) as f32;
            let part = (of(frame)? / FULL).min(1.0);
            Some(egui::pos2(x, rect.bottom() - rect.height() * part))
        });
        painter.add(egui::Shape::line(
            points.collect(),
            egui::Stroke::new(1.0, color),
        ));
    };
    curve(egui::Color32::from_gray(60), &|_| Some(FULL / 2.0));
    curve(CPU, &|frame| Some(frame.cpu));
    curve(RELIGHT, &|frame| frame.gpu.relight);
    curve(VIEW, &|frame| frame.gpu.view);
}
