//! OBJ and MTL.

use super::case::Case;

/// A floor and a roof.
pub const GOOD: &str =
    "v -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 1 -1\nv 1 1 -1\nv 1 1 1\nf 1 2 3 4\nf 5 6 7\n";
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

pub fn cases() -> Vec<Case> {
    let mut cases = refused();
    cases.extend(materials());
    cases.extend(tolerated());
    cases
}

fn refused() -> Vec<Case> {
    let with = |rest: &str| format!("{TRIANGLE}{rest}").into_bytes();
    let binary = [b"f 1 2 3\n".as_slice(), &[0; 64]].concat();
    [
        ("an empty file", vec![], "nothing to bake"),
        (
            "a comment alone",
            b"# nothing\n".to_vec(),
            "nothing to bake",
        ),
        ("one vertex", b"v 0 0 0\n".to_vec(), "nothing to bake"),
        ("vertices and no face", with(""), "nothing to bake"),
        (
            "text with another name",
            b"Dear Sir or Madam,\nhello\n".to_vec(),
            "nothing to bake",
        ),
        ("binary data", binary, "binary data"),
        (
            "a PLY file",
            b"ply\nformat ascii 1.0\n".to_vec(),
            "content is PLY",
        ),
        (
            "a glTF file",
            b"{\"asset\": {}}".to_vec(),
            "content is JSON",
        ),
        (
            "a position of NaN",
            b"v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec(),
            "position of vertex 0",
        ),
        (
            "a position at infinity",
            with("v inf 0 0\nf 1 2 4\n"),
            "position of vertex 3",
        ),
        (
            "a position past f32",
            with("v 1e39 0 0\nf 1 2 4\n"),
            "position of vertex 3",
        ),
        (
            "a position past all sense",
            with("v 0 1e13 0\nf 1 2 4\n"),
            "scale the scene down",
        ),
        (
            "a position of NaN in a polygon",
            with("v nan 1 0\nf 1 2 3 4\n"),
            "position of vertex 3",
        ),
        (
            "two coordinates",
            b"v 1 2\n".to_vec(),
            "line 1: v has 2 numbers",
        ),
        (
            "words for numbers",
            b"v one two three\n".to_vec(),
            "line 1: v has \"one\"",
        ),
        (
            "control characters for a number",
            b"v \x1b[31m 0 0\n".to_vec(),
            "\\u{1b}[31m",
        ),
        (
            "bytes of no encoding",
            b"v \xff\xfe 0 0\n".to_vec(),
            "line 1",
        ),
        ("a face of two", with("f 1 2\n"), "2 corners"),
        ("a face of nothing", with("f\n"), "0 corners"),
        ("index 0", with("f 0 1 2\n"), "counts from 1"),
        (
            "an index past the end",
            with("f 1 2 4\n"),
            "names position 4",
        ),
        (
            "an index before the beginning",
            with("f -4 1 2\n"),
            "not there",
        ),
        (
            "an index past 32 bits",
            with("f 1 2 4294967296\n"),
            "not there",
        ),
        (
            "the index that stands for none",
            with("f 1 2 4294967295\n"),
            "names position 4294967295",
        ),
        (
            "an index past 64 bits",
            with("f 1 2 99999999999999999999\n"),
            "not a corner",
        ),
        (
            "four indices in one",
            with("f 1/1/1/1 2 3\n"),
            "not a corner",
        ),
        (
            "a texture coordinate that is not there",
            with("f 1/1 2 3\n"),
            "names texture coordinate 1",
        ),
        (
            "a normal that is not there",
            with("f 1//7 2 3\n"),
            "names normal 7",
        ),
        (
            "a normal of two",
            with("vn 0 1\nf 1 2 3\n"),
            "vn has 2 numbers",
        ),
        (
            "a colour of NaN",
            b"v 0 0 0 nan 1 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec(),
            "colour of vertex 0",
        ),
        (
            "triangles without area alone",
            with("f 1 1 2\nf 3 3 3\n"),
            "nothing to bake",
        ),
    ]
    .into_iter()
    .map(|(name, bytes, part)| Case::scene(name, "a.obj", bytes, part))
    .collect()
}

