//! The native half of the Python package `coapt`: conversions, no mechanics and no defaults of its own.
//!
//! `python/src/coapt` holds what people call; `_coapt.pyi` there says what is here, in Python's types.

mod arrays;
mod built;
mod check;
mod closed;
mod compare;
mod curve;
mod export;
mod fault;
mod live;
mod personalise;
mod plan;
mod progress;
mod repair;
mod replay;
mod run;
mod stored;
mod stored_results;
mod study;
mod table;
mod tissue;
mod valve;

/// What `coapt` is made of; call `coapt` instead.
#[pyo3::pymodule]
mod _coapt {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::check::{check_file, check_valve};
    #[pymodule_export]
    use crate::closed::Closed;
    #[pymodule_export]
    use crate::compare::{Comparison, compare};
    #[pymodule_export]
    use crate::curve::read_curve;
    #[pymodule_export]
    use crate::export::{export_model, export_results};
    #[pymodule_export]
    use crate::live::Live;
    #[pymodule_export]
    use crate::personalise::{Fit, personalise};
    #[pymodule_export]
    use crate::plan::{Plan, plan_of_dict, plan_of_file};
    #[pymodule_export]
    use crate::repair::ReadRepair;
    #[pymodule_export]
    use crate::replay::replayed;
    #[pymodule_export]
    use crate::study::{Study, StudyOfLaws, study, study_laws, study_no_sizes, study_sizes};
    #[pymodule_export]
    use crate::tissue::fit_tissue;
    #[pymodule_export]
    use crate::valve::{Valve, close_many};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("FILM_FRAMES", coapt::film::FRAMES)?;
        module.add("FILM_FRAME_LIMIT", coapt_io::record::FRAME_LIMIT)?;
        module.add("PAGE_ALTERNATIVES", coapt_io::page::SHOWN_ALTERNATIVES)?;
        module.add("FIT_UP_TO_KPA", coapt_io::tissue::UP_TO_KPA)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
