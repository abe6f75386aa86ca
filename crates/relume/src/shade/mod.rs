//! Transfer and light in, radiance out.
