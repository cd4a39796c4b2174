//! Numbers of twice the digits: a double and what it leaves over (Dekker 1971; Knuth, The Art of Computer Programming 2,
//! 4.2.2). For the few pairs of which the closest points are lost in double precision.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number to 32 digits: the sum of both, of which the first is its rounding to double precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubled {
    pub(super) high: f64,
    low: f64,
}

/// Multiplied by it and brought back, a number keeps its upper 26 bits.
const SPLITTER: f64 = 134_217_729.0;

impl Doubled {
    pub(super) const ZERO: Self = Self { high: 0.0, low: 0.0 };
    pub(super) const ONE: Self = Self { high: 1.0, low: 0.0 };

    fn of(value: f64) -> Self {
        Self {
            high: value,
            low: 0.0,
        }
    }

    /// a + b, exactly.
    pub(super) fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let of_b = high - a;
        Self {
            high,
            low: (a - (high - of_b)) + (b - of_b),
        }
    }

    /// a b, exactly; without fused arithmetic, which many machines lack.
    fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        let ([a, a_rest], [b, b_rest]) = (halves(a), halves(b));
        Self {
            high,
            low: ((a * b - high) + a * b_rest + a_rest * b) + a_rest * b_rest,
        }
    }

    /// Times a power of two.
    pub(super) fn scaled(self, power: f64) -> Self {
        Self {
            high: self.high * power,
            low: self.low * power,
        }
    }

    pub(super) fn clamp_to_one(self) -> Self {
        if self.high < 0.0 {
            Self::ZERO
        } else if self.high >= 1.0 && (self - Self::ONE).high >= 0.0 {
            Self::ONE
        } else {
            self
        }
    }
}

fn halves(a: f64) -> [f64; 2] {
    let large = SPLITTER * a;
    let upper = large - (large - a);
    [upper, a - upper]
}

impl Neg for Doubled {
    type Output = Self;

    fn neg(self) -> Self {
        self.scaled(-1.0)
    }
}

impl Add for Doubled {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, low) = (Self::sum(self.high, other.high), Self::sum(self.low, other.low));
        let first = Self::sum(high.high, high.low + low.high);
        Self::sum(first.high, first.low + low.low)
    }
}

impl Sub for Doubled {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Doubled {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        let rest = self.high * other.low + self.low * other.high;
        Self::sum(product.high, product.low + rest)
    }
}

impl Div for Doubled {
    type Output = Self;

    /// Digit by digit, a double each.
    fn div(self, other: Self) -> Self {
        let times = |digit: f64| other * Self::of(digit);
        let first = self.high / other.high;
        let left = self - times(first);
        let second = left.high / other.high;
        let third = (left - times(second)).high / other.high;
        Self::sum(first, second) + Self::of(third)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (1 + 2⁻⁶⁰)² has its second digit from the cross terms; a third less itself thrice has nothing left but 32 digits of
    /// rounding.
    #[test]
    fn keeps_twice_the_digits() {
        let tiny = (-60_f64).exp2();
        let square = Doubled::sum(1.0, tiny) * Doubled::sum(1.0, tiny);
        assert_eq!((square - Doubled::ONE).high, 2.0 * tiny);
        let third = Doubled::ONE / Doubled::sum(3.0, 0.0);
        assert!((third + third + third - Doubled::ONE).high.abs() < 1e-31);
        let exact = Doubled::product(0.1, 0.1);
        assert!(exact.low != 0.0 && exact.low.abs() < 1e-18);
    }
}
