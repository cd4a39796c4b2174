//! How a verb ends and how it speaks.

use std::io::{ErrorKind, Write};

use coapt::scene::{Fault, Severity};
use coapt_io::escape::{escaped, escaped_lines};
use coapt_io::scene::sentence;

/// A verb ran to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// All is well.
    Done,
    /// There is a result that must not be trusted as it stands.
    Uncertified,
}

/// A verb did not run to its end.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Wrong usage or wrong input.
    Input(Vec<Fault>),
    /// The file system or the machine stood against it.
    Outside(Fault),
}

impl From<Vec<Fault>> for Failure {
    fn from(faults: Vec<Fault>) -> Self {
        Self::Input(faults)
    }
}

/// Writes a result, text or JSON, to standard output, with nothing in it that a terminal would obey. A reader that has
/// gone away, as `head` does, is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out
        .write_all(escaped_lines(text).as_bytes())
        .and_then(|()| out.flush())
    {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::Outside(Fault::error(
            "standard output",
            error.to_string(),
        ))),
        _ => Ok(()),
    }
}

/// Writes faults to standard error, a line each.
pub(crate) fn tell(faults: &[Fault]) {
    faults.iter().for_each(|fault| say(&fault_line(fault)));
}

/// Writes a line of words to standard error; where that is closed there is nobody to tell.
pub(crate) fn say(line: &str) {
    let _ = std::io::stderr()
        .lock()
        .write_all((escaped(line) + "\n").as_bytes());
}

/// `error: scene.toml:12: leaflets[0].thickness_mm is -1 mm, expected ...`, on one line whatever is told.
pub(crate) fn fault_line(fault: &Fault) -> String {
    let severity = match fault.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    escaped(&format!("{severity}: {}", sentence(fault)))
}
