//! The resistance of bodies to motion, by their neighbours and through the constraints between them: sparse, and symmetric unless contacts slip.
//!
//! ```text
//! [ A + N' C^-1 N   P ] [ U ]   [ forces ]      N: rates of constraints for motions U, N' what they push     C: compliances     A: what bodies or near pairs resist
//! [ P'             -L ] [ p ] = [ flows  ]      p: pressures of pores, if they count (see [`Pores`])
//! ```
//!
//! It has the rigid modes of each body as unknowns, owned with the body, whatever the number of constraints. By the identity of Woodbury it
//! gives what `N A^-1 N' + C`, a matrix of the constraints, would.

use std::collections::BTreeMap;

use super::pair_constraint::PairConstraint;
use crate::{
    constraint::{Entries, EntriesMut, MultiplierLayout, Places, PoreShare, Pores, RigidBlock},
    error::Result,
    petsc::{RowBuilder, Scatter, Session, SparseMethod, SparseSolver, Vector},
};

/// Bodies in 3D beyond which factors of the network take more time than iterations: they grow with the square of the number.
const MOST_FACTORED: usize = 500;

/// Whether the network of so many bodies, of so many rigid modes each, is solved by iterations, to a loose tolerance.
pub fn iterated(rigid: usize, bodies: usize) -> bool {
    rigid > 3 && bodies > MOST_FACTORED
}

/// Rows of this rank's bodies, block by block: the numbers of two bodies, and what the motion of the second makes the first feel.
#[derive(Clone, Default)]
pub struct Resistances {
    blocks: BTreeMap<(usize, usize), RigidBlock>,
}

impl Resistances {
    /// Adds what one body feels of the motion of another, or of its own.
    pub fn add(&mut self, layout: &MultiplierLayout, [one, two]: [usize; 2], block: &RigidBlock) {
        if layout.holds(one) {
            *self.blocks.entry((layout.number(one), layout.number(two))).or_default() += block;
        }
    }

    /// Adds what constraints resist with the given compliances.
    pub fn add_constraints<'a>(
        &mut self,
        layout: &MultiplierLayout,
        constraints: impl Iterator<Item = &'a PairConstraint>,
        compliance: impl Fn(&PairConstraint) -> f64,
    ) {
        for constraint in constraints {
            for (one, two) in constraint.sides().flat_map(|one| constraint.sides().map(move |two| (one, two))) {
                self.add(layout, [one.body, two.body], &(one.push * two.weights.transpose() / compliance(constraint)));
            }
        }
    }
}

/// Where the unknowns of the network are: on each rank the rigid modes of its bodies, then its pores.
struct Numbering {
    rigid: usize,
    /// Where the modes of each body begin.
    of_body: Vec<usize>,
    of_pore: Vec<usize>,
    /// This rank's pores.
    pores: Vec<usize>,
}

impl Numbering {
    fn new(session: &Session, layout: &MultiplierLayout, rigid: usize, pores: Option<&Pores>) -> Numbering {
        let owners: Vec<usize> = pores.iter().flat_map(|pores| &pores.of_body).map(|&body| layout.owner(body)).collect();
        let (mut of_pore, mut before) = (vec![0; owners.len()], vec![0; session.world().size() + 1]);
        owners.iter().for_each(|&owner| before[owner + 1] += 1);
        (1..before.len()).for_each(|rank| before[rank] += before[rank - 1]);
        let of_body: Vec<usize> = (0..layout.bodies()).map(|body| rigid * layout.number(body) + before[layout.owner(body)]).collect();
        let mut bodies = vec![0; before.len()];
        (0..layout.bodies()).for_each(|body| bodies[layout.owner(body) + 1] += rigid);
        (1..bodies.len()).for_each(|rank| bodies[rank] += bodies[rank - 1]);
        let mut next: Vec<usize> = before.iter().zip(&bodies[1..]).map(|(pores, bodies)| pores + bodies).collect();
        for (place, &owner) in of_pore.iter_mut().zip(&owners) {
            (*place, next[owner]) = (next[owner], next[owner] + 1);
        }
        let rank = session.world().rank();
        let pores = (0..owners.len()).filter(|&pore| owners[pore] == rank).collect();
        Numbering { rigid, of_body, of_pore, pores }
    }

