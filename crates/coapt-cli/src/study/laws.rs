//! `coapt study --laws`: closes one valve under every tissue law, so that a user can choose one.

use coapt::energy::membrane::may_newman::{ANTERIOR, POSTERIOR};
use coapt::measure::{measure, visible_distance};
use coapt::model::Model;
use coapt::relax::Equilibrium;
use coapt::scene::Leaflet;
use coapt::tissue_fit::each_law::{Told, in_each_law};
use coapt_io::report::NOTICE;
use coapt_io::study::{
    ERROR_OF_LAWS_MEANS, LAWS_SCHEMA, LawRow, LawStudy, MODEL_ERROR_MEANS, median_time, text_of_laws,
    write_laws,
};

use super::{Arguments, cases, prepare, timed};
use crate::case::{self, Case, FACES_OF_A_PRESET};
use crate::closure::on_threads;
use crate::interrupt::close_watched;
use crate::output::{Failure, Verdict, print, say};

/// Runs the verb.
pub(super) fn run(arguments: &Arguments) -> Result<Verdict, Failure> {
    let (mut cases, mut finest) = cases(arguments, &[FACES_OF_A_PRESET])?;
    // Before minutes of work, not after.
    prepare(&arguments.out)?;
    let laws = [in_each_law(&ANTERIOR)?, in_each_law(&POSTERIOR)?];
    let study = on_threads(arguments.threads, || {
        study(arguments, &mut cases, finest.as_mut(), &laws)
    })?;
    write_laws(&arguments.out, &study).map_err(Failure::Outside)?;
    print(&text_of_laws(&study))?;
    say(&format!("results are in {}", arguments.out.display()));
    Ok(match study.rows.iter().any(|row| row.certified) {
        true => Verdict::Done,
        false => Verdict::Uncertified,
    })
}

/// A valve closed under a law.
struct Closure {
    model: Model,
    closed: Equilibrium,
}

impl Closure {
    fn certified(&self) -> bool {
        self.closed.certificate.is_certified(self.closed.status)
    }
}

fn study(
    arguments: &Arguments,
    cases: &mut [Case],
    mut finest: Option<&mut Case>,
    laws: &[Vec<Told>; 2],
) -> Result<LawStudy, Failure> {
    // Law by law, so that one closed reference at a time is enough.
    let mut of_law: Vec<Vec<LawRow>> = Vec::new();
    let mut firsts: Vec<Closure> = Vec::new();
    let mut reference_faces = None;
    for number in 0..laws[0].len() {
        let reference = match &mut finest {
            Some(finest) => Some(close_once(finest, laws, number)?),
            None => None,
        };
        reference_faces = reference.as_ref().map(|reference| reference.model.faces.len());
        let mut rows = Vec::new();
        for (mesh, case) in cases.iter_mut().enumerate() {
            let model = under(case, laws, number)?;
            let (closed, wall_ms) = median_time(&model, arguments.repeats, &timed);
            let closure = Closure { model, closed };
            let told = case
                .scene
                .leaflets
                .iter()
                .map(|leaflet| of(laws, leaflet)[number]);
            rows.push(LawRow {
                curve_error: told.map(|told| told.relative_error).collect(),
                ..row(&closure, wall_ms, reference.as_ref(), firsts.get(mesh))
            });
            if number == 0 {
                firsts.push(closure);
            }
        }
        of_law.push(rows);
    }
    let leaflets = cases[0].scene.leaflets.iter();
    Ok(LawStudy {
        schema: LAWS_SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        notice: NOTICE,
        mesh_error: ERROR_OF_LAWS_MEANS,
        model_error: MODEL_ERROR_MEANS,
        case: cases[0].scene.name.clone(),
        repeats: arguments.repeats,
        reference_faces,
        leaflets: leaflets.map(|leaflet| leaflet.name.clone()).collect(),
        rows: (0..cases.len())
            .flat_map(|mesh| of_law.iter().map(move |rows| rows[mesh].clone()))
            .collect(),
    })
}

fn close_once(case: &mut Case, laws: &[Vec<Told>; 2], number: usize) -> Result<Closure, Failure> {
    let model = under(case, laws, number)?;
    let closed = close_watched("the reference", &model);
    Ok(Closure { model, closed })
}

/// The valve under a law: all that differs between the closures of a mesh.
fn under(case: &mut Case, laws: &[Vec<Told>; 2], number: usize) -> Result<Model, Failure> {
    for leaflet in &mut case.scene.leaflets {
        leaflet.tissue = of(laws, leaflet)[number].tissue;
    }
    let model = case::build(case)?.model;
    let tissue = &case.scene.leaflets[0].tissue;
    say(&format!(
        "{} triangles, {} ...",
        model.faces.len(),
        tissue.law_name()
    ));
    Ok(model)
}

/// The laws of a leaflet; whatever is not the anterior one counts as posterior.
fn of<'a>(laws: &'a [Vec<Told>; 2], leaflet: &Leaflet) -> &'a [Told] {
    &laws[usize::from(leaflet.name != "anterior")]
}

/// A row but for how far its law is from the tissue's curve.
fn row(closure: &Closure, wall_ms: f64, reference: Option<&Closure>, first: Option<&Closure>) -> LawRow {
    let (model, closed) = (&closure.model, &closure.closed);
    let positions_mm = &closed.state.positions_mm;
    let measures = measure(model, positions_mm, &closed.reactions_n);
    let distance = |other: &Closure| {
        let there = &other.closed.state.positions_mm;
        visible_distance(model, positions_mm, &other.model, there).filter(|_| other.certified())
    };
    LawRow {
        faces: model.faces.len(),
        tissues: model.leaflets.iter().map(|leaflet| leaflet.tissue).collect(),
        curve_error: Vec::new(),
        status: closed.status,
        certified: closure.certified(),
        residual: closed.certificate.residual,
        iterations: closed.history.len(),
        wall_ms,
        mesh_error: reference.and_then(distance),
        model_error: first.and_then(distance),
        coaptation_area_mm2: measures.coaptation.area_mm2,
        orifice_area_mm2: measures.orifice.area_mm2,
        largest_chord_force_n: measures.chords.max_force_n,
    }
}
