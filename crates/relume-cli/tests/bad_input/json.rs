//! light.json.

use serde_json::{Value, json};

use super::case::Case;

fn good() -> Value {
    json!({
        "basis": "sh", "order": 2, "convention": "real-no-cs", "quantity": "radiance",
        "colour": "linear-rec709", "window": "none", "coefficients": [[1, 1, 1], [0, 0, 0], [0, 0, 0], [0, 0, 0]]
    })
}

fn with(key: &str, value: Value) -> Vec<u8> {
    let mut json = good();
    json[key] = value;
    json.to_string().into_bytes()
}

pub fn cases() -> Vec<Case> {
    let text = good().to_string();
    let mut cases: Vec<Case> = [
        (
            "JSON cut off",
            text[..text.len() / 2].into(),
            "not valid JSON",
        ),
        ("a brace alone", b"{".to_vec(), "not valid JSON"),
        ("an empty object", b"{}".to_vec(), "\"basis\" is missing"),
        (
            "NaN as a word",
            text.replacen("[1,1,1]", "[NaN,1,1]", 1).into(),
            "not valid JSON",
        ),
        (
            "a thousand brackets",
            format!("{{\"a\":{}", "[".repeat(100_000)).into(),
            "not valid JSON",
        ),
        (
            "more than any light",
            format!("{{\"a\":\"{}\"}}", "x".repeat(9_000_000)).into(),
            "are no light",
        ),
        ("another basis", with("basis", json!("haar")), "\"basis\""),
        (
            "another quantity",
            with("quantity", json!("irradiance")),
            "\"quantity\"",
        ),
        (
            "another colour",
            with("colour", json!("srgb")),
            "\"colour\"",
        ),
        (
            "control characters as a convention",
            with("convention", json!("\u{1b}[31m\n")),
            "\\u",
        ),
        ("order 0", with("order", json!(0)), "1…32"),
        ("order 33", with("order", json!(33)), "1…32"),
        (
            "order 10^18",
            with("order", json!(1_000_000_000_000_000_000_u64)),
            "1…32",
        ),
        ("order 2.5", with("order", json!(2.5)), "1…32"),
        ("order in words", with("order", json!("two")), "1…32"),
        (
            "a count that is not n²",
            with("order", json!(3)),
            "9 coefficients, but the file has 4",
        ),
        (
            "no coefficients",
            with("coefficients", json!([])),
            "4 coefficients, but the file has 0",
        ),
        (
            "coefficients that are no array",
            with("coefficients", json!("x")),
            "an array of [r, g, b]",
        ),
        (
            "a coefficient of two",
            with("coefficients", json!([[1, 1]])),
            "coefficient 0",
        ),
        (
            "a coefficient past f32",
            with("coefficients", json!([[1e39, 0, 0]])),
            "coefficient 0",
        ),
        (
            "a coefficient past all sense",
            with(
                "coefficients",
                json!([[0, 0, 0], [1e30, 0, 0], [0, 0, 0], [0, 0, 0]]),
            ),
            "coefficient 1",
        ),
        (
            "a window that is a wish",
            with("window", json!("auto")),
            "\"window\"",
        ),
        (
            "a window of NaN",
            with("window", json!("gauss:nan")),
            "\"window\"",
        ),
        (
            "a window of -1",
            with("window", json!("hann:-1")),
            "\"window\"",
        ),
    ]
    .into_iter()
    .map(|(name, bytes, part)| Case::light(name, "a.json", bytes, part))
    .collect();
    for field in ["order", "convention", "coefficients", "quantity", "colour"] {
        let mut json = good();
        json.as_object_mut().unwrap().remove(field);
        cases.push(Case::light(
            &format!("no {field}"),
            "a.json",
            json.to_string(),
            "is missing",
        ));
    }
    cases
}
