//! Multiplier modes of a scalar on the surface of a ball, and the jumps that they cause.
//!
//! A flux `lambda` spread over the surface makes the slope of `u` jump, `[du/dn] = -lambda` (outside minus inside), and so does
//! the edge of a source of unit strength outside, `-Lap u = 1`. With the scaled position `X = x/a`, `s = |X|`, harmonic
//! polynomials `H` of degree `l` and `n = 2l + D - 2`, the jump functions, zero on the surface, are
//!
//! ```text
//! D = -(a/n) (1 - s^{-n}) H(X)      (-a ln s at n = 0)      source:  -(a^2/(2D)) (s^2 - 1) - (a/D) D_0
//! ```
//!
//! with `D_0` the first of them: the source has neither a jump of the slope nor a net flux.

use std::{f64::consts::SQRT_2, ops::Range};

use nalgebra::DMatrix;

use super::{
    Modes,
    simd::{LANES, Simd, each, in_batches},
    solid_harmonics::SolidHarmonics,
};

/// Harmonics on a circle or a sphere, the constant first, then by degree; each has mean square 1 and is orthogonal to the others.
pub struct ScalarModes<const D: usize> {
    radius: f64,
    order: usize,
    solid: SolidHarmonics,
}

impl<const D: usize> ScalarModes<D> {
    /// Modes up to degree `order`, at least 1.
    pub fn new(radius: f64, order: usize) -> Self {
        // the plane needs no solid harmonics
        let solid = SolidHarmonics::new(if D == 2 { 1 } else { order });
        ScalarModes { radius, order, solid }
    }

    /// The modes of a degree.
    fn of_degree(degree: usize) -> Range<usize> {
        match (D, degree) {
            (2, 0) => 0..1,
            (2, _) => 2 * degree - 1..2 * degree + 1,
            _ => degree * degree..(degree + 1) * (degree + 1),
        }
    }

    /// Writes the harmonic polynomials at scaled positions.
    fn harmonics(&self, position: &[Simd; D], values: &mut [Simd]) {
        if D > 2 {
            return self.solid.fill(&std::array::from_fn(|axis| position[axis]), values);
        }
        let [x, y] = [position[0], position[1]];
        values[0] = [1.0; LANES];
        let (mut re, mut im) = ([SQRT_2; LANES], [0.0; LANES]);
        for pair in values[1..self.count()].chunks_exact_mut(2) {
            (re, im) = (each(|k| re[k] * x[k] - im[k] * y[k]), each(|k| re[k] * y[k] + im[k] * x[k]));
            pair.copy_from_slice(&[re, im]);
        }
    }

    fn simd_jumps(&self, position: &[Simd; D], values: &mut [Simd]) {
        let (a, dimension) = (self.radius, D as f64);
        let square = each(|k| position.iter().map(|x| x[k] * x[k]).sum());
        let mut decay = each(|k| square[k].powf(1.0 - 0.5 * dimension));
        self.harmonics(position, values);
        for degree in 0..=self.order {
            let n = (2 * degree + D - 2) as f64;
            let factor = each(|k| if n == 0.0 { -0.5 * a * square[k].ln() } else { -a / n * (1.0 - decay[k]) });
            values[Self::of_degree(degree)].iter_mut().for_each(|value| *value = each(|k| factor[k] * value[k]));
            decay = each(|k| decay[k] / square[k]);
        }
        let constant = values[0];
        values[self.count()] = each(|k| -a * (a * (square[k] - 1.0) / 2.0 + constant[k]) / dimension);
    }
}

impl<const D: usize> Modes for ScalarModes<D> {
    fn dimension(&self) -> usize {
        D
    }

    fn radius(&self) -> f64 {
        self.radius
    }

    fn count(&self) -> usize {
        Self::of_degree(self.order).end
    }

    fn components(&self) -> usize {
        1
    }

    fn traction(&self, direction: &[f64], out: &mut [f64]) {
        let mut values = vec![[0.0; LANES]; self.count()];
        self.harmonics(&std::array::from_fn(|axis| [direction[axis]; LANES]), &mut values);
        out.iter_mut().zip(values).for_each(|(out, value)| *out = value[0]);
    }

