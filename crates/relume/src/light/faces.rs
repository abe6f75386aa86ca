//! Six files, one for each face of a cube.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use thiserror::Error;

use crate::files::printable;

use super::decode::decode;
use super::decoded::Decoded;
use super::hdr_image::{HdrImage, ImageError, check_size};

/// Files of the faces of a cube map, in the order of Direct3D: px, nx, py, ny, pz, nz ([`Layout::Faces`](super::Layout::Faces) says where they lie).
///
/// As text it is a path in which `{px,nx,py,ny,pz,nz}` stands for the part that differs. Other names may stand there, but in that order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FacePattern {
    before: String,
    names: [String; 6],
    after: String,
}

/// A face that does not go with the others.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FaceError {
    /// Not as wide as high.
    #[error("is {width} × {height} pixels; the faces of a cube are squares")]
    NotSquare {
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
    },
    /// Not as large as the first.
    #[error(
        "is {found} pixels across, but {} is {expected}; make the six faces equal",
        printable(first)
    )]
    Unequal {
        /// Its side.
        found: usize,
        /// The side of the first face.
        expected: usize,
        /// The path of the first face.
        first: String,
    },
    /// A cube by itself.
    #[error("is a whole cube map; name it alone")]
    WholeCube,
}

impl FacePattern {
    /// The six paths.
    pub fn paths(&self) -> [PathBuf; 6] {
        let path = |name: &String| PathBuf::from(format!("{}{name}{}", self.before, self.after));
        self.names.each_ref().map(path)
    }

    /// Whether a text has a pair of braces with commas between them, and thus means a pattern rather than a path.
    pub(super) fn is_meant(text: &str) -> bool {
        split(text).is_some_and(|(_, names, _)| names.contains(','))
    }
}

/// Before, between and after the braces.
fn split(text: &str) -> Option<(&str, &str, &str)> {
    let (before, rest) = text.split_once('{')?;
    let (names, after) = rest.split_once('}')?;
    Some((before, names, after))
}

impl FromStr for FacePattern {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let (before, names, after) = split(text).ok_or(())?;
        let names: Vec<String> = names
            .split(',')
            .map(|name| name.trim().to_owned())
            .collect();
        let names: [String; 6] = names.try_into().map_err(|_| ())?;
        let distinct = (1..6).all(|i| !names[..i].contains(&names[i]));
        if !distinct || after.contains(['{', '}']) {
            return Err(());
        }
        Ok(Self {
            before: before.to_owned(),
            names,
            after: after.to_owned(),
        })
    }
}

impl fmt::Display for FacePattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            before,
            names,
            after,
        } = self;
        write!(f, "{before}{{{}}}{after}", names.join(","))
    }
}

/// What is wrong with a face.
pub(super) enum Problem {
    Image(ImageError),
    Face(FaceError),
}

impl From<ImageError> for Problem {
    fn from(error: ImageError) -> Self {
        Self::Image(error)
    }
}

/// Faces so far, side by side as [`Layout::Faces`](super::Layout::Faces) has them.
#[derive(Default)]
pub(super) struct Row {
    side: usize,
    first: String,
    pixels: Vec<[f32; 3]>,
}

impl Row {
    /// Adds face `index` of the six from the bytes of the file `name`; returns its warnings. The first one decides the size.
    pub(super) fn add(
        &mut self,
        index: usize,
        bytes: &[u8],
        name: &str,
    ) -> Result<Vec<String>, Problem> {
        let Decoded {
            image,
            layout,
            warnings,
        } = decode(bytes)?;
        let (width, height) = (image.width(), image.height());
        if layout.is_some() {
            return Err(Problem::Face(FaceError::WholeCube));
        }
        if width != height {
            return Err(Problem::Face(FaceError::NotSquare { width, height }));
        }
        if index == 0 {
            check_size(6 * width as u64, height as u64)?;
            self.side = width;
            name.clone_into(&mut self.first);
            self.pixels = vec![[0.0; 3]; 6 * width * height];
        }
        if width != self.side {
            return Err(Problem::Face(FaceError::Unequal {
                found: width,
                expected: self.side,
                first: self.first.clone(),
            }));
        }
        let rows = self.pixels.chunks_exact_mut(6 * width);
        for (row, face) in rows.zip(image.pixels().chunks_exact(width)) {
            row[index * width..(index + 1) * width].copy_from_slice(face);
        }
        Ok(warnings)
    }

    /// The row of six.
    pub(super) fn finish(self) -> Result<HdrImage, ImageError> {
        HdrImage::new(6 * self.side, self.side, self.pixels)
    }
}
