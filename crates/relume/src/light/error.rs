//! What can go wrong with a light.

use thiserror::Error;

use crate::files::printable;

use super::faces::FaceError;
use super::hdr_image::ImageError;
use super::json::LightJsonError;
use super::layout::LayoutError;

/// A light that could not be read. Every message is one line: what, where, what to do.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LightError {
    /// The text is neither a path nor one of the analytic lights.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// The file could not be read at all.
    #[error(
        "{}: {source}; a light is an image, six faces {{px,nx,py,ny,pz,nz}}, a light.json, or constant:R,G,B, sun:X,Y,Z,DEG,R,G,B, sky:ELEVATION,TURBIDITY",
        printable(path)
    )]
    Read {
        /// The path as given.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// A folder, pipe or device.
    #[error(
        "{}: not a regular file; name an image or a light.json",
        printable(path)
    )]
    NotAFile {
        /// The path as given.
        path: String,
    },
    /// The file is larger than any light this reads.
    #[error(
        "{}: {bytes} bytes are more than the {} Relume reads; reduce the image",
        printable(path),
        super::limits::MAX_FILE_BYTES
    )]
    FileTooLarge {
        /// The path as given.
        path: String,
        /// Its length.
        bytes: u64,
    },
    /// The image in the file is not usable.
    #[error("{}: {error}", printable(path))]
    Image {
        /// The path as given.
        path: String,
        /// What is wrong with it.
        error: ImageError,
    },
    /// A face of a cube does not go with the others.
    #[error("{}: {error}", printable(path))]
    Face {
        /// The path of the face.
        path: String,
        /// What is wrong with it.
        error: FaceError,
    },
    /// The image does not fit its layout.
    #[error("{}: {error}", printable(path))]
    Layout {
        /// The path as given.
        path: String,
        /// What does not fit.
        error: LayoutError,
    },
    /// The file is JSON, but not a light that can be used.
    #[error("{}: {error}", printable(path))]
    Json {
        /// The path as given.
        path: String,
        /// What is wrong with it.
        error: LightJsonError,
    },
}

/// A light or a turn given as text, or by numbers, that means nothing.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SpecError {
    /// Not the form that this kind of light has.
    #[error("\"{}\" is not of the form {form}", printable(text))]
    Form {
        /// What was given.
        text: String,
        /// What it should look like.
        form: &'static str,
    },
    /// A number outside the range that means something.
    #[error("{what}: {problem}")]
    Value {
        /// Which value.
        what: &'static str,
        /// What is wrong with it and what is accepted.
        problem: String,
    },
}

impl SpecError {
    pub(super) fn value(what: &'static str, problem: impl Into<String>) -> Self {
        Self::Value {
            what,
            problem: problem.into(),
        }
    }
}
