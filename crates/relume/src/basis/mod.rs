//! Functions on the sphere: real spherical harmonics, their rotation, products, zonal lobes and windows.

mod convention;
#[cfg(test)]
mod fixtures;
mod order;
mod project;
mod quadrature;
mod rotate;
pub mod sh;

pub use convention::{Convention, UnknownConvention};
pub use order::{Order, OrderError, index};
pub use project::{evaluate, evaluate_rgb, project, project_samples};
pub use quadrature::{Quadrature, gauss_legendre};
pub use rotate::{Rotation, RotationError, turn};
