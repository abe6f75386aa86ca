use proptest::prelude::*;

use super::*;

fn file(n: usize) -> LightFile {
    let order = Order::new(n).unwrap();
    let coefficients = (0..order.count())
        .map(|i| [i as f32 / 3.0, -1e-7 * i as f32, 1e8 * i as f32])
        .collect();
    LightFile {
        light: ShLight::new(order, coefficients),
        window: Window::None,
    }
}

#[test]
fn the_file_is_what_the_format_says() {
    let text = file(1).to_json();
    assert_eq!(
        text,
        "{\n  \"basis\": \"sh\",\n  \"order\": 1,\n  \"convention\": \"real-no-cs\",\n  \"quantity\": \"radiance\",\n  \
         \"colour\": \"linear-rec709\",\n  \"window\": \"none\",\n  \"coefficients\": [\n    [0.0, -0.0, 0.0]\n  ]\n}\n"
    );
}

proptest! {
    #[test]
    fn every_f32_comes_back_bit_by_bit(bits in proptest::collection::vec(any::<[u32; 3]>(), 4)) {
        let finite = |bits| Some(f32::from_bits(bits)).filter(|v| v.abs() <= MAX_COEFFICIENT).unwrap_or(1.5);
        let coefficients: Vec<[f32; 3]> = bits.iter().map(|rgb| rgb.map(finite)).collect();
        let light = ShLight::new(Order::new(2).unwrap(), coefficients.clone());
        let written = LightFile { light, window: Window::Gauss(0.425) };
        let read = LightFile::from_json(written.to_json().as_bytes()).unwrap();
        prop_assert_eq!(read.window, Window::Gauss(0.425));
        for (a, b) in read.light.coefficients().iter().flatten().zip(coefficients.iter().flatten()) {
            prop_assert_eq!(a.to_bits(), b.to_bits());
        }
    }
}

#[test]
fn other_conventions_are_converted_on_reading() {
    let text = file(2).to_json().replace("real-no-cs", "real-cs");
    let read = LightFile::from_json(text.as_bytes()).unwrap();
    // With the Condon–Shortley phase, odd m have the other sign.
    for (i, sign) in [(0, 1.0), (1, -1.0), (2, 1.0), (3, -1.0)] {
        let expected = file(2).light.coefficients()[i].map(|value| sign * value);
        assert_eq!(read.light.coefficients()[i], expected);
    }
}

#[test]
fn unknown_fields_and_a_missing_window_are_no_matter() {
    let text = file(3)
        .to_json()
        .replace("\"window\": \"none\"", "\"made_by\": {\"x\": [1]}");
    assert_eq!(LightFile::from_json(text.as_bytes()), Ok(file(3)));
}

#[test]
fn wrong_headers_are_refused_with_what_is_accepted() {
    for (from, to, needles) in [
        ("\"sh\"", "\"haar\"", ["basis", "\"sh\""]),
        ("radiance", "irradiance", ["quantity", "\"radiance\""]),
        ("linear-rec709", "srgb", ["colour", "\"linear-rec709\""]),
        ("real-no-cs", "complex", ["convention", "\"real-cs\""]),
        ("\"order\": 2", "\"order\": 3", ["order 3", "9"]),
        ("\"order\": 2", "\"order\": 2.5", ["order", "1…32"]),
        ("\"order\": 2", "\"order\": 33", ["order", "1…32"]),
        ("\"order\": 2", "\"order\": -2", ["order", "1…32"]),
        ("\"basis\"", "\"base\"", ["basis", "missing"]),
        (
            "\"coefficients\"",
            "\"numbers\"",
            ["coefficients", "missing"],
        ),
        (
            "\"window\": \"none\"",
            "\"window\": 3",
            ["window", "hann:CUTOFF"],
        ),
        ("[0.0, -0.0, 0.0]", "[0.0, NaN, 0.0]", ["JSON", "NaN"]),
        (
            "[0.0, -0.0, 0.0]",
            "[0.0, 1e39, 0.0]",
            ["coefficient 0", "finite"],
        ),
        (
            "[0.0, -0.0, 0.0]",
            "[0.0, null, 0.0]",
            ["coefficient 0", "finite"],
        ),
        ("[0.0, -0.0, 0.0]", "[0.0, 0.0]", ["coefficient 0", "three"]),
        (
            "\"window\": \"none\"",
            "\"window\": \"auto\"",
            ["window", "auto"],
        ),
        (
            "\"window\": \"none\"",
            "\"window\": \"hann:-1\"",
            ["window", "hann:-1"],
        ),
        ("[0.0, -0.0, 0.0]", "7", ["coefficient 0", "three"]),
        ("\"sh\"", "\"s\\u001b[31mh\"", ["basis", "\\u001b"]),
    ] {
        let text = file(2).to_json();
        assert!(text.contains(from), "{from}");
        let error = LightFile::from_json(text.replace(from, to).as_bytes()).unwrap_err();
        let message = error.to_string();
        for needle in needles {
            assert!(message.contains(needle), "{to}: {message}");
        }
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(!message.contains('\u{1b}'));
    }
    for text in ["", "[]", "{", "{}", "{\"coefficients\": 1}", "\u{0}"] {
        assert!(LightFile::from_json(text.as_bytes()).is_err(), "{text}");
    }
}

/// A positive delta rings; `auto` records the width that stopped it, and nothing when nothing rang.
#[test]
fn windows_are_applied_and_recorded() {
    let order = Order::new(5).unwrap();
    let delta = crate::basis::sh::eval(order, glam::DVec3::Z);
    let light = ShLight::new(
        order,
        delta.iter().map(|&value| [value as f32; 3]).collect(),
    );
    let none = LightFile::windowed(&light, WindowChoice::default()).unwrap();
    assert_eq!((&none.light, none.window), (&light, Window::None));
    let hann = LightFile::windowed(&light, WindowChoice::Hann).unwrap();
    assert_eq!(hann.window, Window::Hann(5.0));
    // ½(1 + cos(π/5)) of degree 1.
    let expected = light.coefficients()[2][0] * (0.5 * (1.0 + (std::f32::consts::PI / 5.0).cos()));
    assert!((hann.light.coefficients()[2][0] - expected).abs() < 1e-6);
    let auto = LightFile::windowed(&light, WindowChoice::Window(Window::Auto)).unwrap();
    assert!(matches!(auto.window, Window::Gauss(_)), "{}", auto.window);
    for i in 0..200 {
        let angle = f64::from(i) * std::f64::consts::PI / 199.0;
        let d = glam::DVec3::new(angle.sin(), 0.0, angle.cos());
        assert!(auto.light.radiance(d)[0] >= -1e-5);
    }
    let read = LightFile::from_json(auto.to_json().as_bytes()).unwrap();
    assert_eq!(read, auto);
    let plain = hann.to_json().replace("hann:5", "hann");
    assert_eq!(LightFile::from_json(plain.as_bytes()), Ok(hann));
    let constant = ShLight::new(Order::new(1).unwrap(), vec![[1.0; 3]]);
    assert_eq!(
        LightFile::windowed(&constant, WindowChoice::Window(Window::Auto))
            .unwrap()
            .window,
        Window::None
    );
}
