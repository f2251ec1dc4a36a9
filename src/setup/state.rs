//! What a restart needs: where bodies are and how they move. A value; machinery is rebuilt.

use std::{borrow::Cow, ops::Range};

use nalgebra::{Rotation3, SMatrix, SVector, Vector3};

use crate::{
    body::{Twist, components, skew},
    contact::{AdhesiveContact, ContactForce, Identity, Memory, Partner, bodies_of, pack, packed_length, unpack},
    geometry::Ball,
    parallel::{Peers, World},
};

/// A body on its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moving<const D: usize> {
    /// Its centre, not moved back into the box: what it has travelled can be read off.
    pub center: SVector<f64, D>,
    /// How it has turned since the start, an orthogonal matrix.
    pub rotation: SMatrix<f64, D, D>,
    /// Its motion over the last step: in a dry run its velocity, in Stokes flow the one that the flow gave it.
    pub twist: Twist<D>,
}

/// A contact force of the last step: a place to start from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactHistory<const D: usize> {
    /// The body.
    pub body: usize,
    /// What it touched.
    pub partner: Partner,
    /// Which image of the partner.
    pub image: [i32; D],
    /// The force between them along the normal.
    pub force: f64,
    /// The force of friction on the partner, as a vector in space: frames of contacts turn.
    pub tangential: SVector<f64, D>,
    /// In a flow the couple against rolling and twisting on the partner, a skew matrix.
    pub couple: SMatrix<f64, D, D>,
}

/// Where a body of given motion is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenPlace<const D: usize> {
    /// Its centre, not moved back into the box.
    pub center: SVector<f64, D>,
    /// The angle by which it has turned since the start, as a skew matrix.
    pub angle: SMatrix<f64, D, D>,
}

impl<const D: usize> GivenPlace<D> {
    /// That at a time of a body that started there and has kept this motion.
    pub fn steady(start: SVector<f64, D>, twist: &Twist<D>, time: f64) -> GivenPlace<D> {
        GivenPlace { center: start + twist.velocity * time, angle: twist.spin * time }
    }

    /// That of a body that started there and has gone this far.
    pub fn displaced(start: SVector<f64, D>, displacement: SVector<f64, D>, angle: SMatrix<f64, D, D>) -> GivenPlace<D> {
        GivenPlace { center: start + displacement, angle }
    }
}

/// Which bodies a rank's part of a state holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Share {
    /// All of them, the same on every rank.
    Whole,
    /// Those that the rank owns.
    Own {
        /// Their numbers among all, ascending.
        numbers: Vec<usize>,
        /// How many all are.
        count: usize,
    },
}

/// How a shear whose rate is found on the way has gone.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FoundShear {
    /// The strain so far.
    pub strain: f64,
    /// The rate at the start of the last step; 0 before the first.
    pub rate: f64,
}

/// Where a wall is that a load presses on the bodies, the upper one across an axis, and how it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallMotion<const D: usize> {
    /// The axis.
    pub axis: usize,
    /// Its coordinate along the axis.
    pub position: f64,
    /// Its velocity along the axis over the last step.
    pub velocity: f64,
    /// The force of contacts on it, and on what is fixed to it, in that step.
    pub force: SVector<f64, D>,
}

/// The bodies at a time, or those of them that a rank owns.
#[derive(Debug, Clone, PartialEq)]
pub struct State<const D: usize> {
    /// The time.
    pub time: f64,
    /// Steps made so far.
    pub steps: usize,
    /// Length of the last step, 0 before the first.
    pub last_step: f64,
    /// How a shear whose rate is found on the way has gone so far, if there is one.
    pub shear: FoundShear,
    /// The wall that a load presses on the bodies, if there is one.
    pub wall: Option<WallMotion<D>>,
    /// Which bodies these are.
    pub share: Share,
    /// The bodies.
    pub bodies: Vec<Moving<D>>,
    /// Contacts of these bodies that bore a force; bodies are named by their numbers.
    pub contact_history: Vec<ContactHistory<D>>,
    /// Contacts of these bodies that stick; none unless contacts are gluey.
    pub adhesive_contacts: Vec<AdhesiveContact<D>>,
    /// Velocities that carried these bodies over the last step, by which the next one tells how far it erred; none but in Stokes flow.
    pub carried: Vec<SVector<f64, D>>,
}

