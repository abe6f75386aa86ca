//! Pictures of a baked asset.
