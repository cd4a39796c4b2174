//! The rows of the table: what is done to which presets.

use coapt::mesh::parametric::{Preset, ValveParameters};
use coapt::model::Model;
use coapt::scene::{Load, Scene};
use coapt::state::State;

use super::EDGE_MM;
use super::deeds::{
    cross, each_free, each_tissue, excess_tissue, flatten, knee, lowest_mm, make_slivers, meshes, narrow,
    swing, thickness,
};

/// What a row does to a preset: to its parameters, to its scene or to where it begins.
#[derive(Clone, Copy)]
pub(super) enum Deed {
    Parameters(fn(&mut ValveParameters)),
    Scene(fn(&mut Scene)),
    Start(fn(&Model, &mut State)),
}

/// A row: name, what is hard about it, what is done, to which valves.
pub(super) type Row = (&'static str, &'static str, Deed, &'static [Preset]);

const ALL: &[Preset] = &Preset::ALL;
const HEALTHY: &[Preset] = &[Preset::Healthy];

pub(super) const ROWS: [Row; 32] = [
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
        "20000 mmHg",
        "more than any tissue bears",
        Deed::Scene(|scene| scene.load = Load::mmhg(20_000.0)),
        HEALTHY,
    ),
    (
        "1000000 mmHg",
        "blown up within a few steps, until long edges are pressed on each other",
        Deed::Scene(|scene| scene.load = Load::mmhg(1e6)),
        HEALTHY,
    ),
    (
        "as soft beyond the knee as below",
        "springs too weak for the pressure",
        Deed::Scene(|scene| each_tissue(scene, |soft, stiff| *stiff = *soft)),
        HEALTHY,
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
        Deed::Scene(|scene| {
            scene.load = Load::mmhg(0.0);
            narrow(scene, 0.8);
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
        "leaflets 0.1 mm thick",
        "a tenth of the tissue bears all the load",
        Deed::Scene(|scene| thickness(scene, 0.1)),
        HEALTHY,
    ),
    (
        "annulus narrowed by 20 %",
        "tissue left over: wrinkles",
        Deed::Scene(|scene| narrow(scene, 0.8)),
        ALL,
    ),
    (
        "annulus narrowed by 40 %",
        "tissue left over: wrinkles",
        Deed::Scene(|scene| narrow(scene, 0.6)),
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
    (
        "open and swapped",
        "leaflets hang on the wrong side of each other",
        Deed::Scene(|scene| cross(scene, 3.0)),
        HEALTHY,
    ),
];

/// Rings that leave tissue over, on presets.
pub(super) const RINGS: [(Preset, &str); 8] = [
    (Preset::Barlow, "physio-like:28"),
    (Preset::Barlow, "physio-like:30"),
    (Preset::Barlow, "reduced-ap:40"),
    (Preset::Barlow, "posterior-band:32"),
    (Preset::Healthy, "classic-like:24"),
    (Preset::Healthy, "physio-like:27"),
    (Preset::Healthy, "saddle:35"),
    (Preset::Healthy, "reduced-ap:32"),
];
