//! A suspension in a flow with inertia, step by step: fluid, bodies and what holds them together in one linear system.
//!
//! A solve at a time after the last one is a step. Convection and history are extrapolated (second-order backward differentiation); the Stokes part, the
//! multipliers and the momentum of the bodies are implicit, so that neither viscosity nor added mass limits a step. Solves at the time of the
//! last one, as contacts need them, are that step again.

mod convected;
mod damping;
mod inside;
mod longest;
mod memory;
mod momentum;
mod near_surfaces;
mod rows;
mod scheme;
mod viscous_flux;

use std::{borrow::Cow, cell::OnceCell, f64::consts::PI, time::Instant};

use nalgebra::{SMatrix, SVector};

use self::{
    convected::young,
    damping::damp,
    memory::{Forgetting, between, followed},
    momentum::Momentum,
    near_surfaces::NearSurfaces,
    rows::{Past, kept},
    scheme::convection_weights,
};
pub use self::{
    longest::{COURANT, LARGEST_COURANT, first_step, is_moved_at_once, longest_step, shortest_step, starts_at_once},
    momentum::inertia,
    scheme::StepWeights,
};
use super::{
    evolution::{Evolution, EvolutionOnGrid},
    flow_solver::FlowSolver,
    history::{History, HistoryShape, HistoryView},
    near_bodies::with_smallest_gap,
    resistance::Resistance,
};
use crate::{
    body::{Row, Twist, planes},
    error::{Error, Result},
    flow::{Convection, FluidSystem, OpenEnds, StokesInverse, fastest},
    geometry::{Ball, Domain, fraction},
    grid::{Grid, operators::signed},
    interaction::Wrench,
    petsc::{Scatter, Session, Stage, Vector, enter},
    system::{
        assembled_system::AssembledSystem,
        assembly::Assembly,
        film_forces::add_films,
        fixed_operators::{FixedOperators, Turned},
        krylov_workspace::KrylovWorkspace,
        mean_flow_constraint::{add_drive, add_walls},
        readback,
    },
};
use crate::{
    setup::{Configuration, Inertia, Setup},
    system::{
        BodyState, Cost, Level, Lubrication, ResidualMonitor, Snapshot, Solution, WallForces,
        extrapolation::RecentHistories,
        level::{Band, Extended},
        points::{Point, each_inside},
    },
};

/// Solutions from which a step starts: two for the rate of change, one more for convection.
const LEVELS: usize = 3;

/// Change of the shift, as a part, that is rounding of time steps.
const SAME_SHIFT: f64 = 1e-7;

/// Cells that the flow passes in a step beyond which what is extrapolated means nothing, and no round of contacts is worth while.
const MEANINGLESS_COURANT: f64 = 3.0;

/// Part of the shortest step of light bodies by which a step falls short of it.
const SHORTER: f64 = 0.9;

/// A suspension in a flow with inertia.
pub struct UnsteadySuspension<const D: usize> {
    fixed: FixedOperators<D>,
    /// Of the operator with the shift of the last step; none before the first.
    inverse: Option<Box<dyn StokesInverse<D>>>,
    convection: Convection<D>,
    /// The last solution.
    current: Option<Level<D>>,
    /// Its jumps in bodies, once they are known.
    band: OnceCell<Band>,
    /// The layers on its bodies, in cells, once they are known.
    layers: OnceCell<Vec<f64>>,
    /// The force that the rows of its step lose.
    momentum_residual: SVector<f64, D>,
    /// The solutions before it, from which its step started.
    past: Vec<(Level<D>, Extended<D>)>,
    assembly: Option<Assembly<D>>,
    workspace: Option<KrylovWorkspace>,
    recent: RecentHistories<D>,
    /// What the formula of the last step makes of a unit of the mean force of contacts.
    of_impulse: f64,
    cost: Cost,
}

