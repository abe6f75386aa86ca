//! Every key, and what it means.

use glam::{DAffine3, DVec3};

use super::*;
use crate::light::emitter::Shape;

#[cfg(feature = "import")]
fn mesh(emitter: &Emitter) -> &EmitterMesh {
    match &emitter.shape {
        Shape::Mesh(mesh) => mesh,
        Shape::Sphere { .. } => panic!("a mesh"),
    }
}

#[test]
fn every_shape_is_read() {
    let shape = |key: &str, value: Value| one(&json!({(key): value, "radiance": 1})).shape;
    let blocks = json!({"columns": 3, "rows": 2, "size": [3, 2], "fill": 0.5});
    for (read, made) in [
        (shape("quad", json!([2, 0.5])), EmitterMesh::quad(2.0, 0.5)),
        (shape("disc", json!(0.25)), EmitterMesh::disc(0.25)),
        (
            shape("box", json!([1, 2, 3])),
            EmitterMesh::cuboid(DVec3::new(1.0, 2.0, 3.0)),
        ),
        (
            shape("blocks", blocks),
            EmitterMesh::blocks(3, 2, 3.0, 2.0, 0.5),
        ),
        (
            shape("blocks", json!({"columns": 1, "rows": 4, "size": [1, 2]})),
            EmitterMesh::blocks(1, 4, 1.0, 2.0, 1.0),
        ),
    ] {
        assert_eq!(read, Shape::Mesh(made));
    }
    assert_eq!(shape("sphere", json!(3)), Shape::Sphere { radius: 3.0 });
}

#[test]
fn radiance_is_a_grey_a_colour_or_one_for_each_face_or_corner() {
    let pattern = |key: &str, value: Value| one(&json!({"box": [1, 1, 1], (key): value})).pattern;
    assert_eq!(pattern("radiance", json!(2.5)), Pattern::Uniform([2.5; 3]));
    assert_eq!(pattern("radiance", json!(0)), Pattern::Uniform([0.0; 3]));
    assert_eq!(
        pattern("radiance", json!([1, 2, 3])),
        Pattern::Uniform([1.0, 2.0, 3.0])
    );
    let rows =
        |count: usize| -> Vec<[f32; 3]> { (0..count).map(|i| [i as f32, 0.5, 0.0]).collect() };
    assert_eq!(
        pattern("radiance", json!(rows(6))),
        Pattern::PerFace(rows(6))
    );
    assert_eq!(
        pattern("vertexRadiance", json!(rows(8))),
        Pattern::PerVertex(rows(8))
    );
}

#[test]
fn faces_of_a_box_and_blocks_come_in_the_order_of_the_documentation() {
    // Box: −x, +x, −y, +y, −z, +z. The face that a ray from outside along an axis meets says which it is.
    let rows: Vec<[f32; 3]> = (0..6).map(|i| [i as f32; 3]).collect();
    let entry = json!({"emitters": [{"box": [2, 4, 6], "radiance": rows}]}).to_string();
    let (cube, _) = from_json(entry.as_bytes(), Path::new("")).unwrap();
    let placed = cube.placed();
    for (i, axis) in DVec3::AXES.into_iter().enumerate() {
        for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
            let hit = placed.first_hit(9.0 * sign * axis, -sign * axis).unwrap();
            assert_eq!(hit.radiance[0], (2 * i + side) as f32);
        }
    }
    // Blocks, 2 × 2: row after row from the top; seen from +z, the first is on the left.
    let rows = [[1, 0, 0], [2, 0, 0], [3, 0, 0], [4, 0, 0]];
    let blocks = json!({"columns": 2, "rows": 2, "size": [2, 2]});
    let entry = json!({"emitters": [{"blocks": blocks, "radiance": rows}]}).to_string();
    let (matrix, _) = from_json(entry.as_bytes(), Path::new("")).unwrap();
    let placed = matrix.placed();
    for (x, y, red) in [
        (-0.5, 0.5, 1.0),
        (0.5, 0.5, 2.0),
        (-0.5, -0.5, 3.0),
        (0.5, -0.5, 4.0),
    ] {
        let hit = placed.first_hit(DVec3::new(x, y, 1.0), DVec3::NEG_Z);
        assert_eq!(hit.unwrap().radiance[0], red);
    }
}

#[test]
fn what_is_not_said_has_its_default_and_what_is_said_holds() {
    let plain = one(&json!({"disc": 1, "radiance": 1}));
    assert_eq!(plain.name, "emitter 0");
    assert!(!plain.two_sided);
    assert_eq!(plain.exponent, 0);
    assert_eq!(plain.world_from_emitter, DAffine3::IDENTITY);
    let all =
        one(&json!({"name": "screen", "disc": 1, "radiance": 1, "twoSided": true, "exponent": 8}));
    assert_eq!(
        (all.name.as_str(), all.two_sided, all.exponent),
        ("screen", true, 8)
    );
}

