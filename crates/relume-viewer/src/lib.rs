//! Looks at baked scenes in live light: one application for a native window and for a web page.
//!
//! ```text
//! Source ──jobs──▶ Content ┐
//! EnvSpec ─jobs──▶ Lighting ┼─ relight ──▶ Stage (relume-gpu) ──▶ picture ─┐
//! Emitters ─jobs─▶ Near     ┤                                              │
//! pointer, keys ─▶ Navigation ┘                         panels ────────┴──▶ window or canvas
//! ```
#![cfg_attr(
    test,
    allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")
)]

mod app;
#[cfg(not(target_arch = "wasm32"))]
mod baking;
mod content;
mod exposure;
mod files;
mod frames;
mod gallery;
mod gizmo;
mod jobs;
mod lighting;
mod messages;
mod navigation;
mod near;
mod panels;
mod projection;
mod relight;
mod screenshot;
mod source;
mod stage;
mod start;
mod timer;
#[cfg(target_arch = "wasm32")]
mod web;

pub use app::Viewer;
pub use source::Source;
pub use start::{NO_LIGHT, Start};

use std::sync::Arc;

/// How the graphics device is asked for: all that the adapter allows of what scenes need, and timestamps where there are any.
pub fn graphics() -> eframe::egui_wgpu::WgpuConfiguration {
    let mut setup = eframe::egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.device_descriptor = Arc::new(|adapter| {
        let allowed = adapter.limits();
        let base = if adapter.get_info().backend == wgpu::Backend::Gl {
            wgpu::Limits::downlevel_webgl2_defaults()
        } else {
            wgpu::Limits::default()
        };
        wgpu::DeviceDescriptor {
            label: Some("relume"),
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: wgpu::Limits {
                max_texture_dimension_2d: allowed.max_texture_dimension_2d,
                max_texture_array_layers: allowed.max_texture_array_layers,
                max_buffer_size: allowed.max_buffer_size,
                ..base.using_alignment(allowed)
            },
            ..wgpu::DeviceDescriptor::default()
        }
    });
    eframe::egui_wgpu::WgpuConfiguration {
        wgpu_setup: setup.into(),
        ..eframe::egui_wgpu::WgpuConfiguration::default()
    }
}
