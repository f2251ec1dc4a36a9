//! A suspension in viscous flow at one instant: bodies where they are, the flow and their motions.

use std::{rc::Rc, time::Instant};

use nalgebra::SVector;

use super::{
    FlowSolver, Setup, Solution, WallForces,
    assembled_system::AssembledSystem,
    assembly::Assembly,
    configuration::Configuration,
    cost::{Cost, ResidualMonitor},
    extrapolation::{ExtrapolationHistory, Snapshot},
    faster::{Faster, faster},
    film_forces::add_films,
    fixed_operators::FixedOperators,
    krylov_workspace::KrylovWorkspace,
    pair_resistance::belongs,
    schur_complement::SchurComplement,
    spectrum::Conditions,
};
use crate::{
    constraint::FlowMethod,
    contact::Contact,
    error::{Error, Result},
    flow::{InverseMethod, IteratedInverse, Stokes, StokesInverse},
    geometry::Ball,
    grid::Grid,
    interaction::{Arrangement, PairForce, Wrench},
    petsc::{Session, Stage, Vector, enter},
};

/// A suspension ready to be solved.
pub struct Suspension<const D: usize> {
    basis: FixedOperators<D>,
    inverse: Box<dyn StokesInverse<D>>,
    assembly: Option<Assembly<D>>,
    engine: Option<KrylovWorkspace>,
    remembers: bool,
    past: Option<ExtrapolationHistory<D>>,
    cost: Cost,
}

impl<const D: usize> Suspension<D> {
    /// Builds the machinery that a setup calls for.
    ///
    /// # Errors
    /// The grid or the rank count does not fit, or no steady state exists.
    pub fn new(session: &Session, setup: Setup<D>) -> Result<Suspension<D>> {
        let chosen = setup.clone();
        Self::with_inverse(session, setup, |stokes, grid| inverse(&chosen, stokes, grid))
    }

    /// As [`new`](Self::new), with another approximate inverse of the fluid until images slide.
    ///
    /// # Errors
    /// The same, and those of making the inverse.
    pub fn with_inverse(
        session: &Session,
        setup: Setup<D>,
        inverse: impl FnOnce(&Stokes<D>, &Grid<D>) -> Result<Box<dyn StokesInverse<D>>>,
    ) -> Result<Suspension<D>> {
        let (_stage, start) = (enter(Stage::SetUp), Instant::now());
        let (basis, inverse) = FixedOperators::new(session, setup, inverse)?;
        let cost = Cost { setup: start.elapsed().as_secs_f64(), grid_unknowns: basis.grid.fluid_unknowns(), ..Cost::default() };
        Ok(Suspension { basis, inverse, assembly: None, engine: None, remembers: false, past: None, cost })
    }

    /// As [`new`](Self::new), with a method that makes bodies rigid of one's own, which need not be known to scene files.
    ///
    /// # Errors
    /// The same.
    pub fn with_method(session: &Session, setup: Setup<D>, method: Rc<FlowMethod<D>>) -> Result<Suspension<D>> {
        let mut suspension = Suspension::new(session, setup)?;
        suspension.basis.method = method;
        Ok(suspension)
    }

    /// Lets images slide to where they are at a time; what was assembled across the boundary is gone.
    fn slide_to(&mut self, time: f64) -> Result<()> {
        if let Some(inverse) = self.basis.slide(time, inverse)? {
            (self.inverse, self.assembly) = (inverse, None);
            if self.remembers_fluid() {
                self.past = None;
            }
        }
        Ok(())
    }

    fn initial_centers(&self) -> Vec<SVector<f64, D>> {
        self.basis.setup.bodies.iter().map(|suspended| suspended.body.ball.center).collect()
    }

    /// The moment at which bodies are there and none touches.
    fn at_rest<'a>(&self, centers: &'a [SVector<f64, D>]) -> Configuration<'a, D> {
        let time = self.basis.setup.domain.slide().map_or(0.0, |slide| slide.time);
        Configuration { centers, time, pressed: &[], step: 0.0, pushes: &[], tolerance: self.basis.setup.tolerance.at_an_instant() }
    }

    /// Condition numbers of the system on the multipliers with the bodies where the setup has them; as dear as that many iterations
    /// twice over.
    ///
    /// # Errors
    /// [`Error::Refused`] when the inverse of the fluid is not exact: the fluid is then no part that can be eliminated.
    pub fn conditions(&mut self) -> Result<Conditions> {
        if !self.basis.condensed {
            return Err(Error::refused("condition numbers on the multipliers take an exact inverse of the fluid (transform)"));
        }
        let (centers, basis) = (self.initial_centers(), &self.basis);
        let mut ready = AssembledSystem::new(basis, None, None, None, &self.at_rest(&centers))?;
        let shape = ready.engine.x.like()?;
        let (_, parts) = ready.parts(basis, self.inverse.as_mut());
        Conditions::of(basis.session.world(), &mut SchurComplement::new(parts), &shape)
    }
}

impl<const D: usize> FlowSolver<D> for Suspension<D> {
    fn grid(&self) -> &Grid<D> {
        &self.basis.grid
    }

    fn setup(&self) -> &Setup<D> {
        &self.basis.setup
    }

