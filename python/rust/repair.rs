//! `Repair`: what is to be done to a valve, read once.

use coapt::scene::Repair;
use coapt_io::scene::part_from_table;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::fault::input_error;
use crate::table::table;

/// A repair, whatever valve it is for.
#[pyclass(frozen, name = "Repair", module = "coapt._coapt")]
pub(crate) struct ReadRepair(Repair);

#[pymethods]
impl ReadRepair {
    /// Reads a repair as plans hold it.
    #[new]
    fn new(py: Python<'_>, keys: &Bound<'_, PyDict>) -> PyResult<Self> {
        let kind = keys
            .get_item("kind")?
            .and_then(|kind| kind.extract::<String>().ok());
        let place = kind.unwrap_or_else(|| "repair".to_owned());
        let table = table(&place, keys)?;
        part_from_table(&place, table)
            .map(Self)
            .map_err(|faults| input_error(py, &faults))
    }
}

/// Repairs as the library takes them.
pub(crate) fn repairs_of(read: &[Bound<'_, ReadRepair>]) -> Vec<Repair> {
    read.iter().map(|repair| repair.get().0.clone()).collect()
}
