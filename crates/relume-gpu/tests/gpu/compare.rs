//! Pictures of the GPU held against pictures of the CPU.

use glam::Vec3;
use relume::bake::trace::Tracer;
use relume::display::{self, Camera, Picture, RaycastOptions, VertexRadiance};
use relume::scene::World;

/// How far the centre of a pixel may be off, in pixels: rasterisers keep corners to 1/256 of a pixel, so an edge (and all that is interpolated
/// between edges) lies up to half of that elsewhere; four times as much, for edges seen at a slant.
const OFF: f32 = 1.0 / 128.0;

/// What the CPU sees: its picture, and the darkest and brightest it would see with pixels that are slightly off.
pub struct Expected {
    pub picture: Picture,
    low: Vec<[f32; 3]>,
    high: Vec<[f32; 3]>,
}

impl Expected {
    /// One ray through the middle of each pixel, and four around it.
    pub fn new(
        world: &World,
        radiance: &VertexRadiance,
        background: &(dyn Fn(Vec3) -> [f32; 3] + Sync),
        camera: &Camera,
        (width, height): (u32, u32),
    ) -> Self {
        let tracer = Tracer::new(world);
        let options = RaycastOptions {
            width,
            height,
            samples_per_pixel: 1,
        };
        let look = |camera: &Camera| {
            display::render(world, &tracer, radiance, background, camera, &options).unwrap()
        };
        let picture = look(camera);
        let (mut low, mut high) = (picture.pixels.clone(), picture.pixels.clone());
        let frame = camera.frame().unwrap();
        let distance = f64::from((camera.target - camera.eye).length());
        let pixel = 2.0 * frame.half_height * distance / f64::from(height);
        for (x, y) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let aside = (frame.right * x + frame.up * y) * pixel * f64::from(OFF);
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

    /// Asserts that every pixel lies within what the CPU sees around it, `relative` of its brightness and `absolute` more; returns the
    /// largest difference that is left, and says it.
    pub fn check(&self, name: &str, picture: &Picture, relative: f32, absolute: f32) -> f32 {
        assert_eq!(
            (picture.width, picture.height),
            (self.picture.width, self.picture.height)
        );
        let mut largest = 0.0_f32;
        let mut outside = 0;
        let mut different = 0.0_f32;
        for (i, pixel) in picture.pixels.iter().enumerate() {
            for (c, &value) in pixel.iter().enumerate() {
                assert!(value.is_finite(), "{name}: pixel {i} is {value}");
                let (low, high) = (self.low[i][c], self.high[i][c]);
                let off = (low - value).max(value - high).max(0.0);
                largest = largest.max(off);
                different = different.max((value - self.picture.pixels[i][c]).abs());
                outside += u32::from(off > relative * high.abs().max(low.abs()) + absolute);
            }
        }
        println!("{name}: largest difference {largest:.2e} ({different:.2e} with edges)");
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
        largest
    }
}
