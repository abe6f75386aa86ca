//! A plain path tracer: the oracle of the bake.
//!
//! It shares [`World`](crate::scene::World) with the baker and nothing else: the rays go one by one through obvhs's own traversal and
//! triangle test, the random numbers are PCG32 and a shifted Hammersley set, the light is evaluated in f64 at the direction in which a
//! path leaves the scene. Nothing is interpolated between vertices, so a bake differs from it by its noise and by its mesh.
//!
//! What it estimates, at a receiver with unit normal `n`, is the *transferred radiance*: irradiance over π after at most `k`
//! interreflections, **without the receiver's own albedo**,
//!
//! ```text
//! E_k(x)/π = 1/π ∫ max(0, n·ω) L_k(x, ω) dω,    L_k(x, ω) = L(ω) where ω is free, else albedo(y) · E_{k-1}(y)/π at the point y it hits.
//! ```
//!
//! Surfaces: a back face blocks and reflects nothing unless its material is double-sided, in which case both sides reflect alike; the
//! holes of an alpha mask let rays through; albedo = factor × vertex colour × texture at the point hit. The front is the side of the
//! **interpolated shading normal** (as in Mitsuba): a ray that meets the surface against it is reflected about it, whatever the plane
//! of the triangle says, and a reflected ray that dives under that plane goes on to meet back faces, which are black.
//!
//! Surfaces are diffuse unless the caller gives others ([`Surfaces`]); [`estimate_outgoing`] and [`render_surfaces`] then sample each
//! reflection by its BRDF and estimate radiance toward an eye, the first BRDF included.
//!
//! Emitters ([`Sources::emitters`]) are looked for: each surface a path meets, and the receiver, takes the light of one random point of theirs if
//! nothing is in the way. A path that meets an emitter by chance ends there and brings nothing, for it has been counted. Of
//! [`light::emitter`](crate::light::emitter) this uses the corners and the radiance of a point toward another, and finds by rays of its own what is in the way.

mod compare;
mod estimate;
mod figures;
mod intersect;
mod lamps;
mod outgoing;
mod patch;
mod path;
mod picture;
mod rng;
mod sources;
mod statistics;
mod surfaces;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_emitters;
#[cfg(test)]
mod tests_emitters_scene;
#[cfg(test)]
mod tests_glossy;
mod toward;

pub use compare::{CompareOptions, Comparison, VertexError, compare, compare_radiance};
pub use estimate::{
    Estimate, EstimateOptions, Receiver, TransferEstimate, estimate, estimate_transfer,
    receivers_at, sh_radiance,
};
pub use figures::Interval;
pub use outgoing::{Seen, estimate_outgoing};
pub use picture::{RenderOptions, render, render_surfaces};
pub use sources::{Light, Sources};
pub use surfaces::{Surfaces, diffuse_surfaces, material_surfaces};
pub use toward::{compare_outgoing, compare_toward, compare_transferred};
