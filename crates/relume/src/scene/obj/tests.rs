use std::path::Path;

use glam::{Vec2, Vec3};

use super::super::{ImportOptions, load};
use super::*;

fn import(folder: &Path, text: &[u8]) -> Result<Scene, SceneError> {
    let path = folder.join("a.obj");
    std::fs::write(&path, text).unwrap();
    load(&path, &ImportOptions::default())
}

fn import_text(text: &str) -> Result<Scene, SceneError> {
    import(tempfile::tempdir().unwrap().path(), text.as_bytes())
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn positions_come_first_and_seams_after_in_order_of_use() {
    let text = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0.25\nvn 0 0 2\nvn 0 1 0\n\
                f 4/1/1 3/1/1 2/2/1\nf 2/1/1 4/1/1 5/1/1\nf 4/1/2 3/1/1 2/1/1\n";
    let scene = import_text(text).unwrap();
    let mesh = &scene.meshes[0];
    // Position 2 was first met with coordinate 2; (2, 1, 1) and (4, 1, 2) are seams, in that order.
    assert_eq!(mesh.positions.len(), 7);
    assert_eq!(mesh.positions[0], Vec3::splat(9.0));
    assert_eq!(mesh.normals[0], Vec3::Y);
    assert_eq!(mesh.positions[5..], [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)]);
    assert_eq!(mesh.uvs[1], Vec2::new(1.0, 0.75));
    assert_eq!(mesh.uvs[5], Vec2::new(0.0, 1.0));
    assert_eq!((mesh.normals[3], mesh.normals[6]), (Vec3::Z, Vec3::Y));
    assert_eq!(mesh.groups[0].triangles, [[3, 2, 1], [5, 3, 4], [6, 2, 5]]);
}

#[test]
fn everything_people_write_is_read() {
    let text = "\u{feff}# header\r\no  thing \r\n\
                v\t0 0 0 1.0\r\nv 1 0 0 # comment\r\nv 1e0 +1 -0\r\n  v 0 1 \\\r\n 0\r\n\
                g a b\r\ns off\r\nusemtl my paint\r\nf -4 -3 -2 -1 # all\r\nl 1 2\r\np 1\r\nvp 0 0\r\n\
                f 1// 2// 3//\r\nf 1/ 3/ \\\r\n4/";
    let scene = import_text(text).unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions.len(), 4);
    assert!(mesh.uvs.is_empty());
    assert_eq!(
        mesh.groups[0].triangles,
        [[0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 2, 3]]
    );
    assert_eq!(scene.materials[0].name, "my paint");
    assert_eq!(scene.materials[0].base_color, [0.5, 0.5, 0.5, 1.0]);
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.contains("no material is given for my paint"))
    );
}

#[test]
fn vertex_colours_are_linear_and_the_rest_is_white() {
    let text = "v 0 0 0\nv 1 0 0 0.25 0.5 1\nv 0 1 0 1 0.1 0.2 0.3\nv 1 1 0\nf 1 2 3\nf 2 4 3\n";
    let scene = import_text(text).unwrap();
    let expected = [[1.0; 3], [0.25, 0.5, 1.0], [0.1, 0.2, 0.3], [1.0; 3]];
    assert_eq!(scene.meshes[0].colors, expected);
    assert_eq!(scene.materials[0].base_color, [1.0; 4]);
}

#[test]
fn a_seam_in_texture_coordinates_does_not_split_the_shading() {
    let roof = "v 0 0 0\nv 0 0 1\nv 1 1 0\nv 1 1 1\nv 2 0 0\nv 2 0 1\nvt 0 0\nvt 1 1\n\
                f 1/1 2/1 4/1 3/1\nf 3/2 4/2 6/2 5/2\n";
    let mesh = &import_text(roof).unwrap().meshes[0];
    assert_eq!(mesh.positions.len(), 8);
    assert_eq!(
        (mesh.positions[2], mesh.normals[2]),
        (mesh.positions[6], mesh.normals[6])
    );
    assert!((mesh.normals[2] - Vec3::Y).length() < 1e-6);
}

