//! PLY in its three encodings.

use super::bytes::{floats, patched};
use super::case::Case;

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
const FACES: &str = "property list uchar int vertex_indices\n";

/// A header of so many vertices and faces.
fn header(format: &str, vertices: &str, faces: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex {vertices}\n{XYZ}element face {faces}\n{FACES}end_header\n"
    )
}

fn ascii(body: &str) -> Vec<u8> {
    (header("ascii", "3", "1") + body).into_bytes()
}

fn binary(faces: &[u8]) -> Vec<u8> {
    let positions = floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
    let header = header("binary_little_endian", "3", "1").into_bytes();
    [header, positions, faces.to_vec()].concat()
}

pub fn cases() -> Vec<Case> {
    let mut cases = headers();
    cases.extend(bodies());
    cases.extend(tolerated());
    cases
}

fn headers() -> Vec<Case> {
    let text = |text: &str| text.as_bytes().to_vec();
    let claim = |vertices: &str, faces: &str| header("ascii", vertices, faces).into_bytes();
    [
        ("an empty file", vec![], "the file is empty"),
        ("text with another name", text("hello"), "text of another format"),
        ("the magic and no more", text("ply\n"), "PLY"),
        ("a header without an end", text("ply\nformat ascii 1.0\nelement vertex 1\n"), "PLY"),
        ("no format", text("ply\nelement vertex 1\nend_header\n"), "PLY"),
        ("a format nobody knows", text("ply\nformat morse 1.0\nend_header\n"), "PLY"),
        ("a version to come", text("ply\nformat ascii 9.0\nelement vertex 0\nend_header\n"), "vertex"),
        ("control characters in the header", text("ply\nformat ascii 1.0\n\u{1b}[31m\nend_header\n"), "\\u{1b}[31m"),
        ("no vertices", text("ply\nformat ascii 1.0\nend_header\n"), "no element \"vertex\""),
        ("vertices without z", text("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n"), "x, y and z"),
        ("lists for coordinates", text("ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n"), "x, y and z"),
        ("2^32 vertices", claim("4294967296", "1"), "copy the file again"),
        ("2^64 vertices", claim("18446744073709551616", "1"), "PLY"),
        ("-1 vertices", claim("-1", "1"), "PLY"),
        ("2^60 faces", claim("3", "1152921504606846976"), "copy the file again"),
        ("10^18 elements of nothing", text(&format!("ply\nformat ascii 1.0\nelement vertex 1\n{XYZ}element void 1000000000000000000\nend_header\n0 0 0\n")), "no properties"),
        ("one vertex", text(&format!("ply\nformat ascii 1.0\nelement vertex 1\n{XYZ}end_header\n0 0 0\n")), "nothing to bake"),
        ("faces of single numbers", text(&format!("ply\nformat ascii 1.0\nelement vertex 1\n{XYZ}element face 1\nproperty int vertex_indices\nend_header\n0 0 0\n0\n")), "unsupported"),
    ]
    .into_iter()
    .map(|(name, bytes, part)| Case::scene(name, "a.ply", bytes, part))
    .collect()
}

