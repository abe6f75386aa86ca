use super::*;
use crate::basis::Order;
use crate::light::{Layout, ShLight};

fn spec(path: &Path) -> EnvSpec {
    EnvSpec::File(path.to_owned())
}

fn pfm(width: usize, height: usize, value: f32) -> Vec<u8> {
    let mut bytes = format!("PF\n{width} {height}\n-1\n").into_bytes();
    for _ in 0..width * height * 3 {
        bytes.extend(value.to_le_bytes());
    }
    bytes
}

#[test]
fn files_are_known_by_content_not_by_name() {
    let folder = tempfile::tempdir().unwrap();
    // An image named .json and a light.json named .hdr.
    let image = folder.path().join("image.json");
    std::fs::write(&image, pfm(4, 2, 0.5)).unwrap();
    let (environment, warnings) = load(&spec(&image), &LightOptions::default()).unwrap();
    assert!(warnings.is_empty());
    let light = environment.project(Order::new(2).unwrap());
    let mean = 0.5 * (4.0 * std::f32::consts::PI).sqrt();
    assert!((light.coefficients()[0][1] - mean).abs() < 1e-6);
    let json = folder.path().join("light.hdr");
    let file = LightFile {
        light,
        window: crate::basis::Window::None,
    };
    std::fs::write(&json, format!("\u{feff} {}", file.to_json())).unwrap();
    let (read, _) = load(&spec(&json), &LightOptions::default()).unwrap();
    assert_eq!(read, Environment::Sh(file.light));
}

#[test]
fn layouts_and_turns_of_the_options_are_used() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("square.pfm");
    std::fs::write(&path, pfm(4, 4, 1.0)).unwrap();
    let mut options = LightOptions::default();
    let layout = |options: &LightOptions| match load(&spec(&path), options).unwrap().0 {
        Environment::Map(map) => map.layout(),
        other => panic!("{other:?}"),
    };
    assert_eq!(layout(&options), Layout::Angular);
    options.layout = Layout::LatLong.into();
    assert_eq!(layout(&options), Layout::LatLong);
    options.layout = Layout::VCross.into();
    let error = load(&spec(&path), &options).unwrap_err().to_string();
    assert!(
        error.contains("square.pfm") && error.contains("vcross"),
        "{error}"
    );

    // A quarter turn about +Y brings light from +Z to +X.
    let turned = LightOptions {
        turns: vec!["0,1,0:90".parse().unwrap()],
        ..LightOptions::default()
    };
    let sun = "sun:0,0,1,5,1,1,1".parse().unwrap();
    let (environment, _) = load(&sun, &turned).unwrap();
    assert_eq!(environment.radiance(glam::Vec3::X), [1.0; 3]);
    assert_eq!(environment.radiance(glam::Vec3::Z), [0.0; 3]);
    let constant = "constant:1,2,3".parse().unwrap();
    let (environment, _) = load(&constant, &turned).unwrap();
    assert_eq!(environment, Environment::Constant([1.0, 2.0, 3.0]));
}

#[test]
fn what_cannot_be_read_is_said_on_one_line_with_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let mut nan = pfm(4, 2, 1.0);
    let end = nan.len();
    // The last number of the file: blue of the right pixel of the top row.
    nan[end - 4..].copy_from_slice(&f32::NAN.to_le_bytes());
    for (path, needle) in [
        (folder.path().join("none.hdr"), "none.hdr"),
        (folder.path().to_owned(), "not a regular file"),
        (file("text.hdr", b"hello"), "text.hdr: not an image"),
        (file("nan.pfm", &nan), "pixel (3, 0)"),
        (file("odd.pfm", &pfm(5, 2, 1.0)), "5 × 2"),
        (file("bad.json", b"{\"basis\": \"sh\"}"), "missing"),
        (file("cut.json", b"{\"basis\": \"sh\""), "not valid JSON"),
        (file("empty.pfm", b""), "not an image"),
        (folder.path().join("new\nline"), "new\\nline"),
    ] {
        let message = load(&spec(&path), &LightOptions::default())
            .unwrap_err()
            .to_string();
        assert!(message.contains(needle), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

#[test]
fn negative_pixels_are_warned_about_with_the_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dark.pfm");
    std::fs::write(&path, pfm(2, 1, -1.0)).unwrap();
    let (environment, warnings) = load(&spec(&path), &LightOptions::default()).unwrap();
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].contains("dark.pfm") && warnings[0].contains("2 of 2 pixels"));
    let light = environment.project(Order::new(1).unwrap());
    assert_eq!(light, ShLight::new(Order::new(1).unwrap(), vec![[0.0; 3]]));
}

#[test]
fn six_files_are_a_cube_and_what_does_not_go_with_them_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for (i, face) in ["px", "nx", "py", "ny", "pz", "nz"].iter().enumerate() {
        std::fs::write(path(&format!("sky_{face}.pfm")), pfm(4, 4, i as f32)).unwrap();
    }
    let pattern = path("sky_{px,nx,py,ny,pz,nz}.pfm");
    let spec: EnvSpec = pattern.to_str().unwrap().parse().unwrap();
    let load_it = |layout| {
        load(
            &spec,
            &LightOptions {
                layout,
                turns: Vec::new(),
            },
        )
    };
    let (environment, _) = load_it(LayoutChoice::Auto).unwrap();
    // pz is −Z, nz is +Z.
    assert_eq!(environment.radiance(glam::Vec3::Y), [2.0; 3]);
    assert_eq!(environment.radiance(glam::Vec3::NEG_Z), [4.0; 3]);
    assert_eq!(environment.radiance(glam::Vec3::Z), [5.0; 3]);
    let wrapped = load_it(Layout::LatLong.into()).unwrap_err().to_string();
    assert!(wrapped.contains("leave --layout out"), "{wrapped}");
    for (bytes, part) in [
        (pfm(4, 2, 0.0), "squares"),
        (pfm(2, 2, 0.0), "sky_px.pfm is 4"),
        (b"text".to_vec(), "not an image"),
    ] {
        std::fs::write(path("sky_ny.pfm"), bytes).unwrap();
        let error = load_it(LayoutChoice::Auto).unwrap_err().to_string();
        assert!(
            error.contains("sky_ny.pfm: ") && error.contains(part),
            "{error}"
        );
    }
    std::fs::remove_file(path("sky_ny.pfm")).unwrap();
    let error = load_it(LayoutChoice::Auto).unwrap_err().to_string();
    assert!(error.contains("sky_ny.pfm: "), "{error}");
}

#[test]
fn what_is_the_same_of_all_six_files_is_said_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let pattern = path("sky_{px,nx,py,ny,pz,nz}.pfm");
    let spec: EnvSpec = pattern.to_str().unwrap().parse().unwrap();
    for face in ["px", "nx", "py", "ny", "pz", "nz"] {
        std::fs::write(path(&format!("sky_{face}.pfm")), pfm(2, 2, -1.0)).unwrap();
    }
    let (_, warnings) = load(&spec, &LightOptions::default()).unwrap();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("{px,nx,py,ny,pz,nz}.pfm: 4 of 4 pixels"));
    std::fs::write(path("sky_nx.pfm"), pfm(2, 2, 1.0)).unwrap();
    let (_, warnings) = load(&spec, &LightOptions::default()).unwrap();
    assert_eq!(warnings.len(), 5);
    assert!(warnings[1].contains("sky_py.pfm: 4 of 4 pixels"));
}
