//! A scene that takes its time: hills, and slabs of three colours over them.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;
use std::{fs, io};

pub const OBJ: &str = "scene.obj";
pub const MTL: &str = "scene.mtl";
/// Vertices along a side of the hills.
const SIDE: usize = 160;
/// Slabs.
const SLABS: usize = 9;

/// Writes the scene into a folder.
pub fn write(folder: &Path) -> io::Result<()> {
    let materials = "newmtl hill\nKd 0.7 0.7 0.6\nnewmtl slab0\nKd 0.8 0.2 0.1\nnewmtl slab1\nKd 0.1 0.6 0.2\nnewmtl slab2\nKd 0.2 0.3 0.8\n";
    fs::write(folder.join(MTL), materials)?;
    fs::write(folder.join(OBJ), obj())
}

fn obj() -> String {
    let mut text = format!("mtllib {MTL}\nusemtl hill\n");
    let place = |i: usize| i as f64 / (SIDE - 1) as f64;
    for (x, z) in (0..SIDE * SIDE).map(|i| (place(i % SIDE), place(i / SIDE))) {
        let y = 0.04 * (5.0 * TAU * x).sin() * (4.0 * TAU * z).cos()
            + 0.01 * (23.0 * TAU * (x + z)).sin();
        let _ = writeln!(text, "v {x:.6} {y:.6} {z:.6}");
    }
    for (column, row) in (0..(SIDE - 1) * (SIDE - 1)).map(|i| (i % (SIDE - 1), i / (SIDE - 1))) {
        let corner = row * SIDE + column + 1;
        let _ = writeln!(
            text,
            "f {} {} {} {}",
            corner,
            corner + SIDE,
            corner + SIDE + 1,
            corner + 1
        );
    }
    for slab in 0..SLABS {
        let (x, z) = (0.1 + 0.3 * (slab % 3) as f64, 0.1 + 0.3 * (slab / 3) as f64);
        for y in [0.09, 0.12] {
            for (dx, dz) in [(0.0, 0.0), (0.0, 0.15), (0.15, 0.15), (0.15, 0.0)] {
                let _ = writeln!(text, "v {:.6} {y:.6} {:.6}", x + dx, z + dz);
            }
        }
        let _ = writeln!(text, "usemtl slab{}", slab % 3);
        // Counted from the end: four below, four above.
        text.push_str("f -4 -3 -2 -1\nf -8 -5 -6 -7\nf -8 -7 -3 -4\nf -7 -6 -2 -3\nf -6 -5 -1 -2\nf -5 -8 -4 -1\n");
    }
    text
}
