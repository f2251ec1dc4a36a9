//! Oscillating-flow response of a ball: unsteady Stokes flow inside and outside, of one wavenumber or degree.
//!
//! Units: radius and viscosity one, `s = x^2` the shift of the operator. Flows are a potential part, `u = -grad p / s`, and a vortical one
//! that decays with modified Bessel functions from the surface into both sides,
//!
//! ```text
//! circle:  p = P r^{+-q} cos q t,  psi = B f(r) sin q t,  f = I_q(x r) | K_q(x r)
//! sphere:  p = P r^l | r^{-l-1},   u = curl curl (r B f(r) Y),  f = i_l(x r) | k_l(x r)
//! ```
//!
//! with `[p] = F_n`, `[u] = 0`, `[du_t/dn] = -F_t` (Kim and Karrila, *Microhydrodynamics*, 1991, chapter 6).

use nalgebra::{Matrix4, SMatrix, Vector4};

/// Below this `x` a viscous wave is so much longer than the body that the flow is steady; sums of Bessel functions would lose digits.
pub const STEADY: f64 = 0.03;

/// Terms of the continued fraction of growing Bessel functions.
const TERMS: usize = 400;

/// What a traction on a circle moves: the velocities `(U cos q t, V sin q t)`, radial and tangential, that `(cos q t, 0)` (first column) and
/// `(0, sin q t)` (second column) cause, for a wavenumber `q >= 1`.
pub fn circle(q: usize, x: f64) -> SMatrix<f64, 2, 2> {
    let (n, square) = (q as f64, x * x);
    let (inner, outer) = (growing(n, x) + n / x, -decaying(0.0, q, x) + n / x);
    let (inner, outer) = (inner * x, outer * x);
    let bend = |slope: f64| n * n + square - slope;
    let conditions = Matrix4::new(
        -1.0,
        1.0,
        0.0,
        0.0, //
        n / square,
        n / square,
        -n,
        n, //
        -n / square,
        n / square,
        inner,
        -outer, //
        -n * (n - 1.0) / square,
        -n * (n + 1.0) / square,
        bend(inner),
        -bend(outer),
    );
    // outside: u_r = q (P/s + B), u_t = q P/s - B f'
    respond(conditions, |found| [n * (found[1] / square + found[3]), n * found[1] / square - found[3] * outer])
}

/// The spin of a circle that a unit tangential traction causes, times its radius.
pub fn circle_rotation(x: f64) -> f64 {
    1.0 / (x * (growing(1.0, x) + 1.0 / x) - x * (1.0 / x - decaying(0.0, 1, x)))
}

/// The factors `(U, V)` of `Y n` and `Psi` in the velocity that the tractions `Y n` (first column) and `Psi` (second column) cause on a sphere, for a
/// degree `l >= 1`.
pub fn sphere(l: usize, x: f64) -> SMatrix<f64, 2, 2> {
    let (n, square) = (l as f64, x * x);
    let (inner, outer) = sphere_slopes(l, x);
    let bend = |slope: f64| n * (n + 1.0) + square - 1.0 - slope;
    let conditions = Matrix4::new(
        -1.0,
        1.0,
        0.0,
        0.0, //
        n / square,
        (n + 1.0) / square,
        -n * (n + 1.0),
        n * (n + 1.0), //
        1.0 / square,
        -1.0 / square,
        -(inner + 1.0),
        outer + 1.0, //
        (n - 1.0) / square,
        (n + 2.0) / square,
        -bend(inner),
        bend(outer),
    );
    respond(conditions, |found| [(n + 1.0) * found[1] / square + n * (n + 1.0) * found[3], -found[1] / square + found[3] * (outer + 1.0)])
}

/// The factor of `Phi` in the velocity that the traction `Phi` causes on a sphere.
pub fn sphere_rotation(l: usize, x: f64) -> f64 {
    let (inner, outer) = sphere_slopes(l, x);
    1.0 / (inner - outer)
}

/// Velocities on the surface from pressures and vortical parts inside and outside, for unit normal and unit tangential tractions.
fn respond(conditions: Matrix4<f64>, velocity: impl Fn(Vector4<f64>) -> [f64; 2]) -> SMatrix<f64, 2, 2> {
    let solved = conditions.lu();
    let of = |load: Vector4<f64>| velocity(solved.solve(&load).expect("the two sides of a surface are independent"));
    let (normal, tangential) = (of(Vector4::new(1.0, 0.0, 0.0, 0.0)), of(Vector4::new(0.0, 0.0, 0.0, -1.0)));
    SMatrix::from_columns(&[normal.into(), tangential.into()])
}

