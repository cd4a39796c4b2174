//! Carrying a study out: every mesh at every residual, then the usual mesh at other contact thicknesses.

use coapt::measure::{VisibleDistance, visible_distance};
use coapt::model::Model;
use coapt::relax::Equilibrium;

use super::{
    ERROR_MEANS, Factor, KNEE_MEANS, OWN_MESH_ERROR_MEANS, Reference, Row, STUDY_SCHEMA, Study, mark,
};
use crate::report::NOTICE;

/// Mesh sizes of a preset, in triangles: from the coarsest that still looks like a valve to the one at which the leaflets'
/// folds are resolved.
pub const FACES: [u32; 5] = [160, 320, 650, 1300, 2600];
/// Mesh sizes of a preset whose tissue laws are studied, in triangles.
pub const FACES_OF_LAWS: [u32; 1] = [650];
/// The reference mesh has this many times the triangles of the finest one: half its edge length, so that even the
/// finest shows half of its own error or more.
pub const REFERENCE_FINER: u32 = 4;
/// Residuals to stop at.
pub const TOLERANCES: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// Contact thicknesses beside the scene's own [mm].
pub const THICKNESSES_MM: [f64; 3] = [0.3, 0.5, 0.8];
/// Closures of each setting.
pub const REPEATS: u16 = 3;

/// Residuals of the reference, tightest first: rounding decides which is reached.
const REFERENCE_TOLERANCES: [f64; 3] = [1e-10, 1e-8, 1e-6];
/// Contact thickness is varied on the mesh nearest to this many triangles, those of the models of paper 003.
const USUAL_FACES: usize = 650;

/// What a study tries.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// Residuals to stop at, each tried on every mesh [1].
    pub tolerances: Vec<f64>,
    /// Contact thicknesses, each tried on the mesh of about 650 triangles at the scene's residual [mm].
    pub thicknesses_mm: Vec<f64>,
    /// Closures of each setting, of which the median time counts.
    pub repeats: u16,
}

impl Default for Tried {
    fn default() -> Self {
        Self {
            tolerances: TOLERANCES.to_vec(),
            thicknesses_mm: THICKNESSES_MM.to_vec(),
            repeats: REPEATS,
        }
    }
}

/// What [`Close`] is told of the reference.
pub const REFERENCE: &str = "the reference";

/// Closes a valve from its open state and takes the time [ms]; the first part is what an interruption calls it. It is the caller
/// who has a clock.
pub type Close<'a> = &'a dyn Fn(&str, &Model) -> (Equilibrium, f64);

/// Closes one valve at many mesh sizes, coarsest first, and settings; `say` is told what is done. Nothing where the reference,
/// the finest mesh, does not close to a certified state at any residual.
pub fn carry_out(
    models: &[Model],
    finest: &Model,
    tried: &Tried,
    close: Close,
    say: &dyn Fn(&str),
) -> Option<Study> {
    let models = meshes(models);
    let (reference, exact) = reference(finest, close, say)?;
    let closures: Vec<Closure> = settings(tried, &models)
        .map(|setting| closure(setting, tried.repeats, close, say))
        .collect();
    let mut rows: Vec<Row> = closures
        .iter()
        .map(|closure| {
            // Tolerances of a mesh come loosest first: its last closure of the grid is its tightest.
            let tightest = closures.iter().rfind(|other| {
                other.varied == Factor::MeshAndTolerance
                    && other.model.faces.len() == closure.model.faces.len()
            });
            let own = tightest.and_then(|tightest| closure.distance(&tightest.model, &tightest.closed));
            Row {
                error: closure.distance(finest, &exact),
                own_mesh_rms_mm: own.map(|own| own.rms_mm),
                ..row(closure)
            }
        })
        .collect();
    mark(&mut rows);
    Some(Study {
        schema: STUDY_SCHEMA.into(),
        version: env!("CARGO_PKG_VERSION").into(),
        notice: NOTICE.into(),
        error: match rows.iter().all(|row| row.faces == reference.faces) {
            true => OWN_MESH_ERROR_MEANS.into(),
            false => ERROR_MEANS.into(),
        },
        knee: KNEE_MEANS.into(),
        case: finest.name.clone(),
        repeats: tried.repeats,
        reference,
        rows,
    })
}

/// How many closures [`carry_out`] makes of these, repeats among them, beside the few of the reference.
pub fn closure_count(models: &[Model], tried: &Tried) -> usize {
    settings(tried, &meshes(models)).count() * usize::from(tried.repeats.max(1))
}

