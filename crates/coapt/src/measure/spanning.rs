//! The smallest surface that spans a closed curve.

use super::distance::triangle_area;
use super::plane::{edges_closed, resample_closed};
use crate::Vec3;

/// A rim of more points than this is resampled evenly first: the search below takes the cube of their number.
const RIM_POINTS: usize = 120;

/// Area of the smallest triangulation of a closed polygon in space, by dynamic programming over its pieces.
/// (Barequet & Sharir 1995, "Filling gaps in the boundary of a polyhedron".)
pub(super) fn spanning_area(polygon: &[Vec3]) -> f64 {
    let polygon = if polygon.len() > RIM_POINTS {
        resample_closed(polygon, RIM_POINTS)
    } else {
        polygon.to_vec()
    };
    let n = polygon.len();
    if n < 3 || edges_closed(&polygon).all(|[a, b]| a == b) {
        return 0.0;
    }
    let mut least = vec![0.0f64; n * n];
    for span in 2..n {
        for i in 0..n - span {
            let j = i + span;
            let best = (i + 1..j)
                .map(|k| {
                    least[i * n + k] + least[k * n + j] + triangle_area([polygon[i], polygon[k], polygon[j]])
                })
                .fold(f64::INFINITY, f64::min);
            least[i * n + j] = best;
        }
    }
    least[n - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The smallest surface over a bent square: two triangles that meet along the shorter diagonal.
    #[test]
    fn spanning_a_bent_square() {
        let p = |x, y, z| Vec3::new(x, y, z);
        let square = [
            p(0.0, 0.0, 0.0),
            p(1.0, 0.0, 1.0),
            p(1.0, 1.0, 0.0),
            p(0.0, 1.0, 1.0),
        ];
        let exact = 2.0 * triangle_area([square[0], square[1], square[2]]);
        assert!((spanning_area(&square) - exact).abs() < 1e-15);
        assert_eq!(spanning_area(&square[..2]), 0.0);
        assert_eq!(spanning_area(&[Vec3::zeros(); 5]), 0.0);
    }
}
