//! Scenes of our own making: the courtyard of the demo, and small ones whose transfer is known in closed form.
//!
//! Everything is computed, nothing is read: the same bytes on every machine. Metres, y up; no mesh comes from a file, so
//! [`Scene::document`](crate::scene::Scene::document) is `None`.

mod analytic;
mod courtyard;
mod furniture;
mod paint;
mod part;
mod shapes;

pub use analytic::{bowl, plane_under_sphere, room, sphere};
pub use courtyard::{courtyard, courtyard_camera};

#[cfg(test)]
mod tests;