    fn cost(&self) -> &Cost {
        &self.cost
    }

    fn inverse(&self) -> &'static str {
        self.setup().inverse.word()
    }

    fn faster(&self) -> Result<Option<Faster>> {
        faster(&self.basis, &self.cost)
    }

    fn resistances(&self) -> Vec<f64> {
        let resistance = |(body, suspended): (usize, &super::SuspendedBody<D>)| {
            let (mobility, force) = self.basis.kinds.translation(body);
            if suspended.body.free() { self.basis.setup.viscosity * force / mobility } else { f64::INFINITY }
        };
        self.basis.setup.bodies.iter().enumerate().map(resistance).collect()
    }

    fn film_resistance(&self, contact: &Contact<D>) -> f64 {
        let of = |body: usize| self.basis.kinds.radius_and_order(body);
        self.basis.setup.viscosity * self.basis.setup.interactions.approach_resistance(contact, &of)
    }

    fn remember(&mut self, past: Option<ExtrapolationHistory<D>>) {
        (self.remembers, self.past) = (true, past);
    }

    fn fluid_vector(&self) -> Result<Vector> {
        self.basis.stokes.vector()
    }

    fn remembers_fluid(&self) -> bool {
        !self.basis.condensed
    }

    fn past(&self) -> Option<&ExtrapolationHistory<D>> {
        self.past.as_ref()
    }

    fn solve(&mut self, monitor: ResidualMonitor) -> Result<Solution<D>> {
        let (centers, weights) = (self.initial_centers(), self.resistances());
        let setup = &self.basis.setup;
        let balls: Vec<Ball<D>> = setup.bodies.iter().map(|suspended| suspended.body.ball).collect();
        let arrangement = Arrangement { domain: &setup.domain, balls: &balls, weights: &weights, viscosity: Some(setup.viscosity) };
        let forces = setup.interactions.pair_forces(&arrangement);
        let pushes = Wrench::on_bodies(balls.len(), [], &forces);
        let solution = self.solve_at(&Configuration { pushes: &pushes, ..self.at_rest(&centers) }, monitor)?;
        Ok(Solution { pair_stress: PairForce::total_stress(&forces), ..solution })
    }

    fn solve_at(&mut self, moment: &Configuration<D>, monitor: ResidualMonitor) -> Result<Solution<D>> {
        let start = Instant::now();
        self.slide_to(moment.time)?;
        let basis = &self.basis;
        let mut ready = AssembledSystem::new(basis, self.assembly.take(), self.engine.take(), self.past.as_ref(), moment)?;
        self.cost.multiplier_unknowns = ready.bodies.layout.unknowns();
        (self.cost.assembly, self.cost.assembled) = (start.elapsed().as_secs_f64(), ready.assembly.assembled);
        let (report, mut found) = ready.solve(basis, self.inverse.as_mut(), monitor)?;
        let AssembledSystem { bodies, assembly, mut engine, guess, touching, .. } = ready;
        self.cost.krylov = report;
        self.cost.stages = std::mem::take(&mut engine.work.stages);
        let links = found.global_unknowns.split_off(basis.closure.unknowns::<D>());
        if self.remembers && basis.method.on_surfaces() {
            let last = Snapshot::of(&bodies, &basis.session, moment.centers, &found, basis.condensed)?;
            self.past = Some(ExtrapolationHistory::then(self.past.take(), last, guess, moment.time));
        }
        let mut states = bodies.states(&basis.session, &assembly.blocks, &found.velocities, &found.multipliers);
        let mut walls = assembly.blocks.on_walls(&found.multipliers).map(|pair| pair.map(|force| force * basis.setup.viscosity));
        walls.iter_mut().flatten().for_each(|force| basis.session.world().sum(force.as_mut_slice()));
        let unit = touching.scale * basis.setup.viscosity;
        let (world, layout) = (basis.session.world(), &bodies.layout);
        let mut forces = links[..touching.count()].iter().map(|unknown| unknown * unit);
        let of_contact = |pressed| if belongs(layout, pressed) { forces.next().unwrap_or(0.0) } else { 0.0 };
        let mut contact_forces: Vec<f64> = moment.pressed.iter().map(of_contact).collect();
        if !contact_forces.is_empty() {
            world.sum(&mut contact_forces);
        }
        let film_forces: Vec<f64> = forces.collect();
        let lubrication =
            basis.setup.interactions.resist().then(|| add_films(world, layout, &assembly.films, &film_forces, &mut states, &mut walls));
        (self.assembly, self.engine) = (Some(assembly), Some(engine));
        Ok(Solution {
            lubrication,
            walls: WallForces { forces: walls, complete: false },
            ..basis.solution(states, found.fluid, &found.global_unknowns, contact_forces)?
        })
    }
}

/// The inverse of the fluid that a setup calls for.
fn inverse<const D: usize>(setup: &Setup<D>, stokes: &Stokes<D>, grid: &Grid<D>) -> Result<Box<dyn StokesInverse<D>>> {
    match (setup.inverse, setup.inner_tolerance()) {
        (InverseMethod::Hypre, Some(tolerance)) => Ok(Box::new(IteratedInverse::new(stokes, grid, tolerance)?)),
        (method, _) => method.set_up(stokes, grid),
    }
}
