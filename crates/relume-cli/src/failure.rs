//! What went wrong, in one line.

use std::fmt;

/// An error on its way to the person: what, where, and what to do, on one line.
pub struct Failure(String);

impl Failure {
    pub fn new(message: impl Into<String>) -> Self {
        Self(message.into())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Whatever an error below contained, it stays one line.
        let mut parts = self
            .0
            .split(['\n', '\r'])
            .map(str::trim)
            .filter(|part| !part.is_empty());
        f.write_str(parts.next().unwrap_or("unknown"))?;
        parts.try_for_each(|part| write!(f, " {part}"))
    }
}

impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self(error.to_string())
    }
}
