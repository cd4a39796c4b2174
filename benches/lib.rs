//! The valves that the benches work on, open and closed.
//!
//! ```text
//! cargo bench -p coapt-benches              # open valves of every size, closed ones up to 2600 faces
//! cargo bench -p coapt-benches -- 650       # one size
//! COAPT_BENCH_LARGE=1 cargo bench -p coapt-benches      # 10000 faces closed as well: minutes
//! ```
//!
//! Names are `step/size`, the size being the number of faces aimed at. Valves are generated and closed outside
//! what is timed, and only if the filter asks for them. A valve that did not close properly stops the bench:
//! how fast a wrong answer comes is worth nothing.

use coapt::contact::pairs::{Pair, PairList};
use coapt::contact::surface::Surface;
use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::model::Model;
use coapt::relax::{Equilibrium, relax};
use coapt::scene::Scene;
use coapt::state::State;

/// Faces aimed at: as many as in the published mass-spring valves (600 to 700), four times and fifteen times
/// as many.
pub const SIZES: [u32; 3] = [650, 2600, 10_000];

/// The sizes to be closed: the largest takes minutes and must be asked for by `COAPT_BENCH_LARGE=1`.
pub fn closed_sizes() -> Vec<u32> {
    let large = std::env::var_os("COAPT_BENCH_LARGE").is_some_and(|value| value == "1");
    SIZES.into_iter().filter(|&size| large || size < 10_000).collect()
}

/// The parameters of the healthy valve with about so many faces.
pub fn healthy_parameters(face_count: u32) -> ValveParameters {
    ValveParameters {
        face_count_target: face_count,
        ..ValveParameters::preset(Preset::Healthy)
    }
}

/// The healthy valve as a scene.
///
/// # Panics
/// If it cannot be generated.
pub fn healthy_scene(face_count: u32) -> Scene {
    generate(&healthy_parameters(face_count)).expect("the healthy valve can be generated")
}

/// The healthy valve, open.
///
/// # Panics
/// If it cannot be built.
pub fn healthy_model(face_count: u32) -> Model {
    Model::build(&healthy_scene(face_count))
        .expect("the healthy valve can be built")
        .model
}

/// Closes a valve from open.
///
/// # Panics
/// If the result is not certified.
pub fn close(model: &Model) -> Equilibrium {
    let equilibrium = relax(model, &State::open(model));
    assert_certified(&equilibrium);
    equilibrium
}

/// Stops the bench if a result may not be used.
///
/// # Panics
/// If the result is not certified.
pub fn assert_certified(equilibrium: &Equilibrium) {
    let certificate = &equilibrium.certificate;
    assert!(
        certificate.is_certified(equilibrium.status),
        "not certified: {:?}, residual {:e}, stable {}, {} crossings",
        equilibrium.status,
        certificate.residual,
        certificate.stable,
        certificate.crossings.len()
    );
}

/// A valve at one of its positions, with what the solver keeps beside it.
#[derive(Clone, Debug)]
pub struct Scenery {
    /// The valve.
    pub model: Model,
    /// Its triangles, prepared for contact.
    pub surface: Surface,
    /// Where its vertices are.
    pub state: State,
    /// The pairs that may touch there.
    pub pairs: Vec<Pair>,
}

/// The open valve.
pub fn open_scenery(face_count: u32) -> Scenery {
    let model = healthy_model(face_count);
    let state = State::open(&model);
    scenery(model, state)
}

/// The closed valve.
pub fn closed_scenery(face_count: u32) -> Scenery {
    let model = healthy_model(face_count);
    let state = close(&model).state;
    scenery(model, state)
}

fn scenery(model: Model, state: State) -> Scenery {
    let surface = Surface::new(&model.faces, &model.rest_mm);
    let mut list = PairList::default();
    let thickness_mm = model.contact.thickness_mm;
    list.rebuild(
        &surface,
        &model.rest_mm,
        &state.positions_mm,
        thickness_mm,
        budget_mm(&model),
    );
    let pairs = list.touching(&state.positions_mm, &state.positions_mm);
    Scenery {
        model,
        surface,
        state,
        pairs,
    }
}

/// How far vertices may move before pairs must be listed anew [mm]: what the solver allows for when steps have
/// become short.
pub fn budget_mm(model: &Model) -> f64 {
    0.1 * model.contact.thickness_mm
}
