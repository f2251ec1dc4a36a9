//! The Stokes equations for one wave on a line from wall to wall.
//!
//! With `g` the factors of the discrete gradient of the wave, `k = |g|`, `A` and `N` minus the second differences of tangential
//! and normal velocities between the walls (the former vanish half a cell beyond their outermost points), `d` the first difference
//! from centres to faces and `d'` the one back, the part `u = conj(g) . u_t / k` of the tangential velocity `u_t`, the normal
//! velocity `v` and the pressure solve the real system
//!
//! ```text
//! (A + k^2 + s) u + k b p = r_u,   (N + k^2 + s) v + d p = r_v,   -k u + d' v = r_p
//! ```
//!
//! with the shift `s` of a flow with inertia, `b` what is left of the pressure's gradient beside walls (see [`gradient`](crate::grid::stencil::gradient)), 1 elsewhere;
//! and the part of the tangential velocity across `g` diffuses by itself. Momentum rows are multiplied by the square of the spacing
//! `s`, continuity rows by `s`, so that all entries are of the order of one; the unknown that goes with them is `s p`.

use rustfft::num_complex::Complex;

use crate::{
    grid::stencil::BESIDE_WALL,
    linalg::{Banded, Tridiagonal},
};

type Coupled = Banded<3, 7>;

/// Solver for the waves of one number.
pub struct WallToWall {
    /// Of the points.
    spacing: f64,
    number: f64,
    shift: f64,
    /// Velocity along the wave, normal velocity and pressure; nothing without a wave, where all three are sums.
    coupled: Option<Coupled>,
    /// Tangential velocity across the wave; any one without a wave.
    diffusion: Tridiagonal,
}

/// The values of all fields on a line; those of the velocity along the walled axis start on the lower wall.
pub struct Fields<'a> {
    /// Line after line.
    pub values: &'a mut [Complex<f64>],
    /// From a field to the next.
    pub step: usize,
    /// The axis from wall to wall.
    pub walled: usize,
}

/// Room for the unknowns of a line.
pub struct LineWorkspace {
    /// Normal velocity, velocity along the wave and pressure in turn.
    coupled: Vec<Complex<f64>>,
    across: Vec<Complex<f64>>,
}

impl LineWorkspace {
    /// For lines of `points` points.
    pub fn new(points: usize) -> LineWorkspace {
        LineWorkspace { coupled: vec![Complex::default(); 3 * points + Coupled::PADDING], across: vec![Complex::default(); points] }
    }
}

impl WallToWall {
    /// Solver for waves of a `number` on lines of `points` cells with a `spacing`.
    pub fn new((points, spacing): (usize, f64), number: f64, shift: f64) -> WallToWall {
        let (scaled, edge) = (spacing * number, |point: usize| point == 0 || point == points - 1);
        let decay = scaled * scaled + shift * spacing * spacing;
        let diagonal = |point: usize| decay + if edge(point) { 3.0 } else { 2.0 };
        let coupled = (number > 0.0).then(|| Coupled::new(3 * points, |row, column| entry((scaled, decay), edge, row, column)));
        let diffusion = Tridiagonal::new((0..points).map(diagonal));
        WallToWall { spacing, number, shift, coupled, diffusion }
    }

    /// Replaces the rows of a wave with the given factors by the solution.
    pub fn solve<const D: usize>(&self, factors: &[Complex<f64>; D], fields: &mut Fields, work: &mut LineWorkspace) {
        let Some(coupled) = &self.coupled else { return self.solve_mean::<D>(fields) };
        let along = factors.map(|factor| factor / self.number);
        let across = across(&along, fields.walled);
        self.take(&along, &across, fields, work);
        coupled.solve(&mut work.coupled);
        if D > 2 {
            self.diffusion.solve(&mut work.across);
        }
        self.put(&along, &across, fields, work);
    }

    /// Scales the rows and turns those of tangential velocities.
    fn take<const D: usize>(&self, along: &[Complex<f64>; D], across: &[Complex<f64>; D], fields: &Fields, work: &mut LineWorkspace) {
        let square = self.spacing * self.spacing;
        for (point, (coupled, turned)) in work.coupled.as_chunks_mut::<3>().0.iter_mut().zip(&mut work.across).enumerate() {
            let (mut first, mut second) = (Complex::default(), Complex::default());
            for axis in 0..D {
                let row = fields.values[axis * fields.step + point];
                first += along[axis].conj() * row;
                second += across[axis].conj() * row;
            }
            let normal = fields.values[fields.walled * fields.step + point];
            *coupled = [normal * square, first * square, fields.values[D * fields.step + point] * self.spacing];
            *turned = second * square;
        }
        work.coupled[0] = Complex::default();
    }

