//! How a picture is wrapped around the sphere.
//!
//! Places in a picture are `(u, v)` in 0…1: u to the right, v down, from the top left corner. Directions are world directions
//! (right-handed, +Y up) pointing away from the scene.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;
use std::str::FromStr;

use glam::DVec3;
use thiserror::Error;

use crate::files::printable;

use super::cross;

/// How a picture is wrapped around the sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Layout {
    /// Latitude and longitude as OpenEXR and USD define them: +Y up, longitude 0 is +Z at the centre, π/2 is +X left of it, and
    /// the top left corner is (+π/2, +π).
    LatLong,
    /// Angular map (light probe): with (u, v) in −1…1, v up, and r² = u² + v², the direction is (u s, v s, −cos πr) with
    /// s = sin(πr)/r. The centre is −Z, the rim of the disc +Z; outside the disc is nothing.
    Angular,
    /// Cube cross, three wide and four high: +Y on top; −X, −Z, +X; −Y; and +Z at the bottom, turned by 180°.
    VCross,
    /// Cube cross, four wide and three high: +Y above −Z; −X, −Z, +X, +Z; −Y below −Z.
    HCross,
    /// The six faces of a cube map side by side, as Direct3D orders and turns them (px, nx, py, ny, pz, nz), with z → −z: +X, −X, +Y, −Y,
    /// −Z, +Z.
    Faces,
}

/// A layout, or the one that the shape of the picture suggests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LayoutChoice {
    /// 2:1 is lat-long, 1:1 an angular map, 3:4 a vertical cross, 4:3 a horizontal cross, 6:1 the faces of a cube.
    #[default]
    Auto,
    /// This one.
    Fixed(Layout),
}

/// The layout is unknown, or does not fit the picture.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// No layout has that name.
    #[error("layout \"{}\" is unknown; use auto, latlong, angular, vcross, hcross or faces", printable(.0))]
    Unknown(String),
    /// No layout has that shape.
    #[error(
        "{width} × {height} pixels suggest no layout (2:1 latlong, 1:1 angular, 3:4 vcross, 4:3 hcross, 6:1 faces); name it with --layout or crop the image"
    )]
    NoGuess {
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
    },
    /// The layout asked for has another shape.
    #[error(
        "layout {layout} needs {needs}, but the image is {width} × {height} pixels; choose another --layout or crop the image"
    )]
    Misfit {
        /// The layout asked for.
        layout: Layout,
        /// The shape it has.
        needs: &'static str,
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
    },
    /// A cube map has its own.
    #[error("it is a cube map, which is not wrapped as {0}; leave --layout out")]
    Cube(Layout),
}

