//! Contacts with friction in a flow: who sticks and who slips, from a coupled solve and from what the network of bodies and films would answer.
//!
//! A coupled solve takes the states of contacts as rows: `u = 0` where a contact sticks; `u_N = 0`, with a force along `n + mu s`, where it slips, `s` being
//! the direction of friction on the partner. In three dimensions a slipping contact resists across `s` as Newton's method has it, `u_a + c r_a = 0` with
//! `c = |u_T| / (mu r_N)`. What it finds, forces `r` and velocities `u`, is the solution if the natural map of the exact law is zero. If not, the exact law is
//! solved for the network alone, `u' = W r' + (u - W r)`, and the states of that go into the next solve. The network learns from each: [secants](crate::friction::secant)
//! make its `W` that of the flow along all changes of forces that were tried in the step.
//!
//! What turns a contact is held in the same way ([`held_rows`](super::held_rows)).

use nalgebra::SVector;

use super::{held_contact::HeldContact, network::ImmersedBodies};
use crate::{
    body::Twist,
    contact::{Contact, FrictionReport},
    friction::{
        ContactWrench, FrictionLaw,
        cone::{ContactState, larger, tangential_size},
        frame::Frame,
        law::Turn,
        program::{FrictionIsland, FrictionProgram},
        secant::{Solved, corrections},
        solver::interior_point::follow,
    },
};

/// Residual at which the exact law of the network is solved.
const AIM: f64 = 1e-9;

/// Residual up to which its solution is one, and up to which it is of use; and the starts from the forces of the last solve where it is not.
const SOLVED: f64 = 1e-6;
const USEFUL: f64 = 5e-2;
const NEAR: [f64; 3] = [1e-1, 1e-2, 1.0];

