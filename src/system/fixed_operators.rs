//! What no body changes: box, grid, fluid, the flow without bodies, and what bodies of equal size share.

use std::rc::Rc;

use nalgebra::SVector;

use super::{
    bodies::BodyTypes,
    mean_flow_constraint::{MeanFlowConstraint, flow_without_bodies},
};
use crate::{
    constraint::FlowMethod,
    contact::Contact,
    error::{Error, Result},
    flow::{Drive, Stokes, StokesInverse},
    geometry::Domain,
    grid::Grid,
    petsc::{Session, Vector},
    setup::{Setup, SuspendedBody},
    system::{BodyState, Cost, Solution, WallForces},
};

/// The constant part of a suspension.
pub struct FixedOperators<const D: usize> {
    /// The session.
    pub session: Session,
    /// What is solved.
    pub setup: Setup<D>,
    /// The grid.
    pub grid: Grid<D>,
    /// The fluid.
    pub stokes: Stokes<D>,
    /// Mean values that the drive leaves open.
    pub mean_flow: MeanFlowConstraint,
    /// Flow of walls and drive without bodies, if it is not zero, and the forces of the mean-flow constraint in it.
    pub undisturbed: (Option<Vector>, Vec<f64>),
    /// What makes bodies rigid.
    pub method: Rc<FlowMethod<D>>,
    /// Types of bodies.
    pub body_types: BodyTypes<D>,
    /// Whether the fluid is eliminated from the linear system, because its inverse is exact.
    pub condensed: bool,
    /// Known spin-ups `rho w' / mu` of all bodies; none without inertia.
    pub spin_ups: Vec<Vec<f64>>,
    /// Balanced rows of the fluid, where they are not in the flow without bodies: with inertia, unless the fluid is eliminated.
    pub fluid_rows: Option<Vector>,
}

/// What has changed in a box from one time to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turned {
    /// Nothing.
    Nothing,
    /// How fast walls or images move.
    Velocities,
    /// Where images are.
    Images,
}

impl<const D: usize> FixedOperators<D> {
    /// Builds matrices and the flow without bodies.
    ///
    /// # Errors
    /// The grid or the rank count does not fit, or no steady state exists.
    pub fn new(
        session: &Session,
        setup: Setup<D>,
        inverse: impl FnOnce(&Stokes<D>, &Grid<D>) -> Result<Box<dyn StokesInverse<D>>>,
    ) -> Result<(FixedOperators<D>, Box<dyn StokesInverse<D>>)> {
        check_steady_state(&setup)?;
        let world = session.world();
        let grid = setup.grid(world.size(), world.rank())?;
        let stokes = Stokes::new(session, &grid);
        let mut inverse = inverse(&stokes, &grid)?;
        let mean_flow = MeanFlowConstraint::new(&setup.drive, &grid, &stokes, inverse.as_mut())?;
        let undisturbed = flow_without_bodies(&setup.drive, setup.viscosity, &grid, &stokes, inverse.as_mut(), &mean_flow)?;
        let (method, body_types, condensed) = (setup.method(0.0), BodyTypes::new(&setup, &grid), inverse.exact());
        let fixed = FixedOperators {
            session: session.clone(),
            setup,
            grid,
            stokes,
            mean_flow,
            undisturbed,
            method,
            body_types,
            condensed,
            spin_ups: Vec::new(),
            fluid_rows: None,
        };
        Ok((fixed, inverse))
    }

    /// What is known of a flow with inertia before its first step: no operator has a shift yet.
    ///
    /// # Errors
    /// The grid or the rank count does not fit.
    pub fn at_rest(session: &Session, setup: Setup<D>) -> Result<FixedOperators<D>> {
        let world = session.world();
        let grid = setup.grid(world.size(), world.rank())?;
        let stokes = Stokes::new(session, &grid);
        let flow = if grid.domain().fully_periodic() { None } else { Some(stokes.vector()?) };
        let undisturbed = (flow, Vec::new());
        let (method, body_types, condensed) = (setup.method(0.0), BodyTypes::new(&setup, &grid), setup.inverts_exactly());
        let (session, mean_flow) = (session.clone(), MeanFlowConstraint::Closed);
        let (spin_ups, fluid_rows) = (Vec::new(), None);
        Ok(FixedOperators { session, setup, grid, stokes, mean_flow, undisturbed, method, body_types, condensed, spin_ups, fluid_rows })
    }

