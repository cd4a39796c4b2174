//! Valves that solvers like to fail on: bad meshes, stiff chordae, slack tissue, ruptures, extreme loads. Each must close
//! to the default residual of 1e-6 and be certified, in every preset.

use coapt::Vec3;
use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::model::Model;
use coapt::relax::{Equilibrium, Interactive, Status, relax};
use coapt::repair::apply;
use coapt::repair::ring_shape::parse_ring_spec;
use coapt::scene::{Load, Repair, Scene, SurfaceMesh, Tissue};
use coapt::state::State;
use coapt_tests::close;

/// What a row does to a preset: to its parameters, to its scene or to its model.
enum Stress {
    Parameters(fn(&mut ValveParameters)),
    Scene(fn(&mut Scene)),
    Model(fn(&mut Model)),
}

use Stress::{Model as OnModel, Parameters as OnParameters, Scene as OnScene};

const ROWS: [(&str, Stress); 12] = [
    ("base", OnScene(|_| {})),
    ("slivers", OnScene(|scene| meshes(scene).for_each(make_slivers))),
    // Edges are 2 to 2.5 mm long.
    (
        "jitter of 0.4 edges",
        OnParameters(|valve| valve.jitter_mm = 0.4 * 2.2),
    ),
    (
        "chordae 100 times as stiff",
        OnScene(|scene| {
            scene
                .chordae
                .iter_mut()
                .for_each(|group| group.modulus_mpa = group.modulus_mpa.map(|modulus| 100.0 * modulus))
        }),
    ),
    (
        "leaflets 1.3 times as high, slack chordae",
        OnParameters(|valve| {
            valve.leaflets.height_scale *= 1.3;
            // Else they reach across the orifice already when open.
            valve.leaflets.opening_angle_deg = 8.0;
            valve.chordae.rest_length_scale *= 1.2;
        }),
    ),
    // Of 14 posterior marginal chordae; intermediate ones beside them go too.
    (
        "4 chordae ruptured",
        OnParameters(|valve| valve.chordae.ruptured_posterior_fraction = 4.0 / 14.0),
    ),
    (
        "12 chordae ruptured",
        OnParameters(|valve| valve.chordae.ruptured_posterior_fraction = 12.0 / 14.0),
    ),
    (
        "all marginal chordae ruptured",
        OnScene(|scene| scene.chordae.retain(|group| group.name != "marginal")),
    ),
    ("200 mmHg", OnScene(|scene| scene.load = Load::mmhg(200.0))),
    ("5 mmHg", OnScene(|scene| scene.load = Load::mmhg(5.0))),
    ("30 MPa beyond the knee", OnScene(stiffen_collagen)),
    ("annulus narrowed by 20 %", OnModel(narrow)),
];

fn meshes(scene: &mut Scene) -> impl Iterator<Item = &mut SurfaceMesh> {
    scene
        .leaflets
        .iter_mut()
        .filter_map(|leaflet| leaflet.mesh.as_mut())
}

/// Moves points 0.85 of the way to a neighbour, as many as have no neighbour in common with one moved before: the faces
/// that the two share become needles of a sixth of their height.
fn make_slivers(mesh: &mut SurfaceMesh) {
    let sides = |face: &[u32; 3]| [[face[0], face[1]], [face[1], face[2]], [face[2], face[0]]];
    let directed: Vec<[u32; 2]> = mesh.faces.iter().flat_map(sides).collect();
    let on_border = |point: u32| {
        let mut out = directed.iter().filter(|side| side[0] == point);
        out.any(|&[a, b]| !directed.contains(&[b, a]))
    };
    let mut held = vec![false; mesh.points_mm.len()];
    for point in 0..mesh.points_mm.len() as u32 {
        let around: Vec<u32> = directed
            .iter()
            .filter(|side| side[0] == point)
            .map(|side| side[1])
            .collect();
        if held[point as usize] || around.iter().any(|&other| held[other as usize]) || on_border(point) {
            continue;
        }
        let goal = mesh.points_mm[around[0] as usize];
        let place = &mut mesh.points_mm[point as usize];
        (0..3).for_each(|axis| place[axis] += 0.85 * (goal[axis] - place[axis]));
        held[point as usize] = true;
        around.iter().for_each(|&other| held[other as usize] = true);
    }
}

fn stiffen_collagen(scene: &mut Scene) {
    for leaflet in &mut scene.leaflets {
        if let Tissue::BilinearSprings {
            post_transition_modulus_mpa,
            ..
        } = &mut leaflet.tissue
        {
            *post_transition_modulus_mpa = 30.0;
        }
    }
}

/// Parametric valves stand with their anteroposterior diameter along y.
fn narrow(model: &mut Model) {
    for held in model
        .prescribed
        .iter_mut()
        .filter(|held| model.annulus.contains(&held.vertex))
    {
        held.target_mm.y *= 0.8;
    }
}

