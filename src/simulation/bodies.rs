//! The bodies of a setup as the linear system sees them: their blocks, their rows, their states.

use std::{collections::HashMap, rc::Rc};

use nalgebra::{DMatrix, SMatrix, SVector};

use super::{BodyState, Setup, surfaces::Member};
use crate::{
    body::{Motion, Twist, components, skew},
    constraint::{self, Blocks, Crowd, Layout, NearPairs, PairTables, Placed, Situation},
    error::Result,
    geometry::{Ball, near_pairs},
    grid::Grid,
    petsc::{Session, Vector},
    surface::SurfaceTable,
};

/// What bodies of equal size share, kept for the whole run.
pub struct Kind<const D: usize> {
    radius: f64,
    /// Velocity in unbounded fluid that a unit translation multiplier causes.
    mobility: f64,
    order: usize,
    surface: Rc<SurfaceTable<D>>,
    /// Inverse of the diagonal block of a free body, and of one with prescribed motion.
    inverses: [Rc<DMatrix<f64>>; 2],
}

/// The kinds of a setup's bodies, and which kind each body is.
pub struct Kinds<const D: usize> {
    kinds: Vec<Kind<D>>,
    kind_of: Vec<usize>,
    pair_tables: PairTables<D>,
}

/// The bodies in their places, shared out over the ranks.
pub struct Bodies<'a, const D: usize> {
    setup: &'a Setup<D>,
    grid: &'a Grid<D>,
    kinds: &'a Kinds<D>,
    /// Who holds which multipliers.
    pub layout: Layout,
    /// All of them, with their centres in the box.
    pub placed: Vec<Placed<D>>,
}

impl<const D: usize> Kind<D> {
    fn new(radius: f64, order: usize, setup: &Setup<D>, grid: &Grid<D>) -> Kind<D> {
        let surface = Rc::new(SurfaceTable::new(radius, order, grid.mean_spacing()));
        // other bodies cut the logarithm: half the distance to them
        let reach = 0.5 * (setup.domain.volume() / setup.bodies.len() as f64).powf(1.0 / D as f64);
        let mobility = surface.modes.isolated_mobility(reach);
        let translation = mobility[(0, 0)];
        let mut given_force = mobility.clone();
        for mode in 0..surface.modes.rigid_count() {
            given_force[(mode, mode)] = radius;
        }
        let invert = |matrix: DMatrix<f64>| Rc::new(matrix.try_inverse().expect("the mobility of a body is positive definite"));
        Kind { radius, order, surface, mobility: translation, inverses: [invert(given_force), invert(mobility)] }
    }
}

impl<const D: usize> Kinds<D> {
    /// The kinds of a setup's bodies.
    pub fn new(setup: &Setup<D>, grid: &Grid<D>) -> Kinds<D> {
        let mut kinds: Vec<Kind<D>> = Vec::new();
        let mut kind_of = Vec::new();
        for suspended in &setup.bodies {
            let (radius, order) = (suspended.body.ball.radius, suspended.order);
            let known = kinds.iter().position(|kind| kind.radius == radius && kind.order == order);
            kind_of.push(known.unwrap_or_else(|| {
                kinds.push(Kind::new(radius, order, setup, grid));
                kinds.len() - 1
            }));
        }
        Kinds { kinds, kind_of, pair_tables: PairTables::default() }
    }

    fn of(&self, body: usize) -> &Kind<D> {
        &self.kinds[self.kind_of[body]]
    }

    /// Velocity of a body in unbounded fluid of unit viscosity that a unit translation multiplier causes, and the force of that multiplier.
    pub fn translation(&self, body: usize) -> (f64, f64) {
        (self.of(body).mobility, self.of(body).surface.modes.force_factor())
    }
}

