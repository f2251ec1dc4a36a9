//! Modes with the jumps of a body that spins up besides.
//!
//! Inside a body whose spin changes, fluid that moves along needs the force `rho w' x r` per volume, which no pressure bears; so the Laplacian of
//! the velocity jumps by `-(rho w' / mu) x r` across the surface, and with `s = rho w' / mu`
//!
//! ```text
//! D_u = g(r) s x r,   g'' + (D + 1)/r g' = 1,   g = g' = 0 on the surface
//! g = (r^2 - a^2)^2 / (8 r^2) in 2D,   r^2/10 - a^2/6 + a^5/(15 r^3) in 3D
//! ```

use nalgebra::DMatrix;

use super::{Degree, Modes};

/// Modes whose jump functions have those of unit spin-ups `s` behind them: one in 2D, three in 3D.
pub struct WithSpinUp(pub Box<dyn Modes>);

impl WithSpinUp {
    fn factor(&self, square: f64) -> f64 {
        let a = self.0.radius();
        match self.0.dimension() {
            2 => (square - a * a).powi(2) / (8.0 * square),
            _ => square / 10.0 - a * a / 6.0 + a.powi(5) / (15.0 * square * square.sqrt()),
        }
    }
}

/// A component of `e x r` for the unit spin `e` of a plane: the counter-clockwise one in 2D, the axes in 3D.
pub fn unit_rotation(plane: usize, offset: &[f64], component: usize) -> f64 {
    match offset {
        [x, y] => [-y, *x][component],
        _ => match (component + 3 - plane) % 3 {
            1 => -offset[(plane + 2) % 3],
            2 => offset[(plane + 1) % 3],
            _ => 0.0,
        },
    }
}

/// The rows of so many points.
fn rows(points: usize, out: &mut [f64]) -> impl Iterator<Item = &mut [f64]> {
    let stride = out.len().checked_div(points).unwrap_or(0).max(1);
    out.chunks_exact_mut(stride).take(points)
}

impl Modes for WithSpinUp {
    fn dimension(&self) -> usize {
        self.0.dimension()
    }

    fn radius(&self) -> f64 {
        self.0.radius()
    }

    fn count(&self) -> usize {
        self.0.count()
    }

    fn traction(&self, direction: &[f64], out: &mut [f64]) {
        self.0.traction(direction, out);
    }

    fn velocity_jumps(&self, offsets: &[f64], component: usize, out: &mut [f64]) {
        self.0.velocity_jumps(offsets, component, out);
        let (count, dimension) = (self.count(), self.dimension());
        for (offset, row) in offsets.chunks_exact(dimension).zip(rows(offsets.len() / dimension, out)) {
            let factor = self.factor(offset.iter().map(|x| x * x).sum());
            let spin_ups = row[count..self.jump_count()].iter_mut().enumerate();
            spin_ups.for_each(|(plane, jump)| *jump = factor * unit_rotation(plane, offset, component));
        }
    }

    fn pressure_jumps(&self, offsets: &[f64], out: &mut [f64]) {
        self.0.pressure_jumps(offsets, out);
        rows(offsets.len() / self.dimension(), out).for_each(|row| row[self.count()..self.jump_count()].fill(0.0));
    }

    fn jump_count(&self) -> usize {
        self.count() + self.dimension() * (self.dimension() - 1) / 2
    }

    fn isolated_mobility(&self, reach: f64) -> DMatrix<f64> {
        self.0.isolated_mobility(reach)
    }

    fn unsteady_mobility(&self, shift: f64, reach: f64) -> DMatrix<f64> {
        self.0.unsteady_mobility(shift, reach)
    }

    fn exterior_velocity(&self, offset: &[f64], reach: f64, out: &mut [f64]) {
        self.0.exterior_velocity(offset, reach, out);
    }

    fn exterior_pressure(&self, offset: &[f64], out: &mut [f64]) {
        self.0.exterior_pressure(offset, out);
    }

    fn degrees(&self) -> Vec<Degree> {
        self.0.degrees()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{Fourier, Spherical};

    /// `Lap D = e x r`, and nothing jumps on the surface.
    #[test]
    fn the_jump_of_a_spin_up_has_its_laplacian() {
        let (step, planar, spatial) = (1e-3, WithSpinUp(Box::new(Fourier::new(0.7, 2))), WithSpinUp(Box::new(Spherical::new(0.7, 2))));
        for (modes, place) in [(&planar, &[0.5, 0.6][..]), (&spatial, &[0.4, -0.5, 0.3][..])] {
            let dimension = place.len();
            for plane in 0..modes.jump_count() - modes.count() {
                for component in 0..dimension {
                    let jump = |offset: &[f64]| {
                        let mut out = vec![0.0; modes.jump_count()];
                        modes.velocity_jumps(offset, component, &mut out);
                        out[modes.count() + plane]
                    };
                    let along = |axis: usize, way: f64| {
                        let mut moved = place.to_vec();
                        moved[axis] += way;
                        jump(&moved)
                    };
                    let laplacian: f64 =
                        (0..dimension).map(|axis| (along(axis, step) + along(axis, -step) - 2.0 * jump(place)) / (step * step)).sum();
                    let wanted = unit_rotation(plane, place, component);
                    assert!((laplacian - wanted).abs() < 1e-4, "{laplacian} for {wanted}");
                    let length = place.iter().map(|x| x * x).sum::<f64>().sqrt();
                    let on_surface: Vec<f64> = place.iter().map(|x| x * 0.7 / length).collect();
                    assert!(jump(&on_surface).abs() < 1e-14);
                }
            }
        }
    }
}
