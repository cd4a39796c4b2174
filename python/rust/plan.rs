//! `plan`: many alternatives for one valve, closed side by side and ranked.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use coapt::plan::{Progress, Watch, refuse_second_ring};
use coapt::scene::Fault;
use coapt_io::page::page_of_plan;
use coapt_io::plan::{self, PlanFile, PlanReport, Shapes, Stage, csv, prepare_shapes, text, write_plan};
use coapt_io::scene::{alternatives_up_to, read_text};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::arrays::out_points;
use crate::built::Built;
use crate::closed::write_page;
use crate::fault::{input_error, one_error, outside_error};
use crate::progress::Count;
use crate::run::{Stop, run, run_told};
use crate::stored_results;
use crate::table::table;
use crate::valve::Valve;

/// Alternatives compared.
#[pyclass(frozen, module = "coapt._coapt")]
pub(crate) struct Plan {
    inner: Arc<Done>,
}

pub(crate) struct Done {
    pub(crate) built: Arc<Built>,
    pub(crate) report: PlanReport,
    pub(crate) shapes: Shapes,
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
    progress: Option<Py<PyAny>>,
) -> PyResult<Plan> {
    let text = read_text(&path).map_err(|fault| input_error(py, &[fault]))?;
    let name = path.display().to_string();
    let text = Text {
        name,
        text,
        is_made: false,
    };
    carried_out(py, valve, text, keep_shapes, max_alternatives, progress)
}

/// Compares the alternatives of a plan as a dictionary with the keys of a plan file.
#[pyfunction]
pub(crate) fn plan_of_dict(
    py: Python<'_>,
    valve: &Bound<'_, Valve>,
    plan: &Bound<'_, PyDict>,
    keep_shapes: bool,
    max_alternatives: u64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Plan> {
    let text = toml::to_string(&table("plan", plan)?);
    let text = Text {
        name: "plan".to_owned(),
        text: text.map_err(|error| one_error(py, "plan", error.to_string()))?,
        is_made: true,
    };
    carried_out(py, valve, text, keep_shapes, max_alternatives, progress)
}

fn carried_out(
    py: Python<'_>,
    valve: &Bound<'_, Valve>,
    text: Text,
    keep_shapes: bool,
    max_alternatives: u64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Plan> {
    let built = Arc::clone(&valve.get().built);
    let done = run_told(py, progress, move |stop, count| {
        let done = carry_out(built, &text, keep_shapes, max_alternatives, (stop, count));
        done.map_err(|faults| faults.iter().map(|fault| text.told(fault)).collect::<Vec<_>>())
    })?;
    let done = done.map_err(|faults| input_error(py, &faults))?;
    Ok(Plan {
        inner: Arc::new(done),
    })
}

impl Text {
    /// The plan to name lines in: of what was made of a dictionary nobody has seen a line.
    fn file(&self) -> PlanFile<'_> {
        PlanFile {
            name: &self.name,
            text: if self.is_made { "" } else { &self.text },
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
    (stop, count): (&Stop, &Count),
) -> Result<Done, Vec<Fault>> {
    let path = Path::new(&text.name);
    let (mut plan, more) = alternatives_up_to(path, &text.text, max_alternatives, "max_alternatives")?;
    let deeds = plan
        .alternatives
        .iter()
        .flat_map(|alternative| &alternative.repairs);
    for deed in deeds {
        refuse_second_ring(&built.repairs, deed).map_err(|fault| vec![fault])?;
    }
    let more = more.iter().map(|warning| text.told(warning));
    let warnings: Vec<Fault> = built.warnings.iter().cloned().chain(more).collect();
    let on_stage = |stage, work: &mut dyn FnMut(Watch)| {
        let is_counted = match stage {
            // How many closures it takes, it finds out.
            Stage::Search => false,
            Stage::Alternatives(all) | Stage::Samples(all) => {
                count.begin(all);
                true
            }
        };
        work(&|progress| {
            if is_counted && matches!(progress, Progress::Closed | Progress::Refused) {
                count.step();
            }
            stop.flow()
        });
    };
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
        report,
        shapes: Shapes::from(comparison),
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
        let kept = |number| {
            self.inner
                .shapes
                .after_mm
                .get(number)
                .filter(|kept| !kept.is_empty())
        };
        let rows = self.inner.report.alternatives.iter();
        rows.map(|row| {
            let positions_mm = kept(&row.number);
            positions_mm
                .map(|positions| out_points(py, positions))
                .transpose()
        })
        .collect()
    }

    /// Writes what `coapt plan --out` writes, with shapes if they were kept.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let done = Arc::clone(&self.inner);
        let written = run(py, move |_| {
            if !done.shapes.before_mm.is_empty() {
                prepare_shapes(&folder)?;
            }
            write_plan(&folder, &done.report, &done.built.model, &done.shapes)
        })?;
        written.map_err(|fault| outside_error(&fault))
    }

    /// Writes what `coapt report` writes of the folder that `write` writes, with the shapes of so many alternatives.
    fn report(&self, py: Python<'_>, path: PathBuf, most: usize) -> PyResult<()> {
        let done = Arc::clone(&self.inner);
        if done.shapes.before_mm.is_empty() {
            let message =
                "holds no closed shapes, which a page shows; expected one compared with `keep_shapes=True`";
            return Err(one_error(py, "plan", message));
        }
        let page = run(py, move |_| {
            page_of_plan(&done.report, &done.built.model, &done.shapes, most)
        })?;
        write_page(py, path, page)
    }

    /// The comparison as bytes, with a version.
    fn stored<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &stored_results::plan(&self.inner)?))
    }

    /// The comparison of such bytes.
    #[staticmethod]
    fn from_stored(py: Python<'_>, bytes: Vec<u8>) -> PyResult<Self> {
        let read = run(py, move |_| stored_results::read_plan(&bytes))?;
        let done = read.map_err(|faults| input_error(py, &faults))?;
        Ok(Self {
            inner: Arc::new(done),
        })
    }
}
