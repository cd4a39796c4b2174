//! NumPy arrays in and out.
//!
//! What comes in is checked and copied once, into the scene. What goes out is made once, read-only, and kept.

use coapt::Vec3;
use numpy::ndarray::{Array1, Array2};
use numpy::{
    PyArray1, PyArray2, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::fault::one_error;

/// Points of shape `(n, 3)`.
pub(crate) type Points = Vec<[f64; 3]>;

/// Points: float64, C-contiguous, shape `(n, 3)`.
///
/// # Errors
/// Anything else, naming what was found.
pub(crate) fn points(place: &str, given: &Bound<'_, PyAny>) -> PyResult<Points> {
    let expected = "float64, C-contiguous, of shape (n, 3)";
    let read = given.extract::<PyReadonlyArray2<'_, f64>>().ok();
    let rows = read
        .as_ref()
        .filter(|array| array.shape()[1] == 3 && array.is_c_contiguous());
    match rows.map(|array| array.as_slice()) {
        Some(Ok(numbers)) => Ok(numbers.as_chunks().0.to_vec()),
        _ => Err(unexpected(place, given, expected)),
    }
}

/// Numbers: float64, C-contiguous, shape `(n,)`.
///
/// # Errors
/// Anything else, naming what was found.
pub(crate) fn numbers(place: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let read = given.extract::<PyReadonlyArray1<'_, f64>>().ok();
    let slice = read
        .as_ref()
        .filter(|array| array.is_c_contiguous())
        .map(|array| array.as_slice());
    match slice {
        Some(Ok(numbers)) => Ok(numbers.to_vec()),
        _ => Err(unexpected(place, given, "float64, C-contiguous, of shape (n,)")),
    }
}

/// Rows of point numbers, such as triangles: int32, int64, uint32 or uint64, C-contiguous, shape `(n, N)`.
///
/// # Errors
/// Anything else, or a number that no point can have, naming what was found.
pub(crate) fn index_rows<const N: usize>(place: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<[u32; N]>> {
    let flat = indices(given, Some(N));
    let expected = format!("int32, int64, uint32 or uint64, C-contiguous, of shape (n, {N})");
    let flat = flat.ok_or_else(|| unexpected(place, given, &expected))?;
    let rows = whole(given.py(), place, &flat, N)?;
    Ok(rows.as_chunks().0.to_vec())
}

/// Point numbers, shape `(n,)`.
///
/// # Errors
/// As of [`index_rows`].
pub(crate) fn index_list(place: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<u32>> {
    let expected = "int32, int64, uint32 or uint64, C-contiguous, of shape (n,)";
    let flat = indices(given, None).ok_or_else(|| unexpected(place, given, expected))?;
    whole(given.py(), place, &flat, 1)
}

/// The numbers of an array of whole numbers, row by row; none if it is no such array.
fn indices(given: &Bound<'_, PyAny>, columns: Option<usize>) -> Option<Vec<i128>> {
    fn of<T: numpy::Element + Copy + Into<i128>>(
        given: &Bound<'_, PyAny>,
        columns: Option<usize>,
    ) -> Option<Vec<i128>> {
        let wide = |numbers: &[T]| numbers.iter().map(|&number| number.into()).collect();
        match columns {
            Some(columns) => {
                let array = given.extract::<PyReadonlyArray2<'_, T>>().ok()?;
                let fits = array.shape()[1] == columns && array.is_c_contiguous();
                array.as_slice().ok().filter(|_| fits).map(wide)
            }
            None => {
                let array = given.extract::<PyReadonlyArray1<'_, T>>().ok()?;
                let fits = array.is_c_contiguous();
                array.as_slice().ok().filter(|_| fits).map(wide)
            }
        }
    }
    of::<i64>(given, columns)
        .or_else(|| of::<i32>(given, columns))
        .or_else(|| of::<u32>(given, columns))
        .or_else(|| of::<u64>(given, columns))
}

/// Numbers as those of points.
fn whole(py: Python<'_>, place: &str, flat: &[i128], columns: usize) -> PyResult<Vec<u32>> {
    let fits = |(at, &number): (usize, &i128)| {
        u32::try_from(number).map_err(|_| {
            let message = format!(
                "has {number} in row {}; expected the number of a point, from 0",
                at / columns
            );
            one_error(py, place, message)
        })
    };
    flat.iter().enumerate().map(fits).collect()
}

/// `is float32 of shape (4, 3); expected float64, C-contiguous, of shape (n, 3)`
fn unexpected(place: &str, given: &Bound<'_, PyAny>, expected: &str) -> PyErr {
    let py = given.py();
    let found = match given.cast::<PyUntypedArray>() {
        Ok(array) => {
            let order = match array.is_c_contiguous() {
                true => "",
                false => ", not C-contiguous",
            };
            let shape: Vec<String> = array.shape().iter().map(usize::to_string).collect();
            let comma = if shape.len() == 1 { "," } else { "" };
            let native = match array.dtype().is_native_byteorder() {
                Some(false) => " of foreign byte order",
                _ => "",
            };
            format!(
                "{}{native} of shape ({}{comma}){order}",
                array.dtype(),
                shape.join(", ")
            )
        }
        Err(_) => match given.get_type().name() {
            Ok(kind) => format!("of type {kind}"),
            Err(error) => return error,
        },
    };
    let advice = "numpy.ascontiguousarray(..., dtype=...) makes one";
    one_error(
        py,
        place,
        format!("is {found}; expected a NumPy array, {expected} ({advice})"),
    )
}

/// Points as a read-only array of shape `(n, 3)`.
pub(crate) fn out_points<'py>(py: Python<'py>, points: &[Vec3]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat: Vec<f64> = points
        .iter()
        .flat_map(|point| [point.x, point.y, point.z])
        .collect();
    out_rows(py, flat, 3)
}

/// Rows of numbers as a read-only array of shape `(n, columns)`.
pub(crate) fn out_rows<T: numpy::Element>(
    py: Python<'_>,
    flat: Vec<T>,
    columns: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = Array2::from_shape_vec((flat.len() / columns, columns), flat);
    let rows = rows.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    Ok(read_only(PyArray2::from_owned_array(py, rows)))
}

/// Numbers as a read-only array of shape `(n,)`.
pub(crate) fn out_list<T: numpy::Element>(py: Python<'_>, numbers: Vec<T>) -> Bound<'_, PyArray1<T>> {
    read_only(PyArray1::from_owned_array(py, Array1::from_vec(numbers)))
}

fn read_only<T: numpy::Element, D: numpy::ndarray::Dimension>(
    array: Bound<'_, numpy::PyArray<T, D>>,
) -> Bound<'_, numpy::PyArray<T, D>> {
    // Nobody else has seen it yet.
    let _ = array.readwrite().make_nonwriteable();
    array
}
