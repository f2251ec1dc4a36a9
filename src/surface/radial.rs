//! Radial Stokes solutions of one degree `l` outside and inside the unit sphere, and the jumps that join them.
//!
//! Velocity `U Y n + V Psi` and pressure `P Y`, units `a = mu = 1`, a combination of (Kim and Karrila,
//! *Microhydrodynamics*, 1991, chapter 4: Lamb's solution)
//!
//! ```text
//! (U, V, P) = s^{l+1} ( l/(2(2l+3)), (l+3)/(2(l+1)(2l+3)), 1/s )      s^{-l} ( (l+1)/(2(2l-1)), (2-l)/(2l(2l-1)), 1/s )
//!             s^{l-1} ( l, 1, 0 )                                     s^{-l-2} ( -(l+1), 1, 0 )
//! ```
//!
//! with `P = F_n`, `U = V = 0`, `V' = -F_s` at `s = 1`. The second and fourth decay: they are the flow outside.

use nalgebra::{Matrix4, Vector4};

/// A traction `F_n Y n + F_s Psi` and the jump it causes, in units `a = mu = 1`.
pub struct Poloidal {
    /// Traction along `Y n`, `F_n`.
    pub normal: f64,
    /// Traction along `Psi`, `F_s`.
    pub tangential: f64,
    amplitudes: [f64; 4],
    position: [f64; 3],
    gradient: [f64; 4],
}

impl Poloidal {
    /// The mode of degree `l >= 1` with these two tractions.
    pub fn new(l: usize, normal: f64, tangential: f64) -> Self {
        let [radial, surface] = velocities(l);
        let n = l as f64;
        let slope = Vector4::new(n + 1.0, -n, n - 1.0, -n - 2.0).component_mul(&surface);
        let conditions = Matrix4::from_columns(&[Vector4::new(1.0, 1.0, 0.0, 0.0), radial, surface, slope]).transpose();
        let jumps = Vector4::new(normal, 0.0, 0.0, -tangential);
        let amplitudes = conditions.lu().solve(&jumps).expect("the four radial solutions are independent");
        let gradient = surface.component_mul(&amplitudes);
        let position = radial.component_mul(&amplitudes) - n * gradient;
        Self {
            normal,
            tangential,
            amplitudes: amplitudes.into(),
            position: [position[0], position[1], position[3]],
            gradient: gradient.into(),
        }
    }

    /// The factors of `X H` and `grad H`, `(U - l V) s^{-l-1}` and `V s^{1-l}`, given `s^2, s^{1-2l}, s^{-2l-1}, s^{-2l-3}`.
    #[inline(always)]
    pub fn factors(&self, [square, before, decay, steep]: [f64; 4]) -> [f64; 2] {
        let (p, g) = (&self.position, &self.gradient);
        let position = p[0] + p[1] * decay + p[2] * steep;
        [position, g[0] * square + g[1] * before + g[2] + g[3] * decay]
    }

    /// The part of [`factors`](Self::factors) that decays, given `s^{1-2l}, s^{-2l-1}, s^{-2l-3}`.
    pub fn exterior_factors(&self, [before, decay, steep]: [f64; 3]) -> [f64; 2] {
        let (p, g) = (&self.position, &self.gradient);
        [p[1] * decay + p[2] * steep, g[1] * before + g[3] * decay]
    }

    /// The factor of `H` in the pressure, `P s^{-l}`, given `decay = s^{-2l-1}`.
    #[inline(always)]
    pub fn pressure(&self, decay: f64) -> f64 {
        self.amplitudes[0] + self.amplitudes[1] * decay
    }

    /// The part of [`pressure`](Self::pressure) that decays.
    pub fn exterior_pressure(&self, decay: f64) -> f64 {
        self.amplitudes[1] * decay
    }

    /// `U` and `V` of the decaying solutions on `gamma`.
    pub fn velocity(&self, l: usize) -> [f64; 2] {
        velocities(l).map(|values| values[1] * self.amplitudes[1] + values[3] * self.amplitudes[3])
    }

    /// The mean over `gamma` of this traction times the velocity `U Y n + V Psi`.
    pub fn mean_with(&self, velocity: [f64; 2], l: usize) -> f64 {
        self.normal * velocity[0] + (l * (l + 1)) as f64 * self.tangential * velocity[1]
    }
}

/// `U` and `V` at `s = 1` of the four radial solutions, which go like `s^{l+1}`, `s^{-l}`, `s^{l-1}`, `s^{-l-2}`.
fn velocities(l: usize) -> [Vector4<f64>; 2] {
    let n = l as f64;
    let (inner, outer) = (2.0 * (2.0 * n + 3.0), 2.0 * (2.0 * n - 1.0));
    let radial = Vector4::new(n / inner, (n + 1.0) / outer, n, -n - 1.0);
    let surface = Vector4::new((n + 3.0) / (inner * (n + 1.0)), (2.0 - n) / (outer * n), 1.0, 1.0);
    [radial, surface]
}
