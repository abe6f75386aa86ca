//! Independent work on all threads, or on one where the feature `bake` (and with it threads) is left out. Results come in order, so they do not depend on it.

/// `f(0), f(1), …`
pub fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    #[cfg(feature = "bake")]
    {
        use rayon::prelude::*;
        (0..count).into_par_iter().map(f).collect()
    }
    #[cfg(not(feature = "bake"))]
    (0..count).map(f).collect()
}

/// Calls `f` with the number and the values of each run of `width` values; the last run may be shorter.
pub fn chunks<T: Send>(values: &mut [T], width: usize, f: impl Fn(usize, &mut [T]) + Sync + Send) {
    #[cfg(feature = "bake")]
    {
        use rayon::prelude::*;
        let chunks = values.par_chunks_mut(width).enumerate();
        chunks.for_each(|(i, values)| f(i, values));
    }
    #[cfg(not(feature = "bake"))]
    for (i, values) in values.chunks_mut(width).enumerate() {
        f(i, values);
    }
}