/// Contacts of one step, with bodies of `W` unknowns each.
pub struct FlowContacts<'a, const D: usize, const W: usize> {
    /// The bodies that touch.
    pub immersed: ImmersedBodies<'a, D>,
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
    found: Solved<D>,
    /// What those before it found in the same step.
    solved: Vec<Solved<D>>,
    /// Whether the last one was in another step.
    of_other_step: bool,
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
        let island = FrictionIsland {
            domain,
            balls,
            masses: resistances,
            twists: &still,
            step,
            contacts: &contacts,
            laws: &laws,
            duration: 1.0,
            wall: None,
        };
        // without contacts nobody asks what resists
        let (program, turns) = (island.program_of(&free), island.turns().collect());
        let program = if contacts.is_empty() { program } else { program.in_medium(resistance.medium(&free)) };
        let frames = contacts.iter().map(|contact| Frame::new(contact, balls)).collect();
        FlowContacts {
            immersed,
            frames,
            laws,
            turns,
            program,
            found: (Vec::new(), Vec::new()),
            solved: Vec::new(),
            of_other_step: false,
            iterations: 0,
            contacts,
        }
    }

    /// Takes what a coupled solve found, and gives how far from the law it is: the largest component of the natural map, over that of the velocities that
    /// contacts would have without forces.
    pub fn take(&mut self, wrenches: &[ContactWrench<D>], twists: &[Twist<D>]) -> f64 {
        let scaled = self.scaled_forces(wrenches);
        let velocities: Vec<[f64; D]> = (0..scaled.len()).map(|row_block| self.scaled_velocity(row_block, twists)).collect();
        let solved = (scaled, velocities);
        let last = std::mem::take(&mut self.found);
        if !last.0.is_empty() && !std::mem::take(&mut self.of_other_step) {
            self.solved.push(last);
        }
        self.program.modes = corrections(&solved, &self.solved, |forces| self.program.rates_alone(forces));
        self.program.row_blocks.iter_mut().for_each(|row_block| row_block.offset = [0.0; D]);
        let rates = self.program.velocities_by(&solved.0);
        for (row_block, (velocity, rates)) in self.program.row_blocks.iter_mut().zip(solved.1.iter().zip(&rates)) {
            row_block.offset = std::array::from_fn(|axis| velocity[axis] - rates[axis]);
        }
        let offsets = self.program.row_blocks.iter().flat_map(|row_block| row_block.offset);
        self.program.unit = offsets.fold(f64::MIN_POSITIVE, |unit, offset| unit.max(offset.abs()));
        self.found = solved;
        self.residual()
    }

    /// Forgets that the last solve was one of this step: springs moved in another one.
    pub fn forget(&mut self) {
        self.of_other_step = true;
    }

    fn residual(&self) -> f64 {
        self.misses().into_iter().fold(0.0, larger) / self.program.unit
    }

    /// By how much each contact, and what turns them, misses the law.
    pub fn misses(&self) -> Vec<f64> {
        let (forces, velocities) = &self.found;
        velocities.iter().enumerate().map(|(place, velocity)| self.program.miss(place, forces, velocity)).collect()
    }

    /// How contacts are held where the network obeys the law; nothing if that is not found.
    pub fn by_network(&mut self) -> Option<Vec<HeldContact<D>>> {
        let mut best = follow(&self.program, &vec![[0.0; D]; self.program.row_blocks.len()], 1.0, AIM);
        for start in NEAR {
            if best.residual > SOLVED {
                let again = follow(&self.program, &self.program.within(&self.found.0), start, AIM);
                best = if again.residual < best.residual { again } else { best };
            }
        }
        self.iterations = self.iterations.max(best.iterations);
        if best.residual > USEFUL {
            return None;
        }
        let velocities = self.program.velocities_by(&best.forces);
        Some(self.all_held(&best.forces, &velocities))
    }

    /// Whether contacts leave bodies no way, if that is found.
    pub fn is_jammed(&self) -> Option<bool> {
        self.program.is_jammed()
    }

    /// How they are held by what each alone makes of the last solve.
    pub fn by_contact(&self) -> Vec<HeldContact<D>> {
        self.all_held(&self.found.0, &self.found.1)
    }

    /// How contacts are held that bore these forces and couples before.
    pub fn by_wrenches(&self, wrenches: &[ContactWrench<D>]) -> Vec<HeldContact<D>> {
        let forces = self.scaled_forces(wrenches);
        self.all_held(&forces, &vec![[0.0; D]; forces.len()])
    }

    fn all_held(&self, forces: &[[f64; D]], velocities: &[[f64; D]]) -> Vec<HeldContact<D>> {
        (0..forces.len()).map(|row_block| self.held(row_block, forces, velocities)).collect()
    }

    fn held(&self, row_block: usize, forces: &[[f64; D]], velocities: &[[f64; D]]) -> HeldContact<D> {
        let (place, turn, norms) = (self.contact_of(row_block), self.turn(row_block), self.program.row_blocks[row_block].norms);
        let state = match self.program.state(row_block, forces, velocities) {
            // nothing holds it
            ContactState::Sticking if self.laws[place].coefficient == 0.0 => ContactState::Slipping,
            state => state,
        };
        let (axes, limit) = (self.frames[place].row_axes(turn), self.program.limit(row_block));
        let in_space = |parts: &[f64; D]| -> SVector<f64, D> { (0..D).map(|axis| axes[axis] * parts[axis]).sum() };
        let mut aim: [f64; D] = std::array::from_fn(|axis| forces[row_block][axis] - velocities[row_block][axis]);
        let (size, rubs) = (tangential_size(&aim), limit.dilation > 0.0 || forces[place][0] - velocities[place][0] > limit.load);
        aim[0] = 0.0;
        let direction = if size > 0.0 && rubs { in_space(&aim) / size } else { SVector::zeros() };
        let force = in_space(&std::array::from_fn(|axis| forces[row_block][axis] / norms[axis]));
        let ease = tangential_size(&velocities[row_block]) * norms[1] * norms[1] / limit.at(forces[place][0]);
        let ease = if ease.is_finite() { ease } else { 0.0 };
        HeldContact { state, force, direction, ease, along_line: D == 2 || turn == Some(Turn::Twisting) }
    }

    /// The contact of a row block.
    pub(super) fn contact_of(&self, row_block: usize) -> usize {
        self.program.leader(row_block)
    }

    /// How a row block turns its contact, if it does.
    pub(super) fn turn(&self, row_block: usize) -> Option<Turn> {
        Some(self.turns[row_block.checked_sub(self.contacts.len())?].1)
    }

    pub(super) fn scaled_forces(&self, wrenches: &[ContactWrench<D>]) -> Vec<[f64; D]> {
        let scaled = |row_block: usize| {
            let (place, turn, norms) = (self.contact_of(row_block), self.turn(row_block), self.program.row_blocks[row_block].norms);
            let components = self.frames[place].row_components(turn, &wrenches[place]);
            std::array::from_fn(|axis| components[axis] * norms[axis])
        };
        (0..self.program.row_blocks.len()).map(scaled).collect()
    }

    fn scaled_velocity(&self, row_block: usize, twists: &[Twist<D>]) -> [f64; D] {
        let place = self.contact_of(row_block);
        let (contact, frame, norms) = (&self.contacts[place], &self.frames[place], self.program.row_blocks[row_block].norms);
        let mut velocity = frame.velocity(self.immersed.domain, contact, twists, self.immersed.step);
        if let Some(turn) = self.turn(row_block) {
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
        let power = |row_block: usize| {
            let (force, velocity, contact) =
                (&self.found.0[row_block], &self.found.1[row_block], &self.contacts[self.contact_of(row_block)]);
            // forces and velocities are scaled by factors whose product is one
            let whole: f64 = force.iter().zip(velocity).map(|(force, velocity)| force * velocity).sum();
            whole - force[0] * contact.gap / self.immersed.step / self.program.row_blocks[row_block].norms[0]
        };
        let powers = (0..self.found.0.len()).map(power);
        FrictionReport {
            residual: self.residual(),
            sticking: count(ContactState::Sticking),
            slipping: count(ContactState::Slipping),
            work: powers.sum::<f64>() * self.immersed.step,
            sweeps: 0,
            iterations: self.iterations,
            tolerance: FrictionReport::TOLERANCE_IN_FLOW,
        }
    }
}
