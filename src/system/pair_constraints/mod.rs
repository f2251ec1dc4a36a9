//! Forces between near bodies as unknowns of the coupled system: those of contacts, and those of films that modes do not see.
//!
//! Each contact adds an unknown force `g` along its normal and a row that gives the rate at which its gap grows; each way of a film
//! adds a force and a row that ties it to a rate,
//!
//! ```text
//! contact  sum over its ends of  n . v = rate        film  sum over its ends of  (d . v + t : w)  +  g / resistance = - rate that is known
//! ```
//!
//! so that a film of whatever resistance leaves the system well conditioned: what resists most is a row without compliance. Each constraint belongs to the
//! rank that holds its first body. With what bodies alone, or near pairs, resist these rows have a sparse approximation, the [`Network`],
//! factored once a solve.

mod network;
mod pair_constraint;

pub use network::{Resistances, iterated};
pub use pair_constraint::{ConstraintSide, PairConstraint, RigidVector};

use self::network::{Network, NetworkParts};
use crate::{
    constraint::{Entries, EntriesMut, MultiplierLayout, Places, Pores},
    error::Result,
    petsc::{Scatter, Session, Vector},
};

/// Bodies of other ranks at the ends of this rank's constraints, and what the constraints do through the network.
struct Acting {
    network: Network,
    others: Scatter,
    /// For each side of this rank's constraints, one after the other, the place where its motion begins.
    places: Vec<u32>,
    /// Velocities or forces in the places of multipliers.
    motions: Vector,
}

/// What bodies resist besides constraints.
pub struct Medium {
    /// Of bodies each as if it were alone, or by near pairs.
    pub resistances: Resistances,
    /// Pores, if they count.
    pub pores: Option<Pores>,
    /// Whether it is by near pairs.
    pub by_pairs: bool,
}

/// Bodies at the ends of constraints.
pub struct ConstrainedBodies<'a, S: Fn(usize) -> bool, U: Fn(usize) -> f64> {
    /// Which rank has which of them.
    pub layout: &'a MultiplierLayout,
    /// Number of rigid modes of a body.
    pub rigid: usize,
    /// Whether the motion of a body is given.
    pub stays: S,
    /// Net force of a unit translation multiplier of a body, over that of a unit of a constraint's unknown.
    pub unit: U,
}

/// The constraints of a solve that belong to this rank: contacts and relative modes of films.
pub struct PairConstraints {
    /// Force, per unit viscosity, that a unit of an unknown stands for.
    pub scale: f64,
    constraints: Vec<PairConstraint>,
    rigid: usize,
    places: usize,
    acting: Option<Acting>,
}

impl PairConstraints {
    /// The constraints that touch this rank's bodies, in a system that has at least so many `places` for those that belong to it; a unit of
    /// an unknown stands for the force `scale`, per unit viscosity. Without a medium there is no constraint on any rank. Collective.
    ///
    /// # Errors
    /// The approximation cannot be factored.
    pub fn new(
        session: &Session,
        bodies: ConstrainedBodies<impl Fn(usize) -> bool, impl Fn(usize) -> f64>,
        scale: f64,
        constraints: Vec<PairConstraint>,
        medium: Option<&Medium>,
        places: usize,
    ) -> Result<Self> {
        let ConstrainedBodies { layout, rigid, stays, unit } = bodies;
        let mut owned: Vec<PairConstraint> = constraints.iter().filter(|constraint| constraint.owned).cloned().collect();
        owned.shrink_to_fit();
        let symmetric = !constraints.iter().any(|constraint| !constraint.symmetric());
        let act = |Medium { resistances, pores, by_pairs }: &Medium| {
            let symmetric = session.world().max(f64::from(!symmetric)) == 0.0;
            let mut resistances = resistances.clone();
            resistances.add_constraints(layout, constraints.iter(), PairConstraint::stiff_compliance);
            let parts =
                NetworkParts { resistances: &resistances, pores: pores.as_ref(), rigid, flexible: *by_pairs, symmetric, stays, unit };
            Acting::new(session, layout, Network::new(session, layout, parts)?, &owned, rigid)
        };
        let acting = medium.map(act).transpose()?;
        // a few constraints more or less do not change the size of the system
        let places = if owned.len() <= places { places } else { capacity(owned.len()) };
        Ok(PairConstraints { scale, constraints: owned, rigid, places, acting })
    }

    /// Takes the rates that are known, those of the given velocities on surfaces, from the rates wanted.
    pub fn without(&mut self, velocities: &[f64]) -> Result<()> {
        let Some(acting) = &mut self.acting else { return Ok(()) };
        acting.motions.local_mut()?.copy_from_slice(velocities);
        let known = acting.rates(&self.constraints, self.rigid)?;
        self.constraints.iter_mut().zip(known).for_each(|(constraint, known)| constraint.rate -= known);
        Ok(())
    }

    /// Number of this rank's constraints.
    pub fn count(&self) -> usize {
        self.constraints.len()
    }

    /// Number of unknowns set aside for them.
    pub fn places(&self) -> usize {
        self.places
    }