impl<const D: usize> UnsteadySuspension<D> {
    /// Fluid at rest, unless walls move it, and bodies as they start; through a box with an inflow it flows everywhere.
    ///
    /// # Errors
    /// The grid or the rank count does not fit.
    ///
    /// # Panics
    /// For a setup without inertia.
    pub fn new(session: &Session, setup: Setup<D>) -> Result<UnsteadySuspension<D>> {
        let (_stage, start) = (enter(Stage::SetUp), Instant::now());
        let fixed = FixedOperators::at_rest(session, setup)?;
        let convection = Convection::new(&fixed.grid, &fixed.stokes.vector()?)?;
        let cost = Cost { setup: start.elapsed().as_secs_f64(), grid_unknowns: fixed.grid.fluid_unknowns(), ..Cost::default() };
        let (past, assembly) = (Vec::new(), None);
        Ok(UnsteadySuspension {
            fixed,
            inverse: None,
            convection,
            current: None,
            band: OnceCell::new(),
            layers: OnceCell::new(),
            momentum_residual: SVector::zeros(),
            past,
            assembly,
            workspace: None,
            recent: RecentHistories::default(),
            of_impulse: 1.0,
            cost,
        })
    }

    fn inertia(&self) -> &Inertia<D> {
        inertia(&self.fixed.setup)
    }

    /// Mass per volume over viscosity.
    fn inverse_diffusivity(&self) -> f64 {
        self.inertia().fluid / self.fixed.setup.viscosity
    }

    /// Forgets what was found from a time on: another step is taken in place of the one that led there.
    fn forget_from(&mut self, time: f64) {
        if self.current.take_if(|level| level.time >= time).is_some() {
            self.forget_surroundings();
        }
        self.recent.forget_from(time);
    }

    /// Makes the last solution a past one, if time has gone on.
    fn settle(&mut self, time: f64) -> Result<()> {
        if self.current.as_ref().is_none_or(|level| level.time >= time) {
            return Ok(());
        }
        let _stage = enter(Stage::Assembly);
        let Some(mut level) = self.current.take() else { return Ok(()) };
        if let Some((before, _)) = self.past.first() {
            let (step, grid) = (level.time - before.time, &self.fixed.grid);
            let young = young(grid, step, self.inverse_diffusivity(), fastest(grid, &level.fluid)?);
            level.resolved = 1.0 - young * (1.0 - before.resolved);
        }
        let band = self.band.take();
        self.forget_surroundings();
        self.remember_level(level, band, 0)
    }

    /// Forgets what was found of the last solution.
    fn forget_surroundings(&mut self) {
        self.band.take();
        self.layers.take();
    }

    /// The jumps of the last solution in its bodies; none without a solution or jump functions.
    fn band(&self) -> Result<Option<(&Level<D>, &Band)>> {
        let Some(level) = self.current.as_ref().filter(|_| self.fixed.method.jumps()) else { return Ok(None) };
        if let Some(band) = self.band.get() {
            return Ok(Some((level, band)));
        }
        let grid = self.grid_at(level.time)?;
        let found = level.band(&grid, &self.fixed.body_types)?;
        Ok(Some((level, self.band.get_or_init(|| found))))
    }

