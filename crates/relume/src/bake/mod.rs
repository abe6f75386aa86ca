//! Scene in, transfer out.
