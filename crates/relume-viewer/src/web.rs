//! The page's side: what JavaScript calls, and what only a browser can do.

use std::cell::RefCell;

use eframe::egui;
use eframe::wasm_bindgen::{self, JsCast, JsValue, prelude::wasm_bindgen};
use relume::files::printable;
use serde_json::json;
use wasm_bindgen_futures::{JsFuture, spawn_local};

use crate::app::Viewer;
use crate::jobs::{Event, Teller};
use crate::source::{MAX_BYTES, Source};
use crate::start::{NO_LIGHT, Start};

thread_local! {
    /// What [`state`] tells, as of the last frame.
    static STATE: RefCell<String> = const { RefCell::new(String::new()) };
    /// Names of the gallery's scenes, and what each is.
    static GALLERY: RefCell<Vec<(String, String)>> = const { RefCell::new(Vec::new()) };
}

/// Starts the viewer on the canvas with this id, with what the page's address asks for.
///
/// Fails where there is no such canvas or no graphics device.
#[wasm_bindgen]
pub async fn start(canvas: &str) -> Result<(), JsValue> {
    console_error_panic_hook::set_once();
    // A second logger is no reason to stop.
    let _ = console_log::init_with_level(log::Level::Warn);
    let window = web_sys::window().ok_or("there is no window")?;
    let document = window.document().ok_or("there is no document")?;
    let element = document.get_element_by_id(canvas);
    let element = element.ok_or("the page has no such canvas")?;
    let canvas: web_sys::HtmlCanvasElement = element.dyn_into()?;
    let address = Address::read(&window)?;
    read_gallery().await;
    let options = eframe::WebOptions {
        wgpu_options: crate::graphics(),
        ..eframe::WebOptions::default()
    };
    eframe::WebRunner::new()
        .start(
            canvas,
            options,
            Box::new(|context| {
                let (start, files) = address.split();
                let viewer = Viewer::new(context, start)?;
                files
                    .into_iter()
                    .for_each(|file| fetch(viewer.jobs.teller(), file));
                Ok(Box::new(viewer))
            }),
        )
        .await
}

/// What is shown, as JSON: for scripts of the page, and for its tests.
#[wasm_bindgen]
pub fn state() -> String {
    STATE.with_borrow(Clone::clone)
}

/// Keeps what [`state`] tells.
pub fn publish(viewer: &Viewer) {
    let backend = match viewer.stage.adapter().backend {
        wgpu::Backend::BrowserWebGpu => "webgpu",
        _ => "webgl2",
    };
    let (width, height) = viewer.stage.size();
    let messages: Vec<&str> = viewer
        .messages
        .shown
        .iter()
        .map(|m| m.text.as_str())
        .collect();
    let state = json!({
        "backend": backend,
        "scene": viewer.content.as_ref().map(|content| &content.name),
        "vertices": viewer.content.as_ref().map_or(0, |c| c.asset.transfer.vertex_count()),
        "lamps": viewer.near.lamps().len(),
        "light": viewer.lighting.as_ref().map(|lighting| &lighting.name),
        "frames": viewer.frames.drawn,
        "relights": viewer.frames.relights,
        "exposure": viewer.look.exposure,
        "size": [width, height],
        "messages": messages,
        "memory_pages": core::arch::wasm32::memory_size::<0>(),
    });
    STATE.set(state.to_string());
}

/// What the page's address asks for.
struct Address {
    start: Start,
    /// Files beside the page.
    files: Vec<String>,
}

impl Address {
    /// `?asset=PATH&light=ENV&emitters=PATH&turn=DEGREES&exposure=STOPS&background=0&panel=0`.
    fn read(window: &web_sys::Window) -> Result<Self, JsValue> {
        let query = web_sys::UrlSearchParams::new_with_str(&window.location().search()?)?;
        let number = |name: &str| query.get(name).and_then(|text| text.parse::<f64>().ok());
        let is_on = |name: &str| query.get(name).is_none_or(|text| text != "0");
        let mut files: Vec<String> = query.get("asset").into_iter().collect();
        let made = |light: &String| {
            ["sky:", "sun:", "constant:"]
                .iter()
                .any(|kind| light.starts_with(kind))
        };
        let light = query.get("light");
        files.extend(light.iter().filter(|light| !made(light)).cloned());
        let lamps = query.has("emitters") && !query.has("light");
        files.extend(query.get("emitters"));
        Ok(Self {
            start: Start {
                light: light
                    .filter(made)
                    .or_else(|| lamps.then(|| NO_LIGHT.to_owned())),
                turn: number("turn")
                    .filter(|turn| turn.is_finite())
                    .unwrap_or(0.0),
                exposure: number("exposure").map(|stops| stops.clamp(-64.0, 64.0) as f32),
                background: is_on("background"),
                panels: is_on("panel"),
                files: Vec::new(),
            },
            files,
        })
    }

    fn split(self) -> (Start, Vec<String>) {
        (self.start, self.files)
    }
}

