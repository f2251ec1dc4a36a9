//! Rolling and twisting of contacts: rows of relative spins times the reduced radius, and the couples that resist them.

use std::ops::{Add, Mul};

use nalgebra::{SMatrix, SVector};

use super::{
    FrictionLaw,
    bounds::Bound,
    frame::Frame,
    law::Turn,
    program::{FrictionIsland, FrictionProgram},
    row_block::RowBlock,
};
use crate::{
    body::{Twist, components, skew},
    contact::Contact,
    geometry::Ball,
};

/// What a contact does to its partner, and against it to its body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactWrench<const D: usize> {
    /// The force, in the point of contact.
    pub force: SVector<f64, D>,
    /// The couple against rolling and twisting, as a skew matrix.
    pub couple: SMatrix<f64, D, D>,
}

impl<const D: usize> ContactWrench<D> {
    /// A force alone.
    pub fn of_force(force: SVector<f64, D>) -> ContactWrench<D> {
        ContactWrench { force, couple: SMatrix::zeros() }
    }

    /// The force on each body of a contact as a velocity, and the torque about its centre as a spin.
    pub fn on_bodies(&self, contact: &Contact<D>, balls: &[Ball<D>]) -> impl Iterator<Item = (usize, Twist<D>)> {
        let frame = Frame::new(contact, balls);
        let tangential = frame.tangential(&frame.components(&self.force));
        let ends = [(Some(contact.body), -1.0, frame.arms[0]), (contact.other(), 1.0, -frame.arms[1])];
        let ContactWrench { force, couple } = *self;
        ends.into_iter().filter_map(move |(body, sign, arm)| {
            Some((body?, Twist { velocity: force * sign, spin: frame.torque(&(tangential * sign), arm) + couple * sign }))
        })
    }

    /// Nothing.
    pub fn zero() -> ContactWrench<D> {
        ContactWrench::of_force(SVector::zeros())
    }
}

impl<const D: usize> Add for ContactWrench<D> {
    type Output = ContactWrench<D>;

    fn add(self, other: ContactWrench<D>) -> ContactWrench<D> {
        ContactWrench { force: self.force + other.force, couple: self.couple + other.couple }
    }
}

impl<const D: usize> Mul<f64> for ContactWrench<D> {
    type Output = ContactWrench<D>;

    fn mul(self, factor: f64) -> ContactWrench<D> {
        ContactWrench { force: self.force * factor, couple: self.couple * factor }
    }
}

impl<const D: usize> Frame<D> {
    /// The directions of the rows of a contact or of what turns it; of couples those of axial vectors, in two dimensions the tangent for the one axis.
    pub fn row_axes(&self, turn: Option<Turn>) -> [SVector<f64, D>; D] {
        match turn {
            Some(Turn::Twisting) => std::array::from_fn(|axis| if axis == 1 { self.axes[0] } else { SVector::zeros() }),
            _ => self.axes,
        }
    }

    /// The force along a direction, or the couple of a unit over the reduced radius about it.
    pub fn row_wrench(&self, turn: Option<Turn>, direction: &SVector<f64, D>) -> ContactWrench<D> {
        let spin = match turn {
            None => return ContactWrench::of_force(*direction),
            Some(_) if D == 2 => skew(&[self.axes[1].dot(direction)]),
            Some(_) => skew(direction.as_slice()),
        };
        ContactWrench { force: SVector::zeros(), couple: spin * self.reduced_radius }
    }

    /// Components of a wrench along the rows of a contact, or of what turns it.
    pub fn row_components(&self, turn: Option<Turn>, wrench: &ContactWrench<D>) -> [f64; D] {
        let Some(turn) = turn else { return self.components(&wrench.force) };
        let mut parts = [0.0; D];
        let units = self.unit_spins(turn);
        parts[1..].iter_mut().zip(&units).for_each(|(part, unit)| *part = along(unit, &wrench.couple) / self.reduced_radius);
        parts
    }

    /// The unit spins of a turn.
    pub fn unit_spins(&self, turn: Turn) -> Vec<SMatrix<f64, D, D>> {
        match turn {
            Turn::Rolling if D == 2 => vec![skew(&[1.0])],
            Turn::Rolling => self.axes[1..].iter().map(|axis| skew(axis.as_slice())).collect(),
            Turn::Twisting => vec![skew(self.axes[0].as_slice())],
        }
    }

    /// The rates of a turn: the spin of the partner relative to that of the body, times the reduced radius; the first component is none.
    pub fn turning_rates(&self, contact: &Contact<D>, turn: Turn, twists: &[Twist<D>]) -> [f64; D] {
        let spin = contact.other().map_or_else(SMatrix::zeros, |other| twists[other].spin) - twists[contact.body].spin;
        let mut rates = [0.0; D];
        rates[1..].iter_mut().zip(self.unit_spins(turn)).for_each(|(rate, unit)| *rate = self.reduced_radius * along(&unit, &spin));
        rates
    }
}

/// What one skew matrix has of another one, a unit.
fn along<const D: usize>(unit: &SMatrix<f64, D, D>, other: &SMatrix<f64, D, D>) -> f64 {
    // a skew matrix has each component twice
    0.5 * unit.dot(other)
}

