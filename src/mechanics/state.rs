//! What a restart needs: where bodies are and how they move. A value; machinery is rebuilt.

use std::{borrow::Cow, ops::Range};

use nalgebra::{Rotation3, SMatrix, SVector, Vector3};

use crate::{
    body::{Twist, components, skew},
    contact::{AdhesiveContact, ContactForce, Identity, Memory, Partner, TangentialForce, pack, packed_length, unpack},
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
    /// The force between them.
    pub force: f64,
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
    pub fn displaced(start: SVector<f64, D>, (displacement, angle): (SVector<f64, D>, SMatrix<f64, D, D>)) -> GivenPlace<D> {
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

/// The bodies at a time, or those of them that a rank owns.
#[derive(Debug, Clone, PartialEq)]
pub struct State<const D: usize> {
    /// The time.
    pub time: f64,
    /// Steps made so far.
    pub steps: usize,
    /// Length of the last step, 0 before the first.
    pub last_step: f64,
    /// Which bodies these are.
    pub share: Share,
    /// The bodies.
    pub bodies: Vec<Moving<D>>,
    /// Contacts of these bodies that bore a force; bodies are named by their numbers.
    pub held: Vec<ContactHistory<D>>,
    /// Contacts of these bodies that stick; none unless contacts are gluey.
    pub stuck: Vec<AdhesiveContact<D>>,
    /// Tangential forces of those of these contacts that bore a force; none without friction.
    pub tangential: Vec<TangentialForce<D>>,
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

impl<const D: usize> From<(Identity<D>, f64)> for ContactHistory<D> {
    fn from(((body, partner, image), force): (Identity<D>, f64)) -> ContactHistory<D> {
        ContactHistory { body, partner, image, force }
    }
}

impl<const D: usize> ContactHistory<D> {
    /// The memory of a contact force.
    pub fn of(contact: &ContactForce<D>) -> ContactHistory<D> {
        let ContactForce { contact, force } = *contact;
        ContactHistory { body: contact.body, partner: contact.partner, image: contact.image, force }
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
        let (held, stuck, tangential) = (Vec::new(), Vec::new(), Vec::new());
        State { time: 0.0, steps: 0, last_step: 0.0, share: Share::Whole, bodies, held, stuck, tangential }
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
    pub fn tells(&self, body: usize) -> bool {
        self.place(body).is_some()
    }

    /// The contacts that bore a force and that this rank tells of.
    pub fn told(&self) -> impl Iterator<Item = &ContactHistory<D>> {
        self.held.iter().filter(|held| self.tells(held.body))
    }

    /// The contacts that stick and that this rank tells of.
    pub fn told_stuck(&self) -> impl Iterator<Item = &AdhesiveContact<D>> {
        self.stuck.iter().filter(|stuck| self.tells(stuck.body))
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
    pub fn all_held(&self, world: &World) -> Vec<(Identity<D>, f64)> {
        self.all_told(world, self.told().map(|held| (held.identity(), held.force)))
    }

    /// The contacts of all ranks that stick, each with its memory, on every rank. Collective.
    pub fn all_stuck(&self, world: &World) -> Vec<(Identity<D>, f64)> {
        self.all_told(world, self.told_stuck().map(|stuck| (stuck.identity(), stuck.gamma)))
    }

    /// The tangential forces of all ranks, on every rank. Collective.
    pub fn all_tangential(&self, world: &World) -> Vec<TangentialForce<D>> {
        if self.share == Share::Whole {
            return self.tangential.clone();
        }
        let told = self.tangential.iter().filter(|force| self.tells(force.body));
        let numbers: Vec<f64> = told.flat_map(TangentialForce::pack).collect();
        let mut all: Vec<_> = world.gather(&numbers).chunks(TangentialForce::<D>::LENGTH).map(TangentialForce::unpack).collect();
        all.sort_unstable_by_key(TangentialForce::identity);
        all
    }

    /// The tangential forces of contacts of the bodies that this rank writes of, in order.
    pub fn written_tangential(&self, world: &World) -> Vec<TangentialForce<D>> {
        let written = self.written(world);
        let ours = |force: &&TangentialForce<D>| self.place(force.body).is_some_and(|place| written.contains(&place));
        let mut ours: Vec<_> = self.tangential.iter().filter(ours).copied().collect();
        ours.sort_unstable_by_key(TangentialForce::identity);
        ours
    }

    /// The contacts that bore a force, of the bodies that this rank writes of, in order: all ranks together write of each contact once.
    pub fn written_held(&self, world: &World) -> Vec<(Identity<D>, f64)> {
        self.written_contacts(world, self.held.iter().map(|held| (held.identity(), held.force)))
    }

    /// The contacts that stick, each with its memory, in the same way.
    pub fn written_stuck(&self, world: &World) -> Vec<(Identity<D>, f64)> {
        self.written_contacts(world, self.stuck.iter().map(|stuck| (stuck.identity(), stuck.gamma)))
    }

    fn written_contacts(&self, world: &World, contacts: impl Iterator<Item = (Identity<D>, f64)>) -> Vec<(Identity<D>, f64)> {
        let written = self.written(world);
        let ours = |&((body, ..), _): &(Identity<D>, f64)| self.place(body).is_some_and(|place| written.contains(&place));
        let mut ours: Vec<_> = contacts.filter(ours).collect();
        ours.sort_unstable_by_key(|(identity, _)| *identity);
        ours
    }

    fn all_told(&self, world: &World, told: impl Iterator<Item = (Identity<D>, f64)>) -> Vec<(Identity<D>, f64)> {
        if self.share == Share::Whole {
            return told.collect();
        }
        let numbers: Vec<f64> = told.flat_map(|(identity, number)| pack(identity, number)).collect();
        let mut all: Vec<(Identity<D>, f64)> = world.gather(&numbers).chunks(packed_length::<D>()).map(unpack).collect();
        all.sort_unstable_by_key(|(identity, _)| *identity);
        all
    }

    /// Their centres, not moved back into the box.
    pub fn centers(&self) -> Vec<SVector<f64, D>> {
        self.bodies.iter().map(|body| body.center).collect()
    }

    /// The bodies as balls with these radii.
    pub fn balls(&self, radii: &[f64]) -> Vec<Ball<D>> {
        self.bodies.iter().zip(radii).map(|(body, &radius)| Ball { center: body.center, radius }).collect()
    }

    /// The contact forces of the last step.
    pub fn memory(&self) -> Memory<D> {
        self.held.iter().map(|held| ((held.body, held.partner, held.image), held.force)).collect()
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
