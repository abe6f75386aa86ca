//! Functions on the sphere: real spherical harmonics, their rotation, products, zonal lobes and windows.
//!
//! Everything here is real and orthonormal, without the Condon–Shortley phase, polar axis z, index `i = l(l+1)+m`, directions
//! pointing away from the origin. The folder, in the order of reading:
//!
//! | file | what | in |
//! |---|---|---|
//! | `order` | how many coefficients an expansion has, and which is which | [`Order`], [`index`] |
//! | `sh` | the basis functions in one direction, sixteen or many | [`sh::eval`], [`sh::Evaluator`] |
//! | `quadrature` | exact integration over the sphere | [`Quadrature`], [`gauss_legendre`] |
//! | `project` | function → coefficients → function | [`project()`], [`project_samples`], [`evaluate`], [`evaluate_rgb`] |
//! | `rotate` | rotation of an expansion by a matrix | [`Rotation`], [`turn`] |
//! | `euler` | rotation of many expansions, each by angles of its own | [`EulerRotation`], [`Euler`] |
//! | `hemisphere` | the fit of a function that only a hemisphere sees | [`Hemisphere`] |
//! | `product` | the expansion of a product, triple products | [`Product`] |
//! | `zonal` | lobes about an axis, convolution with them | [`Zonal`] |
//! | `polygon` | integrals over polygons, as a point sees them | [`PolygonHarmonics`] |
//! | `window` | against ringing | [`Window`], [`hann`], [`gauss`] |
//! | `convention` | how other programs write the same coefficients | [`Convention`] |
//!
//! Results are the same bits on every machine: no platform sine, no fused multiply-add, sums in a fixed order.
//!
//! ```
//! use glam::DVec3;
//! use relume::basis::{Order, Rotation, Zonal, evaluate, turn};
//!
//! // A sun of 5° in +z, turned a quarter about x, now stands in −y.
//! let order = Order::new(6)?;
//! let sun = Zonal::disc(order, 5f64.to_radians()).toward(DVec3::Z);
//! let mut turned = vec![0.0; order.count()];
//! Rotation::new(order, turn(DVec3::X, 90f64.to_radians())?)?.apply(&sun, &mut turned);
//! assert!((evaluate(&turned, DVec3::NEG_Y) - evaluate(&sun, DVec3::Z)).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod convention;
mod euler;
#[cfg(test)]
mod fixtures;
mod hemisphere;
mod order;
pub(crate) mod polygon;
mod product;
mod project;
mod quadrature;
mod rotate;
pub mod sh;
mod window;
mod zonal;

pub use convention::{Convention, UnknownConvention};
pub use euler::{Angle, Euler, EulerRotation};
pub use hemisphere::Hemisphere;
pub(crate) use hemisphere::inverse;
pub use order::{Order, OrderError, index};
pub(crate) use polygon::line_of;
pub use polygon::{PolygonHarmonics, PolygonWork};
pub use product::{Entry, Product};
pub use project::{evaluate, evaluate_rgb, project, project_samples};
pub use quadrature::{Quadrature, gauss_legendre};
pub use rotate::{Rotation, RotationError, turn};
pub use window::{Window, WindowError, Windowed, gauss, hann};
pub use zonal::Zonal;
