//! The instantaneous solve: bodies where they are, the flow and their motions at that instant.

use std::time::Instant;

use nalgebra::SVector;

use super::{
    BodyState, Setup, Solution,
    closure::{Closure, flow_without_bodies},
    coupled::{Coupled, Member, Stages, Work},
    suspension::{Kinds, Suspension},
};
use crate::{
    error::{Error, Result},
    flow::{Drive, HypreInverse, Stokes, StokesInverse},
    grid::Grid,
    petsc::{Krylov, KrylovMethod, KrylovSettings, Report, Session, Vector},
};

/// Iterations allowed for the coupled system.
///
/// The restart is as long, so memory grows with the iterations made: a restart after 50 stalls where bodies crowd.
const MOST_ITERATIONS: usize = 1000;

/// What a solve cost on this rank, in seconds, and how it converged.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cost {
    /// Matrices and approximate inverses of the box, once per run.
    pub setup: f64,
    /// Jump corrections of the bodies.
    pub assembly: f64,
    /// The Krylov solver, everything included.
    pub krylov: Report,
    /// Parts of it.
    pub stages: Stages,
    /// Unknowns of the grid on all ranks.
    pub grid_unknowns: usize,
    /// Unknowns on surfaces on all ranks.
    pub multiplier_unknowns: usize,
}

/// A suspension ready to be solved.
pub struct Simulation<const D: usize> {
    session: Session,
    setup: Setup<D>,
    grid: Grid<D>,
    stokes: Stokes<D>,
    inverse: Box<dyn StokesInverse<D>>,
    closure: Closure,
    /// Flow of walls and drive without bodies, and the forces of the closure in it.
    undisturbed: (Vector, Vec<f64>),
    kinds: Kinds<D>,
    cost: Cost,
}

impl<const D: usize> Simulation<D> {
    /// Builds the machinery that a setup calls for.
    ///
    /// # Errors
    /// The grid or the rank count does not fit, or no steady state exists.
    pub fn new(session: &Session, setup: Setup<D>) -> Result<Simulation<D>> {
        Self::with_inverse(session, setup, |stokes, grid| Ok(Box::new(HypreInverse::new(stokes, grid)?)))
    }

    /// As [`new`](Self::new), with another approximate inverse of the fluid.
    ///
    /// # Errors
    /// The same, and those of making the inverse.
    pub fn with_inverse(
        session: &Session,
        setup: Setup<D>,
        inverse: impl FnOnce(&Stokes<D>, &Grid<D>) -> Result<Box<dyn StokesInverse<D>>>,
    ) -> Result<Simulation<D>> {
        let start = Instant::now();
        check_steady_state(&setup)?;
        let world = session.world();
        let grid = Grid::new(&setup.domain, setup.spacing, world.size(), world.rank())?;
        let stokes = Stokes::new(session, &grid)?;
        let mut inverse = inverse(&stokes, &grid)?;
        let closure = Closure::new(&setup.drive, &grid, &stokes, inverse.as_mut())?;
        let undisturbed = flow_without_bodies(&setup.drive, &grid, &stokes, inverse.as_mut(), &closure)?;
        let kinds = Kinds::new(&setup, &grid);
        let cost = Cost { setup: start.elapsed().as_secs_f64(), grid_unknowns: grid.fluid_unknowns(), ..Cost::default() };
        Ok(Simulation { session: session.clone(), setup, grid, stokes, inverse, closure, undisturbed, kinds, cost })
    }

    /// The grid.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// What is solved.
    pub fn setup(&self) -> &Setup<D> {
        &self.setup
    }

    /// What the last solve cost.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    /// Solves; `seen` is told each iteration and its relative residual.
    ///
    /// # Errors
    /// [`Error::Diverged`] when the tolerance is not reached.
    pub fn solve(&mut self, seen: &mut dyn FnMut(usize, f64)) -> Result<Solution<D>> {
        let start = Instant::now();
        let suspension = Suspension::new(&self.setup, &self.grid, &self.kinds, self.session.world().rank());
        let mut blocks = suspension.blocks(&self.session, &self.undisturbed.0)?;
        let uniform = self.imposed_mean_velocity();
        let background = |point: &SVector<f64, D>| uniform + self.setup.drive.background(point);
        let undisturbed = suspension.undisturbed(&mut blocks, &self.undisturbed.0, background)?;
        let members = suspension.members();
        self.cost.multiplier_unknowns = suspension.layout.unknowns();
        self.cost.assembly = start.elapsed().as_secs_f64();

        let prescribed_drag = prescribed_drag(&self.session, &members);
        let rhs = self.right_hand_side(&suspension.wanted_rows(&members, &undisturbed), prescribed_drag)?;
        let mut x = rhs.like()?;
        let mut work = Work::new(&self.stokes, undisturbed.len())?;
        let mut coupled = Coupled {
            stokes: &self.stokes,
            inverse: self.inverse.as_mut(),
            blocks: &mut blocks,
            members: &members,
            closure: &self.closure,
            prescribed_drag,
            work: &mut work,
        };
        let mut krylov = Krylov::new(&self.session, rhs.local()?.len(), c"coupled_", krylov_settings(self.setup.tolerance))?;
        self.cost.krylov = krylov.solve(&mut coupled, (&rhs, &mut x), seen)?;
        let mut velocities = coupled.velocity_on_surfaces(&x)?;
        velocities.iter_mut().zip(undisturbed).for_each(|(velocity, undisturbed)| *velocity += undisturbed);
        let (fluid, multipliers, tail) = coupled.parts(&x)?;
        self.cost.stages = work.stages;
        let states = suspension.states(&self.session, &velocities, &multipliers);
        self.solution(states, fluid, &tail)
    }

