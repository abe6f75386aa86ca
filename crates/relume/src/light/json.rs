//! The file light.json: coefficients with a header that says what they are.

use std::fmt::Write;

use serde_json::{Map, Value};
use thiserror::Error;

use crate::basis::{Convention, Order, Window, WindowError};
use crate::files::printable;

use super::incident::ShLight;
use super::limits::MAX_RADIANCE;
use super::window::WindowChoice;

/// The longest text that is read; order 32 takes a hundredth of it.
const MAX_BYTES: usize = 1 << 23;

/// The largest coefficient: √4π of the largest radiance, and room for what turning adds.
const MAX_COEFFICIENT: f32 = 100.0 * MAX_RADIANCE;

/// A light and what its file says of it.
#[derive(Clone, Debug, PartialEq)]
pub struct LightFile {
    /// The coefficients, in our convention.
    pub light: ShLight,
    /// The window that was applied to them: never `auto`, but what became of it.
    pub window: Window,
}

/// A light.json that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum LightJsonError {
    /// Not JSON at all.
    #[error("not valid JSON (which knows no NaN or Infinity): {0}")]
    Syntax(String),
    /// Longer than any light.
    #[error("{0} bytes of JSON are no light; the highest order takes less than 100 kB")]
    TooLong(usize),
    /// A field of the header is missing.
    #[error("\"{field}\" is missing; it must be {accepted}")]
    Missing {
        /// Which.
        field: &'static str,
        /// What it may be.
        accepted: String,
    },
    /// A field of the header has a value that is not read.
    #[error("\"{field}\" is {found}; it must be {accepted}")]
    Field {
        /// Which.
        field: &'static str,
        /// What it is, printable.
        found: String,
        /// What it may be.
        accepted: String,
    },
    /// A coefficient is not three finite numbers.
    #[error(
        "coefficient {index} (counted from 0) is not [r, g, b], three finite numbers of at most {MAX_COEFFICIENT:e}; write it again"
    )]
    Coefficient {
        /// Which.
        index: usize,
    },
    /// The number of coefficients does not fit the order.
    #[error("order {order} has {expected} coefficients, but the file has {found}; write it again")]
    Count {
        /// The order in the header.
        order: usize,
        /// Its square.
        expected: usize,
        /// How many there are.
        found: usize,
    },
}

impl LightFile {
    /// `light` with a window applied.
    pub fn windowed(light: &ShLight, window: WindowChoice) -> Result<Self, WindowError> {
        let window = window.window(light.order());
        let windowed = window.apply(light.coefficients())?;
        Ok(Self {
            light: ShLight::new(light.order(), windowed.coefficients),
            window: windowed.window,
        })
    }

    /// The text of the file. Numbers read back to the same f32, and the text is the same on every machine.
    pub fn to_json(&self) -> String {
        let text = |value: &str| Value::from(value).to_string();
        let mut out = String::from("{\n");
        let header = [
            ("basis", text("sh")),
            ("order", self.light.order().to_string()),
            ("convention", text(&Convention::RealNoCs.to_string())),
            ("quantity", text("radiance")),
            ("colour", text("linear-rec709")),
            ("window", text(&self.window.to_string())),
        ];
        for (field, value) in header {
            let _ = writeln!(out, "  \"{field}\": {value},");
        }
        out.push_str("  \"coefficients\": [\n");
        let rows: Vec<String> = self
            .light
            .coefficients()
            .iter()
            .map(|rgb| {
                // Debug writes the shortest digits that read back to the same f32, and they are JSON.
                let [r, g, b] = rgb;
                format!("    [{r:?}, {g:?}, {b:?}]")
            })
            .collect();
        out.push_str(&rows.join(",\n"));
        out.push_str("\n  ]\n}\n");
        out
    }

    /// Reads the text of a light.json, in any convention that is known. Fields it does not know are passed over.
    pub fn from_json(text: &[u8]) -> Result<Self, LightJsonError> {
        if text.len() > MAX_BYTES {
            return Err(LightJsonError::TooLong(text.len()));
        }
        let value: Value = serde_json::from_slice(text)
            .map_err(|error| LightJsonError::Syntax(printable(&error.to_string())))?;
        let Value::Object(file) = value else {
            return Err(LightJsonError::Syntax("it is not an object".to_owned()));
        };
        one_of(&file, "basis", "sh")?;
        one_of(&file, "quantity", "radiance")?;
        one_of(&file, "colour", "linear-rec709")?;
        let convention = convention(&file)?;
        let order = order(&file)?;
        let window = window(&file, order)?;
        let coefficients = coefficients(&file)?;
        if coefficients.len() != order.count() {
            return Err(LightJsonError::Count {
                order: order.get(),
                expected: order.count(),
                found: coefficients.len(),
            });
        }
        let ours = convention.from_rgb(&coefficients);
        let ours = ours.map_err(|error| LightJsonError::Syntax(error.to_string()))?;
        let fits = |rgb: &[f32; 3]| rgb.iter().all(|value| value.abs() <= MAX_COEFFICIENT);
        if let Some(index) = ours.iter().position(|rgb| !fits(rgb)) {
            return Err(LightJsonError::Coefficient { index });
        }
        Ok(Self {
            light: ShLight::new(order, ours),
            window,
        })
    }
}

