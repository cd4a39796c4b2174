//! The membranes' laws once more, as energies of the principal stretches, written down from their sources and not from the
//! code under test; stresses from them by differences.

use coapt::energy::membrane::{Law, exponential, may_newman};

use crate::shapes::{neo_hookean, st_venant_kirchhoff};

/// Energy per unloaded volume [MPa] of tissue stretched by λ₁ along its fibres and λ₂ across.
pub(super) fn energy_mpa(law: &Law, [a, b]: [f64; 2]) -> f64 {
    match law {
        Law::StVenantKirchhoff(constants) => {
            let nu = constants.poisson_ratio;
            let [g, h] = [a, b].map(|stretch| 0.5 * (stretch * stretch - 1.0));
            0.5 * constants.modulus_mpa / (1.0 - nu * nu) * (g * g + h * h + 2.0 * nu * g * h)
        }
        Law::Exponential(constants) if constants.compressibility_per_mpa == 0.0 => {
            solid_mpa(constants, [a, b, 1.0 / (a * b)])
        }
        // As thick as costs least.
        Law::Exponential(constants) => {
            let step = 1e-6;
            let slope =
                |c: f64| solid_mpa(constants, [a, b, c + step]) - solid_mpa(constants, [a, b, c - step]);
            let thickness = super::references::root(slope, 0.1, 1.5);
            solid_mpa(constants, [a, b, thickness])
        }
        Law::MayNewman(constants) => {
            let excess = a * a + b * b + 1.0 / (a * b).powi(2) - 3.0;
            let exponent = constants.c1 * excess * excess + constants.c2 * (a - 1.0).powi(4);
            constants.c0_mpa * exponent.exp_m1()
        }
    }
}

/// w = C₀/2 (Ī₁ − 3) + C₁/2 (exp(C₂ (Ī₁ − 3)²) − 1) + (J − 1)² / D.
fn solid_mpa(constants: &exponential::Constants, stretches: [f64; 3]) -> f64 {
    let [a, b, c] = stretches;
    let j = a * b * c;
    let excess = (a * a + b * b + c * c) * j.powf(-2.0 / 3.0) - 3.0;
    let bulk = match constants.compressibility_per_mpa {
        0.0 => 0.0,
        d => (j - 1.0).powi(2) / d,
    };
    0.5 * constants.c0_mpa * excess
        + 0.5 * constants.c1_mpa * (constants.c2 * excess * excess).exp_m1()
        + bulk
}

/// Nominal stresses [MPa]: force per unloaded area, the slopes of the energy.
pub(super) fn stresses_mpa(law: &Law, [a, b]: [f64; 2]) -> [f64; 2] {
    const STEP: f64 = 1e-5;
    let slope = |ahead, behind| (energy_mpa(law, ahead) - energy_mpa(law, behind)) / (2.0 * STEP);
    [
        slope([a + STEP, b], [a - STEP, b]),
        slope([a, b + STEP], [a, b - STEP]),
    ]
}

/// One of each law; stresses of the order of 1 MPa at stretches of 1.1.
pub(super) fn one_of_each() -> [(&'static str, Law); 5] {
    let exponential = |compressibility_per_mpa: f64| {
        Law::Exponential(exponential::Constants {
            c0_mpa: 1.0,
            c1_mpa: 0.2,
            c2: 5.0,
            compressibility_per_mpa,
        })
    };
    [
        ("St. Venant-Kirchhoff", st_venant_kirchhoff(1.0, 0.45)),
        ("neo-Hookean", neo_hookean(1.0)),
        ("exponential", exponential(0.0)),
        ("exponential, compressible", exponential(0.2)),
        (
            "May-Newman",
            Law::MayNewman(may_newman::Constants {
                c0_mpa: 0.5,
                c1: 4.0,
                c2: 300.0,
            }),
        ),
    ]
}
