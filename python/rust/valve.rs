//! `Valve`: built, repaired, closed.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use coapt::Vec3;
use coapt::relax::relax_watched;
use coapt::scene::{Fault, LineMesh, Load, MMHG_MPA, Scene, Space, SurfaceMesh};
use coapt::state::State;
use coapt_io::scene::{part_from_table, turn_scene, write_scene};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyDict};
use rayon::prelude::*;

use crate::arrays::{index_list, index_rows, numbers, out_list, out_points, out_rows, points};
use crate::built::{self, Built};
use crate::closed::{Closed, Relaxed};
use crate::fault::{Told, input_error, one_error, outside_error, told};
use crate::repair::{ReadRepair, repairs_of};
use crate::run::{Stop, run, run_told};
use crate::stored;
use crate::table::{table, value_of};

/// A valve, open, with what was done to it.
#[pyclass(frozen, module = "coapt._coapt")]
pub(crate) struct Valve {
    pub(crate) built: Arc<Built>,
    points_mm: PyOnceLock<Py<PyArray2<f64>>>,
    triangles: PyOnceLock<Py<PyArray2<u32>>>,
}

impl From<Built> for Valve {
    fn from(built: Built) -> Self {
        Self::from(Arc::new(built))
    }
}

impl From<Arc<Built>> for Valve {
    fn from(built: Arc<Built>) -> Self {
        Self {
            built,
            points_mm: PyOnceLock::new(),
            triangles: PyOnceLock::new(),
        }
    }
}

/// A leaflet as arrays: points, triangles, annulus points, their motion.
type LeafletArrays<'py> = (
    Bound<'py, PyAny>,
    Bound<'py, PyAny>,
    Option<Bound<'py, PyAny>>,
    Option<Bound<'py, PyAny>>,
);

/// Chordae as arrays: points, segments, rest lengths, sections.
type ChordArrays<'py> = LeafletArrays<'py>;

/// A muscle as arrays: tips, their motion.
type MuscleArrays<'py> = (Bound<'py, PyAny>, Option<Bound<'py, PyAny>>);

