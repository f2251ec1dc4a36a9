//! Mean stress of a suspension in simple shear, as a tensor of parts.
//!
//! ```text
//! Sigma = -p I + 2 mu E + sum_i S_i / V - sum f r n n / V + sum_i L_i / 2 V
//! ```
//!
//! `p` is the mean pressure over the fluid, `E` the mean rate of strain, `S_i` the stresslets, `f` the forces of contacts between centres
//! a distance `r n` apart, `L_i` the couples that turn bodies from outside, as tensors of which `L_xy` is the torque from x to y. They make it
//! asymmetric. Between walls, whose mean shear stress is meant, a force `F` along them at a height `y` from the middle adds `-F y / V`. Stresslets have no
//! trace: that part of the stress is what bodies bear as pressure, `fraction (p - mean of the pressure inside bodies)`, as the inside of a rigid body is at
//! rest in the solution and bears the mean normal traction. Films add the pressure that the modes of two near bodies do not make inside of them.
//! All parts are over `mu rate` (Batchelor 1970, doi:10.1017/S0022112070000745; particle pressure: Jeffrey, Morris & Brady 1993,
//! doi:10.1063/1.858709).

use nalgebra::{SMatrix, SVector};

use super::{
    inertia::reynolds_stress,
    parts::{Part, Parts},
};
use crate::{
    contact::ContactForce,
    error::Result,
    geometry::Ball,
    grid::Grid,
    interaction::PairForce,
    mechanics::load_stress,
    observe::{fields::cells::visit_inside, shear::Shear},
    scene::ConstraintMethod,
    setup::Setup,
    system::{LubricationPressure, Solution},
};

/// Cells between the surface of a body and those whose pressure counts as that of its inside.
const DEPTH: f64 = 1.5;

/// Mean stress over `mu rate`, without the mean pressure of the fluid; tension is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stress<const D: usize> {
    /// Its parts; that of the flow has the trace of stresslets if it is known.
    pub parts: Parts<SMatrix<f64, D, D>>,
    /// Whether the trace of the hydrodynamic part is known.
    pub with_trace: bool,
}

/// Differences and mean of the normal stresses of all parts or of one, over `mu rate`; tension is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalStresses {
    /// Along the flow less along the gradient.
    pub first: f64,
    /// Along the gradient less along the vorticity, in three dimensions.
    pub second: Option<f64>,
    /// Pressure that bodies bear beyond that of the fluid, positive where they push apart; nothing where the trace of their stresslets is not known.
    pub pressure: Option<f64>,
}

impl<const D: usize> Stress<D> {
    /// Of a solution with the contacts between bodies; collective.
    ///
    /// # Errors
    /// PETSc fails.
    pub(super) fn of(
        setup: &Setup<D>,
        grid: &Grid<D>,
        solution: &Solution<D>,
        contacts: &[ContactForce<D>],
        shear: &Shear<D>,
    ) -> Result<Stress<D>> {
        let unit = setup.viscosity * shear.rate * setup.domain.volume();
        let stresslets: SMatrix<f64, D, D> = solution.bodies.iter().map(|state| state.stresslet).sum();
        let rubs = setup.interactions.friction().is_some_and(|friction| friction.coefficient > 0.0);
        let (moments, rubbed) = (normal_moments(contacts), tangential_stress(contacts));
        let films = solution.lubrication.map(|lubrication| lubrication.stress);
        let at_a_distance = [solution.pair_stress, load_stress(setup, solution, shear.flow, shear.gradient)]
            .into_iter()
            .flatten()
            .reduce(|sum, part| sum + part);
        let resolved = stresslets - films.unwrap_or_else(SMatrix::zeros);
        let pressure = pressure_on_bodies(setup, grid, solution)?;
        let touch = setup.interactions.touch().is_some() || !contacts.is_empty();
        // what there is and does nothing yet has no stress, which is a number
        let of_all = |there: bool, stress: Option<SMatrix<f64, D, D>>| stress.or(there.then(SMatrix::zeros)).map(|stress| stress / unit);
        let pressure_of = |films: LubricationPressure| beyond_fluid(films.inside, films.everywhere, setup.fraction());
        let trace = SMatrix::identity() * (pressure.unwrap_or(0.0) / shear.rate);
        let carried_along = reynolds_stress(setup, grid, solution, shear)?;
        let parts = Parts::of(|part| match part {
            Part::Hydrodynamic => Some(shear.doubled_strain() + resolved / unit - trace),
            Part::Lubrication => {
                solution.lubrication.map(|films| (films.stress - SMatrix::identity() * pressure_of(films.pressure)) / unit)
            }
            Part::Interaction => of_all(setup.interactions.act_at_a_distance(), at_a_distance),
            Part::Bonds => of_all(setup.interactions.tie(), solution.bond_stress),
            Part::Reynolds => carried_along.map(|stress| stress / unit),
            Part::Contact => touch.then(|| -moments / unit),
            Part::Friction => rubs.then(|| rubbed / unit),
        });
        Ok(Stress { parts, with_trace: pressure.is_some() })
    }