/// Sizes aimed at are met roughly: two of them may be one mesh.
fn meshes(models: &[Model]) -> Vec<Model> {
    let mut models = models.to_vec();
    models.dedup_by_key(|model| model.faces.len());
    models
}

/// The closure of the finest mesh to the tightest residual at which it is certified.
fn reference(finest: &Model, close: Close, say: &dyn Fn(&str)) -> Option<(Reference, Equilibrium)> {
    REFERENCE_TOLERANCES.into_iter().find_map(|residual_tolerance| {
        let faces = finest.faces.len();
        say(&format!(
            "reference: {faces} triangles, residual {residual_tolerance:e} ..."
        ));
        let model = with(finest, residual_tolerance, finest.contact.thickness_mm);
        let (exact, _) = close(REFERENCE, &model);
        let reference = Reference {
            faces,
            residual_tolerance,
            residual: exact.certificate.residual,
            contact_thickness_mm: model.contact.thickness_mm,
        };
        exact
            .certificate
            .is_certified(exact.status)
            .then_some((reference, exact))
    })
}

/// Every valve to be closed: each mesh at each tolerance, then the default one at other settings, one at a time.
fn settings<'a>(tried: &Tried, models: &'a [Model]) -> impl Iterator<Item = (Factor, Model)> + use<'a> {
    let tolerances = ascending(&tried.tolerances);
    let thicknesses = ascending(&tried.thicknesses_mm);
    let grid = models.iter().flat_map(move |model| {
        let at = |&tolerance: &f64| {
            (
                Factor::MeshAndTolerance,
                with(model, tolerance, model.contact.thickness_mm),
            )
        };
        tolerances.iter().rev().map(at).collect::<Vec<_>>()
    });
    let usual = models
        .iter()
        .min_by_key(|model| model.faces.len().abs_diff(USUAL_FACES));
    let thicker = usual.into_iter().flat_map(move |model| {
        let other = thicknesses.iter().filter(|&&mm| mm != model.contact.thickness_mm);
        let at = |&mm: &f64| {
            (
                Factor::ContactThickness,
                with(model, model.settings.residual_tolerance, mm),
            )
        };
        other.map(at).collect::<Vec<_>>()
    });
    grid.chain(thicker)
}

fn ascending(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

fn with(model: &Model, residual_tolerance: f64, contact_thickness_mm: f64) -> Model {
    let mut model = model.clone();
    model.settings.residual_tolerance = residual_tolerance;
    model.contact.thickness_mm = contact_thickness_mm;
    model
}

/// A valve closed.
struct Closure {
    varied: Factor,
    model: Model,
    closed: Equilibrium,
    /// Median of the repeats.
    wall_ms: f64,
}

impl Closure {
    fn distance(&self, other: &Model, closed: &Equilibrium) -> Option<VisibleDistance> {
        let (here, there) = (&self.closed.state, &closed.state);
        visible_distance(&self.model, &here.positions_mm, other, &there.positions_mm)
    }
}

/// Closes a valve and tells of it; all repeats end in the same bytes, so the first is kept.
fn closure((varied, model): (Factor, Model), repeats: u16, close: Close, say: &dyn Fn(&str)) -> Closure {
    say(&format!(
        "{} triangles, residual {:e}, contact thickness {} mm ...",
        model.faces.len(),
        model.settings.residual_tolerance,
        model.contact.thickness_mm
    ));
    let (closed, wall_ms) = median_time(&model, repeats, close);
    Closure {
        varied,
        closed,
        wall_ms,
        model,
    }
}

/// A valve closed, and the median time [ms].
pub fn median_time(model: &Model, repeats: u16, close: Close) -> (Equilibrium, f64) {
    let once = || close("a setting", model);
    let (closed, first_ms) = once();
    let mut times_ms = vec![first_ms];
    times_ms.extend((1..repeats).map(|_| once().1));
    (closed, median(times_ms))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    0.5 * (values[values.len() / 2] + values[(values.len() - 1) / 2])
}

/// A row but for its errors and its place among the others.
fn row(closure: &Closure) -> Row {
    let (model, closed) = (&closure.model, &closure.closed);
    let certificate = &closed.certificate;
    Row {
        varied: closure.varied,
        faces: model.faces.len(),
        residual_tolerance: model.settings.residual_tolerance,
        contact_thickness_mm: model.contact.thickness_mm,
        status: closed.status,
        certified: certificate.is_certified(closed.status),
        residual: certificate.residual,
        iterations: closed.history.len(),
        crossings: certificate.crossings.len(),
        wall_ms: closure.wall_ms,
        error: None,
        own_mesh_rms_mm: None,
        on_front: false,
        knee: false,
    }
}