    fn local(&self, layout: &MultiplierLayout) -> usize {
        self.rigid * layout.local_bodies.len() + self.pores.len()
    }
}

/// A share of a body of this rank in a pore.
struct Share {
    /// The place of the pore.
    pore: u32,
    /// Where its multipliers begin.
    first: usize,
    /// Net force of a unit multiplier, over that of a unit of a constraint's unknown.
    unit: f64,
    multipliers: Vec<f64>,
}

/// The factored resistance.
pub struct Network {
    solver: SparseSolver,
    rigid: usize,
    /// Where the rigid modes of this rank's bodies begin among the multipliers.
    places: Vec<usize>,
    /// Whether any rank has pores.
    pores: bool,
    shares: Vec<Share>,
    others: Scatter,
    forces: Vector,
    motions: Vector,
}

/// What a network is made of.
pub struct NetworkParts<'a, S: Fn(usize) -> bool, U: Fn(usize) -> f64> {
    /// What bodies and constraints resist.
    pub resistances: &'a Resistances,
    /// Pores, if they count.
    pub pores: Option<&'a Pores>,
    /// Number of rigid modes of a body.
    pub rigid: usize,
    /// Whether it may be solved loosely.
    pub flexible: bool,
    /// Whether all constraints push as they move, on all ranks.
    pub symmetric: bool,
    /// Whether the motion of a body is given.
    pub stays: S,
    /// Net force of a unit translation multiplier of a body, over that of a unit of a constraint's unknown.
    pub unit: U,
}

impl Network {
    /// The network of some parts. Collective.
    ///
    /// # Errors
    /// It cannot be factored.
    pub fn new(
        session: &Session,
        layout: &MultiplierLayout,
        parts: NetworkParts<impl Fn(usize) -> bool, impl Fn(usize) -> f64>,
    ) -> Result<Network> {
        let NetworkParts { pores, rigid, .. } = parts;
        let numbering = Numbering::new(session, layout, rigid, pores);
        let local = numbering.local(layout);
        let rows = rows(layout, &numbering, &parts);
        let way = match (pores, parts.flexible && iterated(rigid, layout.bodies())) {
            (Some(_), _) if parts.symmetric => SparseMethod::Quasidefinite,
            (None, true) if parts.symmetric => SparseMethod::Iterated,
            (None, false) if parts.symmetric => SparseMethod::Positive,
            (None, true) => SparseMethod::UnsymmetricIterated,
            _ => SparseMethod::Unsymmetric,
        };
        let solver = SparseSolver::new(session, local, rows, way)?;
        let places = layout.local_bodies.iter().map(|&body| layout.local(body)).collect();
        let forces = Vector::new(session, local)?;
        let mut wanted = Places::new(&forces)?;
        let share = |share: &PoreShare| Share {
            pore: wanted.of_shared(numbering.of_pore[share.pore], 1),
            first: layout.local(share.body),
            unit: (parts.unit)(share.body),
            multipliers: share.multipliers.clone(),
        };
        let own = pores.iter().flat_map(|pores| &pores.shares).filter(|share| layout.holds(share.body));
        let shares = own.map(share).collect();
        Ok(Network {
            solver,
            rigid,
            places,
            pores: pores.is_some(),
            shares,
            others: wanted.scatter(&forces)?,
            motions: forces.like()?,
            forces,
        })
    }

    /// Turns forces in the places of multipliers of rigid modes into motions. With pores, all modes are to move as wanted besides, and the
    /// multipliers that the pressures stand for are added to those found. Collective.
    pub fn answer(&mut self, forces: &mut Vector, modes: Option<(&Vector, &mut Vector)>) -> Result<()> {
        let rigid = self.rigid;
        let modes = modes.filter(|_| self.pores);
        if let Some((wanted, _)) = &modes {
            self.forces.fill(0.0)?;
            self.press_out(&wanted.local()?)?;
            self.others.add_back(&mut self.forces)?;
        }
        let mut shared = forces.local_mut()?;
        for (own, &place) in self.forces.local_mut()?.chunks_mut(rigid).zip(&self.places) {
            own.copy_from_slice(&shared[place..place + rigid]);
        }
        self.solver.solve(&self.forces, &mut self.motions)?;
        for (own, &place) in self.motions.local()?.chunks(rigid).zip(&self.places) {
            shared[place..place + rigid].copy_from_slice(own);
        }
        match modes {
            Some((_, found)) => self.press(&mut found.local_mut()?),
            None => Ok(()),
        }
    }

