//! Contacts with friction in a flow: who sticks and who slips, from a coupled solve and from what the network of bodies and films would answer.
//!
//! A coupled solve takes the states of contacts as rows: `u = 0` where a contact sticks; `u_N = 0`, with a force along `n + mu s`, where it slips, `s` being
//! the direction of friction on the partner. In three dimensions a slipping contact resists across `s` as Newton's method has it, `u_a + c r_a = 0` with
//! `c = |u_T| / (mu r_N)`. What it finds, forces `r` and velocities `u`, is the solution if the natural map of the exact law is zero. If not, the exact law is
//! solved for the network alone, `u' = W r' + (u - W r)`, and the states of that go into the next solve.
//!
//! What turns a contact is held in the same way ([`held_rows`](super::held_rows)).

use nalgebra::SVector;

use super::{
    ContactWrench, FrictionLaw,
    cone::{ContactState, larger, tangential_size},
    frame::Frame,
    interior_point::follow,
    law::Turn,
    network::ImmersedBodies,
    program::{FrictionIsland, FrictionProgram},
};
use crate::{
    body::Twist,
    contact::{Contact, FrictionReport},
};

/// Residual at which the exact law of the network is solved.
const AIM: f64 = 1e-9;

/// Residual up to which its solution is one, and up to which it is of use; and the start from the forces of the last solve where it is not.
const SOLVED: f64 = 1e-6;
const USEFUL: f64 = 1e-2;
const NEAR: f64 = 1e-1;

/// How a contact, or what turns one, is held in a coupled solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldContact<const D: usize> {
    /// What it does.
    pub state: ContactState,
    /// Force on the partner near which it is looked for; of what turns a contact the couple over the reduced radius, an axial vector.
    pub force: SVector<f64, D>,
    /// Direction of friction on the partner where it slips; zero where it does so freely.
    pub direction: SVector<f64, D>,
    /// Speed of the slip over the force of friction.
    pub ease: f64,
    /// Whether it slips along one line, one way or the other.
    pub along_line: bool,
}

/// Contacts of one step, with bodies of `W` unknowns each.
pub struct FlowContacts<'a, const D: usize, const W: usize> {
    pub(super) immersed: ImmersedBodies<'a, D>,
    /// The contacts.
    pub contacts: Vec<Contact<D>>,
    pub(super) frames: Vec<Frame<D>>,
    /// The law of each.
    pub(super) laws: Vec<FrictionLaw>,
    /// What turns them, each with the place of its contact.
    pub(super) turns: Vec<(usize, Turn)>,
    /// Contacts, and then what turns them.
    pub(super) program: FrictionProgram<D, W>,
    /// What the last coupled solve found, in the rows of the program.
    found: Vec<([f64; D], [f64; D])>,
    /// Most iterations of the network's program.
    iterations: usize,
}

impl<'a, const D: usize, const W: usize> FlowContacts<'a, D, W> {
    /// Contacts of bodies that have not been solved for.
    pub fn new(immersed: ImmersedBodies<'a, D>, contacts: Vec<Contact<D>>) -> Self {
        let ImmersedBodies { domain, balls, resistance, surfaces, step } = immersed;
        let laws: Vec<FrictionLaw> = contacts.iter().map(|contact| surfaces.of(contact.identity())).collect();
        let resistances = &resistance.bodies[..];
        let free: Vec<usize> = (0..balls.len()).filter(|&body| resistances[body][0].is_finite()).collect();
        let still = vec![Twist::zero(); balls.len()];
        let island =
            FrictionIsland { domain, balls, masses: resistances, twists: &still, step, contacts: &contacts, laws: &laws, duration: 1.0 };
        // without contacts nobody asks what resists
        let (program, turns) = (island.program_of(&free), island.turns().collect());
        let program = if contacts.is_empty() { program } else { program.in_medium(resistance.medium(&free)) };
        let frames = contacts.iter().map(|contact| Frame::new(contact, balls)).collect();
        FlowContacts { immersed, frames, laws, turns, program, found: Vec::new(), iterations: 0, contacts }
    }

