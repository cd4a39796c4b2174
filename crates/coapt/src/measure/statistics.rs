//! Statistics of distances, and the two percentiles: of values, and of values with their areas.

use serde::{Deserialize, Serialize};

/// Statistics of distances [mm].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DistanceStatistics {
    /// How many distances.
    pub count: usize,
    /// Mean [mm].
    pub mean_mm: f64,
    /// Standard deviation about the mean [mm], divided by the number and not by one less: `rms² = mean² + sd²`.
    pub sd_mm: f64,
    /// Root mean square [mm].
    pub rms_mm: f64,
    /// 5th percentile [mm].
    pub p05_mm: f64,
    /// 95th percentile [mm].
    pub p95_mm: f64,
    /// Largest [mm].
    pub max_mm: f64,
}

impl DistanceStatistics {
    /// Of distances that all count the same; percentiles are interpolated between ranks. Nothing of none.
    pub(super) fn of(distances: &[f64]) -> Option<Self> {
        let weighed: Vec<(f64, f64)> = distances.iter().map(|&distance| (distance, 1.0)).collect();
        Some(Self {
            p05_mm: percentile(distances.to_vec(), 0.05),
            p95_mm: percentile(distances.to_vec(), 0.95),
            ..Self::by_area(weighed)?
        })
    }

    /// Of distances, each with the area that it stands for [mm²]; percentiles are distances not exceeded on that
    /// share of the area. Nothing of none, or of no area.
    pub(super) fn by_area(mut distances: Vec<(f64, f64)>) -> Option<Self> {
        distances.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let area_mm2: f64 = distances.iter().map(|d| d.1).sum();
        let max_mm = distances.last()?.0;
        let mean =
            |value: &dyn Fn(f64) -> f64| distances.iter().map(|d| d.1 * value(d.0)).sum::<f64>() / area_mm2;
        (area_mm2 > 0.0).then(|| {
            let mean_mm = mean(&|d| d);
            Self {
                count: distances.len(),
                mean_mm,
                sd_mm: mean(&|d| (d - mean_mm).powi(2)).sqrt(),
                rms_mm: mean(&|d| d.powi(2)).sqrt(),
                p05_mm: percentile_by_area(&distances, area_mm2, 0.05),
                p95_mm: percentile_by_area(&distances, area_mm2, 0.95),
                max_mm,
            }
        })
    }
}

/// Percentile with linear interpolation between ranks (type 7 of Hyndman & Fan 1996, the default of numpy and R); zero
/// of no values.
pub(crate) fn percentile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let Some(last) = values.len().checked_sub(1) else {
        return 0.0;
    };
    let rank = share * last as f64;
    let low = rank.floor() as usize;
    let high = (low + 1).min(last);
    values[low] + (values[high] - values[low]) * (rank - low as f64)
}

/// The least value that is not exceeded on a share of the area (type 1, the only one that numpy has for weights).
/// Between ranks nothing is interpolated: what lies between a huge face and a small one is no area.
fn percentile_by_area(ascending: &[(f64, f64)], area_mm2: f64, share: f64) -> f64 {
    let mut below_mm2 = 0.0;
    let found = ascending.iter().find(|(_, area)| {
        below_mm2 += area;
        below_mm2 >= share * area_mm2
    });
    found.or(ascending.last()).map_or(0.0, |d| d.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The convention on ten numbers: rank 0.95 · 9 = 8.55.
    #[test]
    fn percentile_between_ranks() {
        assert!((percentile((1..=10).map(f64::from).collect(), 0.95) - 9.55).abs() < 1e-12);
        assert_eq!(percentile(vec![], 0.95), 0.0);
        assert_eq!(percentile(vec![3.0], 0.95), 3.0);
    }

    /// 1 to 10: mean 5.5, variance (10² - 1) / 12 = 8.25, mean square 38.5; the sum rule binds the three.
    #[test]
    fn statistics_of_ten_numbers() {
        let numbers: Vec<f64> = (1..=10).map(f64::from).collect();
        let found = DistanceStatistics::of(&numbers).unwrap();
        assert_eq!((found.count, found.mean_mm, found.max_mm), (10, 5.5, 10.0));
        assert!((found.sd_mm - 8.25f64.sqrt()).abs() < 1e-15 * 3.0);
        assert!((found.rms_mm - 38.5f64.sqrt()).abs() < 1e-15 * 7.0);
        assert!((found.p05_mm - 1.45).abs() < 1e-12 && (found.p95_mm - 9.55).abs() < 1e-12);
        assert_eq!(DistanceStatistics::of(&[]), None);
    }

    /// 96 mm² at 1 mm and 4 mm² at 2 mm: both percentiles are 1 mm, the mean 1.04 mm. Without area there is nothing.
    #[test]
    fn area_counts() {
        let found = DistanceStatistics::by_area(vec![(2.0, 4.0), (1.0, 96.0)]).unwrap();
        assert_eq!((found.p05_mm, found.p95_mm, found.max_mm), (1.0, 1.0, 2.0));
        assert!((found.mean_mm - 1.04).abs() < 1e-15);
        let found = DistanceStatistics::by_area(vec![(2.0, 6.0), (1.0, 94.0)]).unwrap();
        assert_eq!(found.p95_mm, 2.0);
        assert_eq!(DistanceStatistics::by_area(vec![(1.0, 0.0)]), None);
    }
}