/// Opens a file of the page's own origin.
pub fn fetch(teller: Teller, path: String) {
    spawn_local(async move {
        let event = match fetched(&path).await {
            Ok(bytes) => {
                let name = path.rsplit('/').next().unwrap_or(&path).to_owned();
                return teller.read(&Source::Bytes { name, bytes });
            }
            Err(why) => Event::Failed(format!("{}: {why}", printable(&path))),
        };
        teller.tell(event);
    });
}

/// The bytes of a file of the page's own origin.
async fn fetched(path: &str) -> Result<Vec<u8>, String> {
    let said = |error: JsValue| {
        let text = error
            .dyn_ref::<js_sys::Error>()
            .map(|e| String::from(e.message()));
        printable(&text.unwrap_or_else(|| "the browser refused".to_owned()))
    };
    let window = web_sys::window().ok_or("there is no window")?;
    let base = window.location().href().map_err(said)?;
    let url = web_sys::Url::new_with_base(path, &base).map_err(|_| "is no address")?;
    if Ok(url.origin()) != window.location().origin() {
        return Err(
            "lies on another host; put it beside the page, or drop the file here".to_owned(),
        );
    }
    let response = JsFuture::from(window.fetch_with_str(&url.href()))
        .await
        .map_err(said)?;
    let response: web_sys::Response = response.dyn_into().map_err(said)?;
    if !response.ok() {
        return Err(format!("the server answers {}", response.status()));
    }
    let length = response.headers().get("content-length").ok().flatten();
    let length = length.and_then(|length| length.parse::<f64>().ok());
    if length.is_some_and(|length| length > MAX_BYTES as f64) {
        return Err(format!("larger than {} MB", MAX_BYTES >> 20));
    }
    let buffer = response.array_buffer().map_err(said)?;
    let buffer = JsFuture::from(buffer).await.map_err(said)?;
    let bytes = js_sys::Uint8Array::new(&buffer);
    if bytes.length() as usize > MAX_BYTES {
        return Err(format!("larger than {} MB", MAX_BYTES >> 20));
    }
    Ok(bytes.to_vec())
}

/// The gallery beside the page, where there is one.
async fn read_gallery() {
    let Ok(bytes) = fetched("gallery/index.json").await else {
        return;
    };
    let scenes: serde_json::Value = serde_json::from_slice(&bytes).unwrap_or_default();
    let text = |scene: &serde_json::Value, key: &str| scene[key].as_str().map(str::to_owned);
    let scenes = scenes.as_array().into_iter().flatten();
    let known = scenes.filter_map(|scene| Some((text(scene, "name")?, text(scene, "what")?)));
    GALLERY.set(known.collect());
}

/// Names of the gallery's scenes, and what each is.
pub fn gallery() -> Vec<(String, String)> {
    GALLERY.with_borrow(Clone::clone)
}

/// Opens a file that was dropped on the page.
pub fn read_dropped(teller: Teller, file: &egui::DroppedFileHandle) {
    if let Some(web) = file.web_file() {
        read_file(teller, web.clone());
    }
}

/// Opens a file that the browser has handed over.
fn read_file(teller: Teller, file: web_sys::File) {
    spawn_local(async move {
        let name = file.name();
        let shown = printable(&name);
        if file.size() > MAX_BYTES as f64 {
            let source = Source::Bytes {
                name,
                bytes: Vec::new(),
            };
            return teller.tell(Event::Failed(source.too_large()));
        }
        match JsFuture::from(file.array_buffer()).await {
            Ok(buffer) => {
                let bytes = js_sys::Uint8Array::new(&buffer).to_vec();
                teller.read(&Source::Bytes { name, bytes });
            }
            Err(_) => teller.tell(Event::Failed(format!(
                "{shown}: the browser cannot read it"
            ))),
        }
    });
}

/// Asks for a file and opens it.
pub fn pick(teller: Teller) {
    let Some(input) = element("input").and_then(|e| e.dyn_into::<web_sys::HtmlInputElement>().ok())
    else {
        return;
    };
    input.set_type("file");
    let chosen = input.clone();
    let changed = wasm_bindgen::closure::Closure::once_into_js(move || {
        if let Some(file) = chosen.files().and_then(|files| files.get(0)) {
            read_file(teller, file);
        }
    });
    input.set_onchange(Some(changed.unchecked_ref()));
    input.click();
}

/// Hands a file to the person.
pub fn download(name: &str, bytes: &[u8]) -> Result<(), String> {
    let failed = |_: JsValue| "the browser did not take the file".to_owned();
    let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(bytes));
    let blob = web_sys::Blob::new_with_u8_array_sequence(&parts).map_err(failed)?;
    let url = web_sys::Url::create_object_url_with_blob(&blob).map_err(failed)?;
    let link = element("a").and_then(|e| e.dyn_into::<web_sys::HtmlAnchorElement>().ok());
    if let Some(link) = link {
        link.set_href(&url);
        link.set_download(name);
        link.click();
    }
    web_sys::Url::revoke_object_url(&url).map_err(failed)
}

fn element(tag: &str) -> Option<web_sys::Element> {
    web_sys::window()?.document()?.create_element(tag).ok()
}
