//! How far long work has come, counted by its threads and told by the thread that waits for it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pyo3::prelude::*;

/// Counts what is done, of how many.
#[derive(Clone, Debug, Default)]
pub(crate) struct Count(Arc<Mutex<Counted>>);

#[derive(Debug, Default)]
struct Counted {
    done: usize,
    all: usize,
    /// What nobody was told yet: the last of each stage, and where the present one is.
    untold: Vec<(usize, usize)>,
}

impl Counted {
    fn note(&mut self) {
        let now = (self.done, self.all);
        match self.untold.last_mut() {
            // Of one stage, the latest is enough; that nothing is done yet is told for itself.
            Some(last) if last.0 > 0 && last.0 <= now.0 => *last = now,
            _ => self.untold.push(now),
        }
    }
}

impl Count {
    /// Begins a stage of so many.
    pub(crate) fn begin(&self, all: usize) {
        let mut counted = self.lock();
        (counted.done, counted.all) = (0, all);
        counted.note();
    }

    /// There are so many more than was known.
    pub(crate) fn more(&self, more: usize) {
        let mut counted = self.lock();
        counted.all += more;
        counted.note();
    }

    /// One more is done.
    pub(crate) fn step(&self) {
        let mut counted = self.lock();
        counted.done += 1;
        counted.note();
    }

    /// A moment's hold: numbers are good whatever a thread that panicked was doing.
    fn lock(&self) -> MutexGuard<'_, Counted> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A count, and who is told of it.
pub(crate) struct Progress {
    count: Count,
    told_to: Py<PyAny>,
}

impl Progress {
    pub(crate) fn new(count: Count, told_to: Py<PyAny>) -> Self {
        Self { count, told_to }
    }

    /// Tells what has changed since it was told last.
    ///
    /// # Errors
    /// What is raised by whoever is told.
    pub(crate) fn tell(&self, py: Python<'_>) -> PyResult<()> {
        let untold = std::mem::take(&mut self.count.lock().untold);
        for told in untold {
            self.told_to.call1(py, told)?;
        }
        Ok(())
    }
}
