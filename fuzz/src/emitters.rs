//! Emitters from files.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use glam::DVec3;
use relume::basis::Order;
use relume::light::emitter::{self, ClosedForm, Emitters, Sampler};
use tempfile::TempDir;

use crate::check_message;

/// Sets of more polygons are only read: what they light is found pair by pair.
const FEW: usize = 64;

/// An emitters.json, with a mesh `m.obj` and an image `t.pfm` beside it.
pub fn emitters_json(bytes: &[u8]) {
    let (emitters, warnings) = match emitter::from_json(bytes, folder()) {
        Ok(read) => read,
        Err(error) => return check_message(&error),
    };
    for warning in &warnings {
        assert!(!warning.contains(char::is_control), "{warning:?}");
    }
    check_light(&emitters);
}

/// Files that an emitters.json may name.
fn folder() -> &'static Path {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a folder");
        let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
        let texels = [0.0_f32, 1.0, 2.0, 3.0, 4.0, 5.0].map(f32::to_le_bytes);
        let pfm = [b"PF\n2 1\n-1.0\n".as_slice(), &texels.concat()].concat();
        fs::write(folder.path().join("m.obj"), obj).expect("written");
        fs::write(folder.path().join("t.pfm"), pfm).expect("written");
        folder
    });
    folder.path()
}

/// What was read stands in the world, shines no more than it may, and is met by rays where it stands.
fn check_light(emitters: &Emitters) {
    assert!(!emitters.emitters().is_empty());
    let placed = emitters.placed();
    assert!(!placed.polygons().is_empty() || !placed.spheres().is_empty());
    for polygon in placed.polygons() {
        assert!(polygon.centre.is_finite() && polygon.radius.is_finite());
        assert!((polygon.normal.length() - 1.0).abs() < 1e-6);
    }
    if placed.polygons().len() > FEW {
        return;
    }
    let point = DVec3::new(0.3, -0.2, 0.7);
    let incident = ClosedForm::new(Order::new(3).expect("an order")).sample(&placed, point);
    let coefficients = incident.coefficients.iter().flatten();
    assert!(coefficients.copied().all(f64::is_finite));
    assert!(incident.solid_angle.is_finite() && incident.inverse_distance.is_finite());
    for direction in [DVec3::X, DVec3::NEG_Y, DVec3::new(1.0, 2.0, -3.0)] {
        let met = placed.first_hit(point, direction);
        assert!(
            met.is_none_or(|hit| hit.distance > 0.0 && hit.radiance.iter().all(|x| x.is_finite()))
        );
    }
}
