//! What goes to standard output and to standard error: with colours on a terminal, without them elsewhere or if
//! `NO_COLOR` is set.

use super::exit::{Code, Failure};
use anstream::AutoStream;
use std::io::{ErrorKind, Write, stderr, stdout};
use urts_mc::report::terminal::BAD;
use urts_mc::util::hidden::spelled_out;

/// Prints to standard output; a reader that went away is not an error.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut stream = AutoStream::auto(stdout()).lock();
    match stream.write_all(text.as_bytes()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::new(
            Code::Other,
            format!(
                "standard output: cannot be written ({error}); make room, or send it elsewhere"
            ),
        )),
        _ => Ok(()),
    }
}

/// Prints a value as JSON to standard output.
pub(super) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    print(&format!("{}\n", serde_json::to_string_pretty(value)?))
}

/// Says on standard error what is worth knowing before the work begins.
pub(super) fn print_note(note: &str) {
    let mut stream = AutoStream::auto(stderr()).lock();
    // There is no other place to say it.
    let _ = writeln!(stream, "note: {}", spelled_out(note));
}

/// Says what went wrong on standard error.
pub(crate) fn print_error(failure: &Failure) {
    let mut stream = AutoStream::auto(stderr()).lock();
    // There is no other place to say that nothing can be said.
    let message = spelled_out(&failure.message);
    let _ = match failure.code {
        // Nothing went wrong: somebody asked for it.
        Code::Partial => writeln!(stream, "partial: {message}"),
        _ => writeln!(stream, "{BAD}error:{BAD:#} {message}"),
    };
}
