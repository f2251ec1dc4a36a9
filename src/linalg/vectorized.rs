//! Loops compiled twice: for all processors of a kind, and for those with wide registers (AVX2), which is found out where the program runs.
//!
//! Products are not fused with sums: both give the same to the last bit.

use pulp::{Arch, Simd, WithSimd};

/// A kernel as it is compiled for each.
struct Kernel<F>(F);

impl<R, F: FnMut() -> R> WithSimd for Kernel<F> {
    type Output = R;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> R {
        (self.0)()
    }
}

/// Runs a kernel as it is compiled for this processor. The kernel must be `#[inline(always)]`, and so must what it calls: functions of their own know no wide
/// registers.
#[inline(always)]
pub fn vectorized<R>(kernel: impl FnMut() -> R) -> R {
    Arch::new().dispatch(Kernel(kernel))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_give_the_same_to_the_last_bit() {
        let values: [f64; 64] = std::array::from_fn(|place| (place as f64).sin());
        let wave = |factor: f64| values.map(|value| 0.3 + factor * value * value);
        let mut wide = [0.0; 64];
        vectorized(
            #[inline(always)]
            || wide = wave(1.7),
        );
        assert_eq!(wide, wave(1.7));
    }
}
