//! The lines of an OBJ file.

use std::borrow::Cow;
use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use super::super::SceneError;
use crate::files::printable;

/// No texture coordinate or normal.
pub(super) const NONE: u32 = u32::MAX;

/// A corner of a face: indices from 0 of position, texture coordinate and normal, the latter two perhaps [`NONE`].
pub(super) type Corner = [u32; 3];

/// An OBJ file, line by line.
#[derive(Debug, Default)]
pub(super) struct Obj {
    pub(super) positions: Vec<Vec3>,
    /// Linear vertex colours: one per position, or empty when no position has one.
    pub(super) colors: Vec<[f32; 3]>,
    /// `v` up, as in the file.
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    /// Corners of all faces, one after the other.
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Vec<Face>,
    /// Names of the materials faces use, in the order of first use; `None` before any `usemtl`.
    pub(super) materials: Vec<Option<String>>,
    /// What follows each `mtllib`.
    pub(super) libraries: Vec<String>,
}

/// A polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// End of its corners in [`Obj::corners`]; they start where the face before ends.
    pub(super) end: usize,
    /// Index into [`Obj::materials`].
    pub(super) material: usize,
    /// Line in the file, from 1.
    pub(super) line: usize,
}

#[derive(Default)]
struct Parser {
    obj: Obj,
    current: Option<String>,
    known: BTreeMap<Option<String>, usize>,
}

/// Parses an OBJ file. Indices are made absolute and not yet checked against the end of the file.
pub(super) fn parse(bytes: &[u8]) -> Result<Obj, SceneError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut parser = Parser::default();
    let mut pending = String::new();
    for (number, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let line = String::from_utf8_lossy(line);
        // A backslash at the end continues the line.
        if let Some(head) = line.strip_suffix('\\') {
            pending.push_str(head);
            pending.push(' ');
            continue;
        }
        let whole = if pending.is_empty() {
            line
        } else {
            pending.push_str(&line);
            Cow::Owned(std::mem::take(&mut pending))
        };
        parser
            .statement(whole.trim(), number + 1)
            .map_err(|problem| SceneError::Line {
                line: number + 1,
                problem,
            })?;
    }
    Ok(parser.obj)
}

impl Parser {
    fn statement(&mut self, line: &str, number: usize) -> Result<(), String> {
        let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match key {
            "v" => self.position(rest)?,
            "vt" => {
                let ([u, v, _], count) = floats::<3>("vt", rest)?;
                at_least("vt", count, 1)?;
                self.obj.uvs.push(Vec2::new(u, v));
            }
            "vn" => {
                let (normal, count) = floats::<3>("vn", rest)?;
                at_least("vn", count, 3)?;
                self.obj.normals.push(Vec3::from(normal));
            }
            "f" | "fo" => self.face(rest, number)?,
            "usemtl" => self.current = Some(rest.trim().to_owned()),
            "mtllib" => self.obj.libraries.push(rest.trim().to_owned()),
            _ => {}
        }
        Ok(())
    }

    /// `x y z`, then perhaps a weight (of curves: ignored), then perhaps a colour.
    fn position(&mut self, rest: &str) -> Result<(), String> {
        let (n, count) = floats::<7>("v", rest)?;
        at_least("v", count, 3)?;
        let color = match count {
            6 => Some([n[3], n[4], n[5]]),
            7 => Some([n[4], n[5], n[6]]),
            _ => None,
        };
        let obj = &mut self.obj;
        if color.is_some() || !obj.colors.is_empty() {
            obj.colors.resize(obj.positions.len(), [1.0; 3]);
            obj.colors.push(color.unwrap_or([1.0; 3]));
        }
        obj.positions.push(Vec3::new(n[0], n[1], n[2]));
        Ok(())
    }

    fn face(&mut self, rest: &str, line: usize) -> Result<(), String> {
        let start = self.obj.corners.len();
        for word in words(rest) {
            let corner = self.corner(word)?;
            self.obj.corners.push(corner);
        }
        let end = self.obj.corners.len();
        if end - start < 3 {
            return Err(format!("a face has {} corners; it needs 3", end - start));
        }
        let known = self.known.get(&self.current).copied();
        let material = known.unwrap_or_else(|| {
            self.obj.materials.push(self.current.clone());
            let index = self.obj.materials.len() - 1;
            self.known.insert(self.current.clone(), index);
            index
        });
        self.obj.faces.push(Face {
            end,
            material,
            line,
        });
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative numbers count back from the last one read.
    fn corner(&self, word: &str) -> Result<Corner, String> {
        let obj = &self.obj;
        let counts = [obj.positions.len(), obj.uvs.len(), obj.normals.len()];
        let mut corner = [NONE; 3];
        for (i, part) in word.split('/').enumerate() {
            let bad = || format!("\"{}\" is not a corner of a face", shown(word));
            let slot = corner.get_mut(i).ok_or_else(bad)?;
            if part.is_empty() && i > 0 {
                continue;
            }
            let number: i64 = part.parse().map_err(|_| bad())?;
            let index = match number {
                1.. => number - 1,
                ..=-1 => counts[i] as i64 + number,
                0 => return Err("index 0 in a face; OBJ counts from 1".to_owned()),
            };
            // The largest number stands for none.
            *slot = u32::try_from(index)
                .ok()
                .filter(|&index| index != NONE)
                .ok_or_else(|| format!("\"{}\" names what is not there", shown(word)))?;
        }
        Ok(corner)
    }
}

/// Words up to a comment.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split_whitespace()
        .take_while(|word| !word.starts_with('#'))
}

/// Up to `N` numbers and how many there are.
fn floats<const N: usize>(key: &str, text: &str) -> Result<([f32; N], usize), String> {
    let mut numbers = [0.0; N];
    let mut count = 0;
    for (slot, word) in numbers.iter_mut().zip(words(text)) {
        *slot = word
            .parse()
            .map_err(|_| format!("{key} has \"{}\" where a number belongs", shown(word)))?;
        count += 1;
    }
    Ok((numbers, count))
}

fn at_least(key: &str, count: usize, needed: usize) -> Result<(), String> {
    if count >= needed {
        return Ok(());
    }
    Err(format!("{key} has {count} numbers; it needs {needed}"))
}

fn shown(word: &str) -> String {
    printable(&word.chars().take(40).collect::<String>())
}