    /// The grid whose images lie where they did at a time: a run that goes on meets a level when they have slid on.
    fn grid_at(&self, time: f64) -> Result<Cow<'_, Grid<D>>> {
        let (grid, domain) = (&self.fixed.grid, self.fixed.setup.domain.clone().at(time));
        Ok(if *grid.domain() == domain { Cow::Borrowed(grid) } else { Cow::Owned(grid.slid(&domain)?) })
    }

    /// Thickness of the layers on the bodies of the last solution, in cells; nothing where there are no jump functions. Collective.
    fn layers(&self) -> Result<Option<Vec<f64>>> {
        let Some((level, band)) = self.band()? else { return Ok(None) };
        if self.layers.get().is_none() {
            let grid = self.grid_at(level.time)?;
            let mut found = level.layers(self.fixed.session.world(), band, &grid)?;
            // no layer is thicker than that of a wall set in motion at the start: on a coarse grid the slope at a surface does not show it
            let most = (PI * level.time / self.inverse_diffusivity()).sqrt() / grid.spacing().max();
            found.iter_mut().for_each(|layer| *layer = layer.min(most));
            return Ok(Some(self.layers.get_or_init(|| found).clone()));
        }
        Ok(self.layers.get().cloned())
    }

    fn remember_level(&mut self, level: Level<D>, band: Option<Band>, place: usize) -> Result<()> {
        if *self.convection.grid().domain() != self.fixed.setup.domain.clone().at(level.time) {
            self.convection = Convection::new(&*self.grid_at(level.time)?, &level.fluid)?;
        }
        let band = match band {
            None if self.fixed.method.jumps() => Some(level.band(self.convection.grid(), &self.fixed.body_types)?),
            known => known,
        };
        let extended = level.extended(band.as_ref(), &mut self.convection)?;
        self.past.insert(place, (level, extended));
        self.past.truncate(LEVELS);
        Ok(())
    }

    /// The flow before the first step.
    fn initial_flow(&self, centers: &[SVector<f64, D>]) -> Result<Vector> {
        let mut fluid = self.fixed.stokes.vector()?;
        let mean_velocity = self.fixed.imposed_mean_velocity();
        let mut values = fluid.local_mut()?;
        for axis in 0..D {
            values[self.fixed.grid.local_range(axis)].fill(mean_velocity[axis]);
        }
        if let Some((axis, _)) = self.fixed.grid.domain().open() {
            let grid = &self.fixed.grid;
            for (value, index) in values[grid.local_range(axis)].iter_mut().zip(grid.block(axis).indices()) {
                *value = grid.domain().inflow_at(&grid.position(axis, signed(index)));
            }
        }
        drop(values);
        self.start_bodies(centers, &mut fluid)?;
        Ok(fluid)
    }

    /// What there is before the first step.
    fn at_rest(&mut self, configuration: &Configuration<D>) -> Result<Solution<D>> {
        let fluid = self.initial_flow(configuration.centers)?;
        let bodies = &self.fixed.setup.bodies;
        let twists = self.starting_motions();
        let multipliers: Vec<_> = self.multiplier_counts().into_iter().map(|count| vec![0.0; count]).collect();
        let states = self.without_forces(configuration.centers, &twists);
        let spin_ups = vec![vec![0.0; planes::<D>().len()]; bodies.len()];
        self.current = Some(Level {
            time: configuration.time,
            fluid: fluid.copied()?,
            smooth: multipliers.clone(),
            slow: multipliers.clone(),
            lagging: multipliers.clone(),
            multipliers,
            centers: configuration.centers.to_vec(),
            twists,
            spin_ups,
            impulses: vec![Wrench::zero(); bodies.len()],
            resolved: 0.0,
        });
        Ok(Solution {
            bodies: states,
            fluid,
            on_mesh: None,
            mean_velocity: self.fixed.imposed_mean_velocity(),
            pressure_gradient: SVector::zeros(),
            walls: WallForces::none(),
            contact_forces: vec![0.0; configuration.contacts.len()],
            pair_stress: None,
            loads: Vec::new(),
            bond_stress: None,
            bond_forces: Vec::new(),
            lubrication: self.films_at_rest(configuration.centers)?,
            cost: Cost::default(),
        })
    }

    /// Bodies that the flow does not act on yet.
    fn without_forces(&self, centers: &[SVector<f64, D>], twists: &[Twist<D>]) -> Vec<BodyState<D>> {
        let state = |(center, twist): (&SVector<f64, D>, &Twist<D>)| BodyState {
            center: self.fixed.setup.domain.wrap(*center),
            twist: *twist,
            force: SVector::zeros(),
            torque: SMatrix::zeros(),
            stresslet: SMatrix::zeros(),
        };
        centers.iter().zip(twists).map(state).collect()
    }

    /// Films, if lubrication acts, before anything moves.
    fn films_at_rest(&mut self, centers: &[SVector<f64, D>]) -> Result<Option<Lubrication<D>>> {
        if !self.fixed.setup.interactions.resist() {
            return Ok(None);
        }
        let assembly = Assembly::of(&self.fixed, centers, self.assembly.take())?;
        let (world, mut walls) = (self.fixed.session.world(), WallForces::none().forces);
        let films = add_films(world, &assembly.layout, &assembly.films, &[], self.fixed.setup.viscosity, &mut [], &mut walls);
        self.assembly = Some(assembly);
        Ok(Some(films))
    }

    /// How bodies move before the first step.
    fn starting_motions(&self) -> Vec<Twist<D>> {
        let starts = self.fixed.setup.bodies.iter().zip(&self.inertia().starts);
        starts.map(|(suspended, start)| suspended.body.given_motion().unwrap_or(*start)).collect()
    }

    /// Lets what lies inside bodies that move do so too, of points of the grid the part that bodies fill around them.
    fn start_bodies(&self, centers: &[SVector<f64, D>], fluid: &mut Vector) -> Result<()> {
        let (grid, size) = (&self.fixed.grid, self.fixed.grid.spacing());
        let (mut places, mut motions) = (Vec::new(), Vec::new());
        let starts = self.fixed.setup.bodies.iter().zip(self.starting_motions()).zip(centers);
        for ((suspended, start), center) in starts.filter(|((_, start), _)| *start != Twist::zero()) {
            let ball = Ball { center: SVector::zeros(), radius: suspended.body.ball.radius };
            each_inside(grid, center, ball.radius + 0.5 * size.norm(), |Point { component, place, offset, shear, .. }| {
                places.push(place);
                motions.push((fraction(&ball, &offset, &size), (start.at(&offset) - shear)[component]));
            });
        }
        let mut scatter = Scatter::new(fluid, &places)?;
        let rest = scatter.fetch(fluid)?.to_vec();
        let changes: Vec<f64> = motions.iter().zip(rest).map(|((part, velocity), rest)| part * (velocity - rest)).collect();
        scatter.places().copy_from_slice(&changes);
        scatter.add_back(fluid)
    }

    /// The rates of change of motions at a time, and turns operators to the step that leads there.
    fn begin(&mut self, time: f64) -> Result<StepWeights> {
        let turned = self.fixed.turn_grid(self.fixed.setup.domain.clone().at(time))?;
        if turned != Turned::Nothing {
            self.assembly = None;
        }
        if turned == Turned::Images {
            self.inverse = None;
            if !self.fixed.condensed {
                self.recent = RecentHistories::default();
            }
        }
        // what has jumped in the first step is in no rate of change
        let jumped = self.past.len() == 2 && is_moved_at_once(&self.fixed.setup);
        let (last, earlier) = (self.past[0].0.time, self.past.get(1).filter(|_| !jumped).map(|(level, _)| level.time));
        let weights = StepWeights::new(time - last, earlier.map(|earlier| last - earlier));
        self.of_impulse = weights.of_impulse();
        let shift = self.inverse_diffusivity() * weights.rate[0];
        if self.inverse.is_none() || (shift / self.fixed.stokes.shift() - 1.0).abs() > SAME_SHIFT {
            let _stage = enter(Stage::SetUp);
            // the old one gives its memory back first
            self.inverse = None;
            // blocks of bodies may know the shift
            self.assembly = None;
            self.inverse = Some(self.fixed.shift_to(shift)?);
        }
        Ok(weights)
    }

    /// Puts what earlier times, walls, drive and known spin-ups bring into the flow without bodies, or into rows of its own.
    fn fill_undisturbed(
        &mut self,
        weights: StepWeights,
        assembly: &mut Assembly<D>,
        centers: &[SVector<f64, D>],
        surfaces: Option<&NearSurfaces>,
    ) -> Result<()> {
        let (inverse_diffusivity, setup) = (self.inverse_diffusivity(), &self.fixed.setup);
        let fastest = fastest(&self.fixed.grid, &self.past[0].0.fluid)?;
        let kept = kept(&self.fixed.grid, weights.step, inverse_diffusivity, fastest);
        let levels: Vec<(&Level<D>, &Extended<D>)> = self.past.iter().map(|(level, extended)| (level, extended)).collect();
        let times: Vec<f64> = self.past.iter().take(weights.levels()).map(|(level, _)| level.time).collect();
        let convection = convection_weights(times[0] + weights.step, &times);
        let viscous = weights.of_known_flux(weights.step / (inverse_diffusivity * self.fixed.grid.spacing().min().powi(2)));
        let past = Past { levels: &levels, weights, convection, viscous, inverse_diffusivity, kept };
        let body_types = self.fixed.method.jumps().then_some(&self.fixed.body_types);
        let mut rows = past.rows(&self.fixed.grid, body_types, centers, surfaces)?;
        let lost = past.lost(&self.fixed.grid, &rows)?;
        self.momentum_residual = lost * (setup.viscosity * self.fixed.grid.spacing().product());
        add_drive(&self.fixed.grid, &setup.drive, setup.viscosity, &mut rows)?;
        add_walls(&self.fixed.grid, &mut rows)?;
        if let Some(ends) = OpenEnds::after(&self.fixed.grid, &self.past[0].0.fluid, weights.step)? {
            ends.add_rows(&self.fixed.grid, &mut rows)?;
        }
        let known = assembly.known_spin_ups(&self.fixed)?;
        assembly.blocks.spread_spin_up(1.0, &known.local()?, &mut rows)?;
        self.fixed.stokes.balance(&mut rows)?;
        let inverse = self.inverse.as_deref_mut().expect("a step has begun");
        if !self.fixed.condensed {
            self.fixed.fluid_rows = Some(rows);
            self.fixed.undisturbed.1 = vec![0.0; self.fixed.mean_flow.forces().len()];
            return Ok(());
        }
        let mut flow = self.fixed.undisturbed.0.take().map_or_else(|| self.fixed.stokes.vector(), Ok)?;
        FluidSystem { stokes: &self.fixed.stokes, inverse: Some(inverse) }.solve(&rows, &mut flow, 0.0, 0)?;
        let wanted = self.fixed.mean_flow.wanted(&self.fixed.setup.drive);
        let forces = self.fixed.mean_flow.correct_mean_velocities(self.fixed.session.world(), &wanted, &mut flow)?;
        self.fixed.undisturbed = (Some(flow), forces);
        Ok(())
    }

    /// The blocks of bodies, with what is known before a step is solved.
    fn assembled(&mut self, centers: &[SVector<f64, D>], weights: StepWeights, forgetting: Forgetting) -> Result<Assembly<D>> {
        let _stage = enter(Stage::Assembly);
        let mut assembly = Assembly::of(&self.fixed, centers, self.assembly.take())?;
        // frames that slide past each other see what lags behind at different places
        let near = self.fixed.method.jumps() && self.fixed.setup.domain.slide().is_none();
        let surfaces = near.then(|| NearSurfaces::new(&self.fixed.grid, &self.fixed.body_types, centers, &self.past[0].0)).transpose()?;
        self.fill_undisturbed(weights, &mut assembly, centers, surfaces.as_ref())?;
        assembly.meet_flow(&self.fixed)?;
        if let Some(surfaces) = &surfaces {
            let mut missed = vec![0.0; assembly.undisturbed.len()];
            assembly.blocks.interpolate(&surfaces.missed()?, &mut missed)?;
            assembly.undisturbed.iter_mut().zip(missed).for_each(|(known, missed)| *known += missed);
        }
        if self.fixed.method.jumps() {
            damp(&self.fixed, &mut assembly, &self.past[0].0.slow, (-forgetting.in_gaps).exp());
        }
        Ok(assembly)
    }

    /// Solves the linear system of a step; the multipliers of all bodies besides, where jump functions need them.
    fn solve_system(
        &mut self,
        assembly: Assembly<D>,
        configuration: &Configuration<D>,
        weights: StepWeights,
        monitor: ResidualMonitor,
    ) -> Result<(Solution<D>, Vec<Vec<f64>>)> {
        let (start, fixed) = (Instant::now(), &self.fixed);
        let mut ready = AssembledSystem::new(fixed, Some(assembly), self.workspace.take(), self.recent.last(), configuration)?;
        self.cost.multiplier_unknowns = ready.bodies.layout.unknowns();
        self.cost.assembly += start.elapsed().as_secs_f64();
        self.cost.assembled = ready.assembly.assembled;
        let inverse = self.inverse.as_deref_mut().expect("a step has begun");
        let solved = ready.solve(fixed, inverse, monitor);
        let (report, mut found) = solved.map_err(|error| with_smallest_gap(error, &fixed.setup, configuration))?;
        let AssembledSystem { bodies, assembly, mut workspace, guess, pair_constraints, .. } = ready;
        self.cost.krylov = report;
        self.cost.stages = std::mem::take(&mut workspace.work.stages);
        let constraints = found.global_unknowns.split_off(fixed.mean_flow.unknowns::<D>());
        let mut multipliers = vec![Vec::new(); configuration.centers.len()];
        if fixed.method.on_surfaces() {
            let last = Snapshot::of(&bodies, &fixed.session, configuration.centers, &found, fixed.condensed)?;
            if fixed.method.jumps() {
                multipliers.clone_from(&last.multipliers);
            }
            self.recent.add(last, guess, configuration.time);
        }
        let mut solution = readback::solution(fixed, &bodies, &assembly, &pair_constraints, &constraints, found, configuration)?;
        drop(bodies);
        solution.contact_forces.iter_mut().for_each(|force| *force /= weights.of_impulse());
        self.refuse_unstable(&solution.fluid, configuration.time, weights.step)?;
        (self.assembly, self.workspace) = (Some(assembly), Some(workspace));
        Ok((solution, multipliers))
    }

    /// Completes what a step has found by what its momentum says, and keeps it for the next ones.
    fn keep(
        &mut self,
        solution: &mut Solution<D>,
        multipliers: Vec<Vec<f64>>,
        configuration: &Configuration<D>,
        weights: StepWeights,
        forgetting: Forgetting,
    ) -> Result<()> {
        let momentum = Momentum::new(&self.fixed.setup, &weights, self.past.iter().map(|(level, _)| level));
        let spin_ups = momentum.complete(&mut solution.bodies);
        let twists = solution.bodies.iter().map(|state| state.twist).collect();
        let (time, centers) = (configuration.time, configuration.centers.to_vec());
        let last = &self.past[0].0;
        let before = if self.past.len() > 1 { &last.multipliers } else { &multipliers };
        let means = [(&last.smooth, forgetting.of_jumps), (&last.slow, forgetting.in_gaps), (&last.lagging, forgetting.of_rates)];
        let [smooth, slow, lagging] = means.map(|(means, forgetting)| followed(means, before, &multipliers, forgetting));
        let resolved = last.resolved;
        // layers thinner than a cell, as at the start, tell no rates; frames that slide past each other would see them at different places
        let lagging = between(&smooth, &lagging, if self.fixed.setup.domain.slide().is_some() { 0.0 } else { resolved });
        let mut impulses = vec![Wrench::zero(); centers.len()];
        let contacts = configuration.contacts.iter().zip(&solution.contact_forces);
        for (body, push) in contacts.flat_map(|(row, force)| row.wrenches(force * weights.step)) {
            impulses[body].force += push.direction;
            impulses[body].torque += push.turn;
        }
        let fluid = solution.fluid.copied()?;
        self.current = Some(Level { time, fluid, multipliers, smooth, slow, lagging, centers, twists, spin_ups, impulses, resolved });
        self.forget_surroundings();
        Ok(())
    }

    /// Ends a step that is too long for what the flow carries along.
    fn refuse_unstable(&self, fluid: &Vector, time: f64, step: f64) -> Result<()> {
        let (size, spacing) = (fluid.norm()?, self.fixed.grid.spacing().min());
        let courant = fastest(&self.fixed.grid, fluid)? * step / spacing;
        if size.is_finite() && courant < MEANINGLESS_COURANT {
            return Ok(());
        }
        let remedy = if self.fixed.setup.domain.slide().is_some() {
            "images of a sheared box slide by whole cells in a step: make the box longer along y, or lower flow.density"
        } else {
            "choose a shorter time.step, or \"auto\""
        };
        Err(Error::CourantExceeded(format!(
            "at time {time} the flow passes {courant:.1} cells in a step of {step:.3e}, more than it can follow; {remedy}"
        )))
    }

    /// Ends a run whose steps are too short for bodies lighter than the fluid. A single short one, as at the end of a run, lets nothing grow.
    fn refuse_short(&self, time: f64, step: f64) -> Result<()> {
        let shortest = shortest_step(&self.fixed.setup, self.fixed.grid.spacing().max());
        let earlier = self.past.get(1).map_or(f64::INFINITY, |(earlier, _)| self.past[0].0.time - earlier.time);
        if step.max(earlier) >= SHORTER * shortest {
            return Ok(());
        }
        Err(Error::Diverged(format!(
            "at time {time} a step of {step:.3e} is too short for bodies lighter than the fluid, which are stable from {shortest:.1e} on, where viscosity reaches part of a cell; \
             refine [resolution], or choose a longer time.step"
        )))
    }

    /// Number of multipliers of each body that levels have.
    fn multiplier_counts(&self) -> Vec<usize> {
        let count = |body| if self.fixed.method.jumps() { self.fixed.body_types.surface(body).modes.count() } else { 0 };
        (0..self.fixed.setup.bodies.len()).map(count).collect()
    }
}

