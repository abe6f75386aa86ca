//! Precomputed radiance transfer (PRT): bake how light moves through a scene once, then relight it in real time.
//!
//! One equation [sloan2005]: the radiance that leaves a point `x` toward `ω` is
//!
//! ```text
//! L_out(x, ω) = o(x, ω)ᵀ · T(x) · l(x)
//! ```
//!
//! and every module makes one of its factors. Plain data passes from stage to stage:
//!
//! ```text
//! scene ──▶ bake ──▶ asset ──▶ light ──▶ shade ──▶ display
//! ```
//!
//! Conventions (axes, coefficient order, units, what is folded in) stand in `docs/conventions.md`; papers are cited by their key in
//! `docs/references.bib`.
#![cfg_attr(
    test,
    allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")
)]

pub mod asset;
#[cfg(feature = "bake")]
pub mod bake;
pub mod basis;
pub mod brdf;
pub mod display;
pub mod files;
pub mod light;
mod parallel;
#[cfg(feature = "bake")]
pub mod reference;
pub mod scene;
pub mod shade;
pub mod simd;
#[cfg(test)]
mod test_data;

/// The README's Rust runs as a test.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