impl<const D: usize> Moving<D> {
    /// How many numbers [`pack`](Self::pack) makes.
    pub const LENGTH: usize = 2 * D + D * D + D * (D - 1) / 2;

    /// The body as numbers.
    pub fn pack(&self) -> Vec<f64> {
        let Moving { center, rotation, twist } = self;
        [center.as_slice(), rotation.as_slice(), twist.velocity.as_slice(), &components(&twist.spin)].concat()
    }

    /// What [`pack`](Self::pack) was given.
    pub fn unpack(numbers: &[f64]) -> Moving<D> {
        let (center, rest) = numbers.split_at(D);
        let (rotation, motion) = rest.split_at(D * D);
        let twist = Twist { velocity: SVector::from_column_slice(&motion[..D]), spin: skew(&motion[D..]) };
        Moving { center: SVector::from_column_slice(center), rotation: SMatrix::from_column_slice(rotation), twist }
    }
}

impl<const D: usize> ContactHistory<D> {
    /// How many numbers [`pack`](Self::pack) makes.
    pub const LENGTH: usize = packed_length::<D>() + D + D * (D - 1) / 2;

    /// The memory of a contact force.
    pub fn of(contact: &ContactForce<D>) -> ContactHistory<D> {
        let ContactForce { contact, force, tangential, couple } = *contact;
        ContactHistory { body: contact.body, partner: contact.partner, image: contact.image, force, tangential, couple }
    }

    /// It as numbers.
    pub fn pack(&self) -> Vec<f64> {
        let mut numbers = pack(self.identity(), self.force);
        numbers.extend(&self.tangential);
        numbers.extend(components(&self.couple));
        numbers
    }

    /// What [`pack`](Self::pack) was given.
    pub fn unpack(numbers: &[f64]) -> ContactHistory<D> {
        let ((body, partner, image), force) = unpack(numbers);
        let (tangential, couple) = numbers[packed_length::<D>()..].split_at(D);
        ContactHistory { body, partner, image, force, tangential: SVector::from_column_slice(tangential), couple: skew(couple) }
    }

    /// The bodies that it concerns.
    pub fn bodies(&self) -> impl Iterator<Item = usize> {
        bodies_of(self.identity())
    }

    /// What tells its contact from all others.
    pub fn identity(&self) -> Identity<D> {
        (self.body, self.partner, self.image)
    }
}

impl<const D: usize> State<D> {
    /// Bodies at the start.
    pub fn start(bodies: impl Iterator<Item = (SVector<f64, D>, Twist<D>)>) -> State<D> {
        let moving = |(center, twist)| Moving { center, rotation: SMatrix::identity(), twist };
        let bodies = bodies.map(moving).collect();
        State {
            time: 0.0,
            steps: 0,
            last_step: 0.0,
            shear: FoundShear::default(),
            wall: None,
            share: Share::Whole,
            bodies,
            contact_history: Vec::new(),
            adhesive_contacts: Vec::new(),
            carried: Vec::new(),
        }
    }

    /// How many bodies all ranks have.
    pub fn count(&self) -> usize {
        match &self.share {
            Share::Whole => self.bodies.len(),
            Share::Own { count, .. } => *count,
        }
    }

