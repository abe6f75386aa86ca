//! Looks at baked scenes in live light: one application for a native window and for a web page.

#[cfg(target_arch = "wasm32")]
mod web;
