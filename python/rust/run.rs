//! Work of the library without Python's lock, stopped by Ctrl-C: on threads of our own, or in the calling one if it is short.
//!
//! Work of any length runs on a pool of ours rather than on rayon's global one: a pool does not survive a fork, and only our own
//! can be made anew. The calling thread waits and asks for signals meanwhile; on Ctrl-C it raises `KeyboardInterrupt` at once, and
//! the work ends at its next iteration with nobody listening.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::progress::{Count, Progress};

/// How often signals are asked for: a person does not feel it, and to ask costs a microsecond.
const ASK_EVERY: Duration = Duration::from_millis(20);

/// How often is looked for what another thread of Python will leave.
const LOOK_EVERY: Duration = Duration::from_millis(1);

/// Tells work to stop.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

impl Stop {
    /// What a watcher of the library answers.
    pub(crate) fn flow(&self) -> ControlFlow<()> {
        match self.0.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }

    fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Does work on the pool without Python's lock.
///
/// # Errors
/// `KeyboardInterrupt`, or whatever a signal handler raises; `RuntimeError` if the library panics, which is a fault of its own.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&Stop) -> T + Send + 'static,
) -> PyResult<T> {
    run_told(py, None, |stop, _| work(stop))
}

/// Does work that counts what is done, which the calling thread tells somebody meanwhile.
///
/// # Errors
/// As of [`run`]; what is raised by whoever is told, which stops the work.
pub(crate) fn run_told<T: Send + 'static>(
    py: Python<'_>,
    told_to: Option<Py<PyAny>>,
    work: impl FnOnce(&Stop, &Count) -> T + Send + 'static,
) -> PyResult<T> {
    let stop = Stop::default();
    let count = Count::default();
    let progress = told_to.map(|told_to| Progress::new(count.clone(), told_to));
    let (tell, told) = channel();
    let of_worker = stop.clone();
    pool(py)?.spawn(move || {
        // A panic in a pool's thread would end the process.
        let done = catch_unwind(AssertUnwindSafe(|| work(&of_worker, &count)));
        // Whoever was interrupted listens no more.
        let _ = tell.send(done.ok());
    });
    wait(py, &stop, told, progress)
}

fn wait<T: Send>(
    py: Python<'_>,
    stop: &Stop,
    told: Receiver<Option<T>>,
    progress: Option<Progress>,
) -> PyResult<T> {
    let tell = &|py: Python<'_>| match &progress {
        Some(progress) => progress.tell(py),
        None => Ok(()),
    };
    let done = py.detach(move || {
        loop {
            match told.recv_timeout(ASK_EVERY) {
                Ok(Some(done)) => return Ok(done),
                Ok(None) | Err(RecvTimeoutError::Disconnected) => return Err(failed()),
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(raised) = Python::attach(|py| py.check_signals().and_then(|()| tell(py))) {
                        stop.set();
                        return Err(raised);
                    }
                }
            }
        }
    })?;
    tell(py)?;
    Ok(done)
}

/// Looks for something until it is there, and lets other threads of Python run meanwhile.
///
/// # Errors
/// `KeyboardInterrupt`, or whatever a signal handler raises.
pub(crate) fn wait_for<T>(py: Python<'_>, look: impl Fn() -> Option<T>) -> PyResult<T> {
    loop {
        if let Some(found) = look() {
            return Ok(found);
        }
        py.detach(|| std::thread::sleep(LOOK_EVERY));
        py.check_signals()?;
    }
}

/// Asks whether to go on.
pub(crate) type Ask<'a> = &'a mut dyn FnMut() -> ControlFlow<()>;

/// The process whose calling threads do work themselves: the first in which one did.
static HERE: OnceLock<u32> = OnceLock::new();

/// Whether [`run_here`] may be used. Large factorisations are shared out even there, on rayon's global pool, which a forked child has
/// without its threads and cannot make anew. Asked with Python's lock held, as of [`POOL`].
pub(crate) fn may_run_here(_attached: Python<'_>) -> bool {
    let process = std::process::id();
    *HERE.get_or_init(|| process) == process
}

/// Does short work in the calling thread without Python's lock: to wake another thread and to be woken by it takes longer than all
/// else that this package does for such work. It must ask at least every 0.1 s whether to go on, since signals wait for that.
///
/// # Errors
/// As of [`run`].
pub(crate) fn run_here<T: Send>(py: Python<'_>, work: impl FnOnce(Ask<'_>) -> T + Send) -> PyResult<T> {
    py.detach(|| {
        let mut raised = Ok(());
        let mut asked = Instant::now();
        let mut ask = || {
            if raised.is_ok() && asked.elapsed() >= ASK_EVERY {
                raised = Python::attach(|py| py.check_signals());
                asked = Instant::now();
            }
            match raised {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        };
        let done = catch_unwind(AssertUnwindSafe(|| work(&mut ask)));
        raised?;
        done.map_err(|_| failed())
    })
}

/// What a panic is told as.
fn failed() -> PyErr {
    PyRuntimeError::new_err("coapt failed by a fault of its own; the details are on standard error")
}

/// The threads of a process, by its number. The lock is taken with Python's lock held only, as forks of Python are made: no
/// child finds it taken by a thread that it does not have.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The pool of this process, made when first needed: as many threads as `RAYON_NUM_THREADS` says, else one per core.
pub(crate) fn pool(_attached: Python<'_>) -> PyResult<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((of, pool)) = &*kept
        && *of == process
    {
        return Ok(Arc::clone(pool));
    }
    let made = rayon::ThreadPoolBuilder::new()
        .thread_name(|number| format!("coapt {number}"))
        .build()
        .map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    let made = Arc::new(made);
    if let Some((_, of_parent)) = kept.replace((process, Arc::clone(&made))) {
        // Its threads are the parent's: to end it would be to wait for them for ever.
        std::mem::forget(of_parent);
    }
    Ok(made)
}
