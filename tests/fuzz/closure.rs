//! Small good valves, spoilt in a few places, are closed and measured: whatever comes out is defined, and its status is
//! true.

use std::sync::LazyLock;

use crate::changes::{Change, make};
use crate::{check_defined, check_faults, check_model, good_scene, seeds};
use arbitrary::{Arbitrary, Unstructured};
use coapt::contact::crossing::crossings;
use coapt::contact::surface::Surface;
use coapt::measure::measure;
use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::model::Model;
use coapt::relax::{Equilibrium, Status, relax};
use coapt::repair::apply;
use coapt::scene::{Repair, Scene};
use coapt::state::State;
use coapt_io::scene::read_scene;

/// Valves of 16 faces, of 96, and three presets as coarse as they come.
static VALVES: LazyLock<[Scene; 5]> = LazyLock::new(|| {
    let small = seeds().join("scene/small.json");
    let small = read_scene(&small).expect("the small scene is good").0;
    let [healthy, flail, barlow] = [Preset::Healthy, Preset::Flail, Preset::Barlow].map(|preset| {
        let mut parameters = ValveParameters::preset(preset);
        parameters.face_count_target = 100;
        generate(&parameters).expect("presets are right")
    });
    [small, good_scene(), healthy, flail, barlow]
});
/// Most closures are of the small valve, ten of which take as long as one of a preset.
const VALVE_OF: [usize; 16] = [0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 3, 4];

/// More changes leave no valve.
const MOST_CHANGES: usize = 8;
/// Where a prescribed vertex counts as arrived [mm]: rounding of coordinates of ten metres.
const ARRIVED_MM: f64 = 1e-6;

#[derive(Arbitrary, Debug)]
struct Case {
    valve: u8,
    iteration_limit: u8,
    changes: Vec<Change>,
    repair: Option<[u8; 2]>,
}

/// One input: the bytes of a case; too few are none.
pub fn closure(bytes: &[u8]) {
    let Ok(case) = Case::arbitrary_take_rest(Unstructured::new(bytes)) else {
        return;
    };
    let mut scene = VALVES[VALVE_OF[usize::from(case.valve) % VALVE_OF.len()]].clone();
    scene.settings.iteration_limit = 1 + u32::from(case.iteration_limit);
    for change in case.changes.iter().take(MOST_CHANGES) {
        make(&mut scene, change);
    }
    let model = match Model::build(&scene) {
        Ok(built) => built.model,
        Err(faults) => return check_faults(&faults, true),
    };
    check_model(&model);
    let closed = close(&model, &State::open(&model));
    if let Some(repair) = case.repair {
        after_repair(&model, &closed, repair);
    }
}

/// Repairs as they stand in plans, of two bytes.
fn repair([kind, size]: [u8; 2]) -> Repair {
    let part = f64::from(size) / 255.0;
    let size_mm = 20 + size % 32;
    let families = [
        "classic-like",
        "physio-like",
        "saddle",
        "reduced-ap",
        "posterior-band",
    ];
    let family = families[usize::from(size) % families.len()];
    let written = match kind % 9 {
        0 => format!(r#""ring", "family": "{family}", "size_mm": {size_mm}"#),
        1 => format!(r#""ring", "family": "{family}", "size_mm": {size_mm}, "attachment": "nearest-point""#),
        2 => format!(r#""ring", "family": "{family}", "size_mm": {size_mm}, "attachment": "sutures""#),
        3 => format!(r#""clip", "position": {part}"#),
        4 => format!(r#""clip", "position": {part}, "model": "rigid", "size": "long-wide""#),
        5 => format!(r#""alfieri", "position": {part}"#),
        6 => format!(r#""neochord", "leaflet": "posterior", "position": {part}"#),
        7 => format!(
            r#""resect", "leaflet": "posterior", "shape": "triangular", "position": {part}, "width_mm": 4"#
        ),
        _ => format!(r#""close-cleft", "position": {part}, "depth_mm": 5"#),
    };
    let written = format!(r#"{{"kind": {written}}}"#);
    serde_json::from_str(&written).unwrap_or_else(|error| panic!("{written}: {error}"))
}

fn after_repair(model: &Model, closed: &Equilibrium, bytes: [u8; 2]) {
    match apply(model, &repair(bytes)) {
        Ok(repaired) => {
            check_model(&repaired.model);
            // A resection makes a mesh of its own.
            let is_same_mesh = repaired.model.faces == model.faces;
            let start = if is_same_mesh {
                closed.state.clone()
            } else {
                State::open(&repaired.model)
            };
            close(&repaired.model, &start);
        }
        Err(faults) => check_faults(&faults, true),
    }
}

/// Closes a valve and sees that what is said of it is true.
fn close(model: &Model, start: &State) -> Equilibrium {
    let closed = relax(model, start);
    let positions = &closed.state.positions_mm;
    check_defined(&closed);
    assert_eq!(positions.len(), model.rest_mm.len());
    assert_eq!(closed.reactions_n.len(), model.rest_mm.len());
    let surface = Surface::new(&model.faces, &model.rest_mm);
    assert_eq!(closed.certificate.crossings, crossings(&surface, positions));
    match closed.status {
        Status::TangledStart => assert_eq!(positions, &start.positions_mm),
        _ if model.contact.is_on() => assert!(
            closed.certificate.crossings.is_empty(),
            "{:?}",
            closed.certificate
        ),
        _ => {}
    }
    if closed.status == Status::Converged {
        assert!(
            closed.certificate.residual <= model.settings.residual_tolerance,
            "{:?}",
            closed.certificate
        );
        let away = |p: &coapt::model::Prescribed| (positions[p.vertex as usize] - p.target_mm).norm();
        let farthest = model.prescribed.iter().map(away).fold(0.0, f64::max);
        assert!(farthest <= ARRIVED_MM, "{farthest} mm from where it should be");
    }
    check_defined(&measure(model, positions, &closed.reactions_n));
    closed
}