    /// Turns to the operator with a shift, and sets up its inverse.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn shift_to(&mut self, shift: f64) -> Result<Box<dyn StokesInverse<D>>> {
        self.stokes = match self.stokes.grid().lies_as(&self.grid) {
            true => self.stokes.with_shift(shift),
            false => Stokes::shifted(&self.session, &self.grid, shift),
        };
        self.body_types.answer_to(&self.setup, shift);
        self.method = self.setup.method(shift);
        let mut inverse = self.setup.inverse_of(&self.stokes, &self.grid)?;
        self.mean_flow = MeanFlowConstraint::new(&self.setup.drive, &self.grid, &self.stokes, inverse.as_mut())?;
        Ok(inverse)
    }

    /// Turns to the box of another time: images slide, for which the inverse of the fluid is set up anew, and walls change their velocity, for which the flow
    /// without bodies is found anew. Says what has changed.
    ///
    /// # Errors
    /// Images would be displaced by a part of a cell, or the inverse cannot be set up.
    pub fn turn_to(&mut self, domain: Domain<D>, inverse: &mut Box<dyn StokesInverse<D>>) -> Result<Turned> {
        let turned = self.turn_grid(domain)?;
        if turned == Turned::Images {
            self.stokes = Stokes::new(&self.session, &self.grid);
            *inverse = self.setup.inverse_of(&self.stokes, &self.grid)?;
        }
        if turned != Turned::Nothing {
            let Setup { drive, viscosity, .. } = &self.setup;
            self.undisturbed = flow_without_bodies(drive, *viscosity, &self.grid, &self.stokes, inverse.as_mut(), &self.mean_flow)?;
        }
        Ok(turned)
    }

    /// Turns given motions, and a drive that changes, to those of a time, and finds the flow without bodies anew for another drive. Says whether it is another one.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn prescribe(&mut self, time: f64, inverse: &mut dyn StokesInverse<D>) -> Result<bool> {
        let before = self.setup.drive;
        self.setup.prescribe(time);
        let Setup { drive, viscosity, .. } = &self.setup;
        if *drive == before {
            return Ok(false);
        }
        self.undisturbed = flow_without_bodies(drive, *viscosity, &self.grid, &self.stokes, inverse, &self.mean_flow)?;
        Ok(true)
    }

    /// Turns the box and the grid alone to those of another time.
    ///
    /// # Errors
    /// Images would be displaced by a part of a cell.
    pub fn turn_grid(&mut self, domain: Domain<D>) -> Result<Turned> {
        if domain == self.setup.domain {
            return Ok(Turned::Nothing);
        }
        let slid = self.grid.slid(&domain)?;
        let before = std::mem::replace(&mut self.grid, slid);
        self.setup.turn_to(domain);
        Ok(if self.grid.lies_as(&before) { Turned::Velocities } else { Turned::Images })
    }

    /// Force that gives each body a unit velocity in unbounded fluid; infinite for a body whose motion is given.
    pub fn resistances(&self) -> Vec<f64> {
        let resistance = |(body, suspended): (usize, &SuspendedBody<D>)| {
            let (mobility, force) = self.body_types.translation(body);
            if suspended.body.free() { self.setup.viscosity * force / mobility } else { f64::INFINITY }
        };
        self.setup.bodies.iter().enumerate().map(resistance).collect()
    }

    /// What films resist the approach of a contact by, force over speed.
    pub fn film_resistance(&self, contact: &Contact<D>) -> f64 {
        let of = |body: usize| self.body_types.radius_and_order(body);
        self.setup.viscosity * self.setup.interactions.approach_resistance(contact, &of)
    }

    /// The velocity that the flow without bodies has besides its fluid vector.
    pub fn background(&self, point: &SVector<f64, D>) -> SVector<f64, D> {
        self.imposed_mean_velocity() + self.setup.drive.background(point)
    }

    /// The mean velocity that a fully periodic box is given; elsewhere the flow without bodies has it.
    pub fn imposed_mean_velocity(&self) -> SVector<f64, D> {
        match self.setup.drive {
            Drive::MeanVelocity(velocity) if self.setup.domain.fully_periodic() => velocity,
            _ => SVector::zeros(),
        }
    }

    /// The right-hand side of the linear system: rows of this rank's bodies, of the mean-flow constraint on rank 0, and of this rank's constraints.
    pub fn fill_right_hand_side(
        &self,
        wanted: &[f64],
        rates: impl Iterator<Item = f64>,
        prescribed_drag: f64,
        rhs: &mut Vector,
    ) -> Result<()> {
        let fluid = if self.condensed { 0 } else { self.grid.local_fluid_unknowns() };
        let mut rows = rhs.local_mut()?;
        rows.fill(0.0);
        if let Some(of_fluid) = &self.fluid_rows {
            rows[..fluid].copy_from_slice(&of_fluid.local()?);
        }
        let (multipliers, global_unknowns) = rows[fluid..].split_at_mut(wanted.len());
        multipliers.copy_from_slice(wanted);
        let mean_flow = if self.session.world().rank() == 0 { self.mean_flow.unknowns::<D>() } else { 0 };
        let (mean_flow, constraints) = global_unknowns.split_at_mut(mean_flow);
        if let MeanFlowConstraint::MeanVelocity = self.mean_flow {
            let total = -self.setup.drive.uniform_force() * self.setup.domain.volume() / self.setup.viscosity;
            mean_flow.iter_mut().zip(total.iter()).for_each(|(row, force)| *row = force / prescribed_drag);
        }
        if self.fluid_rows.is_some() {
            mean_flow.iter_mut().zip(self.mean_flow.wanted(&self.setup.drive)).for_each(|(row, wanted)| *row = wanted);
        }
        constraints.iter_mut().zip(rates).for_each(|(row, rate)| *row = rate);
        Ok(())
    }

    /// What is found, from the disturbance of the flow without bodies and the unknowns of the mean-flow constraint.
    pub fn solution(
        &self,
        bodies: Vec<BodyState<D>>,
        mut fluid: Vector,
        global_unknowns: &[f64],
        contact_forces: Vec<f64>,
    ) -> Result<Solution<D>> {
        if let Some(undisturbed) = &self.undisturbed.0 {
            fluid.add(1.0, undisturbed)?;
        }
        if self.setup.domain.fully_periodic() {
            let offset = if let MeanFlowConstraint::MeanVelocity = self.mean_flow {
                SVector::from_column_slice(global_unknowns)
            } else {
                self.imposed_mean_velocity()
            };
            let mut values = fluid.local_mut()?;
            for axis in 0..D {
                values[self.grid.local_range(axis)].iter_mut().for_each(|value| *value += offset[axis]);
            }
        }
        let pressure_gradient = self.pressure_gradient(&bodies, global_unknowns);
        let mean_velocity = self.mean_velocity(&fluid)?;
        Ok(Solution {
            bodies,
            fluid,
            on_mesh: None,
            mean_velocity,
            pressure_gradient,
            walls: WallForces::none(),
            contact_forces,
            pair_stress: None,
            loads: Vec::new(),
            bond_stress: None,
            bond_forces: Vec::new(),
            lubrication: None,
            cost: Cost::default(),
        })
    }

    fn mean_velocity(&self, fluid: &Vector) -> Result<SVector<f64, D>> {
        let values = fluid.local()?;
        let cells = self.grid.unknowns(D) as f64;
        // faces on walls carry no normal velocity: counting them changes nothing
        let mut mean = SVector::<f64, D>::from_fn(|axis, _| values[self.grid.local_range(axis)].iter().sum::<f64>() / cells);
        self.session.world().sum(mean.as_mut_slice());
        if let Some((axis, _)) = self.setup.domain.open() {
            // half a face at either end
            mean[axis] += self.setup.domain.mean_inflow() / self.grid.cells()[axis] as f64;
        }
        Ok(mean)
    }

    fn pressure_gradient(&self, bodies: &[BodyState<D>], global_unknowns: &[f64]) -> SVector<f64, D> {
        let mut gradient = SVector::zeros();
        match (&self.mean_flow, self.setup.drive) {
            (_, Drive::PressureGradient(given)) => gradient = given,
            (_, Drive::BodyForce(_)) => {}
            (MeanFlowConstraint::Forces(forces), _) => {
                for ((force, known), found) in forces.iter().zip(&self.undisturbed.1).zip(global_unknowns) {
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

/// Refuses a drive under which the flow would never become steady.
pub fn check_steady_state<const D: usize>(setup: &Setup<D>) -> Result<()> {
    if setup.drive.leaves_mean_velocity_open(&setup.domain) && setup.bodies.iter().all(|suspended| suspended.body.free()) {
        return Err(Error::refused(
            "flow.drive: under a uniform force a fully periodic box in which nothing is fixed has no steady flow; \
             fix a body, put up walls, or prescribe mean_velocity",
        ));
    }
    Ok(())
}
