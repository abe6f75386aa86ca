//! Pictures of the GPU held against pictures of the CPU.

use glam::Vec3;
use relume::bake::trace::Tracer;
use relume::display::{self, Camera, Picture, Radiance, RaycastOptions, ToneMap};
use relume::light::emitter::Placed;
use relume::scene::World;

use crate::device::Drawn;

/// How far the centre of a pixel may be off, in pixels: rasterisers keep corners to 1/256 of a pixel, so an edge (and all that is interpolated
/// between edges) lies up to half of that elsewhere; four times as much, for edges seen at a slant.
pub const EDGE: f32 = 1.0 / 128.0;

/// What the CPU sees: its picture, and the darkest and brightest it would see with pixels that are slightly off.
pub struct Expected {
    pub picture: Picture,
    low: Vec<[f32; 3]>,
    high: Vec<[f32; 3]>,
}

impl Expected {
    /// One ray through the middle of each pixel, and four that are `off` pixels aside.
    pub fn new(
        world: &World,
        radiance: &dyn Radiance,
        background: &(dyn Fn(Vec3) -> [f32; 3] + Sync),
        camera: &Camera,
        size: (u32, u32),
        off: f32,
    ) -> Self {
        Self::with_emitters(world, radiance, background, None, camera, size, off)
    }

    /// [`Self::new`] with emitters in the picture.
    pub fn with_emitters(
        world: &World,
        radiance: &dyn Radiance,
        background: &(dyn Fn(Vec3) -> [f32; 3] + Sync),
        emitters: Option<&Placed>,
        camera: &Camera,
        (width, height): (u32, u32),
        off: f32,
    ) -> Self {
        let tracer = Tracer::new(world);
        let options = RaycastOptions {
            width,
            height,
            samples_per_pixel: 1,
        };
        let look = |camera: &Camera| {
            display::render(
                world, &tracer, radiance, background, emitters, camera, &options,
            )
            .unwrap()
        };
        let picture = look(camera);
        let (mut low, mut high) = (picture.pixels.clone(), picture.pixels.clone());
        let frame = camera.frame().unwrap();
        let distance = f64::from((camera.target - camera.eye).length());
        let pixel = 2.0 * frame.half_height * distance / f64::from(height);
        for (x, y) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let aside = (frame.right * x + frame.up * y) * pixel * f64::from(off);
            // A turn of so little moves the picture as a whole.
            let target = camera.target + aside.as_vec3();
            let turned = look(&Camera { target, ..*camera });
            for (i, seen) in turned.pixels.iter().enumerate() {
                for (c, seen) in seen.iter().enumerate() {
                    low[i][c] = low[i][c].min(*seen);
                    high[i][c] = high[i][c].max(*seen);
                }
            }
        }
        Self { picture, low, high }
    }

    /// Asserts that every pixel lies within what the CPU sees around it, `relative` of its brightness and `absolute` more (and one code more,
    /// where codes are drawn); says the largest difference.
    pub fn check(&self, name: &str, drawn: &Drawn, relative: f32, absolute: f32) {
        let (outside, largest) = self.differences(drawn, relative, absolute);
        println!("{name}: largest difference {largest}");
        assert_eq!(
            outside, 0,
            "{name}: values outside; the largest difference is {largest}"
        );
        // A picture of nothing agrees with everything.
        let lit = self.picture.pixels.iter().filter(|p| p[0] != 0.0).count();
        assert!(
            lit * 20 > self.picture.pixels.len(),
            "{name}: {lit} lit pixels"
        );
    }

    /// How many values lie outside what [`Self::check`] allows.
    pub fn outside(&self, drawn: &Drawn, relative: f32, absolute: f32) -> usize {
        self.differences(drawn, relative, absolute).0
    }

    fn differences(&self, drawn: &Drawn, relative: f32, absolute: f32) -> (usize, String) {
        match drawn {
            Drawn::Radiance(pixels) => self.off(pixels, relative, absolute),
            Drawn::Codes(pixels) => self.codes_off(pixels, relative, absolute),
        }
    }

    /// How many values lie outside, and the largest distance from what the CPU sees.
    fn off(&self, pixels: &[[f32; 3]], relative: f32, absolute: f32) -> (usize, String) {
        let (mut outside, mut largest) = (0, 0.0_f32);
        for (i, pixel) in pixels.iter().enumerate() {
            for (c, &value) in pixel.iter().enumerate() {
                assert!(value.is_finite(), "pixel {i} is {value}");
                let (low, high) = (self.low[i][c], self.high[i][c]);
                let off = (low - value).max(value - high).max(0.0);
                largest = largest.max(off);
                outside += usize::from(off > relative * high.abs().max(low.abs()) + absolute);
            }
        }
        (outside, format!("{largest:.1e}"))
    }

    fn codes_off(&self, pixels: &[[u8; 3]], relative: f32, absolute: f32) -> (usize, String) {
        let tone = ToneMap::default();
        let (mut outside, mut largest) = (0, 0);
        for (i, pixel) in pixels.iter().enumerate() {
            let code = |radiance: [f32; 3], sign: f32| {
                tone.encode(radiance.map(|x| x + sign * (relative * x.abs() + absolute)))
            };
            let exact = (tone.encode(self.low[i]), tone.encode(self.high[i]));
            let allowed = (code(self.low[i], -1.0), code(self.high[i], 1.0));
            for (c, &value) in pixel.iter().enumerate() {
                let beyond =
                    |low: u8, high: u8| low.saturating_sub(value).max(value.saturating_sub(high));
                largest = largest.max(beyond(exact.0[c], exact.1[c]));
                outside += usize::from(beyond(allowed.0[c], allowed.1[c]) > 1);
            }
        }
        (outside, format!("{largest} codes"))
    }
}
