//! Compiles a kernel twice, for any machine and for one with wide fused arithmetic, and runs the better one.
//!
//! The only file that names pulp, which hides the unsafe call that a change of instruction set takes.

/// Something to compute in plain loops over arrays, which the compiler turns into vector instructions.
///
/// The method and all that it calls in its inner loops must be `#[inline(always)]`: what stays outside is compiled for
/// the least machine.
pub trait Kernel {
    /// What comes out.
    type Output;

    /// Computes; passes `FUSED` on to [`multiply_add`].
    fn run<const FUSED: bool>(self) -> Self::Output;
}

/// Runs a kernel with the widest instructions there are: AVX2 and FMA on x86-64, NEON on ARM.
#[inline]
pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(machine) = pulp::x86::V3::try_new() {
        return machine.vectorize(
            #[inline(always)]
            || kernel.run::<true>(),
        );
    }
    kernel.run::<{ cfg!(target_arch = "aarch64") }>()
}

/// a b + c, rounded once if `FUSED`. Without the instruction, rounding once would be a slow library call.
#[inline(always)]
pub fn multiply_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}
