//! A suspension in viscous flow at one instant: bodies where they are, the flow and their motions.

use std::{rc::Rc, time::Instant};

use super::{
    evolution::Evolution,
    flow_solver::FlowSolver,
    history::{History, HistoryShape, HistoryView},
    near_bodies::with_smallest_gap,
    resistance::Resistance,
};
use crate::{
    constraint::FlowMethod,
    error::{Error, Result},
    flow::{Stokes, StokesInverse},
    geometry::Domain,
    grid::Grid,
    petsc::{Session, Stage, enter},
    scene::ConstraintMethod,
    surface::Shape,
    system::{
        Conditions,
        assembled_system::AssembledSystem,
        assembly::Assembly,
        fixed_operators::{FixedOperators, Turned},
        krylov_workspace::KrylovWorkspace,
        readback,
        schur_complement::SchurComplement,
    },
};
use crate::{
    setup::{Configuration, Setup},
    system::{Cost, ResidualMonitor, Snapshot, Solution, extrapolation::RecentHistories},
};

/// A suspension ready to be solved.
pub struct Suspension<const D: usize> {
    fixed: FixedOperators<D>,
    inverse: Box<dyn StokesInverse<D>>,
    assembly: Option<Assembly<D>>,
    workspace: Option<KrylovWorkspace>,
    remembers: bool,
    recent: RecentHistories<D>,
    cost: Cost,
}

impl<const D: usize> Suspension<D> {
    /// Builds the machinery that a setup calls for.
    ///
    /// # Errors
    /// The grid or the rank count does not fit, or no steady state exists.
    pub fn new(session: &Session, setup: Setup<D>) -> Result<Suspension<D>> {
        let chosen = setup.clone();
        Self::with_inverse(session, setup, |stokes, grid| chosen.inverse_of(stokes, grid))
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
        let (fixed, inverse) = FixedOperators::new(session, setup, inverse)?;
        let cost = Cost { setup: start.elapsed().as_secs_f64(), grid_unknowns: fixed.grid.fluid_unknowns(), ..Cost::default() };
        Ok(Suspension { fixed, inverse, assembly: None, workspace: None, remembers: false, recent: RecentHistories::default(), cost })
    }

    /// As [`new`](Self::new), with a method that makes bodies rigid of one's own, which need not be known to scene files.
    ///
    /// # Errors
    /// The same.
    pub fn with_method(session: &Session, setup: Setup<D>, method: Rc<FlowMethod<D>>) -> Result<Suspension<D>> {
        let mut suspension = Suspension::new(session, setup)?;
        suspension.fixed.method = method;
        Ok(suspension)
    }

    /// As [`new`](Self::new), with shapes of one's own of some bodies, by their numbers, in place of balls: by the method `sharp`, without interactions.
    ///
    /// # Errors
    /// The same, or the setup has what only balls do.
    ///
    /// # Panics
    /// If there is no body of such a number.
    pub fn with_shapes(session: &Session, mut setup: Setup<D>, shapes: Vec<(usize, Rc<dyn Shape<D>>)>) -> Result<Suspension<D>> {
        let only_flow =
            setup.inertia.is_none() && setup.constraint == ConstraintMethod::Sharp && setup.interactions.iter().next().is_none();
        if !only_flow {
            return Err(Error::refused(
                "bodies that are no balls are known to method.constraint = \"sharp\", without inertia or interactions",
            ));
        }
        for (body, shape) in &shapes {
            setup.bodies[*body].body.ball.radius = shape.bounding_radius();
        }
        let mut suspension = Suspension::new(session, setup)?;
        let FixedOperators { setup, body_types, .. } = &mut suspension.fixed;
        shapes.into_iter().for_each(|(body, shape)| body_types.give_shape(body, shape, setup));
        Ok(suspension)
    }

    /// Turns to the box of another time; what was assembled across its boundary is gone.
    fn turn_to(&mut self, domain: Domain<D>) -> Result<()> {
        let turned = self.fixed.turn_to(domain, &mut self.inverse)?;
        if turned != Turned::Nothing {
            self.assembly = None;
        }
        if turned == Turned::Images && !self.fixed.condensed {
            self.recent = RecentHistories::default();
        }
        Ok(())
    }

