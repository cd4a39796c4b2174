//! Valves: bad meshes, stiff chordae, slack tissue, ruptures, extreme loads, rings that leave tissue over.

use std::collections::BTreeMap;

use coapt::Vec3;
use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::model::Model;
use coapt::relax::Status;
use coapt::repair::apply;
use coapt::repair::ring_shape::parse_ring_spec;
use coapt::scene::{Fault, Load, Repair, Scene, SurfaceMesh, Tissue};
use coapt::state::State;

use super::{End, HardCase, Jitter};

/// Faces of a valve.
const FACES: u32 = 650;
/// Its edges are 2 to 2.5 mm long.
const EDGE_MM: f64 = 2.2;

/// What a row does to a preset: to its parameters, to its scene, to its model or to where it begins.
#[derive(Clone, Copy)]
enum Deed {
    Parameters(fn(&mut ValveParameters)),
    Scene(fn(&mut Scene)),
    Model(fn(&mut Model)),
    Start(fn(&Model, &mut State)),
    Ring(&'static str),
}

/// A row: name, what is hard about it, what is done, to which valves.
type Row = (&'static str, &'static str, Deed, &'static [Preset]);

const ALL: &[Preset] = &Preset::ALL;
const HEALTHY: &[Preset] = &[Preset::Healthy];

const ROWS: [Row; 27] = [
    ("base", "nothing", Deed::Scene(|_| {}), ALL),
    (
        "slivers",
        "needles a sixth as high as before",
        Deed::Scene(|scene| meshes(scene).for_each(make_slivers)),
        ALL,
    ),
    (
        "jitter of 0.4 edges",
        "triangles of any shape",
        Deed::Parameters(|valve| valve.jitter_mm = 0.4 * EDGE_MM),
        ALL,
    ),
    (
        "chordae 100 times as stiff",
        "stiffness of chordae and tissue far apart",
        Deed::Scene(|scene| {
            scene
                .chordae
                .iter_mut()
                .filter_map(|group| group.modulus_mpa.as_mut())
                .for_each(|modulus| *modulus *= 100.0)
        }),
        ALL,
    ),
    (
        "leaflets 1.3 times as high",
        "tissue left over, slack chordae: folds",
        Deed::Parameters(excess_tissue),
        ALL,
    ),
    // Of 14 posterior marginal chordae; intermediate ones beside them go too.
    (
        "4 chordae ruptured",
        "part of a margin is held by nothing",
        Deed::Parameters(|valve| valve.chordae.ruptured_posterior_fraction = 4.0 / 14.0),
        ALL,
    ),
    (
        "12 chordae ruptured",
        "a flap under a load that follows it",
        Deed::Parameters(|valve| valve.chordae.ruptured_posterior_fraction = 12.0 / 14.0),
        ALL,
    ),
    (
        "all marginal chordae ruptured",
        "both margins are held by nothing",
        Deed::Scene(|scene| scene.chordae.retain(|group| group.name != "marginal")),
        ALL,
    ),
    (
        "5 mmHg",
        "hardly any load",
        Deed::Scene(|scene| scene.load = Load::mmhg(5.0)),
        ALL,
    ),
    (
        "200 mmHg",
        "twice the load",
        Deed::Scene(|scene| scene.load = Load::mmhg(200.0)),
        ALL,
    ),
    (
        "400 mmHg",
        "four times the load",
        Deed::Scene(|scene| scene.load = Load::mmhg(400.0)),
        ALL,
    ),
    (
        "no pressure",
        "no scale for the residual",
        Deed::Scene(|scene| scene.load = Load::mmhg(0.0)),
        ALL,
    ),
    (
        "no pressure, annulus narrowed by 20 %",
        "the same, and something moves",
        Deed::Model(|model| {
            model.pressure_mpa = 0.0;
            narrow(model, 0.8);
        }),
        ALL,
    ),
    (
        "30 MPa beyond the knee",
        "stiff beyond the knee",
        Deed::Scene(|scene| each_tissue(scene, |_, stiff| *stiff = 30.0)),
        ALL,
    ),
    (
        "no knee",
        "the same stiffness everywhere",
        Deed::Scene(|scene| knee(scene, 1.0)),
        ALL,
    ),
    (
        "knee of 10",
        "stiffness jumps at the knee",
        Deed::Scene(|scene| knee(scene, 10.0)),
        ALL,
    ),
    (
        "knee of 100",
        "stiffness jumps at the knee",
        Deed::Scene(|scene| knee(scene, 100.0)),
        ALL,
    ),
    (
        "knee of 1000",
        "stiffness jumps at the knee",
        Deed::Scene(|scene| knee(scene, 1000.0)),
        ALL,
    ),
    (
        "annulus narrowed by 20 %",
        "tissue left over: wrinkles",
        Deed::Model(|model| narrow(model, 0.8)),
        ALL,
    ),
    (
        "annulus narrowed by 40 %",
        "tissue left over: wrinkles",
        Deed::Model(|model| narrow(model, 0.6)),
        ALL,
    ),
    (
        "chordae 3 times as long",
        "all chordae slack: the leaflets blow through",
        Deed::Scene(|scene| {
            scene
                .chordae
                .iter_mut()
                .for_each(|group| group.rest_length_scale = 3.0)
        }),
        ALL,
    ),
    (
        "chordae half as long",
        "all chordae taut when open",
        Deed::Scene(|scene| {
            scene
                .chordae
                .iter_mut()
                .for_each(|group| group.rest_length_scale = 0.5)
        }),
        ALL,
    ),
    (
        "begun inverted",
        "leaflets billow to the atrium",
        Deed::Start(|model, state| each_free(model, state, |point| point.z = -point.z)),
        ALL,
    ),
    (
        "begun flat",
        "leaflets in a plane, with no stiffness across it",
        Deed::Start(|model, state| each_free(model, state, |point| point.z = 0.0)),
        ALL,
    ),
    (
        "begun crossed",
        "margins three times as far on the wrong side",
        Deed::Start(|model, state| {
            let lowest = lowest_mm(&model.rest_mm);
            each_free(model, state, |point| swing(point, 3.0, lowest));
        }),
        ALL,
    ),
    (
        "open and crossed by some millimetres",
        "leaflets overlap in the open valve",
        Deed::Scene(|scene| cross(scene, 1.45)),
        HEALTHY,
    ),
    (
        "open and in one plane",
        "margins of both leaflets lie in one plane, one on the other",
        Deed::Scene(|scene| flatten(scene, 0.0)),
        HEALTHY,
    ),
];

const RINGS: [(Preset, &str); 8] = [
    (Preset::Barlow, "physio-like:28"),
    (Preset::Barlow, "physio-like:30"),
    (Preset::Barlow, "reduced-ap:40"),
    (Preset::Barlow, "posterior-band:32"),
    (Preset::Healthy, "classic-like:24"),
    (Preset::Healthy, "physio-like:27"),
    (Preset::Healthy, "saddle:35"),
    (Preset::Healthy, "reduced-ap:32"),
];

pub(super) fn cases() -> Vec<HardCase> {
    let mut cases = Vec::new();
    for (name, what, deed, presets) in ROWS {
        for &preset in presets {
            cases.push(HardCase {
                name: format!("{}: {name}", preset.name()),
                what,
                make: Box::new(move |jitter| make(preset, deed, jitter)),
                end: end(preset, name),
            });
        }
    }
    for (preset, ring) in RINGS {
        cases.push(HardCase {
            name: format!("{}: ring {ring}", preset.name()),
            what: "tissue left over, which folds with hardly any stiffness",
            make: Box::new(move |jitter| make(preset, Deed::Ring(ring), jitter)),
            end: End::Certified,
        });
    }
    cases.push(HardCase {
        name: "healthy: open and swapped".into(),
        what: "leaflets hang on the wrong side of each other",
        make: Box::new(|jitter| make(Preset::Healthy, Deed::Scene(|scene| cross(scene, 3.0)), jitter)),
        end: End::Refused("surfaces cross or touch in the open valve"),
    });
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
        _ => End::Certified,
    }
}

fn make(preset: Preset, deed: Deed, jitter: &mut Jitter) -> Result<(Model, State), Vec<Fault>> {
    let mut parameters = ValveParameters::preset(preset);
    parameters.face_count_target = FACES;
    if let Deed::Parameters(change) = deed {
        change(&mut parameters);
    }
    let mut scene = generate(&parameters)?;
    if let Deed::Scene(change) = deed {
        change(&mut scene);
    }
    // Points that leaflets share stay shared.
    let mut moved: BTreeMap<[u64; 3], Vec3> = BTreeMap::new();
    for point in meshes(&mut scene).flat_map(|mesh| &mut mesh.points_mm) {
        let place = point.map(f64::to_bits);
        *point = (*moved
            .entry(place)
            .or_insert_with(|| jitter.moved(Vec3::from(*point), EDGE_MM)))
        .into();
    }
    let mut model = Model::build(&scene)?.model;
    if let Deed::Model(change) = deed {
        change(&mut model);
    }
    if let Deed::Ring(spec) = deed {
        let ring = parse_ring_spec(spec).map_err(|fault| vec![fault])?;
        model = apply(&model, &Repair::Ring(ring))?.model;
    }
    let mut state = State::open(&model);
    if let Deed::Start(change) = deed {
        change(&model, &mut state);
    }
    Ok((model, state))
}

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

fn excess_tissue(valve: &mut ValveParameters) {
    valve.leaflets.height_scale *= 1.3;
    // Else they reach across the orifice already when open.
    valve.leaflets.opening_angle_deg = 8.0;
    valve.chordae.rest_length_scale *= 1.2;
}

fn each_tissue(scene: &mut Scene, change: impl Fn(&mut f64, &mut f64)) {
    for leaflet in &mut scene.leaflets {
        if let Tissue::BilinearSprings {
            pre_transition_modulus_mpa,
            post_transition_modulus_mpa,
            ..
        } = &mut leaflet.tissue
        {
            change(pre_transition_modulus_mpa, post_transition_modulus_mpa);
        }
    }
}

/// Tissue that is so many times as stiff beyond its knee as below.
fn knee(scene: &mut Scene, ratio: f64) {
    each_tissue(scene, |soft, stiff| *soft = *stiff / ratio);
}

/// Parametric valves stand with their anteroposterior diameter along y.
fn narrow(model: &mut Model, part: f64) {
    for held in model
        .prescribed
        .iter_mut()
        .filter(|held| model.annulus.contains(&held.vertex))
    {
        held.target_mm.y *= part;
    }
}

fn each_free(model: &Model, state: &mut State, change: impl Fn(&mut Vec3)) {
    for vertex in (0..model.leaflet_vertex_count).filter(|vertex| !model.annulus.contains(&(*vertex as u32)))
    {
        change(&mut state.positions_mm[vertex]);
    }
}

fn lowest_mm(points_mm: &[Vec3]) -> f64 {
    points_mm.iter().map(|point| point.z).fold(0.0, f64::min)
}

/// Swings a point towards the other leaflet, the lower it hangs the more: at 1 the lowest meet in the middle.
fn swing(point: &mut Vec3, part: f64, lowest_mm: f64) {
    point.y *= 1.0 - part * (point.z / lowest_mm).clamp(0.0, 1.0);
}

fn each_point(scene: &mut Scene, change: impl Fn(&mut Vec3, f64)) {
    let points = meshes(scene).flat_map(|mesh| &mesh.points_mm);
    let lowest = points.map(|point| point[2]).fold(0.0, f64::min);
    for point in meshes(scene).flat_map(|mesh| &mut mesh.points_mm) {
        let mut moved = Vec3::from(*point);
        change(&mut moved, lowest);
        *point = moved.into();
    }
}

fn cross(scene: &mut Scene, part: f64) {
    each_point(scene, |point, lowest| swing(point, part, lowest));
}

/// Puts the lower halves of both leaflets into one plane.
fn flatten(scene: &mut Scene, plane_mm: f64) {
    each_point(scene, |point, lowest| {
        let depth = (2.0 * point.z / lowest).clamp(0.0, 1.0);
        point.y += depth * (plane_mm - point.y);
    });
}
