//! The bodies of a setup as the linear system sees them: their blocks, their rows, their states.

use std::{collections::HashMap, rc::Rc};

use nalgebra::{DMatrix, SMatrix, SVector};

use super::{
    pair_constraints::RigidVector,
    surfaces::{BodyOperator, Inverse},
};
use crate::{
    body::{Motion, Twist, components, skew},
    constraint::{
        Blocks, Given, MultiplierLayout, Neighbourhood, PAIR_REACH, PairPreconditioner, PairTables, Placed, Pores,
        lubrication::LubricationPairs,
    },
    error::Result,
    geometry::Ball,
    grid::Grid,
    interaction::Wrench,
    petsc::{Session, Vector},
    setup::{Inertia, Setup, SuspendedBody},
    surface::{Shape, SurfaceTable},
    system::BodyState,
};

/// Near neighbours that are not few.
const FEW: usize = 3;

/// What bodies of equal size share, kept for the whole run.
pub struct BodyType<const D: usize> {
    /// Of the smallest ball that holds it.
    radius: f64,
    volume: f64,
    /// Velocities in unbounded fluid that unit multipliers of rigid modes cause.
    mobilities: RigidVector,
    order: usize,
    /// Mass per volume; 0 where nothing has inertia.
    density: f64,
    surface: Rc<SurfaceTable<D>>,
    /// What takes the tangential part of a traction; nothing without inertia.
    tangential: DMatrix<f64>,
    /// What a velocity of each rigid mode adds to the row of its force.
    inertia: RigidVector,
    /// Factor of the multiplier in that row: the row is a velocity, however large the force that accelerates the body.
    force_scale: RigidVector,
    /// Inverse of the diagonal block of a free body, and of one with prescribed motion.
    inverses: [Rc<DMatrix<f64>>; 2],
}

/// What a force or a torque on a body stands for.
pub struct RigidScales {
    /// Velocities in unbounded fluid that unit multipliers of rigid modes cause.
    pub mobilities: RigidVector,
    /// Force of a unit translation multiplier.
    pub force: f64,
    /// Velocity of a rotation mode at unit spin.
    pub lever: f64,
}

/// The kinds of a setup's bodies, and which kind each body is.
pub struct BodyTypes<const D: usize> {
    body_types: Vec<BodyType<D>>,
    kind_of: Vec<usize>,
    pair_tables: PairTables<D>,
    spacing: f64,
    mean_spacing: f64,
    /// Bodies that are no balls.
    shaped: Vec<ShapedBody<D>>,
}

/// A body that is no ball: its shape as it started, and how it is turned now.
struct ShapedBody<const D: usize> {
    body: usize,
    shape: Rc<dyn Shape<D>>,
    rotation: SMatrix<f64, D, D>,
}

/// The bodies in their places, shared out over the ranks.
pub struct Bodies<'a, const D: usize> {
    setup: &'a Setup<D>,
    grid: &'a Grid<D>,
    body_types: &'a BodyTypes<D>,
    /// Who holds which multipliers.
    pub layout: MultiplierLayout,
    /// All of them, with their centres in the box.
    pub placed: Rc<Vec<Placed<D>>>,
    /// Who is near whom.
    neighbourhood: Rc<Neighbourhood<D>>,
}

impl<const D: usize> BodyType<D> {
    fn ball(radius: f64, order: usize, density: f64, setup: &Setup<D>, grid: &Grid<D>) -> BodyType<D> {
        let ball = Ball { center: SVector::zeros(), radius };
        let surface = match setup.inertia {
            Some(_) => SurfaceTable::with_spin_up(radius, order, grid.mean_spacing()),
            None => ball.surface(order, grid.mean_spacing()),
        };
        BodyType::new(&ball, surface, order, density, setup)
    }

    fn new(shape: &dyn Shape<D>, surface: SurfaceTable<D>, order: usize, density: f64, setup: &Setup<D>) -> BodyType<D> {
        let (radius, volume) = (shape.bounding_radius(), shape.volume());
        let empty = Rc::new(DMatrix::zeros(0, 0));
        let (surface, inverses) = (Rc::new(surface), [empty.clone(), empty]);
        let tangential = if setup.inertia.is_some() { surface.tangential() } else { DMatrix::zeros(0, 0) };
        let (mobilities, inertia, force_scale) = (RigidVector::zeros(), RigidVector::zeros(), RigidVector::zeros());
        let mut kind = BodyType { radius, volume, order, density, surface, tangential, mobilities, inertia, force_scale, inverses };
        kind.answer_to(setup, 0.0);
        kind
    }