impl Layout {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::LatLong,
        Self::Angular,
        Self::VCross,
        Self::HCross,
        Self::Faces,
    ];

    /// The name, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::LatLong => "latlong",
            Self::Angular => "angular",
            Self::VCross => "vcross",
            Self::HCross => "hcross",
            Self::Faces => "faces",
        }
    }

    /// The layout that the shape of a picture suggests.
    pub fn guess(width: usize, height: usize) -> Result<Self, LayoutError> {
        [
            (2, 1, Self::LatLong),
            (1, 1, Self::Angular),
            (3, 4, Self::VCross),
            (4, 3, Self::HCross),
            (6, 1, Self::Faces),
        ]
        .into_iter()
        .find(|&(across, down, _)| {
            width > 0
                && width.is_multiple_of(across)
                && height.is_multiple_of(down)
                && width / across == height / down
        })
        .map(|(_, _, layout)| layout)
        .ok_or(LayoutError::NoGuess { width, height })
    }

    /// Refuses pictures of another shape. Lat-long may have any.
    pub fn check(self, width: usize, height: usize) -> Result<(), LayoutError> {
        let needs = match self {
            Self::LatLong => return Ok(()),
            Self::Angular => "a square",
            Self::VCross => "3 × 4 equal squares",
            Self::HCross => "4 × 3 equal squares",
            Self::Faces => "6 equal squares in a row",
        };
        match Self::guess(width, height) {
            Ok(layout) if layout == self => Ok(()),
            _ => Err(LayoutError::Misfit {
                layout: self,
                needs,
                width,
                height,
            }),
        }
    }

    /// The unit direction that the place (u, v) of a picture shows; `None` where the layout shows nothing.
    pub fn direction(self, u: f64, v: f64) -> Option<DVec3> {
        match self {
            Self::LatLong => Some(latlong(PI * (1.0 - 2.0 * u), FRAC_PI_2 - PI * v)),
            Self::Angular => {
                let (x, y) = (2.0 * u - 1.0, 1.0 - 2.0 * v);
                (x * x + y * y <= 1.0).then(|| angular(x, y))
            }
            Self::VCross => cross::VERTICAL.direction(u, v),
            Self::HCross => cross::HORIZONTAL.direction(u, v),
            Self::Faces => cross::ROW.direction(u, v),
        }
    }

    /// The place (u, v) that shows a direction of any length but 0: the inverse of [`Layout::direction`].
    pub fn place(self, d: DVec3) -> (f64, f64) {
        match self {
            Self::LatLong => {
                let longitude = libm::atan2(d.x, d.z);
                let latitude = libm::atan2(d.y, (d.x * d.x + d.z * d.z).sqrt());
                (0.5 - longitude / (2.0 * PI), 0.5 - latitude / PI)
            }
            Self::Angular => {
                let across = (d.x * d.x + d.y * d.y).sqrt();
                let radius = libm::atan2(across, -d.z) / PI;
                // Straight ahead is the centre; of the rim, which is all one direction, take the right end.
                let (x, y) = if across > 0.0 {
                    (d.x / across, d.y / across)
                } else {
                    (1.0, 0.0)
                };
                (0.5 + 0.5 * radius * x, 0.5 - 0.5 * radius * y)
            }
            Self::VCross => cross::VERTICAL.place(d),
            Self::HCross => cross::HORIZONTAL.place(d),
            Self::Faces => cross::ROW.place(d),
        }
    }

    /// Where the faces of a cube lie, for layouts that show one.
    pub(super) fn cross(self) -> Option<&'static cross::Cross> {
        match self {
            Self::VCross => Some(&cross::VERTICAL),
            Self::HCross => Some(&cross::HORIZONTAL),
            Self::Faces => Some(&cross::ROW),
            Self::LatLong | Self::Angular => None,
        }
    }
}

impl LayoutChoice {
    /// The layout of a picture whose file says that it is `known`; any other choice is an error.
    pub(super) fn agree(self, known: Layout) -> Result<Layout, LayoutError> {
        match self {
            Self::Fixed(layout) if layout != known => Err(LayoutError::Cube(layout)),
            _ => Ok(known),
        }
    }

    /// The layout of a picture of this size; an error when none fits.
    pub fn resolve(self, width: usize, height: usize) -> Result<Layout, LayoutError> {
        match self {
            Self::Auto => Layout::guess(width, height),
            Self::Fixed(layout) => layout.check(width, height).map(|()| layout),
        }
    }
}

/// The direction at a longitude and latitude in radians.
fn latlong(longitude: f64, latitude: f64) -> DVec3 {
    let ring = libm::cos(latitude);
    DVec3::new(
        ring * libm::sin(longitude),
        libm::sin(latitude),
        ring * libm::cos(longitude),
    )
}

/// The direction at (x, y) of an angular map, −1…1 and y up. Beyond the rim the formula runs on, past +Z.
pub(super) fn angular(x: f64, y: f64) -> DVec3 {
    let r = (x * x + y * y).sqrt();
    let s = if r > 0.0 { libm::sin(PI * r) / r } else { PI };
    DVec3::new(x * s, y * s, -libm::cos(PI * r))
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for LayoutChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Fixed(layout) => layout.fmt(f),
        }
    }
}

impl FromStr for Layout {
    type Err = LayoutError;

    fn from_str(text: &str) -> Result<Self, LayoutError> {
        Self::ALL
            .into_iter()
            .find(|layout| layout.name() == text)
            .ok_or_else(|| LayoutError::Unknown(text.to_owned()))
    }
}

impl FromStr for LayoutChoice {
    type Err = LayoutError;

    fn from_str(text: &str) -> Result<Self, LayoutError> {
        match text {
            "auto" => Ok(Self::Auto),
            _ => text.parse().map(Self::Fixed),
        }
    }
}

impl From<Layout> for LayoutChoice {
    fn from(layout: Layout) -> Self {
        Self::Fixed(layout)
    }
}

#[cfg(test)]
#[path = "layout_tests.rs"]
mod tests;