    /// The numbers of these bodies, ascending.
    pub fn numbers(&self) -> Cow<'_, [usize]> {
        match &self.share {
            Share::Whole => Cow::Owned((0..self.bodies.len()).collect()),
            Share::Own { numbers, .. } => Cow::Borrowed(numbers),
        }
    }

    /// The number of the body at a place.
    pub fn number(&self, place: usize) -> usize {
        match &self.share {
            Share::Whole => place,
            Share::Own { numbers, .. } => numbers[place],
        }
    }

    /// The place of a body, if the state holds it.
    pub fn place(&self, number: usize) -> Option<usize> {
        match &self.share {
            Share::Whole => Some(number),
            Share::Own { numbers, .. } => numbers.binary_search(&number).ok(),
        }
    }

    /// Whether a contact of a body is this rank's to tell: of two ranks that know it, that of the first body.
    pub fn reports(&self, body: usize) -> bool {
        self.place(body).is_some()
    }

    /// The contacts that bore a force and that this rank tells of.
    pub fn reported(&self) -> impl Iterator<Item = &ContactHistory<D>> {
        self.contact_history.iter().filter(|contact| self.reports(contact.body))
    }

    /// The contacts that stick and that this rank tells of.
    pub fn reported_adhesive_contacts(&self) -> impl Iterator<Item = &AdhesiveContact<D>> {
        self.adhesive_contacts.iter().filter(|contact| self.reports(contact.body))
    }

    /// The ranks that have parts of this state: none but this one where each has all of it.
    pub fn peers<'w>(&self, world: &'w World) -> Peers<'w> {
        if self.share == Share::Whole { Peers::Alone } else { world.into() }
    }

    /// Places of the bodies that this rank writes of: all ranks together write of each body once.
    pub fn written(&self, world: &World) -> Range<usize> {
        let count = self.bodies.len();
        if self.share == Share::Whole { world.share(count) } else { 0..count }
    }

    /// The contacts of all ranks that bore a force, on every rank. Collective.
    pub fn whole_contact_history(&self, world: &World) -> Vec<ContactHistory<D>> {
        if self.share == Share::Whole {
            return self.reported().copied().collect();
        }
        let numbers: Vec<f64> = self.reported().flat_map(ContactHistory::pack).collect();
        let mut all: Vec<_> = world.gather(&numbers).chunks(ContactHistory::<D>::LENGTH).map(ContactHistory::unpack).collect();
        all.sort_unstable_by_key(ContactHistory::identity);
        all
    }

    /// The contacts of all ranks that stick, each with its memory, on every rank. Collective.
    pub fn whole_adhesive_contacts(&self, world: &World) -> Vec<(Identity<D>, f64)> {
        let reported = self.reported_adhesive_contacts().map(|contact| (contact.identity(), contact.gamma));
        if self.share == Share::Whole {
            return reported.collect();
        }
        let numbers: Vec<f64> = reported.flat_map(|(identity, number)| pack(identity, number)).collect();
        let mut all: Vec<(Identity<D>, f64)> = world.gather(&numbers).chunks(packed_length::<D>()).map(unpack).collect();
        all.sort_unstable_by_key(|(identity, _)| *identity);
        all
    }

    /// The contacts that bore a force, of the bodies that this rank writes of, in order: all ranks together write of each contact once.
    pub fn written_contact_history(&self, world: &World) -> Vec<ContactHistory<D>> {
        let mut ours: Vec<_> = self.contact_history.iter().filter(|contact| self.writes(world, contact.body)).copied().collect();
        ours.sort_unstable_by_key(ContactHistory::identity);
        ours
    }

    /// The contacts that stick, each with its memory, in the same way.
    pub fn written_adhesive_contacts(&self, world: &World) -> Vec<(Identity<D>, f64)> {
        let ours = self.adhesive_contacts.iter().filter(|contact| self.writes(world, contact.body));
        let mut ours: Vec<_> = ours.map(|contact| (contact.identity(), contact.gamma)).collect();
        ours.sort_unstable_by_key(|(identity, _)| *identity);
        ours
    }

    fn writes(&self, world: &World, body: usize) -> bool {
        let written = self.written(world);
        self.place(body).is_some_and(|place| written.contains(&place))
    }

    /// Their centres, not moved back into the box.
    pub fn centers(&self) -> Vec<SVector<f64, D>> {
        self.bodies.iter().map(|body| body.center).collect()
    }

    /// Their motions.
    pub fn twists(&self) -> Vec<Twist<D>> {
        self.bodies.iter().map(|body| body.twist).collect()
    }

    /// The bodies as balls with these radii.
    pub fn balls(&self, radii: &[f64]) -> Vec<Ball<D>> {
        self.bodies.iter().zip(radii).map(|(body, &radius)| Ball { center: body.center, radius }).collect()
    }

    /// The contact forces of the last step.
    pub fn memory(&self) -> Memory<D> {
        self.contact_history.iter().map(|contact| ((contact.body, contact.partner, contact.image), contact.force)).collect()
    }

    /// Puts bodies, named by their numbers, where their given motions have them.
    pub fn place_given(&mut self, given: impl Iterator<Item = (usize, GivenPlace<D>)>) {
        for (number, GivenPlace { center, angle }) in given {
            if let Some(place) = self.place(number) {
                let body = &mut self.bodies[place];
                (body.center, body.rotation) = (center, turned_by(&angle));
            }
        }
    }

    /// Moves every body for a step.
    pub fn advance(&mut self, moves: &[Twist<D>], step: f64) {
        for (body, twist) in self.bodies.iter_mut().zip(moves) {
            body.center += twist.velocity * step;
            body.rotation = turn(&twist.spin, step) * body.rotation;
        }
        self.time += step;
        self.steps += 1;
        self.last_step = step;
    }
}

