//! `plan`: many alternatives for one valve, closed side by side and ranked.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use coapt::Vec3;
use coapt::plan::{Comparison, Row, Watch};
use coapt::scene::Fault;
use coapt_io::page::page_of_plan;
use coapt_io::plan::{self, PlanFile, PlanReport, csv, prepare_shapes, text, write_plan};
use coapt_io::scene::{Alternatives, alternatives_from_text, read_text};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::out_points;
use crate::built::Built;
use crate::closed::write_page;
use crate::fault::{input_error, one_error, outside_error};
use crate::run::{Stop, run};
use crate::table::table;
use crate::valve::Valve;

/// Alternatives compared.
#[pyclass(frozen, module = "coapt._coapt")]
pub(crate) struct Plan {
    inner: Arc<Done>,
}

struct Done {
    built: Arc<Built>,
    plan: Alternatives,
    comparison: Comparison,
    report: PlanReport,
}

/// The text of a plan and its name in messages.
struct Text {
    name: String,
    text: String,
    /// Made of a dictionary, whose keys have no lines.
    is_made: bool,
}

/// Compares the alternatives of a plan file.
#[pyfunction]
pub(crate) fn plan_of_file(
    py: Python<'_>,
    valve: &Bound<'_, Valve>,
    path: PathBuf,
    keep_shapes: bool,
    max_alternatives: u64,
) -> PyResult<Plan> {
    let text = read_text(&path).map_err(|fault| input_error(py, &[fault]))?;
    let name = path.display().to_string();
    let text = Text {
        name,
        text,
        is_made: false,
    };
    carried_out(py, valve, text, keep_shapes, max_alternatives)
}

/// Compares the alternatives of a plan as a dictionary with the keys of a plan file.
#[pyfunction]
pub(crate) fn plan_of_dict(
    py: Python<'_>,
    valve: &Bound<'_, Valve>,
    plan: &Bound<'_, PyDict>,
    keep_shapes: bool,
    max_alternatives: u64,
) -> PyResult<Plan> {
    let text = toml::to_string(&table("plan", plan)?);
    let text = Text {
        name: "plan".to_owned(),
        text: text.map_err(|error| one_error(py, "plan", error.to_string()))?,
        is_made: true,
    };
    carried_out(py, valve, text, keep_shapes, max_alternatives)
}

fn carried_out(
    py: Python<'_>,
    valve: &Bound<'_, Valve>,
    text: Text,
    keep_shapes: bool,
    max_alternatives: u64,
) -> PyResult<Plan> {
    let built = Arc::clone(&valve.get().built);
    let done = run(py, move |stop| {
        let done = carry_out(built, &text, keep_shapes, max_alternatives, stop);
        done.map_err(|faults| faults.iter().map(|fault| text.told(fault)).collect::<Vec<_>>())
    })?;
    let done = done.map_err(|faults| input_error(py, &faults))?;
    Ok(Plan {
        inner: Arc::new(done),
    })
}

impl Text {
    fn file(&self) -> PlanFile<'_> {
        PlanFile {
            name: &self.name,
            text: &self.text,
        }
    }

    /// A fault, without the line where there is no file to look into.
    fn told(&self, fault: &Fault) -> Fault {
        let place = match self.is_made {
            true => self.name.clone(),
            false => fault.place.clone(),
        };
        Fault {
            place,
            ..fault.clone()
        }
    }
}

fn carry_out(
    built: Arc<Built>,
    text: &Text,
    keep_shapes: bool,
    max_alternatives: u64,
    stop: &Stop,
) -> Result<Done, Vec<Fault>> {
    let (mut plan, more) = alternatives_from_text(Path::new(&text.name), &text.text, max_alternatives)?;
    let warnings: Vec<Fault> = built.warnings.iter().cloned().chain(more).collect();
    let on_stage = |_, work: &mut dyn FnMut(Watch)| work(&|_| stop.flow());
    let (report, comparison) = plan::carry_out(
        &built.model,
        text.file(),
        &mut plan,
        keep_shapes,
        &warnings,
        &on_stage,
    )?;
    Ok(Done {
        built,
        plan,
        comparison,
        report,
    })
}

#[pymethods]
impl Plan {
    /// Whether all that was computed may be used.
    #[getter]
    fn certified(&self) -> bool {
        self.inner.report.certified()
    }

    /// The report as JSON.
    fn report_json(&self) -> PyResult<String> {
        self.inner.report.json().map_err(|fault| outside_error(&fault))
    }

    /// The report as a table for people.
    fn text(&self) -> String {
        text(&self.inner.report)
    }

    /// A line per alternative, a column per measure, as comma-separated values.
    fn csv(&self) -> String {
        csv(&self.inner.report)
    }

    /// Closed positions of each alternative [mm], in the order of the report; none where they were not kept.
    fn positions_mm<'py>(&self, py: Python<'py>) -> PyResult<Vec<Option<Bound<'py, PyArray2<f64>>>>> {
        let rows = self.inner.comparison.rows.iter();
        rows.map(|row| shape(row).map(|positions| out_points(py, positions)).transpose())
            .collect()
    }

    /// Writes what `coapt plan --out` writes, with shapes if they were kept.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let done = Arc::clone(&self.inner);
        let written = run(py, move |_| {
            if !done.comparison.before.positions_mm.is_empty() {
                prepare_shapes(&folder)?;
            }
            write_plan(
                &folder,
                &done.report,
                &done.built.model,
                &done.plan,
                &done.comparison,
            )
        })?;
        written.map_err(|fault| outside_error(&fault))
    }

    /// Writes what `coapt report` writes of the folder that `write` writes, with the shapes of so many alternatives.
    fn report(&self, py: Python<'_>, path: PathBuf, most: usize) -> PyResult<()> {
        let done = Arc::clone(&self.inner);
        if done.comparison.before.positions_mm.is_empty() {
            let message =
                "holds no closed shapes, which a page shows; expected one compared with `keep_shapes=True`";
            return Err(one_error(py, "plan", message));
        }
        let page = run(py, move |_| {
            page_of_plan(
                &done.report,
                &done.built.model,
                &done.plan,
                &done.comparison,
                most,
            )
        })?;
        write_page(py, path, page)
    }
}

/// Where the vertices of a row ended, if that was kept.
fn shape(row: &Row) -> Option<&[Vec3]> {
    let outcome = row.result.as_ref().ok()?;
    (!outcome.positions_mm.is_empty()).then_some(&outcome.positions_mm)
}
