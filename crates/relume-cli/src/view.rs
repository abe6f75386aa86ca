//! A place to look at a scene from: pictures of it, and the exposure they want.

use glam::Vec3;
use relume::asset::Transfer;
use relume::bake::trace::Tracer;
use relume::display::{self, Camera, GlossyRadiance, Picture, Radiance};
use relume::display::{RaycastOptions, VertexRadiance};
use relume::light::emitter::Placed;
use relume::scene::World;
use relume::shade::Outgoing;

use crate::args::Exposure;
use crate::failure::Failure;
use crate::lights::Shaded;

/// A scene, ready for camera rays, and a camera.
pub struct View<'a> {
    pub world: &'a World,
    pub tracer: &'a Tracer<'a>,
    pub camera: Camera,
    /// What glossy surfaces make of light; none in a diffuse asset.
    pub outgoing: Option<Outgoing>,
    /// Emitters that are seen where they stand; their light is the transfer's to take.
    pub emitters: Option<&'a Placed>,
}

/// Radiance by direction, where there is no surface.
pub type Background<'a> = dyn Fn(Vec3) -> [f32; 3] + Sync + 'a;

impl View<'_> {
    /// What `transfer` made of light, seen from here.
    pub fn picture(
        &self,
        transfer: &Transfer,
        shaded: &Shaded,
        background: &Background,
        options: &RaycastOptions,
    ) -> Result<Picture, Failure> {
        self.draw(transfer, shaded, background, self.emitters, options)
    }

    fn draw(
        &self,
        transfer: &Transfer,
        shaded: &Shaded,
        background: &Background,
        emitters: Option<&Placed>,
        options: &RaycastOptions,
    ) -> Result<Picture, Failure> {
        let (glossy, diffuse);
        let radiance: &dyn Radiance = match (shaded, &self.outgoing) {
            (Shaded::Glossy(arriving), Some(outgoing)) => {
                glossy = GlossyRadiance::of(outgoing, transfer, arriving.clone());
                &glossy
            }
            (Shaded::Diffuse(sides), _) => {
                diffuse = VertexRadiance::of_sides(transfer, sides.clone());
                &diffuse
            }
            (Shaded::Glossy(_), None) => unreachable!("glossy assets have surfaces to see it by"),
        };
        Ok(display::render(
            self.world,
            self.tracer,
            radiance,
            background,
            emitters,
            &self.camera,
            options,
        )?)
    }

    /// The exposure asked for, or the one that brings the mean of the surfaces in view to middle grey.
    pub fn exposure(
        &self,
        choice: Exposure,
        transfer: &Transfer,
        shaded: &Shaded,
        (width, height): (u32, u32),
    ) -> Result<f32, Failure> {
        if let Exposure::Stops(stops) = choice {
            return Ok(stops);
        }
        // A glance is enough. What is not a number is where the background shows. Emitters are no surfaces.
        let shrink = (width.max(height) / 96).max(1);
        let glance = RaycastOptions {
            width: (width / shrink).max(1),
            height: (height / shrink).max(1),
            samples_per_pixel: 1,
        };
        let glance = self.draw(transfer, shaded, &|_| [f32::NAN; 3], None, &glance)?;
        let luminance = |[r, g, b]: &[f32; 3]| f64::from(0.2126 * r + 0.7152 * g + 0.0722 * b);
        let surfaces = glance
            .pixels
            .iter()
            .map(luminance)
            .filter(|y| y.is_finite());
        let (sum, count) = surfaces.fold((0.0, 0), |(sum, count), y| (sum + y, count + 1));
        let mean = sum / f64::from(count.max(1));
        // The tone map multiplies by 0.6 first; middle grey is 0.18.
        let stops = if mean > 0.0 {
            libm::log2(0.18 / 0.6 / mean)
        } else {
            0.0
        };
        Ok(stops.clamp(-64.0, 64.0) as f32)
    }
}
