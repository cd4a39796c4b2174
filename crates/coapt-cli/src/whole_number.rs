//! Whole numbers of options: what is wrong is told with what is expected.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// How many threads there may be.
pub(crate) const THREADS_ALLOWED: RangeInclusive<u16> = 1..=1024;

/// Reads a number of a range, whose type must be that of the option: of bare numbers it would be `i32`. An option that takes one also has `allow_negative_numbers`: without it -3 is taken for an option of its
/// own, and no range is told.
pub(crate) fn whole_number<T: FromStr + PartialOrd + Display + Clone>(
    allowed: RangeInclusive<T>,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |word| {
        let number = word.trim().parse().ok().filter(|number| allowed.contains(number));
        number.ok_or_else(|| {
            format!(
                "expected a whole number from {} to {}",
                allowed.start(),
                allowed.end()
            )
        })
    }
}
