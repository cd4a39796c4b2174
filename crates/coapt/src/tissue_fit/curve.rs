//! The biaxial curve of a law, to fit springs to.

use super::BiaxialPoint;
use crate::energy::membrane::{Law, Metric};

/// Stretches between which states are sought [1]: beyond, no leaflet is whole.
const STRETCHES: [f64; 2] = [0.5, 4.0];

/// Halvings of an interval of stretch: to 1e-12.
const HALVINGS: u32 = 42;

/// Proportions of the stresses along and across the fibres, the larger being 1, that together tell the constants of springs
/// with a direction: alike, and each direction with twice the stress of the other. One alone leaves them open.
pub const STRESS_RATIOS: [[f64; 2]; 3] = [[1.0, 1.0], [1.0, 0.5], [0.5, 1.0]];

/// The states of a membrane under Cauchy stresses of a given proportion, in `count` equal steps of the larger up to
/// `most_mpa`, fibres along the first axis.
///
/// A state that asks for stretches beyond four is left out: such a law is too soft to say more. A membrane bears
/// P₁ = ∂w/∂λ₁ = 2 λ₁ ∂w/∂c₁₁, and σ₁ = λ₁ P₁ as volume stays. Each stress grows with the stretch in its own direction, so
/// that halving intervals finds the one stretch within the other.
pub fn curve_of_law(law: &Law, stress_ratio: [f64; 2], most_mpa: f64, count: usize) -> Vec<BiaxialPoint> {
    curve_of_response(
        |stretch| stress_of_law_mpa(law, stretch),
        stress_ratio,
        most_mpa,
        count,
    )
}

/// Nominal stresses of a membrane along and across its fibres [MPa] at stretches [1].
pub(super) fn stress_of_law_mpa(law: &Law, stretch: [f64; 2]) -> [f64; 2] {
    let metric = Metric::new(stretch[0].powi(2), stretch[1].powi(2), 0.0);
    let slope = law.response(&metric).slope_mpa;
    [0, 1].map(|axis| 2.0 * stretch[axis] * slope[axis])
}

/// The same for any law that gives nominal stresses [MPa] from stretches [1].
pub fn curve_of_response(
    nominal_stress_mpa: impl Fn([f64; 2]) -> [f64; 2],
    stress_ratio: [f64; 2],
    most_mpa: f64,
    count: usize,
) -> Vec<BiaxialPoint> {
    let state = |step: usize| {
        let stress_mpa = stress_ratio.map(|part| part * most_mpa * step as f64 / count as f64);
        let lacks = |stretch: [f64; 2], axis: usize| {
            nominal_stress_mpa(stretch)[axis] * stretch[axis] - stress_mpa[axis]
        };
        let second = |first: f64| crossing(|second| lacks([first, second], 1));
        let first = crossing(|first| lacks([first, second(first)], 0));
        let stretch = [first, second(first)];
        BiaxialPoint {
            stretch,
            nominal_stress_mpa: nominal_stress_mpa(stretch),
        }
    };
    let inside = |point: &BiaxialPoint| {
        point
            .stretch
            .iter()
            .all(|&stretch| stretch < 0.999 * STRETCHES[1])
    };
    (1..=count).map(state).filter(inside).collect()
}

/// Where a growing function of a stretch crosses zero.
fn crossing(function: impl Fn(f64) -> f64) -> f64 {
    let [mut low, mut high] = STRETCHES;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if function(middle) < 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    0.5 * (low + high)
}
