//! `relume demo`: the whole flow on the bundled courtyard.

use std::path::{Path, PathBuf};
use std::time::Instant;

use glam::{DVec3, Vec3};
use relume::asset::{self, Asset, Transfer};
use relume::bake::BakeOptions;
use relume::bake::trace::Tracer;
use relume::basis::{Order, Window};
use relume::display::{self, Picture, RaycastOptions, ToneMap};
use relume::light::{EnvSpec, Environment, LightOptions, ShLight, Turn};
use relume::reference::{self, RenderOptions, Sources};
use relume::scene::{World, bundled};

use crate::args::{DemoArgs, Exposure};
use crate::bake::bake_with_bar;
use crate::failure::Failure;
use crate::inputs::shown;
use crate::lights::Lit;
use crate::progress::{self, grouped};
use crate::view::View;

/// Interreflections of the demo.
const BOUNCES: u32 = 2;
/// Order of the light.
const ORDER: usize = 6;
/// The pictures of the lights.
const LARGE: (u32, u32) = (960, 540);
/// One panel of the strip, and one frame of the turning light.
const SMALL: (u32, u32) = (480, 270);
/// Frames of the turning light.
const FRAMES: u32 = 8;

pub fn run(args: &DemoArgs) -> Result<(), Failure> {
    let start = Instant::now();
    std::fs::create_dir_all(&args.output).map_err(|error| {
        Failure::new(format!(
            "{}: {error}; name another folder",
            shown(&args.output)
        ))
    })?;
    let scene = bundled::courtyard();
    let world = World::new(&scene);
    eprintln!(
        "The courtyard: {} vertices, {} triangles",
        grouped(world.positions.len() as u64),
        grouped(world.triangles.len() as u64)
    );

    eprintln!(
        "\nBaking how light moves through it, once: {BOUNCES} bounces, {} rays a vertex and bounce",
        args.samples
    );
    let options = BakeOptions {
        order: Order::new(ORDER)?,
        samples: args.samples,
        bounces: BOUNCES,
        threads: args.threads,
        ..BakeOptions::default()
    };
    let transfer = bake_with_bar(&world, &options, None)?.transfer;
    let asset = Asset { scene, transfer };
    let asset_path = args.output.join("courtyard.glb");
    asset::write(&asset, &asset_path)?;

    let tracer = Tracer::new(&world);
    let camera = bundled::courtyard_camera();
    let view = View {
        world: &world,
        tracer: &tracer,
        camera,
        outgoing: None,
        emitters: None,
    };
    let studio = Studio {
        view,
        asset: &asset,
        folder: &args.output,
    };
    eprintln!("\nRelighting it with lights it was not baked for");
    studio.two_skies()?;
    studio.turning_light()?;
    eprintln!("\nHow right is it? Unshadowed | shadowed | interreflected | path traced");
    studio.strip(&options)?;

    let (seconds, asset) = (start.elapsed().as_secs_f64(), shown(&asset_path));
    eprintln!("\nDone in {seconds:.0} s. The asset is {asset}; any glTF viewer opens it. Next:");
    eprintln!("  relume render {asset} --light sky:12,5 --rotate 0,1,0:120 -o evening.png");
    eprintln!("  relume compare {asset} --light sky:40,3");
    eprintln!(
        "  relume bake YOUR.glb -o baked.glb --bounces 2 && relume render baked.glb --light YOUR.hdr -o look.png"
    );
    Ok(())
}

/// What every picture of the demo is made with.
struct Studio<'a> {
    view: View<'a>,
    asset: &'a Asset,
    folder: &'a Path,
}

