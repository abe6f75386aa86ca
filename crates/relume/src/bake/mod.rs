//! Scene in, transfer out.

mod sampling;
pub mod trace;