fn materials() -> Vec<Case> {
    let using = |library: &str| format!("mtllib {library}\n{TRIANGLE}usemtl m\nf 1 2 3\n");
    let own = || using("a.mtl");
    vec![
        Case::scene(
            "a library above",
            "a.obj",
            using("../secret.mtl"),
            "leads out",
        ),
        Case::scene(
            "a library above, as Windows has it",
            "a.obj",
            using("..\\secret.mtl"),
            "leads out",
        ),
        Case::scene(
            "an absolute library",
            "a.obj",
            using("/etc/hostname"),
            "absolute",
        ),
        Case::scene(
            "a library on a drive",
            "a.obj",
            using("C:\\a.mtl"),
            "drive letter",
        ),
        Case::scene(
            "a library above, encoded",
            "a.obj",
            using("%2e%2e/secret.mtl"),
            "leads out",
        ),
        Case::scene("Kd of NaN", "a.obj", own(), "a.mtl: line 2")
            .with("a.mtl", "newmtl m\nKd nan 0 0\n"),
        Case::scene("Kd of two", "a.obj", own(), "Kd has 2 numbers")
            .with("a.mtl", "newmtl m\nKd 1 0\n"),
        Case::scene("opacity in words", "a.obj", own(), "line 2: d has")
            .with("a.mtl", "newmtl m\nd half\n"),
        Case::scene("a texture above", "a.obj", own(), "leads out")
            .with("a.mtl", "newmtl m\nmap_Kd ../secret.png\n"),
        Case::scene("a texture of text", "a.obj", own(), "neither PNG nor JPEG")
            .with("a.mtl", "newmtl m\nmap_Kd t.png\n")
            .with("t.png", "hello"),
        Case::scene(
            "a folder as a library",
            "a.obj",
            own(),
            "not a regular file",
        )
        .with_folder("a.mtl"),
        Case::tolerated("a missing library", "a.obj", own(), "is not there"),
        Case::tolerated("a missing texture", "a.obj", own(), "Kd alone")
            .with("a.mtl", "newmtl m\nmap_Kd gone.png\n"),
        Case::tolerated("a library of bytes", "a.obj", own(), "no material")
            .with("a.mtl", [0xff; 99]),
        Case::tolerated("Kd past white", "a.obj", own(), "clamped")
            .with("a.mtl", "newmtl m\nKd 9 -9 1e30\n"),
        Case::tolerated(
            "a material with control characters",
            "a.obj",
            format!("{TRIANGLE}usemtl \u{1b}[31m\u{7}\nf 1 2 3\n"),
            "\\u{1b}[31m\\u{7}",
        ),
    ]
}

fn tolerated() -> Vec<Case> {
    let with = |rest: &str| format!("{TRIANGLE}{rest}").into_bytes();
    let many: String = (1..=3000).map(|i| format!(" {}", 1 + i % 3)).collect();
    let scaled =
        |scale: f64| format!("v 0 0 0\nv {scale:e} 0 0\nv 0 {scale:e} 0\nf 1 2 3\n").into_bytes();
    [
        ("coordinates of 1e8", scaled(1e8), ""),
        ("coordinates of 1e-8", scaled(1e-8), ""),
        ("coordinates of 1e-40", scaled(1e-40), ""),
        ("coordinates of 1e12", scaled(1e12), ""),
        (
            "a triangle of 1e-8 beside one of 1e8",
            b"v 0 0 0\nv 1e8 0 0\nv 0 1e8 0\nv 1e-8 0 0\nv 0 1e-8 0\nf 1 2 3\nf 1 4 5\n".to_vec(),
            "",
        ),
        (
            "a triangle of 1e-8 at 1e8",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1e8 0 0\nv 1e8 1e-8 0\nv 1e8 0 1e-8\nf 1 2 3\nf 4 5 6\n"
                .to_vec(),
            "",
        ),
        (
            "a face without area among others",
            with("f 1 2 3\nf 1 2 2\nf 1 1 1\n"),
            "without area",
        ),
        (
            "normals of zero",
            with("vn 0 0 0\nf 1//1 2//1 3//1\n"),
            "no usable normal",
        ),
        (
            "normals of NaN and infinity",
            with("vn nan 0 0\nvn inf 0 0\nf 1//1 2//2 3//1\n"),
            "no usable normal",
        ),
        (
            "texture coordinates of NaN",
            with("vt nan inf\nf 1/1 2/1 3/1\n"),
            "texture coordinates are not finite",
        ),
        (
            "vertices nobody uses",
            with("v 9 9 9\nv 9 9 9\nf 1 2 3\n"),
            "",
        ),
        (
            "the same triangle 1000 times",
            with(&"f 1 2 3\n".repeat(1000)),
            "",
        ),
        ("a triangle and its back", with("f 1 2 3\nf 3 2 1\n"), ""),
        (
            "a polygon of 3000 corners on three places",
            with(&format!("f{many}\nf 1 2 3\n")),
            "",
        ),
        (
            "a line that goes on past the end",
            with("f 1 2 3\nf 1 2 \\"),
            "",
        ),
        (
            "words nobody knows",
            with("f 1 2 3\nwhatever \u{1b} 1 2 3\n"),
            "",
        ),
        (
            "lines that end as on Windows",
            b"v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n".to_vec(),
            "",
        ),
    ]
    .into_iter()
    .map(|(name, bytes, said)| Case::tolerated(name, "a.obj", bytes, said))
    .collect()
}