#[pymethods]
impl Valve {
    /// Reads a scene file, or a folder with one.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf, face_limit: Option<u32>) -> PyResult<Self> {
        made(py, run(py, move |_| built::read(&path, face_limit))?)
    }

    /// Makes a parametric valve.
    #[staticmethod]
    fn generate(py: Python<'_>, preset: String, parameters: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut settings = Vec::new();
        for (key, value) in parameters {
            let key: String = key.extract()?;
            let value = value_of(&key, &value)?;
            settings.push((key, value));
        }
        made(py, run(py, move |_| built::generated(&preset, &settings))?)
    }

    /// Makes a valve of a scene without meshes, and the meshes as arrays in the order of its parts.
    #[staticmethod]
    fn assemble(
        py: Python<'_>,
        scene: &Bound<'_, PyDict>,
        leaflets: Vec<LeafletArrays<'_>>,
        chordae: Vec<ChordArrays<'_>>,
        papillary: Vec<MuscleArrays<'_>>,
        annulus_mm: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let scene = part_from_table("", table("scene", scene)?);
        let mut scene: Scene = scene.map_err(|faults| input_error(py, &faults))?;
        for (number, (part, arrays)) in scene.leaflets.iter_mut().zip(&leaflets).enumerate() {
            part.mesh = Some(surface_mesh(&format!("leaflets[{number}]"), arrays)?);
        }
        for (number, (part, arrays)) in scene.chordae.iter_mut().zip(&chordae).enumerate() {
            part.mesh = Some(line_mesh(&format!("chordae[{number}]"), arrays)?);
        }
        for (number, (part, (tips, motion))) in scene.papillary.iter_mut().zip(&papillary).enumerate() {
            part.tips_mm = points(&format!("papillary[{number}].tips_mm"), tips)?;
            if let Some(motion) = motion {
                part.displacements_mm = points(&format!("papillary[{number}].displacements_mm"), motion)?;
            }
        }
        if let Some(curve) = annulus_mm {
            scene.annulus.curve_mm = Some(points("annulus_mm", &curve)?);
        }
        if scene.space == Space::RAS {
            turn_scene(&mut scene);
        }
        made(py, run(py, move |_| built::build(scene, None, Vec::new()))?)
    }

    /// The same valve with more repairs.
    fn with_repairs(&self, py: Python<'_>, repairs: Vec<Bound<'_, ReadRepair>>) -> PyResult<Self> {
        let repairs = repairs_of(&repairs);
        let built = Arc::clone(&self.built);
        made(py, run(py, move |_| built.repaired(&repairs))?)
    }

    /// The same valve under another pressure, with other settings or another contact.
    fn altered(
        &self,
        py: Python<'_>,
        pressure_mmhg: Option<f64>,
        settings: &Bound<'_, PyDict>,
        contact: &Bound<'_, PyDict>,
    ) -> PyResult<Self> {
        let mut scene = Scene::clone(&self.built.scene);
        if let Some(pressure_mmhg) = pressure_mmhg {
            scene.load = Load::mmhg(pressure_mmhg);
        }
        scene.settings = merged(py, "settings", &scene.settings, settings)?;
        scene.contact = merged(py, "contact", &scene.contact, contact)?;
        let built = Arc::clone(&self.built);
        made(py, run(py, move |_| built.of(scene))?)
    }

    /// Closes the valve, from the open state or from given positions.
    fn close(&self, py: Python<'_>, start: Option<Bound<'_, PyAny>>) -> PyResult<Closed> {
        let start = match start {
            Some(positions) => Some(self.state(&positions)?),
            None => None,
        };
        let built = Arc::clone(&self.built);
        let closed = run(py, move |stop| closed_of(&built, start, stop))?;
        Ok(Closed::new(Arc::clone(&self.built), closed))
    }

    /// Name of the case.
    #[getter]
    fn name(&self) -> String {
        self.built.model.name.clone()
    }

    /// Pressure [mmHg].
    #[getter]
    fn pressure_mmhg(&self) -> f64 {
        self.built.model.pressure_mpa / MMHG_MPA
    }

    /// Open positions of all vertices [mm].
    #[getter]
    fn points_mm(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        let make = || Ok::<_, PyErr>(out_points(py, &self.built.model.rest_mm)?.unbind());
        Ok(self.points_mm.get_or_try_init(py, make)?.clone_ref(py))
    }

    /// Triangles of all leaflets, as vertices.
    #[getter]
    fn triangles(&self, py: Python<'_>) -> PyResult<Py<PyArray2<u32>>> {
        let faces = &self.built.model.faces;
        let make = || Ok::<_, PyErr>(out_rows(py, faces.as_flattened().to_vec(), 3)?.unbind());
        Ok(self.triangles.get_or_try_init(py, make)?.clone_ref(py))
    }

    /// Leaflet of each triangle.
    #[getter]
    fn triangle_leaflet<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        out_list(py, self.built.model.face_leaflet.clone())
    }

    /// Names of the leaflets.
    #[getter]
    fn leaflet_names(&self) -> Vec<String> {
        let leaflets = self.built.model.leaflets.iter();
        leaflets.map(|leaflet| leaflet.name.clone()).collect()
    }

    /// So many vertices belong to leaflets, the first.
    #[getter]
    fn leaflet_vertex_count(&self) -> usize {
        self.built.model.leaflet_vertex_count
    }

    /// Vertices of the annulus, in order.
    #[getter]
    fn annulus<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        out_list(py, self.built.model.annulus.clone())
    }

    /// Open positions of the ends of chord segments, and which segments are between them [mm].
    fn chords<'py>(&self, py: Python<'py>) -> PyResult<Lines<'py>> {
        chords_at(py, &self.built, &self.built.model.rest_mm)
    }

    /// Group of each chord segment, and the names of the groups.
    #[getter]
    fn chord_groups<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<u32>>, Vec<String>) {
        let model = &self.built.model;
        let names = model.chord_groups.iter().map(|group| group.name.clone());
        let groups = model.chords.group.iter().copied();
        (out_list(py, groups.collect()), names.collect())
    }

    /// Repairs of the input, guesses, doubts.
    #[getter]
    fn warnings(&self) -> Vec<Told> {
        self.built.warnings.iter().map(told).collect()
    }

    /// Repairs, as JSON.
    #[getter]
    fn repairs_json(&self) -> PyResult<String> {
        stored::json(&self.built.repairs)
    }

    /// Writes the scene with its meshes, as `coapt generate --out` does.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let count = self.built.repairs.len();
        if count > 0 {
            let message = format!("has {count} repair(s), which no scene holds; expected a valve before any");
            return Err(one_error(py, "valve", message));
        }
        let scene = Arc::clone(&self.built.scene);
        let written = run(py, move |_| write_scene(&folder, &scene))?;
        written.map_err(|fault| outside_error(&fault))
    }

    /// The valve as bytes, with a version.
    fn stored<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, stored::valve(&self.built)?.as_bytes()))
    }

    /// The valve of such bytes.
    #[staticmethod]
    fn from_stored(py: Python<'_>, bytes: Vec<u8>) -> PyResult<Self> {
        made(py, run(py, move |_| stored::read_valve(&bytes))?)
    }
}

/// Points and the segments between them.
pub(crate) type Lines<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

