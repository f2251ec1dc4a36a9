//! Contacts with friction in a flow: who sticks and who slips, from a coupled solve and from what the network of bodies and films would answer.
//!
//! A coupled solve takes the states of contacts as rows: `u = 0` where a contact sticks; `u_N = 0`, with a force along `n + mu s`, where it slips, `s` being
//! the direction of friction on the partner. In three dimensions a slipping contact resists across `s` as Newton's method has it, `u_a + c r_a = 0` with
//! `c = |u_T| / (mu r_N)`. What it finds, forces `r` and velocities `u`, is the solution if the natural map of the exact law is zero. If not, the exact law is
//! solved for the network alone, `u' = W r' + (u - W r)`, and the states of that go into the next solve.

use nalgebra::{SMatrix, SVector};

use super::{
    FrictionLaw,
    cone::{ContactState, larger, tangential_size},
    frame::{Frame, carried, cross},
    interior_point::follow,
    network::ImmersedBodies,
    program::{FrictionIsland, FrictionProgram},
};
use crate::{
    body::{RigidFunctional, Row, Twist},
    contact::{Contact, FrictionReport},
};

/// Compliance of rows that stick, over the mobility of the contact, about the forces of the last round: redundant rows are regular with it.
const SOFT: f64 = 1e-5;

/// Largest resistance across the direction of a slip, over the inverse mobility of the contact: one that hardly slips would throw the others off.
const STIFFEST: f64 = 10.0;

/// Residual at which the exact law of the network is solved.
const AIM: f64 = 1e-9;

/// Residual up to which its solution is one, and up to which it is of use; and the start from the forces of the last solve where it is not.
const SOLVED: f64 = 1e-6;
const USEFUL: f64 = 1e-2;
const NEAR: f64 = 1e-1;

/// How a contact is held in a coupled solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldContact<const D: usize> {
    /// What it does.
    pub state: ContactState,
    /// Force on the partner near which it is looked for.
    pub force: SVector<f64, D>,
    /// Direction of friction on the partner where it slips; zero where it does so freely.
    pub direction: SVector<f64, D>,
    /// Speed of the slip over the force of friction.
    pub ease: f64,
}

/// An unknown force of a coupled solve: a part of the force of a contact.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldRow<const D: usize> {
    /// Its contact, by place.
    pub contact: usize,
    /// The force on the partner that a unit of it is.
    pub unit: SVector<f64, D>,
    /// Where the solve starts.
    pub guess: f64,
    /// The row.
    pub row: Row<D>,
}

