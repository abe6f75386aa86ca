//! Ctrl-C.

use std::sync::OnceLock;

use relume::files;

use crate::failure::Failure;

/// What to tell whoever interrupts.
static PROMISE: OnceLock<&str> = OnceLock::new();

/// From now on Ctrl-C ends the program with status 130.
///
/// Results are written to temporary files that are renamed when whole, and tiles of a bake to its checkpoint, so there is nothing to undo,
/// except while a result is being written: that write is finished first.
pub fn listen() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        files::wait_for_writes();
        let promise = PROMISE.get().unwrap_or(&"nothing was left half written");
        eprintln!("\ninterrupted: {promise}");
        std::process::exit(130);
    })
    .map_err(|error| Failure::new(format!("cannot listen for Ctrl-C: {error}")))
}

/// From now on, whoever interrupts is told this.
pub fn promise(what: &'static str) {
    let _ = PROMISE.set(what);
}
