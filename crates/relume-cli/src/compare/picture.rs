//! The error picture: ours | path traced | difference, over a scale.

use std::path::{Path, PathBuf};

use glam::DVec3;
use relume::asset::{Transfer, TransferKind};
use relume::bake::trace::Tracer;
use relume::display::{self, Camera, CameraError, Picture, RaycastOptions, ToneMap};
use relume::reference::{self, RenderOptions, Sources};
use relume::scene::World;

use super::font;
use crate::args::Exposure;
use crate::failure::Failure;
use crate::inputs::shown;
use crate::lights::Shaded;
use crate::progress;
use crate::view::View;

/// What the picture shows, in numbers. All are relative to the mean luminance of the surfaces in the path-traced view.
pub struct ErrorPicture {
    /// Where it was written.
    pub path: PathBuf,
    /// The difference that has the full colour, at either end of the scale.
    pub scale: f64,
    /// The largest difference of a pixel.
    pub largest: f64,
    /// Root mean square of the differences.
    pub relative_rms: f64,
    /// How much of that the path tracer's own noise makes.
    pub noise: f64,
}

/// Paths per pixel of each of two halves, whose difference tells the noise.
const PATHS: u32 = 72;
/// The same of glossy surfaces: a lobe shows the light more sharply than a cosine does, and what it shows scatters more.
const GLOSSY_PATHS: u32 = 4 * PATHS;
/// Pixels between and below the views.
const GAP: u32 = 4;
/// Of the scale: its height, and that of the letters' pixels.
const BAR: u32 = 8;
const LETTER: u32 = 2;

/// What the picture is of.
pub struct Shot<'a> {
    pub world: &'a World,
    pub transfer: &'a Transfer,
    /// What ours is made of.
    pub shaded: &'a Shaded,
    /// Interreflections on top of the transfer's own.
    pub bounces: u32,
    /// What paths find.
    pub sources: &'a Sources<'a>,
    pub camera: Camera,
}

impl Shot<'_> {
    /// Makes the picture and writes it.
    pub fn write(&self, seed: u64, size: (u32, u32), path: &Path) -> Result<ErrorPicture, Failure> {
        let TransferKind::Shadowed { bounces: folded } = self.transfer.kind else {
            return Err(Failure::new(format!(
                "{}: paths are always shadowed, so there is no such picture of an asset without shadows; bake it with shadows",
                shown(path)
            )));
        };
        let bounces = folded + self.bounces;
        let (ours, tone) = self.ours(size)?;
        let spinner = progress::spinner("path tracing the picture");
        let half = |half: u64| {
            let seed = seed.wrapping_mul(2).wrapping_add(half);
            self.traced(bounces, seed, size)
        };
        let halves = [half(0)?, half(1)?];
        spinner.finish_and_clear();
        let (whole, figures) = compose(ours, &halves, &tone);
        whole.write(path, &tone)?;
        Ok(ErrorPicture {
            path: path.to_owned(),
            ..figures
        })
    }

    /// From the transfer, and how all three views are shown.
    fn ours(&self, (width, height): (u32, u32)) -> Result<(Picture, ToneMap), Failure> {
        let tracer = Tracer::new(self.world);
        let view = View {
            world: self.world,
            tracer: &tracer,
            camera: self.camera,
            outgoing: display::outgoing(self.world, self.transfer)?,
            emitters: self.sources.emitters,
        };
        let (transfer, shaded) = (self.transfer, self.shaded);
        let exposure = view.exposure(Exposure::Auto, transfer, shaded, (width, height))?;
        let options = RaycastOptions {
            width,
            height,
            samples_per_pixel: 64,
        };
        let ours = view.picture(transfer, shaded, &|_| [0.0; 3], &options)?;
        Ok((ours, ToneMap { exposure }))
    }

    /// Path traced.
    fn traced(
        &self,
        bounces: u32,
        seed: u64,
        (width, height): (u32, u32),
    ) -> Result<Picture, CameraError> {
        let glossy = self.transfer.matrices.is_some();
        let options = RenderOptions {
            width,
            height,
            samples_per_pixel: if glossy { GLOSSY_PATHS } else { PATHS },
            bounces,
            seed,
        };
        let (world, camera) = (self.world, &self.camera);
        let sources = self.sources;
        let behind = |_: DVec3| [0.0; 3];
        if !glossy {
            return reference::render(world, sources, &behind, camera, &options);
        }
        let surfaces = reference::material_surfaces(world)
            .expect("what is covered with a tile is not compared");
        reference::render_surfaces(world, &surfaces, sources, &behind, camera, &options)
    }
}