#[test]
fn bad_lines_are_named() {
    for (text, expected) in [
        ("v 0 0\n", "line 1: v has 2 numbers; it needs 3"),
        (
            "\nv 0 0 x\u{1b}\n",
            "line 2: v has \"x\\u{1b}\" where a number belongs",
        ),
        ("vn 1\n", "line 1: vn has 1 numbers; it needs 3"),
        (
            "v 0 0 0\nf 1 1\n",
            "line 2: a face has 2 corners; it needs 3",
        ),
        (
            "v 0 0 0\nf 1 1 2\n",
            "line 2: a face names position 2, but there are 1",
        ),
        (
            "v 0 0 0\nf 1/1 1/1 1/1\n",
            "line 2: a face names texture coordinate 1, but there are 0",
        ),
        (
            "v 0 0 0\nf 1 1 0\n",
            "line 2: index 0 in a face; OBJ counts from 1",
        ),
        (
            "v 0 0 0\nf 1 1 -2\n",
            "line 2: \"-2\" names what is not there",
        ),
        (
            "v 0 0 0\nf 1 1 4294967296\n",
            "line 2: \"4294967296\" names what is not there",
        ),
        (
            "v 0 0 0\nf 1 1 99999999999999999999\n",
            "is not a corner of a face",
        ),
        ("v 0 0 0\nf 1 1 1/1/1/1\n", "is not a corner of a face"),
        (
            "v 0 0 0\nv 1 nan 0\nf 1 2 1\n",
            "position of vertex 1 is not a finite number",
        ),
        (
            "v 0 0 0\nv 1 1e99 0\nf 1 2 1\n",
            "position of vertex 1 is not a finite number",
        ),
    ] {
        let message = import_text(text).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn libraries_and_textures_are_found_beside_the_file_only() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("scene");
    std::fs::create_dir_all(inner.join("my maps")).unwrap();
    std::fs::write(folder.path().join("out.mtl"), "newmtl a\n").unwrap();
    std::fs::write(
        inner.join("my lib.mtl"),
        "newmtl a\nKd 1 0.5 0.25\nmap_Kd my maps\\t.png\nd 0.5\n",
    )
    .unwrap();
    std::fs::write(
        inner.join("b.mtl"),
        "newmtl a\nKd 0 0 0\nnewmtl b\nKd 0.5 0 0\nmap_Kd gone.png\n",
    )
    .unwrap();
    std::fs::write(inner.join("bad.mtl"), "newmtl a\nmap_Kd ../../secret.png\n").unwrap();
    let faces = "usemtl b\nf 1 2 3\nusemtl a\nf 1 3 4\n";
    let with = |lines: &str| import(&inner, format!("{lines}\n{SQUARE}{faces}").as_bytes());

    #[cfg(feature = "images")]
    {
        image::RgbImage::from_pixel(2, 3, image::Rgb([10, 20, 30]))
            .save(inner.join("my maps/t.png"))
            .unwrap();
        let scene = with("mtllib my lib.mtl\nmtllib b.mtl none.mtl").unwrap();
        let names: Vec<_> = scene.materials.iter().map(|m| m.name.as_str()).collect();
        assert_eq!(names, ["b", "a"]);
        // The first library that has a material counts.
        assert_eq!(scene.materials[1].base_color, [1.0, 0.5, 0.25, 1.0]);
        assert_eq!(scene.materials[1].base_color_texture, Some(0));
        assert_eq!((scene.textures[0].width, scene.textures[0].height), (2, 3));
        assert_eq!(scene.textures[0].texels[5], [10, 20, 30, 255]);
        for said in ["none.mtl", "gone.png", "1 materials are transparent"] {
            assert!(
                scene.warnings.iter().any(|w| w.contains(said)),
                "{:?}",
                scene.warnings
            );
        }
        std::fs::write(inner.join("my maps/t.png"), b"\x89PNG\r\n\x1a\nrubbish").unwrap();
        let message = with("mtllib my lib.mtl").unwrap_err().to_string();
        assert!(message.contains("cannot be decoded"), "{message}");
        std::fs::write(inner.join("my maps/t.png"), b"BM").unwrap();
        let message = with("mtllib my lib.mtl").unwrap_err().to_string();
        assert!(message.contains("neither PNG nor JPEG"), "{message}");
    }
    for bad in [
        "mtllib ../out.mtl",
        "mtllib /etc/passwd",
        "mtllib C:\\x.mtl",
        "mtllib bad.mtl",
    ] {
        let message = with(bad).unwrap_err().to_string();
        assert!(message.contains("refers to"), "{message}");
    }
}