/// The chordae where the vertices are.
pub(crate) fn chords_at<'py>(py: Python<'py>, built: &Built, positions_mm: &[Vec3]) -> PyResult<Lines<'py>> {
    let chords = &built.model.chords;
    let ends: Vec<Vec3> = (0..chords.points.len() as u32)
        .map(|point| chords.point_mm(point, positions_mm))
        .collect();
    let segments = out_rows(py, chords.ends.as_flattened().to_vec(), 2)?;
    Ok((out_points(py, &ends)?, segments))
}

/// Closes many valves, on as many threads as there are.
#[pyfunction]
pub(crate) fn close_many(
    py: Python<'_>,
    valves: Vec<Bound<'_, Valve>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<Closed>> {
    let all: Vec<Arc<Built>> = valves
        .iter()
        .map(|valve| Arc::clone(&valve.get().built))
        .collect();
    let models = all.clone();
    let closed: Vec<Relaxed> = run_told(py, progress, move |stop, count| {
        count.begin(models.len());
        let close = |built: &Arc<Built>| {
            let closed = closed_of(built, None, stop);
            count.step();
            closed
        };
        models.par_iter().with_max_len(1).map(close).collect()
    })?;
    Ok(all
        .into_iter()
        .zip(closed)
        .map(|(built, closed)| Closed::new(built, closed))
        .collect())
}

/// Closes a valve and takes the time.
pub(crate) fn closed_of(built: &Built, start: Option<State>, stop: &Stop) -> Relaxed {
    let start = start.unwrap_or_else(|| State::open(&built.model));
    let begun = Instant::now();
    let equilibrium = relax_watched(&built.model, &start, |_| stop.flow());
    Relaxed {
        wall_ms: begun.elapsed().as_secs_f64() * 1e3,
        equilibrium,
    }
}

fn made(py: Python<'_>, built: Result<Built, Vec<Fault>>) -> PyResult<Valve> {
    built.map(Valve::from).map_err(|faults| input_error(py, &faults))
}

/// Settings with some of them replaced.
fn merged<T: serde::Serialize + serde::de::DeserializeOwned>(
    py: Python<'_>,
    place: &str,
    settings: &T,
    replaced: &Bound<'_, PyDict>,
) -> PyResult<T> {
    let wrong = |error: toml::ser::Error| one_error(py, place, error.to_string());
    let mut all = toml::Table::try_from(settings).map_err(wrong)?;
    all.extend(table(place, replaced)?);
    part_from_table(place, all).map_err(|faults| input_error(py, &faults))
}

fn surface_mesh(place: &str, arrays: &LeafletArrays<'_>) -> PyResult<SurfaceMesh> {
    let (points_mm, faces, annulus_points, motion) = arrays;
    let at = |key: &str| format!("{place}.{key}");
    let list = annulus_points.as_ref();
    let motion = motion.as_ref();
    Ok(SurfaceMesh {
        points_mm: points(&at("points_mm"), points_mm)?,
        faces: index_rows(&at("triangles"), faces)?,
        annulus_points: list
            .map(|list| index_list(&at("annulus_points"), list))
            .transpose()?,
        annulus_displacement_mm: motion
            .map(|motion| points(&at("annulus_displacement_mm"), motion))
            .transpose()?,
    })
}

fn line_mesh(place: &str, arrays: &ChordArrays<'_>) -> PyResult<LineMesh> {
    let (points_mm, segments, lengths, areas) = arrays;
    let at = |key: &str| format!("{place}.{key}");
    let list = |key: &str, list: &Option<Bound<'_, PyAny>>| {
        list.as_ref().map(|list| numbers(&at(key), list)).transpose()
    };
    Ok(LineMesh {
        points_mm: points(&at("points_mm"), points_mm)?,
        segments: index_rows(&at("segments"), segments)?,
        rest_length_mm: list("rest_length_mm", lengths)?,
        area_mm2: list("area_mm2", areas)?,
    })
}

impl Valve {
    /// Positions to begin at.
    fn state(&self, given: &Bound<'_, PyAny>) -> PyResult<State> {
        let positions = points("start", given)?;
        let (found, wanted) = (positions.len(), self.built.model.rest_mm.len());
        if found != wanted {
            let message = format!("has {found} points; expected the {wanted} vertices of this valve");
            return Err(one_error(given.py(), "start", message));
        }
        let is_finite = |point: &[f64; 3]| point.iter().all(|number| number.is_finite());
        if let Some(at) = positions.iter().position(|point| !is_finite(point)) {
            let message = format!("is {:?} at vertex {at}; expected finite numbers", positions[at]);
            return Err(one_error(given.py(), "start", message));
        }
        Ok(State {
            positions_mm: positions.into_iter().map(Vec3::from).collect(),
        })
    }
}
