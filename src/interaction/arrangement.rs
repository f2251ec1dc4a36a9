//! What interactions see of the bodies, and the forces that they answer with.

use nalgebra::{SMatrix, SVector};

use crate::{
    contact::{Contact, ContactForce, candidates},
    geometry::{Ball, Domain},
};

/// Bodies where they are.
#[derive(Debug, Clone, Copy)]
pub struct Arrangement<'a, const D: usize> {
    /// The box.
    pub domain: &'a Domain<D>,
    /// Numbers of the bodies among all of the run, ascending; without them their places.
    pub numbers: Option<&'a [usize]>,
    /// The bodies; their centres need not lie in the box.
    pub balls: &'a [Ball<D>],
    /// Force that gives each body a unit velocity in unbounded fluid, or its mass where there is none; infinite where its motion is given.
    pub weights: &'a [f64],
    /// Viscosity of the fluid, if there is one.
    pub viscosity: Option<f64>,
    /// Gap up to which all neighbours of the bodies of this rank are among them.
    pub reach: f64,
    /// The time, which forces that change with it follow.
    pub time: f64,
}

/// Forces that follow from where bodies are.
#[derive(Debug, Clone, PartialEq)]
pub struct Forces<const D: usize> {
    /// Along the lines of centres of bodies that touch: they count as contacts.
    pub contacts: Vec<ContactForce<D>>,
    /// Others, between near bodies. A pair is the same on every rank that knows both.
    pub pairs: Vec<PairForce<D>>,
    /// On single bodies, by their places in the arrangement; the same on every rank that knows a body.
    pub single: Vec<(usize, Wrench<D>)>,
}

/// A force and torques on two near bodies, or on a body and a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairForce<const D: usize> {
    /// Which two, and how they lie.
    pub contact: Contact<D>,
    /// Force on the partner; the body has the opposite one.
    pub force: SVector<f64, D>,
    /// Torques on the body and on the partner, skew matrices. Together with that of the force they are zero for what has no preferred direction.
    pub torques: [SMatrix<f64, D, D>; 2],
}

/// Force and torque on a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench<const D: usize> {
    /// The force.
    pub force: SVector<f64, D>,
    /// The torque, a skew matrix.
    pub torque: SMatrix<f64, D, D>,
}

impl<const D: usize> Arrangement<'_, D> {
    /// The number of the body at a place.
    pub fn number(&self, place: usize) -> usize {
        self.numbers.map_or(place, |numbers| numbers[place])
    }

    /// Pairs of bodies, and bodies and walls, with a gap below `reach`; pairs of which neither can be moved are left out.
    ///
    /// # Panics
    /// If that is farther than the interaction said ([`Interaction::reach`](super::Interaction::reach)): this rank may not know all neighbours.
    pub fn near(&self, reach: f64) -> Vec<Contact<D>> {
        assert!(reach <= self.reach, "an interaction looks for gaps up to {reach}, and its reach is said to be {}", self.reach);
        candidates(self.domain, self.balls, self.weights, reach)
    }

    /// The impulse that a memory of one stands for: viscosity, or where there is none the mass with which a gap resists being opened.
    pub fn impulse_unit(&self, contact: &Contact<D>) -> f64 {
        let inverse = |body: usize| 1.0 / self.weights[body];
        self.viscosity.unwrap_or_else(|| 1.0 / (inverse(contact.body) + contact.other().map_or(0.0, inverse)))
    }
}

impl<const D: usize> Wrench<D> {
    /// None.
    pub fn zero() -> Wrench<D> {
        Wrench { force: SVector::zeros(), torque: SMatrix::zeros() }
    }

    /// The sum on each of so many bodies of contact forces and others.
    pub fn on_bodies<'a>(
        bodies: usize,
        contacts: impl IntoIterator<Item = &'a ContactForce<D>>,
        others: impl IntoIterator<Item = &'a PairForce<D>>,
    ) -> Vec<Wrench<D>> {
        let mut wrenches = vec![Wrench::zero(); bodies];
        let mut add = |pair: PairForce<D>| {
            let PairForce { contact, force, torques } = pair;
            wrenches[contact.body].force -= force;
            wrenches[contact.body].torque += torques[0];
            if let Some(other) = contact.other() {
                wrenches[other].force += force;
                wrenches[other].torque += torques[1];
            }
        };
        contacts.into_iter().map(PairForce::from).for_each(&mut add);
        others.into_iter().copied().for_each(add);
        wrenches
    }
}

impl<const D: usize> Default for Forces<D> {
    fn default() -> Self {
        Forces { contacts: Vec::new(), pairs: Vec::new(), single: Vec::new() }
    }
}

impl<const D: usize> Forces<D> {
    /// The sum on each of so many bodies, with contact forces besides.
    pub fn on_bodies(&self, bodies: usize, others: &[ContactForce<D>]) -> Vec<Wrench<D>> {
        let mut wrenches = Wrench::on_bodies(bodies, self.contacts.iter().chain(others), &self.pairs);
        for (body, wrench) in &self.single {
            wrenches[*body].force += wrench.force;
            wrenches[*body].torque += wrench.torque;
        }
        wrenches
    }
}

impl<const D: usize> From<Vec<PairForce<D>>> for Forces<D> {
    fn from(pairs: Vec<PairForce<D>>) -> Self {
        Forces { pairs, ..Forces::default() }
    }
}

impl<const D: usize> PairForce<D> {
    /// What it adds to the stress times volume, a pressure counting as negative: `-F r` for a partner at `r`, the torques being taken for half of it.
    pub fn stress(&self) -> SMatrix<f64, D, D> {
        stress_of_pair(&self.force, &(self.contact.normal * self.contact.separation))
    }

    /// What all of them add, if there are any.
    pub fn total_stress(forces: &[PairForce<D>]) -> Option<SMatrix<f64, D, D>> {
        forces.iter().map(PairForce::stress).reduce(|sum, stress| sum + stress)
    }
}

/// What a force on a partner away by `arm`, and the opposite one on the body, add to the stress times volume: the symmetric part of `-F r`.
pub fn stress_of_pair<const D: usize>(force: &SVector<f64, D>, arm: &SVector<f64, D>) -> SMatrix<f64, D, D> {
    let moment = force * arm.transpose();
    (moment + moment.transpose()) * -0.5
}

impl<const D: usize> From<&ContactForce<D>> for PairForce<D> {
    fn from(force: &ContactForce<D>) -> PairForce<D> {
        PairForce { contact: force.contact, force: force.whole(), torques: [SMatrix::zeros(); 2] }
    }
}