    /// The sum of all parts.
    pub fn total(&self) -> SMatrix<f64, D, D> {
        self.parts.total()
    }

    /// The normal stresses of all parts in a shear.
    pub(super) fn normal(&self, shear: &Shear<D>) -> NormalStresses {
        normal_stresses(&self.total(), shear, self.with_trace)
    }

    /// Those of each part, of which only that of the flow may have an unknown trace.
    pub(super) fn normal_parts(&self, shear: &Shear<D>) -> Parts<NormalStresses> {
        let of = |part: Part, stress| normal_stresses(&stress, shear, self.with_trace || part != Part::Hydrodynamic);
        Parts::of(|part| self.parts.get(part).map(|stress| of(part, stress)))
    }
}

/// The sum of the moments of forces along normals.
fn normal_moments<const D: usize>(contacts: &[ContactForce<D>]) -> SMatrix<f64, D, D> {
    let moment = |active: &ContactForce<D>| {
        let normal = active.contact.normal;
        normal * normal.transpose() * (active.force * active.contact.separation)
    };
    contacts.iter().map(moment).sum()
}

/// The sum of the stresses of tangential forces and couples.
fn tangential_stress<const D: usize>(contacts: &[ContactForce<D>]) -> SMatrix<f64, D, D> {
    let along = |active: &ContactForce<D>| PairForce { contact: active.contact, force: active.tangential, torques: [SMatrix::zeros(); 2] };
    contacts.iter().map(|active| along(active).stress() + active.stress_of_couple()).sum()
}

/// The normal stresses of a stress in a shear; without a pressure if its trace is not known.
fn normal_stresses<const D: usize>(stress: &SMatrix<f64, D, D>, shear: &Shear<D>, with_trace: bool) -> NormalStresses {
    let along = |direction: &SVector<f64, D>| (direction.transpose() * stress * direction)[0];
    let (flow, gradient) = (along(&shear.flow), along(&shear.across()));
    NormalStresses {
        first: flow - gradient,
        second: (D == 3).then(|| gradient - (stress.trace() - flow - gradient)),
        pressure: with_trace.then(|| -stress.trace() / D as f64),
    }
}

/// The particle pressure of the flow over viscosity, `fraction (mean inside - mean over the fluid)`; nothing where the solver has no pressure inside.
fn pressure_on_bodies<const D: usize>(setup: &Setup<D>, grid: &Grid<D>, solution: &Solution<D>) -> Result<Option<f64>> {
    // meshes have no inside, and multipliers at points inside leave its pressure open
    if !matches!(setup.constraint, ConstraintMethod::Sharp | ConstraintMethod::Penalty(_)) {
        return Ok(None);
    }
    let depth = DEPTH * grid.mean_spacing();
    let bodies = setup.bodies.iter().zip(&solution.bodies);
    let balls: Vec<Ball<D>> =
        bodies.map(|(suspended, state)| Ball { center: state.center, radius: suspended.body.ball.radius - depth }).collect();
    let sums = inside_sums(grid, &balls, solution)?;
    let inside = sums.chunks(2).zip(&setup.bodies).map(|(sum, suspended)| suspended.body.ball.volume() * sum[0] / sum[1]);
    let (borne, fraction) = (inside.sum::<f64>() / setup.domain.volume(), setup.fraction());
    let everywhere = mean_pressure(grid, solution)?;
    Ok(Some(beyond_fluid(borne, everywhere, fraction)))
}

/// `fraction (mean inside - mean over the fluid)` from what bodies, which fill a fraction of the box, bear inside and the mean over the whole box.
fn beyond_fluid(inside: f64, everywhere: f64, fraction: f64) -> f64 {
    (inside - fraction * everywhere) / (1.0 - fraction)
}

/// Sum of the pressures of the cells in each ball, and their number.
fn inside_sums<const D: usize>(grid: &Grid<D>, balls: &[Ball<D>], solution: &Solution<D>) -> Result<Vec<f64>> {
    let (values, mut sums) = (solution.fluid.local()?, vec![0.0; 2 * balls.len()]);
    let pressures = &values[grid.local_range(D)];
    visit_inside(grid, balls, |ball, cell| {
        sums[2 * ball] += pressures[cell];
        sums[2 * ball + 1] += 1.0;
    });
    drop(values);
    if !sums.is_empty() {
        solution.fluid.session().world().sum(&mut sums);
    }
    Ok(sums)
}

fn mean_pressure<const D: usize>(grid: &Grid<D>, solution: &Solution<D>) -> Result<f64> {
    let mut sum = [solution.fluid.local()?[grid.local_range(D)].iter().sum::<f64>()];
    solution.fluid.session().world().sum(&mut sum);
    Ok(sum[0] / grid.unknowns(D) as f64)
}