    /// Whether any rank has constraints, or near pairs answer to motions.
    pub fn any(&self) -> bool {
        self.acting.is_some()
    }

    /// Rates wanted, as rows of the constraints have them.
    pub fn wanted(&self) -> impl Iterator<Item = f64> {
        self.constraints.iter().map(|constraint| constraint.weight * constraint.rate)
    }

    /// What the rows of the constraints give for velocities in the order of the multipliers. Collective.
    pub fn rows(&mut self, velocities: &Vector, unknowns: &[f64]) -> Result<Vec<f64>> {
        let Some(acting) = &mut self.acting else { return Ok(Vec::new()) };
        acting.motions.copy_from(velocities)?;
        let mut rates = acting.rates(&self.constraints, self.rigid)?;
        let rows = rates.iter_mut().zip(&self.constraints).zip(unknowns);
        rows.for_each(|((rate, constraint), unknown)| *rate = constraint.weight * (*rate + constraint.compliance * unknown));
        Ok(rates)
    }

    /// Adds to the multipliers of rigid modes what the constraints press, times `factor`. Collective.
    pub fn press(&mut self, factor: f64, unknowns: &[f64], multipliers: &mut Vector) -> Result<()> {
        let Some(acting) = &mut self.acting else { return Ok(()) };
        acting.push(&self.constraints, self.rigid, unknowns, |end| factor * end.multiplier)?;
        multipliers.add(1.0, &acting.motions)
    }

    /// The unknowns for which rows of constraints are as wanted where `forces`, in the places of multipliers and per unit of an unknown, act too;
    /// they are replaced by the motions of the bodies. With pores, all modes are to move as wanted besides, and the multipliers that pores stand
    /// for are added to those found. Collective.
    pub fn resist(&mut self, forces: &mut Vector, mut rates: Vec<f64>, modes: Option<(&Vector, &mut Vector)>) -> Result<Vec<f64>> {
        let Some(acting) = &mut self.acting else { return Ok(rates) };
        let compliances: Vec<f64> = self.constraints.iter().map(PairConstraint::stiff_compliance).collect();
        rates.iter_mut().zip(&self.constraints).for_each(|(rate, constraint)| *rate /= constraint.weight);
        rates.iter_mut().zip(&compliances).for_each(|(rate, compliance)| *rate /= compliance);
        acting.push(&self.constraints, self.rigid, &rates, |_| 1.0)?;
        acting.motions.add(1.0, forces)?;
        acting.network.answer(&mut acting.motions, modes)?;
        let found = acting.rates(&self.constraints, self.rigid)?;
        rates.iter_mut().zip(found).zip(compliances).for_each(|((rate, found), compliance)| *rate -= found / compliance);
        forces.copy_from(&acting.motions)?;
        Ok(rates)
    }
}

impl Acting {
    fn new(session: &Session, layout: &MultiplierLayout, network: Network, owned: &[PairConstraint], rigid: usize) -> Result<Acting> {
        let motions = Vector::new(session, layout.local_unknowns())?;
        let mut wanted = Places::new(&motions)?;
        let mut place = |side: &ConstraintSide| wanted.of_shared(layout.global(side.body), rigid);
        let places = owned.iter().flat_map(PairConstraint::sides).map(&mut place).collect();
        Ok(Acting { network, others: wanted.scatter(&motions)?, places, motions })
    }

    /// Rates of the constraints for velocities in `motions`.
    fn rates(&mut self, constraints: &[PairConstraint], rigid: usize) -> Result<Vec<f64>> {
        let (others, own) = (self.others.fetch(&self.motions)?, self.motions.local()?);
        let motions = Entries { own: &own, others };
        let of_side = |(side, place): (&ConstraintSide, u32)| -> f64 {
            side.weights.iter().zip(&motions.from(place)[..rigid]).map(|(weight, velocity)| weight * velocity).sum()
        };
        let mut places = self.places.iter().copied();
        Ok(constraints.iter().map(|constraint| constraint.sides().zip(places.by_ref()).map(of_side).sum()).collect())
    }

    /// Puts into `motions` the pushes of unknowns, each end's times its own factor.
    fn push(
        &mut self,
        constraints: &[PairConstraint],
        rigid: usize,
        unknowns: &[f64],
        factor: impl Fn(&ConstraintSide) -> f64,
    ) -> Result<()> {
        self.motions.fill(0.0)?;
        let (mut own, others) = (self.motions.local_mut()?, self.others.places());
        let mut motions = EntriesMut { own: &mut own, others };
        let mut places = self.places.iter().copied();
        for (constraint, unknown) in constraints.iter().zip(unknowns) {
            for (side, place) in constraint.sides().zip(places.by_ref()) {
                let amount = factor(side) * unknown;
                motions.from(place)[..rigid].iter_mut().zip(side.push.iter()).for_each(|(push, weight)| *push += amount * weight);
            }
        }
        drop(own);
        self.others.add_back(&mut self.motions)
    }
}

/// At least so many places, in steps of an eighth.
fn capacity(count: usize) -> usize {
    let step = (count.next_power_of_two() / 8).max(1);
    count.div_ceil(step) * step
}
