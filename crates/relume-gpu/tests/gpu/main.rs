//! The GPU against its CPU twins, on every back end that this machine has an adapter for (software ones will do).

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod compare;
mod cube;
mod device;
mod emitters;
mod features;
mod glossy;
mod golden;
mod lamps;
mod lights;
mod limits;
mod near;
mod scenes;
