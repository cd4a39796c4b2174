//! How far a closed valve lies from the points of a target.

use serde::{Deserialize, Serialize};

use crate::Vec3;
use crate::measure::atrial_view::{AtrialView, view_of};
use crate::measure::indexed_surface::{Foot, IndexedSurface};
use crate::measure::side::signed;
use crate::model::Model;

/// Distances from the points of a target to the nearest place of a closed valve's surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TargetDistance {
    /// Points.
    pub points: usize,
    /// Root mean square [mm].
    pub rms_mm: f64,
    /// Mean, without sign [mm].
    pub mean_mm: f64,
    /// Mean with sign, positive where the target lies on the atrial side of the model [mm].
    pub mean_signed_mm: f64,
    /// Not exceeded by 95 % of the points [mm].
    pub p95_mm: f64,
    /// Largest [mm].
    pub max_mm: f64,
}

/// The distance of every target point, and whether it counts as seen.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Misfit {
    /// Signed distances [mm], shape `[point]`.
    pub(super) distance_mm: Vec<f64>,
    /// Whether the nearest place is visible from the atrium, shape `[point]`; all are where there is no annular plane.
    pub(super) visible: Vec<bool>,
}

/// Measures a closed valve against target points.
pub(super) fn misfit(model: &Model, positions_mm: &[Vec3], points_mm: &[Vec3]) -> Misfit {
    let view = view_of(model, positions_mm);
    let shows = |foot: &Foot| {
        view.as_ref()
            .is_none_or(|view: &AtrialView| view.sees(foot.place))
    };
    let surface = IndexedSurface::new(&model.faces, positions_mm.to_vec());
    let feet = surface.feet(points_mm);
    Misfit {
        // The faces of a model wind alike.
        distance_mm: signed(&surface, None, points_mm, &feet).unwrap_or_default(),
        visible: feet.iter().map(shows).collect(),
    }
}

impl Misfit {
    /// Over all points.
    pub(super) fn of_all(&self) -> TargetDistance {
        statistics(self.distance_mm.clone())
    }

    /// Over the points that are seen.
    pub(super) fn of_visible(&self) -> TargetDistance {
        let seen = self.distance_mm.iter().zip(&self.visible).filter(|seen| *seen.1);
        statistics(seen.map(|(&distance, _)| distance).collect())
    }
}

fn statistics(signed_mm: Vec<f64>) -> TargetDistance {
    let count = signed_mm.len() as f64;
    let mean = |of: fn(f64) -> f64| signed_mm.iter().map(|&d| of(d)).sum::<f64>() / count;
    let (mean_signed_mm, mean_mm, square) = (mean(|d| d), mean(f64::abs), mean(|d| d * d));
    let mut sizes: Vec<f64> = signed_mm.iter().map(|d| d.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let Some(&max_mm) = sizes.last() else {
        return TargetDistance::default();
    };
    TargetDistance {
        points: sizes.len(),
        rms_mm: square.sqrt(),
        mean_mm,
        mean_signed_mm,
        p95_mm: sizes[(0.95 * count).ceil() as usize - 1],
        max_mm,
    }
}

/// Beyond so many standard deviations points pull with constant force: 95 % as efficient as least squares on Gaussian
/// scatter (Huber 1964).
const HUBER: f64 = 1.345;

/// Scatter below this is taken for this [mm]: a target that the model meets exactly has none, and its points must not count
/// as outliers.
const LEAST_SCATTER_MM: f64 = 0.02;

/// Standard deviation of distances about zero, from their median: half of them may be anything.
pub(super) fn scatter_mm(distances_mm: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = distances_mm.iter().map(|d| d.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    // The median of |x| of a Gaussian is 0.6745 of its standard deviation.
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    (median / 0.6745).max(LEAST_SCATTER_MM)
}

/// What a distance counts in least squares [1].
pub(super) fn weight(distance_mm: f64, scatter_mm: f64) -> f64 {
    let bend = HUBER * scatter_mm;
    if distance_mm.abs() <= bend {
        1.0
    } else {
        bend / distance_mm.abs()
    }
}

/// Half the squares of the distances, linear beyond the bend [mm²]: what weights of 1 and less minimise.
pub(super) fn cost_mm2(distances_mm: &[f64], scatter_mm: f64) -> f64 {
    let bend = HUBER * scatter_mm;
    let cost = |d: &f64| {
        let size = d.abs();
        if size <= bend {
            0.5 * size * size
        } else {
            bend * (size - 0.5 * bend)
        }
    };
    distances_mm.iter().map(cost).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of -3, -1, 0, 2, 4: mean 0.4, of sizes 2, root mean square √6, 95 % within the largest.
    #[test]
    fn statistics_by_hand() {
        let found = statistics(vec![4.0, -1.0, 0.0, 2.0, -3.0]);
        assert_eq!(
            (found.points, found.mean_mm, found.max_mm, found.p95_mm),
            (5, 2.0, 4.0, 4.0)
        );
        assert!((found.rms_mm - 6.0_f64.sqrt()).abs() < 1e-15 && (found.mean_signed_mm - 0.4).abs() < 1e-15);
        assert_eq!(statistics(Vec::new()), TargetDistance::default());
    }

    /// The slope of the cost is weight times distance, and a few wild points hardly change the scatter.
    #[test]
    fn weights_are_the_slope_of_the_cost() {
        for distance in [-3.0, -0.4, 0.1, 0.66, 0.68, 5.0] {
            let cost = |d: f64| cost_mm2(&[d], 0.5);
            // Central differences of a parabola and of a line are exact but for rounding of 1e-16 / 1e-6.
            let slope = (cost(distance + 1e-6) - cost(distance - 1e-6)) / 2e-6;
            assert!(
                (slope - weight(distance, 0.5) * distance).abs() < 1e-8,
                "{distance}"
            );
        }
        let mut distances: Vec<f64> = (-50..=50).map(|k| 0.02 * f64::from(k)).collect();
        let before = scatter_mm(&distances);
        distances.extend([30.0, -40.0, 50.0]);
        assert!((scatter_mm(&distances) / before - 1.0).abs() < 0.05);
    }
}