    /// Turns to the operator with a shift.
    fn answer_to(&mut self, setup: &Setup<D>, shift: f64) {
        let (modes, reach) = (&self.surface.modes, setup.reach());
        let mobility = if shift > 0.0 { modes.unsteady_mobility(shift, reach) } else { modes.isolated_mobility(reach) };
        let rigid = modes.rigid_count();
        let inertia = self.inertia(setup, shift);
        let share = inertia.map(|inertia| 1.0 / (1.0 + inertia.abs()));
        (self.inertia, self.force_scale) = (inertia.component_mul(&share), share * self.radius);
        let invert = |matrix: DMatrix<f64>| Rc::new(matrix.try_inverse().expect("the mobility of a body is positive definite"));
        let resistance = invert(mobility.clone());
        // a force moves a body that is rigid, and has to be accelerated
        let answer = |mode: usize| 1.0 / (resistance[(mode, mode)] + inertia[mode] / self.radius);
        self.mobilities = RigidVector::from_fn(|mode, _| if mode < rigid { answer(mode) } else { 0.0 });
        let mut given_force = mobility.clone();
        for mode in 0..rigid {
            given_force.row_mut(mode).scale_mut(self.inertia[mode]);
            given_force[(mode, mode)] += self.force_scale[mode];
        }
        self.inverses = [invert(given_force), resistance];
    }

    /// Mass in excess of the fluid's and the whole moment of inertia, over time, radius and force of a unit multiplier: fluid inside moves along.
    fn inertia(&self, setup: &Setup<D>, shift: f64) -> RigidVector {
        let Some(Inertia { fluid, .. }) = &setup.inertia else { return RigidVector::zeros() };
        let (modes, ball) = (&self.surface.modes, Ball { center: SVector::<f64, D>::zeros(), radius: self.radius });
        let excess = (self.density / fluid - 1.0) * ball.volume() / modes.force_factor();
        let lever = modes.torque_factor() / modes.force_factor();
        let turning = self.density / fluid * ball.moment_of_inertia() / (modes.torque_factor() * lever);
        RigidVector::from_fn(|mode, _| self.radius * shift * if mode < D { excess } else { turning })
    }
}

impl<const D: usize> BodyTypes<D> {
    /// The kinds of a setup's bodies.
    pub fn new(setup: &Setup<D>, grid: &Grid<D>) -> BodyTypes<D> {
        let (mut body_types, mut known) = (Vec::new(), HashMap::new());
        let kind_of = |(body, suspended): (usize, &SuspendedBody<D>)| {
            let (radius, order) = (suspended.body.ball.radius, suspended.order);
            let density = setup.inertia.as_ref().map_or(0.0, |inertia| inertia.bodies[body]);
            *known.entry((radius.to_bits(), order, density.to_bits())).or_insert_with(|| {
                body_types.push(BodyType::ball(radius, order, density, setup, grid));
                body_types.len() - 1
            })
        };
        let kind_of = setup.bodies.iter().enumerate().map(kind_of).collect();
        let given = if setup.interactions.turn() || ties_near(setup) { Given::Motions } else { Given::Forces };
        let (pair_tables, spacing, mean_spacing) = (PairTables::new(given), grid.spacing().max(), grid.mean_spacing());
        BodyTypes { body_types, kind_of, pair_tables, spacing, mean_spacing, shaped: Vec::new() }
    }

    /// Whether all bodies are balls.
    pub fn are_balls(&self) -> bool {
        self.shaped.is_empty()
    }

    /// Gives a body a shape, which starts unturned.
    pub fn give_shape(&mut self, body: usize, shape: Rc<dyn Shape<D>>, setup: &Setup<D>) {
        let kind = self.shaped_type(body, shape.as_ref(), setup);
        self.kind_of[body] = self.body_types.len();
        self.body_types.push(kind);
        self.shaped.push(ShapedBody { body, shape, rotation: SMatrix::identity() });
    }

    /// Turns bodies that are no balls by these rotations of all bodies from how they started; back to that if there are none.
    pub fn turn_to(&mut self, rotations: &[SMatrix<f64, D, D>], setup: &Setup<D>) {
        let mut shaped = std::mem::take(&mut self.shaped);
        for ShapedBody { body, shape, rotation } in &mut shaped {
            let turned = rotations.get(*body).copied().unwrap_or_else(SMatrix::identity);
            if turned != *rotation {
                *rotation = turned;
                let (kind, place) = (self.shaped_type(*body, shape.turned(&turned).as_ref(), setup), self.kind_of[*body]);
                self.body_types[place] = kind;
            }
        }
        self.shaped = shaped;
    }