/// The whole picture, in radiance that `tone` turns into the colours meant.
fn compose(ours: Picture, halves: &[Picture; 2], tone: &ToneMap) -> (Picture, ErrorPicture) {
    let traced = Picture {
        pixels: std::iter::zip(&halves[0].pixels, &halves[1].pixels)
            .map(|(a, b)| std::array::from_fn(|c| 0.5 * (a[c] + b[c])))
            .collect(),
        ..halves[0]
    };
    let mean = mean(&traced);
    let errors = differences(&ours, &traced, mean);
    let noise: Vec<f64> = differences(&halves[0], &halves[1], mean);
    let mut sizes: Vec<f64> = errors
        .iter()
        .map(|d| d.abs())
        .filter(|&d| d > 0.0)
        .collect();
    sizes.sort_unstable_by(f64::total_cmp);
    // All but the outermost hundredth fits; a few bright paths must not hide the rest.
    let most = sizes.get(sizes.len() * 99 / 100).copied().unwrap_or(0.0);
    let scale = round_up(most.max(1e-3));
    let count = sizes.len().max(1) as f64;
    let rms = |values: &[f64]| (values.iter().map(|x| x * x).sum::<f64>() / count).sqrt();
    let figures = ErrorPicture {
        path: PathBuf::new(),
        scale,
        largest: sizes.last().copied().unwrap_or(0.0),
        relative_rms: rms(&errors),
        // The mean of two halves scatters half as much as their difference.
        noise: 0.5 * rms(&noise),
    };
    let difference = Picture {
        pixels: errors
            .iter()
            .map(|d| shown_as(tone, color(d / scale)))
            .collect(),
        ..ours
    };
    let gap = shown_as(tone, [0.2; 3]);
    let legend = legend(difference.width, scale, tone);
    let views = display::strip(&[ours, traced, difference], GAP, gap);
    let left = Picture::filled(views.width - legend.width, legend.height, [0.0; 3]);
    let below = display::strip(&[left, legend], 0, [0.0; 3]);
    (display::stack(&[views, below], GAP, gap), figures)
}

fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

/// Mean luminance where there is any; 1 where there is none at all.
fn mean(picture: &Picture) -> f64 {
    let lit = picture
        .pixels
        .iter()
        .map(|&p| luminance(p))
        .filter(|&y| y != 0.0);
    let (sum, count) = lit.fold((0.0, 0), |(sum, count), y| (sum + y, count + 1));
    let mean = sum / f64::from(count.max(1));
    if mean > 0.0 { mean } else { 1.0 }
}

/// Luminance of `a` − `b`, pixel by pixel, over `mean`.
fn differences(a: &Picture, b: &Picture, mean: f64) -> Vec<f64> {
    std::iter::zip(&a.pixels, &b.pixels)
        .map(|(&a, &b)| (luminance(a) - luminance(b)) / mean)
        .collect()
}

/// The next of 1, 2, 5, 10, 20, … thousandths.
fn round_up(x: f64) -> f64 {
    let mut step = 1e-3;
    loop {
        for factor in [1.0, 2.0, 5.0] {
            if factor * step >= x || step > 1e6 {
                return factor * step;
            }
        }
        step *= 10.0;
    }
}

/// Black at 0, through red to yellow where ours is too bright, through blue to cyan where it is too dark; full beyond ±1.
fn color(x: f64) -> [f64; 3] {
    let size = x.abs().min(1.0);
    // Squared, as the eye and sRGB do nearly: half of the code then is half of the scale.
    let (first, second) = (2.0 * size, 2.0 * size - 1.0);
    let (first, second) = (first.min(1.0).powi(2), second.max(0.0).powi(2));
    if x >= 0.0 {
        [first, second, 0.0]
    } else {
        [0.0, second, first]
    }
}

