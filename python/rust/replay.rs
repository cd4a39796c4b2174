//! `replay`: makes a recording again and compares every frame.

use std::path::PathBuf;

use coapt_io::record::{Difference, read, replay};
use pyo3::prelude::*;

use crate::fault::input_error;
use crate::run::run;

/// Topic, frame, what differs, the first vertex that does and how far [mm].
type DifferenceParts = (String, usize, String, Option<(usize, f64)>);

/// Frames, different ones, the first of these, farthest way of a vertex [mm], doubts, the same as text.
type ReplayParts = (usize, usize, Option<DifferenceParts>, f64, Vec<String>, String);

/// Makes a recording again.
#[pyfunction(name = "replay")]
pub(crate) fn replayed(py: Python<'_>, path: PathBuf) -> PyResult<ReplayParts> {
    let done = run(py, move |stop| {
        let recording = read(&path).map_err(|fault| vec![fault])?;
        let found = replay(&recording, &|_| stop.flow())?;
        Ok((found, recording.doubts()))
    })?;
    let (found, doubts) = done.map_err(|faults: Vec<_>| input_error(py, &faults))?;
    let text = found.text();
    let parts = |first: Difference| (first.topic, first.frame, first.what, first.vertex);
    Ok((
        found.frames,
        found.different,
        found.first.map(parts),
        found.farthest_mm,
        doubts,
        text,
    ))
}