    /// What the last solve cost.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    /// See [`FlowSolver`]'s own `solve`.
    ///
    /// # Errors
    /// [`Diverged`](crate::error::Error::Diverged) when the solve fails.
    pub fn solve(&mut self, monitor: ResidualMonitor) -> Result<Solution<D>> {
        let flow: &mut dyn FlowSolver<D> = self;
        flow.solve(monitor)
    }

    /// Condition numbers of the system on the multipliers with the bodies where the setup has them; as dear as that many iterations
    /// twice over.
    ///
    /// # Errors
    /// [`Error::Refused`] when the inverse of the fluid is not exact: the fluid is then no part that can be eliminated.
    pub fn conditions(&mut self) -> Result<Conditions> {
        if !self.fixed.condensed {
            return Err(Error::refused("condition numbers on the multipliers need an exact Stokes solver (transform)"));
        }
        let (centers, fixed) = (self.fixed.setup.centers(), &self.fixed);
        let welds = fixed.setup.interactions.welds(&centers);
        let mut ready = AssembledSystem::new(fixed, None, None, None, &Configuration::at_rest(&fixed.setup, &centers, &welds))?;
        let shape = ready.workspace.x.like()?;
        let (_, parts) = ready.parts(fixed, self.inverse.as_mut());
        Conditions::of(fixed.session.world(), &mut SchurComplement::new(parts), &shape)
    }
}

impl<const D: usize> FlowSolver<D> for Suspension<D> {
    fn grid(&self) -> &Grid<D> {
        &self.fixed.grid
    }

    fn setup(&self) -> &Setup<D> {
        &self.fixed.setup
    }

    fn prepare(&mut self, time: f64, domain: &Domain<D>, again: bool) -> Result<()> {
        self.turn_to(domain.clone())?;
        self.remembers = true;
        self.recent.forget_from(if again { time.next_up() } else { time });
        if self.fixed.prescribe(time, self.inverse.as_mut())? {
            self.assembly = None;
        }
        Ok(())
    }

    fn resistance(&self) -> Resistance<'_, D> {
        Resistance::of_modes(&self.fixed, self.assembly.as_ref(), 1.0)
    }

    fn evolution(&self) -> Option<&dyn Evolution<D>> {
        None
    }

    fn history(&self, time: f64) -> HistoryView<'_, D> {
        let shape = HistoryShape { fluid: !self.fixed.condensed, ..HistoryShape::default() };
        HistoryView { past: self.recent.before(time), shape, ..HistoryView::default() }
    }

    fn restore(&mut self, history: History<D>) -> Result<()> {
        self.recent = history.past.into();
        Ok(())
    }

    fn solve_at(&mut self, configuration: &Configuration<D>, monitor: ResidualMonitor) -> Result<Solution<D>> {
        let start = Instant::now();
        self.turn_to(self.fixed.setup.domain.clone().at(configuration.time))?;
        let FixedOperators { setup, body_types, .. } = &mut self.fixed;
        body_types.turn_to(configuration.rotations, setup);
        let fixed = &self.fixed;
        let mut ready = AssembledSystem::new(fixed, self.assembly.take(), self.workspace.take(), self.recent.last(), configuration)?;
        self.cost.multiplier_unknowns = ready.bodies.layout.unknowns();
        (self.cost.assembly, self.cost.assembled) = (start.elapsed().as_secs_f64(), ready.assembly.assembled);
        let solved = ready.solve(fixed, self.inverse.as_mut(), monitor);
        let (report, mut found) = solved.map_err(|error| with_smallest_gap(error, &fixed.setup, configuration))?;
        let AssembledSystem { bodies, assembly, mut workspace, guess, pair_constraints, .. } = ready;
        self.cost.krylov = report;
        self.cost.stages = std::mem::take(&mut workspace.work.stages);
        let constraints = found.global_unknowns.split_off(fixed.mean_flow.unknowns::<D>());
        if self.remembers && fixed.method.on_surfaces() {
            let last = Snapshot::of(&bodies, &fixed.session, configuration.centers, &found, fixed.condensed)?;
            self.recent.add(last, guess, configuration.time);
        }
        let solution = readback::solution(fixed, &bodies, &assembly, &pair_constraints, &constraints, found, configuration)?;
        (self.assembly, self.workspace) = (Some(assembly), Some(workspace));
        Ok(Solution { cost: self.cost, ..solution })
    }
}
