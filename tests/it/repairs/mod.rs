//! Repairs as a user makes them: a model, a plan, a closure, and which way the measures go.

mod atlas;
mod chordae;
mod edge_to_edge;
mod leaflets;
mod mended;
mod refused;
mod rings;

use coapt::measure::{Measures, measure_with_passage};
use coapt::mesh::parametric::Preset;
use coapt::model::Model;
use coapt::relax::Equilibrium;
use coapt::repair::site::on_both_leaflets;
use coapt::repair::{self, Repaired};
use coapt::scene::{Fault, Repair, Site};
use coapt_tests::{close, preset_model};

const FACES: u32 = 650;

/// A closed valve and what it measures.
struct Closed {
    equilibrium: Equilibrium,
    measures: Measures,
}

fn preset(preset: Preset) -> Model {
    preset_model(preset, FACES, 0.0, 0)
}

/// The model after repairs, one after the other.
fn repaired(model: &Model, repairs: &[Repair]) -> Model {
    let mut model = model.clone();
    for deed in repairs {
        model = done(&model, deed).model;
    }
    model
}

fn done(model: &Model, deed: &Repair) -> Repaired {
    repair::apply(model, deed).unwrap_or_else(|faults| panic!("{faults:#?}"))
}

fn refused(model: &Model, deed: &Repair) -> Vec<Fault> {
    match repair::apply(model, deed) {
        Ok(done) => panic!("accepted: {:?}", done.report),
        Err(faults) => faults,
    }
}

/// Whether the first fault has this place and says this.
fn assert_told(faults: &[Fault], place: &str, words: &str) {
    let told = faults
        .first()
        .is_some_and(|fault| fault.place == place && fault.message.contains(words));
    assert!(told, "no `{place}` with `{words}` in {faults:#?}");
}

/// A point of the anterior margin at A2, in the open valve.
fn middle_of_the_anterior_margin(model: &Model) -> [f64; 3] {
    let site = on_both_leaflets(model, Some(Site::A2P2), None, "test").expect("presets have both margins");
    let margin = &site.margins[0];
    margin.point_mm(0.5 * margin.length_mm()).into()
}

/// Closes a valve, which must end certified, and tells its figures (seen with `--nocapture`).
#[allow(clippy::print_stdout, reason = "figures for who asks for them")]
fn closed(name: &str, model: &Model) -> Closed {
    let start = std::time::Instant::now();
    let equilibrium = close(model);
    let certificate = &equilibrium.certificate;
    let measures = measure_with_passage(model, &equilibrium.state.positions_mm, &equilibrium.reactions_n);
    println!(
        "{name}: {:?}, {} iterations, {:.1} s; orifice {:.1} mm2, contact {:.0} mm2, tenting {:.1} mm; chordae {:.2} N, sutures {:?}",
        equilibrium.status,
        equilibrium.history.len(),
        start.elapsed().as_secs_f64(),
        measures.orifice.area_mm2,
        measures.coaptation.area_mm2,
        measures.tenting.height_mm,
        measures.chords.total_force_n,
        measures
            .sutures
            .iter()
            .map(|s| [s.max_force_n, s.total_force_n])
            .collect::<Vec<_>>(),
    );
    assert!(
        certificate.is_certified(equilibrium.status),
        "{name}: {:?}, residual {:e}, stable {}, {} crossings",
        equilibrium.status,
        certificate.residual,
        certificate.stable,
        certificate.crossings.len()
    );
    Closed {
        equilibrium,
        measures,
    }
}
