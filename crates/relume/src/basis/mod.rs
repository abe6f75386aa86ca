//! Functions on the sphere: real spherical harmonics, their rotation, products, zonal lobes and windows.
//!
//! Everything here is real and orthonormal, without the Condon–Shortley phase, polar axis z, index `i = l(l+1)+m`.

mod order;
pub mod sh;

pub use order::{Order, OrderError, index};