impl<'a, const D: usize> Bodies<'a, D> {
    /// Shares out the bodies of a setup with their centres at the given places, seen from `rank`.
    pub fn new(setup: &'a Setup<D>, grid: &'a Grid<D>, kinds: &'a Kinds<D>, centers: &[SVector<f64, D>], rank: usize) -> Self {
        let place = |(body, center): (usize, &SVector<f64, D>)| Placed {
            center: setup.domain.wrap(*center),
            surface: kinds.of(body).surface.clone(),
        };
        let placed: Vec<Placed<D>> = centers.iter().enumerate().map(place).collect();
        let centers: Vec<SVector<f64, D>> = placed.iter().map(|placed| placed.center).collect();
        let modes: Vec<usize> = placed.iter().map(|placed| placed.surface.modes.count()).collect();
        Bodies { setup, grid, kinds, layout: Layout::new(grid, &centers, &modes, rank), placed }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid<D> {
        self.grid
    }

    /// The multipliers of all bodies, from this rank's part; collective.
    pub fn share_multipliers(&self, session: &Session, local: &[f64]) -> Vec<Vec<f64>> {
        let local = self.layout.local_bodies.iter().map(|&body| (body, &local[self.layout.local(body)..][..self.modes(body)]));
        let numbers: Vec<f64> = local.flat_map(|(body, multipliers)| [&[body as f64], multipliers].concat()).collect();
        let all = session.world().gather(&numbers);
        let mut shared = vec![Vec::new(); self.placed.len()];
        let mut rest = &all[..];
        while let [body, following @ ..] = rest {
            let (multipliers, others) = following.split_at(self.modes(*body as usize));
            shared[*body as usize] = multipliers.to_vec();
            rest = others;
        }
        shared
    }

    /// This rank's part of the multipliers of all bodies.
    pub fn local_multipliers(&self, shared: &[Vec<f64>]) -> Vec<f64> {
        self.layout.local_bodies.iter().flat_map(|&body| shared[body].iter().copied()).collect()
    }

    fn modes(&self, body: usize) -> usize {
        self.surface(body).modes.count()
    }

    fn surface(&self, body: usize) -> &SurfaceTable<D> {
        &self.kinds.of(body).surface
    }

    fn ball(&self, body: usize) -> Ball<D> {
        Ball { center: self.placed[body].center, ..self.setup.bodies[body].body.ball }
    }

    /// The blocks of this rank's bodies; those of `earlier` ones that did not move, nor their neighbours, stay as they are.
    ///
    /// Returns them with the number of bodies, of this rank, whose blocks are new. `fluid` is any fluid vector.
    pub fn blocks(&self, session: &Session, fluid: &Vector, earlier: Option<Blocks<D>>) -> Result<(Blocks<D>, usize)> {
        let balls: Vec<Ball<D>> = (0..self.placed.len()).map(|body| self.ball(body)).collect();
        let reach = constraint::INTERPOLATION_REACH * self.grid.spacing().max();
        let mut neighbours: Vec<Vec<(usize, Placed<D>)>> = vec![Vec::new(); self.placed.len()];
        for pair in near_pairs(&self.setup.domain, &balls, reach) {
            for (body, other, separation) in [(pair.first, pair.second, pair.separation), (pair.second, pair.first, -pair.separation)] {
                let image = Placed { center: self.placed[body].center + separation, surface: self.placed[other].surface.clone() };
                neighbours[body].push((other, image));
            }
        }
        let (mut workspace, mut kept) = (constraint::Workspace::default(), HashMap::new());
        for blocks in earlier.into_iter().flat_map(Blocks::into_bodies) {
            let body = blocks.situation.body;
            if self.layout.holds(body) && blocks.situation == Situation::of((body, &self.placed[body]), &neighbours[body]) {
                kept.insert(body, blocks);
            } else {
                workspace.recycle(blocks);
            }
        }
        let assembled = self.layout.local_bodies.len() - kept.len();
        let assemble = |&body: &usize| {
            let anew = || constraint::assemble(self.grid, (body, &self.placed[body]), &neighbours[body], &mut workspace);
            kept.remove(&body).unwrap_or_else(anew)
        };
        let bodies = self.layout.local_bodies.iter().map(assemble).collect();
        Ok((Blocks::new(session, fluid, &self.layout, bodies)?, assembled))
    }

    /// The near pairs of this rank's bodies; collective.
    pub fn near_pairs(&self, session: &Session) -> Result<NearPairs> {
        let balls: Vec<Ball<D>> = (0..self.placed.len()).map(|body| self.ball(body)).collect();
        let orders: Vec<usize> = self.setup.bodies.iter().map(|suspended| suspended.order).collect();
        let crowd = Crowd { domain: &self.setup.domain, balls: &balls, orders: &orders, layout: &self.layout };
        let multipliers = Vector::new(session, self.layout.local_unknowns())?;
        NearPairs::new(&crowd, &self.kinds.pair_tables, &multipliers)
    }

    /// This rank's bodies as members of the coupled system.
    pub fn members(&self) -> Vec<Member> {
        let member = |&body: &usize| {
            let (kind, free, first) = (self.kinds.of(body), self.setup.bodies[body].body.free(), self.layout.local(body));
            let modes = &kind.surface.modes;
            Member {
                range: first..first + modes.count(),
                rigid: modes.rigid_count(),
                free,
                inverse: kind.inverses[usize::from(!free)].clone(),
                force_scale: kind.radius,
                area: modes.force_factor(),
                mobility: kind.mobility,
            }
        };
        self.layout.local_bodies.iter().map(member).collect()
    }

    /// The velocity of the flow without bodies on the surfaces, tested with all modes: `fluid` and a `known` velocity besides it.
    pub fn undisturbed(
        &self,
        blocks: &mut Blocks<D>,
        fluid: &Vector,
        known: impl Fn(&SVector<f64, D>) -> SVector<f64, D>,
    ) -> Result<Vec<f64>> {
        let mut velocities = vec![0.0; self.layout.local_unknowns()];
        blocks.sample_with_walls(fluid, &mut velocities)?;
        for &body in &self.layout.local_bodies {
            let center = self.ball(body).center;
            let known = self.surface(body).coefficients(|offset| known(&(center + offset)));
            velocities[self.layout.local(body)..].iter_mut().zip(known).for_each(|(velocity, known)| *velocity += known);
        }
        Ok(velocities)
    }

    /// The right-hand sides of this rank's bodies.
    pub fn wanted_rows(&self, members: &[Member], undisturbed: &[f64]) -> Vec<f64> {
        let rows = members.iter().zip(&self.layout.local_bodies);
        rows.flat_map(|(member, &body)| self.wanted_rows_of(body, member, &undisturbed[member.range.clone()])).collect()
    }

    fn wanted_rows_of(&self, body: usize, member: &Member, undisturbed: &[f64]) -> Vec<f64> {
        let surface = self.surface(body);
        match self.setup.bodies[body].body.motion {
            Motion::Prescribed(twist) => {
                surface.coefficients(|r| twist.at(r)).iter().zip(undisturbed).map(|(wanted, known)| wanted - known).collect()
            }
            Motion::Free { force, torque } => {
                let mut rows: Vec<f64> = undisturbed.iter().map(|known| -known).collect();
                let scale = member.force_scale / self.setup.viscosity;
                let net = force - self.force_on_fluid_inside(body);
                rows[..D].copy_from_slice((net * (scale / surface.modes.force_factor())).as_slice());
                let turn = scale / surface.modes.torque_factor();
                rows[D..member.rigid].iter_mut().zip(components(&torque)).for_each(|(row, torque)| *row = turn * torque);
                rows
            }
        }
    }

    /// What a body force on the fluid alone would do to the fluid that the body takes the place of.
    fn force_on_fluid_inside(&self, body: usize) -> SVector<f64, D> {
        self.setup.drive.force_on_fluid_alone() * self.ball(body).volume()
    }

    /// The states of all bodies, on every rank, from velocities on surfaces and multipliers (this rank's parts); collective.
    pub fn states(&self, session: &Session, velocities: &[f64], multipliers: &[f64]) -> Vec<BodyState<D>> {
        let mut numbers = Vec::new();
        for &body in &self.layout.local_bodies {
            let range = self.layout.local(body)..self.layout.local(body) + self.surface(body).modes.count();
            numbers.push(body as f64);
            numbers.extend(self.state(body, &velocities[range.clone()], &multipliers[range]).pack());
        }
        let all = session.world().gather(&numbers);
        let mut states: Vec<(usize, BodyState<D>)> =
            all.chunks(1 + BodyState::<D>::packed_length()).map(|chunk| (chunk[0] as usize, BodyState::unpack(&chunk[1..]))).collect();
        states.sort_by_key(|&(body, _)| body);
        states.into_iter().map(|(_, state)| state).collect()
    }

    fn state(&self, body: usize, velocities: &[f64], multipliers: &[f64]) -> BodyState<D> {
        let (surface, viscosity) = (self.surface(body), self.setup.viscosity);
        let (modes, rigid) = (&surface.modes, surface.modes.rigid_count());
        let lever = modes.torque_factor() / modes.force_factor();
        let spin: Vec<f64> = velocities[D..rigid].iter().map(|mode| mode / lever).collect();
        let torque: Vec<f64> = multipliers[D..rigid].iter().map(|mode| -viscosity * modes.torque_factor() * mode).collect();
        let force = SVector::<f64, D>::from_column_slice(&multipliers[..D]) * (-viscosity * modes.force_factor());
        let moment = surface.first_moment(multipliers) * -viscosity;
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
