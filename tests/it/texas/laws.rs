//! What the valve is made of: the constants of the Abaqus input.

use coapt::energy::membrane::{Law, exponential};
use coapt::scene::{ChordLaw, SpringBranches, Tissue, Wrinkling};
use coapt::tissue_fit::{bilinear_from_curve, curve::curve_of_law};

/// D of the input [1/MPa].
pub(super) const COMPRESSIBILITY_PER_MPA: f64 = 20.066_89;
const C0_MPA: f64 = 0.001;

/// C₁ [MPa] and C₂ [1] of each leaflet.
fn constants(leaflet: &str) -> (f64, f64) {
    match leaflet {
        "anterior" => (0.000_124, 4.568_202),
        "posterior" => (0.000_188, 14.859_590),
        "septal" => (0.000_191, 17.751_490),
        other => panic!("no leaflet {other}"),
    }
}

/// Ogden's μ [MPa] and α of each group of chordae.
fn ogden(group: &str) -> [(f64, f64); 3] {
    match group {
        "anterior" => [
            (18.884_147_8, 98.253_655_1),
            (22.682_992_3, 98.251_894_4),
            (19.502_933_9, 98.253_228_7),
        ],
        "posterior" => [
            (4.241_553_98, 55.914_887_2),
            (2.724_796_15, 55.915_477_2),
            (3.726_567_4e-5, 70.715_073_2),
        ],
        "septal" => [
            (33.753_478_5, 1.531_670_654e-4),
            (1.459_628_6e-5, 3.488_130_193e-4),
            (0.020_343_017, 113.447_386_7),
        ],
        other => panic!("no chordae {other}"),
    }
}

/// Nominal stress of incompressible Ogden tissue under uniaxial stretch s: Σ 2μ/α (s^(α−1) − s^(−α/2−1)), to 3 % strain.
pub(super) fn chord_law(group: &str) -> ChordLaw {
    let strain: Vec<f64> = (0..=30).map(|point| f64::from(point) * 1e-3).collect();
    let stress = |strain: &f64| {
        let stretch = 1.0 + strain;
        let term = |(mu, alpha): (f64, f64)| {
            2.0 * mu / alpha * (stretch.powf(alpha - 1.0) - stretch.powf(-0.5 * alpha - 1.0))
        };
        ogden(group).into_iter().map(term).sum::<f64>()
    };
    ChordLaw::Table {
        stress_mpa: strain.iter().map(stress).collect(),
        strain,
    }
}

pub(super) fn tissue(leaflet: &str, compressibility_per_mpa: f64) -> Tissue {
    let (c1_mpa, c2) = constants(leaflet);
    Tissue::Exponential {
        c0_mpa: C0_MPA,
        c1_mpa,
        c2,
        compressibility_per_mpa,
        wrinkling: Wrinkling::TensionField,
        // Of the order of the tangent modulus of unloaded tissue, 3 C₀.
        bending_modulus_mpa: 0.01,
    }
}

/// Springs fitted to the same law under equibiaxial tension, up to the published 99th percentile of stress.
pub(super) fn springs(leaflet: &str) -> Tissue {
    const WORKING_STRESS_MPA: f64 = 0.152;
    let (c1_mpa, c2) = constants(leaflet);
    let law = Law::Exponential(exponential::Constants {
        c0_mpa: C0_MPA,
        c1_mpa,
        c2,
        compressibility_per_mpa: 0.0,
    });
    fitted(&law, WORKING_STRESS_MPA)
}

fn fitted(law: &Law, most_mpa: f64) -> Tissue {
    let curve = curve_of_law(law, [1.0, 1.0], most_mpa, 60);
    let fit =
        bilinear_from_curve(&curve, [0.0, most_mpa], 1.0).unwrap_or_else(|faults| panic!("{faults:#?}"));
    let SpringBranches {
        pre_transition_modulus_mpa,
        transition_strain,
        post_transition_modulus_mpa,
    } = fit.circumferential;
    Tissue::BilinearSprings {
        pre_transition_modulus_mpa,
        transition_strain,
        post_transition_modulus_mpa,
        compression_modulus_ratio: 1.0,
        // As the membranes have: 0.01 MPa.
        bending_modulus_ratio: 0.01 / pre_transition_modulus_mpa,
    }
}
