//! Curves from files, such as a ring or an annulus drawn in 3D Slicer.

use std::path::PathBuf;

use coapt::Vec3;
use coapt_io::mesh;
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::out_points;
use crate::fault::{Told, input_error, told};
use crate::run::run;

/// Points [mm], LPS where the file is marked; whether the curve closes on itself; doubts.
type CurveParts<'py> = (Bound<'py, PyArray2<f64>>, bool, Vec<Told>);

/// Reads a curve: Slicer markups JSON or a polyline.
#[pyfunction]
pub(crate) fn read_curve(py: Python<'_>, path: PathBuf) -> PyResult<CurveParts<'_>> {
    let read = run(py, move |_| mesh::read_curve(&path))?;
    let (curve, warnings) = read.map_err(|faults| input_error(py, &faults))?;
    let points: Vec<Vec3> = curve.points_mm.into_iter().map(Vec3::from).collect();
    Ok((
        out_points(py, &points)?,
        curve.closed,
        warnings.iter().map(told).collect(),
    ))
}