impl<const D: usize> FrictionIsland<'_, D> {
    /// The turns that couples resist, each with the place of its contact, in the order of their row blocks.
    pub fn turns(&self) -> impl Iterator<Item = (usize, Turn)> {
        self.laws.iter().enumerate().flat_map(|(place, law)| {
            let turns = [(law.rolling > 0.0, Turn::Rolling), (D == 3 && law.twisting > 0.0, Turn::Twisting)];
            turns.into_iter().filter_map(move |(resisted, turn)| resisted.then_some((place, turn)))
        })
    }

    /// The row blocks of contacts and of what turns them, with what bounds their tangential impulses.
    pub(super) fn with_turns<const W: usize>(
        &self,
        mut row_blocks: Vec<RowBlock<D, W>>,
        free: &[usize],
    ) -> (Vec<RowBlock<D, W>>, Vec<Bound>) {
        if !self.laws.iter().any(FrictionLaw::has_bounds) {
            return (row_blocks, Vec::new());
        }
        let bound = |(leader, (row_block, law)): (usize, (&RowBlock<D, W>, &FrictionLaw))| Bound {
            leader,
            load: law.critical_load * self.duration * row_block.norms[0],
        };
        let mut bounds: Vec<Bound> = row_blocks.iter().zip(self.laws).enumerate().map(bound).collect();
        for (leader, turn) in self.turns() {
            row_blocks.push(self.turning_rows(&row_blocks[leader], leader, turn, free));
            bounds.push(bounds[leader]);
        }
        (row_blocks, bounds)
    }

    /// The rows of a turn, after the normal one of its contact.
    fn turning_rows<const W: usize>(&self, leader: &RowBlock<D, W>, place: usize, turn: Turn, free: &[usize]) -> RowBlock<D, W> {
        let (contact, law) = (&self.contacts[place], &self.laws[place]);
        let frame = Frame::new(contact, self.balls);
        let mut row_block = leader.clone();
        row_block.rows.iter_mut().for_each(|rows| rows[1..].fill([0.0; W]));
        row_block.norms[1..].fill(1.0);
        let is_free = |body: &usize| free.binary_search(body).is_ok();
        let sides = [(Some(contact.body), -1.0), (contact.other(), 1.0)].into_iter();
        let sides: Vec<(usize, f64)> = sides.filter_map(|(body, sign)| Some((body.filter(is_free)?, sign))).collect();
        for (axis, unit) in frame.unit_spins(turn).iter().enumerate() {
            for (rows, (body, sign)) in row_block.rows.iter_mut().zip(&sides) {
                let factor = sign * frame.reduced_radius / self.masses[*body][1].sqrt();
                rows[axis + 1][D..].iter_mut().zip(components(unit)).for_each(|(entry, component)| *entry = factor * component);
            }
            let norm = row_block.rows.iter().flat_map(|rows| rows[axis + 1]).map(|entry| entry * entry).sum::<f64>().sqrt();
            row_block.rows.iter_mut().for_each(|rows| rows[axis + 1].iter_mut().for_each(|entry| *entry /= norm));
            row_block.norms[axis + 1] = norm;
        }
        let rates = frame.turning_rates(contact, turn, self.twists);
        (1..D).for_each(|axis| row_block.offset[axis] = rates[axis] / row_block.norms[axis]);
        RowBlock { friction: law.of_turn(turn) * row_block.norms[1] / row_block.norms[0], dilation: 0.0, ..row_block }
    }

    /// The impulses of wrenches in the rows of a program.
    pub fn impulses<const W: usize>(&self, program: &FrictionProgram<D, W>, wrenches: &[ContactWrench<D>]) -> Vec<[f64; D]> {
        let frame = |place: usize| Frame::new(&self.contacts[place], self.balls);
        let scaled = |impulse: [f64; D], row_block: &RowBlock<D, W>| {
            std::array::from_fn(|axis| impulse[axis] * self.duration * row_block.norms[axis])
        };
        let (contacts, turns) = program.row_blocks.split_at(self.contacts.len());
        let of_force = |(place, row_block): (usize, &RowBlock<D, W>)| scaled(frame(place).components(&wrenches[place].force), row_block);
        let of_couple = |((place, turn), row_block): ((usize, Turn), &RowBlock<D, W>)| {
            scaled(frame(place).row_components(Some(turn), &wrenches[place]), row_block)
        };
        contacts.iter().enumerate().map(of_force).chain(self.turns().zip(turns).map(of_couple)).collect()
    }

    /// The wrenches of impulses in the rows of a program.
    pub fn wrenches<const W: usize>(&self, program: &FrictionProgram<D, W>, impulses: &[[f64; D]]) -> Vec<ContactWrench<D>> {
        let frames: Vec<Frame<D>> = self.contacts.iter().map(|contact| Frame::new(contact, self.balls)).collect();
        let part = |place: usize, axis: usize| impulses[place][axis] / (program.row_blocks[place].norms[axis] * self.duration);
        let force = |(place, frame): (usize, &Frame<D>)| (0..D).map(|axis| frame.axes[axis] * part(place, axis)).sum();
        let mut wrenches: Vec<ContactWrench<D>> = frames.iter().enumerate().map(force).map(ContactWrench::of_force).collect();
        for (number, (place, turn)) in self.turns().enumerate() {
            for (axis, unit) in frames[place].unit_spins(turn).iter().enumerate() {
                wrenches[place].couple += unit * (frames[place].reduced_radius * part(self.contacts.len() + number, axis + 1));
            }
        }
        wrenches
    }
}
