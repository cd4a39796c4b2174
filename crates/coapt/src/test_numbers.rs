//! Numbers for tests.

use crate::Vec3;

/// A repeatable sequence of numbers in −1..1 (Knuth's linear congruential generator).
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn below(&mut self, limit: usize) -> u32 {
        ((self.next() + 1.0) / 2.0 * limit as f64) as u32
    }

    pub(crate) fn vectors(&mut self, size: usize) -> Vec<Vec3> {
        (0..size).map(|_| Vec3::from_fn(|_, _| self.next())).collect()
    }
}
