//! Words for people on the terminal.

use std::io::{ErrorKind, Write, stderr, stdout};

use crate::error::{Error, Result};

/// Prints a line on the standard output; a reader that has gone away wants no more and is no error.
///
/// # Errors
/// [`Error::File`] when it cannot be written, as on a full device.
pub fn say(text: &str) -> Result<()> {
    let mut out = stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => Err(Error::File { path: "standard output".into(), source }),
        _ => Ok(()),
    }
}

/// Prints a line on the standard error, if it can be printed there.
pub fn note(text: &str) {
    let mut out = stderr().lock();
    // nobody is left to be told
    let _ = writeln!(out, "{text}").and_then(|()| out.flush());
}
