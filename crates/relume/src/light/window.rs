//! The choice of a window by name.

use std::fmt;
use std::str::FromStr;

use crate::basis::{Order, Window};

use super::error::SpecError;

/// What to do against ringing, by the names of the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WindowChoice {
    /// `none`: the coefficients as they are.
    #[default]
    None,
    /// `hann`: the Hann window whose cutoff is the order.
    Hann,
    /// `auto`: the weakest Hann window after which no radiance is negative; none if none is needed.
    Auto,
}

impl WindowChoice {
    /// The window for a light of this order.
    pub fn window(self, order: Order) -> Window {
        match self {
            Self::None => Window::None,
            Self::Hann => Window::Hann(order.get() as f64),
            Self::Auto => Window::Auto,
        }
    }
}

impl fmt::Display for WindowChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::Hann => "hann",
            Self::Auto => "auto",
        })
    }
}

impl FromStr for WindowChoice {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        [Self::None, Self::Hann, Self::Auto]
            .into_iter()
            .find(|choice| choice.to_string() == text)
            .ok_or_else(|| SpecError::Form {
                text: text.to_owned(),
                form: "none, hann or auto",
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_go_both_ways() {
        for name in ["none", "hann", "auto"] {
            assert_eq!(name.parse::<WindowChoice>().unwrap().to_string(), name);
        }
        assert!("lanczos".parse::<WindowChoice>().is_err());
    }
}
