//! The page's side: what JavaScript calls.

use eframe::wasm_bindgen::{self, prelude::*};

/// Starts the viewer on the canvas with this id.
#[wasm_bindgen]
pub async fn start(canvas: &str) -> Result<(), JsValue> {
    console_error_panic_hook::set_once();
    let window = web_sys::window().ok_or("no window")?;
    let document = window.document().ok_or("no document")?;
    let element = document.get_element_by_id(canvas).ok_or("no canvas")?;
    let canvas: web_sys::HtmlCanvasElement = element.dyn_into()?;
    let options = eframe::WebOptions::default();
    eframe::WebRunner::new()
        .start(canvas, options, Box::new(|_| Ok(Box::new(Empty))))
        .await
}

struct Empty;

impl eframe::App for Empty {
    fn ui(&mut self, ui: &mut eframe::egui::Ui, _: &mut eframe::Frame) {
        ui.heading("Relume");
    }
}
