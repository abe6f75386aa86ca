//! The command line of the native window.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use eframe::egui;
use relume_viewer::{NO_LIGHT, Source, Start, Viewer};

/// Look at a baked scene in live light: turn the sky, swap the light, fly around
#[derive(Parser)]
#[command(
    name = "relume-viewer",
    version,
    max_term_width = 100,
    after_help = "\
Examples:
  relume-viewer baked.glb
  relume-viewer baked.glb --light studio.hdr
  relume-viewer baked.glb --emitters lamps.json      lights that stand near, to move and colour
  relume-viewer model.obj                            a model is baked first, in the background
  relume-viewer baked.glb --light sky:20,4 --screenshot look.png"
)]
struct Args {
    /// A baked .glb, a model (.gltf, .glb, .obj, .ply) or a light; nothing opens an empty window
    files: Vec<PathBuf>,
    /// The light: a file, or sky:ELEVATION,TURBIDITY, sun:X,Y,Z,DEG,R,G,B, constant:R,G,B [default: sky:30,3, or none beside --emitters]
    #[arg(long, value_name = "ENV")]
    light: Option<String>,
    /// Lights that stand near: an emitters.json, or a .glb or .gltf, of which what is emissive shines
    #[arg(long, value_name = "FILE")]
    emitters: Option<PathBuf>,
    /// Exposure in stops [default: what suits the scene]
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true)]
    exposure: Option<f32>,
    /// Turn the light about the vertical first, degrees
    #[arg(
        long,
        value_name = "DEGREES",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    turn: f64,
    /// The window's size, points
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    size: (u32, u32),
    /// Start without panels
    #[arg(long)]
    no_panels: bool,
    /// Start without the environment behind the scene
    #[arg(long)]
    no_background: bool,
    /// Write the first picture to this file and end
    #[arg(long, value_name = "FILE")]
    screenshot: Option<PathBuf>,
}

/// Opens the window and stays until it is closed.
pub fn run() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
    let args = Args::parse();
    let viewport = egui::ViewportBuilder::default()
        .with_title("Relume")
        .with_app_id("relume")
        .with_inner_size([args.size.0 as f32, args.size.1 as f32])
        .with_drag_and_drop(true);
    let options = eframe::NativeOptions {
        viewport,
        wgpu_options: relume_viewer::graphics(),
        ..eframe::NativeOptions::default()
    };
    let lamps_alone = args.emitters.is_some();
    let start = Start {
        files: args.files.into_iter().map(Source::Path).collect(),
        light: args
            .light
            .or_else(|| lamps_alone.then(|| NO_LIGHT.to_owned())),
        emitters: args.emitters,
        turn: args.turn,
        exposure: args.exposure,
        background: !args.no_background,
        panels: !args.no_panels,
        screenshot: args.screenshot,
    };
    let run = eframe::run_native(
        "relume",
        options,
        Box::new(|context| Ok(Box::new(Viewer::new(context, start)?))),
    );
    match run {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let why = error.to_string();
            // What is before the last colon names types and source files.
            let why = why.lines().next().unwrap_or_default();
            let why = why.rsplit(": ").next().unwrap_or(why).trim_end_matches('.');
            eprintln!(
                "error: no window could be opened ({why}); check that a display and a driver for Vulkan, Metal, DirectX 12 or OpenGL are there"
            );
            ExitCode::FAILURE
        }
    }
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let sides = text
        .split_once('x')
        .and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    sides
        .filter(|&(w, h): &(u32, u32)| (64..=16384).contains(&w) && (64..=16384).contains(&h))
        .ok_or_else(|| "give width and height between 64 and 16384, such as 1280x720".to_owned())
}
