//! Dense arithmetic on as many threads as there are.
//!
//! Every number of the result is computed by one thread in the order in which one thread alone would: the result is the
//! same, bit by bit, on any number of threads.

use crate::simd::{Kernel, dispatch};

/// Products of two numbers that are worth a thread [1]: a tenth of a millisecond. The processor time of all threads
/// together is the same, within the noise, at half as many and at four times as many (matrices of 3,000 to 12,000 block
/// rows). With fewer, waking threads would cost what they save; with more, nodes of 6,000 faces stay with one thread.
const LEAST_PRODUCTS: usize = 2_000_000;

/// Work that falls into parts that do not touch each other's numbers.
pub(super) trait Shared: Kernel<Output = ()> + Send + Sized {
    /// Products of two numbers that it takes.
    fn products(&self) -> usize;

    /// Strips of rows that it falls into.
    fn strips(&self) -> usize;

    /// Two parts of about the same work, given at least two strips.
    fn halves(self) -> (Self, Self);
}

/// Does the work, here if it is little.
#[inline(always)]
pub(super) fn run<const FUSED: bool, S: Shared>(work: S) {
    if is_for_one(&work) {
        work.run::<FUSED>();
    } else {
        run_on_threads(work);
    }
}

fn run_on_threads<S: Shared>(work: S) {
    if is_for_one(&work) {
        dispatch(work);
    } else {
        let (first, second) = work.halves();
        rayon::join(|| run_on_threads(first), || run_on_threads(second));
    }
}

fn is_for_one(work: &impl Shared) -> bool {
    work.strips() < 2 || !is_worth_sharing(work.products())
}

/// Whether so many products of two numbers are shared out.
pub(super) fn is_worth_sharing(products: usize) -> bool {
    products >= 2 * LEAST_PRODUCTS
}
