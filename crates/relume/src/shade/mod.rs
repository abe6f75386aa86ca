//! Transfer and light in, radiance out.

mod vector;

pub use vector::{radiance, transferred_radiance, transferred_radiance_back};
