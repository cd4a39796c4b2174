//! Steps that lead round in a circle.
//!
//! Full steps of the projected tangent may lead to and fro across a kink for ever, each acceptable by itself: stiff ties of a
//! clip in thick leaflets went slack and taut in turn, at a residual of 1.47, for 480 iterations, until the way with rising
//! pressure began. Iterations depend on nothing but where the valve is and on dampings, so that what has come round several
//! times goes on to.

/// Iterations of a circle that must have come round [1]: five rounds of two. Our choice; what is not a circle does not last
/// that long at the precision below.
const LASTS: usize = 10;
/// Residuals this near, as part of themselves, are the same [1]. A valve that still moves changes its residual by far more.
const SAME: f64 = 1e-4;

/// Whether each of the last residuals is that of two iterations before.
pub(super) fn goes_in_circles(residuals: &[f64]) -> bool {
    let Some(first) = residuals.len().checked_sub(LASTS + 2) else {
        return false;
    };
    let last = &residuals[first..];
    let same = |(before, after): (&f64, &f64)| (after - before).abs() <= SAME * before;
    last.iter().zip(&last[2..]).all(same)
}

#[cfg(test)]
mod tests {
    use super::goes_in_circles;

    #[test]
    fn what_comes_round_is_told_from_what_settles() {
        let to_and_fro: Vec<f64> = (0..12).map(|i| if i % 2 == 0 { 1.47 } else { 1.52 }).collect();
        assert!(goes_in_circles(&to_and_fro));
        assert!(!goes_in_circles(&to_and_fro[1..]));
        let slow: Vec<f64> = (0..30).map(|i| 0.999_f64.powi(i)).collect();
        assert!(!goes_in_circles(&slow));
        let mut left = to_and_fro.clone();
        left[11] = 1.4;
        assert!(!goes_in_circles(&left));
    }
}