#[test]
fn a_texture_is_an_image_beside_the_file_times_its_factor() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("images")).unwrap();
    std::fs::write(folder.path().join("images/two.pfm"), pfm()).unwrap();
    let text = json!({"emitters": [
        {"quad": [2, 1], "texture": "images/two.pfm"},
        {"disc": 1, "texture": "./images/two.pfm", "radiance": [2, 1, 0]},
    ]});
    let (set, warnings) = from_json(text.to_string().as_bytes(), folder.path()).unwrap();
    assert_eq!(warnings, [""; 0]);
    let [quad, disc] = set.emitters() else {
        panic!("two")
    };
    let (
        Pattern::Texture { image, factor },
        Pattern::Texture {
            image: other,
            factor: coloured,
        },
    ) = (&quad.pattern, &disc.pattern)
    else {
        panic!("textures")
    };
    assert_eq!(image.pixels(), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    assert_eq!((factor, coloured), (&[1.0; 3], &[2.0, 1.0, 0.0]));
    assert!(
        std::sync::Arc::ptr_eq(image, other),
        "one file is decoded once"
    );
}

#[cfg(feature = "images")]
#[test]
fn eight_bit_images_are_linearised_and_said_to_be_dim() {
    let folder = tempfile::tempdir().unwrap();
    // sRGB 188 is a half: ((188/255 + 0.055) / 1.055)^2.4 = 0.5029.
    let grey = image::RgbImage::from_pixel(1, 1, image::Rgb([188, 255, 0]));
    grey.save(folder.path().join("grey.png")).unwrap();
    let entry = json!({"quad": [1, 1], "texture": "grey.png"});
    let (set, warnings) = in_folder(folder.path(), &entry).unwrap();
    let Pattern::Texture { image, .. } = &set.emitters()[0].pattern else {
        panic!("a texture")
    };
    let [r, g, b] = image.pixel(0, 0);
    assert!((r - 0.5029).abs() < 1e-4 && g == 1.0 && b == 0.0);
    assert!(warnings[0].starts_with("grey.png: ") && warnings[0].contains("not HDR"));
}

#[cfg(feature = "import")]
#[test]
fn a_mesh_is_a_scene_file_beside_it_with_its_texture_coordinates_where_they_are_wanted() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lamp.obj"), OBJ).unwrap();
    std::fs::write(folder.path().join("two.pfm"), pfm()).unwrap();
    let (set, warnings) =
        in_folder(folder.path(), &json!({"mesh": "lamp.obj", "radiance": 3})).unwrap();
    let shape = mesh(&set.emitters()[0]);
    assert_eq!(shape.faces, [vec![0, 1, 2], vec![0, 2, 3]]);
    assert_eq!(shape.positions[2], DVec3::new(2.0, 2.0, 0.0));
    assert!(shape.uvs.is_empty());
    // What is said of its albedo does not matter to a lamp.
    assert_eq!(
        warnings,
        ["lamp.obj: 1 triangles without area were left out"]
    );

    let entry = json!({"mesh": "lamp.obj", "texture": "two.pfm"});
    let (set, _) = in_folder(folder.path(), &entry).unwrap();
    // v of OBJ runs up.
    assert_eq!(mesh(&set.emitters()[0]).uvs[0], glam::Vec2::new(0.0, 1.0));

    let colours: Vec<[f32; 3]> = (0..4).map(|i| [i as f32; 3]).collect();
    let entry = json!({"mesh": "lamp.obj", "vertexRadiance": colours});
    let (set, _) = in_folder(folder.path(), &entry).unwrap();
    assert_eq!(set.emitters()[0].pattern, Pattern::PerVertex(colours));
}

#[test]
fn a_file_on_disk_finds_its_images_and_warns_in_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("emitters.json");
    // Negative light is none, which is said.
    let mut image = pfm();
    let end = image.len();
    image[end - 4..].copy_from_slice(&(-1.0_f32).to_le_bytes());
    std::fs::write(folder.path().join("two.pfm"), image).unwrap();
    let text = json!({"emitters": [{"quad": [1, 1], "texture": "two.pfm"}]});
    std::fs::write(&path, format!("\u{feff}{text}")).unwrap();
    let (_, warnings) = load(&path).unwrap();
    let begin = format!("{}: two.pfm: 1 of 2 pixels", path.display());
    assert!(warnings[0].starts_with(&begin), "{warnings:?}");
}
