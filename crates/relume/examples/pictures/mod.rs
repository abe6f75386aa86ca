//! Pictures that are compared, pixel by pixel.

use relume::display::{self, Picture};

/// What stands behind a scene: far below any radiance, so that its pixels are known.
pub const NOTHING: f32 = -65_536.0;

/// Says how far `ours` is from the mean of two pictures by paths, and how far these are from each other; returns ours, the mean and the absolute
/// difference side by side.
pub fn compared(ours: &Picture, first: &Picture, second: &Picture) -> Picture {
    let mean = combined(first, second, |a, b| (a + b) / 2.0);
    let noise = difference(first, second, &mean) / 2.0;
    let off = difference(ours, &mean, &mean);
    println!(
        "off by {:.2} %, paths' noise {:.2} %, without it {:.2} %",
        100.0 * off,
        100.0 * noise,
        100.0 * (off * off - noise * noise).max(0.0).sqrt()
    );
    let shown = |picture: &Picture| combined(picture, picture, |a, _| a.max(0.0));
    let error = combined(ours, &mean, |a, b| (a - b).abs());
    display::strip(&[shown(ours), shown(&mean), shown(&error)], 0, [0.0; 3])
}

/// Pixel by pixel and channel by channel.
fn combined(a: &Picture, b: &Picture, of: impl Fn(f32, f32) -> f32) -> Picture {
    let pairs = a.pixels.iter().zip(&b.pixels);
    Picture {
        width: a.width,
        height: a.height,
        pixels: pairs
            .map(|(a, b)| std::array::from_fn(|c| of(a[c], b[c])))
            .collect(),
    }
}

/// Relative RMS over the pixels that show nothing but surfaces.
fn difference(a: &Picture, b: &Picture, scale: &Picture) -> f64 {
    // A camera ray that leaves the scene outweighs all that surfaces send.
    let is_whole = |pixel: &[f32; 3]| pixel[0] > -0.5;
    let (mut off, mut all) = (0.0, 0.0);
    for ((a, b), scale) in a.pixels.iter().zip(&b.pixels).zip(&scale.pixels) {
        if ![a, b, scale].into_iter().all(is_whole) {
            continue;
        }
        for c in 0..3 {
            off += f64::from(a[c] - b[c]).powi(2);
            all += f64::from(scale[c]).powi(2);
        }
    }
    (off / all).sqrt()
}
