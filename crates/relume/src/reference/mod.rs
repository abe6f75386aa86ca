//! A plain path tracer: the oracle the bake is judged by.
