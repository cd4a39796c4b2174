//! Logarithmic axes with ticks at decades.

/// An axis between two powers of ten.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axis {
    /// Exponents of its ends.
    pub(super) decades: [i32; 2],
    /// Where its ends are drawn [pixel].
    pub(super) ends: [f64; 2],
}

/// The axis that just holds some positive values.
pub(super) fn axis(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Axis {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    // Without a value, any axis will do.
    let (low, high) = if high > 0.0 { (low, high) } else { (1.0, 10.0) };
    let first = low.log10().floor() as i32;
    // A single decade at least, also where all values are one power of ten.
    let last = (high.log10().ceil() as i32).max(first + 1);
    Axis {
        decades: [first, last],
        ends,
    }
}

impl Axis {
    /// Where a value is drawn [pixel].
    pub(super) fn at(&self, value: f64) -> f64 {
        let [first, last] = self.decades.map(f64::from);
        let share = (value.log10() - first) / (last - first);
        self.ends[0] + share * (self.ends[1] - self.ends[0])
    }

    /// Its decades, and two and five times each where there are few of them, with labels.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        let [first, last] = self.decades;
        let steps: &[u32] = if last - first <= FEW_DECADES {
            &[1, 2, 5]
        } else {
            &[1]
        };
        let ticks = (first..=last).flat_map(|exponent| {
            let at = move |&step: &u32| (f64::from(step) * 10_f64.powi(exponent), label(step, exponent));
            steps.iter().map(at)
        });
        // Times a hair more: a power of ten may be a rounding error beyond itself.
        ticks
            .filter(|tick| tick.0 <= 10_f64.powi(last) * (1.0 + 1e-9))
            .collect()
    }
}

/// Up to so many decades there is room for more than one label in each.
const FEW_DECADES: i32 = 2;

/// A digit times a power of ten as a person writes it.
fn label(digit: u32, exponent: i32) -> String {
    let value = f64::from(digit) * 10_f64.powi(exponent);
    match exponent {
        -3..0 => format!("{value:.*}", exponent.unsigned_abs() as usize),
        0..5 => format!("{value:.0}"),
        _ => format!("{digit}e{exponent}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks().into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn decades_hold_the_values_and_are_labelled() {
        let axis = axis([0.3, 12.0, 0.02].into_iter(), [100.0, 0.0]);
        assert_eq!(axis.decades, [-2, 2]);
        assert_eq!(labels(&axis), ["0.01", "0.1", "1", "10", "100"]);
        assert!((axis.at(1.0) - 50.0).abs() < 1e-12);
        assert_eq!([-4, 5].map(|exponent| label(2, exponent)), ["2e-4", "2e5"]);
        let short = super::axis([0.3, 3.0].into_iter(), [0.0, 1.0]);
        assert_eq!(labels(&short), ["0.1", "0.2", "0.5", "1", "2", "5", "10"]);
    }

    /// No value, and a single power of ten, still make an axis of some length.
    #[test]
    fn an_axis_has_a_length() {
        for values in [vec![], vec![10.0], vec![10.0, 10.0]] {
            let axis = axis(values.into_iter(), [0.0, 1.0]);
            assert!(axis.decades[1] > axis.decades[0]);
            assert!(axis.at(10.0).is_finite());
        }
    }
}
