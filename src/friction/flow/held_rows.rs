//! Rows of contacts in a coupled solve: the unknown forces and couples of those that are held, and the velocities that these keep.
//!
//! A couple that slips is a part of the normal force, `n + mu s + k z`, as friction is, `z` being its direction; one that sticks has a row `w = 0` for each axis.

use nalgebra::{SMatrix, SVector};

use super::{held_contact::HeldContact, in_flow::FlowContacts};
use crate::{
    body::{RigidFunctional, Row},
    friction::{
        ContactWrench,
        cone::ContactState,
        frame::{carried, cross},
    },
};

/// Compliance of rows that stick, over the mobility of the contact, about the forces of the last round: redundant rows are regular with it.
const SOFT: f64 = 1e-5;

/// Largest resistance across the direction of a slip, over the inverse mobility of the contact: one that hardly slips would throw the others off.
const STIFFEST: f64 = 10.0;

/// An unknown of a coupled solve: a part of the force, or of the couple, of a contact.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldRow<const D: usize> {
    /// Its contact, by place.
    pub contact: usize,
    /// What a unit of it does to the partner.
    pub unit: ContactWrench<D>,
    /// Where the solve starts.
    pub guess: f64,
    /// The row.
    pub row: Row<D>,
}

impl<const D: usize, const W: usize> FlowContacts<'_, D, W> {
    /// The unknown forces and couples of contacts that are held so, with their rows.
    pub fn rows(&self, held: &[HeldContact<D>]) -> Vec<HeldRow<D>> {
        let (contacts, turns) = held.split_at(self.contacts.len());
        let mut of_contact = vec![Vec::new(); contacts.len()];
        for (held, (number, (place, _))) in turns.iter().zip(self.turns.iter().enumerate()) {
            of_contact[*place].push((contacts.len() + number, *held));
        }
        contacts.iter().zip(&of_contact).enumerate().flat_map(|(place, (held, turns))| self.rows_of(place, held, turns)).collect()
    }

    fn rows_of(&self, place: usize, held: &HeldContact<D>, turns: &[(usize, HeldContact<D>)]) -> Vec<HeldRow<D>> {
        if held.state == ContactState::Open {
            return Vec::new();
        }
        let slipping = std::iter::once((place, *held)).chain(turns.iter().copied());
        let slipping: Vec<(usize, HeldContact<D>)> =
            slipping.filter(|(_, held)| held.state == ContactState::Slipping && held.rubs()).collect();
        let friction = slipping.iter().fold(ContactWrench::zero(), |sum, (row_block, held)| {
            sum + self.wrench(*row_block, &held.direction) * self.coefficient(*row_block)
        });
        let normal = self.wrench(place, &self.frames[place].axes[0]);
        // by the convex law a contact that slips opens, and the row is symmetric
        let along = if self.laws[place].convex { normal + friction } else { normal };
        let mut rows = vec![self.row(place, 0, &along, &(normal + friction), held.force.dot(&self.frames[place].axes[0]))];
        let critical_load = self.laws[place].critical_load;
        if critical_load > 0.0 && !slipping.is_empty() {
            rows.push(self.known(place, &(friction * -1.0), critical_load));
        }
        for (row_block, held) in std::iter::once((place, held)).chain(turns.iter().map(|(row_block, held)| (*row_block, held))) {
            rows.extend(self.tangential_rows(row_block, held));
        }
        rows
    }

    /// The rows of a row block besides that of its normal force.
    fn tangential_rows(&self, row_block: usize, held: &HeldContact<D>) -> Vec<HeldRow<D>> {
        let place = self.contact_of(row_block);
        let axes = self.frames[place].row_axes(self.turn(row_block));
        match held.state {
            ContactState::Sticking => {
                let sides = (1..D).filter(|&axis| axes[axis] != SVector::<f64, D>::zeros());
                sides
                    .map(|axis| {
                        let side = self.wrench(row_block, &axes[axis]);
                        self.row(row_block, axis, &side, &side, held.force.dot(&axes[axis]))
                    })
                    .collect()
            }
            ContactState::Slipping if !held.along_line && held.rubs() => {
                let across = self.wrench(row_block, &cross(&self.frames[place].axes[0], &held.direction));
                let mut row = self.row(row_block, 1, &across, &across, 0.0);
                row.row.compliance = held.ease.max(self.program.row_blocks[row_block].norms[1].powi(2) / STIFFEST);
                vec![row]
            }
            ContactState::Slipping | ContactState::Open => Vec::new(),
        }
    }

    /// What a unit along a direction of a row block does to the partner.
    fn wrench(&self, row_block: usize, direction: &SVector<f64, D>) -> ContactWrench<D> {
        self.frames[self.contact_of(row_block)].row_wrench(self.turn(row_block), direction)
    }

    /// The row of the velocity along what a wrench does work on, and of a wrench on the partner, which is this much in the last round.
    fn row(&self, row_block: usize, axis: usize, along: &ContactWrench<D>, push: &ContactWrench<D>, guess: f64) -> HeldRow<D> {
        let place = self.contact_of(row_block);
        let (contact, norm) = (&self.contacts[place], self.program.row_blocks[row_block].norms[axis]);
        let compliance = SOFT * norm * norm;
        let closing = along.force.dot(&contact.normal) * contact.gap / self.immersed.step;
        let rate = compliance * guess - closing - along.force.dot(&carried(self.immersed.domain, contact));
        let pushes = self.ends(place, push).into_iter().map(|(_, push)| push).collect();
        HeldRow { contact: place, unit: *push, guess, row: Row { pushes, ..Row::new(self.ends(place, along), rate, compliance) } }
    }

    /// The row of a wrench on the partner that is known, so many units: no motion counts for it.
    fn known(&self, place: usize, unit: &ContactWrench<D>, force: f64) -> HeldRow<D> {
        let mut held = self.row(place, 1, unit, unit, force);
        held.row.compliance = self.program.row_blocks[place].norms[1].powi(2);
        held.row.ends.iter_mut().for_each(|(_, side)| *side = RigidFunctional { direction: SVector::zeros(), turn: SMatrix::zeros() });
        held.row.rate = held.row.compliance * force;
        held
    }

    /// A wrench on the partner of a contact as what it does to both bodies, about their centres.
    fn ends(&self, place: usize, wrench: &ContactWrench<D>) -> Vec<(usize, RigidFunctional<D>)> {
        let (contact, frame) = (&self.contacts[place], &self.frames[place]);
        let bodies = [(Some(contact.body), -1.0, frame.arms[0]), (contact.other(), 1.0, frame.arms[1])];
        let functional = |(body, sign, arm): (Option<usize>, f64, f64)| {
            let turn = frame.torque(&wrench.force, -arm) + wrench.couple * sign;
            Some((body?, RigidFunctional { direction: wrench.force * sign, turn }))
        };
        bodies.into_iter().filter_map(functional).collect()
    }

    /// The coefficient that bounds a row block.
    fn coefficient(&self, row_block: usize) -> f64 {
        let law = &self.laws[self.contact_of(row_block)];
        self.turn(row_block).map_or(law.coefficient, |turn| law.of_turn(turn))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::{
        body::{Twist, skew},
        contact::Contact,
        friction::{FrictionLaw, ImmersedBodies, NetworkResistance, SurfaceFriction},
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
        let stick = HeldContact {
            state: ContactState::Sticking,
            force: Vector3::zeros(),
            direction: Vector3::zeros(),
            ease: 0.0,
            along_line: false,
        };
        let rows = contacts.rows(&[stick]);
        let slip = contacts.frames[0].slip(&domain, &contact, &twists);
        for held in &rows {
            let rate: f64 = held.row.ends.iter().map(|(body, side)| side.rate(&twists[*body])).sum();
            assert!((rate - held.unit.force.dot(&slip)).abs() < 1e-14, "{rate} {}", held.unit.force.dot(&slip));
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
        let whole = rows.iter().zip(forces).map(|(held, force)| held.unit.force * force).sum::<Vector3<f64>>();
        let scaled = contacts.scaled_forces(&[ContactWrench::of_force(whole)])[0];
        let rates = contacts.program.row_blocks[0].rates(&contacts.program.motion(&[scaled]));
        contacts.program.row_blocks[0].offset = [0.0; 3];
        let velocity = contacts.frames[0].components(&contacts.frames[0].slip(&domain, &contact, &moved));
        for axis in 0..3 {
            assert!((velocity[axis] / contacts.program.row_blocks[0].norms[axis] - rates[axis]).abs() < 1e-14);
        }
    }
}