    /// The mean velocity that a fully periodic box is given; elsewhere the flow without bodies has it.
    fn imposed_mean_velocity(&self) -> SVector<f64, D> {
        match self.setup.drive {
            Drive::MeanVelocity(velocity) if self.setup.domain.fully_periodic() => velocity,
            _ => SVector::zeros(),
        }
    }

    fn right_hand_side(&self, wanted: &[f64], prescribed_drag: f64) -> Result<Vector> {
        let fluid = self.grid.local_fluid_unknowns();
        let tail = if self.session.world().rank() == 0 { self.closure.unknowns::<D>() } else { 0 };
        let mut rhs = Vector::new(&self.session, fluid + wanted.len() + tail)?;
        {
            let mut rows = rhs.local_mut()?;
            let (multipliers, tail) = rows[fluid..].split_at_mut(wanted.len());
            multipliers.copy_from_slice(wanted);
            if let Closure::MeanVelocity = self.closure {
                let total = -self.setup.drive.uniform_force() * self.setup.domain.volume() / self.setup.viscosity;
                tail.iter_mut().zip(total.iter()).for_each(|(row, force)| *row = force / prescribed_drag);
            }
        }
        Ok(rhs)
    }

    fn solution(&self, bodies: Vec<BodyState<D>>, mut fluid: Vector, tail: &[f64]) -> Result<Solution<D>> {
        fluid.add(1.0, &self.undisturbed.0)?;
        if self.setup.domain.fully_periodic() {
            let offset =
                if let Closure::MeanVelocity = self.closure { SVector::from_column_slice(tail) } else { self.imposed_mean_velocity() };
            let mut values = fluid.local_mut()?;
            for axis in 0..D {
                values[self.grid.local_range(axis)].iter_mut().for_each(|value| *value += offset[axis]);
            }
        }
        let pressure_gradient = self.pressure_gradient(&bodies, tail);
        let mean_velocity = self.mean_velocity(&fluid)?;
        Ok(Solution { bodies, fluid, mean_velocity, pressure_gradient })
    }

    fn mean_velocity(&self, fluid: &Vector) -> Result<SVector<f64, D>> {
        let values = fluid.local()?;
        let cells = self.grid.unknowns(D) as f64;
        // faces on walls carry no normal velocity: counting them changes nothing
        let mut mean = SVector::<f64, D>::from_fn(|axis, _| values[self.grid.local_range(axis)].iter().sum::<f64>() / cells);
        self.session.world().sum(mean.as_mut_slice());
        Ok(mean)
    }

    fn pressure_gradient(&self, bodies: &[BodyState<D>], tail: &[f64]) -> SVector<f64, D> {
        let mut gradient = SVector::zeros();
        match (&self.closure, self.setup.drive) {
            (_, Drive::PressureGradient(given)) => gradient = given,
            (_, Drive::BodyForce(_)) => {}
            (Closure::Forces(forces), _) => {
                for ((force, known), found) in forces.iter().zip(&self.undisturbed.1).zip(tail) {
                    gradient[force.axis] = -self.setup.viscosity * (known + found);
                }
            }
            // what the fluid does to the bodies, the mean pressure gradient does to the fluid
            _ if self.setup.domain.fully_periodic() => {
                let on_bodies: SVector<f64, D> = bodies.iter().map(|state| state.force).sum();
                gradient = -on_bodies / self.setup.domain.volume();
            }
            _ => {}
        }
        gradient
    }
}

fn check_steady_state<const D: usize>(setup: &Setup<D>) -> Result<()> {
    if setup.drive.leaves_mean_velocity_open(&setup.domain) && setup.bodies.iter().all(|suspended| suspended.body.free()) {
        return Err(Error::Refused(
            "flow.drive: under a uniform force a fully periodic box in which nothing is fixed has no steady flow; \
             fix a body, put up walls, or prescribe mean_velocity"
                .into(),
        ));
    }
    Ok(())
}

/// Sum over all prescribed bodies of the net force that a unit velocity takes by their preconditioner.
fn prescribed_drag(session: &Session, members: &[Member]) -> f64 {
    let mut drag = [members.iter().filter(|member| !member.free).map(|member| member.area * member.inverse[(0, 0)]).sum()];
    session.world().sum(&mut drag);
    if drag[0] > 0.0 { drag[0] } else { 1.0 }
}

fn krylov_settings(tolerance: f64) -> KrylovSettings {
    KrylovSettings { method: KrylovMethod::Gmres { restart: MOST_ITERATIONS }, tolerance, most_iterations: MOST_ITERATIONS }
}