/// Logarithmic derivatives at the surface of `i_l(x r)` and `k_l(x r)`.
fn sphere_slopes(l: usize, x: f64) -> (f64, f64) {
    let n = l as f64;
    (x * growing(n + 0.5, x) + n, n - x * decaying(0.5, l, x))
}

/// `I_{v+1}(x) / I_v(x)`, by its continued fraction from below.
fn growing(order: f64, x: f64) -> f64 {
    (1..=TERMS).rev().fold(0.0, |ratio, term| 1.0 / (2.0 * (order + term as f64) / x + ratio))
}

/// `K_{v+1}(x) / K_v(x)` with `v = start + steps`, by the recurrence, which is stable upwards.
fn decaying(start: f64, steps: usize, x: f64) -> f64 {
    let first = if start == 0.5 { 1.0 + 1.0 / x } else { decaying_integral(1.0, x) / decaying_integral(0.0, x) };
    (1..=steps).fold(first, |ratio, step| 1.0 / ratio + 2.0 * (start + step as f64) / x)
}

/// `exp(x) K_v(x)`, the integral of `exp(x - x cosh t) cosh(v t)` by the trapezoidal rule, which converges exponentially.
fn decaying_integral(order: f64, x: f64) -> f64 {
    const STEP: f64 = 0.05;
    let value = |place: usize| {
        let t = STEP * place as f64;
        (-2.0 * x * (0.5 * t).sinh().powi(2)).exp() * (order * t).cosh()
    };
    STEP * (0.5 + (1..).map(value).take_while(|value| *value > 1e-18).sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{Fourier, Modes, Spherical};

    #[test]
    fn bessel_functions_have_their_tabulated_ratios() {
        // Abramowitz and Stegun, tables 9.8 and 9.11
        assert!((growing(0.0, 1.0) - 0.565159103992 / 1.266065877752).abs() < 1e-11);
        assert!((decaying(0.0, 0, 1.0) - 0.601907230197 / 0.421024438241).abs() < 1e-10);
        assert!((decaying(0.0, 1, 2.0) - 0.253759754566 / 0.139865881817).abs() < 1e-10);
        assert!((decaying(0.5, 1, 3.0) - (1.0 + 3.0 / 3.0 + 3.0 / 9.0) / (1.0 + 1.0 / 3.0)).abs() < 1e-13);
    }

    #[test]
    fn long_waves_answer_as_steady_flow_does() {
        let (x, order) = (STEADY, 4);
        let (steady, found) = (Fourier::new(1.0, order).isolated_mobility(1.0), Fourier::new(1.0, order).unsteady_mobility(x * x, 1.0));
        for mode in 2..steady.nrows() {
            assert!(
                (found[(mode, mode)] / steady[(mode, mode)] - 1.0).abs() < 0.01,
                "mode {mode}: {} {}",
                found[(mode, mode)],
                steady[(mode, mode)]
            );
        }
        let (steady, found) = (Spherical::new(1.0, 3).isolated_mobility(1.0), Spherical::new(1.0, 3).unsteady_mobility(x * x, 1.0));
        assert!((&found - &steady).amax() < 0.03 * steady.amax());
    }

    /// Stokes (1851): an oscillating sphere of radius 1 feels `6 pi (1 + x + x^2/9)`, and a sphere of fluid that moves with it needs `4 pi x^2 / 3` more.
    #[test]
    fn a_sphere_that_starts_feels_the_drag_of_stokes() {
        let pi = std::f64::consts::PI;
        for x in [0.1, 1.0, 7.0] {
            let mobility = Spherical::new(1.0, 2).unsteady_mobility(x * x, 1.0);
            let resistance = mobility.try_inverse().unwrap()[(0, 0)] * 4.0 * pi;
            // a rigid translation on the surface moves the inside as one
            let exact = 6.0 * pi * (1.0 + x + x * x / 9.0) + 4.0 / 3.0 * pi * x * x;
            assert!((resistance / exact - 1.0).abs() < 1e-9, "x = {x}: {resistance} {exact}");
        }
    }

    #[test]
    fn mobilities_are_symmetric_and_positive() {
        for x in [0.05, 0.7, 5.0, 60.0] {
            for mobility in
                [Fourier::new(0.7, 6).unsteady_mobility(x * x / 0.49, 2.0), Spherical::new(0.7, 4).unsteady_mobility(x * x / 0.49, 2.0)]
            {
                assert!((&mobility - mobility.transpose()).amax() < 1e-9 * mobility.amax(), "x = {x}");
                assert!(mobility.cholesky().is_some(), "x = {x}");
            }
        }
    }
}
