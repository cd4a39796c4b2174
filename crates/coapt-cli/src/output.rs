//! How a verb ends and how it speaks.

use std::io::{ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use coapt::scene::Fault;
use coapt_io::check::fault_line;
use coapt_io::escape::{escaped, escaped_lines};

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
    clear_count_line();
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

/// Whether the last line of standard error is one that counts, which goes before anything else is told.
static COUNTING: AtomicBool = AtomicBool::new(false);

/// Back to the beginning of the line, and nothing in it.
const CLEAR_LINE: &str = "\r\x1b[K";

/// Writes a line of words to standard error; where that is closed there is nobody to tell.
pub(crate) fn say(line: &str) {
    clear_count_line();
    let _ = std::io::stderr()
        .lock()
        .write_all((escaped(line) + "\n").as_bytes());
}

/// Writes a line to a terminal that takes the place of the last one; gone once something else is said.
pub(crate) fn count_line(line: &str) {
    COUNTING.store(true, Ordering::Relaxed);
    let _ = std::io::stderr()
        .lock()
        .write_all(format!("{CLEAR_LINE}{}", escaped(line)).as_bytes());
}

/// Takes that line away.
fn clear_count_line() {
    if COUNTING.swap(false, Ordering::Relaxed) {
        let _ = std::io::stderr().lock().write_all(CLEAR_LINE.as_bytes());
    }
}