    fn shaped_type(&self, body: usize, shape: &dyn Shape<D>, setup: &Setup<D>) -> BodyType<D> {
        let BodyType { order, density, .. } = *self.of(body);
        BodyType::new(shape, shape.surface(order, self.mean_spacing), order, density, setup)
    }

    /// Whether bodies have the surfaces with which they were placed.
    pub fn placed_so(&self, placed: &[Placed<D>]) -> bool {
        placed.iter().enumerate().all(|(body, placed)| Rc::ptr_eq(&placed.surface, self.surface(body)))
    }

    /// Turns to the operator with a shift.
    pub fn answer_to(&mut self, setup: &Setup<D>, shift: f64) {
        self.body_types.iter_mut().for_each(|kind| kind.answer_to(setup, shift));
    }

    /// The surface of a body.
    pub fn surface(&self, body: usize) -> &Rc<SurfaceTable<D>> {
        &self.of(body).surface
    }

    /// Largest spacing of the grid.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// What takes the tangential part of a traction of a body, where there is inertia.
    pub fn tangential(&self, body: usize) -> &DMatrix<f64> {
        &self.of(body).tangential
    }

    /// Bodies with their centres at the given places.
    pub fn place(&self, setup: &Setup<D>, centers: &[SVector<f64, D>]) -> Vec<Placed<D>> {
        let place = |(body, center): (usize, &SVector<f64, D>)| Placed {
            center: setup.domain.wrap(*center),
            surface: self.of(body).surface.clone(),
        };
        centers.iter().enumerate().map(place).collect()
    }

    fn of(&self, body: usize) -> &BodyType<D> {
        &self.body_types[self.kind_of[body]]
    }

    /// Radius of a body, and the order of its modes.
    pub fn radius_and_order(&self, body: usize) -> (f64, usize) {
        (self.of(body).radius, self.of(body).order)
    }

    /// What corrections by near pairs are for.
    pub fn given(&self) -> Given {
        self.pair_tables.given
    }

    /// How a body answers to forces and torques.
    pub fn rigid(&self, body: usize) -> RigidScales {
        let kind = self.of(body);
        let force = kind.surface.modes.force_factor();
        RigidScales { mobilities: kind.mobilities, force, lever: kind.surface.modes.torque_factor() / force }
    }

    /// Velocity of a body in unbounded fluid of unit viscosity that a unit translation multiplier causes, and the force of that multiplier.
    pub fn translation(&self, body: usize) -> (f64, f64) {
        (self.of(body).mobilities[0], self.of(body).surface.modes.force_factor())
    }
}

/// Whether bonds tie bodies that are near each other at the start.
fn ties_near<const D: usize>(setup: &Setup<D>) -> bool {
    let near = |ends: &[usize; 2]| {
        let [one, other] = ends.map(|body| setup.bodies[body].body.ball);
        let gap = setup.domain.nearest_image(other.center - one.center).norm() - one.radius - other.radius;
        gap < PAIR_REACH * 0.5 * (one.radius + other.radius)
    };
    setup.interactions.bonds().iter().any(near)
}

