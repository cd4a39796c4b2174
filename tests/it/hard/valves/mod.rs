//! Valves: bad meshes, stiff chordae, slack tissue, ruptures, extreme loads, rings that leave tissue over.

mod deeds;
mod files;
mod rows;

use coapt::Vec3;
use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::model::Model;
use coapt::relax::Status;
use coapt::repair::apply;
use coapt::repair::ring_shape::parse_ring_spec;
use coapt::scene::{Fault, Repair, Scene};
use coapt::state::State;

use super::{End, HardCase, Jitter};
use deeds::jitter_points;
use rows::{Deed, RINGS, ROWS};

/// Faces of a valve.
const FACES: u32 = 650;
/// Its edges are 2 to 2.5 mm long.
const EDGE_MM: f64 = 2.2;

pub(super) fn cases() -> Vec<HardCase> {
    let mut cases = Vec::new();
    for (name, what, deed, presets) in ROWS {
        for &preset in presets {
            cases.push(HardCase {
                name: format!("{}: {name}", preset.name()),
                what,
                make: Box::new(move |jitter| begun(preset, deed, jitter)),
                end: end(preset, name),
            });
        }
    }
    for (preset, ring) in RINGS {
        cases.push(HardCase {
            name: format!("{}: ring {ring}", preset.name()),
            what: "tissue left over, which folds with hardly any stiffness",
            make: Box::new(move |jitter| ringed(preset, ring, jitter)),
            end: End::Certified,
        });
    }
    cases
}

/// How a row must end, where that is not with a certificate.
fn end(preset: Preset, row: &str) -> End {
    match (preset, row) {
        (Preset::Barlow, "chordae 3 times as long") => End::Uncertified(
            &[Status::IterationLimit],
            "two large leaflets that nothing holds but the annulus, under a load that follows them: no balance of forces was \
             found, at a quarter of the load neither, and there may be none",
        ),
        (_, "1000000 mmHg") => End::Uncertified(
            &[Status::Burst, Status::IterationLimit, Status::Stalled],
            "there is no balance either; what matters is that nothing passes through anything on the way, which from one of these \
             starts it did while rounding was let eat what separates two edges",
        ),
        (_, "20000 mmHg" | "as soft beyond the knee as below") => End::Uncertified(
            &[Status::Burst],
            "there is no balance: the valve grows without end, and is left where it is five times as large as it was",
        ),
        (_, "open and swapped") => End::Refused("surfaces cross or touch in the open valve"),
        _ => End::Certified,
    }
}

/// The scene of a row, which `assets/hard` holds as files.
fn scene(preset: Preset, deed: Deed) -> Result<Scene, Vec<Fault>> {
    let mut parameters = ValveParameters::preset(preset);
    parameters.face_count_target = FACES;
    if let Deed::Parameters(change) = deed {
        change(&mut parameters);
    }
    let mut scene = generate(&parameters)?;
    if let Deed::Scene(change) = deed {
        change(&mut scene);
    }
    Ok(scene)
}

fn begun(preset: Preset, deed: Deed, jitter: &mut Jitter) -> Result<(Model, State), Vec<Fault>> {
    let model = jittered(scene(preset, deed)?, jitter)?;
    let mut state = State::open(&model);
    if let Deed::Start(change) = deed {
        change(&model, &mut state);
    }
    Ok((model, state))
}

fn ringed(preset: Preset, spec: &str, jitter: &mut Jitter) -> Result<(Model, State), Vec<Fault>> {
    let model = jittered(scene(preset, Deed::Scene(|_| {}))?, jitter)?;
    let ring = parse_ring_spec(spec).map_err(|fault| vec![fault])?;
    let model = apply(&model, &Repair::Ring(ring))?.model;
    let state = State::open(&model);
    Ok((model, state))
}

fn jittered(mut scene: Scene, jitter: &mut Jitter) -> Result<Model, Vec<Fault>> {
    jitter_points(&mut scene, |point: Vec3| jitter.moved(point, EDGE_MM));
    Ok(Model::build(&scene)?.model)
}
