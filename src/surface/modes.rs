//! What multiplier modes on the surface of a body are.

use std::f64::consts::PI;

use nalgebra::DMatrix;

use super::rotation::Degree;

/// Multiplier modes on the surface of a ball: tractions `F` on `gamma`, linear in real coefficients, and the jump functions they cause.
///
/// A body of another shape has modes of its own: directions of the unit circle or sphere are then parameters of its surface ([`point`](Self::point)), means over
/// `gamma` are means over directions, and `F` is force per directions, times the mean of `gamma` per directions. What is said of balls below holds then as it
/// stands, with the [`radius`](Self::radius) of a ball of equal area.
///
/// Rigid modes come first: the translations `F = e_i`, then the rotations, `F = tau` (counter-clockwise) in 2D and
/// `F = sqrt(3/2) e_k x n` in 3D. Every mode has `mean |F|^2 = 1` and is orthogonal to the others; the constant
/// pressure inside is left out. Points are `dimension` consecutive numbers.
pub trait Modes {
    /// Space dimension `D`, 2 or 3.
    fn dimension(&self) -> usize;

    /// Radius `a` of the ball, or of a ball of equal area (2D: length).
    fn radius(&self) -> f64;

    /// Radii of the largest ball about the centre inside the body, and of the smallest that holds it.
    fn bounds(&self) -> [f64; 2] {
        [self.radius(); 2]
    }

    /// Whether a point at an offset from the centre lies outside the body, of those between the two [`bounds`](Self::bounds).
    fn outside(&self, offset: &[f64]) -> bool {
        offset.iter().map(|along| along * along).sum::<f64>() > self.radius().powi(2)
    }

    /// Writes in `out` the point of the surface of a direction, from the centre.
    fn point(&self, direction: &[f64], out: &mut [f64]) {
        out.iter_mut().zip(direction).for_each(|(out, along)| *out = along * self.radius());
    }

    /// Number of modes, rigid ones included.
    fn count(&self) -> usize;

    /// Number of components of what the modes are: `D`, or one for the flux of a scalar.
    fn components(&self) -> usize {
        self.dimension()
    }

    /// Writes in `out[mode * components + i]` the traction of unit coefficient at the surface point with outward unit normal `direction`.
    fn traction(&self, direction: &[f64], out: &mut [f64]);

    /// Writes in `out[point * stride + mode]` one component of the velocity jump `D_u` at each of the offsets from the centre, none zero;
    /// `stride = out.len() / points` is at least the number of modes, and what lies between is left alone.
    fn velocity_jumps(&self, offsets: &[f64], component: usize, out: &mut [f64]);

    /// Writes in `out[point * stride + mode]` the pressure jump `D_p` at each of the offsets from the centre, none zero.
    fn pressure_jumps(&self, _offsets: &[f64], out: &mut [f64]) {
        out.fill(0.0);
    }

    /// The jump functions of a field: a component of the velocity (or the scalar), or the pressure behind the last of them.
    fn jumps(&self, offsets: &[f64], field: usize, out: &mut [f64]) {
        if field == self.components() { self.pressure_jumps(offsets, out) } else { self.velocity_jumps(offsets, field, out) }
    }

    /// Number of jump functions: one a mode, and behind them those of sources.
    fn jump_count(&self) -> usize {
        self.count()
    }

    /// The velocity of an isolated ball in unbounded fluid tested with the modes, symmetric positive definite.
    ///
    /// Entry `(m, n)` is the mean over `gamma` of `F_m . u_n`, with `u_n` the velocity that unit coefficient `n` causes.
    /// In 2D, where a net force has no bounded velocity, the length `reach > a` cuts the logarithm:
    /// `ln(reach/a)`, at least 0.5.
    fn isolated_mobility(&self, reach: f64) -> DMatrix<f64>;

    /// The same in a flow with inertia, the fluid inside included, where the operator is `shift - Lap`; as in steady flow where a viscous wave is much
    /// longer than the ball.
    fn unsteady_mobility(&self, _shift: f64, reach: f64) -> DMatrix<f64> {
        self.isolated_mobility(reach)
    }

    /// Writes in `out[mode * D + i]` the velocity that unit coefficients cause in unbounded fluid at `offset`, outside the ball.
    ///
    /// Its mean over `gamma` with the tractions is [`isolated_mobility`](Self::isolated_mobility); `reach` as there. Zero where near pairs
    /// are not looked at.
    fn exterior_velocity(&self, _offset: &[f64], _reach: f64, out: &mut [f64]) {
        out.fill(0.0);
    }

    /// Writes in `out[mode]` the pressure that unit coefficients cause in unbounded fluid at `offset`, outside the ball, zero far away; zero where near pairs
    /// are not looked at.
    fn exterior_pressure(&self, _offset: &[f64], out: &mut [f64]) {
        out.fill(0.0);
    }

    /// The modes, sorted by how they rotate; none where near pairs are not looked at.
    fn degrees(&self) -> Vec<Degree> {
        Vec::new()
    }

    /// Number of rigid modes: `D(D+1)/2`, or the constant of a scalar.
    fn rigid_count(&self) -> usize {
        if self.components() == 1 { 1 } else { self.dimension() * (self.dimension() + 1) / 2 }
    }

    /// Net force on the fluid of a unit translation coefficient: the [`area`].
    fn force_factor(&self) -> f64 {
        area(self.dimension(), self.radius())
    }

    /// Net torque on the fluid of a unit rotation coefficient: the area times the [`lever`].
    fn torque_factor(&self) -> f64 {
        self.force_factor() * lever(self.dimension(), self.radius())
    }
}

/// Area of a sphere, `4 pi a^2`, or length of a circle, `2 pi a`.
pub fn area(dimension: usize, radius: f64) -> f64 {
    match dimension {
        2 => 2.0 * PI * radius,
        _ => 4.0 * PI * radius.powi(2),
    }
}

/// Velocity of a rotation mode at unit spin: `a` on a circle, `a sqrt(2/3)` on a sphere.
pub fn lever(dimension: usize, radius: f64) -> f64 {
    match dimension {
        2 => radius,
        _ => radius * (2.0_f64 / 3.0).sqrt(),
    }
}
