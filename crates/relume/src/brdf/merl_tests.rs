//! The reader of measured BRDFs, with tables made here.

use super::super::{Brdf, Lambert, Phong};
use super::*;

/// The bytes of a file whose entries are `value(half, difference, azimuth)`, each the index of an entry.
fn file(value: impl Fn([usize; 3]) -> [f64; 3]) -> Vec<u8> {
    let mut planes = [const { Vec::new() }; 3];
    for half in 0..90 {
        for difference in 0..90 {
            for azimuth in 0..180 {
                let entry = value([half, difference, azimuth]);
                for (plane, number) in planes.iter_mut().zip(entry) {
                    plane.extend(number.to_le_bytes());
                }
            }
        }
    }
    let header = SIZES.map(i32::to_le_bytes).concat();
    [header, planes.concat()].concat()
}

/// A pair of directions by the angles of their half and difference vectors.
fn pair(half: f64, difference: f64, azimuth: f64) -> (DVec3, DVec3) {
    // The half vector leans toward x: steepest descent from it lies in the plane of x and z.
    let (sine, cosine) = half.sin_cos();
    let (normal, tangent) = (
        DVec3::new(sine, 0.0, cosine),
        DVec3::new(cosine, 0.0, -sine),
    );
    let across = tangent * azimuth.cos() + DVec3::Y * azimuth.sin();
    let incident = normal * difference.cos() + across * difference.sin();
    (incident, 2.0 * incident.dot(normal) * normal - incident)
}

/// What a goniometer would make of `brdf`: its values in the middle of each entry.
pub fn measured(brdf: &Brdf) -> Merl {
    let bytes = file(|[half, difference, azimuth]| {
        let middle = |index: usize, size: f64| (index as f64 + 0.5) / size;
        let (incident, outgoing) = pair(
            FRAC_PI_2 * middle(half, 90.0).powi(2),
            FRAC_PI_2 * middle(difference, 90.0),
            PI * middle(azimuth, 180.0),
        );
        let value = brdf.eval(incident, outgoing).to_array();
        std::array::from_fn(|channel| value[channel] / SCALES[channel])
    });
    Merl::from_bytes(&bytes, "made here").unwrap()
}

#[test]
fn an_entry_is_found_by_its_half_and_difference_angles() {
    // Half angle 23°: 90 √(23/90) = 45.5. Difference angle 10.5°. Azimuth 33.3°, and, the directions exchanged, half a turn more.
    let bytes = file(|index| match index {
        [45, 10, 33] => [1500.0, 3000.0, -1.0],
        _ => [0.0; 3],
    });
    let brdf = Brdf::from(Merl::from_bytes(&bytes, "one entry").unwrap());
    let at = |half: f64, difference: f64, azimuth: f64| {
        let (a, b) = pair(
            half.to_radians(),
            difference.to_radians(),
            azimuth.to_radians(),
        );
        let (there, back) = (brdf.eval(a, b), brdf.eval(b, a));
        assert_eq!(there, back);
        there
    };
    // 1500/1500, 3000 · 1.15/1500, and nothing for what was not measured.
    let there = at(23.0, 10.5, 33.3);
    assert!(
        (there - DVec3::new(1.0, 2.3, 0.0)).length() < 1e-6,
        "{there}"
    );
    for elsewhere in [
        at(23.8, 10.5, 33.3),
        at(22.4, 10.5, 33.3),
        at(23.0, 9.9, 33.3),
        at(23.0, 11.1, 33.3),
        at(23.0, 10.5, 32.9),
        at(23.0, 10.5, 34.1),
    ] {
        assert_eq!(elsewhere, DVec3::ZERO);
    }
    // Turned about the normal it is the same.
    let turn = glam::DQuat::from_rotation_z(2.0);
    let (a, b) = pair(0.4014, 0.1833, 0.5812);
    assert_eq!(brdf.eval(turn * a, turn * b), there);
}

#[test]
fn a_measured_lambert_is_lambert() {
    let albedo = DVec3::new(0.9, 0.5, 0.1);
    let brdf = Brdf::from(measured(&Lambert { albedo }.into()));
    for (theta, phi) in [(0.0_f64, 0.0_f64), (0.7, 1.0), (1.3, -2.0)] {
        let (sine, cosine) = theta.sin_cos();
        let view = DVec3::new(sine * phi.cos(), sine * phi.sin(), cosine);
        let found = brdf.albedo(view);
        // Entries whose middle lies below the horizon were not measured: at most the outermost ring of them.
        assert!(
            (found - albedo).length() < 0.01 * albedo.length(),
            "{found}"
        );
    }
}

#[test]
fn a_measured_phong_is_phong_but_for_its_steps() {
    let phong = Brdf::from(Phong {
        diffuse: DVec3::splat(0.2),
        specular: DVec3::splat(0.5),
        exponent: 20.0,
    });
    let brdf = Brdf::from(measured(&phong));
    for view in [DVec3::Z, DVec3::new(0.6, 0.0, 0.8)] {
        let (found, expected) = (brdf.albedo(view).x, phong.albedo(view).x);
        // Between half angles of 0° and 45°, where the lobe is, there are some 60 steps; the middle of one is not its mean.
        assert!(
            (found - expected).abs() < 0.02 * expected,
            "{found} {expected}"
        );
    }
}

#[test]
fn a_file_of_the_database_is_read_from_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("made.binary");
    let bytes = file(|_| [1500.0 / PI; 3]);
    std::fs::write(&path, &bytes).unwrap();
    let merl = Merl::read(&path).unwrap();
    let value = merl.eval(DVec3::Z, DVec3::Z);
    assert!((value.x - 1.0 / PI).abs() < 1e-7, "{value}");
    std::fs::write(&path, &bytes[1..]).unwrap();
    assert!(matches!(Merl::read(&path), Err(MerlError::Length { .. })));
    let missing = Merl::read(&folder.path().join("none.binary"));
    assert!(matches!(missing, Err(MerlError::Read { .. })));
    assert!(matches!(
        Merl::read(folder.path()),
        Err(MerlError::NotAFile { .. })
    ));
}

#[test]
fn files_that_are_cut_lie_or_hold_no_numbers_are_refused_in_one_line() {
    let good = file(|_| [1.0; 3]);
    let message = |bytes: &[u8]| {
        let error = Merl::from_bytes(bytes, "worn\nsteel.binary").unwrap_err();
        let text = error.to_string();
        assert!(
            text.starts_with("worn\\nsteel.binary: ") && !text.contains('\n'),
            "{text}"
        );
        text
    };
    for end in [0, 5, 12, good.len() - 1] {
        assert!(message(&good[..end]).contains("34992012"));
    }
    assert!(message(&[&good[..], &[0]].concat()).contains("34992013 bytes"));
    let changed = |at: usize, new: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + new.len()].copy_from_slice(new);
        bytes
    };
    // Dimensions whose product would overflow, and the file's own in big endian.
    for size in [i32::MAX, -90, 90_i32.swap_bytes()] {
        assert!(message(&changed(0, &size.to_le_bytes())).contains("90 × 90 × 180"));
    }
    assert!(message(&changed(8, &360_i32.to_le_bytes())).contains("90 × 90 × 360"));
    let second_of_green = HEADER + 8 * (ENTRIES + 1);
    for number in [f64::NAN, f64::INFINITY, 1e300] {
        let text = message(&changed(second_of_green, &number.to_le_bytes()));
        assert!(text.contains("entry 1 of the green table"), "{text}");
    }
}
