//! Ctrl-C.

use relume::files;

use crate::failure::Failure;

/// From now on Ctrl-C ends the program with status 130.
///
/// Results are written to temporary files that are renamed when whole, so there is nothing to undo, except while one is being written:
/// that write is finished first.
pub fn listen() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        files::wait_for_writes();
        eprintln!("\ninterrupted: nothing was left half written");
        std::process::exit(130);
    })
    .map_err(|error| Failure::new(format!("cannot listen for Ctrl-C: {error}")))
}
