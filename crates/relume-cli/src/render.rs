//! `relume render`

use std::path::PathBuf;

use glam::{DVec3, Vec3};
use relume::bake::trace::Tracer;
use relume::display::{self, Camera, RaycastOptions, ToneMap};
use relume::light::{Environment, ShLight, Turn};
use relume::scene::World;

use crate::args::{BackgroundArg, RenderArgs, SweepArg};
use crate::failure::Failure;
use crate::inputs::{self, check_extension, check_output, shown};
use crate::lights::{self, Lights};
use crate::progress;
use crate::view::{Background, View};

pub fn run(args: &RenderArgs) -> Result<(), Failure> {
    check_extension(&args.output, &["png", "exr"])?;
    let frames = frame_names(args)?;
    let files = lights::paths(&args.light);
    let mut given = vec![args.asset.as_path()];
    given.extend(files.iter().map(PathBuf::as_path));
    frames
        .iter()
        .try_for_each(|frame| check_output(frame, &given))?;
    let (asset, world) = inputs::open_asset(&args.asset)?;
    let lights = Lights::open(&args.light, &args.asset, &asset, &world)?;
    let tracer = Tracer::new(&world);
    let mut view = View {
        world: &world,
        tracer: &tracer,
        camera: camera(args, &world),
        outgoing: display::outgoing(&world, &asset.transfer)?,
        emitters: lights.placed.as_ref(),
    };
    let (start, transfer) = (view.camera, &asset.transfer);
    let shaded = |distant: &ShLight| {
        let shaded = lights.with(distant).shaded(transfer);
        shaded.map_err(|error| Failure::new(format!("{}: {error}", shown(&args.asset))))
    };
    let mut lit = shaded(&lights.distant)?;
    let exposure = view.exposure(args.exposure, transfer, &lit, args.size)?;
    let options = RaycastOptions {
        width: args.size.0,
        height: args.size.1,
        samples_per_pixel: args.samples_per_pixel,
    };

    let bar = progress::count_bar("rendering", frames.len() as u64);
    for (i, path) in frames.iter().enumerate() {
        let share = i as f64 / frames.len() as f64;
        let (light, environment, camera) =
            swept(args, share, (&lights.distant, &lights.environment, start))?;
        view.camera = camera;
        let background = background(args.background, &environment, &light);
        if args.sweep == Some(SweepArg::Light) {
            lit = shaded(&light)?;
        }
        let picture = view.picture(transfer, &lit, &*background, &options)?;
        picture.write(path, &ToneMap { exposure })?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    let name = |path: Option<&PathBuf>| shown(path.expect("at least one frame"));
    let names = match frames.len() {
        1 => name(frames.first()),
        _ => format!("{} … {}", name(frames.first()), name(frames.last())),
    };
    eprintln!("wrote {names} (exposure {exposure:+.2} stops)");
    Ok(())
}

/// The light and the camera at this share of a sweep: one of them turned about the vertical, once over all frames.
fn swept(
    args: &RenderArgs,
    share: f64,
    (light, environment, camera): (&ShLight, &Environment, Camera),
) -> Result<(ShLight, Environment, Camera), Failure> {
    let turn = Turn::new(DVec3::Y, 360.0 * share)?.matrix();
    Ok(match args.sweep {
        Some(SweepArg::Light) => (
            light.rotated(turn)?,
            environment.clone().rotated(turn)?,
            camera,
        ),
        Some(SweepArg::Camera) => {
            let from_target = turn * (camera.eye - camera.target).as_dvec3();
            let eye = camera.target + from_target.as_vec3();
            (light.clone(), environment.clone(), Camera { eye, ..camera })
        }
        None => (light.clone(), environment.clone(), camera),
    })
}

/// The camera asked for; what is not said comes from a view of the whole.
fn camera(args: &RenderArgs, world: &World) -> Camera {
    let framing = Camera::framing(world, args.size.0 as f32 / args.size.1 as f32);
    Camera {
        eye: args.eye.unwrap_or(framing.eye),
        target: args.target.unwrap_or(framing.target),
        up: Vec3::Y,
        fov_vertical_deg: args.fov.unwrap_or(framing.fov_vertical_deg),
    }
}

/// What stands behind the scene, by direction.
fn background<'a>(
    choice: BackgroundArg,
    environment: &'a Environment,
    light: &'a ShLight,
) -> Box<Background<'a>> {
    match choice {
        BackgroundArg::Environment => Box::new(|direction| environment.radiance(direction)),
        BackgroundArg::Light => Box::new(|direction| light.radiance(direction.as_dvec3())),
        BackgroundArg::Black => Box::new(|_| [0.0; 3]),
    }
}

/// The files to write: one, or the pattern's numbers 0…N−1.
fn frame_names(args: &RenderArgs) -> Result<Vec<PathBuf>, Failure> {
    let name = args.output.to_string_lossy();
    match args.frames {
        None => Ok(vec![args.output.clone()]),
        Some(frames) => (0..frames)
            .map(|i| numbered(&name, i).map(PathBuf::from))
            .collect(),
    }
}

/// `name` with its one `%d` or `%0Nd` replaced by `number`.
fn numbered(name: &str, number: u32) -> Result<String, Failure> {
    let wrong = || {
        let name = relume::files::printable(name);
        Failure::new(format!(
            "{name}: with --frames the output needs one number, such as f_%04d.png"
        ))
    };
    let (before, rest) = name.split_once('%').ok_or_else(wrong)?;
    let (digits, after) = rest.split_once('d').ok_or_else(wrong)?;
    let width = match digits.strip_prefix('0') {
        _ if digits.is_empty() => 0,
        Some(width) => width
            .parse::<usize>()
            .ok()
            .filter(|w| *w <= 9)
            .ok_or_else(wrong)?,
        None => return Err(wrong()),
    };
    if after.contains('%') {
        return Err(wrong());
    }
    Ok(format!("{before}{number:0width$}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_numbered_by_the_pattern_and_by_nothing_else() {
        let name = |pattern| numbered(pattern, 7).ok();
        assert_eq!(name("f_%04d.png").as_deref(), Some("f_0007.png"));
        assert_eq!(name("a/f%d.png").as_deref(), Some("a/f7.png"));
        assert!(
            ["f.png", "f_%s.png", "f_%4d.png", "%d_%d.png", "%0999d"]
                .iter()
                .all(|p| name(p).is_none())
        );
    }
}