fn order(file: &Map<String, Value>) -> Result<Order, LightJsonError> {
    let accepted = || format!("a whole number, 1…{}", Order::MAX);
    let value = field(file, "order", accepted)?;
    value
        .as_u64()
        .and_then(|n| usize::try_from(n).ok())
        .and_then(|n| Order::new(n).ok())
        .ok_or_else(|| LightJsonError::Field {
            field: "order",
            found: shown(value),
            accepted: accepted(),
        })
}

/// `hann` alone has the order as its cutoff. A file that names no window has none.
fn window(file: &Map<String, Value>, order: Order) -> Result<Window, LightJsonError> {
    let Some(value) = file.get("window") else {
        return Ok(Window::None);
    };
    let choice = value.as_str().and_then(|text| text.parse().ok());
    let window = choice.map(|choice: WindowChoice| choice.window(order));
    window
        // Auto is a wish, not something that was done.
        .filter(|window| *window != Window::Auto)
        .ok_or_else(|| LightJsonError::Field {
            field: "window",
            found: shown(value),
            accepted: "\"none\", \"hann:CUTOFF\" or \"gauss:RADIANS\"".to_owned(),
        })
}

fn convention(file: &Map<String, Value>) -> Result<Convention, LightJsonError> {
    let names: Vec<String> = Convention::all().map(|c| format!("\"{c}\"")).collect();
    let accepted = names.join(" or ");
    let name = string(file, "convention", &accepted)?;
    name.parse().map_err(|_| LightJsonError::Field {
        field: "convention",
        found: shown(&Value::from(name)),
        accepted,
    })
}

fn coefficients(file: &Map<String, Value>) -> Result<Vec<[f32; 3]>, LightJsonError> {
    let accepted = || "an array of [r, g, b]".to_owned();
    let value = field(file, "coefficients", accepted)?;
    let rows = value.as_array().ok_or_else(|| LightJsonError::Field {
        field: "coefficients",
        found: shown(value),
        accepted: accepted(),
    })?;
    let rgb = |row: &Value| -> Option<[f32; 3]> {
        let numbers: Option<Vec<f32>> = row
            .as_array()?
            .iter()
            .map(|value| {
                value
                    .as_f64()
                    .map(|value| value as f32)
                    .filter(|v| v.is_finite())
            })
            .collect();
        numbers?.try_into().ok()
    };
    rows.iter()
        .enumerate()
        .map(|(index, row)| rgb(row).ok_or(LightJsonError::Coefficient { index }))
        .collect()
}

fn one_of(
    file: &Map<String, Value>,
    name: &'static str,
    accepted: &str,
) -> Result<(), LightJsonError> {
    let accepted = format!("\"{accepted}\"");
    let value = string(file, name, &accepted)?;
    if format!("\"{value}\"") == accepted {
        return Ok(());
    }
    Err(LightJsonError::Field {
        field: name,
        found: shown(&Value::from(value)),
        accepted,
    })
}

fn string<'a>(
    file: &'a Map<String, Value>,
    name: &'static str,
    accepted: &str,
) -> Result<&'a str, LightJsonError> {
    let value = field(file, name, || accepted.to_owned())?;
    value.as_str().ok_or_else(|| LightJsonError::Field {
        field: name,
        found: shown(value),
        accepted: accepted.to_owned(),
    })
}

fn field<'a>(
    file: &'a Map<String, Value>,
    name: &'static str,
    accepted: impl Fn() -> String,
) -> Result<&'a Value, LightJsonError> {
    file.get(name).ok_or_else(|| LightJsonError::Missing {
        field: name,
        accepted: accepted(),
    })
}

/// A value from a file, short and fit to print.
pub(super) fn shown(value: &Value) -> String {
    const LONGEST: usize = 40;
    let text = printable(&value.to_string());
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}

#[cfg(test)]
#[path = "json_tests.rs"]
mod tests;
