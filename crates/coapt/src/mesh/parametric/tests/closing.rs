//! What the presets must do once closed, at the size of paper 003.

use super::*;
use crate::measure::{Measures, measure};
use crate::model::Model;
use crate::relax::{Equilibrium, relax};
use crate::state::State;

fn closed(parameters: &ValveParameters) -> (Equilibrium, Measures) {
    let scene = generate(parameters).expect("a preset makes a valve");
    let built = Model::build(&scene).expect("a preset makes a model");
    assert_eq!(built.warnings, []);
    let equilibrium = relax(&built.model, &State::open(&built.model));
    let measures = measure(
        &built.model,
        &equilibrium.state.positions_mm,
        &equilibrium.reactions_n,
    );
    assert!(equilibrium.certificate.stable && equilibrium.certificate.crossings.is_empty());
    (equilibrium, measures)
}

/// No orifice from any start. A normal mitral valve besides: papillary forces of 4 to 10 N, no chord beyond 2 N
/// (marginal chordae fail at 3 to 8 N), contact 3 to 8 mm high, tenting of about 1 mL and less billow than that.
#[test]
fn the_healthy_valve_closes_from_every_start() {
    for jitter_seed in 0..3 {
        let jitter_mm = if jitter_seed == 0 { 0.0 } else { 0.1 };
        let (_, m) = closed(&ValveParameters {
            jitter_mm,
            jitter_seed,
            ..Default::default()
        });
        assert_eq!((m.orifice.area_mm2, m.orifice.count), (0.0, 0), "{jitter_seed}");
        assert!(
            (3.0..8.0).contains(&m.coaptation.length_mean_mm),
            "{:?}",
            m.coaptation
        );
        assert!((0.7..3.0).contains(&m.tenting.volume_ml), "{:?}", m.tenting);
        assert!(m.billow.volume_ml < 0.7, "{:?}", m.billow);
        assert!(m.chords.max_force_n < 2.0, "{:?}", m.chords);
        for muscle in &m.papillary {
            assert!(
                (4.0..10.0).contains(&Vec3::from(muscle.force_n).norm()),
                "{muscle:?}"
            );
        }
    }
}

/// Orifices as severe as named in the recipes, to within the change from mesh to mesh (a factor of 1.5).
#[test]
fn sick_valves_leak_or_billow() {
    let closed = |preset| closed(&ValveParameters::preset(preset)).1;
    let dilated = closed(Preset::Dilated);
    assert!(
        (15.0..60.0).contains(&dilated.orifice.area_mm2),
        "{:?}",
        dilated.orifice
    );
    assert!(
        (3.5..7.0).contains(&dilated.tenting.volume_ml),
        "{:?}",
        dilated.tenting
    );
    let restricted = closed(Preset::Restricted);
    assert!(
        (15.0..60.0).contains(&restricted.orifice.area_mm2),
        "{:?}",
        restricted.orifice
    );
    assert!(restricted.billow.volume_ml < 0.1, "{:?}", restricted.billow);
    let barlow = closed(Preset::Barlow);
    assert!(
        (3.0..10.0).contains(&barlow.billow.volume_ml),
        "{:?}",
        barlow.billow
    );
    // The ruptured part of the margin stands above the annular plane, by more than the published 2 mm of prolapse.
    let flail = closed(Preset::Flail);
    assert!(flail.billow.height_mm > 2.0, "{:?}", flail.billow);
}
