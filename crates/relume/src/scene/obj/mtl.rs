//! What of an MTL file matters to diffuse transfer: `Kd`, `map_Kd`, opacity, and whether there is a normal map.

use super::super::{Sampler, SceneError, Wrap};
use crate::files::printable;

/// A material as the file says it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MtlMaterial {
    pub(super) name: String,
    /// Linear `Kd`.
    pub(super) diffuse: Option<[f32; 3]>,
    pub(super) texture: Option<Map>,
    /// 1 is opaque.
    pub(super) dissolve: f32,
    pub(super) has_normal_map: bool,
}

/// A `map_Kd` line.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    pub(super) file: String,
    pub(super) clamp: bool,
    /// Whether options move the texture.
    pub(super) moved: bool,
}

impl Map {
    pub(super) fn sampler(&self) -> Sampler {
        let wrap = if self.clamp {
            Wrap::Clamp
        } else {
            Wrap::Repeat
        };
        Sampler {
            wrap_u: wrap,
            wrap_v: wrap,
            nearest: false,
        }
    }
}

/// Reads the materials of an MTL file, in order.
pub(super) fn parse(bytes: &[u8]) -> Result<Vec<MtlMaterial>, SceneError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut materials: Vec<MtlMaterial> = Vec::new();
    for (number, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let line = String::from_utf8_lossy(line);
        let line = line.trim();
        let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if key == "newmtl" {
            materials.push(MtlMaterial {
                name: rest.to_owned(),
                diffuse: None,
                texture: None,
                dissolve: 1.0,
                has_normal_map: false,
            });
        } else if let Some(material) = materials.last_mut() {
            statement(material, key, rest).map_err(|problem| SceneError::Line {
                line: number + 1,
                problem,
            })?;
        }
    }
    Ok(materials)
}

fn statement(material: &mut MtlMaterial, key: &str, rest: &str) -> Result<(), String> {
    match key {
        "Kd" => material.diffuse = Some(color(rest)?),
        "map_Kd" => material.texture = map(rest),
        "d" => {
            // `d -halo 0.5` is an opacity that depends on the view.
            let last = rest.split_whitespace().next_back().unwrap_or("");
            material.dissolve = float("d", last)?;
        }
        "Tr" => material.dissolve = 1.0 - float("Tr", rest)?,
        "bump" | "map_bump" | "map_Bump" | "norm" | "map_Kn" => material.has_normal_map = true,
        _ => {}
    }
    Ok(())
}

/// `r g b`, or one number for all three. Other colour spaces are not read.
fn color(text: &str) -> Result<[f32; 3], String> {
    let numbers: Result<Vec<f32>, String> = text
        .split_whitespace()
        .take_while(|word| !word.starts_with('#'))
        .map(|word| float("Kd", word))
        .collect();
    match numbers?.as_slice() {
        &[gray] => Ok([gray; 3]),
        &[r, g, b, ..] => Ok([r, g, b]),
        other => Err(format!("Kd has {} numbers, not 3", other.len())),
    }
}

fn float(key: &str, text: &str) -> Result<f32, String> {
    let value = text.parse().ok().filter(|value: &f32| value.is_finite());
    value.ok_or_else(|| {
        let shown: String = text.chars().take(40).collect();
        format!("{key} has \"{}\" where a number belongs", printable(&shown))
    })
}

/// Options, each with a known number of arguments, and then a file name that may contain spaces.
fn map(text: &str) -> Option<Map> {
    let mut map = Map {
        file: String::new(),
        clamp: false,
        moved: false,
    };
    let mut rest = text;
    while rest.starts_with('-') {
        let (option, after) = word(rest);
        let (most, numeric) = match option {
            "-o" | "-s" | "-t" => (3, true),
            "-mm" => (2, true),
            "-blendu" | "-blendv" | "-cc" | "-clamp" | "-texres" | "-bm" | "-boost"
            | "-imfchan" | "-type" => (1, false),
            // A file name that starts with a dash.
            _ => break,
        };
        rest = after;
        for i in 0..most {
            let (argument, after) = word(rest);
            if numeric && argument.parse::<f32>().is_err() {
                break;
            }
            map.clamp |= option == "-clamp" && argument == "on";
            map.moved |= option == "-o" && argument.parse() != Ok(0.0f32);
            // The third scale, along w, does nothing to an image.
            map.moved |= option == "-s" && i < 2 && argument.parse() != Ok(1.0f32);
            rest = after;
        }
    }
    map.file = rest.to_owned();
    (!map.file.is_empty()).then_some(map)
}

fn word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim_start())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_are_read() {
        let text = "\u{feff}# x\r\nKd 9 9 9\nnewmtl a b\n\tKd 0.1  0.2 0.3 # why\nd 0.5\nKs 1\n\
                    map_Bump n.png\nnewmtl c\nKd .5\nTr 0.25\nmap_Kd -clamp on -s 1 1 1 -o 0.5 tex\\my wood.png\n";
        let materials = parse(text.as_bytes()).unwrap();
        assert_eq!(materials.len(), 2);
        assert_eq!(materials[0].name, "a b");
        assert_eq!(materials[0].diffuse, Some([0.1, 0.2, 0.3]));
        assert_eq!(
            (materials[0].dissolve, materials[0].has_normal_map),
            (0.5, true)
        );
        assert_eq!(materials[1].diffuse, Some([0.5; 3]));
        assert_eq!(materials[1].dissolve, 0.75);
        let expected = Map {
            file: "tex\\my wood.png".to_owned(),
            clamp: true,
            moved: true,
        };
        assert_eq!(materials[1].texture, Some(expected));
    }

    #[test]
    fn bad_numbers_are_named_with_their_line() {
        for (text, expected) in [
            ("newmtl a\nKd 0.1 0.2\n", "line 2: Kd has 2 numbers, not 3"),
            ("newmtl a\nKd\n", "line 2: Kd has 0 numbers, not 3"),
            (
                "newmtl a\nKd spectral x.rfl\n",
                "line 2: Kd has \"spectral\" where a number belongs",
            ),
            (
                "newmtl a\n\nd nan\n",
                "line 3: d has \"nan\" where a number belongs",
            ),
        ] {
            assert_eq!(parse(text.as_bytes()).unwrap_err().to_string(), expected);
        }
    }
}
