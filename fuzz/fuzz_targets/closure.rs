//! Small good valves, spoilt in a few places, are closed and measured: whatever comes out is defined, and its status is
//! true.

#![no_main]

use std::path::Path;
use std::sync::LazyLock;

use arbitrary::Arbitrary;
use coapt::contact::crossing::crossings;
use coapt::contact::surface::Surface;
use coapt::measure::measure;
use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::model::Model;
use coapt::relax::{Equilibrium, Status, relax};
use coapt::repair::apply;
use coapt::scene::{Attachment, Repair, Ring, RingFamily, Scene};
use coapt::state::State;
use coapt_fuzz::changes::{Change, make};
use coapt_fuzz::{check_defined, check_faults, check_model, good_scene};
use coapt_io::scene::read_scene;
use libfuzzer_sys::fuzz_target;

/// Valves of 16 faces, of 96, and three presets as coarse as they come.
static VALVES: LazyLock<[Scene; 5]> = LazyLock::new(|| {
    let small = Path::new(env!("CARGO_MANIFEST_DIR")).join("seeds/scene/small.json");
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
    ring: Option<(u8, u8, bool)>,
}

fuzz_target!(|case: Case| {
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
    if let Some(ring) = case.ring {
        under_ring(&model, &closed, ring);
    }
});

fn under_ring(model: &Model, closed: &Equilibrium, (family, size, nearest): (u8, u8, bool)) {
    let families = [
        RingFamily::ClassicLike,
        RingFamily::PhysioLike,
        RingFamily::Saddle,
        RingFamily::ReducedAp,
        RingFamily::PosteriorBand,
    ];
    let ring = Ring {
        family: Some(families[usize::from(family) % families.len()]),
        size_mm: Some(20.0 + f64::from(size % 32)),
        curve_file: None,
        curve_mm: None,
        closed: None,
        placed: false,
        attachment: if nearest {
            Attachment::NearestPoint
        } else {
            Attachment::ArcLength
        },
    };
    match apply(model, &Repair::Ring(ring)) {
        Ok(repaired) => {
            check_model(&repaired.model);
            close(&repaired.model, &closed.state);
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