    /// Puts into the rows of pores what flows in as surfaces move as wanted.
    fn press_out(&mut self, wanted: &[f64]) -> Result<()> {
        let (mut own, others) = (self.forces.local_mut()?, self.others.places());
        let mut rows = EntriesMut { own: &mut own, others };
        for share in &self.shares {
            let velocities = &wanted[share.first..share.first + share.multipliers.len()];
            let flow: f64 = velocities.iter().zip(&share.multipliers).map(|(velocity, multiplier)| velocity * multiplier).sum();
            *rows.at(share.pore) -= share.unit * flow;
        }
        Ok(())
    }

    /// Adds the multipliers of the pressures found.
    fn press(&mut self, found: &mut [f64]) -> Result<()> {
        let (others, own) = (self.others.fetch(&self.motions)?, self.motions.local()?);
        let motions = Entries { own: &own, others };
        for share in &self.shares {
            let pressure = motions.from(share.pore)[0];
            let pressed = &mut found[share.first..share.first + share.multipliers.len()];
            pressed.iter_mut().zip(&share.multipliers).for_each(|(found, multiplier)| *found += pressure * multiplier);
        }
        Ok(())
    }
}

/// For each of so many pores the entries of its row of conductances, by pore.
fn conductances(pores: &Option<&Pores>, count: usize) -> Vec<Vec<(usize, f64)>> {
    let mut of_pore = vec![Vec::new(); count];
    for ([pore, other], entry) in pores.iter().flat_map(|pores| pores.conductances()) {
        of_pore[pore].push((other, entry));
    }
    of_pore
}

/// This rank's rows of the network.
fn rows(
    layout: &MultiplierLayout,
    numbering: &Numbering,
    parts: &NetworkParts<impl Fn(usize) -> bool, impl Fn(usize) -> f64>,
) -> RowBuilder {
    let NetworkParts { resistances, pores, rigid, stays, unit, .. } = parts;
    let rigid = *rigid;
    let mut bodies = vec![0; layout.bodies()];
    (0..bodies.len()).for_each(|body| bodies[layout.number(body)] = body);
    let mut of_body = vec![Vec::new(); layout.bodies()];
    let mut of_pore = vec![Vec::new(); numbering.of_pore.len()];
    for share in pores.iter().flat_map(|pores| &pores.shares).filter(|share| !stays(share.body)) {
        let forces: Vec<f64> = share.multipliers[..rigid].iter().map(|multiplier| multiplier * unit(share.body)).collect();
        of_body[share.body].push((share.pore, forces.clone()));
        of_pore[share.pore].push((share.body, forces));
    }
    let mut rows = RowBuilder::default();
    for &body in &layout.local_bodies {
        let number = layout.number(body);
        let own = || resistances.blocks.range((number, 0)..=(number, usize::MAX)).filter(|_| !stays(body));
        for row in 0..rigid {
            rows.push(numbering.of_body[body] + row, f64::from(stays(body)));
            for (&(_, column), block) in own().filter(|&(&(_, column), _)| !stays(bodies[column])) {
                (0..rigid).for_each(|mode| rows.push(numbering.of_body[bodies[column]] + mode, block[(row, mode)]));
            }
            of_body[body].iter().for_each(|(pore, forces)| rows.push(numbering.of_pore[*pore], forces[row]));
            rows.end_row();
        }
    }
    let conductances = conductances(pores, numbering.of_pore.len());
    for &pore in &numbering.pores {
        for (body, forces) in &of_pore[pore] {
            forces.iter().enumerate().for_each(|(mode, force)| rows.push(numbering.of_body[*body] + mode, *force));
        }
        conductances[pore].iter().for_each(|&(other, entry)| rows.push(numbering.of_pore[other], -entry));
        rows.end_row();
    }
    rows
}
