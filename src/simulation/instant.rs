//! The instantaneous solve: bodies where they are, the flow and their motions at that instant.

use std::{rc::Rc, time::Instant};

use nalgebra::SVector;

use super::{
    BodyState, Setup, Solution,
    closure::{Closure, flow_without_bodies},
    coupled::{Coupled, Member, Stages, Work},
};
use crate::{
    body::{Motion, Twist, components, skew},
    constraint::{self, Blocks, Layout, Placed},
    error::{Error, Result},
    flow::{Drive, HypreInverse, Stokes, StokesInverse},
    geometry::near_pairs,
    grid::Grid,
    petsc::{Krylov, KrylovMethod, KrylovSettings, Report, Session, Vector},
    surface::SurfaceTable,
};

/// Iterations allowed for the coupled system; the restart is as long, so memory grows with the iterations made.
const MOST_ITERATIONS: usize = 600;

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
    /// Surfaces by (radius, order), one for all equal bodies.
    surfaces: Vec<Rc<SurfaceTable<D>>>,
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
        let world = session.world();
        let grid = Grid::new(&setup.domain, setup.spacing, world.size(), world.rank())?;
        let stokes = Stokes::new(session, &grid)?;
        let mut inverse = inverse(&stokes, &grid)?;
        let closure = Closure::new(&setup.drive, &grid, &stokes, inverse.as_mut())?;
        let undisturbed = flow_without_bodies(&setup.drive, &grid, &stokes, inverse.as_mut(), &closure)?;
        let surfaces = surfaces(&setup, &grid);
        let cost = Cost { setup: start.elapsed().as_secs_f64(), grid_unknowns: grid.fluid_unknowns(), ..Cost::default() };
        let simulation = Simulation { session: session.clone(), setup, grid, stokes, inverse, closure, undisturbed, surfaces, cost };
        simulation.check_steady_state()?;
        Ok(simulation)
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
        let (layout, placed) = self.place_bodies();
        let mut blocks = self.assemble(&layout, &placed)?;
        let members = self.members(&layout);
        let undisturbed = self.undisturbed_velocities(&layout, &mut blocks)?;
        self.cost.assembly = start.elapsed().as_secs_f64();
        self.cost.multiplier_unknowns = layout.unknowns();

        let prescribed_drag = prescribed_drag(&self.session, &members);
        let mut work = Work::new(&self.stokes, layout.local_unknowns())?;
        let rhs = self.right_hand_side(&layout, &members, &undisturbed, prescribed_drag)?;
        let mut x = rhs.like()?;
        let mut coupled = Coupled {
            stokes: &self.stokes,
            inverse: self.inverse.as_mut(),
            blocks: &mut blocks,
            members: &members,
            closure: &self.closure,
            prescribed_drag,
            work: &mut work,
        };
        let settings = KrylovSettings {
            method: KrylovMethod::Gmres { restart: MOST_ITERATIONS },
            tolerance: self.setup.tolerance,
            most_iterations: MOST_ITERATIONS,
        };
        let mut krylov = Krylov::new(&self.session, rhs.local()?.len(), c"coupled_", settings)?;
        self.cost.krylov = krylov.solve(&mut coupled, (&rhs, &mut x), seen)?;
        let velocities = coupled.velocity_on_surfaces(&x)?;
        let (fluid, multipliers, tail) = coupled.parts(&x)?;
        let mut total = fluid.like()?;
        total.copy_from(fluid)?;
        self.cost.stages = work.stages;
        total.add(1.0, &self.undisturbed.0)?;
        let bodies = self.body_states(&layout, &velocities, &undisturbed, &multipliers);
        self.solution(bodies, total, &tail)
    }

    fn check_steady_state(&self) -> Result<()> {
        let all_free = self.setup.bodies.iter().all(|suspended| suspended.body.free());
        if matches!(self.closure, Closure::MeanVelocity) && all_free && self.setup.drive.uniform_force() != SVector::<f64, D>::zeros() {
            return Err(Error::Refused(
                "flow.drive: a uniform force on a fully periodic box in which nothing is fixed has no steady flow; \
                 fix a body, put up walls, or prescribe mean_velocity"
                    .into(),
            ));
        }
        Ok(())
    }

    fn surface(&self, body: usize) -> &Rc<SurfaceTable<D>> {
        &self.surfaces[body]
    }

    fn place_bodies(&self) -> (Layout, Vec<Placed<D>>) {
        let placed: Vec<Placed<D>> = (0..self.setup.bodies.len())
            .map(|body| Placed {
                center: self.setup.domain.wrap(self.setup.bodies[body].body.ball.center),
                surface: self.surface(body).clone(),
            })
            .collect();
        let centers: Vec<SVector<f64, D>> = placed.iter().map(|placed| placed.center).collect();
        let modes: Vec<usize> = placed.iter().map(|placed| placed.surface.modes.count()).collect();
        (Layout::new(&self.grid, &centers, &modes, self.session.world().rank()), placed)
    }

    fn assemble(&self, layout: &Layout, placed: &[Placed<D>]) -> Result<Blocks<D>> {
        let balls: Vec<_> = self.setup.bodies.iter().map(|suspended| suspended.body.ball).collect();
        let reach = constraint::INTERPOLATION_REACH * self.grid.spacing().max();
        let mut neighbours: Vec<Vec<(usize, Placed<D>)>> = vec![Vec::new(); placed.len()];
        for pair in near_pairs(&self.setup.domain, &balls, reach) {
            for (body, other, separation) in [(pair.first, pair.second, pair.separation), (pair.second, pair.first, -pair.separation)] {
                let image = Placed { center: placed[body].center + separation, surface: placed[other].surface.clone() };
                neighbours[body].push((other, image));
            }
        }
        let bodies = layout
            .local_bodies
            .iter()
            .map(|&body| constraint::assemble(&self.grid, layout, body, &placed[body], &neighbours[body]))
            .collect();
        Blocks::new(&self.session, &self.undisturbed.0, layout, bodies)
    }

    fn members(&self, layout: &Layout) -> Vec<Member> {
        let reach = 0.5 * self.setup.domain.size.min();
        let member = |&body: &usize| {
            let (modes, free) = (&self.surface(body).modes, self.setup.bodies[body].body.free());
            let (first, rigid) = (layout.local(body), modes.rigid_count());
            let mut mobility = modes.isolated_mobility(reach);
            let force_scale = modes.radius();
            if free {
                (0..rigid).for_each(|mode| mobility[(mode, mode)] = force_scale);
            }
            Member {
                range: first..first + modes.count(),
                rigid,
                free,
                inverse: Rc::new(mobility.try_inverse().expect("the mobility of a body is positive definite")),
                force_scale,
                area: modes.force_factor(),
            }
        };
        layout.local_bodies.iter().map(member).collect()
    }

    /// The velocity of the flow without bodies on the surfaces, tested with all modes: this rank's part.
    fn undisturbed_velocities(&self, layout: &Layout, blocks: &mut Blocks<D>) -> Result<Vec<f64>> {
        let mut velocities = vec![0.0; layout.local_unknowns()];
        blocks.sample_with_walls(&self.undisturbed.0, &mut velocities)?;
        let uniform = self.imposed_mean_velocity();
        for &body in &layout.local_bodies {
            let center = self.setup.bodies[body].body.ball.center;
            let known = self.surface(body).coefficients(|r| uniform + self.setup.drive.background(&(center + r)));
            velocities[layout.local(body)..].iter_mut().zip(known).for_each(|(velocity, known)| *velocity += known);
        }
        Ok(velocities)
    }

    /// The mean velocity that a fully periodic box is given; elsewhere the flow without bodies has it.
    fn imposed_mean_velocity(&self) -> SVector<f64, D> {
        match self.setup.drive {
            Drive::MeanVelocity(velocity) if self.setup.domain.fully_periodic() => velocity,
            _ => SVector::zeros(),
        }
    }

    fn right_hand_side(&self, layout: &Layout, members: &[Member], undisturbed: &[f64], prescribed_drag: f64) -> Result<Vector> {
        let fluid = self.grid.local_fluid_unknowns();
        let tail = if self.session.world().rank() == 0 { self.closure.unknowns::<D>() } else { 0 };
        let mut rhs = Vector::new(&self.session, fluid + layout.local_unknowns() + tail)?;
        {
            let mut rows = rhs.local_mut()?;
            for (member, &body) in members.iter().zip(&layout.local_bodies) {
                let wanted = self.wanted_rows(body, member, &undisturbed[member.range.clone()]);
                rows[fluid..][member.range.clone()].copy_from_slice(&wanted);
            }
            if tail > 0 && matches!(self.closure, Closure::MeanVelocity) {
                let drag = prescribed_drag;
                let force = -self.setup.drive.uniform_force() * self.setup.domain.volume() / self.setup.viscosity / drag;
                rows[fluid + layout.local_unknowns()..].copy_from_slice(force.as_slice());
            }
        }
        Ok(rhs)
    }

    fn wanted_rows(&self, body: usize, member: &Member, undisturbed: &[f64]) -> Vec<f64> {
        let surface = self.surface(body);
        match self.setup.bodies[body].body.motion {
            Motion::Prescribed(twist) => {
                surface.coefficients(|r| twist.at(r)).iter().zip(undisturbed).map(|(wanted, known)| wanted - known).collect()
            }
            Motion::Free { force, torque } => {
                let mut rows: Vec<f64> = undisturbed.iter().map(|known| -known).collect();
                let volume = self.volume(body);
                let net = (force - self.setup.drive.force_on_fluid_alone() * volume) / self.setup.viscosity / surface.modes.force_factor();
                rows[..D].copy_from_slice((net * member.force_scale).as_slice());
                let turn = member.force_scale / self.setup.viscosity / surface.modes.torque_factor();
                let torques = components(&torque);
                rows[D..member.rigid].iter_mut().zip(torques).for_each(|(row, torque)| *row = turn * torque);
                rows
            }
        }
    }

    fn volume(&self, body: usize) -> f64 {
        self.setup.bodies[body].body.ball.volume()
    }

    fn body_states(&self, layout: &Layout, velocities: &[f64], undisturbed: &[f64], multipliers: &[f64]) -> Vec<BodyState<D>> {
        let mut numbers = Vec::new();
        for &body in &layout.local_bodies {
            let range = layout.local(body)..layout.local(body) + self.surface(body).modes.count();
            let motion: Vec<f64> = velocities[range.clone()].iter().zip(&undisturbed[range.clone()]).map(|(a, b)| a + b).collect();
            numbers.push(body as f64);
            numbers.extend(self.body_state(body, &motion, &multipliers[range]).pack());
        }
        let mut states = Vec::new();
        for chunk in self.session.world().gather(&numbers).chunks(1 + BodyState::<D>::packed_length()) {
            states.push((chunk[0] as usize, BodyState::unpack(&chunk[1..])));
        }
        states.sort_by_key(|&(body, _)| body);
        states.into_iter().map(|(_, state)| state).collect()
    }

    fn body_state(&self, body: usize, motion: &[f64], multipliers: &[f64]) -> BodyState<D> {
        let (surface, viscosity) = (self.surface(body), self.setup.viscosity);
        let modes = &surface.modes;
        let rotation = modes.torque_factor() / modes.force_factor();
        let spin: Vec<f64> = motion[D..modes.rigid_count()].iter().map(|mode| mode / rotation).collect();
        let torque: Vec<f64> = multipliers[D..modes.rigid_count()].iter().map(|mode| -viscosity * modes.torque_factor() * mode).collect();
        let moment = -viscosity * surface.first_moment(multipliers);
        let symmetric = (moment + moment.transpose()) * 0.5;
        let net = SVector::from_fn(|axis, _| -viscosity * modes.force_factor() * multipliers[axis]);
        BodyState {
            twist: Twist { velocity: SVector::from_column_slice(&motion[..D]), spin: skew(&spin) },
            force: net - self.setup.drive.force_on_fluid_alone() * self.volume(body),
            torque: skew(&torque),
            stresslet: symmetric - nalgebra::SMatrix::identity() * (symmetric.trace() / D as f64),
        }
    }

    fn solution(&self, bodies: Vec<BodyState<D>>, mut fluid: Vector, tail: &[f64]) -> Result<Solution<D>> {
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

fn surfaces<const D: usize>(setup: &Setup<D>, grid: &Grid<D>) -> Vec<Rc<SurfaceTable<D>>> {
    let mut known: Vec<((f64, usize), Rc<SurfaceTable<D>>)> = Vec::new();
    let mut all = Vec::new();
    for suspended in &setup.bodies {
        let key = (suspended.body.ball.radius, suspended.order);
        let found = known.iter().find(|(other, _)| *other == key).map(|(_, table)| table.clone());
        let table = found.unwrap_or_else(|| {
            let table = Rc::new(SurfaceTable::new(key.0, key.1, grid.mean_spacing()));
            known.push((key, table.clone()));
            table
        });
        all.push(table);
    }
    all
}

/// Sum over all prescribed bodies of the net force that a unit velocity takes by their preconditioner.
fn prescribed_drag(session: &Session, members: &[Member]) -> f64 {
    let mut drag = [members.iter().filter(|member| !member.free).map(|member| member.area * member.inverse[(0, 0)]).sum()];
    session.world().sum(&mut drag);
    if drag[0] > 0.0 { drag[0] } else { 1.0 }
}