    /// The jump functions of unit coefficients, and last that of a unit source.
    fn velocity_jumps(&self, offsets: &[f64], _component: usize, out: &mut [f64]) {
        in_batches(offsets, self.radius, self.jump_count(), out, |position, values| {
            self.simd_jumps(position, values.as_chunks_mut().0);
        });
    }

    fn jump_count(&self) -> usize {
        self.count() + 1
    }

    /// On the diagonal `a/n`; the constant, whose value depends on what is far away in the plane, counts as `a`.
    fn isolated_mobility(&self, _reach: f64) -> DMatrix<f64> {
        let value = |degree: usize| if degree == 0 { self.radius } else { self.radius / (2 * degree + D - 2) as f64 };
        let values = (0..=self.order).flat_map(|degree| Self::of_degree(degree).map(move |_| value(degree)));
        DMatrix::from_diagonal(&values.collect::<Vec<f64>>().into())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{SVector, Vector2, Vector3};

    use super::*;
    use crate::surface::SurfaceTable;

    const STEP: f64 = 3e-4;

    fn jumps<const D: usize>(modes: &ScalarModes<D>, offset: SVector<f64, D>) -> SVector<f64, 26> {
        let mut jumps = SVector::<f64, 26>::zeros();
        modes.velocity_jumps(offset.as_slice(), 0, &mut jumps.as_mut_slice()[..modes.jump_count()]);
        jumps
    }

    fn values(modes: &dyn Modes, direction: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; modes.count()];
        modes.traction(direction, &mut values);
        values
    }

    /// Minus the Laplacians of all jump functions at an offset, by differences.
    fn minus_laplacian<const D: usize>(modes: &ScalarModes<D>, offset: SVector<f64, D>) -> Vec<f64> {
        let at = |offset| jumps(modes, offset);
        let mut sum = at(offset) * (2.0 * D as f64);
        for axis in 0..D {
            let step = SVector::<f64, D>::from_fn(|other, _| if other == axis { STEP } else { 0.0 });
            sum -= at(offset + step) + at(offset - step);
        }
        (sum / (STEP * STEP)).iter().copied().take(modes.jump_count()).collect()
    }

    fn proof<const D: usize>(direction: SVector<f64, D>) {
        let modes = ScalarModes::<D>::new(0.7, 4);
        let jumps = |s: f64| jumps(&modes, direction * (0.7 * s));
        let (on, out, inside) = (jumps(1.0), jumps(1.0 + STEP), jumps(1.0 - STEP));
        for (mode, value) in values(&modes, direction.as_slice()).into_iter().chain([0.0]).enumerate() {
            assert!(on[mode].abs() < 1e-14);
            assert!(((out[mode] - inside[mode]) / (1.4 * STEP) + value).abs() < 1e-4, "slope of {mode}");
        }
        for s in [0.6, 1.3] {
            let sources = minus_laplacian(&modes, direction * (0.7 * s));
            for (mode, found) in sources.iter().enumerate() {
                let expected = if mode == modes.count() { 1.0 } else { 0.0 };
                assert!((found - expected).abs() < 1e-2, "source of {mode}: {found}");
            }
        }
    }

    #[test]
    fn jumps_are_zero_on_the_surface_have_the_slope_of_their_mode_and_no_source_but_one() {
        proof(Vector2::new(0.6, -0.8));
        proof(Vector3::new(0.48, -0.6, 0.64));
    }

    #[test]
    fn modes_are_orthonormal_in_the_mean() {
        let surface = SurfaceTable::<3>::scalar(0.7, 3, 0.2);
        let directions = surface.offsets().map(|offset| offset / 0.7);
        let values: Vec<f64> = directions.flat_map(|direction| values(surface.modes.as_ref(), direction.as_slice())).collect();
        let products = surface.projector() * DMatrix::from_vec(16, values.len() / 16, values).transpose();
        assert!((products - DMatrix::identity(16, 16)).amax() < 1e-13);
    }
}