impl<'a, const D: usize> Bodies<'a, D> {
    /// The bodies of a setup, shared out as `layout` says.
    pub fn new(
        setup: &'a Setup<D>,
        grid: &'a Grid<D>,
        body_types: &'a BodyTypes<D>,
        placed: Rc<Vec<Placed<D>>>,
        neighbourhood: Rc<Neighbourhood<D>>,
        layout: MultiplierLayout,
    ) -> Self {
        Bodies { setup, grid, body_types, layout, placed, neighbourhood }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid<D> {
        self.grid
    }

    /// The multipliers of all bodies, from this rank's part; collective.
    pub fn share_multipliers(&self, session: &Session, local: &[f64]) -> Vec<Vec<f64>> {
        let local = self.layout.local_bodies.iter().map(|&body| (body, &local[self.layout.local(body)..][..self.layout.count(body)]));
        let numbers: Vec<f64> = local.flat_map(|(body, multipliers)| [&[body as f64], multipliers].concat()).collect();
        let all = session.world().gather(&numbers);
        let mut shared = vec![Vec::new(); self.placed.len()];
        let mut rest = &all[..];
        while let [body, following @ ..] = rest {
            let (multipliers, others) = following.split_at(self.layout.count(*body as usize));
            shared[*body as usize] = multipliers.to_vec();
            rest = others;
        }
        shared
    }

    /// This rank's part of the multipliers of all bodies.
    pub fn local_multipliers(&self, shared: &[Vec<f64>]) -> Vec<f64> {
        self.layout.local_bodies.iter().flat_map(|&body| shared[body].iter().copied()).collect()
    }

    fn surface(&self, body: usize) -> &SurfaceTable<D> {
        &self.body_types.of(body).surface
    }

    /// A body as a ball in the box.
    pub fn ball(&self, body: usize) -> Ball<D> {
        self.neighbourhood.balls[body]
    }

    /// The relative motions that interactions resist and that have a side on a body of this rank.
    pub fn films(&self) -> LubricationPairs<D> {
        self.setup.interactions.rows(&self.neighbourhood, &self.layout)
    }

    /// What the resolved flow resists already of the same, between bodies of this rank and walls.
    pub fn resolved_at_walls(&self) -> LubricationPairs<D> {
        self.setup.interactions.resolved_at_walls(&self.neighbourhood, &self.layout)
    }

    /// How many of [`FEW`] near neighbours each body lacks, as a part; a wall counts for all. Collective: only its own rank knows all of a body.
    pub fn few_neighbours(&self, session: &Session) -> Vec<f64> {
        let mut found = vec![0; self.placed.len()];
        let near = self.neighbourhood.pairs.iter().filter(|pair| self.neighbourhood.near(pair));
        near.flat_map(|pair| [pair.first, pair.second]).for_each(|body| found[body] += 1);
        self.neighbourhood.walls.iter().for_each(|near| found[near.body] = FEW);
        let mut few = vec![0.0; found.len()];
        self.layout.local_bodies.iter().for_each(|&body| few[body] = FEW.saturating_sub(found[body]) as f64 / FEW as f64);
        session.world().sum(&mut few);
        few
    }

    /// The pores between bodies, in 2D.
    pub fn pores(&self) -> Option<Pores> {
        Pores::new(&self.setup.domain, &self.neighbourhood, &self.layout)
    }

    /// The near pairs of this rank's bodies; collective.
    pub fn near_pairs(&self, session: &Session) -> Result<PairPreconditioner> {
        let multipliers = Vector::new(session, self.layout.local_unknowns())?;
        PairPreconditioner::new(&self.neighbourhood, &self.layout, &self.body_types.pair_tables, &multipliers)
    }

    /// This rank's bodies as operators of the coupled system, each with its damping, if there is any.
    pub fn operators(&self, blocks: &Blocks<D>, damping: &[f64]) -> Vec<BodyOperator> {
        let member = |(local, &body): (usize, &usize)| {
            let (kind, free, first) = (self.body_types.of(body), self.setup.bodies[body].body.free(), self.layout.local(body));
            let modes = &kind.surface.modes;
            let dense = &kind.inverses[usize::from(!free)];
            let inverse = match blocks.free_inverse(local) {
                None => Inverse::Dense(dense.clone()),
                Some(others) => Inverse::Split((0..modes.rigid_count()).map(|mode| dense[(mode, mode)]).collect(), others),
            };
            BodyOperator {
                range: first..first + self.layout.count(body),
                rigid: modes.rigid_count(),
                free,
                inverse,
                force_scale: kind.force_scale,
                area: modes.force_factor(),
                mobilities: kind.mobilities,
                inertia: kind.inertia,
                damping: damping.get(local).copied().unwrap_or(0.0),
            }
        };
        self.layout.local_bodies.iter().enumerate().map(member).collect()
    }

    /// The velocity of the flow without bodies on the surfaces, tested with all modes: `fluid`, if it is not zero, and a velocity besides it that is
    /// `known` of each body at points of its surface.
    pub fn undisturbed(
        &self,
        blocks: &mut Blocks<D>,
        fluid: Option<&Vector>,
        known: impl Fn(usize, &SVector<f64, D>) -> SVector<f64, D>,
    ) -> Result<Vec<f64>> {
        let mut velocities = vec![0.0; self.layout.local_unknowns()];
        if let Some(fluid) = fluid {
            blocks.interpolate_with_walls(fluid, &mut velocities)?;
        }
        for (local, &body) in self.layout.local_bodies.iter().enumerate() {
            let center = self.ball(body).center;
            let known = blocks.coefficients(local, |offset| known(body, &(center + offset)));
            velocities[self.layout.local(body)..].iter_mut().zip(known).for_each(|(velocity, known)| *velocity += known);
        }
        Ok(velocities)
    }

    /// The right-hand sides of this rank's bodies.
    ///
    /// `pushes` are forces and torques on all bodies besides those of the setup, or empty.
    pub fn wanted_rows(&self, blocks: &Blocks<D>, operators: &[BodyOperator], undisturbed: &[f64], pushes: &[Wrench<D>]) -> Vec<f64> {
        let rows = operators.iter().enumerate();
        let of = |(local, member): (usize, &BodyOperator)| {
            let push = pushes.get(self.layout.local_bodies[local]).copied().unwrap_or_else(Wrench::zero);
            self.wanted_rows_of(blocks, local, member, &undisturbed[member.range.clone()], push)
        };
        rows.flat_map(of).collect()
    }

    fn wanted_rows_of(&self, blocks: &Blocks<D>, local: usize, member: &BodyOperator, undisturbed: &[f64], push: Wrench<D>) -> Vec<f64> {
        let body = self.layout.local_bodies[local];
        let surface = self.surface(body);
        match self.setup.bodies[body].body.motion {
            Motion::Prescribed(twist) => {
                blocks.coefficients(local, |r| twist.at(r)).iter().zip(undisturbed).map(|(wanted, known)| wanted - known).collect()
            }
            Motion::Free { force, torque } => {
                let mut rows: Vec<f64> = undisturbed.iter().map(|known| -known).collect();
                let net = (force + push.force - self.force_on_fluid_inside(body)) / surface.modes.force_factor();
                let turn = components(&(torque + push.torque)).into_iter().map(|torque| torque / surface.modes.torque_factor());
                for (mode, wanted) in net.iter().copied().chain(turn).enumerate() {
                    rows[mode] = member.force_scale[mode] * wanted / self.setup.viscosity - member.inertia[mode] * undisturbed[mode];
                }
                rows
            }
        }
    }

    /// What a body force on the fluid alone would do to the fluid that the body takes the place of.
    fn force_on_fluid_inside(&self, body: usize) -> SVector<f64, D> {
        self.setup.drive.force_on_fluid_alone() * self.body_types.of(body).volume
    }

    /// The states of all bodies, on every rank, from velocities on surfaces and multipliers (this rank's parts); collective.
    pub fn states(&self, session: &Session, blocks: &Blocks<D>, velocities: &[f64], multipliers: &[f64]) -> Vec<BodyState<D>> {
        let mut numbers = Vec::new();
        for (local, &body) in self.layout.local_bodies.iter().enumerate() {
            let range = self.layout.local(body)..self.layout.local(body) + self.layout.count(body);
            let moment = blocks.first_moment(local, &multipliers[range.clone()]);
            numbers.push(body as f64);
            numbers.extend(self.state(body, &velocities[range.clone()], &multipliers[range], moment).pack());
        }
        let all = session.world().gather(&numbers);
        let mut states: Vec<(usize, BodyState<D>)> =
            all.chunks(1 + BodyState::<D>::packed_length()).map(|chunk| (chunk[0] as usize, BodyState::unpack(&chunk[1..]))).collect();
        states.sort_by_key(|&(body, _)| body);
        states.into_iter().map(|(_, state)| state).collect()
    }

    fn state(&self, body: usize, velocities: &[f64], multipliers: &[f64], moment: SMatrix<f64, D, D>) -> BodyState<D> {
        let (surface, viscosity) = (self.surface(body), self.setup.viscosity);
        let (modes, rigid) = (&surface.modes, surface.modes.rigid_count());
        let lever = modes.torque_factor() / modes.force_factor();
        let spin: Vec<f64> = velocities[D..rigid].iter().map(|mode| mode / lever).collect();
        let torque: Vec<f64> = multipliers[D..rigid].iter().map(|mode| -viscosity * modes.torque_factor() * mode).collect();
        let force = SVector::<f64, D>::from_column_slice(&multipliers[..D]) * (-viscosity * modes.force_factor());
        let moment = moment * -viscosity;
        let symmetric = (moment + moment.transpose()) * 0.5;
        BodyState {
            center: self.placed[body].center,
            twist: Twist { velocity: SVector::from_column_slice(&velocities[..D]), spin: skew(&spin) },
            force: force - self.force_on_fluid_inside(body),
            torque: skew(&torque),
            stresslet: symmetric - SMatrix::identity() * (symmetric.trace() / D as f64),
        }
    }
}
