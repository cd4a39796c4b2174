//! Stress-strain laws of chordae in tension. Slack chordae carry nothing, whatever the law.

use crate::scene::ChordLaw;

/// Chordae tear at exponents of about 10; a solver on its way strays farther, to where e^x is infinite.
const MOST_EXPONENT: f64 = 15.0;

/// What a law answers to a strain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChordResponse {
    /// Energy per unloaded volume ∫σ dε [MPa].
    pub energy_mpa: f64,
    /// Stress σ [MPa].
    pub stress_mpa: f64,
    /// Tangent modulus dσ/dε [MPa].
    pub modulus_mpa: f64,
}

/// Energy, stress and tangent at a strain ε = l / L − 1; all zero where slack.
pub fn response(law: &ChordLaw, strain: f64) -> ChordResponse {
    if strain <= 0.0 {
        return ChordResponse::default();
    }
    match law {
        ChordLaw::Linear { modulus_mpa } => line(*modulus_mpa, 0.0, strain),
        ChordLaw::PiecewiseLinear {
            toe_modulus_mpa,
            transition_strain,
            modulus_mpa,
        } => {
            let toe = line(*toe_modulus_mpa, 0.0, strain.min(*transition_strain));
            continued(toe, *modulus_mpa, strain - transition_strain)
        }
        ChordLaw::Exponential { scale_mpa, exponent } => exponential(*scale_mpa, *exponent, strain),
        ChordLaw::Collagen {
            scale_mpa,
            exponent,
            full_recruitment_strain,
            modulus_mpa,
        } => {
            let curved = exponential(*scale_mpa, *exponent, strain.min(*full_recruitment_strain));
            continued(curved, *modulus_mpa, strain - full_recruitment_strain)
        }
        ChordLaw::Table {
            strain: knots,
            stress_mpa,
        } => table(knots, stress_mpa, strain),
    }
}

/// A law that goes on along a straight line where it has been passed by some strain.
fn continued(before: ChordResponse, modulus_mpa: f64, beyond: f64) -> ChordResponse {
    if beyond <= 0.0 {
        return before;
    }
    let straight = line(modulus_mpa, before.stress_mpa, beyond);
    ChordResponse {
        energy_mpa: before.energy_mpa + straight.energy_mpa,
        ..straight
    }
}

/// A straight law that begins at a stress.
fn line(modulus_mpa: f64, from_mpa: f64, strain: f64) -> ChordResponse {
    ChordResponse {
        energy_mpa: (from_mpa + 0.5 * modulus_mpa * strain) * strain,
        stress_mpa: from_mpa + modulus_mpa * strain,
        modulus_mpa,
    }
}

/// σ = a (e^{bε} − 1), and on along its tangent from where the exponent is [`MOST_EXPONENT`].
fn exponential(scale_mpa: f64, exponent: f64, strain: f64) -> ChordResponse {
    let most = MOST_EXPONENT / exponent;
    let curved = strain.min(most);
    let excess = (exponent * curved).exp_m1();
    let modulus_mpa = scale_mpa * exponent * (excess + 1.0);
    let response = ChordResponse {
        energy_mpa: scale_mpa * (excess / exponent - curved),
        stress_mpa: scale_mpa * excess,
        modulus_mpa,
    };
    continued(response, modulus_mpa, strain - most)
}

fn table(knots: &[f64], stress_mpa: &[f64], strain: f64) -> ChordResponse {
    let mut passed = ChordResponse::default();
    for (knot, stress) in knots.windows(2).zip(stress_mpa.windows(2)) {
        let modulus_mpa = (stress[1] - stress[0]) / (knot[1] - knot[0]);
        if strain <= knot[1] {
            return continued(passed, modulus_mpa, strain - knot[0]);
        }
        passed = continued(passed, modulus_mpa, knot[1] - knot[0]);
    }
    let last = knots.last().copied().unwrap_or_default();
    continued(passed, passed.modulus_mpa, strain - last)
}
