//! The choice of a window by name.

use std::fmt;
use std::str::FromStr;

use crate::basis::{Order, Window, WindowError};

/// What to do against ringing, by the names of the command line: those of [`Window`], and `hann` alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WindowChoice {
    /// `hann`: the Hann window whose cutoff is the order of the light.
    Hann,
    /// This one, whatever the order.
    Window(Window),
}

impl WindowChoice {
    /// The window for a light of this order.
    pub fn window(self, order: Order) -> Window {
        match self {
            Self::Hann => Window::Hann(order.get() as f64),
            Self::Window(window) => window,
        }
    }
}

impl Default for WindowChoice {
    fn default() -> Self {
        Self::Window(Window::None)
    }
}

impl fmt::Display for WindowChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hann => f.write_str("hann"),
            Self::Window(window) => window.fmt(f),
        }
    }
}

impl FromStr for WindowChoice {
    type Err = WindowError;

    fn from_str(text: &str) -> Result<Self, WindowError> {
        match text {
            "hann" => Ok(Self::Hann),
            _ => text.parse().map(Self::Window),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_go_both_ways() {
        for name in ["none", "hann", "auto", "hann:4.5", "gauss:0.25"] {
            assert_eq!(name.parse::<WindowChoice>().unwrap().to_string(), name);
        }
        assert!("lanczos".parse::<WindowChoice>().is_err());
        assert_eq!("none".parse(), Ok(WindowChoice::default()));
        let order = Order::new(7).unwrap();
        assert_eq!(WindowChoice::Hann.window(order), Window::Hann(7.0));
    }
}