    /// Takes what a coupled solve found, and gives how far from the law it is: the largest component of the natural map, over that of the velocities that
    /// contacts would have without forces.
    pub fn take(&mut self, wrenches: &[ContactWrench<D>], twists: &[Twist<D>]) -> f64 {
        let scaled = self.scaled_forces(wrenches);
        let velocities: Vec<[f64; D]> = (0..scaled.len()).map(|link| self.scaled_velocity(link, twists)).collect();
        let motion = self.program.motion(&scaled);
        for (link, velocity) in self.program.links.iter_mut().zip(&velocities) {
            let rates = link.rates(&motion);
            link.offset = std::array::from_fn(|axis| velocity[axis] - rates[axis]);
        }
        let offsets = self.program.links.iter().flat_map(|link| link.offset);
        self.program.unit = offsets.fold(f64::MIN_POSITIVE, |unit, offset| unit.max(offset.abs()));
        self.found = scaled.into_iter().zip(velocities).collect();
        self.residual()
    }

    fn residual(&self) -> f64 {
        self.misses().into_iter().fold(0.0, larger) / self.program.unit
    }

    /// By how much each contact, and what turns them, misses the law.
    pub fn misses(&self) -> Vec<f64> {
        let forces: Vec<[f64; D]> = self.found.iter().map(|(force, _)| *force).collect();
        self.found.iter().enumerate().map(|(place, (_, velocity))| self.program.miss(place, &forces, velocity)).collect()
    }

    /// How contacts are held where the network obeys the law; nothing if that is not found.
    pub fn by_network(&mut self) -> Option<Vec<HeldContact<D>>> {
        let mut best = follow(&self.program, &vec![[0.0; D]; self.program.links.len()], (1.0, AIM));
        if best.residual > SOLVED {
            let found: Vec<[f64; D]> = self.found.iter().map(|(force, _)| *force).collect();
            let again = follow(&self.program, &self.program.within(&found), (NEAR, AIM));
            if again.residual < best.residual {
                best = again;
            }
        }
        self.iterations = self.iterations.max(best.iterations);
        if best.residual > USEFUL {
            return None;
        }
        let velocities = self.program.velocities(&self.program.motion(&best.forces));
        Some(self.all_held(&best.forces, &velocities))
    }

    /// Whether contacts leave bodies no way, if that is found.
    pub fn is_jammed(&self) -> Option<bool> {
        self.program.is_jammed()
    }

    /// How they are held by what each alone makes of the last solve.
    pub fn by_contact(&self) -> Vec<HeldContact<D>> {
        let (forces, velocities): (Vec<[f64; D]>, Vec<[f64; D]>) = self.found.iter().copied().unzip();
        self.all_held(&forces, &velocities)
    }

    /// How contacts are held that bore these forces and couples before.
    pub fn by_wrenches(&self, wrenches: &[ContactWrench<D>]) -> Vec<HeldContact<D>> {
        let forces = self.scaled_forces(wrenches);
        self.all_held(&forces, &vec![[0.0; D]; forces.len()])
    }

    fn all_held(&self, forces: &[[f64; D]], velocities: &[[f64; D]]) -> Vec<HeldContact<D>> {
        (0..forces.len()).map(|link| self.held(link, forces, velocities)).collect()
    }

