//! Membranes that follow a biaxial curve, in least squares of nominal stress.
//!
//! Both laws are isotropic: of tissue with a direction they can follow the gain of area ([`super::area_equivalent`]). Beside one
//! constant within the exponential they are linear in the rest, which are therefore exact.

use super::curve::stress_of_law_mpa;
use super::least_squares::two_factors;
use super::{BiaxialPoint, accepted, in_range, least, longest_stretch, misfit};
use crate::energy::membrane::{Law, MOST_EXPONENT, exponential, st_venant_kirchhoff};
use crate::scene::{Fault, Tissue, Wrinkling, default_bending_modulus_mpa};

/// A fitted law, and how far it is from what it was fitted to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MembraneFit<Constants> {
    /// Constants of the law.
    pub constants: Constants,
    /// Root mean square of the error of the nominal stress, both directions together [MPa].
    pub rms_error_mpa: f64,
    /// Its largest [MPa].
    pub worst_error_mpa: f64,
    /// Root mean square of the nominal stress itself [MPa].
    pub rms_stress_mpa: f64,
    /// The working range: Cauchy stress from and to [MPa].
    pub working_range_mpa: [f64; 2],
    /// Points in it.
    pub points: usize,
}

/// The St. Venant-Kirchhoff law that follows a biaxial curve best in a working range of Cauchy stress [MPa], of which the larger
/// in each state counts.
///
/// # Errors
/// As [`super::bilinear_from_curve`].
pub fn st_venant_kirchhoff_from_curve(
    points: &[BiaxialPoint],
    working_range_mpa: [f64; 2],
    poisson_ratio: f64,
) -> Result<MembraneFit<st_venant_kirchhoff::Constants>, Vec<Fault>> {
    let kept = in_range(points, working_range_mpa)?;
    let of_modulus = |modulus_mpa: f64| st_venant_kirchhoff::Constants {
        modulus_mpa,
        poisson_ratio,
    };
    let of_one = Law::StVenantKirchhoff(of_modulus(1.0));
    let ([modulus_mpa, _], _) = two_factors(&kept, |stretch| [stress_of_law_mpa(&of_one, stretch), [0.0; 2]]);
    let constants = of_modulus(modulus_mpa);
    accepted(&Tissue::StVenantKirchhoff {
        modulus_mpa,
        poisson_ratio,
        wrinkling: Wrinkling::default(),
        bending_modulus_mpa: default_bending_modulus_mpa(),
    })?;
    Ok(judged(
        constants,
        &Law::StVenantKirchhoff(constants),
        &kept,
        working_range_mpa,
    ))
}

/// The incompressible exponential law that does so.
///
/// C₂ is sought up to where the exponent at the longest stretch, both ways, is 8, beyond which the law itself is carried on as a
/// parabola; C₀ and C₁ are exact for it.
///
/// # Errors
/// As [`super::bilinear_from_curve`].
pub fn exponential_from_curve(
    points: &[BiaxialPoint],
    working_range_mpa: [f64; 2],
) -> Result<MembraneFit<exponential::Constants>, Vec<Fault>> {
    let kept = in_range(points, working_range_mpa)?;
    let longest = longest_stretch(&kept);
    let excess = 2.0 * longest.powi(2) + longest.powi(-4) - 3.0;
    let moduli = |c2: f64| {
        let stress = |moduli, stretch| stress_of_law_mpa(&Law::Exponential(of(moduli, c2)), stretch);
        two_factors(&kept, |stretch| {
            [stress([1.0, 0.0], stretch), stress([0.0, 1.0], stretch)]
        })
    };
    let c2 = least(MOST_EXPONENT / excess.powi(2), |c2| moduli(c2).1);
    let constants = of(moduli(c2).0, c2);
    accepted(&Tissue::Exponential {
        c0_mpa: constants.c0_mpa,
        c1_mpa: constants.c1_mpa,
        c2,
        compressibility_per_mpa: constants.compressibility_per_mpa,
        wrinkling: Wrinkling::default(),
        bending_modulus_mpa: default_bending_modulus_mpa(),
    })?;
    Ok(judged(
        constants,
        &Law::Exponential(constants),
        &kept,
        working_range_mpa,
    ))
}

fn of([c0_mpa, c1_mpa]: [f64; 2], c2: f64) -> exponential::Constants {
    exponential::Constants {
        c0_mpa,
        c1_mpa,
        c2,
        compressibility_per_mpa: 0.0,
    }
}

fn judged<Constants>(
    constants: Constants,
    law: &Law,
    points: &[BiaxialPoint],
    working_range_mpa: [f64; 2],
) -> MembraneFit<Constants> {
    let misfit = misfit(points, |stretch| stress_of_law_mpa(law, stretch));
    MembraneFit {
        constants,
        rms_error_mpa: misfit.rms_error_mpa,
        worst_error_mpa: misfit.worst_error_mpa,
        rms_stress_mpa: misfit.rms_stress_mpa,
        working_range_mpa,
        points: points.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::curve::curve_of_law;
    use super::*;

    /// A law fitted to its own curve is that law: a minimum is as sharp as the square root of rounding, 1e-6.
    #[test]
    fn laws_are_found_again() {
        let due = of([0.001, 0.000_124], 4.568_202);
        let curve = curve_of_law(&Law::Exponential(due), [1.0; 2], 0.1, 60);
        let found = exponential_from_curve(&curve, [0.0, 0.1]).unwrap().constants;
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-6;
        assert!(
            near(found.c0_mpa, due.c0_mpa) && near(found.c1_mpa, due.c1_mpa) && near(found.c2, due.c2),
            "{found:?}"
        );
        let due = st_venant_kirchhoff::Constants {
            modulus_mpa: 0.4,
            poisson_ratio: 0.45,
        };
        let curve = curve_of_law(&Law::StVenantKirchhoff(due), [1.0; 2], 0.1, 60);
        let fit = st_venant_kirchhoff_from_curve(&curve, [0.0, 0.1], 0.45).unwrap();
        assert!(near(fit.constants.modulus_mpa, 0.4), "{fit:?}");
        assert!(fit.worst_error_mpa < 1e-9, "{fit:?}");
    }
}
