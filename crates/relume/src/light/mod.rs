//! Light that arrives at the scene, as coefficients of a basis.

mod incident;

pub use incident::{IncidentLight, ShLight};
