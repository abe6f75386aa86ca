use super::*;

/// A pyramid over a square (one quad, four triangles) with everything a vertex can have.
const HEADER: &str = "element vertex 5\nproperty double x\nproperty float y\nproperty float z\n\
    property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n\
    element extra 1\nproperty list uchar float weights\nproperty short flag\n\
    element face 5\nproperty uchar flags\nproperty list uchar int vertex_indices\nend_header\n";
const POSITIONS: [[f32; 3]; 5] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 0.0, 1.0],
    [0.0, 0.0, 1.0],
    [0.5, 1.0, 0.5],
];
const FACES: [&[u32]; 5] = [
    &[0, 1, 2, 3],
    &[1, 0, 4],
    &[2, 1, 4],
    &[3, 2, 4],
    &[0, 3, 4],
];

fn ascii() -> Vec<u8> {
    let mut text = format!("ply\nformat ascii 1.0\ncomment made by hand\n{HEADER}");
    for [x, y, z] in POSITIONS {
        text += &format!("{x} {y} {z} 0 1 0 0.25 0.75 255 0 188 7\n");
    }
    text += "2 0.5 0.5 -3\n";
    for face in FACES {
        let indices: Vec<String> = face.iter().map(u32::to_string).collect();
        text += &format!("1 {} {}\n", face.len(), indices.join(" "));
    }
    text.into_bytes()
}

fn binary(big: bool) -> Vec<u8> {
    let order = |mut bytes: Vec<u8>| {
        if big {
            bytes.reverse();
        }
        bytes
    };
    let name = if big { "big" } else { "little" };
    let mut out = format!("ply\nformat binary_{name}_endian 1.0\n{HEADER}").into_bytes();
    for [x, y, z] in POSITIONS {
        out.extend(order(f64::from(x).to_le_bytes().to_vec()));
        for value in [y, z, 0.0, 1.0, 0.0, 0.25, 0.75] {
            out.extend(order(value.to_le_bytes().to_vec()));
        }
        out.extend([255, 0, 188, 7]);
    }
    out.push(2);
    out.extend(order(0.5f32.to_le_bytes().to_vec()));
    out.extend(order(0.5f32.to_le_bytes().to_vec()));
    out.extend(order((-3i16).to_le_bytes().to_vec()));
    for face in FACES {
        out.extend([1, face.len() as u8]);
        for index in face {
            out.extend(order(index.to_le_bytes().to_vec()));
        }
    }
    out
}

#[test]
fn all_encodings_give_the_same_mesh() {
    for bytes in [ascii(), binary(false), binary(true)] {
        let scene = read(&bytes).unwrap();
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.positions, POSITIONS.map(Vec3::from));
        assert_eq!(mesh.normals, [Vec3::Y; 5]);
        assert_eq!(mesh.uvs, [Vec2::new(0.25, 0.25); 5]);
        // 8-bit colours are sRGB: code 188 is half of the light.
        let [r, g, b] = mesh.colors[0];
        assert_eq!((r, g), (1.0, 0.0));
        assert!((b - 0.5).abs() < 5e-3);
        assert_eq!(
            mesh.groups[0].triangles,
            [
                [0, 1, 2],
                [0, 2, 3],
                [1, 0, 4],
                [2, 1, 4],
                [3, 2, 4],
                [0, 3, 4]
            ]
        );
        assert_eq!(scene.materials[0].base_color, [1.0; 4]);
        assert!(scene.warnings.is_empty());
    }
}

fn small(vertex: &str, faces: &str, body: &str) -> Result<Scene, SceneError> {
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    read(format!("ply\nformat ascii 1.0\n{faces}{vertex}{xyz}end_header\n{body}").as_bytes())
}

#[test]
fn strips_faces_before_vertices_and_defaults() {
    let strips = "element tristrips 1\nproperty list int int vertex_indices\n";
    let vertices = "element vertex 4\n";
    let corners = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    let scene = small(vertices, strips, &format!("8 0 1 2 3 -1 0 2 1\n{corners}")).unwrap();
    let expected = [[0, 1, 2], [1, 3, 2], [0, 2, 1]];
    assert_eq!(scene.meshes[0].groups[0].triangles, expected);
    assert_eq!(scene.materials[0].base_color, [0.5, 0.5, 0.5, 1.0]);
    assert!(scene.warnings[0].contains("albedo is 0.5"));
    let faces = "element face 1\nproperty list uchar uint vertex_index\n";
    let scene = small(vertices, faces, &format!("3 0 1 2\n{corners}")).unwrap();
    assert_eq!(scene.triangle_count(), 1);
    assert_eq!(scene.meshes[0].normals[0], Vec3::Z);
}

#[test]
fn float_colours_are_linear() {
    let vertex =
        "element vertex 3\nproperty float red\nproperty float green\nproperty float blue\n";
    let faces = "element face 1\nproperty list uchar int vertex_index\n";
    let body = "3 0 1 2\n0.5 0.25 1 0 0 0\n0.5 0.25 1 1 0 0\n0.5 0.25 1 0 1 0\n";
    let scene = small(vertex, faces, body).unwrap();
    assert_eq!(scene.meshes[0].colors, [[0.5, 0.25, 1.0]; 3]);
}

#[test]
fn headers_are_not_believed() {
    let face = "element face 1\nproperty list uchar int vertex_indices\n";
    let huge = "element vertex 4000000000\n";
    let message = small(huge, face, "3 0 0 0\n").unwrap_err().to_string();
    assert!(
        message.contains("its header announces at least"),
        "{message}"
    );
    let endless = "element nothing 18446744073709551615\n";
    for (vertex, before, body, expected) in [
        (
            "element vertex 1\n",
            endless,
            "0 0 0\n",
            "have no properties",
        ),
        (
            "element vertex 2\n",
            face,
            "3 0 0 0\n0 0 0\n",
            "Unexpected end of file",
        ),
        (
            "element vertex 1\n",
            face,
            "3 0 0 1\n0 0 0\n",
            "face 0 (counted from 0) names vertex 1",
        ),
        (
            "element vertex 1\n",
            face,
            "3 0 0 -1\n0 0 0\n",
            "names vertex -1",
        ),
        (
            "element vertex 1\n",
            face,
            "255 0 0 0\n0 0 0\n",
            "found only 3",
        ),
        (
            "element vertex 1\n",
            face,
            "3 0 0 0\n0 x 0\n",
            "write the PLY file again",
        ),
        (
            "element vertex 1\nproperty list uchar int q\n",
            face,
            "3 0 0 0\n",
            "header announces",
        ),
    ] {
        let message = small(vertex, before, body).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
        assert!(!message.contains(['\n', '\t']), "{message}");
    }
}

#[test]
fn what_is_cut_off_or_no_mesh_is_refused() {
    let cut = &binary(false)[..binary(false).len() - 3];
    let message = read(cut).unwrap_err().to_string();
    assert!(message.contains("Unexpected end of file"), "{message}");
    assert!(read(b"ply\nformat ascii 1.0\nend_header\n").is_err());
    assert!(read(b"ply\nformat middle_endian 1.0\nend_header\n").is_err());
    assert!(read(b"ply\n").is_err());
}

#[test]
fn every_cut_and_flipped_byte_is_an_error_or_a_mesh() {
    for good in [ascii(), binary(false)] {
        for at in 0..good.len() {
            let _ = read(&good[..at]);
            for flip in [1u8, 0x10, 0x80] {
                let mut bad = good.clone();
                bad[at] ^= flip;
                if let Err(error) = read(&bad) {
                    assert!(!error.to_string().contains('\n'), "{error}");
                }
            }
        }
    }
}
