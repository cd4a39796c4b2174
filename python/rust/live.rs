//! `Live`: a closed valve whose ring is changed bit by bit, each closure beginning where the last one ended.
//!
//! The library's [`Interactive`] borrows its model; a [`Solver`] holds both. It is bound to no thread: small valves are closed by the
//! calling one, since to wake another for every move of a slider costs more than all else that an edit takes beside its closure.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::ThreadId;
use std::time::Instant;

use coapt::Vec3;
use coapt::relax::Interactive;
use coapt::scene::{Fault, Repair};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use self_cell::self_cell;

use crate::built::Built;
use crate::closed::{Closed, Inner, Relaxed};
use crate::fault::input_error;
use crate::repair::{ReadRepair, repairs_of};
use crate::run::{Ask, may_run_here, pool, run, run_here, wait_for};

/// A closed valve that follows edits.
#[pyclass(frozen, module = "coapt._coapt")]
pub(crate) struct Live {
    /// The valve without any edit; its supports are the same as with them.
    base: Arc<Built>,
    /// Locked with Python's lock held only, as forks of Python are made.
    now: Mutex<Now>,
    /// Threads in the midst of [`Live::set`].
    within: Mutex<Vec<ThreadId>>,
}

/// A thread's stay in the midst of an edit.
struct Within<'a>(&'a Mutex<Vec<ThreadId>>);

impl<'a> Within<'a> {
    /// # Errors
    /// It is there already: a signal handler that edits the valve whose edit it interrupts would wait for itself.
    fn enter(threads: &'a Mutex<Vec<ThreadId>>) -> PyResult<Self> {
        let this = std::thread::current().id();
        let mut within = lock(threads);
        if within.contains(&this) {
            return Err(PyRuntimeError::new_err(
                "the valve is in the midst of an edit by this very thread",
            ));
        }
        within.push(this);
        Ok(Self(threads))
    }
}

impl Drop for Within<'_> {
    fn drop(&mut self) {
        let this = std::thread::current().id();
        lock(self.0).retain(|thread| *thread != this);
    }
}

struct Now {
    closed: Py<Closed>,
    solver: Arc<Mutex<Kept>>,
    /// The number of the solver's process.
    process: u32,
}

/// A solver between edits, which take it in turn; the first one makes it.
#[derive(Default)]
struct Kept {
    solver: Option<Solver>,
    is_taken: bool,
}

self_cell! {
    /// The valve without any edit, and what closes it.
    struct Solver {
        owner: Arc<Built>,
        #[covariant]
        dependent: Interactive,
    }
}

/// The solver for as long as one edit lasts. It is taken before work is handed to a pool: an edit that waited there for another one
/// could be what a thread of that one does meanwhile, and both would wait for ever.
struct Turn {
    kept: Arc<Mutex<Kept>>,
    solver: Option<Solver>,
}

impl Turn {
    /// None while another edit has the solver.
    fn take(kept: &Arc<Mutex<Kept>>) -> Option<Self> {
        let mut now = lock(kept);
        if std::mem::replace(&mut now.is_taken, true) {
            return None;
        }
        Some(Self {
            kept: Arc::clone(kept),
            solver: now.solver.take(),
        })
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        // What a panic leaves may be anything.
        let solver = self.solver.take().filter(|_| !std::thread::panicking());
        *lock(&self.kept) = Kept {
            solver,
            is_taken: false,
        };
    }
}

/// A moment's hold.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

type Answer = Result<(Built, Relaxed), Vec<Fault>>;

/// Vertices up to which the calling thread closes the valve itself, some 1,800 faces. It looks for signals between iterations only:
/// at 1,400 vertices they waited for up to 0.14 s on a busy machine, at 400 for 0.03 s.
const SMALL: usize = 1_000;

#[pymethods]
impl Live {
    /// Goes on from a closed valve.
    #[new]
    fn new(closed: Bound<'_, Closed>) -> Self {
        Self {
            base: Arc::clone(&closed.get().inner.built),
            now: Mutex::new(Now {
                closed: closed.unbind(),
                solver: Arc::default(),
                process: std::process::id(),
            }),
            within: Mutex::default(),
        }
    }

    /// The valve as it now is.
    #[getter]
    fn closed(&self, py: Python<'_>) -> Py<Closed> {
        lock(&self.now).closed.clone_ref(py)
    }

    /// Closes the valve again with these repairs instead of those of the last edit.
    fn set(&self, py: Python<'_>, repairs: Vec<Bound<'_, ReadRepair>>) -> PyResult<Py<Closed>> {
        let repairs = repairs_of(&repairs);
        let base = Arc::clone(&self.base);
        let (kept, begin) = self.solver();
        let _within = Within::enter(&self.within)?;
        let turn = wait_for(py, || Turn::take(&kept))?;
        let is_here = base.model.rest_mm.len() <= SMALL && may_run_here(py);
        let edit = move |ask: Ask<'_>| edited(&base, turn, &begin, &repairs, ask);
        let answer = match is_here {
            true => run_here(py, edit)?,
            false => run(py, move |stop| edit(&mut || stop.flow()))?,
        };
        let (repaired, relaxed) = answer.map_err(|faults| input_error(py, &faults))?;
        let closed = Py::new(py, Closed::new(Arc::new(repaired), relaxed))?;
        let last = std::mem::replace(&mut lock(&self.now).closed, closed.clone_ref(py));
        let inner = Arc::clone(&last.get().inner);
        drop(last);
        // To free a valve takes a third of what an edit may cost beside its closure: nobody waits for that.
        pool(py)?.spawn(move || drop(inner));
        Ok(closed)
    }
}

impl Live {
    /// The solver, and the closed valve at which one that is yet to be made begins. A forked child needs one of its own: the parent's
    /// may be in the midst of an edit by a thread that the child does not have.
    fn solver(&self) -> (Arc<Mutex<Kept>>, Arc<Inner>) {
        let mut now = lock(&self.now);
        if now.process != std::process::id() {
            now.process = std::process::id();
            now.solver = Arc::default();
        }
        (Arc::clone(&now.solver), Arc::clone(&now.closed.get().inner))
    }
}

/// The valve with these repairs alone, closed.
fn edited(base: &Arc<Built>, mut turn: Turn, begin: &Inner, repairs: &[Repair], ask: Ask<'_>) -> Answer {
    let solver = turn.solver.get_or_insert_with(|| {
        let closed = &begin.relaxed.equilibrium;
        Solver::new(Arc::clone(base), |base| Interactive::new(&base.model, closed))
    });
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
    let closed = solver.with_dependent_mut(|_, live| live.close_watched(&targets_mm, |_| ask()));
    let wall_ms = begun.elapsed().as_secs_f64() * 1e3;
    let equilibrium = closed.map_err(|fault| vec![fault])?;
    Ok((repaired, Relaxed { equilibrium, wall_ms }))
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