fn stressed(preset: Preset, stress: &Stress) -> Model {
    let mut parameters = ValveParameters::preset(preset);
    parameters.face_count_target = 650;
    if let OnParameters(change) = stress {
        change(&mut parameters);
    }
    let mut scene = generate(&parameters).expect("stressed parameters are right");
    if let OnScene(change) = stress {
        change(&mut scene);
    }
    let mut model = Model::build(&scene).expect("stressed valves build").model;
    if let OnModel(change) = stress {
        change(&mut model);
    }
    model
}

/// What is wrong with a result, if anything is.
fn complaint(name: &str, equilibrium: &Equilibrium) -> Option<String> {
    let certificate = &equilibrium.certificate;
    let right = certificate.is_certified(equilibrium.status) && certificate.residual <= 1e-6;
    (!right).then(|| {
        format!(
            "{name}: {:?}, residual {:.1e}, stable {}, {} crossings, {} iterations",
            equilibrium.status,
            certificate.residual,
            certificate.stable,
            certificate.crossings.len(),
            equilibrium.history.len()
        )
    })
}

/// A flap that nothing holds, on a valve too large for it, under a load that follows it: no balance of forces was found
/// from any of six roads, with and without coarse meshes, and there may be none.
const FLUTTERS: (Preset, &str) = (Preset::Flail, "all marginal chordae ruptured");

#[test]
fn what_does_not_come_to_rest_is_not_certified() {
    let (preset, row) = FLUTTERS;
    let stress = ROWS
        .iter()
        .find(|(name, _)| *name == row)
        .map(|(_, stress)| stress);
    let mut model = stressed(preset, stress.expect("a row of that name"));
    model.settings.iteration_limit = 200;
    let equilibrium = close(&model);
    assert_eq!(equilibrium.status, Status::IterationLimit);
    assert!(!equilibrium.certificate.is_certified(equilibrium.status));
    assert_eq!(equilibrium.certificate.crossings, []);
    assert!(
        equilibrium
            .state
            .positions_mm
            .iter()
            .all(|x| x.iter().all(|value| value.is_finite()))
    );
}

#[test]
fn every_stressed_valve_is_certified() {
    let mut complaints = Vec::new();
    for (row, stress) in &ROWS {
        for preset in Preset::ALL {
            let name = format!("{}, {row}", preset.name());
            if (preset, *row) == FLUTTERS {
                continue;
            }
            complaints.extend(complaint(&name, &close(&stressed(preset, stress))));
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

/// Rings that leave tissue over, which folds up with hardly any stiffness, and chordae slack, which have none at all. Steps
/// that were damped for the factor's sake never came to rest under the Barlow valve's ring of 30 mm; eigenvalues of zero,
/// found as -1e-10, made sound balances look unstable under most of the others.
#[test]
fn valves_with_tissue_left_over_come_to_rest() {
    let rings = [
        (
            Preset::Barlow,
            [
                "physio-like:28",
                "physio-like:30",
                "reduced-ap:40",
                "posterior-band:32",
            ],
        ),
        (
            Preset::Healthy,
            ["classic-like:24", "physio-like:27", "saddle:35", "reduced-ap:32"],
        ),
    ];
    let mut complaints = Vec::new();
    for (preset, specs) in rings {
        let valve = stressed(preset, &OnScene(|_| {}));
        for spec in specs {
            let ring = parse_ring_spec(spec).expect("a ring");
            let repaired = apply(&valve, &Repair::Ring(ring)).expect("the ring fits");
            let name = format!("{}, {spec}", preset.name());
            complaints.extend(complaint(&name, &close(&repaired.model)));
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn what_is_not_a_number_ends_as_stalled() {
    let model = stressed(Preset::Restricted, &OnScene(|_| {}));
    let closed = close(&model);
    let mut targets: Vec<Vec3> = model.prescribed.iter().map(|held| held.target_mm).collect();
    targets[3].x = f64::NAN;
    let mut start = State::open(&model);
    start.positions_mm[5].y = f64::NAN;
    for end in [
        Interactive::new(&model, &closed).close(&targets),
        relax(&model, &start),
    ] {
        assert_eq!(end.status, Status::Stalled);
        assert!(!end.certificate.is_certified(end.status));
    }
}

#[test]
fn crossed_leaflets_are_refused() {
    for preset in Preset::ALL {
        let model = stressed(preset, &OnScene(|_| {}));
        let mut start = State::open(&model);
        let lowest = start.positions_mm.iter().map(|x| x.z).fold(0.0, f64::min);
        // The lower, the farther to the other side: margins change places.
        let is_leaflet = |vertex: usize| vertex < model.leaflet_vertex_count;
        for (vertex, x) in start
            .positions_mm
            .iter_mut()
            .enumerate()
            .filter(|(vertex, _)| is_leaflet(*vertex))
        {
            let depth = (x.z / lowest).clamp(0.0, 1.0);
            if !model.annulus.contains(&(vertex as u32)) {
                *x = Vec3::new(x.x, x.y * (1.0 - 3.0 * depth), x.z);
            }
        }
        let equilibrium = relax(&model, &start);
        assert_eq!(equilibrium.status, Status::TangledStart, "{}", preset.name());
        assert!(equilibrium.certificate.crossings.len() > 10, "{}", preset.name());
        assert_eq!(equilibrium.state, start, "{}", preset.name());
    }
}
