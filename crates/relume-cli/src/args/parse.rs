//! Values of flags from text; what they refuse ends with status 2.

use glam::Vec3;
use relume::bake::BakeOptions;
use relume::basis::Order;
use relume::brdf::tile::{MAX_TEXELS, MAX_VIEWS};

/// `--max-edge`
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MaxEdge {
    Auto,
    Length(f64),
}

/// `--samples`
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Samples {
    /// As many as an error takes.
    Auto,
    Count(u32),
}

/// `--exposure`
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    Auto,
    Stops(f32),
}

pub fn order(text: &str) -> Result<Order, String> {
    let number: usize = text.parse().map_err(|_| "not a whole number".to_owned())?;
    Order::new(number).map_err(|error| error.to_string())
}

pub fn samples(text: &str) -> Result<u32, String> {
    in_range(text, 1, BakeOptions::MAX_SAMPLES)
}

pub fn samples_or_auto(text: &str) -> Result<Samples, String> {
    match text {
        "auto" => Ok(Samples::Auto),
        number => samples(number)
            .map(Samples::Count)
            .map_err(|range| format!("{range}, nor auto")),
    }
}

pub fn error(text: &str) -> Result<f64, String> {
    let range = BakeOptions::MIN_ERROR..=0.5;
    match text.parse() {
        Ok(error) if range.contains(&error) => Ok(error),
        _ => Err(format!("not an error in {}…{}", range.start(), range.end())),
    }
}

pub fn texels(text: &str) -> Result<u32, String> {
    in_range(text, 1, MAX_TEXELS as u32)
}

pub fn views(text: &str) -> Result<u32, String> {
    in_range(text, 2, MAX_VIEWS as u32)
}

pub fn period(text: &str) -> Result<[f32; 2], String> {
    let sides: Result<Vec<f32>, _> = text.split(',').map(str::parse).collect();
    match sides.as_deref() {
        Ok(&[x, z]) if x > 0.0 && z > 0.0 && x.max(z).is_finite() => Ok([x, z]),
        _ => Err("not two positive lengths X,Z".to_owned()),
    }
}

pub fn repeat(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(repeat) if (1e-3..=1e6).contains(&repeat) => Ok(repeat),
        _ => Err("not a number in 0.001…1000000".to_owned()),
    }
}

pub fn bounces(text: &str) -> Result<u32, String> {
    in_range(text, 0, BakeOptions::MAX_BOUNCES)
}

pub fn threads(text: &str) -> Result<usize, String> {
    in_range(text, 1, 1024).map(|n| n as usize)
}

fn in_range(text: &str, low: u32, high: u32) -> Result<u32, String> {
    match text.parse() {
        Ok(number) if (low..=high).contains(&number) => Ok(number),
        _ => Err(format!("not a whole number in {low}…{high}")),
    }
}

pub fn albedo(text: &str) -> Result<[f32; 3], String> {
    let values = three(text)?;
    if values.iter().all(|x| (0.0..=1.0).contains(x)) {
        return Ok(values);
    }
    Err("albedo is the share of light reflected: three numbers in 0…1".to_owned())
}

pub fn share(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err("not a number in 0…1".to_owned()),
    }
}

pub fn exponent(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(exponent) if (0.0..=10_000.0).contains(&exponent) => Ok(exponent),
        _ => Err("not a number in 0…10000".to_owned()),
    }
}

pub fn point(text: &str) -> Result<Vec3, String> {
    three(text).map(Vec3::from)
}

fn three(text: &str) -> Result<[f32; 3], String> {
    let numbers: Option<Vec<f32>> = text
        .split(',')
        .map(|part| part.trim().parse().ok())
        .collect();
    let three = numbers.and_then(|numbers| <[f32; 3]>::try_from(numbers).ok());
    three
        .filter(|three| three.iter().all(|x| x.is_finite()))
        .ok_or_else(|| "not three numbers with commas between them, such as 1,0.5,0".to_owned())
}

pub fn max_edge(text: &str) -> Result<MaxEdge, String> {
    match text.parse::<f64>() {
        _ if text == "auto" => Ok(MaxEdge::Auto),
        Ok(length) if length > 0.0 && length.is_finite() => Ok(MaxEdge::Length(length)),
        _ => Err("neither a positive length nor auto".to_owned()),
    }
}

pub fn exposure(text: &str) -> Result<Exposure, String> {
    match text.parse::<f32>() {
        _ if text == "auto" => Ok(Exposure::Auto),
        Ok(stops) if stops.abs() <= 64.0 => Ok(Exposure::Stops(stops)),
        _ => Err("neither a number of stops in −64…64 nor auto".to_owned()),
    }
}

pub fn fov(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(degrees) if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err("not an angle above 0 and below 180 degrees".to_owned()),
    }
}

pub fn size(text: &str) -> Result<(u32, u32), String> {
    const LARGEST: u32 = 16_384;
    let pixels = text
        .split_once('x')
        .and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match pixels {
        Some((w, h)) if (1..=LARGEST).contains(&w) && (1..=LARGEST).contains(&h) => Ok((w, h)),
        _ => Err(format!(
            "not a size such as 960x540, each at most {LARGEST}"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn good_values_are_read_and_bad_ones_refused() {
        assert_eq!(size("960x540"), Ok((960, 540)));
        assert!(
            ["960", "0x3", "x", "99999x1", "-1x4"]
                .iter()
                .all(|text| size(text).is_err())
        );
        assert_eq!(albedo("0.5, 1,0"), Ok([0.5, 1.0, 0.0]));
        assert!(
            ["0.5", "1,2,3", "NaN,0,0", "1,0,-0.1"]
                .iter()
                .all(|text| albedo(text).is_err())
        );
        assert_eq!(max_edge("auto"), Ok(MaxEdge::Auto));
        assert!(
            ["0", "-1", "inf", "wide"]
                .iter()
                .all(|text| max_edge(text).is_err())
        );
        assert!(order("33").is_err() && order("0").is_err() && order("32").is_ok());
        assert!(samples("0").is_err() && threads("0").is_err() && fov("180").is_err());
    }
}
