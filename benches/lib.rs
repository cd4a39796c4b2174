//! The valves that the benches work on, open and closed.
//!
//! ```text
//! cargo bench -p coapt-benches                                      # closed valves up to 2600 faces
//! cargo bench -p coapt-benches -- /650                              # one size
//! cargo bench -p coapt-benches --bench relax -- closure/cold/10k    # a large one, asked for by its name
//! COAPT_BENCH_LARGE=1 cargo bench -p coapt-benches                  # all large ones: minutes to hours
//! cargo bench -p coapt-benches --bench ratio                        # closure to force evaluation to explicit baseline
//! ```
//!
//! Names are `step/size`, the size being the number of faces aimed at, or `step/case` at [`PLANNING_SIZE`]. Valves
//! are generated and closed outside what is timed, and only if the filter asks for them. A valve that did not close
//! properly stops the bench: how fast a wrong answer comes is worth nothing.

pub mod explicit;

use coapt::Vec3;
use coapt::contact::gather::PairList;
use coapt::contact::pairs::{Pair, Place, rigid_fraction};
use coapt::contact::surface::Surface;
use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::model::Model;
use coapt::relax::{Equilibrium, relax};
use coapt::scene::Scene;
use coapt::state::State;

/// Faces aimed at: as many as in the published mass-spring valves (600 to 700), four, fifteen and a hundred and fifty
/// times as many.
pub const SIZES: [u32; 4] = [650, 2600, 10_000, 100_000];

/// Faces of the valve on which plans are tried.
pub const PLANNING_SIZE: u32 = 650;

/// How a size is called.
pub fn label(size: u32) -> String {
    match size {
        10_000.. => format!("{}k", size / 1000),
        _ => size.to_string(),
    }
}

/// The sizes to be closed: those from 10,000 on take minutes and must be asked for, by their label in the filter or all
/// by `COAPT_BENCH_LARGE=1`.
pub fn closed_sizes() -> Vec<u32> {
    let all = std::env::var_os("COAPT_BENCH_LARGE").is_some_and(|value| value == "1");
    let named = |size: u32| std::env::args().skip(1).any(|word| word.contains(&label(size)));
    SIZES
        .into_iter()
        .filter(|&size| size < 10_000 || all || named(size))
        .collect()
}

/// The parameters of a preset with about so many faces.
pub fn preset_parameters(preset: Preset, face_count: u32) -> ValveParameters {
    ValveParameters {
        face_count_target: face_count,
        ..ValveParameters::preset(preset)
    }
}

/// A preset as a scene.
///
/// # Panics
/// If it cannot be generated.
pub fn preset_scene(preset: Preset, face_count: u32) -> Scene {
    generate(&preset_parameters(preset, face_count)).expect("a preset can be generated")
}

/// A preset, open.
///
/// # Panics
/// If it cannot be built.
pub fn preset_model(preset: Preset, face_count: u32) -> Model {
    Model::build(&preset_scene(preset, face_count))
        .expect("a preset can be built")
        .model
}

/// The healthy valve, open.
///
/// # Panics
/// If it cannot be built.
pub fn healthy_model(face_count: u32) -> Model {
    preset_model(Preset::Healthy, face_count)
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

/// The valve with its annulus drawn in by so many percent along its anteroposterior diameter, as a ring would.
pub fn narrowed(model: &Model, percent: f64) -> Model {
    let mut narrowed = model.clone();
    let target = |vertex: u32| {
        let held = model.prescribed.iter().find(|held| held.vertex == vertex);
        held.map_or(model.rest_mm[vertex as usize], |held| held.target_mm)
    };
    let centre = model.annulus.iter().map(|&v| target(v)).sum::<Vec3>() / model.annulus.len() as f64;
    let landmark = |index: usize| target(model.annulus[index]);
    let marks = &model.landmarks;
    let across = (landmark(marks.mid_posterior) - landmark(marks.mid_anterior)).normalize();
    for held in &mut narrowed.prescribed {
        if model.annulus.contains(&held.vertex) {
            held.target_mm -= across * (across.dot(&(held.target_mm - centre)) * percent / 100.0);
        }
    }
    narrowed
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
    let mut pairs = Vec::new();
    let at_rest = vec![Vec3::zeros(); state.positions_mm.len()];
    PairList::default().gather(
        &place(&model, &surface, &state.positions_mm),
        &at_rest,
        &mut pairs,
    );
    Scenery {
        model,
        surface,
        state,
        pairs,
    }
}

/// Where the valve looks for contact, as the solver does.
pub fn place<'a>(model: &'a Model, surface: &'a Surface, positions_mm: &'a [Vec3]) -> Place<'a> {
    let thickness_mm = model.contact.thickness_mm;
    Place {
        surface,
        rest_mm: &model.rest_mm,
        positions_mm,
        thickness_mm,
        rigid_fraction: rigid_fraction(surface, thickness_mm),
        kept_fraction: 0.0,
    }
}