    fn put<const D: usize>(&self, along: &[Complex<f64>; D], across: &[Complex<f64>; D], fields: &mut Fields, work: &LineWorkspace) {
        for (point, ([normal, first, pressure], second)) in work.coupled.as_chunks::<3>().0.iter().zip(&work.across).enumerate() {
            for axis in 0..D {
                fields.values[axis * fields.step + point] = along[axis] * first + across[axis] * second;
            }
            fields.values[fields.walled * fields.step + point] = *normal;
            fields.values[D * fields.step + point] = pressure / self.spacing;
        }
    }

    /// Without a wave continuity rows give the normal velocity from wall to wall (they must have no mean), then its momentum
    /// rows the pressure but for its mean.
    fn solve_mean<const D: usize>(&self, fields: &mut Fields) {
        let (square, points) = (self.spacing * self.spacing, self.diffusion.size());
        for axis in (0..D).filter(|&axis| axis != fields.walled) {
            let line = &mut fields.values[axis * fields.step..][..points];
            line.iter_mut().for_each(|value| *value *= square);
            self.diffusion.solve(line);
        }
        let (velocities, pressures) = fields.values.split_at_mut(D * fields.step);
        let normal = &mut velocities[fields.walled * fields.step..][..points];
        let pressures = &mut pressures[..points];
        remove_mean(pressures);
        self.sum_up(normal, pressures);
        remove_mean(pressures);
    }

    /// Turns rows of the normal velocity and of continuity into the normal velocity and the pressure, which starts with zero.
    fn sum_up(&self, normal: &mut [Complex<f64>], pressures: &mut [Complex<f64>]) {
        let (mut before, mut velocity, mut pressure) = (Complex::default(), Complex::default(), Complex::default());
        for (point, (value, source)) in normal.iter_mut().zip(pressures).enumerate() {
            let after = velocity + *source * self.spacing;
            // on the wall there is no row
            if point > 0 {
                let drag = (velocity * 2.0 - before - after) / self.spacing + velocity * self.shift * self.spacing;
                pressure += *value * self.spacing - drag;
            }
            *value = velocity;
            *source = pressure;
            (before, velocity) = (velocity, after);
        }
    }
}

/// The direction at right angles to that of the wave and to the walled axis; none in two dimensions.
fn across<const D: usize>(along: &[Complex<f64>; D], walled: usize) -> [Complex<f64>; D] {
    let mut across = [Complex::default(); D];
    if D == 3 {
        let (first, second) = ((walled + 1) % D, (walled + 2) % D);
        (across[first], across[second]) = (-along[second].conj(), along[first].conj());
    }
    across
}

fn remove_mean(values: &mut [Complex<f64>]) {
    let mean = values.iter().sum::<Complex<f64>>() / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
}

/// An entry of the coupled matrix; rows and columns are normal velocity, velocity along the wave and pressure of a cell in turn. `decay` is what a
/// wave of this number and the shift add to the diagonal.
fn entry((number, decay): (f64, f64), edge: impl Fn(usize) -> bool, row: usize, column: usize) -> f64 {
    // the normal velocity on the lower wall is no unknown
    if row == 0 || column == 0 {
        return if row == column { 1.0 } else { 0.0 };
    }
    match (row % 3, column % 3, (column / 3) as isize - (row / 3) as isize) {
        (0, 0, 0) => 2.0 + decay,
        (1, 1, 0) => decay + if edge(row / 3) { 3.0 } else { 2.0 },
        (0, 0, -1 | 1) | (1, 1, -1 | 1) | (0, 2, -1) | (2, 0, 0) => -1.0,
        (0, 2, 0) | (2, 0, 1) => 1.0,
        (1, 2, 0) => number * if edge(row / 3) { BESIDE_WALL } else { 1.0 },
        (2, 1, 0) => -number,
        _ => 0.0,
    }
}
