//! Random suspensions at an instant: means over configurations, each with the scatter that such a mean has.

use std::f64::consts::PI;

use nalgebra::SVector;

use super::{Case, free, measured_viscosity, setup, suspended};
use crate::{
    body::equilibrium,
    error::Result,
    flow::{Drive, InverseMethod},
    geometry::{Axis, Domain},
    interaction::{Interactions, Lubrication},
    petsc::Session,
    scene::Tolerance,
    simulation::Setup,
};

/// Smallest gap in radii.
const GAP: f64 = 0.02;

/// Gap in radii below which films do not change: below the smallest there is.
const ROUGHNESS: f64 = 1e-4;

/// Residual far below the scatter.
const TOLERANCE: f64 = 1e-5;

const EQUILIBRIUM: &str = "equilibrium disks, 40 configurations, exact series";

/// A number of bodies at a fraction, on a grid.
#[derive(Clone, Copy)]
struct Ensemble {
    fraction: f64,
    bodies: usize,
    configurations: u64,
    cells_per_radius: f64,
    order: usize,
}

/// All cases; tolerances are three times the scatter of the mean of these configurations and that of the reference together.
pub fn cases() -> Vec<Case> {
    let disks = |fraction, configurations| Ensemble { fraction, bodies: 64, configurations, cells_per_radius: 5.0, order: 3 };
    let spheres = |fraction| Ensemble { fraction, bodies: 27, configurations: 8, cells_per_radius: 4.0, order: 2 };
    vec![
        case::<2>("viscosity, random disks 0.05", EQUILIBRIUM, disks(0.05, 16), (1.10962, 1.5e-3)),
        case::<2>("viscosity, random disks 0.3", EQUILIBRIUM, disks(0.3, 32), (2.177, 2e-2)),
        second_order::<2>("second-order coefficient, random disks 0.1", EQUILIBRIUM, disks(0.1, 32), (4.18, 0.1)),
        case::<3>("viscosity, random spheres 0.1", "Ladd 1990, two digits", spheres(0.1), (1.32, 2e-2)),
    ]
}

fn case<const D: usize>(name: &'static str, source: &'static str, ensemble: Ensemble, (reference, tolerance): (f64, f64)) -> Case {
    let solve = move |session: &Session| ensemble.mean::<D>(session);
    Case { name, source, resolution: ensemble.text::<D>(), reference, tolerance, solve: Box::new(solve) }
}

/// `(viscosity - 1 - (D + 2) / 2 fraction) / fraction^2`.
fn second_order<const D: usize>(name: &'static str, source: &'static str, ensemble: Ensemble, (reference, tolerance): (f64, f64)) -> Case {
    let fraction = ensemble.fraction;
    let dilute = 1.0 + 0.5 * (D + 2) as f64 * fraction;
    let solve = move |session: &Session| Ok((ensemble.mean::<D>(session)? - dilute) / fraction.powi(2));
    Case { name, source, resolution: ensemble.text::<D>(), reference, tolerance, solve: Box::new(solve) }
}

impl Ensemble {
    fn text<const D: usize>(&self) -> String {
        let Ensemble { bodies, configurations, cells_per_radius, order, .. } = self;
        let letter = if D == 2 { "K" } else { "L" };
        format!("{configurations} times {bodies} bodies, a/h = {cells_per_radius}, {letter} = {order}")
    }

    /// Mean viscosity of its configurations.
    fn mean<const D: usize>(&self, session: &Session) -> Result<f64> {
        let mut sum = 0.0;
        for seed in 1..=self.configurations {
            sum += measured_viscosity(session, session.world().agree(self.configuration::<D>(seed))?)?.relative();
        }
        Ok(sum / self.configurations as f64)
    }

    fn configuration<const D: usize>(&self, seed: u64) -> Result<Setup<D>> {
        let unit = if D == 2 { PI } else { 4.0 * PI / 3.0 };
        let radius = (self.fraction / (unit * self.bodies as f64)).powf(1.0 / D as f64);
        let domain = Domain { size: SVector::repeat(1.0), axes: [Axis::Periodic; D] };
        let centers = equilibrium(&domain, &vec![radius; self.bodies], GAP, seed)?;
        let bodies = centers.into_iter().map(|center| suspended(center, radius, free(), self.order)).collect();
        let setup = setup(1.0, [Axis::Periodic; D], radius / self.cells_per_radius, Drive::Shear(1.0), bodies);
        Ok(Setup {
            inverse: InverseMethod::Transform,
            tolerance: Tolerance::Fixed(TOLERANCE),
            interactions: Interactions::default().with(Lubrication::new(ROUGHNESS)),
            ..setup
        })
    }
}