impl<const D: usize> FlowSolver<D> for UnsteadySuspension<D> {
    fn grid(&self) -> &Grid<D> {
        &self.fixed.grid
    }

    fn setup(&self) -> &Setup<D> {
        &self.fixed.setup
    }

    fn prepare(&mut self, time: f64, _domain: &Domain<D>, again: bool) -> Result<()> {
        self.fixed.setup.prescribe(time);
        self.forget_from(if again { time.next_up() } else { time });
        self.settle(time)?;
        if self.past.is_empty() { Ok(()) } else { self.begin(time).map(drop) }
    }

    fn resistance(&self) -> Resistance<'_, D> {
        Resistance::of_modes(&self.fixed, self.assembly.as_ref(), self.of_impulse)
    }

    fn evolution(&self) -> Option<&dyn Evolution<D>> {
        Some(self)
    }

    fn history(&self, time: f64) -> HistoryView<'_, D> {
        let all = self.current.iter().chain(self.past.iter().map(|(level, _)| level));
        HistoryView {
            past: self.recent.before(time),
            levels: all.filter(|level| level.time < time).take(LEVELS).collect(),
            mesh_levels: Vec::new(),
            shape: HistoryShape { fluid: !self.fixed.condensed, multipliers: self.multiplier_counts(), levels: LEVELS, mesh_levels: 0 },
        }
    }

    fn restore(&mut self, history: History<D>) -> Result<()> {
        self.recent = history.past.into();
        let mut levels = history.levels.into_iter();
        (self.current, self.past) = (levels.next(), Vec::new());
        self.forget_surroundings();
        levels.try_for_each(|level| self.remember_level(level, None, self.past.len()))
    }

    fn solve_at(&mut self, configuration: &Configuration<D>, monitor: ResidualMonitor) -> Result<Solution<D>> {
        let start = Instant::now();
        self.settle(configuration.time)?;
        if self.past.is_empty() {
            return self.at_rest(configuration);
        }
        let weights = self.begin(configuration.time)?;
        self.refuse_short(configuration.time, weights.step)?;
        let momentum = Momentum::new(&self.fixed.setup, &weights, self.past.iter().map(|(level, _)| level));
        let pushes = momentum.pushes(configuration.pushes);
        self.fixed.spin_ups = momentum.known_spin_ups(configuration.pushes);
        let forgetting = Forgetting::in_step(weights.step / (self.inverse_diffusivity() * self.fixed.grid.spacing().max().powi(2)));
        let assembly = self.assembled(configuration.centers, weights, forgetting)?;
        let factor = weights.of_impulse();
        let guess: Vec<f64> = configuration.contact_guess.iter().map(|force| factor * force).collect();
        let per_impulse = |row: &Row<D>| Row { compliance: row.compliance / factor, ..row.clone() };
        let contacts: Vec<Row<D>> = configuration.contacts.iter().map(per_impulse).collect();
        let configuration = Configuration { pushes: &pushes, contacts: &contacts, contact_guess: &guess, ..*configuration };
        self.cost.assembly = start.elapsed().as_secs_f64();
        let (mut solution, multipliers) = self.solve_system(assembly, &configuration, weights, monitor)?;
        self.keep(&mut solution, multipliers, &configuration, weights, forgetting)?;
        Ok(Solution { cost: self.cost, ..solution })
    }
}