/// The radiance that `tone` shows as a linear display colour: the inverse of [`ToneMap::curve`] below 1.
fn shown_as(tone: &ToneMap, color: [f64; 3]) -> [f32; 3] {
    color.map(|y| {
        // y (x (2.43x + 0.59) + 0.14) = x (2.51x + 0.03), solved for x.
        let (a, b, c) = (2.51 - 2.43 * y, 0.03 - 0.59 * y, -0.14 * y);
        let x = (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
        (x / (0.6 * libm::exp2(f64::from(tone.exposure)))) as f32
    })
}

/// A bar of all colours as wide as a view, with the differences that its ends and its middle stand for below it.
fn legend(width: u32, scale: f64, tone: &ToneMap) -> Picture {
    let mut picture = Picture::filled(width, BAR + font::HEIGHT * LETTER + 2 * GAP, [0.0; 3]);
    for y in 0..BAR {
        for x in 0..width {
            let place = (2.0 * f64::from(x) + 1.0) / f64::from(width) - 1.0;
            picture.pixels[(y * width + x) as usize] = shown_as(tone, color(place));
        }
    }
    let percent = 100.0 * scale;
    let white = shown_as(tone, [0.8; 3]);
    let labels = [
        format!("-{percent}%"),
        "0".to_owned(),
        format!("+{percent}%"),
    ];
    for (i, text) in labels.iter().enumerate() {
        let free = width.saturating_sub(font::width(text) * LETTER);
        let left = free * i as u32 / 2;
        font::draw(&mut picture, text, (left, BAR + GAP), LETTER, white);
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_through_the_tone_map_as_they_were_meant() {
        for exposure in [-3.0, 0.0, 2.5] {
            let tone = ToneMap { exposure };
            for step in 0..=100 {
                let y = f64::from(step) / 100.0;
                // Rounding to f32 moves the curve, whose slope is at most 2, by less than this.
                assert!(
                    (tone.curve(shown_as(&tone, [y; 3])[0]) - y).abs() < 1e-6,
                    "{y}"
                );
            }
            assert_eq!(tone.encode(shown_as(&tone, color(1.0))), [255, 255, 0]);
            assert_eq!(tone.encode(shown_as(&tone, color(-0.5))), [0, 0, 255]);
            assert_eq!(tone.encode(shown_as(&tone, color(0.0))), [0, 0, 0]);
        }
    }

    #[test]
    fn scales_are_round_and_large_enough() {
        for (x, scale) in [
            (1e-3, 1e-3),
            (0.0011, 2e-3),
            (0.03, 0.05),
            (0.5, 0.5),
            (0.6, 1.0),
        ] {
            assert!((round_up(x) - scale).abs() < 1e-12, "{x}");
        }
        assert!(round_up(f64::INFINITY).is_finite());
        // They are printed as percent: 0.1 … 200, without the dust of binary fractions.
        for x in [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0] {
            let text = format!("{}", 100.0 * round_up(1e-3 * x));
            assert!(text.len() <= 3, "{text}");
        }
    }

    #[test]
    fn figures_are_those_of_a_known_difference() {
        let grey = |y: f32| Picture::filled(10, 10, [y; 3]);
        // The halves average to 1 and differ by 0.02; ours is a tenth too bright.
        let halves = [grey(1.01), grey(0.99)];
        let (whole, figures) = compose(grey(1.1), &halves, &ToneMap::default());
        // f32 grey levels.
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} for {b}");
        near(figures.largest, 0.1);
        near(figures.relative_rms, 0.1);
        near(figures.noise, 0.01);
        assert_eq!((whole.width, figures.scale >= 0.1), (38, true));
        // The third view is of the colour of +0.1.
        let shown = ToneMap::default().encode(whole.pixel(30, 5));
        assert_eq!(
            shown,
            ToneMap::default().encode(shown_as(&ToneMap::default(), color(0.1 / figures.scale)))
        );
    }
}
