//! Results of many closures as bytes, with a version: plans, studies, comparisons, fits.
//!
//! They are stored as they stand, to be told in the same words without closing anything again. Their reports hold numbers of the solver,
//! which may be undefined: they go as CBOR, which knows them, where JSON does not.

use std::collections::BTreeMap;
use std::sync::Arc;

use coapt::Vec3;
use coapt::scene::Fault;
use coapt_io::compare::ComparisonReport;
use coapt_io::mesh::PolyData;
use coapt_io::personalise::FitReport;
use coapt_io::plan::{PlanReport, Shapes};
use coapt_io::study::{LawStudy, Study};
use pyo3::PyResult;
use pyo3::exceptions::PyValueError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::personalise::{Closure, Fit};
use crate::plan;
use crate::stored::{
    StoredClosed, StoredValve, check_format, damaged, rebuilt, reclosed, stored, stored_closed,
};

const PLAN_FORMAT: &str = "coapt-plan-result/1";
const COMPARISON_FORMAT: &str = "coapt-comparison-result/1";
const STUDY_FORMAT: &str = "coapt-study-result/1";
const LAWS_FORMAT: &str = "coapt-laws-result/1";
const FIT_FORMAT: &str = "coapt-fit-result/1";

#[derive(Serialize, Deserialize)]
struct StoredPlan {
    format: String,
    valve: StoredValve,
    report: PlanReport,
    before_mm: Vec<[f64; 3]>,
    after_mm: BTreeMap<usize, Vec<[f64; 3]>>,
}

#[derive(Serialize, Deserialize)]
struct StoredFit {
    format: String,
    report: FitReport,
    untuned: Option<StoredClosed>,
    tuned: Option<StoredClosed>,
}

/// A result that is data through and through; beside the comparison of two surfaces stands what its report leaves out.
#[derive(Serialize, Deserialize)]
struct Stored<T> {
    format: String,
    result: T,
}

/// A plan's result.
pub(crate) fn plan(done: &plan::Done) -> PyResult<Vec<u8>> {
    let rows = |points: &Vec<Vec3>| points.iter().map(|point| (*point).into()).collect();
    let after = done.shapes.after_mm.iter();
    let kept = after.filter(|(_, points)| !points.is_empty());
    cbor(&StoredPlan {
        format: PLAN_FORMAT.to_owned(),
        valve: stored(&done.built),
        report: done.report.clone(),
        before_mm: rows(&done.shapes.before_mm),
        after_mm: kept.map(|(number, points)| (*number, rows(points))).collect(),
    })
}

/// A comparison's result.
pub(crate) fn comparison(mesh: &PolyData, report: &ComparisonReport) -> PyResult<Vec<u8>> {
    of_data(COMPARISON_FORMAT, (mesh, report, &report.comparison.map))
}

/// A study's result.
pub(crate) fn study(study: &Study) -> PyResult<Vec<u8>> {
    of_data(STUDY_FORMAT, study)
}

/// The result of a study of laws.
pub(crate) fn study_of_laws(study: &LawStudy) -> PyResult<Vec<u8>> {
    of_data(LAWS_FORMAT, study)
}

/// A fit's result.
pub(crate) fn fit(fit: &Fit) -> PyResult<Vec<u8>> {
    let closure = |closure: &Option<Closure>| {
        let closure = closure.as_ref();
        closure.map(|(built, relaxed)| stored_closed(built, relaxed))
    };
    cbor(&StoredFit {
        format: FIT_FORMAT.to_owned(),
        report: fit.report.clone(),
        untuned: closure(&fit.untuned),
        tuned: closure(&fit.tuned),
    })
}

fn of_data(format: &str, result: impl Serialize) -> PyResult<Vec<u8>> {
    cbor(&Stored {
        format: format.to_owned(),
        result,
    })
}

fn cbor(value: &impl Serialize) -> PyResult<Vec<u8>> {
    let mut bytes = Vec::new();
    ciborium::into_writer(value, &mut bytes).map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(bytes)
}

/// A plan's result of its bytes.
///
/// # Errors
/// As of [`read_valve`].
pub(crate) fn read_plan(bytes: &[u8]) -> Result<plan::Done, Vec<Fault>> {
    let stored: StoredPlan = read_cbor(bytes, PLAN_FORMAT)?;
    let points = |rows: Vec<[f64; 3]>| rows.into_iter().map(Vec3::from).collect();
    let after = stored.after_mm.into_iter();
    Ok(plan::Done {
        built: Arc::new(rebuilt(stored.valve)?),
        report: stored.report,
        shapes: Shapes {
            before_mm: points(stored.before_mm),
            after_mm: after.map(|(number, rows)| (number, points(rows))).collect(),
        },
    })
}

/// A comparison's result of its bytes: the mesh of the result, and what is told.
///
/// # Errors
/// Another format.
pub(crate) fn read_comparison(bytes: &[u8]) -> Result<(PolyData, ComparisonReport), Vec<Fault>> {
    let stored: Stored<(PolyData, ComparisonReport, _)> = read_cbor(bytes, COMPARISON_FORMAT)?;
    let (mesh, mut report, map) = stored.result;
    report.comparison.map = map;
    Ok((mesh, report))
}

/// A study's result of its bytes.
///
/// # Errors
/// Another format.
pub(crate) fn read_study(bytes: &[u8]) -> Result<Study, Vec<Fault>> {
    read_cbor(bytes, STUDY_FORMAT).map(|stored: Stored<Study>| stored.result)
}

/// The result of a study of laws of its bytes.
///
/// # Errors
/// Another format.
pub(crate) fn read_study_of_laws(bytes: &[u8]) -> Result<LawStudy, Vec<Fault>> {
    read_cbor(bytes, LAWS_FORMAT).map(|stored: Stored<LawStudy>| stored.result)
}

/// A fit's result of its bytes.
///
/// # Errors
/// As of [`read_closed`].
pub(crate) fn read_fit(bytes: &[u8]) -> Result<Fit, Vec<Fault>> {
    let stored: StoredFit = read_cbor(bytes, FIT_FORMAT)?;
    let closure = |closed: Option<StoredClosed>| {
        closed
            .map(|closed| reclosed(closed).map(|(built, relaxed)| (Arc::new(built), relaxed)))
            .transpose()
    };
    Ok(Fit {
        report: stored.report,
        untuned: closure(stored.untuned)?,
        tuned: closure(stored.tuned)?,
    })
}

fn read_cbor<T: DeserializeOwned>(bytes: &[u8], format: &str) -> Result<T, Vec<Fault>> {
    check_format(ciborium::from_reader(bytes), "result", format)?;
    ciborium::from_reader(bytes).map_err(damaged)
}
