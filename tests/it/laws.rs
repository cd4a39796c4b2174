//! A whole valve of each tissue law: closed, certified, in balance.

use coapt::Vec3;
use coapt::energy::membrane::may_newman;
use coapt::mesh::parametric::{Preset, ValveParameters, generate};
use coapt::model::Model;
use coapt::scene::{SpringBranches, Tissue, Wrinkling};
use coapt_tests::close;

/// Bending as the springs have it by default [MPa].
const BENDING_MPA: f64 = 0.48;

/// Every law with constants of the literature; of springs with a direction, our choice from measured ranges.
fn tissues(wrinkling: Wrinkling) -> Vec<Tissue> {
    let branches = |soft: f64, knee: f64, stiff: f64| SpringBranches {
        pre_transition_modulus_mpa: soft,
        transition_strain: knee,
        post_transition_modulus_mpa: stiff,
    };
    let exponential = |compressibility_per_mpa: f64| Tissue::Exponential {
        c0_mpa: 0.001,
        c1_mpa: 0.000_124,
        c2: 4.568_202,
        compressibility_per_mpa,
        wrinkling,
        bending_modulus_mpa: BENDING_MPA,
    };
    vec![
        Tissue::AnisotropicSprings {
            circumferential: branches(0.09, 0.10, 6.2),
            radial: branches(0.06, 0.40, 2.35),
            compression_modulus_ratio: 1.0,
            bending_modulus_mpa: BENDING_MPA,
        },
        Tissue::StVenantKirchhoff {
            modulus_mpa: 0.4,
            poisson_ratio: 0.5,
            wrinkling,
            bending_modulus_mpa: BENDING_MPA,
        },
        exponential(0.0),
        exponential(1.0),
        Tissue::MayNewman {
            c0_mpa: may_newman::ANTERIOR.c0_mpa,
            c1: may_newman::ANTERIOR.c1,
            c2: may_newman::ANTERIOR.c2,
            wrinkling,
            bending_modulus_mpa: BENDING_MPA,
        },
    ]
}

fn healthy(tissues: [Tissue; 2]) -> Model {
    let mut scene = generate(&ValveParameters::preset(Preset::Healthy)).expect("presets are right");
    for (leaflet, tissue) in scene.leaflets.iter_mut().zip(tissues) {
        leaflet.tissue = tissue;
    }
    Model::build(&scene).expect("presets build").model
}

/// As for springs: the supports bear what the pressure exerts, to 1e-6 of the nodal pressure forces together.
fn assert_closes(model: &Model, what: &str) {
    let closed = close(model);
    assert!(
        closed.certificate.is_certified(closed.status),
        "{what}: {:?}",
        closed.certificate
    );
    let positions = &closed.state.positions_mm;
    let areas = model.faces.iter().map(|face| {
        let [a, b, c] = face.map(|vertex| positions[vertex as usize]);
        (b - a).cross(&(c - a)) / 2.0
    });
    let pressure: Vec3 = areas.clone().sum::<Vec3>() * model.pressure_mpa;
    let scale = areas.map(|area| area.norm()).sum::<f64>() * model.pressure_mpa;
    let supports: Vec3 = closed.reactions_n.iter().sum();
    assert!(
        (supports - pressure).norm() < 1e-6 * scale,
        "{what}: {supports} {pressure}"
    );
}

#[test]
fn a_valve_of_every_law_is_certified_and_in_balance() {
    for wrinkling in [Wrinkling::Resolved, Wrinkling::TensionField] {
        for tissue in tissues(wrinkling) {
            assert_closes(&healthy([tissue; 2]), &format!("{tissue:?}"));
        }
    }
}

/// Springs on one leaflet, a membrane on the other: they share the edges between them.
#[test]
fn leaflets_of_different_laws_meet() {
    for tissue in tissues(Wrinkling::Resolved) {
        let model = healthy([Tissue::default(), tissue]);
        let springs_and_triangles = (model.springs.ends.len(), model.membranes.corners.len());
        assert!(springs_and_triangles.0 > 0, "{springs_and_triangles:?}");
        assert_closes(&model, &format!("springs and {tissue:?}"));
    }
}
