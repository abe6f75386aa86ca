//! What keys and pointer do.

use eframe::egui;

/// Each way to do something, and what it does.
const KEYS: [(&str, &str); 19] = [
    ("drag", "turn the scene (orbit) or the view (fly)"),
    ("Shift + drag", "turn the light"),
    ("right drag, two fingers", "move across the picture"),
    ("wheel, pinch", "come closer"),
    ("arrow keys", "turn the scene or the view"),
    ("Shift + arrow keys", "turn the light"),
    ("W A S D Q E", "fly"),
    ("+  −", "come closer, go away"),
    ("[  ]", "fewer bands, more bands"),
    (",  .", "darker, brighter"),
    ("1 2 3", "unshadowed, shadowed, as baked"),
    ("click", "select a near light; drag its handles"),
    (
        "G T X Del",
        "move, turn, scale the near light; take it away",
    ),
    ("B", "background"),
    ("L", "wireframe"),
    ("R", "reset the camera"),
    ("O", "open a file"),
    ("F2", "panels"),
    ("F1", "this page"),
];

/// A window with the list.
pub fn show(open: &mut bool, context: &egui::Context) {
    egui::Window::new("Keys")
        .open(open)
        .resizable(false)
        .show(context, |ui| {
            egui::Grid::new("keys")
                .num_columns(2)
                .striped(true)
                .show(ui, |ui| {
                    for (key, what) in KEYS {
                        ui.strong(key);
                        ui.label(what);
                        ui.end_row();
                    }
                });
        });
}