/// Contacts of one step, with bodies of `W` unknowns each.
pub struct FlowContacts<'a, const D: usize, const W: usize> {
    immersed: ImmersedBodies<'a, D>,
    /// The contacts.
    pub contacts: Vec<Contact<D>>,
    frames: Vec<Frame<D>>,
    /// The law of each.
    laws: Vec<FrictionLaw>,
    program: FrictionProgram<D, W>,
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
        let program = island.program_of(&free);
        let program = if contacts.is_empty() { program } else { program.in_medium(resistance.medium(&free)) };
        let frames = contacts.iter().map(|contact| Frame::new(contact, balls)).collect();
        FlowContacts { immersed, frames, laws, program, found: Vec::new(), iterations: 0, contacts }
    }

    /// Takes what a coupled solve found, and gives how far from the law it is: the largest component of the natural map, over that of the velocities that
    /// contacts would have without forces.
    pub fn take(&mut self, forces: &[SVector<f64, D>], twists: &[Twist<D>]) -> f64 {
        let scaled: Vec<[f64; D]> = (0..forces.len()).map(|place| self.scaled_force(place, &forces[place])).collect();
        let velocities: Vec<[f64; D]> = (0..forces.len()).map(|place| self.scaled_velocity(place, twists)).collect();
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

    /// By how much each contact misses the law.
    pub fn misses(&self) -> Vec<f64> {
        let forces: Vec<[f64; D]> = self.found.iter().map(|(force, _)| *force).collect();
        self.found.iter().enumerate().map(|(place, (_, velocity))| self.program.miss(place, &forces, velocity)).collect()
    }

    /// How contacts are held where the network obeys the law; nothing if that is not found.
    pub fn by_network(&mut self) -> Option<Vec<HeldContact<D>>> {
        let mut best = follow(&self.program, &vec![[0.0; D]; self.contacts.len()], (1.0, AIM));
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
        Some((0..self.contacts.len()).map(|place| self.held(place, &best.forces[place], &velocities[place])).collect())
    }

    /// Whether contacts leave bodies no way, if that is found.
    pub fn is_jammed(&self) -> Option<bool> {
        self.program.is_jammed()
    }

    /// How they are held by what each alone makes of the last solve.
    pub fn by_contact(&self) -> Vec<HeldContact<D>> {
        self.found.iter().enumerate().map(|(place, (force, velocity))| self.held(place, force, velocity)).collect()
    }

    /// How contacts are held that bore these forces before.
    pub fn by_forces(&self, forces: &[SVector<f64, D>]) -> Vec<HeldContact<D>> {
        let still = [0.0; D];
        (0..forces.len()).map(|place| self.held(place, &self.scaled_force(place, &forces[place]), &still)).collect()
    }

    fn held(&self, place: usize, force: &[f64; D], velocity: &[f64; D]) -> HeldContact<D> {
        let (link, frame) = (&self.program.links[place], &self.frames[place]);
        let state = match self.program.state(place, force, velocity) {
            // nothing holds it
            ContactState::Sticking if self.laws[place].coefficient == 0.0 => ContactState::Slipping,
            state => state,
        };
        let aim: [f64; D] = std::array::from_fn(|axis| force[axis] - velocity[axis]);
        let (size, load) = (tangential_size(&aim), self.program.limit(place).load);
        let direction = if size > 0.0 && aim[0] > load { frame.tangential(&aim) / size } else { SVector::zeros() };
        let in_space = (0..D).map(|axis| frame.axes[axis] * (force[axis] / link.norms[axis])).sum();
        let ease = tangential_size(velocity) * link.norms[1] / (self.laws[place].coefficient * (force[0] - load) / link.norms[0]);
        HeldContact { state, force: in_space, direction, ease: if ease.is_finite() { ease.max(0.0) } else { 0.0 } }
    }

    /// The unknown forces of contacts that are held so, with their rows.
    pub fn rows(&self, held: &[HeldContact<D>]) -> Vec<HeldRow<D>> {
        held.iter().enumerate().flat_map(|(place, held)| self.rows_of(place, held)).collect()
    }

    fn rows_of(&self, place: usize, held: &HeldContact<D>) -> Vec<HeldRow<D>> {
        let (axes, norms) = (&self.frames[place].axes, &self.program.links[place].norms);
        let soft = |axis: usize| SOFT * norms[axis] * norms[axis];
        match held.state {
            ContactState::Open => Vec::new(),
            ContactState::Sticking => {
                (0..D).map(|axis| self.row(place, (&axes[axis], &axes[axis]), soft(axis), held.force.dot(&axes[axis]))).collect()
            }
            ContactState::Slipping => {
                let FrictionLaw { coefficient, critical_load, .. } = self.laws[place];
                let friction = held.direction * coefficient;
                let mut rows = vec![self.row(place, (&axes[0], &(axes[0] + friction)), soft(0), held.force.dot(&axes[0]))];
                if critical_load > 0.0 && held.rubs() {
                    rows.push(self.known_force(place, &-friction, norms[1] * norms[1], critical_load));
                }
                if D == 3 && coefficient > 0.0 && held.rubs() {
                    let across = cross(&axes[0], &held.direction);
                    rows.push(self.row(place, (&across, &across), held.ease.max(norms[1] * norms[1] / STIFFEST), 0.0));
                }
                rows
            }
        }
    }

    /// The row of the velocity along a direction and of a force on the partner, which is this much in the last round.
    fn row(&self, place: usize, (along, push): (&SVector<f64, D>, &SVector<f64, D>), compliance: f64, guess: f64) -> HeldRow<D> {
        let (contact, frame) = (&self.contacts[place], &self.frames[place]);
        let bodies = [(Some(contact.body), -1.0, frame.arms[0]), (contact.other(), 1.0, frame.arms[1])];
        let ends = |vector: &SVector<f64, D>| {
            let functional = |(body, sign, arm): (Option<usize>, f64, f64)| {
                Some((body?, RigidFunctional { direction: vector * sign, turn: frame.torque(vector, -arm) }))
            };
            bodies.into_iter().filter_map(functional).collect::<Vec<_>>()
        };
        let known = carried(self.immersed.domain, contact);
        let closing = along.dot(&contact.normal) * contact.gap / self.immersed.step;
        let rate = compliance * guess - closing - along.dot(&known);
        let pushes = ends(push).into_iter().map(|(_, push)| push).collect();
        HeldRow { contact: place, unit: *push, guess, row: Row { ends: ends(along), pushes, rate, compliance } }
    }

    /// The row of a force on the partner that is known, so many units: no motion counts for it.
    fn known_force(&self, place: usize, unit: &SVector<f64, D>, compliance: f64, force: f64) -> HeldRow<D> {
        let mut held = self.row(place, (unit, unit), compliance, force);
        held.row.pushes = held.row.ends.iter().map(|(_, side)| *side).collect();
        held.row.ends.iter_mut().for_each(|(_, side)| *side = RigidFunctional { direction: SVector::zeros(), turn: SMatrix::zeros() });
        held.row.rate = compliance * force;
        held
    }

    fn scaled_force(&self, place: usize, force: &SVector<f64, D>) -> [f64; D] {
        let (components, norms) = (self.frames[place].components(force), self.program.links[place].norms);
        std::array::from_fn(|axis| components[axis] * norms[axis])
    }

    fn scaled_velocity(&self, place: usize, twists: &[Twist<D>]) -> [f64; D] {
        let (contact, frame, norms) = (&self.contacts[place], &self.frames[place], self.program.links[place].norms);
        let velocity = frame.velocity((self.immersed.domain, contact), twists, self.immersed.step);
        // a smooth contact slides as it likes
        let counts = |axis: usize| axis == 0 || self.laws[place].coefficient > 0.0;
        std::array::from_fn(|axis| if counts(axis) { velocity[axis] / norms[axis] } else { 0.0 })
    }

    /// How well the law is kept by the last solve.
    pub fn report(&self) -> FrictionReport {
        let states: Vec<ContactState> = self.by_contact().iter().map(|held| held.state).collect();
        let count = |which: ContactState| states.iter().filter(|&&state| state == which).count();
        let power = |place: usize| {
            let ((force, velocity), contact, link) = (&self.found[place], &self.contacts[place], &self.program.links[place]);
            // forces and velocities are scaled by factors whose product is one
            let whole: f64 = force.iter().zip(velocity).map(|(force, velocity)| force * velocity).sum();
            whole - force[0] * contact.gap / self.immersed.step / link.norms[0]
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
    fn rubs(&self) -> bool {
        self.direction != SVector::<f64, D>::zeros()
    }

    /// Whether two say the same: of slips in a plane there are two, in space any number.
    pub fn is_like(&self, other: &HeldContact<D>) -> bool {
        if self.state == ContactState::Slipping && !(self.rubs() && other.rubs()) {
            return other.state == self.state && self.rubs() == other.rubs();
        }
        let same_way = D == 3 || self.state != ContactState::Slipping || self.direction.dot(&other.direction) > 0.0;
        self.state == other.state && same_way
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::{
        body::skew,
        contact::{NetworkResistance, SurfaceFriction},
        geometry::{Axis, Ball, Domain},
    };

    #[test]
    fn a_row_says_the_velocity_of_a_contact_and_is_pushed_as_it_moves() {
        let domain = Domain { size: [20.0; 3].into(), axes: [Axis::Periodic; 3] };
        let (normal, radii) = (Vector3::new(0.5, -0.3, 0.8).normalize(), [1.0, 0.6]);
        let centers = [Vector3::new(5.0, 5.0, 5.0), Vector3::new(5.0, 5.0, 5.0) + normal * 1.7];
        let balls: Vec<Ball<3>> = centers.iter().zip(radii).map(|(&center, radius)| Ball { center, radius }).collect();
        let contact = Contact::between(&domain, &balls, [0, 1], centers[1] - centers[0]);
        let resistance = NetworkResistance { bodies: vec![[2.0, 3.0], [1.0, 0.5]], ..NetworkResistance::default() };
        let surfaces = SurfaceFriction::uniform(FrictionLaw::plain(0.5));
        let immersed = ImmersedBodies { domain: &domain, balls: &balls, resistance: &resistance, surfaces: &surfaces, step: 0.1 };
        let twists = [([0.3, 0.1, -0.2], [0.2, 0.7, -0.4]), ([-0.5, 0.2, 0.4], [0.1, -0.3, 0.9])]
            .map(|(velocity, spin)| Twist { velocity: Vector3::from(velocity), spin: skew(&spin) });
        let mut contacts = FlowContacts::<3, 6>::new(immersed, vec![contact]);
        let stick = HeldContact { state: ContactState::Sticking, force: Vector3::zeros(), direction: Vector3::zeros(), ease: 0.0 };
        let rows = contacts.rows(&[stick]);
        let slip = contacts.frames[0].slip((&domain, &contact), &twists);
        for held in &rows {
            let rate: f64 = held.row.ends.iter().map(|(body, side)| side.rate(&twists[*body])).sum();
            assert!((rate - held.unit.dot(&slip)).abs() < 1e-14, "{rate} {}", held.unit.dot(&slip));
        }
        // what the rows push moves bodies as the program has it
        let forces = [0.7, -0.2, 0.4];
        let mut moved = [Twist::zero(); 2];
        for (held, force) in rows.iter().zip(forces) {
            for (body, push) in held.row.wrenches(force) {
                moved[body].velocity += push.direction / resistance.bodies[body][0];
                moved[body].spin += push.turn / resistance.bodies[body][1];
            }
        }
        let whole = rows.iter().zip(forces).map(|(held, force)| held.unit * force).sum::<Vector3<f64>>();
        let scaled = contacts.scaled_force(0, &whole);
        let rates = contacts.program.links[0].rates(&contacts.program.motion(&[scaled]));
        contacts.program.links[0].offset = [0.0; 3];
        let velocity = contacts.frames[0].components(&contacts.frames[0].slip((&domain, &contact), &moved));
        for axis in 0..3 {
            assert!((velocity[axis] / contacts.program.links[0].norms[axis] - rates[axis]).abs() < 1e-14);
        }
    }
}
