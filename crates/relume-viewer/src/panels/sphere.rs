//! The light, as a ball shows it: what a mirror of its directions would see, or a white ball lit by it.

use eframe::egui;
use glam::DVec3;
use relume::basis::Order;
use relume::basis::sh::Evaluator;
use relume::display::ToneMap;
use relume::light::ShLight;

use crate::app::Viewer;

/// Pixels of the picture's side.
const SIDE: usize = 72;

/// The picture of a ball, and what it was made of.
pub struct Ball {
    light: ShLight,
    exposure: f32,
    forward: DVec3,
    texture: egui::TextureHandle,
}

/// The radiance that comes from where each point of the ball faces, seen by the camera.
pub fn show(viewer: &mut Viewer, ui: &mut egui::Ui) {
    let (Some(lighting), Ok(frame)) = (&viewer.lighting, viewer.navigation.camera.frame()) else {
        return;
    };
    let light = lighting.incident().0;
    let exposure = viewer.look.exposure;
    let ball = &mut viewer.open.ball;
    let fresh = ball.as_ref().is_some_and(|ball| {
        ball.light == light && ball.exposure == exposure && ball.forward == frame.forward
    });
    if !fresh {
        let axes = [frame.right, frame.up, -frame.forward];
        let image = picture(&light, axes, exposure);
        let options = egui::TextureOptions::LINEAR;
        *ball = Some(Ball {
            texture: ui.ctx().load_texture("ball", image, options),
            forward: frame.forward,
            light,
            exposure,
        });
    }
    if let Some(ball) = ball {
        let size = egui::vec2(SIDE as f32, SIDE as f32) * 2.0;
        ui.add(egui::Image::new((ball.texture.id(), size)));
    }
}

fn picture(light: &ShLight, axes: [DVec3; 3], exposure: f32) -> egui::ColorImage {
    let tone = ToneMap { exposure };
    let evaluator = Evaluator::new(light.order());
    let mut values = vec![0.0; Order::count(light.order())];
    let mut pixels = Vec::with_capacity(SIDE * SIDE);
    for y in 0..SIDE {
        for x in 0..SIDE {
            let at = |i: usize| (i as f64 + 0.5) / SIDE as f64 * 2.0 - 1.0;
            let (right, up) = (at(x), -at(y));
            let rim = 1.0 - right * right - up * up;
            if rim < 0.0 {
                pixels.push(egui::Color32::TRANSPARENT);
                continue;
            }
            let direction = axes[0] * right + axes[1] * up + axes[2] * rim.sqrt();
            evaluator.eval(direction, &mut values);
            let mut radiance = [0.0_f64; 3];
            for (rgb, value) in light.coefficients().iter().zip(&values) {
                for (sum, c) in radiance.iter_mut().zip(rgb) {
                    *sum += f64::from(*c) * value;
                }
            }
            let [r, g, b] = tone.encode(radiance.map(|x| x as f32));
            pixels.push(egui::Color32::from_rgb(r, g, b));
        }
    }
    egui::ColorImage::new([SIDE, SIDE], pixels)
}
