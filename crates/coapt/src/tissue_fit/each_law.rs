//! One tissue told in every law, so that laws can be compared by what they do to a valve and by what they cost.
//!
//! The tissue is May-Newman's: it has fibres, it stiffens exponentially, and its constants are measured. Every other law is
//! fitted to its biaxial curve up to [`MOST_STRESS_MPA`]. Isotropic laws follow the gain of area
//! ([`super::area_equivalent`]) under equal stresses; springs with a direction follow both directions under three proportions
//! of stress ([`STRESS_RATIOS`]). All bend alike, with the modulus that scenes have by default.

use super::curve::{STRESS_RATIOS, curve_of_law};
use super::membranes::{exponential_from_curve, st_venant_kirchhoff_from_curve};
use super::{BiaxialPoint, anisotropic_from_curve, area_equivalent, bilinear_from_curve};
use crate::energy::membrane::{Law, may_newman};
use crate::scene::{
    Fault, Tissue, Wrinkling, default_bending_modulus_mpa, default_compression_modulus_ratio,
    default_poisson_ratio,
};

/// Largest Cauchy stress of the curve that is followed [MPa]: closed leaflets work at 50 to 150 kPa.
pub const MOST_STRESS_MPA: f64 = 0.1;

/// A tissue in one law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// The law with its constants.
    pub tissue: Tissue,
    /// Root mean square of its error over that of the nominal stress, of the curve that it was fitted to [1]; of area for
    /// isotropic laws.
    pub relative_error: f64,
}

/// A May-Newman tissue in every law, membranes with both ways to wrinkle; itself first.
///
/// # Errors
/// As [`bilinear_from_curve`]: a law so soft that it reaches the stress at no stretch of a leaflet.
pub fn in_each_law(constants: &may_newman::Constants) -> Result<Vec<Told>, Vec<Fault>> {
    let law = Law::MayNewman(*constants);
    let curve = |ratio| curve_of_law(&law, ratio, MOST_STRESS_MPA, POINTS);
    let area = area_equivalent(&curve([1.0; 2]));
    let both: Vec<BiaxialPoint> = STRESS_RATIOS.into_iter().flat_map(curve).collect();
    let mut all = wrinkled(|wrinkling| Told {
        tissue: itself(constants, wrinkling),
        relative_error: 0.0,
    });
    all.push(isotropic_springs(&area)?);
    all.push(springs_with_a_direction(&both)?);
    all.extend(st_venant_kirchhoff(&area)?);
    all.extend(exponential(&area)?);
    Ok(all)
}

/// Points of each curve, as many as the tests of the fits have.
const POINTS: usize = 60;
const RANGE_MPA: [f64; 2] = [0.0, MOST_STRESS_MPA];

fn wrinkled(told: impl Fn(Wrinkling) -> Told) -> Vec<Told> {
    [Wrinkling::Resolved, Wrinkling::TensionField].map(told).to_vec()
}

fn itself(constants: &may_newman::Constants, wrinkling: Wrinkling) -> Tissue {
    Tissue::MayNewman {
        c0_mpa: constants.c0_mpa,
        c1: constants.c1,
        c2: constants.c2,
        wrinkling,
        bending_modulus_mpa: default_bending_modulus_mpa(),
    }
}

fn isotropic_springs(area: &[BiaxialPoint]) -> Result<Told, Vec<Fault>> {
    let fit = bilinear_from_curve(area, RANGE_MPA, default_compression_modulus_ratio())?;
    let branches = fit.circumferential;
    Ok(Told {
        tissue: Tissue::BilinearSprings {
            pre_transition_modulus_mpa: branches.pre_transition_modulus_mpa,
            transition_strain: branches.transition_strain,
            post_transition_modulus_mpa: branches.post_transition_modulus_mpa,
            compression_modulus_ratio: default_compression_modulus_ratio(),
            bending_modulus_ratio: default_bending_modulus_mpa() / branches.pre_transition_modulus_mpa,
        },
        relative_error: fit.rms_error_mpa / fit.rms_stress_mpa,
    })
}

fn springs_with_a_direction(both: &[BiaxialPoint]) -> Result<Told, Vec<Fault>> {
    let fit = anisotropic_from_curve(both, RANGE_MPA, default_compression_modulus_ratio())?;
    Ok(Told {
        tissue: Tissue::AnisotropicSprings {
            circumferential: fit.circumferential,
            radial: fit.radial,
            compression_modulus_ratio: default_compression_modulus_ratio(),
            bending_modulus_mpa: default_bending_modulus_mpa(),
        },
        relative_error: fit.rms_error_mpa / fit.rms_stress_mpa,
    })
}

fn st_venant_kirchhoff(area: &[BiaxialPoint]) -> Result<Vec<Told>, Vec<Fault>> {
    let fit = st_venant_kirchhoff_from_curve(area, RANGE_MPA, default_poisson_ratio())?;
    Ok(wrinkled(|wrinkling| Told {
        tissue: Tissue::StVenantKirchhoff {
            modulus_mpa: fit.constants.modulus_mpa,
            poisson_ratio: fit.constants.poisson_ratio,
            wrinkling,
            bending_modulus_mpa: default_bending_modulus_mpa(),
        },
        relative_error: fit.rms_error_mpa / fit.rms_stress_mpa,
    }))
}

fn exponential(area: &[BiaxialPoint]) -> Result<Vec<Told>, Vec<Fault>> {
    let fit = exponential_from_curve(area, RANGE_MPA)?;
    Ok(wrinkled(|wrinkling| Told {
        tissue: Tissue::Exponential {
            c0_mpa: fit.constants.c0_mpa,
            c1_mpa: fit.constants.c1_mpa,
            c2: fit.constants.c2,
            compressibility_per_mpa: fit.constants.compressibility_per_mpa,
            wrinkling,
            bending_modulus_mpa: default_bending_modulus_mpa(),
        },
        relative_error: fit.rms_error_mpa / fit.rms_stress_mpa,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How near each law comes to the anterior and the posterior leaflet, as we measured it: St. Venant and Kirchhoff's line
    /// follows no exponential, the exponential of I₁ nearly is one, springs lie between. The tissue itself comes first.
    #[test]
    fn the_tissue_is_told_in_each_law() {
        let leaflets = [
            ([0.399e-3, 4.325, 1446.5], [0.0, 0.0, 0.078, 0.128, 0.385, 0.385]),
            ([0.414e-3, 4.848, 305.4], [0.0, 0.0, 0.078, 0.148, 0.382, 0.382]),
        ];
        for ([c0_mpa, c1, c2], due) in leaflets {
            let told = in_each_law(&may_newman::Constants { c0_mpa, c1, c2 }).unwrap();
            assert_eq!(told.len(), 8);
            for (told, due) in told.iter().zip(due) {
                assert!((told.relative_error - due).abs() < 0.002, "{told:?}");
            }
            for told in &told[6..] {
                assert!(told.relative_error < 1e-3, "{told:?}");
            }
        }
    }
}
