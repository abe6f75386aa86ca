//! Dialogs for files.

#[cfg(not(target_arch = "wasm32"))]
use std::path::Path;

use crate::app::Viewer;
use crate::jobs::{Event, Jobs};
#[cfg(not(target_arch = "wasm32"))]
use crate::{jobs::Teller, source::Source};

/// Asks for a file and opens it.
#[cfg(not(target_arch = "wasm32"))]
pub fn pick(jobs: &Jobs) {
    jobs.run(|teller| {
        let dialog = rfd::FileDialog::new()
            .set_title("Open a scene or a light")
            .add_filter(
                "scenes and lights",
                &[
                    "glb", "gltf", "obj", "ply", "hdr", "exr", "dds", "pfm", "png", "jpg", "json",
                ],
            )
            .add_filter("everything", &["*"]);
        if let Some(path) = dialog.pick_file() {
            teller.read(&Source::Path(path));
        }
    });
}

/// Asks for a file and opens it.
#[cfg(target_arch = "wasm32")]
pub fn pick(jobs: &Jobs) {
    crate::web::pick(jobs.teller());
}

/// Asks for a name and writes there.
#[cfg(not(target_arch = "wasm32"))]
pub fn save(
    jobs: &Jobs,
    name: String,
    write: impl FnOnce(&Path) -> Result<(), String> + Send + 'static,
) {
    jobs.run(move |teller| ask_and_write(&teller, &name, write));
}

#[cfg(not(target_arch = "wasm32"))]
fn ask_and_write(teller: &Teller, name: &str, write: impl FnOnce(&Path) -> Result<(), String>) {
    let Some(path) = rfd::FileDialog::new().set_file_name(name).save_file() else {
        return;
    };
    let shown = relume::files::printable(&path.to_string_lossy());
    teller.tell(match write(&path) {
        Ok(()) => Event::Said(format!("wrote {shown}")),
        Err(error) => Event::Failed(error),
    });
}

/// Saves what the picture shows.
#[cfg(not(target_arch = "wasm32"))]
pub fn save_picture(viewer: &Viewer) {
    let teller = viewer.jobs.teller();
    viewer.stage.copy(move |size, pixels| {
        std::thread::spawn(move || {
            ask_and_write(&teller, "relume.png", |path| {
                crate::screenshot::write(path, size, &pixels)
            });
        });
    });
}

/// Saves what the picture shows.
#[cfg(target_arch = "wasm32")]
pub fn save_picture(viewer: &Viewer) {
    let teller = viewer.jobs.teller();
    viewer.stage.copy(move |size, pixels| {
        let saved = crate::screenshot::png(size, &pixels)
            .and_then(|png| crate::web::download("relume.png", &png));
        if let Err(error) = saved {
            teller.tell(Event::Failed(error));
        }
    });
}

/// Saves the lamps as an emitters.json.
pub fn save_emitters(viewer: &Viewer) {
    let teller = viewer.jobs.teller();
    let text = match viewer.near.to_json() {
        Ok(text) => text,
        Err(error) => return teller.tell(Event::Failed(error)),
    };
    #[cfg(not(target_arch = "wasm32"))]
    save(&viewer.jobs, "emitters.json".to_owned(), move |path| {
        use std::io::Write;
        relume::files::write_atomically(path, |writer| writer.write_all(text.as_bytes())).map_err(
            |error| {
                let shown = relume::files::printable(&path.to_string_lossy());
                format!("{shown}: {error}")
            },
        )
    });
    #[cfg(target_arch = "wasm32")]
    if let Err(error) = crate::web::download("emitters.json", text.as_bytes()) {
        teller.tell(Event::Failed(error));
    }
}
