//! Springs that follow measured tissue: from a biaxial test, or from another law, to the moduli and the transition strain
//! of the bilinear springs.
//!
//! The springs of a triangle mesh are not the tissue: what the tissue bears in a direction, springs of all directions bear
//! together, and moduli must not simply be copied ([`lattice`]). Points within a working range of stress are followed in
//! least squares of the nominal stress. For a given transition strain the stress of isotropic springs is linear in their two
//! moduli, which are therefore exact; the transition strain is scanned and then bracketed. Springs with a direction have six
//! constants, and Levenberg-Marquardt starts from several transition strains. [`membranes`] follow a curve likewise;
//! [`each_law`] tells one tissue in all laws, so that laws can be compared.

pub mod curve;
pub mod each_law;
pub mod lattice;
mod least_squares;
pub mod membranes;

use serde::Serialize;

use crate::model::tissue_faults;
use crate::scene::{Fault, Readable, SpringBranches, Tissue, default_bending_modulus_mpa};
use lattice::nominal_stress_mpa;
use least_squares::{descend, two_moduli_that_stiffen};

/// One state of a biaxial test, along and across the fibres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BiaxialPoint {
    /// Length over unloaded length, circumferential and radial [1].
    pub stretch: [f64; 2],
    /// Force per unloaded section, circumferential and radial [MPa].
    pub nominal_stress_mpa: [f64; 2],
}

impl BiaxialPoint {
    /// From force per current section; volume does not change: P₁ = σ₁ / λ₁.
    pub fn from_cauchy_stress(stretch: [f64; 2], stress_mpa: [f64; 2]) -> Self {
        Self {
            stretch,
            nominal_stress_mpa: [0, 1].map(|axis| stress_mpa[axis] / stretch[axis]),
        }
    }

    /// From force per current length of cut: P₁ = N₁ λ₂ / t.
    pub fn from_tension(stretch: [f64; 2], tension_n_per_mm: [f64; 2], thickness_mm: f64) -> Self {
        Self {
            stretch,
            nominal_stress_mpa: [0, 1].map(|axis| tension_n_per_mm[axis] * stretch[1 - axis] / thickness_mm),
        }
    }

    /// The larger of the two forces per current section [MPa].
    pub fn cauchy_stress_mpa(&self) -> f64 {
        let along = |axis: usize| self.nominal_stress_mpa[axis] * self.stretch[axis];
        along(0).max(along(1))
    }
}

/// Fitted springs, and how far they are from what they were fitted to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BilinearFit {
    /// Springs along the annulus.
    pub circumferential: SpringBranches,
    /// Springs from the annulus to the margin; the same for isotropic springs.
    pub radial: SpringBranches,
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

/// Fewest points in the working range: three constants and something to test them by, in both directions (our choice).
pub const FEWEST_POINTS: usize = 6;

/// The curve of isotropic tissue that gains as much area at the same Cauchy stress, the mean of both directions: √(λ₁ λ₂) both
/// ways. Under equal stresses as much work goes into it as into the tissue. It is what isotropic springs can follow of tissue
/// with a direction: paper 003's single transition strain of 0.25 is about that of the anterior leaflet, which stretches to
/// 1.12 and 1.44.
pub fn area_equivalent(points: &[BiaxialPoint]) -> Vec<BiaxialPoint> {
    let of = |point: &BiaxialPoint| {
        let stress = |axis: usize| point.nominal_stress_mpa[axis] * point.stretch[axis];
        let stretch = (point.stretch[0] * point.stretch[1]).sqrt();
        BiaxialPoint::from_cauchy_stress([stretch; 2], [0.5 * (stress(0) + stress(1)); 2])
    };
    points.iter().map(of).collect()
}

/// The isotropic springs (`bilinear-springs`) that follow a biaxial curve best in a working range of Cauchy stress [MPa], of
/// which the larger in each state counts. `compression_modulus_ratio` is that of the scene [1].
///
/// # Errors
/// Points that are not finite or not positive stretches, too few in the range, a range that is none; constants that no model
/// takes, such as no stiffness at all below the transition.
pub fn bilinear_from_curve(
    points: &[BiaxialPoint],
    working_range_mpa: [f64; 2],
    compression_modulus_ratio: f64,
) -> Result<BilinearFit, Vec<Fault>> {
    let kept = in_range(points, working_range_mpa)?;
    let error = |knee: f64| two_moduli_that_stiffen(&kept, knee, compression_modulus_ratio).1;
    let knee = least_knee(&kept, error);
    let ([soft, stiff], _) = two_moduli_that_stiffen(&kept, knee, compression_modulus_ratio);
    let branches = SpringBranches {
        pre_transition_modulus_mpa: soft,
        transition_strain: knee,
        post_transition_modulus_mpa: stiff,
    };
    accepted(&Tissue::BilinearSprings {
        pre_transition_modulus_mpa: soft,
        transition_strain: knee,
        post_transition_modulus_mpa: stiff,
        compression_modulus_ratio,
        bending_modulus_ratio: 0.0,
    })?;
    Ok(judged(
        [branches; 2],
        &kept,
        working_range_mpa,
        compression_modulus_ratio,
    ))
}

/// The springs with a direction (`anisotropic-springs`) that do so.
///
/// # Errors
/// As [`bilinear_from_curve`].
pub fn anisotropic_from_curve(
    points: &[BiaxialPoint],
    working_range_mpa: [f64; 2],
    compression_modulus_ratio: f64,
) -> Result<BilinearFit, Vec<Fault>> {
    let kept = in_range(points, working_range_mpa)?;
    let branches = descend(&kept, compression_modulus_ratio);
    accepted(&Tissue::AnisotropicSprings {
        circumferential: branches[0],
        radial: branches[1],
        compression_modulus_ratio,
        bending_modulus_mpa: default_bending_modulus_mpa(),
    })?;
    Ok(judged(
        branches,
        &kept,
        working_range_mpa,
        compression_modulus_ratio,
    ))
}

