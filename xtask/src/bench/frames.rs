//! The benches of what is drawn: frames of the renderer, and the first picture of the page.

use super::Figures;
use super::bakes::meshes;
use crate::context::Context;
use crate::{browser, process};

/// Frame times: the example `frame_time` of the renderer.
pub fn frames(context: &Context, arguments: &[String]) -> Result<Figures, String> {
    let example = context.cargo("build --release --locked -p relume-gpu --example frame_time");
    if !process::succeeds(&mut { example })? {
        return Ok(Figures::Failed);
    }
    let program = context.program("release/examples", "frame_time");
    for mesh in meshes(context, &["happy_buddha_50k.obj", "igea_134k.ply"]) {
        println!("{}", mesh.file_name().unwrap_or_default().display());
        let mut command = context.command(&program);
        command
            .arg(mesh)
            .args(arguments)
            .envs(context.runtime_folder()?);
        if !process::succeeds(&mut command)? {
            return Ok(Figures::Failed);
        }
    }
    Ok(Figures::Printed)
}

/// Time to the first picture: `xtask/js/first_picture.mjs` on the page as it is published.
pub fn page(context: &Context, _: &[String]) -> Result<Figures, String> {
    Ok(if browser::first_picture(context)? {
        Figures::Printed
    } else {
        Figures::Failed
    })
}
