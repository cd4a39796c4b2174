//! How the distances depend on the factors, from all closures nearby.
//!
//! Leaflets slip on each other when a factor changes by a hundredth, mostly where they are hidden, and come to rest some
//! tenths of a millimetre aside. A difference of two closures takes that for a sensitivity; a plane through many averages it.

use nalgebra::{DMatrix, DVector};

use super::FitSettings;
use super::closures::{Closed, Closures};
use super::misfit::{cost_mm2, scatter_mm, weight};
use super::parameters::Parameters;

/// Standard deviations of a Gaussian to either side that hold 95 %.
const STANDARD_DEVIATIONS_95: f64 = 1.96;

/// Closures within so many radii of the centre count [1]: those around the last centre, half a radius aside, still do.
const REACH: f64 = 1.5;

/// An affine model of the distances: r(p) = r₀ + J (p − p₀).
pub(super) struct Regression {
    /// r₀ [mm], shape `[point]`.
    at_centre_mm: DVector<f64>,
    /// J [mm], shape `[point, parameter]`.
    slopes_mm: DMatrix<f64>,
    /// Each column of J from factors below, and from factors above the centre alone.
    one_sided_mm: [DMatrix<f64>; 2],
    /// Standard deviation of the distances [mm].
    scatter_mm: f64,
}

/// The offsets of a closure's parameters from the centre, in radii [1], and its distances [mm].
type Nearby<'a> = (Vec<f64>, &'a [f64]);

/// The plane of least squares through the closures around one; nothing where a parameter was not moved by any.
pub(super) fn regress(
    closures: &Closures,
    here: &Closed,
    parameters: &Parameters,
    radius: f64,
) -> Option<Regression> {
    let mut near: Vec<Nearby> = Vec::new();
    for closed in &closures.converged {
        let offsets = parameters.offsets(&here.scale, &closed.scale);
        let within = |offsets: &Vec<f64>| offsets.iter().all(|offset| offset.abs() <= REACH * radius);
        if let Some(offsets) = offsets.filter(within) {
            let in_radii = offsets.iter().map(|offset| offset / radius).collect();
            near.push((in_radii, &closed.misfit.distance_mm));
        }
    }
    let plane = plane(&near)?;
    let sided = |sign: f64| {
        let column = |parameter: usize| {
            let there = near
                .iter()
                .filter(|(offsets, _)| sign * offsets[parameter] >= 0.0)
                .cloned();
            let of_side = self::plane(&there.collect::<Vec<_>>());
            // At an end of the range there is one side only.
            let found = of_side.as_ref().unwrap_or(&plane);
            found.row(parameter + 1).transpose() / radius
        };
        DMatrix::from_columns(&(0..parameters.count).map(column).collect::<Vec<_>>())
    };
    Some(Regression {
        at_centre_mm: plane.row(0).transpose(),
        slopes_mm: plane.rows(1, parameters.count).transpose() / radius,
        one_sided_mm: [-1.0, 1.0].map(sided),
        scatter_mm: scatter_mm(&here.misfit.distance_mm),
    })
}

/// Value at the centre and slopes of every distance, shape `[1 + parameter, point]`, from offsets and distances of closures.
fn plane(closures: &[Nearby]) -> Option<DMatrix<f64>> {
    let (offsets, distances) = closures.first()?;
    let design = DMatrix::from_fn(closures.len(), offsets.len() + 1, |row, column| match column {
        0 => 1.0,
        _ => closures[row].0[column - 1],
    });
    let values = DMatrix::from_fn(closures.len(), distances.len(), |row, point| {
        closures[row].1[point]
    });
    let normal = design.tr_mul(&design);
    // Offsets are about one: a parameter that nobody moved leaves a pivot of rounding.
    let factor = normal.cholesky()?;
    let regular = factor.l_dirty().diagonal().iter().all(|pivot| *pivot > 1e-6);
    regular.then(|| factor.solve(&design.tr_mul(&values)))
}

impl Regression {
    /// What is minimised, for one closure [mm²].
    pub(super) fn cost_mm2(&self, closed: &Closed) -> f64 {
        cost_mm2(&closed.misfit.distance_mm, self.scatter_mm)
    }

    /// `JᵀWJ + h I` and `JᵀWr`. A parameter that nothing decides is held where it is as if by one measurement with the width of
    /// its range for a standard deviation: h. One that the points decide to a percent moves by a ten-thousandth less.
    fn equations(&self, slopes: &DMatrix<f64>, settings: &FitSettings) -> (DMatrix<f64>, DVector<f64>) {
        let mut weighted = slopes.clone();
        for (mut row, &distance) in weighted.row_iter_mut().zip(&self.at_centre_mm) {
            row *= weight(distance, self.scatter_mm);
        }
        let width = settings.scale_range[1] - settings.scale_range[0];
        let held =
            DMatrix::from_diagonal_element(slopes.ncols(), slopes.ncols(), (self.scatter_mm / width).powi(2));
        (
            weighted.tr_mul(slopes) + held,
            weighted.tr_mul(&self.at_centre_mm),
        )
    }

    /// A part of the way to the factors of least squares, which are none farther than a longest step from the centre.
    pub(super) fn step(
        &self,
        here: &Closed,
        parameters: &Parameters,
        longest: f64,
        part: f64,
        settings: &FitSettings,
    ) -> Vec<f64> {
        let (matrix, vector) = self.equations(&self.slopes_mm, settings);
        let step = matrix.cholesky().map(|factor| -factor.solve(&vector));
        let step = step.unwrap_or_else(|| DVector::zeros(parameters.count));
        let size = step.amax();
        let step = if size > longest {
            step * (longest / size)
        } else {
            step
        } * part;
        parameters.moved(&here.scale, step.as_slice(), settings.scale_range)
    }

    /// How far each parameter may go down and up before the misfit rises by more than scatter explains, with 95 %
    /// probability, the other parameters being free. With scatter σ the covariance is σ² (JᵀWJ)⁻¹; each side has its own
    /// slopes, for chordae may be slack to one side.
    pub(super) fn reaches(&self, settings: &FitSettings) -> [Vec<f64>; 2] {
        self.one_sided_mm.each_ref().map(|slopes| {
            let inverse = self
                .equations(slopes, settings)
                .0
                .cholesky()
                .map(|factor| factor.inverse());
            let deviation = |k: usize| {
                let variance = inverse.as_ref().map_or(f64::INFINITY, |inverse| inverse[(k, k)]);
                self.scatter_mm * variance.sqrt()
            };
            (0..slopes.ncols())
                .map(|k| STANDARD_DEVIATIONS_95 * deviation(k))
                .collect()
        })
    }
}
