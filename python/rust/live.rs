//! `Live`: a closed valve whose ring is changed bit by bit, each closure beginning where the last one ended.
//!
//! The library's [`Interactive`] borrows its model. A thread of its own holds both, and is asked by messages; it dies with the
//! handle. It belongs to a small pool of its own, whose other threads help with large valves: were it to hand each edit over to the
//! common pool, two more threads would have to wake for every move of a slider. A forked child has no such threads: it gets new ones,
//! which go on from the last closed shape.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use coapt::Vec3;
use coapt::relax::{Equilibrium, Interactive};
use coapt::scene::{Fault, Repair};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::built::Built;
use crate::closed::{Closed, Inner, Relaxed};
use crate::fault::input_error;
use crate::repair::{ReadRepair, repairs_of};
use crate::run::{Stop, pool, wait};

/// A closed valve that follows edits.
#[pyclass(frozen, module = "coapt._coapt")]
pub(crate) struct Live {
    /// The valve without any edit; its supports are the same as with them.
    base: Arc<Built>,
    now: Mutex<Now>,
}

struct Now {
    closed: Py<Closed>,
    /// The last but one.
    past: Option<Arc<Inner>>,
    thread: Option<Thread>,
}

/// Who closes the valve.
struct Thread {
    /// The number of its process.
    process: u32,
    /// Dropped, it ends the work of the pool; hence before it.
    ask: Sender<Request>,
    pool: Option<ThreadPool>,
}

impl Drop for Thread {
    fn drop(&mut self) {
        if self.process != std::process::id() {
            // Its threads are the parent's: to end them would be to wait for them for ever.
            std::mem::forget(self.pool.take());
        }
    }
}

/// Repairs of the valve without any, and where to tell the outcome.
struct Request {
    repairs: Vec<Repair>,
    stop: Stop,
    tell: Sender<Option<Answer>>,
    /// Given up while the caller goes on with the answer: to free a valve takes a fifth of what an edit may cost beside its closure.
    past: Option<Arc<Inner>>,
}

type Answer = Result<(Built, Relaxed), Vec<Fault>>;

#[pymethods]
impl Live {
    /// Goes on from a closed valve.
    #[new]
    fn new(closed: Bound<'_, Closed>) -> Self {
        Self {
            base: Arc::clone(&closed.get().inner.built),
            now: Mutex::new(Now {
                closed: closed.unbind(),
                past: None,
                thread: None,
            }),
        }
    }

    /// The valve as it now is.
    #[getter]
    fn closed(&self, py: Python<'_>) -> Py<Closed> {
        self.lock().closed.clone_ref(py)
    }

    /// Closes the valve again with these repairs instead of those of the last edit.
    fn set(&self, py: Python<'_>, repairs: Vec<Bound<'_, ReadRepair>>) -> PyResult<Py<Closed>> {
        let repairs = repairs_of(&repairs);
        let stop = Stop::default();
        let (tell, told) = channel();
        let past = self.lock().past.take();
        self.ask(
            py,
            Request {
                repairs,
                stop: stop.clone(),
                tell,
                past,
            },
        )?;
        let (repaired, relaxed) = wait(py, &stop, told)?.map_err(|faults| input_error(py, &faults))?;
        let closed = Py::new(py, Closed::new(Arc::new(repaired), relaxed))?;
        let mut now = self.lock();
        let last = std::mem::replace(&mut now.closed, closed.clone_ref(py));
        now.past = Some(Arc::clone(&last.get().inner));
        drop(now);
        Ok(closed)
    }
}

impl Live {
    /// Held for moments only, and with Python's lock held.
    fn lock(&self) -> std::sync::MutexGuard<'_, Now> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn ask(&self, py: Python<'_>, request: Request) -> PyResult<()> {
        let mut now = self.lock();
        let thread = match now.thread.take() {
            Some(thread) if thread.process == std::process::id() => thread,
            _ => begin(
                Arc::clone(&self.base),
                now.closed.get().inner.relaxed.equilibrium.clone(),
                pool(py)?.current_num_threads(),
            )?,
        };
        let sent = thread.ask.send(request);
        now.thread = Some(thread);
        sent.map_err(|_| PyRuntimeError::new_err("the thread of this live valve is gone; make a new one"))
    }
}

/// Whether two models differ in where their held vertices end and in nothing else that a closure would notice.
fn changes_targets_only(before: &Built, after: &Built) -> bool {
    let (before, after) = (&before.model, &after.model);
    let held = |model: &coapt::model::Model| -> Vec<u32> {
        model.prescribed.iter().map(|held| held.vertex).collect()
    };
    before.rest_mm == after.rest_mm
        && before.faces == after.faces
        && before.springs == after.springs
        && before.chords.ends == after.chords.ends
        && held(before) == held(after)
}

/// A thread that closes the valve as often as it is asked, in a pool of so many.
fn begin(base: Arc<Built>, closed: Equilibrium, threads: usize) -> PyResult<Thread> {
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|_| "coapt live".into())
        .build()
        .map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    let (ask, asked) = channel();
    pool.spawn(move || {
        // A panic in a pool's thread would end the process; so it ends the work alone, and whoever waits is told that nobody answers.
        let _ = catch_unwind(AssertUnwindSafe(|| serve(&base, &closed, &asked)));
    });
    Ok(Thread {
        process: std::process::id(),
        ask,
        pool: Some(pool),
    })
}

/// Ends once the handle is gone.
fn serve(base: &Built, closed: &Equilibrium, asked: &Receiver<Request>) {
    let mut live = Interactive::new(&base.model, closed);
    while let Ok(Request {
        repairs,
        stop,
        tell,
        past,
    }) = asked.recv()
    {
        let answer = edited(base, &mut live, &repairs, &stop);
        // Whoever was interrupted listens no more.
        let _ = tell.send(Some(answer));
        drop(past);
    }
}

/// The valve with these repairs alone, closed.
fn edited(base: &Built, live: &mut Interactive<'_>, repairs: &[Repair], stop: &Stop) -> Answer {
    // All that the library does for an edit: to lay a ring is a part of it.
    let begun = Instant::now();
    let repaired = base.repaired(repairs)?;
    if !changes_targets_only(base, &repaired) {
        let message = "changes more than where annulus and papillary tips end; expected rings and relocations of papillary \
                       muscles (close a valve `with_repair` for all others)";
        return Err(vec![Fault::error("repair", message)]);
    }
    let held = repaired.model.prescribed.iter();
    let targets_mm: Vec<Vec3> = held.map(|held| held.target_mm).collect();
    let closed = live.close_watched(&targets_mm, |_| stop.flow());
    let wall_ms = begun.elapsed().as_secs_f64() * 1e3;
    let equilibrium = closed.map_err(|fault| vec![fault])?;
    Ok((repaired, Relaxed { equilibrium, wall_ms }))
}
