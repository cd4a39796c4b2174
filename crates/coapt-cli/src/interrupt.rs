//! Ctrl-C, or a closed terminal: tells what was reached, leaves no half-written file, and ends the program at once, whatever it is computing.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use coapt::model::{Model, size};
use coapt::personalise::Watch;
use coapt::relax::{Equilibrium, Moment, relax_watched};
use coapt::state::State;
use coapt_io::atomic::halt;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::output::say;

/// How often signals are looked for: a tenth of the 0.1 s that a person notices, and nothing beside a closure.
const LOOK_EVERY: Duration = Duration::from_millis(10);

/// What runs, by a number that counts up.
#[derive(Debug, Default)]
struct Work {
    begun: u64,
    running: BTreeMap<u64, Reached>,
    /// Closures that came to their end.
    closed: usize,
}

/// How far a closure, or a fit of many, has come.
#[derive(Clone, Debug, Default)]
struct Reached {
    what: String,
    /// Which closure of a fit.
    closure: usize,
    iterations: usize,
    faces: usize,
    residual: f64,
}

static WORK: Mutex<Work> = Mutex::new(Work {
    begun: 0,
    running: BTreeMap::new(),
    closed: 0,
});

fn work() -> MutexGuard<'static, Work> {
    // Numbers for a sentence: good enough whatever a thread that panicked was doing.
    WORK.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From here on the program ends as told above. Where signals cannot be had, it ends as the system does it.
pub(crate) fn listen() {
    let signal = Arc::new(AtomicUsize::new(0));
    let seen = Arc::clone(&signal);
    let look = move || {
        loop {
            match seen.load(Ordering::Relaxed) {
                0 => std::thread::sleep(LOOK_EVERY),
                number => end(number as i32),
            }
        }
    };
    if std::thread::Builder::new().spawn(look).is_err() {
        return;
    }
    let again = Arc::new(AtomicBool::new(false));
    let hang_up = hang_up().filter(|&number| is_heeded(number));
    for number in [SIGINT, SIGTERM].into_iter().chain(hang_up) {
        // The second time at once, without a word: the first may be waiting for a file system.
        let _ = flag::register_conditional_shutdown(number, 128 + number, Arc::clone(&again));
        let _ = flag::register(number, Arc::clone(&again));
        let _ = flag::register_usize(number, Arc::clone(&signal), number as usize);
    }
    ignore_size_limit();
}

/// The signal of a terminal that was closed.
fn hang_up() -> Option<i32> {
    #[cfg(unix)]
    return Some(signal_hook::consts::SIGHUP);
    #[cfg(not(unix))]
    None
}

/// Whether whoever started the program has not asked for a signal to be ignored, as `nohup` does; where the system does not say,
/// the signal is left as it is.
fn is_heeded(number: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_some_and(|mask| mask & (1 << (number - 1)) == 0)
}

/// A file that grows beyond the limit of the system is an error to be told, as a full disk is, not a reason to die.
fn ignore_size_limit() {
    #[cfg(unix)]
    let _ = flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

/// Tells what was reached and ends the program.
fn end(signal: i32) -> ! {
    let halted = halt();
    say(&sentence(&work(), halted.finished()));
    std::process::exit(128 + signal)
}

/// Closes a valve from its open state; an interruption tells how far it came.
pub(crate) fn close_watched(what: &str, model: &Model) -> Equilibrium {
    // Before it is waited for, not after.
    if let Some(notice) = size::notice(model.faces.len()) {
        say(&format!("{what}: {notice} ..."));
    }
    let closed = watching(what, |watch| relax_watched(model, &State::open(model), watch));
    note_closed();
    closed
}

/// Counts a closure that came to its end.
pub(crate) fn note_closed() {
    work().closed += 1;
}

/// Does some work of closures with a watcher that notes for an interruption how far it has come.
pub(crate) fn watching<T>(what: &str, make: impl FnOnce(Watch) -> T) -> T {
    let number = begin(what);
    let made = make(&|moment: &Moment| {
        if let Some(reached) = work().running.get_mut(&number) {
            note(reached, moment);
        }
        ControlFlow::Continue(())
    });
    work().running.remove(&number);
    made
}

fn begin(what: &str) -> u64 {
    let mut work = work();
    work.begun += 1;
    let number = work.begun;
    let reached = Reached {
        what: what.to_owned(),
        ..Reached::default()
    };
    work.running.insert(number, reached);
    number
}

fn note(reached: &mut Reached, moment: &Moment) {
    reached.closure += usize::from(moment.count == 1);
    reached.iterations = moment.count;
    reached.faces = moment.iteration.faces;
    reached.residual = moment.iteration.residual;
}

/// `interrupted: the valve after 37 iterations on 10,400 triangles, residual 0.02; nothing was written`
fn sentence(work: &Work, written: &[PathBuf]) -> String {
    let mut parts: Vec<String> = work.running.values().map(part).collect();
    match work.closed {
        0 => {}
        1 => parts.push("1 closure was complete".to_owned()),
        count => parts.push(format!("{count} closures were complete")),
    }
    match written {
        [] => parts.push("nothing was written".to_owned()),
        _ => parts.push(format!("complete are {}", listed(written))),
    }
    format!("interrupted: {}", parts.join("; "))
}

fn part(reached: &Reached) -> String {
    let Reached {
        what,
        closure,
        iterations,
        faces,
        residual,
    } = reached;
    if *iterations == 0 {
        return format!("{what} before its first iteration");
    }
    // Closures of a fit run side by side: no count of iterations would be one closure's.
    let after = match (*closure, *iterations) {
        (2.., _) => format!("with {closure} closures begun"),
        (_, 1) => "after 1 iteration".to_owned(),
        _ => format!("after {iterations} iterations"),
    };
    format!(
        "{what} {after} on {} triangles, residual {residual:.1e}",
        size::grouped(*faces)
    )
}

fn listed(paths: &[PathBuf]) -> String {
    let names: Vec<String> = paths.iter().map(|path| Path::display(path).to_string()).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_what_was_reached_and_what_is_complete() {
        let reached = |what: &str, closure, iterations| Reached {
            what: what.to_owned(),
            closure,
            iterations,
            faces: 10_400,
            residual: 0.0213,
        };
        let mut work = Work::default();
        assert_eq!(sentence(&work, &[]), "interrupted: nothing was written");
        work.running.insert(1, reached("the valve", 1, 37));
        assert_eq!(
            sentence(&work, &[]),
            "interrupted: the valve after 37 iterations on 10,400 triangles, residual 2.1e-2; nothing was written"
        );
        work.running.insert(2, reached("the fit", 3, 1));
        work.running.insert(3, reached("the last", 0, 0));
        work.closed = 1;
        assert_eq!(
            sentence(&work, &["out/a".into(), "out/b".into()]),
            "interrupted: the valve after 37 iterations on 10,400 triangles, residual 2.1e-2; the fit with 3 closures \
             begun on 10,400 triangles, residual 2.1e-2; the last before its first iteration; 1 closure was complete; \
             complete are out/a, out/b"
        );
    }
}