    fn held(&self, link: usize, forces: &[[f64; D]], velocities: &[[f64; D]]) -> HeldContact<D> {
        let (place, turn, norms) = (self.contact_of(link), self.turn(link), self.program.links[link].norms);
        let state = match self.program.state(link, forces, velocities) {
            // nothing holds it
            ContactState::Sticking if self.laws[place].coefficient == 0.0 => ContactState::Slipping,
            state => state,
        };
        let (axes, limit) = (self.frames[place].link_axes(turn), self.program.limit(link));
        let in_space = |parts: &[f64; D]| -> SVector<f64, D> { (0..D).map(|axis| axes[axis] * parts[axis]).sum() };
        let mut aim: [f64; D] = std::array::from_fn(|axis| forces[link][axis] - velocities[link][axis]);
        let (size, rubs) = (tangential_size(&aim), forces[place][0] - velocities[place][0] > limit.load);
        aim[0] = 0.0;
        let direction = if size > 0.0 && rubs { in_space(&aim) / size } else { SVector::zeros() };
        let force = in_space(&std::array::from_fn(|axis| forces[link][axis] / norms[axis]));
        let ease = tangential_size(&velocities[link]) * norms[1] * norms[1] / limit.at(forces[place][0]);
        let ease = if ease.is_finite() { ease } else { 0.0 };
        HeldContact { state, force, direction, ease, along_line: D == 2 || turn == Some(Turn::Twisting) }
    }

    /// The contact of a link.
    pub(super) fn contact_of(&self, link: usize) -> usize {
        self.program.leader(link)
    }

    /// How a link turns its contact, if it does.
    pub(super) fn turn(&self, link: usize) -> Option<Turn> {
        Some(self.turns[link.checked_sub(self.contacts.len())?].1)
    }

    pub(super) fn scaled_forces(&self, wrenches: &[ContactWrench<D>]) -> Vec<[f64; D]> {
        let scaled = |link: usize| {
            let (place, turn, norms) = (self.contact_of(link), self.turn(link), self.program.links[link].norms);
            let components = self.frames[place].link_components(turn, &wrenches[place]);
            std::array::from_fn(|axis| components[axis] * norms[axis])
        };
        (0..self.program.links.len()).map(scaled).collect()
    }

    fn scaled_velocity(&self, link: usize, twists: &[Twist<D>]) -> [f64; D] {
        let place = self.contact_of(link);
        let (contact, frame, norms) = (&self.contacts[place], &self.frames[place], self.program.links[link].norms);
        let mut velocity = frame.velocity((self.immersed.domain, contact), twists, self.immersed.step);
        if let Some(turn) = self.turn(link) {
            velocity[1..].copy_from_slice(&frame.turning_rates(contact, turn, twists)[1..]);
        }
        // a smooth contact slides as it likes
        let counts = |axis: usize| axis == 0 || self.laws[place].coefficient > 0.0;
        std::array::from_fn(|axis| if counts(axis) { velocity[axis] / norms[axis] } else { 0.0 })
    }

    /// How well the law is kept by the last solve.
    pub fn report(&self) -> FrictionReport {
        let states: Vec<ContactState> = self.by_contact()[..self.contacts.len()].iter().map(|held| held.state).collect();
        let count = |which: ContactState| states.iter().filter(|&&state| state == which).count();
        let power = |link: usize| {
            let ((force, velocity), contact) = (&self.found[link], &self.contacts[self.contact_of(link)]);
            // forces and velocities are scaled by factors whose product is one
            let whole: f64 = force.iter().zip(velocity).map(|(force, velocity)| force * velocity).sum();
            whole - force[0] * contact.gap / self.immersed.step / self.program.links[link].norms[0]
        };
        let powers = (0..self.found.len()).map(power);
        FrictionReport {
            residual: self.residual(),
            sticking: count(ContactState::Sticking),
            slipping: count(ContactState::Slipping),
            work: powers.sum::<f64>() * self.immersed.step,
            sweeps: 0,
            iterations: self.iterations,
        }
    }
}

impl<const D: usize> HeldContact<D> {
    /// Whether friction resists a slip: not below the critical load, nor of smooth surfaces.
    pub(super) fn rubs(&self) -> bool {
        self.direction != SVector::<f64, D>::zeros()
    }

    /// Whether two say the same: of slips along a line there are two, along a plane any number.
    pub fn is_like(&self, other: &HeldContact<D>) -> bool {
        if self.state == ContactState::Slipping && !(self.rubs() && other.rubs()) {
            return other.state == self.state && self.rubs() == other.rubs();
        }
        let same_way = !self.along_line || self.state != ContactState::Slipping || self.direction.dot(&other.direction) > 0.0;
        self.state == other.state && same_way
    }
}
