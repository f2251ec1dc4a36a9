//! What the jump of a flow that changes has beyond the jump functions of steady flow.
//!
//! Outside a body the flow obeys `du/dt = nu Lap u - grad p / rho`, inside it accelerates as a rigid motion, which the jump of a spin-up is for. So jumps of tangential velocities
//! obey `nu Lap D = dD/dt`; to the third order in the distance `n` from the surface, with the tangential traction `F`,
//!
//! ```text
//! D = - F n / mu + .. - (dF/dt) n^3 / (6 mu nu)
//! ```
//!
//! Without the second part interpolation on a surface errs by several per cent where a layer is a cell thick. Rates of change are the differences of means of multipliers over
//! two times of diffusion, in which the noise of steps in which a surface clears points is small.

use nalgebra::SVector;

use super::{bodies::BodyTypes, level::Level};
use crate::surface::Modes;

/// Memories of two means of multipliers, over the time in which viscosity passes a cell: of jump functions, and of a longer one whose distance from it tells the rate of change.
/// Disks that a stream carries by half a cell a step are stable from memories of 0.03 on, at 0.01 they are not.
pub const OF_JUMPS: f64 = 0.125;
pub const OF_RATES: f64 = 1.0;

/// What a jump has beyond that of steady flow, for one body.
pub struct UnsteadyJump<const D: usize> {
    radius: f64,
    /// Of the traction by whose tangential part times the cube of the distance the jump grows.
    coefficients: Vec<f64>,
}

impl<const D: usize> Level<D> {
    /// Rates of change of the multipliers of a body, times the time in which viscosity passes a cell.
    fn rates(&self, body: usize) -> impl Iterator<Item = f64> {
        self.smooth[body].iter().zip(&self.lagging[body]).map(|(smooth, lagging)| (smooth - lagging) / (OF_RATES - OF_JUMPS))
    }

    /// Multipliers of a body as jump functions take them: means that their rates of change bring up to the time of this level.
    pub fn of_jumps(&self, body: usize) -> Vec<f64> {
        self.smooth[body].iter().zip(self.rates(body)).map(|(smooth, rate)| smooth + OF_JUMPS * rate).collect()
    }

    /// What the jump of a body has beyond that of steady flow; nothing where multipliers do not change.
    pub fn unsteady_jump(&self, body_types: &BodyTypes<D>, body: usize) -> Option<UnsteadyJump<D>> {
        let factor = 1.0 / (6.0 * body_types.spacing().powi(2));
        let coefficients: Vec<f64> = self.rates(body).map(|rate| factor * rate).collect();
        let changes = coefficients.iter().any(|change| *change != 0.0);
        changes.then(|| UnsteadyJump { radius: body_types.surface(body).modes.radius(), coefficients })
    }
}

impl<const D: usize> UnsteadyJump<D> {
    /// Adds a component of it to jumps at offsets from the centre.
    pub fn add(&self, modes: &dyn Modes, offsets: &[f64], component: usize, jumps: &mut [f64]) {
        let mut tractions = vec![0.0; self.coefficients.len() * D];
        for (jump, offset) in jumps.iter_mut().zip(offsets.chunks_exact(D)) {
            let offset = SVector::<f64, D>::from_column_slice(offset);
            let (distance, normal) = (offset.norm(), offset.normalize());
            modes.traction(normal.as_slice(), &mut tractions);
            let units = tractions.chunks_exact(D).map(SVector::<f64, D>::from_column_slice);
            let traction: SVector<f64, D> = units.zip(&self.coefficients).map(|(unit, coefficient)| unit * *coefficient).sum();
            *jump -= (traction - normal * traction.dot(&normal))[component] * (distance - self.radius).powi(3);
        }
    }
}
