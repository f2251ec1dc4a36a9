//! A suspension in viscous flow at one instant: bodies where they are, the flow and their motions.

use std::{rc::Rc, time::Instant};

use nalgebra::SVector;

use super::{
    configuration::Configuration,
    cost::{Cost, ResidualMonitor},
    flow_solver::FlowSolver,
    history::{HistoryShape, HistoryView},
    setup::Setup,
    solution::Solution,
    system::extrapolation::{ExtrapolationHistory, Snapshot},
};
use crate::{
    body::Row,
    constraint::FlowMethod,
    contact::Contact,
    error::{Error, Result},
    flow::{InverseMethod, Stokes, StokesInverse},
    geometry::Ball,
    grid::Grid,
    interaction::{Arrangement, PairForce, Wrench},
    mechanics::{
        Conditions,
        system::{
            assembled_system::AssembledSystem, assembly::Assembly, fixed_operators::FixedOperators, krylov_workspace::KrylovWorkspace,
            readback, schur_complement::SchurComplement,
        },
    },
    petsc::{Session, Stage, Vector, enter},
};

/// A suspension ready to be solved.
pub struct Suspension<const D: usize> {
    fixed: FixedOperators<D>,
    inverse: Box<dyn StokesInverse<D>>,
    assembly: Option<Assembly<D>>,
    workspace: Option<KrylovWorkspace>,
    remembers: bool,
    past: Option<ExtrapolationHistory<D>>,
    /// What that was before the first solve at its time.
    past_before: Option<ExtrapolationHistory<D>>,
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
        Ok(Suspension { fixed, inverse, assembly: None, workspace: None, remembers: false, past: None, past_before: None, cost })
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

    /// Lets images slide to where they are at a time; what was assembled across the boundary is gone.
    fn slide_to(&mut self, time: f64) -> Result<()> {
        if let Some(inverse) = self.fixed.slide(time, Setup::inverse_of)? {
            (self.inverse, self.assembly) = (inverse, None);
            if !self.fixed.condensed {
                (self.past, self.past_before) = (None, None);
            }
        }
        Ok(())
    }

    fn initial_centers(&self) -> Vec<SVector<f64, D>> {
        self.fixed.setup.bodies.iter().map(|suspended| suspended.body.ball.center).collect()
    }

    /// The configuration in which bodies are there and none touches.
    fn at_rest<'a>(&self, centers: &'a [SVector<f64, D>], bonds: &'a [Row<D>]) -> Configuration<'a, D> {
        let time = self.fixed.setup.domain.slide().map_or(0.0, |slide| slide.time);
        Configuration { centers, time, pressed: &[], bonds, step: 0.0, pushes: &[], tolerance: self.fixed.setup.tolerance.at_an_instant() }
    }

    /// Condition numbers of the system on the multipliers with the bodies where the setup has them; as dear as that many iterations
    /// twice over.
    ///
    /// # Errors
    /// [`Error::Refused`] when the inverse of the fluid is not exact: the fluid is then no part that can be eliminated.
    pub fn conditions(&mut self) -> Result<Conditions> {
        if !self.fixed.condensed {
            return Err(Error::refused("condition numbers on the multipliers take an exact inverse of the fluid (transform)"));
        }
        let (centers, fixed) = (self.initial_centers(), &self.fixed);
        let welds = fixed.setup.interactions.welds(&centers);
        let mut ready = AssembledSystem::new(fixed, None, None, None, &self.at_rest(&centers, &welds))?;
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

    fn cost(&self) -> &Cost {
        &self.cost
    }

    fn prescribe(&mut self, time: f64) {
        self.fixed.setup.prescribe(time);
    }

    fn inverse(&self) -> &'static str {
        self.setup().inverse.word()
    }

    fn faster(&self) -> Option<InverseMethod> {
        let fastest = InverseMethod::fastest(&self.setup().domain);
        (!self.fixed.condensed && fastest != self.setup().inverse).then_some(fastest)
    }

    fn resistances(&self) -> Vec<f64> {
        self.fixed.resistances()
    }

    fn film_resistance(&self, contact: &Contact<D>) -> f64 {
        self.fixed.film_resistance(contact)
    }

    fn remember(&mut self, past: Option<ExtrapolationHistory<D>>) {
        (self.remembers, self.past, self.past_before) = (true, past, None);
    }

    fn fluid_vector(&self) -> Result<Vector> {
        self.fixed.stokes.vector()
    }

    fn abandon(&mut self, time: f64) {
        if self.past.as_ref().is_some_and(|past| past.time == time) {
            self.past = self.past_before.take();
        }
    }

    fn history_before(&self, time: f64) -> HistoryView<'_, D> {
        let past = self.past.as_ref().filter(|past| past.time < time).or(self.past_before.as_ref());
        HistoryView { past, ..HistoryView::default() }
    }

    fn history_shape(&self) -> HistoryShape {
        HistoryShape { fluid: !self.fixed.condensed, ..HistoryShape::default() }
    }

    fn past(&self) -> Option<&ExtrapolationHistory<D>> {
        self.past.as_ref()
    }

    fn solve(&mut self, monitor: ResidualMonitor) -> Result<Solution<D>> {
        let (centers, weights) = (self.initial_centers(), self.resistances());
        let setup = &self.fixed.setup;
        let balls: Vec<Ball<D>> = setup.bodies.iter().map(|suspended| suspended.body.ball).collect();
        let viscosity = Some(setup.viscosity);
        let arrangement =
            Arrangement { domain: &setup.domain, numbers: None, balls: &balls, weights: &weights, viscosity, reach: f64::INFINITY };
        let forces = setup.interactions.forces(&arrangement).pairs;
        let pushes = Wrench::on_bodies(balls.len(), [], &forces);
        let welds = setup.welds_in_the_box(&centers);
        let solution = self.solve_at(&Configuration { pushes: &pushes, ..self.at_rest(&centers, &welds) }, monitor)?;
        Ok(Solution { pair_stress: PairForce::total_stress(&forces), ..solution })
    }

    fn solve_at(&mut self, configuration: &Configuration<D>, monitor: ResidualMonitor) -> Result<Solution<D>> {
        let start = Instant::now();
        self.slide_to(configuration.time)?;
        let fixed = &self.fixed;
        let mut ready = AssembledSystem::new(fixed, self.assembly.take(), self.workspace.take(), self.past.as_ref(), configuration)?;
        self.cost.multiplier_unknowns = ready.bodies.layout.unknowns();
        (self.cost.assembly, self.cost.assembled) = (start.elapsed().as_secs_f64(), ready.assembly.assembled);
        let (report, mut found) = ready.solve(fixed, self.inverse.as_mut(), monitor)?;
        let AssembledSystem { bodies, assembly, mut workspace, guess, pair_constraints, .. } = ready;
        self.cost.krylov = report;
        self.cost.stages = std::mem::take(&mut workspace.work.stages);
        let constraints = found.global_unknowns.split_off(fixed.mean_flow.unknowns::<D>());
        if self.remembers && fixed.method.on_surfaces() {
            let last = Snapshot::of(&bodies, &fixed.session, configuration.centers, &found, fixed.condensed)?;
            let (past, before) = ExtrapolationHistory::then(self.past.take(), last, guess, configuration.time);
            (self.past, self.past_before) = (Some(past), before.or(self.past_before.take()));
        }
        let solution = readback::solution(fixed, (&bodies, &assembly), (&pair_constraints, &constraints), found, configuration)?;
        (self.assembly, self.workspace) = (Some(assembly), Some(workspace));
        Ok(solution)
    }
}
