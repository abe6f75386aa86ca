//! Work without the interpreter: other Python threads go on, and Ctrl-C is heard.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::failure;

/// How often signals are looked for.
const TICK: Duration = Duration::from_millis(40);
/// How long cancelled work may take to stop before it is left to do so by itself.
const GRACE: Duration = Duration::from_millis(60);

/// Runs `work`, which does not take long.
pub fn brief<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| catch_unwind(AssertUnwindSafe(work)))
        .map_err(|payload| failure::panic(&*payload))
}

/// Runs `work` on a thread of its own while this one looks for signals.
///
/// A signal whose handler raises (as Ctrl-C does) sets `cancelled`; the exception leaves here within [`TICK`] and [`GRACE`] even where
/// the work takes longer to notice, for it owns all it needs. Python delivers signals to its main thread only.
pub fn long<T: Send + 'static>(
    py: Python<'_>,
    cancelled: &Arc<AtomicBool>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = sync_channel(1);
    let run = move || {
        // Nobody listens any more where the exception has left.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
    };
    std::thread::Builder::new()
        .name("relume".to_owned())
        .spawn(run)?;
    py.detach(move || {
        loop {
            match receiver.recv_timeout(TICK) {
                Ok(outcome) => return outcome.map_err(|payload| failure::panic(&*payload)),
                Err(RecvTimeoutError::Disconnected) => return Err(failure::panic(&"no result")),
                Err(RecvTimeoutError::Timeout) => (),
            }
            let signals = Python::attach(|py: Python<'_>| -> PyResult<()> { py.check_signals() });
            if let Err(raised) = signals {
                cancelled.store(true, Ordering::Relaxed);
                let _ = receiver.recv_timeout(GRACE);
                return Err(raised);
            }
        }
    })
}

/// Threads for short work. A process that was forked off has none of its parent's, so it gets its own.
pub fn pool() -> PyResult<Arc<ThreadPool>> {
    static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some((owner, pool)) = &*pool
        && *owner == process
    {
        return Ok(pool.clone());
    }
    let fresh = ThreadPoolBuilder::new()
        .build()
        .map_err(|error| pyo3::exceptions::PyRuntimeError::new_err(error.to_string()))?;
    let fresh = Arc::new(fresh);
    // Dropping a parent's pool would wait for threads that are not there.
    std::mem::forget(pool.replace((process, fresh.clone())));
    Ok(fresh)
}
