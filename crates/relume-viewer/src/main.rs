//! The native window: `relume view FILE` starts it.

#[cfg(not(target_arch = "wasm32"))]
mod native;

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    native::run()
}

/// The web page calls the library.
#[cfg(target_arch = "wasm32")]
fn main() {}