impl<const D: usize> Evolution<D> for UnsteadySuspension<D> {
    fn longest_step(&self, pushes: &[Wrench<D>]) -> Result<f64> {
        let fastest = self.current.as_ref().map_or(Ok(0.0), |level| fastest(&self.fixed.grid, &level.fluid))?;
        let (setup, spacing) = (&self.fixed.setup, self.fixed.grid.spacing().min());
        let moves = fastest > 0.0 && !self.past.is_empty();
        Ok(if moves { longest_step(setup, spacing, fastest) } else { first_step(setup, spacing, fastest, pushes) })
    }

    fn on_grid(&self) -> Option<&dyn EvolutionOnGrid<D>> {
        Some(self)
    }
}

impl<const D: usize> EvolutionOnGrid<D> for UnsteadySuspension<D> {
    fn levels(&self) -> Vec<&Level<D>> {
        self.current.iter().chain(self.past.iter().map(|(level, _)| level)).take(LEVELS).collect()
    }

    fn courant(&self, step: f64) -> Result<Option<f64>> {
        let passed = |level: &Level<D>| Ok(fastest(&self.fixed.grid, &level.fluid)? * step / self.fixed.grid.spacing().min());
        self.current.as_ref().map(passed).transpose()
    }

    fn extended_flow(&self) -> Result<Option<Vector>> {
        let Some(level) = self.current.as_ref().filter(|_| self.fixed.method.jumps()) else { return Ok(None) };
        level.velocity_outside(&*self.grid_at(level.time)?, &self.fixed.body_types).map(Some)
    }

    fn momentum_residual(&self) -> f64 {
        self.momentum_residual.norm()
    }

    fn thinnest_layer(&self) -> Result<Option<f64>> {
        let thinnest = |layers: Vec<f64>| layers.into_iter().filter(|layer| *layer > 0.0).fold(f64::INFINITY, f64::min);
        Ok(self.layers()?.filter(|layers| !layers.is_empty()).map(thinnest))
    }
}
