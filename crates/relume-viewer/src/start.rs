//! What the viewer starts with.

use crate::source::Source;

/// How the viewer starts.
#[derive(Clone, Debug)]
pub struct Start {
    /// What to open, besides what is dropped later.
    pub files: Vec<Source>,
    /// A light as on the command line.
    pub light: Option<String>,
    /// Lights that stand near, as on the command line.
    #[cfg(not(target_arch = "wasm32"))]
    pub emitters: Option<std::path::PathBuf>,
    /// The light's first turn about the vertical, degrees.
    pub turn: f64,
    /// In stops; `None` for the exposure that suits the scene.
    pub exposure: Option<f32>,
    /// Whether the environment stands behind the scene.
    pub background: bool,
    /// Whether the panels are shown.
    pub panels: bool,
    /// Writes the first picture to this file and ends.
    #[cfg(not(target_arch = "wasm32"))]
    pub screenshot: Option<std::path::PathBuf>,
}

impl Default for Start {
    fn default() -> Self {
        Self {
            files: Vec::new(),
            light: None,
            #[cfg(not(target_arch = "wasm32"))]
            emitters: None,
            turn: 0.0,
            exposure: None,
            background: true,
            panels: true,
            #[cfg(not(target_arch = "wasm32"))]
            screenshot: None,
        }
    }
}

/// The light until one is chosen.
pub(crate) const FIRST_LIGHT: &str = "sky:30,3";

/// Distant light where lamps shine alone.
pub const NO_LIGHT: &str = "constant:0,0,0";
