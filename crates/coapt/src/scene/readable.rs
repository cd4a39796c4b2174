//! Numbers in messages and tables: whatever somebody typed, no three hundred digits.

use std::fmt::{Display, Formatter, Result};

/// A number as a person reads it: digits as usual, powers of ten from 1e7 on and below 1e-5; with so many behind the point if
/// asked for, as in `{:.2}`. Where powers of ten begin is our choice: seven digits are counted at a glance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Readable(pub f64);

const LEAST_LARGE: f64 = 1e7;
const LEAST_USUAL: f64 = 1e-5;

impl Display for Readable {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let value = self.0;
        let is_extreme =
            value.is_finite() && value != 0.0 && !(LEAST_USUAL..LEAST_LARGE).contains(&value.abs());
        match f.precision() {
            Some(digits) if is_extreme => write!(f, "{value:.digits$e}"),
            Some(digits) => write!(f, "{value:.digits$}"),
            None if is_extreme => write!(f, "{value:e}"),
            None => write!(f, "{value}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_number_has_three_hundred_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-1.5, "-1.5"),
            (0.00001, "0.00001"),
            (9_999_999.0, "9999999"),
            (1e7, "1e7"),
            (-1e308, "-1e308"),
            (1.25e-320, "1.25e-320"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(Readable(value).to_string(), text);
        }
        for (value, text) in [
            (1.25, "1.2"),
            (0.0, "0.0"),
            (1e-300, "1.0e-300"),
            (1.26e300, "1.3e300"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(format!("{:.1}", Readable(value)), text);
        }
    }
}
