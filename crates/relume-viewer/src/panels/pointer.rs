//! What pointer, fingers and keys do to the picture.

use eframe::egui::{self, Key};
use glam::DVec3;

use super::view;
use crate::app::Viewer;
use crate::content::Paths;
use crate::navigation::Mode;
use crate::near::Tool;

/// Radians that the light turns when it is dragged across the picture's height.
const LIGHT_SPEED: f64 = 4.0;

/// Moves camera and light by what was done over the picture, and by keys that nobody else wants.
/// The camera `stays` while a lamp is dragged.
pub fn handle(viewer: &mut Viewer, ui: &egui::Ui, response: &egui::Response, stays: bool) {
    if !stays {
        drag(viewer, ui, response);
    }
    if response.hovered() {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = (scroll * 0.002).exp() * pinch;
        if factor != 1.0 {
            viewer.navigation.zoom(factor);
        }
    }
    if !ui.ctx().egui_wants_keyboard_input() {
        held(viewer, ui);
        pressed(viewer, ui);
    }
}

fn drag(viewer: &mut Viewer, ui: &egui::Ui, response: &egui::Response) {
    let height = response.rect.height().max(1.0);
    if let Some(touch) = ui.ctx().multi_touch() {
        let moved = touch.translation_delta / height;
        viewer.navigation.pan(moved.x, moved.y);
        return;
    }
    let moved = response.drag_delta() / height;
    if moved == egui::Vec2::ZERO {
        return;
    }
    let shift = ui.input(|input| input.modifiers.shift);
    if response.dragged_by(egui::PointerButton::Primary) && shift {
        turn_light(viewer, moved.x, moved.y);
    } else if response.dragged_by(egui::PointerButton::Primary) {
        viewer.navigation.drag(moved.x, moved.y);
    } else {
        viewer.navigation.pan(moved.x, moved.y);
    }
}

/// As if the sky were dragged.
fn turn_light(viewer: &mut Viewer, right: f32, down: f32) {
    let (Some(lighting), Ok(frame)) = (&mut viewer.lighting, viewer.navigation.camera.frame())
    else {
        return;
    };
    lighting.rotate(DVec3::Y, f64::from(right) * LIGHT_SPEED);
    lighting.rotate(frame.right, f64::from(down) * LIGHT_SPEED);
    viewer.light_changed = true;
}

/// Keys that act as long as they are down.
fn held(viewer: &mut Viewer, ui: &egui::Ui) {
    let (down, shift, seconds) = ui.input(|input| {
        let along =
            |less, more| f32::from(i8::from(input.key_down(more)) - i8::from(input.key_down(less)));
        let keys = [
            along(Key::ArrowLeft, Key::ArrowRight),
            along(Key::ArrowUp, Key::ArrowDown),
            along(Key::A, Key::D),
            along(Key::Q, Key::E),
            along(Key::S, Key::W),
            along(Key::Minus, Key::Plus) + along(Key::Minus, Key::Equals),
        ];
        (keys, input.modifiers.shift, input.stable_dt.min(0.1))
    });
    if down == [0.0; 6] {
        return;
    }
    let [x, y, right, up, forward, closer] = down.map(|key| key * seconds);
    if shift {
        turn_light(viewer, 0.4 * x, 0.4 * y);
    } else {
        viewer.navigation.drag(0.5 * x, 0.5 * y);
    }
    if [right, up, forward] != [0.0; 3] {
        viewer.navigation.fly(0.5 * right, 0.5 * up, 0.5 * forward);
    }
    viewer.navigation.zoom((1.5 * closer).exp());
    ui.ctx().request_repaint();
}

/// Keys that act once.
fn pressed(viewer: &mut Viewer, ui: &egui::Ui) {
    let keys: Vec<Key> = ui.input(|input| {
        let pressed = input.events.iter().filter_map(|event| match event {
            egui::Event::Key {
                key,
                pressed: true,
                modifiers,
                ..
            } if !modifiers.command => Some(*key),
            _ => None,
        });
        pressed.collect()
    });
    for key in keys {
        act(viewer, key);
    }
}

fn act(viewer: &mut Viewer, key: Key) {
    let look = &mut viewer.look;
    match key {
        Key::F1 => viewer.open.help = !viewer.open.help,
        Key::F2 => viewer.open.panels = !viewer.open.panels,
        Key::B => look.background = !look.background,
        Key::L => look.wireframe = !look.wireframe,
        Key::R => viewer.navigation.reset(),
        Key::F => {
            viewer.navigation.mode = match viewer.navigation.mode {
                Mode::Orbit => Mode::Fly,
                Mode::Fly => Mode::Orbit,
            }
        }
        Key::G => viewer.near.tool = Tool::Move,
        Key::T => viewer.near.tool = Tool::Turn,
        Key::X => viewer.near.tool = Tool::Scale,
        Key::Delete => super::near::remove_selected(viewer),
        Key::O => crate::files::pick(&viewer.jobs),
        Key::Comma => look.exposure -= 0.25,
        Key::Period => look.exposure += 0.25,
        Key::Num1 => view::choose(viewer, Paths::Unshadowed),
        Key::Num2 => view::choose(viewer, Paths::Shadowed),
        Key::Num3 => view::choose(viewer, Paths::Baked),
        Key::OpenBracket => bands(viewer, -1),
        Key::CloseBracket => bands(viewer, 1),
        _ => (),
    }
}

fn bands(viewer: &mut Viewer, more: isize) {
    let most = viewer
        .content
        .as_ref()
        .map_or(1, |c| c.asset.transfer.order.get());
    if let Some(lighting) = &mut viewer.lighting {
        lighting.order = lighting.order.saturating_add_signed(more).clamp(1, most);
        viewer.light_changed = true;
    }
}