/// The rotation by a spin over a step (Cayley's formula: orthogonal whatever the step, second order in it).
pub fn turn<const D: usize>(spin: &SMatrix<f64, D, D>, step: f64) -> SMatrix<f64, D, D> {
    let half = nalgebra::DMatrix::from_fn(D, D, |row, column| spin[(row, column)] * 0.5 * step);
    let one = nalgebra::DMatrix::identity(D, D);
    let turned = (&one - &half).lu().solve(&(&one + &half)).expect("one minus a skew matrix is regular");
    SMatrix::from_fn(|row, column| turned[(row, column)])
}

/// The rotation about an axis by an angle, both in a skew matrix.
pub fn turned_by<const D: usize>(angle: &SMatrix<f64, D, D>) -> SMatrix<f64, D, D> {
    let about = match components(angle)[..] {
        [x, y, z] => Vector3::new(x, y, z),
        ref plane => Vector3::new(0.0, 0.0, plane[0]),
    };
    let turned = Rotation3::new(about);
    SMatrix::from_fn(|row, column| turned[(row, column)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::skew;

    #[test]
    fn an_angle_turns_as_its_spin_does_over_a_time() {
        let spin = skew::<3>(&[0.3, -0.5, 0.7]);
        let many = (0..2000).fold(SMatrix::<f64, 3, 3>::identity(), |turned, _| turn(&spin, 1e-3) * turned);
        assert!((turned_by(&(spin * 2.0)) - many).norm() < 1e-6);
        let flat = skew::<2>(&[0.4]);
        assert!((turned_by(&flat) - turn(&flat, 1.0)).norm() < 0.02 && (turned_by(&flat)[(1, 0)] - 0.4_f64.sin()).abs() < 1e-15);
    }

    #[test]
    fn many_small_turns_make_the_right_angle_and_stay_orthogonal() {
        let at_rest = Twist { velocity: SVector::zeros(), spin: skew::<3>(&[0.0, 0.0, 1.0]) };
        let mut state = State::<3>::start(std::iter::once((SVector::zeros(), at_rest)));
        let steps = 1000;
        (0..steps).for_each(|_| state.advance(&[at_rest], 0.5 * std::f64::consts::PI / f64::from(steps)));
        let rotation = state.bodies[0].rotation;
        assert!((rotation.transpose() * rotation - SMatrix::identity()).norm() < 1e-12);
        assert!((rotation * SVector::from([1.0, 0.0, 0.0]) - SVector::from([0.0, 1.0, 0.0])).norm() < 1e-6);
        assert!((state.time - 0.5 * std::f64::consts::PI).abs() < 1e-12);
    }
}