fn bodies() -> Vec<Case> {
    // Its last number lies 17 bytes before the end: four of its own, and 13 of the face.
    let triangle = binary(&[3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    let big = |count: [u8; 4]| {
        let list = "property list uint int vertex_indices\n";
        let head = header("binary_little_endian", "3", "1").replace(FACES, list);
        [head.into_bytes(), vec![0; 36], count.to_vec(), vec![0; 12]].concat()
    };
    [
        (
            "an index past the vertices",
            ascii("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
            "names vertex 3",
        ),
        (
            "a negative index",
            ascii("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"),
            "names vertex -1",
        ),
        (
            "a list longer than its line",
            ascii("0 0 0\n1 0 0\n0 1 0\n255 0 1 2\n"),
            "PLY",
        ),
        (
            "a list of -1",
            ascii("0 0 0\n1 0 0\n0 1 0\n-1 0 1 2\n"),
            "PLY",
        ),
        (
            "words for numbers",
            ascii("0 0 zero\n1 0 0\n0 1 0\n3 0 1 2\n"),
            "PLY",
        ),
        (
            "control characters for numbers",
            ascii("0 0 \u{1b}[31m\n1 0 0\n0 1 0\n3 0 1 2\n"),
            "PLY",
        ),
        (
            "bytes of no encoding",
            [ascii(""), vec![0xff; 99]].concat(),
            "PLY",
        ),
        (
            "a vertex short",
            ascii("0 0 0\n1 0 0\n"),
            "copy the file again",
        ),
        (
            "half a face",
            ascii("0 0 0\n1 0 0\n0 1 0\n"),
            "copy the file again",
        ),
        (
            "a position of NaN",
            ascii("0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n"),
            "String: '0 0 nan",
        ),
        (
            "a position at infinity",
            ascii("0 0 0\n1 0 -inf\n0 1 0\n3 0 1 2\n"),
            "String: '1 0 -inf",
        ),
        (
            "a position past all sense",
            ascii("0 0 0\n1e20 0 0\n0 1 0\n3 0 1 2\n"),
            "scale the scene down",
        ),
        (
            "a binary position of NaN",
            patched(&triangle, triangle.len() - 17, &f32::NAN.to_le_bytes()),
            "position of vertex 2",
        ),
        (
            "a triangle without area",
            ascii("0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n"),
            "nothing to bake",
        ),
        ("a binary list cut off", binary(&[3, 0, 0, 0, 0]), "PLY"),
        ("a binary list of 255", binary(&[255, 0, 0, 0, 0]), "PLY"),
        (
            "binary vertices cut off",
            binary(&[])[..binary(&[]).len() - 9].to_vec(),
            "copy the file again",
        ),
        ("a binary list of 2^32 − 1", big([0xff; 4]), "PLY"),
        ("a binary list of 2^30", big([0, 0, 0, 0x40]), "PLY"),
    ]
    .into_iter()
    .map(|(name, bytes, part)| Case::scene(name, "a.ply", bytes, part))
    .collect()
}

fn tolerated() -> Vec<Case> {
    let with_normals = |normal: &str| {
        let normals = "property float nx\nproperty float ny\nproperty float nz\nelement face";
        let head = header("ascii", "3", "1").replace("element face", normals);
        format!("{head}0 0 0 {normal}\n1 0 0 {normal}\n0 1 0 {normal}\n3 0 1 2\n").into_bytes()
    };
    let nan_normals = {
        let normals = "property float nx\nproperty float ny\nproperty float nz\nelement face";
        let head = header("binary_little_endian", "3", "1").replace("element face", normals);
        let nan = f32::NAN;
        let vertices = [
            [0., 0., 0., nan, nan, nan],
            [1., 0., 0., nan, 0., 0.],
            [0., 1., 0., nan, 1., 1.],
        ];
        let face = [3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0].to_vec();
        [head.into_bytes(), floats(vertices.as_flattened()), face].concat()
    };
    let positions: Vec<u8> = [0.0_f32, 0., 0., 1., 0., 0., 0., 1., 0.]
        .iter()
        .flat_map(|value| value.to_be_bytes())
        .collect();
    let big = [
        header("binary_big_endian", "3", "1").into_bytes(),
        positions,
        vec![3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2],
    ]
    .concat();
    [
        ("the other order of bytes", big, ""),
        ("normals of zero", with_normals("0 0 0"), "no usable normal"),
        ("normals of NaN", nan_normals, "no usable normal"),
        (
            "faces of one and of none",
            [
                header("ascii", "3", "3"),
                "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n1 0\n0\n".to_owned(),
            ]
            .concat()
            .into_bytes(),
            "",
        ),
        (
            "coordinates of 1e8",
            ascii("0 0 0\n1e8 0 0\n0 1e8 0\n3 0 1 2\n"),
            "",
        ),
        (
            "coordinates of 1e-8",
            ascii("0 0 0\n1e-8 0 0\n0 1e-8 0\n3 0 1 2\n"),
            "",
        ),
        (
            "lines behind the end",
            ascii("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\nand more\n"),
            "",
        ),
    ]
    .into_iter()
    .map(|(name, bytes, said)| Case::tolerated(name, "a.ply", bytes, said))
    .collect()
}