/// Constants that a model would refuse are no result; the faults are the model's, and say what it expects.
fn accepted(tissue: &Tissue) -> Result<(), Vec<Fault>> {
    let mut faults = tissue_faults(tissue, "fit");
    for fault in &mut faults {
        fault.message += "; no such law follows this curve in this working range";
    }
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

fn in_range(points: &[BiaxialPoint], range_mpa: [f64; 2]) -> Result<Vec<BiaxialPoint>, Vec<Fault>> {
    let mut faults = Vec::new();
    let [least, most] = range_mpa;
    // A comparison alone lets NaN pass.
    if !(least >= 0.0 && least < most && most.is_finite()) {
        let message = format!(
            "is {} to {} MPa, expected an ascending range from 0 MPa or more",
            Readable(least),
            Readable(most)
        );
        faults.push(Fault::error("working range", message));
    }
    for (number, point) in points.iter().enumerate() {
        let stretched = point
            .stretch
            .iter()
            .all(|&stretch| (0.1..=10.0).contains(&stretch));
        if !stretched || !point.nominal_stress_mpa.iter().all(|stress| stress.is_finite()) {
            let message = format!(
                "has stretches {:?} and nominal stresses {:?} MPa, expected stretches of 0.1 to 10 and finite stresses",
                point.stretch, point.nominal_stress_mpa
            );
            faults.push(Fault::error(format!("point {number}"), message));
        }
    }
    // A hair more, for a curve that was sampled up to the end of the range.
    let within = |point: &&BiaxialPoint| (least..=most * (1.0 + 1e-9)).contains(&point.cauchy_stress_mpa());
    let kept: Vec<BiaxialPoint> = points.iter().filter(within).copied().collect();
    let longest = kept.iter().flat_map(|point| point.stretch).fold(0.0, f64::max);
    if faults.is_empty() && (kept.len() < FEWEST_POINTS || longest <= 1.0) {
        let message = format!(
            "{} to {} MPa holds {} points of the curve, stretched to {longest}; expected {FEWEST_POINTS} at least, \
             stretched beyond 1",
            Readable(least),
            Readable(most),
            kept.len()
        );
        faults.push(Fault::error("working range", message));
    }
    if faults.is_empty() { Ok(kept) } else { Err(faults) }
}

/// Transition strains that are tried before the best is bracketed: a bilinear curve through points has its kinks of error at
/// the points, of which there are about as many.
const SCANNED: u32 = 60;

/// The transition strain of least error.
fn least_knee(points: &[BiaxialPoint], error: impl Fn(f64) -> f64) -> f64 {
    least(longest_stretch(points) - 1.0, error)
}

fn longest_stretch(points: &[BiaxialPoint]) -> f64 {
    points.iter().flat_map(|point| point.stretch).fold(1.0, f64::max)
}

/// Where between zero and an end an error is least, to 1e-10 of the end: golden section about the best of a scan.
fn least(end: f64, error: impl Fn(f64) -> f64) -> f64 {
    let place = |k: u32| end * f64::from(k) / f64::from(SCANNED);
    let scanned = (1..SCANNED).min_by(|&a, &b| error(place(a)).total_cmp(&error(place(b))));
    let best = scanned.unwrap_or(1);
    let (mut low, mut high) = (place(best - 1), place(best + 1));
    let golden = 0.5 * (5_f64.sqrt() - 1.0);
    while high - low > 1e-10 * end {
        let (left, right) = (high - golden * (high - low), low + golden * (high - low));
        if error(left) < error(right) {
            high = right
        } else {
            low = left
        }
    }
    0.5 * (low + high)
}

fn judged(
    branches: [SpringBranches; 2],
    points: &[BiaxialPoint],
    working_range_mpa: [f64; 2],
    compression_modulus_ratio: f64,
) -> BilinearFit {
    let misfit = misfit(points, |stretch| {
        nominal_stress_mpa(&branches, compression_modulus_ratio, stretch)
    });
    BilinearFit {
        circumferential: branches[0],
        radial: branches[1],
        rms_error_mpa: misfit.rms_error_mpa,
        worst_error_mpa: misfit.worst_error_mpa,
        rms_stress_mpa: misfit.rms_stress_mpa,
        working_range_mpa,
        points: points.len(),
    }
}

/// How far nominal stresses are from those of a curve.
struct Misfit {
    rms_error_mpa: f64,
    worst_error_mpa: f64,
    rms_stress_mpa: f64,
}

fn misfit(points: &[BiaxialPoint], stress_mpa: impl Fn([f64; 2]) -> [f64; 2]) -> Misfit {
    let error = |point: &BiaxialPoint| {
        let found = stress_mpa(point.stretch);
        [0, 1].map(|axis| found[axis] - point.nominal_stress_mpa[axis])
    };
    let errors: Vec<f64> = points.iter().flat_map(error).collect();
    let mean_square = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v * v, count + 1.0));
        (sum / count).sqrt()
    };
    Misfit {
        rms_error_mpa: mean_square(&mut errors.iter().copied()),
        worst_error_mpa: errors.iter().fold(0.0, |worst, error| error.abs().max(worst)),
        rms_stress_mpa: mean_square(&mut points.iter().flat_map(|point| point.nominal_stress_mpa)),
    }
}

#[cfg(test)]
mod tests;