impl Studio<'_> {
    /// Day and evening.
    fn two_skies(&self) -> Result<(), Failure> {
        for (name, spec, degrees) in [("day", "sky:38,2.5", 75.0), ("evening", "sky:14,4", 20.0)] {
            let start = Instant::now();
            let light = Light::new(spec, degrees)?;
            let exposure = self.exposure(&light)?;
            let picture = self.look(&self.asset.transfer, &light, LARGE)?;
            self.save(&picture, &format!("{name}.png"), exposure, start)?;
        }
        Ok(())
    }

    /// A low, wide, warm light that goes round: one transfer, eight lights.
    fn turning_light(&self) -> Result<(), Failure> {
        let start = Instant::now();
        let mut frames = Vec::new();
        let mut stops = 0.0;
        for frame in 0..FRAMES {
            let degrees = 360.0 * f64::from(frame) / f64::from(FRAMES);
            let light = Light::new("sun:0,0.6,1,30,22,17,11", degrees)?;
            if frame == 0 {
                stops = self.exposure(&light)?;
            }
            frames.push(self.look(&self.asset.transfer, &light, SMALL)?);
        }
        let rows: Vec<Picture> = frames
            .chunks(4)
            .map(|row| display::strip(row, 4, [0.0; 3]))
            .collect();
        self.save(
            &display::stack(&rows, 4, [0.0; 3]),
            "turning_light.png",
            stops,
            start,
        )
    }

    fn strip(&self, options: &BakeOptions) -> Result<(), Failure> {
        let start = Instant::now();
        let light = Light::new("sky:38,2.5", 75.0)?;
        let unshadowed = bake_with_bar(
            self.view.world,
            &BakeOptions {
                shadows: false,
                bounces: 0,
                ..options.clone()
            },
            None,
        )?
        .transfer;
        let shadowed = bake_with_bar(
            self.view.world,
            &BakeOptions {
                bounces: 0,
                ..options.clone()
            },
            None,
        )?
        .transfer;
        let mut panels = Vec::new();
        for transfer in [&unshadowed, &shadowed, &self.asset.transfer] {
            panels.push(self.look(transfer, &light, SMALL)?);
        }
        panels.push(self.path_traced(&light)?);
        let stops = self.exposure(&light)?;
        self.save(
            &display::strip(&panels, 4, [0.0; 3]),
            "strip.png",
            stops,
            start,
        )
    }

    fn look(
        &self,
        transfer: &Transfer,
        light: &Light,
        size: (u32, u32),
    ) -> Result<Picture, Failure> {
        let options = RaycastOptions {
            width: size.0,
            height: size.1,
            ..RaycastOptions::default()
        };
        let background = |direction: Vec3| light.environment.radiance(direction);
        let shaded = Lit::distant(&light.sh).shaded(transfer)?;
        self.view.picture(transfer, &shaded, &background, &options)
    }

    fn exposure(&self, light: &Light) -> Result<f32, Failure> {
        let transfer = &self.asset.transfer;
        let shaded = Lit::distant(&light.sh).shaded(transfer)?;
        self.view.exposure(Exposure::Auto, transfer, &shaded, SMALL)
    }

    /// The same light, band-limited as the bake sees it, by paths from every pixel.
    fn path_traced(&self, light: &Light) -> Result<Picture, Failure> {
        let options = RenderOptions {
            width: SMALL.0,
            height: SMALL.1,
            samples_per_pixel: 144,
            bounces: BOUNCES,
            seed: 0,
        };
        let spinner = progress::spinner("path tracing the same picture");
        let radiance = reference::sh_radiance(&light.sh);
        let background = |d: DVec3| light.environment.radiance(d.as_vec3()).map(f64::from);
        let picture = reference::render(
            self.view.world,
            &Sources::distant(&radiance),
            &background,
            &self.view.camera,
            &options,
        )?;
        spinner.finish_and_clear();
        Ok(picture)
    }

    fn save(
        &self,
        picture: &Picture,
        name: &str,
        exposure: f32,
        start: Instant,
    ) -> Result<(), Failure> {
        let path: PathBuf = self.folder.join(name);
        picture.write(&path, &ToneMap { exposure })?;
        eprintln!(
            "  {}  ({:.1} s)",
            shown(&path),
            start.elapsed().as_secs_f64()
        );
        Ok(())
    }
}

/// A light as it came and as the asset takes it.
struct Light {
    environment: Environment,
    sh: ShLight,
}

impl Light {
    /// `spec` turned by `degrees` about the vertical, with the window that keeps a sun from ringing.
    fn new(spec: &str, degrees: f64) -> Result<Self, Failure> {
        let turns = vec![Turn::new(DVec3::Y, degrees)?];
        let options = LightOptions {
            turns,
            ..LightOptions::default()
        };
        let (environment, _) = relume::light::load(&spec.parse::<EnvSpec>()?, &options)?;
        let order = Order::new(ORDER)?;
        let windowed =
            Window::Hann(ORDER as f64).apply(environment.project(order).coefficients())?;
        Ok(Self {
            environment,
            sh: ShLight::new(order, windowed.coefficients),
        })
    }
}
