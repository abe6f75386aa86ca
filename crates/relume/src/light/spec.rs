//! Lights as text: a path, or an analytic light.

use std::path::PathBuf;
use std::str::FromStr;

use glam::DVec3;

use super::error::SpecError;
use super::faces::FacePattern;
use super::sky::Sky;
use super::sun::Sun;
use super::values::{checked_radiance, numbers};

/// What a light is made from.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EnvSpec {
    /// An image or a light.json.
    File(PathBuf),
    /// Six images, the faces of a cube.
    Faces(FacePattern),
    /// The same radiance from everywhere, linear Rec. 709.
    Constant([f32; 3]),
    /// A disc.
    Sun(Sun),
    /// Daylight.
    Sky(Box<Sky>),
}

impl EnvSpec {
    /// The files it is read from.
    pub fn paths(&self) -> Vec<PathBuf> {
        match self {
            Self::File(path) => vec![path.clone()],
            Self::Faces(pattern) => pattern.paths().into(),
            Self::Constant(_) | Self::Sun(_) | Self::Sky(_) => Vec::new(),
        }
    }
}

/// `constant:R,G,B`, `sun:X,Y,Z,DEG,R,G,B` (DEG is the diameter of the disc), `sky:ELEVATION,TURBIDITY`; a path with
/// `{px,nx,py,ny,pz,nz}` in it is six files ([`FacePattern`]); all else is a path.
impl FromStr for EnvSpec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let wrong = |form| SpecError::Form {
            text: text.to_owned(),
            form,
        };
        match text.split_once(':') {
            Some(("constant", values)) => {
                let values = numbers::<3>(values).ok_or_else(|| {
                    wrong("constant:R,G,B, a radiance in linear Rec. 709, such as constant:1,1,1")
                })?;
                let radiance = values.map(|value| value as f32);
                checked_radiance("constant radiance", radiance).map(Self::Constant)
            }
            Some(("sun", values)) => {
                let [x, y, z, diameter, r, g, b] = numbers::<7>(values).ok_or_else(|| {
                    wrong("sun:X,Y,Z,DEG,R,G,B, the direction of the sun, its diameter in degrees and its radiance, such as sun:1,2,1,0.53,50000,50000,50000")
                })?;
                let radiance = [r, g, b].map(|value| value as f32);
                Sun::new(DVec3::new(x, y, z), diameter, radiance).map(Self::Sun)
            }
            Some(("sky", values)) => {
                let [elevation, turbidity] = numbers::<2>(values).ok_or_else(|| {
                    wrong("sky:ELEVATION,TURBIDITY, degrees of the sun above the horizon and haze from 2 to 10, such as sky:40,3")
                })?;
                Sky::new(elevation, turbidity).map(|sky| Self::Sky(Box::new(sky)))
            }
            _ if text.is_empty() => Err(wrong(
                "a path, constant:R,G,B, sun:X,Y,Z,DEG,R,G,B or sky:ELEVATION,TURBIDITY",
            )),
            _ if FacePattern::is_meant(text) => text.parse().map(Self::Faces).map_err(|()| {
                wrong("sky_{px,nx,py,ny,pz,nz}.hdr, a path with one list of six different names in it")
            }),
            _ => Ok(Self::File(PathBuf::from(text))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<EnvSpec, SpecError> {
        text.parse()
    }

    #[test]
    fn every_form_is_read() {
        assert_eq!(parse("a/b.hdr"), Ok(EnvSpec::File("a/b.hdr".into())));
        assert_eq!(parse("C:\\b.hdr"), Ok(EnvSpec::File("C:\\b.hdr".into())));
        assert_eq!(parse("{0}.hdr"), Ok(EnvSpec::File("{0}.hdr".into())));
        let faces = parse("a/{px,nx,py,ny,pz,nz}.exr").unwrap();
        let names =
            ["px", "nx", "py", "ny", "pz", "nz"].map(|n| PathBuf::from(format!("a/{n}.exr")));
        assert_eq!(faces.paths(), names);
        assert_eq!(
            parse("constant:1,0.5, 2e-1"),
            Ok(EnvSpec::Constant([1.0, 0.5, 0.2]))
        );
        let EnvSpec::Sun(sun) = parse("sun:0,2,0,0.53,1,2,3").unwrap() else {
            panic!("a sun");
        };
        assert_eq!(sun.direction(), DVec3::Y);
        assert_eq!(sun.diameter_degrees(), 0.53);
        assert_eq!(sun.radiance(), [1.0, 2.0, 3.0]);
        let EnvSpec::Sky(sky) = parse("sky:35,2.5").unwrap() else {
            panic!("a sky");
        };
        assert_eq!((sky.elevation(), sky.turbidity()), (35.0, 2.5));
    }

    #[test]
    fn errors_are_one_line_that_shows_the_form() {
        for (text, needle) in [
            ("constant:1,1", "constant:R,G,B"),
            ("constant:1,1,1,1", "constant:R,G,B"),
            ("constant:1,-1,1", "not negative"),
            ("constant:nan,1,1", "finite"),
            ("constant:1e39,1,1", "finite"),
            ("sun:0,1,0,1,1,1", "sun:X,Y,Z,DEG,R,G,B"),
            ("sun:0,0,0,1,1,1,1", "not all 0"),
            ("sun:0,1,0,-1,1,1,1", "0…360"),
            ("sky:35", "sky:ELEVATION,TURBIDITY"),
            ("sky:-1,3", "0…90"),
            ("sky:30,1", "2…10"),
            ("sky:nan,3", "0…90"),
            ("", "path"),
            ("sun:\n", "\\n"),
            ("sky_{px,nx}.hdr", "six different names"),
            ("sky_{a,b,c,d,e,a}.hdr", "six different names"),
            ("{a,b,c,d,e,f}{g}.hdr", "six different names"),
        ] {
            let message = parse(text).unwrap_err().to_string();
            assert!(message.contains(needle), "{text}: {message}");
            assert_eq!(message.lines().count(), 1, "{message}");
        }
    }
}
