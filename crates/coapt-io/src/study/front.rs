//! Which closures are worth their time: the Pareto front of time and error, and its knee.

use super::{Factor, Row};

/// Errors below this are drawn and weighed as this [mm]: a nanometre is nothing, and zero has no logarithm.
pub(super) const LEAST_ERROR_MM: f64 = 1e-6;
/// The same for times [ms]: below what a clock tells.
pub(super) const LEAST_TIME_MS: f64 = 1e-3;

/// A closure that takes longer must lower the error by this part to stay on the front [1]. Less is no gain: tolerances
/// differ in the fourth digit of the error, and on a busy machine chance decides which of them is fastest.
const LEAST_GAIN: f64 = 0.01;

/// Marks the front and its knee. Only certified closures of the reference's own valve compete.
pub fn mark(rows: &mut [Row]) {
    let competing: Vec<(usize, [f64; 2])> = rows
        .iter()
        .enumerate()
        .filter(|(_, row)| row.certified && row.varied == Factor::MeshAndTolerance)
        .filter_map(|(index, row)| place(row).map(|place| (index, place)))
        .collect();
    let points: Vec<[f64; 2]> = competing.iter().map(|&(_, place)| place).collect();
    let best = front(&points);
    for row in rows.iter_mut() {
        (row.on_front, row.knee) = (false, false);
    }
    for &index in &best {
        rows[competing[index].0].on_front = true;
    }
    let ordered: Vec<[f64; 2]> = best.iter().map(|&index| points[index]).collect();
    if let Some(index) = knee(&ordered) {
        rows[competing[best[index]].0].knee = true;
    }
}

/// Time [ms] and error [mm] of a closure as they are drawn; nothing without an error.
pub(super) fn place(row: &Row) -> Option<[f64; 2]> {
    let error_mm = row.error?.rms_mm;
    Some([row.wall_ms.max(LEAST_TIME_MS), error_mm.max(LEAST_ERROR_MM)])
}

/// The points that no other beats: indices by ascending first coordinate, along which the second one falls, each time
/// by more than a hundredth. Of equal points the first stays.
pub fn front(points: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&i, &j| {
        let ([a, b], [c, d]) = (points[i], points[j]);
        a.total_cmp(&c).then(b.total_cmp(&d)).then(i.cmp(&j))
    });
    let mut least = f64::INFINITY;
    order.retain(|&index| {
        let better = points[index][1] < (1.0 - LEAST_GAIN) * least;
        if better {
            least = points[index][1];
        }
        better
    });
    order
}

/// The point of a front that lies farthest below the chord between its ends, in logarithms of both coordinates, so that
/// units do not matter. Nothing where no point lies below: a front of two points, or one that bulges outwards, has no
/// knee.
pub fn knee(front: &[[f64; 2]]) -> Option<usize> {
    let logarithms: Vec<[f64; 2]> = front.iter().map(|point| point.map(f64::log10)).collect();
    let (first, last) = (logarithms.first()?, logarithms.last()?);
    let chord = [last[0] - first[0], last[1] - first[1]];
    let length = chord[0].hypot(chord[1]);
    let below =
        |point: &[f64; 2]| (chord[1] * (point[0] - first[0]) - chord[0] * (point[1] - first[1])) / length;
    let inner = 1..logarithms.len().saturating_sub(1);
    inner
        .map(|index| (index, below(&logarithms[index])))
        // Rounding is not a bend.
        .filter(|&(_, depth)| depth > 1e-9)
        .reduce(|best, next| if next.1 > best.1 { next } else { best })
        .map(|(index, _)| index)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beaten points go, also those beaten in one coordinate only or better by less than a hundredth; the order is that
    /// of time.
    #[test]
    fn the_front_is_what_nothing_beats() {
        let points = [
            [4.0, 1.0],
            [1.0, 5.0],
            [2.0, 3.0],
            [2.0, 4.0],
            [3.0, 3.0],
            [5.0, 1.0],
            [2.0, 3.0],
            [3.5, 2.98],
        ];
        assert_eq!(front(&points), [1, 2, 0]);
        assert_eq!(front(&[]), [] as [usize; 0]);
    }

    /// An L in logarithms has its knee at the corner, in whatever units.
    #[test]
    fn the_knee_is_the_corner() {
        let bend = [[1.0, 1.0], [2.0, 0.1], [4.0, 0.01], [40.0, 0.005], [400.0, 0.003]];
        assert_eq!(knee(&bend), Some(2));
        let metres_and_hours = bend.map(|[time, error]| [time / 3.6e6, error / 1e3]);
        assert_eq!(knee(&metres_and_hours), Some(2));
    }

    /// What has no bend towards the origin has no knee.
    #[test]
    fn straight_short_and_bulging_fronts_have_none() {
        assert_eq!(knee(&[]), None);
        assert_eq!(knee(&[[1.0, 1.0]]), None);
        assert_eq!(knee(&[[1.0, 1.0], [2.0, 0.5]]), None);
        assert_eq!(knee(&[[1.0, 1.0], [10.0, 0.1], [100.0, 0.01]]), None);
        assert_eq!(knee(&[[1.0, 1.0], [10.0, 0.9], [20.0, 0.01]]), None);
    }
}
