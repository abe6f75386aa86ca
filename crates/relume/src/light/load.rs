//! From what a person names to light.

use std::path::Path;

use crate::files::{Unread, printable, read_regular};

use super::decode::decode;
use super::environment::Environment;
use super::error::LightError;
use super::faces::{FacePattern, Problem, Row};
use super::json::LightFile;
use super::layout::{Layout, LayoutChoice};
use super::limits::MAX_FILE_BYTES;
use super::map::EnvMap;
use super::spec::EnvSpec;
use super::turn::Turn;

/// How a light is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightOptions {
    /// How an image is wrapped around the sphere.
    pub layout: LayoutChoice,
    /// Turns applied to it, the first one first.
    pub turns: Vec<Turn>,
}

/// Reads or makes the light that `spec` names, turned as the options say, with what a person should know about it.
///
/// Files are known by their content: images ([`HdrImage::decode`](super::HdrImage::decode)) and light.json ([`LightFile`]). Warnings are single lines.
pub fn load(
    spec: &EnvSpec,
    options: &LightOptions,
) -> Result<(Environment, Vec<String>), LightError> {
    let (environment, warnings) = match spec {
        EnvSpec::File(path) => load_file(path, options.layout)?,
        EnvSpec::Faces(pattern) => load_faces(pattern, options.layout)?,
        EnvSpec::Constant(radiance) => (Environment::Constant(*radiance), Vec::new()),
        EnvSpec::Sun(sun) => (Environment::Sun(*sun), Vec::new()),
        EnvSpec::Sky(sky) => (Environment::Sky(sky.clone()), Vec::new()),
    };
    let environment = if options.turns.is_empty() {
        environment
    } else {
        environment
            .rotated(Turn::all(&options.turns))
            .expect("products of rotations")
    };
    Ok((environment, warnings))
}

fn load_file(path: &Path, layout: LayoutChoice) -> Result<(Environment, Vec<String>), LightError> {
    let name = path.display().to_string();
    from_bytes(&read_file(path, &name)?, &name, layout)
}

/// [`load`] of a file that is in memory; `name` is what errors and warnings call it.
///
/// # Errors
/// As for [`load`].
pub fn from_bytes(
    bytes: &[u8],
    name: &str,
    layout: LayoutChoice,
) -> Result<(Environment, Vec<String>), LightError> {
    let path = name.to_owned();
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if text.iter().find(|c| !c.is_ascii_whitespace()) == Some(&b'{') {
        let file = LightFile::from_json(text).map_err(|error| LightError::Json { path, error })?;
        return Ok((Environment::Sh(file.light), Vec::new()));
    }
    let decoded = match decode(bytes) {
        Ok(decoded) => decoded,
        Err(error) => return Err(LightError::Image { path, error }),
    };
    let warnings = said_of(name, decoded.warnings);
    let layout = match decoded.layout {
        None => Ok(layout),
        Some(known) => layout.agree(known).map(LayoutChoice::Fixed),
    };
    let map = layout.and_then(|layout| EnvMap::new(decoded.image, layout));
    let map = map.map_err(|error| LightError::Layout { path, error })?;
    Ok((Environment::Map(map), warnings))
}

fn load_faces(
    pattern: &FacePattern,
    layout: LayoutChoice,
) -> Result<(Environment, Vec<String>), LightError> {
    let mut row = Row::default();
    let mut said = Vec::new();
    for (index, path) in pattern.paths().iter().enumerate() {
        let name = path.display().to_string();
        let bytes = read_file(path, &name)?;
        let of_face = row
            .add(index, &bytes, &name)
            .map_err(|problem| match problem {
                Problem::Image(error) => LightError::Image {
                    path: name.clone(),
                    error,
                },
                Problem::Face(error) => LightError::Face {
                    path: name.clone(),
                    error,
                },
            })?;
        said.push((name, of_face));
    }
    let path = pattern.to_string();
    // What is the same for all is said once.
    let warnings = match &said[..] {
        [(_, first), others @ ..] if others.iter().all(|(_, other)| other == first) => {
            said_of(&path, first.clone())
        }
        _ => said
            .into_iter()
            .flat_map(|(name, warnings)| said_of(&name, warnings))
            .collect(),
    };
    let image = row.finish().map_err(|error| LightError::Image {
        path: path.clone(),
        error,
    })?;
    let layout = layout.agree(Layout::Faces).map(LayoutChoice::Fixed);
    let map = layout.and_then(|layout| EnvMap::new(image, layout));
    let map = map.map_err(|error| LightError::Layout { path, error })?;
    Ok((Environment::Map(map), warnings))
}

/// Warnings with the name of their file.
fn said_of(name: &str, warnings: Vec<String>) -> Vec<String> {
    let said = |warning| format!("{}: {warning}", printable(name));
    warnings.into_iter().map(said).collect()
}

fn read_file(path: &Path, name: &str) -> Result<Vec<u8>, LightError> {
    let given = name.to_owned();
    read_regular(path, MAX_FILE_BYTES).map_err(|unread| match unread {
        Unread::Io(source) => LightError::Read {
            path: given,
            source,
        },
        Unread::NotAFile => LightError::NotAFile { path: given },
        Unread::TooLarge(bytes) => LightError::FileTooLarge { path: given, bytes },
    })
}

#[cfg(test)]
#[path = "load_tests.rs"]
mod tests;
